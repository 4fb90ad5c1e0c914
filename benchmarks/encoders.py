"""Lossless files: processor time and size of ours beside zlib, GDAL, Pillow and, where installed, isal and zlib-ng.

    python benchmarks/encoders.py                          # images of the embedded world
    python benchmarks/encoders.py naip.tif ortho.png       # and the upper left corner of photographs of your own

Images have 640 x 480 px. Times are the least of several runs in turns on one thread; sizes are shares of the pixels.
"""

from __future__ import annotations

import argparse
import time
import zlib
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from terrainav.core.capture.georeference import Georeference
from terrainav.core.capture.metadata import Description
from terrainav.core.capture.writers import geotiff, png
from terrainav.core.world import World

WIDTH, HEIGHT, ZOOM, REPEATS = 640, 480, 18, 9
#: Rows of a strip, as other encoders compress them.
ROWS = 128
Encoder = Callable[[Any], int]


def painted(map_type: str) -> Any:
    """Image of the embedded world."""
    world, tiles = World(2024), [(65_635 + column, 103_759) for column in range(3)]
    rows = [[world.tile(map_type, ZOOM, x, y + row) for x, y in tiles] for row in range(2)]
    return np.concatenate([np.concatenate(row, axis=1) for row in rows])[:HEIGHT, :WIDTH]


def photograph(path: Path) -> Any:
    """Upper left corner of a file, smaller if the file is."""
    with Image.open(path) as image:
        return np.ascontiguousarray(np.asarray(image)[:HEIGHT, :WIDTH, :3])


def in_strips(compress: Callable[[Any], bytes]) -> Encoder:
    """Horizontal differences, as in a TIFF with Predictor 2, and a compressor of strips."""

    def encode(pixels: Any) -> int:
        size = 0
        for top in range(0, len(pixels), ROWS):
            changes = pixels[top : top + ROWS].copy()
            changes[:, 1:] -= pixels[top : top + ROWS, :-1]
            size += len(compress(changes.data))
        return size

    return encode


def zlib_like(module: Any, level: int, strategy: int = 0) -> Encoder:
    """A module with zlib's functions."""

    def compress(data: Any) -> bytes:
        packer = module.compressobj(level, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, strategy)
        return bytes(packer.compress(data) + packer.flush())

    return in_strips(compress)


def by_gdal(*options: str) -> Encoder:
    """GDAL's GeoTIFF in memory."""
    from osgeo import gdal

    gdal.UseExceptions()

    def encode(pixels: Any) -> int:
        height, width, channels = pixels.shape
        raster = gdal.GetDriverByName("MEM").Create("", width, height, channels, gdal.GDT_Byte)
        raster.WriteRaster(
            0, 0, width, height, pixels.tobytes(),
            buf_pixel_space=channels, buf_line_space=channels * width, buf_band_space=1,
        )  # fmt: skip
        gdal.GetDriverByName("GTiff").CreateCopy("/vsimem/a.tif", raster, options=["INTERLEAVE=PIXEL", *options])
        return int(gdal.VSIStatL("/vsimem/a.tif").size)

    return encode


def encoders() -> dict[str, Encoder]:
    """All encoders that are installed."""
    about = Description("image", "satellite", "", "", ZOOM, 0.0, 0.0, 1.0)
    place = Georeference(0.0, 0.0, 1.0, 1.0, WIDTH, HEIGHT)
    found: dict[str, Encoder] = {
        "TerrAInav, GeoTIFF": lambda pixels: len(geotiff(pixels, place, about)),
        "TerrAInav, PNG": lambda pixels: len(png(pixels, about)),
        "zlib, runs": zlib_like(zlib, 6, zlib.Z_RLE),
        "zlib, level 1": zlib_like(zlib, 1),
        "zlib, level 6": zlib_like(zlib, 6),
    }
    if find_spec("osgeo"):
        for level in (1, 6):
            found[f"GDAL, GeoTIFF, level {level}"] = by_gdal("COMPRESS=DEFLATE", "PREDICTOR=2", f"ZLEVEL={level}")
    if find_spec("isal"):
        found["isal, level 1"] = zlib_like(import_module("isal.isal_zlib"), 1)
    if find_spec("zlib_ng"):
        found["zlib-ng, runs"] = zlib_like(import_module("zlib_ng.zlib_ng"), 6, zlib.Z_RLE)
    return found


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("photographs", type=Path, nargs="*")
    asked = parser.parse_args()
    images = {map_type: painted(map_type) for map_type in ("satellite", "roadmap")}
    images.update((path.stem, photograph(path)) for path in asked.photographs)
    known = encoders()
    print("| encoder |", " | ".join(f"{name} ms | size" for name in images), "|")
    print("| --- |", " | ".join("---: | ---:" for _ in images), "|")
    least: dict[tuple[str, str], float] = {}
    sizes = {}
    for _ in range(REPEATS):
        for name, encode in known.items():
            for image, pixels in images.items():
                began = time.thread_time()
                sizes[name, image] = encode(pixels) / pixels.nbytes
                least[name, image] = min(least.get((name, image), np.inf), time.thread_time() - began)
    for name in known:
        cells = (f"{1e3 * least[name, image]:.1f} | {100 * sizes[name, image]:.1f} %" for image in images)
        print(f"| {name} |", " | ".join(cells), "|")


if __name__ == "__main__":
    main()
