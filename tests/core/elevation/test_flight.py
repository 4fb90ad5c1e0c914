"""Flights over relief: their heights, what they are refused for, and that their images leave nothing out."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pyproj
import pytest
from osgeo import gdal
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import SourceOptions, named_source
from terrainav.core.mission.areas.area import Box, Points, Polygon, Polygons, area_contains
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.relief import modelled
from terrainav.core.picture.heights import mission_heights

from tests.core.mission.qgc_survey import checked, photos
from tests.core.mission.wpml_reader import Wpml
from tests.support import rasters
from tests.support.thinning import sampled, thinned

WEST, NORTH, SIDE = 320_000.0, 4_298_000.0, 500
UTM = (WEST, 2.0, 0.0, NORTH, 0.0, -2.0)
TO_UTM = pyproj.Transformer.from_crs(4326, 32618, always_xy=True)
GEOCENTRIC = pyproj.Transformer.from_crs(4979, 4978, always_xy=True)
GRID = PixelGrid(max_zoom=20, native_zoom=20)
CAMERA = Camera(78.8, 4 / 3)


def hills(x, y):
    return 60.0 + 25.0 * np.sin(x / 90.0) * np.cos(y / 70.0)


def tower(x, y):
    return hills(x, y) + 40.0 * ((np.abs(x - 500) < 5) & (np.abs(y - 500) < 5))


def town(x, y):
    return 25.0 * ((x % 30.0 < 12.0) & (y % 30.0 < 12.0))


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    """Paths of surfaces by name, as files of 2 m pixels."""
    x, y = (np.meshgrid(np.arange(SIDE) * 2.0 + 1.0, np.arange(SIDE) * 2.0 + 1.0))[:2]
    folder = tmp_path_factory.mktemp("dem")
    found = {}
    surfaces = {"hills": hills(x, y), "tower": tower(x, y), "level": np.full(x.shape, 41.5)}
    surfaces["town"] = town(x, y)
    surfaces["mast"] = surfaces["level"] + tower(x, y) - hills(x, y)
    for name, values in surfaces.items():
        found[name] = str(
            rasters.write(folder / f"{name}.tif", values[np.newaxis], UTM, 32618, data_type=gdal.GDT_Float32)
        )
    holed = hills(x, y)
    holed[240:260, 240:260] = -9999.0
    found["hole"] = str(
        rasters.write(folder / "hole.tif", holed[np.newaxis], UTM, 32618, nodata=-9999.0, data_type=gdal.GDT_Float32)
    )
    return found


def box(west, south, east, north):
    """Box by metres from the corner of the relief, southward for the second and the fourth."""
    to_degrees = pyproj.Transformer.from_crs(32618, 4326, always_xy=True)
    lon, lat = to_degrees.transform([WEST + west, WEST + east], [NORTH - north, NORTH - south])
    return Box(lat[0], lon[0], lat[1], lon[1])


AREA = box(330.0, 700.0, 640.0, 380.0)
WIDE = box(200.0, 700.0, 800.0, 380.0)


def flown(mission, grid=GRID):
    return plan(mission, grid, mission_heights(mission))


def ground_below(made, surface=hills):
    x, y = TO_UTM.transform(made.lon_deg, made.lat_deg)
    return surface(x - WEST, NORTH - y)


def test_above_the_ground_each_capture_is_so_high_over_what_is_below(dem):
    made = flown(Mission(AREA, 80.0, elevation=(dem["hills"],), overlap_along=0.6, overlap_across=0.4))
    # The model is bilinear in cells of 2 m.
    assert made.ground_m == pytest.approx(ground_below(made), abs=0.02)
    assert made.agl_m == pytest.approx(80.0, abs=1e-9)
    assert made.height_m == pytest.approx(made.ground_m + 80.0)
    assert np.ptp(made.height_m) > 20.0


def test_above_the_takeoff_all_are_as_high(dem):
    made = flown(Mission(AREA, 80.0, elevation=(dem["hills"],), height_above="takeoff"))
    x, y = TO_UTM.transform(AREA.west_deg, AREA.north_deg)
    assert made.height_m == pytest.approx(hills(x - WEST, NORTH - y) + 80.0, abs=0.02)
    assert made.agl_m == pytest.approx(made.height_m - ground_below(made), abs=0.02)


def test_above_the_ellipsoid_all_are_where_they_are_asked_for(dem):
    made = flown(Mission(AREA, 150.0, elevation=(dem["hills"],), height_above="ellipsoid"))
    assert made.height_m == pytest.approx(150.0)


def test_points_have_their_own_heights(dem):
    x, y = np.array([400.0, 500.0, 612.0]), np.array([400.0, 523.0, 700.0])
    lon, lat = pyproj.Transformer.from_crs(32618, 4326, always_xy=True).transform(WEST + x, NORTH - y)
    points = Points(tuple(zip(lat.tolist(), lon.tolist(), (50.0, 90.0, 130.0))))
    made = flown(Mission(points, 50.0, elevation=(dem["hills"],)))
    assert made.agl_m == pytest.approx([50.0, 90.0, 130.0])
    assert made.height_m == pytest.approx(hills(x, y) + np.array([50.0, 90.0, 130.0]), abs=0.02)


def test_a_climb_rate_is_kept_and_never_takes_height_away(dem):
    asked = {"overlap_along": 0.7, "overlap_across": 0.4, "elevation": (dem["tower"],)}
    plain, slow = (flown(Mission(AREA, 70.0, **asked, **more)) for more in ({}, {"climb_m_per_s": 1.5}))
    assert len(plain) == len(slow)
    way = pyproj.Geod(ellps="WGS84").inv(slow.lon_deg[:-1], slow.lat_deg[:-1], slow.lon_deg[1:], slow.lat_deg[1:])[2]
    steepest = 1.5 / slow.mission.flight.airspeed_m_per_s
    assert (np.abs(np.diff(slow.height_m)) <= steepest * way + 1e-6).all()
    assert (np.abs(np.diff(plain.height_m)) > steepest * way).any()
    assert (slow.height_m >= plain.height_m - 1e-9).all()


def test_a_clearance_is_kept_over_everything_within_its_distance(dem):
    asked = {"elevation": (dem["tower"],), "clearance_m": 45.0, "clearance_distance_m": 60.0}
    made = flown(Mission(AREA, 60.0, **asked, overlap_along=0.5, overlap_across=0.5))
    x, y = TO_UTM.transform(made.lon_deg, made.lat_deg)
    away = np.hypot(x - WEST - 500.0, NORTH - y - 500.0)
    top = tower(np.array([500.0]), np.array([500.0]))[0]
    near = away < 55.0
    assert near.sum() > 3
    assert (made.height_m[near] >= top + 45.0 - 0.5).all()
    assert made.agl_m.min() >= 60.0 - 1e-9
    assert (made.agl_m[away > 120.0] < 95.0).all()


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"clearance_m": 70.0}, "clearance 70 m and height 60 m above ground"),
        ({"height_above": "ellipsoid"}, r"the surface there rises to 9[0-9]\.\d m"),
        (
            {"height_above": "takeoff", "clearance_m": 50.0, "clearance_distance_m": 100.0},
            "50 m of clearance are to be kept",
        ),
        ({"frame": "map"}, r"the ground is from [\d.]+ to \d\d\.\d m high, and seen from aside"),
    ],
)
def test_what_cannot_be_flown_is_refused_with_its_place(dem, values, said):
    with pytest.raises(InvalidInput, match=said):
        flown(Mission(AREA, 60.0, elevation=(dem["tower"],), overlap_along=0.6, overlap_across=0.6, **values))


def test_a_hole_below_a_capture_and_an_area_beyond_the_relief_are_named(dem):
    with pytest.raises(InvalidInput, match=r"no height at latitude 38\.\d+, longitude -77\.\d+"):
        flown(Mission(AREA, 60.0, elevation=(dem["hole"],), overlap_along=0.6, overlap_across=0.6))
    filled = Mission(AREA, 60.0, elevation=(dem["hole"], dem["level"]), overlap_along=0.6, overlap_across=0.6)
    assert len(flown(filled)) > 10
    with pytest.raises(InvalidInput, match="no height at latitude 10"):
        flown(Mission(Box(10.001, 20.0, 10.0, 20.001), 60.0, elevation=(dem["hills"],)))


def test_filled_holes_are_counted_and_can_be_refused(dem):
    filled = Mission(AREA, 60.0, elevation=(dem["hole"], dem["hills"]))
    summary = estimate(flown(filled))
    assert summary.filled_heights == 400
    # Centres of pixels of 2 m that corners lie between.
    corners = 2 * [AREA.west_deg, AREA.east_deg], 2 * [AREA.south_deg] + 2 * [AREA.north_deg]
    sides = ((np.asarray(at) - 1.0) / 2.0 for at in TO_UTM.transform(*corners))
    assert summary.heights == np.prod([np.ceil(at.max()) - np.floor(at.min()) + 1.0 for at in sides])
    text = dict(summary.lines())["holes filled"]
    assert str(text).startswith(f"400 of {summary.heights:,} heights around the area (1.")
    whole = estimate(flown(Mission(AREA, 60.0, elevation=(dem["hills"],))))
    assert whole.filled_heights == 0
    assert "holes filled" not in dict(whole.lines())
    with pytest.raises(InvalidInput, match="hole in the heights") as refused:
        flown(filled.replace(holes="refuse"))
    lat, lon = (float(number) for number in re.findall(r"-?\d+\.\d+", str(refused.value))[:2])
    x, y = TO_UTM.transform(lon, lat)
    assert 480.0 < x - WEST < 520.0
    assert 480.0 < NORTH - y < 520.0
    with pytest.raises(InvalidInput, match="hole in the heights"):
        flown(Mission(AREA, 60.0, elevation=(dem["hills"],), surface=(dem["hole"],), holes="refuse"))


def test_level_ground_is_stated_with_its_height(dem):
    figures = estimate(flown(Mission(AREA, 60.0, elevation=(dem["level"],))))
    assert figures.level_ground_m == 41.5
    assert str(dict(figures.lines())["ground below"]) == "41.5 m above the ellipsoid everywhere"
    assert "ground below" not in dict(estimate(plan(Mission(AREA, 60.0), GRID)).lines())


@pytest.mark.parametrize("kind", ["box", "polygon", "point"])
def test_holes_beside_the_area_are_not_refused(dem, kind):
    south, west, north, east = AREA.south_deg, AREA.west_deg, AREA.north_deg, AREA.east_deg
    # The hole is in the middle of the area's box, and in that of the polygon, which is an L around it.
    across, down = west + 0.2 * (east - west), north - 0.2 * (north - south)
    ring = ((west, north), (east, north), (east, down), (across, down), (across, south), (west, south))
    area = {
        "box": box(330.0, 700.0, 640.0, 560.0),
        "polygon": Polygon((ring,)),
        "point": Points(((north, west, 60.0),)),
    }[kind]
    assert len(flown(Mission(area, 60.0, elevation=(dem["hole"], dem["hills"]), holes="refuse"))) >= 1


def test_a_mission_with_relief_is_not_planned_without_its_heights(dem):
    with pytest.raises(InvalidInput, match="is planned without its heights"):
        plan(Mission(AREA, 60.0, elevation=(dem["hills"],)), GRID)


@pytest.mark.parametrize("how", ["a number", "a file"])
def test_level_heights_are_the_level_ground_that_they_say(dem, how):
    asked = {"overlap_along": 0.3, "overlap_across": 0.3}
    heights = ("41.5",) if how == "a number" else (dem["level"],)
    ours = flown(Mission(AREA, 90.0, elevation=heights, **asked))
    plain = plan(Mission(AREA, 90.0, ground_height_m=41.5, **asked), GRID)
    assert ours.frames.on_map
    assert ours.relief.is_level
    for one, other in zip(ours.windows, plain.windows):
        np.testing.assert_array_equal(one, other)
    assert ours.height_m == pytest.approx(plain.height_m)
    assert ours.corners.lat_deg == pytest.approx(plain.corners.lat_deg, abs=1e-12)


def seen_by(made, lat, lon, height_m, margin=0.0, only=None):
    """How many captures have points in their images, occlusion left out: pinholes in geocentric coordinates."""
    points = np.stack(GEOCENTRIC.transform(lon, lat, height_m), axis=-1)
    tan_x, tan_y = made.mission.camera.half_tangents
    count = np.zeros(len(lat), int)
    cameras = np.stack(GEOCENTRIC.transform(made.lon_deg, made.lat_deg, made.height_m), axis=-1)
    for index in range(len(made)) if only is None else only:
        phi, lam = np.radians(made.lat_deg[index]), np.radians(made.lon_deg[index])
        east = np.array([-np.sin(lam), np.cos(lam), 0.0])
        up = np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
        north = np.cross(up, east)
        yaw, tilt = np.radians(made.poses.yaw_deg[index]), np.radians(made.poses.tilt_deg[index])
        heading = np.sin(yaw) * east + np.cos(yaw) * north
        right = np.cos(yaw) * east - np.sin(yaw) * north
        axis = np.sin(tilt) * heading - np.cos(tilt) * up
        top = np.cos(tilt) * heading + np.sin(tilt) * up
        vectors = points - cameras[index]
        depth = vectors @ axis
        x, y = vectors @ right / depth / tan_x, vectors @ top / depth / tan_y
        count += (depth > 0) & (np.abs(x) <= 1.0 + margin) & (np.abs(y) <= 1.0 + margin)
    return count


FLIGHTS = {
    "ground": {},
    "takeoff": {"height_above": "takeoff"},
    "ellipsoid": {"height_above": "ellipsoid"},
    "turned": {"row_azimuth_deg": 120.0},
    "slow": {"climb_m_per_s": 2.0},
    "track": {"facing": "track"},
    "track, tilted": {"facing": "track", "tilt_deg": 12.0},
    "margin": {"margin_m": 40.0},
    "margin, turned": {"margin_m": 40.0, "row_azimuth_deg": 30.0},
}


@pytest.mark.parametrize(
    ("kind", "values"),
    thinned(
        {f"{kind}, {name}": (kind, values) for kind in ("hills", "tower") for name, values in FLIGHTS.items()},
        [*(f"tower, {name}" for name in FLIGHTS), "hills, ground", "hills, turned"],
    ),
)
def test_nothing_of_an_area_is_left_out_and_the_least_overlap_is_kept(dem, kind, values):
    agl = 190.0 if values.get("height_above") == "ellipsoid" else 90.0
    made = flown(Mission(AREA, agl, elevation=(dem[kind],), overlap_along=0.5, overlap_across=0.5, **values))
    rng = np.random.default_rng(4)
    lat = rng.uniform(AREA.south_deg, AREA.north_deg, 3000)
    lon = rng.uniform(AREA.west_deg, AREA.east_deg, 3000)
    x, y = TO_UTM.transform(lon, lat)
    height = (hills if kind == "hills" else tower)(x - WEST, NORTH - y)
    count = seen_by(made, lat, lon, height)
    assert count.min() >= 1
    inner = (np.abs(lat - (AREA.north_deg + AREA.south_deg) / 2) < 0.3 * (AREA.north_deg - AREA.south_deg)) & (
        np.abs(lon - (AREA.east_deg + AREA.west_deg) / 2) < 0.3 * (AREA.east_deg - AREA.west_deg)
    )
    # Half of each image along and across again: every point in the middle is in four images, but for rounding.
    assert (count[inner] >= 4).mean() > 0.99
    assert made.coverage.complete


def test_the_higher_the_ground_the_tighter_the_rows(dem):
    plain = plan(Mission(AREA, 90.0, overlap_along=0.5, overlap_across=0.5), GRID)
    made = flown(Mission(AREA, 90.0, elevation=(dem["hills"],), overlap_along=0.5, overlap_across=0.5))
    assert len(made) > len(plain)
    assert made.overlap.least_along >= 0.49
    assert made.overlap.least_across >= 0.49


def test_along_a_row_images_are_only_as_near_as_what_they_show_needs(dem):
    """About a tower on a plain half of what is seen of its top; elsewhere half of what is seen of the plain."""
    made = flown(Mission(WIDE, 90.0, elevation=(dem["mast"],), overlap_along=0.5, overlap_across=0.5))
    assert made.coverage.complete
    assert made.overlap.least_along >= 0.49
    parallel_m = WGS84.normal_radius_m(made.lat_deg) * np.cos(np.radians(made.lat_deg))
    apart = np.abs(np.radians(np.diff(made.lon_deg)) * parallel_m[1:])
    x, y = TO_UTM.transform(made.lon_deg, made.lat_deg)
    away = np.hypot(x - WEST - 500.0, NORTH - y - 500.0)
    same, near = np.diff(made.row) == 0, np.minimum(away[1:], away[:-1])
    plain_m, top_m = (CAMERA.ground_size_m(agl)[0] for agl in (90.0, 50.0))
    assert np.median(apart[same & (near > 150.0)]) == pytest.approx(0.5 * plain_m, rel=0.005)
    assert apart[same].min() == pytest.approx(0.5 * top_m, rel=0.005)
    assert (apart[same & (near < 30.0)] < 0.4 * plain_m).all()


@pytest.mark.parametrize("trials", [2, pytest.param(40, marks=pytest.mark.thorough)])
def test_rows_over_any_relief_leave_nothing_out(tmp_path, trials):
    """Cliffs, spikes and noise; boxes and polygons, narrower than an image or of several; any overlap and tilt."""
    rng = np.random.default_rng(7)
    for trial in range(trials):
        rough = rng.choice([2.0, 15.0, 40.0])
        values = rng.normal(0.0, rough / 8.0, (SIDE, SIDE))
        for _ in range(rng.integers(1, 12)):
            row, column, side = *rng.integers(0, SIDE, 2), rng.integers(1, 120)
            values[row : row + side, column : column + side] += rng.uniform(-rough, rough)
        path = rasters.write(tmp_path / f"{trial}.tif", values[np.newaxis], UTM, 32618, data_type=gdal.GDT_Float32)
        width, height = rng.uniform(5.0, 500.0, 2)
        # The grid is turned against north by 1.3 degrees: of a flatter box the south would be above the north.
        height = max(height, width / 20.0)
        west, north = rng.uniform(250.0, 750.0 - np.array([width, height]))
        area = box(west, north + height, west + width, north)
        if trial % 4 == 0:
            corners = ("west_deg", "north_deg"), ("west_deg", "south_deg"), ("east_deg", "south_deg")
            area = Polygon((tuple((getattr(area, lon), getattr(area, lat)) for lon, lat in corners),))
        along, across = rng.choice([0.0, 0.3, 0.6, 0.85], 2)
        above = rng.choice(["ground", "takeoff"])
        tilt, yaw = rng.choice([0.0, 0.0, 20.0, 45.0]), rng.choice([0.0, 90.0, 135.0])
        made = flown(
            Mission(
                area,
                160.0,
                elevation=(str(path),),
                overlap_along=float(along),
                overlap_across=float(across),
                height_above=str(above),
                tilt_deg=float(tilt),
                yaw_deg=float(yaw),
            )
        )
        assert made.coverage.complete
        rounding = 1.0 / np.minimum(made.windows.width_px, made.windows.height_px).min()
        for least, asked in ((made.overlap.least_along, along), (made.overlap.least_across, across)):
            assert least is None or least >= asked - rounding


@pytest.mark.parametrize("tilt_deg", sampled([80.0, pytest.param(85.0, marks=pytest.mark.thorough)], 3))
def test_cameras_that_look_far_ahead_stand_over_the_relief_there(tmp_path, tilt_deg):
    """Their images show the area from beyond what images straight down would see of its surroundings."""
    x, y = np.meshgrid(np.arange(SIDE), np.arange(SIDE))
    path = rasters.write(
        tmp_path / "wide.tif",
        (20.0 * np.sin(x / 9.0) * np.cos(y / 7.0))[np.newaxis],
        (WEST - 10_000.0, 40.0, 0.0, NORTH + 10_000.0, 0.0, -40.0),
        32618,
        data_type=gdal.GDT_Float32,
    )
    made = flown(Mission(AREA, 90.0, elevation=(str(path),), tilt_deg=tilt_deg))
    assert made.coverage.complete
    assert made.lat_deg.max() < AREA.south_deg
    assert made.height_m - made.ground_m == pytest.approx(90.0)


def test_polygons_and_wind_go_over_relief(dem):
    ring = ((AREA.west_deg, AREA.north_deg), (AREA.west_deg, AREA.south_deg), (AREA.east_deg, AREA.south_deg))
    asked = {"overlap_along": 0.4, "overlap_across": 0.4, "elevation": (dem["hills"],)}
    still = flown(Mission(Polygon((ring,)), 90.0, **asked))
    windy = flown(Mission(Polygon((ring,)), 90.0, wind=Wind(6.0, 250.0, 0.2), **asked))
    assert len(still) == len(windy)
    moved = windy.height_m - still.height_m
    assert 0.01 < np.abs(moved).max() < 20.0
    assert windy.nominal.agl_m == pytest.approx(still.agl_m)


def test_corners_and_outlines_lie_on_the_relief(dem):
    made = flown(Mission(AREA, 90.0, tilt_deg=35.0, elevation=(dem["hills"],)))
    lat, lon = made.corners.lat_deg.ravel(), made.corners.lon_deg.ravel()
    x, y = TO_UTM.transform(lon, lat)
    for index in range(0, len(made), 7):
        part = slice(4 * index, 4 * index + 4)
        seen = seen_by_one(made, index, lat[part], lon[part], hills(x[part] - WEST, NORTH - y[part]))
        assert np.abs(seen) == pytest.approx(1.0, abs=1e-3)
    ring = made.views.outline(3)
    assert len(ring.lat_deg) == 64
    lon_ring = made.lon_deg[3] + ring.dlon_deg
    x, y = TO_UTM.transform(lon_ring, ring.lat_deg)
    seen = seen_by_one(made, 3, ring.lat_deg, lon_ring, hills(x - WEST, NORTH - y))
    assert seen == pytest.approx(ring.image_xy, abs=1e-3)


def seen_by_one(made, index, lat, lon, height_m):
    """Image points (n, 2) of ground points, from -1 to 1, by geocentric coordinates."""
    points = np.stack(GEOCENTRIC.transform(lon, lat, height_m), axis=-1)
    camera = np.array(GEOCENTRIC.transform(made.lon_deg[index], made.lat_deg[index], made.height_m[index]))
    phi, lam = np.radians(made.lat_deg[index]), np.radians(made.lon_deg[index])
    east = np.array([-np.sin(lam), np.cos(lam), 0.0])
    up = np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
    vectors = (points - camera) @ np.stack([east, np.cross(up, east), up], axis=1)
    found, _ = made.mission.camera.image_xy(
        vectors[np.newaxis], *(angle[index : index + 1] for angle in made.poses.attitude)
    )
    return found[0]


def most_outside(made, lat, lon, height_m):
    """How far the points (n,) lie outside all images at most, as a share of half an image's side."""
    least = np.full(len(lat), np.inf)
    for index in range(len(made)):
        seen = seen_by_one(made, index, lat, lon, height_m)
        least = np.minimum(least, np.maximum(np.abs(seen).max(axis=1) - 1.0, 0.0))
    return float(least.max())


@pytest.mark.parametrize(
    ("azimuth", "tilt", "yaw", "roll"),
    sampled([(90.0, 45.0, 40.0, 0.0), (25.0, 40.0, 200.0, 0.0), (90.0, 0.0, 300.0, 48.0)], 2),
)
@pytest.mark.parametrize("shape", ["box", "polygon", pytest.param("several", marks=pytest.mark.thorough)])
def test_cameras_that_look_aside_show_the_lowest_ground_of_the_area_too(dem, azimuth, tilt, yaw, roll, shape):
    """From the roofs' height the rows reach the area's edge, but streets lie farther aside."""
    whole = box(450.0, 480.0, 520.0, 400.0)
    west, south, east, north = whole.edges_deg
    triangle = Polygon((((west, south), (east, south), (west, north)),))
    west, south, east, north = box(560.0, 480.0, 600.0, 440.0).edges_deg
    square = Polygon((((west, south), (east, south), (east, north), (west, north)),))
    area = {"box": whole, "polygon": triangle, "several": Polygons((triangle, square))}[shape]
    made = flown(
        Mission(
            area,
            40.0,
            Camera(60.0, 4 / 3),
            elevation=("0",),
            surface=(dem["town"],),
            tilt_deg=tilt,
            yaw_deg=yaw,
            roll_deg=roll,
            row_azimuth_deg=azimuth,
            overlap_along=0.1,
            overlap_across=0.1,
        )
    )
    assert made.coverage.complete
    x, y = (at.ravel() for at in np.meshgrid(np.arange(401.0, 640.0, 2.0), np.arange(361.0, 560.0, 2.0)))
    lon, lat = TO_UTM.transform(WEST + x, NORTH - y, direction="INVERSE")
    inside = area_contains(area, lat, lon)
    assert inside.sum() > 400
    assert most_outside(made, lat[inside], lon[inside], town(x[inside], y[inside])) < 1e-9


def test_what_no_image_holds_is_not_covered(dem):
    """Whatever the windows show: cameras here stand farther aside than the plan thought."""
    area = box(450.0, 480.0, 520.0, 400.0)
    made = flown(Mission(area, 40.0, Camera(60.0, 4 / 3), elevation=("0",), surface=(dem["town"],), tilt_deg=45.0))
    assert made.coverage.complete
    moved = replace(made, corners=made.corners, poses=made.poses._replace(lat_deg=made.lat_deg + 20.0 / 111e3))
    assert not moved.coverage.complete
    assert 0.0 < moved.coverage.uncovered_m2 < moved.coverage.area_m2


def test_the_synthetic_source_is_planned_over_a_file(dem):
    mission = Mission(AREA, 90.0, elevation=(dem["hills"],))
    made = plan(mission, named_source("world").grid, mission_heights(mission))
    assert not made.frames.on_map
    assert made.accuracy.relief
    assert made.accuracy.bound_px <= mission.accuracy.error_budget_px


def test_exports_for_drones_have_the_heights_that_their_programs_count(dem, tmp_path):
    """QGroundControl's from the take-off, Litchi's and Google Earth's from the ground below."""
    made = flown(Mission(AREA, 80.0, elevation=(dem["hills"],), height_above="takeoff"))
    write_plan(made, tmp_path / "one.plan")
    told = json.loads((tmp_path / "one.plan").read_text())["mission"]
    assert told["plannedHomePosition"][2] == pytest.approx(made.ground_m[0])
    altitudes = [item["params"][6] for item in told["items"] if item["command"] == 16]
    assert np.array(altitudes) + made.ground_m[0] == pytest.approx(made.height_m)
    assert np.ptp(altitudes) < 1e-6
    ((litchi,), *_) = (sorted(tmp_path.glob("*.csv")) for _ in [write_plan(made, tmp_path / "one.litchi.csv")])
    heights = [float(line.split(",")[2]) for line in litchi.read_text().splitlines()[1:]]
    assert np.array(heights) == pytest.approx(made.agl_m, abs=0.006)


def test_files_for_drones_follow_the_terrain_as_it_was_planned(dem, tmp_path):
    made = flown(Mission(AREA, 80.0, elevation=(dem["hills"],), overlap_along=0.6, overlap_across=0.4))
    write_plan(made, tmp_path / "one.kmz")
    read = Wpml(tmp_path / "one.kmz")
    above = made.height_m - made.ground_m[0]
    assert np.ptp(above) > 20.0
    assert [mark.height_m for mark in read.marks] == pytest.approx(above, abs=5e-4)
    marks = read.template.findall(read.path("Placemark"))
    assert [float(read.text(mark, "ellipsoidHeight")) for mark in marks] == pytest.approx(made.height_m, abs=1e-3)
    write_plan(made, tmp_path / "one.survey.plan")
    mission = json.loads((tmp_path / "one.survey.plan").read_text())["mission"]
    transects = checked(mission["items"][3])
    assert transects["FollowTerrain"] is True
    # QGroundControl keeps what was planned where the speed is the one that it is said to be for.
    assert transects["TerrainFlightSpeed"] == mission["hoverSpeed"]
    assert transects["CameraCalc"]["DistanceToSurface"] == 80.0
    assert [height for _, _, height, _ in photos(transects["Items"])] == pytest.approx(above)


def test_figures_say_what_is_below_a_flight_and_how_near_it_comes(dem):
    asked = {"elevation": (dem["tower"],), "height_above": "ellipsoid", "clearance_distance_m": 30.0}
    made = flown(Mission(AREA, 190.0, **asked))
    found = estimate(made)
    x, y = TO_UTM.transform(made.lon_deg, made.lat_deg)
    below = tower(x - WEST, NORTH - y)
    assert found.lowest_ground_m == pytest.approx(below.min(), abs=0.5)
    assert found.highest_ground_m == pytest.approx(below.max(), abs=0.5)
    # Everything within the area and an image's reach beyond it, cell by cell.
    surface = made.relief.heights.surface.surface(*made.corners[:2])
    seen = surface.heights_m[np.isfinite(surface.heights_m)]
    per_m = made.mission.camera.ground_size_m(1.0)[0] / made.frames.largest_px[0]
    assert found.finest_gsd_m_per_px == pytest.approx((190.0 - seen.max()) * per_m, rel=0.02)
    assert found.coarsest_gsd_m_per_px == pytest.approx((190.0 - seen.min()) * per_m, rel=0.02)
    column, row = surface.position(made.lat_deg, made.lon_deg)
    i, j = np.indices(surface.heights_m.shape)
    cell = 30.0 / 2.0
    nearest = [190.0 - surface.heights_m[np.hypot(i - r, j - c) <= cell].max() for c, r in zip(column, row)]
    # All within a square that holds the circle count.
    assert found.clearance_m <= min(nearest) + 1e-6
    assert found.clearance_m == pytest.approx(min(nearest), abs=3.0)
    labels = dict(found.lines())
    assert f"{found.clearance_m:,.1f} m clear" in labels["ground below"]
    assert estimate(plan(Mission(AREA, 90.0), GRID)).clearance_m is None


@pytest.mark.parametrize("values", sampled([{}, {"tilt_deg": 35.0, "yaw_deg": 30.0}], 2), ids=["down", "aside"])
def test_ground_that_relief_hides_from_all_images_is_told(dem, values):
    """Against a walk from each of many points towards each camera, through the file's own cells."""
    asked = {"elevation": (dem["town"],), "overlap_along": 0.0, "overlap_across": 0.0}
    made = flown(Mission(AREA, 90.0, **asked, **values))
    rng = np.random.default_rng(5)
    lat = rng.uniform(AREA.south_deg, AREA.north_deg, 3000)
    lon = rng.uniform(AREA.west_deg, AREA.east_deg, 3000)
    x, y = TO_UTM.transform(lon, lat)
    cells = gdal.Open(dem["town"]).ReadAsArray()

    def height(x, y):
        column, row = (x - WEST) / 2.0 - 0.5, (NORTH - y) / 2.0 - 0.5
        j, i = np.floor(column).astype(int), np.floor(row).astype(int)
        dx, dy = column - j, row - i
        upper, lower = (cells[at, j] * (1 - dx) + cells[at, j + 1] * dx for at in (i, i + 1))
        return upper * (1 - dy) + lower * dy

    ground = height(x, y)
    held, seen = np.zeros(len(lat), bool), np.zeros(len(lat), bool)
    for index in range(len(made)):
        inside = seen_by(made, lat, lon, ground, only=[index]) > 0
        held |= inside
        at = np.flatnonzero(inside & ~seen)
        camera_x, camera_y = TO_UTM.transform(made.lon_deg[index], made.lat_deg[index])
        free = np.ones(len(at), bool)
        for share in np.arange(0.002, 0.5, 0.002):
            on = [(1 - share) * p[at] + share * c for p, c in ((x, camera_x), (y, camera_y))]
            free &= height(*on) <= (1 - share) * ground[at] + share * made.height_m[index] + 0.2
        seen[at[free]] = True
    hidden = (held & ~seen).mean()
    found = estimate(made)
    assert hidden > 0.02
    assert found.hidden_share == pytest.approx(hidden, abs=0.008)
    assert f"relief hides about {100 * found.hidden_share:.1f} %" in dict(found.lines())["coverage"]


def test_points_and_images_are_paired_in_steps(dem):
    """Steps list no pair twice, and miss no image near a point."""
    made = flown(Mission(AREA, 90.0, elevation=(dem["town"],), tilt_deg=50.0))
    rng = np.random.default_rng(5)
    lat = rng.uniform(AREA.south_deg, AREA.north_deg, 100)
    lon = rng.uniform(AREA.west_deg, AREA.east_deg, 100)
    ground = np.full(len(lat), float(np.median(made.ground_m)))
    candidates = modelled._Candidates.near(lat, lon, made.poses, made.corners)
    steps = ((0, 2), (2, 7), (7, len(made)))
    pairs = [
        (int(point), int(camera))
        for first, last in steps
        for some in candidates.pairs(np.arange(len(lat)), first, last)
        for point, camera in zip(*some)
    ]
    assert len(set(pairs)) == len(pairs)
    for index in range(len(made)):
        held = np.flatnonzero(seen_by(made, lat, lon, ground, only=[index])).tolist()
        assert {(at, index) for at in held} <= set(pairs)


# --- the path between captures


def along(path, surface=hills, step_m=0.5):
    """Heights of the path and of a surface below it, at places along it, without the ways up and down at home."""
    x, y = TO_UTM.transform(path.lon_deg, path.lat_deg)
    x, y, z = x - WEST, NORTH - y, path.height_m
    parts = []
    for at in range(len(path) - 1):
        if np.hypot(x[at + 1] - x[at], y[at + 1] - y[at]) < 0.01:
            continue
        share = np.linspace(0.0, 1.0, int(np.hypot(x[at + 1] - x[at], y[at + 1] - y[at]) / step_m) + 2)
        parts.append([values[at] + share * (values[at + 1] - values[at]) for values in (x, y, z)])
    east, south, height = (np.concatenate(values) for values in zip(*parts))
    return height, surface(east, south)


def ends_of(path):
    """What a path has of its captures alone."""
    return {name: values[path.capture >= 0] for name, values in vars(path).items() if isinstance(values, np.ndarray)}


def test_legs_between_captures_keep_nine_tenths_of_the_height_over_hills(dem):
    # From slope to slope, with a summit between them.
    west, east = box(500.0, 440.0, 501.0, 439.0), box(900.0, 440.0, 901.0, 439.0)
    points = Points(tuple((place.south_deg, place.west_deg, 40.0) for place in (west, east)))
    mission = Mission(points, 40.0, CAMERA, elevation=(dem["hills"],))
    straight = flown(mission)
    height, ground = along(replace(straight.path, **ends_of(straight.path)))
    assert (height - ground).min() < 10.0
    for made in (straight, flown(mission.replace(lead_in_m=10.0))):
        height, ground = along(made.path)
        assert (height - ground).min() >= 0.9 * 40.0 - 0.1
        assert made.path.agl_m[made.path.capture < 0].max() < 45.0


def test_legs_keep_the_clearance_over_a_tower(dem):
    where = box(380.0, 560.0, 620.0, 440.0)
    mission = Mission(
        where,
        60.0,
        CAMERA,
        elevation=(dem["tower"],),
        clearance_m=15.0,
        clearance_distance_m=6.0,
        lead_in_m=5.0,
    )
    height, surface = along(flown(mission).path, tower)
    assert (height - surface).min() >= 15.0 - 0.2


def test_the_way_from_a_valley_is_flown_over_the_highest_ground_on_it(dem):
    home = box(300.0, 850.0, 301.0, 849.0)
    takeoff = (home.north_deg, home.west_deg)
    made = flown(Mission(AREA, 40.0, CAMERA, elevation=(dem["hills"],), takeoff=takeoff))
    path = made.path
    x, y = TO_UTM.transform(takeoff[1], takeoff[0])
    assert path.base_m == pytest.approx(hills(x - WEST, NORTH - y), abs=0.05)
    assert path.height_m[[0, -1]] == pytest.approx(path.base_m)
    ways = [path.sortie_path(0).kind.tolist().index(3), len(path) - 1 - path.kind[::-1].tolist().index(3)]
    for way in (slice(0, ways[0]), slice(ways[1] + 1, None)):
        height = path.height_m[way]
        # One height from above the take-off to above the rows.
        assert np.ptp(height[height > path.base_m + 1.0]) < 1e-6
    height, ground = along(path)
    assert (height - ground).min() >= 0.9 * 40.0 - 0.1
    assert made.path.agl_m[path.capture >= 0] == pytest.approx(40.0)


def test_a_take_off_without_ground_is_refused(dem):
    with pytest.raises(InvalidInput, match=r"no height at latitude 38\.0"):
        _ = flown(Mission(AREA, 80.0, CAMERA, elevation=(dem["hills"],), takeoff=(38.0, -77.0))).path


def test_heights_of_the_landscape_are_the_same_beside_imagery_in_any_crs():
    """A dataset states the CRS of its imagery, which is none that the landscape has."""
    lat, lon = np.array([38.81]), np.array([-77.05])
    found = []
    for crs in ("", "EPSG:32618"):
        mission = Mission(Box(38.811, -77.051, 38.81, -77.05), 90.0, source="ortho.tif", crs=crs, elevation=("world",))
        for options in (None, SourceOptions(seed=mission.imagery.seed, crs=crs)):
            below = mission_heights(mission, options).surface.surface(lat, lon)
            found.append(float(below.heights(*below.position(lat, lon))[0]))
    assert len(set(found)) == 1
    # The landscape itself about a pole, where its imagery and its heights are of one chart.
    polar = Mission(Points(((89.9, 10.0, 90.0),)), 90.0, source="world", crs="EPSG:3413", elevation=("world",))
    below = mission_heights(polar).surface.surface(np.array([89.9]), np.array([10.0]))
    assert np.isfinite(below.heights(*below.position(np.array([89.9]), np.array([10.0])))).all()
