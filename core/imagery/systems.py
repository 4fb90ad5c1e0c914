"""Coordinate reference systems of services: names in documents, axis order, area of use."""

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

#: West, south, east and north of a box in degrees; east is less than west if the box crosses the antimeridian.
Bounds = tuple[float, float, float, float]
#: CRS of the Web-Mercator map.
MAP = WebMercator.crs
#: Codes of Web Mercator, preferred first.
MERCATOR_CODES = (MAP, "EPSG:900913", "EPSG:102100", "EPSG:102113", "EPSG:3785")
#: West, south, east and north of the whole Earth.
WORLD_DEG = (-180.0, -90.0, 180.0, 90.0)
#: Systems kept in memory, as documents list hundreds.
_CACHED = 1024


def epsg_code(name: str) -> str:
    """Convert a system's name in a document to ``EPSG:code``; `MAP` for Web Mercator, other text unchanged.

    Accepted forms are ``EPSG:2056``, ``urn:ogc:def:crs:EPSG::2056`` and ``…/def/crs/EPSG/0/2056``.
    """
    name = name.strip()
    if re.search(r"(^|[:/])(3857|900913|102100|102113|3785)$", name):
        return MAP
    found = re.search(r"(?:^|[:/])EPSG[:/](?:[\w.]*[:/]){0,2}(\d{1,7})$", name, re.IGNORECASE)
    return f"EPSG:{int(found.group(1))}" if found else name


def is_usable(code: str) -> bool:
    """Whether a code names a projected system with an easting and a northing."""
    return code.startswith("EPSG:") and _system(code) is not None


@lru_cache(maxsize=_CACHED)
def northing_first(code: str) -> bool:
    """Whether the axis order of a usable system, by PROJ, is northing, easting; this holds for polar systems, too."""
    from pyproj import CRS, Transformer

    west, south, _, north = area_deg(code)
    # A place off the middle, where northing and easting differ.
    lat, lon = (south + north) / 2.0 + 0.5, west + 0.7
    crs = CRS.from_user_input(code)
    by_axes = Transformer.from_crs("EPSG:4326", crs).transform(lat, lon)
    by_easting = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(lon, lat)
    return bool(by_axes != by_easting)


def unit_m(code: str) -> float:
    """Metres per unit of a usable system."""
    return ProjectedPlane(code, 0.0, 0.0, 1.0, 1.0).unit_m


def area_deg(code: str) -> Bounds:
    """West, south, east and north of a usable system's area of use; the world if none is stated."""
    area = getattr(_system(code), "area_of_use", None)
    return WORLD_DEG if area is None else (area.west, area.south, area.east, area.north)


def likeness(code: str, bounds_deg: Bounds) -> float:
    """Intersection over union of a usable system's area of use and a box."""
    west, south, east, north = _unrolled(*bounds_deg)
    # Margin in degrees, as a box of a single place has no area.
    margin = 1e-3
    one = west - margin, south - margin, east + margin, north + margin
    other = _unrolled(*area_deg(code))
    turns = (-360.0, 0.0, 360.0)
    width = sum(max(min(one[2], other[2] + turn) - max(one[0], other[0] + turn), 0.0) for turn in turns)
    shared = min(width, 360.0) * max(_height(max(one[1], other[1]), min(one[3], other[3])), 0.0)
    both = sum((box[2] - box[0]) * _height(box[1], box[3]) for box in (one, other)) - shared
    return shared / both if both > 0.0 else 0.0


def best_system(codes: Iterable[str], *boxes_deg: Bounds) -> str:
    """Return the system whose area of use is most similar to the first box; in a tie, to the next box."""
    return max(codes, key=lambda code: [likeness(code, box) for box in boxes_deg])


def project_box(
    plane: ProjectedPlane, bounds_deg: tuple[float, float, float, float]
) -> tuple[float, float, float, float] | None:
    """Convert a box in degrees to west, north, east and south as fractions of a plane; None if outside its domain."""
    west, south, east, north = _unrolled(*bounds_deg)
    # 97 longitudes are a point every 3.75 degrees around a pole.
    lon, lat = np.meshgrid(np.linspace(west, east, 97), np.linspace(south, north, 25))
    u, v = plane.forward(lat, np.mod(lon + 180.0, 360.0) - 180.0)
    finite = np.isfinite(u) & np.isfinite(v)
    if not finite.any():
        return None
    u, v = u[finite], v[finite]
    return float(u.min()), float(v.min()), float(u.max()), float(v.max())


def read_plane(stated: Mapping[str, Any]) -> ProjectedPlane:
    """Read the plane in an entry of the catalogue.

    Raises
    ------
    InvalidInput
        An invalid number, a rectangle without extent, or an unusable system.
    """
    edges = {name: stated.get(name) for name in ("west", "north", "width", "height")}
    code = stated.get("crs")
    numbers = [edge for edge in edges.values() if isinstance(edge, (int, float)) and math.isfinite(edge)]
    if set(stated) != {"crs", *edges} or len(numbers) != len(edges) or min(numbers[2:]) <= 0.0:
        raise InvalidInput("plane {0}: must be crs, and west, north, width and height as numbers", dict(stated))
    if not isinstance(code, str) or epsg_code(code) == MAP or not is_usable(code):
        raise InvalidInput("plane of {0!r}: must be that of a projected system, such as EPSG:2056", code)
    return ProjectedPlane(code, *map(float, numbers))


def refused(wanted: str, title: str, offered: Iterable[str]) -> InvalidInput:
    """Error for a system that a source lacks; lists up to twelve available systems."""
    available = list(dict.fromkeys(offered))
    names: str = ", ".join(available[:12]) or Message("none")
    if len(available) > 12:
        names = Message("{0} and {1} more", names, len(available) - 12)
    return InvalidInput("coordinate reference system {0}: {1} has {2}", _short(wanted), title, names, field="crs")


def _short(crs: str) -> str:
    """Code of a system, or the name in its WKT, cut to 80 characters."""
    named = re.search(r'\["([^"]{1,80})', crs)
    return named.group(1) if named else crs[:80]


@lru_cache(maxsize=1)
def _projected() -> frozenset[str]:
    """Numbers of EPSG's projected systems, including deprecated ones."""
    from pyproj.database import get_codes
    from pyproj.enums import PJType

    return frozenset(get_codes("EPSG", PJType.PROJECTED_CRS, allow_deprecated=True))


@lru_cache(maxsize=_CACHED)
def _system(code: str) -> CRS | None:
    """System of a code; None if it cannot be used."""
    from pyproj import CRS
    from pyproj.exceptions import ProjError

    # PROJ takes tens of milliseconds for an unknown code, and documents list hundreds of unknown codes.
    if code.startswith("EPSG:") and code[5:].lstrip("0") not in _projected():
        return None
    try:
        crs = CRS.from_user_input(code)
    except ProjError:
        return None
    directions = {axis.direction.lower() for axis in crs.axis_info}
    # Axes must point east and north or, around a pole, both in one direction.
    usable = directions in ({"east", "north"}, {"north"}, {"south"})
    return crs if crs.is_projected and len(crs.axis_info) == 2 and usable else None


def _unrolled(west: float, south: float, east: float, north: float) -> tuple[float, float, float, float]:
    return west, south, east + (360.0 if east < west else 0.0), north


def _height(south_deg: float, north_deg: float) -> float:
    """Difference of the sines of latitudes, proportional to the area between them."""
    return math.sin(math.radians(north_deg)) - math.sin(math.radians(south_deg))
