"""Mathematical libraries of other machines: run the core with sines and other functions that are inexact.

On processors with AVX-512, sines of numpy 1 are up to 4 units in the last place off; on others they are better. With
`inexact`, tests on any processor cover all of them. A process can disable its `chosen_instructions`.
"""

from __future__ import annotations

import contextlib
import importlib
import math
import pkgutil
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any, Callable
from unittest import mock

import numpy as np
import terrainav.core

#: Units in the last place by which results may be off; the last half is their own rounding.
ULPS = 4.0
_ONE_ARGUMENT = "sin cos tan arcsin arccos arctan sinh cosh tanh arcsinh arccosh arctanh exp expm1 log log1p log2 log10"
_TWO_ARGUMENTS = "arctan2 hypot"
#: Names in ``math`` of functions that numpy names differently.
_PYTHONS = {"arc" + name: "a" + name for name in ("sin", "cos", "tan", "sinh", "cosh", "tanh", "tan2")}
#: Steps of splitmix64 (Steele, Lea and Flood 2014).
_GOLDEN, _MIX, _MIX_AGAIN = (
    np.uint64(number) for number in (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB)
)


def chosen_instructions() -> list[str]:
    """Instruction sets that numpy uses on this processor, named as in ``NPY_DISABLE_CPU_FEATURES``."""
    umath = importlib.import_module(
        "numpy.core._multiarray_umath" if np.__version__ < "2" else "numpy._core._multiarray_umath"
    )
    return [name for name in umath.__cpu_dispatch__ if umath.__cpu_features__[name]]


def _scattered(seed: int, *arguments: np.ndarray) -> np.ndarray:
    """Numbers in [-1, 1) that depend on the bits of float64 arguments alone, as errors of a library do."""
    with np.errstate(over="ignore"):
        state = np.full(np.broadcast_shapes(*(one.shape for one in arguments)), seed, np.uint64)
        for one in arguments:
            state = state + _GOLDEN + np.ascontiguousarray(one).view(np.uint64).reshape(one.shape)
            for shift, factor in ((30, _MIX), (27, _MIX_AGAIN)):
                state = (state ^ (state >> np.uint64(shift))) * factor
            state = state ^ (state >> np.uint64(31))
    return state.astype(np.float64) * 2.0**-63 - 1.0


def _function(name: str, seed: int, ulps: float) -> Callable[..., Any]:
    """A numpy function with float64 results off by up to ``ulps`` units; exact results stay exact."""
    exactly = getattr(np, name)

    def function(*arguments: Any, **options: Any) -> Any:
        plain = exactly(*arguments, **options)
        if getattr(plain, "dtype", None) != np.float64 or options:
            return plain
        given = [np.asarray(one, np.float64) for one in arguments]
        with np.errstate(all="ignore"):
            result = np.asarray(exactly(*(one.astype(np.longdouble) for one in given)))
            rounded = result.astype(np.float64)
            error = _scattered(seed, *given) * (ulps - 0.5) * np.spacing(np.abs(rounded))
            moved = (result + np.where(result == rounded, 0.0, error)).astype(np.float64)
        if name in ("sin", "cos", "tanh"):
            moved = np.clip(moved, -1.0, 1.0)
        return moved[()] if moved.ndim == 0 else moved

    return function


class _Library:
    """A module with some of its functions replaced."""

    def __init__(self, module: ModuleType, functions: dict[str, Callable[..., Any]]) -> None:
        self._module = module
        self.__dict__.update(functions)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)


def _core_modules() -> Iterator[ModuleType]:
    for found in pkgutil.walk_packages(terrainav.core.__path__, "terrainav.core."):
        if found.name in sys.modules:
            yield sys.modules[found.name]


@contextlib.contextmanager
def inexact(seed: int, ulps: float = ULPS, but: str | None = None) -> Iterator[None]:
    """Give the core's loaded modules a numpy and a ``math`` whose functions are off by up to ``ulps`` units.

    Results are exact ones moved by a share of the units that depends on the argument alone: the same argument gives the
    same result, as in any library. Long double, modules outside the core, and modules whose names begin with ``but``
    stay exact.
    """
    names = (*_ONE_ARGUMENT.split(), *_TWO_ARGUMENTS.split())
    functions = {name: _function(name, seed + number, ulps) for number, name in enumerate(names)}
    pythons = {
        _PYTHONS.get(name, name): (lambda *values, _of=function: float(_of(*values)))
        for name, function in functions.items()
    }
    libraries = {np: _Library(np, functions), math: _Library(math, pythons)}
    with contextlib.ExitStack() as replaced:
        for module in list(_core_modules()):
            if but is not None and module.__name__.startswith(but):
                continue
            for name, value in list(vars(module).items()):
                if value is np or value is math:
                    replaced.enter_context(mock.patch.object(module, name, libraries[value]))
        yield
