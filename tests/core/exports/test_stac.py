"""Datasets as STAC describes them: what its own libraries and readers of GeoParquet find is what lies there."""

from __future__ import annotations

import csv
import fnmatch
import json
import os
import re
import sys
import tarfile
from contextlib import nullcontext
from pathlib import Path

import pytest
from osgeo import gdal, ogr
from pyproj import Geod
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.exports import tables
from terrainav.core.exports.croissant import CROISSANT_FILE, write_croissant
from terrainav.core.exports.kinds import export_as
from terrainav.core.exports.stac import COLLECTION_FILE, ITEMS_FILE, write_stac
from terrainav.core.imagery.opening import named_source, open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage.stores import store_path

from tests.support.command import command
from tests.support.datasets import write_dataset
from tests.support.objects import s3_store

pyarrow = pytest.importorskip("pyarrow", reason="needs pyarrow")
parquet = pytest.importorskip("pyarrow.parquet", reason="needs pyarrow")
#: Across the antimeridian, where a footprint has two pieces.
PLACES = ((35.0, 179.9999, 90.0), (35.0, 179.99, 100.0), (35.0001, 179.99, 100.5))
YAWS = (10.0, 20.0, -170.0)
MAPPED = Mission(
    Box(35.16, -89.9, 35.1584, -89.8978), 100.0, image_px=64, max_px=64, map_types=("satellite", "roadmap")
)
#: Columns that images in shards have beside those of others.
IN_SHARDS = {"shard", "offset_bytes", "size_bytes"}


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """Camera frames with times."""
    folder = tmp_path_factory.mktemp("flown") / "out"
    area = Points(PLACES, YAWS, times_s=(1777888800.0, 1777888801.5, 1777888807.25))
    return captured(folder, Mission(area, 90.0, tilt_deg=5.0, image_px=32, image_format="png"))


@pytest.fixture(scope="module")
def mapped(tmp_path_factory):
    """Map frames of two map types, 4 of each."""
    return captured(tmp_path_factory.mktemp("mapped") / "out", MAPPED)


def captured(folder: Path, asked: Mission) -> Path:
    source = open_source("world")
    assert not capture(plan(asked, source.grid), source, folder).failed
    return folder


def items_of(folder: Path) -> list[dict]:
    """Items as STAC's own library reads them out of the table."""
    arrow = pytest.importorskip("stac_geoparquet.arrow", reason="needs stac-geoparquet")
    return list(arrow.stac_table_to_items(parquet.read_table(folder / ITEMS_FILE)))


def rows_of(folder: Path) -> list[tuple[str, dict[str, str]]]:
    """Map types and rows of the tables of what is there."""
    found = []
    for path in sorted(folder.glob("*/meta_data.csv")):
        with path.open(encoding="utf-8", newline="") as file:
            found += [(path.parent.name, row) for row in csv.DictReader(file) if row["status"] == "done"]
    return found


def faults_of(kind: str, value: dict) -> list[str]:
    """What a schema of STAC, which pystac brings, finds wrong."""
    validation = pytest.importorskip("pystac.validation.local_validator", reason="needs pystac")
    jsonschema = pytest.importorskip("jsonschema", reason="needs jsonschema")
    referencing = pytest.importorskip("referencing", reason="needs referencing")
    schemas = validation.get_local_schema_cache()
    asked = schemas[f"https://schemas.stacspec.org/v1.1.0/{kind}-spec/json-schema/{kind}.json"]
    registry = referencing.Registry().with_resources(
        [(name, referencing.Resource.from_contents(one)) for name, one in schemas.items()]
    )
    found = jsonschema.Draft7Validator(asked, registry=registry).iter_errors(value)
    return [f"{one.json_path}: {one.message[:200]}" for one in found]


def test_the_schema_finds_faults():
    assert faults_of("item", {"type": "Feature"})
    assert faults_of("collection", {"type": "Collection"})


@pytest.mark.parametrize("which", ["flown", "mapped"])
def test_items_are_those_of_stac_and_of_the_tables(which, request):
    pystac = pytest.importorskip("pystac", reason="needs pystac")
    folder = request.getfixturevalue(which)
    done = export_as(folder, None, "stac")
    assert done.paths == tuple(folder / name for name in (ITEMS_FILE, COLLECTION_FILE, CROISSANT_FILE))
    features = json.loads((folder / "footprints.geojson").read_text())["features"]
    drawn = {one["properties"]["name"]: one["geometry"] for one in features}
    items, rows = items_of(folder), rows_of(folder)
    assert len(items) == len(rows) == len({one["id"] for one in items})
    for found, (map_type, row) in zip(items, rows):
        assert faults_of("item", found) == []
        item = pystac.Item.from_dict(found)
        assert item.geometry == drawn[Path(row["img_names"]).stem]
        shape = ogr.CreateGeometryFromJson(json.dumps(item.geometry))
        west, east, south, north = shape.GetEnvelope()
        assert item.bbox == [west, south, east, north]
        image = folder / item.assets["image"].href
        assert image == folder / map_type / row["img_names"]
        assert image.is_file()
        assert item.assets["image"].media_type == ("image/png" if which == "flown" else "image/tiff")
        own = {name: value for name, value in item.properties.items() if name in row}
        assert {name for name, cell in row.items() if cell} - {"status"} == own.keys()
        for name, value in own.items():
            assert type(value)(row[name]) == value
        assert item.properties["map_type"] == map_type
        assert (item.datetime, item.collection_id) == (None, "out")


def test_camera_frames_say_how_they_look_and_have_no_projection(flown):
    write_stac(flown, flown)
    items = items_of(flown)
    for one, yaw in zip(items, YAWS):
        assert one["properties"]["view:off_nadir"] == pytest.approx(5.0, abs=1e-9)
        assert one["properties"]["view:azimuth"] == pytest.approx(yaw % 360.0, abs=1e-9)
        assert "proj:code" not in one["properties"]
        assert one["stac_extensions"] == ["https://stac-extensions.github.io/view/v1.0.0/schema.json"]
    assert items[0]["properties"]["time_utc"] == "2026-05-04T10:00:00.000Z"


def test_map_frames_say_their_projection_and_their_gsd(mapped):
    rasterio = pytest.importorskip("rasterio", reason="needs rasterio")
    write_stac(mapped, mapped)
    globe = Geod(ellps="WGS84")
    for one in items_of(mapped):
        with rasterio.open(mapped / one["assets"]["image"]["href"]) as image:
            assert one["properties"]["proj:code"] == image.crs.to_string()
            width = image.width
        west, south, east, north = one["bbox"]
        *_, across = globe.inv(west, (south + north) / 2.0, east, (south + north) / 2.0)
        # To a pixel of the image, which is as wide as whole ones of the map.
        assert one["properties"]["gsd"] == pytest.approx(across / width, rel=1.0 / width)
        assert one["stac_extensions"] == ["https://stac-extensions.github.io/projection/v2.0.0/schema.json"]


def test_the_collection_is_whole_and_in_the_table_too(mapped):
    pystac = pytest.importorskip("pystac", reason="needs pystac")
    items, described, _ = write_stac(mapped, mapped)
    told = json.loads(described.read_text(encoding="utf-8"))
    assert faults_of("collection", told) == []
    collection = pystac.Collection.from_dict(told)
    asset = collection.assets["items"]
    assert mapped / asset.href == items
    assert (asset.media_type, asset.roles) == ("application/vnd.apache.parquet", ["collection-mirror"])
    assert [one.name for one in collection.providers] == ["Synthetic (offline)", "TerrAInav"]
    schema = parquet.read_schema(items)
    assert json.loads(schema.metadata[b"stac-geoparquet"]) == {
        "version": "1.0.0",
        "collections": {"out": told},
    }
    boxes = [one["bbox"] for one in items_of(mapped)]
    assert collection.extent.spatial.bboxes == [
        [
            *(min(edge) for edge in zip(*(box[:2] for box in boxes))),
            *(max(edge) for edge in zip(*(box[2:] for box in boxes))),
        ]
    ]
    # When it was is not known of an invented landscape.
    assert collection.extent.temporal.intervals == [[None, None]]
    assert collection.summaries.lists["map_type"] == ["roadmap", "satellite"]
    gsd = [one["properties"]["gsd"] for one in items_of(mapped)]
    assert told["summaries"]["gsd"] == {"minimum": min(gsd), "maximum": max(gsd)}


def test_readers_of_geoparquet_find_the_footprints(mapped, flown):
    geopandas = pytest.importorskip("geopandas", reason="needs geopandas")
    for folder in (mapped, flown):
        items, *_ = write_stac(folder, folder)
        frame = geopandas.read_parquet(items)
        assert frame.crs.to_epsg() == 4326 or frame.crs.to_string() == "OGC:CRS84"
        assert frame["geometry"].is_valid.all()
        about = json.loads(parquet.read_schema(items).metadata[b"geo"])["columns"]["geometry"]
        assert set(about["geometry_types"]) == set(frame["geometry"].geom_type)
        bounds = [tuple(box.values()) for box in parquet.read_table(items)["bbox"].to_pylist()]
        assert bounds == [tuple(edges) for edges in frame.bounds.values.tolist()]
        west, south, east, north = zip(*bounds)
        assert about["bbox"] == [min(west), min(south), max(east), max(north)]
        # One image, found by the bounds of rows alone.
        some = geopandas.read_parquet(items, bbox=tuple(frame["geometry"].iloc[-1].centroid.bounds))
        assert frame["id"].iloc[-1] in set(some["id"])
        assert len(some) < len(frame) or folder is flown


def test_gdal_opens_the_items(mapped):
    if ogr.GetDriverByName("Parquet") is None:
        pytest.skip("this GDAL has no Parquet")
    items, *_ = write_stac(mapped, mapped)
    opened = ogr.Open(str(items))
    layer = opened.GetLayer(0)
    assert layer.GetFeatureCount() == 8
    assert [one.GetField("map_type") for one in layer] == ["roadmap"] * 4 + ["satellite"] * 4


def test_dates_of_imagery_become_spans_of_time(tmp_path):
    spans = {
        "2024-05-01": ("2024-05-01T00:00:00", "2024-05-01T23:59:59"),
        "2024-02": ("2024-02-01T00:00:00", "2024-02-29T23:59:59"),
        "2014": ("2014-01-01T00:00:00", "2014-12-31T23:59:59"),
        "1950-1965": ("1950-01-01T00:00:00", "1965-12-31T23:59:59"),
        "2020-01-01T00:00:00.000Z/2020-03-31T00:00:00Z": ("2020-01-01T00:00:00", "2020-03-31T23:59:59"),
        **dict.fromkeys(
            ("", "latest", "2024-02-30", "2020-2019", "0001", "9999-12-31"),
            ("1700-01-01T00:00:00", "2200-01-01T00:00:00"),
        ),
    }
    folder = write_dataset(tmp_path / "out", len(spans) + 1)
    table = folder / "satellite" / "meta_data.csv"
    head, *lines = table.read_text(encoding="utf-8").splitlines()
    dated = [f"{line},{date}" for line, date in zip(lines, [*spans, ""])]
    table.write_text("\n".join([f"{head},imagery_date", *dated]) + "\n", encoding="utf-8")
    write_stac(folder, folder)
    found = [one["properties"] for one in items_of(folder)]
    ends = [(one["start_datetime"][:19], one["end_datetime"][:19]) for one in found]
    assert ends == [*spans.values()]
    assert {one["datetime"] for one in found} == {None}
    interval = json.loads((folder / COLLECTION_FILE).read_text())["extent"]["temporal"]["interval"]
    assert interval == [[None, None]]
    table.write_text("\n".join([f"{head},imagery_date", *(f"{line},2014" for line in lines)]) + "\n")
    write_stac(folder, folder)
    interval = json.loads((folder / COLLECTION_FILE).read_text())["extent"]["temporal"]["interval"]
    assert interval == [["2014-01-01T00:00:00Z", "2014-12-31T23:59:59Z"]]


def test_tables_of_others_have_points_and_what_is_rejected_is_where_it_lies(tmp_path):
    folder = write_dataset(tmp_path / "out", 5)
    table = folder / "satellite" / "meta_data.csv"
    head, *lines = table.read_text(encoding="utf-8").splitlines()
    # A column of somebody's that STAC calls something else by.
    table.write_text("\n".join([f"{head},type", *(f"{line},flat" for line in lines)]) + "\n", encoding="utf-8")
    (folder / "satellite" / "rejected").mkdir()
    rejected = lines[3].partition(",")[0]
    (folder / "satellite" / rejected).rename(folder / "satellite" / "rejected" / rejected)
    write_stac(folder, folder)
    items = items_of(folder)
    assert len(items) == 4
    for one, line in zip(items, lines):
        name, _, _, lat, lon, *_ = line.split(",")
        assert faults_of("item", one) == []
        assert one["geometry"] == {"type": "Point", "coordinates": [float(lon), float(lat)]}
        assert one["bbox"] == [float(lon), float(lat)] * 2
        assert (one["type"], one["properties"]["table_type"]) == ("Feature", "flat")
        assert "gsd" not in one["properties"]
        assert (folder / one["assets"]["image"]["href"]).name == name
        assert (folder / one["assets"]["image"]["href"]).is_file()
    assert items[3]["properties"]["rejected"]
    about = json.loads(parquet.read_schema(folder / ITEMS_FILE).metadata[b"geo"])
    assert about["columns"]["geometry"]["geometry_types"] == ["Point"]


def test_rows_come_in_groups_and_the_same_bytes_every_time(mapped, monkeypatch):
    items, *_ = write_stac(mapped, mapped)
    whole = parquet.read_table(items)
    monkeypatch.setattr(tables, "_ROWS_A_GROUP", 3)
    write_stac(mapped, mapped)
    data = items.read_bytes()
    assert parquet.ParquetFile(items).num_row_groups == 4
    assert parquet.read_table(items).equals(whole)
    write_stac(mapped, mapped)
    assert items.read_bytes() == data


def test_one_map_type_alone(mapped):
    export_as(mapped, None, "stac", "roadmap")
    assert {one["properties"]["map_type"] for one in items_of(mapped)} == {"roadmap"}
    records = json.loads((mapped / CROISSANT_FILE).read_text())["recordSet"]
    assert [one["@id"] for one in records] == ["roadmap"]


def test_what_cannot_be_described_is_one_line(mapped, tmp_path, monkeypatch):
    with pytest.raises(InvalidInput, match=r"describes the files beside it; give the dataset's own$"):
        write_stac(mapped, tmp_path)
    folder = write_dataset(tmp_path / "out", 1)
    with pytest.raises(InvalidInput, match=r"out: has no image to export$"):
        write_stac(folder, folder)
    assert not (folder / ITEMS_FILE).exists()
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(OutputError, match=r"^format stac: pyarrow cannot be imported \(.*\); get it with: pip "):
        write_stac(mapped, mapped)


@pytest.fixture(scope="module")
def sharded(tmp_path_factory):
    """The same images in shards of 3."""
    return in_shards(tmp_path_factory.mktemp("sharded") / "out")


def in_shards(place: Path | str) -> Path:
    """Capture the map frames in blocks of 3 images, each a shard."""
    source = open_source("world")
    blocks = Blocks(3, "webdataset")
    assert not capture(plan(MAPPED, source.grid), named_source("world"), place, blocks=blocks).failed
    return store_path(place)


def test_images_in_shards_are_found_in_them(mapped, sharded):
    write_stac(sharded, sharded)
    write_stac(mapped, mapped)
    found, whole = items_of(sharded), items_of(mapped)
    assert len(found) == len(whole) == 8
    for one, same in zip(found, whole):
        assert faults_of("item", one) == []
        said, known = one["properties"], same["properties"]
        assert (one["id"], one["geometry"], one["bbox"]) == (same["id"], same["geometry"], same["bbox"])
        assert {name: value for name, value in said.items() if name not in IN_SHARDS} == known
        assert said.keys() == known.keys() | IN_SHARDS
        assert one["assets"]["image"]["href"] == f"./{said['map_type']}/{said['shard']}"
        assert one["assets"]["image"]["type"] == "application/x-tar"
        tar = sharded / one["assets"]["image"]["href"]
        start, size = said["offset_bytes"], said["size_bytes"]
        image = (mapped / same["assets"]["image"]["href"]).read_bytes()
        assert tar.read_bytes()[start : start + size] == image
        # As GDAL opens a part of a file.
        part, file = (
            gdal.Open(name)
            for name in (f"/vsisubfile/{start}_{size},{tar}", str(mapped / same["assets"]["image"]["href"]))
        )
        assert part.GetGeoTransform() == file.GetGeoTransform()
        assert (part.ReadAsArray() == file.ReadAsArray()).all()


def test_croissant_describes_what_lies_in_shards(sharded):
    (path,) = write_croissant(sharded, sharded)
    told = json.loads(path.read_text(encoding="utf-8"))
    files = {one["@id"]: one for one in told["distribution"]}
    fields = [field for record in told["recordSet"] for field in record["field"]]
    names = [one["@id"] for one in (*told["distribution"], *told["recordSet"], *fields)]
    assert len({*names}) == len(names)
    assert [one["@id"] for one in told["recordSet"]] == [
        "roadmap",
        "roadmap/samples",
        "satellite",
        "satellite/samples",
    ]
    for name in ("roadmap", "satellite"):
        tars = sorted(sharded.glob(files[f"{name}/shards"]["includes"]))
        assert tars == sorted((sharded / name).glob("*.tar"))
        assert files[f"{name}/shards"]["encodingFormat"] == "application/x-tar"
        members = []
        for tar in tars:
            with tarfile.open(tar) as opened:
                members += opened.getnames()
        inside = {}
        for one in ("files", "json"):
            assert files[f"{name}/{one}"]["containedIn"] == {"@id": f"{name}/shards"}
            patterns = files[f"{name}/{one}"]["includes"]
            inside[one] = [
                member
                for member in members
                if any(fnmatch.fnmatchcase(member, pattern) for pattern in ([patterns] if one == "json" else patterns))
            ]
        assert sorted(inside["files"] + inside["json"]) == sorted(members)
        samples = next(one for one in told["recordSet"] if one["@id"] == f"{name}/samples")
        fields = {one["name"]: one for one in samples["field"]}
        keys = [re.match(fields["key"]["source"]["transform"]["regex"], one)[1] for one in inside["files"]]
        assert keys == [re.match(fields["key"]["references"]["transform"]["regex"], one)[1] for one in inside["json"]]
        assert len({*keys}) == 4
        records = next(one for one in told["recordSet"] if one["@id"] == name)
        columns = [one["source"]["extract"]["column"] for one in records["field"]]
        with (sharded / name / "meta_data.csv").open(encoding="utf-8", newline="") as file:
            assert columns == next(csv.reader(file))
        kinds = {one["name"]: one["dataType"] for one in records["field"]}
        assert kinds["shard"] == "sc:Text"


@pytest.mark.parametrize("store", ["memory", "s3"])
def test_datasets_in_stores_are_described_there(store, mapped, sharded, tmp_path, monkeypatch):
    pytest.importorskip("upath", reason="needs universal_pathlib")
    arrow = pytest.importorskip("stac_geoparquet.arrow", reason="needs stac-geoparquet")
    with s3_store(monkeypatch) if store == "s3" else nullcontext("memory://stac") as address:
        where = f"{address}/{tmp_path.name}/out"
        place = in_shards(where)
        written = export_as(where, None, "stac").paths
        assert [str(one) for one in written] == [
            f"{where}/{name}" for name in (ITEMS_FILE, COLLECTION_FILE, CROISSANT_FILE)
        ]
        texts = [one.read_bytes() for one in written]
        found = list(arrow.stac_table_to_items(parquet.read_table(pyarrow.BufferReader(texts[0]))))
        with pytest.raises(InvalidInput, match="give the dataset's own"):
            write_stac(where, f"{address}/{tmp_path.name}")
        assert write_stac(f"{where}/", where) == [*written]
        if store == "s3":
            # GDAL asks for one image's bytes alone.
            for name, value in (
                ("AWS_S3_ENDPOINT", os.environ["AWS_ENDPOINT_URL"].partition("://")[2]),
                ("AWS_HTTPS", "NO"),
                ("AWS_VIRTUAL_HOSTING", "FALSE"),
                ("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR"),
            ):
                monkeypatch.setenv(name, value)
            said = found[0]["properties"]
            tar = f"/vsis3/{place.path}/{found[0]['assets']['image']['href'][2:]}"
            image = gdal.Open(f"/vsisubfile/{said['offset_bytes']}_{said['size_bytes']},{tar}")
            same = gdal.Open(str(mapped / said["map_type"] / said["img_names"]))
            assert (image.ReadAsArray() == same.ReadAsArray()).all()
    # Byte for byte what it is in a folder.
    write_stac(sharded, sharded)
    assert texts == [(sharded / one.name).read_bytes() for one in written]


def test_images_in_stores_that_are_in_no_shards_are_objects(mapped, tmp_path):
    pytest.importorskip("upath", reason="needs universal_pathlib")
    place = store_path(f"memory://stac/{tmp_path.name}/out")
    for one in mapped.rglob("*"):
        if one.is_file():
            (place / one.relative_to(mapped).as_posix()).write_bytes(one.read_bytes())
    written = write_stac(place, place)
    assert [one.read_bytes() for one in written] == [one.read_bytes() for one in write_stac(mapped, mapped)]


def test_a_store_that_refuses_is_one_line(monkeypatch):
    async def refuse(*_, **__):
        raise PermissionError("AccessDenied")

    with s3_store(monkeypatch) as address:
        place = in_shards(f"{address}/out")
        monkeypatch.setattr(place.fs, "_pipe_file", refuse)
        with pytest.raises(OutputError, match=r"^s3://data/out/items\.parquet: access is refused: the credentials"):
            write_stac(place, place)
    with pytest.raises(OutputError, match=r"^memory://stac/nothing: is not there"):
        write_stac("memory://stac/nothing", "memory://stac/nothing")


def test_the_command(mapped, tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    done = run("export", str(mapped), "--as", "stac")
    assert (done.returncode, done.stderr) == (0, "")
    names = (ITEMS_FILE, COLLECTION_FILE, CROISSANT_FILE)
    assert done.stdout == "".join(f"written     {mapped / name}\n" for name in names)
