"""Pixels of a map, north up, and the ground in them."""

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


@dataclass(frozen=True)
class Raster:
    """Square or oblong pixels of a map.

    Parameters
    ----------
    west, north : float
        Outer edges of the first pixel, in the unit of the plane's CRS; on EPSG:3857 they may lie beyond the world's
        half width, where the ground reaches across the antimeridian.
    across, down : float
        Size of a pixel, in that unit.
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
        """Where it lies, for files."""
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
        """Pixels of a square, as far as there are some."""
        width, height = min(size, self.width_px - left), min(size, self.height_px - top)
        x = self.west + (left + np.arange(width) + 0.5) * self.across
        y = self.north - (top + np.arange(height) + 0.5) * self.down
        return PixelBlock(x, y, *places(self.plane, *np.meshgrid(x, y)))


class PixelBlock(NamedTuple):
    """Some pixels of a map, h rows of w.

    Attributes
    ----------
    x, y : array (w,), (h,)
        Of their middles, in the unit of the CRS.
    lat_deg, lon_deg : array (h, w)
        NaN where the CRS shows no ground.
    """

    x: Floats
    y: Floats
    lat_deg: Floats
    lon_deg: Floats


class BlockGround(NamedTuple):
    """The ground in a block's pixels, from the Earth's centre, metres.

    Attributes
    ----------
    points, normals : array (h, w, 3)
        The level ground's normals, of length 1, whatever the relief.
    surface : Surface or None
        The relief that the points lie on.
    """

    points: Floats
    normals: Floats
    surface: Surface | None = None

    @classmethod
    def level(cls, block: PixelBlock, ground: Ellipsoid = WGS84) -> BlockGround:
        """Of level ground."""
        return cls(geocentric(block.lat_deg, block.lon_deg, 0.0, ground), _normals(block))

    @classmethod
    def from_surface(cls, block: PixelBlock, surface: Surface) -> BlockGround:
        """Of relief; NaN where it has no height."""
        lat, lon = block.lat_deg.ravel(), block.lon_deg.ravel()
        heights = surface.heights(*surface.position(lat, lon)).reshape(block.lat_deg.shape)
        return cls(geocentric(block.lat_deg, block.lon_deg, heights), _normals(block), surface)


def places(plane: Plane, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of positions in a plane's CRS (any shape); of EPSG:3857 they go on beyond ±180°."""
    lat, lon = plane.inverse((x - plane.west) / plane.width, (plane.north - y) / plane.height)
    return lat, lon


def positions(plane: Plane, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
    """Positions in a plane's CRS of places (any shape); not finite where it does not show them."""
    u, v = plane.forward(lat_deg, lon_deg)
    with np.errstate(invalid="ignore"):
        return plane.west + u * plane.width, plane.north - v * plane.height


def _normals(block: PixelBlock) -> Floats:
    normals: Floats = enu_axes(block.lat_deg, block.lon_deg)[..., 2, :]
    return normals
