"""What the command prints to: terminals and files whose encoding may have no word for a name."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from contextlib import contextmanager


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
