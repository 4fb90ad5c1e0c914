"""Every method of every stage timed and measured on the captures of one plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ..capture.resample import KERNELS
from ..geodesy.accuracy import outside_flat_domain
from ..geodesy.footprint import ground_corners
from ..imagery.source import Source
from ..mission.choices import MESH_TOLERANCES_PX
from ..mission.framing import ground_of
from ..mission.plan import Plan
from ..mission.rungs import Rung, footprint_rungs, mesh_rungs, picture_rungs
from . import geometry
from .bench import BY_RAYS, Bench, Way
from .flight import Flight, interval_of, measure_flight, seconds_of_flight
from .greys import Encoding, Resampling, encodings, resampling
from .reference import floor_px
from .tiles import Tiles
from .timing import QUICK, THOROUGH, Effort, Seconds, timed_together
from .wind import WindEffect, wind_effect

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
    seconds : Seconds or None
        A capture, on one core, without fetching and encoding; those of a stage were timed in the same rounds.
    chosen : bool
        By the plan.
    size_bytes : int or None
        Of the file of a picture, where the method makes one.
    floor_px : float
        Error of the reference that the error was measured against.
    """

    rung: Rung
    error_px: float | None = None
    seconds: Seconds | None = None
    chosen: bool = False
    size_bytes: int | None = None
    floor_px: float = 0.0

    @property
    def within(self) -> bool:
        """Whether the error is within the bound, as far as the reference can tell; of a method without one, too."""
        return self.error_px is None or self.error_px <= self.rung.bound_px + self.floor_px


def compared_with(stage: Sequence[Measured]) -> Measured | None:
    """Return the method of a stage that the others' times are compared with: the chosen one, or else the cheapest."""
    timed = [one for one in stage if one.seconds is not None]
    return next((one for one in timed if one.chosen), timed[0] if timed else None)


@dataclass(frozen=True)
class Kernel:
    """Seconds of one camera frame by one resampling kernel."""

    name: str
    seconds: Seconds


@dataclass(frozen=True)
class Saving:
    """What the plan left out, and what that saves for the whole mission.

    Attributes
    ----------
    what, why : str
    seconds : Seconds
        By how much more it takes than what was chosen, round by round.
    told : bool
        Whether the two can be told apart in time.
    size_bytes : int
    """

    what: str
    why: str
    seconds: Seconds
    told: bool
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
    wind : WindEffect or None
        None in still air.
    flight : Flight or None
        None in air without gusts.
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
    wind: WindEffect | None
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
        Time every method in one round only; times are then not compared.
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
    by_tiles = plan.grid.centre_decimals is None
    pictures, meshes, kernels = _pictures(bench, by_tiles=by_tiles)
    stages["picture"] = pictures
    if meshes:
        stages["mesh"] = meshes
    say("resampling")
    greys = resampling(plan, bench.tiles, bench.index) if by_tiles else None
    say("file formats")
    files = tuple(encodings(plan, source, bench.index, map_type, bench.own_picture(), effort))
    wind, effect, flight = plan.mission.wind, None, None
    if wind is not None and wind.speed_m_per_s > 0.0:
        say("wind")
        effect = wind_effect(plan)
    if wind is not None and wind.sigma_m_per_s > 0.0:
        agl_m = float(np.median(plan.agl_m))
        flight = measure_flight(wind, plan.mission.airspeed_m_per_s, interval_of(plan), agl_m, effort)
    say("what was left out")
    floor = floor_px(geometry.bounds_scene(plan))
    return Measurement(
        map_type=map_type,
        stages={
            stage: tuple(replace(one, floor_px=floor) for one in methods) for stage, methods in stages.items()
        },
        floor_px=floor,
        kernels=kernels,
        resampling=greys,
        encodings=files,
        wind=effect,
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
            seconds[rung] * (1.0 / len(few.lat_deg)),
            rung.name == chosen,
        )
        for rung in rungs
    )


def _pictures(
    bench: Bench, *, by_tiles: bool
) -> tuple[tuple[Measured, ...], tuple[Measured, ...], tuple[Kernel, ...]]:
    """Map frame and camera frame, the camera frame's meshes, and its kernels: all timed in the same rounds."""
    plan, scene = bench.plan, geometry.bounds_scene(bench.plan)
    own = plan.accuracy.picture
    outside = outside_flat_domain(scene) or geometry.map_frame_problem(plan)
    if not outside and own.rejected is not None and own.rejected.outside:
        outside = own.rejected.outside
    on_map, by_camera = picture_rungs(
        scene, map_outside=outside, camera_outside="" if by_tiles else _BY_CENTRE
    )
    ladder = list(zip(mesh_rungs(scene), (*MESH_TOLERANCES_PX, 0.0))) if by_tiles else []
    usable = [(rung, tolerance) for rung, tolerance in ladder if not rung.outside]
    usual = _usual_mesh(plan, usable)
    kernel = plan.mission.resampling if plan.mission.resampling != BY_RAYS else _OF_MESHES
    meshes = [Way(tolerance, kernel) for _, tolerance in usable]
    kernels = [Way(usual[1], name) for name in KERNELS] if usual else []
    ways = list(dict.fromkeys([*meshes, *kernels]))
    frames, map_frame = bench.camera_frames(ways, map_frame=not on_map.outside)
    made = dict(zip(ways, frames))
    chosen = plan.accuracy.mesh.rung.name if plan.accuracy.mesh else ""
    pictures = [Measured(on_map)]
    if map_frame is not None:
        error = geometry.map_frame_error_px(plan)
        pictures = [Measured(on_map, error, map_frame.seconds, own.rung.name == "map", map_frame.size_bytes)]
    if usual is None:
        return (*pictures, Measured(by_camera)), (), ()
    frame = made[Way(usual[1], plan.mission.resampling)]
    traced = geometry.mesh_error_px(plan, 0.0)
    pictures.append(Measured(by_camera, traced, frame.seconds, own.rung.name == "camera", frame.size_bytes))
    return (
        tuple(pictures),
        tuple(
            Measured(rung)
            if rung.outside
            else Measured(
                rung,
                # Rays are the camera frame's own positions, whose error is that of the picture.
                geometry.mesh_error_px(plan, tolerance) if tolerance else 0.0,
                made[Way(tolerance, kernel)].seconds,
                rung.name == chosen,
                made[Way(tolerance, kernel)].size_bytes,
            )
            for rung, tolerance in ladder
        ),
        tuple(Kernel(way.kernel, made[way].seconds) for way in kernels),
    )


def _usual_mesh(plan: Plan, usable: list[tuple[Rung, float]]) -> tuple[Rung, float] | None:
    """Return the mesh that the plan has, or that it would have: the coarsest within the budget, else the finest."""
    chosen = plan.accuracy.mesh
    wanted = [
        (rung, tolerance)
        for rung, tolerance in usable
        if (rung.name == chosen.rung.name if chosen else rung.bound_px <= plan.accuracy.budget_px)
    ]
    return next(iter([*wanted, *usable[-1:]]), None)


def _left_out(bench: Bench, stages: dict[str, tuple[Measured, ...]]) -> list[Saving]:
    """What the plan left out, with what the same thing takes here beside what was chosen."""
    plan, found = bench.plan, []
    pictures = len(plan) * len(plan.mission.map_types)
    beside = {
        "exact footprints": ("footprint", "exact", len(plan)),
        "resampling": ("picture", "camera", pictures),
        "rays for every pixel": ("mesh", "rays", pictures),
    }
    for what, why in plan.accuracy.left_out:
        if what == "wind":
            found.append(Saving(what, why, seconds_of_flight(plan, bench.effort), True, 0))
            continue
        stage, name, count = beside[what]
        chosen = next(one for one in stages[stage] if one.chosen)
        other = next(one for one in stages[stage] if one.rung.name == name)
        if chosen.seconds is not None and other.seconds is not None:
            seconds = (other.seconds - chosen.seconds) * count
            size = (other.size_bytes or 0) - (chosen.size_bytes or 0)
            found.append(Saving(what, why, seconds, other.seconds.told_from(chosen.seconds), size * count))
    return found
