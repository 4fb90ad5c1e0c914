"""Entry of elevation sources: typed, or chosen from the project, public sources and files."""

from __future__ import annotations

from qgis.core import QgsProject, QgsRasterLayer
from qgis.PyQt.QtWidgets import QMenu

from ..form.text import as_written, to_decimal_point
from ..i18n import tr
from ..plain import shown_plain
from ..sources import TERRARIUM, WORLD
from .offers import OfferedLine


class HeightsLine(OfferedLine):
    """Line for elevation sources, with a button that offers sources.

    Parameters
    ----------
    name : str
        Field of the entry.
    tip : str
    """

    def __init__(self, name: str, tip: str) -> None:
        more = tr("Separate several with ; each fills the holes of those before it.")
        super().__init__(name, f"{tip} {more}", tr("Choose a source of heights"))
        self._more: QMenu | None = None

    def words(self) -> tuple[str, ...]:
        """Return the sources entered, with titles replaced by names."""
        names = {title.casefold(): name for title, name in _titled()}
        return tuple(names.get(part.casefold(), to_decimal_point(part)) for part in super().words())

    def enter(self, words: tuple[str, ...]) -> None:
        """Enter sources, with names replaced by titles."""
        titles = {name: title for title, name in _titled()}
        super().enter(tuple(titles.get(word, as_written(word)) for word in words))
        if set(words) <= set(titles):
            # A title is read from its beginning; the end of a path tells more.
            self.setCursorPosition(0)

    def _fill(self) -> None:
        """Fill the menu with the current sources."""
        self._menu.clear()
        if self._more is not None:
            # Delete the menu later: it may contain the action just chosen.
            self._more.deleteLater()
            self._more = None
        for title, source in self._offered():
            self._menu.addAction(shown_plain(title).replace("&", "&&"), lambda source=source: self.enter((source,)))
        self._menu.addSeparator()
        self._menu.addAction(tr("File…"), self._add_file)
        self._menu.addAction(tr("Level ground"), self.clear)
        if self.words():
            self._menu.addSeparator()
            self._more = self._menu.addMenu(tr("Fill its holes from"))
            self._offer_more(self._more)

    def _offer_more(self, menu: QMenu) -> None:
        """Offer further sources, to fill holes in the sources entered."""
        menu.setObjectName(f"{self.objectName()}_more")
        for title, source in self._offered():
            if source not in self.words():
                menu.addAction(
                    shown_plain(title).replace("&", "&&"),
                    lambda source=source: self.enter((*self.words(), source)),
                )
        menu.addAction(tr("File…"), self._add_file)

    @staticmethod
    def _offered() -> list[tuple[str, str]]:
        """Titles and names of sources."""
        project = QgsProject.instance()
        found = []
        # Since QGIS 3.26, a project may have a terrain: flat, or from a layer.
        properties = getattr(project, "elevationProperties", None)
        provider = None if properties is None else properties().terrainProvider()
        terrain = provider.layer() if hasattr(provider, "layer") else None
        if isinstance(terrain, QgsRasterLayer) and _layer_file(terrain):
            found.append((tr("Terrain of the project ({name})").format(name=terrain.name()), _layer_file(terrain)))
        layers = [layer for layer in project.mapLayers().values() if isinstance(layer, QgsRasterLayer)]
        found += [(one.name(), _layer_file(one)) for one in layers if one.bandCount() == 1 and _layer_file(one)]
        return [*found, *_titled()]

    def _add_file(self) -> None:
        self._choose_file(tr("Heights of the ground"), tr("Raster files (*)"))


def _titled() -> list[tuple[str, str]]:
    """Titles and names of the sources that are always available."""
    return [
        (tr("Terrain Tiles (Terrarium, public)"), TERRARIUM),
        (tr("Synthetic landscape (offline)"), WORLD),
    ]


def _layer_file(layer: QgsRasterLayer) -> str:
    """File of a layer with heights; empty if the core cannot read the layer."""
    return str(layer.source()) if layer.providerType() == "gdal" else ""
