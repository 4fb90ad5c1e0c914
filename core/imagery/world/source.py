"""The embedded world as a source of tiles."""

from __future__ import annotations

import numpy as np

from ...geodesy.mercator import PixelGrid
from ..catalogue.entry import CatalogueEntry
from ..named import SourceOptions
from ..policy import Policy
from ..source import Part, Pixels, Window, tile_parts
from .lattice import TILE_PX
from .world import MAX_ZOOM, STYLES, World

_KEPT_BYTES = 1 << 24


class WorldSource:
    """The embedded world as a source: computed where it is needed, the same everywhere."""

    name = "world"
    title = "Synthetic (offline)"
    attribution = "Synthetic landscape, TerrAInav"
    map_types = STYLES
    grid = PixelGrid(tile_px=TILE_PX, max_zoom=MAX_ZOOM, native_zoom=MAX_ZOOM)
    policy = Policy()
    date = ""

    def __init__(self, seed: int = 2024) -> None:
        self.world = World(seed)
        # glibc gives what a tile has used back to the system after each, and takes it anew, page by page: a quarter of
        # a tile's time. Freeing one large block tells it to keep as much (mallopt(3), M_TRIM_THRESHOLD).
        np.empty(_KEPT_BYTES, dtype=np.uint8)

    def parts(self, window: Window) -> list[Part]:
        """Return the tiles that fill a window."""
        return tile_parts(window, self.grid)

    def fetch(self, map_type: str, part: Window) -> Pixels:
        """Pixels of a tile, (256, 256, 3).

        Raises
        ------
        InvalidInput
            Unknown map type, or a tile that does not exist.
        """
        return self.world.tile(map_type, part.zoom, int(part.left_px) // TILE_PX, int(part.top_px) // TILE_PX)

    def close(self) -> None:
        """Do nothing: it holds nothing."""


def open_entry(_entry: CatalogueEntry, _date: str, _key: str | None, options: SourceOptions) -> WorldSource:
    """Return the world of the seed that is asked for."""
    return WorldSource(options.seed)
