"""Pictures over relief: what tracing takes beside a march of every pixel, and the pictures of docs/relief.md.

    python benchmarks/relief.py                       # times, over hills and over the embedded world's houses
    python benchmarks/relief.py --dsm dsm.tif         # over a surface of your own, too
    python benchmarks/relief.py --scenes 10000        # rays of random scenes beside a march through space, in PROJ
    python benchmarks/relief.py --cliffs 10000        # images of random scenes with cliffs, in six systems
    python benchmarks/relief.py --images              # whole images a second, with numpy and with numba; with --dsm too
    python benchmarks/relief.py --buildings           # whole images a second with and without 2,000 buildings
    python benchmarks/relief.py --lenses              # milliseconds an image through lenses that distort
    python benchmarks/relief.py --pictures docs/images  # makes the page's pictures; with --dsm both

A march goes along each ray in steps of half a cell until it is below the surface, and halves the last one ten times: it
is what most simulators do. It passes by what is thinner than its step: rays whose points are over a metre apart. Times
are of one thread's processor time, the best of several.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import nullcontext
from functools import partial
from io import BytesIO
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from PIL import Image, ImageDraw
from terrainav.core.elevation.layered import open_relief
from terrainav.core.external import compiling
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.raytracing.tracing import ElevationModel, Tracing, compile_code
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.camera_frame import parts_of_tiles
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.products import sighting
from terrainav.core.picture.shot import draw, make_shot, picture_parts

ROOT = Path(__file__).resolve().parents[1]
CAMERA, SIZE = Camera(78.8, 4.0 / 3.0), (640, 480)
LENSES = {
    "ideal, 60°": Camera(60.0, 4.0 / 3.0),
    "k1 = -0.3, 60°": Camera(60.0, 4.0 / 3.0, k1=-0.3),
    "ideal, 120°": Camera(120.0, 4.0 / 3.0),
    "fisheye, 150°": Camera(150.0, 4.0 / 3.0, lens="fisheye"),
}
TILTS, HEIGHTS_M = (0.0, 30.0, 60.0, 85.0), (120.0, 500.0)
REPEATS = 3
TOWN = (35.1408, -89.8606)
JPEG_QUALITY = 82


class Hills:
    """Smooth hills of 512 x 512 cells of about a metre, wherever they are asked for."""

    title, attribution = "hills", ""

    def __init__(self) -> None:
        rng = np.random.default_rng(7)
        wide = sum(
            np.kron(rng.normal(0.0, 8.0 * size / 128, (512 // size + 2,) * 2), np.ones((size, size)))[:512, :512]
            for size in (128, 64, 32)
        )
        for _ in range(24):
            wide = (wide + np.roll(wide, 1, 0) + np.roll(wide, -1, 0) + np.roll(wide, 1, 1) + np.roll(wide, -1, 1)) / 5
        grid = PixelGrid(max_zoom=17, native_zoom=17)
        u, v = grid.plane.forward(np.array([45.0]), np.array([7.0]))
        world = grid.world_px(17)
        self.surface_ = Surface(grid, 17, int(u[0] * world) - 256, int(v[0] * world) - 256, wide)

    def surface(self, *_: object) -> Surface:
        """The hills."""
        return self.surface_

    def end_m(self, *_: float) -> float:
        """Distance beyond which there is no ground."""
        return np.inf

    def cell_m(self, *_: float) -> float:
        """Size of their cells."""
        return 0.84


def march(surface: Surface, tracing: Tracing, height_m: float) -> np.ndarray:
    """Follow every ray in steps of half a cell; depths (height, width)."""
    rays = tracing.rays
    lat, lon = tracing.place
    paths, farthest, _ = surface.paths(lat, lon, height_m, rays, 0.05)
    x, y = np.meshgrid(np.arange(rays.width) + 0.5, np.arange(rays.height) + 0.5)
    coefficients = paths.coefficients(rays.directions(x.ravel(), y.ravel()))
    speed = np.hypot(coefficients[0, 0], coefficients[0, 1]) + 1e-9
    step = np.minimum(0.5 / speed, farthest / 32.0)
    found = np.full(x.size, np.nan)
    index, t = np.arange(x.size), np.zeros(x.size)
    top = float(np.nanmax(surface.heights_m))
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.clip((height_m - top) / -coefficients[0, 2], 0.0, farthest)
    while len(index):
        t = t + step
        part = coefficients[:, :, index]
        column, row, height = _along(paths.start, part, t)
        below = height <= surface.heights(column, row)
        if below.any():
            found[index[below]] = _halved(surface, paths.start, part[:, :, below], t[below], step[below])
        keep = ~below & (t < farthest)
        index, t, step = index[keep], t[keep], step[keep]
    return found.reshape(x.shape)


def _halved(
    surface: Surface, start: np.ndarray, coefficients: np.ndarray, t: np.ndarray, step: np.ndarray
) -> np.ndarray:
    """Where rays meet the surface in their last step, to a thousandth of it."""
    above, below = t - step, t
    for _ in range(10):
        middle = (above + below) / 2.0
        column, row, height = _along(start, coefficients, middle)
        under = height <= surface.heights(column, row)
        above, below = np.where(under, above, middle), np.where(under, middle, below)
    return below


def _along(start: np.ndarray, coefficients: np.ndarray, t: np.ndarray) -> np.ndarray:
    total = coefficients[-1] * t
    for term in coefficients[-2::-1]:
        total = (total + term) * t
    return total + start[:, np.newaxis]


def timed(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Seconds of this thread's processor time, the best of several."""
    best = np.inf
    for _ in range(repeats):
        begin = time.thread_time()
        work()
        best = min(best, time.thread_time() - begin)
    return float(best)


def _traced(scene: ImageGeometry, height_m: float, relief: ElevationModel, lowest_m: float) -> Tracing:
    found = Tracing(scene, height_m, relief, lowest_m, 0.02)
    _ = found.depth_m
    return found


def _box(lat: float, lon: float, room_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a box about a place."""
    up, aside = room_m / 111e3, room_m / 111e3 / np.cos(np.radians(lat))
    return np.array([lat - up, lat + up]), np.array([lon - aside, lon + aside])


def measure(name: str, relief: ElevationModel, lat: float, lon: float) -> None:
    """Print a row for each tilt and height."""
    below = relief.surface(np.array([lat]), np.array([lon]), 0.0)
    ground = float(below.heights(*below.position(np.array([lat]), np.array([lon])))[0])
    for agl in HEIGHTS_M:
        for tilt in TILTS:
            pose = Poses(*(np.array([value]) for value in (lat, lon, agl, 30.0, tilt, 0.0)))
            height = ground + agl

            lowest = float(np.nanmin(below.heights_m)) - 20.0
            traced = partial(_traced, ImageGeometry(CAMERA, *SIZE, pose), height, relief, lowest)
            own, tracing = timed(traced), traced()
            surface = relief.surface(*_box(lat, lon, 3.0 * agl))
            slow = timed(partial(march, surface, tracing, height))
            off = np.abs(march(surface, tracing, height) - tracing.depth_m)
            missed = np.nanmean(off > 1.0) * 100.0
            print(
                f"| {name} | {agl:g} m | {tilt:g} | {own * 1e3:.0f} ms | {slow * 1e3:.0f} ms | "
                f"{slow / own:.1f} | {missed:.2f} % |",
                flush=True,
            )


def scenes(count: int) -> None:
    """Print how many rays of random scenes are off the surface, or pass by ground."""
    sys.path.insert(0, str(ROOT))
    from tests.core.geodesy.test_relief import random_scene

    rays, off, before = np.sum([random_scene(seed) for seed in range(count)], axis=0)
    print(f"{count} scenes, {rays} rays: {off} off the surface by more than the bound, {before} passed by ground")


def cliffs(count: int) -> None:
    """Print how many rays of images over random cliffs are lost, pass by ground, or are beyond the bound."""
    sys.path.insert(0, str(ROOT))
    from tests.core.geodesy import cliffs

    totals, worst = np.zeros(4, np.int64), 0.0
    for seed in range(count):
        found = cliffs.random_scene(seed)
        totals += found[:4]
        worst = max(worst, found.worst_share)
        if any(found[1:4]):
            print(f"scene {seed}: {found}", flush=True)
    rays, lost, passed, beyond = totals
    print(
        f"{count} scenes in {len(cliffs.SYSTEMS)} systems, {count * cliffs.PIXELS} pixels, {rays} rays looked at: "
        f"{lost} lost, {passed} passed by ground, {beyond} beyond the bound; worst {worst:.2f} of it"
    )


def shot(source: str, elevation: tuple[str, ...], agl: float, tilt: float, yaw: float, at: tuple[float, float]):
    """Picture and depth of one capture."""
    area = Points(((at[0], at[1], agl),))
    mission = Mission(area, agl, CAMERA, source=source, elevation=elevation, tilt_deg=tilt, yaw_deg=yaw, upsample=True)
    opened = open_source(source)
    made = plan(mission, opened.grid, mission_heights(mission))
    parts = picture_parts(made, opened, 0)
    pixels = {part.window: opened.fetch("satellite", part.window) for part in parts}
    picture = draw(make_shot(made, 0), parts, pixels).pixels[..., :3]
    return picture, sighting(made, 0, made.frames.largest_px)


def hills_file(folder: Path, times: int = 1) -> str:
    """Write the hills as a raster; ``times`` as wide and deep, about the same place."""
    import rasterio
    from rasterio.transform import from_origin

    surface, path = Hills().surface_, folder / "hills.tif"
    cell = 2.0 * np.pi * 6378137.0 / surface.grid.world_px(surface.zoom)
    aside = 256.0 * (times - 1)
    west, north = (at * cell - np.pi * 6378137.0 for at in (surface.left_px - aside, -surface.top_px + aside))
    north += 2.0 * np.pi * 6378137.0
    cell *= times
    made = {"height": 512, "width": 512, "count": 1, "dtype": "float32", "crs": "EPSG:3857"}
    with rasterio.open(path, "w", driver="GTiff", transform=from_origin(west, north, cell, cell), **made) as file:
        file.write(surface.heights_m.astype(np.float32), 1)
    return str(path)


def whole_image(
    elevation: tuple[str, ...],
    tilt: float,
    at: tuple[float, float],
    agl: float = 120.0,
    buildings: tuple[str, ...] = (),
    camera: Camera = CAMERA,
) -> Callable[[], object]:
    """Work of one capture in memory: find its tiles, draw it, encode it as JPEG. All tiles show the same texture."""
    mission = Mission(
        Points(((*at, agl),)),
        agl,
        camera,
        source="world",
        elevation=elevation,
        buildings=buildings,
        tilt_deg=tilt,
        yaw_deg=30.0,
        upsample=True,
    )
    opened = open_source("world")
    made = plan(mission, opened.grid, mission_heights(mission))
    # The largest tiles are of 512 px.
    texture = np.random.default_rng(1).integers(64, 192, (64, 64, 3), np.uint8).repeat(8, axis=0).repeat(8, axis=1)
    drawn: dict[tuple[int, int], np.ndarray] = {}

    def work() -> None:
        found = make_shot(made, 0)
        parts = (
            picture_parts(made, opened, 0) if not hasattr(found, "tiles") else parts_of_tiles(made.grid, found.tiles)
        )
        sizes = {part.window: (part.window.height_px, part.window.width_px) for part in parts}
        for height, width in set(sizes.values()) - drawn.keys():
            drawn[height, width] = np.ascontiguousarray(texture[:height, :width])
        pixels = {one: drawn[size] for one, size in sizes.items()}
        picture = draw(found, parts, pixels).pixels[..., :3]
        Image.fromarray(picture).save(BytesIO(), "JPEG", quality=JPEG_QUALITY)

    return work


def images(dsm: str | None) -> None:
    """Print whole images a second over level ground and relief, with numpy and with numba in turns."""
    # Else level ground is drawn without.
    compile_code()
    with tempfile.TemporaryDirectory() as folder:
        grounds: list[tuple[str, tuple[str, ...], tuple[float, float]]] = [
            ("level", (), TOWN),
            ("hills", (hills_file(Path(folder)),), (45.0, 7.0)),
            ("world", ("world",), TOWN),
        ]
        if dsm:
            grounds.append(("surface", (dsm,), (38.8105, -77.0526)))
        print("| ground | tilt | with numpy | with numba | ratio |")
        print("| --- | --- | --- | --- | --- |")
        for name, elevation, at in grounds:
            for tilt in (0.0, 60.0, 85.0):
                work = whole_image(elevation, tilt, at)
                taken = {"numpy": np.inf, "numba": np.inf}
                work()
                for _ in range(REPEATS):
                    for code in taken:
                        with compiling.without_numba() if code == "numpy" else nullcontext():
                            taken[code] = min(taken[code], timed(work, 1))
                slow, fast = taken.values()
                print(f"| {name} | {tilt:g}° | {1 / slow:.1f} | {1 / fast:.1f} | {slow / fast:.1f} |", flush=True)


def footprints_file(folder: Path, at: tuple[float, float], side: int = 90) -> str:
    """Write a town of houses and blocks, 24 m apart, with heights and roofs of several kinds."""
    path, some = folder / "town.geojson", np.random.default_rng(7)
    metre_lat, metre_lon = 1.0 / 111_132.0, 1.0 / (111_320.0 * np.cos(np.radians(at[0])))
    features = []
    for row, column in np.ndindex(side, side):
        x, y = 24.0 * (column - side / 2.0), 24.0 * (row - side / 2.0)
        wide, deep = some.uniform(8.0, 18.0, 2)
        ring = [(0.0, 0.0), (wide, 0.0), (wide, deep), (0.4 * wide, deep), (0.4 * wide, 0.7 * deep), (0.0, 0.7 * deep)]
        corners = [[at[1] + (x + east) * metre_lon, at[0] + (y + north) * metre_lat] for east, north in ring]
        values = {
            "height": float(some.uniform(4.0, 20.0)),
            "roof:shape": str(some.choice(["flat", "gabled", "hipped"])),
        }
        geometry = {"type": "Polygon", "coordinates": [[*corners, corners[0]]]}
        features.append({"type": "Feature", "properties": values, "geometry": geometry})
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}), "utf-8")
    return str(path)


def buildings() -> None:
    """Print whole images a second with buildings in view, and the same without, with numpy and with numba in turns."""
    compile_code()
    at, agl = (45.0, 7.0), 900.0
    with tempfile.TemporaryDirectory() as folder:
        hills, town = (hills_file(Path(folder), 4),), (footprints_file(Path(folder), at),)
        print("| tilt | buildings in view | numpy: with | without | numba: with | without |")
        print("| --- | --- | --- | --- | --- | --- |")
        for tilt in (0.0, 45.0):
            mission = Mission(
                Points(((*at, agl),)), agl, CAMERA, source="world", elevation=hills, buildings=town, tilt_deg=tilt,
                yaw_deg=30.0, upsample=True,
            )  # fmt: skip
            made = plan(mission, open_source("world").grid, mission_heights(mission))
            seen = np.unique(sighting(made, 0, made.frames.largest_px).instance)
            works = [whole_image(hills, tilt, at, agl, some) for some in (town, ())]
            found = []
            for code in ("numpy", "numba"):
                with compiling.without_numba() if code == "numpy" else nullcontext():
                    for work in works:
                        work()
                    taken = [min(pair) for pair in zip(*([timed(one, 1) for one in works] for _ in range(REPEATS)))]
                found += [f"{1 / one:.1f}" for one in taken]
            print(f"| {tilt:g}° | {np.count_nonzero(seen):,} | {' | '.join(found)} |", flush=True)


def lenses() -> None:
    """Print what images through lenses take, beside those of ideal cameras, with numpy and with numba in turns."""
    compile_code()
    at, agl = (45.0, 7.0), 300.0
    print("| ground | tilt | lens | tracing, numpy | whole image | tracing, numba | whole image |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        hills, town = (hills_file(Path(folder), 4),), (footprints_file(Path(folder), at),)
        for ground, buildings in (("hills", ()), ("hills with buildings", town)):
            for tilt in (0.0, 60.0):
                works = {name: _lens_works(hills, tilt, at, agl, buildings, lens) for name, lens in LENSES.items()}
                best = {(name, code): [np.inf, np.inf] for code in ("numpy", "numba") for name in LENSES}
                for turn in range(REPEATS + 1):
                    for (name, code), found in best.items():
                        with compiling.without_numba() if code == "numpy" else nullcontext():
                            taken = [timed(work, 1) for work in works[name]]
                        if turn:
                            found[:] = [min(pair) for pair in zip(found, taken)]
                for name in LENSES:
                    row = [f"{1e3 * one:.0f} ms" for code in ("numpy", "numba") for one in best[name, code]]
                    print(f"| {ground} | {tilt:g}° | {name} | {' | '.join(row)} |", flush=True)


def _lens_works(
    elevation: tuple[str, ...],
    tilt: float,
    at: tuple[float, float],
    agl: float,
    buildings: tuple[str, ...],
    camera: Camera,
) -> tuple[Callable[[], object], Callable[[], object]]:
    """Tracing of one image with all of its ground points, and all work of it."""
    mission = Mission(
        Points(((*at, agl),)), agl, camera, source="world", elevation=elevation, buildings=buildings, tilt_deg=tilt,
        yaw_deg=30.0, upsample=True,
    )  # fmt: skip
    made = plan(mission, open_source("world").grid, mission_heights(mission))
    return lambda: made.views.tracing(0).sighting, whole_image(elevation, tilt, at, agl, buildings, camera)


def side_by_side(path: Path, pictures: list[tuple[str, np.ndarray]]) -> None:
    """Write pictures beside each other, each with its title."""
    width = sum(picture.shape[1] for _, picture in pictures) + 8 * (len(pictures) - 1)
    sheet = Image.new("RGB", (width, pictures[0][1].shape[0] + 26), "white")
    pen, left = ImageDraw.Draw(sheet), 0
    for title, picture in pictures:
        pen.text((left + 4, 7), title, fill="black")
        sheet.paste(Image.fromarray(picture), (left, 26))
        left += picture.shape[1] + 8
    sheet.save(path, quality=JPEG_QUALITY)
    print(path)


def shaded(depth: np.ndarray) -> np.ndarray:
    """Depth as grey, near ones bright, on a logarithmic scale; black where there is no ground."""
    near, far = np.nanmin(depth), np.nanpercentile(depth, 98)
    share = np.log(depth / near) / np.log(far / near)
    grey = np.where(np.isnan(share), 0.0, 255.0 - 215.0 * np.clip(share, 0.0, 1.0))
    return np.repeat(grey.astype(np.uint8)[..., np.newaxis], 3, axis=2)


def draw_pages(folder: Path, dsm: str | None) -> None:
    """Make the pictures of docs/relief.md."""
    level, _ = shot("world", (), 60.0, 60.0, 20.0, TOWN)
    over, seen = shot("world", ("world",), 60.0, 60.0, 20.0, TOWN)
    side_by_side(
        folder / "relief-town.jpg",
        [("level ground", level), ("over relief", over), ("its depth, near is bright", shaded(seen.depth_m))],
    )
    if dsm is None:
        return
    from osgeo import gdal

    raster = gdal.Open(dsm)
    z = raster.ReadAsArray().astype(float)
    down, across = np.gradient(np.kron(z, np.ones((4, 4))), raster.GetGeoTransform()[1])
    grey = np.clip(140.0 - 60.0 * (across + down), 0.0, 255.0)
    own = Path("/tmp") / "relief-shade.tif"  # noqa: S108  one file of this run's
    made = gdal.GetDriverByName("GTiff").Create(str(own), grey.shape[1], grey.shape[0], 3, gdal.GDT_Byte)
    x0, dx, _, y0, _, dy = raster.GetGeoTransform()
    made.SetGeoTransform((x0, dx / 4, 0.0, y0, 0.0, dy / 4))
    made.SetProjection(raster.GetProjection())
    for band, share in enumerate((1.0, 0.97, 0.88), 1):
        made.GetRasterBand(band).WriteArray((grey * share).astype(np.uint8))
    made.FlushCache()
    del made
    at = (38.8096, -77.0528)
    level, _ = shot(str(own), (f"{float(np.median(z))}",), 100.0, 35.0, 10.0, at)
    over, seen = shot(str(own), (dsm,), 100.0, 35.0, 10.0, at)
    side_by_side(
        folder / "relief-surface.jpg",
        [("level ground", level), ("over relief", over), ("its depth, near is bright", shaded(seen.depth_m))],
    )


def main() -> None:
    """Measure, or make pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dsm", help="a surface in a projected CRS")
    parser.add_argument("--pictures", type=Path, help="folder to make the page's images in")
    parser.add_argument("--images", action="store_true", help="measure whole images")
    parser.add_argument("--buildings", action="store_true", help="measure whole images with buildings")
    parser.add_argument("--scenes", type=int, help="random scenes to look at")
    parser.add_argument("--cliffs", type=int, help="random scenes with cliffs to look at")
    parser.add_argument("--lenses", action="store_true", help="measure images through lenses")
    asked = parser.parse_args()
    if asked.lenses:
        lenses()
        return
    if asked.cliffs:
        cliffs(asked.cliffs)
        return
    if asked.scenes:
        scenes(asked.scenes)
        return
    if asked.images:
        images(asked.dsm)
        return
    if asked.buildings:
        buildings()
        return
    if asked.pictures:
        draw_pages(asked.pictures, asked.dsm)
        return
    print("| surface | height | tilt | traced | march | ratio | missed |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    measure("hills", Hills(), 45.0, 7.0)
    if asked.dsm:
        measure("surface", open_relief([asked.dsm]), 38.8105, -77.0526)


if __name__ == "__main__":
    main()
