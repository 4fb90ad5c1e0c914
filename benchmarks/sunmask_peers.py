"""Hold cast shadows against GRASS GIS's `r.sunmask`, cell by cell.

    apt-get install grass-core                                         # 8.2.1 on Debian 12
    python benchmarks/sunmask_peers.py                                 # the relief of the synthetic world, and a cone
    python benchmarks/sunmask_peers.py --data /path/to/shared/data     # also a real surface, elevation/dsm.tif

A cell that differs touches a shadow's edge where one of its eight neighbours is of the other kind in GRASS's mask.
`r.sunmask` looks at the nearest cells along a ray, on a plane Earth. So that it meets cells at their centres, it gets
each surface turned until the sun is in the east, at cells half as wide.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.ndimage import map_coordinates
from terrainav.core.geodesy.mercator import MERCATOR
from terrainav.core.geodesy.sun import SunDirection
from terrainav.core.world import World
from terrainav.core.world.heights import chart_scale
from terrainav.core.world.lattice import LatticeWindow
from terrainav.core.world.rays import ChartSun
from terrainav.core.world.relief_light import horizon_tangent, relief_light
from terrainav.core.world.samples import Grid

#: Steep mountains of the synthetic world, by the sea.
MOUNTAINS = 24.1, -114.34
#: Suns of each surface: height and azimuth, degrees.
SUNS = ((25.0, 100.0), (45.0, 200.0), (35.0, 315.0))
#: Suns of walls, between whose cells no height is known: rays meet the middles of cells.
STRAIGHT_SUNS = ((25.0, 90.0), (45.0, 180.0), (35.0, 270.0))


class GridRelief(NamedTuple):
    """Heights (rows, columns) on a plane, with nothing beyond them."""

    heights: np.ndarray
    cell_m: float

    def heights_m(self, window: LatticeWindow) -> np.ndarray:
        """Heights in a window."""
        rows, columns = self.heights.shape
        j, i = (
            np.arange(start, start + count) for start, count in ((window.j0, window.rows), (window.i0, window.columns))
        )
        found = self.heights[np.clip(j, 0, rows - 1)][:, np.clip(i, 0, columns - 1)].astype(np.float32)
        found[(j < 0) | (j >= rows)] = -1e6
        found[:, (i < 0) | (i >= columns)] = -1e6
        return found

    def highest_m(self, _window: LatticeWindow) -> float:
        """Greatest height."""
        return float(self.heights.max())

    limit_m = highest_m

    def curvature_per_m(self, window: LatticeWindow) -> np.ndarray:
        """None, as GRASS has none."""
        return np.zeros((window.rows, 1), np.float32)


def shadows(heights: np.ndarray, cell_m: float, sun: tuple[float, float]) -> np.ndarray:
    """Mask of the cells in shadow."""
    rows, columns = heights.shape
    toward = ChartSun.of(SunDirection(*sun), 0)
    horizon = horizon_tangent(GridRelief(heights, cell_m), LatticeWindow(0, 0, 0, columns, rows), toward)
    return horizon >= toward.tangent


def grass_shadows(surface: Surface, east: np.ndarray, north: np.ndarray, sun: tuple[float, float]) -> np.ndarray:
    """Mask of the places, metres east and north, that r.sunmask has in shadow."""
    height, azimuth = np.radians(sun)
    ahead = east * np.sin(azimuth) + north * np.cos(azimuth)
    aside = north * np.sin(azimuth) - east * np.cos(azimuth)
    cell_m = surface.cell_m / 2.0
    reach = surface.range_m / np.tan(height)
    columns = int((np.ptp(ahead) + reach) / cell_m) + 3
    rows = int(np.ptp(aside) / cell_m) + 3
    at = ahead.min() + (np.arange(columns) - 1) * cell_m
    left = (aside.max() + cell_m - np.arange(rows) * cell_m)[:, np.newaxis]
    turned = surface.heights(
        at * np.sin(azimuth) - left * np.cos(azimuth), at * np.cos(azimuth) + left * np.sin(azimuth)
    )
    mask = run_grass(turned, cell_m, sun[0])
    row = np.rint((left[0, 0] - aside) / cell_m).astype(int)
    return mask[row, np.rint((ahead - at[0]) / cell_m).astype(int)]


def run_grass(heights: np.ndarray, cell_m: float, height_deg: float) -> np.ndarray:
    """Mask of the cells in shadow under a sun in the east, of r.sunmask."""
    rows, columns = heights.shape
    with tempfile.TemporaryDirectory() as folder:
        dem, mask, job = (Path(folder) / name for name in ("dem.txt", "mask.txt", "job.sh"))
        edges = {"north": rows * cell_m, "south": 0, "east": columns * cell_m, "west": 0, "rows": rows, "cols": columns}
        with dem.open("w") as file:
            file.writelines(f"{name}: {value!r}\n" for name, value in edges.items())
            np.savetxt(file, heights, fmt="%.3f")
        job.write_text(
            f"set -e\nr.in.ascii --quiet input={dem} output=dem\ng.region raster=dem\n"
            f"r.sunmask --quiet -z elevation=dem output=mask altitude={height_deg} azimuth=90\n"
            f"r.out.ascii --quiet -h input=mask output={mask} null_value=0\n"
        )
        command = ["grass", "--tmp-location", "XY", "--exec", "sh", str(job)]
        subprocess.run(command, check=True, capture_output=True)
        return np.loadtxt(mask).astype(bool)


def edge_cells(mask: np.ndarray) -> np.ndarray:
    """Cells with a neighbour, of eight, of the other kind."""
    padded, found = np.pad(mask, 1, mode="edge"), np.zeros_like(mask)
    rows, columns = mask.shape
    for row in range(3):
        for column in range(3):
            found |= padded[row : row + rows, column : column + columns] != mask
    return found


class Surface(NamedTuple):
    """Heights at places, metres east and north; the width of its cells, and its greatest difference of heights."""

    heights: Callable[[np.ndarray, np.ndarray], np.ndarray]
    cell_m: float
    range_m: float


def gridded(heights: np.ndarray, cell_m: float, order: int) -> Surface:
    """Surface through the middles of cells (rows, columns), by splines of an order, from the middle of the grid."""
    middle = [(side - 1) / 2.0 for side in heights.shape]

    def at(east: np.ndarray, north: np.ndarray) -> np.ndarray:
        place = np.broadcast_arrays(middle[0] - north / cell_m, middle[1] + east / cell_m)
        return map_coordinates(heights, place, order=order, mode="nearest")

    return Surface(at, cell_m, float(np.ptp(heights)))


def places(rows: int, columns: int, cell_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Metres east and north of the middle of a grid, of its cells."""
    north, east = np.meshgrid(
        (rows - 1) / 2.0 - np.arange(rows), np.arange(columns) - (columns - 1) / 2.0, indexing="ij"
    )
    return east * cell_m, north * cell_m


def on_cone() -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """A cone steeper than the suns, 800 m high, on a plane of 10 m cells."""
    surface = Surface(lambda east, north: np.maximum(800.0 - 1.6 * np.hypot(east, north), 0.0), 10.0, 800.0)
    # An odd number of cells: one is at the tip.
    east, north = places(401, 401, 10.0)
    for sun in SUNS:
        ours = shadows(surface.heights(east, north), 10.0, sun)
        yield f"cone, sun {sun}", ours, grass_shadows(surface, east, north, sun)


def on_world() -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """Tiles of the synthetic world, in whose light they are."""
    for zoom, tiles, suns in ((13, 5, SUNS), (12, 5, ((12.0, 280.0),))):
        heights, cell_m, (x, y) = world(zoom, tiles)
        surface = gridded(heights, cell_m, 3)
        east, north = places(256, 256, cell_m)
        for sun in suns:
            yield (
                f"world at zoom {zoom}, sun {sun}",
                world_shadows(zoom, x + tiles // 2, y + tiles // 2, sun),
                grass_shadows(surface, east, north, sun),
            )


def world(zoom: int, tiles: int) -> tuple[np.ndarray, float, tuple[int, int]]:
    """Bare heights of the world in the chart's metres, their cells, and the first tile."""
    u, v = (float(at) for at in MERCATOR.forward(np.array(MOUNTAINS[0]), np.array(MOUNTAINS[1])))
    x, y = int(u * 2**zoom) - tiles // 2, int(v * 2**zoom) - tiles // 2
    made = World()
    heights = np.vstack(
        [np.hstack([made.heights(zoom, x + i, y + j, bare=True) for i in range(tiles)]) for j in range(tiles)]
    )
    window = LatticeWindow(zoom + 8, x * 256, y * 256, 256 * tiles, 256 * tiles)
    scale = chart_scale(made.landscape, window.rows_v)[:, np.newaxis]
    return heights / scale, Grid(zoom, x, y).pixel_m, (x, y)


def world_shadows(zoom: int, x: int, y: int, sun: tuple[float, float]) -> np.ndarray:
    """Mask of the shadows of a tile as the world has them."""
    landscape = World().landscape
    clearance, _, _ = relief_light(landscape, ChartSun.of(SunDirection(*sun), landscape), Grid(zoom, x, y))
    return np.zeros((256, 256), bool) if clearance is None else clearance <= 0.0


def on_real(folder: Path) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """A surface of buildings and trees near Washington DC."""
    import rasterio

    with rasterio.open(folder / "elevation" / "dsm.tif") as file:
        heights, cell_m = file.read(1).astype(np.float64), float(file.res[0])
    surface = gridded(heights, cell_m, 1)
    # Rays from cells near the border leave the surface.
    rows, columns = heights.shape
    east, north = places(rows - 120, columns - 120, cell_m)
    for sun in STRAIGHT_SUNS:
        ours = shadows(heights, cell_m, sun)[60:-60, 60:-60]
        yield f"dsm.tif, sun {sun}", ours, grass_shadows(surface, east, north, sun)


def main() -> None:
    """Print the cells that differ, and those of them that touch no edge, of which there must be none."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder with elevation/dsm.tif")
    asked = parser.parse_args()
    made = [on_cone(), on_world(), *([on_real(asked.data)] if asked.data else [])]
    print(f"{'':36} {'cells':>9} {'shadow':>8} {'differ':>8} {'off edges':>9}")
    off_edges = 0
    for name, ours, theirs in (one for part in made for one in part):
        differ = ours != theirs
        apart = differ & ~edge_cells(theirs)
        print(f"{name:36} {ours.size:9,} {theirs.mean():8.2%} {differ.mean():8.3%} {apart.sum():9,}", flush=True)
        off_edges += int(apart.sum())
    if off_edges:
        sys.exit("beyond the edges of shadows")


if __name__ == "__main__":
    main()
