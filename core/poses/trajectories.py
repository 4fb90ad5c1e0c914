"""Trajectories in metres of a local frame, as used for visual odometry: TUM, KITTI and EuRoC.

Each pose is the rotation and translation from a body to the world. The files do not define the axes of body and
world: the usual conventions of each format are the defaults.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message, OptionName
from ..geodesy.camera import attitude_from_axes
from ..geodesy.local import LocalFrame
from ..geodesy.quaternions import rotation_matrices
from ..mission.clock import CLOCKS, implausible, is_dated
from ..mission.parts import HIGHEST_AGL_M
from ..numbers import real_number
from .settings import WITHOUT_TIMES
from .track import REPORT_EACH, Progress, Track, report, unwatched

#: Right, top and view direction of the camera in the body's axes, as rows.
BODIES: Mapping[str, Floats] = {
    # Camera: right, down, forward.
    "camera": np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
    # Aircraft: forward, right, down, or forward, left, up; its camera looks down, the top of the image ahead.
    "frd": np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "flu": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]),
    # Inertial unit of EuRoC's vehicle: up, right, forward; its cameras look forward.
    "urf": np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
#: East, north and up in the world's axes, as rows.
WORLDS: Mapping[str, Floats] = {
    "enu": np.eye(3),
    "ned": np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]),
    # Axes of a camera that looks north: right, down, forward.
    "rdf": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
}
#: Largest error of rotations and quaternions, which files round to a few digits.
ROUNDING = 1e-3


def read_trajectory(
    text: str,
    file_format: str,
    origin: tuple[float, float, float],
    *,
    body: str | None = None,
    world: str | None = None,
    times: str | None = None,
    name: str = "trajectory",
    progress: Progress = unwatched,
) -> Track:
    """Read a trajectory in a local frame.

    Parameters
    ----------
    text : str
        Content of the file.
    file_format : {"tum", "kitti", "euroc"}
        Lines of ``timestamp tx ty tz qx qy qz qw``; lines of the twelve numbers of a 3 x 4 matrix, without times; or
        EuRoC's table of nanoseconds, place, and quaternion with w first.
    origin : latitude, longitude in degrees, and height in metres
        Place of the world's origin; its height is also that of the ground.
    body : str or None
        One of `BODIES`; None for a camera. Required for EuRoC, whose poses are those of an inertial unit.
    world : str or None
        One of `WORLDS`; None for ``enu``, and with KITTI, whose world is its first camera, ``rdf``.
    times : str or None
        Unit of the times, one of `CLOCKS`, or "none" to leave them out; None for seconds, and nanoseconds in EuRoC.
        If the unit is given, dated poses may all lie within a second.
    name : str
        Name of the file in messages.
    progress : callable

    Raises
    ------
    InvalidInput
        An invalid line or pose, which the message names; times that decrease or are implausible.
    Cancelled
        ``progress`` returned False.
    """
    if file_format == "euroc" and body is None:
        raise InvalidInput(
            "{0}: EuRoC's poses are those of an inertial unit",
            name,
            remedy="give --body: urf for that of the published flights, flu or frd for an aircraft's",
        )
    lat, lon, height = origin
    counted, places, rotations = _FORMATS[file_format](text, name, progress)
    time_s = None if counted is None else _times(counted, file_format, times, name)
    # Refuse poses far from the origin, where versions of PROJ differ.
    away = np.flatnonzero((np.abs(places) > HIGHEST_AGL_M).any(axis=1))
    if len(away):
        raise InvalidInput(
            "{0}: pose {1:,} must be within {2:,g} m of the origin", name, int(away[0]) + 1, HIGHEST_AGL_M
        )
    world_axes = WORLDS[world or ("rdf" if file_format == "kitti" else "enu")]
    frame = LocalFrame(lat, lon, height)
    lat_deg, lon_deg, height_m = frame.geodetic(places @ world_axes.T)
    # The columns of a rotation are the body's axes in the world. Attitudes count from north and up at the camera.
    local_axes = frame.rotations(lat_deg, lon_deg) @ world_axes @ rotations
    vectors = local_axes @ BODIES[body or "camera"].T
    attitude = attitude_from_axes(vectors[..., 0], vectors[..., 1], vectors[..., 2])
    return Track(lat_deg, lon_deg, height_m, height, time_s, attitude)


def _tum(text: str, name: str, progress: Progress) -> tuple[Floats | None, Floats, Floats]:
    rows = _numbers(text, name, progress, (8,))
    return rows[:, 0], rows[:, 1:4], _rotations(rows[:, [7, 4, 5, 6]], name)


def _kitti(text: str, name: str, progress: Progress) -> tuple[Floats | None, Floats, Floats]:
    matrices = _numbers(text, name, progress, (12,)).reshape(-1, 3, 4)
    rotations = matrices[:, :, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        off = np.abs(rotations @ np.swapaxes(rotations, 1, 2) - np.eye(3)).max(axis=(1, 2))
        wrong = np.flatnonzero(~(off <= ROUNDING) | (np.linalg.det(rotations) < 0.0))
    if len(wrong):
        raise InvalidInput("{0}: pose {1:,} is not a rotation", name, int(wrong[0]) + 1)
    return None, matrices[:, :, 3], rotations


def _euroc(text: str, name: str, progress: Progress) -> tuple[Floats | None, Floats, Floats]:
    # EuRoC's ground truth has speeds and biases in nine more columns.
    rows = _numbers(text, name, progress, (8, 17))
    return rows[:, 0], rows[:, 1:4], _rotations(rows[:, 4:8], name)


_FORMATS: Mapping[str, Callable[[str, str, Progress], tuple[Floats | None, Floats, Floats]]] = {
    "tum": _tum,
    "kitti": _kitti,
    "euroc": _euroc,
}
FORMATS = tuple(_FORMATS)


def _numbers(text: str, name: str, progress: Progress, counts: tuple[int, ...]) -> Floats:
    """Numbers (n, count) of lines; empty lines and comments (#) are skipped."""
    rows: list[list[float]] = []
    lines = text.splitlines()
    for number, line in enumerate(lines, 1):
        if number % REPORT_EACH == 0:
            report(progress, number / len(lines))
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            row = [real_number(cell) for cell in line.replace(",", " ").split()]
        except ValueError:
            row = []
        if len(row) not in counts or not np.isfinite(row).all() or (rows and len(row) != len(rows[0])):
            raise InvalidInput("{0}, line {1}: {2!r}: must be {3} numbers", name, number, line.strip()[:80], counts[0])
        rows.append(row)
    if not rows:
        raise InvalidInput("{0}: holds no poses", name)
    return np.array(rows, np.float64)


def _times(counted: Floats, file_format: str, times: str | None, name: str) -> Floats | None:
    """Times of a file in seconds."""
    if times == WITHOUT_TIMES:
        return None
    clock = CLOCKS[times or ("ns" if file_format == "euroc" else "s")]
    time_s = counted * clock.seconds
    back = np.flatnonzero(np.diff(time_s) < 0.0)
    if len(back):
        raise InvalidInput(
            "{0}: its times go back at pose {1:,}",
            name,
            int(back[0]) + 2,
            remedy=Message("leave the times out{0}", OptionName("times").in_brackets),
        )
    is_known = times is not None and bool(is_dated(time_s).all())
    wrong = None if is_known else implausible(time_s, clock.words)
    if wrong is not None:
        raise InvalidInput(
            "{0}: {1}",
            name,
            wrong,
            remedy=Message("give their unit, or leave them out{0}", OptionName("times").in_brackets),
        )
    return time_s


def _rotations(quaternions: Floats, name: str) -> Floats:
    """Rotations (n, 3, 3) of quaternions (n, 4), w first, checked and normalised."""
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(quaternions, axis=1)
    wrong = np.flatnonzero(np.abs(lengths - 1.0) > ROUNDING)
    if len(wrong):
        raise InvalidInput(
            "{0}: the quaternion of pose {1:,} has the length {2:.3g}, and not 1",
            name,
            int(wrong[0]) + 1,
            lengths[wrong[0]],
        )
    return rotation_matrices(quaternions / lengths[:, np.newaxis])
