"""Base of the window's tabs, which read a dataset in the background."""

from __future__ import annotations

from pathlib import Path

from qgis.PyQt.QtWidgets import QLabel, QWidget

from ..i18n import tr, translate
from ..tasks import LatestWorker, failure_reason
from ..widgets import wrapped_label


class Tab(QWidget):
    """Show a dataset and offer actions.

    Attributes
    ----------
    folder : Path or None
        Folder of the dataset.
    working : bool
        Whether a task of the window is under way; no other task can then begin.
    hint : QLabel
        Shown instead of the contents.
    """

    def __init__(self, name: str) -> None:
        super().__init__()
        self.setObjectName(name)
        self.folder: Path | None = None
        self.working = False
        self.hint: QLabel = wrapped_label(f"{name}_hint")
        self.reader = LatestWorker(name)
        self.reader.failed.connect(lambda error: self.show_refused(translate(failure_reason(error))))

    @property
    def busy(self) -> bool:
        """Whether reading is under way."""
        return self.reader.busy

    def take(self, folder: Path | None) -> None:
        """Show the current state of a dataset; None shows no dataset."""
        self.folder = folder
        self.reader.forget()
        self.show_dataset()

    def stop_reading(self) -> None:
        """Abandon the current reading."""
        self.reader.forget()
        self.show_refused(reading_stopped())

    def show_working(self, working: bool) -> None:
        """Disable actions during a task."""
        self.working = working
        self.enable()

    def close_reader(self) -> None:
        """Stop the reader for good."""
        self.reader.close()

    # --- differences between tabs

    def show_dataset(self) -> None:
        """Show `folder`, which has not been read yet."""
        raise NotImplementedError

    def show_refused(self, reason: str) -> None:
        """Show why the dataset cannot be read."""
        self.hint.setText(reason)
        self.hint.show()
        self.enable()

    def enable(self) -> None:
        """Enable the actions that are possible now."""
        raise NotImplementedError


def reading_stopped() -> str:
    """Text shown after the user has stopped the reading of a dataset."""
    return tr("Reading was stopped; another tab and back reads the dataset again.")


def no_folder() -> str:
    """Text shown while no dataset is open."""
    return tr("Choose the folder of a dataset.")
