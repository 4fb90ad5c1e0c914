"""Entries and missions, without widgets."""

from __future__ import annotations

from dataclasses import replace

import pytest
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.form.mission_form import (
    FormError,
    drop_extras,
    mission,
    mission_state,
    replace_box,
)
from terrainav.terrainav_plugin.form.mission_form import test_shot as single_shot
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.form.text import aspect_text, degrees_text, parse_aspect, parse_number

GOOD = FormState(north="35.16", west="-89.9", south="35.115", east="-89.823")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("35.16", 35.16),
        (" \u221289.9 ", -89.9),
        ("89.9W", -89.9),
        ("35.16° N", 35.16),
        ("12° S", -12.0),
        ("35,16", 35.16),
        ("1e1", 10.0),
    ],
)
def test_numbers_as_people_type_them(text, value):
    assert parse_number(text) == value


@pytest.mark.parametrize("text", ["", "N", "north", "nan", "inf", "1 2"])
def test_what_is_no_number(text):
    with pytest.raises(ValueError):  # noqa: PT011  float's own words vary
        parse_number(text)


@pytest.mark.parametrize("ratio", [4 / 3, 1.0, 3 / 2, 5280 / 3956, 0.5625, 1.7320508075688772, 1e-3, 123.456])
def test_aspect_text_reads_back_exactly(ratio):
    assert parse_aspect(aspect_text(ratio)) == ratio


@pytest.mark.parametrize(("value", "text"), [(35.16, "35.16"), (-0.0, "0"), (100.0, "100"), (1.23456789, "1.2345679")])
def test_degrees_without_trailing_zeros(value, text):
    assert degrees_text(value) == text


def test_mission_of_a_state_and_back():
    state = replace(GOOD, agl=150.0, overlap_along=0.6, map_types=("satellite", "terrain"), folder="/somewhere/x")
    there = mission(state)
    assert there.area == Box(35.16, -89.9, 35.115, -89.823)
    assert there.flight.overlap_along == 0.6
    assert mission(mission_state(there, "/somewhere/x")) == there


def test_mission_of_a_template_and_back():
    template = "https://example.org/{z}/{x}/{y}.png"
    there = mission(replace(GOOD, source="url-template", template=f" {template} "))
    assert there.imagery.source == template
    assert mission_state(there, "").template == template


def test_every_wrong_field_is_named_at_once():
    with pytest.raises(FormError) as refused:
        mission(replace(GOOD, north="x", fov_deg=0.0, agl=-1.0, overlap_across=1.0))
    assert set(refused.value.messages) == {"north", "fov_deg", "agl", "overlap_across"}


def test_test_shot_is_one_picture_of_the_first_map_type():
    there = single_shot(replace(GOOD, north="", map_types=("roadmap", "terrain"), agl=100.0, agl_unit="ft"), 1.5, 2.5)
    assert there.kind == "single"
    assert there.imagery.map_types == ("roadmap",)
    assert there.area.poses == ((1.5, 2.5, 100.0 * 0.3048),)


@pytest.mark.parametrize("text", ["35.15, -89.9", "35.15 -89.9", "35.15N 89.9W", "35.15_-89.9"])
def test_a_take_off_is_typed_as_a_latitude_and_a_longitude(text):
    made = mission(replace(GOOD, takeoff=text, battery_min=18.0, entry="nearest"))
    assert made.route.takeoff == (35.15, -89.9)
    assert mission_state(made, "").takeoff == "35.15, -89.9"
    assert mission(mission_state(made, "")) == made


@pytest.mark.parametrize(
    ("changes", "field", "says"),
    [
        ({"takeoff": "home"}, "takeoff", "must be a latitude and a longitude"),
        ({"takeoff": "35.1"}, "takeoff", "must be a latitude and a longitude"),
        ({"takeoff": "95 10"}, "takeoff", "must be a latitude from -90 to 90"),
        ({"battery_min": 18.0}, "battery_min", "needs a take-off point"),
        ({"entry": "nearest"}, "entry", "needs a take-off point"),
    ],
)
def test_what_is_wrong_with_a_take_off_is_said_at_its_entry(changes, field, says):
    with pytest.raises(FormError) as wrong:
        mission(replace(GOOD, **changes))
    assert list(wrong.value.messages) == [field]
    assert says in wrong.value.messages[field]


def test_a_test_shot_has_no_way_to_it():
    state = replace(GOOD, takeoff="35.15, -89.9", battery_min=1.0, entry="nearest", turnaround_m=30.0)
    assert single_shot(state, 35.0, -80.0).route == type(mission(GOOD).route)()


def test_state_survives_its_settings_text():
    state = replace_box(replace(GOOD, map_types=("terrain",), agl_unit="ft"), Box(1.0, 2.0, 0.5, 3.0))
    assert FormState.from_json(state.to_json()) == state


def test_entries_beyond_the_panel_are_taken_out():
    """Fields that the panel carries along, and the seed of gusts."""
    state = replace(GOOD, seed=7, max_images=1000, mesh="rays", wind=True, wind_seed=99)
    there = mission(state)
    assert (there.imagery.seed, there.output.max_images, there.accuracy.mesh) == (7, 1000, "rays")
    assert there.wind.seed == 99
    assert mission(drop_extras(state)) == mission(replace(GOOD, wind=True))


def test_a_field_without_an_entry_says_where_it_is_wrong():
    with pytest.raises(FormError) as refused:
        mission(replace(GOOD, mesh="nets", overlap_along=1.0))
    assert set(refused.value.messages) == {"more", "overlap_along"}
    assert "mesh 'nets': must be one of auto, rays" in refused.value.messages["more"]
    assert "front overlap 100.0 %" in refused.value.messages["overlap_along"]


def test_a_limit_of_the_longest_side_is_an_entry():
    assert mission(GOOD).pixels.max_px is None
    limited = mission(GOOD).replace(max_px=700, image_px=900)
    state = mission_state(limited, "")
    assert (state.max_px, state.image_px) == (700, 900)
    assert mission(state) == limited
    assert mission_state(mission(GOOD), "").max_px is None


def test_entries_that_do_not_count_are_not_in_the_mission():
    idle = replace(GOOD, zoom=3, gsd_m_per_px=9.0, resize_width_px=7, focal_length_mm=1.0, camera_gsd=1.0)
    assert mission(idle) == mission(GOOD)


def test_mission_opens_in_the_terms_a_person_uses():
    there = mission(GOOD)
    like = replace(GOOD, agl_unit="ft", fov_mode="vertical")
    state = mission_state(there, "", like)
    assert (state.agl_unit, state.fov_mode) == ("ft", "vertical")
    assert state.fov_typed_deg == there.camera.vertical_fov_deg
    assert mission(state) == there


@pytest.mark.parametrize("text", ["", "{", "[]", '{"agl": "high", "unknown": 1}', "null"])
def test_unreadable_settings_give_the_defaults(text):
    assert FormState.from_json(text) == FormState()


def test_default_state_flies_the_default_camera():
    there = mission(GOOD)
    assert there.camera == Mission(area=there.area, agl_m=120.0).camera
