"""Rays over cliffs, against PROJ and a walk from cell to cell: none is lost, none is off by more than the bound."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.raytracing.tracing import Tracing

from tests.core.geodesy.cliffs import SIDE, SYSTEMS, Kept, Truth, random_scene, surface_about
from tests.support.thinning import sampled

pytestmark = pytest.mark.usefixtures("ray_code")


@pytest.mark.parametrize(
    "seeds",
    [
        *sampled(
            [range(first, first + 6) for first in range(0, 60, 6)]
            + [pytest.param(range(first, first + 50), marks=pytest.mark.thorough) for first in range(60, 1060, 50)],
            4,
        ),
        # Rays from beneath that reach the second ring.
        (85, 497, 506, 565),
    ],
    ids=lambda seeds: f"{seeds[0]}-{seeds[-1]}",
)
def test_random_scenes_with_cliffs(seeds):
    for seed in seeds:
        found = random_scene(seed)
        assert (found.lost, found.passed, found.beyond) == (0, 0, 0), seed


@pytest.mark.parametrize(("crs", "lat", "lon"), SYSTEMS)
@pytest.mark.parametrize("cell_m", [0.5, 30.0])
def test_rays_that_cross_from_cell_to_cell_within_a_cliff_are_not_lost(crs, lat, lon, cell_m):
    """They come to the cliff's cells as near to their edges as a step is inexact, and deep below the surface there."""
    z = np.zeros((SIDE, SIDE))
    z[:, SIDE // 2 :] = 120.0 * cell_m
    surface, _ = surface_about(crs, lat, lon, cell_m, z)
    at_lat, at_lon = (float(at[0]) for at in surface.places(np.array([SIDE / 2 - 30.0]), np.array([SIDE / 2.0])))
    height = 90.0 * cell_m
    truth = Truth(surface, crs, at_lat, at_lon, height)
    rng = np.random.default_rng(5)
    # Just before the cliff's foot, and behind the edges of rows, along the cliff.
    row = rng.uniform(SIDE / 2 - 20, SIDE / 2 + 20, 4000)
    row[::2] = np.rint(row[::2]) + 10.0 ** rng.uniform(-9, -3, 2000) * rng.choice([-1, 1], 2000)
    share = 10.0 ** rng.uniform(-9, 0, 4000) * 0.7
    column = SIDE / 2 - 1 + share
    points = truth.seen_from(*surface.places(column, row), truth.heights(column, row))
    paths, farthest, _ = surface.paths(at_lat, at_lon, height, _rays(points), 1e-3)
    hits = surface.first_hits(paths.start, paths.coefficients(points), np.full(4000, farthest))
    assert np.isfinite(hits.t).all()
    assert np.abs(hits.t - 1.0).max() < 1e-4


def _rays(points):
    """Rays of an image that looks along all of some ways."""
    tracing = ImageGeometry(
        Camera(150.0, 4 / 3),
        640,
        480,
        Poses(*(np.array([value]) for value in (0.0, 0.0, 1.0, 90.0, 45.0, 0.0))),
    )
    return Tracing(tracing, 1.0, None, 0.0, 0.02).rays


def test_a_pixel_whose_ray_steps_into_a_cliff_sees_it():
    rng = np.random.default_rng(115)
    z = rng.normal(0, 0.2, (SIDE, SIDE))
    z[:, SIDE // 2 :] += rng.uniform(60, 150)
    grid = PixelGrid(max_zoom=15, native_zoom=15)
    u, v = grid.plane.forward(np.array([69.8]), np.array([7.0]))
    world = grid.world_px(15)
    left, top = int(u[0] * world) - SIDE // 2, int(v[0] * world) - SIDE // 2
    surface = Surface(grid, 15, left, top, z.astype(np.float32))
    lat, lon = surface.places(np.array([SIDE / 2 - 20.0]), np.array([SIDE / 2.0]))
    yaw, tilt, roll = rng.uniform(40, 140), rng.uniform(10, 40), rng.uniform(-10, 10)
    pose = Poses(*(np.array([value]) for value in (lat[0], lon[0], 200.0, yaw, tilt, roll)))
    scene = ImageGeometry(Camera(60.0, 4 / 3), 640, 480, pose)
    depth = Tracing(scene, 200.0, Kept(surface, 2.0), surface.lowest_m - 20.0, 0.02).depth_m
    assert np.isfinite(depth).all()
    assert depth[285, 313] == pytest.approx(202.370, abs=1e-3)
