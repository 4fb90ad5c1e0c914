"""QGIS's network stack as a transport: what is sent, what comes back, and that all of it ends."""

from __future__ import annotations

import gzip
import socket
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from PIL import Image
from qgis.core import (
    QgsApplication,
    QgsBlockingNetworkRequest,
    QgsNetworkAccessManager,
)
from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtNetwork import QNetworkRequest
from qgis.PyQt.QtWidgets import QApplication
from terrainav.core.errors import Cancelled, PartError, TerrAInavError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.transport import Timeouts, TransportError, user_agent
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.xyz import XYZSource
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.capture.task import CaptureTask
from terrainav.terrainav_plugin.sources import MissionPlans

from tests.plugin.steps import PATIENCE_MS
from tests.plugin.transports import (  # noqa: F401  (fixtures)
    BUSY_S,
    CANCEL_S,
    PICTURE,
    Handler,
    network_threads,
    server_fixture,
    settings_fixture,
    threads_here,
    told_fixture,
    transport_of_fixture,
)
from tests.support.patterns import decode_position, positions, to_bytes
from tests.support.tileserver import TileServer


def test_what_qgis_itself_tells_of_a_request_is_heard_here(server, told):
    server.answer = (404, {}, b"")
    QgsBlockingNetworkRequest().get(QNetworkRequest(QUrl(server.url + "/?key=secret")))
    QApplication.processEvents()
    assert len([text for text in told if "key=secret" in text]) >= 2
    told.clear()


# --- what is sent, what comes back


def test_requests_name_terrainav_and_ask_for_pictures_as_they_are(server, transport_of, settings):
    settings("qgis/networkAndProxy/userAgent", "Mozilla/5.0")
    transport_of().get(f"{server.url}/a/b%20c.png?key=1%2F2", {"If-None-Match": '"etag"'})
    path, headers = server.seen[0]
    assert path == "/a/b%20c.png?key=1%2F2"
    assert headers["user-agent"] == user_agent()
    assert headers["accept-encoding"] == "identity"
    assert headers["accept"].startswith("image/*")
    assert headers["if-none-match"] == '"etag"'
    assert "cookie" not in headers


@pytest.mark.parametrize("code", [200, 204, 304, 400, 401, 402, 403, 404, 408, 410, 418, 425, 429, 451, 500, 503, 599])
def test_any_status_is_an_answer(server, transport_of, code):
    server.answer = (code, {"Retry-After": "7", "ETag": '"x"', "X-Of-The-Provider": "Grüße"}, PICTURE)
    answer = transport_of().get(server.url + "/")
    assert answer.status == code
    assert answer.body == (b"" if code in (204, 304) else PICTURE)
    assert answer.headers["retry-after"] == "7"
    assert answer.headers["etag"] == '"x"'
    assert all(name == name.lower() for name in answer.headers)


def test_a_server_that_asks_for_a_password_is_not_answered_by_a_dialog(server, transport_of):
    server.answer = (401, {"WWW-Authenticate": 'Basic realm="tiles"'}, b"who are you?")
    answer = transport_of().get(server.url + "/")
    assert answer.status == 401
    assert answer.headers["www-authenticate"] == 'Basic realm="tiles"'


def test_nothing_comes_from_qgis_s_cache_or_goes_there(server, transport_of):
    server.answer = (200, {"Cache-Control": "public, max-age=3600"}, PICTURE)
    cache = QgsNetworkAccessManager.instance().cache()
    before = cache.cacheSize()
    transport = transport_of()
    for _ in range(3):
        assert transport.get(server.url + "/same.png").body == PICTURE
    assert len(server.seen) == 3
    assert cache.cacheSize() == before


def test_a_body_packed_unasked_is_unpacked_within_the_limit(server, transport_of):
    server.answer = (200, {"Content-Encoding": "gzip"}, gzip.compress(PICTURE))
    assert transport_of().get(server.url + "/").body == PICTURE
    server.answer = (200, {"Content-Encoding": "gzip"}, gzip.compress(bytes(1 << 20)))
    with pytest.raises(TransportError, match="an answer of more than 1000000 bytes"):
        transport_of(max_body_bytes=1_000_000).get(server.url + "/")
    server.answer = (200, {"Content-Encoding": "gzip"}, b"not packed")
    with pytest.raises(TransportError, match="a compressed answer that is damaged"):
        transport_of().get(server.url + "/")
    # Qt leaves alone what is packed, because nothing but identity is asked for.
    server.answer = (200, {"Content-Encoding": "br"}, b"packed")
    with pytest.raises(TransportError, match="an answer compressed as br, which was not requested"):
        transport_of().get(server.url + "/")


@pytest.mark.parametrize("more", [0, 1])
def test_the_limit_of_a_body_is_exact(server, transport_of, more):
    server.answer = (200, {}, bytes(300_000 + more))
    transport = transport_of(max_body_bytes=300_000)
    if more:
        with pytest.raises(TransportError, match="an answer of more than 300000 bytes") as raised:
            transport.get(server.url + "/")
        assert not raised.value.again
    else:
        assert len(transport.get(server.url + "/").body) == 300_000


def test_a_body_in_chunks_that_breaks_off_is_no_tile(server, transport_of, monkeypatch):
    tile = to_bytes(positions("satellite", 3, 1, 1, 256), "png")

    def chunks(handler, *, whole):
        handler.send_response(200)
        handler.send_header("Transfer-Encoding", "chunked")
        handler.end_headers()
        half = len(tile) // 2
        handler.wfile.write(b"%x\r\n%s\r\n" % (half, tile[:half]))
        if whole:
            handler.wfile.write(b"%x\r\n%s\r\n0\r\n\r\n" % (len(tile) - half, tile[half:]))
        handler.close_connection = not whole

    window = Window(3, 256, 256, 256, 256)
    template = server.url + "/{z}/{x}/{y}.png"
    monkeypatch.setattr(Handler, "do_GET", lambda handler: chunks(handler, whole=True))
    assert transport_of().get(server.url + "/").body == tile
    monkeypatch.setattr(Handler, "do_GET", lambda handler: chunks(handler, whole=False))
    # Where the end of the connection comes along with the data, Qt takes it for the end of the body.
    with pytest.raises(PartError, match=r"cut off|was lost|broken image"):
        XYZSource(template, client=Client(transport_of(), "tiles", tries=1)).fetch("satellite", window)


def test_redirects_are_followed_five_times(server, transport_of):
    for step in range(6):
        server.answers[f"/{step}"] = (302, {"Location": str(step + 1)}, b"elsewhere")
    client = Client(transport_of(), "P")
    assert client.get(server.url + "/1", "w").body == PICTURE
    assert [path for path, _ in server.seen] == ["/1", "/2", "/3", "/4", "/5", "/6"]
    with pytest.raises(PartError, match="more than 5 redirects"):
        client.get(server.url + "/0", "w")


@pytest.mark.parametrize("url", ["http://", "http://[::1/", "http://a b/"])
def test_what_is_no_url_is_said(transport_of, url):
    with pytest.raises(TransportError, match="the URL is not valid") as raised:
        transport_of().get(url)
    assert not raised.value.again


def test_a_redirect_to_no_url_is_said(server, transport_of):
    server.answer = (302, {"Location": "http://[::1/"}, b"")
    with pytest.raises(PartError, match="redirect to something that is not a URL"):
        Client(transport_of(), "P").get(server.url + "/", "w")


def test_a_server_of_endless_headers_is_asked_no_more(server, transport_of, qtbot, monkeypatch):
    rest = threading.Event()

    def talk(handler):
        server.seen.append((handler.path, {}))
        handler.send_response(200)
        for number in range(1000):
            handler.send_header(f"X-{number}", "of no use")
        handler.send_header("Content-Length", "2")
        handler.end_headers()
        # The head is enough to end all that is under way.
        rest.wait(30.0)

    monkeypatch.setattr(Handler, "do_GET", talk)
    transport = transport_of(timeouts=Timeouts(20.0, 20.0, 20.0))
    with ThreadPoolExecutor(4) as pool:
        asked = [pool.submit(transport.get, server.url + "/") for _ in range(4)]
        qtbot.waitUntil(lambda: all(one.done() for one in asked), timeout=PATIENCE_MS)
        rest.set()
    failures = {str(one.exception()) for one in asked}
    assert failures == {"an answer of more than 100 header lines"}
    before = len(server.seen)
    with pytest.raises(TransportError, match="an answer of more than 100 header lines") as raised:
        transport.get(server.url + "/")
    assert not raised.value.again
    assert len(server.seen) == before <= 4


# --- ends


class Waiting:
    """A server that lets clients wait where HTTP has not begun yet."""

    def __init__(self, bytes_first=b""):
        self._listening = socket.create_server(("127.0.0.1", 0))
        self._first = bytes_first
        self.port = self._listening.getsockname()[1]
        self._clients = []
        self.asked = threading.Event()
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                client, _ = self._listening.accept()
            except OSError:
                return
            self._clients.append(client)
            client.sendall(self._first)
            self.asked.set()

    def close(self):
        self._listening.shutdown(socket.SHUT_RDWR)
        self._listening.close()
        for client in self._clients:
            client.close()


@pytest.fixture
def waiting():
    opened = Waiting()
    yield opened
    opened.close()


def states(waiting):
    """Addresses at which a request gets no further, by what it waits for."""
    return {
        "handshake of TLS": f"https://localhost:{waiting.port}/",
        "first line": f"http://127.0.0.1:{waiting.port}/",
        "tunnel of the proxy": "https://tiles.invalid/",
        "proxy": "http://tiles.invalid/",
    }


@pytest.mark.parametrize("state", ["handshake of TLS", "first line", "tunnel of the proxy", "proxy"])
def test_a_request_ends_in_time_whatever_it_waits_for(waiting, transport_of, settings, qtbot, state):
    settings("proxy/proxyEnabled", True)
    settings("proxy/proxyHost", "127.0.0.1")
    settings("proxy/proxyPort", str(waiting.port))
    settings("proxy/noProxyUrls", ["http://127.0.0.1", "https://localhost"])
    transport = transport_of(timeouts=Timeouts(30.0, 30.0, 60.0))
    outcome = []

    def ask():
        try:
            transport.get(states(waiting)[state])
        except TerrAInavError as failure:
            outcome.append((time.monotonic(), failure))

    asking = threading.Thread(target=ask)
    asking.start()
    qtbot.waitUntil(waiting.asked.is_set, timeout=PATIENCE_MS)
    # From here on the main thread does nothing: nobody waits for it.
    time.sleep(0.1)
    asked = time.monotonic()
    transport.close()
    assert time.monotonic() - asked < CANCEL_S + BUSY_S
    asking.join(10.0)
    ended, failure = outcome[0]
    assert isinstance(failure, Cancelled)
    assert ended - asked < CANCEL_S + BUSY_S


def test_silence_is_given_up_in_time_and_says_how_long(waiting, transport_of, settings):
    settings("proxy/proxyEnabled", False)
    began = time.monotonic()
    with pytest.raises(TransportError, match=r"no answer from localhost for 0\.3 s") as raised:
        transport_of(timeouts=Timeouts(60.0, 0.3, 60.0)).get(f"https://localhost:{waiting.port}/")
    assert raised.value.again
    assert 0.3 <= time.monotonic() - began < 0.3 + CANCEL_S + BUSY_S


def test_a_closed_transport_starts_nothing(server, transport_of):
    transport = transport_of()
    transport.close()
    transport.close()
    with pytest.raises(Cancelled):
        transport.get(server.url + "/")
    assert server.seen == []


@pytest.mark.thorough
def test_a_capture_in_a_task_gets_every_pixel_right(qtbot, tmp_path):
    with TileServer() as tiles:
        key = "odd/+secret&key"
        mission = Mission(Box(35.14, -89.87, 35.131, -89.856), agl_m=120.0, source=tiles.url_template + "?token={key}")
        steps = plan(mission, PixelGrid(256, max_zoom=22, native_zoom=22))
        tiles.fail("500", share=0.1, times=1)
        tiles.fail("reset", share=0.1, times=1)
        before = threads_here()
        task = CaptureTask(MissionPlans(mission, {"": steps}), tmp_path / "dataset", {"": key})
        ended = []
        task.ended.connect(ended.append)
        QgsApplication.taskManager().addTask(task)
        qtbot.waitUntil(lambda: bool(ended), timeout=PATIENCE_MS)
        assert (task.error, task.trace) == ("", "")
        assert task.result.written == len(steps)
        assert tiles.user_agents == {user_agent()}
        for index in (0, len(steps) // 2, len(steps) - 1):
            picture = tmp_path / "dataset" / "satellite" / f"{steps.names[index]}.{mission.output.image_format}"
            columns, rows = decode_position(np.asarray(Image.open(picture)))
            assert np.array_equal(columns[0], (steps.windows.left_px[index] + np.arange(columns.shape[1])) % 4096)
            assert np.array_equal(rows[:, 0], (steps.windows.top_px[index] + np.arange(rows.shape[0])) % 4096)
    qtbot.waitUntil(lambda: not network_threads(before), timeout=PATIENCE_MS)


def test_a_task_that_waits_for_the_network_ends_when_it_is_cancelled(qtbot, tmp_path):
    with TileServer() as tiles:
        mission = Mission(Box(35.14, -89.87, 35.131, -89.856), agl_m=120.0, source=tiles.url_template)
        tiles.fail("stall")
        steps = plan(mission, PixelGrid(256, max_zoom=22, native_zoom=22))
        task = CaptureTask(MissionPlans(mission, {"": steps}), tmp_path / "dataset", {"": None})
        ended = []
        task.ended.connect(lambda _task: ended.append(time.monotonic()))
        QgsApplication.taskManager().addTask(task)
        qtbot.waitUntil(lambda: sum(tiles.requests.values()) >= 8, timeout=PATIENCE_MS)
        asked = time.monotonic()
        task.cancel()
        qtbot.waitUntil(lambda: bool(ended), timeout=PATIENCE_MS)
        assert ended[0] - asked < CANCEL_S + BUSY_S
        assert task.error == ""
