"""Places of a cross-view dataset: read from a file, or spread over a box."""

from __future__ import annotations

import hashlib
import itertools
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message
from ..geodesy.ellipsoid import WGS84
from ..geodesy.mercator import MAX_LAT_DEG
from ..limits import MAX_MISSION_BYTES, MAX_PAIR_PLACES
from ..mission.areas.area import Box, check_ground, check_lat_lon
from ..numbers import real_number
from ..storage.files import read_limited
from ..text.safe_json import decoded

_FORMATS = (
    "a file of lines `lat lon` or `lat lon name` (or the paper's `lat lon agl`), or a box "
    "latTL_lonTL_latBR_lonBR with a number of places"
)
_NUMBER = r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_BETWEEN = r"[\s,;_]+"
#: Signs and dashes that text processors put for a minus.
_MINUS = str.maketrans(dict.fromkeys("\u2212\u2013\ufe63\uff0d", "-"))


@dataclass(frozen=True)
class PairPlace:
    """A point on the ground.

    Parameters
    ----------
    lat_deg, lon_deg : float
        Latitude within Web Mercator, ±85.0511 degrees; longitude within ±360.
    name : str
        May be empty.
    """

    lat_deg: float
    lon_deg: float
    name: str = ""

    def __post_init__(self) -> None:
        check_lat_lon(self.lat_deg, self.lon_deg)
        if abs(self.lat_deg) > MAX_LAT_DEG:
            raise InvalidInput("latitude {0}: the map ends at ±{1:.4f}", self.lat_deg, MAX_LAT_DEG)


def read_places(path: str | Path) -> tuple[PairPlace, ...]:
    """Read places from a text file, one a line: ``lat lon``, or ``lat lon name``.

    Separators are spaces, commas, semicolons and underscores; empty lines and those that begin with # are skipped. A
    file whose lines all continue with one or two numbers is the paper's coordinate file, ``lat lon agl [yaw]``; its
    heights and yaws, which are those of captures, are ignored.

    Raises
    ------
    InvalidInput
        A line cannot be read or repeats a place, or there are no places; the message names the line.
    """
    try:
        lines = decoded(read_limited(path, MAX_MISSION_BYTES, named_by_user=True)).splitlines()
    except (OSError, InvalidInput) as wrong:
        raise InvalidInput(
            "places {0}: cannot be read as text ({1})", path, wrong, remedy=Message("give {0}", _FORMATS)
        ) from wrong
    places: list[PairPlace] = []
    line_numbers: dict[tuple[float, float], int] = {}
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        place = _place(line, f"places {path}, line {number}:")
        before = line_numbers.setdefault((place.lat_deg, place.lon_deg), number)
        if before != number:
            raise InvalidInput(
                "places {0}, line {1}: the place of line {2} again",
                path,
                number,
                before,
                remedy="give each once",
            )
        places.append(place)
    if not places:
        raise InvalidInput("places {0}: holds none", path, remedy=Message("give {0}", _FORMATS))
    # In the paper's file, each line continues with a height and perhaps a yaw.
    heights = [re.fullmatch(rf"({_NUMBER})(?:{_BETWEEN}{_NUMBER})?", place.name) for place in places]
    if all(heights):
        for number, place, height in zip(line_numbers.values(), places, heights):
            if height is not None and float(height[1]) <= 0.0:
                raise InvalidInput(
                    "places {0}, line {1}: {2:g} {3:g} with height {4}: must be above 0; commas separate, "
                    "and decimals are written with a point",
                    path,
                    number,
                    place.lat_deg,
                    place.lon_deg,
                    height[1],
                )
        return tuple(PairPlace(place.lat_deg, place.lon_deg) for place in places)
    return tuple(places)


def _place(line: str, where: str) -> PairPlace:
    stripped = line.strip()
    found = re.fullmatch(rf"({_NUMBER}){_BETWEEN}({_NUMBER})(?:{_BETWEEN}(.*))?", stripped.translate(_MINUS))
    if found is None:
        raise InvalidInput("{0} {1!r} is not `lat lon` or `lat lon name`", where, stripped)
    lat, lon, rest = found.groups()
    # Take the name from the original text, with its dashes: translating changes no length.
    name = "" if rest is None else stripped[len(stripped) - len(rest) :]
    try:
        return PairPlace(float(lat), float(lon), name.strip())
    except InvalidInput as wrong:
        raise InvalidInput("{0} {1}", where, wrong) from wrong


def read_box(text: str) -> Box:
    """Read a box ``latTL_lonTL_latBR_lonBR``; a height after it, as in the paper, is ignored.

    Raises
    ------
    InvalidInput
    """
    fields = [field for field in re.split(_BETWEEN, text.translate(_MINUS).strip()) if field]
    try:
        values = [real_number(field) for field in fields]
    except ValueError as wrong:
        raise InvalidInput(
            "places {0!r}: no such file, and no box", text, remedy=Message("give {0}", _FORMATS)
        ) from wrong
    if len(values) not in (4, 5):
        raise InvalidInput("places {0!r}: {1} numbers", text, len(values), remedy=Message("give {0}", _FORMATS))
    box = Box(*values[:4])
    check_ground(box)
    return box


def spread_places(
    box: Box, count: int, spacing_m: float, seed: int, *, by_views: bool = False
) -> tuple[PairPlace, ...]:
    """Spread places over a box, evenly by area, with a least distance.

    Places follow from a hash of the seed: they are equal on every machine, and a larger count only adds places.

    Parameters
    ----------
    spacing_m : float
        Least distance in space, >= 0.
    by_views : bool
        Whether the spacing follows from the views, for the message where there is no room.

    Raises
    ------
    InvalidInput
        The box has no room for so many places.
    """
    if not 1 <= count <= MAX_PAIR_PLACES:
        raise InvalidInput("{0:,} places: must be from 1 to {1:,}", count, MAX_PAIR_PLACES)
    if not (math.isfinite(spacing_m) and spacing_m >= 0.0):
        raise InvalidInput("spacing {0} m: must be 0 or more", spacing_m)
    for lat in (box.south_deg, box.north_deg):
        PairPlace(lat, box.west_deg)
    places: list[PairPlace] = []
    taken = np.empty((count, 3))
    misses = 0
    for lat, lon in _random_points(box, seed):
        point = cartesian_m(np.array(lat), np.array(lon))
        nearest = np.sqrt(np.min(np.sum((taken[: len(places)] - point) ** 2, axis=-1), initial=np.inf))
        if nearest == 0.0 or nearest < spacing_m:
            misses += 1
            # After a thousand misses in a row, less than a hundredth of the box is almost certainly free.
            if misses == 1000:
                break
            continue
        misses = 0
        taken[len(places)] = point
        places.append(PairPlace(lat, lon))
        if len(places) == count:
            return tuple(places)
    views = "views that see less, " if by_views else ""
    raise InvalidInput(
        "{0:,} places {1:,.0f} m apart: the box has room for {2:,}",
        count,
        spacing_m,
        len(places),
        remedy=Message("give a larger box, fewer places, {0}or a smaller --spacing", views),
    )


def _random_points(box: Box, seed: int) -> Iterator[tuple[float, float]]:
    """Yield random points of a box endlessly, evenly by area on a sphere."""
    south, north = (math.sin(math.radians(lat)) for lat in (box.south_deg, box.north_deg))
    for number in itertools.count():
        digest = hashlib.blake2b(f"{seed}:{number}".encode(), digest_size=16).digest()
        across, up = (int.from_bytes(part, "big") / 2.0**64 for part in (digest[:8], digest[8:]))
        lat = math.degrees(math.asin(south + (north - south) * up))
        lon = box.west_deg + box.span_deg * across
        # Round to 1 cm, as sines differ between machines in the last digit.
        yield round(min(max(lat, box.south_deg), box.north_deg), 7), round(lon - 360.0 * (lon > 180.0), 7)


def cartesian_m(lat_deg: Floats, lon_deg: Floats) -> Floats:
    """Geocentric coordinates (..., 3) in metres of points on the WGS 84 ellipsoid (EPSG method 9602)."""
    phi, theta = np.radians(lat_deg), np.radians(lon_deg)
    normal = WGS84.normal_radius_m(lat_deg)
    return np.stack(
        [
            normal * np.cos(phi) * np.cos(theta),
            normal * np.cos(phi) * np.sin(theta),
            normal * (1.0 - WGS84.e2) * np.sin(phi),
        ],
        axis=-1,
    )
