"""Code compiled by numba, which is used where it is installed (extra ``fast``); numpy does the same elsewhere."""

from __future__ import annotations

import os
from functools import cache
from importlib.util import find_spec
from typing import Any

from .text.plain import error_text

#: Environment variable: 0 not to use numba.
FAST = "TERRAINAV_FAST"


@cache
def numba_problem() -> str:
    """Why compiled code is not used; empty where it is."""
    if os.environ.get(FAST) == "0":
        return f"{FAST} is 0"
    if find_spec("numba") is None:
        return "numba is not installed"
    try:
        from numba.core.registry import cpu_target

        # Imports what compiling imports, which may fail where numba itself does not: two halves of cffi, say.
        cpu_target.typing_context.refresh()
    except Exception as error:  # noqa: BLE001  (each release of numba refuses newer ones of numpy, in its own way)
        return f"numba cannot be used: {error_text(error)}"
    return ""


def uses_numba() -> bool:
    """Whether compiled code is used: numba is installed, fits numpy and is not switched off."""
    return not numba_problem()


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
