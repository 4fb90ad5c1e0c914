"""Files with poses and cameras that OpenDroneMap reads beside a map type's JPEG images.

``geo.txt`` is for OpenDroneMap's option ``--geo``: the CRS, then a line for each image with longitude, latitude, height
above the ellipsoid in metres, yaw, pitch and roll in degrees (see `xmp`), and horizontal and vertical accuracies in
metres. Lines of images that cleaning has moved do no harm, as OpenDroneMap looks up lines by image name.
``cameras.json`` is for ``--cameras``.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import NDArray, Numbers
from ..geodesy.camera import Camera
from ..geodesy.contract import DEGREE_DECIMALS
from ..geodesy.lens import FISHEYE
from ..geodesy.mercator import wrap_lon_deg
from ..mission.plan import Plan
from ..picture.optics import Optics, camera_body, plan_optics
from ..storage.files import json_bytes, write_whole
from .metadata import MAKE, FocalTags, accuracy, degrees, figure

GEO_FILE = "geo.txt"
CAMERAS_FILE = "cameras.json"


def write_odm_files(folder: Path, plan: Plan, at: Numbers) -> None:
    """Write both files.

    Parameters
    ----------
    folder : Path
        Folder of a map type.
    plan : Plan
        Plan of JPEG images.
    at : array (k,) of int64
        Indices of the captures whose images exist, in the plan's order.

    Raises
    ------
    OutputError
    """
    optics = plan_optics(plan, at)
    write_whole(folder / GEO_FILE, _geo_blocks(plan, at, optics))
    write_whole(folder / CAMERAS_FILE, json_bytes(odm_cameras(plan, at, optics)))


def _geo_blocks(plan: Plan, at: Numbers, optics: Optics) -> Iterator[bytes]:
    yield b"EPSG:4326\n"
    rows_at_once = 2000
    for start in range(0, len(at), rows_at_once):
        rows = slice(start, start + rows_at_once)
        poses = plan.poses.take(at[rows])
        accuracies = Optics(*(values[rows] for values in optics)).accuracy_m(poses.agl_m)
        numbers = np.stack(
            [
                wrap_lon_deg(np.round(poses.lon_deg, DEGREE_DECIMALS)),
                poses.lat_deg,
                plan.height_m[at[rows]],
                *poses.attitude,
                *accuracies,
            ],
            axis=1,
        )
        forms = (degrees, degrees, figure, degrees, degrees, degrees, accuracy, accuracy)
        lines = (
            f"{plan.names[index]}.jpg {' '.join(repr(form(value)) for form, value in zip(forms, row))}\n"
            for index, row in zip(at[rows].tolist(), numbers.tolist())
        )
        yield "".join(lines).encode("utf-8")


def odm_cameras(plan: Plan, at: Numbers, optics: Optics) -> dict[str, dict[str, Any]]:
    """Return cameras of captures (k,) by the names that OpenDroneMap derives from an image's tags.

    A name has the image's size and the focal length in image widths, cut to six characters, so images of one camera may
    have different names at other latitudes or if one is a pixel wider. The model is Brown's, which has focal lengths
    along rows and columns, or OpenCV's fisheye. Lengths are relative to the longer side, and midway between the
    extremes of the images that share a name. Without cameras if lenses have coefficients that OpenDroneMap ignores, or
    if different lenses have one name.
    """
    found: dict[str, list[tuple[float, ...]]] = {}
    lenses: dict[str, Camera] = {}
    for camera, which in plan.cameras[at].groups():
        if any((camera.k4, camera.k5, camera.k6)):
            return {}
        body = camera_body(camera)
        # OpenDroneMap's name for a fisheye.
        projection = "fisheye_opencv" if body.lens == FISHEYE else body.lens
        for width, height, focal_x, focal_y in np.unique(np.stack(optics[:4], axis=1)[which], axis=0).tolist():
            ratio = FocalTags.from_lengths(body.focal_length_mm, focal_x, focal_y).ratio(int(width))
            size = f"{int(width)} {int(height)}"
            name = f"v2 {MAKE} {body.model} {size} {projection} {str(ratio)[:6]}".lower()
            if lenses.setdefault(name, camera) != camera:
                return {}
            found.setdefault(name, []).append((width, height, focal_x, focal_y))
    return {name: _camera(lenses[name], np.array(found[name])) for name in sorted(found)}


def _camera(camera: Camera, sizes_and_focals: NDArray[np.float64]) -> dict[str, Any]:
    width, height, focal_x, focal_y = ((sizes_and_focals.min(axis=0) + sizes_and_focals.max(axis=0)) / 2.0).tolist()
    longer = max(width, height)
    is_fisheye = camera.lens == FISHEYE
    names = ("k1", "k2", "k3") if is_fisheye else ("k1", "k2", "k3", "p1", "p2")
    return {
        "projection_type": "fisheye_opencv" if is_fisheye else "brown",
        "width": int(width),
        "height": int(height),
        "focal_x": figure(focal_x / longer),
        "focal_y": figure(focal_y / longer),
        "c_x": figure(camera.principal_x * width / longer),
        "c_y": figure(camera.principal_y * height / longer),
        **{name: figure(getattr(camera, name)) for name in names},
    }
