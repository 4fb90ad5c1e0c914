"""The algorithm that makes an orthomosaic, in the real application."""

from __future__ import annotations

import pytest
from osgeo import gdal
from qgis.core import QgsProcessingException, QgsProcessingFeedback
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    """Tilted images of the synthetic world."""
    area = Box(35.1285, -89.8647, 35.1277, -89.8634)
    source = open_source("world")
    folder = tmp_path_factory.mktemp("tilted") / "set"
    capture(plan(Mission(area, 80.0, image_px=240, tilt_deg=20.0, yaw_deg=30.0), source.grid), source, folder)
    return folder


def run(**parameters):
    import processing

    return processing.run("terrainav:mosaic", parameters, feedback=QgsProcessingFeedback(False))


def test_an_orthomosaic_is_written_with_overviews(plugin, dataset, tmp_path):
    target = tmp_path / "map.tif"
    found = run(DATASET=str(dataset), OUTPUT=str(target), GSD=0.3)
    raster = gdal.Open(str(target))
    assert (raster.RasterXSize, raster.RasterYSize) == (found["WIDTH"], found["HEIGHT"])
    assert raster.RasterCount == 4
    assert raster.GetRasterBand(4).GetColorInterpretation() == gdal.GCI_AlphaBand
    assert raster.GetRasterBand(1).GetOverviewCount() > 0
    assert found["RESOLUTION"] == 0.3
    assert 0 < found["USED"] <= found["IMAGES"]


def test_other_formats_and_map_types_are_refused(plugin, dataset, tmp_path):
    with pytest.raises(QgsProcessingException, match="GeoTIFF"):
        run(DATASET=str(dataset), OUTPUT=str(tmp_path / "map.png"))
    with pytest.raises(QgsProcessingException, match="roadmap"):
        run(DATASET=str(dataset), OUTPUT=str(tmp_path / "map.tif"), MAP_TYPE="roadmap")
    assert not list(tmp_path.glob("*"))
