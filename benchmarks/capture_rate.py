"""How near a capture comes to the least time that is possible, and how other programs fare with the same job.

    python benchmarks/capture_rate.py --peers    # makes build/peers, where contextily is installed; once
    python benchmarks/capture_rate.py            # writes docs/capture_rate.md and docs/images/capture_rate.png
    python benchmarks/capture_rate.py --only floor --repeats 1

The job: footprints of about 646 x 487 px at zoom 19 with 25 % overlap, from a tile server in another process that takes
40 ms for each request and 80 ms more for each new connection. All of it takes about fourteen minutes on two cores that
have nothing else to do, nearly half of them waits at 4 connections.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path
from typing import Any

import numpy as np
from capture_contenders import Job, windows
from capture_floor import Terms, measure_terms
from capture_page import draw, page
from loopback_server import MODULUS, LoopbackServer, positions_of
from terrainav.core.storage.files import make_folder, write_whole

ROOT = Path(__file__).resolve().parents[1]
PEERS = ROOT / "build" / "peers"
LATENCY_S, CONNECT_S = 0.040, 0.080
#: Footprints along a side of the comparison; columns and rows of the missions whose memory is compared: one of two
#: thousand, and one ten times as large that is square too, so that as much as can be is shared.
FEW, MEMORY = 10, ((45, 45), (142, 143))
CONNECTIONS, FORMATS = (4, 16), ("jpg", "tif")
#: Of the missions that the floor is counted for: footprints along a side, and connections.
FLOORS = ((14, 8), (14, 16), (32, 4), (32, 16))
#: A folder that no disk stands behind, on Linux.
IN_MEMORY = "/dev/shm"  # noqa: S108 (holds folders of our own alone)
#: Of the floor, and megabytes, which are aimed at.
AIM, AIM_MB = 0.85, 400.0


def python_of(name: str) -> Path:
    """Interpreter a contender runs in."""
    return PEERS / "bin" / "python" if name == "contextily" else Path(sys.executable)


def install_peers() -> None:
    """Make the peers' own environment."""
    venv.create(PEERS, with_pip=True)
    subprocess.run([str(python_of("contextily")), "-m", "pip", "install", "--quiet", "contextily"], check=True)


def run(name: str, job: Job, server: LoopbackServer, *, waits: bool = True) -> dict[str, Any]:
    """Let a contender do the job in a process and folder of its own; what it took, and what the server saw."""
    folder = Path(job.folder)
    shutil.rmtree(folder, ignore_errors=True)
    if name != "ours":
        make_folder(folder)
    note = folder.with_suffix(".json")
    job.write(note)
    server.reset(latency_s=LATENCY_S if waits else 0.0, connect_s=CONNECT_S if waits else 0.0)
    done = subprocess.run(
        [str(python_of(name)), str(ROOT / "benchmarks" / "capture_contenders.py"), name, str(note)],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"{name}: {done.stderr[-2000:]}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    seen = server.counts()
    found.update(seen, server_cpu_s=seen["cpu_s"], cpu_s=found["cpu_s"], pictures=len(windows(job)))
    return found


def georeferencing_error_px(folder: Path) -> float | None:
    """Largest distance between where the pixels of pictures are and where their files say; None where they do not."""
    from osgeo import gdal

    gdal.UseExceptions()
    worst: list[float] = []
    half, metres = 20037508.342789244, 2.0 * 20037508.342789244 / (256 << 19)
    for path in sorted(folder.rglob("*.tif")):
        dataset = gdal.Open(str(path))
        west, across, _, north, _, down = dataset.GetGeoTransform(can_return_null=True) or [None] * 6
        if west is None or not dataset.GetProjection():
            return None
        pixels = np.moveaxis(dataset.ReadAsArray()[:3], 0, -1)
        told_x, told_y = positions_of(pixels)
        x = (west + (np.arange(pixels.shape[1]) + 0.5) * across + half) / metres - 0.5
        y = (half - north - (np.arange(pixels.shape[0]) + 0.5) * down) / metres - 0.5
        for told, meant in ((told_x, x[np.newaxis, :]), (told_y, y[:, np.newaxis])):
            off = (told - meant + MODULUS / 2.0) % MODULUS - MODULUS / 2.0
            worst.append(float(np.abs(off).max()))
    if not worst:
        raise SystemExit(f"{folder}: no images")
    return max(worst)


def compare(server: LoopbackServer, folder: Path) -> list[dict[str, Any]]:
    """All contenders on the job of a hundred footprints, one run each."""
    rows = []
    contenders = [("ours", c, f) for c in CONNECTIONS for f in FORMATS]
    contenders += [(name, 16, "jpg") for name in ("pool", "gdal", "qgis")]
    if python_of("contextily").exists():
        contenders.append(("contextily", 16, "tif"))
    else:
        print("contextily is left out: install it with --peers", flush=True)
    errors: dict[str, float | None] = {}
    for name, connections, image_format in contenders:
        job = Job(server.template(), str(folder / name), FEW, FEW, image_format, connections)
        found = run(name, job, server)
        if name not in errors:
            lossless = Job(server.template("positions"), str(folder / f"{name}-positions"), FEW, FEW, "tif", 16)
            run(name, lossless, server, waits=False)
            errors[name] = georeferencing_error_px(Path(lossless.folder))
        found.update(name=name, connections_asked=connections, image_format=image_format, error=errors[name])
        if name in ("qgis", "contextily"):
            found["image_format"] = "tif"
        print(f"{name} {connections} {image_format}: {found['wall_s']:.2f} s", flush=True)
        rows.append(found)
    return rows


def against_floor(server: LoopbackServer, terms: Terms, folder: Path, repeats: int) -> list[dict[str, Any]]:
    """Ours on two hundred and a thousand footprints and the floor of the same run, medians of the repeats."""
    rows = []
    for image_format in FORMATS:
        for side, connections in FLOORS:
            job = Job(server.template(), str(folder / "floor"), side, side, image_format, connections)
            runs = [run("ours", job, server) for _ in range(repeats)]
            row = {key: statistics.median(found[key] for found in runs) for key in runs[0]}
            row["shares_s"] = terms.shares_s(
                image_format, int(row["unique"]), int(row["pictures"]), connections, row["server_cpu_s"]
            )
            row["floor_s"] = max(row["shares_s"].values())
            row["share"] = row["floor_s"] / row["wall_s"]
            row.update(image_format=image_format, connections_asked=connections)
            row["walls_s"] = sorted(found["wall_s"] for found in runs)
            print(
                f"{row['pictures']:.0f} {image_format}, {connections} connections: {row['wall_s']:.2f} s, "
                f"floor {row['floor_s']:.2f} s, "
                f"{row['share']:.1%}",
                flush=True,
            )
            rows.append(row)
    return rows


def memory(server: LoopbackServer, folder: Path) -> list[dict[str, Any]]:
    """Peak memory of a small and a large mission, without waits."""
    rows = []
    for columns, lines in MEMORY:
        job = Job(server.template(), str(folder / "memory"), columns, lines, "jpg", 16)
        rows.append({**run("ours", job, server, waits=False), "shape": f"{columns} x {lines}"})
        print(f"{rows[-1]['pictures']} images: {rows[-1]['peak_mb']:.0f} MB", flush=True)
        shutil.rmtree(job.folder)
    return rows


def folder_in_memory() -> str | None:
    """A folder that no disk stands behind, where there is one: how long a disk takes is not the matter here."""
    return IN_MEMORY if os.access(IN_MEMORY, os.W_OK) else None


def main() -> None:
    """Measure, print a summary and write the page and its picture."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--peers", action="store_true", help="only make the environment of the peers")
    parser.add_argument("--only", choices=("floor", "compare", "memory"), help="one part; writes nothing")
    parser.add_argument("--repeats", type=int, default=5, help="runs whose median counts against the floor")
    parser.add_argument("--folder", default=folder_in_memory(), help="where images go for the time being")
    asked = parser.parse_args()
    if asked.peers:
        install_peers()
        return
    began = time.perf_counter()
    found: dict[str, Any] = {"repeats": asked.repeats, "floor": [], "compared": [], "memory": []}
    found["job"] = (LATENCY_S, CONNECT_S, FEW * FEW, AIM_MB)
    found["disk"] = "memory, so that no disk is measured" if asked.folder == IN_MEMORY else "a disk"
    with (
        tempfile.TemporaryDirectory(dir=asked.folder) as name,
        LoopbackServer(LATENCY_S, CONNECT_S) as server,
    ):
        folder = Path(name)
        first = windows(Job(server.template(), name))[0]
        found["terms"] = measure_terms(server, LATENCY_S, CONNECT_S, first)
        print(found["terms"], flush=True)
        if asked.only in (None, "floor"):
            found["floor"] = against_floor(server, found["terms"], folder, asked.repeats)
        if asked.only in (None, "compare"):
            found["compared"] = compare(server, folder)
        if asked.only in (None, "memory"):
            found["memory"] = memory(server, folder)
    if asked.only is None:
        found["load"] = f" Load average {os.getloadavg()[0]:.1f}." if hasattr(os, "getloadavg") else ""
        write_whole(ROOT / "docs" / "capture_rate.md", page(found).encode("utf-8"))
        draw(found, ROOT / "docs" / "images" / "capture_rate.png")
    low = [row for row in found["floor"] if row["share"] < AIM]
    large = [row for row in found["memory"] if row["peak_mb"] > AIM_MB]
    print(f"{time.perf_counter() - began:.0f} s; below {AIM:.0%}: {len(low)}, above {AIM_MB:.0f} MB: {len(large)}")


if __name__ == "__main__":
    main()
