"""JSON that others wrote, and files of theirs: as json reads them, or one line that says why not."""

from __future__ import annotations

import contextlib
import json
import math
import os
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.limits import MAX_JSON_DEPTH, MAX_JSON_DIGITS
from terrainav.core.storage.files import read_limited
from terrainav.core.text.safe_json import parse_json

_TEXT = st.text(st.characters(exclude_categories=["Cs"]))
_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | _TEXT,
    lambda inner: st.lists(inner) | st.dictionaries(_TEXT, inner),
)


@given(_VALUES, st.booleans())
def test_what_others_write_properly_is_read_as_json_reads_it(value, ascii_only):
    text = json.dumps(value, ensure_ascii=ascii_only)
    assert parse_json(text) == value
    assert parse_json(b"\xef\xbb\xbf" + text.encode()) == value


@given(st.text() | st.binary())
def test_anything_else_is_read_or_refused(text):
    with contextlib.suppress(InvalidInput):
        parse_json(text)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[" * 100_000, "nested too deep"),
        ('{"a":' * 100_000, "nested too deep"),
        ("[" * (MAX_JSON_DEPTH + 1) + "]" * (MAX_JSON_DEPTH + 1), "nested too deep"),
        ('{"a":' * MAX_JSON_DEPTH + "[]" + "}" * MAX_JSON_DEPTH, "nested too deep"),
        ("9" * (MAX_JSON_DIGITS + 1), "a whole number of 301 digits"),
        ("-" + "9" * 3_000_000, "a whole number of 3,000,001 digits"),
        ("1e400", "number 1e400: too large"),
        ("-1e400", "number -1e400: too large"),
        ("9" * 1000 + ".0", "number 99999999999999999999…: too large"),
        ("NaN", "NaN: JSON has finite numbers only"),
        ("[-Infinity]", "-Infinity: JSON has finite numbers only"),
        ('"\\ud800"', "\\ud800 alone is half a character"),
        ('{"\\uDFFF": 1}', "half a character"),
        ('[["\\udcff"]]', "half a character"),
        (b'"\xff"', "not UTF-8: byte 1 is invalid"),
        (b'"\xed\xa0\x80"', "not UTF-8"),
        ("", "Expecting value: line 1"),
    ],
)
def test_what_could_hang_fill_or_end_the_program_is_refused(text, why):
    with pytest.raises(InvalidInput) as caught:
        parse_json(text)
    assert why in str(caught.value)
    assert len(str(caught.value)) < 200


def test_limits_are_reached_and_not_passed():
    deepest = "[" * MAX_JSON_DEPTH + "]" * MAX_JSON_DEPTH
    assert parse_json(deepest) == json.loads(deepest)
    largest = parse_json("9" * MAX_JSON_DIGITS)
    assert math.isfinite(float(largest))
    assert parse_json('"\\ud83d\\ude80"') == "🚀"
    assert len(parse_json("[" + "[]," * 1000 + "[]]")) == 1001


def test_a_file_is_read_up_to_its_limit(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"12345678")
    assert read_limited(path, 8) == b"12345678"
    with pytest.raises(InvalidInput, match="larger than 0 MB"):
        read_limited(path, 7)
    with pytest.raises(FileNotFoundError):
        read_limited(tmp_path / "none", 8)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no /dev/zero")
def test_a_file_without_an_end_is_refused():
    endless = os.devnull.replace("null", "zero")
    with pytest.raises(InvalidInput, match="larger than 1 MB"):
        read_limited(endless, 1_000_000, named_by_user=True)
    with pytest.raises(OSError, match="not a regular file"):
        read_limited(endless, 1_000_000)
