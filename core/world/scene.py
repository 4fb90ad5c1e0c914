"""Coverage of samples by water, woods, motorways and parcels, computed once and shared by all styles."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from . import climate
from .lattice import Array
from .paint import ramp
from .parcels import Parcels
from .rays import ChartSun
from .region import Region
from .samples import Positions

#: Zoom from which parcels and roads are drawn; at lower zooms a pixel is wider than a village.
PARCEL_ZOOM = 8
#: Greatest slope of fields, per metre.
_MOST_STEEPNESS = {
    "river": 6e-5,
    "brook": 2.5e-4,
    "motorway": 4e-5,
    "lake": 1.5e-4,
    "land": 2e-5,
    "wood": 4e-4,
}


class Scene:
    """The world around samples; coverages are float32, 0..1, of the samples' shape, or None where all are 0."""

    def __init__(
        self, seed: int, samples: Positions, region: Region | None = None, sun: ChartSun | None = None
    ) -> None:
        """Evaluate the world, in its own light where there is no sun, with the region around samples by default."""
        self.seed, self.samples, self.sun = seed, samples, sun
        self.pixel_m = samples.pixel_m
        self.region = Region.around(seed, samples) if region is None else region
        self._climates: dict[str, Array] = {}

    @cached_property
    def parcels(self) -> Parcels:
        """The division of the land."""
        return Parcels(self.seed, self.region, self.samples)

    def _value(self, name: str) -> Array:
        return self.region.value(name, self.samples)

    def _bounds(self, name: str) -> Iterator[tuple[float, float]]:
        """Bound a field over the block, which is cheap, and then over the samples."""
        yield self.region.extremes(name)
        yield self.region.span(name, self.samples)

    def _reach(self, name: str, half_width_m: float) -> float:
        """Greatest absolute value of a field within a half width of its zeros, blur included."""
        return (half_width_m + self.pixel_m) * _MOST_STEEPNESS[name] + self.region.blur(name)

    def _course(
        self, name: str, half_width_m: float, least_steepness: float, factor: str | None = None
    ) -> Array | None:
        """Coverage by a line along the zeros of a field, its width times a factor of the climate.

        Where the field is flatter than ``least_steepness`` per metre, as at a confluence, the width grows no further.
        """
        reach = self._reach(name, half_width_m)
        for low, high in self._bounds(name):
            if low > reach or high < -reach:
                return None
        f = self._value(name)
        steep = self.region.steepness(name, self.samples)
        width = np.maximum(steep, np.float32(least_steepness)) * np.float32(half_width_m)
        if factor is not None:
            width *= self._climate(factor)
        soft = steep
        soft *= np.float32(self.pixel_m)
        soft += np.float32(self.region.blur(name) + 1e-12)
        cover = ramp(f + width, soft)
        cover -= ramp(f - width, soft)
        return cover

    def _climate(self, name: str) -> Array:
        if name not in self._climates:
            self._climates[name] = self.region.smooth(getattr(climate, name), self.samples)
        return self._climates[name]

    @cached_property
    def sea(self) -> Array | None:
        """Coverage by the sea."""
        reach = self._reach("land", 0.0)
        if any(low > reach for low, _ in self._bounds("land")):
            return None
        steep = self.region.steepness("land", self.samples) * np.float32(self.pixel_m)
        return ramp(-self._value("land"), steep + np.float32(self.region.blur("land") + 1e-12))

    @cached_property
    def rivers(self) -> Array | None:
        """Coverage by rivers and brooks."""
        river = self._course("river", 34.0, 2.2e-6, "wateriness")
        brook = self._course("brook", 3.2, 1.0e-5, "wateriness")
        return _union(river, brook)

    @cached_property
    def lakes(self) -> Array | None:
        """Coverage by lakes."""
        # The field at shores where `wateriness` is 1; higher where it is less.
        least = 1.08
        reach = self._reach("lake", 0.0)
        if any(high < least - reach for _, high in self._bounds("lake")):
            return None
        above = self._value("lake") - (np.float32(least + 1.2) - np.float32(1.2) * self._climate("wateriness"))
        steep = self.region.steepness("lake", self.samples) * np.float32(self.pixel_m)
        return ramp(above, steep + np.float32(self.region.blur("lake") + 1e-12))

    def water(self) -> Array | None:
        """Coverage by all water."""
        return _union(_union(self.sea, self.lakes), self.rivers)

    @cached_property
    def woods(self) -> Array | None:
        """Coverage by woods, regardless of water."""
        if self.region.extremes("wood")[1] < self.region.derived_extremes(climate.wood_threshold)[0] - self._reach(
            "wood", 0.0
        ):
            return None
        low, high = self.region.span("wood", self.samples)
        least, most = self.region.derived_span(climate.wood_threshold, self.samples)
        reach = self._reach("wood", 0.0)
        if high < least - reach:
            return None
        if low > most + reach:
            return self._outside_towns(np.ones(self.samples.shape, dtype=np.float32))
        above = self._value("wood") - self.region.smooth(climate.wood_threshold, self.samples)
        steep = self.region.steepness("wood", self.samples) * np.float32(self.pixel_m)
        cover = ramp(above, steep + np.float32(self.region.blur("wood") + 1e-12))
        return self._outside_towns(cover) if cover.any() else None

    def _outside_towns(self, cover: Array) -> Array | None:
        if self.samples.zoom >= PARCEL_ZOOM:
            free = self.parcels.leaf(self.parcels.division.looks.open)
            if not free.any():
                return None
            if not free.all():
                cover *= self.parcels.spread(free)
        return cover

    @cached_property
    def motorway(self) -> Array | None:
        """Coverage by motorways."""
        cover = self._course("motorway", 13.0, 1.5e-6)
        if cover is not None:
            cover *= self._climate("settled")
        return cover

    def shade(self) -> Array:
        """Slope towards a light in the north-west, compressed into -1..1.

        Slopes are reduced by a factor of 0.86 for each zoom below 13, as cartographers do: relief as rough at coarse
        pixels as a hillside at fine ones would look like much higher mountains. With a sun it is 0: the sun's light is
        laid over the finished picture.
        """
        if self.sun is not None:
            return np.zeros(self.samples.shape, np.float32)
        east, south = self.region.slope("relief", self.samples)
        east += south
        coarse = max(13 - self.samples.zoom, 0)
        east *= np.float32(40075016.7 / 28.0 * 0.86**coarse)
        east /= np.sqrt(np.float32(1) + east * east)
        return east


def _union(a: Array | None, b: Array | None) -> Array | None:
    if a is None or b is None:
        return a if b is None else b
    return np.maximum(a, b)
