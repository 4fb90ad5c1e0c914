"""Every method of every stage timed and measured on the captures of one plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..capture.resample import KERNELS
from ..geodesy.accuracy import outside_flat_domain
from ..geodesy.footprint import ground_corners
from ..imagery.source import Source
from ..mission.framing import ground_of
from ..mission.plan import Plan
from ..mission.rungs import (
    MESH_TOLERANCES_PX,
    Rung,
    footprint_rungs,
    mesh_rungs,
    picture_rungs,
)
from . import geometry
from .bench import BY_RAYS, Bench, Way
from .flight import Flight, interval_of, measure_flight, seconds_of_flight
from .greys import Encoding, Resampling, encodings, resampling
from .reference import floor_px
from .tiles import Tiles
from .timing import QUICK, THOROUGH, Effort, timed_together

Pixels = NDArray[np.uint8]
#: Called with what is being measured, in words.
Progress = Callable[[str], None]

#: Captures whose footprints are timed: neighbours, as rows share their rays.
_FOOTPRINTS_TIMED = 20_000
#: Kernel that meshes are timed with where the mission's own needs a ray for every pixel.
_OF_MESHES = "bilinear"
_BY_CENTRE = "the source gives pictures by their centre, not tiles that others can be made from"


@dataclass(frozen=True)
class Measured:
    """A method, its greatest error and its time on a mission's own captures.

    Attributes
    ----------
    rung : Rung
        With the bound; `Rung.outside` says why there is none, and then nothing was measured.
    error_px : float or None
    seconds : float or None
        A capture, on one core, without fetching and encoding.
    chosen : bool
        By the plan.
    size_bytes : int or None
        Of the file of a picture, where the method makes one.
    """

    rung: Rung
    error_px: float | None = None
    seconds: float | None = None
    chosen: bool = False
    size_bytes: int | None = None

    @property
    def within(self) -> bool:
        """Whether the error is within the bound; of a method without an error, too."""
        return self.error_px is None or self.error_px <= self.rung.bound_px


@dataclass(frozen=True)
class Kernel:
    """Seconds of one camera frame by one resampling kernel."""

    name: str
    seconds: float


@dataclass(frozen=True)
class Saving:
    """What the plan left out, and what that saves for the whole mission."""

    what: str
    why: str
    seconds: float
    size_bytes: int


@dataclass(frozen=True)
class Measurement:
    """All that is measured of a plan.

    Attributes
    ----------
    map_type : str
    stages : dict of str to tuple of Measured
        By the stage's name, from cheap to exact.
    floor_px : float
        Error of the reference: smaller ones are not told from none.
    terrain, condition : see `Accuracy`
    kernels : tuple of Kernel
        Empty where the source has no tiles; so are the next two None and empty.
    resampling : Resampling or None
    encodings : tuple of Encoding
    flight : Flight or None
        None in still air.
    left_out : tuple of Saving
    planned_px, timed_px : tuple of int
        Width and height of the planned picture, and of the one whose seconds and bytes were scaled to it.
    parts : int
        Of the source that were fetched.
    """

    map_type: str
    stages: dict[str, tuple[Measured, ...]]
    floor_px: float
    kernels: tuple[Kernel, ...]
    resampling: Resampling | None
    encodings: tuple[Encoding, ...]
    flight: Flight | None
    left_out: tuple[Saving, ...]
    planned_px: tuple[int, int]
    timed_px: tuple[int, int]
    parts: int

    @property
    def chosen(self) -> tuple[Measured, ...]:
        """The methods of the plan."""
        return tuple(one for stage in self.stages.values() for one in stage if one.chosen)

    @property
    def error_px(self) -> float:
        """Sum of the errors of the methods of the plan."""
        return sum(one.error_px or 0.0 for one in self.chosen)

    @property
    def within(self) -> bool:
        """Whether every method that was measured kept its bound."""
        return all(one.within for stage in self.stages.values() for one in stage)


def measure(
    plan: Plan,
    source: Source,
    *,
    map_type: str | None = None,
    quick: bool = False,
    progress: Progress | None = None,
) -> Measurement:
    """Time and measure every method on a sample of a plan's captures.

    Parameters
    ----------
    plan : Plan
    source : Source
        That the plan is for: the parts of one or two pictures are fetched.
    map_type : str, optional
        Of the pictures; the mission's first one without it.
    quick : bool
        Time every method once instead of until the median settles.
    progress : callable, optional

    Raises
    ------
    PartError, SourceError
        Where no picture can be had from the source.
    """
    say = progress or (lambda _: None)
    effort = QUICK if quick else THOROUGH
    map_type = map_type or plan.mission.map_types[0]
    say("footprints")
    stages = {"footprint": _footprints(plan, effort)}
    say("a picture")
    bench = Bench.of(plan, Tiles(source, map_type), effort)
    say("camera frames")
    meshes = _meshes(bench)
    stages["picture"] = _pictures(bench, meshes)
    if meshes:
        stages["mesh"] = meshes
    say("resampling")
    by_tiles = plan.grid.centre_decimals is None
    kernels = _kernels(bench) if by_tiles else ()
    greys = resampling(plan, bench.tiles, bench.index) if by_tiles else None
    say("file formats")
    files = tuple(encodings(plan, source, bench.index, map_type, bench.own_picture(), effort))
    wind, flight = plan.mission.wind, None
    if wind is not None and wind.sigma_m_per_s > 0.0:
        say("wind")
        agl_m = float(np.median(plan.agl_m))
        flight = measure_flight(wind, plan.mission.airspeed_m_per_s, interval_of(plan), agl_m, effort)
    say("what was left out")
    return Measurement(
        map_type=map_type,
        stages=stages,
        floor_px=floor_px(geometry.bounds_scene(plan)),
        kernels=kernels,
        resampling=greys,
        encodings=files,
        flight=flight,
        left_out=tuple(_left_out(bench, stages)),
        planned_px=bench.planned_px,
        timed_px=bench.size_px,
        parts=len(bench.tiles),
    )


def _footprints(plan: Plan, effort: Effort) -> tuple[Measured, ...]:
    few = plan.poses.take(np.arange(min(len(plan), _FOOTPRINTS_TIMED)))
    camera, ground = plan.mission.camera, ground_of(plan.mission)
    rungs = footprint_rungs(geometry.bounds_scene(plan))
    usable = [rung for rung in rungs if not rung.outside]
    works = [partial(ground_corners, camera, few, ground, rung.name) for rung in usable]
    seconds = {rung: taken for rung, (_, taken) in zip(usable, timed_together(works, effort))}
    chosen = plan.accuracy.footprint.rung.name
    return tuple(
        Measured(rung)
        if rung.outside
        else Measured(
            rung,
            geometry.footprint_error_px(plan, rung.name),
            seconds[rung] / len(few.lat_deg),
            rung.name == chosen,
        )
        for rung in rungs
    )


def _meshes(bench: Bench) -> tuple[Measured, ...]:
    plan = bench.plan
    if plan.grid.centre_decimals is not None:
        return ()
    kernel = plan.mission.resampling if plan.mission.resampling != BY_RAYS else _OF_MESHES
    chosen = plan.accuracy.mesh.rung.name if plan.accuracy.mesh else ""
    rungs = mesh_rungs(geometry.bounds_scene(plan))
    ladder = list(zip(rungs, (*MESH_TOLERANCES_PX, 0.0)))
    usable = [(rung, tolerance) for rung, tolerance in ladder if not rung.outside]
    frames = bench.camera_frames([Way(tolerance, kernel) for _, tolerance in usable])
    made = {rung: frame for (rung, _), frame in zip(usable, frames)}
    return tuple(
        Measured(rung)
        if rung.outside
        else Measured(
            rung,
            # Rays are the camera frame's own positions, whose error is that of the picture.
            geometry.mesh_error_px(plan, tolerance) if tolerance else 0.0,
            made[rung].seconds,
            rung.name == chosen,
            made[rung].size_bytes,
        )
        for rung, tolerance in ladder
    )


def _usual_mesh(plan: Plan, meshes: tuple[Measured, ...]) -> Measured:
    """Return the mesh that the plan has, or that it would have: the coarsest within the budget."""
    for one in meshes:
        if one.chosen:
            return one
    usable = [one for one in meshes if one.rung.bound_px <= plan.accuracy.budget_px]
    return (usable or list(meshes))[0 if usable else -1]


def _pictures(bench: Bench, meshes: tuple[Measured, ...]) -> tuple[Measured, ...]:
    """Map frame and camera frame."""
    plan, scene = bench.plan, geometry.bounds_scene(bench.plan)
    own = plan.accuracy.picture
    outside = outside_flat_domain(scene) or geometry.map_frame_problem(plan)
    if not outside and own.rejected is not None and own.rejected.outside:
        outside = own.rejected.outside
    camera_outside = "" if meshes else _BY_CENTRE
    on_map, by_camera = picture_rungs(scene, map_outside=outside, camera_outside=camera_outside)
    found = [Measured(on_map)]
    if not on_map.outside:
        made, error = bench.map_frame(), geometry.map_frame_error_px(plan)
        found = [Measured(on_map, error, made.seconds, own.rung.name == "map", made.size_bytes)]
    if not meshes:
        return (*found, Measured(by_camera))
    usual, traced = _usual_mesh(plan, meshes), geometry.mesh_error_px(plan, 0.0)
    return (
        *found,
        Measured(by_camera, traced, usual.seconds, own.rung.name == "camera", usual.size_bytes),
    )


def _kernels(bench: Bench) -> tuple[Kernel, ...]:
    """Seconds of a camera frame by each kernel, through the mesh the plan has or would have."""
    choice = bench.plan.accuracy.mesh
    tolerance = bench.plan.accuracy.mesh_tolerance_px if choice else _tolerance_within(bench.plan)
    frames = bench.camera_frames([Way(tolerance, name) for name in KERNELS])
    return tuple(Kernel(name, frame.seconds) for name, frame in zip(KERNELS, frames))


def _tolerance_within(plan: Plan) -> float:
    rungs = zip(mesh_rungs(geometry.bounds_scene(plan)), (*MESH_TOLERANCES_PX, 0.0))
    return next((tolerance for rung, tolerance in rungs if rung.bound_px <= plan.accuracy.budget_px), 0.0)


def _left_out(bench: Bench, stages: dict[str, tuple[Measured, ...]]) -> list[Saving]:
    """What the plan left out, with what the same thing takes here beside what was chosen."""
    plan, found = bench.plan, []
    pictures = len(plan) * len(plan.mission.map_types)
    for what, why in plan.accuracy.left_out:
        if what == "exact footprints":
            seconds, _ = _difference(stages["footprint"], "exact")
            found.append(Saving(what, why, seconds * len(plan), 0))
        elif what == "wind":
            found.append(Saving(what, why, seconds_of_flight(plan, bench.effort), 0))
        elif (what == "resampling" and "mesh" in stages) or what == "rays for every pixel":
            stage, name = ("picture", "camera") if what == "resampling" else ("mesh", "rays")
            seconds, size = _difference(stages[stage], name)
            found.append(Saving(what, why, seconds * pictures, size * pictures))
    return found


def _difference(stage: tuple[Measured, ...], name: str) -> tuple[float, int]:
    """Seconds and bytes by which a method of a stage takes more than the chosen one."""
    chosen = next(one for one in stage if one.chosen)
    other = next(one for one in stage if one.rung.name == name)
    return (
        (other.seconds or 0.0) - (chosen.seconds or 0.0),
        (other.size_bytes or 0) - (chosen.size_bytes or 0),
    )
