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
from qgis.PyQt.QtWidgets import QAbstractSpinBox, QApplication, QPushButton, QToolButton
from terrainav.core.geodesy.lens import LENS_FIELDS
from terrainav.terrainav_plugin.panel.dock import Dock

# Calls of Python functions that one key may cost the main thread: some milliseconds of work.
MOST_CALLS = 25_000

#: Entries of numbers without a unit, or with one beside them.
WITHOUT_UNIT = ("agl", "zoom", "turbulence", "f_number", "iso", "highest_iso", "adc_bits", *LENS_FIELDS)


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
    line = desk.dock.figures.line
    assert line.isVisibleTo(desk.dock)
    assert ">upsample</a>" in line.text()
    assert "show no finer detail" in html.unescape(desk.dock.estimates.text())
    line.linkActivated.emit("upsample")
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
    desk.show(desk.form.imagery)
    desk.form.imagery.setCollapsed(True)
    desk.show(desk.form.attitude)
    desk.form.attitude.setCollapsed(True)
    for folded in (True, False):
        desk.form.pixels.setCollapsed(folded)
    desk.dock.figures.fold.setChecked(True)
    later = fresh_dock()
    assert later.form.imagery.isCollapsed()
    assert not later.form.pixels.isCollapsed()
    assert later.figures.fold.isChecked()
    desk.show(desk.form.imagery)
    desk.form.imagery.setCollapsed(False)
    desk.dock.figures.fold.setChecked(False)
    # What an error has opened is not what the person wished for.
    desk.form.set_state(replace(desk.session.state(), yaw_deg=999.0))
    assert not desk.form.attitude.isCollapsed()
    desk.form.set_state(replace(desk.session.state(), yaw_deg=0.0))
    later = fresh_dock()
    assert later.form.attitude.isCollapsed()
    assert not later.form.imagery.isCollapsed()


@pytest.mark.parametrize("number", range(4))
def test_tab_key_goes_as_the_eye_reads_and_leaves_the_panel(desk, number):
    form, dock = desk.form, desk.dock
    form.pages.setCurrentIndex(number)
    page = form.pages.currentWidget()
    for box in form.boxes:
        if page.isAncestorOf(box):
            box.setCollapsed(False)
    desk.enter_box("35.14", "-89.87", "35.131", "-89.856")
    desk.wait_planned()
    desk.wait_steady(page.widget().height)
    QApplication.setActiveWindow(dock.window())
    dock.missions.setFocus()
    visited = [dock.missions]
    for _ in range(200):
        QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Tab)
        widget = QApplication.focusWidget()
        if widget is None or not dock.isAncestorOf(widget):
            break
        if widget is not visited[-1]:
            visited.append(widget)
    assert not dock.isAncestorOf(QApplication.focusWidget())
    assert len(visited) == len(set(map(id, visited)))
    # Every entry and button that is seen.
    entries = [one for group in form.groups for one in group.entries.values()]
    entries += [*form.edges.values(), form.source, *page.findChildren(QPushButton), *page.findChildren(QToolButton)]
    entries += [dock.preview, dock.test_shot, dock.capture, dock.export_plan, dock.figures.fold, dock.help]
    entries.append(form.pages.tabBar())
    focused = Qt.FocusPolicy.TabFocus
    entries = [one.focusProxy() or one for one in entries]
    wanted = {id(w) for w in entries if w.isVisible() and w.isEnabled() and w.focusPolicy() & focused}
    assert wanted <= set(map(id, visited))
    # And back again.
    dock.export_plan.setFocus()
    back = [dock.export_plan]
    while back[-1] is not dock.missions and len(back) < 200:
        QTest.keyClick(back[-1], Qt.Key.Key_Backtab)
        if QApplication.focusWidget() is not back[-1]:
            back.append(QApplication.focusWidget())
    assert back[::-1] == visited
    inside = [w for w in visited if page.isAncestorOf(w) and w in entries and not isinstance(w, QToolButton)]
    places = [w.mapTo(page.widget(), QPoint(0, w.height() // 2)) for w in inside]
    lines = [(round(place.y() / 8), place.x()) for place in places]
    assert lines == sorted(lines)
    for box in form.boxes:
        if page.isAncestorOf(box):
            box.setCollapsed(box in form.sections)


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
            if isinstance(widget, QAbstractSpinBox) and name not in WITHOUT_UNIT:
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
