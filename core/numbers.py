"""Parsing of numbers in foreign text: only plain ASCII digits, whereas Python accepts more.

Keep imports small: the command needs this module to parse its options.
"""

from __future__ import annotations

from .limits import MAX_JSON_DIGITS

#: Pattern of a decimal number in a text.
NUMBER = r"-?[0-9]+(\.[0-9]*)?([eE][-+]?[0-9]+)?"


def real_number(text: str) -> float:
    """Parse a number like ``float``, but refuse ``1_20`` and digits of other scripts.

    Raises ValueError with the same message as ``float``.
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"could not convert string to float: {text!r}")
    return float(text)


def integer(text: str) -> int:
    """Parse a whole number like ``int``, with the restrictions and the ValueError of `real_number`.

    Numbers of thousands of digits are refused: Python before 3.11 converts them slowly.
    """
    if "_" in text or not text.isascii() or len(text) > MAX_JSON_DIGITS:
        raise ValueError(f"invalid literal for int() with base 10: {text!r}")
    return int(text)
