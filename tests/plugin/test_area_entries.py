"""The area in the panel: what is pasted and typed, what is said about it, and undo."""

from __future__ import annotations

from dataclasses import replace

import pytest
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.form.area import (
    FormError,
    area_of_text,
    entered_area,
    paste_coordinates,
    replace_area,
)
from terrainav.terrainav_plugin.form.mission_form import mission, mission_state
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.widgets import ShortLine

from tests.support.growth import PROPORTIONAL, growth

CONTROL, SHIFT = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.ShiftModifier
POLYGON = Polygon((((-89.9, 35.1), (-89.8, 35.1), (-89.8, 35.2), (-89.85, 35.13)),))
POINTS = Points(((10.0, 20.0, 100.0), (10.01, 20.0, 200.0)), (5.0, 6.0))
AGRICENTER = "35.16_-89.90_35.115_-89.823_150"


def edges(desk):
    return [edit.text() for edit in desk.form.edges.values()]


def stack(desk):
    return desk.form.area_editing.history.stack


# --- pasted text


@pytest.mark.parametrize(
    ("text", "area", "agl_m"),
    [
        ("35.16_-89.90_35.115_-89.823_120", Box(35.16, -89.9, 35.115, -89.823), 120.0),
        ("35.16, -89.90; 35.115, -89.823", Box(35.16, -89.9, 35.115, -89.823), None),
        ("35.1_-89.9_80", Points(((35.1, -89.9, 80.0),)), 80.0),
        ("35.1, \u221289.9", Points(((35.1, -89.9, 50.0),)), None),
        (
            "35.1 -89.9 80\n# then\n\n35.2,-89.8,90\n",
            Points(((35.1, -89.9, 80.0), (35.2, -89.8, 90.0))),
            80.0,
        ),
        ("1 2 3 -4\n5 6 7 8", Points(((1.0, 2.0, 3.0), (5.0, 6.0, 7.0)), (-4.0, 8.0)), 3.0),
        ("1 2\n3 4", Points(((1.0, 2.0, 50.0), (3.0, 4.0, 50.0))), None),
    ],
)
def test_pasted_formats(text, area, agl_m):
    assert area_of_text(text, 50.0, "m") == (area, agl_m)


def test_pasted_heights_are_in_the_unit_chosen():
    area, agl_m = area_of_text("1 2 100\n3 4 200", 50.0, "ft")
    assert [pose[2] for pose in area.poses] == pytest.approx([30.48, 60.96])
    assert agl_m == pytest.approx(30.48)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "coordinates"),
        ("1 2 3\n4 5 six", "line 2: .*six"),
        ("1 2 3\n4 5 6 7", "line 2: give every point a yaw, or none"),
        ("1 2 3 4\n4 5 6 900", "line 2: yaw 900"),
        ("1 2 3\n95 5 6", "line 2: latitude 95"),
        ("1 2 3\n\n1 2 3 4 5", "line 3: .* has 5 numbers"),
        ("1 2 3 4 5 6", "6 numbers"),
    ],
)
def test_what_cannot_be_read_is_named_with_its_line(text, words):
    with pytest.raises(InvalidInput, match=words):
        area_of_text(text, 50.0, "m")


@pytest.mark.parametrize(("begin", "repeated", "end"), [("1", "_", "x"), ("", ", ", "1"), ("", "1", " x 3 4 5")])
def test_a_text_of_any_length_is_soon_refused(begin, repeated, end):
    def read(length):
        with pytest.raises(InvalidInput):
            area_of_text(f"{begin}{repeated * length}{end}", 50.0, "m")

    # A pattern for the end of a line took minutes.
    assert growth(read, 40_000) < PROPORTIONAL


def test_lines_pasted_into_an_edge_become_points(desk):
    QApplication.clipboard().setText("35.1 -89.9 80 10\n35.12 -89.88 90 20")
    edit = desk.form.edges["south"]
    edit.setFocus()
    edit.paste()
    area = desk.wait_planned().mission.area
    assert area == Points(((35.1, -89.9, 80.0), (35.12, -89.88, 90.0)), (10.0, 20.0))
    assert edges(desk) == ["35.12", "-89.9", "35.1", "-89.88"]
    assert "2 points, 80–90 m AGL, each with its yaw" in desk.form.area.words.text()


def test_clipboard_by_the_menu(desk):
    QApplication.clipboard().setText("35.1, -89.9")
    desk.form.area.area_from.actions_by_name["paste"].trigger()
    assert desk.wait_planned().mission.area == Points(((35.1, -89.9, 120.0),))
    QApplication.clipboard().setText("nothing of the kind")
    desk.form.area.area_from.actions_by_name["paste"].trigger()
    assert any("nothing" in text for text in desk.messages())


# --- the state


@pytest.mark.parametrize("area", [POLYGON, POINTS, Box(1.0, 179.0, 0.0, -179.0)])
def test_area_of_a_state_and_back(area):
    state = replace_area(FormState(), area)
    assert entered_area(state) == area
    assert mission(FormState.from_json(state.to_json())).area == area
    assert mission_state(mission(state), "").shape == state.shape


def test_points_keep_their_heights_until_another_is_entered():
    state = mission_state(Mission(area=POINTS, agl_m=150.0), "")
    assert mission(state).area == POINTS
    assert [pose[2] for pose in mission(replace(state, agl=50.0)).area.poses] == [50.0, 50.0]
    # Feet that are shown to four decimals are the same height.
    feet = replace(state, agl=round(150.0 / 0.3048, 4), agl_unit="ft")
    assert mission(feet).area == POINTS


def test_edge_that_is_not_the_shapes_makes_a_box():
    state = replace(replace_area(FormState(), POLYGON), north="35.3")
    assert mission(state).area == Box(35.3, -89.9, 35.1, -89.8)


def test_shape_that_cannot_be_read_is_marked():
    with pytest.raises(FormError) as refused:
        mission(replace(paste_coordinates(FormState(), AGRICENTER), shape="{"))
    assert set(refused.value.messages) == {"shape"}


# --- in the panel


def test_typing_an_edge_makes_a_polygon_a_box_and_undo_brings_it_back(desk):
    desk.form.area_editing.set_area(POLYGON, "test")
    assert "Polygon, 4 corners" in desk.form.area.words.text()
    assert "make it a box" in desk.form.area.words.text()
    desk.type_text(desk.form.edges["north"], "35.3")
    assert "Box, " in desk.form.area.words.text()
    assert "undo brings the shape back" in desk.form.area.words.text()
    assert desk.wait_planned().mission.area == Box(35.3, -89.9, 35.1, -89.8)
    assert desk.form.area.undo.toolTip() == "Undo: type the northern edge (Ctrl+Z)"
    # With the field's own undo out of the way: all that was typed is one step.
    QTest.keyClick(desk.form.edges["north"], Qt.Key.Key_Z, CONTROL)
    assert desk.wait_planned().mission.area == POLYGON
    QTest.keyClick(desk.form.edges["north"], Qt.Key.Key_Z, CONTROL | SHIFT)
    assert desk.wait_planned().mission.area == Box(35.3, -89.9, 35.1, -89.8)


def test_way_back_to_a_box(desk):
    desk.form.area_editing.set_area(POLYGON, "test")
    desk.form.area.words.linkActivated.emit("box")
    assert desk.wait_planned().mission.area == POLYGON.bounds
    assert not desk.form.area.area_from.actions_by_name["box"].isEnabled()


def test_undo_gives_back_the_height_that_was_pasted_over(desk):
    desk.form.agl.setValue(80.0)
    desk.form.edges["north"].setText(AGRICENTER)
    assert desk.form.agl.value() == 150.0
    desk.click(desk.form.area.undo)
    assert desk.form.agl.value() == 80.0
    assert edges(desk) == [""] * 4
    desk.click(desk.form.area.redo)
    assert desk.form.agl.value() == 150.0
    assert edges(desk) == ["35.16", "-89.9", "35.115", "-89.823"]


def test_typing_is_one_step_for_each_field(desk):
    desk.enter_box("35.14", "-89.87", "35.131", "-89.856")
    assert stack(desk).count() == 4
    for _ in range(4):
        desk.click(desk.form.area.undo)
    assert edges(desk) == [""] * 4
    assert not desk.form.area.undo.isEnabled()
    assert desk.form.area.undo.toolTip() == "No change of the area to undo"


def test_other_entries_survive_undo(desk):
    desk.form.area_editing.set_area(POLYGON, "test")
    desk.form.agl.setValue(99.0)
    desk.click(desk.form.area.undo)
    assert desk.form.agl.value() == 99.0


def test_another_mission_begins_anew(desk):
    desk.form.area_editing.set_area(POLYGON, "test")
    assert stack(desk).canUndo()
    desk.form.set_state(mission_state(Mission(area=POINTS, agl_m=10.0), str(desk.folder)))
    assert stack(desk).count() == 0


def test_group_is_reached_by_keyboard_and_fits(desk, screenshot):
    from qgis.PyQt.QtWidgets import QScrollArea

    desk.form.area_editing.set_area(POLYGON, "test")
    area = desk.form.area
    for widget in (area.area_from, area.draw_box, area.edit, area.undo, area.redo, *area.edges.values()):
        assert widget.focusPolicy() & Qt.FocusPolicy.TabFocus
        assert widget.toolTip()
        assert widget.width() >= widget.minimumSizeHint().width()
    desk.dock.findChild(QScrollArea).ensureWidgetVisible(area)
    area.area_from.menu().popup(area.area_from.mapToGlobal(area.area_from.rect().bottomLeft()))
    screenshot("area-menu")
    area.area_from.menu().close()
    screenshot("area-group", desk.dock)


def test_of_a_long_text_its_beginning_alone_is_measured(qtbot):
    """Measuring a million characters took most of the seconds for which a paste held the window."""
    line = ShortLine(lambda text: text)
    qtbot.addWidget(line)
    line.setToolTip("an edge")
    metrics, measured = line.fontMetrics(), []

    class Counting:
        def horizontalAdvance(self, text):
            measured.append(len(text))
            return metrics.horizontalAdvance(text)

    line.fontMetrics = Counting
    line.setMaxLength(1_000_000)
    line.setText("1" * 1_000_000)
    assert max(measured) <= 10_000
    assert line.text() == "1" * 1_000_000
    assert line.toolTip() == "1" * 200 + "\nan edge"
    line.setText("1")
    assert line.toolTip() == "an edge"
