"""Tiles under the samples of an image, compiled.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math

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
    for one in range(len(du)):
        first_x, last_x = _span(du[one], u, world, reach, size)
        first_y, last_y = _span(v[one], 0.0, world, reach, size)
        for row in range(min(max(first_y - top, 0), rows - 1), min(max(last_y - top, 0), rows - 1) + 1):
            for column in range(first_x - left, last_x - left + 1):
                covered[row, column] = True
