"""Greatest values of a grid's cells in ever larger blocks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Floats, Numbers


class Pyramid(NamedTuple):
    """Greatest values in cells, in blocks of 2 x 2, 4 x 4, … cells, each with its neighbours.

    ``flat`` holds the levels one after the other, each with a margin of one block; level i begins at ``first[i]`` and
    has ``high[i]`` rows and ``wide[i]`` columns without the margin.
    """

    flat: Floats
    first: Numbers
    high: Numbers
    wide: Numbers

    @classmethod
    def build(cls, cells: Floats) -> Pyramid:
        """Build the pyramid of values of cells (rows, columns), surrounded by minus infinity."""
        block, parts, shapes = cells, [], []
        while True:
            shapes.append(block.shape)
            wider = np.pad(block, 2, constant_values=-np.inf)
            tall = np.maximum(np.maximum(wider[:-2], wider[1:-1]), wider[2:])
            parts.append(np.maximum(np.maximum(tall[:, :-2], tall[:, 1:-1]), tall[:, 2:]).ravel())
            if max(block.shape) == 1:
                break
            even = np.pad(block, [(0, size % 2) for size in block.shape], constant_values=-np.inf)
            block = np.maximum(
                np.maximum(even[::2, ::2], even[::2, 1::2]), np.maximum(even[1::2, ::2], even[1::2, 1::2])
            )
        first = np.cumsum([0, *(len(part) for part in parts[:-1])])
        return cls(np.concatenate(parts), first, *np.array(shapes, np.int64).T.copy())

    @property
    def levels(self) -> int:
        """Number of levels."""
        return len(self.first)

    def block(self, level: Numbers | int, x: Floats, y: Floats) -> Numbers:
        """Indices in ``flat`` of the blocks at levels and points (n,)."""
        high, wide = self.high[level], self.wide[level]
        scale = np.ldexp(1.0, -np.asarray(level))
        j = np.minimum(np.maximum(np.floor(x * scale), -1.0), wide)
        i = np.minimum(np.maximum(np.floor(y * scale), -1.0), high)
        block: Numbers = (self.first[level] + (i + 1.0) * (wide + 2) + (j + 1.0)).astype(np.int64)
        return block

    def around(self, level: Numbers | int, x: Floats, y: Floats) -> Floats:
        """Greatest values within a block's width of points (n,) at levels (n,)."""
        return self.flat[self.block(level, x, y)]
