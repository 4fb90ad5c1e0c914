"""DJI's KMZ: checked by a reader of its own, read by GDAL, and flown again to the overlaps of the plan."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.fields import field_named
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.export.wpml import _DRONES
from terrainav.core.mission.flight.path import (
    CAPTURE,
    LANDING,
    LEAD_IN,
    TAKEOFF,
    TRANSIT,
    TURNAROUND,
    FlightPath,
)
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import Route

from tests.core.mission.flights import ACROSS, ALONE, HERE, IN_WIND, worked_out
from tests.core.mission.wpml_reader import Wpml
from tests.core.mission.wpml_writers import FLY_WRITERS, PILOT_WRITERS, TEMPLATE, WAYLINES, outline

GEOD = Geod(ellps="WGS84")
SURVEY = Mission(
    Box(47.403, 8.5, 47.4, 8.506),
    100.0,
    overlap_along=0.7,
    overlap_across=0.6,
    airspeed_m_per_s=8.0,
    yaw_deg=90.0,
)
FAR = ((47.4, 8.5, 1600.0), (47.4, 8.6, 1600.0))
LIFTED = tuple((lat, lon, 99.0) for lat, lon, _ in FAR)
DRONES = tuple(field_named(Route, "drone").choices)
WRITERS = {"mavic-3e": PILOT_WRITERS, "dji-fly": FLY_WRITERS}
#: Elements that most writers for a program have and we do not: ``{(drone, file, parent): (children, reason)}``.
LEFT_OUT = {
    ("mavic-3e", TEMPLATE, "rotateYaw"): (
        "aircraftHeading aircraftPathMode",
        "each waypoint has its heading, to which the aircraft turns on the way there",
    ),
    ("mavic-3e", TEMPLATE, "waylineCoordinateSysParam"): (
        "positioningType",
        "not required: says what measured the waypoints, and ours are measured by nothing",
    ),
    ("dji-fly", WAYLINES, "gimbalEvenlyRotate"): (
        "gimbalPitchRotateAngle payloadPositionIndex",
        "DJI's reference has it turn between two waypoints; gimbalRotate, which drone-flightplan has too, turns at one",
    ),
}
#: Elements that we have and no writer for that program.
MORE = {
    ("mavic-3e", TEMPLATE, "Placemark"): (
        "gimbalPitchAngle waypointHeadingParam",
        "required where each waypoint has its own pitch and heading",
    ),
    ("mavic-3e", TEMPLATE, "waypointHeadingParam"): (
        "waypointHeadingAngle waypointHeadingMode waypointHeadingPathMode waypointPoiPoint",
        "what the others have for all waypoints at once",
    ),
    ("mavic-3e", WAYLINES, "waypointHeadingParam"): ("waypointHeadingPathMode", "required"),
    ("mavic-3e", WAYLINES, "gimbalRotate"): ("gimbalHeadingYawBase", "required"),
    ("mavic-3e", WAYLINES, "hover"): ("hoverTime", "none of the others hovers there"),
    ("dji-fly", TEMPLATE, "missionConfig"): ("globalRTHHeight takeOffSecurityHeight", "required"),
    ("dji-fly", WAYLINES, "missionConfig"): ("takeOffSecurityHeight", "required"),
}
#: Pairs that most writers have the other way round than we.
TURNED = {
    ("mavic-3e", TEMPLATE, "Placemark"): (
        "waypointTurnParam useGlobalTurnParam",
        "DJI's reference says first whether it counts",
    ),
}


def along(start, end, spacing):
    """Places every so many metres from one waypoint on, up to the next one, and their shares of the way."""
    azimuth, _, length = GEOD.inv(start.lon_deg, start.lat_deg, end.lon_deg, end.lat_deg)
    for step in range(math.floor(length / spacing) + 1):
        lon, lat, _ = GEOD.fwd(start.lon_deg, start.lat_deg, azimuth, step * spacing)
        yield lat, lon, step * spacing / length


@pytest.fixture(scope="module")
def survey():
    return worked_out(SURVEY)


def routed(plan, **changes):
    """The same captures with another drone or trigger."""
    return replace(plan, mission=plan.mission.replace(**changes))


def written(plan, tmp_path):
    return write_plan(plan, tmp_path / "field.kmz")


@pytest.mark.parametrize("drone", ["mavic-3e", "m30t", "dji-fly"])
@pytest.mark.parametrize("trigger", ["waypoint", "distance", "hover"])
def test_files_are_as_the_reference_says(tmp_path, survey, drone, trigger):
    flown = routed(survey, drone=drone, trigger=trigger)
    exported = written(flown, tmp_path)
    assert [path.name for path in exported.files] == ["field.kmz"]
    read = Wpml(exported.files[0])
    assert read.of_fly is (drone == "dji-fly")
    by_distance = trigger == "distance" and not read.of_fly
    assert len(read.marks) == (2 * flown.rows if by_distance else len(flown))
    stops = {mark.turn for mark in read.marks[1:-1]}
    passing = trigger == "waypoint" and not read.of_fly
    assert stops == {"toPointAndPassWithContinuityCurvature" if passing else "toPointAndStopWithDiscontinuityCurvature"}
    hovers = [name for mark in read.marks for group in mark.groups for name, _ in group[4] if name == "hover"]
    assert len(hovers) == (len(flown) if trigger == "hover" else 0)
    said = " ".join(map(str, exported.notes))
    assert "not flown" in said
    assert f"for the drone {field_named(Route, 'drone').choices[drone]}" in said
    assert any("by distance" in str(note) for note in exported.notes) is (trigger == "distance" and read.of_fly)
    # What the file has the drone do, and no figure counts.
    assert ("stops at each waypoint; times and sorties count these stops with the trigger hover alone" in said) is (
        trigger != "hover" and read.of_fly
    )


@pytest.mark.parametrize("name", [TEMPLATE, WAYLINES])
@pytest.mark.parametrize("drone", WRITERS)
def test_elements_are_where_other_writers_put_them(tmp_path, survey, drone, name):
    ours = {}
    for trigger in ("waypoint", "distance", "hover"):
        (path,) = write_plan(routed(survey, drone=drone, trigger=trigger), tmp_path / f"{trigger}.kmz").files
        for parent, orders in outline(path, name).items():
            ours.setdefault(parent, set()).update(orders)
    others = [writer[name] for writer in WRITERS[drone].values() if name in writer]
    most = min(2, len(others))
    left_out, more, turned = {}, {}, {}
    for parent in {*ours, *(parent for other in others for parent in other)}:
        theirs = [other[parent].split() for other in others if parent in other]
        agreed = {child for order in theirs for child in order if sum(child in one for one in theirs) >= most}
        have = {child for order in ours.get(parent, ()) for child in order}
        left_out[parent] = agreed - have
        more[parent] = have - {child for order in theirs for child in order}
        turned[parent] = set()
        for first, second in permutations(agreed & have, 2):
            votes = [order.index(first) < order.index(second) for order in theirs if {first, second} <= {*order}]
            if sum(votes) >= most and 2 * sum(votes) > len(votes):
                both = [order for order in ours[parent] if {first, second} <= {*order}]
                if any(order.index(first) > order.index(second) for order in both):
                    turned[parent] |= {first, second}
    for found, known in ((left_out, LEFT_OUT), (more, MORE), (turned, TURNED)):
        named = {key[2]: set(known[key][0].split()) for key in known if key[:2] == (drone, name)}
        assert {parent: children for parent, children in found.items() if children} == named


def test_every_drone_has_its_own_code(tmp_path, survey):
    kinds = []
    for drone in DRONES:
        write_plan(routed(survey, drone=drone), tmp_path / f"{drone}.kmz")
        kinds.append(Wpml(tmp_path / f"{drone}.kmz").kind)
    assert len(set(kinds)) == len(DRONES)
    # DJI's programs take 2 to 65,535 waypoints, though their indices would count one more.
    assert max(drone.max_waypoints for drone in _DRONES.values()) == 65_535


@pytest.mark.parametrize("mission", [HERE, ACROSS, IN_WIND], ids=["here", "antimeridian", "wind"])
def test_waypoints_are_the_nominal_captures(tmp_path, mission):
    flown = worked_out(mission)
    read = Wpml(written(flown, tmp_path).files[0])
    photos, meant = read.photos(along), flown.meant
    assert len(photos) == len(flown)
    lat, lon, height, heading, pitch = np.array(photos).T
    _, _, off = GEOD.inv(lon, lat, meant.lon_deg, meant.lat_deg)
    assert off.max() < 1e-3
    assert height == pytest.approx(meant.agl_m, abs=5e-4)
    assert (heading - meant.yaw_deg + 180.0) % 360.0 - 180.0 == pytest.approx(0.0, abs=0.005)
    assert pitch == pytest.approx(meant.tilt_deg - 90.0, abs=0.005)


@pytest.mark.parametrize(("trigger", "yaw_deg"), [("waypoint", 0.0), ("waypoint", 90.0), ("distance", 90.0)])
def test_the_file_alone_reaches_the_overlaps_of_the_plan(tmp_path, survey, trigger, yaw_deg):
    flown = routed(survey, trigger=trigger) if yaw_deg == 90.0 else worked_out(SURVEY.replace(yaw_deg=yaw_deg))
    photos = Wpml(written(flown, tmp_path).files[0]).photos(along)
    assert len(photos) == len(flown)
    wide, high = flown.mission.camera.ground_size_m(1.0)
    lat, lon, height, heading, _ = np.array(photos).T
    azimuth, _, step = GEOD.inv(lon[:-1], lat[:-1], lon[1:], lat[1:])
    # Of a leg along the heading the image's height counts, of one across it the width.
    off = np.abs(np.sin(np.radians(azimuth - heading[1:])))
    seen = np.where(off < 0.1, high, np.where(off > 0.99, wide, np.nan)) * height[1:]
    in_row = np.abs(np.sin(np.radians(azimuth))) > 0.99
    one_px = 1.0 / 480.0
    assert np.median(1.0 - step[in_row] / seen[in_row]) == pytest.approx(flown.overlap.median_along, abs=one_px)
    turns = ~in_row
    assert np.count_nonzero(turns) == flown.rows - 1
    # Rows of different lengths end at different longitudes: what is between them is their distance in latitude.
    north = step[turns] * np.abs(np.cos(np.radians(azimuth[turns])))
    across = (high if yaw_deg == 0.0 else wide) * height[1:][turns]
    assert np.median(1.0 - north / across) == pytest.approx(flown.overlap.median_across, abs=one_px)


def test_gdal_reads_both_files(tmp_path, survey):
    flown = survey
    path = written(flown, tmp_path).files[0]
    gdal, ogr = (
        pytest.importorskip(f"osgeo.{name}", reason="GDAL's Python module comes with QGIS") for name in ("gdal", "ogr")
    )
    for name in ("template.kml", "waylines.wpml"):
        held = gdal.OpenEx(f"/vsizip/{path}/wpmz/{name}", gdal.OF_VECTOR, allowed_drivers=["LIBKML", "KML"])
        assert held is not None
        places = [
            (feature.GetGeometryRef().GetY(), feature.GetGeometryRef().GetX())
            for feature in held.GetLayer(0)
            if feature.GetGeometryRef().GetGeometryType() in (ogr.wkbPoint, ogr.wkbPoint25D)
        ]
        assert places == [
            pytest.approx(place, abs=1e-9) for place in zip(flown.lat_deg.tolist(), flown.lon_deg.tolist())
        ]


def test_the_same_plan_gives_the_same_bytes(tmp_path):
    first = written(worked_out(SURVEY), tmp_path).files[0].read_bytes()
    (tmp_path / "field.kmz").unlink()
    assert written(worked_out(SURVEY), tmp_path).files[0].read_bytes() == first


def test_dji_fly_gets_parts_of_200_waypoints(tmp_path):
    flown = worked_out(SURVEY.replace(drone="dji-fly", overlap_along=0.88, overlap_across=0.75))
    exported = written(flown, tmp_path)
    files = -(-len(flown) // 200)
    assert files > 1
    assert [path.name for path in exported.files] == [f"field-{number + 1}.kmz" for number in range(files)]
    reads = [Wpml(path) for path in exported.files]
    assert max(len(read.marks) for read in reads) <= 200
    lat, lon = np.array([mark[:2] for read in reads for mark in read.marks]).T
    assert lat == pytest.approx(flown.lat_deg, abs=1e-9)
    assert lon == pytest.approx(flown.lon_deg, abs=1e-9)
    assert str(exported.notes[0]).startswith(f"{files} parts of one flight")
    # Each part sets the gimbal anew.
    assert all(read.marks[0].groups[0][4][0][0] == "gimbalRotate" for read in reads)


def test_the_gimbal_is_turned_where_its_pitch_changes(tmp_path):
    poses = ((47.4, 8.5, 80.0), (47.4, 8.501, 80.0), (47.4, 8.502, 80.0), (47.4, 8.503, 90.0))
    flown = worked_out(Mission(Points(poses, tilts_deg=(0.0, 0.0, 30.0, 30.0)), 80.0))
    read = Wpml(written(flown, tmp_path).files[0])
    turned = [[name for group in mark.groups for name, _ in group[4]] for mark in read.marks]
    assert turned == [
        ["gimbalRotate", "takePhoto"],
        ["takePhoto"],
        ["gimbalRotate", "takePhoto"],
        ["takePhoto"],
    ]
    assert [photo.pitch_deg for photo in read.photos(along)] == [-90.0, -90.0, -60.0, -60.0]
    assert [photo.height_m for photo in read.photos(along)] == [80.0, 80.0, 80.0, 90.0]


def with_sorties(plan, count):
    """A plan whose path is of two sorties with ways there and back, of the first captures."""
    meant, rows = plan.meant, plan.row
    assert rows[count] != rows[count - 1]
    lat, lon, height, kind, capture, sortie = [], [], [], [], [], []

    def add(number, what, at, up, index=-1):
        place = (47.39, 8.49) if at is None else (meant.lat_deg[at], meant.lon_deg[at])
        for values, value in zip((lat, lon, height, kind, capture, sortie), (*place, up, what, index, number)):
            values.append(value)

    for number, part in enumerate((range(count), range(count, len(plan)))):
        add(number, TAKEOFF, None, 430.0)
        add(number, TRANSIT, None, 550.0)
        add(number, LEAD_IN, part[0], 551.0)
        for at in part:
            add(number, CAPTURE, at, 500.0 + meant.agl_m[at], at)
        add(number, TURNAROUND, part[-1], 552.0)
        add(number, LANDING, None, 430.0)
    arrays = [np.array(values, np.float64) for values in (lat, lon, height)]
    numbers = np.array(capture), np.array(sortie)
    path = FlightPath(
        *arrays, np.full(len(lat), 500.0), np.array(kind, np.int8), *numbers, np.arange(len(lat)) * 5.0, 430.0
    )
    flown = replace(plan)
    flown.__dict__["path"] = path
    flown.__dict__["ground_m"] = 500.0
    return flown


def test_each_sortie_is_a_file_that_begins_and_ends_at_the_takeoff(tmp_path):
    plan = worked_out(SURVEY.replace(ground_height_m=500.0))
    count = int(np.flatnonzero(plan.row == 3)[0])
    exported = written(with_sorties(plan, count), tmp_path)
    assert [path.name for path in exported.files] == ["field-1.kmz", "field-2.kmz"]
    for path, captures in zip(exported.files, (count, len(plan) - count)):
        read = Wpml(path)
        # Transit, lead-in and turnaround; what is on the ground DJI's drones do by themselves.
        assert len(read.marks) == captures + 3
        photos = read.photos(along)
        assert len(photos) == captures
        # Heights are over the take-off, 70 m below the area.
        assert {photo.height_m for photo in photos} == {170.0}
        assert [mark.height_m for mark in read.marks[:2]] == [120.0, 121.0]
    assert "430.0 m" in " ".join(map(str, exported.notes))


@pytest.mark.parametrize(
    ("mission", "said"),
    [
        (ALONE, "DJI mission of one waypoint: takes two or more"),
        (Mission(Points(FAR), 1600.0), "must be 1500 m above the take-off or less"),
        (Mission(Points(FAR), 1600.0, drone="dji-fly"), "must be 500 m above the take-off or less"),
        (
            Mission(Points(LIFTED), 99.0, camera=Camera(160.0), tilt_deg=125.0),
            "a tilt of 120 or less",
        ),
        (SURVEY.replace(airspeed_m_per_s=0.5), "must be 1 to 15 m/s"),
    ],
    ids=["one", "high", "high for DJI Fly", "gimbal", "slow"],
)
def test_what_drones_do_not_take_is_refused(tmp_path, mission, said):
    with pytest.raises(InvalidInput, match=said):
        written(worked_out(mission), tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_faster_flight_is_cut_and_said(tmp_path):
    exported = written(worked_out(SURVEY.replace(airspeed_m_per_s=20.0)), tmp_path)
    assert any("reduced to DJI's 15 m/s" in str(note) for note in exported.notes)
    assert Wpml(exported.files[0]).text(Wpml(exported.files[0]).folder, "autoFlightSpeed") == "15.00"
