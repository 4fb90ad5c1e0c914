"""What refusals of captures in blocks advise."""

from __future__ import annotations

import platform
import sys
import threading
from concurrent.futures import Future, ThreadPoolExecutor
from uuid import uuid4

from terrainav.core.capture import holding
from terrainav.core.capture.begun import BEGUN_FILE
from terrainav.core.capture.blocks.engines import Engine, _Workers, open_engine
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.choices import BLOCKS_FOLDER, DIVISION_FILE
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.resources import version
from terrainav.core.storage.stores import put, store_path

from tests.core.remedies.files import extra_brings
from tests.support.remedies import Case, remedy
from tests.support.sources import NamedPattern, PatternSource

SOURCE = NamedPattern()
MISSION = Mission(Points(((35.0, -89.9, 20.0),)), 20.0)


def captured(place, mission=MISSION, **how):
    return capture(plan(mission, SOURCE.grid), SOURCE, place, blocks=Blocks(), **how)


def new():
    return f"memory://{uuid4().hex}/run"


@remedy(
    "capture/blocks/journal.py",
    "{}: holds this mission with other images, because the source or the version was another; choose another folder",
)
def _other_images(case: Case) -> None:
    address = new()
    captured(address)
    put(store_path(f"{address}/blocks/blocks.json"), b'{"captures": 2}')
    case.refused(lambda: captured(address, resume=True))
    case.follow("choose another folder", lambda: captured(new()))


class Failing(ThreadPoolExecutor):
    """Workers of which each block ends with an error, at first."""

    def __init__(self, wrong: Exception) -> None:
        super().__init__(1)
        self.wrong: Exception | None = wrong

    def submit(self, fn, /, *arguments):  # type: ignore[no-untyped-def]
        if self.wrong is None:
            return super().submit(fn, *arguments)
        future: Future = Future()
        future.set_exception(self.wrong)
        return future


@remedy(
    "capture/blocks/running.py",
    "workers: {} blocks in a row could not be made ({}); resume it (--resume) once they are well",
)
def _none_made(case: Case) -> None:
    address, mission = (
        new(),
        MISSION.replace(area=Points(tuple((35.0 + 1e-4 * n, -89.9, 20.0) for n in range(7)))),
    )
    with Failing(RuntimeError("broken")) as workers:
        engine = Engine(workers, lambda: 1, in_process=True)

        def go(resume: bool):
            worked_out = plan(mission, SOURCE.grid)
            return capture(worked_out, SOURCE, address, executor=engine, blocks=Blocks(1), resume=resume)

        case.refused(lambda: go(False))
        workers.wrong = None
        case.follow("resume it (--resume) once they are well", lambda: go(True))


@remedy("capture/blocks/running.py", "workers: not all have TerrAInav {}; install it on each, of the same version")
def _not_installed(case: Case) -> None:
    with Failing(ModuleNotFoundError("No module named 'terrainav'")) as workers:
        engine = Engine(workers, lambda: 1, in_process=True)

        def go():
            return capture(plan(MISSION, SOURCE.grid), SOURCE, new(), executor=engine, blocks=Blocks())

        case.refused(go)
        workers.wrong = None
        case.follow("install it on each, of the same version", go)


@remedy("capture/blocks/running.py", "workers: not all have what TerrAInav needs ({}); install it on each")
def _not_whole(case: Case) -> None:
    with Failing(ModuleNotFoundError("No module named 'pyproj'")) as workers:
        engine = Engine(workers, lambda: 1)
        place = case.tmp_path / "out"

        def go():
            return capture(plan(MISSION, SOURCE.grid), SOURCE, place, executor=engine, blocks=Blocks(), resume=True)

        case.refused(go)
        workers.wrong = None
        case.follow("install it on each", go)


class _Asked:
    """A client of a cluster of one worker."""

    answer: object

    def nthreads(self):
        return {"tcp://127.0.0.1:1": 1}

    def run(self, *_, **__):
        return {"tcp://127.0.0.1:1": self.answer}


@remedy(
    "capture/blocks/engines.py",
    "cluster: {} of {} workers cannot make blocks: {} {}; install it there: pip install 'terrainav[cluster]=={}'",
)
def _worker_without(case: Case) -> None:
    client = _Asked()
    client.answer = ModuleNotFoundError("No module named 'terrainav'", name="terrainav")
    case.refused(lambda: _Workers(client).slots())
    client.answer = (platform.python_version(), version(), True)
    case.follow(f"install it there: pip install 'terrainav[cluster]=={version()}'", lambda: _Workers(client).slots())


@remedy("capture/holding.py", "address {}: another run is at work there; wait until it has ended")
def _at_work(case: Case) -> None:
    case.monkeypatch.setattr(holding, "BEAT_S", 0.1)
    address, begun, go_on = new(), threading.Event(), threading.Event()

    def cancelled():
        begun.set()
        go_on.wait(30.0)
        return False

    first = threading.Thread(target=lambda: captured(address, listener=Listener(cancelled=cancelled)))
    first.start()
    assert begun.wait(30.0)
    case.refused(lambda: captured(address, resume=True))

    def ended():
        go_on.set()
        first.join()
        captured(address, resume=True)

    case.follow("wait until it has ended", ended)


@remedy(
    "capture/begun.py",
    "{}: its {} cannot be read ({}), so it is not known how it was begun; choose another folder",
)
def _torn_settings(case: Case) -> None:
    captured(case.tmp_path / "out")
    (case.tmp_path / "out" / BEGUN_FILE).write_bytes(b"{")
    case.refused(lambda: captured(case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: captured(case.tmp_path / "other"))


@remedy(
    "capture/begun.py",
    "{}: its {} was edited since the capture began: {}; put it back as it was or choose another folder",
)
def _edited(case: Case) -> None:
    captured(case.tmp_path / "out")
    mark = case.tmp_path / "out" / "mission.json"
    text = mark.read_bytes()
    other = MISSION.replace(seed=8)
    other.save(mark)
    case.refused(lambda: captured(case.tmp_path / "out", other, resume=True))

    def put_back():
        mark.write_bytes(text)
        captured(case.tmp_path / "out", resume=True)

    case.follow("put it back as it was", put_back)
    case.follow("choose another folder", lambda: captured(case.tmp_path / "other", other))


@remedy(
    "capture/blocks/journal.py",
    "{}: its {} cannot be read ({}), so it is not known how it was begun; choose another folder",
)
def _torn_division(case: Case) -> None:
    captured(case.tmp_path / "out")
    (case.tmp_path / "out" / BLOCKS_FOLDER / DIVISION_FILE).write_bytes(b"{")
    case.refused(lambda: captured(case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: captured(case.tmp_path / "other"))


@remedy("capture/blocks/journal.py", "folder {}: was captured without blocks; choose another folder")
def _without(case: Case) -> None:
    source = PatternSource()
    capture(plan(MISSION, source.grid), source, case.tmp_path / "out")
    case.refused(lambda: captured(case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: captured(case.tmp_path / "other"))


@remedy(
    "capture/blocks/journal.py",
    "{}: holds no capture in blocks of this mission, so nothing of it has failed; capture it first",
)
def _nothing_failed(case: Case) -> None:
    address = new()
    case.refused(lambda: captured(address, only_failed=True))

    def first():
        captured(address)
        captured(address, only_failed=True)

    case.follow("capture it first", first)


@remedy("capture/images.py", "folder {}: was captured in blocks; choose another folder")
def _with(case: Case) -> None:
    source = PatternSource()
    captured(case.tmp_path / "out")
    worked_out = plan(MISSION, source.grid)
    case.refused(lambda: capture(worked_out, source, case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: capture(worked_out, source, case.tmp_path / "other"))


@remedy(
    "capture/blocks/engines.py",
    "clusters: Dask's distributed cannot be imported ({}); get it with: pip install 'terrainav[cluster]'",
)
def _no_dask(case: Case) -> None:
    def opened():
        with open_engine("local:1"):
            pass

    with case.monkeypatch.context() as without:
        without.setitem(sys.modules, "distributed", None)
        case.refused(opened)
    case.follow("get it with: pip install 'terrainav[cluster]'", lambda: extra_brings("cluster", "distributed"))
