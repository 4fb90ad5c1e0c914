"""Pairs of queries and tiles for training, in the interface of `dataset.loading`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import NDArray
from ..dataset.dataset import open_image
from ..dataset.folder import TRAIN
from ..dataset.label_images import read_label_image
from ..dataset.loading.augment import resize_labels
from ..dataset.loading.batches import ALL, BYTES, FLOATS, BatchLabels, Indices, check_size
from ..dataset.loading.streaming import random_numbers
from ..errors import InvalidInput
from ..storage.stores import Address
from .folder import POSITIVE, Benchmark

Images = tuple[NDArray[Any], NDArray[Any]]


class Pairs:
    """Pairs of a query and a tile that show the same ground, in the order of ``positives.csv``.

    `Batches`, `TorchDataset` and `KerasDataset` accept an instance in place of a dataset, and then return images of the
    query and the tile, with labels ``iou`` and ``positive``; with ``instances``, labels are a tuple of the instances
    (b, height, width) of int64 of the queries' pixels, and these numbers.

    Parameters
    ----------
    benchmark : Benchmark or path
    part : {"train", "validation", "test", "all"}
        Part of the queries; tiles are from the gallery of this part.
    with_semi : bool
        Include semi-positive tiles.
    img_size, tile_size : tuple (width, height, channels)
        Sizes that queries and tiles are resized to; ``tile_size`` defaults to ``img_size``.
    seed : int
        Seed of the order.
    shuffle : bool or "auto"
        ``auto`` shuffles the training part only. Each epoch is shuffled differently.
    dtype : {"float32", "uint8"}
        Type of pixels, which are from 0 to 1 or from 0 to 255.
    instances : bool
        Whether to give the buildings that queries show: their numbers, 0 elsewhere, resized by the nearest rule.

    Attributes
    ----------
    query, reference : array (n,) of int64
        Rows of the benchmark's queries and tiles.
    names : tuple of str
    values : array (n, 2) of float32
        Intersection over union; 1 for a positive, 0 for a semi-positive.
    columns : ("iou", "positive")

    Raises
    ------
    InvalidInput
        An unknown part, a part without pairs, an invalid parameter, or instances of a benchmark without buildings.
    """

    columns = ("iou", "positive")

    def __init__(
        self,
        benchmark: Benchmark | Address,
        *,
        part: str = TRAIN,
        with_semi: bool = True,
        img_size: Sequence[int] = (224, 224, 3),
        tile_size: Sequence[int] | None = None,
        seed: int = 2024,
        shuffle: bool | str = "auto",
        dtype: str = FLOATS,
        instances: bool = False,
    ) -> None:
        if dtype not in (FLOATS, BYTES):
            raise InvalidInput("dtype {0!r}: must be one of {1}", dtype, f"{FLOATS}, {BYTES}")
        if shuffle not in (True, False, "auto"):
            raise InvalidInput("shuffle {0!r}: must be True, False or 'auto'", shuffle)
        self.benchmark = benchmark if isinstance(benchmark, Benchmark) else Benchmark.read(Path(benchmark))
        if instances and not self.benchmark.has_buildings:
            raise InvalidInput("instances: the benchmark in {0} has no buildings", self.benchmark.folder)
        self._with_instances = instances
        self.sizes = check_size(img_size), check_size(img_size if tile_size is None else tile_size)
        self.seed, self.shuffle = seed, part == TRAIN if isinstance(shuffle, str) else shuffle
        self.dtype, self.folder = np.dtype(dtype), self.benchmark.folder
        truth, one = self.benchmark.truth, "" if part == ALL else part
        query = np.array([self.benchmark.query_rows[name] for name in truth.query], np.int64)
        reference = np.array([self.benchmark.reference_rows[name] for name in truth.reference], np.int64)
        positive = np.array([kind == POSITIVE for kind in truth.kind], np.bool_)
        taken = np.isin(query, self.benchmark.query_rows_in(one)) & np.isin(reference, self.benchmark.gallery(one))
        rows = np.flatnonzero(taken & (positive | with_semi))
        if not len(rows):
            raise InvalidInput("part {0!r}: the benchmark in {1} has no pairs of it", part, self.folder)
        self.query, self.reference = query[rows], reference[rows]
        self.values = np.stack([truth.iou[rows], positive[rows]], axis=1).astype(np.float32)
        self.names = tuple(f"{truth.query[row]} {truth.reference[row]}" for row in rows.tolist())

    def __len__(self) -> int:
        return len(self.query)

    def order(self, epoch: int = 0) -> NDArray[np.int64]:
        """Indices (n,) of the pairs in the order of an epoch, which depends only on epoch, seed and number of pairs."""
        if not self.shuffle:
            return np.arange(len(self))
        return np.argsort(random_numbers(f"{self.seed}:{epoch}", len(self)), kind="stable")

    def batch(self, indices: Indices, _epoch: int = 0) -> tuple[Images, BatchLabels]:
        """Images (b, height, width, channels) of queries and of tiles, and labels (b, 2), of some pairs.

        With instances, the labels are a tuple of these (b, height, width) and the labels (b, 2).

        Raises
        ------
        InvalidInput
            An image cannot be read; the message names it.
        """
        at = np.asarray(indices, np.int64)
        queries, references = self.benchmark.queries, self.benchmark.references
        found = (
            self._pixels([files[row] for row in rows[at].tolist()], size)
            for files, rows, size in zip((queries.file, references.file), (self.query, self.reference), self.sizes)
        )
        images = next(found), next(found)
        return images, (self._instances(at), self.values[at]) if self._with_instances else self.values[at]

    take = batch

    def _instances(self, indices: NDArray[np.int64]) -> NDArray[np.int64]:
        """Numbers (b, height, width) of the buildings that the pairs' queries show."""
        width, height, _ = self.sizes[0]
        files = (self.benchmark.instance_file(row) for row in self.query[indices].tolist())
        return np.stack([resize_labels(read_label_image(file), height, width) for file in files])

    def _pixels(self, files: Sequence[str], size: tuple[int, int, int]) -> NDArray[Any]:
        width, height, channels = size
        found = np.empty((len(files), height, width, channels), self.dtype)
        for one, file in zip(found, files):
            image = open_image(self.folder / file, size, as_shown=True)
            one[...] = np.asarray(image).reshape(one.shape)
        if self.dtype != np.uint8:
            np.divide(found, np.float32(255.0), out=found)
        return found
