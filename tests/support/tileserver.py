"""A tile server on the loopback, with faults on demand.

By hand, from the root of the repository::

    python -m tests.support.tileserver --port 8000 --paint world
    python -m tests.support.tileserver --folder tiles/ --latency-ms 40 --fault 503:0.05 --fault 404:0.01:1

Tiles are at ``/z/x/y.png`` and ``/map_type/z/x/y.png`` (or .jpg, .webp; ``@2x`` before the dot for 512 px), pictures
about a centre, in the manner of Google Static Maps, at ``/maps/api/staticmap``.
"""

from __future__ import annotations

import argparse
import base64
import contextlib
import hashlib
import hmac
import io
import json
import re
import sys
import threading
import time
from collections import Counter
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import parse_qs, urlsplit

import numpy as np
from PIL import Image

from tests.support import patterns
from tests.support.faults import FAULTS

_TILE = re.compile(r"(?:/(\w+))?/(\d+)/(\d+)/(-?\d+)(@2x)?\.(png|jpg|jpeg|webp)")
_STATIC_MAP = "/maps/api/staticmap"
# Pictures about a centre do not start at whole pixels, so they hold positions in this many parts of a pixel.
STATIC_MAP_UNITS_PER_PX = 16


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    # Send small writes at once: otherwise they wait for the acknowledgement of earlier ones (40 ms).
    disable_nagle_algorithm = True

    def do_GET(self):
        owner = self.server.owner
        with owner.lock:
            owner.requests[self.path] += 1
            owner.user_agents.add(self.headers.get("User-Agent"))
        if owner.latency_s:
            time.sleep(owner.latency_s)
        parts = urlsplit(self.path)
        found = _TILE.fullmatch(parts.path)
        try:
            if parts.path == _STATIC_MAP:
                owner.static_map(self, parse_qs(parts.query, keep_blank_values=True))
            elif found:
                owner.tile(self, *found.groups())
            else:
                self.answer(404, b"no such place", "text/plain")
        except (BrokenPipeError, ConnectionResetError):
            self.close_connection = True

    def start(self, code, kind, length, headers=None):
        self.send_response(code)
        if code != 204:
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(length))
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        self.end_headers()

    def answer(self, code, body, kind, headers=None):
        self.start(code, kind, len(body), headers)
        if code != 204:
            self.wfile.write(body)

    def picture(self, body):
        return Image.open(io.BytesIO(body)).convert("RGB")

    def log_message(self, *args):
        if self.server.owner.verbose:
            super().log_message(*args)


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    request_queue_size = 128

    def get_request(self):
        request = super().get_request()
        with self.owner.lock:
            self.owner.connections += 1
        return request

    def handle_error(self, request, client_address):
        """Say nothing: clients that go away are part of the tests."""


class _Fault:
    """A fault, the tiles that it affects, and how often it affects each of them."""

    def __init__(self, kind, tiles=None, share=None, times=None):
        self.kind, self._tiles, self._share, self._times = kind, tiles, share, times
        self._seen = Counter()

    def falls_on(self, zoom, x, y):
        if self._tiles is not None and (zoom, x, y) not in self._tiles:
            return False
        if self._share is not None:
            digest = hashlib.sha256(f"{self.kind} {zoom} {x} {y}".encode()).digest()
            if int.from_bytes(digest[:4], "big") >= self._share * 2**32:
                return False
        self._seen[zoom, x, y] += 1
        return self._times is None or self._seen[zoom, x, y] <= self._times


class TileServer:
    """A server that runs while its context is open.

    Parameters
    ----------
    paint : callable or None
        Function of map type, zoom, x, y and size in px that returns a picture, or None for a 404. By default pixels
        hold their position.
    read : callable or None
        Function of map type, zoom, x, y and extension that returns a file's bytes, instead of ``paint``.
    tile_px : int
        Size of tiles without @2x.
    latency_s : float
        Wait before every answer.
    key, secret : str or None
        Key that requests for static maps must have, and secret that must sign them.
    port : int
        0 for any that is free.

    Attributes
    ----------
    requests : Counter of path
    connections : int
        TCP connections accepted.
    user_agents : set
    faults_sent : Counter of kind
    """

    def __init__(
        self,
        paint=None,
        *,
        read=None,
        tile_px=256,
        latency_s=0.0,
        key=None,
        secret=None,
        port=0,
        verbose=False,
    ):
        self.paint, self.read, self.tile_px, self.latency_s = (
            paint or patterns.positions,
            read,
            tile_px,
            latency_s,
        )
        self.key, self.secret, self.verbose = key, secret, verbose
        self.lock = threading.Lock()
        self.requests: Counter = Counter()
        self.user_agents: set = set()
        self.connections = 0
        self.faults_sent: Counter = Counter()
        self._faults: list[_Fault] = []
        self._http = _Server(("127.0.0.1", port), _Handler)
        self._http.owner = self
        self._http.stalled = threading.Event()
        self._thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.02}, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._http.stalled.set()
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()

    @property
    def port(self) -> int:
        return self._http.server_address[1]

    @property
    def url(self) -> str:
        """Address of the server."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def url_template(self) -> str:
        """Template of its tiles, for one kind of picture."""
        return f"{self.url}/{{z}}/{{x}}/{{y}}.png"

    @property
    def map_type_template(self) -> str:
        """Template of its tiles by map type."""
        return f"{self.url}/{{map_type}}/{{z}}/{{x}}/{{y}}.png"

    @property
    def static_map_url(self) -> str:
        """Address of its pictures about a centre."""
        return self.url + _STATIC_MAP

    @property
    def tile_requests(self) -> Counter:
        """Requests of each (map type, zoom, x, y)."""
        with self.lock:
            counted = dict(self.requests)
        found: Counter = Counter()
        for path, times in counted.items():
            match = _TILE.fullmatch(urlsplit(path).path)
            if match:
                found[(match[1] or "", *(int(match[at]) for at in (2, 3, 4)))] += times
        return found

    def fail(self, kind, *tiles, share=None, times=None):
        """Answer with a fault of `FAULTS`.

        Parameters
        ----------
        kind : str
        tiles : (zoom, x, y)
            Tiles affected; all if none is given.
        share : float or None
            Share of the tiles affected, always the same ones.
        times : int or None
            How often on each tile, None for always.
        """
        if kind not in FAULTS:
            raise ValueError(f"fault {kind!r}: one of {', '.join(FAULTS)}")
        self._faults.append(_Fault(kind, set(tiles) or None, share, times))

    def heal(self):
        """Forget all faults."""
        self._faults.clear()

    def tile(self, handler, map_type, zoom, x, y, twice, extension):
        """Answer for a tile."""
        zoom, x, y = int(zoom), int(x), int(y)
        size_px = self.tile_px * (2 if twice else 1)
        if not (0 <= x < 1 << zoom and 0 <= y < 1 << zoom):
            handler.answer(404, b"no such tile", "text/plain")
            return
        body = self._body(map_type or "satellite", zoom, x, y, size_px, extension)
        if body is None:
            handler.answer(404, b"no such tile", "text/plain")
            return
        self._send(handler, body, (zoom, x, y))

    def static_map(self, handler, query):
        """Answer for a picture about a centre."""
        asked = {name: values[0] for name, values in query.items()}
        wrong = self._refusal(handler.path, asked)
        if wrong:
            handler.answer(403, wrong.encode(), "text/plain")
            return
        zoom, scale = int(asked["zoom"]), int(asked.get("scale", 1))
        width, height = (int(size) for size in asked["size"].split("x"))
        if max(width, height) > 640:
            handler.answer(400, b"size too large", "text/plain")
            return
        # The service keeps six decimals, whatever it is sent.
        lat_deg, lon_deg = (round(float(value), 6) for value in asked["center"].split(","))
        world_px = (256 * scale) << zoom
        # Formulas of a textbook, independent of those under test.
        centre_x = (lon_deg + 180.0) / 360.0 * world_px
        sine = np.sin(np.radians(lat_deg))
        centre_y = (0.5 - np.log((1.0 + sine) / (1.0 - sine)) / (4.0 * np.pi)) * world_px
        columns = centre_x - width * scale / 2 + np.arange(width * scale) + 0.5
        rows = centre_y - height * scale / 2 + np.arange(height * scale) + 0.5
        units = (np.floor(values * STATIC_MAP_UNITS_PER_PX).astype(np.int64) for values in (columns, rows))
        picture = patterns.encode_position(*units, asked.get("maptype", "roadmap"))
        self._send(handler, patterns.to_bytes(picture, "png"), (zoom, 0, 0))

    def _refusal(self, path, asked):
        if self.key is not None and asked.get("key") != self.key:
            return f"The provided API key {asked.get('key', '')} is invalid."
        if self.secret is not None:
            unsigned, _, signature = path.rpartition("&signature=")
            if signature != expected_signature(unsigned, self.secret):
                return "Unable to authenticate the request. Provided 'signature' is not valid."
        return ""

    def _body(self, map_type, zoom, x, y, size_px, extension):
        if self.read is not None:
            return self.read(map_type, zoom, x, y, extension)
        if self.paint is patterns.positions:
            return patterns.encoded_positions(map_type, x, y, size_px, extension)
        picture = self.paint(map_type, zoom, x, y, size_px)
        return None if picture is None else patterns.to_bytes(picture, extension)

    def _send(self, handler, body, tile):
        with self.lock:
            fault = next((fault for fault in self._faults if fault.falls_on(*tile)), None)
            if fault is not None:
                self.faults_sent[fault.kind] += 1
        if fault is None:
            handler.answer(200, body, patterns.content_type(body))
        else:
            FAULTS[fault.kind](handler, body)


def expected_signature(path_and_query: str, secret: str) -> str:
    """Signature by the steps in the service's documentation, independent of the code under test."""
    key = base64.b64decode(secret.replace("-", "+").replace("_", "/"))
    raw = hmac.digest(key, path_and_query.encode(), hashlib.sha1)
    return base64.b64encode(raw).decode().replace("+", "-").replace("/", "_")


def main():
    """Run until interrupted."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--port", type=int, default=8000, help="0 for any that is free")
    parser.add_argument("--paint", choices=("positions", "world"), default="positions", help="what tiles show")
    parser.add_argument("--seed", type=int, default=2024, help="of the embedded world")
    parser.add_argument("--folder", help="tiles of another program, z/x/y.png")
    parser.add_argument("--tile-px", type=int, default=256, choices=(256, 512))
    parser.add_argument("--latency-ms", type=float, default=0.0)
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="KIND[:SHARE[:TIMES]]",
        help=f"share of the tiles it falls on, and how often on each of them: {', '.join(sorted(FAULTS))}",
    )
    parser.add_argument("--controlled", action="store_true", help="obey `heal`, `counts` and `end` on the input")
    parser.add_argument("--quiet", action="store_true")
    asked = parser.parse_args()
    server = TileServer(
        patterns.world(asked.seed) if asked.paint == "world" else None,
        read=patterns.folder(asked.folder) if asked.folder else None,
        tile_px=asked.tile_px,
        latency_s=asked.latency_ms / 1000.0,
        port=asked.port,
        verbose=not asked.quiet,
    )
    for fault in asked.fault:
        kind, share, times = (*fault.split(":"), "", "")[:3]
        server.fail(kind, share=float(share or 1.0), times=int(times) if times else None)
    with server:
        print(server.url_template, flush=True)
        print(server.map_type_template, flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            if asked.controlled:
                obey(server, sys.stdin)
            else:
                threading.Event().wait()
        print(f"{sum(server.requests.values())} requests over {server.connections} connections")


def obey(server, commands):
    """Obey the program that started the server; the command `counts` is answered with a line of JSON."""
    for command in map(str.strip, commands):
        if command == "end":
            return
        if command == "heal":
            server.heal()
        if command == "counts":
            tiles = server.tile_requests
            counts = {
                "requests": sum(tiles.values()),
                "unique": len(tiles),
                "once": sum(times == 1 for times in tiles.values()),
                "connections": server.connections,
                "faults": dict(server.faults_sent),
            }
            print(json.dumps(counts), flush=True)


if __name__ == "__main__":
    main()
