"""The embedded world about the poles: a sheet of images, and what its tiles cost beside those of its map.

    python benchmarks/polar_world.py                            # prints a table
    python benchmarks/polar_world.py --sheet docs/images/poles.jpg

Tiles of blocks of 4 x 4 are made for the first time and for a second, which counts, in turns; processor time a tile.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.world import World

NORTH, SOUTH = "EPSG:3413", "EPSG:3031"
#: Places as world fractions: of the map, which the others are compared with, and of the charts.
PLACES = {
    "map, fields and towns": ("", 0.25038, 0.39581),
    "map, 84° N": ("", 0.3, 0.02),
    "pack ice": (NORTH, 0.505, 0.505),
    "crevasses": (SOUTH, 0.50525, 0.52368),
    "South Pole": (SOUTH, 0.5, 0.5),
}
ZOOMS = (4, 8, 10, 12, 14, 16, 18, 20, 22)
#: CRS, latitude, longitude, height and attitude of the images of the sheet, by rows.
IMAGES: tuple[tuple[str, float, float, float, dict[str, float]], ...] = (
    (SOUTH, -90.0, 0.0, 700.0, {}),
    (SOUTH, -89.9985, 135.0, 260.0, {"tilt_deg": 50.0, "yaw_deg": 20.0}),
    (SOUTH, -81.07074, 167.50247, 900.0, {"tilt_deg": 45.0, "yaw_deg": 20.0}),
    (SOUTH, -81.07074, 167.50247, 20e3, {"tilt_deg": 55.0, "yaw_deg": 20.0}),
    (NORTH, 88.0, 10.0, 4000.0, {}),
    (NORTH, 87.35826, 0.56727, 12e3, {"tilt_deg": 50.0, "yaw_deg": 120.0}),
)
COLUMNS, WIDTH, HEIGHT, GAP = 3, 480, 360, 6


def image(crs: str, lat: float, lon: float, agl_m: float, attitude: dict[str, Any]) -> Image.Image:
    """Return the image that a mission of one point captures."""
    source = open_source("world", crs=crs)
    mission = Mission(Points(((lat, lon, agl_m),)), agl_m, source="world", image_format="png", **attitude)
    with tempfile.TemporaryDirectory() as folder:
        worked_out = plan(mission, source.grid)
        capture(worked_out, source, folder)
        with Image.open(Path(folder) / "satellite" / f"{worked_out.names[0]}.png") as made:
            return made.convert("RGB").resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS)


def sheet() -> Image.Image:
    """Return the images side by side."""
    rows = -(-len(IMAGES) // COLUMNS)
    size = COLUMNS * (WIDTH + GAP) - GAP, rows * (HEIGHT + GAP) - GAP
    out = Image.new("RGB", size, "white")
    for n, asked in enumerate(IMAGES):
        out.paste(image(*asked), (n % COLUMNS * (WIDTH + GAP), n // COLUMNS * (HEIGHT + GAP)))
    return out


def tile_ms(crs: str, u: float, v: float, zoom: int) -> float:
    """Processor time of a tile in milliseconds, the mean of a block."""
    world = World(2024, crs)
    x0, y0 = (max(int(place * 2**zoom) - 2, 0) for place in (u, v))
    tiles = [(x, y) for y in range(y0, y0 + 4) for x in range(x0, x0 + 4)]
    for _ in range(2):
        start = time.process_time()
        for x, y in tiles:
            world.tile("satellite", zoom, x, y)
    return (time.process_time() - start) / len(tiles) * 1e3


def main() -> None:
    """Print the table, or write the sheet."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sheet", type=Path, help="file of the sheet of images")
    arguments = parser.parse_args()
    if arguments.sheet:
        sheet().save(arguments.sheet, quality=85)
        return
    names = list(PLACES)
    print(f"| zoom | {names[0]}, ms a tile | {' | '.join(names[1:])} |")
    print("| --- " * (len(names) + 1) + "|")
    for zoom in ZOOMS:
        times = np.array([tile_ms(*place, zoom) for place in PLACES.values()])
        ratios = " | ".join(f"{ratio:.1f}" for ratio in times[1:] / times[0])
        print(f"| {zoom} | {times[0]:.1f} | {ratios} |")


if __name__ == "__main__":
    main()
