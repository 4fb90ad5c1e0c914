"""Normalised cross-correlation: a baseline without weights, for queries of known height and attitude.

A query is projected onto the ground by its height and attitude and correlated with the reference at every place. The
coefficients are computed by Fourier transforms (Lewis, *Fast normalized cross-correlation*, 1995), with a mask because
a tilted image is not a rectangle on the ground (Padfield, *Masked object registration in the Fourier domain*, IEEE TIP
2012).

Sums of the reference's pixels below a mask are whole numbers and are rounded to these; only products with the query are
inexact, by about ε log₂(pixels) times the norms of reference and query. In a reference of a million pixels, a
coefficient is within 1e-9 of one that is summed pixel by pixel, even where all pixels but one are equal.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from PIL import Image

from ..arrays import Bytes, Flags, Floats, NDArray, Numbers
from ..dataset.dataset import open_image
from ..geodesy.camera import CORNERS, Camera, Poses
from ..geodesy.ellipsoid import WGS84, sight_lines
from ..geodesy.footprint import exact
from ..geodesy.interpolation import Interpolation
from .answers import Answer, Locate, Query
from .folder import Benchmark, ReferenceMosaic

#: A query whose mean squared difference from its mean is below this counts as uniform: interpolation is rounded.
_FLAT = 1e-9
#: Pixels in which a mask may differ to have its sums adapted: each costs a tenth of a transform.
_CHANGED = 16

Spectrum = NDArray[np.complex128]


class _Patch(NamedTuple):
    """Pixels of the reference around a query's ground, seen by its camera.

    Attributes
    ----------
    points : array (h, w, 2)
        Positions in the image, as fractions of its width and height from the upper left corner.
    mask : array (h, w) of bool
        Whether the query shows the pixel.
    left, top : int
        Upper left corner in the reference, px, at the assumed position.
    camera, centre : (column, row)
        Positions of the camera and of the ground at the image centre, px from the view's upper left corner.
    """

    points: Floats
    mask: Flags
    left: int
    top: int
    camera: tuple[float, float]
    centre: tuple[float, float]


class _Energy:
    """Sums below a mask at each offset in a reference, for the coefficients of all queries with this mask."""

    def __init__(self, mask: Flags, sums: Floats, squares: Floats) -> None:
        self.mask, self.sums, self.squares = mask, sums, squares
        spread = squares - sums * sums / np.count_nonzero(mask)
        # The spread of n whole numbers that differ is at least 1 - 1/n.
        self.uniform = spread < 0.25
        spread[self.uniform] = 1.0
        #: 1 / √(sum of squared differences from the mean), where the reference is not uniform.
        self.scale = 1.0 / np.sqrt(spread)

    def adapted(self, mask: Flags, reference: _Reference, changed: Numbers) -> _Energy:
        """Energies below a mask that differs in the pixels ``changed``, (n, 2)."""
        sums, squares = self.sums.copy(), self.squares.copy()
        high, wide = sums.shape
        for row, column in changed.tolist():
            below = slice(row, row + high), slice(column, column + wide)
            change = np.add if mask[row, column] else np.subtract
            change(sums, reference.values[below], out=sums)
            change(squares, reference.squares[below], out=squares)
        return _Energy(mask, sums, squares)


class _Reference:
    """A reference prepared for correlation.

    Attributes
    ----------
    values : array (h, w)
        Grey values less their rounded mean, whole numbers.
    squares : array (h, w)
        Their squares.
    padded : (height, width)
        Size of the transforms, px.
    """

    def __init__(self, grey: Bytes) -> None:
        self.values: Floats = grey - np.rint(grey.mean())
        self.padded = _transform_length(grey.shape[0]), _transform_length(grey.shape[1])
        self.squares: Floats = self.values**2
        self._energies: list[_Energy] = []
        self._spectra = [np.fft.rfft2(one, self.padded) for one in (self.values, self.squares)]

    def offsets(self, shape: tuple[int, ...]) -> tuple[int, int]:
        """Numbers of rows and columns at which a template fits in; 0 or less for a larger one."""
        return self.values.shape[0] - shape[0] + 1, self.values.shape[1] - shape[1] + 1

    def products(self, template: Floats) -> Floats:
        """Sums of products with a template at each offset."""
        return self._correlate(self._spectra[0], np.conj(np.fft.rfft2(template, self.padded)), template.shape)

    def energy(self, mask: Flags) -> _Energy:
        """Energies below a mask; those of a similar mask, if known, are adapted."""
        found = None
        for known in self._energies:
            if known.mask.shape == mask.shape:
                changed = np.argwhere(known.mask != mask)
                if len(changed) <= _CHANGED:
                    found = known.adapted(mask, self, changed)
                    self._energies.remove(known)
                    break
        if found is None:
            found = _Energy(mask, *self._sums(mask))
        # Flights along rows have two attitudes, which alternate.
        self._energies = [found, *self._energies[:1]]
        return found

    def _sums(self, mask: Flags) -> tuple[Floats, Floats]:
        """Sums of values and of squared values below a mask at each offset, both exact."""
        mask_spectrum = np.conj(np.fft.rfft2(mask, self.padded))
        whole, squares = (np.rint(self._correlate(one, mask_spectrum, mask.shape)) for one in self._spectra)
        return whole, squares

    def _correlate(self, one: Spectrum, other: Spectrum, shape: tuple[int, ...]) -> Floats:
        high, wide = self.offsets(shape)
        # Rows beyond the last offset are left untransformed.
        found: Floats = np.fft.irfft(np.fft.ifft(one * other, axis=0)[:high], self.padded[1])[:, :wide]
        return found


def correlation(benchmark: Benchmark, gallery: Numbers) -> Locate:
    """Prepare to localise queries in the mosaic of a benchmark; a `Method`."""
    return _Correlation(benchmark, gallery).locate


class _Correlation:
    def __init__(self, benchmark: Benchmark, gallery: Numbers) -> None:
        self._mosaic = benchmark.mosaic
        self._whole = benchmark.grey(benchmark.mosaic.file)
        # A larger reference is reduced before it is searched whole, which bounds time and memory.
        self._step = max(math.ceil(math.sqrt(self._whole.size / 1_000_000)), 1)
        self._searched = _Reference(np.asarray(Image.fromarray(self._whole).reduce(self._step)))
        tiles = benchmark.references
        column, row = benchmark.mosaic.px(tiles.lat_deg[gallery], tiles.lon_deg[gallery])
        width = (tiles.east - tiles.west)[gallery] / benchmark.mosaic.pixel_width
        self._tiles = np.stack([column, row, width]) / self._step
        self._ids = [tiles.id[at] for at in gallery.tolist()]

    def locate(self, query: Query) -> Answer:
        """Localise a query; the answer is empty if the query shows more ground than the reference, or is uniform."""
        sight = _Sight(query.camera, query.height_m, query.ground_m, query.yaw_deg, query.tilt_deg, query.roll_deg)
        middle = self._lat_lon(self._mosaic.width_px / 2.0, self._mosaic.height_px / 2.0)
        coarse = sight.view(*middle, self._mosaic, self._step)
        if coarse is None:
            return Answer()
        picture = open_image(query.image, as_shown=True).convert("L")
        coefficients = _agreement(_template(picture, coarse), coarse.mask, self._searched)
        if coefficients is None:
            return Answer()
        lat, lon = self._lat_lon(*self._refine(sight, picture, coarse, coefficients))
        return Answer(self._rank_tiles(coarse, coefficients), lat, lon)

    def _lat_lon(self, column: float, row: float) -> tuple[float, float]:
        """Latitude and longitude of a position in the mosaic."""
        lat, lon = self._mosaic.ground(np.array(column), np.array(row))
        return float(lat), float(lon)

    def _refine(self, sight: _Sight, picture: Image.Image, coarse: _Patch, coefficients: Floats) -> tuple[float, float]:
        """Refine the best candidates at full resolution; returns column and row of the camera in the mosaic."""
        step = self._step
        best, found = -math.inf, (math.nan, math.nan)
        for top, left in _peaks(coefficients, min(coarse.mask.shape) // 2):
            lat, lon = self._lat_lon((left + coarse.camera[0]) * step, (top + coarse.camera[1]) * step)
            # Project again: the ground that a map's pixel shows depends on the latitude.
            view = sight.view(lat, lon, self._mosaic, 1)
            if view is None:
                continue
            # Three reduced pixels around the candidate: two for its error and one for rounding.
            reach = 3 * step
            high, wide = view.mask.shape
            y, x = max(view.top - reach, 0), max(view.left - reach, 0)
            window = self._whole[y : view.top + high + reach, x : view.left + wide + reach]
            if window.shape[0] < high or window.shape[1] < wide:
                continue
            near = _agreement(_template(picture, view), view.mask, _Reference(window))
            if near is not None and near.max() > best:
                best = float(near.max())
                down, across = _maximum(near)
                found = x + across + view.camera[0], y + down + view.camera[1]
        return found

    def _rank_tiles(self, view: _Patch, coefficients: Floats) -> list[str]:
        """Rank tiles by the highest coefficient of positions that put the query's centre in the tile's middle half."""
        high, wide = coefficients.shape
        column, row, width = self._tiles
        left, right = (
            np.clip(np.floor(column + side * width / 4.0 - view.centre[0]), 0, wide - 1).astype(int)
            for side in (-1.0, 1.0)
        )
        top, bottom = (
            np.clip(np.floor(row + side * width / 4.0 - view.centre[1]), 0, high - 1).astype(int)
            for side in (-1.0, 1.0)
        )
        score = np.array(
            [
                coefficients[t : b + 1, le : r + 1].max()
                for le, r, t, b in zip(left.tolist(), right.tolist(), top.tolist(), bottom.tolist())
            ]
        )
        return [self._ids[at] for at in np.argsort(-score, kind="stable")[:100].tolist()]


class _Sight(NamedTuple):
    """Camera, heights and attitude of a query, as in `Query`."""

    camera: Camera
    height_m: float
    ground_m: float
    yaw_deg: float
    tilt_deg: float
    roll_deg: float

    def view(self, lat_deg: float, lon_deg: float, mosaic: ReferenceMosaic, step: int) -> _Patch | None:
        """View from an assumed position; None if it is tiny or larger than the reference."""
        attitude = self.yaw_deg, self.tilt_deg, self.roll_deg
        agl = self.height_m - self.ground_m
        ground = WGS84.raised(self.ground_m)
        pose = Poses.from_attitude(np.array([lat_deg]), np.array([lon_deg]), np.array([agl]), *attitude)
        seen = exact(self.camera, pose, (*CORNERS, (0.0, 0.0)), ground)
        columns, rows = (px[0] / step for px in mosaic.px(seen.lat_deg, seen.lon_deg))
        left, top = math.floor(columns[:4].min()), math.floor(rows[:4].min())
        wide, high = math.ceil(columns[:4].max()) - left, math.ceil(rows[:4].max()) - top
        # Smaller views match anywhere.
        if min(wide, high) < 4 or wide > mosaic.width_px / step or high > mosaic.height_px / step:
            return None
        # Lines of sight to the ground are smooth along the map, unlike what an image shows of them.
        columns_of, rows_of = Interpolation.along(wide, 8), Interpolation.along(high, 8)
        across, down = np.meshgrid(left + columns_of.nodes, top + rows_of.nodes)
        lat, lon = mosaic.ground(across * float(step), down * float(step))
        dlon = lon - lon_deg
        nodes = sight_lines(np.array(lat_deg), np.array(agl), lat, dlon - 360.0 * np.rint(dlon / 360.0), ground)
        lines = np.stack([rows_of.weights @ part @ columns_of.weights.T for part in np.moveaxis(nodes, -1, 0)], axis=-1)
        points, in_front = self.camera.image_xy(lines, *attitude)
        mask = in_front & (np.abs(points) < 1.0).all(axis=-1)
        camera_at = mosaic.px(np.array(lat_deg), np.array(lon_deg))
        camera = float(camera_at[0]) / step - left, float(camera_at[1]) / step - top
        centre = float(columns[4]) - left, float(rows[4]) - top
        return _Patch((points * (1.0, -1.0) + 1.0) / 2.0, mask, left, top, camera, centre)


def _template(picture: Image.Image, view: _Patch) -> Floats:
    """Grey values (h, w) of a query in a view, minus their mean; 0 where it shows nothing."""
    values = _reduced(picture, int(view.mask.sum()))
    x, y = view.points[..., 0] * values.shape[1], view.points[..., 1] * values.shape[0]
    grey = np.where(view.mask, _bilinear(values, x, y), 0.0)
    centred: Floats = (grey - grey.sum() / max(np.count_nonzero(view.mask), 1)) * view.mask
    return centred


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


def _transform_length(length: int) -> int:
    """Smallest length of at least ``length`` with no prime factors but 2, 3 and 5, which are transformed fast."""
    while True:
        rest = length
        for factor in (2, 3, 5):
            while rest % factor == 0:
                rest //= factor
        if rest == 1:
            return length
        length += 1


def _agreement(template: Floats, mask: Flags, reference: _Reference) -> Floats | None:
    """Correlation coefficients (h, w) of a template at each offset in a reference; -1 where the reference is uniform.

    None if the template is uniform or larger than the reference.
    """
    own = float((template * template).sum())
    if min(reference.offsets(mask.shape)) < 1 or own <= _FLAT * max(np.count_nonzero(mask), 1):
        return None
    energy = reference.energy(mask)
    coefficients = reference.products(template / math.sqrt(own)) * energy.scale
    coefficients[energy.uniform] = -1.0
    return coefficients


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
