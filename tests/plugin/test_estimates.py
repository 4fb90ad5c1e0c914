"""Figures as users read them."""

from __future__ import annotations

import pytest
from terrainav.core.mission.area import Box, Points
from terrainav.core.mission.estimate import OFFLINE, ONLINE, estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.dock.estimates import duration_text, estimate_html, estimate_lines
from terrainav.terrainav_plugin.sources import grid_of

AREA = Box(35.16, -89.90, 35.115, -89.823)


def lines_of(mission, costs=OFFLINE):
    summary = estimate(plan(mission, grid_of(mission)), costs)
    return summary, dict(estimate_lines(summary))


def test_figures_of_a_covered_area():
    summary, lines = lines_of(Mission(area=AREA, agl_m=120.0))
    assert lines["Images"] == f"{summary.images:,} in {summary.rows} rows"
    assert lines["Coverage"].startswith("100 % of 35.03 km²")
    assert lines["Tiles"] == f"{summary.unique_tiles:,}, computed here"


def test_what_is_left_out_is_said_and_never_reads_as_everything():
    summary, lines = lines_of(Mission(area=AREA, agl_m=120.0, layout="paper"))
    assert not summary.complete
    share = float(lines["Coverage"].partition(" %")[0])
    assert 0.0 < share <= 100.0 * summary.covered_share < 100.0
    assert "left out" in lines["Coverage"]


def test_several_map_types_count_together():
    one, single = lines_of(Mission(area=AREA, agl_m=120.0), ONLINE)
    _, double = lines_of(Mission(area=AREA, agl_m=120.0, map_types=("satellite", "terrain")), ONLINE)
    assert "for each of 2 map types" in double["Images"]
    assert single["Tiles"].startswith(f"{one.unique_tiles:,}, about ")
    assert double["Tiles"].startswith(f"{2 * one.unique_tiles:,}, about ")


def test_points_have_neither_coverage_nor_overlap():
    _, lines = lines_of(Mission(area=Points(((35.0, -89.0, 100.0),)), agl_m=100.0))
    assert "Coverage" not in lines
    assert "Overlap" not in lines


def test_every_figure_is_in_the_table():
    summary, lines = lines_of(Mission(area=AREA, agl_m=300.0))
    table = estimate_html(summary)
    assert all(label in table and value in table for label, value in lines.items())


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.2, "1 s"), (89.4, "89 s"), (120.0, "2 min"), (7200.0, "2.0 h")]
)
def test_durations(seconds, text):
    assert duration_text(seconds) == text
