"""Poses whose footprints lie within the imagery: captured without a miss, and told apart by independent geometry."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Geod, Transformer

pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.dataset.table import Table
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.inside import captured_points, captures_inside, poses_inside
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.poses.random_poses import Distribution, PoseDistributions, random_poses

from tests.support import rasters
from tests.support.command import command

run = pytest.fixture(command, name="run")

EPSG, WEST, NORTH, SIDE = 32616, 230_000.0, 3_890_000.0, 400
_to_degrees = Transformer.from_crs(EPSG, 4326, always_xy=True)
_to_utm = Transformer.from_crs(4326, EPSG, always_xy=True)
_geod = Geod(ellps="WGS84")


@pytest.fixture(scope="module")
def raster(tmp_path_factory):
    """Raster of 400 x 400 m."""
    path = tmp_path_factory.mktemp("raster") / "ortho.tif"
    pixels = np.random.default_rng(1).integers(0, 255, (1, SIDE, SIDE), np.uint8)
    rasters.write(path, pixels, (WEST, 1.0, 0.0, NORTH, 0.0, -1.0), EPSG)
    return path


@pytest.fixture(scope="module")
def box():
    lon, lat = _to_degrees.transform([WEST, WEST + SIDE], [NORTH, NORTH - SIDE])
    return Box(lat[0], lon[0], lat[1], lon[1])


def sees_utm(poses, camera):
    """Eastings and northings (n, 4) of the ground corners, by geodesics from below the camera."""
    tan_x, tan_y = camera.half_tangents
    x, y = np.array([-1.0, 1.0, 1.0, -1.0]) * tan_x, np.array([1.0, 1.0, -1.0, -1.0]) * tan_y
    tilt = np.radians(poses.tilt_deg)[:, None]
    # Ahead along the image's top, and to its right, over a plane: the Earth curves away by micrometres.
    down = np.cos(tilt) - y * np.sin(tilt)
    ahead, right = (y * np.cos(tilt) + np.sin(tilt)) / down, x / down
    azimuth = poses.yaw_deg[:, None] + np.degrees(np.arctan2(right, ahead))
    away = poses.agl_m[:, None] * np.hypot(ahead, right)
    lat, lon = (np.broadcast_to(one[:, None], azimuth.shape) for one in (poses.lat_deg, poses.lon_deg))
    lon, lat, _ = _geod.fwd(lon, lat, azimuth, away)
    return _to_utm.transform(lon, lat)


def test_footprints_are_told_apart_by_where_geodesics_end(raster, box):
    camera, count = Camera(60.0), 4_000
    rng = np.random.default_rng(7)
    poses = Poses(
        rng.uniform(box.south_deg, box.north_deg, count),
        rng.uniform(box.west_deg, box.east_deg, count),
        rng.uniform(30.0, 90.0, count),
        rng.uniform(-180.0, 180.0, count),
        rng.uniform(0.0, 40.0, count),
        np.zeros(count),
    )
    east, north = sees_utm(poses, camera)
    # How far inside the raster the nearest corner is, metres.
    depth = np.min([east - WEST, WEST + SIDE - east, NORTH - north, north - NORTH + SIDE], axis=(0, 2))
    kept = poses_inside(open_source(str(raster)).grid, camera, poses, 640)
    assert 0.2 < kept.mean() < 0.8
    # Within the margin of four pixels of the raster and of the image.
    assert depth[kept].min() > 4.0 - 0.01
    assert depth[~kept].max() < 4.0 + 2.0


def test_random_poses_inside_are_captured_without_a_miss(raster, box, tmp_path, run):
    draw = [
        "poses",
        "random",
        "--area",
        "_".join(map(repr, (box.north_deg, box.west_deg, box.south_deg, box.east_deg))),
    ]
    draw += [
        "--count",
        "12",
        "--agl",
        "uniform",
        "40",
        "60",
        "--tilt",
        "uniform",
        "0",
        "30",
        "--output",
        "p.csv",
    ]
    fly = [
        "capture",
        "--coords",
        "p.csv",
        "--source",
        str(raster),
        "--image-px",
        "48",
        "--frame",
        "camera",
        "--quiet",
    ]
    fly += ["--format", "png", "--accept-error", "--data-dir"]
    assert run(*draw).returncode == 0
    missed = run(*fly, "any")
    assert missed.returncode != 0
    assert run(*draw, "--inside", "--source", str(raster)).returncode == 0
    assert run(*fly, "inside").returncode == 0
    table = Table.load(tmp_path / "inside" / "satellite" / "meta_data.csv")
    assert len(table) == 12
    assert not table.unmapped_share.any()


def test_a_smaller_count_is_the_beginning_of_a_larger_one_also_inside(raster, box):
    grid, camera = open_source(str(raster)).grid, Camera(60.0)
    poses = PoseDistributions(Distribution("uniform", 40.0, 80.0))

    def drawn(count):
        return random_poses(box, count, poses, 3, lambda some: poses_inside(grid, camera, some, 640))

    few, many = drawn(5), drawn(20)
    assert many.poses[:5] == few.poses
    assert few.yaws_deg == many.yaws_deg[:5]


def test_a_grid_of_an_area_keeps_what_lies_inside(raster, box):
    mission = Mission(box, 60.0, frame="camera", image_px=48, image_format="png", accept_error=True, yaw_deg=30.0)
    source = open_source(str(raster))
    worked_out = plan(mission, source.grid)
    kept = captures_inside(worked_out, source.grid)
    assert 0 < kept.sum() < len(kept)
    again = plan(captured_points(mission, worked_out, kept), source.grid)
    assert captures_inside(again, source.grid).all()
    assert len(again) == kept.sum()
