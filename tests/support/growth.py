"""How the work of something grows with the size of what it is given, whatever the machine."""

from __future__ import annotations

import gc
import math
import time

TIMES = 8
#: Growth up to which work counts as proportional: with the square of the size it grows `TIMES` as much.
PROPORTIONAL = TIMES / 2.0
#: Seconds that cannot be told from none.
_NOISE_S = 0.02


def growth(work, size):
    """Processor time of ``work(TIMES * size)`` over `TIMES` that of ``work(size)``.

    Where it seems not to be proportional it is measured twice more, and the least of each counts.
    """
    small_s = large_s = math.inf
    for _ in range(3):
        small_s, large_s = min(small_s, _seconds(work, size)), min(large_s, _seconds(work, TIMES * size))
        grown = large_s / max(TIMES * small_s, _NOISE_S)
        if grown < PROPORTIONAL:
            break
    return grown


def _seconds(work, size):
    # A garbage collection takes time by the objects of other tests.
    gc.disable()
    try:
        began_s = time.process_time()
        work(size)
        return time.process_time() - began_s
    finally:
        gc.enable()
