"""Where areas come from and go to: the menu, the map's tools, and the form."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from qgis.core import QgsCsException, QgsMapLayer, QgsProject, QgsVectorLayer
from qgis.gui import QgisInterface, QgsDockWidget
from qgis.PyQt.QtCore import QObject
from qgis.PyQt.QtWidgets import QApplication, QDialog, QFileDialog

from ...core.errors import InvalidInput, TerrAInavError
from ...core.mission.area import Area, Box, Points
from ...core.mission.parts import utc_time
from ..compat import POLYGON, VECTOR
from ..form.area import FormError, area_words, entered_area, with_area
from ..i18n import tr, translate
from ..map.canvas import canvas_rectangle, show_extent
from ..messages import Messages
from ..tasks import single_shot
from .bands import AreaMark
from .dialogs import LayerDialog, LineDialog, PointsDialog, PolygonDialog
from .editing import AreaEditing
from .entries import AreaEntries
from .layers import (
    Reading,
    ReadTask,
    extent_of,
    flown_lines,
    points,
    rectangle_area,
    selected_polygon,
    text_file,
)
from .menu import Way
from .patterns import PATTERNS, pattern_dialog
from .tools import AreaTool, BoxTool, PointTool

#: Room left around an area that is zoomed to, as a share of it.
_MARGIN = 1.5
#: Areas with no side of this many pixels of the screen are a dot, and count as out of sight.
_DOT_PX = 6.0
#: Pause in typing after which the map goes to an area that is out of sight.
_PAUSE_MS = 600


class AreaControl(QObject):
    """Takes areas from wherever a person has them into the form, one undoable step each.

    Parameters
    ----------
    iface : QgisInterface
    panel : QgsDockWidget
        That the entries are part of; the area is marked on the map while it is to be seen.
    entries : AreaEntries
    editing : AreaEditing
    messages : Messages
    box_tool : BoxTool

    Attributes
    ----------
    tool : AreaTool
        Moves the area on the map.
    single_tool : PointTool
        Takes the place of a single capture.
    mark : AreaMark
        Shows the area on the map as long as neither that tool nor a preview does.
    """

    def __init__(
        self,
        iface: QgisInterface,
        panel: QgsDockWidget,
        entries: AreaEntries,
        editing: AreaEditing,
        messages: Messages,
        box_tool: BoxTool,
    ) -> None:
        super().__init__()
        self._iface, self._panel, self._messages = iface, panel, messages
        self._entries, self._editing, self._box_tool = entries, editing, box_tool
        self._canvas, self._project = iface.mapCanvas(), QgsProject.instance()
        self._task: ReadTask | None = None
        #: Layer of which a selected polygon is waited for.
        self._selecting: QgsVectorLayer | None = None
        keys = self._editing.undo_keys
        self.tool = AreaTool(self._canvas, keys)
        self.single_tool = PointTool(self._canvas)
        self.mark, self._previewed = AreaMark(self._canvas), False
        self._pause = single_shot(self._go_to_typed, self, _PAUSE_MS)
        panel.installEventFilter(keys)
        self.tool.setButton(entries.edit)
        entries.edit.clicked.connect(self._switch_tool)
        entries.area_from.chosen.connect(self._take)
        self._editing.noted.connect(self._follow)
        self._editing.coordinates_entered.connect(self._pause.start)
        # Whoever moves the map meanwhile looks at something else.
        self._canvas.extentsChanged.connect(self._pause.stop)
        self._canvas.mapToolSet.connect(self._show_mark)
        panel.visibilityChanged.connect(self._show_mark)
        self.tool.dragging.connect(self._show_dragged)
        self.tool.changed.connect(self._take_moved)
        box_tool.drawn.connect(self._take_drawn)
        self.single_tool.clicked.connect(self._take_single)
        self.single_tool.refused.connect(messages.warning)
        self._ways: dict[str, Callable[[], None]] = {
            Way.DRAW: box_tool.start,
            Way.CANVAS: self.take_canvas,
            Way.SINGLE: self.single_tool.start,
            Way.LAYER: self._ask_for_layer,
            Way.POLYGON: self._take_polygon,
            Way.POINTS: self._ask_for_points,
            Way.LINE: self._ask_for_line,
            **{way: partial(self._ask_for_pattern, way) for way in PATTERNS},
            Way.FILE: self._ask_for_file,
            Way.PASTE: self.paste,
            Way.TO_BOX: self._editing.make_box,
        }

    def close(self) -> None:
        """Leave nothing behind."""
        if self._task is not None:
            self._task.abandon()
            self._task = None
        self._stop_selecting()
        self._pause.stop()
        self._canvas.extentsChanged.disconnect(self._pause.stop)
        self._canvas.mapToolSet.disconnect(self._show_mark)
        self._panel.visibilityChanged.disconnect(self._show_mark)
        self.mark.close()
        for tool in (self.tool, self.single_tool):
            tool.stop()
            tool.deleteLater()

    # --- ways to an area

    def take_canvas(self) -> None:
        """Take what the map shows."""
        settings = self._canvas.mapSettings()
        self._enter(
            lambda: rectangle_area(settings.visibleExtent(), settings.destinationCrs(), self._project),
            tr("map canvas extent"),
        )

    def paste(self) -> None:
        """Take the coordinates on the clipboard."""
        text = QApplication.clipboard().text()
        if not text.strip():
            self._refuse(tr("the clipboard holds no text; copy coordinates first"))
            return
        try:
            self._editing.set_coordinates(text)
        except FormError as wrong:
            self._refuse(translate(wrong))

    def read(self, step: str, reading: Callable[[], Reading]) -> None:
        """Read an area on a thread, and enter it when it is there; a reading under way is dropped."""
        try:
            task = ReadTask(step, reading())
        except TerrAInavError as wrong:
            self._refuse(translate(wrong))
            return
        if self._task is not None:
            self._task.cancel()
        self._task = task
        task.begin(self._take_read)

    def _ask_for_layer(self) -> None:
        dialog = LayerDialog(self._iface.mainWindow(), tr("Extent of a layer"), self._iface.activeLayer())
        self._open(dialog, lambda: self._take_extent(dialog.chosen()))

    def _take_extent(self, layer: QgsMapLayer) -> None:
        step = tr("extent of {layer}").format(layer=layer.name())
        self._enter(lambda: extent_of(layer, self._project), step)

    def _take_polygon(self) -> None:
        layer = self._iface.activeLayer()
        is_polygons = layer is not None and layer.type() == VECTOR and layer.geometryType() == POLYGON
        if is_polygons and layer.selectedFeatureCount():
            self._read_polygon(layer)
            return
        dialog = PolygonDialog(self._iface.mainWindow(), layer)
        dialog.select.clicked.connect(lambda: self._let_select(dialog))
        self._open(dialog, lambda: self._read_polygon(dialog.chosen()))

    def _let_select(self, dialog: PolygonDialog) -> None:
        """Let the user select a polygon by QGIS's own tool; the selection becomes the area."""
        layer = dialog.chosen()
        dialog.reject()
        self._stop_selecting()
        self._selecting = layer
        layer.selectionChanged.connect(self._take_selected)
        layer.willBeDeleted.connect(self._stop_selecting)
        self._iface.setActiveLayer(layer)
        self._iface.actionSelect().trigger()
        self._messages.info(tr("Click one polygon of “{layer}” on the map.").format(layer=layer.name()))

    def _take_selected(self) -> None:
        layer = self._selecting
        if layer is not None and layer.selectedFeatureCount():
            self._stop_selecting()
            self._read_polygon(layer)

    def _stop_selecting(self, *_: object) -> None:
        """Take no selection any more."""
        layer, self._selecting = self._selecting, None
        if layer is not None:
            layer.selectionChanged.disconnect(self._take_selected)
            layer.willBeDeleted.disconnect(self._stop_selecting)

    def _read_polygon(self, layer: QgsMapLayer) -> None:
        step = tr("polygon of {layer}").format(layer=layer.name())
        self.read(step, lambda: selected_polygon(layer, self._project))

    def _ask_for_points(self) -> None:
        state = self._editing.state()
        dialog = PointsDialog(self._iface.mainWindow(), self._iface.activeLayer(), state.agl, state.agl_unit)

        def take() -> None:
            layer, only, fields = dialog.chosen(), dialog.only_selected(), dialog.fields()
            step = tr("points of {layer}").format(layer=layer.name())
            self.read(step, lambda: points(layer, only, fields, self._project))

        self._open(dialog, take)

    def _ask_for_line(self) -> None:
        state = self._editing.state()
        dialog = LineDialog(self._iface.mainWindow(), self._iface.activeLayer(), state)

        def take() -> None:
            layer, flight, agl_m = dialog.chosen(), dialog.flight, dialog.agl_m
            step = tr("line of {layer}").format(layer=layer.name())
            self.read(
                step,
                lambda: flown_lines(
                    layer, flight(), agl_m(), utc_time(state.start).timestamp(), self._project
                ),
            )

        self._open(dialog, take)

    def _ask_for_pattern(self, way: str) -> None:
        try:
            dialog = pattern_dialog(way, self._iface, self._editing.state(), self._project)
        except InvalidInput as wrong:
            self._refuse(translate(wrong))
            return

        def take() -> None:
            try:
                reading = dialog.reading(self._project)
            except (TerrAInavError, QgsCsException) as wrong:
                self._refuse(translate(wrong))
                return
            self.read(dialog.windowTitle(), lambda: reading)

        self._open(dialog, take)

    def _ask_for_file(self) -> None:
        path, _ = QFileDialog.getOpenFileName(
            self._iface.mainWindow(),
            tr("Text file of points: lat lon agl [yaw], or a table with a header"),
            "",
            tr("Text files (*.txt *.csv *.dat);;All files (*)"),
        )
        if path:
            unit = self._editing.state().agl_unit
            self.read(tr("text file"), lambda: text_file(path, unit))

    @staticmethod
    def _open(dialog: QDialog, take: Callable[[], None]) -> None:
        dialog.accepted.connect(take)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    # --- into the form

    def _take(self, name: str) -> None:
        self._ways[name]()

    def _enter(self, area: Callable[[], Area], step: str, agl_m: float | None = None) -> bool:
        try:
            self._editing.set_area(area(), step, agl_m)
        except (TerrAInavError, QgsCsException) as wrong:
            self._refuse(translate(wrong))
            return False
        return True

    def _take_read(self, task: ReadTask) -> None:
        if task is not self._task:
            return
        self._task = None
        if task.trace:
            self._messages.error(tr("No area: {reason}").format(reason=translate(task.error)), task.trace)
        elif task.error:
            self._refuse(translate(task.error))
        elif task.found is not None:
            area, agl_m, note = task.found
            if self._enter(lambda: area, task.step, agl_m):
                self._show_on_canvas()
                if note:
                    self._messages.info(note)

    def _take_drawn(self, box: Area) -> None:
        self._enter(lambda: box, tr("draw box"))
        self.tool.start()

    def _take_single(self, lat_deg: float, lon_deg: float) -> None:
        state = self._editing.state()
        if self._enter(lambda: Points(((lat_deg, lon_deg, state.agl_m),)), tr("single capture")):
            self.tool.start()

    def _take_moved(self, area: Area, step: str, joined: bool) -> None:
        self._editing.set_area(area, step, joined=joined)

    def _refuse(self, reason: str) -> None:
        self._messages.refused(reason, tr("No area was taken."))

    # --- on the map

    def _switch_tool(self, on: bool) -> None:
        if not on:
            self.tool.stop()
            return
        self._show_on_canvas()
        self.tool.start()

    def _follow(self) -> None:
        state = self._editing.state()
        area = entered_area(state)
        self.tool.length_unit = self._box_tool.length_unit = state.agl_unit
        self.tool.set_area(area)
        self.mark.set_area(area)

    def show_previewed(self, previewed: bool) -> None:
        """Take up whether a preview shows the area."""
        self._previewed = previewed
        self._show_mark()

    def _show_mark(self, *_: object) -> None:
        self.mark.set_shown(self._panel.isUserVisible() and not (self._previewed or self.tool.isActive()))

    def _go_to_typed(self) -> None:
        if entered_area(self._editing.state()) is not None:
            self._show_on_canvas()

    def _show_dragged(self, area: Area) -> None:
        """Show the numbers of what is still being dragged."""
        state = self._editing.state()
        self._entries.show_edges(with_area(state, area))
        self._entries.show_words(area_words(area, state.agl_unit), not isinstance(area, Box))

    def _show_on_canvas(self) -> None:
        """Move the map only where the area could not be seen."""
        area = entered_area(self._editing.state())
        if area is None:
            return
        try:
            crs = self._canvas.mapSettings().destinationCrs()
            rectangle = canvas_rectangle(area.bounds, crs, self._project)
        except InvalidInput as wrong:
            self._messages.warning(translate(wrong))
            return
        wide_px = max(rectangle.width(), rectangle.height()) / self._canvas.mapUnitsPerPixel()
        if 0.0 < wide_px < _DOT_PX or not self._canvas.extent().intersects(rectangle):
            show_extent(self._canvas, rectangle, _MARGIN)
