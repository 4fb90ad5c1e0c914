"""Number of images per place, shown if images are too many or too small to be drawn. Runs in the background."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from qgis.core import QgsFeature, QgsGeometry

from .view import MERCATOR, PreviewWorld, Rect

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .index import Rects

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.int64]

#: A polygon with one closed ring of five points, in well-known binary.
_RECTANGLE = np.dtype([("order", "<u1"), ("type", "<u4"), ("rings", "<u4"), ("corners", "<u4"), ("at", "<f8", (5, 2))])
_LITTLE_ENDIAN, _POLYGON, _MULTI_POLYGON = 1, 3, 6


class DensityCells(NamedTuple):
    """Part of a grid that divides the world into 2**level by 2**level cells, counted from the south-west corner.

    Cells stay in place when the map moves. Columns beyond the world's east edge continue across the antimeridian.
    """

    level: int
    column: int
    row: int
    columns: int
    rows: int
    world: PreviewWorld = MERCATOR

    @classmethod
    def covering(cls, rect: Rect, px_per_m: float) -> DensityCells:
        """Cells over a part of the world, as fine as useful on the screen."""
        # Least size of a cell on the screen; cells are less than twice as large.
        least_px = 8.0
        # Largest number of cells along a side.
        most_cells = 400
        width = max(least_px / px_per_m, rect.longer_m / (most_cells - 2))
        world = rect.world
        level = max(math.floor(math.log2(world.size / width)), 0)
        size = world.size / 2.0**level
        corner = world.west, world.south
        first = [math.floor((edge - low) / size) for edge, low in zip((rect.west, rect.south), corner)]
        last = [math.ceil((edge - low) / size) for edge, low in zip((rect.east, rect.north), corner)]
        return cls(level, *first, *(max(stop - start, 1) for start, stop in zip(first, last)), world)

    @property
    def size_m(self) -> float:
        """Width of a cell."""
        return self.world.size / 2.0**self.level


def mean_images(boxes: Rects, cells: DensityCells) -> Floats:
    """Exact mean number of rectangles over each cell; (rows, columns), southernmost row first.

    The number at a single place of each cell would show moiré between the regular grids of images and cells.
    """
    around, size, world = 1 << cells.level, cells.size_m, cells.world
    # The coverage of rows and columns by a rectangle is the running sum of a few steps at its edges.
    steps = np.zeros((cells.rows + 1) * (cells.columns + 1))
    # Process rectangles in blocks to bound memory.
    batch = 1 << 17
    for start in range(0, len(boxes.west), batch):
        west, south, east, north = (
            (edge[start : start + batch] - low) / size for edge, low in zip(boxes.edges, 2 * (world.west, world.south))
        )
        low, high = (np.clip(edge - cells.row, 0.0, cells.rows) for edge in (south, north))
        for shift in (-around, 0, around) if world.wraps else (0,):
            left, right = (np.clip(edge + (shift - cells.column), 0.0, cells.columns) for edge in (west, east))
            seen = (left < right) & (low < high)
            along = _edge_steps(low[seen], high[seen], cells.rows)
            across = _edge_steps(left[seen], right[seen], cells.columns)
            for row, tall in along:
                for column, wide in across:
                    place = row * (cells.columns + 1) + column
                    steps += np.bincount(place, tall * wide, minlength=len(steps))
    return steps.reshape(cells.rows + 1, -1).cumsum(axis=0).cumsum(axis=1)[:-1, :-1]


def _edge_steps(first: Floats, last: Floats, cells: int) -> list[tuple[Numbers, Floats]]:
    """Indices and heights of steps whose running sum is the share of each of ``cells`` cells between two edges."""
    steps = []
    for edge, sign in ((first, 1.0), (last, -1.0)):
        cell = np.minimum(edge.astype(np.int64), cells - 1)
        into = edge - cell
        steps += [(cell, sign * (1.0 - into)), (cell + 1, sign * into)]
    return steps


def levels(means: Floats) -> Numbers:
    """Means as integers in quarters, rounded more coarsely for many images, so that there are few levels."""
    quarters = np.rint(4.0 * means)
    # Eight levels per doubling of the number of images, at most a sixth apart.
    step = 2.0 ** np.maximum(np.floor(np.log2(np.maximum(quarters, 1.0))) - 3, 0.0)
    return (np.rint(quarters / step) * step).astype(np.int64)


def density_features(quarters: Numbers, cells: DensityCells) -> list[QgsFeature]:
    """One feature for each of the `levels`, with all cells of the level, neighbours merged."""
    padded = np.pad(quarters, ((0, 0), (1, 1)))
    change = padded[:, 1:] != padded[:, :-1]
    # Do not merge cells across the antimeridian.
    border = (1 << cells.level) - cells.column
    if cells.world.wraps and 0 < border < cells.columns:
        change[:, border] = True
    row, column = np.nonzero(change)
    value = padded[row, column + 1]
    stop = np.append(column[1:], 0)
    shown = value > 0
    row, column, stop, value = row[shown], column[shown], stop[shown], value[shown]
    order = np.lexsort((row, stop, column, value))
    row, column, stop, value = row[order], column[order], stop[order], value[order]
    # Merge rectangles of equal width above each other, as edges between them would show as hairlines.
    same = (np.diff(value) == 0) & (np.diff(column) == 0) & (np.diff(stop) == 0) & (np.diff(row) == 1)
    first = np.flatnonzero(np.r_[True, ~same][: len(value)])
    tops = np.r_[row[first[1:] - 1], row[-1:]] + 1
    shapes = _rectangles(cells, row[first], tops, column[first], stop[first])
    value = value[first]
    starts = np.flatnonzero(np.r_[True, value[1:] != value[:-1]]) if len(value) else np.empty(0, np.int64)
    features = []
    for begin, end in zip(starts.tolist(), [*starts[1:].tolist(), len(value)]):
        geometry = QgsGeometry()
        head = struct.pack("<BII", _LITTLE_ENDIAN, _MULTI_POLYGON, end - begin)
        geometry.fromWkb(head + shapes[begin:end].tobytes())
        feature = QgsFeature()
        feature.setGeometry(geometry)
        feature.setAttributes([float(value[begin]) / 4.0])
        features.append(feature)
    return features


def _rectangles(cells: DensityCells, low: Numbers, high: Numbers, first: Numbers, stop: Numbers) -> NDArray[np.void]:
    """Rectangles between rows and columns of cells (the upper ones excluded), in well-known binary."""
    size, around, world = cells.size_m, 1 << cells.level, cells.world
    turn = np.floor_divide(cells.column + first, around) * around if world.wraps else 0
    west, east = (world.west + size * (cells.column + edge - turn) for edge in (first, stop))
    south, north = (world.south + size * (cells.row + edge) for edge in (low, high))
    shapes = np.zeros(len(low), _RECTANGLE)
    shapes["order"], shapes["type"], shapes["rings"], shapes["corners"] = _LITTLE_ENDIAN, _POLYGON, 1, 5
    ring = ((west, north), (east, north), (east, south), (west, south), (west, north))
    for index, (x, y) in enumerate(ring):
        shapes["at"][:, index, 0], shapes["at"][:, index, 1] = x, y
    return shapes
