"""QGIS's network stack against other ways to the same tiles, inside QGIS.

    python tools/qgis_app.py --timeout 900 benchmarks/qgis_transport.py      # writes docs/qgis_transport.md

One tile server on the loopback in a process of its own serves all ways, which take turns. Ways: the plugin's transport
(`QgisTransport`), the command's (`RequestsTransport`, which asks urllib3's pools), a Session of requests, and QGIS's
own `QgsBlockingNetworkRequest` on a QThread for each connection. Then a whole capture over each of the first two.
All of it runs beside the main thread, whose event loop turns as it does in the application.
"""

from __future__ import annotations

import os
import platform
import queue
import statistics
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from functools import partial
from pathlib import Path
from typing import NamedTuple, TypeVar

import requests
from qgis.core import Qgis, QgsBlockingNetworkRequest, QgsFeedback
from qgis.PyQt.QtCore import QT_VERSION_STR, QEventLoop, QThread, QTimer, QUrl
from qgis.PyQt.QtNetwork import QNetworkRequest
from requests.adapters import HTTPAdapter
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.http.requests_transport import RequestsTransport
from terrainav.core.imagery.xyz import XYZSource
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import Plan, plan
from terrainav.core.report.machine import machine
from terrainav.terrainav_plugin.network.transport import QgisTransport

sys.path.insert(0, str(Path(__file__).resolve().parent))
from loopback_server import LoopbackServer

RESULT = Path(__file__).resolve().parents[1] / "docs" / "qgis_transport.md"
#: Tiles of the job that tile servers are commonly compared by, and waits as over a good line.
TILES, LATENCY_S, CONNECT_S = 336, 0.040, 0.080
#: Tiles where nothing waits, so that the client's own work is all there is.
TILES_AT_ONCE = 2_000
CONNECTIONS = (4, 16)
ROUNDS = 5
TIMEOUT_S = 20.0
#: Milliseconds between two looks at whether what runs beside the main thread has ended.
LOOK_MS = 20
MAIN = "main thread"

Result = TypeVar("Result")
Fetch = Callable[[Sequence[str]], list[bytes]]


class Cost(NamedTuple):
    """Of one job."""

    wall_s: float
    cpu_s: float
    connections: float


# --- ways


@contextmanager
def over_qgis(connections: int) -> Iterator[Fetch]:
    """Ask through the plugin's transport."""
    with closing(QgisTransport(connections)) as transport:
        yield lambda urls: _on_threads(connections, lambda url: transport.get(url).body, urls)


@contextmanager
def over_urllib3(connections: int) -> Iterator[Fetch]:
    """Ask through the command's transport."""
    with closing(RequestsTransport(connections)) as transport:
        yield lambda urls: _on_threads(connections, lambda url: transport.get(url).body, urls)


@contextmanager
def over_requests(connections: int) -> Iterator[Fetch]:
    """Ask a Session of requests with a pool as large as the connections."""
    with requests.Session() as session:
        session.mount("http://", HTTPAdapter(pool_maxsize=connections))
        yield lambda urls: _on_threads(connections, lambda url: session.get(url, timeout=TIMEOUT_S).content, urls)


@contextmanager
def over_blocking(connections: int) -> Iterator[Fetch]:
    """Ask QGIS's blocking requests, each QThread with a manager and so a connection of its own."""

    def fetch(urls: Sequence[str]) -> list[bytes]:
        waiting: queue.SimpleQueue[tuple[int, str]] = queue.SimpleQueue()
        for numbered in enumerate(urls):
            waiting.put(numbered)
        bodies = [b""] * len(urls)
        threads = [_Blocking(waiting, bodies) for _ in range(connections)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.wait()
        return bodies

    yield fetch


class _Blocking(QThread):
    def __init__(self, waiting: queue.SimpleQueue[tuple[int, str]], bodies: list[bytes]) -> None:
        super().__init__()
        self._waiting, self._bodies = waiting, bodies

    def run(self) -> None:
        while True:
            try:
                index, url = self._waiting.get_nowait()
            except queue.Empty:
                return
            request = QgsBlockingNetworkRequest()
            request.get(QNetworkRequest(QUrl(url)), True, QgsFeedback())
            self._bodies[index] = bytes(request.reply().content())


def _on_threads(connections: int, fetch: Callable[[str], bytes], urls: Sequence[str]) -> list[bytes]:
    with ThreadPoolExecutor(connections) as pool:
        return list(pool.map(fetch, urls))


WAYS = {
    "requests, a Session": over_requests,
    "the command's transport (urllib3)": over_urllib3,
    "**the plugin's transport (QGIS)**": over_qgis,
    "QgsBlockingNetworkRequest on QThreads": over_blocking,
}


# --- measuring


def beside_main(job: Callable[[], Result]) -> Result:
    """Run a job in a thread of its own while the event loop of the main one turns."""
    with ThreadPoolExecutor(1) as pool:
        running, loop, timer = pool.submit(job), QEventLoop(), QTimer()
        timer.timeout.connect(lambda: running.done() and loop.quit())
        timer.start(LOOK_MS)
        loop.exec()
        timer.stop()
        return running.result()


def measure(server: LoopbackServer, way: str, connections: int, tiles: int, latency_s: float, connect_s: float) -> Cost:
    """One job over one way."""
    server.reset(latency_s=latency_s, connect_s=connect_s)
    urls = [server.template().format(z=19, x=x, y=1) for x in range(tiles)]
    with WAYS[way](connections) as fetch:
        cpu_s, began = time.process_time(), time.perf_counter()
        bodies = fetch(urls)
        wall_s, cpu_s = time.perf_counter() - began, time.process_time() - cpu_s
    counts = server.counts()
    if not all(body.startswith(b"\xff\xd8") and body.endswith(b"\xff\xd9") for body in bodies):
        raise SystemExit(f"{way}: a tile is not whole")
    if counts["requests"] != tiles or counts["unique"] != tiles:
        raise SystemExit(f"{way}: {counts['requests']} requests for {tiles} tiles")
    return Cost(wall_s, cpu_s, counts["connections"])


def in_turns(jobs: dict[str, Callable[[], Cost]]) -> dict[str, Cost]:
    """Medians over rounds in which every job has its turn; the first round warms up."""
    costs: dict[str, list[Cost]] = {name: [] for name in jobs}
    for turn in range(ROUNDS + 1):
        for name, job in jobs.items():
            cost = beside_main(job)
            if turn:
                costs[name].append(cost)
    return {name: Cost(*map(statistics.median, zip(*found))) for name, found in costs.items()}


def table(server: LoopbackServer, tiles: int, latency_s: float, connect_s: float) -> list[str]:
    """Rows of all ways at all numbers of connections."""
    rows = [
        "| connections | way | wall s | of requests | CPU ms a tile | of requests | TCP connections |",
        "| ---: | --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for connections in CONNECTIONS:
        found = in_turns({way: partial(measure, server, way, connections, tiles, latency_s, connect_s) for way in WAYS})
        base = found["requests, a Session"]
        for way, cost in found.items():
            print(f"{connections} connections, {latency_s:g} s, {way}: {cost}", flush=True)
            rows.append(
                f"| {connections} | {way} | {cost.wall_s:.2f} | {cost.wall_s / base.wall_s:.2f} "
                f"| {1e3 * cost.cpu_s / tiles:.2f} | {cost.cpu_s / base.cpu_s:.2f} | {cost.connections:.0f} |"
            )
    return rows


def captures(server: LoopbackServer) -> tuple[list[str], Plan]:
    """Rows of a whole capture over the plugin's transport and the command's, JPEG."""
    mission = Mission(
        Box(35.14, -89.87, 35.131, -89.859),
        agl_m=120.0,
        overlap_along=0.25,
        overlap_across=0.25,
        zoom=19,
        max_px=1280,
        source=server.template(),
        image_format="jpg",
    )
    steps = plan(mission, XYZSource(server.template()).grid)
    rows = [
        "| connections | wall s, command's | plugin's | ratio | CPU s, command's | plugin's | ratio |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for connections in CONNECTIONS:
        found = in_turns(
            {
                "command": partial(captured, server, steps, RequestsTransport, connections),
                "plugin": partial(captured, server, steps, QgisTransport, connections),
            }
        )
        print(f"captures, {connections} connections: {found}", flush=True)
        command, plugin = found["command"], found["plugin"]
        rows.append(
            f"| {connections} | {command.wall_s:.2f} | {plugin.wall_s:.2f} | {plugin.wall_s / command.wall_s:.2f} "
            f"| {command.cpu_s:.2f} | {plugin.cpu_s:.2f} | {plugin.cpu_s / command.cpu_s:.2f} |"
        )
    return rows, steps


def captured(
    server: LoopbackServer,
    steps: Plan,
    transport: type[QgisTransport] | type[RequestsTransport],
    connections: int,
) -> Cost:
    """One capture."""
    server.reset(latency_s=LATENCY_S, connect_s=CONNECT_S)
    source = XYZSource(server.template(), transport=transport(connections), connections=connections)
    with tempfile.TemporaryDirectory() as folder, closing(source):
        cpu_s, began = time.process_time(), time.perf_counter()
        result = capture(steps, source, Path(folder) / "dataset", connections=connections)
        wall_s, cpu_s = time.perf_counter() - began, time.process_time() - cpu_s
    counts = server.counts()
    if result.written != len(steps) or counts["requests"] != steps.requests:
        raise SystemExit(f"{result.written} of {len(steps)} images, {counts['requests']} requests")
    return Cost(wall_s, cpu_s, counts["connections"])


def shares(server: LoopbackServer) -> list[str]:
    """Milliseconds a tile of each kind of thread while the plugin's transport is at work, nothing waiting."""
    server.reset(latency_s=0.0, connect_s=0.0)
    urls = [server.template().format(z=19, x=x, y=1) for x in range(4 * TILES_AT_ONCE)]
    with closing(QgisTransport(CONNECTIONS[0])) as transport, ThreadPoolExecutor(CONNECTIONS[0]) as pool:
        list(pool.map(transport.get, urls[:100]))
        before = cpu_by_thread()
        list(pool.map(transport.get, urls))
        after = cpu_by_thread()
    known = {
        MAIN: "the main thread: making requests, reading answers, their signals",
        "QNetworkAccessM": "Qt's own thread below it: sockets and HTTP",
    }
    spent: Counter[str] = Counter()
    for name, seconds in after.items():
        spent[known.get(name, "threads that ask, and QGIS's others")] += seconds - before[name]
    rows = ["| thread | CPU ms a tile |", "| --- | ---: |"]
    return rows + [f"| {name} | {1e3 * seconds / len(urls):.2f} |" for name, seconds in spent.most_common()]


def cpu_by_thread() -> Counter[str]:
    """Seconds of the processor that threads have used, by name; `MAIN` for the main one, whose name others have."""
    spent: Counter[str] = Counter()
    for task in Path("/proc/self/task").iterdir():
        name, _, rest = (task / "stat").read_text().partition("(")[2].rpartition(")")
        fields = rest.split()
        spent[MAIN if task.name == str(os.getpid()) else name] += (int(fields[11]) + int(fields[12])) / os.sysconf(
            "SC_CLK_TCK"
        )
    return spent


def main() -> None:
    """Measure everything and write the page."""
    with LoopbackServer() as server:
        waiting = table(server, TILES, LATENCY_S, CONNECT_S)
        at_once = table(server, TILES_AT_ONCE, 0.0, 0.0)
        spent = beside_main(partial(shares, server))
        whole, steps = captures(server)
    page = PAGE.format(
        machine=", ".join(f"{value} {label}" if label == "cores" else value for label, value in machine()),
        qgis=Qgis.QGIS_VERSION.partition("-")[0],
        qt=QT_VERSION_STR,
        python=platform.python_version(),
        requests=requests.__version__,
        rounds=ROUNDS,
        first=CONNECTIONS[0],
        tiles=TILES,
        latency_ms=1e3 * LATENCY_S,
        connect_ms=1e3 * CONNECT_S,
        waiting="\n".join(waiting),
        tiles_at_once=f"{TILES_AT_ONCE:,}",
        at_once="\n".join(at_once),
        spent="\n".join(spent),
        images=len(steps),
        unique=steps.requests,
        whole="\n".join(whole),
    )
    RESULT.write_text(page, encoding="utf-8")
    print(f"wrote {RESULT}")


PAGE = """\
# QGIS's network stack as a transport

Made by `python tools/qgis_app.py --timeout 900 benchmarks/qgis_transport.py`, inside QGIS; every figure is the median
of {rounds} rounds in which all clients took turns on one machine; only the ratios are transferable.

Machine: {machine}. QGIS {qgis}, Qt {qt}, Python {python}, requests {requests}.

## {tiles} tiles, {latency_ms:.0f} ms a request, {connect_ms:.0f} ms a new connection

JPEGs of about 12 kB from one server on the loopback interface. *Of requests* is the ratio to a `requests.Session` in
the same rounds.

{waiting}

## {tiles_at_once} tiles without waits

The processor is the only limit here.

{at_once}

Processor time of the plugin's transport by thread, at {first} connections:

{spent}

## A capture of {images} images from {unique} tiles

The same waits as in the first table, JPEG, with the transports of the command and of the plugin.

{whole}

## What the transport uses of QGIS

The transport uses the proxies in QGIS's settings (with their exceptions and credentials), the certificates and servers
of the authentication database (trusted authorities, permanently ignored certificate errors), authentication
configurations, and request hooks of plugins. It does not use the rest of `QgsNetworkAccessManager`, which, in QGIS 3.22
as in later versions, is made for layers:

- It overwrites the `User-Agent`, which identifies TerrAInav to tile servers.
- It opens dialogs about certificates, passwords and proxies, and waits until the user closes them. Here each is an
  error message.
- Its timer, and `QgsBlockingNetworkRequest` on any failure, write the whole address with its key to the message log,
  and listeners to its signals, such as the network logger, get every address. Requests of a capture are not logged
  there.
- `QgsBlockingNetworkRequest` returns "no error" and an empty body if a request was cancelled or a body stalled, follows
  any number of redirects, has no limit for a body, and overrides the request's cache setting.

Properties of Qt and PyQt that shaped the transport:

- Certificate errors that are ignored for one session only cannot be read from Python and have no effect.
- 400 and 418 are reported as "protocol error" with a complete response; the response is used.
- A proxy's refusal for http is reported like one of the server; the proxies for the address show who refused.
- Qt opens at most six connections to a server for each manager, so there is a manager for every six. If responses
  arrive faster than connections, it may open one connection more than there are requests, up to six; the number of
  simultaneous requests is never exceeded.
- Qt does not signal that a connection is established: one time limit applies to connecting and to silence.
- If a read buffer limit (`setReadBufferSize`) reaches Qt's network thread after the request has failed there, for
  example at a proxy that refuses, it causes a segmentation fault (Qt 5.15). Instead, the received size is checked 20
  times a second.
- If a connection ends in the middle of a chunked body, Qt may take that for the end of the body. Such a tile fails when
  it is decoded, and is not requested again in that run.
- Qt 5.15 accepts any number of header lines, and takes time in the main thread that grows with the square of their
  number before it reports the response. A server that sends more than 100 gets no more requests, and current requests
  to it are aborted; the first such response blocks QGIS for as long as Qt takes.
- PyQt keeps a list of the Qt objects that Python has seen. It removes destroyed objects in the main thread, without
  Python's lock, even while other threads use the list. It notices objects destroyed in other threads late, and then
  takes a new object at the same address for the old one. Replies that are created or deleted outside the main thread
  therefore crash QGIS sooner or later. So all replies live in the main thread, which deletes them while it holds the
  lock (`sip.delete`, not `deleteLater`), and requesting threads touch no Qt object.
- Responses therefore arrive while the event loop of the main thread runs. Time in which it does not run, for example
  while a big layer is loaded, does not count towards time limits; requests can be abandoned without it.
"""

if __name__ == "__main__":
    main()
