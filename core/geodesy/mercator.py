"""Web Mercator (EPSG:3857), and the pixel grid of a source over it or over another plane.

World fractions (u, v) run from 0 to 1 eastward from 180° W and southward from 85.0511° N. A position in pixels at a
zoom is the fraction times the world's width in pixels.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar, NoReturn, TypeVar, Union

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers
from ..errors import InvalidInput
from .ellipsoid import WGS84, Ellipsoid
from .planes import At, ProjectedPlane

#: Whole numbers, one or many.
Whole = TypeVar("Whole", int, NDArray[np.int64])

#: Half the width of the EPSG:3857 world in metres.
HALF_WORLD_M = math.pi * WGS84.a_m
#: Latitude where the square Web-Mercator world ends, degrees.
MAX_LAT_DEG = math.degrees(math.atan(math.sinh(math.pi)))
#: Highest zoom at which positions of windows are exact in float64, for any tile size in use.
HIGHEST_ZOOM = 30


def lon_to_u(lon_deg: Floats) -> Floats:
    """World fraction eastward of longitudes in degrees (any shape, not wrapped)."""
    return np.asarray(lon_deg, np.float64) / 360.0 + 0.5


def u_to_lon(u: Floats) -> Floats:
    """Longitude in degrees of world fractions (any shape, not wrapped); inverse of `lon_to_u`."""
    return (np.asarray(u, np.float64) - 0.5) * 360.0


def lat_to_v(lat_deg: Floats) -> Floats:
    """World fraction southward of geodetic latitudes in degrees (any shape), the paper's equation 3.

    The poles map to -inf and +inf.
    """
    lat = np.asarray(lat_deg, np.float64)
    size = np.abs(lat)
    with np.errstate(divide="ignore"):
        near_pole = -np.log(np.tan(np.radians(90.0 - size) / 2.0))
    # From 85 degrees on, the logarithm of the half co-latitude keeps more digits than asinh(tan φ).
    psi = np.where(size < 85.0, np.arcsinh(np.tan(np.radians(size))), near_pole)
    v: Floats = 0.5 - np.copysign(psi, lat) / (2.0 * math.pi)
    return v


def v_to_lat(v: Floats) -> Floats:
    """Geodetic latitude in degrees of world fractions (any shape), the paper's equation 6."""
    lat: Floats = np.degrees(np.arctan(np.sinh((0.5 - np.asarray(v, np.float64)) * (2.0 * math.pi))))
    return lat


def wrap_lon_deg(lon_deg: Floats) -> Floats:
    """Longitudes in [-180, 180), degrees; exact for those already there."""
    lon = np.asarray(lon_deg, np.float64)
    inside = (lon >= -180.0) & (lon < 180.0)
    return np.where(inside, lon, np.mod(lon + 180.0, 360.0) - 180.0)


@dataclass(frozen=True)
class WebMercator:
    """The plane of EPSG:3857 as world fractions, with the methods of `planes.ProjectedPlane`.

    It wraps around the Earth: u is continuous across the antimeridian, and frames count from the camera's meridian.
    """

    wraps: ClassVar[bool] = True
    widest_cell: ClassVar[float] = 90.0 / 360.0
    name: ClassVar[str] = "EPSG:3857"
    label: ClassVar[str] = ""
    unit_m: ClassVar[float] = 1.0

    crs: str = "EPSG:3857"
    west: float = -HALF_WORLD_M
    north: float = HALF_WORLD_M
    width: float = 2.0 * HALF_WORLD_M
    height: float = 2.0 * HALF_WORLD_M

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """World fractions of positions in degrees (any shape)."""
        return lon_to_u(lon_deg), lat_to_v(lat_deg)

    def inverse(self, u: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude (not wrapped) in degrees of world fractions (any shape)."""
        return v_to_lat(v), u_to_lon(u)

    def meridian_u(self, lon_deg: Floats) -> Floats:
        """World fractions of the cameras' meridians, from which frames and views count."""
        return lon_to_u(lon_deg)

    def seen(self, lat_deg: Floats, _lon_deg: Floats, dlon_deg: Floats, /) -> tuple[Floats, Floats]:
        """Fractions of ground ``dlon_deg`` east of cameras, u from the camera's meridian."""
        return dlon_deg / 360.0, lat_to_v(lat_deg)

    def shows(self, v: Floats) -> Flags:
        """Whether positions lie within the map's latitudes (any shape)."""
        return np.asarray((v >= 0.0) & (v <= 1.0))

    def shorter(self, du: Floats) -> Floats:
        """Distances along u, >= 0, by the shorter way around the Earth."""
        return np.minimum(du, 1.0 - du)

    def wrapped(self, at: At, count: int) -> At:
        """Columns, or positions, wrapped into a world of ``count``."""
        return at % count

    def clipped(self, row: Numbers, count: int) -> Numbers:
        """Rows clipped to the map."""
        return np.clip(row, 0, count - 1)

    def grid_azimuth_deg(self, azimuth_deg: Floats, _lat_deg: Floats, _lon_deg: Floats, /) -> Floats:
        """Azimuths counted from grid north, which is true north."""
        return azimuth_deg

    def north_deg(self, lat_deg: Floats, _lon_deg: Floats, /) -> Floats:
        """Direction of true north from grid north: 0."""
        return np.broadcast_to(np.float64(0.0), np.shape(lat_deg))

    def ground_m(self, lat_deg: Floats, _lon_deg: Floats, /) -> tuple[Floats, Floats]:
        """Metres of ground on the ellipsoid per unit of u and of v, at positions (any shape)."""
        cosine = np.cos(np.radians(lat_deg))
        across, down = WGS84.normal_radius_m(lat_deg), WGS84.meridional_radius_m(lat_deg)
        return self.width * (across / WGS84.a_m * cosine), self.height * (down / WGS84.a_m * cosine)

    def bends(self, v: Floats, _places: Callable[[], tuple[Floats, Floats]], /) -> Floats:
        """Bend at positions: the tangent of the latitude."""
        steepness: Floats = np.abs(np.sinh((0.5 - v) * (2.0 * np.pi)))
        return steepness

    def frame_bend(self, lat_deg: Floats, _lon_deg: Floats, /) -> Floats:
        """Bend at positions (n,): the tangent of the latitude."""
        return np.asarray(np.abs(np.tan(np.radians(lat_deg))), np.float64)

    def focal_px(
        self, lat_deg: Floats, _lon_deg: Floats, agl_m: Floats, ground: Ellipsoid, world_px: float, /
    ) -> tuple[Floats, Floats]:
        """Focal lengths along x and y, px, of map frames from ``agl_m`` above ``ground`` at positions (n,)."""
        # Pixels per radian of the camera's ground: a metre is 1/(N cos φ) of longitude or 1/M of latitude.
        px_per_rad = agl_m * world_px / (2.0 * math.pi * np.cos(np.radians(lat_deg)))
        return px_per_rad / ground.normal_radius_m(lat_deg), px_per_rad / ground.meridional_radius_m(lat_deg)

    def nearest_px(self, offset_px: Floats, world_px: float) -> Floats:
        """Offsets along x, px, by the shorter way around the world."""
        nearest: Floats = np.mod(offset_px + world_px / 2.0, world_px) - world_px / 2.0
        return nearest

    def lacks_frames(self, _u: Floats, dlon_deg: Floats, /) -> Flags:
        """Whether no rectangle holds a frame (n,), by the midpoints of its top, right, bottom and left edges (n, 4)."""
        return np.asarray((np.abs(dlon_deg[:, 0]) > 90.0) | (np.abs(dlon_deg[:, 2]) > 90.0))

    def refuse_frame(self, lat_deg: float, _lon_deg: float, agl_m: float, /) -> NoReturn:
        """Raise InvalidInput for a frame that no rectangle holds."""
        raise InvalidInput(
            "image at latitude {0!r} from {1:g} m: it holds a pole, which Web Mercator does not",
            lat_deg,
            agl_m,
            remedy="fly lower or farther from the pole",
        )


#: Plane of pictures.
Plane = Union[WebMercator, ProjectedPlane]
#: The Web-Mercator map.
MERCATOR = WebMercator()


@dataclass(frozen=True)
class PixelGrid:
    """The pixels of a source.

    Zooms are in 256 px terms: at zoom z the world is 2**z tiles wide whatever the size of tiles. Tiles of 512 px (or
    @2x) double the pixels of a picture, not its zoom.

    Parameters
    ----------
    tile_px : int
        Width and height of a tile in px, a multiple of 256.
    min_zoom, max_zoom : int
        Zooms that the source serves.
    native_zoom : int
        Highest zoom with new detail; above it the source only enlarges.
    max_size_px : int or None
        Longest side of a picture in 256 px terms, if the source limits it.
    centre_decimals : int or None
        For a source of pictures by their centre, the decimals of a degree to which it rounds the centre; None for
        tiles.
    extent : tuple of (u, v) pairs, or None
        Corners, in order, of the convex ground that the imagery covers, as world fractions; u may lie beyond 0 or 1
        across the antimeridian. None if no limits are known.
    plane : WebMercator or ProjectedPlane
        The world that the pixels divide: the whole map, or the rectangle about a raster in another CRS. At the native
        zoom a pixel is one pixel of the raster; each zoom below has pixels twice as large.
    native_part_px : int
        Width and height of the parts of pictures that are cut out at the native zoom; 0 for those of a tile. Grids with
        the same pixels are equal, whatever their parts.
    """

    tile_px: int = 256
    min_zoom: int = 0
    max_zoom: int = 22
    native_zoom: int = 22
    max_size_px: int | None = None
    centre_decimals: int | None = None
    extent: tuple[tuple[float, float], ...] | None = None
    plane: Plane = MERCATOR
    native_part_px: int = field(default=0, compare=False)

    def __post_init__(self) -> None:
        if self.tile_px < 256 or self.tile_px % 256:
            raise InvalidInput("tile size {0} px: must be a multiple of 256", self.tile_px)
        if not 0 <= self.min_zoom <= self.native_zoom <= self.max_zoom <= HIGHEST_ZOOM:
            raise InvalidInput(
                "zooms {0} to {1}, native {2}: need 0 <= minimum <= native <= maximum <= {3}",
                self.min_zoom,
                self.max_zoom,
                self.native_zoom,
                HIGHEST_ZOOM,
            )

    @property
    def scale(self) -> int:
        """Pixels of a picture per pixel in 256 px terms, along each side."""
        return self.tile_px // 256

    def part_px(self, zoom: int) -> int:
        """Width and height of the parts of pictures that are cut out at ``zoom``."""
        return self.native_part_px if self.native_part_px and zoom == self.native_zoom else self.tile_px

    def world_px(self, zoom: int) -> int:
        """Width (and height) of the world in px at ``zoom``."""
        return self.tile_px << zoom

    def pixel_size(self, zoom: int) -> tuple[float, float]:
        """Width and height of a pixel at ``zoom`` in the CRS's unit; on the map, in metres at the equator."""
        return self.plane.width / self.world_px(zoom), self.plane.height / self.world_px(zoom)

    def meridian_u(self, lon_deg: Floats) -> Floats:
        """World fractions from which frames and views count: cameras' meridians on the map, else the plane's west."""
        return self.plane.meridian_u(lon_deg)

    def wrapped(self, column: Whole, zoom: int) -> Whole:
        """Columns of tiles wrapped into the world; only the map wraps."""
        return self.plane.wrapped(column, 1 << zoom)

    def wrapped_px(self, left_px: Floats | Numbers, zoom: int) -> Floats | Numbers:
        """Left edges wrapped into the world, like columns in `wrapped`."""
        return self.plane.wrapped(left_px, self.world_px(zoom))

    def ground_m_per_px(self, lat_deg: Floats, lon_deg: Floats, zoom: int) -> Floats:
        """Metres of ground per px along rows, on the ellipsoid, at ``zoom`` and positions (any shape)."""
        size: Floats = self.plane.ground_m(lat_deg, lon_deg)[0] / self.world_px(zoom)
        return size

    def edges(
        self, left_px: Floats, top_px: Floats, width_px: Floats, height_px: Floats, zoom: int
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """West, south, east, north of windows in the CRS's unit (float64 arrays of their shape)."""
        across, down = self.pixel_size(zoom)
        left, top = np.asarray(left_px, np.float64), np.asarray(top_px, np.float64)
        west, north = self.plane.west, self.plane.north
        return (
            west + left * across,
            north - (top + height_px) * down,
            west + (left + width_px) * across,
            north - top * down,
        )


def extent_of_box(
    west_deg: float, south_deg: float, east_deg: float, north_deg: float
) -> tuple[tuple[float, float], ...]:
    """Corners of a box as world fractions, for `PixelGrid.extent`; an east below the west crosses the antimeridian."""
    if east_deg < west_deg:
        east_deg += 360.0
    west, east = lon_to_u(np.array([west_deg, east_deg])).tolist()
    top, bottom = np.clip(lat_to_v(np.array([north_deg, south_deg])), 0.0, 1.0).tolist()
    return ((west, top), (east, top), (east, bottom), (west, bottom))


def extent_of_outline(x_m: Floats, y_m: Floats) -> tuple[tuple[float, float], ...] | None:
    """Corners of a quadrilateral as world fractions, for `PixelGrid.extent`.

    None if corners do not describe the outline: a point lies beyond the map, or a side is not straight. Sides of a few
    kilometres in UTM leave their chords by decimetres, sides of a raster about a pole by their length.

    Parameters
    ----------
    x_m, y_m : array (8,)
        Metres of EPSG:3857: the four corners in order, then the middles of the sides that begin at each.
    """
    with np.errstate(invalid="ignore"):
        u, v = 0.5 + x_m / (2.0 * HALF_WORLD_M), 0.5 - y_m / (2.0 * HALF_WORLD_M)
        u = u[0] + (u - u[0]) - np.rint(u - u[0]) * (np.abs(u - u[0]) > 0.5)
        bend = np.hypot(*(side[4:] - (side[:4] + np.roll(side[:4], -1)) / 2.0 for side in (u, v)))
        length = np.hypot(*(np.roll(side[:4], -1) - side[:4] for side in (u, v)))
        # A side is straight if it leaves its chord by at most 1 % of its length.
        straight = bend <= 0.01 * length
    return tuple(zip(u[:4].tolist(), v[:4].tolist())) if straight.all() else None


def fitting_zoom(span: float, size_px: float, slack: float = 1e-6) -> int:
    """Highest zoom at which a span of the world fits a number of pixels (the paper's equation 8).

    Uses the binary exponent: a rounded logarithm may be off by one near powers of two.

    Parameters
    ----------
    span : float
        World fraction, > 0.
    size_px : float
        Pixels in 256 px terms, > 0.
    slack : float
        Relative excess that still fits; it allows for the noise of a span computed in float64, far below a pixel.
    """
    if not (math.isfinite(span) and span > 0.0 and size_px > 0.0):
        raise InvalidInput("span {0} of the world, size {1} px: both must be above 0", span, size_px)
    _, exponent = math.frexp(size_px / (256.0 * span) * (1.0 + slack))
    return exponent - 1
