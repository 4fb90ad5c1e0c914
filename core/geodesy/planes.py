"""Planes of projected coordinate reference systems: scale, convergence and bend. PROJ is imported only where used."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, TypeVar

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers
from ..errors import InvalidInput
from .ellipsoid import WGS84, Ellipsoid, arctan2, sin_cos, trace

if TYPE_CHECKING:
    from pyproj import CRS


#: Whole numbers or positions, one or many.
At = TypeVar("At", int, NDArray[Any])

#: Height in metres above the ground points whose differences give the derivatives of a projection.
_ABOVE_M = 1e3
#: Tangent at which first derivatives look to either side: over 20 m of ground, whose noise (2e-9 m) turns north by
#: 1e-10 rad.
_NEAR = 1e-2
#: Tangent at which second derivatives look to either side: over 2 km of ground.
_FAR = 1.0


@dataclass(frozen=True)
class ProjectedPlane:
    """A rectangle of a CRS's plane as fractions: u along eastings, v down from the north.

    The CRS is projected or, only for heights, geographic, with degrees of longitude and latitude as coordinates.

    Parameters
    ----------
    crs : str
        ``EPSG:code``, or WKT for a CRS without a code.
    west, north : float
        Easting and northing of the corner u = v = 0, in the CRS's unit.
    width, height : float
        Size of the rectangle, up to u = v = 1, in the CRS's unit.
    """

    #: Whether u wraps around the Earth.
    wraps: ClassVar[bool] = False
    #: Largest spread of u in a cell; a cell of larger spread has ground on both sides of a pole.
    widest_cell: ClassVar[float] = math.inf

    crs: str
    west: float
    north: float
    width: float
    height: float

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Fractions u, v of positions in degrees (any shape); not finite beyond the projection."""
        x, y = self.to_crs(lat_deg, lon_deg)
        with np.errstate(invalid="ignore"):
            return (x - self.west) / self.width, (self.north - y) / self.height

    def inverse(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude (in [-180, 180]) in degrees of fractions (any shape)."""
        return self.from_crs(
            self.west + np.asarray(u, np.float64) * self.width,
            self.north - np.asarray(v, np.float64) * self.height,
        )

    def meridian_u(self, lon_deg: Floats) -> Floats:
        """Fractions from which frames and views of cameras at longitudes (any shape) count: the plane's west."""
        return np.zeros(np.shape(lon_deg))

    def seen(self, lat_deg: Floats, lon_deg: Floats, dlon_deg: Floats) -> tuple[Floats, Floats]:
        """Fractions of ground ``dlon_deg`` east of cameras at longitudes (any shapes), u from `meridian_u`."""
        return self.forward(lat_deg, lon_deg + dlon_deg)

    def shows(self, v: Floats) -> Flags:
        """Whether the projection reaches positions (any shape)."""
        return np.asarray(np.isfinite(v))

    def shorter(self, du: Floats) -> Floats:
        """Distances along u, >= 0, unchanged: the plane does not wrap."""
        return du

    def wrapped(self, at: At, _count: int, /) -> At:
        """Columns, or positions, in a world of ``count``, unchanged: the plane does not wrap."""
        return at

    def clipped(self, row: Numbers, _count: int, /) -> Numbers:
        """Rows in a world of ``count``, unchanged: sources may have rows beyond the plane."""
        return row

    def grid_azimuth_deg(self, azimuth_deg: Floats, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """True azimuths at positions (n,), counted from grid north."""
        return azimuth_deg + self.north_deg(lat_deg, lon_deg)

    def bends(self, v: Floats, places: Callable[[], tuple[Floats, Floats]]) -> Floats:
        """`bend` at positions (any shape), huge where unknown; ``places`` returns their latitudes and longitudes."""
        shown = self.shows(v)
        bend = self.bend(*(np.where(shown, angle, 0.0) for angle in places()))
        # With such a bend no cell is within any tolerance.
        return np.where(shown & np.isfinite(bend), bend, 1e12)

    def frame_bend(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Greatest `bend` over positions (n,), one number, for the error bound of map frames."""
        return np.asarray(self.greatest_bend(lat_deg, lon_deg))

    def focal_px(
        self, lat_deg: Floats, lon_deg: Floats, agl_m: Floats, ground: Ellipsoid, world_px: float
    ) -> tuple[Floats, Floats]:
        """Focal lengths along x and y, px, of map frames from ``agl_m`` above ``ground`` at positions (n,).

        Parameters
        ----------
        ground : Ellipsoid
            WGS 84, or raised to the height of the ground.
        world_px : float
            Pixels of the plane's width and height.
        """
        # A metre of raised ground is less on the ellipsoid, by the ratio of the radii.
        agl = agl_m * (WGS84.normal_radius_m(lat_deg) / ground.normal_radius_m(lat_deg))
        across_m, down_m = (size / world_px for size in self.ground_m(lat_deg, lon_deg))
        return agl / across_m, agl / down_m

    def nearest_px(self, offset_px: Floats, _world_px: float, /) -> Floats:
        """Offsets along x, px, unchanged: the plane does not wrap."""
        return offset_px

    def lacks_frames(self, u: Floats, _dlon_deg: Floats, /) -> Flags:
        """Whether no rectangle holds a frame (n,), by u of the midpoints of its edges (n, 4)."""
        return np.asarray(~np.isfinite(u).all(axis=1))

    def refuse_frame(self, lat_deg: float, lon_deg: float, _agl_m: float, /) -> NoReturn:
        """Raise InvalidInput for a frame that no rectangle holds."""
        raise InvalidInput(
            "image at latitude {0!r}, longitude {1!r}: lies beyond what the source's CRS {2} can show",
            lat_deg,
            lon_deg,
            self.name,
            remedy="choose an area that the source shows",
        )

    def to_crs(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Easting and northing in the CRS's unit of positions in degrees (any shape)."""
        from .projections import transformation

        with np.errstate(invalid="ignore"):
            x, y = transformation(self.crs).forward(lat_deg, lon_deg)
        if self._is_geographic:
            # Longitudes continuous with the middle of the rectangle, which may cross the antimeridian.
            x = x - 360.0 * np.rint((x - (self.west + self.width / 2.0)) / 360.0)
        finite = np.isfinite(x) & np.isfinite(y)
        return np.where(finite, x, np.nan), np.where(finite, y, np.nan)

    def from_crs(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude in degrees of eastings and northings (any shape); the inverse of `to_crs`."""
        from .projections import transformation

        lat, lon = transformation(self.crs).inverse(x, y)
        finite = np.isfinite(lon) & np.isfinite(lat)
        return np.where(finite, lat, np.nan), np.where(finite, lon, np.nan)

    def north_deg(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Direction of true north at positions (any shape), degrees clockwise from grid north."""
        slope = self._slopes(lat_deg, lon_deg)
        bearing: Floats = np.degrees(arctan2(slope[..., 0, 1], slope[..., 1, 1]))
        return bearing

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Metres of ground per unit of u and of v, at positions (any shape)."""
        slopes = self._slopes(lat_deg, lon_deg)
        # Lengths of the columns of the inverse.
        area = np.abs(slopes[..., 0, 0] * slopes[..., 1, 1] - slopes[..., 0, 1] * slopes[..., 1, 0])
        with np.errstate(divide="ignore", invalid="ignore"):
            per_x = np.hypot(slopes[..., 1, 1], slopes[..., 1, 0]) / area
            per_y = np.hypot(slopes[..., 0, 1], slopes[..., 0, 0]) / area
        return per_x * self.width, per_y * self.height

    def bend(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Curvature in the plane of straight lines on the ground, relative to the Earth's, at positions (any shape).

        The greatest second derivative of the projection over its least first derivative, times the Earth's least
        radius. For a conformal projection it is the gradient of the logarithm of the scale; for Mercator, the tangent
        of the latitude.
        """
        steps = np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
        steps = np.concatenate([steps, [[1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0]]]) * _FAR
        at = self._around(lat_deg, lon_deg, steps)
        size = (_FAR * _ABOVE_M) ** 2
        east2, north2 = ((at[..., i, :] + at[..., i + 1, :] - 2.0 * at[..., 0, :]) / size for i in (1, 3))
        mixed = (at[..., 5, :] + at[..., 6, :] - at[..., 7, :] - at[..., 8, :]) / (4.0 * size)
        # Between 16 directions, second derivatives are at most 2 % larger.
        angle = np.arange(16) * math.pi / 16
        sine, cosine = (part[:, np.newaxis] for part in sin_cos(np.degrees(angle)))
        second = (
            east2[..., np.newaxis, :] * cosine**2
            + 2.0 * mixed[..., np.newaxis, :] * sine * cosine
            + north2[..., np.newaxis, :] * sine**2
        )
        largest = np.sqrt(np.sum(second * second, axis=-1)).max(axis=-1) * 1.02
        slope = self._slopes(lat_deg, lon_deg)
        with np.errstate(invalid="ignore"):
            finite = np.isfinite(slope).all(axis=(-2, -1), keepdims=True)
            least = np.linalg.svd(np.where(finite, slope, np.eye(2)), compute_uv=False)[..., -1]
        bend: Floats = largest / np.where(finite[..., 0, 0], least, np.nan) * (WGS84.b_m**2 / WGS84.a_m)
        return bend

    def greatest_bend(self, lat_deg: Floats, lon_deg: Floats) -> float:
        """Greatest `bend` over positions (n,) of one mission, computed at up to a thousand of them."""
        some = slice(None, None, -(-len(lat_deg) // 1000))
        # 10 % more for the positions between these.
        return 1.1 * float(np.max(self.bend(lat_deg[some], lon_deg[some])))

    def turned(self, lat_deg: float, lon_deg: float, angle_deg: float) -> TurnedPlane:
        """Return the plane with its origin at a place and its axes turned clockwise."""
        x, y = self.to_crs(np.array(lat_deg), np.array(lon_deg))
        return TurnedPlane(self, float(x), float(y), lon_deg, angle_deg)

    @cached_property
    def name(self) -> str:
        """Code of the CRS, or the name in its WKT."""
        # Codes such as EPSG:32616 are shorter than 32 characters, WKT longer.
        return self.crs if len(self.crs) < 32 else str(_system(self.crs).name)

    @property
    def label(self) -> str:
        """Name to show beside a source's title; empty for the Web-Mercator map."""
        return self.name

    @cached_property
    def _is_geographic(self) -> bool:
        return bool(_system(self.crs).is_geographic)

    @cached_property
    def unit_m(self) -> float:
        """Metres of the CRS's unit."""
        return float(_system(self.crs).axis_info[0].unit_conversion_factor)

    def _slopes(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """First derivatives (..., 2, 2): of easting and northing by metres east and north."""
        at = self._around(lat_deg, lon_deg, np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]) * _NEAR)
        way = 2.0 * _NEAR * _ABOVE_M
        slopes: Floats = np.stack([at[..., i, :] - at[..., i + 1, :] for i in (0, 2)], axis=-1) / way
        return slopes

    def _around(self, lat_deg: Floats, lon_deg: Floats, tangents: Floats) -> Floats:
        """Coordinates (..., k, 2) of the ground points seen at tangents (k, 2) from straight above positions."""
        lat, lon = (np.asarray(angle, np.float64)[..., np.newaxis] for angle in (lat_deg, lon_deg))
        rays = np.concatenate([tangents, np.full((len(tangents), 1), -1.0)], axis=1)
        seen = trace(lat, np.array(_ABOVE_M), rays)
        return np.stack(self.to_crs(seen.lat_deg, lon + seen.dlon_deg), axis=-1)


@dataclass(frozen=True)
class TurnedPlane:
    """A projected plane in metres from a place, its axes turned; made by `ProjectedPlane.turned`.

    Parameters
    ----------
    plane : ProjectedPlane
    x, y : float
        Origin, in the CRS's unit.
    lon_deg : float
        Longitude with which the longitudes of positions are continuous.
    angle_deg : float
        Angle of the axes, clockwise from grid east and grid north.
    """

    plane: ProjectedPlane
    x: float
    y: float
    lon_deg: float
    angle_deg: float

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Positions in metres along the axes, of positions in degrees (any shape)."""
        return self.from_crs(*self.plane.to_crs(lat_deg, lon_deg))

    def from_crs(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Positions in metres along the axes, of eastings and northings in the CRS's unit (any shape)."""
        unit = self.plane.unit_m
        east, north = (x - self.x) * unit, (y - self.y) * unit
        sine, cosine = self._turn()
        return east * cosine - north * sine, east * sine + north * cosine

    def inverse(self, x_m: Floats, y_m: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude in degrees of positions (any shape); longitudes are continuous with the origin's."""
        sine, cosine = self._turn()
        unit = self.plane.unit_m
        east, north = (x_m * cosine + y_m * sine) / unit, (y_m * cosine - x_m * sine) / unit
        lat, lon = self.plane.from_crs(self.x + east, self.y + north)
        return lat, lon - 360.0 * np.rint((lon - self.lon_deg) / 360.0)

    def north_deg(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Direction of true north at positions (any shape), degrees clockwise from the plane's second axis."""
        return self.plane.north_deg(lat_deg, lon_deg) - self.angle_deg

    def _turn(self) -> tuple[float, float]:
        sine, cosine = sin_cos(self.angle_deg)
        return float(sine), float(cosine)


def _system(crs: str) -> CRS:
    # Imported here, as pyproj takes a while to import and the Web-Mercator map does not need it.
    from .reference import read_reference

    return read_reference(crs)
