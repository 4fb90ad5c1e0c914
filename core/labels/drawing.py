"""The topmost piece at each pixel's centre, exactly: polygons by the even-odd rule, segments by their distance."""

from __future__ import annotations

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..external.compiling import uses_numba
from .pieces import Pieces

#: Sides of the tiles of pixels that share the choice of pieces and edges: small for compiled code.
_TILE_PX, _NUMPY_TILE_PX = 16, 64


def topmost(pieces: Pieces, x: Floats, y: Floats) -> Numbers:
    """Index of the topmost piece at each position (h, w), -1 for none; positions without ground are NaN.

    A polygon contains a position if the ray towards greater x crosses an odd number of its edges; an edge belongs to
    its lower end, not to its upper.
    """
    found = np.full(x.shape, -1, np.int64)
    if uses_numba():
        from . import kernels

        x, y = (np.ascontiguousarray(one, np.float64) for one in (x, y))
        tiles = np.empty((*(-(-length // _TILE_PX) for length in x.shape), 4))
        kernels.fill_bounds(x, y, _TILE_PX, tiles)
        strips = _joined_bounds(tiles, axis=1)
        which = _overlapping(pieces.box, _joined_bounds(strips, axis=0))
        if not len(which):
            return found
        near = pieces.take(which)
        count = len(near)
        strip, within, kept, ends = (np.empty(count, np.int64) for _ in range(4))
        kernels.topmost(
            x, y, _TILE_PX, near.box, near.radius_m, near.scale_m, near.starts, near.edges, tiles, strips,
            np.arange(count), strip, within, kept, ends, np.empty(count, np.bool_),
            np.empty(len(near.edges), np.int64), found,
        )  # fmt: skip
    else:
        which = _within(pieces.box, x, y)
        near = pieces.take(which)
        for top in range(0, x.shape[0] if len(which) else 0, _NUMPY_TILE_PX):
            for left in range(0, x.shape[1], _NUMPY_TILE_PX):
                tile = np.s_[top : top + _NUMPY_TILE_PX, left : left + _NUMPY_TILE_PX]
                _draw_tile(near, x[tile], y[tile], found[tile])
    # The last is for positions without a piece, whose index is -1.
    of_all: Numbers = np.append(which, -1).take(found)
    return of_all


def _joined_bounds(bounds: Floats, axis: int) -> Floats:
    """Bounds (..., 4) of several bounds along an axis."""
    return np.concatenate([bounds[..., :2].min(axis=axis), bounds[..., 2:].max(axis=axis)], axis=-1)


def _within(box: Floats, x: Floats, y: Floats) -> Numbers:
    """Indices of the boxes (n, 4) that overlap the bounds of positions."""
    is_known = np.isfinite(x) & np.isfinite(y)
    if not is_known.any():
        return np.empty(0, np.int64)
    if not is_known.all():
        x, y = x[is_known], y[is_known]
    return _overlapping(box, np.array([x.min(), y.min(), x.max(), y.max()]))


def _overlapping(box: Floats, bounds: Floats) -> Numbers:
    """Indices of the boxes (n, 4) that overlap bounds: least x and y, greatest x and y."""
    return np.flatnonzero((box[:, :2] <= bounds[2:]).all(axis=1) & (box[:, 2:] >= bounds[:2]).all(axis=1))


def _draw_tile(pieces: Pieces, x: Floats, y: Floats, found: Numbers) -> None:
    """Write the topmost pieces of one tile."""
    for piece in _within(pieces.box, x, y).tolist():
        west, south, east, north = pieces.box[piece]
        row, column = np.nonzero((found < 0) & (x >= west) & (x <= east) & (y >= south) & (y <= north))
        if not len(row):
            continue
        px, py = x[row, column], y[row, column]
        edges = pieces.edges[pieces.starts[piece] : pieces.starts[piece + 1]]
        if pieces.radius_m[piece] > 0.0:
            inside = _near(px, py, edges[0], pieces.scale_m[piece], pieces.radius_m[piece])
        else:
            inside = _contained(px, py, edges)
        found[row[inside], column[inside]] = piece


def _contained(px: Floats, py: Floats, edges: Floats) -> Flags:
    """Whether a polygon contains positions (n,)."""
    is_odd = np.zeros(len(px), np.bool_)
    used = (edges[:, 1] <= py.max()) & (edges[:, 3] > py.min()) & (edges[:, [0, 2]].max(axis=1) > px.min())
    for low_x, low_y, high_x, high_y in edges[used].tolist():
        crosses = (py >= low_y) & (py < high_y) & (px < max(low_x, high_x))
        at = np.nonzero(crosses & (px >= min(low_x, high_x)))[0]
        crosses[at] = px[at] < low_x + (py[at] - low_y) * (high_x - low_x) / (high_y - low_y)
        is_odd ^= crosses
    return is_odd


def _near(px: Floats, py: Floats, edge: Floats, scale_m: Floats, radius_m: float) -> Flags:
    """Whether positions (n,) lie within a radius of a segment."""
    (low_x, low_y, high_x, high_y), (x_m, y_m) = edge.tolist(), scale_m.tolist()
    east, north = (px - low_x) * x_m, (py - low_y) * y_m
    way_east, way_north = (high_x - low_x) * x_m, (high_y - low_y) * y_m
    square = way_east * way_east + way_north * way_north
    share = np.clip((east * way_east + north * way_north) / square, 0.0, 1.0) if square > 0.0 else 0.0
    off_east, off_north = east - share * way_east, north - share * way_north
    return np.asarray(off_east * off_east + off_north * off_north <= radius_m * radius_m)
