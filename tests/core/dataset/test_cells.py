"""Cells that are cut at commas, against the csv module and Python's ``float``."""

from __future__ import annotations

import csv
import io
import math
import struct

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from terrainav.core.dataset.cells import CsvRows, CutCells
from terrainav.core.errors import InvalidInput

from tests.support.thinning import examples

#: What a table may hold and what is in its way.
PIECES = st.sampled_from(
    [
        '"',
        '""',
        ",",
        "\n",
        "\r",
        "\r\n",
        "\0",
        " ",
        "a",
        "é",
        "𐍈",
        "1.5",
        "-",
        "nan",
        '"a,b"',
        '"x ""y"" z"',
        "0",
        "",
    ]
)
CELLS = st.one_of(
    st.floats().map(repr),
    st.integers(-(10**21), 10**21).map(str),
    st.sampled_from(
        ["", "-", ".", "-.", "+1", "1_0", " 1", "1e5", "nan", "-inf", "-0.0", "5.", ".5", "1.2.3", "٣", "650"]
    ),
    st.text("0123456789-.", max_size=24),
)


def bits(value: float) -> bytes:
    return b"nan" if math.isnan(value) else struct.pack("<d", value)


def number(cell: str) -> float | None:
    if "_" in cell or not cell.isascii():
        return None
    try:
        return float(cell) if cell else math.nan
    except ValueError:
        return None


def cut(rows: list[list[str]]) -> CutCells:
    text = "".join(",".join(row) + "\n" for row in [["x"] * len(rows[0]), *rows])
    (found,) = CsvRows([text], "table", [])
    assert isinstance(found, CutCells)
    return found


def all_rows(texts: list[str]) -> tuple[list[str], list[list[str]]] | str:
    faults: list[tuple[int, str]] = []
    try:
        rows = CsvRows(texts, "table", faults)
        found = []
        for cells in rows:
            columns = [cells.texts(column) for column in range(len(rows.headers))]
            found += zip(cells.lines, map(list, zip(*columns)))
    except InvalidInput as wrong:
        return str(wrong)
    return rows.headers, sorted(found + [(line, []) for line, _ in faults])


def rows_of_csv(text: str) -> tuple[list[str], list[list[str]]] | str:
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    try:
        headers = next(reader, [])
        found = [(reader.line_num, row if len(row) == len(headers) else []) for row in reader if row]
    except csv.Error as wrong:
        return f"table: line {reader.line_num} is not CSV ({wrong})"
    return headers, found


@settings(max_examples=examples(400))
@given(st.lists(PIECES, max_size=40).map("".join))
@example('a,b\n"x,y",1\n"z",2\n')
@example('a,b\n1,"x\ny"\n3,4')
@example('a,b\n"1""2",3\n')
@example('a,b\n1,2"3"\n')
def test_rows_are_those_of_the_csv_module(text):
    lines = io.StringIO("a,b\n1,2\n" + text, newline="\n").readlines()
    whole = "".join(lines)
    expected = rows_of_csv(whole)
    assert all_rows([whole]) == expected
    # However the lines come.
    assert all_rows(lines) == expected


@settings(max_examples=examples(400))
@given(st.lists(CELLS, min_size=1, max_size=12))
def test_numbers_are_those_that_python_reads(cells):
    expected = [number(cell) for cell in cells]
    found = cut([[cell, "x"] for cell in cells]).numbers(0)
    if None in expected:
        assert found is None
    else:
        assert [*map(bits, found.tolist())] == [*map(bits, expected)]


@pytest.mark.parametrize("digits", [1, 3, 9, 15, 16, 17, 18, 19])
def test_decimals_of_any_length_are_rounded_once(digits):
    rng = np.random.default_rng(digits)
    cells = []
    for _ in range(4000):
        text = "".join(map(str, rng.integers(0, 10, digits)))
        at = int(rng.integers(0, digits + 1))
        cells.append(("-" if rng.random() < 0.5 and digits < 19 else "") + text[:at] + "." + text[at:])
    found = cut([[cell, "x"] for cell in cells]).numbers(0)
    assert [*map(bits, found.tolist())] == [bits(float(cell)) for cell in cells]


def test_doubles_come_back_to_the_last_bit_and_halfway_between_them_goes_to_the_even_one():
    rng = np.random.default_rng(2024)
    written = [
        *map(repr, rng.uniform(-180.0, 180.0, 20_000).tolist()),
        *map(repr, rng.uniform(0.0, 8.0, 20_000).tolist()),
    ]
    # 2^53 + 1 lies in the middle between two doubles, and so do its tenths of ten times as much.
    written += ["9007199254740993", "9007199254740993.0", "9007199254740995.0", "4503599627370497.5"]
    found = cut([[cell, "x"] for cell in written]).numbers(0)
    assert [*map(bits, found.tolist())] == [bits(float(cell)) for cell in written]


def test_a_cell_longer_than_csv_takes_is_refused(monkeypatch):
    text = f"a,b\n1,{'x' * (csv.field_size_limit() + 1)}\n"
    assert all_rows([text]) == rows_of_csv(text)
    assert "field larger than field limit" in rows_of_csv(text)
