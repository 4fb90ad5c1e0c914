"""Shadows of the synthetic world's relief and of a cone against GRASS's `r.sunmask`."""

from __future__ import annotations

import shutil

import pytest

from tests.support.peers import told_by_benchmark


@pytest.mark.thorough
def test_shadows_are_those_of_grass():
    if shutil.which("grass") is None:
        pytest.skip("GRASS (Debian: grass-core) is not installed")
    told_by_benchmark("sunmask_peers.py")
