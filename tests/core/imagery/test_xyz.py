"""Tiles by template over real HTTP; every pixel says where it is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput, SourceError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.http.transport import user_agent
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.xyz import XYZSource

from tests.support.patterns import MODULUS, decode_position, folder, positions, to_bytes
from tests.support.tileserver import TileServer


def assemble(source, window, map_type="satellite"):
    """Put a picture together from its parts, in the plainest way."""
    picture = np.zeros((window.height_px, window.width_px, 3), np.uint8)
    covered = np.zeros((window.height_px, window.width_px), int)
    for part in source.parts(window):
        pixels = source.fetch(map_type, part.window)
        rows = slice(max(part.dy_px, 0), min(part.dy_px + part.window.height_px, window.height_px))
        columns = slice(max(part.dx_px, 0), min(part.dx_px + part.window.width_px, window.width_px))
        inner = (
            slice(rows.start - part.dy_px, rows.stop - part.dy_px),
            slice(columns.start - part.dx_px, columns.stop - part.dx_px),
        )
        picture[rows, columns] = pixels[inner]
        covered[rows, columns] += 1
    assert (covered == 1).all()
    return picture


@pytest.mark.parametrize("extension", ["png", "webp"])
@pytest.mark.parametrize("tile_px", [256, 512])
def test_every_pixel_is_where_the_window_says(tile_px, extension):
    with TileServer(tile_px=tile_px) as server:
        source = XYZSource(server.url_template.replace("png", extension), grid=PixelGrid(tile_px), connections=2)
        window = Window(10, 200_001, 77_777, 600, 300)
        columns, rows = decode_position(assemble(source, window))
        source.close()
    assert np.array_equal(columns[0], (200_001 + np.arange(600)) % MODULUS)
    assert np.array_equal(rows[:, 0], (77_777 + np.arange(300)) % MODULUS)


@pytest.mark.parametrize("left_px", [-100, (256 << 3) - 100])
def test_a_picture_across_the_antimeridian(left_px):
    with TileServer() as server:
        source = XYZSource(server.url_template)
        columns, _ = decode_position(assemble(source, Window(3, left_px, 500, 300, 40)))
        source.close()
    assert np.array_equal(columns[0], (left_px + np.arange(300)) % (256 << 3))


def test_jpeg_tiles():
    def grey(_map_type, _zoom, x, y, size_px):
        return np.full((size_px, size_px, 3), (x * 7 + y * 13) % 256, np.uint8)

    with TileServer(grey) as server:
        source = XYZSource(server.url_template.replace("png", "jpg"))
        pixels = source.fetch("satellite", Window(5, 3 * 256, 4 * 256, 256, 256))
        source.close()
    assert np.abs(pixels.astype(int) - 73).max() <= 1


def test_double_tiles_ask_for_twice_the_pixels():
    with TileServer() as server:
        source = XYZSource(server.url_template.replace("{y}", "{y}{r}"), grid=PixelGrid(512))
        pixels = source.fetch("satellite", Window(5, 3 * 512, 4 * 512, 512, 512))
        assert list(server.requests) == ["/5/3/4@2x.png"]
        source.close()
    assert np.array_equal(pixels, positions("satellite", 5, 3, 4, 512))


def test_rows_from_the_south():
    with TileServer() as server:
        source = XYZSource(server.url_template.replace("{y}", "{-y}"))
        source.fetch("", Window(5, 3 * 256, 4 * 256, 256, 256))
        assert list(server.requests) == ["/5/3/27.png"]
        source.close()


def test_map_types():
    with TileServer() as server:
        source = XYZSource(server.map_type_template)
        assert source.map_types == ("satellite", "roadmap", "terrain")
        tile = Window(5, 3 * 256, 4 * 256, 256, 256)
        pictures = {kind: source.fetch(kind, tile) for kind in source.map_types}
        for kind, picture in pictures.items():
            assert np.array_equal(picture, positions(kind, 5, 3, 4, 256))
        with pytest.raises(InvalidInput, match="map type 'night'"):
            source.fetch("night", tile)
        source.close()


def test_a_template_for_each_map_type():
    with TileServer() as server:
        source = XYZSource({"terrain": f"{server.url}/terrain/{{z}}/{{x}}/{{y}}.png"})
        assert source.map_types == ("terrain",)
        source.fetch("terrain", Window(0, 0, 0, 256, 256))
        with pytest.raises(InvalidInput, match="has terrain"):
            source.fetch("satellite", Window(0, 0, 0, 256, 256))
        source.close()


def test_tiles_that_another_program_cut(tmp_path):
    for x in range(2):
        (tmp_path / "1" / str(x)).mkdir(parents=True)
        for y in range(2):
            (tmp_path / "1" / str(x) / f"{y}.webp").write_bytes(to_bytes(positions("satellite", 1, x, y, 256), "webp"))
    with TileServer(read=folder(tmp_path)) as server:
        source = XYZSource(server.url_template)
        columns, rows = decode_position(assemble(source, Window(1, 0, 0, 512, 512)))
        source.close()
    assert np.array_equal(columns[0], np.arange(512))
    assert np.array_equal(rows[:, 0], np.arange(512))


@given(st.integers(0, 22), st.sampled_from([256, 512]), st.data())
def test_parts_fill_any_window_once(zoom, tile_px, data):
    source = XYZSource("https://h/{z}/{x}/{y}", grid=PixelGrid(tile_px))
    world = tile_px << zoom
    left = data.draw(st.integers(-world, 2 * world))
    width, height = data.draw(st.integers(1, 1500)), data.draw(st.integers(1, 1500))
    top = data.draw(st.integers(0, max(world - height, 0)))
    window = Window(zoom, left, top, width, height)
    parts = source.parts(window)
    columns = sorted({part.dx_px for part in parts})
    rows = sorted({part.dy_px for part in parts})
    assert len(parts) == len(columns) * len(rows)
    assert columns[0] <= 0 < columns[0] + tile_px
    assert columns[-1] < width <= columns[-1] + tile_px
    assert rows[-1] < height <= rows[-1] + tile_px
    for part in parts:
        assert (part.window.left_px - left - part.dx_px) % world == 0
        assert part.window.top_px == top + part.dy_px
        assert 0 <= part.window.left_px < world
    source.close()


@pytest.mark.parametrize(
    ("part", "message"),
    [
        (Window(3, 1, 0, 256, 256), "is not a tile of 256 px"),
        (Window(3, 0, 0.5, 256, 256), "is not a tile of 256 px"),
        (Window(3, 0, 0, 512, 512), "is not a tile of 256 px"),
        (Window(20, 0, 0, 256, 256), "zoom 20: h has 2 to 19"),
        (Window(1, 0, 0, 256, 256), "zoom 1: h has 2 to 19"),
    ],
)
def test_what_is_no_tile_is_refused(part, message):
    source = XYZSource("https://h/{z}/{x}/{y}", grid=PixelGrid(256, 2, 19, 19))
    with pytest.raises(InvalidInput, match=message):
        source.fetch("satellite", part)


def test_a_missing_key_is_said_before_anything_is_sent():
    with TileServer() as server:
        source = XYZSource(server.url_template + "?k={key}", title="Somebody")
        with pytest.raises(SourceError, match="Somebody: needs an API key"):
            source.fetch("", Window(0, 0, 0, 256, 256))
        assert not server.requests


def test_a_date_is_needed_where_the_template_has_one():
    with pytest.raises(InvalidInput, match=r"its URL has a \{date\}"):
        XYZSource("https://h/{date}/{z}/{x}/{y}")


def test_no_more_tiles_than_the_terms_allow_whoever_asks():
    with TileServer() as server:
        policy = Policy("no", max_tiles=3, terms="no bulk download", terms_url="https://h/terms")
        source = XYZSource(server.url_template, policy=policy)
        for x in range(3):
            source.fetch("", Window(5, x * 256, 0, 256, 256))
        with pytest.raises(SourceError, match=r"no bulk download \(https://h/terms\)"):
            source.fetch("", Window(5, 3 * 256, 0, 256, 256))
        assert sum(server.requests.values()) == 3
        source.close()


def test_connections_are_kept_alive_and_shared():
    from concurrent.futures import ThreadPoolExecutor

    with TileServer(latency_s=0.01) as server:
        source = XYZSource(server.url_template, connections=4)
        tiles = [Window(9, x * 256, 0, 256, 256) for x in range(100)]
        with ThreadPoolExecutor(16) as threads:
            list(threads.map(lambda tile: source.fetch("", tile), tiles))
        source.close()
        assert sum(server.requests.values()) == 100
        assert server.connections <= 4
        assert server.user_agents == {user_agent()}
