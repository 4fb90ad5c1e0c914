"""Poses from flight simulators that speak FlightGear's native FDM protocol, such as JSBSim and ArduPilot's SITL.

Packets are those of version 24, 408 bytes: FlightGear's ``src/Network/net_fdm.hxx``, in network byte order. They state
time in whole seconds, so the time of a pose is that of its arrival.
"""

from __future__ import annotations

import asyncio
import math
import struct
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from ..units import M_PER_FT
from .following import Mount, PoseTrack
from .serving import FrameServer

VERSION, PACKET_BYTES = 24, 408
#: Version; longitude, latitude in radians, altitude in metres; height above ground, roll, pitch, yaw in radians, angles
#: of attack and slip, three rates, airspeed, climb, and velocities north, east and down in feet per second.
_BEGIN = struct.Struct(">I4x3d14f")


def add_packet(track: PoseTrack, packet: bytes, arrived_s: float) -> None:
    """Add the pose of a packet to a track, which counts what is no packet as nonsense."""
    version = int.from_bytes(packet[:4], "big")
    if len(packet) != PACKET_BYTES or version != VERSION:
        track.counts["nonsense"] += 1
        return
    _, lon, lat, altitude_m, _, roll, pitch, yaw, *_, north, east, down = _BEGIN.unpack_from(packet)
    lat, lon, roll, pitch, yaw = (math.degrees(angle) for angle in (lat, lon, roll, pitch, yaw))
    velocity = (north * M_PER_FT, east * M_PER_FT, down * M_PER_FT)
    track.add_place(arrived_s, arrived_s, lat, (lon + 180.0) % 360.0 - 180.0, altitude_m, velocity)
    track.add_angles(arrived_s, arrived_s, yaw, pitch, roll)


class _Packets(asyncio.DatagramProtocol):
    def __init__(self, track: PoseTrack) -> None:
        self.track = track

    def datagram_received(self, data: bytes, addr: object) -> None:
        del addr
        add_packet(self.track, data, time.time())


@asynccontextmanager
async def serve(server: FrameServer, host: str, port: int, sea_level_m: float = 0.0) -> AsyncIterator[PoseTrack]:
    """Follow a simulator until the end of the block; raises OSError if the port cannot be used.

    The camera is fixed to the aircraft, as the mission's yaw and tilt say.

    Parameters
    ----------
    sea_level_m : float
        Height above the ellipsoid that the simulator's altitudes count from.
    """
    track, start = PoseTrack(), server.camera.start
    mount = Mount(start.tilt_deg - 90.0, start.yaw_deg, on_horizon=False)
    loop = asyncio.get_running_loop()
    transport, _ = await loop.create_datagram_endpoint(lambda: _Packets(track), local_addr=(host, port))
    try:
        with server.following(lambda: mount.request(pose := track.latest(), pose.time_s, sea_level_m)):
            yield track
    finally:
        transport.close()
