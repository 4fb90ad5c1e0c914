"""Images and labels for training, and batches of them as numpy arrays."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any, Protocol, TypeVar, Union, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ...bands import Bands
from ...errors import InvalidInput, Message, OptionName, OutputError
from ...external.importing import imported
from ...storage.stores import Address, is_address, is_file
from ..dataset import Dataset, ImageSet, first_names, open_image, read_band_metadata, read_dataset
from ..folder import ATTITUDE, CAMERA, HEIGHT, IMAGE, PARTS, TABLE_FILE, TARGETS, TRAIN
from ..labels import LABELS_FILE, Labels, make_dataset_labels
from ..stored import ImageFile, StoredImage
from ..table import GAP, image_parts, usable_rows
from .augment import Augmentation
from .streaming import ShardCache, Shards, random_numbers

_Batch = TypeVar("_Batch")
Indices = Union[Sequence[int], NDArray[np.int64]]

#: All images but failed and rejected ones, whether or not the dataset is split.
ALL = "all"
#: The map type that is taken where none is asked for.
USUAL_MAP_TYPE = "satellite"
#: Images of 0 to 1; of 0 to 255; and values and bands as their files have them.
DTYPES = FLOATS, BYTES, STORED = ("float32", "uint8", "stored")
#: Pixels of an image at most: where Pillow, too, begins to warn of files (a quarter of a GB in colour).
_MOST_PX = 89_478_485
#: Shards that shuffled images are taken from at a time: some thousands of images as captures pack them.
SHARDS_AT_ONCE = 8
#: Columns of labels.
_COLUMNS = {
    IMAGE: ("easting", "northing"),
    CAMERA: ("camera_easting", "camera_northing"),
    HEIGHT: ("agl_m",),
    ATTITUDE: ("yaw_deg", "tilt_deg", "roll_deg"),
}


class LabelledImages:
    """Images of one part of a map type and their labels, each by its number, in the table's order.

    Failed and rejected images are never taken. An instance holds names and labels, no pixels, and can be pickled.

    Parameters
    ----------
    map_type : str or None
        None takes the satellite images, or the first map type of a dataset without such.
    part : {"train", "validation", "test", "all"}
        ``all`` needs no split.
    img_size : tuple (width, height, channels) or None
        What images are resized to; None takes them as they are, which must be alike then.
    seed : int
        Of order and augmentation.
    shuffle : bool or "auto"
        ``auto`` shuffles the training part, anew for each epoch, and leaves the others in the table's order, shard
        after shard where they are in such.
    augment : Augmentation, None or "auto"
        ``auto`` augments the training part as the paper does, and no other; None augments none.
    dtype : {"float32", "uint8", "stored"}
        Of images: 0 to 1, or 0 to 255, which takes a quarter of the memory on its way to the model. ``stored`` gives
        all bands and their values as files have them, also of more than 8 bits; such images are neither resized nor
        augmented here.
    layout : str
        Of a folder, as `read_dataset` takes it.
    labels : Labels or None
        None takes those of the dataset's ``labels.json``; where there is none, UTM, scaled by the training part of a
        dataset that is split, and else by all images.
    targets : sequence of str
        What the labels are of, in this order: the ``image``'s centre on the ground and the ``camera``'s
        place, as scaled eastings and northings; its ``height`` above ground in metres; its ``attitude``, yaw, tilt and
        roll in degrees. With the last two ``auto`` augments nothing, as turning and zooming would make them wrong.
    shards_at_once : int
        Of a dataset in shards: how many of them shuffled images are taken from at a time. Shards are shuffled, and then
        the images of so many together: with more the order is the more random, and more of them have to be kept of
        those of an object store.
    cache_mb : float or None
        Most disk space that shards of an object store take in the system's temporary folder; None has room for three
        times as many as are taken at once.

    Attributes
    ----------
    names : tuple of str
        Images' names without ending.
    values : array (n, k) of float32
        The labels' numbers.
    columns : tuple of k str
        What they are, with their units; ``easting`` and ``northing`` are scaled.
    labels : Labels
        What the numbers mean, and the way back to latitude and longitude (`Labels.positions`).
    bands : Bands or None
        Of images as stored, as the first one states them: names, and scale, offset and unit of their values
        (`Bands.each_metadata`). None for others, and where nothing is stated.

    Raises
    ------
    InvalidInput
        A folder that is no dataset, no such map type or part, no images in it, or a value that is not right.
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
        shards_at_once: int = SHARDS_AT_ONCE,
        cache_mb: float | None = None,
    ) -> None:
        _check(part, shuffle, augment, dtype)
        if shards_at_once < 1:
            raise InvalidInput("shards at once {0}: must be 1 or more", shards_at_once)
        if cache_mb is not None and not cache_mb >= 0.0:
            raise InvalidInput("cache of {0} MB: must be 0 MB or more", cache_mb)
        turnable = _check_targets(targets, augment)
        if not isinstance(dataset, Dataset):
            dataset = read_dataset(dataset, layout)
        self.part, self.img_size, self.seed = part, None if img_size is None else check_size(img_size), seed
        self.shuffle = part == TRAIN if isinstance(shuffle, str) else shuffle
        usual = Augmentation() if part == TRAIN and turnable else None
        self.augment = usual if isinstance(augment, str) else augment
        self._is_stored = dtype == STORED
        if self._is_stored:
            _check_as_stored(self.img_size, augment)
            self.augment = None
        self.images = _images(dataset, map_type)
        self._rows = _rows(self.images, part)
        self.names = tuple(Path(self.images.table.img_names[row]).stem for row in self._rows)
        self._shards, self._cache = _streamed(self.images, self._rows, shards_at_once, cache_mb)
        self.labels = _labels(dataset, self.images) if labels is None else labels
        self.columns = tuple(column for target in targets for column in _COLUMNS[target])
        self.values = np.concatenate([_values(one, self.labels, self.images, self._rows) for one in targets], axis=1)
        self.shape, self.dtype = self._shape(), np.dtype(BYTES if self._is_stored else dtype)
        self.bands: Bands | None = None
        if self._is_stored:
            self.dtype = self._stored(0).dtype
            self.bands = read_band_metadata(self.file(0), self.shape[2])

    def _shape(self) -> tuple[int, int, int]:
        """Height, width and channels of every image."""
        if self.img_size is not None:
            width, height, channels = self.img_size
            return height, width, channels
        if self._is_stored:
            height, width, channels = self._stored(0).shape
            return height, width, channels
        first = open_image(self.file(0))
        return first.height, first.width, len(first.getbands())

    def _stored(self, index: int) -> NDArray[Any]:
        """Values (h, w, bands) of an image's file."""
        found = self.images.pixels(int(self._rows[index]), file=self.file(index))
        return found[..., np.newaxis] if found.ndim == 2 else found

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def folder(self) -> Address:
        """Where the images are."""
        return self.images.folder

    def path(self, index: int) -> Path:
        """File of an image; raises InvalidInput where images are no files of a folder of this machine."""
        return self.images.path(int(self._rows[index]))

    def file(self, index: int) -> ImageFile:
        """Source of an image: a path, an object or a range of a shard."""
        found = self.images.file(int(self._rows[index]))
        if self._cache is None or not isinstance(found, StoredImage):
            return found
        return replace(found, copy=self._cache.copy(found.place.name))

    def order(self, epoch: int = 0) -> NDArray[np.int64]:
        """Indices (n,) in the order of an epoch: the same for the same seed and table on every machine.

        A shuffled one sorts the raw stream of numpy's Philox (see `random_numbers`). Of a dataset in shards, images
        stand together whose shards are taken at once; without shuffling those of each shard do, in the table's order.
        """
        if self._shards is not None:
            return self._shards.order(self._key(epoch))
        if not self.shuffle:
            return np.arange(len(self))
        return np.argsort(random_numbers(self._key(epoch), len(self)), kind="stable")

    def _key(self, epoch: int) -> str:
        """Key of the order of an epoch; empty for the order of the table."""
        return f"{self.seed}:{epoch}" if self.shuffle else ""

    def image(self, index: int, epoch: int = 0) -> NDArray[Any]:
        """Pixels (height, width, channels) of an image as it is in an epoch: of uint8, or as stored.

        Raises
        ------
        InvalidInput
            An image that cannot be read, is not of the size that the table says, or of another size than the others,
            where none was asked for.
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
            found = self.augment.applied(found, self.names[index], self.seed, epoch)
        return np.asarray(found).reshape(self.shape)

    def batch(self, indices: Indices, epoch: int = 0) -> tuple[NDArray[Any], NDArray[np.float32]]:
        """Images and labels, as `take` returns them, that follow each other in the order of an epoch.

        Shards of an object store are fetched whole, and those that come next meanwhile.
        """
        if self._shards is not None and self._cache is not None:
            needed, ahead = self._shards.ahead(indices, self._key(epoch))
            if ahead:
                self._cache.hold(needed, ahead)
        return self.take(indices, epoch)

    def take(self, indices: Indices, epoch: int = 0) -> tuple[NDArray[Any], NDArray[np.float32]]:
        """Images (b, height, width, channels) and labels (b, k) of some indices, as they are in an epoch.

        Raises
        ------
        InvalidInput
            As `image` does, or a batch that does not fit into memory.
        """
        try:
            images = np.empty((len(indices), *self.shape), self.dtype)
        except MemoryError as wrong:
            height, width, channels = self.shape
            raise InvalidInput(
                "batch of {0:,} images of {1} x {2} px and {3} channels: does not fit into memory",
                len(indices),
                width,
                height,
                channels,
                remedy="take smaller batches, or smaller images",
            ) from wrong
        for one, index in zip(images, indices):
            one[...] = self.image(int(index), epoch)
        if not self._is_stored and self.dtype != np.uint8:
            np.divide(images, np.float32(255.0), out=images)
        return images, self.values[np.asarray(indices, np.int64)]


@runtime_checkable
class Ordered(Protocol):
    """Source of batches: `LabelledImages`, or pairs of images such as `benchmark.loading.Pairs`."""

    @property
    def names(self) -> Sequence[str]:
        """Names of all, one each."""

    @property
    def folder(self) -> Address:
        """Where the images are."""

    def __len__(self) -> int: ...

    def order(self, epoch: int = 0) -> NDArray[np.int64]:
        """Numbers (n,) in the order of an epoch."""

    def batch(self, indices: Indices, epoch: int = 0, /) -> tuple[Any, NDArray[np.float32]]:
        """Images, or a tuple of such, and labels."""

    def take(self, indices: Indices, epoch: int = 0, /) -> tuple[Any, NDArray[np.float32]]:
        """The same of any numbers."""


def make_samples(dataset: Dataset | Address | Ordered, choice: Mapping[str, Any]) -> Ordered:
    """Samples of a dataset by a choice, or those that are given."""
    if not isinstance(dataset, Ordered):
        return LabelledImages(dataset, **choice)
    if choice:
        raise InvalidInput("{0}: is chosen where the pairs are made", ", ".join(choice))
    return dataset


class Batches:
    """Batches of images and labels as numpy arrays, each iteration those of the epoch that was set last.

    Batches come in the epoch's order, and are the same for any number of workers. Memory is taken for those that are
    under way only: one, or with workers one for each of them and one ahead.

    Parameters
    ----------
    batch_size : int
        The last batch may be smaller.
    workers : int
        Threads that make batches; 0 makes each when it is asked for.
    **choice
        As `LabelledImages` takes them.

    Raises
    ------
    InvalidInput
        As `LabelledImages` does, or a batch size below 1; and when an image cannot be read, which is named.
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
        """Say which epoch the next iteration is of: it has its own order and augmentation."""
        self.epoch = epoch

    def state_dict(self) -> dict[str, Any]:
        """Return the epoch and the number of its batches that have been taken, to go on there another time."""
        return self._position.state(self.epoch)

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Have the next iteration go on where another one was, whatever the workers of either.

        Raises
        ------
        InvalidInput
            A state of other images, another order or another batch size, or of a batch that an epoch does not have.
        """
        self.epoch = self._position.load(state)

    def __len__(self) -> int:
        return len(self._chunks)

    def __iter__(self) -> Iterator[tuple[Any, NDArray[np.float32]]]:
        """Yield images (b, height, width, channels) and labels (b, 2)."""
        epoch, order = self.epoch, self.samples.order(self.epoch)
        self._position.begin(epoch)
        rest = self._chunks[self._position.first :]
        if self._workers:
            return self._position.counted(self._ahead(epoch, order, rest))
        return self._position.counted(self.samples.batch(order[chunk], epoch) for chunk in rest)

    def _ahead(
        self, epoch: int, order: NDArray[np.int64], rest: Sequence[slice]
    ) -> Iterator[tuple[Any, NDArray[np.float32]]]:
        waiting: deque[Future[tuple[Any, NDArray[np.float32]]]] = deque()
        with _pool(self._workers, waiting) as pool:
            for chunk in rest:
                waiting.append(pool.submit(self.samples.batch, order[chunk], epoch))
                if len(waiting) > self._workers:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()


class EpochPosition:
    """Where in an epoch an iteration is: how many batches have been taken, not how many have been made ahead."""

    def __init__(self, samples: Ordered, batch_size: int, batches: int) -> None:
        self._samples, self._batch_size, self._batches = samples, batch_size, batches
        self._epoch = self._taken = self._loaded = 0
        #: Number of the batch that the iteration began with.
        self.first = 0

    def begin(self, epoch: int) -> None:
        """Have an iteration of an epoch begin with its first batch, or where a loaded state says."""
        self.first = self._taken = self._loaded if epoch == self._epoch else 0
        self._epoch, self._loaded = epoch, 0

    def counted(self, batches: Iterable[_Batch]) -> Iterator[_Batch]:
        """Yield batches, counting them."""
        for one in batches:
            self._taken += 1
            yield one

    def state(self, epoch: int) -> dict[str, Any]:
        """Return the position in an epoch, with the digest by which loaders compare their batches."""
        return {
            "epoch": epoch,
            "batch": self._taken if epoch == self._epoch else 0,
            "batch_size": self._batch_size,
            "order": self._order,
        }

    def load(self, state: Mapping[str, Any]) -> int:
        """Take a position over; returns its epoch."""
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
        """Digest of the images and of an order of theirs, from which all others follow."""
        digest = blake2b(self._samples.order(0).astype("<i8").tobytes(), digest_size=16)
        digest.update("\n".join(self._samples.names).encode())
        return digest.hexdigest()


def _is_whole(value: object) -> bool:
    """Whether a value is an integer of Python or numpy, and not a boolean."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


@contextmanager
def _pool(workers: int, waiting: deque[Future[Any]]) -> Iterator[ThreadPoolExecutor]:
    """Threads whose work that has not begun is dropped in the end."""
    with ThreadPoolExecutor(workers) as pool:
        try:
            yield pool
        finally:
            for one in waiting:
                one.cancel()


def chunks(count: int, batch_size: int, drop_last: bool = False) -> list[slice]:
    """Slices of so many things in batches.

    Parameters
    ----------
    drop_last : bool
        Leave out a last one that is smaller.

    Raises
    ------
    InvalidInput
        A batch size below 1, or above the count if there were no batch then.
    """
    if batch_size < 1:
        raise InvalidInput("batch size {0}: must be 1 or more", batch_size)
    end = count - count % batch_size if drop_last else count
    if end == 0:
        raise InvalidInput("batch size {0}: must be {1} or less, as there are no more images", batch_size, count)
    return [slice(start, min(start + batch_size, end)) for start in range(0, end, batch_size)]


def optional_module(name: str, title: str, extra: str) -> Any:
    """Module that may be missing; raises OutputError that says how to get it."""
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
    """Raise InvalidInput for a choice that there is not."""
    if part not in (*PARTS, ALL):
        raise InvalidInput("part {0!r}: must be one of {1}", part, ", ".join((*PARTS, ALL)))
    if shuffle not in (True, False, "auto"):
        raise InvalidInput("shuffle {0!r}: must be True, False or 'auto'", shuffle)
    if augment is not None and augment != "auto" and not isinstance(augment, Augmentation):
        raise InvalidInput("augment {0!r}: must be an Augmentation, None or 'auto'", augment)
    if dtype not in DTYPES:
        raise InvalidInput("dtype {0!r}: must be one of {1}", dtype, ", ".join(DTYPES))


def _check_as_stored(img_size: tuple[int, int, int] | None, augment: Augmentation | str | None) -> None:
    if img_size is not None:
        raise InvalidInput("image size {0}: images are not resized as they are stored", " ".join(map(str, img_size)))
    if isinstance(augment, Augmentation):
        raise InvalidInput("augment: images are not augmented as they are stored")


def check_size(img_size: Sequence[int] | int) -> tuple[int, int, int]:
    """Width, height and channels; raises InvalidInput for what is not such."""
    if isinstance(img_size, int):
        raise InvalidInput("image size {0}: must be a width, a height and 1 or 3 channels", img_size)
    size = tuple(img_size)
    if len(size) != 3 or min(size) < 1 or size[2] not in (1, 3):
        raise InvalidInput(
            "image size {0}: needs a width and a height of 1 px or more, and 1 or 3 channels",
            " ".join(map(str, size)),
        )
    if size[0] * size[1] > _MOST_PX:
        raise InvalidInput(
            "image size {0} {1} {2}: must be {3:,} px or less in all", size[0], size[1], size[2], _MOST_PX
        )
    return size


def _images(dataset: Dataset, map_type: str | None) -> ImageSet:
    if map_type is None:
        map_type = USUAL_MAP_TYPE if USUAL_MAP_TYPE in dataset.image_sets else next(iter(dataset.image_sets))
    return dataset.image_set(map_type)


def _streamed(
    images: ImageSet, rows: NDArray[np.int64], shards_at_once: int, cache_mb: float | None
) -> tuple[Shards | None, ShardCache | None]:
    """The shards that rows are in, and what fetches those of an object store."""
    if not images.shards:
        return None, None
    shards = Shards([images.table.shard[row] for row in rows.tolist()], shards_at_once)
    if not is_address(images.folder):
        return shards, None
    sizes = {name: images.shards[name] for name in shards.names}
    limit_bytes = None if cache_mb is None else int(cache_mb * 1_000_000.0)
    return shards, ShardCache(images.folder, sizes, shards_at_once, limit_bytes)


def _rows(images: ImageSet, part: str) -> NDArray[np.int64]:
    """Rows of the table that are taken."""
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
    """Raise InvalidInput for images of a part that there is not."""
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
    """Raise InvalidInput for labels that are of another dataset.

    Of n numbers with mean 0 and standard deviation 1, none is beyond the root of n: images of the training part that
    are, are none of those that the scaler was fitted on.
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
    """Raise InvalidInput for targets that there are not; whether they hold for images that are turned and zoomed."""
    named = [targets] if isinstance(targets, str) else list(targets)
    if not named or isinstance(targets, str) or len(set(named)) != len(named) or set(named) - set(TARGETS):
        raise InvalidInput("targets {0}: must be some of {1}, each once", " ".join(map(str, named)), ", ".join(TARGETS))
    turnable = not {HEIGHT, ATTITUDE} & set(named)
    if not turnable and isinstance(augment, Augmentation) and not augment.keeps_pose:
        raise InvalidInput(
            "targets {0}: images that are turned, mirrored or zoomed are of another pose",
            " ".join(named),
            remedy="leave the augmentation out, or take one of contrast and brightness alone",
        )
    return turnable


def _values(target: str, labels: Labels, images: ImageSet, rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """Labels (n, 1 to 3) of rows; raises InvalidInput for positions that the frame does not have, and missing poses."""
    table = images.table
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
