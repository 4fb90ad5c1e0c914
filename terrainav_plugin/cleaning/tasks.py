"""What the panel's buttons start: cleaning, its undoing, and pictures of the entropies. In the background."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..i18n import number_text, tr
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.dataset.clean import Cleaned

MARK, MOVE, UNDO = "mark", "move", "undo"


class CleanTask(Task):
    """Rejects images of a dataset, or puts all back.

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
        What was done, by map type; empty until then.
    """

    def __init__(self, folder: Path, action: str, threshold: float) -> None:
        super().__init__(tr("Cleaning {name}").format(name=folder.name))
        self.folder, self.action, self.threshold = folder, action, threshold
        self.cleaned: tuple[Cleaned, ...] = ()

    def work(self) -> None:
        """Clean."""
        from ...core.dataset.clean import clean, undo

        if self.action == UNDO:
            self.cleaned = undo(self.folder, progress=self.go_on)
        else:
            self.cleaned = clean(self.folder, self.threshold, move=self.action == MOVE, progress=self.go_on)

    def text(self) -> str:
        """What was done to all map types, in a sentence or two."""
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
    """Writes the charts of a dataset as pictures.

    Parameters
    ----------
    folder, target : Path
        Of the dataset, and of the pictures.
    threshold : float
        Bits.

    Attributes
    ----------
    written : list of Path
    """

    def __init__(self, folder: Path, target: Path, threshold: float) -> None:
        super().__init__(tr("Images of {name}").format(name=folder.name))
        self.folder, self.target, self.threshold = folder, target, threshold
        self.written: list[Path] = []

    def work(self) -> None:
        """Draw and write."""
        from ...core.dataset.figures import save_figures

        self.written = save_figures(self.folder, self.target, self.threshold)
