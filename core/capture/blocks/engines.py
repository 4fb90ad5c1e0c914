"""Who runs blocks: threads here, processes here, a cluster that is there; no scheduler of our own."""

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
from ...text.plain import one_line, words_of
from ...waiting import wait_for

_log = logging.getLogger(__name__)

_DASK = re.compile(r"dask://([^\s/]+):([0-9]{1,5})/?")
_LOCAL = re.compile(r"local:([0-9]{1,4})")
_MOST_WORKERS, _MOST_PORT = 1024, 65535
#: What makes blocks, with all that it needs.
_MAKING = f"{__package__}.block"
#: Of what Dask says, which may be pages.
_SAID_CHARACTERS = 120


@dataclass
class Engine:
    """What runs blocks.

    Parameters
    ----------
    executor : Executor
        Its workers need TerrAInav, and may be processes of other machines.
    slots : callable
        How many blocks it runs at once, now.
    in_process : bool
        Whether its workers are threads of this process.
    workers : int
        Images that are made at once in each block.
    dashboard : str
        Address of a page that shows what it does; empty where there is none.
    """

    executor: Executor
    slots: Callable[[], int]
    in_process: bool = False
    workers: int = 1
    dashboard: str = ""

    @classmethod
    def of(cls, executor: Executor | Engine, workers: int | None = None) -> Engine:
        """Engine of any executor: one that says how many workers it has, or is asked for one block at a time."""
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
def here(workers: int | None = None) -> Iterator[Engine]:
    """Engine of this process, which makes one block after the other on all processors."""
    with ThreadPoolExecutor(1, "terrainav-block") as executor:
        yield Engine(executor, lambda: 1, True, workers or os.cpu_count() or 1)


@contextmanager
def open_engine(text: str) -> Iterator[Engine]:
    """Open the engine that a text names.

    Parameters
    ----------
    text : str
        ``local:N``, a cluster of Dask's of N processes here; ``dask://HOST:PORT``, a scheduler of Dask's.

    Raises
    ------
    InvalidInput
        Another text, or one with credentials in it, which are not quoted.
    OutputError
        Dask is not installed, or no scheduler is there.
    """
    check_no_credentials(
        text, "cluster", Message("credentials are taken from Dask's own configuration"), field="cluster"
    )
    local, remote = _LOCAL.fullmatch(text), _DASK.fullmatch(text)
    if local is not None and 1 <= int(local[1]) <= _MOST_WORKERS:
        with _local_cluster(int(local[1])) as engine:
            yield engine
    elif remote is not None and 1 <= int(remote[2]) <= _MOST_PORT:
        address = f"tcp://{remote[1]}:{remote[2]}"
        _check_scheduler(address, text)
        with _client(address, text) as client:
            yield replace(_engine_of(client), slots=_Workers(client).slots)
    else:
        raise InvalidInput(
            # An address with a word for its port is printed with asterisks, as a password may be that word.
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
        # A block whose worker dies is ours to run again, in its turn and with its share of the provider's rate.
        "distributed.scheduler.allowed-failures": 0,
        # Dask's own has glibc give memory back after each array, which images then fault in again, page by page:
        # half of a worker's processor time.
        "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,
    }
    with dask.config.set(settings):
        try:
            cluster = _deaf_to_ctrl_c(
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
            # Dask has no error of its own for processes, ports and threads that the system does not give it.
            raise OutputError(
                "cluster local:{0}: its processes cannot be started ({1}: {2})",
                processes,
                type(wrong).__name__,
                one_line(words_of(wrong), _SAID_CHARACTERS),
            ) from wrong
        try:
            with _client(cluster.scheduler_address, "local cluster") as client:
                engine = _engine_of(client, cluster.dashboard_link if find_spec("bokeh") else "")

                def slots() -> int:
                    there: int = engine.slots()
                    if there < processes:
                        # Dask begins a worker again that dies, but gives it up if it dies once more on its way.
                        cluster.scale(processes)
                    return there

                yield replace(engine, slots=slots)
        finally:
            _end(lambda: cluster.sync(_begin_no_worker_again, cluster))
            _end(cluster.close)


def _deaf_to_ctrl_c(begin: Callable[[], Any]) -> Any:
    """Result of what begins processes, which do not hear the Ctrl-C of their terminal: this process ends them.

    Threads and processes take over what the thread that begins them does not hear. Windows has no such thing.
    """
    begun = Future[Any]()

    def run() -> None:
        if hasattr(signal, "pthread_sigmask"):
            # Begun later, it would have this thread hear Ctrl-C again.
            resource_tracker.ensure_running()
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            begun.set_result(begin())
        except BaseException as wrong:  # noqa: BLE001  (whatever it is, it is told where it is waited for)
            begun.set_exception(wrong)

    threading.Thread(target=run, daemon=True).start()
    try:
        wait_for(begun, lambda: None)
    except BaseException:
        begun.add_done_callback(lambda it: _end(lambda: it.result().close()))
        raise
    return begun.result()


def _end(close: Callable[[], object]) -> None:
    """Close something of Dask's. What has been made is whole by then: a fault of its ending is none of the run."""
    try:
        close()
    except Exception as wrong:  # noqa: BLE001  (Dask hands on whatever its processes end of)
        _log.debug("the cluster did not end by itself: %s", words_of(wrong))


async def _begin_no_worker_again(cluster: Any) -> None:
    """Tell Dask to leave dead workers dead, and wait for those that it is beginning: it fails to close some of them.

    One that dies just as it has begun is taken for the next, which has no process yet.
    """
    for nanny in list(cluster.workers.values()):
        nanny.close_gracefully()
        while (
            (worker := nanny.process) is not None
            and worker.process is not None
            and worker.process.pid is None
        ):
            await asyncio.sleep(0.01)


def _check_scheduler(address: str, what: str) -> None:
    """Greet a scheduler: Dask's client takes minutes to give up one that says nothing, and hears no Ctrl-C meanwhile.

    Raises
    ------
    OutputError
        There is none.
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
        except BaseException as wrong:  # noqa: BLE001  (whatever it is, it is told where it is waited for)
            greeted.set_exception(wrong)
        else:
            greeted.set_result(None)

    threading.Thread(target=run, daemon=True).start()
    until_s = time.monotonic() + MAX_SCHEDULER_SILENCE_S

    def look() -> None:
        if time.monotonic() > until_s:
            raise _no_scheduler(what)

    wait_for(greeted, look)
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
    # What becomes of a connection is told in one line by who waits for blocks.
    log = logging.getLogger("distributed.client")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield client
    finally:
        _end(client.close)
        log.setLevel(level)


class _Calls(Executor):
    """Calls as tasks of Dask's.

    Dask's own executor forgets a call whose worker dies after it is done and before its result is fetched: nobody would
    be told of its end.
    """

    def __init__(self, client: Any) -> None:
        self._client = client

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a worker call a function."""
        task, future = self._client.submit(fn, *args, pure=False, retries=0, **kwargs), Future[Any]()

        def end(_: Any) -> None:
            try:
                tell = partial(future.set_result, task.result())
            except BaseException as wrong:  # noqa: BLE001  (whatever it is, it is told where it is waited for)
                tell = partial(future.set_exception, wrong)
            if future.set_running_or_notify_cancel():
                tell()

        task.add_done_callback(end)
        future.add_done_callback(lambda it: it.cancelled() and task.cancel())
        return future


class _Later:
    """Call whose pickle makes it where that is read: by names alone, so that a worker need not know this module."""

    def __init__(self, function: Callable[..., Any], *arguments: object) -> None:
        self._call = function, arguments

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[object, ...]]:
        return self._call


class _Workers:
    """Workers that others have begun, each of which is asked once whether it can make blocks."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._asked: set[str] = set()

    def slots(self) -> int:
        """How many blocks they make at once, now; raises OutputError where one that has come cannot make any."""
        there: dict[str, int] = self._client.nthreads()
        new = sorted(there.keys() - self._asked)
        if new:
            self._ask(new)
        return sum(there.values())

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
        # One that was not to be reached has gone, or is asked again.
        self._asked.update(worker for worker, one in answers.items() if not isinstance(one, OSError))


def _problem(answer: Any) -> Message | None:
    """What a worker that has answered lacks, or has in another version; None where it can make blocks."""
    if isinstance(answer, OSError):
        return None
    if isinstance(answer, ImportError):
        is_own = (answer.name or "").partition(".")[0] == _MAKING.partition(".")[0]
        return (
            Message("has no TerrAInav")
            if is_own
            else Message("has no {0}, which TerrAInav needs", answer.name)
        )
    if isinstance(answer, BaseException):
        return Message(
            "cannot import TerrAInav ({0}: {1})", type(answer).__name__, str(answer).partition("\n")[0]
        )
    python, own, _ = answer
    if own != version():
        return Message("has TerrAInav {0}, and the run has {1}", own, version())
    if python.split(".")[:2] != platform.python_version().split(".")[:2]:
        return Message("has Python {0}, and the run has {1}", python, platform.python_version())
    return None


def _engine_of(client: Any, dashboard: str | None = None) -> Engine:
    shown = client.dashboard_link if dashboard is None else dashboard
    return Engine(
        _Calls(client),
        lambda: sum(client.nthreads().values()),
        dashboard=shown or "",
    )
