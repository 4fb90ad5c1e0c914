"""Camera frames against the embedded world's true values, and against the 50-digit camera."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.errors import PartError
from terrainav.core.geodesy.mercator import lat_to_v, lon_to_u
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.camera_frame import camera_parts, render
from terrainav.core.picture.resampling import KERNELS, sample
from terrainav.core.world import WorldSource

from tests.core.geodesy.reference import see
from tests.support.thinning import sampled

WORLD = WorldSource()
LON = -89.86


class Coordinates:
    """A source of the world's own pixels whose colours say where they are: position modulo 256, and the zoom."""

    grid = WORLD.grid

    def fetch(self, window):
        column = window.left_px + np.arange(window.width_px)
        row = window.top_px + np.arange(window.height_px)
        tile = np.zeros((window.height_px, window.width_px, 3), np.uint8)
        tile[..., 0] = column % 256
        tile[..., 1] = row[:, np.newaxis] % 256
        tile[..., 2] = window.zoom
        return tile


def one(lat=35.14, agl=120.0, lon=LON, **changes):
    return plan(Mission(Points(((lat, lon, agl),)), agl, frame="camera", **changes), WORLD.grid)


def picture_of(worked_out, fetch, kernel="bilinear"):
    view, lon = worked_out.views.view(0), float(worked_out.lon_deg[0])
    parts = camera_parts(view, lon)
    return render(view, lon, parts, {part.window: fetch(part.window) for part in parts}, kernel), view


def satellite(window):
    return WORLD.fetch("satellite", window)


@pytest.mark.parametrize(
    ("lat", "agl", "lon", "attitude"),
    sampled(
        [
            (35.14, 120.0, LON, {}),
            (35.14, 120.0, LON, {"yaw_deg": 30.0, "tilt_deg": 60.0}),
            (-47.5, 1200.0, 179.9999, {"yaw_deg": 200.0, "tilt_deg": 20.0, "roll_deg": -15.0}),
            (35.14, 120.0, LON, {"tilt_deg": 45.0, "roll_deg": 25.0}),
            (40.1, 8e6, -90.0, {}),
        ],
        3,
    ),
)
@pytest.mark.parametrize("mesh", ["auto", "rays"])
def test_each_pixel_shows_the_ground_that_the_50_digit_camera_sees(lat, agl, lon, attitude, mesh):
    """Nearest neighbours name the source pixel that each picture pixel was taken from."""
    worked_out = one(lat, agl, lon, mesh=mesh, resampling="nearest", **attitude)
    picture, view = picture_of(worked_out, Coordinates().fetch, "nearest")
    height, width = picture.shape[:2]
    single = _single_sample(view)
    camera = worked_out.mission.camera
    pose = [float(values[0]) for values in worked_out.poses.attitude]
    checked = 0
    rng = np.random.default_rng(7)
    for row, column in zip(rng.integers(0, height, 400).tolist(), rng.integers(0, width, 400).tolist()):
        if not single[row, column]:
            continue
        x, y = (column + 0.5) / width * 2 - 1, 1 - (row + 0.5) / height * 2
        seen = see(lat, agl, camera.fov_deg, camera.aspect_ratio, *pose, x, y)
        assert seen is not None
        world = WORLD.grid.world_px(int(picture[row, column, 2]))
        exact = (
            float(lon_to_u(np.array(lon + float(seen[1])))) * world,
            float(lat_to_v(np.array(float(seen[0])))) * world,
        )
        for shown, wanted in zip(picture[row, column, :2].tolist(), exact):
            away = (shown + 0.5 - wanted + 128.0) % 256.0 - 128.0
            # Half a source pixel for the nearest, and the mesh's bound in source pixels.
            assert abs(away) <= 0.5 + 0.2
        checked += 1
    assert checked > 20


def _single_sample(view):
    """Pixels that are one sample of the source and not the mean of several."""
    single = np.zeros((view.height_px, view.width_px), bool)
    for patches in view.patches:
        if patches.samples_x == patches.samples_y == 1:
            for left, top, right, bottom in patches.box.tolist():
                single[top:bottom, left:right] = True
    for samples in view.samples:
        if samples.du.shape[1] == 1:
            single[samples.row, samples.column] = True
    return single


@pytest.mark.parametrize("attitude", [{}, {"tilt_deg": 30.0, "yaw_deg": 77.0}])
def test_pictures_are_the_worlds_true_values(attitude):
    worked_out = one(**attitude)
    picture, view = picture_of(worked_out, satellite)
    camera, pose = worked_out.mission.camera, worked_out.poses
    rng = np.random.default_rng(3)
    rows, columns = rng.integers(0, view.height_px, 600), rng.integers(0, view.width_px, 600)
    single = _single_sample(view)[rows, columns]
    rows, columns = rows[single], columns[single]
    angles = [float(angle[0]) for angle in pose.attitude]
    u, v, zoom = [], [], []
    zooms = picture_of(worked_out, Coordinates().fetch)[0][..., 2]
    for row, column in zip(rows.tolist(), columns.tolist()):
        x, y = (column + 0.5) / view.width_px * 2 - 1, 1 - (row + 0.5) / view.height_px * 2
        lat, dlon = see(35.14, 120.0, camera.fov_deg, camera.aspect_ratio, *angles, x, y)
        u.append(float(lon_to_u(np.array(LON + float(dlon)))))
        v.append(float(lat_to_v(np.array(float(lat)))))
        zoom.append(float(zooms[row, column]))
    true = WORLD.world.colour("satellite", np.array(u), np.array(v), np.array(zoom))
    error = picture[rows, columns].astype(float) - true
    assert len(rows) > 300
    # Sharp edges of roofs lie between pixels: bilinear interpolation is off there, and nowhere else.
    assert np.median(np.abs(error)) <= 1.0
    assert np.sqrt(np.mean(error**2)) < 12.0


def test_sky_is_black_and_its_share_is_counted():
    worked_out = one(tilt_deg=85.0)
    assert worked_out.masked
    picture, view = picture_of(worked_out, satellite)
    assert 0.3 < view.sky_share < 0.5
    assert not picture[view.sky].any()
    assert (picture[~view.sky].max(axis=-1) > 0).mean() > 0.999
    # The horizon lies below the horizontal by the dip, arccos(R/(R + h)).
    rows = np.flatnonzero(~view.sky[:, view.width_px // 2])
    dip = np.degrees(np.arccos(1 / (1 + 120.0 / 6.371e6)))
    focal = view.width_px / (2.0 * worked_out.mission.camera.half_tangents[0])
    horizon = view.height_px / 2 - focal * np.tan(np.radians(5.0 - dip))
    assert abs(rows[0] - horizon) <= 1.0


def test_the_visible_cap_from_very_high():
    worked_out = one(40.1, 8e6, -90.0)
    _, view = picture_of(worked_out, satellite)
    assert view.sky_share == pytest.approx(1 - 0.593, abs=2e-3)
    assert 0.0 < view.unmapped_share < 0.01
    assert worked_out.views.poles[0] == 1
    assert not worked_out.corners.hit.any()


def test_rays_and_mesh_agree():
    meshed, _ = picture_of(one(tilt_deg=60.0, yaw_deg=30.0), satellite)
    traced, _ = picture_of(one(tilt_deg=60.0, yaw_deg=30.0, mesh="rays"), satellite)
    difference = meshed.astype(float) - traced
    assert np.sqrt(np.mean(difference**2)) < 1.0


def test_every_kernel_makes_the_picture():
    pictures = {kernel: picture_of(one(resampling=kernel), satellite, kernel)[0].astype(float) for kernel in KERNELS}
    for kernel, picture in pictures.items():
        rms = np.sqrt(np.mean((picture - pictures["lanczos"]) ** 2))
        assert (rms == 0.0) == (kernel == "lanczos")
        assert rms < 15.0


def test_missing_imagery_fails_the_picture_and_only_where_it_is_seen():
    worked_out = one()
    view = worked_out.views.view(0)
    parts = camera_parts(view, LON)
    tiles = {part.window: np.dstack([satellite(part.window), np.full((256, 256), 255, np.uint8)]) for part in parts}
    assert render(view, LON, parts, tiles, "bilinear").any()
    middle = parts[len(parts) // 2].window
    tiles[middle][100:140, 100:140, 3] = 0
    with pytest.raises(PartError, match="no imagery"):
        render(view, LON, parts, tiles, "bilinear")
    tiles[middle] = tiles[middle][:100]
    with pytest.raises(PartError, match="was asked for"):
        render(view, LON, parts, tiles, "bilinear")


@pytest.mark.parametrize("kernel", list(KERNELS))
def test_kernels_keep_constants_and_meet_the_pixels(kernel):
    image = np.random.default_rng(1).integers(0, 256, (9, 11, 3)).astype(np.uint8)
    rows, columns = np.mgrid[0:9, 0:11]
    values = sample(image, columns.ravel() + 0.5, rows.ravel() + 0.5, kernel)
    np.testing.assert_allclose(values.reshape(image.shape), image, atol=1e-4)
    flat = np.full((4, 4, 1), 77, np.uint8)
    anywhere = np.random.default_rng(2).uniform(-3, 7, (2, 50))
    np.testing.assert_allclose(sample(flat, *anywhere, kernel), 77.0, rtol=1e-6)


@pytest.mark.parametrize(("kernel", "degree"), [("bilinear", 1), ("bicubic", 2)])
def test_kernels_reproduce_polynomials(kernel, degree):
    line = 2 * np.arange(10) ** degree
    image = np.broadcast_to(line[np.newaxis, :, np.newaxis], (8, 10, 1)).astype(np.uint8)
    at = np.linspace(2.5, 7.5, 30)
    values = sample(image, at, np.full(30, 4.0), kernel)[:, 0]
    np.testing.assert_allclose(values, 2 * (at - 0.5) ** degree, rtol=1e-5)
