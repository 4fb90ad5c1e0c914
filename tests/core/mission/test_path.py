"""The path of a flight: where it enters, what it has between captures, and how batteries split it."""

from __future__ import annotations

import itertools
from dataclasses import astuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.flight.path import (
    CAPTURE,
    CLIMB_M_PER_S,
    HOVER_S,
    LANDING,
    LEAD_IN,
    TAKEOFF,
    TRANSIT,
    TURNAROUND,
)
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.thinning import examples, sampled

GEOD = Geod(ellps="WGS84")
GRID = PixelGrid()
FIELD = Mission(Box(35.158, -89.90, 35.155, -89.894), 120.0, overlap_along=0.5, overlap_across=0.5)
HOME = (35.1565, -89.9015)
CORNERS = ("north-west", "north-east", "south-east", "south-west")


def flown(mission=FIELD, **changes):
    return plan(mission.replace(**changes), GRID)


def lengths(path):
    return GEOD.inv(path.lon_deg[:-1], path.lat_deg[:-1], path.lon_deg[1:], path.lat_deg[1:])[2]


def test_without_a_route_it_is_the_captures_alone():
    made = flown(wind=Wind(5.0, 200.0, 0.2))
    path = made.path
    assert path.is_captures
    assert path.capture.tolist() == list(range(len(made)))
    assert path.lat_deg is made.nominal.lat_deg
    assert path.time_s is made.direct.exposures_s
    assert made.times_s is made.direct.exposures_s
    assert (path.agl_m == made.nominal.agl_m).all()
    assert "route" not in made.mission.to_dict()


# --- entry


@pytest.mark.parametrize(
    "changes", sampled([{}, {"order": "one-way"}, {"row_azimuth_deg": 120.0}, {"row_azimuth_deg": 40.0}], 2)
)
def test_a_flight_enters_at_each_corner_and_takes_the_same_images(changes):
    as_laid_out = flown(**changes)
    begins = {}
    for corner in CORNERS:
        made = flown(entry=corner, **changes)
        assert sorted(made.names) == sorted(as_laid_out.names)
        assert astuple(made.overlap) == pytest.approx(astuple(as_laid_out.overlap), abs=1e-9)
        assert made.coverage == as_laid_out.coverage
        # Row by row, along each from end to end.
        assert np.count_nonzero(np.diff(made.row)) == made.rows - 1
        assert set(np.abs(np.diff(made.column)[np.diff(made.row) == 0])) == {1}
        begins[corner] = float(made.lon_deg[0]), float(made.lat_deg[0])
    assert len(set(begins.values())) == 4
    east = [begins[corner][0] for corner in CORNERS]
    north = [begins[corner][1] for corner in CORNERS]
    # Together they lie towards their corners as far as four corners can.
    towards = sum(x * a + y * b for x, y, a, b in zip(east, north, (-1, 1, 1, -1), (1, 1, -1, -1)))
    others = (
        sum(east[i] * a + north[i] * b for i, a, b in zip(order, (-1, 1, 1, -1), (1, 1, -1, -1)))
        for order in itertools.permutations(range(4))
    )
    assert towards == pytest.approx(max(others), abs=1e-5)


def test_rows_of_one_way_are_flown_the_other_way_from_the_east():
    made = flown(entry="north-east", order="one-way")
    assert (np.diff(made.lon_deg)[np.diff(made.row) == 0] < 0.0).all()
    made = flown(entry="south-west", order="one-way")
    assert (np.diff(made.lon_deg)[np.diff(made.row) == 0] > 0.0).all()
    assert made.row[0] == made.rows - 1


@pytest.mark.parametrize("home", [(35.2, -89.95), (35.2, 270.2), (35.1, -89.8), (35.1, -89.95)])
def test_the_nearest_corner_is_that_to_the_take_off(home):
    made = flown(entry="nearest", takeoff=home)
    others = [flown(entry=corner) for corner in CORNERS]
    away = [GEOD.inv(home[1], home[0], one.lon_deg[0], one.lat_deg[0])[2] for one in (made, *others)]
    assert away[0] == min(away)


def test_a_second_pass_begins_near_the_end_of_the_first():
    made = flown(entry="south-east", crosshatch=True)
    first, second = (part.first for part in made.passes)
    as_laid_out = flown(crosshatch=True)
    assert sorted(made.names) == sorted(as_laid_out.names)
    ends = [(made.lon_deg[at], made.lat_deg[at]) for at in (second - 1, second)]
    across = GEOD.inv(made.lon_deg[0], made.lat_deg[0], made.lon_deg[second - 1], made.lat_deg[second - 1])[2]
    assert GEOD.inv(*ends[0], *ends[1])[2] < across / 2.0
    assert astuple(made.overlap) == pytest.approx(astuple(as_laid_out.overlap), abs=1e-9)
    assert first == 0


def test_points_keep_their_order():
    points = Points(((35.0, -89.0, 100.0), (35.01, -89.0, 100.0), (35.005, -89.01, 100.0)))
    made = plan(Mission(points, 100.0, entry="south-west"), GRID)
    assert made.lat_deg.tolist() == [35.0, 35.01, 35.005]


# --- what lies between captures


def test_lead_ins_and_turnarounds_lie_on_the_lines_of_their_rows():
    path = flown(lead_in_m=20.0, turnaround_m=35.0).path
    kinds = path.kind.tolist()
    assert kinds[0] == LEAD_IN
    assert kinds[-1] == TURNAROUND
    for at, kind in enumerate(kinds):
        if kind == CAPTURE:
            continue
        own, inner, way_m = (at + 1, at + 2, 20.0) if kind == LEAD_IN else (at - 1, at - 2, 35.0)
        there, _, far = GEOD.inv(path.lon_deg[at], path.lat_deg[at], path.lon_deg[own], path.lat_deg[own])
        assert far == pytest.approx(way_m, abs=1e-6)
        on, _, _ = GEOD.inv(path.lon_deg[own], path.lat_deg[own], path.lon_deg[inner], path.lat_deg[inner])
        assert (there - on + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=1e-3)
    # Each row has one of each.
    assert kinds.count(LEAD_IN) == kinds.count(TURNAROUND) == flown().rows
    assert path.agl_m == pytest.approx(120.0)


def test_a_flight_begins_and_ends_on_the_ground_at_the_take_off():
    made = flown(takeoff=HOME, ground_height_m=55.0)
    path = made.path
    assert path.kind[[0, 1, -2, -1]].tolist() == [TAKEOFF, TRANSIT, TRANSIT, LANDING]
    for at in (0, 1, -2, -1):
        assert (path.lat_deg[at], path.lon_deg[at]) == HOME
    assert path.height_m[[0, -1]].tolist() == [55.0, 55.0]
    assert path.agl_m[1:-1] == pytest.approx(120.0)
    assert path.base_m == 55.0
    assert path.capture[path.kind == CAPTURE].tolist() == list(range(len(made)))


@pytest.mark.parametrize("wind", [None, Wind(6.0, 250.0, 0.0)])
@pytest.mark.parametrize("trigger", ["waypoint", "hover"])
def test_times_are_those_of_the_legs(wind, trigger):
    made = flown(takeoff=HOME, turnaround_m=30.0, wind=wind, trigger=trigger)
    path = made.path
    azimuth, _, length = GEOD.inv(path.lon_deg[:-1], path.lat_deg[:-1], path.lon_deg[1:], path.lat_deg[1:])
    along = np.radians(azimuth)
    speed = 15.0
    if wind is not None:
        # The triangle of wind, solved for the speed over ground.
        blown = -6.0 * np.cos(np.radians(250.0) - along), -6.0 * np.sin(np.radians(250.0) - along)
        speed = blown[0] + np.sqrt(15.0**2 - blown[1] ** 2)
    wanted = np.maximum(length / speed, np.abs(np.diff(path.height_m)) / CLIMB_M_PER_S)
    if trigger == "hover":
        wanted = wanted + HOVER_S * (path.kind[:-1] == CAPTURE)
    assert np.diff(path.time_s) == pytest.approx(wanted, abs=1e-6)
    assert path.time_s[path.capture == 0] == 0.0
    assert (made.times_s == path.time_s[path.kind == CAPTURE]).all()
    assert path.distance_m == pytest.approx(length.sum(), abs=1e-6)


def test_points_with_times_of_their_own_keep_them():
    poses = tuple((35.0 + 0.001 * at, -89.0, 100.0) for at in range(5))
    times = (1e9, 1e9 + 60.0, 1e9 + 200.0, 1e9 + 210.0, 1e9 + 500.0)
    made = plan(Mission(Points(poses, times_s=times), 100.0, takeoff=(35.0, -89.01)), GRID)
    assert made.times_s == pytest.approx(np.array(times) - 1e9)
    assert (np.diff(made.path.time_s) > 0.0).all()


def test_across_the_antimeridian_longitudes_run_on():
    there = Mission(Box(0.002, 179.998, -0.002, -179.998), 120.0)
    path = plan(there.replace(takeoff=(0.0, -179.99), turnaround_m=20.0), GRID).path
    assert np.abs(np.diff(path.lon_deg)).max() < 0.1
    assert lengths(path).max() < 3000.0


# --- no-fly areas

TOWER = Polygon((((-89.8985, 35.1560), (-89.8965, 35.1560), (-89.8965, 35.1572), (-89.8985, 35.1572)),))


def crosses(path, polygon):
    """Whether the path touches a polygon, as GEOS has it."""
    ring = [*polygon.rings[0], polygon.rings[0][0]]
    ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
    shape = ogr.CreateGeometryFromWkt("POLYGON((" + ",".join(f"{x} {y}" for x, y in ring) + "))")
    points = ",".join(f"{x!r} {y!r}" for x, y in zip(path.lon_deg.tolist(), path.lat_deg.tolist()))
    return shape.Intersects(ogr.CreateGeometryFromWkt(f"LINESTRING({points})"))


def test_the_way_there_and_back_leads_around_a_no_fly_area():
    away = Box(35.158, -89.894, 35.155, -89.890)
    mission = FIELD.replace(area=away, takeoff=HOME, entry="nearest")
    straight, around = (plan(one, GRID).path for one in (mission, mission.replace(no_fly=(TOWER,))))
    assert crosses(straight, TOWER)
    assert not crosses(around, TOWER)
    assert around.kind.tolist().count(TRANSIT) > straight.kind.tolist().count(TRANSIT)
    assert straight.distance_m < around.distance_m < 1.2 * straight.distance_m


def test_a_take_off_inside_a_no_fly_area_is_refused():
    with pytest.raises(InvalidInput, match="lies inside a no-fly area; move it outside"):
        _ = flown(takeoff=(35.1565, -89.8975), no_fly=(TOWER,), area=Box(35.158, -89.894, 35.155, -89.89)).path


# --- batteries


@settings(max_examples=examples(25), deadline=None)
@given(
    battery=st.floats(4.0, 12.0),
    north=st.floats(35.152, 35.162),
    turnaround=st.sampled_from([0.0, 40.0]),
    trigger=st.sampled_from(["waypoint", "hover"]),
    angle=st.sampled_from([0.0, 35.0]),
)
def test_no_sortie_is_longer_than_a_battery_and_each_begins_and_ends_at_home(
    battery, north, turnaround, trigger, angle
):
    made = flown(
        takeoff=(north, -89.90),
        battery_min=battery,
        turnaround_m=turnaround,
        trigger=trigger,
        row_azimuth_deg=90.0 + angle,
    )
    path = made.path
    assert path.capture[path.capture >= 0].tolist() == list(range(len(made)))
    assert path.sortie[0] == 0
    assert set(np.diff(path.sortie)) <= {0, 1}
    assert path.sorties_s.max() <= 60.0 * battery + 1e-6
    for number in range(path.sorties):
        one = path.sortie_path(number)
        assert (one.kind[0], one.kind[-1]) == (TAKEOFF, LANDING)
        assert one.time_s[-1] - one.time_s[0] == pytest.approx(path.sorties_s[number])
    assert (np.diff(path.time_s) >= -1e-9).all()
    if path.sorties > 1:
        # One image more would not have fitted, or the sortie ends with its row.
        last = path.capture[path.sortie == 0].max()
        assert made.row[last] != made.row[last + 1] or path.sorties_s[0] > 0.4 * 60.0 * battery


def test_sorties_end_with_a_row_where_that_uses_half_a_battery():
    made = flown(takeoff=HOME, battery_min=4.0)
    path = made.path
    lasts = [path.capture[path.sortie == number].max() for number in range(path.sorties - 1)]
    assert len(lasts) >= 1
    assert all(made.row[last] != made.row[last + 1] for last in lasts)


def test_a_battery_for_all_of_it_splits_nothing():
    whole, split = flown(takeoff=HOME).path, flown(takeoff=HOME, battery_min=600.0).path
    assert split.sorties == 1
    assert split.time_s.tolist() == whole.time_s.tolist()


def test_an_image_too_far_is_one_clear_line():
    with pytest.raises(
        InvalidInput, match=r"battery of 1 min: the way to image 1 and back takes \d+\.\d min"
    ) as refused:
        _ = flown(takeoff=(35.3, -89.9), battery_min=1.0).path
    assert refused.value.field == "battery_min"


@pytest.mark.parametrize("changes", [{"entry": "nearest"}, {"battery_min": 20.0}])
def test_what_needs_a_take_off_is_refused_without_one(changes):
    with pytest.raises(InvalidInput, match="needs a take-off point"):
        FIELD.replace(**changes)


# --- entry of rows whose cameras face their track


@pytest.mark.parametrize("order", ["serpentine", "one-way"])
@pytest.mark.parametrize("corner", sampled(CORNERS, 4))
@pytest.mark.parametrize(
    ("tilt", "azimuth"),
    [
        (0.0, 125.0),
        (15.0, 90.0),
        *(pytest.param(*case, marks=pytest.mark.thorough) for case in ((0.0, 90.0), (15.0, 125.0))),
    ],
)
def test_cameras_face_their_track_wherever_the_flight_enters(order, corner, tilt, azimuth):
    tracking = {"facing": "track", "tilt_deg": tilt, "order": order, "row_azimuth_deg": azimuth}
    made, as_laid_out = flown(entry=corner, **tracking), flown(**tracking)
    same = made.row[1:] == made.row[:-1]
    heading, _, _ = GEOD.inv(made.lon_deg[:-1], made.lat_deg[:-1], made.lon_deg[1:], made.lat_deg[1:])
    off = (made.poses.yaw_deg[:-1] - heading + 180.0) % 360.0 - 180.0
    assert np.abs(off[same]).max() < 0.05
    # Their images lie the other way round, but at the same places.
    places = [sorted(zip(one.column, one.row, one.lat_deg, one.lon_deg)) for one in (made, as_laid_out)]
    assert places[0] == places[1]
    assert made.coverage.complete
    assert astuple(made.overlap) == pytest.approx(astuple(as_laid_out.overlap), abs=1e-6)


# --- sorties split at images


@pytest.mark.parametrize("battery_min", [None, 3.2, 5.0])
def test_a_flight_is_split_after_the_named_images(battery_min):
    made = flown(takeoff=HOME, battery_min=battery_min, split_after="7,20-21")
    path = made.path
    taken = path.capture >= 0
    assert path.capture[taken].tolist() == list(range(len(made)))
    lasts = {int(path.capture[taken & (path.sortie == one)].max()) + 1 for one in range(path.sorties)}
    assert {7, 20, 21} <= lasts
    assert (path.sorties > 4) is (battery_min == 3.2)
    for number in range(path.sorties):
        one = path.sortie_path(number)
        assert one.kind[[0, -1]].tolist() == [TAKEOFF, LANDING]
        assert battery_min is None or path.sorties_s[number] <= 60.0 * battery_min + 1e-6


def test_a_part_that_the_battery_carries_is_no_further_split():
    alone = flown(takeoff=HOME, battery_min=60.0)
    made = flown(takeoff=HOME, battery_min=60.0, split_after="10")
    assert (alone.path.sorties, made.path.sorties) == (1, 2)
    assert "10" in made.mission.to_json()
    assert "split_after" not in alone.mission.to_json()


@pytest.mark.parametrize("text", ["0", "0,5", "100000", "5,100000"])
def test_a_split_at_an_image_that_is_not_there_is_one_clear_line(text):
    made = flown(takeoff=HOME, split_after=text)
    with pytest.raises(InvalidInput, match=f"must be from 1 to {len(made) - 1}, as the flight has") as refused:
        _ = made.path
    assert refused.value.field == "split_after"


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"split_after": "5"}, "needs a take-off point"),
        ({"split_after": "five", "takeoff": HOME}, "must be numbers of images such as 120,340"),
        ({"split_after": "1-99999", "takeoff": HOME}, "at most 999 sorties"),
    ],
)
def test_wrong_splits_are_refused(changes, words):
    with pytest.raises(InvalidInput, match=words) as refused:
        FIELD.replace(**changes)
    assert refused.value.field == "split_after"
