"""Height profile of a flight: ground, surface, flight and clearance along the path."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..geodesy.projections import LocalPlane
from ..waiting import check_cancelled
from .flight.legs import legs
from .flight.path import LANDING, TAKEOFF, FlightPath
from .plan import Plan
from .relief.ground import PathGround, Profile
from .relief.roofed import planned_surface

#: Kind of a point between two points of the path.
BETWEEN = -1
#: Points of a profile: several for each pixel of any screen.
MOST_POINTS = 30_000
#: Points that each stretch of a thinned profile keeps at most: its extremes.
_KEPT = 6
#: Room around a path, which bends on the plane of its heights.
_ROOM_M = 5.0


@dataclass(frozen=True, eq=False)
class HeightProfile:
    """Heights along a flight at points (n,), in flight order. Heights are above the WGS 84 ellipsoid, in metres.

    Attributes
    ----------
    distance_m : array
        Distance flown over ground; what lies between the end of a sortie and the next one is not flown.
    lat_deg, lon_deg : array
        Longitudes are continuous with the plan's.
    height_m : array
        Heights of the flight.
    ground_m, surface_m : array
        Heights straight below; NaN where unknown. They are equal if the mission has one model of heights.
    clearance_m : array
        Height of the flight above the surface, and above everything within the mission's clearance distance; NaN where
        unknown.
    kind : array of int8
        Kind of a point of the path, as in `flight.path`; `BETWEEN` between two points.
    image : array of int64
        Index of the image taken here, or of the last one before; -1 before the first.
    sortie : array of int64
        Number of the sortie, from 0.
    has_surface : bool
        Whether the surface is a model of its own.
    is_level : bool
        Whether the ground has one height everywhere.
    """

    distance_m: Floats
    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    ground_m: Floats
    surface_m: Floats
    clearance_m: Floats
    kind: NDArray[np.int8]
    image: Numbers
    sortie: Numbers
    has_surface: bool
    is_level: bool

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def length_m(self) -> float:
        """Distance at the end of the flight."""
        return float(self.distance_m[-1])

    @cached_property
    def lowest(self) -> int | None:
        """Point with the least clearance, other than take-off and landing; None if all are unknown."""
        clearance = np.where(np.isin(self.kind, (TAKEOFF, LANDING)), np.nan, self.clearance_m)
        return None if np.isnan(clearance).all() else int(np.nanargmin(clearance))

    def part(self, first_m: float, last_m: float, most: int) -> HeightProfile:
        """Points between two distances, with those just outside, thinned to about ``most``; see `height_profile`."""
        first = max(int(np.searchsorted(self.distance_m, first_m, side="left")) - 1, 0)
        last = int(np.searchsorted(self.distance_m, last_m, side="right")) + 1
        points = _taken(self, slice(first, last))
        return points if len(points) <= most else _thinned(points, first_m, last_m, most)


def height_profile(plan: Plan, most: int = MOST_POINTS) -> HeightProfile:
    """Heights along the flight of a plan: take-off, images, turns, ways between sorties, and what lies below them.

    Over relief, points are where the path crosses the lines through pixel centres of the heights, and where between
    two of them the flight is nearest to the surface, so that no least clearance is missed. Over level ground, they are
    the points of the path.

    Parameters
    ----------
    most : int
        About this many points at most, for which the memory is bounded, too. Of a longer flight, each of many equal
        stretches keeps its points of greatest and least height and ground, greatest surface and least clearance.

    Raises
    ------
    InvalidInput
        The flight is impossible, see `flight.path.flight_path`.
    Cancelled
        An enclosing `waiting.cancellable` is cancelled.
    """
    path = plan.path
    found: list[HeightProfile] = []
    count = 0
    for points in _blocks(plan, path):
        check_cancelled()
        found.append(points)
        count += len(points)
        # Thinned points are few beside those of a block.
        if count > 8 * most:
            found = [_thinned(_joined(found), 0.0, path.distance_m, most)]
            count = len(found[0])
    whole = _joined(found)
    return whole if count <= most else _thinned(whole, 0.0, path.distance_m, most)


def _arrays(profile: HeightProfile) -> dict[str, Any]:
    """Arrays of a profile, by their names."""
    return {name: values for name, values in vars(profile).items() if isinstance(values, np.ndarray)}


def _taken(profile: HeightProfile, which: slice | Numbers) -> HeightProfile:
    """Some of the points of a profile."""
    return replace(profile, **{name: values[which] for name, values in _arrays(profile).items()})


def _joined(parts: list[HeightProfile]) -> HeightProfile:
    """Points of all parts of a profile, in order."""
    each = [_arrays(one) for one in parts]
    return replace(parts[0], **{name: np.concatenate([one[name] for one in each]) for name in each[0]})


def _thinned(profile: HeightProfile, first_m: float, last_m: float, most: int) -> HeightProfile:
    """Points that show what all of them show, by stretches of equal length between two distances.

    Each stretch keeps its extremes; ends of sorties are kept.
    """
    stretches = max(most // _KEPT, 1)
    share = (profile.distance_m - first_m) / max(last_m - first_m, 1e-9)
    stretch = np.clip(np.floor(share * stretches), -1, stretches).astype(np.int64)
    starts = np.flatnonzero(np.diff(stretch, prepend=stretch[0] - 1))
    ends = np.flatnonzero(np.diff(profile.sortie))
    is_flown = ~np.isin(profile.kind, (TAKEOFF, LANDING))
    clearance = np.where(is_flown, profile.clearance_m, np.nan)
    extremes = clearance, -profile.surface_m, -profile.ground_m, profile.ground_m, -profile.height_m, profile.height_m
    kept = [_least_of_each(values, stretch, starts) for values in extremes]
    which = np.unique(np.concatenate([np.array([0, len(stretch) - 1]), ends, ends + 1, *kept]))
    return _taken(profile, which)


def _least_of_each(values: Floats, group: Numbers, starts: Numbers) -> Numbers:
    """Index of the least value of each group of neighbours; unknown ones count as greatest."""
    known = np.where(np.isnan(values), np.inf, values)
    least = np.minimum.reduceat(known, starts)
    lengths = np.diff(np.append(starts, len(group)))
    at = np.flatnonzero(known == np.repeat(least, lengths))
    return at[np.unique(np.repeat(np.arange(len(starts)), lengths)[at], return_index=True)[1]]


def _blocks(plan: Plan, path: FlightPath) -> Iterator[HeightProfile]:
    """Points of the path and below its legs, in flight order, in blocks that bound the memory."""
    ground = plan.relief.around(path.lat_deg, path.lon_deg, _ROOM_M)
    middle = (float(at.min() + at.max()) / 2.0 for at in (path.lat_deg, path.lon_deg))
    plane = LocalPlane(*middle)
    start_m, image = 0.0, -1
    for number in range(path.sorties):
        sortie = path.sortie_path(number)
        length = legs(sortie.lat_deg, sortie.lon_deg).distance_m
        distance = start_m + np.append(0.0, np.cumsum(length))
        images = np.maximum(np.maximum.accumulate(sortie.capture), image)
        start_m, image = float(distance[-1]), int(images[-1])
        yield from _sortie_points(plan, sortie, distance, images, ground, plane)


def _sortie_points(
    plan: Plan, path: FlightPath, distance: Floats, images: Numbers, ground: PathGround, plane: LocalPlane
) -> Iterator[HeightProfile]:
    """Points of a sortie, of which distances and images of the points of the path (m,) are known."""
    if plan.relief.is_level:
        below = ground.ground_m(path.lat_deg, path.lon_deg)
        yield HeightProfile(
            distance,
            path.lat_deg,
            path.lon_deg,
            path.height_m,
            below,
            below,
            path.height_m - below,
            path.kind,
            images,
            path.sortie,
            has_surface=False,
            is_level=True,
        )
        return
    last = len(path) - 2
    if last < 0:
        # A leg without length has heights below it; of its ends, the first is kept.
        twice: dict[str, Any] = {
            name: np.repeat(values, 2) for name, values in vars(path).items() if isinstance(values, np.ndarray)
        }
        path, distance, images = replace(path, **twice), np.repeat(distance, 2), np.repeat(images, 2)
    # Climbs have no points between their ends.
    is_climb = np.diff(distance) == 0.0
    is_around, heights = plan.mission.terrain.clearance_distance_m > 0.0, plan.relief.heights
    for profile in ground.profiles(path.lat_deg, path.lon_deg, plane):
        nodes = _at_nearest(profile, path, ground)
        # Sums of shares may be rounded below 1.
        nodes = nodes._replace(share=np.where(nodes.share > 1.0 - 1e-12, 1.0, nodes.share))
        leg, share = nodes.leg, nodes.share
        inside = (share > 0.0) & (share < 1.0)
        ends = (share == 0.0) | ((share == 1.0) & (leg == last))
        repeated = np.append(False, (np.diff(share) == 0.0) & (np.diff(leg) == 0))
        some = (ends | (inside & ~is_climb[leg])) & ~repeated
        nodes = Profile(*(values[some] for values in nodes))
        leg, share = nodes.leg, nodes.share
        point = leg + (share == 1.0)
        height = path.height_m[leg] + share * np.diff(path.height_m)[leg]
        top = nodes.highest_m if is_around else nodes.surface_m
        clearance = height - top
        yield HeightProfile(
            distance[leg] + share * np.diff(distance)[leg],
            nodes.lat_deg,
            nodes.lon_deg,
            height,
            nodes.ground_m,
            nodes.surface_m,
            np.where(np.isfinite(clearance), clearance, np.nan),
            np.where((share > 0.0) & (share < 1.0), BETWEEN, path.kind[point]).astype(np.int8),
            images[point],
            path.sortie[point],
            has_surface=planned_surface(heights) is not heights.ground,
            is_level=False,
        )


def _at_nearest(profile: Profile, path: FlightPath, ground: PathGround) -> Profile:
    """Profile with midpoints moved to where, between their neighbours, the flight is nearest to the surface.

    The flight is straight and the surface a parabola, so that their distance is one, too.
    """
    middle = np.flatnonzero(profile.is_middle)
    begin, end = middle - 1, middle + 1
    height = path.height_m[profile.leg] + profile.share * np.diff(path.height_m)[profile.leg]
    over = height - profile.surface_m
    rise, bulge = over[end] - over[begin], (over[begin] + over[end]) / 2.0 - over[middle]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = 0.5 - rise / (8.0 * bulge)
    # Elsewhere, one of the neighbours is nearest.
    is_moved = (bulge > 0.0) & (along > 0.0) & (along < 1.0)
    at, begin, end, along = middle[is_moved], begin[is_moved], end[is_moved], along[is_moved]

    def moved(values: Floats) -> Floats:
        found = values.copy()
        found[at] = values[begin] + along * (values[end] - values[begin])
        return found

    nodes = profile._replace(
        share=moved(profile.share),
        lat_deg=moved(profile.lat_deg),
        lon_deg=moved(profile.lon_deg),
        surface_m=moved(profile.surface_m),
        ground_m=profile.ground_m.copy(),
    )
    nodes.surface_m[at] += 4.0 * bulge[is_moved] * along * (1.0 - along)
    nodes.ground_m[at] = ground.ground_m(nodes.lat_deg[at], nodes.lon_deg[at])
    return nodes
