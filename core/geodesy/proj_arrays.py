"""PROJ's projections, one set for each thread, and calls of them with arrays of any shape."""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pyproj import Proj

Floats = NDArray[np.float64]


class _Projections(threading.local):
    """Projections that this thread has made: costly to make (0.4 ms), and PROJ's are for one thread at a time."""

    def __init__(self) -> None:
        self.of = lru_cache(maxsize=8)(Proj)


_PROJECTIONS = _Projections()


def projection(**definition: Any) -> Proj:
    """Projection by PROJ's parameters, for the current thread alone."""
    return _PROJECTIONS.of(**definition)


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
