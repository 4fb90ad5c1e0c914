"""The judge: errors and figures of answers whose errors are known, and files of answers and of scores."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from pyproj import Geod
from scipy.spatial.transform import Rotation
from terrainav.core.benchmark import answers
from terrainav.core.benchmark import page as pages
from terrainav.core.benchmark.answers import Answer, Predictions
from terrainav.core.benchmark.folder import Benchmark, Positives
from terrainav.core.benchmark.page import write_scores
from terrainav.core.benchmark.scoring import score
from terrainav.core.errors import InvalidInput

from tests.support.thinning import sampled

WGS84 = Geod(ellps="WGS84")


def figures(scores, group="all"):
    return {one.name: one.value for one in scores.groups[group]}


def truth(benchmark, **changes):
    """Answers that are right, but for changes: a shift to the north in m, to the yaw in degrees, up in m."""
    queries = benchmark.queries
    answers = []
    positives = benchmark.positives()
    for at in range(len(queries)):
        lon, lat, _ = WGS84.fwd(queries.lon_deg[at], queries.lat_deg[at], 0.0, changes.get("north_m", 0.0))
        answers.append(
            Answer(
                [benchmark.references.id[tile] for tile in positives[at]],
                lat,
                lon,
                queries.height_m[at] + changes.get("up_m", 0.0),
                queries.yaw_deg[at] + changes.get("yaw_deg", 0.0),
                queries.tilt_deg[at] + changes.get("tilt_deg", 0.0),
                queries.roll_deg[at],
            )
        )
    rows = range(len(queries))
    return Predictions.from_answers(benchmark, rows, answers, [0.25] * len(queries))


def test_a_file_whose_column_is_there_twice_is_refused(benchmark, tmp_path):
    """Nobody knows which of them is meant."""
    path = tmp_path / "p.csv"
    path.write_text(f"query,lat_deg,lon_deg,lat_deg\n{benchmark.queries.id[0]},35.1,-89.9,36.1\n")
    with pytest.raises(InvalidInput, match="has column lat_deg more than once"):
        Predictions.read(path, benchmark)


def test_a_ranking_takes_no_more_room_than_the_limit(benchmark, tmp_path, monkeypatch):
    """Rankings are as long as the longest one: of 20,000 queries one with 20,000 tiles had all take 3 GB each time."""
    tiles, queries = benchmark.references.id, benchmark.queries.id
    most = 3
    monkeypatch.setattr(answers, "MAX_RANKED", most * len(queries) + 1)
    path = tmp_path / "p.csv"
    for count in (most, most + 1):
        rows = [f"{queries[0]},{tiles[0]}", f"{queries[1]},{' '.join(tiles[:count])}"]
        path.write_text("\n".join(["query,references", *rows, ""]))
        if count == most:
            assert Predictions.read(path, benchmark).ranking.shape == (2, most)
            continue
        with pytest.raises(InvalidInput, match=f"query '{queries[1]}' ranks 4 tiles, .* may rank 3 at most"):
            Predictions.read(path, benchmark)


def test_what_is_right_has_no_error(benchmark):
    scores = score(benchmark, truth(benchmark))
    found = figures(scores)
    assert scores.errors.error_m.max() < 1e-6
    assert scores.errors.distance_m.max() < 1e-6
    assert scores.errors.error_deg.max() < 1e-6
    assert found["recall@1"] == found["recall@1%"] == found["AP"] == found["AP trapezoid"] == 1.0
    assert found["within 1 m"] == found["within 0.1 m, 1 deg"] == 1.0
    assert found["queries"] == 24
    assert found["time"] == 0.25
    assert list(scores.groups) == ["all", "old", "new"]
    assert figures(scores, "old")["queries"] == 12


@pytest.mark.parametrize("north_m", [2.0, 4.5, 800.0])
def test_a_shift_is_the_error_of_all(benchmark, north_m):
    scores = score(benchmark, truth(benchmark, north_m=north_m))
    found = figures(scores)
    assert scores.errors.error_m == pytest.approx(north_m, abs=1e-6)
    # Through the ground and 60 m above it: chords of arcs.
    assert scores.errors.distance_m == pytest.approx(north_m * (1.0 + 60.0 / 6.36e6), rel=1e-6)
    assert found["position"] == pytest.approx(north_m)
    for limit in (1, 3, 5, 10, 20):
        assert found[f"within {limit} m"] == float(north_m <= limit)
    assert found["within 5 m, 10 deg"] == float(north_m < 5.0)


def test_heights_count_in_space_and_not_along_the_ground(benchmark):
    scores = score(benchmark, truth(benchmark, up_m=3.0))
    assert scores.errors.error_m.max() < 1e-6
    assert scores.errors.distance_m == pytest.approx(3.0, abs=1e-6)


@pytest.mark.parametrize(("yaw", "tilt"), [(7.0, 0.0), (0.0, -3.0), (190.0, 20.0)])
def test_angles_are_those_between_the_rotations(benchmark, yaw, tilt):
    found = score(benchmark, truth(benchmark, yaw_deg=yaw, tilt_deg=tilt)).errors.error_deg
    queries = benchmark.queries
    for at in range(len(queries)):
        # Intrinsic rotations about down, right wing and nose.
        own, other = (
            Rotation.from_euler("ZYX", [queries.yaw_deg[at] + a, queries.tilt_deg[at] + b, queries.roll_deg[at]], True)
            for a, b in ((0.0, 0.0), (yaw, tilt))
        )
        angle = math.degrees((own.inv() * other).magnitude())
        assert found[at] == pytest.approx(angle, abs=1e-6)


def test_queries_without_an_answer_are_not_found(benchmark):
    half = [at for at in range(len(benchmark.queries)) if benchmark.queries.imagery[at] == "old"]
    whole = truth(benchmark)
    some = Predictions(whole.index[half], whole.ranking[half], whole.pose[half], whole.seconds[half])
    found = figures(score(benchmark, some))
    assert found["within 1 m"] == found["recall@1"] == 0.5
    assert found["position"] < 1e-6
    others = figures(score(benchmark, some), "new")
    assert math.isnan(others["position"])
    assert others["within 20 m"] == others["within 5 m, 10 deg"] == 0.0


def test_a_part_is_judged_by_itself(benchmark):
    scores = score(benchmark, truth(benchmark), "test")
    assert figures(scores)["queries"] == 6
    with pytest.raises(InvalidInput, match="part 'nothing': must be one of train, validation, test"):
        score(benchmark, truth(benchmark), "nothing")


def test_without_a_split_there_are_no_parts(benchmark):
    queries = replace(benchmark.queries, part=("",) * len(benchmark.queries))
    whole = Benchmark(**{**vars_of(benchmark), "queries": queries})
    with pytest.raises(InvalidInput, match=r"part 'test': the benchmark in .* was made without parts"):
        score(whole, truth(whole), "test")


def test_scores_name_their_part(benchmark, tmp_path):
    scores = score(benchmark, truth(benchmark), "test")
    page = write_scores(benchmark, scores, tmp_path, "mine", diagrams=False)
    assert "<h1>mine, part test</h1>" in page.read_text(encoding="utf-8")
    document = json.loads((tmp_path / "scores.json").read_text(encoding="utf-8"))
    assert (document["method"], document["part"]) == ("mine", "test")


def test_ranks_and_distances_are_those_of_the_tiles(benchmark):
    tiles = benchmark.references
    order = np.random.default_rng(9).permutation(len(tiles))[:20]
    answers = [Answer([tiles.id[at] for at in order])] * len(benchmark.queries)
    predictions = Predictions.from_answers(benchmark, range(len(answers)), answers, [math.nan] * len(answers))
    errors = score(benchmark, predictions).errors
    positives = benchmark.positives()
    for at in range(len(benchmark.queries)):
        ranks = [rank for rank, tile in enumerate(order, 1) if tile in positives[at]]
        assert errors.rank[at] == ranks[0] if ranks else math.isnan(errors.rank[at])
        _, _, distance = WGS84.inv(
            benchmark.queries.centre_lon_deg[at],
            benchmark.queries.centre_lat_deg[at],
            tiles.lon_deg[order[0]],
            tiles.lat_deg[order[0]],
        )
        assert errors.tile_m[at] == pytest.approx(distance, abs=1e-6)
    assert np.isnan(errors.error_m).all()


def test_queries_without_a_right_tile_do_not_count_in_recall(benchmark):
    none = Benchmark(**{**vars_of(benchmark), "truth": Positives((), (), (), np.empty(0))})
    found = figures(score(none, truth(benchmark)))
    assert math.isnan(found["recall@1"])
    assert math.isnan(found["AP"])


def vars_of(benchmark):
    names = ("folder", "about", "mosaic", "queries", "references", "truth")
    return {name: getattr(benchmark, name) for name in names}


def test_predictions_are_read_as_they_were_written(benchmark, tmp_path):
    whole = truth(benchmark, north_m=3.0)
    whole.write(tmp_path / "mine.csv", benchmark)
    again = Predictions.read(tmp_path / "mine.csv", benchmark)
    assert np.array_equal(again.index, whole.index)
    assert np.array_equal(again.ranking, whole.ranking)
    assert np.array_equal(again.pose, whole.pose)


def test_a_file_of_positions_alone_is_enough(benchmark, tmp_path):
    name = benchmark.queries.id[0]
    (tmp_path / "mine.csv").write_text(f"query,lat_deg,lon_deg,model\n{name},35.1,-89.9,net 7\n")
    found = Predictions.read(tmp_path / "mine.csv", benchmark)
    assert found.pose[0, :2].tolist() == [35.1, -89.9]
    assert found.ranking.shape == (1, 0)
    assert figures(score(benchmark, found))["queries"] == 24


def lines(benchmark):
    """Bad files, with what is said of them; {q} and {r} are a query and a tile that are there."""
    return {
        "": "is empty",
        "query,lat,lon\n": "need the column query, and references or lat_deg, lon_deg; its columns are query, lat, lon",
        "name,lat_deg,lon_deg\n": "need the column query",
        "query,lat_deg\n{q},1\n": "lat_deg and lon_deg go together",
        "query,references\n": "answer no query",
        "query,references\nnobody,{r}\n": "line 2: query 'nobody' is not in the benchmark",
        "query,references\n{q},{r}\n{q},{r}\n": "line 3: query '{q}' is answered in line 2 already",
        "query,references\n{q},{r} {r}\n": "one is named twice",
        "query,references\n{q},elsewhere\n": "reference 'elsewhere' of query '{q}' is not in the benchmark",
        "query,lat_deg,lon_deg\n{q},north,1\n": "line 2: lat_deg 'north': must be a number",
        "query,lat_deg,lon_deg\n{q},nan,1\n": "lat_deg 'nan': must be a finite number",
        "query,lat_deg,lon_deg\n{q},95,1\n": "95, 1 is not on the Earth",
        "query,lat_deg,lon_deg\n{q},1\n": "line 2: has 2 cells, not 3",
        'query,references\n"{q}': "is not CSV",
    }


def test_bad_predictions_are_refused_by_their_line(benchmark, tmp_path):
    known = {"q": benchmark.queries.id[3], "r": benchmark.references.id[5]}
    for text, said in lines(benchmark).items():
        path = tmp_path / "bad.csv"
        path.write_text(text.format(**known))
        with pytest.raises(InvalidInput) as refused:
            Predictions.read(path, benchmark)
        assert said.format(**known) in str(refused.value), text
        assert "\n" not in str(refused.value)
    with pytest.raises(InvalidInput, match="cannot be read"):
        Predictions.read(tmp_path / "missing.csv", benchmark)
    (tmp_path / "bad.csv").write_bytes(b"query,references\n\xff\xfe,x\n")
    with pytest.raises(InvalidInput, match="cannot be read"):
        Predictions.read(tmp_path / "bad.csv", benchmark)


def test_tiles_of_another_part_are_no_answer(benchmark):
    tiles = benchmark.references
    parts = tuple("train" if at % 2 else "test" for at in range(len(tiles)))
    other = type(tiles)(**{**{name: getattr(tiles, name) for name in vars(tiles)}, "part": parts})
    cut = Benchmark(**{**vars_of(benchmark), "references": other})
    answers = [Answer([tiles.id[1]])] * len(benchmark.queries)
    predictions = Predictions.from_answers(cut, range(len(answers)), answers, [math.nan] * len(answers))
    with pytest.raises(InvalidInput, match=r"^predictions: rank .* of another part than the queries"):
        score(cut, predictions, "test")


@pytest.mark.parametrize("imageries", sampled([1, 2], 2))
def test_the_page_shows_the_figures_and_leaves_the_numbers(benchmark, tmp_path, imageries):
    whole = truth(benchmark, north_m=12.0)
    rows = np.arange(24) if imageries == 2 else np.arange(12)
    some = Predictions(whole.index[rows], whole.ranking[rows], whole.pose[rows], whole.seconds[rows])
    page = write_scores(benchmark, score(benchmark, some), tmp_path / "scores", "twelve <metres>")
    text = page.read_text(encoding="utf-8")
    assert "twelve &lt;metres&gt;" in text
    assert "12 m" in text
    for name in ("recall.png", "within.png", "map.png", "failures.png"):
        assert name in text
        assert (page.parent / name).stat().st_size > 5_000
    document = json.loads((page.parent / "scores.json").read_text(encoding="utf-8"))
    assert {one["name"]: one["value"] for one in document["groups"]["old"]}["position"] == pytest.approx(12.0)
    with (page.parent / "errors.csv").open(newline="") as file:
        errors = list(csv.DictReader(file))
    assert len(errors) == 24
    features = json.loads((page.parent / "errors.geojson").read_text(encoding="utf-8"))["features"]
    for feature, row in zip(features, errors):
        assert feature["properties"]["query"] == row["query"]
        assert feature["geometry"]["coordinates"] == [float(row["lon_deg"]), float(row["lat_deg"])]
        assert (feature["properties"]["error_m"] is None) == (row["error_m"] == "")


def test_failures_are_told_by_their_ids(benchmark, monkeypatch):
    sheets = []
    monkeypatch.setattr(pages, "png", sheets.append)
    errors = score(benchmark, truth(benchmark, north_m=12.0)).errors
    pages._failures(benchmark, errors, "mine")
    (sheet,) = sheets
    titles = {axes.get_title().partition("\n")[0] for axes in sheet.axes}
    assert len(titles & set(errors.query)) == 4


def test_a_page_without_positions_has_no_map_of_them(benchmark, tmp_path):
    first = benchmark.references.id[0]
    answers = [Answer([first])] * 24
    predictions = Predictions.from_answers(benchmark, range(24), answers, [math.nan] * 24)
    page = write_scores(benchmark, score(benchmark, predictions), tmp_path, "tiles")
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["recall.png"]
    assert "map.png" not in page.read_text(encoding="utf-8")


@pytest.mark.parametrize("place", [(90.0, 0.0), (-90.0, 12.0), (0.0, 10.0)])
@pytest.mark.parametrize("side_m", [100.0, 1e12])
def test_pictures_of_predictions_far_off_are_small_and_black(benchmark, place, side_m):
    whole = Image.new("RGB", (40, 30), "white")
    picture = pages._cut_out(whole, benchmark, place, side_m)
    assert picture.width == picture.height < 1000
    assert picture.getextrema() == ((0, 0),) * 3
