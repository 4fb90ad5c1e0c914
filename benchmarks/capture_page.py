"""Page and picture of the capture benchmark."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from capture_floor import Terms
from terrainav.core.capture.pipeline import MEMORY_BYTES
from terrainav.core.report.machine import machine
from terrainav.core.storage.files import make_folder

Row = dict[str, Any]

TITLES = {
    "ours": "TerrAInav",
    "pool": "plain thread pool, requests",
    "contextily": "contextily, bounds2raster",
    "gdal": "GDAL's TMS driver",
    "qgis": "QGIS, native:rasterize",
}
#: Okabe and Ito's, which people who are colour-blind tell apart.
BLUE, ORANGE, GREY = "#0072B2", "#E69F00", "#999999"

HEAD = """\
# Rate of capture

Made by `python benchmarks/capture_rate.py` on {machine}. A tile server in another process takes {latency:.0f} ms for
each request and {connect:.0f} ms more for each new connection; tiles are JPEGs of {kb:.1f} kB; pictures are about
646 x 487 px at zoom 19 with 25 % overlap. All programs write to {disk}.{load}

![Time of each program compared with the floor](images/capture_rate.png)"""
FLOOR = """\
## Against the floor

No program can be quicker than max(waits, bandwidth, processors) for U unique tiles, N pictures and C connections:
ceil(U / C) t_request + t_connect; U tiles at the bandwidth; (U (t_http + t_decode) + N t_encode + the server's own
processor time) / cores. Measured in the same run:

| term | measured |
| --- | ---: |
| t_request, wall time over an open connection | {request:.2f} ms |
| t_connect, wall time that the first request takes longer | {connect:.1f} ms |
| t_http, processor time with http.client | {http:.3f} ms |
| t_decode, processor time of a tile with Pillow | {decode:.3f} ms |
| t_encode, processor time of assembling and encoding as JPEG | {jpg:.2f} ms |
| t_encode, as lossless GeoTIFF | {tif:.2f} ms |
| bandwidth | {bandwidth:.0f} MB/s |
| cores | {cores} |

Medians of {repeats} runs, and the shortest and the longest."""
BESIDE = """\
## Comparison with other programs

{pictures} pictures, one run each. The error is the largest distance between the true position of a pixel, which its
value encodes in a run with lossless tiles, and its position by the file's georeference."""
MEMORY = """\
## Memory

Peak memory of the process, including Python and numpy, without waits, at 16 connections, JPEG; {limit:.0f} MB are the
limit. A square mission is the hardest case of its size: tiles that one strip of images shares with the next are kept,
because each is fetched and decoded once. Beyond {kept:.0f} MB they are kept in a temporary file."""


def table(head: str, rows: list[list[str]]) -> str:
    """Markdown; the first column is text, the others numbers."""
    columns = head.count("|")
    lines = [f"| {head} |", "| --- " + "| ---: " * columns + "|"]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def page(found: Row) -> str:
    """Text of docs/capture_rate.md."""
    terms: Terms = found["terms"]
    latency_s, connect_s, few, limit_mb = found["job"]
    parts = [
        HEAD.format(
            machine=", ".join(f"{what} {value}" for what, value in machine()),
            latency=latency_s * 1e3,
            connect=connect_s * 1e3,
            kb=terms.tile_bytes / 1e3,
            disk=found["disk"],
            load=found["load"],
        ),
        FLOOR.format(
            request=terms.request_s * 1e3,
            connect=terms.connect_s * 1e3,
            http=terms.http_s * 1e3,
            decode=terms.decode_s * 1e3,
            jpg=terms.encode_s["jpg"] * 1e3,
            tif=terms.encode_s["tif"] * 1e3,
            bandwidth=terms.bandwidth_bytes_per_s / 1e6,
            cores=terms.cores,
            repeats=found["repeats"],
        ),
        _floor_table(found["floor"]),
        BESIDE.format(pictures=few),
        _compared_table(found["compared"]),
        MEMORY.format(limit=limit_mb, kept=MEMORY_BYTES / 1e6),
        _memory_table(found["memory"]),
    ]
    return "\n\n".join(parts) + "\n"


def _floor_table(rows: list[Row]) -> str:
    return table(
        "format | images | connections | unique tiles | requests a tile | waits s | bandwidth s | processors s | "
        "floor s | wall s | least, most s | of the floor",
        [
            [
                row["image_format"],
                f"{row['pictures']:.0f}",
                str(row["connections_asked"]),
                f"{row['unique']:.0f}",
                f"{row['requests'] / row['unique']:.2f}",
                *(f"{seconds:.2f}" for seconds in row["shares_s"].values()),
                f"{row['floor_s']:.2f}",
                f"{row['wall_s']:.2f}",
                f"{row['walls_s'][0]:.2f}, {row['walls_s'][-1]:.2f}",
                f"{row['share']:.1%}",
            ]
            for row in rows
        ],
    )


def _compared_table(rows: list[Row]) -> str:
    return table(
        "program | connections | format | wall s | tile requests | unique | TCP connections | CPU s | peak MB | "
        "error px",
        [
            [
                TITLES[row["name"]],
                str(row["connections_asked"]),
                row["image_format"],
                f"{row['wall_s']:.2f}",
                str(row["requests"]),
                str(row["unique"]),
                str(row["connections"]),
                f"{row['cpu_s']:.2f}",
                f"{row['peak_mb']:.0f}",
                "none written" if row["error"] is None else f"{row['error']:.2f}",
            ]
            for row in rows
        ],
    )


def _memory_table(rows: list[Row]) -> str:
    return table(
        "columns x rows | images | tile requests | peak MB",
        [
            [
                row["shape"],
                f"{row['pictures']}",
                str(row["requests"]),
                f"{row['peak_mb']:.0f}",
            ]
            for row in rows
        ],
    )


def draw(found: Row, path: Path) -> None:
    """Bars of wall time: ours against the floor, and all programs on the small job."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot as plt

    latency_s, _, few, _ = found["job"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.8), layout="constrained")
    rows = found["floor"]
    at = np.arange(len(rows))
    left.barh(at - 0.2, [row["floor_s"] for row in rows], 0.38, color=GREY, label="least time possible")
    left.barh(at + 0.2, [row["wall_s"] for row in rows], 0.38, color=BLUE, label="TerrAInav")
    for place, row in zip(at, rows):
        left.text(row["wall_s"], place + 0.2, f" {row['share']:.0%} of the floor", va="center", fontsize=9)
    names = [f"{row['pictures']:.0f} {row['image_format']}, {row['connections_asked']} connections" for row in rows]
    left.set(yticks=at, yticklabels=names, xlabel="wall time, s")
    left.set_title("Missions of 196 and 1,024 images against the floor")
    left.margins(x=0.3)
    left.legend(loc="lower right")
    rows = sorted(found["compared"], key=lambda row: float(row["wall_s"]))
    labels = [f"{TITLES[row['name']]}\n{row['connections_asked']} connections, {row['image_format']}" for row in rows]
    right.barh(
        labels,
        [row["wall_s"] for row in rows],
        color=[BLUE if row["name"] == "ours" else ORANGE for row in rows],
    )
    for place, row in enumerate(rows):
        right.text(row["wall_s"], place, f" {row['wall_s']:.1f} s", va="center", fontsize=9)
    right.set(xlabel="wall time, s")
    right.set_title(f"{few} images, {latency_s * 1e3:.0f} ms a request: each program once")
    right.margins(x=0.15)
    right.tick_params(axis="y", labelsize=8)
    for axes in (left, right):
        axes.invert_yaxis()
        axes.spines[["top", "right"]].set_visible(False)
    make_folder(path.parent)
    figure.savefig(path, dpi=110)
    plt.close(figure)
