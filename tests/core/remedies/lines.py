"""What refusals of lines and patterns that are to be flown advise."""

from __future__ import annotations

import json

import numpy as np
from terrainav.core.geodesy.camera import Camera
from terrainav.core.poses.line import fly, read_lines
from terrainav.core.poses.patterns import corridor, facade
from terrainav.core.poses.settings import Corridor, LineFlight, Orbit, Scan

from tests.support.remedies import Case, remedy

FLIGHT = LineFlight(12.0, every_s=1.0)


def line(*corners):
    return np.array([(lat, lon, 120.0) for lat, lon in corners])


@remedy(
    "poses/line.py",
    "line {}: turns by {} degrees at {}, {}, between legs of {} m and {} m; make two lines of it there, or simplify it",
)
def _sharp(case: Case) -> None:
    there, turning = (35.0, 10.0), (35.001, 10.0)
    case.refused(lambda: fly([line(there, turning, there)], FLIGHT))
    case.follow("simplify it", lambda: fly([line(there, turning)], FLIGHT))
    case.follow("make two lines of it there", lambda: fly([line(there, turning), line(turning, there)], FLIGHT))


@remedy("poses/line.py", "file {}: its corners have no height above ground; give one for all (--agl)")
def _height(case: Case) -> None:
    path = case.tmp_path / "line.geojson"
    path.write_text(json.dumps({"type": "LineString", "coordinates": [[10, 35], [10, 35.1]]}))
    case.refused(lambda: read_lines(str(path)))
    case.follow("give one for all (--agl)", lambda: read_lines(str(path), 120.0))


WALL = line((35.0, 10.0), (35.001, 10.0), (35.001, 10.0001), (35.0, 10.0001))[:, :2]
CAMERA, OVERLAPS = Camera(), (0.5, 0.5)


@remedy("poses/patterns.py", "line of {} km: a pattern reaches up to {} km; take shorter lines")
def _long(case: Case) -> None:
    strip = Corridor(0.0)
    case.refused(
        lambda: corridor([line((35.0, 10.0), (35.0, 20.0))], CAMERA, 120.0, OVERLAPS, strip),
    )
    case.follow(
        "take shorter lines",
        lambda: corridor([line((35.0, 10.0), (35.0, 10.01))], CAMERA, 120.0, OVERLAPS, strip),
    )


@remedy(
    "poses/patterns.py",
    "distance {} m: no place is so far from every wall; take a shorter distance",
)
def _narrow(case: Case) -> None:
    yard = np.append(WALL, WALL[:1], axis=0)
    case.refused(lambda: facade([yard], CAMERA, OVERLAPS, Scan(20.0, 9.0)))
    case.follow("take a shorter distance", lambda: facade([yard], CAMERA, OVERLAPS, Scan(2.0, 9.0)))


@remedy("poses/settings.py", "{} circles at one height: must be 1; give the highest height as well")
def _circles(case: Case) -> None:
    case.refused(lambda: Orbit(20.0, 10.0, circles=2))
    case.follow("give the highest height as well", lambda: Orbit(20.0, 10.0, 30.0, circles=2))
