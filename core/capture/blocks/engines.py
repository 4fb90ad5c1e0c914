"""Executors of blocks: threads or processes of this machine, or a cluster."""

from __future__ import annotations

import asyncio
import logging
import os
import platform
import re
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from multiprocessing import resource_tracker
from multiprocessing.reduction import ForkingPickler
from typing import Any

from ...errors import Cancelled, InvalidInput, Message, OutputError
from ...external.importing import imported
from ...limits import MAX_SCHEDULER_SILENCE_S
from ...resources import version
from ...storage.stores import check_no_credentials
from ...text.plain import error_text, safe_str
from ...waiting import wait_until_done

_log = logging.getLogger(__name__)

_MOST_WORKERS = 1024
#: Module that makes blocks; a worker that can import it has all that it needs.
_MAKING = f"{__package__}.block"


@dataclass
class Engine:
    """Executor of blocks.

    Parameters
    ----------
    executor : Executor
        Executor whose workers have TerrAInav; they may be processes of other machines.
    slots : callable
        Returns the number of blocks that the executor can run at once at present.
    in_process : bool
        Whether the workers are threads of this process.
    workers : int
        Number of images made at once in each block.
    dashboard : str
        Address of the dashboard, or empty.
    """

    executor: Executor
    slots: Callable[[], int]
    in_process: bool = False
    workers: int = 1
    dashboard: str = ""

    @classmethod
    def from_executor(cls, executor: Executor | Engine, workers: int | None = None) -> Engine:
        """Engine of any executor; it gets one block at a time unless an attribute states its number of workers."""
        if isinstance(executor, Engine):
            return executor
        count = next(
            (
                int(value)
                for name in ("_max_workers", "num_workers", "max_workers")
                if isinstance(value := getattr(executor, name, None), int)
            ),
            1,
        )
        threads = isinstance(executor, ThreadPoolExecutor)
        return cls(executor, lambda: count, threads, workers or 1)


@contextmanager
def local_engine(workers: int | None = None) -> Iterator[Engine]:
    """Engine of this process, which makes one block after the other on all processors."""
    with ThreadPoolExecutor(1, "terrainav-block") as executor:
        yield Engine(executor, lambda: 1, True, workers or os.cpu_count() or 1)


@contextmanager
def open_engine(text: str) -> Iterator[Engine]:
    """Open the engine that a text names.

    Parameters
    ----------
    text : str
        ``local:N`` for a Dask cluster of N local processes, or ``dask://HOST:PORT`` for a Dask scheduler.

    Raises
    ------
    InvalidInput
        The text names no engine, or has credentials, which the message does not quote.
    OutputError
        Dask is not installed, or no scheduler answers.
    """
    check_no_credentials(
        text, "cluster", Message("credentials are taken from Dask's own configuration"), field="cluster"
    )
    local = re.fullmatch(r"local:([0-9]{1,4})", text)
    remote = re.fullmatch(r"dask://([^\s/]+):([0-9]{1,5})/?", text)
    if local is not None and 1 <= int(local[1]) <= _MOST_WORKERS:
        with _local_cluster(int(local[1])) as engine:
            yield engine
    elif remote is not None and 1 <= int(remote[2]) <= 65535:
        address = f"tcp://{remote[1]}:{remote[2]}"
        _check_scheduler(address, text)
        with _client(address, text) as client:
            yield replace(_cluster_engine(client), slots=_Workers(client).slots)
    else:
        raise InvalidInput(
            # Messages hide a port that is a word, as it may be a password.
            "cluster {0!r}: must be local:N, N processes here up to {1:,}, or such as dask://127.0.0.1:8786",
            text,
            _MOST_WORKERS,
            field="cluster",
        )


def _distributed() -> Any:
    try:
        return imported("distributed")
    except ImportError as missing:
        raise OutputError(
            "clusters: Dask's distributed cannot be imported ({0})",
            missing,
            remedy="get it with: pip install 'terrainav[cluster]'",
        ) from missing


@contextmanager
def _local_cluster(processes: int) -> Iterator[Engine]:
    distributed = _distributed()
    import dask

    settings = {
        # Blocks whose worker dies are retried by the run, in turn and within the provider's limits.
        "distributed.scheduler.allowed-failures": 0,
        # With Dask's default, glibc returns memory after each array, and page faults take half of a worker's time.
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,
    }
    with dask.config.set(settings):
        try:
            cluster = _ignoring_ctrl_c(
                lambda: distributed.LocalCluster(
                    n_workers=processes,
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",
                    silence_logs=50,
                )
            )
        except (MemoryError, Cancelled):
            raise
        except Exception as wrong:
            # Dask passes on any error of the system, such as a lack of processes, ports or threads.
            raise OutputError(
                "cluster local:{0}: its processes cannot be started ({1})", processes, error_text(wrong)
            ) from wrong
        try:
            with _client(cluster.scheduler_address, "local cluster") as client:
                engine = _cluster_engine(client, cluster.dashboard_link if find_spec("bokeh") else "")

                def slots() -> int:
                    count: int = engine.slots()
                    if count < processes:
                        # Dask does not restart a worker that dies while it starts.
                        cluster.scale(processes)
                    return count

                yield replace(engine, slots=slots)
        finally:
            _end(lambda: cluster.sync(_stop_restarting, cluster))
            _end(cluster.close)


def _ignoring_ctrl_c(begin: Callable[[], Any]) -> Any:
    """Call ``begin``, whose processes then ignore Ctrl-C in the terminal, as this process ends them; return its result.

    Ctrl-C is blocked in a thread that calls ``begin``, and processes inherit that. Windows has no blocked signals.
    """
    begun = Future[Any]()

    def run() -> None:
        if hasattr(signal, "pthread_sigmask"):
            # Start the tracker first: starting it later would unblock Ctrl-C in this thread.
            resource_tracker.ensure_running()
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            begun.set_result(begin())
        except BaseException as wrong:  # noqa: BLE001  (raised where the result is awaited)
            begun.set_exception(wrong)

    threading.Thread(target=run, daemon=True).start()
    try:
        wait_until_done(begun, lambda: None)
    except BaseException:
        begun.add_done_callback(lambda it: _end(lambda: it.result().close()))
        raise
    return begun.result()


def _end(close: Callable[[], object]) -> None:
    """Close an object of Dask; errors are ignored, as the blocks are complete."""
    try:
        close()
    except Exception as wrong:  # noqa: BLE001  (Dask passes on any error of its processes)
        _log.debug("the cluster did not end by itself: %s", safe_str(wrong))


async def _stop_restarting(cluster: Any) -> None:
    """Stop Dask from restarting workers, and wait for workers that are starting, which Dask may fail to close.

    Dask mistakes a worker that dies just after its start for the next worker, which has no process yet.
    """
    for nanny in list(cluster.workers.values()):
        nanny.close_gracefully()
        while (worker := nanny.process) is not None and worker.process is not None and worker.process.pid is None:
            await asyncio.sleep(0.01)


def _check_scheduler(address: str, what: str) -> None:
    """Check that a scheduler answers; without a scheduler, Dask's client would wait for minutes and ignore Ctrl-C.

    Raises
    ------
    OutputError
        No scheduler answers.
    """
    core, greeted = _distributed().core, Future[None]()

    async def greet() -> None:
        comm = await core.connect(address, timeout=MAX_SCHEDULER_SILENCE_S)
        try:
            await core.send_recv(comm, op="identity")
        finally:
            comm.abort()

    def run() -> None:
        try:
            asyncio.run(greet())
        except BaseException as wrong:  # noqa: BLE001  (raised where the result is awaited)
            greeted.set_exception(wrong)
        else:
            greeted.set_result(None)

    threading.Thread(target=run, daemon=True).start()
    until_s = time.monotonic() + MAX_SCHEDULER_SILENCE_S

    def look() -> None:
        if time.monotonic() > until_s:
            raise _no_scheduler(what)

    wait_until_done(greeted, look)
    if greeted.exception() is not None:
        raise _no_scheduler(what)


def _no_scheduler(what: str) -> OutputError:
    return OutputError("cluster {0}: no scheduler answers there", what)


@contextmanager
def _client(address: str, what: str) -> Iterator[Any]:
    distributed = _distributed()
    try:
        client = distributed.Client(address, timeout=MAX_SCHEDULER_SILENCE_S, set_as_default=False)
    except Exception as wrong:
        raise _no_scheduler(what) from wrong
    # Silence Dask's log, as the run reports lost connections in one line.
    log = logging.getLogger("distributed.client")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield client
    finally:
        _end(client.close)
        log.setLevel(level)


class _Calls(Executor):
    """Executor that submits calls as tasks of Dask.

    Dask's own executor never completes a call whose worker dies after the call and before the result is fetched.
    """

    def __init__(self, client: Any) -> None:
        self._client = client

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit a call to a worker."""
        task, future = self._client.submit(fn, *args, pure=False, retries=0, **kwargs), Future[Any]()

        def end(_: Any) -> None:
            try:
                complete = partial(future.set_result, task.result())
            except BaseException as wrong:  # noqa: BLE001  (raised where the result is awaited)
                complete = partial(future.set_exception, wrong)
            if future.set_running_or_notify_cancel():
                complete()

        task.add_done_callback(end)
        future.add_done_callback(lambda it: it.cancelled() and task.cancel())
        return future


class _Later:
    """Object whose unpickling makes a call; the pickle has only names, so workers need not have this module."""

    def __init__(self, function: Callable[..., Any], *arguments: object) -> None:
        self._call = function, arguments

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[object, ...]]:
        return self._call


class _Workers:
    """Workers of a scheduler; checks once for each worker that it can make blocks."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._asked: set[str] = set()

    def slots(self) -> int:
        """Number of blocks that the workers can make at once; raises OutputError if a new worker cannot make blocks."""
        threads: dict[str, int] = self._client.nthreads()
        new = sorted(threads.keys() - self._asked)
        if new:
            self._ask(new)
        return sum(threads.values())

    def _ask(self, workers: list[str]) -> None:
        asked = _Later(platform.python_version), _Later(version), _Later(bool, _Later(import_module, _MAKING))
        answers: dict[str, Any] = self._client.run(
            ForkingPickler.loads, bytes(ForkingPickler.dumps(asked)), workers=workers, on_error="return"
        )
        wrong = {worker: problem for worker, one in sorted(answers.items()) if (problem := _problem(one))}
        if wrong:
            worker, problem = next(iter(wrong.items()))
            raise OutputError(
                "cluster: {0:,} of {1:,} workers cannot make blocks: {2} {3}",
                len(wrong),
                len(answers),
                worker,
                problem,
                remedy=Message("install it there: pip install 'terrainav[cluster]=={0}'", version()),
            )
        # A worker that could not be reached is gone, or will be checked again.
        self._asked.update(worker for worker, one in answers.items() if not isinstance(one, OSError))


def _problem(answer: Any) -> Message | None:
    """Problem of a worker, from its answer; None if it can make blocks or did not answer."""
    if isinstance(answer, OSError):
        return None
    if isinstance(answer, ImportError):
        is_ours = (answer.name or "").partition(".")[0] == _MAKING.partition(".")[0]
        return Message("has no TerrAInav") if is_ours else Message("has no {0}, which TerrAInav needs", answer.name)
    if isinstance(answer, BaseException):
        return Message("cannot import TerrAInav ({0}: {1})", type(answer).__name__, str(answer).partition("\n")[0])
    python, found, _ = answer
    if found != version():
        return Message("has TerrAInav {0}, and the run has {1}", found, version())
    if python.split(".")[:2] != platform.python_version().split(".")[:2]:
        return Message("has Python {0}, and the run has {1}", python, platform.python_version())
    return None


def _cluster_engine(client: Any, dashboard: str | None = None) -> Engine:
    shown = client.dashboard_link if dashboard is None else dashboard
    return Engine(
        _Calls(client),
        lambda: sum(client.nthreads().values()),
        dashboard=shown or "",
    )
