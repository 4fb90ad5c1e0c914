"""Figures as users read them."""

from __future__ import annotations

import html
import math
import re
from pathlib import Path

import pytest
import terrainav.core.mission
from terrainav.core.errors import Message, OptionName
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.estimate import FROM_FILE, OFFLINE, ONLINE, estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.i18n import translate
from terrainav.terrainav_plugin.panel.figures import readout
from terrainav.terrainav_plugin.sources import mission_grid
from terrainav.terrainav_plugin.units import duration_text

AREA = Box(35.16, -89.90, 35.115, -89.823)
# Tiles with pixels of their own up to zoom 17, which are served to 19.
COARSE = "esri-world-imagery"
# What says something about a mission that is planned.
ROOMS = (
    "estimate",
    "layout/framing",
    "layout/rotated",
    "layout/parallels",
    "layout/paper",
    "layout/rows",
    "methods",
    "mission",
    "plan",
)


def options_in_messages():
    """Options of the command that are named to whom plans a mission."""
    folder = Path(terrainav.core.mission.__file__).parent
    texts = ((folder / f"{room}.py").read_text(encoding="utf-8") for room in ROOMS)
    return {option for text in texts for option in re.findall(r"OptionName\(\"(\w+)\"\)", text)}


def readout_of(mission, costs=OFFLINE, unit="m"):
    planned = plan(mission, mission_grid(mission))
    summary = estimate(planned, costs)
    return summary, readout(planned, summary, unit)


def lines_of(mission, costs=OFFLINE, unit="m"):
    summary, shown = readout_of(mission, costs, unit)
    return summary, dict((*shown.figures, *shown.details))


def test_figures_of_a_covered_area():
    summary, lines = lines_of(Mission(area=AREA, agl_m=120.0))
    assert lines["Images"] == f"{summary.images:,} in {summary.rows} rows"
    assert lines["Coverage"].startswith("100 % of 35.03 km²")
    assert lines["Download"] == f"No download ({summary.unique_tiles:,} local tiles)"
    _, lines = lines_of(Mission(area=AREA, agl_m=120.0), FROM_FILE)
    assert lines["Download"] == f"No download ({summary.unique_tiles:,} local tiles)"


def test_what_is_left_out_is_said_and_never_reads_as_everything():
    summary, lines = lines_of(Mission(area=AREA, agl_m=120.0, layout="paper"))
    assert not summary.complete
    share = float(lines["Coverage"].partition(" %")[0])
    assert 0.0 < share <= 100.0 * summary.covered_share < 100.0
    assert "not covered" in lines["Coverage"]


def test_coverage_is_that_of_the_area_outside_no_fly_areas():
    corners = ((-89.88, 35.12), (-89.87, 35.12), (-89.87, 35.13), (-89.88, 35.13))
    zone = Polygon((corners,))
    summary, lines = lines_of(Mission(area=AREA, agl_m=120.0, no_fly=(zone,)))
    held_km2 = zone.area_m2() / 1e6
    assert lines["Coverage"].startswith(f"{int(summary.covered_share * 1e4) / 1e2:.2f} % of ")
    assert f" % of {35.03 - held_km2:.2f} km² outside no-fly areas; " in lines["Coverage"]
    assert lines["No-fly areas"] == f"Images left out: {summary.images_over_no_fly}; {held_km2:.3f} km² of the area"


def test_the_mosaic_s_time_is_said_apart_and_counted():
    for tilt_deg in (0.0, 20.0):
        summary, lines = lines_of(Mission(area=AREA, agl_m=300.0, tilt_deg=tilt_deg))
        mosaic = duration_text(summary.mosaic_s)
        assert lines["Time"] == f"About {duration_text(summary.seconds)}, then {mosaic} for the mosaic"


def test_several_map_types_count_together():
    one, single = lines_of(Mission(area=AREA, agl_m=120.0), ONLINE)
    _, double = lines_of(Mission(area=AREA, agl_m=120.0, map_types=("satellite", "terrain")), ONLINE)
    assert "for each of 2 map types" in double["Images"]
    assert single["Download"].endswith(f" in {one.unique_tiles:,} tiles")
    assert double["Download"].endswith(f" in {2 * one.unique_tiles:,} tiles")


def test_points_have_neither_coverage_nor_overlap():
    _, lines = lines_of(Mission(area=Points(((35.0, -89.0, 100.0),)), agl_m=100.0))
    assert "Coverage" not in lines
    assert "Overlap" not in lines


def test_what_matters_comes_first_and_the_rest_is_behind_the_fold():
    _, shown = readout_of(Mission(area=AREA, agl_m=300.0, overlap_along=0.6))
    assert [label for label, _ in shown.figures] == [
        *("Images", "Coverage", "Overlap", "GSD", "Flight", "Time in the air", "Download", "Time")
    ]
    assert {"Image", "Tiles", "On disk", "Methods", "Error", "Terrain", "Cost"} <= dict(shown.details).keys()
    for table, lines in ((shown.figures_html(), shown.figures), (shown.details_html(), shown.details)):
        assert all(html.escape(label) in table and html.escape(value) in table for label, value in lines)


def test_gsd_is_the_two_figures_of_the_command():
    summary, lines = lines_of(Mission(area=AREA, agl_m=120.0))
    # By the formula, from the diagonal of 640 x 480 px.
    camera_cm = 100.0 * 2.0 * 120.0 * math.tan(math.radians(78.8 / 2.0)) / 800.0
    delivered_cm = 100.0 * summary.delivered_gsd_m_per_px
    assert lines["GSD"] == f"Requested {camera_cm:.4g} cm, delivered {delivered_cm:.4g} cm"
    assert lines["GSD"].lower() == dict(summary.lines())["ground sample distance"]


def test_source_that_is_coarser_than_the_camera_is_said_to_be():
    near = Mission(area=Box(35.14, -89.87, 35.1395, -89.8695), agl_m=20.0, source=COARSE)
    summary, lines = lines_of(near)
    own = f"{100.0 * summary.delivered_gsd_m_per_px:.4g} cm"
    hint = f"(the source's GSD is {own}: images show no finer detail)"
    assert lines["GSD"].endswith(hint)
    assert "detail" not in lines_of(near.replace(agl_m=2000.0))[1]["GSD"]


def test_feet_come_with_inches_miles_and_acres():
    there = Mission(area=AREA, agl_m=120.0, layout="paper")
    summary, lines = lines_of(there, unit="ft")
    assert lines["Flight"].startswith(f"{summary.flight_distance_m / 1609.344:.4g} mi, ")
    inches = summary.delivered_gsd_m_per_px / 0.0254
    assert f"delivered {inches:.4g} in" in lines["GSD"]
    assert f"of {summary.area_m2 / 2589988.110336:.4g} sq mi" in lines["Coverage"]
    assert f"{summary.uncovered_m2 / 4046.8564224:.4g} acres not covered" in lines["Coverage"]
    assert " m," not in lines["Flight"]
    assert "km" not in "".join(value for label, value in lines.items() if label != "Terrain")


def test_warnings_speak_of_entries_not_of_options():
    large = Mission(area=AREA, agl_m=120.0, img_size=(4000, 3000, 3), source=COARSE)
    summary, shown = readout_of(large, ONLINE)
    assert any("--img-size" in text for text in summary.warnings)
    assert any("“Resize images”" in text for text in shown.warnings)
    assert not any("--" in text for text in shown.warnings)


def test_the_size_of_the_images_is_that_of_the_source_where_it_is_coarser():
    near = Mission(area=Box(35.14, -89.87, 35.1395, -89.8695), agl_m=20.0, source=COARSE)
    summary, shown = readout_of(near)
    own = f"{100.0 * plan(near, mission_grid(near)).resolution.source_m_per_px:.4g} cm"
    size = f"{summary.width_px} × {summary.height_px} px of 640 × 480: the source has {own}"
    assert size in shown.line
    assert summary.width_px < 640
    assert shown.links == ("higher", "upsample", "source")
    # At the height to which the link leads, images have the camera's size, to a pixel's rounding.
    source_m = plan(near, mission_grid(near)).resolution.source_m_per_px
    higher = near.replace(agl_m=near.flight.agl_m * source_m / summary.requested_gsd_m_per_px)
    summary, shown = readout_of(higher)
    assert summary.width_px == pytest.approx(640, rel=0.01)
    assert f"{summary.width_px} × {summary.height_px} px" in shown.line
    assert shown.links == ()
    # Upsampled images have it, too.
    summary, shown = readout_of(near.replace(upsample=True))
    assert f"{summary.width_px} × {summary.height_px} px" in shown.line
    assert shown.links == ()
    # From high up the camera is the limit.
    assert readout_of(near.replace(agl_m=2000.0))[1].links == ()


def test_the_figures_that_decide_are_a_line():
    summary, shown = readout_of(Mission(area=AREA, agl_m=120.0))
    assert shown.line == (
        f"{summary.images:,} images",
        "100 % covered",
        f"GSD {100.0 * summary.delivered_gsd_m_per_px:.4g} cm",
        f"{summary.width_px} × {summary.height_px} px",
        f"{duration_text(summary.seconds + summary.mosaic_s)} to capture",
    )
    _, shown = readout_of(Mission(area=AREA, agl_m=120.0, layout="paper"))
    assert "100 % covered" not in shown.line
    _, shown = readout_of(Mission(area=AREA, agl_m=120.0, img_size=(224, 224, 3)))
    assert any(part.startswith("224 × 224 px, resized from ") for part in shown.line)


@pytest.mark.parametrize("option", sorted(options_in_messages()))
def test_no_advice_of_the_core_names_an_option_in_the_dock(option):
    said = translate(Message("larger images ({0}), or smaller ones", OptionName(option)))
    assert "--" not in said
    # Each is an entry of the dock, but the limit of images, which says where it is.
    assert "“" in said


@pytest.mark.parametrize(("seconds", "text"), [(0.2, "1 s"), (89.4, "89 s"), (120.0, "2 min"), (7200.0, "2.0 h")])
def test_durations(seconds, text):
    assert duration_text(seconds) == text
