"""A plan's path by sorties: for each one the points that an autopilot is to fly through, as arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geodesy.mercator import wrap_lon_deg
from ..flight.path import CAPTURE, LANDING, TAKEOFF
from ..plan import Plan

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Sortie:
    """Points of one sortie, k of them, as arrays (k,), without those on the ground.

    Parameters
    ----------
    takeoff : tuple of float, or None
        Latitude and longitude of the place of take-off; None where the mission sets none.
    base_m : float
        Height over the WGS 84 ellipsoid that heights count from: of the ground at the take-off, or below the first
        capture of the plan.
    lat_deg, lon_deg : array
        Longitudes in [-180, 180).
    height_m : array
        Over ``base_m``.
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
            heading_deg=self.heading_deg[which],
            gimbal_pitch_deg=self.gimbal_pitch_deg[which],
            capture=self.capture[which],
            time_s=self.time_s[which],
        )

    def runs(self, plan: Plan) -> list[tuple[int, int]]:
        """First and last point of each run of captures of one row, one after the other and none left out."""
        at = np.flatnonzero(self.capture >= 0)
        captures = self.capture[at]
        ends = (np.diff(plan.row[captures]) != 0) | (np.abs(np.diff(plan.column[captures])) != 1)
        ends |= np.diff(at) != 1
        starts = np.concatenate([[0], np.flatnonzero(ends) + 1]) if len(at) else at
        last = np.append(starts[1:] - 1, len(at) - 1)[: len(starts)]
        return list(zip(at[starts].tolist(), at[last].tolist()))


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
        found.append(
            Sortie(
                (float(path.lat_deg[ground[0]]), float(lon[ground[0]])) if len(ground) else None,
                path.base_m,
                path.lat_deg[flown],
                lon[flown],
                height[flown],
                heading[counts],
                pitch[counts],
                capture,
                path.time_s[flown],
            )
        )
    return found
