"""Poses of trajectories and flight logs of any format, as `--coords` and the panel fly them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..errors import InvalidInput, Message
from ..fields import field_named
from ..limits import MAX_MISSION_BYTES
from ..mission.areas.area import ANGLES, Points, check_lat_lon
from ..mission.litchi_table import is_litchi
from ..mission.parts import Flight
from ..mission.pose_table import read_poses
from ..storage.files import file_exists, open_foreign, read_limited
from ..text.safe_json import decoded
from ..text.safe_xml import XMLReader, iterate_elements
from .gpx import read_gpx
from .logs import read_dataflash, read_ulog
from .settings import (
    COUNTED_FORMATS,
    ENDINGS,
    LITCHI_ENDING,
    LOCAL_FORMATS,
    LOG_FORMATS,
    WITHOUT_TIMES,
    PoseFile,
)
from .track import Progress, Track, unwatched
from .trajectories import read_trajectory


class ReadPoses(NamedTuple):
    """Mission points of a file, and its number of positions.

    Attributes
    ----------
    left_out, without_place, without_time : int
        Number of positions left out: not above the ground, without a place, or without a time where others have one.
    """

    points: Points
    positions: int
    left_out: int
    without_place: int = 0
    without_time: int = 0

    @property
    def why_left_out(self) -> dict[Message, int]:
        """Number of positions left out, by reason."""
        found = {
            Message("without a place"): self.without_place,
            Message("without a time"): self.without_time,
            Message("at or below the ground"): self.left_out,
        }
        return {reason: count for reason, count in found.items() if count}


def log_format(path: str | os.PathLike[str]) -> str | None:
    """Format by a file's ending; None if the ending does not decide."""
    return "litchi" if Path(path).name.lower().endswith(LITCHI_ENDING) else ENDINGS.get(Path(path).suffix.lower())


def likely_format(path: str | os.PathLike[str]) -> str | None:
    """Format by a file's ending, else by the number of columns of its first line; None if neither decides."""
    found = log_format(path)
    if found is not None:
        return found
    try:
        with open_foreign(path) as file:
            # Far more than a line of numbers, and a bound for files without line ends.
            lines = file.read(1 << 16).decode("utf-8", "replace").splitlines()
            line = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    except OSError:
        return None
    is_csv = "," in line
    if is_litchi([cell.strip().lower() for cell in line.split(",")]):
        return "litchi"
    return {(12, False): "kitti", (8, False): "tum", (8, True): "euroc", (17, True): "euroc"}.get(
        (len(line.replace(",", " ").split()), is_csv)
    )


def read_poses_file(
    path: str | os.PathLike[str],
    how: PoseFile,
    read_xml: XMLReader = iterate_elements,
    progress: Progress = unwatched,
) -> ReadPoses:
    """Read the poses of a trajectory or flight log.

    Parameters
    ----------
    read_xml : callable
        XML reader for GPX; lxml by default.
    progress : callable

    Raises
    ------
    InvalidInput
        The file cannot be read, or lacks what its poses need; as for `Track.points`.
    OutputError
        The reader of the format is not installed.
    Cancelled
        ``progress`` returned False.
    """
    track = read_track(path, how, read_xml, progress)
    points, left_out = track.points(how.ground_height_m, how.agl_m, every_s=how.every_s, every_m=how.every_m)
    positions = len(track) + track.without_place + track.without_time
    return ReadPoses(points, positions, left_out, track.without_place, track.without_time)


def read_track(
    path: str | os.PathLike[str],
    how: PoseFile,
    read_xml: XMLReader = iterate_elements,
    progress: Progress = unwatched,
) -> Track:
    """Read the positions of a trajectory or flight log; arguments and exceptions are those of `read_poses_file`."""
    track = _track(Path(path), how, read_xml, progress)
    if how.start_s is not None:
        track = track.starting(how.start_s)
    return track.nadir() if how.nadir else track


def _track(path: Path, how: PoseFile, read_xml: XMLReader, progress: Progress) -> Track:
    file_format = how.format or log_format(path)
    if file_format is None:
        raise InvalidInput("trajectory {0}: its ending does not tell its format", path, remedy="give --format")
    if file_format not in LOCAL_FORMATS and (how.origin or how.body or how.world):
        raise InvalidInput(
            "--origin, --body and --world: are for {0}, and not for {1}",
            ", ".join(LOCAL_FORMATS),
            file_format,
        )
    if how.times not in (None, WITHOUT_TIMES) and file_format not in COUNTED_FORMATS:
        raise InvalidInput(
            "unit of times {0}: is for {1}, and not for {2}",
            how.times,
            ", ".join(COUNTED_FORMATS),
            file_format,
        )
    if how.flight is not None and file_format not in LOG_FORMATS:
        raise InvalidInput("--flight: is for {0}, and not for {1}", ", ".join(LOG_FORMATS), file_format)
    if not file_exists(path):
        raise InvalidInput("trajectory {0}: no such file", path)
    with_times = how.times != WITHOUT_TIMES
    if file_format == "ulog":
        return read_ulog(path, progress, flight=how.flight, with_times=with_times)
    if file_format == "dataflash":
        is_text = path.suffix.lower() == ".log"
        return read_dataflash(path, progress, text=is_text, flight=how.flight, with_times=with_times)
    try:
        body = read_limited(path, MAX_MISSION_BYTES)
        text = "" if file_format == "gpx" else decoded(body)
    except (OSError, InvalidInput) as wrong:
        raise InvalidInput("trajectory {0}: cannot be read ({1})", path, wrong) from wrong
    name = Message("trajectory {0}", path)
    if file_format == "litchi":
        return _litchi(text, name, how.agl_m)
    if file_format == "gpx":
        return read_gpx(body, name, read_xml, progress, with_times=with_times)
    return read_trajectory(
        text,
        file_format,
        _origin(how.origin, path, file_format),
        body=how.body,
        world=how.world,
        times=how.times,
        name=name,
        progress=progress,
    )


def _litchi(text: str, name: str, agl_m: float | None) -> Track:
    """Poses of a Litchi mission, with heights above the ground."""
    points = read_poses(text.splitlines() or [""], name, agl_m=agl_m)
    lat, lon, agl = np.array(points.poses).T
    yaw, tilt, roll = (np.array(points.stated_deg(angle) or np.zeros(len(lat))) for angle in ANGLES)
    return Track(lat, lon, agl, 0.0, None, (yaw, tilt, roll))


def _origin(numbers: tuple[float, ...], path: Path, file_format: str) -> tuple[float, float, float]:
    if len(numbers) not in (2, 3):
        raise InvalidInput(
            "trajectory {0}: {1} is in metres of a local frame",
            path,
            file_format,
            remedy="say where its origin lies (--origin LAT LON [HEIGHT])",
        )
    lat_deg, lon_deg, height_m = (*numbers, 0.0)[:3]
    check_lat_lon(lat_deg, lon_deg)
    field_named(Flight, "ground_height_m").settled(height_m)
    return lat_deg, lon_deg, height_m
