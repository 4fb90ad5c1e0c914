"""Code compiled by numba, which is used where it is installed (extra ``fast``); numpy does the same elsewhere."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib.util import find_spec
from typing import Any, TypeVar

from ..errors import Message

Function = TypeVar("Function", bound=Callable[..., Any])

#: Environment variable: 0 not to use numba.
FAST = "TERRAINAV_FAST"
_switched_off: ContextVar[bool] = ContextVar("switched_off", default=False)


@cache
def numba_problem() -> Message | None:
    """Why compiled code is not used; None where it is."""
    if os.environ.get(FAST) == "0":
        return Message("{0} is 0 in the environment", FAST)
    if find_spec("numba") is None:
        return Message("numba is not installed")
    try:
        from numba.core.registry import cpu_target

        # Imports what compiling imports, which may fail where numba itself does not: two halves of cffi, say.
        cpu_target.typing_context.refresh()
    except Exception as error:  # noqa: BLE001  (each release of numba refuses newer ones of numpy, in its own way)
        # Imported this late, as commands without relief import this module.
        from ..text.plain import error_text

        return Message("numba cannot be used: {0}", error_text(error))
    return None


def uses_numba() -> bool:
    """Whether compiled code is used: numba is installed, fits numpy and is not switched off."""
    return numba_problem() is None and not _switched_off.get()


def loaded_numba() -> bool:
    """Whether compiled code is used where loading numba, which takes half a second, would not pay."""
    return "numba" in sys.modules and uses_numba()


@contextmanager
def without_numba() -> Iterator[None]:
    """Use numpy within a block, to compare the two."""
    before = _switched_off.set(True)
    try:
        yield
    finally:
        _switched_off.reset(before)


def code_in_use() -> Message:
    """The code that makes pictures over relief, and how to get faster code."""
    problem = numba_problem()
    if problem is None:
        import numba

        return Message("numba {0}", numba.__version__)
    return Message("numpy ({0}); several times as fast with numba, from pip or the package python3-numba", problem)


def compiled(function: Function) -> Function:
    """Decorator: compile a function of a module, when it is first called.

    The machine code is kept beside the module, or in the user's cache. A function made at run time would be compiled
    anew in each process.
    """
    import numba

    # Without counts of references, which inner loops would spend most of their time on: no kernel makes an array.
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}
    try:
        made: Function = numba.njit(cache=True, **options)(function)
    except RuntimeError:
        # Neither folder can be written.
        made = numba.njit(**options)(function)
    kept: Any = made._cache  # type: ignore[attr-defined]  # noqa: SLF001
    try:
        kept._cache_file._load_index()  # noqa: SLF001
    except Exception:  # noqa: BLE001  (pickles raise anything)
        # An earlier release has kept code for classes that are gone, and numba would stop at each call.
        kept.flush()
    return made
