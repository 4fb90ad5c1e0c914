"""Several imageries in the panel: entered, planned, captured as one, shown, saved and refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from qgis.core import QgsProject, QgsRasterLayer
from qgis.PyQt.QtCore import Qt, QTimer
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QDialogButtonBox, QLineEdit, QMessageBox
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.table import image_parts
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.capture.run import row_text
from terrainav.terrainav_plugin.form.mission_form import mission, mission_state
from terrainav.terrainav_plugin.form.state import FormState

from tests.plugin.test_viewer import pixel_of
from tests.support import rasters
from tests.support.tileserver import TileServer


def add(desk, enter, button=None):
    """Press *Add imagery…* (or another button), fill in the dialog by ``enter``, and accept it."""
    seen = []

    def fill():
        dialog = QApplication.activeModalWidget()
        if dialog is None or dialog.objectName() != "terrainav_imagery":
            QTimer.singleShot(20, fill)
            return
        try:
            enter(dialog)
            seen.append({name: dialog.marks.message(name) for name in ("imagery_name", "source")})
            ok = dialog.buttons.button(QDialogButtonBox.StandardButton.Ok)
            (dialog.accept if ok.isEnabled() else dialog.reject)()
        except BaseException:
            dialog.reject()
            raise

    QTimer.singleShot(20, fill)
    desk.click(button or desk.form.imagery.others.add)
    return seen[0]


def add_roadmap(desk, screenshot):
    def enter(dialog):
        dialog.entries.map_types["roadmap"].click()
        screenshot("imageries-dialog", dialog)

    return add(desk, enter)


def rows(desk):
    tree = desk.form.imagery.others.tree
    return [tuple(tree.topLevelItem(at).text(column) for column in range(3)) for at in range(tree.topLevelItemCount())]


@pytest.fixture
def two(desk, screenshot):
    """A small mission of the synthetic world's satellite and roadmap."""
    desk.enter_coarse_mission()
    desk.show(desk.form.imagery.others.add)
    assert not any(add_roadmap(desk, screenshot).values())
    return desk


def test_two_map_types_are_captured_as_one(two, screenshot):
    desk = two
    assert rows(desk) == [("world", "as above", ""), ("world-roadmap", "Synthetic (offline)", "Roadmap")]
    screenshot("imageries", desk.dock)
    planned = desk.wait_planned()
    assert planned.mission.imagery.imageries == ("world=world", "world-roadmap=world:roadmap")
    assert "36 images of 2 imageries" in desk.dock.figures.line.text().replace("\N{NO-BREAK SPACE}", " ")
    one = {name: len(plan) for name, plan in planned.plans.by_imagery.items()}
    assert len(one) == 2
    desk.click(desk.dock.capture)
    desk.wait(lambda: len(desk.session.runs.runs) == 1)
    desk.wait_for_run()
    (run,) = desk.session.runs.runs
    assert (run.result.written, run.result.failed) == (sum(one.values()), ())
    dataset = read_dataset(desk.folder)
    assert set(dataset.image_sets) == {"world", "world-roadmap"}
    assert Mission.load(desk.folder / "mission.json") == planned.mission
    layers = [layer.name() for layer in QgsProject.instance().mapLayers().values()]
    assert layers.count("Captured images") == 2
    assert "Satellite images" in layers
    assert "Roadmap images" in layers
    screenshot("imageries-map", desk.iface.mainWindow())
    # A click finds an image of each, of one name.
    viewing = desk.session.viewing
    desk.plugin.actions["view_images"].trigger()
    plan = planned.plan
    desk.click_map(pixel_of(desk, plan.lat_deg[0], plan.lon_deg[0]))
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    under_click = viewing.viewer.under_click
    texts = [under_click.itemText(number) for number in range(under_click.count())]
    assert texts == [
        f"1 of 2 here: world/{plan.names[0]}",
        f"2 of 2 here: world-roadmap/{plan.names[0]}",
    ]
    viewing.stop()
    viewing.viewer.hide()
    # After a mission of one of them, a new one goes beside the whole dataset.
    desk.form.set_state(replace(desk.session.state(), folder=str(desk.folder / "world")))
    desk.session.missions.begin_new()
    assert Path(desk.session.state().folder).parent == desk.folder.parent
    desk.form.set_state(mission_state(planned.mission, str(desk.folder)))
    desk.wait_planned()
    # Pressed again, there is nothing left to do.
    desk.click(desk.dock.capture)
    desk.wait(lambda: desk.session.runs.runs[-1:] != [run])
    desk.wait_for_run()
    assert desk.session.runs.runs[-1].result.skipped == sum(one.values())


def test_renamed_changed_and_removed(two):
    desk, others = two, two.form.imagery.others
    desk.form.set_state(desk.session.state())
    assert [name for name, _, _ in rows(desk)] == ["world", "world-roadmap"]
    # By keyboard, in the list.
    others.tree.setCurrentItem(others.tree.topLevelItem(1))
    desk.click(others.rename)
    editor = others.tree.findChild(QLineEdit)
    desk.type_text(editor, "World")
    QTest.keyClick(editor, Qt.Key.Key_Return)
    desk.wait(lambda: "imagery 'World': is named twice" in desk.message("imageries"))
    others.tree.topLevelItem(0).setText(0, "air")
    assert desk.wait_planned().mission.imagery.imageries == ("air=world", "World=world:roadmap")
    assert not desk.message("imageries")
    # The name given stays, whatever the source; the other one follows it.
    others.tree.setCurrentItem(others.tree.topLevelItem(1))

    def enter(dialog):
        assert dialog.name.text() == "World"
        desk.type_text(dialog.name, "air")
        assert "is there already" in dialog.marks.message("imagery_name")
        desk.type_text(dialog.name, "map")
        dialog.entries.map_types["terrain"].click()

    assert not any(add(desk, enter, others.edit).values())
    assert desk.wait_planned().mission.imagery.imageries == ("air=world", "map=world:terrain")
    desk.click(others.remove)
    planned = desk.wait_planned()
    assert planned.mission.imagery.imageries == ()
    assert planned.mission.imagery.source == "world"
    assert not others.tree.isVisible()


def test_wrong_imageries_are_told_beside_the_list(two, tmp_path):
    desk, others = two, two.form.imagery.others
    # Far from the area.
    placed = (300_000.0, 1.0, 0.0, 3_800_000.0, 0.0, -1.0)
    far = rasters.write(tmp_path / "far.tif", np.full((3, 50, 50), 9, np.uint8), placed, 32616)

    def enter(dialog):
        dialog.entries.choose_source(str(far))

    # Zooms of a raster are its own.
    desk.form.set_state(replace(desk.session.state(), resolution="auto"))
    add(desk, enter)
    desk.wait_planned()
    assert desk.message("imageries") == "far: its source has no imagery of the area"
    far.unlink()
    desk.form.set_state(replace(desk.session.state(), agl=130.0))
    desk.wait(lambda: desk.message("imageries").startswith("far: ") and "far.tif" in desk.message("imageries"))
    others.tree.setCurrentItem(others.tree.topLevelItem(2))
    desk.click(others.remove)
    assert len(desk.wait_planned().plans.by_imagery) == 2
    # Of the panel's own source one map type is captured then.
    desk.click(desk.form.map_types["terrain"])
    desk.wait(lambda: "tick one map type here" in desk.message("map_types"))
    desk.click(desk.form.map_types["satellite"])
    assert desk.wait_planned().mission.imagery.imageries[0] == "world-terrain=world:terrain"


def test_a_mission_of_several_imageries_survives_forms_files_and_projects(two, tmp_path):
    desk = two
    state = desk.session.state()
    made = mission(state)
    assert FormState.from_json(state.to_json()) == state
    for like in (
        made,
        made.replace(imageries=("2014=world@2014", "world=world")),
        made.replace(imageries=("a=world",)),
    ):
        assert mission(mission_state(like, "folder")) == like
    assert mission_state(made, state.folder).imagery_name == ""
    made.save(tmp_path / "mission.json")
    desk.form.set_state(mission_state(Mission.load(tmp_path / "mission.json"), state.folder))
    assert desk.wait_planned().mission == made


def test_cancelled_paused_and_resumed_in_one_row(desk):
    with TileServer() as server:
        server.latency_s = 0.3
        desk.enter_coarse_mission()
        desk.use_template(server.url_template)

        def enter(dialog):
            dialog.entries.choose_source("world")

        add(desk, enter)
        planned = desk.wait_planned()
        desk.click(desk.dock.capture)
        desk.wait(lambda: bool(desk.session.runs.runs) and desk.session.runs.runs[0].progress is not None)
        (run,) = desk.session.runs.runs
        assert run.progress.total == planned.plans.images
        run.pause(True)
        desk.wait(lambda: "Paused: " in row_text(run))
        run.pause(False)
        run.cancel()
        desk.wait(lambda: run.has_ended)
        server.latency_s = 0.0
        desk.session.runs.resume(run)
        desk.wait(lambda: desk.session.runs.runs[-1] is not run)
        desk.wait_for_run()
        (again,) = desk.session.runs.runs
        assert again.result.written + again.result.skipped == planned.plans.images
        assert len(desk.session.dock.run_list.rows) == 1


def test_a_failing_server_is_told_and_its_failed_images_are_captured_again(desk):
    with TileServer() as server:
        desk.enter_coarse_mission()

        def enter(dialog):
            dialog.entries.choose_source("url-template")
            dialog.entries.template.setText(server.url_template)

        add(desk, enter)
        planned = desk.wait_planned()
        server.fail("404")
        half = planned.plans.images // 2
        desk.click(desk.dock.capture)
        desk.wait(lambda: bool(desk.session.runs.runs))
        desk.wait_for_run()
        (run,) = desk.session.runs.runs
        assert (run.result.written, run.task.failed) == (half, half)
        assert row_text(run) == f"Missing: {half} of {2 * half} images"
        server.heal()
        desk.session.runs.capture_failed(run)
        desk.wait(lambda: desk.session.runs.runs[-1] is not run)
        desk.wait_for_run()
        assert (desk.session.runs.runs[-1].result.written, desk.session.runs.runs[-1].task.failed) == (half, 0)


def test_layers_of_the_project_can_be_imageries(desk, tmp_path):
    desk.enter_coarse_mission()
    desk.form.set_state(replace(desk.session.state(), resolution="auto"))
    planned = desk.wait_planned()
    box = planned.mission.area.bounds
    size = (box.span_deg / 50, 0.0, 0.0, -(box.north_deg - box.south_deg) / 50)
    placed = (box.west_deg - 10 * size[0], size[0], 0.0, box.north_deg - 10 * size[3], 0.0, size[3])
    path = rasters.write(tmp_path / "layer.tif", np.full((3, 70, 70), 99, np.uint8), placed, 4326)
    layer = QgsRasterLayer(str(path), "Ortho")
    QgsProject.instance().addMapLayer(layer)

    def enter(dialog):
        dialog.entries.choose_source(f"qgis:layer/{layer.id()}")
        desk.type_text(dialog.name, "ortho")

    add(desk, enter)
    assert rows(desk)[1][:2] == ("ortho", "Ortho")
    planned = desk.wait_planned()
    assert not desk.message("imageries")
    desk.click(desk.dock.capture)
    desk.wait(lambda: bool(desk.session.runs.runs))
    desk.wait_for_run()
    (run,) = desk.session.runs.runs
    assert run.result.failed == ()
    assert run.result.written == planned.plans.images
    image = next((desk.folder / "ortho" / "satellite").glob("*.tif"))
    assert gdal.Open(str(image)).ReadAsArray().mean() == 99.0


def test_terms_are_asked_of_every_source(two, monkeypatch):
    desk, asked = two, []

    def problem(mission, requests):
        asked.append((mission.imagery.map_types, requests))
        return "Terms", True

    monkeypatch.setattr("terrainav.terrainav_plugin.capture.questions.terms_problem", problem)
    monkeypatch.setattr(QMessageBox, "question", lambda *_: QMessageBox.StandardButton.No)
    planned = desk.wait_planned()
    desk.click(desk.dock.capture)
    desk.wait(lambda: len(asked) >= 3)
    assert {types for types, _ in asked} == {("satellite",), ("roadmap",)}
    # The world's map types are under the same terms.
    assert {requests for _, requests in asked} == {sum(plan.requests for plan in planned.plans.by_imagery.values())}
    assert not desk.session.runs.runs


def test_processing_plans_and_captures_several_imageries(plugin, tmp_path):
    import processing

    asked = {
        "COORDS": "35.16_-89.90_35.157_-89.896_120",
        "IMAGERY": "air=world; map=Synthetic (offline):roadmap",
        "IMAGE_PX": 64,
    }
    planned = processing.run("terrainav:plan", {**asked, "MISSION_FILE": str(tmp_path / "mission.json")})
    assert Mission.load(tmp_path / "mission.json").imagery.imageries == ("air=world", "map=Synthetic (offline):roadmap")
    one = processing.run("terrainav:plan", {name: value for name, value in asked.items() if name != "IMAGERY"})
    assert planned["TILES"] > one["TILES"]
    folder = tmp_path / "out"
    found = processing.run("terrainav:capture", {**asked, "FOLDER": str(folder)})
    assert (found["TOTAL"], found["FAILED"]) == (2 * planned["IMAGES"], 0)
    assert set(read_dataset(folder).image_sets) == {"air", "map"}
    assert (folder / "map" / "footprints.geojson").is_file()
    again = processing.run("terrainav:capture", {**asked, "FOLDER": str(folder)})
    assert again["SKIPPED"] == found["TOTAL"]
    assert processing.run("terrainav:capturefailed", {"DATASET": str(folder)})["TOTAL"] == 0


def test_two_imageries_are_compared_and_viewed(two):
    desk = two
    desk.wait_planned()
    desk.click(desk.dock.capture)
    desk.wait(lambda: bool(desk.session.runs.runs))
    desk.wait_for_run()
    desk.session.compare.open()
    bar = desk.session.compare.bar
    assert len(set(bar.pair())) == 2
    texts = [bar.boxes[0].itemText(at) for at in range(bar.boxes[0].count())]
    desk.session.compare.close()
    assert texts == ["TerrAInav: world: Satellite images", "TerrAInav: world-roadmap: Roadmap images"]
    # The dataset of the whole capture opens in its window, which divides both alike.
    desk.session.datasets.open(desk.folder, "split")
    tab = desk.session.datasets.tabs["split"]
    desk.wait(tab.split.isEnabled)
    desk.choose(tab.how, "shuffled")
    desk.click(tab.split)
    desk.wait(lambda: tab.undo.isEnabled() and not desk.session.datasets.busy)
    parts = [image_parts(one.table) for one in read_dataset(desk.folder).image_sets.values()]
    assert parts[0] == parts[1]
    assert set(parts[0]) == {"train", "validation", "test"}


def test_a_project_keeps_its_imageries(two, tmp_path):
    desk = two
    planned = desk.wait_planned()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    desk.click(desk.dock.capture)
    desk.wait(lambda: bool(desk.session.runs.runs))
    desk.wait_for_run()
    file = str(tmp_path / "project.qgs")
    assert QgsProject.instance().write(file)
    desk.iface.newProject(False)
    desk.form.set_state(replace(desk.session.state(), imageries=(), imagery_name=""))
    desk.iface.addProject(file)
    desk.wait(lambda: bool(desk.session.state().imageries))
    assert desk.wait_planned().mission == planned.mission
    assert [name for name, _, _ in rows(desk)] == ["world", "world-roadmap"]
