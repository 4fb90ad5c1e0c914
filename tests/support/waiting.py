"""Waiting for conditions, for as long as a busy machine may need."""

from __future__ import annotations

import time

#: Longest wait, which only a test that hangs reaches.
PATIENCE_S = 60.0
#: Seconds between two checks of a condition.
LOOK_S = 0.005


def wait_until(condition, patience_s: float = PATIENCE_S) -> None:
    """Return as soon as ``condition()`` is true; fail if it never is."""
    until_s = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < until_s, "what was waited for has not happened"
        time.sleep(LOOK_S)
