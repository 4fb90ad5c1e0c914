"""Images and labels for Keras 3 with any backend, which is imported when `KerasDataset` is first asked for."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...storage.stores import Address
from ..dataset import Dataset
from .batches import Ordered, chunks, make_samples, optional_module


class _KerasSamples:
    """Batches by their number, for ``fit``, ``evaluate`` and ``predict``.

    Images are arrays (b, height, width, channels), or with the channels second where
    ``keras.config.image_data_format()`` says so, float32 of 0 to 1 or uint8; labels are float32 arrays (b, 2).

    Each epoch has its own order and augmentation, which follow from the seed, the epoch and the images' names. ``fit``
    begins with epoch 1, as Keras tells that an epoch is over before the first one; to have the order of `Batches` it is
    given ``shuffle=False``, as it shuffles the batches otherwise once more, by Python's own random numbers. With
    ``workers`` above 1, Keras also hands the first ``fit`` of a model what its queue held while it was built: the
    images are the same, and come up to a batch earlier.

    Parameters
    ----------
    workers, use_multiprocessing, max_queue_size
        Of ``keras.utils.PyDataset``: threads, or processes, that make batches, and how many wait at most.
    **choice
        Options of `LabelledImages`: map_type, part, img_size, seed, shuffle, augment, dtype, layout, labels, targets,
        shards_at_once, cache_mb.

    Raises
    ------
    OutputError
        Keras or its backend is not installed.
    InvalidInput
        As `LabelledImages` does, or a batch size below 1; and when an image cannot be read, which is named.

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
        """The epoch that images are augmented and ordered for."""
        return self._epoch_and_order[0]

    def set_epoch(self, epoch: int) -> None:
        """Say which epoch comes next, as when training goes on; ``fit`` counts on from there."""
        # Set in one go: threads of a queue that still make batches see the one or the other.
        self._epoch_and_order = (epoch, self.samples.order(epoch))

    def on_epoch_end(self) -> None:
        """Go on to the next epoch; Keras calls it, once before the first epoch of ``fit``, too."""
        self.set_epoch(self.epoch + 1)

    def __len__(self) -> int:
        return len(self._chunks)

    def __getitem__(self, index: int) -> tuple[Any, NDArray[np.float32]]:
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
