"""What refusals of lines that are to be flown advise."""

from __future__ import annotations

import json

import numpy as np
from terrainav.core.poses.line import fly, read_lines
from terrainav.core.poses.settings import LineFlight

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
    case.follow(
        "make two lines of it there", lambda: fly([line(there, turning), line(turning, there)], FLIGHT)
    )


@remedy("poses/line.py", "file {}: its corners have no height above ground; give one for all (--agl)")
def _height(case: Case) -> None:
    path = case.tmp_path / "line.geojson"
    path.write_text(json.dumps({"type": "LineString", "coordinates": [[10, 35], [10, 35.1]]}))
    case.refused(lambda: read_lines(str(path)))
    case.follow("give one for all (--agl)", lambda: read_lines(str(path), 120.0))
