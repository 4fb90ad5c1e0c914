"""Formats of photogrammetry, radiance fields and trajectories.

Coordinates are in metres east, north and up of an origin, which ``origin.json`` in the same folder describes.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput
from ..geodesy.contract import CAMERA_FILE, CameraContract
from ..geodesy.quaternions import quaternions_from_matrices
from ..storage.files import json_bytes, make_folder, new_folder, write_whole
from .views import ORIGIN_FILE, Views, origin_record


def export(views: Views, folder: str | os.PathLike[str], kind: str) -> Path:
    """Write views in a format; return the folder.

    Parameters
    ----------
    kind : str
        One of `FORMATS`.

    Raises
    ------
    InvalidInput
        The format is unknown.
    OutputError
        The folder cannot be written, or is not empty.
    """
    if kind not in FORMATS:
        raise InvalidInput("format {0!r}: must be one of {1}", kind, ", ".join(FORMATS))
    path = new_folder(folder)
    for name, text in FORMATS[kind](views, path).items():
        make_folder((path / name).parent)
        write_whole(path / name, text.encode("utf-8"))
    write_whole(path / ORIGIN_FILE, json_bytes(origin_record(views.frame)))
    write_whole(path / CAMERA_FILE, json_bytes(views.camera_record()))
    return path


def colmap(views: Views, _: Path) -> dict[str, str]:
    """COLMAP model as text in ``sparse/0``: cameras and images, without points.

    Poses transform world to camera coordinates, with OpenCV's axes. There is one camera for each image size and lens.
    The model is that of the lens: PINHOLE, OPENCV, FULL_OPENCV or OPENCV_FISHEYE.
    """
    found: dict[tuple[str, tuple[float, ...]], int] = {}
    lines = []
    quaternions = quaternions_from_matrices(views.rotations)
    # Numbered in the order of names, as in COLMAP's database.
    for number, at in enumerate(np.argsort(views.names, kind="stable").tolist(), 1):
        name = views.names[at]
        contract = views.contract(at)
        model, parameters = contract.colmap
        camera = found.setdefault((model, (contract.width_px, contract.height_px, *parameters)), len(found) + 1)
        shift = -views.rotations[at] @ views.centres_m[at]
        numbers = " ".join(repr(float(one)) for one in (*quaternions[at], *shift))
        # Each image has a second line, for points, which is empty.
        lines.append(f"{number} {numbers} {camera} {name}\n\n")
    cameras = [
        f"{number} {model} {width} {height} {' '.join(map(repr, parameters))}\n"
        for (model, (width, height, *parameters)), number in found.items()
    ]
    extra = ", then distortion" if any(model != "PINHOLE" for model, _ in found) else ""
    return {
        "sparse/0/cameras.txt": f"# CAMERA_ID MODEL WIDTH HEIGHT FX FY CX CY{extra}\n" + "".join(cameras),
        "sparse/0/images.txt": "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then POINTS2D\n" + "".join(lines),
        "sparse/0/points3D.txt": "# POINT3D_ID X Y Z R G B ERROR TRACK\n",
    }


def nerfstudio(views: Views, path: Path) -> dict[str, str]:
    """Nerfstudio's ``transforms.json``: poses from camera to world with OpenGL's axes, and relative image paths.

    Motion that blurs or skews images is stated as "Gaussian Splatting on the Move" (Seiskari et al. 2024) reads it:
    seconds of the exposure and of reading all rows, velocities and turn rates along and about the camera's axes.
    """
    # From OpenCV's camera axes (right, down, view) to OpenGL's (right, up, back).
    opengl = np.diag([1.0, -1.0, -1.0])
    motion, times = _nerfstudio_motion(views, opengl)
    frames = []
    for at, name in enumerate(views.names):
        contract, pose = views.contract(at), np.eye(4)
        pose[:3, :3] = views.rotations[at].T @ opengl
        pose[:3, 3] = views.centres_m[at]
        frames.append(
            {
                "file_path": Path(os.path.relpath(views.folder / name, path)).as_posix(),
                "w": contract.width_px,
                "h": contract.height_px,
                "fl_x": contract.fx_px,
                "fl_y": contract.fy_px,
                "cx": contract.cx_px,
                "cy": contract.cy_px,
                **(_coefficients(contract) if views.cameras.vary else {}),
                "transform_matrix": pose.tolist(),
                **{name: values[at] for name, values in motion.items()},
            }
        )
    first = views.contract(0)
    # What stands here holds for all frames, whatever they state.
    lens = {} if views.cameras.vary else _coefficients(first)
    document = {"camera_model": first.nerfstudio["camera_model"], **lens, **times, "frames": frames}
    return {"transforms.json": json.dumps(document, indent=1) + "\n"}


def _coefficients(contract: CameraContract) -> dict[str, float]:
    """Nerfstudio's coefficients of a lens."""
    return {name: value for name, value in contract.nerfstudio.items() if name != "camera_model"}


def _nerfstudio_motion(views: Views, opengl: Floats) -> tuple[dict[str, list[Any]], dict[str, float]]:
    """Motion of each frame by key, and times that all frames share; each frame states those that differ."""
    if views.motion is None:
        return {}, {}
    exposure_s, readout_s, rates = views.motion
    keys = ("camera_linear_velocity", "camera_angular_velocity")
    found = {key: (values @ opengl).tolist() for key, values in zip(keys, views.velocities(rates))}
    shared = {}
    for key, seconds in (("exposure_time", exposure_s), ("rolling_shutter_time", readout_s)):
        if (seconds == seconds[0]).all():
            shared[key] = float(seconds[0])
        else:
            found[key] = seconds.tolist()
    return found, shared


def tum(views: Views, _: Path) -> dict[str, str]:
    """TUM trajectory: time, position, and quaternion (x, y, z, w) from camera to world with OpenCV's axes.

    Times are Unix seconds; if the table has no times, images are numbered from 0 in the table's order instead.
    """
    quaternions = quaternions_from_matrices(np.swapaxes(views.rotations, 1, 2))
    first, times = ("number", np.arange(float(len(views)))) if views.times_s is None else ("timestamp", views.times_s)
    lines = [
        " ".join(
            repr(float(one)) for one in (times[at], *views.centres_m[at], *quaternions[at][1:], quaternions[at][0])
        )
        for at in range(len(views))
    ]
    return {"trajectory.txt": f"# {first} x y z qx qy qz qw\n" + "\n".join(lines) + "\n"}


def kitti(views: Views, _: Path) -> dict[str, str]:
    """KITTI trajectory: each line has the upper three rows of a pose from camera to world, with OpenCV's axes.

    If the table has times, ``times.txt`` has the seconds since the first time.
    """
    rotations, centres = np.swapaxes(views.rotations, 1, 2), views.centres_m[:, :, np.newaxis]
    rows = np.concatenate([rotations, centres], axis=2).reshape(-1, 12)
    files = {"poses.txt": "".join(" ".join(map(repr, row)) + "\n" for row in rows.tolist())}
    if views.times_s is not None:
        since = views.times_s - views.times_s[0]
        files["times.txt"] = "".join(f"{second:.6f}\n" for second in since.tolist())
    return files


#: Formats by their names.
FORMATS: Mapping[str, Callable[[Views, Path], dict[str, str]]] = {
    "colmap": colmap,
    "nerfstudio": nerfstudio,
    "tum": tum,
    "kitti": kitti,
}
