"""The preview: layers of the planned images, which follow every change of the mission and the view."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from qgis.core import QgsFeature, QgsLayerTreeLayer, QgsProject, QgsRectangle, QgsVectorLayer
from qgis.gui import QgsMapCanvas
from qgis.PyQt.QtCore import QObject, QTimer, pyqtSignal

from ..map.mission_group import MissionGroup
from ..plan_features import MOST_FEATURES, PlanFeatures
from ..tasks import LatestWorker, crs_named, single_shot
from .layers import KINDS, OF_FILES, drawn_title, dress_kinds, field_names
from .view import MERCATOR, MapView, current_view, preview_world

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan
    from .scene import Drawing, PreviewScene

#: Number of features added to a layer in a step; QGIS takes some hundredths of a millisecond for each.
MOST_A_STEP = 100


class _Overtaken(Exception):
    """Another view or plan has been requested."""


class Preview(QObject):
    """Show one plan at a time, in the detail that the map's view allows.

    A thread computes the features of a view; the main thread creates and fills the layers, in steps too short to be
    noticed. Layers that are still valid are not changed.

    Signals
    -------
    closed()
        The user has removed the preview's layers, or the project was closed.
    visibility_changed(bool)
        True when a layer of the preview becomes visible, False when all are hidden, by the user or the plugin.
    failed(object)
        The error that prevented drawing.
    """

    closed = pyqtSignal()
    visibility_changed = pyqtSignal(bool)
    failed = pyqtSignal(object)

    def __init__(self, project: QgsProject, canvas: QgsMapCanvas) -> None:
        super().__init__()
        self._project = project
        self._canvas = canvas
        self._group: MissionGroup | None = None
        self._ids: dict[str, str] = {}
        self._plan: Plan | None = None
        self._features = PlanFeatures()
        #: Their map features by role, and of what and in which plane these are.
        self._ground: dict[str, list[QgsFeature]] = {}
        self._ground_of: tuple[object, object] = None, None
        #: Kinds of features that symbols of layers stand for, by role.
        self._kinds: dict[str, list[tuple[str, str]]] = {}
        self._world = MERCATOR
        self._drawing: Drawing | None = None
        #: Features in each layer, by role, to skip unchanged layers.
        self._held: dict[str, list[QgsFeature]] = {}
        #: Layers changed while the map was being drawn.
        self._overdrawn: set[str] = set()
        self._pieces: Iterator[None] | None = None
        self._filling = False
        self._scene: PreviewScene | None = None
        self._visible = True
        self._worker = LatestWorker("preview", self)
        self._worker.failed.connect(self.failed)
        self._pause = single_shot(self._look, self, 60)
        self._turn = single_shot(self._fill_next, self)
        project.layersWillBeRemoved["QStringList"].connect(self._keep_styles)
        project.layersRemoved.connect(self._forget)
        project.layerTreeRoot().visibilityChanged.connect(self._look_at_visibility)
        self._moves = (
            canvas.extentsChanged,
            canvas.scaleChanged,
            canvas.destinationCrsChanged,
            canvas.rotationChanged,
            canvas.temporalRangeChanged,
        )
        for moved in self._moves:
            moved.connect(self._follow)
        canvas.mapCanvasRefreshed.connect(self._paint_again)

    @property
    def shown(self) -> bool:
        """Whether the project has preview layers."""
        return bool(self._ids)

    @property
    def visible(self) -> bool:
        """Whether any layer of the preview is visible, or will be once it exists."""
        nodes = self._nodes()
        return not nodes or any(node.isVisible() for node in nodes)

    @property
    def busy(self) -> bool:
        """Whether layers are still to be filled."""
        return self._pause.isActive() or self._worker.busy or self._pieces is not None

    @property
    def drawing(self) -> Drawing | None:
        """The current drawing."""
        return self._drawing

    def layer(self, role: str) -> QgsVectorLayer | None:
        """Layer with a role: area, centres, flight, footprints or density."""
        return self._project.mapLayer(self._ids.get(role, ""))

    def show(self, group: MissionGroup, mission: Mission, plan: Plan, features: PlanFeatures | None = None) -> None:
        """Show a plan; existing layers are filled again in place.

        Parameters
        ----------
        features : PlanFeatures or None
            Labels and buildings around the plan; None leaves those shown until they are read.
        """
        self._set_group(group)
        self._features = self._features if features is None else features
        self._plan, self._world, self._drawing = plan, preview_world(plan), None
        self._filling, self._pieces = False, self._make_layers(mission)
        self._fill_next()
        self._look()

    def set_footprints_visible(self, visible: bool) -> None:
        """Check or uncheck the planned images, density, centres and flight line in the layer tree."""
        for node in self._nodes():
            if visible:
                node.setItemVisibilityCheckedParentRecursive(True)
            else:
                node.setItemVisibilityChecked(False)

    def remove(self) -> None:
        """Remove the preview from the map; results in the same group stay."""
        self._worker.forget()
        self._pause.stop()
        self._plan = self._scene = self._drawing = self._pieces = None
        self._features, self._ground, self._ground_of = PlanFeatures(), {}, (None, None)
        self._held, self._kinds = {}, {}
        ids = [layer_id for layer_id in self._ids.values() if self._project.mapLayer(layer_id)]
        self._keep_styles(ids)
        # First clear the ids, so that `_forget` does not take this for the user's removal.
        self._ids = {}
        self._project.removeMapLayers(ids)
        if ids:
            # Needed, as QGIS redraws the map only if layers leave its list before they are deleted.
            self._canvas.refresh()
        if self._group is not None:
            self._group.remove_if_empty()
        self._group = None
        # The layers of the next group may be visible even if those of this group were hidden.
        self._look_at_visibility()

    def close(self) -> None:
        """Stop for good: remove the preview, its thread and its connections."""
        for moved in self._moves:
            moved.disconnect(self._follow)
        self._canvas.mapCanvasRefreshed.disconnect(self._paint_again)
        self._project.layersRemoved.disconnect(self._forget)
        self._project.layerTreeRoot().visibilityChanged.disconnect(self._look_at_visibility)
        self.remove()
        self._project.layersWillBeRemoved["QStringList"].disconnect(self._keep_styles)
        self._worker.close()

    # --- from a view to features

    def _follow(self, *_: object) -> None:
        """Check the view again after a pause without changes."""
        if self._plan is not None:
            self._pause.start()

    def _look(self) -> None:
        """Request a drawing of the current view, unless the current drawing serves it."""
        self._pause.stop()
        if self._plan is None:
            self._scene = None
            return
        view = current_view(self._canvas, self._world)
        if self._drawing is not None and view is not None and self._drawing.serves(view):
            # Abandon a drawing for an earlier view.
            self._worker.forget()
        else:
            self._worker.ask(partial(self._work, self._plan, self._features, view), self._take)

    def _work(self, plan: Plan, features: PlanFeatures, view: MapView | None, overtaken: Callable[[], bool]) -> Drawing:
        """Compute features, ending early if overtaken. Runs on the preview's thread."""
        from .ground import ground_features
        from .scene import PreviewScene

        def check() -> None:
            if overtaken():
                raise _Overtaken

        def check_plan() -> None:
            if self._plan is not plan:
                raise _Overtaken

        scene = self._scene
        if scene is None or scene.plan is not plan:
            # The scene is for all views of the plan: only another plan makes it obsolete.
            scene = PreviewScene(plan, check_plan)
            check_plan()
            self._scene = scene
        drawing = scene.draw(view, check)
        plane = plan.grid.plane
        if self._ground_of[0] is not features or self._ground_of[1] != plane:
            self._ground = {role: ground_features(drawn, plane, check) for role, drawn in features.layers.items()}
            self._ground_of = features, plane
        drawing.layers.update({role: self._ground.get(role, []) for role in OF_FILES})
        return drawing

    def _take(self, drawing: Drawing) -> None:
        self._drawing = drawing
        # If layers are still being created, they are filled afterwards.
        if self._pieces is None or self._filling:
            self._pieces = self._fill(drawing)
            self._fill_next()

    def _fill_next(self) -> None:
        """Do one step, and request the following one from the event loop."""
        if self._pieces is None:
            return
        if next(self._pieces, self) is self:
            self._pieces = None
        else:
            self._turn.start()

    def _make_layers(self, mission: Mission) -> Iterator[None]:
        """Create missing layers, step by step, as reading their styles takes a while."""
        # Others would be empty: of the area of points, and of files that the mission does not name.
        wanted = {
            "area": mission.kind == "raster",
            "buildings": bool(mission.terrain.buildings),
            "labels": bool(mission.labels.labels),
        }
        for role in wanted:
            if not wanted[role]:
                self._remove_layer(role)
        for index, kind in enumerate(kind for kind in KINDS if wanted.get(kind.role, True)):
            there = self.layer(kind.role) or self._adopt(kind.role)
            if there is not None:
                self._bring_to_world(there, kind.role)
                continue
            layer = kind.new_layer(self._world.crs)
            # Set up the layer before it is in the project, so that intermediate states are not visible.
            for _ in kind.add_styles(layer):
                yield None
            self._add(layer, kind.role, index)
            yield None
        self._group.remember_mission(mission.to_json())
        self._look_at_visibility()
        if self._drawing is not None:
            yield from self._fill(self._drawing)

    def _fill(self, drawing: Drawing) -> Iterator[None]:
        """Fill the layers, some features per step, and show them all at the end."""
        self._filling = True
        changed = []
        for kind in KINDS:
            wanted, held = drawing.layers[kind.role], self._held.get(kind.role)
            if self.layer(kind.role) is None or held is wanted or (held == [] and not wanted):
                continue
            if kind.role in OF_FILES:
                self._dress(kind.role)
            # While the layer is being filled, another drawing cannot reuse its contents.
            self._held.pop(kind.role, None)
            self.layer(kind.role).dataProvider().truncate()
            for first in range(0, len(wanted), MOST_A_STEP):
                layer = self.layer(kind.role)
                if layer is None:
                    # The user has removed the layer meanwhile.
                    break
                layer.dataProvider().addFeatures(wanted[first : first + MOST_A_STEP])
                yield None
            self._held[kind.role] = wanted
            changed.append(kind.role)
        self._repaint(changed, drawing)

    def _repaint(self, roles: list[str], drawing: Drawing) -> None:
        bounds, world = QgsRectangle(*drawing.bounds.edges), drawing.bounds.world
        if bounds.xMaximum() > world.east:
            bounds.setXMinimum(world.west)
            bounds.setXMaximum(world.east)
        for role in roles:
            layer = self.layer(role)
            if layer is None:
                continue
            if role != "area":
                # The extent for "Zoom to layer" is the whole mission, even if only a part is drawn.
                layer.setExtent(bounds)
            else:
                layer.updateExtents()
            layer.triggerRepaint()
        if self._canvas.isDrawing():
            self._overdrawn.update(roles)

    def _paint_again(self) -> None:
        """Redraw layers that were changed while QGIS was drawing the map.

        QGIS may reuse the images of that drawing, with the old contents of the layers, for the drawing that the change
        has requested: the old contents would then stay on the map.
        """
        roles, self._overdrawn = self._overdrawn, set()
        for role in roles:
            layer = self.layer(role)
            if layer is not None:
                layer.triggerRepaint()

    # --- layers

    def _set_group(self, group: MissionGroup) -> None:
        """Change the group, which depends on the mission's folder."""
        if self._group is not None and not self._group.is_same(group):
            self.remove()
        self._group = group

    def _adopt(self, role: str) -> QgsVectorLayer | None:
        """Reuse the empty layer of an earlier preview that a reopened project has kept."""
        layer = self._group.layer(role)
        if not (isinstance(layer, QgsVectorLayer) and layer.providerType() == "memory"):
            return None
        if layer.fields().names() != field_names(role):
            # Another version of the plugin has made it, with other attributes.
            self._project.removeMapLayer(layer.id())
            return None
        self._ids[role] = layer.id()
        self._held.pop(role, None)
        return layer

    def _bring_to_world(self, layer: QgsVectorLayer, role: str) -> None:
        """Change a layer to the CRS of another plan, keeping its style."""
        crs = crs_named(self._world.crs)
        if layer.crs() != crs:
            # In the other CRS, the old features would be in wrong places.
            layer.dataProvider().truncate()
            layer.setCrs(crs)
            self._held[role] = []

    def _add(self, layer: QgsVectorLayer, role: str, index: int) -> None:
        self._group.add(layer, role, index).setExpanded(False)
        self._ids[role] = layer.id()
        self._held[role] = []

    def _dress(self, role: str) -> None:
        """Give the features of files symbols by their kind, and the layer a name that states how many are left out."""
        layer, drawn = self.layer(role), self._features.layers.get(role, ())
        layer.setName(drawn_title(role, self._features.counts.get(role, 0), MOST_FEATURES))
        present = {one.kinds[place] for one in drawn for place in one.places if place >= 0}
        # In the order of their table.
        kinds = list(dict.fromkeys(kind for one in drawn for kind in one.kinds if kind in present))
        if kinds != self._kinds.get(role):
            self._kinds[role] = kinds
            self._keep_styles([layer.id()])
            dress_kinds(layer, role, kinds)

    def _remove_layer(self, role: str) -> None:
        """Remove a layer that would be empty."""
        layer = self.layer(role) or self._adopt(role)
        if layer is not None:
            self._keep_styles([layer.id()])
            self._kinds.pop(role, None)
            # First delete the id, so that `_forget` does not take this for the user's removal.
            del self._ids[role]
            self._project.removeMapLayer(layer.id())
            self._canvas.refresh()

    def _nodes(self) -> list[QgsLayerTreeLayer]:
        """Layer tree nodes of the layers that may hide results: all except the outline of the area."""
        root = self._project.layerTreeRoot()
        found = (root.findLayer(layer_id) for role, layer_id in self._ids.items() if role != "area")
        return [node for node in found if node is not None]

    def _look_at_visibility(self, *_: object) -> None:
        visible = self.visible
        if visible != self._visible:
            self._visible = visible
            self.visibility_changed.emit(visible)

    def _keep_styles(self, layer_ids: list[str]) -> None:
        """Keep the styles of layers that are about to be removed alive for a while.

        When a drawing begins, QGIS (every known version) copies a style's expressions just after releasing the original
        (`QgsExpression::detach`): if the layer is deleted at that moment, QGIS reads freed memory and crashes. A copy
        of the style keeps the original expressions alive.
        """
        styles = []
        for layer_id in set(layer_ids) & set(self._ids.values()):
            layer = self._project.mapLayer(layer_id)
            styles += [style.clone() for style in (layer.renderer(), layer.labeling()) if style is not None]
        if styles:
            # A timer independent of this object, which may be deleted. A cancelled drawing ends long before 30 s.
            QTimer.singleShot(30_000, styles.clear)

    def _forget(self, layer_ids: list[str]) -> None:
        """Handle layers removed by the user; the preview ends if the footprints are removed."""
        gone = set(layer_ids)
        if not gone & set(self._ids.values()):
            return
        over = self._ids.get("footprints") in gone
        self._ids = {role: layer_id for role, layer_id in self._ids.items() if layer_id not in gone}
        if over:
            self.remove()
            self.closed.emit()
