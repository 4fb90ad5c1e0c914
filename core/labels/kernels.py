"""The topmost piece at each pixel, compiled: the same as the code in `drawing` that needs no numba."""

from __future__ import annotations

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..external.compiling import compiled


@compiled
def contains(px: float, py: float, edges: Floats, chosen: Numbers, first: int, end: int, is_odd: bool) -> bool:
    """Whether a polygon contains a position, by its edges that need a test; ``is_odd`` is the parity of the others."""
    for at in range(first, end):
        edge = chosen[at]
        low_y, high_y = edges[edge, 1], edges[edge, 3]
        if py < low_y or py >= high_y:
            continue
        low_x, high_x = edges[edge, 0], edges[edge, 2]
        # The bounds are exact, where the crossing is rounded.
        crosses = px < min(low_x, high_x)
        if not crosses and px < max(low_x, high_x):
            crosses = px < low_x + (py - low_y) * (high_x - low_x) / (high_y - low_y)
        if crosses:
            is_odd = not is_odd
    return is_odd


@compiled
def is_near(px: float, py: float, edges: Floats, edge: int, x_m: float, y_m: float, radius_m: float) -> bool:
    """Whether a position lies within a radius of a segment; x_m and y_m are metres per unit."""
    east, north = (px - edges[edge, 0]) * x_m, (py - edges[edge, 1]) * y_m
    way_east, way_north = (edges[edge, 2] - edges[edge, 0]) * x_m, (edges[edge, 3] - edges[edge, 1]) * y_m
    square = way_east * way_east + way_north * way_north
    share = 0.0
    if square > 0.0:
        share = min(max((east * way_east + north * way_north) / square, 0.0), 1.0)
    off_east, off_north = east - share * way_east, north - share * way_north
    return bool(off_east * off_east + off_north * off_north <= radius_m * radius_m)


@compiled
def fill_bounds(x: Floats, y: Floats, rows: tuple[int, int], columns: tuple[int, int], bounds: Floats) -> bool:
    """Least x and y and greatest x and y of a rectangle of pixels; returns whether any sees the ground."""
    bounds[0] = bounds[1] = np.inf
    bounds[2] = bounds[3] = -np.inf
    for row in range(rows[0], rows[1]):
        for column in range(columns[0], columns[1]):
            # Comparisons with NaN are false.
            if x[row, column] < bounds[0]:
                bounds[0] = x[row, column]
            if x[row, column] > bounds[2]:
                bounds[2] = x[row, column]
            if y[row, column] < bounds[1]:
                bounds[1] = y[row, column]
            if y[row, column] > bounds[3]:
                bounds[3] = y[row, column]
    return bool(bounds[0] <= bounds[2] and bounds[1] <= bounds[3])


@compiled
def _overlapping(box: Floats, bounds: Floats, among: Numbers, count: int, found: Numbers) -> int:
    """Write the pieces that overlap bounds; returns their number."""
    number = 0
    for at in range(count):
        piece = among[at]
        if (
            box[piece, 0] <= bounds[2]
            and box[piece, 2] >= bounds[0]
            and box[piece, 1] <= bounds[3]
            and box[piece, 3] >= bounds[1]
        ):
            found[number] = piece
            number += 1
    return number


@compiled
def _choose(
    bounds: Floats, among: Numbers, count: int, radius_m: Floats, starts: Numbers, edges: Floats,
    kept: Numbers, ends: Numbers, odd: Flags, chosen: Numbers,
) -> int:  # fmt: skip
    """Write the pieces that may hold a pixel of a tile, with the edges that need a test; returns their number."""
    number, last = 0, 0
    for at in range(count):
        piece, first, is_odd = among[at], last, False
        if radius_m[piece] > 0.0:
            last += 1
        else:
            for edge in range(starts[piece], starts[piece + 1]):
                low_x, high_x = min(edges[edge, 0], edges[edge, 2]), max(edges[edge, 0], edges[edge, 2])
                if edges[edge, 1] > bounds[3] or edges[edge, 3] <= bounds[1] or high_x <= bounds[0]:
                    continue
                if low_x > bounds[2] and edges[edge, 1] <= bounds[1] and edges[edge, 3] > bounds[3]:
                    is_odd = not is_odd
                    continue
                chosen[last] = edge
                last += 1
            if last == first and not is_odd:
                continue
        kept[number], ends[number], odd[number] = piece, last, is_odd
        number += 1
        if last == first:
            # It covers the tile.
            break
    return number


@compiled
def topmost(
    x: Floats, y: Floats, tile_px: int, box: Floats, radius_m: Floats, scale_m: Floats, starts: Numbers,
    edges: Floats, bounds: Floats, every: Numbers, strip: Numbers, near: Numbers, kept: Numbers, ends: Numbers,
    odd: Flags, chosen: Numbers, found: Numbers,
) -> None:  # fmt: skip
    """Write the index of the topmost piece at each pixel into ``found`` (h, w), which holds -1.

    Parameters
    ----------
    x, y : array (h, w)
        Positions of the pixels; NaN without ground.
    box, radius_m, scale_m, starts, edges : array
        Of `Pieces`.
    bounds : array (4,)
    every, strip, near, kept, ends, odd : array (n,)
        Working memory; ``every`` has all indices of pieces.
    chosen : array (m,)
        Working memory for edges.
    """
    rows, columns = x.shape
    for top in range(0, rows, tile_px):
        bottom = min(top + tile_px, rows)
        if not fill_bounds(x, y, (top, bottom), (0, columns), bounds):
            continue
        in_strip = _overlapping(box, bounds, every, len(every), strip)
        for left in range(0, columns, tile_px):
            right = min(left + tile_px, columns)
            if not in_strip or not fill_bounds(x, y, (top, bottom), (left, right), bounds):
                continue
            count = _overlapping(box, bounds, strip, in_strip, near)
            count = _choose(bounds, near, count, radius_m, starts, edges, kept, ends, odd, chosen)
            for row in range(top, bottom if count else top):
                for column in range(left, right):
                    px, py = x[row, column], y[row, column]
                    for at in range(count):
                        piece = kept[at]
                        if not (box[piece, 0] <= px <= box[piece, 2] and box[piece, 1] <= py <= box[piece, 3]):
                            continue
                        if radius_m[piece] > 0.0:
                            x_m, y_m = scale_m[piece, 0], scale_m[piece, 1]
                            if is_near(px, py, edges, starts[piece], x_m, y_m, radius_m[piece]):
                                found[row, column] = piece
                                break
                        elif contains(px, py, edges, chosen, ends[at - 1] if at else 0, ends[at], odd[at]):
                            found[row, column] = piece
                            break
