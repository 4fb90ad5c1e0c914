"""Real aerial photographs: tiles that GDAL cut, served on the loopback, captured, and compared with the photograph."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.xyz import XYZSource
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support import patterns
from tests.support.tileserver import TileServer

# Beside a checkout, never inside it: USDA NAIP photographs of North Dakota, 5 m pixels, EPSG:26914.
PHOTOGRAPH = Path(__file__).resolve().parents[4] / "shared" / "data" / "naip" / "20200831.tif"
INSIDE = Box(47.028, -99.174, 47.012, -99.136)
AGL_M = 1200.0
NATIVE_ZOOM = 14

pytestmark = [
    pytest.mark.real_data,
    pytest.mark.skipif(not PHOTOGRAPH.is_file(), reason="the photographs of ../shared/data/naip are not there"),
]


@pytest.fixture(scope="module")
def tiles(tmp_path_factory):
    """Folder of z/x/y.png tiles cut from the photograph by GDAL, and the photograph's colours in EPSG:3857."""
    gdal = pytest.importorskip("osgeo.gdal", reason="GDAL's Python module comes with QGIS")
    gdal.UseExceptions()
    folder = tmp_path_factory.mktemp("naip")
    colours, warped = str(folder / "colours.tif"), str(folder / "warped.tif")
    gdal.Translate(colours, str(PHOTOGRAPH), bandList=[1, 2, 3])
    side = PixelGrid().pixel_size(NATIVE_ZOOM)[0]
    gdal.Warp(
        warped,
        colours,
        dstSRS="EPSG:3857",
        xRes=side,
        yRes=side,
        targetAlignedPixels=False,
        resampleAlg="bilinear",
    )
    command = [sys.executable, "-m", "osgeo_utils.gdal2tiles", "--xyz", "-q", "-w", "none", "-r", "bilinear"]
    subprocess.run([*command, "-z", str(NATIVE_ZOOM), colours, str(folder / "tiles")], check=True, timeout=120)
    return folder / "tiles", warped


def test_an_aerial_survey_over_real_photographs(tiles, tmp_path):
    from osgeo import gdal

    folder, warped = tiles
    grid = PixelGrid(max_zoom=NATIVE_ZOOM, native_zoom=NATIVE_ZOOM)
    with TileServer(read=patterns.folder(folder)) as server:
        source = XYZSource(server.url_template, grid=grid, attribution="USDA NAIP, public domain")
        worked_out = plan(Mission(INSIDE, AGL_M, overlap_along=0.5, overlap_across=0.5), source.grid)
        result = capture(worked_out, source, tmp_path / "out")
        source.close()
        assert sum(server.requests.values()) == result.unique_parts == worked_out.requests
    assert result.written == len(worked_out) == 9
    assert not result.failed
    assert worked_out.coverage.complete

    photograph = gdal.Open(warped)
    west, resolution, _, north, _, _ = photograph.GetGeoTransform()
    whole = photograph.ReadAsArray().astype(float)
    differences = []
    for path in sorted((tmp_path / "out" / "satellite").glob("*.tif")):
        picture = gdal.Open(str(path))
        assert picture.GetSpatialRef().GetAuthorityCode(None) == "3857"
        left, _, _, top, _, _ = picture.GetGeoTransform()
        pixels = picture.ReadAsArray().astype(float)
        column, row = round((left - west) / resolution), round((north - top) / resolution)
        reference = whole[:, row : row + pixels.shape[1], column : column + pixels.shape[2]]
        # The two grids differ by a part of a pixel, so neighbours are compared too: the picture must lie best
        # where its georeference says.
        errors = {
            (dx, dy): float(np.abs(pixels[:, 2:-2, 2:-2] - np.roll(reference, (dy, dx), (1, 2))[:, 2:-2, 2:-2]).mean())
            for dx in (-1, 0, 1)
            for dy in (-1, 0, 1)
        }
        assert min(errors, key=errors.get) == (0, 0)
        differences.append(errors[0, 0])
    assert np.median(differences) < 8.0

    footprints = json.loads((tmp_path / "out" / "footprints.geojson").read_text())
    assert len(footprints["features"]) == len(worked_out)
