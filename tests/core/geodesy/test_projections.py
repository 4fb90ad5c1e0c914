"""Projections in metres: UTM against PROJ, and the conformal plane about a place."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod, Transformer
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.projections import NOISE_M, LocalPlane, UTMZone, utm_zone
from terrainav.core.geodesy.rectangles import common_sides, image_sides

from tests.core.geodesy.inverse import image_points

GEOD = Geod(ellps="WGS84")
RADIUS_M = 6.371e6
places = st.tuples(st.floats(-84, 84), st.floats(-180, 180), st.floats(-360, 360))


@pytest.mark.parametrize(
    ("lat", "lon", "epsg"),
    [
        (35.14, -89.86, 32616),
        (-35.0, 149.0, 32755),
        (0.0, -180.0, 32601),
        (0.0, 179.9999, 32660),
        (0.0, 180.0, 32601),
        (10.0, 6.0, 32632),
        (10.0, 5.999999, 32631),
        (60.0, 4.0, 32632),  # Norway
        (64.0, 4.0, 32631),
        (55.9, 4.0, 32631),
        (78.0, 8.9, 32631),  # Svalbard
        (78.0, 9.0, 32633),
        (78.0, 20.9, 32633),
        (78.0, 21.0, 32635),
        (78.0, 33.0, 32637),
        (78.0, 42.0, 32638),
        (84.5, 10.0, 32632),  # beyond: the zone of the longitude
    ],
)
def test_zones(lat, lon, epsg):
    assert utm_zone(lat, lon).epsg == epsg


@pytest.mark.parametrize("zone", [UTMZone(16, False), UTMZone(55, True)])
def test_positions_are_projs_and_come_back(zone):
    random = np.random.default_rng(1)
    lon = zone.central_meridian_deg + random.uniform(-6, 6, 50)
    lat = random.uniform(0, 84, 50) * (-1 if zone.south else 1)
    x, y = zone.forward(lon, lat)
    np.testing.assert_allclose(
        np.stack([x, y]), Transformer.from_crs(4326, zone.epsg, always_xy=True).transform(lon, lat), atol=1e-6
    )
    np.testing.assert_allclose(np.stack(zone.inverse(x, y)), [lon, lat], atol=1e-11)


@given(places, st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_there_and_back(place, x, y):
    plane = LocalPlane(*place)
    lat, lon = plane.inverse(np.array(x), np.array(y))
    assert plane.forward(lat, lon) == pytest.approx((x, y), abs=NOISE_M)
    assert abs(lon - place[1]) <= 180.0


@given(places, st.floats(0, 360), st.floats(1.0, 1e5))
def test_lengths_and_directions_from_the_middle_are_those_of_geodesics(place, azimuth, distance_m):
    lat, lon, angle = place
    plane = LocalPlane(*place)
    there_lon, there_lat, _ = GEOD.fwd(lon, lat, azimuth, distance_m)
    near = lon + (there_lon - lon + 180.0) % 360.0 - 180.0
    x, y = (float(values) for values in plane.forward(np.array(there_lat), np.array(near)))
    # Both are stretched by (r / 2R)² over three in the mean; the ellipsoid adds less than that.
    slack = (distance_m / RADIUS_M) ** 2 / 8.0
    assert math.hypot(x, y) == pytest.approx(distance_m, rel=slack, abs=NOISE_M)
    bearing = math.degrees(math.atan2(x, y)) + angle
    assert math.sin(math.radians(bearing - azimuth)) == pytest.approx(0.0, abs=slack + 2 * NOISE_M / distance_m)


@given(places, st.floats(-3e5, 3e5), st.floats(-3e5, 3e5), st.floats(0, 360))
def test_angles_are_kept(place, x, y, azimuth):
    plane = LocalPlane(*place)
    lat, lon = (float(values) for values in plane.inverse(np.array(x), np.array(y)))
    ends = [GEOD.fwd(lon, lat, azimuth + turn, 50.0) for turn in (0.0, 180.0)]
    (x1, y1), (x0, y0) = (
        plane.forward(np.array(end[1]), np.array(lon + (end[0] - lon + 180.0) % 360.0 - 180.0)) for end in ends
    )
    north = float(plane.north_deg(np.array(lat), np.array(lon)))
    off = math.degrees(math.atan2(x1 - x0, y1 - y0)) - north - azimuth
    assert (off + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1e-5)
    enlarged = math.hypot(x1 - x0, y1 - y0) / 100.0 - 1.0
    assert enlarged == pytest.approx((math.hypot(x, y) / 2.0 / RADIUS_M) ** 2, rel=0.03, abs=3e-9)


@pytest.mark.parametrize("attitude", [(0.0, 0.0, 0.0), (20.0, 0.0, 0.0), (0.0, 40.0, 0.0), (-70.0, 20.0, 15.0)])
def test_images_show_the_borders_of_their_rectangles(attitude):
    camera, plane = Camera(78.8, 1.5), LocalPlane(45.0, 179.9, 37.0)
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(-2e4, 2e4, 5), np.linspace(-2e4, 2e4, 5)))
    lat, lon = plane.inverse(x, y)
    yaw = attitude[0] - plane.north_deg(lat, lon)
    poses = Poses(lat, lon, np.full(25, 500.0), yaw, np.full(25, attitude[1]), np.full(25, attitude[2]))
    share = np.linspace(0, 1, 41)
    border = np.concatenate(
        [[share, 0 * share], [share, 0 * share + 1], [0 * share, share], [0 * share + 1, share]], axis=1
    )
    common, own = common_sides(camera, poses, plane), image_sides(camera, poses, plane)
    for left, bottom, right, top in (
        tuple(place + side for place, side in zip((x, y, x, y), common)),
        tuple(own),
    ):
        across = left[:, np.newaxis] + (right - left)[:, np.newaxis] * border[0]
        up = bottom[:, np.newaxis] + (top - bottom)[:, np.newaxis] * border[1]
        seen = image_points(camera, poses, *plane.inverse(across, up))
        assert np.abs(seen).max() <= 1.0 + 1e-9
        # As large as it can be: some side touches its image's.
        assert np.abs(seen).max(axis=(1, 2)).min() > 0.98
    if attitude == (0.0, 0.0, 0.0):
        width, height = camera.ground_size_m(500.0)
        assert common.size_m == (pytest.approx([width], rel=1e-4), pytest.approx([height], rel=1e-4))
