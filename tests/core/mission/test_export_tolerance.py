"""With a tolerance of heights, files have few waypoints, and no image is farther from its planned height than that."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
import pyproj
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their relief by GDAL's Python module")

from terrainav.core.geodesy.camera import Camera  # noqa: E402
from terrainav.core.geodesy.mercator import PixelGrid  # noqa: E402
from terrainav.core.mission.areas.area import Box  # noqa: E402
from terrainav.core.mission.export import write_plan  # noqa: E402
from terrainav.core.mission.export.sorties import _fewest  # noqa: E402
from terrainav.core.mission.mission import Mission  # noqa: E402
from terrainav.core.mission.plan import plan  # noqa: E402
from terrainav.core.picture.heights import mission_heights  # noqa: E402

from tests.core.mission.flown_reader import Ground, least_clearance_m, legs_of  # noqa: E402
from tests.support import rasters  # noqa: E402
from tests.support.thinning import examples, sampled  # noqa: E402

WEST, NORTH, SIDE, CELL = 320_000.0, 4_298_000.0, 300, 4.0
GRID = PixelGrid(max_zoom=20, native_zoom=20)
TO_DEGREES = pyproj.Transformer.from_crs(32618, 4326, always_xy=True)
ENDINGS = (".plan", ".survey.plan", ".kmz", ".litchi.csv")


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    """Path of hills of several sizes, as a file of 4 m pixels."""
    at = (np.arange(SIDE) + 0.5) * CELL
    x, y = np.meshgrid(at, at)
    heights = 200.0 + 20.0 * np.sin(x / 130.0) * np.cos(y / 90.0) + 4.0 * np.sin(x / 35.0) + 2.0 * np.cos(x / 9.0)
    transform = (WEST, CELL, 0.0, NORTH, 0.0, -CELL)
    path = tmp_path_factory.mktemp("dem") / "hills.tif"
    return str(rasters.write(path, heights[np.newaxis], transform, 32618, data_type=gdal.GDT_Float32))


def box(west, south, east, north):
    (west_lon, north_lat), (east_lon, south_lat) = (
        TO_DEGREES.transform(WEST + x, NORTH - SIDE * CELL + y) for x, y in ((west, north), (east, south))
    )
    return Box(north_lat, west_lon, south_lat, east_lon)


def departures(made, files, ground):
    """How far the files' legs pass each image from its planned height above ground, by a reader of its own."""
    to_utm = pyproj.Transformer.from_crs(4326, 32618, always_xy=True)
    lat, lon = made.meant.lat_deg, made.meant.lon_deg
    planned = ground.at(lat, lon) + made.meant.agl_m
    x, y = to_utm.transform(lon, lat)
    least = np.full(len(made), np.inf)
    for file in files:
        for start, end in legs_of(file, ground, made.mission.route.takeoff):
            (x0, x1), (y0, y1) = to_utm.transform([start[1], end[1]], [start[0], end[0]])
            squared = (x1 - x0) ** 2 + (y1 - y0) ** 2
            if squared < 1e-6:
                continue
            share = np.clip(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / squared, 0.0, 1.0)
            away = np.hypot(x0 + share * (x1 - x0) - x, y0 + share * (y1 - y0) - y)
            off = np.abs(start[2] + share * (end[2] - start[2]) - planned)
            least = np.where(away < 0.3, np.minimum(least, off), least)
    return least


def stated(exported):
    """Numbers of waypoints and images, and the greatest departure, of a file's note."""
    (note,) = (str(one) for one in exported.notes if "read back" in str(one))
    found = re.search(r"([\d,]+) waypoints; ([\d,]+) images at most ([\d.]+) m", note)
    return int(found[1].replace(",", "")), int(found[2].replace(",", "")), float(found[3])


@pytest.mark.parametrize(
    ("ending", "tolerance_m", "changes"),
    sampled(
        [
            (ending, tolerance_m, changes)
            for ending in ENDINGS
            for tolerance_m in (0.3, 2.0, 8.0)
            for changes in (
                {},
                {"clearance_m": 30.0, "clearance_distance_m": 10.0, "crosshatch": True},
                {"takeoff": (0.0, 0.0), "battery_min": 4.0, "turnaround_m": 20.0, "row_azimuth_deg": 30.0},
            )
        ],
        5,
    ),
)
def test_no_image_is_farther_from_its_height_than_allowed(dem, tmp_path, ending, tolerance_m, changes):
    area = box(300.0, 400.0, 750.0, 640.0)
    if "takeoff" in changes:
        changes = {**changes, "takeoff": (area.south_deg - 0.0003, area.west_deg)}
    asked = Mission(
        area, 80.0, Camera(), overlap_along=0.8, overlap_across=0.5, elevation=(dem,), trigger="distance", **changes
    )
    ground = Ground(dem)
    counts = []
    for mission in (asked, asked.replace(height_tolerance_m=tolerance_m)):
        made = plan(mission, GRID, mission_heights(mission))
        exported = write_plan(made, tmp_path / f"field{ending}")
        waypoints, images, most = stated(exported)
        found = departures(made, exported.files, ground)
        assert images == len(made)
        assert found.max() == pytest.approx(most, abs=0.03)
        counts.append(waypoints)
        for file in exported.files:
            legs = legs_of(file, ground, mission.route.takeoff)
            assert least_clearance_m(legs, ground, mission.terrain.clearance_distance_m)[0] >= (
                mission.terrain.clearance_m - 0.06
            )
    assert most <= tolerance_m
    assert found.max() <= tolerance_m
    if tolerance_m >= 2.0:
        assert counts[1] < 0.6 * counts[0]


def test_each_image_keeps_its_waypoint_where_waypoints_trigger(dem, tmp_path):
    asked = Mission(box(300.0, 400.0, 600.0, 500.0), 80.0, overlap_along=0.6, elevation=(dem,))
    files = []
    for mission in (asked, asked.replace(height_tolerance_m=20.0)):
        made = plan(mission, GRID, mission_heights(mission))
        exported = write_plan(made, tmp_path / "field.plan")
        files.append(exported.files[0].read_bytes())
        assert not any("read back" in str(note) for note in exported.notes)
    assert files[0] == files[1]


@settings(max_examples=examples(60), deadline=None)
@given(st.lists(st.tuples(st.floats(0.5, 30), st.floats(-20, 20)), min_size=2, max_size=9), st.floats(0.01, 15))
def test_waypoints_are_the_fewest(points, within_m):
    step, height = np.array(points).T
    way = np.cumsum(step)
    found = _fewest(way, height, within_m)
    assert found[0] == 0
    assert found[-1] == len(way) - 1

    def departure(kept):
        return np.abs(np.interp(way, way[list(kept)], height[list(kept)]) - height).max()

    assert departure(found) <= within_m + 2e-3
    inner = range(1, len(way) - 1)
    for count in range(len(found) - 2):
        for some in combinations(inner, count):
            assert departure((0, *some, len(way) - 1)) > within_m - 2e-3
