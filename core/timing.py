"""Measured durations: processor time of the calling thread, in rounds that run all compared functions in turn."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import NamedTuple, TypeVar

import numpy as np

Result = TypeVar("Result")
Clock = Callable[[], float]


class Effort(NamedTuple):
    """Least and greatest number of rounds; after the least, timing stops once each function has run for ``seconds``.

    After ``most_s`` in all, timing stops even before the least, but not before the first round has ended.
    """

    least: int
    most: int
    seconds: float
    most_s: float = math.inf


#: Functions of half a second and more run for few rounds, as users wait for the report.
THOROUGH = Effort(7, 25, 0.25, 12.0)
#: Seed of the order in which functions take turns.
ORDER_SEED = 1
#: One run after the warm-up, if the time does not matter.
QUICK = Effort(1, 1, 0.0)


class Quartiles(NamedTuple):
    """Lower quartile, median and upper quartile."""

    low: float
    median: float
    high: float

    @classmethod
    def from_values(cls, values: Sequence[float]) -> Quartiles:
        """Compute the quartiles of one value or more."""
        return cls(*np.quantile(values, (0.25, 0.5, 0.75)).tolist())


@dataclass(frozen=True)
class Seconds:
    """Seconds that a function took in each round; functions timed together share rounds."""

    rounds: tuple[float, ...]

    @property
    def quartiles(self) -> Quartiles:
        """Quartiles over the rounds."""
        return Quartiles.from_values(self.rounds)

    @property
    def median(self) -> float:
        """Median over the rounds."""
        return float(np.median(self.rounds))

    @property
    def spread_known(self) -> bool:
        """Whether there are enough rounds for quartiles to mean something."""
        return len(self.rounds) >= 5

    def __add__(self, other: Seconds) -> Seconds:
        """Add round by round."""
        return Seconds(tuple(own + more for own, more in zip(self.rounds, other.rounds)))

    def __sub__(self, other: Seconds) -> Seconds:
        """Subtract round by round."""
        return self + other * -1.0

    def __mul__(self, factor: float) -> Seconds:
        """Scale the seconds of every round."""
        return Seconds(tuple(taken * factor for taken in self.rounds))

    def ratio(self, other: Seconds) -> Quartiles:
        """Quartiles of the ratio of these seconds to others, computed round by round."""
        return Quartiles.from_values([own / its for own, its in zip(self.rounds, other.rounds)])

    def is_distinct(self, other: Seconds) -> bool:
        """Whether one takes longer than the other with significance.

        The quartiles of the ratio must lie on one side of 1, and a two-sided sign test over the rounds must reject
        equal durations at 5 %.
        """
        low, _, high = self.ratio(other)
        longer = sum(own > its for own, its in zip(self.rounds, other.rounds))
        agreed, count = max(longer, len(self.rounds) - longer), len(self.rounds)
        chance = 2.0 * sum(math.comb(count, some) for some in range(agreed, count + 1)) / 2.0**count
        return chance <= 0.05 and not low <= 1.0 <= high


def timed(work: Callable[[], Result], effort: Effort = THOROUGH) -> tuple[Result, Seconds]:
    """Run a function repeatedly; return its result and the seconds that it takes."""
    return timed_together([work], effort)[0]


def timed_together(
    works: Sequence[Callable[[], Result]], effort: Effort = THOROUGH, clock: Clock = time.thread_time
) -> list[tuple[Result, Seconds]]:
    """Time functions in turn, so that other load on the machine affects all alike.

    Parameters
    ----------
    clock : callable
        Returns seconds, in steps of any size. The default counts the processor time of the calling thread only:
        functions that use other threads or processes need another clock.
    """
    # Repeat short functions so that a step of the clock is at most 1 % of a run.
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
    spent, rounds, order = 0.0, 0, np.random.Generator(np.random.PCG64(ORDER_SEED))
    enough_s = effort.seconds * len(works)
    while rounds < 1 or (
        spent < effort.most_s and (rounds < effort.least or (rounds < effort.most and spent < enough_s))
    ):
        # Use a random order, so that no function always follows another that fills the processor's cache.
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
    """Measure the resolution of a clock in seconds; some systems report too fine a resolution."""
    steps = []
    for _ in range(5):
        start = now = clock()
        while now == start:
            now = clock()
        steps.append(now - start)
    return float(np.median(steps))
