"""Units and plausibility of the times in trajectories and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput, Message


class Clock(NamedTuple):
    """A unit of time, in seconds and in words."""

    seconds: float
    words: Message


CLOCKS: Mapping[str, Clock] = {
    "s": Clock(1.0, Message("seconds")),
    "ms": Clock(1e-3, Message("milliseconds")),
    "us": Clock(1e-6, Message("microseconds")),
    "ns": Clock(1e-9, Message("nanoseconds")),
}


def is_dated(time_s: Floats) -> NDArray[np.bool_]:
    """Which times (n,), in seconds after 1970, lie from 1990 to 2099, and so can be dates."""
    return (time_s >= 631_152_000.0) & (time_s < 4_102_444_800.0)


def implausible(
    time_s: Sequence[float] | Floats, unit: Message | None = None, *, dated: bool = False
) -> Message | None:
    """Return why no flight can have these times (n,), in seconds after 1970 or after its start; None if one can.

    Times are implausible if they span less than a second, or lie neither within ten days of a start (a GPS week has
    seven) nor from 1990 to 2099.

    Parameters
    ----------
    unit : Message or None
        Unit in which the file's times were read; None if the file states dates.
    dated : bool
        Whether the times are known to count from 1970.
    """
    first, last = float(time_s[0]), float(time_s[-1])
    known = is_dated(np.asarray(time_s)).all()
    # In float64, seconds after 1970 are exact to about a microsecond.
    if len(time_s) > 1 and round(last - first, 6) < 1.0:
        wrong = Message("its {0:,} times are all within {1:.3g} s", len(time_s), last - first)
    elif not known and (dated or first < 0.0 or last > 10 * 86_400.0):
        wrong = Message("its times, as seconds from {0:.7g} to {1:.7g}, are not of 1990 to 2099", first, last)
    else:
        return None
    return wrong if unit is None else Message("{0}; they are probably not in {1}", wrong, unit)


def check_column(times_s: Sequence[float], where: str, *, dated: bool = False) -> None:
    """Check the times of a table, in seconds after 1970 (known to be so if ``dated``) or after a start.

    Raises
    ------
    InvalidInput
        Implausible times, see `implausible`; dates from 1990 to 2099 may span less than a second.
    """
    if not len(times_s) or is_dated(np.array(times_s)).all():
        return
    wrong = implausible(times_s, None if dated else CLOCKS["s"].words, dated=dated)
    if wrong is not None:
        raise InvalidInput("{0}: {1}", where, wrong, remedy="give seconds after 1970, or remove the column of times")
