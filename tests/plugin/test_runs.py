"""Several captures in line: paused, cancelled, resumed, with failures on the map, whatever project is open."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from qgis.core import QgsApplication, QgsProject, QgsTask
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QPushButton
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.capture.run import Stage, row_text
from terrainav.terrainav_plugin.panel.runs import RunList, RunRow, RunRows

from tests.support.tileserver import TileServer

# Slow enough that something can be done in the middle of a run of a few dozen images; no test waits for it to end.
SLOW_S = 0.5


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


@pytest.fixture
def prepared(desk, server):
    """A small mission over a loopback tile server."""
    desk.enter_coarse_mission()
    desk.use_template(server.url_template)
    desk.wait_planned()
    return desk


def pictures(folder):
    return sorted((folder / "satellite").glob("*.tif"))


def press_capture(desk, folder=None):
    """Press Capture, for another folder if one is given; return the run that it makes."""
    if folder is not None:
        desk.form.folder.setFilePath(str(folder))
        desk.wait_planned()
    count = len(desk.session.runs.runs)
    desk.click(desk.dock.capture)
    desk.wait(lambda: len(desk.session.runs.runs) > count)
    return desk.session.runs.runs[-1]


def row_of(desk, run):
    return desk.session.run_panel.row(run)


def press(desk, run, action):
    """Press a button of a run's row with the mouse."""
    button = row_of(desk, run).buttons[action]
    desk.dock.run_list.listed.ensureWidgetVisible(button)
    assert button.isVisible(), action
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)


@pytest.mark.parametrize(
    ("total", "written", "text"),
    [
        (0, 0, "No images were missing."),
        (1, 0, "The image already exists."),
        (1, 1, "One image captured in 2 s."),
        (9, 0, "All 9 images already exist."),
        (1_200, 1_200, "1,200 images captured in 2 s."),
        (93, 75, "All 93 images captured: 75 now, in 2 s; 18 in earlier runs."),
    ],
)
def test_ends_are_told_in_words_that_fit_the_number(total, written, text):
    from terrainav.terrainav_plugin.capture.run import done_text

    result = SimpleNamespace(total=total, written=written, skipped=total - written, seconds=2.0)
    assert done_text(result) == text


def test_missions_wait_in_line_and_are_captured_one_after_the_other(prepared, server, screenshot):
    server.latency_s = SLOW_S
    folders = [prepared.folder.with_name(f"flight-{number}") for number in (1, 2, 3)]
    runs = [press_capture(prepared, folder) for folder in folders]
    assert [run.stage for run in runs] == [Stage.RUNNING, Stage.WAITING, Stage.WAITING]
    assert "Waiting: next" in row_of(prepared, runs[1]).text.text()
    assert "2 ahead of it" in row_of(prepared, runs[2]).text.text()
    # QGIS's own list has the one at work.
    assert QgsApplication.taskManager().countActiveTasks() == 1
    prepared.wait(lambda: len(pictures(folders[0])) >= 12)
    press(prepared, runs[0], "pause")
    prepared.wait(lambda: runs[0].progress.paused)
    screenshot("queue")
    # Cancelled while waiting: it writes nothing.
    press(prepared, runs[1], "cancel")
    assert runs[1].stage is Stage.STOPPED
    press(prepared, runs[0], "resume")
    server.latency_s = 0.0
    prepared.wait_for_run()
    assert [run.stage for run in runs] == [Stage.DONE, Stage.STOPPED, Stage.DONE]
    assert not folders[1].exists()
    assert len(pictures(folders[0])) == len(pictures(folders[2])) == runs[0].images
    groups = {g.name() for g in QgsProject.instance().layerTreeRoot().findGroups(True)}
    assert groups == {"TerrAInav: datasets of one mission", "TerrAInav: flight-1", "TerrAInav: flight-3"}
    for run in runs:
        press(prepared, run, "dismiss")
    assert prepared.session.runs.runs == []
    assert not prepared.dock.run_list.isVisible()


@pytest.mark.parametrize(("elevation", "said"), [((), "Starting…"), (("world",), "Reading heights…")])
def test_a_run_over_relief_says_that_it_reads_heights(elevation, said):
    mission = Mission(Box(35.15, -89.9, 35.14, -89.89), 100.0, elevation=elevation)
    run = SimpleNamespace(stage=Stage.RUNNING, has_ended=False, progress=None, mission=mission)
    assert row_text(run) == said


def test_the_time_left_has_that_of_the_mosaic(monkeypatch):
    """By a clock of the test: the images at their pace, the mosaic as estimated, then at its own pace."""
    from terrainav.core.capture.progress import Progress
    from terrainav.core.geodesy.mercator import PixelGrid
    from terrainav.core.mission.estimate import mosaic_s
    from terrainav.core.mission.plan import plan
    from terrainav.terrainav_plugin.capture import run as run_module
    from terrainav.terrainav_plugin.sources import MissionPlans
    from terrainav.terrainav_plugin.units import duration_text

    clock = SimpleNamespace(now_s=0.0)
    monkeypatch.setattr(run_module, "monotonic", lambda: clock.now_s)
    mission = Mission(Box(35.15, -89.9, 35.14, -89.89), 100.0, source="world", tilt_deg=20.0)
    steps = plan(mission, PixelGrid())
    run = run_module.BackgroundRun(MissionPlans(mission, {"": steps}), Path("survey"), {"": None})
    run.stage = Stage.RUNNING
    estimated_s = mosaic_s(steps, cores=os.cpu_count())
    assert estimated_s > 5.0
    run._progressed(Progress(total=100, done=50, failed=0, skipped=0, requests=0, map_type="satellite", active_s=25.0))
    assert row_text(run).endswith(f", 2.0 a second, {duration_text(25.0 + estimated_s)} left")
    run._progressed(replace(run.progress, done=100, active_s=50.0))
    assert row_text(run).endswith(f"; making the mosaic, {duration_text(estimated_s)} left")
    # A quarter of it has taken 30 s.
    clock.now_s += 30.0
    run._show_progress(100.0 * (run.task.capture_share + 0.25 * (1.0 - run.task.capture_share)))
    assert row_text(run).endswith(f"; making the mosaic, {duration_text(90.0)} left")
    run.stage = Stage.WAITING
    run.close()


def test_paused_run_asks_for_nothing_and_its_time_stands_still(prepared, server):
    server.latency_s = SLOW_S
    run = press_capture(prepared)
    (task,) = QgsApplication.taskManager().activeTasks()
    prepared.wait(lambda: run.progress is not None and run.progress.done >= 12)
    assert "a second" in row_of(prepared, run).text.text()
    press(prepared, run, "pause")
    counts = row_of(prepared, run).text.text()
    bar = row_of(prepared, run).bar.value()
    prepared.wait(lambda: run.progress.paused)
    # What was under way may end, and has its turn on a busy machine, too.
    asked, made, shown = prepared.wait_steady(
        lambda: (sum(server.requests.values()), len(pictures(run.folder)), task.progress()), rest_s=2.0
    )
    active_s = run.progress.active_s
    prepared.qtbot.wait(500)
    assert sum(server.requests.values()) == asked
    assert len(pictures(run.folder)) == made
    assert run.progress.active_s == pytest.approx(active_s)
    assert task.progress() == shown > 0.0
    # Nor do the figures count what was under way.
    assert row_of(prepared, run).text.text() == counts
    assert counts.startswith("Paused: ")
    assert row_of(prepared, run).bar.value() == bar
    press(prepared, run, "resume")
    server.latency_s = 0.0
    prepared.wait_for_run()
    assert run.stage is Stage.DONE
    assert len(pictures(run.folder)) == run.images


@pytest.mark.thorough
def test_paused_run_keeps_its_place_and_can_be_cancelled(prepared, server):
    server.latency_s = SLOW_S
    first = press_capture(prepared)
    prepared.wait(lambda: len(pictures(first.folder)) >= 3)
    press(prepared, first, "pause")
    second = press_capture(prepared, prepared.folder.with_name("second"))
    prepared.wait(lambda: first.progress.paused)
    prepared.qtbot.wait(300)
    assert second.stage is Stage.WAITING
    server.latency_s = 0.0
    press(prepared, first, "cancel")
    prepared.wait_for_run()
    assert (first.stage, second.stage) == (Stage.STOPPED, Stage.DONE)


def test_same_folder_is_not_queued_twice(prepared, server):
    server.latency_s = SLOW_S
    run = press_capture(prepared)
    prepared.click(prepared.dock.capture)
    prepared.wait(lambda: "mission is already being captured." in prepared.messages())
    # As little as by a double click.
    assert prepared.buttons_in_message_bar() == {}
    assert prepared.session.runs.runs == [run]
    prepared.form.agl.setValue(150.0)
    prepared.wait_planned()
    prepared.click(prepared.dock.capture)
    prepared.wait(lambda: any("holds another mission" in text for text in prepared.messages()))
    assert prepared.session.runs.runs == [run]
    server.latency_s = 0.0
    prepared.click(prepared.buttons_in_message_bar()["Capture into mission-2"])
    prepared.wait(lambda: len(prepared.session.runs.runs) == 2)
    prepared.wait_for_run()
    assert (prepared.folder.with_name("mission-2") / "mission.json").is_file()


def test_what_was_pressed_is_captured_whatever_is_entered_later(prepared, server):
    server.latency_s = SLOW_S
    mission = prepared.session.planned.mission
    first = press_capture(prepared)
    second = press_capture(prepared, prepared.folder.with_name("second"))
    prepared.form.agl.setValue(300.0)
    prepared.wait_planned()
    server.latency_s = 0.0
    prepared.wait_for_run()
    for run in (first, second):
        assert Mission.load(run.folder / "mission.json") == mission
        assert len(pictures(run.folder)) == run.images


@pytest.mark.thorough
def test_failed_images_come_to_the_map_while_the_run_goes_on(prepared, server, screenshot):
    planned = prepared.session.planned.plan
    server.latency_s = SLOW_S
    x, y = int(planned.windows.left_px[0]) // 256, int(planned.windows.top_px[0]) // 256
    server.fail("404", (planned.zoom, x, y))
    prepared.zoom_to_box(planned.mission.area.bounds)
    run = press_capture(prepared)
    prepared.wait(lambda: run.progress is not None and run.progress.failed)
    press(prepared, run, "pause")
    run.task._next_look_s = 0.0
    press(prepared, run, "resume")
    prepared.wait(lambda: "Failed images" in prepared.layer_names())
    assert run.under_way
    server.latency_s = 0.0
    prepared.wait_for_run()
    assert run.stage is Stage.INCOMPLETE
    prepared.canvas.waitWhileRendering()
    screenshot("failed")
    failed = set(planned.names) - {path.stem for path in pictures(run.folder)}
    assert {feature["name"] for feature in prepared.layer("Failed images").getFeatures()} == failed
    assert f"Missing: {len(failed)} of {len(planned)} images" in row_of(prepared, run).text.text()
    # Again from the row, in vain first: the layer stays.
    press(prepared, run, "capture_failed")
    prepared.wait_for_run()
    again = prepared.session.runs.runs[-1]
    assert again is not run
    assert again.result.total == len(failed)
    assert "Failed images" in prepared.layer_names()
    server.heal()
    press(prepared, again, "capture_failed")
    prepared.wait_for_run()
    assert "Failed images" not in prepared.layer_names()
    assert len(pictures(run.folder)) == len(planned)
    assert [run.stage for run in prepared.session.runs.runs] == [Stage.DONE]


def test_run_goes_on_when_its_project_is_closed(prepared, server):
    server.latency_s = SLOW_S
    run = press_capture(prepared)
    prepared.wait(lambda: len(pictures(run.folder)) >= 3)
    prepared.iface.newProject(False)
    server.latency_s = 0.0
    prepared.wait_for_run()
    assert run.stage is Stage.DONE
    assert len(pictures(run.folder)) == run.images
    # Another project is none of its business.
    assert QgsProject.instance().mapLayers() == {}
    (item,) = (one for one in prepared.iface.messageBar().items() if "Its project is closed" in one.text())
    # Its button opens the dataset.
    (button,) = (one for one in item.findChildren(QPushButton) if one.text() == "Open dataset")
    prepared.click(button)
    prepared.wait(lambda: not prepared.session.missions.busy)
    assert "Captured images" in prepared.layer_names()


def test_buttons_are_reached_by_keyboard(prepared, server):
    server.latency_s = SLOW_S
    run = press_capture(prepared)
    prepared.wait(lambda: run.progress is not None)
    row = row_of(prepared, run)
    row.buttons["pause"].setFocus()
    assert prepared.iface.mainWindow().focusWidget() is row.buttons["pause"]
    QTest.keyClick(row.buttons["pause"], Qt.Key.Key_Space)
    assert run.stage is Stage.PAUSED
    for button in row.buttons.values():
        assert button.toolTip()
        assert button.accessibleName()


def test_list_leaves_room_for_the_entries(prepared, server):
    """Many runs are scrolled; the panel still fits a small screen."""
    server.latency_s = SLOW_S
    for number in range(6):
        press_capture(prepared, prepared.folder.with_name(f"flight-{number}"))
    assert len(prepared.dock.run_list.rows) == 6
    assert prepared.dock.widget().minimumSizeHint().height() < 600
    row = prepared.dock.run_list.rows[-1]
    shown = prepared.dock.run_list.listed.viewport()
    prepared.wait(lambda: 0 <= row.mapTo(shown, QPoint(0, 0)).y() < shown.height())


@pytest.fixture
def statuses():
    """What QGIS's own list says of tasks; of one that has ended otherwise than well it tells the user."""
    seen = []
    manager = QgsApplication.taskManager()

    def note(_task, status):
        seen.append(status)

    manager.statusChanged.connect(note)
    yield seen
    manager.statusChanged.disconnect(note)


def alpha_of(desk):
    layer = desk.layer("Satellite images")
    block = layer.dataProvider().block(4, layer.extent(), layer.width(), layer.height())
    return bytes(block.data())


def test_cancelled_run_is_no_failure_shows_what_is_finished_and_is_resumed_from_its_row(prepared, server, statuses):
    server.latency_s = SLOW_S
    run = press_capture(prepared)
    prepared.wait(lambda: len(pictures(run.folder)) >= 12)
    press(prepared, run, "cancel")
    server.latency_s = 0.0
    prepared.wait_for_run()
    prepared.wait_for_tasks()
    assert run.stage is Stage.STOPPED
    assert QgsTask.TaskStatus.Terminated not in statuses
    assert statuses[-1] == QgsTask.TaskStatus.Complete
    kept = len(pictures(run.folder))
    assert 12 <= kept < run.images
    assert (run.folder / "satellite.vrt").read_text().count("<ComplexSource>") == kept
    assert 255 in alpha_of(prepared)
    assert "Resume" in prepared.buttons_in_message_bar()

    press(prepared, run, "resume")
    prepared.wait_for_run()
    (again,) = prepared.session.runs.runs
    assert again.stage is Stage.DONE
    total = run.images
    assert again.result.written == total - kept
    for text in (row_of(prepared, again).text.text(), " ".join(prepared.messages())):
        assert f"All {total} images captured: {total - kept} now, in" in text
        assert f"{kept} in earlier runs." in text
    assert (run.folder / "satellite.vrt").read_text().count("<ComplexSource>") == total


def test_second_cancel_leaves_the_mosaic_out(prepared, server, statuses, monkeypatch):
    from terrainav.core.errors import Cancelled
    from terrainav.terrainav_plugin.dataset import mosaic

    def endless(*arguments):
        progress = arguments[-1]
        while progress(0.5):
            time.sleep(0.01)
        raise Cancelled("mosaic: stopped")

    monkeypatch.setattr(mosaic, "build_overviews", endless)
    server.latency_s = SLOW_S
    run = press_capture(prepared)
    prepared.wait(lambda: len(pictures(run.folder)) >= 3)
    press(prepared, run, "cancel")
    server.latency_s = 0.0
    prepared.wait(lambda: "making the mosaic" in row_of(prepared, run).text.text())
    press(prepared, run, "cancel")
    prepared.wait_for_run()
    prepared.wait_for_tasks()
    assert run.stage is Stage.STOPPED
    assert QgsTask.TaskStatus.Terminated not in statuses
    assert not list(run.folder.glob("satellite.vrt*"))
    assert row_of(prepared, run).buttons["resume"].isVisible()


def test_mosaic_that_is_cancelled_is_not_told_as_a_finished_capture(prepared, server, monkeypatch):
    from terrainav.core.errors import Cancelled
    from terrainav.terrainav_plugin.dataset import mosaic

    def endless(*arguments):
        progress = arguments[-1]
        while progress(0.5):
            time.sleep(0.01)
        raise Cancelled("mosaic: stopped")

    monkeypatch.setattr(mosaic, "build_overviews", endless)
    run = press_capture(prepared)
    total = run.images
    prepared.wait(lambda: run.has_all_images)
    press(prepared, run, "cancel")
    prepared.wait_for_run()
    assert run.stage is Stage.STOPPED
    assert row_of(prepared, run).text.text() == f"Stopped without the mosaic, with {total} of {total} images"
    assert f"mission: stopped without the mosaic, with {total} of {total} images." in prepared.messages()


@pytest.mark.parametrize("width_px", [300, 900])
def test_text_of_a_row_is_whole_beside_or_below_its_title(prepared, server, width_px):
    """Also the longest text, a failure of a source."""
    run = press_capture(prepared)
    prepared.wait_for_run()
    row = row_of(prepared, run)
    shown = RunRow("mission")
    shown.show_actions({RunRow.ZOOM, RunRow.OPEN, RunRow.DISMISS, RunRow.CLEAN}, underway=False)
    shown.resize(width_px, 10)
    shown.show()
    for text in (row.text.text(), "All 4,060 images captured: 1,020 now, in 12 min; 3,040 in earlier runs."):
        shown.show_progress(100.0, text)
        shown.resize(width_px, shown.heightForWidth(width_px))
        prepared.wait(lambda: shown.text.height() >= shown.text.heightForWidth(shown.text.width()))
        words = shown.text
        room = words.fontMetrics().boundingRect(words.rect(), Qt.TextFlag.TextWordWrap, text)
        assert words.rect().contains(room)
    # The longer text, which has only the narrow row no room for.
    assert (words.geometry().top() >= shown.title.geometry().bottom()) is (width_px == 300)
    shown.deleteLater()


def test_buttons_stay_in_place_while_a_capture_is_under_way():
    shown = RunRow("mission")
    shown.resize(330, 10)
    shown.show()
    shown.show_actions({RunRow.CANCEL, RunRow.PAUSE})
    shown.show_progress(50.0, "34 of 68 images, 12 a second, 5 s left")
    tall_px = shown.heightForWidth(330)
    shown.show_progress(50.0, "Paused")
    shown.show_actions({RunRow.CANCEL, RunRow.RESUME})
    assert shown.heightForWidth(330) == tall_px
    shown.show_progress(100.0, "Done")
    shown.show_actions({RunRow.ZOOM}, underway=False)
    assert shown.heightForWidth(330) < tall_px
    shown.deleteLater()


def test_a_single_row_has_no_button_for_all():
    shown = RunList()
    first, second = RunRow("first"), RunRow("second")
    shown.add(first)
    assert not shown.clear.isVisibleTo(shown)
    shown.add(second)
    assert shown.clear.isVisibleTo(shown)
    assert not shown.clear.isEnabled()
    shown.remove(second)
    assert not shown.clear.isVisibleTo(shown)
    shown.deleteLater()


def test_newest_row_stays_in_sight_while_the_panel_is_laid_out(prepared):
    listed = RunRows()
    bar = listed.verticalScrollBar()
    listed.show()
    try:
        listed.add(RunRow("first"))
        listed.add(RunRow("second"))
        for height_px in (30, 200, 30):
            listed.resize(300, height_px)
            prepared.wait(lambda tall=height_px > 100: (bar.maximum() == 0) is tall)
        assert bar.value() == bar.maximum()
        # It is seen whole, although its text has two lines.
        newest = listed.rows[-1]
        newest.show_progress(50.0, "34 of 68 images, 12 a second, 5 s left, and more")
        assert listed.minimumSizeHint().height() >= newest.heightForWidth(listed.viewport().width())
        # Unless the user has scrolled away.
        bar.triggerAction(bar.SliderAction.SliderToMinimum)
        listed.resize(300, 28)
        prepared.wait(lambda: bar.maximum() > 0)
        assert bar.value() == 0
    finally:
        listed.deleteLater()


def test_run_taken_out_of_the_line_is_resumed(prepared, server):
    server.latency_s = SLOW_S
    first = press_capture(prepared)
    second = press_capture(prepared, prepared.folder.with_name("second"))
    prepared.wait(row_of(prepared, second).buttons["cancel"].isVisible)
    press(prepared, second, "cancel")
    assert second.stage is Stage.STOPPED
    press(prepared, second, "resume")
    server.latency_s = 0.0
    prepared.wait(lambda: prepared.session.runs.idle)
    assert [run.stage for run in prepared.session.runs.runs] == [Stage.DONE, Stage.DONE]
    assert len(pictures(second.folder)) == len(pictures(first.folder)) == first.images


def test_preview_is_pressed_while_it_is_to_be_seen(prepared):
    dock, action = prepared.dock, prepared.plugin.actions["preview"]
    prepared.click(dock.preview)
    prepared.wait_previewed()
    press_capture(prepared)
    prepared.wait_for_run()
    # The images are there in place of the plan.
    assert not prepared.session.preview.visible
    assert (dock.preview.isChecked(), action.isChecked()) == (False, False)
    # Ticked in the layer tree, it is up to date.
    tree = QgsProject.instance().layerTreeRoot()
    prepared.form.agl.setValue(90.0)
    prepared.wait_planned()
    images = prepared.session.planned.summary.images
    tree.findLayer(prepared.layer("Planned images")).setItemVisibilityChecked(True)
    assert (dock.preview.isChecked(), action.isChecked()) == (True, True)
    prepared.wait(lambda: prepared.layer("Planned images").featureCount() == images)
    # Hidden with its group, and shown by the button.
    prepared.group().setItemVisibilityChecked(False)
    assert not dock.preview.isChecked()
    prepared.click(dock.preview)
    prepared.wait_previewed()
    assert dock.preview.isChecked()
    for name in ("Planned images", "Flight line", "Capture centres"):
        assert tree.findLayer(prepared.layer(name)).isVisible()
    prepared.click(dock.preview)
    assert "Planned images" not in prepared.layer_names()
    assert (dock.preview.isChecked(), action.isChecked()) == (False, False)
