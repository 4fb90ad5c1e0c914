"""Displacement and rotation of the camera by wind, and their effect on coverage and overlap."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..geodesy.camera import CORNERS, Camera, Poses
from ..geodesy.footprint import exact
from ..mission.flight.legs import legs
from ..mission.plan import Plan, plan
from .positions import capture_scene, errors_px, spread

#: Names of the three rows that sum up the others.
MOVED, TURNED, TOGETHER = "moved, in all", "turned, in all", "moved and turned"
#: Most captures whose shift in the picture is measured, as long double takes time and memory.
_COMPARED = 20_000
#: Points of the picture whose shift is measured: corners and centre.
_FOLLOWED = (*CORNERS, (0.0, 0.0))


class Spread(NamedTuple):
    """Root mean square, 95th percentile and maximum of absolute values."""

    rms: float
    usual: float
    most: float

    @classmethod
    def from_values(cls, values: Floats) -> Spread:
        """Spread of one or more values."""
        size = np.abs(values)
        return cls(float(np.sqrt(np.mean(size**2))), float(np.quantile(size, 0.95)), float(size.max()))


class Displacement(NamedTuple):
    """One way in which wind moves or turns the camera.

    Attributes
    ----------
    unit : str
        "m" or "deg"; empty for the sum of both.
    size : Spread or None
        In the unit.
    px : Spread or None
        Shift of the ground in the picture, the greatest of corners and centre; infinite if the ground is behind the
        camera afterwards, None if neither the corners nor the centre show ground.
    """

    what: str
    unit: str
    size: Spread | None
    px: Spread | None


@dataclass(frozen=True)
class WindEffect:
    """Effect of wind on a mission.

    Attributes
    ----------
    displacements : tuple of Displacement
        Empty in steady wind, which neither moves nor turns the camera.
    compared : int
        Number of captures measured for figures in px; figures in metres and degrees are of all captures.
    flown, calm : Plan
        The mission in wind and in still air.
    """

    displacements: tuple[Displacement, ...]
    compared: int
    flown: Plan
    calm: Plan

    @property
    def figures(self) -> dict[str, tuple[float, float]]:
        """Figures in still air and in wind, by name, without figures that the mission lacks."""
        calm, wind = _figures(self.calm), _figures(self.flown)
        return {name: (calm[name], wind[name]) for name in calm if name in wind}


def _figures(one: Plan) -> dict[str, float]:
    covered, shared = one.coverage, one.overlap
    found = {
        "images": len(one),
        "coverage": None if covered is None else covered.share,
        "uncovered_m2": None if covered is None else covered.uncovered_m2,
        "least_front_overlap": shared.least_along,
        "median_front_overlap": shared.median_along,
        "least_side_overlap": shared.least_across,
        "median_side_overlap": shared.median_across,
        "flight_s": one.direct.duration_s,
    }
    return {name: value for name, value in found.items() if value is not None}


def wind_effect(flown: Plan) -> WindEffect:
    """Compare a plan in wind with its nominal poses, and with the same mission in still air."""
    which = spread(len(flown), _COMPARED)
    return WindEffect(
        _displacements(flown, which), len(which), flown, plan(flown.mission.replace(wind=None), flown.grid)
    )


def _displacements(flown: Plan, which: NDArray[np.intp]) -> tuple[Displacement, ...]:
    meant, real = flown.nominal, flown.poses
    if meant is None or flown.mission.wind is None or flown.mission.wind.sigma_m_per_s == 0.0:
        return ()
    ground = flown.ground
    radii_m = (
        ground.meridional_radius_m(meant.lat_deg),
        ground.normal_radius_m(meant.lat_deg) * np.cos(np.radians(meant.lat_deg)),
    )
    north, east = (
        np.radians(is_deg - was_deg) * radius_m for is_deg, was_deg, radius_m in zip(real[:2], meant[:2], radii_m)
    )
    heading = np.radians(legs(meant.lat_deg, meant.lon_deg).headings_deg())
    sine, cosine = np.sin(heading), np.cos(heading)
    along, across, up = north * cosine + east * sine, east * cosine - north * sine, real.agl_m - meant.agl_m
    yaw, tilt, roll = (is_deg - was_deg for is_deg, was_deg in zip(real.attitude, meant.attitude))

    def moved(north_m: Floats, east_m: Floats) -> Poses:
        steps = (np.degrees(step_m / radius_m) for step_m, radius_m in zip((north_m, east_m), radii_m))
        lat_deg, lon_deg = (was_deg + step for was_deg, step in zip(meant[:2], steps))
        return meant._replace(lat_deg=lat_deg, lon_deg=lon_deg)

    kinds = (
        ("along the track", "m", along, moved(along * cosine, along * sine)),
        ("across the track", "m", across, moved(-across * sine, across * cosine)),
        ("up", "m", up, meant._replace(agl_m=real.agl_m)),
        (MOVED, "m", np.sqrt(along**2 + across**2 + up**2), Poses(*real[:3], *meant[3:])),
        ("yaw", "deg", yaw, meant._replace(yaw_deg=real.yaw_deg)),
        ("tilt", "deg", tilt, meant._replace(tilt_deg=real.tilt_deg)),
        ("roll", "deg", roll, meant._replace(roll_deg=real.roll_deg)),
        (TURNED, "deg", _turn_deg(meant, real), Poses(*meant[:3], *real[3:])),
        (TOGETHER, "", None, real),
    )
    return tuple(
        Displacement(what, unit, None if values is None else Spread.from_values(values), _shift_px(flown, poses, which))
        for what, unit, values, poses in kinds
    )


def _turn_deg(meant: Poses, real: Poses) -> Floats:
    """Angle of the rotation from an attitude to another."""
    # Rays through the centre, 45° to the right and 45° up: the last two minus the first are the camera's axes.
    camera, points = (
        Camera(math.degrees(2.0 * math.atan(math.sqrt(2.0))), 1.0),
        ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)),
    )
    change = camera.rays_enu(points, *real.attitude) - camera.rays_enu(points, *meant.attitude)
    change[..., 1:, :] -= change[..., :1, :]
    # The norm of a difference of rotation matrices is 2 √2 times the sine of half the angle.
    chord = np.sqrt(np.sum(change**2, axis=(-2, -1))) / (2.0 * np.sqrt(2.0))
    angle: Floats = np.degrees(2.0 * np.arcsin(np.minimum(chord, 1.0)))
    return angle


def _shift_px(flown: Plan, poses: Poses, which: NDArray[np.intp]) -> Spread | None:
    """Shift in the picture, from other poses, of the ground that the camera should have seen."""
    scene = capture_scene(flown, which)
    meant = (flown.nominal or flown.poses).take(which)
    seen = exact(scene.camera, meant, _FOLLOWED, scene.ground)
    scene = replace(scene, poses=poses.take(which))
    x, y = (np.broadcast_to(part, seen.hit.shape) for part in np.array(_FOLLOWED).T)
    shift = errors_px(scene, seen.lat_deg, seen.lon_deg - scene.poses.lon_deg[:, np.newaxis], x, y)
    some = seen.hit.any(axis=1)
    return Spread.from_values(np.where(seen.hit, shift, 0.0).max(axis=1)[some]) if some.any() else None
