"""Load images and labels for Keras 3 with any backend; Keras is imported when `KerasDataset` is first used."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from ...storage.stores import Address
from ..dataset import Dataset
from .batches import BatchLabels, Ordered, chunks, make_samples, optional_module


class _KerasSamples:
    """Batches by index, for ``fit``, ``evaluate`` and ``predict``.

    Images are arrays (b, height, width, channels), or (b, channels, height, width) according to
    ``keras.config.image_data_format()``, of float32 from 0 to 1 or uint8; labels are float32 arrays (b, 2), or with the
    target ``classes`` int64 arrays (b, height, width), see `LabelledImages.take`.

    Order and augmentation follow from the seed, the epoch and the images' names. ``fit`` begins with epoch 1, as Keras
    reports the end of an epoch before the first one. For the order of `Batches`, pass ``shuffle=False`` to ``fit``,
    which otherwise shuffles the batches again with Python's random numbers. With ``workers`` above 1, the first ``fit``
    of a model also gets batches that Keras queued while building the model: the same images, up to a batch
    earlier.

    Parameters
    ----------
    workers, use_multiprocessing, max_queue_size
        As for ``keras.utils.PyDataset``: threads or processes that make batches, and the most batches in the queue.
    **choice
        Options of `LabelledImages`: map_type, part, img_size, seed, shuffle, augment, dtype, layout, labels, targets,
        shards_at_once, cache_mb.

    Raises
    ------
    OutputError
        Keras or its backend is not installed.
    InvalidInput
        As `LabelledImages`, or the batch size is below 1; during iteration, an image cannot be read.

    Examples
    --------
    ::

        model.fit(KerasDataset("OUT", img_size=(224, 224, 3), batch_size=8, workers=2), epochs=10)
    """

    def __init__(
        self,
        dataset: Dataset | Address | Ordered,
        batch_size: int = 8,
        *,
        workers: int = 1,
        use_multiprocessing: bool = False,
        max_queue_size: int = 10,
        **choice: Any,
    ) -> None:
        super().__init__(workers=workers, use_multiprocessing=use_multiprocessing, max_queue_size=max_queue_size)  # type: ignore[call-arg]
        self.samples = make_samples(dataset, choice)
        self._chunks = chunks(len(self.samples), batch_size)
        self._channels_first = _keras().config.image_data_format() == "channels_first"
        self.set_epoch(0)

    @property
    def epoch(self) -> int:
        """Epoch of the order and the augmentation."""
        return self._epoch_and_order[0]

    def set_epoch(self, epoch: int) -> None:
        """Set the next epoch, such as to resume training; ``fit`` counts on from it."""
        # Set both at once, as threads of a queue may still make batches.
        self._epoch_and_order = (epoch, self.samples.order(epoch))

    def on_epoch_end(self) -> None:
        """Go to the next epoch. Keras calls it also before the first epoch of ``fit``."""
        self.set_epoch(self.epoch + 1)

    def __len__(self) -> int:
        return len(self._chunks)

    def __getitem__(self, index: int) -> tuple[Any, BatchLabels]:
        epoch, order = self._epoch_and_order
        images, labels = self.samples.batch(order[self._chunks[index]], epoch)
        if not self._channels_first:
            return images, labels
        if isinstance(images, tuple):
            return tuple(np.moveaxis(one, 3, 1) for one in images), labels
        return np.moveaxis(images, 3, 1), labels


def _keras() -> Any:
    return optional_module("keras", "Keras", "keras")


@cache
def _dataset_class() -> Any:
    base = _keras().utils.PyDataset
    names = {"__module__": __name__, "__qualname__": "KerasDataset", "__doc__": _KerasSamples.__doc__}
    return type("KerasDataset", (_KerasSamples, base), names)


def __getattr__(name: str) -> Any:
    if name == "KerasDataset":
        return _dataset_class()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
