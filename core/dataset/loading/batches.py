"""Select images and labels for training, and make batches of numpy arrays."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any, Protocol, TypeVar, Union, runtime_checkable

import numpy as np

from ...arrays import NDArray
from ...bands import Bands
from ...errors import InvalidInput, Message, OptionName, OutputError
from ...external.importing import imported
from ...geodesy.contract import CameraContract
from ...labels.classes import ClassTable
from ...numbers import real_number
from ...storage.stores import Address, is_address, is_file
from ..dataset import Dataset, ImageSet, first_names, open_image, read_band_metadata, read_dataset
from ..folder import (
    ATTITUDE,
    CAMERA,
    CLASSES,
    HEIGHT,
    IMAGE,
    PARTS,
    PIXEL_LABELS,
    TABLE_FILE,
    TARGETS,
    TRAIN,
)
from ..label_images import LabelImages
from ..labels import LABELS_FILE, Labels, make_dataset_labels
from ..stored import ImageFile, StoredImage
from ..table import GAP, image_parts, usable_rows
from .augment import Augmentation, Change, change_labels, resize_labels
from .streaming import ShardCache, Shards, random_numbers

_Batch = TypeVar("_Batch")
Indices = Union[Sequence[int], NDArray[np.int64]]
#: Labels of a batch: numbers (b, k), labels of pixels (b, height, width), or a tuple of arrays.
BatchLabels = Union[NDArray[Any], tuple[NDArray[Any], ...]]

#: All images except failed and rejected ones, whether or not the dataset is split.
ALL = "all"
#: Values from 0 to 1.
FLOATS = "float32"
#: Values from 0 to 255.
BYTES = "uint8"
#: Values and bands as in the files.
STORED = "stored"
DTYPES = (FLOATS, BYTES, STORED)
#: Columns of labels by target.
_COLUMNS = {
    IMAGE: ("easting", "northing"),
    CAMERA: ("camera_easting", "camera_northing"),
    HEIGHT: ("agl_m",),
    ATTITUDE: ("yaw_deg", "tilt_deg", "roll_deg"),
}


class LabelledImages:
    """Images of one part of a map type and their labels, by index, in the table's order.

    Failed and rejected images are left out. An instance holds names and labels but no pixels, and can be pickled.

    Parameters
    ----------
    map_type : str or None
        Map type; None for ``satellite``, or the first one if the dataset has no such images.
    part : {"train", "validation", "test", "all"}
        Part of the dataset; ``all`` needs no split.
    img_size : tuple (width, height, channels) or None
        Size that images are resized to; None keeps their size, which must then be the same for all.
    seed : int
        Seed of order and augmentation.
    shuffle : bool or "auto"
        ``auto`` shuffles the training part, anew for each epoch, and keeps other parts in the table's order, shard by
        shard if there are shards.
    augment : Augmentation, None or "auto"
        ``auto`` augments the training part only, as in the paper; None augments nothing.
    dtype : {"float32", "uint8", "stored"}
        Type of images: 0 to 1, or 0 to 255, which takes a quarter of the memory. ``stored`` keeps all bands and values
        of the files, also of more than 8 bits; such images are not resized or augmented.
    layout : str
        Layout of the folder (see `read_dataset`).
    labels : Labels or None
        None reads the dataset's ``labels.json`` or, without such a file, makes labels in UTM, scaled by the training
        part, or by all images if the dataset is not split.
    targets : sequence of str
        Contents of the labels, in order: the ``image``'s centre on the ground and the ``camera``'s position, as scaled
        eastings and northings; the camera's ``height`` above ground in metres, and its ``attitude``: yaw, tilt and roll
        in degrees. With either, ``auto`` augments nothing, as rotating and zooming would make it wrong. ``classes`` and
        ``instances`` are labels (height, width) of the pixels, see `pixel_labels`. Any other name is that of an
        additional column of numbers in the table, such as ``exposure_ms``.
    shards_at_once : int
        Number of shards in a group; with shards as captures pack them, a group holds some thousands of images. Shards
        are shuffled, and then the images of each group. A larger number makes the order more random, but keeps more
        shards of an object store.
    cache_mb : float or None
        Disk space for shards of an object store in the system's temporary folder; None for the space of three
        times ``shards_at_once`` shards.

    Attributes
    ----------
    names : tuple of str
        Image names without ending.
    values : array (n, k) of float32
        Labels, without those of pixels.
    columns : tuple of k str
        Names of the label columns, with units; ``easting`` and ``northing`` are scaled.
    labels : Labels
        Frame and scaler of positions; `Labels.positions` converts back to latitude and longitude.
    pixel_targets : tuple of str
        Those of ``classes`` and ``instances`` that are among the targets, in their order.
    bands : Bands or None
        With ``stored``, the bands that the first image states: names, and scale, offset and unit of values
        (`Bands.each_metadata`). None with other types, and if the image states no bands.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, lacks the map type or part, or has no images in that part; or a value is invalid.
    """

    def __init__(
        self,
        dataset: Dataset | Address,
        *,
        map_type: str | None = None,
        part: str = TRAIN,
        img_size: Sequence[int] | None = None,
        seed: int = 2024,
        shuffle: bool | str = "auto",
        augment: Augmentation | str | None = "auto",
        dtype: str = "float32",
        layout: str = "TerrAInav",
        labels: Labels | None = None,
        targets: Sequence[str] = (IMAGE,),
        shards_at_once: int = 8,
        cache_mb: float | None = None,
    ) -> None:
        _check(part, shuffle, augment, dtype)
        if shards_at_once < 1:
            raise InvalidInput("shards at once {0}: must be 1 or more", shards_at_once)
        if cache_mb is not None and not cache_mb >= 0.0:
            raise InvalidInput("cache of {0} MB: must be 0 MB or more", cache_mb)
        may_turn = _check_targets(targets, augment)
        if not isinstance(dataset, Dataset):
            dataset = read_dataset(dataset, layout)
        self.part, self.img_size, self.seed = part, None if img_size is None else check_size(img_size), seed
        self.shuffle = part == TRAIN if isinstance(shuffle, str) else shuffle
        default = Augmentation() if part == TRAIN and may_turn else None
        self.augment = default if isinstance(augment, str) else augment
        self._is_stored = dtype == STORED
        if self._is_stored:
            _check_stored(self.img_size, augment)
            self.augment = None
        self.images = _images(dataset, map_type)
        self._rows = _rows(self.images, part)
        self.names = tuple(Path(self.images.table.img_names[row]).stem for row in self._rows)
        self._shards, self._cache = _streamed(self.images, self._rows, shards_at_once, cache_mb)
        self.labels = _labels(dataset, self.images) if labels is None else labels
        self.columns = tuple(column for target in targets for column in _label_columns(target))
        self.pixel_targets = tuple(target for target in targets if target in PIXEL_LABELS)
        self._label_images = LabelImages(self.images)
        if self.pixel_targets:
            # Read the table now, so that a dataset without labels is refused at once.
            _ = self.classes
        self.values = np.concatenate([_values(one, self.labels, self.images, self._rows) for one in targets], axis=1)
        self.shape, self.dtype = self._shape(), np.dtype(BYTES if self._is_stored else dtype)
        self.bands: Bands | None = None
        if self._is_stored:
            self.dtype = self._stored(0).dtype
            self.bands = read_band_metadata(self.file(0), self.shape[2])

    def _shape(self) -> tuple[int, int, int]:
        """Height, width and channels of all images."""
        if self.img_size is not None:
            width, height, channels = self.img_size
            return height, width, channels
        if self._is_stored:
            height, width, channels = self._stored(0).shape
            return height, width, channels
        first = open_image(self.file(0))
        return first.height, first.width, len(first.getbands())

    def _stored(self, index: int) -> NDArray[Any]:
        """Read the values (h, w, bands) of an image's file."""
        found = self.images.pixels(int(self._rows[index]), file=self.file(index))
        return found[..., np.newaxis] if found.ndim == 2 else found

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def folder(self) -> Address:
        """Folder or address of the images."""
        return self.images.folder

    @property
    def classes(self) -> ClassTable:
        """Ids, names and colours of the dataset's classes, and the ids of background and ignore.

        Raises
        ------
        InvalidInput
            The dataset has no labels of pixels.
        """
        return self._label_images.classes

    def path(self, index: int) -> Path:
        """File of an image; raises InvalidInput if images are not files of a local folder."""
        return self.images.path(int(self._rows[index]))

    def file(self, index: int) -> ImageFile:
        """File of an image: a path, an object or a range of a shard."""
        found = self.images.file(int(self._rows[index]))
        if self._cache is None or not isinstance(found, StoredImage):
            return found
        return replace(found, copy=self._cache.copy(found.place.name))

    def contract(self, index: int) -> CameraContract:
        """What the pixels of an image mean before it is resized or augmented; see `image_contract`."""
        return self.images.contract(int(self._rows[index]))

    def order(self, epoch: int = 0) -> NDArray[np.int64]:
        """Indices (n,) in the order of an epoch, which depends on seed and table only.

        A shuffled order is that of sorted random numbers (see `random_numbers`). In a dataset of shards, the images of
        a group of shards stay together. Without shuffling, images are in the table's order, shard by shard.
        """
        if self._shards is not None:
            return self._shards.order(self._key(epoch))
        if not self.shuffle:
            return np.arange(len(self))
        return np.argsort(random_numbers(self._key(epoch), len(self)), kind="stable")

    def _key(self, epoch: int) -> str:
        """Key of an epoch's order; empty for the order of the table."""
        return f"{self.seed}:{epoch}" if self.shuffle else ""

    def image(self, index: int, epoch: int = 0) -> NDArray[Any]:
        """Read an image for an epoch: pixels (height, width, channels) of uint8, or as stored.

        Raises
        ------
        InvalidInput
            The image cannot be read, has another size than the table states, or, without ``img_size``, has another size
            than the first image.
        """
        path = self.file(index)
        if self._is_stored:
            stored = self._stored(index)
            if stored.shape != self.shape or stored.dtype != self.dtype:
                raise InvalidInput(
                    "image {0}: has {1} x {2} px, {3} bands of {4}, where the first one has {5} x {6}, {7} of {8}",
                    path,
                    stored.shape[1],
                    stored.shape[0],
                    stored.shape[2],
                    stored.dtype,
                    self.shape[1],
                    self.shape[0],
                    self.shape[2],
                    self.dtype,
                )
            return stored
        found = open_image(path, self.img_size, self.images.expected_px(int(self._rows[index])))
        height, width, channels = self.shape
        if (*found.size, len(found.getbands())) != (width, height, channels):
            raise InvalidInput(
                "image {0}: has {1} x {2} px and {3} channels, where the first one has {4} x {5} and {6}; "
                "an img_size such as {7} {8} {9} makes them equal",
                path,
                found.width,
                found.height,
                len(found.getbands()),
                width,
                height,
                channels,
                width,
                height,
                channels,
            )
        if self.augment is not None:
            found = self.augment.apply(found, self.names[index], self.seed, epoch)
        return np.asarray(found).reshape(self.shape)

    def pixel_labels(self, index: int, epoch: int = 0) -> tuple[NDArray[np.int64], ...]:
        """Read the labels (height, width) of an image's pixels for an epoch, one array for each of ``pixel_targets``.

        They are resized, rotated, mirrored and zoomed with the image, by the nearest rule. Where an augmented image
        shows its reflection, its class is `ClassTable.ignore` and its instance 0.

        Raises
        ------
        InvalidInput
            The labels cannot be read, or have another size than the image.
        """
        height, width, _ = self.shape
        change = Change()
        if self.augment is not None:
            change = self.augment.draw_change(self.names[index], self.seed, epoch)
        found = []
        for target in self.pixel_targets:
            labels = self._label_images.pixels(target, int(self._rows[index]), image=self.file(index))
            if self.img_size is not None:
                labels = resize_labels(labels, height, width)
            elif labels.shape != (height, width):
                raise InvalidInput(
                    "{0} of {1}: of {2} x {3} px, where images have {4} x {5}",
                    target,
                    self.names[index],
                    *labels.shape[::-1],
                    width,
                    height,
                )
            found.append(change_labels(labels, change, self.classes.ignore if target == CLASSES else 0))
        return tuple(found)

    def batch(self, indices: Indices, epoch: int = 0) -> tuple[NDArray[Any], BatchLabels]:
        """Read images and labels as `take` does, for indices that follow each other in the order of an epoch.

        Shards of an object store are fetched whole, and the next shards in the background.
        """
        if self._shards is not None and self._cache is not None:
            needed, ahead = self._shards.ahead(indices, self._key(epoch))
            if ahead:
                self._cache.hold(needed, ahead)
        return self.take(indices, epoch)

    def take(self, indices: Indices, epoch: int = 0) -> tuple[NDArray[Any], BatchLabels]:
        """Read images (b, height, width, channels) and labels for an epoch.

        Labels are float32 (b, k); with one pixel target alone, int64 (b, height, width), as losses of frameworks take
        them; otherwise a tuple of the pixel targets' arrays and then, if there are other targets, theirs.

        Raises
        ------
        InvalidInput
            As `image` and `pixel_labels`, or the batch does not fit into memory.
        """
        height, width, channels = self.shape
        try:
            images = np.empty((len(indices), *self.shape), self.dtype)
            of_pixels = [np.empty((len(indices), height, width), np.int64) for _ in self.pixel_targets]
        except MemoryError as wrong:
            raise InvalidInput(
                "batch of {0:,} images of {1} x {2} px and {3} channels: does not fit into memory",
                len(indices),
                width,
                height,
                channels,
                remedy="take smaller batches, or smaller images",
            ) from wrong
        for place, index in enumerate(indices):
            images[place] = self.image(int(index), epoch)
            for labels, found in zip(of_pixels, self.pixel_labels(int(index), epoch)):
                labels[place] = found
        if not self._is_stored and self.dtype != np.uint8:
            np.divide(images, np.float32(255.0), out=images)
        wanted: tuple[NDArray[Any], ...] = (
            *of_pixels,
            *([self.values[np.asarray(indices, np.int64)]] if self.columns else []),
        )
        return images, wanted[0] if len(wanted) == 1 else wanted


@runtime_checkable
class Ordered(Protocol):
    """Source of batches: `LabelledImages`, or pairs of images such as `benchmark.loading.Pairs`."""

    @property
    def names(self) -> Sequence[str]:
        """Names of all samples."""

    @property
    def folder(self) -> Address:
        """Folder or address of the images."""

    def __len__(self) -> int: ...

    def order(self, epoch: int = 0) -> NDArray[np.int64]:
        """Indices (n,) in the order of an epoch."""

    def batch(self, indices: Indices, epoch: int = 0, /) -> tuple[Any, BatchLabels]:
        """Images, or a tuple of arrays of images, and labels, for consecutive indices of an epoch."""

    def take(self, indices: Indices, epoch: int = 0, /) -> tuple[Any, BatchLabels]:
        """Images and labels, as of `batch`, for any indices of an epoch."""


def make_samples(dataset: Dataset | Address | Ordered, choice: Mapping[str, Any]) -> Ordered:
    """Make samples of a dataset by the options ``choice``, or return samples unchanged."""
    if not isinstance(dataset, Ordered):
        return LabelledImages(dataset, **choice)
    if choice:
        raise InvalidInput("{0}: is chosen where the pairs are made", ", ".join(choice))
    return dataset


class Batches:
    """Batches of images and labels as numpy arrays; each iteration is over the epoch that was set last.

    Batches are the same for any number of workers. Memory is needed for one batch or, with workers, for
    one more than there are workers.

    Parameters
    ----------
    batch_size : int
        The last batch may be smaller.
    workers : int
        Threads that make batches ahead; 0 makes each batch when needed.
    **choice
        Options of `LabelledImages`.

    Raises
    ------
    InvalidInput
        As `LabelledImages`, or the batch size is below 1; during iteration, an image cannot be read.
    """

    def __init__(
        self,
        dataset: Dataset | Address | Ordered,
        batch_size: int = 8,
        *,
        workers: int = 0,
        **choice: Any,
    ) -> None:
        if workers < 0:
            raise InvalidInput("workers {0}: must be 0 or more", workers)
        self.samples = make_samples(dataset, choice)
        self.epoch = 0
        self._chunks = chunks(len(self.samples), batch_size)
        self._position = EpochPosition(self.samples, batch_size, len(self._chunks))
        self._workers = workers

    def set_epoch(self, epoch: int) -> None:
        """Set the epoch of the next iteration, which decides order and augmentation."""
        self.epoch = epoch

    def state_dict(self) -> dict[str, Any]:
        """Return the epoch and the number of its batches taken, to resume from there."""
        return self._position.state(self.epoch)

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Resume the next iteration where another iteration was, with any number of workers.

        Raises
        ------
        InvalidInput
            The state is of other images, another order or batch size, or a batch beyond the epoch.
        """
        self.epoch = self._position.load(state)

    def __len__(self) -> int:
        return len(self._chunks)

    def __iter__(self) -> Iterator[tuple[Any, BatchLabels]]:
        """Yield images (b, height, width, channels) and labels, as `LabelledImages.take`."""
        epoch, order = self.epoch, self.samples.order(self.epoch)
        self._position.begin(epoch)
        rest = self._chunks[self._position.first :]
        if self._workers:
            return self._position.counted(self._ahead(epoch, order, rest))
        return self._position.counted(self.samples.batch(order[chunk], epoch) for chunk in rest)

    def _ahead(self, epoch: int, order: NDArray[np.int64], rest: Sequence[slice]) -> Iterator[tuple[Any, BatchLabels]]:
        waiting: deque[Future[tuple[Any, BatchLabels]]] = deque()
        with _pool(self._workers, waiting) as pool:
            for chunk in rest:
                waiting.append(pool.submit(self.samples.batch, order[chunk], epoch))
                if len(waiting) > self._workers:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()


class EpochPosition:
    """Position of an iteration in an epoch: the number of batches taken, without batches made ahead."""

    def __init__(self, samples: Ordered, batch_size: int, batches: int) -> None:
        self._samples, self._batch_size, self._batches = samples, batch_size, batches
        self._epoch = self._taken = self._loaded = 0
        #: Number of the batch with which the iteration began.
        self.first = 0

    def begin(self, epoch: int) -> None:
        """Begin an iteration of an epoch, at its first batch or at a loaded position."""
        self.first = self._taken = self._loaded if epoch == self._epoch else 0
        self._epoch, self._loaded = epoch, 0

    def counted(self, batches: Iterable[_Batch]) -> Iterator[_Batch]:
        """Yield batches, counting them."""
        for one in batches:
            self._taken += 1
            yield one

    def state(self, epoch: int) -> dict[str, Any]:
        """Return the position in an epoch, with a digest of the batches."""
        return {
            "epoch": epoch,
            "batch": self._taken if epoch == self._epoch else 0,
            "batch_size": self._batch_size,
            "order": self._order,
        }

    def load(self, state: Mapping[str, Any]) -> int:
        """Load a position; returns its epoch."""
        try:
            epoch, batch, batch_size, order = (state[key] for key in ("epoch", "batch", "batch_size", "order"))
        except (KeyError, TypeError) as wrong:
            raise InvalidInput("state {0!r}: must be one that state_dict() returned", state) from wrong
        if not _is_whole(epoch):
            raise InvalidInput("state: epoch {0!r} must be a whole number", epoch)
        if batch_size != self._batch_size or order != self._order:
            raise InvalidInput("state: belongs to other images, another order or another batch size than this loader")
        if not (_is_whole(batch) and 0 <= batch <= self._batches):
            raise InvalidInput(
                "state: batch {0!r} must be a whole number from 0 to {1:,}, the batches of an epoch",
                batch,
                self._batches,
            )
        self._epoch, self._taken, self._loaded = int(epoch), int(batch), int(batch)
        return self._epoch

    @cached_property
    def _order(self) -> str:
        """Digest of the images and of their order in epoch 0, from which all other orders follow."""
        digest = blake2b(self._samples.order(0).astype("<i8").tobytes(), digest_size=16)
        digest.update("\n".join(self._samples.names).encode())
        return digest.hexdigest()


def _is_whole(value: object) -> bool:
    """Whether a value is an integer of Python or numpy, not a boolean."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


@contextmanager
def _pool(workers: int, waiting: deque[Future[Any]]) -> Iterator[ThreadPoolExecutor]:
    """Open threads; at the end, cancel waiting work that has not begun."""
    with ThreadPoolExecutor(workers) as pool:
        try:
            yield pool
        finally:
            for one in waiting:
                one.cancel()


def chunks(count: int, batch_size: int, drop_last: bool = False) -> list[slice]:
    """Divide a number of samples into slices, one a batch.

    Parameters
    ----------
    drop_last : bool
        Leave out a last, smaller batch.

    Raises
    ------
    InvalidInput
        The batch size is below 1, or there would be no batch.
    """
    if batch_size < 1:
        raise InvalidInput("batch size {0}: must be 1 or more", batch_size)
    end = count - count % batch_size if drop_last else count
    if end == 0:
        raise InvalidInput("batch size {0}: must be {1} or less, as there are no more images", batch_size, count)
    return [slice(start, min(start + batch_size, end)) for start in range(0, end, batch_size)]


def optional_module(name: str, title: str, extra: str) -> Any:
    """Import a module that may be missing; raises OutputError with the way to install it."""
    try:
        return imported(name)
    except ImportError as missing:
        if name == "keras" and missing.name and missing.name.partition(".")[0] != name:
            raise OutputError(
                "loader: Keras cannot be used with its backend ({0})",
                missing,
                remedy=("set KERAS_BACKEND to one that is installed, such as torch, before Python starts"),
            ) from missing
        raise OutputError(
            "loader: {0} is not installed",
            title,
            remedy=Message("get it with: pip install 'terrainav[{0}]'", extra),
        ) from missing


def _check(part: str, shuffle: bool | str, augment: Augmentation | str | None, dtype: str) -> None:
    """Raise InvalidInput for unknown choices."""
    if part not in (*PARTS, ALL):
        raise InvalidInput("part {0!r}: must be one of {1}", part, ", ".join((*PARTS, ALL)))
    if shuffle not in (True, False, "auto"):
        raise InvalidInput("shuffle {0!r}: must be True, False or 'auto'", shuffle)
    if augment is not None and augment != "auto" and not isinstance(augment, Augmentation):
        raise InvalidInput("augment {0!r}: must be an Augmentation, None or 'auto'", augment)
    if dtype not in DTYPES:
        raise InvalidInput("dtype {0!r}: must be one of {1}", dtype, ", ".join(DTYPES))


def _check_stored(img_size: tuple[int, int, int] | None, augment: Augmentation | str | None) -> None:
    if img_size is not None:
        raise InvalidInput("image size {0}: stored images are not resized", " ".join(map(str, img_size)))
    if isinstance(augment, Augmentation):
        raise InvalidInput("augment: stored images are not augmented")


def check_size(img_size: Sequence[int] | int) -> tuple[int, int, int]:
    """Check and return width, height and channels; raises InvalidInput."""
    if isinstance(img_size, int):
        raise InvalidInput("image size {0}: must be a width, a height and 1 or 3 channels", img_size)
    size = tuple(img_size)
    if len(size) != 3 or min(size) < 1 or size[2] not in (1, 3):
        raise InvalidInput(
            "image size {0}: needs a width and a height of 1 px or more, and 1 or 3 channels",
            " ".join(map(str, size)),
        )
    # Pillow warns about larger images, which take a quarter of a GB in colour.
    most_px = 89_478_485
    if size[0] * size[1] > most_px:
        raise InvalidInput("image size {0} {1} {2}: must be {3:,} px or less in all", *size, most_px)
    return size


def _images(dataset: Dataset, map_type: str | None) -> ImageSet:
    if map_type is None:
        map_type = "satellite" if "satellite" in dataset.image_sets else next(iter(dataset.image_sets))
    return dataset.image_set(map_type)


def _streamed(
    images: ImageSet, rows: NDArray[np.int64], shards_at_once: int, cache_mb: float | None
) -> tuple[Shards | None, ShardCache | None]:
    """Shards of the rows' images, and the cache of the shards of an object store; None without shards or store."""
    if not images.shards:
        return None, None
    shards = Shards([images.table.shard[row] for row in rows.tolist()], shards_at_once)
    if not is_address(images.folder):
        return shards, None
    sizes = {name: images.shards[name] for name in shards.names}
    limit_bytes = None if cache_mb is None else int(cache_mb * 1_000_000.0)
    return shards, ShardCache(images.folder, sizes, shards_at_once, limit_bytes)


def _rows(images: ImageSet, part: str) -> NDArray[np.int64]:
    """Rows of the table in a part; raises InvalidInput if there are none."""
    parts = image_parts(images.table)
    if part != ALL and parts is None:
        raise InvalidInput(
            "part {0!r}: {1} is not split",
            part,
            images.folder,
            remedy=Message("run terrainav split, or take the part {0!r}", ALL),
        )
    chosen = usable_rows(images.table)
    if part != ALL and parts is not None:
        _check_parts(images, parts)
        chosen &= np.array([one == part for one in parts], np.bool_)
    if not chosen.any():
        what = "that are there and not rejected" if part == ALL else f"in the part {part!r}"
        raise InvalidInput(
            "folder {0}: has no images {1}", images.folder, what, remedy="split, clean or capture it anew"
        )
    return np.flatnonzero(chosen)


def _check_parts(images: ImageSet, parts: Sequence[str]) -> None:
    """Raise InvalidInput for unknown parts in a table."""
    known = (*PARTS, GAP, "")
    odd = [name for name, part in zip(images.table.img_names, parts) if part not in known]
    if odd:
        value = next(part for part in parts if part not in known)
        raise InvalidInput(
            "table {0}: has split {1!r} ({2}); must be one of {3} or empty: split anew",
            images.folder / TABLE_FILE,
            value,
            first_names(odd),
            ", ".join(known[:-1]),
        )


def _labels(dataset: Dataset, images: ImageSet) -> Labels:
    path = dataset.folder / LABELS_FILE
    if not is_file(path):
        return make_dataset_labels(one.table for one in dataset.image_sets.values())
    labels = Labels.load(path)
    _check_fit(labels, images, path)
    return labels


def _check_fit(labels: Labels, images: ImageSet, path: Path) -> None:
    """Raise InvalidInput for labels of another dataset.

    None of n numbers with mean 0 and standard deviation 1 exceeds the square root of n. So if a training image exceeds
    it, the scaler was fitted on other images.
    """
    parts = image_parts(images.table)
    if labels.fitted_on != TRAIN or parts is None:
        return
    rows = np.flatnonzero(usable_rows(images.table) & np.array([part == TRAIN for part in parts], np.bool_))
    if not rows.size:
        return
    table = images.table
    far = np.abs(labels.transform(table.lat_deg[rows], table.lon_deg[rows])).max(axis=1)
    worst = int(np.argmax(far))
    if far[worst] > math.sqrt(max(labels.images, 1)):
        raise InvalidInput(
            "{0}: is of another dataset or split, as {1} of the training part lies {2:,.0f} standard "
            "deviations from its mean",
            path,
            table.img_names[rows[worst]],
            far[worst],
            remedy="have it made anew by split",
        )


def _check_targets(targets: Sequence[str], augment: Augmentation | str | None) -> bool:
    """Raise InvalidInput for unknown targets; return whether rotating and zooming images keeps the targets valid."""
    named = [targets] if isinstance(targets, str) else list(targets)
    if not named or isinstance(targets, str) or len(set(named)) != len(named):
        raise InvalidInput(
            "targets {0}: must be some of {1}, and columns of the table, each once",
            " ".join(map(str, named)),
            ", ".join(TARGETS),
        )
    may_turn = not {HEIGHT, ATTITUDE} & set(named)
    if not may_turn and isinstance(augment, Augmentation) and not augment.keeps_pose:
        raise InvalidInput(
            "targets {0}: images that are turned, mirrored or zoomed are of another pose",
            " ".join(named),
            remedy="leave the augmentation out, or take one of contrast and brightness alone",
        )
    return may_turn


def _label_columns(target: str) -> tuple[str, ...]:
    """Names of the columns of a target's labels; none for labels of pixels."""
    return () if target in PIXEL_LABELS else _COLUMNS.get(target, (target,))


def _column_values(target: str, images: ImageSet, rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """Numbers (n, 1) of an additional column of the table; raises InvalidInput where it has none."""
    other = images.table.other
    if target not in other:
        raise InvalidInput(
            "targets {0}: must be some of {1}, or of the further columns of {2}: {3}",
            target,
            ", ".join(TARGETS),
            images.folder / TABLE_FILE,
            ", ".join(other) or Message("none"),
        )
    found = np.full((len(rows), 1), np.nan, np.float32)
    for at, row in enumerate(rows.tolist()):
        with suppress(ValueError):
            found[at] = real_number(other[target][row])
    _check_known(target, np.isfinite(found).all(axis=1), images, rows)
    return found


def _values(target: str, labels: Labels, images: ImageSet, rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """Labels (n, 0 to 3) of rows; raises InvalidInput for positions outside the frame and for missing poses."""
    table = images.table
    if target in PIXEL_LABELS:
        return np.empty((len(rows), 0), np.float32)
    if target not in TARGETS:
        return _column_values(target, images, rows)
    if target in (HEIGHT, ATTITUDE):
        columns = (table.agl_m,) if target == HEIGHT else (table.yaw_deg, table.tilt_deg, table.roll_deg)
        found: NDArray[np.float32] = np.stack([column[rows] for column in columns], axis=1).astype(np.float32)
        _check_known(target, np.isfinite(found).all(axis=1), images, rows)
        return found
    lat_deg, lon_deg = (
        (table.lat_deg[rows], table.lon_deg[rows])
        if target == IMAGE
        else (table.pose_lat_deg[rows], table.pose_lon_deg[rows])
    )
    _check_known(target, np.isfinite(lat_deg) & np.isfinite(lon_deg), images, rows)
    values = labels.transform(lat_deg, lon_deg).astype(np.float32)
    lost = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if lost.size:
        first = int(lost[0])
        raise InvalidInput(
            "labels: {0} cannot be had in {1}, first Lat {2:g}, Lon {3:g}",
            first_names([images.table.img_names[row] for row in rows[lost].tolist()]),
            labels.frame.crs,
            lat_deg[first],
            lon_deg[first],
            remedy=Message("split with another {0}", OptionName("frame")),
        )
    return values


def _check_known(target: str, known: NDArray[np.bool_], images: ImageSet, rows: NDArray[np.int64]) -> None:
    if not known.all():
        raise InvalidInput(
            "targets {0}: the table of {1} does not have it for {2}",
            target,
            images.folder,
            first_names([images.table.img_names[row] for row in rows[~known].tolist()]),
        )
