"""Bayer patterns of colour filters: one colour per pixel, and the other two from its neighbours."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import NDArray, Scalar

Singles = NDArray[np.float32]
#: Orders of the colours of the upper left pixels: two of the first row, two of the second.
PATTERNS = ("rggb", "bggr", "grbg", "gbrg")
#: Interpolation from the nearest pixels of a colour.
BILINEAR = "bilinear"
#: Interpolation corrected by the gradients of the pixel's own colour, after Malvar, He and Cutler (2004).
MALVAR = "malvar"
_NEXT = ((-1, 0), (1, 0), (0, -1), (0, 1))
_CORNERS = ((-1, -1), (-1, 1), (1, -1), (1, 1))
#: Rows and columns repeated beyond the edges of an image.
_MARGIN = 2


def mosaic(planes: NDArray[Scalar], pattern: str) -> NDArray[Scalar]:
    """The colour (h, w) that each pixel of an image (h, w, 3) in red, green and blue measures."""
    measured: NDArray[Scalar] = np.empty(planes.shape[:2], planes.dtype)
    for band, row, column in _sites(pattern):
        measured[row::2, column::2] = planes[row::2, column::2, band]
    return measured


def demosaiced(measured: Singles, pattern: str, method: str) -> Singles:
    """Red, green and blue (h, w, 3) of an image (h, w) of one colour per pixel.

    Parameters
    ----------
    method : str
        `BILINEAR` or `MALVAR`. Edges are mirrored at their pixels' centres, which keeps the pattern.
    """
    height, width = measured.shape
    planes = np.empty((height, width, 3), np.float32)
    around = np.pad(measured, _MARGIN, mode="reflect")
    # Pixels of one colour side by side, which processors add several at a time.
    parts = [[np.ascontiguousarray(around[row::2, column::2]) for column in (0, 1)] for row in (0, 1)]
    for band, row, column in _sites(pattern):
        here = _Neighbours(parts, row, column, height, width)
        at = slice(row, None, 2), slice(column, None, 2)
        planes[(*at, band)] = here.own
        if band == 1:
            # Red is beside green pixels of its own rows, and above and below those of the others.
            red_row = pattern[2 * row : 2 * row + 2].count("r")
            beside, above = (0, 2) if red_row else (2, 0)
            planes[(*at, beside)], planes[(*at, above)] = here.beside(method), here.above(method)
        else:
            planes[(*at, 1)], planes[(*at, 2 - band)] = here.cross(method), here.corners(method)
    return planes


def _sites(pattern: str) -> Iterator[tuple[int, int, int]]:
    """Band, row and column of each pixel of a pattern."""
    for at, colour in enumerate(pattern):
        yield "rgb".index(colour), at // 2, at % 2


class _Neighbours:
    """Every second pixel of every second row, and what stands around it."""

    def __init__(self, parts: list[list[Singles]], row: int, column: int, height: int, width: int) -> None:
        self._parts = parts
        self._row, self._column = row + _MARGIN, column + _MARGIN
        self._rows, self._columns = (height - row + 1) // 2, (width - column + 1) // 2
        self.own = self._at(0, 0)

    def _at(self, down: int, right: int) -> Singles:
        row, column = self._row + down, self._column + right
        part = self._parts[row % 2][column % 2]
        return part[row // 2 : row // 2 + self._rows, column // 2 : column // 2 + self._columns]

    def _sum(self, *steps: tuple[int, int]) -> Singles:
        first, *others = (self._at(*step) for step in steps)
        total: Singles = first.copy()
        for one in others:
            total += one
        return total

    def cross(self, method: str) -> Singles:
        """Green of a red or blue pixel."""
        near = self._sum(*_NEXT)
        if method == BILINEAR:
            return near * np.float32(0.25)
        far = self._sum((-2, 0), (2, 0), (0, -2), (0, 2))
        return (4 * self.own + 2 * near - far) * np.float32(0.125)

    def corners(self, method: str) -> Singles:
        """Red of a blue pixel, or blue of a red one."""
        near = self._sum(*_CORNERS)
        if method == BILINEAR:
            return near * np.float32(0.25)
        far = self._sum((-2, 0), (2, 0), (0, -2), (0, 2))
        found: Singles = (6 * self.own + 2 * near - np.float32(1.5) * far) * np.float32(0.125)
        return found

    def beside(self, method: str) -> Singles:
        """Colour of the pixels to the left and right of a green one."""
        return self._in_line(method, ((0, -1), (0, 1)), ((0, -2), (0, 2)), ((-2, 0), (2, 0)))

    def above(self, method: str) -> Singles:
        """Colour of the pixels above and below a green one."""
        return self._in_line(method, ((-1, 0), (1, 0)), ((-2, 0), (2, 0)), ((0, -2), (0, 2)))

    def _in_line(self, method: str, *steps: tuple[tuple[int, int], ...]) -> Singles:
        near = self._sum(*steps[0])
        if method == BILINEAR:
            return near * np.float32(0.5)
        along = self._sum(*steps[1], *_CORNERS)
        across = self._sum(*steps[2])
        return (5 * self.own + 4 * near - along + np.float32(0.5) * across) * np.float32(0.125)
