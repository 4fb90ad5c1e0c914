"""Images of many bands and more than 8 bits in QGIS: asked for by a mission, shown in windows and in mosaics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from osgeo import gdal
from qgis.core import QgsRasterLayer
from qgis.PyQt.QtWidgets import QLineEdit
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.dataset.mosaic import build_mosaics
from terrainav.terrainav_plugin.dataset.picture import read_picture
from terrainav.terrainav_plugin.dataset.rectify import lay_on_map
from terrainav.terrainav_plugin.form.mission_form import FormError
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.panel.entries import WordsLine
from terrainav.terrainav_plugin.sources import mission_grid, open_for_capture

from tests.core.imagery.raster.test_bands import NIR, SIDE, about, place, written
from tests.support.thinning import sampled

#: Ramps eastward and southward, of which 2 % at either end are black and white.
COLUMNS, ROWS = np.meshgrid(np.arange(SIDE), np.arange(SIDE))


def flown(tmp_path, values, names=(), area=None, **mission):
    asked = Mission(area or about(), 60.0, source=str(written(tmp_path / "r.tif", values, names)), **mission)
    source = open_for_capture(asked, None)
    worked_out = plan(asked, mission_grid(asked))
    result = capture(worked_out, source, tmp_path / "out")
    source.close()
    assert not result.failed
    return worked_out, tmp_path / "out"


def colours_of(image):
    """Pixels (h, w, 4) of a QImage."""
    bits = image.constBits()
    bits.setsize(image.sizeInBytes())
    return np.frombuffer(bits, np.uint8).reshape(image.height(), image.width(), 4).copy()


def deep(data_type):
    ramps = np.stack([COLUMNS, ROWS, SIDE - COLUMNS, COLUMNS + ROWS])
    return (ramps * 40 if data_type != "uint8" else ramps / 8).astype(data_type)


def test_the_fourth_band_of_a_picture_with_a_nodata_value_is_no_mask(tmp_path):
    values = np.full((4, 8, 8), 200, np.uint8)
    values[3] = 7
    values[:, :2] = 0
    path = tmp_path / "near-infrared.tif"
    made = gdal.GetDriverByName("GTiff").Create(str(path), 8, 8, 4, gdal.GDT_Byte, ["PHOTOMETRIC=RGB", "ALPHA=NO"])
    for number, band in enumerate(values, 1):
        made.GetRasterBand(number).WriteArray(band)
        made.GetRasterBand(number).SetNoDataValue(0.0)
    made = None
    shown = colours_of(read_picture(path, 100).image)
    assert (shown[2:] == (200, 200, 200, 255)).all()
    assert (shown[:2, :, 3] == 0).all()


@pytest.mark.parametrize("data_type", sampled(["uint8", "uint16", "int16", "float32"], 2))
@pytest.mark.parametrize("bands", [1, 4])
def test_images_and_mosaics_show_what_the_bands_have(data_type, bands, tmp_path):
    values = deep(data_type)[:bands]
    worked_out, folder = flown(tmp_path, values, NIR[:bands])
    path = folder / "satellite" / f"{worked_out.names[1]}.tif"
    opened = gdal.Open(str(path))
    assert opened.RasterCount == bands
    stored = opened.ReadAsArray().reshape(bands, opened.RasterYSize, -1)[: 1 if bands == 1 else 3]
    shown = colours_of(read_picture(path, 10_000).image)
    low, high = np.zeros(3), np.full(3, 255.0)
    if data_type != "uint8":
        low, high = np.percentile(values[: len(stored)].reshape(len(stored), -1), (2, 98), axis=1)
    for channel in range(3):
        at = channel % len(stored)
        grey = np.clip((stored[at] - low[at]) * (255.0 / (high[at] - low[at])), 0, 255)
        assert np.abs(shown[..., channel] - grey).max() <= 1.0
    assert (shown[..., 3] == 255).all()

    (mosaic,) = build_mosaics(worked_out, folder, lambda _share: True)
    layer = QgsRasterLayer(str(mosaic.path), "mosaic")
    assert layer.isValid()
    assert layer.bandCount() == (2 if bands == 1 else 4)
    whole = gdal.Open(str(mosaic.path))
    assert {whole.GetRasterBand(1 + i).DataType for i in range(whole.RasterCount)} == {gdal.GDT_Byte}
    # A part of it is that image, as it is shown.
    left, top = (int(edge[1] - np.min(edge)) for edge in (worked_out.windows.left_px, worked_out.windows.top_px))
    part = whole.ReadAsArray(left, top, opened.RasterXSize - 4, opened.RasterYSize - 4)
    assert np.abs(part[0].astype(float) - shown[: part.shape[1], : part.shape[2], 0]).max() <= 1.0
    smaller = whole.GetRasterBand(1).GetOverview(0).ReadAsArray()
    assert smaller.max() > 20 * smaller.min()


@pytest.mark.parametrize("data_type", ["uint8", "uint16"])
def test_a_mosaic_says_what_the_stored_values_mean(data_type, tmp_path):
    path = written(tmp_path / "r.tif", deep(data_type), NIR)
    made = gdal.Open(str(path), gdal.GA_Update)
    made.GetRasterBand(2).SetScale(0.02)
    made.GetRasterBand(2).SetOffset(-5.5)
    made.GetRasterBand(2).SetUnitType("<K>")
    del made
    asked = Mission(about(), 60.0, source=str(path))
    source = open_for_capture(asked, None)
    worked_out = plan(asked, mission_grid(asked))
    capture(worked_out, source, tmp_path / "out")
    source.close()
    (mosaic,) = build_mosaics(worked_out, tmp_path / "out", lambda _share: True)
    whole = gdal.Open(str(mosaic.path))
    band = whole.GetRasterBand(2)
    # Of more than 8 bits they are stretched, and no longer those that the scale is of.
    is_stored = data_type == "uint8"
    assert ((band.GetScale() or 1.0), (band.GetOffset() or 0.0)) == ((0.02, -5.5) if is_stored else (1.0, 0.0))
    assert band.GetUnitType() == ("<K>" if is_stored else "")
    assert whole.GetRasterBand(1).GetDescription() == ("red" if is_stored else "")
    assert whole.GetRasterBand(1).GetScale() in (None, 1.0)


def test_a_camera_frame_of_more_bits_is_laid_on_the_map(tmp_path):
    lat, lon = place()
    worked_out, folder = flown(tmp_path, deep("uint16"), NIR, Points(((lat, lon, 60.0),)), tilt_deg=25.0)
    lay_on_map(worked_out, folder / "satellite" / f"{worked_out.names[0]}.tif", tmp_path / "map.tif")
    laid = gdal.Open(str(tmp_path / "map.tif")).ReadAsArray()
    shown = laid[3] > 0
    assert shown.any()
    assert np.ptp(laid[0][shown].astype(float)) > 20


def test_bands_and_stretch_are_a_mission_s(tmp_path):
    values = deep("uint16")
    options = {"bands": ("4", "1", "2"), "image_format": "png", "stretch": "0 32000"}
    worked_out, folder = flown(tmp_path, values, NIR, **options)
    opened = gdal.Open(str(folder / "satellite" / f"{worked_out.names[0]}.png"))
    assert opened.RasterCount == 3
    assert opened.GetRasterBand(1).DataType == gdal.GDT_Byte


@pytest.mark.parametrize("options", [{"bands": ("4",)}, {"stretch": "percentile"}])
def test_sources_without_bands_refuse_them(options):
    for name in ("world", "qgis:project"):
        with pytest.raises((FormError, InvalidInput)):
            mission_grid(Mission(about(), 60.0, source=name, **options))


def test_the_panel_has_entries_for_bands_and_their_stretch(desk):
    form = desk.dock.findChild(QLineEdit, "bands"), desk.dock.findChild(QLineEdit, "stretch")
    assert [line.text() for line in form] == ["", "none"]
    form[0].setText("4 1 2")
    form[1].setText("0 32000")
    assert WordsLine.words(form[0]) == ("4", "1", "2")
    form[0].setText("red edge, nir")
    assert form[0].words() == ("red edge", "nir")
    form[0].enter(("red edge", "nir"))
    assert form[0].text() == "red edge, nir"
    form[0].enter(("4", "1"))
    assert form[0].text() == "4 1"
    state = desk.session.state()
    assert (state.bands, state.stretch) == (("4", "1"), "0 32000")
    desk.form.set_state(FormState.from_json(replace(state, bands=("2", "3")).to_json()))
    assert form[0].text() == "2 3"
    assert desk.session.state().bands == ("2", "3")
