"""Text of others, as it may be shown and written."""

from __future__ import annotations

#: What begins a formula in the programs that tables are opened with.
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


def printable(text: str) -> str:
    """Text in one line, without what controls a terminal or turns the direction of writing."""
    return text if text.isprintable() else "".join(one if one.isprintable() else " " for one in text)


def table_cell(text: str) -> str:
    """Text for a table, which no program takes for a formula: an apostrophe stands before one."""
    plain = printable(text)
    return f"'{plain}" if text.startswith(_FORMULA) else plain
