"""Several missions flown as one: one take-off and landing, with safe transits from mission to mission."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Floats, Numbers
from ...errors import InvalidInput, Message
from ...fields import declared_fields, field_named
from ...geodesy.camera import Poses
from ...geodesy.footprint import Corners, Outline
from ...geodesy.frames import Windows
from ...geodesy.mercator import wrap_lon_deg
from ...text.ranges import ranges_text, read_ranges
from ..areas.area import Box
from ..estimate import duration_text, length_text
from ..lenses import CaptureCameras
from ..mission import Mission
from ..parts import FIRST, Flight, Route, Terrain
from ..plan import Plan
from ..profile import height_profile
from ..relief.ground import Flown, Heights, Relief, level_ground
from .legs import legs
from .pilot import airborne_s, airborne_text, batteries, sorties_text

#: Room around captures, degrees, so that the box of the whole flight has an area.
_ROOM_DEG = 1e-4


@dataclass(frozen=True, eq=False)
class JoinedPlan(Plan):
    """Plans of several missions in the order of their flight, as one plan that can be exported.

    Rows are numbered on from mission to mission, and images keep their names. Grid, zoom, frames and methods are those
    of the first mission, and coverage and overlap have no meaning: each mission's plan has its own.

    Attributes
    ----------
    plans : tuple of Plan
    """

    plans: tuple[Plan, ...] = ()

    @property
    def joints(self) -> tuple[int, ...]:
        """Index of the first capture of each further mission."""
        return tuple(np.cumsum([len(plan) for plan in self.plans])[:-1].tolist())

    @cached_property
    def names(self) -> list[str]:
        """Name of each picture in its mission."""
        return [name for plan in self.plans for name in plan.names]

    @cached_property
    def asked_agl_m(self) -> Floats:
        """Requested heights above ground, (n,)."""
        return np.concatenate([plan.asked_agl_m for plan in self.plans])

    @cached_property
    def airspeeds_m_per_s(self) -> Floats:
        """Airspeed towards each capture, (n,); a value common to all takes no memory."""
        found = np.concatenate([plan.airspeeds_m_per_s for plan in self.plans])
        return np.broadcast_to(found[0], len(found)) if (found == found[0]).all() else found

    @cached_property
    def zooms(self) -> Numbers:
        """Zoom of each window, (n,)."""
        return np.concatenate([plan.zooms for plan in self.plans])

    @cached_property
    def wrapped_left_px(self) -> Floats | Numbers:
        """Left edges of the windows, wrapped into the world, (n,)."""
        return np.concatenate([plan.wrapped_left_px for plan in self.plans])

    @cached_property
    def cameras(self) -> CaptureCameras:
        """Cameras of the captures."""
        return CaptureCameras.joined([(plan.cameras, len(plan)) for plan in self.plans])

    @cached_property
    def views(self) -> Any:
        """Ground that the cameras see."""
        return _JoinedViews(self.plans, np.append(0, self.joints))

    @cached_property
    def times_s(self) -> Floats:
        """Seconds of each exposure after the first one along the planned path, (n,)."""
        return self.path.time_s[self.path.capture >= 0]


class _JoinedViews(NamedTuple):
    """The `CameraViews` of several plans, as far as exports use them."""

    plans: tuple[Plan, ...]
    firsts: Numbers

    @property
    def poles(self) -> Numbers:
        """Poles in each footprint, (n,)."""
        return np.concatenate([plan.views.poles for plan in self.plans])

    def outline(self, index: int) -> Outline:
        """Outline of a footprint."""
        at = int(np.searchsorted(self.firsts, index, side="right")) - 1
        return self.plans[at].views.outline(index - int(self.firsts[at]))


def join_plans(plans: Sequence[Plan], names: Sequence[str], heights: Heights | None = None) -> JoinedPlan:
    """Join plans to one flight, in their order.

    Transits between missions are level, as high as both ends at least, and over relief as high as ways to the take-off:
    they keep the clearance. Take-off and battery may be set in one of the missions. Each mission keeps its airspeed;
    its splits count its images.

    Parameters
    ----------
    names : sequence of str
        Names of the missions, for errors.
    heights : Heights or None
        Heights of the missions' elevation, if they have one.

    Raises
    ------
    InvalidInput
        There are not two missions, or they differ in what one flight cannot change: camera, wind, relief, trigger,
        drone, lead-in, turnaround, take-off or battery.
    """
    if len(plans) < 2:
        raise InvalidInput("one flight of several missions: needs two or more")
    for (one, name), (other, other_name) in combinations(zip(plans, names), 2):
        _refuse_differences(one.mission, other.mission, name, other_name)
    lon_deg = float(plans[0].lon_deg[0])
    turns = [360.0 * round((lon_deg - float(plan.lon_deg[0])) / 360.0) for plan in plans]
    poses = _joined_poses([_turned(plan.poses, turn) for plan, turn in zip(plans, turns)])
    meant = _joined_poses([_turned(plan.meant, turn) for plan, turn in zip(plans, turns)])
    mission = _joined_mission(plans, names, meant)
    relief = _joined_relief(mission, heights)
    rows = np.cumsum([0, *(int(plan.row.max()) + 1 for plan in plans)])
    first = plans[0]
    return JoinedPlan(
        mission=mission,
        # A grid of another map than Web Mercator needs more care with footprints near the poles.
        grid=next((plan.grid for plan in plans if not plan.grid.plane.wraps), first.grid),
        zoom=first.zoom,
        column=np.concatenate([plan.column for plan in plans]),
        row=np.concatenate([plan.row + offset for plan, offset in zip(plans, rows)]),
        poses=poses,
        windows=Windows._make(np.concatenate(values) for values in zip(*(plan.windows for plan in plans))),
        corners=Corners._make(
            np.concatenate(values)
            for values in zip(
                *(plan.corners._replace(lon_deg=plan.corners.lon_deg + turn) for plan, turn in zip(plans, turns))
            )
        ),
        frames=first.frames,
        accuracy=first.accuracy,
        relief=relief,
        nominal=meant if any(plan.nominal is not None for plan in plans) else None,
        level_m=first.level_m,
        flown=_joined_heights(plans) if mission.terrain.elevation else None,
        plans=tuple(plans),
    )


def _refuse_differences(one: Mission, other: Mission, name: str, other_name: str) -> None:
    """Refuse missions that one flight cannot serve."""
    whole: list[tuple[Message, Any, Any]] = [
        (Message("camera"), one.camera, other.camera),
        (Message("wind"), one.wind, other.wind),
        (Message(field_named(Route, "trigger").title), one.trigger, other.trigger),
    ]
    whole += [
        (Message(field.title), getattr(one.terrain, field.name), getattr(other.terrain, field.name))
        for field in declared_fields(Terrain)
    ]
    if not one.terrain.elevation:
        whole.append(_pair(one.flight, other.flight, Flight, "ground_height_m"))
    whole += [_pair(one.route, other.route, Route, field) for field in ("drone", "turnaround_m", "lead_in_m")]
    for field in ("takeoff", "battery_min"):
        title, *values = _pair(one.route, other.route, Route, field)
        if None not in values:
            whole.append((title, *values))
    for title, value, other_value in whole:
        if value != other_value:
            raise InvalidInput(
                "one flight of {0} and {1}: they differ in {2}, which a flight has in common", name, other_name, title
            )


def _pair(one: Any, other: Any, part: Any, field: str) -> tuple[Message, Any, Any]:
    return Message(field_named(part, field).title), getattr(one, field), getattr(other, field)


def _joined_mission(plans: Sequence[Plan], names: Sequence[str], meant: Poses) -> Mission:
    """Settings of the whole flight; its area is a box around the captures."""
    missions = [plan.mission for plan in plans]
    splits: list[tuple[int, int]] = []
    flown = 0
    for plan, name in zip(plans, names):
        found = read_ranges(plan.mission.route.split_after)
        if found and not 0 < found[0][0] <= found[-1][1] <= len(plan):
            raise InvalidInput(
                "mission {0} with a split after image {1}: it has {2:,} images",
                name,
                plan.mission.route.split_after,
                len(plan),
                field="split_after",
            )
        splits += [(flown + low, flown + high) for low, high in found]
        flown += len(plan)
    # A split after the last image of all would leave nothing to fly.
    splits = [(low, min(high, flown - 1)) for low, high in splits if low < flown]
    lat, lon = meant.lat_deg, meant.lon_deg
    edges = np.array([lon.min() - _ROOM_DEG, lon.max() + _ROOM_DEG])
    west, east = wrap_lon_deg(edges).tolist() if np.ptp(edges) < 360.0 else (-180.0, 180.0)
    north, south = min(float(lat.max()) + _ROOM_DEG, 90.0), max(float(lat.min()) - _ROOM_DEG, -90.0)
    return missions[0].replace(
        area=Box(north, west, south, east),
        no_fly=tuple(polygon for mission in missions for polygon in mission.no_fly),
        takeoff=next((one.route.takeoff for one in missions if one.route.takeoff is not None), None),
        battery_min=next((one.route.battery_min for one in missions if one.route.battery_min is not None), None),
        split_after=ranges_text(splits),
        entry=FIRST,
        skip_rows="",
        imageries=(),
    )


def _joined_relief(mission: Mission, heights: Heights | None) -> Relief:
    """Ground of the whole flight, and between the missions."""
    if not mission.terrain.elevation:
        return level_ground(mission)
    from ..relief.modelled import relief_below

    return relief_below(mission.replace(agl_m=max(mission.flight.agl_m, mission.terrain.clearance_m)), heights)[1]


def _joined_heights(plans: Sequence[Plan]) -> Flown:
    each = (plan.flown or Flown(plan.height_m, plan.ground_m, plan.agl_m) for plan in plans)
    return Flown(*(np.concatenate(values) for values in zip(*each)))


def _joined_poses(each: Sequence[Poses]) -> Poses:
    return Poses(*(np.concatenate(values) for values in zip(*each)))


def _turned(poses: Poses, turn_deg: float) -> Poses:
    return poses._replace(lon_deg=poses.lon_deg + turn_deg)


@dataclass(frozen=True)
class JoinedSummary:
    """Figures of several missions in one flight.

    ``images_each`` are the images of each mission. ``flight_m`` and ``flight_s`` are those of the path with all
    transits, over all sorties, and ``airborne_s`` also counts climb and landing, as QGroundControl does.
    ``clearance_m`` is the least height above the relief within the clearance distance, but for take-off and landing;
    None over level ground.
    """

    missions: tuple[str, ...]
    images_each: tuple[int, ...]
    transits_m: float
    flight_m: float
    flight_s: float
    airborne_s: float
    batteries: int
    drone: str
    sorties_s: tuple[float, ...]
    battery_min: float | None
    clearance_m: float | None

    @property
    def images(self) -> int:
        """Number of images of all missions."""
        return sum(self.images_each)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping."""
        return {"images": self.images, **asdict(self)}

    def lines(self) -> Iterator[tuple[str, str]]:
        """Label and value of each figure, for people."""
        yield Message("images"), Message("{0:,}", self.images)
        for name, count in zip(self.missions, self.images_each):
            yield name, Message("{0:,}", count)
        path = Message("{0}, {1} with turns", length_text(self.flight_m), duration_text(self.flight_s))
        yield Message("flight path"), path
        yield Message("between missions"), length_text(self.transits_m)
        yield Message("time in the air"), airborne_text(self.airborne_s, self.batteries, self.drone)
        if self.battery_min is not None or len(self.sorties_s) > 1:
            yield Message("sorties"), sorties_text(self.sorties_s, self.battery_min)
        if self.clearance_m is not None:
            yield Message("least clearance"), length_text(self.clearance_m)


def summarize(plan: JoinedPlan, names: Sequence[str]) -> JoinedSummary:
    """Figures of a flight of several missions."""
    path, airborne = plan.path, airborne_s(plan)
    return JoinedSummary(
        missions=tuple(names),
        images_each=tuple(len(one) for one in plan.plans),
        transits_m=_transits_m(plan),
        flight_m=path.distance_m,
        flight_s=float(path.sorties_s.sum()),
        airborne_s=float(airborne.sum()),
        batteries=batteries(plan, airborne),
        drone=plan.mission.route.drone,
        sorties_s=tuple(path.sorties_s.tolist()) if path.sorties > 1 else (),
        battery_min=plan.mission.route.battery_min,
        clearance_m=_least_clearance_m(plan),
    )


def _transits_m(plan: JoinedPlan) -> float:
    """Length of the ways from the last capture of each mission to the first of the next, in the same sortie."""
    path, found = plan.path, 0.0
    at = np.flatnonzero(path.capture >= 0)
    for joint in plan.joints:
        last, first = at[joint - 1], at[joint]
        if path.sortie[last] == path.sortie[first]:
            way = slice(int(last), int(first) + 1)
            found += float(legs(path.lat_deg[way], path.lon_deg[way]).distance_m.sum())
    return found


def _least_clearance_m(plan: JoinedPlan) -> float | None:
    """Least clearance of the flight, as in its height profile; None over level ground."""
    if plan.relief.is_level:
        return None
    profile = height_profile(plan)
    return None if profile.lowest is None else float(profile.clearance_m[profile.lowest])
