"""Datasets at addresses: opened over HTTP and S3, looked at image by image, saved and opened again."""

from __future__ import annotations

import json
import shutil
import tarfile
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal, ogr
from qgis.core import QgsApplication, QgsProject, QgsSettings
from qgis.PyQt.QtCore import QTimer
from qgis.PyQt.QtWidgets import QApplication, QDialogButtonBox
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.remote import geoparquet
from terrainav.terrainav_plugin.remote.address import DatasetAddress
from terrainav.terrainav_plugin.remote.copies import copied_address, copy_folder, local_copy
from terrainav.terrainav_plugin.remote.images import ImageFetcher

from tests.plugin.test_project import choose_in_menu
from tests.plugin.test_viewer import pixel_of, pixels
from tests.support.objects import SECRET, s3_store
from tests.support.ranges import RangeServer
from tests.support.shards import MISSION, write_folders, write_shards
from tests.support.thinning import sampled

TILTED = Mission(
    Box(35.16, -89.90, 35.158, -89.897), 120.0, image_px=48, max_px=48, image_format="png", tilt_deg=30.0,
    products=("depth",),
)  # fmt: skip
ENTRY = "Open dataset at an address…"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A capture as a folder of files, of map frames."""
    return write_folders(tmp_path_factory.mktemp("captured") / "run")


@pytest.fixture(scope="module")
def tilted(tmp_path_factory):
    """A capture of tilted camera frames with their depth."""
    return write_folders(tmp_path_factory.mktemp("tilted") / "run", TILTED)


@pytest.fixture
def server():
    with RangeServer() as running:
        yield running


@pytest.fixture
def viewing(desk):
    yield desk.session.viewing
    desk.session.viewing.stop()
    if desk.session.viewing.viewer is not None:
        desk.session.viewing.viewer.hide()


def serve(server, folder: Path, under: str = "/data/run") -> str:
    """Put the files of a folder onto a server; returns the address."""
    for path in folder.rglob("*"):
        if path.is_file():
            data = path.read_bytes()
            server.files[f"{under}/{path.relative_to(folder).as_posix()}"] = (data, f'"{hash(data)}"')
    return server.url + under


def laid_out(folder: Path, layout: str, place: Path) -> Path:
    return folder if layout == "folders" else write_shards(place / "run", folder)


def open_address(desk, text):
    """Choose the entry of the menu, type an address and press OK; returns what is said at the field."""
    said = []

    def enter():
        dialog = QApplication.activeModalWidget()
        desk.type_text(dialog.entry, text)
        desk.click(dialog.buttons.button(QDialogButtonBox.StandardButton.Ok))
        if dialog.isVisible():
            said.append(dialog._marks.message("address"))
            dialog.reject()

    QTimer.singleShot(400, enter)
    choose_in_menu(desk, ENTRY)
    desk.wait(lambda: not desk.session.missions.busy)
    return said[0] if said else ""


def captured(desk):
    return desk.layer("Captured images")


def look_at(desk, viewing, index):
    """Click the middle of a footprint and wait for its image."""
    feature = sorted(captured(desk).getFeatures(), key=lambda one: one.id())[index]
    if not viewing.tool.isActive():
        desk.plugin.actions["view_images"].trigger()
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    viewing.seen = None
    at = feature.geometry().centroid().asPoint()
    desk.click_map(pixel_of(desk, at.y(), at.x()))
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    assert viewing.seen.shot.name == feature["name"]
    return viewing.seen


def shown_pixels(viewing):
    return pixels(viewing.viewer.view.image)[..., :3]


def pixels_of_file(path):
    return np.moveaxis(gdal.Open(str(path)).ReadAsArray(), 0, -1)[..., :3]


def frame_map(desk, mission):
    desk.look_at("EPSG:3857", (0, 0, 1, 1))
    desk.zoom_to_box(mission.area.bounds)


@pytest.mark.parametrize("layout", ["folders", "shards"])
def test_a_click_shows_the_image_that_is_at_an_address(desk, viewing, server, folder, layout, tmp_path, screenshot):
    address = serve(server, laid_out(folder, layout, tmp_path))
    assert open_address(desk, f"{address}/") == ""
    assert captured(desk).featureCount() == 20
    assert desk.session.state().folder == str(copy_folder(DatasetAddress.parse(address)))
    frame_map(desk, MISSION)
    server.asked.clear()
    seen = look_at(desk, viewing, 7)
    original = folder / "satellite" / f"{seen.shot.name}.png"
    assert np.array_equal(shown_pixels(viewing), pixels_of_file(original))
    text = viewing.viewer.details.text()
    assert f"{address}/satellite/" in text
    assert "Synthetic (offline)" in text
    screenshot(f"address-{layout}")
    # One image at a time is fetched, and of a shard its part.
    sent = [path for _, path, headers in server.asked if "Range" in headers]
    assert 1 <= len([path for path in sent if "mission.json" not in path]) <= 2
    # The one that was looked at before is asked for no more.
    server.asked.clear()
    viewing.seen = None
    viewing._show_shot(seen.shot)
    desk.wait(lambda: viewing.seen is not None)
    assert np.array_equal(shown_pixels(viewing), pixels_of_file(original))
    assert server.asked == []


@pytest.mark.parametrize("layout", sampled(["folders", "shards"], 2))
def test_a_dataset_in_s3_is_opened_with_the_credentials_of_awss_tools(
    desk, viewing, folder, layout, tmp_path, monkeypatch
):
    with s3_store(monkeypatch) as bucket:
        import boto3

        place = laid_out(folder, layout, tmp_path)
        store = boto3.client("s3")
        for path in place.rglob("*"):
            if path.is_file():
                store.upload_file(str(path), "data", f"runs/a run/{path.relative_to(place).as_posix()}")
        assert open_address(desk, f"{bucket}/runs/a run") == ""
        frame_map(desk, MISSION)
        seen = look_at(desk, viewing, 3)
        original = folder / "satellite" / f"{seen.shot.name}.png"
        assert np.array_equal(shown_pixels(viewing), pixels_of_file(original))
        assert f"{bucket}/runs/a run/satellite/" in viewing.viewer.details.text()
        # Nothing of the credentials is anywhere.
        assert QgsProject.instance().write(str(tmp_path / "project.qgs"))
        written = (tmp_path / "project.qgs").read_text(encoding="utf-8")
        assert f"{bucket}/runs/a run" in written
        kept = "".join(path.read_text("utf-8") for path in Path(desk.session.state().folder).glob("*.json"))
        for text in (written, kept, viewing.viewer.details.text()):
            assert not any(secret in text for secret in (SECRET, "TESTKEY", "X-Amz"))
        # Other stores than Amazon's are this dataset's affair alone.
        assert gdal.GetConfigOption("AWS_S3_ENDPOINT") is None


@pytest.mark.parametrize("layout", ["folders", "shards"])
@pytest.mark.parametrize("kind", sampled(["map frames", "camera frames"], 2))
def test_a_fetched_image_is_laid_on_the_map(desk, viewing, server, folder, tilted, layout, kind, tmp_path, screenshot):
    source, mission = (folder, MISSION) if kind == "map frames" else (tilted, TILTED)
    open_address(desk, serve(server, laid_out(source, layout, tmp_path)))
    frame_map(desk, mission)
    seen = look_at(desk, viewing, 1)
    if kind == "camera frames":
        assert seen.depth is not None
        assert not seen.depth.problem
    desk.click(viewing.viewer.on_map)
    desk.wait(lambda: not viewing.busy and bool(QgsProject.instance().mapLayersByName(seen.shot.name)))
    (layer,) = QgsProject.instance().mapLayersByName(seen.shot.name)
    assert layer.isValid()
    extent, footprint = layer.extent(), seen.shot.outline.boundingBox()
    west = 6378137.0 * np.radians(footprint.xMinimum())
    assert extent.xMinimum() == pytest.approx(west, abs=0.2 * extent.width())
    screenshot(f"address-on-map-{layout}-{kind.replace(' ', '-')}")
    assert not (desk.messages())


def test_a_saved_project_opens_again_and_copies_what_is_gone(desk, viewing, server, folder, tmp_path):
    address = serve(server, folder)
    open_address(desk, address)
    project = tmp_path / "project.qgz"
    assert QgsProject.instance().write(str(project))
    copy = copy_folder(DatasetAddress.parse(address))
    for gone in (False, True):
        desk.iface.newProject(False)
        if gone:
            shutil.rmtree(copy)
        server.asked.clear()
        desk.iface.addProject(str(project))
        desk.wait(lambda: "Captured images" in desk.layer_names() and captured(desk).isValid())
        desk.wait(lambda: not desk.session.missions.busy)
        assert bool(server.asked) == gone
        assert captured(desk).featureCount() == 20
        assert copied_address(copy) == DatasetAddress.parse(address)
    frame_map(desk, MISSION)
    seen = look_at(desk, viewing, 2)
    assert seen.picture.image is not None


def test_what_cannot_be_done_at_an_address_says_why(desk, server, folder):
    address = serve(server, folder)
    open_address(desk, address)
    missions = desk.session.missions
    missions.menu.aboutToShow.emit()
    entries = {action.text().replace("&", ""): action for action in missions.menu.actions()}
    for name in ("Dataset…", "Capture only the failed images"):
        assert not entries[name].isEnabled()
        assert entries[name].toolTip().endswith(f"is remote and read-only: {address}")
    desk.wait_planned()
    desk.click(desk.dock.capture)
    assert address in desk.message("folder")
    assert desk.session.runs.idle
    # As a folder of this machine it is captured anew.
    assert desk.session._datasets() == []


@pytest.mark.parametrize(
    ("text", "said"),
    sampled(
        [
            ("", "is missing"),
            ("s3://KEY:Sesame77@data/run", "contains a user name or password"),
            ("s3://KEY:a/Sesame77@data/run", "contains a user name or password"),
            ("s3://KEY:Sesame77/run", "contains a user name or password"),
            ("s3://KEY%3ASesame77%40data/run", "contains a user name or password"),
            ("https://host/run?sig=Sesame77", "contains ? or #"),
            ("ftp://u:a/Sesame77@host/run", "must begin with https://, http:// or s3://"),
            ("az://data/run;AccountKey=Sesame77", "must begin with https://, http:// or s3://"),
            ("ftp://host/run", "must begin with https://, http:// or s3://"),
            ("no such folder", "must begin with https://, http:// or s3://"),
            ("https://me:Sesame77@host/run", "belong in QGIS's authentication"),
            ("https://host/run?X-Amz-Signature=Sesame77", "contains ? or #"),
            ("s3://", "names no server or bucket"),
            ("ftp://me:Sesame77@host/run", "must begin with"),
        ],
        4,
    ),
)
def test_a_bad_address_is_said_at_its_field(desk, text, said):
    found = open_address(desk, text)
    assert said in found
    assert not any("Sesame77" in one for one in (found, *desk.messages(), *_settings()))
    assert "\n" not in found


def _settings():
    settings = QgsSettings()
    return [f"{name}={settings.value(name)}" for name in settings.allKeys() if "TerrAInav" in name]


@pytest.mark.parametrize("name", ["collection.json", "items.parquet", "satellite/meta_data.csv", "mission.json", ""])
def test_the_address_of_a_file_in_a_dataset_stands_for_it(name):
    assert DatasetAddress.parse(f" https://Host:8080/a/run/{name} ") == DatasetAddress("https://Host:8080/a/run")
    assert DatasetAddress.parse("s3://Bucket").name == "Bucket"


def test_what_is_wrong_at_an_address_is_one_line(desk, server, folder, monkeypatch):
    address = serve(server, folder)
    del server.files["/data/run/footprints.geojson"]
    server.files["/page/mission.json"] = (b"<html>", '"1"')
    for text, said in (
        (f"{server.url}/nowhere", "has no mission.json"),
        (address, "has no footprints.geojson"),
        (f"{server.url}/page", "mission"),
        ("http://127.0.0.1:9/run", "127.0.0.1"),
    ):
        open_address(desk, text)
        message = desk.messages()[0]
        assert said in message
        assert "\n" not in message
        assert desk.group() is None
        desk.iface.messageBar().clearWidgets()
    with s3_store(monkeypatch):
        for text, said in (
            ("s3://nobucket/run", "has no mission.json"),
            ("s3://data/run", "has no mission.json"),
        ):
            open_address(desk, text)
            assert said in desk.messages()[0]
            desk.iface.messageBar().clearWidgets()


def test_a_store_that_leads_to_another_server_is_not_followed(desk, server, folder, monkeypatch):
    serve(server, folder)
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, SECRET)
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    with RangeServer() as store:
        monkeypatch.setenv("AWS_ENDPOINT_URL", store.url)
        store.redirects["/data/run/mission.json"] = f"{server.url}/data/run/mission.json"
        open_address(desk, "s3://data/run")
        assert "s3://data: its server leads to another one, which is not asked" in desk.messages()[0]
        assert len(store.asked) == 1
    assert server.asked == []


@pytest.mark.parametrize("wrong", sampled(["gone", "torn", "other", "whole files only", "no shard", "refused"], 3))
def test_what_is_wrong_with_an_image_is_said_in_its_place(desk, viewing, server, folder, tmp_path, wrong):
    serve(server, write_shards(tmp_path / "run", folder))
    open_address(desk, f"{server.url}/data/run")
    frame_map(desk, MISSION)
    look_at(desk, viewing, 0)
    name = "/data/run/satellite/satellite-000001.tar"
    data, etag = server.files[name]
    table = Path(desk.session.state().folder) / "satellite" / "meta_data.csv"
    if wrong == "gone":
        del server.files[name]
    elif wrong == "torn":
        server.files[name] = (data[:700], etag)
    elif wrong == "other":
        server.files[name] = (b"x" * len(data), etag)
    elif wrong == "whole files only":
        server.sends_parts = False
    elif wrong == "no shard":
        table.write_text(table.read_text("utf-8").replace("satellite-000001.tar", "../../x"), "utf-8")
    else:
        server.faults += [403] * 3
    viewing._images._kept.clear()
    viewing._images.interrupt()
    seen = look_at(desk, viewing, 6) if wrong != "refused" else None
    if seen is None:
        viewing._step(1)
        desk.wait(lambda: not viewing.busy)
        seen = viewing.seen
    assert seen.picture.image is None
    said = {
        "gone": "satellite-000001.tar: is not there",
        "torn": "is torn",
        "other": "holds no image where the table says",
        "whole files only": "sends whole files only",
        "no shard": "names no part of a shard",
        "refused": "refuses: 403 Forbidden",
    }[wrong]
    assert said in seen.picture.problem
    assert "\n" not in seen.picture.problem
    assert not viewing.viewer.on_map.isEnabled()


def test_the_window_says_that_it_is_fetching_and_goes_on_to_others(desk, viewing, server, folder):
    open_address(desk, serve(server, folder))
    frame_map(desk, MISSION)
    first = look_at(desk, viewing, 0)
    server.latency_s = 30.0
    viewing._step(1)
    desk.wait(lambda: "Fetching" in viewing.viewer.view._text and server.under_way == 1)
    assert viewing.viewer.view.image is None
    server.latency_s = 0.0
    # Not after half a minute, but now.
    viewing._show_shot(first.shot)
    desk.wait(lambda: viewing.viewer.view.image is not None)
    assert viewing.seen.shot.name == first.shot.name


def test_a_folder_of_shards_on_this_machine_is_looked_at_as_well(desk, viewing, folder, tmp_path):
    place = write_shards(tmp_path / "run", folder)
    assert open_address(desk, str(place)) == ""
    frame_map(desk, MISSION)
    seen = look_at(desk, viewing, 11)
    original = folder / "satellite" / f"{seen.shot.name}.png"
    assert np.array_equal(shown_pixels(viewing), pixels_of_file(original))
    assert not desk.messages()
    desk.click(viewing.viewer.on_map)
    desk.wait(lambda: not viewing.busy and bool(QgsProject.instance().mapLayersByName(seen.shot.name)))
    assert QgsProject.instance().mapLayersByName(seen.shot.name)[0].isValid()


def test_opening_can_be_cancelled(desk, server, folder):
    address = serve(server, folder)
    server.latency_s = 30.0
    desk.session.missions.open_address(DatasetAddress.parse(address))
    desk.wait(lambda: server.under_way == 1)
    for task in QgsApplication.taskManager().tasks():
        task.cancel()
    desk.wait(lambda: not desk.session.missions.busy)
    assert desk.group() is None
    assert not desk.messages()


def test_a_copy_tells_its_address_and_nothing_else(desk, server, folder):
    address = serve(server, folder)
    open_address(desk, address)
    copy = copy_folder(DatasetAddress.parse(address))
    assert json.loads((copy / "address.json").read_text("utf-8")) == {"address": address}
    names = {path.relative_to(copy).as_posix() for path in copy.rglob("*") if path.is_file()}
    assert names == {"address.json", "mission.json", "footprints.geojson", "satellite/meta_data.csv"}


def as_table(items: Path, path: Path) -> bytes:
    """Items of GeoParquet in a format that every GDAL reads, with the same columns."""
    parquet = pytest.importorskip("pyarrow.parquet", reason="needs pyarrow")
    rows = parquet.read_table(items).to_pylist()
    made = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    layer = made.CreateLayer("items", None, ogr.wkbUnknown)
    kinds = {str: ogr.OFTString, float: ogr.OFTReal, int: ogr.OFTInteger64}
    names = [name for name, value in rows[0].items() if type(value) in kinds]
    for name in names:
        layer.CreateField(ogr.FieldDefn(name, kinds[type(rows[0][name])]))
    for row in rows:
        feature = ogr.Feature(layer.GetLayerDefn())
        for name in names:
            if row[name] is not None:
                feature.SetField(name, row[name])
        feature.SetGeometry(ogr.CreateGeometryFromWkb(row["geometry"]))
        layer.CreateFeature(feature)
    del layer, made
    return path.read_bytes()


# Debian's pytz, when pandas first loads it.
@pytest.mark.filterwarnings("ignore:invalid escape sequence:DeprecationWarning")
@pytest.mark.parametrize("layout", sampled(["folders", "shards"], 2))
def test_one_table_of_all_images_is_preferred(desk, viewing, server, folder, layout, tmp_path, monkeypatch):
    pytest.importorskip("pyarrow", reason="needs pyarrow")
    from terrainav.core.exports.stac import write_stac

    place = shutil.copytree(folder, tmp_path / "copy")
    place = laid_out(place, layout, tmp_path)
    write_stac(place, place)
    # GDAL of this QGIS may not read GeoParquet; the format is another here, and the columns are the same.
    monkeypatch.setattr(geoparquet, "_DRIVER", "GPKG")
    table = as_table(place / "items.parquet", tmp_path / "items.gpkg")
    (place / "items.parquet").write_bytes(table)
    address = serve(server, place)
    assert open_address(desk, f"{address}/items.parquet") == ""
    asked = {path.removeprefix("/data/run/") for _, path, _ in server.asked}
    assert asked == {"mission.json", "items.parquet"}
    copy = copy_folder(DatasetAddress.parse(address))
    assert not (copy / "items.parquet").exists()
    ours, theirs = (json.loads((one / "footprints.geojson").read_text("utf-8"))["features"] for one in (copy, folder))
    assert [one["properties"] for one in ours] == [one["properties"] for one in theirs]
    for one, other in zip(ours, theirs):
        assert one["geometry"]["type"] == other["geometry"]["type"]
        np.testing.assert_allclose(one["geometry"]["coordinates"], other["geometry"]["coordinates"], rtol=0, atol=1e-12)
    frame_map(desk, MISSION)
    seen = look_at(desk, viewing, 9)
    original = folder / "satellite" / f"{seen.shot.name}.png"
    assert np.array_equal(shown_pixels(viewing), pixels_of_file(original))
    assert "Entropy" in viewing.viewer.details.text()


def test_a_table_of_all_images_that_cannot_be_read_is_done_without(desk, server, folder, monkeypatch):
    monkeypatch.setattr(geoparquet, "_DRIVER", "GPKG")
    address = serve(server, folder)
    server.files["/data/run/items.parquet"] = (b"PAR1", '"1"')
    assert open_address(desk, address) == ""
    assert captured(desk).featureCount() == 20
    assert not desk.messages()


@pytest.mark.parametrize("inside", ["/{outside}/", "../../../{outside}/", "a/../../../{outside}/", ""])
def test_a_project_leads_to_no_file_outside_the_copies(plugin, tmp_path, inside):
    outside = tmp_path / "outside"
    outside.mkdir()
    rest = inside.format(outside=str(outside).lstrip("/"))
    source = f"/home/other/TerrAInav/addresses/{rest}footprints.geojson"
    found = local_copy(source)
    assert not list(outside.iterdir())
    if inside:
        assert found == source
    # QGIS reads halves of characters in a project's XML.
    for name in ("a\ud800", "a\0b", "a" * 300):
        assert local_copy(f"/TerrAInav/addresses/{name}/footprints.geojson").endswith("/footprints.geojson")
        assert copied_address(copy_folder(DatasetAddress("s3://b/run")).parent / name) is None
    # A project of another profile leads to this one's copy, with its options.
    ours = local_copy("../x/TerrAInav/addresses/0123/run/footprints.geojson|layername=footprints")
    assert (
        ours
        == f"{copy_folder(DatasetAddress('s3://b/run')).parent.parent}/0123/run/footprints.geojson|layername=footprints"
    )


@pytest.mark.parametrize(("size", "said"), [(-512, "states -512 bytes"), (-1024, "states -1,024 bytes")])
def test_a_file_of_negative_size_in_a_shard_is_said(plugin, tmp_path, size, said):
    data, member = b"image" + bytes(507), tarfile.TarInfo("0.jgw")
    first = tarfile.TarInfo("0.png")
    first.size, member.size = 5, size
    (tmp_path / "satellite").mkdir()
    (tmp_path / "satellite" / "x.tar").write_bytes(first.tobuf() + data + member.tobuf(tarfile.GNU_FORMAT))
    row = {"shard": "x.tar", "offset_bytes": "512", "size_bytes": "5"}
    with pytest.raises(InvalidInput, match=rf"x\.tar: {said} for the file at byte 1,024$"):
        ImageFetcher().fetch(tmp_path, "satellite", "a.png", row)


# --- servers that answer with other parts than were asked for

PARTS = {
    "nothing, again and again": (
        lambda first, last: (b" " * (last + 1), f"bytes 0-{last}/999999999")
        if first == 0
        else (b"", f"bytes {first}-{first - 1}/999999999")
    ),
    "a size of 4,500 digits": lambda first, last: (b" " * (last + 1 - first), f"bytes {first}-{last}/{'9' * 4500}"),
    "a mission of 16 GB": lambda first, last: (b" " * (last + 1 - first), f"bytes {first}-{last}/{16 * 10**9}"),
}  # fmt: skip


@pytest.mark.parametrize("kind", PARTS)
def test_a_server_that_sends_other_parts_is_left_at_once(desk, server, folder, kind):
    address = serve(server, folder)
    server.sends_instead = PARTS[kind]

    def stop():
        desk.session.missions._task.cancel()

    # One that goes on would be asked for hours.
    server.when = 20, stop
    open_address(desk, address)
    assert len(server.asked) < 20
    (message,) = desk.messages()
    assert "mission.json" in message
    assert "unexpected" not in message
    assert len(message) < 500
