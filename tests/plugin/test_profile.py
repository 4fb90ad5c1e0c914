"""The height profile beside the map: it follows the entries, and mouse and keyboard lead from it to the map."""

from __future__ import annotations

import csv
from dataclasses import replace

import numpy as np
import pytest
from qgis.core import QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsPointXY, QgsProject
from qgis.gui import QgsVertexMarker
from qgis.PyQt.QtCore import QEvent, QPoint, QPointF, Qt
from qgis.PyQt.QtGui import QImage, QKeySequence, QMouseEvent, QWheelEvent
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QFileDialog
from terrainav.core.mission.flight.path import CAPTURE
from terrainav.core.mission.profile import height_profile
from terrainav.terrainav_plugin.profile.dock import ProfileDock, line_parts
from terrainav.terrainav_plugin.profile.profiles import Profiles

from tests.plugin.test_own_crs import UTM, draw
from tests.plugin.test_relief import choose, dem, set_up

__all__ = ["dem"]


@pytest.fixture
def profiles(desk):
    """The height profile, opened from the panel and closed afterwards."""
    profiles = desk.session.profiles
    desk.click(desk.form.flight.profile)
    yield profiles
    profiles.dock.setUserVisible(False)


def wait_shown(desk, profiles):
    """Wait for the profile of what is entered."""
    desk.wait_planned()
    desk.wait(lambda: not profiles.busy and profiles.dock.chart.profile is not None and profiles.dock.chart.isEnabled())
    return profiles.dock.chart


def fly_over_ridge(desk, profiles, dem):
    set_up(desk, image_px=80)
    choose(desk, "Ridge")
    draw(desk, UTM, 100.0)
    return wait_shown(desk, profiles)


def middle_of_map(desk):
    """Longitude and latitude in the middle of the map."""
    crs = desk.canvas.mapSettings().destinationCrs()
    transform = QgsCoordinateTransform(crs, QgsCoordinateReferenceSystem("EPSG:4326"), QgsProject.instance())
    return transform.transform(desk.canvas.center())


def place(chart, at):
    """Position of a point of the profile in the chart."""
    return QPoint(round(chart.x_px(float(chart.profile.distance_m[at]))), round(chart.frame().center().y()))


def point(chart, at, held=Qt.MouseButton.NoButton):
    """Move the mouse to a position of the chart."""
    event = QMouseEvent(
        QEvent.Type.MouseMove,
        QPointF(at),
        QPointF(chart.mapToGlobal(at)),
        Qt.MouseButton.NoButton,
        held,
        Qt.KeyboardModifier.NoModifier,
    )
    QApplication.sendEvent(chart, event)


def marks(desk):
    return [item for item in desk.canvas.scene().items() if isinstance(item, QgsVertexMarker) and item.isVisible()]


def test_the_profile_is_that_of_the_plan(desk, dem, profiles, screenshot):
    chart = fly_over_ridge(desk, profiles, dem)
    expected = height_profile(desk.session.planned.plan)
    assert chart.profile.ground_m == pytest.approx(expected.ground_m)
    assert chart.profile.clearance_m == pytest.approx(expected.clearance_m)
    window = desk.iface.mainWindow()
    assert window.dockWidgetArea(profiles.dock) == Qt.DockWidgetArea.BottomDockWidgetArea
    # The window may be as low as before.
    assert profiles.dock.minimumSizeHint().height() < 150
    least = float(chart.profile.clearance_m[chart.profile.lowest])
    assert f"{least:,.1f} m" in profiles.dock.line.text()
    screenshot("profile")


def test_the_mouse_shows_figures_and_the_place_on_the_map(desk, dem, profiles):
    chart = fly_over_ridge(desk, profiles, dem)
    desk.look_at("EPSG:3857", (-20e6, -20e6, 20e6, 20e6))
    at = int(np.flatnonzero(chart.profile.kind == CAPTURE)[5])
    point(chart, place(chart, at))
    profile, shown = chart.profile, chart.at
    within_m = 1.5 * (chart.seen_m[1] - chart.seen_m[0]) / chart.frame().width()
    assert profile.distance_m[shown] == pytest.approx(profile.distance_m[at], abs=within_m)
    line = profiles.dock.line.text()
    for values in (profile.height_m, profile.ground_m, profile.clearance_m):
        assert f"{values[shown]:,.1f} m" in line
    (mark,) = marks(desk)
    transform = QgsCoordinateTransform(
        QgsCoordinateReferenceSystem("EPSG:4326"), QgsCoordinateReferenceSystem("EPSG:3857"), QgsProject.instance()
    )
    there = transform.transform(QgsPointXY(float(profile.lon_deg[shown]), float(profile.lat_deg[shown])))
    assert (mark.center().x(), mark.center().y()) == pytest.approx((there.x(), there.y()))

    # A click leads there, in the CRS of the project.
    desk.look_at(f"EPSG:{UTM[0]}", (0.0, 0.0, 2000.0, 2000.0))
    QTest.mouseClick(chart, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, place(chart, at))
    middle = middle_of_map(desk)
    clicked = chart.at
    expected = float(profile.lon_deg[clicked]), float(profile.lat_deg[clicked])
    assert (middle.x(), middle.y()) == pytest.approx(expected, abs=1e-9)

    chart.clearFocus()
    QApplication.sendEvent(chart, QEvent(QEvent.Type.Leave))
    assert chart.at == -1
    assert marks(desk) == []


def test_a_long_line_of_figures_is_wrapped_and_not_cut(desk, dem, profiles):
    chart = fly_over_ridge(desk, profiles, dem)
    dock = profiles.dock
    dock.setFloating(True)
    dock.resize(260, 300)
    desk.wait(lambda: dock.line.width() < 260)
    at = int(np.flatnonzero(chart.profile.kind == CAPTURE)[5])
    point(chart, place(chart, at))
    desk.wait(lambda: dock.line.height() >= dock.line.heightForWidth(dock.line.width()))
    high = dock.line.height()
    assert high > 1.5 * dock.line.fontMetrics().height()
    # The diagram stays where it is when the line becomes shorter.
    QApplication.sendEvent(chart, QEvent(QEvent.Type.Leave))
    QApplication.processEvents()
    assert dock.line.height() == high


def test_the_keyboard_moves_the_cursor_and_leads_to_the_map(desk, dem, profiles):
    chart = fly_over_ridge(desk, profiles, dem)
    QTest.keyClick(chart, Qt.Key.Key_Home)
    assert chart.at == 0
    QTest.keyClick(chart, Qt.Key.Key_Right)
    assert chart.at > 0
    before = chart.at
    QTest.keyClick(chart, Qt.Key.Key_PageUp)
    assert chart.profile.kind[chart.at] == CAPTURE
    assert chart.at > before
    QTest.keyClick(chart, Qt.Key.Key_Return)
    middle, at = middle_of_map(desk), chart.at
    expected = float(chart.profile.lon_deg[at]), float(chart.profile.lat_deg[at])
    assert (middle.x(), middle.y()) == pytest.approx(expected, abs=1e-9)
    QTest.keyClick(chart, Qt.Key.Key_End)
    assert chart.at == len(chart.profile) - 1
    QTest.keyClick(chart, Qt.Key.Key_Plus)
    first, last = chart.seen_m
    assert last - first == pytest.approx(chart.profile.length_m / 1.25)
    assert last == pytest.approx(chart.profile.length_m)
    QTest.keyClick(chart, Qt.Key.Key_Escape)
    assert chart.seen_m == (0.0, chart.profile.length_m)
    assert chart.focusPolicy() & Qt.FocusPolicy.TabFocus


def test_the_wheel_zooms_and_a_drag_pans_without_a_click(desk, dem, profiles):
    chart = fly_over_ridge(desk, profiles, dem)
    at = chart.frame().center()
    under_m = chart.distance_m(at.x())
    wheel = QWheelEvent(
        at,
        QPointF(chart.mapToGlobal(at.toPoint())),
        QPoint(),
        QPoint(0, 480),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(chart, wheel)
    first, last = chart.seen_m
    assert last - first == pytest.approx(chart.profile.length_m / 1.25**4)
    assert chart.distance_m(at.x()) == pytest.approx(under_m)
    chosen = []
    chart.chosen.connect(chosen.append)
    middle = at.toPoint()
    QTest.mousePress(chart, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, middle)
    point(chart, middle + QPoint(40, 0), Qt.MouseButton.LeftButton)
    QTest.mouseRelease(chart, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, middle + QPoint(40, 0))
    assert chart.seen_m[0] == pytest.approx(first - 40.0 / chart.frame().width() * (last - first))
    assert chosen == []
    QTest.mouseDClick(chart, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, middle)
    assert chart.seen_m == (0.0, chart.profile.length_m)


def test_its_menu_leads_to_the_least_clearance_and_saves(desk, dem, profiles, tmp_path, monkeypatch):
    chart = fly_over_ridge(desk, profiles, dem)
    lowest, _whole, save = profiles.dock.menu().actions()
    lowest.trigger()
    assert chart.at == chart.profile.lowest
    middle = middle_of_map(desk)
    expected = float(chart.profile.lon_deg[chart.at]), float(chart.profile.lat_deg[chart.at])
    assert (middle.x(), middle.y()) == pytest.approx(expected, abs=1e-9)
    for name, kind, written in (("a.csv", "", "a.csv"), ("b", "Image (*.png)", "b.png"), ("c", "", "c.csv")):
        chosen = str(tmp_path / name), kind
        monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_, chosen=chosen: chosen)
        save.trigger()
        assert (tmp_path / written).is_file()
        assert any(written in text for text in desk.messages())
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["ground_m"]) for row in rows] == pytest.approx(chart.profile.ground_m, abs=1e-3)
    assert not QImage(str(tmp_path / "b.png")).isNull()
    profiles.save(tmp_path / "no folder" / "a.csv")
    assert any("no folder" in text for text in desk.messages())


def test_it_says_why_there_is_no_profile(desk, profiles):
    chart = profiles.dock.chart
    desk.wait(lambda: chart._hint == "No area yet.")
    desk.enter_small_mission()
    wait_shown(desk, profiles)
    assert chart.profile.is_level
    assert "Level ground" in profiles.dock.line.text()
    assert set(chart.profile.clearance_m.tolist()) == {desk.session.planned.mission.flight.agl_m}
    # Of a new mission, the old profile is grey until there is a new one.
    desk.form.agl.setValue(200.0)
    assert not chart.isEnabled()
    wait_shown(desk, profiles)
    assert set(chart.profile.clearance_m.tolist()) == {200.0}
    desk.form.agl.setValue(-5.0)
    desk.wait_planned()
    assert chart.profile is None
    assert chart._hint
    desk.form.set_state(replace(desk.session.state(), agl=100.0, agl_unit="ft"))
    wait_shown(desk, profiles)
    assert "100.0 ft" in profiles.dock.line.text()


def test_nothing_is_worked_out_while_it_is_hidden(desk, profiles):
    profiles.dock.setUserVisible(False)
    desk.wait(lambda: not profiles.dock.isUserVisible())
    desk.enter_small_mission()
    assert not profiles.busy
    assert profiles.dock.chart.profile is None
    desk.click(desk.form.flight.profile)
    wait_shown(desk, profiles)


def test_the_button_has_a_letter_of_its_own(desk):
    button = desk.form.flight.profile
    (key,) = [key for target, key in desk.dock.letters.keys if target.part is button]
    assert QKeySequence.mnemonic(button.text()).toString() in ("", f"Alt+{key}")


def test_the_legend_names_what_is_drawn(desk):
    desk.enter_small_mission()
    profile = height_profile(desk.session.planned.plan)
    assert [text for _, text in line_parts(profile, -1, "m")][:2] == ["Flight", "Ground"]
    with_surface = replace(profile, has_surface=True, is_level=False)
    assert [key for key, _ in line_parts(with_surface, -1, "m")] == ["flight", "surface", "ground", "clearance"]
    unknown = replace(with_surface, ground_m=np.full(len(profile), np.nan))
    assert any("unknown" in text for _, text in line_parts(unknown, 0, "m"))


def test_colours_follow_the_theme(desk):
    dock = ProfileDock()
    desk.qtbot.addWidget(dock)
    light = dock.chart.colours()
    dock.line.setStyleSheet("color: #eeeeee")
    dock.line.ensurePolished()
    assert dock.chart.colours() != light


def test_unloading_removes_it(desk):
    window = desk.iface.mainWindow()
    before = window.findChildren(ProfileDock)
    desk.enter_small_mission()
    own = Profiles(desk.iface, desk.session.messages, lambda: "m")
    own.show_plan(desk.session.planned.plan)
    own.open()
    wait_shown(desk, own)
    QTest.keyClick(own.dock.chart, Qt.Key.Key_Home)
    assert len(marks(desk)) == 1
    dock = own.dock
    own.close()
    assert marks(desk) == []
    QApplication.sendPostedEvents(dock, QEvent.Type.DeferredDelete)
    assert window.findChildren(ProfileDock) == before
