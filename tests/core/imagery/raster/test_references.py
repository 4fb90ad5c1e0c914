"""Rasters whose coordinate reference system names a file: refused before GDAL or PROJ opens either."""

from __future__ import annotations

import html
import importlib.util
import os
import sqlite3
import subprocess
import sys

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.imagery.raster.trust import check_fetched, check_references  # noqa: E402

from tests.core.test_references import FILE, HOSTILE  # noqa: E402
from tests.support import rasters  # noqa: E402

UTM = (500_000.0, 1.0, 0.0, 5_500_000.0, 0.0, -1.0)
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
        with pytest.raises(
            InvalidInput, match=r"(x\.vrt|a\.tif\.aux\.xml): .*(names the file|more in it than bands)"
        ):
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
