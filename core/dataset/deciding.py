"""Which entropy decides over each image of a dataset: the roadmap's of the same place, or the image's own."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import Cancelled
from .dataset import Dataset, read_dataset, rows_made
from .folder import TABLE_FILE, deciding_folder, image_folder, map_type_folders
from .images import Images
from .table import Table

Floats = NDArray[np.float64]

#: What long work tells of: the share done, 0 to 1; an answer of False stops it.
Report = Callable[[float], bool]


@dataclass(frozen=True, eq=False)
class Deciding:
    """The entropies that decide over the images of a map type.

    Parameters
    ----------
    folder : Path
        Of the table.
    table : Table
    image_folder : Path
        Where the images lie; those that cleaning has moved are in ``rejected`` inside.
    images : Images
        Files in it, which agree with the table.
    entropies : array (n,)
        Bits; NaN for rows of images that could not be made.
    by_roadmap : array of bool (n,)
        Rows for which the roadmap's decides, and not the image's own.
    """

    folder: Path
    table: Table
    image_folder: Path
    images: Images
    entropies: Floats
    by_roadmap: NDArray[np.bool_]

    @property
    def names(self) -> tuple[str, ...]:
        """Images by the rows of the table."""
        return self.table.img_names

    @property
    def there(self) -> NDArray[np.bool_]:
        """Rows (n,) whose image has been made."""
        return ~np.isnan(self.entropies)


def entropies_of(dataset: Dataset | str | os.PathLike[str]) -> dict[str, Floats]:
    """Entropies of the images themselves, by map type as in `Dataset.image_sets`.

    Parameters
    ----------
    dataset : Dataset or path
        As `read_dataset` gives it, or takes it.

    Returns
    -------
    dict of str to array (n,)
        Bits, from the table or worked out from the image; NaN for rows of images that could not be made.

    Raises
    ------
    InvalidInput
        A folder that is no dataset, or an image that cannot be read.
    """
    read = dataset if isinstance(dataset, Dataset) else read_dataset(dataset)
    own = {
        map_type: _Own(one.folder, one.table, one.image_folder) for map_type, one in read.image_sets.items()
    }
    _fill_in(list(own.values()), None)
    return {map_type: one.entropies for map_type, one in own.items()}


def deciding_entropies(
    folder: str | os.PathLike[str], *, progress: Report | None = None
) -> dict[str, Deciding]:
    """Entropies that decide over the images of a dataset, by the names of its map types' folders.

    The roadmap's decide for the other map types too, where its images are there; elsewhere the image's own do (the
    paper's section Post Processing). What tables do not have is worked out from the images.

    Parameters
    ----------
    folder : path
        Of a dataset, or of images with a ``meta_data.csv`` beside them.
    progress : callable
        Asked before each image that has to be read.

    Raises
    ------
    InvalidInput
        A folder that is no dataset, a table that cannot be read or says otherwise than the files, or an image that
        cannot be read.
    Cancelled
        ``progress`` said so.
    """
    own = {}
    for name, path in map_type_folders(folder).items():
        table = Table.load(path / TABLE_FILE)
        own[name] = _Own(path, table, image_folder(path, table.img_names))
    _fill_in(list(own.values()), progress)
    found = {}
    for name, one in own.items():
        decider = deciding_folder(name, own)
        entropies, by_roadmap = one.entropies, np.zeros(len(one.table), np.bool_)
        if decider is not None:
            stems = [Path(image).stem for image in one.table.img_names]
            of_roadmap = np.array([own[decider].by_stem.get(stem, math.nan) for stem in stems], np.float64)
            by_roadmap = ~np.isnan(entropies) & ~np.isnan(of_roadmap)
            entropies = np.where(by_roadmap, of_roadmap, entropies)
        found[name] = Deciding(one.folder, one.table, one.image_folder, one.images, entropies, by_roadmap)
    return found


class _Own:
    """The table and the images of a map type, which agree, and the images' own entropies as far as the table has them.

    Attributes
    ----------
    there : array of bool (n,)
        Rows of images that have been made.
    entropies : array (n,)
        NaN for all others.
    """

    def __init__(self, folder: Path, table: Table, images: Path) -> None:
        self.folder, self.table, self.image_folder = folder, table, images
        self.images = Images(images)
        self.there = rows_made(table)
        self.images.check(table.img_names, self.there)
        self.entropies = np.where(self.there, table.entropies, np.nan)

    @cached_property
    def by_stem(self) -> dict[str, float]:
        """Entropies of the images that are there by their names without ending."""
        stems = (Path(name).stem for name in self.table.img_names)
        return {stem: value for stem, value in zip(stems, self.entropies.tolist()) if not math.isnan(value)}


def _fill_in(sets: list[_Own], progress: Report | None) -> None:
    """Work out the entropies that the tables do not have."""
    missing = [
        (one, index) for one in sets for index in np.flatnonzero(one.there & ~np.isfinite(one.entropies))
    ]
    for done, (one, index) in enumerate(missing):
        if progress is not None and not progress(done / len(missing)):
            raise Cancelled("stopped while entropies were worked out: nothing was changed")
        one.entropies[index] = one.images.entropy_of(one.table.img_names[index])
