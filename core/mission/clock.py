"""Clocks of trajectories and tables: which times a flight may have, and what is wrong where it cannot have them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..errors import InvalidInput, Message

#: Times count from a start for ten days at most (those of a GPS week for seven), or from 1970, and are of 1990 to 2099.
_LONGEST_S, _YEAR_1990_S, _YEAR_2100_S = 10 * 86_400.0, 631_152_000.0, 4_102_444_800.0
#: Flights are no shorter than this, s, to the decimals that seconds after 1970 have.
_SHORTEST_S, _DIGITS = 1.0, 6


class Clock(NamedTuple):
    """A unit of times, in seconds and in words."""

    seconds: float
    words: Message


CLOCKS: Mapping[str, Clock] = {
    "s": Clock(1.0, Message("seconds")),
    "ms": Clock(1e-3, Message("milliseconds")),
    "us": Clock(1e-6, Message("microseconds")),
    "ns": Clock(1e-9, Message("nanoseconds")),
}


def is_dated(time_s: Floats) -> NDArray[np.bool_]:
    """Which times (n,), in seconds after 1970, are of 1990 to 2099: those of a clock that knows the date."""
    return (time_s >= _YEAR_1990_S) & (time_s < _YEAR_2100_S)


def implausible(
    time_s: Sequence[float] | Floats, unit: Message | None = None, *, dated: bool = False
) -> Message | None:
    """What is wrong with times (n,), in seconds after 1970 or after a start, that no flight has; None where nothing is.

    Those are all within a second, or neither of a recording's first ten days nor of 1990 to 2099.

    Parameters
    ----------
    unit : Message or None
        That the times of the file are taken to be in; None where the file states dates.
    dated : bool
        Whether they count from 1970 for sure.
    """
    first, last = float(time_s[0]), float(time_s[-1])
    known = is_dated(np.asarray(time_s)).all()
    if len(time_s) > 1 and round(last - first, _DIGITS) < _SHORTEST_S:
        wrong = Message("its {0:,} times are all within {1:.3g} s", len(time_s), last - first)
    elif not known and (dated or first < 0.0 or last > _LONGEST_S):
        wrong = Message("its times, as seconds from {0:.7g} to {1:.7g}, are not of 1990 to 2099", first, last)
    else:
        return None
    return wrong if unit is None else Message("{0}; they are probably not in {1}", wrong, unit)


def check_column(times_s: Sequence[float], where: str, *, dated: bool = False) -> None:
    """Check the times of a table, which are seconds after 1970 or after a start, unless they are ``dated`` ones.

    Raises
    ------
    InvalidInput
        Times that no flight has; those of a short burst of images may have dates.
    """
    if not len(times_s) or is_dated(np.array(times_s)).all():
        return
    wrong = implausible(times_s, None if dated else CLOCKS["s"].words, dated=dated)
    if wrong is not None:
        raise InvalidInput("{0}: {1}", where, wrong, remedy="give seconds after 1970, or remove the column of times")
