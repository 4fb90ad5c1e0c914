"""Areas moved and stretched by degrees. Knows no widget and no map."""

from __future__ import annotations

import math
from dataclasses import replace

from ...core.geodesy.mercator import MAX_LAT_DEG
from ...core.mission.area import Area, Box, Polygon

#: Edges come no nearer to each other: a decimetre on the ground, which the fields' seven decimals still show.
LEAST_SPAN_DEG = 1e-6
_POLE_DEG = 90.0
_TURN_DEG = 360.0


def wrapped(lon_deg: float) -> float:
    """Longitude in [-180, 180)."""
    return lon_deg if -180.0 <= lon_deg < 180.0 else (lon_deg + 180.0) % _TURN_DEG - 180.0


def continuous_box(north_deg: float, west_deg: float, south_deg: float, east_deg: float) -> Box:
    """Box of edges whose longitudes run on across the antimeridian."""
    if east_deg - west_deg >= _TURN_DEG:
        return Box(north_deg, -180.0, south_deg, 180.0)
    turn = _TURN_DEG * math.floor((west_deg + 180.0) / _TURN_DEG)
    west, east = west_deg - turn, east_deg - turn
    return Box(north_deg, west, south_deg, east - _TURN_DEG if east > 180.0 else east)


def moved(area: Area, dlat_deg: float, dlon_deg: float) -> Area:
    """Area moved by degrees: across the antimeridian freely, but no edge of it past where pictures end.

    Those end at Web Mercator's latitudes; an area beyond them already goes as far as the pole.
    """
    bounds = area.bounds
    limit = _limit(max(abs(bounds.north_deg), abs(bounds.south_deg)))
    dlat = min(max(dlat_deg, -limit - bounds.south_deg), limit - bounds.north_deg)
    if isinstance(area, Box):
        north, south = min(area.north_deg + dlat, limit), max(area.south_deg + dlat, -limit)
        return continuous_box(north, area.west_deg + dlon_deg, south, area.continuous_east_deg + dlon_deg)
    if isinstance(area, Polygon):
        return Polygon(
            tuple(tuple((lon + dlon_deg, _kept(lat + dlat)) for lon, lat in ring) for ring in area.rings)
        )
    return replace(
        area, poses=tuple((_kept(lat + dlat), wrapped(lon + dlon_deg), agl) for lat, lon, agl in area.poses)
    )


def stretched(box: Box, edges: frozenset[str], dlat_deg: float, dlon_deg: float) -> Box:
    """Box with some of its edges (north, west, south, east) moved by degrees, none past the opposite one."""
    north, south = box.north_deg, box.south_deg
    west, east = box.west_deg, box.continuous_east_deg
    if "north" in edges:
        north = min(max(north + dlat_deg, south + LEAST_SPAN_DEG), _limit(abs(north)))
    if "south" in edges:
        south = max(min(south + dlat_deg, north - LEAST_SPAN_DEG), -_limit(abs(south)))
    if "west" in edges:
        west = max(min(west + dlon_deg, east - LEAST_SPAN_DEG), east - _TURN_DEG)
    if "east" in edges:
        east = min(max(east + dlon_deg, west + LEAST_SPAN_DEG), west + _TURN_DEG)
    return continuous_box(north, west, south, east)


def is_inside(area: Area, lon_deg: float, lat_deg: float) -> bool:
    """Whether a place is in an area's box."""
    box = area.bounds
    east_of = (lon_deg - box.west_deg) % _TURN_DEG
    return box.south_deg <= lat_deg <= box.north_deg and east_of <= box.span_deg


def middle_of(area: Area) -> tuple[float, float]:
    """Longitude and latitude of the middle of an area's box."""
    box = area.bounds
    return wrapped(box.west_deg + box.span_deg / 2.0), (box.north_deg + box.south_deg) / 2.0


def _kept(lat_deg: float) -> float:
    """Latitude that a sum's last digit has not carried past a pole."""
    return min(max(lat_deg, -_POLE_DEG), _POLE_DEG)


def _limit(lat_deg: float) -> float:
    return MAX_LAT_DEG if lat_deg <= MAX_LAT_DEG else _POLE_DEG
