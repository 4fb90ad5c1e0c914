"""Keys and passwords: chosen in the panel, used on the network, and found nowhere else."""

from __future__ import annotations

import base64
import gzip
import re
import zipfile
from pathlib import Path
from urllib.parse import quote, quote_plus

import pytest
from qgis.core import Qgis, QgsApplication, QgsAuthMethodConfig, QgsOwsConnection, QgsProject, QgsSettings
from qgis.PyQt.QtCore import QBuffer, QIODevice
from qgis.PyQt.QtGui import QColor, QImage
from qgis.PyQt.QtWidgets import QFileDialog
from terrainav.core.imagery import opening
from terrainav.core.imagery.catalogue import add, described, user_sources
from terrainav.core.imagery.entry import CatalogueEntry
from terrainav.core.imagery.opening import FILE, SERVICE, SourceKind
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.credentials import credential_problem
from terrainav.terrainav_plugin.form.mission_form import mission_state
from terrainav.terrainav_plugin.form.state import URL_TEMPLATE
from terrainav.terrainav_plugin.panel.source_dialogs import save_layer
from terrainav.terrainav_plugin.qgis_source.connections import (
    ServiceConnection,
    connection,
    connection_names,
    service,
    without_key,
)
from terrainav.terrainav_plugin.settings import Settings
from terrainav.terrainav_plugin.sources import credentials_problem, tile_layer_uri

from tests.plugin.transports import MASTER_PASSWORD, PASSWORD, USER, Server
from tests.support.services import wms_document
from tests.support.tileserver import TileServer

# Nobody writes this by chance, and it is written otherwise in addresses.
KEY = "marker/key+of&this=test"
# As QGIS takes it in an address, where it unpacks what is packed.
PLAIN_KEY = "another-marker-key-of-this-test"
BASIC = "Basic " + base64.b64encode(f"{USER}:{PASSWORD}".encode()).decode()
# Where QGIS keeps its connections has changed in 3.30.
_NEW = Qgis.QGIS_VERSION_INT >= 33000
XYZ_SETTINGS = "connections/xyz/items" if _NEW else "qgis/connections-xyz"
WMS_SETTINGS = "connections/ows/items/wms/connections/items" if _NEW else "qgis/connections-wms"
WMS_CREDENTIALS = WMS_SETTINGS if _NEW else "qgis/WMS"


def spellings(secret):
    found = {secret, quote(secret), quote(secret, safe=""), quote_plus(secret)}
    return {text.encode() for text in found} | {base64.b64encode(secret.encode())}


@pytest.fixture(autouse=True)
def no_credentials(monkeypatch):
    monkeypatch.delenv("TERRAINAV_KEY", raising=False)
    QgsSettings().remove("TerrAInav/authcfg")
    yield
    for root in ("TerrAInav/authcfg", XYZ_SETTINGS, WMS_SETTINGS, WMS_CREDENTIALS):
        QgsSettings().remove(root)


@pytest.fixture
def configured():
    """Make configurations of QGIS's authentication database; they go away with the test."""
    manager, made = QgsApplication.authManager(), []
    manager.setMasterPassword(MASTER_PASSWORD, True)

    def make(password, name="tiles", username=USER):
        config = QgsAuthMethodConfig("Basic")
        config.setName(name)
        config.setConfig("username", username)
        config.setConfig("password", password)
        assert manager.storeAuthenticationConfig(config)
        made.append(config.id())
        return config.id()

    yield make
    manager.setMasterPassword(MASTER_PASSWORD, True)
    for authcfg in made:
        manager.removeAuthenticationConfig(authcfg)


@pytest.fixture
def heard():
    """What is written to QGIS's log."""
    told, log = [], QgsApplication.messageLog()
    signal = log.messageReceived[str, str, Qgis.MessageLevel]

    def note(text, _tag, _level):
        told.append(text)

    signal.connect(note)
    yield told
    signal.disconnect(note)


@pytest.fixture
def tiles():
    """A server that gives a grey tile to whoever asks, and notes what it was asked."""
    image = QImage(256, 256, QImage.Format.Format_RGB32)
    image.fill(QColor(90, 120, 60))
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    image.save(buffer, "PNG")
    with Server() as server:
        server.answer = (200, {"Content-Type": "image/png"}, bytes(buffer.data()))
        yield server


def connect_xyz(name, **told):
    if _NEW and "referer" in told:
        told["http-header"] = {"referer": told.pop("referer")}
    if _NEW and "tilePixelRatio" in told:
        told["tile-pixel-ratio"] = told.pop("tilePixelRatio")
    for key, value in told.items():
        QgsSettings().setValue(f"{XYZ_SETTINGS}/{name}/{key}", value)


def capture(desk):
    desk.wait_planned()
    desk.click(desk.dock.capture)
    desk.wait(lambda: any(desk.folder.glob("*/meta_data.csv")))
    desk.wait_for_run()
    return sorted(desk.folder.glob("*/*.tif"))


def everything_written(folder: Path):
    """Content of every file, also of those packed in others."""
    for path in folder.rglob("*"):
        if path.is_file():
            yield path, path.read_bytes()
            if zipfile.is_zipfile(path):
                with zipfile.ZipFile(path) as packed:
                    for name in packed.namelist():
                        yield f"{path}/{name}", packed.read(name)
            elif path.suffix == ".gz":
                yield path, gzip.decompress(path.read_bytes())


def assert_kept_secret(desk, tmp_path, heard, secret):
    """Look through what was captured and kept, the project saved now, settings, log, messages and layers."""
    project = QgsProject.instance()
    assert project.write(str(tmp_path / "project.qgz"))
    assert project.write(str(tmp_path / "project.qgs"))
    QgsSettings().sync()
    texts = [
        *heard,
        *desk.messages(),
        desk.session.state().to_json(),
        repr(desk.session.state()),
        *(layer.source() for layer in project.mapLayers().values()),
        *(layer.htmlMetadata() for layer in project.mapLayers().values()),
        Path(QgsSettings().fileName()).read_text(encoding="utf-8"),
    ]
    written = [*everything_written(tmp_path), *(("text", text.encode()) for text in texts)]
    assert len(written) > len(texts) + 5
    for spelling in spellings(secret):
        assert [str(place) for place, content in written if spelling in content] == []


def test_key_of_an_own_source_is_used_and_found_nowhere(desk, tmp_path, configured, heard):
    with TileServer() as server:
        add("keyed", described(server.url_template + "?token={key}", title="Keyed", requests_per_s=10_000.0))
        desk.session.source_list.refresh()
        desk.choose(desk.form.source, "keyed")
        desk.enter_coarse_mission()
        assert desk.form.key.isVisibleTo(desk.form.imagery)
        # Without a key no run begins, and the field says so.
        desk.click(desk.dock.capture)
        desk.wait(lambda: "API key" in desk.message("key"))
        assert not desk.folder.exists()
        assert sum(server.requests.values()) == 0
        authcfg = configured(KEY)
        desk.form.key.setConfigId(authcfg)
        desk.wait(lambda: desk.message("key") == "")
        pictures = capture(desk)
        assert len(pictures) == len(desk.session.planned.plan)
        assert all(path.endswith("?token=" + quote(KEY, safe="")) for path in server.requests)
        desk.session.show_on_map()
        assert any("would be written into the project" in text for text in desk.messages())
    assert Settings().authcfgs() == {"keyed": authcfg}
    assert_kept_secret(desk, tmp_path, heard, KEY)


def test_failures_name_no_key(desk, tmp_path, configured, heard):
    """A server that refuses repeats the key in its words."""
    with Server() as server:
        server.answer = (403, {"Content-Type": "text/plain"}, f"key {KEY} is not valid".encode())
        desk.use_template(server.url + "/{z}/{x}/{y}.png?token={key}")
        desk.enter_small_mission()
        desk.form.key.setConfigId(configured(KEY))
        desk.wait_planned()
        desk.click(desk.dock.capture)
        desk.wait(lambda: bool(server.seen))
        desk.wait_for_run()
    assert_kept_secret(desk, tmp_path, heard, KEY)


@pytest.mark.thorough
def test_http_authentication_of_an_own_source(desk, tmp_path, configured, tiles, heard):
    authcfg = configured(PASSWORD)
    add("closed", described(tiles.url + "/{z}/{x}/{y}.png", title="Closed", requests_per_s=10_000.0))
    desk.session.source_list.refresh()
    desk.choose(desk.form.source, "closed")
    desk.enter_small_mission()
    desk.form.key.setConfigId(authcfg)
    assert capture(desk)
    assert tiles.seen
    assert {headers.get("authorization") for _, headers in tiles.seen} == {BASIC}
    # The layer names the configuration, and nothing of what is in it.
    desk.session.show_on_map()
    sources = [layer.source() for layer in QgsProject.instance().mapLayers().values()]
    assert any(f"authcfg={authcfg}" in source for source in sources)
    assert_kept_secret(desk, tmp_path, heard, PASSWORD)


def test_xyz_connection_of_qgis_is_a_source(desk, tmp_path, configured, tiles, heard, screenshot):
    """With its zooms, authentication and referer, as QGIS keeps them."""
    authcfg = configured(PASSWORD)
    url = tiles.url + "/{z}/{x}/{y}.png"
    connect_xyz("My tiles", url=url, zmin=3, zmax=17, authcfg=authcfg, referer="https://ref.example/")
    desk.session.source_list.refresh()
    desk.choose(desk.form.source, "qgis:xyz/My tiles")
    assert "check them yourself" in desk.form.imagery.limits.text()
    assert "zoom 3 to 17" in desk.form.imagery.limits.text()
    assert not desk.form.key.isVisibleTo(desk.form.imagery)
    desk.enter_small_mission()
    assert desk.session.planned.plan.zoom == 17
    desk.form.source.showPopup()
    screenshot("source-chooser")
    desk.form.source.hidePopup()
    assert capture(desk)
    assert {headers.get("authorization") for _, headers in tiles.seen} == {BASIC}
    assert {headers.get("referer") for _, headers in tiles.seen} == {"https://ref.example/"}
    mission = (desk.folder / "mission.json").read_text()
    assert "qgis:xyz/My tiles" in mission
    assert tiles.url not in mission
    uri = tile_layer_uri("qgis:xyz/My tiles", "satellite")
    assert f"authcfg={authcfg}" in uri
    assert "zmin=3&zmax=17" in uri
    assert_kept_secret(desk, tmp_path, heard, PASSWORD)


def test_tiles_of_a_connection_that_states_no_width_are_captured(desk):
    with TileServer(tile_px=512) as server:
        connect_xyz("Wide", url=server.url_template, zmin=0, zmax=17)
        desk.session.source_list.refresh()
        desk.choose(desk.form.source, "qgis:xyz/Wide")
        desk.enter_small_mission()
        assert desk.session.planned.plan.zoom == 17
        assert capture(desk)


def test_key_in_a_connection_s_address_stays_there(desk, tmp_path, tiles, heard):
    connect_xyz("Keyed", url=tiles.url + "/{z}/{x}/{y}.png?apikey=" + PLAIN_KEY, zmin=0, zmax=17)
    desk.session.source_list.refresh()
    desk.choose(desk.form.source, "qgis:xyz/Keyed")
    desk.enter_small_mission()
    assert capture(desk)
    assert all(path.endswith("?apikey=" + PLAIN_KEY) for path, _ in tiles.seen)
    desk.session.show_on_map()
    assert any("would be written into the project" in text for text in desk.messages())
    # QGIS itself keeps it with the connection, where the user has put it.
    QgsSettings().remove(XYZ_SETTINGS)
    assert_kept_secret(desk, tmp_path, heard, PLAIN_KEY)


def test_connection_that_is_gone_is_said_at_the_field(desk):
    connect_xyz("Gone", url="http://127.0.0.1:9/{z}/{x}/{y}.png", zmin=0, zmax=17)
    desk.session.source_list.refresh()
    desk.choose(desk.form.source, "qgis:xyz/Gone")
    desk.enter_small_mission()
    QgsSettings().remove(XYZ_SETTINGS)
    desk.session.source_list.refresh()
    assert desk.form.source.currentText() == "Missing connection"
    desk.session.capture()
    desk.wait(lambda: "no such XYZ connection" in desk.message("source") + desk.message("key"))


def test_connections_are_those_of_qgis_s_browser():
    connect_xyz("b", url="https://b.example/{z}/{x}/{y}.png", zmin=2, zmax=5, tilePixelRatio=2)
    connect_xyz("A & co", url="https://a.example/{z}/{x}/{y}.png?x=1&y=a%20b", zmin=0, zmax=9)
    names = connection_names()
    assert {"b", "A & co"} <= set(names)
    one = connection("qgis:xyz/b")
    assert (one.min_zoom, one.max_zoom, one.tile_px, one.key) == (2, 5, 512, "")
    assert connection("qgis:xyz/A & co").url == "https://a.example/{z}/{x}/{y}.png?x=1&y=a%20b"


def test_plain_passwords_of_connections_are_refused():
    connect_xyz("Plain", url="https://b.example/{z}/{x}/{y}.png", username="me", password="word")
    with pytest.raises(ValueError, match="in plain text: give it an authentication configuration"):
        connection("qgis:xyz/Plain")


@pytest.mark.parametrize(
    ("url", "address", "key"),
    [
        ("https://h.example/{z}/{x}/{y}?key=a%2Fb&v=1", "https://h.example/{z}/{x}/{y}?key={key}&v=1", "a/b"),
        ("https://h.example/wms?map=m&token=s3cret", "https://h.example/wms?map=m&token={key}", "s3cret"),
        ("https://h.example/{z}/{x}/{y}.png", "https://h.example/{z}/{x}/{y}.png", ""),
        ("https://h.example/?app_id=a&app_code=b", "https://h.example/?app_id=a&app_code=b", ""),
    ],
)
def test_keys_are_taken_out_of_addresses(url, address, key):
    assert without_key(url) == (address, key)
    assert key == "" or key not in address


# OWSLib, when it is first loaded under Python 3.11.
@pytest.mark.filterwarnings("ignore:'cgi' is deprecated")
def test_layer_of_a_service_is_kept_as_an_own_source(desk, configured, screenshot):
    from qgis.PyQt.QtWidgets import QDialogButtonBox
    from terrainav.terrainav_plugin.panel.source_dialogs import ServiceDialog

    authcfg = configured(PASSWORD)
    with Server() as server:
        crs = "<CRS>EPSG:3857</CRS>"
        layers = "".join(
            f"<Layer><Name>{name}</Name><Title>{title}</Title>{crs}</Layer>"
            for name, title in (("ortho", "Orthophoto"), ("plan", "Plan of the town"))
        )
        body = wms_document("1.3.0", f"{server.url}/wms", f"<Layer><Title>All</Title>{crs}{layers}</Layer>")
        server.answers["/wms"] = (200, {"Content-Type": "text/xml"}, body)
        QgsSettings().setValue(f"{WMS_SETTINGS}/Survey/url", server.url + "/wms")
        QgsSettings().setValue(f"{WMS_CREDENTIALS}/Survey/authcfg", authcfg)
        assert QgsOwsConnection.connectionList("WMS") == ["Survey"]
        dialog = ServiceDialog(service("Survey"), desk.iface.mainWindow())
        dialog.show()
        desk.wait(lambda: not dialog.notice.text().startswith("Asking"))
        assert dialog.notice.text() == "2 layers"
        screenshot("service-layers", dialog)
        ok = dialog.buttons.button(QDialogButtonBox.StandardButton.Ok)
        assert not ok.isEnabled()
        dialog.list.setCurrentRow(0)
        assert ok.isEnabled()
        desk.click(ok)
        desk.wait(lambda: bool(dialog.added))
        assert {headers.get("authorization") for _, headers in server.seen} == {BASIC}
    (entry,) = user_sources()
    assert entry.name == dialog.added
    assert entry.title.endswith("(Survey)")
    assert Settings().authcfgs() == {dialog.added: authcfg}
    dialog.deleteLater()
    # All that has to be known of it is kept: it is planned without the server.
    desk.session.source_list.refresh()
    desk.choose(desk.form.source, entry.name)
    desk.enter_small_mission()
    assert desk.wait_planned().mission.imagery.source == entry.name


def test_the_environment_s_key_is_for_hosts_that_the_user_names(monkeypatch):
    """A template may come from a mission file of anybody."""
    source = "https://tiles.example/{z}/{x}/{y}.png?k={key}"
    monkeypatch.setenv("TERRAINAV_KEY", KEY)
    monkeypatch.delenv("TERRAINAV_KEY_HOSTS", raising=False)
    assert "TERRAINAV_KEY is not sent there" in credentials_problem(source)
    monkeypatch.setenv("TERRAINAV_KEY_HOSTS", "tiles.example")
    assert credentials_problem(source) == ""
    monkeypatch.delenv("TERRAINAV_KEY")
    assert "API key" in credentials_problem(source)


def test_a_kept_layer_whose_tiles_are_elsewhere_has_no_configuration():
    entry = CatalogueEntry.from_dict("x", described("https://elsewhere.example/{z}/{x}/{y}", title="Layer"), user=True)
    for address, authcfg in (
        ("https://maps.example/wmts", ""),
        ("https://elsewhere.example/wmts", "cfg1234"),
    ):
        name = save_layer(entry, ServiceConnection("Survey", address, authcfg="cfg1234"), "ortho")
        assert Settings().authcfg(name) == authcfg


def test_words_for_what_keeps_a_configuration_from_being_used(configured):
    assert "press “+”" in credential_problem("", is_key=True)
    assert credential_problem("", is_key=False) == ""
    assert "does not exist" in credential_problem("0000000", is_key=True)
    assert "holds no key" in credential_problem(configured(""), is_key=True)
    assert credential_problem(configured(KEY), is_key=True) == ""


def test_locked_database_is_said_in_words(configured, monkeypatch):
    """The user closes QGIS's question for the master password."""
    authcfg = configured(KEY)
    manager = QgsApplication.authManager()
    manager.clearMasterPassword()

    class Closed:
        """The manager, where nobody enters the password."""

        def __getattr__(self, name):
            return getattr(manager, name)

        def setMasterPassword(self, _ask):
            return False

    monkeypatch.setattr(QgsApplication, "authManager", Closed)
    assert "is locked" in credential_problem(authcfg, is_key=True)


def test_sources_are_found_by_typing(desk, screenshot):
    from qgis.PyQt.QtCore import Qt
    from qgis.PyQt.QtTest import QTest

    combo = desk.form.source
    desk.type_text(combo.lineEdit(), "wayback")
    screenshot("source-search")
    QTest.keyClick(combo.lineEdit(), Qt.Key.Key_Return)
    desk.wait(lambda: combo.currentData() == "esri-wayback")
    # What is found nowhere changes nothing.
    desk.type_text(combo.lineEdit(), "no such source")
    QTest.keyClick(combo.lineEdit(), Qt.Key.Key_Return)
    assert combo.currentData() == "esri-wayback"
    assert combo.currentText() == combo.itemText(combo.currentIndex())


def test_new_kind_reaches_the_list_by_its_line_alone(desk, monkeypatch):
    """A kind of files and one of addresses, as two lines in the table."""
    scenes = SourceKind("scenes", FILE, ".mbtiles", "MBTilesFile", endings=(".scenes",))
    service = SourceKind("stac", SERVICE, ".services.ogc", "ServiceLayer", recognised_by=re.compile("stac:").match)
    monkeypatch.setattr(opening, "KINDS", (scenes, service, *opening.KINDS))
    asked = []
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *args: asked.append(args[3]) or ("a.scenes", ""))
    desk.form.imagery._browse()
    assert "*.scenes " in asked[0]
    assert desk.form.source.currentData() == "a.scenes"
    state = mission_state(Mission(Box(1.0, 1.0, 0.9, 1.1), 120.0, source="stac:https://h/c"), "")
    assert (state.source, state.template) == (URL_TEMPLATE, "stac:https://h/c")
    desk.choose(desk.form.source, URL_TEMPLATE)
    for address, dated in (("https://h/{z}/{x}/{y}", False), ("stac:https://h/c", True)):
        desk.form.imagery.template.setText(address)
        assert desk.form.imagery._date_field.isVisibleTo(desk.form.imagery) == dated


def test_headings_cannot_be_chosen(desk):
    combo = desk.form.source
    headings = [row for row in range(combo.count()) if combo.itemData(row) is None]
    assert [combo.itemText(row) for row in headings][:2] == ["Catalogue: worldwide", "Catalogue: one country"]
    for row in headings:
        assert not combo.model().item(row).isEnabled()
    desk.choose(combo, "world")
    assert combo.itemText(headings[0] + 1) == "Synthetic (offline)"


def test_broken_own_entry_hides_no_other(desk, tmp_path):
    import json

    good = described("https://tiles.example.org/{z}/{x}/{y}.png", title="Mine")
    add("mine", good)
    path = tmp_path / "config" / "sources.json"
    path.write_text(json.dumps({"bad": {}, "osm": good, **json.loads(path.read_text())}))
    desk.session.source_list.refresh()
    titles = [desk.form.source.itemText(row) for row in range(desk.form.source.count())]
    assert titles.count("Mine") == 1
    names = [desk.form.source.itemData(row) for row in range(desk.form.source.count())]
    assert names.count("osm") == 1
    (told,) = [text for text in desk.messages() if "left out" in text]
    assert "'bad'" in told
    assert "'osm'" in told
