"""Read poses from the CSV that Litchi's Mission Hub exports.

Columns and codes: https://www.litchiutilities.com/docs/litchiCsv.php.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..errors import InvalidInput, Message
from ..geodesy.mercator import wrap_lon_deg
from ..geodesy.projections import geodesic_ends, geodesics
from ..limits import MAX_POSES
from ..text.plain import finite_number
from ..units import LENGTHS_M
from .areas.area import Points

#: Columns of heights, by their unit.
_HEIGHTS = {"altitude(m)": "m", "altitude(ft)": "ft"}
#: Latitude, longitude, height above ground, yaw and tilt.
Pose = tuple[float, float, float, float, float]


def is_litchi(columns: Sequence[str]) -> bool:
    """Whether a table with these columns, in lower case, is a Litchi mission."""
    needed = {"latitude", "longitude", "heading(deg)", "gimbalpitchangle", "altitudemode"}
    return set(columns) >= needed and any(name in columns for name in _HEIGHTS)


def read_litchi(lines: Sequence[str], where: str, agl_m: float | None = None) -> Points:
    """Read the poses of a mission's images, at waypoints and by distance along legs; without images, of all waypoints.

    Parameters
    ----------
    lines : sequence of str
        Lines of the table, the header first.
    where : str
        Name of the table, for messages.
    agl_m : float or None
        Height above ground of all images, instead of the column.

    Raises
    ------
    InvalidInput
        A line cannot be read, or its height does not count from the ground.
    """
    try:
        rows = [
            {(name or "").strip().lower(): cell for name, cell in row.items() if isinstance(cell, str) and cell}
            for row in csv.DictReader([line for line in lines if line.strip()])
        ]
    except csv.Error as wrong:
        raise InvalidInput("{0}: cannot be read as a table ({1})", where, wrong) from wrong
    poses = [_pose(row, Message("{0}, waypoint {1}:", where, at), agl_m) for at, row in enumerate(rows, 1)]
    if not poses:
        raise InvalidInput("{0}: holds no poses below its header", where)
    found: list[Pose] = []
    for at, (row, pose) in enumerate(zip(rows, poses)):
        # Action 1 takes an image.
        if any(row.get(name) == "1" for name in row if name.startswith("actiontype")):
            found.append(pose)
        waypoint = Message("{0}, waypoint {1}:", where, at + 1)
        spacing_m = finite_number(row.get("photo_distinterval", "-1"), waypoint)
        if spacing_m > 0.0 and at + 1 < len(poses):
            found += _leg_poses(pose, poses[at + 1], spacing_m, waypoint)
        if len(found) > MAX_POSES:
            raise _too_many(waypoint, spacing_m)
    lat, lon, agl, yaw, tilt = zip(*(found or poses))
    return Points(tuple(zip(lat, lon, agl)), yaw, tilt)


def _pose(row: Mapping[str, str], where: str, agl_m: float | None) -> Pose:
    lat, lon, yaw = (finite_number(row.get(name, ""), where) for name in ("latitude", "longitude", "heading(deg)"))
    # Only mode 2 (interpolate) sets the pitch; elsewhere the camera is taken to look straight down.
    pitch = -90.0
    if row.get("gimbalmode", "2") == "2":
        pitch = finite_number(row.get("gimbalpitchangle", ""), where)
    if agl_m is None:
        name, unit = next((one for one in _HEIGHTS.items() if one[0] in row), ("altitude(m)", "m"))
        agl_m = finite_number(row.get(name, ""), where) * LENGTHS_M[unit]
        # Mode 1 counts heights from the ground.
        if row.get("altitudemode") != "1":
            raise InvalidInput(
                "{0} its height of {1:g} m is above the take-off (altitudemode {2}): must be above the ground (1)",
                where,
                agl_m,
                row.get("altitudemode", ""),
            )
    pose = lat, lon, agl_m, yaw, 90.0 + pitch
    try:
        Points((pose[:3],), (yaw,), (pose[4],))
    except InvalidInput as wrong:
        raise InvalidInput("{0} {1}", where, wrong) from wrong
    return pose


def _too_many(where: str, spacing_m: float) -> InvalidInput:
    return InvalidInput("{0} images each {1:g} m: must be {2:,} in all or fewer", where, spacing_m, MAX_POSES)


def _leg_poses(start: Pose, end: Pose, spacing_m: float, where: str) -> list[Pose]:
    """Poses of the images taken by distance between two waypoints, without the waypoints themselves."""
    ends = (np.array([value]) for value in (*start[:2], *end[:2]))
    azimuth, _, (length_m,) = geodesics(*ends)
    if float(length_m) / spacing_m > MAX_POSES:
        raise _too_many(where, spacing_m)
    # The end waypoint replaces an image within half a spacing of it.
    count = max(math.ceil(float(length_m) / spacing_m - 0.5) - 1, 0)
    along = spacing_m * np.arange(1.0, count + 1.0)
    first_lat, first_lon, azimuths = (np.full(count, value) for value in (start[0], start[1], azimuth[0]))
    lat, lon, _ = geodesic_ends(first_lat, first_lon, azimuths, along)
    agl = start[2] + along / max(float(length_m), spacing_m) * (end[2] - start[2])
    return [(*place, *start[3:]) for place in zip(lat.tolist(), wrap_lon_deg(lon).tolist(), agl.tolist())]
