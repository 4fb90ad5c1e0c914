"""Rasters whose coordinate reference system names a file: refused before GDAL or PROJ opens either."""

from __future__ import annotations

import html
import importlib.util
import os
import sqlite3
import struct
import subprocess
import sys
import zipfile

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.imagery.raster.trust import check_fetched, check_references  # noqa: E402

from tests.core.test_references import FILE, HOSTILE  # noqa: E402
from tests.support import rasters  # noqa: E402
from tests.support.ranges import RangeServer  # noqa: E402

UTM = (500_000.0, 1.0, 0.0, 5_500_000.0, 0.0, -1.0)
#: A system that has no code, so that Esri's text of it is written.
ESRI = (
    'PROJCS["mine",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],'
    'PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
    'PARAMETER["False_Easting",500001.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",9.0],'
    'PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]'
)
#: Tags of GeoTIFF's texts and keys with their types, TIFF's of strips, and the key of a projected system's citation.
TAGS = ((34737, b"\2\0"), (34735, b"\3\0"))
STRIP_OFFSETS, PROJECTED_CITATION = 273, 3073
_OPENED = """
import importlib, sys
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.raster import source, reading
for library in ("GdalFile", "RasterioFile"):
    if library == "GdalFile" or importlib.util.find_spec("rasterio"):
        source.opener = lambda library=library: getattr(reading, library)
        for path in sys.argv[1:]:
            try:
                source.open_raster(path)
            except InvalidInput as refused:
                print(refused)
            else:
                sys.exit(path)
"""


@pytest.fixture
def picture(tmp_path):
    """Path of a GeoTIFF in UTM."""
    values = np.full((1, 16, 16), 7, np.uint8)
    return rasters.write(tmp_path / "a.tif", values, UTM, 32632)


def vrt(picture, system, element="SRS"):
    path = picture.with_name("x.vrt")
    inside = f"<SRS>{html.escape(system)}</SRS>"
    if element == "GCPList":
        inside = f'<GCPList Projection="{html.escape(system)}"><GCP Id="1" Pixel="0" Line="0" X="0" Y="0"/></GCPList>'
    path.write_text(
        f'<VRTDataset rasterXSize="16" rasterYSize="16">{inside}<GeoTransform>{str(UTM)[1:-1]}</GeoTransform>'
        '<VRTRasterBand dataType="Byte" band="1"><SimpleSource><SourceFilename relativeToVRT="1">a.tif'
        "</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>"
    )
    return path


def beside(picture, system):
    """Write the file of GDAL's in XML beside a picture; the name of the system is split, which GDAL does not mind."""
    text = html.escape(system).replace("grids", "gri<![CDATA[ds]]>")
    aux = picture.with_name(picture.name + ".aux.xml")
    aux.write_text(f"<PAMDataset><SRS>{text}</SRS></PAMDataset>")
    return picture


@pytest.mark.parametrize("kind", HOSTILE)
def test_each_is_refused_in_a_vrt_and_beside_a_plain_tiff(picture, kind):
    system = HOSTILE[kind].replace(FILE, "/tmp/up.gtx")
    for path in (vrt(picture, system), vrt(picture, system, "GCPList"), beside(picture, system)):
        with pytest.raises(InvalidInput, match=r"(x\.vrt|a\.tif\.aux\.xml): .*(names the file|more in it than bands)"):
            open_raster(path)


def test_each_format_is_looked_at_before_gdal_opens_it(picture, tmp_path):
    hostile = HOSTILE["a method of PROJ"].replace(FILE, "/tmp/up.gtx")
    old = HOSTILE["PROJ4_GRIDS"].replace(FILE, "/tmp/up.gtx")
    made = []
    for ending, driver in (("img", "HFA"), ("bil", "EHdr"), ("bin", "ENVI"), ("gpkg", "GPKG")):
        path = tmp_path / f"b.{ending}"
        gdal.Translate(str(path), str(picture), format=driver)
        made.append(path)
    gdal.Translate(str(tmp_path / "g.asc"), str(picture), format="AAIGrid")
    for path, prj in ((made[1], "b.prj"), (tmp_path / "g.asc", "g.prj")):
        check_references(path)
        (tmp_path / prj).write_text(hostile)
        with pytest.raises(InvalidInput, match=r"\.prj: .*names the file /tmp/up\.gtx"):
            check_references(path)
        (tmp_path / prj).unlink()
    header = tmp_path / "b.hdr"
    header.write_text(f"ENVI\ncoordinate system string = {{{old}}}\n")
    with pytest.raises(InvalidInput, match=r"b\.hdr: .*names the file /tmp/up\.gtx"):
        check_references(made[2])
    header.unlink()
    check_references(made[0])
    made[0].write_bytes(made[0].read_bytes() + b"\0" * (5 << 20) + hostile.encode() + b"\0" * 100)
    with pytest.raises(InvalidInput, match=r"b\.img: .*names the file /tmp/up\.gtx"):
        check_references(made[0])
    check_references(made[3])
    database = sqlite3.connect(made[3])
    database.execute("UPDATE gpkg_spatial_ref_sys SET definition = ?", (hostile + " " * 10_000,))
    database.commit()
    database.close()
    with pytest.raises(InvalidInput, match=r"b\.gpkg: .*names the file /tmp/up\.gtx"):
        check_references(made[3])


def test_keys_of_a_geotiff_and_boxes_of_a_jpeg_2000(picture, tmp_path):
    hostile = HOSTILE["a method of PROJ"].replace(FILE, "/tmp/up.gtx")
    data = picture.read_bytes()
    # The keys' texts are moved to the end, with Esri's.
    at = data.find((34737).to_bytes(2, "little"))
    text = b"ESRI PE String = " + hostile.encode() + b"|\0"
    patched = bytearray(data + text)
    patched[at + 4 : at + 8] = len(text).to_bytes(4, "little")
    patched[at + 8 : at + 12] = len(data).to_bytes(4, "little")
    (tmp_path / "cited.tif").write_bytes(patched)
    with pytest.raises(InvalidInput, match=r"cited\.tif: .*names the file /tmp/up\.gtx"):
        open_raster(tmp_path / "cited.tif")
    with pytest.raises(InvalidInput, match=r"cited\.tif: .*names the file /tmp/up\.gtx"):
        check_fetched("cited.tif", bytes(patched))
    check_fetched("a.tif", data)
    boxes = b"\0\0\0\x0cjP  \r\n\x87\n"
    for kind, refused in ((b"uuid", True), (b"jp2c", False)):
        path = tmp_path / "a.jp2"
        path.write_bytes(boxes + (8 + len(text)).to_bytes(4, "big") + kind + text)
        if refused:
            with pytest.raises(InvalidInput, match=r"a\.jp2: .*names the file"):
                check_references(path)
        else:
            check_references(path)


def cited(path, system, gap=0, as_numbers=False):
    """Write a GeoTIFF whose keys' texts, behind a gap, have such a system in Esri's way."""
    values = np.full((1, 16, 16), 7, np.uint8)
    rasters.write(path, values, UTM, ESRI, options=("GEOTIFF_KEYS_FLAVOR=ESRI_PE",))
    data = bytearray(path.read_bytes())
    texts, keys = (data.find(tag.to_bytes(2, "little") + kind) for tag, kind in TAGS)
    length, offset = struct.unpack_from("<II", data, texts + 4)
    old = bytes(data[offset : offset + length]).rstrip(b"\0")
    new = b"ESRI PE String = " + system.encode() + b"|"
    struct.pack_into("<II", data, texts + 4, len(old + new) + 1, len(data) + gap)
    length, offset = struct.unpack_from("<II", data, keys + 4)
    for at in range(offset, offset + 2 * length, 8):
        if struct.unpack_from("<H", data, at)[0] == PROJECTED_CITATION:
            struct.pack_into("<HH", data, at + 4, len(new), len(old))
    text = old + new + b"\0"
    if as_numbers:
        struct.pack_into("<H", data, texts + 2, 3)
        text = text.decode().encode("utf-16-le")
    path.write_bytes(bytes(data) + b"\1" * gap + text)
    return path


def test_a_text_written_as_numbers_is_refused_as_libtiff_reads_it_as_one(tmp_path):
    system = HOSTILE["PROJ4_GRIDS"].replace(FILE, "/tmp/up.gtx")
    with pytest.raises(InvalidInput, match=r"numbers in place of the text of tag 34737"):
        open_raster(cited(tmp_path / "a.tif", system, as_numbers=True))


def test_a_second_directory_is_looked_at_and_none_of_unknown_place(picture, tmp_path):
    system = HOSTILE["PROJ4_GRIDS"].replace(FILE, "/tmp/up.gtx")
    second = cited(tmp_path / "b.tif", system).read_bytes()
    data = bytearray(picture.read_bytes())
    # The directory of one, with its offsets moved, is chained to that of the other.
    directory = struct.unpack_from("<I", data, 4)[0]
    chain = directory + 2 + 12 * struct.unpack_from("<H", data, directory)[0]
    shift = len(data)
    moved = bytearray(second)
    start = struct.unpack_from("<I", moved, 4)[0]
    sizes = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 12: 8}
    for at in range(start + 2, start + 2 + 12 * struct.unpack_from("<H", moved, start)[0], 12):
        tag, kind, length, value = struct.unpack_from("<HHII", moved, at)
        if sizes[kind] * length > 4 or tag == STRIP_OFFSETS:
            struct.pack_into("<I", moved, at + 8, value + shift)
    struct.pack_into("<I", data, chain, shift + start)
    path = tmp_path / "c.tif"
    path.write_bytes(bytes(data + moved))
    with pytest.raises(InvalidInput, match=r"c\.tif: .*names the file /tmp/up\.gtx"):
        open_raster(f"GTIFF_DIR:2:{path}")
    with pytest.raises(InvalidInput, match="names a place in the file: must name a directory by its number"):
        open_raster(f"GTIFF_DIR:off:{shift + start}:{path}")


def test_a_system_that_is_none_is_refused_in_one_line(tmp_path):
    path = cited(tmp_path / "a.tif", 'PROJCRS["x",PROJCS["x",GEOGCS[]]]')
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", _OPENED, str(path)],
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
    )
    assert (done.returncode, "Traceback" in done.stderr) == (0, False)


def test_of_rasters_elsewhere_no_pipe_is_opened_either(picture, tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    paths, count = [], 0
    with RangeServer() as server:
        for number, text in enumerate(HOSTILE.values()):
            system = text.replace(FILE, str(pipe))
            # The texts are asked for by a request of their own.
            made = cited(tmp_path / "made.tif", system, gap=1 << 17).read_bytes()
            server.files[f"/{number}.tif"] = (made, f'"{number}"')
            archive = tmp_path / f"{number}.zip"
            with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
                packed.writestr("a.tif", made)
                packed.write(rasters.write(tmp_path / "bare.tif", np.zeros((1, 8, 8)), UTM, None), "b.tif")
                packed.writestr("b.tif.aux.xml", f"<PAMDataset><SRS>{html.escape(system)}</SRS></PAMDataset>")
                packed.writestr("b.prj", system)
            paths += [f"{server.url}/{number}.tif", f"/vsizip/{archive}/a.tif", f"/vsizip/{archive}/b.tif"]
            count += 3
        done = subprocess.run(
            [sys.executable, "-W", "ignore", "-c", _OPENED, *paths],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
    assert (done.returncode, done.stderr) == (0, "")
    libraries = 1 + bool(importlib.util.find_spec("rasterio"))
    refused = done.stdout.splitlines()
    assert len(refused) == libraries * count
    for line in refused:
        assert "header: its coordinate" in line or "states no coordinate reference system" in line


@pytest.mark.parametrize(
    ("sent", "refusal"),
    [
        (0, "header: its coordinate reference system names"),
        # Some versions of GDAL take the text that has not come for none, some for a fault of the file.
        (100, "states no coordinate reference system|GeoAsciiParams is missing or corrupted"),
    ],
)
def test_gdal_opens_the_bytes_that_were_looked_at(tmp_path, sent, refusal):
    system = HOSTILE["PROJ4_GRIDS"].replace(FILE, "/tmp/up.gtx")
    made = cited(tmp_path / "made.tif", system, gap=1 << 17).read_bytes()
    with RangeServer() as server:
        server.files["/a.tif"] = (made, '"a"')

        def send_all():
            server.cuts_at = None

        def break_off():
            server.cuts_at, server.when = sent, (5, send_all)

        # The fourth request is that of the texts, behind those of one byte, of the length and of the head.
        server.when = (4, break_off)
        with pytest.raises(InvalidInput, match=refusal):
            open_raster(f"{server.url}/a.tif")


def test_formats_that_would_be_read_whole_are_refused_in_archives(picture, tmp_path):
    gdal.Translate(str(tmp_path / "a.img"), str(picture), format="HFA")
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as packed:
        packed.write(tmp_path / "a.img", "a.img")
        packed.write(picture, "a.tif")
    with pytest.raises(InvalidInput, match=r"a\.img: is of a format that is read from folders of this machine"):
        open_raster(f"/vsizip/{tmp_path}/a.zip/a.img")
    opened = open_raster(f"/vsizip/{tmp_path}/a.zip/a.tif")
    assert opened.facts.sizes[0] == (16, 16)
    opened.close()


def test_boxes_of_a_jpeg_2000_in_an_archive_are_looked_at(picture, tmp_path):
    if gdal.GetDriverByName("JP2OpenJPEG") is None:
        pytest.skip("this GDAL writes no JPEG 2000")
    hostile = HOSTILE["a method of PROJ"].replace(FILE, "/tmp/up.gtx").encode()
    plain = tmp_path / "a.jp2"
    gdal.Translate(str(plain), str(picture), format="JP2OpenJPEG")
    box = (8 + len(hostile)).to_bytes(4, "big") + b"uuid" + hostile
    many = b"\0\0\0\x08free" * 2_000
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as packed:
        for name, data in (("plain", b""), ("hostile", box), ("many", many)):
            packed.writestr(f"{name}.jp2", plain.read_bytes() + data)
    open_raster(f"/vsizip/{tmp_path}/a.zip/plain.jp2").close()
    with pytest.raises(InvalidInput, match=r"names the file /tmp/up\.gtx"):
        open_raster(f"/vsizip/{tmp_path}/a.zip/hostile.jp2")
    with pytest.raises(InvalidInput, match="more than 1,000 boxes"):
        open_raster(f"/vsizip/{tmp_path}/a.zip/many.jp2")


def test_a_pipe_as_grid_is_never_opened(picture, tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    paths = []
    for number, text in enumerate(HOSTILE.values()):
        folder = tmp_path / str(number)
        folder.mkdir()
        copy = folder / "a.tif"
        copy.write_bytes(picture.read_bytes())
        plain = folder / "plain.tif"
        plain.write_bytes(picture.read_bytes())
        paths += [
            str(vrt(copy, text.replace(FILE, str(pipe)))),
            str(beside(plain, text.replace(FILE, str(pipe)))),
        ]
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", _OPENED, *paths],
        capture_output=True,
        text=True,
        timeout=200,
        env={**os.environ, "PROJ_NETWORK": "ON"},
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    libraries = 1 + bool(importlib.util.find_spec("rasterio"))
    assert len(done.stdout.splitlines()) == libraries * len(paths)


def test_systems_that_gdal_writes_are_read_as_before(picture, tmp_path):
    for system in (
        "EPSG:31467",
        "EPSG:4326+5773",
        "EPSG:2056",
        "+proj=utm +zone=32 +nadgrids=@null +ellps=GRS80",
    ):
        copy = tmp_path / "b.tif"
        gdal.Translate(str(copy), str(picture), outputSRS=system)
        check_references(copy)
        path = tmp_path / "b.png"
        gdal.Translate(str(path), str(copy), format="PNG")
        check_references(path)
        gdal.BuildVRT(str(tmp_path / "b.vrt"), [str(copy)]).FlushCache()
        check_references(tmp_path / "b.vrt")


def test_a_view_in_place_of_systems_is_refused(picture, tmp_path):
    path = tmp_path / "b.gpkg"
    gdal.Translate(str(path), str(picture), format="GPKG")
    database = sqlite3.connect(path)
    database.execute("ALTER TABLE gpkg_spatial_ref_sys RENAME TO other")
    database.execute("CREATE VIEW gpkg_spatial_ref_sys AS SELECT * FROM other")
    database.commit()
    database.close()
    with pytest.raises(InvalidInput, match="has a view in place of its coordinate reference systems"):
        check_references(path)
