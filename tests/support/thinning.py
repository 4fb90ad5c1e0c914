"""Parametrisations of which the usual run takes only representative cases."""

from __future__ import annotations

import os

import pytest

#: Environment variable, "all" to try properties with as many examples as the thorough tests.
EXAMPLES = "TERRAINAV_EXAMPLES"


def examples(most):
    """Number of examples that hypothesis tries: a third of ``most``, which the thorough tests try."""
    return most if os.environ.get(EXAMPLES) == "all" else max(most // 3, 2)


def thinned(cases, quick):
    """Cases for ``parametrize``; all cases except those named in ``quick`` are marked as thorough.

    Parameters
    ----------
    cases : mapping
        Cases by name: the values of a case as a tuple, or its one value.
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
    """Cases for ``parametrize``; all except the first and each ``step``-th one after it are marked as thorough.

    For sweeps, in which no case stands out.
    """
    return [case if number % step == 0 else _thorough(case) for number, case in enumerate(cases)]


def _thorough(case):
    """A case marked as thorough."""
    if isinstance(case, type(pytest.param())):
        return pytest.param(*case.values, id=case.id, marks=(*case.marks, pytest.mark.thorough))
    return pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.thorough)
