"""What refusals of captures in blocks advise."""

from __future__ import annotations

import sys
import threading
from uuid import uuid4

from terrainav.core.capture import holding
from terrainav.core.capture.blocks.engines import open_engine
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.mission.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.stores import put, store_path

from tests.core.remedies.files import extra_brings
from tests.support.remedies import Case, remedy
from tests.support.sources import NamedPattern, PatternSource

SOURCE = NamedPattern()
MISSION = Mission(Points(((35.0, -89.9, 20.0),)), 20.0)


def captured(place, mission=MISSION, **how):
    return capture(plan(mission, SOURCE.grid), SOURCE, place, blocks=Blocks(), **how)


def new():
    return f"memory://{uuid4().hex}/run"


@remedy("capture/folder.py", "address {}: holds another mission; choose another one")
def _another(case: Case) -> None:
    address = new()
    captured(address)
    other = MISSION.with_(agl_m=21.0)
    case.refused(lambda: captured(address, other))
    case.follow("choose another one", lambda: captured(new(), other))


@remedy(
    "capture/folder.py",
    "address {}: already holds this mission; resume it (--resume) or choose another one",
)
def _already(case: Case) -> None:
    address = new()
    captured(address)
    case.refused(lambda: captured(address))
    case.follow("resume it (--resume)", lambda: captured(address, resume=True))
    case.follow("choose another one", lambda: captured(new()))


@remedy(
    "capture/folder.py",
    "address {}: holds {} but no {}, so it is not this mission's; choose another one",
)
def _foreign(case: Case) -> None:
    address = new()
    put(store_path(f"{address}/holiday.jpg"), b"")
    case.refused(lambda: captured(address))
    case.follow("choose another one", lambda: captured(new()))


@remedy(
    "capture/blocks/destination.py",
    "{}: holds this mission with other images, because the source or the version was another; choose another one",
)
def _other_images(case: Case) -> None:
    address = new()
    captured(address)
    put(store_path(f"{address}/blocks/blocks.json"), b'{"captures": 2}')
    case.refused(lambda: captured(address, resume=True))
    case.follow("choose another one", lambda: captured(new()))


@remedy("capture/holding.py", "address {}: another run is at work there; wait until it has ended")
def _at_work(case: Case) -> None:
    case.monkeypatch.setattr(holding, "BEAT_S", 0.1)
    address, begun, go_on = new(), threading.Event(), threading.Event()

    def cancelled():
        begun.set()
        go_on.wait(30.0)
        return False

    first = threading.Thread(target=lambda: captured(address, cancelled=cancelled))
    first.start()
    assert begun.wait(30.0)
    case.refused(lambda: captured(address, resume=True))

    def ended():
        go_on.set()
        first.join()
        captured(address, resume=True)

    case.follow("wait until it has ended", ended)


@remedy("capture/blocks/destination.py", "folder {}: was captured without blocks; choose another folder")
def _without(case: Case) -> None:
    source = PatternSource()
    capture(plan(MISSION, source.grid), source, case.tmp_path / "out")
    case.refused(lambda: captured(case.tmp_path / "out", resume=True))
    case.follow("choose another folder", lambda: captured(case.tmp_path / "other"))


@remedy(
    "capture/blocks/destination.py",
    "{}: holds no capture in blocks of this mission, so nothing of it has failed; capture it first",
)
def _nothing_failed(case: Case) -> None:
    address = new()
    case.refused(lambda: captured(address, only_failed=True))

    def first():
        captured(address)
        captured(address, only_failed=True)

    case.follow("capture it first", first)


@remedy("capture/runner.py", "folder {}: was captured in blocks; choose another folder")
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
    case.follow(
        "get it with: pip install 'terrainav[cluster]'", lambda: extra_brings("cluster", "distributed")
    )
