"""Projects, datasets and mission files of strangers: no server is asked that the user has not agreed to here."""

from __future__ import annotations

import json
import shutil

import pytest
from qgis.core import QgsProject, QgsVectorLayer
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QFileDialog
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.map.mission_group import MissionGroup, mission_layers
from terrainav.terrainav_plugin.remote.address import DatasetAddress
from terrainav.terrainav_plugin.remote.copies import copy_folder
from terrainav.terrainav_plugin.remote.trust import agree, source_names, unagreed_places
from terrainav.terrainav_plugin.settings import Settings, recent

from tests.plugin.test_addresses import open_address, serve
from tests.plugin.test_project import choose_in_menu
from tests.support.growth import PROPORTIONAL, growth
from tests.support.ranges import RangeServer
from tests.support.shards import write_folders
from tests.support.thinning import sampled

BOX = Box(35.16, -89.90, 35.158, -89.897)
# A server of the shipped catalogue.
KNOWN = "https://tile.openstreetmap.org"
# Entries of a mission that lead to a server, by what they are.
LEADING = {
    "wms": {"source": "wms:{url}/ows?layers=x"},
    "wmts": {"source": "wmts:{url}/wmts"},
    "arcgis": {"source": "arcgis:{url}/arcgis/rest/services/x/MapServer"},
    "ogcapi": {"source": "ogcapi:{url}/collections/x"},
    "raster": {"source": "{url}/x.tif"},
    "vsicurl": {"source": "/vsicurl/{url}/x.tif"},
    "vsicurl in a zip": {"source": "/vsizip//vsicurl/{url}/x.zip/x.tif"},
    "tiles": {"source": "{url}/{{z}}/{{x}}/{{y}}.png"},
    "heights": {"source": "world", "elevation": ("{url}/x.tif",)},
    "surface": {"source": "world", "elevation": ("world",), "surface": ("/vsicurl/{url}/x.tif",)},
    "imageries": {"imageries": ("a=world", "b=wms:{url}/ows?layers=x")},
}


@pytest.fixture
def server():
    with RangeServer() as running:
        yield running


@pytest.fixture(autouse=True)
def nothing_agreed(plugin):
    before = Settings().agreed
    Settings().agreed = ""
    yield
    Settings().agreed = before


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    return write_folders(tmp_path_factory.mktemp("captured") / "run")


def mission_of(kind, url):
    def filled(value):
        return value.format(url=url) if isinstance(value, str) else tuple(one.format(url=url) for one in value)

    return Mission(BOX, 120.0, **{name: filled(value) for name, value in LEADING[kind].items()})


def saved_project(desk, path, mission_text, folder="", address=None, title="TerrAInav: theirs"):
    """Save a project with a mission's group as another QGIS would have written it; then begin a new one."""
    project = QgsProject.instance()
    group = project.layerTreeRoot().insertGroup(0, title)
    group.setCustomProperty("terrainav/folder", folder or str(path.parent / "theirs"))
    if mission_text is not None:
        group.setCustomProperty("terrainav/mission", mission_text)
    if address is not None:
        group.setCustomProperty("terrainav/address", address)
    assert project.write(str(path))
    desk.iface.newProject(False)


def open_project(desk, path):
    desk.iface.addProject(str(path))
    QTest.qWait(300)
    desk.wait_planned()
    desk.wait(lambda: not desk.session.missions.busy)
    desk.wait_for_tasks()


def questions(desk):
    return [text for text in desk.messages() if "Nothing is requested" in text]


@pytest.mark.parametrize("kind", sampled(LEADING, 3))
def test_a_project_asks_no_server_until_the_user_allows_it(desk, server, tmp_path, kind, screenshot):
    text = mission_of(kind, server.url).to_json()
    path = tmp_path / "theirs.qgz"
    saved_project(desk, path, text)
    before = desk.session.state()
    open_project(desk, path)
    assert server.asked == []
    (question,) = questions(desk)
    assert server.url in question
    assert "\n" not in question
    assert desk.session.state() == before
    screenshot(f"trust-{kind.replace(' ', '-')}")
    # What is refused stays in the project, and is saved again as it was.
    assert QgsProject.instance().write(str(tmp_path / "again.qgz"))
    other = QgsProject()
    assert other.read(str(tmp_path / "again.qgz"))
    (group,) = other.layerTreeRoot().findGroups(True)
    assert group.customProperty("terrainav/mission") == text
    # Planning again, the panel's own way, asks nothing of theirs.
    desk.session.planning.plan(at_once=True)
    desk.wait_planned()
    assert server.asked == []
    desk.click(desk.buttons_in_message_bar()["Allow"])
    desk.wait_planned()
    assert questions(desk) == []
    assert source_names(_mission(desk)) == source_names(mission_of(kind, server.url))
    if kind not in ("tiles", "imageries"):
        assert server.asked
    # Once allowed it is known in this profile.
    desk.iface.newProject(False)
    desk.iface.messageBar().clearWidgets()
    open_project(desk, path)
    assert questions(desk) == []


def _mission(desk):
    from terrainav.terrainav_plugin.form import mission_form

    return mission_form.mission(desk.session.state())


def test_what_the_user_has_entered_here_is_agreed_to(desk, server, tmp_path):
    desk.enter_coarse_mission()
    desk.use_template(f"{server.url}/{{z}}/{{x}}/{{y}}.png")
    mission = desk.wait_planned().mission
    saved_project(desk, tmp_path / "mine.qgz", mission.to_json())
    open_project(desk, tmp_path / "mine.qgz")
    assert questions(desk) == []
    assert _mission(desk) == mission


def test_the_address_of_a_dataset_in_a_project_is_not_asked_unasked(desk, server, captured, tmp_path):
    address = serve(server, captured)
    mission = (captured / "mission.json").read_text("utf-8")
    shutil.rmtree(copy_folder(DatasetAddress.parse(address)), ignore_errors=True)
    saved_project(desk, tmp_path / "theirs.qgz", mission, str(copy_folder(DatasetAddress.parse(address))), address)
    open_project(desk, tmp_path / "theirs.qgz")
    assert server.asked == []
    (question,) = questions(desk)
    assert server.url in question
    desk.click(desk.buttons_in_message_bar()["Allow"])
    desk.wait(lambda: not desk.session.missions.busy)
    desk.wait_for_tasks()
    assert server.asked
    assert "Captured images" in desk.layer_names()


def test_a_question_goes_with_its_project(desk, server, tmp_path):
    saved_project(desk, tmp_path / "theirs.qgz", mission_of("wms", server.url).to_json())
    open_project(desk, tmp_path / "theirs.qgz")
    assert questions(desk)
    desk.iface.newProject(False)
    assert questions(desk) == []
    assert desk.session.missions._unagreed == {}


@pytest.mark.parametrize("at_address", [False, True])
def test_a_dataset_asks_its_missions_source_once_that_is_allowed(
    desk, monkeypatch, server, captured, tmp_path, at_address
):
    folder = shutil.copytree(captured, tmp_path / "run")
    mission = Mission.load(folder / "mission.json").replace(source=f"wms:{server.url}/ows?layers=x")
    mission.save(folder / "mission.json")
    with RangeServer() as place:
        if at_address:
            open_address(desk, serve(place, folder))
        else:
            monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(folder))
            choose_in_menu(desk, "Open dataset folder…")
        desk.wait(lambda: not desk.session.missions.busy)
        desk.wait_planned()
        assert "Captured images" in desk.layer_names()
        assert server.asked == []
        assert server.url in questions(desk)[0]
    desk.session.missions._allow()
    desk.wait_planned()
    assert server.asked


def test_a_mission_file_asks_its_source_once_that_is_allowed(desk, monkeypatch, server, tmp_path):
    path = tmp_path / "theirs.json"
    mission_of("wms", server.url).save(path)
    monkeypatch.setattr(QFileDialog, "getOpenFileName", lambda *_: (str(path), ""))
    choose_in_menu(desk, "Open mission file…")
    desk.wait_planned()
    assert server.asked == []
    assert questions(desk)
    desk.session.missions._allow()
    desk.wait_planned()
    assert server.asked


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("world", ()),
        ("terrarium", ()),
        ("/data/x.tif", ()),
        ("C:\\data\\x.tif", ()),
        ("qgis:layers", ()),
        ("https://tile.openstreetmap.org/{z}/{x}/{y}.png", ()),
        ("http://host/{z}/{x}/{y}", ("http://host",)),
        ("HTTPS://me:pw@Host:8080/x.tif", ("https://host:8080",)),
        ("https:\\\\host\\x.tif", ("https://host",)),
        ("https:/host/x.tif", ("https://host",)),
        ("https://{switch:a.b,c.d}/{z}/{x}/{y}", ("https://{switch:a.b,c.d}",)),
        ("https://[abc].host/{z}/{x}/{y}", ("https://[abc].host",)),
        ("/vsicurl?url=https%3A%2F%2Fhost%2Fx.tif", ("https://host",)),
        ("/vsicurl?url=https%253A%252F%252Fhost%252Fx.tif", ("https://host",)),
        ("/vsis3/bucket/x.tif", ("/vsis3/bucket/x.tif",)),
        ("/data/x.VRT", ("/data/x.VRT",)),
        ("\\\\host\\share\\x.tif", ("//host",)),
        ("//host/share/x.tif", ("//host",)),
        ("\\\\?\\UNC\\host\\share\\x.tif", ("//?/unc/host",)),
        ("//./unc/host/share/x.tif", ("//./unc/host",)),
        # What looks like an address that is known is a key in a bucket, part of a path, or an option.
        (f"/vsis3/bucket/{KNOWN}/x.tif", (f"/vsis3/bucket/{KNOWN}/x.tif",)),
        (f"/vsigs/bucket/x.tif?{KNOWN}", (f"/vsigs/bucket/x.tif?{KNOWN}",)),
        (f"/vsizip//vsis3/bucket/{KNOWN}", (f"/vsizip//vsis3/bucket/{KNOWN}",)),
        (f"/vsicurl?url=host/x.tif&a={KNOWN}", (f"/vsicurl?url=host/x.tif&a={KNOWN}",)),
        (f"/data/{KNOWN}/x.vrt", (f"/data/{KNOWN}/x.vrt",)),
        (f"/vsizip//vsicurl/{KNOWN}/x.zip/x.tif", ()),
        ("s3://bucket/run", ("s3://bucket",)),
        ("wms:https://a/x?map=https://b/y", ("https://a", "https://b")),
    ],
)
def test_what_a_text_leads_to(text, places):
    assert unagreed_places([text]) == places
    agree([text])
    assert unagreed_places([text]) == ()


def test_another_host_or_scheme_is_not_agreed_to():
    agree(["https://host/{z}/{x}/{y}"])
    others = (
        "http://host/x",
        "https://host.evil/x",
        "https://host:8080/x",
        "https://host@evil/x",
        "https://host&@evil/x",
        "https://host,a=b@evil/x",
        "/vsicurl/https://host\\@evil/x",
        # Spaces beyond ASCII, before which curl takes the user's name on.
        *(f"/vsicurl/https:\\\\host{space}@evil/x.tif" for space in "\x85\xa0\u2003\u2028\u3000"),
        "https://{host}/x",
    )
    assert [text for text in others if not unagreed_places([text])] == []
    assert unagreed_places(["https://host/x.tif"]) == ()


@pytest.mark.parametrize("text", ["", "{", "[1, null]", '"x"', "[" * 10_000])
def test_a_broken_record_agrees_to_nothing(text):
    Settings().agreed = text
    assert unagreed_places(["https://host/x.tif"]) == ("https://host",)
    agree(["https://host/x.tif"])
    assert unagreed_places(["https://host/x.tif"]) == ()


def test_the_record_is_bounded():
    agree([f"https://host{number}/x.tif" for number in range(1500)])
    assert len(json.loads(Settings().agreed)) == 1000
    agree([f"https://{'x' * 5000}/x.tif"])
    assert len(json.loads(Settings().agreed)) == 1000


@pytest.mark.parametrize("piece", ["a", "a.", "https:", "{", "[", "{a", "%25", "://", "a:/", "ab:/b&@", "ab:\\b&"])
def test_the_work_of_a_long_text_grows_with_its_length(piece):
    assert growth(lambda count: unagreed_places([piece * count]), 20_000) < PROPORTIONAL


# --- values of other types

WRONG = [7, 1.5, True, ["a"], {"a": 1}, "\0", "a\0b", "/a\ud800b", "a" * 100_000, " ", "//host/x", b"x"]


@pytest.mark.parametrize("value", WRONG, ids=lambda value: repr(value)[:12])
def test_a_layer_with_a_wrong_folder_is_of_no_mission(desk, value):
    layer = QgsVectorLayer("Polygon?crs=EPSG:4326", "theirs", "memory")
    layer.setCustomProperty("terrainav/folder", value)
    QgsProject.instance().addMapLayer(layer)
    assert mission_layers(QgsProject.instance(), layer.type()) == []


@pytest.mark.parametrize("value", sampled(WRONG, 4), ids=lambda value: repr(value)[:12])
@pytest.mark.parametrize("name", ["folder", "mission", "address"])
def test_wrong_values_in_a_project_are_told_in_a_line_and_stay_nowhere(desk, tmp_path, name, value):
    text = Mission(BOX, 120.0).to_json()
    group = QgsProject.instance().layerTreeRoot().insertGroup(0, "TerrAInav: theirs")
    values = {"folder": str(tmp_path / "theirs"), "mission": text, name: value}
    for key, one in values.items():
        group.setCustomProperty(f"terrainav/{key}", one)
    before = desk.session.state()
    desk.session.missions.restore()
    desk.session.missions.menu.aboutToShow.emit()
    desk.session.missions.gather(tmp_path / "theirs")
    desk.wait_planned()
    for message in desk.messages():
        assert "\n" not in message
    state = desk.session.state()
    if name in ("folder", "mission") and value != "//host/x":
        assert desk.messages()
        assert state == before or (isinstance(value, str) and "\0" not in value and len(value) < 100)
    assert "\0" not in state.folder
    assert len(state.folder) < 5000
    # And by way of a file, as QGIS writes it.
    path = tmp_path / "theirs.qgz"
    assert QgsProject.instance().write(str(path))
    desk.iface.newProject(False)
    desk.iface.addProject(str(path))
    desk.wait_planned()
    desk.iface.newProject(False)
    assert "\0" not in desk.session.state().to_json()


def test_a_folder_whose_name_is_too_long_for_systems_is_none_that_is_there(desk, tmp_path):
    """As is one that only another user may look into: `pathlib` raises of both."""
    for folder in (tmp_path / ("a" * 300), tmp_path / ("b" * 300) / "c"):
        saved_project(desk, tmp_path / "theirs.qgz", Mission(BOX, 120.0).to_json(), str(folder))
        open_project(desk, tmp_path / "theirs.qgz")
        assert desk.session.state().folder == str(folder)
        desk.session.missions.menu.aboutToShow.emit()
        entries = {action.text(): action for action in desk.session.missions.menu.actions()}
        assert not entries["Capture only the &failed images"].isEnabled()
        desk.session.missions.begin_new()
        assert desk.session.state().folder != str(folder)
        desk.session.missions.open_path(folder)
        assert "was not opened" in desk.messages()[0]
        assert "\n" not in desk.messages()[0]
        desk.iface.messageBar().clearWidgets()
    Settings().recent = json.dumps([str(folder), str(tmp_path)])
    assert recent() == [tmp_path]


def test_a_nul_in_a_mission_comes_into_no_panel(desk, tmp_path):
    text = Mission(BOX, 120.0).to_json()
    for wrong in (text.replace('"world"', '"a\\u0000b"'), text.replace('"2024', '"\\u00002024')):
        if wrong == text:
            continue
        saved_project(desk, tmp_path / "theirs.qgz", wrong)
        open_project(desk, tmp_path / "theirs.qgz")
        assert "\\u0000" not in desk.session.state().to_json()
        assert desk.messages()


def test_a_nul_of_an_earlier_version_leaves_the_panel():
    state = FormState(folder="/a\0b", source="x\0", agl=77.0)
    found = FormState.from_json(state.to_json())
    assert (found.folder, found.source, found.agl) == ("", FormState().source, 77.0)


def test_the_layer_that_shows_footprints_need_be_no_file(desk, tmp_path):
    from qgis.core import QgsVectorLayer

    group = MissionGroup(QgsProject.instance(), tmp_path / "theirs")
    layer = QgsVectorLayer("Point?crs=EPSG:4326&field=" + "a" * 100_000, "x", "memory")
    group.add(layer, "captured", 0)
    group.remember_mission(Mission(BOX, 120.0).to_json())
    desk.session.missions.restore()
    assert desk.session.state().folder == str(tmp_path / "theirs")


def test_a_message_of_a_million_letters_is_cut(desk):
    for text in ("x" * 1_000_000, "x " * 500_000, "<" * 1_000_000, "\n" * 1_000_000):
        desk.session.messages.warning(text)
        desk.session.messages.refused(text, "Nothing yet.")
        QTest.qWait(20)
    longest = max(len(text) for text in desk.messages())
    assert longest < 20_000


def test_a_message_is_laid_out_from_a_text_that_is_cut(desk):
    from terrainav.terrainav_plugin import messages

    laid = []
    fit = messages._Fitting._fit_text
    try:
        messages._Fitting._fit_text = lambda self, width: laid.append(len(self._text.toPlainText())) or fit(self, width)
        desk.session.messages.warning("x" * 1_000_000)
        desk.wait(lambda: bool(laid))
    finally:
        messages._Fitting._fit_text = fit
    assert max(laid) < 3000
