"""Velocities and turn rates of cameras at captures, from the path of the flight and the gusts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from ...arrays import Flags, Floats, NDArray
from ...geodesy.camera import Poses
from ...geodesy.ellipsoid import WGS84
from ...geodesy.mercator import wrap_lon_deg
from ..parts import HOVER
from .path import CAPTURE, LEAD_IN, TURNAROUND, FlightPath, Planned

if TYPE_CHECKING:
    from .motion import Disturbance


class FlownPlan(Planned, Protocol):
    """Attributes of a `plan.Plan` that rates use."""

    @property
    def path(self) -> FlightPath:
        """Path of the aircraft."""

    @property
    def gusting(self) -> Disturbance | None:
        """Rates of the pose errors that wind causes; None without."""


class Rates(NamedTuple):
    """Velocities of cameras over the ground and rates of their angles, arrays (n,)."""

    east_m_per_s: Floats
    north_m_per_s: Floats
    up_m_per_s: Floats
    yaw_deg_per_s: Floats
    tilt_deg_per_s: Floats
    roll_deg_per_s: Floats

    def take(self, which: NDArray[Any] | slice) -> Rates:
        """Rates of some captures, by index, mask or slice."""
        return Rates(*(values[which] for values in self))

    def moved(self, poses: Poses, after_s: Floats | float) -> Poses:
        """Poses (n,) at a time after theirs, or before for negative times, (n,) or one."""
        east, north, up, *turns = (rate * after_s for rate in self)
        lat = poses.lat_deg
        parallel_m = WGS84.normal_radius_m(lat) * np.cos(np.radians(lat))
        return Poses(
            lat + np.degrees(north / WGS84.meridional_radius_m(lat)),
            poses.lon_deg + np.degrees(east / parallel_m),
            poses.agl_m + up,
            *(angle + turn for angle, turn in zip(poses.attitude, turns)),
        )


def flight_rates(plan: FlownPlan) -> Rates:
    """Rates of a plan's cameras at its captures.

    Rows are flown straight through their captures, also the first and the last one. Between points, the path bends at
    each: there, the camera has the mean velocity of both legs. Only points that state their times say how the camera
    turns between them. Gusts move and turn it everywhere. A camera that hovers, or that has one capture only, is at
    rest.
    """
    count = len(plan.row)
    if plan.mission.trigger == HOVER or count < 2:
        return Rates(*np.zeros((6, count)))
    rates = np.concatenate([_velocities(plan), _turns(plan)])
    if plan.gusting is not None:
        rates = rates + np.stack(list(vars(plan.gusting).values()))
    return Rates(*rates)


def _velocities(plan: FlownPlan) -> Floats:
    """Velocities (3, n) to the east, north and up at the captures of a path."""
    # Imported here, as it loads PROJ.
    from ...geodesy.projections import geodesics

    path = plan.path
    lat, lon = path.lat_deg, wrap_lon_deg(path.lon_deg)
    start_deg, end_deg, distance_m = geodesics(lat[:-1], lon[:-1], lat[1:], lon[1:])
    seconds = np.diff(path.time_s)
    flown = (seconds > 0.0) & (np.diff(path.sortie) == 0)
    seconds = np.where(flown, seconds, 1.0)
    speed, climb = distance_m / seconds, np.diff(path.height_m) / seconds
    ahead, behind = (
        np.stack([speed * np.sin(azimuth), speed * np.cos(azimuth), climb])
        for azimuth in (np.radians(start_deg), np.radians(end_deg))
    )
    none = np.zeros((3, 1))
    both = np.concatenate([none, behind], axis=1), np.concatenate([ahead, none], axis=1)
    straight = _straight_legs(plan, path, flown)
    velocities = _means(both, straight)[:, path.kind == CAPTURE]
    return velocities[:, np.argsort(path.capture[path.kind == CAPTURE])]


def _straight_legs(plan: FlownPlan, path: FlightPath, flown: Flags) -> tuple[Flags, Flags]:
    """Whether the legs to and from each point of a path (m,) are those on which it is passed."""
    to = np.append(False, flown)
    away = np.append(flown, False)
    if not plan.mission.area.covers_ground:
        return to, away
    is_capture, in_row = path.kind == CAPTURE, (path.kind == LEAD_IN) | (path.kind == TURNAROUND)
    row = np.where(is_capture, plan.row[path.capture], -1)
    at = np.arange(len(row))
    last = np.maximum.accumulate(np.where(is_capture, at, 0))
    following = np.minimum.accumulate(np.where(is_capture, at, len(row) - 1)[::-1])[::-1]
    before, after = np.append(last[:1], last[:-1]), np.append(following[1:], following[-1:])
    straight_to = to & ((row[before] == row) | np.append(False, in_row[:-1]))
    straight_away = away & ((row[after] == row) | np.append(in_row[1:], False))
    # A row of one capture has no legs of its own.
    alone = ~(straight_to | straight_away)
    return straight_to | (alone & to), straight_away | (alone & away)


def _means(values: tuple[Floats, Floats], valid: tuple[Flags, Flags]) -> Floats:
    """Mean (k, n) of those values (k, n) that are valid (n,); 0 without any."""
    total = sum(np.where(ok, one, 0.0) for one, ok in zip(values, valid))
    count = valid[0].astype(np.float64) + valid[1]
    mean: Floats = total / np.maximum(count, 1.0)
    return mean


def _turns(plan: FlownPlan) -> Floats:
    """Rates (3, n) of yaw, tilt and roll of captures that state their times; 0 of others."""
    angles, seconds = np.stack(plan.meant.attitude), np.diff(plan.direct.exposures_s)
    if not plan.direct.has_times:
        return np.zeros_like(angles)
    flown = seconds > 0.0
    # The shorter way round.
    turned = (np.diff(angles) + 180.0) % 360.0 - 180.0
    rates, none = turned / np.where(flown, seconds, 1.0), np.zeros((3, 1))
    both = np.concatenate([none, rates], axis=1), np.concatenate([rates, none], axis=1)
    return _means(both, (np.append(False, flown), np.append(flown, False)))
