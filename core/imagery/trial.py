"""Fetch one tile of a source, to find whether the source answers and to show its imagery."""

from __future__ import annotations

import time
from contextlib import closing
from dataclasses import dataclass, field
from typing import cast

import numpy as np

from ..arrays import PixelValues
from ..geodesy.mercator import PixelGrid
from .opening import NamedSource
from .placeholder import Provided
from .source import Window
from .tiles import Tile


@dataclass(frozen=True)
class Trial:
    """A fetched tile.

    Parameters
    ----------
    tile : Tile
    pixels : array (tile_px, tile_px, 3)
    format : str
        Format of the file, such as PNG; empty if unknown.
    file_bytes : int
    seconds : float
        Time from the request to the decoded pixels.
    min_zoom, native_zoom : int
    attribution : str
    """

    tile: Tile
    pixels: PixelValues = field(repr=False)
    format: str
    file_bytes: int
    seconds: float
    min_zoom: int
    native_zoom: int
    attribution: str


def try_tile(
    named: NamedSource, lat_deg: float | None = None, lon_deg: float | None = None, zoom: int | None = None
) -> Trial:
    """Fetch one tile of a source, at a place within the extent of the imagery, otherwise in the middle of the extent.

    Parameters
    ----------
    named : NamedSource
        A source of tiles, which is opened and closed.
    lat_deg, lon_deg : float or None
    zoom : int or None
        Limited to the zooms of the source; None for 16, which shows houses.

    Raises
    ------
    InvalidInput, SourceError, PartError, Cancelled
    """
    with closing(named.open()) as source:
        grid = source.grid
        finest = 16 if zoom is None else zoom
        tile = _trial_tile(grid, lat_deg, lon_deg, min(max(finest, grid.min_zoom), grid.native_zoom))
        size = grid.tile_px
        window = Window(tile.zoom, tile.x * size, tile.y * size, size, size)
        files: list[bytes] = []
        if hasattr(source, "received"):
            cast(Provided, source).received = lambda _part, file: files.append(file)
        map_type = source.map_types[0] if source.map_types else ""
        begun_s = time.perf_counter()
        pixels = source.fetch(map_type, source.parts(window)[0].window)
        seconds = time.perf_counter() - begun_s
        file = files[0] if files else b""
        formats = ((b"\x89PNG", "PNG"), (b"\xff\xd8\xff", "JPEG"), (b"RIFF", "WebP"), (b"GIF8", "GIF"))
        return Trial(
            tile,
            pixels,
            next((name for magic, name in formats if file.startswith(magic)), ""),
            len(file),
            seconds,
            grid.min_zoom,
            grid.native_zoom,
            source.attribution,
        )


def _trial_tile(grid: PixelGrid, lat_deg: float | None, lon_deg: float | None, zoom: int) -> Tile:
    """Tile at a place if that lies within the grid's extent, otherwise in the middle of the extent."""
    corners = np.array(grid.extent if grid.extent is not None else ((0.0, 0.0), (1.0, 1.0)))
    west, north = corners.min(axis=0)
    east, south = corners.max(axis=0)
    u, v = (west + east) / 2.0, (north + south) / 2.0
    if lat_deg is not None and lon_deg is not None:
        at_u, at_v = (float(one) for one in grid.plane.forward(np.array(lat_deg), np.array(lon_deg)))
        inside = np.isfinite(at_u) and np.isfinite(at_v) and north <= at_v <= south
        # On the map, an extent that crosses the antimeridian continues beyond 1.
        turns = (0.0, 1.0, -1.0) if grid.plane.wraps else (0.0,)
        within_u = next((at_u + turn for turn in turns if west <= at_u + turn <= east), None)
        if inside and within_u is not None:
            u, v = within_u, at_v
    count = 1 << zoom
    column, row = (
        min(max(int(np.floor(one * count)), 0), count - 1) for one in (u % 1.0 if grid.plane.wraps else u, v)
    )
    return Tile(zoom, column, row)
