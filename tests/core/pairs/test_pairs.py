"""Cross-view pairs captured, and read back as University-1652's baseline reads its own."""

from __future__ import annotations

import csv
import hashlib
import json
import os
from dataclasses import replace

import numpy as np
import pyproj
import pytest
from PIL import Image
from terrainav.core.capture.progress import Listener
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.mercator import lat_to_v, lon_to_u
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.imagery.opening import SourceOptions
from terrainav.core.mission.parts import Terrain
from terrainav.core.mission.relief.ground import Heights
from terrainav.core.pairs.capturing import capture_pairs
from terrainav.core.pairs.parts import TEST, TRAIN
from terrainav.core.pairs.places import PairPlace
from terrainav.core.pairs.planning import PairSettings, plan_pairs
from terrainav.core.pairs.sheet import contact_sheet
from terrainav.core.pairs.views import rings
from terrainav.core.picture.heights import terrain_heights
from terrainav.core.picture.products import sighting
from terrainav.core.world import WorldSource

from tests.support.sources import PatternSource, missing

GEOCENTRIC = pyproj.Transformer.from_crs(4979, 4978, always_xy=True)
PLACES = tuple(PairPlace(35.0 + 0.02 * at, -89.9 + 0.001 * at, f"place {at}") for at in range(5))
SETTINGS = PairSettings(views=rings((100.0, 140.0), 3, (40.0,)), size_px=64, source="pattern", shares=(2.0, 2.0, 1.0))
# Endings that torchvision's ImageFolder takes for images (torchvision.datasets.folder.IMG_EXTENSIONS).
IMG_EXTENSIONS = (".jpg", ".jpeg", ".png", ".ppm", ".bmp", ".pgm", ".tif", ".tiff", ".webp")


def image_folder(root):
    """Samples and classes as torchvision's ImageFolder finds them: folders sorted, then files, by their endings."""
    classes = sorted(entry.name for entry in os.scandir(root) if entry.is_dir())
    assert classes
    samples = []
    for label, name in enumerate(classes):
        files = sorted(file for file in (root / name).rglob("*") if file.name.lower().endswith(IMG_EXTENSIONS))
        # ImageFolder refuses classes without images.
        assert files, name
        samples += [(file, label) for file in files]
    return samples, classes


def ids_of(samples):
    """Labels as the baseline's test takes them: the number that an image's folder is called."""
    return [int(path.parent.name) for path, _ in samples]


class SpotSource(PatternSource):
    """Grey ground with a white spot of a few metres at each of some places, at every zoom."""

    RADIUS = 4.0 / 40_075_000

    def __init__(self, places):
        super().__init__(map_types=())
        self.spots = [
            (float(lon_to_u(np.array(place.lon_deg))), float(lat_to_v(np.array(place.lat_deg)))) for place in places
        ]

    def paint(self, _map_type, part):
        world = self.grid.world_px(part.zoom)
        u = (part.left_px + np.arange(part.width_px) + 0.5) / world
        v = ((part.top_px + np.arange(part.height_px) + 0.5) / world)[:, np.newaxis]
        near = sum(np.exp(-((u - x) ** 2 + (v - y) ** 2) / self.RADIUS**2) for x, y in self.spots)
        grey = (40.0 + 200.0 * near).astype(np.uint8)
        return np.repeat(grey[..., np.newaxis], 3, axis=-1)


@pytest.fixture(scope="module")
def pairs(tmp_path_factory):
    """Pairs of the places, the source they are from, and what the capture said."""
    folder, source = tmp_path_factory.mktemp("pairs") / "out", SpotSource(PLACES)
    worked_out = plan_pairs(PLACES, SETTINGS, source.grid)
    return folder, source, worked_out, capture_pairs(worked_out, source, folder)


def rows_of(folder):
    with (folder / "pairs.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def hashes(folder):
    return {
        path.relative_to(folder).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file() and path.name != "journal.jsonl"
    }


def test_the_baseline_finds_the_same_ids_in_all_views(pairs):
    folder, _, worked_out, result = pairs
    assert result.written == result.total == 5 * 7
    assert (result.failed, result.left_out, result.cancelled) == ((), (), False)
    classes = {}
    for place, part in zip(worked_out.ids, worked_out.parts):
        classes.setdefault(part, []).append(place)
    assert {part: len(found) for part, found in classes.items()} == {"train": 2, "test": 2, "distractor": 1}

    drone, names = image_folder(folder / "train" / "drone")
    satellite, same = image_folder(folder / "train" / "satellite")
    assert names == same == classes[TRAIN]
    assert [label for _, label in satellite] == [0, 1]
    assert [label for _, label in drone] == [0] * 6 + [1] * 6
    assert [path.name for path, _ in drone[:6]] == [f"image-{at:02d}.jpeg" for at in range(1, 7)]
    assert [path.name for path, _ in satellite] == [f"{name}.jpg" for name in names]
    # Of views that tilt alike, the lowest stands in for what no drone takes, and the first of those.
    for view in ("street", "google"):
        stand_ins, again = image_folder(folder / "train" / view)
        assert again == names
        assert [path.name for path, _ in stand_ins] == ["image-01.jpeg"] * 2
        assert all(path.samefile(folder / "train" / "drone" / path.parent.name / path.name) for path, _ in stand_ins)
    assert "hold no photographs from the ground" in (folder / "README.txt").read_text(encoding="utf-8")

    for view, count in (("drone", 6), ("satellite", 1), ("street", 1)):
        query, asked = image_folder(folder / "test" / f"query_{view}")
        gallery, found = image_folder(folder / "test" / f"gallery_{view}")
        assert asked == classes[TEST]
        assert found == sorted(classes[TEST] + classes["distractor"])
        assert len(query) == 2 * count
        assert set(ids_of(query)) < set(ids_of(gallery))
        assert not set(ids_of(gallery)) & set(ids_of(drone))
        # Every query's image is in the gallery, as University-1652 has it.
        there = {path.relative_to(folder / "test" / f"gallery_{view}") for path, _ in gallery}
        for path, _ in query:
            inside = path.relative_to(folder / "test" / f"query_{view}")
            assert inside in there
            assert path.read_bytes() == (folder / "test" / f"gallery_{view}" / inside).read_bytes()


def test_the_place_is_in_the_middle_of_every_image(pairs):
    folder, _, _, _ = pairs
    samples = [path for part in ("train/drone", "train/satellite") for path, _ in image_folder(folder / part)[0]]
    assert len(samples) == 14
    for path in samples:
        with Image.open(path) as image:
            assert image.size == (64, 64)
            grey = np.asarray(image.convert("L"), np.float64)
        weight = np.clip(grey - 80.0, 0.0, None)
        centre = [np.average(np.arange(64) + 0.5, weights=weight.sum(axis=axis)) for axis in (0, 1)]
        # The far half of a tilted spot is a little smaller than the near one.
        assert centre == pytest.approx([32.0, 32.0], abs=0.5), path


def test_the_table_names_every_image_with_its_pose(pairs):
    folder, source, worked_out, _ = pairs
    rows = rows_of(folder)
    assert [row["view"] for row in rows if row["id"] == "0003"] == ["satellite"] + 6 * ["drone"] + ["street"]
    assert len([row for row in rows if row["view"] in ("satellite", "drone")]) == worked_out.images
    listed = {row["file"] for row in rows} | {row["query_file"] for row in rows} - {""}
    there = {
        path.relative_to(folder).as_posix()
        for part in ("train", "test")
        for path in (folder / part).rglob("*")
        if path.is_file()
    }
    assert listed == there
    assert {row["status"] for row in rows} == {"done"}
    drones = [row for row in rows if row["view"] == "drone" and row["id"] == "0003"]
    assert [float(row["yaw_deg"]) for row in drones] == [0.0, 120.0, 240.0] * 2
    assert [float(row["agl_m"]) for row in drones] == [100.0] * 3 + [140.0] * 3
    assert {float(row["tilt_deg"]) for row in drones} == {40.0}
    assert {row["name"] for row in drones} == {"place 3"}
    for row in (drones[1], rows[0]):
        with Image.open(folder / row["file"]) as image:
            gps = image.getexif().get_ifd(34853)
        for numbers, sign, column in ((gps[2], gps[1], "lat_deg"), (gps[4], gps[3], "lon_deg")):
            degrees = sum(float(number) / 60.0**at for at, number in enumerate(numbers))
            assert degrees * (-1.0 if sign in "SW" else 1.0) == pytest.approx(float(row[column]), abs=1e-9)
        assert float(gps[17]) == pytest.approx(float(row["yaw_deg"]), abs=1e-4)
    settings = json.loads((folder / "pairs.json").read_text(encoding="utf-8"))
    assert [place["part"] for place in settings["places"]] == list(worked_out.parts)
    assert settings["parts"]["ground_shared"] is False
    assert settings["mission"]["imagery"]["source"] == "pattern"
    for file in settings["missions"].values():
        assert (folder / file).is_file()
    assert source.grid == worked_out.plans["drone"].grid


def test_each_tile_is_fetched_once_by_each_capture(pairs):
    _, source, _, result = pairs
    assert result.requests == result.unique_parts == sum(source.fetched.values())
    # What satellite and drone both need is asked for by each; caches of tiles serve the second.
    assert max(source.fetched.values()) <= 2


def test_a_stopped_run_goes_on_to_the_same_bytes(pairs, tmp_path):
    folder, _, worked_out, _ = pairs
    source, asked = SpotSource(PLACES), []

    def cancelled():
        asked.append(None)
        return len(list(tmp_path.rglob("*.jpg"))) > 8

    stopped = capture_pairs(
        worked_out, source, tmp_path / "out", connections=1, workers=1, listener=Listener(cancelled=cancelled)
    )
    assert stopped.cancelled
    assert asked
    assert not (tmp_path / "out" / "train").exists()
    with pytest.raises(OutputError, match="already holds these pairs; resume them"):
        capture_pairs(worked_out, source, tmp_path / "out")
    resumed = capture_pairs(worked_out, source, tmp_path / "out", resume=True)
    assert stopped.written + resumed.written == resumed.total
    assert hashes(tmp_path / "out") == hashes(folder)


def test_copies_stand_in_where_files_have_one_name(pairs, tmp_path, monkeypatch):
    folder, source, worked_out, _ = pairs

    def refuse(*_arguments):
        raise OSError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", refuse)
    capture_pairs(worked_out, source, tmp_path / "out")
    assert hashes(tmp_path / "out") == hashes(folder)
    assert {path.stat().st_nlink for path in (tmp_path / "out" / "train").rglob("*.jpeg")} == {1}


class Holed(SpotSource):
    """Without imagery at one place, until it is healed."""

    hole, healed = None, False

    def paint(self, map_type, part):
        world = self.grid.world_px(part.zoom)
        x, y = (world * share for share in self.hole)
        inside = 0 <= x - part.left_px < part.width_px and 0 <= y - part.top_px < part.height_px
        if inside and not self.healed:
            raise missing()
        return super().paint(map_type, part)


def test_a_place_without_imagery_is_named_and_left_out_until_it_is_there(pairs, tmp_path):
    folder, _, worked_out, _ = pairs
    source = Holed(PLACES)
    source.hole = source.spots[3]
    result = capture_pairs(worked_out, source, tmp_path / "out")
    assert result.left_out == ("0003",)
    assert len(result.failed) == 7
    assert {failure.map_type for failure in result.failed} == {"satellite", "drone"}
    rows = [row for row in rows_of(tmp_path / "out") if row["id"] == "0003"]
    assert {(row["status"], row["file"]) for row in rows} == {("failed", "")}
    assert all("no imagery (404)" in row["reason"] for row in rows)
    assert not list((tmp_path / "out").glob("*/*/0003"))
    image_folder(tmp_path / "out" / "train" / "drone")

    source.healed = True
    again = capture_pairs(worked_out, source, tmp_path / "out", resume=True)
    assert (again.written, again.left_out, again.failed) == (7, (), ())
    assert hashes(tmp_path / "out") == hashes(folder)


def test_nothing_is_overwritten(pairs, tmp_path):
    _, source, worked_out, _ = pairs
    other = plan_pairs(PLACES[:4], SETTINGS, source.grid)
    foreign = tmp_path / "foreign"
    (foreign / "train").mkdir(parents=True)
    with pytest.raises(OutputError, match=r"holds train but no pairs\.json"):
        capture_pairs(worked_out, source, foreign)
    assert [path.name for path in foreign.iterdir()] == ["train"]

    # A capture's own folder.
    dataset = tmp_path / "dataset"
    dataset.mkdir()
    (dataset / "mission.json").write_bytes(b"{}")
    with pytest.raises(OutputError, match=r"holds mission\.json but no pairs\.json"):
        capture_pairs(worked_out, source, dataset, resume=True)
    assert [path.name for path in dataset.iterdir()] == ["mission.json"]

    mine = tmp_path / "mine"
    capture_pairs(other, source, mine)
    with pytest.raises(OutputError, match="holds pairs of other settings"):
        capture_pairs(worked_out, source, mine, resume=True)
    image = next((mine / "train" / "satellite").rglob("*.jpg"))
    image.unlink()
    image.write_bytes(b"somebody's own")
    with pytest.raises(OutputError, match="is not the one that was captured"):
        capture_pairs(other, source, mine, resume=True)
    assert image.read_bytes() == b"somebody's own"


def test_a_map_type_or_grid_that_is_not_the_sources_writes_nothing(pairs, tmp_path):
    _, _, worked_out, _ = pairs
    with pytest.raises(InvalidInput, match="map type 'satellite': Pattern has roadmap"):
        capture_pairs(worked_out, PatternSource(("roadmap",)), tmp_path / "out")
    with pytest.raises(InvalidInput, match="another pixel grid"):
        capture_pairs(worked_out, PatternSource(tile_px=512), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_several_tilts_are_captured_one_after_the_other_and_numbered_through(tmp_path):
    settings = PairSettings(views=rings((100.0,), 2, (0.0, 30.0)), size_px=32, shares=(1.0, 0.0, 0.0))
    source = SpotSource(PLACES[:2])
    worked_out = plan_pairs(PLACES[:2], settings, source.grid)
    assert list(worked_out.plans) == ["satellite", "drone_0", "drone_30"]
    capture_pairs(worked_out, source, tmp_path / "out")
    shown = [row for row in rows_of(tmp_path / "out") if row["id"] == "0001" and row["view"] == "drone"]
    assert [row["image"] for row in shown] == [f"image-{at:02d}.jpeg" for at in range(1, 5)]
    assert [float(row["tilt_deg"]) for row in shown] == [0.0, 0.0, 30.0, 30.0]


def test_satellite_views_are_north_up_squares_as_sharp_at_every_latitude():
    places = (PairPlace(0.0, 10.0), PairPlace(60.0, 10.0))
    worked_out = plan_pairs(places, PairSettings(shares=(1.0, 0.0, 0.0)), WorldSource.grid)
    satellite = worked_out.plans["satellite"]
    assert satellite.frames.on_map
    assert min(satellite.frames.width_px.min(), satellite.frames.height_px.min()) >= 512
    ground_m = satellite.frames.width_px * satellite.grid.ground_m_per_px(
        satellite.lat_deg, satellite.lon_deg, satellite.zoom
    )
    assert ground_m == pytest.approx(worked_out.settings.satellite_width_m, rel=0.01)


def test_the_contact_sheet_shows_places_of_all_parts(pairs, tmp_path, monkeypatch):
    folder, _, _, _ = pairs
    monkeypatch.setattr("terrainav.core.pairs.sheet.VIEWS", 2)
    sheet = contact_sheet(folder, tmp_path / "sheet.jpg")
    with Image.open(sheet) as image:
        pixels = np.asarray(image.convert("L"), np.float64)
    assert pixels.shape == (3 * 222 + 6, 3 * 206 + 6)
    for line in range(3):
        for column in range(3):
            cell = pixels[6 + line * 222 :, 6 + column * 206 :][:64, :64]
            # The ground between the spots, and the spot in the middle of the cell.
            assert np.median(cell) == pytest.approx(40.0, abs=3.0)
            assert cell[30:34, 30:34].max() > 120.0
    with pytest.raises(InvalidInput, match=r"must end in \.jpg"):
        contact_sheet(folder, tmp_path / "sheet.png")
    with pytest.raises(InvalidInput, match=r"holds no pairs\.csv"):
        contact_sheet(tmp_path, tmp_path / "sheet.jpg")


@pytest.mark.parametrize("size_px", [0, 100_000])
def test_sizes_of_images_are_checked(size_px):
    with pytest.raises(InvalidInput, match=f"size of images {size_px} px: must be from 1 to 14,142"):
        replace(SETTINGS, size_px=size_px)


def test_over_relief_the_drone_looks_at_the_ground_of_each_place(tmp_path):
    """Places at different heights: each in the middle of its images, whose pictures are those of the relief."""
    towns = (
        PairPlace(35.1408, -89.8606, "town"),
        PairPlace(35.1008, -89.86, "field"),
    )
    settings = PairSettings(
        views=rings((60.0,), 2, (45.0,)),
        size_px=48,
        shares=(1.0, 1.0, 0.0),
        terrain=Terrain(elevation=("world",)),
    )
    heights = terrain_heights(settings.terrain, SourceOptions(seed=settings.seed))
    made = plan_pairs(towns, settings, WorldSource.grid, heights)
    drone = made.plans["drone"]
    assert made.plans["satellite"].relief.is_level
    assert not drone.relief.is_level
    spread = []
    for index, place in enumerate(towns):
        at = np.array([place.lat_deg]), np.array([place.lon_deg])
        below = heights.ground.surface(*at)
        ground = float(below.heights(*below.position(*at))[0])
        spread.append(ground)
        for _, view in made.shots(index):
            assert drone.height_m[view] == pytest.approx(ground + 60.0, abs=2e-3)
            # The axis, in geocentric coordinates, passes the place.
            camera = np.array(GEOCENTRIC.transform(drone.lon_deg[view], drone.lat_deg[view], drone.height_m[view]))
            point = np.array(GEOCENTRIC.transform(place.lon_deg, place.lat_deg, ground))
            phi, lam = np.radians(drone.lat_deg[view]), np.radians(drone.lon_deg[view])
            up = np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
            east = np.array([-np.sin(lam), np.cos(lam), 0.0])
            yaw = np.radians(drone.poses.yaw_deg[view])
            heading = np.sin(yaw) * east + np.cos(yaw) * np.cross(up, east)
            axis = (heading - up) / np.sqrt(2.0)
            away = point - camera
            assert np.linalg.norm(away - (away @ axis) * axis) < 0.02
    assert np.ptp(spread) > 2.0
    assert capture_pairs(made, WorldSource(), tmp_path).written == 6
    # Houses hide ground: the depths of an image are not those of a plane.
    shown = sighting(drone, made.shots(0)[0][1], (48, 48)).depth_m
    assert np.abs(np.diff(1.0 / shown, n=2, axis=1)).max() > 1e-3


def test_a_place_without_a_height_is_named():
    settings = replace(SETTINGS, terrain=Terrain(elevation=("world",)))

    class Nothing:
        def surface(self, *_):
            grid = WorldSource.grid
            return Surface(grid, 0, 0, 0, np.full((3, 3), np.nan))

    with pytest.raises(InvalidInput, match="no height at latitude 35"):
        plan_pairs(PLACES, settings, WorldSource.grid, Heights(Nothing(), Nothing()))
