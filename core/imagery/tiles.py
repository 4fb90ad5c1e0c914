"""Addresses of tiles."""

from __future__ import annotations

from typing import NamedTuple

from ..errors import InvalidInput, PartError
from ..geodesy.mercator import PixelGrid
from .source import Window


class Tile(NamedTuple):
    """A tile: zoom, column counted from 180° W, row counted from the north."""

    zoom: int
    x: int
    y: int

    def __str__(self) -> str:
        return f"tile {self.zoom}/{self.x}/{self.y}"


def tile_address(part: Window, grid: PixelGrid, title: str) -> Tile:
    """Address of the tile of ``grid`` that a part is.

    Parameters
    ----------
    part : Window
    grid : PixelGrid
    title : str
        The source, as errors name it.

    Raises
    ------
    InvalidInput
        The part is no tile of the grid, or of a zoom the source does not have.
    PartError
        The tile would be beyond the edge of the map.
    """
    size = grid.tile_px
    x, left = divmod(part.left_px, size)
    y, top = divmod(part.top_px, size)
    if left or top or (part.width_px, part.height_px) != (size, size):
        raise InvalidInput(f"{part}: is no tile of {size} px")
    tile = Tile(int(part.zoom), int(x), int(y))
    if not grid.min_zoom <= tile.zoom <= grid.max_zoom:
        raise InvalidInput(f"zoom {tile.zoom}: {title} has {grid.min_zoom} to {grid.max_zoom}")
    if not (0 <= tile.x < 1 << tile.zoom and 0 <= tile.y < 1 << tile.zoom):
        raise PartError(f"{tile}: beyond the edge of the map")
    return tile
