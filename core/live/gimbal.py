"""The gimbal of a MAVLink camera: https://mavlink.io/en/services/gimbal_v2.html."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pymavlink.dialects.v20 import common as protocol

from .following import Mount

#: Lowest and highest pitch.
PITCH_DEG = -90.0, 20.0
#: Lowest and highest roll, pitch and yaw.
LIMITS_RAD = 0.0, 0.0, *map(math.radians, PITCH_DEG), -math.pi, math.pi
CAPABILITIES = (
    protocol.GIMBAL_MANAGER_CAP_FLAGS_HAS_NEUTRAL
    | protocol.GIMBAL_MANAGER_CAP_FLAGS_HAS_ROLL_LOCK
    | protocol.GIMBAL_MANAGER_CAP_FLAGS_HAS_PITCH_AXIS
    | protocol.GIMBAL_MANAGER_CAP_FLAGS_HAS_PITCH_LOCK
    | protocol.GIMBAL_MANAGER_CAP_FLAGS_HAS_YAW_AXIS
    | protocol.GIMBAL_MANAGER_CAP_FLAGS_HAS_YAW_FOLLOW
    | protocol.GIMBAL_MANAGER_CAP_FLAGS_HAS_YAW_LOCK
    | protocol.GIMBAL_MANAGER_CAP_FLAGS_SUPPORTS_INFINITE_YAW
)
_STABLE = protocol.GIMBAL_MANAGER_FLAGS_ROLL_LOCK | protocol.GIMBAL_MANAGER_FLAGS_PITCH_LOCK
_ON_NORTH, _IN_EARTH_FRAME = protocol.GIMBAL_MANAGER_FLAGS_YAW_LOCK, protocol.GIMBAL_MANAGER_FLAGS_YAW_IN_EARTH_FRAME
_RETRACT, _NEUTRAL = protocol.GIMBAL_MANAGER_FLAGS_RETRACT, protocol.GIMBAL_MANAGER_FLAGS_NEUTRAL
_IN_VEHICLE_FRAME = protocol.GIMBAL_MANAGER_FLAGS_YAW_IN_VEHICLE_FRAME

#: System and component.
Sender = tuple[int, int]


class Gimbal:
    """An ideal gimbal: it is at once where it is told to be."""

    def __init__(self, neutral: Mount) -> None:
        self._neutral = self._from = neutral
        self._rates_deg_per_s, self._since_s = (0.0, 0.0), 0.0
        #: System and component that may move it; zeros if none does.
        self.control: Sender = (0, 0)

    def mount(self, now_s: float) -> Mount:
        """Where the camera looks."""
        past_s, (low, high) = now_s - self._since_s, PITCH_DEG
        pitch, yaw = (
            angle + rate * past_s
            for angle, rate in zip((self._from.pitch_deg, self._from.yaw_deg), self._rates_deg_per_s)
        )
        return self._from._replace(pitch_deg=min(max(pitch, low), high), yaw_deg=(yaw + 180.0) % 360.0 - 180.0)

    def move(self, now_s: float, values: Sequence[float], flags: int, heading_deg: float) -> bool:
        """Move as the protocol asks; False if the gimbal cannot.

        Parameters
        ----------
        values : sequence of four floats
            Pitch, yaw and their rates, degrees; NaN for what stays. Rates serve where there is no angle.
        heading_deg : float
            The vehicle's.
        """
        pitch, yaw, *rates = values
        (low, high), here, north = PITCH_DEG, self.mount(now_s), bool(flags & _ON_NORTH)
        if flags & _RETRACT or not (math.isnan(pitch) or low <= pitch <= high) or any(map(math.isinf, (yaw, *rates))):
            return False
        self._since_s = now_s
        if flags & _NEUTRAL:
            self._from, self._rates_deg_per_s = self._neutral, (0.0, 0.0)
            return True
        counts_from_north = bool(flags & _IN_EARTH_FRAME) or (north and not flags & _IN_VEHICLE_FRAME)
        given = (here.yaw_deg, here.on_north) if math.isnan(yaw) else (yaw, counts_from_north)
        self._from = Mount(
            here.pitch_deg if math.isnan(pitch) else pitch,
            # From what the angle counts to what it is held to.
            given[0] + heading_deg * (given[1] - north),
            flags & _STABLE == _STABLE,
            north,
        )
        pitch_rate, yaw_rate = (
            rate if math.isnan(angle) and not math.isnan(rate) else 0.0 for angle, rate in zip((pitch, yaw), rates)
        )
        self._rates_deg_per_s = pitch_rate, yaw_rate
        return True

    @property
    def flags(self) -> int:
        """Flags of the protocol."""
        return int((_STABLE if self._from.on_horizon else 0) | (_ON_NORTH if self._from.on_north else 0))
