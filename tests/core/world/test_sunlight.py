"""Light of the sun on the synthetic world, compared with shadows that follow from geometry."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest
from pyproj import Geod, Transformer
from terrainav.core.camera.light import bytes_of_linear, linear_of_bytes
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import MERCATOR
from terrainav.core.geodesy.sun import SunDirection
from terrainav.core.imagery.opening import SourceOptions, named_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.sunlight import mission_sun
from terrainav.core.world import World, WorldSource
from terrainav.core.world import sunlight as light
from terrainav.core.world.heights import highest_m
from terrainav.core.world.lattice import LatticeWindow
from terrainav.core.world.paint import Canvas
from terrainav.core.world.rays import ChartSun, Ray
from terrainav.core.world.relief_light import ChartRelief, horizon_tangent, relief_light
from terrainav.core.world.samples import Grid, ScatteredPositions
from terrainav.core.world.scene import Scene
from terrainav.core.world.shadows import highest_shadow, object_zoom

from tests.support.sources import PatternSource

AREA = Box(35.142, -89.866, 35.1415, -89.865)
#: Steep mountains by the sea, fields with a farm, and a town.
MOUNTAINS, FARM, TOWN = (24.1, -114.34), (35.1412, -89.8656), (35.1455, -89.8620)
SUNS = [(25.0, 100.0), (45.0, 200.0), (12.0, 317.0), (60.0, 90.0), (33.0, 45.0), (20.0, 0.0)]


class Analytic(NamedTuple):
    """Ground that a formula states, on cells of 10 m around the middle of a window."""

    formula: object
    cell_m: float = 10.0

    def heights_m(self, window):
        return self.formula(*places(window)).astype(np.float32)

    def highest_m(self, _window):
        return 1000.0

    limit_m = highest_m

    def curvature_per_m(self, window):
        return np.zeros((window.rows, 1), np.float32)


WINDOW = LatticeWindow(20, -100, -100, 200, 200)


def places(window):
    """Metres east and north of cells."""
    south, east = np.meshgrid(np.arange(window.rows) + window.j0, np.arange(window.columns) + window.i0, indexing="ij")
    return east * 10.0, south * -10.0


def chart_sun(height, azimuth):
    return ChartSun.of(SunDirection(height, azimuth), 0)


def tile_of(place, zoom):
    u, v = MERCATOR.forward(*(np.array(one) for one in place))
    return int(u * 2**zoom), int(v * 2**zoom)


def is_close_to_edge(mask, cells):
    """Cells within some cells of one of the other kind."""
    found = np.zeros_like(mask)
    rows, columns = mask.shape
    padded = np.pad(mask, cells, mode="edge")
    for j in range(2 * cells + 1):
        for i in range(2 * cells + 1):
            found |= padded[j : j + rows, i : i + columns] != mask
    return found


@pytest.mark.parametrize("sun", SUNS)
def test_wall_casts_a_shadow_as_long_as_its_height_over_the_tangent(sun):
    toward = chart_sun(*sun)
    # A plateau 100 m high begins in the direction of the sun, at a right angle to it, 300 m from the middle.

    def along(east, north):
        return east * toward.east - north * toward.south

    relief = Analytic(lambda east, north: np.where(along(east, north) > 300.0, 100.0, 0.0))
    shaded = horizon_tangent(relief, WINDOW, toward) >= toward.tangent
    at = along(*places(WINDOW))
    wanted = (at <= 300.0) & (at > 300.0 - 100.0 / toward.tangent)
    assert wanted.any()
    assert not ((shaded != wanted) & ~is_close_to_edge(wanted, 1)).any()


@pytest.mark.parametrize("sun", SUNS)
def test_cone_casts_the_shadow_of_its_tangents(sun):
    toward = chart_sun(*sun)
    height, radius = 300.0, 150.0
    relief = Analytic(lambda east, north: np.maximum(height * (1.0 - np.hypot(east, north) / radius), 0.0))
    shaded = horizon_tangent(relief, WINDOW, toward) >= toward.tangent
    east, north = places(WINDOW)
    behind = -(east * toward.east - north * toward.south)
    aside = np.abs(east * -toward.south - north * toward.east)
    # On the plane: the triangle between the shadow of the tip and the tangents from there to the base.
    tip = height / toward.tangent
    wanted = (behind > radius * radius / tip) & (aside < (tip - behind) * np.tan(np.arcsin(radius / tip)))
    plane = np.hypot(east, north) > radius
    assert (wanted & plane).sum() > 10
    assert not ((shaded != wanted) & plane & ~is_close_to_edge(wanted, 1)).any()


@pytest.mark.parametrize("sun", SUNS)
def test_box_casts_a_shadow_as_long_as_its_height_over_the_tangent(sun):
    toward, window = chart_sun(*sun), LatticeWindow(26, 0, 0, 200, 200)
    ray = Ray.to(toward)
    # Pixels of 0.6 m, as at zoom 18; a flat roof 6 m high.
    drop = ray.length * 0.6 * toward.tangent
    steps = int(np.ceil(10.0 / drop))
    ahead = ray.ahead(window, 1, steps + 1)
    south, east = np.meshgrid(np.arange(ahead.rows) + ahead.j0, np.arange(ahead.columns) + ahead.i0, indexing="ij")
    box = (abs(east - 100) < 8) & (abs(south - 90) < 12)
    highest = highest_shadow(box * np.float32(6.0), window, ahead, ray, steps, drop)
    own = box[window.j0 - ahead.j0 :, window.i0 - ahead.i0 :][:200, :200]
    # A point is in shadow where the ray to the sun meets the box below its roof.
    south, east = np.meshgrid(np.arange(200.0), np.arange(200.0), indexing="ij")
    far = np.linspace(0.0, 6.0 / toward.tangent / 0.6, 400)
    wanted = np.zeros((200, 200), bool)
    for way in far:
        wanted |= (abs(east + way * toward.east - 100) < 7.5) & (abs(south + way * toward.south - 90) < 11.5)
    assert (wanted & ~own).sum() > 50
    assert not (((highest > 0.0) != wanted) & ~own & ~is_close_to_edge(wanted, 1)).any()


def test_light_is_off_by_default():
    x, y = tile_of(FARM, 16)
    assert World().sun is None
    assert np.array_equal(World().tile("satellite", 16, x, y), World(sun=None).tile("satellite", 16, x, y))
    assert WorldSource().sun is None


@pytest.mark.parametrize(
    ("place", "zoom"), [(MOUNTAINS, 9), (MOUNTAINS, 12), (MOUNTAINS, 14), (FARM, 16), (TOWN, 18), (TOWN, 21)]
)
def test_tiles_are_the_light_of_their_points(place, zoom):
    world = World(sun=SunDirection(20.0, 105.0))
    x, y = tile_of(place, zoom)
    tile = world.tile("satellite", zoom, x, y).astype(int)
    random = np.random.default_rng(38)
    row, column = random.integers(0, 256, (2, 400))
    size = 256.0 * 2**zoom
    colour = world.colour("satellite", (x * 256 + column + 0.5) / size, (y * 256 + row + 0.5) / size, float(zoom))
    assert np.abs(tile[row, column] - np.floor(colour + 0.5)).max() <= 1
    assert np.abs(tile - World().tile("satellite", zoom, x, y)).mean() > 1.0


def test_relief_has_the_same_light_at_every_zoom():
    landscape, sun = World().landscape, chart_sun(20.0, 105.0)
    x, y = tile_of(MOUNTAINS, 13)
    at = (np.random.default_rng(3).uniform(0.02, 0.98, (2, 500)) + np.array([[x], [y]])) / 2**13
    coarse = relief_light(landscape, sun, ScatteredPositions(13, x, y, *at))
    for zoom in (14, 15, 16, 19):
        fine_x, fine_y = (np.floor(one * 2**zoom).astype(int) for one in at)
        for n in range(0, 500, 25):
            some = ScatteredPositions(zoom, int(fine_x[n]), int(fine_y[n]), at[0][n : n + 1], at[1][n : n + 1])
            for one, other in zip(coarse[1:], relief_light(landscape, sun, some)[1:]):
                assert one[n] == pytest.approx(other[0], abs=1e-4)
            clearance = relief_light(landscape, sun, some)[0]
            assert clearance is None or clearance[0] == pytest.approx(coarse[0][n], abs=0.02)


@pytest.mark.parametrize("sun", [(20.0, 105.0), (10.0, 45.0)])
def test_tiles_join_in_the_mountains(sun):
    """What is computed for two tiles is the same where they meet, with shadows from ground outside of both."""
    landscape, toward = World().landscape, chart_sun(*sun)
    x, y = tile_of(MOUNTAINS, 14)
    edge = np.full(300, (x + 1) / 2**14)
    along = (y + np.linspace(0.0, 1.0, 300, endpoint=False)) / 2**14
    west, east = (
        relief_light(landscape, toward, ScatteredPositions(14, column, y, edge, along)) for column in (x, x + 1)
    )
    for one, other in zip(west, east):
        assert (one is None) == (other is None)
        assert one is None or np.abs(one - other).max() < 1e-3
    assert west[0] is not None


def test_ground_is_never_higher_than_its_bound():
    landscape = World().landscape
    for place in (MOUNTAINS, FARM):
        for level in (13, 16, 20):
            x, y = tile_of(place, level)
            relief = ChartRelief(landscape, level)
            for side in (4, 40, 300):
                window = LatticeWindow(level, x - side, y - side // 2, 2 * side, side)
                ground = float(relief.heights_m(window).max())
                assert ground <= highest_m(landscape, window)
                # Away from coasts, which the bound does not know, it is close.
                assert (place, level) != (FARM, 20) or highest_m(landscape, window) < ground + 600.0
                assert ground < relief.limit_m(window)


@pytest.mark.parametrize(("crs", "lat", "lon"), [("EPSG:3413", 80.0, 33.0), ("EPSG:3031", -75.0, -120.0)])
def test_azimuths_turn_with_polar_charts(crs, lat, lon):
    world = World(crs=crs)
    sun = ChartSun.of(SunDirection(20.0, 70.0, lat, lon), world.landscape)
    ahead_lon, ahead_lat, _ = Geod(ellps="WGS84").fwd(lon, lat, 70.0, 100.0)
    to = Transformer.from_crs("EPSG:4326", crs, always_xy=True)
    (x0, x1), (y0, y1) = to.transform([lon, ahead_lon], [lat, ahead_lat])
    length = np.hypot(x1 - x0, y1 - y0)
    assert (sun.east, -sun.south) == pytest.approx(((x1 - x0) / length, (y1 - y0) / length), abs=1e-4)


def test_light_is_that_of_linear_values():
    canvas = Canvas([40.0, 120.0, 200.0], (1, 200))
    shares = np.linspace(0.1, 1.2, 200)
    before = canvas.planes.T.astype(np.uint8)
    light._multiply(canvas, shares.astype(np.float32))
    wanted = bytes_of_linear((linear_of_bytes(before) * shares[:, None]).astype(np.float32)).astype(int)
    found = np.minimum(canvas.planes.T, 255.0)
    bright = wanted > 10  # below, sRGB is linear
    assert np.abs(found - wanted)[bright].max() < 0.75


def test_sun_and_sky_share_the_light_as_under_a_clear_sky():
    high, low = SunDirection(60.0, 180.0), SunDirection(8.0, 90.0)
    # 128 klx outside of the air, of which a path of 1/sin of the height leaves exp(-0.21); a sky of 0.8 + 15.5 sin^0.5.
    assert high.direct_lx == pytest.approx(86_983.0, rel=1e-3)
    assert high.sky_lx == pytest.approx(15_224.0, rel=1e-3)
    assert low.sky_share > 0.5 > high.sky_share
    level, away = np.array([np.sin(np.radians(60.0))]), np.array([-0.5])
    assert high.light(level, np.ones(1)) == pytest.approx([1.0])
    assert high.light(away, np.zeros(1)) == pytest.approx([high.sky_share / 2.0])


def test_low_suns_take_coarser_pixels_so_that_shadows_end_within_a_tile():
    for height in (0.5, 2.0, 5.0, 10.0, 45.0):
        sun = chart_sun(height, 100.0)
        zoom = object_zoom(19, sun)
        pixel_m = Grid(zoom, 0, 0).pixel_m
        assert 10.0 / sun.tangent <= 256.0 * pixel_m
        assert (object_zoom(22, sun), object_zoom(15, sun)) == (zoom, 15)


def test_sun_of_a_mission():
    assert mission_sun(Mission(AREA, 120.0)) is None
    assert mission_sun(Mission(AREA, 120.0, sun="30 135")) == SunDirection(30.0, 135.0, 35.14175, -89.8655)
    noon = mission_sun(Mission(AREA, 120.0, sun="time", start="2024-06-21T18:00:00Z"))
    # pvlib 0.16, with refraction.
    assert (noon.height_deg, noon.azimuth_deg) == pytest.approx((78.2965, 178.24), abs=0.3)
    stated = Points(((35.14, -89.86, 100.0),), times_s=(1718992800.0,))
    assert mission_sun(Mission(stated, 100.0, sun="time")).height_deg == pytest.approx(noon.height_deg, abs=0.05)


@pytest.mark.parametrize("sun", ["on", "30", "0 135", "91 0", "30 400", "-5 0", "30  135", ""])
def test_suns_that_are_none_are_refused(sun):
    with pytest.raises(InvalidInput, match="sun") as refused:
        Mission(AREA, 120.0, sun=sun)
    assert refused.value.field == "sun"


def test_imagery_keeps_its_light(tmp_path):
    options = SourceOptions(sun=SunDirection(30.0, 135.0))
    for text in ("https://h.example/{z}/{x}/{y}.png", "photo.tif", "photo.mbtiles"):
        with pytest.raises(InvalidInput, match="has the light in which it was taken"):
            named_source(text, options)
    assert named_source("world", options).open().sun == options.sun
    mission = Mission(AREA, 120.0, sun="30 135")
    source = PatternSource()
    with pytest.raises(InvalidInput, match="has the light in which it was taken"):
        capture(plan(mission, source.grid), source, tmp_path / "a")
    with pytest.raises(InvalidInput, match="opened in another light than the mission's"):
        capture(plan(mission, WorldSource.grid), WorldSource(), tmp_path / "b")


def test_captures_are_lit(tmp_path):
    mission = Mission(AREA, 120.0, sun="20 105", image_format="png", max_px=200)
    lit, plain = WorldSource(sun=mission_sun(mission)), WorldSource()
    assert capture(plan(mission, lit.grid), lit, tmp_path / "lit").written > 0
    assert capture(plan(mission.replace(sun="off"), plain.grid), plain, tmp_path / "plain").written > 0
    one, other = (next((tmp_path / name).rglob("*.png")).read_bytes() for name in ("lit", "plain"))
    assert one != other


def test_scenes_without_a_sun_are_not_lit():
    scene = Scene(World().landscape, Grid(16, *tile_of(FARM, 16)))
    assert light.lighting(scene) is None
