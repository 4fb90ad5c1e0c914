"""A camera frame laid on the map, pixel by pixel. Runs in the background; knows no widget.

GDAL and QGIS can place such a picture by its ground control points alone, but only through polynomials or splines:
those put a picture tilted by 60 degrees a hundred pixels off, or its corners forty.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from osgeo import gdal

from ...core.capture.georeference import wkt_1
from ...core.errors import OutputError
from ...core.files import partial_file
from ...core.geodesy.ellipsoid import WGS84, sight_lines
from ...core.geodesy.mercator import HALF_WORLD_M, MAX_LAT_DEG, v_to_lat
from ...core.mission.outlines import footprint_ring, metres
from ...core.picture.products import sighting
from ...core.picture.resampling import sample
from .shown import open_shown

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.geodesy.relief import Surface
    from ...core.mission.plan import Plan

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Pixels = NDArray[np.uint8]

#: Most pixels along a side of the map: sharp on a screen, made in seconds.
_LONGEST_PX = 2000
#: Widest pixel of the map, in pixels of the camera straight below it. A picture with the horizon in it reaches
#: hundreds of kilometres: it is laid on the map as far as there is something to see.
_COARSEST = 8.0
#: Pixels worked on in one go, to bound memory.
_BATCH = 1 << 17
_OPTIONS = ("COMPRESS=DEFLATE", "PREDICTOR=2", "ZLEVEL=1", "TILED=YES", "PHOTOMETRIC=RGB", "ALPHA=YES")
_OVERVIEWS = [2, 4, 8]
_OPAQUE = 255
#: Share by which what a pixel of the map sees may be farther than what the picture's pixels there see.
_BEHIND = 0.01


class _Frame(NamedTuple):
    """Pixels of the map, in the CRS that the plan's pictures have."""

    west_m: float
    north_m: float
    pixel_m: float
    width_px: int
    height_px: int


def lay_on_map(plan: Plan, picture: Path, target: Path) -> None:
    """Write a camera frame as a GeoTIFF in the CRS of its source's pixels, transparent where it shows no ground.

    Every pixel of the map takes what the exact camera sees there.

    Parameters
    ----------
    plan : Plan
        Of this one capture.
    picture : Path
        As it was captured.
    target : Path
        Written whole or not at all.

    Raises
    ------
    OutputError
        Where a file cannot be read or written, or the picture shows nothing of the map.
    """
    frame = _frame(plan)
    image = _read(picture)
    height, width = image.shape[:2]
    relief = None if plan.relief is None else _Relief.of(plan, (width, height))
    pixels = np.zeros((frame.height_px, frame.width_px, 4), np.uint8)
    rows = max(_BATCH // frame.width_px, 1)
    for top in range(0, frame.height_px, rows):
        part = pixels[top : top + rows]
        points, seen = _image_points(plan, frame, top + np.arange(len(part)), relief)
        x, y = (points[seen, 0] + 1.0) / 2.0 * width, (1.0 - points[seen, 1]) / 2.0 * height
        part[seen] = np.rint(sample(image, x, y, "bilinear")).astype(np.uint8)
    pixels[..., 3] = np.where(pixels[..., 3] > _OPAQUE // 2, _OPAQUE, 0)
    _write(pixels, frame, target, wkt_1(plan.grid.plane.crs))


def _frame(plan: Plan) -> _Frame:
    """Pixels around the ground in the picture, as far as it is worth it."""
    lon, lat = _outline(plan)
    own = plan.grid.own
    if own is None:
        x, y = metres(lon, np.clip(lat, -MAX_LAT_DEG, MAX_LAT_DEG))
        own_x, own_y = metres(plan.lon_deg[0], np.clip(plan.lat_deg[0], -MAX_LAT_DEG, MAX_LAT_DEG))
        # The scale of the map there.
        m_per_unit = math.cos(math.radians(float(plan.lat_deg[0])))
    else:
        x, y = own.to_crs(lat, lon)
        x, y = x[np.isfinite(x)], y[np.isfinite(y)]
        own_x, own_y = own.to_crs(plan.lat_deg[0], plan.lon_deg[0])
        m_per_unit = own.unit_m
    reach_m = _COARSEST * plan.camera_gsd_m_per_px / m_per_unit * _LONGEST_PX
    west, east = max(float(x.min()), float(own_x) - reach_m), min(float(x.max()), float(own_x) + reach_m)
    south, north = max(float(y.min()), float(own_y) - reach_m), min(float(y.max()), float(own_y) + reach_m)
    if not (west < east and south < north):
        raise OutputError(
            "image {0}: shows no ground that a map in {1} has",
            plan.names[0],
            plan.grid.plane.crs if own is None else own.name,
        )
    pixel_m = max(east - west, north - south) / _LONGEST_PX
    width, height = (max(math.floor(length / pixel_m), 1) for length in (east - west, north - south))
    return _Frame(west, north, pixel_m, width, height)


def _outline(plan: Plan) -> tuple[Floats, Floats]:
    """Longitudes, continuous, and latitudes of the footprint, its edges with their bend however small it is."""
    if plan.corners.hit[0].all() and not plan.poles[0]:
        seen = plan.outline(0)
        return seen.dlon_deg + plan.lon_deg[0], seen.lat_deg
    return footprint_ring(plan, 0)


class _Relief(NamedTuple):
    """What a picture sees of relief: the surface, and the farthest that each pixel (h, w) or one beside it sees."""

    surface: Surface
    depth_m: Floats

    @classmethod
    def of(cls, plan: Plan, size_px: tuple[int, int]) -> _Relief:
        """Of a plan's one capture, whose picture has a size."""
        seen = sighting(plan, 0, size_px)
        there = np.isfinite(seen.depth_m)
        surface = plan.relief.heights.surface.surface(seen.lat_deg[there], seen.lon_deg[there])
        padded = np.pad(np.where(there, seen.depth_m, -np.inf), 1, mode="edge")
        return cls(surface, np.lib.stride_tricks.sliding_window_view(padded, (3, 3)).max(axis=(2, 3)))

    def vectors(self, plan: Plan, lat: Floats, dlon: Floats) -> Floats:
        """From the camera to the surface at places, (r, w, 3) in east, north, up; NaN where it has a hole."""
        lat, dlon = np.broadcast_arrays(lat, dlon)
        up = self.surface.heights(*self.surface.position(lat.ravel(), (plan.lon_deg[0] + dlon).ravel()))
        normal = np.stack(_normal(plan, lat, dlon), axis=-1)
        return (
            sight_lines(plan.lat_deg, plan.height_m, lat, dlon, WGS84)
            + normal * up.reshape(lat.shape)[..., None]
        )

    def sees(self, plan: Plan, points: Floats, vectors: Floats, inside: Flags) -> Flags:
        """Which places are not hidden behind others."""
        height, width = self.depth_m.shape
        column = np.clip((points[inside, 0] + 1.0) / 2.0 * width, 0, width - 1).astype(int)
        row = np.clip((1.0 - points[inside, 1]) / 2.0 * height, 0, height - 1).astype(int)
        axis = plan.mission.camera.rays_enu(((0.0, 0.0),), *(angle[0] for angle in plan.poses.attitude))[0]
        seen = inside.copy()
        seen[inside] = vectors[inside] @ axis <= self.depth_m[row, column] * (1.0 + _BEHIND)
        return seen


def _image_points(
    plan: Plan, frame: _Frame, rows: NDArray[np.int64], relief: _Relief | None
) -> tuple[Floats, Flags]:
    """Image points (r, w, 2) of the map's pixels, and which of them the camera sees, (r, w)."""
    ground = plan.ground
    x_m = frame.west_m + (np.arange(frame.width_px) + 0.5) * frame.pixel_m
    y_m = frame.north_m - (rows + 0.5) * frame.pixel_m
    own = plan.grid.own
    if own is None:
        dlon = x_m / HALF_WORLD_M * 180.0 - plan.lon_deg[0]
        lat = v_to_lat(0.5 - y_m / (2.0 * HALF_WORLD_M))[:, np.newaxis]
    else:
        lat, lon = own.from_crs(*np.meshgrid(x_m, y_m))
        dlon = lon - plan.lon_deg[0]
    if relief is None:
        vectors = sight_lines(plan.lat_deg, plan.agl_m, lat, dlon, ground)
    else:
        vectors = relief.vectors(plan, lat, dlon)
    points, in_front = plan.mission.camera.image_xy(
        vectors.reshape(1, -1, 3), *(angle for angle in plan.poses.attitude)
    )
    points, in_front = points.reshape(*vectors.shape[:2], 2), in_front.reshape(vectors.shape[:2])
    inside = in_front & (np.abs(points) <= 1.0).all(axis=-1)
    if relief is not None:
        return points, relief.sees(plan, points, vectors, inside)
    return points, inside & _faces(plan, lat, dlon, vectors)


def _faces(plan: Plan, lat_deg: Floats, dlon_deg: Floats, vectors: Floats) -> Flags:
    """Whether the ground faces the camera, and the Earth does not stand between."""
    return sum(vectors[..., axis] * part for axis, part in enumerate(_normal(plan, lat_deg, dlon_deg))) < 0.0


def _normal(plan: Plan, lat_deg: Floats, dlon_deg: Floats) -> tuple[Floats, Floats, Floats]:
    """The ground's normal in the axes of the camera: east, north, up."""
    phi, lam, own = np.radians(lat_deg), np.radians(dlon_deg), math.radians(float(plan.lat_deg[0]))
    outward = np.cos(phi) * np.cos(lam)
    return (
        np.cos(phi) * np.sin(lam),
        math.cos(own) * np.sin(phi) - math.sin(own) * outward,
        math.cos(own) * outward + math.sin(own) * np.sin(phi),
    )


def _read(picture: Path) -> Pixels:
    """Picture with four channels, (h, w, 4); the last is opaque where it shows something."""
    file = open_shown(picture)
    bands = None if file is None else file.ReadAsArray()
    if bands is None:
        raise OutputError("image {0}: cannot be read ({1})", picture, gdal.GetLastErrorMsg())
    if bands.ndim == 2:
        bands = bands[np.newaxis]
    colours = np.broadcast_to(bands[: 1 if len(bands) < 3 else 3], (3, *bands.shape[1:]))
    masked = len(bands) in (2, 4)
    mask = bands[-1] if masked else np.full(bands.shape[1:], _OPAQUE, np.uint8)
    return np.dstack([*colours, mask])


def _write(pixels: Pixels, frame: _Frame, target: Path, wkt: str) -> None:
    try:
        with partial_file(target) as partial:
            raster = gdal.GetDriverByName("GTiff").Create(
                str(partial), frame.width_px, frame.height_px, 4, gdal.GDT_Byte, list(_OPTIONS)
            )
            if raster is None:
                raise OutputError("image {0}: cannot be written ({1})", target, gdal.GetLastErrorMsg())
            raster.SetProjection(wkt)
            raster.SetGeoTransform((frame.west_m, frame.pixel_m, 0.0, frame.north_m, 0.0, -frame.pixel_m))
            raster.WriteArray(np.moveaxis(pixels, -1, 0))
            raster.BuildOverviews("AVERAGE", _OVERVIEWS)
            raster.FlushCache()
            del raster
    except OSError as wrong:
        raise OutputError("image {0}: cannot be written ({1})", target, wrong.strerror) from wrong
