"""Hashed lattices and spline noise, from which the embedded world is computed.

Level *k* divides the world square, be it the Web-Mercator map or the chart about a pole, into ``2**k`` by ``2**k``
cells. A cell's hash depends on its column modulo ``2**k``, so everything built on it is periodic across the
antimeridian. Noise is a uniform cubic B-spline whose coefficients lie on such lattices. Spline spaces of successive
levels are nested: the sum of many octaves is one spline on the finest level, evaluated once per pixel, and its
coefficients bound its values.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import NDArray

Array = NDArray[Any]

#: Side of the Web-Mercator square in Mercator metres (EPSG:3857, 2 pi a).
WORLD_M = 40075016.685578488

TILE_PX = 256

_MASK = 0xFFFFFFFF
#: Bits of a user's seed; the bits above hold the pole of a chart.
_SEED_BITS = 64


def mix(h: Array) -> NDArray[np.uint32]:
    """Scramble ``uint32`` values, so that each output bit depends on each input bit (MurmurHash3's finalizer)."""
    h = h.astype(np.uint32)
    h ^= h >> np.uint32(16)
    h *= np.uint32(0x85EBCA6B)
    h ^= h >> np.uint32(13)
    h *= np.uint32(0xC2B2AE35)
    h ^= h >> np.uint32(16)
    return h


def chart_seed(seed: int, pole: int) -> int:
    """Combine a user's seed, below ``2**64``, with the pole of a chart: 1 north, -1 south, 0 for the Web-Mercator map.

    This one number identifies a landscape.
    """
    return seed + ((pole % 3) << _SEED_BITS)


def chart_pole(seed: int) -> int:
    """Pole of a landscape's chart; inverse of `chart_seed`."""
    return (0, 1, -1)[seed >> _SEED_BITS]


def salt(seed: int, *words: int) -> int:
    """Hash of a landscape's seed and a few small integers, as a Python integer below ``2**32``."""
    h = seed & _MASK
    chart = seed >> _SEED_BITS
    for word in ((seed >> 32) & _MASK, *((chart,) if chart else ()), *words):
        h = (h ^ (word * 0x9E3779B1)) & _MASK
        h ^= h >> 16
        h = (h * 0x85EBCA6B) & _MASK
        h ^= h >> 13
        h = (h * 0xC2B2AE35) & _MASK
        h ^= h >> 16
    return h


def cell_hash(salts: int | Array, level: int, i: Array, j: Array) -> NDArray[np.uint32]:
    """Hash of lattice cells.

    Parameters
    ----------
    salts : int or uint32 array
        Different for each use of the lattice; broadcast with `i` and `j`.
    level : int
        The lattice has ``2**level`` columns; `i` wraps around.
    i, j : int64 arrays
        Columns and rows, broadcast together.
    """
    column = mix((i & ((1 << level) - 1)).astype(np.uint32) + np.uint32(0x27D4EB2F))
    row = mix((j & _MASK).astype(np.uint32) + np.uint32((0x165667B1 + level * 0x9E3779B1) & _MASK))
    key = (column * np.uint32(0x9E3779B1)) ^ row
    return mix(key ^ np.asarray(salts, dtype=np.uint32))


def signed(h: Array) -> NDArray[np.float32]:
    """Map ``uint32`` hashes to float32 in [-1, 1)."""
    return h.view(np.int32).astype(np.float32) * np.float32(2.0**-31)


def bits(h: Array, shift: int, count: int) -> NDArray[np.float32]:
    """Take `count` bits of hashes as float32 in [0, 1): several independent numbers from one hash."""
    return ((h >> np.uint32(shift)) & np.uint32((1 << count) - 1)).astype(np.float32) * np.float32(2.0**-count)


@dataclass(frozen=True)
class LatticeWindow:
    """A block of lattice points: columns ``i0 … i0 + columns - 1`` and rows ``j0 … j0 + rows - 1`` of `level`."""

    level: int
    i0: int
    j0: int
    columns: int
    rows: int

    def indices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the columns, shape (1, columns), and the rows, shape (rows, 1)."""
        i = np.arange(self.i0, self.i0 + self.columns, dtype=np.int64)[None, :]
        j = np.arange(self.j0, self.j0 + self.rows, dtype=np.int64)[:, None]
        return i, j

    @property
    def rows_v(self) -> NDArray[np.float64]:
        """World fractions of the middles of the rows of cells, from the north, (rows,)."""
        return (np.arange(self.j0, self.j0 + self.rows) + 0.5) / float(1 << self.level)

    def parent(self) -> LatticeWindow:
        """Return the block one level coarser that `refine` needs to fill this one."""
        i0, j0 = self.i0 // 2 - 1, self.j0 // 2 - 1
        i1, j1 = (self.i0 + self.columns - 1) // 2 + 1, (self.j0 + self.rows - 1) // 2 + 1
        return LatticeWindow(self.level - 1, i0, j0, i1 - i0 + 1, j1 - j0 + 1)

    def grown(self, cells: int) -> LatticeWindow:
        """Return the block with a margin of `cells` on each side."""
        return LatticeWindow(
            self.level, self.i0 - cells, self.j0 - cells, self.columns + 2 * cells, self.rows + 2 * cells
        )


def refine(coefficients: Array, coarse: LatticeWindow, fine: LatticeWindow) -> Array:
    """Coefficients of the same cubic spline one level finer (two-scale relation, masks 1 6 1 and 4 4 over 8).

    `coefficients` has shape (..., coarse.rows, coarse.columns); the result (..., fine.rows, fine.columns).
    """
    tall = _refine_last(np.swapaxes(coefficients, -1, -2), coarse.j0, fine.j0, fine.rows)
    return _refine_last(np.swapaxes(tall, -1, -2), coarse.i0, fine.i0, fine.columns)


def _refine_last(c: Array, coarse0: int, fine0: int, count: int) -> Array:
    first = fine0 // 2 - coarse0
    pairs = (fine0 + count - 1) // 2 - fine0 // 2 + 1
    out = np.empty((*c.shape[:-1], 2 * pairs), dtype=np.float32)
    middle = c[..., first : first + pairs]
    right = c[..., first + 1 : first + pairs + 1]
    even = out[..., 0::2]
    np.add(c[..., first - 1 : first + pairs - 1], right, out=even)
    even *= np.float32(0.125)
    even += np.float32(0.75) * middle
    odd = out[..., 1::2]
    np.add(middle, right, out=odd)
    odd *= np.float32(0.5)
    offset = fine0 & 1
    return out[..., offset : offset + count]
