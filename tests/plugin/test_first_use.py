"""A first mission without obstacles: what a new user does first, by real events."""

from __future__ import annotations

from dataclasses import replace

import pytest
from qgis.core import QgsProject, QgsRectangle
from qgis.gui import QgsRubberBand
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QScrollArea

from tests.plugin.steps import PATIENCE_MS, SMALL_BOX
from tests.support.thinning import sampled

ELSEWHERE = (-1_000_000.0, 5_000_000.0, -900_000.0, 5_100_000.0)


def choose_by_typing(desk, title):
    edit = desk.form.source.lineEdit()
    desk.type_text(edit, title)
    popup = desk.form.source.completer().popup()
    QTest.keyClick(popup if popup.isVisible() else edit, Qt.Key.Key_Return)
    popup.hide()
    assert desk.form.source.currentText() == title


def test_one_map_type_of_a_source_is_ticked_and_the_former_choice_comes_back(desk, screenshot):
    desk.enter_box(**SMALL_BOX)
    desk.show(desk.form.imagery)
    roadmap, satellite = desk.form.map_types["roadmap"], desk.form.map_types["satellite"]
    desk.click(desk.form.map_types["terrain"])
    choose_by_typing(desk, "OpenStreetMap")
    assert desk.session.state().map_types == ("roadmap",)
    assert desk.wait_planned() is not None
    assert desk.message("map_types") == ""
    screenshot("one-map-type", desk.dock)
    # Entering another area is no choice of map types.
    desk.type_text(desk.form.edges["north"], "35.142")
    QTest.keyClick(desk.form.edges["north"], Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert desk.session.state().map_types == ("roadmap",)
    choose_by_typing(desk, "Synthetic (offline)")
    assert desk.session.state().map_types == ("satellite", "terrain")
    # What is unticked by hand stays so, and is said.
    choose_by_typing(desk, "OpenStreetMap")
    desk.click(roadmap)
    assert desk.session.state().map_types == ()
    assert "no map type" in desk.message("map_types")
    assert not satellite.isEnabled()


def drawn(desk):
    """Bounds of what is drawn over the map, in its CRS; None for nothing."""
    bands = [item.asGeometry() for item in desk.canvas.scene().items() if isinstance(item, QgsRubberBand)]
    shapes = [shape.boundingBox() for shape in bands if not shape.isEmpty()]
    assert len(shapes) <= 1
    return shapes[0] if shapes else None


def paste(desk, text):
    QApplication.clipboard().setText(text)
    edit = desk.form.edges["west"]
    edit.setFocus()
    edit.selectAll()
    QTest.keyClick(edit, Qt.Key.Key_V, Qt.KeyboardModifier.ControlModifier)


def in_sight(desk):
    shape = drawn(desk)
    return shape is not None and desk.canvas.extent().contains(shape)


def test_typed_area_is_drawn_and_the_map_goes_there_once(desk, screenshot):
    desk.look_at("EPSG:3857", ELSEWHERE)
    others = len(desk.canvas.scene().items())
    desk.enter_box(**SMALL_BOX)
    desk.wait(lambda: in_sight(desk))
    screenshot("typed-area")
    # Another look at the map is the user's own.
    desk.canvas.setExtent(QgsRectangle(*ELSEWHERE))
    desk.type_text(desk.form.folder.lineEdit(), str(desk.folder / "other"))
    desk.qtbot.wait(700)
    assert not in_sight(desk)
    # The preview has a drawing of its own.
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    assert drawn(desk) is None
    desk.click(desk.dock.preview)
    assert in_sight(desk)
    desk.session.show_dock(False)
    assert drawn(desk) is None
    desk.session.show_dock(True)
    assert in_sight(desk)
    for edge in desk.form.edges.values():
        desk.type_text(edge, "")
    assert drawn(desk) is None
    assert len(desk.canvas.scene().items()) == others


def test_map_that_is_moved_while_typing_is_left_alone(desk):
    desk.look_at("EPSG:3857", ELSEWHERE)
    # The map goes to what was typed a while after the last key, which is never too early for the next one here.
    pause, pause_ms = desk.session.areas._pause, desk.session.areas._pause.interval()
    pause.setInterval(PATIENCE_MS)
    desk.enter_box(**SMALL_BOX)
    assert pause.isActive()
    pause.setInterval(pause_ms)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Right)
    view = desk.canvas.extent()
    desk.qtbot.wait(2 * pause_ms)
    assert desk.canvas.extent() == view
    assert view.xMinimum() > ELSEWHERE[0]


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:32616"])
def test_pasted_points_are_drawn_in_any_crs(desk, crs):
    desk.look_at(crs, {"EPSG:4326": (-10, -10, 10, 10), "EPSG:32616": (4e5, 1e6, 5e5, 1.1e6)}[crs])
    paste(desk, "35.13 -89.88 50\n35.14 -89.87 60\n")
    desk.wait(lambda: in_sight(desk))
    assert QgsProject.instance().crs().authid() == crs


def test_map_between_points_goes_to_them_and_stays_where_one_is_in_view(desk):
    desk.look_at("EPSG:4326", (-89.876, 35.134, -89.874, 35.136))
    paste(desk, "35.13 -89.88 50\n35.14 -89.87 60\n")
    desk.wait(lambda: in_sight(desk))
    desk.look_at("EPSG:4326", (-89.871, 35.1395, -89.868, 35.1425))
    view = desk.canvas.extent()
    paste(desk, "35.13 -89.88 50\n35.14 -89.87 70\n")
    desk.qtbot.wait(700)
    assert desk.canvas.extent() == view


def test_single_place_keeps_the_scale_and_a_dot_is_gone_to(desk):
    desk.look_at("EPSG:3857", ELSEWHERE)
    scale = desk.canvas.scale()
    paste(desk, "35.13_-89.88_120")
    desk.wait(lambda: in_sight(desk))
    assert desk.canvas.scale() == pytest.approx(scale)
    desk.look_at("EPSG:3857", (-2e7, -2e7, 2e7, 2e7))
    desk.enter_box(**SMALL_BOX)
    desk.wait(lambda: drawn(desk).width() > desk.canvas.extent().width() / 10.0)


def test_new_project_begins_with_an_empty_area(desk, screenshot):
    desk.enter_small_mission()
    desk.form.agl.setValue(90.0)
    desk.folder.mkdir()
    before = desk.session.state()
    desk.iface.actionNewProject().trigger()
    empty = dict.fromkeys((*SMALL_BOX, "shape"), "")
    folder = str(desk.folder.with_name("mission-2"))
    assert desk.session.state() == replace(before, folder=folder, **empty)
    desk.wait(lambda: "No area yet" in desk.dock.figures.line.text())
    assert drawn(desk) is None
    screenshot("new-project")


def test_new_project_leaves_the_mission_of_a_capture_under_way(desk):
    desk.enter_small_mission()
    before = desk.session.state()
    desk.click(desk.dock.capture)
    desk.wait(lambda: not desk.session.runs.idle)
    desk.iface.actionNewProject().trigger()
    assert desk.session.state() == before
    desk.session.runs.cancel()
    desk.wait_for_run()


def test_refusals_begin_with_their_reason_and_take_the_place_of_each_other(desk, screenshot):
    desk.click(desk.dock.preview)
    desk.click(desk.dock.capture)
    ours = [item for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    assert [item.text() for item in ours] == ["No area yet; draw a box or enter coordinates. Nothing to capture yet."]
    # A long one is cut where a part of it ends, and the log has it whole.
    paste(desk, "60_-120_-60_120_1")
    desk.wait(lambda: "the limit is" in desk.dock.problem.text())
    desk.click(desk.dock.capture)
    desk.wait(lambda: any("the limit is" in text for text in desk.messages()))
    (text,) = [item.text() for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    assert text.startswith("Mission of ")
    assert text.endswith(" …")
    assert len(text) <= 142
    assert "Details" in desk.buttons_in_message_bar()
    screenshot("refusal")


def test_ground_per_px_that_leads_near_the_ground_names_the_longer_side(desk, screenshot):
    desk.enter_box(**SMALL_BOX)
    gsd = desk.form.camera_gsd
    hint = desk.form.flight.low
    desk.show(hint)
    assert not hint.isVisible()
    type_number(gsd, "2")
    assert desk.form.agl.value() == pytest.approx(9.7, abs=0.2)
    assert hint.isVisible()
    assert "640 px" in hint.text()
    assert "9.8" in hint.text() or "9.7" in hint.text()
    assert "Image's longer side" in hint.text()
    assert desk.message("camera_gsd") == ""
    desk.dock.findChild(QScrollArea).ensureWidgetVisible(hint)
    screenshot("low", desk.dock)
    # The camera's own size in pixels leads where such a flight is.
    type_number(desk.form.camera_group.entries["image_px"], "4000")
    assert desk.form.agl.value() > 20.0
    assert not hint.isVisible()
    # Who types a low height means it.
    type_number(desk.form.agl, "5")
    assert not hint.isVisible()


def type_number(spin, text):
    spin.setFocus()
    spin.selectAll()
    QTest.keyClicks(spin, text)
    QTest.keyClick(spin, Qt.Key.Key_Tab)


@pytest.mark.parametrize(
    ("title", "agl", "words"),
    sampled(
        [
            ("OpenStreetMap", "50", "but the provider allows 250"),
            ("OpenStreetMap", "3000", "of the 250 requests that the provider allows"),
            ("swisstopo SWISSIMAGE", "20", "requests require accepting the terms"),
        ],
        2,
    ),
)
def test_limit_of_the_provider_is_compared_with_the_plan(desk, screenshot, title, agl, words):
    where = ("46.96", "7.43", "46.94", "7.46") if "swiss" in title else SMALL_BOX.values()
    desk.enter_box(*where)
    type_number(desk.form.agl, agl)
    desk.wait_planned()
    assert "Limit" not in desk.dock.estimates.text()
    choose_by_typing(desk, title)
    planned = desk.wait_planned()
    assert f"{planned.plan.requests:,}" in desk.dock.estimates.text()
    assert words in desk.dock.estimates.text()
    screenshot(f"limit-{agl}", desk.dock)
