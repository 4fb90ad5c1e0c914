"""The report's own reference camera against the one at 50 digits, and what it finds of the methods' errors."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.footprint import exact
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report.positions import errors_px, floor_px, footprint_errors_px, mesh_errors

from tests.core.geodesy.reference import see

ONE = np.array([0.0])
PLACES = [
    # latitude, height above ground, yaw, tilt, roll, height of the ground
    (35.14, 120.0, 0.0, 0.0, 0.0, 0.0),
    (-79.9, 3.0, 200.0, 10.0, -5.0, 0.0),
    (35.14, 120.0, 30.0, 60.0, 12.0, 1500.0),
    (51.0, 16e3, 301.0, 70.0, 0.0, -400.0),
    (40.1, 8e6, 0.0, 0.0, 0.0, 0.0),
]


def scene(place, camera=Camera()):  # noqa: B008 - frozen
    lat, agl, yaw, tilt, roll, ground_m = place
    poses = Poses.from_attitude(ONE + lat, ONE, ONE + agl, yaw, tilt, roll)
    return ImageGeometry(camera, 640.0, 480.0, poses, WGS84.raised(ground_m))


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("camera", [Camera(), Camera(100.0, 0.5)])
def test_points_that_the_50_digit_camera_sees_are_seen_where_it_sees_them(place, camera):
    one = scene(place, camera)
    lat, agl, *attitude, ground_m = place
    checked = 0
    for x, y in ((0.0, 0.0), (-0.3, -0.4), (0.2, -0.5), (-0.1, 0.1), (0.25, 0.2)):
        seen = see(lat, agl, camera.fov_deg, camera.aspect_ratio, *attitude, x, y, ground_m)
        if seen is None:
            continue
        points = (np.array([[float(value)]]) for value in (*seen[:2], x, y))
        # Degrees in float64 round the ground by some nanometres.
        rounding_px = 4e-9 / float(one.nadir_px_m[0])
        assert errors_px(one, *points)[0, 0] <= 10.0 * rounding_px + 10.0 * floor_px(one)
        checked += 1
    assert checked >= 3


def test_an_error_of_a_pixel_is_found_as_one():
    place = PLACES[0]
    one = scene(place)
    seen = see(*place[:2], 78.8, 4 / 3, 0.0, 0.0, 0.0, 0.25, -0.5)
    lat, dlon = (np.array([[float(value)]]) for value in seen[:2])
    away = errors_px(one, lat, dlon, np.array([[0.25 + 2.0 / 640.0]]), np.array([[-0.5]]))
    assert away[0, 0] == pytest.approx(1.0, abs=1e-6)
    away = errors_px(one, lat, dlon, np.array([[0.25 - 6.0 / 640.0]]), np.array([[-0.5 + 8.0 / 480.0]]))
    assert away[0, 0] == pytest.approx(5.0, abs=1e-6)


def test_points_behind_the_camera_have_no_place_in_the_image():
    one = scene((35.14, 120.0, 0.0, 85.0, 0.0, 0.0))
    south = np.array([[35.04]])
    assert np.isinf(errors_px(one, south, np.zeros((1, 1)), np.zeros((1, 1)), np.zeros((1, 1)))[0, 0])


def test_the_floor_is_far_below_what_is_measured():
    for place in PLACES:
        limit = 1e-6 if np.finfo(np.longdouble).nmant >= 63 else 1e-4
        assert 0.0 < floor_px(scene(place)) < limit


@pytest.mark.parametrize(
    "camera", [Camera(k1=-0.25, k2=0.08, p1=2e-3), Camera(120.0, lens="fisheye", k1=0.01)], ids=["barrel", "fisheye"]
)
def test_meshes_and_corners_of_distorted_images_are_within_their_bounds(camera):
    source = open_source("world")
    mission = Mission(Box(35.13, -89.86, 35.126, -89.856), 120.0, camera, tilt_deg=20.0)
    planned = plan(mission, source.grid)
    for tolerance_px in (0.1, 0.0):
        found = mesh_errors(planned, tolerance_px)
        assert len(found.errors_px) > 100
        assert found.errors_px.max() <= max(found.reached_px, 1e-6)
        assert found.reached_px <= tolerance_px
    assert footprint_errors_px(planned, exact).max() < 1e-6
