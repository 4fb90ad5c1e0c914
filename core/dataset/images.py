"""The image files of a map type, with what belongs to each, in their own folder or among the rejected ones."""

from __future__ import annotations

import contextlib
import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput, OutputError
from .decode import open_image
from .entropy import entropy
from .folder import REJECTED_FOLDER, raster_folders

#: Files that one message names.
_NAMED = 3
_DEGREES = r"-?\d+(?:\.\d+)?(?:e-\d+)?"
#: Images' names without ending, of captures and of the published dataset: column, row, latitude, longitude, zoom.
NAME = re.compile(rf"(\d+)_(\d+)_({_DEGREES})_({_DEGREES})_(\d+)")


@dataclass(frozen=True)
class Move:
    """A file of the image ``stem``, from one place to another on the same file system."""

    stem: str
    origin: Path
    target: Path

    def carry_out(self) -> None:
        """Move it; raises OutputError."""
        try:
            self.target.parent.mkdir(exist_ok=True)
            os.replace(self.origin, self.target)
        except OSError as wrong:
            raise OutputError(
                f"file {self.origin}: cannot be moved to {self.target.parent} ({wrong.strerror}); run it again to "
                "finish, or undo to put all back"
            ) from wrong


class Images:
    """What lies in a map type's folder and in its folder of rejected images, as it is now.

    Raises
    ------
    InvalidInput
        Where a folder cannot be read, or a file is in both.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        there = (folder / REJECTED_FOLDER).is_dir()
        self._kept, others = _files_and_others(folder)
        self._rejected, beside = _files_and_others(folder / REJECTED_FOLDER) if there else (set(), set())
        self._blocked = REJECTED_FOLDER in self._kept | others and not there
        twice = sorted(self._kept & (self._rejected | beside) | self._rejected & others)
        if twice:
            raise InvalidInput(
                f"folder {folder}: {some(twice)} {_is(twice)} in it and in {REJECTED_FOLDER} as well; remove one "
                "of the two"
            )

    def check(self, names: Sequence[str], there: NDArray[np.bool_]) -> None:
        """Raise InvalidInput where a table says otherwise than the files.

        Parameters
        ----------
        names : sequence of str
            Images, of all rows of the table.
        there : array of bool
            Those that have been made.
        """
        foreign = [
            name for name in names if not name or name in (".", "..") or re.search(r"[/\\:\x00]", name)
        ]
        if foreign:
            raise InvalidInput(
                f"folder {self._folder}: {foreign[0]!r} in the table is no name of a file in it"
            )
        stems = Counter(Path(name).stem for name in names)
        twice = [stem for stem, count in stems.items() if count > 1]
        if twice:
            raise InvalidInput(f"folder {self._folder}: the table has {some(twice)} in more than one row")
        files = self._kept | self._rejected
        lost = [name for name, made in zip(names, there.tolist()) if made and name not in files]
        if lost:
            raise InvalidInput(
                f"folder {self._folder}: {some(lost)} of the table {_is(lost)} not there; put "
                f"{'it' if len(lost) == 1 else 'them'} back, or capture again (--resume)"
            )
        endings = {Path(name).suffix for name in names}
        unknown = sorted(
            name
            for name in files
            if Path(name).suffix in endings
            and NAME.fullmatch(Path(name).stem)
            and Path(name).stem not in stems
        )
        if unknown:
            raise InvalidInput(
                f"folder {self._folder}: {some(unknown)} {_is(unknown)} not in the table; finish the capture "
                "(--resume), or remove what does not belong to it"
            )

    def entropy_of(self, name: str) -> float:
        """Entropy of an image that the table has none of; raises InvalidInput where it cannot be read."""
        path = self._folder / (REJECTED_FOLDER if name in self._rejected else "") / name
        return entropy(np.asarray(open_image(path)))

    def moves(self, out: Iterable[str], back: Iterable[str]) -> tuple[list[Move], list[Move]]:
        """Moves of images, by name, to the rejected ones and from there, with every file that belongs to them.

        Those of a file that is there already are left out. Of one image, the image itself is the last that returns and
        the first that leaves: what lies in the folder is whole.

        Raises
        ------
        InvalidInput
            Where a file is in the place of the folder that images would leave for.
        """
        leaving, returning = set(out), set(back)
        if leaving and self._blocked:
            raise InvalidInput(
                f"folder {self._folder}: {REJECTED_FOLDER} in it is no folder, which images are moved to; move it away"
            )
        return (
            self._moves(self._kept, leaving, self._folder, self._folder / REJECTED_FOLDER),
            self._moves(self._rejected, returning, self._folder / REJECTED_FOLDER, self._folder)[::-1],
        )

    def all_back(self) -> list[Move]:
        """Moves of all that lies among the rejected images."""
        origin = self._folder / REJECTED_FOLDER
        return [
            Move(_stem(name, NAME.fullmatch), origin / name, self._folder / name)
            for name in sorted(self._rejected)
        ]

    @staticmethod
    def _moves(files: set[str], images: set[str], origin: Path, target: Path) -> list[Move]:
        stems = {Path(name).stem: name for name in images}
        found = []
        for name in files:
            stem = _stem(name, stems.__contains__)
            if stem in stems:
                found.append((stem, name != stems[stem], name))
        return [Move(stem, origin / name, target / name) for stem, _, name in sorted(found)]

    @staticmethod
    def remove_if_empty(folder: Path) -> None:
        """Remove the folder of rejected images of a map type where nothing lies in it."""
        for one in (folder, *raster_folders(folder)):
            with contextlib.suppress(OSError):
                (one / REJECTED_FOLDER).rmdir()


def _stem(name: str, known: Callable[[str], object]) -> str:
    """Name of the image that a file belongs to: ``a.b`` of ``a.b.tif`` and of ``a.b.tif.aux.xml``."""
    end = name.rfind(".")
    while end > 0:
        if known(name[:end]):
            return name[:end]
        end = name.rfind(".", 0, end)
    return Path(name).stem


def _files_and_others(folder: Path) -> tuple[set[str], set[str]]:
    """Names of files in a folder, and of all else."""
    try:
        with os.scandir(folder) as entries:
            kinds = {entry.name: entry.is_file() for entry in entries}
    except OSError as wrong:
        raise InvalidInput(f"folder {folder}: cannot be read ({wrong.strerror})") from wrong
    files = {name for name, is_file in kinds.items() if is_file}
    return files, kinds.keys() - files


def some(names: Sequence[str]) -> str:
    """The first names, and how many there are beside them."""
    more = len(names) - _NAMED
    return ", ".join(names[:_NAMED]) + (f" and {more:,} more" if more > 0 else "")


def _is(names: Sequence[str]) -> str:
    return "is" if len(names) == 1 else "are"
