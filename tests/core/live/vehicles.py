"""A vehicle of known path that speaks MAVLink over a bad link, written with pymavlink alone."""

from __future__ import annotations

import heapq
import math
import random
import socket
import threading
import time

import numpy as np
from pymavlink.dialects.v20 import common
from pyproj import Transformer

HOME = 46.6, 8.1, 150.0
#: A circle: radius, speed, and how far the vehicle rises and falls about home's height.
RADIUS_M, SPEED_M_PER_S, RISE_M = 60.0, 12.0, 5.0
#: Metres of a degree of latitude and longitude in the path's formula; what they are of the Earth does not matter.
PER_DEG = 111_000.0, 76_000.0


def path(time_s):
    """Latitude, longitude, height, and velocities in degrees and metres per second, of the vehicle."""
    turn = SPEED_M_PER_S / RADIUS_M
    lat = HOME[0] + RADIUS_M * np.sin(turn * time_s) / PER_DEG[0]
    lon = HOME[1] + RADIUS_M * np.cos(turn * time_s) / PER_DEG[1]
    height = HOME[2] + RISE_M * np.sin(0.3 * time_s)
    rates = (
        SPEED_M_PER_S * np.cos(turn * time_s) / PER_DEG[0],
        -SPEED_M_PER_S * np.sin(turn * time_s) / PER_DEG[1],
        0.3 * RISE_M * np.cos(0.3 * time_s),
    )
    return lat, lon, height, rates


def velocity_ned(time_s):
    """Metres per second north, east and down, by the radii of curvature of WGS 84."""
    lat, _, height, (lat_rate, lon_rate, climb) = path(time_s)
    a, e2 = 6378137.0, 0.0066943799901413165
    sine = math.sin(math.radians(lat))
    meridian = a * (1 - e2) / (1 - e2 * sine**2) ** 1.5 + height
    normal = a / math.sqrt(1 - e2 * sine**2) + height
    return (
        math.radians(lat_rate) * meridian,
        math.radians(lon_rate) * normal * math.cos(math.radians(lat)),
        -climb,
    )


def attitude(time_s):
    """Roll, pitch and yaw in radians."""
    return 0.2 * np.sin(time_s), 0.1 * np.cos(0.7 * time_s), (time_s * SPEED_M_PER_S / RADIUS_M) % math.tau


#: Origin of local positions, and Unix seconds when the vehicle begins.
ORIGIN, UNIX_S = (46.5998, 8.1003, 120.0), 1_700_000_000
TO_LOCAL = Transformer.from_pipeline(
    "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84 "
    f"+step +proj=topocentric +ellps=WGS84 +lat_0={ORIGIN[0]} +lon_0={ORIGIN[1]} +h_0={ORIGIN[2]}"
)


class Vehicle:
    """Sends heartbeats and poses at 20 Hz, each late by up to `late_s`; a share of the packets is lost.

    A fine one also sends local positions.
    """

    def __init__(self, port, *, late_s=0.0, lost=0.0, seed=1, boot_s=1000.0, fine=False):
        self.link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.link.bind(("127.0.0.1", 0))
        self.to, self.rng = ("127.0.0.1", port), random.Random(seed)
        self.late_s, self.lost, self.boot_s, self.fine = late_s, lost, boot_s, fine
        self.mav = common.MAVLink(None, srcSystem=1, srcComponent=1)
        self.begun_s = time.monotonic()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._fly)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()
        self.link.close()

    def messages(self, time_s):
        """Position and attitude of a moment, as the protocol rounds them."""
        stamp = round((self.boot_s + time_s) * 1000)
        lat, lon, height, _ = path(time_s)
        north, east, down = velocity_ned(time_s)
        yield common.MAVLink_global_position_int_message(
            stamp,
            round(lat * 1e7),
            round(lon * 1e7),
            round(height * 1000),
            round((height - HOME[2]) * 1000),
            round(north * 100),
            round(east * 100),
            round(down * 100),
            0,
        )
        if self.fine:
            east_m, north_m, up_m = TO_LOCAL.transform(lon, lat, height)
            yield common.MAVLink_local_position_ned_message(stamp, north_m, east_m, -up_m, north, east, down)
        yield common.MAVLink_attitude_message(stamp, *attitude(time_s), 0, 0, 0)

    def send(self, message):
        self.link.sendto(message.pack(self.mav), self.to)

    def _fly(self):
        queue, number = [], 0
        while not self._stop.is_set():
            time_s = number * 0.05
            due = self.begun_s + time_s
            while queue and queue[0][0] <= time.monotonic():
                self.link.sendto(heapq.heappop(queue)[2], self.to)
            if time.monotonic() < due:
                self._stop.wait(0.002)
                continue
            unix_us = UNIX_S * 1_000_000 + number * 50_000
            if number % 20 == 0:
                self.send(common.MAVLink_heartbeat_message(2, 12, 0, 0, 4, 3))
                self.send(common.MAVLink_system_time_message(unix_us, round((self.boot_s + time_s) * 1000)))
                if self.fine:
                    lat, lon, height = ORIGIN
                    origin = common.MAVLink_gps_global_origin_message(
                        round(lat * 1e7), round(lon * 1e7), round(height * 1000)
                    )
                    self.send(origin)
            for message in self.messages(time_s):
                if self.rng.random() < self.lost:
                    continue
                late = due + self.rng.uniform(0.0, self.late_s)
                heapq.heappush(queue, (late, len(queue) + number * 100, message.pack(self.mav)))
            number += 1
