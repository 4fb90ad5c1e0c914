"""Walls with the textures of a CityJSON file: pixels beside SciPy's at the points that they see."""

from __future__ import annotations

import json
from contextlib import nullcontext

import numpy as np
import pyproj
import pytest
from osgeo import gdal
from PIL import Image
from scipy.ndimage import map_coordinates
from terrainav.core.external import compiling
from terrainav.core.faces import appearance
from terrainav.core.geodesy.triangles import ROOF, WALL, Triangles
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.products import sighting
from terrainav.core.picture.shot import draw, make_shot, picture_parts

from tests.core.geodesy.boxes import LAT, LON, METRE_LAT, METRE_LON
from tests.support import rasters

GROUND_M, HIGH_M, WIDE_M, DEEP_M = 100.0, 30.0, 20.0, 15.0
SIDE = 600
UTM = pyproj.Transformer.from_crs(4326, 32632, always_xy=True)
EAST, NORTH = (float(value) for value in UTM.transform(LON - 10.0 * METRE_LON, LAT + 20.0 * METRE_LAT))
BOX = [[[0, 3, 2, 1]], [[4, 5, 6, 7]], [[0, 1, 5, 4]], [[1, 2, 6, 5]], [[2, 3, 7, 6]], [[3, 0, 4, 7]]]
SOUTH, EASTERN = 2, 3


@pytest.fixture
def files(tmp_path):
    """Grey imagery and level heights."""
    per = METRE_LON, METRE_LAT
    west, north = LON - SIDE / 2 * per[0], LAT + SIDE / 2 * per[1]
    photo = np.full((3, SIDE, SIDE), 77)
    rasters.write(tmp_path / "photo.tif", photo, (west, per[0], 0, north, 0, -per[1]), 4326)
    coarse = (west, 2 * per[0], 0, north, 0, -2 * per[1])
    heights = np.full((1, SIDE // 2, SIDE // 2), GROUND_M)
    rasters.write(tmp_path / "flat.tif", heights, coarse, 4326, data_type=gdal.GDT_Float32)
    return tmp_path


def city(folder, pixels, places, image="wall.png", sides=(SOUTH,), rings=None):
    """A box whose sides have a texture; ``places`` of the lower left, lower right, upper right and upper left."""
    if pixels is not None:
        Image.fromarray(pixels).save(folder / "wall.png")
    ring = [(0, 0), (WIDE_M, 0), (WIDE_M, DEEP_M), (0, DEEP_M)]
    values = [[rings or [[0, 0, 1, 2, 3]]] if side in sides else [[[None]]] for side in range(6)]
    values = [value[0] for value in values]
    solid = {"type": "Solid", "lod": 2, "boundaries": [BOX], "texture": {"photo": {"values": [values]}}}
    content = {
        "type": "CityJSON",
        "version": "2.0",
        "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/32632"},
        "transform": {"scale": [1.0, 1.0, 1.0], "translate": [EAST, NORTH, 0.0]},
        "CityObjects": {"house": {"type": "Building", "geometry": [solid]}},
        "vertices": [[x, y, z] for z in (0, HIGH_M) for x, y in ring],
        "appearance": {"textures": [{"type": "PNG", "image": image}], "vertices-texture": places},
    }
    (folder / "city.json").write_text(json.dumps(content))
    return str(folder / "city.json")


def pictured(files, path, agl=60.0, south_m=40.0, image_px=240, is_compiled=False, **values):
    """Image of the house from the south, where its pixels lie on the wall, in metres east and up, and the plan."""
    mission = Mission(
        Points(((LAT - south_m * METRE_LAT, LON, agl),)),
        agl,
        elevation=(str(files / "flat.tif"),),
        source=str(files / "photo.tif"),
        buildings=(path,),
        image_px=image_px,
        tilt_deg=50.0,
        upsample=True,
        **values,
    )
    source = open_source(mission.imagery.source)
    made = plan(mission, source.grid, mission_heights(mission))
    parts = picture_parts(made, source, 0)
    with nullcontext() if is_compiled else compiling.without_numba():
        drawn = draw(make_shot(made, 0), parts, {part.window: source.fetch("satellite", part.window) for part in parts})
        seen = sighting(made, 0, made.views.size_px(0))
    east, north = UTM.transform(seen.lon_deg, seen.lat_deg)
    return drawn.pixels, seen, (east - EAST, north - NORTH, seen.height_m - GROUND_M), made


def south_wall(seen, at):
    """Pixels of the south wall above the ground."""
    return (seen.kind == WALL) & (np.abs(at[1]) < 0.01) & (at[2] > 0.05)


WHOLE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]


@pytest.mark.parametrize("is_compiled", [False, True])
def test_walls_show_their_texture_pixel_by_pixel(files, is_compiled):
    if is_compiled and not compiling.uses_numba():
        pytest.skip("numba is not installed")
    pixels = np.random.default_rng(3).integers(0, 256, (6, 4, 3), np.uint8)
    drawn, seen, at, _ = pictured(files, city(files, pixels, WHOLE), is_compiled=is_compiled)
    wall = south_wall(seen, at)
    assert wall.sum() > 2000
    column, row = at[0][wall] / WIDE_M * 4 - 0.5, (1.0 - at[2][wall] / HIGH_M) * 6 - 0.5
    for band in range(3):
        wanted = map_coordinates(pixels[..., band].astype(float), [row, column], order=1, mode="nearest")
        assert drawn[wall][:, band].astype(float) == pytest.approx(wanted, abs=1.0)


def test_both_codes_paint_the_same_pixels(files):
    if not compiling.uses_numba():
        pytest.skip("numba is not installed")
    pixels = np.random.default_rng(4).integers(0, 256, (300, 200, 3), np.uint8)
    path = city(files, pixels, WHOLE)
    one, other = (pictured(files, path, is_compiled=is_compiled)[0] for is_compiled in (False, True))
    assert np.array_equal(one, other)


def test_a_checkerboard_has_its_colours_and_greys_where_it_is_finer_than_pixels(files):
    def board(cells):
        rows, columns = np.mgrid[:960, :640]
        light = (rows // (960 // cells[1]) + columns // (640 // cells[0])) % 2 == 1
        return np.where(light[..., None], np.uint8(250), np.uint8(10)).repeat(3, axis=2)

    # Cells of 5 m; the first row of pixels is the top.
    drawn, seen, at, _ = pictured(files, city(files, board((4, 6)), WHOLE))
    wall = south_wall(seen, at)
    across, down = at[0][wall], HIGH_M - at[2][wall]
    inside = (np.abs(across % 5 - 2.5) < 1.5) & (np.abs(down % 5 - 2.5) < 1.5)
    light = (across // 5 + down // 5) % 2 == 1
    assert inside.sum() > 500
    assert (drawn[wall][inside] == np.where(light[inside], 250, 10)[:, np.newaxis]).all()
    # Cells of 3 cm.
    drawn, seen, at, _ = pictured(files, city(files, board((640, 960)), WHOLE))
    wall = south_wall(seen, at)
    assert drawn[wall].astype(float) == pytest.approx(130.0, abs=2.0)


def test_textures_are_repeated_beyond_their_edges(files):
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[:, 4:] = (200, 100, 50)
    drawn, seen, at, _ = pictured(files, city(files, pixels, [[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]]))
    wall = south_wall(seen, at)
    across = at[0][wall] % 10.0
    colours = drawn[wall]
    assert (colours[np.abs(across - 2.5) < 1.0] == 0).all()
    assert (colours[np.abs(across - 7.5) < 1.0] == (200, 100, 50)).all()


def test_only_walls_with_a_texture_have_it(files):
    pixels = np.full((4, 4, 3), (0, 255, 0), np.uint8)
    path = city(files, pixels, WHOLE, sides=(EASTERN, 1))
    drawn, seen, at, made = pictured(files, path)
    green = (drawn == (0, 255, 0)).all(axis=2)
    assert not green[south_wall(seen, at)].any()
    # The roof has one, too, and shows the imagery.
    assert (drawn[seen.kind == ROOF] == 77).all()
    assert not made.relief.heights.faces.warnings[1:]
    for side in ((SOUTH, EASTERN), (SOUTH,)):
        drawn, seen, at, _ = pictured(files, city(files, pixels, WHOLE, sides=side))
        assert (drawn[south_wall(seen, at)] == (0, 255, 0)).all()


def test_missing_textures_are_plain_walls_and_counted(files):
    drawn, seen, at, made = pictured(files, city(files, None, WHOLE, image="gone.png"))
    assert len(np.unique(drawn[south_wall(seen, at)], axis=0)) == 1
    assert any("1 of 1 textures are missing" in str(one) for one in made.relief.heights.faces.warnings)
    triangles = made.relief.heights.faces.triangles(np.array([LAT]), np.array([LON]))
    assert triangles.skin is None


def test_textures_whose_places_do_not_fit_are_one_colour(files):
    pixels = np.zeros((4, 4, 3), np.uint8)
    pixels[:2] = 200
    for places, rings in ((WHOLE, [[0, 0, 1, 2]]), ([*WHOLE[:3], ["x", 1.0]], [[0, 0, 1, 2, 3]])):
        drawn, seen, at, made = pictured(files, city(files, pixels, places, rings=rings))
        assert len(np.unique(drawn[south_wall(seen, at)], axis=0)) == 1
        assert any("1 surfaces have one colour" in str(one) for one in made.relief.heights.faces.warnings)


def test_faces_with_and_without_textures_are_joined_and_taken(files):
    pixels = np.full((4, 4, 3), 9, np.uint8)
    textured = pictured(files, city(files, pixels, WHOLE))[3].relief.heights.faces
    around = np.array([LAT - 0.01, LAT + 0.01]), np.array([LON - 0.01, LON + 0.01])
    one = textured.triangles(*around)
    plain = Triangles(one.corners_m, one.kind, one.instance, one.colour, one.shows_imagery)
    both = Triangles.joined([plain, one, one])
    assert len(both.skin.textures) == 1
    assert both.skin.texture.tolist() == [-1] * len(one) + 2 * one.skin.texture.tolist()
    part = both.take(np.arange(len(one), 2 * len(one)))
    assert np.array_equal(part.skin.places, one.skin.places)
    assert Triangles.joined([plain, plain]).skin is None


def test_memory_for_textures_is_bounded(files, monkeypatch):
    monkeypatch.setattr(appearance, "_MOST_BYTES", 30_000)
    kept = appearance._Kept()

    def texture(name):
        return appearance.ImageTexture(str(files / name), 0)

    for k in range(5):
        Image.fromarray(np.full((64, 64, 3), k, np.uint8)).save(files / f"{k}.png")
        levels = kept.levels(texture(f"{k}.png"))
        assert [one.shape[0] for one in levels] == [64, 32, 16, 8, 4, 2, 1]
        assert all((one == k).all() for one in levels)
    assert list(kept._levels) == [texture("4.png")]
    assert kept.levels(texture("gone.png")) == ()
    monkeypatch.setattr(appearance, "_MOST_SIDE_PX", 16)
    assert [one.shape[0] for one in kept.levels(texture("0.png"))] == [16, 8, 4, 2, 1]
