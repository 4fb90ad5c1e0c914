"""What pixels cover and the samples spread over it, compiled: the same as the rest of `areas`, and faster.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arrays import Floats, Numbers
from ..external.compiling import compiled


class SpreadRules(NamedTuple):
    """How samples are spread: the constants of `areas`, which are described there."""

    source_blur: float
    least_covered: float
    most_skew: float
    most_length: int
    rounding: float
    tiny: float


@compiled
def see_pixels(
    box: Numbers,
    factors: Floats,
    begin_u: Floats,
    begin_v: Floats,
    row: Numbers,
    column: Numbers,
    du: Floats,
    v: Floats,
    steps: Floats,
) -> None:
    """Fill in the pixels (n,) of cells (k, 4): their positions, and steps (n, 4) along their rows and columns.

    ``factors`` (8, k) and ``begin_u, begin_v`` (k,) are those of `areas._Perspectives`.
    """
    at = 0
    for cell in range(len(box)):
        left, top, right, bottom = box[cell]
        a, b, c, d, e, f, g, h = factors[:, cell]
        for pixel_row in range(top, bottom):
            y = pixel_row - top + 0.5
            for pixel_column in range(left, right):
                x = pixel_column - left + 0.5
                divisor = g * x + h * y + 1.0
                off_u, off_v = (a * x + b * y + c) / divisor, (d * x + e * y + f) / divisor
                row[at], column[at] = pixel_row, pixel_column
                du[at], v[at] = begin_u[cell] + off_u, begin_v[cell] + off_v
                steps[at, 0], steps[at, 1] = (a - off_u * g) / divisor, (d - off_v * g) / divisor
                steps[at, 2], steps[at, 3] = (b - off_u * h) / divisor, (e - off_v * h) / divisor
                at += 1


@compiled
def _zoom(long2: float, short2: float, world: float, zooms: tuple[int, int], rules: SpreadRules) -> int:
    """Zoom for an ellipse: see `areas._zooms`."""
    if zooms[0] == zooms[1]:
        return zooms[0]
    least = max(rules.source_blur / short2, rules.least_covered / math.sqrt(long2 * short2))
    share, finest = math.frexp(math.sqrt(least) / world)
    _, most = math.frexp(rules.most_length / (math.sqrt(long2) * world))
    return min(max(min(finest - (1 if share == 0.5 else 0), most - 1), zooms[0]), zooms[1])


@compiled
def spread(
    world: float, zooms: tuple[int, int], rules: SpreadRules, steps: Floats, zoom: Numbers, counts: Numbers
) -> None:
    """Fill in the zooms (n,) of pixels and numbers of samples (n, 2), and replace steps (n, 4) by those between these.

    ``world`` is the number of source pixels around the world at zoom 0.
    """
    for pixel in range(len(steps)):
        across_u, across_v, down_u, down_v = steps[pixel]
        # The ellipse: see `areas._Ellipses`.
        uu, uv = across_u * across_u + down_u * down_u, across_u * across_v + down_u * down_v
        vv = across_v * across_v + down_v * down_v
        apart, half = (uu - vv) / 2.0, (uu + vv) / 2.0
        eccentric = math.sqrt(apart * apart + uv * uv)
        long2 = max(half + eccentric, rules.tiny)
        area = across_u * down_v - across_v * down_u
        short2 = max(area * area / long2, rules.tiny)
        zoom[pixel] = _zoom(long2, short2, world, zooms, rules)
        world_px = math.ldexp(world, zoom[pixel])
        # The samples: see `areas._spread`.
        blur = rules.source_blur / (world_px * world_px)
        if max(long2, short2) <= blur:
            # The source's own blur is as wide as the pixel.
            counts[pixel, 0], counts[pixel, 1], steps[pixel] = 1, 1, 0.0
            continue
        axis_u, axis_v = eccentric + abs(apart), uv
        if apart < 0.0:
            axis_u, axis_v = axis_v, axis_u
        length = math.sqrt(axis_u * axis_u + axis_v * axis_v)
        if length > 0.0:
            axis_u, axis_v = axis_u / length, axis_v / length
        else:
            axis_u, axis_v = 1.0, 0.0
        left_long, left_short = math.sqrt(max(1.0 - blur / long2, 0.0)), math.sqrt(max(1.0 - blur / short2, 0.0))
        longer, shorter = math.sqrt(long2), math.sqrt(short2)
        most = rules.most_skew * longer * shorter
        is_even = (across_u * across_u + across_v * across_v) * (down_u * down_u + down_v * down_v) <= most * most
        for axis in range(2):
            if is_even:
                side_u, side_v = (across_u, across_v) if axis == 0 else (down_u, down_v)
            elif axis == 0:
                side_u, side_v = axis_u * longer, axis_v * longer
            else:
                side_u, side_v = -axis_v * shorter, axis_u * shorter
            along = (side_u * axis_u + side_v * axis_v) * left_long
            aside = (side_v * axis_u - side_u * axis_v) * left_short
            length = math.sqrt(along * along + aside * aside) * world_px
            count = math.ceil(math.sqrt(length * length / rules.source_blur + 1.0) - rules.rounding)
            count = min(count, rules.most_length)
            share = 1.0 / math.sqrt(max(count * count - 1.0, 1.0))
            steps[pixel, 2 * axis] = (along * axis_u - aside * axis_v) * share
            steps[pixel, 2 * axis + 1] = (along * axis_v + aside * axis_u) * share
            counts[pixel, axis] = count
