"""A tile server that states how long its tiles may be cached, and answers conditional requests."""

from __future__ import annotations

import hashlib
import time
from collections import Counter
from email.utils import formatdate

from tests.support.patterns import content_type
from tests.support.tileserver import TileServer


class CachingTileServer(TileServer):
    """Tile server with validators.

    Parameters
    ----------
    headers : dict or None
        Sent with every tile and every 304.
    etag : bool
        Whether tiles have an ETag, which changes with the picture.
    last_modified : str
        Date when the tiles were last modified; empty for none.
    length_in_304 : bool
        Whether a 304 states the length of the picture it leaves out, as servers may (RFC 9110, 8.6).
    clock : callable
        Seconds since 1970, for Date.

    Attributes
    ----------
    statuses : Counter of status
    """

    def __init__(
        self,
        paint=None,
        *,
        headers=None,
        etag=False,
        last_modified="",
        length_in_304=False,
        clock=time.time,
        **options,
    ):
        super().__init__(paint, **options)
        self.headers = headers or {}
        self.etag, self.last_modified, self.length_in_304 = etag, last_modified, length_in_304
        self.clock = clock
        self.statuses: Counter = Counter()

    def _send(self, handler, body, tile):
        handler.date_time_string = lambda: formatdate(self.clock(), usegmt=True)
        if self._faults:
            super()._send(handler, body, tile)
            return
        headers = dict(self.headers)
        if self.etag:
            headers["ETag"] = f'"{hashlib.sha256(body).hexdigest()[:16]}"'
        if self.last_modified:
            headers["Last-Modified"] = self.last_modified
        conditions = handler.headers
        # If-None-Match takes precedence over If-Modified-Since (RFC 9110, 13.2.2).
        if "If-None-Match" in conditions:
            same = conditions["If-None-Match"] == headers.get("ETag")
        else:
            same = bool(self.last_modified) and conditions.get("If-Modified-Since") == self.last_modified
        with self.lock:
            self.statuses[304 if same else 200] += 1
        if same:
            handler.send_response(304)
            if self.length_in_304:
                headers["Content-Length"] = str(len(body))
            for name, value in headers.items():
                handler.send_header(name, value)
            handler.end_headers()
        else:
            handler.answer(200, body, content_type(body), headers)
