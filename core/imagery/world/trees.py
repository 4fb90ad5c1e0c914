"""Tree crowns: one to a cell of a lattice, and in woods another between four of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .buildings import Footprints
from .lattice import WORLD_M, Array, Cells, Grid, Window, bits, cell_hash, salt
from .leaves import HALF_WIDTH_M, HEDGE, LANE, MAIN, ROAD
from .paint import Canvas, clip01
from .scene import Scene

LEVEL = 22
"""Cells of 9.6 m hold a crown each."""

FIRST_ZOOM = 15
"""From here on crowns are drawn one by one, before as an even canopy."""

CELL_M = WORLD_M / (1 << LEVEL)
CANOPY = (50, 68, 40)
_MEAN_LIGHT = 0.86
"""Mean lightness of a crown, by which its colour is divided so that woods are as dark from afar as near."""

_SHADOW_M, _SHADOW = 2.6, (18, 24, 22)
_HUES = (30.0, 16.0, 4.0)
_WOODED = 0.9
"""A greater chance than this means a wood: crowns are wide and touch."""

_DENSE = 0.25
"""Below this share of cells with a tree it is quicker to gather those."""


@dataclass(frozen=True)
class Crowns:
    """Trees of a block of cells: arrays (rows, columns); centres and radii in cells."""

    window: Window
    there: Array
    x: Array
    y: Array
    radius: Array
    tone: Array
    hue: Array


def _chances(scene: Scene) -> Array:
    """How likely each cell of a scene of cells holds a tree."""
    shape = scene.samples.shape
    chance = np.full(shape, 0.006, dtype=np.float32)
    parcels = scene.parcels
    town = parcels.leaf(parcels.division.looks.town)
    if town.any():
        np.maximum(chance, parcels.spread(town) * np.float32(0.30), out=chance)
    d = parcels.distance_m(HEDGE)
    if d is not None:
        chance[d < 5.5] = 0.55
    woods = scene.woods()
    if woods is not None:
        np.maximum(chance, (woods > 0.5) * np.float32(0.97), out=chance)
    for line in (LANE, ROAD, MAIN):
        d = parcels.distance_m(line)
        if d is not None:
            chance[d < HALF_WIDTH_M[line] + 3.2] = 0.0
    prints = Footprints(parcels)
    if not prints.none:
        chance[prints.cover(moved_m=1.5, grow_m=4.4) > 0.5] = 0.0
    for cover in (scene.water(), scene.motorway()):
        if cover is not None:
            chance[cover > 0.02] = 0.0
    return chance


def plant(scene: Scene) -> list[tuple[Cells, Crowns]]:
    """Plant trees in the cells under a scene's samples, and in woods between them too."""
    seed, samples = scene.seed, scene.samples
    cells, between = samples.cells(LEVEL), samples.cells(LEVEL, shifted=True)
    block = between.window(1, 0)  # the four cells around each cell between
    chance = _chances(Scene(seed, Grid(samples.zoom, samples.x, samples.y, block)))
    window = cells.window()
    i, j = window.i0 - block.i0, window.j0 - block.j0
    planted = [(cells, _grow(seed, window, chance[j : j + window.rows, i : i + window.columns], 0))]
    dense = chance > _WOODED
    dense = dense[:-1, :-1] & dense[1:, :-1] & dense[:-1, 1:] & dense[1:, 1:]
    if dense.any():
        planted.append((between, _grow(seed, between.window(), dense * np.float32(0.96), 1)))
    return planted


def _grow(seed: int, window: Window, chance: Array, number: int) -> Crowns:
    i, j = window.indices()
    h = cell_hash(salt(seed, 7, number), LEVEL, i, j)
    k = cell_hash(salt(seed, 8, number), LEVEL, i, j)
    there = bits(h, 0, 8) < chance
    crowded = chance > _WOODED
    radius = np.where(crowded, 0.37 + 0.13 * bits(h, 8, 6), 0.2 + 0.24 * bits(h, 8, 6)).astype(np.float32)
    slack = (np.float32(0.5) - radius) * np.where(crowded, np.float32(1), np.float32(0.4))
    x = np.float32(0.5) + slack * (bits(h, 14, 9) * np.float32(2) - np.float32(1))
    y = np.float32(0.5) + slack * (bits(h, 23, 9) * np.float32(2) - np.float32(1))
    tone = np.float32(0.80) + np.float32(0.4) * bits(k, 0, 8)
    hue = bits(k, 8, 8) - np.float32(0.5)
    return Crowns(window, there, x, y, radius, tone, hue)


class _Drawn:
    """Crowns' attributes at the samples: at all of them or, where crowns are few, at those in a cell with one."""

    def __init__(self, canvas: Canvas, cells: Cells, crowns: Crowns) -> None:
        self.canvas, self.cells, self.window = canvas, cells, crowns.window
        self.dense = float(crowns.there.mean()) > _DENSE
        if not self.dense:
            near = np.broadcast_to(cells.spread(crowns.there, crowns.window), cells.inner())
            self.at = np.flatnonzero(near)
            self.cells = cells.pick(self.at)

    def take(self, table: Array) -> Array:
        return self.cells.spread(table, self.window)

    def sample(self, values: Array) -> Array:
        return values.reshape(self.cells.inner()) if self.dense else values.ravel()[self.at]

    def blend(self, cover: Array, colour: Sequence[float | Array]) -> None:
        if not self.dense:
            self.canvas.touch(self.at, cover, colour)
            return
        for plane, ink in zip(self.canvas.planes, colour):
            view = plane.reshape(self.cells.inner())
            step = np.float32(ink) - view if np.ndim(ink) == 0 else ink - view
            step *= cover
            view += step


def draw(
    canvas: Canvas,
    cells: Cells,
    crowns: Crowns,
    pixel_m: float,
    leaf: Array | None,
    contrast: float,
    canopy: Array,
) -> None:
    """Draw crowns, lit from the north-west, and the shadows of those that stand alone."""
    if not crowns.there.any():
        return
    drawn = _Drawn(canvas, cells, crowns)
    one = np.float32(1)
    radius = np.where(crowns.there, crowns.radius, np.float32(1e-3))
    inverse = drawn.take(one / radius)
    dx = (drawn.cells.fx - drawn.take(crowns.x)) * inverse
    dy = drawn.cells.fy - drawn.take(crowns.y)
    dy *= inverse
    sharp = drawn.take(radius * np.float32(0.5 * CELL_M / pixel_m))
    if pixel_m < _SHADOW_M and not drawn.dense:
        shift = np.float32(_SHADOW_M / CELL_M) * inverse
        sx, sy = dx - shift, dy - shift
        shade = (one - (sx * sx + sy * sy)) * sharp
        shade += np.float32(0.5)
        drawn.blend(clip01(shade) * np.float32(0.55), _SHADOW)
    q = dy * dy
    q += dx * dx
    cover = one - q
    cover *= sharp
    cover += np.float32(0.5)
    clip01(cover)
    light = np.minimum(q, one, out=q)
    light += dy
    light += dx
    light *= np.float32(-0.30)
    light += one
    if leaf is not None:
        light += drawn.sample(leaf) * np.float32(0.55)
    light *= np.float32(contrast / _MEAN_LIGHT)
    light += np.float32(1 - contrast)
    light *= drawn.take(one + (crowns.tone - one) * np.float32(contrast))
    drawn.blend(
        cover, [light * drawn.take(np.float32(c) + crowns.hue * np.float32(s)) for c, s in zip(canopy, _HUES)]
    )
