"""The figures people see."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from terrainav.core.external.compiling import uses_numba
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.estimate import FROM_FILE, OFFLINE, ONLINE, area_text, estimate, mosaic_s, percent
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.shot import Shot

AGRICENTER = Box(35.16, -89.90, 35.115, -89.823)


def text(summary):
    return dict(summary.lines())


def test_the_papers_mission_in_words():
    summary = estimate(plan(Mission(AGRICENTER, 120.0), PixelGrid()))
    words = text(summary)
    assert words["images"] == "1,935"
    assert words["coverage"] == "100 % (complete)"
    assert words["ground sample distance"] == "requested 24.64 cm, delivered 24.44 cm"
    assert summary.download_bytes == summary.unique_tiles * ONLINE.request_bytes
    json.dumps(summary.to_dict())


def test_what_is_not_complete_never_reads_so():
    summary = estimate(plan(Mission(AGRICENTER, 120.0, layout="paper"), PixelGrid()))
    assert text(summary)["coverage"].startswith("99.7")
    assert "uncovered" in text(summary)["coverage"]
    assert percent(0.999999, exact=False) == "99.9999 %"


def test_images_over_relief_take_longer_the_more_of_its_cells_they_see():
    """The same pixels see four times the ground from twice as high, as long as cells are not larger from there."""
    mission = Mission(Points(((35, -89, 40),)), 40.0, image_px=160, elevation=("world",), frame="camera")
    seconds, cells = [], []
    for agl_m in (40.0, 80.0):
        made = plan(
            mission.replace(area=Points(((35, -89, agl_m),)), agl_m=agl_m), PixelGrid(), mission_heights(mission)
        )
        costs = replace(OFFLINE, request_s=0.0)
        seconds.append(estimate(made, costs, cores=1).seconds)
        tan_x, tan_y = mission.camera.half_tangents
        # Cells of the world's heights are those of its pixels at zoom 19.
        cell_m = 2.0 * math.pi * WGS84.a_m * math.cos(math.radians(35.0)) / 256.0 / 2.0**19
        cells.append(4.0 * tan_x * tan_y * agl_m**2 / cell_m**2)
    added = (cells[1] - cells[0]) * costs.trace_s_per_cell / (3.0 if uses_numba() else 1.0)
    assert seconds[1] - seconds[0] == pytest.approx(added, rel=0.02)
    assert added > seconds[0] / 3.0


#: A flight of two images in motion, and costs of nothing but a take's parts.
MOVED = Mission(
    Points(((35.156, -89.9, 150.0), (35.158, -89.9, 150.0))),
    150.0,
    tilt_deg=30.0,
    motion_blur=True,
    exposure_ms=20.0,
    row_time_us=200.0,
    airspeed_m_per_s=15.0,
)
FREE = replace(
    OFFLINE, request_s=0.0, image_s=0.0, encode_s_per_px={"tif": 0.0}, warp_s_per_px=0.0, take_s_per_px=0.0, strip_s=0.0
)


def test_images_take_the_time_of_their_takes():
    made = plan(MOVED, PixelGrid())
    instants = Shot(made, 0).instants
    assert len(instants) > 1
    assert len(instants[0]) > 10
    pixels = made.frames.resampled_px()

    def seconds(worked_out, **costs):
        return estimate(worked_out, replace(FREE, **costs), cores=1).seconds

    # The strips of all instants but one each, which any image has.
    assert seconds(made, strip_s=1.0) == 2 * sum(len(takes) - 1 for takes in instants)
    assert seconds(made, take_s_per_px=1.0) == (len(instants) - 1) * pixels
    red = plan(MOVED.replace(camera=Camera(red_scale=0.001)), PixelGrid())
    assert seconds(red, take_s_per_px=1.0) == (3 * len(instants) - 1) * pixels
    assert seconds(red, strip_s=1.0) == 3 * seconds(made, strip_s=1.0)


@pytest.mark.parametrize(("tilt_deg", "native_zoom"), [(0.0, 22), (30.0, 19), (60.0, 22)])
def test_images_by_area_take_the_time_of_their_samples(tilt_deg, native_zoom):
    mission = Mission(MOVED.area, 150.0, tilt_deg=tilt_deg, frame="camera", sampling="area")
    made = plan(mission, PixelGrid(native_zoom=native_zoom))
    found = estimate(made, replace(FREE, sample_s=1.0, sample_numpy_s=1.0), cores=1).seconds
    # Cells of strips are smaller than those of a whole image, and may read finer zooms.
    assert found == pytest.approx(sum(made.views.view(index).sample_count for index in (0, 1)), rel=0.3)


def test_effects_and_undistorted_twins_take_time():
    ideal = Mission(MOVED.area, 150.0, frame="camera")
    assert estimate(plan(ideal, PixelGrid()), FREE).seconds == 0.0
    one = estimate(plan(ideal.replace(mtf50=0.3), PixelGrid()), FREE).seconds
    more = estimate(
        plan(ideal.replace(mtf50=0.3, visibility_km=5.0, white_balance_k=5000.0), PixelGrid()), FREE
    ).seconds
    assert 0.0 < one < more
    bent, costs = ideal.replace(camera=Camera(k1=-0.1)), replace(FREE, warp_s_per_px=1.0)
    alone, twice = (
        estimate(plan(bent.replace(keep_undistorted=kept), PixelGrid()), costs).seconds for kept in (False, True)
    )
    assert twice == 2 * alone


def test_mosaics_take_the_time_of_the_pixels_that_they_read_and_make(tmp_path):
    from terrainav.core.capture.runner import capture
    from terrainav.core.imagery.opening import named_source
    from terrainav.core.mosaic.orthomosaic import make_orthomosaic

    one_a_px = replace(OFFLINE, mosaic_s_per_px=0.0, orthomosaic_s_per_px=1.0, orthomosaic_trace_s_per_px=0.0)
    small = Mission(Box(35.14, -89.87, 35.138, -89.868), 120.0, source="world", zoom=16)
    for number, options in enumerate(({"yaw_deg": 30.0}, {"tilt_deg": 30.0}, {"yaw_deg": 10.0, "overlap_along": 0.8})):
        made = plan(small.replace(**options), PixelGrid())
        capture(made, named_source("world").open(), tmp_path / str(number))
        mosaic = make_orthomosaic(tmp_path / str(number))
        assert mosaic_s(made, one_a_px, cores=1) == pytest.approx(mosaic.width_px * mosaic.height_px, rel=0.05)
    # Of map frames the images are read, of each map type; nothing is made anew.
    costs = replace(one_a_px, mosaic_s_per_px=1.0)
    level = plan(small.replace(map_types=("satellite", "roadmap")), PixelGrid())
    pixels = float((level.frames.width_px * level.frames.height_px).sum())
    assert mosaic_s(level, costs, cores=1) == 2.0 * pixels
    assert mosaic_s(level, costs, cores=4) == pixels / 2.0
    # A camera that sees the horizon has no endless mosaic, and the largest one is limited.
    flat = plan(small.replace(tilt_deg=85.0), PixelGrid())
    assert 0.0 < mosaic_s(flat, one_a_px, cores=1) < 1e8
    assert mosaic_s(plan(Mission(AGRICENTER, 30.0, yaw_deg=5.0, image_px=4000), PixelGrid()), one_a_px, 1) == 1 << 28


def test_points_have_no_area():
    words = text(estimate(plan(Mission(Points(((35, -89, 120),)), 120.0), PixelGrid())))
    assert "coverage" not in words
    assert "front overlap" not in words


def test_two_map_types_take_twice_as_much():
    one = plan(Mission(AGRICENTER, 400.0), PixelGrid())
    two = plan(Mission(AGRICENTER, 400.0, map_types=("satellite", "roadmap")), PixelGrid())
    for costs in (ONLINE, OFFLINE):
        single, double = estimate(one, costs), estimate(two, costs)
        assert double.seconds == pytest.approx(2 * single.seconds)
        assert double.output_bytes == pytest.approx(2 * single.output_bytes, abs=1)
    assert estimate(two, OFFLINE).download_bytes == 0


def test_why_nothing_is_downloaded_is_said():
    worked_out = plan(Mission(AGRICENTER, 400.0), PixelGrid())
    for costs, said in ((OFFLINE, "nothing (computed here)"), (FROM_FILE, "nothing (read from the file)")):
        summary = estimate(worked_out, costs)
        assert (summary.download_bytes, dict(summary.lines())["download"]) == (0, said)


def test_more_connections_take_less_time_until_encoding_is_the_limit():
    worked_out = plan(Mission(AGRICENTER, 120.0), PixelGrid())
    times = [estimate(worked_out, ONLINE, connections).seconds for connections in (1, 2, 4, 64, 4096)]
    assert times[0] == pytest.approx(2 * times[1])
    assert times[-1] == times[-2]


# --- native resolution

#: Pixels of zoom 16 at the height of Memphis are 1.95 m; the grid enlarges them up to zoom 22.
COARSE = PixelGrid(native_zoom=16)
#: From here a camera frame of 640 px has pixels of 1.95 m.
HIGH_M = 950.0


def warnings(grid=COARSE, agl_m=HIGH_M, **options):
    return estimate(plan(Mission(Points(((35.16, -89.90, agl_m),)), agl_m, **options), grid)).warnings


def test_pictures_of_the_source_s_own_pixels_are_not_warned_of():
    assert warnings() == ()
    assert warnings(zoom=16) == ()
    assert warnings(zoom=14) == ()
    assert warnings(PixelGrid(), zoom=22, agl_m=50.0) == ()
    assert warnings(img_size=(64, 48, 3)) == ()
    # A camera frame as large as the ground has pixels.
    assert warnings(frame="camera", zoom=16) == ()


def test_upsampling_is_named_with_both_distances_and_the_way_out():
    (text,) = warnings(zoom=18, upsample=True)
    # 1.953 m is 2 pi a cos(lat) / (256 * 2**16) on the ellipsoid.
    assert "requested 48.8" in text
    assert "but the source has 1.95" in text
    assert "(zoom 16): upsampled 4 times" in text
    assert text.endswith("ask for --zoom 16 or a finer source")
    assert "\n" not in text


def test_resizing_counts():
    worked_out = plan(Mission(Points(((35.16, -89.90, HIGH_M),)), HIGH_M, zoom=16), COARSE)
    width, height = int(worked_out.frames.width_px[0]), int(worked_out.frames.height_px[0])
    (text,) = warnings(zoom=16, img_size=(3 * width, 3 * height, 3))
    assert "upsampled 3 times" in text
    assert f"--img-size {width} {height} 3 or less" in text
    assert warnings(zoom=18, upsample=True, img_size=(width, height, 3)) == ()


def test_camera_frames_count_by_the_ground_below():
    (text,) = warnings(frame="camera", zoom=18, upsample=True)
    assert "upsampled 4 times" in text
    (text,) = warnings(frame="camera", image_px=2560, upsample=True)
    # Pixels of a camera of 640 px are 1.951 m here, and the source's 1.955 m.
    assert text.endswith("ask for --image-px 638 or less, or fly higher")
    assert warnings(frame="camera", image_px=638, upsample=True) == ()
    assert warnings(PixelGrid(), frame="camera", zoom=18) == ()


def test_warnings_are_among_the_figures_for_people_and_scripts():
    summary = estimate(plan(Mission(Points(((35.16, -89.90, HIGH_M),)), HIGH_M, zoom=18, upsample=True), COARSE))
    assert text(summary)["warning"] == summary.warnings[0]
    assert summary.to_dict()["warnings"] == summary.warnings


def test_a_limit_of_the_source_on_requests_is_time():
    worked_out = plan(Mission(AGRICENTER, 120.0), PixelGrid())
    slow = estimate(worked_out, replace(ONLINE, requests_per_s=2.0))
    assert slow.seconds == pytest.approx(worked_out.requests / 2.0)
    assert slow.seconds > estimate(worked_out, replace(ONLINE, requests_per_s=1e6)).seconds


@pytest.mark.parametrize(
    ("area_m2", "text"),
    [
        (0.5, "0.5 m²"),
        (9876.54, "9,877 m²"),
        (25_012.3, "25,012 m²"),
        (2.5e5, "0.25 km²"),
        (1.2345e10, "12,345 km²"),
    ],
)
def test_areas_are_written_without_powers_of_ten(area_m2, text):
    assert area_text(area_m2) == text
