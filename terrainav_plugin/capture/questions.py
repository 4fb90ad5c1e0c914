"""Checks and questions before a run: the folder, the key, and the terms of the source."""

from __future__ import annotations

import html
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
from ..sources import credentials_problem, terms_problem

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan
    from ..messages import Messages
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

    def has_usable_key(self, source: str) -> bool:
        """Whether a source's key or authentication can be used; shows the problem at the field otherwise."""
        try:
            problem = credentials_problem(source)
        except TerrAInavError as wrong:
            problem = translate(wrong)
        if problem:
            self._mark({"key": problem})
            self._messages.refused(problem, tr("Nothing to capture yet."))
        return not problem

    def belongs_to_another(self, plan: Plan, folder: Path, *, may_count_on: bool = False) -> bool:
        """Whether the folder holds another mission; if so, use the next free folder if allowed, or offer it."""
        from ...core.capture.folder import holds_mission

        # The run itself reports what cannot be read.
        if holds_mission(plan, folder) is not False:
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

    def check_limits(self, mission: Mission, requests: int) -> bool:
        """Whether a source's terms can allow a run, with or without the user's consent; reports it if not."""
        problem = terms_problem(mission, requests)
        return problem is None or problem[1] or self.terms_allow(mission, requests)

    def terms_allow(self, mission: Mission, requests: int) -> bool:
        """Whether a source's terms allow a run; asks the user if consent is enough."""
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
