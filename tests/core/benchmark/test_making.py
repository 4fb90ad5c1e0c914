"""Benchmarks that are made: their reference, their truth, their parts."""

from __future__ import annotations

import csv
import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from PIL import Image
from pyproj import Transformer
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.benchmark.making import make_benchmark
from terrainav.core.benchmark.planning import BenchmarkSettings, plan_benchmark, tiles_folder
from terrainav.core.capture.progress import Listener
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.imageries import NamedImagery
from terrainav.core.mission.mission import Mission

from tests.core.benchmark.conftest import EPSG, HEIGHT, NORTH, PLACED, WEST, WIDTH, made, mission, places
from tests.support import rasters

TO_UTM = Transformer.from_crs(4326, EPSG, always_xy=True)
TO_ECEF = Transformer.from_crs(4979, 4978, always_xy=True)
FROM_ECEF = Transformer.from_crs(4978, 4979, always_xy=True)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def ground_ellipsoid(query: dict[str, str], x_px: np.ndarray, y_px: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """UTM of the ground at image points, from ``queries.csv`` alone: rays met with the ellipsoid in geocentric axes."""
    value = {name: float(text) for name, text in query.items() if name not in ("id", "file", "imagery", "part")}
    lat, lon = math.radians(value["lat_deg"]), math.radians(value["lon_deg"])
    yaw, tilt, roll = (math.radians(value[f"{name}_deg"]) for name in ("yaw", "tilt", "roll"))
    # Nose, right wing and belly of an aircraft (z-y'-x''), whose camera looks along the belly: right, down, axis.
    turn_yaw = np.array([[math.cos(yaw), -math.sin(yaw), 0], [math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
    turn_tilt = np.array([[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]])
    turn_roll = np.array([[1, 0, 0], [0, math.cos(roll), -math.sin(roll)], [0, math.sin(roll), math.cos(roll)]])
    body = np.stack(
        [
            -(y_px - value["cy_px"]) / value["fy_px"],
            (x_px - value["cx_px"]) / value["fx_px"],
            np.ones_like(x_px),
        ]
    )
    north, east, down = turn_yaw @ turn_tilt @ turn_roll @ body
    axes = np.array(
        [
            [-math.sin(lat) * math.cos(lon), -math.sin(lon), -math.cos(lat) * math.cos(lon)],
            [-math.sin(lat) * math.sin(lon), math.cos(lon), -math.cos(lat) * math.sin(lon)],
            [math.cos(lat), 0.0, -math.sin(lat)],
        ]
    )
    ray = axes @ np.stack([north, east, down])
    start = np.array(TO_ECEF.transform(value["lon_deg"], value["lat_deg"], value["height_m"]))
    size = np.array([6378137.0, 6378137.0, 6356752.314245179])
    start, ray = start / size, ray / size[:, np.newaxis]
    a, b, c = (ray * ray).sum(0), 2.0 * (start @ ray), start @ start - 1.0
    far = 2.0 * c / (-b + np.sqrt(b * b - 4.0 * a * c))
    place = (start[:, np.newaxis] + far * ray) * size[:, np.newaxis]
    lon_deg, lat_deg, _ = FROM_ECEF.transform(*place)
    return TO_UTM.transform(lon_deg, lat_deg)


@pytest.mark.parametrize("tilt_deg", [0.0, 35.0])
def test_labels_say_where_every_pixel_was_taken(tmp_path, tilt_deg):
    """Colours that tell their own place are found where ``queries.csv`` says, within a tenth of a pixel."""
    x, y = rasters.centres(PLACED, 700, 600)
    colours = rasters.position_colours(x - WEST, NORTH - y)
    source = str(rasters.write(tmp_path / "places.tif", colours, PLACED, EPSG))
    imagery = NamedImagery("places", source)
    queries = mission(6, tilt_deg=tilt_deg, mesh="rays")
    folder = tmp_path / "benchmark"
    made(folder, BenchmarkSettings(queries, (imagery,), imagery, split="none"))
    rows = table(folder / "queries.csv")
    assert len(rows) == 6
    for row in rows:
        with Image.open(folder / row["file"]) as image:
            seen = np.asarray(image, float)
        down, across = np.mgrid[4 : seen.shape[0] - 4 : 5, 4 : seen.shape[1] - 4 : 5]
        east, north = ground_ellipsoid(row, across.ravel() + 0.5, down.ravel() + 0.5)
        px = east - WEST, NORTH - north
        # Of each band the place along its own axis, where pixels that are mixed lie on one straight line.
        waves = (*px, px[0] + px[1])
        straight = ~np.any([rasters.turns(wave, 3.0) for wave in waves], axis=0)
        expected = np.stack([rasters.triangle(wave) for wave in waves])
        off = np.abs(seen[down.ravel(), across.ravel()].T - expected)[:, straight]
        assert straight.sum() > 50
        # 4 levels a pixel of each axis, and half a level for rounding.
        assert (off.max(axis=1) <= 0.1 * np.array([4.0, 4.0, 8.0]) + 0.501).all()


@pytest.mark.parametrize("ends_at_edges", [False, True])
def test_the_mosaic_is_the_reference_pixel_for_pixel(tmp_path, benchmark, settings, dates, ends_at_edges):
    if ends_at_edges:
        one = replace(settings, queries=mission(1), imageries=settings.imageries[:1], split="none", margin_m=700.0)
        benchmark = made(tmp_path / "clipped", one).benchmark
        assert (benchmark.mosaic.width_px, benchmark.mosaic.height_px) == (WIDTH, HEIGHT)
    mosaic = benchmark.mosaic
    with Image.open(benchmark.folder / mosaic.file) as image:
        found = np.asarray(image.convert("L"))
    whole = gdal.Open(dates["old"].source).ReadAsArray()
    left, top = round(mosaic.west - WEST), round(NORTH - mosaic.north)
    assert found.shape == (mosaic.height_px, mosaic.width_px)
    assert mosaic.crs == f"EPSG:{EPSG}"
    assert np.array_equal(found, whole[top : top + mosaic.height_px, left : left + mosaic.width_px])
    assert gdal.Open(str(benchmark.folder / mosaic.file)).GetGeoTransform() == (
        mosaic.west,
        1.0,
        0.0,
        mosaic.north,
        0.0,
        -1.0,
    )


def test_the_reference_ends_where_its_source_does(benchmark):
    """Its margin would reach beyond; nothing has failed for that."""
    mosaic = benchmark.mosaic
    east, south = mosaic.west + mosaic.width_px, mosaic.north - mosaic.height_px
    assert WEST <= mosaic.west < east <= WEST + 700
    assert NORTH - 600 <= south < mosaic.north <= NORTH
    for row in table(benchmark.folder / "references.csv"):
        assert WEST <= float(row["west"]) < float(row["east"]) <= WEST + 700
        assert (benchmark.folder / row["file"]).is_file()


def test_every_place_of_the_reference_is_in_some_tile(benchmark):
    tiles = benchmark.references
    x = np.linspace(tiles.west.min(), tiles.east.max(), 60)[1:-1]
    y = np.linspace(tiles.south.min(), tiles.north.max(), 60)[1:-1]
    for east in x:
        for north in y:
            inside = (tiles.west <= east) & (tiles.east >= east) & (tiles.south <= north) & (tiles.north >= north)
            assert inside.any()


def test_queries_of_all_imageries_are_of_one_pose(benchmark):
    rows = table(benchmark.folder / "queries.csv")
    by_imagery = {name: [row for row in rows if row["imagery"] == name] for name in ("old", "new")}
    assert len(rows) == 24
    for old, new in zip(*by_imagery.values()):
        for name in ("lat_deg", "lon_deg", "height_m", "yaw_deg", "part", "fx_px"):
            assert old[name] == new[name]


def test_positives_are_tiles_that_show_the_same_ground(benchmark):
    """Intersection over union by counting a fine lattice of ground, each point of it projected into the query."""
    rows = {row["id"]: row for row in table(benchmark.folder / "queries.csv")}
    tiles = {row["id"]: row for row in table(benchmark.folder / "references.csv")}
    named = {(row["query"], row["reference"]): row for row in table(benchmark.folder / "positives.csv")}
    step = 0.25
    for name in list(rows)[:6]:
        row = rows[name]
        wide, high = float(row["width_px"]), float(row["height_px"])
        edge_x = np.concatenate([np.linspace(0, wide, 20), np.full(20, wide), np.linspace(wide, 0, 20), np.zeros(20)])
        edge_y = np.concatenate([np.zeros(20), np.linspace(0, high, 20), np.full(20, high), np.linspace(high, 0, 20)])
        ring = np.stack(ground_ellipsoid(row, edge_x, edge_y), axis=1)
        low, top = ring.min(axis=0), ring.max(axis=0)
        x, y = np.meshgrid(np.arange(low[0], top[0], step), np.arange(low[1], top[1], step))
        inside = _inside(ring, x, y)
        for tile, edges in tiles.items():
            west, south, east, north = (float(edges[side]) for side in ("west", "south", "east", "north"))
            both = inside[(x >= west) & (x < east) & (y >= south) & (y < north)].sum() * step**2
            iou = both / ((east - west) * (north - south) + inside.sum() * step**2 - both)
            found = named.get((name, tile))
            assert iou == pytest.approx(
                0.0 if found is None else float(found["iou"]), abs=0.14 if found is None else 0.01
            )
            if found is not None:
                assert found["kind"] == ("positive" if float(found["iou"]) >= 0.39 else "semi-positive")


def _inside(ring: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Which points lie inside a ring, by counting crossings."""
    inside = np.zeros(x.shape, bool)
    for (x0, y0), (x1, y1) in zip(ring, np.roll(ring, -1, axis=0)):
        if y0 == y1:
            continue
        crosses = (y0 > y) != (y1 > y)
        inside ^= crosses & (x < (x1 - x0) * (y - y0) / (y1 - y0) + x0)
    return inside


def test_cross_area_parts_share_no_ground(tmp_path):
    source = "world"
    imagery = NamedImagery("world", source)
    queries = Mission(Box(35.150, -89.900, 35.142, -89.888), 60.0, image_px=64, image_format="png")
    settings = BenchmarkSettings(queries, (imagery,), imagery, tile_widths_m=(70.0,), tile_overlap=0.0, gap_m=10.0)
    folder = tmp_path / "benchmark"
    found = made(folder, settings).benchmark
    parts, boxes = [], []
    for row in table(folder / "queries.csv"):
        east, north = ground_ellipsoid(row, np.array([0.0, 64.0, 64.0, 0.0]), np.array([0.0, 0.0, 48.0, 48.0]))
        parts.append(row["part"])
        boxes.append((east.min(), north.min(), east.max(), north.max()))
    from_map = Transformer.from_crs(3857, EPSG, always_xy=True)
    for row in table(folder / "references.csv"):
        west, south, east, north = (float(row[name]) for name in ("west", "south", "east", "north"))
        x, y = from_map.transform([west, east, east, west], [south, south, north, north])
        parts.append(row["part"])
        boxes.append((min(x), min(y), max(x), max(y)))
    assert {"train", "validation", "test"} <= set(parts) <= {"train", "validation", "test", "gap"}
    west, south, east, north = np.array(boxes).T
    apart = np.maximum(west[:, None] - east, west - east[:, None])
    apart = np.maximum(apart, np.maximum(south[:, None] - north, south - north[:, None]))
    part = np.array(parts)
    others = (part[:, None] != part) & (part != "gap") & (part[:, None] != "gap")
    # Boxes along the grid are wider than those along meridians, which are turned by 1.7 degrees: 3 m of 70 on a side.
    assert apart[others].min() > 10.0 - 2.0 * 3.0
    assert set(found.gallery("test")) == {at for at, part in enumerate(found.references.part) if part == "test"}


@pytest.mark.thorough
def test_many_queries_in_the_gap_bring_a_hint_whose_figures_hold(tmp_path):
    imagery = NamedImagery("world", "world")
    queries = Mission(Box(35.150, -89.900, 35.1455, -89.893), 60.0, image_px=48, image_format="png")
    settings = BenchmarkSettings(
        queries, (imagery,), imagery, tile_widths_m=(70.0, 100.0), tile_overlap=0.0, gap_m=30.0
    )
    first = made(tmp_path / "first", settings)
    lost, count = first.benchmark.queries_of_parts["gap"], len(first.benchmark.queries)
    assert str(first.hint).startswith(f"{lost} of {count} queries are in the gap between parts; it would be ")
    hinted = {words: int(number) for number, words in re.findall(r"(\d+) (with(?:out)? [^,;]+)", str(first.hint))}
    changes = {
        "with a gap of 0 m": {"gap_m": 0.0},
        "without a validation part": {"shares": (0.9, 0.0, 0.1)},
    }
    assert hinted.keys() == changes.keys()
    for at, (words, change) in enumerate(changes.items()):
        parts = made(tmp_path / str(at), replace(settings, **change)).benchmark.queries_of_parts
        assert parts["gap"] == hinted[words] < lost
        asked = {"train", "validation", "test"} - ({"validation"} if "shares" in change else set())
        assert {name for name, queries in parts.items() if queries} - {"gap"} == asked


@pytest.mark.parametrize("overlap", [0.0, 0.3, 0.6])
@pytest.mark.parametrize("long_m", [150.0, 500.0, 900.0])
@pytest.mark.parametrize("more", [{}, {"tile_overlap": 0.0}, {"tile_widths_m": (70.0, 300.0)}, {"gap_m": 20.0}])
def test_a_plan_leaves_half_of_the_queries_in_parts_or_states_an_area_that_does(overlap, long_m, more):
    imagery = NamedImagery("world", "world")
    grids = {str(imagery): open_source("world").grid}

    def planned(length_m):
        # A degree of longitude is 91 km there.
        box = Box(35.15, -89.9, 35.15 - 0.003, -89.9 + length_m / 91_000.0)
        queries = Mission(box, 120.0, image_px=64, overlap_along=overlap, overlap_across=overlap)
        return plan_benchmark(BenchmarkSettings(queries, (imagery,), imagery, **more), grids)

    said = ""
    try:
        planned(long_m)
    except InvalidInput as refused:
        said = str(refused)
    if said:
        assert ("smaller gap" in said) == ("gap_m" in more)
        advised = float(re.search(r"an area ([\d,]+) m long or more", said)[1].replace(",", ""))
        assert advised > long_m
        planned(advised)


def test_queries_of_each_part_are_at_hand_where_earlier_nearly_all_were_lost(tmp_path):
    imagery = NamedImagery("world", "world")
    queries = Mission(Box(35.15, -89.9, 35.147, -89.8955), 120.0, image_px=48, image_format="png")
    parts = made(tmp_path, BenchmarkSettings(queries, (imagery,), imagery)).benchmark.queries_of_parts
    assert min(parts.values()) > 0
    assert parts["gap"] <= sum(parts.values()) / 2


@pytest.mark.thorough
def test_queries_beyond_the_imagery_are_left_out_where_that_is_asked_for(tmp_path, dates, settings):
    # Of 75 m of ground at any yaw: half of them reach beyond a raster's edge.
    around = [*places(8), *places(8, seed=5, rim_m=-10.0), *places(8, seed=6, rim_m=20.0)]
    points = Points(tuple((lat, lon, 60.0) for lat, lon in around), tuple(range(0, 240, 10)))
    asked = replace(settings, queries=settings.queries.replace(area=points), split="none")
    grids = {str(one): open_source(one.source).grid for one in (*asked.imageries, asked.reference)}
    inside = replace(asked, inside=True)
    worked_out = plan_benchmark(inside, grids)
    assert 0 < worked_out.left_out < 16
    found = made(tmp_path / "inside", inside)
    assert not found.total.failed
    counts = {name: found.benchmark.queries.imagery.count(name) for name in dates}
    assert set(counts.values()) == {24 - worked_out.left_out}
    for row in table(tmp_path / "inside" / "queries.csv"):
        east, north = ground_ellipsoid(row, np.array([0.0, 79.0, 79.0, 0.0]), np.array([0.0, 0.0, 59.0, 59.0]))
        assert WEST < east.min() < east.max() < WEST + WIDTH
        assert NORTH - HEIGHT < north.min() < north.max() < NORTH
    # Settings of before are those that leave none out.
    assert "inside" not in asked.to_dict()
    assert inside.to_dict()["inside"] is True
    assert made(tmp_path / "inside", inside, resume=True).benchmark is not None
    assert len(made(tmp_path / "all", asked).total.failed) > 0


def test_same_area_has_one_gallery_for_all_parts(benchmark):
    assert set(benchmark.references.part) == {""}
    assert len(benchmark.gallery("test")) == len(benchmark.gallery("train")) == len(benchmark.references)
    counts = {part: benchmark.queries.part.count(part) for part in ("train", "validation", "test")}
    assert counts == {"train": 12, "validation": 6, "test": 6}


def test_the_same_settings_leave_the_same_bytes_also_in_several_goes(tmp_path, settings, benchmark):
    folder = tmp_path / "again"
    asked = iter([False] * 40 + [True] * 1_000_000)
    first = made(folder, settings, listener=Listener(cancelled=lambda: next(asked)))
    assert first.benchmark is None
    assert first.total.cancelled
    with pytest.raises(InvalidInput, match="is not finished"):
        Benchmark.read(folder)
    with pytest.raises(OutputError, match="already holds this benchmark"):
        made(folder, settings)
    made(folder, settings, resume=True)
    files = [path.relative_to(benchmark.folder) for path in benchmark.folder.rglob("*") if path.is_file()]
    assert len(files) > 50
    for file in files:
        # Journals are in the order in which images were finished.
        if file.name != "journal.jsonl":
            assert (folder / file).read_bytes() == (benchmark.folder / file).read_bytes(), file


@pytest.mark.thorough
def test_tiles_of_several_widths_are_one_gallery(tmp_path, settings):
    wide = replace(settings, tile_widths_m=(60.0, 120.0), tile_overlap=0.25)
    found = made(tmp_path / "benchmark", wide).benchmark
    assert set(found.references.width_m) == {60.0, 120.0}
    for width in (60.0, 120.0):
        of_width = found.references.width_m == width
        assert found.references.east[of_width] - found.references.west[of_width] == pytest.approx(width, abs=1.0)
        assert (tmp_path / "benchmark" / tiles_folder(width) / "mission.json").is_file()


def test_pieces_are_datasets(benchmark):
    from terrainav.core.dataset.dataset import read_dataset

    for name in ("reference/mosaic", "queries/old", "queries/new"):
        (images,) = read_dataset(benchmark.folder / name).image_sets.values()
        assert len(images)


def test_how_it_was_made_is_told(benchmark, dates):
    about = json.loads((benchmark.folder / "benchmark.json").read_text(encoding="utf-8"))
    assert about["schema"] == 1
    assert about["imageries"] == [str(dates["old"]), str(dates["new"])]
    assert set(about["imagery"]) == {"old", "new"}
    assert Mission.from_dict(about["queries"]) == mission()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"imageries": ()}, "no imagery of queries"),
        ({"tile_widths_m": (0.0,)}, "tiles of 0.0 m: must be wider than 0"),
        ({"tile_widths_m": (60.0, 60.0)}, "each width may be given once"),
        ({"tile_overlap": 1.0}, "overlap of tiles 1.0: must be from 0 to below 1"),
        ({"margin_m": -1.0}, "margin -1.0 m: must be 0 or more"),
        ({"positive_iou": 0.1}, "intersection over union 0.1 and 0.14"),
        ({"split": "blocks"}, "split 'blocks': must be one of cross-area, same-area, none"),
    ],
)
def test_settings_that_are_wrong_are_refused(settings, changes, said):
    with pytest.raises(InvalidInput, match=said):
        replace(settings, **changes)


def test_queries_of_the_horizon_are_refused(settings):
    tilted = replace(settings, queries=mission(tilt_deg=80.0))
    grids = {str(one): open_source(one.source).grid for one in (*settings.imageries, settings.reference)}
    with pytest.raises(InvalidInput, match="queries of old: 12 of 12 see the horizon"):
        plan_benchmark(tilted, grids)


def test_tiles_of_a_few_pixels_are_refused(settings):
    grids = {str(one): open_source(one.source).grid for one in (*settings.imageries, settings.reference)}
    with pytest.raises(InvalidInput) as refused:
        plan_benchmark(replace(settings, tile_widths_m=(15.0,)), grids)
    assert str(refused.value) == "tiles of 15 m: the reference has pixels of 1 m; must be 16 m wide or wider"
    (tiles,) = plan_benchmark(replace(settings, tile_widths_m=(16.0,)), grids).tiles.values()
    assert set(tiles.frames.width_px) == {16}


def test_a_reference_of_too_many_pixels_is_refused():
    world = NamedImagery("world", "world")
    queries = Mission(Box(35.5, -90.0, 35.0, -89.0), 2_000.0, image_px=4000)
    with pytest.raises(InvalidInput, match=r"reference of .* m in pixels of .* m: more than 20,000 px"):
        plan_benchmark(BenchmarkSettings(queries, (world,), world), {"world=world": open_source("world").grid})


def test_folders_of_others_are_left_alone(tmp_path, settings):
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "thesis.txt").write_text("mine")
    with pytest.raises(OutputError, match=r"holds thesis\.txt but no benchmark\.json"):
        made(folder, settings)
    assert [path.name for path in folder.iterdir()] == ["thesis.txt"]


def test_another_benchmark_is_not_gone_on_with(benchmark, settings):
    other = replace(settings, tile_overlap=0.25)
    with pytest.raises(OutputError, match="holds another benchmark"):
        made(benchmark.folder, other, resume=True)


def test_a_source_that_lacks_the_queries_ground_is_refused(tmp_path, settings):
    placed = (WEST + 90_000.0, *PLACED[1:])
    far = rasters.write(tmp_path / "far.tif", np.full((1, 50, 50), 7), placed, EPSG)
    elsewhere = replace(settings, reference=NamedImagery("far", str(far)))
    with pytest.raises(InvalidInput, match="has no imagery where the queries are"):
        made(tmp_path / "benchmark", elsewhere)


def test_shares_are_checked_before_anything_is_made(tmp_path, settings):
    sources = {str(one): open_source(one.source) for one in (*settings.imageries, settings.reference)}
    grids = {name: source.grid for name, source in sources.items()}
    wrong = plan_benchmark(replace(settings, shares=(0.5, 0.5, 0.5)), grids)
    with pytest.raises(InvalidInput, match=r"add up to 1\.5"):
        make_benchmark(wrong, sources, tmp_path / "benchmark")
    assert not (tmp_path / "benchmark").exists()
