"""Whatever is typed into a field is read, or refused in words beside it: never changed in silence, never an error."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QLabel, QLineEdit
from terrainav.core.errors import InvalidInput, TerrAInavError
from terrainav.core.mission.areas.area import Box
from terrainav.terrainav_plugin.form import mission_form
from terrainav.terrainav_plugin.form.area import FormError, area_of_text
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.form.text import LATITUDE, LONGITUDE, inserted, parse_degrees
from terrainav.terrainav_plugin.widgets import spin, whole_spin

from tests.support.thinning import sampled

SEED = 32
#: Parts that texts are made of: numbers, what stands between them, and what is none.
PARTS = (
    *(
        "0",
        "-5",
        "12,5",
        "12.5",
        "47",
        "01",
        "30",
        "1e3",
        "1e308",
        "9" * 40,
        "-0",
        "1_0",
        "35.14",
        "-89.87",
        "180",
    ),
    *(
        " ",
        "_",
        ",",
        ";",
        ":",
        "°",
        "'",
        '"',
        "N",
        "W",
        "\u2212",
        "\t",
        "/",
        "x",
        "*",
        "(",
        "%",
        "{",
        "}",
        "\\",
    ),
    *(
        "abc",
        "nan",
        "inf",
        "null",
        "\u0664",
        "\U0001f681",
        "<b>",
        "{0}",
        "&",
        "\u202e",
        "not set",
        "EPSG:4326",
    ),
)
WHOLE_BOX = "35.16_-89.90_35.115_-89.823_120"


def random_texts(count):
    made = random.Random(SEED)
    return ["".join(made.choices(PARTS, k=made.randint(1, 5))) for _ in range(count)]


# --- angles


@pytest.mark.parametrize(
    ("text", "letters", "value"),
    [
        ("47 01 30 N", LATITUDE, 47.025),
        ("47 01 30", LATITUDE, 47.025),
        ("47°01'30\"N", LATITUDE, 47.025),
        ("47° 01′ 30″ N", LATITUDE, 47.025),
        ("N 47 01 30", LATITUDE, 47.025),
        ("47 1.5", LATITUDE, 47.025),
        ("47 01 30,0 S", LATITUDE, -47.025),
        ("-47 01 30", LATITUDE, -47.025),
        ("\u221247°1.5'", LATITUDE, -47.025),
        ("8 30 15 W", LONGITUDE, -8.504166666666666),
        ("179 59 60", LONGITUDE, None),
        ("47 60 30 N", LATITUDE, None),
        ("47 1.5 30 N", LATITUDE, None),
        ("-47 01 30 S", LATITUDE, None),
        ("47 01 30 E", LATITUDE, None),
        ("47 N", LONGITUDE, None),
        ("47 -1 30", LATITUDE, None),
        ("47 01 30 15", LATITUDE, None),
        ("N", LATITUDE, None),
        ("1_0", LATITUDE, None),
    ],
)
def test_degrees_minutes_and_seconds(text, letters, value):
    if value is None:
        with pytest.raises(ValueError):  # noqa: PT011  float's own words vary
            parse_degrees(text, letters)
    else:
        assert parse_degrees(text, letters) == pytest.approx(value, abs=1e-12)


def test_places_as_other_programs_write_them():
    found, _ = area_of_text("47°01'30.0\"N 8°30'15.0\"W", 120.0, "m")
    assert found.poses == ((pytest.approx(47.025), pytest.approx(-8.5041666667), 120.0),)
    box, agl_m = area_of_text("47 01 30 N, 8 30 15 E, 47 00 00 N, 8 31 00 E, 80", 120.0, "m")
    assert (box, agl_m) == (Box(47.025, 8.504166666666666, 47.0, 8.516666666666667), 80.0)
    for text in ("8 30 15 E 47 01 30 N", "47 61 30 N 8 30 15 E"):
        with pytest.raises(InvalidInput, match="each latitude stand before its longitude"):
            area_of_text(text, 120.0, "m")


@pytest.mark.parametrize("text", ["47 01 30 N, 8 30 15 E", "47.025; 8.504166666666666", "47°1'30\"N 8°30'15\"E"])
def test_take_off_in_degrees_minutes_and_seconds(text):
    assert mission_form.takeoff(FormState(takeoff=text)) == pytest.approx((47.025, 8.504166666666666))
    with pytest.raises(InvalidInput, match="must be a latitude and a longitude"):
        mission_form.takeoff(FormState(takeoff="47 01 8 30"))


@pytest.mark.parametrize(
    ("before", "now", "count"),
    [("", "35", 2), ("35", "351", 1), ("3555", "355", 0), ("35", "1", 1), ("aXb", "aYYb", 2), ("5", "5", 0)],
)
def test_how_much_has_come_at_once(before, now, count):
    assert inserted(before, now) == count


# --- the edges


def edges(desk):
    return [edit.text() for edit in desk.form.edges.values()]


def test_typing_an_angle_touches_no_other_edge(desk):
    desk.enter_small_mission()
    others = edges(desk)[1:]
    agl = desk.form.agl.value()
    edit = desk.form.edges["north"]
    edit.setFocus()
    edit.selectAll()
    for key in "35 08 30 N":
        QTest.keyClicks(edit, key)
        assert edges(desk)[1:] == others
    QTest.keyClick(edit, Qt.Key.Key_Return)
    assert edges(desk) == ["35 08 30 N", *others]
    assert desk.form.agl.value() == agl
    assert desk.wait_planned().mission.area.north_deg == 35.0 + 8.5 / 60.0
    assert desk.dock.problem.text() == ""


@pytest.mark.parametrize("end", [Qt.Key.Key_Return, Qt.Key.Key_Tab])
def test_a_box_that_is_typed_is_taken_apart_when_the_field_is_left(desk, end):
    QApplication.setActiveWindow(desk.dock.window())
    edit = desk.form.edges["west"]
    desk.type_text(edit, WHOLE_BOX)
    assert edges(desk) == ["", WHOLE_BOX, "", ""]
    assert desk.message("west") == "coordinates are read when you leave the field"
    QTest.keyClick(edit, end)
    assert edges(desk) == ["35.16", "-89.9", "35.115", "-89.823"]
    assert desk.message("west") == ""


def test_a_box_that_is_pasted_is_taken_apart_at_once(desk):
    QApplication.clipboard().setText(WHOLE_BOX)
    edit = desk.form.edges["south"]
    edit.setFocus()
    QTest.keyClick(edit, Qt.Key.Key_V, Qt.KeyboardModifier.ControlModifier)
    assert edges(desk) == ["35.16", "-89.9", "35.115", "-89.823"]


def test_what_is_wrong_with_coordinates_is_said_where_they_are(desk):
    edit = desk.form.edges["east"]
    desk.type_text(edit, "35.16_-89.90_35.115_x_120")
    QTest.keyClick(edit, Qt.Key.Key_Return)
    assert "'x' is not a number" in desk.message("east")
    assert desk.form.marks.message("north") != desk.message("east")


@pytest.mark.parametrize(
    ("entries", "field", "words"),
    [({"east": "-89.87"}, "east", "has no width"), ({"south": "35.14"}, "south", "has no height")],
)
def test_a_box_without_ground_is_refused_in_words(desk, entries, field, words):
    desk.enter_small_mission()
    for name, text in entries.items():
        desk.type_text(desk.form.edges[name], text)
    desk.wait(lambda: words in desk.message(field))
    assert desk.wait_planned() is None
    assert desk.dock.problem.text() == ""
    assert not desk.form.findChild(QLabel, "describe_area").isVisibleTo(desk.dock)


# --- numbers


@pytest.mark.parametrize(
    ("field", "text", "words"),
    sampled(
        [
            ("tilt_deg", "abc", "tilt “abc”: must be a number"),
            ("tilt_deg", "", "tilt “”: must be a number"),
            ("tilt_deg", "1e9", "tilt 1000000000.0 deg: must be from -180 to 180"),
            ("climb_m_per_s", "-5", "must be"),
            ("camera_gsd", "-5", "GSD “-5”: must be 0 or more"),
            ("overlap_along", "-5", "front overlap -5.0 %: must be at least 0 and below 100"),
            ("image_px", "-5", "image's longer side -5 px: must be 1 or more"),
            ("image_px", "640,5", "must be a whole number"),
            ("agl", "12 metres", "height above ground “12 metres”: must be a number"),
        ],
        3,
    ),
)
def test_a_text_that_is_no_number_is_said_beside_its_entry(desk, field, text, words):
    desk.enter_small_mission()
    entry = next(group.entries[field] for group in desk.form.groups if field in group.entries)
    last, read = entry.value(), desk.session.state()
    line = entry.lineEdit()
    desk.type_text(line, text)
    QTest.keyClick(line, Qt.Key.Key_Return)
    assert words in desk.message(field)
    assert desk.wait_planned() is None
    with pytest.raises(FormError):
        mission_form.mission(desk.session.state())
    # It stays, for its user to put it right, and nothing is made of it.
    assert (text or "°") in line.text() or not text
    assert FormState.from_json(desk.session.state().to_json()).unread == ()
    desk.form.set_state(read)
    assert desk.message(field) == ""
    assert entry.value() == last


def test_units_and_signs_may_be_typed_before_and_after():
    box = spin("overlap", -5.0, 100.0, 1, " %", "")
    box.setPrefix("front ")
    for keys, value in (("-5", -5.0), ("12,5 %", 12.5), ("7%", 7.0)):
        box.lineEdit().selectAll()
        QTest.keyClicks(box.lineEdit(), keys)
        assert (box.value(), box.problem()) == (value, "")
        box.interpretText()
        assert box.text() == f"front {value:g} %"


def test_a_text_that_is_hidden_or_switched_off_is_not_asked_for(desk):
    desk.enter_small_mission()
    wind = desk.form.wind
    wind.setChecked(True)
    line = wind.entries["wind_speed_m_per_s"].lineEdit()
    line.selectAll()
    QTest.keyClicks(line, "abc")
    assert "must be a number" in desk.message("wind_speed_m_per_s")
    wind.setChecked(False)
    assert desk.message("wind_speed_m_per_s") == ""
    assert desk.wait_planned() is not None


def test_whole_numbers_of_dialogs_are_not_changed_in_silence():
    box = whole_spin("connections", 1, 64, "")
    box.setValue(8)
    for text, words in (
        ("100", "must be from 1 to 64"),
        ("2,5", "whole number"),
        ("abc", "must be a number"),
    ):
        box.lineEdit().selectAll()
        QTest.keyClicks(box.lineEdit(), text)
        box.interpretText()
        assert words in box.problem()
        assert box.lineEdit().text() == text
    box.setValue(3)
    assert (box.problem(), box.value(), box.text()) == ("", 3, "3")


@pytest.mark.parametrize(
    ("field", "entries", "words"),
    [
        ("elevation", {"elevation": ("abc",)}, "abc"),
        ("surface", {"elevation": ("12",), "surface": ("nowhere.tif",)}, "nowhere.tif"),
        (
            "vertical_datum",
            {"vertical_datum": "anything"},
            "vertical datum 'anything': must be ellipsoid, EGM96",
        ),
        ("vertical_datum", {"vertical_datum": "EPSG:32616"}, "or the code of a vertical system"),
    ],
)
def test_heights_that_are_none_are_marked_beside_their_entry(desk, field, entries, words):
    desk.enter_small_mission()
    desk.form.set_state(replace(desk.session.state(), **entries))
    desk.wait(lambda: words in desk.message(field))
    assert [label.text() for _, label in desk.form.marks.fields() if label.text()] == [desk.message(field)]
    assert not desk.form.relief.isCollapsed()


# --- all fields


def lines_of(desk):
    """Fields of the panel that take text, those in spin boxes and choosers too, unfolded to be seen."""
    # Few images, so that what is planned is planned at once.
    desk.form.set_state(replace(desk.session.state(), max_images=200))
    for box in desk.form.boxes:
        box.setCollapsed(False)
    desk.form.wind.setChecked(True)
    desk.form.pixels.entries["resize"].setChecked(True)
    return [line for line in desk.form.findChildren(QLineEdit) if line.isEnabled() and not line.isReadOnly()]


def drive(desk, line, texts):
    """Put texts into a field, one after another, and return the errors that are none of ours."""
    errors, planned = [], set()

    def note(error):
        if not isinstance(error, (TerrAInavError, FormError)):
            errors.append((line.objectName(), text, repr(error)))

    begun = desk.session.state()
    desk.session.planner.refused.connect(note)
    try:
        for text in texts:
            line.setFocus()
            line.selectAll()
            line.insert(text)
            QTest.keyClick(line, Qt.Key.Key_Return)
            try:
                mission = mission_form.mission(desk.session.state()).to_json()
            except FormError:
                continue
            if mission not in planned:
                planned.add(mission)
                desk.wait_planned()
            assert "nexpected" not in desk.dock.problem.text(), (line.objectName(), text)
    finally:
        desk.session.planner.refused.disconnect(note)
    desk.form.set_state(begun)
    return errors


@pytest.mark.thorough
def test_no_text_brings_an_unexpected_error_to_a_user(desk, monkeypatch):
    # Nothing is timed beside it.
    monkeypatch.setattr(desk.session.planning, "_may_time", lambda: False)
    desk.enter_small_mission()
    lines = lines_of(desk)
    assert len(lines) > 50
    texts = random_texts(2 * len(lines))
    for number, line in enumerate(lines):
        assert drive(desk, line, texts[number :: len(lines)]) == []
    assert not [text for text in desk.messages() if "nexpected" in text]


@pytest.mark.thorough
def test_no_text_of_500_in_each_field_brings_an_unexpected_error(desk, monkeypatch):
    monkeypatch.setattr(desk.session.planning, "_may_time", lambda: False)
    desk.enter_small_mission()
    texts = random_texts(500)
    for line in lines_of(desk):
        assert drive(desk, line, texts) == []
    assert not [text for text in desk.messages() if "nexpected" in text]


def test_half_a_character_in_a_refusal_is_shown_as_a_question_mark():
    from terrainav.core.errors import InvalidInput, Message
    from terrainav.terrainav_plugin.i18n import translate

    for said in ("take-off \ud800", InvalidInput("take-off \ud800"), Message("take-off \ud800")):
        assert translate(said) == "take-off ?"
