"""Entropies of images, the choice of the entropy that decides on each image, and the best threshold between them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from ..arrays import Floats, NDArray
from ..errors import Cancelled, InvalidInput
from .dataset import Dataset, Images, open_image, read_dataset
from .folder import MISSION_FILE, TABLE_FILE, deciding_folder, image_folder, map_type_folders, place_key
from .table import Table

#: Entropy of 256 equally frequent grey levels, bits.
HIGHEST_ENTROPY = 8.0
#: Measure of entropies computed by `entropy`.
GREY = "grey"
#: Measure of entropies computed by `pooled_entropy`.
POOLED = "pooled"
#: Measure of entropies computed in another way.
UNKNOWN = "unknown"
MEASURES = (GREY, POOLED, UNKNOWN)
#: Called with the share done, 0 to 1; returning False stops the work.
Report = Callable[[float], bool]


def entropy(image: NDArray[np.uint8]) -> float:
    """Shannon entropy of the histogram of 256 grey levels, the paper's equation 10.

    Parameters
    ----------
    image : array (h, w) or (h, w, 3) of uint8
        Grey, or RGB, which Pillow converts to grey (mode "L", ITU-R BT.601).

    Returns
    -------
    float
        Bits, 0 (one level only) to 8 (all levels equally frequent).

    Raises
    ------
    InvalidInput
        Another shape or type, or an image without pixels.
    """
    grey_or_rgb = image.ndim == 2 or (image.ndim == 3 and image.shape[2] == 3)
    if image.dtype != np.uint8 or not grey_or_rgb or image.size == 0:
        raise InvalidInput(
            "image of shape {0} and type {1}: must be (height, width) or (height, width, 3) of uint8 with "
            "at least one pixel",
            image.shape,
            image.dtype,
        )
    grey = Image.fromarray(np.ascontiguousarray(image)) if image.ndim == 2 else _grey(image)
    # Adding 0 turns the -0 of a single level into 0.
    return float(grey.entropy()) + 0.0


def _grey(image: NDArray[np.uint8]) -> Image.Image:
    """Grey image (mode L) of an RGB image (h, w, 3)."""
    height, width = image.shape[:2]
    # Larger bands do not fit the processor's cache and take three times as long.
    rows = max((1 << 19) // width, 1)
    bands = (
        (top, Image.fromarray(np.ascontiguousarray(image[top : top + rows])).convert("L"))
        for top in range(0, height, rows)
    )
    if rows >= height:
        return next(bands)[1]
    grey = Image.new("L", (width, height))
    for top, band in bands:
        grey.paste(band, (0, top))
    return grey


def pooled_entropy(image: NDArray[np.uint8]) -> float:
    """Shannon entropy of an image (h, w, n) in bits, with all channels in one histogram of 256 values."""
    counts = np.bincount(image.ravel(), minlength=256)
    shares = counts[counts > 0] / image.size
    return float(-(shares * np.log2(shares)).sum()) + 0.0


def otsu(values: NDArray[np.float64]) -> float | None:
    """Threshold that separates values into two groups with the least variance inside them, after Otsu (1979).

    Otsu's criterion is the largest variance between the groups. It is computed at every gap between values instead of
    at the bins of a histogram, whose width would matter.

    Parameters
    ----------
    values : array (n,)
        Finite.

    Returns
    -------
    float or None
        Middle of the gap; None if all values are equal.

    References
    ----------
    N. Otsu, "A threshold selection method from gray-level histograms", IEEE Transactions on Systems, Man, and
    Cybernetics 9(1), 1979, 62-66.
    """
    ordered = np.sort(values)
    gaps = np.flatnonzero(np.diff(ordered) > 0.0)
    if len(gaps) == 0:
        return None
    below = gaps + 1.0
    above = len(ordered) - below
    sums = np.cumsum(ordered)
    means = sums[gaps] / below, (sums[-1] - sums[gaps]) / above
    best = gaps[np.argmax(below * above * (means[1] - means[0]) ** 2)]
    return float((ordered[best] + ordered[best + 1]) / 2.0)


def separates_groups(values: NDArray[np.float64], threshold: float) -> bool:
    """Whether a threshold lies between two groups of values, not inside a single one.

    It does if values near it are at most half as frequent as at the lower of the peaks on either side, by more than
    chance. `otsu` alone separates any values: it cuts a single group through the middle.

    Parameters
    ----------
    values : array (n,)
        Finite.
    """
    ordered = np.sort(values)
    if len(ordered) < 2 or not ordered[0] < threshold <= ordered[-1]:
        return False
    # Values are counted in windows of an eighth of their range.
    width = (ordered[-1] - ordered[0]) / 8.0

    def count_values(places: NDArray[np.float64]) -> NDArray[np.int64]:
        first, last = (np.searchsorted(ordered, places + off) for off in (-width / 2.0, width / 2.0))
        return np.asarray(last - first, np.int64)

    near = int(count_values(np.array([threshold]))[0])
    low, high = (count_values(side).max() for side in (ordered[ordered < threshold], ordered[ordered >= threshold]))
    return bool(near + math.sqrt(near) <= 0.5 * min(int(low), int(high)))


@dataclass(frozen=True, eq=False)
class Deciding:
    """The entropies that decide on the images of a map type.

    Parameters
    ----------
    folder : Path
        Folder of the table.
    image_folder : Path
        Folder of the images; its subfolder ``rejected`` holds the images that cleaning has moved.
    images : Images
        Files of the images, which agree with the table.
    entropies : array (n,)
        Bits; NaN for rows of images that could not be made.
    by_roadmap : array of bool (n,)
        Rows decided by the roadmap's entropy.
    measure : str
        One of `MEASURES`: the kind of entropies in the deciding table.
    """

    folder: Path
    table: Table
    image_folder: Path
    images: Images
    entropies: Floats
    by_roadmap: NDArray[np.bool_]
    measure: str = GREY

    @property
    def names(self) -> tuple[str, ...]:
        """Image names of the rows."""
        return self.table.img_names

    @property
    def made(self) -> NDArray[np.bool_]:
        """Rows (n,) whose image has been made."""
        return ~np.isnan(self.entropies)


def image_entropies(dataset: Dataset | str | os.PathLike[str]) -> dict[str, Floats]:
    """Entropies of the images, by map type as in `Dataset.image_sets`.

    Parameters
    ----------
    dataset : Dataset or path
        Dataset, or a folder that `read_dataset` reads.

    Returns
    -------
    dict of str to array (n,)
        Bits, from the table or computed from the image; NaN for rows of images that could not be made.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, or an image cannot be read.
    """
    read = dataset if isinstance(dataset, Dataset) else read_dataset(dataset)
    found = {
        map_type: _KnownEntropies(one.folder, one.table, one.image_folder) for map_type, one in read.image_sets.items()
    }
    _compute_missing(list(found.values()), None)
    return {map_type: one.entropies for map_type, one in found.items()}


def deciding_entropies(folder: str | os.PathLike[str], *, progress: Report | None = None) -> dict[str, Deciding]:
    """Entropies that decide on the images of a dataset, by the names of its map types' folders.

    Where the dataset has roadmap images, their entropies decide for all map types; elsewhere, each image's entropy
    decides (the paper's section Post Processing), or that of its clean image. Entropies missing from the tables are
    computed from the images.

    Parameters
    ----------
    folder : path
        Dataset, or images with a ``meta_data.csv`` beside them.
    progress : callable
        Called before each image that has to be read; returning False stops the work.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, a table cannot be read or disagrees with the files, or an image cannot be read.
    Cancelled
        ``progress`` returned False.
    """
    folders, known = map_type_folders(folder), {}
    place = place_key(folder, folders.values())
    for name, path in folders.items():
        table = Table.load(path / TABLE_FILE)
        known[name] = _KnownEntropies(path, table, image_folder(path, table))
    measures = {name: one.measure() for name, one in known.items()}
    _compute_missing(list(known.values()), progress)
    found = {}
    for name, one in known.items():
        decider = deciding_folder(name, folders)
        entropies, by_roadmap = one.entropies, np.zeros(len(one.table), np.bool_)
        if decider is not None:
            of_place = known[decider].entropies_by_place(place)
            of_roadmap = np.array([of_place.get(place(image), math.nan) for image in one.table.img_names], np.float64)
            by_roadmap = ~np.isnan(entropies) & ~np.isnan(of_roadmap)
            entropies = np.where(by_roadmap, of_roadmap, entropies)
        measure = measures[decider if decider is not None and by_roadmap.any() else name]
        found[name] = Deciding(one.folder, one.table, one.image_folder, one.images, entropies, by_roadmap, measure)
    return found


class _KnownEntropies:
    """Table, images and known entropies of a map type; table and images agree.

    Attributes
    ----------
    made : array of bool (n,)
        Rows of images that have been made.
    entropies : array (n,)
        Bits; NaN for other rows, and where the table has no entropy.
    """

    def __init__(self, folder: Path, table: Table, images: Path) -> None:
        self.folder, self.table, self.image_folder = folder, table, images
        self.images = Images(images)
        self.made = table.made
        self.images.check(table.img_names, self.made)
        self.entropies = np.where(self.made, table.entropies, np.nan)

    def measure(self) -> str:
        """Identify the measure of the table's entropies from some images; `GREY` for captures and without entropies."""
        if (self.folder.parent / MISSION_FILE).is_file():
            # Computed before JPEG compression, whose losses can add half a bit and more to flat colours.
            return GREY
        stated = np.flatnonzero(np.isfinite(self.entropies))
        # Five images suffice to identify the measure.
        sample = stated[:: max(-(-len(stated) // 5), 1)]
        errors = []
        for index in sample.tolist():
            path = self.images.path(self.table.img_names[index])
            image = np.asarray(open_image(path, as_shown=True))
            in_table = float(self.entropies[index])
            errors.append([abs(one(image) - in_table) for one in (entropy, pooled_entropy)])
        if not errors:
            return GREY
        typical = np.median(errors, axis=0)
        # JPEG losses change an entropy by up to 0.1 bits.
        return MEASURES[int(np.argmin(typical))] if typical.min() <= 0.1 else UNKNOWN

    def entropies_by_place(self, place: Callable[[str], str]) -> dict[str, float]:
        """Entropies of the images that exist, by place."""
        named = zip(self.table.img_names, self.entropies.tolist())
        return {place(name): value for name, value in named if not math.isnan(value)}


def _compute_missing(sets: list[_KnownEntropies], progress: Report | None) -> None:
    """Compute the entropies that are missing from the tables."""
    missing = [(one, index) for one in sets for index in np.flatnonzero(one.made & ~np.isfinite(one.entropies))]
    for done, (one, index) in enumerate(missing):
        if progress is not None and not progress(done / len(missing)):
            raise Cancelled("stopped while entropies were worked out: nothing was changed")
        one.entropies[index] = entropy(
            np.asarray(open_image(one.images.path(one.table.img_names[index]), as_shown=True))
        )
