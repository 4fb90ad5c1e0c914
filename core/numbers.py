"""Numbers in text that others wrote: of plain digits alone, where Python reads more.

Nothing else is imported: the command needs this before its options are known.
"""

from __future__ import annotations


def real_number(text: str) -> float:
    """Number as ``float`` reads it, but of the digits 0 to 9 alone: ``1_20`` and digits of other scripts are none.

    Raises ValueError of any other text, in the words of ``float``.
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"could not convert string to float: {text!r}")
    return float(text)


def integer(text: str) -> int:
    """Whole number as ``int`` reads it, of the digits that `real_number` reads; raises ValueError as that does."""
    if "_" in text or not text.isascii():
        raise ValueError(f"invalid literal for int() with base 10: {text!r}")
    return int(text)
