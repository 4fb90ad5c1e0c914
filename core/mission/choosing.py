"""The kind of picture and the methods a mission is worked out with: the cheapest that fit its error budget."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..geodesy import accuracy
from ..geodesy.accuracy import Scene
from ..geodesy.mercator import PixelGrid
from ..geodesy.poses import Poses
from .area import Points
from .choices import AUTO
from .framing import CameraFraming, Framed, MapFraming, check_sizes, check_windows, framed, ground_of
from .layout import Layout
from .mission import Mission
from .rungs import (
    Accuracy,
    Choice,
    Rung,
    bound_text,
    choose,
    footprint_rungs,
    mesh_rungs,
    picture_rungs,
    too_much,
)
from .turned import is_turned

Floats = NDArray[np.float64]
Disturbed = Callable[[Layout, Poses], Poses]

_NO_CAMERA_FRAME = "the source gives pictures by their centre, not tiles that others can be made from"
_WIND = "wind turns the camera"
_TURNED = "the rows are turned from east, and the camera with them"


def choose_methods(mission: Mission, grid: PixelGrid, disturbed: Disturbed) -> tuple[Framed, Accuracy]:
    """Frame a mission with the cheapest methods whose bounds sum within its error budget.

    Raises
    ------
    InvalidInput
        Where none fit and the mission does not accept that; where a method that it names has no bound; and as `plan`
        does.
    """
    camera_outside = _NO_CAMERA_FRAME if grid.centre_decimals is not None else ""
    gusty = mission.wind is not None and mission.wind.sigma_m_per_s > 0.0
    map_outside = (
        _TURNED if is_turned(mission) else _WIND if gusty else accuracy.outside_flat_domain(_ends(mission))
    )
    turned_away: Choice | None = None
    if mission.frame != "camera":
        if not map_outside:
            flown = framed(mission, grid, MapFraming(mission, grid), disturbed)
            check_sizes(flown, mission, grid)
            try:
                check_windows(flown, mission, grid)
            except InvalidInput as wrong:
                if mission.frame == "map" or camera_outside:
                    raise
                # A camera's image has no such limits, or is refused for its own.
                map_outside = str(wrong).partition(";")[0]
        if not map_outside:
            scene = scene_of(mission, flown)
            _check_resolved(scene)
            picture = picture_rungs(scene)[0]
            found = choose(
                mission.error_budget_px, [[picture], footprint_rungs(scene)], ["map", mission.footprint]
            )
            if found is not None:
                choices, _ = found
                return flown, _accuracy(mission, scene, choices[1], choices[0], None)
            least = min(rung.bound_px for rung in _allowed(footprint_rungs(scene), mission.footprint))
            turned_away = Choice(picture, picture, too_much(picture.bound_px, least, mission.error_budget_px))
            if mission.frame == "map" or camera_outside:
                return _beyond_budget(mission, flown, [picture], None)
        elif mission.frame == "map":
            raise InvalidInput(f"picture 'map' was asked for, but has no bound here: {map_outside}", "frame")
        else:
            rung = Rung("picture", "map", math.inf, math.inf, map_outside)
            turned_away = Choice(rung, rung, map_outside)
    if camera_outside:
        raise InvalidInput(
            f"picture as the camera sees it: {camera_outside}; choose a source of tiles", "source"
        )
    flown = framed(mission, grid, CameraFraming(mission, grid), disturbed)
    check_windows(flown, mission, grid)
    scene = scene_of(mission, flown)
    _check_resolved(scene)
    picture = picture_rungs(scene)[1]
    ladders = [[picture], mesh_rungs(scene), footprint_rungs(scene)]
    found = choose(mission.error_budget_px, ladders, ["camera", mission.mesh, mission.footprint])
    if found is None:
        return _beyond_budget(mission, flown, [picture], turned_away)
    picture_choice, mesh_choice, footprint_choice = found[0]
    if turned_away is not None:
        picture_choice = replace(picture_choice, rejected=turned_away.rejected, reason=turned_away.reason)
    return flown, _accuracy(mission, scene, footprint_choice, picture_choice, mesh_choice)


def scene_of(mission: Mission, flown: Framed) -> Scene:
    """What the bounds of a framed mission depend on, once for each run of poses that share it."""
    first, _ = flown.poses.runs()
    poses = flown.poses.take(first)
    if flown.size_px is not None:
        return Scene(
            mission.camera, float(flown.size_px[0]), float(flown.size_px[1]), poses, ground_of(mission)
        )
    # Pictures of one row differ by a pixel at most, as each edge is rounded on its own.
    width, height = (
        np.asarray(size[first], np.float64) + 1.0
        for size in (flown.windows.width_px, flown.windows.height_px)
    )
    return Scene(mission.camera, width, height, poses, ground_of(mission))


def _check_resolved(scene: Scene) -> None:
    finest = float(np.min(accuracy.finest_px_m(scene)))
    if finest < accuracy.RESOLVED_M:
        raise InvalidInput(
            f"pixels of {finest:.2g} m on the ground: degrees in float64 resolve {accuracy.RESOLVED_M:g} m; fly "
            "higher or widen the field of view",
            "agl_m",
        )


def _ends(mission: Mission) -> Scene:
    """Scene of the captures whose flat model is stretched most, before any is placed; of any image size."""
    area = mission.area
    if isinstance(area, Points):
        lat, _, agl = np.array(area.poses, np.float64).reshape(-1, 3).T
        # The domain is the same at any yaw.
    else:
        lat = np.array([area.bounds.north_deg, area.bounds.south_deg])
        agl = np.full(2, mission.agl_m)
    attitude = (mission.yaw_deg, mission.tilt_deg, mission.roll_deg)
    return Scene(
        mission.camera, 1.0, 1.0, Poses.turned(lat, np.zeros_like(lat), agl, *attitude), ground_of(mission)
    )


def _allowed(ladder: list[Rung], name: str) -> list[Rung]:
    return [rung for rung in ladder if name in (AUTO, rung.name)]


def _beyond_budget(
    mission: Mission, flown: Framed, pictures: list[Rung], turned_away: Choice | None
) -> tuple[Framed, Accuracy]:
    """Return the most accurate combination where the mission accepts it, else say how far off it is."""
    scene = scene_of(mission, flown)
    ladders = [pictures, footprint_rungs(scene)]
    if flown.size_px is not None:
        ladders.append(mesh_rungs(scene))
    wanted = [AUTO, mission.footprint, mission.mesh]
    best = [
        min(_allowed(ladder, name), key=lambda rung: rung.bound_px) for ladder, name in zip(ladders, wanted)
    ]
    total = sum(rung.bound_px for rung in best)
    budget = mission.error_budget_px
    if not mission.accept_error:
        methods = ", ".join(f"{rung.stage} {rung.name}" for rung in best)
        raise InvalidInput(
            f"error budget {budget:g} px: no methods fit; the closest are {methods} with {bound_text(total)} px, "
            f"{bound_text(total / budget)} times as much; raise --error-budget, or go on with --accept-error",
            "error_budget_px",
        )
    picture, footprint, *rest = (Choice(rung) for rung in best)
    if turned_away is not None:
        picture = replace(picture, rejected=turned_away.rejected, reason=turned_away.reason)
    return flown, _accuracy(mission, scene, footprint, picture, rest[0] if rest else None)


def _accuracy(
    mission: Mission, scene: Scene, footprint: Choice, picture: Choice, mesh: Choice | None
) -> Accuracy:
    return Accuracy(
        budget_px=mission.error_budget_px,
        footprint=footprint,
        picture=picture,
        mesh=mesh,
        condition=accuracy.condition_number(scene),
        terrain_px_per_m=accuracy.terrain_px_per_m(scene),
        left_out=tuple(_left_out(mission, footprint.rung, picture.rung, mesh)),
    )


def _left_out(mission: Mission, footprint: Rung, picture: Rung, mesh: Choice | None) -> list[tuple[str, str]]:
    found = []
    if picture.name == "map":
        found.append(("resampling", "a map frame shows the source's own pixels"))
    if mesh is not None and mesh.rung.name != "rays":
        found.append(
            ("rays for every pixel", f"the mesh's bound of {bound_text(mesh.rung.bound_px)} px fits")
        )
    if footprint.name != "exact":
        found.append(
            ("exact footprints", f"the bound of {footprint.name}, {bound_text(footprint.bound_px)} px, fits")
        )
    if mission.wind is None or mission.wind.sigma_m_per_s == 0.0:
        found.append(
            ("wind", "air without gusts was asked for" if mission.wind else "still air was asked for")
        )
    return found
