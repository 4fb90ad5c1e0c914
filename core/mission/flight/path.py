"""The path of an aircraft: take-off, transits, lead-ins, captures and turns, in sorties."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from ...arrays import Floats, NDArray, Numbers, expand_counts
from ...errors import InvalidInput
from ...geodesy.camera import Poses
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.projections import LocalPlane, geodesic_ends, geodesics
from ...geodesy.ways import way_around
from ...text.ranges import read_ranges
from ..areas.area import Polygon
from ..layout.no_fly import in_no_fly
from ..mission import Mission
from ..parts import GROUND, HOVER, MOST_SORTIES, ONE_WAY
from ..relief.ground import PathGround, Relief, refuse_hole
from .direct import DirectFlight
from .legs import legs

#: Kinds of points. Take-off and landing are on the ground; the points above them are transit, as are detours around
#: no-fly areas and points over relief.
TAKEOFF, TRANSIT, LEAD_IN, CAPTURE, TURNAROUND, LANDING = range(6)
#: Default rate of climb and descent: moderate for multirotors.
CLIMB_M_PER_S = 3.0
#: Stop at a capture: braking, coming to rest, taking the image and accelerating.
HOVER_S = 3.0
#: Share of the height above ground by which a leg may be lower, where the flight follows the ground.
SAG_SHARE = 0.1
#: Distance kept from no-fly areas: about the position error of an aircraft.
_NO_FLY_M = 5.0
#: Least climb or descent that has a point: less is level flight.
_CLIMB_M = 0.01
#: Height by which a leg may be too low: less is noise.
_NOISE_M = 1e-3


class Planned(Protocol):
    """Attributes of a `plan.Plan` that a path uses."""

    @property
    def mission(self) -> Mission:
        """Mission of the plan."""
        ...

    @property
    def row(self) -> Numbers:
        """Row of each capture, (n,)."""
        ...

    @property
    def meant(self) -> Poses:
        """Planned poses of captures in flight order, (n,)."""
        ...

    @property
    def ground_m(self) -> Floats:
        """Heights of the ground below captures, (n,)."""
        ...

    @property
    def asked_agl_m(self) -> Floats:
        """Requested heights above ground, (n,)."""
        ...

    @property
    def airspeeds_m_per_s(self) -> Floats:
        """Airspeed towards each capture, (n,); a value common to all takes no memory."""
        ...

    @property
    def joints(self) -> tuple[int, ...]:
        """Index of the first capture of each further mission of several in one flight."""
        ...

    @property
    def relief(self) -> Relief:
        """Ground below the flight."""
        ...

    @property
    def direct(self) -> DirectFlight:
        """The flight from capture to capture, without turns."""
        ...


@dataclass(frozen=True, eq=False)
class FlightPath:
    """Points of a flight in order, arrays (m,), joined by straight lines.

    Attributes
    ----------
    lat_deg, lon_deg : array
        Degrees; longitudes are continuous with the plan's.
    height_m : array
        Heights above the WGS 84 ellipsoid.
    ground_m : array
        Heights of the ground below, above the WGS 84 ellipsoid.
    kind : array of int8
        `TAKEOFF`, `TRANSIT`, `LEAD_IN`, `CAPTURE`, `TURNAROUND` or `LANDING`.
    capture : array of int64
        Index of the capture in the plan; -1 at other points.
    sortie : array of int64
        Number of the sortie, from 0.
    time_s : array
        Time of arrival: seconds after the first capture, negative before it.
    base_m : float
        Reference of heights above take-off in files, above the ellipsoid: the ground at the take-off, or below the
        first capture if none is set.
    """

    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    ground_m: Floats
    kind: NDArray[np.int8]
    capture: Numbers
    sortie: Numbers
    time_s: Floats
    base_m: float

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def agl_m(self) -> Floats:
        """Heights above the ground, (m,)."""
        return self.height_m - self.ground_m

    @property
    def sorties(self) -> int:
        """Number of sorties."""
        return int(self.sortie[-1]) + 1

    @property
    def sorties_s(self) -> Floats:
        """Duration of each sortie in seconds, (k,)."""
        first = np.searchsorted(self.sortie, np.arange(self.sorties))
        last = np.searchsorted(self.sortie, np.arange(self.sorties), side="right") - 1
        seconds: Floats = self.time_s[last] - self.time_s[first]
        return seconds

    @property
    def distance_m(self) -> float:
        """Length over ground of all sorties, without climbs."""
        length = legs(self.lat_deg, self.lon_deg).distance_m
        return float(length[np.diff(self.sortie) == 0].sum())

    @property
    def is_captures(self) -> bool:
        """Whether the path has only captures, in one sortie."""
        return self.sorties == 1 and bool((self.kind == CAPTURE).all())

    def sortie_path(self, sortie: int) -> FlightPath:
        """Path of one sortie; sortie numbers and times are kept."""
        first, last = np.searchsorted(self.sortie, [sortie, sortie + 1])
        arrays = {name: values[first:last] for name, values in vars(self).items() if name != "base_m"}
        return replace(self, **arrays)


def flight_path(plan: Planned) -> FlightPath:
    """Compute the path of a plan; without a route, the captures and points that raise legs over relief.

    The path leads through planned positions, whatever the wind. Sorties follow each other without a pause. A leg takes
    the longer of its length at the ground speed and its height at the climb rate, and a hovered capture `HOVER_S` more.
    Turns take no extra time.

    Raises
    ------
    InvalidInput
        The take-off is inside a no-fly area or has no ground height, or a capture is beyond the range of the battery.
    """
    route = plan.mission.route
    is_routed = route.takeoff is not None or route.turnaround_m or route.lead_in_m or plan.mission.trigger == HOVER
    if is_routed or plan.mission.no_fly or plan.joints:
        return _PathBuilder(plan).path()
    alone = _captures_only(plan)
    if plan.relief.is_level:
        return alone
    raised = _PathBuilder(plan).path()
    return alone if len(raised) == len(alone) else raised


def _captures_only(plan: Planned) -> FlightPath:
    """Path of the captures alone, in one sortie."""
    meant, count = plan.meant, len(plan.row)
    ground = np.asarray(plan.ground_m)
    return FlightPath(
        meant.lat_deg,
        meant.lon_deg,
        ground + meant.agl_m,
        ground,
        np.full(count, CAPTURE, np.int8),
        np.arange(count, dtype=np.int64),
        np.zeros(count, np.int64),
        plan.direct.exposures_s,
        float(ground[0]),
    )


class _Points(NamedTuple):
    """Points in order, arrays (m,)."""

    lat: Floats
    lon: Floats
    height: Floats
    kind: NDArray[np.int8]
    capture: Numbers

    @classmethod
    def create(cls, kind: int, lat: Floats, lon: Floats, height: Floats) -> _Points:
        """Points of one kind other than captures."""
        return cls(lat, lon, height, np.full(len(lat), kind, np.int8), np.full(len(lat), -1, np.int64))

    @classmethod
    def joined(cls, parts: Sequence[_Points]) -> _Points:
        """Points of all parts, in order."""
        return cls(*(np.concatenate(values) for values in zip(*parts)))

    def take(self, which: Any) -> _Points:
        """Some of the points."""
        return _Points(*(values[which] for values in self))


class _PathBuilder:
    """Computes a path that also has points other than captures."""

    def __init__(self, plan: Planned) -> None:
        self._mission, self._route = plan.mission, plan.mission.route
        meant, count = plan.meant, len(plan.row)
        ground = np.asarray(plan.ground_m)
        self._captures = _Points(
            np.asarray(meant.lat_deg),
            np.asarray(meant.lon_deg),
            np.asarray(ground + meant.agl_m),
            np.full(count, CAPTURE, np.int8),
            np.arange(count, dtype=np.int64),
        )
        self._row, self._capture_ground = plan.row, ground
        self._asked_agl, self._joints = np.asarray(plan.asked_agl_m), plan.joints
        speeds = plan.airspeeds_m_per_s
        self._airspeeds: Floats | None = speeds if any(speeds.strides) else None
        self._exposures_s = plan.direct.exposures_s
        self._own_times = bool(self._mission.area.times_s)
        lat, lon = self._captures.lat, self._captures.lon
        middle = float(lat.min() + lat.max()) / 2.0, float(lon.min() + lon.max()) / 2.0
        self._plane = LocalPlane(*middle)
        self._no_fly = [_nearby_rings(polygon, middle[1]) for polygon in self._mission.no_fly]
        self._rings = [[np.stack(self._plane.forward(y, x), axis=1) for x, y in one] for one in self._no_fly]
        self._home = self._takeoff(middle[1])
        self._is_level = plan.relief.is_level
        self._relief = self._relief_below(plan.relief)
        self._base_m = float(ground[0]) if self._home is None else self._ground_at_home(self._home)
        self._into_deg, self._out_deg = self._directions()
        self._ways: dict[tuple[int, bool], tuple[_Points, float]] = {}
        self._track = self._build_track()
        self._at_capture = np.flatnonzero(self._track.kind == CAPTURE)
        self._track_s = np.append(0.0, np.cumsum(self._legs_s(self._track)))

    def path(self) -> FlightPath:
        """Whole path, sortie by sortie."""
        parts = [self._sortie(first, last) for first, last in self._sorties()]
        points = _Points.joined(parts)
        sortie = np.repeat(np.arange(len(parts), dtype=np.int64), [len(part.kind) for part in parts])
        seconds = np.append(0.0, np.cumsum(self._legs_s(points)))
        # The change of batteries between landing and take-off takes no time.
        ends = np.flatnonzero(np.diff(sortie)) + 1
        for end in ends.tolist():
            seconds[end:] -= seconds[end] - seconds[end - 1]
        taken = points.capture >= 0
        if self._own_times:
            computed, stated = seconds[taken], self._exposures_s
            before, after = seconds < computed[0], seconds > computed[-1]
            moved = np.interp(seconds, computed, stated)
            seconds = np.where(
                before, seconds - computed[0] + stated[0], np.where(after, seconds - computed[-1] + stated[-1], moved)
            )
        seconds = seconds - seconds[np.argmax(taken)]
        ground = np.empty(len(points.kind))
        ground[taken] = self._capture_ground[points.capture[taken]]
        ground[~taken] = self._ground_m(points.lat[~taken], points.lon[~taken])
        return FlightPath(
            points.lat,
            points.lon,
            points.height,
            ground,
            points.kind,
            points.capture,
            sortie,
            seconds,
            self._base_m,
        )

    # --- the ground

    def _takeoff(self, lon_deg: float) -> tuple[float, float] | None:
        """Position of the take-off, with its longitude within 180 degrees of ``lon_deg``."""
        if self._route.takeoff is None:
            return None
        lat, lon = self._route.takeoff
        lon += 360.0 * round((lon_deg - lon) / 360.0)
        if in_no_fly(self._mission.no_fly, np.array([lat]), np.array([lon]))[0]:
            raise InvalidInput(
                "take-off at latitude {0:.6f}, longitude {1:.6f}: lies inside a no-fly area",
                *self._route.takeoff,
                field="takeoff",
                remedy="move it outside",
            )
        return lat, lon

    def _relief_below(self, relief: Relief) -> PathGround:
        lat, lon = [self._captures.lat], [self._captures.lon]
        for polygon in self._no_fly:
            lon.append(polygon[0][0])
            lat.append(polygon[0][1])
        if self._home is not None:
            lat.append(np.array(self._home[:1]))
            lon.append(np.array(self._home[1:]))
        room_m = max(self._route.lead_in_m, self._route.turnaround_m) + _NO_FLY_M
        return relief.around(np.concatenate(lat), np.concatenate(lon), room_m)

    def _ground_at_home(self, home: tuple[float, float]) -> float:
        found = float(self._relief.ground_m(np.array(home[:1]), np.array(home[1:]))[0])
        if math.isnan(found):
            refuse_hole(*home)
        return found

    def _ground_m(self, lat: Floats, lon: Floats) -> Floats:
        """Heights of the ground below points; the reference of heights where the ground is unknown."""
        found = self._relief.ground_m(lat, lon)
        return np.where(np.isnan(found), self._base_m, found)

    def _least_m(self, lat: Floats, lon: Floats, agl_m: Floats | float) -> tuple[Floats, Floats]:
        """Least heights that legs may have at positions, and heights to give to new points there."""
        return self._leg_heights_m(self._relief.highest_m(lat, lon), self._relief.ground_m(lat, lon), agl_m)

    def _leg_heights_m(self, highest_m: Floats, ground_m: Floats, agl_m: Floats | float) -> tuple[Floats, Floats]:
        """Heights as `_least_m` returns them, from the greatest height nearby and the ground below."""
        least = highest_m + self._mission.terrain.clearance_m
        # Half a metre more, so that a round hill does not need a point every few metres.
        given = least + 0.5
        if self._mission.terrain.height_above != GROUND:
            return least, given
        return np.fmax(least, ground_m + (1.0 - SAG_SHARE) * agl_m), np.fmax(given, ground_m + agl_m)

    # --- rows and the legs between them

    def _directions(self) -> tuple[Floats, Floats]:
        """Azimuths of arrival at each capture as first of a row, and of departure as last of a row, (n,) each."""
        lat, lon, row = self._captures.lat, wrap_lon_deg(self._captures.lon), self._row
        count = len(lat)
        into, out = np.full(count, np.nan), np.full(count, np.nan)
        if count == 1:
            return np.zeros(1), np.zeros(1)
        start, end, _ = geodesics(lat[:-1], lon[:-1], lat[1:], lon[1:])
        same = row[1:] == row[:-1]
        into[1:][same], out[:-1][same] = end[same], start[same]
        into[:-1][same], out[1:][same] = start[same], end[same]
        turned = 0.0 if self._mission.flight.order == ONE_WAY else 180.0
        alone = np.flatnonzero(np.isnan(into))
        for one in alone.tolist():
            # A row of one capture has the direction of its neighbour, or the opposite one.
            if one and not math.isnan(out[one - 1]):
                into[one] = out[one] = out[one - 1] + turned
        for one in alone[::-1].tolist():
            if math.isnan(into[one]):
                into[one] = out[one] = into[one + 1] + turned if one + 1 < count else start[-1]
        alone = np.flatnonzero(np.isnan(into))
        into[alone] = out[alone] = start[np.minimum(alone, count - 2)]
        return into, out

    def _extensions(self, which: Numbers, kind: int) -> tuple[_Points, Numbers]:
        """Lead-ins before captures, or turnarounds after them, outside no-fly areas, with the capture of each."""
        lead_in = kind == LEAD_IN
        length_m = self._route.lead_in_m if lead_in else self._route.turnaround_m
        if not length_m or not len(which):
            return _Points.create(kind, *np.empty((3, 0))), which[:0]
        azimuth = self._into_deg[which] + 180.0 if lead_in else self._out_deg[which]
        row_ends = self._captures.take(which)
        lat, lon, _ = geodesic_ends(row_ends.lat, wrap_lon_deg(row_ends.lon), azimuth, np.full(len(which), length_m))
        lon = row_ends.lon + wrap_lon_deg(lon - row_ends.lon)
        least, _ = self._least_m(lat, lon, self._asked_agl[which])
        free = ~in_no_fly(self._mission.no_fly, lat, lon)
        points = _Points.create(kind, lat, lon, np.fmax(row_ends.height, least))
        return points.take(free), which[free]

    def _build_track(self) -> _Points:
        """Captures with turnarounds, lead-ins, detours and raised legs."""
        turns = np.flatnonzero(np.diff(self._row))
        behind, left = self._extensions(turns, TURNAROUND)
        before, entered = self._extensions(turns + 1, LEAD_IN)
        keys = np.concatenate([3 * self._captures.capture, 3 * left + 1, 3 * entered - 1])
        points = _Points.joined([self._captures, behind, before]).take(np.argsort(keys, kind="stable"))
        # Points of the missions of one flight are separated before the lead-in of each.
        keys.sort()
        joints = np.searchsorted(keys, [3 * joint - 1 for joint in self._joints])
        parts = [
            self._raise_legs(self._around(points.take(slice(first, end))))
            for first, end in zip([0, *joints], [*joints, len(keys)])
        ]
        whole = parts[:1]
        for joint, part in zip(self._joints, parts[1:]):
            last, first = whole[-1].take(slice(-1, None)), part.take(slice(0, 1))
            agl_m = float(self._asked_agl[joint - 1 : joint + 1].max())
            crossing = self._crossing(last, first, agl_m)
            rises, falls = (float(crossing.height[0] - end.height[0]) > _CLIMB_M for end in (last, first))
            whole += [crossing.take(slice(int(not rises), len(crossing.kind) - int(not falls))), part]
        return _Points.joined(whole) if self._joints else parts[0]

    def _crossing(self, start: _Points, end: _Points, agl_m: float) -> _Points:
        """Level way from a point to another, both included, that is safe and no lower than either."""
        ends = (one._replace(kind=np.full(1, TRANSIT, np.int8), capture=np.full(1, -1)) for one in (start, end))
        across = self._around(_Points.joined([*ends]))
        height_m = max(float(start.height[0]), float(end.height[0]), self._safe_height_m(across, agl_m))
        return across._replace(height=np.full(len(across.kind), height_m))

    def _around(self, points: _Points) -> _Points:
        """Points with detours around no-fly areas."""
        if not self._rings or len(points.kind) < 2:
            return points
        place = np.stack(self._plane.forward(points.lat, points.lon), axis=1)
        low, high = np.minimum(place[:-1], place[1:]), np.maximum(place[:-1], place[1:])
        near = np.zeros(len(low), bool)
        for polygon in self._rings:
            corners = polygon[0]
            near |= ((high >= corners.min(axis=0) - _NO_FLY_M) & (low <= corners.max(axis=0) + _NO_FLY_M)).all(axis=1)
        added: list[tuple[int, _Points]] = []
        for leg in np.flatnonzero(near).tolist():
            detour = way_around(place[leg], place[leg + 1], self._rings, _NO_FLY_M)[1:-1]
            if len(detour):
                lat, lon = self._plane.inverse(*detour.T)
                height = np.full(len(detour), max(points.height[leg], points.height[leg + 1]))
                added.append((leg, _Points.create(TRANSIT, lat, lon, height)))
        return _inserted(points, added)

    def _raise_legs(self, points: _Points) -> _Points:
        """Points, with more of them inserted where a leg is too low over the relief."""
        if self._is_level or len(points.kind) < 2:
            return points
        agl = self._leg_agl_m(points)
        points = self._raised(points, np.append(agl, agl[-1]))
        added: list[tuple[int, _Points]] = []
        for below in self._relief.profiles(points.lat, points.lon, self._plane):
            least, given = self._leg_heights_m(below.highest_m, below.ground_m, agl[below.leg])
            line = points.height[below.leg]
            line = line + below.share * (points.height[below.leg + 1] - line)
            for one in np.unique(below.leg[least - line > _NOISE_M]).tolist():
                at = slice(*np.searchsorted(below.leg, [one, one + 1]))
                ends = float(points.height[one]), float(points.height[one + 1])
                which, height = _raised_nodes(below.share[at], least[at], given[at], ends)
                lat, lon = below.lat_deg[at][which], below.lon_deg[at][which]
                added.append((one, _Points.create(TRANSIT, lat, lon, height)))
        return _inserted(points, added)

    def _raised(self, points: _Points, agl_m: Floats) -> _Points:
        """Points, of which those that are not captures are raised where they are too low over the relief."""
        least, given = self._least_m(points.lat, points.lon, agl_m)
        low = (points.capture < 0) & (points.height < least)
        return points._replace(height=np.where(low, given, points.height))

    def _leg_agl_m(self, points: _Points) -> Floats:
        """Requested height above ground of each leg, (m - 1,): the lower of the captures before and after."""
        before = np.maximum(np.maximum.accumulate(points.capture), 0)
        after = np.minimum.accumulate(np.where(points.capture < 0, len(self._row) - 1, points.capture)[::-1])[::-1]
        agl: Floats = np.minimum(self._asked_agl[before[:-1]], self._asked_agl[after[1:]])
        return agl

    # --- sorties

    def _sorties(self) -> list[tuple[int, int]]:
        """First and last capture of each sortie."""
        last = len(self._row) - 1
        splits = [one for first, end in read_ranges(self._route.split_after) for one in range(first, end + 1)]
        if splits and not 0 < splits[0] <= splits[-1] <= last:
            raise InvalidInput(
                "split after image {0:,}: must be from 1 to {1:,}, as the flight has {2:,} images",
                splits[-1] if splits[0] else 0,
                last,
                last + 1,
                field="split_after",
            )
        found: list[tuple[int, int]] = []
        for first, end in zip([0, *splits], [*(one - 1 for one in splits), last]):
            self._add_sorties(first, end, found)
        return found

    def _add_sorties(self, first: int, last: int, found: list[tuple[int, int]]) -> None:
        """Divide captures into sorties that the battery allows."""
        battery = self._route.battery_min
        if battery is None:
            found.append((first, last))
            return
        limit_s = 60.0 * battery
        ends = np.append(np.flatnonzero(np.diff(self._row)), len(self._row) - 1)
        while first <= last:
            if len(found) == MOST_SORTIES:
                raise InvalidInput(
                    "battery of {0:g} min: the flight needs more than {1:,} sorties",
                    battery,
                    MOST_SORTIES,
                    field="battery_min",
                    remedy="take a smaller area, a nearer take-off or a larger battery",
                )
            end = self._farthest(first, last, limit_s)
            row_end = ends[np.searchsorted(ends, end, side="right") - 1] if end >= ends[0] else -1
            # A sortie that uses half of the battery ends with a row rather than within the next.
            if first <= row_end < end < last and 0.5 * limit_s <= self._sortie_s(first, int(row_end)) <= limit_s:
                end = int(row_end)
            found.append((first, end))
            first = end + 1

    def _farthest(self, first: int, last: int, limit_s: float) -> int:
        """Last capture of the longest sortie that the battery allows."""
        alone_s = self._sortie_s(first, first)
        if alone_s > limit_s:
            raise InvalidInput(
                "battery of {0:g} min: the way to image {1:,} and back takes {2:.1f} min",
                limit_s / 60.0,
                first + 1,
                alone_s / 60.0,
                field="battery_min",
                remedy="take off nearer to it, fly faster or take a larger battery",
            )
        if self._sortie_s(first, last) <= limit_s:
            return last
        fits, exceeds = first, last
        while exceeds - fits > 1:
            middle = (fits + exceeds) // 2
            fits, exceeds = (middle, exceeds) if self._sortie_s(first, middle) <= limit_s else (fits, middle)
        return fits

    def _sortie(self, first: int, last: int) -> _Points:
        """Points of one sortie."""
        track = self._track.take(slice(self._at_capture[first], self._at_capture[last] + 1))
        return _Points.joined([self._way(first, True)[0], track, self._way(last, False)[0]])

    def _sortie_s(self, first: int, last: int) -> float:
        """Seconds of one sortie."""
        track_s = float(self._track_s[self._at_capture[last]] - self._track_s[self._at_capture[first]])
        return self._way(first, True)[1] + track_s + self._way(last, False)[1]

    def _way(self, capture: int, outward: bool) -> tuple[_Points, float]:
        """Way from take-off to a capture (excluded), or back, and its duration including the leg at the capture."""
        key = capture, outward
        if key not in self._ways:
            end, _ = self._extensions(np.array([capture]), LEAD_IN if outward else TURNAROUND)
            point = self._captures.take(slice(capture, capture + 1))
            # Lead-ins and turnarounds are flown like rows, the rest at one safe height.
            both = [end, point] if outward else [point, end]
            near = self._raise_legs(self._around(_Points.joined(both)))
            near = near.take(slice(0, -1) if outward else slice(1, None))
            outer = near if len(near.kind) else point
            place = outer.take(slice(0, 1) if outward else slice(-1, None))
            home = self._transit(place, capture) if self._home is not None else near.take(slice(0, 0))
            if not outward:
                home = home.take(slice(None, None, -1))
                home = home._replace(kind=np.where(home.kind == TAKEOFF, LANDING, home.kind).astype(np.int8))
            way = _Points.joined([home, near] if outward else [near, home])
            timed = _Points.joined([way, point] if outward else [point, way])
            seconds = self._legs_s(timed)
            self._ways[key] = way, float(seconds.sum())
        return self._ways[key]

    def _transit(self, place: _Points, capture: int) -> _Points:
        """Points from take-off to a place (excluded): up, across at one safe height, and down."""
        if self._home is None:
            return place.take(slice(0, 0))
        home = np.array(self._home[:1]), np.array(self._home[1:])
        across = self._crossing(_Points.create(TRANSIT, *home, place.height), place, float(self._asked_agl[capture]))
        if float(across.height[0] - place.height[0]) <= _CLIMB_M:
            across = across.take(slice(0, -1))
        takeoff = _Points.create(TAKEOFF, *home, np.array([self._base_m]))
        return _Points.joined([takeoff, across])

    def _safe_height_m(self, points: _Points, agl_m: float) -> float:
        """Least height that is safe on all legs; minus infinity over level ground."""
        return max(
            (
                float(self._leg_heights_m(below.highest_m, below.ground_m, agl_m)[1].max())
                for below in self._relief.profiles(points.lat, points.lon, self._plane)
            ),
            default=-math.inf,
        )

    # --- time

    @property
    def _hover_s(self) -> float:
        return HOVER_S if self._mission.trigger == HOVER else 0.0

    def _legs_s(self, points: _Points) -> Floats:
        """Seconds of each leg, (m - 1,), with hovering at the capture where it begins."""
        flown_legs = legs(points.lat, points.lon)
        airspeed, wind = self._leg_airspeeds(points), self._mission.wind
        speed: Floats | float = airspeed
        if wind is not None:
            speed = wind.ground_speed_m_per_s(flown_legs.azimuth_deg, airspeed)
        climb = self._mission.terrain.climb_m_per_s or CLIMB_M_PER_S
        seconds = np.maximum(flown_legs.distance_m / speed, np.abs(np.diff(points.height)) / climb)
        hovered: Floats = seconds + self._hover_s * (points.capture[:-1] >= 0)
        return hovered

    def _leg_airspeeds(self, points: _Points) -> Floats | float:
        """Airspeed of each leg, (m - 1,), or of all: that of the next capture, or of the last one if none follows."""
        if self._airspeeds is None:
            return self._mission.flight.airspeed_m_per_s
        at = np.flatnonzero(points.capture >= 0)
        ahead = at[np.minimum(np.searchsorted(at, np.arange(1, len(points.kind))), len(at) - 1)]
        found: Floats = self._airspeeds[points.capture[ahead]]
        return found


def _nearby_rings(polygon: Polygon, lon_deg: float) -> list[tuple[Floats, Floats]]:
    """Rings of a polygon, shifted by whole turns to be near a longitude."""
    rings = polygon.arrays()
    turn = 360.0 * round((lon_deg - float(rings[0][0].mean())) / 360.0)
    return [_cut(lon + turn, lat) for lon, lat in rings]


def _cut(lon_deg: Floats, lat_deg: Floats) -> tuple[Floats, Floats]:
    """Ring with its sides divided into pieces that are straight in a plane."""
    along = legs(np.append(lat_deg, lat_deg[0]), np.append(lon_deg, lon_deg[0])).distance_m
    # Sides follow parallels: pieces of 1 km deviate by 2 cm where parallels bend most. 256 pieces bound the time.
    pieces = np.clip(np.ceil(along / 1000.0), 1, 256).astype(np.int64)
    side, number = expand_counts(pieces)
    share = number / pieces[side]
    lon, lat = (part[side] + share * (np.roll(part, -1) - part)[side] for part in (lon_deg, lat_deg))
    return lon, lat


def _inserted(points: _Points, added: list[tuple[int, _Points]]) -> _Points:
    """Points with others inserted into legs, keyed by start point."""
    if not added:
        return points
    keys = [np.arange(len(points.kind), dtype=np.float64)]
    keys += [leg + np.arange(1.0, len(more.kind) + 1.0) / (len(more.kind) + 1.0) for leg, more in added]
    whole = _Points.joined([points, *(more for _, more in added)])
    return whole.take(np.argsort(np.concatenate(keys), kind="stable"))


def _raised_nodes(share: Floats, least: Floats, given: Floats, ends: tuple[float, float]) -> tuple[Numbers, Floats]:
    """Nodes of a leg that a path must pass to be nowhere below ``least``: indices and heights, (k,) each.

    The node that lies lowest is raised, and the same is repeated on both sides of it.
    """
    height = {0: ends[0], len(share) - 1: ends[1]}
    waiting = [(0, len(share) - 1)]
    while waiting:
        first, last = waiting.pop()
        # Nodes at the ends have the heights of the ends.
        inner = np.flatnonzero((share[first:last] > share[first]) & (share[first:last] < share[last])) + first
        if not len(inner):
            continue
        line = np.interp(share[inner], share[[first, last]], [height[first], height[last]])
        lowest = int(np.argmax(least[inner] - line))
        if least[inner[lowest]] - line[lowest] > _NOISE_M:
            at = int(inner[lowest])
            height[at] = float(given[at])
            waiting += [(first, at), (at, last)]
    inner = np.array(sorted(height)[1:-1], np.int64)
    return inner, np.array([height[one] for one in inner.tolist()])
