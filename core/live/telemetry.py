"""Poses of a vehicle from its MAVLink messages.

GLOBAL_POSITION_INT counts in 1e-7 degrees, which are up to 11 mm. LOCAL_POSITION_NED counts finer, from the origin that
GPS_GLOBAL_ORIGIN states, but autopilots project it in ways of their own. So it serves where it says the same place as
GLOBAL_POSITION_INT of the same time, to its last digit.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..arrays import Floats
from ..geodesy.local import LocalFrame
from ..mission.clock import is_dated
from .following import PoseTrack

#: Messages of the vehicle that are followed.
MESSAGES = ("GLOBAL_POSITION_INT", "ATTITUDE", "SYSTEM_TIME", "LOCAL_POSITION_NED", "GPS_GLOBAL_ORIGIN")
#: Largest difference of rounded positions and heights, in units of the message: rounding, and that of 32-bit floats.
_AGREE = 0.75
#: Positions that wait for the other one of their time; milliseconds without local ones after which global ones serve.
_REMEMBERED, _MISSED_MS = 32, 500


#: Highest height, mm.
_HIGHEST_MM = 100_000_000


class Telemetry:
    """What a vehicle sends of itself.

    Attributes
    ----------
    track : PoseTrack
    home_alt_mm : int
        Height of home above the vehicle's sea level.
    is_fine : bool
        Whether local positions serve.
    """

    def __init__(self, track: PoseTrack) -> None:
        self.track, self.home_alt_mm, self.is_fine = track, 0, False
        self._boot_us = 0
        self._origin: LocalFrame | None = None
        self._global: dict[int, Any] = {}
        self._local: dict[int, Floats] = {}
        self._last_local_ms = -math.inf

    def unix_us(self, time_ms: int) -> int:
        """Microseconds since 1970 of a time by the vehicle's clock; 0 if the vehicle does not say."""
        return self._boot_us + 1000 * time_ms if self._boot_us else 0

    def receive(self, message: Any, now_s: float) -> None:
        """Handle one of `MESSAGES`."""
        kind = message.get_type()
        if kind == "GLOBAL_POSITION_INT":
            self._add_global(message, now_s)
        elif kind == "LOCAL_POSITION_NED":
            self._add_local(message, now_s)
        elif kind == "ATTITUDE":
            angles = (math.degrees(angle) for angle in (message.yaw, message.pitch, message.roll))
            self.track.add_angles(message.time_boot_ms / 1000.0, now_s, *angles)
        elif kind == "GPS_GLOBAL_ORIGIN":
            lat, lon = message.latitude / 1e7, message.longitude / 1e7
            found = LocalFrame(lat, lon, message.altitude / 1000.0) if abs(lat) <= 90.0 and abs(lon) <= 180.0 else None
            if found != self._origin:
                self._origin, self.is_fine = found, False
                self._local.clear()
        elif is_dated(np.array([message.time_unix_usec / 1e6]))[0]:
            self._boot_us = message.time_unix_usec - 1000 * message.time_boot_ms

    def _add_global(self, message: Any, now_s: float) -> None:
        time_ms = message.time_boot_ms
        if max(abs(message.alt), abs(message.relative_alt)) <= _HIGHEST_MM:
            self.home_alt_mm = message.alt - message.relative_alt
        _remember(self._global, time_ms, message)
        self._compare(time_ms)
        if abs(time_ms - self._last_local_ms) > _MISSED_MS:
            self.is_fine = False
        if not self.is_fine:
            place = message.lat / 1e7, message.lon / 1e7, message.alt / 1000.0
            velocity = message.vx / 100.0, message.vy / 100.0, message.vz / 100.0
            self.track.add_place(time_ms / 1000.0, now_s, *place, velocity)

    def _add_local(self, message: Any, now_s: float) -> None:
        ned = np.array([message.x, message.y, message.z], np.float64)
        if self._origin is None or not np.isfinite(ned).all():
            return
        time_ms = message.time_boot_ms
        lat, lon, height = (float(one) for one in self._origin.geodetic(ned[[1, 0, 2]] * [1.0, 1.0, -1.0]))
        _remember(self._local, time_ms, np.array([lat * 1e7, lon * 1e7, height * 1000.0]))
        self._last_local_ms = time_ms
        self._compare(time_ms)
        if self.is_fine:
            self.track.add_place(time_ms / 1000.0, now_s, lat, lon, height, (message.vx, message.vy, message.vz))

    def _compare(self, time_ms: int) -> None:
        """Find whether both positions of a time agree, once both are there."""
        if time_ms in self._global and time_ms in self._local:
            rounded = self._global[time_ms]
            differences = self._local[time_ms] - [rounded.lat, rounded.lon, rounded.alt]
            self.is_fine = bool(np.abs(differences).max() <= _AGREE)


def _remember(values: dict[int, Any], time_ms: int, value: Any) -> None:
    values[time_ms] = value
    if len(values) > _REMEMBERED:
        del values[next(iter(values))]
