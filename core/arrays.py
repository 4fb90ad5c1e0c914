"""Array types for annotations, and an idiom of arrays."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np

Scalar = TypeVar("Scalar", bound=np.generic)
#: As in `numpy.typing`, which takes a tenth of the time of numpy itself to import.
NDArray = np.ndarray[Any, np.dtype[Scalar]]
Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]
Flags = NDArray[np.bool_]
Bytes = NDArray[np.uint8]
#: Pixels of one of `bands.DATA_TYPES`, in most cases uint8.
PixelValues = NDArray[Any]


def expand_counts(counts: Numbers) -> tuple[Numbers, Numbers]:
    """Owner of each of ``counts`` (n,) items, and its number among the owner's: of 2, 0, 1, 0 0 2 and 0 1 0."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
