"""Hits of an image's rays on triangles, exact at the centres of its pixels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Floats, Numbers, expand_counts
from ...external.compiling import uses_numba
from ..triangles import NO_TRIANGLES, Triangles
from .pixel_rays import PixelIndex, PixelRays

#: Candidates, pixels in boxes around triangles, that numpy looks at together.
_BATCH = 1 << 18
#: Least depth at which edges that lead behind the camera are cut, to find the pixels that they may cross.
_NEAR = 1e-6
#: Share by which boxes around triangles are wider, for rounding.
_WIDER = 1e-9


class FaceHits(NamedTuple):
    """First hits of an image's rays on triangles.

    Attributes
    ----------
    t : array (height, width)
        Distance along the ray, in units of its direction; infinite for a miss.
    triangle : array (height, width) of int64
        Index of the triangle; -1 for a miss.
    triangles : Triangles
        Those that may be seen, (n,).
    forms : array (n, 4, 3)
        Edge functions and nearness of each, by constant, column and row: see `face_hits`.
    side : array (n,)
        1 where the camera sees the outside, -1 where it sees the inside.
    """

    t: Floats
    triangle: Numbers
    triangles: Triangles
    forms: Floats
    side: Floats

    @classmethod
    def none(cls, rays: PixelRays) -> FaceHits:
        """Misses of all rays."""
        shape = rays.height, rays.width
        misses = np.full(shape, np.inf), np.full(shape, -1, np.int64)
        return cls(*misses, NO_TRIANGLES, np.empty((0, 4, 3)), np.empty(0))


def face_hits(triangles: Triangles, camera_m: Floats, axes: Floats, rays: PixelRays) -> FaceHits:
    """Find the first triangle that each pixel's ray hits, from whichever side.

    A ray o + x·a + y·b is inside the cone over a triangle with corners u, v, w, relative to the camera, where the
    products of the ray with u×v, v×w and w×u have one sign: functions linear in x and y, whose signs on an edge are
    exactly opposite for the two triangles that share it, so that no ray passes between. 1/t is linear, too. Nothing
    is divided by depths, so corners may lie beside and behind the camera.

    Parameters
    ----------
    camera_m : array (3,)
        Geocentric position of the camera.
    axes : array (3, 3)
        Its axes east, north and up in the Earth's frame, as rows; the rays are in these.
    """
    ways = rays.ways @ axes
    seen, boxes, forms, side = (_compiled_outlines if uses_numba() else _outlines)(triangles, camera_m, ways, rays)
    if not len(seen):
        return FaceHits.none(rays)
    nearness, triangle = np.zeros((rays.height, rays.width)), np.full((rays.height, rays.width), -1, np.int64)
    _draw_at_pixels(forms, boxes, rays, nearness, triangle)
    with np.errstate(divide="ignore"):
        return FaceHits(1.0 / nearness, triangle, triangles.take(seen), forms, side)


def _outlines(
    triangles: Triangles, camera_m: Floats, ways: Floats, rays: PixelRays
) -> tuple[Numbers, Numbers, Floats, Floats]:
    """Indices of the triangles that pixels may see, with their boxes (n, 4), forms (n, 4, 3) and sides (n,)."""
    corners = triangles.corners_m - camera_m
    boxes = _boxes(corners, ways, rays)
    seen = np.flatnonzero((boxes[:, 0] < boxes[:, 2]) & (boxes[:, 1] < boxes[:, 3]))
    forms, side = _forms(corners[seen], ways)
    is_face = side != 0.0
    seen = seen[is_face]
    return seen, boxes[seen], forms[is_face], side[is_face]


def _compiled_outlines(
    triangles: Triangles, camera_m: Floats, ways: Floats, rays: PixelRays
) -> tuple[Numbers, Numbers, Floats, Floats]:
    """`_outlines` by numba: the same forms and sides; boxes may differ within their slack."""
    from .face_kernels import outlines

    n = len(triangles)
    seen, boxes, forms, side = np.empty(n, np.int64), np.empty((n, 4), np.int64), np.empty((n, 4, 3)), np.empty(n)
    limits = np.array([*rays.plane_px, _NEAR, _WIDER, _margin(rays)])
    frame = np.ascontiguousarray(np.stack([camera_m, *ways, *np.linalg.inv(ways)]))
    count = outlines(
        np.ascontiguousarray(triangles.corners_m), frame, limits, seen, boxes, forms, side, np.empty((10, 4))
    )
    return seen[:count], boxes[:count], forms[:count], side[:count]


def _forms(corners: Floats, ways: Floats) -> tuple[Floats, Floats]:
    """Edge functions and nearness (n, 4, 3) by constant, column and row; and sides (n,), 0 for those seen edge-on.

    Sums and products one by one: a product of matrices may round the shared corners of two triangles differently.
    """
    u, v, w = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = _cross(v - u, w - u)
    depth = normal[:, 0] * u[:, 0] + normal[:, 1] * u[:, 1] + normal[:, 2] * u[:, 2]
    sign = np.sign(depth)
    forms = np.empty((len(corners), 4, 3))
    for at, edge in enumerate((_cross(u, v), _cross(v, w), _cross(w, u), normal)):
        scale = sign if at < 3 else 1.0 / np.where(depth == 0.0, 1.0, depth)
        for term, way in enumerate(ways):
            forms[:, at, term] = (edge[:, 0] * way[0] + edge[:, 1] * way[1] + edge[:, 2] * way[2]) * scale
    return forms, -sign


def _cross(one: Floats, other: Floats) -> Floats:
    """Cross products (n, 3); of swapped factors they are exactly opposite."""
    (a, b, c), (d, e, f) = one.T, other.T
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=1)


def _margin(rays: PixelRays) -> float:
    """Distance that the points of pixels keep from the edges of ideal pixels, px; 1 beyond them for any points."""
    return 1.0 if rays.is_bent else 0.5


def _boxes(corners: Floats, ways: Floats, rays: PixelRays) -> Numbers:
    """Columns and rows of the ideal pixels that triangles may cover: firsts, and the ones after the last; (n, 4)."""
    inverse = np.linalg.inv(ways)
    depth, x, y = np.moveaxis(corners @ inverse, 2, 0)
    is_ahead = depth > _NEAR
    with np.errstate(divide="ignore", invalid="ignore"):
        x_px, y_px = x / depth, y / depth
    # Three columns compared are ten times as fast as a reduction of rows of three.
    low, high = (
        np.stack([end(end(at[:, 0], at[:, 1]), at[:, 2]) for at in (x_px, y_px)]) for end in (np.minimum, np.maximum)
    )
    first, second, third = is_ahead.T
    some = first | second | third
    across = np.flatnonzero(some & ~(first & second & third))
    if len(across):
        points = _cut(depth[across], np.stack([x[across], y[across]]), is_ahead[across])
        low[:, across], high[:, across] = np.nanmin(points, axis=2), np.nanmax(points, axis=2)
    size, margin = np.array([[side] for side in rays.plane_px]), _margin(rays)
    low[:, ~some], high[:, ~some] = 1.0, 0.0
    slack = _WIDER * (np.abs(low) + np.abs(high) + size)
    firsts = np.clip(np.ceil(low - slack - margin), 0.0, size)
    ends = np.clip(np.floor(high + slack + margin), 0.0, size)
    boxes: Numbers = np.concatenate([firsts, ends]).T.astype(np.int64)
    return boxes


def _cut(depth: Floats, at: Floats, is_ahead: Floats) -> Floats:
    """Image points (2, n, 6): corners ahead of the camera, and where edges reach the least depth; NaN where none."""
    after = np.roll(depth, -1, axis=1), np.roll(at, -1, axis=2), np.roll(is_ahead, -1, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        corners = np.where(is_ahead, at / depth, np.nan)
        share = (_NEAR - depth) / (after[0] - depth)
        cuts = np.where(is_ahead != after[2], (at + share * (after[1] - at)) / _NEAR, np.nan)
    return np.concatenate([corners, cuts], axis=2)


def _draw_at_pixels(forms: Floats, boxes: Numbers, rays: PixelRays, nearness: Floats, triangle: Numbers) -> None:
    """Draw triangles into an image of nearness and triangles, at the points that its pixels see."""
    if not uses_numba():
        _draw(forms, _pixel_boxes(rays.index, boxes, rays) if rays.is_bent else boxes, rays, nearness, triangle)
        return
    from . import face_kernels

    if rays.is_bent:
        box = np.empty(4, np.int64)
        face_kernels.draw_seen(forms, boxes, rays.points, rays.index, rays.top, box, nearness, triangle)
    else:
        face_kernels.draw(forms, boxes, nearness, triangle)


def _pixel_boxes(index: PixelIndex, boxes: Numbers, rays: PixelRays) -> Numbers:
    """Boxes (n, 4) around the pixels whose points may lie in boxes of the ideal image plane."""
    left, top, right, bottom = boxes.T
    level, open_ = np.zeros(len(boxes), np.int64), np.ones(len(boxes), bool)
    for one in range(len(index.first) - 1):
        side = index.cell_px << one
        open_ &= np.maximum(right // side - left // side, bottom // side - top // side) > 3
        level += open_
    size = index.cell_px << level
    high, wide = index.high[level], index.wide[level]
    found = np.array([[rays.width], [0], [rays.height + rays.top], [0]]) + np.zeros(len(boxes), np.int64)
    # Up to four cells across.
    for below, beside in np.ndindex(4, 4):
        i, j = (
            np.minimum(np.minimum(low // size + off, end // size), most - 1)
            for low, off, end, most in ((top, below, bottom, high), (left, beside, right, wide))
        )
        ends = index.ends[:, index.first[level] + i * wide + j]
        found[::2], found[1::2] = np.minimum(found[::2], ends[::2]), np.maximum(found[1::2], ends[1::2])
    first, last, upper, lower = found
    upper, lower = (np.clip(at - rays.top, 0, rays.height) for at in (upper, lower))
    return np.stack([first, upper, np.maximum(first, last), np.maximum(upper, lower)], axis=1)


def _draw(forms: Floats, boxes: Numbers, rays: PixelRays, nearness: Floats, triangle: Numbers) -> None:
    """`face_kernels.draw` and `draw_seen` in numpy: the same pixels, a number of candidates at a time."""
    wide, high = boxes[:, 2] - boxes[:, 0], boxes[:, 3] - boxes[:, 1]
    # Rows of boxes one by one, so that a box of the whole image is not one batch.
    of_row, row = expand_counts(high)
    row = row + boxes[of_row, 1]
    ends = np.cumsum(wide[of_row])
    draw_rows = _draw_points if rays.is_bent else _draw_rows
    start = begun = 0
    while start < len(of_row):
        stop = max(int(np.searchsorted(ends, begun + _BATCH, "right")), start + 1)
        draw_rows(forms, boxes, (of_row[start:stop], row[start:stop]), rays, nearness, triangle)
        start, begun = stop, int(ends[stop - 1])


def _draw_rows(
    forms: Floats,
    boxes: Numbers,
    rows: tuple[Numbers, Numbers],
    rays: PixelRays,  # noqa: ARG001  (all pixels of an ideal image are alike)
    nearness: Floats,
    triangle: Numbers,
) -> None:
    """Draw rows of triangles: numbers of the triangles and of the rows."""
    of_row, row = rows
    y = row + 0.5
    at_row = [forms[of_row, k, 0] + y * forms[of_row, k, 2] for k in range(4)]
    wide = boxes[of_row, 2] - boxes[of_row, 0]
    which, column = expand_counts(wide)
    column = column + boxes[of_row, 0][which]
    for k in range(3):
        inside = at_row[k][which] + (column + 0.5) * forms[of_row[which], k, 1] >= 0.0
        which, column = which[inside], column[inside]
    one = of_row[which]
    value = at_row[3][which] + (column + 0.5) * forms[one, 3, 1]
    _keep_nearest(one, row[which] * nearness.shape[1] + column, value, nearness, triangle)


def _draw_points(
    forms: Floats, boxes: Numbers, rows: tuple[Numbers, Numbers], rays: PixelRays, nearness: Floats, triangle: Numbers
) -> None:
    """`_draw_rows` at any points of pixels."""
    of_row, row = rows
    which, column = expand_counts(boxes[of_row, 2] - boxes[of_row, 0])
    column += boxes[of_row, 0][which]
    # With the pixels around the image, as the points are.
    wide = rays.width + 2
    place = (row[which] + 1) * wide + column + 1
    x, y = (at.ravel().take(place) for at in rays.points)
    for k in range(4):
        constant, per_x, per_y = (forms[of_row, k, term].take(which) for term in range(3))
        value: Floats = (constant + y * per_y) + x * per_x
        if k < 3:
            inside = np.flatnonzero(value >= 0.0)
            which, place = which.take(inside), place.take(inside)
            x, y = x.take(inside), y.take(inside)
    pixel = (place // wide - 1) * rays.width + place % wide - 1
    _keep_nearest(of_row[which], pixel, value, nearness, triangle)


def _keep_nearest(one: Numbers, pixel: Numbers, value: Floats, nearness: Floats, triangle: Numbers) -> None:
    """Put triangles into pixels where they are nearest."""
    nearer = value > nearness.ravel()[pixel]
    pixel, value, one = pixel[nearer], value[nearer], one[nearer]
    # The nearest of each pixel, and of equally near ones the first.
    order = np.lexsort((one, -value, pixel))
    order = order[np.append(True, np.diff(pixel[order]) != 0)[: len(order)]]
    nearness.ravel()[pixel[order]], triangle.ravel()[pixel[order]] = value[order], one[order]
