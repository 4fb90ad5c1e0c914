"""The dataset open in the window, and the tabs that have read it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.gui import QgisInterface
from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.dataset.folder import MISSION_FILE
from ...core.storage.files import file_exists
from ..paths import entered_folder
from ..settings import recent
from ..tasks import single_shot
from ..widgets import add_docked, remove_menu_mnemonics

if TYPE_CHECKING:
    from ..messages import Messages
    from .cleaning import Cleaning
    from .tab import Tab
    from .tasks import CleanTask, SplitTask, Work
    from .window import DatasetWindow

CLEAN, SPLIT, BENCHMARK, EXPORT, LABELS = TABS = ("clean", "split", "benchmark", "export", "labels")


class Datasets(QObject):
    """The window, its tabs, and their folder.

    Parameters
    ----------
    iface : QgisInterface
    messages : Messages
    folders : callable
        Returns folders that may be a dataset's, most likely first.

    Signals
    -------
    dataset_wanted(object)
        Folder of a dataset to open, with its mosaics rebuilt.
    benchmark_wanted()
        The user wants to make a benchmark from the panel's mission.
    score_wanted(object)
        The user wants to score a benchmark: its folder, or None.
    compare_wanted()
        The user wants to compare two images on the map.
    """

    dataset_wanted = pyqtSignal(object)
    benchmark_wanted = pyqtSignal()
    score_wanted = pyqtSignal(object)
    compare_wanted = pyqtSignal()

    def __init__(self, iface: QgisInterface, messages: Messages, folders: Callable[[], Iterable[Path]]) -> None:
        super().__init__()
        self._iface, self._messages, self._folders = iface, messages, folders
        # Most datasets are read before a progress bar could be seen.
        self._reading_lasts = single_shot(self._show_reading, self, 300)
        self._percent_read = 0.0
        self.window: DatasetWindow | None = None
        self.cleaning: Cleaning | None = None
        self.tabs: dict[str, Tab] = {}
        self.folder: Path | None = None
        self._work: Work | None = None
        #: Tabs that do not show the current state of the open dataset.
        self._stale: set[str] = set()

    @property
    def busy(self) -> bool:
        """Whether results are pending."""
        if self.window is None:
            return False
        return self._work.busy or self.cleaning.busy or any(tab.busy for tab in self.tabs.values())

    def open(self, folder: Path | None = None, tab: str = "") -> None:
        """Show a dataset in the window, by default the one captured last, in a tab, by default the current one."""
        window = self._shown_window()
        folder = folder or self.folder or self._last()
        if tab:
            window.tabs.setCurrentIndex(TABS.index(tab))
        if folder is not None and not self._work.busy:
            window.show_folder(str(folder))
            self._take(folder)

    def close(self) -> None:
        """Stop for good."""
        if self.window is None:
            return
        self._work.close()
        self._reading_lasts.stop()
        self.window.visibilityChanged.disconnect(self._show_sight)
        self.cleaning.close()
        for tab in self.tabs.values():
            tab.close_reader()
        self._iface.removeDockWidget(self.window)
        self.window.deleteLater()
        self.window = None

    # --- the folder

    def _last(self) -> Path | None:
        """Folder of the most likely dataset; if there is none, of the dataset opened last."""
        folders = (*self._folders(), *recent())
        return next((folder for folder in folders if file_exists(folder / MISSION_FILE)), None)

    def _folder_chosen(self, text: str) -> None:
        self.cleaning.panel.forget_focus()
        self._take(entered_folder(text) if text.strip() else None)

    def _take(self, folder: Path | None) -> None:
        """Show the current state of a dataset in the visible tab; other tabs read it when they become visible."""
        self.folder = folder
        self._stale = set(TABS)
        self._show_current()

    @property
    def _name(self) -> str:
        """Name of the current tab."""
        return TABS[self.window.tabs.currentIndex()]

    @property
    def _shown(self) -> Cleaning | Tab:
        """What reads and shows a dataset in the current tab."""
        return self.cleaning if self._name == CLEAN else self.tabs[self._name]

    def _show_current(self, *_: object) -> None:
        if self._name in self._stale:
            self._stale.discard(self._name)
            self._shown.take(self.folder)
        self._reading_changed()
        self._show_sight(self.window.isUserVisible())

    def _show_sight(self, visible: bool) -> None:
        """Show the crosses on the map only while the cleaning tab is visible."""
        self.cleaning.show_in_sight(visible and self._name == CLEAN)

    # --- reading

    def _reading_changed(self, *_: object) -> None:
        self._percent_read = 0.0
        self._reading_lasts.start() if self._shown.reader.is_awaited else self._reading_lasts.stop()
        if not self._work.busy:
            self.window.show_progress(False, 0.0)

    def _note_read(self, percent: float) -> None:
        self._percent_read = percent
        self._reading_lasts.stop()
        self._show_reading()

    def _show_reading(self) -> None:
        if self._shown.reader.is_awaited and not self._work.busy:
            self.window.show_progress(True, self._percent_read if self._name == CLEAN else 0.0)

    def _stop(self) -> None:
        """Stop the task, or the reading of the current tab, which is read again when it is opened again."""
        if self._work.busy:
            self._work.stop()
        elif self._shown.reader.is_awaited:
            self._stale.add(self._name)
            self._shown.stop_reading()

    # --- tasks

    def _show_working(self, working: bool, percent: float) -> None:
        self.window.show_working(working, percent)
        self.cleaning.panel.show_working(working)
        for tab in self.tabs.values():
            tab.show_working(working)

    def _ended(self, task: CleanTask | SplitTask) -> None:
        """Show the state of the dataset after a task, whether it succeeded or failed."""
        from .tasks import SplitTask, UndoSplitTask

        if task.changes_dataset and self.window is not None:
            # The split tab reads its folder itself, and keeps its text about the split.
            self._stale = set(TABS) - ({SPLIT} if isinstance(task, (SplitTask, UndoSplitTask)) else set())
            self._show_current()

    # --- the window

    def _shown_window(self) -> DatasetWindow:
        if self.window is None:
            self._make()
        self.window.setUserVisible(True)
        return self.window

    def _make(self) -> None:
        from .benchmark_tab import BenchmarkTab
        from .cleaning import Cleaning
        from .export_tab import ExportTab
        from .labels_tab import LabelsTab
        from .split_tab import SplitTab
        from .tasks import Work
        from .window import DatasetWindow

        work = self._work = Work(self._messages)
        cleaning = self.cleaning = Cleaning(self._iface, self._messages, work)
        cleaning.dataset_wanted.connect(self.dataset_wanted)
        benchmark = BenchmarkTab()
        benchmark.make_wanted.connect(self.benchmark_wanted)
        benchmark.score_wanted.connect(self.score_wanted)
        self.tabs = {
            SPLIT: SplitTab(work),
            BENCHMARK: benchmark,
            EXPORT: ExportTab(work),
            LABELS: LabelsTab(),
        }
        window = self.window = DatasetWindow({CLEAN: cleaning.panel, **self.tabs})
        window.folder_chosen.connect(self._folder_chosen)
        window.compare_wanted.connect(self.compare_wanted)
        window.stop_wanted.connect(self._stop)
        cleaning.read_so_far.connect(self._note_read)
        for reader in (cleaning.reader, *(tab.reader for tab in self.tabs.values())):
            reader.awaited.connect(self._reading_changed)
        window.tabs.currentChanged.connect(self._show_current)
        window.visibilityChanged.connect(self._show_sight)
        work.shown.connect(self._show_working)
        work.ended.connect(self._ended)
        remove_menu_mnemonics(window, self._iface.mainWindow().menuBar())
        add_docked(window, self._iface, "terrainav_dock")
