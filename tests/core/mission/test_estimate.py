"""The figures people see."""

from __future__ import annotations

import json

import pytest
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.area import Box, Points
from terrainav.core.mission.estimate import OFFLINE, ONLINE, estimate, percent
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

AGRICENTER = Box(35.16, -89.90, 35.115, -89.823)


def text(summary):
    return dict(summary.lines())


def test_the_papers_mission_in_words():
    summary = estimate(plan(Mission(AGRICENTER, 120.0), PixelGrid()))
    words = text(summary)
    assert words["images"] == "1,935"
    assert words["coverage"] == "100 % (complete)"
    assert "48.8" in words["ground sample distance"]
    assert summary.download_bytes == summary.unique_tiles * ONLINE.request_bytes
    json.dumps(summary.to_dict())


def test_what_is_not_complete_never_reads_so():
    summary = estimate(plan(Mission(AGRICENTER, 120.0, layout="paper"), PixelGrid()))
    assert text(summary)["coverage"].startswith("99.7")
    assert "uncovered" in text(summary)["coverage"]
    assert percent(0.999999, exact=False) == "99.9999 %"


def test_points_have_no_area():
    words = text(estimate(plan(Mission(Points(((35, -89, 120),)), 120.0), PixelGrid())))
    assert "coverage" not in words
    assert "overlap along rows" not in words


def test_two_map_types_take_twice_as_much():
    one = plan(Mission(AGRICENTER, 400.0), PixelGrid())
    two = plan(Mission(AGRICENTER, 400.0, map_types=("satellite", "roadmap")), PixelGrid())
    for costs in (ONLINE, OFFLINE):
        single, double = estimate(one, costs), estimate(two, costs)
        assert double.seconds == pytest.approx(2 * single.seconds)
        assert double.output_bytes == pytest.approx(2 * single.output_bytes, abs=1)
    assert estimate(two, OFFLINE).download_bytes == 0


def test_more_connections_take_less_time_until_encoding_is_the_limit():
    worked_out = plan(Mission(AGRICENTER, 120.0), PixelGrid())
    times = [estimate(worked_out, ONLINE, connections).seconds for connections in (1, 2, 4, 64, 4096)]
    assert times[0] == pytest.approx(2 * times[1])
    assert times[-1] == times[-2]
