"""Colours of faces that no imagery shows: their own, in the light of the sun."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Floats, PixelValues
from ..bands import Bands, fitted
from ..camera.light import bytes_of_linear, linear_of_bytes
from ..geodesy.sun import sun_position
from ..mission.parts import Flight
from ..mission.plan import Plan
from ..mission.sunlight import mission_sun

if TYPE_CHECKING:
    from ..geodesy.raytracing.seen_faces import Painted

#: Share of its colour that a face shows in the shade; one that faces the sun shows all of it.
AMBIENT = 0.5
#: Height and azimuth of the sun, degrees, where no time is known, or at night: the light of shaded maps.
MAP_LIGHT = 45.0, 315.0


def sun_enu(plan: Plan, index: int) -> Floats:
    """Unit vector to the sun, in east, north and up, at a capture's time; see `MAP_LIGHT`."""
    height, azimuth = MAP_LIGHT
    # The default is a date for clocks, not for light; the sun stands still during a flight whose points have no times.
    if plan.direct.has_times or plan.mission.flight.start != Flight.start:
        after_s = plan.direct.exposures_s[index : index + 1] if plan.direct.has_times else np.zeros(1)
        place = float(plan.lat_deg[index]), float(plan.lon_deg[index])
        found = sun_position(plan.direct.start, after_s, *place)
        if float(found[0][0]) > 0.0:
            height, azimuth = float(found[0][0]), float(found[1][0])
    up, around = np.radians(height), np.radians(azimuth)
    return np.array([np.cos(up) * np.sin(around), np.cos(up) * np.cos(around), np.sin(up)])


def lit_colours(plan: Plan, index: int, painted: Painted, white: float) -> Floats:
    """Colours (k, 3) of faces in their light, which textures have already; ``white`` is the value of white."""
    sun, normals = mission_sun(plan.mission), painted.normals
    if sun is None:
        light = AMBIENT + (1.0 - AMBIENT) * np.maximum(normals @ sun_enu(plan, index), 0.0)
        light[painted.is_lit] = 1.0
        return painted.colour * (light / 255.0 * white)[:, np.newaxis]
    light = sun.light(normals @ sun.enu, normals[:, 2])
    light[painted.is_lit] = 1.0
    linear = linear_of_bytes(painted.colour) * light[:, np.newaxis]
    return bytes_of_linear(linear.astype(np.float32)) * (white / 255.0)


def paint(picture: PixelValues, painted: Painted, colours: Floats, bands: Bands) -> None:
    """Paint faces into a picture (height, width, bands): the shown bands in colours (k, 3), others in their grey."""
    values = np.repeat(colours.mean(axis=1, keepdims=True), len(bands), axis=1)
    if len(bands.shown) == colours.shape[1]:
        values[:, list(bands.shown)] = colours
    picture[painted.row, painted.column] = fitted(values, bands.dtype)[painted.which]
