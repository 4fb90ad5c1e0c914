"""Files as other software reads them: GDAL for CRS, edges, pixels and metadata; Pillow for EXIF and text."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture import writers as jpeg
from terrainav.core.capture.georeference import Georeference
from terrainav.core.capture.metadata import Description
from terrainav.core.capture.writers import file_endings, write_picture
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.mercator import HALF_WORLD_M, PixelGrid

from tests.support.patterns import encode_position

FORMATS = ("tif", "jpg", "png")
# The promise of the format: a picture's edges are its window's to a micrometre.
EDGE_M = 1e-6

GRID, ZOOM = PixelGrid(), 18
AGRICENTER = (16795774, 26545132)
WINDOWS = {
    "Agricenter": (*AGRICENTER, 323, 242),
    "north-west corner of the world": (0, 0, 300, 200),
    "across the antimeridian": ((256 << ZOOM) - 100, 26545132, 323, 242),
    "west of the antimeridian": (-100, 26545132, 323, 242),
    "one pixel": (*AGRICENTER, 1, 1),
    "by its centre": (16795774.125, 26545132.875, 640, 640),
}
DESCRIPTION = Description(
    name="3_7_35.15988939_-89.89958078_18",
    map_type="satellite",
    source="Synthetic (offline)",
    attribution='© "Söhne" & <Töchter>, it\'s 日本',
    zoom=ZOOM,
    lat_deg=35.159889173820034,
    lon_deg=-89.89958173522095,
    agl_m=120.5,
)


@pytest.fixture(scope="module")
def gdal():
    osgeo = pytest.importorskip("osgeo.gdal", reason="GDAL's Python modules are not installed")
    osgeo.UseExceptions()
    return osgeo


def georeference(window, size=None) -> Georeference:
    _, _, width, height = window
    west, south, east, north = (
        float(edge) for edge in GRID.edges(*(np.asarray(value, np.float64) for value in window), ZOOM)
    )
    return Georeference(west, south, east, north, *(size or (width, height)))


def picture(width, height, channels=3, seed=0):
    rng = np.random.default_rng(seed)
    colour = rng.integers(0, 256, (height, width, 3), np.uint8)
    return colour if channels == 3 else colour[..., 0].copy()


@pytest.mark.parametrize("window", WINDOWS.values(), ids=WINDOWS)
@pytest.mark.parametrize("resized", [None, (100, 77), (700, 801)], ids=["as it is", "smaller", "larger"])
@pytest.mark.parametrize("image_format", FORMATS)
def test_gdal_finds_crs_and_edges(gdal, tmp_path, image_format, window, resized):
    from osgeo import osr

    reference = georeference(window, resized)
    width, height = reference.width_px, reference.height_px
    write_picture(tmp_path, image_format, picture(width, height), reference, DESCRIPTION)
    data = gdal.Open(str(tmp_path / f"{DESCRIPTION.name}.{image_format}"))
    assert (data.RasterXSize, data.RasterYSize, data.RasterCount) == (width, height, 3)
    west, step_x, row_turn, north, column_turn, step_y = data.GetGeoTransform()
    assert row_turn == column_turn == 0.0
    resolution = 2.0 * HALF_WORLD_M / (256 << ZOOM)
    left, top, window_width, window_height = window
    assert west == pytest.approx(-HALF_WORLD_M + left * resolution, abs=EDGE_M)
    assert north == pytest.approx(HALF_WORLD_M - top * resolution, abs=EDGE_M)
    assert west + width * step_x == pytest.approx(-HALF_WORLD_M + (left + window_width) * resolution, abs=EDGE_M)
    assert north + height * step_y == pytest.approx(HALF_WORLD_M - (top + window_height) * resolution, abs=EDGE_M)
    crs = data.GetSpatialRef()
    web_mercator = osr.SpatialReference()
    web_mercator.ImportFromEPSG(3857)
    assert crs.GetAuthorityName(None) == "EPSG"
    assert crs.GetAuthorityCode(None) == "3857"
    assert crs.IsSame(web_mercator)
    assert list(crs.GetDataAxisToSRSAxisMapping()) == [1, 2]


@pytest.mark.parametrize("image_format", ["jpg", "png"])
def test_a_world_file_alone_says_the_same(gdal, tmp_path, image_format):
    reference = georeference(WINDOWS["Agricenter"], (100, 77))
    write_picture(tmp_path, image_format, picture(100, 77), reference, DESCRIPTION)
    (tmp_path / f"{DESCRIPTION.name}.{image_format}.aux.xml").unlink()
    data = gdal.Open(str(tmp_path / f"{DESCRIPTION.name}.{image_format}"))
    assert data.GetGeoTransform() == pytest.approx(reference.geotransform, abs=EDGE_M)
    assert data.GetSpatialRef() is None


@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("size", [(323, 242), (1, 1), (2, 700), (900, 700)])
@pytest.mark.parametrize("image_format", ["tif", "png"])
def test_lossless_formats_are(gdal, tmp_path, image_format, size, channels):
    """Pillow and GDAL, with decoders of their own, see the pixels that were written; 900 x 700 is several strips."""
    pixels = picture(*size, channels)
    write_picture(tmp_path, image_format, pixels, georeference(WINDOWS["Agricenter"], size), DESCRIPTION)
    path = tmp_path / f"{DESCRIPTION.name}.{image_format}"
    with Image.open(path) as image:
        assert image.mode == ("L" if channels == 1 else "RGB")
        assert np.array_equal(np.asarray(image), pixels)
    read = gdal.Open(str(path)).ReadAsArray()
    assert np.array_equal(read if channels == 1 else read.transpose(1, 2, 0), pixels)


def test_a_geotiff_is_packed_in_strips(gdal, tmp_path):
    pixels = np.full((700, 900, 3), 90, np.uint8)
    write_picture(tmp_path, "tif", pixels, georeference(WINDOWS["Agricenter"], (900, 700)), DESCRIPTION)
    path = tmp_path / f"{DESCRIPTION.name}.tif"
    data = gdal.Open(str(path))
    assert data.GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE") == "DEFLATE"
    assert data.GetMetadataItem("AREA_OR_POINT") == "Area"
    assert data.GetRasterBand(1).GetBlockSize() == [900, 97]
    assert path.stat().st_size < pixels.nbytes / 50


@pytest.mark.parametrize("channels", [1, 3])
def test_jpeg_is_close_to_what_it_was_made_of(tmp_path, channels):
    x, y = np.meshgrid(np.arange(160), np.arange(120))
    colour = (
        np.stack([100 + 50 * np.sin(x / 9), 120 + 60 * np.cos(y / 7), 60 + x * 0.5], axis=-1).round().astype(np.uint8)
    )
    pixels = colour if channels == 3 else colour[..., 0].copy()
    write_picture(tmp_path, "jpg", pixels, georeference(WINDOWS["Agricenter"], (160, 120)), DESCRIPTION)
    with Image.open(tmp_path / f"{DESCRIPTION.name}.jpg") as image:
        assert image.mode == ("L" if channels == 1 else "RGB")
        error = np.asarray(image).astype(float) - pixels
    # Grey levels, root mean square: a smooth picture at this quality loses about one.
    assert np.sqrt(np.mean(error**2)) < 1.5


@pytest.mark.parametrize("image_format", FORMATS)
def test_gdal_shows_the_metadata(gdal, tmp_path, image_format):
    write_picture(tmp_path, image_format, picture(30, 20), georeference(WINDOWS["Agricenter"], (30, 20)), DESCRIPTION)
    shown = gdal.Open(str(tmp_path / f"{DESCRIPTION.name}.{image_format}")).GetMetadata()
    expected = {
        "NAME": DESCRIPTION.name,
        "MAP_TYPE": "satellite",
        "SOURCE": "Synthetic (offline)",
        "ATTRIBUTION": DESCRIPTION.attribution,
        "ZOOM": "18",
        "LAT_DEG": "35.159889174",
        "LON_DEG": "-89.899581735",
        "AGL_M": "120.5",
        "YAW_DEG": "0.0",
        "TILT_DEG": "0.0",
        "ROLL_DEG": "0.0",
    }
    assert expected.items() <= shown.items()
    assert DESCRIPTION.wrapped_lon_deg == -89.899581735


def test_tags_of_a_geotiff(gdal, tmp_path):
    write_picture(tmp_path, "tif", picture(30, 20), georeference(WINDOWS["Agricenter"], (30, 20)), DESCRIPTION)
    shown = gdal.Open(str(tmp_path / f"{DESCRIPTION.name}.tif")).GetMetadata()
    assert shown["TIFFTAG_SOFTWARE"] == "TerrAInav"
    assert shown["TIFFTAG_COPYRIGHT"] == DESCRIPTION.attribution
    assert shown["TIFFTAG_IMAGEDESCRIPTION"] == DESCRIPTION.title
    assert "Synthetic (offline)" in DESCRIPTION.title


def exif_position(path) -> tuple[float, float, float, float]:
    with Image.open(path) as image:
        exif = image.getexif()
        gps = exif.get_ifd(0x8825)
    sign = {"N": 1, "S": -1, "E": 1, "W": -1}

    def degrees(values):
        whole, minutes, seconds = (float(value) for value in values)
        assert 0 <= minutes < 60
        assert 0 <= seconds < 60
        return whole + minutes / 60 + seconds / 3600

    return (
        sign[gps[1]] * degrees(gps[2]),
        sign[gps[3]] * degrees(gps[4]),
        float(gps[6]),
        float(gps[17]),
    )


@pytest.mark.parametrize(
    ("lat", "lon", "agl", "yaw"),
    [
        (35.159889173820034, -89.89958173522095, 120.5, 0.0),
        (-0.00001, 179.99999999, 30.0, 359.5),
        (-45.999999999999, 12.0, 0.25, -90.0),
        (60.0, 181.25, 36_000_000.0, 720.25),
    ],
)
def test_jpeg_says_where_the_camera_was(tmp_path, lat, lon, agl, yaw):
    description = dataclasses.replace(DESCRIPTION, lat_deg=lat, lon_deg=lon, agl_m=agl, yaw_deg=yaw)
    write_picture(tmp_path, "jpg", picture(16, 16), georeference(WINDOWS["Agricenter"], (16, 16)), description)
    read = exif_position(tmp_path / f"{description.name}.jpg")
    # Half of the ninth decimal, and of the last digit of an EXIF second of arc, in degrees.
    digit = 0.5e-9 + 0.5e-7 / 3600
    assert read[0] == pytest.approx(lat, abs=1.01 * digit)
    assert read[1] == pytest.approx((lon + 180.0) % 360.0 - 180.0, abs=1.01 * digit)
    assert read[2] == pytest.approx(agl, abs=0.5e-3)
    assert read[3] == pytest.approx(yaw % 360.0, abs=1e-6)


def test_jpeg_says_what_it_is(tmp_path):
    write_picture(tmp_path, "jpg", picture(16, 16), georeference(WINDOWS["Agricenter"], (16, 16)), DESCRIPTION)
    with Image.open(tmp_path / f"{DESCRIPTION.name}.jpg") as image:
        exif = image.getexif()
    text = {number: value.encode("latin-1").decode("utf-8") for number, value in exif.items() if isinstance(value, str)}
    assert text == {270: DESCRIPTION.title, 305: "TerrAInav", 33432: DESCRIPTION.attribution}
    assert exif[274] == 1


def test_png_says_what_it_is(tmp_path):
    write_picture(tmp_path, "png", picture(16, 16), georeference(WINDOWS["Agricenter"], (16, 16)), DESCRIPTION)
    with Image.open(tmp_path / f"{DESCRIPTION.name}.png") as image:
        image.load()
        text = image.text
    assert text["Title"] == DESCRIPTION.title
    assert text["Software"] == "TerrAInav"
    assert text["Copyright"] == DESCRIPTION.attribution
    assert text["LAT_DEG"] == "35.159889174"


@pytest.mark.parametrize("image_format", FORMATS)
def test_bytes_depend_on_nothing_else(tmp_path, image_format):
    def written(folder):
        folder.mkdir()
        write_picture(folder, image_format, picture(64, 48), georeference(WINDOWS["Agricenter"], (64, 48)), DESCRIPTION)
        return {path.name: path.read_bytes() for path in folder.iterdir()}

    first, second = written(tmp_path / "a"), written(tmp_path / "b")
    assert first == second
    assert set(first) == {DESCRIPTION.name + ending for ending in file_endings(image_format)}


@pytest.mark.parametrize("image_format", FORMATS)
def test_the_picture_comes_last(tmp_path, image_format):
    order = []
    write_picture(
        tmp_path,
        image_format,
        picture(8, 8),
        georeference(WINDOWS["Agricenter"], (8, 8)),
        DESCRIPTION,
        write=lambda path, _: order.append(path.name),
    )
    assert order[-1] == f"{DESCRIPTION.name}.{image_format}"
    assert len(order) == (1 if image_format == "tif" else 3)


def test_metadata_that_is_no_xml_does_not_break_the_files(gdal, tmp_path):
    description = dataclasses.replace(DESCRIPTION, attribution="a\x00b\x1b]c\ud800 & </Item>")
    for image_format in FORMATS:
        write_picture(tmp_path, image_format, picture(8, 8), georeference(WINDOWS["Agricenter"], (8, 8)), description)
        data = gdal.Open(str(tmp_path / f"{description.name}.{image_format}"))
        assert data.GetSpatialRef().GetAuthorityCode(None) == "3857"
        assert data.GetMetadata()["NAME"] == description.name
        assert re.fullmatch("a.b.\\]c.+ & </Item>", data.GetMetadata()["ATTRIBUTION"])


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(OutputError, match=r"nowhere: cannot write .* \(No such file"):
        write_picture(
            tmp_path / "nowhere",
            "tif",
            picture(8, 8),
            georeference(WINDOWS["one pixel"], (8, 8)),
            DESCRIPTION,
        )


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((1.0, 0.0, 1.0, 1.0, 5, 5), "west < east"),
        ((0.0, 0.0, 1.0, float("inf"), 5, 5), "edges"),
        ((0.0, 0.0, 1.0, 1.0, 0, 5), "0 x 5 px"),
    ],
)
def test_impossible_georeferences_are_refused(values, message):
    with pytest.raises(InvalidInput, match=message):
        Georeference(*values)


def test_gdal_reads_positions_out_of_the_pixels(gdal, tmp_path):
    """What the pixels say about where they are is what the file says: 0.00 px."""
    left, top, width, height = WINDOWS["Agricenter"]
    pixels = encode_position(left + np.arange(width), top + np.arange(height))
    for image_format in ("tif", "png"):
        write_picture(tmp_path, image_format, pixels, georeference(WINDOWS["Agricenter"]), DESCRIPTION)
        data = gdal.Open(str(tmp_path / f"{DESCRIPTION.name}.{image_format}"))
        west, _, _, north, _, _ = data.GetGeoTransform()
        resolution = GRID.pixel_size(ZOOM)[0]
        stated = ((west + HALF_WORLD_M) / resolution, (HALF_WORLD_M - north) / resolution)
        assert np.round(stated, 6).tolist() == [left, top]


@pytest.mark.parametrize("channels", [1, 3])
def test_a_jpeg_has_the_same_bytes_on_systems_without_files_in_memory(monkeypatch, channels):
    pixels = picture(301, 77, channels)
    usual = jpeg.jpeg(pixels, DESCRIPTION)
    monkeypatch.delattr(jpeg.os, "memfd_create", raising=False)
    assert jpeg.jpeg(pixels, DESCRIPTION) == usual


def test_the_date_and_the_effective_resolution_are_in_the_metadata():
    said = dataclasses.replace(DESCRIPTION, imagery_date="2024-06-21", effective_gsd_m_per_px=0.3).metadata()
    assert (said["IMAGERY_DATE"], said["EFFECTIVE_GSD_M_PER_PX"]) == ("2024-06-21", "0.3")
    assert "IMAGERY_DATE" not in DESCRIPTION.metadata()
