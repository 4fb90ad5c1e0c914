"""A plan as a table: CSV."""

from __future__ import annotations

from collections.abc import Iterator

from ..plan import Plan
from .rows import COLUMNS, batches


def csv_text(plan: Plan) -> Iterator[str]:
    """Text of the table, in blocks."""
    yield ",".join(COLUMNS) + "\n"
    for batch in batches(plan):
        rows = zip(*(batch[name] for name in COLUMNS))
        # Text of a float is its shortest exact form: all its digits.
        yield "".join(",".join(map(str, row)) + "\n" for row in rows)
