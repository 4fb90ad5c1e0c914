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
def fill_bounds(x: Floats, y: Floats, tile_px: int, bounds: Floats) -> None:
    """Write least x and y and greatest x and y of each tile of pixels into ``bounds`` (rows, columns, 4).

    Least are greater than greatest where no pixel of a tile sees the ground.
    """
    for tile_row in range(bounds.shape[0]):
        for tile_column in range(bounds.shape[1]):
            # Variables, as writing to the array for each pixel takes longer.
            least_x = least_y = np.inf
            most_x = most_y = -np.inf
            for row in range(tile_row * tile_px, min((tile_row + 1) * tile_px, x.shape[0])):
                for column in range(tile_column * tile_px, min((tile_column + 1) * tile_px, x.shape[1])):
                    px, py = x[row, column], y[row, column]
                    # Comparisons with NaN are false.
                    if px < least_x:
                        least_x = px
                    if px > most_x:
                        most_x = px
                    if py < least_y:
                        least_y = py
                    if py > most_y:
                        most_y = py
            bounds[tile_row, tile_column, 0], bounds[tile_row, tile_column, 1] = least_x, least_y
            bounds[tile_row, tile_column, 2], bounds[tile_row, tile_column, 3] = most_x, most_y


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
def _draw_tile(
    x: Floats, y: Floats, count: int, kept: Numbers, ends: Numbers, odd: Flags, box: Floats, radius_m: Floats,
    scale_m: Floats, starts: Numbers, edges: Floats, chosen: Numbers, found: Numbers,
) -> None:  # fmt: skip
    """Write the topmost pieces of one tile, of those that `_choose` has kept."""
    for row in range(x.shape[0]):
        for column in range(x.shape[1]):
            px, py = x[row, column], y[row, column]
            if not ends[0]:
                # The first piece covers the tile.
                if not (np.isnan(px) or np.isnan(py)):
                    found[row, column] = kept[0]
                continue
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


@compiled
def topmost(
    x: Floats, y: Floats, tile_px: int, box: Floats, radius_m: Floats, scale_m: Floats, starts: Numbers,
    edges: Floats, tiles: Floats, strips: Floats, every: Numbers, strip: Numbers, near: Numbers, kept: Numbers,
    ends: Numbers, odd: Flags, chosen: Numbers, found: Numbers,
) -> None:  # fmt: skip
    """Write the index of the topmost piece at each pixel into ``found`` (h, w), which holds -1.

    Parameters
    ----------
    x, y : array (h, w)
        Positions of the pixels; NaN without ground.
    box, radius_m, scale_m, starts, edges : array
        Of `Pieces`.
    tiles, strips : array (rows, columns, 4), (rows, 4)
        Bounds of tiles, from `fill_bounds`, and of their rows.
    every, strip, near, kept, ends, odd : array (n,)
        Working memory; ``every`` has all indices of pieces.
    chosen : array (m,)
        Working memory for edges.
    """
    rows, columns = x.shape
    for tile_row in range(len(strips)):
        in_strip = _overlapping(box, strips[tile_row], every, len(every), strip)
        if not in_strip:
            continue
        top, bottom = tile_row * tile_px, min((tile_row + 1) * tile_px, rows)
        for tile_column in range(tiles.shape[1]):
            left, right = tile_column * tile_px, min((tile_column + 1) * tile_px, columns)
            bounds = tiles[tile_row, tile_column]
            count = _overlapping(box, bounds, strip, in_strip, near)
            count = _choose(bounds, near, count, radius_m, starts, edges, kept, ends, odd, chosen)
            if count:
                _draw_tile(
                    x[top:bottom, left:right], y[top:bottom, left:right], count, kept, ends, odd, box, radius_m,
                    scale_m, starts, edges, chosen, found[top:bottom, left:right],
                )  # fmt: skip
