"""What the command prints to: terminals and files whose encoding may have no word for a name."""

from __future__ import annotations

import io
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

#: Seconds without a result after which the command says that it is at work, and from then on every so many.
QUIET_S, AGAIN_S = 10.0, 60.0


@contextmanager
def busy_notice() -> Iterator[None]:
    """Say in a terminal that the command is at work, where what is done inside takes long and prints nothing."""
    if sys.stderr is None or not sys.stderr.isatty():
        yield
        return
    ended = threading.Event()
    notices = threading.Thread(target=_print_notices, args=(ended,), daemon=True)
    notices.start()
    try:
        yield
    finally:
        ended.set()


def _print_notices(ended: threading.Event) -> None:
    began_s, wait_s = time.monotonic(), QUIET_S
    while not ended.wait(wait_s):
        wait_s = AGAIN_S
        took_s = time.monotonic() - began_s
        print(f"terrainav: at work for {took_s:.0f} s; Ctrl-C ends it", file=sys.stderr, flush=True)


@contextmanager
def anything_printed() -> Iterator[None]:
    r"""Have standard output show as ``\xe9`` what its encoding lacks, where printing it would be an error."""
    out = sys.stdout
    # There may be none, or a notebook's, which takes everything.
    if not isinstance(out, io.TextIOWrapper) or out.errors != "strict":
        yield
        return
    out.reconfigure(errors="backslashreplace")
    try:
        yield
    finally:
        out.reconfigure(errors="strict")
