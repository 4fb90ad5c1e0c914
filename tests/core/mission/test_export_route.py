"""Files of flights with take-off, turns and sorties: each sortie whole, images at captures alone."""

from __future__ import annotations

import csv
import json
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.export import PartsAlreadyThere, write_plan
from terrainav.core.mission.export.waypoints import waypoints
from terrainav.core.mission.flight.path import CAPTURE, LANDING, TAKEOFF
from terrainav.core.mission.mission import Mission

from tests.core.mission.flights import worked_out

HOME = (35.1565, -89.9015)
ROUTED = Mission(
    Box(35.158, -89.90, 35.155, -89.894),
    120.0,
    overlap_along=0.5,
    overlap_across=0.5,
    takeoff=HOME,
    turnaround_m=30.0,
    lead_in_m=15.0,
    battery_min=4.0,
    ground_height_m=80.0,
    start="2024-06-21T10:30:00Z",
)
FLOWN = worked_out(ROUTED)


def in_air(path, sortie):
    one = path.sortie_path(sortie)
    return one.kind[~np.isin(one.kind, (TAKEOFF, LANDING))]


def test_waypoints_are_the_points_of_each_sortie():
    path = FLOWN.path
    assert path.sorties > 1
    everything = [one for sortie in range(path.sorties) for one in waypoints(FLOWN, sortie)]
    assert everything == list(waypoints(FLOWN))
    assert [one.kind for one in everything] == path.kind.tolist()
    assert [one.name for one in everything if one.is_capture] == FLOWN.names
    assert {(one.name, one.column, one.row) for one in everything if one.kind == TAKEOFF} == {("take-off", -1, -1)}
    ground = [one for one in everything if one.kind in (TAKEOFF, LANDING)]
    assert {(one.lat_deg, one.lon_deg, one.agl_m) for one in ground} == {(*HOME, 0.0)}
    assert {one.agl_m for one in everything if one.kind not in (TAKEOFF, LANDING)} == {120.0}
    times = [one.time for one in everything]
    assert times == sorted(times)
    assert next(one.time for one in everything if one.is_capture) == "2024-06-21T10:30:00.000Z"


def test_between_captures_heading_and_gimbal_are_those_of_the_capture_ahead():
    flown = worked_out(ROUTED.replace(row_azimuth_deg=120.0, tilt_deg=10.0))
    ahead = None
    for one in reversed(list(waypoints(flown, 0))):
        if one.is_capture:
            ahead = one
        elif ahead is not None:
            assert (one.heading_deg, one.gimbal_pitch_deg) == (ahead.heading_deg, ahead.gimbal_pitch_deg)


@pytest.mark.parametrize("ending", [".kmz", ".plan", ".litchi.csv"])
def test_parts_replace_files_only_where_they_may(tmp_path, ending):
    mine = tmp_path / f"survey-2{ending}"
    mine.write_text("mine")
    with pytest.raises(PartsAlreadyThere, match=rf"are already there: survey-2{re.escape(ending)}$") as wrong:
        write_plan(FLOWN, tmp_path / f"survey{ending}", replace_parts=False)
    assert wrong.value.files == (mine,)
    assert mine.read_text() == "mine"
    assert list(tmp_path.iterdir()) == [mine]
    written = write_plan(FLOWN, tmp_path / f"survey{ending}").files
    assert mine in written
    assert mine.read_bytes() != b"mine"


# --- Litchi


def tables(exported):
    found = []
    for file in exported.files:
        with file.open(newline="") as text:
            found.append(list(csv.DictReader(text)))
    return found


def test_litchi_has_a_file_for_each_sortie_and_photos_at_captures(tmp_path):
    exported = write_plan(FLOWN, tmp_path / "field.litchi.csv")
    path = FLOWN.path
    assert [file.name for file in exported.files] == [
        f"field-{number}.litchi.csv" for number in range(1, path.sorties + 1)
    ]
    for sortie, table in enumerate(tables(exported)):
        kinds = in_air(path, sortie)
        assert [row["actiontype1"] for row in table] == ["1" if kind == CAPTURE else "-1" for kind in kinds]
        assert {float(row["altitude(m)"]) for row in table} == {120.0}
        for row in (table[0], table[-1]):
            assert (float(row["latitude"]), float(row["longitude"])) == pytest.approx(HOME)


def test_litchi_stays_where_it_hovers(tmp_path):
    exported = write_plan(worked_out(ROUTED.replace(trigger="hover", battery_min=None)), tmp_path / "n.litchi.csv")
    for row in (row for table in tables(exported) for row in table):
        actions = [(row[f"actiontype{number}"], row[f"actionparam{number}"]) for number in (1, 2, 3)]
        assert actions in ([("0", "1000"), ("1", "0"), ("-1", "0")], [("-1", "0")] * 3)


def test_litchi_flies_rows_by_distance_from_end_to_end(tmp_path):
    flown = worked_out(ROUTED.replace(trigger="distance", battery_min=None))
    exported = write_plan(flown, tmp_path / "n.litchi.csv")
    (table,) = tables(exported)
    at = [number for number, row in enumerate(table) if float(row["photo_distinterval"]) > 0.0]
    assert len(at) == flown.rows
    lon, lat = flown.lon_deg, flown.lat_deg
    steps = Geod(ellps="WGS84").inv(lon[:-1], lat[:-1], lon[1:], lat[1:])[2]
    for row, number in enumerate(at):
        first, last = np.flatnonzero(flown.row == row)[[0, -1]]
        for cells, capture in ((table[number], first), (table[number + 1], last)):
            assert float(cells["longitude"]) == pytest.approx(lon[capture], abs=5.1e-9)
        assert float(table[number]["photo_distinterval"]) == pytest.approx(steps[first:last].min(), abs=0.006)
        assert float(table[number + 1]["photo_distinterval"]) == -1.0


def test_points_have_no_rows_to_fly_by_distance(tmp_path):
    points = Points(tuple((35.0 + 0.001 * at, -89.0 - 0.001 * (at % 2), 90.0) for at in range(6)))
    mission = Mission(points, 90.0, trigger="distance")
    assert mission.trigger == "waypoint"
    (table,) = tables(write_plan(worked_out(mission), tmp_path / "n.litchi.csv"))
    assert len(table) == 6


def test_a_long_sortie_is_cut_further(tmp_path):
    flown = worked_out(ROUTED.replace(overlap_along=0.9, overlap_across=0.8, battery_min=5.0))
    exported = write_plan(flown, tmp_path / "n.litchi.csv")
    sizes = [len(table) for table in tables(exported)]
    assert max(sizes) <= 99
    assert sum(sizes) == sum(len(in_air(flown.path, sortie)) for sortie in range(flown.path.sorties))
    assert len(sizes) > flown.path.sorties > 1
    (note,) = (note for note in exported.notes if note.startswith("sorties begin at the parts "))
    begins = [int(number) - 1 for number in note.rpartition(" parts ")[2].split(", ")]
    assert len(begins) == flown.path.sorties
    for number, table in enumerate(tables(exported)):
        at_home = (float(table[0]["latitude"]), float(table[0]["longitude"])) == pytest.approx(HOME)
        assert at_home == (number in begins)


# --- Google Earth, GPX and GIS


def test_google_earth_has_a_line_for_each_sortie_and_the_take_off(tmp_path):
    write_plan(FLOWN, tmp_path / "field.kml")
    space = "{http://www.opengis.net/kml/2.2}"
    root = ET.parse(tmp_path / "field.kml").getroot()
    folders = {one.find(f"{space}name").text: one.findall(f"{space}Placemark") for one in root.iter(f"{space}Folder")}
    assert len(folders["Waypoints"]) == len(FLOWN)
    names = [one.find(f"{space}name").text for one in folders["Flight line"]]
    assert names == ["Take-off", *(f"Sortie {number}" for number in range(1, FLOWN.path.sorties + 1))]
    for number, mark in enumerate(folders["Flight line"][1:]):
        (text,) = (one.text for one in mark.iter(f"{space}coordinates"))
        places = [tuple(map(float, place.split(","))) for place in text.split()]
        one = FLOWN.path.sortie_path(number)
        assert places == list(zip(one.lon_deg.tolist(), one.lat_deg.tolist(), one.agl_m.tolist()))


def test_gpx_has_a_route_for_each_sortie(tmp_path):
    write_plan(FLOWN, tmp_path / "field.gpx")
    space = "{http://www.topografix.com/GPX/1/1}"
    root = ET.parse(tmp_path / "field.gpx").getroot()
    path = FLOWN.path
    assert [child.tag for child in root] == [
        f"{space}metadata",
        f"{space}wpt",
        *[f"{space}rte"] * path.sorties,
    ]
    assert (float(root.find(f"{space}wpt").get("lat")), float(root.find(f"{space}wpt").get("lon"))) == HOME
    routes = root.findall(f"{space}rte")
    assert [len(route.findall(f"{space}rtept")) for route in routes] == [
        len(path.sortie_path(sortie)) for sortie in range(path.sorties)
    ]
    assert routes[1].find(f"{space}name").text == "TerrAInav flight, sortie 2"


def test_geojson_says_which_sortie_takes_an_image(tmp_path):
    write_plan(FLOWN, tmp_path / "field.geojson")
    sorties = [one["properties"]["sortie"] for one in json.loads((tmp_path / "field.geojson").read_text())["features"]]
    path = FLOWN.path
    assert sorties == (path.sortie[path.capture >= 0] + 1).tolist()
    write_plan(worked_out(ROUTED.replace(battery_min=None)), tmp_path / "one.geojson")
    assert "sortie" not in (tmp_path / "one.geojson").read_text()


def test_geopackage_has_a_line_for_each_sortie_and_the_take_off(tmp_path):
    ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
    write_plan(FLOWN, tmp_path / "field.gpkg")
    data = ogr.Open(str(tmp_path / "field.gpkg"))
    lines, path = list(data.GetLayerByName("flight_line")), FLOWN.path
    assert [one.GetField("sortie") for one in lines] == list(range(1, path.sorties + 1))
    for number, line in enumerate(lines):
        one = path.sortie_path(number)
        assert line.GetField("length_m") == pytest.approx(one.distance_m)
        assert line.GetField("flight_s") == pytest.approx(path.sorties_s[number])
        places = line.GetGeometryRef().GetGeometryRef(0).GetPoints()
        assert places == list(zip(one.lon_deg.tolist(), one.lat_deg.tolist(), one.agl_m.tolist()))
    (mark,) = data.GetLayerByName("takeoff")
    assert mark.GetGeometryRef().GetPoint_2D() == (HOME[1], HOME[0])


# --- missions without a route


def test_without_a_route_files_have_nothing_new(tmp_path):
    plain = worked_out(Mission(ROUTED.area, 120.0, overlap_along=0.5, overlap_across=0.5))
    for ending in (".kml", ".gpx", ".geojson", ".litchi.csv"):
        (file,) = write_plan(plain, tmp_path / f"field{ending}").files
        text = file.read_text().lower()
        assert not re.search("sortie|take-off|takeoff|turnaround|lead-in|transit|landing", text)
    route = [
        (float(a), float(b))
        for a, b in re.findall(r'rtept lat="([^"]+)" lon="([^"]+)"', (tmp_path / "field.gpx").read_text())
    ]
    wanted = list(zip(plain.lat_deg.tolist(), plain.lon_deg.tolist()))
    assert np.asarray(route) == pytest.approx(np.asarray(wanted), abs=5.1e-10)
