"""MBTiles that attack: views that loop or make something large of nothing, metadata without end, huge tiles."""

from __future__ import annotations

import io
import sqlite3
import struct
import sys
import threading
import time
import zlib
from contextlib import closing

import pytest
from PIL import Image
from terrainav.core.errors import Cancelled, InvalidInput, PartError
from terrainav.core.imagery import mbtiles
from terrainav.core.imagery.mbtiles import open_mbtiles
from terrainav.core.imagery.source import Window
from terrainav.core.limits import MAX_METADATA_CHARACTERS

from tests.support.patterns import positions, to_bytes

resource = pytest.importorskip("resource", reason="this system does not say what memory was taken")

TILE = to_bytes(positions("", 6, 20, 30, 256), "png")
WINDOW = Window(6, 20 * 256, 30 * 256, 256, 256)
ROW = (6, 20, (1 << 6) - 1 - 30)
TABLE = "CREATE TABLE tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob)"
PLAIN = (TABLE, ("INSERT INTO tiles VALUES (?, ?, ?, ?)", (*ROW, TILE)))
METADATA = (
    "CREATE TABLE metadata (name text, value text)",
    "INSERT INTO metadata VALUES ('minzoom', '6'), ('maxzoom', '6')",
)
LOOPS = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT max(i) FROM n"


def made(path, *statements):
    with closing(sqlite3.connect(path)) as database:
        for one in statements:
            database.execute(*(one if isinstance(one, tuple) else (one,)))
        database.commit()
    return path


def view(data, of="one"):
    """Statements of a view of tiles whose pictures are an expression."""
    kept = TABLE.replace("TABLE tiles", "TABLE one")
    return (
        kept,
        ("INSERT INTO one VALUES (?, ?, ?, ?)", (*ROW, TILE)),
        f"CREATE VIEW tiles AS SELECT zoom_level, tile_column, tile_row, {data} AS tile_data FROM {of}",
    )


def gif_of(pixels):
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "gif")
    return out.getvalue()


def header_only(width_px):
    """PNG of any size in a few bytes: its header is all that is looked at."""
    header = b"IHDR" + struct.pack(">IIBBBBB", width_px, width_px, 8, 2, 0, 0, 0)
    chunk = struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header))
    return b"\x89PNG\r\n\x1a\n" + chunk + struct.pack(">I", 0) + b"IDAT" + struct.pack(">I", zlib.crc32(b"IDAT"))


COMPUTED = "is computed; must be a table, or a view that reads tables alone"


def chain(name, links, link, last):
    """Views of which each names the one before it several times: all of it is written out before anything is read."""
    first = "CREATE VIEW link0 AS SELECT tile_data AS x FROM one"
    return (
        *view("tile_data")[:2],
        first,
        *(f"CREATE VIEW link{at} AS {link.format(f'link{at - 1}')}" for at in range(1, links)),
        f"CREATE VIEW {name} AS {last.format(f'link{links - 1}')}",
    )


PLACE = "6 AS zoom_level, 20 AS tile_column, 33 AS tile_row"
COLUMNS = ", ".join(f"c{at} AS (c{at - 1} || c{at - 1})" for at in range(1, 26))


WORDS = (
    f"CREATE VIEW tiles AS SELECT {PLACE}, x AS tile_data, ' union' AS \"union\" "
    "FROM (SELECT x || x AS x FROM (SELECT tile_data AS x FROM one)) -- union"
)


@pytest.mark.parametrize(
    ("statements", "says"),
    [
        ((*METADATA, *view(f"({LOOPS})")), COMPUTED),
        ((f"CREATE VIEW metadata AS SELECT 'name' AS name, ({LOOPS}) AS value", *PLAIN), COMPUTED),
        # Patterns that take for ever within one step of SQLite, which asks nobody meanwhile.
        ((*METADATA, *view(f"('{'a' * 900}' LIKE '{'%a' * 200}b')")), "not authorized"),
        (
            (
                *METADATA,
                *chain("tiles", 27, "SELECT x || x AS x FROM {}", f"SELECT {PLACE}, x AS tile_data FROM {{}}"),
            ),
            COMPUTED,
        ),
        (
            (
                *PLAIN,
                *chain(
                    "metadata",
                    15,
                    "SELECT a.x FROM {0} AS a, {0} AS b, {0} AS c",
                    "SELECT 'name' AS name, x AS value FROM {}",
                ),
            ),
            COMPUTED,
        ),
        (
            (
                *METADATA,
                f"CREATE TABLE tiles (zoom_level, tile_column, tile_row, c0, {COLUMNS}, tile_data AS (c25))",
                "INSERT INTO tiles (zoom_level, tile_column, tile_row, c0) VALUES (6, 20, 33, 'x')",
            ),
            COMPUTED,
        ),
        (
            # Words within quotes and comments are none.
            (
                *METADATA,
                *view("tile_data")[:2],
                WORDS,
            ),
            COMPUTED,
        ),
        ((*METADATA, *view("tile_data" + " || 'x'" * 400)), COMPUTED),
    ],
    ids=["tiles", "metadata", "pattern", "chain", "joins", "columns", "words", "length"],
)
def test_a_view_that_loops_or_grows_is_refused_at_once(tmp_path, statements, says):
    path = made(tmp_path / "own.mbtiles", *statements)
    with pytest.raises(InvalidInput, match=says):
        open_mbtiles(path)


def test_a_step_that_copies_much_is_counted_as_such(tmp_path, monkeypatch):
    """SQLite asks whether to stop between its steps, and each of these takes some 20 ms."""
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        *view("tile_data", of="one, large, n AS a, n AS b WHERE upper(x || a.i) = lower(x || b.i) || 1"),
        "CREATE TABLE large AS SELECT hex(zeroblob(8000000)) AS x",
        "CREATE TABLE n AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 2000) SELECT i FROM n",
    )
    monkeypatch.setattr(mbtiles, "MAX_QUERY_S", 0.2)
    with pytest.raises(InvalidInput, match="takes more than"):
        open_mbtiles(path)


def test_a_view_without_end_is_given_up_in_time(tmp_path, monkeypatch):
    """Of joins alone, which honest views have, too: told by the clock."""
    many = (
        "CREATE TABLE n AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 2000) SELECT i FROM n",
    )
    end = " UNION ALL SELECT zoom_level, tile_column, tile_row, tile_data FROM one"
    loops = view("CAST(a.i + b.i + c.i + d.i AS blob)", of="one, n AS a, n AS b, n AS c, n AS d WHERE a.i = 0")
    path = made(tmp_path / "own.mbtiles", *METADATA, *many, *loops[:2], loops[2] + end)
    monkeypatch.setattr(mbtiles, "MAX_QUERY_S", 0.2)
    with pytest.raises(InvalidInput, match=r"takes more than 0\.2 s to look a tile up; give the file an index"):
        open_mbtiles(path)


def test_a_slow_look_up_ends_when_the_source_is_closed(tmp_path):
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        *PLAIN,
        "CREATE TABLE n AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 3000) SELECT i FROM n",
    )
    source = open_mbtiles(path)
    with closing(sqlite3.connect(path)) as database:
        database.execute("ALTER TABLE tiles RENAME TO one")
        database.execute(
            "CREATE VIEW tiles AS SELECT zoom_level, tile_column, tile_row, tile_data FROM one, n AS a, n AS b, n AS c "
            "WHERE a.i + b.i + c.i = 0"
        )
        database.commit()
    threading.Timer(0.2, source.close).start()
    with pytest.raises(Cancelled):
        source.fetch("", WINDOW)


@pytest.mark.parametrize(
    "data",
    [
        "zeroblob(900000000)",
        "randomblob(900000000)",
        "printf('%.*c', 900000000, 'x')",
        "replace(hex(zeroblob(99999)), '0', hex(zeroblob(4999)))",
    ],
)
def test_a_view_that_makes_large_tiles_of_nothing_takes_no_memory(tmp_path, data):
    path = made(tmp_path / "own.mbtiles", *METADATA, *view(data))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InvalidInput, match="not authorized"):
        open_mbtiles(path)
    # In kilobytes.
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000


def test_a_view_as_programs_make_it_is_read(tmp_path):
    """Each picture once, with its places beside it, rows counted from the north and joined."""
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        "CREATE TABLE map (zoom_level integer, tile_column integer, north integer, tile_id text)",
        "CREATE TABLE images (tile_data blob, tile_id text)",
        ("INSERT INTO map VALUES (?, ?, ?, 'x')", (6, 20, 30)),
        ("INSERT INTO images VALUES (?, 'x')", (TILE,)),
        "CREATE VIEW tiles AS SELECT zoom_level, tile_column, (1 << zoom_level) - 1 - north AS tile_row, "
        "CAST(coalesce(tile_data, x'') AS blob) AS tile_data FROM map JOIN images USING (tile_id)",
    )
    source = open_mbtiles(path)
    assert (source.fetch("", WINDOW) == positions("", 6, 20, 30, 256)).all()
    source.close()


@pytest.mark.parametrize("quote", ["{}", '"{}"', "[{}]", "`{}`"])
def test_views_that_nothing_of_ours_reads_do_no_harm(tmp_path, quote):
    """Of utility grids, say, or of programs that keep their own notes in the file."""
    other = "CREATE VIEW grids AS SELECT * FROM (SELECT * FROM (SELECT tile_data AS grid FROM one))"
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        view("tile_data")[0],
        ("INSERT INTO one VALUES (?, ?, ?, ?)", (*ROW, TILE)),
        other,
        f"CREATE VIEW {quote.format('tiles')} AS SELECT * FROM {quote.format('one')} /* of each zoom */ "
        "UNION ALL SELECT * FROM one WHERE zoom_level < 0",
    )
    source = open_mbtiles(path)
    assert (source.fetch("", WINDOW) == positions("", 6, 20, 30, 256)).all()
    source.close()


def gif_with_notes():
    """A picture whose comment comes a letter at a time, each of which Pillow has added to a copy of what was there."""
    gif = gif_of(positions("", 6, 20, 30, 256))
    colours_end = 13 + (3 << (gif[10] & 7) + 1)
    return gif[:colours_end] + b"!\xfe" + b"\x01x" * 500_000 + b"\0" + gif[colours_end:]


def test_a_file_whose_first_tile_has_endless_notes_is_opened_at_once(tmp_path):
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        TABLE,
        ("INSERT INTO tiles VALUES (?, ?, ?, ?)", (*ROW, gif_with_notes())),
    )
    begun_s = time.thread_time()
    open_mbtiles(path).close()
    assert time.thread_time() - begun_s < 1.0


@pytest.mark.parametrize(
    "tile", [TILE, to_bytes(positions("", 6, 0, 0, 256), "jpg"), gif_of(positions("", 6, 0, 0, 256))]
)
def test_a_file_whose_first_tile_is_cut_off_is_opened(tmp_path, tile):
    """That is this tile's failure."""
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        TABLE,
        ("INSERT INTO tiles VALUES (6, 0, 0, ?)", (tile[:-200],)),
    )
    open_mbtiles(path).close()


def test_metadata_without_end_are_not_read(tmp_path):
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        *PLAIN,
        ("INSERT INTO metadata VALUES ('attribution', ?)", ("x" * 5_000_000,)),
        "INSERT INTO metadata WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 300000) "
        "SELECT 'name' || i, 'x' FROM n",
    )
    source = open_mbtiles(path)
    assert len(source.attribution) == MAX_METADATA_CHARACTERS
    source.close()


def test_a_tile_that_is_there_a_million_times_is_read_once(tmp_path):
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        *view("tile_data", of="one, n"),
        "CREATE TABLE n AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT 1000000) "
        "SELECT i FROM n",
    )
    source = open_mbtiles(path)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert source.fetch("", WINDOW).shape == (256, 256, 3)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000
    source.close()


@pytest.mark.parametrize("width_px", [4352, 12_800, 1 << 30])
def test_tiles_beyond_measure_are_refused(tmp_path, width_px):
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        TABLE,
        ("INSERT INTO tiles VALUES (?, ?, ?, ?)", (*ROW, header_only(width_px))),
    )
    with pytest.raises(InvalidInput, match=r"must be square, of 4096 px at most|no images"):
        open_mbtiles(path)


@pytest.mark.parametrize("zoom", [-1, 31, 10**6, 2**62])
def test_zooms_beyond_the_grid_are_refused(tmp_path, zoom):
    path = made(
        tmp_path / "own.mbtiles",
        METADATA[0],
        TABLE,
        ("INSERT INTO tiles VALUES (?, ?, ?, ?)", (zoom, 0, 0, TILE)),
    )
    with pytest.raises(InvalidInput):
        open_mbtiles(path)


@pytest.mark.skipif(sys.version_info < (3, 11), reason="this Python sets no limits of SQLite")
def test_a_stored_tile_beyond_measure_is_that_tile_s_failure(tmp_path):
    path = made(
        tmp_path / "own.mbtiles",
        *METADATA,
        *PLAIN,
        ("INSERT INTO tiles VALUES (6, 0, 63, ?)", (bytes(70 << 20),)),
    )
    source = open_mbtiles(path)
    assert source.fetch("", WINDOW).shape == (256, 256, 3)
    with pytest.raises(PartError, match="tile 6/0/0"):
        source.fetch("", Window(6, 0, 0, 256, 256))
    source.close()
