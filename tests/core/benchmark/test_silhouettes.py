"""Benchmarks of silhouettes: masks of queries, the buildings they are found in, and figures at predicted poses."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image, ImageDraw
from pyproj import Geod, Transformer
from terrainav.core.benchmark.answers import Answer, Predictions, visible_query
from terrainav.core.benchmark.folder import Benchmark
from terrainav.core.benchmark.loading import Pairs
from terrainav.core.benchmark.making import make_benchmark
from terrainav.core.benchmark.page import write_scores
from terrainav.core.benchmark.planning import BenchmarkSettings, plan_benchmark
from terrainav.core.benchmark.running import method_named, run_method
from terrainav.core.benchmark.scoring import score
from terrainav.core.benchmark.silhouettes import Silhouettes
from terrainav.core.dataset.loading import Batches
from terrainav.core.errors import Cancelled, InvalidInput
from terrainav.core.imagery.opening import open_source
from terrainav.core.picture.heights import mission_heights

from tests.core.benchmark.conftest import EPSG, HEIGHT, NORTH, WEST, WIDTH, mission
from tests.support import rasters

GEOD = Geod(ellps="WGS84")
LEVEL_M = 30.0


def boxes(rng):
    """Footprints on a grid of 40 m: west, south, width, depth and height in metres."""
    found = []
    for x in range(20, WIDTH - 40, 40):
        for y in range(20, HEIGHT - 40, 40):
            wide, deep = rng.uniform(8.0, 24.0, 2)
            found.append((WEST + x, NORTH - HEIGHT + y, wide, deep, rng.uniform(4.0, 15.0)))
    return found


@pytest.fixture(scope="module")
def houses(tmp_path_factory):
    """GeoJSON file of buildings over the rasters."""
    to_degrees = Transformer.from_crs(EPSG, 4326, always_xy=True)
    features = []
    for west, south, wide, deep, high in boxes(np.random.default_rng(5)):
        x, y = [west, west + wide, west + wide, west, west], [south, south, south + deep, south + deep, south]
        ring = list(zip(*to_degrees.transform(x, y)))
        geometry = {"type": "Polygon", "coordinates": [ring]}
        features.append({"type": "Feature", "geometry": geometry, "properties": {"height": high}})
    path = tmp_path_factory.mktemp("houses") / "houses.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


@pytest.fixture(scope="module")
def slope(tmp_path_factory):
    """Heights that rise by 40 m to the east, with waves, in pixels of 5 m."""
    x, y = np.meshgrid(np.arange(0.0, WIDTH + 400.0, 5.0), np.arange(0.0, HEIGHT + 400.0, 5.0))
    heights = 40.0 * x / WIDTH + 6.0 * np.sin(x / 35.0) * np.cos(y / 45.0)
    placed = (WEST - 200.0, 5.0, 0.0, NORTH + 200.0, 0.0, -5.0)
    return rasters.write(tmp_path_factory.mktemp("slope") / "slope.tif", heights[np.newaxis].astype("f4"), placed, EPSG)


def settings_of(dates, houses, elevation, count=6, **values):
    asked = mission(count, elevation=(str(elevation),), **{"image_px": 96, **values})
    return BenchmarkSettings(asked, (dates["new"],), dates["old"], split="none", reference_buildings=(str(houses),))


def make(folder, settings, **options):
    sources = {str(one): open_source(one.source) for one in (settings.reference, *settings.imageries)}
    grids = {name: source.grid for name, source in sources.items()}
    planned = plan_benchmark(settings, grids, mission_heights(settings.queries))
    return make_benchmark(planned, sources, folder, **options).benchmark


@pytest.fixture(scope="module")
def tilted(tmp_path_factory, dates, houses, slope):
    """Queries tilted by 40 degrees over a slope."""
    return make(tmp_path_factory.mktemp("tilted") / "made", settings_of(dates, houses, slope, tilt_deg=40.0))


@pytest.fixture(scope="module")
def level(tmp_path_factory, dates, houses):
    """Queries that look straight down on level ground."""
    return make(tmp_path_factory.mktemp("level") / "made", settings_of(dates, houses, f"{LEVEL_M:g}"))


def answers(benchmark, *, east_m=0.0, up_m=0.0, yaw_deg=0.0):
    """True poses, but for a shift to the east and up, and a turn."""
    queries, found = benchmark.queries, []
    for at in range(len(queries)):
        lat, lon = float(queries.lat_deg[at]), float(queries.lon_deg[at])
        if east_m:
            lon, lat, _ = GEOD.fwd(lon, lat, 90.0, east_m)
        angles = queries.yaw_deg[at] + yaw_deg, queries.tilt_deg[at], queries.roll_deg[at]
        found.append(Answer((), lat, lon, float(queries.height_m[at]) + up_m, *map(float, angles)))
    return found


def scored(benchmark, found):
    index = [at for at, one in enumerate(found) if one is not None]
    given = [one for one in found if one is not None]
    return score(benchmark, Predictions.from_answers(benchmark, index, given, [math.nan] * len(given)))


def figures(scores):
    (found,) = scores.groups.values()
    return {one.name: one.value for one in found}


def test_true_poses_have_all_shares_and_an_overlap_of_exactly_1(tilted, level):
    for benchmark in (tilted, level):
        scores = scored(benchmark, answers(benchmark))
        found = figures(scores)
        assert [found[f"within {n} m, {n} deg"] for n in (2, 3, 5)] == [1.0, 1.0, 1.0]
        assert (scores.errors.mask_iou == 1.0).all()
        assert found["mask IoU"] == 1.0
        assert len(benchmark.queries) >= 5
        masks = [Silhouettes.from_benchmark(benchmark).mask(at) for at in range(len(benchmark.queries))]
        assert all(0.05 < mask.mean() < 0.95 for mask in masks)


def test_true_poses_in_a_file_have_an_overlap_of_exactly_1(tilted, tmp_path):
    path = tmp_path / "answers.csv"
    given = answers(tilted)
    Predictions.from_answers(tilted, range(len(given)), given, [1.0] * len(given)).write(path, tilted)
    assert figures(score(tilted, Predictions.read(path, Benchmark.read(tilted.folder))))["mask IoU"] == 1.0


@pytest.mark.parametrize(
    ("shift", "wanted"),
    [
        ({"east_m": 2.5}, (0.0, 1.0, 1.0)),
        ({"up_m": -4.0}, (0.0, 0.0, 1.0)),
        ({"east_m": 6.0}, (0.0, 0.0, 0.0)),
        ({"yaw_deg": 2.5}, (0.0, 1.0, 1.0)),
        ({"yaw_deg": -1.5, "east_m": 1.5}, (1.0, 1.0, 1.0)),
    ],
)
def test_shifted_poses_fall_between_the_limits(tilted, shift, wanted):
    found = figures(scored(tilted, answers(tilted, **shift)))
    assert tuple(found[f"within {n} m, {n} deg"] for n in (2, 3, 5)) == wanted
    assert 0.2 < found["mask IoU"] < 1.0


def test_overlap_equals_that_of_boxes_drawn_by_hand(level):
    """Straight down on level ground a box shows its roof, nearer to the camera than its foot, and its walls between."""
    queries, shift_m = level.queries, 3.0
    to_metres = Transformer.from_crs(4326, EPSG, always_xy=True)

    def drawn(at, lat, lon):
        """Mask of four times the size, from a plane around the camera in metres east and north."""
        finer, (wide, high) = 8, (int(queries.width_px[at]), int(queries.height_px[at]))
        picture = Image.new("1", (wide * finer, high * finer))
        turn = np.radians(queries.yaw_deg[at])
        x, y = to_metres.transform(lon, lat)
        to_degrees = Transformer.from_crs(EPSG, 4326, always_xy=True)
        for west, south, across, deep, height in boxes(np.random.default_rng(5)):
            if np.hypot(west - x, south - y) > 200.0:
                continue
            ring = []
            for corner_x, corner_y in ((0, 0), (across, 0), (across, deep), (0, deep)):
                corner = to_degrees.transform(west + corner_x, south + corner_y)
                azimuth, _, far = GEOD.inv(lon, lat, *corner)
                ring.append((far * np.sin(np.radians(azimuth)), far * np.cos(np.radians(azimuth))))
            shown = []
            for up in (0.0, height):
                depth = queries.height_m[at] - LEVEL_M - up
                shown.append(
                    [
                        (
                            (queries.cx_px[at] + queries.fx_px[at] * (e * np.cos(turn) - n * np.sin(turn)) / depth)
                            * finer,
                            (queries.cy_px[at] - queries.fy_px[at] * (e * np.sin(turn) + n * np.cos(turn)) / depth)
                            * finer,
                        )
                        for e, n in ring
                    ]
                )
            low, top = shown
            draw = ImageDraw.Draw(picture)
            for one in (low, top, *([low[k], low[k - 1], top[k - 1], top[k]] for k in range(4))):
                draw.polygon(one, fill=1)
        return np.asarray(picture)[finer // 2 :: finer, finer // 2 :: finer]

    moved = answers(level, east_m=shift_m)
    found = scored(level, moved).errors.mask_iou
    silhouettes = Silhouettes.from_benchmark(level)
    for at, one in enumerate(moved):
        mask, other = drawn(at, queries.lat_deg[at], queries.lon_deg[at]), drawn(at, one.lat_deg, one.lon_deg)
        assert (silhouettes.mask(at) == mask).mean() > 0.99
        assert found[at] == pytest.approx((mask & other).sum() / (mask | other).sum(), abs=0.02)


def test_bad_answers_count_nothing_and_stop_nothing(tilted):
    true = answers(tilted)
    bad = [
        replace(true[0], height_m=-500.0),
        replace(true[0], height_m=math.nan),
        replace(true[0], lat_deg=true[0].lat_deg + 20.0),
        replace(true[0], height_m=1e9),
        None,
        replace(true[0], tilt_deg=179.0),
    ]
    for one in bad:
        scores = scored(tilted, [one, *true[1:]])
        assert scores.errors.mask_iou.tolist() == [0.0] + [1.0] * (len(true) - 1)
        assert figures(scores)["within 5 m, 5 deg"] == pytest.approx(1.0 - 1.0 / len(true))
        assert figures(scores)["mask IoU"] == pytest.approx(1.0 - 1.0 / len(true))


def test_answers_without_poses_have_no_figures_of_silhouettes(tilted):
    found = figures(scored(tilted, [replace(one, height_m=math.nan, yaw_deg=math.nan) for one in answers(tilted)]))
    assert "mask IoU" not in found


def test_scoring_reports_progress_and_can_be_cancelled(tilted):
    count = len(tilted.queries)
    given = Predictions.from_answers(tilted, range(count), answers(tilted), [1.0] * count)
    seen = []
    score(tilted, given, progress=lambda done, total: seen.append((done, total)))
    assert seen == [(at + 1, count) for at in range(count)]
    with pytest.raises(Cancelled):
        score(tilted, given, cancelled=lambda: True)


def test_the_folder_holds_the_model_and_the_masks(tilted, houses, tmp_path):
    copy = tilted.folder / "reference" / "buildings" / "houses.geojson"
    assert copy.read_bytes() == houses.read_bytes()
    about = json.loads((tilted.folder / "benchmark.json").read_text())
    assert about["buildings"]["files"] == ["reference/buildings/houses.geojson"]
    assert about["reference_buildings"] == [str(houses)]
    assert about["queries"]["output"]["products"] == ["classes", "instances"]
    assert visible_query(tilted, 0).instances == tilted.instance_file(0)
    page = write_scores(tilted, scored(tilted, answers(tilted, east_m=1.0)), tmp_path / "page", "mine")
    rows = list(csv.DictReader((page.parent / "errors.csv").read_text().splitlines()))
    assert 0.2 < float(rows[0]["mask_iou"]) < 1.0
    assert "mask IoU" in page.read_text()
    assert "houses.geojson" in page.read_text()
    shown = json.loads((page.parent / "errors.geojson").read_text())["features"][0]["properties"]
    assert shown["mask_iou"] == float(rows[0]["mask_iou"])


@pytest.mark.parametrize("loader", ["numpy", "torch"])
def test_pairs_have_the_buildings_of_their_queries(tilted, loader):
    plain, pairs = (Pairs(tilted, part="all", img_size=(60, 40, 3), instances=given) for given in (False, True))
    if loader == "torch":
        pytest.importorskip("torch")
        from terrainav.core.dataset.loading.torch_loader import TorchDataset

        batches = TorchDataset(pairs).batches(4)
    else:
        batches = Batches(pairs, 4)
    shown = 0
    for at, (_, (instances, values)) in enumerate(batches):
        rows = range(4 * at, 4 * at + len(instances))
        assert instances.shape == (len(rows), 40, 60)
        assert str(instances.dtype).endswith("int64")
        np.testing.assert_array_equal(np.asarray(values), plain.take(rows)[1])
        for row, found in zip(rows, np.asarray(instances)):
            image = Image.open(tilted.instance_file(pairs.query[row])).resize((60, 40), Image.NEAREST)
            np.testing.assert_array_equal(found, np.asarray(image))
            shown += len(np.unique(found)) - 1
    assert shown > len(pairs)


def test_pairs_of_other_benchmarks_have_no_buildings(benchmark):
    with pytest.raises(InvalidInput, match=r"instances: the benchmark in .* has no buildings"):
        Pairs(benchmark, part="all", instances=True)


def test_a_folder_is_judged_where_the_model_that_it_was_made_of_is_gone(tilted, houses):
    hidden = houses.with_suffix(".gone")
    houses.rename(hidden)
    try:
        assert figures(scored(tilted, answers(tilted)))["mask IoU"] == 1.0
    finally:
        hidden.rename(houses)


def test_an_interrupted_run_ends_with_the_same_bytes(tilted, dates, houses, slope, tmp_path):
    settings = settings_of(dates, houses, slope, tilt_deg=40.0)
    make(tmp_path / "again", settings)
    make(tmp_path / "again", settings, resume=True)
    for name in ("benchmark.json", "queries.csv", "positives.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (tilted.folder / name).read_bytes()


def test_other_benchmarks_have_no_trace_of_buildings(benchmark, tmp_path):
    about = json.loads((benchmark.folder / "benchmark.json").read_text())
    assert not {"buildings", "reference_buildings"} & {*about}
    assert visible_query(benchmark, 0).instances is None
    page = write_scores(benchmark, scored_all(benchmark), tmp_path / "page", "mine", diagrams=False)
    assert "mask_iou" not in (page.parent / "errors.csv").read_text() + (page.parent / "errors.geojson").read_text()
    assert "LoD-Loc" not in page.read_text()


def scored_all(benchmark):
    given = answers(benchmark)
    return score(benchmark, Predictions.from_answers(benchmark, range(len(given)), given, [1.0] * len(given)))


def test_queries_may_show_other_buildings_than_the_model(dates, houses, slope, tmp_path):
    """Such as a coarse model to be found in images of a fine one."""
    higher = tmp_path / "higher.geojson"
    content = json.loads(houses.read_text())
    for one in content["features"]:
        one["properties"]["height"] += 3.0
    higher.write_text(json.dumps(content))
    settings = settings_of(dates, houses, slope, tilt_deg=40.0, buildings=(str(higher),))
    found = make(tmp_path / "made", settings)
    assert 0.5 < figures(scored(found, answers(found)))["mask IoU"] < 1.0


def test_labels_and_two_files_of_one_name_are_refused(dates, houses, slope, tmp_path):
    with pytest.raises(InvalidInput, match=r"labels .*: must be left out of a benchmark with reference buildings"):
        settings_of(dates, houses, slope, labels=(str(houses),))
    other = tmp_path / houses.name
    other.write_bytes(houses.read_bytes())
    settings = replace(settings_of(dates, houses, slope), reference_buildings=(str(houses), str(other)))
    with pytest.raises(InvalidInput, match="another file has this name"):
        make(tmp_path / "made", settings)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"files": ["../houses.geojson"]}, "outside"),
        ({"files": None}, "does not say how to render"),
        ({"traced": {"new": {"tolerance_px": "x", "lowest_m": 0.0}}}, "does not say how to render"),
        ({"traced": {"new": {"tolerance_px": 0.1, "lowest_m": math.nan}}}, "does not say how to render"),
        ({"traced": {}}, "does not say how to render"),
    ],
)
def test_a_folder_that_was_tampered_with_is_refused(tilted, change, problem):
    changed = replace(tilted, about={**tilted.about, "buildings": {**tilted.about["buildings"], **change}})
    with pytest.raises(InvalidInput, match=problem):
        scored(changed, answers(tilted))


def test_silhouettes_beat_the_prior(tilted):
    prior, fitted = (figures(score(tilted, run_method(tilted, method_named(name)))) for name in ("prior", "silhouette"))
    assert fitted["mask IoU"] > prior["mask IoU"]
    assert fitted["mask IoU"] > 0.9
    assert fitted["within 2 m, 2 deg"] > prior["within 2 m, 2 deg"]


def test_silhouettes_need_buildings(benchmark):
    with pytest.raises(InvalidInput, match="has no buildings"):
        run_method(benchmark, method_named("silhouette"))
