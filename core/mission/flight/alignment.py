"""Row azimuths that suit an area: along its longest side, or for the shortest flight."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...errors import Cancelled, InvalidInput, Message, OptionName
from ...geodesy.ellipsoid import arctan2
from ...geodesy.mercator import PixelGrid
from ...geodesy.projections import LocalPlane
from ..areas.area import Box, Polygon
from ..estimate import length_text
from ..layout.framing import ground_ellipsoid
from ..layout.rotated import is_rotated, lay_out_rotated
from ..mission import Mission
from ..parts import COVER, EASTWARD_DEG, LONGEST_SIDE, SHORTEST
from ..plan import Plan, plan
from ..relief.ground import Heights
from .legs import legs

#: Steps of the search for an azimuth, degrees; each step refines the two best azimuths so far.
_STEPS_DEG = (5.0, 1.25, 0.4, 0.1)
#: Called with the progress of a search, 0 to 1; returning False cancels it.
GoOn = Callable[[float], bool]


class Alignment(NamedTuple):
    """Flight at the row azimuth that was found, and at the previous one; both in still air."""

    mission: Mission
    made: Plan
    before: Plan

    @property
    def azimuth_deg(self) -> float:
        """New azimuth of the rows."""
        return self.made.mission.flight.row_azimuth_deg

    @property
    def gain(self) -> float:
        """Share by which the flight is shorter than before; negative where it is longer."""
        before = flown_m(self.before)
        return 1.0 - flown_m(self.made) / before if before > 0.0 else 0.0

    def text(self, length: Callable[[float], str] = length_text) -> Message:
        """Azimuth, rows, length and gain in words; ``length`` formats metres."""
        azimuth, before = self.azimuth_deg, self.before.mission.flight.row_azimuth_deg
        count = self.made.rows
        rows = Message("{0} row", count) if count == 1 else Message("{0} rows", count)
        flown: str = length(flown_m(self.made))
        if not self.made.path.is_captures:
            flown = Message("{0} with turns", flown)
        figures = (azimuth, rows, flown)
        percent = abs(round(100.0 * self.gain))
        if azimuth == before:
            return Message("row azimuth {0:g}°: {1}, {2}, as before", *figures)
        if percent == 0:
            return Message("row azimuth {0:g}°: {1}, {2}, as long as {3:g}°", *figures, before)
        if self.gain > 0.0:
            return Message("row azimuth {0:g}°: {1}, {2}, {3} % shorter than {4:g}°", *figures, percent, before)
        return Message("row azimuth {0:g}°: {1}, {2}, {3} % longer than {4:g}°", *figures, percent, before)


def flown_m(made: Plan) -> float:
    """Length of the flight in metres as in estimates: with turns and transit where the mission has them."""
    return made.direct.distance_m if made.path.is_captures else made.path.distance_m


def align_rows(
    mission: Mission,
    grid: PixelGrid,
    heights: Heights | None = None,
    way: str = SHORTEST,
    go_on: GoOn = lambda _share: True,
) -> Alignment:
    """Align the rows of a mission with the longest side of its area, or for the shortest flight.

    Flights are compared without wind, from the first capture to the last, or with a route including all sorties, turns
    and detours around no-fly areas. The search begins with regular azimuths and the azimuths of the area's sides, and
    refines the best in ever finer steps. The previous flight is kept unless another is shorter by a thousandth.

    Parameters
    ----------
    heights : Heights or None
        As for `plan`.
    way : str
        One of `parts.ALIGNMENTS`.
    go_on : callable

    Raises
    ------
    InvalidInput
        The area is points, which have no rows; the layout is ``paper``, whose rows run east; or the mission cannot be
        planned.
    Cancelled
        ``go_on`` returned False.
    """
    if not mission.area.covers_ground:
        raise InvalidInput("points have no rows that could be aligned")
    if mission.flight.layout != COVER:
        raise InvalidInput(
            "rows to be aligned: the layout {0} is north-up",
            mission.flight.layout,
            field="layout",
            remedy=Message("use {0} {1}", OptionName("layout"), "cover"),
        )
    if mission.flight.skip_rows:
        raise InvalidInput(
            "rows to be aligned: the skipped rows {0} would be others then", mission.flight.skip_rows, field="skip_rows"
        )
    if mission.route.split_after:
        raise InvalidInput(
            "rows to be aligned: a split after image {0} would be elsewhere then",
            mission.route.split_after,
            field="split_after",
        )
    area = max(mission.area.parts, key=lambda part: part.area_m2())
    flights = _Flights(mission, grid, heights, area)
    before = flights.plan(mission.flight.row_azimuth_deg)
    found = flights.plan(longest_side_deg(area)) if way == LONGEST_SIDE else flights.shortest(before, go_on)
    return Alignment(mission.replace(row_azimuth_deg=found.mission.flight.row_azimuth_deg), found, before)


def longest_side_deg(area: Box | Polygon) -> float:
    """Azimuth of the longest side of an area, in [0, 180) degrees; 90 for a square box."""
    return float(_sides_deg(area)[0])


def _sides_deg(area: Box | Polygon) -> list[float]:
    """Azimuths of the outer sides of an area, the longest first."""
    box = area.bounds
    plane = LocalPlane((box.north_deg + box.south_deg) / 2.0, box.west_deg + box.span_deg / 2.0)
    if isinstance(area, Box):
        # The sides of a box are parallels and meridians.
        x, y = plane.forward(
            np.array([box.north_deg, box.south_deg, box.south_deg]),
            np.array([plane.lon_deg, plane.lon_deg, plane.lon_deg]),
        )
        lon = np.array([box.west_deg, box.continuous_east_deg])
        across = plane.forward(np.full(2, plane.lat_deg), lon)
        high, wide = math.hypot(x[1] - x[0], y[1] - y[0]), math.hypot(*(end[1] - end[0] for end in across))
        return [0.0, EASTWARD_DEG] if high > wide else [EASTWARD_DEG, 0.0]
    lon, lat = area.arrays()[0]
    x, y = plane.forward(lat, lon)
    side = np.stack([np.roll(x, -1) - x, np.roll(y, -1) - y], axis=1)
    length = np.hypot(*side.T)
    side, length = side[length > 0.0], length[length > 0.0]
    if not len(side):
        return [EASTWARD_DEG]
    heading = np.degrees(arctan2(side[:, 0], side[:, 1]))
    # Consecutive sides whose directions differ by a degree or less count as one.
    bends = np.abs(np.mod(heading - np.roll(heading, 1) + 180.0, 360.0) - 180.0) > 1.0
    first = int(np.argmax(bends))
    whole = np.cumsum(np.roll(bends, -first)) - 1
    summed = np.zeros((max(int(whole[-1]), 0) + 1, 2))
    np.add.at(summed, np.maximum(whole, 0), np.roll(side, -first, axis=0))
    order = np.argsort(-np.hypot(*summed.T), kind="stable")
    azimuths = np.degrees(np.arctan2(summed[order, 0], summed[order, 1]))
    return [_rounded(azimuth) for azimuth in azimuths.tolist()]


def _rounded(azimuth_deg: float) -> float:
    """Azimuth in [0, 180), rounded to 0.01 degrees, which moves a row sideways by 2 cm in 100 m."""
    return round(azimuth_deg % 180.0, 2) % 180.0


class _Flights:
    """Lengths of a mission's flight at different azimuths, each planned once."""

    def __init__(self, mission: Mission, grid: PixelGrid, heights: Heights | None, area: Box | Polygon) -> None:
        self._mission, self._grid, self._heights = mission.replace(wind=None), grid, heights
        self._area = area
        self._lengths_m: dict[float, float] = {}
        self._from_positions = False

    def plan(self, azimuth_deg: float) -> Plan:
        """Plan the flight at an azimuth."""
        made = plan(self._mission.replace(row_azimuth_deg=azimuth_deg), self._grid, self._heights)
        self._lengths_m[azimuth_deg] = flown_m(made)
        return made

    def shortest(self, before: Plan, go_on: GoOn) -> Plan:
        """Plan the shortest flight; return the flight before if none is shorter by a thousandth."""
        # Without a route and no-fly areas, the positions of the captures give the length.
        self._from_positions = before.path.is_captures and not self._mission.no_fly
        tried = [
            *np.arange(0.0, 180.0, _STEPS_DEG[0]).tolist(),
            *_sides_deg(self._area)[:6],
        ]
        for number, step in enumerate((*_STEPS_DEG[1:], 0.0)):
            for at, azimuth in enumerate(tried):
                if not go_on((number + at / len(tried)) / len(_STEPS_DEG)):
                    raise Cancelled("alignment: stopped")
                self._length_m(azimuth)
            best = sorted(self._lengths_m, key=lambda one: (self._lengths_m[one], one))[:2]
            tried = [_rounded(azimuth + steps * step) for azimuth in best for steps in range(-3, 4)]
        azimuth = min(self._lengths_m, key=lambda one: (self._lengths_m[one], one))
        if self._lengths_m[azimuth] > (1.0 - 1e-3) * flown_m(before):
            return before
        return self.plan(azimuth)

    def _laid_out_m(self, azimuth_deg: float) -> float:
        """Length of the flight at an azimuth, from positions of captures where these suffice, else from a plan."""
        mission = self._mission.replace(row_azimuth_deg=azimuth_deg)
        # Rounded map frames shift captures of rows along the axes of the map.
        along_axes = azimuth_deg % EASTWARD_DEG == 0.0
        from_positions = self._from_positions and self._heights is None and self._grid.plane.wraps
        if along_axes or not from_positions or not is_rotated(mission):
            return flown_m(self.plan(azimuth_deg))
        layout, _ = lay_out_rotated(mission, ground_ellipsoid(mission))
        return float(np.sum(legs(layout.lat_deg, layout.lon_deg).distance_m))

    def _length_m(self, azimuth_deg: float) -> float:
        """Length of the flight at an azimuth, cached; infinite where it cannot be planned."""
        found = self._lengths_m.get(azimuth_deg)
        if found is None:
            try:
                found = self._laid_out_m(azimuth_deg)
            except InvalidInput:
                found = math.inf
            self._lengths_m[azimuth_deg] = found
        return found
