"""Cleaning: images with too little to see are marked in the table, and moved out of the way where that is wanted.

Nothing is deleted. The table is written whole before a file is moved, and each file is in one of its two places at any
time, so that a run that was interrupted can be finished by another one or taken back.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import Cancelled, InvalidInput
from ..files import clear_partial
from ..lock import open_locked
from .folder import JOURNAL_FILE, TABLE_FILE, map_type_folders
from .images import Images, Move
from .table import Table
from .thresholds import otsu

Floats = NDArray[np.float64]

#: Column of the table: why an image is rejected; empty for one that is kept. A table that has none is not cleaned.
REJECTED = "rejected"
#: The paper's: in its dataset, images below it lack significant detail.
DEFAULT_ENTROPY = 2.1
#: Of 256 grey levels, in bits.
HIGHEST_ENTROPY = 8.0
#: The map type whose entropies decide for all of a place, where there are such images.
DECIDING = "roadmap"
#: What `clean` and `undo` tell of: the share done, 0 to 1; an answer of False stops them.
Report = Callable[[float], bool]


@dataclass(frozen=True)
class Cleaned:
    """What cleaning did to one map type, or would do.

    Parameters
    ----------
    map_type : str
    images, failed : int
        Images that are there; rows of images that could not be made, which are left as they are.
    rejected : int
        Images that are marked.
    by_roadmap : int
        Images for which the roadmap decided.
    moved, returned : int
        Images moved out of the way, and back.
    suggested : float or None
        Threshold that parts the deciding entropies best (see `otsu`); None where all are the same.
    """

    map_type: str
    images: int
    failed: int
    rejected: int
    by_roadmap: int
    moved: int
    returned: int
    suggested: float | None


def clean(
    folder: str | os.PathLike[str],
    threshold: float = DEFAULT_ENTROPY,
    *,
    move: bool = False,
    dry_run: bool = False,
    progress: Report | None = None,
) -> tuple[Cleaned, ...]:
    """Reject images with an entropy below a threshold, of every map type of a dataset.

    The roadmap's entropies decide for the other map types too, where its images are there; elsewhere the image's own
    do (the paper's section Post Processing). Rejected rows say why in the column ``rejected``. An image that is
    no longer rejected is moved back from where an earlier run has put it.

    Parameters
    ----------
    folder : path
        Of a dataset, or of images with a ``meta_data.csv`` beside them.
    threshold : float
        Bits, 0 to 8.
    move : bool
        Move rejected images, with the files that belong to them, to the folder ``rejected`` beside them.
    dry_run : bool
        Change nothing.
    progress : callable

    Returns
    -------
    tuple of Cleaned
        By map type.

    Raises
    ------
    InvalidInput
        A folder that is no dataset, a table that cannot be read or says otherwise than the files, an image that
        cannot be read: nothing is changed then.
    OutputError
        Another run is at work in the folder, or something cannot be written or moved.
    Cancelled
        ``progress`` said so: to be finished by the next run, or taken back.
    """
    if not 0.0 <= threshold <= HIGHEST_ENTROPY:
        raise InvalidInput(f"entropy {threshold}: must be from 0 to {HIGHEST_ENTROPY:g} bits")
    with _held(Path(folder), map_type_folders(folder), only_read=dry_run) as folders:
        loaded = {map_type: _Loaded(path) for map_type, path in folders.items()}
        deciding = loaded[DECIDING].by_stem() if DECIDING in loaded else {}
        steps = [_judged(map_type, one, deciding, threshold, move) for map_type, one in loaded.items()]
        if not dry_run:
            _carry_out(
                [(one.folder, table, moves) for one, (_, table, moves) in zip(loaded.values(), steps)],
                progress,
            )
    return tuple(cleaned for cleaned, _, _ in steps)


def undo(
    folder: str | os.PathLike[str], *, dry_run: bool = False, progress: Report | None = None
) -> tuple[Cleaned, ...]:
    """Take cleaning back: images return to their places, and tables have no column ``rejected`` any more.

    Parameters, errors and result are those of `clean`; ``rejected`` counts the marks that were taken away. All that
    lies in a folder ``rejected`` returns, also what no table names.
    """
    with _held(Path(folder), map_type_folders(folder), only_read=dry_run) as folders:
        results, steps = [], []
        for map_type, path in folders.items():
            table, images = Table.load(path / TABLE_FILE), Images(path)
            moves = images.all_back()
            marks = table.other.get(REJECTED, ())
            failed = table.status.count("failed")
            marked, returned = sum(map(bool, marks)), len({move.stem for move in moves})
            results.append(Cleaned(map_type, len(table) - failed, failed, marked, 0, 0, returned, None))
            kept = {header: cells for header, cells in table.other.items() if header != REJECTED}
            steps.append((path, table.replaced(kept) if REJECTED in table.other else None, moves))
        if not dry_run:
            # Marks go last: as long as they are there, an interrupted run can be told from a finished one.
            _carry_out([(path, None, moves) for path, _, moves in steps], progress)
            _carry_out([(path, table, []) for path, table, _ in steps], None)
            for path in folders.values():
                Images.remove_if_empty(path)
    return tuple(results)


@contextmanager
def _held(folder: Path, folders: dict[str, Path], *, only_read: bool) -> Iterator[dict[str, Path]]:
    """Keep captures out of a folder, unless it is only read."""
    with ExitStack() as held:
        journal = folder / JOURNAL_FILE
        if not only_read and journal.is_file():
            held.enter_context(open_locked(journal))
        yield folders


class _Loaded:
    """The table and the images of a map type, which agree, and the entropies of all images that are there.

    Attributes
    ----------
    entropies : array (n,)
        NaN for rows of images that could not be made.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.table = Table.load(folder / TABLE_FILE)
        self.images = Images(folder)
        there = np.array([status != "failed" for status in self.table.status], np.bool_)
        self.images.check(self.table.img_names, there)
        self.entropies = np.where(there, self.table.entropies, np.nan)
        for index in np.flatnonzero(there & ~np.isfinite(self.entropies)):
            self.entropies[index] = self.images.entropy_of(self.table.img_names[index])

    def by_stem(self) -> dict[str, float]:
        """Entropies of the images that are there by their names without ending."""
        stems = (Path(name).stem for name in self.table.img_names)
        return {stem: value for stem, value in zip(stems, self.entropies.tolist()) if not math.isnan(value)}


def _judged(
    map_type: str, loaded: _Loaded, deciding: dict[str, float], threshold: float, move: bool
) -> tuple[Cleaned, Table | None, list[Move]]:
    """What is to be done to a map type: counts, the table if it changes, and files to be moved."""
    names = loaded.table.img_names
    there = ~np.isnan(loaded.entropies)
    decisive, by_roadmap = loaded.entropies.copy(), np.zeros(len(names), np.bool_)
    if map_type != DECIDING:
        of_roadmap = np.array([deciding.get(Path(name).stem, math.nan) for name in names], np.float64)
        by_roadmap = there & ~np.isnan(of_roadmap)
        decisive = np.where(by_roadmap, of_roadmap, decisive)
    # A row without an image compares as not below.
    below = decisive < threshold
    marks = tuple(
        f"{'roadmap ' if by else ''}entropy {value:.3f} below {threshold:g}" if low else ""
        for low, by, value in zip(below.tolist(), by_roadmap.tolist(), decisive.tolist())
    )
    table = None
    if loaded.table.other.get(REJECTED) != marks:
        table = loaded.table.replaced({**loaded.table.other, REJECTED: marks})
    out, back = loaded.images.moves(
        [name for name, low in zip(names, below.tolist()) if low and move],
        [name for name, low in zip(names, below.tolist()) if not low],
    )
    cleaned = Cleaned(
        map_type,
        int(there.sum()),
        int((~there).sum()),
        int(below.sum()),
        int(by_roadmap.sum()),
        len({one.stem for one in out}),
        len({one.stem for one in back}),
        otsu(decisive[there]),
    )
    return cleaned, table, [*out, *back]


def _carry_out(steps: list[tuple[Path, Table | None, list[Move]]], progress: Report | None) -> None:
    """Write the tables, then move the files."""
    for folder, table, _ in steps:
        if table is None:
            clear_partial(folder / TABLE_FILE)
        else:
            table.save(folder / TABLE_FILE)
    moves = [move for _, _, of_folder in steps for move in of_folder]
    for done, move in enumerate(moves):
        if progress is not None and not progress(done / len(moves)):
            raise Cancelled("stopped while files were moved: run it again to finish, or undo to put all back")
        move.carry_out()
    for folder, _, _ in steps:
        Images.remove_if_empty(folder)
