"""What holds for the core's tests: properties are tried with the same examples every time, on slow machines, too."""

from __future__ import annotations

import pytest
from hypothesis import settings

from tests.support.thinning import examples

settings.register_profile("same every time", derandomize=True, deadline=None, max_examples=examples(100))
settings.load_profile("same every time")


@pytest.fixture(params=["numpy", "compiled"])
def ray_code(request, monkeypatch):
    """The code that follows rays over relief: numpy's, and what numba has compiled."""
    from terrainav.core.external import compiling

    if request.param == "numpy":
        monkeypatch.setattr(compiling, "numba_problem", lambda: "not wanted")
    elif not compiling.uses_numba():
        pytest.skip(compiling.numba_problem())
