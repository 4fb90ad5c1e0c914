"""Plans against brute force: every figure is counted again on a raster of pixels or by other software."""

from __future__ import annotations

import tracemalloc
from dataclasses import asdict

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pyproj import Geod, Transformer
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid, lat_to_v, lon_to_u
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.errors import refused
from tests.support.thinning import examples, sampled

AGRICENTER = Box(35.16, -89.90, 35.115, -89.823)
GRID = PixelGrid()
#: Concave, with a hole that no picture of 120 m bridges.
STAR = Polygon(
    (
        ((-89.9, 35.16), (-89.86, 35.15), (-89.82, 35.17), (-89.83, 35.12), (-89.86, 35.14), (-89.89, 35.11)),
        ((-89.87, 35.148), (-89.855, 35.148), (-89.862, 35.143)),
    )
)


def pixel_m(lat, world_px):
    """Width and height of one pixel of the map on the ground, from the ellipsoid's own radii."""
    e2 = 0.00669437999014
    sine2 = np.sin(np.radians(lat)) ** 2
    east = 6378137.0 / np.sqrt(1 - e2 * sine2)
    north = 6378137.0 * (1 - e2) / (1 - e2 * sine2) ** 1.5
    angle = 2 * np.pi / world_px * np.cos(np.radians(lat))
    return float(east * angle), float(north * angle)


def pixels_shown(worked_out, box):
    """How often each pixel of the map inside ``box`` is shown, painted picture by picture."""
    world = GRID.world_px(worked_out.zoom)
    west, east = (lon_to_u(np.array([box.west_deg, box.continuous_east_deg])) * world).tolist()
    north, south = (lat_to_v(np.array([box.north_deg, box.south_deg])) * world).tolist()
    x0, y0 = int(np.floor(west)), int(np.floor(north))
    count = np.zeros((int(np.ceil(south)) - y0, int(np.ceil(east)) - x0), np.uint8)
    left, top, right, bottom = (edge.astype(int) for edge in worked_out.windows.bounds_px)
    for x_from, y_from, x_to, y_to in zip(left - x0, top - y0, right - x0, bottom - y0):
        count[max(y_from, 0) : max(y_to, 0), max(x_from, 0) : max(x_to, 0)] += 1
    return count, x0, y0


def test_the_papers_mission_is_covered_whole_by_the_fewest_images():
    worked_out = plan(Mission(AGRICENTER, 120.0), GRID)
    assert (len(worked_out), worked_out.rows, int(worked_out.column.max()) + 1, worked_out.zoom) == (
        1935,
        43,
        45,
        19,
    )
    assert worked_out.coverage.complete
    assert worked_out.coverage.share == 1.0
    assert worked_out.coverage.uncovered_m2 == 0.0
    count, _, _ = pixels_shown(worked_out, AGRICENTER)
    assert count.min() == 1
    # Fewer would not do: the box is over 44 widths wide at its north, and over 42 heights high.
    width_m, height_m = worked_out.mission.camera.ground_size_m(120.0)
    geod = Geod(ellps="WGS84")
    assert geod.inv(-89.90, 35.16, -89.823, 35.16)[2] > 44 * width_m
    assert geod.inv(-89.90, 35.16, -89.90, 35.115)[2] > 42 * height_m


def test_the_papers_own_layout_leaves_ground_out_and_says_how_much():
    worked_out = plan(Mission(AGRICENTER, 120.0, layout="paper"), GRID)
    coverage = worked_out.coverage
    assert not coverage.complete
    count, _, _ = pixels_shown(worked_out, AGRICENTER)
    missing_px = int((count == 0).sum())
    pixel_m2 = np.prod(pixel_m(35.14, GRID.world_px(worked_out.zoom)))
    assert coverage.uncovered_m2 == pytest.approx(missing_px * pixel_m2, rel=0.01)
    assert coverage.share == pytest.approx(1 - coverage.uncovered_m2 / coverage.area_m2, abs=1e-6)
    assert coverage.share <= 1 - coverage.uncovered_m2 / coverage.area_m2


def test_the_papers_grid_is_in_utm_from_the_top_left_corner_to_the_bottom_right():
    mission = Mission(AGRICENTER, 120.0, overlap_along=0.25, overlap_across=0.1, layout="paper")
    worked_out = plan(mission, GRID)
    to_utm = Transformer.from_crs(4326, 32616, always_xy=True).transform
    x, y = to_utm(worked_out.lon_deg, worked_out.lat_deg)
    left, top = to_utm(-89.90, 35.16)
    right, bottom = to_utm(-89.823, 35.115)
    width, height = mission.camera.ground_size_m(120.0)
    np.testing.assert_allclose(x, left + worked_out.column * width * 0.75, atol=1e-6)
    np.testing.assert_allclose(y, top - worked_out.row * height * 0.9, atol=1e-6)
    assert abs(x.max() - right) < width * 0.75
    assert right - width / 2 <= x.max() < right + width * 0.25
    assert bottom - height * 0.4 <= y.min() <= bottom + height / 2


boxes = st.tuples(
    st.floats(-84.5, 84.5),
    st.floats(-180, 180),
    st.floats(1e-12, 0.05),
    st.floats(1e-12, 0.2),
    st.floats(300, 3000),
)


@settings(max_examples=examples(60), deadline=None)
@given(boxes, st.floats(0, 0.8), st.floats(0, 0.8), st.floats(20, 150), st.floats(0.1, 10))
def test_no_pixel_of_any_box_is_left_out(box, along, across, fov, ratio):
    lat, west, height, width, agl = box
    east = west + width
    area = Box(lat + height, west, lat, east if east <= 180 else east - 360)
    more = {"overlap_along": along, "overlap_across": across, "max_px": 200, "max_images": 3000}
    mission = Mission(area, agl, Camera(fov, ratio), **more)
    try:
        worked_out = plan(mission, GRID)
    except InvalidInput as refused:
        assume(refused.field != "max_images")
        raise
    count, _, _ = pixels_shown(worked_out, area)
    assert count.size == 0 or count.min() >= 1
    assert worked_out.coverage.complete
    # What was asked for, less the rounding of a shared width's two edges.
    shortest = float(worked_out.windows.width_px.min())
    if worked_out.overlap.least_along is not None:
        assert worked_out.overlap.least_along >= along - 2 / shortest
    lowest = float(worked_out.windows.height_px.min())
    if worked_out.overlap.least_across is not None:
        assert worked_out.overlap.least_across >= across - 2 / lowest


@pytest.mark.parametrize("layout", ["cover", "paper"])
@pytest.mark.parametrize("overlap", [0.0, 0.3])
def test_overlap_and_tiles_are_what_counting_gives(layout, overlap):
    area = Box(35.16, -89.90, 35.15, -89.88)
    mission = Mission(area, 120.0, overlap_along=overlap, overlap_across=overlap, layout=layout)
    worked_out = plan(mission, GRID)
    left, top, right, bottom = (edge.astype(int).tolist() for edge in worked_out.windows.bounds_px)
    tiles = set()
    for x0, y0, x1, y1 in zip(left, top, right, bottom):
        tiles |= {(x, y) for x in range(x0 // 256, (x1 - 1) // 256 + 1) for y in range(y0 // 256, (y1 - 1) // 256 + 1)}
    assert worked_out.requests == len(tiles)
    at = {pair: i for i, pair in enumerate(zip(worked_out.column.tolist(), worked_out.row.tolist()))}
    along = [
        (right[i] - left[at[c + 1, r]]) / min(right[i] - left[i], right[at[c + 1, r]] - left[at[c + 1, r]])
        for (c, r), i in at.items()
        if (c + 1, r) in at
    ]
    across = [
        (bottom[i] - top[at[c, r + 1]]) / min(bottom[i] - top[i], bottom[at[c, r + 1]] - top[at[c, r + 1]])
        for (c, r), i in at.items()
        if (c, r + 1) in at
    ]
    measured = worked_out.overlap
    assert measured.least_along == pytest.approx(min(along))
    assert measured.median_along == pytest.approx(np.median(along), abs=0.002)
    assert measured.least_across == pytest.approx(min(across))
    assert measured.median_across == pytest.approx(np.median(across), abs=0.002)


def inside(polygon, lon, lat):
    """Even-odd rule, point by point."""
    result = np.zeros(lon.shape, bool)
    for ring in polygon.rings:
        for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1]):
            crosses = (y0 <= lat) != (y1 <= lat)
            with np.errstate(divide="ignore", invalid="ignore"):
                result ^= crosses & (lon < x0 + (lat - y0) * (x1 - x0) / (y1 - y0))
    return result


@pytest.mark.parametrize("layout", sampled(["cover", "paper"], 2))
def test_a_polygon_is_covered_and_nothing_else_is_flown(layout):
    worked_out = plan(Mission(STAR, 120.0, layout=layout, zoom=16), GRID)
    count, x0, y0 = pixels_shown(worked_out, STAR.bounds)
    world = GRID.world_px(worked_out.zoom)
    x, y = np.meshgrid(np.arange(count.shape[1]) + 0.5 + x0, np.arange(count.shape[0]) + 0.5 + y0)
    lon = (x / world - 0.5) * 360
    lat = np.degrees(np.arctan(np.sinh((0.5 - y / world) * 2 * np.pi)))
    ground = inside(STAR, lon, lat)
    missing = int((ground & (count == 0)).sum())
    assert (missing == 0) == (layout == "cover")
    assert worked_out.coverage.complete == (layout == "cover")
    pixel = np.prod(pixel_m(35.14, world))
    assert worked_out.coverage.uncovered_m2 == pytest.approx(missing * pixel, rel=0.05)
    assert worked_out.coverage.area_m2 == pytest.approx(ground.sum() * pixel, rel=1e-3)
    whole_box = plan(Mission(STAR.bounds, 120.0, layout=layout, zoom=16), GRID)
    assert len(worked_out) < 0.75 * len(whole_box)
    # Each picture, grown by a pixel for the rounding of its edges, shows ground of the polygon.
    margin = 200
    grown = np.pad(ground, margin)
    left, top, right, bottom = (edge.astype(int) for edge in worked_out.windows.bounds_px)
    for x_from, y_from, x_to, y_to in zip(left - x0, top - y0, right - x0, bottom - y0):
        rows = slice(y_from - 1 + margin, y_to + 1 + margin)
        assert grown[rows, x_from - 1 + margin : x_to + 1 + margin].any()


@pytest.mark.parametrize("rows", [10_000, pytest.param(100_000, marks=pytest.mark.thorough)])
def test_a_hundred_thousand_rows_settle(rows):
    worked_out = plan(
        Mission(Box(35.0 + rows * 3e-6, -89.9000000001, 35, -89.9), 0.3),
        PixelGrid(max_zoom=30, native_zoom=30),
    )
    assert worked_out.rows > rows
    assert worked_out.coverage.complete


def test_rows_are_flown_in_turn_east_and_west():
    worked_out = plan(Mission(AGRICENTER, 400.0), GRID)
    assert (np.diff(worked_out.row) >= 0).all()
    for row in range(worked_out.rows):
        columns = np.diff(worked_out.column[worked_out.row == row])
        assert (columns == (-1 if row % 2 else 1)).all()
    geod = Geod(ellps="WGS84")
    assert worked_out.direct.distance_m == pytest.approx(
        geod.line_length(worked_out.lon_deg, worked_out.lat_deg), rel=1e-12
    )


def test_across_the_antimeridian_is_like_anywhere_else():
    there = plan(Mission(Box(1, 179.9, 0.9, -179.9), 1000.0), GRID)
    here = plan(Mission(Box(1, -0.1, 0.9, 0.1), 1000.0), GRID)
    assert len(there) == len(here)
    assert there.coverage.complete
    assert there.requests == here.requests
    assert there.lon_deg.max() > 180
    assert there.frame_centres[1].max() < 180
    assert there.direct.distance_m == pytest.approx(here.direct.distance_m, rel=1e-9)
    np.testing.assert_allclose(there.lon_deg - 180, here.lon_deg, atol=1e-9)


def test_the_whole_world_from_limit_to_limit():
    worked_out = plan(Mission(Box(85.05, -180, -85.05, 180), 50e3, frame="map", accept_error=True), GRID)
    assert worked_out.coverage.complete
    assert worked_out.requests == 4**worked_out.zoom
    _, top, _, bottom = worked_out.windows.bounds_px
    assert top.min() == 0
    assert bottom.max() == GRID.world_px(worked_out.zoom)


@pytest.mark.parametrize(
    ("area", "rows", "columns"),
    [
        (Box(35.0000000001, -89.0000000001, 35, -89), 1, 1),
        (Box(35.0000000001, -89.1, 35, -89), 1, None),
        (Box(35.1, -89.0000000001, 35, -89), None, 1),
    ],
)
def test_boxes_of_next_to_no_ground_are_lines_and_points_of_captures(area, rows, columns):
    worked_out = plan(Mission(area, 120.0), GRID)
    assert worked_out.coverage.complete
    assert (worked_out.rows == 1) == (rows == 1)
    assert (int(worked_out.column.max()) + 1 == 1) == (columns == 1)


@pytest.mark.parametrize(
    ("area", "field", "says"),
    [
        (Box(35, -89, 35, -89), "south", "box from latitude 35 down to 35: has no height"),
        (Box(35, -89.1, 35, -89), "south", "has no height; its north must lie above its south"),
        (Box(90, -89.1, 90, -89), "south", "has no height"),
        (Box(35.1, -89, 35, -89), "east", "box from longitude -89 to -89: has no width"),
        (Box(35.1, 180, 35, -180), "east", "from longitude 180 to -180: has no width"),
    ],
)
def test_boxes_without_ground_are_no_missions(area, field, says):
    good = Mission(Box(35.1, -89.1, 35, -89), 120.0)
    of_file = {**good.to_dict(), "area": {"type": "box", **asdict(area)}}
    for make in (
        lambda: Mission(area, 120.0),
        lambda: good.replace(area=area),
        lambda: Mission.from_dict(of_file),
    ):
        with pytest.raises(InvalidInput, match=says) as wrong:
            make()
        assert wrong.value.field == field


def test_a_box_around_the_world_has_ground():
    for area in (Box(10, -180, -10, 180), Box(10, 0, -10, 360), Box(10, -360, -10, 360)):
        assert Mission(area, 50e3).area == area


def test_points_keep_their_own_heights_and_share_a_zoom():
    worked_out = plan(Mission(Points(((35.1, -89.8, 120.0), (-70.0, 180.0, 60.0))), 120.0), GRID)
    assert worked_out.column.tolist() == [0, 1]
    assert worked_out.coverage is None
    assert worked_out.overlap.least_along is None
    widths = worked_out.windows.width_px * GRID.ground_m_per_px(worked_out.lat_deg, worked_out.lon_deg, worked_out.zoom)
    assert widths[0] / widths[1] == pytest.approx(2.0, rel=0.01)


# --- size and zoom

#: Of every zoom there is.
DEEP = PixelGrid(max_zoom=30, native_zoom=30)
MAVIC_3E = Camera.from_sensor((17.3, 13.0), 12.29, 5280 / 3956)


def test_the_default_has_as_many_pixels_as_its_camera():
    worked_out = plan(Mission(AGRICENTER, 120.0), GRID)
    assert worked_out.zoom == 19
    assert worked_out.windows.width_px.max() == pytest.approx(640, rel=0.02)
    # 120 m and 78.8 degrees across 640 by 480 px, and a pixel of zoom 19 at the latitude of Memphis.
    assert worked_out.resolution.requested_m_per_px == pytest.approx(
        2 * 120.0 * np.tan(np.radians(78.8) / 2) * 0.8 / 640
    )
    assert worked_out.resolution.delivered_m_per_px == pytest.approx(pixel_m(35.1375, 256 << 19)[0], rel=1e-4)


@settings(max_examples=examples(40), deadline=None)
@given(
    st.floats(-84.0, 84.0),
    st.floats(3.0, 16e3),
    st.integers(40, 9000),
    st.sampled_from([256, 512]),
    st.sampled_from([Camera(), Camera(40.0, 0.7), MAVIC_3E]),
    st.sampled_from(["map", "camera"]),
)
def test_no_other_zoom_has_pixels_nearer_to_the_camera_s(lat, agl, image_px, tile_px, camera, frame):
    grid = PixelGrid(tile_px=tile_px, max_zoom=30, native_zoom=30)
    mission = Mission(Points(((lat, 10.0, agl),)), agl, camera, image_px=image_px, frame=frame, accept_error=True)
    assume(abs(lat) < 70.0 or agl < 3e3)
    worked_out = plan(mission, grid)
    wanted_m = max(camera.ground_size_m(agl)) / image_px
    off = [
        abs(np.log2(pixel_m(lat, tile_px * 2.0**zoom)[0] / wanted_m))
        for zoom in (worked_out.zoom - 1, worked_out.zoom, worked_out.zoom + 1)
    ]
    assert off[1] <= min(off) + 1e-9
    assert worked_out.resolution.requested_m_per_px == pytest.approx(wanted_m)
    assert abs(np.log2(worked_out.resolution.delivered_m_per_px / wanted_m)) <= (0.5 if frame == "map" else 0.02) + 1e-9


@pytest.mark.parametrize("max_px", [160, 640, 645, 646, 5000])
def test_a_limit_takes_the_highest_zoom_at_which_all_pictures_fit(max_px):
    for agl in (10.0, 97.3, 120.0, 240.0, 1000.0, 16e3):
        mission = Mission(
            Points(((35.14, -89.86, agl), (36.14, -89.86, agl))),
            agl,
            frame="map",
            accept_error=True,
            max_px=max_px,
            image_px=9999,
        )
        worked_out = plan(mission, DEEP)
        finer = plan(mission.replace(zoom=worked_out.zoom + 1, max_px=None), DEEP)
        assert worked_out.windows.width_px.max() <= max_px < finer.windows.width_px.max()
        # Where the camera's own pixels fit, there is nothing to be limited.
        own = mission.replace(image_px=40)
        assert plan(own, DEEP).zoom == plan(own.replace(max_px=None), DEEP).zoom


def test_a_limit_is_the_sources_and_the_papers_too():
    served = PixelGrid(max_zoom=21, native_zoom=21, centre_decimals=6, max_size_px=640)
    for mission, grid in (
        (Mission(AGRICENTER, 120.0, layout="paper"), GRID),
        (Mission(AGRICENTER, 120.0, image_px=5280), served),
        (Mission(AGRICENTER, 120.0, max_px=640), GRID),
    ):
        worked_out = plan(mission, grid)
        assert worked_out.zoom == 18
        assert worked_out.windows.width_px.min() == pytest.approx(323, abs=1)
        assert worked_out.resolution.delivered_m_per_px > 1.9 * worked_out.resolution.requested_m_per_px
    assert plan(Mission(AGRICENTER, 120.0, layout="paper", max_px=700), GRID).zoom == 19
    tilted = Mission(AGRICENTER, 120.0, tilt_deg=10.0, layout="paper", image_px=900)
    assert max(plan(tilted, GRID).frames.largest_px) == 640


@pytest.mark.parametrize(
    ("mission", "grid", "says"),
    [
        (
            Mission(AGRICENTER, 120.0, zoom=19, max_px=640),
            GRID,
            r"646 px.*640 px; choose a lower zoom, or allow",
        ),
        (
            Mission(AGRICENTER, 120.0, gsd_m_per_px=0.3, max_px=640),
            GRID,
            "a larger ground sample distance, or",
        ),
        (Mission(AGRICENTER, 120.0, zoom=19), PixelGrid(max_size_px=640), "640 px; choose a lower zoom$"),
        (Mission(AGRICENTER, 120.0, zoom=22, tilt_deg=9.0, max_px=640), GRID, "5,1.. px: .*640 px"),
        (
            Mission(AGRICENTER, 120.0, max_px=640),
            PixelGrid(min_zoom=19),
            "640 px; fly lower, or allow larger",
        ),
        (Mission(Points(((35.0, -89.0, 9e3),)), 9e3, zoom=22, accept_error=True), GRID, "20,000 px; choose"),
    ],
)
def test_what_is_asked_for_beyond_a_limit_is_refused(mission, grid, says):
    with pytest.raises(InvalidInput, match=says):
        plan(mission, grid)


@pytest.mark.parametrize("more", [{}, {"tilt_deg": 20.0}])
def test_pictures_of_too_many_pixels_are_refused_before_memory_is_taken(more):
    # As a camera of 20,000 px by 9,999 has them, and by 10,001.
    def mission(high_px):
        camera = Camera(78.8, 20_000 / high_px)
        return Mission(Points(((35.0, -89.0, 9e3),)), 9e3, camera, image_px=20_000, accept_error=True, **more)

    assert plan(mission(9_700), GRID).frames.width_px[0] * 9_700 > 150e6
    tracemalloc.start()
    try:
        with pytest.raises(InvalidInput, match=r"20,000 x 1[0-9],... px: 200,000,000 px in all are allowed; choose"):
            plan(mission(15_000), GRID)
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()


@settings(max_examples=examples(30), deadline=None)
@given(st.integers(20, 1500), st.integers(20, 1500), st.sampled_from([256, 512]), st.floats(30.0, 3000.0))
def test_resizing_takes_no_finer_zoom_than_it_needs(width, height, tile_px, agl):
    grid = PixelGrid(tile_px=tile_px, max_zoom=30, native_zoom=30)
    mission = Mission(Points(((35.14, -89.86, agl),)), agl, accept_error=True, frame="map")
    plain, resized = plan(mission, grid), plan(mission.replace(img_size=(width, height, 3)), grid)
    assert resized.zoom <= plain.zoom
    coarser = plan(mission.replace(zoom=resized.zoom - 1), grid)
    # A frame of 255.6 px, whose window may have 255, is as good as 256.
    enough = resized.frames.width_px[0] >= width - 1 and resized.frames.height_px[0] >= height - 1
    assert enough or resized.zoom == plain.zoom
    assert coarser.frames.width_px[0] <= width or coarser.frames.height_px[0] <= height


def test_camera_frames_are_made_no_larger_than_they_are_written():
    mission = Mission(AGRICENTER, 120.0, tilt_deg=10.0)
    assert plan(mission.replace(img_size=(320, 240, 3)), GRID).frames.largest_px == (320, 240)
    assert plan(mission.replace(img_size=(224, 224, 3)), GRID).frames.largest_px == (299, 224)
    assert plan(mission.replace(img_size=(1280, 960, 3)), GRID).frames.largest_px == (640, 480)
    assert plan(mission.replace(img_size=(320, 240, 3)), GRID).zoom == plan(mission, GRID).zoom - 1


def test_requested_and_delivered_are_of_the_files():
    mission = Mission(AGRICENTER, 120.0)
    asked = plan(mission.replace(gsd_m_per_px=0.3), GRID)
    assert (asked.resolution.requested_m_per_px, asked.zoom) == (0.3, 19)
    resized = plan(mission.replace(img_size=(256, 256, 3)), GRID)
    width = float(np.median(resized.frames.width_px))
    assert resized.resolution.delivered_m_per_px == pytest.approx(
        plan(mission, GRID).resolution.delivered_m_per_px * width / 256
    )
    tall = plan(mission.replace(camera=Camera(78.8, 0.5), img_size=(256, 256, 3)), GRID)
    assert tall.resolution.delivered_m_per_px == pytest.approx(
        max(tall.mission.camera.ground_size_m(120.0)) / 256, rel=0.01
    )
    in_wind = mission.replace(wind=Wind(8.0, 250.0, 0.2))
    assert plan(in_wind, GRID).resolution.requested_m_per_px == plan(mission, GRID).resolution.requested_m_per_px


TOO_FINE = "ground sample distance {0} m: the source's own pixels are {1:.3g} m here"


def test_native_resolution_is_kept_unless_told_otherwise():
    coarse = PixelGrid(max_zoom=20, native_zoom=16)
    mission = Mission(Points(((35.14, -89.86, 120.0),)), 120.0)
    assert plan(mission, coarse).zoom == 16
    assert plan(mission.replace(upsample=True), coarse).zoom == 19
    with refused("zoom {0}: the source's own pixels end at zoom {1}", 20, 16, field="zoom"):
        plan(mission.replace(zoom=20), coarse)
    assert plan(mission.replace(zoom=20, upsample=True), coarse).zoom == 20


def test_camera_frames_have_no_more_pixels_than_the_ground_right_below():
    coarse = PixelGrid(max_zoom=20, native_zoom=16)
    mission = Mission(Points(((35.14, -89.86, 600.0),)), 600.0, frame="camera", tilt_deg=20.0)
    own = plan(mission, coarse)
    source_m = float(coarse.ground_m_per_px(own.lat_deg, own.lon_deg, 16)[0])
    width_m = mission.camera.ground_size_m(600.0)[0]
    assert own.frames.largest_px[0] == round(width_m / source_m)
    assert max(plan(mission.replace(upsample=True), coarse).frames.largest_px) == 640
    assert max(plan(mission.replace(upsample=True), PixelGrid()).frames.largest_px) == 640
    with refused(TOO_FINE, field="gsd_m_per_px"):
        plan(mission.replace(gsd_m_per_px=0.5), coarse)
    assert (
        plan(mission.replace(gsd_m_per_px=0.5, upsample=True), coarse).frames.largest_px[0] > own.frames.largest_px[0]
    )


@pytest.mark.parametrize("changes", [{"zoom": 18}, {"max_px": 640, "image_px": 5000}])
def test_larger_tiles_multiply_the_pixels_of_a_zoom(changes):
    mission = Mission(AGRICENTER, 120.0, **changes)
    small, large = plan(mission, PixelGrid()), plan(mission, PixelGrid(tile_px=512))
    assert small.zoom == large.zoom == 18
    np.testing.assert_allclose(large.windows.width_px, 2 * small.windows.width_px, atol=2)
    assert large.coverage.complete


def test_a_wanted_ground_sample_distance_chooses_the_zoom():
    mission = Mission(AGRICENTER, 120.0, gsd_m_per_px=0.5)
    worked_out = plan(mission, GRID)
    assert worked_out.zoom == 18
    assert worked_out.resolution.delivered_m_per_px <= 0.5
    with refused(TOO_FINE, field="gsd_m_per_px"):
        plan(mission.replace(gsd_m_per_px=0.001), GRID)


def test_pictures_by_their_centre_leave_nothing_out_either():
    grid = PixelGrid(max_zoom=21, native_zoom=21, centre_decimals=6, max_size_px=640)
    worked_out = plan(Mission(AGRICENTER, 120.0), grid)
    assert worked_out.coverage.complete
    assert worked_out.requests == len(worked_out)
    assert worked_out.windows.width_px.max() <= 640


@pytest.mark.parametrize(("lat", "agl"), sampled([(89.9, 3e6), (84.2, 3e6), (85.0511, 100.0), (86.0, 1e6)], 2))
def test_a_picture_that_is_partly_on_the_map_is_planned(lat, agl):
    """89.9 degrees from 3,000 km was refused, and 84.2 with the same share of its picture planned."""
    worked_out = plan(Mission(Points(((lat, 0.0, agl),)), agl), GRID)
    assert not worked_out.frames.on_map
    assert worked_out.masked
    assert 0.0 < worked_out.views.view(0).unmapped_share < 1.0
    assert worked_out.views.view(0).tiles(0.0)
    with pytest.raises(InvalidInput, match=r"lies beyond the map.*fly higher"):
        plan(Mission(Points(((lat + 5.0 if lat < 85.0 else 89.99, 0.0, 50.0),)), 50.0), GRID)


@pytest.mark.parametrize("ratio", [1e-3, 1e3])
def test_a_map_frame_under_one_pixel_gives_way_to_a_camera_frame(ratio):
    mission = Mission(Points(((0.0, 0.0, 120.0),)), 120.0, Camera(78.8, ratio))
    worked_out = plan(mission, GRID)
    assert sorted(worked_out.frames.largest_px) == [1, 640]
    assert "under one pixel" in worked_out.accuracy.picture.reason
    with pytest.raises(InvalidInput, match="under one pixel"):
        plan(mission.replace(frame="map"), GRID)


def test_names_are_the_published_ones():
    worked_out = plan(Mission(Points(((35.128039, -89.799163, 126.0),)), 126.0), GRID)
    column, row, lat, lon, zoom = worked_out.names[0].split("_")
    assert (column, row, zoom) == ("0", "0", str(worked_out.zoom))
    assert len(lat.split(".")[1]) == len(lon.split(".")[1]) == 8
    assert float(lat) == pytest.approx(35.128039, abs=1e-5)
    assert float(lon) == pytest.approx(-89.799163, abs=1e-5)


@pytest.mark.parametrize(
    ("mission", "says"),
    [
        (Mission(Box(35.16, -89.9, 35.115, -89.8), 120.0, max_images=1000), "the limit is 1,000"),
        (Mission(Box(60, -100, -60, 100), 0.01), "the limit is 10,000,000"),
        (Mission(Box(85.1, 0, 85, 1), 1000.0), "latitude 85.1"),
        (Mission(Points(((85.0511, 0.0, 100.0),)), 100.0, frame="map"), "reaches beyond the map"),
        (Mission(Points(((86.0, 0.0, 1000.0),)), 1000.0), "beyond the map"),
        (Mission(Points(((0.0, 0.0, 8e6),)), 8e6, frame="map"), "holds up to 0.1"),
        (Mission(Points(((0.0, 0.0, 3e6),)), 3e6, tilt_deg=150.0), "no ray of its image meets the Earth"),
        (Mission(AGRICENTER, 120.0, error_budget_px=1e-12), "times as much"),
        (
            Mission(Points(((35.0, -89.0, 0.01),)), 0.01, camera=Camera(0.01, 1.0), frame="camera", upsample=True),
            "resolve 4e-08 m",
        ),
        (Mission(AGRICENTER, 120.0, zoom=23), "zoom 23: the source has 0 to 22"),
        (Mission(AGRICENTER, 120.0, zoom=28913, tilt_deg=30.0), "zoom 28913: the source has 0 to 22"),
        (
            Mission(AGRICENTER, 120.0, zoom=10**18, row_azimuth_deg=30.0),
            f"zoom {10**18}: the source has 0 to 22",
        ),
        (Mission(Points(((35, -89, 0.01),)), 0.01, zoom=5), "under one pixel"),
        (
            Mission(Points(((35, -89, 120.0),)), 120.0, camera=Camera(60.0, 1e4), tilt_deg=1.0),
            "under one pixel",
        ),
        (Mission(Box(35.0001, -89.0001, 35, -89), 120.0, overlap_along=0.9999999), "overlap less"),
        (Mission(Box(10, -170, -10, 170), 1e5, layout="paper"), "use --layout cover"),
    ],
)
def test_what_cannot_be_flown_is_refused_in_one_line(mission, says):
    with pytest.raises(InvalidInput) as refused:
        plan(mission, GRID)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_too_many_images_are_refused_before_memory_is_taken():
    import tracemalloc

    tracemalloc.start()
    try:
        with pytest.raises(InvalidInput, match="limit"):
            plan(Mission(Box(80, -180, -80, 180), 1.0), GRID)
        with pytest.raises(InvalidInput, match="limit"):
            plan(Mission(Box(0.1, -180, -0.1, 180), 1.0), GRID)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 50e6


def test_rows_of_the_paper_without_end_are_refused():
    mission = Mission(
        Box(35.16, -89.90, 35.115, -89.823), 1e-308, Camera(78.8, 4 / 3), layout="paper", accept_error=True
    )
    with pytest.raises(InvalidInput, match="mission of inf images: the limit is"):
        plan(mission, PixelGrid())
