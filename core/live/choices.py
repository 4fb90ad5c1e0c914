"""Choices of live interfaces, importable without numerics."""

from __future__ import annotations

#: Addresses that only programs on this machine reach.
LOOPBACK = ("127.0.0.1", "::1", "localhost")
#: Usual ports: of HTTP, and AirSim's own.
HTTP_PORT, AIRSIM_PORT = 8421, 41451
