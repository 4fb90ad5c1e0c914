"""Entropy of images, the threshold that separates a dataset, and the entropy that decides on each image."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..arrays import Floats
from ..errors import Cancelled, InvalidInput
from .dataset import Dataset, Images, open_image, read_dataset
from .folder import MISSION_FILE, TABLE_FILE, deciding_folder, image_folder, map_type_folders, place_key
from .table import Table

#: Of 256 grey levels, in bits.
HIGHEST_ENTROPY = 8.0
#: Which entropies a table holds: those of `entropy`, of `pooled_entropy`, or of neither.
GREY, POOLED, UNKNOWN = MEASURES = ("grey", "pooled", "unknown")
#: Images sampled to find the measure, and the most that JPEG losses change an entropy by, bits.
_TELLING, _LOST = 5, 0.1
#: Called with the share done, 0 to 1; returning False stops the work.
Report = Callable[[float], bool]
#: Of a valley between two groups: width of the windows in which values are counted, as a share of their range, and how
#: many may be in it, as a share of those at the lower peak.
_WINDOW, _VALLEY = 1.0 / 8.0, 0.5


def entropy(image: NDArray[np.uint8]) -> float:
    """Shannon entropy of the histogram of 256 grey levels, the paper's equation 10.

    Parameters
    ----------
    image : array (h, w) or (h, w, 3) of uint8
        Grey, or RGB that is made grey by ITU-R 601 as Pillow's mode "L" has it.

    Returns
    -------
    float
        Bits, 0 (one level only) to 8 (every level equally often).

    Raises
    ------
    InvalidInput
        For any other shape or type, or an image without pixels.
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
    """Grey image (mode L) of an RGB one (h, w, 3)."""
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
    """Shannon entropy in bits of the values of all channels of an image (h, w, n) in one histogram of 256."""
    counts = np.bincount(image.ravel(), minlength=256)
    shares = counts[counts > 0] / image.size
    return float(-(shares * np.log2(shares)).sum()) + 0.0


def otsu(values: NDArray[np.float64]) -> float | None:
    """Threshold that parts values in two groups with the least variance inside them, after Otsu (1979).

    Otsu's criterion is the largest variance between the groups; here it is taken at every gap between values and not
    at the bins of a histogram, so that it does not depend on their width.

    Parameters
    ----------
    values : array (n,)
        Finite.

    Returns
    -------
    float or None
        Middle of the gap; None where there are no two different values.

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


def parts_groups(values: NDArray[np.float64], threshold: float) -> bool:
    """Whether a threshold lies between two groups of values, and not inside the only one.

    Between groups, values are at most half as frequent about it as at the peaks on either side, by more than their
    number may vary by chance. `otsu` parts any values, also those of one group, which it cuts through the middle.

    Parameters
    ----------
    values : array (n,)
        Finite.
    """
    ordered = np.sort(values)
    if len(ordered) < 2 or not ordered[0] < threshold <= ordered[-1]:
        return False
    width = (ordered[-1] - ordered[0]) * _WINDOW

    def count_values(places: NDArray[np.float64]) -> NDArray[np.int64]:
        first, last = (np.searchsorted(ordered, places + off) for off in (-width / 2.0, width / 2.0))
        return np.asarray(last - first, np.int64)

    about = int(count_values(np.array([threshold]))[0])
    low, high = (count_values(side).max() for side in (ordered[ordered < threshold], ordered[ordered >= threshold]))
    return bool(about + math.sqrt(about) <= _VALLEY * min(int(low), int(high)))


@dataclass(frozen=True, eq=False)
class Deciding:
    """The entropies that decide over the images of a map type.

    Parameters
    ----------
    folder : Path
        Of the table.
    image_folder : Path
        Where the images lie; those that cleaning has moved are in ``rejected`` inside.
    images : Images
        Files in it, which agree with the table.
    entropies : array (n,)
        Bits; NaN for rows of images that could not be made.
    by_roadmap : array of bool (n,)
        Rows for which the roadmap's decides, and not the image's own.
    measure : str
        One of `MEASURES`: which entropies the table of those that decide holds.
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
    own = {map_type: _Own(one.folder, one.table, one.image_folder) for map_type, one in read.image_sets.items()}
    _compute_missing(list(own.values()), None)
    return {map_type: one.entropies for map_type, one in own.items()}


def deciding_entropies(folder: str | os.PathLike[str], *, progress: Report | None = None) -> dict[str, Deciding]:
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
        ``progress`` returned False.
    """
    folders, own = map_type_folders(folder), {}
    place = place_key(folder, folders.values())
    for name, path in folders.items():
        table = Table.load(path / TABLE_FILE)
        own[name] = _Own(path, table, image_folder(path, table))
    measures = {name: one.measure() for name, one in own.items()}
    _compute_missing(list(own.values()), progress)
    found = {}
    for name, one in own.items():
        decider = deciding_folder(name, folders)
        entropies, by_roadmap = one.entropies, np.zeros(len(one.table), np.bool_)
        if decider is not None:
            of_place = own[decider].entropies_by_place(place)
            of_roadmap = np.array([of_place.get(place(image), math.nan) for image in one.table.img_names], np.float64)
            by_roadmap = ~np.isnan(entropies) & ~np.isnan(of_roadmap)
            entropies = np.where(by_roadmap, of_roadmap, entropies)
        measure = measures[decider if decider is not None and by_roadmap.any() else name]
        found[name] = Deciding(one.folder, one.table, one.image_folder, one.images, entropies, by_roadmap, measure)
    return found


class _Own:
    """Table, images and known entropies of a map type; table and images agree.

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
        self.there = table.made
        self.images.check(table.img_names, self.there)
        self.entropies = np.where(self.there, table.entropies, np.nan)

    def measure(self) -> str:
        """Which entropies the table holds, by some of its images; `GREY` of a capture, and where it holds none."""
        if (self.folder.parent / MISSION_FILE).is_file():
            # Worked out before the image was a JPEG, whose losses may add half a bit and more to flat colours.
            return GREY
        stated = np.flatnonzero(np.isfinite(self.entropies))
        some = stated[:: max(-(-len(stated) // _TELLING), 1)]
        off = []
        for index in some.tolist():
            path = self.images.path(self.table.img_names[index])
            image = np.asarray(open_image(path, as_shown=True))
            own = float(self.entropies[index])
            off.append([abs(one(image) - own) for one in (entropy, pooled_entropy)])
        if not off:
            return GREY
        nearness = np.median(off, axis=0)
        return MEASURES[int(np.argmin(nearness))] if nearness.min() <= _LOST else UNKNOWN

    def entropies_by_place(self, place: Callable[[str], str]) -> dict[str, float]:
        """Entropies of the images that are there by their places."""
        named = zip(self.table.img_names, self.entropies.tolist())
        return {place(name): value for name, value in named if not math.isnan(value)}


def _compute_missing(sets: list[_Own], progress: Report | None) -> None:
    """Compute the entropies that are missing from the tables."""
    missing = [(one, index) for one in sets for index in np.flatnonzero(one.there & ~np.isfinite(one.entropies))]
    for done, (one, index) in enumerate(missing):
        if progress is not None and not progress(done / len(missing)):
            raise Cancelled("stopped while entropies were worked out: nothing was changed")
        one.entropies[index] = entropy(
            np.asarray(open_image(one.images.path(one.table.img_names[index]), as_shown=True))
        )
