"""Overviews of a mosaic, straight from its pictures.

GDAL's own way reads the virtual raster block by block, four times slower than reading each picture once.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from osgeo import gdal

from ...core.errors import Cancelled, OutputError
from ...core.files import partial_file

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .mosaic import Placed

    Sums = NDArray[np.uint32]

#: Pixels of the mosaic along a side of one of its first overview. Finer ones cost disk and gain little: a screen
#: at half size still needs a few dozen pictures only.
FACTOR = 4
#: Overviews go on until the mosaic fits about a thumbnail.
_LAST_PX = 256
#: Lossless and quick: level 1 packs aerial imagery within a few percent of the default.
_OPTIONS = ("COMPRESS=DEFLATE", "PREDICTOR=2", "ZLEVEL=1", "TILED=YES", "BIGTIFF=IF_SAFER")
#: Share of the work that the first overview is; the rest is made from it.
_FIRST_SHARE = 0.9
#: Pictures decoded ahead of need, for each thread.
_AHEAD = 4


def build_overviews(
    placed: Placed,
    size: tuple[int, int],
    channels: int,
    target: Path,
    progress: Callable[[float], bool],
) -> None:
    """Write the file that GDAL takes for a raster's overviews, whole or not at all.

    Every overview pixel is the mean of all picture pixels in it, and opaque where there is one.

    Parameters
    ----------
    placed : Placed
        Pictures in the pixels of the mosaic.
    size : tuple
        Width and height of the mosaic in px.
    channels : int
        1 or 3, of the pictures.
    target : Path
        Where to; what is there is gone afterwards, also where the mosaic is so small that it needs none.
    progress : callable
        Takes the share done, 0 to 1; an answer of False stops.

    Raises
    ------
    Cancelled, OutputError
    """
    width, height = (-(-side // FACTOR) for side in size)
    if max(size) <= _LAST_PX:
        target.unlink(missing_ok=True)
        return
    try:
        with partial_file(target) as partial:
            raster = gdal.GetDriverByName("GTiff").Create(
                str(partial), width, height, channels + 1, gdal.GDT_Byte, [*_OPTIONS, _photometric(channels)]
            )
            if raster is None:
                raise _failed(target)
            raster.GetRasterBand(channels + 1).SetColorInterpretation(gdal.GCI_AlphaBand)
            _fill(raster, placed, (width, height), channels, progress)
            _reduce(raster, (width, height), progress)
            if raster.FlushCache() not in (None, gdal.CE_None):
                raise _failed(target)
            del raster
    except OSError as wrong:
        raise OutputError(f"mosaic {target}: cannot be written ({wrong.strerror})") from wrong


def _photometric(channels: int) -> str:
    return "PHOTOMETRIC=RGB" if channels == 3 else "PHOTOMETRIC=MINISBLACK"


def _fill(
    raster: gdal.Dataset,
    placed: Placed,
    size: tuple[int, int],
    channels: int,
    progress: Callable[[float], bool],
) -> None:
    """Add up the pictures from north to south, and write rows that no later picture reaches."""
    band_top = 0
    sums = np.zeros((0, size[0], channels + 1), np.uint32)
    tops = (placed.top_px // FACTOR).astype(np.int64)
    for index, (left, top, part) in enumerate(_reduced(placed, channels)):
        if not progress(_FIRST_SHARE * index / len(placed.paths)):
            raise Cancelled("mosaic: stopped")
        settled = int(tops[index]) - band_top
        # Whole blocks of the file at a time; a picture's rounding may start it a row before its neighbours.
        if settled > 256:
            _write(raster, sums[: settled - 1], band_top)
            sums, band_top = sums[settled - 1 :], band_top + settled - 1
        bottom = top + part.shape[0] - band_top
        if bottom > len(sums):
            sums = np.concatenate([sums, np.zeros((bottom - len(sums), *sums.shape[1:]), np.uint32)])
        sums[top - band_top : bottom, left : left + part.shape[1]] += part
    _write(raster, sums, band_top)


def _reduced(placed: Placed, channels: int) -> Iterator[tuple[int, int, Sums]]:
    """Left, top, and the sums and counts of the overview's pixels for each picture, in order."""
    count = os.cpu_count() or 1
    columns = (placed.left_px, placed.top_px, placed.width_px, placed.height_px)
    jobs = zip(placed.paths, *(values.astype(np.int64).tolist() for values in columns))
    with ThreadPoolExecutor(count, thread_name_prefix="terrainav-overview") as pool:
        waiting = [pool.submit(_reduce_picture, channels, *job) for job in islice(jobs, count * _AHEAD)]
        try:
            while waiting:
                yield waiting.pop(0).result()
                waiting += [pool.submit(_reduce_picture, channels, *job) for job in islice(jobs, 1)]
        finally:
            for future in waiting:
                future.cancel()


def _reduce_picture(
    channels: int, path: Path, left: int, top: int, width: int, height: int
) -> tuple[int, int, Sums]:
    picture = gdal.Open(str(path))
    pixels = picture.ReadAsArray(buf_xsize=width, buf_ysize=height) if picture is not None else None
    if pixels is None:
        raise _failed(path)
    # Lines of the picture as (column, channel), the last channel counting the pixels.
    # Sixteen bits hold the sum of an overview pixel of one picture: FACTOR² * 255.
    lines = np.empty((height, width, channels + 1), np.uint16)
    lines[..., :channels] = np.moveaxis(pixels.reshape(-1, height, width)[:channels], 0, -1)
    lines[..., channels] = 1
    rows = np.add.reduceat(lines, _starts(top, height), axis=0, dtype=np.uint16)
    return left // FACTOR, top // FACTOR, np.add.reduceat(rows, _starts(left, width), axis=1, dtype=np.uint16)


def _starts(first: int, length: int) -> NDArray[np.int64]:
    """Where along a picture's side the overview's pixels begin."""
    return np.r_[0, np.arange(FACTOR - first % FACTOR, length, FACTOR)]


def _write(raster: gdal.Dataset, sums: Sums, top: int) -> None:
    sums = sums[: raster.RasterYSize - top]
    if not len(sums):
        return
    counts = sums[..., -1:]
    pixels = ((sums[..., :-1] + counts // 2) // np.maximum(counts, 1)).astype(np.uint8)
    alpha = np.where(counts > 0, np.uint8(255), np.uint8(0))
    bands = np.moveaxis(np.concatenate([pixels, alpha], axis=-1), -1, 0)
    if raster.WriteArray(np.ascontiguousarray(bands), 0, top) != gdal.CE_None:
        raise _failed(Path(raster.GetDescription()))


def _reduce(raster: gdal.Dataset, size: tuple[int, int], progress: Callable[[float], bool]) -> None:
    """Halve the first overview again and again, inside the same file."""
    factors, factor = [], 2
    while max(size) * FACTOR // factor > _LAST_PX * FACTOR:
        factors.append(factor)
        factor *= 2

    def step(share: float, _text: str, _data: object) -> int:
        return int(progress(_FIRST_SHARE + (1.0 - _FIRST_SHARE) * share))

    raster.FlushCache()
    if factors and raster.BuildOverviews("AVERAGE", factors, callback=step) != gdal.CE_None:
        if not progress(1.0):
            raise Cancelled("mosaic: stopped")
        raise _failed(Path(raster.GetDescription()))


def _failed(path: Path) -> OutputError:
    reason = " ".join(gdal.GetLastErrorMsg().split())
    return OutputError(f"mosaic {path}: cannot be made ({reason or 'no reason given'})")
