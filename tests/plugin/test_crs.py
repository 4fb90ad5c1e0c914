"""The coordinate reference system of a mission, in the panel and where QGIS shows sources."""

from __future__ import annotations

import json

import numpy as np
import pyproj
import pytest
from qgis.core import QgsProject, QgsVectorLayer
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.catalogue import described
from terrainav.core.imagery.entry import CatalogueEntry
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin import sources
from terrainav.terrainav_plugin.capture.questions import Questions
from terrainav.terrainav_plugin.form.mission_form import FormError
from terrainav.terrainav_plugin.sources import MissionPlans, mission_grid, open_for_capture, tile_layer_uri

from tests.support import rasters

LAT, LON = 35.15, -89.9


def test_a_system_that_the_source_does_not_have_is_said_at_its_entry(desk):
    desk.enter_small_mission()
    entry = next(group.entries["crs"] for group in desk.form.groups if "crs" in group.entries)
    desk.type_text(entry, "2056")
    desk.wait(lambda: "must be a code such as EPSG:2056" in desk.message("crs"))
    desk.type_text(entry, "EPSG:2056")
    desk.wait(lambda: "EPSG:2056" in desk.message("crs") and "EPSG:3857" in desk.message("crs"))
    desk.type_text(entry, "EPSG:3857")
    planned = desk.wait_planned()
    assert planned.mission.imagery.crs == "EPSG:3857"
    assert desk.message("crs") == ""
    desk.type_text(entry, "")
    assert desk.wait_planned().mission.imagery.crs == ""


def test_maps_of_qgis_are_in_web_mercator(plugin):
    QgsProject.instance().addMapLayer(QgsVectorLayer("Polygon?crs=EPSG:3857", "areas", "memory"))
    mission = Mission(Points(((LAT, LON, 100.0),)), 100.0, source="qgis:project")
    assert mission_grid(mission.replace(crs="EPSG:3857")) == mission_grid(mission)
    with pytest.raises(FormError) as refused:
        mission_grid(mission.replace(crs="EPSG:2056"))
    assert refused.value.messages == {"crs": "coordinate reference system EPSG:2056: this map of QGIS has EPSG:3857"}


def test_tiles_of_another_system_are_no_background(plugin, monkeypatch):
    plane = {"crs": "EPSG:25832", "west": 0.0, "north": 6e6, "width": 2.0**20, "height": 2.0**20}
    data = {**described("https://h.example/{z}/{x}/{y}.png", title="Länder"), "plane": plane}
    entry = CatalogueEntry.from_dict("mine", data, user=True)
    monkeypatch.setattr(sources, "_named", lambda *_: type("Named", (), {"entry": entry}))
    with pytest.raises(InvalidInput, match="Länder has tiles in EPSG:25832, which cannot be a background"):
        tile_layer_uri("mine", "satellite")


def test_a_dataset_that_states_its_system_is_of_the_mission_that_left_it_to_the_source(plugin, tmp_path):
    x, y = pyproj.Transformer.from_crs(4326, 32616, always_xy=True).transform(LON, LAT)
    values = np.zeros((3, 800, 800), np.uint8)
    path = rasters.write(tmp_path / "ortho.tif", values, (x - 200.0, 0.5, 0.0, y + 200.0, 0.0, -0.5), 32616)
    mission = Mission(Points(((LAT, LON, 100.0),)), 100.0, source=str(path))
    source = open_for_capture(mission, None)
    worked_out = plan(mission, source.grid)
    capture(worked_out, source, tmp_path / "out")
    source.close()
    stated = json.loads((tmp_path / "out/mission.json").read_text("utf-8"))
    assert stated["imagery"]["crs"] == "EPSG:32616"
    questions = Questions(None, None, None, None)
    assert not questions.belongs_to_another(MissionPlans(mission, {"": worked_out}), tmp_path / "out")
    on_map = mission.replace(crs="EPSG:3857")
    assert mission_grid(on_map).plane.wraps
    assert mission_grid(mission).plane.crs == "EPSG:32616"
