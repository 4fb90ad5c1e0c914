"""Light of the sun and the sky over the picture of a landscape.

Light is relative to that of level ground in the sun, on which pictures have the colours that they have without a sun.
"""

from __future__ import annotations

import numpy as np

from ..geodesy.sun import RADIUS_DEG
from .lattice import Array
from .paint import Canvas
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


def shine(canvas: Canvas, scene: Scene, facing: Canvas) -> None:
    """Light a picture.

    Parameters
    ----------
    canvas : Canvas
        Colours without light.
    facing : Canvas
        Cosine of the angle between the surface and the sun, over that of level ground; from `faced`.
    """
    sun = scene.sun
    if sun is None or scene.samples.zoom < FIRST_ZOOM:
        return
    light = np.maximum(facing.planes[0], np.float32(0))
    clearance, _, view = relief_light(scene.seed, sun, scene.samples)
    if clearance is not None:
        light *= _disc(clearance).ravel()
    shown = cast_shadows(scene)
    if shown is not None:
        light *= shown.ravel()
    light *= np.float32(1.0 - sun.sky_share)
    light += view.ravel() * np.float32(sun.sky_share)
    _multiply(canvas, light)


def _multiply(canvas: Canvas, light: Array) -> None:
    """Multiply the linear light of colours by factors (n,)."""
    gain = _GAIN.take((light * np.float32(_LIGHT_STEPS)).astype(np.intp), mode="clip")
    canvas.planes += _OFFSET
    canvas.planes *= gain
    canvas.planes -= _OFFSET


def faced(scene: Scene) -> Canvas:
    """Cosine of the angle between the ground and the sun, over that of level ground, on a canvas of one plane."""
    sun = scene.sun
    if sun is None or scene.samples.zoom < FIRST_ZOOM:
        return Canvas([1.0], scene.samples.shape)
    return Canvas([relief_light(scene.seed, sun, scene.samples)[1]], scene.samples.shape)


def _disc(clearance: Array) -> Array:
    """Share of the sun's disc above a horizon that is lower than its centre by some degrees."""
    x = np.clip(clearance * np.float32(0.5 / RADIUS_DEG) + np.float32(0.5), np.float32(0), np.float32(1))
    return np.asarray(x * x * (np.float32(3) - np.float32(2) * x))
