"""An S3 store on loopback in a process of its own, moto's server, which counts what it is asked.

    python benchmarks/object_store.py    # prints its address, and serves until its standard input ends

All objects are kept in memory. Counts of requests leave out those for counts.
"""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import threading
import time
import urllib.request
from collections import Counter
from collections.abc import Iterable
from types import TracebackType
from typing import Any

BUCKET = "data"
#: What the store takes for credentials, and where its address stands: for this process and its children.
_CREDENTIALS = {
    "AWS_ACCESS_KEY_ID": "BENCHMARK",
    "AWS_SECRET_ACCESS_KEY": "BENCHMARK",
    "AWS_DEFAULT_REGION": "us-east-1",
}
_COUNTS = "/counts-of-requests"


class _Counted:
    """An application of WSGI, and what it was asked: method, and the part of the store, of each request."""

    def __init__(self, application: Any) -> None:
        self._application = application
        self._lock = threading.Lock()
        self._asked: Counter[str] = Counter()
        self._received_bytes = 0
        self._cpu_s = time.process_time()

    def __call__(self, asked: dict[str, Any], start: Any) -> Iterable[bytes]:
        if asked["PATH_INFO"] == _COUNTS:
            return self._told(start)
        with self._lock:
            self._asked[asked["REQUEST_METHOD"]] += 1
            self._received_bytes += int(asked.get("CONTENT_LENGTH") or 0)
        answer: Iterable[bytes] = self._application(asked, start)
        return answer

    def _told(self, start: Any) -> Iterable[bytes]:
        """Counts since they were last told."""
        with self._lock:
            cpu_s = time.process_time()
            told = {
                "requests": dict(self._asked),
                "received_bytes": self._received_bytes,
                "cpu_s": cpu_s - self._cpu_s,
            }
            self._asked.clear()
            self._received_bytes, self._cpu_s = 0, cpu_s
        start("200 OK", [("Content-Type", "application/json")])
        return [json.dumps(told).encode()]


class ObjectStore:
    """The store with one bucket, while the context is open; the environment leads to it meanwhile."""

    address = f"s3://{BUCKET}"

    def __enter__(self) -> ObjectStore:
        self._process = subprocess.Popen(
            [sys.executable, __file__], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        if self._process.stdout is None:
            raise RuntimeError("the store's output is not to be read")
        self._url = self._process.stdout.readline().strip()
        os.environ.update(_CREDENTIALS, AWS_ENDPOINT_URL=self._url)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.communicate()

    def counts(self) -> dict[str, Any]:
        """Requests by method, bytes received, and the server's processor seconds, since it was last asked for them."""
        with urllib.request.urlopen(self._url + _COUNTS, timeout=30) as answer:  # noqa: S310 (our own, on loopback)
            return dict(json.load(answer))


def main() -> None:
    """Serve until the standard input ends."""
    import boto3
    from moto.moto_server.werkzeug_app import DomainDispatcherApplication, create_backend_app
    from werkzeug.serving import WSGIRequestHandler, make_server

    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    application = _Counted(DomainDispatcherApplication(create_backend_app))
    WSGIRequestHandler.protocol_version = "HTTP/1.1"
    server = make_server("127.0.0.1", 0, application, threaded=True)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    url = f"http://127.0.0.1:{server.port}"
    os.environ.update(_CREDENTIALS, AWS_ENDPOINT_URL=url)
    boto3.client("s3").create_bucket(Bucket=BUCKET)
    print(url, flush=True)
    sys.stdin.read()
    server.shutdown()


if __name__ == "__main__":
    main()
