"""Images from a local raster in its own pixels, beside GDAL's and rasterio's windows of the same cut.

    python benchmarks/rasters.py                     # writes docs/rasters.md; about ten minutes
    python benchmarks/rasters.py --repeats 1 --side 8000 --no-page
    python benchmarks/rasters.py --file ortho.tif    # a raster of your own; kept in build/ otherwise

The raster is a COG of 20,000 x 20,000 px in UTM 16 N, deflate, painted by the embedded world; the job are its windows
of 640 x 480 px with 25 % overlap that a plan has. Each program cuts them in a process of its own, in turns.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
#: A folder that no disk stands behind, on Linux.
IN_MEMORY = "/dev/shm"  # noqa: S108 (holds folders of our own alone)
EPSG, WEST, NORTH, PIXEL_M = 32616, 240_000.0, 3_900_000.0, 0.5
BLOCK_PX, WORLD_ZOOM = 512, 18
AGL_M, OVERLAP = 243.0, 0.25
#: As `core.capture.writers` packs GeoTIFF, and GDAL's quickest level, whose files are the nearest in size.
PREDICTOR, LEVEL = 2, 1
TITLES = {
    "ours": "TerrAInav",
    "gdal": "gdal.Translate, srcWin",
    "rasterio": "rasterio, read and write",
}
#: Program, threads.
CONTENDERS = (("ours", 2), ("gdal", 1), ("rasterio", 1), ("gdal", 2), ("rasterio", 2))
#: Columns and rows of windows, and overlap, of the missions whose memory is compared.
MEMORY = ((8, 8, 0.25), (32, 32, 0.25), (48, 48, 0.5))


def paint(path: Path, side: int) -> None:
    """Write the raster: satellite tiles of the embedded world, side by side."""
    from osgeo import gdal, osr
    from terrainav.core.world import World

    gdal.UseExceptions()
    world, plain = World(2024), path.with_suffix(".plain.tif")
    system = osr.SpatialReference()
    system.ImportFromEPSG(EPSG)
    raster = gdal.GetDriverByName("GTiff").Create(
        str(plain), side, side, 3, gdal.GDT_Byte, ["TILED=YES", "INTERLEAVE=PIXEL", "BIGTIFF=YES"]
    )
    raster.SetGeoTransform((WEST, PIXEL_M, 0.0, NORTH, 0.0, -PIXEL_M))
    raster.SetProjection(system.ExportToWkt())
    x0, y0 = (int(place * 2**WORLD_ZOOM) for place in (0.25038, 0.39581))
    for top in range(0, side, 256):
        for left in range(0, side, 256):
            tile = world.tile("satellite", WORLD_ZOOM, x0 + left // 256, y0 + top // 256)
            tile = np.ascontiguousarray(tile[: side - top, : side - left].transpose(2, 0, 1))
            raster.WriteRaster(left, top, tile.shape[2], tile.shape[1], tile.tobytes())
    raster = None
    options = [
        "COMPRESS=DEFLATE",
        "PREDICTOR=2",
        f"BLOCKSIZE={BLOCK_PX}",
        "NUM_THREADS=ALL_CPUS",
        "BIGTIFF=YES",
    ]
    part = path.with_suffix(".part.tif")
    gdal.Translate(str(part), str(plain), format="COG", creationOptions=options)
    plain.unlink()
    os.replace(part, path)


def planned(file: str, columns: int, rows: int, overlap: float) -> Any:
    """Plan of about ``columns`` x ``rows`` images in the middle of the raster, and the open source."""
    from terrainav.core.imagery.raster.source import open_raster
    from terrainav.core.mission.areas.area import Polygon
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    source = open_raster(file)
    own = source.grid.plane
    if own.wraps:
        raise SystemExit(f"{file}: has no pixels of its own in a projected CRS")
    size_px = source._sizes[0]  # noqa: SLF001
    pixel = source.grid.pixel_size(source.grid.native_zoom)[0]
    x, y = own.west + size_px[0] * pixel / 2.0, own.north - size_px[1] * pixel / 2.0
    width_m, height_m = Mission(Polygon((((0, 0), (1, 0), (1, 1)),)), AGL_M).camera.ground_size_m(AGL_M)
    halves = (
        (columns * (1.0 - overlap)) * width_m / 2.0,
        (rows * (1.0 - overlap)) * height_m / 2.0,
    )
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * halves
    lat, lon = own.from_crs(x + signs[:, 0], y + signs[:, 1])
    area = Polygon((tuple(zip(lon.tolist(), lat.tolist())),))
    mission = Mission(area, AGL_M, overlap_along=overlap, overlap_across=overlap, source=file)
    return plan(mission, source.grid), source


def windows(worked_out: Any, grid: Any) -> list[tuple[int, int, int, int]]:
    """Left, top, width and height of the images in pixels of the raster."""
    if worked_out.zoom != grid.native_zoom:
        raise SystemExit("the images are not made of the raster's own pixels")
    held = worked_out.windows
    parts = (held.left_px, held.top_px, held.width_px, held.height_px)
    return [tuple(int(value) for value in row) for row in zip(*parts)]  # type: ignore[misc]


def ours(job: dict[str, Any]) -> None:
    """Capture the mission."""
    from terrainav.core.capture import writers
    from terrainav.core.capture.runner import capture

    if not job["packed"]:
        writers._ZLIB_LEVEL = 0  # noqa: SLF001
    worked_out, source = planned(job["file"], *job["shape"])
    result = capture(worked_out, source, job["folder"], connections=job["threads"], workers=job["threads"])
    source.close()
    if result.failed:
        raise SystemExit(f"{result.failed} images failed")


def in_threads(job: dict[str, Any], cut: Callable[[Any, int, list[int]], None], opened: Callable[[], Any]) -> None:
    """Cut all windows, each thread from a dataset of its own."""
    held = threading.local()

    def one(asked: tuple[int, list[int]]) -> None:
        if not hasattr(held, "raster"):
            held.raster = opened()
        cut(held.raster, *asked)

    Path(job["folder"]).mkdir(parents=True)
    with ThreadPoolExecutor(job["threads"]) as threads:
        for _ in threads.map(one, enumerate(job["windows"])):
            pass


def by_gdal(job: dict[str, Any]) -> None:
    """Cut by gdal.Translate."""
    from osgeo import gdal

    gdal.UseExceptions()
    packing = ["COMPRESS=DEFLATE", f"PREDICTOR={PREDICTOR}", f"ZLEVEL={job['level']}"] if job["packed"] else []

    def cut(raster: Any, n: int, window: list[int]) -> None:
        gdal.Translate(
            f"{job['folder']}/{n}.tif", raster, srcWin=window, creationOptions=["INTERLEAVE=PIXEL", *packing]
        )

    in_threads(job, cut, lambda: gdal.Open(job["file"]))


def by_rasterio(job: dict[str, Any]) -> None:
    """Cut by rasterio's windows."""
    import rasterio
    from affine import Affine
    from rasterio.windows import Window

    packing = {"compress": "deflate", "predictor": PREDICTOR, "zlevel": job["level"]} if job["packed"] else {}

    def cut(raster: Any, n: int, window: list[int]) -> None:
        pixels, lies = raster.read(window=Window(*window)), raster.transform
        profile = {
            "driver": "GTiff", "dtype": "uint8", "count": pixels.shape[0], "interleave": "pixel",
            "width": pixels.shape[2], "height": pixels.shape[1], "crs": raster.crs, **packing,
        }  # fmt: skip
        with rasterio.open(
            f"{job['folder']}/{n}.tif",
            "w",
            transform=Affine(lies.a, 0.0, lies.c + window[0] * lies.a, 0.0, lies.e, lies.f + window[1] * lies.e),
            **profile,
        ) as written:
            written.write(pixels)

    in_threads(job, cut, lambda: rasterio.open(job["file"]))


HEAD = """\
# Images from rasters

Made by `python benchmarks/rasters.py` on {machine}, load average {load:.1f}. A local COG of {side:,} x {side:,} px
({file_mb:,.0f} MB, deflate, blocks of {block} px) is cut into the {images:,} images of about 640 x 480 px of a plan
with 25 % overlap, straight down, as GeoTIFF in memory. All programs make the same pixels at the same place, which is
checked; TerrAInav also records each image in its journal, computes its entropy and writes tables. Each run is a
separate process, including imports and planning; {runs}, taken in turns. “Not compressed” is stored deflate (level 0)
in TerrAInav's images.

| output | program | threads | images/s | TerrAInav to it | wall s (least, most) | CPU s | peak MB | output MB |
| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |
"""
ROW = (
    "| {output} | {title} | {threads} | {rate:.0f} | {ratio:.2f} | {wall_s:.1f} ({least:.1f}, {most:.1f}) | "
    "{cpu_s:.1f} | {peak_mb:.0f} | {mb:.0f} |\n"
)
STAGES = """
## Time of each step

Processor milliseconds per image, one thread: {stages}. *Parts* are read from the raster, 512 px each; *all else* is
planning, assembling, compression, entropy, journal and tables. Cutting alone, as the other programs do for images that
are not compressed, takes a few milliseconds.

## Memory

GDAL caches blocks of a raster in at most 64 MB (`GDAL_CACHEMAX`; by default in 5 % of the machine's memory).

| images | peak MB |
| ---: | ---: |
"""

PROGRAMS = {"ours": ours, "gdal": by_gdal, "rasterio": by_rasterio}


def contend(name: str, note: Path) -> None:
    """Do the job of a note in this process, and print what it took."""
    job = json.loads(note.read_text("utf-8"))
    start, cpu = time.perf_counter(), time.process_time()
    PROGRAMS[name](job)
    wall_s, cpu_s = time.perf_counter() - start, time.process_time() - cpu
    peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"wall_s": wall_s, "cpu_s": cpu_s, "peak_mb": peak_mb}))


def run(name: str, job: dict[str, Any]) -> dict[str, Any]:
    """Let a program do a job in a process and folder of its own."""
    folder = Path(job["folder"])
    shutil.rmtree(folder, ignore_errors=True)
    note = folder.with_suffix(".json")
    note.write_text(json.dumps(job), "utf-8")
    done = subprocess.run(
        [sys.executable, __file__, "--contender", name, "--note", str(note)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode:
        raise SystemExit(f"{name}: {done.stderr[-2000:]}")
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    images = list(folder.rglob("*.tif"))
    found.update(images=len(images), mb=sum(path.stat().st_size for path in images) / 1e6)
    return found


def same_pixels(one: Path, other: Path, worked_out: Any) -> None:
    """Refuse a comparison of images that are not the same."""
    from osgeo import gdal

    gdal.UseExceptions()
    for n in range(0, len(worked_out.names), 97):
        a = gdal.Open(str(one / "satellite" / f"{worked_out.names[n]}.tif"))
        b = gdal.Open(str(other / f"{n}.tif"))
        if not np.array_equal(a.ReadAsArray(), b.ReadAsArray()):
            raise SystemExit(f"image {n}: differs from gdal.Translate's")
        if not np.allclose(a.GetGeoTransform(), b.GetGeoTransform(), rtol=0.0, atol=1e-6):
            raise SystemExit(f"image {n}: lies elsewhere than gdal.Translate's")


def stages(file: str, shape: tuple[int, int, float]) -> list[tuple[str, float]]:
    """Processor milliseconds that an image takes in one thread: reading its tiles, and all else."""
    from terrainav.core.capture.runner import capture

    start = time.process_time()
    worked_out, source = planned(file, *shape)
    spent = {"read": 0.0}
    fetch = source.fetch

    def timed(map_type: str, part: Any) -> Any:
        began = time.thread_time()
        try:
            return fetch(map_type, part)
        finally:
            spent["read"] += time.thread_time() - began

    source.fetch = timed
    with tempfile.TemporaryDirectory(dir=IN_MEMORY if os.access(IN_MEMORY, os.W_OK) else None) as folder:
        capture(worked_out, source, folder, connections=1, workers=1)
        whole = time.process_time() - start
    count = len(worked_out.names)
    return [("parts", spent["read"] / count * 1e3), ("all else", (whole - spent["read"]) / count * 1e3)]


def compare(file: str, folder: Path, repeats: int, shape: tuple[int, int, float]) -> dict[str, Any]:
    """All programs on all jobs, in turns; medians."""
    worked_out, source = planned(file, *shape)
    source.close()
    cuts = windows(worked_out, source.grid)
    found: dict[str, Any] = {"images": len(cuts), "rows": []}
    for packed in (True, False):
        runs: dict[tuple[str, int], list[dict[str, Any]]] = {contender: [] for contender in CONTENDERS}
        for _ in range(repeats):
            for name, threads in CONTENDERS:
                job = {
                    "file": file, "folder": str(folder / f"{name}-{packed}"), "threads": threads, "packed": packed,
                    "windows": cuts, "shape": shape, "level": LEVEL,
                }  # fmt: skip
                runs[name, threads].append(run(name, job))
        same_pixels(folder / f"ours-{packed}", folder / f"gdal-{packed}", worked_out)
        for (name, threads), each in runs.items():
            row = {key: statistics.median(one[key] for one in each) for key in each[0]}
            row.update(name=name, threads=threads, packed=packed, rate=row["images"] / row["wall_s"])
            row["walls_s"] = sorted(one["wall_s"] for one in each)
            found["rows"].append(row)
            print(f"{name} x {threads}, packed {packed}: {row['rate']:.0f} images/s", flush=True)
    return found


def memory(file: str, folder: Path) -> list[dict[str, Any]]:
    """Peak memory of missions of several sizes."""
    rows = []
    for shape in MEMORY:
        job = {"file": file, "folder": str(folder / "memory"), "threads": 2, "packed": True, "shape": shape}
        rows.append(run("ours", job))
        print(f"{rows[-1]['images']} images: {rows[-1]['peak_mb']:.0f} MB", flush=True)
        shutil.rmtree(job["folder"])
    return rows


def page(found: dict[str, Any]) -> str:
    """Page of the figures."""
    from terrainav.core.report.machine import machine

    shown = HEAD.format(
        machine=", ".join(f"{what} {value}" for what, value in machine()),
        load=os.getloadavg()[0],
        block=BLOCK_PX,
        **{**found, "memory": "", "rows": "", "stages": ""},
    )
    for row in found["rows"]:
        own = next(one for one in found["rows"] if one["name"] == "ours" and one["packed"] == row["packed"])
        shown += ROW.format(
            output="deflate" if row["packed"] else "not compressed",
            title=TITLES[row["name"]],
            ratio=own["rate"] / row["rate"],
            least=row["walls_s"][0],
            most=row["walls_s"][-1],
            **row,
        )
    shown += STAGES.format(stages=", ".join(f"{name} {ms:.1f}" for name, ms in found["stages"]))
    return shown + "".join(f"| {row['images']:,} | {row['peak_mb']:.0f} |\n" for row in found["memory"])


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--side", type=int, default=20_000, help="of the raster in px")
    parser.add_argument("--grid", type=int, default=32, help="columns, and rows, of images")
    parser.add_argument("--file", type=Path, help="the raster; made where it is not there")
    parser.add_argument("--no-page", action="store_true", help="write nothing")
    parser.add_argument("--contender", choices=tuple(PROGRAMS), help=argparse.SUPPRESS)
    parser.add_argument("--note", type=Path, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.contender:
        contend(asked.contender, asked.note)
        return
    file = asked.file or ROOT / "build" / f"raster-{asked.side}.tif"
    if not file.exists():
        file.parent.mkdir(exist_ok=True)
        paint(file, asked.side)
    shape = (asked.grid, asked.grid, OVERLAP)
    with tempfile.TemporaryDirectory(dir=IN_MEMORY if os.access(IN_MEMORY, os.W_OK) else None) as name:
        found = compare(str(file), Path(name), asked.repeats, shape)
        found["memory"] = [] if asked.no_page else memory(str(file), Path(name))
    found["stages"] = stages(str(file), (8, 8, OVERLAP))
    print(found["stages"])
    runs = "one run each" if asked.repeats == 1 else f"medians of {asked.repeats}"
    found.update(side=asked.side, runs=runs, file_mb=file.stat().st_size / 1e6)
    if not asked.no_page:
        (ROOT / "docs" / "rasters.md").write_text(page(found), "utf-8")


if __name__ == "__main__":
    main()
