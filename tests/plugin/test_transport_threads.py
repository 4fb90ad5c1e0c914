"""QGIS's network stack as a transport between threads: nobody waits for another, nothing stays, nothing meets."""

from __future__ import annotations

import gc
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from types import SimpleNamespace

import pytest
from qgis.PyQt.QtCore import QTimer
from qgis.PyQt.QtWidgets import QDialogButtonBox
from terrainav.core.errors import Cancelled
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.transport import Timeouts
from terrainav.terrainav_plugin.network import worker as network_worker
from terrainav.terrainav_plugin.network.transport import QgisTransport

from tests.plugin.steps import PATIENCE_MS
from tests.plugin.transports import (  # noqa: F401  (fixtures)
    BUSY_S,
    CANCEL_S,
    PICTURE,
    Handler,
    network_threads,
    server_fixture,
    threads_here,
    told_fixture,
    transport_of_fixture,
)
from tests.support.tileserver import TileServer

# Enough for memory of replies to be used again many times.
MANY_REPLIES = 600
TRANSPORTS, TILES_EACH = 20, 60
# For all of them; a machine that needs longer has done fewer.
STRESS_S = 8.0


def wait_until(condition, seconds=10.0):
    until = time.monotonic() + seconds
    while not condition() and time.monotonic() < until:
        time.sleep(0.02)
    return condition()


def tile(tiles, x):
    return tiles.url_template.format(z=12, x=x, y=7)


@pytest.mark.off_main
def test_sixteen_threads_share_sixteen_connections_and_leave_no_thread():
    with TileServer(latency_s=0.02) as tiles:
        before = threads_here()
        transport = QgisTransport(16)
        with ThreadPoolExecutor(16) as pool:
            fetched = list(pool.map(lambda x: transport.get(tiles.url_template.format(z=12, x=x, y=7)), range(400)))
        assert all(answer.status == 200 for answer in fetched)
        assert len(tiles.tile_requests) == 400
        assert set(tiles.tile_requests.values()) == {1}
        assert tiles.connections <= 16
        transport.close()
    assert wait_until(lambda: not network_threads(before))


def test_replies_outlive_what_the_main_thread_is_told_of_earlier_ones(qtbot):
    with TileServer() as tiles, closing(QgisTransport(8)) as transport, ThreadPoolExecutor(8) as pool:
        asked = [pool.submit(transport.get, tiles.url_template.format(z=12, x=x, y=7)) for x in range(MANY_REPLIES)]
        # Meanwhile the main thread has work of its own, and hears late of what was destroyed in others.
        qtbot.waitUntil(lambda: time.sleep(0.002) or all(one.done() for one in asked), timeout=PATIENCE_MS)
        assert {one.result().status for one in asked} == {200}


@pytest.mark.off_main
def test_a_transport_that_nobody_closes_ends_with_its_last_user(server):
    before = threads_here()
    transport = QgisTransport(4)
    transport.get(server.url + "/")
    assert network_threads(before)
    del transport
    assert wait_until(lambda: not network_threads(before))


@pytest.mark.off_main
def test_workers_go_with_their_transports(server):
    before = set(network_worker._ALIVE)
    for how in ("closed", "left"):
        transport = QgisTransport(4)
        assert transport.get(server.url + "/").body == PICTURE
        assert len(network_worker._ALIVE - before) == 1
        if how == "closed":
            transport.close()
        del transport
        gc.collect()
        assert wait_until(lambda: before >= network_worker._ALIVE)


def test_time_in_which_the_main_thread_is_busy_counts_for_no_limit(server, transport_of, qtbot, monkeypatch):
    released, right = threading.Event(), Handler.do_GET

    def held(handler):
        if handler.path == "/":
            server.seen.append((handler.path, {}))
            released.wait(30.0)
        else:
            # So that the time is looked at before the answer is there.
            time.sleep(0.3)
        right(handler)

    monkeypatch.setattr(Handler, "do_GET", held)
    server.answers["/"] = (302, {"Location": "/there"}, b"")
    ahead_s = [0.0]
    clock = SimpleNamespace(monotonic=lambda: time.monotonic() + ahead_s[0])
    monkeypatch.setattr(network_worker, "time", clock)
    # Longer than a busy machine takes, and less than the main thread is busy by that clock.
    transport = transport_of(timeouts=Timeouts(30.0, 30.0, 60.0))
    with ThreadPoolExecutor(1) as pool:
        asked = pool.submit(Client(transport, "P").get, server.url + "/", "w")
        qtbot.waitUntil(lambda: bool(server.seen), timeout=PATIENCE_MS)
        released.set()
        ahead_s[0] = 600.0
        qtbot.waitUntil(asked.done, timeout=PATIENCE_MS)
    assert asked.result().body == PICTURE


def test_all_who_wait_are_told_of_the_end_while_the_main_thread_is_busy(qtbot):
    with TileServer() as tiles, ThreadPoolExecutor(8) as pool:
        tiles.fail("stall")
        transport = QgisTransport(8)
        asked = [pool.submit(transport.get, tile(tiles, x)) for x in range(8)]
        qtbot.waitUntil(lambda: sum(tiles.requests.values()) == 8, timeout=PATIENCE_MS)
        began = time.monotonic()
        transport.close()
        ends = [one.exception(timeout=10.0) for one in asked]
        assert time.monotonic() - began < CANCEL_S + BUSY_S
    assert {type(end) for end in ends} == {Cancelled}


def test_transports_come_and_go_while_the_main_thread_makes_objects_of_its_own(qtbot):
    """PyQt's list of objects that Qt has made is that of both: a meeting there would end QGIS."""
    buttons = QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
    wrapped = []

    def wrap():
        # Buttons that Qt makes, that Python sees and that Qt destroys.
        box = QDialogButtonBox(buttons)
        wrapped.extend(box.buttons())
        del wrapped[:-10]
        box.deleteLater()

    statuses, ends, began = [], [], time.monotonic()

    def fetch(transport, url):
        try:
            statuses.append(transport.get(url).status)
        except Cancelled:
            ends.append(url)

    def open_and_close():
        for number in range(TRANSPORTS):
            if time.monotonic() - began > STRESS_S:
                return
            with ThreadPoolExecutor(8) as pool:
                with closing(QgisTransport(8)) as transport:
                    asked = [pool.submit(fetch, transport, tile(tiles, x)) for x in range(TILES_EACH)]
                    # Every other one is closed in the middle.
                    for one in asked[: TILES_EACH // (1 + number % 2)]:
                        one.result()
                for one in asked:
                    one.result()

    timer = QTimer()
    timer.timeout.connect(wrap)
    timer.start(0)
    with TileServer() as tiles, ThreadPoolExecutor(1) as pool:
        stress = pool.submit(open_and_close)
        qtbot.waitUntil(stress.done, timeout=PATIENCE_MS)
        stress.result()
    timer.stop()
    assert set(statuses) == {200}
    assert len(statuses) > TILES_EACH
    assert ends
    qtbot.waitUntil(lambda: not network_worker._ALIVE, timeout=PATIENCE_MS)
