"""Numbers in foreign text: plain ASCII digits only, where Python accepts more.

Imports nothing large, as the command needs this to parse its options.
"""

from __future__ import annotations

from .limits import MAX_JSON_DIGITS


def real_number(text: str) -> float:
    """Parse a number like ``float``, but refuse ``1_20`` and digits of other scripts.

    Raises ValueError in the words of ``float``.
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"could not convert string to float: {text!r}")
    return float(text)


def integer(text: str) -> int:
    """Parse a whole number like ``int``, of the digits that `real_number` accepts; raises ValueError likewise.

    Thousands of digits are refused: Python before 3.11 would take long to convert them.
    """
    if "_" in text or not text.isascii() or len(text) > MAX_JSON_DIGITS:
        raise ValueError(f"invalid literal for int() with base 10: {text!r}")
    return int(text)
