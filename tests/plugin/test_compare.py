"""Datasets of one mission stand together, and two images on the map are compared by flickering."""

from __future__ import annotations

import shutil

import pytest
from qgis.core import QgsProject
from qgis.gui import QgsRubberBand
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtTest import QTest
from terrainav.terrainav_plugin.form.state import FormState

from tests.plugin.test_project import choose_in_menu

AREA = "35.14_-89.87_35.137_-89.866_120"


def captured_into(folder, *more):
    from terrainav.core.cli import main

    assert main(["capture", "--coords", AREA, "--zoom", "17", *more, "--data-dir", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    """Of two imageries."""
    folder = tmp_path_factory.mktemp("captured") / "change"
    return captured_into(folder, "--imagery", "first=world", "second=world")


@pytest.fixture
def both(desk, captured, tmp_path):
    """The two on the map."""
    folder = shutil.copytree(captured, tmp_path / "change")
    desk.session.missions.open_dataset(folder)
    desk.wait(lambda: not desk.session.missions.busy)
    return folder


@pytest.fixture
def compare(desk):
    yield desk.session.compare
    desk.session.compare.close()


def groups():
    """Names of all groups, with the names of those around them."""
    found = []
    for group in QgsProject.instance().layerTreeRoot().findGroups(True):
        around = group.parent()
        found.append((around.name(), group.name()))
    return found


def mosaic_nodes():
    from terrainav.terrainav_plugin.compat import RASTER

    nodes = QgsProject.instance().layerTreeRoot().findLayers()
    return [node for node in nodes if node.layer().type() == RASTER]


def seen():
    return [node.itemVisibilityChecked() for node in mosaic_nodes()]


def on_canvas(canvas):
    """Mosaics that the map draws, in the order of the layer tree."""
    drawn = {layer.id() for layer in canvas.layers()}
    return [node.layerId() in drawn for node in mosaic_nodes()]


def state():
    """What is ticked in the whole layer tree."""
    root = QgsProject.instance().layerTreeRoot()
    return [node.itemVisibilityChecked() for node in (*root.findGroups(True), *root.findLayers())]


def test_imageries_of_one_mission_stand_under_one_parent(desk, both):
    assert ("", "TerrAInav: change") in groups()
    assert ("TerrAInav: change", "TerrAInav: first") in groups()
    assert ("TerrAInav: change", "TerrAInav: second") in groups()
    assert len(groups()) == 3
    assert len(mosaic_nodes()) == 2
    assert desk.session.state().folder == str(both)
    # Opened again there are no more.
    desk.session.missions.open_dataset(both)
    desk.wait(lambda: not desk.session.missions.busy)
    assert len(groups()) == 3
    assert len(mosaic_nodes()) == 2


def test_one_imagery_opened_alone_comes_under_its_mission(desk, captured):
    desk.session.missions.open_dataset(captured / "second")
    desk.wait(lambda: not desk.session.missions.busy)
    assert groups() == [("", "TerrAInav: change"), ("TerrAInav: change", "TerrAInav: second")]


def test_datasets_of_one_flight_are_gathered_and_others_are_not(desk, tmp_path):
    for name, more in (("one", ()), ("two", ("--map-type", "roadmap")), ("other", ("--overlap", "30%"))):
        captured_into(tmp_path / name, *more)
        desk.session.missions.open_dataset(tmp_path / name)
        desk.wait(lambda: not desk.session.missions.busy)
    together = "TerrAInav: datasets of one mission"
    assert set(groups()) == {
        ("", together),
        (together, "TerrAInav: one"),
        (together, "TerrAInav: two"),
        ("", "TerrAInav: other"),
    }
    # A layer that comes then is above none of them.
    from qgis.core import QgsVectorLayer

    QgsProject.instance().addMapLayer(QgsVectorLayer("Point?crs=EPSG:4326", "mine", "memory"))
    desk.wait(lambda: QgsProject.instance().layerTreeRoot().children()[-1].name() == "mine")


def test_flicker_shows_one_and_then_the_other(desk, both, compare, screenshot):
    before = state()
    choose_in_menu(desk, "Compare images…")
    bar = compare.bar
    assert bar.isVisible()
    assert seen() == [True, False]
    desk.wait(lambda: on_canvas(desk.canvas) == [True, False])
    assert bar.state.text() == "Shown: TerrAInav: first: Satellite images"
    desk.click(bar.switch)
    assert seen() == [False, True]
    assert bar.state.text() == "Shown: TerrAInav: second: Satellite images"
    desk.wait(lambda: on_canvas(desk.canvas) == [False, True])
    desk.canvas.waitWhileRendering()
    screenshot("compare")
    bar.pause.setValue(0.2)
    desk.click(bar.flicker)
    for wanted in ([True, False], [False, True], [True, False]):
        desk.wait(lambda wanted=wanted: seen() == wanted)
    desk.click(bar.flicker)
    held = seen()
    QTest.qWait(300)
    assert seen() == held
    desk.click(bar.closing)
    assert compare.bar is None
    assert state() == before


def test_space_switches_over_the_map_and_in_the_window(desk, both, compare):
    compare.open()
    for widget in (desk.canvas, compare.bar):
        widget.setFocus()
        before = seen()
        QTest.keyClick(widget, Qt.Key.Key_Space)
        assert seen() == before[::-1]
    compare.close()
    # And is QGIS's again.
    before = seen()
    QTest.keyClick(desk.canvas, Qt.Key.Key_Space)
    assert seen() == before


def test_what_was_hidden_is_hidden_again_and_the_project_is_as_saved(desk, both, compare, tmp_path):
    project = QgsProject.instance()
    mosaic_nodes()[1].setItemVisibilityChecked(False)
    project.layerTreeRoot().findGroups(True)[0].setItemVisibilityChecked(False)
    assert project.write(str(tmp_path / "project.qgz"))
    desk.wait(lambda: not project.isDirty())
    before = state()
    compare.open()
    compare.switch()
    assert all(group.itemVisibilityChecked() for group in project.layerTreeRoot().findGroups(True)[:1])
    assert state() != before
    assert not project.isDirty()
    compare.close()
    assert state() == before
    assert not project.isDirty()


def test_a_layer_that_goes_ends_the_flicker_and_leaves_the_rest_as_it_was(desk, both, compare):
    project = QgsProject.instance()
    compare.open()
    desk.click(compare.bar.flicker)
    first, second = mosaic_nodes()
    kept = second.layerId()
    project.removeMapLayer(first.layerId())
    desk.wait(lambda: not compare.bar.flicker.isEnabled())
    assert not compare._timer.isActive()
    assert "no two images" in compare.bar.state.text()
    assert project.layerTreeRoot().findLayer(kept).itemVisibilityChecked()
    compare.close()
    assert project.layerTreeRoot().findLayer(kept).itemVisibilityChecked()


def test_a_new_project_closes_it(desk, both, compare, iface):
    compare.open()
    desk.click(compare.bar.flicker)
    iface.newProject(False)
    desk.wait(lambda: compare.bar is None)
    assert not compare._timer.isActive()
    # And it can be opened again, and says what is missing.
    compare.open()
    assert "no two images" in compare.bar.state.text()
    assert not compare.bar.switch.isEnabled()


def test_frames_and_fills_are_hidden_meanwhile(desk, both, compare):
    """Of captured and of planned images, and what is drawn over the map; all come back as they were."""

    def drawn():
        return {layer.name() for layer in desk.canvas.layers()}

    def bands():
        shown = (item for item in desk.canvas.scene().items() if isinstance(item, QgsRubberBand) and item.isVisible())
        return sum(1 for _ in shown)

    desk.form.set_state(FormState(folder=str(desk.folder)))
    desk.enter_small_mission()
    desk.session.set_preview(True)
    desk.wait_previewed()
    desk.session.viewing.start()
    desk.wait(lambda: desk.session.viewing.seen is not None and not desk.session.viewing.busy)
    frames = {"Captured images", "Planned images"}
    desk.wait(lambda: frames <= drawn())
    before, bands_before = state(), bands()
    assert bands_before
    compare.open()
    desk.wait(lambda: drawn() == {"Satellite images"})
    assert bands() == 0
    for _ in range(2):
        compare.switch()
        assert bands() == 0
    assert desk.canvas.isVisible()
    bar = compare.bar
    assert not bar.isFloating()
    assert not bar.geometry().intersects(desk.iface.mainWindow().centralWidget().geometry())
    compare.close()
    desk.wait(lambda: frames <= drawn())
    assert state() == before
    assert bands() == bands_before
    desk.session.viewing.stop()
    desk.session.viewing.viewer.hide()


def test_the_window_of_a_dataset_leads_to_it(desk, both, compare):
    desk.session.datasets.open(both / "first", "clean")
    desk.wait(lambda: not desk.session.datasets.busy)
    desk.click(desk.session.datasets.window.compare)
    assert compare.bar.isVisible()
    desk.session.datasets.window.hide()
