"""The three styles: satellite imagery, a street map in flat colours, and hill-shaded relief."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from . import climate, objects
from .climate import height
from .division import HALF_WIDTH_M, HEDGE, LANE, MAIN, ROAD, TRACK, farm_mean
from .lattice import Array, LatticeWindow, cell_hash, mix, refine, salt, signed
from .objects import footprints
from .paint import Canvas
from .region import neighbourhood
from .samples import Grid, Positions, shared
from .scene import PARCEL_ZOOM, Scene
from .sunlight import Lighting, lighting, shine

#: Function that paints a scene in one style.
Painter = Callable[[Scene], Canvas]

#: Level of the coarsest octave of speckle, 2.4 km.
_SPECKLE_FIRST = 14
#: Samples of a period of field stripes.
_STRIPE_COUNT = 8192
#: Samples of field stripes per pixel.
_STRIPES_PER_PX = 4
#: Colour of woods in satellite imagery.
_CANOPY = (50, 68, 40)
#: Colour of water on street maps and relief.
WATER = (156, 200, 227)


def speckle(seed: int, samples: Positions, last_level: int) -> Array | None:
    """Evaluate texture of all scales from 2.4 km down to `last_level`, with a standard deviation of 0.1 an octave."""
    if last_level < _SPECKLE_FIRST:
        return None
    return samples.spline(*_speckle(seed, last_level, *neighbourhood(samples)))


def _octave(seed: int, window: LatticeWindow) -> Array:
    i, j = window.indices()
    noise = signed(cell_hash(salt(seed, 5), window.level, i, j))
    noise *= np.float32(0.36)
    return noise


@shared(32)
def _speckle(seed: int, level: int, zoom: int, x: int, y: int) -> tuple[Array, LatticeWindow]:
    """Coefficients of speckle at `level` over a tile of any zoom."""
    windows = [Grid(zoom, x, y).cells(level).support()]
    while windows[-1].level > _SPECKLE_FIRST:
        windows.append(windows[-1].parent())
    coarse = windows.pop()
    c: Array = _octave(seed, coarse)
    for window in reversed(windows):
        c, coarse = refine(c, coarse, window), window
        c += _octave(seed, window)
    return c, coarse


@shared(32)
def _stripe_table(seed: int, pixel_m: float) -> Array:
    """One period of the stripes at a pixel size, without bands too narrow for a pixel."""
    # Spacing in metres and strength of each band.
    bands = ((48.0, 0.5), (22.0, 0.55), (9.0, 0.6), (4.2, 0.55), (2.0, 0.5), (0.9, 0.45), (0.4, 0.4))
    at = np.arange(_STRIPE_COUNT) / _STRIPES_PER_PX
    out = np.zeros(_STRIPE_COUNT, dtype=np.float32)
    period_px = _STRIPE_COUNT // _STRIPES_PER_PX
    for band, (spacing_m, strength) in enumerate(bands):
        wave_px = spacing_m / pixel_m
        weight = min(max((wave_px - 2.0) / 2.0, 0.0), 1.0) * strength
        if weight == 0.0:
            continue
        count = max(round(period_px / wave_px), 4)
        cell = at * (count / period_px)
        k = np.floor(cell).astype(np.int64)
        f = (cell - k).astype(np.float32)
        f = f * f * (np.float32(3) - np.float32(2) * f)
        value = signed(mix((np.arange(count + 1) % count).astype(np.uint32) + np.uint32(salt(seed, 6, band))))
        out += np.float32(weight) * (value[k] * (np.float32(1) - f) + value[k + 1] * f)
    out.flags.writeable = False
    return out


def stripes(seed: int, across_m: Array, pixel_m: float) -> Array:
    """Evaluate stripes by the distance across them, in metres."""
    place = across_m * np.float32(_STRIPES_PER_PX / pixel_m)
    index = place.astype(np.int32)
    index &= _STRIPE_COUNT - 1
    out: Array = _stripe_table(seed, pixel_m).take(index.astype(np.intp), mode="clip")
    return out


def satellite(scene: Scene) -> Canvas:
    """Paint the land, then water, then roads, buildings and trees, and light them where there is a sun."""
    lit = lighting(scene)
    canvas = unlit_satellite(scene, lit)
    if lit is not None:
        shine(canvas, scene, lit)
    return canvas


def unlit_satellite(scene: Scene, lit: Lighting | None) -> Canvas:
    """Paint a picture without the light of a sun, and what roofs and crowns turn to it."""
    zoom = scene.samples.zoom
    return _Land(scene, lit).paint() if zoom >= PARCEL_ZOOM else _paint_overview(scene)


def _farm_colour(f: dict[str, Array]) -> Array:
    dry = climate.dryness(f)
    return farm_mean(dry.ravel()).reshape(3, *dry.shape)


def _paint_overview(scene: Scene) -> Canvas:
    region, samples = scene.region, scene.samples
    canvas = Canvas(region.smooth(climate.natural_colour, samples), samples.shape)
    canvas.blend(region.smooth(climate.rural_share, samples), region.smooth(_farm_colour, samples))
    woods = scene.woods
    if woods is not None:
        canvas.blend(woods, _CANOPY)
    canvas.lighten(_light(scene))
    _paint_water(canvas, scene)
    return canvas


def _light(scene: Scene) -> Array:
    return np.float32(1) + scene.shade() * np.float32(0.36)


def _paint_water(canvas: Canvas, scene: Scene) -> None:
    sea = scene.sea
    if sea is not None:
        canvas.blend(sea, scene.region.smooth(climate.sea_colour, scene.samples))
    canvas.blend(scene.lakes, (44, 66, 76))
    canvas.blend(scene.rivers, (62, 84, 82))


class _Land:
    """Painter of a scene at zooms that show parcels."""

    def __init__(self, scene: Scene, lit: Lighting | None) -> None:
        self.scene, self.parcels, self.lit = scene, scene.parcels, lit
        self.pixel_m, self.zoom = scene.pixel_m, scene.samples.zoom
        self.looks = self.parcels.division.looks

    def paint(self) -> Canvas:
        scene = self.scene
        seed, samples = scene.seed, scene.samples
        self.speckle = speckle(seed, samples, min(self.zoom + 6, 28))
        canvas = Canvas([self.parcels.take(c) for c in self.looks.colour], samples.shape)
        wild = self.parcels.leaf(self.looks.wild)
        if wild.any():
            canvas.blend(self.parcels.spread(wild), scene.region.smooth(climate.natural_colour, samples))
        canvas.lighten(self._texture())
        self._lines(canvas)
        woods = scene.woods
        if woods is not None:
            floor = (44, 52, 32)
            canvas.blend(woods, floor if self.zoom >= objects.FIRST_ZOOM else _CANOPY)
        _paint_water(canvas, scene)
        self._roads(canvas)
        self._buildings(canvas)
        if self.zoom >= objects.FIRST_ZOOM:
            self._trees(canvas)
        return canvas

    def _texture(self) -> Array:
        """Lightness of the ground: stripes along the rows of fields, speckle, and slopes."""
        looks, parcels = self.looks, self.parcels
        light = _light(self.scene)
        if self.speckle is not None:
            light += self.speckle * parcels.take(looks.speckle)
        strength = parcels.leaf(looks.stripes)
        if self.zoom >= 13 and strength.any():
            across = parcels.x * parcels.take(looks.cos)
            across += parcels.y * parcels.take(looks.sin)
            light += stripes(self.scene.seed, across, self.pixel_m) * parcels.spread(strength)
        return light

    def _lines(self, canvas: Canvas) -> None:
        for line, colour in ((TRACK, (176, 156, 122)), (HEDGE, (62, 80, 44))):
            d = self.parcels.distance_m(line)
            if d is not None:
                canvas.stroke(d, self.pixel_m, (HALF_WIDTH_M[line], 0.8, colour))

    def _roads(self, canvas: Canvas) -> None:
        asphalt = {LANE: (150, 146, 140), ROAD: (128, 126, 124), MAIN: (112, 112, 112)}
        verge, marking = (138, 138, 92), (224, 206, 130)
        lines = [(line, self.parcels.distance_m(line)) for line in asphalt]
        for line, d in lines:
            if d is not None:
                canvas.stroke(d, self.pixel_m, (HALF_WIDTH_M[line] + 2.0, 0.6, verge))
        for line, d in lines:
            if d is not None:
                strokes = [(HALF_WIDTH_M[line], 1.0, asphalt[line])]
                if line == MAIN and self.zoom >= 18:
                    strokes.append((0.2, 0.7, marking))
                canvas.stroke(d, self.pixel_m, *strokes)
        canvas.blend(self.scene.motorway, (134, 132, 130))

    def _buildings(self, canvas: Canvas) -> None:
        prints = footprints(self.parcels)
        if prints is None:
            return
        if self.lit is not None:
            at, near = prints.nearby(0.0)
            cover = near.cover()
            canvas.touch(at, (cover, near.roofs(is_lit=False)))
            self.lit.facing.touch(at, (cover, [near.facing(self.lit.sun)]))
            return
        at, near = prints.nearby(objects.SHADOW_M)
        layers: list[tuple[Array, Array | Sequence[float | Array]]] = [(near.cover(), near.roofs())]
        if self.zoom >= 15:
            layers.insert(0, (near.cover(moved_m=objects.SHADOW_M) * np.float32(0.6), (26, 30, 34)))
        canvas.touch(at, *layers)

    def _trees(self, canvas: Canvas) -> None:
        contrast = 0.55 if self.zoom == objects.FIRST_ZOOM else 1.0
        canopy = np.array(_CANOPY, dtype=np.float32)
        toward = None if self.lit is None else (self.lit.sun, self.lit.facing)
        for cells, crowns in objects.plant(self.scene):
            objects.draw(canvas, cells, crowns, self.pixel_m, self.speckle, contrast, canopy, toward)


def roadmap(scene: Scene) -> Canvas:
    """Draw a street map in flat colours."""
    canvas = Canvas((242, 240, 233), scene.samples.shape)
    drawn = scene.samples.zoom >= PARCEL_ZOOM
    if drawn:
        town = scene.parcels.leaf(scene.parcels.division.looks.town)
        if town.any():
            canvas.blend(scene.parcels.spread(town), (229, 227, 224))
    canvas.blend(scene.woods, (196, 224, 186))
    canvas.blend(scene.sea, WATER)
    canvas.blend(scene.lakes, WATER)
    canvas.blend(scene.rivers, WATER)
    if drawn:
        _draw_buildings(canvas, scene)
        _draw_roads(canvas, scene)
    canvas.blend(scene.motorway, (245, 176, 106))
    return canvas


def _draw_buildings(canvas: Canvas, scene: Scene) -> None:
    prints = footprints(scene.parcels)
    if prints is not None:
        edge, inside = (176, 170, 164), (206, 202, 197)
        for colour, grow in ((edge, 0.0), (inside, -0.7)):
            canvas.blend(prints.cover(grow_m=grow), colour)


def _draw_roads(canvas: Canvas, scene: Scene) -> None:
    parcels, p = scene.parcels, scene.pixel_m
    track, casing = (214, 204, 186), (201, 196, 188)
    fills = {LANE: (255, 255, 255), ROAD: (255, 250, 208), MAIN: (252, 220, 132)}
    lines = {line: parcels.distance_m(line) for line in (TRACK, *fills)}
    for line, d in lines.items():
        if d is not None:
            ink, wider = (track, 0.0) if line == TRACK else (casing, 1.4)
            canvas.stroke(d, p, (HALF_WIDTH_M[line] + wider, 1.0, ink))
    for line, fill in fills.items():
        d = lines[line]
        if d is not None:
            canvas.stroke(d, p, (HALF_WIDTH_M[line], 1.0, fill))


def terrain(scene: Scene) -> Canvas:
    """Draw hypsometric tints with hill shading, water, woods and faint roads."""
    up = scene.region.smooth(height, scene.samples)
    tints = (
        (0.0, (190, 206, 172)),
        (0.06, (206, 214, 178)),
        (0.18, (224, 216, 176)),
        (0.4, (212, 190, 152)),
        (0.7, (190, 166, 142)),
        (1.0, (236, 234, 236)),
    )
    stops = np.array([s for s, _ in tints])
    tint = np.stack([np.interp(up, stops, [c[k] for _, c in tints]) for k in range(3)])
    canvas = Canvas(tint, scene.samples.shape)
    woods = scene.woods
    if woods is not None:
        canvas.blend(woods * np.float32(0.35), (150, 186, 132))
    shade = scene.shade()
    light = np.float32(1) + shade * np.float32(0.3)
    canvas.lighten(light)
    canvas.blend(scene.sea, WATER)
    canvas.blend(scene.lakes, WATER)
    canvas.blend(scene.rivers, WATER)
    return canvas
