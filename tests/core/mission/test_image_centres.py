"""Places, names and sizes of camera frames by their pose alone, against a ray in geocentric metres worked out here."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.labels import make_labels
from terrainav.core.dataset.table import Table
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.sources import PatternSource

GEOCENTRIC = Transformer.from_crs(4979, 4978, always_xy=True)
#: Of 5 m, 1 m and 0.3 m on the ground at 38.8 degrees, and a raster's own of 0.5 m in UTM.
COARSE, MIDDLE, FINE = (PixelGrid(native_zoom=zoom, max_zoom=zoom) for zoom in (14, 17, 19))
UTM = PixelGrid(native_zoom=15, max_zoom=15, plane=ProjectedPlane("EPSG:32618", 310_000.0, 4_310_000.0, 2**22, 2**22))
POSES = ((38.81, -77.05, 900.0), (38.83, -77.02, 914.0), (38.9, -77.06, 2700.0), (38.8, -77.01, 700.0))
YAW_DEG, TILT_DEG, ROLL_DEG = 40.0, 35.0, -8.0
LEANING = {"tilt_deg": TILT_DEG, "roll_deg": ROLL_DEG}


def mission_of(which=(0, 1, 2, 3), **values):
    """Mission of some of the poses, whose yaws are their own: from true north on every grid."""
    points = Points(tuple(POSES[at] for at in which), yaws_deg=(YAW_DEG,) * len(which))
    return Mission(points, 900.0, **{**LEANING, **values})


def coarse_source():
    """Tiles of `COARSE`."""
    source = PatternSource(())
    source.grid = COARSE
    return source


def rotation(axis, angle_deg):
    """Right-handed turn about a coordinate axis."""
    sine, cosine = math.sin(math.radians(angle_deg)), math.cos(math.radians(angle_deg))
    others = [at for at in range(3) if at != axis]
    turn = np.eye(3)
    turn[np.ix_(others, others)] = [[cosine, -sine], [sine, cosine]]
    if axis == 1:
        turn = turn.T
    return turn


def axis_on_ellipsoid(lat_deg, lon_deg, height_m, yaw_deg, tilt_deg, roll_deg, ground_m=0.0):
    """Latitude and longitude where the axis of a camera meets the WGS 84 ellipsoid, enlarged by a height."""
    # An aircraft's ahead, right and down, turned about each in the order z-y'-x''; its camera looks down.
    turn = rotation(2, yaw_deg) @ rotation(1, tilt_deg) @ rotation(0, roll_deg)
    north, east, down = turn @ (0.0, 0.0, 1.0)
    phi, lam = math.radians(lat_deg), math.radians(lon_deg)
    east_at = np.array([-math.sin(lam), math.cos(lam), 0.0])
    up_at = np.array([math.cos(phi) * math.cos(lam), math.cos(phi) * math.sin(lam), math.sin(phi)])
    ray = east * east_at + north * np.cross(up_at, east_at) - down * up_at
    start = np.array(GEOCENTRIC.transform(lon_deg, lat_deg, height_m))
    a = 6378137.0 + ground_m
    squeezed = np.array([1.0, 1.0, a / (6356752.314245179 + ground_m)])
    o, d = start * squeezed, ray * squeezed
    half, rest = o @ d, o @ o - a * a
    t = (-half - math.sqrt(half * half - (d @ d) * rest)) / (d @ d)
    lon, lat, _ = GEOCENTRIC.transform(*(start + t * ray), direction="INVERSE")
    return lat, lon


@pytest.mark.parametrize("grid", [COARSE, MIDDLE, FINE, UTM], ids=["5 m", "1 m", "0.3 m", "UTM"])
def test_the_place_of_a_camera_frame_is_where_its_axis_meets_the_ground(grid):
    made = plan(mission_of(), grid)
    wanted = [axis_on_ellipsoid(*pose, YAW_DEG, TILT_DEG, ROLL_DEG) for pose in POSES]
    np.testing.assert_allclose(np.transpose(made.frame_centres), wanted, rtol=0, atol=1e-9)


def test_the_table_and_labels_have_that_place_to_full_precision(tmp_path):
    source = coarse_source()
    capture(plan(mission_of(image_px=40), source.grid), source, tmp_path)
    wanted = np.array([axis_on_ellipsoid(*pose, YAW_DEG, TILT_DEG, ROLL_DEG) for pose in POSES])
    table = Table.load(tmp_path / "satellite" / "meta_data.csv")
    np.testing.assert_allclose(np.transpose([table.lat_deg, table.lon_deg]), wanted, rtol=0, atol=1e-9)
    with (tmp_path / "satellite" / "meta_data.csv").open(encoding="utf-8", newline="") as file:
        for row, (lat, lon) in zip(csv.DictReader(file), wanted.tolist()):
            assert (float(row["Lat"]), float(row["Lon"])) == pytest.approx((lat, lon), rel=0, abs=1e-9)
    labels = make_labels(table.lat_deg, table.lon_deg)
    utm = Transformer.from_crs(4326, 32618, always_xy=True)
    found = labels.scaler.inverse(labels.transform(table.lat_deg, table.lon_deg))
    np.testing.assert_allclose(found, np.transpose(utm.transform(*wanted.T[::-1])), rtol=0, atol=1e-3)


def test_one_pose_has_one_place_and_one_name_in_every_imagery():
    mission = mission_of()
    made = [plan(mission, grid) for grid in (COARSE, MIDDLE, FINE, UTM)]
    assert len({one.zoom for one in made}) > 2
    for one in made[1:]:
        assert one.names == made[0].names
        np.testing.assert_array_equal(one.frame_centres, made[0].frame_centres)


def test_of_an_image_of_the_horizon_the_place_is_in_the_part_that_shows_ground():
    made = [plan(mission_of([0], tilt_deg=85.0, roll_deg=0.0), grid) for grid in (FINE, UTM)]
    assert made[0].names == made[1].names
    lat, lon = (float(angle[0]) for angle in made[0].frame_centres)
    ahead = Transformer.from_crs(
        "EPSG:4326", f"+proj=aeqd +lat_0={POSES[0][0]} +lon_0={POSES[0][1]}", always_xy=True
    ).transform(lon, lat)
    assert 900.0 < math.hypot(*ahead) < 120e3
    assert math.degrees(math.atan2(*ahead)) == pytest.approx(YAW_DEG, abs=0.1)


@pytest.mark.parametrize("grid", [COARSE, UTM], ids=["5 m", "UTM"])
@pytest.mark.parametrize("wanted", [{"image_px": 4000}, {"gsd_m_per_px": 12.0}, {"zoom": 13}], ids=["", "gsd", "zoom"])
def test_the_size_of_an_image_does_not_depend_on_others_of_its_table(grid, wanted):
    def sizes(which):
        made = plan(mission_of(which, **wanted), grid)
        return list(zip(made.frames.width_px.tolist(), made.frames.height_px.tolist()))

    together = sizes(range(4))
    assert len(set(together)) == 4
    for which in ([0], [1], [2], [3], [3, 1], [2, 0, 1]):
        assert sizes(which) == [together[at] for at in which]


def test_images_of_one_pose_are_the_same_in_two_tables(tmp_path):
    def images(which, folder):
        source = coarse_source()
        capture(plan(mission_of(which, image_px=60), source.grid), source, folder)
        return {path.name: path.read_bytes() for path in folder.glob("*/*.tif")}

    alone, together = images([1], tmp_path / "one"), images([1, 2, 0], tmp_path / "three")
    assert len(together) == 3
    assert alone.items() <= together.items()


def test_images_of_a_flight_have_one_size_whatever_the_wind():
    box = Box(38.95, -77.1, 38.7, -77.09)
    calm = plan(Mission(box, 900.0, yaw_deg=YAW_DEG, **LEANING), COARSE)
    blown = plan(Mission(box, 900.0, wind=Wind(8.0, 250.0, 0.2), yaw_deg=YAW_DEG, **LEANING), COARSE)
    for made in (calm, blown):
        assert len({*zip(made.frames.width_px.tolist(), made.frames.height_px.tolist())}) == 1
    assert calm.frames.largest_px == blown.frames.largest_px
