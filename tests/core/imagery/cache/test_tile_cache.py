"""Tiles kept from run to run, over real HTTP; files are read back with plain sqlite3 and with GDAL."""

from __future__ import annotations

import hashlib
import sqlite3
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput, OutputError, PartError, SourceError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.cache import database
from terrainav.core.imagery.cache.tile_cache import TileCache, default_folder
from terrainav.core.imagery.http.transport import Response
from terrainav.core.imagery.placeholder import Placeholder
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.tiles import Tile
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.cached import ZOOM, Clock, source_of, tile
from tests.support.caching import CachingTileServer
from tests.support.faults import flat_placeholder
from tests.support.patterns import decode_position, positions

ROOT = Path(__file__).resolve().parents[4]
HOUR = {"Cache-Control": "max-age=3600"}


@pytest.fixture
def clock():
    return Clock(time.time())


@pytest.fixture
def cache(tmp_path, clock):
    return TileCache(tmp_path / "cache", clock=clock)


def fetch(server, cache, columns=range(1), **options):
    """Fetch some tiles with a source of its own, and see that every pixel is right."""
    source = source_of(server.url_template, cache, **options)
    try:
        for x in columns:
            assert np.array_equal(source.fetch("", tile(x)), server.paint("satellite", ZOOM, x, 0, 256))
    finally:
        source.close()


def stored(cache):
    return sum(file.tiles for file in cache.list())


def test_a_second_run_makes_no_request(cache):
    with CachingTileServer(headers=HOUR) as server:
        for _ in range(2):
            source = source_of(server.url_template, cache)
            with ThreadPoolExecutor(8) as threads:
                pictures = list(threads.map(partial(source.fetch, ""), map(tile, range(30))))
            source.close()
            for x, picture in enumerate(pictures):
                assert np.array_equal(picture, positions("satellite", ZOOM, x, 0, 256))
        assert sum(server.requests.values()) == 30


def test_a_capture_without_network_is_the_capture_with_it(cache, tmp_path):
    with CachingTileServer(headers=HOUR) as server:
        mission = Mission(Box(35.140, -89.862, 35.138, -89.858), 120.0, overlap_along=0.2)
        worked_out = plan(mission, PixelGrid())
        folders = []
        for name in ("online", "offline"):
            source = source_of(server.url_template, cache)
            result = capture(worked_out, source, tmp_path / name)
            source.close()
            assert (result.written, len(result.failed)) == (len(worked_out), 0)
            folders.append({path.name: path.read_bytes() for path in (tmp_path / name / "satellite").iterdir()})
            assert sum(server.requests.values()) == worked_out.requests
            server.fail("503")
    assert folders[0] == folders[1]
    assert len(folders[0]) > len(worked_out) > 3


def test_without_network_the_same_pictures_come_again(cache):
    with CachingTileServer(headers=HOUR) as server:
        fetch(server, cache, range(5))
    fetch(server, cache, range(5))


@pytest.mark.parametrize("length_in_304", [False, True])
@pytest.mark.parametrize("validators", [{"etag": True}, {"last_modified": "Sun, 06 Nov 1994 08:49:37 GMT"}])
def test_what_has_expired_is_confirmed(cache, clock, validators, length_in_304):
    with CachingTileServer(headers=HOUR, length_in_304=length_in_304, clock=clock, **validators) as server:
        fetch(server, cache)
        clock.now_s += 3601
        fetch(server, cache)
        assert server.statuses == {200: 1, 304: 1}
        # The confirmation holds for another hour.
        clock.now_s += 3500
        fetch(server, cache)
        assert server.statuses == {200: 1, 304: 1}


def test_what_a_clock_that_was_wrong_has_stored_is_confirmed(cache, clock):
    now_s = clock.now_s
    with CachingTileServer(headers={"Cache-Control": "max-age=31536000"}, etag=True, clock=clock) as server:
        clock.now_s = now_s + 74 * 365 * 86400
        fetch(server, cache)
        clock.now_s = now_s
        fetch(server, cache)
        assert server.statuses == {200: 1, 304: 1}
        fetch(server, cache)
        assert server.statuses == {200: 1, 304: 1}


def test_what_has_changed_comes_anew(cache, clock):
    with CachingTileServer(headers=HOUR, etag=True, clock=clock) as server:
        fetch(server, cache)
        clock.now_s += 3601
        server.paint = lambda *address: 255 - positions(*address)
        fetch(server, cache)
        fetch(server, cache)
        assert server.statuses == {200: 2}
    assert stored(cache) == 1


def test_without_validators_it_is_asked_for_plainly(cache, clock):
    with CachingTileServer(headers=HOUR) as server:
        fetch(server, cache)
        clock.now_s += 3601
        fetch(server, cache)
        assert server.statuses == {200: 2}


@pytest.mark.parametrize(
    ("control", "tiles", "statuses"),
    [
        ("no-store", 0, {200: 2}),
        ("private, max-age=60", 1, {200: 1}),
        ("no-cache", 1, {200: 1, 304: 1}),
        ("max-age=0", 1, {200: 1, 304: 1}),
    ],
)
def test_cache_control(cache, control, tiles, statuses):
    with CachingTileServer(headers={"Cache-Control": control}, etag=True) as server:
        fetch(server, cache)
        fetch(server, cache)
        assert server.statuses == statuses
    assert stored(cache) == tiles


def test_nothing_is_on_disk_where_the_terms_forbid_it(cache):
    with CachingTileServer(headers=HOUR) as server:
        fetch(server, cache, policy=Policy(cache_allowed=False))
        fetch(server, cache, policy=Policy(cache_allowed=False))
        assert sum(server.requests.values()) == 2
    assert not cache.folder.exists()


def test_a_stored_tile_does_not_count_against_the_terms(cache):
    policy = Policy("no", max_tiles=3, terms="no bulk download", terms_url="https://h/terms")
    with CachingTileServer(headers=HOUR) as server:
        fetch(server, cache, range(3), policy=policy)
        source = source_of(server.url_template, cache, policy=policy)
        for x in range(6):
            source.fetch("", tile(x))
        with pytest.raises(SourceError, match="no bulk download"):
            source.fetch("", tile(6))
        source.close()


def test_a_server_out_of_reach_leaves_the_stale_copy(cache, clock):
    with CachingTileServer(headers=HOUR, etag=True) as server:
        fetch(server, cache, range(3))
    clock.now_s += 10 * 86400
    source = source_of(server.url_template, cache)
    tries = []
    asked = source._client._transport.get
    source._client._transport.get = lambda *args: tries.append(args) or asked(*args)
    for x in range(3):
        assert np.array_equal(source.fetch("", tile(x)), positions("satellite", ZOOM, x, 0, 256))
    # Only the first was tried: the others know that nobody answers.
    assert len(tries) == 2
    with pytest.raises(PartError, match="no connection"):
        source.fetch("", tile(7))
    source.close()


@pytest.mark.parametrize("control", ["no-cache", "must-revalidate, max-age=60"])
def test_a_stale_copy_is_not_used_where_that_is_forbidden(cache, clock, control):
    with CachingTileServer(headers={"Cache-Control": control}) as server:
        fetch(server, cache)
    clock.now_s += 3601
    with pytest.raises(PartError, match="no connection"):
        fetch(server, cache)


@pytest.mark.parametrize("kind", ["500", "503", "504", "reset"])
def test_a_failing_server_leaves_the_stale_copy(cache, clock, kind):
    with CachingTileServer(headers=HOUR) as server:
        fetch(server, cache)
        clock.now_s += 3601
        server.fail(kind)
        fetch(server, cache)
        assert sum(server.requests.values()) == 3


def test_a_bad_copy_in_place_of_what_has_expired_is_got_round(cache, clock):
    with CachingTileServer(headers=HOUR, etag=True, clock=clock) as server:
        fetch(server, cache)
        clock.now_s += 3601
        # Asked for under conditions, which the second request must not repeat.
        server.fail("bad-copy")
        fetch(server, cache)
        assert sum(server.requests.values()) == 3
        fetch(server, cache)
        assert sum(server.requests.values()) == 3
    assert stored(cache) == 1


@pytest.mark.parametrize("kind", ["404", "410"])
def test_a_tile_that_is_gone_is_gone_from_the_cache(cache, clock, kind):
    with CachingTileServer(headers=HOUR) as server:
        fetch(server, cache, range(2))
        clock.now_s += 3601
        server.fail(kind, (ZOOM, 0, 0))
        with pytest.raises(PartError, match=kind):
            fetch(server, cache)
    assert stored(cache) == 1


@pytest.mark.parametrize(
    "kind", ["html", "truncated-jpeg", "corrupt", "corrupt-jpeg", "wrong-size", "flat", "short-body"]
)
def test_only_whole_pictures_are_stored(cache, kind):
    placeholder = Placeholder(sha256=(hashlib.sha256(flat_placeholder()).hexdigest(),))
    with CachingTileServer(headers=HOUR) as server:
        server.fail(kind)
        with pytest.raises(PartError):
            fetch(server, cache, placeholder=placeholder)
        assert stored(cache) == 0
        server.heal()
        fetch(server, cache, placeholder=placeholder)
    assert stored(cache) == 1


def test_a_stored_picture_that_counts_as_placeholder_now_is_dropped(cache):
    with CachingTileServer(lambda *_: np.full((256, 256, 3), 204, np.uint8), headers=HOUR) as server:
        fetch(server, cache)
        with pytest.raises(PartError, match="one colour"):
            fetch(server, cache, placeholder=Placeholder(flat_rgb=((204, 204, 204),)))
    assert stored(cache) == 0


def contents(folder):
    return b"".join(path.name.encode() + path.read_bytes() for path in sorted(folder.iterdir()))


def test_the_key_is_nowhere_in_the_folder(cache):
    key = "s3cr3t+key/of=mine"
    # A server that sends the key back where it would be stored.
    told = {**HOUR, "Last-Modified": f"{key}"}
    with CachingTileServer(headers=told, etag=True) as server:
        source = source_of(server.url_template + "?access_token={key}", cache, key=key)
        source.fetch("", tile(0))
        source._stores[""].flush()
        written = contents(cache.folder)
        source.close()
    written += contents(cache.folder)
    assert b"SQLite format 3" in written
    for secret in (key, "s3cr3t", "access_token", "%2Bkey"):
        assert secret.encode() not in written


def test_another_key_finds_the_same_tiles(cache):
    with CachingTileServer(headers=HOUR) as server:
        for key in ("one", "two"):
            source = source_of(server.url_template + "?k={key}", cache, key=key)
            source.fetch("", tile(0))
            source.close()
        assert sum(server.requests.values()) == 1


def test_a_file_for_each_source_map_type_date_and_size(cache):
    with CachingTileServer(headers=HOUR) as server:
        dated = server.map_type_template.replace(".png", ".png?d={date}")
        for date in ("2020", "2021"):
            source = source_of(dated, cache, date=date, name="usgs", title="USGS")
            for map_type in ("satellite", "terrain"):
                picture = source.fetch(map_type, tile(0))
                assert np.array_equal(picture, positions(map_type, ZOOM, 0, 0, 256))
            source.close()
        source = source_of(server.url_template.replace("{y}", "{y}@2x"), cache, grid=PixelGrid(512))
        source.fetch("", tile(0, tile_px=512))
        source.close()
    files = cache.list()
    assert [(file.source, file.map_type, file.date, file.tile_px) for file in files] == [
        ("127.0.0.1", "", "", 512),
        ("usgs", "satellite", "2020", 256),
        ("usgs", "satellite", "2021", 256),
        ("usgs", "terrain", "2020", 256),
        ("usgs", "terrain", "2021", 256),
    ]
    assert [file.path.name.rpartition("-")[0] for file in files] == [
        "127.0.0.1-512",
        "usgs-satellite-2020-256",
        "usgs-satellite-2021-256",
        "usgs-terrain-2020-256",
        "usgs-terrain-2021-256",
    ]
    assert {file.title for file in files} == {"127.0.0.1", "USGS"}


@pytest.mark.parametrize("extension", ["png", "webp"])
def test_other_software_reads_the_file(cache, extension):
    """Nine tiles away from all edges: GDAL finds every pixel where the tile said it is."""
    with CachingTileServer(headers=HOUR) as server:
        template = server.url_template.replace("png", extension)
        source = source_of(template, cache, name="somebody", title="Somebody", attribution="© Somebody")
        for x in range(100, 103):
            for y in range(200, 203):
                source.fetch("", tile(x, y))
        source.close()
    (file,) = cache.list()
    with closing(sqlite3.connect(file.path)) as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        assert database.execute("PRAGMA application_id").fetchone() == (0x4D504258,)
        told = dict(database.execute("SELECT name, value FROM metadata"))
        rows = database.execute("SELECT min(tile_row), max(tile_row), count(*) FROM tiles").fetchone()
    assert rows == (511 - 202, 511 - 200, 9)
    assert told["name"] == "Somebody"
    assert told["format"] == extension
    assert (told["minzoom"], told["maxzoom"], told["type"]) == ("9", "9", "baselayer")
    assert told["attribution"] == "© Somebody"
    dataset = gdal.Open(str(file.path))
    assert dataset.GetDriver().ShortName == "MBTiles"
    left, resolution, _, top, _, _ = dataset.GetGeoTransform()
    half_m = 20037508.342789244
    columns, rows = decode_position(np.moveaxis(dataset.ReadAsArray()[:3], 0, -1))
    assert columns.shape == (768, 768)
    assert round((left + half_m) / resolution, 4) == 100 * 256
    assert round((half_m - top) / resolution, 4) == 200 * 256
    assert np.array_equal(columns[0], (100 * 256 + np.arange(768)) % 4096)
    assert np.array_equal(rows[:, 0], (200 * 256 + np.arange(768)) % 4096)


def test_the_least_recently_used_go_first_and_the_files_shrink(tmp_path, clock, monkeypatch):
    # However slow the machine.
    monkeypatch.setattr("terrainav.core.imagery.cache.tile_cache._TRIM_S", 60.0)
    noise = np.frombuffer(hashlib.shake_256(b"noise").digest(256 * 256 * 3), np.uint8).reshape(256, 256, 3)
    with CachingTileServer(
        lambda _t, _z, x, _y, _s: noise + np.uint8(x), headers={"Cache-Control": "max-age=9999999"}
    ) as server:
        plenty = TileCache(tmp_path, clock=clock)
        for x in range(18):
            fetch(server, plenty, [x], name=f"source-{x % 2}")
            clock.now_s += 3600
        # Those of the first half are used again.
        for x in range(0, 18, 3):
            fetch(server, plenty, [x], name=f"source-{x % 2}")
        before = sum(file.stat().st_size for file in tmp_path.iterdir())
        assert before > 18 * noise.size
        limit = 12 * noise.size
        little = TileCache(tmp_path, limit_bytes=limit, clock=clock)
        clock.now_s += 3600
        fetch(server, little, [31], name="source-1")
        after = sum(file.stat().st_size for file in tmp_path.iterdir())
        assert limit / 2 < after <= limit
        requests = sum(server.requests.values())
        for x in [*range(0, 18, 3), 17, 31]:
            fetch(server, plenty, [x], name=f"source-{x % 2}")
        assert sum(server.requests.values()) == requests
        fetch(server, plenty, [1], name="source-1")
        assert sum(server.requests.values()) == requests + 1


def test_clear(cache):
    with CachingTileServer(headers=HOUR) as server:
        for name in ("usgs", "ign", "pdok"):
            fetch(server, cache, range(3), name=name, title=name.upper())
        (cache.folder / "my-own.mbtiles").write_bytes(b"mine")
        (cache.folder / "notes.txt").write_bytes(b"mine")
        # A folder is none of the cache's files, whatever it is called.
        (cache.folder / "a-0123456789ab.mbtiles").mkdir()
        with pytest.raises(InvalidInput, match=r"cache 'osm': is not there; .* holds ign, pdok, usgs"):
            cache.clear(["usgs", "osm"])
        assert len(cache.list()) == 3
        assert cache.clear(["usgs", "IGN"]) > 0
        assert [file.source for file in cache.list()] == ["pdok"]
        assert cache.clear() > 0
        assert cache.list() == ()
        left = sorted(path.name for path in cache.folder.iterdir())
        assert left == ["a-0123456789ab.mbtiles", "my-own.mbtiles", "notes.txt"]
        assert cache.clear() == 0


def test_a_file_that_cannot_be_removed_keeps_no_other(cache, monkeypatch):
    with CachingTileServer(headers=HOUR) as server:
        for name in ("ign", "usgs"):
            fetch(server, cache, range(3), name=name, title=name)
    remove = database.remove

    def held(path):
        if "ign" in path.name:
            raise PermissionError(13, "Permission denied")
        return remove(path)

    monkeypatch.setattr(database, "remove", held)
    with pytest.raises(OutputError, match=r"ign.*: cannot be removed"):
        cache.clear()
    assert [file.source for file in cache.list()] == ["ign"]


def test_clearing_a_file_in_use_leaves_it_whole(cache):
    with CachingTileServer(headers=HOUR) as server:
        source = source_of(server.url_template, cache)
        for x in range(5):
            source.fetch("", tile(x))
        source._stores[""].flush()
        script = (
            "from terrainav.core.imagery.cache.tile_cache import TileCache; "
            f"print(TileCache({str(cache.folder)!r}).clear())"
        )
        freed = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, timeout=60)
        assert int(freed.stdout) > 0
        assert stored(cache) == 0
        for x in range(10):
            assert np.array_equal(source.fetch("", tile(x)), positions("satellite", ZOOM, x, 0, 256))
        source.close()
        assert sum(server.requests.values()) == 15
        fetch(server, cache, range(10))
        assert sum(server.requests.values()) == 15


def test_a_file_locked_by_another_program_holds_no_capture_up(cache):
    with CachingTileServer(headers=HOUR) as server:
        fetch(server, cache)
        (file,) = cache.list()
        source = source_of(server.url_template, cache)
        with closing(sqlite3.connect(file.path, isolation_level=None)) as other:
            other.execute("BEGIN IMMEDIATE")
            for x in range(5):
                source.fetch("", tile(x))
            other.execute("ROLLBACK")
        source.close()
    assert stored(cache) == 5


def test_many_threads_and_two_sources_of_a_program(cache):
    with CachingTileServer(headers=HOUR) as server:
        sources = [source_of(server.url_template, cache) for _ in range(2)]
        barrier = threading.Barrier(8)

        def work(number):
            barrier.wait()
            for x in range(number, 20 + number):
                picture = sources[number % 2].fetch("", tile(x))
                assert np.array_equal(picture, positions("satellite", ZOOM, x, 0, 256))

        with ThreadPoolExecutor(8) as threads:
            list(threads.map(work, range(8)))
        for source in sources:
            source.close()
    assert stored(cache) == 27


def test_after_closing_nothing_is_stored(cache):
    threads = threading.active_count()
    with CachingTileServer(headers=HOUR) as server:
        source = source_of(server.url_template, cache)
        source.fetch("", tile(0))
        store = source._stores[""]
        source.close()
        store.close()
        store.keep(Tile(ZOOM, 1, 0), Response(200, {}, b"body"))
        assert store.find(Tile(ZOOM, 1, 0)) is None
    assert stored(cache) == 1
    # The server's own thread may still be about to end.
    assert threading.active_count() <= threads + 1


@pytest.mark.parametrize(
    ("variables", "platform", "folder"),
    [
        ({"TERRAINAV_CACHE_DIR": "/tiles"}, "linux", "/tiles"),
        ({"XDG_CACHE_HOME": "/xdg"}, "linux", "/xdg/terrainav"),
        ({"XDG_CACHE_HOME": "not/absolute", "HOME": "/home/me"}, "linux", "/home/me/.cache/terrainav"),
        ({"HOME": "/home/me"}, "darwin", "/home/me/Library/Caches/terrainav"),
        ({"LOCALAPPDATA": "/local"}, "win32", "/local/terrainav/cache"),
    ],
)
def test_where_the_cache_is(monkeypatch, variables, platform, folder):
    for name in ("TERRAINAV_CACHE_DIR", "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "platform", platform)
    assert default_folder() == Path(folder)
    assert TileCache().folder == Path(folder)


def test_a_limit_of_nothing_is_refused():
    with pytest.raises(InvalidInput, match="cache of 0 bytes"):
        TileCache("anywhere", 0)
