"""Planes of projected CRSs, and pictures on them, against definitions at 50 digits and PROJ's own factors."""

from __future__ import annotations

import math

import numpy as np
import pyproj
import pytest
from terrainav.core.geodesy.accuracy import ImageGeometry, camera_frame_px
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.frames import map_windows, plane_frame_px
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.geodesy.projections import NOISE_M
from terrainav.core.geodesy.view import KERNEL_REACH_PX, ImageRays, mesh, view

from tests.core.geodesy import reference
from tests.core.geodesy.bounds import perspective
from tests.core.geodesy.projections50 import polar_stereographic, transverse_mercator

CAMERA = Camera(78.8, 4 / 3)
SIZE = 640.0, 480.0
#: A CRS, what it is at 50 digits, and places on it.
PLANES = {
    "EPSG:32616": (
        lambda lat, lon: transverse_mercator(lat, lon, -87),
        [(35.1, -89.9), (0.0, -85.0), (83.0, -84.1)],
    ),
    "EPSG:3413": (
        lambda lat, lon: polar_stereographic(lat, lon, 70, -45),
        [(88.0, 10.0), (90.0, 0.0), (70.0, 135.0)],
    ),
    "EPSG:3031": (
        lambda lat, lon: polar_stereographic(lat, lon, -71, 0),
        [(-89.9, 100.0), (-90.0, 7.0), (-65.0, -179.9)],
    ),
}
#: Points of each image that are worked out at 50 digits.
DRAWS = pytest.mark.parametrize("draws", [2, pytest.param(25, marks=pytest.mark.thorough)])
PLACES = [(crs, *place) for crs, (_, places) in PLANES.items() for place in places]


def plane_about(crs, lat, lon, pixel=0.5):
    """A plane of 2**15 px about a place."""
    x, y = ProjectedPlane(crs, 0.0, 0.0, 1.0, 1.0).to_crs(np.array(lat), np.array(lon))
    size = pixel * 2**15
    return ProjectedPlane(crs, float(x) - size / 2, float(y) + size / 2, size, size)


def grid_about(crs, lat, lon):
    return PixelGrid(256, 0, 10, 7, plane=plane_about(crs, lat, lon))


def exactly(crs, lat, lon):
    return [float(value) for value in PLANES[crs][0](lat, lon)]


@pytest.mark.parametrize(("crs", "lat", "lon"), PLACES)
def test_coordinates_are_those_of_the_definition(crs, lat, lon):
    plane = plane_about(crs, lat, lon)
    x, y = plane.to_crs(np.array(lat), np.array(lon))
    assert math.hypot(float(x) - exactly(crs, lat, lon)[0], float(y) - exactly(crs, lat, lon)[1]) < NOISE_M
    u, v = plane.forward(np.array(lat), np.array(lon))
    assert (float(u), float(v)) == pytest.approx((0.5, 0.5), abs=1e-9)
    back_lat, back_lon = plane.inverse(u, v)
    assert float(back_lat) == pytest.approx(lat, abs=1e-12)
    if abs(lat) < 90.0:
        assert float(back_lon) == pytest.approx(lon, abs=1e-11)


@pytest.mark.parametrize("crs", ["EPSG:32616", "EPSG:3413", "EPSG:2154", "EPSG:3035", "EPSG:5070", "EPSG:2263"])
def test_north_and_scale_are_proj_s(crs):
    area = pyproj.CRS(crs).area_of_use
    lon = np.linspace(area.west, area.east, 7)[1:-1]
    lat = np.linspace(max(area.south, -89.0), min(area.north, 89.0), 7)[1:-1]
    factors = pyproj.Proj(crs).get_factors(lon, lat)
    plane = ProjectedPlane(crs, 0.0, 0.0, 1.0, 1.0)
    # PROJ's is the convergence, the other way around, and on the CRS's own ellipsoid.
    assert plane.north_deg(lat, lon) == pytest.approx(-factors.meridian_convergence, abs=1e-5)
    across, down = plane.ground_m(lat, lon)
    areal = plane.unit_m**2 / (across * down)
    if crs in ("EPSG:32616", "EPSG:3413", "EPSG:2154", "EPSG:2263"):
        assert areal == pytest.approx(factors.areal_scale, rel=1e-6)
        assert across == pytest.approx(down, rel=1e-7)


def test_bends_are_those_of_conformal_projections():
    lat = np.array([0.0, 30.0, 60.0, 84.0])
    mercator = ProjectedPlane("EPSG:3395", 0.0, 0.0, 1.0, 1.0)
    bend = mercator.bend(lat, np.zeros(4))
    assert bend == pytest.approx(np.tan(np.radians(lat)), rel=0.03, abs=1e-9)
    assert (bend >= np.tan(np.radians(lat)) * 0.99).all()
    polar = ProjectedPlane("EPSG:3031", 0.0, 0.0, 1.0, 1.0)
    # The logarithm of a stereographic scale falls by tan(θ/2) with the distance θ from the pole.
    assert polar.bend(np.array([-60.0]), np.zeros(1)) == pytest.approx(math.tan(math.radians(15.0)), rel=0.03)


@pytest.mark.parametrize(("crs", "lat", "lon"), PLACES)
@pytest.mark.parametrize("agl", [120.0, 3000.0])
@DRAWS
def test_map_frames_are_within_their_bound(crs, lat, lon, agl, draws):
    grid = grid_about(crs, lat, lon)
    plane = grid.plane
    yaw = -plane.north_deg(np.array([lat]), np.array([lon]))
    pose = Poses(np.array([lat]), np.array([lon]), np.array([agl]), yaw, np.zeros(1), np.zeros(1))
    scene = ImageGeometry(CAMERA, *SIZE, pose)
    bound = float(plane_frame_px(scene, plane, plane.greatest_bend(pose.lat_deg, pose.lon_deg))[0])
    # The window as it is before its edges are rounded: at a zoom of a millionth of a pixel.
    fine = PixelGrid(256, 0, 30, 30, plane=plane)
    window = [float(value[0]) / fine.world_px(30) for value in map_windows(CAMERA, pose, fine, 30)]
    worst = 0.0
    corners = [[-1, -1], [1, 1], [-1, 1], [1, -1]]
    for x, y in [*np.random.default_rng(1).uniform(-1, 1, (draws, 2)).tolist(), *corners]:
        seen = reference.see(lat, agl, CAMERA.fov_deg, CAMERA.aspect_ratio, float(yaw[0]), 0, 0, x, y)
        there = exactly(crs, seen[0], seen[1] + lon)
        u, v = (there[0] - plane.west) / plane.width, (plane.north - there[1]) / plane.height
        off_x = ((u - window[0]) / window[2] - (x + 1) / 2) * SIZE[0]
        off_y = ((v - window[1]) / window[3] - (1 - y) / 2) * SIZE[1]
        worst = max(worst, math.hypot(off_x, off_y))
    assert worst <= bound
    assert bound < 0.05 if agl < 1000 else 2.0


@pytest.mark.parametrize(
    ("crs", "lat", "lon", "tilt"),
    [
        # At each place one tilt; all of them are thorough.
        pytest.param(*place, tilt, marks=() if i % 3 == k else pytest.mark.thorough)
        for i, place in enumerate(PLACES)
        for k, tilt in enumerate((0.0, 45.0, 80.0))
    ],
)
@DRAWS
def test_cells_and_rays_of_camera_frames_are_within_their_bounds(crs, lat, lon, tilt, draws):
    grid = grid_about(crs, lat, lon)
    plane = grid.plane
    attitude = 30.0, tilt, 3.0
    pose = Poses.from_attitude(np.array([lat]), np.array([lon]), np.array([120.0]), *attitude)
    scene = ImageGeometry(CAMERA, *SIZE, pose)
    rays = ImageRays.from_scene(scene, plane)
    cells = mesh(rays, 0.1)
    assert len(cells.box) > 0
    rng = np.random.default_rng(7)
    which = rng.integers(0, len(cells.box), draws)
    a, b = rng.random((2, draws))
    box = cells.box[which]
    column, row = box[:, 0] + a * (box[:, 2] - box[:, 0]), box[:, 1] + b * (box[:, 3] - box[:, 1])
    meshed = perspective(cells.du[which], cells.v[which], a, b)
    traced = rays.map_points(column, row)[:2]
    for index in range(len(which)):
        x, y = 2 * column[index] / SIZE[0] - 1, 1 - 2 * row[index] / SIZE[1]
        for (u, v), bound in (
            ((meshed[0][index], meshed[1][index]), cells.bound_px[which][index]),
            ((traced[0][index], traced[1][index]), float(camera_frame_px(scene)[0])),
        ):
            assert _away_px(crs, lat, lon, attitude, (x, y), (u, v), plane) <= bound


def _away_px(crs, lat, lon, attitude, image, place, plane):
    """How far from an image point the ground is seen that lies at a position on the plane, by a Newton step."""

    def on_plane(x, y):
        seen = reference.see(lat, 120.0, CAMERA.fov_deg, CAMERA.aspect_ratio, *attitude, x, y)
        there = PLANES[crs][0](seen[0], seen[1] + lon)
        return np.array([float((there[0] - plane.west) / plane.width), float((plane.north - there[1]) / plane.height)])

    x, y = image
    off = np.asarray(place) - on_plane(x, y)
    step = 1e-6
    slope = np.stack(
        [(on_plane(x + step, y) - on_plane(x, y)) / step, (on_plane(x, y + step) - on_plane(x, y)) / step],
        axis=1,
    )
    moved = np.linalg.solve(slope, off)
    return math.hypot(moved[0] * SIZE[0] / 2, moved[1] * SIZE[1] / 2)


def test_tiles_of_views_are_those_that_pixels_are_read_from():
    crs, lat, lon = "EPSG:32616", 35.1, -89.9
    grid = grid_about(crs, lat, lon)
    pose = Poses.from_attitude(np.array([lat]), np.array([lon]), np.array([500.0]), 20.0, 60.0, 0.0)
    seen = view(ImageGeometry(CAMERA, *SIZE, pose), grid, (0, 7), 0.1)
    tiles = set(seen.tiles(lon))
    keys = seen.tile_keys(np.array([lon]), np.zeros(1), np.zeros(1))
    assert len(keys) == len(tiles)
    for zoom, west, east, north, south in seen.extents():
        size, world = grid.tile_px, grid.world_px(zoom)
        for u in (west, east):
            for v in (north, south):
                needed = zip((u * world // size).astype(int), (v * world // size).astype(int))
                assert {(zoom, int(column), int(row)) for column, row in needed} <= tiles
    assert KERNEL_REACH_PX > 0


def test_beyond_the_projection_nothing_is_finite():
    plane = plane_about("EPSG:32616", 35.1, -89.9)
    u, v = plane.forward(np.array([35.1, np.nan]), np.array([-89.9, 0.0]))
    assert np.isfinite(u).tolist() == [True, False]
    assert np.isfinite(v).tolist() == [True, False]


def test_a_plane_goes_round_nothing():
    """Columns left of the plane stay there: only the map begins anew."""
    grid = grid_about("EPSG:3031", -90.0, 0.0)
    assert grid.wrapped(-1, 3) == -1
    assert PixelGrid().wrapped(-1, 3) == 7
