"""The two drawn styles: a street map in flat colours, and hill-shaded relief."""

from __future__ import annotations

import numpy as np

from .buildings import footprints
from .climate import height
from .leaves import HALF_WIDTH_M, LANE, MAIN, ROAD, TRACK
from .paint import Canvas
from .scene import PARCEL_ZOOM, Scene

LAND = (242, 240, 233)
WATER = (156, 200, 227)
WOOD = (196, 224, 186)
RESIDENTIAL = (229, 227, 224)
BUILDING, BUILDING_EDGE = (206, 202, 197), (176, 170, 164)
TRACK_INK, CASING = (214, 204, 186), (201, 196, 188)
STREET, ROAD_FILL, MAIN_FILL = (255, 255, 255), (255, 250, 208), (252, 220, 132)
MOTORWAY_FILL = (245, 176, 106)
_CASING_M = 1.4


def roadmap(scene: Scene) -> Canvas:
    """Draw the street map."""
    canvas = Canvas(LAND, scene.samples.shape)
    drawn = scene.samples.zoom >= PARCEL_ZOOM
    if drawn:
        town = scene.parcels.leaf(scene.parcels.division.looks.town)
        if town.any():
            canvas.blend(scene.parcels.spread(town), RESIDENTIAL)
    canvas.blend(scene.woods(), WOOD)
    canvas.blend(scene.sea(), WATER)
    canvas.blend(scene.lakes(), WATER)
    canvas.blend(scene.rivers(), WATER)
    if drawn:
        _draw_buildings(canvas, scene)
        _draw_roads(canvas, scene)
    cover = scene.motorway()
    canvas.blend(cover, MOTORWAY_FILL)
    return canvas


def _draw_buildings(canvas: Canvas, scene: Scene) -> None:
    prints = footprints(scene.parcels)
    if prints is not None:
        for colour, grow in ((BUILDING_EDGE, 0.0), (BUILDING, -0.7)):
            canvas.blend(prints.cover(grow_m=grow), colour)


def _draw_roads(canvas: Canvas, scene: Scene) -> None:
    parcels, p = scene.parcels, scene.pixel_m
    lines = {line: parcels.distance_m(line) for line in (TRACK, LANE, ROAD, MAIN)}
    for line, d in lines.items():
        if d is not None:
            ink, wider = (TRACK_INK, 0.0) if line == TRACK else (CASING, _CASING_M)
            canvas.stroke(d, p, (HALF_WIDTH_M[line] + wider, 1.0, ink))
    for line, ink in ((LANE, STREET), (ROAD, ROAD_FILL), (MAIN, MAIN_FILL)):
        d = lines[line]
        if d is not None:
            canvas.stroke(d, p, (HALF_WIDTH_M[line], 1.0, ink))


_TINTS = (
    (0.0, (190, 206, 172)),
    (0.06, (206, 214, 178)),
    (0.18, (224, 216, 176)),
    (0.4, (212, 190, 152)),
    (0.7, (190, 166, 142)),
    (1.0, (236, 234, 236)),
)


def terrain(scene: Scene) -> Canvas:
    """Draw hypsometric tints with hill shading, water, woods and faint roads."""
    up = scene.region.smooth(height, scene.samples)
    stops = np.array([s for s, _ in _TINTS])
    tint = np.stack([np.interp(up, stops, [c[k] for _, c in _TINTS]) for k in range(3)])
    canvas = Canvas(tint, scene.samples.shape)
    woods = scene.woods()
    if woods is not None:
        canvas.blend(woods * np.float32(0.35), (150, 186, 132))
    shade = scene.shade()
    light = np.float32(1) + shade * np.float32(0.3)
    canvas.lighten(light)
    canvas.blend(scene.sea(), WATER)
    canvas.blend(scene.lakes(), WATER)
    canvas.blend(scene.rivers(), WATER)
    return canvas
