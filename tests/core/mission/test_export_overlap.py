"""Overlap in flight, worked out from an exported file alone: places, headings and heights, and the camera's angles."""

from __future__ import annotations

import csv
import json
import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Polygon
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.core.mission.qgc_survey import photos
from tests.core.mission.test_export_wpml import along as places_along
from tests.core.mission.wpml_reader import Wpml
from tests.support.thinning import sampled

GRID = PixelGrid(max_zoom=22, native_zoom=22)
#: Diagonal field of view in degrees, and width over height.
FOV_DEG, ASPECT = 73.7, 4 / 3
AREA = Box(35.145, -89.866, 35.138, -89.857)
FIELD = Polygon((((-89.866, 35.1385), (-89.8585, 35.1425), (-89.8597, 35.1460), (-89.868, 35.1405)),))
OVERLAPS = {"overlap_along": 0.7, "overlap_across": 0.6}
MISSIONS = {
    "north": Mission(AREA, 100.0, Camera(FOV_DEG, ASPECT), **OVERLAPS),
    "track": Mission(AREA, 100.0, Camera(FOV_DEG, ASPECT), facing="track", **OVERLAPS),
    "track, turned": Mission(FIELD, 100.0, Camera(FOV_DEG, ASPECT), facing="track", row_azimuth_deg=57.0, **OVERLAPS),
    "a fixed azimuth": Mission(AREA, 100.0, Camera(FOV_DEG, ASPECT), facing="-90", **OVERLAPS),
    "one way": Mission(AREA, 100.0, Camera(FOV_DEG, ASPECT), facing="track", order="one-way", **OVERLAPS),
}


def of_table(path, names=("lat_deg", "lon_deg", "agl_m", "yaw_deg")):
    with path.open(newline="") as file:
        return [[float(row[name]) for name in names] for row in csv.DictReader(file)]


def of_litchi(path):
    return of_table(path, ("latitude", "longitude", "altitude(m)", "heading(deg)"))


def of_geojson(path):
    every = [feature["properties"] for feature in json.loads(path.read_text())["features"]]
    return [[one[name] for name in ("lat_deg", "lon_deg", "agl_m", "yaw_deg")] for one in every]


def of_geopackage(path):
    from osgeo import ogr

    data = ogr.Open(str(path))
    return [
        [
            feature.GetGeometryRef().GetY(),
            feature.GetGeometryRef().GetX(),
            feature["agl_m"],
            feature["yaw_deg"],
        ]
        for feature in data.GetLayer("captures")
    ]


def of_kml(path):
    found, kml = [], "{http://www.opengis.net/kml/2.2}"
    for mark in ET.parse(path).iter(f"{kml}Placemark"):
        about = {one.get("name"): float(one[0].text) for one in mark.iter(f"{kml}Data") if one.get("name") != "time"}
        if about:
            lon, lat, height = map(float, mark.find(f"{kml}Point/{kml}coordinates").text.split(","))
            found.append([lat, lon, height, about["heading_deg"]])
    return found


def of_gpx(path):
    found = []
    for point in ET.parse(path).iter("{http://www.topografix.com/GPX/1/1}rtept"):
        about = {one.tag.rpartition("}")[2]: one.text for one in point[-1]}
        found.append(
            [float(value) for value in (point.get("lat"), point.get("lon"), about["agl_m"], about["heading_deg"])]
        )
    return found


def of_qgroundcontrol(path):
    items = []
    for item in json.loads(path.read_text())["mission"]["items"]:
        items += item["TransectStyleComplexItem"]["Items"] if item["type"] == "ComplexItem" else [item]
    return photos([item for item in items if item["command"] in (16, 206, 2000)])


def of_wpml(path):
    return [photo[:4] for photo in Wpml(path).photos(places_along)]


#: Ending of a file, what the mission has beside it, and what reads places, heights and headings of its images.
KINDS = {
    "table": (".csv", {}, of_table),
    "GeoJSON": (".geojson", {}, of_geojson),
    "GeoPackage": (".gpkg", {}, of_geopackage),
    "Google Earth": (".kml", {}, of_kml),
    "GPX": (".gpx", {}, of_gpx),
    "Litchi": (".litchi.csv", {}, of_litchi),
    "QGroundControl": (".plan", {}, of_qgroundcontrol),
    "QGroundControl by distance": (".plan", {"trigger": "distance"}, of_qgroundcontrol),
    "survey": (".survey.plan", {}, of_qgroundcontrol),
    "survey by distance": (".survey.plan", {"trigger": "distance"}, of_qgroundcontrol),
    "Pilot 2": (".kmz", {}, of_wpml),
    "Pilot 2 by distance": (".kmz", {"trigger": "distance"}, of_wpml),
    "DJI Fly": (".kmz", {"drone": "dji-fly"}, of_wpml),
}


@pytest.fixture(scope="module")
def plans():
    return {name: plan(mission, GRID) for name, mission in MISSIONS.items()}


def exported(made, folder, kind):
    """Latitudes, longitudes, heights and headings of the files of a flight, of which some programs want many."""
    ending, changes, read = KINDS[kind]
    if ending == ".gpkg":
        pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
    flown = replace(made, mission=made.mission.replace(**changes))
    rows = [row for path in write_plan(flown, folder / f"plan{ending}").files for row in read(path)]
    assert len(rows) == len(made)
    return np.array(rows, np.float64).T


def overlaps_in_flight(lat, lon, agl, heading):
    """Least and median share along and across the flight's rows, from where it flies and how the camera is held."""
    to_plane = Transformer.from_crs(4326, "+proj=laea +lat_0=35.14 +lon_0=-89.86 +ellps=WGS84", always_xy=True)
    places = np.stack(to_plane.transform(lon, lat), axis=1)
    diagonal = 2.0 * agl * math.tan(math.radians(FOV_DEG / 2.0))
    width, height = diagonal * ASPECT / math.hypot(ASPECT, 1.0), diagonal / math.hypot(ASPECT, 1.0)
    yaw = np.radians(heading)
    top = np.stack([np.sin(yaw), np.cos(yaw)], axis=1) * height[:, np.newaxis] / 2.0
    right = np.stack([np.cos(yaw), -np.sin(yaw)], axis=1) * width[:, np.newaxis] / 2.0
    corners = np.stack([places + top - right, places + top + right, places - top + right, places - top - right], axis=1)
    # Rows end where the way bends; most of the flight goes along them.
    legs = np.diff(places, axis=0)
    way = np.degrees(np.arctan2(legs[:, 0], legs[:, 1]))
    main = np.radians(np.median(np.mod(way, 180.0)))
    along, across = np.array([np.sin(main), np.cos(main)]), np.array([np.cos(main), -np.sin(main)])
    straight = np.abs(legs @ across) < 0.2 * np.abs(legs @ along)
    turns = np.abs(np.diff(np.sign(legs @ along), prepend=np.sign(legs[0] @ along))) > 0
    row = np.cumsum(np.append(0, (~straight) | (turns & straight & (np.abs(legs @ across) > 1.0))))

    def share(one, other, axis):
        ends = [((corners[at] @ axis).min(axis=-1), (corners[at] @ axis).max(axis=-1)) for at in (one, other)]
        shared = np.minimum(ends[0][1], ends[1][1]) - np.maximum(ends[0][0], ends[1][0])
        return shared / np.minimum(*(high - low for low, high in ends))

    following = np.flatnonzero(row[1:] == row[:-1])
    shares = [share(following, following + 1, along)]
    beside = []
    for number in range(int(row.max())):
        here, there = np.flatnonzero(row == number), np.flatnonzero(row == number + 1)
        apart = np.abs((places[here] @ along)[:, np.newaxis] - places[there] @ along)
        beside.append(share(here, there[apart.argmin(axis=1)], across))
    shares.append(np.concatenate(beside))
    return [(float(values.min()), float(np.median(values))) for values in shares]


@pytest.mark.parametrize("kind", sampled(KINDS, 4))
@pytest.mark.parametrize("name", MISSIONS)
def test_the_overlap_of_an_exported_flight_is_the_one_that_was_planned(name, kind, plans, tmp_path):
    made = plans[name]
    along, across = overlaps_in_flight(*exported(made, tmp_path, kind))
    (least_along, median_along), (least_across, median_across) = along, across
    found = made.overlap
    # Windows are rounded to pixels of 0.3 m, and Litchi has headings by the degree.
    assert least_along == pytest.approx(found.least_along, abs=0.012)
    assert median_along == pytest.approx(found.median_along, abs=0.006)
    assert least_across == pytest.approx(found.least_across, abs=0.012)
    assert median_across == pytest.approx(found.median_across, abs=0.006)
    assert median_along == pytest.approx(0.7, abs=0.006)
    assert median_across == pytest.approx(0.6, abs=0.006)


@pytest.mark.parametrize("name", MISSIONS)
def test_the_aircraft_heads_where_the_image_was_planned_to_point(name, plans, tmp_path):
    made = plans[name]
    *_, heading = exported(made, tmp_path, "Litchi")
    off = np.abs(np.mod(heading - made.poses.yaw_deg + 180.0, 360.0) - 180.0)
    assert off.max() <= 0.51
