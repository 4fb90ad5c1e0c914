"""Loading: which images are taken, as which pixels and labels, in which order, and what is said of faults."""

from __future__ import annotations

import hashlib
import json
import pickle
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.dataset import open_image, read_dataset
from terrainav.core.dataset.labels import make_labels
from terrainav.core.dataset.loading import Batches, LabelledImages
from terrainav.core.dataset.loading.augment import Augmentation
from terrainav.core.dataset.loading.batches import chunks, optional_module
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.command import command
from tests.support.datasets import pixels_of, write_dataset
from tests.support.sources import PatternSource

SIZE = (20, 16, 3)
#: Labels are float32: of a spread of a kilometre, a tenth of a millimetre; in degrees, with room.
FLOAT32_DEG = 1e-8
#: Grey levels, in the mean: of a JPEG decoded at half its size beside one decoded whole, both resized.
DRAFT_LEVELS = 1.5


@pytest.fixture
def folder(tmp_path):
    return write_dataset(tmp_path / "OUT", map_types=("satellite", "roadmap"))


def numbers_of(samples):
    """Row of the table by image's name."""
    return [int(name.split("_")[0]) + 6 * int(name.split("_")[1]) for name in samples.names]


def collected(batches):
    images, labels = zip(*batches)
    return np.concatenate(images), np.concatenate(labels)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A capture in gusts: every camera is somewhere else, and turned otherwise; its plan."""
    mission = Mission(
        Box(35.16, -89.90, 35.1575, -89.897),
        60.0,
        image_px=32,
        image_format="png",
        tilt_deg=10.0,
        wind=Wind(8.0, 270.0, 0.2),
    )
    worked_out, folder = plan(mission, PatternSource().grid), tmp_path_factory.mktemp("flown") / "out"
    capture(worked_out, PatternSource(), folder)
    return worked_out, folder


def test_labels_may_be_of_the_camera(flown):
    worked_out, folder = flown
    targets = ("attitude", "camera", "height", "image")
    samples = LabelledImages(folder, part="all", targets=targets, img_size=(16, 12, 3))
    assert samples.columns == (
        *(
            "yaw_deg",
            "tilt_deg",
            "roll_deg",
            "camera_easting",
            "camera_northing",
            "agl_m",
            "easting",
            "northing",
        ),
    )
    at = [worked_out.names.index(name) for name in samples.names]
    yaw, tilt, roll, _, _, agl, _, _ = samples.values.T
    for values, pose in zip((yaw, tilt, roll, agl), ("yaw_deg", "tilt_deg", "roll_deg", "agl_m")):
        np.testing.assert_allclose(values, getattr(worked_out.poses, pose)[at], rtol=1e-6, atol=1e-6)
        assert np.ptp(values) > 0.0
    lat, lon = samples.labels.positions(samples.values[:, 3:5].astype(np.float64))
    np.testing.assert_allclose(lat, worked_out.lat_deg[at], atol=FLOAT32_DEG)
    np.testing.assert_allclose(lon, worked_out.lon_deg[at], atol=FLOAT32_DEG)
    np.testing.assert_array_equal(
        samples.values[:, 6:], LabelledImages(folder, part="all", img_size=(16, 12, 3)).values
    )
    assert samples.augment is None
    images, labels = samples.take([0, 1])
    assert (images.shape, labels.shape) == ((2, 12, 16, 3), (2, 8))


def test_labels_that_there_are_not_are_refused(folder, flown):
    for targets in ((), "camera", ("camera", "camera")):
        with pytest.raises(
            InvalidInput, match="must be some of image, camera, height, attitude, classes, instances, and columns"
        ):
            LabelledImages(folder, part="all", targets=targets)
    for target in ("camera", "height", "attitude"):
        with pytest.raises(InvalidInput, match=f"targets {target}: the table of .* does not have it for 0_0_"):
            LabelledImages(folder, part="all", targets=(target,))


def test_the_command_loads_labels_of_the_camera(run, flown):
    folder = str(flown[1])
    said = run("load", folder, "--part", "all", "--img-size", "16", "12", "3", "--targets", "camera", "height").stdout
    assert "camera_easting, camera_northing, agl_m" in said
    assert "labels (8, 3)" in said
    shaded = ("--targets", "attitude", "--contrast", "0.2", "--json")
    told = json.loads(run("load", folder, "--part", "all", "--img-size", "16", "12", "3", *shaded).stdout)
    assert told["columns"] == ["yaw_deg", "tilt_deg", "roll_deg"]


def test_batches_have_the_pixels_and_positions_of_their_rows(folder):
    batches = Batches(folder, 5, part="validation", dtype="uint8")
    images, labels = collected(batches)
    assert [len(one) for one, _ in batches] == [3]
    assert numbers_of(batches.samples) == [2, 10, 18]
    np.testing.assert_array_equal(images, [pixels_of(number) for number in (2, 10, 18)])
    assert labels.dtype == np.float32
    lat, lon = batches.samples.labels.positions(labels.astype(np.float64))
    np.testing.assert_allclose(lat, [35.16, 35.159, 35.157], atol=FLOAT32_DEG)
    np.testing.assert_allclose(lon, [-89.898, -89.896, -89.9], atol=FLOAT32_DEG)
    assert batches.samples.labels.fitted_on == "train"
    scaled, _ = collected(Batches(folder, 5, part="validation"))
    assert scaled.dtype == np.float32
    np.testing.assert_array_equal(np.rint(scaled * 255), images)
    assert scaled.max() <= 1.0


def test_failed_rejected_and_gap_are_never_taken(folder):
    assert numbers_of(LabelledImages(folder)) == [0, 1, 3, 5, 7, 8, 9, 11, 13, 15, 16, 17, 19, 21]
    assert numbers_of(LabelledImages(folder, part="test")) == [4, 12, 20]
    assert numbers_of(LabelledImages(folder, part="all")) == list(range(22))


def test_training_is_shuffled_anew_for_each_epoch_and_nothing_else_is(folder):
    samples = LabelledImages(folder)
    orders = [samples.order(epoch).tolist() for epoch in range(4)]
    assert all(sorted(order) == list(range(14)) for order in orders)
    assert len(set(map(tuple, orders))) == 4
    assert LabelledImages(folder).order(3).tolist() == orders[3]
    assert LabelledImages(folder, seed=1).order().tolist() != orders[0]
    for choice in ({"part": "test"}, {"shuffle": False}):
        assert LabelledImages(folder, **choice).order(2).tolist() == list(range(len(LabelledImages(folder, **choice))))
    assert LabelledImages(folder, part="test", shuffle=True).shuffle


def test_the_order_is_the_same_on_every_machine(folder):
    assert LabelledImages(folder).order(1).tolist() == [12, 8, 10, 9, 11, 13, 2, 1, 4, 5, 0, 3, 7, 6]


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_batches_are_the_same_for_any_number_of_workers(folder, workers):
    alone, together = (Batches(folder, 4, img_size=SIZE, workers=count) for count in (0, workers))
    found = []
    for epoch in (0, 3):
        for batches in (alone, together):
            batches.set_epoch(epoch)
            found.append(collected(batches))
            assert len(batches) == 4
    for first, second in (found[:2], found[2:]):
        for one, other in zip(first, second):
            np.testing.assert_array_equal(one, other)
    assert not np.array_equal(found[0][0], found[2][0])


def test_what_is_done_to_an_image_follows_from_seed_epoch_and_name_alone(folder):
    usual = Augmentation()
    train = LabelledImages(folder, dtype="uint8")
    every = LabelledImages(folder, part="all", dtype="uint8", augment=usual)
    for index, number in enumerate(numbers_of(train)):
        image = train.image(index, 2)
        np.testing.assert_array_equal(image, every.image(number, 2))
        meant = usual.apply(Image.fromarray(pixels_of(number)), train.names[index], 2024, 2)
        np.testing.assert_array_equal(image, np.asarray(meant))
    assert train.augment == usual
    assert LabelledImages(folder, augment=None).augment is None
    assert LabelledImages(folder, part="test").augment is None
    assert not np.array_equal(train.image(0, 2), LabelledImages(folder, seed=1).image(0, 2))


def test_a_place_is_changed_alike_in_all_map_types(tmp_path):
    folder = write_dataset(tmp_path / "OUT", map_types=("satellite", "roadmap"))
    for path in (folder / "satellite").glob("*.png"):
        (folder / "roadmap" / path.name).write_bytes(path.read_bytes())
    ground, road = (LabelledImages(folder, map_type=one).take(range(14), 1) for one in ("satellite", "roadmap"))
    np.testing.assert_array_equal(ground[0], road[0])
    np.testing.assert_array_equal(ground[1], road[1])


#: Pillow's modes that files of an ending can have.
KINDS = {
    "png": ("1", "L", "LA", "P", "RGB", "RGBA"),
    "tif": ("1", "L", "LA", "P", "RGB", "RGBA", "CMYK"),
    "jpg": ("L", "RGB", "CMYK"),
}


@pytest.mark.parametrize(("ending", "mode"), [(ending, mode) for ending in KINDS for mode in KINDS[ending]])
def test_images_of_every_kind_become_grey_or_colour(tmp_path, ending, mode):
    path = tmp_path / f"image.{ending}"
    source = Image.fromarray(pixels_of(3))
    image = source.convert(mode)
    if mode in ("LA", "RGBA"):
        # What is transparent keeps its colour.
        image.putalpha(Image.new("L", image.size, 0))
    image.save(path)
    whole = open_image(path)
    assert (whole.mode, whole.size) == ("L" if mode in ("1", "L", "LA") else "RGB", source.size)
    if ending != "jpg":
        plain = {"LA": "L", "RGBA": "RGB"}.get(mode, mode)
        meant = source.convert(plain).convert(whole.mode)
        np.testing.assert_array_equal(np.asarray(whole), np.asarray(meant))
    for asked, wanted in ((1, "L"), (3, "RGB")):
        sized = open_image(path, (20, 16, asked))
        assert (sized.mode, sized.size) == (wanted, (20, 16))


def test_large_jpegs_are_read_at_a_part_of_their_size_and_look_the_same(tmp_path):
    path = tmp_path / "large.jpg"
    Image.fromarray(pixels_of(2, 480, 640)).save(path, quality=95)
    found = np.asarray(open_image(path, (80, 60, 3)), np.float64)
    with Image.open(path) as image:
        meant = np.asarray(image.resize((80, 60), Image.BILINEAR), np.float64)
    assert np.abs(found - meant).mean() < DRAFT_LEVELS


def test_compressed_tiffs_are_read_by_threads_at_once(tmp_path):
    """Pillow closes such files twice: the second time may be another thread's file, opened in between."""
    path = tmp_path / "image.tif"
    Image.fromarray(pixels_of(1, 120, 160)).save(path, compression="tiff_lzw")
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda _: open_image(path).tobytes(), range(600)))
    assert set(found) == {pixels_of(1, 120, 160).tobytes()}


@pytest.mark.parametrize("fault", ["cut", "text", "empty", "deep", "gone"])
@pytest.mark.parametrize("workers", [0, 2])
def test_images_that_cannot_be_read_are_named_in_one_line(folder, fault, workers):
    batches = Batches(folder, 2, img_size=SIZE, workers=workers, shuffle=False)
    path = batches.samples.path(5)
    if fault == "cut":
        path.write_bytes(path.read_bytes()[:-200])
    elif fault == "deep":
        Image.fromarray(np.zeros((30, 40), np.uint16)).save(path)
    elif fault == "gone":
        path.unlink()
    else:
        path.write_bytes(b"no image" if fault == "text" else b"")
    found = []
    with pytest.raises(InvalidInput, match=f"^image {path}: [^\n]*$"):
        found.extend(batches)
    # What lies before it has come.
    assert len(found) == 2


def test_sizes_that_differ_are_named_and_made_equal_by_img_size(folder):
    samples = LabelledImages(folder, part="all")
    path = samples.path(4)
    Image.fromarray(pixels_of(4, 31, 40)).save(path)
    with pytest.raises(InvalidInput, match=rf"{path}: has 40 x 31 px .* first one has 40 x 30 .* 40 30 3 makes"):
        samples.take(range(6))
    Image.fromarray(pixels_of(4)).convert("L").save(path)
    with pytest.raises(InvalidInput, match="1 channels, where the first one has 40 x 30 and 3"):
        samples.take(range(6))
    assert LabelledImages(folder, part="all", img_size=SIZE).take(range(6))[0].shape == (6, 16, 20, 3)


def test_an_image_is_found_where_cleaning_has_put_it(folder):
    samples = LabelledImages(folder, part="all", dtype="uint8")
    path = samples.path(3)
    (path.parent / "rejected").mkdir()
    path.rename(path.parent / "rejected" / path.name)
    np.testing.assert_array_equal(samples.image(3), pixels_of(3))


def test_labels_are_those_of_the_folder_or_those_given(folder):
    own = LabelledImages(folder).labels
    others = make_labels(np.array([10.0, 11.0]), np.array([20.0, 21.0]), "mercator")
    assert LabelledImages(folder, labels=others).labels is others
    others.save(folder / "labels.json")
    assert LabelledImages(folder).labels == others != own
    np.testing.assert_allclose(
        LabelledImages(folder).values,
        others.transform(*own.positions(LabelledImages(folder, labels=own).values)),
        rtol=1e-6,
    )


def test_threads_are_a_few_batches_ahead_and_end_with_the_loop(folder, monkeypatch):
    begun, before = [], set(threading.enumerate())
    take = LabelledImages.take
    monkeypatch.setattr(LabelledImages, "take", lambda self, *which: begun.append(1) or take(self, *which))
    for count, _ in enumerate(Batches(folder, 1, workers=2), 1):
        assert len(begun) <= count + 2
        if count == 5:
            break
    assert set(threading.enumerate()) <= before
    assert len(begun) < 14


def test_samples_can_be_sent_to_other_processes(folder):
    samples = LabelledImages(folder, img_size=SIZE)
    again = pickle.loads(pickle.dumps(samples))
    for one, other in zip(samples.take([3, 1], 2), again.take([3, 1], 2)):
        np.testing.assert_array_equal(one, other)


def test_a_dataset_that_is_read_already_is_taken_as_it_is(folder):
    dataset = read_dataset(folder)
    assert LabelledImages(dataset, map_type="roadmap").images is dataset.image_set("roadmap")


def test_without_satellite_images_the_first_map_type_is_taken(tmp_path):
    folder = write_dataset(tmp_path / "OUT", map_types=("terrain", "roadmap"))
    assert LabelledImages(folder).images.map_type == "roadmap"


@pytest.mark.parametrize(
    ("choice", "words"),
    [
        ({"part": "training"}, "part 'training': must be one of train, validation, test, all"),
        ({"map_type": "terrain"}, "map type 'terrain': .* has roadmap, satellite"),
        ({"img_size": (0, 5, 3)}, "image size 0 5 3: needs"),
        ({"img_size": (5, 5, 2)}, "image size 5 5 2: needs"),
        ({"img_size": (5, 5)}, "image size 5 5: needs"),
        ({"img_size": 224}, "image size 224: must be"),
        ({"augment": True}, "augment True: must be"),
        ({"shuffle": "yes"}, "shuffle 'yes'"),
        ({"augment": "yes"}, "augment 'yes'"),
        ({"dtype": "float16"}, "dtype 'float16': must be one of float32, uint8"),
        ({"batch_size": 0}, "batch size 0: must be 1 or more"),
        ({"workers": -1}, "workers -1: must be 0 or more"),
    ],
)
def test_choices_are_checked(folder, choice, words):
    with pytest.raises(InvalidInput, match=words):
        Batches(folder, **choice)


def test_a_part_needs_a_split_and_images(tmp_path):
    unsplit = write_dataset(tmp_path / "unsplit", split=False)
    with pytest.raises(InvalidInput, match=r"part 'train': .* is not split; run terrainav split"):
        LabelledImages(unsplit)
    assert len(LabelledImages(unsplit, part="all")) == 22
    with pytest.raises(InvalidInput, match="has no images in the part 'test'"):
        LabelledImages(write_dataset(tmp_path / "few", 4), part="test")


def test_chunks_cover_all_or_all_that_fill_a_batch():
    assert chunks(7, 3) == [slice(0, 3), slice(3, 6), slice(6, 7)]
    assert chunks(7, 3, drop_last=True) == [slice(0, 3), slice(3, 6)]
    with pytest.raises(InvalidInput, match="batch size 8: must be 7 or less"):
        chunks(7, 8, drop_last=True)


def test_packages_that_are_missing_are_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(
        OutputError,
        match=r"^loader: PyTorch is not installed; get it with: pip install 'terrainav\[torch\]'$",
    ):
        optional_module("torch", "PyTorch", "torch")


def test_keras_without_its_backend_is_told_from_no_keras(monkeypatch, tmp_path):
    (tmp_path / "keras.py").write_text("import a_backend_that_is_not_there\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "keras", raising=False)
    with pytest.raises(OutputError, match=r"its backend .*a_backend_that_is_not_there.* set KERAS_BACKEND"):
        optional_module("keras", "Keras", "keras")


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    return command(tmp_path, monkeypatch, capsys)


def test_load_prints_batches_shapes_and_rate(folder, run):
    done = run("load", str(folder), "--img_size", "20", "16", "1", "--batch-size", "4", "--workers", "2")
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0] == "satellite, part train: 14 images of 20 x 16 px and 1 channel, augmented"
    assert lines[1] == "labels in EPSG:32616, scaled by the images of train"
    assert lines[2:4] == [
        "3 batches: images (4, 16, 20, 1) float32, labels (4, 2) float32",
        "1 batch: images (2, 16, 20, 1) float32, labels (2, 2) float32",
    ]
    assert "images per second (numpy" in lines[4]


def test_load_reads_the_environment_and_prints_json(folder, run):
    done = run("load", str(folder), "--part", "all", "--json", TERRAINAV_BATCH_SIZE="11")
    found = json.loads(done.stdout)
    assert found["batches"] == [{"count": 2, "images": [11, 30, 40, 3], "labels": [11, 2]}]
    assert (found["images"], found["augmented"], found["map_type"]) == (22, False, "satellite")
    assert found["images_per_s"] == pytest.approx(22 / found["seconds"])
    asked = run("load", str(folder), "--contrast", "0.1", "--part", "test", "--json")
    assert json.loads(asked.stdout)["augmented"]
    assert not json.loads(run("load", str(folder), "--no-augment", "--json").stdout)["augmented"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--map-type", "terrain"], "map type 'terrain'"),
        (["--batch-size", "some"], "option batch_size 'some': must be a whole number"),
        (["--no-augment", "--contrast", "0.1"], "--no-augment: goes with neither"),
        (["--loader", "keras", "--workers", "2"], "workers 2: must be 0 with keras"),
    ],
)
def test_load_refuses_in_one_line(folder, run, arguments, words):
    done = run("load", str(folder), *arguments)
    assert done.returncode == 2
    assert words in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""


def test_loading_changes_nothing(folder, run):
    def state():
        return {
            path: (path.stat().st_mtime_ns, hashlib.sha256(path.read_bytes()).hexdigest())
            for path in Path(folder).rglob("*")
            if path.is_file()
        }

    before = state()
    assert run("load", str(folder)).returncode == 0
    assert state() == before


def table_edited(folder, old, new):
    path = folder / "satellite" / "meta_data.csv"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_parts_that_there_are_not_are_named(folder):
    table_edited(folder, ",train\n", ",Train\n")
    with pytest.raises(InvalidInput, match=r"has split 'Train' \(0_0_.*\); must be one of train, .* or empty"):
        LabelledImages(folder)
    assert len(LabelledImages(folder, part="all")) == 22


def test_labels_of_another_dataset_are_refused(folder, tmp_path):
    lat, lon = np.array([-33.8, -33.9]), np.array([18.4, 18.7])
    make_labels(lat, lon, "mercator", training=np.array([True, True])).save(folder / "labels.json")
    with pytest.raises(InvalidInput, match=r"labels\.json: is of another dataset or split, as 0_0_.* lies [\d,]+"):
        LabelledImages(folder)
    (folder / "labels.json").unlink()
    own = LabelledImages(folder).labels
    own.save(folder / "labels.json")
    assert LabelledImages(folder).labels == own


def test_positions_that_the_frame_does_not_have_are_named(folder):
    read = read_dataset(folder)
    images = read.image_sets["satellite"]
    lat_deg = images.table.lat_deg.copy()
    lat_deg[0] = -90.0
    pole = replace(images, table=replace(images.table, lat_deg=lat_deg))
    labels = make_labels(lat_deg[1:], images.table.lon_deg[1:], "mercator")
    with pytest.raises(InvalidInput, match=r"0_0_.* cannot be had in EPSG:\d+, first Lat -90"):
        LabelledImages(replace(read, image_sets={"satellite": pole}), labels=labels)


def test_an_image_of_another_size_than_the_table_says_is_named_with_img_size_too(folder):
    path = folder / "satellite" / "meta_data.csv"
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    sized = [head + ",image_width_px,image_height_px", *(row + ",40,30" for row in rows)]
    path.write_text("\n".join(sized) + "\n", encoding="utf-8")
    samples = LabelledImages(folder, img_size=SIZE)
    assert samples.image(2).shape == (16, 20, 3)
    Image.new("RGB", (7, 5)).save(samples.path(2))
    with pytest.raises(InvalidInput, match=r"has 7 x 5 px, and 40 x 30 px in the table"):
        samples.image(2)


def test_sizes_beyond_memory_are_refused(folder, monkeypatch):
    with pytest.raises(InvalidInput, match="image size 1000000 1000000 3: must be 89,478,485 px or less"):
        LabelledImages(folder, img_size=(1_000_000, 1_000_000, 3))

    def none_left(*_):
        raise MemoryError

    samples = LabelledImages(folder, img_size=SIZE)
    monkeypatch.setattr(np, "empty", none_left)
    with pytest.raises(InvalidInput, match="batch of 2 images of 20 x 16 px and 3 channels: does not fit into memory"):
        samples.take([0, 1])


def test_postscript_is_not_run(tmp_path):
    path = tmp_path / "a.jpg"
    path.write_bytes(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 10 10\n%%EndComments\nshowpage\n%%EOF\n")
    for img_size in (None, SIZE):
        with pytest.raises(InvalidInput, match=r"cannot be read \(it is not a JPEG, PNG or TIFF\)"):
            open_image(path, img_size)


def test_a_compressed_tiff_that_is_cut_off_is_told_in_words(tmp_path):
    path = tmp_path / "a.tif"
    Image.fromarray(pixels_of(1)).save(path, compression="tiff_adobe_deflate")
    with Image.open(path) as image:
        (start,), (length,) = image.tag_v2[273], image.tag_v2[279]
    data = bytearray(path.read_bytes())
    data[start : start + length] = bytes(length)
    path.write_bytes(data)
    with pytest.raises(InvalidInput, match=r"cannot be read \(its pixels are damaged or cut off"):
        open_image(path)
