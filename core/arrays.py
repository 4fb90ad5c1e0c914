"""Array types for annotations."""

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
