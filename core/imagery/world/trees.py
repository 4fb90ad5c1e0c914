"""Tree crowns: one to a cell of a lattice, and in woods another between four of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .buildings import Footprints
from .lattice import Array, Cells, Grid, Samples, Window, bits, cell_hash, salt
from .leaves import HALF_WIDTH_M, HEDGE, LANE, MAIN, ROAD
from .paint import Canvas
from .scene import Scene

LEVEL = 22
"""Cells of 9.6 m hold a crown each."""

FIRST_ZOOM = 15
"""From here on crowns are drawn one by one, before as an even canopy."""

CELL_M = 40075016.685578488 / (1 << LEVEL)
CANOPY = (50, 68, 40)
_MEAN_LIGHT = 0.86
"""Mean lightness of a crown, by which its colour is divided so that woods are as dark from afar as near."""

_SHADOW_M = 2.6


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


def _chances(scene: Scene, alone: bool) -> Array:
    """How likely each cell of a grid scene holds a tree."""
    shape = scene.samples.shape
    chance = np.full(shape, 0.006 if alone else 0.0, dtype=np.float32)
    parcels = scene.parcels
    town = parcels.leaf(parcels.division.looks.town)
    if town.any():
        np.maximum(chance, parcels.spread(town) * np.float32(0.30 if alone else 0.10), out=chance)
    if alone:
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
    if prints.at.size:
        built = prints.cover(grow_m=3.4) + prints.cover(-2.0, 3.4)
        chance.ravel()[prints.at[built > 0.3]] = 0.0
    for cover in (scene.water(), scene.motorway()):
        if cover is not None:
            chance[cover > 0.02] = 0.0
    return chance


def plant(seed: int, samples: Samples, shifted: bool) -> tuple[Cells, Crowns]:
    """Plant trees in the cells under the samples; `shifted` gives the second set, between the first's cells."""
    cells = samples.cells(LEVEL, shifted)
    window = cells.window()
    level = LEVEL + 1 if shifted else LEVEL
    if (
        shifted
    ):  # the shifted cell's centre is the unshifted cell's corner: every second point of a grid twice as fine
        block = Window(LEVEL, window.i0 - 1, window.j0 - 1, window.columns + 1, window.rows + 1)
        block = Window(LEVEL, window.i0, window.j0, window.columns, window.rows)
    else:
        block = window
    scene = Scene(seed, Grid(samples.zoom, samples.x, samples.y, block))
    chance = _chances(scene, alone=not shifted)
    i, j = window.indices()
    h = cell_hash(salt(seed, 7, int(shifted)), level, i, j)
    k = cell_hash(salt(seed, 8, int(shifted)), level, i, j)
    there = bits(h, 0, 8) < chance
    crowded = chance > 0.9
    radius = np.where(crowded, 0.37 + 0.13 * bits(h, 8, 6), 0.2 + 0.24 * bits(h, 8, 6)).astype(np.float32)
    slack = (np.float32(0.5) - radius) * np.where(crowded, np.float32(1), np.float32(0.4))
    x = np.float32(0.5) + slack * (bits(h, 14, 9) * np.float32(2) - np.float32(1))
    y = np.float32(0.5) + slack * (bits(h, 23, 9) * np.float32(2) - np.float32(1))
    tone = np.float32(0.80) + np.float32(0.4) * bits(k, 0, 8)
    hue = bits(k, 8, 8) - np.float32(0.5)
    return cells, Crowns(window, there, x, y, radius, tone, hue)


class _Drawn:
    """Crowns' attributes at the samples: all of them, or, where crowns are few, those near one."""

    def __init__(self, cells: Cells, crowns: Crowns) -> None:
        self.cells, self.crowns = cells, crowns
        self.dense = crowns.there.mean() > 0.25
        if not self.dense:
            near = np.broadcast_to(cells.spread(crowns.there, crowns.window), self.inner())
            self.at = np.flatnonzero(near)

    def inner(self) -> tuple[int, ...]:
        return np.broadcast_shapes(
            self.cells.spread(self.crowns.there, self.crowns.window).shape,
            self.cells.fx.shape,
            self.cells.fy.shape,
        )

    def take(self, table: Array) -> Array:
        spread = self.cells.spread(table, self.crowns.window)
        if self.dense:
            return spread
        out: Array = np.broadcast_to(spread, self.inner()).ravel()[self.at]
        return out

    def fraction(self) -> tuple[Array, Array]:
        if self.dense:
            return self.cells.fx, self.cells.fy
        inner = self.inner()
        return np.broadcast_to(self.cells.fx, inner).ravel()[self.at], np.broadcast_to(
            self.cells.fy, inner
        ).ravel()[self.at]


def draw(
    canvas: Canvas,
    cells: Cells,
    crowns: Crowns,
    pixel_m: float,
    leaf: Array | None,
    contrast: float,
    canopy: Array,
) -> None:
    """Draw crowns, lit from the north-west, and their shadows."""
    if not crowns.there.any():
        return
    drawn = _Drawn(cells, crowns)
    radius = np.where(crowns.there, crowns.radius, np.float32(1e-3))
    fx, fy = drawn.fraction()
    shadow_cells = np.float32(_SHADOW_M / CELL_M)
    inverse = drawn.take(np.float32(1) / radius)
    dx = (fx - drawn.take(crowns.x)) * inverse
    dy = (fy - drawn.take(crowns.y)) * inverse
    sharp = drawn.take(radius * np.float32(0.5 * CELL_M / pixel_m))
    shift = shadow_cells * inverse
    q = dx * dx + dy * dy
    cover = np.clip((np.float32(1) - q) * sharp + np.float32(0.5), 0.0, 1.0)
    if pixel_m < 2.0:
        sx, sy = dx - shift, dy - shift
        shade = np.clip((np.float32(1) - (sx * sx + sy * sy)) * sharp + np.float32(0.5), 0.0, 1.0)
        shade *= np.float32(0.55)
        _blend(canvas, drawn, shade, (18, 24, 22))
    light = np.float32(1.0) - np.float32(0.30) * np.minimum(q, np.float32(1)) - np.float32(0.30) * (dx + dy)
    if leaf is not None:
        rough = leaf.reshape(drawn.inner()) if drawn.dense else leaf.ravel()[drawn.at]
        light = light + rough * np.float32(0.55)
    light = (light * np.float32(contrast) + np.float32((1 - contrast) * _MEAN_LIGHT)) * np.float32(
        1 / _MEAN_LIGHT
    )
    light = light * drawn.take(np.float32(1) + (crowns.tone - np.float32(1)) * np.float32(contrast))
    hue = drawn.take(crowns.hue)
    _blend(
        canvas,
        drawn,
        cover,
        [light * (np.float32(c) + hue * np.float32(s)) for c, s in zip(canopy, (30.0, 16.0, 4.0))],
    )


def _blend(canvas: Canvas, drawn: _Drawn, cover: Array, colour: object) -> None:
    for plane, ink in zip(canvas.planes, colour):  # type: ignore[call-overload]
        if drawn.dense:
            view = plane.reshape(drawn.inner())
            step = ink - view
            step *= cover
            view += step
        else:
            old = plane[drawn.at]
            plane[drawn.at] = old + cover * (ink - old)
