"""Footprints found in their file: the same bounds as a parser of JSON gives, whatever the numbers look like."""

from __future__ import annotations

import json
import threading

import numpy as np
import pytest
from qgis.PyQt.QtCore import QEventLoop, QTimer
from terrainav.core.dataset.folder import FOOTPRINTS_FILE
from terrainav.core.errors import Cancelled, InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.dataset import footprints
from terrainav.terrainav_plugin.dataset.footprints import FootprintFile, polygon_rings

EDGES = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    9.1e-05,
    -1e-07,
    5e-324,
    0.1,
    100.00000000000001,
    179.99999999999997,
    -180.0,
    1e-5,
]


def write(folder, polygons, name="a [1, 2] name"):
    """Write footprints as the core does, a line each."""
    features = [
        json.dumps(
            {
                "type": "Feature",
                "properties": {"name": f"{name} {number}"},
                "geometry": {"type": "Polygon", "coordinates": [ring]},
            }
        )
        for number, ring in enumerate(polygons)
    ]
    text = '{"type": "FeatureCollection", "features": [\n' + ",\n".join(features) + "\n]}\n"
    (folder / FOOTPRINTS_FILE).write_text(text, encoding="utf-8")


def bounds_by_json(folder):
    found = []
    for feature in json.loads((folder / FOOTPRINTS_FILE).read_text(encoding="utf-8"))["features"]:
        corners = np.array([corner for polygon in polygon_rings(feature) for ring in polygon for corner in ring])
        found.append([*corners.min(axis=0), *corners.max(axis=0)])
    return np.array(found)


@pytest.mark.parametrize("block_bytes", [64, 1000, 1 << 20])
def test_bounds_are_those_of_a_parser(tmp_path, monkeypatch, block_bytes):
    monkeypatch.setattr(footprints, "_BLOCK_BYTES", block_bytes)
    random = np.random.default_rng(7)
    rings = [[[lon, lat], [lat, lon], [0.5, -0.5]] for lon in EDGES for lat in EDGES]
    rings += (random.uniform(-180, 180, (200, 5, 2)) * 10.0 ** -random.integers(0, 9, (200, 5, 2))).tolist()
    write(tmp_path, rings, name="plain")
    file = FootprintFile(tmp_path)
    assert len(file) == len(rings)
    np.testing.assert_allclose(file._bounds, bounds_by_json(tmp_path), rtol=1e-15, atol=0)
    assert file.read(17)["geometry"]["coordinates"] == [rings[17]]


@pytest.mark.parametrize("box", [Box(10.01, 179.99, 10.0, -179.99), Box(0.004, -0.004, -0.004, 0.004)])
def test_every_capture_is_found_below_itself(tmp_path, box):
    """Across the antimeridian, and where both coordinates change their sign."""
    made = plan(Mission(box, 120.0), PixelGrid())
    write_plan(made, tmp_path / FOOTPRINTS_FILE)
    file = FootprintFile(tmp_path)
    assert len(file) == len(made)
    for index in range(0, len(made), 7):
        lon = (made.lon_deg[index] + 180.0) % 360.0 - 180.0
        found = [file.read(number)["properties"]["name"] for number in file.covering(made.lat_deg[index], lon)]
        assert made.names[index] in found


@pytest.mark.parametrize("text", ["", "\n", "{}", "no json", '{"type": "Feature", "geometry": null}\n', "\x00" * 99])
def test_what_is_no_file_of_footprints_is_one_line(tmp_path, text):
    (tmp_path / FOOTPRINTS_FILE).write_text(text)
    with pytest.raises(InvalidInput, match=r"footprints\.geojson: cannot be read") as caught:
        FootprintFile(tmp_path)
    assert "\n" not in str(caught.value)


def test_missing_file_is_one_line(tmp_path):
    with pytest.raises(InvalidInput, match=r"footprints\.geojson: cannot be read"):
        FootprintFile(tmp_path)


def test_reading_ends_when_nobody_waits(tmp_path):
    write(tmp_path, [[[0, 0], [1, 1], [0, 1]]])
    with pytest.raises(Cancelled):
        FootprintFile(tmp_path, lambda: True)


def test_main_thread_goes_on_while_a_long_file_is_read(tmp_path, monkeypatch):
    """Python's own parser would run for most of the time that this takes; it is called for no line at all."""
    write(tmp_path, np.random.default_rng(1).uniform(-80, 80, (20_000, 5, 2)).tolist())

    def forbidden(_text):
        raise AssertionError("a line was parsed")

    def turns_while_it_is_read():
        read, loop, timer, turns = [], QEventLoop(), QTimer(), []
        thread = threading.Thread(target=lambda: read.append(len(FootprintFile(tmp_path))))

        def turn():
            turns.append(1)
            if not thread.is_alive():
                loop.quit()

        timer.timeout.connect(turn)
        timer.start(0)
        thread.start()
        loop.exec()
        timer.stop()
        assert read == [20_000]
        return len(turns)

    monkeypatch.setattr(footprints, "parse_json", forbidden)
    # A busy machine may let the main thread wait for other programs all the while, but not time and again.
    assert any(turns_while_it_is_read() > 1 for _ in range(20))
