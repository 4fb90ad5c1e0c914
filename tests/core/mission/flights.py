"""Plans that the exports are tested with."""

from __future__ import annotations

from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

HERE = Mission(Box(35.16, -89.90, 35.155, -89.89), 120.0, yaw_deg=-30.0, tilt_deg=20.0, start="2024-06-21T10:30:00.25Z")
ACROSS = Mission(Box(0.01, 179.99, -0.01, -179.99), 300.0)
IN_WIND = HERE.replace(wind=Wind(8.0, 270.0, 0.2))
ALONE = Mission(Points(((35.1, -89.8, 120.0),)), 120.0)


def worked_out(mission):
    return plan(mission, PixelGrid())
