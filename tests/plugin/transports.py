"""A server that answers as it is told, and fixtures of tests of QGIS's network stack."""

from __future__ import annotations

import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from qgis.core import (
    Qgis,
    QgsApplication,
    QgsNetworkAccessManager,
    QgsNetworkRequestParameters,
    QgsSettings,
)
from qgis.PyQt.QtWidgets import QApplication
from terrainav.core.imagery.http.transport import Timeouts
from terrainav.terrainav_plugin.network.transport import QgisTransport

# What the promise of ending within half a second may miss on a busy machine, of 20 s and more.
CANCEL_S, BUSY_S = 0.5, 5.0
TIMEOUTS = Timeouts(connect_s=5.0, read_s=5.0, whole_s=10.0)
PICTURE = b"\x89PNG and so on"
USER, PASSWORD = "surveyor", "only for this test"
# Of the profile that the tests run in; the same in every test that uses the authentication database.
MASTER_PASSWORD = "only for this test"


class Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def do_GET(self):
        self.server.seen.append((self.path, {name.lower(): value for name, value in self.headers.items()}))
        code, headers, body = self.server.answers.get(self.path.partition("?")[0], self.server.answer)
        self.send_response(code)
        for name, value in headers.items():
            self.send_header(name, value)
        if code not in (204, 304):
            self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        if code not in (204, 304):
            self.wfile.write(body)

    def do_CONNECT(self):
        self.server.seen.append((self.path, dict(self.headers)))
        self.server.ended.wait(30.0)
        self.close_connection = True

    def log_message(self, *_):
        pass


class Server(ThreadingHTTPServer):
    """Answers every path with the same, or with what is told for it, and notes what it was asked."""

    daemon_threads = True

    def __init__(self):
        super().__init__(("127.0.0.1", 0), Handler)
        self.seen, self.answers, self.answer = [], {}, (200, {"Content-Type": "image/png"}, PICTURE)
        self.ended = threading.Event()

    @property
    def url(self):
        return f"http://127.0.0.1:{self.server_address[1]}"

    def __enter__(self):
        self._serving = threading.Thread(target=self.serve_forever, args=(0.02,), daemon=True)
        self._serving.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.shutdown()
        self.server_close()
        self._serving.join()

    def handle_error(self, *_):
        """Say nothing: clients that go away are part of the tests."""


@pytest.fixture(name="server")
def server_fixture():
    with Server() as running:
        yield running


@pytest.fixture(name="transport_of")
def transport_of_fixture():
    opened = []

    def make(connections=4, timeouts=TIMEOUTS, **options):
        opened.append(QgisTransport(connections, timeouts, **options))
        return opened[-1]

    yield make
    for transport in opened:
        transport.close()


@pytest.fixture(name="told", autouse=True)
def told_fixture():
    """What QGIS tells its log and those who listen to its requests: nothing of ours, as addresses hold keys."""
    heard = []
    log, manager = QgsApplication.messageLog(), QgsNetworkAccessManager.instance()
    logged = log.messageReceived[str, str, Qgis.MessageLevel]
    requested = manager.requestAboutToBeCreated[QgsNetworkRequestParameters]

    def note_message(text, _tag, _level):
        heard.append(text)

    def note_request(parameters):
        heard.append(parameters.request().url().toString())

    logged.connect(note_message)
    requested.connect(note_request)
    yield heard
    QApplication.processEvents()
    logged.disconnect(note_message)
    requested.disconnect(note_request)
    assert QApplication.activeModalWidget() is None
    assert [text for text in heard if "://" in text] == []


@pytest.fixture(name="settings")
def settings_fixture():
    """Set QGIS's settings for one test, as its options dialog does."""
    before = {}
    apply = QgsNetworkAccessManager.instance().setupDefaultProxyAndCache

    def set_value(name, value):
        before.setdefault(name, QgsSettings().value(name))
        QgsSettings().setValue(name, value)
        apply()

    yield set_value
    for name, value in before.items():
        if value is None:
            QgsSettings().remove(name)
        else:
            QgsSettings().setValue(name, value)
    apply()


def threads_here():
    return set(Path("/proc/self/task").iterdir())


def name_of(task):
    try:
        return (task / "comm").read_text(encoding="ascii")
    except OSError:
        return ""  # it has ended meanwhile


def network_threads(before):
    """Qt's threads below the managers of transports that were not there before."""
    return [task for task in threads_here() - before if name_of(task).startswith("QNetworkAccess")]
