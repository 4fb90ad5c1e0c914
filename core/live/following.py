"""Poses of a vehicle that arrive late and with gaps, and its pose at the time of an exposure."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections import Counter, deque
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from ..geodesy.camera import attitude_from_axes
from ..geodesy.local import enu_axes, geocentric, geodetic
from ..geodesy.quaternions import quaternions_from_angles, quaternions_from_matrices, rotation_matrices
from .camera import FrameRequest

#: Seconds of poses that are kept.
_KEPT_S = 10.0
#: Largest change of the delay between a pose's time and its arrival, seconds; more is a clock that jumped.
JUMP_S = 2.0
#: Farthest that a pose may be from the one before it: a distance, and more for each second between.
_REACH_M, _REACH_M_PER_S = 50.0, 400.0
#: So many poses in a row that contradict the track, but not each other, begin it anew.
_STRAYS = 3
#: Longest gap that is interpolated and longest extrapolation, seconds.
WIDEST_GAP_S, FURTHEST_S = 1.0, 0.25
#: Delays that the least is taken from: few, as a simulator's clock may be slower or faster than time.
_DELAYS = 16
#: Highest speed and height of a pose that is taken.
_FASTEST_M_PER_S, _HIGHEST_M = 1000.0, 100_000.0
#: From north, east, down to east, north, up, and back.
_SWAP = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


class VehiclePose(NamedTuple):
    """Pose of a vehicle.

    Attributes
    ----------
    time_s : float
        By the vehicle's clock.
    lat_deg, lon_deg, height_m : float
        Position, as its sender counts heights.
    quaternion : array (4,)
        From the axes ahead, right and down to north, east and down; w first.
    extrapolated_s : float
        Seconds since the last position or attitude that is known; 0 between known ones.
    """

    time_s: float
    lat_deg: float
    lon_deg: float
    height_m: float
    quaternion: Floats
    extrapolated_s: float = 0.0


class Mount(NamedTuple):
    """Attitude of a camera on a vehicle, as an ideal gimbal holds it.

    Attributes
    ----------
    pitch_deg, yaw_deg : float
        Of the view, up from the horizon and to the right of ahead.
    on_horizon : bool
        Whether the gimbal levels the vehicle's pitch and roll.
    on_north : bool
        Whether yaw counts from north instead of the vehicle's.
    """

    pitch_deg: float = -90.0
    yaw_deg: float = 0.0
    on_horizon: bool = True
    on_north: bool = False

    def turn(self, vehicle: Floats) -> Floats:
        """Rotation (3, 3) from the camera's view, right and down to north, east, down, for a vehicle's quaternion."""
        base, heading = rotation_matrices(vehicle[np.newaxis])[0], heading_deg(vehicle)
        if self.on_horizon:
            base = _turned(0.0 if self.on_north else heading)
        elif self.on_north:
            base = _turned(-heading) @ base
        turn: Floats = base @ _turned(self.yaw_deg, self.pitch_deg)
        return turn

    def request(self, pose: VehiclePose, time_s: float, sea_level_m: float = 0.0) -> FrameRequest:
        """Request for the frame of the camera, at heights ``sea_level_m`` above those of the pose."""
        right, down, view = (_SWAP @ self.turn(pose.quaternion)[:, at] for at in (1, 2, 0))
        yaw, tilt, roll = (float(angle) for angle in attitude_from_axes(right, -down, view))
        height_m = pose.height_m + sea_level_m
        return FrameRequest(pose.lat_deg, pose.lon_deg, height_m, yaw, tilt, roll, time_s, above_ellipsoid=True)

    def quaternion(self, vehicle: Floats) -> Floats:
        """Quaternion (4,) of `turn`."""
        found: Floats = quaternions_from_matrices(self.turn(vehicle)[np.newaxis])[0]
        return found


def heading_deg(vehicle: Floats) -> float:
    """Heading of a vehicle's quaternion."""
    turn = rotation_matrices(vehicle[np.newaxis])[0]
    return math.degrees(math.atan2(turn[1, 0], turn[0, 0]))


def vehicle_quaternion(yaw_deg: float, pitch_deg: float, roll_deg: float) -> Floats:
    """Quaternion (4,) of a vehicle's angles."""
    found: Floats = quaternions_from_angles(*(np.array([angle]) for angle in (yaw_deg, pitch_deg, roll_deg)))[0]
    return found


def _turned(yaw_deg: float, pitch_deg: float = 0.0) -> Floats:
    turn: Floats = rotation_matrices(vehicle_quaternion(yaw_deg, pitch_deg, 0.0)[np.newaxis])[0]
    return turn


class _Sample(NamedTuple):
    """What arrived: a geocentric place and velocity (6,), or a quaternion (4,)."""

    time_s: float
    arrived_s: float
    values: Floats

    def contradicts(self, other: _Sample) -> bool:
        span_s = self.time_s - other.time_s
        if abs(span_s - (self.arrived_s - other.arrived_s)) > JUMP_S:
            return True
        reach_m = _REACH_M + _REACH_M_PER_S * abs(span_s)
        return len(self.values) == 6 and bool(np.linalg.norm(self.values[:3] - other.values[:3]) > reach_m)


class _Samples:
    """Samples in the order of their times, arriving in any."""

    def __init__(self) -> None:
        self.times: list[float] = []
        self.samples: list[_Sample] = []

    def add(self, sample: _Sample) -> bool:
        """Add a sample; False if there is one of its time."""
        at = bisect_left(self.times, sample.time_s)
        if at < len(self.times) and self.times[at] == sample.time_s:
            return False
        self.times.insert(at, sample.time_s)
        self.samples.insert(at, sample)
        old = bisect_left(self.times, self.times[-1] - _KEPT_S)
        del self.times[:old], self.samples[:old]
        return True

    def around(self, time_s: float, furthest_s: float) -> tuple[_Sample, _Sample]:
        """Samples before and after a time; the last one twice if the time is up to ``furthest_s`` after it.

        Raises
        ------
        InvalidInput
            There are none, or they are too far away.
        """
        if not self.times or time_s < self.times[0]:
            raise InvalidInput("pose at {0:.3f} s: none is known that early", time_s)
        at = bisect_left(self.times, time_s)
        if at == len(self.times):
            last = self.samples[-1]
            if time_s - last.time_s > furthest_s:
                raise InvalidInput("pose at {0:.3f} s: the last known one is of {1:.3f} s", time_s, last.time_s)
            return last, last
        after = self.samples[at]
        before = after if after.time_s == time_s else self.samples[at - 1]
        if after.time_s - before.time_s > WIDEST_GAP_S:
            raise InvalidInput("pose at {0:.3f} s: none is known for {1:g} s", time_s, after.time_s - before.time_s)
        return before, after


class PoseTrack:
    """Track of a vehicle's poses.

    Positions are interpolated by cubic polynomials that have the given velocities, in geocentric coordinates;
    attitudes by the shortest turn. After the last pose, positions go on at its velocity and the attitude stays. Poses
    may arrive in any order; of those that contradict the track in time or place, the third in a row begins it anew.

    Attributes
    ----------
    counts : Counter
        Poses ``taken``, and those dropped as ``nonsense``, ``repeated`` or ``stray``; and how often the track
        ``restarted``.
    """

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self._places, self._attitudes = _Samples(), _Samples()
        self._delays: deque[float] = deque(maxlen=_DELAYS)
        self._newest: dict[int, _Sample] = {}
        self._strays: dict[int, list[_Sample]] = {}

    def add_place(
        self,
        time_s: float,
        arrived_s: float,
        lat_deg: float,
        lon_deg: float,
        height_m: float,
        velocity_m_per_s: tuple[float, float, float],
    ) -> None:
        """Add a position with its velocity north, east and down."""
        numbers = (time_s, lat_deg, lon_deg, height_m, *velocity_m_per_s)
        # A vehicle without a position sends zeros.
        known = all(map(math.isfinite, numbers)) and abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0
        known = known and abs(height_m) <= _HIGHEST_M and math.hypot(*velocity_m_per_s) <= _FASTEST_M_PER_S
        if not known or lat_deg == lon_deg == 0.0:
            self.counts["nonsense"] += 1
            return
        velocity = enu_axes(lat_deg, lon_deg).T @ _SWAP @ np.array(velocity_m_per_s)
        values = np.concatenate([geocentric(lat_deg, lon_deg, height_m), velocity])
        self._add(self._places, _Sample(time_s, arrived_s, values))

    def add_attitude(self, time_s: float, arrived_s: float, quaternion: Floats) -> None:
        """Add an attitude; the quaternion's length does not matter."""
        length = float(np.linalg.norm(quaternion))
        if not (math.isfinite(time_s) and math.isfinite(length) and length > 1e-6):
            self.counts["nonsense"] += 1
            return
        self._add(self._attitudes, _Sample(time_s, arrived_s, quaternion / length))

    def add_angles(self, time_s: float, arrived_s: float, yaw_deg: float, pitch_deg: float, roll_deg: float) -> None:
        """Add an attitude by a vehicle's angles."""
        angles = (yaw_deg, pitch_deg, roll_deg)
        known = all(map(math.isfinite, angles))
        self.add_attitude(time_s, arrived_s, vehicle_quaternion(*angles) if known else np.zeros(4))

    def _add(self, samples: _Samples, sample: _Sample) -> None:
        kind = len(sample.values)
        newest, strays = self._newest.get(kind), self._strays.setdefault(kind, [])
        if newest is not None and sample.contradicts(newest):
            if strays and sample.contradicts(strays[-1]):
                strays.clear()
            strays.append(sample)
            if len(strays) < _STRAYS:
                self.counts["stray"] += 1
                return
            self._restart()
        strays.clear()
        if not samples.add(sample):
            self.counts["repeated"] += 1
            return
        self.counts["taken"] += 1
        self._newest[kind] = sample
        self._delays.append(sample.arrived_s - sample.time_s)

    def _restart(self) -> None:
        """Forget all poses: the vehicle's clock or place is another."""
        self.counts["restarted"] += 1
        self._places, self._attitudes = _Samples(), _Samples()
        self._delays.clear()
        self._newest.clear()

    def time_s(self, now_s: float) -> float:
        """Time by the vehicle's clock, by the pose that arrived soonest; raises InvalidInput without poses."""
        if not self._delays:
            raise InvalidInput("vehicle: has sent no pose")
        return now_s - min(self._delays)

    @property
    def last_s(self) -> float:
        """Time up to which positions and attitudes are known; minus infinity if one of the two is not."""
        known = self._places.times, self._attitudes.times
        return min(times[-1] if times else -math.inf for times in known)

    @property
    def last_arrival_s(self) -> float:
        """When the last pose arrived; minus infinity without poses."""
        return max((one.arrived_s for one in self._newest.values()), default=-math.inf)

    def at(self, time_s: float, furthest_s: float = FURTHEST_S) -> VehiclePose:
        """Pose at a time by the vehicle's clock.

        Parameters
        ----------
        furthest_s : float
            Longest extrapolation.

        Raises
        ------
        InvalidInput
            No pose is known near that time.
        """
        before, after = self._places.around(time_s, furthest_s)
        lat, lon, height = (float(value) for value in geodetic(_place(before, after, time_s)))
        turned, turning = self._attitudes.around(time_s, furthest_s)
        late_s = max(0.0, time_s - after.time_s, time_s - turning.time_s)
        return VehiclePose(time_s, lat, lon, height, _attitude(turned, turning, time_s), late_s)

    def latest(self) -> VehiclePose:
        """The last pose that is known; raises InvalidInput without one."""
        return self.at(self.last_s)


def _place(before: _Sample, after: _Sample, time_s: float) -> Floats:
    """Place (3,) on the cubic with the places and velocities at both ends."""
    start, rate, end, end_rate = before.values[:3], before.values[3:], after.values[:3], after.values[3:]
    past_s, span_s = time_s - before.time_s, after.time_s - before.time_s
    if span_s == 0.0:
        return start + rate * past_s
    x, chord = past_s / span_s, end - start
    rate, end_rate = rate * span_s, end_rate * span_s
    place: Floats = start + x * (rate + x * (3.0 * chord - 2.0 * rate - end_rate + x * (rate + end_rate - 2.0 * chord)))
    return place


def _attitude(before: _Sample, after: _Sample, time_s: float) -> Floats:
    """Quaternion (4,) on the shortest turn."""
    start, end, span_s = before.values, after.values, after.time_s - before.time_s
    cosine = float(start @ end)
    if cosine < 0.0:
        end, cosine = -end, -cosine
    angle, x = math.acos(min(cosine, 1.0)), 0.0 if span_s == 0.0 else (time_s - before.time_s) / span_s
    if angle < 1e-9:
        return start
    found: Floats = (math.sin((1.0 - x) * angle) * start + math.sin(x * angle) * end) / math.sin(angle)
    return found
