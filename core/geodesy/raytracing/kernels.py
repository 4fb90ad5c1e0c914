"""Rays followed one by one, compiled: the same as `Surface.clear` and `Surface.search_cells`, several times as fast.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Flags, Floats
from ...compiling import compiled
from .pyramid import Pyramid


class Rules(NamedTuple):
    """Lowest height of a surface, and the constants of `surface`."""

    lowest_m: float
    touching_m: float
    speeding: float
    slowest: float
    most_steps: int


@compiled
def _value(factors: Floats, axis: int, ray: int, t: float) -> float:
    """Polynomial with coefficients (degree, axes, n) of t, t², … at t."""
    total = 0.0
    for power in range(factors.shape[0] - 1, -1, -1):
        total = (total + factors[power, axis, ray]) * t
    return total


@compiled
def _slope(factors: Floats, axis: int, ray: int, t: float) -> float:
    """Derivative of `_value` by t."""
    total = 0.0
    for power in range(factors.shape[0] - 1, -1, -1):
        total = total * t + (power + 1) * factors[power, axis, ray]
    return total


@compiled
def _point(start: Floats, at: int, c: Floats, ray: int, t: float) -> tuple[float, float, float]:
    """Column, row and height of a ray at t."""
    return (
        start[0, at] + _value(c, 0, ray, t),
        start[1, at] + _value(c, 1, ray, t),
        start[2, at] + _value(c, 2, ray, t),
    )


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
    ray: int,
    t: float,
    end: float,
    level: int,
    least_level: int,
) -> tuple[float, bool]:
    """Follow a ray or a bundle while it certainly hits nothing: t, and whether it may hit something from there on."""
    rows, columns = heights.shape[0] - 1, heights.shape[1] - 1
    at = ray if start.shape[1] > 1 else 0
    is_bundle = spread.shape[0] > 0
    bulge = abs(c[1, 2, ray]) if c.shape[0] > 1 else 0.0
    wide, widens, deep = 0.0, 0.0, 0.0
    for _ in range(rules.most_steps):
        x, y, h = _point(start, at, c, ray, t)
        per_x, per_y = _slope(c, 0, ray, t), _slope(c, 1, ray, t)
        size = math.ldexp(1.0, level)
        per_t = max(abs(per_x), abs(per_y))
        if is_bundle:
            wide, widens = _value(spread, 0, ray, t), _slope(spread, 0, ray, t)
            per_t += widens
        roomy = wide <= 0.5 * size
        step = (size - wide) / (rules.speeding * max(per_t, rules.slowest)) if roomy else 0.0
        ahead = min(t + step, end)
        if is_bundle:
            deep = _value(spread, 1, ray, ahead)
        j = min(max(math.floor(x / size), -1.0), tops.wide[level])
        i = min(max(math.floor(y / size), -1.0), tops.high[level])
        top = tops.flat[int(tops.first[level] + (i + 1.0) * (tops.wide[level] + 2) + (j + 1.0))]
        over = h - deep - bulge * (ahead - t) ** 2 - top
        fall = h - (start[2, at] + _value(c, 2, ray, ahead))
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
) -> tuple[Floats, Flags]:
    """`Surface.clear` of rays, or of bundles where ``spread`` has coefficients."""
    n = len(after)
    t_found, may_hit = after.copy(), np.zeros(n, np.bool_)
    # Single rays start near the ground, so at a low level.
    top_level = len(tops.first) - 1
    level = top_level if spread.shape[0] > 0 else min(2, top_level)
    for ray in range(n):
        if after[ray] <= farthest[ray]:
            t_found[ray], may_hit[ray] = _clear(
                heights, tops, rules, start, c, spread, ray, after[ray], farthest[ray], level, least_level
            )
    return t_found, may_hit


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
    """Share of a chord through a cell at which it reaches the ground, see `_first_share`; whether it has ground.

    Positions count from the cell's upper left corner.
    """
    a = heights[i, j]
    b, down = heights[i, j + 1] - a, heights[i + 1, j] - a
    twist = (heights[i + 1, j + 1] - heights[i + 1, j]) - b
    x, y = min(max(x, 0.0), 1.0), min(max(y, 0.0), 1.0)
    x_next, y_next = min(max(x_next, 0.0), 1.0), min(max(y_next, 0.0), 1.0)
    share = _first_share(a, b, down, twist, over, touching_m, x, y, h, x_next, y_next, h_next)
    return share, not math.isnan(twist)


@compiled
def _search(
    heights: Floats, tops: Pyramid, rules: Rules, start: Floats, c: Floats, ray: int, t: float, end: float
) -> tuple[float, float, float]:
    """t, column and row of the first hit of a ray."""
    rows, columns = heights.shape[0] - 1, heights.shape[1] - 1
    at, level, none = ray if start.shape[1] > 1 else 0, min(2, len(tops.first) - 1), np.empty((0, 2, 1))
    nothing = np.nan, np.nan, np.nan
    # Whether the ray was above ground in the cell before.
    over, i, j, x, y, h = False, 0, 0, 0.0, 0.0, 0.0
    for count in range(rules.most_steps):
        if count % 8 == 7:
            # Every eight cells, try again to skip whole blocks.
            t, may_hit = _clear(heights, tops, rules, start, c, none, ray, t, end, level, 0)
            if not may_hit:
                return nothing
        per_x, per_y = _slope(c, 0, ray, t), _slope(c, 1, ray, t)
        if count == 0 or count % 8 == 7:
            x, y, h = _point(start, at, c, ray, t)
            i, j = _cell(y, per_y), _cell(x, per_x)
        to_x = (j + (1 if per_x > 0.0 else 0) - x) / per_x if per_x != 0.0 else np.inf
        to_y = (i + (1 if per_y > 0.0 else 0) - y) / per_y if per_y != 0.0 else np.inf
        t_next = min(t + max(min(to_x, to_y), 0.0), end)
        x_next, y_next, h_next = _point(start, at, c, ray, t_next)
        if 0 <= j < columns and 0 <= i < rows:
            share, over = _share_of_cell(
                heights, i, j, over, rules.touching_m, x - j, y - i, h, x_next - j, y_next - i, h_next
            )
            if share <= 1.0:
                x, y = x + share * (x_next - x), y + share * (y_next - y)
                # Rounding may put hits on the outermost edge of the surface beyond it.
                return t + share * (t_next - t), min(max(x, 0.0), columns), min(max(y, 0.0), rows)
            if math.isnan(share):
                # From beneath the ground.
                return nothing
        else:
            over = False
        if t_next >= end or _leaves(rows, columns, x, y, per_x, per_y, 0.0, 0.0):
            return nothing
        if to_x <= to_y:
            j += int(np.sign(per_x))
        else:
            i += int(np.sign(per_y))
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
) -> Floats:
    """`Surface.search_cells`: t, column and row of the first hits, (3, n); NaN for a miss."""
    found = np.full((3, len(after)), np.nan)
    for ray in range(len(after)):
        # Where t is infinite, nothing is searched.
        if after[ray] < np.inf:
            found[:, ray] = _search(heights, tops, rules, start, c, ray, after[ray], farthest[ray])
    return found
