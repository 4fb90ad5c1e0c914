"""The relief: combined sources of heights, and surfaces of it for ray tracing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..geodesy.mercator import PixelGrid
from ..geodesy.raytracing.surface import Surface
from .filling import REACH_PX, interpolated
from .heights import ConstantHeight, HeightOptions, Heights32, Layer, open_heights

#: Most cells of a surface: 32 MB of heights, and several times as much when rays are traced.
MOST_CELLS = 1 << 23
#: Pixels that a surface reaches beyond the requested ground.
_MARGIN_PX = 2
#: Size of the cells of level ground, which has no pixels, metres.
_LEVEL_CELL_M = 1024.0


@dataclass(eq=False)
class LayeredElevation:
    """Heights over the WGS 84 ellipsoid as one surface, bilinear between the pixels' centres of the first source.

    Parameters
    ----------
    layers : sequence of Layer
        At least one; the first with a height counts.
    interpolates : bool
        Whether holes that no layer fills are interpolated.
    """

    layers: Sequence[Layer]
    interpolates: bool = False

    @property
    def title(self) -> str:
        """Title for people."""
        return ", then ".join(layer.title for layer in self.layers)

    @property
    def attribution(self) -> str:
        """Credit for the heights."""
        return "; ".join(dict.fromkeys(layer.attribution for layer in self.layers if layer.attribution))

    def cell_m(self, lat_deg: float, lon_deg: float) -> float:
        """Size of the first source's pixels at a place, metres."""
        layer = self.layers[0]
        if isinstance(layer, ConstantHeight):
            return _LEVEL_CELL_M
        return _size_m(layer, lat_deg, lon_deg, layer.grid.native_zoom)

    def surface(self, lat_deg: Floats, lon_deg: Floats, cell_m: float = 0.0) -> Surface:
        """Read heights over the box of positions, in the first source's plane.

        Parameters
        ----------
        lat_deg, lon_deg : array (n,)
            Positions; longitudes are continuous.
        cell_m : float
            Largest size of cells; 0 for the finest. Cells are the source's pixels, or 2, 4, 8 … of them along each
            side, and larger than asked for if there were too many.

        Raises
        ------
        InvalidInput
            Heights are invalid.
        PartError, SourceError
            Heights cannot be read.
        """
        lat, lon = np.asarray(lat_deg, np.float64), np.asarray(lon_deg, np.float64)
        middle = float(np.mean(lat)), float(np.mean(lon))
        layer = next((one for one in self.layers[:-1] if _coarsest_m(one, *middle) >= cell_m), self.layers[-1])
        alone = len(self.layers) == 1
        zoom, (left, top, right, bottom) = _window(layer, lat, lon, cell_m, cut=alone)
        heights, holes = self._read(layer, zoom, left, top, right, bottom)
        made = None
        if self.interpolates and np.isnan(heights).any():
            # Heights depend on those within reach only, so the window's edges do not matter.
            reach = REACH_PX
            wide, _ = self._read(layer, zoom, left - reach, top - reach, right + reach, bottom + reach)
            whole = interpolated(wide)[reach:-reach, reach:-reach]
            made = np.isnan(heights) & ~np.isnan(whole)
            heights = whole
        return Surface(layer.grid, zoom, left, top, heights, holes, made)

    def _read(
        self, layer: Layer, zoom: int, left: int, top: int, right: int, bottom: int
    ) -> tuple[Heights32, NDArray[np.bool_] | None]:
        """Read a window of a layer's pixels, and mark pixels missing from the first source."""
        heights = np.full((bottom - top, right - left), np.nan, np.float32)
        missing, holes = np.isnan(heights), None
        for other in self.layers:
            if other is layer:
                read = layer.read(zoom, left, top, right - left, bottom - top)
                np.copyto(heights, read, where=missing)
            else:
                self._fill(other, layer.grid, (zoom, left, top), heights)
            missing = np.isnan(heights)
            if not missing.any():
                break
            holes = missing if holes is None else holes
        return heights, holes

    @staticmethod
    def _fill(layer: Layer, grid: PixelGrid, first: tuple[int, int, int], heights: Heights32) -> None:
        """Fill missing heights, on pixels of another grid from ``first`` on, with those of a layer."""
        zoom, left, top = first
        rows, columns = np.nonzero(np.isnan(heights))
        world = grid.world_px(zoom)
        lat, lon = grid.plane.inverse((columns + left + 0.5) / world, (rows + top + 0.5) / world)
        good = np.isfinite(lat) & np.isfinite(lon)
        rows, columns, lat, lon = rows[good], columns[good], lat[good], lon[good]
        if not len(rows):
            return
        cell_m = float(grid.ground_m_per_px(lat[:1], lon[:1], zoom)[0])
        own_zoom, (own_left, own_top, right, bottom) = _window(layer, lat, lon, cell_m, cut=True)
        read = layer.read(own_zoom, own_left, own_top, right - own_left, bottom - own_top)
        surface = Surface(layer.grid, own_zoom, own_left, own_top, read)
        column, row = surface.position(lat, lon)
        found = surface.heights(column, row)
        # Outer pixels reach half of their size beyond their centres, to the pixels of an adjacent file.
        on = [(at > -0.5) & (at < side - 0.5) for at, side in zip((row, column), read.shape)]
        alone = np.flatnonzero(np.isnan(found) & on[0] & on[1])
        nearest = (np.rint(at[alone]).astype(np.intp) for at in (row, column))
        found[alone] = read[tuple(nearest)]
        heights[rows, columns] = found


def open_relief(
    texts: Sequence[str],
    options: HeightOptions = HeightOptions(),  # noqa: B008  frozen
    *,
    interpolates: bool = False,
) -> LayeredElevation:
    """Open the sources of heights that texts name, see `open_heights`; the first with a height counts.

    Raises
    ------
    InvalidInput, SourceError
        As for `open_heights`.
    """
    return LayeredElevation(tuple(open_heights(text, options) for text in texts), interpolates)


def _size_m(layer: Layer, lat_deg: float, lon_deg: float, zoom: int) -> float:
    """Size of a layer's pixels at a place and a zoom, metres."""
    return float(layer.grid.ground_m_per_px(np.array(lat_deg), np.array(lon_deg), zoom))


def _coarsest_m(layer: Layer, lat_deg: float, lon_deg: float) -> float:
    return _size_m(layer, lat_deg, lon_deg, layer.grid.min_zoom)


def _window(
    layer: Layer, lat: Floats, lon: Floats, cell_m: float, *, cut: bool
) -> tuple[int, tuple[int, int, int, int]]:
    """Choose a zoom and a window (left, top, right, bottom) of a layer's pixels over the box of positions (n,).

    Parameters
    ----------
    cell_m : float
        Largest size of pixels, unless a surface would have too many; the largest within it are chosen.
    cut : bool
        Leave out pixels well beyond the layer.
    """
    grid = layer.grid
    u, v = grid.plane.forward(lat, lon)
    there = np.isfinite(u) & np.isfinite(v)
    lows, highs = np.zeros(2), np.zeros(2)
    if there.any():
        lows, highs = (np.array([f(u[there]), f(v[there])]) for f in (np.min, np.max))
    if cut and not grid.plane.wraps and grid.extent is not None:
        ends = np.array(grid.extent)
        lows, highs = (np.clip(at, ends.min(axis=0), ends.max(axis=0)) for at in (lows, highs))
    middle = float(np.mean(lat)), float(np.mean(lon))
    wanted_m = max(cell_m, _LEVEL_CELL_M) if isinstance(layer, ConstantHeight) else cell_m
    zoom = grid.native_zoom
    size_m = _size_m(layer, *middle, zoom)
    while True:
        world = grid.world_px(zoom)
        left, top = (int(np.floor(at * world - 0.5)) - _MARGIN_PX for at in lows)
        right, bottom = (int(np.ceil(at * world - 0.5)) + 1 + _MARGIN_PX for at in highs)
        if grid.plane.wraps:
            top, bottom = max(min(top, world - 2), 0), min(max(bottom, 2), world)
        few = (right - left) * (bottom - top) <= MOST_CELLS
        if zoom <= grid.min_zoom or (few and 2.0 * size_m > wanted_m):
            return zoom, (left, top, right, bottom)
        zoom, size_m = zoom - 1, 2.0 * size_m
