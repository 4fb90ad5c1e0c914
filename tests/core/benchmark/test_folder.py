"""Folders that are no benchmark, or a broken one; and where the mosaic lies."""

from __future__ import annotations

import json
import math
import shutil

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.benchmark.folder import Benchmark, ReferenceMosaic
from terrainav.core.errors import InvalidInput


@pytest.fixture
def copy(benchmark, tmp_path):
    """Tables of a benchmark in a folder of their own, to be broken."""
    for path in benchmark.folder.glob("*.*"):
        shutil.copy(path, tmp_path / path.name)
    return tmp_path


def test_what_is_written_is_read(benchmark, copy):
    again = Benchmark.read(copy)
    assert again.queries.id == benchmark.queries.id
    assert np.array_equal(again.queries.fx_px, benchmark.queries.fx_px)
    assert again.truth.kind == benchmark.truth.kind
    assert again.mosaic == benchmark.mosaic


def test_sizes_of_images_are_whole_numbers_and_those_of_before_are_read(benchmark, copy):
    header, first = (line.split(",") for line in (copy / "queries.csv").read_text().splitlines()[:2])
    sizes = [first[header.index(name)] for name in ("width_px", "height_px")]
    assert all(size.isdigit() for size in sizes)
    replaced("queries.csv", ",".join(sizes), ",".join(f"{size}.0" for size in sizes))(copy)
    assert np.array_equal(Benchmark.read(copy).queries.width_px, benchmark.queries.width_px)


def replaced(name, old, new):
    def change(folder):
        path = folder / name
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    return change


def without(name):
    return lambda folder: (folder / name).unlink()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (without("benchmark.json"), "is not a benchmark, as benchmark.json cannot be read"),
        (lambda folder: (folder / "benchmark.json").write_text("{"), "is not a benchmark"),
        (
            lambda folder: (folder / "benchmark.json").write_text("[]"),
            "is not of a benchmark that this version can read",
        ),
        (
            replaced("benchmark.json", '"schema": 1', '"schema": 99'),
            "is not of a benchmark that this version can read",
        ),
        (replaced("benchmark.json", '"mosaic"', '"mosaik"'), "is not finished"),
        (replaced("benchmark.json", '"pixel_width"', '"pixels"'), "does not state where the mosaic lies"),
        (without("queries.csv"), "queries.csv: cannot be read"),
        (replaced("queries.csv", "fy_px", "lat_deg"), "queries.csv: has column lat_deg more than once"),
        (replaced("queries.csv", "fx_px", "focal"), "has no column fx_px"),
        (replaced("queries.csv", "old/", "old/,"), "line 2: has 20 cells, not 19"),
        (replaced("queries.csv", "queries/old", "/etc/passwd"), "is not a file of the benchmark"),
        (replaced("references.csv", "reference/tiles", "../../elsewhere"), "is not a file of the benchmark"),
        (replaced("positives.csv", "old/", "other/"), "which does not exist"),
    ],
)
def test_broken_ones_are_refused_in_one_line(copy, change, said):
    change(copy)
    with pytest.raises(InvalidInput) as refused:
        Benchmark.read(copy)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *(("width_px", value) for value in (0, -1, 1.5, "9", None, True, 10**12)),
        *(("pixel_height", value) for value in (0.0, -1.0, "x", [], 1e300)),
        *(("west", value) for value in (1e300, "x", None)),
        *(("crs", value) for value in ("EPSG:0", 5, "", "EPSG:4326", "EPSG:4979")),
        *(("file", value) for value in (5, "/etc/passwd", "../elsewhere.tif")),
    ],
)
def test_mosaics_that_cannot_be_are_refused(copy, name, value):
    about = json.loads((copy / "benchmark.json").read_text(encoding="utf-8"))
    about["mosaic"][name] = value
    (copy / "benchmark.json").write_text(json.dumps(about), encoding="utf-8")
    with pytest.raises(InvalidInput, match="does not state where the mosaic lies"):
        Benchmark.read(copy)


@pytest.mark.parametrize(
    ("table", "column", "value"),
    [
        ("queries.csv", "lat_deg", ""),
        ("queries.csv", "centre_lat_deg", "91"),
        ("queries.csv", "yaw_deg", "1e300"),
        ("queries.csv", "height_m", "1e308"),
        ("queries.csv", "fx_px", "0"),
        ("queries.csv", "width_px", "-5"),
        ("references.csv", "lon_deg", "1e9"),
        ("references.csv", "east", ""),
    ],
)
def test_numbers_that_cannot_be_are_named_with_their_row(copy, table, column, value):
    header, first, *rest = (copy / table).read_text(encoding="utf-8").splitlines()
    cells = dict(zip(header.split(","), first.split(",")))
    cells[column] = value
    (copy / table).write_text("\n".join([header, ",".join(cells.values()), *rest]) + "\n", encoding="utf-8")
    with pytest.raises(InvalidInput, match=f"{table}: {column} of '{cells['id']}' is .*; must be from"):
        Benchmark.read(copy)


@pytest.mark.parametrize("table", ["queries.csv", "references.csv"])
def test_rows_of_one_name_are_refused(copy, table):
    header, first, *rest = (copy / table).read_text(encoding="utf-8").splitlines()
    (copy / table).write_text("\n".join([header, first, *rest, first]) + "\n", encoding="utf-8")
    with pytest.raises(InvalidInput, match="appears twice"):
        Benchmark.read(copy)


def test_numbers_that_are_none_are_named_with_their_line(copy):
    rows = (copy / "queries.csv").read_text(encoding="utf-8").splitlines()
    cells = rows[2].split(",")
    rows[2] = ",".join([*cells[:8], "high", *cells[9:]])
    (copy / "queries.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    with pytest.raises(InvalidInput, match=r"line 3: height_m 'high': must be a number"):
        Benchmark.read(copy)


@pytest.mark.parametrize(
    ("crs", "west", "north", "lat", "lon"),
    [
        ("EPSG:32616", 230_000.0, 3_890_000.0, 35.11, -89.95),
        ("EPSG:3857", -10_013_000.0, 4_180_000.0, 35.1, -89.93),
        # Across the antimeridian, where EPSG:3857 goes on.
        ("EPSG:3857", 20_036_000.0, 4_180_000.0, 35.1, -179.995),
        ("EPSG:3031", -20_000.0, 20_000.0, -89.9, 30.0),
    ],
)
def test_places_in_the_mosaic_are_those_of_proj(crs, west, north, lat, lon):
    mosaic = ReferenceMosaic("mosaic.tif", crs, west, north, 2.0, 0.5, 4_000, 20_000)
    x, y = Transformer.from_crs(4326, crs, always_xy=True).transform(lon, lat)
    if crs == "EPSG:3857" and x < west:
        x += 2.0 * 20_037_508.342789244
    column, row = mosaic.px(np.array([lat]), np.array([lon]))
    assert column[0] == pytest.approx((x - west) / 2.0, abs=1e-6)
    assert row[0] == pytest.approx((north - y) / 0.5, abs=1e-6)
    again_lat, again_lon = mosaic.ground(column, row)
    assert again_lat[0] == pytest.approx(lat, abs=1e-10)
    assert abs(math.remainder(again_lon[0] - lon, 360.0)) < 1e-9


def test_json_of_a_benchmark_is_for_people(copy):
    assert json.loads((copy / "benchmark.json").read_text(encoding="utf-8"))["split"] == "same-area"
