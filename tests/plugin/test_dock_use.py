"""The panel as a person uses it: pixels, units, folds, the Tab key, and a window that never waits."""

from __future__ import annotations

import html
import sys
import threading
from collections import Counter
from dataclasses import replace

import pytest
from qgis.core import QgsSettings
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QAbstractSpinBox, QApplication
from terrainav.terrainav_plugin.panel.dock import Dock

# Calls of Python functions that one key may cost the main thread: some milliseconds of work.
MOST_CALLS = 25_000


def type_number(spin, text):
    spin.setFocus()
    spin.selectAll()
    QTest.keyClicks(spin, text)


# --- pixels


def test_zoom_beyond_the_source_is_refused_in_words_of_the_panel_and_allowed_by_a_tick(desk):
    desk.enter_small_mission()
    desk.choose(desk.form.source, "esri-world-imagery")
    pixels = desk.form.pixels
    pixels.setCollapsed(True)
    desk.choose(pixels.entries["resolution"], "zoom")
    type_number(pixels.entries["zoom"], "19")
    desk.wait(lambda: "pixels end at zoom 17" in desk.message("zoom"))
    assert "“Allow upsampling”" in desk.message("zoom")
    assert not pixels.isCollapsed()
    QTest.keyClick(pixels.entries["upsample"], Qt.Key.Key_Space)
    planned = desk.wait_planned()
    assert planned.plan.zoom == 19
    # Enlarged pixels are said to be such, in words of the panel.
    warning = desk.dock.figures.warnings.text()
    assert "upsampled" in warning
    assert "--" not in warning


def test_upsampling_is_offered_beside_the_figures(desk):
    desk.enter_small_mission()
    desk.choose(desk.form.source, "esri-world-imagery")
    desk.form.agl.setValue(30.0)
    desk.wait_planned()
    warnings = desk.dock.figures.warnings
    assert warnings.isVisibleTo(desk.dock)
    assert "Allow upsampling" in warnings.text()
    assert "show no finer detail" in html.unescape(desk.dock.estimates.text())
    warnings.linkActivated.emit("upsample")
    assert desk.form.pixels.entries["upsample"].isChecked()
    planned = desk.wait_planned()
    assert planned.mission.pixels.upsample
    assert planned.plan.zoom > planned.plan.grid.native_zoom


def test_pictures_are_resized_and_grey(desk):
    desk.enter_small_mission()
    entries = desk.form.pixels.entries
    assert not entries["resize_width_px"].isVisibleTo(desk.form.pixels)
    for folded in (True, False):
        desk.form.pixels.setCollapsed(folded)
    assert not entries["resize_width_px"].isVisibleTo(desk.form.pixels)
    entries["resize"].setChecked(True)
    type_number(entries["resize_width_px"], "64")
    type_number(entries["resize_height_px"], "48")
    entries["resize_grey"].setChecked(True)
    assert desk.wait_planned().mission.output.img_size == (64, 48, 1)
    entries["resize"].setChecked(False)
    assert desk.wait_planned().mission.output.img_size is None


# --- lines flown


def test_lines_are_turned_crossed_and_flown_one_way(desk):
    desk.enter_small_mission()
    plain = desk.wait_planned().summary.images
    entries = desk.form.flight.entries
    type_number(entries["row_azimuth_deg"], "120")
    turned = desk.wait_planned()
    assert turned.mission.flight.row_azimuth_deg == 120.0
    # Rows are straight on the map, whose north turns a little along them.
    assert turned.plan.poses.yaw_deg == pytest.approx(30.0, abs=0.01)
    type_number(entries["row_azimuth_deg"], "90")
    entries["crosshatch"].setChecked(True)
    desk.choose(entries["order"], "one-way")
    crossed = desk.wait_planned()
    assert (crossed.mission.flight.crosshatch, crossed.mission.flight.order) == (True, "one-way")
    assert crossed.summary.images > 1.5 * plain
    type_number(entries["airspeed_m_per_s"], "7.5")
    assert desk.wait_planned().summary.flight_s > 1.5 * crossed.summary.flight_s


def test_figures_in_feet(desk):
    desk.enter_small_mission()
    assert " km" in desk.dock.estimates.text()
    desk.choose(desk.form.agl_unit, "ft")
    planned = desk.wait_planned()
    miles = planned.summary.flight_distance_m / 1609.344
    assert f"{miles:.4g} mi" in desk.dock.estimates.text()
    assert " km" not in desk.dock.estimates.text()


# --- folds, keys and the wheel


@pytest.fixture
def fresh_dock(desk):
    """Makes panels of later sessions."""
    docks = []

    def make():
        dock = Dock((), ())
        dock.form.set_state(desk.session.state())
        docks.append(dock)
        return dock

    yield make
    for dock in docks:
        dock.deleteLater()
    QgsSettings().remove("TerrAInav/folded")


def test_folds_are_remembered_as_a_person_left_them(desk, fresh_dock):
    desk.form.attitude.setCollapsed(True)
    desk.form.imagery.setCollapsed(True)
    for folded in (True, False):
        desk.form.pixels.setCollapsed(folded)
    desk.dock.figures.fold.setChecked(True)
    later = fresh_dock()
    assert later.form.imagery.isCollapsed()
    assert not later.form.pixels.isCollapsed()
    assert later.figures.fold.isChecked()
    desk.form.imagery.setCollapsed(False)
    desk.dock.figures.fold.setChecked(False)
    # What an error has opened is not what the person wished for.
    desk.form.set_state(replace(desk.session.state(), yaw_deg=999.0))
    assert not desk.form.attitude.isCollapsed()
    desk.form.set_state(replace(desk.session.state(), yaw_deg=0.0))
    later = fresh_dock()
    assert later.form.attitude.isCollapsed()
    assert not later.form.imagery.isCollapsed()


def test_tab_key_goes_as_the_eye_reads(desk):
    form = desk.form
    for box in form.boxes:
        box.setCollapsed(False)
    inside = [form.camera_group, form.flight, form.output, *form.sections]
    QApplication.setActiveWindow(desk.dock.window())
    form.camera.setFocus()
    visited = []
    for _ in range(200):
        widget = QApplication.focusWidget()
        if widget in visited or widget is None or not form.isAncestorOf(widget):
            break
        visited.append(widget)
        QTest.keyClick(widget, Qt.Key.Key_Tab)
    # Layouts settle, now that groups are open.
    QTest.qWait(50)
    entries = [w for group in inside for w in group.entries.values() if w.isVisibleTo(form) and w.isEnabled()]
    found = [w for w in visited if any(w is entry for entry in entries)]
    assert set(map(id, found)) == {id(w) for w in entries if w.focusPolicy() & Qt.FocusPolicy.TabFocus}
    places = [w.mapTo(form, QPoint(0, w.height() // 2)) for w in found]
    lines = [(round(place.y() / 8), place.x()) for place in places]
    assert lines == sorted(lines)


def test_wheel_over_an_entry_scrolls_the_panel(desk):
    from qgis.PyQt.QtCore import QPointF
    from qgis.PyQt.QtGui import QWheelEvent

    def turn(widget):
        middle = QPointF(widget.rect().center())
        event = QWheelEvent(
            middle,
            QPointF(widget.mapToGlobal(widget.rect().center())),
            QPoint(0, 0),
            QPoint(0, -120),
            Qt.MouseButton.NoButton,
            Qt.KeyboardModifier.NoModifier,
            Qt.ScrollPhase.NoScrollPhase,
            False,
        )
        QApplication.sendEvent(widget, event)

    desk.form.edges["north"].setFocus()
    before = desk.session.state()
    for widget in (desk.form.agl, desk.form.layout_choice, desk.form.fov):
        turn(widget)
    assert desk.session.state() == before
    desk.form.agl.setFocus()
    turn(desk.form.agl)
    assert desk.session.state().agl < before.agl


def test_every_number_has_its_unit_and_every_label_its_entry(desk):
    for group in desk.form.groups:
        for name, widget in group.entries.items():
            if isinstance(widget, QAbstractSpinBox) and name not in ("agl", "zoom", "turbulence"):
                assert widget.suffix().strip(), name


# --- a window that never waits


def test_planning_is_never_done_on_the_main_thread(desk, monkeypatch):
    import terrainav.core.mission.estimate as estimating
    import terrainav.core.mission.plan as planning

    threads = Counter()
    for module, name in ((planning, "plan"), (estimating, "estimate")):
        real = getattr(module, name)

        def watched(*args, real=real, name=name, **kwargs):
            threads[name, threading.current_thread() is threading.main_thread()] += 1
            return real(*args, **kwargs)

        monkeypatch.setattr(module, name, watched)
    desk.enter_small_mission()
    threads.clear()
    keys = "80.25"
    for _ in range(4):
        type_number(desk.form.agl, keys)
    desk.wait_planned()
    assert threads["plan", True] == threads["estimate", True] == 0
    # The last one wins: not every key has a plan of its own.
    assert 1 <= threads["plan", False] < 4 * len(keys)


def calls_of(act):
    """How many Python functions are called on this thread while something is done."""
    count = 0

    def count_calls(frame, event, argument):
        nonlocal count
        count += event == "call"

    sys.setprofile(count_calls)
    try:
        act()
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.thorough
def test_a_key_costs_the_main_thread_little_however_large_the_mission(desk):
    counts = {}
    for name, south in (("small", "35.131"), ("large", "34.14")):
        desk.enter_box("35.14", "-89.87", south, "-88.9")
        images = desk.wait_planned().summary.images
        entries = {
            entry: widget
            for group in desk.form.groups
            for entry, widget in group.entries.items()
            if isinstance(widget, QAbstractSpinBox)
        }
        for entry, widget in entries.items():
            number = widget.value()
            counts[name, entry] = calls_of(lambda widget=widget, number=number: widget.setValue(number + 1.0))
            widget.setValue(number)
        desk.session.planner.forget()
    assert images > 100_000
    assert max(counts.values()) < MOST_CALLS, max(counts, key=counts.get)
    assert all(counts["large", entry] < 1.5 * counts["small", entry] for entry in entries)
