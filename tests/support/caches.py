"""Contents of a cache of tiles, read without the code that wrote it."""

from __future__ import annotations

import io
import sqlite3
from contextlib import closing

import numpy as np
from PIL import Image

from tests.support.patterns import positions


def check_cache(folder, tile_px=256):
    """Assert that every tile cached of a `TileServer` has the right pixels; returns the number of tiles."""
    kept = 0
    for path in folder.glob("*.mbtiles"):
        with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as file:
            metadata = dict(file.execute("SELECT name, value FROM metadata"))
            rows = file.execute("SELECT zoom_level, tile_column, tile_row, tile_data FROM tiles").fetchall()
        map_type = next((kind for kind in ("roadmap", "terrain") if kind in f"{path.name} {metadata}"), "satellite")
        for zoom, x, row, data in rows:
            # Rows of MBTiles count from the south.
            y = (1 << zoom) - 1 - row
            with Image.open(io.BytesIO(data)) as image:
                right = (np.asarray(image) == positions(map_type, zoom, x, y, tile_px)).all()
            assert right, f"{path.name} holds a wrong image of {zoom}/{x}/{y}"
            kept += 1
    return kept
