"""Buildings with their shadows and roofs, and the crowns of trees."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .division import HALF_WIDTH_M, HEDGE, LANE, MAIN, ROAD
from .lattice import WORLD_M, Array, LatticeWindow, bits, cell_hash, salt
from .paint import Canvas, clip01
from .parcels import Parcels, root_squares
from .rays import ChartSun
from .region import Region, neighbourhood
from .samples import Few, LatticeCells, TilePositions, shared
from .scene import Scene

#: Level of the lattice of trees: cells of 9.6 m hold a crown each.
LEVEL = 22
CELL_M = WORLD_M / (1 << LEVEL)
#: Zoom from which crowns are drawn one by one; at lower zooms woods are an even canopy.
FIRST_ZOOM = 15
#: Length of shadows southward and eastward.
SHADOW_M = 2.6
#: Height of walls, and of the middle of crowns, in Mercator metres. With the sun at 50 degrees, this height casts
#: shadows of `SHADOW_M` southward and eastward.
EAVES_M = 4.4
#: Rise of gables, metre per metre: 35 degrees.
GABLE_RISE = 0.7
#: Rise of a crown from its edge to its middle, per radius, as light meets it: leaves scatter it.
_CROWN_RISE = 0.6
#: Probability of a tree above which a cell counts as wood, whose crowns are wide and touch.
_WOODED = 0.9


@dataclass(frozen=True)
class BuildingOutlines:
    """Buildings at samples.

    Attributes
    ----------
    index : intp array
        Piece of each sample, as in `Parcels.index`.
    west, east, north, south : float32 arrays
        Distance of each sample inside each side of its piece's building, in metres.
    """

    parcels: Parcels
    index: Array
    west: Array
    east: Array
    north: Array
    south: Array

    def nearby(self, moved_m: float) -> tuple[Array, BuildingOutlines]:
        """Return the flat indices of samples at or near buildings, and the buildings at these only.

        The buildings cover no other samples, neither in place nor moved `moved_m` south and east.
        """
        margin = -0.6 * self.parcels.pixel_m
        on = np.minimum(self.west, self.north) > np.float32(margin)
        on &= np.minimum(self.east, self.south) > np.float32(margin - moved_m)
        at = np.flatnonzero(on)
        values = (self.index, self.west, self.east, self.north, self.south)
        return at, BuildingOutlines(self.parcels, *(value.take(at, mode="clip") for value in values))

    def cover(self, moved_m: float = 0.0, grow_m: float = 0.0) -> Array:
        """Coverage by the buildings, moved south and east, and grown on each side, by some metres."""
        more, less = np.float32(grow_m - moved_m), np.float32(grow_m + moved_m)
        half, p = np.float32(0.5), np.float32(1.0 / self.parcels.pixel_m)
        # If pixels are smaller than 2.5 m, buildings are many pixels wide: the nearest edge alone decides coverage.
        if p > 1 / 2.5:
            out = np.minimum(self.west, self.north)
            out += more - less
            np.minimum(out, self.east, out=out)
            np.minimum(out, self.south, out=out)
            out += less
            out *= p
            out += half
            return clip01(out)
        cx = clip01((self.west + more) * p + half)
        cx -= clip01(half - (self.east + less) * p)
        cy = clip01((self.north + more) * p + half)
        cy -= clip01(half - (self.south + less) * p)
        cx *= cy
        return np.asarray(np.maximum(cx, np.float32(0), out=cx))

    def _entries(self, table: Array) -> Array:
        return np.asarray(self.parcels.leaf(table).take(self.index, mode="clip"))

    def _across(self) -> Array:
        """Side of the gable: -1 north or west of the ridge, 1 beyond it, and between within a pixel of it."""
        is_ridge_x = self._entries(self.parcels.division.looks.buildings.ridge_x)
        across = np.where(is_ridge_x, self.north - self.south, self.west - self.east)
        across *= np.float32(0.5) * np.float32(1.0 / self.parcels.pixel_m)
        np.maximum(across, np.float32(-1), out=across)
        return np.asarray(np.minimum(across, np.float32(1), out=across))

    def roofs(self, *, is_lit: bool = True) -> list[Array]:
        """Roof colours at the samples, red, green and blue; if lit, the sides of a gable differ in light."""
        buildings = self.parcels.division.looks.buildings
        if not is_lit:
            return [self._entries(channel) for channel in buildings.roof]
        across = self._across()
        across *= self._entries(buildings.pitch)
        light = np.float32(1) - across
        return [self._entries(channel) * light for channel in buildings.roof]

    def facing(self, sun: ChartSun) -> Array:
        """Cosine of the angle between roofs and the sun, over that of level ground."""
        buildings = self.parcels.division.looks.buildings
        toward = np.where(self._entries(buildings.ridge_x), np.float32(sun.south), np.float32(sun.east))
        level = np.float32(1.0 / np.hypot(1.0, GABLE_RISE))
        gable = level + self._across() * toward * (level * np.float32(GABLE_RISE / sun.tangent))
        return np.asarray(np.where(self._entries(buildings.pitch) == 0, np.float32(1), gable))

    def heights_m(self) -> Array:
        """Heights of roofs above the ground, in the chart's metres."""
        buildings = self.parcels.division.looks.buildings
        inside = np.where(
            self._entries(buildings.ridge_x), np.minimum(self.north, self.south), np.minimum(self.west, self.east)
        )
        rise = np.maximum(inside, np.float32(0)) * np.float32(GABLE_RISE)
        return np.asarray(np.float32(EAVES_M) + np.where(self._entries(buildings.pitch) == 0, np.float32(0), rise))


def footprints(parcels: Parcels) -> BuildingOutlines | None:
    """Return the buildings at samples; None if no building is in reach."""
    buildings = parcels.division.looks.buildings
    x0, x1, y0, y1 = (parcels.leaf(edge) for edge in (buildings.x0, buildings.x1, buildings.y0, buildings.y1))
    # Shadows of buildings, and their distance to trees, reach less than 8 m.
    in_reach = parcels.leaf(buildings.there) & parcels.touched(x0, x1, y0, y1, 8.0 + parcels.pixel_m)
    if not in_reach.any():
        return None
    return BuildingOutlines(
        parcels,
        parcels.index,
        parcels.x - parcels.local(np.where(in_reach, x0, np.inf), 0),
        parcels.local(x1, 0) - parcels.x,
        parcels.y - parcels.local(y0, 1),
        parcels.local(y1, 1) - parcels.y,
    )


@dataclass(frozen=True)
class Crowns:
    """Trees of blocks of cells: arrays (..., rows, columns); centres and radii in cells.

    `i0`, `j0`, shape (...), are the column and row of each block's first cell.
    """

    i0: Array
    j0: Array
    there: Array
    x: Array
    y: Array
    radius: Array
    tone: Array
    hue: Array

    def crop(self, block: int, window: LatticeWindow) -> Crowns:
        """Return the trees of a window of one of the blocks."""
        i, j = window.i0 - int(self.i0[block]), window.j0 - int(self.j0[block])
        at = (block, slice(j, j + window.rows), slice(i, i + window.columns))
        tables = (self.there, self.x, self.y, self.radius, self.tone, self.hue)
        return Crowns(self.i0[block] + i, self.j0[block] + j, *(table[at] for table in tables))


def _chance(scene: Scene) -> Array:
    """Probability of a tree in each cell of a scene of cells."""
    shape = scene.samples.shape
    chance = np.full(shape, 0.006, dtype=np.float32)
    parcels = scene.parcels
    town = parcels.leaf(parcels.division.looks.town)
    if town.any():
        np.maximum(chance, parcels.spread(town) * np.float32(0.30), out=chance)
    d = parcels.distance_m(HEDGE)
    if d is not None:
        chance[d < 5.5] = 0.55
    woods = scene.woods
    if woods is not None:
        np.maximum(chance, (woods > 0.5) * np.float32(0.97), out=chance)
    for line in (LANE, ROAD, MAIN):
        d = parcels.distance_m(line)
        if d is not None:
            chance[d < HALF_WIDTH_M[line] + 3.2] = 0.0
    prints = footprints(parcels)
    if prints is not None:
        chance[prints.cover(moved_m=1.5, grow_m=4.4) > 0.5] = 0.0
    for cover in (scene.water(), scene.motorway):
        if cover is not None:
            chance[cover > 0.02] = 0.0
    return chance


def plant(scene: Scene) -> list[tuple[LatticeCells, Crowns]]:
    """Plant trees in the cells under a scene's samples, and in woods also between the cells."""
    samples = scene.samples
    zoom, x, y = neighbourhood(samples)
    up = samples.zoom - zoom
    tile = ((samples.y - (y << up)) << up) + samples.x - (x << up)
    planted = []
    for crowns, shifted in zip(_stand(scene.seed, samples.zoom, zoom, x, y), (False, True)):
        cells = samples.cells(LEVEL, shifted)
        planted.append((cells, crowns.crop(tile, cells.window())))
    return planted


@shared(32)
def _stand(seed: int, zoom: int, around: int, x: int, y: int) -> tuple[Crowns, Crowns]:
    """Plant all tiles of `zoom`, row by row, in a tile of zoom `around`: in cells, and in the middle of four cells."""
    up = zoom - around
    step = np.arange(1 << up, dtype=np.int64)
    rows, columns = (a.ravel() for a in np.meshgrid((y << up) + step, (x << up) + step, indexing="ij"))
    chance, tiles = _chances(seed, zoom, columns, rows)
    i, j = tiles.columns, tiles.rows
    dense = chance > _WOODED
    dense = dense[:, :-1, :-1] & dense[:, 1:, :-1] & dense[:, :-1, 1:] & dense[:, 1:, 1:]
    inside = slice(1, -1)
    return (
        _grow(seed, i[..., inside], j[:, inside], chance[:, inside, inside], 0),
        _grow(seed, i[..., 1:], j[:, 1:], dense * np.float32(0.96), 1),
    )


def _chances(seed: int, zoom: int, x: Array, y: Array) -> tuple[Array, TilePositions]:
    """Probability of a tree in each cell of tiles and of a margin of one cell; and the cells."""
    tiles = TilePositions(zoom, x, y, LEVEL)
    chance = np.empty(tiles.shape, dtype=np.float32)
    # Land is divided for the root squares that a tile touches: group tiles that touch the same squares.
    squares = root_squares(Region.around(seed, tiles), tiles)
    for alike in np.unique(squares, axis=0):
        at = np.flatnonzero((squares == alike).all(axis=1))
        chance[at] = _chance(Scene(seed, TilePositions(zoom, x[at], y[at], LEVEL)))
    return chance, tiles


def _grow(seed: int, i: Array, j: Array, chance: Array, number: int) -> Crowns:
    h = cell_hash(salt(seed, 7, number), LEVEL, i, j)
    k = cell_hash(salt(seed, 8, number), LEVEL, i, j)
    has_tree = bits(h, 0, 8) < chance
    crowded = chance > _WOODED
    radius = np.where(crowded, 0.37 + 0.13 * bits(h, 8, 6), 0.2 + 0.24 * bits(h, 8, 6)).astype(np.float32)
    slack = (np.float32(0.5) - radius) * np.where(crowded, np.float32(1), np.float32(0.4))
    x = np.float32(0.5) + slack * (bits(h, 14, 9) * np.float32(2) - np.float32(1))
    y = np.float32(0.5) + slack * (bits(h, 23, 9) * np.float32(2) - np.float32(1))
    tone = np.float32(0.80) + np.float32(0.4) * bits(k, 0, 8)
    hue = bits(k, 8, 8) - np.float32(0.5)
    return Crowns(i[:, 0, 0], j[:, 0, 0], has_tree, x, y, radius, tone, hue)


class _Drawn:
    """Attributes of crowns at all samples or, where crowns are few, at the samples in cells with a crown."""

    def __init__(self, canvas: Canvas, cells: LatticeCells, crowns: Crowns) -> None:
        self.canvas, self.cells = canvas, cells
        self.fx, self.fy = cells.fx, cells.fy
        self.few: Few | None = None
        # Gathering is faster for up to a quarter of the cells.
        if float(crowns.there.mean()) <= 0.25:
            self.few = cells.among(crowns.there)
            self.fx, self.fy = self.few.fx, self.few.fy

    def take(self, table: Array) -> Array:
        return self.cells.spread(table, self.cells.window()) if self.few is None else table[self.few.cells]

    def sample(self, values: Array) -> Array:
        return values.reshape(self.cells.inner()) if self.few is None else values.take(self.few.at, mode="clip")

    def placed(self, crowns: Crowns, pixel_m: float) -> tuple[Array, Array, Array, Array]:
        """Inverse radii, offsets from the centres in radii, and half radii in pixels."""
        radius = np.where(crowns.there, crowns.radius, np.float32(1e-3))
        inverse = self.take(np.float32(1) / radius)
        dx = (self.fx - self.take(crowns.x)) * inverse
        dy = self.fy - self.take(crowns.y)
        dy *= inverse
        return inverse, dx, dy, self.take(radius * np.float32(0.5 * CELL_M / pixel_m))

    def blend(self, cover: Array, colour: Sequence[float | Array]) -> None:
        self.blend_on(self.canvas, cover, colour)

    def blend_on(self, canvas: Canvas, cover: Array, colour: Sequence[float | Array]) -> None:
        if self.few is not None:
            canvas.touch(self.few.at, (cover, colour))
            return
        for plane, ink in zip(canvas.planes, colour):
            view = plane.reshape(self.cells.inner())
            step = np.float32(ink) - view if np.ndim(ink) == 0 else ink - view
            step *= cover
            view += step


def draw(
    canvas: Canvas,
    cells: LatticeCells,
    crowns: Crowns,
    pixel_m: float,
    leaf: Array | None,
    contrast: float,
    canopy: Array,
    lit: tuple[ChartSun, Canvas] | None = None,
) -> None:
    """Draw crowns.

    They are lit from the north-west, with shadows unless they are dense; or, where there is a sun, without light, and
    what they turn to it is drawn on the canvas given with it.
    """
    if not crowns.there.any():
        return
    drawn = _Drawn(canvas, cells, crowns)
    one = np.float32(1)
    inverse, dx, dy, sharp = drawn.placed(crowns, pixel_m)
    if lit is None and pixel_m < SHADOW_M and drawn.few is not None:
        shift = np.float32(SHADOW_M / CELL_M) * inverse
        sx, sy = dx - shift, dy - shift
        shade = (one - (sx * sx + sy * sy)) * sharp
        shade += np.float32(0.5)
        drawn.blend(clip01(shade) * np.float32(0.55), (18, 24, 22))
    q = dy * dy
    q += dx * dx
    cover = one - q
    cover *= sharp
    cover += np.float32(0.5)
    clip01(cover)
    light = np.minimum(q, one, out=q)
    if lit is None:
        light += dy
        light += dx
    else:
        sun, facing = lit
        toward = dx * np.float32(sun.east) + dy * np.float32(sun.south)
        toward *= np.float32(_CROWN_RISE * contrast / sun.tangent)
        toward += one
        toward /= np.sqrt(one + light * np.float32((_CROWN_RISE * contrast) ** 2))
        drawn.blend_on(facing, cover, [toward])
    light *= np.float32(-0.30)
    light += one
    if leaf is not None:
        light += drawn.sample(leaf) * np.float32(0.55)
    # Divided by the mean lightness of a crown, 0.86, woods are as light as the even canopy of lower zooms.
    light *= np.float32(contrast / 0.86)
    light += np.float32(1 - contrast)
    light *= drawn.take(one + (crowns.tone - one) * np.float32(contrast))
    hues = (30.0, 16.0, 4.0)
    drawn.blend(cover, [light * drawn.take(np.float32(c) + crowns.hue * np.float32(s)) for c, s in zip(canopy, hues)])


def raise_crowns(canvas: Canvas, cells: LatticeCells, crowns: Crowns, pixel_m: float) -> None:
    """Blend crowns over a canvas of heights above the ground: domes as high as their shadows are long."""
    if not crowns.there.any():
        return
    drawn = _Drawn(canvas, cells, crowns)
    one = np.float32(1)
    inverse, dx, dy, sharp = drawn.placed(crowns, pixel_m)
    inside = one - (dx * dx + dy * dy)
    cover = clip01(inside * sharp + np.float32(0.5))
    dome = np.sqrt(np.maximum(inside, np.float32(0))) * (np.float32(CELL_M) / inverse)
    drawn.blend(cover, [dome + np.float32(EAVES_M)])
