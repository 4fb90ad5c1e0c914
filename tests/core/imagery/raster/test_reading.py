"""What raster files may hold, what is refused and how, and files that break while they are used."""

from __future__ import annotations

import random
import re
import struct
import subprocess
import sys
import zipfile
from contextlib import closing, contextmanager

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.errors import Cancelled, InvalidInput, PartError, SourceError, TerrAInavError  # noqa: E402
from terrainav.core.geodesy.mercator import HALF_WORLD_M, PixelGrid  # noqa: E402
from terrainav.core.imagery.raster import reading  # noqa: E402
from terrainav.core.imagery.raster import source as raster_source  # noqa: E402
from terrainav.core.imagery.raster.reading import (  # noqa: E402
    GdalFile,
    RasterioFile,
)
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.imagery.source import Window  # noqa: E402

from tests.support import rasters  # noqa: E402
from tests.support.thinning import sampled  # noqa: E402

#: A raster of one tile that lies on the map's own grid, so that pixels come out as they are stored.
ZOOM, COLUMN, ROW, SIZE = 15, 17_240, 11_380, 64
TILE = Window(ZOOM, COLUMN * 256, ROW * 256, SIZE, SIZE)
SIZE_M = PixelGrid().pixel_size(ZOOM)[0]
ON_GRID = (
    -HALF_WORLD_M + COLUMN * 256 * SIZE_M,
    SIZE_M,
    0.0,
    HALF_WORLD_M - ROW * 256 * SIZE_M,
    0.0,
    -SIZE_M,
)
NAMES = {
    "gray": gdal.GCI_GrayIndex,
    "red": gdal.GCI_RedBand,
    "green": gdal.GCI_GreenBand,
    "blue": gdal.GCI_BlueBand,
    "alpha": gdal.GCI_AlphaBand,
    "undefined": gdal.GCI_Undefined,
}


@pytest.fixture
def values():
    return np.random.default_rng(4).integers(1, 255, (4, SIZE, SIZE), np.uint8)


def fetched(path, window=TILE, **options):
    source = open_raster(path, **options)
    try:
        return source.fetch("", window)
    finally:
        source.close()


def colours(*names):
    return tuple(NAMES[name] for name in names)


@pytest.mark.parametrize(
    ("names", "shown"),
    [
        ("red green blue", (0, 1, 2)),
        ("blue green red", (2, 1, 0)),
        ("undefined blue green red", (3, 2, 1)),
        # Near infrared as a fourth band is not alpha, and bands of which nothing is said are red, green, blue.
        ("red green blue undefined", (0, 1, 2)),
        ("gray undefined undefined undefined", (0, 1, 2)),
        ("undefined undefined undefined", (0, 1, 2)),
        ("gray", (0, 0, 0)),
        ("undefined", (0, 0, 0)),
        ("gray undefined", (0, 0, 0)),
    ],
)
def test_bands_are_what_the_file_says(names, shown, values, tmp_path, library):
    kinds = names.split()
    path = rasters.write(
        tmp_path / "r.tif",
        values[: len(kinds)],
        ON_GRID,
        3857,
        colours=colours(*kinds),
        options=("ALPHA=NO",),
    )
    pixels = fetched(path)
    assert np.array_equal(pixels, np.moveaxis(values[list(shown)], 0, 2))


@pytest.mark.parametrize("kinds", ["red green blue alpha", "gray alpha"])
def test_alpha_is_no_imagery_where_it_is_0_and_lies_over_white_where_it_is_less_than_full(
    kinds, values, tmp_path, library
):
    bands = values[: len(kinds.split())].copy()
    bands[-1] = 255
    bands[-1, :20] = 0
    bands[-1, 20:30] = 51
    pixels = fetched(rasters.write(tmp_path / "r.tif", bands, ON_GRID, 3857, colours=colours(*kinds.split())))
    assert np.array_equal(pixels[..., 3], np.where(bands[-1] == 0, 0, 255))
    assert not pixels[:20].any()
    red = bands[0].astype(float)
    assert np.array_equal(pixels[30:, :, 0], bands[0, 30:])
    assert np.abs(pixels[20:30, :, 0] - (0.2 * red[20:30] + 0.8 * 255.0)).max() <= 0.5


def test_no_data_is_where_every_band_says_so_and_never_mixes_with_colours(values, tmp_path, library):
    bands = values[:3].copy()
    bands[:, 10:20, 30:50] = 0
    # A pond without red is no hole.
    bands[0, 40:50] = 0
    path = rasters.write(tmp_path / "r.tif", bands, ON_GRID, 3857, nodata=0)
    pixels = fetched(path)
    hole = (bands == 0).all(0)
    assert np.array_equal(pixels[..., 3] == 0, hole)
    assert np.array_equal(pixels[~hole][:, :3], np.moveaxis(bands, 0, 2)[~hole])
    # Shrunk and enlarged, what has a part of the hole is a hole.
    bright = np.where(hole, 0, 222)[np.newaxis].repeat(3, 0)
    path = rasters.write(tmp_path / "bright.tif", bright, ON_GRID, 3857, nodata=0)
    for zoom in (ZOOM - 1, ZOOM - 2, ZOOM + 1):
        factor = 2.0 ** (zoom - ZOOM)
        window = Window(zoom, TILE.left_px * factor, TILE.top_px * factor, int(SIZE * factor), int(SIZE * factor))
        pixels = fetched(path, window)
        there = pixels[..., 3] == 255
        assert (pixels[there][:, :3] == 222).all()
        assert not pixels[~there].any()
        if factor < 1.0:
            block = round(1.0 / factor)
            full = ~hole.reshape(SIZE // block, block, SIZE // block, block).any((1, 3))
            assert np.array_equal(there, full)
        else:
            assert not there[20:40, 60:100].any()
            assert there[2:18, 2:126].all()


def test_masks_of_the_file_are_obeyed(values, tmp_path, library):
    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    dataset = gdal.Open(str(path), gdal.GA_Update)
    dataset.CreateMaskBand(gdal.GMF_PER_DATASET)
    mask = np.full((SIZE, SIZE), 255, np.uint8)
    mask[5:25, 7:17] = 0
    dataset.GetRasterBand(1).GetMaskBand().WriteArray(mask)
    del dataset
    assert np.array_equal(fetched(path)[..., 3], mask)


def test_palettes_become_colours(tmp_path, library):
    indices = np.random.default_rng(1).integers(0, 4, (1, SIZE, SIZE), np.uint8)
    path = tmp_path / "r.tif"
    system = gdal.Open(str(rasters.write(tmp_path / "plain.tif", indices, ON_GRID, 3857))).GetProjection()
    table = [(200, 10, 30), (0, 0, 255), (9, 99, 199), (255, 255, 0)]
    made = gdal.GetDriverByName("GTiff").Create(str(path), SIZE, SIZE, 1, gdal.GDT_Byte)
    made.SetGeoTransform(ON_GRID)
    made.SetProjection(system)
    colour_table = gdal.ColorTable()
    for index, colour in enumerate(table):
        colour_table.SetColorEntry(index, (*colour, 255))
    made.GetRasterBand(1).SetColorTable(colour_table)
    made.GetRasterBand(1).WriteArray(indices[0])
    made.GetRasterBand(1).SetNoDataValue(3)
    del made
    pixels = fetched(path)
    expected = np.array(table, np.uint8)[indices[0]]
    hole = indices[0] == 3
    assert np.array_equal(pixels[..., 3] == 0, hole)
    assert np.array_equal(pixels[~hole][:, :3], expected[~hole])
    # Averages are of colours, not of their numbers.
    small = fetched(path, Window(ZOOM - 1, TILE.left_px // 2, TILE.top_px // 2, SIZE // 2, SIZE // 2))
    blocks = expected.reshape(SIZE // 2, 2, SIZE // 2, 2, 3).astype(float).mean((1, 3))
    whole = ~hole.reshape(SIZE // 2, 2, SIZE // 2, 2).any((1, 3))
    assert whole.any()
    assert np.abs(small[..., :3] - blocks)[whole].max() <= 0.5


def test_fewer_bits_than_8_reach_from_black_to_white(tmp_path, library):
    values = np.random.default_rng(1).integers(0, 4, (1, SIZE, SIZE), np.uint8)
    path = rasters.write(tmp_path / "r.tif", values, ON_GRID, 3857, options=("NBITS=2",))
    assert np.array_equal(fetched(path)[..., 1], values[0] * 85)


def test_vrt_and_gdal_s_virtual_files_are_rasters_too(values, tmp_path, library):
    plain = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    gdal.BuildVRT(str(tmp_path / "r.vrt"), [str(plain)]).FlushCache()
    expected = np.moveaxis(values[:3], 0, 2)
    assert np.array_equal(fetched(tmp_path / "r.vrt"), expected)
    assert np.array_equal(fetched(f"/vsisubfile/0_{plain.stat().st_size},{plain}"), expected)


@pytest.mark.parametrize(
    ("tags", "attribution", "date"),
    [
        ({}, "r.tif", ""),
        ({"TIFFTAG_COPYRIGHT": " Survey of\nNowhere ", "TIFFTAG_ARTIST": "A"}, "Survey of Nowhere", ""),
        ({"TIFFTAG_ARTIST": "An aerial company"}, "An aerial company", ""),
        ({"TIFFTAG_DATETIME": "2020:08:31 10:11:12"}, "r.tif", "2020-08-31"),
        ({"TIFFTAG_DATETIME": "0000:00:00 00:00:00"}, "r.tif", ""),
        ({"TIFFTAG_DATETIME": "yesterday"}, "r.tif", ""),
    ],
)
def test_what_a_source_says_of_itself(tags, attribution, date, values, tmp_path, library):
    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857, tags=tags)
    source = open_raster(str(path))
    assert (source.name, source.title) == (str(path), "r.tif")
    assert (source.attribution, source.date) == (attribution, date)
    assert source.map_types == ()
    assert source.policy.bulk_allowed == "yes"
    source.close()
    source = open_raster(path, date="20190102")
    assert source.date == "2019-01-02"
    source.close()


def refused(path, **options):
    with pytest.raises(InvalidInput) as caught:
        open_raster(path, **options)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    return message


def test_files_that_are_no_rasters_are_refused_in_one_line(tmp_path, library):
    assert "no such file" in refused(tmp_path / "missing.tif")
    assert "is a folder" in refused(tmp_path)
    for name, content in (("empty.tif", b""), ("text.tif", b"a,b\n1,2\n"), ("cut.tif", b"II*\0\x08\0\0\0")):
        (tmp_path / name).write_bytes(content)
        assert "not a readable raster" in refused(tmp_path / name)


def test_rasters_without_a_place_on_the_map_are_refused_in_one_line(values, tmp_path, library):
    def path(name, *args, **options):
        return rasters.write(tmp_path / f"{name}.tif", values[:3], *args, **options)

    assert "no coordinate reference system" in refused(path("no-crs", ON_GRID, None))
    assert "no geotransform" in refused(path("nothing", None, None))
    assert "no geotransform" in refused(path("crs-alone", None, 3857))
    local = 'LOCAL_CS["site",UNIT["metre",1],AXIS["Easting",EAST],AXIS["Northing",NORTH]]'
    assert "site, is not one of maps" in refused(path("local", ON_GRID, local))
    assert "is not one of maps" in refused(path("geocentric", ON_GRID, 4978))
    assert "does not lie on the Web-Mercator map" in refused(path("pole", (0.0, 1e-3, 0.0, 90.0, 0.0, -1e-3), 4326))
    one_pixel = rasters.write(tmp_path / "world.tif", values[:3, :1, :1], (-180.0, 360.0, 0.0, 10.0, 0.0, -20.0), 4326)
    assert "its pixels are as wide as the whole map" in refused(one_pixel)
    assert "its centre lies beyond what WGS 84 / Pseudo-Mercator reaches" in refused(
        path("huge", (0.0, 1e300, 0.0, 0.0, 0.0, -1e300), 3857)
    )
    for place in (1, 5):
        steps = list(ON_GRID)
        steps[place] = 1e-300
        assert "places no pixel" in refused(path(f"lost-{place}", tuple(steps), 3857))
    by_points = gdal.Open(str(path("points", None, None)), gdal.GA_Update)
    corners = [gdal.GCP(9.0 + x / 1e3, 48.0 - y / 1e3, 0.0, x, y) for x in (0, 64) for y in (0, 64)]
    system = gdal.Open(str(path("other", ON_GRID, 4326))).GetProjection()
    by_points.SetGCPs(corners, system)
    del by_points
    assert "ground control points" in refused(tmp_path / "points.tif")


def test_what_is_no_picture_of_8_bits_is_refused_and_never_stretched(values, tmp_path, library):
    for data_type, name in ((gdal.GDT_UInt16, "uint16"), (gdal.GDT_Float32, "float32")):
        path = rasters.write(tmp_path / f"{name}.tif", values[:3], ON_GRID, 3857, data_type=data_type)
        message = refused(path)
        assert name in message
        assert message.endswith(
            "choose how they become 8 bits (--stretch), such as percentile, or write GeoTIFF (--format)"
        )
    for kinds, words in (
        ("Undefined Undefined", "(undefined, undefined) are neither a grey one nor red, green and blue"),
        ("Cyan Magenta Yellow", "cyan, magenta, yellow, and not red, green, blue or grey"),
    ):
        path = tmp_path / f"{kinds}.vrt"
        plain = rasters.write(tmp_path / "plain.tif", values[: len(kinds.split())], ON_GRID, 3857)
        gdal.Translate(str(path), str(plain), format="VRT").FlushCache()
        bands = re.sub("<ColorInterp>.*</ColorInterp>", "", path.read_text()).split("</VRTRasterBand>")
        stated = [f"{band}<ColorInterp>{kind}</ColorInterp>" for band, kind in zip(bands, kinds.split())]
        path.write_text("</VRTRasterBand>".join([*stated, bands[-1]]))
        assert words in refused(path)


def test_files_of_several_dates_are_one_path(values, tmp_path, library):
    for i, name in enumerate(("20090818", "20140720", "2020-08-31")):
        rasters.write(tmp_path / f"naip_{name}.tif", np.full((3, SIZE, SIZE), 50 * (i + 1)), ON_GRID, 3857)
    (tmp_path / "naip_old.tif").write_bytes(b"")
    pattern = tmp_path / "naip_{date}.tif"
    for date, shade in (("2014-07-20", 100), ("20140720", 100), ("20200831", 150)):
        source = open_raster(pattern, date=date)
        assert source.name == str(pattern)
        assert source.title == f"naip_{'2020-08-31' if shade == 150 else '20140720'}.tif"
        assert source.date == ("2020-08-31" if shade == 150 else "2014-07-20")
        assert (source.fetch("", TILE) == shade).all()
        source.close()
    there = "2009-08-18, 2014-07-20, 2020-08-31"
    assert refused(pattern, date="2015-01-01").endswith(f"there is none of 2015-01-01; dates there are: {there}")
    assert refused(pattern).endswith(f"say which date; dates there are: {there}")
    for wrong in ("2014-13-01", "someday", "20", "2014-7-2"):
        with pytest.raises(InvalidInput, match="must be YYYY-MM-DD"):
            open_raster(pattern, date=wrong)


def test_a_date_may_be_in_a_folder_s_name_as_well(values, tmp_path, library):
    for year in ("2009", "2014"):
        (tmp_path / year).mkdir()
        rasters.write(tmp_path / year / f"ortho_{year}.tif", values[:3], ON_GRID, 3857)
    rasters.write(tmp_path / "2009" / "ortho_2014.tif", values[:3], ON_GRID, 3857)
    source = open_raster(tmp_path / "{date}" / "ortho_{date}.tif", date="2014")
    assert (source.date, source.title) == ("2014", "ortho_2014.tif")
    source.close()
    assert "dates there are: 2009, 2014" in refused(tmp_path / "{date}" / "ortho_{date}.tif", date="2015")


def test_a_broken_file_fails_the_parts_that_are_broken_and_no_other(tmp_path, library):
    values = np.random.default_rng(3).integers(0, 256, (3, 512, 512), np.uint8)
    path = rasters.write(
        tmp_path / "r.tif",
        values,
        ON_GRID,
        3857,
        options=("TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256", "COMPRESS=DEFLATE"),
    )
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) * 3 // 5])
    source = open_raster(path)
    windows = [Window(ZOOM, TILE.left_px + 256 * i, TILE.top_px + 256 * j, 256, 256) for j in (0, 1) for i in (0, 1)]
    assert np.array_equal(source.fetch("", windows[0]), np.moveaxis(values[:, :256, :256], 0, 2))
    with pytest.raises(PartError, match=r"r\.tif: cannot be read here: ") as caught:
        source.fetch("", windows[3])
    assert "\n" not in str(caught.value)
    # The next part has a handle of its own again.
    assert source.fetch("", windows[0]).shape == (256, 256, 3)
    source.close()


def test_a_second_directory_of_nonsense_is_refused_in_one_line_or_not_read(values, tmp_path, library):
    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    body = bytearray(path.read_bytes())
    (first,) = struct.unpack_from("<I", body, 4)
    (entries,) = struct.unpack_from("<H", body, first)
    struct.pack_into("<I", body, first + 2 + 12 * entries, len(body))
    # Three values of the tag TileDepth, which has one.
    path.write_bytes(body + struct.pack("<HHHIII", 1, 32998, 3, 3, 0, 0))
    with one_line_at_most():
        open_raster(path).close()


@contextmanager
def one_line_at_most():
    """Let errors of TerrAInav pass whose text is one line."""
    try:
        yield
    except TerrAInavError as wrong:
        if "\n" in str(wrong):
            raise


@pytest.mark.parametrize("compression", sampled(["NONE", "DEFLATE", "LZW", "JPEG"], 4))
@pytest.mark.parametrize("tiled", ["YES", "NO"])
@pytest.mark.parametrize("cases", [24, pytest.param(240, marks=pytest.mark.thorough)])
def test_files_that_are_broken_anywhere_are_read_or_refused_in_one_line(
    values, tmp_path, library, compression, tiled, cases
):
    options = (f"COMPRESS={compression}", f"TILED={tiled}")
    whole = rasters.write(tmp_path / "whole.tif", values[:3], ON_GRID, 3857, options=options).read_bytes()
    choose = random.Random(15)
    path = tmp_path / "r.tif"
    for case in range(cases):
        broken = bytearray(whole[: choose.randrange(len(whole))] if case % 4 == 0 else whole)
        for _ in range(choose.choice([1, 3, 10]) if case % 4 else 0):
            broken[choose.randrange(choose.choice([16, 600, len(whole)]))] = choose.randrange(256)
        path.write_bytes(broken)
        with one_line_at_most():
            source = open_raster(path)
            with closing(source):
                source.fetch("", TILE._replace(zoom=source.grid.native_zoom))


def test_a_jpeg_that_is_broken_off_is_not_filled_with_grey(tmp_path, library):
    values = np.random.default_rng(3).integers(0, 256, (3, 256, 256), np.uint8)
    plain = rasters.write(tmp_path / "r.tif", values, ON_GRID, 3857)
    gdal.Translate(str(tmp_path / "r.jpg"), str(plain), format="JPEG")
    path = tmp_path / "r.jpg"
    path.write_bytes(path.read_bytes()[:-9000])
    source = open_raster(path)
    with pytest.raises(PartError, match="cannot be read here"):
        source.fetch("", TILE._replace(width_px=256, height_px=256))
    source.close()


def test_a_file_that_is_gone_or_changes_stops_the_run(values, tmp_path, library):
    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    source = open_raster(path)
    source.fetch("", TILE)
    path.rename(tmp_path / "kept.tif")
    with pytest.raises(SourceError, match=r"r\.tif: is gone"):
        source.fetch("", TILE)
    rasters.write(path, values[1:4, :32], ON_GRID, 3857)
    with pytest.raises(SourceError, match="has changed since it was opened"):
        source.fetch("", TILE)
    source.close()


def test_a_closed_source_says_so_and_holds_no_file(values, tmp_path, library):
    opened = []

    def spying(path, level, drivers):
        file = {"gdal": GdalFile, "rasterio": RasterioFile}[library](path, level, drivers)
        opened.append(file)
        return file

    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(raster_source, "opener", lambda: spying)
        source = open_raster(path)
    for _ in range(3):
        source.fetch("", TILE)
    assert len(opened) == 1
    source.close()
    with pytest.raises(Cancelled):
        source.fetch("", TILE)
    handle = opened[0]._dataset
    assert handle is None or handle.closed


def test_zooms_it_does_not_serve_are_refused(values, tmp_path, library):
    source = open_raster(rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857))
    assert (source.grid.min_zoom, source.grid.native_zoom, source.grid.max_zoom) == (0, ZOOM, 22)
    with pytest.raises(InvalidInput, match=r"zoom 23: r\.tif has 0 to 22"):
        source.fetch("", TILE._replace(zoom=23))
    source.close()


def test_a_huge_raster_without_overviews_serves_only_what_can_be_read(tmp_path, library):
    size = 100_000
    path = tmp_path / "huge.tif"
    options = ["SPARSE_OK=TRUE", "TILED=YES", "COMPRESS=DEFLATE"]
    made = gdal.GetDriverByName("GTiff").Create(str(path), size, size, 3, gdal.GDT_Byte, options=options)
    made.SetGeoTransform(ON_GRID)
    made.SetProjection(
        gdal.Open(str(rasters.write(tmp_path / "r.tif", np.zeros((3, 4, 4)), ON_GRID, 3857))).GetProjection()
    )
    del made
    source = open_raster(path)
    assert (source.grid.min_zoom, source.grid.native_zoom) == (ZOOM - 3, ZOOM)
    down = Window(ZOOM - 3, TILE.left_px // 8, TILE.top_px // 8, 256, 256)
    assert source.fetch("", down).shape == (256, 256, 3)
    source.close()


HEADLESS = """
import sys
{before}
from terrainav.core.imagery.raster.source import open_raster
from terrainav.core.imagery.source import Window
source = open_raster({path!r})
print(source.fetch("", Window({zoom}, {left}, {top}, 8, 8)).shape, *({{"rasterio", "osgeo"}} & sys.modules.keys()))
"""


@pytest.mark.parametrize(
    ("before", "used"),
    sampled(
        [
            ("", "rasterio"),
            ("sys.modules['osgeo'] = None; del sys.modules['osgeo']", "rasterio"),
            ("sys.modules['qgis'] = sys", "osgeo"),
            ("import osgeo.gdal", "osgeo"),
        ],
        2,
    ),
)
def test_rasterio_is_for_where_neither_qgis_nor_gdal_s_bindings_are_loaded(before, used, values, tmp_path):
    pytest.importorskip("rasterio", reason="rasterio is the extra `raster`")
    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    code = HEADLESS.format(before=before, path=str(path), zoom=ZOOM, left=TILE.left_px, top=TILE.top_px)
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert (result.stdout.strip(), result.stderr) == (f"(8, 8, 3) {used}", "")


def test_without_either_library_the_way_to_one_is_named(values, tmp_path):
    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    code = (
        "import importlib.util as u; f = u.find_spec\n"
        "u.find_spec = lambda name, *rest: None if name in ('rasterio', 'osgeo') else f(name, *rest)\n"
        "from terrainav.core.imagery.raster.source import open_raster\n"
        f"try: open_raster({str(path)!r})\nexcept ValueError as wrong: print(wrong)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert result.stdout.strip() == "raster files need rasterio: pip install terrainav[raster]"


def test_keys_of_s3_in_the_environment_cost_a_tile_nothing(values, tmp_path, library, monkeypatch):
    boto3 = pytest.importorskip("boto3", reason="needs boto3")
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "key")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
    sessions = []
    monkeypatch.setattr(boto3.Session, "__init__", lambda self, **_: sessions.append(self))
    path = rasters.write(tmp_path / "r.tif", values[:3], ON_GRID, 3857)
    assert np.array_equal(fetched(path), np.moveaxis(values[:3], 0, 2))
    assert not sessions


def test_options_to_check_a_file_have_ended_when_it_is_opened(tmp_path, monkeypatch):
    """Only the bytes of the file may be read through a VRT of raw bytes, of the raster and of its overviews."""
    rasterio = pytest.importorskip("rasterio")
    from rasterio.env import get_gdal_config

    path = rasters.write(tmp_path / "r.tif", np.zeros((1, 600, 600), np.uint8), ON_GRID, 3857)
    gdal.Open(str(path), gdal.GA_Update).BuildOverviews("NEAREST", [2])
    with zipfile.ZipFile(tmp_path / "r.zip", "w") as packed:
        packed.write(path, "r.tif")
    name, allowed = f"/vsizip/{tmp_path / 'r.zip'}/r.tif", []
    reader = rasterio.DatasetReader

    def opened(path, **options):
        allowed.append((path == name, get_gdal_config("GDAL_VRT_RAWRASTERBAND_ALLOWED_SOURCE")))
        return reader(path, **options)

    monkeypatch.setattr(rasterio, "DatasetReader", opened)
    pool = reading.Pool(RasterioFile, name)
    with pool.lent(0) as file:
        assert len(file.facts().sizes) == 2
        file.read([1], reading.PixelBox(0, 0, 9, 9))
    pool.close()
    assert allowed == [(False, "ALL"), (True, None)] * 2
