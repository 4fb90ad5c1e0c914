"""Cleaning: images with too little to see are marked in the table, and moved out of the way where that is wanted.

Nothing is deleted. The table is written whole before a file is moved, and each file is in one of its two places at any
time, so that a run that was interrupted can be finished by another one or taken back.
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
from .entropy import GREY, HIGHEST_ENTROPY, Deciding, Report, deciding_entropies, otsu, parts_groups
from .figures import draw_all
from .folder import DEFAULT_ENTROPY, JOURNAL_FILE, TABLE_FILE, image_folder, map_type_folders
from .table import REJECTED, Table


@dataclass(frozen=True)
class Cleaned:
    """Result of cleaning one map type, or of a dry run.

    Parameters
    ----------
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
    measure : str
        One of `entropy.MEASURES`: which entropies the table holds that decides.
    figures : tuple of str
        Paths of the diagrams that were written.
    groups : bool
        Whether the suggested threshold lies between two groups of entropies; else nothing stands out.
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
        """Whether the threshold separates hardly anything: it rejects nothing, or at least 95 %."""
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
    """Reject images with an entropy below a threshold, of every map type of a dataset.

    The roadmap's entropies decide for the other map types too, where its images are there; elsewhere the image's own
    do (see `deciding_entropies`). Rejected rows say why in the column ``rejected``. An image that is
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
        Change nothing in the dataset.
    plot : path or None
        Folder for the diagrams of the entropies (see `figures.save_figures`), which are written before anything is
        changed, in a dry run too.
    progress : callable
        Called with the share done, 0 to 1; returning False stops the run.

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
        Another run is at work in the folder, something cannot be written or moved, or matplotlib is not there to draw
        with.
    Cancelled
        ``progress`` returned False; the next run finishes the work, and `undo` reverts it.
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
    """Take cleaning back: images return to their places, and tables have no column ``rejected`` any more.

    Parameters, errors and result are those of `clean`; ``rejected`` counts the marks that were taken away. All that
    lies in a folder ``rejected`` returns, also what no table names.
    """
    folders = map_type_folders(folder)
    with locked_folder(folder, only_read=dry_run):
        results, steps = [], []
        for map_type, path in folders.items():
            table = Table.load(path / TABLE_FILE)
            images = Images(image_folder(path, table))
            moves = images.all_back()
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
    """Keep captures and other runs out of a dataset's folder, unless it is only read; raises OutputError."""
    with ExitStack() as locks:
        # Object stores know no locks.
        folders = [] if only_read or is_address(folder) else [Path(folder)]
        for path in folders:
            # Imageries beside each other have a journal each, below that of their folder.
            for journal in (path / JOURNAL_FILE, *sorted(path.glob(f"*/{JOURNAL_FILE}"))):
                if journal.is_file():
                    locks.enter_context(open_locked(journal))
        yield


def _half_progress(progress: Report | None, start: float) -> Report | None:
    """Report progress of the half of the work that starts at a share."""
    return None if progress is None else lambda share: progress(start + share / 2.0)


def _judge(map_type: str, deciding: Deciding, threshold: float, move: bool) -> tuple[Cleaned, Table | None, list[Move]]:
    """Plan the cleaning of a map type: counts, the table if it changes, and the files to move."""
    names, there, decisive = deciding.names, deciding.there, deciding.entropies
    # A row without an image compares as not below.
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
    suggested = otsu(decisive[there])
    cleaned = Cleaned(
        map_type,
        int(there.sum()),
        int((~there).sum()),
        int(below.sum()),
        int(deciding.by_roadmap.sum()),
        len({one.stem for one in out}),
        len({one.stem for one in back}),
        suggested,
        deciding.measure,
        groups=suggested is not None and parts_groups(decisive[there], suggested),
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
