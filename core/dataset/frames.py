"""Frames of labels: eastings and northings in metres that stand for latitudes and longitudes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS, Geod, Transformer
from pyproj.exceptions import CRSError

from ..errors import InvalidInput
from ..geodesy.mercator import HALF_WORLD_M, lat_to_v, lon_to_u, u_to_lon, v_to_lat, wrap_lon_deg
from ..geodesy.projections import through_proj, utm_zone
from .choices import FRAMES

Floats = NDArray[np.float64]

MERCATOR = "EPSG:3857"
#: Where UTM ends and the Universal Polar Stereographic system begins, degrees (NGA.SIG.0012).
_UTM_NORTH_DEG, _UTM_SOUTH_DEG = 84.0, -80.0
#: WGS 84 / UPS with easting before northing.
_UPS_NORTH, _UPS_SOUTH = "EPSG:5041", "EPSG:5042"
#: Most that a position may be off after the way to a frame and back, metres: projections in their domain keep
#: nanometres, shifts between datums, and an oblique plane beside a pole, some tenths of a millimetre.
_ROUND_TRIP_M = 1e-3
#: Most that a frame may enlarge the distance from the middle; Web Mercator enlarges 11.6 times where its map ends.
#: A frame whose seam parts the images enlarges far more.
_MOST_ENLARGED = 16.0


@dataclass(frozen=True)
class Frame:
    """A plane in metres, and the place that its longitudes are continuous with.

    Parameters
    ----------
    crs : str
        ``EPSG:…``, or PROJ's text of an oblique stereographic plane.
    middle_lat_deg, middle_lon_deg : float
        Middle of the positions it is for.
    zones : tuple of str
        UTM and UPS zones that these lie in, such as ``16N``, ``UPS north``.
    """

    crs: str
    middle_lat_deg: float
    middle_lon_deg: float
    zones: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """What people call it."""
        return "oblique stereographic about the middle" if self.crs.startswith("+") else _crs(self.crs).name

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Eastings and northings (n, 2) in metres of positions (n,) in degrees.

        In Web Mercator, positions beyond the antimeridian from the middle go on beyond the map's edge.
        """
        lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
        if self.crs == MERCATOR:
            continuous = self.middle_lon_deg + wrap_lon_deg(lon - self.middle_lon_deg)
            # The way to the middle and back would cost the last bits where nothing has to be wrapped.
            u = lon_to_u(np.where(np.abs(continuous - lon) < 180.0, lon, continuous))
            metres: Floats = np.stack([2.0 * u - 1.0, 1.0 - 2.0 * lat_to_v(lat)], axis=-1) * HALF_WORLD_M
            return metres
        return np.stack(through_proj(_transformer(self.crs).transform, lon, lat), axis=-1)

    def inverse(self, metres: Floats) -> tuple[Floats, Floats]:
        """Latitudes and longitudes (n,) in degrees, the latter in [-180, 180), of eastings and northings (n, 2)."""
        metres = np.asarray(metres, np.float64)
        east, north = metres[..., 0], metres[..., 1]
        if self.crs == MERCATOR:
            lat = v_to_lat((1.0 - north / HALF_WORLD_M) / 2.0)
            return lat, wrap_lon_deg(u_to_lon((east / HALF_WORLD_M + 1.0) / 2.0))
        lon, lat = through_proj(_transformer(self.crs).transform, east, north, direction="INVERSE")
        return lat, wrap_lon_deg(lon)


def frame_of(lat_deg: Floats, lon_deg: Floats, frame: str = "utm") -> Frame:
    """One frame for all of some positions (n,) in degrees, n > 0.

    Parameters
    ----------
    frame : str
        ``utm``: the UTM zone of their middle, with the exceptions of Norway and Svalbard, and UPS where the middle is
        north of 84° or south of 80° S. ``mercator``: EPSG:3857. ``mission``: an oblique stereographic plane about their
        middle, which has no zones and suits any place but a pole. Or a projected system in metres as ``EPSG:…``.

    Raises
    ------
    InvalidInput
        No such frame, no positions, or some that the frame cannot hold.
    """
    lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
    if not lat.size or not (np.isfinite(lat) & np.isfinite(lon) & (np.abs(lat) <= 90.0)).all():
        raise InvalidInput(
            f"frame {frame}: of {lat.size} positions; needs one or more, with latitudes from -90 to 90"
        )
    middle_lat, middle_lon = middle_of(lat, lon)
    found = Frame(_crs_of(frame, middle_lat, middle_lon), middle_lat, middle_lon, zones_of(lat, lon))
    _check_holds(found, frame, lat, lon)
    return found


def middle_of(lat_deg: Floats, lon_deg: Floats) -> tuple[float, float]:
    """Middle of the smallest box of latitude and longitude that holds positions (n,), in degrees."""
    lon = np.sort(wrap_lon_deg(lon_deg))
    gaps = np.append(np.diff(lon), lon[0] + 360.0 - lon[-1])
    widest = int(np.argmax(gaps))
    west = float(lon[(widest + 1) % len(lon)])
    middle = west + (360.0 - float(gaps[widest])) / 2.0
    return float(lat_deg.min() + lat_deg.max()) / 2.0, float(wrap_lon_deg(np.array(middle)))


def zones_of(lat_deg: Floats, lon_deg: Floats) -> tuple[str, ...]:
    """UTM and UPS zones that positions (n,) in degrees lie in, sorted."""
    places = set(zip(np.floor(lat_deg).tolist(), np.floor(wrap_lon_deg(lon_deg)).tolist()))
    # All borders of zones are whole degrees, so that a corner tells for all of its square of a degree.
    return tuple(sorted({_zone_name(lat, lon) for lat, lon in places}))


def _zone_name(lat_deg: float, lon_deg: float) -> str:
    if not _UTM_SOUTH_DEG <= lat_deg < _UTM_NORTH_DEG:
        return "UPS north" if lat_deg > 0.0 else "UPS south"
    zone = utm_zone(lat_deg, lon_deg)
    return f"{zone.number:02d}{'S' if zone.south else 'N'}"


def _crs_of(frame: str, lat_deg: float, lon_deg: float) -> str:
    if frame == "mercator":
        return MERCATOR
    if frame == "mission":
        return f"+proj=sterea +lat_0={lat_deg!r} +lon_0={lon_deg!r} +k=1 +ellps=WGS84 +units=m +type=crs"
    if frame == "utm":
        if lat_deg >= _UTM_NORTH_DEG:
            return _UPS_NORTH
        return _UPS_SOUTH if lat_deg < _UTM_SOUTH_DEG else f"EPSG:{utm_zone(lat_deg, lon_deg).epsg}"
    if re.fullmatch(r"EPSG:\d+", frame, re.IGNORECASE) is None:
        raise InvalidInput(f"frame {frame!r}: must be {', '.join(FRAMES)} or a code like EPSG:32616")
    code = frame.upper()
    try:
        crs = _crs(code)
    except CRSError as wrong:
        raise InvalidInput(
            f"frame {frame}: PROJ knows no such system; give the code of another one"
        ) from wrong
    if not crs.is_projected or any(axis.unit_name != "metre" for axis in crs.axis_info):
        raise InvalidInput(
            f"frame {frame}: is {crs.name}, no projected system in metres, which labels need; give the code of one"
        )
    return code


def _check_holds(frame: Frame, asked: str, lat: Floats, lon: Floats) -> None:
    """Raise InvalidInput unless a frame has a place for each position, from which it is found again."""
    metres = frame.forward(lat, lon)
    # What has no place is found by that, and not by a warning.
    with np.errstate(invalid="ignore"):
        back_lat, back_lon = frame.inverse(metres)
    geod = Geod(ellps="WGS84")
    # PROJ's word for what cannot be projected is infinity.
    held = np.isfinite(metres).all(axis=-1) & np.isfinite(back_lat) & np.isfinite(back_lon)
    if held.all():
        middle = frame.forward(np.array([frame.middle_lat_deg]), np.array([frame.middle_lon_deg]))
        away = np.hypot(*(metres - middle).T)
        middle_lon, middle_lat = (
            np.full_like(lon, frame.middle_lon_deg),
            np.full_like(lat, frame.middle_lat_deg),
        )
        ground = through_proj(geod.inv, middle_lon, middle_lat, lon, lat)[2]
        held &= through_proj(geod.inv, lon, lat, back_lon, back_lat)[2] <= _ROUND_TRIP_M
        # A middle that itself has no place tells nothing.
        held &= ~(away > _MOST_ENLARGED * ground + _ROUND_TRIP_M)
    if not held.all():
        worst = int(np.flatnonzero(~held)[0])
        place = f"{lat[worst]:.6f} {lon[worst]:.6f}"
        if asked in ("mission", "utm"):
            other = "utm" if asked == "mission" else "mission"
            raise InvalidInput(
                f"frame {asked}: {frame.crs} cannot hold all positions, such as {place}; choose {other}"
            )
        raise InvalidInput(
            f"frame {asked}: {frame.crs} cannot hold all positions, such as {place}; choose mission or utm"
        )


@lru_cache(maxsize=8)
def _crs(code: str) -> CRS:
    """Systems are costly to make (some ms)."""
    return CRS.from_user_input(code)


@lru_cache(maxsize=8)
def _transformer(code: str) -> Transformer:
    """From longitude and latitude on WGS84; costly to make, and used by one thread at a time."""
    return Transformer.from_crs(CRS.from_epsg(4326), _crs(code), always_xy=True)
