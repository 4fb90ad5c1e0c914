"""Areas of missions: boxes, polygons and points, and the parts of them inside bands and rectangles."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, Protocol, Union

import numpy as np

from ...arrays import Flags, Floats, Numbers
from ...errors import InvalidInput, Message
from ...fields import field_named
from ...geodesy.ellipsoid import WGS84, next_corners
from ...geodesy.mercator import v_to_lat, wrap_lon_deg
from ...limits import MAX_PAIRS_OF_SIDES, MAX_POLYGONS
from ..parts import HIGHEST_AGL_M, Attitude, Flight

Position = tuple[float, float]
#: Start longitude, start latitude, end longitude, end latitude of each edge.
Edges = tuple[Floats, Floats, Floats, Floats]
#: Pairs of edges, or of a rectangle and a corner of a polygon, per batch, which bounds memory to 13 MB.
_CHUNK = 100_000


def check_lat_lon(lat_deg: float, lon_deg: float) -> None:
    """Refuse a latitude beyond ±90 or a longitude beyond ±360 degrees (or not a number)."""
    if not -90.0 <= lat_deg <= 90.0:
        raise InvalidInput("latitude {0}: must be within -90 and 90 degrees", lat_deg)
    if not -360.0 <= lon_deg <= 360.0:
        raise InvalidInput("longitude {0}: must be within -360 and 360 degrees", lon_deg)


def check_ground(area: Area) -> None:
    """Refuse a box whose edges enclose no ground; `check_rings` does so for polygons."""
    if not isinstance(area, Box) or area.area_m2() > 0.0:
        return
    if area.north_deg == area.south_deg or area.span_deg > 0.0:
        raise InvalidInput(
            "box from latitude {0} down to {1}: has no height; its north must lie above its south",
            area.north_deg,
            area.south_deg,
            field="south",
        )
    raise InvalidInput(
        "box from longitude {0} to {1}: has no width; its west and its east must differ",
        area.west_deg,
        area.east_deg,
        field="east",
    )


def check_agl(agl_m: float) -> None:
    """Refuse a height above ground outside the limits of `Flight.agl_m`."""
    field_named(Flight, "agl_m").settled(agl_m)


#: Angles that points may state.
ANGLES = ("yaw", "tilt", "roll")
#: The year 10000, beyond ISO 8601.
LATEST_S = 253_402_300_800.0


def check_yaw(yaw_deg: float) -> None:
    """Refuse a yaw beyond ±360 degrees (or not a number)."""
    field_named(Attitude, "yaw_deg").settled(yaw_deg)


class _CoveredArea:
    """An area that rows of captures cover, as opposed to points."""

    covers_ground: ClassVar[bool] = True
    kind: ClassVar[str] = "raster"
    #: Areas state no times, unlike points.
    times_s: ClassVar[tuple[float, ...]] = ()

    def stated_deg(self, _name: str) -> tuple[float, ...]:
        """Return no angles: the mission's angles apply to all captures."""
        return ()


@dataclass(frozen=True)
class Box(_CoveredArea):
    """A box in degrees; where its west exceeds its east, it crosses the antimeridian."""

    north_deg: float
    west_deg: float
    south_deg: float
    east_deg: float

    def __post_init__(self) -> None:
        check_lat_lon(self.north_deg, self.west_deg)
        check_lat_lon(self.south_deg, self.east_deg)
        if self.south_deg > self.north_deg:
            raise InvalidInput(
                "box from latitude {0} down to {1}: south lies above north",
                self.north_deg,
                self.south_deg,
                remedy="give the top-left corner first",
            )

    @property
    def span_deg(self) -> float:
        """Longitudes from west to east, in [0, 360] degrees."""
        span = self.east_deg - self.west_deg
        return min(span, 360.0) if span >= 0.0 else span % 360.0

    @property
    def continuous_east_deg(self) -> float:
        """East edge, at least the west edge."""
        return self.west_deg + self.span_deg

    @property
    def edges_deg(self) -> tuple[float, float, float, float]:
        """West, south, east and north; east is at least west."""
        return self.west_deg, self.south_deg, self.continuous_east_deg, self.north_deg

    @property
    def bounds(self) -> Box:
        """The box itself."""
        return self

    @property
    def parts(self) -> tuple[Box | Polygon, ...]:
        """The box, as the only part."""
        return (self,)

    def arrays(self) -> list[tuple[Floats, Floats]]:
        """Longitudes and latitudes of the corners, as the only ring."""
        west, south, east, north = map(float, self.edges_deg)
        return [(np.array([west, east, east, west]), np.array([north, north, south, south]))]

    def area_m2(self) -> float:
        """Area on the ellipsoid, square metres."""
        return self.span_deg * float(WGS84.zone_area_m2_per_deg(np.asarray(self.south_deg), np.asarray(self.north_deg)))


@dataclass(frozen=True)
class Polygon(_CoveredArea):
    """A polygon with holes; edges are straight in longitude and latitude (RFC 7946).

    Parameters
    ----------
    rings : tuple of rings, each a tuple of (longitude, latitude) in degrees
        The outer ring first, then holes; closed or not. Longitudes are continuous across the antimeridian (179, 181);
        a jump of more than 180 degrees is taken as a crossing, except along a pole.
    """

    rings: tuple[tuple[Position, ...], ...]

    def __post_init__(self) -> None:
        if not self.rings:
            raise InvalidInput("polygon without a ring: needs at least one of three corners")
        outer, *holes = (_tidy_ring(ring) for ring in self.rings)
        west = min(lon for lon, _ in outer)
        outer = _shifted(outer, -math.floor((west + 180.0) / 360.0))
        middle = sum(lon for lon, _ in outer) / len(outer)
        near = (_shifted(hole, round((middle - hole[0][0]) / 360.0)) for hole in holes)
        object.__setattr__(self, "rings", (outer, *near))

    def arrays(self) -> list[tuple[Floats, Floats]]:
        """Longitudes and latitudes of each ring; continuous, the westernmost in [-180, 180)."""
        return [(np.array([p[0] for p in ring]), np.array([p[1] for p in ring])) for ring in self.rings]

    @cached_property
    def bounds(self) -> Box:
        """The smallest box around the outer ring."""
        lon, lat = self.arrays()[0]
        east = float(lon.max())
        return Box(float(lat.max()), float(lon.min()), float(lat.min()), east - 360.0 if east > 180.0 else east)

    @property
    def parts(self) -> tuple[Box | Polygon, ...]:
        """The polygon, as the only part."""
        return (self,)

    def area_m2(self) -> float:
        """Area on the ellipsoid without the holes, square metres."""
        outer, *holes = (WGS84.ring_area_m2(lon, lat) for lon, lat in self.arrays())
        return outer - sum(holes)


def _tidy_ring(ring: tuple[Position, ...]) -> tuple[Position, ...]:
    """Drop a ring's closing corner and make its longitudes continuous."""
    corners = [(float(lon), float(lat)) for lon, lat in ring]
    # Drop repeated closing corners as well, so that a ring read back equals the written ring.
    while len(corners) > 1 and corners[0] == corners[-1]:
        corners.pop()
    if len(corners) < 3:
        raise InvalidInput("polygon ring of {0} corners: needs at least 3", len(corners))
    for lon, lat in corners:
        check_lat_lon(lat, lon)
    tidy = [corners[0]]
    for lon, lat in corners[1:]:
        # Sides along a pole may span any number of degrees.
        along_pole = abs(lat) == 90.0 and lat == tidy[-1][1]
        turns = 0 if along_pole else round((lon - tidy[-1][0]) / 360.0)
        tidy.append((lon - 360.0 * turns, lat))
    return tuple(tidy)


@dataclass(frozen=True)
class Polygons(_CoveredArea):
    """Several polygons that one mission covers, each by separate rows.

    Equal polygons count once. Ground where different polygons overlap counts for each, and is covered for each.

    Parameters
    ----------
    parts : tuple of Polygon
        At least one.
    """

    parts: tuple[Polygon, ...]

    def __post_init__(self) -> None:
        parts = tuple(dict.fromkeys(self.parts))
        if not parts:
            raise InvalidInput("area of no polygons: needs at least one")
        if len(parts) > MAX_POLYGONS:
            raise InvalidInput("area of {0:,} polygons: must be {1:,} at most", len(parts), MAX_POLYGONS)
        object.__setattr__(self, "parts", parts)

    def placed(self) -> tuple[PlacedRings, ...]:
        """Return the parts, shifted to longitudes within the bounds, which continue beyond 180 degrees."""
        west = self.bounds.west_deg
        return tuple(PlacedRings.from_polygon(part, west) for part in self.parts)

    @property
    def bounds(self) -> Box:
        """The smallest box around all parts; may cross the antimeridian."""
        boxes = [part.bounds for part in self.parts]
        if len(boxes) == 1:
            return boxes[0]
        west, east = _shortest_span([(box.west_deg, box.continuous_east_deg) for box in boxes])
        north, south = max(box.north_deg for box in boxes), min(box.south_deg for box in boxes)
        return Box(north, west, south, east - 360.0 if east > 180.0 else east)

    def area_m2(self) -> float:
        """Sum of the parts' areas on the ellipsoid, square metres."""
        return sum(part.area_m2() for part in self.parts)


class PlacedRings(NamedTuple):
    """Rings of one polygon, the outer one first, shifted by whole turns of longitude."""

    rings: tuple[tuple[Floats, Floats], ...]

    @classmethod
    def from_polygon(cls, polygon: Polygon, west_deg: float) -> PlacedRings:
        """Shift a polygon so that its westernmost longitude lies in the turn east of a meridian."""
        rings = polygon.arrays()
        turn = 360.0 * math.ceil((west_deg - float(rings[0][0].min())) / 360.0)
        return cls(tuple((lon + turn, lat) for lon, lat in rings))

    def arrays(self) -> list[tuple[Floats, Floats]]:
        """Longitudes and latitudes of each ring."""
        return list(self.rings)

    @property
    def edges_deg(self) -> tuple[float, float, float, float]:
        """West, south, east and north of the outer ring."""
        lon, lat = self.rings[0]
        return float(lon.min()), float(lat.min()), float(lon.max()), float(lat.max())


def _shortest_span(spans: list[tuple[float, float]]) -> tuple[float, float]:
    """West and east end, in continuous degrees, of the shortest span that holds all spans; west in [-180, 180)."""
    spans = sorted(spans)
    reach, gaps = spans[0][1], []
    for west, east in spans[1:]:
        gaps.append((west - reach, west))
        reach = max(reach, east)
    # The gap from the last span back to the first comes first, so that it wins among equal gaps.
    widest, first = max([(spans[0][0] + 360.0 - reach, spans[0][0]), *gaps], key=lambda gap: gap[0])
    if widest <= 0.0:
        return -180.0, 180.0
    return first, max(east + 360.0 * (west < first) for west, east in spans)


@dataclass(frozen=True)
class Points:
    """Single captures at given places and heights.

    Parameters
    ----------
    poses : tuple of (latitude, longitude, height above ground), degrees and metres
    yaws_deg, tilts_deg, rolls_deg : tuple of float
        Yaw (-360 to 360), tilt and roll (-180 to 180) of each; empty where the mission's angle applies to all.
    times_s : tuple of float
        Times of capture, seconds after 1970 in UTC, not decreasing; empty where they follow from the mission's start
        and airspeed.
    """

    poses: tuple[tuple[float, float, float], ...]
    yaws_deg: tuple[float, ...] = ()
    tilts_deg: tuple[float, ...] = ()
    rolls_deg: tuple[float, ...] = ()
    times_s: tuple[float, ...] = ()

    covers_ground: ClassVar[bool] = False
    parts: ClassVar[tuple[Box | Polygon, ...]] = ()

    def __post_init__(self) -> None:
        if not self.poses:
            raise InvalidInput("list of points is empty: needs at least one latitude, longitude and height")
        for lat, lon, agl in self.poses if not _all_poses_allowed(self.poses) else ():
            check_lat_lon(lat, lon)
            check_agl(agl)
        for what, values in (
            (Message("yaws"), self.yaws_deg),
            (Message("tilts"), self.tilts_deg),
            (Message("rolls"), self.rolls_deg),
            (Message("times"), self.times_s),
        ):
            if values and len(values) != len(self.poses):
                raise InvalidInput(
                    "{0} {1} of {2} points: give one for each, or none", len(values), what, len(self.poses)
                )
        for name in ANGLES:
            field, angles = field_named(Attitude, f"{name}_deg"), self.stated_deg(name)
            for angle in () if _all_allowed(angles, field.least, field.most) else angles:
                field.settled(angle)
        _check_times(self.times_s)

    def stated_deg(self, name: str) -> tuple[float, ...]:
        """Angles of the points, by one of `ANGLES`; empty where the mission's angle applies to all."""
        stated: tuple[float, ...] = getattr(self, f"{name}s_deg")
        return stated

    @property
    def kind(self) -> str:
        """``single`` for one point, ``list`` for several."""
        return "single" if len(self.poses) == 1 else "list"

    def take(self, which: Sequence[int]) -> Points:
        """Some of the points, by index."""
        lists = ("poses", "yaws_deg", "tilts_deg", "rolls_deg", "times_s")
        values = ((name, getattr(self, name)) for name in lists)
        return Points(**{name: tuple(items[one] for one in which) for name, items in values if items})

    @property
    def bounds(self) -> Box:
        """The smallest box around the points; may cross the antimeridian."""
        lat, lon, _ = np.array(self.poses, np.float64).reshape(-1, 3).T
        lon = np.unique(np.where(np.abs(lon) <= 180.0, lon, wrap_lon_deg(lon)))
        # The box leaves out the widest gap between neighbours; the first gap crosses the antimeridian.
        gaps = np.diff(lon, prepend=lon[-1] - 360.0)
        first = int(np.argmax(gaps))
        return Box(float(lat.max()), float(lon[first]), float(lat.min()), float(lon[first - 1]))


def _all_allowed(numbers: tuple[Any, ...], least: float | None, most: float | None) -> bool:
    """Fast check of numbers against limits; where it fails, the slow check of each decides."""
    if least is None or most is None or not set(map(type, numbers)) <= {float, int}:
        return False
    values = np.array(numbers)
    return values.dtype.kind in "fi" and bool(((values >= least) & (values <= most)).all())


def _check_times(times_s: tuple[Any, ...]) -> None:
    if _all_allowed(times_s, 0.0, math.nextafter(LATEST_S, 0.0)) and bool((np.diff(times_s) >= 0.0).all()):
        return
    for at, time in enumerate(times_s):
        if not isinstance(time, (int, float)) or isinstance(time, bool) or not 0.0 <= time < LATEST_S:
            raise InvalidInput(
                "time {0!r} of point {1}: must be seconds after 1970, before the year 10000", time, at + 1
            )
        if at and time < times_s[at - 1]:
            raise InvalidInput(
                "time of point {0}: is before that of the one before it",
                at + 1,
                remedy="put the points in the order of their times",
            )


def _all_poses_allowed(poses: tuple[tuple[float, float, float], ...]) -> bool:
    """Fast check of poses; where it fails, the slow check of each decides."""
    values = np.array(poses) if len({len(pose) for pose in poses}) == 1 else np.empty(0)
    if values.dtype.kind not in "fiu" or values.shape[1:] != (3,):
        return False
    lat, lon, agl = values.T
    allowed = (np.abs(lat) <= 90.0) & (np.abs(lon) <= 360.0) & (agl > 0.0) & (agl <= HIGHEST_AGL_M)
    return bool(allowed.all())


def _shifted(ring: tuple[Position, ...], turns: int) -> tuple[Position, ...]:
    return tuple((lon + 360.0 * turns, lat) for lon, lat in ring) if turns else ring


Area = Union[Box, Polygon, Polygons, Points]


class Rings(Protocol):
    """Rings, the outer one first, with straight sides in degrees or in the coordinates of a plane."""

    def arrays(self) -> list[tuple[Floats, Floats]]:
        """First and second coordinates of each ring's corners."""
        ...


def polygon_edges(polygon: Rings) -> Edges:
    """Edges of all rings."""
    rings = polygon.arrays()
    lon0, lat0 = (np.concatenate(parts) for parts in zip(*rings))
    lon1, lat1 = (np.concatenate([np.roll(part, -1) for part in parts]) for parts in zip(*rings))
    return lon0, lat0, lon1, lat1


def shared_rings(area: Rings, others: Sequence[Polygon]) -> list[tuple[Floats, Floats]]:
    """Ground that an area shares with any of ``others``, as disjoint trapezoids between parallels.

    Longitudes are continuous with the area's.
    """
    rings = area.arrays()
    west, east = float(rings[0][0].min()), float(rings[0][0].max())
    south, north = float(rings[0][1].min()), float(rings[0][1].max())
    shapes = [rings]
    for other in others:
        other_rings = other.arrays()
        lon, lat = other_rings[0]
        if lat.max() <= south or lat.min() >= north:
            continue
        # The polygon appears once for each turn of longitude that the area spans.
        first = math.ceil((west - float(lon.max())) / 360.0)
        last = math.floor((east - float(lon.min())) / 360.0)
        shapes += [[(x + 360.0 * turn, y) for x, y in other_rings] for turn in range(first, last + 1)]
    edges, owners = [], []
    for owner, shape in enumerate(shapes):
        sides = np.stack(polygon_edges(PlacedRings(tuple(shape))))
        sides = sides[:, _enter_band((sides[0], sides[1], sides[2], sides[3]), south, north)]
        edges.append(sides)
        owners.append(np.full(sides.shape[1], owner))
    lon0, lat0, lon1, lat1 = np.concatenate(edges, axis=1)
    owner = np.concatenate(owners)
    if len(shapes) == 1:
        return []
    cuts = np.unique(np.concatenate([lat0, lat1, _crossing_places(lon0, lat0, lon1, lat1)[1]]))
    cuts = cuts[(cuts >= south) & (cuts <= north)]
    low, high = np.minimum(lat0, lat1), np.maximum(lat0, lat1)
    slope = (lon1 - lon0) / np.where(lat1 == lat0, 1.0, lat1 - lat0)
    found = []
    for bottom, top in zip(cuts[:-1].tolist(), cuts[1:].tolist()):
        here = np.flatnonzero((low < top) & (high > bottom))
        ends = [lon0[here] + slope[here] * (lat - lat0[here]) for lat in (bottom, top)]
        order = np.argsort(ends[0] + ends[1], kind="stable")
        inside, begun = [False] * len(shapes), -1
        for at in order.tolist():
            inside[owner[here[at]]] ^= True
            shared = inside[0] and any(inside[1:])
            if shared and begun < 0:
                begun = at
            elif begun >= 0 and not shared:
                lon = np.array([ends[0][begun], ends[0][at], ends[1][at], ends[1][begun]])
                found.append((lon, np.array([bottom, bottom, top, top])))
                begun = -1
    return found


def _crossing_places(lon0: Floats, lat0: Floats, lon1: Floats, lat1: Floats) -> tuple[Floats, Floats]:
    """Longitudes and latitudes at which edges (n,) cross each other; edges that touch do not cross."""
    # Edges that meet within this share of their length from an end only touch.
    end = 1e-9
    order = np.argsort(np.minimum(lon0, lon1), kind="stable")
    lon0, lat0, lon1, lat1 = (part[order] for part in (lon0, lat0, lon1, lat1))
    x, y = lon1 - lon0, lat1 - lat0
    lon, lat = [np.empty(0)], [np.empty(0)]
    for at, other in _pairs_of_edges(lon0, lon1):
        apart_x, apart_y = lon0[other] - lon0[at], lat0[other] - lat0[at]
        turn = x[at] * y[other] - y[at] * x[other]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (apart_x * y[other] - apart_y * x[other]) / turn
            other_share = (apart_x * y[at] - apart_y * x[at]) / turn
            cross = (share > end) & (share < 1.0 - end)
            cross &= (other_share > end) & (other_share < 1.0 - end)
        if cross.any():
            first = at[cross]
            lon.append(lon0[first] + share[cross] * x[first])
            lat.append(lat0[first] + share[cross] * y[first])
    return np.concatenate(lon), np.concatenate(lat)


def _pairs_of_edges(lon0: Floats, lon1: Floats) -> Iterator[tuple[Numbers, Numbers]]:
    """Yield pairs of edges that share longitudes, in batches; edges are sorted by their western ends."""
    west = np.minimum(lon0, lon1)
    # Count the edges that begin before each one ends.
    counts = np.maximum(np.searchsorted(west, np.maximum(lon0, lon1)) - np.arange(len(west)) - 1, 0)
    total = int(counts.sum())
    if total > MAX_PAIRS_OF_SIDES:
        raise InvalidInput(
            "polygon whose sides are too many beside each other: {0:,} pairs of them share a longitude; {1:,} at most",
            total,
            MAX_PAIRS_OF_SIDES,
        )
    return pairs_in_batches(np.arange(1, len(west) + 1), counts)


def pairs_in_batches(first: Numbers, counts: Numbers) -> Iterator[tuple[Numbers, Numbers]]:
    """Yield pairs of each index of ``first`` (n,) with ``counts`` numbers from ``first`` on, in batches."""
    totals = np.cumsum(counts)
    start = 0
    while start < len(counts):
        before = int(totals[start - 1]) if start else 0
        stop = max(int(np.searchsorted(totals, before + _CHUNK, side="right")), start + 1)
        at = np.repeat(np.arange(start, stop), counts[start:stop])
        rank = np.arange(len(at)) - np.repeat(totals[start:stop] - counts[start:stop] - before, counts[start:stop])
        yield at, first[at] + rank
        start = stop


def check_rings(polygon: Polygon) -> None:
    """Refuse a polygon that is not valid.

    Raises
    ------
    InvalidInput
        Sides cross, a hole lies outside, the polygon encloses no ground, or it surrounds a pole.
    """
    outer, *holes = polygon.arrays()
    if abs(outer[0][-1] - outer[0][0]) > 180.0:
        raise InvalidInput(
            "polygon around a pole: its sides are straight in degrees",
            remedy="give its corners along the pole as well",
        )
    lon, lat = _crossing_places(*polygon_edges(polygon))
    if len(lon):
        raise InvalidInput(
            "polygon whose sides cross at latitude {0:.6f}, longitude {1:.6f}: its sides may only touch",
            float(lat[0]),
            float(wrap_lon_deg(lon[:1])[0]),
        )
    whole = PlacedRings((outer,))
    for number, (hole_lon, hole_lat) in enumerate(holes, 1):
        # Middles of sides lie inside even where corners lie on the outer ring.
        at_lon, at_lat = (np.concatenate([at, (at + np.roll(at, -1)) / 2.0]) for at in (hole_lon, hole_lat))
        if not polygon_contains(whole, at_lat, at_lon).any():
            raise InvalidInput("polygon with hole {0:,} outside of it: holes lie inside the outer ring", number)
    west, south, east, north = whole.edges_deg
    sides_m2 = WGS84.a_m**2 * math.radians(max(east - west, north - south)) ** 2
    # Corners on one line enclose, by rounding, up to this share of the square around them.
    if polygon.area_m2() <= 1e-9 * sides_m2 * math.cos(math.radians(min(abs(south), abs(north)))):
        raise InvalidInput(
            "polygon without ground: its corners lie on one line or more than half the Earth apart, or its holes are "
            "all of it"
        )


def check_area(area: Area) -> None:
    """Refuse an area with an invalid polygon, see `check_rings`."""
    check_polygons([one for one in area.parts if isinstance(one, Polygon)], Message("area"), "area")


def check_polygons(polygons: Sequence[Polygon], what: Message, name: str) -> None:
    """Refuse invalid polygons, see `check_rings`; the message numbers the invalid polygon among several.

    Parameters
    ----------
    what : Message
        Name of the polygons, such as "area", for messages.
    name : str
        Field of the mission that holds the polygons.
    """
    for number, polygon in enumerate(polygons, 1):
        _check_named(polygon, what if len(polygons) == 1 else Message("{0}: polygon {1:,}", what, number), name)


def _check_named(polygon: Polygon, what: Message, name: str) -> None:
    try:
        check_rings(polygon)
    except InvalidInput as wrong:
        raise InvalidInput("{0}: {1}", what, wrong, field=name) from wrong


def band_spans(edges: Edges, south: float, north: float) -> tuple[Floats, Floats]:
    """Least and greatest longitude, inside the open band between two parallels, of each edge that enters the band."""
    inside = _enter_band(edges, south, north)
    return _clip_to_band(_select(edges, inside), south, north)


def _select(edges: Edges, which: Flags | Numbers) -> Edges:
    lon0, lat0, lon1, lat1 = (part[which] for part in edges)
    return lon0, lat0, lon1, lat1


def _enter_band(edges: Edges, south: Floats | float, north: Floats | float) -> Flags:
    """Which edges enter the open band between two parallels."""
    _, lat0, _, lat1 = edges
    reach: Flags = (np.maximum(lat0, lat1) > south) & (np.minimum(lat0, lat1) < north)
    return reach


def _clip_to_band(edges: Edges, south: Floats | float, north: Floats | float) -> tuple[Floats, Floats]:
    """Least and greatest longitude of each edge inside a band of latitude that it enters."""
    lon0, lat0, lon1, lat1 = edges
    rise = np.where(lat1 == lat0, 1.0, lat1 - lat0)
    slope = (lon1 - lon0) / rise
    ends = []
    for lon, lat in ((lon0, lat0), (lon1, lat1)):
        cut = np.clip(lat, south, north)
        ends.append(np.where(cut == lat, lon, lon0 + slope * (cut - lat0)))
    return np.minimum(*ends), np.maximum(*ends)


def row_spans(area: Box | Polygon, top_v: Floats, bottom_v: Floats) -> Floats:
    """West and east end, in continuous degrees, of an area inside each band of latitude.

    Parameters
    ----------
    top_v, bottom_v : array (n,)
        Bands as world fractions southward.

    Returns
    -------
    array (n, 2)
        NaN where a band misses the area.
    """
    if isinstance(area, Box):
        return np.tile([area.west_deg, area.continuous_east_deg], (len(top_v), 1))
    edges = polygon_edges(area)
    spans = np.full((len(top_v), 2), np.nan)
    for index, (south, north) in enumerate(zip(v_to_lat(bottom_v), v_to_lat(top_v))):
        west, east = band_spans(edges, float(south), float(north))
        if len(west):
            spans[index] = west.min(), east.max()
    return spans


def touching(polygon: Rings, west: Floats, south: Floats, east: Floats, north: Floats) -> Flags:
    """Which rectangles of degrees (n,) share ground with a polygon; longitudes are continuous with the polygon's.

    Consecutive rectangles with equal south and north are tested together.
    """
    edges = polygon_edges(polygon)
    touches = np.zeros(len(west), bool)
    change = np.flatnonzero((np.diff(south) != 0.0) | (np.diff(north) != 0.0)) + 1
    for start, stop in zip([0, *change], [*change, len(west)]):
        row = slice(start, stop)
        low, high = band_spans(edges, float(south[start]), float(north[start]))
        crossings = _crossings(edges, float(south[start] + north[start]) / 2.0)
        middle = (west[row] + east[row]) / 2.0
        inside = np.searchsorted(crossings, middle) % 2 == 1
        # An edge meets a rectangle unless the edge ends west of the rectangle or begins east of it.
        before = np.searchsorted(np.sort(high), west[row], side="right")
        after = len(low) - np.searchsorted(np.sort(low), east[row], side="left")
        touches[row] = inside | (before + after < len(low))
    return touches


def _crossings(edges: Edges, lat: float) -> Floats:
    """Sorted longitudes where a parallel crosses the polygon's edges."""
    _, lat0, _, lat1 = edges
    cross = (lat0 <= lat) != (lat1 <= lat)
    return np.sort(_crossing(_select(edges, cross), lat))


def _crossing(edges: Edges, lat: Floats | float) -> Floats:
    """Longitude where a parallel crosses each edge."""
    lon0, lat0, lon1, lat1 = edges
    lon: Floats = lon0 + (lat - lat0) * (lon1 - lon0) / (lat1 - lat0)
    return lon


def crossed_and_held(polygon: Rings, west: Floats, south: Floats, east: Floats, north: Floats) -> tuple[Flags, Flags]:
    """Which rectangles an edge of a polygon crosses, and which have their middle inside it, (n,) each.

    `touching` is true where either of the two is; here, rectangles need not lie in rows.
    """
    edges = polygon_edges(polygon)
    crossed = np.zeros(len(west), bool)
    for some in _batches(len(west), len(edges[0])):
        low, high = south[some, np.newaxis], north[some, np.newaxis]
        at, edge = np.nonzero(_enter_band(edges, low, high))
        least, greatest = _clip_to_band(_select(edges, edge), low[at, 0], high[at, 0])
        meets = (greatest > west[some][at]) & (least < east[some][at])
        crossed[some] = np.bincount(at[meets], minlength=len(low)) > 0
    return crossed, polygon_contains(polygon, (south + north) / 2.0, (west + east) / 2.0)


def polygon_contains(polygon: Rings, lat_deg: Floats, lon_deg: Floats) -> Flags:
    """Which places are inside a polygon, (n,); longitudes are continuous with the polygon's."""
    edges = polygon_edges(polygon)
    order = np.argsort(lat_deg, kind="stable")
    lat, lon = lat_deg[order], lon_deg[order]
    # The parallels of these places cross an edge; edges include their southern ends.
    first, end = (np.searchsorted(lat, side(edges[1], edges[3])) for side in (np.minimum, np.maximum))
    crossings = np.zeros(len(lat), np.int64)
    for edge, at in pairs_in_batches(first, end - first):
        before = _crossing(_select(edges, edge), lat[at]) < lon[at]
        crossings += np.bincount(at[before], minlength=len(lat))
    held = np.zeros(len(lat), bool)
    held[order] = crossings % 2 == 1
    return held


def area_contains(area: Area, lat_deg: Floats, lon_deg: Floats) -> Flags:
    """Which places are inside an area, (n,); longitudes may differ by whole turns."""
    west, south, _, north = area.bounds.edges_deg
    if isinstance(area, Box):
        in_turn = np.mod(lon_deg - west, 360.0) <= area.span_deg
        return np.asarray((lat_deg >= south) & (lat_deg <= north) & in_turn)
    found = np.zeros(np.shape(lat_deg), bool)
    for polygon in area.parts:
        west, south, east, north = polygon.bounds.edges_deg
        lon = lon_deg - 360.0 * np.floor((lon_deg - west) / 360.0)
        # Test only places in the polygon's box.
        near = np.flatnonzero((lat_deg >= south) & (lat_deg <= north) & (lon <= east) & ~found)
        found[near] = polygon_contains(polygon, lat_deg[near], lon[near])
    return found


def _batches(count: int, each: int) -> Iterator[slice]:
    """Batches of ``count`` values that need ``each`` numbers apiece, see `_CHUNK`."""
    step = max(_CHUNK // each, 1)
    return (slice(start, start + step) for start in range(0, count, step))


def area_within_m2(area: Box | Rings, west: Floats, south: Floats, east: Floats, north: Floats) -> Floats:
    """Square metres of an area inside rectangles of degrees, (n,); the rectangles for a Box must lie inside it."""
    if isinstance(area, Box):
        return (east - west) * WGS84.zone_area_m2_per_deg(south, north)
    return ground_m2(area, west, south, east, north, lambda lon, lat: (lat, lon))


def ground_m2(
    polygon: Rings,
    west: Floats,
    south: Floats,
    east: Floats,
    north: Floats,
    geodetic: Callable[[Floats, Floats], tuple[Floats, Floats]],
) -> Floats:
    """Square metres of a polygon inside rectangles of its coordinates, (n,).

    Parameters
    ----------
    geodetic : callable
        Converts coordinates to latitudes and continuous longitudes.
    """
    rectangles = np.stack([west, south, east, north], axis=1)
    crossed, held = crossed_and_held(polygon, west, south, east, north)
    ground = np.zeros(len(rectangles))
    corners = rectangles[:, [[0, 1], [2, 1], [2, 3], [0, 3]]]
    # Only rectangles that an edge crosses need clipping.
    whole = np.flatnonzero(held & ~crossed)
    for some in _batches(len(whole), 4):
        count = len(whole[some])
        inside = corners[whole[some]].reshape(-1, 2)
        lat, lon = geodetic(inside[:, 0], inside[:, 1])
        ground[whole[some]] = WGS84.ring_areas_m2(lon, lat, np.repeat(np.arange(count), 4), count)
    cut = np.flatnonzero(crossed)
    sign = 1.0
    for ring in polygon.arrays():
        for some in _batches(len(cut), len(ring[0])):
            inside, owner = _clip(np.stack(ring, axis=1), rectangles[cut[some]])
            lat, lon = geodetic(inside[:, 0], inside[:, 1])
            ground[cut[some]] += sign * WGS84.ring_areas_m2(lon, lat, owner, len(cut[some]))
        sign = -1.0
    return ground


def _clip(ring: Floats, rectangles: Floats) -> tuple[Floats, Numbers]:
    """Clip a ring to each of n rectangles (n, 4), by Sutherland and Hodgman: corners (m, 2), and their rectangles (m,).

    Rectangles that miss the ring have no corners.
    """
    points, owner = np.tile(ring, (len(rectangles), 1)), np.repeat(np.arange(len(rectangles)), len(ring))
    for side, axis, sense in ((0, 0, 1.0), (2, 0, -1.0), (1, 1, 1.0), (3, 1, -1.0)):
        points, owner = _cut(points, owner, axis, rectangles[owner, side], sense)
        some = np.bincount(owner, minlength=len(rectangles))[owner] > 2
        points, owner = points[some], owner[some]
    return points, owner


def cut_half_plane(lon: Floats, lat: Floats, axis: int, limit: float, sense: float) -> tuple[Floats, Floats]:
    """Cut a ring at a meridian (axis 0) or parallel (axis 1) ``limit``, and keep one side.

    Parameters
    ----------
    lon, lat : array (n,)
        Corners in degrees, not closed.
    sense : float
        1 keeps the side of greater coordinates, -1 the other.

    Returns
    -------
    arrays (m,), (m,)
        Corners of that side; separate pieces of a concave ring stay joined along the cut.
    """
    points, _ = _cut(np.stack([lon, lat], axis=1), np.zeros(len(lon), np.int64), axis, limit, sense)
    return points[:, 0], points[:, 1]


def _cut(points: Floats, ring: Numbers, axis: int, limit: Floats | float, sense: float) -> tuple[Floats, Numbers]:
    """Cut consecutive rings, given by corners (n, 2) and the ring of each (n,), at one limit or a limit per corner."""
    following = points[next_corners(ring)]
    depth = sense * (points[:, axis] - limit)
    next_depth = sense * (following[:, axis] - limit)
    cross = (depth >= 0.0) != (next_depth >= 0.0)
    share = np.where(cross, depth / np.where(cross, depth - next_depth, 1.0), 0.0)
    cuts = points + share[:, np.newaxis] * (following - points)
    cuts[:, axis] = np.where(cross, limit, cuts[:, axis])
    both = np.stack([points, cuts], axis=1).reshape(-1, 2)
    keep = np.stack([depth >= 0.0, cross], axis=1).ravel()
    return both[keep], np.repeat(ring, 2)[keep]
