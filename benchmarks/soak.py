"""A capture of ten thousand pictures from a server of which a twentieth of the tiles fail, killed, stopped and resumed.

    python -m benchmarks.soak                    # writes docs/soak.md; some minutes
    python -m benchmarks.soak --images 1000 --docs /tmp

The server is a process of its own. Pixels of its tiles hold their own position, so that every pixel of every picture is
checked against where the plan says it is. Tiles fail in all the ways that `tests.support.faults` knows: some once, so
that another attempt brings them, some for good, until the server is healed. The run is killed (SIGKILL), cancelled and
stopped by spent quotas; each time it is resumed.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import re
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import SourceError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.requests_transport import RequestsTransport
from terrainav.core.imagery.http.transport import Timeouts
from terrainav.core.imagery.placeholder import Placeholder
from terrainav.core.imagery.xyz import XYZSource
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import Plan, plan
from terrainav.core.picture.map_frame import capture_window
from terrainav.core.storage.files import write_whole

from tests.support.faults import flat_placeholder
from tests.support.patterns import MODULUS, decode_position

ROOT = Path(__file__).resolve().parents[1]
LAT_DEG, LON_DEG, AGL_M, LONGEST_PX = 35.14, -89.86, 120.0, 400
#: Tiles in ten thousand that each of these falls on: once, or for good. Together a twentieth.
ONCE = dict.fromkeys(
    ("408", "425", "500", "502", "503", "504", "reset", "short-body", "stall", "stall-mid-body", "bad-copy"),
    25,
)
ONCE.update({"429-seconds": 5, "429-date": 5, "quota": 3})
FOR_GOOD = dict.fromkeys(
    (
        "204",
        "404",
        "410",
        "html",
        "truncated-jpeg",
        "corrupt-jpeg",
        "corrupt",
        "wrong-size",
        "flat",
        "transparent",
    ),
    20,
)
FOR_GOOD.update({"redirects": 15, "redirect-to-file": 15, "bomb": 5, "200MB": 3, "trickle": 9})
#: Short, so that what stalls costs the soak a second and not twenty.
TIMEOUTS = Timeouts(connect_s=5.0, read_s=1.0, whole_s=3.0)
CONNECTIONS = 16
#: Longest a whole soak may take for each picture, far more than it does; a run beyond it hangs.
LONGEST_S_PER_IMAGE = 0.5
#: Longest wait for threads that end by themselves when a source was closed.
SETTLE_S = 10.0


def plan_of(images: int) -> Plan:
    """Plan of about so many captures, in a box that is as high as wide."""
    side_deg, worked_out = 0.01 * math.sqrt(images / 100.0), None
    for _ in range(4):
        box = Box(LAT_DEG + side_deg / 2, LON_DEG - side_deg / 2, LAT_DEG - side_deg / 2, LON_DEG + side_deg / 2)
        mission = Mission(
            box, AGL_M, max_px=LONGEST_PX, overlap_along=0.25, overlap_across=0.25, max_images=10 * images
        )
        worked_out = plan(mission, PixelGrid())
        side_deg *= math.sqrt((images + 0.5) / len(worked_out))
    if worked_out is None:
        raise RuntimeError("no plan was made")
    return worked_out


def run(images: int, template: str, folder: Path, cancel_after: int) -> None:
    """One run in this process; prints what became of it."""
    worked_out = plan_of(images)
    client = Client(RequestsTransport(CONNECTIONS, TIMEOUTS), "Loopback", connections=CONNECTIONS, first_wait_s=0.2)
    placeholder = Placeholder(sha256=(sha256(flat_placeholder()).hexdigest(),))
    source = XYZSource(
        template,
        name="soak",
        title="Loopback",
        placeholder=placeholder,
        client=client,
        cache=TileCache(folder / "cache"),
    )
    done = 0
    stopped, result = "", None

    def note(progress: Any) -> None:
        nonlocal done
        done = progress.done

    try:
        result = capture(
            worked_out,
            source,
            folder / "out",
            connections=CONNECTIONS,
            resume=True,
            listener=Listener(progress=note, cancelled=lambda: 0 < cancel_after <= done),
        )
    except SourceError as refused:
        stopped = str(refused)
    source.close()
    deadline = time.monotonic() + SETTLE_S
    while threading.active_count() > 1 and time.monotonic() < deadline:
        time.sleep(0.05)
    told = {
        "stopped": stopped,
        "written": result.written if result else 0,
        "skipped": result.skipped if result else 0,
        "failed": len(result.failed) if result else 0,
        "cancelled": bool(result and result.cancelled),
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
        "threads": threading.active_count() - 1,
        "sockets": _sockets(),
    }
    print(json.dumps(told))


def _sockets() -> int:
    count = 0
    for entry in list(Path("/proc/self/fd").iterdir()):
        with suppress(OSError):
            count += str(entry.readlink()).startswith("socket:")
    return count


class Server:
    """The server's process."""

    def __init__(self) -> None:
        shares = [f"{kind}:{count / 1e4}:1" for kind, count in ONCE.items()]
        shares += [f"{kind}:{count / 1e4}" for kind, count in FOR_GOOD.items()]
        command = [sys.executable, "-m", "tests.support.tileserver", "--port=0", "--quiet", "--controlled"]
        self._process = subprocess.Popen(
            [*command, *(f"--fault={share}" for share in shares)],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.template = self._line()
        self._line()

    def _line(self) -> str:
        if self._process.stdout is None:
            raise RuntimeError("the server says nothing")
        return self._process.stdout.readline().strip()

    def tell(self, command: str) -> None:
        """Give a command."""
        if self._process.stdin is None:
            raise RuntimeError("the server hears nothing")
        self._process.stdin.write(command + "\n")
        self._process.stdin.flush()

    def counts(self) -> dict[str, Any]:
        """What it was asked so far."""
        self.tell("counts")
        counts: dict[str, Any] = json.loads(self._line())
        return counts

    def close(self) -> None:
        """End it."""
        self.tell("end")
        self._process.wait()


@contextmanager
def running(arguments: argparse.Namespace, server: Server, folder: Path, cancel_after: int = 0) -> Any:
    """Start a run in a process of its own; end it where it hangs."""
    command = [sys.executable, "-m", "benchmarks.soak", f"--images={arguments.images}", f"--run={folder}"]
    with subprocess.Popen(
        [*command, f"--template={server.template}", f"--cancel-after={cancel_after}"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        timer = threading.Timer(60.0 + LONGEST_S_PER_IMAGE * arguments.images, process.kill)
        timer.start()
        try:
            yield process
        finally:
            timer.cancel()


def finish(arguments: argparse.Namespace, server: Server, folder: Path, cancel_after: int = 0) -> dict[str, Any]:
    """Run to the end, and return what the run told."""
    began = time.monotonic()
    with running(arguments, server, folder, cancel_after) as process:
        text = process.stdout.read()
    if process.returncode != 0:
        raise SystemExit(f"a run ended with {process.returncode}")
    told: dict[str, Any] = {**json.loads(text), "seconds": time.monotonic() - began}
    print(told, flush=True)
    return told


def kill_amid(arguments: argparse.Namespace, server: Server, folder: Path, lines: int) -> dict[str, Any]:
    """Start a run and kill it once its journal has so many lines."""
    journal, began = folder / "out" / "journal.jsonl", time.monotonic()
    with running(arguments, server, folder) as process:
        while process.poll() is None and not (journal.exists() and journal.read_bytes().count(b"\n") >= lines):
            time.sleep(0.05)
        process.kill()
    told = {"killed": process.returncode < 0, "seconds": time.monotonic() - began}
    print(told, flush=True)
    return told


def checked(worked_out: Plan, folder: Path) -> dict[str, Any]:
    """Look at every pixel of every picture, and at what the table says of those that are not there."""
    table = Table.load(folder / "satellite" / "meta_data.csv")
    status = dict(zip(table.img_names, zip(table.status, table.reason)))
    reasons: Counter[str] = Counter()
    pictures = wrong_px = unnamed = 0
    for index, name in enumerate(worked_out.names):
        path, (state, reason) = folder / "satellite" / f"{name}.tif", status[f"{name}.tif"]
        if path.exists() != (state == "done") or (state == "failed") != bool(reason):
            unnamed += 1
        if not path.exists():
            reasons[re.sub(r"tile [\d/]+: ", "", reason)] += 1
            continue
        pictures += 1
        window = capture_window(worked_out, index)
        with Image.open(path) as image:
            columns, rows = decode_position(np.asarray(image))
        right = (np.arange(window.width_px) + int(window.left_px)) % MODULUS
        down = (np.arange(window.height_px) + int(window.top_px)) % MODULUS
        if columns.shape != (window.height_px, window.width_px):
            wrong_px += window.height_px * window.width_px
        else:
            wrong_px += int(((columns != right) | (rows != down[:, np.newaxis])).sum())
    parts = len(list(folder.rglob("*.part")))
    return {
        "pictures": pictures,
        "wrong_px": wrong_px,
        "unnamed": unnamed,
        "part_files": parts,
        "failed": sum(reasons.values()),
        "reasons": dict(reasons.most_common()),
    }


def soak(arguments: argparse.Namespace) -> dict[str, Any]:
    """Run, kill, cancel, resume, heal, resume; returns every figure."""
    began = time.monotonic()
    with tempfile.TemporaryDirectory(dir=arguments.folder) as name:
        folder, server, worked_out = Path(name), Server(), plan_of(arguments.images)
        try:
            runs = [kill_amid(arguments, server, folder, len(worked_out) // 5)]
            for cancel_after in (len(worked_out) // 5, 0):
                runs.append(finish(arguments, server, folder, cancel_after))
                while runs[-1]["stopped"]:
                    runs.append(finish(arguments, server, folder, cancel_after))
            faulty, counts = checked(worked_out, folder / "out"), server.counts()
            server.tell("heal")
            runs.append(finish(arguments, server, folder))
            healed, all_counts = checked(worked_out, folder / "out"), server.counts()
        finally:
            server.close()
    return {
        "images": len(worked_out),
        "tiles": worked_out.requests,
        "runs": runs,
        "faulty": faulty,
        "counts": counts,
        "healed": healed,
        "all_counts": all_counts,
        "seconds": time.monotonic() - began,
    }


def document(found: dict[str, Any]) -> str:
    """Page of the figures."""
    runs, faulty, healed = found["runs"], found["faulty"], found["healed"]
    counts, all_counts = found["counts"], found["all_counts"]
    once = sum(ONCE.values()) / 100
    for_good = sum(FOR_GOOD.values()) / 100
    whole = [run for run in runs if "peak_mb" in run]
    lines = [
        "# Soak test",
        "",
        "Made by `python -m benchmarks.soak`; all figures are from one run on one machine.",
        "",
        (
            f"Machine: {_processor()}, {os.cpu_count()} cores, {platform.system()}. "
            f"Python {platform.python_version()}, numpy {np.__version__}, Pillow {Image.__version__}."
        ),
        "",
        (
            f"{found['images']:,} images of up to {LONGEST_PX} px out of {found['tiles']:,} tiles, over "
            f"{CONNECTIONS} connections, from a server on the loopback interface in a separate process. Pixels of its "
            f"tiles encode their position. {once:g} % of the tiles fail once ({', '.join(ONCE)}), {for_good:g} % "
            f"permanently ({', '.join(FOR_GOOD)})."
        ),
        (
            "The run is killed after a fifth of the images and cancelled after another fifth; a provider's message "
            "that the quota is used up also stops it. Each time it is resumed; then the faults of the server are "
            "removed and it is resumed once more."
        ),
        "",
        "| run | ended | written | existing | failed | seconds | peak memory, MB | threads left | sockets left |",
        "| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for number, run_ in enumerate(runs, 1):
        if "killed" in run_:
            lines.append(f"| {number} | killed | | | | {run_['seconds']:.1f} | | | |")
            continue
        if run_["stopped"]:
            lines.append(
                f"| {number} | stopped: {run_['stopped']} | | | | {run_['seconds']:.1f} | {run_['peak_mb']:.0f} "
                f"| {run_['threads']} | {run_['sockets']} |"
            )
            continue
        ended = "cancelled" if run_["cancelled"] else "complete"
        lines.append(
            f"| {number} | {ended} | {run_['written']:,} | {run_['skipped']:,} | {run_['failed']:,} "
            f"| {run_['seconds']:.1f} | {run_['peak_mb']:.0f} | {run_['threads']} | {run_['sockets']} |"
        )
    lines += [
        "",
        "| check of every pixel of every image | with faults | without |",
        "| --- | ---: | ---: |",
        f"| images | {faulty['pictures']:,} | {healed['pictures']:,} |",
        f"| failed images, listed with the reason | {faulty['failed']:,} | {healed['failed']:,} |",
        f"| images missing without being listed | {faulty['unnamed']} | {healed['unnamed']} |",
        f"| wrong pixels | {faulty['wrong_px']} | {healed['wrong_px']} |",
        f"| incomplete files left | {faulty['part_files']} | {healed['part_files']} |",
        f"| tile requests | {counts['requests']:,} | {all_counts['requests']:,} |",
        (
            f"| of these, answered with a fault | {sum(counts['faults'].values()):,} "
            f"| {sum(all_counts['faults'].values()):,} |"
        ),
        f"| different tiles | {counts['unique']:,} | {all_counts['unique']:,} |",
        f"| requests per tile, without those answered with a fault | {_good(counts):.4f} | {_good(all_counts):.4f} |",
        f"| TCP connections | {counts['connections']:,} | {all_counts['connections']:,} |",
        "",
        (
            f"Peak memory of a run: {min(run['peak_mb'] for run in whole):.0f} to "
            f"{max(run['peak_mb'] for run in whole):.0f} MB. Whole test: {found['seconds']:.0f} s, with the checks."
        ),
        "",
        "## Reasons of failures",
        "",
        "| images | reason |",
        "| ---: | --- |",
        *(f"| {count:,} | {reason} |" for reason, count in faulty["reasons"].items()),
        "",
    ]
    return "\n".join(lines)


def _good(counts: dict[str, Any]) -> float:
    """Requests answered with a picture for each tile that had one."""
    return float((counts["requests"] - sum(counts["faults"].values())) / counts["unique"])


def _processor() -> str:
    found = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    return found.group(1).strip() if found else platform.machine()


def main() -> None:
    """Soak, or be one run of it."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--images", type=int, default=10_000)
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder of soak.md")
    parser.add_argument("--folder", type=Path, help="where the images are written for the time being")
    parser.add_argument("--run", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--template", help=argparse.SUPPRESS)
    parser.add_argument("--cancel-after", type=int, default=0, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.run:
        run(arguments.images, arguments.template, arguments.run, arguments.cancel_after)
        return
    found = soak(arguments)
    page = document(found)
    write_whole(arguments.docs / "soak.md", page.encode("utf-8"))
    print(page)
    wrong = [found[state][what] for state in ("faulty", "healed") for what in ("wrong_px", "unnamed", "part_files")]
    if any(wrong) or found["healed"]["failed"]:
        raise SystemExit("not as it should be")


if __name__ == "__main__":
    main()
