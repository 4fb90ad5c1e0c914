"""The entropies that decide which images of a dataset are rejected. On any thread; knows no widget."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...core.arrays import Floats, Numbers
from ...core.dataset.entropy import Report, deciding_entropies, otsu, parts_groups
from ...core.dataset.folder import REJECTED_FOLDER
from ...core.dataset.table import REJECTED
from ...core.storage.files import file_exists


class Example(NamedTuple):
    """An image, as one that stands for others.

    Parameters
    ----------
    index : int
        Row of the table.
    path : Path
        Where the file is now.
    entropy : float
        Bits that decide on it.
    """

    index: int
    path: Path
    entropy: float


@dataclass(frozen=True, eq=False)
class Entropies:
    """Entropies that decide on the images of a map type.

    Parameters
    ----------
    folder : Path
        Of the images.
    names : tuple of str
        Files, in the order of the table: that of the flight.
    bits : array (n,)
        Entropies that decide; NaN for images that could not be made.
    by_roadmap : int
        Images for which the roadmap decides.
    marked, moved : int
        Images that an earlier cleaning has marked, and files that it has moved.
    """

    folder: Path
    names: tuple[str, ...]
    bits: Floats
    by_roadmap: int
    marked: int
    moved: int
    #: Names without ending.
    stems: tuple[str, ...] = field(init=False)
    #: Rows of the images that are there, the least entropy first.
    order: Numbers = field(init=False)
    #: Their entropies, in that order.
    ordered: Floats = field(init=False)
    #: Threshold that parts the entropies best; None where all are the same.
    suggested: float | None = field(init=False)
    #: Whether that lies between two groups of entropies; else they form one.
    groups: bool = field(init=False)

    def __post_init__(self) -> None:
        there = np.flatnonzero(~np.isnan(self.bits))
        object.__setattr__(self, "stems", tuple(Path(name).stem for name in self.names))
        object.__setattr__(self, "order", there[np.argsort(self.bits[there], kind="stable")])
        object.__setattr__(self, "ordered", self.bits[self.order])
        suggested = otsu(self.ordered)
        groups = suggested is not None and parts_groups(self.ordered, suggested)
        object.__setattr__(self, "suggested", suggested)
        object.__setattr__(self, "groups", groups)

    def __len__(self) -> int:
        """Images that are there."""
        return len(self.order)

    @property
    def failed(self) -> int:
        """Images that could not be made."""
        return len(self.bits) - len(self.order)

    def rejected(self, threshold: float) -> int:
        """How many images are below a threshold."""
        return int(np.searchsorted(self.ordered, threshold, side="left"))

    def rejected_stems(self, threshold: float) -> list[str]:
        """Names without ending of the images below a threshold."""
        return [self.stems[row] for row in self.order[: self.rejected(threshold)].tolist()]

    def examples(self, threshold: float, count: int) -> tuple[list[Example], list[Example]]:
        """Images just below a threshold and just above it, at most ``count`` each, the nearest first."""
        first_kept = self.rejected(threshold)
        below = self.order[max(first_kept - count, 0) : first_kept][::-1]
        above = self.order[first_kept : first_kept + count]
        return [self._example(row) for row in below.tolist()], [self._example(row) for row in above.tolist()]

    def _example(self, row: int) -> Example:
        name = self.names[row]
        kept, moved = self.folder / name, self.folder / REJECTED_FOLDER / name
        return Example(row, moved if not file_exists(kept) and file_exists(moved) else kept, float(self.bits[row]))


def read_entropies(folder: Path, progress: Report | None = None) -> dict[str, Entropies]:
    """Entropies that decide in a dataset, by the name of each map type's folder: those that cleaning goes by.

    Parameters
    ----------
    progress : callable
        Told the share done, 0 to 1, where images have to be read; an answer of False stops it.

    Raises
    ------
    InvalidInput
        A folder that is no dataset, a table that cannot be read or says otherwise than the files, an image that cannot
        be read.
    Cancelled
        When ``progress`` said so.
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
    """Files among the rejected images."""
    rejected = folder / REJECTED_FOLDER
    return sum(1 for one in rejected.iterdir() if one.is_file()) if rejected.is_dir() else 0
