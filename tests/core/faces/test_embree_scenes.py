"""Buildings of five scenes against Embree: triangle, instance, class and depth of every pixel far from edges."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
DATA = ROOT.parent / "shared" / "data"


@pytest.fixture
def peers(monkeypatch):
    """The script that compares them."""
    pytest.importorskip("embreex")
    pytest.importorskip("rasterio")
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    return importlib.import_module("faces_peers")


def check(peers, scene, tilt_deg):
    found = peers.Picture(scene, tilt_deg).compared()
    assert found.is_equal
    assert found.farthest < 1e-5
    # Hardly any pixel is a tie of triangles that lie on top of each other.
    assert found.ties < 20
    assert found.buildings > 1_000
    assert found.compared > 0.5 * peers.SIZE[0] * peers.SIZE[1]


@pytest.mark.parametrize("tilt_deg", [0.0, 60.0])
def test_houses_on_a_steep_slope(peers, tmp_path, tilt_deg):
    check(peers, peers.slope(DATA, tmp_path), tilt_deg)


@pytest.mark.thorough
@pytest.mark.parametrize("tilt_deg", [0.0, 45.0, 60.0, 75.0])
def test_houses_of_the_synthetic_world(peers, tmp_path, tilt_deg):
    check(peers, peers.world(DATA, tmp_path), tilt_deg)


@pytest.mark.real_data
@pytest.mark.parametrize("tilt_deg", [0.0, 45.0, 60.0, 75.0])
@pytest.mark.parametrize("name", ["washington", "delft", "helsinki"])
def test_buildings_of_real_places(peers, tmp_path, name, tilt_deg):
    missing = [file for file in peers.FILES[name] if not (DATA / file).is_file()]
    if missing:
        pytest.skip(f"{DATA / missing[0]} is missing")
    check(peers, peers.SCENES[name](DATA, tmp_path), tilt_deg)
