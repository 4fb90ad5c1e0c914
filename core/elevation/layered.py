"""The relief: sources of heights combined, and read as surfaces for ray tracing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats, NDArray
from ..geodesy.ellipsoid import sight_lines
from ..geodesy.mercator import PixelGrid
from ..geodesy.raytracing.surface import Surface
from ..geodesy.triangles import FaceModel
from .filling import REACH_PX, interpolated
from .heights import ConstantHeight, HeightOptions, Heights32, Layer, open_heights

#: Most cells of a surface, with 32 MB of heights; ray tracing takes several times this memory.
MOST_CELLS = 1 << 23
#: Pixels by which a surface extends beyond the requested ground.
_MARGIN_PX = 2
#: Size in metres of the cells of level ground, which has no pixels.
_LEVEL_CELL_M = 1024.0


@dataclass(eq=False)
class LayeredElevation:
    """Heights over the WGS 84 ellipsoid as one surface, bilinear between pixel centres of the first source.

    Parameters
    ----------
    layers : sequence of Layer
        At least one; at each place, the first layer with a height counts.
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

    @property
    def faces(self) -> FaceModel:
        """Buildings of the first source: on others they would not meet the ground where it fills no hole."""
        return self.layers[0].faces

    def cell_m(self, lat_deg: float, lon_deg: float) -> float:
        """Size of the first source's pixels at a place, metres."""
        layer = self.layers[0]
        if isinstance(layer, ConstantHeight):
            return _LEVEL_CELL_M
        return _size_m(layer, lat_deg, lon_deg, layer.grid.native_zoom)

    def end_m(self, lat_deg: float, lon_deg: float) -> float:
        """Level distance from a place beyond which no source has heights, metres; infinite if unknown."""
        return max(_end_m(layer, lat_deg, lon_deg) for layer in self.layers)

    def surface(self, lat_deg: Floats, lon_deg: Floats, cell_m: float = 0.0) -> Surface:
        """Read heights over the box of positions, in the first source's plane.

        Parameters
        ----------
        lat_deg, lon_deg : array (n,)
            Positions; longitudes are continuous.
        cell_m : float
            Largest size of cells; 0 for the finest. Cells are 1, 2, 4, 8 … of the source's pixels wide
            and high, and larger than ``cell_m`` if there would be too many otherwise.

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
        interpolated_mask = None
        if self.interpolates and np.isnan(heights).any():
            # Filled heights depend on heights within reach only, so read this margin around the window.
            reach = REACH_PX
            with_margin, _ = self._read(layer, zoom, left - reach, top - reach, right + reach, bottom + reach)
            filled = interpolated(with_margin)[reach:-reach, reach:-reach]
            interpolated_mask = np.isnan(heights) & ~np.isnan(filled)
            heights = filled
        return Surface(layer.grid, zoom, left, top, heights, holes, interpolated_mask)

    def _read(
        self, layer: Layer, zoom: int, left: int, top: int, right: int, bottom: int
    ) -> tuple[Heights32, NDArray[np.bool_] | None]:
        """Read a window of a layer's pixels from all layers; also return which pixels the first layer lacks."""
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
        """Fill missing heights from a layer; ``first`` is the zoom, left and top of ``heights`` on ``grid``."""
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
        # Beyond the centres of outer pixels, to half a pixel, use the nearest pixel, as an adjacent file begins there.
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
    """Open the sources of heights that texts name (see `open_heights`); at each place, the first with a height counts.

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


def _end_m(layer: Layer, lat_deg: float, lon_deg: float) -> float:
    """Level distance from a place to a layer's farthest corner, metres, with a margin; infinite if unknown."""
    if layer.grid.extent is None:
        return np.inf
    lat, lon = layer.grid.plane.inverse(*np.array(layer.grid.extent).T)
    if np.ptp(lon) > 180.0:
        # Corners may lie near a place from which the layer reaches around the Earth.
        return np.inf
    corners = sight_lines(np.array(lat_deg), np.array(0.0), lat, lon - lon_deg)
    # Sides bend by up to 1 % of their length.
    end_m = 1.05 * float(np.hypot(corners[:, 0], corners[:, 1]).max())
    return end_m + _size_m(layer, lat_deg, lon_deg, layer.grid.native_zoom) if np.isfinite(end_m) else np.inf


def _window(
    layer: Layer, lat: Floats, lon: Floats, cell_m: float, *, cut: bool
) -> tuple[int, tuple[int, int, int, int]]:
    """Choose a zoom and a window (left, top, right, bottom) of a layer's pixels over the box of positions (n,).

    Parameters
    ----------
    cell_m : float
        Largest size of pixels. The zoom with the largest pixels of at most this size is chosen, or a lower zoom if a
        surface would have too many pixels.
    cut : bool
        Whether to leave out pixels well beyond the layer.
    """
    grid = layer.grid
    u, v = grid.plane.forward(lat, lon)
    finite = np.isfinite(u) & np.isfinite(v)
    lows, highs = np.zeros(2), np.zeros(2)
    if finite.any():
        lows, highs = (np.array([f(u[finite]), f(v[finite])]) for f in (np.min, np.max))
    if cut and grid.extent is not None:
        ends = np.array(grid.extent)
        if grid.plane.wraps:
            ends[:, 0] += np.rint((lows[0] + highs[0]) / 2.0 - ends[:, 0].mean())
            if np.ptp(ends[:, 0]) > 0.5:
                ends[:, 0] = lows[0], lows[0], highs[0], highs[0]
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
        fits = (right - left) * (bottom - top) <= MOST_CELLS
        if zoom <= grid.min_zoom or (fits and 2.0 * size_m > wanted_m):
            return zoom, (left, top, right, bottom)
        zoom, size_m = zoom - 1, 2.0 * size_m
