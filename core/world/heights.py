"""Heights of the ground, and of the surface with trees, as the pictures show them; for buildings, see `houses`."""

from __future__ import annotations

import numpy as np

from . import climate, objects
from .lattice import WORLD_M, Array, chart_pole
from .paint import Canvas
from .region import smoothstep
from .scene import PARCEL_ZOOM, Scene


def ground_m(scene: Scene) -> Array:
    """Heights of the bare ground above the ellipsoid, metres, in the samples' shape; 0 at sea, no hills in lakes."""
    region, samples = scene.region, scene.samples
    land = region.value("land", samples)
    # The relief rises to its full height between the shore and 0.02 of `land`, and likewise around lakes.
    shore = smoothstep(0.0, 0.02, land)
    # The highest mountains reach 1, which is 3 km.
    high = region.smooth(climate.height, samples) * np.float32(3000.0)
    # Hills are as steep as they are painted: seldom more than 30 degrees.
    hills = region.hills(samples) * np.float32(40_000.0)
    lake = region.value("lake", samples) - (
        np.float32(2.28) - np.float32(1.2) * region.smooth(climate.wateriness, samples)
    )
    hills *= np.float32(1) - smoothstep(-0.2, 0.0, lake)
    # Land lies at least 0.5 m above the sea.
    ground = np.maximum(high + hills, np.float32(0.5)) * shore
    return np.asarray(np.broadcast_to(ground, samples.shape), np.float32)


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
    return np.asarray(ground + above.planes[0].reshape(samples.shape) * _scale(scene), np.float32)


def _scale(scene: Scene) -> Array | float:
    """Metres on the ground per metre of the chart, the scale of objects: their heights change like their widths."""
    if chart_pole(scene.seed):
        return 1.0
    _, south = scene.samples.local_m()
    v = (np.asarray(scene.samples.origin_m[1], np.float64) + south) / WORLD_M
    return np.asarray(1.0 / np.cosh(np.pi * (1.0 - 2.0 * v)), np.float32)
