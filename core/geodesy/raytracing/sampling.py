"""Samples of the pixels that see a surface, compiled: the same as the rest of `seen.Seen.samples`, many times as fast.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Floats, Numbers
from ...external.compiling import compiled


class SeenPixels(NamedTuple):
    """Pixels (n,) to be sampled, filled by kernels.

    Attributes
    ----------
    row, column : array of int
    x, y : array
        Position on the surface, in its columns and rows, then in the source's plane, as world fractions.
    steps : array (n, 4)
        From a pixel to the next along the image's rows, then down its columns: eastward and northward, in metres, then
        along x and y.
    """

    row: Numbers
    column: Numbers
    x: Floats
    y: Floats
    steps: Floats

    @classmethod
    def blank(cls, count: int) -> SeenPixels:
        """Make room for pixels."""
        (row, column), (x, y) = np.empty((2, count), np.int64), np.empty((2, count))
        return cls(row, column, x, y, np.empty((count, 4)))

    def first(self, count: int) -> SeenPixels:
        """First pixels."""
        return SeenPixels._make(part[:count] for part in self)


# Not shared with `kernels`: numba keeps a module's code by its own file, and would not see the other's change.
@compiled
def _ground(heights: Floats, column: float, row: float) -> tuple[float, float, float]:
    """Height at a column and row within the surface, and its rise per cell along rows and along columns."""
    j = min(max(int(column), 0), heights.shape[1] - 2)
    i = min(max(int(row), 0), heights.shape[0] - 2)
    x, y = column - j, row - i
    a, below = float(heights[i, j]), float(heights[i + 1, j])
    b, c = float(heights[i, j + 1]) - a, below - a
    d = (float(heights[i + 1, j + 1]) - below) - b
    return a + b * x + c * y + d * x * y, b + d * y, c + d * x


@compiled
def _slopes(per: Floats, across: float, down: float) -> tuple[float, float]:
    """Slopes eastward and northward, metres per metre."""
    return across * per[0, 0] + down * per[1, 0], across * per[0, 1] + down * per[1, 1]


@compiled
def _face_end(
    heights: Floats, per: Floats, column: float, row: float, sign: float, steep: float
) -> tuple[float, float, float]:
    """Column, row and height of the end of a steep face: see `Seen.follow_faces`."""
    _, across, down = _ground(heights, column, row)
    length = max(math.sqrt(across * across + down * down), 1e-12)
    x, y = column, row
    for _ in range(2 * 6):
        x = min(max(x + sign * 0.5 * across / length, 0.0), heights.shape[1] - 1.0)
        y = min(max(y + sign * 0.5 * down / length, 0.0), heights.shape[0] - 1.0)
        _, new_across, new_down = _ground(heights, x, y)
        east, north = _slopes(per, new_across, new_down)
        if not east * east + north * north > steep * steep:
            break
    return x, y, _ground(heights, x, y)[0]


@compiled
def _face_edge(heights: Floats, per: Floats, column: float, row: float, steep: float) -> tuple[float, float]:
    """Upper or lower end of a steep face, whichever is nearer in height: see `Seen.face_edges`."""
    height = _ground(heights, column, row)[0]
    upper_x, upper_y, upper = _face_end(heights, per, column, row, 1.0, steep)
    lower_x, lower_y, lower = _face_end(heights, per, column, row, -1.0, steep)
    if abs(upper - height) <= abs(lower - height):
        return upper_x, upper_y
    return lower_x, lower_y


@compiled
def _has_ground(heights: Floats, per: Floats, column: float, row: float, steps: Floats) -> bool:
    """Whether a point has ground all around: see `Seen.has_ground_around`."""
    wide = 2.0 * (abs(per[0, 0] * steps[0] + per[0, 1] * steps[1]) + abs(per[0, 0] * steps[2] + per[0, 1] * steps[3]))
    high = 2.0 * (abs(per[1, 0] * steps[0] + per[1, 1] * steps[1]) + abs(per[1, 0] * steps[2] + per[1, 1] * steps[3]))
    for corner in range(4):
        x = column + (wide if corner % 2 else -wide)
        y = row + (high if corner // 2 else -high)
        x, y = min(max(x, 0.0), heights.shape[1] - 1.0), min(max(y, 0.0), heights.shape[0] - 1.0)
        if not math.isfinite(_ground(heights, x, y)[0]):
            return False
    return True


@compiled
def _step(points: Floats, row: int, column: int, axis: int) -> float:
    """Change of one coordinate from a pixel to the next along its row, or down its column: see `PixelRays`."""
    if axis == 0:
        step: float = (points[row + 1, column + 2] - points[row + 1, column]) / 2.0
    else:
        step = (points[row + 2, column + 1] - points[row, column + 1]) / 2.0
    return step


@compiled
def seen_pixels(
    heights: Floats,
    has_holes: bool,
    hit_t: Floats,
    hit_column: Floats,
    hit_row: Floats,
    rays: Floats,
    points: tuple[Floats, Floats],
    per: Floats,
    steep: float,
    pixels: SeenPixels,
) -> tuple[int, int]:
    """Fill in the pixels that see a surface; return their number, and that of all that see steep faces.

    Hits are (height, width); ``rays`` (3, 3) and ``points`` are those of `PixelRays`.
    """
    count, faces, is_straight = 0, 0, points[0].size == 0
    x_px, y_px, x_step, y_step = 0.0, 0.0, 0.0, 0.0
    for row in range(hit_t.shape[0]):
        for column in range(hit_t.shape[1]):
            t = hit_t[row, column]
            if not math.isfinite(t):
                continue
            x, y = hit_column[row, column], hit_row[row, column]
            _, across, down = _ground(heights, x, y)
            slope_east, slope_north = _slopes(per, across, down)
            is_steep = slope_east * slope_east + slope_north * slope_north > steep * steep
            if is_straight:
                x_px, y_px = column + 0.5, row + 0.5
            else:
                x_px, y_px = points[0][row + 1, column + 1], points[1][row + 1, column + 1]
            east, north, up = (
                rays[0, 0] + x_px * rays[1, 0] + y_px * rays[2, 0],
                rays[0, 1] + x_px * rays[1, 1] + y_px * rays[2, 1],
                rays[0, 2] + x_px * rays[1, 2] + y_px * rays[2, 2],
            )
            facing = min(up - slope_east * east - slope_north * north, -0.02 * abs(up) - 1e-12)
            for axis in range(2):
                per_east, per_north, per_up = rays[1 + axis, 0], rays[1 + axis, 1], rays[1 + axis, 2]
                if not is_straight:
                    x_step, y_step = _step(points[0], row, column, axis), _step(points[1], row, column, axis)
                    per_east, per_north, per_up = (
                        x_step * rays[1, 0] + y_step * rays[2, 0],
                        x_step * rays[1, 1] + y_step * rays[2, 1],
                        x_step * rays[1, 2] + y_step * rays[2, 2],
                    )
                ahead = 0.0 if is_steep else (per_up - slope_east * per_east - slope_north * per_north) / facing
                pixels.steps[count, 2 * axis] = t * (per_east - ahead * east)
                pixels.steps[count, 2 * axis + 1] = t * (per_north - ahead * north)
            if is_steep:
                faces += 1
                x, y = _face_edge(heights, per, x, y, steep)
            if has_holes and not _has_ground(heights, per, x, y, pixels.steps[count]):
                continue
            pixels.row[count], pixels.column[count], pixels.x[count], pixels.y[count] = row, column, x, y
            count += 1
    return count, faces


@compiled
def _power(value: float, power: int, low: float) -> tuple[int, float]:
    """Exponent of the least power of two above a value, and that power's half; those of a value before, if they fit."""
    if low <= value < 2.0 * low:
        return power, low
    _, power = math.frexp(value)
    return power, math.ldexp(0.5, power)


@compiled
def _power_along(power: int, zoom: int, is_exact: bool, most_power: int) -> int:
    """Binary logarithm of the samples of a pixel along one axis: see `view.pixel_detail`."""
    return min(max(power + zoom - (1 if is_exact else 0), 0), most_power)


@compiled
def detail(
    pixels: SeenPixels,
    middle: Floats,
    half: Floats,
    factors: Floats,
    turn: Floats,
    world: float,
    zooms: tuple[int, int],
    nearest_px: float,
    most_power: int,
    kind_bits: int,
    kinds: Numbers,
) -> None:
    """Move pixels from a surface to a source's plane, and fill in the kind of each: see `view.Detail`.

    ``nearest_px, most_power`` are the constants of `view`, and ``kind_bits`` those of `view.Detail.kinds`.
    """
    degrees, tiny, finest_px = factors.shape[1], 2.2250738585072014e-308, 0.5**most_power
    # Neighbours have the same powers of two as a rule.
    power, low, power_x, low_x, power_y, low_y = 0, 0.0, 0, 0.0, 0, 0.0
    for pixel in range(len(kinds)):
        x, y = (pixels.x[pixel] - middle[0]) / half[0], (pixels.y[pixel] - middle[1]) / half[1]
        u, v = 0.0, 0.0
        for k in range(degrees - 1, -1, -1):
            u_k, v_k = 0.0, 0.0
            for i in range(degrees - 1, -1, -1):
                u_k, v_k = u_k * x + factors[0, i, k], v_k * x + factors[1, i, k]
            u, v = u * y + u_k, v * y + v_k
        pixels.x[pixel], pixels.y[pixel] = u, v
        for axis in range(2):
            east, north = pixels.steps[pixel, 2 * axis], pixels.steps[pixel, 2 * axis + 1]
            pixels.steps[pixel, 2 * axis] = turn[0, 0] * east + turn[0, 1] * north
            pixels.steps[pixel, 2 * axis + 1] = turn[1, 0] * east + turn[1, 1] * north
        across, down = pixels.steps[pixel, 0], pixels.steps[pixel, 1]
        per_x = math.sqrt(across * across + down * down)
        across, down = pixels.steps[pixel, 2], pixels.steps[pixel, 3]
        per_y = math.sqrt(across * across + down * down)
        finest = max(max(min(per_x, per_y), max(per_x, per_y) * finest_px) * world, tiny)
        power, low = _power(nearest_px / finest, power, low)
        zoom = min(max(power - 1, zooms[0]), zooms[1])
        per_x, per_y = per_x * (world / nearest_px), per_y * (world / nearest_px)
        power_x, low_x = _power(per_x, power_x, low_x)
        power_y, low_y = _power(per_y, power_y, low_y)
        log_x = _power_along(power_x, zoom, per_x == low_x, most_power)
        log_y = _power_along(power_y, zoom, per_y == low_y, most_power)
        kinds[pixel] = (((zoom << kind_bits) + (1 << log_x)) << kind_bits) + (1 << log_y)


@compiled
def spread_samples(
    pixels: SeenPixels,
    kinds: Numbers,
    samples_x: Numbers,
    samples_y: Numbers,
    next_pixel: Numbers,
    next_sample: Numbers,
    row: Numbers,
    column: Numbers,
    du: Floats,
    v: Floats,
) -> None:
    """Sort pixels by kind, and spread samples evenly over each.

    ``samples_x, samples_y`` are, by kind, the samples of its pixels, and ``next_pixel, next_sample`` are where its
    pixels and samples begin; they are moved on.
    """
    for pixel in range(len(kinds)):
        kind = kinds[pixel]
        wide, high = samples_x[kind], samples_y[kind]
        at = next_pixel[kind]
        next_pixel[kind] = at + 1
        row[at], column[at] = pixels.row[pixel], pixels.column[pixel]
        at = next_sample[kind]
        next_sample[kind] = at + wide * high
        for below in range(high):
            off_y = (below + 0.5) / high - 0.5
            for beside in range(wide):
                off_x = (beside + 0.5) / wide - 0.5
                du[at] = pixels.x[pixel] + pixels.steps[pixel, 0] * off_x + pixels.steps[pixel, 2] * off_y
                v[at] = pixels.y[pixel] + pixels.steps[pixel, 1] * off_x + pixels.steps[pixel, 3] * off_y
                at += 1
