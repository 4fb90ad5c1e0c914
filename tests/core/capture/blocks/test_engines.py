"""Who runs blocks: what their processes are set to."""

import asyncio
import contextlib
import gc
import multiprocessing
import os
import signal
import socket
import struct
import threading
import time

import pytest
from terrainav.core.capture.blocks import running
from terrainav.core.capture.blocks.division import parse_block_size
from terrainav.core.capture.blocks.engines import open_engine
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.waiting import cancellable

from tests.support.thinning import sampled
from tests.support.waiting import wait_until

distributed = pytest.importorskip("distributed", reason="needs Dask's distributed")
#: Dask's own warnings, of ports that are taken and workers that are slow to end, are none of ours.
pytestmark = pytest.mark.filterwarnings("default")


@pytest.fixture(scope="module")
def cluster():
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.delenv("MALLOC_TRIM_THRESHOLD_", raising=False)
        with open_engine("local:1") as engine:
            yield engine


@pytest.mark.skipif(os.name == "nt", reason="Windows has no masks of signals")
def test_workers_do_not_hear_the_ctrl_c_of_their_terminal(cluster):
    """They printed a traceback each, or were missed as they began, which ended the command with 3."""
    pid = cluster.executor.submit(os.getpid).result()
    os.kill(pid, signal.SIGINT)
    assert cluster.executor.submit(os.getpid).result(timeout=60.0) == pid
    assert signal.SIGINT in cluster.executor.submit(signal.pthread_sigmask, signal.SIG_BLOCK, []).result()
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])


def test_a_cluster_that_is_being_begun_can_be_cancelled(monkeypatch):
    let_go, closed = threading.Event(), threading.Event()

    class Slow:
        close = staticmethod(closed.set)

        def __init__(self, **settings):
            let_go.wait(60.0)

    monkeypatch.setattr(distributed, "LocalCluster", Slow)
    with cancellable(lambda: True), pytest.raises(Cancelled), open_engine("local:1"):
        pass
    let_go.set()
    assert closed.wait(60.0)


def test_workers_keep_the_memory_of_arrays(cluster):
    # As Dask sets it, it takes half of the workers' processor time; who has set it himself keeps that.
    assert cluster.executor.submit(os.environ.get, "MALLOC_TRIM_THRESHOLD_").result() is None


@pytest.mark.thorough
def test_a_worker_that_is_gone_for_good_is_replaced(monkeypatch):
    monkeypatch.delenv("MALLOC_TRIM_THRESHOLD_", raising=False)
    dask = pytest.importorskip("dask")
    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "100 ms"}),
        open_engine("local:1") as engine,
    ):
        client = engine.executor._client
        (first,) = client.nthreads()
        client.retire_workers([first], close_workers=True)
        wait_until(engine.slots)
        (second,) = client.nthreads()
        assert second != first
        assert engine.executor.submit(os.environ.get, "MALLOC_TRIM_THRESHOLD_").result() is None


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such pipes")
def test_a_call_that_is_cancelled_is_not_made(cluster, tmp_path):
    # Lasts until somebody writes to it.
    os.mkfifo(tmp_path / "pipe")
    first = cluster.executor.submit(os.open, str(tmp_path / "pipe"), os.O_RDONLY)
    second = cluster.executor.submit(os.mkdir, str(tmp_path / "made"))
    tasks = "sum(len(one.state.tasks) for one in __import__('distributed').Worker._instances)"
    # The worker hears of either a while later.
    wait_until(lambda: [*cluster.executor._client.run(eval, tasks).values()] == [2])
    assert second.cancel()
    wait_until(lambda: [*cluster.executor._client.run(eval, tasks).values()] == [1])
    with (tmp_path / "pipe").open("w"):
        assert first.result(timeout=60.0) > 2
    assert cluster.executor.submit(os.getpid).result(timeout=60.0)
    assert not (tmp_path / "made").exists()


#: Returns much, and ends the worker while that is fetched; the next time, ends it at once.
ENDS = """[
    os := __import__("os"),
    os._exit(1) if os.path.exists({0!r}) else os.mkdir({0!r}),
    __import__("threading").Timer(0.02, os._exit, (1,)).start(),
    bytes(100_000_000),
]"""


def test_a_worker_that_dies_while_its_result_is_fetched_is_told_of(tmp_path):
    """Dask's own executor would not say anything of it."""
    with open_engine("local:1") as engine:
        future = engine.executor.submit(eval, ENDS.format(str(tmp_path / "once")))
        wrong = future.exception(timeout=60.0)
    assert running._describe(wrong) == "its worker died"


@pytest.mark.thorough
def test_a_cluster_ends_while_a_worker_is_begun_again(monkeypatch):
    """One that dies just as it has begun: Dask takes the next for it, whose process it has not begun yet."""
    process, nanny = distributed.process.AsyncProcess, distributed.nanny.WorkerProcess
    begin, connect, others = (
        process.start,
        nanny._wait_until_connected,
        set(multiprocessing.active_children()),
    )
    begun: list[object] = []

    async def begin_late(worker):
        begun.append(worker)
        if len(begun) == 2:
            await asyncio.sleep(1.0)
        await begin(worker)

    async def connect_late(*args):
        connected = await connect(*args)
        while len(begun) == 1:
            await asyncio.sleep(0.01)
        return connected

    with open_engine("local:1") as engine:
        monkeypatch.setattr(process, "start", begin_late)
        monkeypatch.setattr(nanny, "_wait_until_connected", connect_late)
        for _ in range(2):
            assert engine.executor.submit(os._exit, 1).exception(timeout=60.0)
        while len(begun) < 2:
            time.sleep(0.01)
        time.sleep(0.1)
    # One that was begun meanwhile is being ended.
    wait_until(lambda: set(multiprocessing.active_children()) <= others)


def _serve(data):
    """Serve bytes to whoever connects; returns the port, and what ends it."""
    server = socket.create_server(("127.0.0.1", 0))

    def answer():
        while True:
            try:
                connection, _ = server.accept()
            except OSError:
                return
            with connection, contextlib.suppress(OSError):
                connection.sendall(data)
                connection.recv(1 << 16)

    threading.Thread(target=answer, daemon=True).start()
    return server.getsockname()[1], server.close


@pytest.mark.parametrize(
    "data",
    sampled(
        [
            bytes(1 << 16),
            # Announces more than any memory holds.
            b"HTTP/1.1 400 Bad Request\r\n\r\n" * 100,
            # A message of Dask's in msgpack that is none, and one that says nothing.
            *(
                struct.pack("<3Q", 8 + 8 + len(body), 1, len(body)) + body
                for body in (b"\xc1" * 5, b"\x80", b"\x93" + b"\xc0" * 3)
            ),
        ],
        2,
    ),
)
def test_what_is_no_scheduler_is_told_in_one_line(data):
    port, end = _serve(data)
    try:
        with (
            pytest.raises(OutputError, match="no scheduler answers there"),
            open_engine(f"dask://127.0.0.1:{port}"),
        ):
            pass
        # What Dask has half made is not ended when it is collected, which takes 20 s and prints a traceback.
        gc.collect()
    finally:
        end()


@pytest.mark.parametrize("text", ["local:" + "9" * 5000, "dask://h:" + "9" * 5000, "dask://h:0", "dask://h:65536"])
def test_numbers_without_end_name_no_cluster(text):
    with pytest.raises(InvalidInput, match="must be local:N"), open_engine(text):
        pass


def test_workers_that_cannot_be_begun_are_told_in_one_line(monkeypatch):
    async def start(self):
        raise RuntimeError("no process")

    monkeypatch.setattr(distributed.nanny.WorkerProcess, "start", start)
    with pytest.raises(OutputError) as refused, open_engine("local:1"):
        pass
    assert str(refused.value) == (
        "cluster local:1: its processes cannot be started (RuntimeError: Nanny failed to start.)"
    )


def test_a_cluster_that_does_not_end_well_takes_nothing_back(monkeypatch):
    close = distributed.LocalCluster.close

    def fails(self, *arguments, **named):
        close(self, *arguments, **named)
        raise TimeoutError("late")

    monkeypatch.setattr(distributed.LocalCluster, "close", fails)
    with open_engine("local:1") as engine:
        assert engine.executor.submit(os.getpid).result(timeout=60.0)


@pytest.mark.parametrize("size", ["9" * 5000, "9" * 5000 + "MB", "9" * 300 + ".5MB"])
def test_blocks_without_end_are_refused(size):
    with pytest.raises(InvalidInput, match="must be 1 to"):
        parse_block_size(size, lambda: 1000.0)
