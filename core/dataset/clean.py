"""Clean datasets: mark images with too little detail in the table, and optionally move them away.

Nothing is deleted. The table is written before any file is moved, and each file is always in one of two folders, so
that another run can finish or undo an interrupted run.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import Cancelled, InvalidInput
from ..external.drawing import check_matplotlib
from ..storage.files import clear_partial, open_locked
from ..storage.stores import is_address
from .dataset import Images, Move
from .entropy import GREY, HIGHEST_ENTROPY, Deciding, Report, deciding_entropies, otsu, separates_groups
from .figures import draw_all
from .folder import DEFAULT_ENTROPY, JOURNAL_FILE, TABLE_FILE, image_folder, map_type_folders
from .table import REJECTED, Table


@dataclass(frozen=True)
class Cleaned:
    """Result of cleaning one map type, or of a dry run.

    Parameters
    ----------
    images, failed : int
        Number of images that exist, and of rows whose image could not be made, which stay unchanged.
    rejected : int
        Images marked.
    by_roadmap : int
        Images for which the roadmap decided.
    moved, returned : int
        Images moved away, and back.
    suggested : float or None
        Threshold that separates the deciding entropies best (see `otsu`); None if all are equal.
    measure : str
        One of `entropy.MEASURES`: the kind of entropies in the deciding table.
    figures : tuple of str
        Paths of the written diagrams.
    groups : bool
        Whether the suggested threshold lies between two groups of entropies.
    """

    map_type: str
    images: int
    failed: int
    rejected: int
    by_roadmap: int
    moved: int
    returned: int
    suggested: float | None
    measure: str = GREY
    figures: tuple[str, ...] = ()
    groups: bool = False

    @property
    def is_one_sided(self) -> bool:
        """Whether the threshold rejects nothing, or at least 95 %."""
        return bool(self.images) and not 0 < self.rejected < self.images * 0.95


def clean(
    folder: str | os.PathLike[str],
    threshold: float = DEFAULT_ENTROPY,
    *,
    move: bool = False,
    dry_run: bool = False,
    plot: str | os.PathLike[str] | None = None,
    progress: Report | None = None,
) -> tuple[Cleaned, ...]:
    """Reject images whose entropy is below a threshold, in all map types of a dataset.

    Where the dataset has roadmap images, their entropies decide for all map types; elsewhere, each image's entropy
    decides (see `deciding_entropies`). The column ``rejected`` gives the reason. Images that an earlier run moved away
    and that are no longer rejected are moved back.

    Parameters
    ----------
    folder : path
        Dataset, or images with a ``meta_data.csv`` beside them.
    threshold : float
        Bits, 0 to 8.
    move : bool
        Move rejected images, with their sidecar files, to the folder ``rejected`` beside them.
    dry_run : bool
        Change nothing in the dataset.
    plot : path or None
        Folder for the diagrams of the entropies (see `figures.save_figures`). They are written before anything changes,
        also in a dry run.
    progress : callable
        Called with the share done, 0 to 1; returning False stops the run.

    Returns
    -------
    tuple of Cleaned
        One for each map type.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, a table cannot be read or disagrees with the files, or an image cannot be read.
        Nothing is changed then.
    OutputError
        Another run works in the folder, something cannot be written or moved, or matplotlib is not installed.
    Cancelled
        ``progress`` returned False. The next run finishes the work, and `undo` reverts it.
    """
    if not 0.0 <= threshold <= HIGHEST_ENTROPY:
        raise InvalidInput("entropy {0}: must be from 0 to {1:g} bits", threshold, HIGHEST_ENTROPY)
    if plot is not None:
        check_matplotlib()
    with locked_folder(folder, only_read=dry_run):
        deciding = deciding_entropies(folder, progress=_half_progress(progress, 0.0))
        steps = [_judge(map_type, one, threshold, move) for map_type, one in deciding.items()]
        drawn = {} if plot is None else draw_all(deciding, plot, threshold)
        if not dry_run:
            _carry_out(
                [(one.folder, table, moves) for one, (_, table, moves) in zip(deciding.values(), steps)],
                _half_progress(progress, 0.5),
            )
    return tuple(replace(cleaned, figures=tuple(map(str, drawn.get(cleaned.map_type, ())))) for cleaned, _, _ in steps)


def undo(
    folder: str | os.PathLike[str], *, dry_run: bool = False, progress: Report | None = None
) -> tuple[Cleaned, ...]:
    """Undo cleaning: move images back, and remove the column ``rejected`` from the tables.

    Parameters, errors and result are those of `clean`; ``rejected`` counts the marks removed. Everything in a folder
    ``rejected`` is moved back, even files that no table names.
    """
    folders = map_type_folders(folder)
    with locked_folder(folder, only_read=dry_run):
        results, steps = [], []
        for map_type, path in folders.items():
            table = Table.load(path / TABLE_FILE)
            images = Images(image_folder(path, table))
            moves = images.moves_back()
            marks = table.other.get(REJECTED, ())
            failed = table.status.count("failed")
            marked, returned = sum(map(bool, marks)), len({move.stem for move in moves})
            results.append(Cleaned(map_type, len(table) - failed, failed, marked, 0, 0, returned, None))
            kept = {header: cells for header, cells in table.other.items() if header != REJECTED}
            steps.append((path, table.replace_other(kept) if REJECTED in table.other else None, moves))
        if not dry_run:
            # Remove the marks last: while they remain, the run counts as interrupted.
            _carry_out([(path, None, moves) for path, _, moves in steps], progress)
            _carry_out([(path, table, []) for path, table, _ in steps], None)
            for path in folders.values():
                Images.remove_if_empty(path)
    return tuple(results)


@contextmanager
def locked_folder(folder: str | os.PathLike[str], *, only_read: bool) -> Iterator[None]:
    """Lock a dataset's folder against captures and other runs unless it is only read; raises OutputError."""
    with ExitStack() as locks:
        # Object stores have no locks.
        folders = [] if only_read or is_address(folder) else [Path(folder)]
        for path in folders:
            # Where a dataset holds several imageries, each of them has a journal.
            for journal in (path / JOURNAL_FILE, *sorted(path.glob(f"*/{JOURNAL_FILE}"))):
                if journal.is_file():
                    locks.enter_context(open_locked(journal))
        yield


def _half_progress(progress: Report | None, start: float) -> Report | None:
    """Scale progress to the half of the work that begins at the share ``start``."""
    return None if progress is None else lambda share: progress(start + share / 2.0)


def _judge(map_type: str, deciding: Deciding, threshold: float, move: bool) -> tuple[Cleaned, Table | None, list[Move]]:
    """Plan the cleaning of a map type: counts, the table if it changes, and the files to move."""
    names, made, decisive = deciding.names, deciding.made, deciding.entropies
    # Rows without an image have NaN, which is never below.
    below = decisive < threshold
    marks = tuple(
        f"{'roadmap ' if by else ''}entropy {value:.3f} below {threshold:g}" if low else ""
        for low, by, value in zip(below.tolist(), deciding.by_roadmap.tolist(), decisive.tolist())
    )
    table = None
    if deciding.table.other.get(REJECTED) != marks:
        table = deciding.table.replace_other({**deciding.table.other, REJECTED: marks})
    out, back = deciding.images.moves(
        [name for name, low in zip(names, below.tolist()) if low and move],
        [name for name, low in zip(names, below.tolist()) if not low],
    )
    suggested = otsu(decisive[made])
    cleaned = Cleaned(
        map_type,
        int(made.sum()),
        int((~made).sum()),
        int(below.sum()),
        int(deciding.by_roadmap.sum()),
        len({one.stem for one in out}),
        len({one.stem for one in back}),
        suggested,
        deciding.measure,
        groups=suggested is not None and separates_groups(decisive[made], suggested),
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
