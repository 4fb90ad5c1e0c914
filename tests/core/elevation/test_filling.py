"""Holes in heights that are interpolated: GDAL's own fill, the same in every window, and nothing beyond a model."""

from __future__ import annotations

import numpy as np
import pytest
from osgeo import gdal
from terrainav.core.capture.runner import capture
from terrainav.core.elevation.filling import REACH_PX, interpolated
from terrainav.core.elevation.layered import open_relief
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.raster import reading
from terrainav.core.imagery.raster.reading import GdalFile, RasterioFile
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

from tests.core.elevation.test_flight import AREA, GRID, SIDE, TO_UTM, UTM, hills
from tests.core.elevation.test_heights import places
from tests.support import rasters

NODATA = -9999.0


@pytest.fixture(params=["gdal", "rasterio"])
def library(request, monkeypatch):
    if request.param == "rasterio":
        pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    chosen = {"gdal": GdalFile, "rasterio": RasterioFile}[request.param]
    monkeypatch.setattr(reading, "opener", lambda: chosen)


def model(path, holes, values=None):
    """A model of hills in cells of 2 m, with rectangles (top, bottom, left, right) of no heights."""
    x, y = np.meshgrid(np.arange(SIDE) * 2.0 + 1.0, np.arange(SIDE) * 2.0 + 1.0)
    heights = (hills(x, y) if values is None else values).astype(np.float32)
    for top, bottom, left, right in holes:
        heights[top:bottom, left:right] = NODATA
    rasters.write(path, heights[np.newaxis], UTM, 32618, nodata=NODATA, data_type=gdal.GDT_Float32)
    return str(path)


def gdal_s_fill(path):
    """The whole file as `gdal_fillnodata.py` makes it."""
    filled = gdal.GetDriverByName("MEM").CreateCopy("", gdal.Open(path))
    band = filled.GetRasterBand(1)
    gdal.FillNodata(band, band.GetMaskBand(), REACH_PX, 0)
    return band.ReadAsArray()


def test_a_hole_has_the_heights_that_gdal_gives_it_in_every_window(tmp_path, library):
    path = model(tmp_path / "hole.tif", [(240, 260, 230, 270), (300, 303, 100, 130)])
    expected = gdal_s_fill(path)
    relief = open_relief([path], interpolates=True)
    for left, top, right, bottom in ((200, 220, 300, 280), (235, 245, 251, 250), (90, 230, 300, 310)):
        surface = relief.surface(*places(32618, [left + 0.5, right + 0.5], [top + 0.5, bottom + 0.5]))
        column, row = np.meshgrid(np.arange(left, right), np.arange(top, bottom))
        at = surface.position(*places(32618, column.ravel() + 0.5, row.ravel() + 0.5))
        found = surface.heights(*at).reshape(column.shape)
        assert np.abs(found - expected[top:bottom, left:right]).max() < 1e-3
    whole = relief.surface(*places(32618, [90.5, 300.5], [230.5, 310.5]))
    assert np.count_nonzero(whole.interpolated) == 20 * 40 + 3 * 30
    assert np.array_equal(whole.interpolated, whole.holes)


def test_nothing_is_interpolated_beyond_a_model_or_across_a_wide_hole(tmp_path, library):
    heights = np.full((300, 300), 50.0, np.float32)
    row, column = np.indices(heights.shape)
    # As of a file that was turned when it was warped, and of a notch in its side.
    heights[(row + column < 150) | ((row > 200) & (column > 290))] = np.nan
    assert np.array_equal(interpolated(heights), heights, equal_nan=True)
    wide = np.full((3 * REACH_PX, 3 * REACH_PX), 50.0, np.float32)
    wide[5:-5, 5:-5] = np.nan
    found = interpolated(wide)
    middle = 3 * REACH_PX // 2
    assert np.isnan(found[middle, middle])
    narrow = np.full((90, 3 * REACH_PX), 50.0, np.float32)
    narrow[5:-5, 5:-5] = np.nan
    assert np.isfinite(interpolated(narrow)[:, REACH_PX:-REACH_PX]).all()


def test_sources_come_before_what_is_interpolated(tmp_path):
    first = model(tmp_path / "first.tif", [(240, 260, 230, 270)])
    second = model(tmp_path / "second.tif", [(240, 250, 0, SIDE)], np.full((SIDE, SIDE), 7.0))
    relief = open_relief([first, second], interpolates=True)
    surface = relief.surface(*places(32618, [220.5, 280.5], [230.5, 270.5]))
    assert np.count_nonzero(surface.holes) == 20 * 40
    assert np.count_nonzero(surface.interpolated) == 10 * 40
    assert np.count_nonzero(surface.heights_m == 7.0) == 10 * 40
    assert not surface.has_holes


def test_a_flight_over_a_hole_counts_and_states_what_is_interpolated(tmp_path):
    path = model(tmp_path / "hole.tif", [(240, 260, 240, 260)])
    asked = Mission(AREA, 60.0, elevation=(path,))
    with pytest.raises(InvalidInput, match="have holes interpolated") as refused:
        plan(asked, GRID, mission_heights(asked))
    assert refused.value.field == "elevation"
    asked = asked.replace(holes="interpolate")
    made = plan(asked, GRID, mission_heights(asked))
    x, y = TO_UTM.transform(made.lon_deg, made.lat_deg)
    ground = made.height_m - made.agl_m
    inside = (np.abs(x - UTM[0] - 500.0) < 20.0) & (np.abs(UTM[3] - y - 500.0) < 20.0)
    assert inside.any()
    expected = gdal_s_fill(path)
    column, row = ((x - UTM[0]) / 2.0).astype(int), ((UTM[3] - y) / 2.0).astype(int)
    assert np.abs(ground - expected[row, column])[inside].max() < 1.0
    figures = estimate(made)
    assert (figures.filled_heights, figures.interpolated_heights) == (0, 400)
    lines = dict(figures.lines())
    assert str(lines["holes interpolated"]).startswith(f"400 of {figures.heights:,} heights around the area (1.")
    assert "holes filled" not in lines
    whole = asked.replace(elevation=(model(tmp_path / "whole.tif", []),))
    assert "holes interpolated" not in dict(estimate(plan(whole, GRID, mission_heights(whole))).lines())
    # Both are counted where both are there.
    level = model(tmp_path / "level.tif", [(240, 250, 0, SIDE)], np.full((SIDE, SIDE), 60.0))
    both = asked.replace(elevation=(path, level))
    figures = estimate(plan(both, GRID, mission_heights(both)))
    assert (figures.filled_heights, figures.interpolated_heights) == (200, 200)


def test_images_state_that_missing_heights_are_interpolated(tmp_path):
    lon, lat = TO_UTM.transform(UTM[0] + 500.0, UTM[3] - 500.0, direction="INVERSE")
    path = model(tmp_path / "hole.tif", [(245, 255, 245, 255)])
    source = open_source("world", seed=1)
    area = Points(((lat, lon, 60.0),))
    asked = Mission(area, 60.0, elevation=(path,), holes="interpolate", image_px=64)
    made = plan(asked, source.grid, mission_heights(asked))
    assert not capture(made, source, tmp_path / "out").failed
    image = gdal.Open(str(tmp_path / "out" / "satellite" / f"{made.names[0]}.tif"))
    assert image.GetMetadataItem("MISSING_HEIGHTS") == "interpolated"
    assert image.GetMetadataItem("SKY_SHARE") == "0.0"


def test_without_gdal_the_choice_is_refused_in_one_line(tmp_path, monkeypatch):
    def none():
        raise InvalidInput("raster files need rasterio: pip install terrainav[raster]")

    monkeypatch.setattr(reading, "opener", none)
    holed = np.ones((5, 5), np.float32)
    holed[2, 2] = np.nan
    with pytest.raises(InvalidInput, match=r"interpolated by GDAL, which is not there: pip install") as caught:
        interpolated(holed)
    assert caught.value.field == "holes"
    assert np.array_equal(interpolated(np.ones((5, 5), np.float32)), np.ones((5, 5)))


@pytest.mark.parametrize(
    "text",
    ["a.tif, b.tif", "a.tif;b.tif", "a.tif,world", "world; 10", "terrarium,world", "/x/dem.tif;terrarium"],
)
def test_several_sources_in_one_text_are_told_apart(text):
    with pytest.raises(InvalidInput, match="are several sources in one; write a semicolon between them") as caught:
        open_relief([text])
    assert caught.value.field == "elevation"
    assert "imagery" not in str(caught.value)


def test_a_file_may_have_a_separator_in_its_name(tmp_path):
    path = model(tmp_path / "a.tif;b.tif", [])
    assert np.isfinite(open_relief([path]).surface(*places(32618, [50.0], [50.0])).heights_m).all()


def test_an_unknown_source_of_heights_is_refused_in_words_of_heights():
    with pytest.raises(
        InvalidInput, match="no such source is known; name a raster file of heights, terrarium"
    ) as caught:
        open_relief(["copernicus"])
    assert "sources" not in str(caught.value)
