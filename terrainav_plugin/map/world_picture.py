"""A picture of the embedded world as a file, so that it can be the map one plans on. Knows no widget."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from osgeo import gdal

from ...core.capture.georeference import WEB_MERCATOR_WKT
from ...core.errors import Cancelled, OutputError
from ...core.files import make_folder, partial_file
from ...core.geodesy.mercator import MAX_LAT_DEG, PixelGrid, lat_to_v, lon_to_u
from ...core.imagery.opening import open_source
from ...core.imagery.source import Window

if TYPE_CHECKING:
    from ...core.mission.area import Box

#: Most pixels of a picture: a few seconds of drawing, and sharper than the screen until zoomed in twofold.
_MOST_PX = 20_000_000
#: Width and height of the picture around an area, in widths and heights of the area.
_AROUND = 2.0
#: Shorter side of the picture over its longer, at least.
_NARROWEST = 0.75
#: Least width and height in the world's own: even around a small area there is some land to see.
_LEAST = 2.0**-16
_OPTIONS = ("COMPRESS=JPEG", "JPEG_QUALITY=90", "PHOTOMETRIC=YCBCR", "TILED=YES")
_OVERVIEWS = (2, 4, 8, 16, 32)


class WorldPicture(NamedTuple):
    """Tiles of the embedded world: columns and rows from ``left, top`` at ``zoom``."""

    map_type: str
    seed: int
    zoom: int
    left: int
    top: int
    columns: int
    rows: int

    @property
    def file_name(self) -> str:
        """The same picture has the same name."""
        return f"synthetic-{'-'.join(str(part) for part in self)}.tif"


def choose_picture(box: Box | None, map_type: str, seed: int) -> WorldPicture:
    """Tiles around a box at the highest zoom that keeps the picture small; None for the whole world.

    Columns end at the world's edges, so that of a box across the antimeridian the wider side is shown.
    """
    west, east, north, south = 0.0, 1.0, 0.0, 1.0
    if box is not None:
        west, east = (float(lon_to_u(np.asarray(lon))) for lon in (box.west_deg, box.continuous_east_deg))
        if east > 1.0:
            west, east = (west, 1.0) if 1.0 - west >= east - 1.0 else (0.0, east - 1.0)
        north, south = (
            float(lat_to_v(np.asarray(min(max(lat, -MAX_LAT_DEG), MAX_LAT_DEG))))
            for lat in (box.north_deg, box.south_deg)
        )
        width, height = east - west, south - north
        half_u = max(width, _NARROWEST * height, _LEAST) * _AROUND / 2.0
        half_v = max(height, _NARROWEST * width, _LEAST) * _AROUND / 2.0
        middle_u, middle_v = (west + east) / 2.0, (north + south) / 2.0
        west, east, north, south = middle_u - half_u, middle_u + half_u, middle_v - half_v, middle_v + half_v
    grid = PixelGrid()
    zoom = 0
    for candidate in range(grid.max_zoom + 1):
        tiles = _tiles(west, east, north, south, candidate)
        if tiles[2] * tiles[3] * grid.tile_px**2 > _MOST_PX:
            break
        zoom = candidate
    return WorldPicture(map_type, seed, zoom, *_tiles(west, east, north, south, zoom))


def _tiles(west: float, east: float, north: float, south: float, zoom: int) -> tuple[int, int, int, int]:
    count = 1 << zoom
    left, top = (min(max(math.floor(edge * count), 0), count - 1) for edge in (west, north))
    right, bottom = (min(max(math.ceil(edge * count), 1), count) for edge in (east, south))
    return left, top, max(right - left, 1), max(bottom - top, 1)


def render(picture: WorldPicture, path: Path, progress: Callable[[float], bool]) -> None:
    """Draw a picture and write it as a GeoTIFF with overviews, whole or not at all.

    Raises
    ------
    Cancelled
        When ``progress`` (share done, 0 to 1) said so.
    OutputError
    """
    make_folder(path.parent)
    try:
        with partial_file(path) as partial:
            _write(picture, partial, progress)
    except OSError as wrong:
        raise OutputError(f"background {path}: cannot be written ({wrong.strerror})") from wrong


def _write(picture: WorldPicture, path: Path, progress: Callable[[float], bool]) -> None:
    source = open_source("world", seed=picture.seed)
    size = source.grid.tile_px
    width, height = picture.columns * size, picture.rows * size
    pixels = np.empty((3, height, width), np.uint8)
    places = [(column, row) for row in range(picture.rows) for column in range(picture.columns)]

    def draw(column: int, row: int) -> None:
        left, top = (picture.left + column) * size, (picture.top + row) * size
        tile = source.fetch(picture.map_type, Window(picture.zoom, left, top, size, size))
        pixels[:, row * size : (row + 1) * size, column * size : (column + 1) * size] = np.moveaxis(
            tile, -1, 0
        )

    with ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix="terrainav-world") as pool:
        drawing = [pool.submit(draw, *place) for place in places]
        try:
            for done, future in enumerate(as_completed(drawing), 1):
                future.result()
                if not progress(0.9 * done / len(places)):
                    raise Cancelled("background: stopped")
        finally:
            for future in drawing:
                future.cancel()
    edges = source.grid.edges_m(picture.left * size, picture.top * size, width, height, picture.zoom)
    _save(pixels, path, float(edges[0]), float(edges[3]), source.grid.resolution_m_per_px(picture.zoom))


def _save(pixels: np.ndarray, path: Path, west_m: float, north_m: float, resolution_m: float) -> None:
    _, height, width = pixels.shape
    raster = gdal.GetDriverByName("GTiff").Create(str(path), width, height, 3, gdal.GDT_Byte, list(_OPTIONS))
    if raster is None:
        raise OutputError(f"background {path}: cannot be written ({gdal.GetLastErrorMsg()})")
    raster.SetProjection(WEB_MERCATOR_WKT)
    raster.SetGeoTransform((west_m, resolution_m, 0.0, north_m, 0.0, -resolution_m))
    raster.WriteArray(pixels)
    raster.FlushCache()
    factors = [factor for factor in _OVERVIEWS if max(width, height) // factor >= 256]
    if factors:
        raster.BuildOverviews("AVERAGE", factors)
    del raster
