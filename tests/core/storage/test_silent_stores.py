"""Stores and schedulers that accept and say nothing, or never end: one line in a while, and at once at Ctrl-C."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
from contextlib import contextmanager, suppress
from pathlib import Path
from types import SimpleNamespace

import pytest
from terrainav.core.storage import store_requests

pytest.importorskip("s3fs", reason="needs s3fs")
pytest.importorskip("upath", reason="needs universal_pathlib")
pytest.importorskip("distributed", reason="needs distributed")

ROOT = Path(__file__).resolve().parents[4]
#: Far beyond what any of it takes, and far within the silence that a store may keep where a test leaves it as it is.
PATIENCE_S = 50.0
#: A limit of the program's memory: an endless body fills it if it is read to its end.
MOST_BYTES = 3 << 30
_OBJECT = b"HTTP/1.1 200 OK\r\nContent-Length: 1000\r\nETag: x\r\nLast-Modified: Tue, 01 Jan 2030 00:00:00 GMT\r\n\r\n"
_CHUNKED = b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\nTransfer-Encoding: chunked\r\n\r\n"
_PAGE = (
    '<?xml version="1.0"?><ListBucketResult xmlns="http://s3.amazonaws.com/doc/2006-03-01/"><Name>data</Name>'
    "<IsTruncated>true</IsTruncated><NextContinuationToken>{0}</NextContinuationToken>{1}</ListBucketResult>"
)
_ENTRY = (
    "<Contents><Key>run/{0}.png</Key><LastModified>2030-01-01T00:00:00.000Z</LastModified><ETag>x</ETag>"
    "<Size>1</Size></Contents>"
)


class Hostile:
    """A server that behaves badly in one way, whatever it is asked.

    Attributes
    ----------
    asked : Event
        Set once it has been asked something.
    """

    def __init__(self, way):
        self.asked = threading.Event()
        self._way, self._pages = way, 0
        self._ended = threading.Event()
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self):
        self._ended.set()
        self._listening.close()

    def _accept(self):
        with suppress(OSError):
            while True:
                threading.Thread(target=self._serve, args=(self._listening.accept()[0],), daemon=True).start()

    def _serve(self, connection):
        with connection, suppress(OSError):
            while not self._ended.is_set() and (request := self._request(connection)):
                self.asked.set()
                self._answer(connection, request)

    def _request(self, connection):
        head = b""
        while b"\r\n\r\n" not in head and (got := connection.recv(1 << 16)):
            head += got
            if self._way in ("zeros", "silent"):
                break
        return head

    def _answer(self, connection, request):
        if self._way == "silent":
            self._ended.wait()
        elif self._way == "zeros":
            self._go_on(connection, bytes(1 << 16))
        elif request.startswith(b"HEAD"):
            connection.sendall(_OBJECT)
        elif self._way == "slow":
            connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\n")
            while not self._ended.wait(0.2):
                connection.sendall(b"x")
        elif self._way in ("list", "empty list"):
            self._pages += 1
            entries = (_ENTRY.format(1000 * self._pages + one) for one in range(1000))
            body = _PAGE.format(self._pages, "" if self._way == "empty list" else "".join(entries)).encode()
            connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: %d\r\n\r\n" % len(body) + body)
        else:
            connection.sendall(_CHUNKED)
            self._go_on(connection, b"10000\r\n" + b" " * (1 << 16) + b"\r\n")

    def _go_on(self, connection, block):
        while not self._ended.is_set():
            connection.sendall(block)


@contextmanager
def hostile(way):
    server = Hostile(way)
    try:
        yield server
    finally:
        server.close()


#: A capture, which hears a first Ctrl-C and goes on, unless there is nothing yet.
_CAPTURE = [
    "capture",
    "--coords",
    "35.16_-89.90_35.158_-89.898_120",
    "--max-px",
    "200",
    "--data-dir",
    "s3://data/run",
]
#: The command, which does a piece of code after another in the place of its own work; each prints its code and line.
_PROGRAM = f"""
import os, resource, signal, sys
import s3fs
signal.signal(signal.SIGINT, signal.default_int_handler)
resource.setrlimit(resource.RLIMIT_AS, ({MOST_BYTES}, {MOST_BYTES}))
import terrainav.core.storage.store_requests as requests
from terrainav.core import cli
from terrainav.core.capture.blocks import engines
from terrainav.core.storage.files import open_foreign, read_limited
from terrainav.core.storage.stores import list_folders, get, get_range, is_file, put, list_sizes, store_path
def run(code):
    by_http = store_path(os.environ["AWS_ENDPOINT_URL"] + "/run")
    exec(code, {{**globals(), "place": store_path("s3://data/run"), "by_http": by_http}})
    return 0
def begin_cluster():
    with engines.open_engine("dask://" + os.environ["AWS_ENDPOINT_URL"].partition("//")[2]):
        pass
real_run, cli._run = cli._run, run
for text in sys.argv[1:]:
    port, code = text.split(" ", 1)
    os.environ["AWS_ENDPOINT_URL"] = f"http://127.0.0.1:{{port}}"
    s3fs.S3FileSystem.clear_instance_cache()
    print("ended", cli.main(code), file=sys.stderr, flush=True)
"""


def begun(*tasks):
    """Begin a program that does tasks, each a server and code."""
    environment = {
        **os.environ,
        "AWS_ACCESS_KEY_ID": "a",
        "AWS_SECRET_ACCESS_KEY": "b",
        "AWS_DEFAULT_REGION": "us-east-1",
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    return subprocess.Popen(
        [sys.executable, "-c", _PROGRAM, *(f"{server.port} {code}" for server, code in tasks)],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def printed_by(process):
    """Lines of a program that ends by itself."""
    try:
        return process.communicate(timeout=PATIENCE_S)[1].splitlines()
    finally:
        process.kill()


def test_a_store_that_says_next_to_nothing_is_given_up():
    few = "requests.MAX_STORE_SILENCE_S = 1.0; "
    with hostile("silent") as silent, hostile("slow") as slow, hostile("empty list") as empty:
        tasks = [
            (silent, "is_file(place)"),
            (silent, "list_sizes(place)"),
            (silent, "put(place, b'1')"),
            (slow, "get(place, 1000)"),
            (slow, "get_range(place, 0, 1000)"),
            (empty, "list_sizes(place)"),
            (silent, "is_file(by_http)"),
            (silent, "list_sizes(by_http)"),
            (slow, "get(by_http, 1000)"),
        ]
        printed = printed_by(begun(*((server, few + code) for server, code in tasks)))
    assert printed[1::2] == ["ended 3"] * len(tasks), printed
    for line in printed[::2]:
        assert re.fullmatch(r"terrainav: (s3://data|http://[\d.:]+)/run: only \d+ bytes have come within \d s", line), (
            line
        )


def test_what_has_no_end_is_refused_before_it_fills_the_memory():
    with hostile("endless") as endless, hostile("list") as listing:
        printed = printed_by(
            begun(
                (endless, "assert len(get_range(place, 0, 1000)) == 1000"),
                (endless, "get(place, 1 << 20)"),
                (endless, "read_limited(place, 1 << 20)"),
                (endless, "open_foreign(place, 1 << 20)"),
                (endless, "list_sizes(place)"),
                (endless, "list_folders(place)"),
                (endless, "get(by_http, 1 << 20)"),
                (endless, "list_sizes(by_http)"),
                (listing, "requests.MAX_STORE_NAMES = 5000; list_sizes(place)"),
            )
        )
    assert printed == [
        "ended 0",
        *["terrainav: larger than 1 MB", "ended 2"] * 3,
        *["terrainav: s3://data/run: the answer is larger than 8 MB", "ended 3"] * 2,
        "terrainav: larger than 1 MB",
        "ended 2",
        f"terrainav: http://127.0.0.1:{endless.port}/run: the answer is larger than 8 MB",
        "ended 3",
        "terrainav: s3://data/run: it holds more than 5,000 objects",
        "ended 3",
    ]


@pytest.mark.thorough
def test_a_scheduler_that_says_nothing_to_the_point_is_given_up():
    with hostile("silent") as silent, hostile("zeros") as zeros, hostile("endless") as endless:
        servers = (silent, zeros, endless)
        code = "engines.MAX_SCHEDULER_SILENCE_S = 1.0; begin_cluster()"
        printed = printed_by(begun(*((server, code) for server in servers)))
    assert printed == [
        line
        for server in servers
        for line in (
            f"terrainav: cluster dask://127.0.0.1:{server.port}: no scheduler answers there",
            "ended 3",
        )
    ]


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no SIGINT to another process")
@pytest.mark.parametrize(
    ("way", "code"),
    [
        ("silent", "is_file(place)"),
        ("slow", "get(place, 1000)"),
        ("silent", "engines.MAX_SCHEDULER_SILENCE_S = 100.0; begin_cluster()"),
        ("silent", f"real_run({_CAPTURE!r})"),
    ],
)
def test_ctrl_c_ends_what_waits(way, code):
    """At once: nothing else ends it within the time of the test."""
    with hostile(way) as server:
        process = begun((server, code))
        assert server.asked.wait(PATIENCE_S)
        process.send_signal(signal.SIGINT)
        assert printed_by(process) == ["terrainav: stopped", "ended 130"]


def test_time_for_which_the_process_was_stopped_is_no_silence(monkeypatch):
    """As by Ctrl-Z, or as the machine sleeps: the answer has had nobody to come to."""
    now_s = 0.0
    monkeypatch.setattr(store_requests, "time", SimpleNamespace(monotonic=lambda: now_s))
    watch = store_requests._Watch(store_requests.Moved())
    # Then it is silent, too.
    for now_s in (1.0, *(86_400.0 + second for second in range(59))):  # noqa: B007  (read by the clock)
        watch.look()
    now_s += 4.0
    with pytest.raises(store_requests.StoreLimitError, match="only 0 bytes have come within 6"):
        watch.look()
