"""The path that an aircraft flies: take-off, ways there and back, lead-ins, captures and turns, in sorties."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..geodesy.camera import Poses
from .mission import Mission
from .relief import ReliefBelow

Floats = NDArray[np.float64]
Numbers = NDArray[np.int64]

#: Kinds of points. Take-off and landing lie on the ground; the points above them, at which the way there begins and
#: the way back ends, are transit, as are those around no-fly polygons and over relief.
TAKEOFF, TRANSIT, LEAD_IN, CAPTURE, TURNAROUND, LANDING = range(6)


class Planned(Protocol):
    """What a path is made of: a plan."""

    @property
    def mission(self) -> Mission:
        """What was asked for."""
        ...

    @property
    def row(self) -> Numbers:
        """Row of each capture, (n,)."""
        ...

    @property
    def meant(self) -> Poses:
        """Captures in flight order, where they were meant to be, (n,)."""
        ...

    @property
    def ground_m(self) -> Floats:
        """Heights of the ground below them, (n,)."""
        ...

    @property
    def relief(self) -> ReliefBelow | None:
        """The relief that they are flown over; None where the ground is level."""
        ...

    @property
    def exposures_s(self) -> Floats:
        """Seconds of each capture after the first one, of a flight of captures alone, (n,)."""
        ...


@dataclass(frozen=True, eq=False)
class FlightPath:
    """Points of a flight one after the other, m of them, as arrays (m,); straight lines lie between them.

    Attributes
    ----------
    lat_deg, lon_deg : array
        Degrees; longitudes are continuous with the plan's.
    height_m : array
        Over the WGS 84 ellipsoid.
    ground_m : array
        Of the ground below, over the WGS 84 ellipsoid.
    kind : array of int8
        `TAKEOFF`, `TRANSIT`, `LEAD_IN`, `CAPTURE`, `TURNAROUND` or `LANDING`.
    capture : array of int64
        Index of the capture in the plan; -1 at points between.
    sortie : array of int64
        Number of the sortie, from 0.
    time_s : array
        When the aircraft leaves the point: seconds after the first capture, before 0 on the way there.
    base_m : float
        What heights count from in files of heights over the take-off: that of the ground there, or below the first
        capture where no take-off is set; over the ellipsoid.
    """

    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    ground_m: Floats
    kind: NDArray[np.int8]
    capture: Numbers
    sortie: Numbers
    time_s: Floats
    base_m: float

    def __len__(self) -> int:
        return len(self.kind)

    @property
    def agl_m(self) -> Floats:
        """Heights above the ground, (m,)."""
        return self.height_m - self.ground_m

    @property
    def sorties(self) -> int:
        """How many sorties there are."""
        return int(self.sortie[-1]) + 1


def flight_path(plan: Planned) -> FlightPath:
    """Work out the path of a plan; of a mission without a route the captures alone.

    Where wind moves the captures it goes through the places that they were meant at.
    """
    return _captures_alone(plan)


def _captures_alone(plan: Planned) -> FlightPath:
    meant, count = plan.meant, len(plan.row)
    ground = np.asarray(plan.ground_m)
    return FlightPath(
        meant.lat_deg,
        meant.lon_deg,
        ground + meant.agl_m,
        ground,
        np.full(count, CAPTURE, np.int8),
        np.arange(count, dtype=np.int64),
        np.zeros(count, np.int64),
        plan.exposures_s,
        float(ground[0]),
    )
