"""Who runs blocks: what their processes are set to."""

import os

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
