"""Heights of the surface with the roofs of buildings on it: to keep flights clear of, and to see from above."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Floats, Numbers, expand_counts
from ...geodesy.ellipsoid import positions
from ...geodesy.local import enu_axes, geocentric
from ...geodesy.raytracing.surface import Surface
from ...geodesy.triangles import NO_FACES, WALL, FaceModel, Triangles
from .ground import Heights
from .path_ground import cell_size_m

if TYPE_CHECKING:
    from ...geodesy.raytracing.tracing import ElevationModel

#: Cells by which roofs are wider on the grid, so that no bilinear surface cuts their edges off.
_WIDER = 1.0
#: Greatest size of cells that hold roofs, metres, but where there would be too many: to plan with, and to look at.
_PLANNED_CELL_M, _SEEN_CELL_M = 2.0, 0.5
_MOST_CELLS = 1 << 22
#: Buildings narrower and lower than half a cell, or than this, metres, are left out: coarse heights are off by as much.
_SMALL_M = 5.0
#: Pixels in boxes around triangles that are looked at together.
_BATCH = 1 << 20


@dataclass(frozen=True, eq=False)
class RoofedElevation:
    """Heights of an elevation model, raised to the tops of faces: an `ElevationModel`.

    Pictures meet the faces themselves instead, see `Heights`.

    Parameters
    ----------
    elevation : ElevationModel
    faces : FaceModel
    is_planned : bool
        Whether each triangle counts as level at its highest corner, and as a cell wider than it is, to plan with.
    """

    elevation: ElevationModel
    faces: FaceModel
    is_planned: bool = True

    @property
    def title(self) -> str:
        """Name of the elevation."""
        return self.elevation.title

    @property
    def attribution(self) -> str:
        """Credit for the elevation."""
        return self.elevation.attribution

    def surface(self, lat_deg: Floats, lon_deg: Floats, cell_m: float = 0.0) -> Surface:
        """Heights over the bounding box of positions."""
        surface = self.elevation.surface(lat_deg, lon_deg, cell_m)
        factor = _refinement(surface, max(cell_m, _PLANNED_CELL_M if self.is_planned else _SEEN_CELL_M))
        least_m = min(cell_size_m(surface) / factor / 2.0, _SMALL_M)
        triangles = self.faces.triangles(lat_deg, lon_deg, least_m)
        triangles = triangles.take(triangles.kind != WALL)
        if not len(triangles):
            return surface
        wider = _WIDER if self.is_planned else 0.0
        return _raised(_finer(surface, factor), triangles, (float(np.mean(lat_deg)), float(np.mean(lon_deg))), wider)

    def cell_m(self, lat_deg: float, lon_deg: float) -> float:
        """Size in metres of the elevation's finest cells at a place."""
        return self.elevation.cell_m(lat_deg, lon_deg)

    def end_m(self, lat_deg: float, lon_deg: float) -> float:
        """Level distance from a place beyond which there is no ground, metres."""
        return self.elevation.end_m(lat_deg, lon_deg)


def planned_surface(heights: Heights) -> ElevationModel:
    """Return the surface that a flight keeps clear of: that of a mission, with the roofs of its buildings."""
    return heights.surface if heights.faces is NO_FACES else RoofedElevation(heights.surface, heights.faces)


def seen_surface(heights: Heights) -> ElevationModel:
    """Return the surface that shows from above: that of a mission, with the roofs of its buildings."""
    return heights.surface if heights.faces is NO_FACES else RoofedElevation(heights.surface, heights.faces, False)


def _refinement(surface: Surface, wanted_m: float) -> int:
    """Factor by which cells are to be smaller for roofs, as level ground and far relief have large ones."""
    size_m = cell_size_m(surface)
    rows, columns = surface.cells
    factor = 1
    while size_m > wanted_m * factor * 1.5 and rows * columns * (2 * factor) ** 2 <= _MOST_CELLS:
        factor *= 2
    return factor


def _finer(surface: Surface, factor: int) -> Surface:
    """The same surface on cells that are smaller by a factor, a power of two."""
    if factor == 1:
        return surface
    rows, columns = surface.cells
    # Pixels' centres of the finer zoom, from the first one within the surface to the last.
    first = factor // 2
    x, y = ((first + 0.5 + np.arange(side * factor)) / factor - 0.5 for side in (columns, rows))
    heights = surface.heights(*(at.ravel() for at in np.meshgrid(x, y))).reshape(len(y), len(x))
    left, top = surface.left_px * factor + first, surface.top_px * factor + first
    return Surface(surface.grid, surface.zoom + factor.bit_length() - 1, left, top, heights.astype(np.float32))


def _raised(surface: Surface, triangles: Triangles, place: tuple[float, float], wider: float) -> Surface:
    """Surface raised to triangles, or to their tops if they are to be wider by some cells; ``place`` is near them."""
    offsets = (triangles.corners_m.reshape(-1, 3) - geocentric(*place)) @ enu_axes(*place).T
    lat, dlon, height = positions(np.array(place[0]), np.array(0.0), offsets)
    x, y = (at.reshape(-1, 3) for at in surface.position(lat, place[1] + dlon))
    height = height.reshape(-1, 3)
    rows, columns = surface.heights_m.shape
    (left, right), (top, bottom) = (
        (np.clip(np.ceil(at.min(axis=1) - wider), 0, side), np.clip(np.floor(at.max(axis=1) + wider) + 1, 0, side))
        for at, side in ((x, columns), (y, rows))
    )
    boxes = np.stack([left, top, np.maximum(right, left), np.maximum(bottom, top)]).astype(np.int64)
    heights = surface.heights_m.astype(np.result_type(surface.heights_m, np.float32))
    ends = np.cumsum((boxes[2] - boxes[0]) * (boxes[3] - boxes[1]))
    start = begun = 0
    while start < len(ends):
        stop = max(int(np.searchsorted(ends, begun + _BATCH, "right")), start + 1)
        some = slice(start, stop)
        one, row, column = _box_pixels(boxes[:, some])
        is_near = _within(x[some][one], y[some][one], column, row, wider)
        one, at = one[is_near] + start, (row[is_near], column[is_near])
        tops = height[one].max(axis=1) if wider else _on_planes(x[one], y[one], height[one], *at[::-1])
        # Where there is no ground, comparisons with NaN leave it so.
        values = np.where(np.isnan(heights[at]), np.nan, tops)
        with np.errstate(invalid="ignore"):
            np.maximum.at(heights, at, values.astype(heights.dtype))
        start, begun = stop, int(ends[stop - 1])
    return replace(surface, heights_m=heights)


def _box_pixels(boxes: Numbers) -> tuple[Numbers, Numbers, Numbers]:
    """Numbers of boxes (4, n), and rows and columns of the pixels in them."""
    left, top, right, bottom = boxes
    counts = (right - left) * (bottom - top)
    one, at = expand_counts(counts)
    wide = (right - left)[one]
    return one, top[one] + at // wide, left[one] + at % wide


def _on_planes(x: Floats, y: Floats, height: Floats, column: Numbers, row: Numbers) -> Floats:
    """Heights at pixels (n,) of the planes of triangles (n, 3); that of the highest corner for vertical ones."""
    (x0, x1, x2), (y0, y1, y2) = x.T, y.T
    whole = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    with np.errstate(divide="ignore", invalid="ignore"):
        second = ((column - x0) * (y2 - y0) - (x2 - x0) * (row - y0)) / whole
        third = ((x1 - x0) * (row - y0) - (column - x0) * (y1 - y0)) / whole
        found = height[:, 0] + second * (height[:, 1] - height[:, 0]) + third * (height[:, 2] - height[:, 0])
    # Rounding, and corners that are nearly in line, lead no higher than the corners.
    highest: Floats = height.max(axis=1)
    return np.where(found <= highest, np.fmax(found, height.min(axis=1)), highest)


def _within(x: Floats, y: Floats, column: Numbers, row: Numbers, wider: float) -> Numbers:
    """Whether pixels (n,) lie within triangles (n, 3), or less than some cells outside each of their edges."""
    next_x, next_y = np.roll(x, -1, axis=1), np.roll(y, -1, axis=1)
    along_x, along_y = next_x - x, next_y - y
    turn = np.sign(along_x[:, 0] * along_y[:, 1] - along_y[:, 0] * along_x[:, 1])
    length = np.maximum(np.hypot(along_x, along_y), np.finfo(float).tiny)
    side = (along_x * (row[:, np.newaxis] - y) - along_y * (column[:, np.newaxis] - x)) / length
    within: Numbers = (side * turn[:, np.newaxis] >= -wider).all(axis=1)
    return within
