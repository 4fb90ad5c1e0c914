"""Raster files as a source: every pixel where it belongs, whatever the coordinate reference system."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pyproj
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.capture.runner import capture  # noqa: E402
from terrainav.core.geodesy.mercator import HALF_WORLD_M, PixelGrid  # noqa: E402
from terrainav.core.imagery.raster import source as raster_source  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster as open_any  # noqa: E402
from terrainav.core.imagery.source import Window  # noqa: E402
from terrainav.core.mission.areas.area import Box  # noqa: E402
from terrainav.core.mission.mission import Mission  # noqa: E402
from terrainav.core.mission.plan import plan  # noqa: E402
from terrainav.core.picture.map_frame import assemble  # noqa: E402

from tests.support import rasters  # noqa: E402
from tests.support.thinning import sampled  # noqa: E402

#: These are about rasters as pixels of the map; `test_own_pixels` is about their own.
open_raster = partial(open_any, own_pixels=False)
# Beside a checkout, never inside it: USDA NAIP photographs of North Dakota on three dates, 5 m pixels, EPSG:26914.
PHOTOGRAPHS = Path(__file__).resolve().parents[5] / "shared" / "data" / "naip"
INSIDE_PHOTOGRAPHS = Box(47.028, -99.174, 47.012, -99.136)

#: UTM 32, about 48° N, 9.1° E; 2 m pixels.
UTM = (505_000.0, 2.0, 0.0, 5_317_000.0, 0.0, -2.0)
UTM_EPSG = 32632
SIZE = 600


def on_map(epsg, x, y):
    """Oracle of its own: through geographic coordinates and the sphere's formula, not by EPSG:3857."""
    lon, lat = pyproj.Transformer.from_crs(epsg, 4326, always_xy=True).transform(x, y)
    radius = HALF_WORLD_M / math.pi
    return np.radians(lon) * radius, np.arctanh(np.sin(np.radians(lat))) * radius


def off_map(epsg, x, y):
    radius = HALF_WORLD_M / math.pi
    lon, lat = np.degrees(x / radius), np.degrees(np.arctan(np.sinh(y / radius)))
    return pyproj.Transformer.from_crs(4326, epsg, always_xy=True).transform(lon, lat)


def map_centres(window, grid):
    """Map coordinates (h, w) of a window's pixels."""
    west, _, _, north = grid.edges(*window[1:], window.zoom)
    size = grid.pixel_size(window.zoom)[0]
    return np.meshgrid(
        west + (np.arange(window.width_px) + 0.5) * size, north - (np.arange(window.height_px) + 0.5) * size
    )


def window_about(source, epsg, x, y, zoom, size=256):
    map_x, map_y = on_map(epsg, x, y)
    size_m = source.grid.pixel_size(zoom)[0]
    left, top = (map_x + HALF_WORLD_M) / size_m, (HALF_WORLD_M - map_y) / size_m
    return Window(zoom, round(float(left)) - size // 2, round(float(top)) - size // 2, size, size)


def picture_of(source, window):
    parts = source.parts(window)
    return assemble(window, parts, {part.window: source.fetch("", part.window) for part in parts})


def assert_shows_its_position(pixels, x_px, y_px, most_px, reach_px):
    """Colours of `position_colours` must be those of positions in px; compared in px, turns of the waves left out."""
    errors = []
    for channel, position in enumerate((x_px, y_px)):
        wrong = (pixels[..., channel] - rasters.triangle(position)) / 4.0
        kept = ~rasters.turns(position, reach_px)
        assert kept.mean() > 0.5
        errors.append(np.abs(wrong[kept]))
        # The sign of the wave's slope turns a shift into errors of both signs, so the mean of |error| is not enough.
        falling = np.mod(position / rasters.RAMP_PERIOD, 1.0) > 0.5
        assert abs(np.where(falling, -wrong, wrong)[kept].mean()) < 0.02
    assert max(float(error.max()) for error in errors) <= most_px


@pytest.mark.parametrize(
    ("epsg", "geotransform"),
    sampled(
        [
            (UTM_EPSG, UTM),
            (2056, (2_600_000.0, 2.0, 0.0, 1_200_000.0, 0.0, -2.0)),
            (4326, (9.0, 3e-5, 0.0, 48.0, 0.0, -2e-5)),
            pytest.param(3035, (4_300_000.0, 2.0, 0.0, 2_800_000.0, 0.0, -2.0), marks=pytest.mark.thorough),
            # Turned by 30°, and one that counts its rows from the south.
            (UTM_EPSG, (505_000.0, math.sqrt(3.0), 1.0, 5_317_000.0, 1.0, -math.sqrt(3.0))),
            (UTM_EPSG, (505_000.0, 2.0, 0.0, 5_316_000.0, 0.0, 2.0)),
            # The map's own system, off its grid.
            pytest.param(3857, (1_013_000.3, 2.1, 0.0, 6_106_000.7, 0.0, -2.1), marks=pytest.mark.thorough),
            (3857, (1_013_000.3, 2.1, 0.5, 6_106_000.7, 0.5, -2.1)),
        ],
        3,
    ),
    ids=["utm", "lv95", "geographic", "laea", "turned", "south-up", "map", "map-turned"],
)
def test_pixels_lie_where_an_independent_transformation_puts_them(epsg, geotransform, tmp_path):
    columns, rows = np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5)
    path = rasters.write(tmp_path / "r.tif", rasters.position_colours(columns, rows), geotransform, epsg)
    source = open_raster(path)
    assert source.is_warped == (epsg != 3857)
    x0, xc, xr, y0, yc, yr = geotransform
    centre = x0 + (xc + xr) * SIZE / 2, y0 + (yc + yr) * SIZE / 2
    for zoom in (source.grid.native_zoom, source.grid.native_zoom + 1, source.grid.native_zoom - 1):
        window = window_about(source, epsg, *centre, zoom, 128 if zoom < source.grid.native_zoom else 200)
        pixels = picture_of(source, window).astype(float)
        x, y = off_map(epsg, *map_centres(window, source.grid))
        to_pixels = np.linalg.inv([[xc, xr], [yc, yr]])
        column, row = np.tensordot(to_pixels, np.stack([x - x0, y - y0]), 1)
        reach = 4.0 if zoom < source.grid.native_zoom else 2.5
        assert_shows_its_position(pixels, column, row, 0.3, reach)
    source.close()


def test_captured_files_state_where_their_pixels_lie(tmp_path):
    columns, rows = np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5)
    path = rasters.write(tmp_path / "r.tif", rasters.position_colours(columns, rows), UTM, UTM_EPSG)
    source = open_raster(path, date="2020")
    to_lonlat = pyproj.Transformer.from_crs(UTM_EPSG, 4326, always_xy=True)
    lon, lat = to_lonlat.transform(*(UTM[0] + SIZE, UTM[3] - SIZE))
    area = Box(lat + 0.0016, lon - 0.003, lat - 0.0016, lon + 0.003)
    worked_out = plan(Mission(area, 150.0, source=str(path)), source.grid)
    result = capture(worked_out, source, tmp_path / "out")
    source.close()
    assert result.written == len(worked_out) > 3
    assert not result.failed
    assert worked_out.zoom == source.grid.native_zoom
    windows = worked_out.windows
    edges = source.grid.edges(*windows, worked_out.zoom)
    to_utm = pyproj.Transformer.from_crs(3857, UTM_EPSG, always_xy=True)
    seen = []
    for index, name in enumerate(worked_out.names):
        picture = gdal.Open(str(next((tmp_path / "out" / "satellite").glob(f"{name}*.tif"))))
        assert picture.GetSpatialRef().GetAuthorityCode(None) == "3857"
        west, size_x, _, north, _, size_y = picture.GetGeoTransform()
        assert west == pytest.approx(edges[0][index], abs=1e-9 * abs(size_x) + 1e-8)
        assert north == pytest.approx(edges[3][index], abs=1e-8)
        assert west + size_x * picture.RasterXSize == pytest.approx(edges[2][index], abs=1e-8)
        assert north + size_y * picture.RasterYSize == pytest.approx(edges[1][index], abs=1e-8)
        map_x, map_y = rasters.centres(picture.GetGeoTransform(), picture.RasterXSize, picture.RasterYSize)
        x, y = to_utm.transform(map_x, map_y)
        pixels = np.moveaxis(picture.ReadAsArray().astype(float), 0, 2)
        seen.append((pixels.reshape(-1, 3), ((x - UTM[0]) / 2.0).ravel(), ((UTM[3] - y) / 2.0).ravel()))
    assert_shows_its_position(*(np.concatenate(values) for values in zip(*seen)), 0.3, 2.5)


@pytest.mark.parametrize("zoom", [3, 14, 19, 22])
def test_pixels_on_the_map_s_own_grid_are_copied_and_their_overviews_averaged(zoom, tmp_path):
    grid = PixelGrid()
    size = grid.pixel_size(zoom)[0]
    left, top = (
        (grid.world_px(zoom) * 17 // 32) // 256 * 256 - 64,
        (grid.world_px(zoom) * 11 // 32) // 256 * 256 - 32,
    )
    values = np.random.default_rng(zoom).integers(0, 256, (3, 512, 512), np.uint8)
    geotransform = (-HALF_WORLD_M + left * size, size, 0.0, HALF_WORLD_M - top * size, 0.0, -size)
    source = open_raster(rasters.write(tmp_path / "r.tif", values, geotransform, 3857))
    assert not source.is_warped
    assert source.grid.native_zoom == zoom
    assert np.array_equal(picture_of(source, Window(zoom, left, top, 512, 512)), np.moveaxis(values, 0, 2))
    for down in (1, 2):
        block = 1 << down
        pixels = picture_of(source, Window(zoom - down, left // block, top // block, 512 // block, 512 // block))
        means = values.reshape(3, 512 // block, block, 512 // block, block).mean((2, 4))
        assert np.abs(pixels - np.moveaxis(means, 0, 2)).max() <= 0.5
    source.close()


def test_a_cog_in_google_s_tiling_scheme_is_copied(tmp_path, library):
    values = np.random.default_rng(5).integers(1, 256, (3, SIZE, SIZE), np.uint8)
    plain = rasters.write(tmp_path / "r.tif", values, UTM, UTM_EPSG)
    cog = tmp_path / "cog.tif"
    options = ["TILING_SCHEME=GoogleMapsCompatible", "COMPRESS=DEFLATE"]
    gdal.Translate(str(cog), str(plain), format="COG", creationOptions=options)
    stored = gdal.Open(str(cog))
    west, size, _, north, _, _ = stored.GetGeoTransform()
    source = open_raster(cog)
    zoom = source.grid.native_zoom
    assert source.grid.pixel_size(zoom)[0] == pytest.approx(size, rel=1e-9)
    left, top = round((west + HALF_WORLD_M) / size), round((HALF_WORLD_M - north) / size)
    window = Window(zoom, left + 256, top + 256, 256, 256)
    alpha = stored.GetRasterBand(1).GetMaskBand().ReadAsArray(256, 256, 256, 256)
    expected = np.moveaxis(stored.ReadAsArray(256, 256, 256, 256)[:3], 0, 2)
    pixels = source.fetch("", window)
    there = np.ones((256, 256), bool) if pixels.shape[2] == 3 else pixels[..., 3] == 255
    assert np.array_equal(there, alpha == 255)
    assert np.array_equal(pixels[there][:, :3], expected[there])
    source.close()


def test_enlarged_it_is_gdal_s_bilinear(tmp_path):
    values = np.random.default_rng(2).integers(0, 256, (3, 120, 120), np.uint8)
    path = rasters.write(tmp_path / "r.tif", values, UTM, UTM_EPSG)
    source = open_raster(path)
    zoom = source.grid.native_zoom + 2
    window = window_about(source, UTM_EPSG, UTM[0] + 120.0, UTM[3] - 120.0, zoom, 128)
    edges = source.grid.edges(*window[1:], zoom)
    warped = gdal.Warp(
        "",
        str(path),
        format="MEM",
        dstSRS="EPSG:3857",
        outputBounds=edges,
        width=128,
        height=128,
        resampleAlg="bilinear",
        errorThreshold=0,
    )
    difference = picture_of(source, window).astype(int) - np.moveaxis(warped.ReadAsArray().astype(int), 0, 2)
    assert np.abs(difference).max() <= 1
    source.close()


@pytest.mark.parametrize(
    ("epsg", "geotransform"),
    [
        (UTM_EPSG, UTM),
        (UTM_EPSG, (505_000.0, 0.25, 0.0, 5_317_000.0, 0.0, -0.5)),
        (4326, (9.0, 1e-4, 0.0, 60.0, 0.0, -1e-4)),
        (3413, (-500_000.0, 30.0, 0.0, -1_500_000.0, 0.0, -30.0)),
        (3857, (1_013_000.0, 156543.0339280410 / 2**18, 0.0, 6_106_000.0, 0.0, -156543.0339280410 / 2**18)),
        (3857, (1_013_000.0, 0.6, 0.0, 6_106_000.0, 0.0, -0.6)),
    ],
)
def test_native_zoom_is_the_highest_that_does_not_enlarge(epsg, geotransform, tmp_path):
    path = rasters.write(tmp_path / "r.tif", np.zeros((3, 64, 64)), geotransform, epsg)
    source = open_raster(path)
    x0, xc, _, y0, _, yr = geotransform
    map_x, map_y = on_map(epsg, x0 + 32 * xc, y0 + 32 * yr)

    def raster_px_per_px(zoom):
        """Steps of columns and rows over one pixel of the map at the raster's centre."""
        size = source.grid.pixel_size(zoom)[0]
        x, y = off_map(epsg, map_x + np.array([-0.5, 0.5, 0, 0]) * size, map_y + np.array([0, 0, -0.5, 0.5]) * size)
        return [math.hypot(v[1] - v[0], v[3] - v[2]) / abs(step) for v, step in ((x, xc), (y, yr))]

    assert min(raster_px_per_px(source.grid.native_zoom)) >= 1.0 - 1e-3
    assert min(raster_px_per_px(source.grid.native_zoom + 1)) < 1.0
    source.close()


def test_across_the_antimeridian(tmp_path):
    step = 0.01
    geographic = (170.0, step, 0.0, 10.0, 0.0, -step)
    columns, rows = np.meshgrid(np.arange(2000) + 0.5, np.arange(400) + 0.5)
    colours = rasters.position_colours(columns, rows)
    on_the_map = (HALF_WORLD_M - 200_000.0, 1000.0, 0.0, 1_000_000.0, 0.0, -1000.0)
    for epsg, geotransform in ((4326, geographic), (3857, on_the_map)):
        source = open_raster(rasters.write(tmp_path / f"{epsg}.tif", colours, geotransform, epsg))
        zoom = source.grid.native_zoom
        world = source.grid.world_px(zoom)
        top = int((HALF_WORLD_M - 900_000.0) / source.grid.pixel_size(zoom)[0])
        window = Window(zoom, world - 60, top, 120, 100)
        pixels = picture_of(source, window).astype(float)
        x, y = map_centres(window, source.grid)
        if epsg == 4326:
            radius = HALF_WORLD_M / math.pi
            x, y = np.degrees(x / radius), np.degrees(np.arctan(np.sinh(y / radius)))
        column = (x - geotransform[0]) / geotransform[1]
        row = (y - geotransform[3]) / geotransform[5]
        assert_shows_its_position(pixels, column, row, 0.3, 3.0)
        source.close()


def test_beyond_the_edge_there_is_no_imagery(tmp_path):
    path = rasters.write(tmp_path / "r.tif", np.full((3, SIZE, SIZE), 200), UTM, UTM_EPSG)
    source = open_raster(path)
    zoom = source.grid.native_zoom
    window = window_about(source, UTM_EPSG, UTM[0], UTM[3], zoom)
    pixels = source.fetch("", window)
    x, y = off_map(UTM_EPSG, *map_centres(window, source.grid))
    column, row = (x - UTM[0]) / 2.0, (UTM[3] - y) / 2.0
    there = pixels[..., 3] == 255
    assert there[(column > 1.1) & (row > 1.1)].all()
    assert not there[(column < 0.45) | (row < 0.45)].any()
    # What is missing does not darken what is there.
    assert (pixels[there][:, :3] == 200).all()
    assert (pixels[~there] == 0).all()
    far = source.fetch("", Window(zoom, 0, 0, 256, 256))
    assert far.shape == (256, 256, 4)
    assert not far.any()
    source.close()


@pytest.mark.parametrize(("resampling", "most_px"), sampled([("NEAREST", 0.145), ("AVERAGE", 0.02)], 2))
def test_far_below_the_native_zoom_overviews_serve(resampling, most_px, tmp_path, library, monkeypatch):
    size, down = 2048, 4
    columns, rows = np.meshgrid(np.arange(size) + 0.5, np.arange(size) + 0.5)
    # Waves of the map's pixels, not of the raster's.
    colours = rasters.position_colours(columns / (1 << down), rows / (1 << down))
    path = rasters.write(tmp_path / "r.tif", colours, UTM, UTM_EPSG)
    dataset = gdal.Open(str(path), gdal.GA_Update)
    dataset.BuildOverviews(resampling, [2, 4, 8])
    del dataset
    source = open_raster(path)
    assert source.grid.min_zoom == 0
    window = window_about(source, UTM_EPSG, UTM[0] + size, UTM[3] - size, source.grid.native_zoom - down, 64)
    levels = []
    read = raster_source.RasterSource._read
    monkeypatch.setattr(
        raster_source.RasterSource, "_read", lambda self, *args: levels.append(args[0]) or read(self, *args)
    )
    pixels = source.fetch("", window).astype(float)
    assert levels == [2]
    x, y = off_map(UTM_EPSG, *map_centres(window, source.grid))
    step_m = 2.0 * (1 << down)
    for channel, position in enumerate(((x - UTM[0]) / step_m, (UTM[3] - y) / step_m)):
        kept = ~rasters.turns(position, 2.5)
        falling = np.mod(position / rasters.RAMP_PERIOD, 1.0) > 0.5
        wrong = (pixels[..., channel] - rasters.triangle(position)) / 4.0
        # In units of 16 px of the raster. The overview's pixels are 4 of them wide: left out, half of one is 0.125.
        assert abs(np.where(falling, -wrong, wrong)[kept].mean()) < most_px
    source.close()


def test_threads_get_what_one_alone_gets(tmp_path, library):
    columns, rows = np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5)
    path = rasters.write(
        tmp_path / "r.tif",
        rasters.position_colours(columns, rows),
        UTM,
        UTM_EPSG,
        options=("TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=64", "COMPRESS=DEFLATE"),
    )
    source = open_raster(path)
    zoom = source.grid.native_zoom
    window = window_about(source, UTM_EPSG, UTM[0] + SIZE, UTM[3] - SIZE, zoom, 64)
    windows = [
        window._replace(zoom=z, left_px=window.left_px + 20 * i, top_px=window.top_px - 20 * i)
        for z in (zoom, zoom)
        for i in range(-5, 6)
    ] + [window_about(source, UTM_EPSG, UTM[0] + SIZE, UTM[3] - SIZE, zoom - 2, 64)] * 3
    alone = [source.fetch("", each) for each in windows]
    with ThreadPoolExecutor(8) as threads:
        together = list(threads.map(lambda each: source.fetch("", each), windows * 4))
    assert all(np.array_equal(one, alone[i % len(windows)]) for i, one in enumerate(together))
    source.close()


def outlines(picture):
    """Edges of a picture, from 0 to 1: fields' outlines stay where seasons change the fields."""
    grey = picture.ReadAsArray().astype(float).mean(0)
    down, right = np.gradient(grey)
    strength = np.hypot(right, down)
    return strength / (strength + 10.0)


def shift_px(first, second):
    """Shift between two lists of pictures of one size, (x, y) in px, by phase correlation over all of them."""
    height, width = (min(picture.shape[axis] for picture in first) for axis in (0, 1))
    fade = np.outer(np.hanning(height), np.hanning(width))
    fy, fx = np.meshgrid(np.fft.fftfreq(height), np.fft.fftfreq(width), indexing="ij")
    correlation = np.zeros((height, width))
    for pair in zip(first, second):
        a, b = (picture[:height, :width] for picture in pair)
        cross = np.fft.fft2((a - a.mean()) * fade) * np.conj(np.fft.fft2((b - b.mean()) * fade))
        # Above a quarter of the sampling frequency there is little but the noise of resampling.
        cross = np.where(np.hypot(fx, fy) < 0.25, cross / np.maximum(np.abs(cross), 1e-12), 0.0)
        correlation += np.real(np.fft.ifft2(cross))
    row, column = np.unravel_index(np.argmax(correlation), correlation.shape)

    def refined(before, at, after):
        """Top of the parabola through three values."""
        return 0.5 * (before - after) / (before - 2.0 * at + after)

    at = correlation[row, column]
    dy = row + refined(correlation[row - 1, column], at, correlation[(row + 1) % height, column])
    dx = column + refined(correlation[row, column - 1], at, correlation[row, (column + 1) % width])
    return (dx + width / 2) % width - width / 2, (dy + height / 2) % height - height / 2


def captured_on(path, date, area, agl_m, folder):
    source = open_raster(path, date=date)
    mission = Mission(area, agl_m, source=str(path))
    worked_out = plan(mission, source.grid)
    result = capture(worked_out, source, folder)
    source.close()
    assert not result.failed
    pictures = [gdal.Open(str(name)) for name in sorted((folder / "satellite").glob("*.tif"))]
    assert len(pictures) == len(worked_out)
    return worked_out, pictures


def test_the_same_plan_on_two_dates_aligns_to_the_pixel(tmp_path):
    """The two rasters have other origins, pixel sizes and coordinate reference systems, and much has changed."""
    rng = np.random.default_rng(8)
    waves = rng.normal(size=(60, 2)) * 0.25, rng.uniform(0.0, 2.0 * np.pi, 60)

    def ground(x, y):
        """Texture of the ground by UTM coordinates, levels of grey."""
        phases = np.tensordot(np.stack([x, y], -1), waves[0].T, 1) + waves[1]
        return 128.0 + 8.0 * np.cos(phases).sum(-1)

    first = UTM
    second = (9.0665, 2.3e-5, 0.0, 48.0056, 0.0, -1.6e-5)
    to_utm = pyproj.Transformer.from_crs(4326, UTM_EPSG, always_xy=True)
    at_first = rasters.centres(first, 300, 300)
    at_second = to_utm.transform(*rasters.centres(second, 420, 420))
    for date, epsg, geotransform, (x, y) in (
        ("20180601", UTM_EPSG, first, at_first),
        ("20210601", 4326, second, at_second),
    ):
        shade = ground(x, y)
        if date == "20210601":
            # A new field, and a season's light.
            shade = np.where((x > 505_300) & (x < 505_400) & (y > 5_316_700), 200.0, 0.8 * shade + 20.0)
        bands = np.clip(np.rint(np.stack([shade] * 3)), 0, 255)
        rasters.write(tmp_path / f"{date}.tif", bands, geotransform, epsg)
    path = tmp_path / "{date}.tif"
    lon, lat = pyproj.Transformer.from_crs(UTM_EPSG, 4326, always_xy=True).transform(505_300.0, 5_316_700.0)
    area = Box(lat + 0.0012, lon - 0.0018, lat - 0.0012, lon + 0.0018)
    plan_then, then = captured_on(path, "2018-06-01", area, 150.0, tmp_path / "then")
    plan_now, now = captured_on(path, "2021-06-01", area, 150.0, tmp_path / "now")
    assert_aligned(plan_then, then, plan_now, now, 0.1)


def assert_aligned(plan_then, then, plan_now, now, most_px):
    assert plan_then.names == plan_now.names
    for a, b in zip(then, now):
        assert a.GetGeoTransform() == b.GetGeoTransform()
        assert (a.RasterXSize, a.RasterYSize) == (b.RasterXSize, b.RasterYSize)
    edges_then, edges_now = ([outlines(picture) for picture in pictures] for pictures in (then, now))
    assert np.abs(shift_px(edges_then, edges_now)).max() < most_px
    # The measure itself: it sees shifts of the same pictures, of whole pixels and of half ones.
    for shift in ((3, -2), (0.5, 0.5)):
        moved = [shifted(edges, *shift) for edges in edges_now]
        assert shift_px(edges_then, moved) == pytest.approx((-shift[0], -shift[1]), abs=most_px)


def shifted(picture, right_px, down_px):
    """Picture moved by parts of pixels, by the shift theorem; wraps around."""
    fy, fx = np.meshgrid(*(np.fft.fftfreq(size) for size in picture.shape), indexing="ij")
    turn = np.exp(-2j * np.pi * (fx * right_px + fy * down_px))
    return np.real(np.fft.ifft2(np.fft.fft2(picture) * turn))


@pytest.mark.real_data
@pytest.mark.skipif(not PHOTOGRAPHS.is_dir(), reason="the photographs of ../shared/data/naip are not there")
@pytest.mark.parametrize("later", ["2014-07-20", "2020-08-31"])
def test_photographs_of_two_years_align_to_the_pixel(later, tmp_path):
    path = PHOTOGRAPHS / "{date}.tif"
    plan_then, then = captured_on(path, "2009-08-18", INSIDE_PHOTOGRAPHS, 1200.0, tmp_path / "then")
    plan_now, now = captured_on(path, later, INSIDE_PHOTOGRAPHS, 1200.0, tmp_path / "now")
    assert_aligned(plan_then, then, plan_now, now, 0.5)
