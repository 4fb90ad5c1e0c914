"""What the panel hides, it does not ask for: no choice leads to an entry that is wrong and out of sight."""

from __future__ import annotations

import itertools
from dataclasses import fields, replace

import pytest
from qgis.PyQt.QtCore import QDate, QDateTime, Qt, QTime
from terrainav.terrainav_plugin.form.state import FOV_MODES, FormState

# What no mission takes, in each entry that a choice can hide.
WRONG = {
    "date": "the other day",
    "template": "no template",
    "zoom": 99,
    "gsd_m_per_px": 0.0,
    "resize_width_px": 0,
    "resize_height_px": 0,
    "focal_length_mm": 0.0,
    "sensor_width_mm": 0.0,
    "sensor_height_mm": 0.0,
    "wind_speed_m_per_s": -9.0,
    "wind_from_deg": 9999.0,
    "turbulence": -1.0,
}
DATED, UNDATED = "esri-wayback", "world"


def type_date(desk, text):
    desk.type_text(desk.form.date, text)


def test_date_is_not_asked_for_where_the_source_has_none(desk):
    desk.enter_small_mission()
    desk.choose(desk.form.source, DATED)
    type_date(desk, WRONG["date"])
    desk.wait(lambda: bool(desk.message("date")))
    assert "Fix the highlighted fields." in desk.dock.figures.warnings.text()
    desk.choose(desk.form.source, UNDATED)
    planned = desk.wait_planned()
    assert planned is not None
    assert planned.mission.imagery.date == ""
    assert desk.dock.figures.warnings.text() == ""
    # What was typed is still there for the source that takes it.
    desk.choose(desk.form.source, DATED)
    assert desk.form.date.text() == WRONG["date"]
    desk.wait(lambda: bool(desk.message("date")))


def test_capture_of_an_undated_source_follows_a_wrong_date(desk):
    desk.enter_coarse_mission()
    desk.choose(desk.form.source, DATED)
    type_date(desk, WRONG["date"])
    desk.choose(desk.form.source, UNDATED)
    desk.wait_planned()
    desk.click(desk.dock.capture)
    desk.wait(lambda: any("images captured" in text for text in desk.messages()))


# Each value of each choice, or each with each.
@pytest.mark.thorough
@pytest.mark.parametrize("step", [5, pytest.param(1, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("source", [DATED, UNDATED])
def test_nothing_hidden_is_asked_for_whatever_is_chosen(desk, source, step):
    """Every entry that is hidden may be wrong, and the mission is sound, or says at an entry in sight why not."""
    desk.enter_small_mission()
    sound = replace(desk.session.state(), zoom=16, gsd_m_per_px=2.0)
    choices = [*itertools.product(FOV_MODES, ("auto", "zoom", "gsd"), (True, False))][::step]
    seen = set()
    for mode, resolution, resize in choices:
        state = replace(sound, source=source, fov_mode=mode, resolution=resolution, resize=resize)
        if mode in ("horizontal", "vertical"):
            state = replace(state, fov_typed_deg=60.0)
        if mode == "sensor":
            state = replace(state, focal_length_mm=8.8, sensor_width_mm=13.2, sensor_height_mm=9.9)
        desk.form.set_state(state)
        hidden = set(desk.session.state().hidden)
        seen |= hidden
        off = {"wind_speed_m_per_s", "wind_from_deg", "turbulence", "template"}
        wrong = {name: WRONG[name] for name in WRONG if name in hidden | off}
        desk.form.set_state(replace(state, **wrong))
        assert desk.wait_planned() is not None, (mode, resolution, resize, desk.dock.problem.text())
        assert desk.form.marks.first_message() == ""
    known = {field.name for field in fields(FormState)}
    assert seen & known >= set(WRONG) - {"template", "wind_speed_m_per_s", "wind_from_deg", "turbulence"} - (
        {"date"} if source == DATED else set()
    )


def test_folded_groups_are_asked_for_all_the_same(desk):
    desk.enter_small_mission()
    for box in desk.form.boxes:
        box.setCollapsed(True)
    desk.form.flight.entries["row_azimuth_deg"].setValue(127.0)
    start = QDateTime(QDate(2024, 6, 21), QTime(10, 30), Qt.TimeSpec.UTC)
    desk.form.attitude.entries["start"].edit.setDateTime(start)
    mission = desk.wait_planned().mission
    assert (mission.flight.row_azimuth_deg, mission.flight.start) == (127.0, "2024-06-21T10:30:00Z")
    for box in desk.form.boxes:
        box.setCollapsed(box in desk.form.sections)


def test_what_is_said_of_an_entry_out_of_sight_stands_with_the_figures(desk):
    messages = {"date": "the date is wrong", "nowhere": "so is this"}
    assert not desk.form.date.isVisibleTo(desk.form.imagery)
    assert desk.form.marks.hidden_messages(messages) == "the date is wrong\nso is this"
    desk.choose(desk.form.source, DATED)
    assert desk.form.marks.hidden_messages(messages) == "so is this"


@pytest.mark.parametrize(
    ("source", "dated"),
    [
        ("https://tiles.example/{z}/{x}/{y}.png", False),
        ("https://tiles.example/{date}/{z}/{x}/{y}.png", True),
        ("wmts:https://maps.example/wmts#layer=ortho", True),
        ("/rasters/naip_{date}.tif", True),
        ("/rasters/naip.tif", False),
    ],
)
def test_a_date_of_a_mission_file_is_kept_where_its_source_may_have_dates(desk, source, dated):
    from terrainav.core.mission.areas.area import Box
    from terrainav.core.mission.mission import Mission
    from terrainav.terrainav_plugin.form.mission_form import mission, mission_state

    there = Mission(Box(35.16, -89.9, 35.115, -89.823), agl_m=120.0, source=source, date="2014" if dated else "")
    desk.form.set_state(mission_state(there, str(desk.folder)))
    assert desk.form.date.isVisibleTo(desk.form.imagery) == dated
    assert mission(desk.session.state()) == there
