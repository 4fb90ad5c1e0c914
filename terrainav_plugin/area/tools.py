"""Map tools for areas: draw a box, pick a point, move an area, drag the edges of a box or corners of polygons."""

from __future__ import annotations

import math
from collections.abc import Callable

from qgis.core import QgsCsException, QgsGeometry, QgsPointXY, QgsProject, QgsRectangle
from qgis.gui import QgsMapCanvas, QgsMapMouseEvent, QgsRubberBand
from qgis.PyQt.QtCore import QEvent, QObject, QPoint, Qt, pyqtSignal
from qgis.PyQt.QtGui import QKeyEvent
from qgis.PyQt.QtWidgets import QApplication, QMenu

from ...core.errors import TerrAInavError
from ...core.mission.areas.area import Area, Box, Polygon, Polygons
from ..compat import POLYGON
from ..form.area import readout
from ..i18n import tr, translate
from ..map.canvas import ClickTool, TemporaryTool
from ..units import METRES
from .bands import AreaBands, PointerText, area_band
from .corners import (
    as_polygons,
    checked,
    find_polygon,
    insert_corner,
    is_sound,
    move_corner,
    without_corner,
    without_hole,
    without_polygon,
)
from .layers import rectangle_area
from .outline import (
    AreaOutline,
    Corner,
    area_middle,
    contains,
    find_corner,
    find_edge,
    find_grip,
    moved,
    point_lon_lat,
    stretched,
)

#: Distance in screen pixels within which the pointer grips an edge, a corner or a point.
_REACH_PX = 8.0
_ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}
#: Cursors for the directions of dragging, at every eighth of a turn from east.
_CURSORS = (
    Qt.CursorShape.SizeHorCursor,
    Qt.CursorShape.SizeBDiagCursor,
    Qt.CursorShape.SizeVerCursor,
    Qt.CursorShape.SizeFDiagCursor,
)


class BoxTool(TemporaryTool):
    """Draw a rectangle on the canvas, and emit its area on the ground, in any project CRS.

    Signals
    -------
    drawn(object)
        The `Box`, or a `Polygon` if the box would be much larger, after the mouse is released.
    refused(str)
        Why the rectangle has no area on the ground.
    """

    drawn = pyqtSignal(object)
    refused = pyqtSignal(str)
    is_resumed = False

    def __init__(self, canvas: QgsMapCanvas) -> None:
        super().__init__(canvas)
        #: Unit of sizes shown at the pointer.
        self.length_unit = METRES
        self._band: QgsRubberBand | None = None
        self._readout = PointerText(canvas)
        self._pressed_at: QPoint | None = None
        self._start: QgsPointXY | None = None
        self._given_up = False

    def canvasPressEvent(self, event: QgsMapMouseEvent) -> None:
        """Start a box."""
        if event.button() == Qt.MouseButton.LeftButton:
            self._pressed_at = event.pos()
            # Keep the corner in map units, as the wheel may zoom the map.
            self._start = self.toMapCoordinates(event.pos())

    def canvasMoveEvent(self, event: QgsMapMouseEvent) -> None:
        """Stretch the box."""
        if self._pressed_at is not None:
            self._show(self._rectangle(event.pos()))
            self._say_size(event.pos())

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """Finish the box; a click without dragging draws no box."""
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._pressed_at is None:
            if self._given_up:
                self.stop()
            return
        moved = (event.pos() - self._pressed_at).manhattanLength()
        rectangle = self._rectangle(event.pos())
        if moved < QApplication.startDragDistance() or rectangle.width() == 0 or rectangle.height() == 0:
            self._clear()
            return
        try:
            area = self._area(event.pos())
        except (TerrAInavError, QgsCsException) as wrong:
            self.refused.emit(translate(wrong))
            return
        finally:
            self._clear()
        self.stop()
        self.drawn.emit(area)

    def give_up(self) -> None:
        """Discard the box; leave the tool only after the button is up, as another tool would receive the release."""
        if self._pressed_at is None:
            self.stop()
        else:
            self._clear()
            self._given_up = True

    def deactivate(self) -> None:
        """Discard an unfinished box."""
        self._clear()
        self._given_up = False
        super().deactivate()

    def _rectangle(self, released_at: QPoint) -> QgsRectangle:
        return QgsRectangle(self._start, self.toMapCoordinates(released_at))

    def _show(self, rectangle: QgsRectangle) -> None:
        if self._band is None:
            self._band = area_band(self.canvas())
        self._band.reset(POLYGON)
        west, south, east, north = (
            rectangle.xMinimum(),
            rectangle.yMinimum(),
            rectangle.xMaximum(),
            rectangle.yMaximum(),
        )
        for x, y in ((west, south), (east, south), (east, north)):
            self._band.addPoint(QgsPointXY(x, y), False)
        self._band.addPoint(QgsPointXY(west, north), True)

    def _say_size(self, at: QPoint) -> None:
        """Show the size of the box next to the pointer; nothing if it has no area on the ground."""
        try:
            text = readout(self._area(at), self.length_unit)
        except (TerrAInavError, QgsCsException):
            text = ""
        self._readout.say(text, at)

    def _area(self, at: QPoint) -> Area:
        return rectangle_area(self._rectangle(at), self.canvas().mapSettings().destinationCrs(), QgsProject.instance())

    def _clear(self) -> None:
        self._readout.clear()
        self._pressed_at = self._start = None
        if self._band is not None:
            self.canvas().scene().removeItem(self._band)
            self._band = None


class PointTool(ClickTool):
    """Emit the place of one click, and leave the canvas."""

    is_resumed = False

    def _take(self, lat_deg: float, lon_deg: float) -> None:
        self.stop()
        super()._take(lat_deg, lon_deg)


class AreaTool(TemporaryTool):
    """Show the area on the map; dragging moves the area, the edges of a box or a corner of polygons.

    Dragging an edge of polygons adds a corner; a right click on a corner, or the Delete key, removes it. A right click
    elsewhere opens a menu of changes. Dragging outside the area moves the map, as in other tools.

    Signals
    -------
    dragging(object)
        The area while it is dragged; after Esc, the previous area.
    changed(object, str, bool)
        The area, the name of the step, and whether to merge the step with a preceding one of the same name.
    hole_wanted(), polygon_wanted()
        The user wants to draw a hole, or another polygon.
    takeoff_set(float, float)
        Latitude and longitude of a take-off point.
    refused(str)
        Why a change is invalid.
    """

    dragging = pyqtSignal(object)
    changed = pyqtSignal(object, str, bool)
    hole_wanted = pyqtSignal()
    polygon_wanted = pyqtSignal()
    takeoff_set = pyqtSignal(float, float)
    refused = pyqtSignal(str)

    def __init__(self, canvas: QgsMapCanvas, undo_keys: QObject) -> None:
        super().__init__(canvas)
        self._undo_keys = undo_keys
        #: Unit of sizes shown at the pointer.
        self.length_unit = METRES
        self._area: Area | None = None
        self._dragged: Area | None = None
        self._outline: AreaOutline | None = None
        self._grip: frozenset[str] = frozenset()
        #: Corner being dragged, and the polygons with it; dragging an edge has added it to these.
        self._held: Corner | None = None
        self._held_in: Polygon | Polygons | None = None
        #: Last corner that was at the pointer.
        self._picked: Corner | None = None
        self._menu: QMenu | None = None
        self._from: tuple[float, float] | None = None
        self._pressed_at: QPoint | None = None
        self._panned_from: QgsPointXY | None = None
        self._bands, self._readout = AreaBands(canvas), PointerText(canvas)

    def set_area(self, area: Area | None) -> None:
        """Set the area; None clears it."""
        if area != self._area:
            # In the new area, the same indices may denote another corner.
            self._picked = None
        self._area = area
        if not self.isActive():
            return
        if area is None:
            self.stop()
        elif self._dragged is None:
            self._draw()

    # --- starting and stopping

    def activate(self) -> None:
        """Show the area."""
        super().activate()
        canvas = self.canvas()
        canvas.installEventFilter(self._undo_keys)
        canvas.destinationCrsChanged.connect(self._draw)
        # Redraw, as a geographic map may now show another turn around the Earth.
        canvas.extentsChanged.connect(self._draw)
        self.setCursor(Qt.CursorShape.ArrowCursor)
        self._draw()

    def deactivate(self) -> None:
        """Hide the area, and undo an unfinished drag."""
        canvas = self.canvas()
        canvas.extentsChanged.disconnect(self._draw)
        canvas.destinationCrsChanged.disconnect(self._draw)
        canvas.removeEventFilter(self._undo_keys)
        self._put_back()
        self._panned_from = self._picked = None
        self._close_menu()
        self._bands.clear()
        self._readout.clear()
        self._outline = None
        super().deactivate()

    def give_up(self) -> None:
        """Undo an unfinished drag; if there is none, leave the tool."""
        if not self._put_back():
            self.stop()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Move the area by arrow keys, which would otherwise move the map; remove a corner by Delete or Backspace."""
        if (
            isinstance(event, QKeyEvent)
            and event.key() in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace)
            and self._picked is not None
        ):
            if event.type() == QEvent.Type.ShortcutOverride:
                # Accept the key, as the window's shortcut would delete features.
                event.accept()
                return True
            if event.type() == QEvent.Type.KeyPress:
                if self._dragged is None:
                    self._remove_corner(self._picked)
                return True
        pressed = event.type() == QEvent.Type.KeyPress and self._area is not None
        if pressed and isinstance(event, QKeyEvent) and event.key() in _ARROWS:
            if self._dragged is None:
                self._step(event)
            return True
        return super().eventFilter(watched, event)

    # --- the mouse

    def canvasPressEvent(self, event: QgsMapMouseEvent) -> None:
        """Begin dragging the area or, outside it, the map."""
        if event.button() != Qt.MouseButton.LeftButton or self._area is None:
            return
        self._grip, self._held = self._find_grip(event.pos()), self._find_corner(event.pos())
        edge = None if self._held is not None else self._find_edge(event.pos())
        if not (self._grip or self._held or edge or self._is_at_area(event.pos())):
            self._panned_from = self.toMapCoordinates(event.pos())
            return
        self._from = self._place(event.pos())
        if self._from is None:
            return
        self._pressed_at, self._dragged = event.pos(), self._area
        if edge is not None:
            self._held = Corner(edge.part, edge.ring, edge.at + 1)
            self._dragged = insert_corner(self._area, edge, *self._from)
        self._held_in = None if self._held is None else self._dragged
        self._picked = self._held
        self._draw()

    def canvasMoveEvent(self, event: QgsMapMouseEvent) -> None:
        """Drag, or show what can be dragged."""
        if self._panned_from is not None:
            self._pan_map(event.pos())
        elif self._dragged is None:
            self._show_cursor(event.pos())
        elif event.pos() != self._pressed_at:
            self._pressed_at = None
            self._drag_box(event.pos())

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """End dragging; the right button removes a corner or opens the menu."""
        if event.button() == Qt.MouseButton.RightButton:
            self._ask(event)
        if event.button() != Qt.MouseButton.LeftButton:
            return
        if self._panned_from is not None:
            self._panned_from = None
            return
        if self._dragged is None:
            return
        # Qt does not report every move, and may skip the last one.
        if event.pos() != self._pressed_at:
            self._drag_box(event.pos())
        held, is_new = self._held, self._held_in is not self._area
        moved_area, self._dragged, self._from = self._dragged, None, None
        self._held = self._held_in = None
        self._readout.clear()
        if moved_area is self._area:
            self._draw()
        elif held is not None:
            self._take_corner(moved_area, tr("add a corner") if is_new else tr("move a corner"))
            # Pick the new corner at the pointer, as no move may follow.
            self._picked = self._find_corner(event.pos())
            self._draw()
        else:
            named = self._grip and isinstance(moved_area, Box)
            self.changed.emit(moved_area, tr("drag an edge") if named else tr("move the area"), False)

    # --- implementation

    def _drag_box(self, at: QPoint) -> None:
        place = self._place(at)
        if place is None or self._area is None or self._from is None:
            return
        dlon = place[0] - self._from[0]
        dlon -= 360.0 * round(dlon / 360.0)
        dlat = place[1] - self._from[1]
        if self._held is not None and self._held_in is not None:
            self._dragged = move_corner(self._held_in, self._held, dlat, dlon)
        elif self._grip and isinstance(self._area, Box):
            self._dragged = stretched(self._area, self._grip, dlat, dlon)
        else:
            self._dragged = moved(self._area, dlat, dlon)
        self._draw()
        self._readout.say(self._readout_text(), at)
        self.dragging.emit(self._dragged)

    def _readout_text(self) -> str:
        """Readout of the area being dragged."""
        if self._held is not None and not is_sound(self._dragged) and is_sound(self._area):
            return tr("The outline would cross itself")
        return readout(self._dragged, self.length_unit)

    def _put_back(self) -> bool:
        """Undo an unfinished drag, and return whether there was one."""
        if self._dragged is None:
            return False
        self._dragged = self._from = self._held = self._held_in = None
        self._readout.clear()
        self._draw()
        self.dragging.emit(self._area)
        return True

    # --- corners, holes and parts

    def _take_corner(self, area: Polygon | Polygons, step: str) -> None:
        """Emit an area with a changed corner, unless outlines cross."""
        self._change(lambda: checked(self._area, area), step)

    def _remove_corner(self, corner: Corner) -> None:
        self._change(lambda: without_corner(self._area, corner), tr("remove a corner"))

    def _change(self, change: Callable[[], Area], step: str) -> None:
        """Emit the changed area, or the reason why the change is invalid."""
        try:
            area = change()
        except TerrAInavError as wrong:
            self._draw()
            self.dragging.emit(self._area)
            self.refused.emit(translate(wrong))
            return
        self.changed.emit(area, step, False)

    def _ask(self, event: QgsMapMouseEvent) -> None:
        """Remove the corner at the pointer; elsewhere open a menu of changes."""
        if self._dragged is not None or self._area is None:
            return
        corner = self._find_corner(event.pos())
        if corner is not None:
            self._remove_corner(corner)
            return
        area = as_polygons(self._area)
        if area is None:
            return
        self._close_menu()
        self._menu = self._open_menu(area, event.pos())
        self._menu.popup(self.canvas().viewport().mapToGlobal(event.pos()))

    def _open_menu(self, area: Polygon | Polygons, at: QPoint) -> QMenu:
        menu = QMenu(self.canvas())
        menu.setObjectName("edit_area_menu")
        place, edge = self._place(at), self._find_edge(at)
        inside = None if place is None else find_polygon(area, *place)
        entries: list[tuple[str, str, Callable[[], None]]] = []
        if edge is not None and place is not None:
            entries.append(
                (
                    "add_corner",
                    tr("Add a &corner here"),
                    lambda: self._take_corner(insert_corner(area, edge, *place), tr("add a corner")),
                )
            )
        if isinstance(self._area, Box):
            entries.append(
                (
                    "to_polygon",
                    tr("Make it a &polygon"),
                    lambda: self.changed.emit(area, tr("make it a polygon"), False),
                )
            )
        entries.append(("add_hole", tr("Cut a &hole"), self.hole_wanted.emit))
        entries.append(("add_polygon", tr("Add anoth&er polygon"), self.polygon_wanted.emit))
        if inside is not None and inside[1]:
            entries.append(
                (
                    "remove_hole",
                    tr("&Remove this hole"),
                    lambda: self._change(lambda: without_hole(area, *inside), tr("remove a hole")),
                )
            )
        elif inside is not None and isinstance(area, Polygons):
            entries.append(
                (
                    "remove_polygon",
                    tr("Re&move this polygon"),
                    lambda: self._change(lambda: without_polygon(area, inside[0]), tr("remove a polygon")),
                )
            )
        if place is not None:
            lon, lat = place
            entries.append(("set_takeoff", tr("Set &take-off point here"), lambda: self.takeoff_set.emit(lat, lon)))
        for name, text, act in entries:
            action = menu.addAction(text)
            action.setObjectName(name)
            action.triggered.connect(lambda _=False, act=act: act())
        return menu

    def _close_menu(self) -> None:
        if self._menu is not None:
            self._menu.close()
            self._menu.deleteLater()
            self._menu = None

    # --- keys

    def _step(self, event: QKeyEvent) -> None:
        far = event.modifiers() & Qt.KeyboardModifier.ShiftModifier
        pixels = 10 if far else 1
        across, down = (pixels * way for way in _ARROWS[event.key()])
        lon, lat = area_middle(self._area)
        middle = None if self._outline is None else self._outline.project(lon, lat)
        if middle is None:
            return
        aside = self.toMapCoordinates(QPoint(across, down)) - self.toMapCoordinates(QPoint(0, 0))
        crs = self.canvas().mapSettings().destinationCrs()
        there = point_lon_lat(middle + aside, crs, QgsProject.instance())
        if there is not None:
            dlon = there[0] - lon
            area = moved(self._area, there[1] - lat, dlon - 360.0 * round(dlon / 360.0))
            self.changed.emit(area, tr("move by arrow keys"), True)

    def _place(self, at: QPoint) -> tuple[float, float] | None:
        crs = self.canvas().mapSettings().destinationCrs()
        return point_lon_lat(self.toMapCoordinates(at), crs, QgsProject.instance())

    def _draw(self) -> None:
        area = self._area if self._dragged is None else self._dragged
        if area is None or not self.isActive():
            return
        canvas = self.canvas()
        crs = canvas.mapSettings().destinationCrs()
        near = canvas.extent().center().x() if crs.isGeographic() else 0.0
        self._outline = AreaOutline(area, crs, QgsProject.instance(), near)
        self._bands.show(self._outline, with_handles=area.covers_ground, picked=self._picked)

    def _find_grip(self, at: QPoint) -> frozenset[str]:
        if self._outline is None:
            return frozenset()
        return find_grip(self._outline, self.canvas().getCoordinateTransform(), at.x(), at.y(), _REACH_PX)

    def _find_corner(self, at: QPoint) -> Corner | None:
        if self._outline is None:
            return None
        return find_corner(self._outline, self.toMapCoordinates(at), _REACH_PX * self.canvas().mapUnitsPerPixel())

    def _find_edge(self, at: QPoint) -> Corner | None:
        if self._outline is None:
            return None
        # Edges are gripped within a shorter distance than corners, so that small areas can be moved.
        return find_edge(self._outline, self.toMapCoordinates(at), 5.0 * self.canvas().mapUnitsPerPixel())

    def _is_at_area(self, at: QPoint) -> bool:
        place = self._place(at)
        if place is not None and self._area is not None and contains(self._area, *place):
            return True
        return self._is_at_point(at)

    def _is_at_point(self, at: QPoint) -> bool:
        if self._outline is None or self._area is None or self._area.covers_ground or self._outline.shape.isEmpty():
            return False
        reach = _REACH_PX * self.canvas().mapUnitsPerPixel()
        return self._outline.shape.distance(QgsGeometry.fromPointXY(self.toMapCoordinates(at))) <= reach

    def _show_cursor(self, at: QPoint) -> None:
        grip, corner = self._find_grip(at), self._find_corner(at)
        if corner != self._picked:
            self._picked = corner
            self._draw()
        if grip:
            self.setCursor(self._grip_cursor(grip))
        elif corner is not None:
            self.setCursor(Qt.CursorShape.PointingHandCursor)
        elif self._find_edge(at) is not None:
            self.setCursor(Qt.CursorShape.CrossCursor)
        elif self._is_at_area(at):
            self.setCursor(Qt.CursorShape.SizeAllCursor)
        else:
            self.setCursor(Qt.CursorShape.ArrowCursor)

    def _grip_cursor(self, grip: frozenset[str]) -> Qt.CursorShape:
        """Cursor with arrows in the direction from the box's middle to a handle on the screen."""
        if self._area is None or self._outline is None or grip not in self._outline.handles:
            return Qt.CursorShape.SizeAllCursor
        middle = self._outline.project(*area_middle(self._area))
        if middle is None:
            return Qt.CursorShape.SizeAllCursor
        to_pixel = self.canvas().getCoordinateTransform()
        here, there = to_pixel.transform(middle), to_pixel.transform(self._outline.handles[grip])
        # Pixel rows count downwards.
        angle = math.atan2(here.y() - there.y(), there.x() - here.x())
        if len(grip) == 1:
            return _CURSORS[2 * round(angle / (math.pi / 2.0)) % 4]
        return _CURSORS[(2 * math.floor(angle / (math.pi / 2.0)) + 1) % 4]

    def _pan_map(self, at: QPoint) -> None:
        """Move the map so that the gripped place follows the pointer."""
        canvas = self.canvas()
        canvas.setCenter(canvas.center() + (self._panned_from - self.toMapCoordinates(at)))
        canvas.refresh()
