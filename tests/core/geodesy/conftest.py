"""Every test of geodesy is run twice: with this machine's mathematical library, and with one that is far worse."""

from __future__ import annotations

import contextlib

import pytest

from tests.support.libraries import inexact


@pytest.fixture(scope="module", autouse=True, params=["own", pytest.param("4 ulp", marks=pytest.mark.thorough)])
def library(request):
    """Mathematical library of the core: the machine's, or one whose functions are up to 4 last places off."""
    with inexact(seed=4) if request.param == "4 ulp" else contextlib.nullcontext():
        yield request.param
