"""Datasets of other bands than 8-bit colours: read as they are, shown for entropies, refused in one line elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.bands import Bands, colour_channels  # noqa: E402
from terrainav.core.capture.georeference import Georeference  # noqa: E402
from terrainav.core.capture.metadata import Description  # noqa: E402
from terrainav.core.capture.writers import geotiff  # noqa: E402
from terrainav.core.dataset.clean import clean  # noqa: E402
from terrainav.core.dataset.dataset import read_dataset  # noqa: E402
from terrainav.core.dataset.entropy import image_entropies  # noqa: E402
from terrainav.core.dataset.geotiff import parse_geotiff  # noqa: E402
from terrainav.core.dataset.loading import Batches, LabelledImages  # noqa: E402
from terrainav.core.dataset.loading.augment import Augmentation  # noqa: E402
from terrainav.core.dataset.split import split  # noqa: E402
from terrainav.core.dataset.table import Table  # noqa: E402
from terrainav.core.errors import InvalidInput  # noqa: E402

from tests.core.imagery.raster.test_bands import NIR, captured, noise, written  # noqa: E402

PLACE = Georeference(500_000.0, 5_000_000.0, 500_010.0, 5_000_010.0, 40, 30, "EPSG:32616")
ABOUT = Description("n", "satellite", "a source", "somebody", 5, 45.0, -87.0, 100.0)


@pytest.mark.parametrize("data_type", ["uint8", "uint16", "int16", "float32"])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("masked", [False, True])
def test_what_is_written_is_read_by_us_and_by_gdal(data_type, count, masked, tmp_path):
    names = tuple([*NIR, "<a> & 'b'", "日本", "seventh"][:count])
    bands = Bands(names, data_type, colour_channels(names))
    values = np.moveaxis(noise(data_type, count + masked, 41), 0, 2)[:30, :40]
    if masked:
        values[..., count] = values[..., count] != values[..., count].min()
        values[:9, :, count] = 0
    ranges = tuple((float(band), 100.5 + band) for band in range(count))
    data = geotiff(values, PLACE, ABOUT, bands, ranges)
    (tmp_path / "n.tif").write_bytes(data)
    opened = gdal.Open(str(tmp_path / "n.tif"))
    shown = opened.ReadAsArray().reshape(-1, 30, 40)[:count]
    read = parse_geotiff(data)
    if data_type == "uint8" and count in (1, 3):
        assert read is None
        assert np.array_equal(np.moveaxis(shown, 0, 2), values[..., :count])
        return
    assert np.array_equal(np.moveaxis(shown, 0, 2), read.values(), equal_nan=data_type == "float32")
    there = values[..., count] != 0 if masked else np.ones((30, 40), bool)
    assert np.array_equal(read.values()[there], values[..., :count][there])
    assert (read.bands, read.size, read.is_placed) == (bands, (40, 30), True)
    assert [opened.GetRasterBand(1 + band).GetDescription() for band in range(count)] == list(names)
    if data_type != "uint8":
        assert read.stated == dict(enumerate(ranges))
    # The mask, whatever tells it.
    assert bool(read.mask) == masked


@pytest.fixture
def dataset(tmp_path):
    captured(written(tmp_path / "r.tif", noise("uint16"), NIR), tmp_path / "out")
    return tmp_path / "out"


def test_a_dataset_of_four_bands_is_read_split_and_loaded_as_it_is(dataset):
    images = read_dataset(dataset).image_set("satellite")
    pixels = images.pixels(2)
    opened = gdal.Open(str(images.path(2)))
    assert np.array_equal(np.moveaxis(opened.ReadAsArray(), 0, 2), pixels)
    assert images.pixels(2, 3).shape == (*pixels.shape[:2], 3)
    assert images.pixels(2, 1).dtype == np.uint8
    split(dataset)
    sizes = {images.pixels(index).shape for index in range(len(images))}
    if len(sizes) > 1:
        with pytest.raises(InvalidInput, match="4 bands of uint16, where the first one has"):
            list(Batches(dataset, part="all", dtype="stored"))
    first = LabelledImages(dataset, part="all", dtype="stored", shuffle=False)
    assert first.dtype == np.uint16
    taken, labels = first.take([0])
    assert np.array_equal(taken[0], images.pixels(0))
    assert labels.shape == (1, 2)


def test_loaders_refuse_what_they_would_change(dataset):
    with pytest.raises(InvalidInput, match=r"red, green, blue, nir \(uint16\), and not grey or colours") as caught:
        LabelledImages(dataset, part="all")
    assert "\n" not in str(caught.value)
    with pytest.raises(InvalidInput, match="stored images are not resized"):
        LabelledImages(dataset, part="all", dtype="stored", img_size=(8, 8, 3))
    with pytest.raises(InvalidInput, match="stored images are not augmented"):
        LabelledImages(dataset, part="all", dtype="stored", augment=Augmentation())


def test_entropies_that_are_lost_are_worked_out_as_they_were(dataset):
    table = Table.load(dataset / "satellite" / "meta_data.csv")
    import dataclasses

    lost = dataclasses.replace(table, entropies=np.full(len(table), np.nan))
    lost.save(dataset / "satellite" / "meta_data.csv")
    assert image_entropies(dataset)["satellite"] == pytest.approx(table.entropies, abs=1e-6)
    clean(dataset, threshold=0.5)


def test_damaged_files_are_refused_in_one_line(dataset):
    images = read_dataset(dataset).image_set("satellite")
    path = images.path(0)
    whole = path.read_bytes()
    for data in (whole[: len(whole) // 2], whole[:-40], whole[:2000] + b"\0" * 400 + whole[2400:]):
        path.write_bytes(data)
        with pytest.raises(InvalidInput) as caught:
            images.pixels(0)
        assert "\n" not in str(caught.value)
        assert str(path) in str(caught.value)
