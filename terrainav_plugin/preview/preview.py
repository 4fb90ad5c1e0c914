"""The preview: what would be captured, as layers that follow every change of the mission and of the view."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

from qgis.core import QgsFeature, QgsLayerTreeLayer, QgsProject, QgsRectangle, QgsVectorLayer
from qgis.gui import QgsMapCanvas
from qgis.PyQt.QtCore import QObject, QTimer, pyqtSignal

from ..map.mission_group import MissionGroup
from ..tasks import LatestWorker, crs_named, single_shot
from .layers import KINDS, field_names
from .view import MERCATOR, MapView, current_view, preview_world

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan
    from .scene import Drawing, PreviewScene

#: Features put into a layer at once: QGIS looks at each of them for some hundredths of a millisecond.
MOST_A_STEP = 100


class _Overtaken(Exception):
    """Another view or plan is wanted by now."""


class Preview(QObject):
    """Shows one plan at a time, in the detail that the map's view allows.

    A thread works out what a view needs; the layers are made and filled on the main thread, in steps too
    short to be felt. What is there already and still right stays.

    Signals
    -------
    closed()
        After the user removed the preview's layers, or the project was closed.
    visibility_changed(bool)
        Its layers have come into sight, or have all gone out of it, by whoever ticked them.
    failed(object)
        The error that has kept a view from being drawn.
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
        self._world = MERCATOR
        self._drawing: Drawing | None = None
        #: What each layer holds, so that the same is not put there again.
        self._held: dict[str, list[QgsFeature]] = {}
        #: Layers that were changed while the map was being drawn.
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
        """Whether there are preview layers in the project."""
        return bool(self._ids)

    @property
    def visible(self) -> bool:
        """Whether anything of it is to be seen, or will be as soon as it is there."""
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
        """Layer of a kind: area, centres, flight, footprints or density."""
        return self._project.mapLayer(self._ids.get(role, ""))

    def show(self, group: MissionGroup, mission: Mission, plan: Plan) -> None:
        """Have a plan drawn; layers that are there already are filled anew, in place."""
        self._set_group(group)
        self._plan, self._world, self._drawing = plan, preview_world(plan), None
        self._filling, self._pieces = False, self._make_layers(mission)
        self._fill_next()
        self._look()

    def set_footprints_visible(self, visible: bool) -> None:
        """Tick or untick the planned images, their density, centres and flight line in the layer tree."""
        for node in self._nodes():
            if visible:
                node.setItemVisibilityCheckedParentRecursive(True)
            else:
                node.setItemVisibilityChecked(False)

    def remove(self) -> None:
        """Take the preview off the map; results in its group stay."""
        self._worker.forget()
        self._pause.stop()
        self._plan = self._scene = self._drawing = self._pieces = None
        self._held = {}
        ids = [layer_id for layer_id in self._ids.values() if self._project.mapLayer(layer_id)]
        self._keep_styles(ids)
        # Removed by the preview: `_forget` need not react.
        self._ids = {}
        self._project.removeMapLayers(ids)
        if ids:
            # QGIS itself draws the map anew only where layers are gone from its list before they are deleted.
            self._canvas.refresh()
        if self._group is not None:
            self._group.remove_if_empty()
        self._group = None
        # Layers of another group are not hidden because those of this one were.
        self._look_at_visibility()

    def close(self) -> None:
        """End for good: nothing of the preview, no thread and no connection is left."""
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
        """Look again once the map has come to rest."""
        if self._plan is not None:
            self._pause.start()

    def _look(self) -> None:
        """Have drawn what the map shows now, unless it is there."""
        self._pause.stop()
        if self._plan is None:
            self._scene = None
            return
        view = current_view(self._canvas, self._world)
        if self._drawing is not None and view is not None and self._drawing.serves(view):
            # On its way may be another view, which has been left meanwhile.
            self._worker.forget()
        else:
            self._worker.ask(partial(self._work, self._plan, view), self._take)

    def _work(self, plan: Plan, view: MapView | None, overtaken: Callable[[], bool]) -> Drawing:
        """Make features, ending early when overtaken. Runs on the preview's thread."""
        from .scene import PreviewScene

        def check() -> None:
            if overtaken():
                raise _Overtaken

        def check_plan() -> None:
            if self._plan is not plan:
                raise _Overtaken

        scene = self._scene
        if scene is None or scene.plan is not plan:
            # It serves all views of its plan, so that only another plan overtakes it.
            scene = PreviewScene(plan, check_plan)
            check_plan()
            self._scene = scene
        return scene.draw(view, check)

    def _take(self, drawing: Drawing) -> None:
        self._drawing = drawing
        # Layers that are still being made are filled after that.
        if self._pieces is None or self._filling:
            self._pieces = self._fill(drawing)
            self._fill_next()

    def _fill_next(self) -> None:
        """Take the next step, and let the application breathe before the one after it."""
        if self._pieces is None:
            return
        if next(self._pieces, self) is self:
            self._pieces = None
        else:
            self._turn.start()

    def _make_layers(self, mission: Mission) -> Iterator[None]:
        """Bring the layers that are not there, step by step: reading their styles takes a while."""
        has_area = mission.kind == "raster"
        if not has_area:
            self._remove_area()
        for index, kind in enumerate(kind for kind in KINDS if has_area or kind.role != "area"):
            there = self.layer(kind.role) or self._adopt(kind.role)
            if there is not None:
                self._bring_to_world(there, kind.role)
                continue
            layer = kind.new_layer(self._world.crs)
            # Before the project has it: what it looks like meanwhile is not seen.
            for _ in kind.add_styles(layer):
                yield None
            self._add(layer, kind.role, index)
            yield None
        self._group.remember_mission(mission.to_json())
        self._look_at_visibility()
        if self._drawing is not None:
            yield from self._fill(self._drawing)

    def _fill(self, drawing: Drawing) -> Iterator[None]:
        """Fill the layers, some features a step, and show them all at the end."""
        self._filling = True
        changed = []
        for kind in KINDS:
            wanted, held = drawing.layers[kind.role], self._held.get(kind.role)
            if self.layer(kind.role) is None or held is wanted or (held == [] and not wanted):
                continue
            # Until it is filled, what it holds is of no use to another drawing.
            self._held.pop(kind.role, None)
            self.layer(kind.role).dataProvider().truncate()
            for first in range(0, len(wanted), MOST_A_STEP):
                layer = self.layer(kind.role)
                if layer is None:
                    # The user has removed it meanwhile.
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
                # "Zoom to layer" goes to the whole mission, whatever part of it is drawn.
                layer.setExtent(bounds)
            else:
                layer.updateExtents()
            layer.triggerRepaint()
        if self._canvas.isDrawing():
            self._overdrawn.update(roles)

    def _paint_again(self) -> None:
        """Have layers drawn once more that were changed under a running drawing.

        That drawing shows what they held before, and QGIS may keep its images for the next one, which the change
        had asked for: the old state would then stay on the map.
        """
        roles, self._overdrawn = self._overdrawn, set()
        for role in roles:
            layer = self.layer(role)
            if layer is not None:
                layer.triggerRepaint()

    # --- layers

    def _set_group(self, group: MissionGroup) -> None:
        """Change the group; a mission with another folder has another."""
        if self._group is not None and not self._group.is_same(group):
            self.remove()
        self._group = group

    def _adopt(self, role: str) -> QgsVectorLayer | None:
        """Take over the empty layer that a reopened project has kept of an earlier preview."""
        layer = self._group.layer(role)
        if not (isinstance(layer, QgsVectorLayer) and layer.providerType() == "memory"):
            return None
        if layer.fields().names() != field_names(role):
            # Of another version, which knew other attributes.
            self._project.removeMapLayer(layer.id())
            return None
        self._ids[role] = layer.id()
        self._held.pop(role, None)
        return layer

    def _bring_to_world(self, layer: QgsVectorLayer, role: str) -> None:
        """Have a layer, which keeps its style, hold features in the CRS of another plan."""
        crs = crs_named(self._world.crs)
        if layer.crs() != crs:
            # What it holds lies elsewhere in that CRS.
            layer.dataProvider().truncate()
            layer.setCrs(crs)
            self._held[role] = []

    def _add(self, layer: QgsVectorLayer, role: str, index: int) -> None:
        self._group.add(layer, role, index).setExpanded(False)
        self._ids[role] = layer.id()
        self._held[role] = []

    def _remove_area(self) -> None:
        """Take the layer of the area away, which for points would be empty."""
        layer = self.layer("area") or self._adopt("area")
        if layer is not None:
            self._keep_styles([layer.id()])
            # Removed by the preview: `_forget` need not react.
            del self._ids["area"]
            self._project.removeMapLayer(layer.id())
            self._canvas.refresh()

    def _nodes(self) -> list[QgsLayerTreeLayer]:
        """Where the layers that hide results are in the layer tree."""
        root = self._project.layerTreeRoot()
        # The area hides nothing.
        found = (root.findLayer(layer_id) for role, layer_id in self._ids.items() if role != "area")
        return [node for node in found if node is not None]

    def _look_at_visibility(self, *_: object) -> None:
        visible = self.visible
        if visible != self._visible:
            self._visible = visible
            self.visibility_changed.emit(visible)

    def _keep_styles(self, layer_ids: list[str]) -> None:
        """Have the styles of layers that go outlive them for a while.

        A drawing that begins copies a style's expressions just after it has let go of the original, in every QGIS
        known (`QgsExpression::detach`): if the layer goes at that moment, QGIS reads freed memory and ends. The
        original stays while a copy of the style holds it, too.
        """
        styles = []
        for layer_id in set(layer_ids) & set(self._ids.values()):
            layer = self._project.mapLayer(layer_id)
            styles += [style.clone() for style in (layer.renderer(), layer.labeling()) if style is not None]
        if styles:
            # Not a timer of this object, which may be closed. A cancelled drawing ends long before these 30 s.
            QTimer.singleShot(30_000, styles.clear)

    def _forget(self, layer_ids: list[str]) -> None:
        """Notice layers that the user has removed; the preview ends with its footprints."""
        gone = set(layer_ids)
        if not gone & set(self._ids.values()):
            return
        over = self._ids.get("footprints") in gone
        self._ids = {role: layer_id for role, layer_id in self._ids.items() if layer_id not in gone}
        if over:
            self.remove()
            self.closed.emit()
