"""What neighbouring tiles have in common: worked out once, by whichever thread comes first, and remembered."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import wraps
from typing import Any, Generic, TypeVar

Result = TypeVar("Result")


class _Place(Generic[Result]):
    """Where a result is, or will be: who holds the lock works it out."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.results: list[Result] = []


def shared(count: int) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Remember the last `count` results of a function of hashable arguments, as `lru_cache` does.

    Threads that ask for the same result at the same time wait for the one that works it out; with `lru_cache` each of
    them would.
    """

    def remember(function: Callable[..., Result]) -> Callable[..., Result]:
        places: OrderedDict[tuple[Hashable, ...], _Place[Result]] = OrderedDict()
        guard = threading.Lock()

        @wraps(function)
        def ask(*arguments: Any) -> Result:
            with guard:
                place = places.get(arguments)
                if place is None:
                    place = places[arguments] = _Place()
                    if len(places) > count:
                        places.popitem(last=False)
                else:
                    places.move_to_end(arguments)
            if not place.results:
                with place.lock:
                    if not place.results:
                        place.results.append(function(*arguments))
            return place.results[0]

        return ask

    return remember
