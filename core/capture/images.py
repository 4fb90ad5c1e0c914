"""Journals of a capture, which state which images exist and which to make; `ImageJournal` notes each image."""

from __future__ import annotations

import contextlib
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from ..arrays import Numbers
from ..dataset.folder import JOURNAL_FILE, REJECTED_FOLDER, TABLE_FILE
from ..dataset.table import other_columns
from ..errors import InvalidInput, OutputError
from ..imagery.placeholder import PLACEHOLDER_REASON, Placeholder
from ..map_types import twin_type
from ..mission.plan import Plan
from ..storage.files import PARTIAL_ENDING, write_whole
from ..storage.stores import list_sizes
from .begun import check_mission
from .folder import LocalFolder, captured_mission, check_captured, has_blocks
from .holding import kept
from .journal import FAILED, Journal, Outcome
from .making import Piece
from .writers import file_endings


class CaptureJournal(ABC):
    """Journal of a capture, opened by the run that holds the place.

    Attributes
    ----------
    root : Path
    images : int
        Number of requested images of each map type.
    in_shards : bool
        Whether images are stored in shards.
    """

    root: Path
    images: int
    in_shards = False

    @abstractmethod
    def check(self) -> None:
        """Raise OutputError if another run has taken the place."""

    @abstractmethod
    def read(
        self, map_type: str, placeholder: Placeholder, *, only_failed: bool
    ) -> tuple[dict[str, Outcome], list[Piece]]:
        """Read the outcomes of earlier runs for a map type.

        Parameters
        ----------
        placeholder : Placeholder
            Images that show a placeholder count as failed.
        only_failed : bool
            Whether to make only images that have failed.

        Returns
        -------
        dict of str to Outcome
            Outcomes of images that exist or have failed, by name.
        list of Piece
            Images to make.
        """

    @abstractmethod
    def note(self, outcome: Outcome) -> None:
        """Note the outcome of an image."""

    def write(self, path: Path, data: bytes) -> None:
        """Write a file, unless another run has taken the place."""
        self.check()
        write_whole(path, data)

    @abstractmethod
    def write_index(self, map_type: str) -> None:
        """Write the index of a map type's shards."""


class ImageJournal(CaptureJournal):
    """Journal with a line for each image, in a local folder."""

    def __init__(self, plan: Plan, root: Path, chosen: Numbers, journal: Journal, hold: Callable[[], None]) -> None:
        self.root, self.images = root, len(chosen)
        self._plan, self._chosen, self._journal, self._hold = plan, chosen, journal, hold
        self._names = set(plan.names)
        self._endings = image_endings(plan)

    @classmethod
    @contextlib.contextmanager
    def opened(
        cls, plan: Plan, root: Path, only: Iterable[int] | None, *, resume: bool, only_failed: bool
    ) -> Iterator[ImageJournal]:
        """Claim a folder for a plan and open its journal, which keeps other runs out.

        Parameters
        ----------
        only : iterable of int or None
            Indices of the captures requested; None for all.

        Raises
        ------
        OutputError
        """
        chosen = choose(plan, only)
        if only_failed:
            check_captured(root)
        if has_blocks(root):
            raise OutputError("folder {0}: was captured in blocks", root, remedy="choose another folder")
        mission = captured_mission(plan)
        LocalFolder(root).claim(mission, resume=resume or only_failed)
        with Journal(root / JOURNAL_FILE) as journal, kept(root / JOURNAL_FILE, journal.file) as check:
            check_mission(root, mission)
            yield cls(plan, root, chosen, journal, check)

    def check(self) -> None:
        """Raise OutputError if another run has taken the folder."""
        self._hold()
        self._journal.check()

    def read(
        self, map_type: str, placeholder: Placeholder, *, only_failed: bool
    ) -> tuple[dict[str, Outcome], list[Piece]]:
        """Read the outcomes of earlier runs for a map type; removes images that show a placeholder."""
        noted = {name: one for (kind, name), one in self._journal.outcomes.items() if kind == map_type}
        foreign = min(set(noted) - self._names, default=None)
        if foreign is not None:
            raise OutputError(
                "folder {0}: holds this mission with other images, such as {1}, because the "
                "source or the version was another",
                self.root,
                foreign,
                remedy="choose another folder",
            )
        folder = self.root / map_type
        # Refuse a table whose other columns cannot be kept before the work rather than after it.
        other_columns(folder / TABLE_FILE)
        complete = find_complete(folder, self._endings, noted)
        folders = [folder]
        for kind in self._plan.mission.varied.twins:
            folders.append(self.root / twin_type(map_type, kind))
            complete &= find_complete(folders[-1], self._endings, {name: one.twin(kind) for name, one in noted.items()})
        known = {name: one for name, one in noted.items() if one.status == FAILED or name in complete}
        for name, outcome in known.items():
            if any(map(placeholder.knows, outcome.repeated)):
                for one in folders:
                    remove_image(one, self._endings, name)
                known[name] = Outcome(map_type, name, reason=PLACEHOLDER_REASON)
                self._journal.add(known[name])

        def is_missing(name: str) -> bool:
            return known[name].status == FAILED if name in known else not only_failed

        names = self._plan.names
        missing = [index for index in self._chosen.tolist() if is_missing(names[index])]
        return known, [Piece(map_type, np.array(missing, np.int64))]

    def note(self, outcome: Outcome) -> None:
        """Append the outcome of an image."""
        self._journal.add(outcome)

    def write_index(self, map_type: str) -> None:
        """Do nothing: there are no shards."""


def choose(plan: Plan, only: Iterable[int] | None) -> Numbers:
    """Return the indices of the requested captures, each once, ascending; raises InvalidInput for unknown indices."""
    if only is None:
        return np.arange(len(plan), dtype=np.int64)
    chosen = np.unique(np.array(list(only), np.int64))
    outside = chosen[(chosen < 0) | (chosen >= len(plan))]
    if len(outside):
        raise InvalidInput("capture {0} of the plan: it has 0 to {1}", outside[0], len(plan) - 1)
    return chosen


def image_endings(plan: Plan) -> tuple[str, ...]:
    """Endings of the files of each image of a plan; the last ending is the image's."""
    return file_endings(plan.mission.output.image_format, on_map=plan.frames.on_map)


def find_complete(folder: Path, endings: tuple[str, ...], outcomes: Mapping[str, Outcome]) -> set[str]:
    """Find the images whose files all exist, with the sizes with which they were written.

    Files that cleaning has moved count as existing. Partial files of a killed run are removed, so the journal must be
    open.

    Parameters
    ----------
    folder : Path
        Folder of a map type.
    endings : tuple of str
        Endings of all files of an image.
    outcomes : mapping of str to Outcome
        Outcomes by image name.
    """
    partial = tuple(ending + PARTIAL_ENDING for ending in endings)
    sizes = file_sizes(folder)
    for name in [name for name in sizes if name.endswith(partial)]:
        with contextlib.suppress(OSError):
            (folder / name).unlink()
    return {name for name, outcome in outcomes.items() if is_complete(outcome, endings, sizes)}


def file_sizes(folder: Path) -> dict[str, int]:
    """Sizes in bytes of a map type's files by name, including files that cleaning has moved."""
    return {**list_sizes(folder / REJECTED_FOLDER), **list_sizes(folder)}


def is_complete(outcome: Outcome, endings: Sequence[str], sizes: Mapping[str, int]) -> bool:
    """Whether all files of an image exist with the sizes with which they were written."""
    lengths = [sizes.get(outcome.name + ending, 0) for ending in endings]
    return all(lengths) and outcome.size_bytes in (0, sum(lengths))


def remove_image(folder: Path, endings: tuple[str, ...], name: str) -> None:
    """Remove all files of an image, including files that cleaning has moved; raises OutputError."""
    for place in (folder, folder / REJECTED_FOLDER):
        for ending in reversed(endings):
            path = place / (name + ending)
            try:
                path.unlink(missing_ok=True)
            except OSError as wrong:
                raise OutputError(
                    "file {0}: cannot be removed ({1})", path, wrong.strerror, remedy="close what shows it"
                ) from wrong
