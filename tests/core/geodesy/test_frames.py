"""Map frames against the 50-digit camera, and the rounding of their edges."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import CORNERS, EDGE_MIDPOINTS, Camera, Poses
from terrainav.core.geodesy.footprint import ground_corners
from terrainav.core.geodesy.frames import map_frame_edges, map_windows, window_centres
from terrainav.core.geodesy.mercator import PixelGrid, lat_to_v, lon_to_u

from tests.core.geodesy.reference import ground_point

CAMERA = Camera(78.8, 4 / 3)
# An edge rounded on its own is at most half a pixel off; the rest is float64's noise of positions.
HALF_PX = 0.5 + 1e-6


def poses(lat, lon, agl):
    return Poses.level(*(np.atleast_1d(np.asarray(column, float)) for column in (lat, lon, agl)))


@pytest.mark.parametrize(("lat", "lon"), [(35.14, -89.86), (0.0, 179.9999), (-47.5, -180.0), (84.0, 10.0)])
@pytest.mark.parametrize("agl", [10.0, 120.0, 16e3])
def test_each_edge_is_the_nearest_pixel_to_its_midpoint(lat, lon, agl):
    grid, zoom = PixelGrid(), 17
    windows = map_windows(CAMERA, poses(lat, lon, agl), grid, zoom)
    rays = CAMERA.rays_enu(EDGE_MIDPOINTS)
    north, east, south, west = (ground_point(lat, agl, ray) for ray in rays)
    world = grid.world_px(zoom)
    left, top, right, bottom = (float(edge[0]) for edge in windows.bounds_px)
    assert abs(left - float(lon_to_u(np.array(lon + float(west[1])))) * world) < HALF_PX
    assert abs(right - float(lon_to_u(np.array(lon + float(east[1])))) * world) < HALF_PX
    assert abs(top - float(lat_to_v(np.array(float(north[0])))) * world) < HALF_PX
    assert abs(bottom - float(lat_to_v(np.array(float(south[0])))) * world) < HALF_PX


def test_corners_are_the_exact_cameras():
    placed = poses([35.14, 35.14, -70.0], [-89.86, -89.85, 179.999], [120.0, 120.0, 9000.0])
    lat, lon, agl = placed[:3]
    corners = ground_corners(CAMERA, placed)
    for index in range(3):
        for corner, ray in enumerate(CAMERA.rays_enu(CORNERS)):
            exact_lat, exact_dlon = ground_point(lat[index], agl[index], ray)
            # Both end at the last digit of float64 degrees, and the reference once more as it becomes a float.
            for found, expected in ((corners.lat_deg, exact_lat), (corners.lon_deg, exact_dlon + lon[index])):
                value = found[index, corner]
                assert value == pytest.approx(float(expected), abs=2 * np.spacing(abs(value)))


@given(st.floats(-80, 80), st.floats(-180, 180), st.floats(5, 5000), st.integers(10, 20))
def test_neighbours_share_their_edge(lat, lon, agl, zoom):
    grid = PixelGrid()
    half = float(map_frame_edges(CAMERA, poses(lat, 0.0, agl)).east_u[0]) * 360
    windows = map_windows(CAMERA, poses([lat, lat], [lon, lon + 2 * half], [agl, agl]), grid, zoom)
    left, _, right, _ = windows.bounds_px
    # Within float64's noise of a rounding boundary either neighbour is right.
    on_boundary = abs((lon + half) / 360 * grid.world_px(zoom) % 1 - 0.5) < 1e-4
    assert abs(right[0] - left[1]) <= (1 if on_boundary else 0)


@given(st.floats(-80, 80), st.floats(-179, 179), st.floats(20, 5000), st.sampled_from([256, 512]))
def test_pictures_by_centre_are_sent_as_kept_and_show_all_they_should(lat, lon, agl, tile_px):
    plain = PixelGrid(tile_px=tile_px)
    grid = PixelGrid(tile_px=tile_px, max_zoom=21, native_zoom=21, centre_decimals=6, max_size_px=640)
    zoom = 15
    whole = map_windows(CAMERA, poses(lat, lon, agl), plain, zoom)
    sent = map_windows(CAMERA, poses(lat, lon, agl), grid, zoom)
    for kept in window_centres(sent, grid, zoom):
        assert abs(kept[0] * 1e6 - round(kept[0] * 1e6)) < 1e-4
    assert sent.width_px[0] % grid.scale == 0
    assert sent.height_px[0] % grid.scale == 0
    for inner, outer, sense in zip(whole.bounds_px, sent.bounds_px, (1, 1, -1, -1)):
        assert sense * (inner[0] - outer[0]) > -1e-6


def test_a_camera_that_sees_past_the_earth_is_refused():
    with pytest.raises(InvalidInput, match="horizon"):
        map_windows(CAMERA, poses(0.0, 0.0, 8e6), PixelGrid(), 2)


def test_a_picture_that_holds_a_pole_is_refused():
    with pytest.raises(InvalidInput, match="pole"):
        map_windows(CAMERA, poses(89.9, 0.0, 1e5), PixelGrid(), 2)
