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
    assert camera.focal_length_px(640) == pytest.approx(487.0, abs=0.1)


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
