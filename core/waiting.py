"""Waits and long preparations that Ctrl-C and the caller can end, and that report what they do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TYPE_CHECKING, Any, Callable

from .errors import Cancelled

if TYPE_CHECKING:
    from concurrent.futures import Future

    from .errors import Message

_cancelled: ContextVar[Callable[[], bool] | None] = ContextVar("cancelled", default=None)
_report: ContextVar[Callable[[Message], object] | None] = ContextVar("report", default=None)


@contextmanager
def cancellable(cancelled: Callable[[], bool] | None) -> Iterator[None]:
    """Make waits of this thread raise Cancelled as soon as ``cancelled()`` is true."""
    token = _cancelled.set(cancelled)
    try:
        yield
    finally:
        _cancelled.reset(token)


def check_cancelled() -> None:
    """Raise Cancelled if the enclosing `cancellable` is cancelled."""
    cancelled = _cancelled.get()
    if cancelled is not None and cancelled():
        raise Cancelled("stopped")


@contextmanager
def reporting(report: Callable[[Message], object] | None) -> Iterator[None]:
    """Pass texts on the progress of this thread's long preparations, such as indexing a file, to ``report``."""
    token = _report.set(report)
    try:
        yield
    finally:
        _report.reset(token)


def report_progress(text: Message) -> None:
    """Pass a text to the enclosing `reporting`; raise Cancelled if the enclosing `cancellable` is cancelled."""
    check_cancelled()
    report = _report.get()
    if report is not None:
        report(text)


def wait_until_done(future: Future[Any], look: Callable[[], object]) -> None:
    """Wait until a future is done.

    Parameters
    ----------
    look : callable
        Called repeatedly; its exceptions end the wait.

    Raises
    ------
    Cancelled
        The enclosing `cancellable` is cancelled.
    """
    from concurrent.futures import wait

    # Use short waits, as Windows handles Ctrl-C only between waits.
    while not wait([future], 0.1).done:
        check_cancelled()
        look()
