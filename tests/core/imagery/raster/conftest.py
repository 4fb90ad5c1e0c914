"""Raster files through each of the libraries that read them."""

from __future__ import annotations

import pytest
from terrainav.core.imagery.raster import source as raster_source
from terrainav.core.imagery.raster.reading import GdalFile, RasterioFile


@pytest.fixture(params=["gdal", "rasterio"])
def library(request, monkeypatch):
    """Both libraries, one after the other."""
    if request.param == "rasterio":
        pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    chosen = {"gdal": GdalFile, "rasterio": RasterioFile}[request.param]
    monkeypatch.setattr(raster_source, "opener", lambda: chosen)
    return request.param
