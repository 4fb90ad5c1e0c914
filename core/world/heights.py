"""Heights of the ground, and of the surface with trees, as the pictures show them; for buildings, see `houses`."""

from __future__ import annotations

import numpy as np

from ..arrays import NDArray
from . import climate, objects
from .lattice import WORLD_M, Array, LatticeWindow, chart_pole
from .paint import Canvas
from .region import Region, smoothstep
from .samples import Grid
from .scene import PARCEL_ZOOM, Scene

#: Metres per unit of `climate.height`, of which the highest mountains reach 1.
_HIGH_M = 3000.0
#: No ground is higher, by the sum of all octaves.
HIGHEST_M = 10_500.0
#: Metres per unit of hills, which are as steep as they are painted: seldom more than 30 degrees.
_HILLS_M = 40_000.0


def ground_m(scene: Scene) -> Array:
    """Heights of the bare ground above the ellipsoid, metres, in the samples' shape; 0 at sea, no hills in lakes."""
    region, samples = scene.region, scene.samples
    land = region.value("land", samples)
    # The relief rises to its full height between the shore and 0.02 of `land`, and likewise around lakes.
    shore = smoothstep(0.0, 0.02, land)
    high = region.smooth(climate.height, samples) * np.float32(_HIGH_M)
    hills = region.hills(samples) * np.float32(_HILLS_M)
    lake = region.value("lake", samples) - (
        np.float32(2.28) - np.float32(1.2) * region.smooth(climate.wateriness, samples)
    )
    hills *= np.float32(1) - smoothstep(-0.2, 0.0, lake)
    # Land lies at least 0.5 m above the sea.
    ground = np.maximum(high + hills, np.float32(0.5)) * shore
    return np.asarray(np.broadcast_to(ground, samples.shape), np.float32)


def highest_m(seed: int, window: LatticeWindow) -> float:
    """Bound the heights of the ground at the cells of a window from above, in the chart's metres.

    By the coefficients of a region three zooms lower, and by the most that the octaves left out can add.
    """
    zoom = max(window.level - 11, 0)
    side, tiles, found = window.level - zoom, 1 << zoom, -np.inf
    for y in range(max(window.j0 >> side, 0), min((window.j0 + window.rows - 1) >> side, tiles - 1) + 1):
        for x in range(window.i0 >> side, ((window.i0 + window.columns - 1) >> side) + 1):
            tile = Grid(zoom, x % tiles, y)
            land, relief, hills = Region.around(seed, tile).highest(window, x - tile.x)
            found = max(found, 0.16 * _HIGH_M * max(land, 0.0) + 1.9 * _HIGH_M * max(relief, 0.0) + _HILLS_M * hills)
    return max(found, 0.5) / float(chart_scale(seed, window.rows_v).min())


def surface_m(scene: Scene) -> Array:
    """Heights of the ground with trees, metres; of the samples' shape."""
    ground = ground_m(scene)
    zoom, samples = scene.samples.zoom, scene.samples
    if zoom < PARCEL_ZOOM:
        return ground
    above = Canvas([0.0], samples.shape)
    woods = scene.woods
    if woods is not None and zoom < objects.FIRST_ZOOM:
        # Mean height of a wood, before single crowns are drawn.
        above.blend(woods, [6.0])
    if zoom >= objects.FIRST_ZOOM:
        for cells, crowns in objects.plant(scene):
            objects.raise_crowns(above, cells, crowns, scene.pixel_m)
    _, south = samples.local_m()
    v = (np.asarray(samples.origin_m[1], np.float64) + south) / WORLD_M
    # Heights of objects change with the scale of the chart, like their widths.
    return np.asarray(ground + above.planes[0].reshape(samples.shape) * chart_scale(scene.seed, v), np.float32)


def chart_scale(seed: int, v: Array) -> NDArray[np.float32]:
    """Metres on the ground per metre of the chart, at world fractions from the north."""
    if chart_pole(seed):
        return np.ones(np.shape(v), np.float32)
    return np.asarray(1.0 / np.cosh(np.pi * (1.0 - 2.0 * np.clip(v, 0.0, 1.0))), np.float32)
