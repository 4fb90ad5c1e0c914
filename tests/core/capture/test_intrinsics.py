"""Intrinsics in the table: a pinhole of theirs sees the ground where the pictures show it."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.sources import PatternSource

LAT, LON, AGL_M = 35.16, -89.9, 120.0
POINTS = Points(((LAT, LON, AGL_M), (LAT + 1e-3, LON, AGL_M)))
_to_cart = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True).transform
_to_map = Transformer.from_crs("EPSG:4326", "EPSG:3857", always_xy=True).transform


def captured(tmp_path, **options):
    mission = Mission(POINTS, AGL_M, image_format="png", accept_error=True, **options)
    source = PatternSource()
    capture(plan(mission, source.grid), source, tmp_path / "out")
    return tmp_path / "out" / "satellite"


def pinhole_px(row, lat, lon):
    """Column and row of ground on the ellipsoid by the table alone, of a camera that looks straight down, north up."""
    place = math.radians(float(row["pose_lat_deg"])), math.radians(float(row["pose_lon_deg"]))
    camera = np.array(_to_cart(float(row["pose_lon_deg"]), float(row["pose_lat_deg"]), float(row["agl_m"])))
    ground = np.array(_to_cart(lon, lat, np.zeros_like(lon)))
    (sin_lat, cos_lat), (sin_lon, cos_lon) = ((math.sin(one), math.cos(one)) for one in place)
    axes = np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [sin_lat * cos_lon, sin_lat * sin_lon, -cos_lat],
            [-cos_lat * cos_lon, -cos_lat * sin_lon, -sin_lat],
        ]
    )
    right, down, ahead = axes @ (ground - camera[:, None])
    fx, fy, cx, cy = (float(row[name]) for name in ("fx_px", "fy_px", "cx_px", "cy_px"))
    return cx + fx * right / ahead, cy + fy * down / ahead


@pytest.mark.parametrize("img_size", [None, (200, 100, 3)])
def test_a_map_frame_is_the_picture_of_its_equivalent_camera(tmp_path, img_size):
    folder = captured(tmp_path, **({} if img_size is None else {"img_size": img_size}))
    across, down = np.linspace(-3e-4, 3e-4, 7), np.linspace(-2e-4, 2e-4, 7)
    with (folder / "meta_data.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2
    for row in rows:
        lat, lon = float(row["pose_lat_deg"]) + down, float(row["pose_lon_deg"]) + across
        # Where the world file, which counts from the middle of the first pixel, says that the ground is.
        world = (folder / row["img_names"]).with_suffix(".pgw").read_text().split()
        pixel_x, _, _, pixel_y, west, north = map(float, world)
        x, y = _to_map(lon, lat)
        shown = (x - west) / pixel_x + 0.5, (y - north) / pixel_y + 0.5
        np.testing.assert_allclose(pinhole_px(row, lat, lon), shown, atol=0.02)


@pytest.mark.parametrize("fov_deg", [40.0, 90.0])
def test_a_camera_frame_has_the_intrinsics_of_its_camera(tmp_path, fov_deg):
    table = Table.load(captured(tmp_path, frame="camera", image_px=80, camera=Camera(fov_deg)) / "meta_data.csv")
    diagonal = np.hypot(table.image_width_px / table.fx_px, table.image_height_px / table.fy_px)
    np.testing.assert_allclose(diagonal, 2.0 * math.tan(math.radians(fov_deg / 2.0)), rtol=1e-7)
    np.testing.assert_array_equal(table.cx_px, table.image_width_px / 2.0)
    np.testing.assert_array_equal(table.cy_px, table.image_height_px / 2.0)


def test_tables_without_intrinsics_are_read_and_written_without_them(tmp_path):
    path = captured(tmp_path) / "meta_data.csv"
    with path.open(newline="") as file:
        headers, *rows = csv.reader(file)
    kept = [at for at, header in enumerate(headers) if header not in ("fx_px", "fy_px", "cx_px", "cy_px")]
    assert len(kept) == len(headers) - 4
    old = "".join(",".join(row[at] for at in kept) + "\n" for row in (headers, *rows))
    path.write_text(old)
    table = Table.load(path)
    assert np.isnan(table.fx_px).all()
    table.save(path)
    assert path.read_text().splitlines()[0] == old.splitlines()[0]
