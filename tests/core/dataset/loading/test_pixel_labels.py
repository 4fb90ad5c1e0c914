"""Labels of pixels in training: those of the ground that the image shows, however it is resized and augmented."""

from __future__ import annotations

import json
import os
import pickle
import shutil

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.label_images import LabelImages
from terrainav.core.dataset.loading import Batches, LabelledImages
from terrainav.core.dataset.loading.augment import Augmentation, Change, apply_change, change_labels, resize_labels
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.opening import named_source, open_source
from terrainav.core.mission.plan import plan

from tests.support.command import command
from tests.support.labelled import NAMES, STEP, labels_of, write_labelled
from tests.support.shards import MISSION, write_shards
from tests.support.thinning import sampled

BOTH = ("classes", "instances")
#: Python 3.12 warns of a fork beside threads, such as those that torch has made.
pytestmark = pytest.mark.filterwarnings("default:This process:DeprecationWarning")
IGNORE, BEYOND = 255, 7777


@pytest.fixture
def folder(tmp_path):
    return write_labelled(tmp_path / "OUT")


def number_of(name):
    return int(name.split("_")[0]) + 6 * int(name.split("_")[1])


# --- as stored


@pytest.mark.parametrize(
    ("ending", "files", "wide"), [("png", "png", False), ("tif", "tif", False), ("jpg", "png", True)]
)
def test_labels_are_those_of_the_files(tmp_path, ending, files, wide):
    folder = write_labelled(tmp_path / "OUT", ending=ending, files=files, wide=wide)
    samples = LabelledImages(folder, part="all", targets=BOTH, augment=None)
    images, (classes, instances) = samples.take(range(len(samples)))
    assert classes.dtype == instances.dtype == np.int64
    assert images.shape == (16, 48, 64, 3)
    for at, name in enumerate(samples.names):
        wanted = labels_of(number_of(name), 48, 64)
        of_class = np.where(wanted[0] == 255, 65535, wanted[0] * 1000) if wide else wanted[0]
        np.testing.assert_array_equal(classes[at], of_class)
        np.testing.assert_array_equal(instances[at], wanted[1] * (10_000 if wide else 1))


def test_the_table_of_classes_is_at_hand(folder):
    samples = LabelledImages(folder, part="all")
    table = samples.classes
    assert [one.name for one in table.classes] == [*NAMES]
    assert [one.colour for one in table.classes][:2] == ["#000001", "#000002"]
    assert (table.ignore, table.dtype) == (255, np.uint8)
    assert samples.pixel_targets == ()
    assert LabelImages(read_dataset(folder).image_set("satellite")).classes.classes == table.classes
    assert pickle.loads(pickle.dumps(samples)).classes.classes == table.classes


@pytest.mark.parametrize(
    ("targets", "shapes"),
    [
        (("classes",), (48, 64)),
        (("instances",), (48, 64)),
        (("image",), (2,)),
        (BOTH, [(48, 64), (48, 64)]),
        (("image", "instances"), [(48, 64), (2,)]),
        (("instances", "image", "classes"), [(48, 64), (48, 64), (2,)]),
    ],
)
def test_labels_come_as_one_array_or_in_order(folder, targets, shapes):
    samples = LabelledImages(folder, part="all", targets=targets)
    _, labels = samples.take([3, 1])
    if isinstance(shapes, list):
        assert [one.shape for one in labels] == [(2, *shape) for shape in shapes]
        assert [one.dtype for one in labels] == [*[np.int64] * (len(shapes) - 1), labels[-1].dtype]
    else:
        assert labels.shape == (2, *shapes)
    assert samples.columns == (("easting", "northing") if "image" in targets else ())


def test_images_are_the_same_with_labels_and_without(folder):
    plain, labelled = (LabelledImages(folder, targets=targets) for targets in (("image",), BOTH))
    for epoch in range(3):
        np.testing.assert_array_equal(plain.take([2, 5], epoch)[0], labelled.take([2, 5], epoch)[0])


def test_stored_values_have_stored_labels(folder):
    samples = LabelledImages(folder, part="all", dtype="stored", targets=("classes",))
    images, classes = samples.take([4])
    np.testing.assert_array_equal(classes[0], labels_of(number_of(samples.names[4]), 48, 64)[0])
    assert images.dtype == np.uint8


# --- resized and augmented: against plain numpy where positions are whole


LABELS = np.arange(1, 1 + 40 * 40).reshape(40, 40)


@pytest.mark.parametrize(
    ("change", "wanted"),
    [
        (Change(), LABELS),
        (Change(contrast=2.0, brightness=0.1), LABELS),
        (Change(mirrored=True), LABELS[:, ::-1]),
        (Change(upside_down=True), LABELS[::-1]),
        (Change(180.0), LABELS[::-1, ::-1]),
        (Change(90.0), np.rot90(LABELS)),
        (Change(-90.0), np.rot90(LABELS, -1)),
        (Change(90.0, mirrored=True), np.rot90(LABELS)[:, ::-1]),
        (Change(magnification=2.0), LABELS[10:30, 10:30].repeat(2, axis=0).repeat(2, axis=1)),
        (Change(magnification=4.0), LABELS[15:25, 15:25].repeat(4, axis=0).repeat(4, axis=1)),
        (Change(90.0, magnification=2.0), np.rot90(LABELS[10:30, 10:30]).repeat(2, axis=0).repeat(2, axis=1)),
        (Change(magnification=1 / 3), np.pad(LABELS[1::3, 1::3], 13, constant_values=BEYOND)[:40, :40]),
    ],
)
def test_whole_changes_are_cuts_of_arrays(change, wanted):
    if change.magnification < 1.0:
        # 40 px show 120: of the middle of each three.
        labels = np.arange(1, 1 + 42 * 42).reshape(42, 42)
        wanted = np.pad(labels[1::3, 1::3], 14, constant_values=BEYOND)
        np.testing.assert_array_equal(change_labels(labels, change, BEYOND), wanted)
        return
    np.testing.assert_array_equal(change_labels(LABELS, change, BEYOND), wanted)


@pytest.mark.parametrize("size", [(40, 40), (20, 20), (80, 120), (13, 31), (96, 7), (1, 1)])
def test_resized_labels_are_pillows_nearest(size):
    height, width = size
    found = Image.fromarray(LABELS.astype(np.int32)).resize((width, height), Image.NEAREST)
    np.testing.assert_array_equal(resize_labels(LABELS, height, width), np.asarray(found))
    np.testing.assert_array_equal(resize_labels(LABELS, 20, 20), LABELS[1::2, 1::2])


# --- augmented: by the positions that the image itself shows


def ramp(height, width):
    """Image whose red and green are twice the column and the row, and labels that count its pixels from 1."""
    y, x = np.mgrid[:height, :width]
    pixels = np.stack([2 * x, 2 * y, 0 * x], axis=-1).astype(np.uint8)
    return Image.fromarray(pixels), 1 + y * width + x


def changes():
    usual = Augmentation(180.0, zoom=1.0, contrast=0.0)
    return sampled([pytest.param(usual.draw_change(f"{number}", 1, 0)) for number in range(60)], 12)


@pytest.mark.parametrize("change", changes())
@pytest.mark.parametrize("size", [(60, 100), (120, 120), (111, 64)])
def test_a_label_is_of_the_pixel_that_the_image_shows(size, change):
    height, width = size
    image, labels = ramp(height, width)
    seen = np.asarray(apply_change(image, change), float)
    found = change_labels(labels, change, 0)
    # By the angle: where the centre of each pixel comes from, about the middle.
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    place = (x * (-1 if change.mirrored else 1) + 1j * y * (-1 if change.upside_down else 1)) / change.magnification
    place *= np.exp(1j * np.radians(change.rotation_deg))
    off = np.maximum(abs(place.real) - width / 2, abs(place.imag) - height / 2)
    assert (found[off > 0.01] == 0).all()
    assert (found[off < -0.01] > 0).all()
    # The ramp is half a level of each pixel; Pillow cuts levels off.
    inside = off < -1.0
    row, column = np.divmod(found[inside] - 1, width)
    assert np.abs(column - seen[inside][:, 0] / 2.0).max() < 1.02
    assert np.abs(row - seen[inside][:, 1] / 2.0).max() < 1.02


def pure(classes, ignore, radius_px=5):
    """Pixels whose neighbours all have the same class: as far as values spread that are resized, then zoomed."""
    height, width = classes.shape
    padded = np.pad(classes, radius_px, constant_values=ignore)
    side = range(2 * radius_px + 1)
    around = [padded[y : y + height, x : x + width] for y in side for x in side]
    return np.all([one == classes for one in around], axis=0) & (classes != ignore)


@pytest.mark.parametrize("img_size", [None, (160, 120, 3), (320, 240, 3), (200, 200, 1)])
@pytest.mark.parametrize(
    "augment", ["auto", None, Augmentation(180.0, zoom=1.0), Augmentation(45.0, flip=False, zoom=0.0)]
)
def test_images_and_labels_agree(tmp_path, img_size, augment):
    folder = write_labelled(tmp_path / "OUT", size=(256, 192))
    samples = LabelledImages(folder, targets=BOTH, img_size=img_size, augment=augment, dtype="uint8")
    shares, beyond = [], 0
    for epoch in range(4):
        images, (classes, instances) = samples.take(range(len(samples)), epoch)
        for at, (image, of_class, instance) in enumerate(zip(images[..., 0], classes, instances)):
            certain = pure(of_class, IGNORE)
            shares.append(certain.mean())
            np.testing.assert_array_equal(image[certain], STEP * of_class[certain])
            # An instance is of one class, and ignored pixels are of none.
            wanted, numbers = labels_of(number_of(samples.names[at]), 192, 256)
            by_instance = np.full(numbers.max() + 1, IGNORE)
            by_instance[numbers] = wanted
            np.testing.assert_array_equal(of_class, by_instance[instance])
            beyond += (instance == 0).mean() > 0.05
    assert np.mean(shares) > 0.1
    assert (beyond > 10) == (augment is not None)


def test_shading_leaves_labels(folder):
    shaded = Augmentation(0.0, flip=False, zoom=0.0, contrast=0.5, brightness=0.2)
    samples = LabelledImages(folder, targets=("classes",), augment=shaded)
    _, classes = samples.take([0])
    np.testing.assert_array_equal(classes[0], labels_of(number_of(samples.names[0]), 48, 64)[0])


# --- all loaders


def plain(place, epoch, **choice):
    batches = Batches(place, 3, **choice)
    batches.set_epoch(epoch)
    return list(batches)


def assert_same(found, wanted):
    assert len(found) == len(wanted)
    for (images, labels), (pixels, values) in zip(found, wanted):
        np.testing.assert_array_equal(np.asarray(images), pixels)
        several = isinstance(values, tuple)
        assert isinstance(labels, (tuple, list)) == several
        for one, other in zip(*(each if several else (each,) for each in (labels, values))):
            np.testing.assert_array_equal(np.asarray(one), other)
            assert str(one.dtype).rpartition(".")[2] == str(other.dtype)


TARGETS = [("classes",), BOTH, ("instances", "image")]


@pytest.mark.parametrize("targets", TARGETS)
def test_threads_give_the_same(folder, targets):
    for epoch in range(2):
        found = plain(folder, epoch, workers=2, targets=targets, img_size=(40, 30, 3))
        assert_same(found, plain(folder, epoch, targets=targets, img_size=(40, 30, 3)))


@pytest.mark.parametrize("targets", TARGETS)
@pytest.mark.parametrize(("workers", "method"), [(0, None), (2, "fork")])
def test_torch_gives_the_same(folder, targets, workers, method):
    pytest.importorskip("torch")
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    choice = {"targets": targets, "img_size": (40, 30, 3)}
    dataset = TorchDataset(folder, **choice)
    for epoch in range(2):
        dataset.set_epoch(epoch)
        found = list(dataset.batches(3, workers, multiprocessing_context=method))
        assert_same([(images.permute(0, 2, 3, 1), labels) for images, labels in found], plain(folder, epoch, **choice))


def test_torchs_losses_take_the_classes(folder):
    torch = pytest.importorskip("torch")
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    dataset = TorchDataset(folder, targets=("classes",))
    images, classes = next(iter(dataset.batches(4)))
    assert (images.shape, classes.shape) == ((4, 3, 48, 64), (4, 48, 64))
    guesses = torch.zeros(4, 7, 48, 64)
    loss = torch.nn.functional.cross_entropy(guesses, classes, ignore_index=dataset.samples.classes.ignore)
    assert abs(loss.item() - np.log(7.0)) < 1e-4
    image, one = dataset[2]
    assert (image.shape, one.shape, one.dtype) == ((3, 48, 64), (48, 64), torch.int64)
    _, (classes, position) = TorchDataset(folder, targets=("image", "classes"))[2]
    assert (classes.shape, position.shape) == ((48, 64), (2,))


@pytest.mark.parametrize("targets", TARGETS)
def test_keras_gives_the_same(folder, targets):
    pytest.importorskip("torch")
    os.environ.setdefault("KERAS_BACKEND", "torch")
    keras = pytest.importorskip("keras")
    from terrainav.core.dataset.loading.keras_loader import KerasDataset

    choice = {"targets": targets, "img_size": (40, 30, 3)}
    dataset = KerasDataset(folder, 3, **choice)
    assert_same([dataset[at] for at in range(len(dataset))], plain(folder, 0, **choice))
    if targets == ("classes",):
        model = keras.Sequential([keras.layers.Conv2D(7, 1)])
        loss = keras.losses.SparseCategoricalCrossentropy(from_logits=True, ignore_class=255)
        model.compile(loss=loss)
        assert np.isfinite(model.fit(dataset, epochs=1, verbose=0).history["loss"]).all()


@pytest.mark.parametrize("targets", TARGETS)
@pytest.mark.parametrize(
    ("ending", "files", "wide"), [("png", "png", False), ("tif", "tif", False), ("jpg", "png", True)]
)
def test_shards_and_stores_give_the_same(tmp_path, targets, ending, files, wide):
    folder = write_labelled(tmp_path / "OUT", ending=ending, files=files, wide=wide)
    choice = {"targets": targets, "img_size": (40, 30, 3), "shuffle": False}
    wanted = plain(folder, 1, **choice)
    for place in (tmp_path / "SHARDS", f"memory://{tmp_path.name}"):
        packed = write_shards(place, folder, 4)
        assert_same(plain(str(packed), 1, **choice), wanted)
        assert_same(plain(str(packed), 1, workers=2, **choice), wanted)


@pytest.mark.parametrize("image_format", ["tif", "jpg"])
def test_captures_as_files_and_in_shards_give_the_same(tmp_path, image_format):
    corners = [[-89.8985, 35.1585], [-89.8955, 35.158], [-89.896, 35.1595], [-89.8985, 35.1585]]
    field = {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [corners]}}
    (tmp_path / "fields.geojson").write_text(json.dumps(field))
    mission = MISSION.replace(labels=(str(tmp_path / "fields.geojson"),), image_format=image_format)
    planned, source = plan(mission, open_source("world").grid), named_source("world")
    capture(planned, source, tmp_path / "files", blocks=Blocks(4))
    capture(planned, source, tmp_path / "shards", blocks=Blocks(4, "webdataset"))
    choice = {"part": "all", "targets": BOTH, "img_size": (40, 40, 3), "augment": Augmentation()}
    files, shards = (LabelledImages(tmp_path / name, **choice) for name in ("files", "shards"))
    assert files.names == shards.names
    wanted = files.take(range(len(files)), 1)
    assert {*np.unique(wanted[1][0])} == {0, 1, IGNORE}
    assert_same([shards.take(range(len(shards)), 1)], [wanted])


def test_objects_of_a_store_give_the_same(tmp_path, folder):
    fsspec = pytest.importorskip("fsspec")
    store, address = fsspec.filesystem("memory"), f"memory://{tmp_path.name}"
    for path in folder.rglob("*"):
        if path.is_file():
            store.pipe_file(f"{address}/{path.relative_to(folder).as_posix()}", path.read_bytes())
    assert_same(plain(address, 1, targets=BOTH), plain(folder, 1, targets=BOTH))


def test_several_map_types_share_labels(folder):
    shutil.copytree(folder / "satellite", folder / "roadmap")
    wanted = plain(folder, 0, targets=BOTH, map_type="satellite")
    assert_same(plain(folder, 0, targets=BOTH, map_type="roadmap"), wanted)


# --- what is missing or wrong


def test_a_dataset_without_labels_is_refused(folder):
    (folder / "classes.json").unlink()
    with pytest.raises(InvalidInput, match=r"has no classes.json, as it was captured without labels"):
        LabelledImages(folder, targets=("classes",))
    assert LabelledImages(folder).columns == ("easting", "northing")


def test_a_missing_or_damaged_file_is_named(folder):
    samples = LabelledImages(folder, part="all", targets=("classes",))
    path = folder / "classes" / f"{samples.names[3]}.png"
    data = path.read_bytes()
    for content, words in ((None, "are not there"), (b"", "cannot be read"), (data[:200], "cannot be read")):
        path.unlink()
        if content is not None:
            path.write_bytes(content)
        else:
            with pytest.raises(InvalidInput, match=f"labels .*{path.stem}.* {words}"):
                samples.take([3])
            path.write_bytes(b"")
            continue
        with pytest.raises(InvalidInput, match=f"labels .*{path.stem}.* {words}"):
            samples.take([3])


def test_labels_of_another_size_or_in_colour_are_refused(folder):
    samples = LabelledImages(folder, part="all", targets=("classes",))
    path = folder / "classes" / f"{samples.names[3]}.png"
    Image.new("P", (20, 10)).save(path)
    with pytest.raises(InvalidInput, match=r"classes of .*: of 20 x 10 px, where images have 64 x 48"):
        samples.take([3])
    Image.new("RGB", (64, 48)).save(path)
    with pytest.raises(InvalidInput, match="must have one channel of whole numbers"):
        samples.take([3])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "table of classes"),
        ("[]", "it must hold background, ignore, and classes of id, name and color"),
        ('{"classes": [{"id": 1}]}', "it must hold background, ignore, and classes of id, name and color"),
        ('{"classes": [], "background": 0, "ignore": 9}', "background 0 and ignore 9 must be 0 and 255"),
        (
            '{"classes": [{"id": -1, "name": "a", "color": "#000000"}], "background": 0, "ignore": 255}',
            "id -1: must be",
        ),
    ],
)
def test_a_wrong_table_is_refused(folder, content, words):
    (folder / "classes.json").write_text(content)
    with pytest.raises(InvalidInput, match=words):
        LabelledImages(folder, targets=("classes",))


def test_shards_of_another_map_type_have_none(tmp_path, folder):
    shutil.copytree(folder / "satellite", folder / "roadmap")
    packed = write_shards(tmp_path / "SHARDS", folder, 4)
    for product in ("classes", "instances"):
        shutil.rmtree(folder / product)
    bare = write_shards(tmp_path / "BARE", folder, 4)
    shutil.rmtree(packed / "roadmap")
    shutil.copytree(bare / "roadmap", packed / "roadmap")
    LabelledImages(packed, targets=("classes",)).take([0])
    with pytest.raises(InvalidInput, match="its shard has no classes, which are with the first map type of a mission"):
        LabelledImages(packed, targets=("classes",), map_type="roadmap").take([0])


# --- the command


def test_the_command_loads_labels_of_pixels_by_torch(folder, tmp_path, monkeypatch, capsys):
    pytest.importorskip("torch")
    run = command(tmp_path, monkeypatch, capsys)
    said = run("load", str(folder), "--targets", "instances", "image", "--loader", "torch").stdout
    assert "instances (8, 48, 64) int64, labels (8, 2) float32" in said


def test_the_command_loads_labels_of_pixels(folder, tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    said = run("load", str(folder), "--targets", "classes").stdout
    assert "classes 0 background, 1 field, 2 wood, 3 water, 4 road, 5 roof, 6 wall, 255 ignore" in said
    assert "1 batch: images (8, 48, 64, 3) float32, classes (8, 48, 64) int64" in said
    told = json.loads(run("load", str(folder), "--targets", *BOTH, "--json").stdout)
    assert told["classes"]["ignore"] == 255
    assert told["batches"][0]["labels"] == [[8, 48, 64], [8, 48, 64]]
    (folder / "classes.json").unlink()
    done = run("load", str(folder), "--targets", "classes")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
