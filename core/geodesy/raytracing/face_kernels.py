"""Triangles drawn one by one, compiled: the same pixels as numpy's in `faces`. Needs numba; see `compiling`."""

from __future__ import annotations

import math

from ...arrays import Floats, Numbers
from ...external.compiling import compiled
from .pixel_rays import PixelIndex


@compiled
def _widen(ends: Floats, depth: float, x: float, y: float) -> None:
    """Widen the box (least x, greatest x, least y, greatest y) of image points by that of a corner."""
    x, y = x / depth, y / depth
    ends[0], ends[1] = min(ends[0], x), max(ends[1], x)
    ends[2], ends[3] = min(ends[2], y), max(ends[3], y)


@compiled
def _fill_ends(at: Floats, near: float, ends: Floats) -> None:
    """Box of a triangle's image; what lies before the least depth ``near`` is cut off.

    at : array (3, 3)
        Depth, x and y of each corner, x and y times the depth.
    """
    ends[0] = ends[2] = math.inf
    ends[1] = ends[3] = -math.inf
    for k in range(3):
        one, other = at[k], at[(k + 1) % 3]
        if one[0] > near:
            _widen(ends, one[0], one[1], one[2])
        if (one[0] > near) != (other[0] > near):
            share = (near - one[0]) / (other[0] - one[0])
            _widen(ends, near, one[1] + share * (other[1] - one[1]), one[2] + share * (other[2] - one[2]))


@compiled
def _fill_cross(one: Floats, other: Floats, product: Floats) -> None:
    """Cross product; of swapped factors it is exactly opposite."""
    product[0] = one[1] * other[2] - one[2] * other[1]
    product[1] = one[2] * other[0] - one[0] * other[2]
    product[2] = one[0] * other[1] - one[1] * other[0]


@compiled
def _dot(one: Floats, other: Floats) -> float:
    """Inner product."""
    value: float = one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
    return value


@compiled
def _end(value: float, size: float) -> int:
    """Column or row within an image."""
    return int(min(max(value, 0.0), size))


@compiled
def outlines(
    corners_m: Floats,
    frame: Floats,
    limits: Floats,
    seen: Numbers,
    boxes: Numbers,
    forms: Floats,
    side: Floats,
    scratch: Floats,
) -> int:
    """Fill indices, boxes, forms and sides of the triangles that pixels may see; see `faces._outlines`.

    Parameters
    ----------
    corners_m : array (n, 3, 3)
    frame : array (7, 3)
        Position of the camera; rays by constant, column and row; the inverse matrix of the rays.
    limits : array (5,)
        Columns, rows, least depth, by which share boxes are wider, and by how many pixels.
    seen, boxes, forms, side : array (n,), (n, 4), (n, 4, 3), (n,)
        Filled from the front.
    scratch : array (10, 4)

    Returns
    -------
    int
        How many may be seen.
    """
    wide, high, near, wider, margin = limits
    at, from_camera, normal, edges, ends = scratch[:3], scratch[3:6], scratch[6], scratch[7:9], scratch[9]
    count = 0
    for one in range(len(corners_m)):
        for k in range(3):
            for axis in range(3):
                from_camera[k, axis] = corners_m[one, k, axis] - frame[0, axis]
            for term in range(3):
                at[k, term] = _dot(from_camera[k], frame[4:, term])
        if max(at[0, 0], at[1, 0], at[2, 0]) <= near:
            continue
        _fill_ends(at, near, ends)
        slack_x, slack_y = (
            wider * (abs(ends[0]) + abs(ends[1]) + wide),
            wider * (abs(ends[2]) + abs(ends[3]) + high),
        )
        left = _end(math.ceil(ends[0] - slack_x - margin), wide)
        right = _end(math.floor(ends[1] + slack_x + margin), wide)
        top = _end(math.ceil(ends[2] - slack_y - margin), high)
        bottom = _end(math.floor(ends[3] + slack_y + margin), high)
        if left >= right or top >= bottom:
            continue
        for axis in range(3):
            edges[0, axis] = from_camera[1, axis] - from_camera[0, axis]
            edges[1, axis] = from_camera[2, axis] - from_camera[0, axis]
        _fill_cross(edges[0], edges[1], normal)
        depth = _dot(normal, from_camera[0])
        if depth == 0.0:
            continue
        sign = 1.0 if depth > 0.0 else -1.0
        for term in range(3):
            forms[count, 3, term] = _dot(normal, frame[1 + term]) * (1.0 / depth)
        for k in range(3):
            _fill_cross(from_camera[k], from_camera[(k + 1) % 3], normal)
            for term in range(3):
                forms[count, k, term] = _dot(normal, frame[1 + term]) * sign
        seen[count], side[count] = one, -sign
        boxes[count, 0], boxes[count, 1], boxes[count, 2], boxes[count, 3] = left, top, right, bottom
        count += 1
    return count


@compiled
def draw(forms: Floats, boxes: Numbers, nearness: Floats, triangle: Numbers) -> None:
    """Draw triangles into an image (height, width) of the nearness 1/t of its hits, and of the triangles' numbers.

    Parameters
    ----------
    forms : array (n, 4, 3)
        Three edge functions and the nearness of each triangle: constants, and changes per column and per row.
    boxes : array (n, 4)
        First column, first row, and the ones after the last.
    """
    for one in range(len(boxes)):
        left, top, right, bottom = boxes[one]
        f = forms[one]
        for row in range(top, bottom):
            y = row + 0.5
            a, b = f[0, 0] + y * f[0, 2], f[1, 0] + y * f[1, 2]
            c, near = f[2, 0] + y * f[2, 2], f[3, 0] + y * f[3, 2]
            for column in range(left, right):
                x = column + 0.5
                if a + x * f[0, 1] >= 0.0 and b + x * f[1, 1] >= 0.0 and c + x * f[2, 1] >= 0.0:
                    value = near + x * f[3, 1]
                    if value > nearness[row, column]:
                        nearness[row, column], triangle[row, column] = value, one


@compiled
def _fill_pixel_box(index: PixelIndex, box: Numbers, found: Numbers) -> None:
    """Box around the pixels whose points may lie in a box (left, top, right, bottom) of the ideal image plane.

    ``found`` is first column, the one after the last, first row and the one after the last.
    """
    level, size = 0, index.cell_px
    # Up to eight cells across.
    while level < len(index.first) - 1 and max(box[2] // size - box[0] // size, box[3] // size - box[1] // size) > 7:
        level, size = level + 1, 2 * size
    found[0] = found[2] = 1 << 40
    found[1] = found[3] = 0
    wide, high, first = index.wide[level], index.high[level], index.first[level]
    for i in range(box[1] // size, min(box[3] // size + 1, high)):
        for j in range(box[0] // size, min(box[2] // size + 1, wide)):
            at = first + i * wide + j
            found[0], found[1] = min(found[0], index.ends[0, at]), max(found[1], index.ends[1, at])
            found[2], found[3] = min(found[2], index.ends[2, at]), max(found[3], index.ends[3, at])


@compiled
def draw_seen(
    forms: Floats,
    boxes: Numbers,
    points: tuple[Floats, Floats],
    index: PixelIndex,
    top: int,
    box: Numbers,
    nearness: Floats,
    triangle: Numbers,
) -> None:
    """Draw triangles as `draw` into the image of a lens that distorts: at the points of its pixels.

    Parameters
    ----------
    boxes : array (n, 4)
        On the ideal image plane.
    points, index, top
        Those of `PixelRays`.
    box : array (4,)
        Room for a box of pixels.
    """
    for one in range(len(boxes)):
        _fill_pixel_box(index, boxes[one], box)
        f = forms[one]
        # Named one by one, they stay in registers.
        a, a_x, a_y, b, b_x, b_y = f[0, 0], f[0, 1], f[0, 2], f[1, 0], f[1, 1], f[1, 2]
        c, c_x, c_y, near, near_x, near_y = f[2, 0], f[2, 1], f[2, 2], f[3, 0], f[3, 1], f[3, 2]
        for row in range(max(box[2] - top, 0), min(box[3] - top, nearness.shape[0])):
            xs, ys = points[0][row + 1], points[1][row + 1]
            for column in range(box[0], box[1]):
                x, y = xs[column + 1], ys[column + 1]
                if (a + y * a_y) + x * a_x >= 0.0 and (b + y * b_y) + x * b_x >= 0.0 and (c + y * c_y) + x * c_x >= 0.0:
                    value = (near + y * near_y) + x * near_x
                    if value > nearness[row, column]:
                        nearness[row, column], triangle[row, column] = value, one


@compiled
def interpolate(
    forms: Floats,
    which: Numbers,
    row: Numbers,
    column: Numbers,
    points: tuple[Floats, Floats],
    t: Floats,
    most_steps: Floats,
    found: Floats,
) -> None:
    """Fill two values at pixels (n,), such as places on a map or in a texture, and their steps along columns and rows.

    Parameters
    ----------
    forms : array (k, 3, 3)
        Of each face, both values times the third line, by constant, column and row.
    which : array (n,)
        Face of each pixel.
    points
        Those of `PixelRays`.
    t : array (height, width)
        Distances along the image's rays.
    most_steps : array (2,)
        Greatest steps along columns and rows of the ideal image, for each unit of ``t``.
    found : array (6, n)
        Both values, their steps along columns, and along rows.
    """
    is_straight = points[0].size == 0
    for one in range(len(which)):
        form, i, j = forms[which[one]], row[one], column[one]
        away = t[i, j]
        x, y = (j + 0.5, i + 0.5) if is_straight else (points[0][i + 1, j + 1], points[1][i + 1, j + 1])
        whole = form[2, 0] + x * form[2, 1] + y * form[2, 2]
        for axis in range(2):
            found[axis, one] = (form[axis, 0] + x * form[axis, 1] + y * form[axis, 2]) / whole
        for term in range(1, 3):
            if is_straight:
                per_u, per_v, per_whole = form[0, term], form[1, term], form[2, term]
                most = most_steps[term - 1] * away
            else:
                x_step, y_step = _step(points[0], i, j, term), _step(points[1], i, j, term)
                per_u, per_v, per_whole = (
                    x_step * form[0, 1] + y_step * form[0, 2],
                    x_step * form[1, 1] + y_step * form[1, 2],
                    x_step * form[2, 1] + y_step * form[2, 2],
                )
                most = away * math.sqrt((x_step * most_steps[0]) ** 2 + (y_step * most_steps[1]) ** 2)
            u = (per_u - found[0, one] * per_whole) / whole
            v = (per_v - found[1, one] * per_whole) / whole
            length = math.sqrt(u * u + v * v)
            share = most / length if length > most else 1.0
            found[2 * term, one], found[2 * term + 1, one] = share * u, share * v


# Not shared with `sampling`: numba keeps a module's code by its own file.
@compiled
def _step(points: Floats, row: int, column: int, term: int) -> float:
    """Change of one coordinate from a pixel to the next along its row, for a term of 1, or down its column."""
    if term == 1:
        step: float = (points[row + 1, column + 2] - points[row + 1, column]) / 2.0
    else:
        step = (points[row + 2, column + 1] - points[row, column + 1]) / 2.0
    return step
