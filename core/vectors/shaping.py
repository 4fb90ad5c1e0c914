"""Rings of features in WGS 84, with vertices where edges straight in the file's plane would bend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Callable

import numpy as np

from ..arrays import Floats, Numbers, expand_counts
from ..errors import InvalidInput
from ..geodesy.reference import check_reference
from .features import LINE, POLYGON
from .wkb import Part

#: Greatest distance of an edge in longitude and latitude from the edge in the file's plane.
TOLERANCE_M = 1e-3
#: PROJ's names of the datum of WGS 84, and the degree in radians.
_WGS84 = ("World Geodetic System 1984", "World Geodetic System 1984 ensemble")
_DEGREE = 0.017453292519943295
_M_PER_DEG = 111_320.0
#: Most pieces that an edge is divided into at once, and how often pieces are divided.
_MOST_PIECES, _ROUNDS = 1000, 4

ToDegrees = Callable[[Floats, Floats], tuple[Floats, Floats]]


class Reference:
    """A layer's reference system: from its plane to longitude and latitude.

    Raises
    ------
    InvalidInput
        The definition is none, or no places on the Earth.
    """

    def __init__(self, definition: str) -> None:
        from pyproj import CRS, Transformer
        from pyproj.exceptions import CRSError, ProjError

        check_reference(definition)
        try:
            crs = CRS.from_user_input(definition)
            self._transformer = Transformer.from_crs(crs, "OGC:CRS84", always_xy=True)
        except (CRSError, ProjError) as wrong:
            raise InvalidInput("reference system cannot be read: {0}", str(wrong)[:200]) from wrong
        #: Whether coordinates are degrees, so that edges may span more than half the Earth.
        self.is_geographic = crs.is_geographic
        self._is_degrees = (
            self.is_geographic
            and getattr(crs.datum, "name", "") in _WGS84
            and all(axis.unit_conversion_factor == _DEGREE for axis in crs.axis_info[:2])
        )

    def degrees(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Longitude and latitude of places in the plane, each (n,)."""
        if self._is_degrees:
            return x, y
        lon, lat = self._transformer.transform(x, y)
        return np.asarray(lon, np.float64), np.asarray(lat, np.float64)

    def traced(self, x: Floats, y: Floats, ring: Numbers) -> tuple[Floats, Floats, Numbers]:
        """Longitudes, latitudes and rings of the vertices (n,) of lines and rings, and of those that edges need."""
        if self._is_degrees:
            return x, y, ring
        for _ in range(_ROUNDS):
            lon, lat = self._continuous(x, y, ring)
            pieces = self._pieces(x, y, lon, lat, ring)
            if (pieces <= 1).all():
                break
            x, y, ring = _divided(x, y, ring, pieces)
        lon, lat = self._continuous(x, y, ring)
        return lon, lat, ring

    def _continuous(self, x: Floats, y: Floats, ring: Numbers) -> tuple[Floats, Floats]:
        """Degrees, with longitudes that do not jump at the antimeridian within a ring of a plane."""
        lon, lat = self.degrees(x, y)
        if self.is_geographic or np.ptp(lon) < 180.0:
            return lon, lat
        turns = -np.round(np.diff(lon, prepend=lon[:1]) / 360.0)
        turns[np.diff(ring, prepend=ring[:1] - 1) != 0] = 0.0
        total = np.cumsum(turns)
        first = np.searchsorted(ring, ring)
        return lon + 360.0 * (total - total[first]), lat

    def _pieces(self, x: Floats, y: Floats, lon: Floats, lat: Floats, ring: Numbers) -> Numbers:
        """Number of pieces that each edge needs (n - 1,)."""
        worst = np.zeros(len(x) - 1)
        # An edge that bends both ways may be straight at its middle.
        for share in (0.5, 0.25):
            at_lon, at_lat = self.degrees(x[:-1] + share * np.diff(x), y[:-1] + share * np.diff(y))
            east = (at_lon - (lon[:-1] + share * np.diff(lon)) + 180.0) % 360.0 - 180.0
            north = at_lat - (lat[:-1] + share * np.diff(lat))
            worst = np.fmax(worst, np.hypot(east * np.cos(np.radians(at_lat)), north) * _M_PER_DEG)
        pieces = np.ceil(np.sqrt(np.where(np.isfinite(worst), worst, 0.0) / TOLERANCE_M))
        pieces[ring[1:] != ring[:-1]] = 1
        return np.asarray(np.clip(pieces, 1, _MOST_PIECES), np.int64)


def _divided(x: Floats, y: Floats, ring: Numbers, pieces: Numbers) -> tuple[Floats, Floats, Numbers]:
    """Divide edges into equal pieces."""
    counts = np.append(pieces, 1)
    edge, step = expand_counts(counts)
    share = step / counts[edge]
    after = np.minimum(edge + 1, len(x) - 1)
    return x[edge] + share * (x[after] - x[edge]), y[edge] + share * (y[after] - y[edge]), ring[edge]


def shaped(features: Sequence[list[Part]], reference: Reference) -> list[list[Part]]:
    """Parts in longitude and latitude; those without area or length are left out, and rings are turned as stated."""
    rings = [
        ring if kind != POLYGON else _closed(ring) for parts in features for kind, all_of in parts for ring in all_of
    ]
    if not rings:
        return [[] for _ in features]
    counts = [len(ring) for ring in rings]
    plane = np.concatenate(rings)
    lon, lat, ring = reference.traced(plane[:, 0], plane[:, 1], np.repeat(np.arange(len(rings)), counts))
    ends = np.searchsorted(ring, np.arange(1, len(rings)))
    degrees = iter(np.split(np.column_stack([lon, lat]), ends))
    wraps = not reference.is_geographic
    return [_kept([(kind, [next(degrees) for _ in all_of]) for kind, all_of in parts], wraps) for parts in features]


def _closed(ring: Floats) -> Floats:
    return ring if len(ring) and (ring[0] == ring[-1]).all() else np.concatenate([ring, ring[:1]])


def _kept(parts: list[Part], wraps: bool) -> list[Part]:
    """Parts with area or length; with ``wraps``, all at the same turn of the Earth."""
    found: list[Part] = []
    for kind, given in parts:
        if not all(np.isfinite(ring).all() for ring in given):
            continue
        origin = found[0][1][0][0, 0] if found else given[0][0, 0]
        rings = [_beside(ring, origin) for ring in given] if wraps else given
        if kind == POLYGON:
            areas = [_area(ring) for ring in rings]
            if areas[0] == 0.0:
                continue
            rings = [
                ring if (area > 0) == (place == 0) else ring[::-1]
                for place, (ring, area) in enumerate(zip(rings, areas))
                if area != 0.0
            ]
        elif kind == LINE and not np.ptp(rings[0], axis=0).any():
            continue
        found.append((kind, rings))
    return found


def _beside(ring: Floats, lon_deg: float) -> Floats:
    """Shift a ring by whole turns to a longitude."""
    return np.asarray(ring + np.array([360.0 * round((lon_deg - ring[0, 0]) / 360.0), 0.0]))


def _area(ring: Floats) -> float:
    """Signed area, positive counter-clockwise."""
    x, y = (ring - ring[0]).T
    return float(np.dot(x[:-1], y[1:]) - np.dot(x[1:], y[:-1])) / 2.0


def extent(parts: list[Part]) -> tuple[float, float, float, float]:
    """West, south, east and north."""
    outer = [rings[0] for _, rings in parts]
    low, high = (
        np.min([ring.min(axis=0) for ring in outer], axis=0),
        np.max([ring.max(axis=0) for ring in outer], axis=0),
    )
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def size_m(box: tuple[float, float, float, float]) -> float:
    """Longer side of a box, approximately."""
    west, south, east, north = box
    narrow = np.cos(np.radians(min(abs(south), abs(north)))) if south * north > 0 else 1.0
    return float(max((east - west) * narrow, north - south) * _M_PER_DEG)
