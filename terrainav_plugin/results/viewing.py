"""The map tool for footprints, and the image of a clicked footprint."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCsException,
    QgsMapLayer,
    QgsProject,
    QgsVectorLayer,
)
from qgis.gui import QgisInterface, QgsRubberBand
from qgis.PyQt.QtCore import QObject
from qgis.PyQt.QtGui import QColor

from ...core.errors import InvalidInput, TerrAInavError
from ...core.text.plain import one_line
from ..compat import LINE
from ..dataset.layers import open_raster
from ..i18n import tr, translate
from ..map.canvas import ClickTool, show_extent
from ..map.mission_group import CAPTURED, ROLE, MissionGroup
from ..map.outlines import seen_edges
from ..messages import Messages
from ..paths import open_in_system
from ..remote.trust import elevation_names, unagreed_places
from ..tasks import LatestWorker, failure_reason
from ..widgets import add_docked, remove_menu_mnemonics

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ...core.mission.relief.ground import Heights
    from ..remote.images import ImageFetcher
    from .shots import CapturedImage, Finder, FootprintLayer, ViewedImage
    from .viewer import Viewer

_BAND_COLOUR = QColor(240, 140, 30)


def _agreed_heights(mission: Mission) -> Heights | None:
    """Heights of a dataset's mission; raises InvalidInput if the user has not agreed to their source."""
    from ..sources import mission_heights

    places = unagreed_places(elevation_names(mission))
    if places:
        raise InvalidInput(
            tr(
                "its heights are those of {place}, which you have not used in this QGIS: open its dataset by "
                "“Missions” and allow it"
            ).format(place=one_line(places[0]))
        )
    return mission_heights(mission)


class Viewing(QObject):
    """The map tool, the window, and the outline of the image shown."""

    def __init__(self, project: QgsProject, iface: QgisInterface, messages: Messages) -> None:
        super().__init__()
        self._project, self._iface, self._messages = project, iface, messages
        self._canvas = iface.mapCanvas()
        self.tool = ClickTool(self._canvas)
        self.tool.clicked.connect(self._clicked)
        self.tool.refused.connect(messages.warning)
        self.viewer: Viewer | None = None
        self.seen: ViewedImage | None = None
        #: Product of labels shown over images; empty for none.
        self._labels = ""
        self._shots: list[CapturedImage] = []
        self._finder: Finder | None = None
        self._images: ImageFetcher | None = None
        self._band: QgsRubberBand | None = None
        self._worker = LatestWorker("viewer")
        self._worker.failed.connect(self._refused)
        self._layer_worker = LatestWorker("on-map")
        self._layer_worker.failed.connect(self._show_lay_error)
        project.layersRemoved.connect(self._layers_removed)

    @property
    def busy(self) -> bool:
        """Whether an image is pending."""
        return self._worker.busy or self._layer_worker.busy

    def start(self) -> bool:
        """Let the user click footprints; if there are none, show a message and return False."""
        if not self._layers():
            self._messages.info(
                tr("There are no captured images on the map yet: capture a mission, or open a dataset by “Missions”.")
            )
            return False
        self._shown_viewer()
        self.tool.start()
        if self.seen is None:
            self._find_images(lambda finder, footprints: finder.first(footprints))
        return True

    def stop(self) -> None:
        """Stop the tool; the window stays until the user closes it."""
        self.tool.stop()

    def close(self) -> None:
        """Stop for good."""
        self._project.layersRemoved.disconnect(self._layers_removed)
        if self._images is not None:
            self._images.interrupt()
        self._worker.close()
        self._layer_worker.close()
        self.tool.stop()
        self.tool.deleteLater()
        self._remove_band()
        if self.viewer is not None:
            self._iface.removeDockWidget(self.viewer)
            self.viewer.deleteLater()
            self.viewer = None

    # --- finding an image

    def _layers(self) -> list[QgsVectorLayer]:
        """Captured footprints of all missions: the visible ones, or all if none is visible."""
        nodes = [
            node
            for node in self._project.layerTreeRoot().findLayers()
            if node.layer() is not None and node.layer().customProperty(ROLE) == CAPTURED and node.layer().isValid()
        ]
        return [node.layer() for node in nodes if node.isVisible()] or [node.layer() for node in nodes]

    def _clicked(self, lat_deg: float, lon_deg: float) -> None:
        self._find_images(lambda finder, footprints: finder.find_shots(footprints, lat_deg, lon_deg))

    def _find_images(self, find: Callable[[Finder, list[FootprintLayer]], list[CapturedImage]]) -> None:
        from .shots import Finder, FootprintLayer

        footprints = [FootprintLayer.read(layer) for layer in self._layers()]
        finder = self._finder = self._finder or Finder(lambda: self._worker.closed)
        if self.seen is None:
            self._shown_viewer().show_hint(tr("Looking for images…"))
        self._ask(lambda _: find(finder, footprints), self._found)

    def _found(self, shots: list[CapturedImage]) -> None:
        viewer = self._shown_viewer()
        if not shots:
            self._messages.refused(tr("No image shows this place"), _what_to_click())
            if self.seen is None:
                viewer.show_hint(_what_to_click())
            else:
                # Nothing is under the click: keep the latest image, as it is easy to miss a footprint.
                self._outline(self.seen.shot)
            return
        self._messages.withdraw_refusal()
        self._shots = shots
        viewer.offer(shots, 0)
        self._show_shot(shots[0])

    def _show_shot(self, shot: CapturedImage | None, map_type: str = "") -> None:
        from ..remote.copies import has_images_elsewhere
        from ..remote.images import ImageFetcher
        from .shots import view_image

        if shot is None:
            return
        wanted = map_type or (self.seen.map_type if self.seen is not None else "")
        self._outline(shot)
        images = self._images = self._images or ImageFetcher()
        if has_images_elsewhere(shot.footprints.folder):
            self._shown_viewer().show_fetching(shot.name)
        # Images with a longer side of 1600 px are sharp on any screen, and quickly read.
        labels = self._labels
        self._ask(lambda _: view_image(shot, wanted, 1600, images, labels), self._show)

    def _ask(self, work: Callable[[Callable[[], bool]], Any], answer: Callable[[Any], None]) -> None:
        """Run work in the background, and cancel the fetching of a previous image."""
        if self._images is not None and self._worker.busy:
            self._images.interrupt()
        self._worker.ask(work, answer)

    def _show(self, seen: ViewedImage) -> None:
        self.seen = seen
        viewer = self._shown_viewer()
        viewer.show_seen(seen)
        viewer.on_map.setChecked(self._find_layer(seen) is not None)

    # --- the image on the map

    def _mission_group(self, seen: ViewedImage) -> MissionGroup:
        return MissionGroup(self._project, seen.shot.footprints.folder)

    def _find_layer(self, seen: ViewedImage) -> QgsMapLayer | None:
        """Layer of an image laid on the map, if any."""
        group, role = self._mission_group(seen), _layer_role(seen)
        # In a project of an earlier version, it is in the group.
        return group.on_top(role) or group.layer(role)

    def _show_on_map(self, on: bool) -> None:
        seen = self.seen
        if seen is None:
            return
        if not on:
            layer = self._find_layer(seen)
            if layer is not None:
                self._project.removeMapLayer(layer.id())
            self._canvas.refresh()
            return
        folder, map_type, file = seen.shot.footprints.folder, seen.map_type, seen.picture.path.name
        fetched = seen.fetched

        def save(path: Path) -> None:
            from ..remote.images import add_georeference

            add_georeference(fetched, folder, map_type, file).save(path)

        def laid(_: object) -> Path:
            from ..dataset.rectify import lay_image_on_map

            return lay_image_on_map(folder, map_type, file, _agreed_heights, None if fetched is None else save)

        self._layer_worker.ask(laid, lambda path: self._show_laid(seen, path))

    def _show_laid(self, seen: ViewedImage, path: Path) -> None:
        group = self._mission_group(seen)
        if group.find() is None:
            return
        try:
            if self._find_layer(seen) is None:
                group.add_on_top(open_raster(path, seen.shot.name), _layer_role(seen)).setExpanded(False)
        except TerrAInavError as wrong:
            self._show_lay_error(wrong)
            return
        if self.seen is not None and _layer_role(self.seen) == _layer_role(seen):
            self._zoom()

    def _show_lay_error(self, error: Exception) -> None:
        self._messages.warning(translate(failure_reason(error)))
        if self.viewer is not None:
            self.viewer.on_map.setChecked(False)

    def _choose(self, index: int) -> None:
        if 0 <= index < len(self._shots):
            self._show_shot(self._shots[index])

    def _step(self, step: int) -> None:
        if self.seen is None or self.viewer is None or self._finder is None:
            return
        shot, finder = self.seen.shot, self._finder
        self.viewer.leave_click()
        self._ask(lambda _: finder.neighbour(shot, step), self._show_shot)

    def _refused(self, error: Exception) -> None:
        if self.viewer is not None:
            self.viewer.show_hint(translate(failure_reason(error)))

    # --- the window and the outline

    def _shown_viewer(self) -> Viewer:
        if self.viewer is None:
            from .viewer import Viewer

            viewer = self.viewer = Viewer()
            viewer.chosen.connect(self._choose)
            viewer.step_wanted.connect(self._step)
            viewer.map_type_wanted.connect(self._show_map_type)
            viewer.labels.wanted.connect(self._show_labels)
            viewer.open_wanted.connect(self._open)
            viewer.zoom_wanted.connect(self._zoom)
            viewer.on_map_wanted.connect(self._show_on_map)
            viewer.visibilityChanged.connect(self._visibility_changed)
            viewer.closed.connect(self.tool.stop)
            remove_menu_mnemonics(viewer, self._iface.mainWindow().menuBar())
            add_docked(viewer, self._iface, "terrainav_dock")
        self.viewer.setUserVisible(True)
        return self.viewer

    def _show_map_type(self, map_type: str) -> None:
        if self.seen is not None:
            self._show_shot(self.seen.shot, map_type)

    def _show_labels(self, product: str) -> None:
        """Show labels over this image and further ones."""
        self._labels = product
        if self.seen is not None:
            self._show_shot(self.seen.shot)

    def _open(self) -> None:
        if self.seen is None:
            return
        path, fetched = self.seen.picture.path, self.seen.fetched
        if fetched is not None:
            from ..dataset.rectify import fetched_file

            path = fetched_file(self.seen.shot.footprints.folder, self.seen.map_type, path.name)
            try:
                fetched.save(path)
            except TerrAInavError as wrong:
                self._messages.warning(translate(wrong))
                return
        open_in_system(path)

    def _zoom(self) -> None:
        if self._band is None:
            return
        show_extent(self._canvas, self._band.asGeometry().boundingBox(), 2.0)

    def _visibility_changed(self, visible: bool) -> None:
        """Show or hide the outline with the window."""
        if self._band is not None:
            self._band.setVisible(visible)

    def _outline(self, shot: CapturedImage) -> None:
        if self._band is None:
            self._band = QgsRubberBand(self._canvas, LINE)
            self._band.setStrokeColor(_BAND_COLOUR)
            self._band.setWidth(3)
        try:
            self._band.setToGeometry(seen_edges(shot.outline), QgsCoordinateReferenceSystem("EPSG:4326"))
        except QgsCsException:
            # The footprint is outside the domain of the map's CRS: show the image without an outline.
            self._band.reset(LINE)

    def _remove_band(self) -> None:
        if self._band is not None:
            self._canvas.scene().removeItem(self._band)
            self._band = None

    def _layers_removed(self, layer_ids: list[str]) -> None:
        """Hide the image if the layer of its footprints was removed."""
        self._shots = [shot for shot in self._shots if shot.footprints.layer_id not in layer_ids]
        if self.seen is not None and self.seen.shot.footprints.layer_id in layer_ids:
            self.seen = None
            self._remove_band()
            if self.viewer is not None:
                self.viewer.show_hint(_what_to_click())
        elif self.seen is not None and self.viewer is not None:
            # The layer of the image itself may be among the removed layers.
            self.viewer.on_map.setChecked(self._find_layer(self.seen) is not None)


def _layer_role(seen: ViewedImage) -> str:
    """Role of the layer of an image laid on the map."""
    return f"image/{seen.map_type}/{seen.shot.name}"


def _what_to_click() -> str:
    return tr("Click a captured footprint on the map.")
