"""Buildings under samples: where they stand, their shadows and roofs."""

from __future__ import annotations

import numpy as np

from .lattice import Array
from .paint import clip01
from .parcels import Parcels

_EXACT_PIXEL_M = 2.5
"""Up to this pixel size buildings are many pixels wide, and the nearest edge alone decides coverage."""


class Footprints:
    """Coverage by buildings at samples; `none` says that there are none."""

    def __init__(self, parcels: Parcels) -> None:
        self._parcels, self._scale = parcels, np.float32(1.0 / parcels.pixel_m)
        buildings = parcels.division.looks.buildings
        there = parcels.leaf(buildings.there)
        self.none = not there.any()
        if self.none:
            return
        east, south = parcels.corner
        x0 = np.where(there, parcels.leaf(buildings.x0) + east, np.inf)
        x1 = parcels.leaf(buildings.x1) + east
        y0, y1 = parcels.leaf(buildings.y0) + south, parcels.leaf(buildings.y1) + south
        spread, f = parcels.spread, np.float32
        self._west = parcels.x - spread(x0.astype(f))
        self._east = spread(x1.astype(f)) - parcels.x
        self._north = parcels.y - spread(y0.astype(f))
        self._south = spread(y1.astype(f)) - parcels.y

    def cover(self, moved_m: float = 0.0, grow_m: float = 0.0) -> Array:
        """Coverage by the buildings, moved some metres south-east and grown at each side by some."""
        more, less = np.float32(grow_m - moved_m), np.float32(grow_m + moved_m)
        half, p = np.float32(0.5), self._scale
        if p > 1 / _EXACT_PIXEL_M:
            out = np.minimum(self._west, self._north)
            out += more - less
            np.minimum(out, self._east, out=out)
            np.minimum(out, self._south, out=out)
            out += less
            out *= p
            out += half
            return clip01(out)
        cx = clip01((self._west + more) * p + half)
        cx -= clip01(half - (self._east + less) * p)
        cy = clip01((self._north + more) * p + half)
        cy -= clip01(half - (self._south + less) * p)
        cx *= cy
        return np.asarray(np.maximum(cx, np.float32(0), out=cx))

    def roofs(self, at: Array) -> Array:
        """Roof colours at the samples of some flat indices, shape (3, n): a gable's sides are lit differently."""
        parcels = self._parcels
        buildings, leaf = parcels.division.looks.buildings, parcels.index.ravel()[at]
        west, east, north, south = (
            side.ravel()[at] for side in (self._west, self._east, self._north, self._south)
        )
        across = np.where(parcels.leaf(buildings.ridge_x)[leaf], north - south, west - east)
        across *= np.float32(0.5) * self._scale
        light = np.float32(1) - np.clip(across, -1, 1) * parcels.leaf(buildings.pitch)[leaf]
        return np.stack([parcels.leaf(channel)[leaf] * light for channel in buildings.roof])
