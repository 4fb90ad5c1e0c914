"""Images of an area with yaws at random: uniform, by the seed, without gaps, and with the overlap that is asked for."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Transformer
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

from tests.support.sources import PatternSource
from tests.support.thinning import examples

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


UTM = PixelGrid(native_zoom=15, max_zoom=15, plane=ProjectedPlane("EPSG:32632", 310_000.0, 5_410_000.0, 2**22, 2**22))


def on_rows(made, part):
    """Ground in metres along and across the rows of a pass, by PROJ's oblique equidistant projection."""
    middle = made.mission.area.bounds
    lat, lon = (middle.north_deg + middle.south_deg) / 2.0, middle.west_deg + middle.span_deg / 2.0
    to_plane = Transformer.from_crs(4326, f"+proj=aeqd +lat_0={lat} +lon_0={lon} +ellps=WGS84", always_xy=True)
    longest = part[made.row[part] == np.bincount(made.row[part]).argmax()][[0, -1]]
    x, y = to_plane.transform(made.lon_deg[longest], made.lat_deg[longest])
    turn = np.arctan2(y[1] - y[0], x[1] - x[0])

    def axes(lat_deg, lon_deg):
        x, y = to_plane.transform(lon_deg, lat_deg)
        return np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x

    return axes


def promised_m(made, part, along_m, across_m):
    """Width and height of ground that each image must show about its middle, for the overlap of its neighbours."""
    beside = (np.diff(made.row[part]) == 0) & (np.abs(np.diff(made.column[part])) == 1)
    row = np.unique(made.row[part])
    middles = np.array([across_m[made.row[part] == one].mean() for one in row])
    flight = made.mission.flight
    return (
        np.abs(np.diff(along_m)[beside]).max(initial=0.0) / (1.0 - flight.overlap_along),
        np.abs(np.diff(middles) / np.diff(row)).max(initial=0.0) / (1.0 - flight.overlap_across),
    )


@settings(max_examples=examples(15), deadline=None)
@given(
    azimuth=st.floats(0.0, 359.0),
    along=st.sampled_from([0.0, 0.3, 0.6]),
    across=st.sampled_from([0.0, 0.25, 0.5]),
    aspect=st.sampled_from([0.5, 1.0, 4.0 / 3.0, 2.4]),
    crosshatch=st.booleans(),
    grid=st.sampled_from([GRID, UTM]),
    area=st.sampled_from([FIELD.area, TRIANGLE]),
    seed=st.integers(0, 99),
)
def test_turned_rows_and_rows_of_other_systems_keep_the_overlap(
    azimuth, along, across, aspect, crosshatch, grid, area, seed
):
    changes = {"row_azimuth_deg": azimuth, "overlap_along": along, "overlap_across": across, "seed": seed}
    camera = Camera(FIELD.camera.fov_deg, aspect)
    made = plan(FIELD.replace(area=area, camera=camera, crosshatch=crosshatch, agl_m=150.0, **changes), grid)
    assert made.coverage.complete
    assert made.overlap.least_along >= along
    assert made.overlap.least_across >= across
    ends = [*(part.first for part in made.passes[1:]), len(made)]
    for one, end in zip(made.passes, ends):
        part = np.arange(one.first, end)
        axes = on_rows(made, part)
        x, y = axes(made.lat_deg[part], made.lon_deg[part])
        width, height = promised_m(made, part, x, y)
        # The exact cameras' corners, in order around each image.
        rings = np.stack(axes(made.corners.lat_deg[part], made.corners.lon_deg[part]), axis=-1)
        for across_m, up_m in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            corner = np.stack([x + across_m * width / 2.0, y + up_m * height / 2.0], axis=-1)[:, np.newaxis]
            side, to = np.roll(rings, -1, axis=1) - rings, corner - rings
            turned = side[..., 0] * to[..., 1] - side[..., 1] * to[..., 0]
            distance = turned / np.linalg.norm(side, axis=-1)
            # All on one side, whichever way around the corners go.
            assert (np.maximum(distance.min(axis=1), -distance.max(axis=1)) > 0.0).all()


def test_rows_over_relief_and_in_wind_are_whole():
    for changes in ({"elevation": ("world",)}, {"wind": Wind(5.0, 200.0, 0.1), "overlap_across": 0.3}):
        mission = FIELD.replace(row_azimuth_deg=20.0, overlap_along=0.3, **changes)
        made = plan(mission, GRID, mission_heights(mission) if "elevation" in changes else None)
        assert made.coverage.complete
        assert len(np.unique(made.meant.yaw_deg)) == len(made)
