"""Where runs in blocks work: workers with another current folder, places that others hold, stores out of reach."""

from __future__ import annotations

import json
import os
import pickle
import threading
import time
from concurrent.futures import Executor, Future
from pathlib import Path
from uuid import uuid4

import pytest
from terrainav.core.capture import holding
from terrainav.core.capture.blocks.engines import Engine
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.folder import StoreFolder, capture_folder
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.capture.several import capture_imageries
from terrainav.core.elevation.heights import whole_heights_path
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.storage.files import open_locked
from terrainav.core.storage.stores import get, store_path

from tests.support.rasters import write
from tests.support.sources import NamedPattern

POINTS = Points(tuple((35.101 + 0.01 * n, -89.865, 120.0) for n in range(6)))
MISSION = Mission(POINTS, 120.0, zoom=17)
PATTERN = NamedPattern()
PLAN = plan(MISSION, PATTERN.grid)


@pytest.fixture
def address():
    return f"memory://{uuid4().hex}/run"


@pytest.fixture
def brief(monkeypatch):
    monkeypatch.setattr(holding, "BEAT_S", 0.1)
    monkeypatch.setattr(holding, "DEAD_S", 1.0)


class Elsewhere(Executor):
    """Workers with another current folder than the run's."""

    def __init__(self, folder):
        self._folder = folder

    def submit(self, make, /, *arguments):
        future, before = Future(), Path.cwd()
        os.chdir(self._folder)
        try:
            future.set_result(make(*arguments))
        except Exception as wrong:  # noqa: BLE001
            future.set_exception(wrong)
        finally:
            os.chdir(before)
        return future


def test_workers_with_another_folder_find_what_relative_paths_name(tmp_path, monkeypatch):
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    monkeypatch.chdir(tmp_path / "here")
    write(tmp_path / "here" / "dem.tif", [[[90.0] * 40] * 40], (-89.9, 0.003, 0, 35.18, 0, -0.003), epsg=4326)
    mission = MISSION.replace(elevation=("dem.tif",), tilt_deg=10.0)
    worked_out = plan(mission, PATTERN.grid, mission_heights(mission))
    engine = Engine(Elsewhere(tmp_path / "there"), lambda: 1)
    result = capture(worked_out, PATTERN, "out", executor=engine, blocks=Blocks(3))
    assert (result.written, result.failed) == (len(worked_out), ())
    assert len(list((tmp_path / "here" / "out" / "satellite").glob("*.tif"))) == len(worked_out)
    assert list((tmp_path / "there").iterdir()) == []


def test_files_have_whole_paths_where_other_processes_open_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for text in ("x.mbtiles", "sub/ortho-{date}.tif"):
        assert pickle.loads(pickle.dumps(named_source(text))).text == str(tmp_path / text)
    for text in ("/data/x.tif", "https://a.example/x.tif", "/vsizip/x.zip/y.tif"):
        assert pickle.loads(pickle.dumps(named_source(text))).text == text
    for text in ("world", "120.5", "terrarium", "terrarium:https://a.example/{z}/{x}/{y}.png"):
        assert whole_heights_path(text) == text
    assert whole_heights_path("terrain-rgb:x.mbtiles") == f"terrain-rgb:{tmp_path}/x.mbtiles"


def test_an_address_of_a_file_is_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    capture(PLAN, PATTERN, f"file://{tmp_path}/out", blocks=Blocks())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out"]


def test_memory_of_this_process_is_refused_where_others_make_blocks(address):
    with pytest.raises(InvalidInput, match=r"is of this process alone, .* must be a folder, or begin with s3://"):
        capture(PLAN, PATTERN, address, executor=Engine(Elsewhere("."), lambda: 1))


def test_a_run_that_is_refused_leaves_no_division(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mission.json").write_text(MISSION.to_json(), "utf-8")
    with (
        open_locked(tmp_path / "out" / "journal.jsonl"),
        pytest.raises(OutputError, match="another run is at work in it"),
    ):
        capture(PLAN, PATTERN, tmp_path / "out", blocks=Blocks(3), resume=True)
    assert not (tmp_path / "out" / "blocks").exists()


def test_progress_goes_on_within_a_block(address):
    told = []
    slow = NamedPattern(wait_s=0.15)
    capture(
        PLAN,
        slow,
        address,
        connections=1,
        workers=1,
        listener=Listener(progress=lambda one: told.append(one.done)),
    )
    assert [one for one in told if 0 < one < len(PLAN)]
    assert told == sorted(told)
    assert told[-1] == len(PLAN)


def test_workers_that_have_gone_are_one_line(tmp_path):
    def slots():
        raise OSError("in <TCP (closed) ConnectionPool.ncores>: ConnectionResetError")

    with pytest.raises(OutputError, match=r"^workers: all are gone \(OSError\)$"):
        capture(PLAN, PATTERN, tmp_path / "out", executor=Engine(Elsewhere("."), slots))


# --- who holds a place


@pytest.mark.usefixtures("brief")
def test_a_store_that_is_out_of_reach_for_a_moment_ends_no_run(address, monkeypatch):
    refused = []

    def put(path, data):
        if len(refused) < 3:
            refused.append(path)
            raise OutputError("{0}: cannot be reached", path)
        store_path(str(path)).write_bytes(data)

    monkeypatch.setattr(holding, "write_whole", put)
    with capture_folder(store_path(address)).held() as check:
        until_s = time.monotonic() + 30.0
        while len(refused) < 3 or b'"beat": 0' in get(store_path(f"{address}/run.lock")):
            assert time.monotonic() < until_s
            time.sleep(0.02)
        check()


@pytest.mark.usefixtures("brief")
def test_a_store_that_stays_out_of_reach_ends_the_run(address, monkeypatch):
    def put(path, _):
        raise OutputError("{0}: cannot be reached", path)

    monkeypatch.setattr(holding, "write_whole", put)
    slow = NamedPattern(wait_s=0.5)
    with pytest.raises(OutputError, match=r"run\.lock: cannot be reached"):
        capture(PLAN, slow, address, blocks=Blocks(1), connections=1)


def test_a_run_that_ends_leaves_the_mark_of_the_one_that_took_over(address):
    lock = store_path(f"{address}/run.lock")
    with (
        pytest.raises(OutputError, match="another run has taken over"),
        capture_folder(store_path(address)).held(),
    ):
        lock.write_bytes(b'{"run": "another", "beat": 0}')
    assert json.loads(get(lock))["run"] == "another"


@pytest.mark.usefixtures("brief")
def test_a_run_whose_place_was_taken_writes_no_tables(address, monkeypatch):
    lost = threading.Event()

    def check():
        if lost.is_set():
            raise OutputError("another run has taken over")

    class Held:
        def __enter__(self):
            return check

        def __exit__(self, *_):
            return None

    monkeypatch.setattr(StoreFolder, "held", lambda _: Held())
    with pytest.raises(OutputError, match="another run has taken over"):
        capture(
            PLAN,
            NamedPattern(wait_s=0.2),
            address,
            blocks=Blocks(1),
            connections=1,
            listener=Listener(progress=lambda one: one.done and lost.set()),
        )
    assert get(store_path(f"{address}/satellite/meta_data.csv")) is None


def test_of_several_imageries_at_an_address_the_whole_is_held(address):
    mission = MISSION.replace(imageries=("a=world", "b=world"))
    each = mission.missions_by_imagery
    sources = {name: NamedPattern() for name in each}
    plans = {name: plan(one, PATTERN.grid) for name, one in each.items()}
    begun, go_on = threading.Event(), threading.Event()

    def cancelled():
        begun.set()
        go_on.wait(30.0)
        return False

    def run(**how):
        return capture_imageries(mission, plans, sources, address, **how)

    first = threading.Thread(target=lambda: run(listener=Listener(cancelled=cancelled)))
    first.start()
    try:
        assert begun.wait(30.0)
        assert get(store_path(f"{address}/run.lock")) is not None
    finally:
        go_on.set()
        first.join()
    assert get(store_path(f"{address}/run.lock")) is None
    assert get(store_path(f"{address}/b/satellite/meta_data.csv")).count(b"done") == len(PLAN)
