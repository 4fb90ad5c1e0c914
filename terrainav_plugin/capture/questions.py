"""Checks and questions before a run: the folder, the key, and the terms of the source."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.PyQt.QtGui import QTextDocument
from qgis.PyQt.QtWidgets import QMessageBox, QWidget

from ...core.errors import TerrAInavError
from ..i18n import tr, translate
from ..paths import entered_folder, next_folder, path_key
from ..remote.copies import read_only_reason
from ..settings import Settings
from ..sources import credentials_problem, each_imagery, terms_problem

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ..messages import Messages
    from ..sources import MissionPlans
    from .run import BackgroundRun


class Questions:
    """Ask questions before a run, and show each problem at the entry where the user can solve it.

    Parameters
    ----------
    messages : Messages
    window : QWidget
        Parent of dialogs.
    mark : callable
        Shows messages at entries, by field.
    capture_into : callable
        Captures the entered mission into another folder.
    taken : callable
        Returns the folders of this session's runs, including folders that do not exist yet.
    """

    def __init__(
        self,
        messages: Messages,
        window: QWidget,
        mark: Callable[[dict[str, str]], None],
        capture_into: Callable[[Path], None],
        taken: Callable[[], Collection[Path]] = tuple,
    ) -> None:
        self._messages, self._window = messages, window
        self._mark, self._capture_into, self._taken = mark, capture_into, taken

    def has_folder(self, text: str) -> bool:
        """Whether a writable folder is chosen; shows the problem at the field otherwise."""
        if not text.strip():
            message = tr("no folder: choose where to save the images")
        elif not (message := read_only_reason(entered_folder(text))):
            return True
        self._mark({"folder": message})
        self._messages.refused(message, tr("Nothing to capture yet."))
        return False

    def has_usable_keys(self, mission: Mission) -> bool:
        """Whether the keys or authentication of a mission's sources can be used; shows a problem at its entry."""
        for number, (name, one) in enumerate(each_imagery(mission).items()):
            try:
                problem = credentials_problem(one.imagery.source)
            except TerrAInavError as wrong:
                problem = translate(wrong)
            if problem:
                problem = f"{name}: {problem}" if number else problem
                self._mark({"imageries" if number else "key": problem})
                self._messages.refused(problem, tr("Nothing to capture yet."))
                return False
        return True

    def belongs_to_another(self, plans: MissionPlans, folder: Path, *, may_count_on: bool = False) -> bool:
        """Whether the folder holds another mission; if so, use the next free folder if allowed, or offer it."""
        # The run itself reports what cannot be read.
        if plans.are_in(folder) is not False:
            return False
        text = tr("{folder} holds another mission; nothing was changed there.")
        self._offer_other(folder, text, may_count_on=may_count_on)
        return True

    def is_queued(self, mission: Mission, folder: Path, others: list[BackgroundRun]) -> bool:
        """Whether an unfinished run already captures into the folder; reports it."""
        found = next((run for run in others if path_key(run.folder) == path_key(folder)), None)
        if found is None:
            return False
        if found.mission == mission:
            self._messages.info(tr("{name} is already being captured.").format(name=folder.name))
            return True
        text = tr("{folder}: a capture into it is already running; a second mission needs another folder.")
        self._offer_other(folder, text, may_count_on=True)
        return True

    def _offer_other(self, folder: Path, text: str, *, may_count_on: bool) -> None:
        """Use the next free folder if the panel proposed ``folder``; otherwise offer the next free folder.

        Parameters
        ----------
        folder : Path
        text : str
            Why the folder cannot be used.
        may_count_on : bool
            Whether another folder may be used without asking: only if the whole mission is captured.
        """
        other = next_folder(folder, self._taken())
        if may_count_on and path_key(folder) == path_key(entered_folder(Settings().suggested_folder)):
            self._capture_into(other)
            return
        self._messages.warning(
            text.format(folder=folder),
            action=(tr("Capture into {name}").format(name=other.name), lambda: self._capture_into(other)),
        )

    def check_limits(self, plans: MissionPlans) -> bool:
        """Whether the terms of the sources can allow a run, with or without consent; reports it if not."""
        for name, requests in plans.requests.items():
            mission = plans.by_imagery[name].mission
            problem = terms_problem(mission, requests)
            if not (problem is None or problem[1] or self._terms_allow(mission, requests)):
                return False
        return True

    def terms_allow(self, plans: MissionPlans, share: float = 1.0) -> bool:
        """Whether the terms of the sources allow a run of a share of the images; asks where consent is enough."""
        agreed: set[tuple[str, int]] = set()
        for name, requests in plans.requests.items():
            mission = plans.by_imagery[name].mission
            asked = (mission.imagery.source, math.ceil(share * requests))
            # Two dates of a source need one consent.
            if asked not in agreed and not self._terms_allow(mission, asked[1]):
                return False
            agreed.add(asked)
        return True

    def _terms_allow(self, mission: Mission, requests: int) -> bool:
        problem = terms_problem(mission, requests)
        if problem is None:
            return True
        text, can_agree = problem
        window, title = self._window, tr("TerrAInav: terms of the source")
        if not can_agree:
            # A dialog, as the message bar shows only the first lines.
            plain = QTextDocument()
            plain.setHtml(text)
            label = tr("Terms and alternatives")
            self._messages.warning(
                plain.toPlainText(), action=(label, lambda: QMessageBox.warning(window, title, text))
            )
            return False
        asked = tr("Do you agree to these terms, and are you allowed to download?")
        answer = QMessageBox.question(window, title, f"{text}<p>{html.escape(asked)}</p>")
        return answer == QMessageBox.StandardButton.Yes
