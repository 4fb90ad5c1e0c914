"""Buildings under samples: where they stand, their shadows and roofs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .lattice import Array
from .paint import clip01
from .parcels import Parcels

_EXACT_PIXEL_M = 2.5
"""Up to this pixel size buildings are many pixels wide, and the nearest edge alone decides coverage."""

_REACH_M = 8.0
"""Nothing of a building, its shadow or the trees it keeps off is farther away."""


@dataclass(frozen=True)
class Footprints:
    """Buildings at samples.

    Attributes
    ----------
    parcels : Parcels
    index : intp array
        Each sample's piece, as in `Parcels.index`.
    west, east, north, south : float32 arrays
        How far inside the sides of its piece's building each sample is, in metres.
    """

    parcels: Parcels
    index: Array
    west: Array
    east: Array
    north: Array
    south: Array

    def near(self, moved_m: float) -> tuple[Array, Footprints]:
        """Return the flat indices of samples at or near buildings, and the buildings at only these.

        No others are covered, nor are they by the buildings moved `moved_m` south-east.
        """
        margin = -0.6 * self.parcels.pixel_m
        on = np.minimum(self.west, self.north) > np.float32(margin)
        on &= np.minimum(self.east, self.south) > np.float32(margin - moved_m)
        at = np.flatnonzero(on)
        values = (self.index, self.west, self.east, self.north, self.south)
        return at, Footprints(self.parcels, *(value.take(at, mode="clip") for value in values))

    def cover(self, moved_m: float = 0.0, grow_m: float = 0.0) -> Array:
        """Coverage by the buildings, moved some metres south-east and grown at each side by some."""
        more, less = np.float32(grow_m - moved_m), np.float32(grow_m + moved_m)
        half, p = np.float32(0.5), np.float32(1.0 / self.parcels.pixel_m)
        if p > 1 / _EXACT_PIXEL_M:
            out = np.minimum(self.west, self.north)
            out += more - less
            np.minimum(out, self.east, out=out)
            np.minimum(out, self.south, out=out)
            out += less
            out *= p
            out += half
            return clip01(out)
        cx = clip01((self.west + more) * p + half)
        cx -= clip01(half - (self.east + less) * p)
        cy = clip01((self.north + more) * p + half)
        cy -= clip01(half - (self.south + less) * p)
        cx *= cy
        return np.asarray(np.maximum(cx, np.float32(0), out=cx))

    def roofs(self) -> list[Array]:
        """Roof colours at the samples, red, green and blue: a gable's sides are lit differently."""
        buildings = self.parcels.division.looks.buildings

        def own(table: Array) -> Array:
            return np.asarray(self.parcels.leaf(table).take(self.index, mode="clip"))

        across = np.where(own(buildings.ridge_x), self.north - self.south, self.west - self.east)
        across *= np.float32(0.5) * np.float32(1.0 / self.parcels.pixel_m)
        np.maximum(across, np.float32(-1), out=across)
        np.minimum(across, np.float32(1), out=across)
        across *= own(buildings.pitch)
        light = np.float32(1) - across
        return [own(channel) * light for channel in buildings.roof]


def footprints(parcels: Parcels) -> Footprints | None:
    """Return the buildings at samples; None where there are none in reach."""
    buildings = parcels.division.looks.buildings
    x0, x1, y0, y1 = (parcels.leaf(edge) for edge in (buildings.x0, buildings.x1, buildings.y0, buildings.y1))
    there = parcels.leaf(buildings.there) & parcels.touched(x0, x1, y0, y1, _REACH_M + parcels.pixel_m)
    if not there.any():
        return None
    return Footprints(
        parcels,
        parcels.index,
        parcels.x - parcels.local(np.where(there, x0, np.inf), 0),
        parcels.local(x1, 0) - parcels.x,
        parcels.y - parcels.local(y0, 1),
        parcels.local(y1, 1) - parcels.y,
    )
