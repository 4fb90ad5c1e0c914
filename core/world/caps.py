"""The polar caps in the three styles: ice over the landscape of a polar chart.

Where it is too warm for ice, the landscape is painted as on the map.
"""

from __future__ import annotations

import numpy as np

from . import styles
from .climate import open_water
from .ice import Ice, blue, icy
from .paint import Canvas, ramp
from .scene import Scene
from .sunlight import lighting, shine


def satellite(scene: Scene) -> Canvas:
    """Paint ice as seen from the air, over land and sea."""
    lit = lighting(scene)
    canvas = _covered(scene, lambda bare: styles.unlit_satellite(bare, lit), _photographed)
    if lit is not None:
        shine(canvas, scene, lit)
    return canvas


def roadmap(scene: Scene) -> Canvas:
    """Draw ice in flat colours."""
    return _covered(scene, styles.roadmap, _mapped)


def terrain(scene: Scene) -> Canvas:
    """Draw ice with hill shading."""
    return _covered(scene, styles.terrain, _shaded)


def _covered(scene: Scene, bare: styles.Painter, iced: styles.Painter) -> Canvas:
    """Paint ice where it is cold enough, and the landscape elsewhere."""
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
    canvas = Canvas((208, 216, 225), samples.shape)  # snow
    rough, drifts = ice.speckle * np.float32(0.032), ice.drifts()
    if drifts is not None:
        rough += drifts * np.float32(0.06)
    if ice.on_land:
        canvas.blend(region.smooth(blue, samples), (158, 189, 210))
        cracks = ice.crevasses()
        if cracks is not None:
            canvas.blend(np.sqrt(cracks) * np.float32(0.5), (206, 217, 228))  # snow bridges
            canvas.blend(cracks, (74, 112, 146))
        canvas.lighten(np.float32(1) + scene.shade() * np.float32(0.15) + rough)
        rock = ice.rock()
        if rock is not None:
            ground = np.float32(1) + scene.shade() * np.float32(0.42) + ice.speckle * np.float32(0.22)
            canvas.blend(rock, np.stack([ground * np.float32(c) for c in (112, 102, 94)]))
    if ice.sea is not None:
        pack, colour = ice.pack(), region.smooth(open_water, samples)
        for channel, packed in enumerate((220, 227, 234)):
            light = (np.float32(1) + rough) * np.float32(packed)
            colour[channel] += pack * (light - colour[channel])
        canvas.blend(ice.sea, colour)
    return canvas


def _mapped(scene: Scene) -> Canvas:
    ice, samples = Ice(scene), scene.samples
    canvas = Canvas((246, 249, 252), samples.shape)
    if ice.on_land:
        canvas.blend(ice.crevasses(), (170, 198, 220))
        canvas.blend(ice.rock(), (226, 220, 210))
    _lay_sea(canvas, ice)
    return canvas


def _shaded(scene: Scene) -> Canvas:
    ice, samples = Ice(scene), scene.samples
    canvas = Canvas((222, 230, 237), samples.shape)
    canvas.blend(ice.rock() if ice.on_land else None, (200, 184, 164))
    canvas.lighten(np.float32(1) + scene.shade() * np.float32(0.16))
    _lay_sea(canvas, ice)
    return canvas


def _lay_sea(canvas: Canvas, ice: Ice) -> None:
    if ice.sea is not None:
        canvas.blend(ice.sea, styles.WATER)
        canvas.blend(ice.sea * ice.pack(), (220, 234, 243))
