"""Seconds that work takes, as work-precision diagrams want them: a warm-up, then the median of repeated runs."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeVar

Result = TypeVar("Result")


class Effort(NamedTuple):
    """How often work is repeated: at least and at most so many runs, and between the two until so many seconds."""

    least: int
    most: int
    seconds: float


#: Work of half a second and more is not repeated often: a report must end while someone waits for it.
THOROUGH = Effort(2, 25, 0.25)
#: One run after the warm-up: for trying things out, and where a time is not what is asked for.
QUICK = Effort(1, 1, 0.0)


def timed(work: Callable[[], Result], effort: Effort = THOROUGH) -> tuple[Result, float]:
    """What some work returns, and the median of the seconds that its runs take after one to warm up."""
    return timed_together([work], effort)[0]


def timed_together(
    works: Sequence[Callable[[], Result]], effort: Effort = THOROUGH
) -> list[tuple[Result, float]]:
    """As `timed`, of works that are compared: they take turns, so that what else the machine does falls on all."""
    results = [work() for work in works]
    times: list[list[float]] = [[] for _ in works]
    spent, rounds = 0.0, 0
    while rounds < effort.least or (rounds < effort.most and spent < effort.seconds * len(works)):
        # There and back, so that none always follows one that has filled the processor's cache.
        for work, taken in list(zip(works, times))[:: -1 if rounds % 2 else 1]:
            start = time.perf_counter()
            work()
            taken.append(time.perf_counter() - start)
            spent += taken[-1]
        rounds += 1
    return [(result, statistics.median(taken)) for result, taken in zip(results, times)]
