"""Pictures over relief: what each pixel sees, its colour, what stands in front of what, and the products beside."""

from __future__ import annotations

import csv
import json
from collections import Counter

import numpy as np
import pyproj
import pytest
from osgeo import gdal
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.elevation.layered import open_relief
from terrainav.core.errors import InvalidInput
from terrainav.core.external.compiling import uses_numba, without_numba
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing import tracing
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.raytracing.tracing import Tracing
from terrainav.core.geodesy.triangles import NO_FACES, ROOF, WALL
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.relief.roofed import seen_surface
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.products import sighting
from terrainav.core.picture.shot import Shot, draw, make_shot, picture_parts
from terrainav.core.report.measure import measure
from terrainav.core.report.pixels import NUMPY
from terrainav.core.world import World, WorldSource
from terrainav.core.world.houses import _houses
from terrainav.core.world.objects import footprints
from terrainav.core.world.samples import ScatteredPositions as Places
from terrainav.core.world.scene import Scene as Landscape

from tests.support import rasters

WEST, NORTH, SIDE, CELL = 320_000.0, 4_298_000.0, 300, 2.0
TO_UTM = pyproj.Transformer.from_crs(4326, 32618, always_xy=True)
TO_DEGREES = pyproj.Transformer.from_crs(32618, 4326, always_xy=True)
GEOCENTRIC = pyproj.Transformer.from_crs(4979, 4978, always_xy=True)
#: Middle of the tower, half its width, and its height.
TOWER, HALF, HIGH = (300.0, 300.0), 7.0, 30.0


def hills(x, y):
    return 60.0 + 12.0 * np.sin(x / 60.0) * np.cos(y / 50.0)


def grid_points():
    return np.meshgrid((np.arange(SIDE) + 0.5) * CELL, (np.arange(SIDE) + 0.5) * CELL)


def with_tower(x, y):
    return hills(x, y) + HIGH * ((np.abs(x - TOWER[0]) < HALF) & (np.abs(y - TOWER[1]) < HALF))


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Heights with and without a tower, and imagery of 0.5 m that tells positions; or red roofs on blue ground."""
    folder = tmp_path_factory.mktemp("relief")
    x, y = grid_points()
    transform = (WEST, CELL, 0.0, NORTH, 0.0, -CELL)
    found = {}
    for name, values in (("hills", hills(x, y)), ("tower", with_tower(x, y))):
        found[name] = str(
            rasters.write(folder / f"{name}.tif", values[np.newaxis], transform, 32618, data_type=gdal.GDT_Float32)
        )
    lake = np.where(x < 290.0, 60.0, hills(x, y))
    found["lake"] = str(
        rasters.write(folder / "lake.tif", lake[np.newaxis], transform, 32618, data_type=gdal.GDT_Float32)
    )
    fine = np.meshgrid((np.arange(4 * SIDE) + 0.5) / 2.0, (np.arange(4 * SIDE) + 0.5) / 2.0)
    colours = np.stack([40.0 + fine[0] / 4.0, 230.0 - fine[1] / 4.0, np.full_like(fine[0], 90.0)])
    photo = (WEST, 0.5, 0.0, NORTH, 0.0, -0.5)
    found["photo"] = str(rasters.write(folder / "photo.tif", np.rint(colours), photo, 32618))
    roof = (np.abs(fine[0] - TOWER[0]) < HALF - 1.0) & (np.abs(fine[1] - TOWER[1]) < HALF - 1.0)
    painted = np.stack([255.0 * roof, np.zeros_like(roof), 255.0 * ~roof])
    found["roofs"] = str(rasters.write(folder / "roofs.tif", painted, photo, 32618))
    return found


def one(files, heights="hills", x=300.0, y=330.0, agl=90.0, photo="photo", **values):
    lon, lat = TO_DEGREES.transform(WEST + x, NORTH - y)
    values = {"elevation": (files[heights],), "source": files[photo], "image_px": 320, **values}
    places = ((lat, lon, agl), *values.pop("also", ()))
    mission = Mission(Points(places), agl, **values)
    source = open_source(mission.imagery.source)
    return plan(mission, source.grid, mission_heights(mission)), source


def picture(made, source, index=0):
    parts = picture_parts(made, source, index)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    return draw(make_shot(made, index), parts, pixels, masked=True)


def axes(made):
    """Camera in geocentric metres, and its right, top and axis there."""
    camera = np.array(GEOCENTRIC.transform(made.lon_deg[0], made.lat_deg[0], made.height_m[0]))
    phi, lam = np.radians(made.lat_deg[0]), np.radians(made.lon_deg[0])
    east = np.array([-np.sin(lam), np.cos(lam), 0.0])
    up = np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
    north = np.cross(up, east)
    yaw, tilt = (np.radians(angle[0]) for angle in (made.poses.yaw_deg, made.poses.tilt_deg))
    heading = np.sin(yaw) * east + np.cos(yaw) * north
    right = np.cos(yaw) * east - np.sin(yaw) * north
    return (
        camera,
        right,
        np.cos(tilt) * heading + np.sin(tilt) * up,
        np.sin(tilt) * heading - np.cos(tilt) * up,
    )


@pytest.mark.parametrize("tilt", [0.0, 40.0])
def test_captures_of_level_ground_in_a_mission_over_relief_are_made_as_over_level_ground(files, tilt, monkeypatch):
    """A lake among hills: no ray is traced for its pictures, which are those of traced rays all the same."""
    lon, lat = TO_DEGREES.transform(WEST + 400.0, NORTH - 330.0)
    made, source = one(files, "lake", x=150.0, agl=60.0, tilt_deg=tilt, also=((lat, lon, 60.0),))
    assert not made.relief.is_level
    assert not made.views.view(0).samples
    assert made.views.view(0).patches
    assert made.views.view(1).samples
    assert not made.views.view(1).patches
    quick = picture(made, source).pixels[..., :3].astype(int)
    monkeypatch.setattr(Tracing, "level_m", None)
    assert made.views.view(0).samples
    assert not made.views.view(0).patches
    slow = picture(made, source).pixels[..., :3].astype(int)
    assert np.abs(quick - slow).max() <= 2


TILTS = [(0.0, 0.0), (30.0, 75.0), (55.0, 200.0)]


@pytest.mark.parametrize(("tilt", "yaw"), TILTS)
@pytest.mark.parametrize("heights", ["hills", "tower"])
def test_ground_points_lie_on_the_surface_and_where_a_pinhole_sees_them(files, heights, tilt, yaw):
    made, _ = one(files, heights, tilt_deg=tilt, yaw_deg=yaw)
    width, height = made.frames.largest_px
    seen = sighting(made, 0, made.frames.largest_px)
    there = np.isfinite(seen.depth_m)
    assert there.mean() > 0.8
    camera, right, top, axis = axes(made)
    points = np.stack(GEOCENTRIC.transform(seen.lon_deg[there], seen.lat_deg[there], seen.height_m[there]), axis=-1)
    vectors = points - camera
    depth = vectors @ axis
    tan_x, tan_y = made.mission.camera.half_tangents
    focal_x, focal_y = width / (2.0 * tan_x), height / (2.0 * tan_y)
    row, column = np.nonzero(there)
    x, y = vectors @ right / depth * focal_x + width / 2.0, height / 2.0 - vectors @ top / depth * focal_y
    np.testing.assert_allclose(x, column + 0.5, rtol=0.0, atol=0.02)
    np.testing.assert_allclose(y, row + 0.5, rtol=0.0, atol=0.02)
    np.testing.assert_allclose(seen.depth_m[there], depth, rtol=1e-5)
    # On the surface: between the centres of its own pixels heights are bilinear.
    east, north = TO_UTM.transform(seen.lon_deg[there], seen.lat_deg[there])
    j, i = (east - WEST) / CELL - 0.5, (NORTH - north) / CELL - 0.5
    z = (hills if heights == "hills" else with_tower)(*grid_points()).astype(np.float32).astype(float)
    j0, i0 = np.clip(np.floor(j).astype(int), 0, SIDE - 2), np.clip(np.floor(i).astype(int), 0, SIDE - 2)
    u, v = j - j0, i - i0
    own = (z[i0, j0] * (1 - u) + z[i0, j0 + 1] * u) * (1 - v) + (z[i0 + 1, j0] * (1 - u) + z[i0 + 1, j0 + 1] * u) * v
    np.testing.assert_allclose(seen.height_m[there], own, rtol=0.0, atol=5e-3)


@pytest.mark.parametrize(("tilt", "yaw"), TILTS[1:])
def test_nothing_stands_between_the_camera_and_what_it_sees(files, tilt, yaw):
    made, _ = one(files, "tower", tilt_deg=tilt, yaw_deg=yaw, x=300.0, y=300.0 + 60.0 * np.cos(np.radians(yaw)))
    seen = sighting(made, 0, made.frames.largest_px)
    at = np.flatnonzero(np.isfinite(seen.depth_m))[::37]
    lat, lon, high = (values.ravel()[at] for values in (seen.lat_deg, seen.lon_deg, seen.height_m))
    ends = np.stack(GEOCENTRIC.transform(lon, lat, high), axis=-1)
    camera = axes(made)[0]
    z = with_tower(*grid_points())
    back = pyproj.Transformer.from_crs(4978, 4979, always_xy=True)
    for share in np.linspace(0.02, 0.995, 400):
        between = camera + share * (ends - camera)
        lon_b, lat_b, h = back.transform(*between.T)
        east, north = TO_UTM.transform(lon_b, lat_b)
        j, i = (east - WEST) / CELL - 0.5, (NORTH - north) / CELL - 0.5
        inside = (j > 0) & (j < SIDE - 1) & (i > 0) & (i < SIDE - 1)
        j0, i0 = np.clip(np.floor(j).astype(int), 0, SIDE - 2), np.clip(np.floor(i).astype(int), 0, SIDE - 2)
        u, v = j - j0, i - i0
        own = (z[i0, j0] * (1 - u) + z[i0, j0 + 1] * u) * (1 - v) + (
            z[i0 + 1, j0] * (1 - u) + z[i0 + 1, j0 + 1] * u
        ) * v
        assert (h - own)[inside].min() > -0.02


@pytest.mark.parametrize(("tilt", "yaw"), TILTS)
def test_each_pixel_has_the_colour_of_the_ground_that_it_sees(files, tilt, yaw):
    made, source = one(files, tilt_deg=tilt, yaw_deg=yaw)
    shown = picture(made, source)
    seen = sighting(made, 0, made.frames.largest_px)
    there = shown.pixels[..., 3] > 0
    east, north = TO_UTM.transform(seen.lon_deg[there], seen.lat_deg[there])
    wanted = np.stack([40.0 + (east - WEST) / 4.0, 230.0 - (NORTH - north) / 4.0], axis=-1)
    off = np.abs(shown.pixels[there][:, :2] - wanted)
    # Four metres are a grey level: rounding, and the mean over a pixel's ground.
    assert np.percentile(off, 99) < 1.2
    assert off.max() < 4.0
    assert shown.unmapped_share == pytest.approx(1.0 - there.mean(), abs=1e-9)


def test_normals_are_those_of_the_ground(files):
    made, _ = one(files, tilt_deg=20.0)
    seen = sighting(made, 0, made.frames.largest_px)
    there = np.isfinite(seen.depth_m)
    east, north = TO_UTM.transform(seen.lon_deg[there], seen.lat_deg[there])
    x, y = east - WEST, NORTH - north
    by_x = 12.0 / 60.0 * np.cos(x / 60.0) * np.cos(y / 50.0)
    by_y = -12.0 / 50.0 * np.sin(x / 60.0) * np.sin(y / 50.0)
    # Grid north is not true north.
    turn = np.radians(pyproj.Proj(32618).get_factors(made.lon_deg[0], made.lat_deg[0]).meridian_convergence)
    slope_east = by_x * np.cos(turn) + by_y * np.sin(turn) * -1.0
    slope_north = -by_y * np.cos(turn) - by_x * np.sin(turn)
    wanted = np.stack([-slope_east, -slope_north, np.ones_like(x)], axis=-1)
    wanted /= np.linalg.norm(wanted, axis=-1, keepdims=True)
    assert np.abs(seen.normals[there] - wanted).max() < 0.02
    np.testing.assert_allclose(np.linalg.norm(seen.normals[there], axis=-1), 1.0, rtol=1e-6)


def test_walls_are_marked_and_have_the_colour_of_the_roof_or_the_ground(files):
    made, source = one(files, "tower", tilt_deg=45.0, y=360.0, agl=70.0, photo="roofs")
    shown = picture(made, source)
    seen = sighting(made, 0, made.frames.largest_px)
    assert 0.02 < seen.steep.mean() < 0.3
    assert shown.facade_share == pytest.approx(seen.steep.mean())
    wall = seen.height_m[seen.steep]
    assert np.ptp(wall) > 0.8 * HIGH
    red, blue = (shown.pixels[seen.steep][:, channel].astype(int) for channel in (0, 2))
    # The upper half as the roof, the lower as the ground, and nothing smeared between.
    assert ((red > 200) | (blue > 200)).mean() > 0.95
    base = hills(*TOWER)
    upper, lower = wall > base + 0.6 * HIGH, wall < base + 0.4 * HIGH
    assert (red[upper] > 200).mean() > 0.95
    assert (blue[lower] > 200).mean() > 0.95


TOWN = (35.1405, -89.8605)


@pytest.fixture(scope="module")
def town(tmp_path_factory):
    """Two captures of one town of the embedded world, northward and eastward: folder, plan, what pixels see."""
    folder = tmp_path_factory.mktemp("town")
    places = tuple((TOWN[0] + north_m / 111_000.0, TOWN[1], 50.0) for north_m in (-20.0, 5.0))
    mission = Mission(
        Points(places, yaws_deg=(20.0, 75.0)),
        50.0,
        tilt_deg=40.0,
        image_px=320,
        elevation=("world",),
        source="world",
        map_types=("satellite", "roadmap"),
        products=("classes", "instances"),
    )
    source = open_source(mission.imagery.source)
    made = plan(mission, source.grid, mission_heights(mission))
    capture(made, source, folder)
    return folder, made, [sighting(made, index, made.frames.largest_px) for index in range(2)]


def written(town, index, map_type="satellite"):
    """Picture of a capture as its file has it."""
    folder, made, _ = town
    with Image.open(folder / map_type / f"{made.names[index]}.tif") as image:
        return np.asarray(image)[..., :3]


def building_at(lat, lon):
    """Hash of the building at places (n,), and how far inside its west, north, east and south side they are, metres."""
    u, v = WorldSource.grid.plane.forward(lat, lon)
    x, y = (int(np.median(at) * 2**14) for at in (u, v))
    parcels = Landscape(World().landscape, Places(14, x, y, u, v)).parcels
    prints = footprints(parcels)
    sides = np.stack([prints.west, prints.north, prints.east, prints.south], axis=1)
    return parcels.take(parcels.division.leaves.hash), sides


def walls_seen(picture, seen):
    """Colours of the walls in a picture by building and side, well away from corners, without light; of their roofs."""
    walls, roofs = {}, {}
    row, column = np.nonzero(seen.kind == WALL)
    own, sides = building_at(seen.lat_deg[row, column], seen.lon_deg[row, column])
    # Walls are straight, and the painter's sides as bent as the plane.
    side, others = np.abs(sides).argmin(axis=1), np.sort(np.abs(sides), axis=1)
    on_wall = (others[:, 0] < 0.1) & (others[:, 1] > 1.5)
    assert (others[:, 0] < 0.1).mean() > 0.9
    sun = np.array([-0.5, 0.5, np.sqrt(0.5)])
    light = 0.5 + 0.5 * np.maximum(seen.normals[row, column] @ sun, 0.0)
    plain = picture[row, column] / light[:, np.newaxis]
    for one, of, colour in zip(own[on_wall], side[on_wall], plain[on_wall]):
        walls.setdefault((int(one), int(of)), []).append(colour)
    row, column = np.nonzero(seen.kind == ROOF)
    own, sides = building_at(seen.lat_deg[row, column], seen.lon_deg[row, column])
    assert (sides.min(axis=1) > -0.1).all()
    inside = sides.min(axis=1) > 1.5
    for one, colour in zip(own[inside], picture[row, column][inside]):
        roofs.setdefault(int(one), []).append(colour)
    return walls, roofs


def test_walls_of_the_embedded_world_are_painted_alike_from_wherever_they_are_seen(town):
    pictures = [walls_seen(written(town, index), seen) for index, seen in enumerate(town[2])]
    for walls, roofs in pictures:
        assert len(walls) > 10
        unlike = []
        for (building, _), colours in walls.items():
            wall = np.median(colours, axis=0)
            # One plain colour, but for rounding.
            assert np.abs(colours - wall).max() <= 2.0
            if building in roofs:
                unlike.append(np.abs(wall - np.median(roofs[building], axis=0)).max() > 8)
        assert np.mean(unlike) > 0.8
    (south, _), (west, _) = pictures
    both = [one for one in south if one in west]
    assert len(both) >= 3
    for one in both:
        np.testing.assert_allclose(np.median(south[one], axis=0), np.median(west[one], axis=0), atol=2.0)


def test_walls_are_painted_in_images_of_all_map_types_and_roofs_are_the_imagerys(town):
    folder, made, (seen, _) = town
    source = open_source("world")
    np.testing.assert_array_equal(written(town, 0), picture(made, source).pixels[..., :3])
    walls = seen.kind == WALL
    np.testing.assert_array_equal(written(town, 0)[walls], written(town, 0, "roadmap")[walls])
    assert (written(town, 0) != written(town, 0, "roadmap")).any(axis=2)[seen.kind == ROOF].mean() > 0.9
    with (folder / "satellite" / "meta_data.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[0]["facade_share"]) == pytest.approx(seen.steep.mean())
    assert seen.steep[walls].all()
    assert not seen.steep[seen.kind == ROOF].any()


def test_houses_are_classes_and_instances_that_are_not_listed(town):
    folder, made, pictures = town
    with (folder / "instances.csv").open() as file:
        assert file.read().splitlines() == ["id,class,layer,feature"]
    ids = {one["name"]: one["id"] for one in json.loads((folder / "classes.json").read_text())["classes"]}
    for name, seen in zip(made.names, pictures):
        classes, instances = (
            gdal.Open(str(folder / product / f"{name}.tif")).ReadAsArray() for product in ("classes", "instances")
        )
        np.testing.assert_array_equal(classes == ids["roof"], seen.kind == ROOF)
        np.testing.assert_array_equal(classes == ids["wall"], seen.kind == WALL)
        np.testing.assert_array_equal(instances, seen.instance)
        assert instances.dtype == np.uint32
    # Houses that both captures see.
    assert len(np.intersect1d(*(one.instance[one.kind == ROOF] for one in pictures))) > 3


def test_captures_that_go_on_give_houses_the_same_numbers(town, tmp_path):
    folder, made, _ = town
    source = open_source("world")
    _houses.cache_clear()
    capture(made, source, tmp_path, only=[1])
    capture(made, source, tmp_path, resume=True, workers=2)
    for product in ("satellite", "classes", "instances"):
        for name in made.names:
            path = f"{product}/{name}.tif"
            assert (tmp_path / path).read_bytes() == (folder / path).read_bytes(), path


def test_the_surface_seen_from_above_has_the_houses(town):
    _, made, (seen, _) = town
    roofs = (seen.kind == ROOF) & (np.roll(seen.kind, 2, axis=0) == ROOF) & (np.roll(seen.kind, -2, axis=0) == ROOF)
    roofs &= (np.roll(seen.kind, 2, axis=1) == ROOF) & (np.roll(seen.kind, -2, axis=1) == ROOF)
    lat, lon = seen.lat_deg[roofs], seen.lon_deg[roofs]
    surface = seen_surface(made.relief.heights).surface(lat, lon)
    off = surface.heights(*surface.position(lat, lon)) - seen.height_m[roofs]
    # But for cells across ridges and eaves.
    assert np.percentile(np.abs(off), 90) < 0.01
    assert np.abs(off).max() < 8.0
    assert roofs.sum() > 5_000


def test_edges_of_roofs_are_straight(town):
    """Pixels of a roof are those between the lines through the pixels of its corners."""
    _, made, (seen, _) = town
    tracing = made.views.tracing(0)
    corners = tracing.faces.triangles(seen.lat_deg, seen.lon_deg)
    camera, right, top, axis = axes(made)
    towards = corners.corners_m - camera
    depth = towards @ axis
    width, height = made.frames.largest_px
    tan_x, tan_y = made.mission.camera.half_tangents
    x = width / 2.0 * (1.0 + towards @ right / depth / tan_x)
    y = height / 2.0 * (1.0 - towards @ top / depth / tan_y)
    checked = 0
    for number in np.unique(corners.instance[corners.kind == ROOF]):
        own = (corners.instance == number) & (corners.kind == ROOF)
        if (x[own] < 0).any() or (x[own] > width).any() or (y[own] < 0).any() or (y[own] > height).any():
            continue
        inside = np.zeros((height, width), bool)
        column, row = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        for at_x, at_y in zip(x[own], y[own]):
            turns = [
                (at_x[k - 2] - at_x[k]) * (row - at_y[k]) - (at_y[k - 2] - at_y[k]) * (column - at_x[k])
                for k in range(3)
            ]
            inside |= (np.min(turns, axis=0) >= 0.0) | (np.max(turns, axis=0) <= 0.0)
        seen_roof = (seen.kind == ROOF) & (seen.instance == number)
        assert not (seen_roof & ~inside).any()
        # What stands before it hides the rest.
        checked += int((seen_roof == inside).all())
    assert checked > 3


@pytest.mark.parametrize(
    ("terrain", "own"),
    [
        ({"elevation": ("world",)}, True),
        ({"elevation": ("12",), "surface": ("World",)}, True),
        ({"elevation": ("world",), "surface": ("hills",)}, False),
        ({"elevation": ("hills", "world")}, False),
        ({"elevation": ("12",)}, False),
    ],
)
def test_the_worlds_houses_stand_where_it_is_what_cameras_see_first(files, terrain, own):
    terrain = {part: tuple(files.get(one, one) for one in names) for part, names in terrain.items()}
    mission = Mission(Points(((*TOWN, 50.0),)), 50.0, source="world", **terrain)
    assert (mission_heights(mission).faces is not NO_FACES) == own


def test_the_worlds_houses_are_raised_with_its_heights():
    def corners(**terrain):
        mission = Mission(Points(((*TOWN, 50.0),)), 50.0, elevation=("world",), **terrain)
        faces = mission_heights(mission).faces
        assert (faces.count, faces.listed) == (1 << 29, 0)
        return faces.triangles(TOWN[0] + np.array([-0.001, 0.001]), TOWN[1] + np.array([-0.001, 0.001])).corners_m

    plain, raised = corners(), corners(vertical_datum="EGM96", height_offset_m=7.0, height_unit="ft")
    lon, lat, height = GEOCENTRIC.transform(*plain.reshape(-1, 3).T, direction="INVERSE")
    other_lon, other_lat, higher = GEOCENTRIC.transform(*raised.reshape(-1, 3).T, direction="INVERSE")
    np.testing.assert_allclose([other_lon, other_lat], [lon, lat], rtol=0.0, atol=1e-9)
    geoid = pyproj.Transformer.from_crs("EPSG:4326+5773", 4979, always_xy=True).transform(lon, lat, np.zeros(len(lat)))
    np.testing.assert_allclose(higher - height, 7.0 + geoid[2], rtol=0.0, atol=0.01)


def test_what_lies_beyond_the_model_is_no_ground(files):
    made, source = one(files, x=560.0, y=300.0, yaw_deg=90.0, tilt_deg=30.0)
    shown = picture(made, source)
    assert 0.3 < shown.unmapped_share < 0.9
    assert shown.sky_share == 0.0
    assert (shown.pixels[..., 3] == 0).mean() == pytest.approx(shown.unmapped_share)


@pytest.mark.parametrize("code", [32618, 3857, 4326])
def test_rings_end_with_the_model_and_show_the_same(files, tmp_path, code):
    """A view to the horizon from beside a small model, over its own reference system, the map and degrees."""
    x, y = grid_points()
    to_code = pyproj.Transformer.from_crs(32618, code, always_xy=True)
    west, north = to_code.transform(WEST, NORTH)
    cell = 2e-5 if code == 4326 else CELL
    path = rasters.write(
        tmp_path / "model.tif", hills(x, y)[np.newaxis], (west, cell, 0.0, north, 0.0, -cell), code,
        data_type=gdal.GDT_Float32,
    )  # fmt: skip
    relief = open_relief([str(path)])
    column, row = np.array([(0.1, 0.1), (0.5, 9.0), (0.0, 0.0), (SIDE, 0.0), (0.0, SIDE), (SIDE, SIDE)]).T
    to_degrees = pyproj.Transformer.from_crs(code, 4326, always_xy=True)
    lon, lat = to_degrees.transform(west + column * cell, north - row * cell)
    for place in ((lat[0], lon[0]), (lat[1], lon[1])):
        away = pyproj.Geod(ellps="WGS84").inv(*np.broadcast_arrays(place[1], place[0], lon, lat))[2]
        assert away.max() < relief.end_m(*place) < 1.1 * away.max() + 2.0 * CELL
    poses = Poses(*(np.array([value]) for value in (lat[1], lon[1], 120.0, 135.0, 80.0, 0.0)))
    scene = ImageGeometry(Camera(78.8, 4 / 3), 160, 120, poses)
    ended = Tracing(scene, 180.0, relief, 40.0, 0.02)
    endless = Tracing(scene, 180.0, Endless(relief), 40.0, 0.02)
    assert len(list(ended.rings())) < len(list(endless.rings()))
    assert 0.05 < np.isfinite(ended.depth_m).mean() < 0.9
    assert np.mean(np.isnan(ended.depth_m) != np.isnan(endless.depth_m)) < 1e-3
    # Paths are fitted over other lengths, each within half the bound; rays that graze the ground move farther along it.
    off = np.abs(ended.depth_m / endless.depth_m - 1.0)
    assert np.nanquantile(off, 0.99) < 0.02 * float(np.linalg.norm(ended.rays.per_x))
    assert np.nanmedian(off) < 1e-5


@pytest.mark.parametrize("code", [4326, 3857])
def test_models_around_the_earth_end_nowhere(tmp_path, code):
    """The corners of such a model are near each other, and may be near the camera."""
    west, north = pyproj.Transformer.from_crs(4326, code, always_xy=True).transform(-180.0, 61.0)
    cell = -2.0 * west / 720
    path = rasters.write(
        tmp_path / "band.tif", np.zeros((1, 4, 720)), (west, cell, 0.0, north, 0.0, -cell), code,
        data_type=gdal.GDT_Float32,
    )  # fmt: skip
    assert open_relief([str(path)]).end_m(60.5, 179.9) > 700_000.0


class Endless:
    """Relief that does not say where it ends."""

    def __init__(self, relief):
        self.surface, self.cell_m = relief.surface, relief.cell_m

    def end_m(self, *_):
        return np.inf


def test_the_sky_is_behind_the_relief(files):
    made, source = one(files, "tower", tilt_deg=75.0, agl=25.0, y=380.0, upsample=True, image_px=160)
    shown = picture(made, source)
    assert shown.sky_share > 0.15
    # The tower stands up against it.
    seen = sighting(made, 0, made.frames.largest_px)
    assert np.nanmax(seen.height_m) > hills(*TOWER) + 0.95 * HIGH


def box():
    lon, lat = TO_DEGREES.transform([WEST + 240.0, WEST + 360.0], [NORTH - 240.0, NORTH - 340.0])
    return Box(lat[0], lon[0], lat[1], lon[1])


def test_a_capture_over_relief_is_whole(files, tmp_path):
    mission = Mission(
        box(),
        70.0,
        elevation=(files["tower"],),
        source=files["photo"],
        tilt_deg=25.0,
        overlap_along=0.3,
        overlap_across=0.3,
        image_px=200,
        products=("depth", "points", "normals", "facades"),
        map_types=("satellite", "roadmap"),
    )
    source = open_source(mission.imagery.source, as_stored=True)
    made = plan(mission, source.grid, mission_heights(mission))
    result = capture(made, source, tmp_path / "out")
    assert not result.failed
    assert result.written == 2 * len(made)
    with (tmp_path / "out" / "satellite" / "meta_data.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["height_m"]) for row in rows] == pytest.approx(made.height_m)
    assert np.array([float(row["agl_m"]) for row in rows]) == pytest.approx(70.0)
    assert max(float(row["facade_share"]) for row in rows) > 0.0
    planned = (tmp_path / "out" / "plan.csv").read_text().splitlines()
    at = planned[0].split(",").index("height_m")
    assert [float(line.split(",")[at]) for line in planned[1:]] == pytest.approx(made.height_m)
    name = made.names[0]
    depth = gdal.Open(str(tmp_path / "out" / "depth" / f"{name}.tif"))
    assert depth.GetRasterBand(1).DataType == gdal.GDT_Float32
    seen = sighting(made, 0, made.frames.largest_px)
    np.testing.assert_array_equal(depth.ReadAsArray(), seen.depth_m.astype(np.float32))
    points = gdal.Open(str(tmp_path / "out" / "points" / f"{name}.tif"))
    assert points.GetRasterBand(1).DataType == gdal.GDT_Float64
    np.testing.assert_array_equal(points.ReadAsArray()[2], seen.height_m)
    np.testing.assert_array_equal(points.ReadAsArray()[0], seen.lon_deg)
    normals = gdal.Open(str(tmp_path / "out" / "normals" / f"{name}.tif")).ReadAsArray()
    assert np.nanmax(np.abs(np.linalg.norm(normals, axis=0) - 1.0)) < 1e-6
    faces = gdal.Open(str(tmp_path / "out" / "facades" / f"{name}.tif")).ReadAsArray()
    assert set(np.unique(faces)) <= {0, 255}
    # Ground control points lie on the relief, and GDAL reads their heights.
    picture_file = gdal.Open(str(tmp_path / "out" / "satellite" / f"{name}.tif"))
    heights = [point.GCPZ for point in picture_file.GetGCPs()]
    assert np.ptp(heights) > 1.0
    for point in picture_file.GetGCPs()[::5]:
        x, y = TO_UTM.transform(point.GCPX, point.GCPY)
        assert pytest.approx(with_tower(x - WEST, NORTH - y), abs=HIGH) == point.GCPZ
    told = json.loads((tmp_path / "out" / "mission.json").read_text())
    assert told["terrain"]["elevation"] == [files["tower"]]
    assert Mission.load(tmp_path / "out" / "mission.json") == made.mission.replace(crs=told["imagery"]["crs"])


def test_a_capture_that_goes_on_leaves_the_same_files(files, tmp_path):
    mission = Mission(
        box(), 70.0, elevation=(files["tower"],), source=files["photo"], image_px=120, products=("depth",)
    )
    source = open_source(mission.imagery.source, as_stored=True)
    made = plan(mission, source.grid, mission_heights(mission))
    capture(made, source, tmp_path / "whole")
    stopped = capture(made, source, tmp_path / "parts", only=[0, 1])
    assert stopped.written == 2
    again = plan(mission, source.grid, mission_heights(mission))
    capture(again, source, tmp_path / "parts", resume=True, workers=1)
    for path in sorted((tmp_path / "whole").rglob("*.tif")):
        other = tmp_path / "parts" / path.relative_to(tmp_path / "whole")
        assert other.read_bytes() == path.read_bytes(), path.name


@pytest.mark.parametrize("tilt", [0.0, 50.0])
def test_each_image_is_traced_once_each_tile_fetched_once_and_boxes_hold_what_is_shown(
    files, tmp_path, tilt, monkeypatch
):
    traced = []
    image_hits = Surface.image_hits

    def watched(self, *arguments, **options):
        traced.append(self)
        return image_hits(self, *arguments, **options)

    monkeypatch.setattr(Surface, "image_hits", watched)
    monkeypatch.setattr(tracing, "compile_code", lambda: None)
    photo, tower = files["photo"], files["tower"]
    mission = Mission(box(), 60.0, source=photo, elevation=(tower,), tilt_deg=tilt, upsample=True)
    source = open_source(files["photo"])
    made = plan(mission, source.grid, mission_heights(mission))
    fetched = Counter()
    fetch = source.fetch
    source.fetch = lambda map_type, window: fetched.update([window]) or fetch(map_type, window)
    result = capture(made, source, tmp_path / "run", workers=2)
    assert result.unique_parts == len(fetched)
    assert set(fetched.values()) == {1}
    # At these distances, relief is one surface.
    assert len(traced) == len(made) > 4
    for index in range(len(made)):
        west, north, east, south = made.views.box(index)
        for zoom, column, row in Shot(made, index).tiles:
            world = made.grid.world_px(zoom) / made.grid.tile_px
            assert west * world - 1.0 <= column <= east * world
            assert north * world - 1.0 <= row <= south * world


def test_photographs_say_the_cameras_altitude(files, tmp_path):
    mission = Mission(box(), 70.0, elevation=(files["hills"],), source=files["photo"], image_px=120, image_format="jpg")
    source = open_source(mission.imagery.source)
    made = plan(mission, source.grid, mission_heights(mission))
    capture(made, source, tmp_path)
    for index in (0, len(made) - 1):
        with Image.open(tmp_path / "satellite" / f"{made.names[index]}.jpg") as image:
            altitude = image.getexif().get_ifd(0x8825)[6]
        assert float(altitude) == pytest.approx(made.height_m[index], abs=1e-3)
    lines = (tmp_path / "satellite" / "geo.txt").read_text().splitlines()[1:]
    assert [float(line.split()[3]) for line in lines] == pytest.approx(made.height_m, abs=6e-4)


@pytest.mark.parametrize("tilt", [0.0, 40.0])
def test_products_of_level_ground(tmp_path, tilt):
    area = Box(40.001, 10.0, 40.0, 10.001)
    mission = Mission(
        area,
        100.0,
        ground_height_m=12.0,
        tilt_deg=tilt,
        image_px=200,
        products=("depth", "points", "normals"),
    )
    source = open_source("world")
    made = plan(mission, source.grid)
    capture(made, source, tmp_path, only=[0])
    name = made.names[0]
    depth = gdal.Open(str(tmp_path / "depth" / f"{name}.tif")).ReadAsArray()
    points = gdal.Open(str(tmp_path / "points" / f"{name}.tif")).ReadAsArray()
    shape = gdal.Open(str(tmp_path / "satellite" / f"{name}.tif"))
    assert depth.shape == (shape.RasterYSize, shape.RasterXSize)
    np.testing.assert_allclose(points[2], 12.0, rtol=1e-6)
    ends = np.stack(GEOCENTRIC.transform(*points.reshape(3, -1)), axis=-1)
    camera, _, _, axis = axes(made)
    np.testing.assert_allclose(depth.ravel(), (ends - camera) @ axis, rtol=1e-6)
    if not tilt:
        np.testing.assert_allclose(depth, 100.0, rtol=0.0, atol=0.01)


def test_a_plan_over_level_ground_has_no_rays_over_relief():
    made = plan(Mission(Box(40.001, 10.0, 40.0, 10.001), 100.0), open_source("world").grid)
    with pytest.raises(InvalidInput, match="the ground is level"):
        made.views.tracing(0)


def test_the_report_says_what_level_ground_is_off_by_and_that_rays_keep_their_bound(files):
    made, source = one(files, "tower", x=330.0, y=330.0)
    found = measure(made, source, quick=True)
    level, *rays = found.stages["pixels"]
    assert level.method.name == "level ground"
    # A pinhole that looks straight down: what is h high stands farther out by f r (1 / (H - h) - 1 / H).
    width, height = made.frames.largest_px
    high = float(made.height_m[0] - made.ground_m[0])
    tan_x, tan_y = made.mission.camera.half_tangents
    step = max(width, height) // 48
    row, column = np.mgrid[0:height:step, 0:width:step]
    x = ((column + 0.5) / width * 2.0 - 1.0) * tan_x
    y = ((row + 0.5) / height * 2.0 - 1.0) * tan_y
    rise = with_tower(330.0 + x * high, 330.0 + y * high) - float(made.ground_m[0])
    wanted = np.hypot(x * width / 2.0 / tan_x, y * height / 2.0 / tan_y) * (high / (high - rise) - 1.0)
    assert level.error_px == pytest.approx(np.abs(wanted).max(), rel=0.05)
    assert level.error_px > 10.0
    assert [one.chosen for one in rays].count(True) == 1
    if uses_numba():
        # Numpy's rays beside the compiled ones, in the same block of the report and nowhere else.
        assert any(one.method.name == NUMPY for one in rays)
        with without_numba():
            assert not uses_numba()
        assert uses_numba()
    for one_of in rays:
        assert one_of.error_px <= one_of.method.bound_px
        assert one_of.seconds is not None
    assert found.keeps_bounds


def test_from_high_up_cells_are_as_large_as_what_pixels_show():
    """A hundred kilometres up, cells of a quarter of a metre would be billions, and none of them seen."""
    asked = []

    class Fine:
        title, attribution = "fine", ""

        def surface(self, lat_deg, lon_deg, cell_m=0.0):
            asked.append(cell_m)
            grid = PixelGrid()
            u, v = grid.plane.forward(lat_deg, lon_deg)
            left, top = (int(at.min() * grid.world_px(6)) - 1 for at in (u, v))
            rows, columns = (int(np.ptp(at) * grid.world_px(6)) + 4 for at in (v, u))
            return Surface(grid, 6, left, top, np.full((rows, columns), 100.0))

        def end_m(self, *_):
            return np.inf

        def cell_m(self, *_):
            return 0.25

    pose = Poses(*(np.array([value]) for value in (45.0, 7.0, 1e5, 0.0, 0.0, 0.0)))
    tracing = Tracing(ImageGeometry(Camera(78.8, 4 / 3), 64, 48, pose), 1e5, Fine(), 0.0, 0.02)
    assert tracing.depth_m == pytest.approx(1e5 - 100.0, rel=2e-2)
    pixel_m = 1e5 * Camera(78.8, 4 / 3).ground_size_m(1.0)[0] / 64
    assert 20.0 < min(asked) <= max(asked) < pixel_m


@pytest.mark.parametrize("heights", ["hills", "tower"])
def test_the_place_of_an_image_is_where_its_axis_first_meets_the_relief(files, heights):
    made, _ = one(files, heights, x=330.0, y=330.0, tilt_deg=25.0, yaw_deg=200.0)
    lat, lon = (float(angle[0]) for angle in made.frame_centres)
    camera, right, top, axis = axes(made)
    east, north = TO_UTM.transform(lon, lat)
    j, i = (east - WEST) / CELL - 0.5, (NORTH - north) / CELL - 0.5
    z = (hills if heights == "hills" else with_tower)(*grid_points()).astype(np.float32).astype(float)
    j0, i0 = int(j), int(i)
    (a, b), (c, d) = z[i0 : i0 + 2, j0 : j0 + 2]
    height = (a * (1 - j + j0) + b * (j - j0)) * (1 - i + i0) + (c * (1 - j + j0) + d * (j - j0)) * (i - i0)
    off = np.array(GEOCENTRIC.transform(lon, lat, height)) - camera
    assert off @ axis > 50.0
    assert np.abs([off @ right, off @ top]).max() < 2e-3
    # Nothing of the relief stands between: the axis is above it all the way.
    along = np.linspace(0.0, 0.999, 400)[:, np.newaxis] * off + camera
    lons, lats, heights_m = GEOCENTRIC.transform(*along.T, direction="INVERSE")
    x, y = TO_UTM.transform(lons, lats)
    below = (hills if heights == "hills" else with_tower)(x - WEST, NORTH - y)
    assert (heights_m > below - 0.1).all()
