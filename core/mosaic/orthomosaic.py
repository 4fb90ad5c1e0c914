"""Orthomosaics of a dataset's images, in files that may be larger than memory.

Each pixel comes from the image that sees its ground at the smallest angle from the vertical, unless relief hides it.
Among cameras at equal heights, that is the camera with the nearest nadir, so that seams form the Voronoi diagram of
the nadirs. Colours are sampled bilinearly where the exact camera sees the ground.
"""

from __future__ import annotations

import math
import os
from collections import OrderedDict
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from threading import Lock
from typing import NamedTuple

import numpy as np

from ..arrays import Bytes, Floats, NDArray, Numbers
from ..bands import Bands
from ..dataset.dataset import open_masked, read_band_metadata
from ..errors import Cancelled, InvalidInput
from ..limits import MAX_MOSAIC_SIDE_PX
from ..mission.estimate import ORTHOMOSAIC_THREADS
from ..picture.heights import mission_heights
from ..picture.resampling import sample
from .bigtiff import TILE_PX, packed_tile, write_tiles
from .frames import CameraImages, ImageBoxes, OpenHeights, PlacedImages, place_images, unit_m
from .raster import PixelBlock, Raster, places

#: Called with the share done, 0 to 1; returns False to cancel.
Progress = Callable[[float], bool]

#: Side of the blocks that threads make: whole tiles, some 100 MB a thread.
_BLOCK_PX = 2 * TILE_PX
#: Size of the decoded images that are kept, besides those in use.
_KEPT_BYTES = 1 << 28


@dataclass(frozen=True)
class Orthomosaic:
    """A written mosaic.

    Parameters
    ----------
    images, used : int
        Number of all images, and of those that the mosaic shows.
    shown_share : float
        Share of the mosaic's pixels that show ground.
    """

    path: str
    map_type: str
    images: int
    used: int
    width_px: int
    height_px: int
    gsd_m_per_px: float
    crs: str
    shown_share: float


def make_orthomosaic(
    folder: str | os.PathLike[str],
    target: str | os.PathLike[str] | None = None,
    *,
    map_type: str | None = None,
    gsd_m: float | None = None,
    most_px: int | None = None,
    open_heights: OpenHeights = mission_heights,
    progress: Progress = lambda share: True,  # noqa: ARG005  goes on
) -> Orthomosaic:
    """Write an orthomosaic of the images of a dataset's map type, in the CRS of its source.

    Parameters
    ----------
    target : path or None
        File to write atomically; None for ``MAP_TYPE.tif`` in the folder.
    map_type : str or None
        None for the first map type.
    gsd_m : float or None
        Ground sample distance at the middle; None for that of the images.
    most_px : int or None
        Greatest number of pixels; the ground sample distance is enlarged to keep it.
    open_heights : callable
        Opens the heights of a mission.

    Raises
    ------
    InvalidInput
        As in `frames.place_images`, or the ground sample distance is not above 0.
    OutputError, SourceError, Cancelled
    """
    if gsd_m is not None and not (math.isfinite(gsd_m) and gsd_m > 0.0):
        raise InvalidInput("ground sample distance {0} m: must be a number above 0", gsd_m, field="gsd_m")
    path = Path(folder)
    frames, images, rows = place_images(path, map_type, open_heights)
    raster, boxes = mosaic_raster(frames, gsd_m)
    count = raster.width_px * raster.height_px
    if most_px is not None and count > most_px:
        gsd_m = (gsd_m or frames.gsd_m) * math.sqrt(count / most_px)
        raster, boxes = mosaic_raster(frames, gsd_m)
    file = path / f"{images.map_type}.tif" if target is None else Path(target)
    attributions = dict.fromkeys(images.table.attribution[row] for row in rows.tolist())
    used, shown = write_orthomosaic(
        frames, raster, boxes, file, progress, images.map_type, "; ".join(filter(None, attributions))
    )
    return Orthomosaic(
        str(file),
        images.map_type,
        len(frames),
        used,
        raster.width_px,
        raster.height_px,
        frames.gsd_m if gsd_m is None else gsd_m,
        raster.plane.crs,
        shown,
    )


def check_ending(path: str | os.PathLike[str]) -> None:
    """Raise InvalidInput unless a file's name is that of a GeoTIFF."""
    endings = (".tif", ".tiff")
    if Path(path).suffix.lower() not in endings:
        raise InvalidInput("mosaic {0}: must end in {1}", path, " or ".join(endings))


def mosaic_raster(frames: PlacedImages, gsd_m: float | None = None) -> tuple[Raster, ImageBoxes]:
    """Pixel grid over the ground in images, and the boxes of that ground.

    Edges are whole multiples of a pixel, so that mosaics of equal ground sample distance align. Without ``gsd_m``, map
    frames keep their pixels.
    """
    boxes = frames.boxes()
    west, south, east, north = frames.extent(boxes)
    if not (west < east and south < north):
        raise _no_ground(frames)
    affines = getattr(frames, "affines", None)
    if affines is not None and gsd_m is None:
        across, down = (float(max(abs(affines[0, at]), abs(affines[0, at + 1]))) for at in (1, 4))
        start_x, start_y = west, north
    else:
        middle = int(np.argmin(np.abs(frames.nadirs[1] - np.median(frames.nadirs[1]))))
        lat, lon = places(frames.plane, *(at[middle : middle + 1] for at in frames.nadirs))
        across = down = (frames.gsd_m if gsd_m is None else gsd_m) / unit_m(frames.plane, float(lat[0]), float(lon[0]))
        _check_size(*(length / across if across > 0.0 else math.inf for length in (east - west, north - south)))
        start_x, start_y = math.floor(west / across) * across, math.ceil(north / down) * down
    # Whole numbers may come out larger by rounding.
    width, height = (math.ceil(span - 1e-6) for span in ((east - start_x) / across, (start_y - south) / down))
    _check_size(width, height)
    return Raster(start_x, start_y, across, down, max(width, 1), max(height, 1), frames.plane), boxes


def _check_size(width: float, height: float) -> None:
    if max(width, height) > MAX_MOSAIC_SIDE_PX:
        raise InvalidInput(
            "mosaic of {0:,.9g} x {1:,.9g} px: at most {2:,} px along a side",
            width,
            height,
            MAX_MOSAIC_SIDE_PX,
            field="gsd_m",
            remedy="give a larger ground sample distance",
        )


def orthorectify(frames: CameraImages, target: Path, longest_px: int) -> None:
    """Orthorectify the first of some images to a GeoTIFF of at most ``longest_px`` along its longer side.

    Pixels are no finer than half of the camera's ground sample distance at the nadir. An image with the horizon in it
    reaches hundreds of kilometres: it is cut where a pixel would be wider than eight such distances.

    Raises
    ------
    InvalidInput
        The image cannot be read, or shows no ground within the domain of the CRS.
    OutputError
        The file cannot be written.
    """
    alone = frames.take(np.array([0]))
    below_m = frames.gsd_m * float(frames.sizes_px.max()) / (2.0 * max(frames.cameras.of(0).half_tangents))
    reach_m, level_deg = 8.0 * frames.gsd_m * longest_px, 89.99
    flattest_deg = min(math.degrees(math.atan2(reach_m, below_m)), level_deg)
    cut = replace(alone, flattest_deg=flattest_deg)
    boxes = cut.boxes()
    west, south, east, north = cut.extent(boxes)
    alone = replace(alone, flattest_deg=level_deg)
    if not (west < east and south < north):
        raise _no_ground(alone)
    lat, lon = places(frames.plane, *(at[:1] for at in frames.nadirs))
    finest = alone.gsd_m / (2.0 * unit_m(frames.plane, float(lat[0]), float(lon[0])))
    pixel = max(max(east - west, north - south) / longest_px, finest)
    width, height = (max(math.floor(length / pixel), 1) for length in (east - west, north - south))
    raster = Raster(west, north, pixel, pixel, width, height, frames.plane)
    write_orthomosaic(alone, raster, boxes, target)


def _no_ground(frames: PlacedImages) -> InvalidInput:
    return InvalidInput("image {0}: shows no ground that a map in {1} has", frames.paths[0].name, frames.plane.crs)


def write_orthomosaic(
    frames: PlacedImages,
    raster: Raster,
    boxes: ImageBoxes,
    target: Path,
    progress: Progress = lambda share: True,  # noqa: ARG005  goes on
    title: str = "",
    attribution: str = "",
) -> tuple[int, float]:
    """Write a mosaic as a GeoTIFF with an alpha channel, atomically.

    Returns
    -------
    used : int
        Number of images shown.
    shown_share : float
        Share of pixels that show ground.

    Raises
    ------
    InvalidInput, OutputError, SourceError, Cancelled
    """
    images = _Images(frames, raster)
    channels = images.channels
    used: set[int] = set()
    shown = 0

    def tiles() -> Iterator[tuple[int, int, bytes]]:
        nonlocal shown
        blocks = [
            (left, top)
            for top in range(0, raster.height_px, _BLOCK_PX)
            for left in range(0, raster.width_px, _BLOCK_PX)
        ]
        for number, made in enumerate(_in_order(lambda at: _make_block(frames, raster, boxes, images, *at), blocks)):
            used.update(made.used)
            shown += made.shown
            yield from made.tiles
            if not progress((number + 1) / len(blocks)):
                raise Cancelled("mosaic: stopped")

    write_tiles(target, raster.place, channels + 1, tiles(), title, attribution, images.bands())
    return len(used), shown / (raster.width_px * raster.height_px)


class _Block(NamedTuple):
    """Non-empty tiles of a block for `write_tiles`, indices of the images in it, and number of pixels with ground."""

    tiles: list[tuple[int, int, bytes]]
    used: set[int]
    shown: int


def _in_order(make: Callable[[tuple[int, int]], _Block], blocks: list[tuple[int, int]]) -> Iterator[_Block]:
    """Make blocks in threads, and yield them in order."""
    threads = min(os.cpu_count() or 1, ORTHOMOSAIC_THREADS)
    left = iter(blocks)
    with ThreadPoolExecutor(threads, thread_name_prefix="terrainav-mosaic") as pool:
        # Begin two blocks a thread ahead of the block that is written next.
        waiting = [pool.submit(make, at) for at in islice(left, threads * 2)]
        try:
            while waiting:
                yield waiting.pop(0).result()
                waiting += [pool.submit(make, at) for at in islice(left, 1)]
        finally:
            for future in waiting:
                future.cancel()


def _make_block(
    frames: PlacedImages, raster: Raster, boxes: ImageBoxes, images: _Images, left: int, top: int
) -> _Block:
    block = raster.block(left, top, _BLOCK_PX)
    choice = choose_images(frames, boxes, block, images)
    is_shown = choice.image >= 0
    used = np.unique(choice.image[is_shown]).tolist()
    if not used:
        return _Block([], set(), 0)
    pixels = np.zeros((*is_shown.shape, images.channels + 1), np.uint8)
    for index in used:
        at = choice.image == index
        image, _ = images.decode(index)
        x, y = choice.x[at] * image.shape[1], choice.y[at] * image.shape[0]
        pixels[at, :-1] = np.rint(sample(image, x, y, "bilinear")).astype(np.uint8)
    pixels[..., -1] = is_shown * np.uint8(255)
    tiles = [
        ((left + across) // TILE_PX, (top + down) // TILE_PX, packed_tile(part))
        for down in range(0, pixels.shape[0], TILE_PX)
        for across in range(0, pixels.shape[1], TILE_PX)
        if (part := pixels[down : down + TILE_PX, across : across + TILE_PX])[..., -1].any()
    ]
    return _Block(tiles, set(used), int(is_shown.sum()))


class ChosenImages(NamedTuple):
    """Image (h, w) of each pixel of a block, -1 for none, and position in that image, in shares of its size."""

    image: Numbers
    x: Floats
    y: Floats


def choose_images(
    frames: PlacedImages, boxes: ImageBoxes, block: PixelBlock, images: _Images | None = None
) -> ChosenImages:
    """Choose the image that sees each pixel of a block most steeply, the first among equals.

    Parameters
    ----------
    images : _Images or None
        Images whose masked pixels count as not seen; None to ignore masks.
    """
    shape = block.lat_deg.shape
    index, best = np.full(shape, -1, np.int64), np.full(shape, -np.inf)
    found = ChosenImages(index, np.zeros(shape), np.zeros(shape))
    with np.errstate(invalid="ignore"):
        near = (boxes.west <= block.x[-1]) & (boxes.east >= block.x[0])
        near &= (boxes.south <= block.y[0]) & (boxes.north >= block.y[-1])
    candidates = np.flatnonzero(near).astype(np.int64)
    if not len(candidates):
        return found
    ground = frames.block_ground(block, candidates)
    bounds = frames.steepness_bounds(block, ground, candidates)
    order = np.lexsort((candidates, -bounds))
    for candidate, bound in zip(candidates[order].tolist(), bounds[order].tolist()):
        if bound < best.min():
            break
        part = block.inside(*(float(edge[candidate]) for edge in boxes))
        within = ground.take(part)
        sight = frames.sight(candidate, block.take(part), within)
        own, steepest = index[part], best[part]
        better = sight.inside & ((sight.steepness > steepest) | ((sight.steepness == steepest) & (candidate < own)))
        if images is not None and better.any():
            better = images.shows(candidate, sight.x, sight.y, better)
        better = frames.visible(candidate, within, better)
        for whole, values in ((steepest, sight.steepness), (found.x[part], sight.x), (found.y[part], sight.y)):
            whole[better] = values[better]
        own[better] = candidate
    return found


class _Images:
    """Thread-safe cache of decoded images, of bounded size.

    Images whose pixels are everywhere finer than the mosaic's are reduced by a whole factor.
    """

    def __init__(self, frames: PlacedImages, raster: Raster) -> None:
        self._paths = frames.paths
        lat, lon = places(frames.plane, *(at[:1] for at in frames.nadirs))
        pixel_m = raster.across * unit_m(frames.plane, float(lat[0]), float(lon[0]))
        self._reduced = max(int(pixel_m / frames.coarsest_gsd_m + 1e-6), 1)
        self._kept: OrderedDict[int, Future[tuple[Bytes, Bytes | None]]] = OrderedDict()
        self._bytes = 0
        self._lock = Lock()
        self.channels = 0
        self.channels = self.decode(0)[0].shape[2]

    def bands(self) -> Bands | None:
        """Bands of the mosaic; None if its values are not those of the images, as with more than 8 bits."""
        stated = read_band_metadata(self._paths[0], self.channels)
        if stated is None or stated.data_type != "uint8" or len(stated.shown) != self.channels:
            return None
        return stated.picture_bands(self.channels)

    def decode(self, index: int) -> tuple[Bytes, Bytes | None]:
        """Pixels (h, w, c) of an image, and a mask (h, w), 0 for pixels without data; None if all pixels have data."""
        with self._lock:
            known = self._kept.get(index)
            if known is not None:
                self._kept.move_to_end(index)
            else:
                future = self._kept[index] = Future()
        if known is not None:
            return known.result()
        try:
            image = self._read(self._paths[index])
        except BaseException as wrong:
            future.set_exception(wrong)
            raise
        future.set_result(image)
        with self._lock:
            self._bytes += _byte_count(image)
            for old, other in list(self._kept.items()):
                if self._bytes <= _KEPT_BYTES:
                    break
                if old != index and other.done():
                    del self._kept[old]
                    self._bytes -= _byte_count(other.result())
        return image

    def shows(self, index: int, x: Floats, y: Floats, which: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Pixels (h, w) among ``which`` whose positions in an image, in shares of its size, are not masked."""
        image, mask = self.decode(index)
        if mask is None:
            return which
        found = which.copy()
        column, row = x[which] * image.shape[1], y[which] * image.shape[0]
        found[which] = sample(mask[..., np.newaxis], column, row, "bilinear")[:, 0] > 127.5
        return found

    def _read(self, path: Path) -> tuple[Bytes, Bytes | None]:
        pixels, mask = open_masked(path)
        if self.channels == 1 and pixels.shape[2] == 3:
            # ITU-R BT.601.
            pixels = np.rint(pixels @ np.array([0.299, 0.587, 0.114])).astype(np.uint8)[..., np.newaxis]
        elif self.channels == 3 and pixels.shape[2] == 1:
            pixels = np.repeat(pixels, 3, axis=2)
        step = min(self._reduced, max(pixels.shape[:2]))
        if step == 1:
            return pixels, mask
        from PIL import Image

        reduced = np.asarray(Image.fromarray(pixels.squeeze()).reduce(step))
        if mask is not None:
            mask = np.asarray(Image.fromarray(mask).reduce(step))
        return reduced.reshape(*reduced.shape[:2], -1), mask


def _byte_count(image: tuple[Bytes, Bytes | None]) -> int:
    return image[0].nbytes + (0 if image[1] is None else image[1].nbytes)
