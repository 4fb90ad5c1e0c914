"""Runs in blocks: the same bytes by whatever engine, however often they are interrupted."""

from __future__ import annotations

import itertools
import json
import multiprocessing
import pickle
import shutil
import tarfile
import threading
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import closing
from fractions import Fraction
from pathlib import Path
from uuid import uuid4

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from terrainav.core.capture import holding
from terrainav.core.capture.blocks import running
from terrainav.core.capture.blocks.block import WrongWorker, make_packed
from terrainav.core.capture.blocks.engines import Engine
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.choices import BLOCKS_FOLDER
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput, OutputError, PartError, SourceError
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.opening import SourceOptions, named_source
from terrainav.core.imagery.policy import Policy
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.storage.stores import get, store_path

from tests.support.sources import NamedPattern, PatternSource
from tests.support.thinning import examples, sampled

BOX = Box(35.16, -89.90, 35.1565, -89.894)
MISSION = Mission(BOX, 120.0, map_types=("satellite", "roadmap"), zoom=18)
PATTERN = NamedPattern()
PLAN = plan(MISSION, PATTERN.grid)
SMALL = Box(35.1425, -89.866, 35.1405, -89.8625)
OF_THE_WORLD = {
    "map": Mission(SMALL, 120.0, max_px=200),
    "photos": Mission(SMALL, 120.0, image_format="jpg", max_px=200, start="2024-05-01T10:00:00Z"),
    "turned": Mission(SMALL, 120.0, yaw_deg=33.0, tilt_deg=50.0, max_px=160, image_format="png"),
    "relief": Mission(
        Points(tuple((35.141 + 2e-4 * n, -89.865, 60.0) for n in range(4))),
        60.0,
        elevation=("world",),
        tilt_deg=20.0,
        max_px=96,
        products=("depth", "facades"),
    ),
    "wind": Mission(SMALL, 120.0, max_px=160, wind=Wind(8.0, 250.0, 0.2)),
    "times": Mission(Points(tuple((35.141 + 1e-4 * n, -89.865, 120.0) for n in range(7))), 120.0, max_px=160),
}


def contents(folder: Path, but: tuple[str, ...] = ()) -> dict[str, bytes]:
    """Files of a folder by relative path."""
    return {
        name: path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not (name := path.relative_to(folder).as_posix()).startswith(but)
    }


def captured(folder, blocks=Blocks(8), worked_out=PLAN, source=PATTERN, **how):  # noqa: B008
    return capture(worked_out, source, folder, blocks=blocks, **how)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A capture of this process, without blocks."""
    folder = tmp_path_factory.mktemp("plain") / "out"
    capture(PLAN, PatternSource(), folder)
    return contents(folder, but=("journal.jsonl",))


@pytest.fixture(scope="module")
def sharded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shards") / "out"
    captured(folder, Blocks(8, "webdataset"))
    return folder


def test_blocks_leave_what_a_run_without_leaves(whole, tmp_path):
    result = captured(tmp_path / "out")
    assert (result.total, result.written, result.failed) == (2 * len(PLAN), 2 * len(PLAN), ())
    assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole


@pytest.mark.parametrize("name", sampled(OF_THE_WORLD, 3))
def test_a_block_that_was_packed_makes_the_images_of_the_whole_plan(name, tmp_path):
    mission, source = OF_THE_WORLD[name], named_source("world")
    worked_out = plan(mission, source.grid, mission_heights(mission))
    assert len(worked_out) > 3
    with closing(source.open()) as opened:
        capture(worked_out, opened, tmp_path / "whole")
    with ThreadPoolExecutor(2) as threads:
        # As other processes would have them, but without the time it takes to start some.
        engine = Engine(threads, lambda: 2)
        capture(worked_out, source, tmp_path / "blocks", executor=engine, blocks=Blocks(3))
    without = ("journal.jsonl", "blocks/")
    assert contents(tmp_path / "blocks", without) == contents(tmp_path / "whole", without)


def test_any_executor_of_processes_runs_blocks(whole, tmp_path):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as processes:
        result = captured(tmp_path / "out", executor=processes)
    assert result.written == 2 * len(PLAN)
    assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole


def test_shards_hold_images_and_their_rows(whole, sharded):
    table = Table.load(sharded / "satellite" / "meta_data.csv")
    index = json.loads((sharded / "satellite" / "shards.json").read_bytes())
    assert sum(one["nsamples"] for one in index["shardlist"]) == len(PLAN)
    files = {path.name: path.stat().st_size for path in (sharded / "satellite").glob("*.tar")}
    assert {one["url"]: one["filesize"] for one in index["shardlist"]} == files
    for row, name in enumerate(table.img_names):
        data = (sharded / "satellite" / table.shard[row]).read_bytes()
        begin = int(table.offset_bytes[row])
        assert data[begin : begin + int(table.size_bytes[row])] == whole[f"satellite/{name}"]
    with tarfile.open(sharded / "satellite" / "satellite-000001.tar") as tar:
        members = tar.getmembers()
        first = json.loads(tar.extractfile(members[1]).read())
        keys = [one.name.partition(".")[0] for one in members]
        assert keys == sorted(keys)
    at = int(keys[0])
    assert first["img_names"] == f"{PLAN.names[at]}.tif"
    assert first["pose_lat_deg"] == pytest.approx(PLAN.lat_deg[at], abs=1e-12)
    assert all((one.mtime, one.uid, one.gid) == (0, 0, 0) for one in members)


class Dying(Executor):
    """An executor of threads that lets blocks die as a worker's death would, when it is told to."""

    def __init__(self, dies):
        self._dies, self._threads, self._count = dies, ThreadPoolExecutor(2), 0

    def submit(self, fn, /, *arguments, **more):
        self._count += 1
        if self._dies(self._count):
            future: Future = Future()
            future.set_exception(KilledWorker("killed"))
            return future
        return self._threads.submit(fn, *arguments, **more)


class KilledWorker(Exception):
    """What Dask raises where a worker has died."""


def test_a_block_whose_worker_died_is_begun_again(whole, tmp_path):
    notices = []
    engine = Engine(Dying(lambda count: count % 3 == 1), lambda: 2)
    result = captured(
        tmp_path / "out", executor=engine, listener=Listener(notice=lambda text: notices.append(str(text)))
    )
    assert result.failed == ()
    assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole
    assert notices[0] == "block satellite-000000: its worker died: it is begun again"


def test_a_block_that_kills_its_workers_is_given_up_and_the_others_go_on(whole, tmp_path):
    notices = []
    engine = Engine(Dying(lambda count: count <= running.TRIES), lambda: 1)
    result = captured(
        tmp_path / "out", executor=engine, listener=Listener(notice=lambda text: notices.append(str(text)))
    )
    lost = [f"{one.map_type}/{one.name}.tif" for one in result.failed]
    assert result.failed[0].reason == "its worker died"
    assert 0 < len(lost) <= 8
    assert notices[-1] == f"block satellite-000000: its worker died, {running.TRIES} times: given up"
    made = contents(tmp_path / "out", but=("journal.jsonl", "blocks/"))
    assert {name: data for name, data in whole.items() if name not in {*lost, "satellite/meta_data.csv"}} == {
        name: data for name, data in made.items() if name != "satellite/meta_data.csv"
    }
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert table.status.count("failed") == len(lost)
    again = captured(tmp_path / "out", only_failed=True)
    assert again.written == len(lost)
    assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole


def test_a_run_whose_workers_all_die_ends_and_can_go_on(whole, tmp_path):
    engine = Engine(Dying(lambda count: count > 2), lambda: 1)
    with pytest.raises(
        OutputError, match=r"^workers: \d blocks in a row could not be made \(its worker died\); resume"
    ):
        captured(tmp_path / "out", Blocks(2), executor=engine)
    captured(tmp_path / "out", Blocks(2), resume=True)
    assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole


def test_what_an_engine_wraps_is_told_as_it_was_raised(tmp_path):
    class TaskError(Exception):
        """What Ray raises of what was raised in a task."""

        cause = SourceError("the provider has shut down")

    class Wrapping(ThreadPoolExecutor):
        def submit(self, fn, /, *arguments):
            future: Future = Future()
            future.set_exception(TaskError("ray::call() (pid=1)\nTraceback"))
            return future

    with (
        Wrapping(1) as threads,
        pytest.raises(SourceError, match=r"^the provider has shut down$"),
    ):
        captured(tmp_path / "out", executor=Engine(threads, lambda: 1))


@pytest.mark.parametrize("blocks", [Blocks(4), Blocks(8, "webdataset")])
def test_a_run_that_was_stopped_goes_on_to_the_same_bytes(sharded, whole, tmp_path, blocks):
    done = []
    result = captured(
        tmp_path / "out",
        blocks,
        source=NamedPattern(wait_s=0.05),
        connections=1,
        # When a block is done, and another under way.
        listener=Listener(
            cancelled=lambda: any(one > 8 for one in done),
            progress=lambda progress: done.append(progress.done),
        ),
    )
    assert result.cancelled
    assert 0 < result.written < 2 * len(PLAN)
    again = captured(tmp_path / "out", blocks, resume=True)
    assert again.skipped + again.written == 2 * len(PLAN)
    assert again.skipped >= result.written
    if blocks.layout == "webdataset":
        assert contents(tmp_path / "out") == contents(sharded)
    else:
        assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole


@pytest.mark.parametrize("place", sampled(["tar cut", "tar gone", "record cut", "record of another"], 2))
def test_what_is_torn_is_made_again(sharded, tmp_path, place):
    captured(tmp_path / "out", Blocks(8, "webdataset"))
    shard = tmp_path / "out" / "satellite" / "satellite-000001.tar"
    record = tmp_path / "out" / BLOCKS_FOLDER / "satellite-000001.jsonl"
    if place == "tar cut":
        shard.write_bytes(shard.read_bytes()[:-100])
    elif place == "tar gone":
        shard.unlink()
    elif place == "record cut":
        record.write_bytes(record.read_bytes()[:-10])
    else:
        record.write_bytes(b"{}\n")
    result = captured(tmp_path / "out", Blocks(8, "webdataset"), resume=True)
    assert 0 < result.written <= 8
    assert contents(tmp_path / "out") == contents(sharded)


def without_the_last(head, lines):
    head["images"] -= 1
    lines.pop()


def with_another(head, lines):
    lines[-1]["name"] = "nobody"


def with_one_twice(head, lines):
    lines[-1] = dict(lines[0])


def of_another_map_type(head, lines):
    lines[-1]["map_type"] = "roadmap"


def of_another_shard(head, lines):
    lines[-1]["shard"] = "satellite-000000.tar"


def beyond_the_shard(head, lines):
    lines[-1]["offset_bytes"] = head["shard_bytes"]


def over_each_other(head, lines):
    lines[-1]["offset_bytes"] = lines[0]["offset_bytes"]


def before_the_shard(head, lines):
    lines[-1]["offset_bytes"] = -512


def with_a_share_of_two(head, lines):
    lines[-1]["sky_share"] = 2.0


def without_bound(head, lines):
    head["shard_bytes"] = float("inf")


def with_a_torn_note(head, lines):
    head["noted"] = "00"


EVERYWHERE = [without_the_last, with_another, with_one_twice, of_another_map_type, of_another_shard]
EVERYWHERE += [with_a_share_of_two, without_bound, with_a_torn_note]
IN_SHARDS = [beyond_the_shard, over_each_other, before_the_shard]


@pytest.mark.parametrize(
    ("layout", "change"),
    sampled([("folders", one) for one in EVERYWHERE] + [("webdataset", one) for one in EVERYWHERE + IN_SHARDS], 4),
)
def test_a_record_that_is_not_of_its_block_is_not_believed(whole, sharded, tmp_path, layout, change):
    """A block whose record says less, or other than it made, is made again: no row is lost."""
    shutil.copytree(sharded, tmp_path / "out") if layout == "webdataset" else captured(tmp_path / "out")
    record = tmp_path / "out" / BLOCKS_FOLDER / "satellite-000001.jsonl"
    head, *lines = map(json.loads, record.read_text().splitlines())
    change(head, lines)
    record.write_text("".join(json.dumps(one) + "\n" for one in (head, *lines)))
    result = captured(tmp_path / "out", Blocks(8, layout), resume=True)
    assert result.written == len(lines) + (change is without_the_last)
    if layout == "webdataset":
        assert contents(tmp_path / "out") == contents(sharded)
    else:
        assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert len(table.img_names) == len(PLAN)


@pytest.mark.parametrize("text", sampled(["", "{", "[1]", "3", '{"images": 8}\x00', "\xff"], 3))
def test_a_division_that_cannot_be_read_is_one_line(tmp_path, text):
    captured(tmp_path / "out")
    (tmp_path / "out" / BLOCKS_FOLDER / "blocks.json").write_bytes(text.encode("latin-1"))
    with pytest.raises(OutputError, match=r"out: its .*blocks\.json cannot be read \(.*choose another folder$"):
        captured(tmp_path / "out", resume=True)


class Broken(PatternSource):
    """A source that has no part to the east of a line."""

    def fetch(self, map_type, part):
        if part.left_px > float(np.median(PLAN.windows.left_px)):
            raise PartError("no imagery here")
        return super().fetch(map_type, part)


def test_images_that_fail_are_named_and_made_when_they_can_be(whole, tmp_path):
    result = captured(tmp_path / "out", source=NamedPattern(opens=Broken))
    assert 0 < len(result.failed) < 2 * len(PLAN)
    assert {one.reason for one in result.failed} == {"no imagery here"}
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert table.status.count("failed") == sum(one.map_type == "satellite" for one in result.failed)
    again = captured(tmp_path / "out", only_failed=True)
    assert again.failed == ()
    assert contents(tmp_path / "out", but=("journal.jsonl", "blocks/")) == whole


class Refusing(PatternSource):
    """A source that serves nothing any more."""

    def fetch(self, map_type, part):
        raise SourceError("Pattern refuses: 403 Forbidden")


def test_a_source_that_refuses_stops_the_run(tmp_path):
    with pytest.raises(SourceError, match=r"^Pattern refuses: 403 Forbidden$"):
        captured(tmp_path / "out", source=NamedPattern(opens=Refusing))


def test_two_runs_in_one_folder_are_refused(tmp_path):
    begun, go_on = threading.Event(), threading.Event()

    def cancelled():
        begun.set()
        go_on.wait(30.0)
        return False

    first = threading.Thread(target=lambda: captured(tmp_path / "out", listener=Listener(cancelled=cancelled)))
    first.start()
    try:
        assert begun.wait(30.0)
        with pytest.raises(OutputError, match="another run is at work in it"):
            captured(tmp_path / "out", resume=True)
    finally:
        go_on.set()
        first.join()


def test_runs_with_and_without_blocks_do_not_mix(tmp_path):
    captured(tmp_path / "blocks")
    with pytest.raises(OutputError, match="was captured in blocks; choose another folder"):
        capture(PLAN, PatternSource(), tmp_path / "blocks", resume=True)
    capture(PLAN, PatternSource(), tmp_path / "plain")
    with pytest.raises(OutputError, match="was captured without blocks; choose another folder"):
        captured(tmp_path / "plain", resume=True)


@pytest.mark.parametrize("blocks", [Blocks(9), Blocks(8, "webdataset")])
def test_a_run_goes_on_as_it_was_begun(tmp_path, blocks):
    captured(tmp_path / "out")
    with pytest.raises(OutputError, match="was begun with the layout folders and blocks of 8 images"):
        captured(tmp_path / "out", blocks, resume=True)


def test_a_worker_of_another_version_is_refused(tmp_path):
    packed = pickle.dumps("not looked at")
    with pytest.raises(WrongWorker, match=r"^worker on .*: has TerrAInav .*, and the run has 0.0.1: both"):
        make_packed(packed, "0.0.1", "3.11.2")
    with pytest.raises(WrongWorker, match=r"has Python 3\.\d+, and the run has 2\.7: both"):
        make_packed(packed, running.version(), "2.7.18")


def test_a_source_that_is_open_cannot_be_handed_to_workers(tmp_path):
    with pytest.raises(InvalidInput, match="needs a source by its name"):
        captured(tmp_path / "out", source=PatternSource())


# --- object stores


@pytest.fixture
def address():
    return f"memory://{uuid4().hex}/run"


def test_an_address_holds_what_a_folder_holds(whole, address):
    result = capture(PLAN, PATTERN, address)
    assert result.written == 2 * len(PLAN)
    for name, data in whole.items():
        assert get(store_path(f"{address}/{name}")) == data, name


def test_an_address_of_another_mission_or_of_others_is_refused(address):
    capture(PLAN, PATTERN, address)
    with pytest.raises(OutputError, match=r"already holds this mission; resume it \(--resume\)"):
        capture(PLAN, PATTERN, address)
    other = plan(MISSION.replace(agl_m=121.0), PATTERN.grid)
    with pytest.raises(OutputError, match="holds another mission; choose another folder"):
        capture(other, PATTERN, address)
    store_path(f"{address}2/holiday.jpg").write_bytes(b"")
    with pytest.raises(OutputError, match=r"holds holiday\.jpg but no mission\.json"):
        capture(PLAN, PATTERN, f"{address}2")


@pytest.fixture
def brief(monkeypatch):
    monkeypatch.setattr(holding, "BEAT_S", 0.1)
    monkeypatch.setattr(holding, "DEAD_S", 1.0)


@pytest.mark.usefixtures("brief")
def test_two_runs_at_one_address_are_refused(address):
    begun, go_on = threading.Event(), threading.Event()

    def cancelled():
        begun.set()
        go_on.wait(30.0)
        return False

    first = threading.Thread(target=lambda: capture(PLAN, PATTERN, address, listener=Listener(cancelled=cancelled)))
    first.start()
    try:
        assert begun.wait(30.0)
        with pytest.raises(OutputError, match="another run is at work there; wait until it has ended"):
            capture(PLAN, PATTERN, address, resume=True)
    finally:
        go_on.set()
        first.join()
    assert get(store_path(f"{address}/run.lock")) is None


@pytest.mark.usefixtures("brief")
def test_a_run_that_died_leaves_its_place_to_the_next(whole, address):
    asked = iter(range(10**9))
    capture(PLAN, PATTERN, address, blocks=Blocks(8), listener=Listener(cancelled=lambda: next(asked) > 3))
    store_path(f"{address}/run.lock").write_bytes(b'{"run": "of a machine that is no more", "beat": 7}')
    result = capture(PLAN, PATTERN, address, blocks=Blocks(8), resume=True)
    assert result.written + result.skipped == 2 * len(PLAN)
    assert all(get(store_path(f"{address}/{name}")) == data for name, data in whole.items())
    assert get(store_path(f"{address}/run.lock")) is None


@pytest.mark.usefixtures("brief")
def test_a_run_whose_place_was_taken_ends(address):
    lock = store_path(f"{address}/run.lock")
    taken = threading.Event()

    def progress(_):
        if not taken.is_set():
            lock.write_bytes(b'{"run": "another", "beat": 0}')
            taken.set()

    slow = NamedPattern(wait_s=0.2)
    with pytest.raises(OutputError, match="another run has taken over"):
        capture(PLAN, slow, address, blocks=Blocks(1), connections=1, listener=Listener(progress=progress))
    assert json.loads(get(lock))["run"] == "another"


# --- a provider's limits


@given(
    st.floats(1.0, 60.0),
    st.lists(st.tuples(st.integers(1, 12), st.floats(0.0, 5.0)), min_size=5, max_size=40),
    st.integers(0, 2**32 - 1),
)
@settings(max_examples=examples(60), deadline=None)
def test_no_second_has_more_requests_than_the_provider_allows(rate, blocks, seed):
    # Blocks of workers that come and go, each with the share of its time, on the way with up to 40 ms of delay.
    policy, rng = Policy(requests_per_s=rate), np.random.default_rng(seed)
    under_way, now_s, sent = [], 0.0, []
    for wanted, lasts_s in blocks:
        sharers = min(wanted, policy.most_sharers)
        share = Fraction(1, sharers)
        while sum(one for _, one in under_way) + share > 1:
            under_way.sort()
            now_s = max(now_s, under_way.pop(0)[0])
        own = policy.shared(sharers)
        times = now_s + own.rest_s + np.arange(0.0, lasts_s, 1.0 / own.requests_per_s)
        sent.append(times + rng.uniform(0.0, 0.04, len(times)))
        # It may die at any moment after its last request.
        under_way.append((float(times[-1]) if len(times) else now_s, share))
    arrived = np.sort(np.concatenate(sent))
    in_a_second = np.searchsorted(arrived, arrived + 1.0, side="left") - np.arange(len(arrived))
    assert in_a_second.max(initial=0) <= rate


@pytest.mark.parametrize(("limits", "most"), [({"requests_per_s": 2.5}, 2), ({"max_connections": 3}, 3), ({}, 5)])
def test_no_more_blocks_are_under_way_than_there_are_shares(limits, most, tmp_path):
    at_once, counts = [], []

    class Counting(ThreadPoolExecutor):
        def submit(self, fn, /, *arguments):
            future = super().submit(fn, *arguments)
            at_once.append(future)
            counts.append(sum(not one.done() for one in at_once))
            return future

    with Counting(5) as threads:
        source = NamedPattern(policy=Policy(**limits), wait_s=0.02)
        captured(tmp_path / "out", Blocks(2), source=source, executor=threads)
    assert max(counts) <= most


def test_workers_that_come_do_not_wait_where_the_provider_has_no_limits(tmp_path):
    asked, together = itertools.count(), threading.Barrier(4)

    class Together(ThreadPoolExecutor):
        def submit(self, fn, /, *arguments):
            def made():
                # The one that was begun when there was one worker alone, too.
                if next(begun) < 4:
                    together.wait(60.0)
                return fn(*arguments)

            return super().submit(made)

    begun = itertools.count()
    with Together(4) as threads:
        engine = Engine(threads, lambda: 4 if next(asked) else 1, in_process=True)
        assert not captured(tmp_path / "out", executor=engine).failed


def test_a_run_without_workers_waits_for_them_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(running, "_PATIENCE_S", 0.2)
    notices = []
    with ThreadPoolExecutor(1) as threads:
        engine = Engine(threads, lambda: len(notices), in_process=True)
        result = captured(
            tmp_path / "out",
            executor=engine,
            listener=Listener(notice=lambda text: notices.append(str(text))),
        )
    assert result.written == 2 * len(PLAN)
    assert notices == ["workers: none is there: waiting for one", "workers: 1 there: going on"]


def test_a_run_that_waits_for_workers_can_be_cancelled(tmp_path):
    asked = itertools.count()
    with ThreadPoolExecutor(1) as threads:
        engine = Engine(threads, lambda: 0, in_process=True)
        result = captured(tmp_path / "out", executor=engine, listener=Listener(cancelled=lambda: next(asked) > 2))
    assert (result.cancelled, result.written) == (True, 0)


def test_workers_of_other_machines_have_their_own_usual_cache(tmp_path, monkeypatch):
    usual, given = TileCache(), TileCache(tmp_path / "given", 10**9)
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "elsewhere"))
    found = [pickle.loads(pickle.dumps(one)) for one in (usual, given)]
    assert [one.folder for one in found] == [tmp_path / "elsewhere", tmp_path / "given"]
    assert found[1].limit_bytes == 10**9


def test_options_of_workers_hold_no_keys():
    source = named_source("https://tiles.example/{z}/{x}/{y}?k={key}", SourceOptions(key="NOBODYSEES"))
    packed = pickle.dumps(source)
    assert b"NOBODYSEES" not in packed
    assert pickle.loads(packed).entry == source.entry
