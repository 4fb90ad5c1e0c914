"""The world about the poles: one landscape each, without seams, also where all meridians meet."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.ellipsoid import trace
from terrainav.core.imagery.opening import SourceOptions, named_source, open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.world import World, WorldSource

from tests.support.thinning import sampled

STYLES = ("satellite", "roadmap", "terrain")
NORTH, SOUTH = "EPSG:3413", "EPSG:3031"
CAPS = {crs: World(2024, crs) for crs in (NORTH, SOUTH)}
#: World fractions of the poles, of pack ice and its edge, of fields of crevasses, of a coast, and of land without ice.
PLACES = {
    "north pole": (NORTH, 0.5, 0.5),
    "pack ice": (NORTH, 0.505, 0.505),
    "edge of the pack": (NORTH, 0.5, 0.474),
    "farms": (NORTH, 0.43, 0.62),
    "south pole": (SOUTH, 0.5, 0.5),
    "crevasses": (SOUTH, 0.5052490234375, 0.523681640625),
    "coast": (SOUTH, 0.523, 0.46),
}
#: As in test_world.
PYRAMID_RMS = {"satellite": 22.0, "roadmap": 8.0, "terrain": 13.0}


def tile_at(zoom, u, v):
    return int(u * 2**zoom), int(v * 2**zoom)


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("place", sampled(PLACES, 4))
def test_a_tile_is_its_pixels_one_by_one(place, style):
    crs, *at = PLACES[place]
    for zoom in (0, 4, 9, 12, 15, 18, 22):
        x, y = tile_at(zoom, *at)
        tile = CAPS[crs].tile(style, zoom, x, y)
        rows, columns = np.random.default_rng(zoom).integers(0, 256, (2, 300))
        side = 2.0**-zoom / 256
        u, v = (x * 256 + columns + 0.5) * side, (y * 256 + rows + 0.5) * side
        colour = CAPS[crs].colour(style, u, v, zoom)
        # As in test_world: half a grey level may be rounded the other way.
        assert np.abs(colour - tile[rows, columns].astype(float)).max() <= 0.52


def steps(pixels):
    """Mean change of colour from each column to the next."""
    return np.abs(np.diff(pixels.astype(float), axis=1)).mean(axis=(0, 2))


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("place", sampled(PLACES, 4))
def test_tiles_have_no_seams_also_at_the_pole(place, style):
    crs, *at = PLACES[place]
    zooms = (4, 9, 13, 15, 17, 20)
    # All of them at the poles, and a half at each other place.
    for zoom in zooms if "pole" in place else zooms[list(PLACES).index(place) % 2 :: 2]:
        x, y = tile_at(zoom, *at)
        four = [[CAPS[crs].tile(style, zoom, x - 1 + i, y - 1 + j) for i in (0, 1)] for j in (0, 1)]
        block = np.concatenate([np.concatenate(row, axis=1) for row in four])
        for pixels in (block, block.swapaxes(0, 1)):
            change = steps(pixels)
            # Of a smooth slope the middle may be the steepest.
            assert change[255] <= 1.1 * np.delete(change, 255).max() + 1e-9


@pytest.mark.parametrize("style", sampled(STYLES, 3))
@pytest.mark.parametrize("place", sampled(PLACES, 3))
def test_a_zoom_is_the_next_one_averaged(place, style):
    crs, *at = PLACES[place]
    # All zooms, shared out among the places.
    for zoom in range(list(PLACES).index(place), 22, len(PLACES)):
        x, y = tile_at(zoom, *at)
        below = [[CAPS[crs].tile(style, zoom + 1, 2 * x + i, 2 * y + j) for i in (0, 1)] for j in (0, 1)]
        block = np.concatenate([np.concatenate(row, axis=1) for row in below])
        averaged = block.reshape(256, 2, 256, 2, 3).mean(axis=(1, 3))
        rms = float(np.sqrt(np.mean((averaged - CAPS[crs].tile(style, zoom, x, y)) ** 2)))
        assert rms < PYRAMID_RMS[style]


def test_order_and_threads_make_no_difference():
    wanted = [
        (crs, style, zoom, x, y)
        for crs, u, v in PLACES.values()
        for style in STYLES
        for zoom, x, y in [(13, *tile_at(13, u, v)), (17, *tile_at(17, u, v))]
    ]
    alone = [World(2024, crs).tile(*tile) for crs, *tile in wanted]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda tile: CAPS[tile[0]].tile(*tile[1:]), reversed(wanted)))[::-1]
    for one, other in zip(alone, together):
        np.testing.assert_array_equal(one, other)


def test_each_pole_and_each_seed_is_another_landscape_and_the_map_s_stays():
    worlds = [World(2024), World(2024, NORTH), World(2024, SOUTH), World(7, SOUTH)]
    tiles = [world.tile("satellite", 3, 4, 4).astype(int) for world in worlds]
    for n, one in enumerate(tiles):
        assert all((np.abs(one - other) > 8).any(axis=-1).mean() > 0.3 for other in tiles[:n])
    np.testing.assert_array_equal(World(2024, "epsg:3857").tile("satellite", 3, 4, 4), tiles[0])


def test_ice_lies_about_the_poles_and_on_the_sea():
    """White about the poles and nowhere near the equator; pack ice ends at the same place in all styles."""
    for crs, world in CAPS.items():
        pole = world.tile("satellite", 8, 128, 128).astype(int)
        assert pole.min(axis=-1).mean() > 150, crs
        warm = world.tile("satellite", 4, 2, 8).astype(int)
        assert warm.min(axis=-1).mean() < 120, crs
    v = np.linspace(0.5, 0.41, 200)
    red = {style: CAPS[NORTH].colour(style, np.full(200, 0.5), v, 10)[:, 0] for style in STYLES}
    packed = red["satellite"] > 150
    assert 0.2 < packed.mean() < 0.6
    assert (np.diff(packed) != 0).sum() == 1
    for style in ("roadmap", "terrain"):
        assert red[style][packed].min() > red[style][~packed].max()


def block(world, style, zoom, left, top, width, height):
    """Pixels of a window from the tiles under it."""
    columns, rows = (
        range(start // 256, (start + size - 1) // 256 + 1) for start, size in ((left, width), (top, height))
    )
    whole = np.concatenate([np.concatenate([world.tile(style, zoom, x, y) for x in columns], axis=1) for y in rows])
    return whole[top - rows[0] * 256 :, left - columns[0] * 256 :][:height, :width]


def image(path):
    gdal = pytest.importorskip("osgeo.gdal", reason="the images are read by GDAL's Python module")
    return gdal.Open(str(path))


@pytest.mark.parametrize(
    ("crs", "area"),
    [
        (NORTH, Box(88.002, 10.0, 88.0, 10.06)),
        (SOUTH, Points(((-90.0, 0.0, 120.0), (-89.9999, 77.0, 120.0)))),
    ],
)
def test_map_frames_are_the_chart_s_own_pixels(crs, area, tmp_path):
    source = open_source("world", crs=crs)
    worked_out = plan(Mission(area, 120.0, source="world"), source.grid)
    capture(worked_out, source, tmp_path)
    assert worked_out.accuracy.picture.method.name == "map"
    windows = worked_out.windows
    for n, name in enumerate(worked_out.names[:6]):
        read = image(tmp_path / "satellite" / f"{name}.tif")
        left, top = int(windows.left_px[n]), int(windows.top_px[n])
        pixels = read.ReadAsArray().transpose(1, 2, 0)[..., :3]
        wanted = block(source.world, "satellite", worked_out.zoom, left, top, pixels.shape[1], pixels.shape[0])
        np.testing.assert_array_equal(pixels, wanted)
        west, across, _, north, _, down = read.GetGeoTransform()
        side = source.grid.pixel_size(worked_out.zoom)[0]
        assert (across, -down) == pytest.approx((side, side))
        assert (west, north) == pytest.approx(
            (left * side - 20037508.342789244, 20037508.342789244 - top * side), abs=1e-3
        )
        assert read.GetSpatialRef().GetAuthorityCode(None) == crs[5:]


@pytest.mark.parametrize("crs", CAPS)
def test_a_tilted_picture_over_the_pole_shows_the_ground_that_rays_meet(crs, tmp_path):
    lat = 90.0 if crs == NORTH else -90.0
    source = open_source("world", crs=crs)
    mission = Mission(Points(((lat, 30.0, 3000.0),)), 3000.0, tilt_deg=40.0, yaw_deg=70.0, source="world")
    worked_out = plan(mission, source.grid)
    capture(worked_out, source, tmp_path)
    assert worked_out.accuracy.picture.method.name == "camera"
    (path,) = (tmp_path / "satellite").glob("*.tif")
    shown = image(path).ReadAsArray().astype(float)
    height, width = shown.shape[1:]
    rows, columns = (np.random.default_rng(4).uniform(0.02, 0.98, (2, 4000)) * [[height], [width]]).astype(int)
    points = np.stack([(2 * columns + 1) / width - 1, 1 - (2 * rows + 1) / height], axis=-1)
    poses = worked_out.poses
    seen = trace(np.array(lat), np.array(3000.0), mission.camera.rays_enu(points, *poses.attitude)[0])
    u, v = source.grid.plane.forward(seen.lat_deg, poses.lon_deg[0] + seen.dlon_deg)
    assert (v.min() < 0.5 < v.max()) or (u.min() < 0.5 < u.max())
    wanted = source.world.colour("satellite", u, v, worked_out.zoom)
    apart = np.abs(shown[:, rows, columns].T - wanted).max(axis=-1)
    # Textures of a pixel's size are resampled; what is elsewhere would be off by more.
    assert np.median(apart) < 3.0
    assert np.corrcoef(shown[0, rows, columns], wanted[:, 0])[0, 1] > 0.9


@pytest.mark.parametrize("crs", ["EPSG:3995", "EPSG:4326", "EPSG:32616", "polar"])
def test_a_chart_that_there_is_none_of_is_refused(crs):
    for ask in (
        lambda: World(2024, crs),
        lambda: open_source("world", crs=crs),
        lambda: named_source("world", SourceOptions(crs=crs)).grid,
    ):
        with pytest.raises(InvalidInput, match="EPSG:3413, EPSG:3031; choose") as refused:
            ask()
        assert refused.value.field == "crs"


def test_the_named_source_has_the_chart_s_grid_and_what_it_opens_too():
    for crs, code in (("", None), ("EPSG:3857", None), (NORTH, NORTH), (SOUTH.lower(), SOUTH)):
        named = named_source("world", SourceOptions(crs=crs, seed=7))
        assert named.grid == named.open().grid
        assert (None if named.grid.plane.wraps else named.grid.plane.crs) == code
        assert named.open().world == World(7, code or "")
    with pytest.raises(InvalidInput, match="tile"):
        _ = named_source("world", SourceOptions(crs=SOUTH, tile_px=512)).grid


def test_ground_beyond_the_chart_is_counted_as_without_imagery():
    far = Mission(Points(((-40.0, 45.0, 120.0),)), 120.0, source="world")
    assert plan(far, WorldSource(crs=NORTH).grid).imagery.outside == 1
