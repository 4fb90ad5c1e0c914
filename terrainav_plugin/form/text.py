"""Numbers, aspect ratios and degrees as people type and read them."""

from __future__ import annotations

import math
import re
from fractions import Fraction

from ...core.numbers import real_number
from ..i18n import decimal_sign, localized

_DEGREE_DECIMALS = 7
#: Aspect ratios have parts as small as those of 4:3, 16:9 or 3000:2000; others are quotients of what was measured.
_LARGEST_DENOMINATOR = 100
_RATIO_DECIMALS = 4
_TWO, _THREE = 2, 3
#: Between the numbers of pasted coordinates.
SEPARATORS = re.compile(r"[_,;\s]+")
#: What stands between other signs than commas, and a number with decimals, which its user writes with a comma or point.
_RUN, _DECIMAL = re.compile(r"[^_;\s]+"), re.compile(r"([-+\u2212]?\d*)[.,](\d+)")
#: A number with decimals or without, and a comma between digits.
_NUMBER = re.compile(r"[-+\u2212]?\d+(\.\d*)?")
_COMMA = re.compile(r"(?<=\d),(?=\d)")


def parse_number(text: str) -> float:
    """Read a number as people type it: Unicode minus, degree sign and hemisphere letters are understood.

    Decimals stand behind a point, a comma or the user's own sign.

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
    plain = plain.replace(decimal_sign(), ".")
    if "," in plain and "." not in plain:
        plain = plain.replace(",", ".")
    value = real_number(plain)
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
    """Text of degrees as their user writes it, with the decimals that mean something: 7 are a centimetre."""
    plain = with_point(text)
    _, _, decimals = plain.partition(".")
    if len(decimals) > _DEGREE_DECIMALS and decimals.isdigit():
        plain = degrees_text(float(plain))
    return as_written(plain)


def short_place(text: str) -> str:
    """Text of a latitude and a longitude as their user writes it, each as `short_degrees` has it."""
    parts = SEPARATORS.split(text.strip()) if "." in text else ()
    if len(parts) != _TWO or not all(map(_NUMBER.fullmatch, parts)):
        return text
    return ("; " if decimal_sign() == "," else ", ").join(map(short_degrees, parts))


def short_aspect(text: str) -> str:
    """Text of an aspect ratio as its user writes it, to four digits where nobody would write a fraction or more."""
    first, colon, second = text.partition(":")
    if colon and first.isdigit() and second.isdigit():
        fraction = Fraction(int(first), int(second) or 1)
        written = (fraction.numerator, fraction.denominator) == (int(first), int(second))
        long = written and fraction.denominator > _LARGEST_DENOMINATOR
        return as_written(f"{float(fraction):.4g}") if long else text
    plain = with_point(text)
    _, point, decimals = plain.partition(".")
    if point and decimals.isdigit() and len(decimals) > _RATIO_DECIMALS:
        plain = f"{float(plain):.4g}"
    return as_written(plain)


def with_point(text: str) -> str:
    """Text of one number with a point before its decimals; other text as it is."""
    plain = text.strip().replace("\u2212", "-").replace(decimal_sign(), ".")
    found = _DECIMAL.fullmatch(plain)
    return f"{found[1]}.{found[2]}" if found else text


def as_written(text: str) -> str:
    """Text of one number with a point as its user writes it; other text as it is."""
    return localized(text) if _DECIMAL.fullmatch(text) and "." in text else text


def with_points(text: str) -> str:
    """Text of numbers, of which commas that stand before decimals have become points.

    They do so where the user writes decimals with a comma, the text has no point, and something else stands between the
    numbers: ``35,14 -89,9`` and ``35,14, -89,9`` are two.

    Raises
    ------
    ValueError
        A comma could be either: ``35,14,-89,9``.
    """
    if decimal_sign() != "," or "." in text:
        return text
    for run in _RUN.findall(text):
        if run.strip(",").count(",") > 1:
            raise ValueError(run)
    return _COMMA.sub(".", text)


def looks_like_coordinates(text: str) -> bool:
    """Whether a text entered into one field holds several numbers, as pasted coordinates do."""
    try:
        return len(SEPARATORS.split(with_points(text.strip()))) >= _THREE
    except ValueError:
        return True
