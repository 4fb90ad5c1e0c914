"""Who runs blocks: what their processes are set to."""

import os
import time

import pytest
from terrainav.core.capture.blocks.engines import open_engine

pytest.importorskip("distributed", reason="needs Dask's distributed")
#: Dask's own warnings, of ports that are taken and workers that are slow to end, are none of ours.
pytestmark = pytest.mark.filterwarnings("default")


def test_workers_keep_the_memory_of_arrays(monkeypatch):
    # As Dask sets it, it takes half of the workers' processor time; who has set it himself keeps that.
    monkeypatch.delenv("MALLOC_TRIM_THRESHOLD_", raising=False)
    with open_engine("local:1") as engine:
        assert engine.executor.submit(os.environ.get, "MALLOC_TRIM_THRESHOLD_").result() is None


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
        until_s = time.monotonic() + 60.0
        while not engine.slots() and time.monotonic() < until_s:
            time.sleep(0.1)
        (second,) = client.nthreads()
        assert second != first
        assert engine.executor.submit(os.environ.get, "MALLOC_TRIM_THRESHOLD_").result() is None
