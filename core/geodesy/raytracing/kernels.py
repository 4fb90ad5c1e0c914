"""Rays followed one by one, compiled: the same as `Surface.first_hits` and `image_hits`, many times as fast.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Floats, Numbers
from ...external.compiling import compiled


class HeightBlocks(NamedTuple):
    """Greatest heights in blocks of 2 x 2, 4 x 4, … cells; minus infinity without ground.

    ``flat`` holds the levels one after the other; level i, from 1 on, begins at ``first[i]`` and has ``high[i]`` rows
    and ``wide[i]`` columns. A level of one block is the last.
    """

    flat: Floats
    first: Numbers
    high: Numbers
    wide: Numbers

    @classmethod
    def build(cls, heights_m: Floats) -> HeightBlocks:
        """Build the blocks of heights (rows, columns) at the corners of cells."""
        shapes = [(heights_m.shape[0] - 1, heights_m.shape[1] - 1)]
        while len(shapes) == 1 or max(shapes[-1]) > 1:
            shapes.append((-(-shapes[-1][0] // 2), -(-shapes[-1][1] // 2)))
        high, wide = np.array(shapes, np.int64).T.copy()
        sizes = high * wide
        sizes[0] = 0
        blocks = cls(np.empty(int(sizes.sum()), heights_m.dtype), np.cumsum(sizes) - sizes, high, wide)
        _fill_blocks(heights_m, blocks)
        return blocks


class Rules(NamedTuple):
    """Lowest height of a surface, and the constants of `surface`."""

    lowest_m: float
    touching_m: float
    speeding: float
    slowest: float
    most_steps: int


@compiled
def _fill_blocks(heights: Floats, blocks: HeightBlocks) -> None:
    """Fill in the greatest heights of all blocks."""
    rows, columns = heights.shape
    for level in range(1, len(blocks.first)):
        high, wide, first = blocks.high[level], blocks.wide[level], blocks.first[level]
        for i in range(high):
            for j in range(wide):
                top = -np.inf
                if level == 1:
                    for row in range(2 * i, min(2 * i + 3, rows)):
                        for column in range(2 * j, min(2 * j + 3, columns)):
                            # Comparisons with NaN are false.
                            if heights[row, column] > top:
                                top = heights[row, column]
                else:
                    below, across = blocks.high[level - 1], blocks.wide[level - 1]
                    for row in range(2 * i, min(2 * i + 2, below)):
                        for column in range(2 * j, min(2 * j + 2, across)):
                            top = max(top, blocks.flat[blocks.first[level - 1] + row * across + column])
                blocks.flat[first + i * wide + j] = top


@compiled
def _top(blocks: HeightBlocks, level: int, i: int, j: int) -> float:
    """Greatest height of a block, which may lie beside the surface."""
    if i < 0 or j < 0 or i >= blocks.high[level] or j >= blocks.wide[level]:
        return -np.inf
    top: float = blocks.flat[blocks.first[level] + i * blocks.wide[level] + j]
    return top


@compiled
def _value(factors: Floats, axis: int, t: float) -> float:
    """Polynomial with coefficients (degree, axes) of t, t², … at t."""
    total = 0.0
    for power in range(factors.shape[0] - 1, -1, -1):
        total = (total + factors[power, axis]) * t
    return total


@compiled
def _slope(factors: Floats, axis: int, t: float) -> float:
    """Derivative of `_value` by t."""
    total = 0.0
    for power in range(factors.shape[0] - 1, -1, -1):
        total = total * t + (power + 1) * factors[power, axis]
    return total


@compiled
def _point(start: Floats, c: Floats, t: float) -> tuple[float, float, float]:
    """Column, row and height of a ray at t."""
    return start[0] + _value(c, 0, t), start[1] + _value(c, 1, t), start[2] + _value(c, 2, t)


@compiled
def _leaves(
    rows: int, columns: int, x: float, y: float, per_x: float, per_y: float, wide: float, widens: float
) -> bool:
    """Whether a ray, or a bundle that widens at a rate, lies beside the surface and moves away from it."""
    return (
        (x + wide < 0.0 and per_x + widens <= 0.0)
        or (x - wide > columns and per_x - widens >= 0.0)
        or (y + wide < 0.0 and per_y + widens <= 0.0)
        or (y - wide > rows and per_y - widens >= 0.0)
    )


@compiled
def _highest(blocks: HeightBlocks, level: int, low_x: float, high_x: float, low_y: float, high_y: float) -> float:
    """Greatest height of the blocks that a rectangle touches."""
    size = 1.0 / (1 << level)
    top = -np.inf
    left = math.floor(min(max(low_x * size, 0.0), blocks.wide[level] - 1.0))
    right = math.floor(min(max(high_x * size, 0.0), blocks.wide[level] - 1.0))
    upper = math.floor(min(max(low_y * size, 0.0), blocks.high[level] - 1.0))
    lower = math.floor(min(max(high_y * size, 0.0), blocks.high[level] - 1.0))
    for i in range(int(upper), int(lower) + 1):
        for j in range(int(left), int(right) + 1):
            top = max(top, blocks.flat[blocks.first[level] + i * blocks.wide[level] + j])
    return top


@compiled
def _clear(
    blocks: HeightBlocks, rules: Rules, start: Floats, c: Floats, spread: Floats, t: float, end: float, level: int
) -> float:
    """Follow a bundle while it certainly hits nothing: t from which on it may hit something; infinite if it does not.

    ``c`` is the middle ray; ``spread`` (degree, 2) are the largest distances of others from it, see `Surface.clear`.
    """
    rows, columns = blocks.high[0], blocks.wide[0]
    top_level = len(blocks.first) - 1
    while level < top_level and float(1 << level) < 4.0 * _value(spread, 0, t):
        level += 1
    bulge = abs(c[1, 2]) if c.shape[0] > 1 else 0.0
    for count in range(rules.most_steps):
        x, y, h = _point(start, c, t)
        per_x, per_y = _slope(c, 0, t), _slope(c, 1, t)
        size = float(1 << level)
        wide, widens = _value(spread, 0, t), _slope(spread, 0, t)
        # Blocks that are not much wider than the bundle allow only tiny steps.
        roomy = wide <= 0.5 * size
        per_t = rules.speeding * max(max(abs(per_x), abs(per_y)) + widens, rules.slowest)
        step = (size - wide) / per_t if roomy else 0.0
        ahead = min(t + step, end)
        deep = _value(spread, 1, ahead)
        # No ray of the bundle leaves this rectangle.
        reach = wide + (rules.speeding - 1.0) * size + rules.speeding * widens * (ahead - t)
        to_x, to_y = x + per_x * (ahead - t), y + per_y * (ahead - t)
        top = _highest(
            blocks, level, min(x, to_x) - reach, max(x, to_x) + reach, min(y, to_y) - reach, max(y, to_y) + reach
        )
        over = h - deep - bulge * (ahead - t) ** 2 - top
        fall = h - (start[2] + _value(c, 2, ahead))
        free = roomy and over > max(fall, 0.0)
        stuck = not free and (level <= 1 or not roomy)
        gone = not stuck and (
            (ahead >= end and free)
            or _leaves(rows, columns, x, y, per_x, per_y, wide, widens)
            # Rays may begin below the surface.
            or (count > 0 and h + deep < rules.lowest_m - rules.touching_m)
        )
        if free:
            t, level = ahead, min(level + 1, top_level)
        else:
            if roomy and over > 0.0:
                t += over / fall * (ahead - t)
            level = max(level - 1, 1)
        if stuck:
            return t
        if gone:
            return np.inf
    return t


@compiled
def _cell(position: float, speed: float) -> int:
    """Index of the cell that a ray is in along one axis: the one before it, where it moves down from an edge."""
    cell = math.floor(position)
    return cell - 1 if speed < 0.0 and position == cell else cell


@compiled
def _within(position: float, block: int, level: int) -> int:
    """Index of the cell at a position along one axis, within a block."""
    return min(max(math.floor(position), block << level), ((block + 1) << level) - 1)


@compiled
def _is_ground(heights: Floats, i: int, j: int) -> bool:
    """Whether a cell lies on the surface and has ground."""
    if i < 0 or j < 0 or i >= heights.shape[0] - 1 or j >= heights.shape[1] - 1:
        return False
    return not math.isnan(heights[i, j] + heights[i, j + 1] + heights[i + 1, j] + heights[i + 1, j + 1])


@compiled
def _share_of_cell(
    heights: Floats,
    i: int,
    j: int,
    i_before: int,
    j_before: int,
    touching_m: float,
    x: float,
    y: float,
    h: float,
    x_next: float,
    y_next: float,
    h_next: float,
) -> float:
    """Share of a chord through a cell at which it reaches the surface from above; see `surface.first_share`.

    Infinite if the chord stays above, NaN if it comes from beneath: it begins below the surface, and the cell before
    has no ground. Positions count from the cell's upper left corner.
    """
    if i < 0 or j < 0 or i >= heights.shape[0] - 1 or j >= heights.shape[1] - 1:
        return np.inf
    a, at_right = float(heights[i, j]), float(heights[i, j + 1])
    below, across = float(heights[i + 1, j]), float(heights[i + 1, j + 1])
    if math.isnan(a + at_right + below + across) or min(h, h_next) > max(a, at_right, below, across):
        return np.inf
    b, c = at_right - a, below - a
    d = across - below - b
    x, y = min(max(x, 0.0), 1.0), min(max(y, 0.0), 1.0)
    dx, dy = min(max(x_next, 0.0), 1.0) - x, min(max(y_next, 0.0), 1.0) - y
    above = h - (a + b * x + c * y + d * x * y)
    if above <= 0.0:
        return np.nan if above < -touching_m and not _is_ground(heights, i_before, j_before) else 0.0
    rising = b * dx + c * dy + d * (x * dy + y * dx) - (h_next - h)
    bend = d * dx * dy
    root = math.sqrt(rising * rising + 4.0 * bend * above)
    share = 2.0 * above / (rising + root) if rising >= 0.0 or bend <= 0.0 else (root - rising) / (2.0 * bend)
    return share if share >= 0.0 else np.inf


@compiled
def _per_cell(per_t: float) -> float:
    """Way of a ray, in t, through a cell along one axis; infinite for a ray that does not move along it."""
    return 1.0 / per_t if per_t != 0.0 else np.inf


@compiled
def _way(position: float, per_cell: float, block: int, level: int) -> float:
    """Way of a ray, in t, to the edge of a block along one axis."""
    if per_cell == np.inf:
        return np.inf
    return (float((block + (1 if per_cell > 0.0 else 0)) << level) - position) * per_cell


@compiled
def _chord(
    start: Floats, c: Floats, t: float, longest: float, end: float
) -> tuple[float, float, float, float, float, float, float]:
    """Column, row and height of a ray at t, and where its chord from there ends: see `_search`; its rates per t."""
    x, y, h = _point(start, c, t)
    last = min((math.sqrt(t) + longest) ** 2, end)
    if last < end:
        per_x, per_y = _slope(c, 0, t), _slope(c, 1, t)
        to_x = _way(x, _per_cell(per_x), _cell(x, per_x), 0)
        to_y = _way(y, _per_cell(per_y), _cell(y, per_y), 0)
        last = min(max(last, t + min(to_x, to_y)), end)
    # Over shorter ways, differences of positions are rounding.
    if last - t <= 1e-6 * last:
        return x, y, h, last, _slope(c, 0, t), _slope(c, 1, t), _slope(c, 2, t)
    per_t = 1.0 / (last - t)
    x_last, y_last, h_last = _point(start, c, last)
    return x, y, h, last, (x_last - x) * per_t, (y_last - y) * per_t, (h_last - h) * per_t


@compiled
def _search(
    heights: Floats,
    blocks: HeightBlocks,
    rules: Rules,
    start: Floats,
    c: Floats,
    longest: float,
    t: float,
    end: float,
    level: int,
) -> tuple[float, float, float]:
    """t, column and row of the first hit of a ray.

    The ray is cut into chords, each from t to (√t + ``longest``)², or through a cell if that is farther. A chord passes
    blocks that lie below it, the larger the farther it is above them, and looks into the others.
    """
    rows, columns, top_level = heights.shape[0] - 1, heights.shape[1] - 1, len(blocks.first) - 1
    nothing = np.nan, np.nan, np.nan
    x, y, h, last, per_x, per_y, per_h = _chord(start, c, t, longest, end)
    i, j, across, down = _cell(y, per_y), _cell(x, per_x), _per_cell(per_x), _per_cell(per_y)
    # The cell before, as if it had no ground.
    i_before, j_before = -1, -1
    for _ in range(rules.most_steps):
        block_i, block_j = i >> level, j >> level
        to_x, to_y = _way(x, across, block_j, level), _way(y, down, block_i, level)
        step = max(min(to_x, to_y), 0.0)
        leaves = t + step <= last
        if not leaves:
            step = last - t
        x_next, y_next, h_next = x + step * per_x, y + step * per_y, h + step * per_h
        if level > 0:
            top = _top(blocks, level, block_i, block_j)
            if min(h, h_next) <= top:
                if h > top:
                    # Nothing is hit before the ray is as low as the block's top.
                    step = (h - top) / -per_h
                    t, x, y, h = t + step, x + step * per_x, y + step * per_y, top
                    i, j = _within(y, block_i, level), _within(x, block_j, level)
                level -= 1
                continue
        else:
            share = _share_of_cell(
                heights, i, j, i_before, j_before, rules.touching_m, x - j, y - i, h, x_next - j, y_next - i, h_next
            )
            if share <= 1.0:
                x, y = x + share * (x_next - x), y + share * (y_next - y)
                # Rounding may put hits on the outermost edge of the surface beyond it.
                return t + share * step, min(max(x, 0.0), columns), min(max(y, 0.0), rows)
            # Rays from beneath the ground have no share.
            if math.isnan(share):
                return nothing
        t, x, y, h = t + step if leaves else last, x_next, y_next, h_next
        if t >= end or h < rules.lowest_m - rules.touching_m or _leaves(rows, columns, x, y, per_x, per_y, 0.0, 0.0):
            return nothing
        i, j = _within(y, block_i, level), _within(x, block_j, level)
        if leaves:
            is_across, right, lower = to_x <= to_y, 1 if per_x > 0.0 else 0, 1 if per_y > 0.0 else 0
            j_before = ((block_j + right) << level) - right if is_across else j
            i_before = i if is_across else ((block_i + lower) << level) - lower
            j = j_before + (2 * right - 1 if is_across else 0)
            i = i_before + (0 if is_across else 2 * lower - 1)
            # A larger block begins where the ray leaves the one around it.
            above = level + 1
            rises = i >> above != block_i >> 1 or j >> above != block_j >> 1
            level = min(above, top_level) if rises else level
        else:
            i_before, j_before = i, j
        if t >= last:
            x, y, h, last, per_x, per_y, per_h = _chord(start, c, t, longest, end)
            across, down = _per_cell(per_x), _per_cell(per_y)
    return nothing


@compiled
def search(
    heights: Floats,
    blocks: HeightBlocks,
    rules: Rules,
    start: Floats,
    c: Floats,
    longest: Floats,
    farthest: Floats,
    found: Floats,
) -> None:
    """`Surface.first_hits`: fills in t, column and row of the first hits, (3, n)."""
    # Rays from one point have one start.
    each = 1 if start.shape[1] > 1 else 0
    level = len(blocks.first) - 1
    for ray in range(len(farthest)):
        hit = _search(
            heights, blocks, rules, start[:, each * ray], c[:, :, ray], longest[ray], 0.0, farthest[ray], level
        )
        found[0, ray], found[1, ray], found[2, ray] = hit


@compiled
def _fill_lines(forms: Floats, y_px: float, lines: Floats) -> None:
    """Fill in the coefficients of a row's paths by powers of x: (degree, 3, k)."""
    for power in range(len(forms)):
        for axis in range(3):
            for k in range(power + 2):
                total = 0.0
                for m in range(power + 1, -1, -1):
                    total = total * y_px + forms[power, axis, m, k]
                lines[power, axis, k] = total


@compiled
def _fill_ray(lines: Floats, x_px: float, c: Floats) -> None:
    """Fill in the coefficients (degree, 3) of a pixel's path."""
    for power in range(len(lines)):
        for axis in range(3):
            total = 0.0
            for k in range(power + 1, -1, -1):
                total = total * x_px + lines[power, axis, k]
            c[power, axis] = total


class Scratch(NamedTuple):
    """Room for coefficients: of a row of pixels (degree, 3, k), of two rays (degree, 3), and a spread (degree, 2)."""

    lines: Floats
    c: Floats
    corner: Floats
    spread: Floats

    @classmethod
    def blank(cls, degree: int) -> Scratch:
        """Make room for paths of a degree."""
        c, corner = np.empty((2, degree, 3))
        return cls(np.empty((degree, 3, degree + 1)), c, corner, np.empty((degree, 2)))


@compiled
def _fill_bundle(forms: Floats, left: float, top: float, right: float, bottom: float, scratch: Scratch) -> None:
    """Fill in the middle ray of a bundle of pixels, and the spread of the others around it."""
    lines, c, corner, spread = scratch
    _fill_lines(forms, 0.5 * (top + bottom), lines)
    _fill_ray(lines, 0.5 * (left + right), c)
    spread[:] = 0.0
    for y in (top, bottom):
        _fill_lines(forms, y, lines)
        for x in (left, right):
            _fill_ray(lines, x, corner)
            for power in range(len(forms)):
                # 0.1 % more for rays between the corners of a bundle.
                across, down, deep = (
                    1.001 * abs(corner[power, 0] - c[power, 0]),
                    1.001 * abs(corner[power, 1] - c[power, 1]),
                    1.001 * abs(corner[power, 2] - c[power, 2]),
                )
                spread[power, 0] = max(spread[power, 0], across, down)
                spread[power, 1] = max(spread[power, 1], deep)


@compiled
def _fill_point(forms: Floats, x_px: float, y_px: float, c: Floats) -> None:
    """Fill in the coefficients (degree, 3) of the path through any point; terms above a form's degree are zero."""
    for power in range(len(forms)):
        for axis in range(3):
            total = 0.0
            for k in range(power + 1, -1, -1):
                part = 0.0
                for m in range(power + 1 - k, -1, -1):
                    part = part * y_px + forms[power, axis, m, k]
                total = total * x_px + part
            c[power, axis] = total


@compiled
def _extent(points: Floats, top: int, bottom: int, left: int, right: int) -> tuple[float, float]:
    """Least and greatest coordinate of the points of pixels in a box; see `DistortedRays`."""
    least, greatest = np.inf, -np.inf
    for row in range(top + 1, bottom + 1):
        for column in range(left + 1, right + 1):
            least, greatest = min(least, points[row, column]), max(greatest, points[row, column])
    return least, greatest


@compiled
def _fill_pixels(
    forms: Floats, points: tuple[Floats, Floats], box: tuple[int, int, int, int], scratch: Scratch
) -> None:
    """Fill in the middle ray of the pixels in a box (top, bottom, left, right), and the spread of the others."""
    top, bottom, left, right = box
    if points[0].size:
        low_x, high_x = _extent(points[0], top, bottom, left, right)
        low_y, high_y = _extent(points[1], top, bottom, left, right)
        _fill_bundle(forms, low_x, low_y, high_x, high_y, scratch)
    else:
        _fill_bundle(forms, left, top, right, bottom, scratch)


@compiled
def _least(values: Floats, top: int, bottom: int, left: int, right: int) -> float:
    """Least value in a box."""
    least = np.inf
    for row in range(top, bottom):
        for column in range(left, right):
            least = min(least, values[row, column])
    return least


@compiled
def _begins_below(heights: Floats, start: Floats, c: Floats, t: float) -> tuple[bool, float, float]:
    """Whether a ray is below the surface at t; its column and row there."""
    x, y, h = _point(start, c, t)
    rows, columns = heights.shape[0] - 1, heights.shape[1] - 1
    if not (0.0 <= x <= columns and 0.0 <= y <= rows):
        return False, x, y
    i, j = min(int(y), rows - 1), min(int(x), columns - 1)
    a, at_right = float(heights[i, j]), float(heights[i, j + 1])
    below, across = float(heights[i + 1, j]), float(heights[i + 1, j + 1])
    twist = (across - below) - (at_right - a)
    ground = a + (at_right - a) * (x - j) + (below - a) * (y - i) + twist * (x - j) * (y - i)
    return ground >= h, x, y


@compiled
def image_hits(
    heights: Floats,
    blocks: HeightBlocks,
    rules: Rules,
    start: Floats,
    forms: Floats,
    points: tuple[Floats, Floats],
    longest: float,
    spans: tuple[Floats, Floats],
    farthest: float,
    begins: bool,
    sides: tuple[int, int],
    scratch: Scratch,
    found: Floats,
) -> None:
    """Fill in t, column and row of the first hits of an image's pixels, (3, height, width).

    ``forms`` (degree, 3, k, k) and ``points`` are those of `PixelRays`; ``sides`` are those of bundles, px. See
    `Surface.image_hits` for the rest.
    """
    height, width = spans[0].shape
    large, small = sides
    top_level = len(blocks.first) - 1
    for top in range(0, height, large):
        for left in range(0, width, large):
            bottom, right = min(top + large, height), min(left + large, width)
            least = _least(spans[0], top, bottom, left, right)
            if least > farthest:
                continue
            _fill_pixels(forms, points, (top, bottom, left, right), scratch)
            t_large = _clear(blocks, rules, start, scratch.c, scratch.spread, least, farthest, top_level)
            if t_large == np.inf:
                continue
            for upper in range(top, bottom, small):
                for first in range(left, right, small):
                    _search_bundle(
                        heights, blocks, rules, start, forms, points, longest, spans, farthest, begins, t_large,
                        (upper, min(upper + small, bottom), first, min(first + small, right)), scratch, found,
                    )  # fmt: skip


@compiled
def _search_bundle(
    heights: Floats,
    blocks: HeightBlocks,
    rules: Rules,
    start: Floats,
    forms: Floats,
    points: tuple[Floats, Floats],
    longest: float,
    spans: tuple[Floats, Floats],
    farthest: float,
    begins: bool,
    t_large: float,
    box: tuple[int, int, int, int],
    scratch: Scratch,
    found: Floats,
) -> None:
    """Fill in the hits of a small bundle of pixels, of a large one that hits nothing before ``t_large``."""
    top, bottom, left, right = box
    after, until = spans
    least = _least(after, top, bottom, left, right)
    if least > farthest:
        return
    top_level = len(blocks.first) - 1
    level, t_begin = (min(2, top_level), t_large) if t_large >= least else (top_level, least)
    _fill_pixels(forms, points, box, scratch)
    t_small = _clear(blocks, rules, start, scratch.c, scratch.spread, t_begin, farthest, level)
    if t_small == np.inf:
        return
    is_straight = points[0].size == 0
    for row in range(top, bottom):
        if is_straight:
            _fill_lines(forms, row + 0.5, scratch.lines)
        for column in range(left, right):
            t, end = max(t_small, after[row, column]), until[row, column]
            if t > end:
                continue
            if is_straight:
                _fill_ray(scratch.lines, column + 0.5, scratch.c)
            else:
                _fill_point(forms, points[0][row + 1, column + 1], points[1][row + 1, column + 1], scratch.c)
            if begins and t == after[row, column]:
                is_below, x, y = _begins_below(heights, start, scratch.c, t)
                if is_below:
                    found[0, row, column], found[1, row, column], found[2, row, column] = t, x, y
                    continue
            hit = _search(heights, blocks, rules, start, scratch.c, longest, t, end, min(1, top_level))
            found[0, row, column], found[1, row, column], found[2, row, column] = hit
