"""Exports of any dataset: what is read back is what the tables and the folders of the dataset hold."""

from __future__ import annotations

import csv
import hashlib
import json
import os
from datetime import datetime
from pathlib import Path

import pytest
from osgeo import ogr
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import unix_seconds
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.exports.croissant import CROISSANT_FILE, write_croissant
from terrainav.core.exports.formats import export
from terrainav.core.exports.huggingface import write_huggingface
from terrainav.core.exports.kinds import DATASETS, KINDS, export_as, refusals
from terrainav.core.exports.tables import PARQUET_FILE, write_parquet
from terrainav.core.exports.views import Views
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.command import command
from tests.support.datasets import PARTS, write_dataset

#: Across the antimeridian, where a footprint has two pieces.
PLACES = ((35.0, 179.9999, 90.0), (35.0, 179.99, 100.0), (35.0001, 179.99, 100.5))
#: Unix seconds of three points.
START = datetime.fromisoformat("2026-05-04T10:00:00+00:00").timestamp()
TIMES = (START, START + 1.5, START + 7.25)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Camera frames with times."""
    folder = tmp_path_factory.mktemp("flown") / "out"
    source = open_source("world")
    area = Points(PLACES, (10.0, 20.0, -170.0), times_s=TIMES)
    asked = Mission(area, 90.0, tilt_deg=5.0, image_px=32, image_format="png")
    capture(plan(asked, source.grid), source, folder)
    return folder


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    """24 rows of two map types, of every part; the last but one rejected, the last failed."""
    return write_dataset(tmp_path_factory.mktemp("dataset") / "out", map_types=("satellite", "roadmap"))


def rows_of(table: Path) -> list[dict[str, str]]:
    with table.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_parquet_holds_the_table_with_types_and_null_for_what_is_not_known(flown):
    parquet = pytest.importorskip("pyarrow.parquet")
    (path,) = write_parquet(flown, flown)
    assert path == flown / "satellite" / PARQUET_FILE
    table = parquet.read_table(path)
    rows = rows_of(flown / "satellite" / "meta_data.csv")
    *names, geometry = table.column_names
    assert (names, geometry) == (list(rows[0]), "geometry")
    kinds = {name: str(table.schema.field(name).type) for name in names}
    assert kinds["columns"] == kinds["image_width_px"] == "int64"
    assert kinds["Lat"] == kinds["nominal_yaw_deg"] == "double"
    assert kinds["time_utc"] == "timestamp[us, tz=UTC]"
    for found, row in zip(table.to_pylist(), rows):
        for name, cell in row.items():
            if not cell:
                assert found[name] is None
            elif name == "time_utc":
                assert found[name] == datetime.fromisoformat(cell.replace("Z", "+00:00"))
            else:
                assert type(found[name])(cell) == found[name]


def test_footprints_are_those_of_the_capture_as_geoparquet_has_them(flown, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    (path,) = write_parquet(flown, tmp_path / "tables")
    table = parquet.read_table(path)
    shapes = [ogr.CreateGeometryFromWkb(shape) for shape in table["geometry"].to_pylist()]
    features = json.loads((flown / "footprints.geojson").read_text())["features"]
    drawn = {one["properties"]["name"]: json.dumps(one["geometry"]) for one in features}
    expected = [ogr.CreateGeometryFromJson(drawn[Path(name).stem]) for name in table["img_names"].to_pylist()]
    assert [one.ExportToWkt() for one in shapes] == [one.ExportToWkt() for one in expected]
    about = json.loads(table.schema.metadata[b"geo"])
    assert (about["version"], about["primary_column"]) == ("1.1.0", "geometry")
    column = about["columns"]["geometry"]
    assert column["encoding"] == "WKB"
    assert column["geometry_types"] == ["MultiPolygon", "Polygon"]
    whole = ogr.Geometry(ogr.wkbGeometryCollection)
    for one in expected:
        whole.AddGeometry(one)
    west, east, south, north = whole.GetEnvelope()
    assert column["bbox"] == [west, south, east, north]


def test_tables_of_others_go_without_footprints(dataset, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    paths = write_parquet(dataset, tmp_path / "tables")
    assert [path.relative_to(tmp_path).as_posix() for path in paths] == [
        f"tables/{one}/{PARQUET_FILE}" for one in ("roadmap", "satellite")
    ]
    table = parquet.read_table(paths[1])
    assert "geometry" not in table.column_names
    assert table["split"].to_pylist()[:8] == list(PARTS)
    assert table["entropies"].to_pylist()[-2:] == [5.0, None]
    with pytest.raises(OutputError, match="is not empty; choose another folder"):
        write_parquet(dataset, tmp_path / "tables")
    with pytest.raises(OutputError, match=r"^folder memory://tables: must be one of this machine$"):
        write_parquet(dataset, "memory://tables")


def test_hugging_face_gets_the_images_of_each_part_with_their_rows(dataset, tmp_path):
    card, *tables = write_huggingface(dataset, tmp_path / "hf")
    assert len(tables) == 6
    for map_type in ("satellite", "roadmap"):
        wanted = {one: set() for one in ("train", "validation", "test")}
        rows = rows_of(dataset / map_type / "meta_data.csv")
        by_name = {row["img_names"]: row for row in rows}
        for row in rows:
            wanted.get(row["split"], set()).add(row["img_names"])
        for part, names in wanted.items():
            folder = tmp_path / "hf" / map_type / part
            lines = [json.loads(line) for line in (folder / "metadata.jsonl").read_text().splitlines()]
            assert {one["file_name"] for one in lines} == names
            assert {one.name for one in folder.iterdir()} == {*names, "metadata.jsonl"}
            for one in lines:
                name = one["file_name"]
                assert (folder / name).read_bytes() == (dataset / map_type / name).read_bytes()
                assert one["Lat"] == float(by_name[name]["Lat"])
                assert set(one) == {
                    "file_name",
                    "columns",
                    "rows",
                    "Lat",
                    "Lon",
                    "Alt",
                    "entropies",
                    "status",
                    "split",
                }
    _, head, text = card.read_text(encoding="utf-8").split("---\n", 2)
    assert '- config_name: "satellite"\n  data_dir: "satellite"\n  default: true\n' in head
    assert (
        head.count('  - name: "Lat"\n    dtype: float64\n') == head.count('  - name: "image"\n    dtype: image\n') == 2
    )
    assert "| satellite | test | 3 |" in text


def test_without_a_split_all_images_are_in_one_folder(flown, tmp_path):
    card, table = write_huggingface(flown, tmp_path / "hf")
    assert table == tmp_path / "hf" / "satellite" / "metadata.jsonl"
    lines = [json.loads(line) for line in table.read_text().splitlines()]
    assert [one["time_utc"] for one in lines] == [
        f"2026-05-04T10:00:0{second}Z" for second in ("0.000", "1.500", "7.250")
    ]
    assert "satellite: Synthetic (offline), Synthetic landscape, TerrAInav" in card.read_text(encoding="utf-8")
    assert '"nominal_yaw_deg"' not in card.read_text(encoding="utf-8")


def test_a_dataset_without_images_of_a_part_is_refused(dataset, tmp_path):
    folder = write_dataset(tmp_path / "out", 2)
    with pytest.raises(InvalidInput, match="map type 'satellite': has no image to export"):
        write_huggingface(folder, tmp_path / "hf")
    with pytest.raises(InvalidInput, match="map type 'aerial'"):
        write_huggingface(dataset, tmp_path / "hf", "aerial")
    assert not (tmp_path / "hf").exists()


def test_croissant_describes_what_lies_there(dataset):
    (path,) = write_croissant(dataset, dataset)
    told = json.loads(path.read_text(encoding="utf-8"))
    assert path == dataset / CROISSANT_FILE
    assert (told["@type"], told["conformsTo"]) == ("sc:Dataset", "http://mlcommons.org/croissant/1.0")
    assert {"@context", "name", "description", "license", "distribution", "recordSet"} <= set(told)
    files = {one["@id"]: one for one in told["distribution"]}
    assert len(files) == 4
    for one in files.values():
        if one["@type"] == "cr:FileObject":
            data = (dataset / one["contentUrl"]).read_bytes()
            assert one["sha256"] == hashlib.sha256(data).hexdigest()
            assert one["encodingFormat"] == "text/csv"
        else:
            assert one["encodingFormat"] == ["image/png"]
            assert len([*dataset.glob(*one["includes"])]) == 23
    assert [one["@id"] for one in told["recordSet"]] == ["roadmap", "satellite"]
    for record in told["recordSet"]:
        fields = {one["@id"]: one for one in record["field"]}
        assert record["key"]["@id"] in fields
        kinds = {name.partition("/")[2]: one["dataType"] for name, one in fields.items()}
        assert [kinds[name] for name in ("image", "file", "Lat", "columns", "split")] == (
            ["sc:ImageObject", "sc:Text", "sc:Float", "sc:Integer", "sc:Text"]
        )
        for one in fields.values():
            for asked in (one["source"], one.get("references", {"extract": {}})):
                for kind in ("fileObject", "fileSet"):
                    assert asked.get(kind, {"@id": f"{record['@id']}/table"})["@id"] in files
                column = asked["extract"].get("column", "img_names")
                assert column in rows_of(dataset / record["@id"] / "meta_data.csv")[0]


def test_trajectories_have_the_times_of_the_table(flown, tmp_path):
    views = Views.read(flown)
    tum = (export(views, tmp_path / "tum", "tum") / "trajectory.txt").read_text().splitlines()
    assert tum[0].startswith("# timestamp ")
    assert [float(line.split()[0]) for line in tum[1:]] == list(TIMES)
    kitti = export(views, tmp_path / "kitti", "kitti")
    assert [float(line) for line in (kitti / "times.txt").read_text().splitlines()] == [0.0, 1.5, 7.25]


def test_what_is_no_time_is_refused():
    with pytest.raises(InvalidInput, match="time_utc 'noon': is not a time in ISO 8601"):
        unix_seconds(["", "noon"])


def test_the_command(dataset, tmp_path, monkeypatch, capsys):
    pytest.importorskip("pyarrow")
    run = command(tmp_path, monkeypatch, capsys)
    for format_ in DATASETS:
        target = ["hf"] if format_ == "huggingface" else []
        done = run("export", str(dataset), *target, "--as", format_, "--map-type", "roadmap")
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout.startswith("written     ")
    assert not (tmp_path / "hf" / "satellite").exists()
    refused = run("export", str(dataset), "--as", "huggingface")
    assert refused.returncode == 2
    assert refused.stderr == "terrainav: format huggingface: needs the folder to write to\n"


def test_what_a_folder_can_become_is_what_is_written(flown, dataset, tmp_path):
    """By trying all of it."""
    (tmp_path / "empty").mkdir()
    for number, folder in enumerate((flown, dataset, tmp_path / "empty")):
        for kind, reason in refusals(folder).items():
            target = folder if kind in ("croissant", "stac") else tmp_path / f"{kind}-{number}"
            try:
                written = export_as(folder, target, kind).written > 0
            except (InvalidInput, OutputError):
                written = False
            assert written == (reason is None), (folder, kind)
    assert set(refusals(flown)) == set(KINDS)


def test_a_stopped_export_is_told_how_far_it_is_and_leaves_nothing(dataset, tmp_path):
    told = []

    def stop(share):
        told.append(share)
        return len(told) < 3

    with pytest.raises(Cancelled):
        export_as(dataset, tmp_path / "hf", "huggingface", progress=stop)
    assert told == sorted(told)
    assert 0.0 < told[-1] < 1.0
    assert not (tmp_path / "hf").exists()
    told.clear()
    done = export_as(dataset, tmp_path / "hf", "huggingface", progress=lambda share: told.append(share) is None)
    assert told[-1] == 1.0
    # All that it wrote, images too.
    assert done.written == sum(len(files) for _, _, files in os.walk(tmp_path / "hf"))
    assert done.written > len(done.paths)
