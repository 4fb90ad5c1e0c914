"""The captures of this session in the panel: running, waiting and ended."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QObject, QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QResizeEvent
from qgis.PyQt.QtWidgets import (
    QBoxLayout,
    QFrame,
    QHBoxLayout,
    QProgressBar,
    QScrollArea,
    QSizePolicy,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from ..capture.run import BackgroundRun, Stage, row_text, run_title
from ..i18n import tr
from ..paths import icon
from ..widgets import ElidedLabel, named, push_button, tool_button, wrapped_label

if TYPE_CHECKING:
    from ..capture.queue import Runs

#: Height of the panel for each row shown.
_ROW_SHARE_PX = 250


class RunPanel(QObject):
    """Keep the list up to date with the queue of captures.

    Parameters
    ----------
    zoom, open_folder, clean : callable
        Called with a run by the buttons of its row.
    """

    def __init__(
        self,
        runs: Runs,
        shown: RunList,
        zoom: Callable[[BackgroundRun], None],
        open_folder: Callable[[BackgroundRun], None],
        clean: Callable[[BackgroundRun], None],
    ) -> None:
        super().__init__()
        self._runs, self._list = runs, shown
        self._rows: dict[BackgroundRun, RunRow] = {}
        self._actions: dict[str, Callable[[BackgroundRun], None]] = {
            RunRow.PAUSE: lambda run: run.pause(True),
            RunRow.RESUME: runs.resume,
            RunRow.CANCEL: lambda run: run.cancel(),
            RunRow.FAILED: runs.capture_failed,
            RunRow.ZOOM: zoom,
            RunRow.OPEN: open_folder,
            RunRow.CLEAN: clean,
            RunRow.DISMISS: runs.dismiss,
        }
        runs.listed.connect(self._add)
        runs.dismissed.connect(self._remove)
        runs.moved.connect(self._show_all)
        shown.clear_clicked.connect(self._clear)

    def row(self, run: BackgroundRun) -> RunRow:
        """Row of a run."""
        return self._rows[run]

    def _add(self, run: BackgroundRun) -> None:
        row = self._rows[run] = RunRow(run_title(run))
        row.asked.connect(lambda action: self._actions[action](run))
        run.changed.connect(lambda: self._show(run))
        self._show(run)
        self._list.add(row)

    def _remove(self, run: BackgroundRun) -> None:
        row = self._rows.pop(run, None)
        if row is not None:
            self._list.remove(row)
            self._fit()

    def _show_all(self) -> None:
        for run in self._rows:
            self._show(run)

    def _show(self, run: BackgroundRun) -> None:
        row = self._rows.get(run)
        if row is None:
            return
        line = self._runs.waiting
        row.show_progress(run.percent, row_text(run, line.index(run) if run in line else 0))
        row.show_actions(_run_actions(run), run.can_pause, underway=not run.has_ended)
        self._fit()

    def _fit(self) -> None:
        self._list.fit(any(run.has_ended for run in self._rows))

    def _clear(self) -> None:
        """Remove ended runs from the list."""
        for run in [run for run in self._rows if run.has_ended]:
            self._runs.dismiss(run)


class OpeningRow:
    """A row of the list while a dataset is opened.

    Parameters
    ----------
    cancel : callable
        Called by the row's button.
    """

    def __init__(self, shown: RunList, cancel: Callable[[], None]) -> None:
        self._list, self._cancel = shown, cancel
        self._row: RunRow | None = None

    def show(self, name: str, percent: float) -> None:
        """Show the progress of opening a dataset; an empty name removes the row."""
        if not name:
            if self._row is not None:
                self._list.remove(self._row)
                self._row = None
            return
        if self._row is None:
            self._row = RunRow(name)
            self._row.asked.connect(lambda _action: self._cancel())
            self._row.show_actions({RunRow.CANCEL})
            tip = tr("Stop opening this dataset")
            self._row.buttons[RunRow.CANCEL].setToolTip(tip)
            self._row.buttons[RunRow.CANCEL].setAccessibleName(f"{tip} ({name})")
            self._list.add(self._row)
        # The share is known of the mosaics; before, the bar moves.
        self._row.bar.setMaximum(100 if percent else 0)
        self._row.show_progress(percent, tr("Opening; making the mosaic…") if percent else tr("Opening…"))


class RunList(QWidget):
    """List of runs, with a button that removes ended runs if there are several runs; hidden while empty.

    Signals
    -------
    clear_clicked()
    """

    clear_clicked = pyqtSignal()

    def __init__(self) -> None:
        super().__init__()
        self.listed = RunRows()
        self.clear = push_button(
            "clear_finished",
            tr("Clear finished"),
            tr("Remove finished captures from the list (files are kept)"),
        )
        self.clear.clicked.connect(self.clear_clicked)
        self.clear.setEnabled(False)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        layout.addWidget(self.listed)
        layout.addWidget(self.clear, 0, Qt.AlignmentFlag.AlignRight)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.hide()

    @property
    def rows(self) -> list[RunRow]:
        """Rows from top to bottom."""
        return self.listed.rows

    def add(self, row: RunRow) -> None:
        """Add a row at the bottom."""
        self.listed.add(row)
        self._offer_clear()
        self.show()

    def remove(self, row: RunRow) -> None:
        """Remove a row."""
        self.listed.remove(row)
        self._offer_clear()
        self.setVisible(bool(self.rows))

    def fit(self, finished: bool) -> None:
        """Update the height after rows have changed; ``finished`` is whether a run has ended."""
        self.clear.setEnabled(finished)
        self._offer_clear()
        self.listed.fit()

    def _offer_clear(self) -> None:
        # A single row has a button of its own.
        self.clear.setVisible(len(self.rows) > 1)

    def set_room(self, height_px: int) -> None:
        """Note the height of the panel: a small one shows fewer rows."""
        self.listed.most_rows = min(max(height_px // _ROW_SHARE_PX, 1), 4)
        self.listed.fit()


class RunRows(QScrollArea):
    """Rows from top to bottom; scrolls if there are more than ``most_rows``."""

    most_rows = 4

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("runs")
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setWidgetResizable(True)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        contents = QWidget()
        self._layout = QVBoxLayout(contents)
        self._layout.setContentsMargins(0, 0, 0, 0)
        self._layout.setSpacing(2)
        self._layout.addStretch(1)
        self.setWidget(contents)
        self._to_newest = False
        self.verticalScrollBar().rangeChanged.connect(self._grown)
        self.verticalScrollBar().actionTriggered.connect(self._scrolled)

    @property
    def rows(self) -> list[RunRow]:
        """Rows from top to bottom."""
        widgets = (self._layout.itemAt(index).widget() for index in range(self._layout.count()))
        return [widget for widget in widgets if isinstance(widget, RunRow)]

    def add(self, row: RunRow) -> None:
        """Add a row at the bottom."""
        self._layout.insertWidget(self._layout.count() - 1, row)
        row.fitted.connect(self.fit)
        self._to_newest = True
        self.fit()

    def remove(self, row: RunRow) -> None:
        """Remove a row."""
        self._layout.removeWidget(row)
        row.hide()
        row.deleteLater()
        self.fit()

    def fit(self) -> None:
        """Update the height after rows have changed."""
        self.updateGeometry()

    def sizeHint(self) -> QSize:
        """Return the size of all rows, but at most of ``most_rows``."""
        return QSize(super().sizeHint().width(), self._list_height(self.most_rows))

    def minimumSizeHint(self) -> QSize:
        """Return the size of one row."""
        return QSize(super().minimumSizeHint().width(), self._list_height(1))

    def _grown(self, _least: int, most: int) -> None:
        """Stay at the newest row while the list is laid out, which may take several steps."""
        if self._to_newest:
            self.verticalScrollBar().setValue(most)

    def _scrolled(self, _action: int) -> None:
        """Leave the list to the user."""
        self._to_newest = False

    def _list_height(self, count: int) -> int:
        width = max(self.viewport().width(), 1)
        heights = [
            row.heightForWidth(width) if row.hasHeightForWidth() else row.sizeHint().height() for row in self.rows
        ]
        # Room for the tallest, whichever are scrolled to.
        tallest = sorted(heights)[-count:]
        return sum(tallest) + self._layout.spacing() * len(tallest)


class RunRow(QFrame):
    """Row of a run; displays only, and emits the user's requests.

    Signals
    -------
    asked(str)
        The action wanted, one of `RunRow.DEEDS`.
    fitted()
        The height may have changed.
    """

    DEEDS = PAUSE, RESUME, CANCEL, FAILED, ZOOM, CLEAN, OPEN, DISMISS = (
        "pause",
        "resume",
        "cancel",
        "capture_failed",
        "zoom",
        "clean",
        "open_folder",
        "dismiss",
    )
    asked = pyqtSignal(str)
    fitted = pyqtSignal()

    def __init__(self, title: str) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.title = named(ElidedLabel(Qt.TextElideMode.ElideMiddle, 10), "run_title")
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        self.title.say(title)
        self.bar = named(QProgressBar(), "run_progress")
        self.bar.setRange(0, 100)
        self.bar.setTextVisible(False)
        self.bar.setFixedHeight(4)
        self.text = wrapped_label("run_text")
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.NoTextInteraction)
        # Keep the flag by which the height follows the width.
        policy = self.text.sizePolicy()
        policy.setHorizontalPolicy(QSizePolicy.Policy.Ignored)
        self.text.setSizePolicy(policy)
        self.buttons = self._make_buttons(title)
        self._actions: set[str] = set()
        self._lay_out()

    def show_progress(self, percent: float, text: str) -> None:
        """Show the progress of the run."""
        self.bar.setValue(int(percent))
        if text != self.text.text():
            self.text.setText(text)
            self._fit_text()

    def show_actions(self, actions: set[str], enabled: bool = True, underway: bool = True) -> None:
        """Enable the actions that are possible now.

        Parameters
        ----------
        actions : set of str
            Possible actions, of `DEEDS`.
        enabled : bool
            Whether pausing is possible now.
        underway : bool
            Whether to show the progress bar.
        """
        for name, button in self.buttons.items():
            button.setVisible(name in actions)
        self.buttons[self.PAUSE].setEnabled(enabled)
        self.bar.setVisible(underway)
        if actions != self._actions:
            self._actions = actions
            # While the run is under way, its buttons stay where they are: one press pauses, another resumes.
            self._fit_text(anew=not underway)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Fit the text to a new width."""
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self._fit_text(anew=True)

    def _fit_text(self, *, anew: bool = False) -> None:
        """Put a text that does not fit beside the title below it; it stays there, unless fitted ``anew``."""
        beside, below = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
        buttons_px = sum(button.sizeHint().width() for button in self.buttons.values() if not button.isHidden())
        edges = self.layout().contentsMargins()
        room_px = self.width() - edges.left() - edges.right() - 2 * self.frameWidth() - buttons_px
        texts_px = sum(label.fontMetrics().horizontalAdvance(label.text()) for label in (self.title, self.text))
        fits = texts_px + 2 * self._words.spacing() <= room_px
        if anew or not fits:
            self._words.setDirection(beside if fits else below)
        # Qt would do so only later, and the list asks for the height now.
        for layout in (self._words, self._top, self.layout()):
            layout.invalidate()
        self.fitted.emit()

    def _make_buttons(self, title: str) -> dict[str, QToolButton]:
        of_qgis = QgsApplication.getThemeIcon
        looks = {
            self.PAUSE: (
                of_qgis("/temporal_navigation/pause.svg"),
                tr("Pause this capture"),
            ),
            self.RESUME: (of_qgis("/mActionPlay.svg"), tr("Resume this capture")),
            self.CANCEL: (of_qgis("/mTaskCancel.svg"), tr("Cancel (finished images are kept)")),
            self.FAILED: (icon("capture_failed"), tr("Capture only the failed images again")),
            self.ZOOM: (of_qgis("/mActionZoomToLayer.svg"), tr("Zoom the map to this mission")),
            self.CLEAN: (
                icon("clean_dataset"),
                tr("Open in the Dataset window, which cleans, splits, exports and shows it"),
            ),
            self.OPEN: (of_qgis("/mActionFileOpen.svg"), tr("Open the folder of the images")),
            self.DISMISS: (of_qgis("/mIconClose.svg"), tr("Remove from list (files are kept)")),
        }
        buttons = {}
        for name, (image, tip) in looks.items():
            button = tool_button(f"run_{name}", image, tip)
            button.setAutoRaise(True)
            button.setAccessibleName(f"{tip} ({title})")
            # Make the button reachable by keyboard.
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.clicked.connect(lambda _=False, name=name: self.asked.emit(name))
            buttons[name] = button
        return buttons

    def _lay_out(self) -> None:
        self._words = QBoxLayout(QBoxLayout.Direction.LeftToRight)
        self._words.setSpacing(6)
        self._words.addWidget(self.title)
        self._words.addWidget(self.text, 1)
        top = self._top = QHBoxLayout()
        top.setSpacing(0)
        top.addLayout(self._words, 1)
        for button in self.buttons.values():
            top.addWidget(button, 0, Qt.AlignmentFlag.AlignTop)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 1, 4, 1)
        layout.setSpacing(1)
        layout.addLayout(top)
        layout.addWidget(self.bar)


def _run_actions(run: BackgroundRun) -> set[str]:
    """Actions that are possible for a run now."""
    if run.stage is Stage.WAITING:
        return {RunRow.CANCEL}
    if run.stage is Stage.RUNNING:
        return {RunRow.CANCEL, RunRow.PAUSE}
    if run.stage is Stage.PAUSED:
        return {RunRow.CANCEL, RunRow.RESUME}
    if run.stage is Stage.STOPPING:
        # After the last image, only the mosaic can be stopped.
        return {RunRow.CANCEL} if run.result is not None else set()
    actions = {RunRow.ZOOM, RunRow.OPEN, RunRow.DISMISS}
    if run.stage in (Stage.DONE, Stage.INCOMPLETE) and not run.test_shot:
        actions.add(RunRow.CLEAN)
    if run.stage in (Stage.STOPPED, Stage.BROKEN) and not run.test_shot:
        actions.add(RunRow.RESUME)
    return actions | ({RunRow.FAILED} if run.task.failed else set())
