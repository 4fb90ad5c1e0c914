"""Heights in SRTM's files and in Esri's ASCII grids, as GDAL reads them."""

from __future__ import annotations

import numpy as np
import pytest
from osgeo import gdal
from terrainav.core.elevation.layered import open_relief
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.raster import source as raster_source
from terrainav.core.imagery.raster.reading import GdalFile, RasterioFile

LAT, LON = np.array([47.40, 47.41]), np.array([8.50, 8.51])
WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
    'UNIT["degree",0.0174532925199433]]'
)


@pytest.fixture(params=["gdal", "rasterio"], autouse=True)
def _library(request, monkeypatch):
    if request.param == "rasterio":
        pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    chosen = {"gdal": GdalFile, "rasterio": RasterioFile}[request.param]
    monkeypatch.setattr(raster_source, "opener", lambda: chosen)


@pytest.fixture
def srtm(tmp_path):
    row, column = np.indices((1201, 1201))
    heights = (400 + row // 4 - column // 8).astype(">i2")
    heights[720:724, 600:604] = -32768
    path = tmp_path / "N47E008.hgt"
    heights.tofile(path)
    return path


@pytest.fixture
def grid(tmp_path):
    rows = [" ".join(f"{450.0 + row - column / 4}" for column in range(60)) for row in range(60)]
    rows[45] = rows[45].replace(" 490.0 ", " -9999 ")
    header = "ncols 60\nnrows 60\nxllcorner 8.49\nyllcorner 47.39\ncellsize 0.001\nNODATA_value -9999\n"
    (tmp_path / "dem.asc").write_text(header + "\n".join(rows))
    (tmp_path / "dem.prj").write_text(WGS84)
    return tmp_path / "dem.asc"


def check(path):
    """Every height near the positions is the one that GDAL reads in its pixel."""
    surface = open_relief([str(path)]).surface(LAT, LON)
    opened = gdal.Open(str(path))
    west, across, _, north, _, down = opened.GetGeoTransform()
    band = opened.GetRasterBand(1)
    values = np.where(band.ReadAsArray() == band.GetNoDataValue(), np.nan, band.ReadAsArray())
    rows, columns = np.indices(surface.heights_m.shape)
    lat, lon = surface.places(columns.astype(float), rows.astype(float))
    row, column = np.floor((lat - north) / down).astype(int), np.floor((lon - west) / across).astype(int)
    assert surface.heights_m.size > 50
    assert np.array_equal(surface.heights_m, values[row, column].astype(np.float32), equal_nan=True)
    return surface


def test_srtm_files_are_read_with_their_voids(srtm):
    assert np.count_nonzero(np.isnan(check(srtm).heights_m)) > 0


def test_ascii_grids_are_read_with_their_voids(grid):
    assert np.isnan(open_relief([str(grid)]).surface(LAT, LON).heights_m).sum() == 1
    check(grid)


def test_virtual_rasters_of_them_are_read_and_of_nothing_that_is_called_so(srtm, grid, tmp_path):
    for name, path in (("a", srtm), ("b", grid)):
        made = gdal.BuildVRT(str(tmp_path / f"{name}.vrt"), [str(path)])
        del made
        check(tmp_path / f"{name}.vrt")
    other = tmp_path / "secrets.hgt"
    other.write_text("root:x:0:0")
    text = (tmp_path / "a.vrt").read_text().replace("N47E008.hgt", "secrets.hgt")
    (tmp_path / "c.vrt").write_text(text)
    with pytest.raises(InvalidInput, match="is of no format of images that a VRT may read"):
        open_relief([str(tmp_path / "c.vrt")])


def test_a_file_that_is_not_there_is_said_to_be_missing():
    for name in ("N10E010.hgt", "none.asc"):
        with pytest.raises(InvalidInput, match="there is no such file"):
            open_relief([name])
