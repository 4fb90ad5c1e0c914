"""Labels as training sets: pycocotools and rasterio find the pixels that the dataset has."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import rasterio.features
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.label_images import LabelImages
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.exports import label_sets
from terrainav.core.exports.kinds import LABEL_SETS, export_as, refusals
from terrainav.core.exports.label_sets import coco_annotations, write_coco, write_yolo, yolo_polygons
from terrainav.core.exports.masks import Masks

from tests.support.command import command
from tests.support.datasets import PARTS, write_dataset
from tests.support.labelled import NAMES, write_labelled

coco_masks = pytest.importorskip("pycocotools.mask")
BACKGROUND, IGNORE = 0, 255
WIDEST = 2**32 - 1


def random_labels(seed: int, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Classes and instances of speckles, or of boxes and discs upon each other, with pixels of each kind."""
    rng = np.random.default_rng(seed)
    if seed % 3 == 0:
        return rng.choice([0, 1, 2, IGNORE], (height, width)), rng.choice([0, 1, WIDEST], (height, width))
    classes, instances = np.zeros((2, height, width), np.int64)
    y, x = np.mgrid[:height, :width]
    for _ in range(rng.integers(0, 9)):
        row, column, size = rng.integers(-2, height), rng.integers(-2, width), rng.integers(1, 12)
        inside = np.maximum(abs(x - column), abs(y - row)) < size
        if seed % 3 == 1:
            inside = (x - column) ** 2 + (y - row) ** 2 < size**2
        classes[inside] = rng.choice([0, 1, 2, 3, IGNORE])
        instances[inside] = rng.choice([0, 1, 2, 70_000, WIDEST])
    return classes, instances


def named_labels() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    ring = np.zeros((7, 9), np.int64)
    ring[1:6, 1:8] = 4
    ring[2:5, 2:7] = 0
    ring[3, 4] = 4
    corners = np.array([[1, 0, 1], [0, 1, 0], [1, 0, 1]])
    diagonal_hole = np.array([[1, 1, 1, 1], [1, 0, 1, 1], [1, 1, 0, 1], [1, 1, 1, 1]])
    shapes = {
        "ring with an island": ring,
        "pixels that touch at corners": corners,
        "holes that touch at a corner": diagonal_hole,
        "hole that touches the outside at a corner": diagonal_hole * (np.arange(4) < 3)[:, np.newaxis],
        "whole image": np.ones((3, 5), np.int64),
        "one pixel": np.ones((1, 1), np.int64),
        "empty": np.zeros((4, 6), np.int64),
    }
    return {name: (shape, shape * 70_001) for name, shape in shapes.items()}


LABELS = {
    **named_labels(),
    **{f"random {seed}": random_labels(seed, 1 + seed * 7 % 29, 1 + seed * 5 % 37) for seed in range(60)},
}


@pytest.mark.parametrize("labels", LABELS.values(), ids=LABELS)
def test_pycocotools_finds_masks_areas_and_boxes(labels):
    classes, instances = labels
    size = classes.shape
    found = {}
    for one in coco_annotations(Masks(classes, instances, (BACKGROUND, IGNORE))):
        key = one["category_id"], one["instance"]
        wanted = (classes == key[0]) & (instances == key[1])
        outlined = isinstance(one["segmentation"], list)
        # As pycocotools.coco.COCO.annToRLE has it.
        packed = (
            coco_masks.merge(coco_masks.frPyObjects(one["segmentation"], *size)) if outlined else one["segmentation"]
        )
        np.testing.assert_array_equal(coco_masks.decode(packed), wanted)
        own = coco_masks.encode(np.asfortranarray(wanted, np.uint8))
        assert one["area"] == coco_masks.area(own) == wanted.sum()
        assert one["bbox"] == coco_masks.toBbox(own).tolist()
        assert one["iscrowd"] == (key[1] == 0)
        assert outlined == (key[1] > 0 and not has_hole(wanted))
        if not outlined:
            assert one["segmentation"] == {"size": list(size), "counts": own["counts"].decode()}
        found[key] = wanted
    assert len(found) == len({*zip(classes.ravel().tolist(), instances.ravel().tolist())} - nothing(classes, instances))
    covered = np.zeros(size, np.int64)
    for mask in found.values():
        covered += mask
    np.testing.assert_array_equal(covered, (classes != BACKGROUND) & (classes != IGNORE))


def nothing(classes: np.ndarray, instances: np.ndarray) -> set[tuple[int, int]]:
    return {(one, at) for one in (BACKGROUND, IGNORE) for at in np.unique(instances).tolist()}


def has_hole(mask: np.ndarray) -> bool:
    """Whether some pixels outside are not connected, by edges or corners, with the rim."""
    ndimage = pytest.importorskip("scipy.ndimage")
    _, parts = ndimage.label(np.pad(~mask, 1, constant_values=True), np.ones((3, 3)))
    return parts > 1


@pytest.mark.parametrize("labels", LABELS.values(), ids=LABELS)
def test_polygons_of_yolo_enclose_the_same_pixels(labels):
    classes, instances = labels
    height, width = classes.shape
    keys = {key for key in zip(classes.ravel().tolist(), instances.ravel().tolist()) if key[1] > 0}
    wanted = sorted(keys - nothing(classes, instances), key=lambda key: key[::-1])
    polygons = [*yolo_polygons(Masks(classes, instances, (BACKGROUND, IGNORE)))]
    assert len(polygons) == len(wanted)
    for (category, instance), (found, text) in zip(wanted, polygons):
        assert found == category
        mask = (classes == category) & (instances == instance)
        np.testing.assert_array_equal(rasterized(text, width, height), mask)


def rasterized(text: str, width: int, height: int) -> np.ndarray:
    """Mask of a polygon in shares of width and height, by GDAL: pixels whose centre is inside."""
    corners = np.array(text.split(), np.float64).reshape(-1, 2)
    assert len(corners) >= 4
    assert corners.min() >= 0.0
    assert corners.max() <= 1.0
    ring = (corners * [width, height]).tolist()
    shape = {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}
    return rasterio.features.rasterize([(shape, 1)], out_shape=(height, width)).astype(bool)


@pytest.fixture(scope="module", params=["narrow", "wide"])
def labelled(request, tmp_path_factory) -> Path:
    """16 images of all parts, in files of 8 and 16 bits or of 16 and 32."""
    folder = tmp_path_factory.mktemp("labelled") / request.param
    return write_labelled(folder, wide=request.param == "wide", files="tif" if request.param == "wide" else "png")


def rows_in(labelled: Path, part: str) -> dict[str, int]:
    """Row of each image of a part, by name."""
    with (labelled / "satellite" / "meta_data.csv").open(encoding="utf-8", newline="") as file:
        return {row["img_names"]: at for at, row in enumerate(csv.DictReader(file)) if row["split"] == part}


@pytest.mark.parametrize(("part", "name"), [("train", "train"), ("validation", "val"), ("test", "test")])
def test_pycocotools_loads_each_part(labelled, tmp_path, part, name):
    coco = pytest.importorskip("pycocotools.coco")
    assert write_coco(labelled, tmp_path / "coco") == sum(one != "gap" for one in PARTS) * 2
    found = coco.COCO(tmp_path / "coco" / "annotations" / f"instances_{name}.json")
    rows = rows_in(labelled, part)
    scale = 1000 if "wide" in labelled.name else 1
    assert {one["id"]: one["name"] for one in found.loadCats(found.getCatIds())} == {
        number * scale: text for number, text in enumerate(NAMES, 1)
    }
    labels = LabelImages(read_dataset(labelled).image_sets["satellite"])
    images = found.loadImgs(found.getImgIds())
    assert {one["file_name"] for one in images} == set(rows)
    for image in images:
        place = tmp_path / "coco" / name / image["file_name"]
        assert place.read_bytes() == (labelled / "satellite" / image["file_name"]).read_bytes()
        classes, instances = (labels.pixels(kind, rows[image["file_name"]]) for kind in ("classes", "instances"))
        assert classes.shape == (image["height"], image["width"])
        drawn = np.zeros((2, *classes.shape), np.int64)
        for one in found.loadAnns(found.getAnnIds(image["id"])):
            drawn[:, found.annToMask(one) > 0] = [[one["category_id"]], [one["instance"]]]
        shown = ~np.isin(classes, (0, labels.classes.ignore))
        np.testing.assert_array_equal(drawn, np.stack([classes, instances]) * shown)


def test_yolo_has_a_text_for_each_image(labelled, tmp_path):
    count = write_yolo(labelled, tmp_path / "yolo")
    yaml = (tmp_path / "yolo" / "data.yaml").read_text(encoding="utf-8").splitlines()
    assert yaml[1:5] == ["train: images/train", "val: images/val", "test: images/test", "names:"]
    assert yaml[5:] == [f'  {at}: "{name}"' for at, name in enumerate(NAMES)]
    labels = LabelImages(read_dataset(labelled).image_sets["satellite"])
    ids = [one.id for one in labels.classes.classes]
    for part, name in (("train", "train"), ("validation", "val"), ("test", "test")):
        rows = rows_in(labelled, part)
        count -= len(rows)
        images, texts = (tmp_path / "yolo" / kind / name for kind in ("images", "labels"))
        assert {one.name for one in images.iterdir()} == set(rows)
        assert {one.stem for one in texts.iterdir()} == {Path(one).stem for one in rows}
        for file, row in rows.items():
            classes = labels.pixels("classes", row)
            height, width = classes.shape
            drawn = np.zeros_like(classes)
            for line in (texts / f"{Path(file).stem}.txt").read_text().splitlines():
                number, _, polygon = line.partition(" ")
                drawn[rasterized(polygon, width, height)] = ids[int(number)]
            np.testing.assert_array_equal(drawn, np.where(classes == labels.classes.ignore, 0, classes))
    assert count == 0


def test_without_a_split_all_images_are_for_training(tmp_path):
    folder = write_labelled(tmp_path / "whole", 3)
    table = folder / "satellite" / "meta_data.csv"
    lines = table.read_text(encoding="utf-8").splitlines()
    table.write_text("\n".join(line.rpartition(",")[0] for line in lines) + "\n", encoding="utf-8")
    assert write_coco(folder, tmp_path / "coco") == write_yolo(folder, tmp_path / "yolo") == 3
    assert len([*(tmp_path / "coco" / "train").iterdir()]) == 3
    assert [one.name for one in (tmp_path / "coco" / "annotations").iterdir()] == ["instances_train.json"]
    # Ultralytics needs both.
    yaml = (tmp_path / "yolo" / "data.yaml").read_text(encoding="utf-8").splitlines()
    assert yaml[1:4] == ["train: images/train", "val: images/train", "names:"]


def test_a_set_without_labels_is_refused_in_one_line(tmp_path):
    bare = write_dataset(tmp_path / "bare")
    line = "has no classes.json, as it was captured without labels; capture it with labels"
    for kind in LABEL_SETS:
        with pytest.raises(InvalidInput, match=line):
            export_as(bare, tmp_path / "out", kind)
        assert line in str(refusals(bare)[kind])
        with pytest.raises(InvalidInput, match=f"format {kind}: needs the folder"):
            export_as(bare, None, kind)
    half = write_labelled(tmp_path / "half", 2)
    (half / "instances").rename(half / "other")
    with pytest.raises(InvalidInput, match="has labels without both classes and instances; capture it with both"):
        write_coco(half, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_what_cannot_be_written_leaves_nothing(labelled, tmp_path, monkeypatch):
    shares = []

    def stop(share: float) -> bool:
        shares.append(share)
        return len(shares) < 3

    for kind in LABEL_SETS:
        shares.clear()
        with pytest.raises(Cancelled):
            export_as(labelled, tmp_path / kind, kind, progress=stop)
        assert shares == [1 / 14, 2 / 14, 3 / 14]
        assert [*tmp_path.iterdir()] == []
    monkeypatch.setattr(label_sets.LabelledSet, "names", {})
    with pytest.raises(InvalidInput, match=r"labels of 0_0_.*png: the class \d+ is not in the table of classes"):
        write_yolo(labelled, tmp_path / "yolo")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").touch()
    with pytest.raises(OutputError, match="is not empty"):
        write_coco(labelled, tmp_path / "full")


def test_the_command(labelled, tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    for kind in LABEL_SETS:
        done = run("export", str(labelled), kind, "--as", kind)
        assert (done.returncode, done.stderr, done.stdout) == (0, "", f"14 images as {kind} in {kind}\n")
    assert len(json.loads((tmp_path / "coco" / "annotations" / "instances_train.json").read_text())["images"]) == 10
    refused = run("export", str(labelled), "other", "--as", "coco", "--map-type", "roadmap")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
