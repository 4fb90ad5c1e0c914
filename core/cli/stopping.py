"""Signals that end the command: Ctrl-C, ``kill``, a closed terminal."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from ..external.native_calls import GRACE_S, ask_to_end, forget_signals, signals_asked
from .exits import exit_code

#: Windows has no SIGHUP.
_SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Interrupted(KeyboardInterrupt):
    """Raised by a signal that ends the command, so that the command cleans up as after Ctrl-C.

    Parameters
    ----------
    number : int
        Number of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.code = exit_code(number)


@contextmanager
def raise_signals(received: list[int]) -> Iterator[None]:
    """Raise Interrupted on signals that would end the process; at the end, append received signals to the list."""

    def receive(number: int, _frame: object) -> None:
        ask_to_end(number, 0.0)
        raise Interrupted(number)

    before = {number: signal.getsignal(number) for number in _SIGNALS}
    # Leave signals that the caller handles, or ignores as under nohup, unchanged.
    defaults = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: handler for number, handler in before.items() if handler in defaults}
    if threading.current_thread() is not threading.main_thread():
        before = {}
    for number in before:
        signal.signal(number, receive)
    try:
        yield
    finally:
        received += signals_asked()
        forget_signals()
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def collect_signals() -> Iterator[list[int]]:
    """Collect signals in a list instead of raising; a second signal of the same kind raises as usual."""
    received: list[int] = []

    def receive(number: int, _frame: object) -> None:
        received.append(number)
        ask_to_end(number, GRACE_S)
        signal.signal(number, before[number])

    # Signals that the caller ignores, as under nohup, stay ignored, except Ctrl-C.
    collected = [n for n in _SIGNALS if n == signal.SIGINT or signal.getsignal(n) not in (signal.SIG_IGN, None)]
    before = {number: signal.signal(number, receive) for number in collected}
    try:
        yield received
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
