"""A user's own MBTiles, written by GDAL and by hand, as a source."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pyproj
import pytest
from osgeo import gdal
from terrainav.core.errors import Cancelled, InvalidInput, PartError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.mbtiles import open_mbtiles
from terrainav.core.imagery.source import Window

from tests.support.cached import source_of, tile
from tests.support.caching import CachingTileServer
from tests.support.patterns import decode_position, encode_position, positions, to_bytes

ROOT = Path(__file__).resolve().parents[3]
ZOOM = 6
HALF_WORLD_M = 20037508.342789244


def write(path, tiles, *, wal=False, **rows):
    """Write an MBTiles by hand; ``tiles`` are bytes by zoom, x and y from the north."""
    with closing(sqlite3.connect(path)) as database:
        if wal:
            database.execute("PRAGMA journal_mode = WAL")
        database.execute("CREATE TABLE metadata (name text, value text)")
        database.execute(
            "CREATE TABLE tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob)"
        )
        database.executemany("INSERT INTO metadata VALUES (?, ?)", rows.items())
        database.executemany(
            "INSERT INTO tiles VALUES (?, ?, ?, ?)",
            [(z, x, (1 << z) - 1 - y, body) for (z, x, y), body in tiles.items()],
        )
        database.commit()
    return path


def some_tiles(extension="png", tile_px=256):
    return {(ZOOM, x, y): to_bytes(positions("", ZOOM, x, y, tile_px), extension) for x in (20, 21) for y in (30, 31)}


def window(x=20, y=30, tile_px=256):
    return Window(ZOOM, x * tile_px, y * tile_px, tile_px, tile_px)


@pytest.mark.parametrize(("extension", "tile_px"), [("png", 256), ("webp", 256), ("png", 512)])
def test_every_pixel_is_where_the_window_says(tmp_path, extension, tile_px):
    path = write(tmp_path / "own.mbtiles", some_tiles(extension, tile_px))
    source = open_mbtiles(path)
    assert source.grid == PixelGrid(tile_px, ZOOM, ZOOM, ZOOM)
    wanted = Window(ZOOM, 20 * tile_px + 13, 30 * tile_px + 57, tile_px + 99, tile_px + 111)
    picture = np.zeros((wanted.height_px, wanted.width_px, 3), np.uint8)
    for part in source.parts(wanted):
        pixels = source.fetch("", part.window)
        top, left = max(part.dy_px, 0), max(part.dx_px, 0)
        inner = pixels[top - part.dy_px :, left - part.dx_px :]
        room = picture[top : top + inner.shape[0], left : left + inner.shape[1]]
        room[:] = inner[: room.shape[0], : room.shape[1]]
    source.close()
    columns, rows = decode_position(picture)
    assert np.array_equal(columns[0], (wanted.left_px + np.arange(wanted.width_px)) % 4096)
    assert np.array_equal(rows[:, 0], (wanted.top_px + np.arange(wanted.height_px)) % 4096)


def degrees_of_tiles():
    """West, south, east and north of `some_tiles`, by PROJ, a little within."""
    side = 2.0 * HALF_WORLD_M / (1 << ZOOM)
    x = np.array([20.1, 21.9]) * side - HALF_WORLD_M
    y = HALF_WORLD_M - np.array([31.9, 30.1]) * side
    (west, east), (south, north) = pyproj.Transformer.from_crs(3857, 4326, always_xy=True).transform(x, y)
    return f"{west},{south},{east},{north}"


@pytest.mark.parametrize(
    ("rows", "from_north"),
    [
        ({"scheme": "xyz"}, True),
        ({"scheme": " XYZ "}, True),
        ({"scheme": "tms"}, False),
        ({"scheme": "other"}, False),
        ({}, False),
        # The bounds tell which way they count, where the scheme was taken over from elsewhere.
        ({"scheme": "xyz", "bounds": degrees_of_tiles()}, True),
        ({"scheme": "xyz", "bounds": degrees_of_tiles()}, False),
        ({"scheme": "xyz", "bounds": "-180,-85,180,85"}, True),
        ({"scheme": "xyz", "bounds": "nonsense"}, True),
    ],
)
def test_rows_count_from_the_north_where_the_scheme_says_so(tmp_path, rows, from_north):
    tiles = some_tiles()
    stored = {(z, x, (1 << z) - 1 - y): body for (z, x, y), body in tiles.items()} if from_north else tiles
    source = open_mbtiles(write(tmp_path / "own.mbtiles", stored, **rows))
    assert np.array_equal(source.fetch("", window()), positions("", ZOOM, 20, 30, 256))
    source.close()


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
@pytest.mark.parametrize("tile_px", [256, 512])
def test_what_gdal_writes(tmp_path, kind, tile_px):
    """A picture on the tile grid, cut into tiles by GDAL, which may write them with loss."""
    resolution = 2 * HALF_WORLD_M / (tile_px << ZOOM)
    left, top, size = 20 * tile_px, 30 * tile_px, 2 * tile_px
    steps = np.arange(size) // 64 * 16
    right = encode_position(steps, steps)
    memory = gdal.GetDriverByName("MEM").Create("", size, size, 3)
    memory.SetProjection("EPSG:3857")
    memory.SetGeoTransform(
        [left * resolution - HALF_WORLD_M, resolution, 0, HALF_WORLD_M - top * resolution, 0, -resolution]
    )
    for band in range(3):
        memory.GetRasterBand(band + 1).WriteArray(right[..., band])
    path = tmp_path / "gdal.mbtiles"
    options = [f"TILE_FORMAT={kind}", f"BLOCKSIZE={tile_px}", "NAME=By GDAL", "QUALITY=95"]
    gdal.GetDriverByName("MBTiles").CreateCopy(str(path), memory, options=options).FlushCache()
    source = open_mbtiles(path)
    assert source.title == "By GDAL"
    # Tiles 20 and 21 of 64, and rows 30 and 31.
    west, north, east, south = 20 / (1 << ZOOM), 30 / (1 << ZOOM), 22 / (1 << ZOOM), 32 / (1 << ZOOM)
    np.testing.assert_allclose(
        source.grid.extent, ((west, north), (east, north), (east, south), (west, south)), atol=1e-12
    )
    assert replace(source.grid, extent=None) == PixelGrid(tile_px, ZOOM, ZOOM, ZOOM)
    loss = {"PNG": 0, "JPEG": 16, "WEBP": 40}[kind]
    for x in (0, 1):
        for y in (0, 1):
            pixels = source.fetch("anything", window(20 + x, 30 + y, tile_px))
            part = right[y * tile_px : (y + 1) * tile_px, x * tile_px : (x + 1) * tile_px]
            assert np.abs(pixels[..., :3].astype(int) - part).max() <= loss
    source.close()


def test_what_it_says_of_itself(tmp_path):
    path = write(
        tmp_path / "own.mbtiles",
        some_tiles(),
        name="  My orthophoto ",
        attribution='<a href="https://h">&copy; The town</a>, <b>2021</b><br/>by us',
        date="2021-06-01",
        license="CC0-1.0",
        minzoom="4",
        maxzoom="6",
    )
    source = open_mbtiles(str(path))
    assert source.name == str(path)
    assert source.title == "My orthophoto"
    assert source.attribution == "© The town, 2021 by us"
    assert source.date == "2021-06-01"
    assert source.policy.licence == "CC0-1.0"
    assert source.policy.bulk_allowed == "yes"
    assert source.map_types == ()
    assert (source.grid.min_zoom, source.grid.max_zoom, source.grid.native_zoom) == (4, 6, 6)
    source.close()


@pytest.mark.parametrize(
    "rows",
    [
        {},
        {"minzoom": "0"},
        {"minzoom": "x", "maxzoom": "y"},
        {"minzoom": "9", "maxzoom": "3"},
        {"minzoom": "0", "maxzoom": "99"},
    ],
)
def test_zooms_of_the_tiles_where_the_metadata_do_not_tell(tmp_path, rows):
    tiles = {**some_tiles(), (3, 1, 1): to_bytes(positions("", 3, 1, 1, 256), "png")}
    source = open_mbtiles(write(tmp_path / "own.mbtiles", tiles, date="yesterday", **rows))
    assert (source.grid.min_zoom, source.grid.max_zoom) == (3, 6)
    assert (source.title, source.date) == ("own", "")
    source.close()


def test_what_is_not_there_or_broken_is_a_missing_part(tmp_path):
    tiles = some_tiles()
    tiles[ZOOM, 21, 30] = tiles[ZOOM, 21, 30][:200]
    tiles[ZOOM, 21, 31] = "text"
    source = open_mbtiles(write(tmp_path / "own.mbtiles", tiles))
    with pytest.raises(PartError, match=r"^tile 6/1/2: is not in own\.mbtiles$"):
        source.fetch("", window(1, 2))
    with pytest.raises(PartError, match=r"^tile 6/21/30: broken image"):
        source.fetch("", window(21, 30))
    with pytest.raises(PartError, match="tile 6/21/31"):
        source.fetch("", window(21, 31))
    with pytest.raises(InvalidInput, match="is not a tile of 256 px"):
        source.fetch("", Window(ZOOM, 5, 0, 256, 256))
    with pytest.raises(InvalidInput, match="zoom 7: own has 6 to 6"):
        source.fetch("", window()._replace(zoom=7))
    source.close()
    with pytest.raises(Cancelled):
        source.fetch("", window())
    source.close()


def no_file(path):
    pass


def no_database(path):
    path.write_bytes(b"II*\0" + bytes(1000))


def no_tables(path):
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE something (a)")
        database.commit()


def without_tiles(path):
    write(path, {})


def a_schema_that_is_not_utf8(path):
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE metadata (name, value)")
        database.commit()
    path.write_bytes(path.read_bytes().replace(b"CREATE TABLE", b"CREAT\xff TABLE"))


def vector_by_name(path):
    write(path, {(0, 0, 0): b"\x1f\x8bvector"}, format="pbf")


def vector_by_content(path):
    write(path, {(0, 0, 0): b"\x1f\x8bvector"})


def something_else(path):
    write(path, {(0, 0, 0): b"something else"}, format="png")


def not_square(path):
    write(path, {(0, 0, 0): to_bytes(np.zeros((256, 512, 3), np.uint8), "png")})


def an_odd_size(path):
    write(path, {(0, 0, 0): to_bytes(np.zeros((300, 300, 3), np.uint8), "png")})


def zooms_that_are_none(path):
    # By hand, as columns of declared types would turn some of it into numbers.
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE metadata (name, value)")
        database.execute("CREATE TABLE tiles (zoom_level, tile_column, tile_row, tile_data)")
        body = to_bytes(np.zeros((256, 256, 3), np.uint8), "png")
        database.execute("INSERT INTO tiles VALUES (NULL, 0, 0, ?)", (body,))
        database.commit()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (no_file, "is not there"),
        (no_database, r"is not an MBTiles file, or is damaged \(file is not a database\)"),
        (no_tables, r"is not an MBTiles file, or is damaged \(no such table: metadata\)"),
        (a_schema_that_is_not_utf8, r"is not an MBTiles file, or is damaged \('utf-8' codec"),
        (without_tiles, "holds no tiles"),
        (vector_by_name, r"holds vector tiles \(pbf\); must hold images"),
        (vector_by_content, r"holds vector tiles \(pbf\); must hold images"),
        (
            something_else,
            r"its tiles are no images \(something instead of an image: something else\); must be png",
        ),
        (not_square, "its tiles are of 512x256 px; must be square"),
        (zooms_that_are_none, "its tiles are of zooms None to None; must be whole numbers"),
        (an_odd_size, "tile size 300 px: must be a multiple of 256"),
    ],
)
def test_what_is_no_mbtiles_is_refused_in_one_line(tmp_path, make, message):
    path = tmp_path / "own.mbtiles"
    make(path)
    with pytest.raises(InvalidInput, match=message) as raised:
        open_mbtiles(path)
    assert str(path) in str(raised.value)
    assert "\n" not in str(raised.value)
    # Nothing is made in its place.
    assert path.exists() == (make is not no_file)


@pytest.mark.parametrize("name", ["with space", "100% & more", "a?mode=rwc", "a#b", "été", "a'b\"c"])
@pytest.mark.parametrize("wal", [False, True])
def test_any_name(tmp_path, name, wal):
    path = write(tmp_path / f"{name}.mbtiles", some_tiles(), wal=wal)
    before = path.read_bytes()
    source = open_mbtiles(path)
    assert np.array_equal(source.fetch("", window()), positions("", ZOOM, 20, 30, 256))
    source.close()
    assert path.read_bytes() == before
    assert source.title == name


def test_relative_paths(tmp_path, monkeypatch):
    write(tmp_path / "own.mbtiles", some_tiles())
    monkeypatch.chdir(tmp_path)
    source = open_mbtiles("own.mbtiles")
    monkeypatch.chdir("/")
    source.fetch("", window())
    source.close()


def test_what_another_program_is_writing_is_seen(tmp_path):
    path = write(tmp_path / "own.mbtiles", some_tiles(), wal=True)
    with closing(sqlite3.connect(path)) as writer:
        writer.execute(
            "INSERT INTO tiles VALUES (?, 1, 63, ?)", (ZOOM, to_bytes(positions("", ZOOM, 1, 0, 256), "png"))
        )
        writer.commit()
        # It is in the log only.
        assert Path(f"{path}-wal").stat().st_size > 0
        source = open_mbtiles(path)
        assert np.array_equal(source.fetch("", window(1, 0)), positions("", ZOOM, 1, 0, 256))
        source.close()


def test_a_cache_is_a_source(tmp_path):
    cache = TileCache(tmp_path)
    with CachingTileServer(headers={"Cache-Control": "max-age=60"}) as server:
        online = source_of(server.url_template, cache, title="Somebody", attribution="© Somebody", date="2020")
        picture = online.fetch("", tile(3, 4))
        online._stores[""].flush()
        (file,) = cache.list()
        offline = open_mbtiles(file.path)
        assert np.array_equal(offline.fetch("", tile(3, 4)), picture)
        assert (offline.title, offline.attribution, offline.date) == ("Somebody 2020", "© Somebody", "2020")
        offline.close()
        online.close()


READ_AS_SOMEBODY = """
import os, sys
from terrainav.core.errors import TerrAInavError
from terrainav.core.imagery.mbtiles import open_mbtiles
from terrainav.core.imagery.source import Window
os.getuid() or os.setuid(65534)
try:
    print(open_mbtiles(sys.argv[1]).fetch("", Window(6, 20 * 256, 30 * 256, 256, 256)).shape)
except TerrAInavError as wrong:
    print(wrong)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="folders have other permissions there")
@pytest.mark.parametrize("log", [False, True])
def test_a_wal_file_in_a_folder_that_is_read_only(readable_folder, log):
    folder = readable_folder / "own"
    folder.mkdir()
    path = write(folder / "own.mbtiles", some_tiles(), wal=True)
    if log:
        # What it holds may be more than the file: reading past it would be reading something old.
        Path(f"{path}-wal").write_bytes(b"something")
        Path(f"{path}-wal").chmod(0o400)
    path.chmod(0o444)
    folder.chmod(0o555)
    result = subprocess.run(
        [sys.executable, "-c", READ_AS_SOMEBODY, str(path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    folder.chmod(0o755)
    expected = "is not an MBTiles file, or is damaged" if log else "(256, 256, 3)"
    assert expected in result.stdout
    assert result.stdout.count("\n") == 1


def test_many_threads(tmp_path):
    source = open_mbtiles(write(tmp_path / "own.mbtiles", some_tiles()))
    windows = [window(x, y) for x in (20, 21) for y in (30, 31)] * 10
    with ThreadPoolExecutor(8) as threads:
        pictures = list(threads.map(partial(source.fetch, ""), windows))
    source.close()
    for part, picture in zip(windows, pictures):
        assert np.array_equal(picture[0, 0], encode_position([part.left_px], [part.top_px])[0, 0])


def test_a_locked_file_is_waited_for_until_the_source_is_closed(tmp_path):
    path = write(tmp_path / "own.mbtiles", some_tiles())
    source, closed = open_mbtiles(path), open_mbtiles(path)
    with closing(sqlite3.connect(path, isolation_level=None, check_same_thread=False)) as other:
        other.execute("BEGIN EXCLUSIVE")
        threading.Timer(0.2, closed.close).start()
        started_s = time.monotonic()
        with pytest.raises(Cancelled):
            closed.fetch("", window())
        # Half a second is the promise; a busy machine may take a while longer, and what is locked stays so for ever.
        assert time.monotonic() - started_s < 0.2 + 0.5 + 5.0
        threading.Timer(0.3, other.execute, ["ROLLBACK"]).start()
        assert source.fetch("", window()).shape == (256, 256, 3)
    source.close()


def test_damage_is_a_missing_part(tmp_path):
    rng = np.random.default_rng(5)
    tiles = {
        (8, x, y): to_bytes(rng.integers(0, 256, (256, 256, 3), np.uint8), "png") for x in range(3) for y in range(2)
    }
    path = write(tmp_path / "own.mbtiles", tiles)
    source = open_mbtiles(path)
    with path.open("r+b") as file:
        file.seek(8192)
        file.write(os.urandom(path.stat().st_size - 8192))
    for zoom, x, y in list(tiles)[1:]:
        with pytest.raises(PartError, match=f"tile {zoom}/{x}/{y}"):
            source.fetch("", Window(zoom, x * 256, y * 256, 256, 256))
    source.close()


def test_a_title_is_one_line_of_what_can_be_printed(tmp_path):
    source = open_mbtiles(write(tmp_path / "own.mbtiles", some_tiles(), name="my\nown \x1b[31mtiles"))
    assert source.title == "my own [31mtiles"
    source.close()


def test_a_name_that_is_too_long_is_one_line():
    with pytest.raises(InvalidInput, match="cannot be read"):
        open_mbtiles("x" * 5000 + ".mbtiles")
