"""The list of sources, kept up to date as layers and the user's sources are added and removed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from qgis.core import QgsProject
from qgis.PyQt.QtCore import QObject
from qgis.PyQt.QtWidgets import QMessageBox, QWidget

from ...core.errors import TerrAInavError
from ..i18n import tr, translate
from ..messages import Messages
from ..plain import shown_plain
from ..settings import Settings
from ..tasks import single_shot
from .choices import source_choices
from .imagery import ImageryEntries
from .options_page import CacheDialog
from .source_dialogs import AddSourceDialog

if TYPE_CHECKING:
    from ...core.mission.areas.area import Box


class SourceList(QObject):
    """Keep the source chooser up to date.

    Parameters
    ----------
    project : QgsProject
    imagery : ImageryEntries
    messages : Messages
    window : QWidget
        Parent of dialogs.
    visible_box : callable
        Returns the extent of the map as a box; None if that is impossible.
    """

    def __init__(
        self,
        project: QgsProject,
        imagery: ImageryEntries,
        messages: Messages,
        window: QWidget,
        visible_box: Callable[[], Box | None],
    ) -> None:
        super().__init__()
        self._project, self._imagery, self._messages, self._window = project, imagery, messages, window
        self._checked_features = visible_box
        self._told = ""
        # Layers may be added and removed in groups: update once for all.
        self._soon = single_shot(self.refresh, self)
        self._signals = (
            project.layersAdded,
            project.layersRemoved,
            project.cleared,
            project.layerTreeRoot().nameChanged,
        )
        for signal in self._signals:
            signal.connect(self._changed)
        imagery.add_source_clicked.connect(self.add)
        imagery.remove_source_clicked.connect(self.remove)
        imagery.cache_clicked.connect(self.show_cache)
        imagery.service_chosen.connect(self.choose_layer)
        imagery.imagery_wanted.connect(self.ask_imagery)
        # Update before the list opens, as QGIS emits no signal when connections are added or removed.
        imagery.source.about_to_open.connect(self.refresh)
        self.refresh()

    def close(self) -> None:
        """Stop for good."""
        self._soon.stop()
        for signal in self._signals:
            signal.disconnect(self._changed)

    def refresh(self) -> None:
        """Offer the current sources."""
        choices, problem = source_choices(self._project)
        self._imagery.set_choices(choices)
        if problem and problem != self._told:
            self._messages.warning(tr("Some of your own sources are left out: {reason}").format(reason=problem))
        self._told = problem

    def add(self) -> None:
        """Ask for a source, save it and choose it."""

        def place() -> tuple[float, float] | None:
            box = self._checked_features()
            if box is None:
                return None
            return (box.north_deg + box.south_deg) / 2.0, (box.west_deg + box.continuous_east_deg) / 2.0

        dialog = AddSourceDialog(self._window, place)
        if dialog.exec() and dialog.added:
            self.refresh()
            self._imagery.choose_source(dialog.added)
        dialog.deleteLater()

    def choose_layer(self, name: str) -> None:
        """Ask for a layer of a QGIS service, save it as a source and choose it."""
        from ..qgis_source.connections import service
        from .source_dialogs import ServiceDialog

        dialog = ServiceDialog(service(name), self._window)
        if dialog.exec() and dialog.added:
            self.refresh()
            self._imagery.choose_source(dialog.added)
        dialog.deleteLater()

    def ask_imagery(self, text: str) -> None:
        """Ask for another imagery of the mission, or change the one of a text."""
        from ...core.mission.imageries import NamedImagery
        from .imagery_dialog import ImageryDialog

        others = self._imagery.others
        given = NamedImagery.parse(text) if text else None
        taken = [name for name in others.names() if given is None or name != given.name]
        dialog = ImageryDialog(self._window, self._imagery.choices(), taken, given)
        # Sources are added and chosen in the dialog as in the panel.
        sources = SourceList(self._project, dialog.entries, self._messages, dialog, self._checked_features)
        if dialog.exec() and dialog.imagery is not None:
            others.put(dialog.imagery, text)
        sources.close()
        dialog.deleteLater()

    def remove(self) -> None:
        """Remove the chosen source of the user, after asking."""
        from ...core.imagery.catalogue import remove

        choice = self._imagery.choice()
        answer = QMessageBox.question(
            self._window,
            tr("TerrAInav: remove source"),
            shown_plain(tr("Remove “{title}” from your sources? Captured images stay.").format(title=choice.title)),
        )
        if answer != QMessageBox.StandardButton.Yes:
            return
        try:
            remove(choice.name)
            Settings().set_authcfg(choice.name, "")
        except TerrAInavError as wrong:
            self._messages.warning(translate(wrong))
        self.refresh()

    def show_cache(self) -> None:
        """Show the contents of the cache."""
        dialog = CacheDialog(self._window)
        dialog.exec()
        dialog.deleteLater()

    def _changed(self, *_: object) -> None:
        self._soon.start()
