"""Pixels that average what they cover, against dense integrals, and by every way of making a picture."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from terrainav.core.camera.light import linear
from terrainav.core.errors import InvalidInput
from terrainav.core.external.compiling import numba_problem, without_numba
from terrainav.core.geodesy.areas import MOST_LENGTH, plane_areas
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.shot import draw, make_shot, picture_parts

from tests.core.picture.test_camera_frame import WORLD, satellite
from tests.core.picture.zone_plate import GRID, LAT, LON, ZonePlate


def asked(agl=120.0, **changes):
    return Mission(Points(((LAT, LON, agl),)), agl, **{"frame": "camera", "image_px": 96, **changes})


def planned(grid=GRID, **changes):
    mission = asked(**changes)
    return plan(mission, grid, mission_heights(mission) if mission.terrain.elevation else None)


@pytest.mark.parametrize(
    ("plate", "changes"),
    [
        (ZonePlate(1.0 / 60.0), {}),
        (ZonePlate(1.0 / 94.0), {"agl": 150.0}),
        (ZonePlate(1.0 / 150.0), {"agl": 190.0, "yaw_deg": 30.0}),
        (ZonePlate(1.0 / 15_000.0, 2_000.0), {"tilt_deg": 85.0}),
    ],
    ids=["2-m", "3-m", "turned", "tilt-85"],
)
def test_zone_plates_have_under_a_hundredth_of_the_aliases_of_interpolation(plate, changes):
    """Straight down with pixels of metres, and at a tilt of 85° up to 12 rows below the horizon."""
    truth = plate.truth(planned(**changes), 12, 48)
    ground = np.isfinite(truth)
    ground[: np.argmax(ground.all(axis=1)) + 12 if not ground.all() else 0] = False
    interpolated, mean = (
        float(((plate.picture(planned(**changes, sampling=sampling)) - truth)[ground] ** 2).sum())
        for sampling in ("zoom", "area")
    )
    assert mean < 0.01 * interpolated


@pytest.mark.parametrize("attitude", [{}, {"tilt_deg": 85.0}, {"tilt_deg": 60.0, "roll_deg": 30.0, "yaw_deg": 20.0}])
def test_mesh_and_rays_and_numpy_give_the_same_pixels(attitude):
    pictures = []
    for mesh in ("auto", "rays"):
        shot = make_shot(planned(WORLD.grid, mesh=mesh, sampling="area", **attitude), 0)
        parts = picture_parts(shot.plan, WORLD, 0)
        pixels = {part.window: satellite(part.window) for part in parts}
        pictures.append(draw(shot, parts, pixels).pixels)
        with without_numba():
            assert np.array_equal(draw(shot, parts, pixels).pixels, pictures[-1])
        if numba_problem() is None:
            import numba  # noqa: F401

            assert np.array_equal(draw(shot, parts, pixels).pixels, pictures[-1])
    off = np.abs(pictures[0].astype(int) - pictures[1])
    assert (off > 1).mean() < 0.005


def test_an_even_picture_stays_as_it_is():
    shot = make_shot(planned(sampling="area", tilt_deg=80.0), 0)
    parts = picture_parts(shot.plan, WORLD, 0)
    for value in (0, 1, 77, 254, 255):
        tile = np.full((256, 256, 3), value, np.uint8)
        pixels = draw(shot, parts, {part.window: tile for part in parts}).pixels
        assert (pixels[~shot.hidden] == value).all()


def test_a_mean_is_of_light_and_not_of_values():
    """Black and white stripes of a pixel of the source are half the light, sRGB 188, and not 128."""
    shot = make_shot(planned(sampling="area"), 0)
    parts = picture_parts(shot.plan, WORLD, 0)
    tile = np.zeros((256, 256, 3), np.uint8)
    tile[::2] = 255
    drawn = draw(shot, parts, {part.window: tile for part in parts}).pixels
    assert abs(float(drawn.mean()) - 188.0) < 1.0


def steps_of(rng, count, ratio):
    """Sides of parallelograms (n,) with axes of a ratio, turned on the ground and in the pixel."""
    turns, inner = rng.uniform(0.0, 2.0 * np.pi, (2, count))
    size = 2.0 ** rng.uniform(-24.0, -16.0, count)
    left, right = (
        np.moveaxis(np.array([[np.cos(one), -np.sin(one)], [np.sin(one), np.cos(one)]]), 2, 0) for one in (turns, inner)
    )
    scale = np.zeros((count, 2, 2))
    scale[:, 0, 0], scale[:, 1, 1] = size * ratio, size
    across, down = np.moveaxis(left @ scale @ right, 2, 0)
    return (tuple(across.T), tuple(down.T)), left @ scale @ right


@pytest.mark.parametrize("ratio", [1.0, 1.7, 5.0, 12.0])
def test_samples_and_the_sources_blur_have_the_second_moments_of_the_pixel(ratio):
    """J Jᵀ/12 is the covariance of a box under J; a source's pixel and bilinear interpolation have one of 1/4."""
    rng = np.random.default_rng(5)
    steps, jacobian = steps_of(rng, 300, ratio)
    places = rng.uniform(-0.1, 0.1, 300), rng.uniform(0.3, 0.5, 300)
    rows = np.arange(300)
    seen = 0
    for areas in plane_areas(rows, rows, places, steps, PixelGrid(), (0, 22)):
        world = float(PixelGrid().world_px(areas.zoom))
        for row, _, du, v in areas.samples(1 << 16):
            off = np.stack([du - places[0][row, None], v - places[1][row, None]], axis=1) * world
            assert np.abs(off.mean(axis=2)).max() < 1e-6
            found = off @ off.transpose(0, 2, 1) / off.shape[2] + np.eye(2) / 4.0
            wanted = jacobian[row] @ jacobian[row].transpose(0, 2, 1) * world**2 / 12.0
            assert np.abs(found - wanted).max() < 1e-6 * np.abs(wanted).max()
            seen += len(row)
        assert areas.counts.max() <= MOST_LENGTH
    assert seen == 300


def test_a_long_pixel_takes_a_lower_zoom_so_that_its_samples_are_bounded():
    one = np.array([0])
    step = (np.array([2.0**-26]), np.array([0.0])), (np.array([0.0]), np.array([2.0**-12]))
    (areas,) = plane_areas(one, one, (np.zeros(1), np.full(1, 0.4)), step, PixelGrid(), (0, 22))
    assert 2.0**-12 * PixelGrid().world_px(areas.zoom) <= MOST_LENGTH < 2.0**-12 * PixelGrid().world_px(areas.zoom + 1)
    assert areas.counts.prod() <= MOST_LENGTH


def test_where_the_source_is_coarse_a_pixel_is_interpolated_once():
    """Nothing is averaged twice: one sample, as the source's own pixel is larger than the picture's."""
    grid = PixelGrid(max_zoom=16, native_zoom=16)
    view = planned(grid, sampling="area", agl=60.0, image_px=640).views.view(0)
    areas = [one for zoom in view.zooms for one in view.areas(zoom)]
    assert all((one.counts == 1).all() for one in areas)


def test_other_kernels_are_refused():
    with pytest.raises(InvalidInput, match="resampling nearest: must be bilinear for sampling area"):
        planned(sampling="area", resampling="nearest")


@pytest.mark.parametrize("attitude", [{"tilt_deg": 70.0, "roll_deg": 25.0}])
def test_relief_and_roofs_have_the_same_pixels_with_and_without_numba(attitude):
    """Of the synthetic world with its houses; numpy finds the hits and draws, too."""
    values = {"sampling": "area", "agl": 150.0, "elevation": ("world",), "surface": ("world",), **attitude}
    pictures = []
    for fast in (True, False):
        with nullcontext() if fast else without_numba():
            worked_out = planned(WORLD.grid, **values)
            assert not worked_out.relief.is_level
            parts = picture_parts(worked_out, WORLD, 0)
            pixels = {part.window: satellite(part.window) for part in parts}
            pictures.append(draw(make_shot(worked_out, 0), parts, pixels).pixels)
            zooms = [part.zoom for part in worked_out.views.view(0).samples]
            assert len(zooms) == len(set(zooms))
    off = np.abs(pictures[0].astype(int) - pictures[1])
    assert (off > 1).mean() < 0.002


def over_relief(sampling, image_px, tilt_deg, **surface):
    """Linear light (h, w, 3) of the synthetic world with relief."""
    values = {"elevation": ("world",), "agl": 150.0, **surface}
    worked_out = planned(WORLD.grid, sampling=sampling, image_px=image_px, tilt_deg=tilt_deg, **values)
    parts = picture_parts(worked_out, WORLD, 0)
    drawn = draw(make_shot(worked_out, 0), parts, {part.window: satellite(part.window) for part in parts})
    return linear(drawn.pixels[..., :3] / 255.0)


@pytest.mark.parametrize(("tilt_deg", "surface"), [(0.0, {"surface": ("world",)})])
def test_over_relief_a_pixel_is_the_mean_of_64_pixels_of_a_larger_image(tilt_deg, surface):
    """Edges of what hides other things are those at a pixel's middle: houses of a few pixels only straight down."""
    fine = over_relief("zoom", 8 * 64, tilt_deg, **surface)
    wanted = fine.reshape(fine.shape[0] // 8, 8, fine.shape[1] // 8, 8, 3).mean(axis=(1, 3))
    shown = wanted.min(axis=2) > 0.0
    interpolated, mean = (
        float(np.median(np.abs(over_relief(one, 64, tilt_deg, **surface) - wanted).max(axis=2)[shown]))
        for one in ("zoom", "area")
    )
    assert mean < 0.3 * interpolated, (mean, interpolated)
