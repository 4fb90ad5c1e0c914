"""The sun over a chart, and rays to it over lattices."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..geodesy.sun import SunDirection
from .lattice import LatticeWindow, chart_pole


class ChartSun(NamedTuple):
    """The sun in the directions of a chart: unit steps east and south towards it, and its height."""

    east: float
    south: float
    height_deg: float
    sky_share: float

    @classmethod
    def of(cls, sun: SunDirection, landscape: int) -> ChartSun:
        """Return the sun over a landscape, whose chart is turned against north about the poles."""
        turned = {0: 0.0, 1: -(sun.lon_deg + 45.0), -1: sun.lon_deg}[chart_pole(landscape)]
        azimuth = np.radians(sun.azimuth_deg + turned)
        return cls(float(np.sin(azimuth)), float(-np.cos(azimuth)), sun.height_deg, sun.sky_share)

    @property
    def tangent(self) -> float:
        """Tangent of the height."""
        return float(np.tan(np.radians(self.height_deg)))


class Ray(NamedTuple):
    """Steps along a ray to the sun, from one row or column of a lattice to the next."""

    east: float
    south: float
    length: float

    @classmethod
    def to(cls, sun: ChartSun) -> Ray:
        """Return the steps towards the sun."""
        most = max(abs(sun.east), abs(sun.south))
        return cls(sun.east / most, sun.south / most, 1.0 / most)

    def at(self, step: int, part: float) -> tuple[int, int, float, bool]:
        """Whole cells east and south, the share of the way to the next cell, and whether that lies eastward.

        Shares are rounded to multiples of ``part``.
        """
        across_is_east = abs(self.south) == 1.0
        across = (self.east if across_is_east else self.south) * step
        if part:
            across = round(across / part) * part
        whole = int(np.floor(across))
        along = round(self.south if across_is_east else self.east) * step
        column, row = (whole, along) if across_is_east else (along, whole)
        return column, row, across - whole, across_is_east

    def ahead(self, window: LatticeWindow, first: int, stop: int) -> LatticeWindow:
        """Window that rays from a window cross in steps from first to before stop."""
        ends = [self.at(step, 0.0) for step in (first, stop - 1)]
        i, j = [end[0] for end in ends], [end[1] for end in ends]
        return LatticeWindow(
            window.level,
            window.i0 + min(i),
            window.j0 + min(j),
            window.columns + max(i) - min(i) + 1,
            window.rows + max(j) - min(j) + 1,
        )
