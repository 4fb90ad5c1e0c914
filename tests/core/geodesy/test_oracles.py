"""The camera, areas and tiles against published values and against other software's projections."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pyproj import Geod, Proj
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84, Ellipsoid, sight_lines, trace
from terrainav.core.geodesy.mercator import (
    HALF_WORLD_M,
    lat_to_v,
    lon_to_u,
    u_to_lon,
    v_to_lat,
)

RADIUS_M = 6378137.0
SPHERE = Ellipsoid(RADIUS_M, RADIUS_M)


def dms(degrees, minutes, seconds):
    return degrees + minutes / 60 + seconds / 3600


def test_vertical_perspective_of_epsg_guidance_note_7_2():
    # Method 9838: origin 55° N 5° E at 200 m, viewed from 5,900 km above it; the point is 73 m high. Its projected
    # coordinates lie on the horizontal plane through the origin.
    height_m, origin_m, viewpoint_m = 73.0, 200.0, 5_900_000.0
    ray = np.array([-188878.767, -128550.090, -viewpoint_m])
    agl_m = origin_m + viewpoint_m - height_m
    seen = trace(np.array(55.0), np.array(agl_m), ray, WGS84.raised(height_m))
    # The note gives the point to 0.01″.
    assert float(seen.lat_deg) == pytest.approx(dms(53, 48, 33.82), abs=0.005 / 3600)
    assert 5.0 + float(seen.dlon_deg) == pytest.approx(dms(2, 7, 46.38), abs=0.005 / 3600)


# Published in pymap3d (src/pymap3d/tests/test_look_spheroid.py) for its lookAtSpheroid; to the digits given, some of
# them cut off instead of rounded.
LOOKS = [
    (42.0, -82.0, 200.0, 0.0, 30.0, ("42.00103959", "-82.000000000", "230.9413173")),
    (42.0, -82.0, 200.0, 10.0, 45.0, ("42.00177328", "-81.9995808", "282.84715651")),
    (10.0, -20.0, 1e3, 0.0, 45.0, ("10.009041667", "-20.000000000", "1414.32515")),
    (10.0, -20.0, 1e3, 45.0, 45.0, ("10.00639336", "-19.993549978", "1414.324795")),
    (10.0, -20.0, 1e3, 125.0, 45.0, ("9.99481382", "-19.992528", "1414.324671")),
]


@pytest.mark.parametrize(("lat", "lon", "agl", "azimuth", "tilt", "expected"), LOOKS)
def test_look_at_spheroid(lat, lon, agl, azimuth, tilt, expected):
    ray = Camera(60.0, 1.0).rays_enu(((0.0, 0.0),), azimuth, tilt)
    seen = trace(np.array([lat]), np.array([agl]), ray)
    slant_m = np.linalg.norm(sight_lines(np.array([lat]), np.array([agl]), seen.lat_deg, seen.dlon_deg))
    for value, published in zip((seen.lat_deg[0], lon + seen.dlon_deg[0], slant_m), expected):
        assert float(value) == pytest.approx(float(published), abs=10.0 ** -len(published.partition(".")[2]))


def test_look_at_spheroid_sees_no_ground_at_the_level():
    ray = Camera(60.0, 1.0).rays_enu(((0.0, 0.0),), 125.0, 90.0)
    assert not trace(np.array([42.0]), np.array([200.0]), ray).hit.any()


@pytest.mark.parametrize("lat", [-71.5, 0.0, 40.1])
@pytest.mark.parametrize("agl", [5e3, 3e5, 5.5e6])
def test_near_sided_perspective_of_proj(lat, agl):
    random = np.random.default_rng(3)
    # A third of the way to the horizon and nearer.
    reach = agl * np.tan(np.arcsin(RADIUS_M / (RADIUS_M + agl)))
    x, y = random.uniform(-0.5, 0.5, (2, 40)) * min(reach, 10 * agl)
    lon, expected = Proj(proj="nsper", lat_0=lat, lon_0=0, h=agl, R=RADIUS_M)(x, y, inverse=True)
    seen = trace(np.array(lat), np.array(agl), np.stack([x, y, np.full_like(x, -agl)], axis=-1), SPHERE)
    assert seen.hit.all()
    np.testing.assert_allclose(seen.lat_deg, expected, atol=1e-9)
    np.testing.assert_allclose(seen.dlon_deg, lon, atol=1e-9)


@pytest.mark.parametrize(("lat", "agl", "yaw", "tilt"), [(40.1, 3e5, 20.0, 30.0), (-65.0, 5.5e6, -110.0, 12.0)])
def test_tilted_perspective_of_proj(lat, agl, yaw, tilt):
    # PROJ's plane is tilted about the nadir point: its scale is H cos(tilt) and its origin lies H sin(tilt) below the
    # principal point.
    camera = Camera(50.0, 1.4)
    points = np.random.default_rng(4).uniform(-1, 1, (40, 2))
    seen = trace(np.array(lat), np.array(agl), camera.rays_enu(points, yaw, tilt), SPHERE)
    tan_x, tan_y = camera.half_tangents
    slope = np.radians(tilt)
    x = agl * np.cos(slope) * points[:, 0] * tan_x
    y = agl * np.cos(slope) * points[:, 1] * tan_y + agl * np.sin(slope)
    tilted = Proj(proj="tpers", lat_0=lat, lon_0=0, h=agl, azi=yaw, tilt=tilt, R=RADIUS_M)
    lon, expected = tilted(x[seen.hit], y[seen.hit], inverse=True)
    assert seen.hit.sum() > 20
    np.testing.assert_allclose(seen.lat_deg[seen.hit], expected, atol=1e-9)
    np.testing.assert_allclose(seen.dlon_deg[seen.hit], lon, atol=1e-9)


@pytest.mark.parametrize("lat", [-50.0, 0.0, 63.0])
@pytest.mark.parametrize("agl", [50.0, 2e4, 1e6])
def test_distance_and_azimuth_of_a_view_over_the_sphere(lat, agl):
    # The triangle of the Earth's centre, the camera and the ground point, by the sine rule.
    nadir_angle = np.radians(np.array([1.0, 20.0, 45.0]))
    arc = np.arcsin((RADIUS_M + agl) / RADIUS_M * np.sin(nadir_angle)) - nadir_angle
    for yaw in (-170.0, -30.0, 0.0, 75.0):
        rays = Camera(60.0, 1.0).rays_enu(((0.0, 0.0),), yaw, np.degrees(nadir_angle))[:, 0]
        seen = trace(np.array(lat), np.array(agl), rays, SPHERE)
        start = np.zeros(3)
        azimuth, _, metres = Geod(a=RADIUS_M, b=RADIUS_M).inv(start, start + lat, seen.dlon_deg, seen.lat_deg)
        # Half a metre of ground carries an azimuth good to 1e-9 m over 1 m.
        np.testing.assert_allclose(metres, RADIUS_M * arc, rtol=1e-12, atol=1e-8)
        np.testing.assert_allclose(azimuth, yaw, atol=1e-6)


# GeodTest (Karney 2010, doi:10.5281/zenodo.32156), rows shorter than 1.2 km of the selection GeodTest-100.dat of
# georust/geographiclib-rs: latitude 1, azimuth 1, latitude 2, longitude 2, distance (exact).
SHORT_GEODESICS = [
    (18.725775553796, 98.927919777265, 18.724785210853172866, 0.006615636046166963, 706.2676803),
    (47.900780879363, 148.758779524609, 47.899309788344023215, 0.001327005894209747, 191.3088022),
    (2.514600234503, 166.362139719401, 2.506446532968658234, 0.00196695535966103, 927.7647972),
    (60.077425015363, 81.639916890942, 60.078197903525388982, 0.010531670881733178, 592.5766309),
    (36.800966049655, 43.389649034063, 36.802889529289609993, 0.002261122427425817, 293.7372273),
    (56.310719132311, 155.158323803365, 56.304258387808388716, 0.005380024608319352, 792.7231052),
    (8.849455388939, 129.673344478389, 8.843107684651578467, 0.007694428892432052, 1099.6867173),
]


@pytest.mark.parametrize(("lat", "azimuth", "other_lat", "dlon", "metres"), SHORT_GEODESICS)
def test_sight_lines_along_published_geodesics(lat, azimuth, other_lat, dlon, metres):
    agl = 300.0
    east, north, up = sight_lines(np.array(lat), np.array(agl), np.array(other_lat), np.array(dlon))
    # Within 1.1 km a chord is shorter than its arc by s³/24R² (1.4e-6 m), in which R is known to 1 %; and a normal
    # section leaves a geodesic's azimuth by e²(s/R)²/12 (2e-11 rad, 1e-9 degrees).
    chord = np.sqrt(east**2 + north**2 + (up + agl) ** 2)
    assert chord == pytest.approx(metres - metres**3 / (24 * RADIUS_M**2), abs=2e-8)
    # 2e-8 m across over 191 m are 6e-9 degrees.
    assert np.degrees(np.arctan2(east, north)) == pytest.approx(azimuth, abs=1e-8)
    back = trace(np.array(lat), np.array(agl), np.stack([east, north, up], axis=-1))
    # Both `sight_lines` and `trace` are off by 2⁻⁴⁷ of the slant at most, here over the sine of incidence, with any
    # library within 4 units in the last place; over 110 km a degree. Latitudes end at their last digit.
    slant = math.hypot(metres, agl)
    rays_deg = 2.0 * 2.0**-47 * slant / (agl / slant) / 110_000.0
    assert float(back.lat_deg) == pytest.approx(other_lat, abs=rays_deg + np.spacing(lat))
    assert float(back.dlon_deg) == pytest.approx(dlon, abs=rays_deg / math.cos(math.radians(lat)))


# From the same file, geodesics of one hemisphere: latitude 1, azimuth 1, longitude 2, distance, area under it in m².
AREAS = [
    (23.287785477695, 87.82760486416, 35.797365608165841143, 3703998.3106422, 9687159334175.357207),
    (22.5638815461, 92.656027197162, 74.442871731040704334, 8268776.6328499, 13921383920403.241935),
    (39.467536559447, 52.043751751992, 135.413534116455116183, 13145044.4390506, 63684702532912.381707),
    (63.655969559901, 65.042796414527, 111.700018655530895272, 9790058.7849835, 64064866938432.523903),
    (18.725775553796, 98.927919777265, 0.006615636046166963, 706.2676803, 1498532658.831092),
]


@pytest.mark.parametrize(("lat", "azimuth", "lon", "metres", "area_m2"), AREAS)
def test_areas_under_published_geodesics(lat, azimuth, lon, metres, area_m2):
    steps = np.linspace(0.0, metres, 40_001)
    start = np.zeros_like(steps)
    lons, lats, _ = Geod(ellps="WGS84").fwd(start, start + lat, start + azimuth, steps)
    ring_lon = np.concatenate([[0.0], lons, [lon]])
    ring_lat = np.concatenate([[0.0], lats, [0.0]])
    # A chord in longitude and latitude of one of n pieces leaves the geodesic by 1/n².
    assert WGS84.ring_area_m2(ring_lon, ring_lat) == pytest.approx(area_m2, rel=1e-8)


def test_tiles_of_mercantiles_readme():
    # mapbox/mercantile, README: ul(486, 332, 10), bbox and xy of the same tile, and the outline of 20,35,6.
    world = 2.0**10
    assert float(u_to_lon(np.array(486 / world))) == -9.140625
    assert float(v_to_lat(np.array(332 / world))) == pytest.approx(53.33087298301705, abs=1e-13)
    assert float(v_to_lat(np.array(333 / world))) == pytest.approx(53.12040528310657, abs=1e-13)
    easting = (float(lon_to_u(np.array(-9.140625))) - 0.5) * 2 * HALF_WORLD_M
    assert easting == pytest.approx(-1017529.7205322663, abs=1e-8)
    northing = (0.5 - float(lat_to_v(np.array(53.33087298301705)))) * 2 * HALF_WORLD_M
    assert northing == pytest.approx(7044436.526761846, abs=1e-8)
    assert u_to_lon(np.array([20, 21]) / 64).tolist() == [-67.5, -61.875]
    assert v_to_lat(np.array([35, 36]) / 64) == pytest.approx([-16.636191878397653, -21.943045533438177], abs=1e-12)
