"""Flight logs: PX4's ULog through pyulog, ArduPilot's DataFlash through pymavlink; their cameras look down.

The camera is fixed to the aircraft, the top of its image ahead. Heights are above the sea, as the autopilot has them.
"""

from __future__ import annotations

import contextlib
import importlib
import logging
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import Cancelled, InvalidInput, Message, OutputError
from ..geodesy.camera import attitude_of
from ..geodesy.quaternions import quaternions_of_angles, rotations_of
from .track import REPORT_EACH, Progress, Track, report, unwatched
from .trajectories import BODIES, ROUNDING, WORLDS

Floats = NDArray[np.float64]
_log = logging.getLogger(__name__)
#: Topics of PX4; of the receiver's the first that is logged counts.
_PLACE, _ATTITUDE, _HOME, _RECEIVERS = (
    "vehicle_global_position",
    "vehicle_attitude",
    "home_position",
    ("vehicle_gps_position", "sensor_gps"),
)
#: Columns without which a topic is as good as not logged.
_NEEDED = {
    _PLACE: ("timestamp", "lat", "lon", "alt"),
    _ATTITUDE: ("timestamp", "q[0]", "q[1]", "q[2]", "q[3]"),
    _HOME: ("timestamp", "alt"),
    **dict.fromkeys(_RECEIVERS, ("timestamp", "time_utc_usec")),
}
#: Columns of ArduPilot's messages, and those that not all of its versions have.
_COLUMNS = {
    "POS": (("TimeUS", "Lat", "Lng", "Alt"), ("RelHomeAlt", "RelAlt")),
    "AHR2": (("TimeUS", "Lat", "Lng", "Alt"), ()),
    "GPS": (("TimeUS", "Lat", "Lng", "Alt", "Status", "GWk", "GMS"), ("I",)),
    "ATT": (("TimeUS", "Roll", "Pitch", "Yaw"), ()),
}
#: Those that have places, best first: of its filter, of the second filter, of the receiver.
_PLACES = ("POS", "AHR2", "GPS")
_GPS_FIX_3D = 3
_S_PER_US = 1e-6
#: GPS time: its beginning, its weeks, and by how much it is ahead of UTC from a time on (IERS, Bulletin C).
_GPS_EPOCH_S, _WEEK_S = 315_964_800.0, 604_800.0
_LEAPS = (
    (0.0, 15.0),  # Before July 2012, when no DataFlash log had GPS weeks.
    (1_341_100_800.0, 16.0),
    (1_435_708_800.0, 17.0),
    (1_483_228_800.0, 18.0),
)
#: File descriptor of standard error.
_STANDARD_ERROR = 2


def missing_reader(package: str) -> OutputError:
    """Error that says how to get a package that reads a format."""
    return OutputError(
        "{0}, which reads such files, is not installed",
        package,
        remedy=Message("get it with: pip install 'terrainav[{0}]'", "logs"),
    )


def _reader_module(name: str, package: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as missing:
        raise missing_reader(package) from missing


@contextlib.contextmanager
def _quiet(path: str | os.PathLike[str]) -> Iterator[None]:
    """Put what a reader prints, a line for each byte that it cannot make out, into one line."""
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as printed:
        aside = contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed)
        with aside[0], aside[1], _standard_error(printed.fileno()):
            yield
        printed.seek(0)
        said = printed.readline().strip()
    if said:
        _log.warning("log %s: is damaged in places (%s)", path, said)


@contextlib.contextmanager
def _standard_error(target: int) -> Iterator[None]:
    """Lead what modules written in C print to another file for a while."""
    try:
        kept = os.dup(_STANDARD_ERROR)
    except OSError:
        # A program with windows has none.
        yield
        return
    os.dup2(target, _STANDARD_ERROR)
    try:
        yield
    finally:
        os.dup2(kept, _STANDARD_ERROR)
        os.close(kept)


class _Watched:
    """A file that tells how much of it is read, to what reads it in one go."""

    def __init__(self, file: IO[bytes], progress: Progress) -> None:
        self._file, self._progress, self._reads = file, progress, 0
        self._bytes = max(os.fstat(file.fileno()).st_size, 1)

    def read(self, count: int = -1) -> bytes:
        self._reads += 1
        if self._reads % REPORT_EACH == 0:
            report(self._progress, min(self._file.tell() / self._bytes, 1.0))
        return self._file.read(count)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)


def read_ulog(path: str | os.PathLike[str], progress: Progress = unwatched) -> Track:
    """Read a PX4 log: ``vehicle_global_position``, with ``vehicle_attitude`` in between.

    The ground is at the home position, else at the first position. Times are UTC where a receiver's are logged, else
    seconds after the autopilot's start.

    Raises
    ------
    InvalidInput
        No such log, or one without positions.
    OutputError
        pyulog is not installed.
    Cancelled
        When ``progress`` said so.
    """
    pyulog = _reader_module("pyulog", "pyulog")
    wanted = [_PLACE, _ATTITUDE, _HOME, *_RECEIVERS]
    try:
        # Given a name, pyulog leaves the file open where it cannot read it.
        with _quiet(path), Path(path).open("rb") as file:
            log = pyulog.ULog(_Watched(file, progress), wanted)
    except Cancelled:
        raise
    except Exception as wrong:
        raise InvalidInput("log {0}: cannot be read as ULog ({1})", path, wrong) from wrong
    # Of several instances of a topic the first one, which comes first in the list.
    topics = {
        one.name: _columns(one.data)
        for one in reversed(log.data_list)
        if one.data.keys() >= set(_NEEDED[one.name])
    }
    place = topics.get(_PLACE, {})
    place = _rows(place, _valid(place, "lat_lon_valid") & _valid(place, "alt_valid")) if place else place
    if not place or not len(place["timestamp"]):
        raise InvalidInput("log {0}: has no positions ({1})", path, _PLACE)
    clock = place["timestamp"] * _S_PER_US
    attitude = None
    if _ATTITUDE in topics:
        turned = topics[_ATTITUDE]
        quaternions = np.stack([turned[f"q[{axis}]"] for axis in range(4)], axis=1)
        attitude = _attitude_at(clock, turned["timestamp"] * _S_PER_US, quaternions)
    home = topics.get(_HOME, {})
    heights = home["alt"][_valid(home, "valid_alt")] if home else np.empty(0)
    ground = float((heights if len(heights) else place["alt"])[0])
    utc_less_clock = 0.0
    for receiver in (topics[name] for name in _RECEIVERS if name in topics):
        known = receiver["time_utc_usec"] > 0.0
        if known.any():
            utc_less_clock = float(
                np.median((receiver["time_utc_usec"] - receiver["timestamp"])[known]) * _S_PER_US
            )
            break
    return Track(place["lat"], place["lon"], place["alt"], ground, clock + utc_less_clock, attitude)


def read_dataflash(
    path: str | os.PathLike[str], progress: Progress = unwatched, *, text: bool = False
) -> Track:
    """Read an ArduPilot log: ``POS``, else ``AHR2`` or ``GPS``, with ``ATT`` in between.

    The ground is below the first position by its height over home, where that is logged, else at the first position.
    Times are UTC where a receiver's are logged, else seconds after the autopilot's start.

    Parameters
    ----------
    progress : callable
    text : bool
        Whether the log is of text (``.log``), and not binary (``.bin``).

    Raises
    ------
    InvalidInput
        No such log, or one without positions.
    OutputError
        pymavlink is not installed.
    Cancelled
        When ``progress`` said so.
    """
    reader = _reader_module("pymavlink.DFReader", "pymavlink")
    if Path(path).is_file() and not Path(path).stat().st_size:
        # pymavlink leaves such a file open.
        raise InvalidInput("log {0}: is empty", path)
    try:
        with _quiet(path):
            opened = (reader.DFReader_text if text else reader.DFReader_binary)(os.fspath(path))
            with contextlib.closing(opened) as log:
                found = _messages(log, progress)
    except Cancelled:
        raise
    except Exception as wrong:
        raise InvalidInput("log {0}: cannot be read as DataFlash ({1})", path, wrong) from wrong
    places = (_with_fix(found[name]) for name in _PLACES if name in found)
    place = next((one for one in places if len(one["TimeUS"])), None)
    if place is None:
        raise InvalidInput("log {0}: has no positions ({1})", path, ", ".join(_PLACES))
    clock = place["TimeUS"] * _S_PER_US
    attitude = None
    if "ATT" in found:
        turned = found["ATT"]
        with np.errstate(invalid="ignore"):
            # Of infinite angles NaN, which are left out as states of a filter that are none.
            quaternions = quaternions_of_angles(turned["Yaw"], turned["Pitch"], turned["Roll"])
        attitude = _attitude_at(clock, turned["TimeUS"] * _S_PER_US, quaternions)
    above_home = next((place[name] for name in ("RelHomeAlt", "RelAlt") if name in place), np.zeros(1))
    ground = float(place["Alt"][0] - above_home[0])
    return Track(place["Lat"], place["Lng"], place["Alt"], ground, clock + _utc_less_clock(found), attitude)


def _utc_less_clock(found: Mapping[str, Mapping[str, Floats]]) -> float:
    """Seconds from the clock of a DataFlash log to UTC; 0 where the receiver's time is not logged."""
    fixes = found.get("GPS", {})
    if not fixes or not (known := fixes["GWk"] > 0.0).any():
        return 0.0
    gps_s = _GPS_EPOCH_S + fixes["GWk"][known] * _WEEK_S + fixes["GMS"][known] * 1e-3
    since, leaps = np.array(_LEAPS).T
    utc_s = gps_s - leaps[np.searchsorted(since + leaps, gps_s, side="right") - 1]
    return float(np.median(utc_s - fixes["TimeUS"][known] * _S_PER_US))


def _columns(data: Mapping[str, Any]) -> dict[str, Floats]:
    return {name: np.asarray(values, np.float64) for name, values in data.items()}


def _messages(log: Any, progress: Progress) -> dict[str, dict[str, Floats]]:
    """Columns of those messages of a DataFlash log that are read, by name."""
    columns: dict[str, list[str]] = {}
    rows: dict[str, list[list[float]]] = {}
    read = 0
    while (message := log.recv_match(type=list(_COLUMNS))) is not None:
        read += 1
        if read % REPORT_EACH == 0:
            report(progress, log.percent / 100.0)
        name = message.get_type()
        if name not in columns:
            needed, others = _COLUMNS[name]
            columns[name] = [*needed, *(one for one in others if one in message.get_fieldnames())]
        rows.setdefault(name, []).append([float(getattr(message, one)) for one in columns[name]])
    return {name: dict(zip(columns[name], np.array(held).T)) for name, held in rows.items()}


def _with_fix(place: Mapping[str, Floats]) -> dict[str, Floats]:
    """Rows of a DataFlash log that have a place: before the first fix places are zeros."""
    there = (place["Lat"] != 0.0) | (place["Lng"] != 0.0)
    if "Status" in place:
        there &= place["Status"] >= _GPS_FIX_3D
    if "I" in place:
        # Of several receivers one.
        there &= place["I"] == place["I"].min()
    return _rows(place, there)


def _rows(columns: Mapping[str, Floats], which: NDArray[np.bool_]) -> dict[str, Floats]:
    return {name: values[which] for name, values in columns.items()}


def _valid(columns: Mapping[str, Floats], flag: str) -> NDArray[np.bool_]:
    """Rows whose flag is set; all of them in logs that are older than the flag."""
    return columns[flag] != 0.0 if flag in columns else np.ones(len(columns["timestamp"]), np.bool_)


def _attitude_at(
    clock_s: Floats, times_s: Floats, quaternions: Floats
) -> tuple[Floats, Floats, Floats] | None:
    """Yaw, tilt and roll (n,) at moments, of quaternions (m, 4) of the body to north, east, down at other ones.

    In between it is the weighted mean of both neighbours, w first; before the first and after the last it is theirs.
    """
    right = np.abs(np.linalg.norm(quaternions, axis=1) - 1.0) < ROUNDING
    times_s, quaternions = times_s[right], quaternions[right]
    if not len(times_s):
        return None
    # A quaternion and its negative are one rotation: each of the sign of the one before it.
    turns = np.sign(np.sum(quaternions[1:] * quaternions[:-1], axis=1))
    signs = np.cumprod(np.concatenate([[1.0], np.where(turns < 0.0, -1.0, 1.0)]))
    quaternions = quaternions * signs[:, np.newaxis]
    mean = np.stack([np.interp(clock_s, times_s, part) for part in quaternions.T], axis=1)
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    vectors = WORLDS["ned"] @ rotations_of(mean) @ BODIES["frd"].T
    return attitude_of(vectors[..., 0], vectors[..., 1], vectors[..., 2])
