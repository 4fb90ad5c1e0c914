"""Light of the sun and the sky over the picture of a landscape.

Light is relative to that of level ground in the sun, on which pictures have the colours that they have without a sun.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geodesy.sun import RADIUS_DEG
from .lattice import Array
from .paint import Canvas
from .rays import ChartSun
from .relief_light import relief_light
from .scene import Scene
from .shadows import cast_shadows

#: First zoom with light; at lower ones a tile is so wide that the sun's height differs by degrees within it.
FIRST_ZOOM = 6
#: Encoded colours grow by the power of light of sRGB: c + a by light^(1 / 2.4), with a = 0.055. This is exact but for
#: the darkest tenth, where sRGB is linear.
_OFFSET = np.float32(0.055 * 255.0)
_POWER, _LIGHT_STEPS, _MOST_LIGHT = 1.0 / 2.4, 1024, 16
_GAIN = ((np.arange(_LIGHT_STEPS * _MOST_LIGHT + 1) / _LIGHT_STEPS) ** _POWER).astype(np.float32)


class Lighting(NamedTuple):
    """The sun over a scene.

    Attributes
    ----------
    facing : Canvas
        Cosine of the angle between the surface and the sun, over that of level ground, on one plane; of the ground, on
        which roofs and crowns are painted.
    clearance : array or None
        Degrees by which the sun's centre stands above the horizon of the relief; None where the whole disc does.
    view : array
        Share of the sky that the ground sees.
    """

    sun: ChartSun
    facing: Canvas
    clearance: Array | None
    view: Array


def lighting(scene: Scene) -> Lighting | None:
    """Lighting of a scene; None without a sun."""
    sun = scene.sun
    if sun is None or scene.samples.zoom < FIRST_ZOOM:
        return None
    clearance, facing, view = relief_light(scene.seed, sun, scene.samples)
    return Lighting(sun, Canvas([facing], scene.samples.shape), clearance, view)


def shine(canvas: Canvas, scene: Scene, lit: Lighting) -> None:
    """Light a picture, whose colours are without light."""
    light = np.maximum(lit.facing.planes[0], np.float32(0))
    if lit.clearance is not None:
        light *= _disc(lit.clearance).ravel()
    shown = cast_shadows(scene)
    if shown is not None:
        light *= shown.ravel()
    light *= np.float32(1.0 - lit.sun.sky_share)
    light += lit.view.ravel() * np.float32(lit.sun.sky_share)
    _multiply(canvas, light)


def _multiply(canvas: Canvas, light: Array) -> None:
    """Multiply the linear light of colours by factors (n,)."""
    gain = _GAIN.take((light * np.float32(_LIGHT_STEPS)).astype(np.intp), mode="clip")
    canvas.planes += _OFFSET
    canvas.planes *= gain
    canvas.planes -= _OFFSET


def _disc(clearance: Array) -> Array:
    """Share of the sun's disc above a horizon that is lower than its centre by some degrees."""
    x = np.clip(clearance * np.float32(0.5 / RADIUS_DEG) + np.float32(0.5), np.float32(0), np.float32(1))
    return np.asarray(x * x * (np.float32(3) - np.float32(2) * x))
