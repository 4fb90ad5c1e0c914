"""Poses that differ at random from the planned ones, as a mission's distributions say."""

from __future__ import annotations

import numpy as np

from ...arrays import Floats, Numbers
from ...errors import InvalidInput
from ...geodesy.camera import Poses
from ...geodesy.ellipsoid import WGS84, Ellipsoid
from ..mission import Mission
from ..parts.varied import place_of_pose


def vary_poses(mission: Mission, column: Numbers, row: Numbers, poses: Poses, ground: Ellipsoid) -> Poses:
    """Move and turn poses (n,) at random.

    A drawn height or angle takes the place of the mission's: the pose changes by the difference. So rows that turn with
    their track, and points with angles of their own, keep theirs. Draws are by column and row, which no pose changes.

    Raises
    ------
    InvalidInput
        A camera would be on the ground or below it.
    """
    varied, seed = mission.varied, mission.imagery.seed
    places = [place_of_pose(*place) for place in zip(column.tolist(), row.tolist())]
    values = {one.field: np.array([one.draw(seed, place) for place in places]) for one in varied.of_poses}
    moved = _moved(poses, values.pop("east_m", 0.0), values.pop("north_m", 0.0), ground)
    usual = {"agl_m": mission.flight.agl_m, **_angles(mission)}
    changed = {name: getattr(moved, name) + (drawn - usual[name]) for name, drawn in values.items()}
    lowest_m = float(np.min(changed.get("agl_m", 1.0)))
    if lowest_m <= 0.0:
        raise InvalidInput(
            "vary {0!r}: one of the cameras would be {1:g} m above the ground",
            next(str(one) for one in mission.varied.of_poses if one.field == "agl_m"),
            lowest_m,
            field="vary",
            remedy="fly higher, or choose another distribution",
        )
    return moved._replace(**changed)


def _angles(mission: Mission) -> dict[str, float]:
    return {name: getattr(mission.attitude, name) for name in ("yaw_deg", "tilt_deg", "roll_deg")}


def _moved(poses: Poses, east_m: Floats | float, north_m: Floats | float, ground: Ellipsoid) -> Poses:
    """Poses moved along geodesics, over ground at any height."""
    if np.ndim(east_m) == np.ndim(north_m) == 0:
        return poses
    # Imported here, as it loads PROJ.
    from ...geodesy.projections import geodesic_ends

    azimuth_deg = np.degrees(np.arctan2(east_m, north_m)) + np.zeros(len(poses.lat_deg))
    length_m = np.hypot(east_m, north_m) * (WGS84.a_m / ground.a_m)
    lat_deg, lon_deg, _ = geodesic_ends(poses.lat_deg, poses.lon_deg, azimuth_deg, length_m)
    # Longitudes stay continuous along the mission.
    turns = np.rint((lon_deg - poses.lon_deg) / 360.0)
    return poses._replace(lat_deg=lat_deg, lon_deg=lon_deg - 360.0 * turns)
