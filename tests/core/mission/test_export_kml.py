"""Google Earth's file: footprints, waypoints above ground and the line between them, of any size."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.export.waypoints import waypoints

from tests.core.mission.flights import ACROSS, ALONE, HERE, IN_WIND, worked_out

KML = "{http://www.opengis.net/kml/2.2}"


def folders(path):
    found = ET.parse(path).getroot().find(f"{KML}Document").findall(f"{KML}Folder")
    return {folder.find(f"{KML}name").text: folder.findall(f"{KML}Placemark") for folder in found}


def coordinates(element):
    return [tuple(map(float, place.split(","))) for place in element.text.split()]


@pytest.mark.parametrize("mission", [HERE, ACROSS, IN_WIND], ids=["here", "antimeridian", "wind"])
def test_waypoints_and_line_are_above_ground_where_they_were_meant(tmp_path, mission):
    flown = worked_out(mission)
    notes = write_plan(flown, tmp_path / "field.kml").notes
    assert [note[:45] for note in notes] == (
        ["footprints are those of the flight in wind, w"] if mission is IN_WIND else []
    )
    found = folders(tmp_path / "field.kml")
    assert list(found) == ["Footprints", "Waypoints", "Flight line"]
    assert len(found["Footprints"]) == len(flown)
    wanted = [(one.lon_deg, one.lat_deg, one.agl_m) for one in waypoints(flown)]
    assert [coordinates(mark.find(f"{KML}Point/{KML}coordinates"))[0] for mark in found["Waypoints"]] == wanted
    (line,) = found["Flight line"]
    lines = line.findall(f"{KML}MultiGeometry/{KML}LineString")
    modes = [element.text for element in (*found["Waypoints"], line) for element in element.iter(f"{KML}altitudeMode")]
    assert set(modes) == {"relativeToGround"}
    assert len(modes) == len(flown) + len(lines)
    drawn = [place for part in lines for place in coordinates(part.find(f"{KML}coordinates"))]
    # Beside the waypoints, two places at each crossing of the antimeridian.
    assert len(drawn) == len(flown) + 2 * (len(lines) - 1)
    assert (len(lines) > 1) is (mission is ACROSS)


def test_one_capture_has_no_line(tmp_path):
    write_plan(worked_out(ALONE), tmp_path / "one.kml")
    assert {name: len(marks) for name, marks in folders(tmp_path / "one.kml").items()} == {
        "Footprints": 1,
        "Waypoints": 1,
        "Flight line": 0,
    }


def test_large_plans_are_drawn_by_their_line_alone(tmp_path, monkeypatch):
    monkeypatch.setattr("terrainav.core.mission.export.kml.MAX_PLACEMARKS", 10)
    flown = worked_out(HERE)
    (note,) = write_plan(flown, tmp_path / "field.kml").notes
    assert f"{len(flown)} captures are more than Google Earth opens" in note
    assert list(folders(tmp_path / "field.kml")) == ["Flight line"]


def test_gdal_finds_the_attributes(tmp_path):
    ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
    flown = worked_out(HERE)
    write_plan(flown, tmp_path / "field.kml")
    data = ogr.Open(str(tmp_path / "field.kml"))
    assert [data.GetLayer(index).GetName() for index in range(data.GetLayerCount())] == [
        "Footprints",
        "Waypoints",
        "Flight line",
    ]
    if data.GetDriver().GetName() == "LIBKML":
        first = data.GetLayerByName("Waypoints").GetNextFeature()
        assert (int(first.GetField("column")), float(first.GetField("agl_m"))) == (
            int(flown.column[0]),
            120.0,
        )
