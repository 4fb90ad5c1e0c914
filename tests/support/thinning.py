"""Parametrisations of which the usual run takes what stands for the others."""

from __future__ import annotations

import os

import pytest

#: Set to "all" where properties are tried with as many examples as the thorough tests take.
EXAMPLES = "TERRAINAV_EXAMPLES"


def examples(most):
    """Examples that hypothesis tries of a property: a third of those of the thorough tests."""
    return most if os.environ.get(EXAMPLES) == "all" else max(most // 3, 2)


def thinned(cases, quick):
    """Cases for ``parametrize``: those that are named ``quick`` as they are, all others as thorough ones.

    Parameters
    ----------
    cases : mapping
        What each name stands for: the values of a case as a tuple, or its one value.
    quick : iterable of str
    """
    quick = set(quick)
    assert quick < set(cases), f"these are no cases: {quick - set(cases)}"
    return [
        pytest.param(
            *(case if isinstance(case, tuple) else (case,)),
            id=name,
            marks=() if name in quick else pytest.mark.thorough,
        )
        for name, case in cases.items()
    ]


def named(cases):
    """Cases that are their own names, for `thinned`."""
    return {str(case): case for case in cases}


def sampled(cases, step):
    """Cases for ``parametrize``: the first and each ``step``-th one after it as they are, all others as thorough ones.

    For sweeps, in which no case stands out.
    """
    return [case if number % step == 0 else _thorough(case) for number, case in enumerate(cases)]


def _thorough(case):
    """A case with its mark."""
    if isinstance(case, type(pytest.param())):
        return pytest.param(*case.values, id=case.id, marks=(*case.marks, pytest.mark.thorough))
    return pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.thorough)
