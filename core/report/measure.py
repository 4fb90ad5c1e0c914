"""Run time and error of every method, measured on the captures of a plan."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message
from ..geodesy.accuracy import outside_flat_domain
from ..geodesy.footprint import ground_corners
from ..imagery.source import Source
from ..mission.flight.legs import intervals_s, legs
from ..mission.flight.motion import fly
from ..mission.flight.wind import Wind
from ..mission.methods import Method, camera_frame, map_frame
from ..mission.parts import Flight
from ..mission.plan import Plan
from ..picture.resampling import KERNELS
from ..timing import ORDER_SEED, QUICK, THOROUGH, Effort, Seconds, timed, timed_together
from . import positions
from .footprints import FOOTPRINTS, footprint_methods
from .pictures import BY_RAYS, Bench, Encoding, PartCache, Rendering, Resampling, encodings, resampling
from .pixels import pixel_methods
from .positions import floor_px
from .wind import WindEffect, wind_effect

#: Called with the name of each step.
Progress = Callable[[str], None]


class ErrorSpread(NamedTuple):
    """Distribution of errors in px: median, 95 % and greatest, and the quantiles at 0, 1, … 100 %."""

    median: float
    usual: float
    most: float
    quantiles: tuple[float, ...]

    @classmethod
    def from_values(cls, values: Floats) -> ErrorSpread | None:
        """Distribution of values (n,); None without any."""
        if not values.size:
            return None
        found = tuple(np.quantile(values, np.linspace(0.0, 1.0, 101)).tolist())
        return cls(found[50], found[95], found[-1], found)


@dataclass(frozen=True)
class Measured:
    """A method with its errors and its run time on captures of a mission.

    Attributes
    ----------
    method : Method
        With its bound; not measured if it is not usable, for the reason in `Method.outside`.
    error_px : float or None
        Greatest error.
    seconds : Seconds or None
        For a capture on one core, without fetching and encoding; methods of a stage are timed in the same rounds.
    chosen : bool
        Whether the plan uses it.
    size_bytes : int or None
        Size of an image file, for methods that make one.
    floor_px : float
        Error of the reference.
    errors : ErrorSpread or None
        Distribution of the errors.
    own_reached_px : float or None
        Bound that a mesh reaches on the measured captures, which may be far below its tolerance.
    same_px : tuple of float
        Other tolerances that give the same positions.
    """

    method: Method
    error_px: float | None = None
    seconds: Seconds | None = None
    chosen: bool = False
    size_bytes: int | None = None
    floor_px: float = 0.0
    errors: ErrorSpread | None = None
    own_reached_px: float | None = None
    same_px: tuple[float, ...] = ()

    @property
    def reached_px(self) -> float:
        """Bound that is reached: the method's, or less."""
        return self.method.bound_px if self.own_reached_px is None else self.own_reached_px

    @property
    def keeps_bound(self) -> bool:
        """Whether the error is within the bound reached, up to the error of the reference; true without an error."""
        return self.error_px is None or self.error_px <= min(self.reached_px, self.method.bound_px) + self.floor_px


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
class WholeImage:
    """All that makes an image file: a method of each stage, and a file format."""

    methods: tuple[Measured, ...]
    encoding: Encoding
    seconds: Seconds

    @classmethod
    def joined(cls, methods: Sequence[Measured], taking: Sequence[Measured], encoding: Encoding) -> WholeImage | None:
        """Whole image by methods, whose time is that of some of them and of the format; None if one was not timed."""
        seconds = encoding.seconds
        for one in taking:
            if one.seconds is None:
                return None
            seconds = seconds + one.seconds
        return cls(tuple(methods), encoding, seconds)

    @property
    def reached_px(self) -> float:
        """Sum of the bounds reached."""
        return sum(one.reached_px for one in self.methods)

    @property
    def error_px(self) -> float:
        """Sum of the greatest errors."""
        return sum(one.error_px or 0.0 for one in self.methods)

    @property
    def chosen(self) -> bool:
        """Whether the plan uses the methods and the format."""
        return self.encoding.chosen and all(one.chosen for one in self.methods)


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
    seeds : dict of str to int
        Seeds of all that is random.
    load : tuple of float
        Load of the machine, processes of the last minute, before and after; empty where the system does not count them.
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
    seeds: dict[str, int]
    load: tuple[float, ...]

    @property
    def chosen(self) -> tuple[Measured, ...]:
        """Methods of the plan."""
        return tuple(one for stage in self.stages.values() for one in stage if one.chosen)

    @property
    def error_px(self) -> float:
        """Sum of the greatest errors of the plan's methods."""
        return sum(one.error_px or 0.0 for one in self.chosen)

    @property
    def reached_px(self) -> float:
        """Sum of the bounds that the plan's methods reach."""
        return sum(one.reached_px for one in self.chosen)

    @cached_property
    def pipelines(self) -> tuple[WholeImage, ...]:
        """Ways to make an image file, from cheap to exact in the mission's format, then the plan's in other formats."""
        footprint = next(one for one in self.stages["footprint"] if one.chosen)
        on_map, camera = (
            next((one for one in self.stages["image"] if one.method.name == name), None) for name in ("map", "camera")
        )
        ways: list[tuple[Measured, ...]] = [] if on_map is None else [(on_map,)]
        if camera is not None:
            ways += [(camera, one) for one in self.stages.get("pixels", ())]
        found = (
            # The time of pixels is that of the whole camera frame.
            WholeImage.joined((footprint, *way), (footprint, way[-1]), encoding)
            for encoding in sorted(self.encodings, key=lambda one: not one.chosen)
            for way in ways
            if encoding.chosen or all(one.chosen for one in way)
        )
        return tuple(one for one in found if one is not None)

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
    InvalidInput
        Images have lenses of their own.
    PartError, SourceError
        No picture can be made from the source.
    """
    if plan.cameras.vary:
        raise InvalidInput(
            "vary {0!r}: methods are measured with one camera",
            str(plan.mission.varied.of_lens[0]),
            field="vary",
            remedy="choose other fields",
        )
    say, load = progress or (lambda _: None), _load()
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
    files = tuple(encodings(bench, effort))
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
        seeds={
            "landscape": plan.mission.imagery.seed,
            **({"wind": wind.seed} if wind is not None else {}),
            "order of rounds": ORDER_SEED,
        },
        load=(*load, *_load()),
    )


def _load() -> tuple[float, ...]:
    """Load of the machine in the last minute; empty where the system does not count it."""
    try:
        return os.getloadavg()[:1]
    except (AttributeError, OSError):
        return ()


def _measured(
    method: Method, errors_px: Floats, seconds: Seconds | None, *, chosen: bool, size: int | None = None
) -> Measured:
    errors = ErrorSpread.from_values(errors_px)
    return Measured(method, errors.most if errors else None, seconds, chosen, size, errors=errors)


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
        else _measured(
            method,
            positions.footprint_errors_px(plan, FOOTPRINTS[method.name]),
            seconds[method.name] * (1.0 / len(few.lat_deg)),
            chosen=method.name == chosen,
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
    # Lanczos needs a ray for every pixel.
    kernel = plan.mission.accuracy.resampling if plan.mission.accuracy.resampling != BY_RAYS else "bilinear"
    own_tolerance_px = next((one.tolerance_px for one in methods if one.own), None)
    kernels = [] if own_tolerance_px is None else [Rendering(own_tolerance_px, name) for name in KERNELS]
    ways = [one.rendering._replace(kernel=kernel) for one in methods]
    renderings = list(dict.fromkeys([*ways, *kernels]))
    frames, map_cost = bench.camera_frames(renderings, map_frame=not on_map.outside)
    costs = dict(zip(renderings, frames))
    pictures = [Measured(on_map)]
    if map_cost is not None:
        errors_px, chosen = positions.map_frame_errors_px(plan), choice.method.name == "map"
        pictures = [_measured(on_map, errors_px, map_cost.seconds, chosen=chosen, size=map_cost.size_bytes)]
    if own_tolerance_px is None:
        return (*pictures, Measured(by_camera)), (), ()
    frame = costs[Rendering(own_tolerance_px, plan.mission.accuracy.resampling)]
    errors_px, chosen = positions.mesh_errors(plan, 0.0).errors_px, choice.method.name == "camera"
    pictures.append(_measured(by_camera, errors_px, frame.seconds, chosen=chosen, size=frame.size_bytes))
    pixels = []
    for one, way in zip(methods, ways):
        cost, chosen = costs[way], one.own and plan.accuracy.pixels is not None
        measured = _measured(one.method, one.errors_px, cost.seconds, chosen=chosen, size=cost.size_bytes)
        pixels.append(replace(measured, own_reached_px=one.reached_px, same_px=one.same_px))
    return tuple(pictures), tuple(pixels), tuple(Kernel(way.kernel, costs[way].seconds) for way in kernels)


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
