"""What a file says that its values mean: in images, beside them, in mosaics and for loaders, as GDAL reads it."""

from __future__ import annotations

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.bands import BandMetadata, Bands  # noqa: E402
from terrainav.core.capture.writers import geotiff  # noqa: E402
from terrainav.core.dataset.loading import LabelledImages  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.mission.areas.area import Points  # noqa: E402
from terrainav.core.mosaic.orthomosaic import make_orthomosaic  # noqa: E402

from tests.core.dataset.test_geotiff import ABOUT, PLACE  # noqa: E402
from tests.core.imagery.raster.test_bands import (  # noqa: E402
    GDAL_TYPES,
    NIR,
    SIDE,
    captured,
    noise,
    place,
    read,
    window,
    written,
)
from tests.support.thinning import sampled  # noqa: E402

#: Scale, offset and unit of each band; the last one's values are the quantity.
QUANTITIES = ((0.0001, -0.1, "reflectance"), (0.01, 273.15, "K <&> \"C'"), (-1.5, 0.0, ""), (1.0, 0.0, ""))


def stated(path, values, names=NIR, quantities=QUANTITIES, **options):
    written(path, values, names[: len(values)], **options)
    made = gdal.Open(str(path), gdal.GA_Update)
    for index, (scale, offset, unit) in enumerate(quantities[: len(values)], 1):
        band = made.GetRasterBand(index)
        if (scale, offset) != (1.0, 0.0):
            band.SetScale(scale)
            band.SetOffset(offset)
        band.SetUnitType(unit)
        band.SetMetadata({"wavelength": f"{400 + index}", "STATISTICS_MEAN": "3", "note": "a <b> & 'c'"})
        band.SetMetadataItem("CENTRAL_WAVELENGTH_UM", f"0.{index}", "IMAGERY")
    del made
    return path


def quantities(opened, count):
    bands = [opened.GetRasterBand(1 + at) for at in range(count)]
    return tuple(
        (1.0 if band.GetScale() is None else band.GetScale(), band.GetOffset() or 0.0, band.GetUnitType())
        for band in bands
    )


@pytest.mark.parametrize("data_type", sampled(GDAL_TYPES, 3))
def test_images_say_what_their_values_mean(data_type, tmp_path, library):
    values = noise(data_type, 4)
    _, paths = captured(stated(tmp_path / "r.tif", values), tmp_path / "out")
    opened, shown = read(paths[0])
    assert np.array_equal(shown, window(opened, values))
    assert quantities(opened, 4) == QUANTITIES
    for at in range(4):
        band = opened.GetRasterBand(1 + at)
        said = band.GetMetadata()
        assert (said["wavelength"], said["note"]) == (f"{401 + at}", "a <b> & 'c'")
        # Of all the file's values, which an image has a part of.
        assert "STATISTICS_MEAN" not in said
        assert band.GetMetadataItem("CENTRAL_WAVELENGTH_UM", "IMAGERY") == f"0.{1 + at}"
        assert band.GetDescription() == NIR[at]


def test_rasterio_reads_what_values_mean(tmp_path):
    rasterio = pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    _, paths = captured(stated(tmp_path / "r.tif", noise("uint16")), tmp_path / "out", bands=("nir", "2", "red"))
    with rasterio.open(paths[0]) as opened:
        scales, offsets, units = zip(*(QUANTITIES[at] for at in (3, 1, 0)))
        assert (opened.scales, opened.offsets) == (scales, offsets)
        assert tuple(unit or "" for unit in opened.units) == units
        assert opened.descriptions == ("nir", "green", "red")
        assert opened.tags(1)["wavelength"] == "404"


@pytest.mark.parametrize("image_format", ["jpg", "png"])
@pytest.mark.parametrize("tilt_deg", [0.0, 20.0])
def test_formats_without_room_for_it_have_it_beside_them(image_format, tilt_deg, tmp_path, library):
    path = stated(tmp_path / "r.tif", noise("uint8"))
    lat, lon = place()
    _, paths = captured(
        path,
        tmp_path / "out",
        Points(((lat, lon, 60.0),)),
        bands=("4", "1", "2"),
        image_format=image_format,
        tilt_deg=tilt_deg,
        as_stored=False,
    )
    opened, _ = read(paths[0])
    assert quantities(opened, 3) == tuple(QUANTITIES[at] for at in (3, 0, 1))
    assert [opened.GetRasterBand(1 + at).GetDescription() for at in range(3)] == ["nir", "red", "green"]


@pytest.mark.parametrize("image_format", ["tif", "png"])
def test_values_that_are_stretched_mean_something_else(image_format, tmp_path):
    path = stated(tmp_path / "r.tif", noise("uint16"))
    _, paths = captured(
        path,
        tmp_path / "out",
        bands=("1", "2", "3"),
        stretch="percentile",
        image_format=image_format,
        as_stored=image_format == "tif",
    )
    opened, _ = read(paths[0])
    assert quantities(opened, 3) == ((1.0, 0.0, ""),) * 3


@pytest.mark.parametrize(("data_type", "nodata"), sampled([("int16", -9999), ("uint16", 0), ("float32", -9999.5)], 3))
def test_a_band_alone_without_data_stays_so(data_type, nodata, tmp_path, library):
    values = np.full((2, SIDE, SIDE), 1000, data_type)
    values[1, ::7, ::5] = nodata
    _, paths = captured(written(tmp_path / "r.tif", values, nodata=nodata), tmp_path / "out")
    opened, shown = read(paths[0])
    part = window(opened, values)
    assert np.array_equal(shown, part)
    for at in (0, 1):
        band = opened.GetRasterBand(1 + at)
        assert band.GetNoDataValue() == nodata
        assert np.array_equal(band.GetMaskBand().ReadAsArray() != 0, part[at] != nodata)


@pytest.mark.parametrize("data_type", ["uint8", "uint16", "int16", "float32"])
def test_a_mean_that_happens_to_be_the_value_for_no_data_is_imagery(data_type):
    bands = Bands(("a", "b"), data_type, (0,), nodata=0)
    values = np.full((30, 40, 3), 7, data_type)
    values[4, 5, :2] = 0
    values[6, 7, 1] = 0
    values[9] = 0
    data = geotiff(values, PLACE, ABOUT, bands, ((0.0, 1.0),) * 2)
    gdal.FileFromMemBuffer("/vsimem/mean.tif", data)
    opened = gdal.Open("/vsimem/mean.tif")
    masks = [opened.GetRasterBand(1 + at).GetMaskBand().ReadAsArray() != 0 for at in (0, 1)]
    del opened
    gdal.Unlink("/vsimem/mean.tif")
    there = np.ones((30, 40), bool)
    there[9] = False
    assert np.array_equal(masks[0], there)
    there[4, 5] = there[6, 7] = False
    assert np.array_equal(masks[1], there)


def test_a_grey_of_colours_means_what_all_of_them_do(tmp_path):
    same = (QUANTITIES[1],) * 3
    for at, (stated_as, expected) in enumerate(((same, QUANTITIES[1]), (QUANTITIES, (1.0, 0.0, "")))):
        path = stated(tmp_path / f"{at}.tif", noise("uint16", 3), quantities=stated_as)
        _, paths = captured(path, tmp_path / f"out{at}", img_size=(50, 40, 1))
        assert quantities(read(paths[0])[0], 1) == (expected,)


def test_a_scale_that_is_no_number_is_not_taken(tmp_path, library):
    quantity = ((float("nan"), 1.0, "m"), (0.0, 5.0, "m"), (float("inf"), 0.0, "m"))
    source = open_raster(stated(tmp_path / "r.tif", noise("int16", 3), quantities=quantity), as_stored=True)
    source.close()
    assert [(one.scale, one.offset, one.unit) for one in source.bands.metadata] == [(1.0, 0.0, "m")] * 3


@pytest.mark.parametrize(("count", "image_format"), [(1, "tif"), (3, "tif"), (4, "tif"), (1, "png"), (3, "png")])
def test_a_mosaic_says_what_its_values_mean(count, image_format, tmp_path):
    values = np.full((count, SIDE, SIDE), 90, "uint8")
    path = stated(tmp_path / "r.tif", values)
    lat, lon = place()
    area = Points(((lat, lon, 60.0), (lat + 1e-4, lon, 60.0)))
    as_stored = image_format == "tif"
    captured(path, tmp_path / "out", area, tilt_deg=10.0, image_format=image_format, as_stored=as_stored)
    made = make_orthomosaic(tmp_path / "out")
    opened, shown = read(made.path)
    assert set(np.unique(shown[0])) == {0, 90}
    bands = 3 if image_format == "png" else min(count, 3)
    each = tuple(QUANTITIES[at % count] for at in range(bands))
    assert quantities(opened, bands) == each
    # That colours are red, green and blue in this order goes without saying beside a PNG.
    named = [opened.GetRasterBand(1 + at).GetDescription() for at in range(bands)]
    assert named == ([NIR[at] for at in range(bands)] if as_stored else [""] * 3)


def test_a_mosaic_of_stretched_values_says_nothing_of_them(tmp_path):
    path = stated(tmp_path / "r.tif", noise("uint16", 3))
    lat, lon = place()
    captured(path, tmp_path / "out", Points(((lat, lon, 60.0), (lat + 1e-4, lon, 60.0))), tilt_deg=10.0)
    opened, _ = read(make_orthomosaic(tmp_path / "out").path)
    assert quantities(opened, 3) == ((1.0, 0.0, ""),) * 3


@pytest.mark.parametrize("data_type", ["uint8", "uint16"])
def test_loaders_say_what_stored_values_mean(data_type, tmp_path):
    lat, lon = place()
    area = Points(((lat, lon, 60.0), (lat + 1e-4, lon, 60.0)))
    captured(stated(tmp_path / "r.tif", noise(data_type, 3)), tmp_path / "out", area)
    samples = LabelledImages(tmp_path / "out", part="all", dtype="stored")
    assert [(one.scale, one.offset, one.unit) for one in samples.bands.each_metadata] == list(QUANTITIES[:3])
    assert samples.bands.names == NIR[:3]
    if data_type == "uint8":
        assert LabelledImages(tmp_path / "out", part="all").bands is None


@pytest.mark.thorough
def test_a_palette_of_more_than_256_colours_is_looked_up(tmp_path, library):
    rng = np.random.default_rng(2)
    values = rng.integers(0, 3000, (1, SIDE, SIDE), np.uint16)
    path = written(tmp_path / "r.tif", values)
    table = rng.integers(0, 256, (3000, 3))
    colours = gdal.ColorTable()
    for at, colour in enumerate(table.tolist()):
        colours.SetColorEntry(at, (*colour, 255))
    copied = gdal.GetDriverByName("GTiff").Create(
        str(tmp_path / "p.tif"), SIDE, SIDE, 1, gdal.GDT_UInt16, options=["PHOTOMETRIC=PALETTE"]
    )
    original = gdal.Open(str(path))
    copied.SetGeoTransform(original.GetGeoTransform())
    copied.SetProjection(original.GetProjection())
    copied.GetRasterBand(1).SetColorTable(colours)
    copied.GetRasterBand(1).WriteArray(values[0])
    del copied
    for as_stored, image_format in ((True, "tif"), (False, "png")):
        _, paths = captured(tmp_path / "p.tif", tmp_path / image_format, as_stored=as_stored, image_format=image_format)
        opened, shown = read(paths[0])
        assert np.array_equal(np.moveaxis(shown, 0, 2), table[window(opened, values)[0]])


def test_bands_keep_what_they_are_sensitive_to(tmp_path):
    kinds = [gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand, gdal.GCI_Undefined]
    path = written(tmp_path / "r.tif", noise("uint16"), colours=tuple(kinds))
    with open_raster_of(path) as source:
        plain = source.bands
    about = BandMetadata(colour="nir")
    named = Bands(plain.names, "uint16", plain.shown, (BandMetadata(),) * 3 + (about,))
    data = geotiff(np.moveaxis(noise("uint16", 4, 40), 0, 2)[:30], PLACE, ABOUT, named, ((0.0, 1.0),) * 4)
    assert b'<Item name="COLORINTERP" sample="3" role="colorinterp">nir</Item>' in data


def open_raster_of(path):
    from contextlib import closing

    return closing(open_raster(path, as_stored=True))


@pytest.mark.parametrize("bits", sampled([8, 4, 1, 16, 12], 2))
@pytest.mark.parametrize("image_format", ["tif", "png"])
def test_greys_that_count_from_white_show_what_the_file_shows(bits, image_format, tmp_path, library):
    wide = bits > 8
    most = (1 << bits) - 1
    values = np.random.default_rng(4).integers(0, most + 1, (1, SIDE, SIDE)).astype(np.uint16 if wide else np.uint8)
    written(tmp_path / "plain.tif", values)
    options = ["PHOTOMETRIC=MINISWHITE", *([f"NBITS={bits}"] if bits not in (8, 16) else [])]
    gdal.Translate(str(tmp_path / "r.tif"), str(tmp_path / "plain.tif"), creationOptions=options)
    more = {"stretch": f"0 {most}"} if wide and image_format == "png" else {}
    _, paths = captured(
        tmp_path / "r.tif",
        tmp_path / "out",
        image_format=image_format,
        as_stored=image_format == "tif",
        **more,
    )
    opened, shown = read(paths[0])
    black_is_0 = most - window(opened, values)[0].astype(np.int64)
    expected = black_is_0 if wide and image_format == "tif" else np.rint(black_is_0 * (255.0 / most))
    assert np.abs(shown - expected).max() == 0
    assert opened.GetMetadataItem("MINISWHITE", "IMAGE_STRUCTURE") is None


def test_quantities_of_greys_that_count_from_white_stay_the_same(tmp_path):
    values = np.random.default_rng(4).integers(1, 255, (1, SIDE, SIDE)).astype(np.uint8)
    stated(tmp_path / "plain.tif", values, quantities=((0.5, -3.0, "m"),))
    gdal.Translate(str(tmp_path / "r.tif"), str(tmp_path / "plain.tif"), creationOptions=["PHOTOMETRIC=MINISWHITE"])
    _, paths = captured(tmp_path / "r.tif", tmp_path / "out")
    opened, shown = read(paths[0])
    ((scale, offset, unit),) = quantities(opened, 1)
    assert unit == "m"
    assert np.array_equal(shown[0] * scale + offset, window(opened, values)[0] * 0.5 - 3.0)


@pytest.mark.parametrize(("image_format", "expected"), [("tif", (94, 106, 220)), ("png", (174, 180, 237))])
def test_translucent_pixels_are_as_stored_in_geotiffs_and_over_white_elsewhere(
    image_format, expected, tmp_path, library
):
    values = np.empty((4, SIDE, SIDE), np.uint8)
    values[:] = np.array([94, 106, 220, 128])[:, None, None]
    kinds = (gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand, gdal.GCI_AlphaBand)
    path = written(tmp_path / "r.tif", values, colours=kinds)
    _, paths = captured(path, tmp_path / "out", image_format=image_format, as_stored=image_format == "tif")
    _, shown = read(paths[0])
    # 94 · 128 / 255 + 255 · 127 / 255 and so on, rounded, over white.
    assert (shown == np.array(expected)[:, None, None]).all()
    assert len(shown) == 3
