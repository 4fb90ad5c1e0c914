"""Base of the window's tabs: a dataset, read in the background."""

from __future__ import annotations

from pathlib import Path

from qgis.PyQt.QtWidgets import QLabel, QWidget

from ..i18n import tr, translate
from ..tasks import LatestWorker, failure_reason
from ..widgets import wrapped_label


class Tab(QWidget):
    """Shows a dataset, and lets something be done with it.

    Attributes
    ----------
    folder : Path or None
        Of the dataset.
    working : bool
        Whether a task of the window is under way: nothing else can be begun then.
    hint : QLabel
        What there is to say where nothing is shown.
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
        """Whether something is still being read."""
        return self.reader.busy

    def take(self, folder: Path | None) -> None:
        """Show a dataset as it is now; None for none."""
        self.folder = folder
        self.reader.forget()
        self.show_dataset()

    def show_working(self, working: bool) -> None:
        """Let nothing be begun while a task is under way."""
        self.working = working
        self.enable()

    def close_reader(self) -> None:
        """End for good."""
        self.reader.close()

    # --- what tabs differ in

    def show_dataset(self) -> None:
        """Show `folder`, of which nothing is known yet."""
        raise NotImplementedError

    def show_refused(self, reason: str) -> None:
        """Show why the dataset cannot be read."""
        self.hint.setText(reason)
        self.hint.show()
        self.enable()

    def enable(self) -> None:
        """Let be pressed what can be done now."""
        raise NotImplementedError


def no_folder() -> str:
    """Text to show while no dataset is open."""
    return tr("Choose the folder of a dataset.")
