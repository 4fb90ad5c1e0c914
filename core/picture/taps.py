"""Bilinear interpolation of images and of tiles, compiled: the same as `resampling.PackedImage.sample`, and faster.

Needs numba; see `compiling`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba.extending import intrinsic

from ..arrays import Floats, Numbers, PixelValues
from ..external.compiling import compiled


@compiled
def _shares(position: float, size: int) -> tuple[int, int, float, float]:
    """Indices and weights of the two pixels on either side of a position along an axis."""
    first = math.floor(position - 0.5)
    distance = position - 0.5 - first
    near, far = 1.0 - distance, 1.0 - abs(position - 0.5 - (first + 1))
    total = near + far
    last = size - 1
    return min(max(first, 0), last), min(max(first + 1, 0), last), near / total, far / total


@compiled
def interpolate(image: PixelValues, x_px: Floats, y_px: Floats, scratch: PixelValues, values: PixelValues) -> None:
    """Fill in values (n, c) of an image (h, w, c) at points (n,); ``scratch`` (8,) is of the values' type."""
    height, width, channels = image.shape
    for point in range(len(x_px)):
        # Arithmetic in the type of the values.
        left, right, scratch[0], scratch[1] = _shares(x_px[point], width)
        top, bottom, scratch[2], scratch[3] = _shares(y_px[point], height)
        for channel in range(channels):
            scratch[4], scratch[5] = image[top, left, channel], image[top, right, channel]
            scratch[6], scratch[7] = image[bottom, left, channel], image[bottom, right, channel]
            upper = scratch[4] * scratch[0] + scratch[5] * scratch[1]
            lower = scratch[6] * scratch[0] + scratch[7] * scratch[1]
            values[point, channel] = upper * scratch[2] + lower * scratch[3]


@intrinsic  # type: ignore[untyped-decorator]
def _value(_: Any, address: Any, like: Any) -> tuple[Any, Any]:
    """Value at an address, of an array's type."""

    def load(context: Any, builder: Any, _signature: Any, given: Any) -> Any:
        pointer = builder.inttoptr(given[0], context.get_data_type(like.dtype).as_pointer())
        return context.unpack_value(builder, like.dtype, pointer)

    return like.dtype(address, like), load


@compiled
def _address(addresses: Numbers, depths: Numbers, size: int, itemsize: int, row: int, column: int) -> int:
    """Address of a pixel of joined tiles."""
    tile_y, tile_x = row // size, column // size
    offset = (row - tile_y * size) * size + column - tile_x * size
    address: int = addresses[tile_y, tile_x] + offset * depths[tile_y, tile_x] * itemsize
    return address


@compiled
def _light(address: int, like: PixelValues, levels: Floats | None, sums: Floats) -> Any:
    """Value at an address, of an array's type, or the linear light of it, as one of the type of sums."""
    value = _value(address, like)
    if levels is None:
        return sums.dtype.type(value)
    return levels[np.uint64(value)]


@compiled
def _add_sample(
    addresses: Numbers,
    depths: Numbers,
    size: int,
    x: float,
    y: float,
    is_masked: bool,
    picture: PixelValues,
    levels: Floats | None,
    sums: Floats,
) -> int:
    """Add a sample of tiles to sums; return 1 if it lacks imagery."""
    height, width = addresses.shape[0] * size, addresses.shape[1] * size
    channels, itemsize, kind, missing = len(sums), picture.itemsize, sums.dtype.type, 0
    left, right, west, east = _shares(x, width)
    top, bottom, north, south = _shares(y, height)
    tile_y, tile_x = top // size, left // size
    depth = depths[tile_y, tile_x]
    first = addresses[tile_y, tile_x] + ((top - tile_y * size) * size + left - tile_x * size) * depth * itemsize
    if right < (tile_x + 1) * size and bottom < (tile_y + 1) * size:
        second = first + (right - left) * depth * itemsize
        down = (bottom - top) * size * depth * itemsize
        third, fourth = first + down, second + down
    else:
        second = _address(addresses, depths, size, itemsize, top, right)
        third = _address(addresses, depths, size, itemsize, bottom, left)
        fourth = _address(addresses, depths, size, itemsize, bottom, right)
    if is_masked:
        near_y, near_x = min(max(int(y), 0), height - 1), min(max(int(x), 0), width - 1)
        if depths[near_y // size, near_x // size] > channels:
            near = _address(addresses, depths, size, itemsize, near_y, near_x)
            missing = int(_value(near + channels * itemsize, picture) == 0)
    # Arithmetic in the type of the sums.
    for channel in range(channels):
        at = channel * itemsize
        one, other = _light(first + at, picture, levels, sums), _light(second + at, picture, levels, sums)
        upper = one * kind(west) + other * kind(east)
        one, other = _light(third + at, picture, levels, sums), _light(fourth + at, picture, levels, sums)
        sums[channel] += upper * kind(north) + (one * kind(west) + other * kind(east)) * kind(south)
    return missing


@compiled
def _tile_at(
    addresses: Numbers, depths: Numbers, size: int, x: float, y: float, channels: int, itemsize: int
) -> tuple[float, float, float, float, int]:
    """Part of a tile around a position whose values follow from the tile alone, and the address of the pixel at 0, 0.

    The part ends in the west, east, north and south; it is empty where pixels have a mask or there is no tile.
    """
    tile_y, tile_x = math.floor(y / size), math.floor(x / size)
    if 0 <= tile_y < addresses.shape[0] and 0 <= tile_x < addresses.shape[1]:
        depth, left, top = depths[tile_y, tile_x], tile_x * size, tile_y * size
        if depth == channels:
            address = addresses[tile_y, tile_x] - (top * size + left) * channels * itemsize
            # Weights of the first pixel are rounded otherwise.
            return max(left, 1) + 0.5, left + size - 0.5, max(top, 1) + 0.5, top + size - 0.5, address
    return np.inf, -np.inf, np.inf, -np.inf, 0


@compiled
def _between(
    first: int,
    right: int,
    below: int,
    across: float,
    down: float,
    like: PixelValues,
    levels: Floats | None,
    sums: Floats,
) -> Any:
    """Value between four pixels of one tile, of which the first is at an address, as `_add_sample` adds it."""
    kind = sums.dtype.type
    west, east = kind(1.0 - across), kind(across)
    one, other = _light(first, like, levels, sums), _light(first + right, like, levels, sums)
    upper = one * west + other * east
    one, other = _light(first + below, like, levels, sums), _light(first + below + right, like, levels, sums)
    return upper * kind(1.0 - down) + (one * west + other * east) * kind(down)


@compiled
def gather(
    addresses: Numbers,
    depths: Numbers,
    size: int,
    x_px: Floats,
    y_px: Floats,
    row: Numbers,
    column: Numbers,
    is_masked: bool,
    limits: tuple[float, float],
    sums: Floats,
    picture: PixelValues,
) -> int:
    """Fill pixels (n,), each with the mean of its samples (n, k), from tiles that need not be joined.

    Parameters
    ----------
    addresses, depths : array (rows, columns) of int64
        Where the pixels (size, size, depth) of each tile begin in memory, and their channels: those of the picture, and
        a mask after them or not.
    size : int
        Width and height of a tile.
    x_px, y_px : array (n, k)
        Positions from the upper left corner of the tiles.
    row, column : array (n,)
        Pixels of the picture.
    is_masked : bool
        Whether any tile has a mask.
    limits : (least, greatest)
        Values of the picture; they are rounded if the least is finite.
    sums : array (channels,)
        Scratch, of the type in which `interpolate` has values.

    Returns
    -------
    int
        Samples without imagery.
    """
    channels, itemsize, missing = len(sums), picture.itemsize, 0
    right, below, tile = channels * itemsize, size * channels * itemsize, 0
    west, east, north, south = np.inf, -np.inf, np.inf, -np.inf
    for pixel in range(len(row)):
        sums[:] = 0
        for point in range(x_px.shape[1]):
            x, y = x_px[pixel, point], y_px[pixel, point]
            if not (west <= x < east and north <= y < south):
                west, east, north, south, tile = _tile_at(addresses, depths, size, x, y, channels, itemsize)
                if not (west <= x < east and north <= y < south):
                    missing += _add_sample(addresses, depths, size, x, y, is_masked, picture, None, sums)
                    continue
            x, y = x - 0.5, y - 0.5
            first_x, first_y = int(x), int(y)
            first = tile + first_y * below + first_x * right
            across, down = x - first_x, y - first_y
            for channel in range(channels):
                at = first + channel * itemsize
                sums[channel] += _between(at, right, below, across, down, picture, None, sums)
        _set_mean(picture, row[pixel], column[pixel], sums, x_px.shape[1], limits)
    return missing


@compiled
def _set_mean(
    picture: PixelValues, row: int, column: int, sums: Floats, count: int, limits: tuple[float, float]
) -> None:
    """Set a pixel to the mean of so many samples."""
    kind = sums.dtype.type
    for channel in range(len(sums)):
        mean = sums[channel] / kind(count)
        if limits[0] > -math.inf:
            mean = kind(min(max(np.rint(mean), limits[0]), limits[1]))
        picture[row, column, channel] = mean


@compiled
def _nearest(light: float, begins: Numbers, borders: Floats) -> int:
    """Value of 8 bits nearest to linear light."""
    value: int = begins[int(light * (len(begins) - 1))]
    while value < len(borders) and light >= borders[value]:
        value += 1
    return value


@compiled
def average(
    addresses: Numbers,
    depths: Numbers,
    size: int,
    row: Numbers,
    column: Numbers,
    x_px: Floats,
    y_px: Floats,
    steps: Floats,
    counts: Numbers,
    is_masked: bool,
    limits: tuple[float, float],
    sums: Floats,
    picture: PixelValues,
    levels: Floats | None,
    begins: Numbers | None,
    borders: Floats | None,
) -> int:
    """Fill pixels (n,), each with the mean of the samples of its area, from tiles that need not be joined.

    Parameters
    ----------
    row, column, x_px, y_px, steps, counts : arrays
        As `geodesy.areas.Areas` has them, in pixels from the upper left corner of the tiles.
    levels, begins, borders : arrays, or None
        Linear light of each value, the value that each of so many even steps of light begins with, and the borders
        between values, for means in linear light; None for means of values.

    Others are those of `gather`, which does the same with samples that are made before.
    """
    channels, itemsize, missing = len(sums), picture.itemsize, 0
    right, below, tile = channels * itemsize, size * channels * itemsize, 0
    west, east, north, south = np.inf, -np.inf, np.inf, -np.inf
    for pixel in range(len(row)):
        wide, high = counts[pixel]
        across_x, across_y, down_x, down_y = steps[pixel]
        sums[:] = 0
        for other in range(high):
            off_down = other - (high - 1) / 2.0
            for one in range(wide):
                off = one - (wide - 1) / 2.0
                x = x_px[pixel] + across_x * off + down_x * off_down
                y = y_px[pixel] + across_y * off + down_y * off_down
                if not (west <= x < east and north <= y < south):
                    west, east, north, south, tile = _tile_at(addresses, depths, size, x, y, channels, itemsize)
                    if not (west <= x < east and north <= y < south):
                        missing += _add_sample(addresses, depths, size, x, y, is_masked, picture, levels, sums)
                        continue
                x, y = x - 0.5, y - 0.5
                first_x, first_y = int(x), int(y)
                first = tile + first_y * below + first_x * right
                across, down = x - first_x, y - first_y
                for channel in range(channels):
                    at = first + channel * itemsize
                    sums[channel] += _between(at, right, below, across, down, picture, levels, sums)
        if begins is None or borders is None:
            _set_mean(picture, row[pixel], column[pixel], sums, wide * high, limits)
            continue
        for channel in range(channels):
            picture[row[pixel], column[pixel], channel] = _nearest(sums[channel] / (wide * high), begins, borders)
    return missing
