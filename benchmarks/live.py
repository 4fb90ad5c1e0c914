"""Frames per second and latency of `terrainav live`, seen by a client in another process.

    python benchmarks/live.py                   # 20 s each
    python benchmarks/live.py --seconds 600     # ten minutes each
    python benchmarks/live.py --seconds 600 --docs    # and writes "How fast" into docs/live.md

The server has one core where the system allows it; the client has the others. Frames of 640 x 480 are asked for one
after the other, along a circle whose tiles were fetched before, at tilts up to 60 degrees. In real time, poses come at
a constant rate over a WebSocket from a flight that begins without tiles, each of which takes 40 ms.
"""

from __future__ import annotations

import argparse
import asyncio
import math
import os
import platform
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import numpy as np
from loopback_server import LoopbackServer

ROOT = Path(__file__).resolve().parents[1]
LAT_DEG, LON_DEG, AGL_M = 46.6, 8.1, 150.0
DEGREES_PER_M = 1.0 / 111_200.0
#: Of the real-time flight.
SPEED_M_S, RATE_HZ, DEADLINE_S, TILE_S = 30.0, 10.0, 0.1, 0.04
Pose = dict[str, float]


@dataclass
class Measured:
    """Figures of one kind of frames; memory in MB, at ten moments."""

    name: str
    latencies_s: list[float] = field(default_factory=list)
    seconds: float = 0.0
    processor_s: float = 0.0
    memory_mb: list[float] = field(default_factory=list)
    load: tuple[float, float] = (0.0, 0.0)
    stated: list[dict[str, Any]] = field(default_factory=list)

    def row(self) -> str:
        """Row of the page's table."""
        count = len(self.latencies_s)
        p50, p99 = (1e3 * float(np.quantile(self.latencies_s, share)) for share in (0.5, 0.99))
        memory = self.memory_mb
        return (
            f"| {self.name} | {count:,} | {count / self.seconds:.1f} | {1e3 * self.processor_s / count:.0f} "
            f"| {p50:.0f} | {p99:.0f} | {memory[0]:.0f} to {memory[-1]:.0f} "
            f"| {self.load[0]:.1f} to {self.load[1]:.1f} |"
        )


class Server:
    """`terrainav live` in a process of its own."""

    def __init__(self, source: str, more: Sequence[str]) -> None:
        with closing(socket.socket()) as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        place = f"--coords={LAT_DEG}_{LON_DEG}_{AGL_M:g}"
        camera = ["--image-px", "640", "--aspect-ratio", "4", "3", "--hfov", "70"]
        command = [sys.executable, "-m", "terrainav.core.cli", "live", place, "--source", source, *camera, *more]
        one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        self.process = subprocess.Popen(
            [*command, "--no-cache", "--http", str(self.port)], env={**os.environ, **one_thread}, stderr=subprocess.PIPE
        )
        if hasattr(os, "sched_setaffinity"):
            os.sched_setaffinity(self.process.pid, {0})
        # Each interface tells its address once it serves.
        for _ in range(1 + ("--airsim" in more)):
            if self.process.stderr is None or not self.process.stderr.readline():
                raise RuntimeError("the server did not start")

    def close(self) -> None:
        """End the server."""
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(30.0)

    def processor_s(self) -> float:
        """Seconds of the processor so far."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory_mb(self) -> float:
        """Memory in use."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.partition("VmRSS:")[2].split()[0]) / 1024.0


def circle() -> list[Pose]:
    """Poses of a flight in a circle of 40 m radius, at tilts up to 60 degrees."""
    turns = np.linspace(0.0, 2.0 * math.pi, 60, endpoint=False)
    return [
        {
            "lat": LAT_DEG + 40.0 * DEGREES_PER_M * math.cos(turn),
            "lon": LON_DEG + 40.0 * DEGREES_PER_M * math.sin(turn) / math.cos(math.radians(LAT_DEG)),
            "agl": AGL_M,
            "yaw": math.degrees(turn),
            "tilt": 60.0 * number / 59.0,
        }
        for number, turn in enumerate(turns.tolist())
    ]


@contextmanager
def watched(measured: Measured, server: Server, seconds: float) -> Iterator[None]:
    """Measure time of the processor, memory and the machine's load while the block runs."""
    ended = threading.Event()

    def watch() -> None:
        while not ended.wait(seconds / 10.0):
            measured.memory_mb.append(server.memory_mb())

    watching = threading.Thread(target=watch)
    measured.memory_mb.append(server.memory_mb())
    processor_s, begun_s, load = server.processor_s(), time.perf_counter(), os.getloadavg()[0]
    watching.start()
    try:
        yield
    finally:
        measured.seconds = time.perf_counter() - begun_s
        measured.processor_s = server.processor_s() - processor_s
        measured.load = load, os.getloadavg()[0]
        ended.set()
        watching.join()


def over_http(name: str, source: str, more: Sequence[str], seconds: float) -> Measured:
    """Ask for frame after frame over one connection."""
    measured, poses = Measured(name), circle()
    with closing(Server(source, more)) as server, closing(HTTPConnection("127.0.0.1", server.port, 60.0)) as connection:

        def ask(pose: Pose) -> None:
            connection.request("GET", "/frame?" + "&".join(f"{name}={value!r}" for name, value in pose.items()))
            answer = connection.getresponse()
            if answer.status != 200 or not answer.read():
                raise RuntimeError(f"status {answer.status}")

        for pose in poses:
            ask(pose)
        _repeat(ask, poses, measured, server, seconds)
    return measured


def over_airsim(name: str, source: str, more: Sequence[str], seconds: float) -> Measured:
    """Ask for compressed scenes by AirSim's client."""
    import cosysairsim

    with closing(socket.socket()) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    measured, radians = Measured(name), math.radians
    with closing(Server(source, [*more, "--airsim", str(port)])) as server:
        client = cosysairsim.VehicleClient(port=port)

        def ask(pose: Pose) -> None:
            north, east = (pose["lat"] - LAT_DEG) / DEGREES_PER_M, (pose["lon"] - LON_DEG) / DEGREES_PER_M
            down = cosysairsim.euler_to_quaternion(0.0, radians(pose["tilt"]), radians(pose["yaw"]))
            place = cosysairsim.Vector3r(north, east * math.cos(radians(LAT_DEG)), -pose["agl"])
            client.simSetVehiclePose(cosysairsim.Pose(place, down), True)
            if not client.simGetImage("3", cosysairsim.ImageType.Scene):
                raise RuntimeError("no image")

        for pose in circle():
            ask(pose)
        _repeat(ask, circle(), measured, server, seconds)
    return measured


def _repeat(
    ask: Callable[[Pose], None], poses: Sequence[Pose], measured: Measured, server: Server, seconds: float
) -> None:
    with watched(measured, server, seconds):
        until_s = time.perf_counter() + seconds
        while time.perf_counter() < until_s:
            begun_s = time.perf_counter()
            ask(poses[len(measured.latencies_s) % len(poses)])
            measured.latencies_s.append(time.perf_counter() - begun_s)


async def in_real_time(name: str, source: str, more: Sequence[str], seconds: float) -> Measured:
    """Send poses of a straight flight at a constant rate; the client measures each frame's age, too."""
    import aiohttp

    measured, sent_s = Measured(name), dict[int, float]()
    with closing(Server(source, more)) as server:
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(f"http://127.0.0.1:{server.port}/poses", max_msg_size=0) as poses,
        ):

            async def receive() -> None:
                while True:
                    stated = await poses.receive_json()
                    await poses.receive_bytes()
                    measured.latencies_s.append(time.perf_counter() - sent_s[stated["id"]])
                    measured.stated.append(stated)

            receiving = asyncio.ensure_future(receive())
            with watched(measured, server, seconds):
                begun_s = time.perf_counter()
                for number in range(round(seconds * RATE_HZ)):
                    await asyncio.sleep(max(begun_s + number / RATE_HZ - time.perf_counter(), 0.0))
                    lat = LAT_DEG + number / RATE_HZ * SPEED_M_S * DEGREES_PER_M
                    pose = {"lat": lat, "lon": LON_DEG, "agl": AGL_M, "tilt": 30.0}
                    sent_s[number] = time.perf_counter()
                    await poses.send_json({**pose, "id": number, "deadline_ms": 1e3 * DEADLINE_S})
                await asyncio.sleep(2.0 * DEADLINE_S + 1.0)
            receiving.cancel()
            with suppress(asyncio.CancelledError):
                await receiving
    return measured


def real_time_text(measured: Measured) -> str:
    """What the frames in real time state, and whether it is so."""
    stated, ages_s = measured.stated, np.array(measured.latencies_s)
    late = np.array([one["late"] for one in stated])
    shares = np.array([one["coarse_share"] for one in stated])
    beyond_s = ages_s - [one["age_s"] for one in stated]
    after_s = np.where(late, 0.0, np.maximum(ages_s - DEADLINE_S, 0.0))
    memory, load = measured.memory_mb, measured.load
    return (
        f"{measured.name}, {measured.seconds:.0f} s: {len(stated):,} frames, of which {100 * late.mean():.1f} % are "
        f"marked as late. {np.count_nonzero(after_s)} of the others reached the client after the deadline, at most "
        f"{1e3 * after_s.max():.0f} ms after it: an age ends with the encoded image, and the way to the client takes "
        f"{1e3 * np.quantile(beyond_s, 0.5):.0f} ms (median). {100 * np.mean(shares == 0.0):.0f} % of the frames are "
        f"at full resolution, and {100 * shares.mean():.1f} % of all pixels are not. Memory {memory[0]:.0f} to "
        f"{memory[-1]:.0f} MB, load {load[0]:.1f} to {load[1]:.1f}."
    )


def write_relief(path: Path) -> None:
    """Hills of 5 m cells, 6 km wide."""
    import rasterio
    from rasterio.transform import from_bounds

    side, reach = 1200, 3000.0 * DEGREES_PER_M
    wide = reach / math.cos(math.radians(LAT_DEG))
    x, y = np.meshgrid(np.linspace(-3000.0, 3000.0, side), np.linspace(-3000.0, 3000.0, side))
    heights = 800.0 + 60.0 * np.sin(x / 200.0) * np.cos(y / 170.0) + 4.0 * np.sin(x / 23.0) * np.sin(y / 31.0)
    place = from_bounds(LON_DEG - wide, LAT_DEG - reach, LON_DEG + wide, LAT_DEG + reach, side, side)
    about = {"driver": "GTiff", "width": side, "height": side, "count": 1, "dtype": "float32", "crs": "EPSG:4326"}
    with rasterio.open(path, "w", transform=place, **about) as file:
        file.write(heights.astype(np.float32), 1)


def page(seconds: float, rows: Sequence[Measured], flights: Sequence[Measured]) -> str:
    """Section "How fast"."""
    numba = "numba compiles rays and sampling" if _has_numba() else "numba is not installed"
    method = (
        f"`python benchmarks/live.py --seconds {seconds:g}` on {platform.machine()} with {os.cpu_count()} cores, which "
        "other programs used as well: the load is the system's mean over a minute, and counts the benchmark. "
        f"The server has one core, the client the others; {numba}. Frames of 640 x 480 as JPEG, tilts 0 to 60°, tiles "
        "cached; milliseconds from the request to the whole answer, as the client has it; those of the processor "
        "are the server's for a frame."
    )
    flight = (
        f"In real time: {RATE_HZ:g} poses a second at {SPEED_M_S:g} m/s, no tiles at first, {1e3 * TILE_S:g} ms for "
        f"each tile, a deadline of {1e3 * DEADLINE_S:g} ms."
    )
    head = "| | frames | per second | processor, ms | p50, ms | p99, ms | memory, MB | load |"
    table = [head, "| --- | --- | --- | --- | --- | --- | --- | --- |", *(one.row() for one in rows)]
    listed = (f"- {real_time_text(one)}" for one in flights)
    return "\n".join(["## How fast", "", method, "", *table, "", flight, "", *listed, ""])


def _has_numba() -> bool:
    from importlib.util import find_spec

    return find_spec("numba") is not None


def main() -> None:
    """Measure and print, or write, the section."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=20.0, help="of each measurement (%(default)s)")
    parser.add_argument("--docs", action="store_true", help='write the section "How fast" of docs/live.md')
    parser.add_argument("--only", metavar="TEXT", default="", help="measurements whose names contain this")
    parser.add_argument("--airsim", action="store_true", help="with AirSim's client, cosysairsim")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary, LoopbackServer() as tiles:
        relief = Path(temporary) / "relief.tif"
        write_relief(relief)
        url = tiles.template()
        hills = ["--elevation", str(relief), "--vertical-datum", "ellipsoid"]
        kinds = [("level ground", []), ("relief, 5 m cells", hills)]
        kinds.append(("relief, 0.3 m cells, houses", ["--elevation", "world"]))
        rows, flights = [], []
        for name, more in kinds:
            for ask, by in ((over_http, "HTTP"), *(((over_airsim, "AirSim"),) if asked.airsim else ())):
                if asked.only in (title := f"{name}, {by}"):
                    rows.append(ask(title, url, more, asked.seconds))
                    print(rows[-1].row(), flush=True)
        for name, more in kinds[:2]:
            if asked.only in (title := f"{name}, real time"):
                tiles.reset(latency_s=TILE_S)
                flights.append(asyncio.run(in_real_time(title, url, more, asked.seconds)))
                print(real_time_text(flights[-1]), flush=True)
    text = page(asked.seconds, rows, flights)
    print(text)
    if asked.docs:
        target = ROOT / "docs" / "live.md"
        before = target.read_text(encoding="utf-8")
        without = re.sub(r"## How fast\n.*?(?=\n## |\Z)", "", before, flags=re.DOTALL).rstrip()
        target.write_text(f"{without}\n\n{text}", encoding="utf-8")


if __name__ == "__main__":
    main()
