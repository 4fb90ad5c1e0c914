"""A capture that is held, and one of what has failed before, from a server with faults."""

from __future__ import annotations

import json
import threading
import time
from contextlib import closing

import pytest
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.errors import OutputError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.requests_transport import RequestsTransport
from terrainav.core.imagery.xyz import XYZSource
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.core.capture.test_faulty_capture import BAD, CONCERNED, MISSION, PLAN, TILES, check, files, run
from tests.support.command import command
from tests.support.sources import PatternSource
from tests.support.tileserver import TileServer
from tests.support.waiting import wait_until

#: Reports of a held run, which come at intervals, that say the same when nothing is under way any more.
SETTLED_REPORTS = 5
#: Long enough to hang in, were there anything to hang in.
HANG_S = 30.0


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


def only_failed(server, folder, worked_out=PLAN, **options):
    client = Client(RequestsTransport(4), "The provider", connections=4, tries=2, first_wait_s=0.01)
    with closing(
        XYZSource(server.url_template, name="p", title="The provider", attribution="© provider", client=client)
    ) as source:
        return capture(worked_out, source, folder, only_failed=True, **options)


# --- what has failed before


def test_only_what_has_failed_is_asked_for(server, tmp_path):
    server.fail("404", *BAD)
    first = run(server, tmp_path / "out")
    assert {failure.name for failure in first.failed} == CONCERNED
    # A picture that is lost is for --resume: it has not failed.
    lost = next(name for name in PLAN.names if name not in CONCERNED)
    (tmp_path / "out" / "satellite" / f"{lost}.tif").unlink()
    server.heal()
    before = server.tile_requests
    again = only_failed(server, tmp_path / "out")
    assert (again.total, again.written, again.skipped, again.failed) == (
        len(CONCERNED),
        len(CONCERNED),
        0,
        (),
    )
    assert not (tmp_path / "out" / "satellite" / f"{lost}.tif").exists()
    asked = set(server.tile_requests - before)
    assert {("", *tile) for tile in BAD} <= asked
    assert len(asked) < len(TILES)

    resumed = run(server, tmp_path / "out", resume=True)
    assert resumed.written == 1
    check(tmp_path / "out")


def test_what_fails_again_stays_named(server, tmp_path):
    server.fail("404", *BAD)
    run(server, tmp_path / "out")
    again = only_failed(server, tmp_path / "out")
    assert {failure.name for failure in again.failed} == CONCERNED
    assert again.written == 0
    check(tmp_path / "out", CONCERNED, "404")


def test_where_nothing_has_failed_there_is_nothing_to_do(server, tmp_path):
    run(server, tmp_path / "out")
    before, requests = files(tmp_path / "out"), server.tile_requests
    again = only_failed(server, tmp_path / "out")
    assert (again.total, again.written, again.skipped, again.failed, again.requests) == (0, 0, 0, (), 0)
    assert not again.cancelled
    assert files(tmp_path / "out") == before
    assert server.tile_requests == requests


def test_a_folder_without_this_mission_is_refused_and_left_alone(server, tmp_path):
    with pytest.raises(OutputError, match="holds no capture of this mission"):
        only_failed(server, tmp_path / "new")
    assert not (tmp_path / "new").exists()
    other = plan(MISSION.replace(agl_m=130.0), PixelGrid())
    run(server, tmp_path / "out")
    before = files(tmp_path / "out")
    with pytest.raises(OutputError, match="holds another mission"):
        only_failed(server, tmp_path / "out", other)
    assert files(tmp_path / "out") == before


def test_failures_of_one_map_type_are_not_those_of_another(tmp_path):
    from tests.support.sources import FailingSource, missing

    mission = Mission(Box(35.16, -89.90, 35.1525, -89.8915), 120.0, zoom=18, map_types=("satellite", "roadmap"))
    whole = PatternSource()
    worked_out = plan(mission, whole.grid)

    class HalfMissing(FailingSource):
        def paint(self, map_type, part):
            if map_type == "roadmap":
                raise missing()
            return super().paint(map_type, part)

    capture(worked_out, HalfMissing({}), tmp_path)
    result = capture(worked_out, whole, tmp_path, only_failed=True)
    assert result.total == result.written == len(worked_out)
    assert {map_type for map_type, _ in whole.fetched} == {"roadmap"}


# --- pauses


class Held:
    """A run on a thread that is held as soon as some pictures are there."""

    def __init__(self, source, folder, mission=MISSION, after=2):
        self.pausing, self.cancelling = threading.Event(), threading.Event()
        self.reports = []
        self._source, self._folder, self._plan = source, folder, plan(mission, source.grid)
        self._after = after
        self.result = None
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self):
        self.result = capture(
            self._plan,
            self._source,
            self._folder,
            connections=2,
            workers=2,
            listener=Listener(progress=self._hear, cancelled=self.cancelling.is_set, paused=self._paused),
        )

    def _hear(self, progress):
        self.reports.append(progress)

    def _paused(self):
        if self._after is not None and sum(self._source.fetched.values()) >= self._after:
            self._after = None
            self.pausing.set()
        return self.pausing.is_set()

    def settle(self):
        """Wait until it is held and nothing is under way any more."""
        assert self.pausing.wait(HANG_S)
        states = []

        def is_settled():
            latest = self.reports[-1] if self.reports else None
            if latest is not None and not (states and states[-1][0] is latest):
                images = sum(1 for _ in self._folder.glob("satellite/*.tif"))
                at_rest = latest.paused and self._source.at_once == 0
                states.append((latest, at_rest and (sum(self._source.fetched.values()), images)))
            same = {state for _, state in states[-SETTLED_REPORTS:]}
            return len(states) >= SETTLED_REPORTS and len(same) == 1 and False not in same

        wait_until(is_settled)

    def hear(self, count=SETTLED_REPORTS):
        """Wait for so many more reports; returns them."""
        before = len(self.reports)
        wait_until(lambda: len(self.reports) >= before + count)
        return self.reports[before:]

    def end(self):
        self._thread.join(HANG_S)
        assert not self._thread.is_alive()
        return self.result


def test_a_held_run_asks_for_nothing_begins_nothing_and_goes_on_to_the_same_bytes(tmp_path):
    source = PatternSource(wait_s=0.01)
    held = Held(source, tmp_path / "out")
    held.settle()
    fetched, written = dict(source.fetched), len(list((tmp_path / "out" / "satellite").glob("*.tif")))
    later = held.hear()
    assert dict(source.fetched) == fetched
    assert len(list((tmp_path / "out" / "satellite").glob("*.tif"))) == written
    assert sum(fetched.values()) < len(TILES)
    # It still tells, that it is held, and its clock stands.
    assert all(report.paused for report in later)
    assert len({report.active_s for report in later}) == 1
    held.pausing.clear()
    result = held.end()
    assert (result.written, result.failed, result.cancelled) == (len(PLAN), (), False)
    assert not held.reports[-1].paused
    assert set(source.fetched.values()) == {1}

    whole = PatternSource()
    capture(plan(MISSION, whole.grid), whole, tmp_path / "whole")
    assert files(tmp_path / "out") == files(tmp_path / "whole")


def test_pauses_count_for_no_rate(tmp_path):
    held = Held(PatternSource(wait_s=0.01), tmp_path / "out")
    held.settle()
    started = time.monotonic()
    held.hear()
    paused_s = time.monotonic() - started
    # What the run has worked cannot be more than the time around it without the pause.
    began = held.reports[-1].active_s
    resumed = time.monotonic()
    held.pausing.clear()
    result = held.end()
    assert result.seconds <= began + (time.monotonic() - resumed) + 0.1
    assert paused_s > 0.4
    times = [report.active_s for report in held.reports]
    assert times == sorted(times)


def test_a_held_run_is_cancelled_at_once_and_can_be_resumed(tmp_path):
    source = PatternSource(wait_s=0.01)
    before = set(threading.enumerate())
    held = Held(source, tmp_path / "out")
    held.settle()
    fetched = dict(source.fetched)
    held.cancelling.set()
    asked = time.monotonic()
    result = held.end()
    assert result.cancelled
    # Half a second is promised; the rest is for a busy machine.
    assert time.monotonic() - asked < HANG_S / 3
    assert dict(source.fetched) == fetched
    wait_until(lambda: before.issuperset(threading.enumerate()))
    again = capture(plan(MISSION, source.grid), source, tmp_path / "out", resume=True)
    assert again.written + again.skipped == len(PLAN)


def test_held_from_the_start_it_waits(tmp_path):
    source = PatternSource()
    held = Held(source, tmp_path / "out", after=0)
    held.settle()
    assert source.fetched == {}
    held.pausing.clear()
    assert held.end().written == len(PLAN)


def test_the_command_captures_only_what_has_failed(server, tmp_path, monkeypatch, capsys):
    run_command = command(tmp_path, monkeypatch, capsys)
    options = ["--coords", "35.16_-89.90_35.1568_-89.8963_120", "--source", server.url_template]
    options += ["--data-dir", "out", "--no-cache", "--quiet", "--json"]
    refused = run_command("capture", *options, "--only-failed")
    assert refused.returncode == 3
    assert "holds no capture of this mission" in refused.stderr
    server.fail("404", share=0.1)
    first = json.loads(run_command("capture", *options).stdout)
    assert 0 < len(first["failed"]) < first["total"]
    server.heal()
    again = json.loads(run_command("capture", *options, "--only-failed").stdout)
    assert (again["total"], again["written"], again["failed"]) == (len(first["failed"]), again["total"], [])
