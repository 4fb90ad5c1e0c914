"""Whole numbers and ranges of them as text, such as ``3,7-9``."""

from __future__ import annotations

import re
from collections.abc import Iterable

#: First and last number of ranges, in order and apart from each other.
Ranges = tuple[tuple[int, int], ...]
#: Text of numbers and ranges; empty for none.
RANGES = r"([0-9]{1,9}(-[0-9]{1,9})?(,[0-9]{1,9}(-[0-9]{1,9})?)*)?"


def read_ranges(text: str) -> Ranges:
    """Read numbers and ranges, in any order and with spaces; raises ValueError."""
    plain = re.sub(r"\s*([,-])\s*", r"\1", text.strip())
    if not re.fullmatch(RANGES, plain, re.ASCII):
        raise ValueError(text)
    pairs = [part.split("-") for part in plain.split(",") if part]
    found = [(int(ends[0]), int(ends[-1])) for ends in pairs]
    if any(first > last for first, last in found):
        raise ValueError(text)
    return merged(found)


def merged(ranges: Iterable[tuple[int, int]]) -> Ranges:
    """Ranges in order, with those that touch each other joined."""
    found: list[tuple[int, int]] = []
    for first, last in sorted(ranges):
        if found and first <= found[-1][1] + 1:
            found[-1] = found[-1][0], max(found[-1][1], last)
        else:
            found.append((first, last))
    return tuple(found)


def ranges_text(ranges: Iterable[tuple[int, int]]) -> str:
    """Text that `read_ranges` reads; the same for equal sets of numbers."""
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in merged(ranges))


def count(ranges: Iterable[tuple[int, int]]) -> int:
    """Count the numbers in ranges that are apart from each other."""
    return sum(last - first + 1 for first, last in ranges)


def toggled(text: str, numbers: Iterable[int]) -> str:
    """Text of ranges with some numbers taken out if all of them are in it, and added otherwise."""
    asked, ranges = sorted(set(numbers)), read_ranges(text)
    held = {one for one in asked if any(first <= one <= last for first, last in ranges)}
    if len(held) < len(asked):
        return ranges_text([*ranges, *((one, one) for one in asked)])
    kept: list[tuple[int, int]] = list(ranges)
    for one in asked:
        kept = [part for first, last in kept for part in _without(first, last, one)]
    return ranges_text(kept)


def _without(first: int, last: int, one: int) -> list[tuple[int, int]]:
    """Ranges that are left of one without a number."""
    if not first <= one <= last:
        return [(first, last)]
    return [(low, high) for low, high in ((first, one - 1), (one + 1, last)) if low <= high]
