"""The live view: a camera moved on the map or along the flight, its picture, footprint, and recordings."""

from __future__ import annotations

import math
import threading
from dataclasses import replace

import numpy as np
import pytest
from qgis.core import QgsDateTimeRange, QgsProject
from qgis.gui import QgsRubberBand, QgsVertexMarker
from qgis.PyQt.QtCore import QDateTime, QPoint, QPointF, Qt, QTimeZone
from qgis.PyQt.QtGui import QWheelEvent
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication
from terrainav.core.geodesy.projections import geodesics
from terrainav.core.imagery.opening import named_source
from terrainav.core.live.camera import LiveCamera
from terrainav.core.mission.mission import Mission
from terrainav.core.picture.heights import mission_heights
from terrainav.terrainav_plugin.live.flight import FlightPoses

from tests.plugin.test_own_crs import UTM, middle_of
from tests.plugin.test_relief import dem
from tests.plugin.test_viewer import pixels
from tests.support.tileserver import TileServer

__all__ = ["dem"]

HERE = 35.1353, -89.863


@pytest.fixture(name="live")
def opened_live(desk, ground):
    """The live view over the embedded world, opened from the toolbar and closed afterwards."""
    desk.form.set_state(replace(desk.session.state(), source="world", agl=120.0, image_px=64))
    desk.enter_small_mission()
    desk.look_at("EPSG:3857", around(HERE))
    desk.plugin.actions["live_view"].trigger()
    live = desk.session.live
    wait_shown(desk, live)
    yield live
    live.dock.follow.setChecked(False)
    live.hide()
    live.pose = None
    show_all_times(desk)


def show_all_times(desk):
    desk.canvas.setTemporalRange(QgsDateTimeRange(QDateTime(), QDateTime()))


def around(place, half_m=400.0):
    """Web Mercator rectangle about a place."""
    x = math.radians(place[1]) * 6378137.0
    y = math.asinh(math.tan(math.radians(place[0]))) * 6378137.0
    return x - half_m, y - half_m, x + half_m, y + half_m


def wait_shown(desk, live):
    """Wait for the whole picture of the newest pose."""
    desk.wait(lambda: not live.feed.busy and live.dock.picture.image is not None and live._latest.request == live.pose)
    return live._latest


def expected(live, request):
    """Picture that the core takes from a pose, as RGBA."""
    mission = live._source.mission
    source = named_source(mission.imagery.source).open()
    return LiveCamera(mission, source, mission_heights(mission)).take(request)


def shown_pixels(live):
    return pixels(live.dock.picture.image)[..., :3]


def grip(live):
    """Pixels of the camera and of its handle on the map."""
    compass = live.marks.compass
    return QPoint(round(compass.x), round(compass.y)), QPoint(*(round(at) for at in live.marks.handle))


def items(desk):
    """Marks of the camera on the map."""
    kinds = (QgsRubberBand, QgsVertexMarker)
    return [item for item in desk.canvas.scene().items() if isinstance(item, kinds) and item.isVisible()]


def wheel(desk, at, notches, modifiers=Qt.KeyboardModifier.NoModifier):
    viewport = desk.canvas.viewport()
    event = QWheelEvent(
        QPointF(at),
        QPointF(viewport.mapToGlobal(at)),
        QPoint(),
        QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton,
        modifiers,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(viewport, event)


def show_time(desk, unix_s):
    """Let the map show a second of time, as the temporal controller does."""
    begin = QDateTime.fromMSecsSinceEpoch(round(1000.0 * unix_s), QTimeZone.utc())
    desk.canvas.setTemporalRange(QgsDateTimeRange(begin, begin.addSecs(1)))


def test_the_picture_is_what_a_capture_from_the_pose_has(desk, live, screenshot):
    taken = wait_shown(desk, live)
    frame = expected(live, taken.request)
    assert np.array_equal(shown_pixels(live), frame.picture[..., :3])
    assert taken.request.up_m == pytest.approx(120.0)
    status = live.dock.status.text()
    assert f"{taken.request.lat_deg:.6f}" in status
    assert "120.0 m" in status
    for choice in frame.plan.accuracy.choices:
        assert str(choice.method.name) in status
    assert "px" in status
    assert "lower resolution" not in status
    assert desk.plugin.actions["live_view"].isChecked()
    screenshot("live-view")


def test_dragging_the_camera_moves_it_and_the_footprint_follows(desk, live):
    project = QgsProject.instance()
    project.setDirty(False)
    layers = set(project.mapLayers())
    before = live.pose
    camera, _ = grip(live)
    desk.drag(camera, camera + QPoint(60, -40))
    taken = wait_shown(desk, live)
    moved, _ = grip(live)
    assert (moved - camera - QPoint(60, -40)).manhattanLength() <= 2
    assert (live.pose.up_m, live.pose.yaw_deg) == (before.up_m, before.yaw_deg)
    # The map is conformal, and its scale holds at the equator.
    metres = desk.canvas.mapUnitsPerPixel() * math.hypot(60, 40) * math.cos(math.radians(HERE[0]))
    _, distance = geodesics(*(np.array([at]) for at in (*before[:2], *live.pose[:2])))[:2]
    assert float(np.ravel(distance)[0]) == pytest.approx(metres, rel=0.02)
    footprint = live.marks.items[0].asGeometry()
    place = live.marks.items[2].center()
    assert footprint.boundingBox().center().distance(place) < 2.0
    assert np.array_equal(shown_pixels(live), expected(live, taken.request).picture[..., :3])
    assert set(project.mapLayers()) == layers
    assert not project.isDirty()


@pytest.mark.parametrize("rotation", [0.0, 35.0])
def test_the_handle_turns_the_camera(desk, live, rotation):
    desk.canvas.setRotation(rotation)
    try:
        camera, handle = grip(live)
        # A quarter of a turn clockwise on the screen, y down.
        arm = handle - camera
        desk.drag(handle, camera + QPoint(-arm.y(), arm.x()))
        assert live.pose.yaw_deg == pytest.approx(90.0, abs=1.5)
        # The handle follows where it was dragged to.
        _, now = grip(live)
        assert (now - camera - QPoint(-arm.y(), arm.x())).manhattanLength() <= 3
        assert (live.pose.lat_deg, live.pose.lon_deg) == pytest.approx(live._home, abs=1e-9)
        wait_shown(desk, live)
    finally:
        desk.canvas.setRotation(0.0)


def test_the_wheel_turns_over_the_camera_and_zooms_elsewhere(desk, live):
    camera, _ = grip(live)
    scale = desk.canvas.scale()
    wheel(desk, camera, 2)
    assert live.pose.yaw_deg == pytest.approx(10.0)
    wheel(desk, camera, -1, Qt.KeyboardModifier.ShiftModifier)
    assert live.pose.yaw_deg == pytest.approx(9.0)
    assert desk.canvas.scale() == pytest.approx(scale)
    wheel(desk, desk.at(0.05, 0.05), 1)
    assert live.pose.yaw_deg == pytest.approx(9.0)
    assert desk.canvas.scale() < scale


def test_arrow_keys_move_and_turn_the_camera(desk, live):
    before = live.pose
    QTest.keyClick(desk.canvas, Qt.Key.Key_Up)
    assert live.pose.lat_deg > before.lat_deg
    assert live.pose.lon_deg == pytest.approx(before.lon_deg, abs=1e-7)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Right)
    assert live.pose.yaw_deg == pytest.approx(before.yaw_deg + 5.0)
    QTest.keyClick(desk.canvas, Qt.Key.Key_Escape)
    assert not live.tool.isActive()
    assert not live.dock.place.isChecked()
    # The picture stays, and the button brings the tool back.
    desk.click(live.dock.place)
    assert live.tool.isActive()


def test_entries_set_height_and_attitude(desk, live):
    for name, value in {"height": 90.0, "yaw": -30.0, "tilt": 40.0, "roll": 5.0}.items():
        live.dock.entries[name].setValue(value)
    taken = wait_shown(desk, live)
    assert taken.request[2:6] == pytest.approx((90.0, -30.0, 40.0, 5.0))
    assert taken.agl_m == pytest.approx(90.0)
    assert np.array_equal(shown_pixels(live), expected(live, taken.request).picture[..., :3])
    # Dragging leaves them.
    camera, _ = grip(live)
    desk.drag(camera, camera + QPoint(20, 20))
    assert live.dock.entries["tilt"].value() == pytest.approx(40.0)
    assert live.pose.tilt_deg == pytest.approx(40.0)


def test_the_camera_is_that_of_the_panel(desk, live):
    desk.form.set_state(replace(desk.session.state(), image_px=48, visibility_km=2.0, agl_unit="ft"))
    desk.wait(lambda: live._latest is not None and live.dock.picture.image.width() != 64 and not live.feed.busy)
    taken = wait_shown(desk, live)
    assert np.array_equal(shown_pixels(live), expected(live, taken.request).picture[..., :3])
    assert " ft" in live.dock.status.text()
    # The entry has two decimals of a foot, which changes no height.
    assert live.dock.entries["height"].number() == pytest.approx(120.0, abs=0.01)
    assert live.pose.up_m == 120.0
    assert live.dock.entries["height"].suffix() == " ft"


def test_relief_is_seen(desk, live):
    live.dock.entries["tilt"].setValue(55.0)
    desk.form.set_state(replace(desk.session.state(), elevation=("world",)))
    desk.wait(lambda: live._source is not None and live._source.mission.terrain.elevation == ("world",))
    taken = wait_shown(desk, live)
    assert not taken.is_levelled
    assert "error ≤" in live.dock.status.text()
    assert taken.agl_m == pytest.approx(120.0)
    assert np.array_equal(shown_pixels(live), expected(live, taken.request).picture[..., :3])


def test_a_wrong_entry_is_one_line_and_goes_away(desk, live):
    before = desk.session.state()
    desk.form.set_state(replace(before, aspect="wide"))
    desk.wait(live.dock.problem.isVisible)
    assert "wide" in live.dock.problem.text()
    assert "\n" not in live.dock.problem.text()
    desk.form.set_state(before)
    desk.wait(lambda: not live.dock.problem.isVisible())
    wait_shown(desk, live)


def test_only_the_newest_pose_is_taken(desk, live, monkeypatch):
    """Of poses that come while a picture is made, the last follows it, and no other."""
    gate, asked = threading.Event(), []
    take = type(live._source).take

    def slow(source, request, deadline_s, overtaken):
        asked.append((request, deadline_s))
        gate.wait(30.0)
        return take(source, request, deadline_s, overtaken)

    monkeypatch.setattr(type(live._source), "take", slow)
    for step in range(20):
        live._change(yaw_deg=float(step))
    gate.set()
    wait_shown(desk, live)
    assert [request.yaw_deg for request, _ in asked] == [0.0, 19.0]
    assert all(deadline_s is not None for _, deadline_s in asked)


def test_coarse_first_then_at_full_resolution(desk, ground):
    """Tiles that are late leave the picture coarse, which the status says, until they are here."""
    live, seen = desk.session.live, []
    with TileServer() as server:
        server.latency_s = 1.0
        desk.use_template(server.url_template)
        desk.form.set_state(replace(desk.session.state(), agl=120.0, image_px=64))
        desk.look_at("EPSG:3857", around(HERE))
        take_note = lambda taken: seen.append((taken.coarse_share, live.dock.status.text()))  # noqa: E731
        live.feed.shown.connect(take_note)
        live.open()
        wait_shown(desk, live)
        live.feed.shown.disconnect(take_note)
        (coarse, text), *_, (whole, last_text) = seen
        assert coarse == 1.0
        assert "100 % at lower resolution" in text
        assert whole == 0.0
        assert "lower resolution" not in last_text
        assert len({*map(tuple, shown_pixels(live).reshape(-1, 3).tolist())}) > 1
        live.hide()
        live.pose = None


def test_a_source_that_fails_is_one_line(desk, ground):
    live = desk.session.live
    with TileServer() as server:
        server.fail("404")
        desk.use_template(server.url_template)
        desk.form.set_state(replace(desk.session.state(), agl=120.0, image_px=64))
        desk.look_at("EPSG:3857", around(HERE))
        live.open()
        desk.wait(lambda: live.dock.problem.isVisible() and not live.feed.busy)
        assert "404" in live.dock.problem.text()
        assert "\n" not in live.dock.problem.text()
        live.hide()
        live.pose = None


def test_the_camera_follows_the_flight_in_the_time_of_the_map(desk, live):
    plan = desk.session.planned.plan
    desk.click(live.dock.follow)
    assert "temporal controller" in live.dock.problem.text()
    assert not live.tool.isActive()
    assert not live.dock.entries["tilt"].isEnabled()
    poses = FlightPoses(plan)
    at = 7
    show_time(desk, poses.start_s + round(float(plan.times_s[at]), 3))
    taken = wait_shown(desk, live)
    assert not live.dock.problem.isVisible()
    # The time of the map is to the millisecond, in which the flight passes 1 cm.
    assert taken.request.lat_deg == pytest.approx(float(plan.lat_deg[at]), abs=1e-7)
    assert taken.request.lon_deg == pytest.approx(float(plan.lon_deg[at]), abs=1e-7)
    assert taken.agl_m == pytest.approx(float(plan.agl_m[at]), abs=1e-3)
    assert live.dock.entries["height"].value() == pytest.approx(120.0, abs=0.01)
    # Half way between two captures of a row.
    half = (float(plan.times_s[at]) + float(plan.times_s[at + 1])) / 2.0
    pose = poses.at(poses.start_s + half)
    assert pose.lat_deg == pytest.approx(float(plan.lat_deg[at : at + 2].mean()), abs=1e-9)
    assert pose.lon_deg == pytest.approx(float(plan.lon_deg[at : at + 2].mean()), abs=1e-9)
    # The map's marks come along.
    show_time(desk, poses.start_s + half)
    wait_shown(desk, live)
    assert live.marks.compass is not None
    show_time(desk, poses.span_s[1] + 3600.0)
    assert "UTC" in live.dock.problem.text()
    show_all_times(desk)


def test_leaving_the_flight_stays_where_it_was(desk, dem, live):
    poses = FlightPoses(desk.session.planned.plan)
    desk.click(live.dock.follow)
    show_time(desk, poses.start_s + 5.0)
    there = wait_shown(desk, live)
    desk.click(live.dock.follow)
    show_all_times(desk)
    taken = wait_shown(desk, live)
    assert not taken.request.above_ellipsoid
    assert taken.request[:2] == there.request[:2]
    assert taken.agl_m == pytest.approx(there.agl_m, abs=1e-6)
    assert live.dock.entries["tilt"].isEnabled()


def test_a_recording_becomes_a_dataset_of_the_poses(desk, live, tmp_path):
    folder = tmp_path / "recorded"
    live.dock.folder.setFilePath(str(folder))
    live.dock.rate.setValue(10.0)
    desk.click(live.dock.record)
    assert not live.dock.follow.isEnabled()
    for yaw in (10.0, 20.0, 30.0):
        count = len(live.recording)
        live._change(yaw_deg=yaw)
        desk.wait(lambda count=count: len(live.recording) > count)
    # A camera at rest adds no pose.
    rest = desk.wait_steady(lambda: len(live.recording))
    poses = list(live.recording.poses)
    assert len(poses) == rest == 4
    assert str(rest) in live.dock.record.text()
    desk.click(live.dock.record)
    assert live.recording is None
    desk.wait((folder / "mission.json").exists)
    desk.wait_for_run()
    mission = Mission.load(folder / "mission.json")
    assert mission.area.yaws_deg == (0.0, 10.0, 20.0, 30.0)
    assert mission.area.times_s == tuple(round(pose.time_s, 3) for pose in poses)
    made = sorted(folder.rglob("*.tif")) or sorted(folder.rglob("*.jpg"))
    assert len([one for one in made if "mosaic" not in one.name and one.parent.name in mission.imagery.map_types]) == 4
    # The panel's mission and the next recording's folder.
    assert desk.session.state().folder == str(desk.folder)
    assert live.dock.folder.filePath() != str(folder)


def test_a_recording_of_the_flight_has_its_times(desk, live, tmp_path):
    plan = desk.session.planned.plan
    start_s = FlightPoses(plan).start_s
    folder = tmp_path / "flown"
    live.dock.folder.setFilePath(str(folder))
    desk.click(live.dock.follow)
    show_time(desk, start_s + 1.0)
    wait_shown(desk, live)
    desk.click(live.dock.record)
    for second in (2.0, 3.0, 2.5, 4.0):
        show_time(desk, start_s + second)
    desk.click(live.dock.record)
    desk.wait((folder / "mission.json").exists)
    desk.wait_for_run()
    mission = Mission.load(folder / "mission.json")
    # What goes back in time is left out.
    assert mission.area.times_s == tuple(start_s + second for second in (1.0, 2.0, 3.0, 4.0))
    show_all_times(desk)


def test_a_folder_with_a_mission_is_refused(desk, live, tmp_path):
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "mission.json").write_text("{}")
    live.dock.folder.setFilePath(str(tmp_path / "taken"))
    desk.click(live.dock.record)
    assert live.recording is None
    assert not live.dock.record.isChecked()
    assert "holds a mission" in live.dock.problem.text()


def test_layers_of_the_project_are_seen(desk, live, dem):
    """A raster of the project, drawn by QGIS off the main thread."""
    x, y = middle_of(UTM)
    desk.look_at(f"EPSG:{UTM[0]}", (x - 300.0, y - 300.0, x + 300.0, y + 300.0))
    live.hide()
    live.pose = None
    choose = desk.form.source
    index = next(at for at in range(choose.count()) if "Ridge" in choose.itemText(at))
    choose.setCurrentIndex(index)
    desk.form.set_state(replace(desk.session.state(), north="", west="", south="", east="", image_px=64))
    live.open()
    taken = wait_shown(desk, live)
    assert taken.coarse_share == 0.0
    assert not live.dock.problem.isVisible()
    assert shown_pixels(live).max() > shown_pixels(live).min()


def test_closing_and_a_new_project_stop_everything(desk, live):
    tool = live.tool
    assert len(items(desk)) >= 4
    live.dock.close()
    desk.wait(lambda: not desk.plugin.actions["live_view"].isChecked())
    assert not tool.isActive()
    assert not live.feed.is_open
    assert live.marks.items == []
    desk.plugin.actions["live_view"].trigger()
    wait_shown(desk, live)
    assert tool.isActive()
    desk.click(live.dock.record)
    desk.iface.newProject(False)
    desk.wait(lambda: not live.is_seen)
    assert live.recording is None
    assert live.pose is None
    assert not live.feed.is_open
    assert live.marks.items == []
