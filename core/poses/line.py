"""A line flown at constant speed, with rounded corners and a pose every n seconds or metres.

Corners are fly-by waypoints, passed on a circular arc that touches both legs. A coordinated turn at speed v and bank b
has the radius r = v² / (g tan b) and the turn rate v / r. Where legs are too short for that radius, the arc is as wide
as they allow and flown at the speed for which the bank is coordinated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message
from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import wrap_lon_deg
from ..geodesy.projections import geodesic_ends, geodesics
from ..limits import MAX_MISSION_BYTES, MAX_POSES
from ..mission.areas.area import Points, check_agl, check_lat_lon
from ..mission.areas.geojson import shapes
from ..mission.flight.gusts import GRAVITY_M_PER_S2
from ..storage.files import read_limited
from ..text.safe_json import parse_json
from .settings import LineFlight
from .track import ANGLE_DIGITS, PLACE_DIGITS

#: Largest distance between the flown geodesics and the line, and between corners that are merged.
TOLERANCE_M = 0.1


class FlownLine(NamedTuple):
    """Poses of a flown line, with its turns.

    Parameters
    ----------
    points : Points
        Poses with yaw and time, and with roll if the camera is fixed.
    missed_m : float
        Largest distance at which a corner is passed; no pose is farther from the line.
    tight : int
        Number of turns tighter than `turn_radius_m` because of short legs.
    slowest_m_per_s : float
        Speed in the tightest turn.
    """

    points: Points
    missed_m: float
    tight: int
    slowest_m_per_s: float


def turn_radius_m(flight: LineFlight) -> float:
    """Radius of turns between legs that are long enough."""
    return flight.speed_m_per_s**2 / (GRAVITY_M_PER_S2 * math.tan(math.radians(flight.bank_deg)))


def fly(lines: Sequence[Floats], flight: LineFlight, start_s: float = 0.0) -> FlownLine:
    """Fly lines one after the other, without exposures between them.

    Each line begins with an exposure. The top of the image points along the way.

    Parameters
    ----------
    lines : sequence of arrays (n, 3)
        Latitude, longitude in degrees and height above ground in metres of each corner. Sides are straight in longitude
        and latitude (RFC 7946) and take the shorter way around the Earth; heights are interpolated linearly.
    start_s : float
        Time of the first exposure, seconds after 1970 in UTC.

    Raises
    ------
    InvalidInput
        No line, an invalid place or height, a line of one place, a corner too sharp for its legs, or too many poses.
    """
    rounded = [_RoundedLine.from_corners(line, flight, number) for number, line in enumerate(lines, 1)]
    if not rounded:
        raise InvalidInput("line: missing")
    count = sum(one.count(flight) for one in rounded)
    if count > MAX_POSES:
        raise InvalidInput("{0:,} poses: must be from 1 to {1:,}", count, MAX_POSES)
    clock, columns = start_s, []
    for at, one in enumerate(rounded):
        time_s, way_m = one.exposures(flight)
        columns.append([*one.poses(way_m), one.roll_deg(time_s), clock + time_s])
        if at + 1 < len(rounded):
            clock += float(one.time_s[-1]) + one.distance_m(rounded[at + 1]) / flight.speed_m_per_s
    digits = (PLACE_DIGITS, PLACE_DIGITS, *[ANGLE_DIGITS] * 4)
    # Adding 0 turns -0 into 0.
    lat, lon, agl, yaw, roll, time = (
        (np.round(np.concatenate(column), places) + 0.0).tolist() for column, places in zip(zip(*columns), digits)
    )
    return FlownLine(
        Points(
            tuple(zip(lat, lon, agl)),
            yaws_deg=tuple(yaw),
            rolls_deg=tuple(roll) if flight.fixed_camera else (),
            times_s=tuple(time),
        ),
        max(one.missed_m for one in rounded),
        int(sum(np.count_nonzero(one.speed_m_per_s < flight.speed_m_per_s) for one in rounded)),
        min(float(one.speed_m_per_s.min()) for one in rounded),
    )


@dataclass(frozen=True, eq=False)
class _RoundedLine:
    """One line of n corners, divided into 2 n - 3 pieces: legs (even) and turns (odd).

    ``radius_m`` and ``turn_deg`` (positive to the right) belong to the corners and are 0 at both ends; ``cut_m`` is the
    length that an arc takes from the legs on either side. ``way_m`` and ``time_s`` are the bounds of the pieces.
    """

    lat_deg: Floats
    lon_deg: Floats
    agl_m: Floats
    azimuth_deg: Floats
    arrival_deg: Floats
    leg_m: Floats
    turn_deg: Floats
    radius_m: Floats
    cut_m: Floats
    way_m: Floats
    time_s: Floats
    speed_m_per_s: Floats
    bank_deg: Floats

    @classmethod
    def from_corners(cls, line: Floats, flight: LineFlight, number: int) -> _RoundedLine:
        """Round the corners of a line; messages give its number."""
        lat, lon, agl = _distinct(line, number).T
        azimuth, arrival, leg = geodesics(lat[:-1], lon[:-1], lat[1:], lon[1:])
        turn = np.zeros(len(lat))
        turn[1:-1] = wrap_lon_deg(azimuth[1:] - arrival[:-1])
        half = np.tan(np.radians(np.abs(turn)) / 2.0)
        widest = turn_radius_m(flight)
        wanted = widest * half
        # A leg too short for both its turns is shared; a turn that needs less than half leaves the rest to
        # the other turn.
        first, second = (
            np.minimum(one, np.maximum(leg / 2.0, leg - other))
            for one, other in ((wanted[:-1], wanted[1:]), (wanted[1:], wanted[:-1]))
        )
        cut = np.minimum(np.append(first, 0.0), np.append(0.0, second))
        share = np.divide(cut, wanted, out=np.ones(len(cut)), where=wanted > 0.0)
        radius = widest * share
        # Refuse turns tighter than 1 m.
        sharp = np.flatnonzero(radius[1:-1] < min(widest, 1.0)) + 1
        if len(sharp):
            at = int(sharp[0])
            raise InvalidInput(
                "line {0}: turns by {1:.0f} degrees at {2:.6f}, {3:.6f}, between legs of {4:.1f} m and {5:.1f} m",
                number,
                abs(turn[at]),
                lat[at],
                lon[at],
                leg[at - 1],
                leg[at],
                remedy="make two lines of it there, or simplify it",
            )
        length = np.empty(2 * len(leg) - 1)
        length[::2] = np.maximum(leg - cut[:-1] - cut[1:], 0.0)
        length[1::2] = (radius * np.radians(np.abs(turn)))[1:-1]
        speed, bank = np.full(len(length), flight.speed_m_per_s), np.zeros(len(length))
        speed[1::2] *= np.sqrt(share[1:-1])
        bank[1::2] = np.copysign(flight.bank_deg, turn[1:-1])
        way, time = (np.append(0.0, np.cumsum(values)) for values in (length, length / speed))
        return cls(lat, lon, agl, azimuth, arrival, leg, turn, radius, cut, way, time, speed, bank)

    @property
    def missed_m(self) -> float:
        """Largest distance at which a corner is passed."""
        return float((np.hypot(self.radius_m, self.cut_m) - self.radius_m).max())

    def count(self, flight: LineFlight) -> int:
        """Number of exposures."""
        every, end = (flight.every_m, self.way_m[-1]) if flight.every_s is None else (flight.every_s, self.time_s[-1])
        # Rounding must not drop an exposure at the very end of the line.
        return int(end / float(every or 1.0) * (1.0 + 1e-12)) + 1

    def exposures(self, flight: LineFlight) -> tuple[Floats, Floats]:
        """Time in seconds and distance along the way in metres of each exposure."""
        steps = np.arange(self.count(flight))
        if flight.every_s is not None:
            time_s = steps * flight.every_s
            return time_s, np.interp(time_s, self.time_s, self.way_m)
        way_m = steps * float(flight.every_m or 0.0)
        return np.interp(way_m, self.way_m, self.time_s), way_m

    def poses(self, way_m: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Latitude, longitude, height above ground and course at distances along the way.

        Legs are geodesics. Turns are computed in the azimuthal equidistant plane about their corner, where legs are
        straight and circles are off by (r / R)² / 6: 2e-8 of a radius of 2 km.
        """
        last = len(self.speed_m_per_s) - 1
        piece = np.minimum(np.searchsorted(self.way_m, way_m, side="right") - 1, last)
        along = way_m - self.way_m[piece]
        # Positions in a turn are relative to its corner, on a leg to the corner at its start.
        in_turn, corner = piece % 2 == 1, (piece + 1) // 2
        radius, turn, cut = self.radius_m[corner], self.turn_deg[corner], self.cut_m[corner]
        swept = np.where(in_turn, along / radius, 0.0)
        ahead = np.where(in_turn, radius * np.sin(swept) - cut, cut + along)
        right = np.copysign(radius * (1.0 - np.cos(swept)), turn)
        inward = np.where(in_turn, self.arrival_deg[corner - 1], self.azimuth_deg[piece // 2])
        heading = inward + np.copysign(np.degrees(swept), turn)
        away = inward + np.degrees(np.arctan2(right, ahead))
        lat, lon, bearing = geodesic_ends(self.lat_deg[corner], self.lon_deg[corner], away, np.hypot(ahead, right))
        # The height in a turn is that of the line at the same share of the length that the turn cuts off.
        share = np.degrees(swept) / np.where(in_turn, np.abs(turn), 1.0)
        corners_m = np.append(0.0, np.cumsum(self.leg_m))
        line_m = corners_m[corner] + np.where(in_turn, cut * (2.0 * share - 1.0), ahead)
        agl = np.interp(line_m, corners_m, self.agl_m)
        course: Floats = wrap_lon_deg(bearing + heading - away)
        return lat, lon, agl, course

    def roll_deg(self, time_s: Floats) -> Floats:
        """Roll of the aircraft at times: the mean bank over the rolling time around each time."""
        # Time that the aircraft takes to roll into a turn and out of it.
        rolling_s = 1.0
        turned = np.append(0.0, np.cumsum(self.bank_deg * np.diff(self.time_s)))
        after, before = (np.interp(time_s + half, self.time_s, turned) for half in (rolling_s / 2.0, -rolling_s / 2.0))
        roll: Floats = (after - before) / rolling_s
        return roll

    def distance_m(self, other: _RoundedLine) -> float:
        """Geodesic distance from the end of this line to the start of another."""
        *_, distance = geodesics(self.lat_deg[-1], self.lon_deg[-1], other.lat_deg[0], other.lon_deg[0])
        return float(distance)


def _distinct(line: Floats, number: int) -> Floats:
    """Places (m, 3) along a line, without repetitions; geodesics between them stay within the tolerance of the line."""
    for lat, lon, agl in line.tolist():
        check_lat_lon(lat, lon)
        check_agl(agl)
    corners = line.copy()
    corners[1:, 1] = line[:1, 1] + np.cumsum(wrap_lon_deg(np.diff(line[:, 1])))
    places = [corners[:1]]
    for start, end in zip(corners, corners[1:]):
        pieces = _pieces(start, end)
        places.append(start + np.arange(1, pieces + 1)[:, np.newaxis] / pieces * (end - start))
    whole = np.concatenate(places)
    kept = [0]
    for at in range(1, len(whole)):
        *_, distance = geodesics(*whole[kept[-1], :2], *whole[at, :2])
        if distance > TOLERANCE_M:
            kept.append(at)
    if len(kept) < 2:
        raise InvalidInput("line {0}: is a single place", number)
    distinct: Floats = whole[kept]
    return distinct


def _pieces(start: Floats, end: Floats) -> int:
    """Number of geodesics that replace a side, straight in longitude and latitude, within the tolerance.

    Where a side runs in the direction a, its geodesic curvature is sin a (1 + cos² a) tan(lat) / R.
    """
    (lat0, lon0, _), (lat1, lon1, _) = np.radians(start), np.radians(end)
    if lon0 == lon1:
        return 1
    low = 0.0 if lat0 * lat1 < 0.0 else min(abs(lat0), abs(lat1))
    length = WGS84.a_m * math.hypot(lat1 - lat0, (lon1 - lon0) * math.cos(low))
    # Over all directions, sin a (1 + cos² a) is at most 4/3 sqrt(2/3).
    bending = 4.0 / 3.0 * math.sqrt(2.0 / 3.0) * math.tan(max(abs(lat0), abs(lat1))) / WGS84.b_m
    # Bound the work for sides that run close to a pole.
    return min(math.ceil(length * math.sqrt(bending / (8.0 * TOLERANCE_M))) or 1, 10_000)


def read_lines(path: str, agl_m: float | None = None) -> list[Floats]:
    """Read the lines of a GeoJSON file for `fly`: each LineString, and each part of a MultiLineString.

    Parameters
    ----------
    agl_m : float or None
        Height above ground of all corners; None to take their third coordinates.

    Raises
    ------
    InvalidInput
        A file that cannot be read, has an unknown reference system, or holds no line; a corner that is invalid or has
        no height.
    """
    try:
        data = parse_json(read_limited(path, MAX_MISSION_BYTES, named_by_user=True))
    except (OSError, InvalidInput) as wrong:
        raise InvalidInput("file {0}: cannot be read as GeoJSON ({1})", path, wrong) from wrong
    found = []
    for coordinates, system in shapes(data, "LineString", Message("file {0}", path)):
        try:
            corners = [(corner[0], corner[1], *(corner[2:3] if agl_m is None else (agl_m,))) for corner in coordinates]
            # Some corners may lack a height.
            has_heights = all(len(corner) == 3 for corner in corners)
            line = np.array(corners, np.float64) if has_heights else None
        except (IndexError, KeyError, TypeError, ValueError) as wrong:
            raise InvalidInput("file {0}: a corner is not longitude, latitude ({1})", path, wrong) from wrong
        if line is None:
            raise InvalidInput(
                "file {0}: its corners have no height above ground",
                path,
                remedy="give one for all (--agl)",
            )
        found.append(system.degrees(line)[:, [1, 0, 2]])
    if not found:
        raise InvalidInput("file {0}: holds no LineString", path)
    return found
