"""A run that stood still while another one took its place finds out before it writes anything more."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest
from terrainav.core.capture import holding
from terrainav.core.errors import OutputError
from terrainav.core.storage.files import read_existing
from terrainav.core.storage.stores import is_address, put, store_path

from tests.support.forks import ROOT
from tests.support.objects import s3_store

pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGSTOP"), reason="this system stops no processes")
#: Far longer than anything takes: only a test that fails waits for so long.
PATIENCE_S = 120.0


@contextmanager
def running(kind, place, signals):
    """Run a capture; ended with the context, whatever became of it."""
    with subprocess.Popen(
        [sys.executable, "-m", "tests.support.overtaken", kind, str(place), str(signals)],
        cwd=ROOT,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            if process.poll() is None:
                process.kill()


def wait_for(is_so):
    until_s = time.monotonic() + PATIENCE_S
    while not is_so():
        assert time.monotonic() < until_s
        time.sleep(0.02)


def is_stopped(process):
    state = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()[0]
    return state == "T"


@contextmanager
def stopped_in_the_middle(kind, place, signals):
    """A run that is stopped once it has asked for imagery, and may go on with what it was waiting for."""
    with running(kind, place, signals) as first:
        wait_for((signals / "asked").exists)
        first.send_signal(signal.SIGSTOP)
        wait_for(lambda: is_stopped(first))
        (signals / "go").touch()
        yield first


def ended(process):
    process.send_signal(signal.SIGCONT)
    printed, said = process.communicate(timeout=PATIENCE_S)
    return process.returncode, printed, said


def contents(folder):
    """Bytes of all files, and when they were written."""
    return {
        str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mtime_ns, path.stat().st_ino)
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        pytest.param(
            "no-locks",
            "another run has taken over, as this one gave no sign of life for 4 s",
            marks=pytest.mark.thorough,
        ),
        ("no-locks-blocks", "another run has taken over, as this one gave no sign of life for 4 s"),
        ("lost", "another run has taken over, as its journal.jsonl shows"),
        ("flock", "its journal.jsonl was replaced or removed, so that another run may be at work in it"),
        pytest.param(
            "flock-blocks",
            "its journal.jsonl was replaced or removed, so that another run may be at work in it",
            marks=pytest.mark.thorough,
        ),
    ],
)
def test_a_run_that_was_overtaken_ends_and_leaves_all_as_it_is(tmp_path, kind, said):
    signals, place = tmp_path / "signals", tmp_path / "out"
    signals.mkdir()
    with stopped_in_the_middle(kind, place, signals) as first:
        if kind.startswith("flock"):
            # As of a folder that was copied back, or whose journal somebody has removed.
            shutil.copy(place / "journal.jsonl", tmp_path / "journal")
            (tmp_path / "journal").replace(place / "journal.jsonl")
        with running(kind, place, signals) as second:
            assert ended(second)[0] == 0
        before = contents(place)
        code, printed, words = ended(first)
    assert (code, printed) == (3, "")
    assert said in words
    assert words.count("\n") == 1
    assert contents(place) == before
    assert not (place / "run.lease").exists()


@pytest.mark.thorough
def test_a_run_that_nobody_overtook_goes_on(tmp_path):
    (tmp_path / "signals").mkdir()
    with stopped_in_the_middle("no-locks", tmp_path / "out", tmp_path / "signals") as first:
        # It counts as dead by now.
        time.sleep(4.5)
        code, printed, words = ended(first)
    assert (code, words) == (0, "")
    assert "0 failed" in printed


@pytest.mark.thorough
def test_without_locks_a_second_run_is_refused_while_the_first_is_alive(tmp_path):
    (tmp_path / "signals").mkdir()
    with running("no-locks", tmp_path / "out", tmp_path / "signals") as first:
        wait_for((tmp_path / "signals" / "asked").exists)
        with running("no-locks", tmp_path / "out", tmp_path / "signals") as second:
            code, _, words = ended(second)
        assert code == 3
        assert "another run is at work in it" in words
        (tmp_path / "signals" / "go").touch()
        assert ended(first)[0] == 0


@pytest.mark.thorough
def test_a_run_into_a_store_that_was_overtaken_ends(tmp_path, monkeypatch):
    pytest.importorskip("upath", reason="needs universal_pathlib")
    (tmp_path / "signals").mkdir()
    with s3_store(monkeypatch) as bucket:
        place = f"{bucket}/out"
        with stopped_in_the_middle("flock-blocks", place, tmp_path / "signals") as first:
            with running("flock-blocks", place, tmp_path / "signals") as second:
                assert ended(second)[0] == 0
            code, printed, words = ended(first)
        assert (code, printed) == (3, "")
        assert "another run has taken over" in words
        assert read_existing(store_path(place) / "run.lock", 10_000) is None


# --- leases, beside clocks that others set


@pytest.fixture(params=["folder", "store"])
def root(request, tmp_path, monkeypatch):
    monkeypatch.setattr(holding, "BEAT_S", 0.05)
    monkeypatch.setattr(holding, "DEAD_S", 5.0)
    if request.param == "store":
        pytest.importorskip("upath", reason="needs universal_pathlib")
        return store_path(f"memory://leases/{tmp_path.name}")
    return tmp_path


def steal(path):
    """Have another run take a lease; returns what it puts."""
    stolen = json.dumps({"run": "another", "beat": 0}).encode()
    put(path, stolen) if is_address(path) else path.write_bytes(stolen)
    return stolen


def test_a_clock_that_is_set_by_hours_ends_no_run(root, monkeypatch):
    now, shift_s = time.time, 0.0
    monkeypatch.setattr(time, "time", lambda: now() + shift_s)
    with holding.Lease(root / "run.lease") as lease:
        for shift_s in (-7_200.0, 7_200.0, 0.0, 1e6):  # noqa: B007  (read by the clock)
            lease.check()
            time.sleep(0.1)
            lease.check()


def test_a_lease_that_is_stolen_is_found_without_any_beat(root, monkeypatch):
    """As by a process that goes on after it was stopped: its thread of beats has had no turn yet."""
    monkeypatch.setattr(holding.Lease, "_beat", lambda self: self._ended.wait())
    steady = holding._steady_s
    lease = holding.Lease(root / "it")
    with suppress(OutputError), lease:
        lease.check()
        stolen = steal(root / "it")
        monkeypatch.setattr(holding, "_steady_s", lambda: steady() + 60.0)
        with pytest.raises(OutputError, match="another run has taken over"):
            lease.check()
    assert read_existing(root / "it", 10_000) == stolen


def test_a_lease_that_is_stolen_in_the_last_moment_is_found_at_the_end(root):
    with pytest.raises(OutputError, match="another run has taken over"), holding.Lease(root / "it"):
        stolen = steal(root / "it")
    assert read_existing(root / "it", 10_000) == stolen


def test_a_sign_that_was_written_over_another_runs_is_taken_away(root, monkeypatch):
    """As by a process that was stopped between its look at the lease and its sign."""
    monkeypatch.setattr(holding.Lease, "_beat", lambda self: self._ended.wait())
    steady, put_sign = holding._steady_s, holding.Lease._put

    def put_late(lease):
        steal(root / "it")
        monkeypatch.setattr(holding, "_steady_s", lambda: steady() + 60.0)
        put_sign(lease)

    with suppress(OutputError), holding.Lease(root / "it") as lease:
        monkeypatch.setattr(holding.Lease, "_put", put_late)
        lease._sign()
        with pytest.raises(OutputError, match="another run has taken over"):
            lease.check()
    assert read_existing(root / "it", 10_000) is None


def test_a_lease_that_is_no_lease_any_more_ends_the_run_in_one_line(root, monkeypatch):
    """Another program has written over it; the thread that gives signs prints nothing of its own."""
    monkeypatch.setattr(holding, "MAX_SETTINGS_BYTES", 1000)
    monkeypatch.setattr(holding, "DEAD_S", 0.2)
    junk = b"x" * 2000
    with suppress(OutputError), holding.Lease(root / "it") as lease:
        put(root / "it", junk) if is_address(root) else (root / "it").write_bytes(junk)
        wait_for(lambda: not lease._thread.is_alive())
        with pytest.raises(OutputError, match=r"it: cannot be read \(larger than "):
            lease.check()
    assert read_existing(root / "it", 10_000) == junk


def test_a_lease_that_is_no_lease_is_said_before_the_run_begins(root, monkeypatch):
    monkeypatch.setattr(holding, "MAX_SETTINGS_BYTES", 1000)
    junk = b"x" * 2000
    put(root / "it", junk) if is_address(root) else (root / "it").write_bytes(junk)
    with pytest.raises(OutputError, match=r"it: cannot be read \(larger than "):
        holding.Lease(root / "it").__enter__()
    assert read_existing(root / "it", 10_000) == junk
