"""Numbers, aspect ratios and degrees as people type and read them."""

from __future__ import annotations

import math
import re
from fractions import Fraction

from ..i18n import decimal_sign, localized, plain_number

_TWO, _THREE = 2, 3
#: Separators of pasted coordinates.
SEPARATORS = re.compile(r"[_,;\s]+")
#: Text between separators other than commas.
_RUN = re.compile(r"[^_;\s]+")
#: A number with decimal comma or point.
_DECIMAL = re.compile(r"([-+\u2212]?\d*)[.,](\d+)")
#: An integer in an aspect ratio.
_DIGITS = re.compile(r"\d{1,15}")
#: A number with or without decimals.
_NUMBER = re.compile(r"[-+\u2212]?\d+(\.\d*)?")
#: A comma between digits.
_COMMA = re.compile(r"(?<=\d),(?=\d)")
#: Letters of the hemispheres of latitudes and longitudes.
LATITUDE, LONGITUDE = "NS", "EW"
_LETTERS = LATITUDE + LONGITUDE + (LATITUDE + LONGITUDE).lower()
#: Degrees, minutes and optional seconds, separated by their signs or spaces. All repetitions are bounded, so that
#: matching a long text takes linear time.
_SEXAGESIMAL = (
    r"(?P<degrees>\d{1,3})(?:\s?[°º]\s?|\s)(?P<minutes>\d{1,2}(?:[.,]\d{0,20})?)"
    r"(?:(?:\s?['′’]\s?|\s)(?P<seconds>\d{1,2}(?:[.,]\d{0,20})?)\s?(?:[\"″”]|''|′′)?|\s?['′’])?"
)
_ANGLE = re.compile(rf"(?P<sign>[-+]?){_SEXAGESIMAL}")
#: Such an angle followed by a hemisphere's letter, as other programs write places.
_LETTERED = re.compile(rf"(?<![\w.,])(?P<sign>){_SEXAGESIMAL}\s?(?P<letter>[NSEWnsew])\b")
_FULL_MINUTES = 60.0


def parse_number(text: str) -> float:
    """Read degrees as people type them: `plain_number`, with an optional degree sign or hemisphere's letter.

    Raises
    ------
    ValueError
        The text is not a number.
    """
    plain = text.strip()
    sign = 1.0
    if plain and plain[-1].upper() in LATITUDE + LONGITUDE:
        sign = -1.0 if plain[-1].upper() in "SW" else 1.0
        plain = plain[:-1].rstrip()
    return sign * plain_number(plain.rstrip("°"))


def parse_degrees(text: str, letters: str) -> float:
    """Read a latitude or a longitude: a number, or degrees, minutes and seconds, as ``47 01 30 N`` or ``-8°30'15"``.

    Parameters
    ----------
    letters : str
        `LATITUDE` or `LONGITUDE`: letters allowed before or after the number, in place of a sign.

    Raises
    ------
    ValueError
        The text is not an angle in one of these forms, or has the letter of the other axis.
    """
    plain = text.strip().replace("\u2212", "-")
    letter = next((end for end in (plain[:1], plain[-1:]) if end and end.upper() in letters), "")
    if letter:
        plain = (plain[1:] if plain.startswith(letter) else plain[:-1]).strip()
        if not plain[:1].isdecimal():
            # Refuse a sign together with a letter: they may contradict each other.
            raise ValueError(text)
    found = _ANGLE.fullmatch(" ".join(plain.split()))
    if not found and plain[-1:].isalpha():
        # This includes a letter of the other axis.
        raise ValueError(text)
    value = _angle_deg(found) if found else parse_number(plain)
    return -value if letter and letter.upper() in "SW" else value


def parse_place(text: str) -> tuple[float, float]:
    """Read a latitude and longitude from a text; raises ValueError unless there is exactly one way to read it."""
    plain = to_decimal_points(text.strip().strip(",;"))
    # No place that people write is longer.
    if len(plain) > 100:
        raise ValueError(text)
    halves = ((plain[: one.start()], plain[one.end() :]) for one in SEPARATORS.finditer(plain))
    places = {place for place in (_place(*half) for half in halves) if place is not None}
    if len(places) != 1:
        raise ValueError(text)
    return places.pop()


def _place(lat: str, lon: str) -> tuple[float, float] | None:
    try:
        return parse_degrees(lat, LATITUDE), parse_degrees(lon, LONGITUDE)
    except ValueError:
        return None


def has_minutes(text: str) -> bool:
    """Whether a text has the form of one angle in degrees and minutes, though these may be 60 or more."""
    plain = " ".join(text.replace("\u2212", "-").split())
    return _ANGLE.fullmatch(plain.strip(_LETTERS).strip()) is not None


def to_decimal_degrees(text: str) -> str:
    """Text with places such as ``47°01'30"N 8°30'15"E`` converted to decimal degrees.

    Raises
    ------
    ValueError
        A longitude precedes its latitude, or minutes or seconds reach 60.
    """
    found = list(_LETTERED.finditer(text))
    for number, one in enumerate(found):
        if one["letter"].upper() not in (LATITUDE, LONGITUDE)[number % 2]:
            raise ValueError(one[0])
    return _LETTERED.sub(_decimal_text, text)


def _decimal_text(found: re.Match[str]) -> str:
    sign = "-" if found["letter"].upper() in "SW" else ""
    return f"{sign}{_angle_deg(found)!r} "


def _angle_deg(found: re.Match[str]) -> float:
    """Degrees of an angle in degrees, minutes and seconds; raises ValueError if minutes or seconds reach 60."""
    minutes, seconds = found["minutes"], found["seconds"]
    parts = plain_number(minutes), plain_number(seconds or "0")
    # Only the last of minutes and seconds may have decimals.
    if max(parts) >= _FULL_MINUTES or (seconds is not None and not minutes.isdecimal()):
        raise ValueError(found[0])
    value = float(found["degrees"]) + (parts[0] + parts[1] / _FULL_MINUTES) / _FULL_MINUTES
    return -value if found["sign"] == "-" else value


def parse_aspect(text: str) -> float:
    """Width over height from ``4:3``, ``4/3``, ``4000x3000`` or ``1.333``; raises ValueError otherwise."""
    for separator in (":", "/", "x", "×"):
        if separator in text:
            width, height = (plain_number(part) for part in text.split(separator, 1))
            if height == 0.0:
                raise ValueError(text)
            return width / height
    return plain_number(text)


def aspect_text(ratio: float) -> str:
    """Shortest text that `parse_aspect` reads as ``ratio``."""
    if not (math.isfinite(ratio) and ratio > 0.0):
        return repr(ratio)
    fraction = Fraction(ratio).limit_denominator(10_000)
    if fraction.denominator and fraction.numerator / fraction.denominator == ratio:
        return f"{fraction.numerator}:{fraction.denominator}"
    return repr(ratio)


def degrees_text(value: float, decimals: int = 7) -> str:
    """Degrees without trailing zeros; 7 decimals correspond to a centimetre on the ground."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text


def exact_degrees_text(value: float) -> str:
    """Degrees as a text that reads back as the same number."""
    text = degrees_text(value)
    return text if float(text) == value else repr(value)


def short_degrees(text: str) -> str:
    """Text of degrees with the user's decimal sign, rounded to 7 decimals (a centimetre)."""
    plain = to_decimal_point(text)
    _, _, decimals = plain.partition(".")
    if len(decimals) > 7 and _DECIMAL.fullmatch(plain):
        plain = degrees_text(float(plain))
    return as_written(plain)


def short_place(text: str) -> str:
    """Text of a latitude and a longitude, each as from `short_degrees`; other text unchanged."""
    parts = SEPARATORS.split(text.strip()) if "." in text else ()
    if len(parts) != _TWO or not all(map(_NUMBER.fullmatch, parts)):
        return text
    return ("; " if decimal_sign() == "," else ", ").join(map(short_degrees, parts))


def short_aspect(text: str) -> str:
    """Text of an aspect ratio with the user's decimal sign; a quotient of measurements is rounded to four digits."""
    first, colon, second = text.partition(":")
    if colon and _DIGITS.fullmatch(first) and _DIGITS.fullmatch(second):
        fraction = Fraction(int(first), int(second) or 1)
        written = (fraction.numerator, fraction.denominator) == (int(first), int(second))
        # Common ratios (4:3, 16:9, 3000:2000) reduce to small integers; others are quotients of measurements.
        long = written and fraction.denominator > 100
        return as_written(f"{float(fraction):.4g}") if long else text
    plain = to_decimal_point(text)
    _, point, decimals = plain.partition(".")
    if point and len(decimals) > 4 and _DECIMAL.fullmatch(plain):
        plain = f"{float(plain):.4g}"
    return as_written(plain)


def to_decimal_point(text: str) -> str:
    """Text of a number with a point in place of the user's decimal sign; other text unchanged."""
    plain = text.strip().replace("\u2212", "-").replace(decimal_sign(), ".")
    found = _DECIMAL.fullmatch(plain)
    return f"{found[1]}.{found[2]}" if found else text


def as_written(text: str) -> str:
    """Text of a number with the user's decimal sign in place of a point; other text unchanged."""
    return localized(text) if _DECIMAL.fullmatch(text) and "." in text else text


def to_decimal_points(text: str) -> str:
    """Text of numbers with decimal commas replaced by points.

    Commas between digits are replaced if the text has no point, and spaces, semicolons or underscores separate the
    numbers: ``35,14 -89,9`` and ``35,14, -89,9`` are two numbers, and ``35,14`` is one.

    Raises
    ------
    ValueError
        The commas are ambiguous: ``35,14,-89,9``.
    """
    if "." in text:
        return text
    for run in _RUN.findall(text):
        if run.strip(",").count(",") > 1:
            raise ValueError(run)
    return _COMMA.sub(".", text)


def looks_like_coordinates(text: str) -> bool:
    """Whether a text in one field consists of several numbers, as pasted coordinates do, and is not one angle."""
    if has_minutes(text):
        return False
    if len(_LETTERED.findall(text)) > 1:
        return True
    try:
        return len(SEPARATORS.split(to_decimal_points(text.strip()))) >= _THREE
    except ValueError:
        return True


def inserted(before: str, now: str) -> int:
    """Number of characters inserted by the edit from ``before`` to ``now``."""
    most = min(len(before), len(now))
    begin = next((at for at in range(most) if before[at] != now[at]), most)
    end = next((at for at in range(most - begin) if before[-1 - at] != now[-1 - at]), most - begin)
    return len(now) - begin - end
