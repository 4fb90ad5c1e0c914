"""Rays followed one by one, compiled: the same as `Surface.clear` and `Surface.search_cells`, several times as fast.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Flags, Floats
from ...external.compiling import compiled
from .pyramid import Pyramid


class Rules(NamedTuple):
    """Lowest height of a surface, and the constants of `surface`."""

    lowest_m: float
    touching_m: float
    speeding: float
    slowest: float
    most_steps: int


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
def _clear(
    heights: Floats,
    tops: Pyramid,
    rules: Rules,
    start: Floats,
    c: Floats,
    spread: Floats,
    t: float,
    end: float,
    level: int,
    least_level: int,
) -> tuple[float, bool]:
    """Follow a ray or a bundle while it certainly hits nothing: t, and whether it may hit something from there on."""
    rows, columns = heights.shape[0] - 1, heights.shape[1] - 1
    is_bundle = spread.shape[0] > 0
    bulge = abs(c[1, 2]) if c.shape[0] > 1 else 0.0
    wide, widens, deep = 0.0, 0.0, 0.0
    for _ in range(rules.most_steps):
        x, y, h = _point(start, c, t)
        per_x, per_y = _slope(c, 0, t), _slope(c, 1, t)
        size = float(1 << level)
        per_t = max(abs(per_x), abs(per_y))
        if is_bundle:
            wide, widens = _value(spread, 0, t), _slope(spread, 0, t)
            per_t += widens
        roomy = wide <= 0.5 * size
        step = (size - wide) / (rules.speeding * max(per_t, rules.slowest)) if roomy else 0.0
        ahead = min(t + step, end)
        if is_bundle:
            deep = _value(spread, 1, ahead)
        j = min(max(math.floor(x / size), -1.0), tops.wide[level])
        i = min(max(math.floor(y / size), -1.0), tops.high[level])
        top = tops.flat[int(tops.first[level] + (i + 1.0) * (tops.wide[level] + 2) + (j + 1.0))]
        over = h - deep - bulge * (ahead - t) ** 2 - top
        fall = h - (start[2] + _value(c, 2, ahead))
        free = roomy and over > max(fall, 0.0)
        stuck = not free and (level <= least_level or not roomy)
        gone = not stuck and (
            (ahead >= end and free)
            or _leaves(rows, columns, x, y, per_x, per_y, wide, widens)
            or h + deep < rules.lowest_m - rules.touching_m
        )
        if free:
            t, level = ahead, min(level + 1, len(tops.first) - 1)
        else:
            if roomy and over > 0.0:
                t += over / fall * (ahead - t)
            level = max(level - 1, least_level)
        if stuck or gone:
            return t, stuck
    return t, True


@compiled
def clear(
    heights: Floats,
    tops: Pyramid,
    rules: Rules,
    start: Floats,
    c: Floats,
    spread: Floats,
    after: Floats,
    farthest: Floats,
    least_level: int,
    t_found: Floats,
    may_hit: Flags,
) -> None:
    """`Surface.clear` of rays, or of bundles where ``spread`` has coefficients; fills ``t_found`` and ``may_hit``."""
    top_level = len(tops.first) - 1
    # Rays from one point have one start.
    each = 1 if start.shape[1] > 1 else 0
    for ray in range(len(after)):
        if after[ray] <= farthest[ray]:
            # Single rays, and bundles that have been followed as parts of larger ones, start near the ground.
            level = top_level if after[ray] == 0.0 else min(2, top_level)
            if spread.shape[0] > 0:
                while level < top_level and float(1 << level) < 4.0 * _value(spread[:, :, ray], 0, after[ray]):
                    level += 1
            t_found[ray], may_hit[ray] = _clear(
                heights,
                tops,
                rules,
                start[:, each * ray],
                c[:, :, ray],
                spread[:, :, ray if spread.shape[0] > 0 else 0],
                after[ray],
                farthest[ray],
                level,
                least_level,
            )


@compiled
def _cell(position: float, speed: float) -> int:
    """Index of the cell that a ray is in along one axis: the one before it, where it moves down from an edge."""
    cell = math.floor(position)
    return cell - 1 if speed < 0.0 and position == cell else cell


@compiled
def _first_share(
    a: float,
    b: float,
    c: float,
    d: float,
    over: bool,
    touching_m: float,
    x: float,
    y: float,
    h: float,
    x_next: float,
    y_next: float,
    h_next: float,
) -> float:
    """Share of a chord through a cell at which it reaches the surface from above; see `surface.first_share`."""
    dx, dy = x_next - x, y_next - y
    above = h - (a + b * x + c * y + d * x * y)
    if above < -touching_m and not over:
        return np.nan
    if above <= 0.0:
        return 0.0
    rising = b * dx + c * dy + d * (x * dy + y * dx) - (h_next - h)
    bend = d * dx * dy
    root = math.sqrt(rising * rising + 4.0 * bend * above)
    share = 2.0 * above / (rising + root) if rising >= 0.0 or bend <= 0.0 else (root - rising) / (2.0 * bend)
    return share if share >= 0.0 else np.inf


@compiled
def _ways(x: float, y: float, per_x: float, per_y: float, i: int, j: int) -> tuple[float, float]:
    """Ways of a ray, in t, to a cell's edge, along columns and along rows."""
    to_x = (j + (1 if per_x > 0.0 else 0) - x) / per_x if per_x != 0.0 else np.inf
    to_y = (i + (1 if per_y > 0.0 else 0) - y) / per_y if per_y != 0.0 else np.inf
    return to_x, to_y


@compiled
def _share_of_cell(
    heights: Floats,
    i: int,
    j: int,
    over: bool,
    touching_m: float,
    x: float,
    y: float,
    h: float,
    x_next: float,
    y_next: float,
    h_next: float,
) -> tuple[float, bool]:
    """Share of a chord through a cell at which it reaches the ground, see `_first_share`; whether the cell has ground.

    Positions count from the cell's upper left corner.
    """
    a, at_right, below, across = heights[i, j], heights[i, j + 1], heights[i + 1, j], heights[i + 1, j + 1]
    if math.isnan(a + at_right + below + across):
        return np.inf, False
    if min(h, h_next) > max(a, at_right, below, across):
        return np.inf, True
    b, down = at_right - a, below - a
    x, y = min(max(x, 0.0), 1.0), min(max(y, 0.0), 1.0)
    x_next, y_next = min(max(x_next, 0.0), 1.0), min(max(y_next, 0.0), 1.0)
    return _first_share(a, b, down, across - below - b, over, touching_m, x, y, h, x_next, y_next, h_next), True


@compiled
def _chord(start: Floats, c: Floats, t: float, last: float) -> tuple[float, float, float]:
    """Change of column, row and height per t from t to ``last``."""
    # Over shorter ways, differences of positions are rounding.
    if last - t <= 1e-6 * last:
        return _slope(c, 0, t), _slope(c, 1, t), _slope(c, 2, t)
    (x, y, h), (x_last, y_last, h_last) = _point(start, c, t), _point(start, c, last)
    return (x_last - x) / (last - t), (y_last - y) / (last - t), (h_last - h) / (last - t)


@compiled
def _search(
    heights: Floats,
    tops: Pyramid,
    rules: Rules,
    start: Floats,
    c: Floats,
    longest: float,
    none: Floats,
    t: float,
    end: float,
) -> tuple[float, float, float]:
    """t, column and row of the first hit of a ray.

    The ray is cut into chords, each from t to (√t + ``longest``)², or through a cell if that is farther. ``none`` is an
    empty spread for `_clear`.
    """
    rows, columns = heights.shape[0] - 1, heights.shape[1] - 1
    nothing = np.nan, np.nan, np.nan
    # Whether the ray was above ground in the cell before.
    over, i, j = False, 0, 0
    x, y, h, per_x, per_y, per_h, last = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, t
    for count in range(rules.most_steps):
        is_new = count % 8 == 7
        if is_new:
            # Every eight cells, try again to skip whole blocks.
            t, may_hit = _clear(heights, tops, rules, start, c, none, t, end, min(2, len(tops.first) - 1), 0)
            if not may_hit:
                return nothing
        if is_new or t >= last:
            x, y, h = _point(start, c, t)
            per_x, per_y = _slope(c, 0, t), _slope(c, 1, t)
            if is_new or count == 0:
                i, j = _cell(y, per_y), _cell(x, per_x)
            last = min(max((math.sqrt(t) + longest) ** 2, t + max(min(*_ways(x, y, per_x, per_y, i, j)), 0.0)), end)
            per_x, per_y, per_h = _chord(start, c, t, last)
        to_x, to_y = _ways(x, y, per_x, per_y, i, j)
        t_next = t + max(min(to_x, to_y), 0.0)
        moves = t_next <= last
        t_next = min(t_next, last)
        x_next, y_next, h_next = x + (t_next - t) * per_x, y + (t_next - t) * per_y, h + (t_next - t) * per_h
        share, is_ground = np.inf, False
        if 0 <= j < columns and 0 <= i < rows:
            share, is_ground = _share_of_cell(
                heights, i, j, over, rules.touching_m, x - j, y - i, h, x_next - j, y_next - i, h_next
            )
        if share <= 1.0:
            x, y = x + share * (x_next - x), y + share * (y_next - y)
            # Rounding may put hits on the outermost edge of the surface beyond it.
            return t + share * (t_next - t), min(max(x, 0.0), columns), min(max(y, 0.0), rows)
        # Rays from beneath the ground have no share.
        if math.isnan(share) or t_next >= end or _leaves(rows, columns, x, y, per_x, per_y, 0.0, 0.0):
            return nothing
        over = is_ground
        if moves and to_x <= to_y:
            j += 1 if per_x > 0.0 else -1
        elif moves:
            i += 1 if per_y > 0.0 else -1
        t, x, y, h = t_next, x_next, y_next, h_next
    return nothing


@compiled
def search_cells(
    heights: Floats,
    tops: Pyramid,
    rules: Rules,
    start: Floats,
    c: Floats,
    after: Floats,
    farthest: Floats,
    none: Floats,
    found: Floats,
) -> None:
    """`Surface.search_cells`: fills in t, column and row of the first hits, (3, n)."""
    each = 1 if start.shape[1] > 1 else 0
    for ray in range(len(after)):
        # Where t is infinite, nothing is searched.
        if after[ray] < np.inf:
            found[0, ray], found[1, ray], found[2, ray] = _search(
                heights, tops, rules, start[:, each * ray], c[:, :, ray], 0.0, none, after[ray], farthest[ray]
            )


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


@compiled
def image_hits(
    heights: Floats,
    tops: Pyramid,
    rules: Rules,
    start: Floats,
    forms: Floats,
    longest: float,
    after: Floats,
    bundles: Floats,
    side: int,
    farthest: float,
    lines: Floats,
    c: Floats,
    none: Floats,
    found: Floats,
) -> None:
    """Fill in t, column and row of the first hits of an image's pixels, (3, height, width).

    ``forms`` (degree, 3, k, k) are those of `PixelRays.forms`; ``bundles`` are t before which no ray of a bundle of
    ``side`` px hits anything.
    """
    height, width = after.shape
    for row in range(height):
        _fill_lines(forms, row + 0.5, lines)
        for column in range(width):
            t = max(bundles[row // side, column // side], after[row, column])
            if t == np.inf:
                continue
            _fill_ray(lines, column + 0.5, c)
            hit = _search(heights, tops, rules, start, c, longest, none, t, farthest)
            found[0, row, column], found[1, row, column], found[2, row, column] = hit


@compiled
def begin_below(
    heights: Floats,
    start: Floats,
    forms: Floats,
    after: Floats,
    lines: Floats,
    c: Floats,
    hit_t: Floats,
    hit_column: Floats,
    hit_row: Floats,
) -> None:
    """`Surface.begin_below`: fills in hits, (height, width) each."""
    rows, columns = heights.shape[0] - 1, heights.shape[1] - 1
    for row in range(after.shape[0]):
        _fill_lines(forms, row + 0.5, lines)
        for column in range(after.shape[1]):
            t = after[row, column]
            if t == np.inf or not math.isnan(hit_t[row, column]):
                continue
            _fill_ray(lines, column + 0.5, c)
            x, y, h = _point(start, c, t)
            if not (0.0 <= x <= columns and 0.0 <= y <= rows):
                continue
            i, j = min(int(y), rows - 1), min(int(x), columns - 1)
            a, b, below = heights[i, j], heights[i, j + 1] - heights[i, j], heights[i + 1, j] - heights[i, j]
            twist = heights[i + 1, j + 1] - heights[i + 1, j] - b
            if a + b * (x - j) + below * (y - i) + twist * (x - j) * (y - i) >= h:
                hit_t[row, column], hit_column[row, column], hit_row[row, column] = t, x, y
