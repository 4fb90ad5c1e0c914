"""The window of a dataset, tab by tab: what it shows is what the core says, and what it writes the core reads."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QAbstractButton, QLabel
from terrainav.core.dataset.labels import mark_unfinished
from terrainav.terrainav_plugin.widgets import mnemonic_key

AREA = "35.14_-89.87_35.1365_-89.8645_120"
VIEWS = ("colmap", "nerfstudio", "tum", "kitti")


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    """Tilted images with depth."""
    from terrainav.core.cli import main

    folder = tmp_path_factory.mktemp("captured") / "tilted"
    asked = ["--coords", AREA, "--tilt", "20", "--frame", "camera", "--products", "depth", "--zoom", "17"]
    assert main(["capture", *asked, "--data-dir", str(folder)]) == 0
    return folder


@pytest.fixture
def dataset(captured, tmp_path):
    """A copy of it, for one test."""
    return shutil.copytree(captured, tmp_path / "tilted")


@pytest.fixture
def window(desk):
    """The window, closed at the end."""
    datasets = desk.session.datasets
    yield datasets
    desk.wait(lambda: not datasets.busy)
    datasets.window.hide()


def go_to(desk, datasets, folder, tab):
    """Open a dataset at a tab."""
    datasets.open(folder, tab)
    desk.wait(lambda: not datasets.busy)
    return datasets.tabs.get(tab)


def press(desk, datasets, button):
    desk.click(button)
    desk.wait(lambda: not datasets.busy)


def choose(button):
    """Click the round mark of a format, which is at the left end of its cell."""
    QTest.mouseClick(button, Qt.MouseButton.LeftButton, pos=QPoint(8, button.height() // 2))
    assert button.isChecked()


def test_one_folder_is_for_all_tabs_which_read_it_when_they_are_seen(desk, window, dataset, tmp_path):
    go_to(desk, window, dataset, "clean")
    assert [window.window.tabs.tabText(at).replace("&", "") for at in range(5)] == [
        "Clean",
        "Split",
        "Benchmark",
        "Export",
        "Labels",
    ]
    assert window.cleaning.panel.entropies is not None
    assert window.tabs["labels"].folder != dataset
    bar = window.window.tabs.tabBar()
    for at, name in enumerate(("split", "benchmark", "export", "labels"), 1):
        QTest.mouseClick(bar, Qt.MouseButton.LeftButton, pos=bar.tabRect(at).center())
        desk.wait(lambda: not window.busy)
        assert window.tabs[name].folder == dataset
    # One that is no dataset says so in each of them, in one line.
    (tmp_path / "empty").mkdir()
    desk.type_text(window.window.folder.lineEdit(), str(tmp_path / "empty"))
    desk.wait(lambda: not window.busy)
    assert "is not a dataset" in window.tabs["labels"].hint.text()
    go_to(desk, window, tmp_path / "empty", "split")
    assert "is not a dataset" in window.tabs["split"].state.text()
    assert not window.tabs["split"].split.isEnabled()
    go_to(desk, window, tmp_path / "empty", "export")
    assert not any(button.isEnabled() for button in window.tabs["export"].kinds.values())


def test_split_writes_what_the_core_would_and_says_what_came_out(desk, window, dataset, screenshot):
    from terrainav.core.dataset.split import split
    from terrainav.core.dataset.table import Table

    tab = go_to(desk, window, dataset, "split")
    assert "Not split yet" in tab.state.text()
    tables = {path: path.read_bytes() for path in dataset.rglob("meta_data.csv")}
    desk.choose(tab.how, "shuffled")
    for part, text in (("train", "0.6"), ("validation", "0.2"), ("test", "0.2")):
        desk.type_text(tab.shares[part].lineEdit(), text)
    desk.type_text(tab.seed.lineEdit(), "7")
    desk.click(tab.dry_run)
    expected = split(dataset, (0.6, 0.2, 0.2), how="shuffled", seed=7, dry_run=True)
    press(desk, window, tab.split)
    assert {path: path.read_bytes() for path in dataset.rglob("meta_data.csv")} == tables
    assert "Only counted" in tab.result.text()
    for title, part in (("Training", "train"), ("Validation", "validation"), ("Test", "test")):
        assert f"{title}: {expected.images[part]} images" in tab.result.text()
    # By keyboard.
    desk.click(tab.dry_run)
    tab.split.setFocus()
    QTest.keyClick(tab.split, Qt.Key.Key_Space)
    desk.wait(lambda: not window.busy)
    parts = Table.load(dataset / "satellite" / "meta_data.csv").other["split"]
    assert {part: parts.count(part) for part in expected.images} == expected.images
    assert f"Parts now: Training {expected.images['train']}," in tab.state.text()
    assert json.loads((dataset / "labels.json").read_text())["frame"] == "EPSG:32616"
    screenshot("dataset-split", window.window)


def test_a_split_is_undone_by_a_button(desk, window, dataset):
    tab = go_to(desk, window, dataset, "split")
    tables = {path: path.read_bytes() for path in dataset.rglob("meta_data.csv")}
    assert not tab.undo.isEnabled()
    desk.choose(tab.how, "shuffled")
    press(desk, window, tab.split)
    desk.wait(tab.undo.isEnabled)
    now = tab.state.text()
    desk.choose(tab.how, "in-order")
    press(desk, window, tab.split)
    desk.wait(tab.undo.isEnabled)
    press(desk, window, tab.undo)
    assert tab.result.text().startswith("The split is undone. Parts before it: Training ")
    desk.wait(lambda: tab.state.text() == now and tab.undo.isEnabled())
    press(desk, window, tab.undo)
    assert tab.result.text() == "The split is undone: the images are in no part, and there are no labels."
    assert {path: path.read_bytes() for path in dataset.rglob("meta_data.csv")} == tables
    assert not (dataset / "labels.json").exists()
    desk.wait(lambda: tab.split.isEnabled() and not tab.undo.isEnabled())


def test_a_split_that_was_interrupted_at_once_can_be_undone(desk, window, dataset):
    mark_unfinished(dataset / "labels.json")
    tab = go_to(desk, window, dataset, "split")
    desk.wait(tab.undo.isEnabled)
    press(desk, window, tab.undo)
    desk.wait(lambda: tab.split.isEnabled() and not tab.undo.isEnabled())
    assert not (dataset / "labels.json").exists()


def test_split_takes_blocks_and_a_frame_by_its_code(desk, window, dataset):
    tab = go_to(desk, window, dataset, "split")
    desk.choose(tab.how, "shuffled")
    assert not tab.block.isEnabled()
    desk.choose(tab.how, "blocks")
    desk.type_text(tab.block.lineEdit(), "40")
    desk.type_text(tab.frame.lineEdit(), "EPSG:3857")
    assert tab.options()[1] == {
        "how": "blocks",
        "seed": tab.seed.value(),
        "block_m": 40.0,
        "gap_m": 0.0,
        "frame": "EPSG:3857",
        "dry_run": False,
    }
    desk.type_text(tab.frame.lineEdit(), "EPSG:4326")
    press(desk, window, tab.split)
    assert "not a projected system in metres" in tab.result.text()
    assert "\n" not in tab.result.text()
    desk.choose(tab.frame, "mission")
    assert tab.options()[1]["frame"] == "mission"


def test_a_split_is_stopped_and_changes_nothing(desk, window, dataset, monkeypatch):
    from terrainav.terrainav_plugin.dataset_window.tasks import SplitTask

    tab = go_to(desk, window, dataset, "split")
    tables = {path: path.read_bytes() for path in dataset.rglob("meta_data.csv")}
    go_on = SplitTask.report_progress

    def stop(task, share):
        # As the button does while the task is at work.
        task.cancel()
        return go_on(task, share)

    monkeypatch.setattr(SplitTask, "report_progress", stop)
    press(desk, window, tab.split)
    assert tab.result.text() == "Stopped: nothing was changed."
    assert {path: path.read_bytes() for path in dataset.rglob("meta_data.csv")} == tables
    assert not (dataset / "labels.json").exists()


def test_stop_is_there_while_something_is_done(desk, window, dataset):
    tab = go_to(desk, window, dataset, "split")
    assert not window.window.stop.isVisible()
    desk.click(tab.split)
    assert window.window.stop.isVisible()
    assert not window.window.folder.isEnabled()
    assert not tab.split.isEnabled()
    desk.click(window.window.stop)
    desk.wait(lambda: not window.busy)
    assert not window.window.stop.isVisible()
    assert tab.split.isEnabled()


def test_only_what_a_dataset_can_become_is_offered(desk, window, dataset, tmp_path, screenshot):
    from tests.support.published import write_published

    tab = go_to(desk, window, dataset, "export")
    for kind in (*VIEWS, "huggingface", "croissant"):
        assert tab.kinds[kind].isEnabled(), kind
    for kind in ("university-1652", "ortholoc"):
        assert not tab.kinds[kind].isEnabled()
        assert "is not a benchmark" in tab.kinds[kind].toolTip()
    assert "was captured without labels" in tab.kinds["coco"].toolTip()
    assert [note.text() for note in tab.notes[2:]] == [
        "This folder has no labels of pixels.",
        "This folder is not a sequence.",
        "This folder is not a benchmark.",
    ]
    target = tmp_path / "out"
    choose(tab.kinds["nerfstudio"])
    assert tab.target.filePath() == str(dataset.with_name("tilted-nerfstudio"))
    desk.type_text(tab.target.lineEdit(), str(target))
    press(desk, window, tab.export)
    frames = json.loads((target / "transforms.json").read_text())["frames"]
    assert f"{len(frames)} images as nerfstudio in {target}" in tab.result.text()
    assert tab.open_folder.isVisible()
    screenshot("dataset-export", window.window)
    # Not a second time into the same folder: in one line.
    press(desk, window, tab.export)
    assert "is not empty" in tab.result.text()
    assert not tab.open_folder.isVisible()
    # Windows of the map are no camera's, and whose camera nobody knows have none.
    write_published(tmp_path / "Memphis" / "satellite_0")
    tab = go_to(desk, window, tmp_path / "Memphis", "export")
    assert not any(tab.kinds[kind].isEnabled() for kind in VIEWS)
    assert tab.kinds["croissant"].isEnabled()
    assert tab.notes[0].isVisible()


def test_labels_become_coco(desk, window, tmp_path, screenshot):
    from tests.support.labelled import write_labelled

    folder = write_labelled(tmp_path / "labelled")
    tab = go_to(desk, window, folder, "export")
    assert not tab.notes[2].isVisible()
    choose(tab.kinds["coco"])
    assert tab.target.filePath() == str(tmp_path / "labelled-coco")
    press(desk, window, tab.export)
    assert "14 images as COCO in " in tab.result.text()
    screenshot("dataset-export-labels", window.window)
    names = {one.name for one in (tmp_path / "labelled-coco" / "annotations").iterdir()}
    assert names == {"instances_train.json", "instances_val.json", "instances_test.json"}


def test_croissant_goes_beside_the_tables(desk, window, dataset):
    tab = go_to(desk, window, dataset, "export")
    choose(tab.kinds["croissant"])
    assert tab.target.filePath() == ""
    assert tab.export.isEnabled()
    press(desk, window, tab.export)
    assert (dataset / "croissant.json").is_file()


def test_a_stopped_export_leaves_nothing(desk, window, dataset, tmp_path, monkeypatch):
    from terrainav.terrainav_plugin.dataset_window.tasks import DatasetExportTask

    tab = go_to(desk, window, dataset, "export")
    monkeypatch.setattr(DatasetExportTask, "report_progress", lambda task, share: share < 0.5)
    choose(tab.kinds["huggingface"])
    desk.type_text(tab.target.lineEdit(), str(tmp_path / "hf"))
    press(desk, window, tab.export)
    assert tab.result.text() == "Stopped: nothing of the export is left."
    assert not (tmp_path / "hf").exists()


def test_labels_and_depths_are_those_of_the_files(desk, window, dataset, screenshot):
    from osgeo import gdal
    from terrainav.core.dataset.clean import clean
    from terrainav.core.dataset.labels import Labels
    from terrainav.core.dataset.split import split
    from terrainav.core.dataset.table import Table

    table = Table.load(dataset / "satellite" / "meta_data.csv")
    threshold = float(np.sort(table.entropies)[1]) + 1e-6
    clean(dataset, threshold)
    split(dataset, how="shuffled")
    table = Table.load(dataset / "satellite" / "meta_data.csv")
    tab = go_to(desk, window, dataset, "labels")
    labels = Labels.load(dataset / "labels.json").transform(table.lat_deg, table.lon_deg)
    for at, card in enumerate(tab.cards):
        text = card.text.text()
        assert card.name.text() == table.img_names[at]
        east, north = labels[at]
        assert f"Label: easting {east:+.3f}, northing {north:+.3f}" in text
        assert f"Entropy: {table.entropies[at]:.3f} bits" in text
        assert ("Not rejected" in text) == (not table.other["rejected"][at])
        stem = table.img_names[at].rsplit(".", 1)[0]
        there = gdal.Open(str(dataset / "depth" / f"{stem}.tif")).ReadAsArray()
        there = there[np.isfinite(there) & (there > 0.0)]
        shown = [float(one.removesuffix(" m")) for one in card.scale.texts]
        assert shown[0] == pytest.approx(float(there.min()), rel=0.05)
        assert shown[1] == pytest.approx(float(there.max()), rel=0.05)
        assert not card.image.pixmap().isNull()
        assert not card.depth_image.pixmap().isNull()
        # Two pictures, and the text below them, as the dock beside the map is narrow.
        assert card.minimumSizeHint().width() < 320
        desk.wait(lambda card=card: card.text.geometry().top() > card.image.geometry().bottom())
    screenshot("dataset-labels", window.window)
    # Further, and back; no further than there are images.
    desk.click(tab.next)
    desk.wait(lambda: not window.busy)
    assert tab.cards[0].name.text() == table.img_names[4]
    desk.click(tab.previous)
    desk.wait(lambda: not window.busy)
    assert tab.cards[0].name.text() == table.img_names[0]
    assert not tab.previous.isEnabled()
    # Those of a part, and the rejected ones, alone.
    for of, rows in (
        ("test", [at for at, part in enumerate(table.other["split"]) if part == "test"]),
        ("rejected", [at for at, mark in enumerate(table.other["rejected"]) if mark]),
    ):
        tab.of.setCurrentIndex(tab.of.findData(of))
        tab.of.activated.emit(tab.of.currentIndex())
        desk.wait(lambda: not window.busy)
        seen = [card.name.text() for card in tab.cards if card.isVisible()]
        assert seen == [table.img_names[at] for at in rows][:4]
        assert f"({len(rows)})" in tab.of.currentText()


def test_labels_of_an_interrupted_split_say_so(desk, window, dataset):
    (dataset / "labels.json").write_text('{"unfinished": "split"}\n')
    tab = go_to(desk, window, dataset, "labels")
    assert "a split was interrupted" in tab.hint.text()
    assert tab.cards[0].isVisible()
    assert "Label:" not in tab.cards[0].text.text()


def test_benchmark_tab_opens_processings_windows(desk, window, dataset):
    desk.enter_small_mission()
    tab = go_to(desk, window, dataset, "benchmark")
    assert "is not a benchmark" in tab.hint.text()
    windows = desk.session.benchmarks
    press(desk, window, tab.make)
    desk.wait(lambda: len(windows.windows) == 1)
    assert windows.windows[0].algorithm().id() == "terrainav:makebenchmark"
    press(desk, window, tab.score)
    desk.wait(lambda: len(windows.windows) == 2)
    assert windows.windows[1].algorithm().id() == "terrainav:scorebenchmark"
    windows.close()
    asked = []
    tab.score_wanted.connect(asked.append)
    tab._is_benchmark = True
    desk.click(tab.score)
    assert asked == [dataset]
    windows.close()


def letters(widget):
    """Letters of what a tab and the window around it show."""
    found = [mnemonic_key(child.text()) for child in widget.findChildren(QLabel) if child.buddy() is not None]
    found += [mnemonic_key(child.text()) for child in widget.findChildren(QAbstractButton)]
    return [letter for letter in found if letter]


def test_letters_of_the_whole_window_differ(desk, window, dataset):
    go_to(desk, window, dataset, "clean")
    found = letters(window.window)
    assert len(found) >= 8
    assert sorted(found) == sorted(set(found))


def test_large_type_fits_in_700_px(desk, window, dataset, screenshot):
    # QGIS sets its size of type by a style sheet, too.
    points = desk.iface.mainWindow().font().pointSizeF()
    go_to(desk, window, dataset, "clean")
    assert window.window.minimumSizeHint().height() < 225
    # By itself, as wide as a user likes.
    window.window.setFloating(True)
    window.window.setStyleSheet(f"QWidget {{ font-size: {2.0 * points}pt; }}")
    try:
        for name in ("clean", "split", "benchmark", "export", "labels"):
            go_to(desk, window, dataset, name)
            window.window.resize(700, 660)
            shown = window.window.tabs.currentWidget()
            desk.wait_steady(lambda shown=shown: (window.window.width(), shown.viewport().width()))
            screenshot(f"dataset-large-{name}", window.window)
            assert window.window.width() == 700
            assert shown.widget().minimumSizeHint().width() <= shown.viewport().width(), name
    finally:
        window.window.setStyleSheet("")
        window.window.setFloating(False)


def test_depth_is_seen_by_colour_blind_people():
    """Lightness grows from near to far: grey alone tells them apart."""
    from terrainav.terrainav_plugin.dataset.picture import depth_colours

    colours = depth_colours(np.linspace(0.0, 1.0, 64)[np.newaxis])[0] / 255.0
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    luminance = linear @ np.array([0.2126, 0.7152, 0.0722])
    assert (np.diff(luminance) > 0.0).all()
