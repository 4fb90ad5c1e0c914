"""What the plugin advises of missions, datasets and their images."""

from __future__ import annotations

import pytest
from qgis.core import QgsApplication, QgsProject
from qgis.PyQt.QtWidgets import QFileDialog
from terrainav.core.capture.runner import capture
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.dataset import mosaic
from terrainav.terrainav_plugin.dataset_window.tasks import CleanTask
from terrainav.terrainav_plugin.foreign import check_vector
from terrainav.terrainav_plugin.missions.plan_export import PlanExportTask

from tests.plugin.remedies.panel import captured, single
from tests.plugin.test_processing import Feedback, run
from tests.plugin.test_processing import provider as _provider  # noqa: F401  (a fixture)
from tests.plugin.test_project import choose_in_menu
from tests.plugin.test_repeated_tiles import DIGEST, grey_images, some_grey
from tests.plugin.test_viewer import pixel_of
from tests.support.patterns import positions
from tests.support.remedies import Case, remedy
from tests.support.sources import PatternSource
from tests.support.tileserver import TileServer

#: A few images.
MISSION = Mission(Box(35.142, -89.872, 35.14, -89.869), 120.0, image_px=64, max_px=64)


def dataset(folder):
    """Capture the mission into a folder; returns its plan."""
    source = PatternSource()
    planned = plan(MISSION, source.grid)
    assert capture(planned, source, folder).failed == ()
    return planned


def open_by_menu(case, desk, folder):
    """Open a dataset by the menu “Missions”."""
    case.monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(folder))
    choose_in_menu(desk, "Open dataset folder…")
    desk.wait(lambda: not desk.session.missions.busy)


@remedy(
    "missions/missions.py",
    "folder {folder}: has no {name}, so it is not a dataset of a capture; choose its folder",
)
def _no_dataset(case: Case) -> None:
    desk, folder = case.fixture("desk"), case.tmp_path / "out"
    dataset(folder)
    open_by_menu(case, desk, folder / "satellite")
    case.says("\n".join(desk.messages()))

    def choose():
        open_by_menu(case, desk, folder)
        return desk.session.state().folder == str(folder) and "Satellite images" in desk.layer_names()

    case.follow("choose its folder", choose)


@remedy("missions/plan_export.py", "{name} is still being written; try again when it is there.")
def _still_being_written(case: Case) -> None:
    desk, path = case.fixture("desk"), case.tmp_path / "survey.kml"
    exporting = desk.session.missions.plan_export
    single(desk)
    case.monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), ""))
    exporting._task = PlanExportTask(desk.wait_planned().plan, path)
    exporting._task.ended.connect(exporting._ended)
    choose_in_menu(desk, "Export plan…")
    case.says("\n".join(desk.messages()))
    assert not path.exists()
    QgsApplication.taskManager().addTask(exporting._task)
    desk.wait(lambda: path.exists() and not exporting.busy)
    path.unlink()

    def again():
        choose_in_menu(desk, "Export plan…")
        desk.wait(lambda: not desk.session.planner.busy and not exporting.busy)
        return path.exists()

    case.follow("try again when it is there.", again)


@remedy("dataset/mosaic.py", "file {}: cannot be replaced ({}); close what shows it")
def _held_open(case: Case) -> None:
    """As on Windows, where a program has it open."""
    folder = case.tmp_path / "out"
    planned = dataset(folder)
    mosaic.build_mosaics(planned, folder, lambda _share: True)
    (made,) = mosaic.build_mosaics(planned, folder, lambda _share: True)

    def held(*_):
        raise PermissionError(13, "in use")

    with case.monkeypatch.context() as patch:
        patch.setattr(mosaic.os, "replace", held)
        case.refused(made.put_in_place)
    case.follow("close what shows it", lambda: not made.put_in_place().is_made)


# --- looking at images


@pytest.fixture
def looking(desk):
    """The plugin's part that shows images; its window is closed at the end."""
    yield desk.session.viewing
    desk.session.viewing.stop()
    if desk.session.viewing.viewer is not None:
        desk.session.viewing.viewer.hide()


def look(desk):
    """Press the button that shows images; whether its tool is there then."""
    desk.plugin.actions["view_images"].trigger()
    return desk.canvas.mapTool() is desk.session.viewing.tool


@remedy(
    "results/viewing.py",
    "There are no captured images on the map yet: capture a mission, or open a dataset by “Missions”.",
)
def _nothing_to_look_at(case: Case) -> None:
    desk, folder = case.fixture("desk"), case.tmp_path / "out"
    case.fixture("looking")
    assert not look(desk)
    case.says("\n".join(desk.messages()))
    single(desk)
    case.follow("capture a mission", lambda: captured(desk) and shown(desk) and look(desk))
    desk.session.viewing.stop()
    QgsProject.instance().clear()
    assert not look(desk)
    dataset(folder)

    def open_one():
        open_by_menu(case, desk, folder)
        return look(desk)

    case.follow("open a dataset by “Missions”.", open_one)


def shown(desk):
    desk.wait(lambda: "Captured images" in desk.layer_names())
    return True


def looked_at(case):
    """A dataset on the map, with the tool that shows its images; what clicks one of them, and the window's hint."""
    desk, viewing = case.fixture("desk"), case.fixture("looking")
    planned = dataset(case.tmp_path / "out")
    open_by_menu(case, desk, case.tmp_path / "out")
    desk.canvas.waitWhileRendering()
    assert look(desk)

    def click():
        desk.click_map(pixel_of(desk, planned.lat_deg[0], planned.lon_deg[0]))
        desk.wait(lambda: viewing.seen is not None and not viewing.busy)
        return viewing.viewer.view.image is not None

    return desk, viewing, click


def hint_of(viewing):
    return viewing.viewer.view.accessibleName()


@remedy("results/viewing.py", "Click a captured footprint on the map.")
def _image_has_gone(case: Case) -> None:
    desk, viewing, click = looked_at(case)
    assert click()
    QgsProject.instance().removeMapLayer(desk.layer("Captured images").id())
    case.says(hint_of(viewing))
    open_by_menu(case, desk, case.tmp_path / "out")
    desk.canvas.waitWhileRendering()
    case.follow("Click a captured footprint on the map.", click)


# --- cleaning


@pytest.fixture
def cleaning(desk):
    """The plugin's part that cleans, whose tab is the current one; its window is closed at the end."""
    desk.session.datasets.open(tab="clean")
    yield desk.session.datasets
    desk.wait(lambda: not desk.session.datasets.busy)
    desk.session.datasets.window.hide()


def read(desk, cleaning):
    desk.wait(lambda: not cleaning.busy)
    return cleaning.cleaning.panel.entropies is not None


@remedy("dataset_window/tab.py", "Choose the folder of a dataset.")
def _no_folder(case: Case) -> None:
    desk, cleaning, folder = case.fixture("desk"), case.fixture("cleaning"), case.tmp_path / "out"
    dataset(folder)
    cleaning.open(folder)
    desk.type_text(cleaning.window.folder.lineEdit(), "")
    assert not read(desk, cleaning)
    case.says(cleaning.cleaning.panel.charts[0]._hint)
    desk.type_text(cleaning.window.folder.lineEdit(), str(folder))
    case.follow("Choose the folder of a dataset.", lambda: read(desk, cleaning))


@remedy(
    "dataset_window/cleaning.py",
    "{name}: stopped. Press the button again to finish, or Undo to put all back.",
)
def _cleaning_stopped(case: Case) -> None:
    desk, cleaning, folder = case.fixture("desk"), case.fixture("cleaning"), case.tmp_path / "out"
    total = len(dataset(folder))

    def there():
        return len(list(folder.glob("satellite/*.tif")))

    def press(action):
        read(desk, cleaning)
        desk.click(cleaning.cleaning.panel.buttons[action])
        return read(desk, cleaning)

    def press_and_stop():
        go_on = CleanTask.report_progress

        def stop(task, share):
            if share > 0.5:
                task.cancel()
            return go_on(task, share)

        with case.monkeypatch.context() as patch:
            patch.setattr(CleanTask, "report_progress", stop)
            press("move")

    cleaning.open(folder)
    read(desk, cleaning)
    # More than any image has.
    cleaning.cleaning.panel.threshold.setValue(8.0)
    press_and_stop()
    case.says("\n".join(desk.messages()))
    assert there() > 0
    case.follow("Press the button again to finish", lambda: press("move") and there() == 0)
    assert press("undo")
    cleaning.cleaning.panel.threshold.setValue(8.0)
    press_and_stop()
    assert there() > 0
    case.follow("Undo to put all back.", lambda: press("undo") and there() == total)


# --- algorithms


@remedy(
    "processing/capture.py",
    "Stopped at {done} of {total} images. Enter {folder} as the folder, and run it again to go on.",
)
def _stopped(case: Case) -> None:
    case.fixture("_provider")
    feedback, folder = Feedback(), case.tmp_path / "out"
    seen: list[object] = []

    def paint(*tile):
        seen.append(tile)
        if len(seen) == 30:
            feedback.cancel()
        return positions(*tile)

    with TileServer(paint) as server:
        # Of some hundred tiles.
        asked = {"COORDS": "35.14_-89.87_35.131_-89.856_120", "OTHER_SOURCE": server.url_template}
        first = run("capture", feedback, **asked, FOLDER=str(folder))
        case.says("\n".join(feedback.warnings))
        assert first["WRITTEN"] < first["TOTAL"]

        def again():
            result = run("capture", **asked, FOLDER=str(folder))
            return result["SKIPPED"] == first["WRITTEN"] and result["WRITTEN"] + result["SKIPPED"] == result["TOTAL"]

        case.follow(f"Enter {folder} as the folder, and run it again to go on.", again)


@remedy(
    "processing/capture.py",
    "{map_type}: the same tile came for {places} places and is in {images} images, such as {image}. It may be water "
    "or snow; if it shows no imagery, enter {digest} under “Tiles to treat as missing” and run it again.",
)
def _same_tile(case: Case) -> None:
    case.fixture("_provider")
    feedback, folder = Feedback(), case.tmp_path / "out"
    with TileServer(some_grey) as server:
        asked = {"COORDS": "35.14_-89.87_35.131_-89.856_120", "OTHER_SOURCE": server.url_template, "ZOOM": 18}
        run("capture", feedback, **asked, FOLDER=str(folder))
        case.says("\n".join(feedback.warnings))
        assert grey_images(folder)

        def again():
            run("capture", **asked, FOLDER=str(folder), PLACEHOLDERS=DIGEST)
            return grey_images(folder) == set()

        case.follow(f"enter {DIGEST} under “Tiles to treat as missing” and run it again.", again)


@remedy("foreign.py", "{path}: QGIS would open {other} in its place; rename the folder")
def _another_file(case: Case) -> None:
    path = case.tmp_path / "flights|layername=other" / "footprints.geojson"
    path.parent.mkdir()
    path.write_text('{"type": "FeatureCollection", "features": []}')
    case.refused(lambda: check_vector(path))

    def renamed():
        check_vector(path.parent.rename(case.tmp_path / "flights") / path.name)
        return True

    case.follow("rename the folder", renamed)
