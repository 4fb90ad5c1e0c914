"""Numbers in text that others wrote: of plain digits alone, where Python reads more.

Nothing else of size is imported: the command needs this before its options are known.
"""

from __future__ import annotations

from .limits import MAX_JSON_DIGITS


def real_number(text: str) -> float:
    """Number as ``float`` reads it, but of the digits 0 to 9 alone: ``1_20`` and digits of other scripts are none.

    Raises ValueError of any other text, in the words of ``float``.
    """
    if "_" in text or not text.isascii():
        raise ValueError(f"could not convert string to float: {text!r}")
    return float(text)


def integer(text: str) -> int:
    """Whole number as ``int`` reads it, of the digits that `real_number` reads; raises ValueError as that does.

    Of thousands of digits there is none: Python refuses them, or takes long before 3.11.
    """
    if "_" in text or not text.isascii() or len(text) > MAX_JSON_DIGITS:
        raise ValueError(f"invalid literal for int() with base 10: {text!r}")
    return int(text)
