"""Vectors of a stranger's dataset: opened as footprints alone, or refused; no server and no other file is asked."""

from __future__ import annotations

import json
import os
import shutil

import pytest
from qgis.core import (
    QgsExpression,
    QgsExpressionContext,
    QgsExpressionContextUtils,
    QgsProject,
    QgsRasterLayer,
)
from qgis.PyQt.QtWidgets import QFileDialog
from terrainav.core.capture.journal import FAILED
from terrainav.core.dataset.vectors import check_geojson
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.mission import Mission
from terrainav.terrainav_plugin.dataset.layers import FailedImages, open_failed, open_footprints, open_raster
from terrainav.terrainav_plugin.dataset.picture import read_depth, read_picture
from terrainav.terrainav_plugin.dataset.placing import _name_pictures
from terrainav.terrainav_plugin.foreign import check_raster
from terrainav.terrainav_plugin.remote.address import DatasetAddress
from terrainav.terrainav_plugin.remote.copies import copied_address, copy_folder
from terrainav.terrainav_plugin.results.shots import Finder, FootprintLayer

from tests.plugin.test_addresses import open_address, serve
from tests.plugin.test_project import choose_in_menu
from tests.support.ranges import RangeServer
from tests.support.shards import write_folders
from tests.support.thinning import sampled

POINT = '{"type": "Feature", "properties": {"name": "1_1"}, "geometry": {"type": "Point", "coordinates": [1, 2]}}'
# What a file called footprints.geojson may be instead, and the address that each names, or a file outside.
DOCUMENTS = {
    "vrt": '<OGRVRTDataSource><OGRVRTLayer name="x"><SrcDataSource>/vsicurl/{url}/x.geojson</SrcDataSource>'
    "</OGRVRTLayer></OGRVRTDataSource>",
    "vrt of a file": '<OGRVRTDataSource><OGRVRTLayer name="x"><SrcDataSource>{file}</SrcDataSource></OGRVRTLayer>'
    "</OGRVRTDataSource>",
    "wfs": "<OGRWFSDataSource><URL>{url}/wfs</URL></OGRWFSDataSource>",
    "gml": '<gml:FeatureCollection xmlns:gml="http://www.opengis.net/gml" xmlns:xlink="http://www.w3.org/1999/xlink">'
    '<gml:featureMember xlink:href="{url}/x.gml#a"/></gml:FeatureCollection>',
    "kml": '<kml xmlns="http://www.opengis.net/kml/2.2"><NetworkLink><Link><href>{url}/x.kml</href></Link>'
    "</NetworkLink></kml>",
    "vrt in a name": '{{"type": "FeatureCollection", "name": "<OGRVRTDataSource><OGRVRTLayer name=\'x\'>'
    "<SrcDataSource>/vsicurl/{url}/x.geojson</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>\", "
    '"features": [{point}]}}',
    "link": '{{"type": "FeatureCollection", "crs": {{"type": "link", "properties": {{"href": "{url}/x"}}}}, '
    '"features": [{point}]}}',
    "link in a geometry": '{{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": {{}}, '
    '"geometry": {{"type": "Point", "\\u0063RS": {{"type": "link", "properties": {{"href": "{url}/x"}}}}, '
    '"coordinates": [1, 2]}}}}]}}',
    "address as a name": '{{"type": "FeatureCollection", "crs": {{"type": "name", "properties": {{"name": "{url}/x"}}}}'
    ', "features": [{point}]}}',
    "grid": '{{"type": "FeatureCollection", "crs": {{"type": "name", "properties": {{"name": '
    '"+proj=longlat +nadgrids={file} +no_defs"}}}}, "features": [{point}]}}',
    "esri": '{{"displayFieldName": "", "geometryType": "esriGeometryPoint", "features": []}}',
    "topology": '{{"type": "Topology", "objects": {{}}, "arcs": []}}',
    "not json": "name,lat\n1,2\n",
    "nothing": "",
}  # fmt: skip


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    return write_folders(tmp_path_factory.mktemp("captured") / "run")


@pytest.fixture
def folder(captured, tmp_path):
    return shutil.copytree(captured, tmp_path / "run")


@pytest.fixture
def server():
    with RangeServer() as running:
        yield running


@pytest.fixture
def other():
    """The server that a file leads to."""
    with RangeServer() as running:
        yield running


def document(kind, other, tmp_path):
    outside = tmp_path / "outside.geojson"
    outside.write_text(f'{{"type": "FeatureCollection", "features": [{POINT}]}}', "utf-8")
    return DOCUMENTS[kind].format(url=other.url, file=outside, point=POINT)


def open_folder(desk, monkeypatch, folder):
    monkeypatch.setattr(QFileDialog, "getExistingDirectory", lambda *_: str(folder))
    choose_in_menu(desk, "Open dataset folder…")
    desk.wait(lambda: not desk.session.missions.busy)
    desk.wait_for_tasks()


@pytest.mark.parametrize("kind", sampled(DOCUMENTS, 4))
def test_what_is_no_footprints_is_refused_when_a_folder_is_opened(desk, monkeypatch, folder, other, tmp_path, kind):
    (folder / "footprints.geojson").write_text(document(kind, other, tmp_path), "utf-8")
    open_folder(desk, monkeypatch, folder)
    (message,) = desk.messages()
    assert "footprints.geojson" in message
    assert "\n" not in message
    assert QgsProject.instance().mapLayers() == {}
    assert other.asked == []


@pytest.mark.parametrize("kind", ["vrt", "wfs", "vrt in a name", "link"])
def test_what_is_no_footprints_is_refused_at_an_address(desk, folder, server, other, tmp_path, kind):
    (folder / "footprints.geojson").write_text(document(kind, other, tmp_path), "utf-8")
    address = serve(server, folder)
    open_address(desk, address)
    desk.wait_for_tasks()
    assert "footprints.geojson" in desk.messages()[0]
    assert QgsProject.instance().mapLayers() == {}
    assert other.asked == []
    # A project that shows the copy would open whatever lay there.
    copy = copy_folder(DatasetAddress.parse(address))
    assert [path.name for path in copy.glob("*.geojson*")] == []


def test_footprints_that_turn_bad_leave_the_copy_as_it_was(desk, folder, server, other, tmp_path):
    address = serve(server, folder)
    assert open_address(desk, address) == ""
    good = (copy_folder(DatasetAddress.parse(address)) / "footprints.geojson").read_bytes()
    (folder / "footprints.geojson").write_text(document("vrt", other, tmp_path), "utf-8")
    serve(server, folder)
    open_address(desk, address)
    assert (copy_folder(DatasetAddress.parse(address)) / "footprints.geojson").read_bytes() == good
    assert other.asked == []


def test_a_style_beside_footprints_is_not_taken(folder, other):
    """It may fetch symbols, and hold actions of Python."""
    style = (
        '<!DOCTYPE qgis><qgis styleCategories="AllStyleCategories"><mapTip>theirs</mapTip>'
        f'<attributeactions><actionsetting type="1" action="print({other.url!r})" name="theirs" '
        'isEnabledOnlyWhenEditable="0">'
        '<actionScope id="Canvas"/></actionsetting></attributeactions></qgis>'
    )
    for ending in (".qml", ".geojson.qml"):
        (folder / f"footprints{ending}").write_text(style, "utf-8")
    layer = open_footprints(folder / "footprints.geojson", "x")
    assert layer.mapTipTemplate() == ""
    assert layer.actions().actions() == []


def test_a_style_beside_an_image_is_not_taken(folder):
    """Newer QGIS evaluates its expressions, which may open layers, and shows its map tip."""
    image = next((folder / "satellite").glob("*.png"))
    image.with_suffix(".qml").write_text(
        "<!DOCTYPE qgis><qgis styleCategories='AllStyleCategories'><customproperties><Option type='Map'>"
        "<Option name='theirs' type='QString' value='1'/></Option></customproperties><pipe>"
        "<rasterrenderer type='singlebandgray' grayBand='1' opacity='0.3' alphaBand='-1'/></pipe></qgis>",
        "utf-8",
    )
    layer = open_raster(image, "x")
    assert "theirs" not in layer.customPropertyKeys()
    assert layer.opacity() == 1.0
    # QGIS itself takes it.
    assert "theirs" in QgsRasterLayer(str(image), "x", "gdal").customPropertyKeys()


def test_a_pipe_in_an_images_place_is_in_no_map_tip(clean_project, folder):
    """QGIS would wait for what comes out of it, for good."""
    layer = open_footprints(folder / "footprints.geojson", "x")
    clean_project.addMapLayer(layer)
    _name_pictures(layer, Mission.load(folder / "mission.json"), has_paths=True)
    feature = next(layer.getFeatures())

    def tip():
        context = QgsExpressionContext(QgsExpressionContextUtils.globalProjectLayerScopes(layer))
        context.setFeature(feature)
        return QgsExpression.replaceExpressionText(layer.mapTipTemplate(), context)

    image = folder / "satellite" / f"{feature['name']}.png"
    shown = f'<img src="file:///{image}" width="320"/>'
    assert shown in tip()
    image.unlink()
    assert "<img" not in tip()
    os.mkfifo(image)
    assert "<img" not in tip()
    assert str(image) in tip()
    image.unlink()
    image.symlink_to("/dev/zero")
    assert "<img" not in tip()


@pytest.mark.parametrize("name", ["../../outside", "/outside", "..", "a\0b", "a\u202eb", ""])
def test_an_images_name_leads_into_its_folder_only(folder, name):
    path = folder / "footprints.geojson"
    lines = path.read_text("utf-8").splitlines()
    at = next(number for number, line in enumerate(lines) if line.startswith('{"type": "Feature"'))
    feature = json.loads(lines[at].rstrip(","))
    feature["properties"]["name"] = name
    lines[at] = json.dumps(feature) + ","
    path.write_text("\n".join(lines), "utf-8")
    footprints = FootprintLayer("x", folder)
    with pytest.raises(InvalidInput, match="not the name of an image"):
        Finder(lambda: False).first([footprints])


def test_a_folder_that_says_it_is_a_copy_asks_no_address(desk, monkeypatch, folder, other):
    (folder / "address.json").write_text(json.dumps({"address": f"{other.url}/run"}), "utf-8")
    assert copied_address(folder) is None
    open_folder(desk, monkeypatch, folder)
    assert "Captured images" in desk.layer_names()
    assert other.asked == []
    inside = copy_folder(DatasetAddress(f"{other.url}/run")).parents[1] / ".." / "run"
    assert copied_address(inside) is None


def test_a_reason_in_the_journal_is_no_document(folder, other, tmp_path):
    name = next(iter(json.loads((folder / "footprints.geojson").read_text("utf-8"))["features"]))["properties"]["name"]
    line = {
        "map_type": "satellite",
        "name": name,
        "status": FAILED,
        "reason": document("vrt", other, tmp_path),
    }
    with (folder / "journal.jsonl").open("a", encoding="utf-8") as journal:
        journal.write(json.dumps(line) + "\n")
    assert FailedImages(folder).update()
    layer = open_failed(folder)
    (feature,) = layer.getFeatures()
    assert "OGRVRTDataSource" in feature["reason"]
    assert other.asked == []


def test_a_pipe_is_no_footprints(folder):
    path = folder / "footprints.geojson"
    path.unlink()
    os.mkfifo(path)
    with pytest.raises(InvalidInput, match="not a regular file"):
        check_geojson(path)


def test_processing_loads_no_document(desk, folder, other, tmp_path):
    from qgis import processing
    from qgis.core import QgsProcessingContext, QgsProcessingFeedback

    (folder / "footprints.geojson").write_text(document("vrt", other, tmp_path), "utf-8")
    context, feedback = QgsProcessingContext(), QgsProcessingFeedback(False)
    context.setProject(QgsProject.instance())
    processing.run(
        "terrainav:capturefailed", {"DATASET": str(folder), "LOAD": True, "MAKE_MOSAIC": False}, context=context,
        feedback=feedback,
    )  # fmt: skip
    to_load = [path for path in context.layersToLoadOnCompletion() if path.endswith(".geojson")]
    # A capture writes its footprints anew; what cannot be read as such is not loaded.
    assert to_load == [] or check_geojson(to_load[0]) is None
    assert other.asked == []


@pytest.mark.parametrize(
    "text",
    ["<GDAL_WMS><Service name='WMS'><ServerUrl>{url}/wms?</ServerUrl></Service></GDAL_WMS>",
     ("<VRTDataset rasterXSize='1' rasterYSize='1'><VRTRasterBand dataType='Byte' band='1'><SimpleSource>"
     "<SourceFilename>/vsicurl/{url}/x.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>")],
)  # fmt: skip
def test_a_reference_of_a_benchmark_is_a_picture(tmp_path, other, text):
    path = tmp_path / "mosaic.tif"
    path.write_text(text.format(url=other.url), "utf-8")
    with pytest.raises(InvalidInput, match=r"mosaic\.tif"):
        check_raster(path)
    assert other.asked == []


@pytest.mark.parametrize("ending", ["png", "tif", "jpg"])
def test_an_image_of_a_dataset_is_an_image(tmp_path, other, ending):
    """And no virtual raster, which GDAL takes it for by what is in it."""
    path = tmp_path / f"1_1.{ending}"
    path.write_text(
        "<VRTDataset rasterXSize='1' rasterYSize='1'><VRTRasterBand dataType='Byte' band='1'><SimpleSource>"
        f"<SourceFilename>/vsicurl/{other.url}/x.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>",
        "utf-8",
    )
    assert read_picture(path, 100).problem
    assert read_depth(path, 100).problem
    assert read_picture(path, 100, path.read_bytes()).problem
    assert other.asked == []


# What may lie beside an image that GDAL opens with it, and leads to a server.
_TMS = (
    "<GDAL_WMS><Service name='TMS'><ServerUrl>{url}/${{z}}/${{x}}/${{y}}.png</ServerUrl></Service><DataWindow>"
    "<UpperLeftX>0</UpperLeftX><UpperLeftY>0</UpperLeftY><LowerRightX>1</LowerRightX><LowerRightY>1</LowerRightY>"
    "<TileLevel>1</TileLevel><TileCountX>1</TileCountX><TileCountY>1</TileCountY></DataWindow>"
    "<BandsCount>3</BandsCount><BlockSizeX>256</BlockSizeX><BlockSizeY>256</BlockSizeY></GDAL_WMS>"
)
_VIRTUAL = (
    "<VRTDataset rasterXSize='200' rasterYSize='200'><VRTRasterBand dataType='Byte' band='1'><SimpleSource>"
    "<SourceFilename>/vsicurl/{url}/x.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>"
)
_NOTES = (
    "<PAMDataset><Metadata domain='OVERVIEWS'><MDI key='OVERVIEW_FILE'>/vsicurl/{url}/x.tif</MDI></Metadata>"
    "</PAMDataset>"
)
BESIDE = {
    "service": (".ovr", _TMS),
    "service, upper case": (".OVR", _TMS),
    "virtual": (".ovr", _VIRTUAL),
    "mask": (".msk", _TMS),
    "metadata": (
        ".aux.xml",
        _NOTES,
    ),
}


@pytest.mark.parametrize("kind", BESIDE)
@pytest.mark.parametrize("ending", ["png", "tif", "jpg"])
def test_overviews_beside_an_image_lead_nowhere(tmp_path, other, ending, kind):
    """GDAL opens them as whatever they are, by whatever driver, as soon as less than all pixels are read."""
    from osgeo import gdal

    path = tmp_path / f"1_1.{ending}"
    driver = {"png": "PNG", "tif": "GTiff", "jpg": "JPEG"}[ending]
    image = gdal.GetDriverByName("MEM").Create("", 400, 400, 3)
    gdal.GetDriverByName(driver).CreateCopy(str(path), image)
    del image
    beside, text = BESIDE[kind]
    name = path.name if beside.islower() else path.name.upper()
    path.with_name(name + beside).write_text(text.format(url=other.url), "utf-8")
    picture, depth = read_picture(path, 100), read_depth(path, 100)
    assert other.asked == []
    assert picture.problem
    assert depth.problem
