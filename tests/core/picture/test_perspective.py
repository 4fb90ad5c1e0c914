"""Camera frames of level ground: compiled code draws what Pillow draws, and is loaded where that pays."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from terrainav.core.errors import PartError
from terrainav.core.external import compiling
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.view import Patches
from terrainav.core.picture import camera_frame

needs_numba = pytest.mark.skipif(not compiling.uses_numba(), reason="numba is not installed")
GRID, ZOOM = PixelGrid(), 8
HEIGHT, WIDTH = 60, 90


def patches(rng, wide, high):
    """Two boxes of a picture, side by side, whose corners lie on an image of 90 x 60 px and around it."""
    box = np.array([[0, 0, 13, 20], [13, 0, 32, 20]])
    corners = np.array([[0.1, 0.1], [0.2, 0.9], [0.9, 1.05], [1.05, 0.0]]) * (WIDTH, HEIGHT)
    x, y = (corners + rng.uniform(-9.0, 9.0, (2, 4, 2))).transpose(2, 0, 1) / GRID.world_px(ZOOM)
    return Patches(ZOOM, wide, high, box, x, y)


def pictures(patch, pixels, kernel, missing=None):
    """The same picture by Pillow and by compiled code."""
    ground = camera_frame._Ground(pixels, missing, 0, 0, is_compiled=True)
    found = []
    for warp in (camera_frame._warp, camera_frame._warp_compiled):
        picture = np.zeros((24, 32, pixels.shape[2]), pixels.dtype)
        warp(picture, patch, ground, GRID, 0.0, kernel)
        found.append(picture)
    return found


@needs_numba
@pytest.mark.parametrize("kernel", ["nearest", "bilinear"])
@pytest.mark.parametrize(("wide", "high"), [(1, 1), (1, 2), (1, 8), (2, 1), (4, 1), (2, 2), (4, 8), (8, 4)])
@pytest.mark.parametrize(
    ("data_type", "channels"), [("uint8", 1), ("uint8", 3), ("uint8", 4), ("uint16", 2), ("int16", 1), ("float32", 3)]
)
def test_patches_are_those_of_pillow_to_the_last_bit(kernel, wide, high, data_type, channels):
    rng = np.random.default_rng([wide, high, channels])
    for _ in range(5):
        high_value = {"uint8": 256, "uint16": 65536}.get(data_type, 32768)
        low_value = -32768 if data_type == "int16" else 0
        pixels = rng.integers(low_value, high_value, (HEIGHT, WIDTH, channels)).astype(data_type)
        if data_type == "float32":
            pixels /= np.float32(7.0)
        wanted, found = pictures(patches(rng, wide, high), pixels, kernel)
        assert wanted.any()
        assert np.array_equal(found, wanted)


@needs_numba
def test_missing_imagery_is_refused_as_without():
    rng = np.random.default_rng(1)
    pixels, missing = np.full((HEIGHT, WIDTH, 3), 9, np.uint8), np.zeros((HEIGHT, WIDTH), bool)
    pictures(patches(rng, 1, 2), pixels, "bilinear", missing)
    missing[25:30, 40:45] = True
    reasons = []
    for warp in (camera_frame._warp, camera_frame._warp_compiled):
        ground = camera_frame._Ground(pixels, missing, 0, 0, is_compiled=True)
        with pytest.raises(PartError) as refused:
            warp(np.zeros((24, 32, 3), np.uint8), patches(np.random.default_rng(1), 1, 2), ground, GRID, 0.0, "nearest")
        reasons.append(str(refused.value))
    assert reasons[0] == reasons[1]


@needs_numba
@pytest.mark.parametrize(("images", "is_loaded"), [(1, False), (99, False), (100, True)])
def test_numba_is_loaded_only_where_level_images_are_many(images, is_loaded):
    code = f"""
import sys
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.camera_frame import load_code
from terrainav.core.picture.shot import draw, make_shot, picture_parts
from terrainav.core.world import WorldSource

source = WorldSource()
points = tuple((35.14 + 1e-5 * at, -89.86, 120.0) for at in range({images}))
made = plan(Mission(Points(points), 120.0, tilt_deg=60.0), source.grid)
load_code(made)
parts = picture_parts(made, source, 0)
draw(make_shot(made, 0), parts, {{part.window: source.fetch("satellite", part.window) for part in parts}})
print("numba" in sys.modules)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == f"{is_loaded}\n"
