"""Seconds that work takes: processor time of its own thread, in rounds in which what is compared takes turns."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import NamedTuple, TypeVar

import numpy as np

Result = TypeVar("Result")
Clock = Callable[[], float]

#: How likely equal works may be to agree in so many rounds, as if by the toss of a coin.
_CHANCE = 0.05


class Effort(NamedTuple):
    """How many rounds there are: at least and at most, and between the two until every work has had so many seconds."""

    least: int
    most: int
    seconds: float


#: Work of half a second and more is not repeated often: a report must end while someone waits for it.
THOROUGH = Effort(7, 25, 0.25)
#: One run after the warm-up: for trying things out, and where a time is not what is asked for.
QUICK = Effort(1, 1, 0.0)


class Quartiles(NamedTuple):
    """Lower quartile, median and upper quartile."""

    low: float
    median: float
    high: float

    @classmethod
    def from_values(cls, values: Sequence[float]) -> Quartiles:
        """Quartiles of one value or more."""
        return cls(*np.quantile(values, (0.25, 0.5, 0.75)).tolist())


@dataclass(frozen=True)
class Seconds:
    """Seconds that some work took in each of the rounds; those of one round belong together, of works in turns."""

    rounds: tuple[float, ...]

    @property
    def quartiles(self) -> Quartiles:
        """Of the rounds."""
        return Quartiles.from_values(self.rounds)

    @property
    def median(self) -> float:
        """Of the rounds."""
        return statistics.median(self.rounds)

    @property
    def spread_known(self) -> bool:
        """Whether there are rounds enough for quartiles to say something."""
        # Quartiles of fewer rounds mean nothing.
        return len(self.rounds) >= 5

    def __add__(self, other: Seconds) -> Seconds:
        """Round by round."""
        return Seconds(tuple(own + more for own, more in zip(self.rounds, other.rounds)))

    def __sub__(self, other: Seconds) -> Seconds:
        """Round by round."""
        return self + other * -1.0

    def __mul__(self, factor: float) -> Seconds:
        """Of so many times the work."""
        return Seconds(tuple(taken * factor for taken in self.rounds))

    def ratio(self, other: Seconds) -> Quartiles:
        """How many times as long as other work this one takes: quartiles of the ratios within each round."""
        return Quartiles.from_values([own / its for own, its in zip(self.rounds, other.rounds)])

    def is_distinct(self, other: Seconds) -> bool:
        """Whether one can be said to take longer than the other.

        It cannot where the quartiles of their ratio lie on either side of 1, nor where equal works would agree in as
        many rounds by chance (`_CHANCE`), as they often do in a few.
        """
        low, _, high = self.ratio(other)
        longer = sum(own > its for own, its in zip(self.rounds, other.rounds))
        agreed, count = max(longer, len(self.rounds) - longer), len(self.rounds)
        chance = 2.0 * sum(math.comb(count, some) for some in range(agreed, count + 1)) / 2.0**count
        return chance <= _CHANCE and not low <= 1.0 <= high


def timed(work: Callable[[], Result], effort: Effort = THOROUGH) -> tuple[Result, Seconds]:
    """What some work returns, and the seconds that it takes."""
    return timed_together([work], effort)[0]


def timed_together(
    works: Sequence[Callable[[], Result]], effort: Effort = THOROUGH, clock: Clock = time.thread_time
) -> list[tuple[Result, Seconds]]:
    """As `timed`, of works that are compared: they take turns, so that what else the machine does falls on all.

    Parameters
    ----------
    clock : callable
        Of seconds, however coarse. The default counts what the calling thread computes, and neither its waiting nor
        other threads and processes: work that is shared with those needs another.
    """
    # Short work is repeated, so that a step of the clock is at most 1 % of a run.
    least_s = 100 * clock_step_s(clock)
    results, counts = [], []
    for work in works:
        start = clock()
        results.append(work())
        # A first run with a cold cache may take ten times as long as the next.
        taken, count = (clock() - start) / 10.0, 1
        while taken < least_s:
            taken = _run(work, count, clock)
            count *= 1 if taken >= least_s else 2
        counts.append(count)
    times: list[list[float]] = [[] for _ in works]
    spent, rounds, order = 0.0, 0, np.random.Generator(np.random.PCG64(1))
    while rounds < effort.least or (rounds < effort.most and spent < effort.seconds * len(works)):
        # In any order, so that none always follows one that has filled the processor's cache.
        for index in order.permutation(len(works)).tolist():
            taken = _run(works[index], counts[index], clock)
            times[index].append(taken / counts[index])
            spent += taken
        rounds += 1
    return [(result, Seconds(tuple(taken))) for result, taken in zip(results, times)]


def _run(work: Callable[[], object], count: int, clock: Clock) -> float:
    start = clock()
    for _ in repeat(None, count):
        work()
    return clock() - start


def clock_step_s(clock: Clock = time.thread_time) -> float:
    """Seconds between the values that a clock takes: what it says of itself is too fine on some systems."""
    steps = []
    for _ in range(5):
        start = now = clock()
        while now == start:
            now = clock()
        steps.append(now - start)
    return statistics.median(steps)
