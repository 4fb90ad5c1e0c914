"""Lengths, floors and colours as files write them."""

from __future__ import annotations

import math
import re
from typing import Union

#: Height of a floor where a file counts floors, metres.
LEVEL_M = 3.0

Value = Union[str, int, float, None]

_FOOT_M, _INCH_M = 0.3048, 0.0254
_UNITS_M = {
    "": 1.0, "m": 1.0, "meter": 1.0, "meters": 1.0, "metre": 1.0, "metres": 1.0, "mt": 1.0, "mts": 1.0,
    "cm": 0.01, "km": 1000.0, "ft": _FOOT_M, "foot": _FOOT_M, "feet": _FOOT_M, "'": _FOOT_M,
    "in": _INCH_M, "inch": _INCH_M, "inches": _INCH_M, '"': _INCH_M,
}  # fmt: skip
_FLOORS = {"floor", "floors", "level", "levels", "storey", "storeys", "story", "stories"}
_WORDS = {
    word: number
    for number, word in enumerate("zero one two three four five six seven eight nine ten eleven twelve".split())
}
_NUMBER = re.compile(r"([+-]?\d+(?:[.,]\d+)?|[+-]?[.,]\d+)\s*([a-z'\"]*)")
_FEET_INCHES = re.compile(r"(\d+(?:\.\d+)?)\s*'\s*(?:(\d+(?:\.\d+)?)\s*\"?)?")
_WORD = re.compile(r"([a-z]+)\s+([a-z]+)")
_COLOURS = {
    "black": 0x202020, "white": 0xF2F2F2, "grey": 0x808080, "gray": 0x808080, "silver": 0xC0C0C0, "red": 0xB03A2E,
    "maroon": 0x800000, "brown": 0x8B5A3C, "yellow": 0xE3C565, "orange": 0xD98A3D, "green": 0x5B8C5A, "olive": 0x808000,
    "blue": 0x4F6D9A, "navy": 0x000080, "purple": 0x800080, "pink": 0xE8B4B8, "beige": 0xE8DCC0, "tan": 0xD2B48C,
    "cream": 0xF3E9C9, "lightgrey": 0xD3D3D3, "lightgray": 0xD3D3D3, "darkgrey": 0x5A5A5A, "darkgray": 0x5A5A5A,
    "teal": 0x008080, "aqua": 0x00FFFF, "lime": 0x00FF00, "fuchsia": 0xFF00FF, "salmon": 0xFA8072, "gold": 0xD4AF37,
}  # fmt: skip


def read_length_m(value: Value) -> float | None:
    """Length in metres of a value as written; None if it has none.

    Marks of doubt ("~12", "3 m?") are dropped, of several values ("12;15") the first counts, a decimal comma is one,
    feet and inches are converted, and counts of floors ("two floors") have `LEVEL_M` each.
    """
    if value is None or isinstance(value, (int, float)):
        return _finite(value)
    text = _plain(value)
    found = _FEET_INCHES.fullmatch(text)
    if found:
        return float(found[1]) * _FOOT_M + float(found[2] or 0.0) * _INCH_M
    found = _NUMBER.fullmatch(text)
    if found:
        number = float(found[1].replace(",", "."))
        if found[2] in _FLOORS:
            return _finite(number * LEVEL_M)
        return _finite(number * _UNITS_M[found[2]]) if found[2] in _UNITS_M else None
    found = _WORD.fullmatch(text)
    if found and found[1] in _WORDS:
        if found[2] in _FLOORS:
            return _WORDS[found[1]] * LEVEL_M
        return _WORDS[found[1]] * _UNITS_M[found[2]] if found[2] in _UNITS_M else None
    return None


def read_number(value: Value) -> float | None:
    """Plain number, such as a count of floors; None if there is none."""
    if value is None or isinstance(value, (int, float)):
        return _finite(value)
    text = _plain(value)
    if text in _WORDS:
        return float(_WORDS[text])
    found = _NUMBER.fullmatch(text)
    return _finite(float(found[1].replace(",", "."))) if found and (not found[2] or found[2] in _FLOORS) else None


def read_direction_deg(value: Value) -> float | None:
    """Compass direction in degrees, from a number or a point such as "NNW"; None if there is none."""
    points = "n nne ne ene e ese se sse s ssw sw wsw w wnw nw nnw".split()
    text = value.strip().lower().rstrip("°") if isinstance(value, str) else value
    if text in points:
        return points.index(str(text)) * 22.5
    return read_number(text)


def read_colour(value: Value) -> tuple[int, int, int] | None:
    """Colour of a name or of "#rgb" or "#rrggbb"; None if it is neither."""
    if not isinstance(value, str):
        return None
    text = re.sub(r"[\s_-]", "", value.lower())
    if re.fullmatch(r"#?[0-9a-f]{3}", text):
        text = "".join(2 * digit for digit in text.lstrip("#"))
    if re.fullmatch(r"#?[0-9a-f]{6}", text):
        number = int(text.lstrip("#"), 16)
    elif text in _COLOURS:
        number = _COLOURS[text]
    else:
        return None
    return number >> 16, number >> 8 & 255, number & 255


def _plain(text: str) -> str:
    """First of several values, in lower case, without marks of doubt."""
    text = text.partition(";")[0].strip().lower().replace("′", "'").replace("″", '"').replace("’", "'")
    return re.sub(r"^(?:~|≈|ca\.?|circa|approx\.?|about)\s*|\s*\??$", "", text)


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None
