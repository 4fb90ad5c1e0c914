"""A server on the loopback for each test that asks services, and no key but what a test sets."""

from __future__ import annotations

import pytest

from tests.support.services import ServiceServer


@pytest.fixture(autouse=True)
def _no_key(monkeypatch):
    monkeypatch.delenv("TERRAINAV_KEY", raising=False)


@pytest.fixture
def server():
    with ServiceServer() as running:
        yield running
