"""Menu of the origins of no-fly areas."""

from __future__ import annotations

from ..i18n import tr
from .menu import MenuButton


class NoFlyWay:
    """Names of the menu's entries."""

    DRAW, LAYER, FILE = "draw_no_fly", "no_fly_layer", "no_fly_file"


class NoFlyMenu(MenuButton):
    """A button with a menu of the origins of no-fly areas."""

    def __init__(self) -> None:
        super().__init__(
            tr("No-fly areas"),
            "no_fly",
            tr("Ground over which no image is taken: drawn, from a layer or from a file"),
            (
                (
                    (
                        NoFlyWay.DRAW,
                        "=no_fly",
                        tr("&Draw no-fly area"),
                        tr("Click each corner on the map; a double click, a right click or Enter finishes"),
                    ),
                    (
                        NoFlyWay.LAYER,
                        "/mIconPolygonLayer.svg",
                        tr("No-fly areas from &layer…"),
                        tr("Polygons of a layer, all or those selected"),
                    ),
                    (
                        NoFlyWay.FILE,
                        "/mActionFileOpen.svg",
                        tr("No-fly areas from &file…"),
                        tr("All polygons of a KML, KMZ or GeoJSON file"),
                    ),
                ),
            ),
        )
