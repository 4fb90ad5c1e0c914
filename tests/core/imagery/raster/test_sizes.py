"""Rasters with more of something than there may be: they are refused in one line, before GDAL is busy with them."""

from __future__ import annotations

import struct

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.imagery.raster import reading, trust  # noqa: E402
from terrainav.core.imagery.raster.sizes import check_block  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.limits import (  # noqa: E402
    MAX_RASTER_BANDS,
    MAX_RASTER_BLOCK_BYTES,
    MAX_RASTER_ITEMS,
    MAX_RASTER_OVERVIEWS,
    MAX_TIFF_DIRECTORIES,
    MAX_VRT_DEPTH,
    MAX_VRT_SOURCES,
    MAX_XML_DEPTH,
)

from tests.support import rasters  # noqa: E402
from tests.support.growth import PROPORTIONAL, growth  # noqa: E402
from tests.support.thinning import sampled  # noqa: E402

PLACE = (690_000.0, 1.0, 0.0, 5_300_000.0, 0.0, -1.0)
SOURCE = '<SimpleSource><SourceFilename relativeToVRT="1">{0}</SourceFilename></SimpleSource>'
BAND = '<VRTRasterBand dataType="Byte" band="1">{0}</VRTRasterBand>'


def sparse(path, width, height, bands=1, data_type=gdal.GDT_Byte, options=()):
    """A GeoTIFF of which nothing is written but its directory."""
    made = gdal.GetDriverByName("GTiff").Create(
        str(path), width, height, bands, data_type, options=["SPARSE_OK=YES", *options]
    )
    made.SetGeoTransform(PLACE)
    made.SetProjection("EPSG:25832")
    made.FlushCache()
    return path


def vrt(path, content):
    place = ",".join(map(str, PLACE))
    path.write_text(
        f'<VRTDataset rasterXSize="8" rasterYSize="8"><SRS>EPSG:25832</SRS><GeoTransform>{place}</GeoTransform>'
        f"{content}</VRTDataset>"
    )
    return path


def refusal(path, **options):
    with pytest.raises(InvalidInput) as raised:
        open_raster(path, **options)
    text = str(raised.value)
    assert "\n" not in text
    assert text.startswith(str(path))
    return text


@pytest.fixture
def one(tmp_path):
    return rasters.write(tmp_path / "one.tif", np.ones((1, 8, 8), np.uint8), PLACE, 25832)


def test_bands_are_counted_before_they_are_read(tmp_path, library, monkeypatch):
    path = sparse(tmp_path / "b.tif", 4, 4, 65_535, options=["INTERLEAVE=PIXEL", "COMPRESS=DEFLATE"])
    assert path.stat().st_size < 400_000
    made = []
    monkeypatch.setattr(reading, "Band", lambda **facts: made.append(facts))
    assert f"has 65,535 bands: must be at most {MAX_RASTER_BANDS:,}" in refusal(path)
    assert not made


def test_facts_of_bands_take_time_in_proportion_to_their_number(tmp_path, library):
    files = {}
    kind = {"gdal": reading.GdalFile, "rasterio": reading.RasterioFile}[library]

    def read(count):
        if count not in files:
            files[count] = str(sparse(tmp_path / f"{count}.tif", 4, 4, count, options=["INTERLEAVE=PIXEL"]))
        file = kind(files[count], 0)
        assert len(file.facts().bands) == count
        file.close()

    read(8 * 150)
    assert growth(read, 150) < PROPORTIONAL


@pytest.mark.parametrize(
    ("width", "height", "bands", "data_type", "options"),
    [
        (20_000, 20_000, 1, gdal.GDT_UInt16, ("COMPRESS=DEFLATE", "BLOCKYSIZE=20000")),
        (16_384, 16_384, 3, gdal.GDT_Byte, ("TILED=YES", "BLOCKXSIZE=16384", "BLOCKYSIZE=16384")),
        (512, 512, 2_000, gdal.GDT_Byte, ("TILED=YES", "BLOCKXSIZE=512", "BLOCKYSIZE=512")),
        (8_192, 8_192, 1, gdal.GDT_CFloat64, ("COMPRESS=ZSTD", "BLOCKYSIZE=8192")),
    ],
    ids=["strip", "tile", "all bands of a tile", "complex"],
)
@pytest.mark.parametrize("through", ["", "VRT", "mask", "overviews"])
def test_blocks_that_fill_memory_are_refused(tmp_path, library, one, width, height, bands, data_type, options, through):
    name = {"mask": "one.tif.msk", "overviews": "one.tif.ovr"}.get(through, "big.tif")
    big = sparse(tmp_path / name, width, height, bands, data_type, [*options, "INTERLEAVE=PIXEL", "BIGTIFF=YES"])
    path = {"": big, "VRT": vrt(tmp_path / "big.vrt", BAND.format(SOURCE.format(name)))}.get(through, one)
    text = refusal(path, heights=True)
    assert f"must be at most {MAX_RASTER_BLOCK_BYTES >> 20} MB; make a copy in tiles, with gdal_translate" in text
    assert f"{name} is decoded in blocks of " in text


def test_gdal_is_asked_for_blocks_of_formats_that_are_not_looked_through(tmp_path, library, monkeypatch):
    header = "\n".join(["ENVI", "samples = 300000000", "lines = 2", "bands = 1", "data type = 1", "interleave = bsq"])
    (tmp_path / "e.hdr").write_text(header + "\n")
    path = tmp_path / "e.dat"
    with path.open("wb") as file:
        file.truncate(600_000_000)
    looked_through = []
    monkeypatch.setattr(trust, "may_name_file", lambda data: bool(looked_through.append(len(data))))
    assert "is decoded in blocks of 300,000,000x1 px, 286 MB each" in refusal(path)
    # Pixels alone are in it, and what describes them beside it.
    assert looked_through == [len(header) + 1]


@pytest.mark.parametrize(
    ("width", "height", "bands", "data_type", "options"),
    sampled(
        [
            (3_601, 3_601, 1, gdal.GDT_Int16, ("COMPRESS=DEFLATE", "BLOCKYSIZE=3601")),
            (10_000, 10_000, 3, gdal.GDT_Byte, ()),
            (10_000, 10_000, 3, gdal.GDT_Byte, ("BLOCKYSIZE=10000",)),
            (20_000, 20_000, 4, gdal.GDT_UInt16, ("BLOCKYSIZE=20000", "BIGTIFF=YES")),
            (40_000, 40_000, 3, gdal.GDT_Byte, ("COMPRESS=JPEG", "BLOCKYSIZE=8", "PHOTOMETRIC=YCBCR")),
            (40_000, 40_000, 1, gdal.GDT_Byte, ("NBITS=1", "COMPRESS=CCITTFAX4", "BLOCKYSIZE=40000")),
            (100_000, 100_000, 3, gdal.GDT_Byte, ("TILED=YES", "COMPRESS=LZW", "BIGTIFF=YES")),
        ],
        4,
    ),
    ids=[
        "heights in a strip",
        "rows",
        "uncompressed strip",
        "uncompressed strip of 3.2 GB",
        "JPEG",
        "fax",
        "tiles",
    ],
)
def test_usual_rasters_pass(tmp_path, library, width, height, bands, data_type, options):
    path = sparse(tmp_path / "usual.tif", width, height, bands, data_type, options)
    open_raster(path, as_stored=True).close()
    open_raster(vrt(tmp_path / "usual.vrt", BAND.format(SOURCE.format("usual.tif"))), as_stored=True).close()


def test_no_block_is_larger_than_the_limit():
    side = 1 << 14
    check_block(side, side, MAX_RASTER_BLOCK_BYTES / side**2)
    with pytest.raises(InvalidInput, match="is decoded in blocks of 16,384x16,385 px"):
        check_block(side, side + 1, MAX_RASTER_BLOCK_BYTES / side**2)


@pytest.mark.parametrize(
    ("content", "most", "what"),
    sampled(
        [
            (lambda n: '<VRTRasterBand dataType="Byte"/>' * n, MAX_RASTER_BANDS, "bands"),
            (lambda n: BAND.format("<Overview/>" * n), MAX_RASTER_OVERVIEWS, "overviews of a band"),
            (lambda n: BAND.format("") + "<MDI/>" * n, MAX_RASTER_ITEMS, "items of metadata"),
            (lambda n: BAND.format("") + "<GCPList>" + "<GCP/>" * n, MAX_RASTER_ITEMS, "ground control points"),
        ],
        3,
    ),
    ids=["bands", "overviews", "metadata", "points"],
)
def test_what_a_vrt_has_is_counted_before_gdal_sees_it(tmp_path, library, monkeypatch, content, most, what):
    monkeypatch.setattr(reading, "NativeCall", None)
    text = refusal(vrt(tmp_path / "many.vrt", content(most + 1)))
    assert f"many.vrt has {most + 1:,} {what} or more: must be at most {most:,}" in text


def test_sources_of_a_vrt_are_counted(tmp_path, library, one, monkeypatch):
    monkeypatch.setattr(reading, "NativeCall", None)
    path = vrt(tmp_path / "many.vrt", BAND.format(SOURCE.format("one.tif") * (MAX_VRT_SOURCES + 1)))
    text = refusal(path)
    assert f"many.vrt reads files more than {MAX_VRT_SOURCES:,} times; make one raster of it" in text


def test_sources_of_vrts_within_others_are_counted_as_often_as_they_are_read(tmp_path, library, one, monkeypatch):
    named = "one.tif"
    for level in range(MAX_VRT_DEPTH - 1):
        path = vrt(tmp_path / f"{level}.vrt", BAND.format(SOURCE.format(named) * 20))
        named = path.name
    monkeypatch.setattr(reading, "NativeCall", None)
    assert f"vrt reads files more than {MAX_VRT_SOURCES:,} times" in refusal(path)
    monkeypatch.undo()
    open_raster(tmp_path / "1.vrt", heights=True).close()


def test_a_file_that_a_vrt_reads_often_is_looked_at_once(tmp_path, library, one, monkeypatch):
    looked_at = []
    head = trust._head
    monkeypatch.setattr(trust, "_head", lambda file, *size: looked_at.append(file.name) or head(file, *size))
    open_raster(vrt(tmp_path / "m.vrt", BAND.format(SOURCE.format("one.tif") * 500)), heights=True).close()
    assert looked_at.count("one.tif") == 1


def test_elements_of_a_vrt_within_each_other_are_refused(tmp_path, library, monkeypatch):
    monkeypatch.setattr(reading, "NativeCall", None)
    text = refusal(vrt(tmp_path / "deep.vrt", "<a>" * 10_000 + "</a>" * 10_000))
    assert f"more than {MAX_XML_DEPTH} within each other" in text


@pytest.mark.parametrize("loops", [True, False])
def test_directories_of_a_tiff_are_counted(tmp_path, library, monkeypatch, loops):
    monkeypatch.setattr(reading, "NativeCall", None)
    content = bytearray(b"II*\0" + struct.pack("<I", 16) + bytes(8))
    for _ in range(1 if loops else MAX_TIFF_DIRECTORIES + 1):
        # One entry: the width.
        following = 16 if loops else len(content) + 18
        content += struct.pack("<HHHIII", 1, 256, 4, 1, 100, following)
    path = tmp_path / "many.tif"
    path.write_bytes(content)
    assert f"many.tif has more than {MAX_TIFF_DIRECTORIES:,} directories; make a copy" in refusal(path)


@pytest.mark.parametrize("content", [b"", b"\xff" * 8, struct.pack("<IHHHII", 8, 9000, 256, 4, 1, 100)])
def test_broken_directories_are_left_to_gdal(tmp_path, library, content):
    path = tmp_path / "broken.tif"
    path.write_bytes(b"II*\0" + content)
    assert "is not a readable raster" in refusal(path)


def test_metadata_beside_and_within_a_raster_are_counted(tmp_path, library, one, monkeypatch):
    monkeypatch.setattr(trust, "MAX_RASTER_ITEMS", 3)
    aux = tmp_path / "one.tif.aux.xml"
    item = '<MDI key="a">b</MDI>'
    aux.write_text(f"<PAMDataset><Metadata>{item * 4}</Metadata></PAMDataset>")
    assert "one.tif.aux.xml has 4 items of metadata or more: must be at most 3" in refusal(one)
    aux.unlink()
    rasters.write(one, np.ones((1, 8, 8)), PLACE, 25832, tags={f"k{i}": "v" for i in range(4)})
    assert "one.tif has 4 items of metadata or more: must be at most 3" in refusal(one)


def test_metadata_beside_a_raster_that_have_no_end_are_refused(tmp_path, library, one, monkeypatch):
    monkeypatch.setattr(trust, "MAX_VRT_BYTES", 1 << 20)
    with (tmp_path / "one.tif.aux.xml").open("wb") as file:
        file.truncate((1 << 20) + 1)
    assert "one.tif.aux.xml holds more than 1 MB of metadata" in refusal(one)
