"""Calls of PROJ with arrays of any shape."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def through_proj(
    function: Callable[..., tuple[Any, ...]], *values: Any, **options: Any
) -> tuple[Floats, ...]:
    """Results of a function of pyproj for arrays that go together, (their common shape) each.

    pyproj takes an array of a single value for a number, which numpy 2 deprecates: it is given two.
    """
    arrays = np.broadcast_arrays(*(np.asarray(value, np.float64) for value in values))
    shape, size = arrays[0].shape, arrays[0].size
    flat = [np.resize(array, 2) if size == 1 else array.ravel() for array in arrays]
    return tuple(
        np.asarray(result, np.float64)[:size].reshape(shape) for result in function(*flat, **options)
    )
