"""The transport over TLS, through a proxy, and what it leaves behind."""

from __future__ import annotations

import contextlib
import gc
import logging
import re
import shutil
import socket
import ssl
import subprocess
import threading
import time
import tracemalloc

import numpy as np
import pytest
from terrainav.core.errors import Cancelled, PartError
from terrainav.core.imagery.http import requests_transport
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.requests_transport import RequestsTransport
from terrainav.core.imagery.http.transport import Timeouts, TransportError
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.xyz import XYZSource

from tests.support.patterns import positions
from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

TILE = Window(5, 256, 512, 256, 256)
RIGHT = positions("satellite", 5, 1, 2, 256)


@pytest.fixture(scope="module")
def certificate(tmp_path_factory):
    if shutil.which("openssl") is None:
        pytest.skip("no openssl command to make a certificate with")
    folder = tmp_path_factory.mktemp("tls")
    files = folder / "certificate.pem", folder / "key.pem"
    subject = ["-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1"]
    made = [
        "openssl",
        "req",
        "-x509",
        "-newkey",
        "rsa:2048",
        "-nodes",
        "-days",
        "2",
        "-out",
        files[0],
        "-keyout",
        files[1],
    ]
    subprocess.run([*made, *subject], check=True, capture_output=True)
    return files


@pytest.fixture
def tls_server(certificate):
    server = TileServer()
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(*certificate)
    server._http.socket = context.wrap_socket(server._http.socket, server_side=True)
    with server:
        yield server


def source_of(server, tries=2):
    client = Client(RequestsTransport(2, Timeouts(5.0, 20.0, 60.0)), "P", connections=2, tries=tries, first_wait_s=0.01)
    return XYZSource(server.url_template.replace("http:", "https:"), client=client)


def test_tls_with_a_certificate_the_environment_trusts(tls_server, certificate, monkeypatch):
    monkeypatch.setenv("REQUESTS_CA_BUNDLE", str(certificate[0]))
    source = source_of(tls_server)
    for _ in range(5):
        assert np.array_equal(source.fetch("", TILE), RIGHT)
    assert tls_server.connections == 1
    source.close()


def test_tls_without_trust(tls_server, monkeypatch):
    monkeypatch.delenv("REQUESTS_CA_BUNDLE", raising=False)
    monkeypatch.delenv("CURL_CA_BUNDLE", raising=False)
    source = source_of(tls_server)
    with pytest.raises(PartError, match=r"no trusted connection to 127\.0\.0\.1 \(TLS\)"):
        source.fetch("", TILE)
    assert not tls_server.requests
    source.close()


@pytest.mark.parametrize("kind", ["stall", "stall-mid-body"])
def test_a_wait_over_tls_can_be_cancelled(tls_server, certificate, monkeypatch, kind):
    monkeypatch.setenv("REQUESTS_CA_BUNDLE", str(certificate[0]))
    tls_server.fail(kind)
    source = source_of(tls_server)
    threading.Timer(0.3, source.close).start()
    began = time.monotonic()
    with pytest.raises(Cancelled):
        source.fetch("", TILE)
    # Of the 20 s of the silence it would wait for.
    assert time.monotonic() - began < 10.0


def test_requests_go_through_the_proxy_of_the_environment(monkeypatch):
    with TileServer() as proxy:
        monkeypatch.setenv("http_proxy", proxy.url)
        monkeypatch.delenv("no_proxy", raising=False)
        monkeypatch.delenv("NO_PROXY", raising=False)
        source = XYZSource("http://tiles.invalid/{z}/{x}/{y}.png")
        for _ in range(3):
            assert np.array_equal(source.fetch("", TILE), RIGHT)
        assert list(proxy.requests) == ["http://tiles.invalid/5/1/2.png"]
        assert proxy.connections == 1
        source.close()


def test_an_answer_of_any_status_comes_with_its_headers():
    with TileServer() as server:
        server.fail("429-seconds")
        transport = RequestsTransport()
        answer = transport.get(f"{server.url}/5/1/2.png")
        transport.close()
    assert (answer.status, answer.body, answer.headers["retry-after"]) == (429, b"slow down", "1")


def test_nothing_is_asked_of_a_closed_transport():
    with TileServer(latency_s=0.5) as server:
        transport = RequestsTransport()
        transport.close()
        with pytest.raises((Cancelled, TransportError)):
            transport.get(f"{server.url}/5/1/2.png")


def test_a_transport_leaves_no_thread_and_no_filter():
    logger = logging.getLogger("urllib3.connectionpool")
    filters, threads = len(logger.filters), set(threading.enumerate())
    with TileServer() as server:
        closed, dropped = RequestsTransport(), RequestsTransport()
        for transport in (closed, dropped):
            transport.get(f"{server.url}/5/1/2.png")
        closed.close()
        del transport, dropped
    gc.collect()
    assert len(logger.filters) == filters
    deadline = time.monotonic() + 20.0
    while left := {thread for thread in threading.enumerate() if thread.name.startswith("terrainav-")} - threads:
        assert time.monotonic() < deadline, left
        time.sleep(0.05)


def test_others_logs_are_left_alone(caplog):
    import requests

    caplog.set_level("DEBUG")
    with TileServer() as server:
        transport = RequestsTransport()
        transport.get(f"{server.url}/5/1/2.png?token=ours")
        requests.get(f"{server.url}/5/1/2.png?token=theirs", timeout=10)
        transport.close()
    assert "theirs" in caplog.text
    assert "ours" not in caplog.text


def test_a_request_that_outlives_its_transport_logs_nothing_either(caplog):
    caplog.set_level("DEBUG")
    logger = logging.getLogger("urllib3.connectionpool")
    filters = len(logger.filters)
    transport = RequestsTransport()
    with transport._watch.exchange(time.monotonic() + 60.0):
        transport.close()
        logger.debug("GET /5/1/2.png?token=ours")
    assert "ours" not in caplog.text
    assert len(logger.filters) == filters


@pytest.fixture
def talking():
    """Give what makes a server that sends the same bytes to everybody, without end if the last of them may repeat."""
    opened = []

    def make(first, repeated=b""):
        listening = socket.create_server(("127.0.0.1", 0))
        opened.append(listening)

        def talk():
            with contextlib.suppress(OSError):
                while True:
                    client, _ = listening.accept()
                    with client, contextlib.suppress(OSError):
                        client.recv(1 << 16)
                        client.sendall(first)
                        while repeated:
                            client.sendall(repeated)

        threading.Thread(target=talk, daemon=True).start()
        return f"http://127.0.0.1:{listening.getsockname()[1]}/"

    yield make
    for listening in opened:
        listening.shutdown(socket.SHUT_RDWR)
        listening.close()


OK = b"HTTP/1.1 200 OK\r\n"
CHUNKED = OK + b"Transfer-Encoding: chunked\r\n\r\n"
FILLING = bytes(1 << 16).replace(b"\0", b"a")


@pytest.mark.parametrize(
    ("first", "repeated"),
    sampled(
        [
            (OK + b"\r\n", FILLING),
            (OK + b"Content-Length: 99999999999999999999\r\n\r\n", FILLING),
            (CHUNKED + b"1;", FILLING),
            (CHUNKED + b"-1\r\n", FILLING),
            (CHUNKED + b"7fffffffffffffff\r\n", FILLING),
            (CHUNKED, b"4\r\naaaa\r\n" * 1000),
            (CHUNKED + b"0\r\n", b"Trailer: 1\r\n" * 1000),
            (OK + b"X: ", FILLING),
            (OK, b"X: 1\r\n" * 1000),
            (b"", b"HTTP/1.1 100 Continue\r\n\r\n" * 1000),
            (b"", FILLING),
        ],
        3,
    ),
    ids="body length chunk-line negative-chunk chunk chunks trailers header headers continue status".split(),
)
def test_an_answer_without_end_ends_in_words_and_takes_no_memory(talking, monkeypatch, first, repeated):
    limit = 1 << 20
    monkeypatch.setattr(requests_transport, "MAX_FRAMING_BYTES", limit)
    transport = RequestsTransport(1, Timeouts(5.0, 5.0, 30.0), max_body_bytes=limit)
    tracemalloc.start()
    try:
        with pytest.raises(TransportError) as raised:
            transport.get(talking(first, repeated))
        _, peak_bytes = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
        transport.close()
    assert re.search("answer of more than|cut off|was lost|header lines", str(raised.value))
    # What is read of one answer at most, while it is being put together.
    assert peak_bytes < 6 * limit
