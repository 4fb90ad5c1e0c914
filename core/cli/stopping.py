"""Signals that ask the command to end: Ctrl-C, ``kill``, a terminal that is closed."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from ..external.native_calls import GRACE_S, ask_to_end, forget_signals, signals_asked
from .exits import exit_code

#: Windows has no SIGHUP.
_ASKING = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Interrupted(KeyboardInterrupt):
    """One of these signals, raised where the program is, as Ctrl-C is: what is under way is cleaned up.

    Parameters
    ----------
    number : int
        Of the signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.code = exit_code(number)


@contextmanager
def raised(received: list[int]) -> Iterator[None]:
    """Have signals raise Interrupted where they would end the process at once; they are put into a list at the end."""

    def receive(number: int, _frame: object) -> None:
        ask_to_end(number, 0.0)
        raise Interrupted(number)

    before = {number: signal.getsignal(number) for number in _ASKING}
    # Those that the caller has chosen to ignore, as nohup does, or to handle stay as they are.
    usual = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: handler for number, handler in before.items() if handler in usual}
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
def collected() -> Iterator[list[int]]:
    """Collect signals in a list instead of raising; each one's second raises as usual."""
    received: list[int] = []

    def receive(number: int, _frame: object) -> None:
        received.append(number)
        ask_to_end(number, GRACE_S)
        signal.signal(number, before[number])

    # One that the caller ignores, as nohup does, stays ignored; Ctrl-C is meant for whoever runs.
    heard = [n for n in _ASKING if n == signal.SIGINT or signal.getsignal(n) not in (signal.SIG_IGN, None)]
    before = {number: signal.signal(number, receive) for number in heard}
    try:
        yield received
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
