"""The path as waypoints for an autopilot: positions, headings, gimbal pitches and times."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...arrays import Floats, NDArray
from ...errors import Message
from ...geodesy.mercator import wrap_lon_deg
from ..flight.path import CAPTURE, LANDING, LEAD_IN, TAKEOFF, TRANSIT, TURNAROUND
from ..outlines import cut_line
from ..plan import Plan
from .rows import clock, parts

#: Approximate limit of the points of a flight line; a longer one is thinned out between the ends of its rows.
LINE_POINTS = 50_000
#: Names of waypoints that are not captures.
NAMES = {
    TAKEOFF: "take-off",
    TRANSIT: "transit",
    LEAD_IN: "lead-in",
    TURNAROUND: "turnaround",
    LANDING: "landing",
}


class Waypoint(NamedTuple):
    """One point of the planned path.

    Parameters
    ----------
    name : str
        Name of the capture, or one of `NAMES`.
    column, row : int
        Grid indices of the capture; -1 at other points.
    lat_deg, lon_deg : float
        Longitude in [-180, 180).
    heading_deg : float
        Heading of the aircraft, to which the top of the image points, in [0, 360); other points have the heading of
        the next capture, or of the last one if none follows.
    agl_m : float
        Height above ground; 0 at take-off and landing.
    gimbal_pitch_deg : float
        -90 is straight down, 0 horizontal.
    time : str
        UTC, ISO 8601 to the millisecond.
    kind : int
        One of the kinds in `path`: `CAPTURE`, `TRANSIT` and so on.
    """

    name: str
    column: int
    row: int
    lat_deg: float
    lon_deg: float
    agl_m: float
    heading_deg: float
    gimbal_pitch_deg: float
    time: str
    kind: int = CAPTURE

    @property
    def is_capture(self) -> bool:
        """Whether an image is taken here."""
        return self.kind == CAPTURE

    @property
    def details(self) -> dict[str, float]:
        """Figures written to files beside name, position and time."""
        names = ("column", "row", "agl_m", "heading_deg", "gimbal_pitch_deg")
        return {name: getattr(self, name) for name in names}


def waypoints(plan: Plan, sortie: int | None = None) -> Iterator[Waypoint]:
    """Points of the path in flight order, of one sortie or of all; without a route, only the captures.

    Positions are the planned ones, without the effect of wind. As a gimbal cannot look backwards, a view tilted to the
    rear becomes a view to the front of an aircraft that is turned around: it shows the same ground, upside down.
    """
    path, meant = plan.path if sortie is None else plan.path.sortie_path(sortie), plan.meant
    lon = wrap_lon_deg(path.lon_deg)
    taken, ahead = path.capture >= 0, _captures_ahead(path.capture)
    agl = path.agl_m
    # Exactly as planned, without rounding.
    agl[taken] = meant.agl_m[path.capture[taken]]
    for part in parts(len(path)):
        at = ahead[part]
        backwards = meant.tilt_deg[at] < 0.0
        heading = np.mod(meant.yaw_deg[at] + 180.0 * backwards, 360.0)
        # The remainder of a tiny negative angle is rounded to 360.
        heading = np.where(heading >= 360.0, 0.0, heading)
        kinds, captures = path.kind[part].tolist(), path.capture[part].tolist()
        columns, rows = (np.where(taken[part], values[at], -1).tolist() for values in (plan.column, plan.row))
        yield from map(
            Waypoint._make,
            zip(
                [plan.names[one] if one >= 0 else NAMES[kind] for one, kind in zip(captures, kinds)],
                columns,
                rows,
                path.lat_deg[part].tolist(),
                lon[part].tolist(),
                agl[part].tolist(),
                heading.tolist(),
                (np.abs(meant.tilt_deg[at]) - 90.0).tolist(),
                clock(plan.direct.start, path.time_s[part]),
                kinds,
            ),
        )


def _captures_ahead(capture: NDArray[np.int64]) -> NDArray[np.int64]:
    """Capture that each point of a path leads to, (m,): itself, the next one, or the last one if none follows."""
    known = np.flatnonzero(capture >= 0)
    ahead: NDArray[np.int64] = capture[
        known[np.minimum(np.searchsorted(known, np.arange(len(capture))), len(known) - 1)]
    ]
    return ahead


def takeoff_deg(plan: Plan) -> tuple[float, float] | None:
    """Latitude and longitude, in [-180, 180), of the take-off; None if none is set."""
    place = plan.mission.route.takeoff
    return None if place is None else (place[0], float(wrap_lon_deg(np.array(place[1]))))


def flight_line(plan: Plan, sortie: int | None = None) -> list[tuple[Floats, Floats, Floats]]:
    """Longitudes, latitudes and heights above ground of the flight line, cut at the antimeridian.

    Over relief, or for a path with other points than captures, the line has all points of one sortie or of all.
    Otherwise, a line of more than `LINE_POINTS` waypoints is thinned out to every k-th one, and the ends of rows unless
    these are too many.
    """
    if not plan.path.is_captures or not plan.relief.is_level:
        path = plan.path if sortie is None else plan.path.sortie_path(sortie)
        return [(lon, lat, agl) for lon, lat, agl in cut_line(path.lon_deg, path.lat_deg, path.agl_m)]
    meant, count = plan.meant, len(plan)
    stride = -(-count // LINE_POINTS)
    places = np.arange(0, count, stride)
    if stride > 1:
        turns = np.flatnonzero(np.diff(plan.row))
        if 2 * len(turns) <= LINE_POINTS:
            places = np.union1d(places, np.concatenate([turns, turns + 1]))
        places = np.union1d(places, [count - 1])
    lines = cut_line(meant.lon_deg[places], meant.lat_deg[places], meant.agl_m[places])
    return [(lon, lat, agl) for lon, lat, agl in lines]


def waypoint_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on what waypoints cannot express, one line each."""
    notes, meant = [], plan.meant
    roll, tilt = float(meant.roll_deg[np.abs(meant.roll_deg).argmax()]), float(meant.tilt_deg.min())
    if roll:
        notes.append(Message("the roll of {0:g} deg is left out: waypoints have none", roll))
    if tilt < 0.0:
        notes.append(
            Message(
                "the tilt of {0:g} deg is flown with the aircraft turned around: same ground, images upside down",
                tilt,
            )
        )
    if plan.mission.wind is not None:
        notes.append(Message("wind is left out: waypoints are at the planned positions"))
    elif plan.nominal is not None:
        notes.append(Message("random poses are left out: waypoints are at the planned positions"))
    return tuple(notes)
