"""Choices of live interfaces, importable without numerics."""

from __future__ import annotations

#: Addresses that only programs on this machine reach.
LOOPBACK = ("127.0.0.1", "::1", "localhost")
#: Usual ports: of HTTP, AirSim's own, of RTSP where no right is needed, and that of FlightGear's FDM.
HTTP_PORT, AIRSIM_PORT, RTSP_PORT, FDM_PORT = 8421, 41451, 8554, 5550
#: Where autopilots in simulation send to companions of theirs.
MAVLINK_ADDRESS = "udp:127.0.0.1:14540"
