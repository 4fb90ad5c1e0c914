"""Coordinate reference systems that services offer: which can be used, and how documents write positions in them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InvalidInput, Message
from ..geodesy.mercator import WebMercator
from ..geodesy.planes import ProjectedPlane

if TYPE_CHECKING:
    from pyproj import CRS

#: West, south, east and north of a box in degrees; the east may lie below the west across the antimeridian.
Bounds = tuple[float, float, float, float]
#: The Web-Mercator map's.
MAP = WebMercator.crs
#: Codes that name it, best first.
MERCATOR_CODES = (MAP, "EPSG:900913", "EPSG:102100", "EPSG:102113", "EPSG:3785")
#: How documents name a system: ``EPSG:2056``, ``urn:ogc:def:crs:EPSG::2056``, ``…/def/crs/EPSG/0/2056``.
_CODE = re.compile(r"(?:^|[:/])EPSG[:/](?:[\w.]*[:/]){0,2}(\d{1,7})$", re.IGNORECASE)
#: How they name Web Mercator, of whatever authority.
_MERCATOR = re.compile(r"(^|[:/])(3857|900913|102100|102113|3785)$")
#: Directions that the axes of a plane may have: east and north, or away from a pole.
_DIRECTIONS = ({"east", "north"}, {"north"}, {"south"})
_AXES = 2
#: Columns and rows of points at which a box is looked at in another system; about the pole, every 3.75 degrees.
_LOOKED_AT = (97, 25)
#: West, south, east and north of the whole Earth.
WORLD_DEG = (-180.0, -90.0, 180.0, 90.0)
#: Degrees around what is looked at.
_PLACE_DEG = 1e-3
#: Systems whose facts are kept: documents list hundreds.
_KEPT = 1024
#: Degrees from the middle of an area to a place whose northing is not its easting.
_ASIDE_DEG = (0.5, 0.7)
#: Systems that an error names, and characters of one.
_NAMED, _LONGEST = 12, 80
#: Name that a WKT begins with.
_NAME = re.compile(r'\["([^"]{1,80})')


def code_of(name: str) -> str:
    """``EPSG:code`` of a system as a document names it; as it is where it is none of those, Web Mercator as `MAP`."""
    name = name.strip()
    if _MERCATOR.search(name):
        return MAP
    found = _CODE.search(name)
    return f"EPSG:{int(found.group(1))}" if found else name


def is_usable(code: str) -> bool:
    """Whether a code is that of a projected system with an easting and a northing."""
    return code.startswith("EPSG:") and _system(code) is not None


@lru_cache(maxsize=_KEPT)
def northing_first(code: str) -> bool:
    """Whether a usable system's own order of coordinates is northing, easting: as PROJ has it, about the poles, too."""
    from pyproj import CRS, Transformer

    west, south, _, north = area_deg(code)
    lat, lon = (south + north) / 2.0 + _ASIDE_DEG[0], west + _ASIDE_DEG[1]
    crs = CRS.from_user_input(code)
    own = Transformer.from_crs("EPSG:4326", crs).transform(lat, lon)
    by_easting = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(lon, lat)
    return bool(own != by_easting)


def unit_m(code: str) -> float:
    """Metres of a usable system's unit."""
    return ProjectedPlane(code, 0.0, 0.0, 1.0, 1.0).unit_m


def area_deg(code: str) -> Bounds:
    """West, south, east and north of a usable system's area of use; of the world where it states none."""
    area = getattr(_system(code), "area_of_use", None)
    return WORLD_DEG if area is None else (area.west, area.south, area.east, area.north)


def likeness(code: str, bounds_deg: Bounds) -> float:
    """How well a usable system's area of use suits a box: what they share, over what they cover together.

    Parameters
    ----------
    code : str
    bounds_deg : Bounds
    """
    west, south, east, north = _unrolled(*bounds_deg)
    # A place has no extent to share.
    one = west - _PLACE_DEG, south - _PLACE_DEG, east + _PLACE_DEG, north + _PLACE_DEG
    other = _unrolled(*area_deg(code))
    turns = (-360.0, 0.0, 360.0)
    width = sum(max(min(one[2], other[2] + turn) - max(one[0], other[0] + turn), 0.0) for turn in turns)
    shared = min(width, 360.0) * max(_height(max(one[1], other[1]), min(one[3], other[3])), 0.0)
    both = sum((box[2] - box[0]) * _height(box[1], box[3]) for box in (one, other)) - shared
    return shared / both if both > 0.0 else 0.0


def best_of(codes: Iterable[str], *boxes_deg: Bounds) -> str:
    """Return the system that suits the first box best; of those that do equally the next one, and then the first."""
    return max(codes, key=lambda code: [likeness(code, box) for box in boxes_deg])


def box_on(
    plane: ProjectedPlane, bounds_deg: tuple[float, float, float, float]
) -> tuple[float, float, float, float] | None:
    """West, north, east and south, as fractions of a plane, of what a box in degrees has on it; None for nothing."""
    west, south, east, north = _unrolled(*bounds_deg)
    lon, lat = np.meshgrid(np.linspace(west, east, _LOOKED_AT[0]), np.linspace(south, north, _LOOKED_AT[1]))
    u, v = plane.forward(lat, np.mod(lon + 180.0, 360.0) - 180.0)
    there = np.isfinite(u) & np.isfinite(v)
    if not there.any():
        return None
    u, v = u[there], v[there]
    return float(u.min()), float(v.min()), float(u.max()), float(v.max())


def plane_of(stated: Mapping[str, Any]) -> ProjectedPlane:
    """Plane that an entry of the catalogue states.

    Raises
    ------
    InvalidInput
        A number that is none, a rectangle without extent, or a system that cannot be used.
    """
    edges = {name: stated.get(name) for name in ("west", "north", "width", "height")}
    code = stated.get("crs")
    numbers = [edge for edge in edges.values() if isinstance(edge, (int, float)) and math.isfinite(edge)]
    if set(stated) != {"crs", *edges} or len(numbers) != len(edges) or min(numbers[2:]) <= 0.0:
        raise InvalidInput(
            "plane {0}: must be crs, and west, north, width and height as numbers", dict(stated)
        )
    if not isinstance(code, str) or code_of(code) == MAP or not is_usable(code):
        raise InvalidInput("plane of {0!r}: must be that of a projected system, such as EPSG:2056", code)
    return ProjectedPlane(code, *map(float, numbers))


def refused(wanted: str, title: str, offered: Iterable[str]) -> InvalidInput:
    """Error for a system that a source does not have, with those it has."""
    there = list(dict.fromkeys(offered))
    names: str = ", ".join(there[:_NAMED]) or Message("none")
    if len(there) > _NAMED:
        names = Message("{0} and {1} more", names, len(there) - _NAMED)
    return InvalidInput(
        "coordinate reference system {0}: {1} has {2}", _short(wanted), title, names, field="crs"
    )


def _short(crs: str) -> str:
    """Code of a system, or the name in its WKT, which need not be any."""
    named = _NAME.search(crs)
    return named.group(1) if named else crs[:_LONGEST]


@lru_cache(maxsize=1)
def _projected() -> frozenset[str]:
    """Numbers of EPSG's projected systems, deprecated ones included."""
    from pyproj.database import get_codes
    from pyproj.enums import PJType

    return frozenset(get_codes("EPSG", PJType.PROJECTED_CRS, allow_deprecated=True))


@lru_cache(maxsize=_KEPT)
def _system(code: str) -> CRS | None:
    """The system of a code; None where it cannot be used."""
    from pyproj import CRS
    from pyproj.exceptions import ProjError

    # PROJ takes tens of milliseconds to find that there is no such system, and documents list hundreds of them.
    if code.startswith("EPSG:") and code[5:].lstrip("0") not in _projected():
        return None
    try:
        crs = CRS.from_user_input(code)
    except ProjError:
        return None
    directions = {axis.direction.lower() for axis in crs.axis_info}
    usable = crs.is_projected and len(crs.axis_info) == _AXES and directions in _DIRECTIONS
    return crs if usable else None


def _unrolled(west: float, south: float, east: float, north: float) -> tuple[float, float, float, float]:
    return west, south, east + (360.0 if east < west else 0.0), north


def _height(south_deg: float, north_deg: float) -> float:
    """Share of a sphere's ground between latitudes, but for a factor."""
    return math.sin(math.radians(north_deg)) - math.sin(math.radians(south_deg))
