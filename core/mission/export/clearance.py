"""Exported flights over relief, read back from their files and checked against the surface.

Each format has a reader, which follows the rules of the format (reference of heights, cut corners) and uses nothing of
the plan but its relief and take-off.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
import zipfile
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Floats, NDArray, expand_counts
from ...errors import InvalidInput, Message
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.projections import LocalPlane
from ..plan import Plan
from ..relief.ground import PathGround, refuse_hole
from .sorties import continuous

#: Row that separates two lines of points.
_BREAK = np.full((1, 3), np.nan)
#: Number of a waypoint in its file, latitude, longitude and height.
Place = tuple[str, float, float, float]

#: Points closer than this, in metres, count as one.
_SAME_M = 1e-3
#: Paths pass a place within this distance, metres: drones cut corners by 0.2 m, and rows bend on the Earth.
_PASSED_M = 0.5
#: A number in the text of a file.
_NUMBER = r"([-+.\deE]+)"
_GPX_POINT = re.compile(
    rf'<rtept lat="{_NUMBER}" lon="{_NUMBER}">.*?<terrainav:agl_m>{_NUMBER}</terrainav:agl_m>', re.DOTALL
)
_WPML_MARK = re.compile(
    rf"<coordinates>{_NUMBER},{_NUMBER}</coordinates>.*?<wpml:index>(\d+)</wpml:index>.*?"
    rf"<wpml:executeHeight>{_NUMBER}</wpml:executeHeight>.*?"
    rf"<wpml:waypointTurnDampingDist>{_NUMBER}</wpml:waypointTurnDampingDist>",
    re.DOTALL,
)


class FlownPath(NamedTuple):
    """Straight legs from point to point, (n,) each.

    Attributes
    ----------
    waypoint : tuple of str
        Number of each point in the file.
    lat_deg, lon_deg : array
        Longitudes are continuous.
    height_m : array
        Heights above the ellipsoid.
    """

    waypoint: tuple[str, ...]
    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats


class Reader:
    """Reader of the files of a plan.

    Parameters
    ----------
    plan : Plan
        Over relief.
    """

    def __init__(self, plan: Plan) -> None:
        self._lon_deg = float(plan.lon_deg[0])
        self._takeoff, self._takeoff_m = plan.mission.route.takeoff, plan.path.base_m
        self._relief, self._clearance_m = plan.relief, plan.mission.terrain.clearance_m

    def _path(self, places: Iterable[Place], base_m: float | None) -> list[FlownPath]:
        """Path through points with heights above ``base_m``, or above the ground below each if None."""
        found = list(places)
        if len(found) < 2:
            return []
        names = tuple(place[0] for place in found)
        lat, lon, height = np.array([place[1:] for place in found]).T
        lon = continuous(lon, self._lon_deg)
        if base_m is not None:
            return [FlownPath(names, lat, lon, height + base_m)]
        base = self._ground(lat, lon).ground_m(lat, lon)
        if np.isnan(base).any():
            lost = int(np.argmax(np.isnan(base)))
            refuse_hole(float(lat[lost]), float(wrap_lon_deg(lon[lost])))
        return [FlownPath(names, lat, lon, height + base)]

    def _ground(self, lat: Floats, lon: Floats) -> PathGround:
        return self._relief.around(lat, lon, 0.0)

    def plan(self, text: str) -> list[FlownPath]:
        """Paths of QGroundControl's ``.plan``, with heights above the planned home; autopilots choose the return."""
        mission = json.loads(text)["mission"]
        # MAV_FRAME_GLOBAL_RELATIVE_ALT: heights above home.
        places: list[Place] = [
            (str(item["doJumpId"]), *item["params"][4:])
            for item in chain.from_iterable(map(_simple_items, mission["items"]))
            if item["frame"] == 3
        ]
        return self._path(places, mission["plannedHomePosition"][2])

    def litchi(self, text: str) -> list[FlownPath]:
        """Paths of Litchi's table, with heights above the ground below each waypoint."""
        places = (
            (str(number), float(row["latitude"]), float(row["longitude"]), float(row["altitude(m)"]))
            for number, row in enumerate(csv.DictReader(io.StringIO(text)), 1)
        )
        return self._path(places, None)

    def kmz(self, data: bytes) -> list[FlownPath]:
        """Paths of a KMZ of WPML, with heights above the take-off.

        The aircraft climbs, crosses to the first waypoint, and returns at the return height. Where it passes a waypoint
        without a stop, it cuts the corner.
        """
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            template, flown = (archive.read(f"wpmz/{name}").decode() for name in ("template.kml", "waylines.wpml"))
        places, cuts_m = [], []
        for lon, lat, index, height, cut_m in _WPML_MARK.findall(flown):
            places.append((index, float(lat), float(lon), float(height)))
            cuts_m.append(float(cut_m))
        first, last = places[0], places[-1]
        found = re.search(rf"<wpml:takeOffRefPoint>{_NUMBER},{_NUMBER},{_NUMBER}<", template)
        home = self._home(first)
        if found:
            home = float(found.group(1)), float(found.group(2)), float(found.group(3))
        up_m, back_m = (
            max(float(re.findall(rf"<wpml:{name}>{_NUMBER}<", flown)[0]), one[3])
            for name, one in (("takeOffSecurityHeight", first), ("globalRTHHeight", last))
        )
        whole = [
            *(("take-off", lat, lon, up_m) for lat, lon in (home[:2], first[1:3])),
            *_cut_corners(places, cuts_m),
            *(("return", lat, lon, back_m) for lat, lon in (last[1:3], home[:2])),
        ]
        return self._path(whole, home[2])

    def _home(self, first: Place) -> tuple[float, float, float]:
        """Take-off for files without one, as of DJI Fly: the mission's, or the ground below the first waypoint."""
        if self._takeoff is not None:
            return (*self._takeoff, self._takeoff_m)
        lat, lon = np.array([first[1]]), continuous(np.array([first[2]]), self._lon_deg)
        return first[1], first[2], float(self._ground(lat, lon).ground_m(lat, lon)[0])

    def above_ground(self, places: Iterable[Floats]) -> list[FlownPath]:
        """Paths through blocks of points (k, 3), such as `gpx_points` returns, with heights above ground."""
        whole = np.concatenate([*places, _BREAK])
        ends = np.flatnonzero(np.isnan(whole[:, 0]))
        found = []
        for first, end in zip(np.append(0, ends + 1), ends):
            rows = whole[first:end].tolist()
            found += self._path(((str(at), lat, lon, agl) for at, (lat, lon, agl) in enumerate(rows, 1)), None)
        return found

    def check(self, ways: Iterable[FlownPath], name: str) -> None:
        """Refuse paths that are closer to the surface than the clearance, or below it.

        Paths are sampled every half metre, without the climb at the beginning and the descent at the end.

        Parameters
        ----------
        name : str
            File name for the message.

        Raises
        ------
        InvalidInput
            The message names the position, the leg and the missing height.
        """
        for path in map(_without_climbs, ways):
            if len(path.waypoint) < 2:
                continue
            ground = self._ground(path.lat_deg, path.lon_deg)
            worst, at = -np.inf, (0, 0.0, 0.0)
            for leg, lat, lon, height in _samples(path):
                short = ground.highest_within_m(lat, lon) + self._clearance_m - height
                most = int(np.argmax(short))
                if short[most] > worst:
                    worst, at = float(short[most]), (int(leg[most]), float(lat[most]), float(lon[most]))
            # Rounded coordinates beside a wall may reduce the clearance by up to 5 cm.
            if worst > 0.05:
                raise self._refusal(name, path, at, worst)

    def departure_note(self, ways: Iterable[FlownPath], plan: Plan) -> Message:
        """Note on how far paths are from the planned heights at images, with the heights above ground there.

        Images are found where the paths pass their planned places, in flight order.
        """
        lat, lon = (np.asarray(values) for values in (plan.meant.lat_deg, plan.meant.lon_deg))
        planned = np.asarray(plan.ground_m + plan.meant.agl_m)
        begins = np.append(True, np.diff(plan.row) != 0)
        heights: list[float] = []
        waypoints = 0
        for path in ways:
            waypoints += len({name for name in path.waypoint if name.isdigit()})
            rest = slice(len(heights), None)
            heights += _heights_at(path, lat[rest], lon[rest], begins[rest])
        passed = slice(0, len(heights))
        departure = np.abs(np.array(heights) - planned[passed])
        above = np.array(heights) - self._ground(lat[passed], lon[passed]).ground_m(lat[passed], lon[passed])
        worst = int(np.argmax(departure))
        return Message(
            "read back: {0:,} waypoints; {1:,} images at most {2:.2f} m from their planned height (latitude {3:.6f}, "
            "longitude {4:.6f}), {5:.1f} to {6:.1f} m above ground",
            waypoints,
            len(heights),
            float(departure[worst]),
            float(lat[worst]),
            float(wrap_lon_deg(lon[worst])),
            float(above.min()),
            float(above.max()),
        )

    def _refusal(self, name: str, path: FlownPath, at: tuple[int, float, float], short_m: float) -> InvalidInput:
        leg, lat, lon = at
        values = (
            name,
            path.waypoint[leg],
            path.waypoint[leg + 1],
            lat,
            float(wrap_lon_deg(np.array(lon))),
            short_m,
        )
        if self._clearance_m:
            return InvalidInput(
                "{0}: between waypoints {1} and {2} the flight comes {5:.2f} m short of its clearance of {6:g} m, at "
                "latitude {3:.6f}, longitude {4:.6f}",
                *values,
                self._clearance_m,
                field="clearance_m",
            )
        return InvalidInput(
            "{0}: between waypoints {1} and {2} the flight comes {5:.2f} m below the surface, at latitude {3:.6f}, "
            "longitude {4:.6f}",
            *values,
            field="agl_m",
        )


def gpx_points(text: str) -> Floats:
    """Latitudes, longitudes and heights above ground of route points, (k, 3), with a row of NaN before each route.

    ``text`` is a part of a GPX file that ends between points; heights are read from the extensions.
    """
    first, *routes = (np.array(_GPX_POINT.findall(route), np.float64).reshape(-1, 3) for route in text.split("<rte>"))
    return np.concatenate([first, *chain.from_iterable((_BREAK, route) for route in routes)])


def kml_points(text: str) -> Floats:
    """Like `gpx_points`, for the flight lines in a part of a KML file that ends between lines."""
    pattern = "<LineString><altitudeMode>relativeToGround</altitudeMode><coordinates>([^<]*)</coordinates></LineString>"
    lines = (np.array(line.replace(",", " ").split(), np.float64) for line in re.findall(pattern, text))
    return np.concatenate([_BREAK, *chain.from_iterable((_BREAK, line.reshape(-1, 3)[:, [1, 0, 2]]) for line in lines)])


def geopackage_points(path: Path) -> Floats:
    """Like `gpx_points`, for the flight lines of a GeoPackage."""
    from osgeo import ogr

    data = ogr.Open(str(path))
    lines = [feature.GetGeometryRef().Clone() for feature in data.GetLayerByName("flight_line")]
    parts = chain.from_iterable(
        (line.GetGeometryRef(part).GetPoints() for part in range(line.GetGeometryCount())) for line in lines
    )
    return np.concatenate([_BREAK, *chain.from_iterable((_BREAK, np.array(part)[:, [1, 0, 2]]) for part in parts)])


def _heights_at(path: FlownPath, lat_deg: Floats, lon_deg: Floats, begins: NDArray[np.bool_]) -> list[float]:
    """Heights at which a path passes over the first of some places (n,), in order, up to the first it does not pass.

    ``begins`` says which places begin a row: these are waypoints, the last of several there, as after a descent.
    """
    plane = LocalPlane(float(path.lat_deg[0]), float(path.lon_deg[0]))
    lon = continuous(lon_deg, plane.lon_deg)
    x, y, height = (values.tolist() for values in (*plane.forward(path.lat_deg, path.lon_deg), path.height_m))
    found: list[float] = []
    leg = 0
    for east, north, is_first in zip(*(values.tolist() for values in (*plane.forward(lat_deg, lon), begins))):
        if is_first:
            near = (at for at in range(leg, len(x)) if math.hypot(x[at] - east, y[at] - north) <= _PASSED_M)
            at = next(near, None)
            if at is None:
                break
            while at + 1 < len(x) and math.hypot(x[at + 1] - east, y[at + 1] - north) <= _PASSED_M:
                at += 1
            leg = at
            found.append(height[at])
            continue
        shares = ((at, _share_passed(x[at : at + 2], y[at : at + 2], east, north)) for at in range(leg, len(x) - 1))
        passed = next((one for one in shares if one[1] is not None), None)
        if passed is None:
            break
        leg, share = passed
        found.append(height[leg] + (share or 0.0) * (height[leg + 1] - height[leg]))
    return found


def _share_passed(x: list[float], y: list[float], east: float, north: float) -> float | None:
    """Share of a leg at which it passes a place; None if it does not, or has no length."""
    along, across = x[1] - x[0], y[1] - y[0]
    length = math.hypot(along, across)
    if length < _SAME_M:
        return None
    share = ((east - x[0]) * along + (north - y[0]) * across) / length**2
    if not -_PASSED_M / length <= share <= 1.0 + _PASSED_M / length:
        return None
    share = min(max(share, 0.0), 1.0)
    away_m = math.hypot(x[0] + share * along - east, y[0] + share * across - north)
    return share if away_m <= _PASSED_M else None


def _simple_items(item: dict[str, Any]) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = item["TransectStyleComplexItem"]["Items"] if item["type"] == "ComplexItem" else [item]
    return found


def _cut_corners(places: list[Place], cuts_m: list[float]) -> Iterator[Place]:
    """Points with each corner replaced by two points, at the cut distance before and after it."""
    plane = LocalPlane(places[0][1], places[0][2])
    lat, lon, height = np.array([place[1:] for place in places]).T
    at = np.stack([*plane.forward(lat, continuous(lon, plane.lon_deg)), height], axis=1)
    leg = np.diff(at, axis=0)
    direction = leg / np.maximum(np.linalg.norm(leg, axis=1), _SAME_M)[:, np.newaxis]
    cut = np.flatnonzero(cuts_m)
    offset = np.stack([-direction[cut - 1], direction[cut]], axis=1) * np.array(cuts_m)[cut, np.newaxis, np.newaxis]
    corners = (at[cut, np.newaxis] + offset).reshape(-1, 3)
    ends = zip(*(values.tolist() for values in (*plane.inverse(*corners.T[:2]), corners[:, 2])))
    for place, cut_m in zip(places, cuts_m):
        if not cut_m:
            yield place
            continue
        yield (place[0], *next(ends))
        yield (place[0], *next(ends))


def _without_climbs(path: FlownPath) -> FlownPath:
    """Path without a vertical climb at the beginning and a vertical descent at the end."""
    plane = LocalPlane(float(path.lat_deg[0]), float(path.lon_deg[0]))
    x, y = plane.forward(path.lat_deg, path.lon_deg)
    length = np.hypot(np.diff(x), np.diff(y))
    some = slice(int(length[0] < _SAME_M), len(x) - int(length[-1] < _SAME_M))
    return FlownPath._make(column[some] for column in path)


def _samples(path: FlownPath) -> Iterator[tuple[NDArray[np.int64], Floats, Floats, Floats]]:
    """Samples along a path, in blocks: number of the leg, latitude, longitude and height."""
    plane = LocalPlane(float(path.lat_deg[0]), float(path.lon_deg[0]))
    x, y = plane.forward(path.lat_deg, path.lon_deg)
    length = np.hypot(np.diff(x), np.diff(y))
    # Pieces of 100 m are straight in longitude and latitude to half a millimetre at 60 degrees of latitude.
    pieces = np.maximum(np.ceil(length / 100.0), 1.0).astype(np.int64)
    leg, number = expand_counts(pieces)
    share = number / pieces[leg]
    x, y, height = (values[leg] + share * np.diff(values)[leg] for values in (x, y, path.height_m))
    lat, lon = plane.inverse(x, y)
    ends = [np.append(a, b[-1]) for a, b in zip((lat, lon, height), path[1:])]
    steps = np.maximum(np.ceil(length / pieces / 0.5), 1.0).astype(np.int64)[leg]
    for some in np.split(np.arange(len(leg)), np.flatnonzero(np.diff(np.cumsum(steps) // (1 << 20))) + 1):
        count = steps[some] + 1
        piece, number = expand_counts(count)
        piece = some[piece]
        along = number / steps[piece]
        lat, lon, height = (values[piece] + along * np.diff(values)[piece] for values in ends)
        yield leg[piece], lat, lon, height
