"""Numbers, aspect ratios and degrees as people type and read them."""

from __future__ import annotations

import math
import re
from fractions import Fraction

_DEGREE_DECIMALS = 7
#: Aspect ratios have parts as small as those of 4:3, 16:9 or 3000:2000; others are quotients of what was measured.
_LARGEST_DENOMINATOR = 100
_RATIO_DECIMALS = 4
#: Between the numbers of pasted coordinates.
SEPARATORS = re.compile(r"[_,;\s]+")


def parse_number(text: str) -> float:
    """Read a number as people type it: Unicode minus, degree sign and hemisphere letters are understood.

    Raises
    ------
    ValueError
        Where there is no number.
    """
    plain = text.strip().replace("\u2212", "-").rstrip("°").strip()
    sign = 1.0
    if plain and plain[-1:].upper() in "NESW":
        sign = -1.0 if plain[-1].upper() in "SW" else 1.0
        plain = plain[:-1].rstrip().rstrip("°")
    if "," in plain and "." not in plain:
        plain = plain.replace(",", ".")
    value = float(plain)
    if not math.isfinite(value):
        raise ValueError(text)
    return sign * value


def parse_aspect(text: str) -> float:
    """Width over height from ``4:3``, ``4/3``, ``4000x3000`` or ``1.333``; raises ValueError otherwise."""
    for separator in (":", "/", "x", "×"):
        if separator in text:
            width, height = (parse_number(part) for part in text.split(separator, 1))
            if height == 0.0:
                raise ValueError(text)
            return width / height
    return parse_number(text)


def aspect_text(ratio: float) -> str:
    """Shortest text that `parse_aspect` reads back as ``ratio``."""
    if not (math.isfinite(ratio) and ratio > 0.0):
        return repr(ratio)
    fraction = Fraction(ratio).limit_denominator(10_000)
    if fraction.denominator and fraction.numerator / fraction.denominator == ratio:
        return f"{fraction.numerator}:{fraction.denominator}"
    return repr(ratio)


def degrees_text(value: float, decimals: int = 7) -> str:
    """Degrees without trailing zeros; 7 decimals are a centimetre on the ground."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text


def exact_degrees_text(value: float) -> str:
    """Degrees that read back as the very same number."""
    text = degrees_text(value)
    return text if float(text) == value else repr(value)


def short_degrees(text: str) -> str:
    """Text of degrees with the decimals that mean something: 7 are a centimetre on the ground."""
    _, _, decimals = text.partition(".")
    return degrees_text(float(text)) if len(decimals) > _DEGREE_DECIMALS and decimals.isdigit() else text


def short_aspect(text: str) -> str:
    """Text of an aspect ratio to four digits, where it is a fraction that nobody would write, or has more."""
    first, colon, second = text.partition(":")
    if colon and first.isdigit() and second.isdigit():
        fraction = Fraction(int(first), int(second) or 1)
        written = (fraction.numerator, fraction.denominator) == (int(first), int(second))
        return f"{float(fraction):.4g}" if written and fraction.denominator > _LARGEST_DENOMINATOR else text
    _, point, decimals = text.partition(".")
    return f"{float(text):.4g}" if point and decimals.isdigit() and len(decimals) > _RATIO_DECIMALS else text


def looks_like_coordinates(text: str) -> bool:
    """Whether a text entered into one field holds several numbers, as pasted coordinates do."""
    return len(SEPARATORS.split(text.strip())) >= 3
