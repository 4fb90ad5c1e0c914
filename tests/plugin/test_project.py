"""Saved projects, and the plugin's end in the middle of its work."""

from __future__ import annotations

import shutil

import pytest
import qgis.utils
from qgis.core import QgsApplication, QgsProject

from tests.plugin.test_loading import PLUGIN, census, differences, names_of_the_plugin, settle, unloaded
from tests.support.tileserver import TileServer

__all__ = ["unloaded"]


def everything(iface):
    """Count all but the layer tree's marks of temporary layers, which QGIS keeps after any such layer is removed."""
    counts = census(iface)
    del counts["all objects below the main window"]["QgsLayerTreeViewIndicator"]
    return counts


@pytest.fixture
def captured(desk):
    """A captured mission with its preview, and a project saved beside it."""
    with TileServer() as server:
        desk.enter_small_mission()
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
    results = {
        layer.name(): layer for layer in project.mapLayers().values() if layer.providerType() != "memory"
    }
    assert set(results) == {"Captured images", "Satellite images"}
    for layer in results.values():
        assert layer.isValid()
        assert layer.source().startswith(str(moved))


def test_reopened_project_brings_the_mission_back(captured):
    state, count = captured.workflow.state(), captured.layer("Planned images").featureCount()
    names = captured.layer_names()
    captured.iface.newProject(False)
    captured.form.agl.setValue(33.0)
    captured.iface.addProject(str(captured.folder.parent / "project.qgz"))
    captured.wait_previewed()
    captured.wait_planned()
    assert captured.workflow.state() == state
    assert captured.layer_names() == names
    assert captured.layer("Planned images").featureCount() == count
    assert captured.dock.preview.isChecked()


def test_project_moved_with_its_dataset_knows_where_it_is(captured, tmp_path):
    moved = tmp_path / "elsewhere"
    captured.iface.newProject(False)
    shutil.copytree(captured.folder.parent, moved, ignore=shutil.ignore_patterns("elsewhere"))
    shutil.rmtree(captured.folder)
    captured.iface.addProject(str(moved / "project.qgz"))
    captured.wait_previewed()
    assert captured.workflow.state().folder == str(moved / "mission")
    # Going on there finds every image.
    captured.click(captured.dock.capture)
    captured.wait(lambda: any("were there already" in text for text in captured.messages()))


def test_unloading_in_the_middle_of_everything_leaves_nothing(unloaded, iface, qtbot, tmp_path):
    """Dock, tools, preview, a background, messages, and a run under way."""
    from qgis.utils import plugins

    from tests.plugin.steps import Desk

    before = everything(iface)
    for round_number in range(3):
        assert qgis.utils.loadPlugin(PLUGIN)
        assert qgis.utils.startPlugin(PLUGIN)
        with TileServer(latency_s=0.2) as server:
            desk = Desk(plugins[PLUGIN], iface, qtbot, tmp_path / f"mission-{round_number}")
            desk.workflow.show_dock(True)
            desk.form.set_state(type(desk.workflow.state())(folder=str(desk.folder)))
            desk.enter_small_mission()
            desk.use_template(server.url_template)
            desk.wait_planned()
            desk.click(desk.dock.preview)
            desk.wait_previewed()
            desk.workflow.messages.warning("something to read", "details")
            desk.click(desk.dock.capture)
            desk.wait(lambda desk=desk: any((desk.folder / "satellite").glob("*.tif")))
            desk.click(desk.form.draw_box)
            desk.drag(desk.at(0.4, 0.4), desk.at(0.41, 0.4))
            assert qgis.utils.unloadPlugin(PLUGIN)
        del desk
        qtbot.waitUntil(lambda: QgsApplication.taskManager().countActiveTasks() == 0, timeout=60_000)
        settle()
    assert differences(before, everything(iface)) == {}
    assert names_of_the_plugin(iface) == []
