"""The job of the capture benchmark as several programs do it, each in a process of its own.

    python benchmarks/capture_contenders.py ours job.json

prints wall seconds, processor seconds and peak memory as JSON. What the job is: see `Job`.
"""

from __future__ import annotations

import io
import json
import math
import os
import resource
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

ZOOM, TILE_PX = 19, 256
AGL_M, LAT_DEG, LON_DEG, OVERLAP = 120.0, 35.14, -89.86, 0.25
HALF_WORLD_M = 20037508.342789244
M_PER_PX = 2.0 * HALF_WORLD_M / (TILE_PX << ZOOM)
JPEG_QUALITY = 95

#: Left, top, width and height of a footprint in px of the zoom.
Window = tuple[int, int, int, int]


@dataclass(frozen=True)
class Job:
    """Footprints on a grid of ``columns`` x ``rows``, fetched from ``template`` into ``folder``."""

    template: str
    folder: str
    columns: int = 10
    rows: int = 10
    image_format: str = "jpg"
    connections: int = 16
    windows: tuple[Window, ...] = ()

    def write(self, path: Path) -> None:
        """Leave the job where a contender reads it, with its windows: peers need nothing of ours."""
        path.write_text(json.dumps(asdict(replace(self, windows=windows(self)))), "utf-8")


def planned(job: Job) -> Any:
    """Plan of the job."""
    from terrainav.core.geodesy.mercator import PixelGrid
    from terrainav.core.mission.areas.area import Box
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan

    width_m, height_m = Mission(Box(1, 0, 0, 1), AGL_M).camera.ground_size_m(AGL_M)
    # A little more than the steps of the grid, so that the last footprint is needed.
    half_lat = (job.rows * (1.0 - OVERLAP) + 0.1) * height_m / 111_000.0 / 2.0
    m_per_deg = 111_320.0 * math.cos(math.radians(LAT_DEG))
    half_lon = (job.columns * (1.0 - OVERLAP) + 0.1) * width_m / m_per_deg / 2.0
    mission = Mission(
        Box(LAT_DEG + half_lat, LON_DEG - half_lon, LAT_DEG - half_lat, LON_DEG + half_lon),
        AGL_M,
        overlap_along=OVERLAP,
        overlap_across=OVERLAP,
        zoom=ZOOM,
        max_px=1280,
        image_format=job.image_format,
        source=job.template,
    )
    return plan(mission, PixelGrid())


def windows(job: Job) -> tuple[Window, ...]:
    """Return the footprints of the job."""
    left, top, width, height = (values.tolist() for values in planned(job).windows)
    return tuple(zip(map(int, left), map(int, top), map(int, width), map(int, height)))


def edges_m(window: Window) -> tuple[float, float, float, float]:
    """West, south, east and north of a window in metres of EPSG:3857."""
    left, top, width, height = window
    west, north = left * M_PER_PX - HALF_WORLD_M, HALF_WORLD_M - top * M_PER_PX
    return west, north - height * M_PER_PX, west + width * M_PER_PX, north


def tiles_of(window: Window) -> list[tuple[int, int]]:
    """Columns and rows of the tiles that a window needs."""
    left, top, width, height = window
    return [
        (x, y)
        for y in range(top // TILE_PX, (top + height - 1) // TILE_PX + 1)
        for x in range(left // TILE_PX, (left + width - 1) // TILE_PX + 1)
    ]


def ours(job: Job) -> Callable[[], None]:
    """TerrAInav."""
    from terrainav.core.capture.runner import capture
    from terrainav.core.imagery.xyz import XYZSource

    plan = planned(job)

    def run() -> None:
        source = XYZSource(job.template, connections=job.connections)
        result = capture(plan, source, job.folder, connections=job.connections)
        source.close()
        if result.failed or result.written != len(plan):
            raise SystemExit(f"{result.written} of {len(plan)} images: {result.failed[:1]}")

    return run


def pool(job: Job) -> Callable[[], None]:
    """A plain thread pool with requests: all tiles first, each once, then the pictures."""
    import numpy as np
    import requests
    from PIL import Image

    footprints = job.windows

    def run() -> None:
        with requests.Session() as session, ThreadPoolExecutor(job.connections) as threads:
            session.mount("http://", requests.adapters.HTTPAdapter(pool_maxsize=job.connections))

            def fetch(tile: tuple[int, int]) -> Any:
                url = job.template.format(z=ZOOM, x=tile[0], y=tile[1])
                return np.asarray(Image.open(io.BytesIO(session.get(url, timeout=60).content)).convert("RGB"))

            needed = sorted({tile for window in footprints for tile in tiles_of(window)})
            tiles = dict(zip(needed, threads.map(fetch, needed)))

            def make(entry: tuple[int, Window]) -> None:
                index, window = entry
                picture = np.empty((window[3], window[2], 3), np.uint8)
                for tile in tiles_of(window):
                    paste(picture, window, tile, tiles[tile])
                out = Path(job.folder) / f"{index}.{job.image_format}"
                Image.fromarray(picture).save(out, quality=JPEG_QUALITY, subsampling=0)

            list(threads.map(make, enumerate(footprints)))

    return run


def paste(picture: Any, window: Window, tile: tuple[int, int], pixels: Any) -> None:
    """Lay a tile into the picture of a window."""
    dx, dy = tile[0] * TILE_PX - window[0], tile[1] * TILE_PX - window[1]
    x, y = max(dx, 0), max(dy, 0)
    right, bottom = min(dx + TILE_PX, window[2]), min(dy + TILE_PX, window[3])
    picture[y:bottom, x:right] = pixels[y - dy : bottom - dy, x - dx : right - dx]


def contextily(job: Job) -> Callable[[], None]:
    """contextily.bounds2raster for each footprint."""
    import contextily as package

    footprints = job.windows

    def run() -> None:
        for index, window in enumerate(footprints):
            west, south, east, north = edges_m(window)
            package.bounds2raster(
                west,
                south,
                east,
                north,
                str(Path(job.folder) / f"{index}.tif"),
                zoom=ZOOM,
                source=job.template,
                ll=False,
                n_connections=job.connections,
                use_cache=False,
            )

    return run


def gdal(job: Job) -> Callable[[], None]:
    """GDAL's TMS driver, and gdal.Translate for each footprint."""
    from osgeo import gdal as library

    library.UseExceptions()
    library.SetConfigOption("GDAL_PAM_ENABLED", "NO")
    footprints = job.windows
    url = job.template.format(z="${z}", x="${x}", y="${y}")
    description = f"""<GDAL_WMS><Service name="TMS"><ServerUrl>{url}</ServerUrl></Service><DataWindow>
      <UpperLeftX>-{HALF_WORLD_M}</UpperLeftX><UpperLeftY>{HALF_WORLD_M}</UpperLeftY>
      <LowerRightX>{HALF_WORLD_M}</LowerRightX><LowerRightY>-{HALF_WORLD_M}</LowerRightY>
      <TileLevel>{ZOOM}</TileLevel><TileCountX>1</TileCountX><TileCountY>1</TileCountY><YOrigin>top</YOrigin>
      </DataWindow><Projection>EPSG:3857</Projection><BlockSizeX>256</BlockSizeX><BlockSizeY>256</BlockSizeY>
      <BandsCount>3</BandsCount><MaxConnections>{job.connections}</MaxConnections>
      <Cache><Path>{job.folder}-cache</Path></Cache></GDAL_WMS>"""
    options: dict[str, list[str]] = {
        "jpg": ["QUALITY=95", "WORLDFILE=YES"],
        "tif": ["COMPRESS=DEFLATE", "PREDICTOR=2"],
    }

    def run() -> None:
        dataset = library.Open(description)
        for index, window in enumerate(footprints):
            west, south, east, north = edges_m(window)
            library.Translate(
                str(Path(job.folder) / f"{index}.{job.image_format}"),
                dataset,
                projWin=[west, north, east, south],
                format={"jpg": "JPEG", "tif": "GTiff"}[job.image_format],
                creationOptions=options[job.image_format],
            )

    return run


def qgis(job: Job) -> Callable[[], None]:
    """QGIS's native:rasterize for each footprint of an XYZ layer."""
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    from qgis.analysis import QgsNativeAlgorithms
    from qgis.core import (
        QgsApplication,
        QgsProcessingContext,
        QgsProcessingFeedback,
        QgsProject,
        QgsRasterLayer,
    )

    footprints = job.windows
    application = QgsApplication([], False)
    application.initQgis()
    application.processingRegistry().addProvider(QgsNativeAlgorithms())
    url = job.template.replace("{", "%7B").replace("}", "%7D")
    layer = QgsRasterLayer(f"type=xyz&url={url}&zmin=0&zmax={ZOOM}", "tiles", "wms")
    if not layer.isValid():
        raise SystemExit("QGIS does not open the tiles as a layer")
    project = QgsProject.instance()
    project.setCrs(layer.crs())
    project.addMapLayer(layer)
    context = QgsProcessingContext()
    context.setProject(project)
    rasterize = application.processingRegistry().createAlgorithmById("native:rasterize")

    def run() -> None:
        for index, window in enumerate(footprints):
            west, south, east, north = edges_m(window)
            application.processEvents()
            _, made = rasterize.run(
                {
                    "EXTENT": f"{west!r},{east!r},{south!r},{north!r} [EPSG:3857]",
                    "EXTENT_BUFFER": 0,
                    "TILE_SIZE": 1024,
                    "MAP_UNITS_PER_PIXEL": M_PER_PX,
                    "MAKE_BACKGROUND_TRANSPARENT": False,
                    "LAYERS": [layer],
                    "OUTPUT": str(Path(job.folder) / f"{index}.tif"),
                },
                context,
                QgsProcessingFeedback(),
            )
            if not made:
                raise SystemExit(f"footprint {index}: native:rasterize failed")

    return run


CONTENDERS: dict[str, Callable[[Job], Callable[[], None]]] = {
    "ours": ours,
    "pool": pool,
    "contextily": contextily,
    "gdal": gdal,
    "qgis": qgis,
}


def _cpu_s() -> float:
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def _peak_mb() -> float:
    # Not from getrusage, which counts what the process that started this one had in memory.
    status = Path("/proc/self/status").read_text("ascii")
    return float(status.split("VmHWM:")[1].split()[0]) * 1.024e-3


def main() -> None:
    """Run one contender; print what it took."""
    name, path = sys.argv[1:]
    job = Job(**json.loads(Path(path).read_text("utf-8")))
    run = CONTENDERS[name](job)
    cpu_s, began = _cpu_s(), time.perf_counter()
    run()
    found = {"wall_s": time.perf_counter() - began, "cpu_s": _cpu_s() - cpu_s}
    found["peak_mb"] = _peak_mb()
    print(json.dumps(found), flush=True)
    # QGIS's own threads may hold the interpreter's end up; nothing is left to be written.
    os._exit(0)


if __name__ == "__main__":
    main()
