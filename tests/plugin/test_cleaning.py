"""A dataset is cleaned by eye: what the window shows is what cleaning does, by mouse and by keyboard."""

from __future__ import annotations

import shutil
import threading

import numpy as np
import pytest
from qgis.core import QgsApplication, QgsProject, QgsRectangle
from qgis.gui import QgsMapCanvasItem
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtGui import QColor, QPainter
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QDockWidget, QFileDialog, QLabel
from terrainav.terrainav_plugin.dataset_window import clean_tab as cleaning_panel
from terrainav.terrainav_plugin.dataset_window import marks as cleaning_marks

from tests.support.thinning import sampled

LEFT, PLAIN = Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
AREA = "35.14_-89.87_35.131_-89.856_120"


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    """A dataset of the embedded world, of two map types, of which the roadmap decides."""
    from terrainav.core.cli import main

    folder = tmp_path_factory.mktemp("captured") / "fields"
    assert (
        main(
            [
                *("capture", "--coords", AREA, "--map-type", "satellite", "roadmap"),
                *("--image-px", "160", "--data-dir", str(folder)),
            ]
        )
        == 0
    )
    return folder


@pytest.fixture
def dataset(captured, tmp_path):
    """A copy of it, for one test."""
    return shutil.copytree(captured, tmp_path / "fields")


@pytest.fixture
def cleaning(desk):
    """The plugin's part that cleans; its window is closed at the end."""
    datasets = desk.session.datasets
    yield datasets
    desk.wait(lambda: not datasets.busy)
    if datasets.window is not None:
        datasets.window.hide()


@pytest.fixture
def opened(desk, cleaning):
    """Open a dataset in the window and wait until all is there."""

    def open_dataset(folder):
        cleaning.open(folder, "clean")
        desk.wait(lambda: not cleaning.busy)
        return cleaning.cleaning.panel

    return open_dataset


def counted(folder, map_type, threshold):
    """What cleaning itself would reject of a map type."""
    from terrainav.core.dataset.clean import clean

    return next(one for one in clean(folder, threshold, dry_run=True) if one.map_type == map_type)


def marks_of(folder, map_type):
    from terrainav.core.dataset.table import Table

    table = Table.load(folder / map_type / "meta_data.csv")
    return {name for name, mark in zip(table.img_names, table.other.get("rejected", ("",) * len(table))) if mark}


def type_bits(desk, panel, text):
    """Type a threshold and leave the entry."""
    desk.type_text(panel.threshold.lineEdit(), text)
    QTest.keyClick(panel.threshold, Qt.Key.Key_Return)


def middle_bits(panel):
    """A threshold that parts the images in about two halves."""
    return round(float(np.nanmedian(panel.entropies.bits)), 2)


def items_on_map(desk):
    return [item for item in desk.canvas.scene().items() if isinstance(item, QgsMapCanvasItem)]


# --- the entropies are those that cleaning goes by


@pytest.mark.parametrize("threshold", sampled([0.0, 1.0, 2.1, 3.3, 5.0, 6.7, 8.0], 3))
def test_counts_are_those_of_cleaning(captured, threshold):
    from terrainav.terrainav_plugin.dataset_window.entropies import read_entropies

    found = read_entropies(captured)
    assert set(found) == {"satellite", "roadmap"}
    for map_type, one in found.items():
        there = counted(captured, map_type, threshold)
        assert one.rejected(threshold) == there.rejected
        assert (len(one), one.failed, one.by_roadmap) == (there.images, there.failed, there.by_roadmap)
        assert one.suggested == there.suggested
    assert np.array_equal(found["satellite"].bits, found["roadmap"].bits)


def test_rejected_images_are_those_that_cleaning_marks(dataset):
    from terrainav.core.dataset.clean import clean
    from terrainav.terrainav_plugin.dataset_window.entropies import read_entropies

    found = read_entropies(dataset)["satellite"]
    threshold = float(np.median(found.bits))
    clean(dataset, threshold)
    assert {f"{stem}.tif" for stem in found.rejected_stems(threshold)} == marks_of(dataset, "satellite")
    assert read_entropies(dataset)["satellite"].marked == found.rejected(threshold) > 5


def test_published_folders_without_entropies_are_worked_out(tmp_path):
    from terrainav.terrainav_plugin.dataset_window.entropies import read_entropies

    from tests.support.published import write_published

    for name in ("satellite_0", "roadmap_0"):
        write_published(tmp_path / "Memphis" / name, blank={(1, 0)} if "road" in name else (), entropies=False)
    found = read_entropies(tmp_path / "Memphis")
    assert set(found) == {"satellite_0", "roadmap_0"}
    for map_type, one in found.items():
        assert one.rejected(2.1) == counted(tmp_path / "Memphis", map_type, 2.1).rejected == 1
    assert found["satellite_0"].by_roadmap == 6


def test_examples_are_the_images_next_to_the_threshold(captured):
    from terrainav.terrainav_plugin.dataset_window.entropies import read_entropies

    found = read_entropies(captured)["satellite"]
    threshold = float(np.median(found.bits))
    below, above = found.examples(threshold, 4)
    ordered = sorted(found.bits.tolist())
    assert [one.entropy for one in below] == [bits for bits in ordered if bits < threshold][::-1][:4]
    assert [one.entropy for one in above] == [bits for bits in ordered if bits >= threshold][:4]
    assert all(one.path.is_file() for one in (*below, *above))
    assert found.examples(0.0, 4)[0] == []
    assert found.examples(8.0, 4)[1] == []


# --- the window


def test_it_is_a_tab_of_the_panel_and_leaves_the_map_its_room(desk, dataset, opened):
    layers = desk.iface.mainWindow().findChild(QDockWidget, "Layers")
    before = layers.width(), desk.canvas.width()
    opened(dataset)
    window = desk.session.datasets.window
    assert not window.isFloating()
    assert window in desk.iface.mainWindow().tabifiedDockWidgets(desk.dock)
    desk.wait(window.isUserVisible)
    assert (layers.width(), desk.canvas.width()) == before


def test_threshold_is_dragged_typed_and_moved_by_keys(desk, dataset, opened, screenshot):
    panel = opened(dataset)
    histogram, bars = panel.charts
    total = len(panel.entropies)
    assert f"of {total} images kept" in panel.findChild(QLabel, "counts").text()
    # Its numbers are bold, and no markup is to be read.
    assert panel.counts.textFormat() == Qt.TextFormat.RichText

    # Dragged with the mouse over the histogram.
    frame = histogram.frame()
    y = int((frame.top + frame.bottom) / 2)
    QTest.mousePress(histogram, LEFT, PLAIN, QPoint(round(histogram.axis_px(2.1)), y))
    for bits in (3.0, 4.0, 5.0):
        QTest.mouseMove(histogram, QPoint(round(histogram.axis_px(bits)), y))
    QTest.mouseRelease(histogram, LEFT, PLAIN, QPoint(round(histogram.axis_px(5.0)), y))
    a_pixel = 8.0 / (frame.right - frame.left)
    assert panel.threshold.value() == pytest.approx(5.0, abs=a_pixel)
    rejected = counted(dataset, "satellite", panel.threshold.value()).rejected
    assert f"<b>{rejected}</b> rejected" in panel.counts.text()
    assert bars.threshold == panel.threshold.value()
    # What has the keyboard is framed, and not filled: the paper stays as light as it was.
    QApplication.setActiveWindow(histogram.window())
    histogram.setFocus()
    desk.wait(histogram.hasFocus)
    at = histogram.frame().rect.topRight().toPoint() + QPoint(-4, 4)
    assert histogram.grab().toImage().pixelColor(at).lightness() > 200
    # Beyond the plot it stays in range.
    QTest.mouseClick(histogram, LEFT, PLAIN, QPoint(histogram.width() - 1, y))
    assert panel.threshold.value() == 8.0

    # Typed, with its unit.
    type_bits(desk, panel, "3.25")
    assert panel.threshold.value() == histogram.threshold == 3.25
    assert panel.threshold.suffix().strip() == "bits"

    # By keys, with the line in focus.
    histogram.setFocus()
    for key, modifier, expected in (
        (Qt.Key.Key_Right, PLAIN, 3.26),
        (Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier, 3.16),
        (Qt.Key.Key_PageUp, PLAIN, 3.66),
        (Qt.Key.Key_Home, PLAIN, 0.0),
        (Qt.Key.Key_Left, PLAIN, 0.0),
        (Qt.Key.Key_End, PLAIN, 8.0),
    ):
        QTest.keyClick(histogram, key, modifier)
        assert panel.threshold.value() == pytest.approx(expected)
    assert "8.00" in histogram.accessibleName()

    # The other chart: the threshold is a height there.
    panel.tabs.setCurrentIndex(1)
    desk.wait(bars.isVisible)
    QTest.mouseClick(bars, LEFT, PLAIN, QPoint(bars.width() // 2, round(bars.axis_px(4.0))))
    assert panel.threshold.value() == pytest.approx(4.0, abs=8.0 / (bars.frame().bottom - bars.frame().top))

    screenshot("entropy-bars")


def with_entropies(folder, bits):
    """A dataset's tables with other entropies."""
    from dataclasses import replace

    from terrainav.core.dataset.table import Table

    for map_type in ("satellite", "roadmap"):
        path = folder / map_type / "meta_data.csv"
        table = Table.load(path)
        replace(table, entropies=np.resize(bits, len(table))).save(path)


def test_suggest_sets_a_threshold_between_two_groups_and_says_why(desk, dataset, opened, screenshot):
    with_entropies(dataset, [1.0, 1.1, 4.0, 4.1, 4.2, 3.9, 1.2])
    panel = opened(dataset)
    assert panel.entropies.groups
    desk.click(panel.suggest)
    assert panel.threshold.value() == pytest.approx(panel.entropies.suggested, abs=0.005)
    text, below = panel.reason.text(), panel.entropies.rejected(panel.entropies.suggested)
    assert panel.reason.isVisible()
    assert "two groups" in text
    assert f"{below} of {len(panel.entropies)} images" in text
    assert "a large part" in text
    screenshot("suggest-two-groups")
    # Said of this threshold alone.
    panel.threshold.setValue(3.0)
    assert not panel.reason.isVisible()


def test_suggest_leaves_the_threshold_where_nothing_stands_out(desk, dataset, opened, screenshot):
    with_entropies(dataset, np.linspace(4.0, 5.0, 97))
    panel = opened(dataset)
    before = panel.threshold.value()
    desk.click(panel.suggest)
    assert panel.threshold.value() == before
    rejected = panel.entropies.rejected(panel.entropies.suggested)
    assert "form one group: nothing stands out" in panel.reason.text()
    assert f"{rejected} of {len(panel.entropies)} images" in panel.reason.text()
    screenshot("suggest-one-group")


def test_histogram_shows_every_image_on_its_side_of_the_line(desk, dataset, opened):
    from terrainav.terrainav_plugin.dataset_window.charts import KEPT, REJECTED

    panel = opened(dataset)
    histogram = panel.charts[0]
    assert histogram.counts.sum() == len(panel.entropies)
    type_bits(desk, panel, str(middle_bits(panel)))
    image = histogram.grab().toImage()
    line = histogram.axis_px(panel.threshold.value())
    ratio = image.devicePixelRatio()
    sides = {QColor(KEPT).rgb(): set(), QColor(REJECTED).rgb(): set()}
    for x in range(image.width()):
        for y in range(image.height()):
            if image.pixel(x, y) in sides:
                sides[image.pixel(x, y)].add(np.sign(x / ratio - line))
    assert list(sides.values()) == [{1.0}, {-1.0}]


def test_chart_of_a_hundred_thousand_images_shows_the_only_poor_one(qtbot):
    from terrainav.terrainav_plugin.dataset_window.charts import REJECTED, Bars, Histogram

    bits = np.full(100_000, 6.5)
    bits[70_000] = 0.7
    for chart in (Histogram(), Bars()):
        qtbot.addWidget(chart)
        chart.resize(600, 300)
        chart.show_bits(bits, None)
        chart.show_threshold(2.1)
        image = chart.grab().toImage()
        found = sum(image.pixel(x, y) == REJECTED.rgb() for x in range(image.width()) for y in range(image.height()))
        assert found > 0, chart.objectName()


@pytest.mark.parametrize("size", [(240, 140), (420, 190), (900, 500)])
def test_labels_of_axes_stand_apart(qtbot, monkeypatch, size):
    from terrainav.terrainav_plugin.dataset_window.charts import Bars, Histogram

    drawn = []

    class Painter(QPainter):
        def drawText(self, at, text):
            drawn.append((text, self.worldTransform().map(at)))
            super().drawText(at, text)

    monkeypatch.setattr("terrainav.terrainav_plugin.dataset_window.charts.QPainter", Painter)
    for chart in (Histogram(), Bars()):
        qtbot.addWidget(chart)
        chart.resize(*size)
        chart.show_bits(np.tile(np.linspace(0.0, 8.0, 1000), 1000), None)
        drawn.clear()
        chart.grab()
        frame, metrics = chart.frame(), chart.fontMetrics()
        numbers = [(text, at) for text, at in drawn if text.replace(",", "").isdigit()]
        left = sorted(
            at.y() for _, at in numbers if at.x() < frame.left and at.y() <= frame.bottom + metrics.ascent() / 2
        )
        assert len(left) >= 2
        assert np.diff(left).min() >= metrics.ascent()
        below = sorted(
            (at.x(), at.x() + metrics.horizontalAdvance(text))
            for text, at in numbers
            if at.y() > frame.bottom + metrics.ascent() / 2
        )
        assert len(below) >= 2
        assert all(end < start for (_, end), (start, _) in zip(below, below[1:]))


def test_examples_show_their_pictures_and_lead_to_the_map(desk, dataset, opened):
    desk.session.missions.open_dataset(dataset)
    desk.wait(lambda: not desk.session.missions.busy)
    panel = opened(dataset)
    type_bits(desk, panel, str(middle_bits(panel)))
    desk.wait(lambda: not desk.session.datasets.busy)
    for button in (*panel.strip.below, *panel.strip.above):
        assert not button.icon().isNull()
        assert button.isEnabled()
    assert all(float(button.text()) < panel.threshold.value() for button in panel.strip.below)
    assert all(float(button.text()) >= panel.threshold.value() for button in panel.strip.above)
    before = desk.canvas.extent()
    # By keyboard, also where nothing is crossed out.
    QTest.mouseClick(panel.on_map, LEFT)
    button = panel.strip.below[0]
    button.setFocus()
    QTest.keyClick(button, Qt.Key.Key_Space)
    desk.wait(lambda: not desk.session.datasets.busy)
    QTest.mouseClick(panel.on_map, LEFT)
    desk.wait(lambda: not desk.session.datasets.busy)
    assert desk.canvas.extent().width() < before.width() / 2
    row = panel.strip._rows[button]
    footprint = next(
        feature
        for feature in desk.layer("Captured images").getFeatures()
        if feature["name"] == panel.entropies.stems[row]
    )
    layer = desk.layer("Captured images")
    box = desk.canvas.mapSettings().layerExtentToOutputExtent(layer, footprint.geometry().boundingBox())
    assert desk.canvas.extent().contains(box)


# --- on the map


def is_crossed(colour):
    """Whether a line of a cross goes through; where lines meet their colours are mixed, to within rounding."""
    from terrainav.terrainav_plugin.dataset_window.charts import REJECTED

    parts = zip(colour.getRgb()[:3], REJECTED.getRgb()[:3])
    return colour.alpha() > 0 and all(abs(one - other) <= 2 for one, other in parts)


def test_rejected_images_are_crossed_out_on_the_map_while_the_window_is_open(desk, dataset, opened, screenshot):
    desk.session.missions.open_dataset(dataset)
    desk.wait(lambda: not desk.session.missions.busy)
    desk.canvas.waitWhileRendering()
    panel, cleaning = opened(dataset), desk.session.datasets.cleaning
    type_bits(desk, panel, str(middle_bits(panel)))
    desk.wait(lambda: not desk.session.datasets.busy)
    # The crosses are one item.
    before = len(items_on_map(desk)) - 1
    assert cleaning.marks.drawn == panel.entropies.rejected(panel.threshold.value()) > 5
    screenshot("entropy-panel")

    layer = desk.layer("Captured images")
    rejected = set(panel.entropies.rejected_stems(panel.threshold.value()))
    image = cleaning.marks.item.image
    extent = desk.canvas.mapSettings().visibleExtent()
    seen = 0
    for feature in layer.getFeatures():
        centre = desk.canvas.mapSettings().layerToMapCoordinates(layer, feature.geometry().centroid().asPoint())
        x = int((centre.x() - extent.xMinimum()) / extent.width() * image.width())
        y = int((extent.yMaximum() - centre.y()) / extent.height() * image.height())
        if 0 < x < image.width() and 0 < y < image.height():
            seen += 1
            # Crossed out: the middle is where the lines meet.
            assert is_crossed(image.pixelColor(x, y)) == (feature["name"] in rejected)
    assert seen > 50

    # With the map, in any projection.
    desk.canvas.setExtent(QgsRectangle(extent.center().x(), extent.yMinimum(), extent.xMaximum(), extent.yMaximum()))
    desk.wait(lambda: not desk.session.datasets.busy)
    assert cleaning.marks.item.image != image
    QTest.mouseClick(panel.on_map, LEFT)
    assert len(items_on_map(desk)) == before
    QTest.mouseClick(panel.on_map, LEFT)
    desk.wait(lambda: not desk.session.datasets.busy and len(items_on_map(desk)) == before + 1)
    desk.session.datasets.window.hide()
    desk.wait(lambda: cleaning.marks.item is None)


def test_crosses_follow_outlines_of_any_shape_and_projection():
    from terrainav.terrainav_plugin.dataset.footprints import Outlines
    from terrainav.terrainav_plugin.dataset_window.marks import MapExtent, draw

    ring_x = [-89.9, -89.8, -89.8, -89.9, -89.9, 10.0, 10.1, 10.1, 10.0, 10.0]
    ring_y = [35.2, 35.2, 35.1, 35.1, 35.2, 50.1, 50.1, 50.0, 50.0, 50.1]
    outlines = Outlines(("a", "b"), np.array(ring_x), np.array(ring_y), np.array([0, 5, 10]), np.array([0, 1]))
    from qgis.core import QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsPointXY

    target = QgsCoordinateReferenceSystem("EPSG:32616")
    there = outlines.projected(target.toWkt())
    transform = QgsCoordinateTransform(QgsCoordinateReferenceSystem("EPSG:4326"), target, QgsProject.instance())
    for index in range(5):
        place = transform.transform(QgsPointXY(ring_x[index], ring_y[index]))
        assert (there.x[index], there.y[index]) == pytest.approx((place.x(), place.y()), abs=1e-3)
    west, south, east, north = there.bounds("a")
    assert there.bounds("c") is None
    view = MapExtent(west, south, east, north, (east - west) / 200.0, 2.0)
    image = draw(there, ["a"], view)
    assert image.width() == 400
    assert image.pixelColor(200, image.height() // 2).alpha() == 255
    assert draw(there, ["b"], view).pixelColor(200, image.height() // 2).alpha() == 0


# --- the buttons


def test_mark_move_and_undo(desk, dataset, opened, screenshot):
    panel = opened(dataset)
    before = {path.relative_to(dataset) for path in dataset.rglob("*.tif")}
    tables = {path: path.read_bytes() for path in dataset.glob("*/meta_data.csv")}
    type_bits(desk, panel, str(middle_bits(panel)))
    expected = counted(dataset, "satellite", panel.threshold.value()).rejected
    desk.click(panel.buttons["mark"])
    assert not any(button.isEnabled() for button in panel.buttons.values())
    assert not desk.session.datasets.window.folder.isEnabled()
    desk.wait(lambda: not desk.session.datasets.busy)
    assert len(marks_of(dataset, "satellite")) == expected == len(marks_of(dataset, "roadmap"))
    assert {path.relative_to(dataset) for path in dataset.rglob("*.tif")} == before
    assert (
        f"fields: {2 * expected} of {2 * len(panel.entropies)} images of 2 map types are marked as rejected."
        in desk.messages()
    )
    assert f"{expected} images marked" in panel.notes.text()

    # By keyboard.
    panel.activateWindow()
    panel.buttons["move"].setFocus()
    QTest.keyClick(panel.buttons["move"], Qt.Key.Key_Space)
    desk.wait(lambda: not desk.session.datasets.busy)
    assert len(list(dataset.glob("satellite/rejected/*.tif"))) == expected
    assert any(f"{2 * expected} moved away." in text for text in desk.messages())
    # Pictures of what was moved are found where they are.
    assert all(not button.icon().isNull() for button in panel.strip.below)
    assert panel.strip.below[0].toolTip().count("\n") == 1
    screenshot("entropy-moved", panel)

    desk.click(panel.buttons["undo"])
    desk.wait(lambda: not desk.session.datasets.busy)
    assert {path.relative_to(dataset) for path in dataset.rglob("*.tif")} == before
    assert {path: path.read_bytes() for path in dataset.glob("*/meta_data.csv")} == tables
    assert panel.notes.text().endswith(".")
    assert "Cleaned before" not in panel.notes.text()


@pytest.mark.thorough
def test_mosaic_is_offered_anew_where_images_have_moved(desk, dataset, opened):
    desk.session.missions.open_dataset(dataset)
    desk.wait(lambda: not desk.session.missions.busy)
    panel = opened(dataset)
    type_bits(desk, panel, str(middle_bits(panel)))
    desk.click(panel.buttons["move"])
    desk.wait(lambda: not desk.session.datasets.busy)
    desk.click(desk.buttons_in_message_bar()["Update mosaic"])
    desk.wait(lambda: not desk.session.missions.busy)
    assert "rejected" not in (dataset / "satellite.vrt").read_text()


def test_what_goes_wrong_is_said_and_changes_nothing(desk, dataset, opened, tmp_path):
    panel = opened(tmp_path)
    assert "is not a dataset" in panel.charts[0]._hint
    assert not any(button.isEnabled() for button in panel.buttons.values())
    panel = opened(dataset)
    assert panel.entropies is not None
    # Lost after it was read.
    next(dataset.glob("satellite/*.tif")).unlink()
    tables = {path: path.read_bytes() for path in dataset.glob("*/meta_data.csv")}
    type_bits(desk, panel, "8")
    desk.click(panel.buttons["mark"])
    desk.wait(lambda: not desk.session.datasets.busy)
    assert any("is not there" in text for text in desk.messages())
    assert {path: path.read_bytes() for path in dataset.glob("*/meta_data.csv")} == tables


def test_what_is_shown_is_what_is_there_after_something_went_wrong(desk, dataset, opened):
    panel = opened(dataset)
    shutil.rmtree(dataset)
    desk.click(panel.buttons["mark"])
    desk.wait(lambda: not desk.session.datasets.busy)
    assert any("cannot be read" in text for text in desk.messages())
    assert panel.entropies is None
    assert "cannot be read" in panel.charts[0]._hint
    assert not any(button.isEnabled() for button in panel.buttons.values())


def test_window_closed_while_it_works_stays_closed(desk, dataset, opened):
    panel, cleaning = opened(dataset), desk.session.datasets.cleaning
    desk.click(panel.buttons["mark"])
    desk.session.datasets.window.close()
    desk.wait(lambda: not desk.session.datasets.busy)
    assert not panel.isVisible()
    assert cleaning.marks.item is None


def test_a_dataset_that_cannot_be_written_is_left_as_it_is(desk, dataset, opened, monkeypatch):
    from terrainav.core.dataset.table import Table
    from terrainav.core.errors import OutputError

    def full(*_):
        raise OutputError("folder satellite: cannot write meta_data.csv (Read-only file system)")

    panel = opened(dataset)
    monkeypatch.setattr(Table, "save", full)
    type_bits(desk, panel, str(middle_bits(panel)))
    threshold = panel.threshold.value()
    desk.click(panel.buttons["move"])
    desk.wait(lambda: not desk.session.datasets.busy)
    assert any("Read-only file system" in text for text in desk.messages())
    assert not list(dataset.rglob("rejected"))
    assert panel.notes.text().endswith("of them.")
    assert panel.threshold.value() == threshold
    assert all(button.isEnabled() for button in panel.buttons.values())


def test_a_folder_that_is_no_more_entered_is_not_cleaned(desk, dataset, opened):
    panel, cleaning = opened(dataset), desk.session.datasets.cleaning
    desk.type_text(desk.session.datasets.window.folder.lineEdit(), "")
    desk.wait(lambda: not desk.session.datasets.busy)
    assert panel.entropies is None
    assert panel.charts[0]._hint == "Choose the folder of a dataset."
    assert cleaning.marks.item is None
    assert not any(button.isEnabled() for button in panel.buttons.values())
    # Nobody's home.
    desk.type_text(desk.session.datasets.window.folder.lineEdit(), "~nobody-of-this-name")
    desk.wait(lambda: not desk.session.datasets.busy)
    assert "~nobody-of-this-name: cannot be read" in panel.charts[0]._hint


def test_focus_comes_back_when_the_work_is_done(desk, dataset, opened):
    panel = opened(dataset)
    panel.activateWindow()
    panel.buttons["mark"].setFocus()
    QTest.keyClick(panel.buttons["mark"], Qt.Key.Key_Space)
    assert panel.window().focusWidget() is not panel.buttons["mark"]
    desk.wait(lambda: not desk.session.datasets.busy)
    assert panel.window().focusWidget() is panel.buttons["mark"]
    # But not from where somebody types.
    edit = desk.session.datasets.window.folder.lineEdit()
    desk.type_text(edit, str(dataset))
    desk.wait(lambda: not desk.session.datasets.busy)
    assert panel.window().focusWidget() is edit


def test_everything_is_reached_by_tab(desk, dataset, opened):
    panel = opened(dataset)
    type_bits(desk, panel, str(middle_bits(panel)))
    desk.wait(lambda: not desk.session.datasets.busy)
    panel.activateWindow()
    first = desk.session.datasets.window.folder.lineEdit()
    first.setFocus()
    order = [first]
    # To its end, where the keyboard goes on to the rest of QGIS's window.
    while desk.session.datasets.window.isAncestorOf(order[-1]):
        QTest.keyClick(order[-1], Qt.Key.Key_Tab)
        order.append(panel.window().focusWidget())
        assert len(order) < 40
    lines = (
        [first, panel.map_type, panel.on_map, panel.tabs.tabBar(), panel.tabs.currentWidget()],
        [panel.threshold, panel.suggest, panel.save],
        [*panel.strip.below[::-1], *panel.strip.above],
        [*(panel.buttons[action] for action in ("undo", "mark", "move"))],
    )
    expected = [widget for line in lines for widget in line]
    assert [widget for widget in order[:-1] if widget in expected] == expected


def test_beside_other_panels_it_is_as_narrow_and_low_as_they_are(desk, dataset, opened):
    opened(dataset)
    least = desk.session.datasets.window.widget().minimumSizeHint()
    assert least.width() <= 200
    assert least.height() <= 200


def test_datasets_without_footprints_say_that_they_are_not_on_the_map(desk, dataset, opened):
    (dataset / "footprints.geojson").unlink()
    panel = opened(dataset)
    assert not panel.on_map.isEnabled()
    assert "no footprints" in panel.on_map.toolTip()
    before = desk.canvas.extent()
    desk.click(panel.strip.above[0])
    desk.wait(lambda: not desk.session.datasets.busy)
    assert any("no footprints" in text for text in desk.messages())
    assert desk.canvas.extent() == before


def test_reading_that_takes_long_shows_how_far_it_is(desk, captured, tmp_path, cleaning):
    from tests.support.published import write_published

    write_published(tmp_path / "Memphis" / "satellite_0", entropies=False)
    cleaning.open(captured)
    desk.wait(lambda: not desk.session.datasets.busy)
    shown = []
    bar = cleaning.window.bar
    bar.valueChanged.connect(lambda percent: shown.append((percent, bar.isVisible())))
    cleaning.open(tmp_path / "Memphis")
    desk.wait(lambda: not desk.session.datasets.busy)
    assert shown
    assert all(visible for _, visible in shown)
    assert not bar.isVisible()
    assert len(cleaning.cleaning.panel.entropies) == 6


def test_map_types_and_folders_are_chosen(desk, dataset, captured, opened):
    panel = opened(dataset)
    assert [panel.map_type.itemText(index) for index in range(panel.map_type.count())] == [
        "Roadmap",
        "Satellite",
    ]
    panel.map_type.setFocus()
    QTest.keyClick(panel.map_type, Qt.Key.Key_Down)
    QTest.keyClick(panel.map_type, Qt.Key.Key_Up)
    other = panel.map_type.findData("satellite")
    panel.map_type.setCurrentIndex(other)
    panel.map_type.activated.emit(other)
    assert "roadmap decides" in panel.notes.text()
    edit = desk.session.datasets.window.folder.lineEdit()
    desk.type_text(edit, str(captured))
    QTest.keyClick(edit, Qt.Key.Key_Return)
    desk.wait(lambda: not desk.session.datasets.busy)
    assert desk.session.datasets.folder == captured
    assert panel.entropies.folder == captured / "satellite"


def test_capture_s_row_menu_and_toolbar_lead_to_its_dataset(desk, cleaning, qtbot):
    desk.enter_coarse_mission()
    desk.click(desk.dock.capture)
    desk.wait(lambda: not desk.session.runs.idle)
    desk.wait(lambda: desk.session.runs.idle)
    (run,) = desk.session.runs.runs
    desk.click(desk.session.run_panel.row(run).buttons["clean"])
    desk.wait(lambda: not desk.session.datasets.busy)
    assert cleaning.cleaning.panel.isVisible()
    assert desk.session.datasets.folder == desk.folder
    assert len(cleaning.cleaning.panel.entropies) == 36
    desk.session.datasets.window.hide()
    desk.session.datasets.folder = None
    desk.plugin.actions["clean_dataset"].trigger()
    desk.wait(lambda: not desk.session.datasets.busy)
    assert cleaning.cleaning.panel.isVisible()
    assert desk.session.datasets.folder == desk.folder


def test_charts_are_saved(desk, dataset, opened, tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    panel = opened(dataset)
    target = tmp_path / "charts"
    target.mkdir()
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(target))
    assert panel.save.text() == "Save charts…"
    desk.click(panel.save)
    desk.wait(lambda: not desk.session.datasets.busy)
    written = sorted(target.iterdir())
    assert len(written) >= 4
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)
    assert any(f"{len(written)} charts" in text for text in desk.messages())


# --- never held up


def test_nothing_long_is_done_on_the_main_thread(desk, dataset, opened, monkeypatch):
    """Tables, footprints and pictures are read, and crosses drawn, beside it: for any number of images."""
    from terrainav.terrainav_plugin.dataset_window import entropies

    done = {}

    def watch(module, name):
        original = getattr(module, name)

        def watched(*arguments, **more):
            done.setdefault(name, set()).add(threading.current_thread() is threading.main_thread())
            return original(*arguments, **more)

        monkeypatch.setattr(module, name, watched)

    watch(entropies, "deciding_entropies")
    watch(entropies, "otsu")
    watch(cleaning_marks, "read_outlines")
    watch(cleaning_marks, "draw")
    watch(cleaning_panel, "read_picture")
    watch(entropies.Entropies, "rejected_stems")
    watch(entropies.Entropies, "examples")
    desk.look_at("EPSG:4326", (-89.88, 35.12, -89.85, 35.15))
    panel = opened(dataset)
    type_bits(desk, panel, str(middle_bits(panel)))
    desk.wait(lambda: not desk.session.datasets.busy)
    assert done == {
        name: {False}
        for name in (
            "deciding_entropies",
            "otsu",
            "read_outlines",
            "draw",
            "read_picture",
            "rejected_stems",
            "examples",
        )
    }


def test_examples_and_crosses_wait_until_the_threshold_rests(desk, dataset, opened, monkeypatch):
    panel, cleaning = opened(dataset), desk.session.datasets.cleaning
    asked = []
    monkeypatch.setattr(cleaning.marks, "show", lambda *_: asked.append(panel.threshold.value()))
    for bits in np.linspace(1.0, 3.0, 40):
        panel.threshold.setValue(float(bits))
    desk.wait(lambda: not desk.session.datasets.busy)
    assert asked == [3.0]


@pytest.mark.thorough
def test_dark_theme(desk, dataset, opened, screenshot):
    """Axes and text stand out from what is behind them."""
    application, theme = QApplication.instance(), QgsApplication.themeName()
    palette = application.palette()
    QgsApplication.setUITheme("Night Mapping")
    try:
        panel = opened(dataset)
        for number, chart in enumerate(panel.charts):
            panel.tabs.setCurrentIndex(number)
            desk.wait(chart.isVisible)
            image = chart.grab().toImage()
            shades = [image.pixelColor(x, y).lightness() for x in range(image.width()) for y in range(image.height())]
            assert np.median(shades) < 100
            assert sum(shade > 150 for shade in shades) > 200
            screenshot(f"entropy-dark-{number}", panel)
    finally:
        QgsApplication.setUITheme(theme)
        application.setPalette(palette)
        application.processEvents()
