"""Ways to place the pixels of a camera frame: the plan's, and others that differ from it near the budget."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..external.compiling import uses_numba, without_numba
from ..geodesy.accuracy import ImageGeometry
from ..mission.methods import (
    COARSEST_MESH_PX,
    TRACED,
    Method,
    camera_frame,
    choose_pixels,
    exact_footprint,
    mesh,
    relief_rays,
)
from ..mission.plan import Plan
from .pictures import Rendering
from .positions import mesh_errors, relief_errors_px

#: Ratio of the tolerances of successive meshes.
_STEP = 3.0
#: Meshes finer than the plan's.
_FINER = 3
#: Tolerances between which rays over relief are compared, px.
_RELIEF_PX = (0.3, 0.001)
#: Rays over relief where compiled code is installed, but not used.
NUMPY = "relief, numpy"
#: Level ground in place of relief.
LEVEL = "level ground"


class PixelMethod(NamedTuple):
    """A way to place the pixels of a camera frame, with its errors.

    Attributes
    ----------
    rendering : Rendering
        Without a kernel.
    own : bool
        Whether the plan uses the method.
    errors_px : array (n,)
        Errors of the positions beyond those of the camera frame's rays.
    reached_px : float or None
        Bound that the mesh reaches; None if it is the method's.
    same_px : tuple of float
        Other tolerances that give the same positions.
    """

    method: Method
    rendering: Rendering
    own: bool
    errors_px: Floats
    reached_px: float | None = None
    same_px: tuple[float, ...] = ()

    @property
    def tolerance_px(self) -> float:
        """Tolerance of the mesh, 0 for rays; over relief, tolerance of the rays."""
        return self.rendering.tolerance_px


def pixel_methods(plan: Plan, scene: ImageGeometry) -> list[PixelMethod]:
    """Methods from coarse to fine: the one that the plan uses, or would use, and others whose positions differ.

    Over level ground meshes, then rays. The tolerances of the meshes are a factor of three apart, down from what the
    mesh before reaches. Tolerances that give the same mesh are one method.
    """
    if not plan.relief.is_level:
        return _relief_methods(plan, scene)
    others_px = camera_frame(scene).bound_px + exact_footprint(scene).bound_px
    choice = plan.accuracy.pixels or choose_pixels(plan.mission, (scene,), others_px)
    own = choice.method if choice.method.name != TRACED.name else None
    first_px = own.bound_px if own is not None else COARSEST_MESH_PX
    found: list[PixelMethod] = []
    cells = b""
    coarser_px = min(_rounded(_STEP * first_px), COARSEST_MESH_PX)
    for tolerance_px in sorted({COARSEST_MESH_PX, coarser_px, first_px}, reverse=True):
        method = replace(mesh(scene, tolerance_px), name=_mesh_name(tolerance_px))
        drawn = mesh_errors(plan, tolerance_px)
        same_px: tuple[float, ...] = ()
        if drawn.cells == cells:
            coarser = found.pop()
            same_px = (*coarser.same_px, coarser.tolerance_px)
        is_own = own is not None and tolerance_px == first_px
        cells, made = drawn.cells, own if own is not None and is_own else method
        found.append(PixelMethod(made, Rendering(tolerance_px), is_own, drawn.errors_px, drawn.reached_px, same_px))
    # Rays give the camera frame's positions, whose error is counted in that stage.
    return [*found, *_finer(plan, scene, found[-1]), PixelMethod(TRACED, Rendering(0.0), own is None, np.zeros(1))]


def _finer(plan: Plan, scene: ImageGeometry, found: PixelMethod) -> Iterator[PixelMethod]:
    """Yield meshes finer than another, as far as they have cells."""
    for _ in range(_FINER):
        tolerance_px = _rounded((found.reached_px or 0.0) / _STEP)
        method = mesh(scene, tolerance_px)
        # Rounding of the corners to float64 limits how fine a mesh can be.
        drawn = mesh_errors(plan, tolerance_px) if 0.0 < method.bound_px <= tolerance_px else None
        if drawn is None or not drawn.reached_px:
            return
        method = replace(method, name=_mesh_name(tolerance_px))
        found = PixelMethod(method, Rendering(tolerance_px), False, drawn.errors_px, drawn.reached_px)
        yield found


def _rounded(tolerance_px: float) -> float:
    return float(f"{tolerance_px:.2g}")


def _mesh_name(tolerance_px: float) -> str:
    return f"mesh, {np.format_float_positional(tolerance_px, trim='-')} px"


def _relief_methods(plan: Plan, scene: ImageGeometry) -> list[PixelMethod]:
    """Level ground, whose error over relief has no bound, and rays over relief from coarse to fine."""
    level = Method("pixels", LEVEL, math.inf, math.inf)
    found = [PixelMethod(level, Rendering(COARSEST_MESH_PX, level=True), False, relief_errors_px(plan, None))]
    found += _relief_rays(plan, scene)
    if uses_numba():
        with without_numba():
            found += _relief_rays(plan, scene, compiled=False)
    return found


def _relief_rays(plan: Plan, scene: ImageGeometry, *, compiled: bool = True) -> list[PixelMethod]:
    """Rays over relief from coarse to fine; tolerances that give the same positions are one method."""
    own_px, name = plan.accuracy.mesh_tolerance_px, "relief" if compiled else NUMPY
    rays: list[PixelMethod] = []
    for tolerance_px in sorted({own_px, *_RELIEF_PX}, reverse=True):
        errors_px = relief_errors_px(plan, tolerance_px)
        is_own = compiled and tolerance_px == own_px
        same_px: tuple[float, ...] = ()
        if rays and np.array_equal(errors_px, rays[-1].errors_px):
            if rays[-1].tolerance_px == own_px:
                rays[-1] = rays[-1]._replace(same_px=(*rays[-1].same_px, tolerance_px))
                continue
            coarser = rays.pop()
            same_px = (*coarser.same_px, coarser.tolerance_px)
        named = name if tolerance_px == own_px else f"{name}, {tolerance_px:g} px"
        method = replace(relief_rays(scene, own_px), name=named, bound_px=tolerance_px)
        rendering = Rendering(tolerance_px, compiled=compiled)
        rays.append(PixelMethod(method, rendering, is_own, errors_px, same_px=same_px))
    return rays
