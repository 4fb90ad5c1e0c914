"""The plugin's page among QGIS's options; the page itself is made when it is looked at."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from qgis.gui import QgsOptionsWidgetFactory
from qgis.PyQt.QtWidgets import QWidget

from .paths import icon

if TYPE_CHECKING:
    from .panel.options_page import OptionsPage

TITLE = "TerrAInav"
#: By which QGIS finds the page to open its options at.
PAGE = "terrainav_options"


class OptionsFactory(QgsOptionsWidgetFactory):
    """Makes the page.

    Parameters
    ----------
    applied : callable
        Called after settings were kept.
    """

    def __init__(self, applied: Callable[[], None]) -> None:
        super().__init__(TITLE, icon("icon"))
        self._applied = applied

    def createWidget(self, parent: QWidget | None = None) -> OptionsPage:
        """Make the page, each time the options are opened."""
        from .panel.options_page import OptionsPage

        return OptionsPage(parent, self._applied)
