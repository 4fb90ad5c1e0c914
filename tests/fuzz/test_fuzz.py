"""A quick draw of every target; `make fuzz` goes on for as long as it is let."""

from __future__ import annotations

import pytest

from tests.fuzz.support import all_targets


@pytest.mark.parametrize("target", list(all_targets()), ids=lambda target: target.name)
def test_only_errors_that_are_meant_come_out(target, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    target.draw(target.quick)
