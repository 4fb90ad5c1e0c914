"""Dates a source's imagery can be had of, and how its URLs write them."""

from __future__ import annotations

import bisect
import datetime as dt
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from ...errors import InvalidInput

KINDS = ("day", "year", "listed", "any")
#: Dates that an error names; `terrainav sources show` names more.
_NAMED = 6
_FORMS = {"day": "YYYY-MM-DD", "year": "YYYY"}
#: Steps of a time dimension (ISO 8601) that are a day or a year.
_STEPS = {"P1D": "day", "P1Y": "year"}


@dataclass(frozen=True)
class Dates:
    """Dates a source's imagery can be had of.

    Parameters
    ----------
    kind : str
        ``day`` or ``year``: any of them, as YYYY-MM-DD or YYYY; ``listed``: those of ``values``; ``any``: whatever
        the server takes.
    first, last : str
        Empty where they are not known, or go on.
    default : str
        What is taken where nothing is asked for. Empty, for ``any`` alone: a date must be asked for.
    values : mapping
        Of ``listed``: date to what stands for it in the URL.
    """

    kind: str
    first: str = ""
    default: str = ""
    last: str = ""
    values: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InvalidInput(f"dates of kind {self.kind!r}: must be one of {', '.join(KINDS)}")
        if (self.kind == "listed") != bool(self.values):
            raise InvalidInput(f"dates of kind {self.kind!r}: values are for listed ones, which need them")
        if not all(isinstance(text, str) for pair in self.values.items() for text in pair):
            raise InvalidInput(f"dates of kind {self.kind!r}: values must be text")
        if self.kind == "listed":
            object.__setattr__(self, "first", min(self.values))
            object.__setattr__(self, "last", max(self.values))
        if self.default or self.kind != "any":
            self.checked(self.default)

    def checked(self, date: str) -> str:
        """Return ``date``, refused where it is of another form, out of range or not among those there are."""
        if self.kind == "listed":
            if date not in self.values:
                raise InvalidInput(
                    f"date {date!r}: must be one of those there are, such as {self._near(date)}"
                )
        elif self.kind == "any":
            if not date or not date.isprintable():
                raise InvalidInput(f"date {date!r}: must be one the server takes; say which (--date)")
        elif not self._in_range(date):
            raise InvalidInput(
                f"date {date!r}: must be {_FORMS[self.kind]}, from {self.first} to {self.last or 'now'}"
            )
        return date

    def written(self, date: str) -> str:
        """Return what stands for a date in the URL."""
        return self.values.get(date, date)

    def text(self) -> str:
        """Words for people."""
        default = f"{self.default} by default" if self.default else "one must be asked for"
        if self.kind == "listed":
            if len(self.values) <= _NAMED:
                return f"{', '.join(sorted(self.values))}; {default}"
            return f"{len(self.values)} from {self.first} to {self.last}; {default}"
        span = f" from {self.first} to {self.last or 'now'}" if self.first else ""
        form = {"day": "every day", "year": "every year", "any": "as the server takes them"}[self.kind]
        return f"{form}{span}; {default}"

    def _in_range(self, date: str) -> bool:
        try:
            dt.date.fromisoformat(date if self.kind == "day" else f"{date}-01-01")
        except ValueError:
            return False
        return len(date) == len(_FORMS[self.kind]) and self.first <= date <= (self.last or _now())

    def _near(self, date: str) -> str:
        ordered = sorted(self.values)
        at = bisect.bisect(ordered, date)
        start = max(0, min(at - _NAMED // 2, len(ordered) - _NAMED))
        return ", ".join(ordered[start : start + _NAMED])


def _now() -> str:
    """Latest day it is anywhere on Earth."""
    return (dt.datetime.now(dt.timezone.utc) + dt.timedelta(hours=14)).date().isoformat()


def dates_of_dimension(values: Iterable[str], default: str) -> Dates | None:
    """Dates of the time dimension of a WMS or WMTS layer.

    Parameters
    ----------
    values : iterable of str
        Single times, and intervals written ``first/last/step``.
    default : str
        Empty where the server names none.
    """
    times = [value.strip() for value in values if value.strip()]
    default = default.strip()
    intervals = [time.split("/") for time in times if "/" in time]
    if not times:
        return Dates("any", default=default) if default else None
    if not intervals:
        listed = {time: time for time in (*times, default) if time}
        return Dates("listed", default=default or max(times), values=listed)
    first, last = min(ends[0] for ends in intervals), max(ends[1] for ends in intervals)
    kinds = {_STEPS.get(ends[2] if len(ends) == 3 else "") for ends in intervals}
    kind = kinds.pop() if len(kinds) == 1 and len(intervals) == len(times) else None
    pattern = {"day": r"\d{4}-\d\d-\d\d", "year": r"\d{4}"}.get(kind or "", "(?!)")
    if (
        kind
        and re.fullmatch(f"{pattern} {pattern}", f"{first} {last}")
        and first <= (default or last) <= last
    ):
        return Dates(kind, first, default or last, last)
    return Dates("any", first, default, last)
