"""Rays, radii and areas against 50-digit arithmetic and PROJ's geodesics."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import CORNERS, Camera
from terrainav.core.geodesy.ellipsoid import WGS84, Ellipsoid, trace

from tests.core.geodesy.reference import ground_point, zone_area_m2

METRES_PER_DEGREE = 111_320.0
# Float64 degrees resolve 1.6e-9 m of latitude; the exact camera may use three of those.
GROUND_FLOOR_M = 5e-9


def error_m(lat, dlon, exact):
    """Distance between a traced point and the reference, metres."""
    exact_lat, exact_dlon = exact
    north = float(exact_lat - lat) * METRES_PER_DEGREE
    east = float(exact_dlon - dlon) * METRES_PER_DEGREE * np.cos(np.radians(lat))
    return float(np.hypot(north, east))


@pytest.mark.parametrize("lat", [0.0, -35.14, 47.5, 84.0, -89.9])
@pytest.mark.parametrize("agl", [3.0, 120.0, 16e3, 1e6])
def test_rays_meet_the_ground_where_fifty_digits_say(lat, agl):
    rays = Camera(78.8, 4 / 3).rays_enu(CORNERS, yaw_deg=33.0, tilt_deg=12.0, roll_deg=-4.0)
    ground = trace(np.array(lat), np.array(agl), rays)
    for index, ray in enumerate(rays):
        exact = ground_point(lat, agl, ray)
        assert ground.hit[index] == (exact is not None)
        if exact is not None:
            # The condition of the scene, at most the height over the footprint's distance, scales the floor.
            floor = GROUND_FLOOR_M * max(1.0, agl / 1e6)
            assert error_m(ground.lat_deg[index], ground.dlon_deg[index], exact) < floor


def test_a_ray_past_the_limb_is_a_miss_not_a_number():
    rays = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 1.0, -0.01], [0.0, 0.0, -1.0]])
    ground = trace(np.array(35.0), np.array(1000.0), rays)
    # The horizon of 1000 m is 1.01 degrees (0.0177) below level.
    assert ground.hit.tolist() == [False, False, False, True]
    assert np.isnan(ground.lat_deg[:3]).all()
    assert np.isnan(ground.dlon_deg[:3]).all()
    assert ground.lat_deg[3] == pytest.approx(35.0, abs=1e-13)


def test_ground_above_the_ellipsoid_is_hit_at_its_height():
    high = WGS84.raised(1500.0)
    ray = np.array([0.3, -0.2, -1.0])
    ground = trace(np.array(46.5), np.array(400.0), ray, high)
    geod = Geod(ellps="WGS84")
    _, _, distance = geod.inv(0.0, 46.5, float(ground.dlon_deg), float(ground.lat_deg))
    # 400 m above ground that lies 1500 m up: the offset seen from above is 400 m times the tangent, brought
    # down to the ellipsoid's scale.
    flat = 400.0 * np.hypot(0.3, 0.2) / (1 + 1500.0 / 6.38e6)
    assert distance == pytest.approx(flat, rel=1e-4)
    _, _, without = geod.inv(
        0.0, 46.5, *(float(v) for v in trace(np.array(46.5), np.array(1900.0), ray)[1::-1])
    )
    assert without > 4.5 * distance


@pytest.mark.parametrize(
    ("south", "north"), [(0, 90), (-90, 90), (35.115, 35.16), (84.9, 85.05), (-60, -59.999999), (10, 10)]
)
def test_zone_areas_are_the_closed_form(south, north):
    exact = float(zone_area_m2(south, north)) / 360.0
    measured = float(WGS84.zone_area_m2_per_deg(np.array(south), np.array(north)))
    assert measured == pytest.approx(exact, rel=1e-13, abs=1e-12)


def test_ring_areas_agree_with_geodesics_through_many_points():
    lon = np.array([-89.9, -89.8, -89.83, -89.86, -89.91])
    lat = np.array([35.2, 35.19, 35.1, 35.16, 35.11])
    steps = np.linspace(0, 1, 2000, endpoint=False)
    dense = [np.concatenate([c[i] + (c[(i + 1) % 5] - c[i]) * steps for i in range(5)]) for c in (lon, lat)]
    exact = abs(Geod(ellps="WGS84").polygon_area_perimeter(*dense)[0])
    assert WGS84.ring_area_m2(lon, lat) == pytest.approx(exact, rel=1e-9)


def test_radii_at_equator_and_pole():
    assert WGS84.normal_radius_m(np.array(0.0)) == pytest.approx(WGS84.a_m)
    polar = WGS84.a_m**2 / WGS84.b_m
    assert WGS84.normal_radius_m(np.array(90.0)) == pytest.approx(polar)
    assert WGS84.meridional_radius_m(np.array(90.0)) == pytest.approx(polar)
    assert WGS84.meridional_radius_m(np.array(0.0)) == pytest.approx(WGS84.b_m**2 / WGS84.a_m)


def test_an_impossible_ellipsoid_is_refused():
    with pytest.raises(InvalidInput, match="semi-axes"):
        Ellipsoid(1.0, 2.0)
