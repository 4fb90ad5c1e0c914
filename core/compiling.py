"""Code compiled by numba, which is used where it is installed (extra ``fast``); numpy does the same elsewhere."""

from __future__ import annotations

import os
from functools import cache
from importlib.util import find_spec
from typing import Any

#: Environment variable: 0 not to use numba.
FAST = "TERRAINAV_FAST"


@cache
def uses_numba() -> bool:
    """Whether compiled code is used: numba is installed, fits numpy and is not switched off."""
    if os.environ.get(FAST) == "0" or find_spec("numba") is None:
        return False
    try:
        import numba  # noqa: F401
    except Exception:  # noqa: BLE001  (each release of numba refuses newer ones of numpy, in its own way)
        return False
    return True


def compiled(function: Any) -> Any:
    """Decorator: compile a function of a module, when it is first called.

    The machine code is kept beside the module, or in the user's cache. A function made at run time would be compiled
    anew in each process.
    """
    import numba

    try:
        return numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:
        # Neither folder can be written.
        return numba.njit(nogil=True, error_model="numpy")(function)
