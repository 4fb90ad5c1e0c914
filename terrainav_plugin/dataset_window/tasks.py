"""Background tasks started by the window's buttons, one at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.PyQt.QtCore import QObject, pyqtSignal

from ..i18n import number_text, tr, translate
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.dataset.clean import Cleaned
    from ...core.dataset.split import Split, UndoneSplit
    from ...core.exports.kinds import Exported
    from ..messages import Messages

MARK, MOVE, UNDO = "mark", "move", "undo"


class Work(QObject):
    """Runs the window's tasks, one at a time.

    Signals
    -------
    shown(bool, float)
        Whether a task is under way, and its percentage done.
    ended(object)
        The task, after its callback.
    """

    shown = pyqtSignal(bool, float)
    ended = pyqtSignal(object)

    def __init__(self, messages: Messages) -> None:
        super().__init__()
        self._messages = messages
        self.task: Task | None = None

    @property
    def busy(self) -> bool:
        """Whether a task is under way."""
        return self.task is not None

    def start(self, task: Task, done: Callable[[Any], None], refused: Callable[[str], None] | None = None) -> None:
        """Begin a task unless one is under way.

        Parameters
        ----------
        done, refused : callable
            Called when the task ends: ``done`` with the task after success, ``refused`` with the reason of a failure,
            which the message bar also shows.
        """
        if self.task is not None:
            return
        self.task = task
        task.progressChanged.connect(lambda percent: self.shown.emit(True, percent))
        self.shown.emit(True, 0.0)
        task.begin(partial(self._ended, done, refused))

    def stop(self) -> None:
        """Cancel the task."""
        if self.task is not None:
            self.task.cancel()

    def close(self) -> None:
        """Stop for good, without emitting `ended`."""
        if self.task is not None:
            self.task.progressChanged.disconnect()
            self.task.abandon()
            self.task.waitForFinished()
            self.task = None

    def _ended(self, done: Callable[[Any], None], refused: Callable[[str], None] | None, task: Task) -> None:
        self.task = None
        self.shown.emit(False, 0.0)
        if not task.error:
            done(task)
        else:
            reason = translate(task.error)
            self._messages.failed(reason, task.trace)
            if refused is not None:
                refused(reason)
        self.ended.emit(task)


class CleanTask(Task):
    """Reject images of a dataset, or restore them all.

    Parameters
    ----------
    folder : Path
    action : str
        `MARK`, `MOVE` or `UNDO`.
    threshold : float
        Bits.

    Attributes
    ----------
    cleaned : tuple of Cleaned
        Results by map type; empty until the task has ended.
    """

    changes_dataset = True

    def __init__(self, folder: Path, action: str, threshold: float) -> None:
        super().__init__(tr("Cleaning {name}").format(name=folder.name))
        self.folder, self.action, self.threshold = folder, action, threshold
        self.cleaned: tuple[Cleaned, ...] = ()

    def work(self) -> None:
        """Clean."""
        from ...core.dataset.clean import clean, undo

        if self.action == UNDO:
            self.cleaned = undo(self.folder, progress=self.report_progress)
        else:
            self.cleaned = clean(self.folder, self.threshold, move=self.action == MOVE, progress=self.report_progress)

    def text(self) -> str:
        """One or two sentences about the results of all map types."""
        images, rejected, moved, returned = (
            number_text(sum(values))
            for values in zip(*((one.images, one.rejected, one.moved, one.returned) for one in self.cleaned))
        )
        if self.action == UNDO:
            return tr("{rejected} images are no longer marked, {returned} moved back.").format(
                rejected=rejected, returned=returned
            )
        count = len(self.cleaned)
        text = (
            tr("{rejected} of {images} images are marked as rejected.")
            if count == 1
            else tr("{rejected} of {images} images of {count} map types are marked as rejected.")
        ).format(rejected=rejected, images=images, count=count)
        if any(one.moved for one in self.cleaned):
            text += " " + tr("{moved} moved away.").format(moved=moved)
        if any(one.returned for one in self.cleaned):
            text += " " + tr("{returned} moved back.").format(returned=returned)
        return text


class PicturesTask(Task):
    """Write the charts of a dataset as images.

    Parameters
    ----------
    folder, target : Path
        Folder of the dataset, and folder for the images.
    threshold : float
        Bits.

    Attributes
    ----------
    written : list of Path
    """

    changes_dataset = False

    def __init__(self, folder: Path, target: Path, threshold: float) -> None:
        super().__init__(tr("Images of {name}").format(name=folder.name))
        self.folder, self.target, self.threshold = folder, target, threshold
        self.written: list[Path] = []

    def work(self) -> None:
        """Draw and write the charts."""
        from ...core.dataset.figures import save_figures

        self.written = save_figures(self.folder, self.target, self.threshold)


class SplitTask(Task):
    """Split a dataset, or compute the counts of a split only.

    Parameters
    ----------
    folder : Path
    shares : sequence of three floats
    options : dict
        Keyword arguments of `split`.

    Attributes
    ----------
    made : Split or None
        None if stopped.
    """

    changes_dataset = True

    def __init__(self, folder: Path, shares: Sequence[float], options: dict[str, Any]) -> None:
        super().__init__(tr("Splitting {name}").format(name=folder.name))
        self.folder, self.shares, self.options = folder, shares, options
        self.made: Split | None = None

    def work(self) -> None:
        """Split."""
        from ...core.dataset.split import split

        self.made = split(self.folder, self.shares, **self.options, progress=self.report_progress)


class UndoSplitTask(Task):
    """Undo the last split of a dataset.

    Attributes
    ----------
    undone : UndoneSplit or None
        None until the task has ended.
    """

    changes_dataset = True

    def __init__(self, folder: Path) -> None:
        super().__init__(tr("Undoing the split of {name}").format(name=folder.name))
        self.folder = folder
        self.undone: UndoneSplit | None = None

    def work(self) -> None:
        """Undo."""
        from ...core.dataset.split import undo_split

        self.undone = undo_split(self.folder)


class DatasetExportTask(Task):
    """Export a dataset or benchmark to a format of another program.

    Parameters
    ----------
    folder : Path
    target : Path or None
        None for the dataset's folder.
    kind : str
        One of `KINDS`.
    map_type : str or None

    Attributes
    ----------
    done : Exported or None
        None if stopped.
    """

    changes_dataset = False

    def __init__(self, folder: Path, target: Path | None, kind: str, map_type: str | None) -> None:
        super().__init__(tr("Exporting {name}").format(name=folder.name))
        self.folder, self.target, self.kind, self.map_type = folder, target, kind, map_type
        self.done: Exported | None = None

    def work(self) -> None:
        """Export."""
        from ...core.exports.kinds import export_as

        self.done = export_as(self.folder, self.target, self.kind, self.map_type, self.report_progress)
