"""Flight times from take-off to landing: of the plan, and of its `.plan` file as QGroundControl counts it.

    python benchmarks/flight_times.py

QGroundControl's count is written anew after `MissionFlightStatusCalculator::recalc` of its development version: a
vertical climb and landing at the settings' default speeds, level legs on a sphere at the hover speed, the holds of
waypoints, and the way home. Climbs between waypoints, turns and gimbals take no time.
"""

from __future__ import annotations

import json
import math
import tempfile
from pathlib import Path

from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Polygon
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import Plan, plan
from terrainav.core.picture.heights import mission_heights

#: Defaults of QGroundControl's settings, m/s, and the radius of Qt's sphere.
ASCENT_M_PER_S, DESCENT_M_PER_S, RADIUS_M = 3.0, 1.0, 6_371_007.2
FIELD = Box(47.405, 8.500, 47.400, 8.510)
HOME = {"takeoff": (47.399, 8.499)}
OVERLAPS = {"overlap_along": 0.7, "overlap_across": 0.7}
MISSIONS = {
    "field, each image a waypoint": Mission(FIELD, 100.0, Camera(), **OVERLAPS),
    "field by distance, take-off": Mission(FIELD, 100.0, Camera(), trigger="distance", **HOME, **OVERLAPS),
    "field with turnarounds, 8 m/s": Mission(
        FIELD, 60.0, Camera(), trigger="distance", turnaround_m=30.0, airspeed_m_per_s=8.0, **HOME, **OVERLAPS
    ),
    "triangle, hovering": Mission(
        Polygon((((8.500, 47.400), (8.510, 47.400), (8.505, 47.406)),)), 100.0, trigger="hover", **HOME, **OVERLAPS
    ),
    "hills, batteries of 8 min": Mission(
        FIELD, 100.0, trigger="distance", elevation=("world",), battery_min=8.0, **HOME, **OVERLAPS
    ),
    "field in wind of 6 m/s": Mission(
        FIELD, 100.0, trigger="distance", wind=Wind(6.0, 270.0, 0.0), frame="camera", **HOME, **OVERLAPS
    ),
}


def distance_m(one: list[float], other: list[float]) -> float:
    """Distance on Qt's sphere."""
    (lat, lon), (to_lat, to_lon) = (map(math.radians, place) for place in (one, other))
    half = math.sin((to_lat - lat) / 2.0) ** 2 + math.cos(lat) * math.cos(to_lat) * math.sin((to_lon - lon) / 2.0) ** 2
    return 2.0 * RADIUS_M * math.asin(math.sqrt(half))


def counted_s(file: Path) -> float:
    """Seconds that QGroundControl counts for a multicopter."""
    mission = json.loads(file.read_text())["mission"]
    *home, _ = mission["plannedHomePosition"]
    speed, at, height, seconds = mission["hoverSpeed"], home, 0.0, 0.0
    for item in mission["items"]:
        params = item["params"]
        if item["command"] == 178:
            speed = params[1]
        elif item["command"] == 20:
            return seconds + distance_m(at, home) / speed + height / DESCENT_M_PER_S
        elif item["command"] in (16, 22):
            height, to = params[6], params[4:6]
            seconds += height / ASCENT_M_PER_S if item["command"] == 22 else params[0]
            seconds += distance_m(at, to) / speed
            at = to
    return seconds


def planned(mission: Mission) -> Plan:
    """Plan on tiles of the embedded world's zooms."""
    return plan(
        mission, PixelGrid(max_zoom=20, native_zoom=20), mission_heights(mission) if mission.terrain.elevation else None
    )


def main() -> None:
    """Print a row for each mission."""
    with tempfile.TemporaryDirectory() as folder:
        for name, mission in MISSIONS.items():
            made = planned(mission)
            ours = estimate(made).airborne_s or 0.0
            theirs = sum(counted_s(file) for file in write_plan(made, Path(folder) / f"{len(name)}.plan").files)
            print(
                f"| {name} | {ours / 60.0:.2f} min | {theirs / 60.0:.2f} min | {100.0 * (ours / theirs - 1.0):+.1f} % |"
            )


if __name__ == "__main__":
    main()
