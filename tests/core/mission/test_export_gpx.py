"""The route of GPX 1.1, read by GDAL and held against the schema's rules."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.export.waypoints import waypoints
from terrainav.core.mission.mission import Mission

from tests.core.mission.flights import ACROSS, HERE, IN_WIND, worked_out

GPX = "{http://www.topografix.com/GPX/1/1}"
OWN = "{https://github.com/terrainav/terrainav/gpx/1}"


@pytest.mark.parametrize("mission", [HERE, ACROSS, IN_WIND], ids=["here", "antimeridian", "wind"])
def test_the_route_keeps_to_the_schema(tmp_path, mission):
    flown = worked_out(mission)
    write_plan(flown, tmp_path / "field.gpx")
    root = ET.parse(tmp_path / "field.gpx").getroot()
    assert (root.tag, root.get("version"), bool(root.get("creator"))) == (f"{GPX}gpx", "1.1", True)
    assert [child.tag for child in root] == [f"{GPX}metadata", f"{GPX}rte"]
    assert root.find(f"{GPX}metadata/{GPX}time").text == mission.flight.start
    points = root.findall(f"{GPX}rte/{GPX}rtept")
    for element, one in zip(points, waypoints(flown)):
        # In the schema's order; without a height above sea level, which is not known.
        assert [child.tag for child in element] == [f"{GPX}{name}" for name in ("time", "name", "desc", "extensions")]
        assert all(re.fullmatch(r"-?\d+\.\d+", element.get(axis)) for axis in ("lat", "lon"))
        assert float(element.get("lat")) == pytest.approx(one.lat_deg, abs=5.1e-10)
        assert float(element.get("lon")) == pytest.approx(one.lon_deg, abs=5.1e-10)
        assert -180.0 <= float(element.get("lon")) < 180.0
        assert element.find(f"{GPX}name").text == one.name
        assert element.find(f"{GPX}time").text == one.time
        assert all(child.tag.startswith(OWN) for child in element.find(f"{GPX}extensions"))
        assert float(element.find(f"{GPX}extensions/{OWN}agl_m").text) == one.agl_m
    assert len(points) == len(flown)


def test_a_longitude_is_not_rounded_to_180(tmp_path):
    poses = ((0.0, 179.9999999999, 100.0), (0.0, 1e-12, 100.0))
    write_plan(worked_out(Mission(Points(poses), 100.0)), tmp_path / "field.gpx")
    points = ET.parse(tmp_path / "field.gpx").getroot().findall(f"{GPX}rte/{GPX}rtept")
    assert [point.get("lon") for point in points] == ["-180.000000000", "0.000000000"]


def test_gdal_reads_the_route(tmp_path):
    ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
    flown = worked_out(HERE)
    notes = write_plan(flown, tmp_path / "field.gpx").notes
    data = ogr.Open(str(tmp_path / "field.gpx"))
    (route,) = data.GetLayerByName("routes")
    assert route.GetGeometryRef().GetPointCount() == len(flown)
    points = list(data.GetLayerByName("route_points"))
    assert [point.GetField("name") for point in points] == flown.names
    assert points[0].GetField("time") == "2024/06/21 10:30:00.250+00"
    assert points[0].GetField("ele") is None
    assert "above ground" in notes[-1]
