"""Buildings on the ground, from a layer made here."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pyproj
import pytest
from terrainav.core.faces import buildings
from terrainav.core.faces.buildings import (
    BY_DEFAULT,
    NO_BUILDING,
    WITH_HEIGHT,
    WITH_LEVELS,
    BuildingOptions,
    FootprintBuildings,
    lowest_ground_m,
)
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.triangles import ROOF, WALL
from terrainav.core.vectors.layer import open_layer

LON, LAT = 10.0, 47.0
M = 1 / 111_200.0


class Ground:
    """A steep rough slope, on pixels of about 3 m."""

    title, attribution = "slope", ""
    grid = PixelGrid(max_zoom=16, native_zoom=16)

    def surface(self, lat_deg, lon_deg, cell_m=0.0):
        probe = Surface(self.grid, 16, 0, 0, np.zeros((2, 2)))
        x, y = probe.position(np.asarray(lat_deg), np.asarray(lon_deg))
        left, top = int(x.min()) - 3, int(y.min()) - 3
        columns, rows = np.meshgrid(np.arange(left, x.max() + 4), np.arange(top, y.max() + 4))
        heights = 500 + 2.0 * (columns - left) + 1.5 * (rows - top) + 3 * np.sin(columns) * np.cos(2 * rows)
        return Surface(self.grid, 16, left, top, heights)


class Layer:
    """Rectangles in metres east and north, and their values."""

    title, attribution = "made", ""

    def __init__(self, boxes, **values):
        self.boxes, self.values = boxes, values
        self.fields, self.count = tuple(values), len(boxes)

    def features(self, west, south, east, north, fields=(), least_m=0.0, most=-1):
        found = []
        for k, (x0, y0, x1, y1) in enumerate(self.boxes):
            ring = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]) * M + [LON, LAT]
            (w, s), (e, n) = ring.min(axis=0), ring.max(axis=0)
            if e >= west and w <= east and n >= south and s <= north:
                found.append((k, ring))
        count = len(found)
        places = np.concatenate([ring for _, ring in found]) if found else np.empty((0, 2))
        return SimpleNamespace(
            number=np.array([k + 1 for k, _ in found], np.int64),
            kind=np.zeros(count, np.uint8),
            lon_deg=places[:, 0],
            lat_deg=places[:, 1],
            ring_starts=5 * np.arange(count + 1),
            part_starts=np.arange(count + 1),
            feature_starts=np.arange(count + 1),
            values={name: tuple(self.values[name][k] for k, _ in found) for name in fields},
        )


def tile_column(box):
    """Column of the tile of a box's first vertex."""
    return ((LON + box[0] * M) / 360.0 + 0.5) * 2**16 // 1


def read(layer, options=None):
    model = FootprintBuildings(layer, Ground(), options)
    return model, model.triangles(np.array([LAT - 0.01, LAT + 0.01]), np.array([LON - 0.01, LON + 0.01]))


def test_lowest_ground_is_that_of_dense_samples():
    ring = np.array([[0, 0], [40, 5], [30, 30], [-5, 20]]) * M + [LON, LAT]
    surface = Ground().surface(ring[:, 1], ring[:, 0])
    t = np.linspace(0, 1, 20001)[:, None, None]
    dense = (ring + t * (np.roll(ring, -1, axis=0) - ring)).reshape(-1, 2)
    sampled = surface.heights(*surface.position(dense[:, 1], dense[:, 0])).min()
    least = lowest_ground_m(surface, [[ring]])[0]
    assert sampled - 1e-4 <= least <= sampled + 1e-9


def test_heights_levels_default_and_unread_values():
    layer = Layer(
        [(0, 0, 10, 10), (20, 0, 30, 10), (40, 0, 50, 10), (60, 0, 70, 10)],
        **{
            "height": ("22 m", None, "tall", None),
            "building:levels": (None, "4", None, None),
            "roof:shape": (None, None, "9.0", None),
        },
    )
    model, triangles = read(layer, BuildingOptions(default_height_m=7.0))
    counts = model.counts
    assert (counts.with_height, counts.with_levels, counts.by_default) == (1, 1, 2)
    assert dict(counts.unread) == {"height": 1}
    assert counts.examples == {"height": ["tall"]}
    assert dict(counts.unknown_roofs) == {"9.0": 1}
    assert set(triangles.instance.tolist()) == {1, 2, 3, 4}
    # A flat roof and four walls, without the underside.
    assert len(triangles) == 4 * (2 + 8)
    assert (triangles.shows_imagery == (triangles.kind == ROOF)).all()
    model.triangles(np.array([LAT]), np.array([LON]))
    assert model.counts.with_height == 1


def test_a_survey_tells_where_heights_come_from():
    layer = Layer(
        [(0, 0, 10, 10), (20, 0, 30, 10), (40, 0, 50, 10), (60, 0, 70, 10)],
        **{
            "building": ("yes", "house", "yes", None),
            "height": ("22 m", None, "tall", "3"),
            "building:levels": (None, "4", None, None),
        },
    )
    model = FootprintBuildings(layer, None)
    features, sources = model.survey(LON - 0.01, LAT - 0.01, LON + 0.01, LAT + 0.01)
    assert features.number.tolist() == [1, 2, 3, 4]
    assert sources.tolist() == [WITH_HEIGHT, WITH_LEVELS, BY_DEFAULT, NO_BUILDING]
    assert (model.counts.with_height, model.counts.with_levels, model.counts.by_default) == (1, 1, 1)
    assert model.counts.examples == {"height": ["tall"]}


def test_parts_replace_their_outline():
    layer = Layer(
        [(0, 0, 20, 10), (0, 0, 10, 10), (10, 0, 20, 10), (40, 0, 60, 10), (40, 0, 50, 10)],
        **{"height": (5, 10, 15, 5, 9), "building:part": (None, "yes", "yes", None, "yes")},
    )
    model, triangles = read(layer)
    assert model.counts.replaced == 1
    assert np.bincount(triangles.instance).tolist() == [0, 20, 0, 0, 20]


def test_other_areas_of_openstreetmap_are_no_buildings():
    boxes = [(0, 0, 10, 10), (20, 0, 30, 10), (40, 0, 50, 10), (60, 0, 70, 10)]
    tags = {"building": ("yes", None, "no", None), "building:part": (None, None, None, "yes")}
    model, triangles = read(Layer(boxes, **tags))
    assert set(triangles.instance.tolist()) == {1, 4}
    assert model.counts.by_default == 2


@pytest.mark.parametrize("size_m", [10, 35])
def test_no_gap_between_walls_and_the_slope(size_m):
    _, triangles = read(Layer([(0, 0, size_m, size_m)], height=(9,)))
    walls = triangles.corners_m[triangles.kind == WALL].reshape(-1, 3)
    to_heights = pyproj.Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=True)
    heights = to_heights.transform(*walls.T)[2]
    ring = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * size_m * M + [LON, LAT]
    edges = ring + np.linspace(0, 1, 2001)[:, None, None] * (np.roll(ring, -1, axis=0) - ring)
    surface = Ground().surface(edges[..., 1], edges[..., 0])
    ground = surface.heights(*surface.position(edges[..., 1].ravel(), edges[..., 0].ravel()))
    assert np.ptp(ground) > size_m / 2
    # All walls reach 2 m below the lowest ground, and the height counts from that.
    assert heights.min() == pytest.approx(ground.min() - 2, abs=1e-3)
    assert heights.max() == pytest.approx(ground.min() + 9, abs=1e-3)


def test_a_box_to_the_horizon_reads_only_tiles_with_buildings():
    """An oblique image asks for 100 km around, of which the file covers a kilometre."""

    class Counted(Layer):
        def count_in(self, *box):
            return len(self.features(*box).number)

    layer = Counted([(0, 0, 20, 10), (900, 700, 930, 720), (-40_000, 0, -39_980, 20)], height=(5, 6, 7))
    model = FootprintBuildings(layer, Ground())
    far = 50_000 * M
    found = model.triangles(np.array([LAT - far, LAT + far]), np.array([LON - far, LON + far]))
    assert set(found.instance.tolist()) == {1, 2, 3}
    # Where ranges of tiles meet, a building reaches into up to four; there are 29,000 tiles in all.
    assert len(model._tiles) <= 3 * 4 * buildings._FEW_TILES


@pytest.mark.real_data
def test_footprints_of_washington(tmp_path):
    path = Path(__file__).resolve().parents[4] / "shared" / "data" / "elevation" / "buildings.geojson"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    layer = open_layer(str(path), index_dir=tmp_path)
    model = FootprintBuildings(layer, Ground())
    triangles = model.triangles(np.array([38.80, 38.82]), np.array([-77.06, -77.04]))
    heights = [one["properties"]["HEIGHT"] for one in json.loads(path.read_text())["features"]]
    stated = sum(1 for height in heights if height and height > 0)
    assert (model.counts.with_height, model.counts.by_default) == (stated, 84 - stated)
    assert len(set(triangles.instance.tolist())) == 84


def test_roofs_beneath_a_part_do_not_show_the_imagery_and_others_do():
    layer = Layer(
        [(0, 0, 40, 40), (0, 0, 40, 40), (0, 0, 10, 10), (60, 0, 80, 20)],
        building=("yes", None, None, "house"),
        height=(30, 12, 30, 8),
        min_height=(None, None, 20, None),
        **{"building:part": (None, "yes", "yes", None)},
    )
    model, found = read(layer)
    roofs = found.kind == ROOF
    up = np.linalg.norm(found.corners_m.mean(axis=1), axis=1)
    low = roofs & (found.instance == 1) & (up < up[roofs & (found.instance == 1)].max() - 5.0)
    assert low.any()
    assert not found.shows_imagery[low].all()
    assert found.shows_imagery[roofs & ~low].all()
    assert not found.shows_imagery[~roofs].any()
    assert model.counts.replaced == 1


def test_neighbours_of_other_tiles_cover_only_what_they_overlap():
    # Tiles of zoom 16 are 415 m wide here: rows of boxes across several, wall to wall.
    boxes = [(20 * k, 0, 20 * k + 20, 15) for k in range(-40, 40)]
    _, found = read(Layer(boxes, height=tuple(range(5, 85))))
    assert np.array_equal(found.shows_imagery, found.kind == ROOF)
    edge = next(k for k in range(80) if tile_column(boxes[k]) != tile_column(boxes[k + 1]))
    x0, y0, x1, y1 = boxes[edge + 1]
    boxes[edge + 1] = (x0 - 5, y0, x1, y1)
    _, found = read(Layer(boxes, height=tuple(range(5, 85))))
    hidden = set(found.instance[(found.kind == ROOF) & ~found.shows_imagery].tolist())
    assert edge + 1 in hidden
    assert hidden <= {edge + 1, edge + 2}


def query(model, x0, y0, x1, y1, least_m=0.0):
    """Triangles in a box of metres east and north."""
    return model.triangles(LAT + np.array([y0, y1]) * M, LON + np.array([x0, x1]) * M, least_m)


def test_a_building_across_tiles_is_seen_from_each_of_them_once_and_whole():
    columns = [tile_column((x, 0)) for x in range(-600, 600)]
    edge = -600 + next(k for k in range(1, len(columns)) if columns[k] != columns[0])
    # It belongs to the tile of its first vertex, in the west.
    boxes = [(edge - 10, 0, edge + 30, 20), (edge + 100, 0, edge + 120, 20)]
    _, whole = read(Layer(boxes, height=(9, 9)))
    for x in (edge - 8, edge + 25):
        found = query(FootprintBuildings(Layer(boxes, height=(9, 9)), Ground()), x, 1, x + 2, 2)
        assert set(found.instance.tolist()) == {1}
        assert np.array_equal(found.corners_m, whole.corners_m[whole.instance == 1])
    both = query(FootprintBuildings(Layer(boxes, height=(9, 9)), Ground()), edge - 8, 1, edge + 110, 2)
    assert sorted(both.instance.tolist()) == sorted(whole.instance.tolist())


def test_tiles_that_left_memory_are_made_again_alike_and_counted_once(monkeypatch):
    boxes = [(150 * k, 0, 150 * k + 10, 10) for k in range(-4, 5)]
    views = [(box[0], 0, box[2], 10) for box in boxes]
    whole = FootprintBuildings(Layer(boxes), Ground())
    wanted = [query(whole, *view).corners_m for view in views]
    monkeypatch.setattr(buildings, "_MOST_TRIANGLES", 25)
    small = FootprintBuildings(Layer(boxes), Ground())
    for view, corners in 2 * list(zip(views, wanted)):
        assert np.array_equal(query(small, *view).corners_m, corners)
        assert sum(len(tile.triangles) for tile in small._tiles.values()) <= 40
    assert len(whole._tiles) > 2
    assert small.counts.by_default == whole.counts.by_default == len(boxes)


def test_buildings_without_ground_are_left_out_and_counted():
    class Island(Ground):
        def surface(self, lat_deg, lon_deg, cell_m=0.0):
            found = super().surface(lat_deg, lon_deg, cell_m)
            heights = found.heights_m.copy()
            columns = np.arange(heights.shape[1]) + found.left_px
            heights[:, columns > (LON + 100 * M) / 360.0 * 256 * 2**16 + 128 * 2**16] = np.nan
            return Surface(self.grid, 16, found.left_px, found.top_px, heights)

    model = FootprintBuildings(Layer([(0, 0, 10, 10), (95, 0, 120, 10), (200, 0, 210, 10)]), Island())
    found = query(model, -50, -50, 250, 50)
    assert set(found.instance.tolist()) == {1}
    assert np.isfinite(found.corners_m).all()
    assert model.counts.without_ground == 2


def test_small_buildings_may_be_left_out_but_no_tall_ones():
    layer = Layer([(0, 0, 10, 10), (50, 0, 54, 4), (90, 0, 94, 4), (130, 0, 190, 4)], height=(5, 3, 60, 3))
    model = FootprintBuildings(layer, Ground())
    for least_m, wanted in ((0.0, {1, 2, 3, 4}), (8.0, {1, 3, 4}), (30.0, {3, 4}), (100.0, set())):
        assert set(query(model, -20, -20, 200, 50, least_m).instance.tolist()) == wanted


def test_colours_are_the_files_and_otherwise_plain_by_seed_and_building():
    boxes = [(30 * k, 0, 30 * k + 10, 10) for k in range(20)]
    walls, roofs = (["#0a141e", "Red", "no colour"] + 17 * [None], ["#fff", None, ""] + 17 * [None])
    layer = Layer(boxes, **{"building:colour": walls, "roof:colour": roofs})

    def of(kind, seed):
        _, found = read(layer, BuildingOptions(seed=seed))
        rows = [found.colour[(found.instance == k + 1) & (found.kind == kind)] for k in range(20)]
        assert all((row == row[0]).all() for row in rows)
        return [tuple(row[0].tolist()) for row in rows]

    wall, roof = of(WALL, 1), of(ROOF, 1)
    assert (wall[0], wall[1], roof[0]) == ((10, 20, 30), (176, 58, 46), (255, 255, 255))
    assert set(wall[2:]) <= set(buildings._WALLS)
    assert set(roof[1:]) <= set(buildings._ROOFS)
    assert len(set(wall[2:])) > 3
    assert of(WALL, 1) == wall
    assert of(WALL, 2)[:2] == wall[:2]
    assert of(WALL, 2) != wall
