"""Orthomosaics against the source's own pixels, brute force over all images, marched rays, and GDAL."""

from __future__ import annotations

import csv
import json
import math
import re
import sys

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.cli.exits import BAD_INPUT
from terrainav.core.errors import Cancelled, InvalidInput
from terrainav.core.exports.views import Views
from terrainav.core.geodesy.camera import Camera, image_axes
from terrainav.core.geodesy.local import LocalFrame
from terrainav.core.geodesy.projections import geodesics
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.source import Window
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mosaic import bigtiff
from terrainav.core.mosaic.frames import place_images
from terrainav.core.mosaic.orthomosaic import (
    choose_images,
    make_orthomosaic,
    mosaic_raster,
    orthorectify,
    write_orthomosaic,
)
from terrainav.core.mosaic.raster import Raster
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.map_frame import assemble

from tests.support.command import command
from tests.support.thinning import sampled

rasterio = pytest.importorskip("rasterio")

SOURCE = open_source("world", seed=2024)
AREA = Box(35.12845, -89.86474, 35.12767, -89.86339)


def captured(folder, **changes):
    """A plan of a small area, captured."""
    values = {
        "agl_m": 80.0,
        "image_px": 360,
        "overlap_along": 0.3,
        "overlap_across": 0.3,
        "area": AREA,
        "frame": "camera",
    }
    mission = Mission(**{**values, **changes})
    made = plan(mission, SOURCE.grid, mission_heights(mission))
    capture(made, SOURCE, folder)
    return made


def source_pixels(grid, zoom, left, top, width, height):
    """Grey levels of the source itself."""
    window = Window(zoom, left, top, width, height)
    parts = SOURCE.parts(window)
    return assemble(window, parts, {one.window: SOURCE.fetch("satellite", one.window) for one in parts}) @ (
        0.299,
        0.587,
        0.114,
    )


def shift_px(one, other):
    """Shift between two images by phase correlation, to a fraction of a pixel."""
    window = np.outer(np.hanning(one.shape[0]), np.hanning(one.shape[1]))
    first, second = (np.fft.fft2((image - image.mean()) * window) for image in (one, other))
    across = first * np.conj(second)
    # A plane is fitted to the phases of low frequencies, which resampling leaves as they are.
    v, u = np.meshgrid(*(np.fft.fftfreq(size) for size in one.shape), indexing="ij")
    low = (np.hypot(u, v) < 0.12) & (np.hypot(u, v) > 0.0)
    weight = np.abs(across[low])
    matrix = 2.0 * np.pi * np.stack([u[low], v[low]], axis=1)
    found, *_ = np.linalg.lstsq(matrix * weight[:, None] ** 0.5, np.angle(across[low]) * weight**0.5, rcond=None)
    return found


@pytest.mark.parametrize(
    "changes",
    [
        *sampled(
            [
                {"yaw_deg": 33.0},
                {"yaw_deg": 20.0, "tilt_deg": 30.0},
                {"yaw_deg": 20.0, "tilt_deg": 10.0, "elevation": ("hills",), "vertical_datum": "ellipsoid"},
            ],
            2,
        ),
        {"camera": Camera(78.8, k1=-0.25, k2=0.08, p1=2e-3, principal_x=0.03), "yaw_deg": 20.0, "tilt_deg": 10.0},
        {"camera": Camera(80.0, lens="fisheye", k1=0.02), "tilt_deg": 5.0},
    ],
    ids=["turned", "tilted", "relief", "barrel", "fisheye"],
)
def test_each_pixel_has_the_colour_of_the_source_there(tmp_path, changes):
    if "elevation" in changes:
        changes = {**changes, "elevation": (hills(tmp_path),)}
    made = captured(tmp_path / "set", **changes)
    frames, _, _ = place_images(tmp_path / "set")
    grid, zoom = SOURCE.grid, made.zoom
    across, down = grid.pixel_size(zoom)
    left, top = int(np.median(made.windows.left_px)) + 60, int(np.median(made.windows.top_px)) + 60
    raster = Raster(grid.plane.west + left * across, grid.plane.north - top * down, across, down, 384, 320)
    used, shown = write_orthomosaic(frames, raster, frames.boxes(), tmp_path / "part.tif")
    with rasterio.open(tmp_path / "part.tif") as file:
        assert file.crs.to_epsg() == 3857
        assert file.transform.c == raster.west
        assert file.transform.f == raster.north
        assert (file.transform.a, file.transform.e) == pytest.approx((across, -down), rel=1e-9)
        pixels, alpha = file.read([1, 2, 3]), file.read(4)
    assert used > 1
    assert shown == pytest.approx((alpha == 255).mean())
    assert (alpha == 255).mean() > (0.9 if made.relief else 0.999)
    grey = np.moveaxis(pixels, 0, -1) @ (0.299, 0.587, 0.114)
    own = source_pixels(grid, zoom, left, top, 384, 320)
    there = alpha == 255
    grey = np.where(there, grey, own)
    # Resampled twice, from the source and from the image.
    assert np.median(np.abs(grey - own)[there]) < 6.0
    assert np.abs(grey - own)[there].mean() < 0.5 * np.abs(np.roll(grey, 3, axis=1) - own)[there].mean()
    for rows in (slice(0, 160), slice(160, 320)):
        for columns in (slice(0, 192), slice(192, 384)):
            off = shift_px(grey[rows, columns], own[rows, columns])
            assert np.hypot(*off) < 0.1


@pytest.mark.parametrize("tilt_deg", [0.0, 25.0])
def test_seams_are_those_of_the_nearest_nadir(tmp_path, tilt_deg):
    """All cameras fly at one height: of those that hold a place, the one counts whose nadir is nearest to it."""
    made = captured(tmp_path / "set", yaw_deg=20.0, tilt_deg=tilt_deg)
    frames, _, _ = place_images(tmp_path / "set")
    raster, boxes = mosaic_raster(frames, 2.0)
    random = np.random.default_rng(3)
    compared = 0
    for left, top in ((0, 0), (64, 64), (raster.width_px // 2, raster.height_px // 2)):
        block = raster.block(left, top, 64)
        choice = choose_images(frames, boxes, block)
        for row, column in random.integers(0, (block.lat_deg.shape), (60, 2)).tolist():
            lat, lon = (float(at[row, column]) for at in (block.lat_deg, block.lon_deg))
            # Through PROJ, from each camera's own east, north and up.
            off = []
            for index in range(len(made)):
                pose = made.poses.take(np.array([index]))
                frame = LocalFrame(float(pose.lat_deg[0]), float(pose.lon_deg[0]), float(pose.agl_m[0]))
                vector = frame.enu(np.array(lat), np.array(lon), np.array(0.0))
                right, up, axis = (part[0] for part in image_axes(*pose.attitude))
                tan_x, tan_y = made.mission.camera.half_tangents
                depth = vector @ axis
                holds = depth > 0.0 and max(abs(vector @ right) / tan_x, abs(vector @ up) / tan_y) <= depth
                away = geodesics(pose.lat_deg, pose.lon_deg, np.array([lat]), np.array([lon]))[2][0]
                off.append(float(away) if holds else math.inf)
            nearest = np.sort(off)
            if math.isinf(nearest[0]):
                assert choice.image[row, column] == -1
            elif nearest[1] - nearest[0] > 1e-3:
                assert choice.image[row, column] == int(np.argmin(off))
                compared += 1
    assert compared > 60


def elevation_of(folder, heights):
    """Heights (120, 120) as a GeoTIFF of cells of two metres in UTM, its middle at 239020, 3891000 of zone 16."""
    path = folder / "heights.tif"
    with rasterio.open(
        path,
        "w",
        driver="GTiff",
        width=120,
        height=120,
        count=1,
        dtype="float32",
        crs="EPSG:32616",
        transform=rasterio.Affine(2.0, 0.0, 238900.0, 0.0, -2.0, 3891120.0),
    ) as file:
        file.write(heights.astype(np.float32), 1)
    return str(path)


def heights_at(heights, x, y):
    """Such heights in UTM, bilinear between the pixels' centres."""
    column, row = (x - 238900.0) / 2.0 - 0.5, (3891120.0 - y) / 2.0 - 0.5
    i, j = np.floor(row).astype(int).clip(0, 118), np.floor(column).astype(int).clip(0, 118)
    s, t = column - j, row - i
    return (
        heights[i, j] * (1 - s) * (1 - t)
        + heights[i, j + 1] * s * (1 - t)
        + heights[i + 1, j] * (1 - s) * t
        + heights[i + 1, j + 1] * s * t
    )


def wall(folder):
    """A wall of 40 m from south to north in the middle; not level beside it, either."""
    heights = np.full((120, 120), 100.0) + np.linspace(0.0, 6.0, 120)[:, None]
    heights[:, 58:62] += 40.0
    return elevation_of(folder, heights)


def hills(folder):
    """Hills of 12 m: images of higher ones are made of several zooms of the source, which look different."""
    row, column = np.mgrid[0:120, 0:120]
    return elevation_of(folder, 100.0 + 6.0 * np.sin(column / 9.0) * np.cos(row / 11.0))


def test_ground_behind_relief_comes_from_an_image_that_sees_it(tmp_path):
    """Rays from the chosen camera, marched step by step over the heights, reach each pixel's ground."""
    from pyproj import Transformer

    elevation = wall(tmp_path)
    to_lat_lon = Transformer.from_crs(32616, 4326)
    to_utm = Transformer.from_crs(4326, 32616)
    places = [to_lat_lon.transform(239020.0 + off, 3891000.0) for off in (-20.0, 55.0, -60.0)]
    made = captured(
        tmp_path / "set",
        area=Points(tuple((lat, lon, 80.0) for lat, lon in places)),
        elevation=(elevation,),
        vertical_datum="ellipsoid",
    )
    frames, _, _ = place_images(tmp_path / "set")
    raster, boxes = mosaic_raster(frames, 1.0)
    with rasterio.open(elevation) as file:
        heights = file.read(1)
    block = raster.block(0, 0, 512)
    choice = choose_images(frames, boxes, block)

    def height_at(x, y):
        return heights_at(heights, x, y)

    def clearance(index, rows, columns):
        """Least height of rays over the ground on their way, but for the last metres of it."""
        x, y = to_utm.transform(block.lat_deg[rows, columns], block.lon_deg[rows, columns])
        own_x, own_y = to_utm.transform(made.lat_deg[index], made.lon_deg[index])
        share = np.linspace(0.0, 0.998, 600)[:, None]
        along_x, along_y = own_x + share * (x - own_x), own_y + share * (y - own_y)
        up = made.height_m[index] + share * (height_at(x, y) - made.height_m[index])
        return (up - height_at(along_x, along_y)).min(axis=0)

    hidden_from_nearest = 0
    for index in range(len(made)):
        rows, columns = np.nonzero(choice.image == index)
        assert len(rows) > 100
        x, y = to_utm.transform(block.lat_deg[rows, columns], block.lon_deg[rows, columns])
        inner = (np.abs(x - 239020.0) < 100.0) & (np.abs(y - 3891000.0) < 100.0)
        # Cells of two metres: what grazes an edge by centimetres is told alike by neither.
        assert clearance(index, rows[inner], columns[inner]).min() > -0.05
    held = np.stack([frames.sight(i, block, frames.block_ground(block, np.arange(3))).inside for i in range(3)])
    steep = np.stack([frames.sight(i, block, frames.block_ground(block, np.arange(3))).steepness for i in range(3)])
    first = np.where(held, steep, -np.inf).argmax(axis=0)
    for index in range(3):
        rows, columns = np.nonzero(held.any(axis=0) & (first == index) & (choice.image != index))
        if len(rows):
            x, y = to_utm.transform(block.lat_deg[rows, columns], block.lon_deg[rows, columns])
            inner = (np.abs(x - 239020.0) < 100.0) & (np.abs(y - 3891000.0) < 100.0)
            # Only what relief hides is taken from another image.
            assert clearance(index, rows[inner], columns[inner]).max() < 0.05
            hidden_from_nearest += int(inner.sum())
    assert hidden_from_nearest > 100


def marched(pose, camera, side, heights):
    """Ground in EPSG:3857 that rays of an image, its edges' among them, meet first: followed by 10 cm."""
    from pyproj import Transformer

    lat, lon, height = (float(at[0]) for at in pose[:3])
    origin = np.array(Transformer.from_crs(4979, 4978).transform(lat, lon, height))
    phi, theta = math.radians(lat), math.radians(lon)
    axes = np.array(
        [
            [-math.sin(theta), math.cos(theta), 0.0],
            [-math.sin(phi) * math.cos(theta), -math.sin(phi) * math.sin(theta), math.cos(phi)],
            [math.cos(phi) * math.cos(theta), math.cos(phi) * math.sin(theta), math.sin(phi)],
        ]
    )
    x, y = np.meshgrid(np.linspace(-1.0, 1.0, side), np.linspace(-1.0, 1.0, side))
    right, up, view = (part[0] for part in image_axes(*pose.attitude))
    tan_x, tan_y = camera.half_tangents
    ways = (view + tan_x * x[..., None] * right + tan_y * y[..., None] * up).reshape(-1, 3)
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True) @ axes
    to_utm = Transformer.from_crs(4978, 32616)
    met, rest, begin_m = np.zeros((3, len(ways))), np.arange(len(ways)), 0.0
    begin = np.array(to_utm.transform(*np.broadcast_to(origin, ways.shape).T))
    while len(rest):
        # Ten metres are straight in UTM, too, within micrometres.
        begin_m += 10.0
        end = np.array(to_utm.transform(*(origin + begin_m * ways[rest]).T))
        clear = np.minimum(begin[2], end[2]) > heights.max()
        for share in np.arange(100) / 100.0:
            low = np.flatnonzero(~clear)
            east, north, above = at = begin[:, low] + share * (end - begin)[:, low]
            down = above <= heights_at(heights, east, north)
            met[:, rest[low[down]]] = at[:, down]
            rest, clear, begin, end = (np.delete(part, low[down], axis=-1) for part in (rest, clear, begin, end))
        begin = end
    east, north, _ = met
    known = (np.abs(east - 239020.0) <= 119.0) & (np.abs(north - 3891000.0) <= 119.0)
    return Transformer.from_crs(32616, 3857).transform(east[known], north[known])


@pytest.mark.parametrize("east", sampled([239035.0, 239110.0], 2), ids=["beside the wall", "where heights end"])
def test_over_relief_a_mosaic_ends_where_its_images_do(tmp_path, east):
    """Rays of the images, marched step by step over the heights, reach as far as the mosaic does."""
    from pyproj import Transformer

    elevation = wall(tmp_path)
    lat, lon = Transformer.from_crs(32616, 4326).transform(east, 3891000.0)
    made = captured(
        tmp_path / "set",
        area=Points(((lat, lon, 80.0),)),
        elevation=(elevation,),
        vertical_datum="ellipsoid",
        yaw_deg=20.0,
        tilt_deg=15.0,
    )
    frames, _, _ = place_images(tmp_path / "set")
    raster, _ = mosaic_raster(frames, 0.5)
    with rasterio.open(elevation) as file:
        heights = file.read(1)
    pose = made.poses.take(np.array([0]))._replace(agl_m=made.height_m)
    x, y = marched(pose, made.mission.camera, 181, heights)
    ends = (raster.west, raster.north - raster.height_px * raster.down)
    ends += (raster.west + raster.width_px * raster.across, raster.north)
    assert ends == pytest.approx((x.min(), y.min(), x.max(), y.max()), abs=2.0 * raster.across)


@pytest.mark.parametrize("image_format", ["tif", "jpg", "png"])
def test_map_frames_keep_their_pixels(tmp_path, image_format):
    made = captured(tmp_path / "set", frame="auto", image_format=image_format, agl_m=150.0)
    assert made.frames.on_map
    result = make_orthomosaic(tmp_path / "set", tmp_path / "map.tif")
    edges = zip(made.windows.bounds_px, (np.min, np.min, np.max, np.max))
    left, top, right, bottom = (int(end(edge)) for edge, end in edges)
    assert (result.width_px, result.height_px) == (right - left, bottom - top)
    with rasterio.open(tmp_path / "map.tif") as file:
        pixels, alpha = file.read([1, 2, 3]), file.read(4)
        west, _, _, north = (float(edge) for edge in SOURCE.grid.edges(left, top, 1, 1, made.zoom))
        assert (file.transform.c, file.transform.f) == pytest.approx((west, north), abs=1e-6)
    own = source_pixels(SOURCE.grid, made.zoom, left, top, right - left, bottom - top)
    off = np.abs(np.moveaxis(pixels, 0, -1) @ (0.299, 0.587, 0.114) - own)[alpha == 255]
    assert off.max() < 1e-9 if image_format != "jpg" else off.mean() < 3.0


def test_frames_turned_by_a_quarter_lie_where_their_places_say(tmp_path):
    made = captured(tmp_path / "set", frame="auto", image_format="png", agl_m=150.0)
    assert made.frames.on_map
    make_orthomosaic(tmp_path / "set", tmp_path / "before.tif")
    table = tmp_path / "set" / "satellite" / "meta_data.csv"
    rows = table.read_text().splitlines()
    heads = rows[0].split(",")
    for number, row in enumerate(rows[1:], 1):
        cells = row.split(",")
        path = tmp_path / "set" / "satellite" / cells[0]
        image = Image.open(path)
        width, height = image.size
        a, d, b, e, x, y = map(float, path.with_suffix(".pgw").read_text().split())
        # The image's top becomes its left side: columns then run north, and rows east.
        image.transpose(Image.Transpose.ROTATE_270).transpose(Image.Transpose.FLIP_LEFT_RIGHT).save(path)
        turned = (b, e, a, d, x, y)
        path.with_suffix(".pgw").write_text("".join(f"{value!r}\n" for value in turned))
        for name, value in (("image_width_px", height), ("image_height_px", width)):
            cells[heads.index(name)] = str(value)
        rows[number] = ",".join(cells)
    table.write_text("\n".join(rows) + "\n")
    make_orthomosaic(tmp_path / "set", tmp_path / "after.tif")
    with rasterio.open(tmp_path / "before.tif") as one, rasterio.open(tmp_path / "after.tif") as other:
        assert one.transform == other.transform
        assert (one.read() == other.read()).all()


def test_a_mosaic_that_is_stopped_leaves_nothing(tmp_path):
    captured(tmp_path / "set", yaw_deg=33.0)
    target = tmp_path / "set" / "satellite.tif"
    target.write_bytes(b"as it was")
    with pytest.raises(Cancelled):
        make_orthomosaic(tmp_path / "set", gsd_m=0.5, progress=lambda _share: False)
    assert target.read_bytes() == b"as it was"
    assert not list((tmp_path / "set").glob("*.part"))


def test_a_mosaic_is_the_same_however_its_threads_run(tmp_path, monkeypatch):
    captured(tmp_path / "set", yaw_deg=33.0)
    make_orthomosaic(tmp_path / "set", tmp_path / "many.tif", gsd_m=0.5)
    monkeypatch.setattr("terrainav.core.mosaic.orthomosaic.ORTHOMOSAIC_THREADS", 1)
    monkeypatch.setattr("terrainav.core.mosaic.orthomosaic._KEPT_BYTES", 0)
    make_orthomosaic(tmp_path / "set", tmp_path / "one.tif", gsd_m=0.5)
    assert (tmp_path / "many.tif").read_bytes() == (tmp_path / "one.tif").read_bytes()


def test_large_files_are_bigtiffs(tmp_path, monkeypatch):
    captured(tmp_path / "set", yaw_deg=33.0)
    make_orthomosaic(tmp_path / "set", tmp_path / "small.tif", gsd_m=0.5)
    monkeypatch.setattr(bigtiff, "_MOST_BYTES", 1000)
    make_orthomosaic(tmp_path / "set", tmp_path / "big.tif", gsd_m=0.5)
    assert (tmp_path / "small.tif").read_bytes()[2] == 42
    assert (tmp_path / "big.tif").read_bytes()[2] == 43
    with rasterio.open(tmp_path / "small.tif") as one, rasterio.open(tmp_path / "big.tif") as other:
        assert one.profile["tiled"]
        assert one.transform == other.transform
        assert (one.read() == other.read()).all()


def test_one_image_on_the_map_is_no_finer_than_half_its_own_pixels(tmp_path):
    captured(tmp_path / "set", area=Points(((35.13, -89.86, 80.0),)), image_px=80)
    frames, _, _ = place_images(tmp_path / "set")
    for longest_px, wanted_m in ((2000, frames.gsd_m / 2.0), (100, frames.gsd_m * 0.8)):
        orthorectify(frames, tmp_path / "on-map.tif", longest_px)
        with rasterio.open(tmp_path / "on-map.tif") as file:
            assert file.transform.a * math.cos(math.radians(35.13)) == pytest.approx(wanted_m, rel=5e-3)


def test_images_with_the_horizon_end_where_they_look_too_flat(tmp_path):
    made = captured(tmp_path / "set", area=Points(((35.13, -89.86, 100.0),)), tilt_deg=75.0)
    result = make_orthomosaic(tmp_path / "set", gsd_m=1.0)
    assert not made.corners.hit.all()
    assert (
        300
        < max(result.width_px, result.height_px)
        < 2.2 * 100.0 * math.tan(math.radians(80.0)) / math.cos(math.radians(35.13))
    )


@pytest.mark.parametrize("frame", ["camera", "map"])
@pytest.mark.parametrize(
    ("column", "cell"),
    [("pose_lat_deg", "1e30"), ("pose_lon_deg", "inf"), ("agl_m", "1e400"), ("tilt_deg", "-inf")],
)
def test_poses_that_are_nowhere_are_refused_by_name(tmp_path, frame, column, cell):
    captured(tmp_path / "set", frame=frame)
    _write_cell(tmp_path / "set", column, cell)
    with pytest.raises(InvalidInput, match=rf"^image .*: {column} .* in its table: must be from -"):
        make_orthomosaic(tmp_path / "set")


@pytest.mark.parametrize("column", ["pose_lat_deg", "pose_lon_deg", "agl_m", "tilt_deg"])
def test_camera_frames_need_poses(tmp_path, column):
    captured(tmp_path / "set", tilt_deg=10.0)
    _write_cell(tmp_path / "set", column, "")
    for wants in (make_orthomosaic, Views.read):
        with pytest.raises(InvalidInput, match=f"its table has no {column} of it"):
            wants(tmp_path / "set")


def _write_cell(folder, column, cell):
    """Change a cell of a table's first row."""
    path = folder / "satellite" / "meta_data.csv"
    with path.open(newline="") as file:
        rows = list(csv.reader(file))
    rows[1][rows[0].index(column)] = cell
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(rows)


@pytest.mark.parametrize("gsd_m", [0.0, -1.0, math.nan])
def test_a_ground_sample_distance_that_is_none_is_refused(tmp_path, gsd_m):
    with pytest.raises(InvalidInput, match="ground sample distance"):
        make_orthomosaic(tmp_path, gsd_m=gsd_m)


def test_a_mosaic_may_be_a_single_pixel(tmp_path):
    captured(tmp_path / "set", yaw_deg=33.0)
    made = make_orthomosaic(tmp_path / "set", gsd_m=1e9)
    assert (made.width_px, made.height_px) == (1, 1)


def test_a_mosaic_beyond_measure_is_refused(tmp_path):
    captured(tmp_path / "set", yaw_deg=33.0)
    for gsd_m in (1e-5, 1e-300, 1e-306, 5e-324):
        with pytest.raises(InvalidInput, match="give a larger ground sample distance") as refused:
            make_orthomosaic(tmp_path / "set", gsd_m=gsd_m)
        assert len(str(refused.value)) < 200


def test_the_command_says_what_it_has_made(tmp_path, monkeypatch, capsys):
    captured(tmp_path / "set", yaw_deg=33.0)
    terrainav = command(tmp_path, monkeypatch, capsys)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    done = terrainav("mosaic", "set", "--gsd", "0.5", "--output", "map.tif")
    assert done.returncode == 0, done.stderr
    assert re.search(r"^\rmosaic +\[#+\] 100 % *\n$", done.stderr.rpartition("\r")[1] + done.stderr.rpartition("\r")[2])
    assert terrainav("mosaic", "set", "--gsd", "0.5", "--output", "map.tif", "--quiet").stderr == ""
    said = json.loads(terrainav("mosaic", "set", "--gsd", "0.5", "--json").stdout)
    with (
        rasterio.open(tmp_path / "map.tif") as one,
        rasterio.open(tmp_path / "set" / "satellite.tif") as other,
    ):
        assert (one.read() == other.read()).all()
        assert (said["width_px"], said["height_px"]) == (one.width, one.height)
        # Metres of the map are longer than those of the ground, on a sphere by the cosine.
        assert one.transform.a * math.cos(math.radians(35.128)) == pytest.approx(0.5, rel=3e-3)
        assert one.tags()["TIFFTAG_COPYRIGHT"] == SOURCE.attribution
    assert f"{said['used']} of {said['images']} images, {said['width_px']:,} x {said['height_px']:,} px" in done.stdout
    assert terrainav("mosaic", "set", "--map-type", "roadmap").returncode == BAD_INPUT
    refused = terrainav("mosaic", "set", "--output", "map.jpg")
    assert refused.returncode == BAD_INPUT
    assert refused.stderr == "terrainav: mosaic map.jpg: must end in .tif or .tiff\n"
    assert not (tmp_path / "map.jpg").exists()
