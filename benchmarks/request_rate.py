"""Requests a second at a server whose limit a cluster shares, while its workers come, go and are killed.

    python benchmarks/request_rate.py                  # writes its part of docs/scale.md; some minutes
    python benchmarks/request_rate.py --seconds 15 --limits 20 --no-page

A tile server on loopback, a process of its own, notes when each request comes. The source states a limit. A
LocalCluster is scaled up and down, and its workers are killed, at random moments that a seed gives. No window of one
second, wherever it begins, may have more requests in it than the limit.
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from cluster_kills import workers
from loopback_server import LoopbackServer
from scale import machine_text, put_in_page

MOST_WORKERS, BLOCK_IMAGES = 4, 12
LATENCY_S = 0.040
#: Seconds between two changes: at least, and at most.
_CHANGE_S = (2.0, 6.0)
#: Share of the changes that kill a worker.
_KILLS = 1.0 / 3.0


class Changes:
    """Changes a cluster, at random."""

    def __init__(self, cluster: Any, seed: int) -> None:
        self._cluster, self._random = cluster, np.random.default_rng(seed)
        self._next_s = time.monotonic() + _CHANGE_S[1]
        self._killed: set[int] = set()
        self.joined = self.left = self.kills = 0
        self._count = 2

    def __call__(self, _: Any = None) -> None:
        """Change it, if it is time."""
        if time.monotonic() < self._next_s:
            return
        self._next_s = time.monotonic() + self._random.uniform(*_CHANGE_S)
        alive = [one for one in workers() if one.pid not in self._killed]
        if self._random.random() < _KILLS and alive:
            chosen = alive[int(self._random.integers(len(alive)))]
            chosen.kill()
            self._killed.add(chosen.pid)
            self.kills += 1
            return
        wanted = int(self._random.choice([n for n in range(1, MOST_WORKERS + 1) if n != self._count]))
        self.joined += max(wanted - self._count, 0)
        self.left += max(self._count - wanted, 0)
        self._count = wanted
        self._cluster.scale(wanted)


def most_in_a_second(times_s: Sequence[float]) -> int:
    """Greatest number of times in any window of one second, wherever it begins."""
    times = np.sort(np.asarray(times_s, np.float64))
    # A window that holds the most can begin at one of them; one that comes a whole second later is in the next.
    return int((np.searchsorted(times, times + 1.0, side="left") - np.arange(len(times))).max(initial=0))


def measure(server: LoopbackServer, limit: float, seconds: float, seed: int, folder: Path) -> dict[str, Any]:
    """Capture for so long, and tell what came to the server."""
    import dask
    import distributed
    from terrainav.core.capture.blocks.engines import open_engine
    from terrainav.core.capture.blocks.running import Blocks
    from terrainav.core.capture.progress import Listener
    from terrainav.core.capture.runner import capture
    from terrainav.core.imagery.catalogue import add, described
    from terrainav.core.imagery.opening import SourceOptions, named_source
    from terrainav.core.mission.areas.area import Box
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    name = f"limited-{limit:g}-{seed}"
    add(name, described(server.template(), requests_per_s=limit))
    named = named_source(name, SourceOptions(connections=16))
    mission = Mission(Box(35.16, -89.90, 35.06, -89.80), 120.0, source=name, image_format="jpg")
    worked_out = plan(mission, named.grid)
    server.reset(latency_s=LATENCY_S)
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs=50,
        ) as cluster,
    ):
        changes = Changes(cluster, seed)
        until_s = time.monotonic() + seconds
        with open_engine(cluster.scheduler_address.replace("tcp", "dask")) as engine:
            result = capture(
                worked_out,
                named,
                folder / name,
                executor=engine,
                blocks=Blocks(BLOCK_IMAGES),
                listener=Listener(progress=changes, cancelled=lambda: time.monotonic() > until_s),
            )
    times_s = server.times_s()
    lasted_s = max(times_s) - min(times_s)
    return {
        "limit": limit,
        "requests": len(times_s),
        "seconds": lasted_s,
        "most": most_in_a_second(times_s),
        "used": len(times_s) / lasted_s / limit,
        "written": result.written,
        "failed": len(result.failed),
        **{key: getattr(changes, key) for key in ("joined", "left", "kills")},
    }


TEXT = """\
Measured by `python benchmarks/request_rate.py` on {machine}: a tile server on loopback that responds within
{latency:.0f} ms for an answer, blocks of {block} images, 1 to {most} workers that come, go and are killed at random
moments.

| limit, requests/s | most in any second | requests | seconds | of the limit used | joined | left | killed |
| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""
ROW = "| {limit:g} | {most} | {requests:,} | {seconds:.0f} | {used:.0%} | {joined} | {left} | {kills} |\n"


def main() -> None:
    """Measure each limit."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--limits", type=float, nargs="+", default=[10.0, 40.0])
    parser.add_argument("--seconds", type=float, default=90.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--no-page", action="store_true", help="write nothing into docs/")
    asked = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as name, LoopbackServer() as server:
        os.environ["TERRAINAV_CONFIG_DIR"] = name
        for limit in asked.limits:
            rows.append(measure(server, limit, asked.seconds, asked.seed, Path(name)))
            print(json.dumps(rows[-1]), flush=True)
    if any(row["most"] > row["limit"] for row in rows):
        raise SystemExit("above the limit")
    if not asked.no_page:
        head = TEXT.format(machine=machine_text(), latency=LATENCY_S * 1e3, block=BLOCK_IMAGES, most=MOST_WORKERS)
        put_in_page(rate=head + "".join(ROW.format(**row) for row in rows))


if __name__ == "__main__":
    main()
