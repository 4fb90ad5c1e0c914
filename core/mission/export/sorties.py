"""The path of a plan by sorties: points for an autopilot, as arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Floats, NDArray, Numbers
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.projections import LocalPlane
from ..flight.legs import legs
from ..flight.path import CAPTURE, LANDING, TAKEOFF
from ..plan import Plan

#: Heights that differ by less are equal, metres.
_NOISE_M = 1e-3
#: Part of a tolerance of heights that files take: half a digit at both ends of a leg, and corners cut.
_ROUNDING_M = 0.02


@dataclass(frozen=True, eq=False)
class Sortie:
    """Points of one sortie in the air, arrays (k,).

    Parameters
    ----------
    takeoff : tuple of float, or None
        Latitude and longitude of the take-off; None if the mission sets none.
    base_m : float
        Reference of heights, above the WGS 84 ellipsoid: the ground at the take-off, or below the first point.
    lat_deg, lon_deg : array
        Longitudes in [-180, 180).
    height_m : array
        Heights above ``base_m``.
    ground_m : array
        Heights of the ground below, above the WGS 84 ellipsoid.
    heading_deg : array
        Heading of the aircraft, to which the top of the image points, in [0, 360); between
        captures, that of the next one.
    gimbal_pitch_deg : array
        -90 is straight down, 0 horizontal.
    capture : array of int64
        Index of the capture in the plan; -1 at other points.
    time_s : array
        Seconds after the first capture of the plan.
    speed_m_per_s : array
        Airspeed towards each point.
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
    speed_m_per_s: Floats

    def __len__(self) -> int:
        return len(self.capture)

    def take(self, which: slice | NDArray[np.bool_]) -> Sortie:
        """Some of the points."""
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
            speed_m_per_s=self.speed_m_per_s[which],
        )

    def part(self, which: slice) -> Sortie:
        """Some of the points as a flight; without a take-off, heights count from the ground below the first of them."""
        part = self.take(which)
        if self.takeoff is not None:
            return part
        base_m = float(part.ground_m[0])
        return replace(part, base_m=base_m, height_m=part.height_m + (self.base_m - base_m))

    @property
    def home(self) -> tuple[float, float]:
        """Latitude and longitude of the take-off, or of the first point if none is set."""
        return self.takeoff or (float(self.lat_deg[0]), float(self.lon_deg[0]))

    def way_home_m(self, plan: Plan, at: int) -> float:
        """Height above ``base_m`` of a level flight between home and a point; minus infinity over level ground.

        The flight keeps the clearance above the relief, and at least the height of the lowest capture above ground.
        """
        lat = np.array([self.home[0], self.lat_deg[at]])
        lon = continuous(np.array([self.home[1], self.lon_deg[at]]), float(plan.lon_deg[0]))
        plane = LocalPlane(float(lat[0]), float(lon[0]))
        profiles = plan.relief.around(lat, lon, 0.0).profiles(lat, lon, plane)
        highest_m = max((float(below.highest_m.max()) for below in profiles), default=-math.inf)
        above_m = max(plan.mission.terrain.clearance_m, float(plan.meant.agl_m.min()))
        return highest_m + above_m - self.base_m

    def runs(self, plan: Plan) -> list[tuple[int, int]]:
        """First and last point of each run of consecutive captures of one row."""
        at = np.flatnonzero(self.capture >= 0)
        captures = self.capture[at]
        ends = (np.diff(plan.row[captures]) != 0) | (np.abs(np.diff(plan.column[captures])) != 1)
        ends |= np.diff(at) != 1
        starts = np.concatenate([[0], np.flatnonzero(ends) + 1]) if len(at) else at
        last = np.append(starts[1:] - 1, len(at) - 1)[: len(starts)]
        return list(zip(at[starts].tolist(), at[last].tolist()))

    def waypoints(self, plan: Plan) -> NDArray[np.bool_]:
        """Which points are waypoints if the camera is triggered by distance, (k,).

        Waypoints are the ends of each run and, over relief, points that keep the flight no lower than planned, and
        hardly higher.
        """
        found = self.capture < 0
        runs = self.runs(plan)
        found[[end for run in runs for end in run]] = True
        if plan.relief.is_level:
            return found
        way_m = np.append(0.0, np.cumsum(legs(self.lat_deg, self.lon_deg).distance_m))
        tolerance_m = plan.mission.terrain.height_tolerance_m
        for first, last in runs:
            run = slice(first, last + 1)
            if tolerance_m:
                # Digits of files and corners that drones cut take part of the tolerance.
                within_m = max(tolerance_m - _ROUNDING_M, 0.0)
                found[first + _fewest(way_m[run], self.height_m[run], within_m)] = True
                continue
            # Fewer waypoints may raise the flight by 1 % of the height above ground.
            higher_m = 0.01 * plan.meant.agl_m[self.capture[run]]
            found[first + _bends(way_m[run], self.height_m[run], higher_m)] = True
        if tolerance_m:
            return self._raise_low_legs(plan, found, way_m)
        low = np.zeros(len(found), bool)
        for first, last in self._low_legs(plan, found):
            low[first:last] = True
        kept: NDArray[np.bool_] = found | low
        return kept

    def _raise_low_legs(self, plan: Plan, found: NDArray[np.bool_], way_m: Floats) -> NDArray[np.bool_]:
        """Waypoints, with more of them on legs that are too low over the relief, (k,).

        Of each such leg the point that is highest above it becomes a waypoint, until no leg is too low, or has points.
        """
        found = found.copy()
        while True:
            added = False
            for first, last in self._low_legs(plan, found):
                inner = slice(first + 1, last)
                if inner.start >= inner.stop:
                    continue
                line = np.interp(way_m[inner], way_m[[first, last]], self.height_m[[first, last]])
                found[inner.start + int(np.argmax(self.height_m[inner] - line))] = added = True
            if not added:
                return found

    def _low_legs(self, plan: Plan, found: NDArray[np.bool_]) -> list[tuple[int, int]]:
        """First and last point of each leg between waypoints that is too low over the relief."""
        at = np.flatnonzero(found)
        if len(at) < 2:
            return []
        low: list[tuple[int, int]] = []
        lat, height = self.lat_deg[at], self.height_m[at] + self.base_m
        lon = continuous(self.lon_deg[at], float(plan.lon_deg[0]))
        plane = LocalPlane(float(lat[0]), float(lon[0]))
        for below in plan.relief.around(lat, lon, 0.0).profiles(lat, lon, plane):
            line = height[below.leg] + below.share * (height[below.leg + 1] - height[below.leg])
            short = below.highest_m + plan.mission.terrain.clearance_m - line > _NOISE_M
            low += [(int(at[leg]), int(at[leg + 1])) for leg in np.unique(below.leg[short]).tolist()]
        return low


def continuous(lon_deg: Floats, near_deg: float) -> Floats:
    """Longitudes within 180 degrees of ``near_deg``."""
    return near_deg + wrap_lon_deg(lon_deg - near_deg)


def _bends(way_m: Floats, height_m: Floats, higher_m: Floats) -> Numbers:
    """Indices (k,) of points of a run: lines between them are nowhere lower than the run, nor higher than allowed.

    From each point the line goes to the farthest point possible.
    """
    if np.ptp(height_m) <= _NOISE_M:
        return np.empty(0, np.int64)
    found, start, count = [0], 0, len(way_m)
    while start < count - 1:
        rest = slice(start + 1, None)
        away = np.maximum(way_m[rest] - way_m[start], _NOISE_M)
        slope, most = ((heights[rest] - height_m[start]) / away for heights in (height_m, height_m + higher_m))
        # The line passes exactly through its last point.
        low, high = np.maximum.accumulate(slope), np.minimum.accumulate(most)
        free = np.append(True, (slope[1:] >= low[:-1] - _NOISE_M / away[1:]) & (slope[1:] <= high[:-1]))
        start += int(np.flatnonzero(free)[-1]) + 1
        found.append(start)
    return np.array(found)


def _fewest(way_m: Floats, height_m: Floats, within_m: float) -> Numbers:
    """Indices (k,) of the fewest points of a run whose connecting lines stay within a distance of all its heights.

    The shortest way from the first point to the last: in each round, to all points that one more line reaches.
    """
    count = len(way_m)
    came_from = np.full(count, -1, np.int64)
    round_, came_from[0] = [0], 0
    while came_from[-1] < 0:
        reached = []
        for start in round_:
            rest = slice(start + 1, None)
            away = np.maximum(way_m[rest] - way_m[start], _NOISE_M)
            rise = height_m[rest] - height_m[start]
            low, high = np.maximum.accumulate((rise - within_m) / away), np.minimum.accumulate((rise + within_m) / away)
            slope = rise / away
            free = (slope >= low - _NOISE_M / away) & (slope <= high + _NOISE_M / away) & (came_from[rest] < 0)
            ends = start + 1 + np.flatnonzero(free)
            came_from[ends] = start
            reached += ends.tolist()
        round_ = reached
    found = [count - 1]
    while found[-1]:
        found.append(int(came_from[found[-1]]))
    return np.array(found[::-1])


def sorties(plan: Plan) -> list[Sortie]:
    """Sorties of a plan, in order; a single sortie without a take-off if the mission has no route.

    As a gimbal cannot look backwards, a view tilted to the rear becomes a view to the front of an aircraft that is
    turned around; see `waypoints`.
    """
    path, meant = plan.path, plan.meant
    heading = np.mod(meant.yaw_deg + 180.0 * (meant.tilt_deg < 0.0), 360.0)
    # The remainder of a tiny negative angle is rounded to 360.
    heading = np.where(heading >= 360.0, 0.0, heading)
    pitch = np.abs(meant.tilt_deg) - 90.0
    lon = wrap_lon_deg(path.lon_deg)
    height = path.height_m - path.base_m
    # This order of additions keeps heights over level ground exact.
    above = np.flatnonzero(path.kind == CAPTURE)
    captures = path.capture[above]
    height[above] = meant.agl_m[captures] + (plan.ground_m[captures] - path.base_m)
    found = []
    for number in range(path.sorties):
        in_sortie = path.sortie == number
        flown = np.flatnonzero(in_sortie & (path.kind != TAKEOFF) & (path.kind != LANDING))
        capture = np.where(path.kind[flown] == CAPTURE, path.capture[flown], -1)
        at = np.flatnonzero(capture >= 0)
        if not len(at):
            continue
        # Points after the last capture take its heading and pitch.
        captures_ahead = capture[at[np.minimum(np.searchsorted(at, np.arange(len(flown))), len(at) - 1)]]
        on_ground = np.flatnonzero(in_sortie & (path.kind == TAKEOFF))
        whole = Sortie(
            (float(path.lat_deg[on_ground[0]]), float(lon[on_ground[0]])) if len(on_ground) else None,
            path.base_m,
            path.lat_deg[flown],
            lon[flown],
            height[flown],
            path.ground_m[flown],
            heading[captures_ahead],
            pitch[captures_ahead],
            capture,
            path.time_s[flown],
            plan.airspeeds_m_per_s[captures_ahead],
        )
        found.append(whole.part(slice(None)))
    return found
