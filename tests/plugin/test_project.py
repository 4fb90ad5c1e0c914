"""Saved projects, and the plugin's end in the middle of its work."""

from __future__ import annotations

import csv
import os
import re
import shutil
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
import qgis.utils
from qgis.core import Qgis, QgsApplication, QgsProject
from qgis.PyQt.QtCore import Qt, QTimer
from qgis.PyQt.QtTest import QTest
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.form.state import FormState

from tests.plugin.test_loading import PLUGIN, census, differences, names_of_the_plugin, settle, unloaded
from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

# From this version on the project says whether extents are read from it, for all of its layers.
WITH_EXTENTS_OF_PROJECT = 34000

__all__ = ["unloaded"]


@pytest.fixture
def captured(desk):
    """A captured mission with its preview, and a project saved beside it."""
    with TileServer() as server:
        desk.enter_coarse_mission()
        desk.use_template(server.url_template)
        desk.wait_planned()
        desk.click(desk.dock.preview)
        desk.wait_previewed()
        desk.click(desk.dock.capture)
        desk.wait(lambda: "Satellite images" in desk.layer_names())
    assert QgsProject.instance().write(str(desk.folder.parent / "project.qgz"))
    return desk


def test_saved_project_opens_in_another_place(captured, tmp_path):
    QgsProject.instance().clear()
    moved = tmp_path / "elsewhere"
    shutil.copytree(captured.folder.parent, moved, ignore=shutil.ignore_patterns("elsewhere"))
    shutil.rmtree(captured.folder)
    project = QgsProject()
    assert project.read(str(moved / "project.qgz"))
    results = {layer.name(): layer for layer in project.mapLayers().values() if layer.providerType() != "memory"}
    assert set(results) == {"Captured images", "Satellite images"}
    for layer in results.values():
        assert layer.isValid()
        assert layer.source().startswith(str(moved))


def test_reopened_project_brings_the_mission_back(captured):
    state, count = captured.session.state(), captured.layer("Planned images").featureCount()
    names = captured.layer_names()
    captured.iface.newProject(False)
    captured.form.agl.setValue(33.0)
    captured.iface.addProject(str(captured.folder.parent / "project.qgz"))
    captured.wait_previewed()
    captured.wait_planned()
    assert captured.session.state() == state
    assert captured.layer_names() == names
    assert captured.layer("Planned images").featureCount() == count
    # Its layers are hidden, as they were.
    assert not captured.dock.preview.isChecked()


@pytest.mark.thorough
def test_project_moved_with_its_dataset_knows_where_it_is(captured, tmp_path):
    moved = tmp_path / "elsewhere"
    captured.iface.newProject(False)
    shutil.copytree(captured.folder.parent, moved, ignore=shutil.ignore_patterns("elsewhere"))
    shutil.rmtree(captured.folder)
    captured.iface.addProject(str(moved / "project.qgz"))
    captured.wait_previewed()
    assert captured.session.state().folder == str(moved / "mission")
    # Going on there finds every image.
    captured.click(captured.dock.capture)
    captured.wait(lambda: any("already exist" in text for text in captured.messages()))


@pytest.fixture
def answers(monkeypatch):
    """What the user chooses in dialogs for files; set by the test."""
    from qgis.PyQt.QtWidgets import QFileDialog

    chosen = {}
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(chosen["file"]), ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(chosen["save"]), ""))
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(chosen["folder"]))
    return chosen


def choose_in_menu(desk, text):
    """Open the menu of missions with the mouse and choose an entry with it."""
    menu = desk.session.missions.menu
    picked = []

    def pick():
        actions = {action.text().replace("&", ""): action for action in menu.actions()}
        place = menu.actionGeometry(actions[text]).center()
        picked.append(actions[text].isEnabled())
        QTest.mouseClick(menu, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, place)
        menu.hide()

    QTimer.singleShot(50, pick)
    # Comes back when the menu is closed.
    QTest.mouseClick(desk.dock.missions, Qt.MouseButton.LeftButton)
    desk.wait(lambda: bool(picked))
    return picked[0]


def menu_texts(desk):
    desk.session.missions.menu.aboutToShow.emit()
    return [action.text().replace("&", "") for action in desk.session.missions.menu.actions() if action.text()]


def capture_into(desk, folder):
    desk.form.folder.setFilePath(str(folder))
    desk.wait_planned()
    desk.click(desk.dock.capture)
    desk.wait(lambda: not desk.session.runs.idle)
    desk.wait_for_run()


def test_project_holds_several_missions_and_opens_the_one_that_was_in_the_panel(desk, tmp_path):
    desk.enter_coarse_mission()
    capture_into(desk, tmp_path / "first")
    first = desk.session.state()
    desk.form.agl.setValue(200.0)
    capture_into(desk, tmp_path / "second")
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    second = desk.session.state()
    assert QgsProject.instance().write(str(tmp_path / "project.qgz"))
    desk.iface.newProject(False)
    desk.form.agl.setValue(33.0)
    desk.iface.addProject(str(tmp_path / "project.qgz"))
    desk.wait_previewed()
    assert desk.session.state() == second
    titles = {"TerrAInav: first", "TerrAInav: second"}
    assert titles <= set(menu_texts(desk))
    checked = {a.text(): a.isChecked() for a in desk.session.missions.menu.actions() if a.isCheckable()}
    assert checked == {"TerrAInav: first": False, "TerrAInav: second": True}
    # Another one of the list, with the mouse: entries and preview are its own.
    choose_in_menu(desk, "TerrAInav: first")
    assert desk.session.state() == first
    desk.wait_planned()
    desk.wait_previewed()
    groups = {group.name(): group for group in QgsProject.instance().layerTreeRoot().findGroups(True)}
    assert set(groups) == titles
    names = {title: [node.name() for node in group.findLayers()] for title, group in groups.items()}
    assert "Planned images" in names["TerrAInav: first"]
    assert names["TerrAInav: second"] == ["Captured images", "Satellite images"]


def test_mission_is_saved_as_a_file_and_opened_again(desk, tmp_path, answers):
    desk.enter_coarse_mission()
    desk.form.agl.setValue(150.0)
    state, mission = desk.session.state(), desk.wait_planned().mission
    answers["save"] = tmp_path / "survey"
    choose_in_menu(desk, "Save mission as file…")
    file = tmp_path / "survey.json"
    assert Mission.load(file) == mission
    desk.form.set_state(replace(state, skip_rows="0", split_after="3"))
    choose_in_menu(desk, "New mission")
    assert not desk.session.state().has_box
    assert desk.session.state().folder != state.folder
    # Rows and images of the earlier mission, which the new one may not have.
    assert (desk.session.state().skip_rows, desk.session.state().split_after) == ("", "")
    answers["file"] = file
    choose_in_menu(desk, "Open mission file…")
    assert desk.wait_planned().mission == mission
    assert Path(desk.session.state().folder).name == "survey"
    desk.wait_previewed()
    # And again from the recent ones.
    desk.form.agl.setValue(99.0)
    menu_texts(desk)
    (recent,) = (a.menu() for a in desk.session.missions.menu.actions() if a.menu() is not None)
    assert recent.actions()[0].text() == str(file)
    recent.actions()[0].trigger()
    assert desk.wait_planned().mission == mission


def test_a_mission_that_was_not_captured_is_a_click_away_after_a_new_one(desk):
    desk.enter_coarse_mission()
    state, mission = desk.session.state(), desk.wait_planned().mission
    choose_in_menu(desk, "New mission")
    assert desk.messages() == ["mission was not captured."]
    desk.click(desk.buttons_in_message_bar()["Back to mission"])
    assert desk.wait_planned().mission == mission
    assert desk.session.state() == state
    # Nothing is lost of one without an area.
    desk.iface.messageBar().clearWidgets()
    desk.form.set_state(FormState(folder=str(desk.folder)))
    choose_in_menu(desk, "New mission")
    assert desk.messages() == []


@pytest.mark.parametrize(
    "text",
    sampled(
        [
            *("", "{", "[]", "null", "[" * 200_000, "\x00\x01"),
            *('{"schema": 99}', '{"schema": 1, "area": ["x"], "flight": {"agl_m": 1}}'),
            '{"schema": 1, "area": {"type": "box"}, "flight": {"agl_m": -4}}',
            '{"schema": 1, "area": {"type": "points", "poses": [[1]]}, "flight": {"agl_m": 4}}',
        ],
        4,
    ),
)
def test_broken_mission_file_is_one_line_and_changes_nothing(desk, tmp_path, answers, text):
    desk.enter_coarse_mission()
    before = desk.session.state()
    answers["file"] = tmp_path / "broken.json"
    answers["file"].write_text(text)
    choose_in_menu(desk, "Open mission file…")
    ours = [item.text() for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    assert len(ours) == 1
    assert "broken.json was not opened: " in ours[0]
    assert "\n" not in ours[0]
    assert desk.session.state() == before


def test_folder_that_is_no_dataset_is_one_line(desk, tmp_path, answers):
    before = desk.session.state()
    answers["folder"] = tmp_path
    choose_in_menu(desk, "Open dataset folder…")
    assert any("so it is not a dataset" in text for text in desk.messages())
    assert desk.session.state() == before
    assert QgsProject.instance().mapLayers() == {}


def test_dataset_of_the_command_comes_with_mosaic_footprints_and_failures(desk, tmp_path, answers):
    """Captured by the core alone; one image has failed."""
    from terrainav.core.capture.runner import capture
    from terrainav.core.imagery.opening import open_source

    folder = tmp_path / "by-command"
    with TileServer() as server:
        desk.enter_coarse_mission()
        desk.use_template(server.url_template)
        planned = desk.wait_planned()
        plan = planned.plan
        x, y = int(plan.windows.left_px[0]) // 256, int(plan.windows.top_px[0]) // 256
        server.fail("404", (plan.zoom, x, y))
        with closing(open_source(server.url_template)) as source:
            result = capture(plan, source, folder)
    assert result.failed
    desk.form.set_state(type(desk.session.state())(folder=str(desk.folder)))
    answers["folder"] = folder
    choose_in_menu(desk, "Open dataset folder…")
    desk.wait(lambda: not desk.session.missions.busy)
    assert desk.layer_names() == ["Failed images", "Captured images", "Satellite images"]
    assert desk.layer("Captured images").featureCount() == len(plan)
    assert desk.layer("Satellite images").isValid()
    assert {f["name"] for f in desk.layer("Failed images").getFeatures()} == {f.name for f in result.failed}
    assert desk.session.state().folder == str(folder)
    assert desk.wait_planned().mission == planned.mission
    # Once more changes nothing: the layers are there.
    ids = {layer.id() for layer in QgsProject.instance().mapLayers().values() if layer.name() != "Failed images"}
    choose_in_menu(desk, "Open dataset folder…")
    desk.wait(lambda: not desk.session.missions.busy)
    assert ids <= set(QgsProject.instance().mapLayers())


@pytest.mark.thorough
@pytest.mark.parametrize("name", sampled(["a|b", "50% & 'more' #1; ünï", "[x] {y}?z"], 3))
def test_folders_may_have_any_name(desk, tmp_path, name):
    """Layers, the saved project and the viewer find what is in them."""
    folder = tmp_path / name / "mission"
    desk.enter_coarse_mission()
    capture_into(desk, folder)
    plan = desk.wait_planned().plan
    assert QgsProject.instance().write(str(tmp_path / "project.qgz"))
    desk.iface.newProject(False)
    desk.form.set_state(type(desk.session.state())())
    desk.iface.addProject(str(tmp_path / "project.qgz"))
    desk.wait_planned()
    assert desk.session.state().folder == str(folder)
    assert all(desk.layer(title).isValid() for title in ("Captured images", "Satellite images"))
    viewing = desk.session.viewing
    desk.wait_for_tasks()
    viewing.tool.clicked.emit(float(plan.lat_deg[3]), float(plan.lon_deg[3]))
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    assert viewing.seen.picture.path.parent == folder / "satellite"
    assert viewing.seen.picture.image is not None
    viewing.viewer.hide()


def test_large_footprints_are_measured_before_the_main_thread_asks(desk, tmp_path, answers, monkeypatch):
    """QGIS asks a layer for its extent when it is added, which would read the whole file there."""
    from qgis.core import QgsVectorLayer
    from qgis.PyQt.QtCore import QThread

    asked, original = [], QgsVectorLayer.extent

    def extent(layer):
        asked.append(QThread.currentThread() == QgsApplication.instance().thread())
        return original(layer)

    desk.enter_coarse_mission()
    capture_into(desk, desk.folder)
    desk.iface.newProject(False)
    monkeypatch.setattr(QgsVectorLayer, "extent", extent)
    answers["folder"] = desk.folder
    choose_in_menu(desk, "Open dataset folder…")
    desk.wait(lambda: not desk.session.missions.busy)
    assert asked[0] is False
    if Qgis.QGIS_VERSION_INT < WITH_EXTENTS_OF_PROJECT:
        assert desk.layer("Captured images").readExtentFromXml()


@pytest.mark.thorough
@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="open files are listed on Linux only")
def test_runs_that_are_over_keep_no_file_open(desk):
    """Twice into the same folder: the second run's layers are not needed."""
    desk.enter_coarse_mission()
    capture_into(desk, desk.folder)
    runs = [desk.session.runs.runs[-1]]
    capture_into(desk, desk.folder)
    runs.append(desk.session.runs.runs[-1])
    desk.wait_for_tasks()
    desk.iface.newProject(False)
    desk.canvas.stopRendering()

    def open_files():
        settle()
        links = (os.path.realpath(link) for link in Path("/proc/self/fd").iterdir())
        return [link for link in links if link.startswith(str(desk.folder))]

    desk.wait(lambda: open_files() == [])
    assert all(run.has_ended for run in runs)


def test_mosaic_of_a_cleaned_dataset_is_made_anew(desk, tmp_path, answers):
    """Cleaning has moved images away that the mosaic still names."""
    from terrainav.core.dataset.clean import clean

    desk.enter_coarse_mission()
    capture_into(desk, desk.folder)
    desk.iface.newProject(False)
    images = sorted((desk.folder / "satellite").glob("*.tif"))
    with (desk.folder / "satellite" / "meta_data.csv").open(encoding="utf-8-sig", newline="") as table:
        entropies = sorted(float(row["entropies"]) for row in csv.DictReader(table))
    (cleaned,) = clean(desk.folder, entropies[len(entropies) // 2], move=True)
    assert 0 < cleaned.moved < len(images)
    answers["folder"] = desk.folder
    choose_in_menu(desk, "Open dataset folder…")
    desk.wait(lambda: not desk.session.missions.busy)
    text = (desk.folder / "satellite.vrt").read_text(encoding="utf-8")
    named = set(re.findall(r"satellite/[^<]*\.tif", text))
    assert named == {f"satellite/{path.name}" for path in (desk.folder / "satellite").glob("*.tif")}
    assert len(named) == len(images) - cleaned.moved
    assert desk.layer("Satellite images").isValid()


@pytest.mark.thorough
def test_failed_images_of_an_opened_mission_are_captured_from_the_menu(desk, tmp_path):
    with TileServer() as server:
        desk.enter_coarse_mission()
        desk.use_template(server.url_template)
        plan = desk.wait_planned().plan
        x, y = int(plan.windows.left_px[0]) // 256, int(plan.windows.top_px[0]) // 256
        assert not choose_in_menu(desk, "Capture only the failed images")
        server.fail("404", (plan.zoom, x, y))
        capture_into(desk, desk.folder)
        assert "Failed images" in desk.layer_names()
        assert QgsProject.instance().write(str(tmp_path / "project.qgz"))
        for run in list(desk.session.runs.runs):
            desk.session.runs.dismiss(run)
        desk.iface.newProject(False)
        desk.form.set_state(type(desk.session.state())())
        desk.iface.addProject(str(tmp_path / "project.qgz"))
        desk.wait_planned()
        assert "Failed images" in desk.layer_names()
        server.heal()
        assert choose_in_menu(desk, "Capture only the failed images")
        desk.wait(lambda: not desk.session.runs.idle)
        desk.wait_for_run()
    assert len(list((desk.folder / "satellite").glob("*.tif"))) == len(plan)
    assert "Failed images" not in desk.layer_names()


@pytest.mark.parametrize("rounds", [3, pytest.param(4, marks=pytest.mark.thorough)])
def test_unloading_in_the_middle_of_everything_leaves_nothing(unloaded, iface, qtbot, tmp_path, rounds):
    """Dock, tools, preview, a background, messages, and a run under way."""
    from qgis.utils import plugins

    from tests.plugin.steps import Desk

    before = None
    for round_number in range(rounds):
        if round_number == 1:
            # What QGIS makes once, when it is first asked for a message or a layer, is there by now.
            before = census(iface)
        assert qgis.utils.loadPlugin(PLUGIN)
        assert qgis.utils.startPlugin(PLUGIN)
        with TileServer(latency_s=0.2) as server:
            desk = Desk(plugins[PLUGIN], iface, qtbot, tmp_path / f"mission-{round_number}")
            desk.session.show_dock(True)
            desk.form.set_state(type(desk.session.state())(folder=str(desk.folder)))
            desk.enter_coarse_mission()
            desk.use_template(server.url_template)
            desk.wait_planned()
            desk.click(desk.dock.preview)
            desk.wait_previewed()
            desk.session.messages.warning("something to read", "details")
            desk.click(desk.dock.capture)
            desk.wait(lambda desk=desk: any((desk.folder / "satellite").glob("*.tif")))
            desk.click(desk.form.draw_box)
            desk.drag(desk.at(0.4, 0.4), desk.at(0.41, 0.4))
            assert qgis.utils.unloadPlugin(PLUGIN)
        del desk
        qtbot.waitUntil(lambda: QgsApplication.taskManager().countActiveTasks() == 0, timeout=60_000)
        settle()
    assert differences(before, census(iface)) == {}
    assert names_of_the_plugin(iface) == []
