"""Shadows that houses and trees cast on the ground and on each other."""

from __future__ import annotations

import numpy as np

from ..arrays import NDArray
from . import objects
from .lattice import TILE_PX, WORLD_M, Array, LatticeWindow
from .paint import Canvas, clip01
from .rays import ChartSun, Ray
from .relief_light import lay
from .samples import Grid, Positions, shared
from .scene import Scene

#: Finest zoom at whose pixels shadows are computed.
_FINEST_ZOOM = 19
#: Greatest height of houses and trees, in the chart's metres.
_HIGHEST_M = 10.0
#: Step of a ray from which on it passes every other pixel only.
_CLOSE_STEPS = 64


def cast_shadows(scene: Scene) -> NDArray[np.float32] | None:
    """Share of the sun's light, 0..1, that houses and trees let through to samples; None for all of it."""
    sun, samples = scene.sun, scene.samples
    if sun is None or samples.zoom < objects.FIRST_ZOOM:
        return None
    zoom = object_zoom(samples.zoom, sun)
    up = samples.zoom - zoom
    highest = _highest_shadow(scene.seed, sun, zoom, samples.x >> up, samples.y >> up)
    if highest is None:
        return None
    is_tile = isinstance(samples, Grid)
    tops = _tops(scene.seed, sun, samples.zoom, samples.x, samples.y) if is_tile else tops_m(scene)
    if is_tile and not up:
        shadow: Array = highest[1:-1, 1:-1]
    else:
        shadow = _interpolated(highest, samples, up)
    clear = -shadow if tops is None else tops - shadow
    # Shadows end within a pixel.
    clear *= np.float32(1.0 / (Ray.to(sun).length * samples.pixel_m * sun.tangent))
    return np.asarray(clip01(clear), np.float32)


def object_zoom(zoom: int, sun: ChartSun) -> int:
    """Zoom at whose pixels the shadows of houses and trees are computed: within a tile's width they end.

    Under a sun lower than half a degree, they are cut off at 1.2 km.
    """
    finest = np.floor(np.log2(WORLD_M / TILE_PX * (TILE_PX - 2) * max(sun.tangent, 1e-6) / _HIGHEST_M))
    return int(max(min(zoom, _FINEST_ZOOM, finest), objects.FIRST_ZOOM))


def _interpolated(values: Array, samples: Positions, up: int) -> Array:
    """Interpolate values at the pixels of the tile ``up`` zooms lower, with a margin of one, linearly at samples."""
    pixel_m = samples.pixel_m * (1 << up)
    corner = (samples.x & ((1 << up) - 1)) * TILE_PX, (samples.y & ((1 << up) - 1)) * TILE_PX
    east, south = (
        np.clip((at + np.float32(start * samples.pixel_m)) * np.float32(1.0 / pixel_m) + np.float32(0.5), 0.0, 256.9999)
        for at, start in zip(samples.local_m(), corner)
    )
    column, row = np.floor(east).astype(np.intp), np.floor(south).astype(np.intp)
    x, y = (east - column).astype(np.float32), (south - row).astype(np.float32)
    if isinstance(samples, Grid):
        # Of a tile's pixels, all rows have the same columns.
        first, last = int(row[0, 0]), int(row[-1, 0]) + 2
        part = values[first:last]
        along = part[:, column] + (part[:, column + 1] - part[:, column]) * x
        above = row[:, 0] - first
        return np.asarray(along[above] + (along[above + 1] - along[above]) * y)
    north = values[row, column] + (values[row, column + 1] - values[row, column]) * x
    beyond = values[row + 1, column] + (values[row + 1, column + 1] - values[row + 1, column]) * x
    return np.asarray(north + (beyond - north) * y)


@shared(64)
def _highest_shadow(landscape: int, sun: ChartSun, zoom: int, x: int, y: int) -> NDArray[np.float32] | None:
    """Height above ground below which the houses and trees in the direction of the sun leave no light.

    Chart metres at the pixels of a tile and in a margin of one, (258, 258); None without shadows.
    """
    ray, window = Ray.to(sun), Grid(zoom, x, y).block.grown(1)
    step_m = ray.length * WORLD_M / (1 << window.level)
    drop = step_m * sun.tangent
    steps = min(int(np.ceil(_HIGHEST_M / drop)), TILE_PX)
    if drop >= _HIGHEST_M:
        return None
    ahead = ray.ahead(window, 1, steps + 1)
    tops = _tops_ahead(landscape, sun, zoom, ahead)
    return None if tops is None else highest_shadow(tops, window, ahead, ray, steps, drop)


def highest_shadow(
    tops: Array, window: LatticeWindow, ahead: LatticeWindow, ray: Ray, steps: int, drop: float
) -> NDArray[np.float32]:
    """Greatest height over a window of rays to the sun that tops (of the window ``ahead``) are in the way of."""
    shape, origin = (window.rows, window.columns), (window.i0 - ahead.i0, window.j0 - ahead.j0)
    # Rays pass between two pixels of a row: halfway is close enough.
    halfway = tops.copy()
    if abs(ray.south) == 1.0:
        halfway[:, :-1] += (tops[:, 1:] - tops[:, :-1]) * np.float32(0.5)
    else:
        halfway[:-1] += (tops[1:] - tops[:-1]) * np.float32(0.5)
    best, here = np.full(shape, -drop, np.float32), np.empty(shape, np.float32)
    step = 1
    while step <= steps:
        column, row, share, _ = ray.at(step, 0.5)
        i, j = origin[0] + column, origin[1] + row
        held = halfway if share else tops
        np.subtract(held[j : j + shape[0], i : i + shape[1]], np.float32(step * drop), out=here)
        np.maximum(best, here, out=best)
        # Far from a pixel its ray rises slowly against the width of what it meets.
        step += 1 if step < _CLOSE_STEPS else 2
    return best


def _tops_ahead(landscape: int, sun: ChartSun, zoom: int, window: LatticeWindow) -> NDArray[np.float32] | None:
    """Heights of houses and trees above the ground in a window of pixels; None if there are none."""
    tiles = 1 << zoom
    out: NDArray[np.float32] | None = None
    for y in range(max(window.j0 // TILE_PX, 0), min((window.j0 + window.rows - 1) // TILE_PX, tiles - 1) + 1):
        for x in range(window.i0 // TILE_PX, (window.i0 + window.columns - 1) // TILE_PX + 1):
            tops = _tops(landscape, sun, zoom, x % tiles, y)
            if tops is not None:
                out = np.zeros((window.rows, window.columns), np.float32) if out is None else out
                lay(out, window, tops, x, y)
    return out


@shared(64)
def _tops(landscape: int, sun: ChartSun, zoom: int, x: int, y: int) -> NDArray[np.float32] | None:
    return tops_m(tile_scene(landscape, sun, zoom, x, y))


def tile_scene(landscape: int, sun: ChartSun | None, zoom: int, x: int, y: int) -> Scene:
    """Scene of a tile; under a sun, neighbours share it, as their shadows fall on each other."""
    samples = Grid(zoom, x, y)
    return Scene(landscape, samples) if sun is None else _shared_scene(landscape, sun, samples.zoom, x, y)


@shared(12)
def _shared_scene(landscape: int, sun: ChartSun, zoom: int, x: int, y: int) -> Scene:
    return Scene(landscape, Grid(zoom, x, y), sun=sun)


def tops_m(scene: Scene) -> NDArray[np.float32] | None:
    """Heights of houses and trees above the ground, in the chart's metres; None if there are none."""
    above = Canvas([0.0], scene.samples.shape)
    prints = objects.footprints(scene.parcels)
    if prints is not None:
        at, near = prints.nearby(0.0)
        above.touch(at, (near.cover(), [near.heights_m()]))
    for cells, crowns in objects.plant(scene):
        objects.raise_crowns(above, cells, crowns, scene.pixel_m)
    return above.planes[0].reshape(scene.samples.shape) if above.planes.any() else None
