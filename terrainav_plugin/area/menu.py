"""The menu of what an area may be taken from."""

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


class Way:
    """Ways to an area, by the names of the menu's entries."""

    DRAW, SINGLE = "draw", "single"
    CANVAS, LAYER, POLYGON, POINTS, LINE = "canvas", "layer", "polygon", "points", "line"
    CORRIDOR, FACADE, STRUCTURE, ORBIT = "corridor", "facade", "structure", "orbit"
    RANDOM = "random"
    FILE, PASTE, TO_BOX = "file", "paste", "box"


class AreaMenu(QPushButton):
    """A button with that menu.

    Signals
    -------
    chosen(str)
        A `Way`.
    """

    chosen = pyqtSignal(str)

    def __init__(self) -> None:
        super().__init__(tr("Area &from"))
        self.setObjectName("area_from")
        self.setToolTip(tr("Other ways to an area: the map, a layer, a file, the clipboard, a click"))
        menu = QMenu(self)
        menu.setObjectName("area_menu")
        menu.setToolTipsVisible(True)
        self.actions_by_name: dict[str, QAction] = {}
        for group in self._entries():
            for name, image, text, tip in group:
                action = menu.addAction(
                    icon(image[1:]) if image[0] == "=" else QgsApplication.getThemeIcon(image), text
                )
                action.setObjectName(f"area_{name}")
                action.setToolTip(tip)
                action.triggered.connect(lambda _=False, name=name: self.chosen.emit(name))
                self.actions_by_name[name] = action
            menu.addSeparator()
        self.setMenu(menu)

    def offer_box(self, possible: bool) -> None:
        """Offer the way back to a box only where there is something else."""
        self.actions_by_name[Way.TO_BOX].setEnabled(possible)

    @staticmethod
    def _entries() -> tuple[tuple[tuple[str, str, str, str], ...], ...]:
        """Name, icon, text and tooltip of each entry, in groups."""
        return (
            (
                (Way.DRAW, "=draw_box", tr("&Draw box"), tr("Press, drag and release on the map")),
                (
                    Way.CANVAS,
                    "/mActionZoomFullExtent.svg",
                    tr("&Map canvas extent"),
                    tr("The box of what the map shows now"),
                ),
                (
                    Way.SINGLE,
                    "=test_shot",
                    tr("&Single capture here…"),
                    tr("Click a point on the map: the mission is one image, straight above it"),
                ),
            ),
            (
                (
                    Way.LAYER,
                    "/mActionZoomToLayer.svg",
                    tr("Extent of a &layer…"),
                    tr("The box around a layer"),
                ),
                (
                    Way.POLYGON,
                    "/mIconPolygonLayer.svg",
                    tr("Selected pol&ygon…"),
                    tr("One selected polygon, with its holes; images that do not touch it are left out"),
                ),
                (
                    Way.POINTS,
                    "/mIconPointLayer.svg",
                    tr("P&oints of a layer…"),
                    tr("One image above each point, with height (AGL), attitude and time from fields"),
                ),
                (
                    Way.LINE,
                    "/mIconLineLayer.svg",
                    tr("L&ine of a layer…"),
                    tr("A line flown at a speed, with an image each so many seconds or metres"),
                ),
            ),
            (
                (
                    Way.CORRIDOR,
                    "/mActionOffsetCurve.svg",
                    tr("&Corridor along a line…"),
                    tr("Rows along a line that show all of a strip"),
                ),
                (
                    Way.ORBIT,
                    "/mActionAddRing.svg",
                    tr("O&rbit around a point…"),
                    tr("Circles from which the camera looks at a point"),
                ),
                (
                    Way.FACADE,
                    "/mActionOffsetPointSymbols.svg",
                    tr("F&açade along a line…"),
                    tr("Flights along a wall, one above the other; the camera looks at it"),
                ),
                (
                    Way.STRUCTURE,
                    "/mActionFillRing.svg",
                    tr("Str&ucture around a polygon…"),
                    tr("Flights around a building, one above the other; the camera looks at its walls"),
                ),
                (
                    Way.RANDOM,
                    "/algorithms/mAlgorithmRandomPointsWithinPolygon.svg",
                    tr("Ra&ndom poses in the area…"),
                    tr("Images at random places of the area, with random heights, directions and tilts"),
                ),
            ),
            (
                (
                    Way.FILE,
                    "/mActionFileOpen.svg",
                    tr("&Text file of points…"),
                    tr(
                        "Lines of “lat lon agl [yaw]”, in degrees and the unit chosen for the height; or a table whose "
                        "first line names its columns, such as lat, lon, agl, yaw, tilt, roll, time"
                    ),
                ),
                (
                    Way.PASTE,
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
                    Way.TO_BOX,
                    "=draw_box",
                    tr("Make it a &box"),
                    tr("The box around the polygon or the points, instead of them"),
                ),
            ),
        )
