"""Images of a dataset with their training data, read for display. On any thread; no widgets."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...core.dataset.dataset import read_dataset
from ...core.dataset.folder import PARTS
from ...core.dataset.labels import LABELS_FILE, Labels
from ...core.dataset.table import GAP, REJECTED, SPLIT
from ...core.errors import TerrAInavError
from ...core.storage.files import file_exists
from ..dataset.picture import Depth, DisplayImage, read_depth, read_picture

if TYPE_CHECKING:
    from ...core.dataset.dataset import ImageSet

#: Choices of images besides the parts of a split.
ALL, REJECTED_ONES = "all", "rejected"


class ImagePreview(NamedTuple):
    """An image with its training data.

    Parameters
    ----------
    name : str
    picture : DisplayImage
    depth : Depth or None
        None if the image has no depth map.
    part : str
        One of `PARTS`, or `GAP`; empty if the image is in no part.
    label : tuple of float or None
        Scaled easting and northing; None if there are no labels.
    entropy : float
        Bits; NaN if unknown.
    rejected : str
        Reason of the rejection by cleaning; empty for a kept image.
    """

    name: str
    picture: DisplayImage
    depth: Depth | None
    part: str
    label: tuple[float, float] | None
    entropy: float
    rejected: str


class DatasetTables:
    """The tables of a dataset, and the scaler of its labels.

    Attributes
    ----------
    map_types : tuple of str
    is_split : bool
    labels : Labels or None
    fault : TerrAInavError or None
        Why labels are missing although the dataset has a file for them.
    """

    def __init__(self, folder: Path) -> None:
        """Read tables but no images; raises InvalidInput."""
        self._sets = read_dataset(folder).image_sets
        self.map_types = tuple(self._sets)
        self.is_split = any(SPLIT in one.table.other for one in self._sets.values())
        self.labels: Labels | None = None
        self.fault: TerrAInavError | None = None
        if file_exists(folder / LABELS_FILE):
            try:
                self.labels = Labels.load(folder / LABELS_FILE)
            except TerrAInavError as wrong:
                self.fault = wrong
        self._rows = {name: _image_choices(one) for name, one in self._sets.items()}

    def counts(self, map_type: str) -> dict[str, int]:
        """Number of images of a map type by choice (all, a part, the gap, rejected), without empty choices."""
        return {name: len(rows) for name, rows in self._rows[map_type].items() if len(rows)}

    def previews(self, map_type: str, of: str, first: int, count: int, longest_px: int) -> list[ImagePreview]:
        """Read ``count`` images of a map type and of the choice ``of``, from index ``first``."""
        images = self._sets[map_type]
        rows = self._rows[map_type].get(of, np.zeros(0, np.int64))[first : first + count]
        return self._read(images, rows.tolist(), longest_px)

    def _read(self, images: ImageSet, rows: Sequence[int], longest_px: int) -> list[ImagePreview]:
        table = images.table
        parts, marks = (table.other.get(name, ("",) * len(table)) for name in (SPLIT, REJECTED))
        labels: list[tuple[float, float] | None] = [None] * len(rows)
        if self.labels is not None and len(rows):
            found = self.labels.transform(table.lat_deg[list(rows)], table.lon_deg[list(rows)])
            labels = [(east, north) for east, north in found.tolist()]
        depths = images.folder.parent / "depth"
        return [
            ImagePreview(
                table.img_names[row],
                read_picture(images.path(row), longest_px),
                read_depth(depths / f"{Path(table.img_names[row]).stem}.tif", longest_px),
                parts[row],
                label,
                float(table.entropies[row]),
                marks[row],
            )
            for row, label in zip(rows, labels)
        ]


def _image_choices(images: ImageSet) -> dict[str, np.ndarray]:
    """Rows of existing images in a table, by choice."""
    table = images.table
    existing = np.flatnonzero(table.made)
    parts, marks = (table.other.get(name, ("",) * len(table)) for name in (SPLIT, REJECTED))
    part = np.array([parts[row] for row in existing.tolist()], object)
    mark = np.array([bool(marks[row]) for row in existing.tolist()], np.bool_)
    return {ALL: existing, **{name: existing[part == name] for name in (*PARTS, GAP)}, REJECTED_ONES: existing[mark]}
