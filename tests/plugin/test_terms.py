"""Terms of providers hold for layers of every kind, wherever an address stands."""

from __future__ import annotations

from urllib.parse import quote

import numpy as np
import pytest
from osgeo import gdal, osr
from qgis.core import QgsProject, QgsRasterLayer, QgsVectorLayer, QgsVectorTileLayer
from terrainav.core.imagery import entry
from terrainav.core.imagery.entry import shipped_entry
from terrainav.terrainav_plugin.qgis_source.snapshot import (
    PROJECT_SOURCE,
    policies_of_layers,
    source_name,
    take_snapshot,
)
from terrainav.terrainav_plugin.qgis_source.terms import known_providers

from tests.support.services import ServiceServer, wms_document

OSM = "https://tile.openstreetmap.org/{z}/{x}/{y}.png"
XYZ = f"type=xyz&url={quote(OSM, safe=':/')}&zmin=0&zmax=19"
WMS = """<GDAL_WMS><Service name="TMS"><ServerUrl>{url}</ServerUrl></Service><DataWindow>
<UpperLeftX>-20037508.34</UpperLeftX><UpperLeftY>20037508.34</UpperLeftY><LowerRightX>20037508.34</LowerRightX>
<LowerRightY>-20037508.34</LowerRightY><TileLevel>18</TileLevel><TileCountX>1</TileCountX><TileCountY>1</TileCountY>
<YOrigin>top</YOrigin></DataWindow><Projection>EPSG:3857</Projection><BlockSizeX>256</BlockSizeX>
<BlockSizeY>256</BlockSizeY><BandsCount>3</BandsCount></GDAL_WMS>"""
GDAL_OSM = "https://tile.openstreetmap.org/${z}/${x}/${y}.png"


def limits_of(layer):
    """Terms of a layer of the project."""
    assert layer.isValid()
    QgsProject.instance().addMapLayer(layer)
    name = source_name(layer)
    found = [(one.bulk_allowed, one.max_tiles) for one, _ in policies_of_layers(name, QgsProject.instance())]
    of_snapshot = take_snapshot(name, QgsProject.instance()).policy
    assert (of_snapshot.bulk_allowed, of_snapshot.max_tiles) == (found[0] if found else ("yes", None))
    return found


@pytest.mark.parametrize(
    "source",
    [
        XYZ,
        XYZ.replace("tile.open", "a.tile.open"),
        XYZ.replace("tile.open", "TILE.open").replace(".org/", ".org.:443/"),
        XYZ.replace("tile.open", "%74ile.open"),
        XYZ.replace("https://", "https://me:mine@"),
        f"{XYZ}&username=a&password=b",
        f"{XYZ}&interpretation=terrariumterrain",
        f"{XYZ}&tilePixelRatio=2",
        XYZ.replace(".png", ".png?apikey%3Dx%26token%3Dy"),
        f"crs=EPSG:3857&{XYZ}",
    ],
)
def test_terms_hold_for_xyz_layers_of_every_spelling(source):
    assert limits_of(QgsRasterLayer(source, "mine", "wms")) == [("no", 250)]


def vrt(tmp_path, name, source):
    """VRT of a raster, by GDAL's own words but for the source's name."""
    path = tmp_path / name
    path.write_text(
        f'<VRTDataset rasterXSize="512" rasterYSize="512"><SRS>EPSG:3857</SRS><GeoTransform>0,1,0,0,0,-1</GeoTransform>'
        f'<VRTRasterBand dataType="Byte" band="1"><SimpleSource><SourceFilename relativeToVRT="1">{source}'
        f"</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>"
    )
    return path


def test_terms_hold_for_descriptions_in_files(tmp_path):
    """GDAL's descriptions of tiles, however the address is written there, and whatever leads to them."""
    spellings = {
        "plain": GDAL_OSM,
        "bare": GDAL_OSM.partition("//")[2],
        "entities": GDAL_OSM.replace("tile", "&#116;ile"),
        "cdata": f"<![CDATA[{GDAL_OSM}]]>",
        "upper": GDAL_OSM.replace("tile.openstreetmap.org", "TILE.OPENSTREETMAP.ORG:443"),
    }
    for name, url in spellings.items():
        (tmp_path / f"{name}.xml").write_text(WMS.format(url=url))
        assert limits_of(QgsRasterLayer(str(tmp_path / f"{name}.xml"), name, "gdal")) == [("no", 250)], name
    inner = vrt(tmp_path, "inner.vrt", "plain.xml")
    outer = vrt(tmp_path, "outer.vrt", inner.name)
    escaped = WMS.format(url=GDAL_OSM).replace("\n", "").replace("<", "&lt;")
    inline = vrt(tmp_path, "inline.vrt", escaped)
    gdal.FileFromMemBuffer("/vsimem/osm.xml", WMS.format(url=GDAL_OSM).encode())
    for source in (str(inner), str(outer), str(inline), WMS.format(url=GDAL_OSM), "/vsimem/osm.xml"):
        layer = QgsRasterLayer(source, "mine", "gdal")
        if layer.isValid():
            # Not by a snapshot: GDAL 3.6 ends QGIS where copies of a VRT of a VRT are still open when it quits.
            assert [one.policy.max_tiles for one in known_providers(layer)] == [250], source[:80]
    gdal.Unlink("/vsimem/osm.xml")
    # A file that is another one by now is looked at again.
    path = tmp_path / "upper.xml"
    path.write_text(WMS.format(url="https://tiles.example/${z}/${x}/${y}.png"))
    assert limits_of(QgsRasterLayer(str(path), "other", "gdal")) == []


def test_files_of_pictures_have_no_terms_whatever_they_are_called(tmp_path):
    folder = tmp_path / "tile.openstreetmap.org"
    folder.mkdir()
    driver, crs = gdal.GetDriverByName("GTiff"), osr.SpatialReference()
    crs.ImportFromEPSG(3857)
    file = driver.Create(str(folder / "1.tif"), 512, 512, 1)
    file.SetGeoTransform((0, 1, 0, 0, 0, -1))
    file.SetProjection(crs.ExportToWkt())
    file.GetRasterBand(1).WriteArray(np.ones((512, 512), np.uint8))
    file = None
    assert limits_of(QgsRasterLayer(str(folder / "1.tif"), "mine", "gdal")) == []
    mosaic = vrt(tmp_path, "mosaic.vrt", "tile.openstreetmap.org/1.tif")
    assert limits_of(QgsRasterLayer(str(mosaic), "mosaic", "gdal")) == []


def test_who_refers_to_a_server_is_not_asked():
    other = XYZ.replace("tile.openstreetmap.org", "tiles.example")
    for referer in ("&referer=https://tile.openstreetmap.org", "&http-header:referer=https://tile.osm.org"):
        assert limits_of(QgsRasterLayer(other + referer, "mine", "wms")) == []


@pytest.fixture
def provider(monkeypatch):
    """OpenStreetMap's terms for the loopback."""
    data = dict(entry.shipped_data())
    data["osm"] = {**data["osm"], "hosts": ["127.0.0.1"]}
    monkeypatch.setattr(entry, "shipped_data", lambda: data)
    return shipped_entry("osm").policy


def test_terms_hold_for_the_host_that_a_service_names_for_its_pictures(provider):
    """The capabilities are of localhost, and the pictures of 127.0.0.1; no further request is made to find out."""
    layer = (
        "<Layer><Title>a</Title><CRS>EPSG:3857</CRS><Layer queryable='0'><Name>a</Name><Title>a</Title>"
        "<BoundingBox CRS='EPSG:3857' minx='0' miny='0' maxx='9' maxy='9'/></Layer></Layer>"
    )
    with ServiceServer() as server:
        server.answer = lambda *_: (200, "text/xml", wms_document("1.3.0", f"{server.url}/wms", layer))
        url = server.url.replace("127.0.0.1", "localhost") + "/capabilities"
        found = QgsRasterLayer(f"crs=EPSG:3857&format=image/png&layers=a&styles=&url={url}", "mine", "wms")
        asked = len(server.asked)
        assert [one.policy for one in known_providers(found)] == [provider]
        assert len(server.asked) == asked
        assert limits_of(found) == [("no", provider.max_tiles)]


def test_terms_hold_for_layers_that_are_no_rasters_and_above_others():
    """Vector tiles, and rasters over vectors, which are drawn as a whole picture."""
    tiles = QgsVectorTileLayer(f"type=xyz&url={quote(OSM, safe='')}&zmin=0&zmax=14", "vectors")
    assert limits_of(tiles) == [("no", 250)]
    QgsProject.instance().clear()
    below = QgsVectorLayer("Point?crs=EPSG:3857", "below", "memory")
    above = QgsRasterLayer(XYZ, "above", "wms")
    QgsProject.instance().addMapLayers([above, below])
    ((policy, title),) = policies_of_layers(PROJECT_SOURCE, QgsProject.instance())
    assert (policy.bulk_allowed, policy.max_tiles, title) == ("no", 250, "above")


def test_layers_of_one_provider_share_what_it_allows():
    layers = [QgsRasterLayer(XYZ, name, "wms") for name in ("one", "two")]
    google = QgsRasterLayer(XYZ.replace("tile.openstreetmap.org", "maps.googleapis.com"), "google", "wms")
    QgsProject.instance().addMapLayers([google, *layers])
    found = policies_of_layers(PROJECT_SOURCE, QgsProject.instance())
    # What nothing overrides comes first.
    assert [(one.bulk_allowed, one.max_tiles) for one, _ in found] == [("no", 125), ("ask", 500)]
    assert sorted(found[0][1].split(", ")) == ["one", "two"]
