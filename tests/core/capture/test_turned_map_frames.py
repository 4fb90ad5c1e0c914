"""Map frames turned by quarter turns: where GDAL says that their pixels are, the source has those very pixels."""

from __future__ import annotations

import json
from contextlib import closing

import numpy as np
import pytest
from osgeo import gdal, ogr, osr
from pyproj import Transformer
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.ground import are_camera_frames, ground_boxes
from terrainav.core.dataset.loading.batches import LabelledImages
from terrainav.core.errors import InvalidInput
from terrainav.core.exports.kinds import export_as
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import named_source
from terrainav.core.imagery.source import Window
from terrainav.core.mission.areas.area import Box, Points, Polygon, Polygons
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mosaic.orthomosaic import make_orthomosaic
from terrainav.core.picture.map_frame import turned
from terrainav.core.picture.optics import plan_optics
from terrainav.core.world import WorldSource

from tests.support import rasters
from tests.support.thinning import sampled

gdal.UseExceptions()
ogr.UseExceptions()
TO_DEGREES = Transformer.from_crs(32616, 4326, always_xy=True)
CAMERA = Camera(60.0, 1.5)
#: One capture at each quarter turn, one of them across whole turns.
YAWS = (0.0, 90.0, 180.0, -90.0, 450.0 - 360.0)
PLACES = Points(tuple((35.1405 + 0.0001 * at, -89.863, 60.0) for at in range(len(YAWS))), yaws_deg=YAWS)
SMALL = Box(35.1425, -89.866, 35.1405, -89.863)
FIELDS = Polygons(
    tuple(
        Polygon((((west, 35.1405), (west + 0.001, 35.1405), (west + 0.001, 35.1415), (west, 35.1415)),))
        for west in (-89.866, -89.863)
    )
)


def captured(folder, mission, source=None):
    source = source or WorldSource()
    made = plan(mission, source.grid)
    assert made.frames.on_map
    capture(made, source, folder)
    return made, source


def source_pixels(source, zoom, columns, rows):
    """Pixels of the source at global columns and rows (h, w) of a zoom, one window around them all fetched at once."""
    left, top = int(columns.min()), int(rows.min())
    size = int(columns.max()) - left + 1, int(rows.max()) - top + 1
    tile = 256
    found = np.empty((*columns.shape, 3), np.uint8)
    for y in range(top // tile, (top + size[1] - 1) // tile + 1):
        for x in range(left // tile, (left + size[0] - 1) // tile + 1):
            pixels = source.fetch("satellite", Window(zoom, x * tile, y * tile, tile, tile))
            here = (columns // tile == x) & (rows // tile == y)
            found[here] = pixels[rows[here] - y * tile, columns[here] - x * tile, :3]
    return found


def pixels_of(raster):
    return np.moveaxis(raster.ReadAsArray(), 0, -1)


def places_of(raster):
    """Easting and northing of the pixels' centres, (h, w) each, as GDAL has them."""
    x0, x_column, x_row, y0, y_column, y_row = raster.GetGeoTransform()
    column, row = np.meshgrid(np.arange(raster.RasterXSize) + 0.5, np.arange(raster.RasterYSize) + 0.5)
    return x0 + x_column * column + x_row * row, y0 + y_column * column + y_row * row


@pytest.mark.parametrize("ending", sampled(["tif", "png"], 2))
def test_pixels_are_the_source_s_own_where_gdal_says_that_they_are(tmp_path, ending):
    made, source = captured(tmp_path, Mission(PLACES, 60.0, CAMERA, image_format=ending))
    resolution = 2.0 * np.pi * 6378137.0 / made.grid.world_px(made.zoom)
    for index, yaw in enumerate(YAWS):
        raster = gdal.Open(str(tmp_path / "satellite" / f"{made.names[index]}.{ending}"))
        assert osr.SpatialReference(raster.GetProjection()).IsSame(epsg(3857))
        assert (raster.RasterXSize, raster.RasterYSize) == (
            made.frames.width_px[index],
            made.frames.height_px[index],
        )
        assert raster.RasterXSize > raster.RasterYSize
        x, y = places_of(raster)
        columns, rows = (x + np.pi * 6378137.0) / resolution, (np.pi * 6378137.0 - y) / resolution
        assert np.abs(columns - np.floor(columns) - 0.5).max() < 1e-4
        assert np.array_equal(
            pixels_of(raster),
            source_pixels(source, made.zoom, *(np.floor(at).astype(np.int64) for at in (columns, rows))),
        )
        # The top of the image is where the camera's top points, and its edges are what the camera sees.
        down = np.array([x[-1, 0] - x[0, 0], y[-1, 0] - y[0, 0]])
        assert np.degrees(np.arctan2(-down[0], -down[1])) % 360.0 == pytest.approx(yaw % 360.0)
        corners = Transformer.from_crs(4326, 3857, always_xy=True).transform(
            made.corners.lon_deg[index], made.corners.lat_deg[index]
        )
        at = [(0, 0), (0, -1), (-1, -1), (-1, 0)]
        off = np.hypot(*(np.array([part[i] for i in at]) - true for part, true in zip((x, y), corners)))
        assert off.max() < 2.0 * resolution


def epsg(code):
    found = osr.SpatialReference()
    found.ImportFromEPSG(code)
    return found


def test_a_world_file_alone_says_the_same(tmp_path):
    made, _ = captured(tmp_path, Mission(PLACES, 60.0, CAMERA, image_format="jpg", img_size=(90, 60, 3)))
    for index in range(len(YAWS)):
        path = tmp_path / "satellite" / f"{made.names[index]}.jpg"
        by_both = gdal.Open(str(path)).GetGeoTransform()
        path.with_name(path.name + ".aux.xml").unlink()
        alone = gdal.Open(str(path))
        assert alone.GetGeoTransform() == pytest.approx(by_both, rel=1e-12, abs=1e-9)
        x, y = places_of(alone)
        west, south, east, north = (edge[index] for edge in made.edges)
        half = [abs(by_both[1]) + abs(by_both[2]), abs(by_both[4]) + abs(by_both[5])]
        assert (x.min() - half[0] / 2, x.max() + half[0] / 2) == pytest.approx((west, east), abs=1e-6)
        assert (y.min() - half[1] / 2, y.max() + half[1] / 2) == pytest.approx((south, north), abs=1e-6)


def test_ground_points_and_optics_are_those_of_the_turned_image(tmp_path):
    made, _ = captured(tmp_path, Mission(PLACES, 60.0, CAMERA, products=("points", "depth")))
    optics = plan_optics(made, np.arange(len(made)))
    for index, yaw in enumerate(YAWS):
        name = f"{made.names[index]}.tif"
        lon, lat, _ = gdal.Open(str(tmp_path / "points" / name)).ReadAsArray()[:3]
        raster = gdal.Open(str(tmp_path / "satellite" / name))
        x, y = Transformer.from_crs(4326, 3857, always_xy=True).transform(lon, lat)
        _, across, _, _, along, _ = raster.GetGeoTransform()
        # Places are rounded to an 8,000th of a pixel's ground (docs/relief.md).
        assert np.abs(np.array(places_of(raster)) - (x, y)).max() <= np.hypot(across, along) / 16_000.0
        # The pinhole sees the ground of each pixel there.
        north = np.radians(lat - made.lat_deg[index]) * made.ground.meridional_radius_m(made.lat_deg[index])
        east = np.radians(lon - made.lon_deg[index]) * (
            made.ground.normal_radius_m(made.lat_deg[index]) * np.cos(np.radians(made.lat_deg[index]))
        )
        sine, cosine = np.sin(np.radians(yaw)), np.cos(np.radians(yaw))
        right, ahead = east * cosine - north * sine, east * sine + north * cosine
        column = optics.centre_x_px[index] + optics.focal_x_px[index] * right / 60.0
        row = optics.centre_y_px[index] - optics.focal_y_px[index] * ahead / 60.0
        true_column, true_row = np.meshgrid(np.arange(lon.shape[1]) + 0.5, np.arange(lon.shape[0]) + 0.5)
        assert np.hypot(column - true_column, row - true_row).max() < 0.05


def test_footprints_and_loaded_images_are_those_of_the_turned_files(tmp_path):
    made, _ = captured(tmp_path, Mission(PLACES, 60.0, CAMERA, image_format="png"))
    features = json.loads((tmp_path / "footprints.geojson").read_text())["features"]
    to_map = Transformer.from_crs(4326, 3857, always_xy=True)
    resolution = 2.0 * np.pi * 6378137.0 / made.grid.world_px(made.zoom)
    for index, feature in enumerate(features):
        raster = gdal.Open(str(tmp_path / "satellite" / f"{feature['properties']['name']}.png"))
        assert feature["properties"]["yaw_deg"] == pytest.approx(YAWS[index])
        seen = np.array(to_map.transform(*np.array(feature["geometry"]["coordinates"][0]).T))
        there = np.array([(at.min(), at.max()) for at in places_of(raster)])
        ends = np.stack([seen.min(axis=1), seen.max(axis=1)], axis=1)
        # To the whole pixels that the centres of the outermost ones are half a pixel inside of.
        assert np.abs(ends - there).max() < 1.1 * resolution
    for size in ((90, 60, 3), (60, 90, 3)):
        samples = LabelledImages(
            tmp_path, part="all", img_size=size, dtype="uint8", augment=None, targets=("attitude",)
        )
        images, values = samples.take(np.arange(len(YAWS)), 0)
        assert images.shape == (len(YAWS), size[1], size[0], 3)
        assert values[:, 0] == pytest.approx(YAWS)
        for image, name in zip(images, samples.names):
            own = pixels_of(gdal.Open(str(tmp_path / "satellite" / f"{name}.png"))).astype(np.float64)
            for rows in (slice(0, size[1] // 2), slice(size[1] // 2, None)):
                part = slice(*(round(at * len(own) / size[1]) for at in rows.indices(size[1])[:2]))
                assert image[rows].mean() == pytest.approx(own[part].mean(), abs=2.0)


def test_rows_to_and_fro_are_map_frames_of_one_dataset(tmp_path):
    made, _ = captured(tmp_path, Mission(SMALL, 60.0, CAMERA, facing="track", overlap_along=0.3))
    assert made.coverage.complete
    assert set(made.frames.quarter_turns.tolist()) == {1, 3}
    assert not made.frames.is_north_up
    assert made.overlap.least_along >= 0.3 - 0.01
    images = read_dataset(tmp_path).image_sets["satellite"]
    rows = np.arange(len(made))
    assert not are_camera_frames(images, rows, tmp_path)
    boxes = ground_boxes(images, rows, tmp_path, -89.86)
    west, _, east, _ = made.edges
    scale = 2.0 * np.pi * 6378137.0
    assert np.abs((boxes.east_u - boxes.west_u) * scale - (east - west)).max() < 1e-6
    table = images.table
    assert (table.image_width_px == table.height_px).all()
    assert (table.image_height_px == table.width_px).all()
    assert (table.image_width_px > table.image_height_px).all()


@pytest.mark.parametrize("ending", sampled(["tif", "jpg", pytest.param("png", marks=pytest.mark.thorough)], 2))
def test_images_of_rows_along_meridians_are_read_as_the_map_frames_that_they_are(tmp_path, ending):
    """Their cameras are turned from the map by what meridians converge: as little as the budget lets pass."""
    mission = Mission(FIELDS, 60.0, CAMERA, facing="track", row_azimuth_deg=0.0, overlap_along=0.3, image_format=ending)
    made, source = captured(tmp_path, mission)
    images = read_dataset(tmp_path).image_sets["satellite"]
    rows = np.arange(len(made))
    assert np.any(images.table.yaw_deg % 90.0)
    assert not are_camera_frames(images, rows, tmp_path)
    boxes = ground_boxes(images, rows, tmp_path, -89.86)
    west, _, east, _ = made.edges
    assert np.abs((boxes.east_u - boxes.west_u) * 2.0 * np.pi * 6378137.0 - (east - west)).max() < 1e-6
    with pytest.raises(InvalidInput, match="windows of the map"):
        export_as(tmp_path, tmp_path / "model", "colmap", None)
    if ending != "jpg":
        make_orthomosaic(tmp_path, tmp_path / "whole.tif")
        whole = gdal.Open(str(tmp_path / "whole.tif"))
        x, y = places_of(whole)
        half, size = np.pi * 6378137.0, 2.0 * np.pi * 6378137.0 / (256 << made.zoom)
        columns, lines = (np.floor(at / size).astype(np.int64) for at in (x + half, half - y))
        pixels = pixels_of(whole)
        there = pixels[..., 3] > 0
        assert there.mean() > 0.2
        own = source_pixels(source, made.zoom, columns, lines)
        assert (pixels[there][:, :3] == own[there]).all()


@pytest.mark.parametrize("azimuth", [90.0, 0.0])
def test_images_lie_by_quarter_turns_on_a_source_s_own_grid(tmp_path, azimuth):
    place = 240_000.0, 0.5, 0.0, 3_893_000.0, 0.0, -0.5
    values = np.random.default_rng(3).integers(0, 255, (3, 900, 1100))
    path = rasters.write(tmp_path / "ortho.tif", values, place, 32616)
    with closing(named_source(str(path)).open()) as source:
        lon, lat = TO_DEGREES.transform([240_150.0, 240_350.0], [3_892_850.0, 3_892_700.0])
        area = Box(lat[0], lon[0], lat[1], lon[1])
        mission = Mission(area, 60.0, CAMERA, facing="track", row_azimuth_deg=azimuth, source=str(path))
        made, _ = captured(tmp_path / "out", mission, source)
    assert set(made.frames.quarter_turns.tolist()) == ({1, 3} if azimuth else {0, 2})
    assert made.coverage.complete
    assert made.overlap.least_across > -1e-9
    for index in (0, len(made) - 1):
        raster = gdal.Open(str(tmp_path / "out" / "satellite" / f"{made.names[index]}.tif"))
        assert osr.SpatialReference(raster.GetProjection()).IsSame(epsg(32616))
        x, y = places_of(raster)
        column, row = (x - place[0]) / 0.5, (place[3] - y) / 0.5
        assert np.array_equal(pixels_of(raster), np.moveaxis(values, 0, -1)[row.astype(int), column.astype(int)])
        corners = made.corners.lon_deg[index], made.corners.lat_deg[index]
        true = TO_DEGREES.transform(*corners, direction="INVERSE")
        off = np.hypot(*(np.array([p[0, 0], p[0, -1], p[-1, -1]]) - t[:3] for p, t in zip((x, y), true)))
        assert off.max() < 0.8


FIELD = Polygon((((-89.866, 35.1385), (-89.8585, 35.1425), (-89.8597, 35.1440), (-89.868, 35.1405)),))


@pytest.mark.parametrize(
    ("area", "changes", "turns"),
    sampled(
        [
            (SMALL, {"row_azimuth_deg": 0.0}, {0, 2}),
            (FIELD, {"row_azimuth_deg": 180.0, "overlap_along": 0.4, "overlap_across": 0.2}, {0, 2}),
            (FIELD, {"row_azimuth_deg": 270.0}, {1, 3}),
            (SMALL, {"crosshatch": True}, {0, 1, 2, 3}),
            (SMALL, {"row_azimuth_deg": 0.0, "facing": "90"}, {1}),
            (
                Box(60.03, 10.0, 60.0, 10.05),
                {"row_azimuth_deg": 0.0, "agl_m": 300.0, "error_budget_px": 2.0},
                {0, 2},
            ),
        ],
        3,
    ),
)
def test_rows_along_meridians_are_map_frames_that_leave_nothing_out(area, changes, turns):
    agl_m = changes.pop("agl_m", 60.0)
    made = plan(Mission(area, agl_m, CAMERA, **{"facing": "track", **changes}), PixelGrid(max_zoom=22, native_zoom=22))
    assert made.frames.on_map
    assert set(made.frames.quarter_turns.tolist()) == turns
    assert made.coverage.complete
    # GEOS knows no camera and no rows: the windows hold the area.
    box = area.bounds
    ring = (
        area.rings[0]
        if isinstance(area, Polygon)
        else [
            (box.west_deg, box.north_deg),
            (box.east_deg, box.north_deg),
            (box.east_deg, box.south_deg),
            (box.west_deg, box.south_deg),
        ]
    )
    field = polygon(*np.array(ring).T)
    field.Segmentize(1e-4)
    lon, lat = np.array(field.GetGeometryRef(0).GetPoints())[:, :2].T
    windows = ogr.Geometry(ogr.wkbMultiPolygon)
    for west, south, east, north in zip(*made.edges):
        windows.AddGeometry(polygon([west, east, east, west], [south, south, north, north]))
    on_map = polygon(*Transformer.from_crs(4326, 3857, always_xy=True).transform(lon, lat))
    assert on_map.Difference(windows.UnionCascaded()).Area() < 1e-3
    # Overlap that is said is had: the next window of a row shares as much.
    west, south, east, north = made.edges
    here = np.flatnonzero(made.row[1:] == made.row[:-1])
    shared = np.minimum(north[here], north[here + 1]) - np.maximum(south[here], south[here + 1])
    beside = np.minimum(east[here], east[here + 1]) - np.maximum(west[here], west[here + 1])
    share = np.minimum(shared / (north - south)[here], beside / (east - west)[here])
    assert share.min() >= made.overlap.least_along - 1e-3
    assert made.overlap.least_along >= made.mission.flight.overlap_along


def polygon(x, y):
    ring = ogr.Geometry(ogr.wkbLinearRing)
    for place in zip([*x, x[0]], [*y, y[0]]):
        ring.AddPoint_2D(*map(float, place))
    found = ogr.Geometry(ogr.wkbPolygon)
    found.AddGeometry(ring)
    return found


def test_rows_that_were_camera_frames_before_others_could_be_turned_still_are():
    for changes in ({"row_azimuth_deg": 0.0}, {"crosshatch": True}):
        assert not plan(Mission(SMALL, 60.0, CAMERA, **changes), PixelGrid()).frames.on_map


@pytest.mark.parametrize("yaw", [1.0, 45.0, 89.0, 91.0])
def test_other_yaws_are_camera_frames(yaw):
    area = Points(PLACES.poses[:1], yaws_deg=(yaw,))
    assert not plan(Mission(area, 60.0, CAMERA), PixelGrid()).frames.on_map


def test_half_turns_keep_to_the_windows_of_north_up_images():
    both = [plan(Mission(SMALL, 60.0, CAMERA, yaw_deg=yaw), PixelGrid()) for yaw in (0.0, 180.0)]
    for ours, theirs in zip(both[0].windows, both[1].windows):
        assert np.array_equal(ours, theirs)
    assert both[1].frames.quarter_turns.tolist() == [2] * len(both[1])
    assert both[1].accuracy.bound_px == pytest.approx(both[0].accuracy.bound_px, rel=1e-6)


def test_a_source_of_whole_images_gives_turned_ones():
    grid = PixelGrid(centre_decimals=6, max_size_px=640)
    made = plan(Mission(SMALL, 60.0, CAMERA, facing="track"), grid)
    assert made.coverage.complete
    assert set(made.frames.quarter_turns.tolist()) == {1, 3}


@pytest.mark.parametrize("turns", range(-4, 5))
def test_turning_back_gives_the_same_pixels(turns):
    image = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    assert np.array_equal(np.rot90(turned(image, turns), -turns), image)
