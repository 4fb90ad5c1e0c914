"""Compiled code against numpy's: the same samples, tiles and values, and the same hits within the bound."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.external import compiling
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.tracing import Tracing
from terrainav.core.picture.resampling import sample

from tests.core.geodesy.cliffs import Kept, blocks, holes, surface_about, terraces

pytestmark = pytest.mark.skipif(not compiling.uses_numba(), reason="numba is not installed")

TOLERANCE_PX = 0.02
ZOOMS = (0, 22)


def with_numpy(work):
    """Result of work that is done without numba."""
    with compiling.without_numba():
        return work()


def tracing(kind, tilt_deg, crs="EPSG:32616", place=(35.1, -89.9)):
    z = np.full((160, 160), 100.0)
    kind(z, np.random.default_rng(5))
    surface, size_m = surface_about(crs, *place, 1.0, z)
    poses = Poses(*(np.array([value]) for value in (*place, 90.0, 33.0, tilt_deg, 4.0)))
    height_m = float(np.nanmax(z)) + 90.0
    return Tracing(
        ImageGeometry(Camera(78.8, 4 / 3), 160, 120, poses), height_m, Kept(surface, size_m), 50.0, TOLERANCE_PX
    )


@pytest.mark.parametrize("kind", [terraces, blocks, holes])
@pytest.mark.parametrize("tilt_deg", [0.0, 70.0])
def test_samples_and_tiles_are_those_of_numpy(kind, tilt_deg):
    made, grid = tracing(kind, tilt_deg), PixelGrid(max_zoom=22, native_zoom=22)
    view, wanted = made.view(grid, ZOOMS), with_numpy(lambda: made.view(grid, ZOOMS))
    assert view.facade_share == wanted.facade_share
    assert np.array_equal(view.unmapped, wanted.unmapped)
    assert [part.zoom for part in view.samples] == [part.zoom for part in wanted.samples]
    for part, other in zip(view.samples, wanted.samples):
        assert np.array_equal(part.row, other.row)
        assert np.array_equal(part.column, other.column)
        world = grid.world_px(part.zoom)
        assert part.du * world == pytest.approx(other.du * world, abs=1e-5)
        assert part.v * world == pytest.approx(other.v * world, abs=1e-5)
    assert view.tiles(-89.9) == with_numpy(lambda: view.tiles(-89.9))


@pytest.mark.parametrize("kind", [terraces, blocks, holes])
def test_hits_are_those_of_numpy_but_where_rays_graze_an_edge(kind):
    found = tracing(kind, 55.0).depth_m
    wanted = with_numpy(lambda: tracing(kind, 55.0).depth_m)
    assert np.mean(np.isnan(found) != np.isnan(wanted)) < 1e-3
    met = np.isfinite(found) & np.isfinite(wanted)
    off = np.abs(found[met] - wanted[met]) / wanted[met]
    assert np.mean(off > 1e-4) < 2e-3
    assert np.median(off) < 1e-6


@pytest.mark.parametrize("data_type", ["uint8", "uint16", "float32"])
@pytest.mark.parametrize("channels", [1, 3, 5])
def test_bilinear_values_are_those_of_numpy_to_the_last_digit(data_type, channels):
    rng = np.random.default_rng(1)
    image = rng.integers(0, 256, (50, 70, channels)).astype(data_type)
    x, y = rng.uniform(-5.0, 75.0, 1000), rng.uniform(-5.0, 55.0, 1000)
    found = sample(image, x, y, "bilinear")
    wanted = with_numpy(lambda: sample(image, x, y, "bilinear"))
    assert found.dtype == wanted.dtype
    assert np.array_equal(found, wanted)


@pytest.mark.parametrize("shape", [(2, 2), (3, 8), (17, 16), (64, 41)])
def test_blocks_have_the_greatest_height_of_their_cells(shape):
    from terrainav.core.geodesy.raytracing.kernels import HeightBlocks

    heights = np.random.default_rng(2).normal(size=shape).astype(np.float32)
    heights[np.random.default_rng(3).random(shape) < 0.1] = np.nan
    blocks = HeightBlocks.build(heights)
    assert max(blocks.high[-1], blocks.wide[-1]) == 1
    for level in range(1, len(blocks.first)):
        size, (high, wide) = 1 << level, (blocks.high[level], blocks.wide[level])
        assert (high, wide) == tuple(-(-(side - 1) // size) for side in shape)
        for i, j in np.ndindex(high, wide):
            # Cells share the heights of their edges with their neighbours.
            among = heights[i * size : (i + 1) * size + 1, j * size : (j + 1) * size + 1]
            wanted = np.max(among, where=np.isfinite(among), initial=-np.inf)
            assert blocks.flat[blocks.first[level] + i * wide + j] == wanted
