"""A reader of flight files of its own: the straight legs that each format asks an aircraft to fly, and where they lead.

Written from the formats' descriptions and with the standard library, pyproj and GDAL; it knows nothing of the exporter.
"""

from __future__ import annotations

import csv
import json
import math
import xml.etree.ElementTree as ET
import zipfile
from typing import NamedTuple

import numpy as np
import pyproj
from osgeo import gdal, ogr

from tests.core.mission.wpml_reader import Wpml

GPX, OURS = "{http://www.topografix.com/GPX/1/1}", "{https://github.com/terrainav/terrainav/gpx/1}"
KML = "{http://www.opengis.net/kml/2.2}"


class Ground:
    """Heights of a north-up raster over the ellipsoid, bilinear between the pixels' centres; NaN outside."""

    def __init__(self, path):
        file = gdal.Open(str(path))
        self.heights = file.ReadAsArray().astype(np.float64)
        self.west, self.cell, _, self.north, _, _ = file.GetGeoTransform()
        self._project = pyproj.Transformer.from_crs(4979, file.GetProjection(), always_xy=True)

    def pixels(self, lat, lon):
        x, y = self._project.transform(lon, lat)
        return (x - self.west) / self.cell - 0.5, (self.north - y) / self.cell - 0.5

    def at(self, lat, lon):
        column, row = self.pixels(np.asarray(lat), np.asarray(lon))
        rows, columns = self.heights.shape
        i = np.clip(np.floor(row).astype(int), 0, rows - 2)
        j = np.clip(np.floor(column).astype(int), 0, columns - 2)
        x, y = column - j, row - i
        h = self.heights
        found = (h[i, j] * (1 - x) + h[i, j + 1] * x) * (1 - y) + (h[i + 1, j] * (1 - x) + h[i + 1, j + 1] * x) * y
        inside = (column >= 0) & (column <= columns - 1) & (row >= 0) & (row <= rows - 1)
        return np.where(inside, found, np.nan)

    def highest(self, lat, lon, radius_m):
        """Highest of the ground there and of the pixels that surely lie within a radius."""
        found = self.at(lat, lon)
        reach = radius_m / self.cell - math.sqrt(0.5)
        if reach < 0.0:
            return found
        column, row = (np.rint(at).astype(int) for at in self.pixels(np.asarray(lat), np.asarray(lon)))
        whole = int(reach)
        for down in range(-whole, whole + 1):
            for across in range(-whole, whole + 1):
                if math.hypot(down, across) <= reach:
                    i = np.clip(row + down, 0, self.heights.shape[0] - 1)
                    j = np.clip(column + across, 0, self.heights.shape[1] - 1)
                    found = np.fmax(found, self.heights[i, j])
        return found


class Leg(NamedTuple):
    """From latitude, longitude and height over the ellipsoid to the same."""

    start: tuple
    end: tuple


def legs_of(path, ground, home=None):
    """Legs of a flight file by its ending; ``home`` is the place of take-off where the file does not say it."""
    name = path.name
    read = next(reader for ending, reader in READERS.items() if name.endswith(ending))
    return [
        Leg(*pair)
        for places in read(path, ground, home)
        for pair in zip(places, places[1:])
        if all(map(math.isfinite, pair[0] + pair[1]))
    ]


def _plan(path, _ground, _home):
    mission = json.loads(path.read_text())["mission"]
    base, places = mission["plannedHomePosition"][2], []
    items = []
    for item in mission["items"]:
        items += item["TransectStyleComplexItem"]["Items"] if item["type"] == "ComplexItem" else [item]
    for item in items:
        if item["command"] in (16, 22):
            assert item["frame"] == 3
            lat, lon, above = item["params"][4:]
            places.append((lat, lon, base + above))
    return [places]


def _kmz(path, ground, home):
    read = Wpml(path)
    first, last = read.marks[0], read.marks[-1]
    if read.of_fly:
        place = home or (first.lat_deg, first.lon_deg)
        base = float(ground.at(*place))
    else:
        with zipfile.ZipFile(path) as archive:
            template = ET.fromstring(archive.read("wpmz/template.kml"))
        (reference,) = (one for one in template.iter() if one.tag.endswith("takeOffRefPoint"))
        *place, base = map(float, reference.text.split(","))
    up = max(float(read.text(read.config, "takeOffSecurityHeight")), first.height_m)
    back = max(float(read.text(read.config, "globalRTHHeight")), last.height_m)
    places = [
        (*place, base + up),
        (first.lat_deg, first.lon_deg, base + up),
        *((mark.lat_deg, mark.lon_deg, base + mark.height_m) for mark in read.marks),
        (last.lat_deg, last.lon_deg, base + back),
        (*place, base + back),
    ]
    return [places]


def _litchi(path, ground, _home):
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["altitudemode"] for row in rows} == {"1"}
    places = [(float(row["latitude"]), float(row["longitude"]), float(row["altitude(m)"])) for row in rows]
    return [_raised(places, ground)]


def _raised(places, ground):
    lat, lon, above = zip(*places)
    return list(zip(lat, lon, (np.array(above) + ground.at(lat, lon)).tolist()))


def _gpx(path, ground, _home):
    return [
        _raised(
            [
                (float(point.get("lat")), float(point.get("lon")), float(point.find(f".//{OURS}agl_m").text))
                for point in route.iter(f"{GPX}rtept")
            ],
            ground,
        )
        for route in ET.parse(path).getroot().iter(f"{GPX}rte")
    ]


def _kml(path, ground, _home):
    found = []
    for line in ET.parse(path).getroot().iter(f"{KML}LineString"):
        assert line.find(f"{KML}altitudeMode").text == "relativeToGround"
        places = (tuple(map(float, place.split(","))) for place in line.find(f"{KML}coordinates").text.split())
        found.append(_raised([(lat, lon, above) for lon, lat, above in places], ground))
    return found


def _gpkg(path, ground, _home):
    layer = ogr.Open(str(path))
    found = []
    for feature in layer.GetLayerByName("flight_line"):
        shape = feature.GetGeometryRef()
        for part in range(shape.GetGeometryCount()):
            points = shape.GetGeometryRef(part).GetPoints()
            found.append(_raised([(lat, lon, above) for lon, lat, above in points], ground))
    return found


READERS = {
    ".plan": _plan,
    ".kmz": _kmz,
    ".litchi.csv": _litchi,
    ".gpx": _gpx,
    ".kml": _kml,
    ".gpkg": _gpkg,
}


def least_clearance_m(legs, surface, radius_m=0.0, step_m=0.5):
    """Least height of legs over a surface, each half metre along them, but the climbs from and to the ground at home.

    Legs are straight in an azimuthal equidistant plane about the first place, as autopilots fly them.
    """
    lat0, lon0, _ = legs[0].start
    plane = pyproj.Proj(proj="aeqd", lat_0=lat0, lon_0=lon0, ellps="WGS84")
    lat, lon, height = np.array(legs).transpose(2, 1, 0)
    x, y = plane(lon, lat)
    counts = np.ceil(np.hypot(*np.diff([x, y], axis=1)[:, 0]) / step_m).astype(int)
    # Up and down over home.
    counts[np.hypot(*np.diff([x, y], axis=1)[:, 0]) < 0.01] = -1
    leg = np.repeat(np.arange(len(legs)), counts + 1)
    share = np.concatenate([np.linspace(0.0, 1.0, count + 1) for count in counts])
    east, north, up = (a[0, leg] + share * (a[1, leg] - a[0, leg]) for a in (x, y, height))
    found_lon, found_lat = plane(east, north, inverse=True)
    clear = up - surface.highest(found_lat, found_lon, radius_m)
    at = int(np.nanargmin(clear))
    return float(clear[at]), (float(found_lat[at]), float(found_lon[at]), legs[leg[at]])
