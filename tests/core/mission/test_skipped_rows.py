"""Rows that a mission skips: the others are those of the whole mission, and the flight goes to and fro over them."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points, Polygon, Polygons
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.text.ranges import ranges_text, read_ranges, toggled

from tests.support.command import command
from tests.support.sources import PatternSource
from tests.support.thinning import examples

GEOD = Geod(ellps="WGS84")
GRID = PixelGrid()
FIELD = Mission(Box(47.408, 8.500, 47.400, 8.504), 60.0, overlap_along=0.2)
SEVERAL = Polygons(
    (
        Polygon((((8.500, 47.400), (8.504, 47.400), (8.502, 47.404)),)),
        Polygon((((8.507, 47.401), (8.511, 47.402), (8.508, 47.405)),)),
    )
)
WAYS = [
    {},
    {"order": "one-way"},
    {"facing": "track"},
    {"row_azimuth_deg": 30.0},
    {"row_azimuth_deg": 30.0, "facing": "track", "entry": "south-east"},
    {"entry": "north-east"},
    {"crosshatch": True},
    {"area": SEVERAL},
    {"area": SEVERAL, "row_azimuth_deg": 100.0, "facing": "track"},
    {"layout": "paper"},
]


def planned(**changes):
    return plan(FIELD.replace(**changes), GRID)


def keys(made, *, by_pose=True):
    poses = np.round([made.lat_deg, made.lon_deg], 12).T.tolist() if by_pose else made.names
    return set(zip(made.column.tolist(), made.row.tolist(), map(str, poses)))


@pytest.mark.parametrize("changes", WAYS)
@settings(max_examples=examples(12), deadline=None)
@given(data=st.data())
def test_skipped_rows_and_the_rest_are_all(changes, data):
    whole = planned(**changes)
    last = int(whole.row.max())
    skipped = data.draw(st.sets(st.integers(0, last), min_size=1, max_size=last))
    rest = sorted(set(range(last + 1)) - skipped)
    text, other = (ranges_text((one, one) for one in rows) for rows in (skipped, rest))
    kept, left = planned(**changes, skip_rows=text), planned(**changes, skip_rows=other)
    assert keys(kept) | keys(left) == keys(whole)
    assert not keys(kept) & keys(left)
    assert sorted(set(kept.row.tolist())) == rest
    assert kept.in_skipped_rows == len(left)
    assert set(kept.names) | set(left.names) == set(whole.names)
    # Each row is flown along, from one end to the other.
    assert set(np.abs(np.diff(kept.column)[np.diff(kept.row) == 0]).tolist()) <= {1}
    assert estimate(kept).rows == len(rest)


@pytest.mark.parametrize("changes", [{}, {"row_azimuth_deg": 91.0}, {"entry": "south-east"}])
def test_the_flight_goes_to_and_fro_over_the_rest(changes):
    made = planned(**changes, area=Box(47.408, 8.500, 47.400, 8.510), skip_rows="2,5-6")
    ends = np.flatnonzero(np.diff(made.row))
    lon, lat = made.lon_deg, made.lat_deg
    across = GEOD.inv(lon[ends], lat[ends], lon[ends + 1], lat[ends + 1])[2]
    row = GEOD.inv(lon[0], lat[0], lon[ends[0]], lat[ends[0]])[2]
    spacing = float(np.min(across))
    assert row > 3.0 * spacing
    # The way to the next row is never a way back along it.
    assert across.max() < 1.2 * 3.0 * spacing


def test_images_turn_with_rows_that_are_flown_the_other_way():
    made = planned(facing="track", skip_rows="1")
    for row in (0, 2, 3):
        at = np.flatnonzero(made.row == row)
        azimuth = GEOD.inv(made.lon_deg[at[0]], made.lat_deg[at[0]], made.lon_deg[at[1]], made.lat_deg[at[1]])[0]
        assert (made.poses.yaw_deg[at] - azimuth + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=0.1)


def test_oblique_views_along_the_track_keep_the_direction_of_their_rows():
    whole, made = (planned(facing="track", tilt_deg=20.0, skip_rows=text) for text in ("", "1"))
    rest = whole.row != 1
    np.testing.assert_array_equal(made.column, whole.column[rest])
    np.testing.assert_array_equal(made.poses.yaw_deg, whole.poses.yaw_deg[rest])


@pytest.mark.parametrize("changes", [{}, {"row_azimuth_deg": 30.0}])
def test_the_coverage_is_less_by_what_only_the_skipped_rows_show(changes):
    whole, made = planned(**changes), planned(**changes, skip_rows="3")
    assert whole.coverage.complete
    assert not made.coverage.complete
    step = 1.0 / estimate(whole).rows
    assert 1.0 - made.coverage.share == pytest.approx(step, rel=0.35)


def test_a_capture_has_the_images_of_the_rest_with_the_names_of_the_whole(tmp_path):
    small = FIELD.replace(area=Box(47.402, 8.500, 47.400, 8.502), max_px=64)
    whole, made = plan(small, GRID), plan(small.replace(skip_rows="1"), GRID)
    capture(whole, PatternSource(), tmp_path / "whole")
    capture(made, PatternSource(), tmp_path / "rest")
    ours, theirs = ({file.name: file for file in (tmp_path / name).rglob("*.tif")} for name in ("rest", "whole"))
    assert sorted(ours) == sorted(f"{name}.tif" for name in made.names)
    assert len(ours) == len(theirs) - made.in_skipped_rows < len(theirs)
    for name, file in ours.items():
        assert file.read_bytes() == theirs[name].read_bytes()


def test_estimates_state_the_skipped_rows():
    summary = estimate(planned(skip_rows="7-9,3"))
    assert summary.skip_rows == "3,7-9"
    lines = {str(label): str(text) for label, text in summary.lines()}
    assert lines["skipped rows"] == f"3,7-9: {summary.images_in_skipped_rows:,} images left out"
    assert "skipped rows" not in {str(label) for label, _ in estimate(planned()).lines()}


# --- entries


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"skip_rows": "4-2"}, "must be numbers and ranges such as 3,7-9"),
        ({"skip_rows": "three"}, "must be numbers and ranges such as 3,7-9"),
        ({"skip_rows": "٣"}, "must be numbers and ranges such as 3,7-9"),
        ({"skip_rows": "-1"}, "must be numbers and ranges such as 3,7-9"),
        ({"skip_rows": "3,999999999"}, "the rows of this mission are 0 to"),
        ({"skip_rows": "0-20"}, "the rows of this mission are 0 to"),
        ({"area": Points(((47.4, 8.5, 60.0),)), "skip_rows": "0"}, "points have no rows"),
    ],
)
def test_wrong_rows_are_one_clear_line(changes, words):
    with pytest.raises(InvalidInput, match=words) as refused:
        planned(**changes)
    assert refused.value.field == "skip_rows"
    assert "\n" not in str(refused.value)


def test_a_mission_without_rows_is_refused():
    last = int(planned().row.max())
    with pytest.raises(InvalidInput, match="no row is left"):
        planned(skip_rows=f"0-{last}")


def test_equal_rows_make_equal_missions():
    assert FIELD.replace(skip_rows=" 9, 7 - 8,3 ").to_json() == FIELD.replace(skip_rows="3,7-9").to_json()
    assert "skip_rows" not in FIELD.to_json()
    assert Mission.from_json(FIELD.replace(skip_rows="3").to_json()).flight.skip_rows == "3"


@given(st.sets(st.integers(0, 40)), st.sets(st.integers(0, 40), min_size=1))
def test_toggled_numbers_are_added_or_taken_out_together(held, asked):
    text = ranges_text((one, one) for one in held)
    found = {one for first, last in read_ranges(toggled(text, asked)) for one in range(first, last + 1)}
    assert found == (held - asked if asked <= held else held | asked)


def test_the_command_takes_rows_and_splits(tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    box = ("--coords", "47.408_8.500_47.400_8.504_60", "--overlap", "0.2")
    done = run("plan", *box, "--skip-rows", "7-9,3", "--takeoff", "47.4", "8.499", "--split-after", "9,4")
    assert done.returncode == 0
    assert "skipped rows            3,7-9: " in done.stdout
    assert "sorties                 3: " in done.stdout
    assert json.loads(run("plan", *box, "--skip-rows", "3", "--json").stdout)["skip_rows"] == "3"
    done = run("plan", *box, "--skip-rows", "300")
    assert done.returncode == 2
    assert "skipped rows 300: the rows of this mission are 0 to " in done.stderr
