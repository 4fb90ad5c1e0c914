"""Views, outlines and rectangles of cameras that distort, against single rays."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.geodesy.accuracy import ImageGeometry, camera_frame_px, finest_px_m, ground_m_per_px
from terrainav.core.geodesy.camera import CORNERS, Camera, Poses
from terrainav.core.geodesy.ellipsoid import sight_lines, trace
from terrainav.core.geodesy.footprint import exact, ground_corners, outline
from terrainav.core.geodesy.mercator import lat_to_v, lon_to_u, u_to_lon, v_to_lat
from terrainav.core.geodesy.projections import LocalPlane
from terrainav.core.geodesy.rectangles import common_sides, image_sides, inscribed_edges
from terrainav.core.geodesy.view import ImageRays, mesh

from tests.core.geodesy.test_distortion import CAMERAS
from tests.support.thinning import sampled

SIZE = (320, 240)
LAT = 35.0
ATTITUDES = [(0.0, 0.0, 0.0), (30.0, 40.0, 5.0), (200.0, 75.0, -10.0), (0.0, 120.0, 0.0)]
CASES = sampled([pytest.param(name, attitude) for name in CAMERAS for attitude in ATTITUDES], 3)


def one_pose(attitude, agl_m=120.0):
    return Poses.from_attitude(np.array([LAT]), np.array([-89.0]), np.array([agl_m]), *attitude)


def rays_of(name, attitude, agl_m=120.0):
    return ImageRays.from_scene(ImageGeometry(CAMERAS[name], *SIZE, one_pose(attitude, agl_m)))


def perspective(corners, x, y):
    """Places (n, 2) of shares of cells (n,), in the perspective through corners (n, 4, 2) as `Cells` has them."""
    left_top, left_low, right_low, right_top = np.moveaxis(corners, 1, 0)
    found = np.empty((len(x), 2))
    for index in range(len(x)):
        sides = np.stack([right_top[index] - right_low[index], left_low[index] - right_low[index]], axis=1)
        rest = left_top[index] - right_top[index] + right_low[index] - left_low[index]
        along = np.linalg.solve(sides, rest)
        across = right_top[index] - left_top[index] + along[0] * right_top[index]
        down = left_low[index] - left_top[index] + along[1] * left_low[index]
        whole = 1.0 + along @ (x[index], y[index])
        found[index] = (left_top[index] + x[index] * across + y[index] * down) / whole
    return found


@pytest.mark.parametrize("tolerance_px", [0.1, 0.02])
@pytest.mark.parametrize(("name", "attitude"), CASES)
def test_the_mesh_is_within_its_bound(name, attitude, tolerance_px):
    rays = rays_of(name, attitude)
    cells = mesh(rays, tolerance_px)
    assert (cells.bound_px <= tolerance_px).all()
    random = np.random.default_rng(5)
    at = random.integers(0, len(cells.box), 1500) if len(cells.box) else np.empty(0, int)
    share_x, share_y = random.uniform(0.0, 1.0, (2, len(at)))
    left, top, right, bottom = cells.box[at].T
    x, y = left + share_x * (right - left), top + share_y * (bottom - top)
    found = perspective(np.stack([cells.du[at], cells.v[at]], axis=-1), share_x, share_y)

    def places(x, y):
        du, v, hit = rays.map_points(x, y)
        assert hit.all()
        return np.stack([du, v], axis=-1)

    true, step = places(x, y), 1e-3
    slopes = np.stack([(places(x + step, y) - true) / step, (places(x, y + step) - true) / step], axis=-1)
    off_px = np.linalg.solve(slopes, (found - true)[..., np.newaxis])[..., 0]
    # Slopes are those of rounded places, a ten-thousandth off.
    assert (np.hypot(*off_px.T) <= cells.bound_px[at] * 1.001).all()


@pytest.mark.parametrize(("name", "attitude"), CASES)
def test_every_pixel_that_sees_ground_is_in_the_mesh(name, attitude):
    rays = rays_of(name, attitude)
    cells = mesh(rays, 0.1)
    covered = np.zeros(SIZE[::-1], int)
    for left, top, right, bottom in np.concatenate([cells.box, cells.loose]).tolist():
        covered[top:bottom, left:right] += 1
    assert covered.max() <= 1
    column, row = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    assert not (rays.map_points(column + 0.5, row + 0.5)[2] & (covered == 0)).any()
    sure = np.zeros_like(covered, bool)
    for left, top, right, bottom in cells.box.tolist():
        sure[top:bottom, left:right] = True
    assert rays.map_points(column[sure] + 0.5, row[sure] + 0.5)[2].all()


@pytest.mark.parametrize("name", CAMERAS)
def test_rows_have_the_rays_of_the_whole_image(name):
    whole = rays_of(name, (30.0, 40.0, 5.0))
    part = ImageRays.from_scene(whole.scene, rows=(100, 140))
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(40) + 0.5)
    assert np.abs(part.directions(x, y) - whole.directions(x, y + 100)).max() < 1e-12
    for rays, first in ((whole, 100), (part, 0)):
        centres = rays.ideal_directions(*rays.ideal_centres(first, first + 40))
        assert np.abs(centres - part.directions(x, y)).max() < 1e-12


@pytest.mark.parametrize("name", CAMERAS)
def test_steps_are_the_differences_of_ideal_pixels(name):
    rays, step = rays_of(name, (0.0, 0.0, 0.0)), 1e-4
    x, y = np.random.default_rng(2).uniform(1.0, SIZE[1] - 1.0, (2, 100))
    xx, xy, yx, yy = rays.ideal_steps(x, y)
    for (by_x, by_y), (dx, dy) in (((xx, yx), (step, 0.0)), ((xy, yy), (0.0, step))):
        ahead, behind = (rays.ideal_px(x + sign * dx, y + sign * dy) for sign in (1.0, -1.0))
        assert np.allclose(by_x, (ahead[0] - behind[0]) / (2.0 * step), atol=1e-6)
        assert np.allclose(by_y, (ahead[1] - behind[1]) / (2.0 * step), atol=1e-6)


def shoelace(x, y):
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2.0


@pytest.mark.parametrize(("name", "attitude"), CASES)
@pytest.mark.parametrize("agl_m", [120.0, 2e5])
def test_the_outline_holds_the_pixels_that_see_ground(name, attitude, agl_m):
    camera = CAMERAS[name]
    side = (np.arange(300) + 0.5) / 150.0 - 1.0
    x, y = (values.ravel() for values in np.meshgrid(side, side))
    hit = exact(camera, one_pose(attitude, agl_m), tuple(zip(x.tolist(), y.tolist()))).hit.mean()
    if hit == 0.0:
        return
    ring = outline(camera, LAT, agl_m, attitude)
    # An arc of 72 chords lacks a thousandth of its circle; the rest is the pixels on the edge.
    assert shoelace(*ring.image_xy.T) / 4.0 == pytest.approx(hit, abs=4e-3)
    on_frame = np.abs(np.abs(ring.image_xy).max(axis=1) - 1.0) < 1e-9
    assert (on_frame | ring.horizon | np.roll(ring.horizon, 1)).all()
    seen = camera.image_xy(
        sight_lines(np.array(LAT), np.array(agl_m), ring.lat_deg, ring.dlon_deg)[np.newaxis], *attitude
    )[0]
    assert np.abs(seen[0] - ring.image_xy).max() < 1e-6


@pytest.mark.parametrize("name", CAMERAS)
def test_two_parts_of_the_ground_are_one_outline(name):
    # A fisheye that looks up sees ground in its lower corners only.
    if name not in ("fisheye", "equidistant"):
        return
    ring = outline(CAMERAS[name], LAT, 120.0, (0.0, 139.0, 0.0))
    middle = np.abs(ring.image_xy[:, 0]) < 0.3
    assert not middle.any()
    assert ring.image_xy[:, 0].min() == pytest.approx(-1.0)
    assert ring.image_xy[:, 0].max() == pytest.approx(1.0)


@pytest.mark.parametrize("name", CAMERAS)
def test_corners_of_footprints_are_those_of_dense_rays(name):
    camera, pose = CAMERAS[name], one_pose((30.0, 10.0, 3.0))
    seen = ground_corners(camera, pose)
    for index, (x, y) in enumerate(CORNERS):
        # The ground of a dense grid that is seen nearest to the corner is the corner's.
        shares = np.linspace(0.9, 1.0, 101)
        grid = np.stack(np.meshgrid(x * shares, y * shares), axis=-1).reshape(-1, 2)
        ground = trace(np.array(LAT), np.array(120.0), camera.rays_enu(grid, 30.0, 10.0, 3.0))
        lines = sight_lines(np.array(LAT), np.array(120.0), ground.lat_deg, ground.dlon_deg)
        at = camera.image_xy(lines[np.newaxis], 30.0, 10.0, 3.0)[0][0]
        assert np.abs(at - grid).max() < 1e-8
        nearest = np.abs(grid - (x, y)).max(axis=1).argmin()
        assert seen.lat_deg[0, index] == pytest.approx(ground.lat_deg[nearest], abs=1e-12)


def outside(camera, poses, lat, dlon):
    """How far places (n, k) are outside the images of poses (n,), in half images, at most; by image points."""
    lines = sight_lines(poses.lat_deg[:, np.newaxis], poses.agl_m[:, np.newaxis], lat, dlon)
    found, in_front = camera.image_xy(lines, *poses.attitude)
    assert in_front.all()
    return float(np.abs(found).max()) - 1.0


@pytest.mark.parametrize(("name", "attitude"), CASES)
def test_rectangles_are_inside_images(name, attitude):
    if attitude[1] > 100.0:
        return
    camera, pose = CAMERAS[name], one_pose(attitude)
    edges = inscribed_edges(camera, pose)
    across, down = np.meshgrid(np.linspace(0.0, 1.0, 61), np.linspace(0.0, 1.0, 61))
    u, v = (
        start[:, np.newaxis] + share.ravel() * size[:, np.newaxis]
        for start, share, size in zip((edges.west_u, edges.top_v), (across, down), edges.size)
    )
    assert (edges.size[0] > 0.0).all()
    assert outside(camera, pose, v_to_lat(v), u_to_lon(u + 0.5)) < 1e-6


@pytest.mark.parametrize("name", CAMERAS)
def test_rectangles_of_level_images_touch_their_borders(name):
    camera, pose = CAMERAS[name], one_pose((0.0, 0.0, 0.0))
    edges = inscribed_edges(camera, pose)
    border = exact(camera, pose, tuple(map(tuple, np.linspace(*np.array(CORNERS)[[0, 3]], 401).tolist())))
    west = lon_to_u(border.lon_deg) - lon_to_u(pose.lon_deg)
    assert edges.west_u[0] == pytest.approx(float(west.max()), abs=3e-3 * float(edges.size[0][0]))
    top = exact(camera, pose, tuple(map(tuple, np.linspace(*np.array(CORNERS)[[0, 1]], 401).tolist())))
    assert edges.top_v[0] == pytest.approx(float(lat_to_v(top.lat_deg).max()), abs=3e-3 * float(edges.size[1][0]))


@pytest.mark.parametrize("name", CAMERAS)
def test_sides_in_a_plane_are_inside_images_and_large(name):
    camera = CAMERAS[name]
    poses = Poses.from_attitude(np.full(3, LAT), np.array([-89.0, -89.01, -89.02]), np.full(3, 120.0), 25.0, 10.0, 0.0)
    plane = LocalPlane(LAT, -89.0)
    sides = image_sides(camera, poses, plane)
    shares = np.linspace(0.0, 1.0, 81)
    x, y = (at.ravel() for at in np.meshgrid(shares, shares))
    width, height = (size[:, np.newaxis] for size in sides.size_m)
    lat, lon = plane.inverse(sides.left_m[:, np.newaxis] + x * width, sides.bottom_m[:, np.newaxis] + y * height)
    assert outside(camera, poses, lat, lon - poses.lon_deg[:, np.newaxis]) < 1e-6
    # A twentieth larger about its middle it reaches out.
    lat, lon = plane.inverse(
        (sides.left_m + sides.right_m)[:, np.newaxis] / 2.0 + 1.05 * (x - 0.5) * width,
        (sides.bottom_m + sides.top_m)[:, np.newaxis] / 2.0 + 1.05 * (y - 0.5) * height,
    )
    assert outside(camera, poses, lat, lon - poses.lon_deg[:, np.newaxis]) > 1e-3
    common = common_sides(camera, poses, plane)
    assert 0.9 * min(map(float, width[:, 0])) < float(common.size_m[0][0])


@pytest.mark.parametrize("name", CAMERAS)
def test_sizes_of_pixels_on_the_ground_are_bounds(name):
    camera = CAMERAS[name]
    for attitude in ATTITUDES[:2]:
        scene = ImageGeometry(camera, *SIZE, one_pose(attitude))
        rays = ImageRays.from_scene(scene)
        x, y = (at.ravel() for at in np.meshgrid(np.linspace(0.0, SIZE[0], 41), np.linspace(0.0, SIZE[1], 31)))
        step = 1e-3
        seen, right, below = (rays.ground(x + dx, y + dy) for dx, dy in ((0.0, 0.0), (step, 0.0), (0.0, step)))
        if not seen.hit.all():
            continue
        east_m, north_m = 111e3 * np.cos(np.radians(LAT)), 111e3
        steps = np.stack(
            [
                np.stack([(at.dlon_deg - seen.dlon_deg) * east_m, (at.lat_deg - seen.lat_deg) * north_m], axis=-1)
                / step
                for at in (right, below)
            ],
            axis=-1,
        )
        scales = np.linalg.svd(steps, compute_uv=False)
        assert float(finest_px_m(scene)[0]) <= 1.01 * float(scales[:, 1].min())
        assert ground_m_per_px(scene) >= 0.99 * float(scales[:, 0].max())
        assert 0.0 < float(camera_frame_px(scene)[0]) < 1e-5


def test_ideal_cameras_have_the_bounds_of_their_corners():
    camera = Camera(78.8)
    assert camera.extremes.image_xy.tolist() == [list(corner) for corner in CORNERS]
    assert camera.extremes.greatest_scale.tolist() == [1.0] * 4
