"""Shards on their way into training: the order, the cache that workers share, and how a run goes on in mid-epoch."""

from __future__ import annotations

import gc
import json
import pickle
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from uuid import uuid4

import numpy as np
import pytest
from terrainav.core.dataset.dataset import read_dataset
from terrainav.core.dataset.loading import Batches, LabelledImages, streaming
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.storage import stores
from terrainav.core.storage.files import PARTIAL_ENDING

from tests.support.objects import SECRET, s3_store
from tests.support.shards import write_folders, write_shards
from tests.support.thinning import sampled

CHOICE = {"part": "all", "img_size": (16, 12, 3), "shuffle": True, "shards_at_once": 3, "augment": None}
IMAGES, A_SHARD, SHARDS = 20, 3, 7
#: Python 3.12 warns of a fork beside threads, such as those of torch and of what asks a store.
pytestmark = pytest.mark.filterwarnings("default:This process:DeprecationWarning")


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    return write_folders(tmp_path_factory.mktemp("capture") / "OUT")


@pytest.fixture(scope="module")
def shards(folders, tmp_path_factory):
    return write_shards(tmp_path_factory.mktemp("shards") / "SHARDS", folders, A_SHARD)


@pytest.fixture(scope="module")
def in_s3(folders):
    with pytest.MonkeyPatch.context() as monkeypatch, s3_store(monkeypatch) as address:
        yield str(write_shards(f"{address}/{uuid4().hex}", folders, A_SHARD))


@pytest.fixture
def in_memory(folders, tmp_path):
    return str(write_shards(f"memory://{tmp_path.name}", folders, A_SHARD))


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """Folder of temporary files of its own."""
    (tmp_path / "tmp").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "tmp"))
    return tmp_path / "tmp"


@pytest.fixture
def fetched(monkeypatch):
    """Names of objects of which parts were asked for, and how many bytes each time."""
    asked: list[tuple[str, int]] = []
    get_range = stores.get_range

    def counted(path, start, length):
        asked.append((path.name, length))
        return get_range(path, start, length)

    monkeypatch.setattr(streaming, "get_range", counted)
    return asked


def batches_of(place, epoch=0, workers=0, **choice):
    batches = Batches(place, 4, workers=workers, **{**CHOICE, **choice})
    batches.set_epoch(epoch)
    return list(batches)


def assert_same(found, wanted):
    assert len(found) == len(wanted)
    for (images, labels), (pixels, values) in zip(found, wanted):
        np.testing.assert_array_equal(np.asarray(images), np.asarray(pixels))
        np.testing.assert_array_equal(np.asarray(labels), np.asarray(values))


def torch_dataset(place, **choice):
    pytest.importorskip("torch")
    from terrainav.core.dataset.loading.torch_loader import TorchDataset

    return TorchDataset(place, **{**CHOICE, **choice})


def of_torch(loader):
    return [(images.permute(0, 2, 3, 1).numpy(), labels.numpy()) for images, labels in loader]


# --- the order


@pytest.mark.parametrize("at_once", [1, 2, 3, SHARDS, 100])
def test_each_image_comes_once_and_the_images_of_a_group_together(shards, at_once):
    samples = LabelledImages(shards, **{**CHOICE, "shards_at_once": at_once})
    shard_of = [samples.images.table.shard[row] for row in range(IMAGES)]
    orders = [samples.order(epoch).tolist() for epoch in range(4)]
    for order in orders:
        assert sorted(order) == list(range(IMAGES))
        # Which shards are in each run of as many images as a group has, in the order in which they first come.
        names = list(dict.fromkeys(shard_of[index] for index in order))
        group = {name: at // at_once for at, name in enumerate(names)}
        groups = [group[shard_of[index]] for index in order]
        if at_once < SHARDS:
            assert len(set(groups)) == -(-SHARDS // at_once)
        counts = {one: sum(group[name] == one for name in shard_of) for one in set(groups)}
        assert [one for one in sorted(counts) for _ in range(counts[one])] == groups
    assert len({tuple(order) for order in orders}) == 4
    assert orders[2] == LabelledImages(shards, **{**CHOICE, "shards_at_once": at_once}).order(2).tolist()
    other = LabelledImages(shards, seed=7, **{**CHOICE, "shards_at_once": at_once})
    assert orders[0] != other.order(0).tolist()


def test_images_of_a_group_are_mixed(shards):
    samples = LabelledImages(shards, **CHOICE)
    shard_of = samples.images.table.shard
    runs = sum(shard_of[a] != shard_of[b] for a, b in zip(samples.order(1), samples.order(1)[1:]))
    assert runs > SHARDS


def test_without_shuffling_shards_follow_each_other(folders, tmp_path, temporary, fetched):
    """Whatever the order of the table: blocks of neighbours have rows far apart."""
    place = write_shards(f"memory://{tmp_path.name}", folders, A_SHARD)
    path = place / "satellite" / "meta_data.csv"
    head, *lines = stores.get(path).decode().splitlines()
    mixed = [lines[7 * row % IMAGES] for row in range(IMAGES)]
    stores.put(path, "\n".join([head, *mixed, ""]).encode())
    choice = {**CHOICE, "shuffle": False, "shards_at_once": 1}
    samples = LabelledImages(place, **choice)
    order, table = samples.order(3).tolist(), samples.images.table
    assert sorted(order) == list(range(IMAGES))
    names = [table.shard[index] for index in order]
    assert len([1 for one, two in zip(names, names[1:]) if one != two]) == SHARDS - 1
    rows = [[index for index, name in zip(order, names) if name == one] for one in set(names)]
    assert all(one == sorted(one) for one in rows)
    assert_same(
        list(Batches(place, 2, **choice)),
        [samples.take(order[at : at + 2]) for at in range(0, 20, 2)],
    )
    assert len(fetched) == SHARDS


def test_the_order_of_an_epoch_stays_what_it_was(shards):
    """What has been trained with a seed can be had again by later versions."""
    wanted = [15, 19, 18, 17, 4, 5, 3, 16, 12, 14, 8, 13, 2, 1, 0, 7, 6, 10, 9, 11]
    assert LabelledImages(shards, **CHOICE).order(1).tolist() == wanted


@pytest.mark.parametrize(("name", "value"), [("shards_at_once", 0), ("cache_mb", -1.0), ("cache_mb", float("nan"))])
def test_options_are_checked(shards, name, value):
    with pytest.raises(InvalidInput, match="must be"):
        LabelledImages(shards, **{**CHOICE, name: value})


# --- the same batches, whoever makes them


@pytest.mark.parametrize("workers", sampled([0, 1, 2, 5], 2))
@pytest.mark.parametrize("augment", sampled([None, "auto"], 2))
def test_threads_make_the_same_batches_from_every_place(shards, in_s3, in_memory, workers, augment):
    choice = {"augment": augment, "part": "all"}
    for epoch in (0, 1):
        wanted = batches_of(shards, epoch, **choice)
        for place in (shards, in_s3, in_memory):
            assert_same(batches_of(place, epoch, workers, **choice), wanted)


def test_images_are_those_of_the_folder(folders, shards):
    plain, packed = (LabelledImages(one, **CHOICE) for one in (folders, shards))
    for index in range(IMAGES):
        np.testing.assert_array_equal(packed.image(index), plain.image(index))


@pytest.mark.parametrize(("place", "workers"), sampled([("shards", 1), ("shards", 2), ("in_s3", 0), ("in_s3", 2)], 3))
def test_processes_make_the_same_batches(shards, request, place, workers):
    dataset = torch_dataset(request.getfixturevalue(place))
    loader = dataset.batches(4, workers, **quick_start(place, workers))
    for epoch in (0, 1):
        dataset.set_epoch(epoch)
        assert_same(of_torch(loader), batches_of(shards, epoch))


def quick_start(place, workers):
    """Options by which worker processes start quickly, where that is safe."""
    is_safe = place == "shards" and workers and sys.platform == "linux"
    return {"multiprocessing_context": "fork"} if is_safe else {}


@pytest.mark.thorough
def test_processes_that_are_started_afresh_share_the_cache(in_s3, shards, temporary):
    dataset = torch_dataset(in_s3)
    loader = dataset.batches(4, 1, multiprocessing_context="spawn")
    assert_same(of_torch(loader), batches_of(shards))
    (cache,) = temporary.glob("terrainav-shards-*")
    assert len(list(cache.glob("*.tar"))) == SHARDS


# --- the cache


def test_each_shard_is_fetched_once_an_epoch_whole(in_memory, temporary, fetched):
    batches_of(in_memory, workers=4)
    images = read_dataset(in_memory).image_set("satellite")
    assert sorted(fetched) == sorted(images.shards.items())


def test_what_comes_late_fetches_nothing_that_is_past(in_memory, temporary, fetched, monkeypatch):
    lock_tried, over = streaming.lock_tried, threading.Event()

    @contextmanager
    def late(path):
        if threading.current_thread() is not threading.main_thread():
            over.wait(60.0)
        with lock_tried(path) as held:
            yield held

    monkeypatch.setattr(streaming, "lock_tried", late)
    batches = Batches(in_memory, 4, **{**CHOICE, "shards_at_once": 1})
    list(batches)
    over.set()
    settled(batches.samples)
    assert len(fetched) == SHARDS


def test_a_large_shard_is_fetched_in_parts(in_memory, shards, fetched, monkeypatch):
    monkeypatch.setattr(streaming, "_PART_BYTES", 10_000)
    assert_same(batches_of(in_memory), batches_of(shards))
    assert max(length for _, length in fetched) == 10_000


@pytest.mark.parametrize("kept", [0.0, 0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("workers", [0, 3])
def test_never_more_is_kept_than_there_is_room_for(in_memory, shards, kept, workers, temporary, monkeypatch):
    size = max(read_dataset(in_memory).image_set("satellite").shards.values())
    most, rename = [0], streaming.os.replace

    def watched(origin, target):
        rename(origin, target)
        there = [one for one in target.parent.iterdir() if one.suffix in (".tar", PARTIAL_ENDING)]
        most.append(sum(one.stat().st_size for one in there if one.exists()))

    monkeypatch.setattr(streaming.os, "replace", watched)
    found = batches_of(in_memory, workers=workers, cache_mb=kept * size / 1e6)
    assert_same(found, batches_of(shards))
    assert max(most) <= kept * size
    assert (max(most) > 0) == (kept >= 1.0)


def test_the_least_recently_needed_make_room(in_memory, temporary, fetched):
    """Of three groups one is left over: in a second pass over two of them nothing is fetched again."""
    samples = LabelledImages(in_memory, **{**CHOICE, "shards_at_once": 1}, cache_mb=None)
    order = samples.order(0)
    for start in range(0, IMAGES, 2):
        samples.batch(order[start : start + 2])
        settled(samples)
    (cache,) = temporary.glob("terrainav-shards-*")
    kept = {one.name for one in cache.glob("*.tar")}
    shard_of = samples.images.table.shard
    names = list(dict.fromkeys(shard_of[index] for index in order.tolist()))
    assert kept == set(names[-3:])


def settled(samples):
    """Wait for what is fetched ahead."""
    while samples._cache._fetching:
        time.sleep(0.002)


def test_the_next_group_is_fetched_ahead(in_memory, temporary):
    samples = LabelledImages(in_memory, **CHOICE)
    order, shard_of = samples.order(0), samples.images.table.shard
    samples.batch(order[:1])
    settled(samples)
    names = list(dict.fromkeys(shard_of[index] for index in order.tolist()))
    (cache,) = temporary.glob("terrainav-shards-*")
    assert {one.name for one in cache.glob("*.tar")} == set(names[:6])


def test_single_images_and_random_ones_are_read_by_their_ranges(in_memory, shards, temporary, fetched):
    samples, local = (LabelledImages(one, **{**CHOICE, "shards_at_once": 1}) for one in (in_memory, shards))
    np.testing.assert_array_equal(samples.image(5), local.image(5))
    apart = [int(samples.order(0)[at]) for at in (0, IMAGES - 1)]
    assert_same([samples.batch(apart)], [local.take(apart)])
    assert fetched == []
    (cache,) = temporary.glob("terrainav-shards-*")
    assert list(cache.iterdir()) == []


def test_the_cache_ends_with_the_loader(in_memory, temporary):
    batches = Batches(in_memory, 4, **CHOICE)
    again = pickle.loads(pickle.dumps(batches.samples))
    list(batches)
    (cache,) = temporary.glob("terrainav-shards-*")
    del again
    gc.collect()
    assert cache.exists()
    settled(batches.samples)
    del batches
    gc.collect()
    assert not cache.exists()


def test_local_shards_are_read_where_they_are(shards, temporary):
    batches_of(shards)
    assert list(temporary.iterdir()) == []


def test_a_shard_that_is_removed_under_way_is_read_from_the_store(in_memory, shards, temporary):
    batches, wanted = Batches(in_memory, 4, **CHOICE), batches_of(shards)
    found = []
    for one in batches:
        found.append(one)
        for path in temporary.glob("terrainav-shards-*/*.tar"):
            path.unlink(missing_ok=True)
    assert_same(found, wanted)


def test_what_a_killed_worker_left_is_fetched_anew(in_memory, shards, temporary):
    batches = Batches(in_memory, 4, **CHOICE)
    (cache,) = temporary.glob("terrainav-shards-*")
    for number in range(SHARDS):
        (cache / f"satellite-{number:06d}.tar{PARTIAL_ENDING}").write_bytes(b"half")
        (cache / f"satellite-{number:06d}.tar.lock").touch()
    assert_same(list(batches), batches_of(shards))


def test_a_worker_waits_for_the_one_that_fetches(in_memory, temporary, monkeypatch):
    """Ten at once: each shard comes from the store once."""
    asked, get_range = [], stores.get_range

    def slow(path, start, length):
        asked.append(path.name)
        time.sleep(0.05)
        return get_range(path, start, length)

    monkeypatch.setattr(streaming, "get_range", slow)
    samples = LabelledImages(in_memory, **CHOICE)
    order = samples.order(0)
    threads = [threading.Thread(target=samples.batch, args=(order[:4],)) for _ in range(10)]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    settled(samples)
    assert len(asked) == len(set(asked)) == 6


def test_a_torn_shard_is_named_while_it_is_streamed(in_memory):
    batches, later = (Batches(in_memory, 4, **CHOICE) for _ in range(2))
    path = stores.store_path(in_memory) / "satellite" / "satellite-000002.tar"
    data = stores.get(path)
    stores.put(path, data[:-5000])
    with pytest.raises(InvalidInput, match=f"^shard {path}: is cut short"):
        list(batches)
    stores.put(path, b"\0" * len(data))
    with pytest.raises(InvalidInput, match=rf"^image \S+\.png in {path}: is not where the table says it is"):
        list(Batches(in_memory, 4, **CHOICE))
    stores.remove(path)
    with pytest.raises((InvalidInput, OutputError), match=f"^{path}: is not there"):
        list(later)


def test_a_store_that_refuses_is_one_line(in_s3, monkeypatch):
    batches = Batches(in_s3, 4, **CHOICE)

    async def refused(*_args, **_options):
        raise PermissionError(f"403 {SECRET}")

    monkeypatch.setattr(batches.samples.images.folder.fs, "_call_s3", refused)
    with pytest.raises(OutputError, match="access is refused") as wrong:
        list(batches)
    assert SECRET not in str(wrong.value)
    assert "\n" not in str(wrong.value)


# --- going on in mid-epoch


@pytest.mark.parametrize("taken", [0, 1, 3, 5])
@pytest.mark.parametrize(("before", "after"), [(0, 2), (2, 0), (3, 1)])
def test_batches_go_on_in_mid_epoch_with_other_workers(in_memory, shards, taken, before, after):
    first = Batches(in_memory, 4, workers=before, **CHOICE)
    first.set_epoch(2)
    iterator = iter(first)
    head = list(islice(iterator, taken))
    state = json.loads(json.dumps(first.state_dict()))
    again = Batches(shards, 4, workers=after, **CHOICE)
    again.load_state_dict(state)
    assert again.epoch == 2
    assert again.state_dict() == state
    again.set_epoch(2)
    assert_same([*head, *again], batches_of(shards, 2))
    assert_same(list(again), batches_of(shards, 2))
    again.set_epoch(3)
    assert again.state_dict()["batch"] == 0
    assert_same(list(again), batches_of(shards, 3))


@pytest.mark.parametrize(("before", "after"), sampled([(2, 1), (0, 2)], 2))
def test_the_torch_loader_goes_on_in_mid_epoch(in_s3, shards, before, after):
    def loader_of(place, workers):
        name = "shards" if place is shards else "in_s3"
        return torch_dataset(place).batches(4, workers, **quick_start(name, workers))

    first = loader_of(in_s3, before)
    first.dataset.set_epoch(1)
    head = of_torch(islice(iter(first), 2))
    state = first.state_dict()
    assert (state["epoch"], state["batch"]) == (1, 2)
    again = loader_of(shards, after)
    again.load_state_dict(state)
    assert again.dataset.epoch == 1
    assert_same([*head, *of_torch(again)], batches_of(shards, 1))
    assert_same(of_torch(again), batches_of(shards, 1))
    # The plain iterator takes it over, too.
    plain = Batches(shards, 4, **CHOICE)
    plain.load_state_dict(state)
    assert_same([*head, *plain], batches_of(shards, 1))


def test_a_folder_of_files_goes_on_as_well(folders):
    batches = Batches(folders, 3, **CHOICE)
    list(islice(iter(batches), 4))
    again = Batches(folders, 3, workers=2, **CHOICE)
    again.load_state_dict(batches.state_dict())
    whole = Batches(folders, 3, **CHOICE)
    assert_same(list(again), list(whole)[4:])


def test_a_state_of_another_loader_is_refused(shards, folders):
    state = Batches(shards, 4, **CHOICE).state_dict()
    for other in (
        Batches(shards, 5, **CHOICE),
        Batches(shards, 4, seed=3, **CHOICE),
        Batches(shards, 4, **{**CHOICE, "shards_at_once": 2}),
        Batches(folders, 4, **CHOICE),
    ):
        with pytest.raises(InvalidInput, match=r"^state: belongs to other images, another order or another batch size"):
            other.load_state_dict(state)
    for name, odd in (
        *(("batch", value) for value in (-5, 10**9, 6, 1.0, "1", None, True, float("nan"))),
        *(("epoch", value) for value in (0.5, "1", None, False, [])),
    ):
        with pytest.raises(InvalidInput, match=rf"^state: {name} .* must be a whole number") as refused:
            Batches(shards, 4, **CHOICE).load_state_dict({**state, name: odd})
        assert "\n" not in str(refused.value)
    torch_loader = torch_dataset(shards).batches(4)
    with pytest.raises(InvalidInput, match=r"^state: batch -5 must be a whole number from 0 to 5, the batches"):
        torch_loader.load_state_dict({**state, "batch": -5})
    for odd in ({}, {"epoch": 1}, None):
        with pytest.raises(InvalidInput, match=r"^state .*: must be one that state_dict\(\) returned"):
            Batches(shards, 4, **CHOICE).load_state_dict(odd)


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_webdataset_has_the_same_images(in_s3, shards):
    """An epoch of ours, from S3, against what webdataset unpacks of the files, whatever the order."""
    wds = pytest.importorskip("webdataset")
    samples = LabelledImages(in_s3, **CHOICE)
    paths = sorted(Path(shards, "satellite").glob("*.tar"))
    theirs = {}
    for sample in wds.WebDataset([str(one) for one in paths], shardshuffle=False, empty_check=False):
        theirs[json.loads(sample["json"])["img_name"]] = sample["png"]
    names = samples.images.table.img_names
    assert {names[row]: samples.file(row).read_bytes() for row in samples.order(5).tolist()} == theirs
