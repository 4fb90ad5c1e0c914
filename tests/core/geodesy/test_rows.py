"""Parts of images: their rows see what the same rows of the whole image see."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.view import view
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

from tests.core.geodesy.boxes import Boxes, tracing_of

GRID = PixelGrid(max_zoom=22, native_zoom=22)
SIZE, ROWS = (160, 120), (37, 90)


def positions(seen):
    """World fractions (height, width, 2) of the pixels of a view that traces each; NaN for none."""
    found = np.full((seen.height_px, seen.width_px, 2), np.nan)
    for part in [*seen.samples, *(part for patches in seen.patches for part in seen.traced(patches))]:
        found[part.row, part.column] = np.stack([part.du.mean(axis=1), part.v.mean(axis=1)], axis=-1)
    return found


@pytest.mark.parametrize("tilt_deg", [0.0, 50.0, 85.0])
def test_rows_of_level_ground_are_those_of_the_whole_image(tilt_deg):
    pose = Poses(*(np.array([value]) for value in (46.95, 7.45, 300.0, 33.0, tilt_deg, 3.0)))
    scene = ImageGeometry(Camera(78.8, SIZE[0] / SIZE[1]), *SIZE, pose)
    whole = view(scene, GRID, (22, 22), 0.0, by_rays=True)
    part = view(scene, GRID, (22, 22), 0.0, by_rays=True, rows=ROWS)
    assert (part.width_px, part.height_px) == (SIZE[0], ROWS[1] - ROWS[0])
    wanted = positions(whole)[slice(*ROWS)]
    assert np.isnan(wanted).any() == (tilt_deg > 80.0)
    # Cells of other sizes have other numbers of samples.
    pixel = np.nanmedian(np.abs(np.diff(wanted, axis=0)))
    assert positions(part) == pytest.approx(wanted, abs=0.02 * pixel, nan_ok=True)


@pytest.mark.usefixtures("ray_code")
@pytest.mark.parametrize("tilt_deg", [0.0, 60.0])
def test_rows_over_relief_and_of_buildings_are_those_of_the_whole_image(tilt_deg):
    rng = np.random.default_rng(3)
    ground = 100.0 + np.cumsum(rng.normal(0.0, 1.0, (160, 160)), axis=1)
    west, south = rng.uniform(-280, 250, (2, 80))
    town = Boxes(np.stack([west, south, *rng.uniform(4, 25, (2, 80)), np.full(80, 60.0), np.full(80, 150.0)], axis=1))
    whole, part = (tracing_of(town, tilt_deg, ground=ground, rows=rows) for rows in (None, ROWS))
    wanted, found = whole.sighting, part.sighting
    assert found.depth_m.shape == (ROWS[1] - ROWS[0], SIZE[0])
    depth = wanted.depth_m[slice(*ROWS)]
    # Rays that graze an edge may be cut short in other places.
    off = np.abs(found.depth_m - depth) / depth
    assert np.mean(~(off < 1e-5) & np.isfinite(depth)) < 2e-3
    assert np.mean(found.instance != wanted.instance[slice(*ROWS)]) < 1e-3
    assert (found.instance > 0).any()


def test_a_pose_of_its_own_moves_the_camera_and_its_own_changes_nothing():
    mission = Mission(Points(((35.1408, -89.8606, 120.0),)), 120.0, source="world", elevation=("world",), tilt_deg=40.0)
    made = plan(mission, open_source("world").grid, mission_heights(mission))
    pose = made.poses.take(slice(0, 1))
    own, same = made.views.tracing(0), made.views.tracing(0, pose=pose, rows=(100, 140))
    assert same.height_m == own.height_m
    assert same.place == own.place
    moved = made.views.tracing(0, pose=pose._replace(agl_m=pose.agl_m + 8.0, tilt_deg=pose.tilt_deg + 1.0))
    assert moved.height_m == pytest.approx(own.height_m + 8.0, abs=1e-3)
    assert moved.scene.poses.tilt_deg == pytest.approx(own.scene.poses.tilt_deg + 1.0, abs=1e-4)
    part = made.views.view(0, rows=(100, 140), pose=pose)
    assert (part.width_px, part.height_px) == (640, 40)
