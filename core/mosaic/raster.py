"""North-up pixel grids of a map, and the ground in their pixels."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..capture.georeference import Georeference
from ..geodesy.ellipsoid import WGS84, Ellipsoid
from ..geodesy.local import enu_axes, geocentric
from ..geodesy.mercator import Plane, WebMercator
from ..geodesy.raytracing.surface import Surface

#: Rows and columns of a block.
BlockPart = tuple[slice, slice]


@dataclass(frozen=True)
class Raster:
    """North-up pixel grid of a map.

    Parameters
    ----------
    west, north : float
        Outer edges of the first pixel, in the unit of the plane's CRS. On EPSG:3857 they may lie beyond the world's
        edge, for ground across the antimeridian.
    across, down : float
        Size of a pixel, in the unit of the CRS.
    """

    west: float
    north: float
    across: float
    down: float
    width_px: int
    height_px: int
    plane: Plane = field(default_factory=WebMercator)

    @property
    def place(self) -> Georeference:
        """Georeference for files."""
        return Georeference(
            self.west,
            self.north - self.height_px * self.down,
            self.west + self.width_px * self.across,
            self.north,
            self.width_px,
            self.height_px,
            self.plane.crs,
        )

    def block(self, left: int, top: int, size: int) -> PixelBlock:
        """Pixels of a square, clipped to the raster."""
        width, height = min(size, self.width_px - left), min(size, self.height_px - top)
        x = self.west + (left + np.arange(width) + 0.5) * self.across
        y = self.north - (top + np.arange(height) + 0.5) * self.down
        return PixelBlock(x, y, *places(self.plane, *np.meshgrid(x, y)))


class PixelBlock(NamedTuple):
    """Pixels of a map, h rows of w.

    Attributes
    ----------
    x, y : array (w,), (h,)
        Pixel centres, in the unit of the CRS.
    lat_deg, lon_deg : array (h, w)
        NaN where the CRS shows no ground.
    """

    x: Floats
    y: Floats
    lat_deg: Floats
    lon_deg: Floats

    def inside(self, west: float, south: float, east: float, north: float) -> BlockPart:
        """Rows and columns whose centres are in a box."""
        left, right = np.searchsorted(self.x, west), np.searchsorted(self.x, east, "right")
        top, bottom = np.searchsorted(-self.y, -north), np.searchsorted(-self.y, -south, "right")
        return slice(int(top), int(bottom)), slice(int(left), int(right))

    def take(self, part: BlockPart) -> PixelBlock:
        """Some rows and columns."""
        return PixelBlock(self.x[part[1]], self.y[part[0]], self.lat_deg[part], self.lon_deg[part])


class BlockGround(NamedTuple):
    """The ground in a block's pixels, in geocentric metres.

    Attributes
    ----------
    points, normals : array (h, w, 3)
        Points of the ground; unit normals of level ground, even over relief.
    surface : Surface or None
        The relief that the points lie on.
    """

    points: Floats
    normals: Floats
    surface: Surface | None = None

    @classmethod
    def level(cls, block: PixelBlock, ground: Ellipsoid = WGS84) -> BlockGround:
        """Level ground."""
        return cls(geocentric(block.lat_deg, block.lon_deg, 0.0, ground), _normals(block))

    @classmethod
    def from_surface(cls, block: PixelBlock, surface: Surface) -> BlockGround:
        """Relief; NaN where it has no height."""
        lat, lon = block.lat_deg.ravel(), block.lon_deg.ravel()
        heights = surface.heights(*surface.position(lat, lon)).reshape(block.lat_deg.shape)
        return cls(geocentric(block.lat_deg, block.lon_deg, heights), _normals(block), surface)

    def take(self, part: BlockPart) -> BlockGround:
        """Ground in some rows and columns."""
        return BlockGround(self.points[part], self.normals[part], self.surface)


def places(plane: Plane, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of positions in a plane's CRS (any shape); longitudes of EPSG:3857 go beyond ±180°."""
    lat, lon = plane.inverse((x - plane.west) / plane.width, (plane.north - y) / plane.height)
    return lat, lon


def positions(plane: Plane, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
    """Positions in a plane's CRS of places (any shape); not finite outside its domain."""
    u, v = plane.forward(lat_deg, lon_deg)
    with np.errstate(invalid="ignore"):
        return plane.west + u * plane.width, plane.north - v * plane.height


def _normals(block: PixelBlock) -> Floats:
    normals: Floats = enu_axes(block.lat_deg, block.lon_deg)[..., 2, :]
    return normals
