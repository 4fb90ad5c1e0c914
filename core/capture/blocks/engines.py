"""Who runs blocks: threads here, processes here, a cluster that is there; no scheduler of our own."""

from __future__ import annotations

import asyncio
import logging
import os
import re
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec
from typing import Any

from ...errors import InvalidInput, Message, OutputError
from ...stores import check_no_credentials

_DASK = re.compile(r"dask://([^\s/]+):(\d+)/?")
_LOCAL = re.compile(r"local:(\d+)")
_MOST_WORKERS = 1024
#: Seconds within which a scheduler answers that is there.
_ANSWER_S = 10.0


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
    elif remote is not None:
        with _client(f"tcp://{remote[1]}:{remote[2]}", text) as client:
            yield _engine_of(client)
    else:
        raise InvalidInput(
            "cluster {0!r}: must be local:N, N processes of this machine up to {1:,}, or dask://HOST:PORT",
            text,
            _MOST_WORKERS,
            field="cluster",
        )


def _distributed() -> Any:
    try:
        import distributed
    except ImportError as missing:
        raise OutputError(
            "clusters: Dask's distributed cannot be imported ({0})",
            missing,
            remedy="get it with: pip install 'terrainav[cluster]'",
        ) from missing
    return distributed


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
        cluster = distributed.LocalCluster(
            n_workers=processes,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=50,
        )
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
            cluster.sync(_begin_no_worker_again, cluster)
            cluster.close()


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


@contextmanager
def _client(address: str, what: str) -> Iterator[Any]:
    distributed = _distributed()
    try:
        client = distributed.Client(address, timeout=_ANSWER_S, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as wrong:
        raise OutputError("cluster {0}: no scheduler answers there", what) from wrong
    # What becomes of a connection is told in one line by who waits for blocks.
    log = logging.getLogger("distributed.client")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        yield client
    finally:
        client.close()
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


def _engine_of(client: Any, dashboard: str | None = None) -> Engine:
    shown = client.dashboard_link if dashboard is None else dashboard
    return Engine(
        _Calls(client),
        lambda: sum(client.nthreads().values()),
        dashboard=shown or "",
    )
