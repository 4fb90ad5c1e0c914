"""Sources of one's own: added by URL, with their limits, captured, and captured again without the network."""

from __future__ import annotations

import importlib
import re
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from qgis.core import QgsProject, QgsVectorLayer
from qgis.PyQt.QtCore import QTimer
from qgis.PyQt.QtWidgets import QApplication, QDialogButtonBox, QFileDialog, QMessageBox
from terrainav.core.imagery.catalogue import user_sources
from terrainav.terrainav_plugin.panel.options_page import CacheDialog
from terrainav.terrainav_plugin.panel.source_dialogs import AddSourceDialog

from tests.plugin.steps import PATIENCE_MS
from tests.support.json_services import answer_of, map_service
from tests.support.patterns import decode_position, positions, to_bytes
from tests.support.services import ServiceServer, wms_document
from tests.support.tileserver import TileServer

OK = QDialogButtonBox.StandardButton.Ok


@pytest.fixture(autouse=True)
def own_folders(tmp_path, monkeypatch):
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "cache"))


@pytest.fixture
def dialog(qtbot, iface):
    dialog = AddSourceDialog(iface.mainWindow())
    dialog.show()
    yield dialog
    dialog.close()
    dialog.deleteLater()


@pytest.fixture
def source_list(desk):
    """The chooser, without what other tests kept."""
    desk.session.source_list.refresh()
    yield desk
    desk.session.source_list.refresh()


def in_dialog(desk, kind, act):
    """Do something in the dialog that comes next; what is wrong there is raised where it was opened."""
    errors = []

    def look():
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, kind):
            QTimer.singleShot(20, look)
            return
        try:
            act(dialog)
        except BaseException as wrong:  # noqa: BLE001  raised again where the dialog was opened
            errors.append(wrong)
            dialog.reject()

    QTimer.singleShot(0, look)
    return errors


def menu_entry(desk, text):
    return next(action for action in desk.form.imagery.more.menu().actions() if action.text() == text)


def titles(desk):
    return [desk.form.source.itemText(index) for index in range(desk.form.source.count())]


def capture(desk, folder):
    desk.form.folder.setFilePath(str(folder))
    desk.wait_planned()
    desk.click(desk.dock.capture)
    desk.wait(lambda: desk.session.runs.task is not None)
    desk.wait_for_run()


@pytest.mark.parametrize(
    ("url", "field", "words"),
    [
        ("https://tiles.example.org/{z}/{x}.png", "url", "without {y}"),
        ("https://tiles.example.org/{z}/{x}/{y}.png?key=abcdef", "url", "write key={key}"),
        ("https://me:secret@tiles.example.org/{z}/{x}/{y}.png", "url", "no credentials"),
        ("https://tiles.example.org/{z}/{x}/{y}/{nonsense}.png", "url", "{nonsense} is unknown"),
    ],
)
def test_wrong_url_is_marked_while_it_is_typed(dialog, url, field, words):
    dialog.url.setText(url)
    assert words in dialog.marks.message(field)
    assert not dialog.buttons.button(OK).isEnabled()
    dialog.url.setText("https://tiles.example.org/{z}/{x}/{y}.png")
    assert dialog.marks.first_message() == ""
    assert dialog.buttons.button(OK).isEnabled()


def test_empty_dialog_says_nothing_and_cannot_be_accepted(dialog):
    assert dialog.marks.first_message() == ""
    assert not dialog.buttons.button(OK).isEnabled()


def test_name_is_suggested_by_the_host_until_one_is_typed(dialog, qtbot):
    dialog.url.setText("https://{s}.tiles.example.org/{z}/{x}/{y}.png")
    assert dialog.name.text() == "tiles-example-org"
    dialog.name.clear()
    qtbot.keyClicks(dialog.name, "mine")
    dialog.url.setText("https://other.example.org/{z}/{x}/{y}.png")
    assert dialog.name.text() == "mine"
    dialog.name.clear()
    qtbot.keyClicks(dialog.name, "osm")
    assert "taken" in dialog.marks.message("name")


def test_limits_are_those_that_are_entered(dialog, screenshot):
    dialog.url.setText("https://tiles.example.org/{z}/{x}/{y}.png")
    dialog.max_zoom.setValue(18)
    dialog.connections.setValue(3)
    dialog.rate.setValue(7.0)
    dialog.cached.setChecked(False)
    for words in ("zoom 0 to 18", "3 connections", "7 requests a second", "tiles are not cached"):
        assert words in dialog.limits.text()
    screenshot("add-source", dialog)


def test_providers_own_terms_hold_for_their_hosts(dialog):
    dialog.url.setText("https://tile.openstreetmap.org/{z}/{x}/{y}.png")
    assert "At most 250 requests" in dialog.limits.text()


def test_dates_are_asked_for_where_the_url_has_them(dialog):
    dialog.url.setText("https://tiles.example.org/{z}/{x}/{y}.png")
    assert not dialog.default_date.isVisible()
    dialog.url.setText("https://tiles.example.org/{date}/{z}/{x}/{y}.png")
    assert dialog.default_date.isVisible()


def find(dialog, qtbot, text):
    """Type an address, and wait for what the server tells."""
    dialog.url.setText(text)
    assert not dialog.buttons.button(OK).isEnabled()
    dialog.find_layers.click()
    qtbot.waitUntil(lambda: dialog._task is None, timeout=PATIENCE_MS)


def test_arcgis_service_by_its_address_shows_a_tile_and_is_kept(dialog, qtbot, screenshot):
    base = "/arcgis/rest/services/Ortho/MapServer"

    def answer(path, _query):
        found = re.fullmatch(rf"{base}/tile/(\d+)/(\d+)/(\d+)", path)
        if found:
            zoom, row, column = map(int, found.groups())
            return 200, "image/png", to_bytes(positions("satellite", zoom, column, row, 256), "png")
        return answer_of(map_service()) if path == base else (404, "text/plain", b"")

    with ServiceServer(answer) as server:
        find(dialog, qtbot, server.url + base)
        assert "zoom 0 to 19" in dialog.limits.text()
        assert dialog.title.placeholderText() == "Orthophotos 2023"
        assert not dialog.max_zoom.isVisible()
        dialog.test.click()
        qtbot.waitUntil(lambda: dialog._task is None, timeout=PATIENCE_MS)
        for words in ("256 x 256 px, PNG", "Zoom 0 to 19", "Survey of Somewhere", " s."):
            assert words in dialog.about_tile.text()
        assert re.search(r"/tile/16/\d+/\d+$", server.asked[-1])
        screenshot("add-service", dialog)
        dialog.accept()
    kept = next(entry for entry in user_sources() if entry.name == dialog.added)
    assert kept.urls[""].endswith(f"{base}/tile/{{z}}/{{y}}/{{x}}")
    assert (kept.title, kept.attribution) == ("Orthophotos 2023", "Survey of Somewhere")
    assert kept.policy.max_connections == 4


def test_layers_of_a_wms_are_listed_with_their_systems_and_one_is_kept(dialog, qtbot, screenshot):
    pytest.importorskip("owslib")
    with warnings.catch_warnings():
        # It imports a module that Python is going to drop; that is for it to change.
        warnings.simplefilter("ignore", DeprecationWarning)
        importlib.import_module("owslib.wms")
    layers = "".join(
        f"<Layer><Name>{name}</Name><Title>{title}</Title></Layer>" for name, title in (("a", "Ortho"), ("b", "Plan"))
    )
    systems = "<CRS>EPSG:3857</CRS><CRS>EPSG:25832</CRS>"

    with ServiceServer() as server:
        all_layers = f"<Layer><Title>All</Title>{systems}{layers}</Layer>"
        document = wms_document("1.3.0", f"{server.url}/wms?", all_layers)
        server.answer = lambda *_: (200, "text/xml", document)
        find(dialog, qtbot, f"{server.url}/wms")
        assert dialog.notice.text() == "2 layers"
        listed = [dialog.layers.item(row).text() for row in range(dialog.layers.count())]
        assert listed == ["Ortho · EPSG:3857, EPSG:25832", "Plan · EPSG:3857, EPSG:25832"]
        assert not dialog.buttons.button(OK).isEnabled()
        dialog.layers.setCurrentRow(1)
        qtbot.waitUntil(lambda: dialog._task is None, timeout=PATIENCE_MS)
        screenshot("add-wms", dialog)
        assert "EPSG:3857" in dialog._entry.urls[""]
        dialog.system.setCurrentIndex(dialog.system.findData("EPSG:25832"))
        qtbot.waitUntil(lambda: dialog._task is None, timeout=PATIENCE_MS)
        dialog.accept()
    kept = next(entry for entry in user_sources() if entry.name == dialog.added)
    assert kept.plane.crs == "EPSG:25832"
    assert "LAYERS=b" in kept.urls[""]


def test_what_a_server_answers_amiss_is_one_line(dialog, qtbot):
    with ServiceServer(lambda *_: (200, "text/html", b"<title>Shop</title>")) as server:
        find(dialog, qtbot, f"{server.url}/shop")
        assert "no service known here" in dialog.notice.text()
        assert "\n" not in dialog.notice.text()
        assert not dialog.buttons.button(OK).isEnabled()
        template = f"{server.url}/{{z}}/{{x}}/{{y}}.png"
        dialog.url.setText(template)
        assert dialog.notice.text() == ""
        dialog.test.click()
        qtbot.waitUntil(lambda: dialog._task is None, timeout=PATIENCE_MS)
        assert "tile" in dialog.notice.text()
        assert not dialog.tile.isVisible()
    # A source is kept whether or not its server answers today.
    assert dialog.buttons.button(OK).isEnabled()


def test_dialog_that_is_closed_asks_no_more(dialog, qtbot):
    gate = threading.Event()

    def answer(*_):
        gate.wait(20.0)
        return 200, "text/html", b""

    with ServiceServer(answer) as server:
        dialog.url.setText(f"{server.url}/wms")
        dialog.find_layers.click()
        qtbot.waitUntil(lambda: bool(server.asked), timeout=PATIENCE_MS)
        dialog.reject()
        assert dialog._task is None
        gate.set()


def test_source_by_url_is_captured_and_again_without_the_network(source_list, tmp_path, screenshot):
    """Add, see the limits, capture, take the server away, capture the same ground into another folder."""
    desk = source_list

    def fill(dialog):
        desk.type_text(dialog.url, server.url_template)
        desk.type_text(dialog.name, "my-tiles")
        desk.type_text(dialog.title, "My tiles")
        desk.type_text(dialog.attribution, "© Me")
        desk.type_text(dialog.licence, "CC BY 4.0")
        dialog.max_zoom.setValue(19)
        dialog.rate.setValue(10_000.0)
        desk.click(dialog.buttons.button(OK))

    with TileServer() as server:
        errors = in_dialog(desk, AddSourceDialog, fill)
        menu_entry(desk, "Add source by URL…").trigger()
        assert errors == []
        assert [entry.name for entry in user_sources()] == ["my-tiles"]
        assert desk.form.source.currentText() == "My tiles"
        assert "zoom 0 to 19" in desk.form.imagery.limits.text()
        assert "CC BY 4.0" in desk.form.imagery.limits.text()
        desk.enter_coarse_mission()
        screenshot("own-source")
        capture(desk, tmp_path / "first")
        asked = sum(server.requests.values())
        assert asked == desk.session.planned.plan.requests
    # The server is gone now.
    capture(desk, tmp_path / "second")
    first, second = (sorted((tmp_path / name / "satellite").glob("*.tif")) for name in ("first", "second"))
    assert len(second) == len(desk.session.planned.plan)
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]
    shown = np.moveaxis(gdal.Open(str(second[0])).ReadAsArray(), 0, -1)
    columns, _ = decode_position(shown)
    assert (np.diff(columns[0]) % 4096 == 1).all()
    assert gdal.Open(str(second[0])).GetMetadataItem("TIFFTAG_COPYRIGHT") == "© Me"


def test_cache_is_listed_and_cleared(source_list, tmp_path, screenshot):
    desk = source_list
    with TileServer() as server:
        desk.enter_coarse_mission()
        desk.use_template(server.url_template)
        capture(desk, tmp_path / "first")
    seen = []

    def clear(dialog):
        seen.append(dialog.table.rowCount())
        screenshot("cache", dialog)
        dialog.table.selectRow(0)
        desk.click(dialog.clear_some)
        seen.append(dialog.table.rowCount())
        seen.append(dialog.notice.text())
        dialog.reject()

    errors = in_dialog(desk, CacheDialog, clear)
    menu_entry(desk, "Cache…").trigger()
    assert errors == []
    assert seen[:2] == [1, 0]
    assert "freed" in seen[2]
    assert list((tmp_path / "cache").glob("*.mbtiles")) == []


def test_own_source_is_removed_after_asking(source_list, monkeypatch):
    from terrainav.core.imagery.catalogue import add, described

    desk = source_list
    add("mine", described("https://tiles.example.org/{z}/{x}/{y}.png", title="Mine"))
    desk.session.source_list.refresh()
    remove = menu_entry(desk, "Remove this source")
    desk.choose(desk.form.source, "osm")
    assert not remove.isEnabled()
    desk.choose(desk.form.source, "mine")
    assert remove.isEnabled()
    monkeypatch.setattr(QMessageBox, "question", lambda *_: QMessageBox.StandardButton.No)
    remove.trigger()
    assert "Mine" in titles(desk)
    monkeypatch.setattr(QMessageBox, "question", lambda *_: QMessageBox.StandardButton.Yes)
    remove.trigger()
    assert "Mine" not in titles(desk)
    assert user_sources() == ()


def test_broken_file_of_sources_is_told_once_and_the_others_stay(source_list, tmp_path):
    desk = source_list
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "sources.json").write_text("not JSON")
    desk.session.source_list.refresh()
    desk.session.source_list.refresh()
    assert len([text for text in desk.messages() if "left out" in text]) == 1
    assert desk.form.source.findData("osm") >= 0


def test_layers_come_and_go_in_the_chooser(source_list):
    desk, project = source_list, QgsProject.instance()
    layer = project.addMapLayer(QgsVectorLayer("Point?crs=EPSG:4326", "trees", "memory"))
    desk.wait(lambda: {"Whole map", "trees"} <= set(titles(desk)))
    desk.choose(desk.form.source, f"qgis:layer/{layer.id()}")
    layer.setName("old trees")
    desk.wait(lambda: "old trees" in titles(desk))
    assert desk.form.source.currentText() == "old trees"
    desk.enter_small_mission()
    project.removeAllMapLayers()
    desk.wait(lambda: desk.form.source.currentText() == "Missing layer")
    desk.session.capture()
    desk.wait(lambda: "no such layer" in desk.message("source"))


def test_file_is_a_source(source_list, tmp_path, monkeypatch):
    desk = source_list
    path = tmp_path / "ortho.tif"
    file = gdal.GetDriverByName("GTiff").Create(str(path), 2000, 2000, 3, gdal.GDT_Byte)
    file.SetGeoTransform((-10_006_000.0, 2.0, 0.0, 4_184_000.0, 0.0, -2.0))
    from osgeo import osr

    crs = osr.SpatialReference()
    crs.ImportFromEPSG(3857)
    file.SetProjection(crs.ExportToWkt())
    file = None
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    menu_entry(desk, "Open raster or MBTiles file…").trigger()
    assert desk.form.source.currentText() == "ortho.tif"
    assert desk.session.state().source_name == str(path)
    desk.enter_small_mission()
    planned = desk.wait_planned()
    assert planned.mission.imagery.source == str(path)
    # Pixels of 2 m: whatever is asked for, they are not enlarged unasked.
    assert planned.plan.zoom <= planned.plan.grid.native_zoom
    assert Path(desk.form.imagery.limits.text()).name == "ortho.tif"


def test_dates_are_checked_at_their_field(source_list):
    desk = source_list
    desk.choose(desk.form.source, "osm")
    assert not desk.form.date.isVisibleTo(desk.form.imagery)
    desk.enter_small_mission()
    desk.form.agl.setValue(50_000.0)
    desk.choose(desk.form.source, "nasa-gibs")
    assert desk.form.date.isVisibleTo(desk.form.imagery)
    assert desk.form.date.placeholderText()
    desk.type_text(desk.form.date, "yesterday")
    desk.wait(lambda: "YYYY-MM-DD" in desk.message("date"))
    desk.type_text(desk.form.date, "2023-07-01")
    assert desk.wait_planned().mission.imagery.date == "2023-07-01"
    assert desk.message("date") == ""
