"""Outlines of what cameras see, against the 50-digit camera and against counted pixels."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.footprint import exact, ground_corners, outline, poles_seen

from tests.core.geodesy.inverse import image_points
from tests.core.geodesy.reference import look
from tests.support.thinning import examples

CAMERA = Camera(78.8, 4 / 3)
SCENES = [
    (40.1, 120.0, (0.0, 0.0, 0.0)),
    (40.1, 120.0, (30.0, 85.0, 0.0)),
    (-70.0, 4e6, (20.0, 10.0, 5.0)),
    (40.1, 3.7e6, (0.0, 0.0, 0.0)),
    (40.1, 8e6, (0.0, 0.0, 0.0)),
    (0.0, 0.01, (200.0, 89.0, 10.0)),
    (89.99, 1e4, (0.0, 0.0, 0.0)),
    (35.0, 120.0, (0.0, 100.0, -20.0)),
]


def shoelace(x, y):
    """Area inside a ring, positive counter-clockwise."""
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2.0


@pytest.mark.parametrize(("lat", "agl", "attitude"), SCENES)
def test_vertices_are_seen_where_the_outline_says(lat, agl, attitude):
    ring = outline(CAMERA, lat, agl, attitude)
    assert shoelace(*ring.image_xy.T) > 0.0
    on_frame = np.abs(np.abs(ring.image_xy).max(axis=1) - 1.0) < 1e-9
    on_horizon = ring.horizon | np.roll(ring.horizon, 1)
    assert (on_frame | on_horizon).all()
    for index in range(0, len(ring.lat_deg), 5):
        # A point of the very horizon may count as hidden by its last digit.
        found = look(lat, agl, 78.8, 4 / 3, *attitude, ring.lat_deg[index], ring.dlon_deg[index])
        assert found is not None or on_horizon[index]
        if found is not None:
            np.testing.assert_allclose([float(c) for c in found], ring.image_xy[index], rtol=0, atol=1e-6)


@pytest.mark.parametrize(("lat", "agl", "attitude"), SCENES)
def test_the_outline_holds_the_pixels_that_see_ground(lat, agl, attitude):
    ring = outline(CAMERA, lat, agl, attitude)
    side = (np.arange(300) + 0.5) / 150.0 - 1.0
    x, y = (values.ravel() for values in np.meshgrid(side, side))
    one = Poses.from_attitude(np.array([lat]), np.zeros(1), np.array([agl]), *attitude)
    hit = exact(CAMERA, one, tuple(zip(x.tolist(), y.tolist()))).hit.mean()
    # An arc of 72 chords lacks a thousandth of its circle; the rest is the pixels on the edge.
    assert shoelace(*ring.image_xy.T) / 4.0 == pytest.approx(hit, abs=4e-3)


def test_from_very_high_it_is_the_visible_cap_inside_the_frustum():
    ring = outline(CAMERA, 40.1, 8e6)
    assert ring.pole == 1
    assert ring.horizon.sum() == len(ring.lat_deg) - 4 or ring.horizon.mean() > 0.9
    # At 8,000 km 59.3 % of the image is Earth.
    assert shoelace(*ring.image_xy.T) / 4.0 == pytest.approx(0.593, abs=2e-3)
    assert not ground_corners(CAMERA, Poses.level(np.array([40.1]), np.zeros(1), np.array([8e6]))).hit.any()


def test_a_whole_cap_has_the_area_it_should():
    agl = 3.6e7
    ring = outline(CAMERA, 0.0, agl)
    assert ring.horizon.all()
    assert ring.pole == 0
    cap = math.acos(6371e3 / (6371e3 + agl))
    area = 2 * math.pi * 6371e3**2 * (1 - math.cos(cap))
    assert WGS84.ring_area_m2(ring.dlon_deg, ring.lat_deg) == pytest.approx(area, rel=0.02)


@settings(max_examples=examples(150))
@given(
    st.floats(-90, 90),
    st.floats(2, 7.5),
    st.floats(0, 360),
    st.floats(0, 80),
    st.floats(-40, 40),
    st.floats(5, 150),
)
def test_poles_are_found_both_ways(lat, log_agl, yaw, tilt, roll, fov):
    camera, agl = Camera(fov, 1.2), 10.0**log_agl
    pose = Poses.from_attitude(np.array([lat]), np.zeros(1), np.array([agl]), yaw, tilt, roll)
    try:
        ring = outline(camera, lat, agl, (yaw, tilt, roll))
    except InvalidInput:
        return
    seen = int(poles_seen(camera, pose)[0])
    if seen != ring.pole:
        # Only where the pole lies on the outline itself, within what its chords leave out.
        pole = np.array([[90.0 if seen + ring.pole > 0 else -90.0]])
        at = image_points(camera, pose, pole, np.zeros((1, 1)))[0, 0]
        ways = np.hypot(*(ring.image_xy - at).T)
        assert ways.min() < 0.2


def test_cameras_that_look_at_the_sky_have_no_outline():
    with pytest.raises(InvalidInput, match="no ray of its image meets the Earth"):
        outline(CAMERA, 35.0, 120.0, (0.0, 130.0, 0.0))


@pytest.mark.parametrize("lat", [-70.0, 0.0, 40.1, 89.0])
def test_corners_beyond_the_earth_are_points_of_the_horizon(lat):
    pose = Poses.from_attitude(np.array([lat]), np.array([12.0]), np.array([3e5]), 40.0, 80.0, 5.0)
    corners = ground_corners(CAMERA, pose)
    assert (~corners.hit).any()
    assert corners.hit.any()
    assert np.isfinite(corners.lat_deg).all()
    radius = WGS84.b_m
    dip = math.acos(radius / (radius + 3e5))
    missed = ~corners.hit[0]
    for place_lat, place_lon in zip(corners.lat_deg[0][missed], corners.lon_deg[0][missed]):
        one, other = (
            np.array(
                [
                    math.cos(math.radians(a)) * math.cos(math.radians(b)),
                    math.cos(math.radians(a)) * math.sin(math.radians(b)),
                    math.sin(math.radians(a)),
                ]
            )
            for a, b in ((lat, 12.0), (place_lat, place_lon))
        )
        assert math.acos(float(one @ other)) == pytest.approx(dip, rel=0.02)
