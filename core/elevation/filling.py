"""Interpolation of holes in heights."""

from __future__ import annotations

import numpy as np

from ..arrays import NDArray
from ..errors import InvalidInput, PartError
from ..imagery.raster.reading import ReadError, filled

Heights32 = NDArray[np.float32]
#: Longest distance over which holes are filled, px; the default of `gdal_fillnodata.py`.
REACH_PX = 100


def interpolated(heights_m: Heights32) -> Heights32:
    """Heights (rows, columns) with holes filled by GDAL's FillNodata.

    A pixel stays NaN if any of the four quadrants around it has no height within `REACH_PX`. Filled heights depend on
    heights within this distance only, and are rounded to millimetres, as further digits differ between processors.

    Raises
    ------
    InvalidInput
        GDAL is missing.
    PartError
        GDAL fails.
    """
    is_known = np.isfinite(heights_m)
    wanted = ~is_known & _is_surrounded(is_known)
    if not wanted.any():
        return heights_m
    try:
        found = filled(np.where(is_known, heights_m, np.float32(0.0)), is_known, REACH_PX)
    except InvalidInput as wrong:
        raise InvalidInput(
            "missing heights: are interpolated by GDAL, which is not there: pip install terrainav[raster]",
            field="holes",
        ) from wrong
    except ReadError as wrong:
        raise PartError("missing heights: cannot be interpolated: {0}", wrong) from wrong
    return np.where(wanted, np.round(found, 3), heights_m)


def _is_surrounded(is_known: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether each of the four quadrants around a pixel has heights within reach."""
    counts = np.zeros((is_known.shape[0] + 1, is_known.shape[1] + 1), np.int64)
    np.cumsum(np.cumsum(is_known, axis=0), axis=1, out=counts[1:, 1:])
    surrounded = np.ones(is_known.shape, np.bool_)
    spans = [_spans(side) for side in is_known.shape]
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
