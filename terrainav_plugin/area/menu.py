"""Menu of the origins of an area."""

from __future__ import annotations

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import pyqtSignal
from qgis.PyQt.QtWidgets import (
    QMenu,
    QPushButton,
)

from ..compat import QAction
from ..i18n import tr
from ..paths import icon


class AreaAction:
    """Names of the menu's entries."""

    DRAW, DRAW_POLYGON, SINGLE, CANVAS = "draw", "draw_polygon", "single", "canvas"
    LAYER, POLYGON, POINTS, LINE = "layer", "polygon", "points", "line"
    CORRIDOR, FACADE, STRUCTURE, ORBIT = "corridor", "facade", "structure", "orbit"
    RANDOM = "random"
    AREA_FILE, FILE, POSES, PASTE = "area_file", "file", "poses", "paste"
    ADD_POLYGON, ADD_HOLE, TO_BOX = "add_polygon", "add_hole", "box"


#: Groups of entries, each entry with name, icon, text and tooltip. An icon with a leading "=" is one of the plugin's.
Entries = tuple[tuple[tuple[str, str, str, str], ...], ...]


class MenuButton(QPushButton):
    """A button with a menu.

    Signals
    -------
    chosen(str)
        The name of an entry.
    """

    chosen = pyqtSignal(str)

    def __init__(self, text: str, name: str, tip: str, entries: Entries) -> None:
        super().__init__(text)
        self.setObjectName(f"{name}_from")
        self.setToolTip(tip)
        menu = QMenu(self)
        menu.setObjectName(f"{name}_menu")
        menu.setToolTipsVisible(True)
        self.actions_by_name: dict[str, QAction] = {}
        for group in entries:
            for way, image, title, about in group:
                action = menu.addAction(
                    icon(image[1:]) if image[0] == "=" else QgsApplication.getThemeIcon(image), title
                )
                action.setObjectName(f"area_{way}")
                action.setToolTip(about)
                action.triggered.connect(lambda _=False, way=way: self.chosen.emit(way))
                self.actions_by_name[way] = action
            menu.addSeparator()
        self.setMenu(menu)


class AreaMenu(MenuButton):
    """A button with a menu of the origins of an area."""

    def __init__(self) -> None:
        super().__init__(
            tr("Area &from"),
            "area",
            tr("Other ways to set the area: the map, a layer, a file, the clipboard, a click"),
            self._entries(),
        )

    def offer_changes(self, is_ground: bool, is_shape: bool) -> None:
        """Enable the changes that the area allows.

        Parameters
        ----------
        is_ground, is_shape : bool
            Whether the area is a box or polygons; whether it consists of polygons or points.
        """
        for name in (AreaAction.ADD_POLYGON, AreaAction.ADD_HOLE):
            self.actions_by_name[name].setEnabled(is_ground)
        self.actions_by_name[AreaAction.TO_BOX].setEnabled(is_shape)

    @staticmethod
    def _entries() -> Entries:
        return (
            (
                (AreaAction.DRAW, "=draw_box", tr("&Draw box"), tr("Press, drag and release on the map")),
                (
                    AreaAction.DRAW_POLYGON,
                    "=draw_polygon",
                    tr("Draw pol&ygon"),
                    tr("Click each corner on the map; a double click, a right click or Enter finishes"),
                ),
                (
                    AreaAction.SINGLE,
                    "=test_shot",
                    tr("&Single capture here…"),
                    tr("Click a point on the map: the mission is one image, straight above it"),
                ),
                (
                    AreaAction.CANVAS,
                    "/mActionZoomFullExtent.svg",
                    tr("&Map canvas extent"),
                    tr("The extent of the map as a box"),
                ),
            ),
            (
                (
                    AreaAction.LAYER,
                    "/mActionZoomToLayer.svg",
                    tr("Extent of a &layer…"),
                    tr("The box around a layer"),
                ),
                (
                    AreaAction.POLYGON,
                    "/mIconPolygonLayer.svg",
                    tr("Poly&gons of a layer…"),
                    tr("The selected polygons, or all, with their holes; images that touch none are left out"),
                ),
                (
                    AreaAction.POINTS,
                    "/mIconPointLayer.svg",
                    tr("P&oints of a layer…"),
                    tr("One image above each point, with height (AGL), attitude and time from fields"),
                ),
                (
                    AreaAction.LINE,
                    "/mIconLineLayer.svg",
                    tr("L&ine of a layer…"),
                    tr("A line flown at a speed, with images at intervals of time or distance"),
                ),
            ),
            (
                (
                    AreaAction.CORRIDOR,
                    "/mActionOffsetCurve.svg",
                    tr("&Corridor along a line…"),
                    tr("Rows along a line that show all of a strip"),
                ),
                (
                    AreaAction.ORBIT,
                    "/mActionAddRing.svg",
                    tr("O&rbit around a point…"),
                    tr("Click a point on the map: circles from which the camera looks at it"),
                ),
                (
                    AreaAction.FACADE,
                    "/mActionOffsetPointSymbols.svg",
                    tr("F&açade along a line…"),
                    tr("Flights along a wall, one above the other; the camera looks at it"),
                ),
                (
                    AreaAction.STRUCTURE,
                    "/mActionFillRing.svg",
                    tr("Str&ucture around a polygon…"),
                    tr("Flights around a building, one above the other; the camera looks at its walls"),
                ),
                (
                    AreaAction.RANDOM,
                    "/algorithms/mAlgorithmRandomPointsWithinPolygon.svg",
                    tr("Ra&ndom poses in the area…"),
                    tr("Images at random places of the area, with random heights, directions and tilts"),
                ),
            ),
            (
                (
                    AreaAction.AREA_FILE,
                    "/mActionFileOpen.svg",
                    tr("Area file (KML, Geo&JSON)…"),
                    tr("All polygons of a KML, KMZ or GeoJSON file, with their holes"),
                ),
                (
                    AreaAction.FILE,
                    "/mIconPointLayer.svg",
                    tr("&Text file of points…"),
                    tr(
                        "Lines of “lat lon agl [yaw]”, in degrees and the unit chosen for the height; or a table whose "
                        "first line names its columns, such as lat, lon, agl, yaw, tilt, roll, time"
                    ),
                ),
                (
                    AreaAction.POSES,
                    "/mIconLineLayer.svg",
                    tr("Trajectory or &flight log…"),
                    tr(
                        "The poses of a GPX track, a PX4 or ArduPilot log, or a TUM, KITTI or EuRoC "
                        "trajectory: one image from each pose, or one every so many seconds or metres"
                    ),
                ),
                (
                    AreaAction.PASTE,
                    "/mActionEditPaste.svg",
                    tr("&Paste coordinates"),
                    tr(
                        "From the clipboard: north_west_south_east_agl, lat_lon_agl, lines of lat lon agl [yaw], or a "
                        "table whose first line names its columns; heights in the unit chosen"
                    ),
                ),
            ),
            (
                (
                    AreaAction.ADD_POLYGON,
                    "=draw_polygon",
                    tr("Add anoth&er polygon"),
                    tr("Draw one more polygon; what it overlaps is joined with it"),
                ),
                (
                    AreaAction.ADD_HOLE,
                    "/mActionAddRing.svg",
                    tr("Cut a &hole"),
                    tr("Draw a hole inside the area"),
                ),
                (
                    AreaAction.TO_BOX,
                    "=draw_box",
                    tr("Make it a &box"),
                    tr("The box around the polygon or the points, instead of them"),
                ),
            ),
        )
