"""How far wind moves and turns the camera over a mission's captures, and what that does to coverage and overlap."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..geodesy.camera import CORNERS, Camera, Poses
from ..geodesy.footprint import exact
from ..mission.flight.legs import legs
from ..mission.plan import Plan, plan
from .positions import errors_px, scene_of, spread

#: What the three rows are called that sum up the others.
MOVED, TURNED, TOGETHER = "moved, in all", "turned, in all", "moved and turned"
#: Captures whose pictures are compared, spread over the mission: long double takes time and memory.
_COMPARED = 20_000
#: Points of the picture that are followed: its corners and its middle.
_FOLLOWED = (*CORNERS, (0.0, 0.0))


class Spread(NamedTuple):
    """Root mean square, what 95 % of the captures stay within, and the most of any; without their signs."""

    rms: float
    usual: float
    most: float

    @classmethod
    def of(cls, values: Floats) -> Spread:
        """Spread of one value or more."""
        size = np.abs(values)
        return cls(float(np.sqrt(np.mean(size**2))), float(np.quantile(size, 0.95)), float(size.max()))


class Displacement(NamedTuple):
    """One way in which wind moves or turns the camera.

    Attributes
    ----------
    unit : str
        "m" or "deg"; empty of the two together.
    size : Spread or None
        In the unit.
    px : Spread or None
        How far that moves the ground in the picture, where it moves most of its corners and its middle; infinite
        where some of it comes to lie behind the camera, None where none of them shows any ground.
    """

    what: str
    unit: str
    size: Spread | None
    px: Spread | None


@dataclass(frozen=True)
class WindEffect:
    """What wind does to a mission.

    Attributes
    ----------
    displacements : tuple of Displacement
        Empty in steady wind, which moves and turns nothing.
    compared : int
        Captures that the figures in px are of; those in metres and degrees are of all.
    flown, calm : Plan
        The mission in wind and in still air.
    """

    displacements: tuple[Displacement, ...]
    compared: int
    flown: Plan
    calm: Plan

    @property
    def figures(self) -> dict[str, tuple[float, float]]:
        """What the plans come to in still air and in wind, by name; without what the mission has not."""
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
        Displacement(what, unit, None if values is None else Spread.of(values), _shift_px(flown, poses, which))
        for what, unit, values, poses in kinds
    )


def _turn_deg(meant: Poses, real: Poses) -> Floats:
    """Angle of the one turn that takes an attitude to another."""
    # Rays through the middle and to 45° right and up: the camera's axes, once that of the middle is taken off.
    camera, points = (
        Camera(math.degrees(2.0 * math.atan(math.sqrt(2.0))), 1.0),
        ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)),
    )
    change = camera.rays_enu(points, *real.attitude) - camera.rays_enu(points, *meant.attitude)
    change[..., 1:, :] -= change[..., :1, :]
    # Columns of a difference of rotations: its norm is 2 √2 times the sine of half the angle.
    chord = np.sqrt(np.sum(change**2, axis=(-2, -1))) / (2.0 * np.sqrt(2.0))
    angle: Floats = np.degrees(2.0 * np.arcsin(np.minimum(chord, 1.0)))
    return angle


def _shift_px(flown: Plan, poses: Poses, which: NDArray[np.intp]) -> Spread | None:
    """How far the ground that the camera was meant to see is shifted in the pictures from other poses."""
    scene = scene_of(flown, which)
    meant = (flown.nominal or flown.poses).take(which)
    seen = exact(scene.camera, meant, _FOLLOWED, scene.ground)
    scene = replace(scene, poses=poses.take(which))
    x, y = (np.broadcast_to(part, seen.hit.shape) for part in np.array(_FOLLOWED).T)
    shift = errors_px(scene, seen.lat_deg, seen.lon_deg - scene.poses.lon_deg[:, np.newaxis], x, y)
    some = seen.hit.any(axis=1)
    return Spread.of(np.where(seen.hit, shift, 0.0).max(axis=1)[some]) if some.any() else None
