"""The caps about the poles in the three styles: ice over the landscape of a polar chart.

Where it is warm enough that landscape is painted as that of the map is.
"""

from __future__ import annotations

import numpy as np

from . import stations, styles
from .climate import open_water
from .ice import Ice, blue, icy
from .paint import Canvas, ramp
from .scene import Scene

_SNOW, _BLUE_ICE, _ROCK = (208, 216, 225), (158, 189, 210), (112, 102, 94)
_CREVASSE, _BRIDGE = (74, 112, 146), (206, 217, 228)
_FLOE, _YOUNG_ICE = (220, 227, 234), (126, 150, 168)
_PACKED_SNOW, _SHADOW = (206, 214, 224), (96, 116, 142)
_HOUSES = (
    (178, 52, 40),
    (204, 108, 40),
    (52, 96, 140),
    (62, 110, 78),
    (150, 40, 44),
    (214, 168, 52),
    (92, 98, 108),
)
ICE, PACK_ICE, BARE_ROCK, CREVASSE_INK = (246, 249, 252), (220, 234, 243), (226, 220, 210), (170, 198, 220)
_TINT_ICE, _TINT_ROCK = (222, 230, 237), (200, 184, 164)


def satellite(scene: Scene) -> Canvas:
    """Paint ice as seen from the air, over the land and sea that it covers."""
    return _covered(scene, styles.satellite, _photographed)


def roadmap(scene: Scene) -> Canvas:
    """Draw ice in flat colours."""
    return _covered(scene, styles.roadmap, _mapped)


def terrain(scene: Scene) -> Canvas:
    """Draw ice with hill shading."""
    return _covered(scene, styles.terrain, _shaded)


def _covered(scene: Scene, bare: styles.Painter, iced: styles.Painter) -> Canvas:
    """Paint ice where it is, and the landscape elsewhere."""
    low, high = scene.region.derived_span(icy, scene.samples)
    soft = 0.006 + 1.0e-6 * scene.pixel_m
    if high < -soft:
        return bare(scene)
    if low > soft:
        return iced(scene)
    canvas = bare(scene)
    canvas.blend(ramp(scene.region.smooth(icy, scene.samples), soft), iced(scene).planes)
    return canvas


def _photographed(scene: Scene) -> Canvas:
    ice, region, samples = Ice(scene), scene.region, scene.samples
    canvas = Canvas(_SNOW, samples.shape)
    if ice.on_land:
        canvas.blend(region.smooth(blue, samples), _BLUE_ICE)
        light = np.float32(1) + scene.shade() * np.float32(0.15)
        drifts = ice.drifts()
        if drifts is not None:
            light += drifts * np.float32(0.06)
        light += ice.speckle * np.float32(0.032)
        cracks = ice.crevasses()
        if cracks is not None:
            canvas.blend(np.sqrt(cracks) * np.float32(0.5), _BRIDGE)
            canvas.blend(cracks, _CREVASSE)
        canvas.lighten(light)
        rock = ice.rock()
        if rock is not None:
            ground = np.float32(1) + scene.shade() * np.float32(0.42) + ice.speckle * np.float32(0.22)
            canvas.blend(rock, np.stack([ground * np.float32(c) for c in _ROCK]))
    if ice.sea is not None:
        floe, young, tone = ice.floes
        tone = tone + ice.speckle * np.float32(0.025)
        drifts = ice.drifts()
        if drifts is not None:
            tone += drifts * np.float32(0.03)
        colour = region.smooth(open_water, samples)
        for channel in range(3):
            colour[channel] += young * (np.float32(_YOUNG_ICE[channel]) - colour[channel])
            colour[channel] += floe * (tone * np.float32(_FLOE[channel]) - colour[channel])
        canvas.blend(ice.sea, colour)
    stations.paint(canvas, scene, [_PACKED_SNOW, *_HOUSES], _SHADOW)
    return canvas


def _mapped(scene: Scene) -> Canvas:
    ice, samples = Ice(scene), scene.samples
    canvas = Canvas(ICE, samples.shape)
    if ice.on_land:
        canvas.blend(ice.crevasses(), CREVASSE_INK)
        canvas.blend(ice.rock(), BARE_ROCK)
    _lay_sea(canvas, ice)
    inks = [styles.TRACK_INK, *([styles.BUILDING] * stations.COLOURS)]
    stations.paint(canvas, scene, inks, None)
    return canvas


def _shaded(scene: Scene) -> Canvas:
    ice, samples = Ice(scene), scene.samples
    canvas = Canvas(_TINT_ICE, samples.shape)
    canvas.blend(ice.rock() if ice.on_land else None, _TINT_ROCK)
    canvas.lighten(np.float32(1) + scene.shade() * np.float32(0.16))
    _lay_sea(canvas, ice)
    return canvas


def _lay_sea(canvas: Canvas, ice: Ice) -> None:
    if ice.sea is None:
        return
    canvas.blend(ice.sea, styles.WATER)
    floe, young, _ = ice.floes
    canvas.blend(ice.sea * (floe + (np.float32(1) - floe) * young * np.float32(0.5)), PACK_ICE)
