"""Images of an area with yaws at random: uniform, by the seed, without gaps, and with the overlap that is asked for."""

from __future__ import annotations

import json

import numpy as np
import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.sources import PatternSource

GRID = PixelGrid()
FIELD = Mission(Box(47.405, 8.500, 47.400, 8.510), 100.0, random_yaw=True)
TRIANGLE = Polygon((((8.500, 47.400), (8.510, 47.400), (8.505, 47.406)),))


def planned(**changes):
    return plan(FIELD.replace(**changes), GRID)


@pytest.mark.parametrize("area", [FIELD.area, TRIANGLE, Box(-60.0, 179.995, -60.004, -179.995)])
@pytest.mark.parametrize("overlap", [0.0, 0.4])
def test_no_gap_is_left_and_images_overlap_as_asked(area, overlap):
    made = planned(area=area, overlap_along=overlap, overlap_across=overlap)
    assert made.coverage.complete
    # Frames are whole pixels of about 640.
    assert made.overlap.least_along > overlap - 0.03
    assert made.overlap.least_across > overlap - 0.03


def test_yaws_are_uniform_and_follow_from_the_seed():
    made = planned(overlap_along=0.6, overlap_across=0.6)
    yaw = np.sort(made.poses.yaw_deg)
    assert len(yaw) > 500
    # Kolmogorov and Smirnov's distance, of which 1.63 / sqrt(n) is passed once in a hundred samples.
    assert np.abs((yaw + 180.0) / 360.0 - np.arange(len(yaw)) / len(yaw)).max() < 1.63 / np.sqrt(len(yaw))
    again, other = (
        planned(overlap_along=0.6, overlap_across=0.6),
        planned(overlap_along=0.6, overlap_across=0.6, seed=1),
    )
    np.testing.assert_array_equal(made.poses.yaw_deg, again.poses.yaw_deg)
    assert (made.poses.yaw_deg != other.poses.yaw_deg).all()
    np.testing.assert_array_equal(made.poses.lat_deg, other.poses.lat_deg)


def test_wind_turns_images_about_their_yaw():
    still, windy = planned(), planned(wind=Wind(5.0, 200.0, 0.1))
    turned = (windy.poses.yaw_deg - still.poses.yaw_deg + 180.0) % 360.0 - 180.0
    np.testing.assert_array_equal(windy.meant.yaw_deg, still.poses.yaw_deg)
    assert 0.0 < np.abs(turned).max() < 20.0


def test_files_for_drones_and_datasets_have_the_yaws(tmp_path):
    made = planned(agl_m=200.0, image_px=32)
    (file,) = write_plan(made, tmp_path / "field.plan").files
    items = json.loads(file.read_text())["mission"]["items"]
    headings = [item["params"][3] for item in items if item["command"] == 16]
    np.testing.assert_allclose(headings, np.mod(made.poses.yaw_deg, 360.0), atol=1e-9)
    source = PatternSource()
    written = plan(made.mission, source.grid)
    assert capture(written, source, tmp_path / "out").failed == ()
    table = read_dataset(tmp_path / "out").image_sets["satellite"].table
    np.testing.assert_allclose((table.yaw_deg - written.poses.yaw_deg + 180.0) % 360.0, 180.0, atol=1e-6)


def test_points_keep_their_yaws_and_tilted_cameras_are_refused():
    assert plan(FIELD.replace(area=Points(((47.4, 8.5, 100.0),), (30.0,))), GRID).poses.yaw_deg.tolist() == [30.0]
    with pytest.raises(InvalidInput, match="random yaw with a tilt of 20 and a roll of 0 deg: must look straight down"):
        planned(tilt_deg=20.0)
