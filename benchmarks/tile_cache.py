"""What the tile cache costs and gives: tiles fetched without it, into it, and out of it.

    python benchmarks/tile_cache.py          # prints a table

Tiles of 12 kB come from a server in another process; each is fetched and decoded as a capture does. The three ways take
turns, the median of the rounds counts.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from loopback_server import LoopbackServer
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.tiles import Tile
from terrainav.core.imagery.xyz import XYZSource

ZOOM = 19
ACROSS = 100


def windows(count: int) -> list[Window]:
    """Tiles of a block."""
    return [Window(ZOOM, (1000 + n % ACROSS) * 256, (2000 + n // ACROSS) * 256, 256, 256) for n in range(count)]


def timed(run: Callable[[], None]) -> tuple[float, float]:
    """Wall and processor seconds."""
    wall_s, cpu_s = time.perf_counter(), time.process_time()
    run()
    return time.perf_counter() - wall_s, time.process_time() - cpu_s


def capture(template: str, cache: TileCache | None, count: int, connections: int) -> None:
    """Fetch tiles, until what was stored is on disk."""
    source = XYZSource(template, cache=cache, connections=connections)
    with ThreadPoolExecutor(connections) as threads:
        for _ in threads.map(partial(source.fetch, ""), windows(count)):
            pass
    source.close()


def read_bare(folder: Path, template: str, count: int) -> None:
    """Read tiles out of the cache without decoding them."""
    store = TileCache(folder).store(template, source="127.0.0.1", title="127.0.0.1")
    for window in windows(count):
        tile = Tile(ZOOM, int(window.left_px) // 256, int(window.top_px) // 256)
        kept = store.find(tile)
        if kept is None or not store.is_fresh(kept):
            raise RuntimeError("a tile was not in the cache")
    store.close()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--tiles", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=5)
    asked = parser.parse_args()
    print(f"{asked.tiles} tiles of 12 kB, median of {asked.rounds} rounds: wall s (processor s)")
    print("connections  latency   no cache        cold            warm            warm, not decoded")
    with LoopbackServer() as server:
        for connections, latency_s in ((4, 0.0), (16, 0.0), (4, 0.04), (16, 0.04)):
            server.reset(latency_s=latency_s)
            times: dict[str, list[tuple[float, float]]] = {name: [] for name in ("none", "cold", "warm", "bare")}
            run = partial(capture, server.template(), count=asked.tiles, connections=connections)
            for _ in range(asked.rounds):
                with tempfile.TemporaryDirectory() as folder:
                    times["none"].append(timed(partial(run, cache=None)))
                    times["cold"].append(timed(partial(run, cache=TileCache(folder))))
                    before = server.counts()["requests"]
                    times["warm"].append(timed(partial(run, cache=TileCache(folder))))
                    times["bare"].append(timed(partial(read_bare, Path(folder), server.template(), asked.tiles)))
                    if server.counts()["requests"] != before:
                        raise RuntimeError("a warm run made requests")
            row = [
                "{:6.3f} ({:5.3f})".format(*(statistics.median(values) for values in zip(*of_way)))
                for of_way in times.values()
            ]
            print(f"{connections:11d}  {latency_s * 1e3:4.0f} ms   " + "  ".join(row), flush=True)


if __name__ == "__main__":
    main()
