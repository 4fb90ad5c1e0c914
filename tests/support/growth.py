"""Growth of a function's work with the size of its input, on any machine."""

from __future__ import annotations

import gc
import math
import time

#: Factor between the two sizes that are compared.
TIMES = 8
#: Largest growth of work that counts as proportional; for work that grows with the square of the size it is `TIMES`.
PROPORTIONAL = TIMES / 2.0
#: Shortest time that can be measured.
_NOISE_S = 0.02


def growth(work, size):
    """Processor time of ``work(TIMES * size)`` over `TIMES` that of ``work(size)``.

    If the work does not seem proportional, both are measured up to twice more, and the least time of each counts.
    """
    small_s = large_s = math.inf
    for _ in range(3):
        small_s, large_s = min(small_s, _seconds(work, size)), min(large_s, _seconds(work, TIMES * size))
        grown = large_s / max(TIMES * small_s, _NOISE_S)
        if grown < PROPORTIONAL:
            break
    return grown


def _seconds(work, size):
    # A garbage collection takes more time if other tests have left objects.
    gc.disable()
    try:
        began_s = time.process_time()
        work(size)
        return time.process_time() - began_s
    finally:
        gc.enable()
