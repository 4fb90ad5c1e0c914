"""Images per second of `terrainav benchmark make` from a local raster, beside a plain capture of the same queries.

    python benchmarks/benchmark_rate.py                      # 10,000 queries, from a raster painted by GDAL
    python benchmarks/benchmark_rate.py --plain 2000          # the same; the plain capture is of the first 2,000
    python benchmarks/benchmark_rate.py --raster ortho.tif    # from one of your own

Queries are camera frames at random places of the raster, each with its own yaw. The plain capture writes these alone;
the benchmark the reference as well, as a mosaic and as tiles, and what is true of them: footprints and right tiles.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from contextlib import closing
from pathlib import Path

import numpy as np
from rasters import paint
from terrainav.core.benchmark.making import make_benchmark
from terrainav.core.benchmark.planning import BenchmarkSettings, plan_benchmark
from terrainav.core.capture.runner import capture
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.source import Source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.imageries import NamedImagery
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

#: Of the painted raster, and the share of it along each side in which queries are.
SIDE_PX, INNER = 6144, 0.8
SEED = 17


def mission_of(raster: Path, grid: PixelGrid, count: int, image_px: int, agl_m: float) -> Mission:
    """Queries at random places of a raster, with yaws at random."""
    u, v = np.array(grid.extent).T
    rng = np.random.default_rng(SEED)
    shares = (1.0 - INNER) / 2.0 + INNER * rng.random((2, count))
    lat, lon = grid.plane.inverse(u.min() + shares[0] * (u.max() - u.min()), v.min() + shares[1] * (v.max() - v.min()))
    places = tuple((a, b, agl_m) for a, b in zip(lat.tolist(), lon.tolist()))
    yaws = tuple(rng.uniform(-180.0, 180.0, count).tolist())
    return Mission(
        Points(places, yaws), agl_m, frame="camera", image_px=image_px, source=str(raster), image_format="png"
    )


class Clock:
    """Seconds that have gone by, on the wall and of the processor, since it was made."""

    def __init__(self) -> None:
        self._wall, self._processor = time.perf_counter(), time.process_time()

    def rate(self, what: str, images: int) -> float:
        """Print and return images per second."""
        wall, processor = time.perf_counter() - self._wall, time.process_time() - self._processor
        print(f"{what:24} {images:7,} images {wall:7.1f} s {images / wall:6.0f}/s", end="")
        print(f"   {1000.0 * processor / images:.2f} ms of the processor an image", flush=True)
        return images / wall


def main() -> None:
    """Capture, make, and print the rates."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--raster", type=Path, help="georeferenced raster file")
    parser.add_argument("--queries", type=int, default=10_000)
    parser.add_argument("--image-px", type=int, default=128)
    parser.add_argument("--agl", type=float, default=45.0, help="metres above the ground (%(default)s)")
    parser.add_argument("--plain", type=int, help="images of the plain capture (as many as queries)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        raster = arguments.raster or folder / "raster.tif"
        if arguments.raster is None:
            paint(raster, SIDE_PX)
        raster = raster.resolve()
        with closing(open_source(str(raster))) as source:
            mission = mission_of(raster, source.grid, arguments.queries, arguments.image_px, arguments.agl)
            compare(mission, source, folder, arguments.plain or arguments.queries)


def compare(mission: Mission, source: Source, folder: Path, count: int) -> None:
    """Print the rates of a plain capture of some images, and of a benchmark."""
    area = mission.area
    some = mission.replace(area=Points(area.poses[:count], area.yaws_deg[:count]))
    clock = Clock()
    done = capture(plan(some, source.grid), source, folder / "plain")
    alone = clock.rate("plain capture", done.written)
    imagery = NamedImagery("own", mission.imagery.source)
    settings = BenchmarkSettings(mission, (imagery,), imagery, split="none")
    clock = Clock()
    worked_out = plan_benchmark(settings, {str(imagery): source.grid})
    made = make_benchmark(worked_out, {str(imagery): source}, folder / "benchmark")
    whole = clock.rate("benchmark", made.total.written)
    print(f"  {whole / alone:.2f} of the rate of the plain capture; by parts:")
    for name, result in made.results.items():
        print(f"  {name:32} {result.written:7,} images {result.seconds:7.1f} s")
    print(f"  right and nearly right tiles     {len(made.benchmark.truth.query):7,} pairs")


if __name__ == "__main__":
    main()
