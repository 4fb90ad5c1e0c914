"""Runs in other processes with buildings that a mission names by relative paths."""

from __future__ import annotations

import json
import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from contextlib import closing

from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

LAT, LON = 35.141, -89.865


def footprints():
    """Two houses north of the place."""
    features = []
    for east, north, height in ((-20, 30, 12), (10, 45, 20)):
        ring = [(0, 0), (15, 0), (15, 12), (0, 12), (0, 0)]
        places = [[LON + (east + x) * 1.1e-5, LAT + (north + y) * 9e-6] for x, y in ring]
        geometry = {"type": "Polygon", "coordinates": [places]}
        features.append({"type": "Feature", "properties": {"height": height}, "geometry": geometry})
    return json.dumps({"type": "FeatureCollection", "features": features})


def contents(folder):
    """Files of a folder but for records of the run."""
    return {
        name: path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not (name := path.relative_to(folder).as_posix()).startswith(("journal.jsonl", "blocks/"))
    }


def test_workers_elsewhere_make_the_same_bytes(tmp_path, monkeypatch):
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    home.mkdir()
    elsewhere.mkdir()
    (home / "houses.geojson").write_text(footprints())
    monkeypatch.chdir(home)
    places = Points(tuple((LAT + 1e-5 * n, LON, 60.0) for n in range(4)))
    mission = Mission(
        places,
        60.0,
        elevation=("world",),
        buildings=("houses.geojson",),
        tilt_deg=40.0,
        max_px=96,
        products=("facades", "instances"),
    )
    source = named_source("world")
    made = plan(mission, source.grid, mission_heights(mission))
    found = []
    for workers in (1, 2):
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(workers, mp_context=context, initializer=os.chdir, initargs=(elsewhere,)) as processes:
            result = capture(made, source, home / f"by{workers}", executor=processes, blocks=Blocks(2))
        assert result.failed == ()
        found.append(contents(home / f"by{workers}"))
    with closing(source.open()) as opened:
        capture(made, opened, home / "here")
    found.append(contents(home / "here"))
    assert found[0] == found[1] == found[2]
    assert any(b"houses" in data for data in found[0].values())
