"""A tile server for benchmarks: encoded tiles from memory, a wait for each answer, little processor time.

    python benchmarks/loopback_server.py --latency-ms 40 --connect-ms 80

prints its port and serves until its standard input ends. Tiles of photographic detail are at ``/jpg/z/x/y.jpg``, tiles
whose pixels hold their own position at ``/positions/z/x/y.png``; ``/count`` tells what was asked for since ``/reset``.
One thread serves all connections: on two cores a server with a thread for each costs as much as the client under test.
"""

from __future__ import annotations

import argparse
import asyncio
import functools
import io
import json
import subprocess
import sys
import time
import urllib.request
from collections import Counter
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from PIL import Image

TILE_PX = 256
#: Length of ``/blob``, which the bandwidth is measured with.
BLOB_BYTES = 1 << 20
#: Different tiles with detail that are served in turn.
_TILES = 64
_SEED = 7
#: Standard deviation of the tiles' grey levels and quality of their JPEG: about 12 kB each, as aerial photographs have.
_CONTRAST, _QUALITY = 16.0, 75
#: Positions are told modulo this: 12 bits for each axis fill the 24 bits of a pixel.
MODULUS = 4096


def detailed_tiles() -> list[bytes]:
    """JPEGs of noise whose power falls with the square of the frequency, as that of photographs does."""
    rng = np.random.default_rng(_SEED)
    frequency = np.hypot(*np.meshgrid(np.fft.rfftfreq(TILE_PX), np.fft.fftfreq(TILE_PX)))
    frequency[0, 0] = 1.0
    tiles = []
    for _ in range(_TILES):
        noise = rng.standard_normal((4, TILE_PX, TILE_PX))
        grey, *tints = np.fft.irfft2(np.fft.rfft2(noise) / frequency, s=(TILE_PX, TILE_PX))
        colours = [grey + 0.15 * tint for tint in tints]
        pixels = 110.0 + _CONTRAST * np.stack(colours, axis=-1) / grey.std()
        out = io.BytesIO()
        Image.fromarray(np.clip(pixels, 0, 255).astype(np.uint8)).save(out, "JPEG", quality=_QUALITY)
        tiles.append(out.getvalue())
    return tiles


@functools.lru_cache(maxsize=100_000)
def position_tile(x: int, y: int) -> bytes:
    """PNG whose pixels hold their column and row on the global pixel grid."""
    steps = np.arange(TILE_PX)
    column, row = np.meshgrid((x * TILE_PX + steps) % MODULUS, (y * TILE_PX + steps) % MODULUS)
    pixels = np.stack([column & 255, row & 255, (column >> 8) | (row >> 8 << 4)], axis=-1).astype(np.uint8)
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG", compress_level=1)
    return out.getvalue()


def positions_of(pixels: np.ndarray[Any, np.dtype[np.uint8]]) -> tuple[Any, Any]:
    """Columns and rows, modulo `MODULUS`, that pixels of position tiles hold."""
    first, second, high = (pixels[..., channel].astype(np.int64) for channel in range(3))
    return first | (high & 15) << 8, second | high >> 4 << 8


class _Counts:
    """What was asked of the server."""

    def __init__(self) -> None:
        self.paths: Counter[bytes] = Counter()
        self.connections = 0
        self.times_s: list[float] = []
        self.cpu_s = time.process_time()

    def to_json(self) -> bytes:
        return json.dumps(
            {
                "requests": sum(self.paths.values()),
                "unique": len(self.paths),
                "connections": self.connections,
                "cpu_s": time.process_time() - self.cpu_s,
            }
        ).encode()


class _Server:
    """Tiles, waits and counts."""

    def __init__(self, latency_s: float, connect_s: float) -> None:
        self.latency_s, self.connect_s = latency_s, connect_s
        self.counts = _Counts()
        self._blob = _answer("application/octet-stream", bytes(BLOB_BYTES))
        self._jpeg = [_answer("image/jpeg", tile) for tile in detailed_tiles()]

    def answer(self, path: bytes) -> tuple[bytes, bool]:
        """Answer to a path, and whether it is a tile's."""
        kind, _, rest = path[1:].partition(b"/")
        if kind == b"count":
            return _answer("application/json", self.counts.to_json()), False
        if kind == b"blob":
            return self._blob, False
        if kind == b"reset":
            query = dict(pair.split(b"=") for pair in rest.split(b"&") if pair)
            self.latency_s = float(query.get(b"latency_s", self.latency_s))
            self.connect_s = float(query.get(b"connect_s", self.connect_s))
            self.counts = _Counts()
            return _answer("application/json", b"{}"), False
        if kind == b"times":
            return _answer("application/json", json.dumps(self.counts.times_s).encode()), False
        _, x, y = rest.partition(b".")[0].split(b"/")
        self.counts.paths[path] += 1
        self.counts.times_s.append(time.monotonic())
        if kind == b"positions":
            return _answer("image/png", position_tile(int(x), int(y))), True
        return self._jpeg[(int(x) * 31 + int(y)) % _TILES], True


def _answer(kind: str, body: bytes) -> bytes:
    return f"HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body


class _Connection(asyncio.Protocol):
    """One connection that is kept open; its first answer takes the time of connecting as well."""

    def __init__(self, server: _Server) -> None:
        self._server = server
        self._received = b""
        self._is_new = True

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        self._received += data
        while b"\r\n\r\n" in self._received:
            request, _, self._received = self._received.partition(b"\r\n\r\n")
            self._respond(request.split(b" ", 2)[1])

    def _respond(self, path: bytes) -> None:
        answer, is_tile = self._server.answer(path)
        wait_s = self._server.latency_s if is_tile else 0.0
        if self._is_new and is_tile:
            self._is_new = False
            self._server.counts.connections += 1
            wait_s += self._server.connect_s
        if wait_s:
            asyncio.get_running_loop().call_later(wait_s, self._transport.write, answer)
        else:
            self._transport.write(answer)


async def _serve(server: _Server) -> None:
    loop = asyncio.get_running_loop()
    listening = await loop.create_server(lambda: _Connection(server), "127.0.0.1", 0, backlog=512)
    print(listening.sockets[0].getsockname()[1], flush=True)
    await loop.run_in_executor(None, sys.stdin.read)
    listening.close()


class LoopbackServer:
    """The server in a process of its own, while the context is open."""

    def __init__(self, latency_s: float = 0.0, connect_s: float = 0.0) -> None:
        self._waits = ["--latency-ms", str(latency_s * 1e3), "--connect-ms", str(connect_s * 1e3)]

    def __enter__(self) -> LoopbackServer:
        self._process = subprocess.Popen(
            [sys.executable, str(Path(__file__)), *self._waits],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        if self._process.stdout is None:
            raise RuntimeError("the server's output is not to be read")
        self.url = f"http://127.0.0.1:{int(self._process.stdout.readline())}"
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.communicate()

    def template(self, kind: str = "jpg") -> str:
        """URL template of the tiles of a kind: jpg or positions."""
        return f"{self.url}/{kind}/{{z}}/{{x}}/{{y}}.{'png' if kind == 'positions' else 'jpg'}"

    def counts(self) -> dict[str, float]:
        """Tile requests, different tiles, connections and the server's processor seconds since `reset`."""
        return dict(self._get("/count"))

    def times_s(self) -> list[float]:
        """When each of these tile requests came, by a clock of the server's own."""
        return list(self._get("/times"))

    def reset(self, **waits_s: float) -> None:
        """Count anew; ``latency_s`` and ``connect_s`` may be changed."""
        self._get("/reset/" + "&".join(f"{name}={value}" for name, value in waits_s.items()))

    def _get(self, path: str) -> Any:
        with urllib.request.urlopen(self.url + path, timeout=10) as answer:  # noqa: S310 (our own, on the loopback)
            return json.load(answer)


def main() -> None:
    """Serve until the standard input ends."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--latency-ms", type=float, default=0.0, help="before every answer")
    parser.add_argument("--connect-ms", type=float, default=0.0, help="before the first answer of a connection")
    asked = parser.parse_args()
    asyncio.run(_serve(_Server(asked.latency_ms / 1e3, asked.connect_ms / 1e3)))


if __name__ == "__main__":
    main()
