"""Run time and error of every method, measured on the captures of a plan."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from ..errors import Message
from ..geodesy.accuracy import ImageGeometry, outside_flat_domain
from ..geodesy.footprint import ground_corners
from ..imagery.source import Source
from ..mission.flight.legs import intervals_s, legs
from ..mission.flight.motion import fly
from ..mission.flight.wind import Wind
from ..mission.methods import (
    COARSEST_MESH_PX,
    TRACED,
    Method,
    camera_frame,
    choose_pixels,
    exact_footprint,
    map_frame,
    mesh,
    relief_rays,
)
from ..mission.parts import Flight
from ..mission.plan import Plan
from ..picture.resampling import KERNELS
from ..timing import QUICK, THOROUGH, Effort, Seconds, timed, timed_together
from . import positions
from .footprints import FOOTPRINTS, footprint_methods
from .pictures import BY_RAYS, Bench, Encoding, PartCache, Rendering, Resampling, encodings, resampling
from .positions import floor_px
from .wind import WindEffect, wind_effect

#: Called with the name of each step.
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Measured:
    """A method with its greatest error and its run time on captures of a mission.

    Attributes
    ----------
    method : Method
        With its bound; not measured if it is not usable, for the reason in `Method.outside`.
    seconds : Seconds or None
        For a capture on one core, without fetching and encoding; methods of a stage are timed in the same rounds.
    chosen : bool
        Whether the plan uses it.
    size_bytes : int or None
        Size of an image file, for methods that make one.
    floor_px : float
        Error of the reference.
    """

    method: Method
    error_px: float | None = None
    seconds: Seconds | None = None
    chosen: bool = False
    size_bytes: int | None = None
    floor_px: float = 0.0

    @property
    def keeps_bound(self) -> bool:
        """Whether the error is within the bound, up to the error of the reference; true without an error."""
        return self.error_px is None or self.error_px <= self.method.bound_px + self.floor_px


def baseline(stage: Sequence[Measured]) -> Measured | None:
    """Method of a stage with whose time others are compared: the chosen one, or else the cheapest."""
    with_time = [one for one in stage if one.seconds is not None]
    return next((one for one in with_time if one.chosen), with_time[0] if with_time else None)


@dataclass(frozen=True)
class Kernel:
    """Run time of a camera frame with a resampling kernel."""

    name: str
    seconds: Seconds


@dataclass(frozen=True)
class Saving:
    """A step that the plan left out, and the time and bytes saved for the whole mission.

    Attributes
    ----------
    seconds : Seconds
        Additional time, round by round.
    differs : bool
        Whether the times differ significantly.
    """

    what: str
    why: str
    seconds: Seconds
    differs: bool
    size_bytes: int


@dataclass(frozen=True)
class Measurement:
    """Everything measured for a plan.

    Attributes
    ----------
    stages : dict of str to tuple of Measured
        Methods by stage, from cheap to exact.
    floor_px : float
        Error of the reference, the least that can be measured.
    kernels : tuple of Kernel
        Empty if the source has no tiles; ``resampling`` is None then.
    wind : WindEffect or None
        None in still air.
    planned_px, timed_px : tuple of int
        Size of the planned picture, and of the measured one, whose time and bytes are scaled to the planned size.
    parts : int
        Number of fetched parts of the source.
    """

    map_type: str
    stages: dict[str, tuple[Measured, ...]]
    floor_px: float
    kernels: tuple[Kernel, ...]
    resampling: Resampling | None
    encodings: tuple[Encoding, ...]
    wind: WindEffect | None
    left_out: tuple[Saving, ...]
    planned_px: tuple[int, int]
    timed_px: tuple[int, int]
    parts: int

    @property
    def chosen(self) -> tuple[Measured, ...]:
        """Methods of the plan."""
        return tuple(one for stage in self.stages.values() for one in stage if one.chosen)

    @property
    def error_px(self) -> float:
        """Sum of the errors of the plan's methods."""
        return sum(one.error_px or 0.0 for one in self.chosen)

    @property
    def keeps_bounds(self) -> bool:
        """Whether every measured method keeps its bound."""
        return all(one.keeps_bound for stage in self.stages.values() for one in stage)


def measure(plan: Plan, source: Source, *, quick: bool = False, progress: Progress | None = None) -> Measurement:
    """Measure run time and error of every method on a sample of a plan's captures.

    Parameters
    ----------
    source : Source
        Source of the plan, of which the parts of one or two pictures are fetched.
    quick : bool
        Time every method in a single round; times are then not compared.

    Raises
    ------
    PartError, SourceError
        No picture can be made from the source.
    """
    say = progress or (lambda _: None)
    effort = QUICK if quick else THOROUGH
    map_type = plan.mission.imagery.map_types[0]
    say(Message("footprints"))
    stages = {"footprint": _footprints(plan, effort)}
    say(Message("an image"))
    bench = Bench.from_plan(plan, PartCache(source, map_type), effort)
    say(Message("camera frames"))
    by_tiles = plan.grid.centre_decimals is None
    pictures, meshes, kernels = _pictures(bench, by_tiles=by_tiles)
    stages["image"] = pictures
    if meshes:
        stages["pixels"] = meshes
    say(Message("resampling"))
    greys = resampling(plan, bench.tiles, bench.index) if by_tiles else None
    say(Message("file formats"))
    files = tuple(encodings(plan, source, bench.index, map_type, bench.own_picture(), effort))
    wind, effect = plan.mission.wind, None
    if wind is not None and wind.speed_m_per_s > 0.0:
        say(Message("wind"))
        effect = wind_effect(plan)
    say(Message("what was left out"))
    floor = floor_px(positions.bounds_scene(plan))
    return Measurement(
        map_type=map_type,
        stages={stage: tuple(replace(one, floor_px=floor) for one in methods) for stage, methods in stages.items()},
        floor_px=floor,
        kernels=kernels,
        resampling=greys,
        encodings=files,
        wind=effect,
        left_out=tuple(_left_out(bench, stages)),
        planned_px=bench.planned_px,
        timed_px=bench.size_px,
        parts=len(bench.tiles),
    )


def _footprints(plan: Plan, effort: Effort) -> tuple[Measured, ...]:
    # Consecutive captures, as captures of a row share rays.
    few = plan.poses.take(np.arange(min(len(plan), 20_000)))
    camera, ground = plan.mission.camera, plan.ground
    methods = footprint_methods(positions.bounds_scene(plan))
    usable = [method.name for method in methods if not method.outside]
    works = [partial(ground_corners, camera, few, ground, FOOTPRINTS[name]) for name in usable]
    seconds = {name: measured for name, (_, measured) in zip(usable, timed_together(works, effort))}
    chosen = plan.accuracy.footprint.method.name
    return tuple(
        Measured(method)
        if method.outside
        else Measured(
            method,
            positions.footprint_error_px(plan, FOOTPRINTS[method.name]),
            seconds[method.name] * (1.0 / len(few.lat_deg)),
            method.name == chosen,
        )
        for method in methods
    )


def _pictures(bench: Bench, *, by_tiles: bool) -> tuple[tuple[Measured, ...], tuple[Measured, ...], tuple[Kernel, ...]]:
    """Measure map frame and camera frame, meshes of the camera frame, and kernels, all in the same rounds."""
    plan, scene = bench.plan, positions.bounds_scene(bench.plan)
    choice = plan.accuracy.picture
    plane = plan.grid.plane
    bend = plane.frame_bend(scene.poses.lat_deg, scene.poses.lon_deg)
    outside = outside_flat_domain(scene, bend) or positions.map_frame_problem(plan)
    if not outside and choice.rejected is not None and choice.rejected.outside:
        outside = choice.rejected.outside
    on_map = map_frame(scene, outside, plane)
    by_camera = camera_frame(
        scene,
        "" if by_tiles else Message("the source gives images by their centre, not tiles that others can be made from"),
    )
    methods = pixel_methods(plan, scene) if by_tiles else []
    usable = [one for one in methods if not one.method.outside]
    # Lanczos needs a ray for every pixel.
    kernel = plan.mission.accuracy.resampling if plan.mission.accuracy.resampling != BY_RAYS else "bilinear"
    own_tolerance_px = next((one.tolerance_px for one in methods if one.own), None)
    meshes = [Rendering(one.tolerance_px, kernel, one.level) for one in usable]
    kernels = [] if own_tolerance_px is None else [Rendering(own_tolerance_px, name) for name in KERNELS]
    renderings = list(dict.fromkeys([*meshes, *kernels]))
    frames, map_cost = bench.camera_frames(renderings, map_frame=not on_map.outside)
    costs = dict(zip(renderings, frames))
    pictures = [Measured(on_map)]
    if map_cost is not None:
        error, is_chosen = positions.map_frame_error_px(plan), choice.method.name == "map"
        pictures = [Measured(on_map, error, map_cost.seconds, is_chosen, map_cost.size_bytes)]
    if own_tolerance_px is None:
        return (*pictures, Measured(by_camera)), (), ()
    frame = costs[Rendering(own_tolerance_px, plan.mission.accuracy.resampling)]
    traced = positions.mesh_error_px(plan, 0.0)
    pictures.append(Measured(by_camera, traced, frame.seconds, choice.method.name == "camera", frame.size_bytes))
    return (
        tuple(pictures),
        tuple(
            Measured(one.method)
            if one.method.outside
            else Measured(
                one.method,
                _pixels_error_px(plan, one),
                costs[Rendering(one.tolerance_px, kernel, one.level)].seconds,
                one.own and plan.accuracy.pixels is not None,
                costs[Rendering(one.tolerance_px, kernel, one.level)].size_bytes,
            )
            for one in methods
        ),
        tuple(Kernel(way.kernel, costs[way].seconds) for way in kernels),
    )


def _pixels_error_px(plan: Plan, one: PixelMethod) -> float | None:
    if not plan.relief.is_level:
        return positions.relief_error_px(plan, None if one.level else one.tolerance_px)
    # Rays give the camera frame's positions, whose error is counted in that stage.
    return positions.mesh_error_px(plan, one.tolerance_px) if one.tolerance_px else 0.0


class PixelMethod(NamedTuple):
    """A way to place the pixels of a camera frame.

    Attributes
    ----------
    tolerance_px : float
        Tolerance of the mesh, 0 for rays; over relief, tolerance of the rays.
    own : bool
        Whether the plan uses the method.
    level : bool
        Whether relief is ignored.
    """

    method: Method
    tolerance_px: float
    own: bool
    level: bool = False


def pixel_methods(plan: Plan, scene: ImageGeometry) -> list[PixelMethod]:
    """Meshes from coarse to fine, then rays: the method that the plan uses, or would use, and others to compare."""
    if not plan.relief.is_level:
        return _relief_methods(plan, scene)
    others_px = camera_frame(scene).bound_px + exact_footprint(scene).bound_px
    choice = plan.accuracy.pixels or choose_pixels(plan.mission, scene, others_px)
    own_px = 0.0 if choice.method.name == TRACED.name else choice.method.bound_px
    meshes = []
    for tolerance_px in (1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001):
        name, found = f"mesh, {tolerance_px:g} px", mesh(scene, tolerance_px)
        if found.bound_px > tolerance_px:
            # Rounding of the corners to float64 limits how fine a mesh can be.
            outside = f"no mesh is finer than {found.bound_px:.2g} px here"
            meshes.append(PixelMethod(Method("pixels", name, math.inf, math.inf, outside), tolerance_px, False))
        elif tolerance_px != own_px:
            meshes.append(PixelMethod(replace(found, name=name), tolerance_px, False))
    if own_px:
        meshes.append(PixelMethod(choice.method, own_px, True))
        meshes.sort(key=lambda one: one.tolerance_px, reverse=True)
    return [*meshes, PixelMethod(TRACED, 0.0, not own_px)]


def _relief_methods(plan: Plan, scene: ImageGeometry) -> list[PixelMethod]:
    """Level ground, whose error over relief has no bound, and rays over relief from coarse to fine."""
    own_px = plan.accuracy.mesh_tolerance_px
    level = Method("pixels", "level ground", math.inf, math.inf)
    found = [PixelMethod(level, COARSEST_MESH_PX, False, level=True)]
    for tolerance_px in sorted({own_px, 0.1, 0.001}, reverse=True):
        method = replace(relief_rays(scene, own_px), bound_px=tolerance_px)
        if tolerance_px != own_px:
            method = replace(method, name=f"relief, {tolerance_px:g} px")
        found.append(PixelMethod(method, tolerance_px, tolerance_px == own_px))
    return found


def _left_out(bench: Bench, stages: dict[str, tuple[Measured, ...]]) -> list[Saving]:
    """Steps that the plan left out, with their cost compared with what was chosen."""
    plan, found = bench.plan, []
    pictures = len(plan) * len(plan.mission.imagery.map_types)
    compared = {"resampling": ("image", "camera"), Message("rays for every pixel"): ("pixels", "rays")}
    for what, why in plan.accuracy.left_out:
        if what == "wind":
            found.append(Saving(what, why, _seconds_of_flight(plan, bench.effort), True, 0))
            continue
        stage, name = compared[what]
        chosen = next(one for one in stages[stage] if one.chosen)
        other = next(one for one in stages[stage] if one.method.name == name)
        if chosen.seconds is not None and other.seconds is not None:
            seconds = (other.seconds - chosen.seconds) * pictures
            size = (other.size_bytes or 0) - (chosen.size_bytes or 0)
            found.append(Saving(what, why, seconds, other.seconds.is_distinct(chosen.seconds), size * pictures))
    return found


def _seconds_of_flight(plan: Plan, effort: Effort) -> Seconds:
    """Time to compute the poses of a whole plan in wind; in typical wind if the mission has no gusts."""
    wind, airspeed = plan.mission.wind, plan.mission.flight.airspeed_m_per_s
    if wind is None or wind.sigma_m_per_s == 0.0:
        wind, airspeed = Wind(5.0, 0.0, 0.15), Flight.airspeed_m_per_s
    gusty, count = wind, min(len(plan), 20_000)
    agl = plan.agl_m[:count]
    route = legs(plan.lat_deg[:count], plan.lon_deg[:count])
    interval_s = intervals_s(route, agl, airspeed, gusty)
    _, seconds = timed(lambda: fly(gusty, airspeed, interval_s, route.headings_deg(), agl), effort)
    return seconds * (len(plan) / count)
