"""A quick draw of every target; `make fuzz` goes on for as long as it is let."""

from __future__ import annotations

import pytest
from terrainav.core.geodesy.raytracing.tracing import compile_code

from tests.fuzz.support import all_targets


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """The time to compile code is not that of the example that first uses it."""
    compile_code()


@pytest.mark.parametrize("target", list(all_targets()), ids=lambda target: target.name)
def test_only_errors_that_are_meant_come_out(target, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    target.draw(target.quick)
