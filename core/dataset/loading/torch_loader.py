"""Load images and labels for PyTorch, which is imported when `TorchDataset` is first used."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from multiprocessing import get_all_start_methods
from typing import Any

import numpy as np

from ...arrays import NDArray
from ...errors import InvalidInput
from ...storage.stores import Address, is_address
from ..dataset import Dataset
from .batches import EpochPosition, Ordered, chunks, make_samples, optional_module


class _Order:
    """Sampler that yields the indices of each batch of a dataset's current epoch."""

    def __init__(self, dataset: _TorchSamples, batch_size: int, drop_last: bool) -> None:
        self._dataset, self._batch_size, self._drop_last = dataset, batch_size, drop_last
        self.position = EpochPosition(dataset.samples, batch_size, len(self))

    def __len__(self) -> int:
        return len(self._chunks())

    def __iter__(self) -> Iterator[list[int]]:
        order = self._dataset.samples.order(self._dataset.epoch)
        return (order[one].tolist() for one in self._chunks()[self.position.first :])

    def _chunks(self) -> list[slice]:
        return chunks(len(self._dataset.samples), self._batch_size, self._drop_last)


class _TorchSamples:
    """Map-style dataset: (image, label) of an index, or (images, labels) of a list of indices.

    Images are tensors (channels, height, width) or (b, channels, height, width) of float32 from 0 to 1 or uint8; labels
    are tensors (2,) or (b, 2) of float32; with the target ``classes``, (height, width) or (b, height, width) of int64,
    see `LabelledImages.take`; of several, a ``DataLoader`` makes a list. Augmentation follows from the seed, the epoch
    and the image's name, whatever the number of workers.

    Parameters
    ----------
    **choice
        Options of `LabelledImages`: map_type, part, img_size, seed, shuffle, augment, dtype, layout, labels, targets,
        shards_at_once, cache_mb.

    Raises
    ------
    OutputError
        PyTorch is not installed.
    InvalidInput
        As `LabelledImages`; during iteration, an image cannot be read.

    Examples
    --------
    ::

        dataset = TorchDataset("OUT", img_size=(224, 224, 3))
        loader = dataset.batches(batch_size=8, workers=2)
        for epoch in range(10):
            dataset.set_epoch(epoch)
            for images, labels in loader:
                ...
    """

    def __init__(self, dataset: Dataset | Address | Ordered, **choice: Any) -> None:
        torch = _torch()
        self.samples = make_samples(dataset, choice)
        # Share the memory, so that persistent workers see the epoch change.
        self._epoch = torch.zeros(1, dtype=torch.int64).share_memory_()

    @property
    def epoch(self) -> int:
        """Epoch of the order and the augmentation."""
        return int(self._epoch.item())

    def set_epoch(self, epoch: int) -> None:
        """Set the next epoch: before a loader's iteration begins, not during it."""
        self._epoch[0] = epoch

    def __len__(self) -> int:
        return len(self.samples)

    def __getitem__(self, index: int | list[int]) -> tuple[Any, Any]:
        if isinstance(index, list):
            pixels, values = self.samples.batch(index, self.epoch)
        else:
            pixels, values = self.samples.take([index], self.epoch)
        images, labels = _each(_tensor, pixels), _each(_torch().from_numpy, values)
        return (images, labels) if isinstance(index, list) else (_each(_first, images), _each(_first, labels))

    def batches(self, batch_size: int = 8, workers: int = 0, *, drop_last: bool = False, **options: Any) -> Any:
        """Make a ``torch.utils.data.DataLoader`` of the epoch's batches, in the order of `Batches`.

        Each worker makes whole batches, two ahead, and stays from one epoch to the next. Like `Batches`, the loader has
        ``state_dict()`` and ``load_state_dict(state)`` to resume in the middle of an epoch.

        Parameters
        ----------
        drop_last : bool
            Leave out a last, smaller batch.
        **options
            Other options of ``DataLoader``, such as ``pin_memory``. For a dataset in an object store, the default of
            ``multiprocessing_context`` is ``forkserver`` or ``spawn``.

        Raises
        ------
        InvalidInput
            The batch size is below 1, there would be no batch, or workers are below 0.
        """
        if workers < 0:
            raise InvalidInput("workers {0}: must be 0 or more", workers)
        order = _Order(self, batch_size, drop_last)
        # More workers than batches would have nothing to do.
        workers = min(workers, len(order))
        options = {"persistent_workers": workers > 0, **options}
        if workers and is_address(self.samples.folder):
            # Clients of stores have threads, and a fork could leave the threads' locks locked for ever.
            method = "forkserver" if "forkserver" in get_all_start_methods() else "spawn"
            options.setdefault("multiprocessing_context", method)
        return _loader_class()(self, batch_size=None, sampler=order, num_workers=workers, **options)


def _each(change: Callable[[Any], Any], values: Any) -> Any:
    """Change an array, or each of a tuple."""
    return tuple(map(change, values)) if isinstance(values, tuple) else change(values)


def _first(batch: Any) -> Any:
    return batch[0]


def _tensor(pixels: NDArray[Any]) -> Any:
    """Convert pixels (b, height, width, channels) to a tensor (b, channels, height, width)."""
    return _torch().from_numpy(np.ascontiguousarray(pixels.transpose(0, 3, 1, 2)))


def _torch() -> Any:
    return optional_module("torch", "PyTorch", "torch")


class _Resumable:
    """Mixin that lets a PyTorch loader resume in the middle of an epoch."""

    dataset: _TorchSamples
    sampler: _Order

    def __iter__(self) -> Iterator[Any]:
        # Begin here, not in the sampler, which the base class iterates twice.
        self.sampler.position.begin(self.dataset.epoch)
        return self.sampler.position.counted(super().__iter__())  # type: ignore[misc]

    def state_dict(self) -> dict[str, Any]:
        """Return the epoch and the number of its batches taken, to resume from there."""
        return self.sampler.position.state(self.dataset.epoch)

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Resume the next iteration where another iteration was, with any number of workers."""
        self.dataset.set_epoch(self.sampler.position.load(state))


@cache
def _loader_class() -> Any:
    base = _torch().utils.data.DataLoader
    return type("DataLoader", (_Resumable, base), {"__module__": __name__})


@cache
def _dataset_class() -> Any:
    base = _torch().utils.data.Dataset
    names = {"__module__": __name__, "__qualname__": "TorchDataset", "__doc__": _TorchSamples.__doc__}
    return type("TorchDataset", (_TorchSamples, base), names)


def __getattr__(name: str) -> Any:
    if name == "TorchDataset":
        return _dataset_class()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
