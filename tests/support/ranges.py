"""A server on the loopback that sends parts of files (HTTP Range), with faults on demand."""

from __future__ import annotations

import re
import threading
import time
from email.utils import formatdate
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def do_HEAD(self):
        if self.server.owner.answers_heads:
            self.do_GET()
        else:
            self._send(403, b"signed for GET", {})

    def do_GET(self):
        owner, path = self.server.owner, urlsplit(self.path).path
        with owner.lock:
            owner.asked.append((self.command, self.path, dict(self.headers)))
            owner.under_way += 1
            owner.most_under_way = max(owner.most_under_way, owner.under_way)
            if owner.when and len(owner.asked) == owner.when[0]:
                owner.when[1]()
            fault = owner.faults.pop(0) if owner.faults else 0
        time.sleep(owner.latency_s)
        with owner.lock:
            owner.under_way -= 1
        try:
            self._answer(owner, path, fault)
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True

    def _answer(self, owner, path, fault):
        if path in owner.redirects:
            return self._send(302, b"", {"Location": owner.redirects[path]})
        if fault:
            return self._send(fault, b"busy", {})
        if path not in owner.files:
            return self._send(404, b"no such file", {})
        body, etag = owner.files[path]
        named = {"ETag": etag} if owner.names_versions else {}
        named["Last-Modified"] = formatdate(1e9, usegmt=True)
        if owner.keeps_conditions and self.headers.get("If-Match", etag) != etag:
            return self._send(412, b"", {})
        wanted = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        if wanted is not None and owner.sends_instead is not None:
            part, range_sent = owner.sends_instead(int(wanted.group(1)), int(wanted.group(2)))
            return self._send(206, part, {"Content-Range": range_sent})
        if wanted is None or not owner.sends_parts:
            return self._send(200, body, named)
        first, last = int(wanted.group(1)), int(wanted.group(2) or len(body) - 1)
        if first >= len(body):
            return self._send(416, b"", {"Content-Range": f"bytes */{len(body)}"})
        part = body[first : last + 1]
        range_sent = f"bytes {first}-{first + len(part) - 1}/{len(body)}"
        return self._send(206, part, {**named, "Content-Range": range_sent})

    def _send(self, status, body, headers):
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name, value)
        if self.server.owner.sends_parts:
            self.send_header("Accept-Ranges", "bytes")
        self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        if self.command == "HEAD":
            return
        cut = self.server.owner.cuts_at
        if cut is not None and len(body) > cut:
            self.wfile.write(body[:cut])
            self.close_connection = True
            return
        self.wfile.write(body)
        with self.server.owner.lock:
            self.server.owner.sent_bytes += len(body)

    def log_message(self, *args):
        """Say nothing."""


class RangeServer:
    """A server that runs while its context is open.

    Attributes
    ----------
    files : dict of path to (bytes, ETag)
    redirects : dict of path to URL
    asked : list of (method, path and query, headers)
    faults : list of status
        Statuses of the next answers; 0 for no fault.
    sends_parts, names_versions, keeps_conditions : bool
        Whether the server supports Range, ETag and If-Match.
    answers_heads : bool
        Whether the server answers HEAD; servers with addresses signed only for GET do not.
    when : (int, callable) or None
        Number of requests after which a function is called, and the function.
    sends_instead : callable or None
        Function of the first and last byte requested that returns the bytes to send instead, and their Content-Range.
    cuts_at : int or None
        Number of bytes after which the connection is closed if the body is longer.
    """

    def __init__(self):
        self.files, self.redirects, self.asked, self.faults = {}, {}, [], []
        self.sends_parts = self.names_versions = self.keeps_conditions = self.answers_heads = True
        self.when, self.cuts_at, self.latency_s = None, None, 0.0
        self.sends_instead = None
        self.sent_bytes = self.under_way = self.most_under_way = 0
        self.lock = threading.Lock()
        self._http = ThreadingHTTPServer(("127.0.0.1", 0), _Handler)
        self._http.daemon_threads = True
        self._http.owner = self
        self._http.handle_error = lambda *_: None
        self._thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)
        self.url = f"http://127.0.0.1:{self._http.server_address[1]}"

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._http.shutdown()
        self._http.server_close()
