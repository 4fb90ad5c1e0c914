"""The plugin's page among QGIS's options: what is set there holds, and keys stay in the authentication database."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from qgis.core import QgsApplication, QgsAuthMethodConfig, QgsSettings
from qgis.PyQt.QtCore import QTimer
from qgis.PyQt.QtWidgets import QApplication, QDialog, QDialogButtonBox
from terrainav.terrainav_plugin.panel.options_page import OptionsPage, folder_problem
from terrainav.terrainav_plugin.settings import Settings, credential_name
from terrainav.terrainav_plugin.sources import source_transport

from tests.plugin.transports import MASTER_PASSWORD, PASSWORD, USER

NAMES = ("missions_folder", "backgrounds_folder", "cache_folder", "cache_limit_mb", "connections", "units")


@pytest.fixture(autouse=True)
def as_installed(monkeypatch, tmp_path):
    """Settings as they are after an installation, before and after each test."""
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    for _ in range(2):
        for name in NAMES:
            QgsSettings().remove(f"TerrAInav/{name}")
        QgsSettings().remove("TerrAInav/authcfg")
        if _ == 0:
            yield


@pytest.fixture
def authcfg():
    manager = QgsApplication.authManager()
    manager.setMasterPassword(MASTER_PASSWORD, True)
    config = QgsAuthMethodConfig("Basic")
    config.setName("my maps")
    config.setConfig("username", USER)
    config.setConfig("password", PASSWORD)
    assert manager.storeAuthenticationConfig(config)
    yield config.id()
    manager.setMasterPassword(MASTER_PASSWORD, True)
    manager.removeAuthenticationConfig(config.id())


@pytest.fixture
def page(qtbot):
    told = []
    page = OptionsPage(None, lambda: told.append(True))
    page.told = told
    qtbot.addWidget(page)
    page.resize(760, 820)
    page.show()
    return page


def in_options(act: Callable[[QDialog, OptionsPage], None]) -> list[BaseException]:
    """Do something in the options dialog that comes next; what is wrong there is raised where it was opened."""
    errors: list[BaseException] = []

    def look() -> None:
        dialog = QApplication.activeModalWidget()
        page = None if dialog is None else dialog.findChild(OptionsPage)
        if page is None:
            QTimer.singleShot(50, look)
            return
        try:
            act(dialog, page)
        except BaseException as wrong:  # noqa: BLE001  raised again where the dialog was opened
            errors.append(wrong)
            dialog.reject()

    QTimer.singleShot(0, look)
    return errors


def test_menu_opens_qgis_s_options_at_the_page(plugin, screenshot, tmp_path):
    """As a person does it: the menu's entry, a value, OK."""

    def act(dialog, page):
        assert page.isVisible()
        screenshot("options")
        page.connections.setValue(3)
        page.folders["missions_folder"].setFilePath(str(tmp_path / "flights"))
        dialog.findChild(QDialogButtonBox, "buttonBox").button(QDialogButtonBox.StandardButton.Ok).click()

    errors = in_options(act)
    plugin.actions["settings"].trigger()
    if errors:
        raise errors[0]
    assert Settings().connections == 3
    assert Settings().missions == tmp_path / "flights"


def test_what_is_set_is_shown_kept_and_told(page, tmp_path):
    assert page.folders["missions_folder"].filePath() == ""
    assert page.folders["missions_folder"].lineEdit().placeholderText() == str(Path.home() / "TerrAInav")
    for name, widget in page.folders.items():
        widget.setFilePath(str(tmp_path / name))
    page.connections.setValue(5)
    page.cache_limit.setValue(1234)
    page.units.setCurrentIndex(page.units.findData("ft"))
    assert page.isValid()
    page.apply()
    assert page.told == [True]
    settings = Settings()
    assert settings.missions == tmp_path / "missions_folder"
    assert settings.backgrounds == tmp_path / "backgrounds_folder"
    assert (settings.connections, settings.cache_limit_bytes, settings.units) == (5, 1_234_000_000, "ft")
    other = OptionsPage(None, lambda: None)
    assert other.connections.value() == 5
    assert other.folders["cache_folder"].filePath() == str(tmp_path / "cache_folder")
    other.deleteLater()


def test_nothing_is_kept_before_it_is_accepted(page):
    page.connections.setValue(2)
    assert Settings().connections == Settings.connections.default


def test_wrong_values_are_marked_in_words_and_not_kept(page, tmp_path, screenshot):
    file = tmp_path / "file.txt"
    file.write_text("")
    page.folders["missions_folder"].setFilePath("flights/of/mine")
    page.folders["cache_folder"].setFilePath(str(file / "below"))
    assert "must be an absolute path" in page.marks.message("missions_folder")
    assert "is a file; choose a folder" in page.marks.message("cache_folder")
    assert not page.isValid()
    screenshot("options-wrong", page)
    page.connections.setValue(2)
    page.apply()
    assert Settings().missions_folder == Settings().cache_folder == ""
    assert Settings().connections == 2
    page.folders["missions_folder"].setFilePath(str(tmp_path))
    page.folders["cache_folder"].setFilePath("")
    assert page.isValid()
    assert page.marks.first_message() == ""


def test_reset_brings_back_what_was_installed_but_for_keys(page, authcfg, tmp_path):
    page.keys.choosers["google-static"].setConfigId(authcfg)
    page.folders["missions_folder"].setFilePath(str(tmp_path))
    page.connections.setValue(1)
    page.apply()
    page.reset.click()
    page.apply()
    assert Settings().missions_folder == ""
    assert Settings().connections == Settings.connections.default
    assert Settings().authcfg("google-static") == authcfg


def test_keys_are_ids_of_configurations(page, authcfg, screenshot):
    assert {"google-static", "mapbox-satellite"} <= set(page.keys.choosers)
    page.keys.choosers["mapbox-satellite"].setConfigId(authcfg)
    screenshot("options-page", page)
    page.apply()
    assert Settings().authcfgs() == {"mapbox-satellite": authcfg}
    QgsSettings().sync()
    assert PASSWORD not in Path(QgsSettings().fileName()).read_text(encoding="utf-8")
    page.keys.choosers["mapbox-satellite"].setConfigId("")
    page.apply()
    assert Settings().authcfgs() == {}


@pytest.mark.thorough
def test_dark_theme(page, screenshot):
    before = QApplication.instance().styleSheet()
    QgsApplication.setUITheme("Night Mapping")
    try:
        page.folders["missions_folder"].setFilePath("nowhere")
        screenshot("options-dark", page)
        assert page.grab().toImage().pixelColor(3, 3).lightness() < 80
    finally:
        QgsApplication.setUITheme("default")
        QApplication.instance().setStyleSheet(before)


def test_cache_is_opened_from_the_page_and_its_settings_hold(page, tmp_path, monkeypatch):
    monkeypatch.delenv("TERRAINAV_CACHE_DIR", raising=False)
    page.folders["cache_folder"].setFilePath(str(tmp_path / "tiles"))
    page.cache_limit.setValue(77)
    page.apply()
    cache = Settings().tile_cache()
    assert (cache.folder, cache.limit_bytes) == (tmp_path / "tiles", 77_000_000)
    seen = []

    def look():
        dialog = QApplication.activeModalWidget()
        if dialog is None or dialog.objectName() != "terrainav_cache":
            QTimer.singleShot(20, look)
            return
        seen.append(dialog.notice.text())
        dialog.reject()

    QTimer.singleShot(0, look)
    page.cache_button.click()
    assert str(tmp_path / "tiles") in seen[0]


def test_connections_hold_for_requests():
    Settings().connections = 3
    transport = source_transport("osm")
    assert transport._worker._terms.connections == 3
    transport.close()


@pytest.mark.parametrize("value", ["", "many", -1, 0, 65, 3.7, None])
def test_a_file_of_settings_that_was_edited_badly_does_no_harm(value):
    QgsSettings().setValue("TerrAInav/connections", value)
    QgsSettings().setValue("TerrAInav/units", value)
    assert Settings().connections in (3, Settings.connections.default)
    assert Settings().units == "m"


def test_what_is_out_of_range_is_refused():
    with pytest.raises(ValueError, match="must be from 1 to 64"):
        Settings().connections = 0
    with pytest.raises(ValueError, match="must be one of m, ft"):
        Settings().units = "yards"


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("mapbox-satellite", "mapbox-satellite"),
        ("https://tiles.example.org/{z}/{x}/{y}.png?k={key}", "tiles.example.org"),
        ("https://{s}.tiles.example.org/{z}/{x}/{y}.png", "tiles.example.org"),
        ("https://t{1-4}.tiles.example.org/{z}/{x}/{y}.png", "tiles.example.org"),
        ("http://127.0.0.1:8080/{z}/{x}/{y}.png", "127.0.0.1:8080"),
        ("wmts:https://maps.example.org/wmts#layer=a", "maps.example.org"),
        ("qgis:layer/abc", ""),
        ("qgis:xyz/My tiles", ""),
        ("/data/ortho.tif", ""),
        ("https://" + "a" * 1_000_000, ""),
    ],
)
def test_credentials_are_those_of_a_host(source, name):
    """What was entered for one address is not sent to another host."""
    assert credential_name(source) == name


def test_folders_that_cannot_be_written_to(tmp_path):
    assert folder_problem("") == ""
    assert folder_problem(str(tmp_path / "new" / "below")) == ""
    assert folder_problem("~/flights") == ""
    assert "must be an absolute path" in folder_problem("flights")
    (tmp_path / "file").write_text("")
    assert "is a file" in folder_problem(str(tmp_path / "file"))


def test_units_are_taken_up_by_the_panel(desk):
    page = OptionsPage(None, desk.session.settings_changed)
    height_m = desk.session.state().agl_m
    page.units.setCurrentIndex(page.units.findData("ft"))
    page.apply()
    assert desk.session.state().agl_unit == "ft"
    assert desk.session.state().agl_m == pytest.approx(height_m, abs=1e-3)
    page.units.setCurrentIndex(page.units.findData("m"))
    page.apply()
    assert desk.session.state().agl_unit == "m"
    page.deleteLater()
