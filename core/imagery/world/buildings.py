"""Buildings under samples: where they stand, their shadows and roofs."""

from __future__ import annotations

import numpy as np

from .lattice import Array
from .parcels import Parcels


class Footprints:
    """Coverage by buildings at samples.

    `at` are the flat indices of the samples whose piece holds a building, `leaf` their pieces.
    """

    def __init__(self, parcels: Parcels) -> None:
        self.parcels, self.pixel_m = parcels, parcels.pixel_m
        buildings = parcels.division.looks.buildings
        there = parcels.leaf(buildings.there)
        self.at = np.zeros(0, dtype=np.intp)
        if not there.any():
            return
        self.at = np.flatnonzero(parcels.spread(there))
        self.leaf = parcels.index.ravel()[self.at]
        x, y = parcels.x.ravel()[self.at], parcels.y.ravel()[self.at]
        east, south = parcels.corner
        self._inside = [
            x - self._edge(buildings.x0, east), self._edge(buildings.x1, east) - x,
            y - self._edge(buildings.y0, south), self._edge(buildings.y1, south) - y,
        ]  # fmt: skip

    def _edge(self, table: Array, shift: float) -> Array:
        edge: Array = (self.parcels.leaf(table) + shift).astype(np.float32)
        return edge.take(self.leaf)

    def cover(self, moved_m: float = 0.0, grow_m: float = 0.0) -> Array:
        """Coverage at `at` by the buildings, moved some metres south-east and grown at each side by some."""
        more, less = np.float32(grow_m - moved_m), np.float32(grow_m + moved_m)
        west, east, north, south = self._inside
        p = np.float32(1.0 / self.pixel_m)
        if self.pixel_m < 2.5:  # buildings many pixels wide: the nearest edge decides
            out = np.minimum(np.minimum(west, north) + more, np.minimum(east, south) + less)
            out *= p
            out += np.float32(0.5)
            clipped: Array = np.clip(out, 0.0, 1.0, out=out)
            return clipped
        half = np.float32(0.5)
        cx = np.clip((west + more) * p + half, 0.0, 1.0) - np.clip(half - (east + less) * p, 0.0, 1.0)
        cy = np.clip((north + more) * p + half, 0.0, 1.0) - np.clip(half - (south + less) * p, 0.0, 1.0)
        cx *= cy
        return np.asarray(cx)

    def roofs(self, which: Array) -> Array:
        """Roof colours at some of the samples `at`, shape (3, n): gables' sides are lit differently."""
        buildings, parcels = self.parcels.division.looks.buildings, self.parcels
        leaf = self.leaf[which]
        west, east, north, south = (side[which] for side in self._inside)
        across = np.where(parcels.leaf(buildings.ridge_x)[leaf], north - south, west - east)
        across *= np.float32(0.5 / self.pixel_m)
        light = np.float32(1) - np.clip(across, -1, 1) * parcels.leaf(buildings.pitch)[leaf]
        return np.stack([parcels.leaf(channel)[leaf] * light for channel in buildings.roof])
