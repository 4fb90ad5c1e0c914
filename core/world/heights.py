"""How high the world is: its ground, and what stands on it, as its pictures have them."""

from __future__ import annotations

import numpy as np

from . import climate, objects
from .lattice import WORLD_M, Array, pole_of
from .objects import footprints
from .paint import Canvas
from .region import smoothstep
from .scene import PARCEL_ZOOM, Scene

_MOUNTAINS_M = 3000.0
"""Of 1 in `climate.height`, which the highest mountains reach."""
_HILLS_M = 40_000.0
"""Of 1 in the relief of hills, so that they are steep where they are painted so: seldom more than 30 degrees."""
_SHORE, _LAKE_SHORE = 0.02, 0.2
"""What `land` is beyond the shore where the ground is as high as its relief, and likewise of `lake`."""
_LEAST_M = 0.5
"""Height of land that is not the sea's."""
_CANOPY_M = 6.0
"""Mean height of a wood, of which no crowns are drawn."""


def ground_m(scene: Scene) -> Array:
    """Heights of the bare ground over the ellipsoid, metres: 0 at sea, without hills in lakes; (…) as the samples."""
    region, samples = scene.region, scene.samples
    land = region.value("land", samples)
    shore = smoothstep(0.0, _SHORE, land)
    high = region.smooth(climate.height, samples) * np.float32(_MOUNTAINS_M)
    hills = region.hills(samples) * np.float32(_HILLS_M)
    lake = region.value("lake", samples) - (
        np.float32(2.28) - np.float32(1.2) * region.smooth(climate.wateriness, samples)
    )
    hills *= np.float32(1) - smoothstep(-_LAKE_SHORE, 0.0, lake)
    ground = np.maximum(high + hills, np.float32(_LEAST_M)) * shore
    return np.asarray(np.broadcast_to(ground, samples.shape), np.float32)


def surface_m(scene: Scene) -> Array:
    """Heights of the ground with buildings and trees on it, as they are painted, metres; of the samples' shape."""
    ground = ground_m(scene)
    zoom, samples = scene.samples.zoom, scene.samples
    if zoom < PARCEL_ZOOM:
        return ground
    above = Canvas([0.0], samples.shape)
    woods = scene.woods
    if woods is not None and zoom < objects.FIRST_ZOOM:
        above.blend(woods, [_CANOPY_M])
    prints = footprints(scene.parcels)
    if prints is not None:
        at, near = prints.near(0.0)
        above.touch(at, (near.cover(), [near.rises_m() + np.float32(objects.EAVES_M)]))
    if zoom >= objects.FIRST_ZOOM:
        for cells, crowns in objects.plant(scene):
            objects.raise_crowns(above, cells, crowns, scene.pixel_m)
    return np.asarray(ground + above.planes[0].reshape(samples.shape) * _scale(scene), np.float32)


def _scale(scene: Scene) -> Array | float:
    """Metres of ground in one of the chart: objects are as high as they are wide."""
    if pole_of(scene.seed):
        return 1.0
    _, south = scene.samples.local_m()
    v = (np.asarray(scene.samples.origin_m[1], np.float64) + south) / WORLD_M
    return np.asarray(1.0 / np.cosh(np.pi * (1.0 - 2.0 * v)), np.float32)
