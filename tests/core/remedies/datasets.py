"""What refusals of datasets advise: of reading, cleaning, splitting, converting and loading them."""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
import tempfile
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean, undo
from terrainav.core.dataset.convert import convert
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.folder import TABLE_FILE
from terrainav.core.dataset.labels import LABELS_FILE, make_dataset_labels, make_labels, mark_unfinished
from terrainav.core.dataset.loading import Batches, LabelledImages, augment
from terrainav.core.dataset.loading.batches import optional_module
from terrainav.core.dataset.split import split, undo_split
from terrainav.core.dataset.table import Table, image_parts
from terrainav.core.errors import Cancelled
from terrainav.core.exports.label_sets import write_coco
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mosaic.orthomosaic import make_orthomosaic

from tests.core.remedies.files import extra_brings
from tests.support.datasets import write_dataset
from tests.support.published import write_published, write_vbn
from tests.support.remedies import Case, remedy
from tests.support.shards import write_shards
from tests.support.sources import PatternSource

AREA = Box(35.16, -89.90, 35.1555, -89.8945)
MISSION = Mission(AREA, 120.0, image_format="png", map_types=("satellite", "roadmap"), image_px=32, max_px=32)
TURNED = MISSION.replace(yaw_deg=20.0, tilt_deg=20.0, map_types=("satellite",))


def captured(case: Case, mission=MISSION, name="out", **options) -> Path:
    source = PatternSource()
    folder = case.tmp_path / name
    assert capture(plan(mission, source.grid), source, folder, **options).failed == ()
    return folder


def again(folder, mission=MISSION):
    source = PatternSource()
    capture(plan(mission, source.grid), source, folder, resume=True)


def images_in(folder, map_type="satellite"):
    return sorted((folder / map_type).glob("*.png"))


def sample(folder, **options):
    """Load the first image of every part."""
    return LabelledImages(folder, part="all", **options).image(0, 0)


def copied(folder, name="copy"):
    target = folder.parent / name
    shutil.rmtree(target, ignore_errors=True)
    return Path(shutil.copytree(folder, target))


def edited(path, old, new, count=-1):
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, count), encoding="utf-8")


# --- folders


@remedy("dataset/folder.py", "folder {}: is one map type of the dataset {}; give that one")
def _one_map_type(case: Case) -> None:
    folder = captured(case)
    text = case.refused(lambda: clean(folder / "satellite"))
    named = text.partition("of the dataset ")[2].partition(";")[0]
    case.follow("give that one", lambda: clean(named))


@remedy(
    "dataset/folder.py",
    "folder {}: is laid out as the Night Vision supplement is; make a dataset of it first (terrainav "
    "convert --dataset "
    "VBN)",
)
def _supplement(case: Case) -> None:
    write_vbn(case.tmp_path / "vbn", ["1", "2"])
    convert_it = ("convert", "vbn", "made", "--dataset", "VBN")
    case.refused(lambda: clean(case.tmp_path / "vbn"))
    case.follow(
        "terrainav convert --dataset VBN",
        lambda: case.run(*convert_it).returncode == 0,
    )
    case.follow("make a dataset of it first", lambda: clean(case.tmp_path / "made"))


@remedy(
    "dataset/folder.py",
    "folder {}: is not a dataset, as neither it nor a folder in it has a {}; give the folder of a capture",
)
def _no_dataset(case: Case) -> None:
    case.refused(lambda: clean(case.tmp_path))
    case.follow("give the folder of a capture", lambda: clean(captured(case)))


@remedy(
    "dataset/folder.py",
    "folder {}: the images of its {} are in {} and in {} as well; move one of the two away",
)
def _two_folders(case: Case) -> None:
    folder = case.tmp_path / "satellite_0"
    write_published(folder, images="raster_images_120")
    other = folder / "raster_images_150"
    shutil.copytree(folder / "raster_images_120", other)
    case.refused(lambda: read_dataset(folder))

    def moved():
        other.rename(case.tmp_path / "away")
        read_dataset(folder)

    case.follow("move one of the two away", moved)


def _in_both(case: Case, several: bool) -> None:
    folder = captured(case)
    images = images_in(folder)[: 1 + several]
    (folder / "satellite" / "rejected").mkdir()
    for image in images:
        shutil.copy(image, folder / "satellite" / "rejected")
    case.refused(lambda: clean(folder))

    def removed():
        for image in images:
            (folder / "satellite" / "rejected" / image.name).unlink()
        clean(folder)

    case.follow("remove one of the two", removed)


def _not_there(case: Case, several: bool) -> None:
    folder = captured(case)
    images = images_in(folder)[: 1 + several]
    for image in images:
        image.rename(case.tmp_path / image.name)
    case.refused(lambda: clean(folder))
    other = copied(folder)

    def back():
        for image in images:
            (case.tmp_path / image.name).rename(image)
        clean(folder)

    case.follow("put them back" if several else "put it back", back)

    def resumed():
        again(other)
        clean(other)

    case.follow("capture again (--resume)", resumed)


def _not_in_the_table(case: Case, several: bool) -> None:
    source, folder = PatternSource(), case.tmp_path / "out"
    worked_out = plan(MISSION, source.grid)
    capture(worked_out, source, folder, only=[0, 1, 2])
    foreign = [folder / "satellite" / f"9_{row}_35.10000000_-89.90000000_18.png" for row in range(1 + several)]
    for image in foreign:
        shutil.copy(images_in(folder)[0], image)
    case.refused(lambda: clean(folder))

    def removed():
        for image in foreign:
            image.unlink()
        clean(folder)

    case.follow("remove what does not belong to it", removed)
    # A run that was killed has images whose table is not written yet.
    table = folder / "satellite" / TABLE_FILE
    lines = table.read_text(encoding="utf-8").splitlines(keepends=True)
    table.write_text("".join(lines[: -1 - several]), encoding="utf-8")
    case.refused(lambda: clean(folder))

    def finished():
        capture(worked_out, source, folder, resume=True)
        clean(folder)

    case.follow("finish the capture (--resume)", finished)


for _entry, _one in {
    _in_both: "{} is in it and in {} as well; remove one of the two",
    _not_there: "{} of the table is not there; put it back, or capture again (--resume)",
    _not_in_the_table: ("{} is not in the table; finish the capture (--resume), or remove what does not belong to it"),
}.items():
    _many = _one.replace(" is ", " are ", 1).replace("put it", "put them")
    remedy("dataset/dataset.py", f"folder {{}}: {_one}")(partial(_entry, several=False))
    remedy("dataset/dataset.py", f"folder {{}}: {_many}")(partial(_entry, several=True))


@remedy("dataset/dataset.py", "folder {}: {} in it is not a folder, so images cannot be moved to it; move it away")
def _in_the_way(case: Case) -> None:
    folder = captured(case)
    (folder / "satellite" / "rejected").write_text("")
    case.refused(lambda: clean(folder, 8.0, move=True))

    def moved():
        (folder / "satellite" / "rejected").rename(case.tmp_path / "away")
        clean(folder, 8.0, move=True)

    case.follow("move it away", moved)


@remedy(
    "dataset/dataset.py",
    "file {}: cannot be moved to {} ({}); run it again to finish, or undo to put all back",
)
def _cannot_be_moved(case: Case) -> None:
    real = os.replace

    def stuck(folder):
        moves = []

        def replaced(origin, target):
            # As in Windows, where a viewer holds a file; tables are written all the same.
            if Path(target).parent.name == "rejected":
                moves.append(origin)
                if len(moves) == 3:
                    raise PermissionError(13, "The file is in use")
            real(origin, target)

        with case.monkeypatch.context() as held:
            held.setattr(os, "replace", replaced)
            case.refused(lambda: clean(folder, 8.0, move=True))

    finish_or_undo(case, stuck)


@remedy("dataset/clean.py", "stopped while files were moved: run it again to finish, or undo to put all back")
def _stopped(case: Case) -> None:
    def stopped(folder):
        asked = []
        case.refused(
            lambda: clean(folder, 8.0, move=True, progress=lambda share: asked.append(share) or len(asked) < 3),
            Cancelled,
        )

    finish_or_undo(case, stopped)


def finish_or_undo(case: Case, break_off) -> None:
    """Break cleaning off, and finish it or take it back."""
    folder = captured(case)
    whole = [path.name for path in images_in(folder)]
    break_off(folder)
    other = copied(folder)
    assert images_in(folder)

    def finished():
        clean(folder, 8.0, move=True)
        return not images_in(folder)

    case.follow("run it again to finish", finished)

    def undone():
        undo(other)
        return [path.name for path in images_in(other)] == whole

    case.follow("undo to put all back", undone)


@remedy(
    "dataset/dataset.py",
    "image {}: has {} x {} px, and {} x {} px in the table; capture it again, or put the table right",
)
def _other_size(case: Case) -> None:
    folder = captured(case)
    image = images_in(folder)[0]
    first = read_dataset(folder).image_sets["satellite"].table.img_names.index(image.name)

    def load(folder):
        return LabelledImages(folder, part="all", map_type="satellite", img_size=(16, 16, 3)).image(first, 0)

    Image.new("RGB", (20, 20)).save(image)
    other = copied(folder)
    case.refused(lambda: load(folder))

    def captured_again():
        image.unlink()
        again(folder)
        load(folder)

    case.follow("capture it again", captured_again)

    def put_right():
        path = other / "satellite" / TABLE_FILE
        table = Table.load(path)
        width, height = table.image_width_px.copy(), table.image_height_px.copy()
        width[first] = height[first] = 20
        replace(table, image_width_px=width, image_height_px=height).save(path)
        load(other)

    case.follow("put the table right", put_right)


@remedy("dataset/dataset.py", "image {}: is not there; put it back, or capture it again (--resume)")
def _lost(case: Case) -> None:
    folder = captured(case)
    samples = LabelledImages(folder, part="all", map_type="satellite")
    image = samples.path(0)
    image.rename(case.tmp_path / "kept.png")
    case.refused(lambda: samples.image(0, 0))
    (case.tmp_path / "kept.png").rename(image)
    case.follow("put it back", lambda: samples.image(0, 0))
    image.unlink()

    def resumed():
        again(folder)
        samples.image(0, 0)

    case.follow("capture it again (--resume)", resumed)


# --- tables


@remedy("dataset/table.py", "{}: has column {} more than once; rename or remove all but one")
def _column_twice(case: Case) -> None:
    folder = captured(case)
    path = folder / "satellite" / TABLE_FILE
    rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()]

    def write(*headers):
        lines = [
            ",".join([*row, *more]) for row, more in zip(rows, [headers, *(["1"] * len(headers) for _ in rows[1:])])
        ]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")

    write("mine", "mine")
    case.refused(lambda: Table.load(path))
    write("mine", "mine_2")
    case.follow("rename", lambda: Table.load(path))
    write("mine")
    case.follow("remove all but one", lambda: Table.load(path))


@remedy("dataset/table.py", "{}; repair the table, or remove it to have it written anew")
def _repair(case: Case) -> None:
    folder = captured(case)
    path = folder / "satellite" / TABLE_FILE
    sound = path.read_text(encoding="utf-8").splitlines()
    broken = [sound[0] + ",mine", *(line + ",1" for line in sound[1:-1]), sound[-1]]
    path.write_text("\n".join(broken) + "\n", encoding="utf-8")
    case.refused(lambda: again(folder))
    path.write_text("\n".join([*broken[:-1], sound[-1] + ",1"]) + "\n", encoding="utf-8")
    case.follow("repair the table", lambda: again(folder))
    path.unlink()

    def anew():
        again(folder)
        return len(Table.load(path).img_names) == len(sound) - 1

    case.follow("remove it to have it written anew", anew)


# --- labels and splits


@remedy(
    "dataset/labels.py",
    "frame {}: is {}, not a projected system in metres, which labels need; give the code of one",
)
def _not_projected(case: Case) -> None:
    folder = captured(case)
    case.refused(lambda: split(folder, frame="EPSG:4326"))
    case.follow("give the code of one", lambda: split(folder, frame="EPSG:32616"))


@remedy("dataset/labels.py", "frame {}: PROJ knows no such system; give the code of another one")
def _no_such_system(case: Case) -> None:
    folder = captured(case)
    case.refused(lambda: split(folder, frame="EPSG:1"))
    case.follow("give the code of another one", lambda: split(folder, frame="EPSG:32616"))


@remedy("dataset/labels.py", "frame {}: {} cannot hold all positions, such as {}; choose mission or utm")
def _cannot_hold(case: Case) -> None:
    lat, lon = np.array([10.0, 10.0]), np.array([179.999, -179.999])
    case.refused(lambda: make_labels(lat, lon, "EPSG:3395"))
    case.follow("choose mission", lambda: make_labels(lat, lon, "mission"))
    case.follow("utm", lambda: make_labels(lat, lon, "utm"))


@remedy("dataset/labels.py", "frame {}: {} cannot hold all positions, such as {}; choose {}")
def _not_by_zones(case: Case) -> None:
    lat, lon = np.array([0.0, 0.0]), np.array([0.0, 180.0])
    case.refused(lambda: make_labels(lat, lon, "utm"))
    case.follow("choose mission", lambda: make_labels(lat, lon, "mission"))


@remedy("dataset/labels.py", "labels: no image is in the training part, which the scaler is fitted on; split anew")
def _no_training(case: Case) -> None:
    folder = captured(case)
    table = read_dataset(folder).image_sets["satellite"].table
    where = table.lat_deg, table.lon_deg
    case.refused(lambda: make_labels(*where, training=np.zeros(len(table.lat_deg), bool)))
    case.follow("split anew", lambda: bool(split(folder).images["train"]))


@remedy(
    "dataset/labels.py",
    "labels: the dataset has no image that is there and not rejected; capture or clean anew",
)
def _none_left(case: Case) -> None:
    folder = captured(case)

    def labels():
        return make_dataset_labels(one.table for one in read_dataset(folder).image_sets.values())

    clean(folder, 8.0)
    case.refused(labels)

    def cleaned():
        clean(folder, 0.0)
        labels()

    case.follow("clean anew", cleaned)
    other = captured(case, name="other")
    case.follow("capture", lambda: make_dataset_labels(one.table for one in read_dataset(other).image_sets.values()))


@remedy(
    "dataset/labels.py",
    "{}: a split was interrupted, so the parts of its map types may disagree; split again, or undo the split",
)
def _interrupted(case: Case) -> None:
    folder = captured(case)
    split(folder)
    mark_unfinished(folder / LABELS_FILE)
    case.refused(lambda: sample(folder))

    def split_again():
        split(folder)
        sample(folder)

    case.follow("split again", split_again)
    case.follow("undo the split", lambda: undo_split(folder).changed)


@remedy("dataset/labels.py", "{}: cannot be read ({}); have it made anew by split")
def _no_labels(case: Case) -> None:
    folder = captured(case)
    (folder / LABELS_FILE).write_text("{}")
    case.refused(lambda: sample(folder))

    def anew():
        split(folder)
        sample(folder)

    case.follow("have it made anew by split", anew)


@remedy("dataset/split.py", "split {}: has no blocks and no gap; choose blocks, or leave their sizes out")
def _no_blocks(case: Case) -> None:
    folder = captured(case)
    case.refused(lambda: split(folder, how="shuffled", block_m=100.0))
    case.follow("choose blocks", lambda: split(folder, how="blocks", block_m=100.0))
    case.follow("leave their sizes out", lambda: split(folder, how="shuffled"))


@remedy(
    "dataset/split.py",
    "folder {}: the ground that its images show is not known (they see the horizon, or come from no "
    "map), so there are no "
    "blocks of it; split shuffled or in-order",
)
def _no_ground(case: Case) -> None:
    area = Points(tuple((10.0 + 0.02 * index, 20.0, 60.0) for index in range(4)))
    folder = captured(case, MISSION.replace(area=area, agl_m=60.0, tilt_deg=80.0, accept_error=True))
    case.refused(lambda: split(folder, how="blocks"))
    case.follow("split shuffled", lambda: split(folder, how="shuffled"))
    case.follow("in-order", lambda: split(folder, how="in-order"))


@remedy(
    "dataset/split.py",
    "split by {}: {} images up to {} m wide with a gap of {} m leave one of {} without images; choose a "
    "smaller gap, "
    "other blocks or shares, a dataset of more ground, or split shuffled",
)
def _empty_part(case: Case) -> None:
    folder = captured(case)
    case.refused(lambda: split(folder, how="blocks", gap_m=400.0))
    case.follow("choose a smaller gap", lambda: split(folder, how="blocks", gap_m=0.0))
    case.refused(lambda: split(folder, how="blocks", block_m=5000.0, gap_m=1.0))
    case.follow("other blocks", lambda: split(folder, how="blocks", block_m=200.0, gap_m=1.0))
    case.follow("shares", lambda: split(folder, (1.0, 0.0, 0.0), how="blocks", block_m=5000.0, gap_m=1.0))
    more = captured(case, MISSION.replace(area=Box(35.18, -89.92, 35.15, -89.88), agl_m=480.0), "more")
    case.follow("a dataset of more ground", lambda: split(more, how="blocks", gap_m=400.0))
    case.follow("split shuffled", lambda: split(folder, how="shuffled"))


@remedy(
    "dataset/split.py",
    "split by {}: {} images up to {} m wide with a gap of {} m leave one of {} without images; choose other "
    "blocks or shares, a dataset of more ground, or split shuffled",
)
def _empty_part_without_a_gap(case: Case) -> None:
    folder = captured(case)
    case.refused(lambda: split(folder, how="blocks", block_m=5000.0))
    case.follow("choose other blocks", lambda: split(folder, how="blocks", block_m=200.0))
    case.follow("shares", lambda: split(folder, (1.0, 0.0, 0.0), how="blocks", block_m=5000.0))
    more = captured(case, MISSION.replace(area=Box(35.24, -89.98, 35.15, -89.88), agl_m=1500.0), "more")
    case.follow("a dataset of more ground", lambda: split(more, how="blocks", block_m=5000.0))
    case.follow("split shuffled", lambda: split(folder, how="shuffled"))


@remedy(
    "dataset/split.py",
    "split by blocks: most of {} images up to {} m wide would be in no part, as they show the same ground; take an "
    "area {} m long or more, smaller images or less overlap, or split shuffled",
)
def _too_little_ground(case: Case) -> None:
    def strip(name, length_deg, **changes):
        area = Box(35.16, -89.90, 35.1599, -89.90 + length_deg)
        return captured(case, MISSION.replace(area=area, overlap_along=0.9, map_types=("satellite",), **changes), name)

    folder = strip("short", 0.003)
    case.refused(lambda: split(folder))
    taken = re.search(r"take an area ([\d,]+) m long or more", case.advice)
    longer, smaller = (
        strip("long", 0.001 + float(taken[1].replace(",", "")) / 91_000.0),
        strip("low", 0.003, agl_m=40.0),
    )
    case.follow(taken[0], lambda: split(longer))
    case.follow("smaller images", lambda: split(smaller))
    apart = captured(case, MISSION.replace(map_types=("satellite",), overlap_along=0.05), "apart")
    case.follow("less overlap", lambda: split(apart, how="blocks"))
    case.follow("split shuffled", lambda: split(folder, how="shuffled"))


@remedy(
    "dataset/ground.py",
    "folder {}: the window of {} in the table lies elsewhere than its Lat and Lon; put the table right, "
    "or split without "
    "blocks",
)
def _elsewhere(case: Case) -> None:
    folder = captured(case)
    path = folder / "satellite" / TABLE_FILE
    sound = path.read_bytes()
    table = Table.load(path)
    left = table.left_px.copy()
    left[0] += 4000.0
    replace(table, left_px=left).save(path)
    case.refused(lambda: split(folder, how="blocks"))
    case.follow("split without blocks", lambda: split(folder))
    path.write_bytes(sound)
    case.follow("put the table right", lambda: split(folder, how="blocks"))


@remedy("dataset/ground.py", "{}: has no row of {}; put back the capture's own")
def _no_row(case: Case) -> None:
    folder = captured(case, TURNED)
    path = folder / "plan.csv"
    sound = path.read_text(encoding="utf-8")
    path.write_text("".join(sound.splitlines(keepends=True)[:-1]), encoding="utf-8")
    case.refused(lambda: split(folder, how="blocks"))
    path.write_text(sound, encoding="utf-8")
    case.follow("put back the capture's own", lambda: split(folder, how="blocks"))


@remedy(
    "dataset/ground.py",
    "{}: cannot be read ({}), and blocks need it for the ground of a turned camera's images: "
    "put it back, or split without blocks",
)
def _no_plan(case: Case) -> None:
    folder = captured(case, TURNED)
    path = folder / "plan.csv"
    path.rename(case.tmp_path / "kept.csv")
    case.refused(lambda: split(folder, how="blocks"))
    case.follow("split without blocks", lambda: split(folder))
    (case.tmp_path / "kept.csv").rename(path)
    case.follow("put it back", lambda: split(folder, how="blocks"))


# --- conversions


@remedy("dataset/convert.py", "folder {}: is the current one, which is in use; give a new one")
def _current(case: Case) -> None:
    write_published(case.tmp_path / "a" / "satellite")
    (case.tmp_path / "here").mkdir()
    case.monkeypatch.chdir(case.tmp_path / "here")
    case.refused(lambda: convert(case.tmp_path / "a", "."))
    case.follow("give a new one", lambda: convert(case.tmp_path / "a", "new"))


@remedy("dataset/convert.py", "folder {}: is there already; choose a new or empty folder")
def _full(case: Case) -> None:
    write_published(case.tmp_path / "a" / "satellite")
    for name in ("full", "empty"):
        (case.tmp_path / name).mkdir()
    (case.tmp_path / "full" / "mine.txt").write_text("")
    case.refused(lambda: convert(case.tmp_path / "a", case.tmp_path / "full"))
    case.follow("choose a new", lambda: convert(case.tmp_path / "a", case.tmp_path / "new"))
    case.follow("empty folder", lambda: convert(case.tmp_path / "a", case.tmp_path / "empty"))


@remedy(
    "dataset/convert.py",
    "folder {}: is left over from an interrupted conversion, or another is running; remove it",
)
def _left(case: Case) -> None:
    write_published(case.tmp_path / "a" / "satellite")
    (case.tmp_path / "b.part").mkdir()
    case.refused(lambda: convert(case.tmp_path / "a", case.tmp_path / "b"))

    def removed():
        (case.tmp_path / "b.part").rmdir()
        convert(case.tmp_path / "a", case.tmp_path / "b")

    case.follow("remove it", removed)


@remedy("dataset/vbn.py", "folder {}: {} more than once; remove or rename all but one")
def _stem_twice(case: Case) -> None:
    write_vbn(case.tmp_path, ["1", "2"])
    twin = case.tmp_path / "JPG2" / "1.JPG"
    shutil.copy(case.tmp_path / "JPG2" / "1.jpg", twin)
    case.refused(lambda: read_dataset(case.tmp_path, "VBN"))
    twin.rename(twin.with_name("3.jpg"))
    shutil.copy(case.tmp_path / "MetaData2" / "2.txt", case.tmp_path / "MetaData2" / "3.txt")
    case.follow("rename all but one", lambda: read_dataset(case.tmp_path, "VBN"))
    twin.with_name("3.jpg").unlink()
    case.follow("remove", lambda: read_dataset(case.tmp_path, "VBN"))


@remedy(
    "dataset/vbn.py",
    "folder {}: {} of {} without a text in {}; put it there, or remove the image",
)
def _no_text(case: Case) -> None:
    write_vbn(case.tmp_path, ["1", "2"])
    text = case.tmp_path / "MetaData2" / "2.txt"
    kept = text.read_bytes()
    text.unlink()
    case.refused(lambda: read_dataset(case.tmp_path, "VBN"))
    text.write_bytes(kept)
    case.follow("put it there", lambda: read_dataset(case.tmp_path, "VBN"))
    text.unlink()
    (case.tmp_path / "JPG2" / "2.jpg").unlink()
    case.follow("remove the image", lambda: read_dataset(case.tmp_path, "VBN"))


# --- loading


@remedy("dataset/loading/batches.py", "part {}: {} is not split; run terrainav split, or take the part {}")
def _not_split(case: Case) -> None:
    folder = captured(case)
    case.refused(lambda: LabelledImages(folder, part="train"))
    case.follow("take the part 'all'", lambda: LabelledImages(folder, part="all"))
    case.follow("run terrainav split", lambda: case.run("split", str(folder)).returncode == 0)
    LabelledImages(folder, part="train")


@remedy("dataset/loading/batches.py", "folder {}: has no images {}; split, clean or capture it anew")
def _no_images(case: Case) -> None:
    folder = captured(case)
    split(folder, (0.5, 0.0, 0.5))
    case.refused(lambda: LabelledImages(folder, part="validation"))

    def split_anew():
        split(folder)
        LabelledImages(folder, part="validation")

    case.follow("split", split_anew)
    clean(folder, 8.0)
    case.refused(lambda: LabelledImages(folder, part="all"))

    def cleaned():
        clean(folder, 0.0)
        LabelledImages(folder, part="all")

    case.follow("clean", cleaned)
    case.follow("capture it anew", lambda: LabelledImages(captured(case, name="other"), part="all"))


@remedy(
    "dataset/loading/batches.py",
    "targets {}: images that are turned, mirrored or zoomed are of another pose; leave the augmentation out, or take "
    "one of contrast and brightness alone",
)
def _turned_targets(case: Case) -> None:
    folder = captured(case)
    chosen = {"part": "all", "targets": ("attitude",)}
    case.refused(lambda: LabelledImages(folder, augment=augment.Augmentation(), **chosen))
    shaded = augment.Augmentation(rotation_deg=0.0, flip=False, zoom=0.0, contrast=0.2, brightness=0.1)
    case.follow("take one of contrast and brightness alone", lambda: LabelledImages(folder, augment=shaded, **chosen))
    case.follow("leave the augmentation out", lambda: LabelledImages(folder, augment=None, **chosen))


def labels_file(case: Case) -> tuple[str]:
    """File of one field, as the labels of a mission."""
    field = {"type": "Polygon", "coordinates": [[[-89.9, 35.156], [-89.895, 35.156], [-89.9, 35.16], [-89.9, 35.156]]]}
    path = case.tmp_path / "fields.geojson"
    path.write_text(json.dumps({"type": "Feature", "properties": {}, "geometry": field}))
    return (str(path),)


@remedy("exports/label_sets.py", "folder {}: has labels without both {} and {}; capture it with both products")
def _one_product_of_labels(case: Case) -> None:
    mission = MISSION.replace(labels=labels_file(case), products=("classes",))
    folder = captured(case, mission, "classes-alone")
    case.refused(lambda: write_coco(folder, case.tmp_path / "coco"))
    both = captured(case, mission.replace(products=("classes", "instances")), "both")
    case.follow("capture it with both products", lambda: write_coco(both, case.tmp_path / "coco"))


@remedy("dataset/label_images.py", "folder {}: has no {}, as it was captured without labels; capture it with labels")
def _no_labels(case: Case) -> None:
    chosen = {"part": "all", "targets": ("classes",)}
    folder = captured(case)
    case.refused(lambda: LabelledImages(folder, **chosen))

    def with_labels():
        labelled = captured(case, MISSION.replace(labels=labels_file(case)), "labelled")
        assert set(np.unique(LabelledImages(labelled, **chosen).take([0])[1])) == {0, 1}

    case.follow("capture it with labels", with_labels)


@remedy("dataset/label_images.py", "map type {}: labels are those of the images with distortion; take {}")
def _labels_of_twins(case: Case) -> None:
    chosen = {"part": "all", "targets": ("classes",)}
    lens = MISSION.replace(camera=Camera(60.0, k1=-0.2), keep_undistorted=True, labels=labels_file(case))
    folder = captured(case, lens)
    case.refused(lambda: LabelledImages(folder, map_type="satellite_undistorted", **chosen))
    case.follow("take satellite", lambda: LabelledImages(folder, map_type="satellite", **chosen))


@remedy("dataset/loading/batches.py", "table {}: has split {} ({}); must be one of {} or empty: split anew")
def _odd_part(case: Case) -> None:
    folder = captured(case)
    split(folder)
    edited(folder / "satellite" / TABLE_FILE, "train", "practice", 1)
    case.refused(lambda: LabelledImages(folder, part="test", map_type="satellite"))

    def anew():
        split(folder)
        LabelledImages(folder, part="test", map_type="satellite")

    case.follow("split anew", anew)


@remedy(
    "dataset/loading/batches.py",
    "{}: is of another dataset or split, as {} of the training part lies {} standard deviations from its "
    "mean; have it "
    "made anew by split",
)
def _of_another(case: Case) -> None:
    folder = captured(case)
    elsewhere = captured(case, MISSION.replace(area=Box(36.16, -89.90, 36.1555, -89.8945)), "elsewhere")
    for one in (folder, elsewhere):
        split(one)
    shutil.copy(elsewhere / LABELS_FILE, folder / LABELS_FILE)
    case.refused(lambda: LabelledImages(folder))

    def anew():
        split(folder)
        LabelledImages(folder)

    case.follow("have it made anew by split", anew)


@remedy(
    "dataset/loading/batches.py",
    "labels: {} cannot be had in {}, first Lat {}, Lon {}; split with another --frame",
)
def _not_in_frame(case: Case) -> None:
    folder = write_dataset(case.tmp_path / "OUT")
    split(folder, frame="mercator")
    # A table that was worked on since, and tells of the south pole.
    path = folder / "satellite" / TABLE_FILE
    table = Table.load(path)
    at = image_parts(table).index("test")
    pole = table.img_names[at].replace(f"_{table.lat_deg[at]!r}_", "_-90.0_")
    (folder / "satellite" / table.img_names[at]).rename(folder / "satellite" / pole)
    lat, names = table.lat_deg.copy(), list(table.img_names)
    lat[at], names[at] = -90.0, pole
    replace(table, lat_deg=lat, img_names=tuple(names)).save(path)
    case.refused(lambda: LabelledImages(folder, part="all"))

    def another():
        split(folder, frame="mission")
        LabelledImages(folder, part="all")

    case.follow("split with another --frame", another)


@remedy("dataset/loading/batches.py", "loader: {} is not installed; get it with: pip install 'terrainav[{}]'")
def _no_library(case: Case) -> None:
    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "keras", None)
        case.refused(lambda: optional_module("keras", "Keras", "keras"))
    case.follow("get it with: pip install 'terrainav[keras]'", lambda: extra_brings("keras", "keras"))
    assert extra_brings("torch", "torch")


@remedy(
    "dataset/loading/batches.py",
    "loader: Keras cannot be used with its backend ({}); set KERAS_BACKEND to one that is installed, "
    "such as torch, before "
    "Python starts",
)
def _no_backend(case: Case) -> None:
    (case.tmp_path / "keras.py").write_text(
        "import importlib, os\nimportlib.import_module(os.environ.get('KERAS_BACKEND', 'no_such_backend'))\n"
    )
    case.monkeypatch.syspath_prepend(str(case.tmp_path))
    case.monkeypatch.delitem(sys.modules, "keras", raising=False)
    case.monkeypatch.delenv("KERAS_BACKEND", raising=False)
    load = partial(optional_module, "keras", "Keras", "keras")
    case.refused(load)
    # A stand-in that imports what the variable names, as Keras does; one that is there is `json`.
    case.monkeypatch.setenv("KERAS_BACKEND", "json")
    case.follow("set KERAS_BACKEND to one that is installed, such as torch, before Python starts", load)
    case.monkeypatch.delitem(sys.modules, "keras")


@remedy(
    "dataset/loading/batches.py",
    "batch of {} images of {} x {} px and {} channels: does not fit into memory; take smaller batches, "
    "or smaller images",
)
def _large_batch(case: Case) -> None:
    folder, real = captured(case), np.empty

    def scarce(shape, *args):
        if np.prod(shape) > 5_000:
            raise MemoryError
        return real(shape, *args)

    def first(size, img_size):
        batches = Batches(folder, size, part="all", img_size=img_size)
        with case.monkeypatch.context() as machine:
            machine.setattr(np, "empty", scarce)
            return next(iter(batches))

    case.refused(lambda: first(4, (32, 32, 3)))
    case.follow("take smaller batches", lambda: first(1, (32, 32, 3)))
    case.follow("smaller images", lambda: first(4, (8, 8, 3)))


@remedy(
    "dataset/loading/augment.py",
    "image of {} x {} px: augmented, it needs {} x {} px with its reflections, which is too much memory; "
    "take smaller or "
    "less narrow images, or do not augment",
)
def _reflections(case: Case) -> None:
    case.monkeypatch.setattr(augment, "_MOST_PX", 100_000)

    def turned(width, height):
        longest = max(width, height)
        image = Image.new("L", (width, height))
        return augment._add_reflections(image, (longest - width) // 2, (longest - height) // 2)

    case.refused(lambda: turned(4, 400))
    case.follow("take smaller", lambda: turned(1, 100))
    case.follow("less narrow images", lambda: turned(40, 40))
    folder = captured(case)
    case.follow("do not augment", lambda: LabelledImages(folder, part="all", augment=None).image(0, 0))


@remedy(
    "dataset/dataset.py",
    "image {}: has {}, and not grey or colours of 8 bits; take the dtype stored, or capture with a stretch (--stretch)",
)
def _of_more_than_8_bits(case: Case) -> None:
    from tests.core.imagery.raster import test_bands as rasters

    path = rasters.written(case.tmp_path / "r.tif", rasters.noise("uint16", 3))
    rasters.captured(path, case.tmp_path / "deep")
    case.refused(lambda: sample(case.tmp_path / "deep"))
    case.follow("take the dtype stored", lambda: sample(case.tmp_path / "deep", dtype="stored"))

    def stretched():
        rasters.captured(path, case.tmp_path / "shown", stretch="percentile")
        sample(case.tmp_path / "shown")

    case.follow("capture with a stretch (--stretch)", stretched)


# --- mosaics


@remedy(
    "mosaic/orthomosaic.py",
    "mosaic of {} x {} px: at most {} px along a side; give a larger ground sample distance",
)
def _too_fine_a_mosaic(case: Case) -> None:
    folder = captured(case, TURNED)
    case.refused(lambda: make_orthomosaic(folder, gsd_m=1e-5))
    case.follow("give a larger ground sample distance", lambda: make_orthomosaic(folder, gsd_m=5.0))


# --- shards


@remedy(
    "dataset/stored.py",
    "image {}: is not where the table says it is, as the shard is damaged or a different one; put back the shard that "
    "belongs to the table",
)
def _torn_shard(case: Case) -> None:
    place = write_shards(case.tmp_path / "shards", captured(case, MISSION.replace(map_types=("satellite",))))
    shard = place / "satellite" / "satellite-000000.tar"
    whole = shard.read_bytes()
    shard.write_bytes(b"\0" * len(whole))
    case.refused(lambda: sample(place))

    def put_back():
        shard.write_bytes(whole)
        sample(place)

    case.follow("put back the shard that belongs to the table", put_back)


@remedy(
    "dataset/loading/streaming.py",
    "folder {}: cannot keep the shard {} ({}); set TMPDIR to a folder with more room",
)
def _full_disk(case: Case) -> None:
    folder = captured(case, MISSION.replace(map_types=("satellite",)))
    place = write_shards(f"memory://{case.tmp_path.name}", folder)
    small, large = case.tmp_path / "small", case.tmp_path / "large"
    large.mkdir()

    def load(temporary):
        case.monkeypatch.setattr(tempfile, "tempdir", None)
        case.monkeypatch.setenv("TMPDIR", str(temporary))
        batches = Batches(place, part="all", img_size=(8, 8, 3))
        if temporary == small:
            # Nothing can be written there any more, not even by root.
            (kept,) = small.iterdir()
            kept.rmdir()
            kept.write_bytes(b"")
        return list(batches)

    small.mkdir()
    case.refused(lambda: load(small))
    case.follow("set TMPDIR to a folder with more room", lambda: load(large))
