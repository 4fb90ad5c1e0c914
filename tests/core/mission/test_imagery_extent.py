"""What of a mission lies where its source has imagery: against points, and in words."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.geodesy.mercator import PixelGrid, extent_of_box, v_to_lat
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.thinning import examples

AREA = Box(35.16, -89.90, 35.15, -89.888)


def held(ring, u, v):
    """Whether points lie in a convex ring, by the side of each of its edges that they are on."""
    corners = np.array(ring)
    sides = [
        (u1 - u0) * (v - v0) - (v1 - v0) * (u - u0) for (u0, v0), (u1, v1) in zip(corners, np.roll(corners, -1, axis=0))
    ]
    return (np.min(sides, axis=0) > 0.0) | (np.max(sides, axis=0) < 0.0)


@settings(max_examples=examples(40), deadline=None)
@given(
    st.floats(0.0, 6.3),
    st.floats(3e-6, 5e-5),
    st.floats(-3e-5, 3e-5),
    st.floats(-3e-5, 3e-5),
    st.booleans(),
    st.sampled_from([-89.894, 179.9999]),
)
def test_images_and_share_are_those_of_points(turn, size, east, south, backwards, lon):
    middle = np.array([lon / 360.0 + 0.5 + east, 0.4])
    angles = turn + np.array([0.3, 2.0, 3.6, 5.0])
    ring = middle + size * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ring = ring[::-1] if backwards else ring
    lat = float(v_to_lat(np.array(0.4 + south)))
    west, right = lon - 0.006, lon + 0.006
    area = Box(lat + 0.005, west, lat - 0.005, right - 360.0 if right > 180.0 else right)
    worked_out = plan(Mission(area, 120.0, accept_error=True), PixelGrid(extent=tuple(map(tuple, ring.tolist()))))
    world = worked_out.grid.world_px(worked_out.zoom)
    left, top, right_px, bottom = (edge / world for edge in worked_out.windows.bounds_px)
    # A pixel of room for what rounding moves edges by.
    left, top, right_px, bottom = left + 1 / world, top + 1 / world, right_px - 1 / world, bottom - 1 / world
    share = np.linspace(0.0, 1.0, 41)
    seen = np.array(
        [
            held(ring, *np.meshgrid(a + share * (c - a), b + share * (d - b))).mean()
            for a, b, c, d in zip(left, top, right_px, bottom)
        ]
    )
    imagery = worked_out.imagery
    # Points inside prove a picture is not outside, points outside that it is not inside.
    assert imagery.outside <= int((seen == 0.0).sum())
    assert len(worked_out) - imagery.outside - imagery.partly <= int((seen == 1.0).sum())
    # Slivers between points may hide what there is of either.
    assert imagery.outside >= int((seen == 0.0).sum()) - 8
    assert imagery.partly <= int(((seen > 0.0) & (seen < 1.0)).sum()) + 8
    u = np.linspace(area.west_deg, area.continuous_east_deg, 800) / 360.0 + 0.5
    ends = np.radians([area.north_deg, area.south_deg])
    v = np.linspace(*(0.5 - np.arcsinh(np.tan(ends)) / (2.0 * np.pi)), 800)
    assert imagery.share == pytest.approx(float(held(ring, *np.meshgrid(u, v)).mean()), abs=0.005)


def test_where_nothing_is_known_to_end_nothing_is_said():
    summary = estimate(plan(Mission(AREA, 120.0), PixelGrid()))
    assert (summary.imagery_share, summary.images_outside, summary.images_partly_outside) == (1.0, 0, 0)
    assert summary.warnings == ()
    assert "imagery" not in dict(summary.lines())


def test_images_beyond_the_imagery_are_told_to_people_and_scripts():
    grid = PixelGrid(extent=extent_of_box(-89.90, 35.10, -89.894, 35.20))
    summary = estimate(plan(Mission(AREA, 120.0), grid))
    assert summary.complete
    assert summary.imagery_share == pytest.approx(0.5)
    assert summary.images_outside > 0 < summary.images_partly_outside
    assert dict(summary.lines())["coverage"] == "100 % (complete but for missing imagery)"
    assert dict(summary.lines())["imagery"] == "the source has imagery of 50 % of the area"
    (text,) = summary.warnings
    assert f"{summary.images_outside} lie outside the source's imagery" in text
    assert summary.to_dict()["images_outside"] == summary.images_outside
    # What the message says to do.
    inside = Box(35.16, -89.8995, 35.15, -89.8945)
    assert estimate(plan(Mission(inside, 120.0), grid)).warnings == ()
    assert estimate(plan(Mission(AREA, 120.0), replace(grid, extent=None))).warnings == ()


def test_points_and_polygons_have_their_imagery_too():
    grid = PixelGrid(extent=extent_of_box(179.0, -10.0, -179.0, 10.0))
    points = Points(((0.0, 179.5, 120.0), (0.0, -179.5, 120.0), (0.0, -178.0, 120.0), (10.0, 180.0, 120.0)))
    assert plan(Mission(points, 120.0), grid).imagery == (None, 1, 1)
    hole = ((-89.897, 35.157), (-89.895, 35.157), (-89.895, 35.153), (-89.897, 35.153))
    area = Polygon((((-89.9, 35.16), (-89.888, 35.16), (-89.888, 35.15), (-89.9, 35.15)), hole))
    west = plan(Mission(area, 120.0), PixelGrid(extent=extent_of_box(-89.90, 35.10, -89.894, 35.20)))
    # Half of 0.012 by 0.01 degrees, of which the hole takes 0.002 by 0.004.
    assert west.imagery.share == pytest.approx((60.0 - 8.0) / (120.0 - 8.0), rel=1e-4)


def test_a_raster_says_where_it_ends(tmp_path):
    """In another system, whose north is turned by a degree from the map's."""
    rasterio = pytest.importorskip("rasterio", reason="rasterio is not installed")
    from pyproj import Transformer

    x, y = Transformer.from_crs(4326, 32616, always_xy=True).transform(-89.894, 35.155)
    path = tmp_path / "ortho.tif"
    with rasterio.open(
        path,
        "w",
        driver="GTiff",
        width=1000,
        height=800,
        count=3,
        dtype="uint8",
        crs="EPSG:32616",
        transform=rasterio.Affine(1.0, 0.0, x - 500.0, 0.0, -1.0, y + 400.0),
    ) as file:
        file.write(np.full((3, 800, 1000), 90, np.uint8))
    to_degrees = Transformer.from_crs(32616, 4326, always_xy=True).transform
    lon, lat = to_degrees([x - 500, x + 500, x + 500, x - 500], [y + 400, y + 400, y - 400, y - 400])
    on_map = np.stack([np.array(lon) / 360.0 + 0.5, 0.5 - np.arcsinh(np.tan(np.radians(lat))) / (2.0 * np.pi)], axis=1)
    own = np.array([[0, 0], [1000, 0], [1000, 800], [0, 800]]) / 1024.0
    # Of the map to a centimetre of ground; of its own pixels exactly.
    for crs, expected, most in (("EPSG:3857", on_map, 2e-10), ("", own, 1e-12)):
        with closing(open_source(str(path), crs=crs)) as source:
            grid = source.grid
        assert np.abs(np.array(grid.extent) - expected).max() < most
        _says_what_is_beyond(grid)


def _says_what_is_beyond(grid):
    summary = estimate(plan(Mission(Box(35.16, -89.90, 35.15, -89.885), 120.0), grid))
    assert 0.0 < summary.imagery_share < 1.0
    assert summary.images_outside > 0
