"""A plan's path by sorties: for each one the points that an autopilot is to fly through, as arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats, Numbers
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.projections import LocalPlane
from ..flight.legs import legs
from ..flight.path import CAPTURE, LANDING, TAKEOFF
from ..plan import Plan

#: Heights that differ by noise, metres.
_NOISE_M = 1e-3


@dataclass(frozen=True, eq=False)
class Sortie:
    """Points of one sortie, k of them, as arrays (k,), without those on the ground.

    Parameters
    ----------
    takeoff : tuple of float, or None
        Latitude and longitude of the place of take-off; None where the mission sets none.
    base_m : float
        Height over the WGS 84 ellipsoid that heights count from: of the ground at the take-off, or below the first
        point.
    lat_deg, lon_deg : array
        Longitudes in [-180, 180).
    height_m : array
        Over ``base_m``.
    ground_m : array
        Of the ground below, over the WGS 84 ellipsoid.
    heading_deg : array
        Of the aircraft, which is where the top of the image points, in [0, 360); between captures that of the next.
    gimbal_pitch_deg : array
        -90 straight down, 0 to the horizon.
    capture : array of int64
        Index of the capture in the plan; -1 at points between.
    time_s : array
        Seconds after the first capture of the plan.
    """

    takeoff: tuple[float, float] | None
    base_m: float
    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    ground_m: Floats
    heading_deg: Floats
    gimbal_pitch_deg: Floats
    capture: Numbers
    time_s: Floats

    def __len__(self) -> int:
        return len(self.capture)

    def take(self, which: slice | NDArray[np.bool_]) -> Sortie:
        """Some of its points."""
        return replace(
            self,
            lat_deg=self.lat_deg[which],
            lon_deg=self.lon_deg[which],
            height_m=self.height_m[which],
            ground_m=self.ground_m[which],
            heading_deg=self.heading_deg[which],
            gimbal_pitch_deg=self.gimbal_pitch_deg[which],
            capture=self.capture[which],
            time_s=self.time_s[which],
        )

    def part(self, which: slice) -> Sortie:
        """Some of its points as a flight: where no take-off is set, heights count from the ground below its first."""
        part = self.take(which)
        if self.takeoff is not None:
            return part
        base_m = float(part.ground_m[0])
        return replace(part, base_m=base_m, height_m=part.height_m + (self.base_m - base_m))

    @property
    def home(self) -> tuple[float, float]:
        """Latitude and longitude of the take-off; where none is set, of the first point."""
        return self.takeoff or (float(self.lat_deg[0]), float(self.lon_deg[0]))

    def way_home_m(self, plan: Plan, at: int) -> float:
        """Height over ``base_m`` of a straight way between home and a point; minus infinity over level ground.

        It is as far above the relief as the lowest capture is above the ground, or as the clearance.
        """
        lat = np.array([self.home[0], self.lat_deg[at]])
        lon = continuous(np.array([self.home[1], self.lon_deg[at]]), float(plan.lon_deg[0]))
        plane = LocalPlane(float(lat[0]), float(lon[0]))
        profiles = plan.relief.around(lat, lon, 0.0).profiles(lat, lon, plane)
        highest_m = max((float(below.highest_m.max()) for below in profiles), default=-math.inf)
        above_m = max(plan.mission.terrain.clearance_m, float(plan.meant.agl_m.min()))
        return highest_m + above_m - self.base_m

    def runs(self, plan: Plan) -> list[tuple[int, int]]:
        """First and last point of each run of captures of one row, one after the other and none left out."""
        at = np.flatnonzero(self.capture >= 0)
        captures = self.capture[at]
        ends = (np.diff(plan.row[captures]) != 0) | (np.abs(np.diff(plan.column[captures])) != 1)
        ends |= np.diff(at) != 1
        starts = np.concatenate([[0], np.flatnonzero(ends) + 1]) if len(at) else at
        last = np.append(starts[1:] - 1, len(at) - 1)[: len(starts)]
        return list(zip(at[starts].tolist(), at[last].tolist()))

    def waypoints(self, plan: Plan) -> NDArray[np.bool_]:
        """Which points are waypoints where distance releases the camera, (k,).

        Of a run they are its ends and, over relief, what the flight has to go through to be nowhere lower than planned,
        and hardly higher.
        """
        found = self.capture < 0
        runs = self.runs(plan)
        found[[end for run in runs for end in run]] = True
        if plan.relief.is_level:
            return found
        way_m = np.append(0.0, np.cumsum(legs(self.lat_deg, self.lon_deg).distance_m))
        for first, last in runs:
            own = slice(first, last + 1)
            # Lines through fewer waypoints may be higher than the captures by 1 % of their height above ground.
            higher_m = 0.01 * plan.meant.agl_m[self.capture[own]]
            found[first + _bends(way_m[own], self.height_m[own], higher_m)] = True
        return found | self._low_between(plan, found)

    def _low_between(self, plan: Plan, found: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Points between waypoints that are too far from each other to keep clear of the relief, (k,)."""
        at = np.flatnonzero(found)
        low = np.zeros(len(found), bool)
        if len(at) < 2:
            return low
        lat, height = self.lat_deg[at], self.height_m[at] + self.base_m
        lon = continuous(self.lon_deg[at], float(plan.lon_deg[0]))
        plane = LocalPlane(float(lat[0]), float(lon[0]))
        for below in plan.relief.around(lat, lon, 0.0).profiles(lat, lon, plane):
            line = height[below.leg] + below.share * (height[below.leg + 1] - height[below.leg])
            short = below.highest_m + plan.mission.terrain.clearance_m - line > _NOISE_M
            for leg in np.unique(below.leg[short]).tolist():
                low[at[leg] : at[leg + 1]] = True
        return low


def continuous(lon_deg: Floats, near_deg: float) -> Floats:
    """Longitudes in the turn of the world that is next to one of them."""
    return near_deg + wrap_lon_deg(lon_deg - near_deg)


def _bends(way_m: Floats, height_m: Floats, higher_m: Floats) -> Numbers:
    """Points (k,) of a run, by index, through which straight lines are nowhere lower than all, nor higher than so much.

    From each point the line goes to the farthest one to which all between let it.
    """
    if np.ptp(height_m) <= _NOISE_M:
        return np.empty(0, np.int64)
    found, start, count = [0], 0, len(way_m)
    while start < count - 1:
        rest = slice(start + 1, None)
        away = np.maximum(way_m[rest] - way_m[start], _NOISE_M)
        slope, most = ((heights[rest] - height_m[start]) / away for heights in (height_m, height_m + higher_m))
        # To a point itself the line goes exactly.
        low, high = np.maximum.accumulate(slope), np.minimum.accumulate(most)
        free = np.append(True, (slope[1:] >= low[:-1] - _NOISE_M / away[1:]) & (slope[1:] <= high[:-1]))
        start += int(np.flatnonzero(free)[-1]) + 1
        found.append(start)
    return np.array(found)


def sorties(plan: Plan) -> list[Sortie]:
    """Sorties of a plan, in order; one without a take-off where the mission has no route.

    A gimbal does not look backwards: a view that is lifted to the rear becomes one to the front of an aircraft that
    is turned around, as in `waypoints`.
    """
    path, meant = plan.path, plan.meant
    heading = np.mod(meant.yaw_deg + 180.0 * (meant.tilt_deg < 0.0), 360.0)
    # The remainder of a tiny negative angle is rounded to 360.
    heading = np.where(heading >= 360.0, 0.0, heading)
    pitch = np.abs(meant.tilt_deg) - 90.0
    lon = wrap_lon_deg(path.lon_deg)
    height = path.height_m - path.base_m
    # In this order heights over level ground are those above it, to the last digit.
    above = np.flatnonzero(path.kind == CAPTURE)
    captures = path.capture[above]
    height[above] = meant.agl_m[captures] + (plan.ground_m[captures] - path.base_m)
    found = []
    for number in range(path.sorties):
        of_it = path.sortie == number
        flown = np.flatnonzero(of_it & (path.kind != TAKEOFF) & (path.kind != LANDING))
        capture = np.where(path.kind[flown] == CAPTURE, path.capture[flown], -1)
        at = np.flatnonzero(capture >= 0)
        if not len(at):
            continue
        # Of points behind the last capture that one counts.
        counts = capture[at[np.minimum(np.searchsorted(at, np.arange(len(flown))), len(at) - 1)]]
        ground = np.flatnonzero(of_it & (path.kind == TAKEOFF))
        whole = Sortie(
            (float(path.lat_deg[ground[0]]), float(lon[ground[0]])) if len(ground) else None,
            path.base_m,
            path.lat_deg[flown],
            lon[flown],
            height[flown],
            path.ground_m[flown],
            heading[counts],
            pitch[counts],
            capture,
            path.time_s[flown],
        )
        found.append(whole.part(slice(None)))
    return found
