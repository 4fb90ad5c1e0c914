"""``terrainav benchmark``: made, run and judged from the command line."""

from __future__ import annotations

import json

import pytest

from tests.support.command import command

BOX = "35.150_-89.900_35.1475_-89.8965_60"


@pytest.fixture
def terrainav(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def make(terrainav, *more):
    return terrainav(
        "benchmark",
        "make",
        *("--coords", BOX, "--image-px", "80", "--format", "png"),
        *("--queries", "air=world", "--reference", "map=world:roadmap"),
        *("--split", "same-area", "--data-dir", "bench", "--quiet", *more),
    )


@pytest.mark.thorough
def test_the_walk_from_nothing_to_figures(terrainav, tmp_path):
    made = make(terrainav)
    assert made.returncode == 0, made.stderr
    assert "benchmark in bench" in made.stdout
    run = terrainav("benchmark", "run", "bench", "--method", "middle", "--quiet")
    assert run.returncode == 0, run.stderr
    assert "recall@1" in run.stdout
    assert "mean of exp(-5000 d), d in degrees" in run.stdout
    assert (tmp_path / "bench/scores/middle/index.html").is_file()
    predictions = tmp_path / "bench/scores/middle/middle.csv"
    answered, asked = (len(path.read_text().splitlines()) for path in (predictions, tmp_path / "bench/queries.csv"))
    assert answered == asked > 10
    judged = terrainav("benchmark", "score", "bench", str(predictions), "--part", "test", "--json", "--output", "page")
    assert judged.returncode == 0, judged.stderr
    document = json.loads(judged.stdout)
    assert list(document["groups"]) == ["air"]
    assert (tmp_path / "page/index.html").is_file()
    part = terrainav(
        *("benchmark", "run", "bench", "--method", "middle", "--part", "test"),
        *("--quiet", "--no-page", "--json"),
    )
    assert json.loads(part.stdout)["part"] == "test"
    answers = (tmp_path / "bench/scores/middle-test/middle.csv").read_text().splitlines()
    assert 1 < len(answers) < answered
    assert len(predictions.read_text().splitlines()) == answered
    again = make(terrainav)
    assert again.returncode == 3
    assert "already holds this benchmark; resume it (--resume) or choose another folder" in again.stderr
    assert make(terrainav, "--resume").returncode == 0


def test_parts_that_would_be_empty_are_refused_before_anything_is_captured(terrainav, tmp_path):
    asked = (
        *("benchmark", "make", "--coords", "35.15_-89.9_35.1475_-89.8975_60", "--image-px", "40", "--quiet"),
        *("--queries", "air=world", "--reference", "air=world", "--tiles", "60", "--margin", "0"),
        *("--format", "png", "--data-dir", "bench"),
    )
    refused = terrainav(*asked, "--gap", "150")
    assert refused.returncode == 2
    assert "choose a smaller gap, an area " in refused.stderr
    assert not (tmp_path / "bench").exists()
    # As advised, though 60 m of ground are not much.
    found = terrainav(*asked)
    assert found.returncode == 0, found.stderr
    counts = {line[:24].rstrip(): line[24:] for line in found.stdout.splitlines()}
    assert list(counts)[-5:-1] == ["train", "validation", "test", "gap"]
    assert counts["queries without a tile"].isdigit()
    queries = {part: int(counts[part].split()[0]) for part in ("train", "validation", "test", "gap")}
    assert queries["gap"] <= sum(queries.values()) / 2
    assert min(queries.values()) > 0
    none = terrainav(*asked, "--shares", "0.9", "0", "0.1", "--data-dir", "two")
    assert none.returncode == 0, none.stderr
    none = terrainav("benchmark", "run", "two", "--method", "middle", "--part", "validation")
    assert none.returncode == 2
    assert "part 'validation': the benchmark in two has no such queries" in none.stderr


def test_a_dry_run_says_what_would_be_captured_and_leaves_nothing(terrainav, tmp_path):
    found = make(terrainav, "--dry-run")
    assert found.returncode == 0
    assert "reference/mosaic" in found.stdout
    assert "queries/air" in found.stdout
    assert not (tmp_path / "bench").exists()


def test_imagery_without_a_name_is_called_as_its_source(terrainav):
    found = make(terrainav, "--dry-run", "--queries", "Synthetic (offline)", "world:roadmap")
    assert found.returncode == 0, found.stderr
    assert "queries/Synthetic-offline" in found.stdout
    assert "queries/world-roadmap" in found.stdout


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("benchmark",), "benchmark: needs one of make, run, score"),
        (("benchmark", "run", "nowhere", "--method", "ncc"), "folder nowhere: is not a benchmark"),
        (("benchmark", "score", "nowhere", "mine.csv"), "folder nowhere: is not a benchmark"),
    ],
)
def test_bad_input_is_one_line(terrainav, arguments, said):
    found = terrainav(*arguments)
    assert found.returncode == 2
    assert said in found.stderr
    assert len(found.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--queries", "world", "a=world:roadmap", "World"), "imagery 'World': is named twice"),
        (("--reference", "a=nowhere"), "nowhere"),
        (("--queries", "a=world", "A=world"), "imagery 'A': is named twice"),
        (("--tiles", "-5"), "tiles of -5.0 m: must be wider than 0"),
        (("--data-dir", ""), "data folder ''"),
        (("--tile-overlap", "120%"), "'120%': must be a share from 0 to below 1"),
    ],
)
def test_bad_benchmarks_are_one_line(terrainav, tmp_path, more, said):
    found = make(terrainav, *more)
    assert found.returncode == 2
    assert said in found.stderr
    assert len(found.stderr.splitlines()) == 1
    assert not (tmp_path / "bench").exists()


def test_buildings_to_be_found_in(terrainav, tmp_path):
    """Queries of a dozen houses, answered with their priors."""
    houses = [
        [[lon, lat], [lon + 1e-4, lat], [lon + 1e-4, lat + 1e-4], [lon, lat + 1e-4], [lon, lat]]
        for lat in (35.1478, 35.1486, 35.1494)
        for lon in (-89.8998, -89.8988, -89.8978, -89.8968)
    ]
    features = [
        {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [ring]}, "properties": {"height": 6}}
        for ring in houses
    ]
    (tmp_path / "houses.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    refused = make(terrainav, "--reference-buildings", "houses.geojson")
    assert refused.returncode == 2
    assert "buildings houses.geojson: need an elevation" in refused.stderr
    made = make(terrainav, "--reference-buildings", "houses.geojson", "--elevation", "20", "--overlap", "0")
    assert made.returncode == 0, made.stderr
    run = terrainav("benchmark", "run", "bench", "--method", "prior", "--quiet", "--json", "--no-page")
    assert run.returncode == 0, run.stderr
    figures = {one["name"]: one["value"] for one in json.loads(run.stdout)["groups"]["air"]}
    assert 0.0 < figures["mask IoU"] < 1.0
    assert figures["within 2 m, 2 deg"] <= figures["within 3 m, 3 deg"] <= figures["within 5 m, 5 deg"]
