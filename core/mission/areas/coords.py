"""Areas from text, in the paper's formats."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from ...errors import InvalidInput, Message
from ...limits import MAX_MISSION_BYTES
from ...numbers import real_number
from ...storage.files import file_exists, read_limited
from ...text.safe_json import decoded
from ...units import LENGTHS_M
from ..options import KINDS
from ..pose_table import UNICODE_MINUS, read_header, read_poses, states_separator
from .area import Area, Box, Points

_FORMATS = Message('"lat_lon_agl", "latTL_lonTL_latBR_lonBR_agl", or a text file of "lat lon agl [yaw]" lines')


def _numbers(text: str, where: str) -> list[float]:
    fields = [field for field in re.split(r"[_,;\s]+", text.translate(UNICODE_MINUS).strip()) if field]
    try:
        return [_number(field) for field in fields]
    except InvalidInput as wrong:
        raise InvalidInput("{0} {1!r}: {2}; expected {3}", where, text.strip(), wrong, _FORMATS) from wrong


def _number(text: str) -> float:
    try:
        return real_number(text)
    except ValueError as wrong:
        raise InvalidInput("{0!r} is not a number", text) from wrong


def _scaled(agl: float, unit: str) -> float:
    if unit not in LENGTHS_M:
        raise InvalidInput("unit of height {0!r}: must be one of {1}", unit, ", ".join(LENGTHS_M))
    return agl * LENGTHS_M[unit]


def parse_coords(
    text: str, kind: str | None = None, agl_unit: str = "m", agl_m: float | None = None
) -> tuple[Area, float]:
    """Read area and height above ground (metres) from the paper's ``--coords``.

    Parameters
    ----------
    text : str
        ``"lat_lon_agl"``, ``"latTL_lonTL_latBR_lonBR_agl"``, or a file of ``lat lon agl [yaw]`` lines, yaw in degrees.
        Commas or spaces may replace underscores, and Unicode minus signs hyphens. A file whose first line names its
        columns is a table of poses, see `pose_table.read_poses`.
    kind : str or None
        single, list or raster; None to infer it. A single mission takes a file's first row, and a box's top-left
        corner as its centre.
    agl_unit : str
        Unit of the heights, m or ft.
    agl_m : float or None
        Height in metres of corners, points or poses that state none.

    Raises
    ------
    InvalidInput
        The text or a line of the file cannot be read; the message names it.
    """
    if kind is not None and kind not in KINDS:
        raise InvalidInput("mission {0!r}: must be one of {1}", kind, ", ".join(KINDS))
    if not text.strip():
        raise InvalidInput("coordinates are empty: expected {0}", _FORMATS)
    if file_exists(text):
        return _read_file(Path(text), kind, agl_unit, agl_m)
    if Path(text).suffix.lower() in (".csv", ".tsv", ".txt"):
        raise InvalidInput("coordinates {0!r}: there is no such file", text.strip())
    values = _numbers(text, Message("coordinates"))
    if len(values) in (3, 5):
        corners, agl = values[:-1], _scaled(values[-1], agl_unit)
    elif len(values) in (2, 4) and agl_m is not None:
        corners, agl = values, agl_m
    else:
        raise InvalidInput("coordinates {0!r}: {1} numbers; expected {2}", text.strip(), len(values), _FORMATS)
    if len(corners) == 4 and kind in (None, "raster"):
        return Box(*corners), agl
    if len(corners) == 2 and kind == "raster":
        raise InvalidInput(
            "coordinates {0!r}: a raster mission needs two corners and a height (5 numbers)", text.strip()
        )
    return Points(((corners[0], corners[1], agl),)), agl


def parse_points(
    lines: Iterable[str],
    where: str = Message("coordinates"),
    agl_unit: str = "m",
    most: int | None = None,
) -> Points:
    """Read points from lines of ``lat lon agl [yaw]``, without empty lines and comments (#).

    Parameters
    ----------
    where : str
        Name of the text, for messages.
    agl_unit : str
        Unit of the heights, m or ft.
    most : int or None
        Greatest number of points to read; None for all.

    Raises
    ------
    InvalidInput
        A line cannot be read, or no line holds a point.
    """
    poses: list[tuple[float, float, float]] = []
    yaws: list[float] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#") or (not poses and states_separator(line)):
            continue
        place = Message("{0}, line {1}:", where, number)
        pose, yaw = _pose(line, place, agl_unit)
        if poses and bool(yaw) != bool(yaws):
            raise InvalidInput(
                "{0} {1!r} has {2} numbers and the lines before {3}: give every point its yaw, or none",
                place,
                line.strip(),
                3 + len(yaw),
                4 - len(yaw),
            )
        poses.append(pose)
        yaws += yaw
        if len(poses) == most:
            break
    if not poses:
        raise InvalidInput("{0}: holds no coordinates; expected lines of lat lon agl [yaw]", where)
    return Points(tuple(poses), tuple(yaws))


def _read_file(path: Path, kind: str | None, agl_unit: str, agl_m: float | None) -> tuple[Area, float]:
    if kind == "raster":
        raise InvalidInput("file {0}: holds points; a raster mission needs two corners and a height as text", path)
    # Trajectories and flight logs lack heights above ground.
    if path.suffix.lower() in (".gpx", ".ulg", ".bin"):
        raise InvalidInput(
            "file {0}: is a trajectory or a flight log",
            path,
            remedy="make a table of poses from it (terrainav poses read)",
        )
    try:
        lines = decoded(read_limited(path, MAX_MISSION_BYTES)).splitlines()
    except (OSError, InvalidInput) as wrong:
        raise InvalidInput("file {0}: cannot be read as text ({1})", path, wrong) from wrong
    where, most = Message("file {0}", path), 1 if kind == "single" else None
    if read_header(lines, where):
        points = read_poses(lines, where, agl_unit, agl_m, most)
    else:
        points = parse_points(lines, where, agl_unit, most)
    return points, points.poses[0][2]


def _pose(line: str, where: str, agl_unit: str) -> tuple[tuple[float, float, float], list[float]]:
    """Pose of a line, and its yaw, if any, in a list."""
    values = _numbers(line, where)
    if len(values) not in (3, 4):
        raise InvalidInput("{0} {1!r} has {2} numbers; expected lat lon agl [yaw]", where, line.strip(), len(values))
    pose = (values[0], values[1], _scaled(values[2], agl_unit))
    try:
        Points((pose,), tuple(values[3:]))
    except InvalidInput as wrong:
        raise InvalidInput("{0} {1}", where, wrong) from wrong
    return pose, values[3:]
