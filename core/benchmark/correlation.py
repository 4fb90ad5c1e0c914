"""Normalised cross-correlation: a baseline without weights, for queries of known height and attitude.

A query is projected onto the ground by its height and attitude and correlated with the reference at every place. The
coefficients are computed by Fourier transforms (Lewis, *Fast normalized cross-correlation*, 1995), with a mask because
a tilted image is not a rectangle on the ground (Padfield, *Masked object registration in the Fourier domain*, IEEE TIP
2012).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from PIL import Image

from ..arrays import Floats, NDArray, Numbers
from ..dataset.dataset import open_image
from ..geodesy.camera import CORNERS, Poses
from ..geodesy.ellipsoid import WGS84, sight_lines
from ..geodesy.footprint import exact
from .answers import Answer, Locate, Query
from .folder import Benchmark, ReferenceMosaic

#: An image whose variance is below this share counts as uniform: the transforms are rounded.
_FLAT = 1e-9


class _Patch(NamedTuple):
    """A query projected onto the pixels of the reference.

    Attributes
    ----------
    grey : array (h, w)
        Grey values minus their mean; 0 where ``mask`` is 0.
    mask : array (h, w)
        1 where the query shows ground, else 0.
    left, top : int
        Upper left corner in the reference, px, at the assumed position.
    camera, centre : (column, row)
        Positions of the camera and of the ground at the image centre, px from the patch's upper left corner.
    """

    grey: Floats
    mask: Floats
    left: int
    top: int
    camera: tuple[float, float]
    centre: tuple[float, float]


class _PyramidLevel(NamedTuple):
    """The reference, reduced by a factor of ``step``."""

    grey: Floats
    step: int


def correlation(benchmark: Benchmark, gallery: Numbers) -> Locate:
    """Prepare to localise queries in the mosaic of a benchmark; a `Method`."""
    return _Correlation(benchmark, gallery).locate


class _Correlation:
    def __init__(self, benchmark: Benchmark, gallery: Numbers) -> None:
        self._mosaic = benchmark.mosaic
        whole = benchmark.grey(benchmark.mosaic.file)
        # A larger reference is reduced before it is searched whole, which bounds time and memory.
        step = max(math.ceil(math.sqrt(whole.size / 1_000_000)), 1)
        self._whole = _PyramidLevel(whole.astype(np.float64), 1)
        self._searched = _PyramidLevel(np.asarray(Image.fromarray(whole).reduce(step), np.float64), step)
        self._transforms = _transforms(self._searched.grey)
        tiles = benchmark.references
        column, row = benchmark.mosaic.px(tiles.lat_deg[gallery], tiles.lon_deg[gallery])
        width = (tiles.east - tiles.west)[gallery] / benchmark.mosaic.pixel_width
        self._tiles = np.stack([column, row, width]) / step
        self._ids = [tiles.id[at] for at in gallery.tolist()]

    def locate(self, query: Query) -> Answer:
        """Localise a query; the answer is empty if the query shows more ground than the reference, or is uniform."""
        lat, lon = self._lat_lon(self._mosaic.width_px / 2.0, self._mosaic.height_px / 2.0)
        coarse = _project(query, lat, lon, self._mosaic, self._searched.step)
        if coarse is None:
            return Answer()
        coefficients = _agreement(coarse, self._searched.grey.shape, self._transforms)
        if coefficients is None:
            return Answer()
        lat, lon = self._lat_lon(*self._refine(query, coarse, coefficients))
        return Answer(self._rank_tiles(coarse, coefficients), lat, lon)

    def _lat_lon(self, column: float, row: float) -> tuple[float, float]:
        """Latitude and longitude of a position in the mosaic."""
        lat, lon = self._mosaic.ground(np.array(column), np.array(row))
        return float(lat), float(lon)

    def _refine(self, query: Query, coarse: _Patch, coefficients: Floats) -> tuple[float, float]:
        """Refine the best candidates at full resolution; returns column and row of the camera in the mosaic."""
        step = self._searched.step
        best, found = -math.inf, (math.nan, math.nan)
        for top, left in _peaks(coefficients, min(coarse.grey.shape) // 2):
            lat, lon = self._lat_lon((left + coarse.camera[0]) * step, (top + coarse.camera[1]) * step)
            # Project again: the ground that a map's pixel shows depends on the latitude.
            patch = _project(query, lat, lon, self._mosaic, 1)
            if patch is None:
                continue
            # Three reduced pixels around the candidate: two for its error and one for rounding.
            reach = 3 * step
            high, wide = patch.grey.shape
            y, x = max(patch.top - reach, 0), max(patch.left - reach, 0)
            window = self._whole.grey[y : patch.top + high + reach, x : patch.left + wide + reach]
            if window.shape[0] < high or window.shape[1] < wide:
                continue
            near = _agreement(patch, window.shape, _transforms(window))
            if near is not None and near.max() > best:
                best = float(near.max())
                down, across = _maximum(near)
                found = x + across + patch.camera[0], y + down + patch.camera[1]
        return found

    def _rank_tiles(self, patch: _Patch, coefficients: Floats) -> list[str]:
        """Rank tiles by the highest coefficient of positions that put the query's centre in the tile's middle half."""
        high, wide = coefficients.shape
        column, row, width = self._tiles
        left, right = (
            np.clip(np.floor(column + side * width / 4.0 - patch.centre[0]), 0, wide - 1).astype(int)
            for side in (-1.0, 1.0)
        )
        top, bottom = (
            np.clip(np.floor(row + side * width / 4.0 - patch.centre[1]), 0, high - 1).astype(int)
            for side in (-1.0, 1.0)
        )
        score = np.array(
            [
                coefficients[t : b + 1, le : r + 1].max()
                for le, r, t, b in zip(left.tolist(), right.tolist(), top.tolist(), bottom.tolist())
            ]
        )
        return [self._ids[at] for at in np.argsort(-score, kind="stable")[:100].tolist()]


def _project(query: Query, lat_deg: float, lon_deg: float, mosaic: ReferenceMosaic, step: int) -> _Patch | None:
    """Project a query from an assumed camera position; None if it is tiny or larger than the reference."""
    agl = query.height_m - query.ground_m
    ground = WGS84.raised(query.ground_m)
    pose = Poses.from_attitude(
        np.array([lat_deg]),
        np.array([lon_deg]),
        np.array([agl]),
        query.yaw_deg,
        query.tilt_deg,
        query.roll_deg,
    )
    seen = exact(query.camera, pose, (*CORNERS, (0.0, 0.0)), ground)
    columns, rows = (px[0] / step for px in mosaic.px(seen.lat_deg, seen.lon_deg))
    left, top = math.floor(columns[:4].min()), math.floor(rows[:4].min())
    wide, high = math.ceil(columns[:4].max()) - left, math.ceil(rows[:4].max()) - top
    # Smaller patches match anywhere.
    if min(wide, high) < 4 or wide > mosaic.width_px / step or high > mosaic.height_px / step:
        return None
    across, down = np.meshgrid(left + 0.5 + np.arange(wide), top + 0.5 + np.arange(high))
    lat, lon = mosaic.ground(across * float(step), down * float(step))
    dlon = lon - lon_deg
    lines = sight_lines(np.array(lat_deg), np.array(agl), lat, dlon - 360.0 * np.rint(dlon / 360.0), ground)
    points, in_front = query.camera.image_xy(lines, query.yaw_deg, query.tilt_deg, query.roll_deg)
    inside = in_front & (np.abs(points) < 1.0).all(axis=-1)
    picture = _reduced(open_image(query.image, as_shown=True).convert("L"), int(inside.sum()))
    x, y = (points[..., 0] + 1.0) / 2.0 * picture.shape[1], (1.0 - points[..., 1]) / 2.0 * picture.shape[0]
    grey = np.where(inside, _bilinear(picture, x, y), 0.0)
    mask = inside.astype(np.float64)
    grey = (grey - grey.sum() / max(mask.sum(), 1.0)) * mask
    camera_at = mosaic.px(np.array(lat_deg), np.array(lon_deg))
    camera = float(camera_at[0]) / step - left, float(camera_at[1]) / step - top
    return _Patch(grey, mask, left, top, camera, (float(columns[4]) - left, float(rows[4]) - top))


def _reduced(picture: Image.Image, pixels: int) -> Floats:
    """Image as floats, averaged down by the largest whole factor that leaves at least ``pixels`` pixels."""
    factor = max(int(math.sqrt(picture.width * picture.height / max(pixels, 1))), 1)
    return np.asarray(picture.reduce(factor) if factor > 1 else picture, np.float64)


def _bilinear(picture: Floats, x: Floats, y: Floats) -> Floats:
    """Interpolated values; the centre of the first pixel is (0.5, 0.5)."""
    high, wide = picture.shape
    x, y = np.clip(x - 0.5, 0.0, wide - 1.0), np.clip(y - 0.5, 0.0, high - 1.0)
    left, top = x.astype(np.int64), y.astype(np.int64)
    right, bottom = np.minimum(left + 1, wide - 1), np.minimum(top + 1, high - 1)
    across, down = x - left, y - top
    upper = picture[top, left] * (1.0 - across) + picture[top, right] * across
    lower = picture[bottom, left] * (1.0 - across) + picture[bottom, right] * across
    values: Floats = upper * (1.0 - down) + lower * down
    return values


def _transforms(grey: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Fourier transforms of a reference minus its mean, and of the square of this difference."""
    around = grey - grey.mean()
    return np.fft.rfft2(around), np.fft.rfft2(around * around)


def _agreement(patch: _Patch, shape: tuple[int, ...], transforms: tuple[NDArray[np.complex128], ...]) -> Floats | None:
    """Correlation coefficients (h, w) of a patch at each offset in a reference; None if uniform or larger than it."""
    high, wide = shape[0] - patch.grey.shape[0] + 1, shape[1] - patch.grey.shape[1] + 1
    energy = float((patch.grey * patch.grey).sum())
    count = patch.mask.sum()
    if high < 1 or wide < 1 or energy <= _FLAT * max(float(count), 1.0):
        return None
    grey, mask = (np.conj(np.fft.rfft2(one, shape)) for one in (patch.grey, patch.mask))
    whole, squares = transforms

    def summed(product: NDArray[np.complex128]) -> Floats:
        return np.asarray(np.fft.irfft2(product, shape)[:high, :wide])

    sums = summed(whole * mask)
    spread = summed(squares * mask) - sums * sums / count
    # Where the reference is uniform, the quotient would consist of rounding errors.
    has_texture = spread > _FLAT * max(float(spread.max()), 1.0)
    return np.where(has_texture, summed(whole * grey) / np.sqrt(np.where(has_texture, spread, 1.0) * energy), -1.0)


def _peaks(coefficients: Floats, apart_px: int) -> list[tuple[int, int]]:
    """Rows and columns of the highest values, at least ``apart_px`` from each other along an axis."""
    left, found = coefficients.copy(), []
    # Three candidates for the refinement at full resolution.
    for _ in range(3):
        at = int(left.argmax())
        row, column = divmod(at, left.shape[1])
        if left[row, column] == -np.inf:
            break
        found.append((row, column))
        near = (
            slice(max(row - apart_px, 0), row + apart_px + 1),
            slice(max(column - apart_px, 0), column + apart_px + 1),
        )
        left[near] = -np.inf
    return found


def _maximum(coefficients: Floats) -> tuple[float, float]:
    """Row and column of the maximum, to a fraction of a pixel by parabolas through its neighbours."""
    row, column = divmod(int(coefficients.argmax()), coefficients.shape[1])
    down = _vertex(coefficients[max(row - 1, 0) : row + 2, column]) if 0 < row < len(coefficients) - 1 else 0.0
    inside = 0 < column < coefficients.shape[1] - 1
    across = _vertex(coefficients[row, max(column - 1, 0) : column + 2]) if inside else 0.0
    return row + down, column + across


def _vertex(three: Floats) -> float:
    before, here, after = three.tolist()
    bend = before - 2.0 * here + after
    return 0.0 if bend >= 0.0 else (before - after) / (2.0 * bend)
