"""Rasters of any number of bands and of more than 8 bits: their values, bit for bit, in images and between pixels."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from PIL import Image  # noqa: E402
from terrainav.core.bands import RGB, Bands  # noqa: E402
from terrainav.core.capture.runner import capture  # noqa: E402
from terrainav.core.dataset.entropy import entropy  # noqa: E402
from terrainav.core.dataset.table import Table  # noqa: E402
from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.imagery.opening import open_source  # noqa: E402
from terrainav.core.imagery.raster import source as raster_source  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.imagery.source import Window  # noqa: E402
from terrainav.core.mission.areas.area import Box, Points  # noqa: E402
from terrainav.core.mission.mission import Mission  # noqa: E402
from terrainav.core.mission.plan import plan  # noqa: E402
from terrainav.core.picture.camera_frame import camera_parts, render  # noqa: E402

from tests.support import rasters  # noqa: E402
from tests.support.command import command  # noqa: E402

#: UTM 16 N, 0.5 m; its middle lies at 35.15, -89.9.
SIDE = 800
WEST, NORTH = 235_600.123, 3_893_700.077
UTM, EPSG = (WEST, 0.5, 0.0, NORTH, 0.0, -0.5), 32616
NIR = ("red", "green", "blue", "nir")
GDAL_TYPES = {
    "uint8": gdal.GDT_Byte,
    "uint16": gdal.GDT_UInt16,
    "int16": gdal.GDT_Int16,
    "float32": gdal.GDT_Float32,
}
#: USDA NAIP photographs of North Dakota, 5 m pixels, four bands, EPSG:26914; beside a checkout, never inside it.
PHOTOGRAPH = Path(__file__).resolve().parents[5] / "shared" / "data" / "naip" / "20200831.tif"


def noise(data_type, bands=4, side=SIDE):
    rng = np.random.default_rng(7)
    if data_type == "float32":
        # From the smallest to the largest: nothing survives that is not copied.
        return (rng.normal(size=(bands, side, side)) * 10.0 ** rng.integers(-30, 30, (bands, side, side))).astype(
            np.float32
        )
    limits = np.iinfo(data_type)
    return rng.integers(limits.min, limits.max, (bands, side, side), data_type, endpoint=True)


def written(path, values, names=(), **options):
    kind = GDAL_TYPES[values.dtype.name]
    rasters.write(path, values, UTM, EPSG, data_type=kind, options=("ALPHA=NO",), **options)
    made = gdal.Open(str(path), gdal.GA_Update)
    for index, name in enumerate(names):
        made.GetRasterBand(index + 1).SetDescription(name)
    del made
    return path


def place(column=SIDE / 2, row=SIDE / 2):
    import pyproj

    lon, lat = pyproj.Transformer.from_crs(EPSG, 4326, always_xy=True).transform(WEST + column * 0.5, NORTH - row * 0.5)
    return float(lat), float(lon)


def about(half=300):
    north, west = place(SIDE / 2 - half, SIDE / 2 - half)
    south, east = place(SIDE / 2 + half, SIDE / 2 + half)
    return Box(north, west, south, east)


def captured(path, folder, area=None, agl_m=60.0, *, as_stored=True, **mission):
    source = open_raster(
        path,
        bands=mission.get("bands", ()),
        stretch=mission.get("stretch", "none"),
        as_stored=as_stored,
    )
    try:
        worked_out = plan(Mission(area or about(), agl_m, source=str(path), **mission), source.grid)
        result = capture(worked_out, source, folder)
    finally:
        source.close()
    assert not result.failed
    assert result.written == len(worked_out) > 0
    return worked_out, [
        folder / "satellite" / f"{name}.{worked_out.mission.output.image_format}" for name in worked_out.names
    ]


def window(opened, values):
    """Part of the file that an image's georeference says it shows."""
    west, _, _, north, _, _ = opened.GetGeoTransform()
    column, row = round((west - WEST) / 0.5), round((NORTH - north) / 0.5)
    assert abs(west - WEST - column * 0.5) < 1e-6
    return values[:, row : row + opened.RasterYSize, column : column + opened.RasterXSize]


def read(path):
    """Bands (n, h, w) as GDAL reads them, and not as anything else does."""
    opened = gdal.Open(str(path))
    values = opened.ReadAsArray()
    return opened, values if values.ndim == 3 else values[np.newaxis]


@pytest.mark.parametrize(
    ("data_type", "bands"),
    [
        # All types, all counts; each with each is thorough.
        (data_type, bands) if bands == (1, 2, 4, 7)[at] else pytest.param(data_type, bands, marks=pytest.mark.thorough)
        for at, data_type in enumerate(GDAL_TYPES)
        for bands in (1, 2, 4, 7)
    ],
)
def test_images_straight_down_are_the_file_s_values_in_every_band(data_type, bands, tmp_path, library):
    names = [*NIR, "red edge", "thermal <IR> & more", "日本"][:bands]
    values = noise(data_type, bands)
    worked_out, paths = captured(written(tmp_path / "r.tif", values, names), tmp_path / "out")
    assert worked_out.accuracy.picture.method.name == "map"
    assert len(paths) > 3
    for path in paths:
        opened, shown = read(path)
        assert opened.RasterCount == bands
        assert shown.dtype.name == data_type
        assert np.array_equal(shown, window(opened, values))
        assert [opened.GetRasterBand(1 + i).GetDescription() for i in range(bands)] == names


def test_rasterio_reads_type_bands_and_names(tmp_path):
    rasterio = pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    values = noise("int16", 5)
    _, paths = captured(written(tmp_path / "r.tif", values, [*NIR, "swir"]), tmp_path / "out")
    with rasterio.open(paths[0]) as opened:
        assert opened.dtypes == ("int16",) * 5
        assert opened.descriptions == (*NIR, "swir")
        assert [colour.name for colour in opened.colorinterp[:3]] == ["red", "green", "blue"]
        column, row = round((opened.transform.c - WEST) * 2), round((NORTH - opened.transform.f) * 2)
        part = values[:, row : row + opened.height, column : column + opened.width]
        assert np.array_equal(opened.read(), part)


@pytest.mark.parametrize("wanted", [("4", "1", "2"), ("nir", "red", "green"), ("NIR", "1", "green")])
def test_bands_come_in_the_order_that_is_asked_for(wanted, tmp_path, library):
    values = noise("uint16")
    path = written(tmp_path / "r.tif", values, NIR)
    _, paths = captured(path, tmp_path / "out", bands=wanted)
    opened, shown = read(paths[1])
    assert np.array_equal(shown, window(opened, values[[3, 0, 1]]))
    assert [opened.GetRasterBand(1 + i).GetDescription() for i in range(3)] == ["nir", "red", "green"]
    # Three bands that are chosen are shown as red, green and blue, as colour infrared is.
    assert opened.GetRasterBand(1).GetColorInterpretation() == gdal.GCI_RedBand


def test_names_are_colours_where_the_file_states_no_other(tmp_path, library):
    values = noise("uint8", 5)
    kinds = (gdal.GCI_Undefined, gdal.GCI_BlueBand, gdal.GCI_GreenBand, gdal.GCI_RedBand, gdal.GCI_AlphaBand)
    values[4] = 255
    path = written(tmp_path / "r.tif", values, colours=kinds)
    source = open_raster(path, as_stored=True)
    assert source.bands == Bands(("band 1", "blue", "green", "red"), "uint8", (3, 2, 1))
    source.close()
    _, paths = captured(path, tmp_path / "out")
    opened, shown = read(paths[0])
    assert np.array_equal(shown, window(opened, values[:4]))
    # What is shown as red is said to be red, wherever it stands.
    assert [opened.GetRasterBand(1 + i).GetColorInterpretation() for i in range(4)] == list(kinds[:4])
    _, paths = captured(path, tmp_path / "red", bands=("red",))
    opened, shown = read(paths[0])
    assert np.array_equal(shown, window(opened, values[3:4]))
    # A band that is said to be alpha is one like others where it is asked for: infrared often is.
    _, paths = captured(path, tmp_path / "alpha", bands=("alpha", "1"))
    opened, shown = read(paths[0])
    assert np.array_equal(shown, window(opened, values[[4, 0]]))


def test_three_bands_of_8_bits_are_the_same_file_as_ever(tmp_path):
    values = noise("uint8", 3)
    path = written(tmp_path / "r.tif", values)
    contents = []
    for as_stored in (True, False):
        _, paths = captured(path, tmp_path / str(as_stored), as_stored=as_stored)
        contents.append([path.read_bytes() for path in paths])
    assert contents[0] == contents[1]
    source = open_raster(path, as_stored=True)
    assert source.bands == RGB
    source.close()


@pytest.mark.parametrize("image_format", ["jpg", "png", "tif"])
def test_percentiles_of_the_file_become_black_and_white(image_format, tmp_path):
    # Sixteen bits of which the values take a small part, and other ones in each band.
    rng = np.random.default_rng(1)
    values = np.stack([rng.normal(1000 * (1 + b), 90 * (1 + b), (SIDE, SIDE)) for b in range(3)]).astype(np.uint16)
    path = written(tmp_path / "r.tif", values)
    options = {"image_format": image_format, "stretch": "percentile"}
    _, paths = captured(path, tmp_path / "out", as_stored=image_format == "tif", **options)
    low, high = np.percentile(values.reshape(3, -1), (2, 98), axis=1)
    expected = np.clip((values - low[:, None, None]) * (255.0 / (high - low))[:, None, None], 0, 255)
    for name in paths[:3]:
        opened, shown = read(name)
        assert shown.dtype == np.uint8
        wrong = np.abs(shown - window(opened, np.rint(expected)))
        assert wrong.max() == 0 if image_format != "jpg" else wrong.mean() < 9.0
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert (table.entropies > 6.5).all()


def test_two_numbers_become_black_and_white(tmp_path, library):
    values = np.arange(-400, 400, dtype=np.int16)[np.newaxis, np.newaxis].repeat(SIDE, 1)
    path = written(tmp_path / "r.tif", values)
    _, paths = captured(path, tmp_path / "out", as_stored=False, image_format="png", stretch="-100 155")
    opened, shown = read(paths[0])
    assert np.array_equal(shown, np.clip(window(opened, values).repeat(3, 0) + 100, 0, 255))


def test_entropy_is_that_of_the_values_as_they_are_shown(tmp_path):
    values = np.random.default_rng(2).integers(2000, 2256, (1, SIDE, SIDE)).astype(np.uint16)
    _, paths = captured(written(tmp_path / "r.tif", values), tmp_path / "out")
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    low, high = np.percentile(values, (2, 98))
    for path, bits in zip(paths, table.entropies):
        opened, shown = read(path)
        grey = np.rint(np.clip((shown[0] - low) * (255.0 / (high - low)), 0, 255)).astype(np.uint8)
        assert entropy(grey) == pytest.approx(float(bits), abs=1e-6)
        assert opened.GetRasterBand(1).GetMetadataItem("DISPLAY_RANGE") == f"{low!r} {high!r}".replace(
            "np.float64(", ""
        ).replace(")", "")


@pytest.mark.parametrize("data_type", ["uint16", "int16", "float32", "uint8"])
@pytest.mark.parametrize("mesh", ["auto", "rays"])
def test_camera_frames_take_their_values_between_pixels_as_float64_does(data_type, mesh, tmp_path):
    """Ramps in columns and rows, whose bilinear values are the positions themselves."""
    columns, rows = np.meshgrid(np.arange(SIDE) + 0.5, np.arange(SIDE) + 0.5)
    scale = {"uint16": 80.0, "int16": 80.0, "float32": 1e-3, "uint8": 0.3}[data_type]
    offset = -32000.0 if data_type == "int16" else 0.0
    ramps = np.stack([columns, rows, (columns + rows) / 2, columns]) * scale
    values = (np.rint(ramps + offset) if data_type != "float32" else ramps).astype(data_type)
    lat, lon = place()
    mission = {"tilt_deg": 30.0, "yaw_deg": 25.0, "mesh": mesh}
    _, paths = captured(
        written(tmp_path / "r.tif", values, NIR), tmp_path / "out", Points(((lat, lon, 60.0),)), **mission
    )
    opened, shown = read(paths[0])
    assert shown.dtype.name == data_type
    assert opened.RasterCount == 4
    column, row = ((shown[b].astype(np.float64) - offset) / scale for b in (0, 1))
    # Where a pixel of the image looks to, by the points that its file states.
    points = opened.GetGCPs()
    import pyproj

    to_utm = pyproj.Transformer.from_crs(4326, EPSG, always_xy=True)
    checked = 0
    step = 1.0 / scale if data_type != "float32" else 0.0
    for point in points:
        x, y = round(point.GCPPixel - 0.5), round(point.GCPLine - 0.5)
        if not (2 < x < opened.RasterXSize - 3 and 2 < y < opened.RasterYSize - 3):
            continue
        east, north = to_utm.transform(point.GCPX, point.GCPY)
        # Bilinear between the centres of four pixels, in float64.
        at = [np.array([[field[y + j, x + i] for i in (-1, 0, 1)] for j in (-1, 0, 1)]) for field in (column, row)]
        dx, dy = point.GCPPixel - 0.5 - x, point.GCPLine - 0.5 - y
        found = [a[1, 1] + dx * (a[1, 2] - a[1, 0]) / 2 + dy * (a[2, 1] - a[0, 1]) / 2 for a in at]
        assert found[0] == pytest.approx((east - WEST) / 0.5, abs=0.15 + step)
        assert found[1] == pytest.approx((NORTH - north) / 0.5, abs=0.15 + step)
        checked += 1
    assert checked > 15
    # The bands of one pixel are of one place: sums of ramps are ramps, to the rounding of each.
    least = 2.0 if data_type != "float32" else 1e-3
    assert np.abs((column + row) - (shown[2].astype(np.float64) - offset) * 2 / scale).max() <= least * (
        1.0 / scale if data_type != "float32" else 1.0
    ) * (2.0 if data_type == "uint8" else 1.0)


@pytest.mark.parametrize("data_type", ["uint16", "int16", "float32"])
def test_rays_are_bilinear_in_float64_between_white_noise(data_type, tmp_path):
    values = noise(data_type, 4)
    if data_type == "float32":
        values = np.random.default_rng(9).normal(0.0, 1e5, values.shape).astype(np.float32)
    lat, lon = place()
    source = open_raster(written(tmp_path / "r.tif", values, NIR), as_stored=True)
    mission = Mission(Points(((lat, lon, 60.0),)), 60.0, tilt_deg=20.0, yaw_deg=40.0, mesh="rays", source="r.tif")
    worked_out = plan(mission, source.grid)
    view, lon_deg = worked_out.views.view(0), float(worked_out.lon_deg[0])
    parts = camera_parts(view, lon_deg)
    pixels = {part.window: source.fetch("", part.window) for part in parts}
    source.close()
    picture = render(view, lon_deg, parts, pixels, "bilinear", source.bands)
    u = float(source.grid.meridian_u(np.asarray(lon_deg)))
    seen = 0
    for patches in view.patches:
        # Of the file's own pixels: those of a zoom further down are means of them.
        down = 2 ** (source.grid.native_zoom - patches.zoom)
        if down != 1:
            continue
        world = source.grid.world_px(patches.zoom)
        for traced in view.traced(patches):
            x, y = (u + traced.du) * world - 0.5, traced.v * world - 0.5
            column, row = np.floor(x).astype(int), np.floor(y).astype(int)
            across, below = x - column, y - row
            corners = {(i, j): values[:, row + j, column + i].astype(np.float64) for i in (0, 1) for j in (0, 1)}
            upper = corners[0, 0] * (1 - across) + corners[1, 0] * across
            lower = corners[0, 1] * (1 - across) + corners[1, 1] * across
            expected = (upper * (1 - below) + lower * below).mean(axis=-1)
            found = picture[traced.row, traced.column].T.astype(np.float64)
            most = 0.5 + 1e-6 if data_type != "float32" else np.abs(expected).max() * 2.0**-23
            assert np.abs(found - expected).max() <= most
            seen += found.shape[1]
    assert seen > 0.5 * picture.shape[0] * picture.shape[1]


@pytest.mark.parametrize("kernel", ["bicubic", "lanczos"])
@pytest.mark.parametrize("data_type", ["uint16", "int16", "uint8"])
def test_what_a_kernel_overshoots_is_cut_at_the_ends_of_the_type(kernel, data_type, tmp_path):
    limits = np.iinfo(data_type)
    stripes = np.where(np.arange(SIDE) // 7 % 2, limits.max, limits.min).astype(data_type)
    values = stripes[np.newaxis, np.newaxis].repeat(SIDE, 1).repeat(2, 0)
    lat, lon = place()
    _, paths = captured(
        written(tmp_path / "r.tif", values),
        tmp_path / "out",
        Points(((lat, lon, 60.0),)),
        tilt_deg=20.0,
        resampling=kernel,
    )
    _, shown = read(paths[0])
    columns = shown[0].astype(np.int64)
    assert columns.min() == limits.min
    assert columns.max() == limits.max
    # A value that had wrapped around would lie among those of the other end.
    middle = (int(limits.min) + int(limits.max)) // 2
    light, dark = columns > middle, columns <= middle
    inner = light[:, 1:-1] & light[:, :-2] & light[:, 2:]
    assert (columns[:, 1:-1][inner] > middle).all()
    assert (columns[dark] >= limits.min).all()


@pytest.mark.parametrize(
    ("data_type", "channels", "names"),
    [
        ("uint16", 3, ("red", "green", "blue")),
        ("uint16", 1, ("grey",)),
        ("float32", 3, ("red", "green", "blue")),
    ],
)
def test_images_are_resized_in_their_own_type(data_type, channels, names, tmp_path):
    values = np.random.default_rng(5).uniform(100, 60000, (4, SIDE, SIDE)).astype(data_type)
    path = written(tmp_path / "r.tif", values, NIR)
    worked_out, paths = captured(path, tmp_path / "out", img_size=(50, 40, channels))
    opened, shown = read(paths[0])
    assert shown.shape == (channels, 40, 50)
    assert shown.dtype.name == data_type
    assert tuple(opened.GetRasterBand(1 + i).GetDescription() for i in range(channels)) == names
    _, whole = read(captured(path, tmp_path / "whole", zoom=worked_out.zoom)[1][0])
    wide = whole[:3].astype(np.float64)
    if channels == 1:
        wide = np.tensordot([[0.299, 0.587, 0.114]], wide, 1)
    expected = [np.asarray(Image.fromarray(band.astype(np.float32)).resize((50, 40), Image.LANCZOS)) for band in wide]
    assert np.abs(shown - np.array(expected)).max() <= 1.5


@pytest.mark.parametrize(
    ("data_type", "nodata"),
    [("uint16", 65535), ("int16", -9999), ("float32", -3.4028234663852886e38), ("float32", math.nan)],
)
def test_values_without_data_are_no_imagery_in_any_type(data_type, nodata, tmp_path, library):
    values = np.full((2, SIDE, SIDE), 1000, data_type)
    values[:, 300:310, 400:420] = nodata
    # One band alone says nothing, unless it is no number.
    values[0, 350, 450] = nodata
    source = open_raster(written(tmp_path / "r.tif", values, nodata=nodata), as_stored=True)
    zoom = source.grid.native_zoom
    pixels = source.fetch("", Window(zoom, 256, 256, 256, 256))
    assert pixels.shape == (256, 256, 3)
    assert pixels.dtype.name == data_type
    hole = np.zeros((256, 256), bool)
    hole[300 - 256 : 310 - 256, 400 - 256 : 420 - 256] = True
    hole[350 - 256, 450 - 256] = isinstance(nodata, float) and math.isnan(nodata)
    assert np.array_equal(pixels[..., 2] == 0, hole)
    assert not pixels[hole].any()
    # What is missing never mixes with values that are there.
    small = source.fetch("", Window(zoom - 1, 128, 128, 256, 256))
    assert set(np.unique(small[small[..., 2] != 0][:, 1])) == {1000}
    source.close()


def test_alpha_and_masks_of_more_than_8_bits_are_no_imagery_where_they_are_0(tmp_path, library):
    values = noise("uint16")
    values[3] = 65535
    values[3, :400] = 0
    kinds = (gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand, gdal.GCI_AlphaBand)
    source = open_raster(written(tmp_path / "r.tif", values, colours=kinds), as_stored=True)
    assert source.bands.names == ("red", "green", "blue")
    pixels = source.fetch("", Window(source.grid.native_zoom, 256, 256, 256, 256))
    assert np.array_equal(pixels[..., 3] != 0, values[3, 256:512, 256:512] != 0)
    assert np.array_equal(pixels[200:, :, :3], np.moveaxis(values[:3, 456:512, 256:512], 0, 2))
    source.close()


@pytest.mark.parametrize("data_type", GDAL_TYPES)
def test_means_are_those_of_the_values_rounded_once(data_type, tmp_path, library):
    rng = np.random.default_rng(3)
    values = rng.uniform(-9 if data_type in ("int16", "float32") else 0, 200, (2, SIDE, SIDE)) * (
        1 if data_type == "uint8" else 100
    )
    values = values.astype(data_type)
    source = open_raster(written(tmp_path / "r.tif", values), as_stored=True)
    pixels = source.fetch("", Window(source.grid.native_zoom - 2, 32, 32, 128, 128)).astype(np.float64)
    blocks = values[:, 128:640, 128:640].astype(np.float64).reshape(2, 128, 4, 128, 4).mean((2, 4))
    most = 0.5 if data_type != "float32" else 1e-3
    assert np.abs(pixels[..., :2] - np.moveaxis(blocks, 0, 2)).max() <= most + 1e-9
    source.close()


@pytest.mark.parametrize("data_type", GDAL_TYPES)
def test_what_a_camera_does_not_see_is_no_data_to_gdal(data_type, tmp_path):
    values = np.full((2, SIDE, SIDE), 77, data_type)
    lat, lon = place()
    area = Points(((lat, lon, 30.0),))
    source = open_raster(written(tmp_path / "r.tif", values), as_stored=True)
    mission = Mission(area, 30.0, source="r.tif", tilt_deg=40.0)
    worked_out = plan(mission, source.grid)
    from terrainav.core.capture.records import image_job
    from terrainav.core.capture.writers import write_picture

    job = image_job(worked_out, 0, source, "satellite", tmp_path)
    pixels = np.full((60, 80, 3), 77, data_type)
    pixels[:20] = 0
    write_picture(tmp_path, "tif", pixels, job.place, job.description, job.bands, job.ranges)
    source.close()
    opened = gdal.Open(str(tmp_path / f"{worked_out.names[0]}.tif"))
    if np.dtype(data_type).kind == "u":
        # GDAL takes alpha for the mask of one or three bands alone; with others it is a band that says so.
        assert opened.GetRasterBand(3).GetColorInterpretation() == gdal.GCI_AlphaBand
        mask = opened.GetRasterBand(3).ReadAsArray()
    else:
        mask = opened.GetRasterBand(1).GetMaskBand().ReadAsArray()
    assert np.array_equal(mask != 0, pixels[..., 2] != 0)
    assert (opened.GetRasterBand(2).ReadAsArray()[20:] == 77).all()


def refused(path, field, **options):
    with pytest.raises(InvalidInput) as caught:
        open_raster(path, **options).close()
    assert caught.value.field == field
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_what_cannot_be_is_refused_in_one_line(tmp_path, library):
    path = written(tmp_path / "r.tif", noise("uint16", 4, 64), NIR)
    for as_stored in (True, False):
        stored = {"as_stored": as_stored, "stretch": "percentile"}
        assert "band '5': r.tif has 1 red, 2 green, 3 blue, 4 nir" in refused(path, "bands", bands=("5",), **stored)
        assert "band 'swir'" in refused(path, "bands", bands=("swir",), **stored)
        assert "band 'nir': is named twice" in refused(path, "bands", bands=("4", "nir"), **stored)
        assert "lower one first" in refused(path, "stretch", stretch="5 2", as_stored=as_stored)
        assert "lower one first" in refused(path, "stretch", stretch="a lot", as_stored=as_stored)
    assert "2 bands: JPEG and PNG have one or three" in refused(path, "bands", bands=("1", "2"), stretch="percentile")
    assert "uint16, but JPEG and PNG have 8 bits; choose how they become 8 bits (--stretch)" in refused(path, "stretch")
    wide = rasters.write(tmp_path / "wide.tif", np.zeros((1, 8, 8)), UTM, EPSG, data_type=gdal.GDT_Float64)
    assert "values of band 1 are float64: must be one of uint8, uint16, int16, float32" in refused(
        wide, "", as_stored=True
    )
    for options in ({"bands": ("4",)}, {"stretch": "percentile"}):
        for name in ("world", "https://h.example/{z}/{x}/{y}.png"):
            with pytest.raises(InvalidInput, match="as all sources but raster files") as caught:
                open_source(name, **options)
            assert caught.value.field in options


def test_a_format_without_room_for_the_bands_is_refused_before_anything_is_written(tmp_path):
    path = written(tmp_path / "r.tif", noise("uint8"), NIR)
    with pytest.raises(InvalidInput) as caught:
        captured(path, tmp_path / "out", image_format="png")
    assert caught.value.field == "image_format"
    with pytest.raises(InvalidInput) as caught:
        captured(path, tmp_path / "out", bands=("1", "2"), img_size=(64, 64, 3))
    assert caught.value.field == "img_size"
    assert not (tmp_path / "out").exists()


def test_a_large_file_is_sampled_all_over_and_always_alike(tmp_path, monkeypatch):
    values = noise("uint16", 1)
    path = written(tmp_path / "r.tif", values)
    monkeypatch.setattr(raster_source, "_MOST_SAMPLED_PX", 1000)
    found = []
    for _ in range(2):
        source = open_raster(path, as_stored=True)
        found.append(source.ranges)
        source.close()
    assert found[0] == found[1]
    assert found[0][0] == pytest.approx(np.percentile(values, (2, 98)), abs=300)


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def test_the_command_takes_bands_and_a_stretch(run, tmp_path):
    values = np.arange(-400, 400, dtype=np.int16)[np.newaxis, np.newaxis].repeat(SIDE, 1).repeat(4, 0)
    values[3] += 100
    written(tmp_path / "r.tif", values, NIR)
    box = about()
    coords = f"{box.north_deg}_{box.west_deg}_{box.south_deg}_{box.east_deg}_60"
    asked = ("--coords", coords, "--source", "r.tif")
    planned = run("plan", *asked)
    assert planned.returncode == 0, planned.stderr
    said = planned.stdout
    assert re.search(r"^bands +red, green, blue, nir \(int16\)$", said, re.MULTILINE)
    assert json.loads(run("plan", *asked, "--json").stdout)["bands"]["data_type"] == "int16"
    three = run("plan", *asked, "--bands", "1").stdout
    files = [float(re.search(r"^files +([0-9.]+) (k|M)B", text, re.MULTILINE)[1]) for text in (said, three)]
    assert files[0] != files[1]
    done = run(
        *("capture", *asked, "--format", "png", "--bands", "nir", "1", "green", "--stretch", "-100", "155"),
        *("--data-dir", "out"),
    )
    assert done.returncode == 0
    path = min((tmp_path / "out" / "satellite").glob("*.png"))
    opened, shown = read(path)
    assert np.array_equal(shown, np.clip(window(opened, values[[3, 0, 1]].astype(int)) + 100, 0, 255))
    mission = json.loads((tmp_path / "out" / "mission.json").read_text())
    assert mission["imagery"]["bands"] == ["nir", "1", "green"]
    assert mission["imagery"]["stretch"] == "-100 155"
    # A mission file may have numbers, and says all that the options say.
    mission["imagery"]["bands"] = [4, 1, 2]
    (tmp_path / "m.json").write_text(json.dumps(mission))
    assert run("capture", "m.json", "--data-dir", "again").returncode == 0
    assert read(tmp_path / "again" / "satellite" / path.name)[1].tolist() == shown.tolist()
    (tmp_path / "config.json").write_text(json.dumps({"bands": "nir red", "stretch": "percentile"}))
    assert run("capture", *asked, "--data-dir", "two").returncode == 0
    opened, shown = read(tmp_path / "two" / "satellite" / path.with_suffix(".tif").name)
    assert (shown.shape[0], shown.dtype) == (2, np.uint8)
    for options, words in (
        (("--bands", "9"), "band '9': r.tif has 1 red, 2 green, 3 blue, 4 nir"),
        (("--stretch", "3", "2"), "the lower one first"),
        (("--format", "jpg", "--stretch", "none", "--bands", "1"), "(--stretch)"),
    ):
        refused = run("capture", *asked, *options, "--data-dir", "three")
        assert refused.returncode == 2
        assert words in refused.stderr
        assert refused.stderr.count("\n") == 1
        assert not (tmp_path / "three").exists()


@pytest.mark.real_data
@pytest.mark.skipif(not PHOTOGRAPH.is_file(), reason="the photographs of ../shared/data/naip are not there")
@pytest.mark.parametrize(("bands", "expected"), [((), (1, 2, 3, 4)), (("4", "1", "2"), (4, 1, 2))])
def test_naip_gives_images_at_its_own_5_m_with_its_four_bands(bands, expected, tmp_path, library):
    photograph = gdal.Open(str(PHOTOGRAPH))
    area = Box(47.028, -99.174, 47.012, -99.136)
    worked_out, paths = captured(PHOTOGRAPH, tmp_path / "out", area, 1200.0, bands=bands)
    assert worked_out.resolution.source_m_per_px == pytest.approx(5.0, rel=1e-3)
    west, _, _, north, _, _ = photograph.GetGeoTransform()
    for path in paths:
        opened, shown = read(path)
        assert opened.GetSpatialRef().GetAuthorityCode(None) == "26914"
        left, across, _, top, _, down = opened.GetGeoTransform()
        assert (across, down) == (5.0, -5.0)
        part = (round((left - west) / 5), round((north - top) / 5), opened.RasterXSize, opened.RasterYSize)
        assert np.array_equal(shown, np.stack([photograph.GetRasterBand(band).ReadAsArray(*part) for band in expected]))
