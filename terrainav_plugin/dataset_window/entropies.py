"""Entropies that decide which images of a dataset are rejected. On any thread; no widgets."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...core.arrays import Floats, Numbers
from ...core.dataset.entropy import Report, deciding_entropies, otsu, separates_groups
from ...core.dataset.folder import REJECTED_FOLDER
from ...core.dataset.table import REJECTED
from ...core.storage.files import file_exists


class Example(NamedTuple):
    """An image close to the threshold, as an example.

    Parameters
    ----------
    index : int
        Row in the table.
    path : Path
        Current path of the file.
    entropy : float
        Deciding entropy in bits.
    """

    index: int
    path: Path
    entropy: float


@dataclass(frozen=True, eq=False)
class Entropies:
    """The entropies that decide which images of a map type are rejected.

    Parameters
    ----------
    folder : Path
        Folder of the images.
    names : tuple of str
        File names in the order of the table, which is flight order.
    bits : array (n,)
        Deciding entropies; NaN for images that failed.
    by_roadmap : int
        Number of images for which the roadmap decides.
    marked, moved : int
        Number of images marked, and of files moved, by an earlier cleaning.
    """

    folder: Path
    names: tuple[str, ...]
    bits: Floats
    by_roadmap: int
    marked: int
    moved: int
    #: File names without extension.
    stems: tuple[str, ...] = field(init=False)
    #: Rows of existing images, by increasing entropy.
    order: Numbers = field(init=False)
    #: Entropies of existing images, increasing.
    ordered: Floats = field(init=False)
    #: Threshold that separates the entropies best; None if all are equal.
    suggested: float | None = field(init=False)
    #: Whether the suggested threshold separates two distinct groups of entropies.
    groups: bool = field(init=False)

    def __post_init__(self) -> None:
        there = np.flatnonzero(~np.isnan(self.bits))
        object.__setattr__(self, "stems", tuple(Path(name).stem for name in self.names))
        object.__setattr__(self, "order", there[np.argsort(self.bits[there], kind="stable")])
        object.__setattr__(self, "ordered", self.bits[self.order])
        suggested = otsu(self.ordered)
        groups = suggested is not None and separates_groups(self.ordered, suggested)
        object.__setattr__(self, "suggested", suggested)
        object.__setattr__(self, "groups", groups)

    def __len__(self) -> int:
        """Return the number of existing images."""
        return len(self.order)

    @property
    def failed(self) -> int:
        """Number of images that failed."""
        return len(self.bits) - len(self.order)

    def rejected(self, threshold: float) -> int:
        """Number of images below a threshold."""
        return int(np.searchsorted(self.ordered, threshold, side="left"))

    def rejected_stems(self, threshold: float) -> list[str]:
        """Names without extension of the images below a threshold."""
        return [self.stems[row] for row in self.order[: self.rejected(threshold)].tolist()]

    def examples(self, threshold: float, count: int) -> tuple[list[Example], list[Example]]:
        """Images just below a threshold, and images just above it: at most ``count`` each, the nearest first."""
        first_kept = self.rejected(threshold)
        below = self.order[max(first_kept - count, 0) : first_kept][::-1]
        above = self.order[first_kept : first_kept + count]
        return [self._example(row) for row in below.tolist()], [self._example(row) for row in above.tolist()]

    def _example(self, row: int) -> Example:
        name = self.names[row]
        kept, moved = self.folder / name, self.folder / REJECTED_FOLDER / name
        return Example(row, moved if not file_exists(kept) and file_exists(moved) else kept, float(self.bits[row]))


def read_entropies(folder: Path, progress: Report | None = None) -> dict[str, Entropies]:
    """Deciding entropies of a dataset, as used by cleaning, by the name of the map type's folder.

    Parameters
    ----------
    progress : callable
        Takes the share done, 0 to 1, if images must be read; stops the reading by returning False.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, its table cannot be read or contradicts the files, or an image cannot be read.
    Cancelled
        ``progress`` has returned False.
    """
    found = {}
    for name, one in deciding_entropies(folder, progress=progress).items():
        marks = one.table.other.get(REJECTED, ())
        found[name] = Entropies(
            one.image_folder,
            one.names,
            one.entropies,
            int(one.by_roadmap.sum()),
            sum(map(bool, marks)),
            _moved(one.image_folder),
        )
    return found


def _moved(folder: Path) -> int:
    """Number of files among the rejected images."""
    rejected = folder / REJECTED_FOLDER
    return sum(1 for one in rejected.iterdir() if one.is_file()) if rejected.is_dir() else 0
