"""Bounds over a seeded draw of their domains, and what the bounds are made of."""

from __future__ import annotations

import math

import numpy as np
import pytest
from terrainav.core.geodesy import accuracy
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import CORNERS, Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid, v_to_lat
from terrainav.core.geodesy.rectangles import inscribed_edges
from terrainav.core.geodesy.view import ImageRays, mesh, view

from tests.core.geodesy import bounds, longdouble
from tests.core.geodesy.reference import look, see
from tests.support.thinning import named, thinned

pytestmark = pytest.mark.skipif(not longdouble.EXTENDED, reason=longdouble.WHY_NOT)


def scene(lat=35.14, agl=120.0, yaw=0.0, tilt=0.0, roll=0.0, camera=Camera(), size=(640, 480)):  # noqa: B008
    one = np.array([float(lat)])
    return ImageGeometry(camera, *size, Poses.from_attitude(one, np.zeros(1), np.array([float(agl)]), yaw, tilt, roll))


def test_angles_of_corners_are_those_of_their_rays_whether_poses_share_their_attitude_or_not():
    count, camera = 7, Camera(100.0, 1.5)
    some = np.linspace(0.0, 30.0, count)
    alike = Poses.from_attitude(some, some, some + 1.0, 20.0, -15.0, 40.0)
    for poses in (
        alike,
        alike._replace(yaw_deg=9.0 * some),
        alike._replace(yaw_deg=9.0 * some, tilt_deg=2.0 * some, roll_deg=-some),
        alike._replace(roll_deg=some),
    ):
        sin_below, squared = accuracy.corner_angles(ImageGeometry(camera, 640, 480, poses))
        rays = camera.rays_enu(CORNERS, *poses.attitude)
        length = np.linalg.norm(rays, axis=-1)
        assert sin_below.shape == squared.shape == (count, 4)
        np.testing.assert_allclose(sin_below, -rays[..., 2] / length, rtol=1e-14)
        np.testing.assert_allclose(squared, length**2, rtol=1e-14)


def test_methods_for_level_cameras_stay_within_their_bounds():
    for name, tally in bounds.level_methods(seed=7, draws=60, each=150).items():
        assert tally.count > 2000
        assert tally.worst <= 1.0, (name, tally.scene)
        # A bound ten times too large would be no guide.
        assert tally.median > 0.1, name


def test_the_exact_camera_stays_within_its_bound():
    tally = bounds.exact_footprints(seed=8, draws=100, each=150)
    assert tally.count > 5000
    assert tally.worst <= 1.0, tally.scene


def test_camera_frames_whose_every_pixel_is_traced_stay_within_their_bound():
    points, frames = bounds.camera_frames(seed=12, draws=150, each=5)
    assert points.count > 50_000
    assert frames.count > 300
    assert points.worst <= 1.0, points.scene
    # The noise of a position on the map that counts itself: a tenth of its bound is common.
    assert points.worst > 0.1


@pytest.mark.parametrize("tolerance", thinned(named([0.3, 0.03, 0.003]), ["0.03"]))
def test_cells_of_meshes_stay_within_their_bounds(tolerance):
    points, meshes = bounds.meshes(9, 60, tolerance)
    assert points.count > 10_000
    assert points.worst <= 1.0, points.scene
    _, plain = bounds.meshes(10, 40, tolerance, widest=120.0)
    assert plain.worst <= 1.0, plain.scene
    assert meshes.count > 10


@pytest.mark.parametrize("draws", [30, pytest.param(250, marks=pytest.mark.thorough)])
def test_rectangles_lie_inside_what_cameras_see(library, draws):
    # The shapes are tried with the machine's library; a far worse one takes ten times as long.
    if library != "own":
        draws = 80
    found = bounds.rectangles_inside(seed=11, draws=draws, each=6)
    # They give way by half a pixel of the source; what an edge does between the points looked at is far less.
    assert found.worst_px <= 0.05
    assert found.with_extent > 2 * draws


@pytest.mark.parametrize(
    "pose",
    [
        {
            "camera": Camera(160.3353, 1.5),
            "lat": 5.3793,
            "agl": 28336680.0,
            "yaw": 165.476,
            "tilt": 72.5369,
            "roll": 39.7222,
        },
        {"camera": Camera(140.0, 1.5), "lat": 85.0, "agl": 2.8e7, "yaw": 30.0, "tilt": 55.0, "roll": 40.0},
        {"camera": Camera(160.0, 1.5), "lat": 80.0, "agl": 3.6e7, "yaw": 300.0, "tilt": 65.0, "roll": 40.0},
        {"lat": 35.0, "agl": 8e6, "tilt": 20.0},
    ],
)
def test_a_rectangle_stays_inside_what_the_horizon_leaves(pose):
    here = scene(**pose)
    (west,), (east,), (top,), (bottom,) = inscribed_edges(here.camera, here.poses)
    assert 0.0 < east - west <= 0.5
    share = np.linspace(0.0, 1.0, 33)
    u, v = (axis.ravel() for axis in np.meshgrid(west + (east - west) * share, top + (bottom - top) * share))
    at = [values[:, np.newaxis] for values in (here.poses.lat_deg, here.poses.agl_m)]
    seen = longdouble.look(
        *at,
        here.camera.fov_deg,
        here.camera.aspect_ratio,
        *(angle[:, np.newaxis] for angle in here.poses.attitude),
        v_to_lat(v),
        u * 360.0,
    )
    assert seen.visible.all()
    assert max(np.abs(seen.x).max(), np.abs(seen.y).max()) <= 1.0 + 1e-9


@pytest.mark.parametrize(
    "pose",
    [{}, {"tilt": 60.0, "yaw": 30.0}, {"tilt": 85.0, "roll": 5.0}, {"lat": 40.1, "agl": 8e6}, {"agl": 3.6e7}],
)
@pytest.mark.parametrize("tolerance", thinned(named([0.1, 0.003]), ["0.1"]))
def test_every_pixel_is_a_cell_or_a_ray_or_sky(pose, tolerance):
    here = scene(**pose)
    rays = ImageRays.from_scene(here)
    cells = mesh(rays, tolerance)
    times = np.zeros((480, 640), int)
    for left, top, right, bottom in np.concatenate([cells.box, cells.loose]).tolist():
        times[top:bottom, left:right] += 1
    assert times.max() == 1
    row, column = np.nonzero(times == 0)
    _, _, hit = rays.map_points(column + 0.5, row + 0.5)
    assert not hit.any()
    assert (cells.bound_px <= tolerance).all()
    made = view(here, PixelGrid(), (0, 22), tolerance)
    _, _, seen = rays.map_points(*(axis + 0.5 for axis in np.meshgrid(np.arange(640), np.arange(480))))
    sky = np.zeros((480, 640), bool) if made.sky is None else made.sky
    np.testing.assert_array_equal(sky, ~seen)


def test_numbers_that_were_measured_elsewhere():
    # The flat model's corner error at latitude 40.1 (px of 640): 0.0025 at 120 m, 0.021 at 1 km, 0.34 at 16 km.
    for agl, error in ((120.0, 0.0025), (1e3, 0.021), (16e3, 0.34)):
        assert float(accuracy.flat_bending_px(scene(40.1, agl))[0]) == pytest.approx(error, rel=0.05)
    assert accuracy.terrain_px_per_m(scene()) == pytest.approx(400.0 / 120.0, rel=1e-12)
    assert accuracy.condition_number(scene(85.05, 10.0)) == pytest.approx(11.6, abs=0.05)
    assert accuracy.condition_number(scene(tilt=85.0)) == math.inf


@pytest.mark.parametrize(("inside_deg", "condition"), [(1.0, 68.0), (0.01, 1.1e3)])
def test_the_condition_near_the_horizon(inside_deg, condition):
    """Relative change of the ground distance per relative change of the angle, by differences at 50 digits."""
    camera = Camera(0.001, 1.0)
    agl, radius = 120.0, 6378137.0 * (1 - 1 / 298.257223563)
    tilt = 90.0 - math.degrees(math.acos(radius / (radius + agl))) - inside_deg
    from mpmath import mp, mpf

    def distance(angle):
        lat, _ = see(0.0, agl, 0.001, 1.0, 0.0, float(angle), 0.0, 0.0, 0.0)
        return lat

    with mp.workdps(50):
        step = tilt * 1e-7
        change = (distance(tilt + step) - distance(tilt - step)) / (2 * mpf(step)) * tilt / distance(tilt)
    found = accuracy.condition_number(scene(0.0, agl, tilt=tilt, camera=camera))
    assert float(change) == pytest.approx(condition, rel=0.15)
    assert found == pytest.approx(float(change), rel=0.25)


@pytest.mark.parametrize("pose", [{}, {"tilt": 40.0}, {"tilt": 55.0, "roll": 10.0, "yaw": 200.0}])
def test_relief_moves_points_as_stated(pose):
    here = scene(**pose)
    stated = accuracy.terrain_px_per_m(here)
    angles = [pose.get(name, 0.0) for name in ("yaw", "tilt", "roll")]
    worst = 0.0
    for x, y in ((-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)):
        lat, dlon = see(35.14, 120.0, 78.8, 4 / 3, *angles, x, y)
        # The same place a centimetre higher: a camera that much lower over ground that much higher.
        found = look(35.14, 119.99, 78.8, 4 / 3, *angles, lat, dlon, 0.01)
        worst = max(worst, math.hypot((float(found[0]) - x) * 320, (float(found[1]) - y) * 240) / 0.01)
    assert worst <= stated * 1.01
    assert worst >= stated * 0.4
