"""Datasets in shards and at addresses: read as folders are, the same images by other libraries, faults in one line."""

from __future__ import annotations

import io
import json
import shutil
import tarfile

import numpy as np
import pytest
from terrainav.core.bands import Bands
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.georeference import Georeference
from terrainav.core.capture.metadata import Description
from terrainav.core.capture.runner import capture
from terrainav.core.capture.writers import geotiff
from terrainav.core.dataset.clean import clean, undo
from terrainav.core.dataset.dataset import image_size, open_bands, open_image, open_masked, read_dataset
from terrainav.core.dataset.entropy import image_entropies
from terrainav.core.dataset.ground import are_camera_frames
from terrainav.core.dataset.loading import Batches, LabelledImages
from terrainav.core.dataset.split import split
from terrainav.core.dataset.table import SPLIT, Table
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.imagery.opening import named_source, open_source
from terrainav.core.mission.plan import plan
from terrainav.core.storage import stores

from tests.support.command import command
from tests.support.objects import SECRET, s3_store
from tests.support.shards import MISSION, write_folders, write_shards


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    return write_folders(tmp_path_factory.mktemp("capture") / "OUT")


@pytest.fixture
def shards(folders, tmp_path):
    return write_shards(tmp_path / "SHARDS", folders)


@pytest.fixture(scope="module")
def bucket(folders):
    with pytest.MonkeyPatch.context() as monkeypatch, s3_store(monkeypatch) as address:
        write_shards(f"{address}/shards", folders)
        for path in (one for one in folders.rglob("*") if one.is_file()):
            stores.put(
                stores.store_path(f"{address}/folders/{path.relative_to(folders).as_posix()}"),
                path.read_bytes(),
            )
        yield address


@pytest.fixture(params=["folder", "memory", "s3", "folders in s3"])
def place(request, folders, tmp_path):
    """A dataset at each kind of place: three in shards, one whose images are objects."""
    if request.param == "folder":
        return write_shards(tmp_path / "SHARDS", folders)
    if request.param == "memory":
        return write_shards(f"memory://{tmp_path.name}", folders)
    return request.getfixturevalue("bucket") + ("/shards" if request.param == "s3" else "/folders")


def images_of(dataset):
    (images,) = dataset.image_sets.values()
    return images


def test_images_are_those_of_the_folder_wherever_they_are(folders, place):
    wanted, found = images_of(read_dataset(folders)), images_of(read_dataset(place))
    assert found.table.img_names == wanted.table.img_names
    for row in range(len(wanted)):
        assert found.file(row).read_bytes() == wanted.path(row).read_bytes()
        np.testing.assert_array_equal(found.pixels(row), wanted.pixels(row))
    image = found.file(3)
    assert image_size(image) == image_size(wanted.path(3))
    assert open_bands(image) is None
    np.testing.assert_array_equal(open_masked(image)[0], open_masked(wanted.path(3))[0])
    assert not are_camera_frames(found, np.arange(2), read_dataset(place).folder)


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_webdataset_reads_the_same_images_and_rows(shards):
    wds = pytest.importorskip("webdataset")
    images = images_of(read_dataset(shards))
    index = json.loads((shards / "satellite" / "shards.json").read_text())["shardlist"]
    urls = [str(shards / "satellite" / one["url"]) for one in index]
    assert {one["url"]: one["filesize"] for one in index} == dict(images.shards)
    samples = list(wds.WebDataset(urls, shardshuffle=False, empty_check=False))
    assert len(samples) == len(images)
    for row, sample in enumerate(samples):
        assert sample["__key__"] == f"{row:09d}"
        assert sample["png"] == images.file(row).read_bytes()
        told = json.loads(sample["json"])
        assert (told["img_name"], told["lat_deg"]) == (
            images.table.img_names[row],
            images.table.lat_deg[row],
        )


def test_bands_and_places_on_the_map_are_read_from_shards(tmp_path):
    folder = write_folders(tmp_path / "tif", MISSION.replace(image_format="tif"))
    bands = Bands(("red", "near"), "uint16", (0,))
    place = Georeference(500_000.0, 5_000_000.0, 500_010.0, 5_000_010.0, 41, 31, "EPSG:32616")
    about = Description("n", "satellite", "a source", "somebody", 5, 45.0, -87.0, 100.0)
    values = np.arange(31 * 41 * 2, dtype=np.uint16).reshape(31, 41, 2)
    packed = geotiff(values, place, about, bands, ((0.0, 9.0),) * 2)
    (folder / "satellite" / read_dataset(folder).image_set("satellite").table.img_names[0]).write_bytes(packed)
    found = images_of(read_dataset(write_shards(tmp_path / "SHARDS", folder)))
    np.testing.assert_array_equal(found.pixels(0), values)
    assert open_bands(found.file(0)).bands == bands
    assert image_size(found.file(0)) == (41, 31)
    for row in (0, 1):
        assert not are_camera_frames(found, np.array([row]), folder)


def test_a_split_is_the_folders(folders, place, tmp_path):
    """By blocks, which needs to know what the images are of: none of them lies beside the table."""
    copy = shutil.copytree(folders, tmp_path / "copy")
    wanted, made = (split(one, how="blocks", block_m=400.0) for one in (copy, place))
    assert made.images == wanted.images
    assert images_of(read_dataset(place)).table.other[SPLIT] == images_of(read_dataset(copy)).table.other[SPLIT]


def test_what_needs_files_says_so_in_one_line(place):
    images = images_of(read_dataset(place))
    needs_files = r"/satellite: its images are in shards or in an object store, and here have to be files"
    works = (
        lambda: clean(place),
        lambda: undo(place),
        lambda: image_entropies(place),
        lambda: images.path(0),
        lambda: images.image_folder,
    )
    for work in works:
        with pytest.raises(InvalidInput, match=needs_files):
            work()
    if stores.is_address(place):
        with pytest.raises(InvalidInput, match=r"^layout VBN: .* is in an object store; must be a folder"):
            read_dataset(place, "VBN")


def test_a_shard_that_is_gone_or_cut_short_is_named(shards):
    path = shards / "satellite" / "satellite-000001.tar"
    data = path.read_bytes()
    path.write_bytes(data[:20_000])
    with pytest.raises(InvalidInput, match=f"^shard {path}: is cut short, as it has 20,000 bytes of"):
        read_dataset(shards)
    path.unlink()
    with pytest.raises(InvalidInput, match=r"satellite: the shard satellite-000001\.tar of the table is not there"):
        read_dataset(shards)
    path.write_bytes(data)
    read = read_dataset(shards)
    path.unlink()
    with pytest.raises(InvalidInput, match=f"^shard {path}: is not there"):
        images_of(read).pixels(6)


@pytest.mark.parametrize(
    "spoiled",
    [
        lambda data, at: data[: at - 512] + b"\0" * (len(data) - at + 512),
        lambda data, at: b"x" * 512 + data[:-512],
        lambda data, at: data[: at - 512] + data[at - 400 :],
        lambda data, at: data[: at - 500] + b"y" + data[at - 499 :],
    ],
    ids=["zeros", "moved", "shorter", "another name"],
)
def test_other_bytes_at_an_offset_are_named(shards, spoiled):
    read = images_of(read_dataset(shards))
    image = read.file(7)
    image.place.write_bytes(spoiled(image.place.read_bytes(), image.range.offset_bytes))
    with pytest.raises(InvalidInput, match=f"^image {read.table.img_names[7]} in {image.place}: is not where"):
        open_image(image)


def test_a_shard_of_another_image_is_named(shards):
    """Sizes tell, and endings."""
    read = images_of(read_dataset(shards))
    image = read.file(7)
    with tarfile.open(image.place, "w", format=tarfile.USTAR_FORMAT) as tar:
        for row in (0, 1, 2, 3, 4):
            member = tarfile.TarInfo(f"{row:09d}.jpg")
            member.size = 9000
            tar.addfile(member, io.BytesIO(b"\0" * 9000))
    with pytest.raises(InvalidInput, match="is damaged or a different one"):
        read.pixels(7)


def test_an_image_that_is_none_is_named(shards):
    read = images_of(read_dataset(shards))
    image = read.file(7)
    data, at = bytearray(image.place.read_bytes()), image.range.offset_bytes
    data[at : at + 1000] = b"\0" * 1000
    image.place.write_bytes(bytes(data))
    with pytest.raises(InvalidInput, match=f"^image {read.table.img_names[7]} in .*: cannot be read"):
        read.pixels(7)


@pytest.mark.parametrize(
    ("column", "value"),
    [("offset_bytes", "0"), ("size_bytes", ""), ("size_bytes", "0.5"), ("shard", "../x.tar")],
)
def test_rows_have_to_say_where_their_images_are(shards, column, value):
    path = shards / "satellite" / "meta_data.csv"
    lines = path.read_text().splitlines()
    cells = lines[3].split(",")
    # From the end, as credits have commas.
    cells[lines[0].split(",").index(column) - lines[0].count(",") - 1] = value
    path.write_text("\n".join([*lines[:3], ",".join(cells), *lines[4:]]) + "\n")
    with pytest.raises(InvalidInput, match=f"the table does not say where in a shard {cells[0]} is"):
        read_dataset(shards)


def test_a_failed_image_is_in_no_shard(shards):
    path = shards / "satellite" / "meta_data.csv"
    table = Table.load(path)
    last = len(table) - 1
    cells = path.read_text().splitlines()
    failed = cells[-1].replace(",done,,", ",failed,no tile,").rsplit(",", 3)[0] + ",,,"
    path.write_text("\n".join([*cells[:-1], failed]) + "\n")
    images = images_of(read_dataset(shards))
    assert not images.made[last]
    assert images.made[:last].all()


def test_objects_that_are_gone_are_named(bucket):
    place = stores.store_path(f"{bucket}/folders")
    images = images_of(read_dataset(place))
    object_, data = images.file(2).place, images.file(2).read_bytes()
    stores.remove(object_)
    try:
        with pytest.raises(InvalidInput, match=f"^image {object_}: is not there"):
            open_image(images.file(2))
        with pytest.raises(InvalidInput, match=f"satellite: {object_.name} of the table is not there"):
            read_dataset(place)
    finally:
        stores.put(object_, data)


@pytest.mark.parametrize("place", ["", "/none"])
def test_a_place_without_a_dataset_is_one_line(bucket, place):
    with pytest.raises((InvalidInput, OutputError), match=r"is not a dataset|is not there"):
        read_dataset(bucket + place)
    with pytest.raises(OutputError, match=r"^s3://nobody/x: is not there, or s3://nobody is not"):
        read_dataset("s3://nobody/x")


def test_one_map_type_alone_is_refused_as_in_a_folder(bucket):
    with pytest.raises(InvalidInput, match=f"^folder {bucket}/shards/satellite: is one map type of"):
        read_dataset(f"{bucket}/shards/satellite")


def test_without_credentials_one_line_says_so(bucket, monkeypatch, tmp_path, capsys):
    import s3fs

    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.delenv(name)
    monkeypatch.setenv("AWS_SHARED_CREDENTIALS_FILE", str(tmp_path / "none"))
    s3fs.S3FileSystem.clear_instance_cache()
    run = command(tmp_path, monkeypatch, capsys)
    done = run("load", f"{bucket}/shards", "--part", "all", "--img-size", "8", "8", "3")
    s3fs.S3FileSystem.clear_instance_cache()
    assert done.returncode != 0
    assert "credentials" in done.stderr
    assert done.stderr.count("\n") == 1
    assert SECRET not in done.stderr


def test_the_command_loads_from_an_address(bucket, tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    done = run("load", f"{bucket}/shards", "--part", "all", "--img-size", "8", "8", "3", "--batch-size", "5")
    assert "4 batches: images (5, 8, 8, 3) float32" in done.stdout


@pytest.mark.parametrize("layout", ["webdataset", "folders"])
def test_what_a_capture_in_blocks_leaves_in_a_store_is_read(folders, tmp_path, layout):
    place, source = f"memory://{tmp_path.name}", named_source("world")
    assert not capture(plan(MISSION, open_source("world").grid), source, place, blocks=Blocks(6, layout)).failed
    wanted, found = (images_of(read_dataset(one)) for one in (folders, place))
    assert bool(found.shards) == (layout == "webdataset")
    for row, name in enumerate(found.table.img_names):
        assert found.file(row).read_bytes() == (wanted.image_folder / name).read_bytes()
    assert not are_camera_frames(found, np.arange(2), read_dataset(place).folder)
    split(place)
    labels = LabelledImages(place, part="train").labels
    assert labels.fitted_on == "train"
    assert sum(len(one) for _, one in Batches(place, 4, part="all", img_size=(8, 8, 3))) == len(wanted)
