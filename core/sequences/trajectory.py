"""Trajectories: the pose of a body in continuous time, twice continuously differentiable.

Each coordinate of the place and of the attitude's quaternion is a cubic spline through the given poses. The quaternion
is normalised where it is used, so that the attitude passes exactly through the given ones and has an exact rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message, OptionName
from ..geodesy.camera import attitude_from_axes, image_axes
from ..geodesy.ellipsoid import sin_cos
from ..geodesy.local import enu_axes, geocentric, geodetic
from ..geodesy.quaternions import quaternions_from_matrices, rotation_matrices
from ..poses.trajectories import BODIES

#: Greatest acceleration of a flight, m/s²; more is a jump in the poses.
HIGHEST_M_PER_S2 = 200.0
#: Greatest turn between neighbouring poses, degrees; a spline of quaternions needs less than 180.
WIDEST_TURN_DEG = 90.0
#: Least number of poses of a spline.
FEWEST_POSES = 4


class Motion(NamedTuple):
    """Motion of a body at given times, in geocentric axes.

    Attributes
    ----------
    place_m, velocity_m_per_s, acceleration_m_per_s2 : array (n, 3)
        Relative to the turning Earth.
    rotation : array (n, 3, 3)
        From the body's axes to geocentric ones.
    rate_rad_per_s : array (n, 3)
        Rate of turn against the Earth, in the body's axes.
    """

    place_m: Floats
    velocity_m_per_s: Floats
    acceleration_m_per_s2: Floats
    rotation: Floats
    rate_rad_per_s: Floats


@dataclass(frozen=True, eq=False)
class Rig:
    """How a camera sits on the body that carries the inertial unit.

    Parameters
    ----------
    body : str
        The body's axes, one of `BODIES`: where the camera looks.
    lever_m : tuple of three floats
        Camera's projection centre in the body's axes.
    tilt_deg : float
        How far the view is raised from there towards the top of the image.
    """

    body: str = "frd"
    lever_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tilt_deg: float = 0.0

    @property
    def camera_axes(self) -> Floats:
        """Camera's axes right, down and view in the body's axes, as columns (3, 3)."""
        right, image_up, view = BODIES[self.body]
        sine, cosine = sin_cos(self.tilt_deg)
        axes: Floats = np.stack([right, sine * view - cosine * image_up, cosine * view + sine * image_up], axis=-1)
        return axes

    def rotations(self, lat_deg: Floats, lon_deg: Floats, attitude_deg: tuple[Floats, Floats, Floats]) -> Floats:
        """Rotations (n, 3, 3) from the body's axes to geocentric ones, for the camera's yaw, tilt and roll."""
        right, image_up, view = image_axes(*attitude_deg)
        to_enu = np.stack([right, -image_up, view], axis=-1) @ self.camera_axes.T
        rotations: Floats = np.swapaxes(enu_axes(lat_deg, lon_deg), -1, -2) @ to_enu
        return rotations

    def camera(self, motion: Motion) -> tuple[Floats, Floats, Floats, tuple[Floats, Floats, Floats]]:
        """Latitude, longitude, height above the ellipsoid, and yaw, tilt and roll of the camera, (n,) each."""
        lat, lon, height = geodetic(motion.place_m + motion.rotation @ np.array(self.lever_m))
        axes = enu_axes(lat, lon) @ motion.rotation @ self.camera_axes
        return lat, lon, height, attitude_from_axes(axes[..., 0], -axes[..., 1], axes[..., 2])


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Smooth trajectory of a body.

    Parameters
    ----------
    start_us : int
        Time of the first pose, microseconds after 1970.
    knots_s : array (n,)
        Times of the given poses after the first, ascending.
    states, slopes : array (n, 7)
        Geocentric place in metres relative to ``origin_m`` and quaternion from the body's axes, w first, and their
        rates.
    origin_m : array (3,)
    """

    start_us: int
    knots_s: Floats
    states: Floats
    slopes: Floats
    origin_m: Floats

    @classmethod
    def through_cameras(
        cls,
        time_s: Floats,
        lat_deg: Floats,
        lon_deg: Floats,
        height_m: Floats,
        attitude_deg: tuple[Floats, Floats, Floats],
        rig: Rig,
        start_us: int,
        smooth_s: float = 0.0,
    ) -> Trajectory:
        """Trajectory of the body through poses of its camera; see `through`."""
        rotations = rig.rotations(lat_deg, lon_deg, attitude_deg)
        places = geocentric(lat_deg, lon_deg, height_m) - rotations @ np.array(rig.lever_m)
        return cls.through(time_s, places, rotations, start_us, smooth_s)

    @classmethod
    def through(
        cls, time_s: Floats, places_m: Floats, rotations: Floats, start_us: int, smooth_s: float = 0.0
    ) -> Trajectory:
        """Trajectory through poses.

        Parameters
        ----------
        time_s : array (n,)
            Seconds after the first pose.
        places_m : array (n, 3)
            Geocentric.
        rotations : array (n, 3, 3)
            From the body's axes to geocentric ones.
        start_us : int
            Time of the first pose, microseconds after 1970.
        smooth_s : float
            Interval of the control points of a uniform cubic B-spline, which no longer meets the poses; 0 to meet them.

        Raises
        ------
        InvalidInput
            Fewer than four poses, times that do not ascend, or jumps.
        """
        if len(time_s) < FEWEST_POSES:
            raise InvalidInput("trajectory of {0} poses: needs at least {1}", len(time_s), FEWEST_POSES)
        late = np.flatnonzero(np.diff(time_s) <= 0.0)
        if len(late):
            at = int(late[0]) + 1
            raise InvalidInput(
                "trajectory: pose {0:,} has the time of the one before it, {1:g} s after the start, or an earlier one",
                at + 1,
                time_s[at],
                remedy="remove one of the two",
            )
        quaternions = _continuous(quaternions_from_matrices(rotations))
        _check_turns(quaternions)
        states = np.concatenate([places_m - places_m[0], quaternions], axis=1)
        if smooth_s:
            time_s, states = _smoothed(time_s, states, smooth_s)
        found = cls(start_us, time_s, states, spline_slopes(time_s, states), places_m[0])
        _check_accelerations(found)
        return found

    @property
    def duration_s(self) -> float:
        """Time from the first pose to the last."""
        return float(self.knots_s[-1])

    def at(self, time_s: Floats) -> Motion:
        """Motion at times (n,) in seconds after the first pose, from 0 to the duration."""
        value, rate, change = evaluate_spline(self.knots_s, self.states, self.slopes, time_s)
        q, dq = value[:, 3:], rate[:, 3:]
        length2 = np.einsum("ni,ni->n", q, q)[:, np.newaxis]
        turn = 2.0 * (q[:, :1] * dq[:, 1:] - dq[:, :1] * q[:, 1:] - np.cross(q[:, 1:], dq[:, 1:]))
        return Motion(
            value[:, :3] + self.origin_m,
            rate[:, :3],
            change[:, :3],
            rotation_matrices(q / np.sqrt(length2)),
            turn / length2,
        )


def _continuous(quaternions: Floats) -> Floats:
    """Quaternions (n, 4) with the signs that bring each nearest to the one before it."""
    products = np.einsum("ni,ni->n", quaternions[1:], quaternions[:-1])
    signs = np.cumprod(np.append(1.0, np.where(products < 0.0, -1.0, 1.0)))
    signed: Floats = quaternions * signs[:, np.newaxis]
    return signed


def _smoothed(time_s: Floats, states: Floats, interval_s: float) -> tuple[Floats, Floats]:
    """Knots (m,) and their states (m, k) of a B-spline, whose control points are states at about an interval."""
    steps = max(round(time_s[-1] / interval_s), FEWEST_POSES - 1)
    knots_s = np.linspace(0.0, time_s[-1], steps + 1)
    control = np.stack([np.interp(knots_s, time_s, column) for column in states.T], axis=1)
    return knots_s, uniform_b_spline(control, steps, np.arange(steps + 1.0))


def _check_turns(quaternions: Floats) -> None:
    cosine = np.abs(np.einsum("ni,ni->n", quaternions[1:], quaternions[:-1]))
    turns = 2.0 * np.degrees(np.arccos(np.minimum(cosine, 1.0)))
    wide = np.flatnonzero(turns > WIDEST_TURN_DEG)
    if len(wide):
        raise InvalidInput(
            "trajectory: jumps by {0:.0f} deg from pose {1:,} to the next: must be at most {2:g}",
            turns[wide[0]],
            int(wide[0]) + 1,
            WIDEST_TURN_DEG,
            remedy="give poses that are closer in time",
        )


def _check_accelerations(found: Trajectory) -> None:
    change = evaluate_spline(found.knots_s, found.states, found.slopes, found.knots_s)[2][:, :3]
    size = np.linalg.norm(change, axis=1)
    worst = int(size.argmax())
    if size[worst] > HIGHEST_M_PER_S2:
        raise InvalidInput(
            "trajectory: jumps at pose {0:,}, {1:g} s after the start: no aircraft accelerates by {2:.0f} m/s²",
            worst + 1,
            found.knots_s[worst],
            size[worst],
            remedy=Message("remove the pose, or smooth the trajectory{0}", OptionName("smooth").in_brackets),
        )


def spline_slopes(time_s: Floats, values: Floats) -> Floats:
    """Slopes (n, k) of the cubic splines through values (n, k) at ascending times (n,), n >= 4.

    The ends are those of "not a knot": the first two and the last two pieces are one polynomial each. The tridiagonal
    system is that of de Boor, A Practical Guide to Splines, chapter IV.
    """
    step = np.diff(time_s)[:, np.newaxis]
    chord = np.diff(values, axis=0) / step
    lower = np.concatenate([step[1:], step[-1:] + step[-2:-1]])
    upper = np.concatenate([step[:1] + step[1:2], step[:-1]])
    middle = np.concatenate([step[1:2], 2.0 * (step[:-1] + step[1:]), step[-2:-1]])
    right = 3.0 * (step[1:] * chord[:-1] + step[:-1] * chord[1:])
    first = ((step[0] + 2.0 * upper[0]) * step[1] * chord[0] + step[0] ** 2 * chord[1]) / upper[0]
    last = (step[-1] ** 2 * chord[-2] + (2.0 * lower[-1] + step[-1]) * step[-2] * chord[-1]) / lower[-1]
    found: Floats = np.concatenate([first[np.newaxis], right, last[np.newaxis]])
    diagonal, below, above = (part[:, 0].tolist() for part in (middle, lower, upper))
    for at in range(1, len(found)):
        share = below[at - 1] / diagonal[at - 1]
        diagonal[at] -= share * above[at - 1]
        found[at] -= share * found[at - 1]
    found[-1] /= diagonal[-1]
    for at in range(len(found) - 2, -1, -1):
        found[at] = (found[at] - above[at] * found[at + 1]) / diagonal[at]
    return found


def evaluate_spline(knots_s: Floats, values: Floats, slopes: Floats, time_s: Floats) -> tuple[Floats, Floats, Floats]:
    """Values and first and second derivatives (m, k) of cubic pieces with given values and slopes (n, k) at knots."""
    at = np.clip(np.searchsorted(knots_s, time_s, side="right") - 1, 0, len(knots_s) - 2)
    step = (knots_s[at + 1] - knots_s[at])[:, np.newaxis]
    x = (time_s - knots_s[at])[:, np.newaxis] / step
    chord = values[at + 1] - values[at]
    start, end = slopes[at] * step, slopes[at + 1] * step
    square, cube = 3.0 * chord - 2.0 * start - end, start + end - 2.0 * chord
    value = values[at] + x * (start + x * (square + x * cube))
    rate = (start + x * (2.0 * square + x * 3.0 * cube)) / step
    change = (2.0 * square + x * 6.0 * cube) / (step * step)
    return value, rate, change


def uniform_b_spline(control: Floats, steps: int, place: Floats) -> Floats:
    """Points (m, k) of a uniform cubic B-spline with control points (steps + 1, k), at places 0 to ``steps``.

    Ends are continued in straight lines, so that the curve begins and ends at the first and last control point.
    """
    ends = 2.0 * control[:1] - control[1:2], 2.0 * control[-1:] - control[-2:-1]
    control = np.concatenate([ends[0], control, ends[1]])
    at = np.clip(np.floor(place).astype(np.intp), 0, steps - 1)
    x = (place - at)[:, np.newaxis]
    weights = ((1.0 - x) ** 3, 3.0 * x**3 - 6.0 * x**2 + 4.0, -3.0 * x**3 + 3.0 * x**2 + 3.0 * x + 1.0, x**3)
    found: Floats = sum((weight * control[at + k] for k, weight in enumerate(weights)), np.zeros(1)) / 6.0
    return found
