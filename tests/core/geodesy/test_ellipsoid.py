"""Rays, radii and areas against 50-digit arithmetic and PROJ's geodesics."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import CORNERS, Camera
from terrainav.core.geodesy.ellipsoid import WGS84, Ellipsoid, arctan2, sight_lines, trace

from tests.core.geodesy import longdouble, scenes
from tests.core.geodesy.reference import distance_m, ground_point, slant_and_grazing, zone_area_m2

#: What `trace` states: half the last digit of a latitude, and a share of slant over sine of incidence.
LATITUDE_FLOOR_M, RAY_SHARE = 0.8e-9, 2.0**-47


@pytest.mark.parametrize("lat", [0.0, -35.14, 47.5, 84.0, -89.9])
@pytest.mark.parametrize("agl", [3.0, 120.0, 16e3, 1e6])
def test_rays_meet_the_ground_where_fifty_digits_say(lat, agl):
    rays = Camera(78.8, 4 / 3).rays_enu(CORNERS, yaw_deg=33.0, tilt_deg=12.0, roll_deg=-4.0)
    ground = trace(np.array(lat), np.array(agl), rays)
    for index, ray in enumerate(rays):
        exact = ground_point(lat, agl, ray)
        assert ground.hit[index] == (exact is not None)
        if exact is not None:
            slant, grazing = slant_and_grazing(lat, agl, exact)
            found = float(ground.lat_deg[index]), float(ground.dlon_deg[index])
            assert distance_m(found, exact) < LATITUDE_FLOOR_M + RAY_SHARE * slant / grazing


@pytest.mark.skipif(not longdouble.EXTENDED, reason=longdouble.WHY_NOT)
@pytest.mark.parametrize("height", [0.0, 8848.0])
@pytest.mark.parametrize(
    "drawn",
    [scenes.whole_domain(31, 40_000), scenes.near_the_horizon(32, 5000, (1e-6, 1.0))],
    ids=["whole domain", "near the horizon"],
)
def test_rays_stay_within_what_trace_states(drawn, height):
    camera = drawn.fov_deg, drawn.aspect_ratio, *drawn[4:9]
    rays = np.stack(longdouble.image_ray(*camera), axis=-1).astype(np.float64)
    seen = longdouble.ground_point(drawn.lat_deg, drawn.agl_m, rays.T.astype(longdouble.Real), height)
    found = trace(drawn.lat_deg, drawn.agl_m, rays, WGS84.raised(height))
    both = found.hit & seen.hit
    assert (found.hit != seen.hit).mean() < 1e-3
    assert both.sum() > 1000
    drawn, lat, dlon = drawn.take(both), seen.lat_deg[both], seen.dlon_deg[both]
    slant, grazing = longdouble.slant_and_grazing(drawn.lat_deg, drawn.agl_m, lat, dlon, height)
    error = longdouble.distance_m(lat, dlon, found.lat_deg[both], found.dlon_deg[both])
    ratio = error / (LATITUDE_FLOOR_M + RAY_SHARE * slant / grazing)
    assert ratio.max() < 1.0, drawn.take(int(ratio.argmax()))
    back = sight_lines(drawn.lat_deg, drawn.agl_m, lat.astype(float), dlon.astype(float), WGS84.raised(height))
    # Both are rounded to float64 on the way: half a digit of the longitude, 1.6e-9 m, beside that of the latitude.
    off = np.linalg.norm(back - rays[both] * (slant / np.linalg.norm(rays[both], axis=-1))[:, np.newaxis], axis=-1)
    assert (off < 2e-9 + RAY_SHARE * slant).all()


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
    _, _, without = geod.inv(0.0, 46.5, *(float(v) for v in trace(np.array(46.5), np.array(1900.0), ray)[1::-1]))
    assert without > 4.5 * distance


@pytest.mark.parametrize(
    ("south", "north"),
    [(0, 90), (-90, 90), (35.115, 35.16), (84.9, 85.05), (-60, -59.999999), (10, 10), (70, 71), (70, 71.01)],
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


def test_angles_do_not_depend_on_where_arrays_lie_in_memory():
    rng = np.random.default_rng(0)
    both = rng.normal((0.0, 1.0), (1e-2, 1e-3), (256, 2))
    found, held = set(), []
    for length in rng.integers(1, 3000, 3000).tolist():
        held = [*held[-40:], np.empty(length)]
        parts = np.empty((256, 2, 2))
        parts[:, :, 1] = both
        found.add(arctan2(parts[:, 0, 1], parts[:, 1, 1]).tobytes())
    assert len(found) == 1
