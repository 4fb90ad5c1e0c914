"""Clusters on a busy machine: Dask gives up what has not answered after half a minute."""

from __future__ import annotations

import importlib.util

import pytest

PATIENCE = {"distributed.comm.timeouts.connect": "300 s", "distributed.comm.timeouts.tcp": "300 s"}


@pytest.fixture(scope="package", autouse=True)
def patient_clusters():
    """Let schedulers and workers take their time, also those that are processes of their own."""
    if importlib.util.find_spec("distributed") is None:
        yield
        return
    import dask

    with pytest.MonkeyPatch.context() as environment, dask.config.set(PATIENCE):
        for name, value in PATIENCE.items():
            environment.setenv("DASK_" + name.upper().replace(".", "__"), value)
        yield
