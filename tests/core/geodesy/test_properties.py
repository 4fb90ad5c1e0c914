"""Inverse pairs, symmetries and monotonicity."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pyproj import Geod
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84, limb, sight_lines, trace
from terrainav.core.geodesy.mercator import (
    lat_to_v,
    lon_to_u,
    u_to_lon,
    v_to_lat,
    wrap_lon_deg,
)
from terrainav.core.geodesy.projections import UTMZone, utm_zone

from tests.core.geodesy import reference
from tests.support.thinning import examples

# The same examples every time: a failure here is a defect, never the luck of a draw.
EVERY_TIME = settings(derandomize=True, deadline=None)
FEW = settings(EVERY_TIME, max_examples=examples(40))

METRES_PER_DEGREE = 111_320.0
#: What the core states of its rays with any library within 4 units in the last place: shares of directions, 2⁻⁴⁶, and
#: 2e-9 m for the last digits of float64 degrees. From 10 km, 80 degrees off the vertical, a ray is 65 km long and meets
#: the ground at 7 degrees: 540 km over the sine of that are another 7.6e-9 m.
DIRECTION, SAME_PLACE_M = 2.0**-46, 1e-8

latitudes = st.floats(-90, 90)
heights = st.floats(-2, 4).map(lambda power: 10.0**power)
yaws = st.floats(-180, 180)
# Together at most 80 degrees off the vertical: away from the horizon, which lies at 86.8 from 10 km.
tilts, rolls = st.floats(-40, 40), st.floats(-20, 20)
cameras = st.builds(Camera, st.floats(0.01, 40), st.floats(-3, 3).map(lambda power: 10.0**power))
image = st.floats(-1, 1)


def see(camera, lat, agl, attitude, x, y, ground=WGS84):
    seen = trace(np.array([lat]), np.array([agl]), camera.rays_enu(((x, y),), *attitude), ground)
    return float(seen.lat_deg[0]), float(seen.dlon_deg[0]), bool(seen.hit[0])


def apart_m(one, other):
    """Metres between two places, (latitude, longitude), by 50 digits."""
    return float(reference.distance_m(one[:2], other[:2]))


@FEW
@given(cameras, latitudes, heights, yaws, tilts, rolls, image, image, st.floats(-400, 8000))
def test_the_reference_looks_back_along_the_ray(camera, lat, agl, yaw, tilt, roll, x, y, height):
    seen_lat, dlon, hit = see(camera, lat, agl, (yaw, tilt, roll), x, y, WGS84.raised(height))
    assert hit
    found = reference.look(lat, agl, camera.fov_deg, camera.aspect_ratio, yaw, tilt, roll, seen_lat, dlon, height)
    tan_x, tan_y = camera.half_tangents
    off = math.hypot(float(found[0] - mpmath.mpf(x)) * tan_x, float(found[1] - mpmath.mpf(y)) * tan_y)
    # The ground point's own resolution, seen from at least the height away, and that of the direction.
    assert off < 2e-9 / agl + DIRECTION * (1.0 + tan_x**2 + tan_y**2)


@given(cameras, yaws, st.floats(-180, 180), st.floats(-180, 180), image, image)
@EVERY_TIME
def test_image_points_come_back_from_their_rays(camera, yaw, tilt, roll, x, y):
    rays = camera.rays_enu(((x, y),), yaw, tilt, roll)
    points, in_front = camera.image_xy(rays, yaw, tilt, roll)
    assert in_front.all()
    # A direction holds 1e-16 of its length; a narrow image is that small a part of it.
    floor = 1e-15 / min(camera.half_tangents)
    np.testing.assert_allclose(points[0], [x, y], rtol=1e-14, atol=floor)
    assert not camera.image_xy(-rays, yaw, tilt, roll)[1].any()


@given(latitudes, heights, yaws, st.floats(0, 80))
@EVERY_TIME
def test_ground_points_come_back_from_their_sight_lines(lat, agl, yaw, tilt):
    seen_lat, dlon, hit = see(Camera(), lat, agl, (yaw, tilt, 0.0), 0.0, 0.0)
    assert hit
    line = sight_lines(np.array(lat), np.array(agl), np.array(seen_lat), np.array(dlon))
    # A sight line is good to the last digits of degrees across; along shallow ground that is six times as far.
    again = trace(np.array(lat), np.array(agl), line)
    assert apart_m((float(again.lat_deg), float(again.dlon_deg)), (seen_lat, dlon)) < SAME_PLACE_M


@given(cameras, latitudes, heights, yaws, tilts, rolls, image, image)
@EVERY_TIME
def test_east_mirrors_west(camera, lat, agl, yaw, tilt, roll, x, y):
    east = see(camera, lat, agl, (yaw, tilt, roll), x, y)
    west = see(camera, lat, agl, (-yaw, tilt, -roll), -x, y)
    assert east[2]
    assert west[2]
    assert apart_m(east, (west[0], -west[1])) < SAME_PLACE_M


@given(cameras, latitudes, heights, yaws, tilts, rolls, image, image)
@EVERY_TIME
def test_north_mirrors_south(camera, lat, agl, yaw, tilt, roll, x, y):
    north = see(camera, lat, agl, (yaw, tilt, roll), x, y)
    south = see(camera, -lat, agl, (180.0 - yaw, tilt, -roll), -x, y)
    assert north[2]
    assert south[2]
    # 180 - yaw is rounded to 1.4e-14 degrees: 2.5e-16 of the distance.
    assert apart_m(north, (-south[0], south[1])) < 2 * SAME_PLACE_M


@pytest.mark.parametrize(("pole", "sense"), [(90.0, -1.0), (-90.0, 1.0)])
@EVERY_TIME
@given(heights, yaws, st.floats(-180, 180), st.floats(0, 70), image, image)
def test_turning_at_a_pole_turns_the_longitude(pole, sense, agl, yaw, turn, tilt, x, y):
    camera = Camera(20.0, 1.0)
    before = see(camera, pole, agl, (yaw, tilt, 0.0), x, y)
    after = see(camera, pole, agl, (yaw + turn, tilt, 0.0), x, y)
    assert apart_m((before[0], before[1] + sense * turn), after) < 2 * SAME_PLACE_M


@given(latitudes, heights, yaws, st.floats(0, 90), st.floats(0, 90))
@EVERY_TIME
def test_farther_from_straight_down_is_farther_on_the_ground(lat, agl, yaw, one, other):
    near, far = sorted((one, other))
    # 1e-4 degrees at 1 cm are 17 nm, five times what degrees resolve.
    assume(far - near > 1e-4)
    spots = [see(Camera(), lat, agl, (yaw, tilt, 0.0), 0.0, 0.0) for tilt in (near, far)]
    assume(spots[1][2])
    assert spots[0][2], "a steeper ray misses where a shallower one hits"
    # The chord from below the camera grows along one azimuth as long as the ray does.
    assert apart_m((lat, 0.0), spots[0]) < apart_m((lat, 0.0), spots[1])


@given(latitudes, heights, st.floats(1e-3, 10), yaws, st.floats(1, 80))
@EVERY_TIME
def test_higher_is_farther_on_the_ground(lat, agl, growth, yaw, tilt):
    low, high = (see(Camera(), lat, h, (yaw, tilt, 0.0), 0.0, 0.0) for h in (agl, agl * (1 + growth)))
    assert low[2]
    assume(high[2])
    step = agl * growth * math.tan(math.radians(tilt))
    assume(step > SAME_PLACE_M)
    assert apart_m((lat, 0.0), low) < apart_m((lat, 0.0), high)


@given(st.floats(-80, 80), heights, yaws, st.floats(1, 60))
@EVERY_TIME
def test_the_ground_is_geodesics_away_in_the_direction_of_the_view(lat, agl, yaw, tilt):
    seen_lat, dlon, hit = see(Camera(), lat, agl, (yaw, tilt, 0.0), 0.0, 0.0)
    assert hit
    azimuth, _, metres = Geod(ellps="WGS84").inv(0.0, lat, dlon, seen_lat)
    flat = agl * math.tan(math.radians(tilt))
    # The ground curves away under 20 km by up to s²·tan/2R.
    assert metres == pytest.approx(flat, rel=2e-8 + flat * math.tan(math.radians(tilt)) / 6.2e6, abs=SAME_PLACE_M)
    turn = (azimuth - yaw + 180.0) % 360.0 - 180.0
    assert abs(math.radians(turn)) * metres < SAME_PLACE_M + 1e-8 * metres


@FEW
@given(latitudes, st.floats(-2, 7.5).map(lambda power: 10.0**power), yaws)
def test_sight_lines_to_the_limb_graze_the_ground(lat, agl, azimuth):
    towards = np.array([math.sin(math.radians(azimuth)), math.cos(math.radians(azimuth)), 0.0])
    edge = limb(np.array(lat), np.array(agl), towards)
    point = float(edge.lat_deg), float(edge.dlon_deg)
    slant, grazing = map(float, reference.slant_and_grazing(lat, agl, point))
    # A point of the limb moved by its resolution turns the sight line against the ground by that over the Earth's
    # radius and, across it, over the slant range times the angle of the two.
    assert abs(grazing) < SAME_PLACE_M / slant + 1e-14


@given(st.floats(0, 1))
@EVERY_TIME
def test_world_fractions_come_back(fraction):
    assert float(lon_to_u(u_to_lon(np.array(fraction)))) == pytest.approx(fraction, abs=3e-16)
    assert float(lat_to_v(v_to_lat(np.array(fraction)))) == pytest.approx(fraction, abs=5e-15)


@given(st.floats(-90, 90), st.floats(-90, 90))
@EVERY_TIME
def test_northern_places_lie_above_southern_ones(one, other):
    south, north = sorted((one, other))
    assert float(lat_to_v(np.array(north))) <= float(lat_to_v(np.array(south)))
    assert float(lat_to_v(np.array(-north))) == pytest.approx(1.0 - float(lat_to_v(np.array(north))))


@given(st.floats(-1e6, 1e6))
@EVERY_TIME
def test_wrapping_twice_is_wrapping_once(lon):
    once = wrap_lon_deg(np.array(lon))
    assert -180.0 <= once < 180.0
    assert wrap_lon_deg(once) == once


@given(st.floats(-80, 84), st.floats(-180, 180, exclude_max=True))
@EVERY_TIME
def test_utm_positions_come_back(lat, lon):
    zone = utm_zone(lat, lon)
    x, y = zone.forward(np.array(lon), np.array(lat))
    back_lon, back_lat = zone.inverse(x, y)
    turn = (float(back_lon) - lon + 180.0) % 360.0 - 180.0
    assert abs(turn) * METRES_PER_DEGREE * math.cos(math.radians(lat)) < 1e-7
    assert abs(float(back_lat) - lat) * METRES_PER_DEGREE < 1e-7


@given(st.integers(1, 60), st.booleans(), st.floats(1e5, 9e5), st.floats(1e5, 9.2e6))
@EVERY_TIME
def test_places_come_back_from_utm(number, south, x, y):
    zone = UTMZone(number, south)
    lon, lat = zone.inverse(np.array(x), np.array(y))
    assert np.hypot(*(np.array(zone.forward(lon, lat)) - [x, y])) < 1e-7


@given(st.floats(-80, 84), st.floats(-3, 3), st.floats(1, 10))
@EVERY_TIME
def test_easting_grows_eastward_and_mirrors_about_the_meridian(lat, dlon, more):
    zone = UTMZone(31, lat < 0)
    x, _ = zone.forward(3.0 + np.array([-dlon, 0.0, dlon, dlon + more]), np.full(4, lat))
    assert x[1] == pytest.approx(500_000.0, abs=1e-6)
    assert x[0] + x[2] == pytest.approx(1_000_000.0, abs=1e-6)
    assert x[3] > x[2]
