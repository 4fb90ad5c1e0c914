"""Tiles whose colours are heights: voids of each encoding are holes, and tiles may have 512 px."""

from __future__ import annotations

import io
import re
import sqlite3
import threading
from contextlib import ExitStack, closing, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest
from PIL import Image
from terrainav.core.elevation.layered import open_relief
from terrainav.core.errors import InvalidInput, PartError

from tests.core.elevation.test_heights import encoded_terrain_rgb, encoded_terrarium
from tests.support.thinning import sampled

ZOOM = 12
ENCODE = {"terrarium": encoded_terrarium, "terrain-rgb": encoded_terrain_rgb}
STEP_M = {"terrarium": 1 / 256, "terrain-rgb": 0.1}
LAT, LON = np.array([46.4, 46.45]), np.array([8.4, 8.45])


def plane(column, row, size):
    """Heights at positions in pixels of zoom `ZOOM`, up to a kilometre."""
    return 1000.0 * (column / 2.0**ZOOM / size) - 800.0 * (row / 2.0**ZOOM / size) + 600.0


def tile(encoding, x, y, size, change=lambda rgba, column, row: rgba):
    column, row = np.meshgrid(x * size + np.arange(size) + 0.5, y * size + np.arange(size) + 0.5)
    rgba = np.full((size, size, 4), 255, np.uint8)
    rgba[..., :3] = ENCODE[encoding](plane(column, row, size))
    body = io.BytesIO()
    changed = change(rgba, column, row)
    Image.fromarray(changed if (changed[..., 3] < 255).any() else changed[..., :3].copy()).save(body, "PNG")
    return body.getvalue()


@contextmanager
def tiles(encoding, size, change=lambda rgba, column, row: rgba):
    """A server of tiles; gives its address behind the encoding, without an ending."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            zoom, x, y = map(int, re.findall(r"/(\d+)", self.path))
            assert zoom == ZOOM
            body = tile(encoding, x, y, size, change)
            self.send_response(200)
            self.send_header("Content-Type", "image/png")
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"{encoding}:http://127.0.0.1:{server.server_port}/{{z}}/{{x}}/{{y}}"
    finally:
        server.shutdown()
        server.server_close()


@pytest.fixture
def served():
    """Starts servers of tiles."""
    with ExitStack() as started:
        yield lambda *how: started.enter_context(tiles(*how))


def surface_of(*texts):
    return open_relief(texts).surface(LAT, LON)


def wanted(surface, size):
    rows, columns = surface.heights_m.shape
    column, row = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    return plane(surface.left_px + column, surface.top_px + row, size)


#: What is no height, by its name: colours, and alpha.
VOIDS = {
    "black": ("terrarium terrain-rgb", (0, 0, 0, 255)),
    "transparent": ("terrarium terrain-rgb", (130, 20, 7, 0)),
    "-32768": ("terrarium", (0, 0, 0, 255)),
    "-9999 of terrarium": ("terrarium", (88, 241, 0, 255)),
    "-9999 of terrain-rgb": ("terrain-rgb", (0, 0, 10, 255)),
    "-32767": ("terrarium", (0, 1, 0, 255)),
}


@pytest.mark.parametrize(
    ("encoding", "colour"),
    sampled([(encoding, colour) for encodings, colour in VOIDS.values() for encoding in encodings.split()], 2),
)
@pytest.mark.parametrize("whole", [False, True])
def test_voids_of_tiles_are_holes_that_other_sources_fill(encoding, colour, whole, served):
    def change(rgba, column, row):
        rgba[... if whole else (column % 16 < 5) & (row % 16 < 5)] = colour
        return rgba

    address = f"{served(encoding, 256, change)}.png#maxzoom={ZOOM}"
    surface = surface_of(address)
    rows, columns = np.indices(surface.heights_m.shape)
    void = ((surface.left_px + columns) % 16 < 5) & ((surface.top_px + rows) % 16 < 5) | whole
    assert np.array_equal(np.isnan(surface.heights_m), void)
    heights = wanted(surface, 256)
    assert np.abs(surface.heights_m - heights)[~void].max(initial=0.0) <= STEP_M[encoding]
    filled = surface_of(address, "75").heights_m
    assert (filled[void] == 75.0).all()


@pytest.mark.parametrize("encoding", list(ENCODE))
def test_translucent_pixels_have_the_heights_that_their_colours_say(encoding, served):
    def change(rgba, column, row):
        rgba[..., 3] = 100
        return rgba

    surface = surface_of(f"{served(encoding, 256, change)}.png#maxzoom={ZOOM}")
    assert np.abs(surface.heights_m - wanted(surface, 256)).max() <= STEP_M[encoding]


@pytest.mark.parametrize("encoding", sampled(list(ENCODE), 3))
@pytest.mark.parametrize(
    "behind", [".png#maxzoom=12&tilesize=512", ".png#tilesize=512&maxzoom=12", "@2x.png#maxzoom=12"]
)
def test_tiles_of_512_px_have_twice_as_many_heights_along_a_side(encoding, behind, served):
    surface = surface_of(f"{served(encoding, 512)}{behind}")
    assert surface.grid.tile_px == 512
    assert surface.zoom == ZOOM
    assert np.abs(surface.heights_m - wanted(surface, 512)).max() <= STEP_M[encoding]
    # In metres the pixels are half of those of tiles of 256 px.
    lat, lon = LAT[:1], LON[:1]
    size_m = float(surface.grid.ground_m_per_px(lat, lon, ZOOM)[0])
    assert size_m == pytest.approx(40_075_016.7 / (512 << ZOOM) * np.cos(np.radians(LAT[0])), rel=4e-3)


def test_tiles_of_another_size_say_what_to_write(served):
    address = served("terrain-rgb", 512)
    with pytest.raises(PartError, match=r"an image of 512x512 px instead of 256x256; write #tilesize=512 behind"):
        surface_of(f"{address}.png#maxzoom={ZOOM}")
    surface_of(f"{address}.png#maxzoom={ZOOM}&tilesize=512")


@pytest.mark.parametrize(
    ("behind", "said"),
    [
        ("#maxzoom=12&tilesize=big", "tilesize 'big' must be a whole number"),
        ("#maxzoom=12&zoom=3", "'zoom' behind # must be maxzoom or tilesize"),
        ("#tilesize=300", "300"),
    ],
)
def test_what_stands_behind_an_address_is_checked(behind, said):
    with pytest.raises(InvalidInput, match=said):
        open_relief([f"terrarium:https://tiles.example/{{z}}/{{x}}/{{y}}.png{behind}"])


@pytest.mark.parametrize("size", [256, 512])
def test_mbtiles_tell_the_size_themselves_and_have_the_same_voids(size, tmp_path):
    x, y = (
        (np.array([8.4, 8.45]) + 180.0) / 360.0,
        (0.5 - np.arcsinh(np.tan(np.radians([46.45, 46.4]))) / (2.0 * np.pi)),
    )

    def change(rgba, column, row):
        rgba[(column % 16 < 5) & (row % 16 < 5)] = (9, 9, 9, 0)
        rgba[(column % 16 > 12) & (row % 16 < 5)] = (0, 0, 0, 255)
        return rgba

    path = tmp_path / "heights.mbtiles"
    with closing(sqlite3.connect(path)) as file:
        file.execute("CREATE TABLE metadata (name TEXT, value TEXT)")
        file.execute("CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB)")
        file.execute("CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row)")
        columns, rows = (range(int(at[0] * 2**ZOOM) - 1, int(at[1] * 2**ZOOM) + 2) for at in (x.tolist(), y.tolist()))
        for column in columns:
            for row in rows:
                made = tile("terrain-rgb", column, row, size, change)
                file.execute("INSERT INTO tiles VALUES (?, ?, ?, ?)", (ZOOM, column, 2**ZOOM - 1 - row, made))
        file.commit()
    surface = surface_of(f"terrain-rgb:{path}")
    rows, columns = np.indices(surface.heights_m.shape)
    across, down = (surface.left_px + columns) % 16, (surface.top_px + rows) % 16
    void = ((across < 5) | (across >= 12)) & (down < 5)
    assert np.array_equal(np.isnan(surface.heights_m), void)
    assert np.abs(surface.heights_m - wanted(surface, size))[~void].max() <= 0.1
