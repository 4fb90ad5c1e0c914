"""Rays through the pixels of an image, of an ideal camera or of one whose lens distorts."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Floats, Numbers
from ..camera import Camera
from ..view import ImageRays
from .paths import Paths

#: Cameras and sizes whose pixels are kept: of red, green and blue, and one more.
_KEPT = 4
#: Points along each side of a distorted image that stand for the ground it sees, as its edges are bent.
_FINE = 33

#: A column or row beyond all images.
_FAR_PX = 1 << 40

#: Points of pixels as compiled code takes them; without any for an ideal camera.
Points = tuple[Floats, Floats]
_NO_POINTS = np.empty((0, 0)), np.empty((0, 0))


@dataclass(frozen=True, eq=False)
class PixelRays:
    """Rays of an ideal image: ``origin + x·per_x + y·per_y`` at x, y px from its upper left corner, y down."""

    origin: Floats
    per_x: Floats
    per_y: Floats
    width: int
    height: int

    @classmethod
    def of_image(cls, rays: ImageRays) -> PixelRays:
        """Rays of all pixels of an image."""
        camera, size = rays.scene.camera, rays.scene.one_size_px
        plain = PixelRays(rays.origin, rays.per_x, rays.per_y, *size)
        return DistortedRays.through_lens(plain, _seen_points(camera, *size)) if camera.distorts else plain

    @property
    def is_bent(self) -> bool:
        """Whether a lens moves the pixels from their places on the ideal image plane."""
        return False

    @property
    def ways(self) -> Floats:
        """Rays by constant, column and row of the ideal image plane, (3, 3)."""
        return np.stack([self.origin, self.per_x, self.per_y])

    @property
    def plane_px(self) -> tuple[int, int]:
        """Width and height of the part of the ideal image plane that the image may show."""
        return self.width, self.height

    @property
    def points(self) -> Points:
        """Points of the pixels as compiled code takes them; see `DistortedRays`."""
        return _NO_POINTS

    @property
    def grid(self) -> Points:
        """Points x, y of the ideal image plane that the pixels see, (height, width) each."""
        x, y = np.meshgrid(np.arange(self.width) + 0.5, np.arange(self.height) + 0.5)
        return x, y

    @property
    def index(self) -> PixelIndex:
        """Pixels by the places of their points."""
        return PixelIndex.build(*self.grid, self.plane_px)

    @property
    def top(self) -> int:
        """First row of the image in the image that `index` is of."""
        return 0

    @cached_property
    def pixel(self) -> float:
        """Least size of a pixel at a depth of 1."""
        return min(float(np.linalg.norm(per)) for per in (self.per_x, self.per_y))

    def directions(self, x_px: Floats, y_px: Floats) -> Floats:
        """Rays (n, 3) of points (n,) of the ideal image plane."""
        parts = [o + x_px * per_x + y_px * per_y for o, per_x, per_y in zip(self.origin, self.per_x, self.per_y)]
        rays: Floats = np.stack(parts).T
        return rays

    def through(self, row: Numbers, column: Numbers) -> Floats:
        """Rays (n, 3) through the centres of pixels (n,)."""
        return self.directions(*self.centres(row, column))

    def centres(self, row: Numbers, column: Numbers) -> tuple[Floats, Floats]:
        """Points x, y of the ideal image plane that the centres of pixels (n,) see."""
        return column + 0.5, row + 0.5

    def components(self) -> tuple[Floats, ...]:
        """East, north and up of the rays through all pixels, (height, width) each."""
        x, y = np.arange(self.width) + 0.5, np.arange(self.height) + 0.5
        return tuple(
            origin + x * per_x + y[:, np.newaxis] * per_y
            for origin, per_x, per_y in zip(self.origin, self.per_x, self.per_y)
        )

    def changes(
        self,
        row: Numbers,  # noqa: ARG002  (all pixels of an ideal image are alike)
        column: Numbers,  # noqa: ARG002
        per_x: Floats,
        per_y: Floats,
    ) -> tuple[Floats, Floats]:
        """Change of a value from pixels (n,) to the next along rows, and down columns.

        The value is linear on the ideal image plane: ``per_x, per_y`` are its changes there.
        """
        return per_x, per_y

    def spread(self, count: int) -> Floats:
        """Rays (count², 3) spread evenly over the image and its edges, row by row."""
        x, y = np.meshgrid(*(np.linspace(0.0, side, count) for side in (self.width, self.height)))
        return self.directions(x.ravel(), y.ravel())

    def outlook(self) -> Floats:
        """Rays (n, 3) all over the image, close enough to find the ground that it may show."""
        return self.spread(9)

    def rows(self, top: int, bottom: int) -> PixelRays:
        """Rays of some rows of pixels, as an image."""
        return replace(self, origin=self.origin + top * self.per_y, height=bottom - top)

    def forms(self, paths: Paths) -> list[Floats]:
        """Coefficients of paths as polynomials in x and y: for tᵏ an array (c, k + 1, k + 1), by powers of y and x."""
        found = []
        for degree in range(1, paths.degree + 1):
            x, y = (np.linspace(0.0, side, degree + 1) for side in self.plane_px)
            across, down = np.meshgrid(x, y)
            values = paths.coefficients(self.directions(across.ravel(), down.ravel()))[degree - 1]
            grid = values.reshape(-1, degree + 1, degree + 1)
            inverse_x, inverse_y = (_inverse_powers(side, degree) for side in self.plane_px)
            found.append(inverse_y @ grid @ inverse_x.T)
        return found

    def coefficients(self, forms: list[Floats], top: int, bottom: int) -> Floats:
        """Coefficients (degree, c, rows, width) of the paths of rows of pixels."""
        return on_grid(forms, np.arange(self.width) + 0.5, np.arange(top, bottom) + 0.5)

    def bundles(self, forms: list[Floats], side_px: int) -> tuple[Floats, Floats]:
        """Middle rays of square bundles of pixels, and the largest differences of others from them.

        Both are coefficients (degree, c, rows, columns) of paths.
        """
        x, y = (_edges(length, side_px) for length in (self.width, self.height))
        middle = on_grid(forms, (x[:-1] + x[1:]) / 2.0, (y[:-1] + y[1:]) / 2.0)
        corners = on_grid(forms, x, y)
        around = corners[..., :-1, :-1], corners[..., :-1, 1:], corners[..., 1:, :-1], corners[..., 1:, 1:]
        return middle, np.max([np.abs(corner - middle) for corner in around], axis=0)

    def middles(self, forms: list[Floats], top: int, bottom: int, side_px: int) -> tuple[Floats, Floats, Floats]:
        """Coefficients (degree, c, n) of rays amid bundles of rows of pixels, and offsets x, y of the pixels from them.

        Offsets, on the ideal image plane, broadcast to (rows, width).
        """
        px = np.arange(self.width) + 0.5, np.arange(top, bottom) + 0.5
        middles = [np.minimum(at[::side_px] + (side_px - 1) / 2.0, at[-1]) for at in px]
        off_x, off_y = (at - middle.repeat(side_px)[: len(at)] for at, middle in zip(px, middles))
        return on_grid(forms, *middles).reshape(len(forms), 3, -1), off_x, off_y[:, np.newaxis]


@dataclass(frozen=True, eq=False)
class SeenPoints:
    """Points of the ideal image plane that pixels of a distorted image see, with the pixels around the image.

    Attributes
    ----------
    x, y : array (height + 2, width + 2)
        In px of the ideal image, from the upper left corner of the box around what the image shows. Those around the
        image are extrapolated, so that the mean with their neighbours is the image's edge.
    corner_px : tuple of int
        The box's upper left corner, from that of the ideal image.
    plane_px : tuple of int
        Its width and height.
    least_step : float
        Least distance of points, for pixels one apart in any direction.
    """

    x: Floats
    y: Floats
    corner_px: tuple[int, int]
    plane_px: tuple[int, int]
    least_step: float

    @classmethod
    def build(cls, ideal_px: Callable[[Floats, Floats], tuple[Floats, Floats]], width: int, height: int) -> SeenPoints:
        """Points of the pixels of an image by the function from its points to those of the ideal image."""
        image = np.meshgrid(*(np.concatenate([[0.0], np.arange(n) + 0.5, [n]]) for n in (width, height)))
        x, y = ideal_px(*image)
        low_x, low_y = math.floor(x.min()), math.floor(y.min())
        plane_px = math.ceil(x.max()) - low_x, math.ceil(y.max()) - low_y
        x, y = x - low_x, y - low_y
        for at in (x, y):
            for outer, inner in ((0, 1), (-1, -2)):
                at[outer] = 2.0 * at[outer] - at[inner]
                at[:, outer] = 2.0 * at[:, outer] - at[:, inner]
        return cls(x, y, (low_x, low_y), plane_px, _least_step(x, y))

    @cached_property
    def index(self) -> PixelIndex:
        """Pixels by the places of their points."""
        return PixelIndex.build(self.x[1:-1, 1:-1], self.y[1:-1, 1:-1], self.plane_px)


@dataclass(frozen=True, eq=False)
class DistortedRays(PixelRays):
    """Rays of an image that a lens distorts: x and y count on the ideal image plane, from a corner of what is seen."""

    seen: SeenPoints
    top: int = 0

    @classmethod
    def through_lens(cls, ideal: PixelRays, seen: SeenPoints) -> DistortedRays:
        """Rays of an ideal image, seen at other points of it."""
        left, top = seen.corner_px
        origin = ideal.origin + left * ideal.per_x + top * ideal.per_y
        return cls(origin, ideal.per_x, ideal.per_y, ideal.width, ideal.height, seen)

    @property
    def is_bent(self) -> bool:
        """See `PixelRays`."""
        return True

    @property
    def plane_px(self) -> tuple[int, int]:
        """See `PixelRays`."""
        return self.seen.plane_px

    @property
    def points(self) -> Points:
        """See `PixelRays`."""
        rows = slice(self.top, self.top + self.height + 2)
        return self.seen.x[rows], self.seen.y[rows]

    @property
    def index(self) -> PixelIndex:
        """See `PixelRays`."""
        return self.seen.index

    @property
    def grid(self) -> Points:
        """See `PixelRays`."""
        x, y = self.points
        return x[1:-1, 1:-1], y[1:-1, 1:-1]

    @cached_property
    def pixel(self) -> float:
        """See `PixelRays`."""
        return self.seen.least_step * min(float(np.linalg.norm(per)) for per in (self.per_x, self.per_y))

    def centres(self, row: Numbers, column: Numbers) -> tuple[Floats, Floats]:
        """See `PixelRays`."""
        x, y = self.grid
        return x[row, column], y[row, column]

    def components(self) -> tuple[Floats, ...]:
        """See `PixelRays`."""
        x, y = self.grid
        return tuple(
            origin + x * per_x + y * per_y for origin, per_x, per_y in zip(self.origin, self.per_x, self.per_y)
        )

    def changes(self, row: Numbers, column: Numbers, per_x: Floats, per_y: Floats) -> tuple[Floats, Floats]:
        """See `PixelRays`."""
        (x, y), i, j = self.points, row + 1, column + 1
        along, down = (
            (x[after] - x[before]) / 2.0 * per_x + (y[after] - y[before]) / 2.0 * per_y
            for after, before in (((i, j + 1), (i, j - 1)), ((i + 1, j), (i - 1, j)))
        )
        return along, down

    def spread(self, count: int) -> Floats:
        """See `PixelRays`."""
        # Between pixels, linear: they stand for many others.
        found = []
        for at in self.points:
            for axis in (0, 1):
                place = np.linspace(0.5, at.shape[axis] - 1.5, count)
                before = np.minimum(place.astype(np.int64), at.shape[axis] - 2)
                share = (place - before)[(slice(None), np.newaxis) if axis == 0 else slice(None)]
                at = (1.0 - share) * at.take(before, axis) + share * at.take(before + 1, axis)  # noqa: PLW2901
            found.append(at.ravel())
        return self.directions(*found)

    def outlook(self) -> Floats:
        """See `PixelRays`."""
        return self.spread(_FINE)

    def rows(self, top: int, bottom: int) -> DistortedRays:
        """See `PixelRays`."""
        return replace(self, height=bottom - top, top=self.top + top)

    def coefficients(self, forms: list[Floats], top: int, bottom: int) -> Floats:
        """See `PixelRays`."""
        x, y = self.grid
        return at_points(forms, x[top:bottom], y[top:bottom])

    def bundles(self, forms: list[Floats], side_px: int) -> tuple[Floats, Floats]:
        """See `PixelRays`."""
        boxes = [end_of_bundles(at, side_px, end) for at in self.grid for end in (np.minimum, np.maximum)]
        left, right, top, bottom = boxes
        middle = at_points(forms, (left + right) / 2.0, (top + bottom) / 2.0)
        corners = (at_points(forms, x, y) for x in (left, right) for y in (top, bottom))
        return middle, np.max([np.abs(corner - middle) for corner in corners], axis=0)

    def middles(self, forms: list[Floats], top: int, bottom: int, side_px: int) -> tuple[Floats, Floats, Floats]:
        """See `PixelRays`."""
        offsets, middles = [], []
        for at in self.grid:
            part = at[top:bottom]
            row, column = (np.minimum(np.arange(0, n, side_px) + side_px // 2, n - 1) for n in part.shape)
            middle = part[np.ix_(row, column)]
            middles.append(middle)
            offsets.append(part - finer(middle, part.shape, side_px))
        return at_points(forms, *middles).reshape(len(forms), 3, -1), offsets[0], offsets[1]


class PixelIndex(NamedTuple):
    """Boxes around the pixels whose points lie in cells of the ideal image plane, of ``cell_px``, twice as much, ….

    ``ends`` (4, n) are first columns, the ones after the last, first rows and the ones after the last, of all levels
    one after the other; level i begins at ``first[i]`` and has ``high[i]`` rows of ``wide[i]`` cells. A level of one
    cell is the last.
    """

    ends: Numbers
    first: Numbers
    high: Numbers
    wide: Numbers
    cell_px: int

    @classmethod
    def build(cls, x: Floats, y: Floats, plane_px: tuple[int, int]) -> PixelIndex:
        """Index of points (height, width) within an ideal image plane."""
        # About as many cells as pixels.
        cell_px = max(2, math.ceil(math.sqrt(plane_px[0] * plane_px[1] / x.size)))
        wide, high = (side // cell_px + 1 for side in plane_px)
        cell = (y / cell_px).astype(np.int64) * wide + (x / cell_px).astype(np.int64)
        order = np.argsort(cell, axis=None)
        place = np.unravel_index(order, x.shape)
        cells, begins = np.unique(cell.ravel()[order], return_index=True)
        ends = np.stack([np.full(high * wide, end) for end in (_FAR_PX, 0, _FAR_PX, 0)])
        for axis, at in enumerate(place[::-1]):
            ends[2 * axis, cells] = np.minimum.reduceat(at, begins)
            ends[2 * axis + 1, cells] = np.maximum.reduceat(at, begins) + 1
        levels = [ends.reshape(4, high, wide)]
        while levels[-1][0].size > 1:
            kinds = np.minimum, np.maximum, np.minimum, np.maximum
            levels.append(np.stack([end_of_bundles(at, 2, kind) for at, kind in zip(levels[-1], kinds)]))
        sizes = np.array([level.shape[1:] for level in levels], np.int64)
        flat = np.concatenate([level.reshape(4, -1) for level in levels], axis=1)
        counts = sizes.prod(axis=1)
        return cls(flat, np.cumsum(counts) - counts, sizes[:, 0].copy(), sizes[:, 1].copy(), cell_px)


def _least_step(x: Floats, y: Floats) -> float:
    """Least singular value of the derivatives of points by columns and rows."""
    a, b, c, d = (
        (after - before) / 2.0
        for at in (x, y)
        for after, before in ((at[1:-1, 2:], at[1:-1, :-2]), (at[2:, 1:-1], at[:-2, 1:-1]))
    )
    squares, area = a * a + b * b + c * c + d * d, a * d - b * c
    least = (squares - np.sqrt(np.maximum(squares * squares - 4.0 * area * area, 0.0))) / 2.0
    return math.sqrt(max(float(least.min()), 0.0))


@lru_cache(maxsize=_KEPT)
def _seen_points(camera: Camera, width: int, height: int) -> SeenPoints:
    """Points that the pixels of a camera's images see."""

    def ideal_px(x_px: Floats, y_px: Floats) -> tuple[Floats, Floats]:
        ideal = camera.ideal_xy(np.stack([2.0 * x_px / width - 1.0, 1.0 - 2.0 * y_px / height], axis=-1))
        return (ideal[..., 0] + 1.0) * (width / 2.0), (1.0 - ideal[..., 1]) * (height / 2.0)

    return SeenPoints.build(ideal_px, width, height)


@lru_cache(maxsize=256)
def _inverse_powers(side: int, degree: int) -> Floats:
    """Matrix that makes polynomials from their values at ``degree + 1`` points from 0 to a side."""
    inverse: Floats = np.linalg.inv(np.vander(np.linspace(0.0, side, degree + 1), increasing=True))
    return inverse


def on_grid(forms: list[Floats], x_px: Floats, y_px: Floats) -> Floats:
    """Coefficients (degree, c, rows, columns) at all x and y, from `PixelRays.forms`."""
    return np.stack(
        [
            np.vander(y_px, len(form[0]), increasing=True) @ form @ np.vander(x_px, len(form[0]), increasing=True).T
            for form in forms
        ]
    )


def at_points(forms: list[Floats], x_px: Floats, y_px: Floats) -> Floats:
    """Coefficients (degree, c, rows, columns) at points (rows, columns), from `PixelRays.forms`."""
    found = np.empty((len(forms), len(forms[0]), *x_px.shape))
    for power, form in enumerate(forms):
        for axis, terms in enumerate(form):
            # Terms above the form's degree are zero.
            total: Any = 0.0
            for k in range(power + 1, -1, -1):
                part: Any = 0.0
                for m in range(power + 1 - k, -1, -1):
                    part = part * y_px + terms[m, k]
                total = total * x_px + part
            found[power, axis] = total
    return found


def _edges(length: int, side: int) -> Floats:
    """Edges of bundles along an image's side; the last bundle is cut off."""
    return np.append(np.arange(0, length, side), length).astype(np.float64)


def finer(values: Floats, shape: tuple[int, ...], step: int) -> Floats:
    """Repeat the values of larger bundles for the smaller bundles in them."""
    return values.repeat(step, axis=0).repeat(step, axis=1)[: shape[0], : shape[1]]


def end_of_bundles(values: Floats, side: int, end: Any = np.minimum) -> Floats:
    """Least value in each bundle of pixels, or greatest by another ``end``."""
    rows, columns = (np.arange(0, length, side) for length in values.shape)
    found: Floats = end.reduceat(end.reduceat(values, rows, axis=0), columns, axis=1)
    return found
