"""Waiting for what runs in another thread, so that Ctrl-C and whoever asked for it can end the wait."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future, wait
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, Callable

from .errors import Cancelled

_POLL_S = 0.1
_cancelled: ContextVar[Callable[[], bool] | None] = ContextVar("cancelled", default=None)


@contextmanager
def cancellable(cancelled: Callable[[], bool] | None) -> Iterator[None]:
    """Have what this thread waits for meanwhile raise Cancelled where ``cancelled`` says so."""
    token = _cancelled.set(cancelled)
    try:
        yield
    finally:
        _cancelled.reset(token)


def check_cancelled() -> None:
    """Raise Cancelled where the wait is to end."""
    cancelled = _cancelled.get()
    if cancelled is not None and cancelled():
        raise Cancelled("stopped")


def wait_until_done(future: Future[Any], look: Callable[[], object]) -> None:
    """Wait until a future is done.

    Parameters
    ----------
    look : callable
        Called again and again; what it raises ends the wait.

    Raises
    ------
    Cancelled
        As `cancellable` has it.
    """
    # Briefly at a time: on Windows Ctrl-C is heard in between.
    while not wait([future], _POLL_S).done:
        check_cancelled()
        look()
