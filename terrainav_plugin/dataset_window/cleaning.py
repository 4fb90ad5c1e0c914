"""Control cleaning: read a dataset's entropies, show examples and crosses on the map, and run the buttons' tasks."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsRectangle
from qgis.gui import QgisInterface
from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtWidgets import QFileDialog

from ...core.dataset.folder import DECIDING, FOOTPRINTS_FILE
from ...core.storage.files import file_exists
from ..i18n import tr, translate
from ..map.canvas import show_extent
from ..paths import open_in_system
from ..tasks import LatestWorker, failure_reason, single_shot
from ..widgets import first_problem
from .clean_tab import COUNT, CleanTab, no_footprints, read_examples
from .entropies import read_entropies
from .marks import Marks
from .tab import reading_stopped
from .tasks import CleanTask, PicturesTask

if TYPE_CHECKING:
    from ..messages import Messages
    from .clean_tab import ExampleImage
    from .entropies import Entropies
    from .tasks import Work


class Cleaning(QObject):
    """The tab, its marks on the map, and its tasks.

    Parameters
    ----------
    iface : QgisInterface
    messages : Messages
    work : Work

    Signals
    -------
    dataset_wanted(object)
        Folder of a dataset to open, with its mosaics rebuilt.
    read_so_far(float)
        Percentage of the dataset that has been read.
    """

    dataset_wanted = pyqtSignal(object)
    read_so_far = pyqtSignal(float)
    #: Number of the request to read, and the percentage read; emitted on the reader's thread.
    _read_so_far = pyqtSignal(int, float)

    def __init__(self, iface: QgisInterface, messages: Messages, work: Work) -> None:
        super().__init__()
        self._messages, self._work = messages, work
        self._canvas = iface.mapCanvas()
        self.panel = CleanTab()
        self.marks = Marks(self._canvas)
        self._in_sight = False
        self._folder: Path | None = None
        self._found: dict[str, Entropies] = {}
        self._map_type = ""
        self._asked = 0
        # Two workers: images are needed while a long table is being read, and vice versa.
        self.reader, self._pictures = LatestWorker("entropies"), LatestWorker("examples")
        self.reader.failed.connect(self._refused)
        self._read_so_far.connect(self._show_reading)
        # Update examples and crosses when the threshold rests: dragging stays smooth for any number of images.
        self._rested = single_shot(self._follow, self, 60)
        self._join()

    @property
    def busy(self) -> bool:
        """Whether results are pending."""
        return self._rested.isActive() or self._pictures.busy or self.marks.busy or self.reader.busy

    def take(self, folder: Path | None) -> None:
        """Show the current state of a dataset; None shows no dataset."""
        if folder is not None:
            self._read(folder)
            return
        self._abandon("")

    def stop_reading(self) -> None:
        """Abandon the current reading."""
        self._abandon(reading_stopped())

    def show_in_sight(self, in_sight: bool) -> None:
        """Show crosses on the map only while the tab is visible."""
        self._in_sight = in_sight
        if in_sight:
            self._follow()
        else:
            self.marks.hide()

    def close(self) -> None:
        """Stop for good."""
        self._asked += 1
        self._rested.stop()
        self.reader.close()
        self._pictures.close()
        self.marks.close()

    # --- reading

    def _abandon(self, hint: str) -> None:
        self.reader.forget()
        self._forget(None)
        self.panel.show_hint(hint)

    def _forget(self, folder: Path | None) -> int:
        """Switch to a folder that has not been read; return the number of the next request to read."""
        self._folder, self._found = folder, {}
        self.marks.hide()
        self._asked += 1
        return self._asked

    def _read(self, folder: Path) -> None:
        """Read a dataset, and abandon the current reading."""
        number = self._forget(folder)
        self.panel.show_hint(tr("Reading {name}…").format(name=folder.name))

        def read(overtaken: Callable[[], bool]) -> dict[str, Entropies]:
            def report(share: float) -> bool:
                self._read_so_far.emit(number, 100.0 * share)
                return not overtaken()

            return read_entropies(folder, report)

        self.reader.ask(read, self._show)

    def _show_reading(self, number: int, percent: float) -> None:
        if number == self._asked and not self._found:
            self.read_so_far.emit(percent)

    def _show(self, found: dict[str, Entropies]) -> None:
        self._found = found
        # Of several map types, the roadmap only decides about the images of the others.
        of_pictures = [name for name in found if not name.startswith(DECIDING)] or list(found)
        self._show_map_type(self._map_type if self._map_type in found else of_pictures[0])

    def _show_map_type(self, map_type: str) -> None:
        if map_type in self._found:
            self._map_type = map_type
            footprints = self._folder is not None and file_exists(self._folder / FOOTPRINTS_FILE)
            self.panel.show_entropies(self._found, map_type, footprints)
            self._follow()

    def _refused(self, error: Exception) -> None:
        self.panel.show_hint(translate(failure_reason(error)))

    # --- effects of the threshold

    def _follow(self, *_: object) -> None:
        """Show examples and crosses for the current threshold."""
        panel, found = self.panel, self._found.get(self._map_type)
        if found is None:
            return
        threshold, ratio = panel.threshold.value(), panel.devicePixelRatioF()
        self._pictures.ask(
            lambda _: read_examples(found.examples(threshold, COUNT), ratio),
            partial(self._show_examples, found),
        )
        if panel.on_map.isChecked() and self._in_sight and self._folder is not None:
            self.marks.show(self._folder, partial(found.rejected_stems, threshold))
        else:
            self.marks.hide()

    def _show_examples(self, found: Entropies, shown: tuple[list[ExampleImage], list[ExampleImage]]) -> None:
        if self.panel.entropies is found:
            self.panel.strip.show_examples(*shown)

    def _zoom_map(self, row: int) -> None:
        found = self._found.get(self._map_type)
        if found is not None and self._folder is not None:
            self.marks.find(self._folder, found.stems[row], self._zoom_to_extent)

    def _zoom_to_extent(self, extent: QgsRectangle | None) -> None:
        if extent is None:
            self._messages.warning(no_footprints())
            return
        # Show four times the extent of the image.
        show_extent(self._canvas, extent, 4.0)

    # --- actions of the buttons

    def _do(self, action: str) -> None:
        if self._folder is not None and self._is_right():
            self._work.start(CleanTask(self._folder, action, self.panel.threshold.value()), self._cleaned)

    def _save_pictures(self) -> None:
        folder = self._folder
        if folder is None or not self._is_right():
            return
        chosen = QFileDialog.getExistingDirectory(self.panel, tr("TerrAInav: folder for the charts"), str(folder))
        if chosen and not self.reader.closed:
            task = PicturesTask(folder, Path(chosen), self.panel.threshold.value())
            self._work.start(task, self._pictures_saved)

    def _is_right(self) -> bool:
        """Whether the threshold typed is valid; shows the problem otherwise."""
        problem = first_problem(self.panel)
        if problem:
            self._messages.warning(problem)
        return not problem

    def _cleaned(self, task: CleanTask) -> None:
        from ..dataset.mosaic import mosaic_names

        if not task.cleaned:
            self._messages.info(
                tr("{name}: stopped. Press the button again to finish, or Undo to put all back.").format(
                    name=task.folder.name
                )
            )
        else:
            moved = any(one.moved or one.returned for one in task.cleaned)
            update = (tr("Update mosaic"), lambda: self.dataset_wanted.emit(task.folder))
            mosaics = moved and mosaic_names(task.folder)
            self._messages.success(f"{task.folder.name}: {task.text()}", update if mosaics else None)

    def _pictures_saved(self, task: PicturesTask) -> None:
        if not task.written:
            # The task was stopped before it began.
            return
        self._messages.success(
            tr("{count} charts written to {folder}.").format(count=len(task.written), folder=task.target),
            (tr("Open folder"), lambda: open_in_system(task.target)),
        )

    def _join(self) -> None:
        self.marks.failed.connect(lambda error: self._messages.warning(translate(failure_reason(error))))
        panel = self.panel
        panel.map_type_chosen.connect(self._show_map_type)
        panel.threshold_changed.connect(lambda _bits: self._rested.start())
        panel.on_map_toggled.connect(self._follow)
        panel.action_wanted.connect(self._do)
        panel.pictures_wanted.connect(self._save_pictures)
        panel.strip.chosen.connect(self._zoom_map)
