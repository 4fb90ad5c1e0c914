"""Missions of several imageries: one dataset of each over the same ground, which are split and cleaned as one."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal, ogr
from pyproj import Transformer
from terrainav.core.capture.progress import Listener, OverallProgress, Progress
from terrainav.core.capture.several import capture_imageries
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.loading import LabelledImages
from terrainav.core.dataset.split import split
from terrainav.core.dataset.table import REJECTED, SPLIT
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.source import tile_parts
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.map_frame import capture_window

from tests.support import rasters
from tests.support.command import command
from tests.support.sources import FailingSource, PatternSource, missing
from tests.support.thinning import sampled

run = pytest.fixture(command, name="run")

AREA = Box(35.1600, -89.9000, 35.1555, -89.8945)
UTM = "EPSG:26916"
_to_utm = Transformer.from_crs("EPSG:4326", UTM, always_xy=True).transform
CORNER = (
    round(_to_utm(AREA.west_deg, AREA.south_deg)[0]) - 150.0,
    round(_to_utm(AREA.west_deg, AREA.south_deg)[1]) + 800.0,
)


@pytest.fixture(scope="module")
def dates(tmp_path_factory):
    """Rasters of two dates on one grid of half a metre in UTM, brighter and darker, each with its own noise."""
    folder = tmp_path_factory.mktemp("dates")
    place = (CORNER[0], 0.5, 0.0, CORNER[1], 0.0, -0.5)
    made = {}
    for seed, level in ((2014, 60), (2020, 160)):
        noise = np.random.default_rng(seed).integers(0, 64, (3, 2000, 1800))
        made[str(seed)] = rasters.write(folder / f"{seed}.tif", (noise + level).astype(np.uint8), place, 26916)
    return made


def several(*imageries: str, **changes) -> Mission:
    return Mission(AREA, 60.0, image_px=64, imageries=imageries, **changes)


def captured(mission: Mission, folder: Path, **options):
    sources = {name: open_source(one.imagery.source) for name, one in mission.missions_by_imagery.items()}
    plans = {name: plan(one, sources[name].grid) for name, one in mission.missions_by_imagery.items()}
    return capture_imageries(mission, plans, sources, folder, **options)


@pytest.fixture
def of_dates(dates, tmp_path):
    mission = several(*(f"{name}={path}" for name, path in dates.items()))
    return mission, tmp_path / "out", captured(mission, tmp_path / "out")


def contents(folder: Path) -> dict[str, object]:
    return {
        path.relative_to(folder).as_posix(): (
            set(path.read_bytes().splitlines()) if path.name == "journal.jsonl" else path.read_bytes()
        )
        for path in folder.rglob("*")
        if path.is_file()
    }


def places(folder: Path) -> dict[str, dict[str, str]]:
    """Part of each place, column and row, by the imagery."""
    found: dict[str, dict[str, str]] = {}
    for name, images in read_dataset(folder).image_sets.items():
        for image, part in zip(images.table.img_names, images.table.other[SPLIT]):
            found.setdefault("_".join(image.split("_")[:2]), {})[name] = part
    return found


@pytest.mark.thorough
def test_imageries_of_one_grid_have_the_same_windows_and_other_pixels(of_dates):
    _, folder, result = of_dates
    sets = read_dataset(folder).image_sets
    assert list(sets) == ["2014", "2020"]
    old, new = (sets[name] for name in sets)
    assert result.written == result.total == len(old) + len(new) > 20
    assert old.table.img_names == new.table.img_names
    for column in ("left_px", "top_px", "width_px", "height_px", "lat_deg", "lon_deg", "pose_lat_deg"):
        np.testing.assert_array_equal(getattr(old.table, column), getattr(new.table, column))
    for row in range(len(old)):
        before, after = old.pixels(row, 3), new.pixels(row, 3)
        assert before.shape == after.shape
        assert before.max() < 60 + 64 <= 160 <= after.min()


def test_each_imagery_is_a_dataset_as_its_own_mission_makes_it(of_dates, tmp_path):
    from terrainav.core.capture.runner import capture

    mission, folder, _ = of_dates
    one = mission.missions_by_imagery["2020"]
    source = open_source(one.imagery.source)
    capture(plan(one, source.grid), source, tmp_path / "alone")
    assert contents(folder / "2020") == contents(tmp_path / "alone")


@pytest.mark.thorough
def test_stopped_and_resumed_it_leaves_the_same_bytes(of_dates, tmp_path):
    mission, folder, whole = of_dates
    images = itertools.count()
    result = captured(mission, tmp_path / "again", listener=Listener(cancelled=lambda: next(images) > 8), workers=1)
    assert result.cancelled
    assert result.total == whole.total > result.written
    with pytest.raises(OutputError, match="already holds this mission"):
        captured(mission, tmp_path / "again")
    captured(mission, tmp_path / "again", resume=True)
    assert contents(tmp_path / "again") == contents(folder)


def test_only_what_has_failed_is_made_again(tmp_path):
    mission = several("a=one", "b=two", image_format="png")
    whole = PatternSource(())
    plans = {name: plan(one, whole.grid) for name, one in mission.missions_by_imagery.items()}
    first_window = capture_window(plans["b"], 0)
    gone = FailingSource({tile_parts(first_window, whole.grid)[0].window: missing()}, map_types=())
    first = capture_imageries(mission, plans, {"a": whole, "b": gone}, tmp_path / "out")
    assert first.failed
    assert {one.map_type for one in first.failed} == {"b"}
    again = capture_imageries(mission, plans, {"a": whole, "b": PatternSource(())}, tmp_path / "out", only_failed=True)
    assert (again.written, again.skipped, again.failed) == (len(first.failed), 0, ())


@pytest.mark.parametrize("how", sampled(["shuffled", "in-order", "auto", "blocks"], 4))
def test_images_of_one_place_are_in_one_part_in_all_imageries(tmp_path, how):
    # Another zoom gives other names.
    mission = several("a=one", "b=two", image_format="png", overlap_along=0.2)
    sources = {"a": PatternSource(()), "b": PatternSource((), tile_px=512)}
    plans = {name: plan(one, sources[name].grid) for name, one in mission.missions_by_imagery.items()}
    assert set(plans["a"].names).isdisjoint(plans["b"].names)
    capture_imageries(mission, plans, sources, tmp_path / "out")
    made = split(tmp_path / "out", how=how)
    parts = places(tmp_path / "out")
    assert len(parts) == len(plans["a"]) == len(plans["b"]) == sum(made.images.values()) + made.gap
    assert all(len(one) == 2 and len(set(one.values())) == 1 for one in parts.values())
    assert min(made.images.values()) > 0
    train = LabelledImages(tmp_path / "out", map_type="b", part="train")
    assert len(train) == made.images["train"]


@pytest.mark.thorough
def test_blocks_keep_the_ground_of_different_grids_apart(dates, tmp_path):
    mission = several(f"air={dates['2020']}", "map=world:roadmap", overlap_along=0.3, overlap_across=0.3)
    captured(mission, tmp_path / "out")
    assert split(tmp_path / "out").how == "blocks"
    ground: dict[str, list[ogr.Geometry]] = {"train": [], "test": []}
    for images in read_dataset(tmp_path / "out").image_sets.values():
        for row, part in enumerate(images.table.other[SPLIT]):
            if part in ground:
                ground[part].append(ground_ellipsoid(images.path(row)))
    assert min(map(len, ground.values())) > 2
    assert all(not test.Intersects(train) for test in ground["test"] for train in ground["train"])


def ground_ellipsoid(path: Path) -> ogr.Geometry:
    """Corners of a GeoTIFF in UTM, as GDAL reads them."""
    raster = gdal.Open(str(path))
    x0, dx, _, y0, _, dy = raster.GetGeoTransform()
    x = x0 + dx * np.array([0, 1, 1, 0]) * raster.RasterXSize
    y = y0 + dy * np.array([0, 0, 1, 1]) * raster.RasterYSize
    to_utm = Transformer.from_crs(raster.GetProjection(), UTM, always_xy=True)
    return shape(np.column_stack(to_utm.transform(x, y)))


def shape(corners) -> ogr.Geometry:
    ring = ogr.Geometry(ogr.wkbLinearRing)
    for x, y in (*corners, corners[0]):
        ring.AddPoint_2D(float(x), float(y))
    polygon = ogr.Geometry(ogr.wkbPolygon)
    polygon.AddGeometry(ring)
    return polygon


def test_the_one_roadmap_decides_which_places_are_rejected(tmp_path):
    mission = several("air=world", "streets=world:roadmap", image_format="png")
    captured(mission, tmp_path / "out")
    air, streets = clean(tmp_path / "out", 3.0)
    assert air.by_roadmap == air.images
    assert 0 < air.rejected == streets.rejected < air.images
    marks = {
        name: {
            "_".join(image.split("_")[:2])
            for image, mark in zip(one.table.img_names, one.table.other[REJECTED])
            if mark
        }
        for name, one in read_dataset(tmp_path / "out").image_sets.items()
    }
    assert marks["air"] == marks["streets"]


def test_the_mission_file_keeps_its_imageries(tmp_path):
    mission = several("2014=a.tif", "2020=world@2020-06-01:roadmap")
    mission.save(tmp_path / "mission.json")
    said = json.loads((tmp_path / "mission.json").read_text())["imagery"]
    assert said["imageries"] == ["2014=a.tif", "2020=world@2020-06-01:roadmap"]
    assert not {"source", "date", "map_types"} & set(said)
    assert Mission.load(tmp_path / "mission.json") == mission
    of_2020 = mission.missions_by_imagery["2020"]
    assert (of_2020.imagery.source, of_2020.imagery.date) == ("world", "2020-06-01")
    assert (of_2020.imagery.map_types, of_2020.imagery.imageries) == (("roadmap",), ())
    assert "imageries" not in Mission(AREA, 60.0).to_json()


def test_what_no_imagery_can_be_is_refused():
    with pytest.raises(InvalidInput, match=r"imagery '\.\./up': must be named by up to 64"):
        several("../up=world")
    with pytest.raises(InvalidInput, match="imagery 'A': is named twice"):
        several("a=world", "A=world")
    with pytest.raises(InvalidInput, match="imagery 7: must be text"):
        several(7)  # type: ignore[arg-type]
    with pytest.raises(InvalidInput, match="and source osm"):
        several("a=world", source="osm")
    with pytest.raises(InvalidInput, match="needs a plan for each of them"):
        plan(several("a=world"), PixelGrid())


def test_a_source_without_the_map_type_is_refused_before_anything_is_written(tmp_path):
    mission = several("a=one", "b=two:terrain")
    source = PatternSource(("satellite",))
    plans = {name: plan(one, source.grid) for name, one in mission.missions_by_imagery.items()}
    with pytest.raises(InvalidInput, match="map type 'terrain'"):
        capture_imageries(mission, plans, dict.fromkeys(plans, source), tmp_path / "out")
    assert not (tmp_path / "out").exists()
    with pytest.raises(InvalidInput, match="need a plan and a source each"):
        capture_imageries(mission, {"a": plans["a"]}, {"a": source}, tmp_path / "out")


def test_the_command_plans_and_captures_them(run, tmp_path):
    options = (
        *("--coords", "35.16_-89.9_35.1585_-89.898_60", "--image-px", "64"),
        *("--imagery", "air=world", "streets=world:roadmap"),
    )
    planned = run("plan", *options, "--json", "--output", str(tmp_path / "plan.csv"))
    figures = json.loads(planned.stdout)["imageries"]
    assert list(figures) == ["air", "streets"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plan-air.csv", "plan-streets.csv"]
    made = run("capture", *options, "--data-dir", str(tmp_path / "out"), "--json", "--quiet")
    assert json.loads(made.stdout)["total"] == sum(one["images"] for one in figures.values())
    again = run("capture", str(tmp_path / "out" / "mission.json"), "--data-dir", str(tmp_path / "out"), "--resume")
    assert again.stdout.startswith("0 images written")
    assert run("split", str(tmp_path / "out")).returncode == 0
    refused = run("capture", *options, "--source", "osm", "--data-dir", str(tmp_path / "b"))
    assert refused.returncode != 0
    assert refused.stderr.count("\n") == 1
    assert "and source osm" in refused.stderr


def test_progress_over_several_captures_is_the_sum_of_their_latest():
    overall = OverallProgress({"old": 10, "new": 10})
    assert overall.add(Progress(10, 4, 1, 0, 20, "old", 2.0)) == Progress(20, 4, 1, 0, 20, "old", 2.0)
    overall.add(Progress(10, 9, 1, 0, 50, "old", 5.0))
    # The second captures its failed images only.
    assert overall.add(Progress(3, 1, 0, 0, 7, "new", 1.0)) == Progress(13, 10, 1, 0, 57, "new", 6.0)
