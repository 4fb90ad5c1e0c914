"""The camera's angles and directions, from their definitions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import CORNERS, Camera

fovs = st.floats(0.01, 179.9)
ratios = st.floats(1e-3, 1e3)
angles = st.floats(-180, 180)


def angle_deg(one, other):
    """Angle between two directions, stable for all."""
    return math.degrees(math.atan2(np.linalg.norm(np.cross(one, other)), np.dot(one, other)))


@given(fovs, ratios, angles, angles, angles)
def test_opposite_corners_are_the_diagonal_field_of_view_apart(fov, ratio, yaw, tilt, roll):
    rays = Camera(fov, ratio).rays_enu(CORNERS, yaw, tilt, roll)
    assert angle_deg(rays[0], rays[2]) == pytest.approx(fov, rel=1e-9)
    assert angle_deg(rays[1], rays[3]) == pytest.approx(fov, rel=1e-9)


@given(fovs, ratios)
def test_half_tangents_keep_ratio_and_diagonal(fov, ratio):
    tan_x, tan_y = Camera(fov, ratio).half_tangents
    assert tan_x / tan_y == pytest.approx(ratio, rel=1e-14)
    assert 2 * math.degrees(math.atan(math.hypot(tan_x, tan_y))) == pytest.approx(fov, rel=1e-12)


def test_the_height_survives_extreme_ratios():
    # sin and cos of atan(1e16) lose the height altogether: cos gives 6e-17 for 1e-16.
    _, tan_y = Camera(90.0, 1e16).half_tangents
    assert tan_y == pytest.approx(1e-16, rel=1e-15)


def test_the_papers_camera():
    camera = Camera(78.8, 4 / 3)
    # Diagonal 2·120·tan(39.4°) = 197.14 m, in the ratio 4 : 3 : 5.
    width, height = camera.ground_size_m(120.0)
    assert width == pytest.approx(0.8 * 240 * math.tan(math.radians(39.4)), rel=1e-14)
    assert height == pytest.approx(0.6 * 240 * math.tan(math.radians(39.4)), rel=1e-14)
    assert camera.horizontal_fov_deg == pytest.approx(66.62, abs=0.01)
    assert camera.vertical_fov_deg == pytest.approx(52.47, abs=0.01)
    assert 320.0 / camera.half_tangents[0] == pytest.approx(487.0, abs=0.1)


def test_attitude_is_an_aircrafts():
    camera = Camera(60.0, 1.0)
    centre, top, right = ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0))

    def look(point, **attitude):
        return camera.rays_enu((point,), **attitude)[0]

    np.testing.assert_allclose(look(centre), [0, 0, -1], atol=1e-15)
    assert look(top)[1] > 0  # the top of the image is north
    assert look(right)[0] > 0  # its right is east
    np.testing.assert_allclose(look(centre, yaw_deg=90.0, tilt_deg=90.0), [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(look(centre, tilt_deg=45.0), [0, 0.5**0.5, -(0.5**0.5)], atol=1e-15)
    # Rolled right side down, a camera that flies north looks to the west.
    assert look(centre, roll_deg=10.0)[0] == pytest.approx(-math.sin(math.radians(10.0)))


def test_rays_of_many_poses_are_those_of_each():
    camera = Camera(70.0, 1.5)
    yaw, tilt, roll = np.array([0.0, 40.0, 250.0]), np.array([0.0, 30.0, 80.0]), np.array([0.0, -3.0, 5.0])
    together = camera.rays_enu(CORNERS, yaw, tilt, roll)
    assert together.shape == (3, 4, 3)
    for index in range(3):
        alone = camera.rays_enu(CORNERS, float(yaw[index]), float(tilt[index]), float(roll[index]))
        np.testing.assert_array_equal(together[index], alone)


@pytest.mark.parametrize("fov", [0.0, -1.0, 180.0, 181.0, math.nan, math.inf])
def test_fields_of_view_outside_zero_to_180_are_refused(fov):
    with pytest.raises(InvalidInput, match=r"field of view .* between 0 and 180"):
        Camera(fov)


@pytest.mark.parametrize("ratio", [0.0, -1.0, math.nan, math.inf])
def test_ratios_that_are_not_positive_are_refused(ratio):
    with pytest.raises(InvalidInput, match="aspect ratio"):
        Camera(60.0, ratio)


# Fields of view whose diagonal stays clear of 180 degrees at ratios from 1 : 10 to 10 : 1.
side_fovs = st.floats(0.01, 170.0)
plain_ratios = st.floats(0.1, 10.0)


@given(side_fovs, plain_ratios)
def test_a_camera_by_a_side_has_that_side(fov, ratio):
    wide, tall = Camera.from_horizontal_fov(fov, ratio), Camera.from_vertical_fov(fov, ratio)
    # The complement of the diagonal, which the degrees hold to 3e-14, is 0.6 degrees at the least.
    assert wide.horizontal_fov_deg == pytest.approx(fov, rel=1e-12)
    assert tall.vertical_fov_deg == pytest.approx(fov, rel=1e-12)
    assert wide.aspect_ratio == tall.aspect_ratio == ratio


@given(fovs, plain_ratios)
def test_sides_and_diagonal_lead_to_each_other(fov, ratio):
    camera = Camera(fov, ratio)
    # As an angle: near 180 degrees its complement has but the digits that the sides' complements leave it.
    assert Camera.from_horizontal_fov(camera.horizontal_fov_deg, ratio).fov_deg == pytest.approx(fov, abs=1e-11)
    assert Camera.from_vertical_fov(camera.vertical_fov_deg, ratio).fov_deg == pytest.approx(fov, abs=1e-11)


@given(st.floats(1.0, 60.0), st.floats(1.0, 60.0), st.floats(1.0, 500.0))
def test_a_camera_by_its_sensor_is_the_pinhole_of_the_sensor(width_mm, height_mm, focal_length_mm):
    camera = Camera.from_sensor((width_mm, height_mm), focal_length_mm)
    # Half the picture is half the sensor, at the focal length.
    assert camera.half_tangents == pytest.approx(
        (width_mm / 2 / focal_length_mm, height_mm / 2 / focal_length_mm), rel=1e-12
    )


def test_full_frame_lenses_see_what_photographers_know():
    # 36 x 24 mm behind 50 mm: 46.8 degrees across, 39.6 along, 27.0 up.
    camera = Camera.from_sensor((36.0, 24.0), 50.0)
    assert camera.fov_deg == pytest.approx(46.8, abs=0.05)
    assert camera.horizontal_fov_deg == pytest.approx(39.6, abs=0.05)
    assert camera.vertical_fov_deg == pytest.approx(27.0, abs=0.05)


def test_the_picture_s_own_ratio_goes_before_the_rounded_sensor_s():
    camera = Camera.from_sensor((6.3, 4.7), 4.49, 4 / 3)
    assert camera.aspect_ratio == 4 / 3
    assert camera.fov_deg == Camera.from_sensor((6.3, 4.7), 4.49).fov_deg
    with pytest.raises(InvalidInput, match=r"sensor 36 by 24 mm .* 1\.778 to 1: pixels would not be square"):
        Camera.from_sensor((36.0, 24.0), 50.0, 16 / 9)


@given(fovs, plain_ratios, st.floats(0.01, 1e7), st.integers(1, 100_000))
def test_height_and_ground_sample_distance_lead_to_each_other(fov, ratio, agl_m, longer_side_px):
    camera = Camera(fov, ratio)
    gsd = camera.gsd_m_per_px(agl_m, longer_side_px)
    assert camera.agl_m(gsd, longer_side_px) == pytest.approx(agl_m, rel=1e-14)
    assert gsd * longer_side_px == pytest.approx(max(camera.ground_size_m(agl_m)), rel=1e-14)
    # Square pixels: the same along the shorter side.
    assert gsd * longer_side_px * min(ratio, 1 / ratio) == pytest.approx(min(camera.ground_size_m(agl_m)), rel=1e-13)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Camera.from_horizontal_fov(180.0), "horizontal field of view 180.0 deg: must be between"),
        (lambda: Camera.from_vertical_fov(math.nan), "vertical field of view nan deg"),
        (lambda: Camera.from_vertical_fov(0.0), "vertical field of view 0.0 deg"),
        (lambda: Camera.from_horizontal_fov(60.0, 0.0), "aspect ratio 0.0"),
        (lambda: Camera.from_horizontal_fov(60.0, math.inf), "aspect ratio inf"),
        (lambda: Camera.from_vertical_fov(179.9999999, 1e9), "across the diagonal 180 deg"),
        (lambda: Camera.from_sensor((0.0, 4.0), 5.0), "sensor 0.0 by 4.0 mm"),
        (lambda: Camera.from_sensor((6.0, math.inf), 5.0), "sensor 6.0 by inf mm"),
        (lambda: Camera.from_sensor((6.0, 4.0), 0.0), "focal length 0.0 mm"),
        (lambda: Camera.from_sensor((6.0, 4.0), 5.0, math.nan), "aspect ratio nan"),
    ],
)
def test_what_makes_no_camera_is_named(make, says):
    with pytest.raises(InvalidInput, match=says):
        make()
