"""Pictures of buildings: colours of roofs and walls, products, and flights that keep clear of them."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest
from osgeo import gdal
from terrainav.core.elevation.heights import HeightOptions
from terrainav.core.elevation.layered import open_relief
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.triangles import NO_FACES, ROOF, WALL
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.estimate import building_warnings
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.relief.ground import Heights
from terrainav.core.mission.relief.roofed import RoofedElevation, seen_surface
from terrainav.core.mission.sunlight import mission_sun
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.painting import AMBIENT, sun_enu
from terrainav.core.picture.products import products, sighting
from terrainav.core.picture.shot import Shot, draw, make_shot, picture_parts

from tests.core.geodesy.boxes import LAT, LON, METRE_LAT, METRE_LON, Boxes
from tests.support import rasters

GROUND_M, HIGH_M = 100.0, 30.0
SIDE = 1200


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Level heights, and imagery of 0.5 m that tells positions."""
    folder = tmp_path_factory.mktemp("town")
    per = METRE_LON / 2.0, METRE_LAT / 2.0
    west, north = LON - SIDE / 2 * per[0], LAT + SIDE / 2 * per[1]
    y, x = np.mgrid[:SIDE, :SIDE]
    colours = np.stack([x / 5.0, y / 5.0, np.full((SIDE, SIDE), 90.0)])
    photo = rasters.write(folder / "photo.tif", np.rint(colours), (west, per[0], 0, north, 0, -per[1]), 4326)
    heights = np.full((1, SIDE // 4, SIDE // 4), GROUND_M)
    coarse = (west, 4 * per[0], 0, north, 0, -4 * per[1])
    flat = rasters.write(folder / "flat.tif", heights, coarse, 4326, data_type=gdal.GDT_Float32)
    return str(photo), str(flat)


@pytest.fixture
def tower():
    return Boxes([(-10.0, 20.0, 20.0, 15.0, GROUND_M, GROUND_M + HIGH_M)])


def planned(files, faces, at=(0.0, -30.0), agl=90.0, **values):
    photo, flat = files
    place = LAT + at[1] * METRE_LAT, LON + at[0] * METRE_LON, agl
    values = {"elevation": (flat,), "source": photo, "image_px": 240, "tilt_deg": 40.0, **values}
    mission = Mission(Points((place,)), agl, **values)
    source = open_source(mission.imagery.source)
    found = mission_heights(mission)
    return plan(mission, source.grid, Heights(found.ground, found.surface, faces)), source


def picture(made, source):
    parts = picture_parts(made, source, 0)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    return draw(make_shot(made, 0), parts, pixels)


def size_of(made):
    return made.views.size_px(0)


def test_roofs_have_the_colours_of_the_imagery_where_they_are(files, tower):
    made, source = planned(files, tower)
    drawn = picture(made, source)
    seen = sighting(made, 0, size_of(made))
    roof = seen.kind == ROOF
    assert roof.sum() > 50
    x = (seen.lon_deg[roof] - LON) / METRE_LON * 2.0 + SIDE / 2
    y = (LAT - seen.lat_deg[roof]) / METRE_LAT * 2.0 + SIDE / 2
    assert drawn.pixels[roof][:, 0] == pytest.approx(x / 5.0, abs=2.0)
    assert drawn.pixels[roof][:, 1] == pytest.approx(y / 5.0, abs=2.0)


def test_walls_have_their_colour_in_the_light(files, tower):
    made, source = planned(files, tower)
    drawn, seen = picture(made, source), sighting(made, 0, size_of(made))
    walls = seen.kind == WALL
    assert walls.sum() > 50
    light = AMBIENT + (1.0 - AMBIENT) * np.maximum(seen.normals[walls] @ sun_enu(made, 0), 0.0)
    wanted = tower.all.colour[0] * light[:, np.newaxis]
    assert drawn.pixels[walls] == pytest.approx(wanted, abs=1.0)
    assert drawn.facade_share == pytest.approx(walls.mean())
    # Seen from the south, with light from north-west: in the shade.
    assert drawn.pixels[walls].astype(float) == pytest.approx(
        np.tile(AMBIENT * tower.all.colour[0], (walls.sum(), 1)), abs=1.0
    )


def test_walls_are_lit_at_the_missions_time_and_by_day_only(files, tower):
    noon, _ = planned(files, tower, start="2024-06-21T11:30:00Z")
    night, _ = planned(files, tower, start="2024-06-21T23:30:00Z")
    plain, _ = planned(files, tower)
    east, north, up = sun_enu(noon, 0)
    assert north < -0.3
    assert up > 0.8
    assert abs(east) < 0.1
    assert np.array_equal(sun_enu(night, 0), sun_enu(plain, 0))
    assert sun_enu(plain, 0) == pytest.approx([-0.5, 0.5, 0.5**0.5])


def test_walls_face_the_sun_of_the_mission(files, tower):
    for text in ("30 160", "30 340"):
        made, source = planned(files, tower, sun=text)
        seen, sun = sighting(made, 0, size_of(made)), mission_sun(made.mission)
        walls = seen.kind == WALL
        normals = seen.normals[walls]
        direct = np.maximum(normals @ sun.enu, 0.0) / np.sin(np.radians(30.0))
        shares = 0.5 * sun.sky_share * (1.0 + normals[:, 2]) + (1.0 - sun.sky_share) * direct
        # sRGB (IEC 61966-2-1).
        value = tower.all.colour[0] / 255.0
        linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
        lit = np.minimum(linear * shares[:, np.newaxis], 1.0)
        wanted = 255.0 * np.where(lit <= 0.0031308, lit * 12.92, 1.055 * lit ** (1.0 / 2.4) - 0.055)
        assert picture(made, source).pixels[walls] == pytest.approx(wanted, abs=1.0)


def test_a_shot_keeps_what_its_picture_needs(files, tower):
    made, source = planned(files, tower)
    wanted = picture(made, source).pixels
    shot = make_shot(made, 0)
    shot.trace(with_sighting=True)
    assert "_tracing" not in shot.__dict__
    parts = picture_parts(made, source, 0)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    assert np.array_equal(draw(shot, parts, pixels).pixels, wanted)
    assert isinstance(shot, Shot)


def test_products_follow_the_walls(files, tower):
    made, _ = planned(files, tower, products=("depth", "points", "normals", "facades"))
    found = dict(products(made, 0, size_of(made)))
    walls = sighting(made, 0, size_of(made)).kind == WALL
    assert (found["facades"][..., 0] == 255 * walls).all()
    assert found["normals"][walls][:, :3] == pytest.approx(np.tile([0.0, -1.0, 0.0], (walls.sum(), 1)), abs=1e-3)
    heights = found["points"][walls][:, 2]
    assert heights.min() > GROUND_M - 0.01 + made.relief.lowest_m - GROUND_M
    assert (found["depth"][walls][:, 1] == 1.0).all()


def test_pictures_without_buildings_in_view_are_the_same(files):
    far = Boxes([(250.0, 250.0, 10.0, 10.0, GROUND_M, GROUND_M + 5.0)])
    (made, source), (bare, _) = planned(files, far), planned(files, NO_FACES)
    assert np.array_equal(picture(made, source).pixels, picture(bare, source).pixels)


@pytest.mark.parametrize(("agl", "at"), [(25.0, (0.0, 25.0)), (30.0, (0.0, 30.0))])
def test_a_camera_inside_a_building_is_refused(files, tower, agl, at):
    with pytest.raises(InvalidInput, match="rises to"):
        planned(files, tower, at=at, agl=agl)


def test_a_camera_above_a_roof_flies_and_one_below_a_roof_that_it_may_see_does_not(files, tower):
    planned(files, tower, at=(0.0, 27.0), agl=35.0)
    with pytest.raises(InvalidInput, match="may see there rises to 130"):
        planned(files, tower, at=(0.0, -30.0), agl=20.0)


def test_the_clearance_is_kept_from_roofs(files, tower):
    made, _ = planned(files, tower, at=(0.0, 27.0), agl=40.0, clearance_m=15.0)
    assert made.height_m[0] == pytest.approx(GROUND_M + HIGH_M + 15.0, abs=0.01)
    made, _ = planned(files, NO_FACES, at=(0.0, 27.0), agl=40.0, clearance_m=15.0)
    assert made.height_m[0] == pytest.approx(GROUND_M + 40.0, abs=0.01)


def test_ground_of_large_cells_is_raised_under_roofs_only(tower):
    level = open_relief(("100",), HeightOptions())
    lat, lon = LAT + np.array([-100.0, 100.0]) * METRE_LAT, LON + np.array([-100.0, 100.0]) * METRE_LON
    raised = RoofedElevation(level, tower).surface(lat, lon)

    def height(x, y):
        return float(
            raised.heights(*raised.position(LAT + np.array([y]) * METRE_LAT, LON + np.array([x]) * METRE_LON))[0]
        )

    for inside in ((0.0, 27.0), (-9.5, 20.5), (9.5, 34.5)):
        assert height(*inside) == pytest.approx(GROUND_M + HIGH_M, abs=0.01)
    for outside in ((0.0, 10.0), (-18.0, 27.0), (0.0, 44.0), (90.0, -90.0)):
        assert height(*outside) == pytest.approx(GROUND_M, abs=0.01)


@pytest.mark.parametrize(("elevation", "cell_m"), [("flat", 0.75), ("level", 3.0)])
def test_surfaces_seen_from_above_have_roofs_no_wider_than_they_are(files, tower, elevation, cell_m):
    found = open_relief((files[1] if elevation == "flat" else str(GROUND_M),), HeightOptions())
    lat, lon = LAT + np.array([-60.0, 60.0]) * METRE_LAT, LON + np.array([-60.0, 60.0]) * METRE_LON
    raised = seen_surface(Heights(found, found, tower)).surface(lat, lon)
    x, y = (at.ravel() for at in np.meshgrid(np.arange(-50.0, 50.0, 0.7), np.arange(-50.0, 50.0, 0.7)))
    heights = raised.heights(*raised.position(LAT + y * METRE_LAT, LON + x * METRE_LON))
    inside = np.minimum(10.0 - np.abs(x), 7.5 - np.abs(y - 27.5))
    aside = 1.5 * cell_m
    assert heights[inside > aside] == pytest.approx(GROUND_M + HIGH_M, abs=0.01)
    assert heights[inside < -aside] == pytest.approx(GROUND_M, abs=0.01)
    assert (inside > aside).sum() > 50


def test_buildings_on_level_ground_are_seen_by_camera_frames(files, tower):
    made, source = planned((files[0], str(GROUND_M)), tower)
    wanted, _ = planned(files, tower)
    assert not made.frames.on_map
    seen, other = (sighting(one, 0, size_of(one)) for one in (made, wanted))
    assert np.array_equal(seen.kind, other.kind)
    assert seen.depth_m == pytest.approx(other.depth_m, abs=0.05)
    assert (picture(made, source).pixels[seen.kind == WALL] > 0).any()


@pytest.mark.parametrize("elevation", ["100", None])
def test_buildings_elsewhere_leave_a_plan_with_figures(files, tmp_path, elevation):
    ring = [[LON + 1.0 + x, LAT + y] for x, y in ((0.0, 0.0), (1e-4, 0.0), (1e-4, 1e-4), (0.0, 0.0))]
    house = {"type": "Feature", "properties": {"height": 3}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
    path = tmp_path / "houses.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": [house]}))
    values = {"elevation": (elevation or files[1],), "buildings": (str(path),), "source": files[0], "image_px": 240}
    mission = Mission(Points(((LAT, LON, 90.0),)), 90.0, **values)
    made = plan(mission, open_source(files[0]).grid, mission_heights(mission))
    assert building_warnings(made) == ()
    # A field of heights that no file has is refused.
    with pytest.raises(InvalidInput, match="field 'tall' of heights: no file of buildings has it, but height") as said:
        mission_heights(mission.replace(building_height_field="tall"))
    assert said.value.field == "building_height_field"


def test_plans_go_to_other_processes_without_the_faces(files, tower):
    made, _ = planned(files, tower)
    heights, heights_m = made.relief.heights, made.relief.heights_m
    copy = pickle.loads(pickle.dumps(made))
    copy.relief.load(heights, heights_m)
    seen, again = (sighting(one, 0, size_of(made)) for one in (made, copy))
    assert all(np.array_equal(one, other, equal_nan=True) for one, other in zip(seen, again))


def test_images_state_the_credit_of_buildings(files, tower):
    tower.attribution = "© OpenStreetMap contributors"
    made, _ = planned(files, tower)
    assert made.relief.attribution == f"{made.relief.heights.ground.attribution}; © OpenStreetMap contributors"
