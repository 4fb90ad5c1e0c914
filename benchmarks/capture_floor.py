"""The least time that any program can take for the capture benchmark: its terms, each measured here and now."""

from __future__ import annotations

import http.client
import io
import math
import os
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlsplit

import numpy as np
from capture_contenders import JPEG_QUALITY, TILE_PX, ZOOM, Window, paste, tiles_of
from loopback_server import BLOB_BYTES, LoopbackServer, detailed_tiles
from PIL import Image
from terrainav.core.capture.georeference import Georeference
from terrainav.core.capture.metadata import Description
from terrainav.core.capture.writers import geotiff

#: Requests in a row that processor times are the mean of, and repeats whose median counts.
_REQUESTS, _REPEATS = 400, 5
_PICTURES = 40
#: Blobs that the bandwidth is measured with.
_BLOBS = 64


@dataclass(frozen=True)
class Terms:
    """What a request, a tile and a picture cost at least.

    Parameters
    ----------
    request_s, connect_s : float
        Wall time of a request over an open connection, and what the first one takes longer.
    http_s, decode_s : float
        Processor time of a request with http.client, and of decoding a tile with Pillow.
    encode_s : dict of float
        Processor time of assembling and encoding a picture, by format.
    bandwidth_bytes_per_s : float
    tile_bytes : float
    cores : int
    """

    request_s: float
    connect_s: float
    http_s: float
    decode_s: float
    encode_s: dict[str, float]
    bandwidth_bytes_per_s: float
    tile_bytes: float
    cores: int

    def shares_s(
        self, image_format: str, unique: int, pictures: int, connections: int, server_cpu_s: float
    ) -> dict[str, float]:
        """Seconds that the network's waits, its bandwidth and the processors each need at least."""
        tiles = unique * (self.http_s + self.decode_s)
        return {
            "waits": math.ceil(unique / connections) * self.request_s + self.connect_s,
            "bandwidth": unique * self.tile_bytes / self.bandwidth_bytes_per_s,
            "processors": (tiles + pictures * self.encode_s[image_format] + server_cpu_s) / self.cores,
        }


def measure_terms(server: LoopbackServer, latency_s: float, connect_s: float, window: Window) -> Terms:
    """Measure the terms on one thread, with the picture of a window."""
    bodies = detailed_tiles()
    waits, connects = _waits(server, latency_s, connect_s)
    server.reset(latency_s=0.0, connect_s=0.0)
    decoded = {tile: _decoded(bodies[index % len(bodies)]) for index, tile in enumerate(tiles_of(window))}
    terms = Terms(
        request_s=waits,
        connect_s=connects,
        http_s=_http_s(server),
        decode_s=_cpu_s(lambda: [_decoded(body) for body in bodies]) / len(bodies),
        encode_s={name: _encode_s(encode, window, decoded) for name, encode in _ENCODERS.items()},
        bandwidth_bytes_per_s=_bandwidth(server),
        tile_bytes=statistics.mean(map(len, bodies)),
        cores=os.cpu_count() or 1,
    )
    server.reset(latency_s=latency_s, connect_s=connect_s)
    return terms


def _cpu_s(work: Callable[[], object]) -> float:
    work()
    times = []
    for _ in range(_REPEATS):
        before = time.thread_time()
        work()
        times.append(time.thread_time() - before)
    return statistics.median(times)


def _decoded(body: bytes) -> Any:
    return np.asarray(Image.open(io.BytesIO(body)))


def _assembled(window: Window, tiles: dict[tuple[int, int], Any]) -> Any:
    picture = np.empty((window[3], window[2], 3), np.uint8)
    for tile, pixels in tiles.items():
        paste(picture, window, tile, pixels)
    return picture


def _jpeg(picture: Any) -> bytes:
    out = io.BytesIO()
    Image.fromarray(picture).save(out, "JPEG", quality=JPEG_QUALITY, subsampling=0)
    return out.getvalue()


def _tiff(picture: Any) -> bytes:
    # Our own encoder is the quickest lossless one here: a floor with Pillow's or GDAL's would be easier to reach.
    height, width = picture.shape[:2]
    return geotiff(
        picture,
        Georeference(0.0, 0.0, 1.0, 1.0, width, height),
        Description("floor", "satellite", "", "", ZOOM, 0.0, 0.0, 1.0),
    )


_ENCODERS: dict[str, Callable[[Any], bytes]] = {"jpg": _jpeg, "tif": _tiff}


def _encode_s(encode: Callable[[Any], bytes], window: Window, tiles: dict[tuple[int, int], Any]) -> float:
    def work() -> None:
        for _ in range(_PICTURES):
            encode(_assembled(window, tiles))

    return _cpu_s(work) / _PICTURES


def _connection(server: LoopbackServer) -> http.client.HTTPConnection:
    parts = urlsplit(server.url)
    return http.client.HTTPConnection(str(parts.hostname), parts.port, timeout=60)


def _get(connection: http.client.HTTPConnection, path: str) -> bytes:
    connection.request("GET", path)
    return connection.getresponse().read()


def _waits(server: LoopbackServer, latency_s: float, connect_s: float) -> tuple[float, float]:
    server.reset(latency_s=latency_s, connect_s=connect_s)
    first, others = [], []
    for _ in range(_REPEATS):
        connection = _connection(server)
        for times in (first, others, others):
            before = time.perf_counter()
            _get(connection, f"/jpg/{ZOOM}/1/1.jpg")
            times.append(time.perf_counter() - before)
        connection.close()
    request_s = statistics.median(others)
    return request_s, statistics.median(first) - request_s


def _http_s(server: LoopbackServer) -> float:
    connection = _connection(server)

    def work() -> None:
        for index in range(_REQUESTS):
            _get(connection, f"/jpg/{ZOOM}/{index}/{TILE_PX}.jpg")

    seconds = _cpu_s(work) / _REQUESTS
    connection.close()
    return seconds


def _bandwidth(server: LoopbackServer) -> float:
    connection = _connection(server)
    before = time.perf_counter()
    for _ in range(_BLOBS):
        _get(connection, "/blob")
    seconds = time.perf_counter() - before
    connection.close()
    return _BLOBS * BLOB_BYTES / seconds
