"""What the pixels of a dataset mean, as a file of the dataset states it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..dataset.cameras import INTRINSICS, LENS
from ..dataset.folder import TABLE_FILE
from ..geodesy.contract import CAMERA_FILE, CONVENTIONS, SCHEMA
from ..map_types import UNDISTORTED
from ..mission.plan import Plan
from ..picture.optics import shared_contract
from ..storage.files import json_bytes, write_whole


def write_cameras(plan: Plan, folder: Path) -> None:
    """Write the cameras of a plan's pictures into the folder of its dataset; raises OutputError."""
    write_whole(folder / CAMERA_FILE, json_bytes(camera_record(plan)))


def camera_record(plan: Plan) -> dict[str, Any]:
    """Camera contract of a plan's pictures, JSON-ready, with the columns of tables that state it of each image.

    Without intrinsics, the images have several cameras, and the columns alone state them.
    """
    record = {"schema": SCHEMA, **_intrinsics(plan), **CONVENTIONS}
    if plan.mission.varied.keep_undistorted:
        record[UNDISTORTED] = _intrinsics(plan.undistorted)
    return {**record, "table": _columns(plan)}


def _intrinsics(plan: Plan) -> dict[str, Any]:
    """Intrinsics of a plan's pictures; empty if they have several."""
    shared = shared_contract(plan)
    return {} if shared is None else shared.intrinsics


def _columns(plan: Plan) -> dict[str, Any]:
    """Columns that state cameras and poses, by what they state."""
    distorts = plan.cameras.distort
    coefficients = plan.cameras.distinct[0].coefficients if distorts else ()
    pose = {"lat_deg": "pose_lat_deg", "lon_deg": "pose_lon_deg"}
    # Of a camera above level ground, tables state the height above that ground alone.
    height: dict[str, Any] = {"agl_m": "agl_m", "ground_height_m": plan.level_m}
    if not plan.relief.is_level:
        height = {"height_m": "height_m"}
    return {
        "file": TABLE_FILE,
        "image": "img_names",
        **INTRINSICS,
        **({LENS: LENS, "distortion": list(coefficients)} if distorts else {}),
        **pose,
        **height,
        **{name: name for name in ("yaw_deg", "tilt_deg", "roll_deg")},
        **({"time": "time_utc"} if plan.direct.has_times else {}),
    }
