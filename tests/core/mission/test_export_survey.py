"""QGroundControl's survey: keys that it loads, the captures that it flies, and the rows that it lays anew."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.mission import Mission

from tests.core.mission.flights import worked_out
from tests.core.mission.qgc_loaders import loaded_plan
from tests.core.mission.qgc_survey import (
    GEOD,
    PHOTO,
    WAYPOINT,
    checked,
    footprint_m,
    photos,
    rows_anew,
    shots_anew,
)
from tests.core.mission.test_export_wpml import with_sorties

BOX = Mission(Box(47.404, 8.5, 47.4, 8.507), 100.0, overlap_along=0.7, overlap_across=0.6)
FIELD = Polygon((((8.50, 47.405), (8.508, 47.404), (8.511, 47.400), (8.503, 47.3985)),))
MISSIONS = {
    "box": BOX,
    "facing east": BOX.replace(yaw_deg=90.0),
    "no overlap": BOX.replace(overlap_along=0.0, overlap_across=0.0),
    "turned": BOX.replace(area=FIELD, row_azimuth_deg=20.0, agl_m=80.0),
    "turned west": BOX.replace(area=FIELD, row_azimuth_deg=230.0),
    "antimeridian": Mission(Box(0.01, 179.99, 0.0, -179.995), 300.0, overlap_along=0.6, overlap_across=0.6),
    "paper": BOX.replace(layout="paper"),
    "one way": BOX.replace(order="one-way"),
}


@pytest.fixture(scope="module")
def plans():
    return {name: worked_out(mission) for name, mission in MISSIONS.items()}


def exported(plan, tmp_path):
    done = write_plan(plan, tmp_path / "field.survey.plan")
    return done, [json.loads(path.read_text()) for path in done.files]


def survey_of(data):
    (survey,) = (item for item in data["mission"]["items"] if item["type"] == "ComplexItem")
    return survey


def distance_m(one, other):
    return GEOD.inv(one[1], one[0], other[1], other[0])[2]


@pytest.mark.parametrize("name", MISSIONS)
def test_what_is_flown_is_what_was_planned(tmp_path, plans, name):
    flown = plans[name]
    _, (data,) = exported(flown, tmp_path)
    items = loaded_plan(data)
    assert [item["type"] for item in items] == ["SimpleItem"] * 3 + ["ComplexItem", "SimpleItem"]
    assert [item["command"] for item in items if "command" in item] == [22, 178, 205, 20]
    transects = checked(survey_of(data))
    numbers = [item["doJumpId"] for item in (*items[:3], *transects["Items"], items[-1])]
    assert numbers == list(range(1, len(numbers) + 1))
    assert [item["command"] for item in transects["Items"]] == [WAYPOINT, PHOTO] * len(flown)
    lat, lon, height, _ = np.array(photos(transects["Items"])).T
    assert GEOD.inv(lon, lat, flown.lon_deg, flown.lat_deg)[2].max() < 1e-3
    assert height == pytest.approx(flown.agl_m, abs=1e-9)
    assert transects["CameraShots"] == len(flown)


@pytest.mark.parametrize("name", MISSIONS)
def test_overlaps_of_the_file_are_those_of_the_plan(tmp_path, plans, name):
    flown = plans[name]
    camera = checked(survey_of(exported(flown, tmp_path)[1][0]))["CameraCalc"]
    side, front = footprint_m(camera)
    along = 1.0 - camera["AdjustedFootprintFrontal"] / front
    across = 1.0 - camera["AdjustedFootprintSide"] / side
    # Whole pixels of the map, and a spacing that is some per mille off so that rows come to lie on the planned ones.
    assert along == pytest.approx(flown.overlap.median_along, abs=0.004)
    assert across == pytest.approx(flown.overlap.median_across, abs=0.01)
    assert camera["FrontalOverlap"] == pytest.approx(max(100.0 * along, 0.0), abs=0.05)
    assert camera["SideOverlap"] == pytest.approx(max(100.0 * across, 0.0), abs=0.05)


@pytest.mark.parametrize("name", ["box", "facing east", "no overlap", "antimeridian", "paper"])
def test_rows_of_a_box_laid_anew_are_the_planned_ones(tmp_path, plans, name):
    flown = plans[name]
    survey = survey_of(exported(flown, tmp_path)[1][0])
    assert len(survey["polygon"]) == 4
    shown = survey["TransectStyleComplexItem"]["VisualTransectPoints"]
    planned, anew = list(zip(shown[::2], shown[1::2])), rows_anew(survey)
    assert len(anew) == len(planned) == flown.rows
    step = survey["TransectStyleComplexItem"]["CameraCalc"]["AdjustedFootprintFrontal"]
    off = [distance_m(*ends) for pair in zip(planned, anew) for ends in zip(*pair)]
    assert max(off) < 0.05 * step + 0.5
    assert shots_anew(survey) == np.bincount(flown.row).tolist()


@pytest.mark.parametrize("name", ["turned", "turned west"])
def test_rows_of_a_polygon_laid_anew_lie_on_the_planned_ones(tmp_path, plans, name):
    flown = plans[name]
    survey = survey_of(exported(flown, tmp_path)[1][0])
    # A polygon that can be edited by hand.
    assert len(survey["polygon"]) <= 16
    anew = rows_anew(survey)
    assert len(anew) == flown.rows
    planned = np.bincount(flown.row)
    shots = np.array(shots_anew(survey))
    # No image fewer; sides that slant are straight, where the planned rows step from image to image.
    assert (shots >= planned).all()
    assert shots.sum() <= 1.1 * planned.sum() + flown.rows
    for number, (start, end) in enumerate(anew):
        captures = np.flatnonzero(flown.row == number)
        forward = GEOD.inv(start[1], start[0], end[1], end[0])[0]
        for at in captures[[0, -1]]:
            azimuth, _, length = GEOD.inv(start[1], start[0], flown.lon_deg[at], flown.lat_deg[at])
            assert abs(length * np.sin(np.radians(azimuth - forward))) < 1.0
        if len(captures) > 1:
            first, last = captures[[0, -1]]
            way = GEOD.inv(flown.lon_deg[first], flown.lat_deg[first], flown.lon_deg[last], flown.lat_deg[last])[0]
            assert np.cos(np.radians(way - forward)) > 0.999


def test_distance_releases_the_camera_along_each_row(tmp_path, plans):
    flown = replace(plans["facing east"], mission=plans["facing east"].mission.replace(trigger="distance"))
    survey = survey_of(exported(flown, tmp_path)[1][0])
    transects = checked(survey)
    assert [item["command"] for item in transects["Items"]] == [16, 206, 16, 206] * flown.rows
    lat, lon, _, _ = np.array(photos(transects["Items"])).T
    assert GEOD.inv(lon, lat, flown.lon_deg, flown.lat_deg)[2].max() < 0.05
    assert transects["HoverAndCapture"] is False


def test_hovering_stops_at_each_image(tmp_path, plans):
    flown = replace(plans["box"], mission=plans["box"].mission.replace(trigger="hover"))
    survey = survey_of(exported(flown, tmp_path)[1][0])
    transects = checked(survey)
    assert transects["HoverAndCapture"] is True
    assert {item["params"][0] for item in transects["Items"] if item["command"] == WAYPOINT} == {1.0}
    # Rows are a little shorter: QGroundControl stops at their ends and every so many metres before.
    spacing = transects["CameraCalc"]["AdjustedFootprintFrontal"]
    stops = [int(distance_m(*row) / spacing) + 2 for row in rows_anew(survey)]
    assert stops == np.bincount(flown.row).tolist()


def test_ways_there_and_back_are_outside_the_survey(tmp_path):
    plan = worked_out(BOX.replace(ground_height_m=500.0))
    count = int(np.flatnonzero(plan.row == 3)[0])
    done, both = exported(with_sorties(plan, count), tmp_path)
    assert [path.name for path in done.files] == ["field-1.survey.plan", "field-2.survey.plan"]
    for data, captures in zip(both, (count, len(plan) - count)):
        items = data["mission"]["items"]
        commands = [item.get("command", "survey") for item in items]
        # Take-off, speed, gimbal, transit and lead-in; the survey; the turn, and home.
        assert commands == [22, 178, 205, 16, 16, "survey", 16, 20]
        transects = checked(survey_of(data))
        assert transects["CameraShots"] == len(photos(transects["Items"])) == captures
        assert data["mission"]["plannedHomePosition"] == [47.39, 8.49, 430.0]
        numbers = [item["doJumpId"] for item in (*items[:5], *transects["Items"], *items[6:])]
        assert numbers == list(range(1, len(numbers) + 1))
        assert {height for _, _, height, _ in photos(transects["Items"])} == {170.0}


@pytest.mark.parametrize(
    ("mission", "said"),
    [
        (
            Mission(Points(((47.4, 8.5, 99.0), (47.4, 8.6, 99.0))), 99.0),
            "an area of one polygon without holes",
        ),
        (
            BOX.replace(area=Polygon((*FIELD.rings, ((8.505, 47.402), (8.506, 47.403), (8.507, 47.402))))),
            "an area of one polygon without holes",
        ),
        (BOX.replace(tilt_deg=20.0), "must look straight down"),
        (BOX.replace(yaw_deg=30.0), "30 deg off the direction of rows"),
    ],
    ids=["points", "hole", "tilt", "yaw"],
)
def test_what_is_no_survey_is_refused_with_what_to_do(tmp_path, mission, said):
    with pytest.raises(InvalidInput, match=said) as refused:
        exported(worked_out(mission), tmp_path)
    assert "choose the ending .plan" in str(refused.value)
    assert list(tmp_path.iterdir()) == []


def test_what_becomes_of_an_edited_survey_is_said(tmp_path, plans):
    notes = " ".join(map(str, exported(plans["one way"], tmp_path)[0].notes))
    assert "lays the rows anew" in notes
    assert "to and fro" in notes
