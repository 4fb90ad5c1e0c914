"""The world as seen from the air."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from . import climate, trees
from .buildings import footprints
from .detail import speckle, stripes
from .lattice import Array
from .leaves import HALF_WIDTH_M, HEDGE, LANE, MAIN, ROAD, TRACK, farm_mean
from .paint import Canvas
from .scene import PARCEL_ZOOM, Scene

_HEDGE, _SOIL_TRACK = (62, 80, 44), (176, 156, 122)
_ASPHALT = {LANE: (150, 146, 140), ROAD: (128, 126, 124), MAIN: (112, 112, 112)}
_VERGE = (138, 138, 92)
_MARKING, _MOTORWAY = (224, 206, 130), (134, 132, 130)
_RIVER = (62, 84, 82)
_LAKE = (44, 66, 76)
_SHADOW, _SHADOW_M = (26, 30, 34), 2.6
_FLOOR = (44, 52, 32)


def satellite(scene: Scene) -> Canvas:
    """Paint the land, then water, then what stands on it."""
    zoom = scene.samples.zoom
    return _Land(scene).paint() if zoom >= PARCEL_ZOOM else _from_afar(scene)


def _farm_colour(f: dict[str, Array]) -> Array:
    dry = climate.dryness(f)
    return farm_mean(dry.ravel()).reshape(3, *dry.shape)


def _from_afar(scene: Scene) -> Canvas:
    region, samples = scene.region, scene.samples
    canvas = Canvas(region.smooth(climate.natural_colour, samples), samples.shape)
    canvas.blend(region.smooth(climate.rural_share, samples), region.smooth(_farm_colour, samples))
    woods = scene.woods()
    if woods is not None:
        canvas.blend(woods, trees.CANOPY)
    canvas.lighten(_light(scene))
    _paint_water(canvas, scene)
    return canvas


def _light(scene: Scene) -> Array:
    return np.float32(1) + scene.shade() * np.float32(0.36)


def _paint_water(canvas: Canvas, scene: Scene) -> None:
    sea = scene.sea()
    if sea is not None:
        canvas.blend(sea, scene.region.smooth(climate.sea_colour, scene.samples))
    canvas.blend(scene.lakes(), _LAKE)
    canvas.blend(scene.rivers(), _RIVER)


class _Land:
    """Painter of one set of samples at the zooms that show parcels."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.parcels = scene, scene.parcels
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
        woods = scene.woods()
        if woods is not None:
            canvas.blend(woods, _FLOOR if self.zoom >= trees.FIRST_ZOOM else trees.CANOPY)
        _paint_water(canvas, scene)
        self._roads(canvas)
        self._buildings(canvas)
        if self.zoom >= trees.FIRST_ZOOM:
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
        for line, colour in ((TRACK, _SOIL_TRACK), (HEDGE, _HEDGE)):
            d = self.parcels.distance_m(line)
            if d is not None:
                canvas.stroke(d, self.pixel_m, (HALF_WIDTH_M[line], 0.8, colour))

    def _roads(self, canvas: Canvas) -> None:
        lines = [(line, self.parcels.distance_m(line)) for line in (LANE, ROAD, MAIN)]
        for line, d in lines:
            if d is not None:
                canvas.stroke(d, self.pixel_m, (HALF_WIDTH_M[line] + 2.0, 0.6, _VERGE))
        for line, d in lines:
            if d is not None:
                strokes = [(HALF_WIDTH_M[line], 1.0, _ASPHALT[line])]
                if line == MAIN and self.zoom >= 18:
                    strokes.append((0.2, 0.7, _MARKING))
                canvas.stroke(d, self.pixel_m, *strokes)
        canvas.blend(self.scene.motorway(), _MOTORWAY)

    def _buildings(self, canvas: Canvas) -> None:
        prints = footprints(self.parcels)
        if prints is None:
            return
        at, near = prints.near(_SHADOW_M)
        layers: list[tuple[Array, Array | Sequence[float | Array]]] = [(near.cover(), near.roofs())]
        if self.zoom >= 15:
            layers.insert(0, (near.cover(moved_m=_SHADOW_M) * np.float32(0.6), _SHADOW))
        canvas.touch(at, *layers)

    def _trees(self, canvas: Canvas) -> None:
        contrast = 0.55 if self.zoom == trees.FIRST_ZOOM else 1.0
        canopy = np.array(trees.CANOPY, dtype=np.float32)
        for cells, crowns in trees.plant(self.scene):
            trees.draw(canvas, cells, crowns, self.pixel_m, self.speckle, contrast, canopy)
