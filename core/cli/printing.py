"""Output of the command: notices during long work, and escapes for characters that the encoding lacks."""

from __future__ import annotations

import io
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

#: Seconds before the first notice that the command is at work, and between later notices.
QUIET_S, AGAIN_S = 10.0, 60.0


@contextmanager
def busy_notice() -> Iterator[None]:
    """Print notices to a terminal while a ``with`` block takes long."""
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
def escape_output() -> Iterator[None]:
    r"""Make standard output escape characters that its encoding lacks, as ``\xe9``, instead of raising an error."""
    out = sys.stdout
    # Standard output may be missing, or a notebook's, which accepts all characters.
    if not isinstance(out, io.TextIOWrapper) or out.errors != "strict":
        yield
        return
    out.reconfigure(errors="backslashreplace")
    try:
        yield
    finally:
        out.reconfigure(errors="strict")
