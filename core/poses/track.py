"""Tracks read from trajectories and logs of any format, and the mission points made of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import Cancelled, InvalidInput, Message, OptionName
from ..fields import field_named
from ..mission.areas.area import Points, check_agl
from ..mission.flight.legs import legs
from ..mission.parts import Flight

#: Decimals of latitudes and longitudes, 0.1 mm.
PLACE_DIGITS = 9
#: Decimals of heights and angles.
ANGLE_DIGITS = 6
#: Called with the share of a file that is read, 0 to 1; returns False to stop.
Progress = Callable[[float], bool]
#: Lines, or elements of a document, between two calls of `Progress`.
REPORT_EACH = 4096


def unwatched(_share: float) -> bool:
    """Progress callable that does nothing."""
    return True


def report(progress: Progress, share: float) -> None:
    """Report the share that is read; raises Cancelled if ``progress`` returns False."""
    if not progress(share):
        raise Cancelled("reading: stopped")


@dataclass(frozen=True, eq=False)
class Track:
    """Positions (n,) in the order of a file.

    Parameters
    ----------
    lat_deg, lon_deg, height_m : array
        Places; heights in the file's reference, NaN where missing.
    ground_m : float or None
        Height of the ground in the file's reference, from the file or its origin; None if it has to be given.
    time_s : array or None
        Seconds after 1970 in UTC, or after the start of the file; never decreasing.
    attitude_deg : tuple of three arrays, or None
        Yaw, tilt and roll of the camera; None if the file has no attitude.
    without_place, without_time : int
        Numbers of positions left out because they have no place, or no time where others have one.
    """

    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    ground_m: float | None = None
    time_s: Floats | None = None
    attitude_deg: tuple[Floats, Floats, Floats] | None = None
    without_place: int = 0
    without_time: int = 0

    def __len__(self) -> int:
        return len(self.lat_deg)

    def take(self, which: NDArray[np.intp]) -> Track:
        """Some of the positions."""
        return replace(
            self,
            lat_deg=self.lat_deg[which],
            lon_deg=self.lon_deg[which],
            height_m=self.height_m[which],
            time_s=None if self.time_s is None else self.time_s[which],
            attitude_deg=None
            if self.attitude_deg is None
            else (self.attitude_deg[0][which], self.attitude_deg[1][which], self.attitude_deg[2][which]),
        )

    def starting(self, start_s: float) -> Track:
        """The track with its first position at ``start_s``, seconds after 1970; raises InvalidInput without times."""
        if self.time_s is None:
            raise InvalidInput(
                "start: the trajectory has no times",
                remedy=Message("give the start to the capture ({0})", OptionName("start")),
            )
        return replace(self, time_s=self.time_s - self.time_s[0] + start_s)

    def nadir(self) -> Track:
        """The track with the camera kept straight down by a gimbal, which keeps only the yaw."""
        if self.attitude_deg is None:
            return self
        yaw, tilt, _ = self.attitude_deg
        return replace(self, attitude_deg=(yaw, np.zeros_like(tilt), np.zeros_like(tilt)))

    def thinned(self, every_s: float | None = None, every_m: float | None = None) -> Track:
        """Drop positions less than ``every_s`` seconds, or ``every_m`` metres of way, after the position kept before.

        Raises
        ------
        InvalidInput
            An interval that is not above 0, or an interval of time for a track without times.
        """
        for unit, value in (("s", every_s), ("m", every_m)):
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise InvalidInput("interval of {0} {1}: must be above 0", value, unit)
        if every_s is not None and self.time_s is None:
            raise InvalidInput(
                "interval of {0:g} s: the trajectory has no times",
                every_s,
                remedy=Message("give one in metres{0}", OptionName("every_m").in_brackets),
            )
        kept = self
        if every_s is not None and kept.time_s is not None:
            kept = kept.take(_spaced(kept.time_s, every_s))
        if every_m is not None:
            climb_m = np.nan_to_num(np.diff(kept.height_m))
            steps_m = np.hypot(legs(kept.lat_deg, kept.lon_deg).distance_m, climb_m)
            kept = kept.take(_spaced(np.concatenate([[0.0], np.cumsum(steps_m)]), every_m))
        return kept

    @np.errstate(over="ignore", invalid="ignore")
    def points(
        self,
        ground_m: float | None = None,
        agl_m: float | None = None,
        *,
        every_s: float | None = None,
        every_m: float | None = None,
    ) -> tuple[Points, int]:
        """Points of a mission, and the number of positions left out because they are not above the ground.

        Without an attitude, the top of the image points along the way.

        Parameters
        ----------
        ground_m : float or None
            Height of the ground in the file's reference; None for the track's.
        agl_m : float or None
            One height above ground for all positions, instead of the file's heights.
        every_s, every_m : float or None
            Intervals for `thinned`, which is applied to positions above the ground.

        Raises
        ------
        InvalidInput
            A missing or invalid height of the ground or of a position; no position above the ground; numbers that
            overflow when rounded; as for `thinned`.
        """
        agl = np.round(self.above_ground_m(ground_m, agl_m), ANGLE_DIGITS)
        flown = np.flatnonzero(agl > 0.0)
        if not len(flown):
            raise InvalidInput("trajectory: none of its {0:,} positions is above the ground", len(self))
        track = replace(self, height_m=agl).take(flown).thinned(every_s, every_m)
        yaw, tilt, roll = track.attitude_deg or (track.headings_deg(), None, None)
        poses = zip(
            np.round(track.lat_deg, PLACE_DIGITS).tolist(),
            np.round(track.lon_deg, PLACE_DIGITS).tolist(),
            track.height_m.tolist(),
        )
        points = Points(
            tuple(poses),
            _listed(yaw, ANGLE_DIGITS),
            _listed(tilt, ANGLE_DIGITS),
            _listed(roll, ANGLE_DIGITS),
            _listed(track.time_s, 6),
        )
        return points, len(self) - len(flown)

    def above_ground_m(self, ground_m: float | None = None, agl_m: float | None = None) -> Floats:
        """Heights above the ground (n,); arguments and exceptions are those of `points`."""
        if agl_m is not None:
            check_agl(agl_m)
            return np.full(len(self), agl_m)
        if ground_m is not None:
            field_named(Flight, "ground_height_m").settled(ground_m)
        ground_m = self.ground_m if ground_m is None else ground_m
        if ground_m is None:
            raise InvalidInput(
                "trajectory: does not say how high its ground is",
                remedy=Message(
                    "give that in the heights of the file{0}, or one height above ground{1}",
                    OptionName("ground_height").in_brackets,
                    OptionName("agl").in_brackets,
                ),
            )
        unknown = np.flatnonzero(np.isnan(self.height_m))
        if len(unknown):
            raise InvalidInput(
                "trajectory: position {0:,} has no height",
                int(unknown[0]) + 1,
                remedy=Message("give one height above ground{0}", OptionName("agl").in_brackets),
            )
        return self.height_m - ground_m

    def headings_deg(self) -> Floats:
        """Headings (n,) along positions; where these stand still, the previous heading or, at the start, the first."""
        route = legs(self.lat_deg, self.lon_deg)
        # A step below 1 cm has no heading: the vehicle stands still, or a position is logged twice.
        moving = np.append(route.distance_m >= 0.01, False)
        if not moving.any():
            return np.zeros(len(self))
        last = np.maximum.accumulate(np.where(moving, np.arange(len(moving)), np.argmax(moving)))
        headings: Floats = route.headings_deg()[last]
        return headings


def _listed(values: Floats | None, digits: int) -> tuple[float, ...]:
    return () if values is None else tuple((np.round(values, digits) + 0.0).tolist())


def _spaced(along: Floats, interval: float) -> NDArray[np.intp]:
    """Indices of ascending numbers (n,): the first, then each that is at least an interval after the last taken."""
    taken = [0]
    # Rounding may shorten steps that equal the interval.
    interval *= 1.0 - 1e-9
    while True:
        # A tiny interval may not change the number.
        after = max(int(np.searchsorted(along, along[taken[-1]] + interval)), taken[-1] + 1)
        if after >= len(along):
            return np.array(taken, np.intp)
        taken.append(after)
