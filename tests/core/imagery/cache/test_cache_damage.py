"""What may befall the files of a cache: none of it costs a picture, and no wrong pixel comes out."""

from __future__ import annotations

import logging
import os
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from terrainav.core.imagery.cache.tile_cache import TileCache

from tests.support.cached import ZOOM, source_of, tile
from tests.support.caching import CachingTileServer
from tests.support.patterns import positions, to_bytes
from tests.support.thinning import sampled

ROOT = Path(__file__).resolve().parents[4]
HOUR = {"Cache-Control": "max-age=3600"}
TILES = 12

# A capture as another program makes it.
CAPTURE = """
import sys
from terrainav.core.imagery.cache.tile_cache import TileCache
from tests.support.cached import source_of, tile
template, folder, first, last, say = sys.argv[1:]
{before}
source = source_of(template, TileCache(folder))
for x in range(int(first), int(last)):
    pixels = source.fetch("", tile(x))
    if say == "each":
        print(x, int(pixels.astype("int64").sum()), flush=True)
source.close()
print("done", flush=True)
"""


def other_program(server, folder, columns, *, say="end", before="", **options):
    return subprocess.Popen(
        [
            sys.executable,
            "-c",
            CAPTURE.format(before=before),
            server.url_template,
            str(folder),
            str(columns[0]),
            str(columns[1]),
            say,
        ],
        cwd=ROOT,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        **options,
    )


def fetch(server, cache, columns=range(TILES)):
    source = source_of(server.url_template, cache)
    try:
        for x in columns:
            assert np.array_equal(source.fetch("", tile(x)), positions("satellite", ZOOM, x, 0, 256)), x
    finally:
        source.close()


def requests(server):
    return sum(server.requests.values())


@pytest.fixture
def server():
    with CachingTileServer(headers=HOUR) as running:
        yield running


@pytest.fixture
def cache(tmp_path):
    return TileCache(tmp_path / "cache")


def filled(server, cache):
    """Fill the cache; return its file, which nobody has open."""
    fetch(server, cache)
    (file,) = cache.list()
    assert sorted(path.name for path in cache.folder.iterdir()) == [file.path.name]
    return file.path


@pytest.mark.thorough
def test_two_programs_at_once(server, cache):
    both = [other_program(server, cache.folder, columns) for columns in ((0, 40), (20, 60))]
    for program in both:
        out, err = program.communicate(timeout=60)
        assert (out, err) == ("done\n", "")
    before = requests(server)
    assert 60 <= before <= 80
    fetch(server, cache, range(60))
    assert requests(server) == before
    (file,) = cache.list()
    assert file.tiles == 60
    with closing(sqlite3.connect(file.path)) as database:
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)


@pytest.mark.parametrize("after", [1, 35])
def test_a_killed_program_leaves_a_whole_file(server, cache, after):
    # So that there is something to be killed in the midst of.
    before = "import terrainav.core.imagery.cache.tilestore as store; store.FLUSH_S = 0.001"
    program = other_program(server, cache.folder, (0, 400), say="each", before=before)
    told = [program.stdout.readline().split() for _ in range(after)]
    program.send_signal(signal.SIGKILL)
    program.communicate(timeout=60)
    assert [int(x) for x, _ in told] == list(range(after))
    fetch(server, cache, range(after + 5))
    (file,) = cache.list()
    assert file.tiles >= after + 5
    assert not [path for path in cache.folder.iterdir() if "corrupt" in path.name]
    before = requests(server)
    fetch(server, cache, range(after + 5))
    assert requests(server) == before


@pytest.mark.parametrize("seed", sampled(range(12), 3))
def test_bytes_changed_anywhere(tmp_path, seed):
    """JPEG, which has no checksums: what comes out is what the server sent, or is asked for anew."""
    rng = np.random.default_rng(seed)
    tiles = {
        x: to_bytes(rng.integers(0, 256, (16, 16, 3), np.uint8).repeat(16, 0).repeat(16, 1), "jpg")
        for x in range(TILES)
    }
    with CachingTileServer(read=lambda _type, _zoom, x, _y, _ending: tiles[x], headers=HOUR, etag=True) as server:
        cache = TileCache(tmp_path)

        def run():
            source = source_of(server.url_template, cache)
            found = [source.fetch("", tile(x)) for x in range(TILES)]
            source.close()
            return found

        right = run()
        (file,) = cache.list()
        content = bytearray(file.path.read_bytes())
        # In the head of the file one byte may matter, in the pictures most do not.
        ends = [100, 30_000, len(content)]
        for at in rng.integers(0, ends[seed % 3], 1 + 4 * seed):
            content[at] ^= int(rng.integers(1, 256))
        file.path.write_bytes(content)
        for _ in range(3):
            assert all(np.array_equal(one, other) for one, other in zip(run(), right))


@pytest.mark.parametrize("content", [b"", b"no database at all" * 1000, b"SQLite format 3\0" + bytes(5000)])
def test_a_file_that_is_no_database(server, cache, content, caplog):
    path = filled(server, cache)
    path.write_bytes(content)
    fetch(server, cache)
    assert requests(server) == 2 * TILES
    fetch(server, cache)
    assert requests(server) == 2 * TILES
    if content:
        assert path.with_name(path.name + ".corrupt").read_bytes() == content
        assert "is damaged; set aside" in caplog.text
        assert cache.clear() > 0
    else:
        assert not caplog.text


def test_a_file_cut_short(server, cache):
    path = filled(server, cache)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2 + 100])
    fetch(server, cache)
    before = requests(server)
    fetch(server, cache)
    assert requests(server) == before


def test_a_file_of_another_make(server, cache):
    path = filled(server, cache)
    path.unlink()
    with closing(sqlite3.connect(path)) as database:
        database.execute("PRAGMA application_id = 0x4D504258")
        database.execute("CREATE TABLE tiles (a, b)")
    fetch(server, cache)
    before = requests(server)
    fetch(server, cache)
    assert requests(server) == before


def test_damage_in_the_middle_of_a_run(server, cache, caplog):
    path = filled(server, cache)
    source = source_of(server.url_template, cache)
    source.fetch("", tile(0))
    size = path.stat().st_size
    with path.open("r+b") as file:
        file.seek(4096)
        file.write(os.urandom(size - 4096))
    for x in range(TILES):
        assert np.array_equal(source.fetch("", tile(x)), positions("satellite", ZOOM, x, 0, 256))
    source.close()
    assert caplog.text.count("is damaged; set aside") == 1
    # What the run still had in memory of the old file is not in the new one.
    fetch(server, cache)
    before = requests(server)
    fetch(server, cache)
    assert requests(server) == before
    names = sorted(entry.name for entry in cache.folder.iterdir())
    assert names == [path.name + ".corrupt", path.name.replace(".mbtiles", "~2.mbtiles")]


def test_damage_that_shows_when_the_file_is_closed(server, cache, caplog):
    path = filled(server, cache)
    with closing(sqlite3.connect(path)) as database:
        database.execute("UPDATE metadata SET value = 'everywhere' WHERE name = 'bounds'")
        database.commit()
    fetch(server, cache, [TILES])
    assert caplog.text.count("is damaged; set aside") == 1
    before = requests(server)
    fetch(server, cache, [TILES])
    assert requests(server) == before


def test_damage_comes_again_and_again(server, cache):
    """Whatever is opened is damaged at once: the run goes on without a cache."""
    filled(server, cache)
    source = source_of(server.url_template, cache)
    for x in range(TILES):
        for path in cache.folder.glob("*.mbtiles"):
            with path.open("r+b") as file:
                file.write(bytes(200))
            for ending in ("-wal", "-shm"):
                companion = path.with_name(path.name + ending)
                if companion.exists() and ending == "-wal":
                    companion.write_bytes(b"")
        assert np.array_equal(source.fetch("", tile(x)), positions("satellite", ZOOM, x, 0, 256))
        if "" in source._stores:
            source._stores[""].flush()
    source.close()


@pytest.mark.parametrize("limit", [0, 30_000, 60_000])
def test_a_full_disk(server, cache, limit):
    """No file may grow beyond the limit: the run says so once, and every picture is made."""
    before = f"import resource; resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit}))"
    program = other_program(server, cache.folder, (0, 40), say="each", before=before)
    out, err = program.communicate(timeout=60)
    sums = [line.split() for line in out.splitlines()]
    assert sums.pop() == ["done"]
    assert [int(total) for _, total in sums] == [
        int(positions("satellite", ZOOM, x, 0, 256).astype(np.int64).sum()) for x in range(40)
    ]
    assert len(err.splitlines()) == 1
    assert err.startswith("cache")
    fetch(server, cache, range(40))


@pytest.mark.skipif(sys.platform == "win32", reason="folders have other permissions there")
@pytest.mark.parametrize("content", [False, True])
def test_a_folder_that_is_read_only(server, cache, content):
    if content:
        filled(server, cache)
    else:
        cache.folder.mkdir()
    for path in [cache.folder, *cache.folder.iterdir()]:
        path.chmod(0o555 if path.is_dir() else 0o444)
    # Root may write everywhere.
    before = "from tests.support.rights import obey_permissions; obey_permissions()"
    program = other_program(server, cache.folder, (0, TILES), before=before)
    out, err = program.communicate(timeout=60)
    assert out == "done\n"
    assert len(err.splitlines()) == 1
    assert err.startswith("cache")
    cache.folder.chmod(0o755)


def test_a_file_in_place_of_the_folder(server, tmp_path, caplog):
    caplog.set_level(logging.WARNING)
    (tmp_path / "cache").write_text("a file")
    fetch(server, TileCache(tmp_path / "cache"))
    assert "this run goes without it" in caplog.text
