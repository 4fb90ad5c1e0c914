"""Interpolation of holes in heights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput, PartError
from ..imagery.raster.reading import ReadError, filled

Heights32 = NDArray[np.float32]
#: Largest distance of a hole from heights on all sides, px; the default of `gdal_fillnodata.py`.
REACH_PX = 100


def interpolated(heights_m: Heights32) -> Heights32:
    """Heights (rows, columns) with holes filled by GDAL's FillNodata.

    NaN stays if one of the four quadrants around a pixel has no height within `REACH_PX`. Heights depend on those
    within that distance only, and are rounded to millimetres, as further digits differ between processors.

    Raises
    ------
    InvalidInput
        GDAL is missing.
    PartError
        GDAL fails.
    """
    there = np.isfinite(heights_m)
    wanted = ~there & _is_surrounded(there)
    if not wanted.any():
        return heights_m
    try:
        found = filled(np.where(there, heights_m, np.float32(0.0)), there, REACH_PX)
    except InvalidInput as wrong:
        raise InvalidInput(
            "missing heights: are interpolated by GDAL, which is not there: pip install terrainav[raster]",
            field="holes",
        ) from wrong
    except ReadError as wrong:
        raise PartError("missing heights: cannot be interpolated: {0}", wrong) from wrong
    return np.where(wanted, np.round(found, 3), heights_m)


def _is_surrounded(there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether each of the four quadrants around a pixel has heights within reach."""
    counts = np.zeros((there.shape[0] + 1, there.shape[1] + 1), np.int64)
    np.cumsum(np.cumsum(there, axis=0), axis=1, out=counts[1:, 1:])
    surrounded = np.ones(there.shape, np.bool_)
    spans = [_spans(side) for side in there.shape]
    for top, bottom in spans[0]:
        for left, right in spans[1]:
            found = counts[bottom][:, right] - counts[top][:, right] - counts[bottom][:, left]
            surrounded &= found + counts[top][:, left] > 0
    return surrounded


def _spans(side: int) -> tuple[tuple[NDArray[np.intp], NDArray[np.intp]], ...]:
    """Ranges of indices within reach before and after each of ``side`` pixels."""
    at = np.arange(side)
    before = np.maximum(at - REACH_PX, 0), at + 1
    return before, (at, np.minimum(at + REACH_PX + 1, side))
