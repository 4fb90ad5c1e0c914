"""Waiting for what happens: a busy machine only takes longer."""

from __future__ import annotations

import time

#: Ends a test that would hang, and nothing else.
PATIENCE_S = 60.0
#: Seconds between two looks.
LOOK_S = 0.005


def wait_until(condition, patience_s: float = PATIENCE_S) -> None:
    """Return as soon as ``condition()`` is true; the test fails where it never is."""
    until_s = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < until_s, "what was waited for has not happened"
        time.sleep(LOOK_S)
