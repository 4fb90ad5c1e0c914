"""Condition number of a mission's scene over tilt and height."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..geodesy.accuracy import condition_number
from ..geodesy.camera import Poses
from ..mission.plan import Plan
from .positions import bounds_scene

#: Heights and tilts of the curves beside the mission's.
_HEIGHTS_M, _TILTS_DEG = (1e3, 1e5, 1e6), (0.0, 30.0, 60.0)
#: Tilts and heights along the curves.
_OVER_TILT_DEG, _OVER_HEIGHT_M = np.linspace(0.0, 89.0, 90), np.geomspace(10.0, 1e7, 61)


class Curve(NamedTuple):
    """Condition numbers (n,) over tilts (degrees) or heights (m) x; NaN where the image shows the horizon.

    Attributes
    ----------
    parameter : float
        The height in m, or the tilt in degrees, that is the same all along the curve.
    """

    parameter: float
    x: Floats
    condition: Floats


class Conditioning(NamedTuple):
    """Curves over tilt, one for each height, and over height, one for each tilt; the mission's own is the first."""

    over_tilt: tuple[Curve, ...]
    over_height: tuple[Curve, ...]

    @property
    def height_m(self) -> float:
        """The mission's height."""
        return self.over_tilt[0].parameter

    @property
    def tilt_deg(self) -> float:
        """The mission's tilt."""
        return self.over_height[0].parameter


def conditioning(plan: Plan) -> Conditioning:
    """Condition numbers of a plan's camera over tilt and height, at its highest latitude.

    The mission's own height is the median of its captures; its tilt and roll are the greatest.
    """
    scene, poses = bounds_scene(plan), plan.poses
    lat_deg = float(np.abs(poses.lat_deg).max())
    roll_deg = float(np.abs(poses.roll_deg).max())
    height_m, tilt_deg = float(np.median(poses.agl_m)), float(np.abs(poses.tilt_deg).max())

    def condition(height: float, tilt: float) -> float:
        pose = Poses.from_attitude(np.array([lat_deg]), np.zeros(1), np.array([height]), 0.0, tilt, roll_deg)
        found = condition_number(replace(scene, poses=pose), on_mercator=plan.grid.plane.wraps)
        return found if math.isfinite(found) else math.nan

    return Conditioning(
        tuple(
            Curve(height, _OVER_TILT_DEG, np.array([condition(height, tilt) for tilt in _OVER_TILT_DEG.tolist()]))
            for height in _others(height_m, _HEIGHTS_M)
        ),
        tuple(
            Curve(tilt, _OVER_HEIGHT_M, np.array([condition(height, tilt) for height in _OVER_HEIGHT_M.tolist()]))
            for tilt in _others(tilt_deg, _TILTS_DEG)
        ),
    )


def _others(own: float, values: Sequence[float]) -> list[float]:
    """Values after the mission's own, without those near to it."""
    return [own, *(value for value in values if not math.isclose(value, own, rel_tol=0.05, abs_tol=1.0))]
