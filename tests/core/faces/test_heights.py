"""Values as files write them."""

from __future__ import annotations

import pytest
from terrainav.core.faces.heights import read_colour, read_direction_deg, read_length_m, read_number


@pytest.mark.parametrize(
    ("value", "length_m"),
    [
        ("22 m", 22.0), ("22m", 22.0), ("70 ft", 21.336), ("22'6\"", 6.858), ("22'", 6.7056), ("3 m?", 3.0),
        ("two floors", 6.0), ("4 floors", 12.0), ("~12", 12.0), ("12;15", 12.0), ("1,5 m", 1.5), (7, 7.0), (7.5, 7.5),
        (" 9 ", 9.0), ("-2", -2.0), ("350 cm", 3.5), ("tall", None), ("", None), (None, None), (float("nan"), None),
        ("12 parsecs", None), ("1e999", None), ("3-4", None),
    ],
)  # fmt: skip
def test_lengths(value, length_m):
    assert read_length_m(value) == (length_m if length_m is None else pytest.approx(length_m, abs=1e-12))


def test_numbers_and_directions():
    assert [read_number(v) for v in ("3", "2.5", "two", "3 levels", "3 m", 4, None)] == [3, 2.5, 2, 3, None, 4, None]
    assert [read_direction_deg(v) for v in ("N", "ssw", "135°", 90, "up")] == [0, 202.5, 135, 90, None]


def test_colours():
    assert read_colour("#f00") == read_colour("ff0000") == (255, 0, 0)
    assert read_colour("Light Grey") == (0xD3, 0xD3, 0xD3)
    assert read_colour("#12345") is read_colour(3) is read_colour("no colour") is None
