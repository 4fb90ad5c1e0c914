"""Tiles under the samples of an image, compiled.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Flags, Floats
from ..external.compiling import compiled


@compiled
def _span(positions: Floats, begin: float, world: float, reach: float, size: int) -> tuple[int, int]:
    """First and last tile under positions along one axis."""
    low, high = positions[0], positions[0]
    for at in range(1, len(positions)):
        low, high = min(low, positions[at]), max(high, positions[at])
    first = math.floor(((begin + low) * world - reach) / size)
    return first, math.floor(((begin + high) * world + reach) / size)


@compiled
def mark_tiles(
    du: Floats, v: Floats, u: float, world: float, reach: float, size: int, left: int, top: int, covered: Flags
) -> None:
    """Mark the tiles (rows, columns) under cells or pixels, with all that a kernel reaches around them.

    ``du, v`` (n, k) are positions of corners or samples; the tiles are those from column ``left`` and row ``top`` on.
    """
    rows = len(covered)
    # Positions within a tile that was marked last, a thousandth of a pixel from where its neighbours begin.
    west, east, north, south = np.inf, -np.inf, np.inf, -np.inf
    for one in range(len(du)):
        is_known = True
        for at in range(du.shape[1]):
            is_known = is_known and west <= du[one, at] <= east and north <= v[one, at] <= south
        if is_known:
            continue
        first_x, last_x = _span(du[one], u, world, reach, size)
        first_y, last_y = _span(v[one], 0.0, world, reach, size)
        for row in range(min(max(first_y - top, 0), rows - 1), min(max(last_y - top, 0), rows - 1) + 1):
            for column in range(first_x - left, last_x - left + 1):
                covered[row, column] = True
        if first_x == last_x and first_y == last_y:
            room = reach + 1e-3
            west, east = (first_x * size + room) / world - u, ((first_x + 1) * size - room) / world - u
            north, south = (first_y * size + room) / world, ((first_y + 1) * size - room) / world
