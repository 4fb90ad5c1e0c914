"""Connect the sources of areas (the menu and the map tools) to the form."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from qgis.core import QgsCsException, QgsMapLayer, QgsProject, QgsVectorLayer
from qgis.gui import QgisInterface, QgsDockWidget
from qgis.PyQt.QtCore import QObject
from qgis.PyQt.QtWidgets import QApplication, QDialog, QFileDialog

from ...core.errors import InvalidInput, TerrAInavError
from ...core.mission.areas.area import Area, Box, Points, Polygon, Polygons
from ...core.mission.parts import utc_time
from ..compat import POLYGON, VECTOR
from ..form.area import FormError, describe_area, entered_area, entered_no_fly, replace_area
from ..form.mission_form import takeoff, takeoff_text
from ..form.state import FormState
from ..i18n import tr, translate
from ..map.canvas import canvas_lon_lat, canvas_rectangle, is_in_sight, show_extent
from ..messages import Messages
from ..paths import symbol
from ..tasks import single_shot
from .bands import NO_FLY_COLOURS, AreaMark
from .corners import as_polygons, cut_hole, join_polygon, pointed
from .dialogs import LayerDialog, LineDialog, PointsDialog, PolygonDialog, PosesDialog
from .drawing import PolygonTool
from .editing import AreaEditing
from .entries import AreaEntries
from .layers import (
    Found,
    Reading,
    ReadTask,
    area_file,
    flown_lines,
    layer_extent_area,
    no_fly_file,
    points,
    polygons,
    pose_file,
    rectangle_area,
    text_file,
)
from .menu import AreaAction
from .no_fly import NoFlyWay
from .outline import AreaOutline
from .patterns import PATTERNS, OrbitDialog, pattern_dialog
from .tools import AreaTool, BoxTool, PointTool


class AreaControl(QObject):
    """Enter areas into the form, each as one undoable step.

    Parameters
    ----------
    iface : QgisInterface
    panel : QgsDockWidget
        Panel with the entries; while it is visible, the area is marked on the map.
    entries : AreaEntries
    editing : AreaEditing
    messages : Messages
    box_tool : BoxTool
    draw : callable
        Takes a function that begins drawing, and calls it once the map shows something.

    Attributes
    ----------
    tool : AreaTool
        Changes the area on the map.
    polygon_tool, hole_tool, part_tool, no_fly_tool : PolygonTool
        Draw the area, a hole in it, another polygon of it, and a no-fly area.
    takeoff_tool : PointTool
        Picks the take-off point.
    single_tool, orbit_tool : PointTool
        Pick the place of a single capture, and the centre of an orbit.
    mark : AreaMark
        Marks the area on the map while neither ``tool`` nor a preview shows it.
    no_fly_mark, takeoff_mark : AreaMark
        Mark the no-fly areas and the take-off point.
    """

    def __init__(
        self,
        iface: QgisInterface,
        panel: QgsDockWidget,
        entries: AreaEntries,
        editing: AreaEditing,
        messages: Messages,
        box_tool: BoxTool,
        draw: Callable[[Callable[[], None]], None],
    ) -> None:
        super().__init__()
        self._iface, self._panel, self._messages = iface, panel, messages
        self._entries, self._editing, self._box_tool = entries, editing, box_tool
        self._canvas, self._project = iface.mapCanvas(), QgsProject.instance()
        self._task: ReadTask | None = None
        #: Layer in which the user is to select a polygon.
        self._selecting: QgsVectorLayer | None = None
        keys = self._editing.undo_keys
        self.tool = AreaTool(self._canvas, keys)
        self.single_tool, self.orbit_tool = PointTool(self._canvas), PointTool(self._canvas)
        self.polygon_tool = PolygonTool(self._canvas, tr("Click the first corner"))
        self.hole_tool = PolygonTool(self._canvas, tr("Click the first corner of the hole"))
        self.part_tool = PolygonTool(self._canvas, tr("Click the first corner of one more polygon"))
        self.no_fly_tool = PolygonTool(self._canvas, tr("Click the first corner of the no-fly area"), NO_FLY_COLOURS)
        self.takeoff_tool = PointTool(self._canvas)
        self.mark, self._previewed = AreaMark(self._canvas), False
        self.no_fly_mark = AreaMark(self._canvas, NO_FLY_COLOURS)
        self.takeoff_mark = AreaMark(self._canvas, symbol=symbol("takeoff"))
        # After a pause in typing, move the map to the area unless it is in view.
        self._pause = single_shot(self._go_to_typed, self, 600)
        panel.installEventFilter(keys)
        self.tool.setButton(entries.edit)
        entries.edit.clicked.connect(self._switch_tool)
        entries.draw_polygon.clicked.connect(partial(draw, self.polygon_tool.start))
        for menu in (entries.area_from, entries.no_fly_from):
            menu.chosen.connect(self._take)
        self._editing.noted.connect(self._follow)
        self._editing.coordinates_entered.connect(self._pause.start)
        self._editing.history.stepped.connect(self._pause.start)
        # Do not move the map if the user has moved it meanwhile.
        self._canvas.extentsChanged.connect(self._pause.stop)
        self._canvas.mapToolSet.connect(self._show_mark)
        panel.visibilityChanged.connect(self._show_mark)
        self._join_tools()
        self._ways: dict[str, Callable[[], None]] = {
            AreaAction.DRAW: partial(draw, box_tool.start),
            AreaAction.DRAW_POLYGON: partial(draw, self.polygon_tool.start),
            AreaAction.CANVAS: self.take_canvas,
            AreaAction.SINGLE: partial(draw, self.single_tool.start),
            AreaAction.ORBIT: partial(draw, self.orbit_tool.start),
            AreaAction.LAYER: self._ask_for_layer,
            AreaAction.POLYGON: self._take_polygon,
            AreaAction.POINTS: self._ask_for_points,
            AreaAction.LINE: self._ask_for_line,
            **{way: partial(self._ask_for_pattern, way) for way in PATTERNS},
            AreaAction.AREA_FILE: self._ask_for_area_file,
            AreaAction.FILE: self._ask_for_file,
            AreaAction.POSES: self._ask_for_poses,
            AreaAction.PASTE: self.paste,
            AreaAction.ADD_POLYGON: self.part_tool.start,
            AreaAction.ADD_HOLE: self.hole_tool.start,
            AreaAction.TO_BOX: self._editing.make_box,
            NoFlyWay.DRAW: partial(draw, self.no_fly_tool.start),
            NoFlyWay.LAYER: self._ask_for_no_fly_layer,
            NoFlyWay.FILE: self._ask_for_no_fly_file,
        }

    def close(self) -> None:
        """Remove marks and connections for good."""
        if self._task is not None:
            self._task.abandon()
            self._task = None
        self._stop_selecting()
        self._pause.stop()
        self._canvas.extentsChanged.disconnect(self._pause.stop)
        self._canvas.mapToolSet.disconnect(self._show_mark)
        self._panel.visibilityChanged.disconnect(self._show_mark)
        for mark in (self.mark, self.no_fly_mark, self.takeoff_mark):
            mark.close()
        for tool in (*self._polygon_tools(), *self._point_tools(), self.tool):
            tool.stop()
            tool.deleteLater()

    def _polygon_tools(self) -> tuple[PolygonTool, ...]:
        return self.polygon_tool, self.hole_tool, self.part_tool, self.no_fly_tool

    def _point_tools(self) -> tuple[PointTool, ...]:
        return self.takeoff_tool, self.single_tool, self.orbit_tool

    def _join_tools(self) -> None:
        """Connect the map tools, to enter their areas."""
        tool = self.tool
        tool.dragging.connect(self._show_dragged)
        tool.changed.connect(self._take_changed)
        tool.hole_wanted.connect(self.hole_tool.start)
        tool.polygon_wanted.connect(self.part_tool.start)
        tool.takeoff_set.connect(self._take_takeoff)
        tool.refused.connect(lambda reason: self._messages.refused(reason, tr("The area is unchanged.")))
        self._box_tool.drawn.connect(self._take_drawn)
        self.polygon_tool.drawn.connect(self._take_drawn_polygon)
        self.hole_tool.accept = lambda hole: cut_hole(self._polygons(), hole)
        self.hole_tool.drawn.connect(self._take_hole)
        self.part_tool.drawn.connect(self._take_part)
        self.no_fly_tool.drawn.connect(self._take_no_fly)
        for drawing in self._polygon_tools():
            drawing.refused.connect(self._refuse_drawn)
            # Once another tool is chosen, a refused outline no longer matters.
            drawing.deactivated.connect(self._messages.withdraw_refusal)
        self.takeoff_tool.clicked.connect(self._take_takeoff)
        self.single_tool.clicked.connect(self._take_single)
        self.orbit_tool.clicked.connect(self._ask_for_orbit)
        for point in self._point_tools():
            point.refused.connect(self._messages.warning)

    # --- origins of an area

    def take_canvas(self) -> None:
        """Enter the extent of the canvas."""
        settings = self._canvas.mapSettings()
        self._enter(
            lambda: rectangle_area(settings.visibleExtent(), settings.destinationCrs(), self._project),
            tr("map canvas extent"),
        )

    def paste(self) -> None:
        """Enter the coordinates on the clipboard."""
        text = QApplication.clipboard().text()
        if not text.strip():
            self._refuse(tr("the clipboard holds no text; copy coordinates first"))
            return
        try:
            self._editing.set_coordinates(text)
        except FormError as wrong:
            self._refuse(translate(wrong))

    def read(self, step: str, reading: Callable[[], Reading], take: Callable[[Found, str], None] | None = None) -> None:
        """Read an area on a thread, then enter it; abandon a previous reading.

        Parameters
        ----------
        take : callable or None
            Takes the area found and the name of the step; None enters it as the mission's area.
        """
        try:
            task = ReadTask(step, reading())
        except TerrAInavError as wrong:
            self._refuse(translate(wrong))
            return
        if self._task is not None:
            self._task.cancel()
        self._task = task
        task.begin(lambda task: self._take_read(task, take or self._take_area_read))

    def take_extent(self, layer: QgsMapLayer) -> bool:
        """Enter a layer's extent as the area, and show it; returns False for a layer without one."""
        step = tr("extent of {layer}").format(layer=layer.name())
        taken = self._enter(lambda: layer_extent_area(layer, self._project), step)
        if taken:
            self._show_on_canvas()
        return taken

    def _ask_for_layer(self) -> None:
        dialog = LayerDialog(self._iface.mainWindow(), tr("Extent of a layer"), self._iface.activeLayer())
        self._open(dialog, lambda: self.take_extent(dialog.chosen()))

    def _take_polygon(self) -> None:
        layer = self._iface.activeLayer()
        is_polygons = layer is not None and layer.type() == VECTOR and layer.geometryType() == POLYGON
        if is_polygons and layer.selectedFeatureCount():
            self._read_polygon(layer)
            return
        dialog = PolygonDialog(self._iface.mainWindow(), tr("Area from polygons of a layer"), layer)
        dialog.select.clicked.connect(lambda: self._let_select(dialog))
        self._open(dialog, lambda: self._read_polygon(dialog.chosen(), dialog.only_selected()))

    def _let_select(self, dialog: PolygonDialog) -> None:
        """Let the user select a polygon with QGIS's tool; the selection becomes the area."""
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
        """Stop waiting for a selection."""
        layer, self._selecting = self._selecting, None
        if layer is not None:
            layer.selectionChanged.disconnect(self._take_selected)
            layer.willBeDeleted.disconnect(self._stop_selecting)

    def _read_polygon(self, layer: QgsMapLayer, only_selected: bool = True) -> None:
        step = tr("polygons of {layer}").format(layer=layer.name())
        self.read(step, lambda: polygons(layer, self._project, only_selected))

    def _ask_for_no_fly_layer(self) -> None:
        dialog = PolygonDialog(self._iface.mainWindow(), tr("No-fly areas from a layer"), self._iface.activeLayer())
        dialog.select.hide()

        def take() -> None:
            layer, only = dialog.chosen(), dialog.only_selected()
            step = tr("no-fly areas of {layer}").format(layer=layer.name())
            self.read(step, lambda: polygons(layer, self._project, only), self._take_no_fly_read)

        self._open(dialog, take)

    def _ask_for_no_fly_file(self) -> None:
        path = self._area_path(tr("No-fly areas from a file"))
        if path:
            self.read(tr("no-fly areas of a file"), lambda: no_fly_file(path), self._take_no_fly_read)

    def _ask_for_area_file(self) -> None:
        path = self._area_path(tr("Area from a file"))
        if path:
            self.read(tr("area file"), lambda: area_file(path))

    def _area_path(self, title: str) -> str:
        path, _ = QFileDialog.getOpenFileName(
            self._iface.mainWindow(),
            title,
            "",
            tr("Polygons (*.kml *.kmz *.geojson *.json);;All files (*)"),
        )
        return path

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
                lambda: flown_lines(layer, flight(), agl_m(), utc_time(state.start).timestamp(), self._project),
            )

        self._open(dialog, take)

    def _ask_for_pattern(self, way: str) -> None:
        try:
            dialog = pattern_dialog(way, self._iface, self._editing.state())
        except InvalidInput as wrong:
            self._refuse(translate(wrong))
            return
        self._open_pattern(dialog)

    def _ask_for_orbit(self, lat_deg: float, lon_deg: float) -> None:
        lon, lat = pointed(lon_deg, lat_deg)
        self._open_pattern(OrbitDialog(self._iface.mainWindow(), lat, lon))

    def _open_pattern(self, dialog: Any) -> None:
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

    def _ask_for_poses(self) -> None:
        window = self._iface.mainWindow()
        path, _ = QFileDialog.getOpenFileName(
            window,
            tr("Trajectory or flight log"),
            "",
            tr("Trajectories and flight logs (*.gpx *.ulg *.bin *.log *.txt *.csv);;All files (*)"),
        )
        if not path:
            return
        settings = self._canvas.mapSettings()
        dialog = PosesDialog(window, path, self._editing.state())
        with suppress(TerrAInavError):
            # The CRS of an empty map may have no such place.
            dialog.set_origin(
                *canvas_lon_lat(settings.visibleExtent().center(), settings.destinationCrs(), self._project)
            )
        step = tr("poses of {file}").format(file=Path(path).name)
        self._open(dialog, lambda: self.read(step, lambda: pose_file(path, dialog.pose_settings())))

    @staticmethod
    def _open(dialog: QDialog, take: Callable[[], None]) -> None:
        dialog.accepted.connect(take)
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    # --- entering

    def _take(self, name: str) -> None:
        self._ways[name]()

    def _enter(self, area: Callable[[], Area], step: str, agl_m: float | None = None) -> bool:
        try:
            self._editing.set_area(area(), step, agl_m)
        except (TerrAInavError, QgsCsException) as wrong:
            self._refuse(translate(wrong))
            return False
        return True

    def _take_read(self, task: ReadTask, take: Callable[[Found, str], None]) -> None:
        if task is not self._task:
            return
        self._task = None
        if task.trace:
            self._messages.error(tr("No area: {reason}").format(reason=translate(task.error)), task.trace)
        elif task.error:
            self._refuse(translate(task.error))
        elif task.found is not None:
            take(task.found, task.step)

    def _take_area_read(self, found: Found, step: str) -> None:
        area, agl_m, note = found
        if self._enter(lambda: area, step, agl_m):
            self._show_on_canvas()
            if note:
                self._messages.info(note)

    def _take_drawn(self, box: Area) -> None:
        self._enter(lambda: box, tr("draw box"))
        self.tool.start()

    def _take_drawn_polygon(self, polygon: Polygon) -> None:
        self._enter(lambda: polygon, tr("draw polygon"))
        self.tool.start()

    def _polygons(self) -> Polygon | Polygons:
        """Polygons of the area; raises InvalidInput if the area has none."""
        area = entered_area(self._editing.state())
        found = None if area is None else as_polygons(area)
        if found is None:
            raise InvalidInput(tr("the area has no polygons"))
        return found

    def _take_hole(self, hole: Polygon) -> None:
        self._enter(lambda: cut_hole(self._polygons(), hole), tr("cut a hole"))
        self.tool.start()

    def _take_part(self, polygon: Polygon) -> None:
        self._enter(lambda: join_polygon(self._polygons(), polygon), tr("add a polygon"))
        self.tool.start()

    def _take_no_fly(self, polygon: Polygon) -> None:
        self._add_no_fly((polygon,), tr("draw a no-fly area"))

    def _take_no_fly_read(self, found: Found, step: str) -> None:
        self._add_no_fly(found.area.parts, step)
        self._show_on_canvas(found.area)

    def _add_no_fly(self, added: tuple[Polygon, ...], step: str) -> None:
        """Add no-fly areas, except those already entered."""
        self._editing.set_no_fly(tuple(dict.fromkeys((*entered_no_fly(self._editing.state()), *added))), step)

    def _take_takeoff(self, lat_deg: float, lon_deg: float) -> None:
        lon, lat = pointed(lon_deg, lat_deg)
        self._editing.set_takeoff(takeoff_text((lat, lon)), tr("set take-off point"))

    def _take_single(self, lat_deg: float, lon_deg: float) -> None:
        state = self._editing.state()
        if self._enter(lambda: Points(((lat_deg, lon_deg, state.agl_m),)), tr("single capture")):
            self.tool.start()

    def _take_changed(self, area: Area, step: str, joined: bool) -> None:
        self._editing.set_area(area, step, joined=joined)

    def _refuse(self, reason: str) -> None:
        self._messages.refused(reason, tr("No area was taken."))

    def _refuse_drawn(self, reason: str) -> None:
        self._messages.refused(reason, tr("Go on drawing; Backspace removes the last corner."))

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
        for tool in (self.tool, self._box_tool, *self._polygon_tools()):
            tool.length_unit = state.agl_unit
        self.tool.set_area(area)
        self.mark.set_area(area)
        no_fly = entered_no_fly(state)
        self.no_fly_mark.set_area(Polygons(no_fly) if no_fly else None)
        self.takeoff_mark.set_area(_takeoff_place(state))

    def show_previewed(self, previewed: bool) -> None:
        """Note whether a preview shows the area."""
        self._previewed = previewed
        self._show_mark()

    def _show_mark(self, *_: object) -> None:
        seen = self._panel.isUserVisible()
        self.mark.set_shown(seen and not (self._previewed or self.tool.isActive()))
        for mark in (self.no_fly_mark, self.takeoff_mark):
            mark.set_shown(seen)

    def _go_to_typed(self) -> None:
        if entered_area(self._editing.state()) is not None:
            self._show_on_canvas()

    def _show_dragged(self, area: Area) -> None:
        """Show in the entries the coordinates of an area while it is dragged."""
        state = self._editing.state()
        self._entries.show_edges(replace_area(state, area))
        self._entries.show_description(
            describe_area(area, state.agl_unit),
            not isinstance(area, Box),
            is_ground=area.covers_ground,
        )

    def _show_on_canvas(self, area: Area | None = None) -> None:
        """Move the map to an area, by default the mission's, unless it is in view."""
        area = entered_area(self._editing.state()) if area is None else area
        if area is None:
            return
        try:
            crs = self._canvas.mapSettings().destinationCrs()
            rectangle = canvas_rectangle(area.bounds, crs, self._project)
        except InvalidInput as wrong:
            self._messages.warning(translate(wrong))
            return
        if not (is_in_sight(self._canvas, rectangle) and self._is_any_visible(area)):
            # Show the area with a margin.
            show_extent(self._canvas, rectangle, 1.5)

    def _is_any_visible(self, area: Area) -> bool:
        """Whether any point of an area of points is in view; True for other areas, whose bounds decide."""
        if area.covers_ground:
            return True
        view = self._canvas.extent()
        crs = self._canvas.mapSettings().destinationCrs()
        shape = AreaOutline(area, crs, self._project, view.center().x()).shape
        return shape.intersects(view)


def _takeoff_place(state: FormState) -> Points | None:
    """Take-off point entered; None if missing or invalid."""
    try:
        place = takeoff(state)
    except TerrAInavError:
        return None
    # Any height will do, as the mark is drawn without it.
    return None if place is None else Points(((*place, 1.0),))
