"""Flight logs: PX4's ULog, read with pyulog, and ArduPilot's DataFlash, read with pymavlink.

The camera is fixed to the aircraft and looks down, the top of its image ahead. Heights are those of the autopilot,
above sea level.
"""

from __future__ import annotations

import contextlib
import importlib
import logging
import mmap
import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import Cancelled, InvalidInput, Message, OptionName, OutputError
from ..geodesy.camera import attitude_from_axes
from ..geodesy.quaternions import quaternions_from_angles, rotation_matrices
from ..limits import (
    MAX_JOURNAL_LINE_BYTES,
    MAX_LOG_DAMAGE_BYTES,
    MAX_LOG_DEPTH,
    MAX_LOG_FIELDS,
    MAX_LOG_KINDS,
    MAX_LOG_NAME_CHARACTERS,
    MAX_MISSION_BYTES,
)
from ..mission.clock import CLOCKS, implausible, is_dated
from ..storage.files import open_foreign
from .track import REPORT_EACH, Progress, Track, report, unwatched
from .trajectories import BODIES, ROUNDING, WORLDS

_Columns = Mapping[str, Floats]
_log = logging.getLogger(__name__)
#: Topics of PX4.
_PLACE = "vehicle_global_position"
_ATTITUDE = "vehicle_attitude"
_HOME = "home_position"
#: Topics of PX4's receivers; the first one with a time is used.
_RECEIVERS = ("vehicle_gps_position", "sensor_gps")
#: Required columns of each topic; a topic that lacks a column is ignored.
_NEEDED = {
    _PLACE: ("timestamp", "lat", "lon", "alt"),
    _ATTITUDE: ("timestamp", "q[0]", "q[1]", "q[2]", "q[3]"),
    _HOME: ("timestamp", "alt"),
    **dict.fromkeys(_RECEIVERS, ("timestamp", "time_utc_usec")),
}
#: Required and optional columns of ArduPilot's messages.
_COLUMNS = {
    "POS": (("TimeUS", "Lat", "Lng", "Alt"), ("RelHomeAlt", "RelAlt")),
    "AHR2": (("TimeUS", "Lat", "Lng", "Alt"), ()),
    "GPS": (("TimeUS", "Lat", "Lng", "Alt", "Status", "GWk", "GMS"), ("I",)),
    "ATT": (("TimeUS", "Roll", "Pitch", "Yaw"), ()),
}
#: Names of these columns in logs before 2015 (version 3.3), with a factor for their unit.
_OLD_COLUMNS = {
    ("GPS", "TimeUS"): ("T", 1e3),
    ("GPS", "GWk"): ("Week", 1.0),
    ("GPS", "GMS"): ("TimeMS", 1.0),
    **{(name, "TimeUS"): ("TimeMS", 1e3) for name in ("POS", "AHR2", "ATT")},
}
#: Messages with a position, best first: from the filter, the second filter, the receiver.
_PLACES = ("POS", "AHR2", "GPS")
_S_PER_US = 1e-6


def missing_reader(package: str) -> OutputError:
    """Error for a missing package, with how to install it."""
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
    """Log one line instead of a reader's output, which has a line for each byte that it cannot parse."""
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as printed:
        redirected = contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed)
        with redirected[0], redirected[1], _standard_error(printed.fileno()):
            yield
        printed.seek(0)
        first_line = printed.readline().strip()
    if first_line:
        _log.warning("log %s: is damaged in places (%s)", path, first_line)


@contextlib.contextmanager
def _standard_error(target: int) -> Iterator[None]:
    """Redirect the file descriptor of standard error, to which C extensions print."""
    standard_error = 2
    try:
        kept = os.dup(standard_error)
    except OSError:
        # A program without a console has no standard error.
        yield
        return
    os.dup2(target, standard_error)
    try:
        yield
    finally:
        os.dup2(kept, standard_error)
        os.close(kept)


class _BeyondLimits(Exception):
    """A log exceeds a limit. Not a ValueError, which newer versions of pyulog take for damage and skip."""


class _Watched:
    """A file that reports progress while a reader reads it in one go."""

    def __init__(self, file: IO[bytes], progress: Progress) -> None:
        self._file, self._progress, self._reads, self._steps_back = file, progress, 0, 0
        self._bytes = max(os.fstat(file.fileno()).st_size, 1)

    def read(self, count: int = -1) -> bytes:
        self._reads += 1
        if self._reads % REPORT_EACH == 0:
            report(self._progress, min(self._file.tell() / self._bytes, 1.0))
        return self._file.read(count)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        # Where no message begins, the reader steps back to continue byte by byte.
        self._steps_back += whence == os.SEEK_CUR
        _check_damage(self._steps_back)
        return self._file.seek(offset, whence)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)


def read_ulog(
    path: str | os.PathLike[str],
    progress: Progress = unwatched,
    *,
    flight: int | None = None,
    with_times: bool = True,
) -> Track:
    """Read a PX4 log: positions from ``vehicle_global_position``, attitudes interpolated in ``vehicle_attitude``.

    The ground is at the home position, else at the first position. Times are UTC if the log has a receiver's times,
    else seconds after the autopilot's start. Positions are sorted by time; positions without a place are left out and
    counted.

    Parameters
    ----------
    progress : callable
    flight : int or None
        Number of the flight, from 1, in a log whose clock restarts.
    with_times : bool
        Whether the track has times.

    Raises
    ------
    InvalidInput
        No such log, or no positions in it; several flights and none chosen; implausible times.
    OutputError
        The reader, pyulog, is not installed.
    Cancelled
        ``progress`` returned False.
    """
    pyulog = _reader_module("pyulog", "pyulog")
    wanted = [_PLACE, _ATTITUDE, _HOME, *_RECEIVERS]
    try:
        # Given a name, pyulog leaves an unreadable file open.
        with _quiet(path), open_foreign(path, MAX_MISSION_BYTES) as file:
            log = _ulog_reader(pyulog)(_Watched(file, progress), wanted)
    except Cancelled:
        raise
    except Exception as wrong:
        raise InvalidInput("log {0}: cannot be read as ULog ({1})", path, wrong) from wrong
    # Instances of each topic, in the order of the log.
    topics: dict[str, list[_Columns]] = {name: [] for name in wanted}
    for one in log.data_list:
        if one.data.keys() >= set(_NEEDED[one.name]):
            topics[one.name].append(_columns(one.data))
    place, turned, home = (next(iter(topics[name]), None) for name in (_PLACE, _ATTITUDE, _HOME))
    if place is None or not (valid := _valid(place, "lat_lon_valid") & _valid(place, "alt_valid")).any():
        raise InvalidInput("log {0}: has no positions ({1})", path, _PLACE)
    heights = np.empty(0) if home is None else home["alt"][_valid(home, "valid_alt")]
    known = heights[np.isfinite(heights)]
    found = _Log(
        _renamed(_rows(place, valid), ("lat", "lon", "alt")),
        None if turned is None else _renamed(turned, ("q[0]", "q[1]", "q[2]", "q[3]")),
        tuple(
            {"clock_s": one["timestamp"] * _S_PER_US, "utc_s": one["time_utc_usec"] * _S_PER_US}
            for name in _RECEIVERS
            for one in topics[name]
        ),
        float(known[0]) if len(known) else None,
    )
    return found.track(path, flight, with_times=with_times)


def _ulog_reader(pyulog: Any) -> Any:
    """Subclass of pyulog's reader that refuses topics beyond the limits, before it lists their fields one by one."""

    class Topic(pyulog.ULog._MessageAddLogged):  # type: ignore[misc]  # noqa: SLF001 (where it lists them)
        def __init__(self, data: bytes, header: Any, formats: Mapping[str, Any]) -> None:
            Reader.fields += _count_fields(data[3:].decode("utf-8", "replace"), formats)
            if Reader.fields > MAX_LOG_FIELDS:
                raise _BeyondLimits(f"its topics have more than {MAX_LOG_FIELDS:,} fields")
            super().__init__(data, header, formats)

    class Reader(pyulog.ULog):  # type: ignore[misc]
        _MessageAddLogged = Topic
        fields = 0

    return Reader


def _count_fields(name: str, formats: Mapping[str, Any], depth: int = 0) -> int:
    """Number of fields of a type, with all fields of nested types."""
    if name not in formats:
        return 1
    if depth == MAX_LOG_DEPTH:
        raise _BeyondLimits(f"its types are within each other more than {MAX_LOG_DEPTH} deep")
    total = 0
    for inner, times, field in formats[name].fields:
        if max(len(name), len(field)) > MAX_LOG_NAME_CHARACTERS:
            raise _BeyondLimits(f"a name has more than {MAX_LOG_NAME_CHARACTERS} characters")
        total += max(times, 1) * _count_fields(inner, formats, depth + 1)
        if total > MAX_LOG_FIELDS:
            raise _BeyondLimits(f"{name} has {total:,} fields")
    # A type without fields takes time, too.
    return max(total, 1)


def read_dataflash(
    path: str | os.PathLike[str],
    progress: Progress = unwatched,
    *,
    text: bool = False,
    flight: int | None = None,
    with_times: bool = True,
) -> Track:
    """Read an ArduPilot log: positions from ``POS``, else ``AHR2`` or ``GPS``; attitudes interpolated in ``ATT``.

    The ground is below the first position by its height over home if that is logged, else at the first position. Times,
    order, other parameters and errors are as for `read_ulog`; the reader is pymavlink.

    Parameters
    ----------
    text : bool
        Whether the log is text (``.log``) rather than binary (``.bin``).
    """
    reader = _reader_module("pymavlink.DFReader", "pymavlink")
    if Path(path).is_file() and not Path(path).stat().st_size:
        # pymavlink leaves such a file open.
        raise InvalidInput("log {0}: is empty", path)
    try:
        with _quiet(path):
            if text:
                _check_lines(Path(path))
                opened = _open(reader.DFReader_text, Path(path))
            else:
                opened = _dataflash_reader(reader, Path(path), progress)
            with contextlib.closing(opened) as log:
                read = _messages(log, progress)
    except Cancelled:
        raise
    except Exception as wrong:
        raise InvalidInput("log {0}: cannot be read as DataFlash ({1})", path, wrong) from wrong
    places = (_fixed_rows(read[name]) for name in _PLACES if name in read)
    place = next((one for one in places if len(one["TimeUS"])), None)
    if place is None:
        raise InvalidInput("log {0}: has no positions ({1})", path, ", ".join(_PLACES))
    above_home = [name for name in ("RelHomeAlt", "RelAlt") if name in place][:1]
    turned = read.get("ATT")
    attitude: dict[str, Floats] = {}
    if turned is not None:
        with np.errstate(invalid="ignore"):
            # Infinite angles give NaN, which is left out like invalid states of the filter.
            quaternions = quaternions_from_angles(turned["Yaw"], turned["Pitch"], turned["Roll"])
        attitude = {"clock_s": turned["TimeUS"] * _S_PER_US, **dict(zip(_QUATERNION, quaternions.T))}
    fixes = read.get("GPS")
    found = _Log(
        _renamed(place, ("Lat", "Lng", "Alt", *above_home)),
        attitude or None,
        () if fixes is None else ({"clock_s": fixes["TimeUS"] * _S_PER_US, "utc_s": _utc_s(fixes)},),
    )
    return found.track(path, flight, with_times=with_times)


def _dataflash_reader(reader: Any, path: Path, progress: Progress) -> Any:
    """Open a binary log with pymavlink, and stop at messages without a length, which pymavlink reads forever."""
    _check_messages(path, progress)

    class Reader(reader.DFReader_binary):  # type: ignore[misc]
        def recv_msg(self) -> Any:
            before = self.offset
            message = super().recv_msg()
            if message is not None and self.offset <= before:
                raise _BeyondLimits(f"its messages {message.get_type()} have no length")
            return message

    return _open(Reader, path)


def _open(reader: Any, path: Path) -> Any:
    """Open a log with a reader of pymavlink, and close the file if that fails."""
    log = reader.__new__(reader)
    try:
        log.__init__(os.fspath(path))
    except BaseException:
        for name in ("data_map", "filehandle"):
            with contextlib.suppress(AttributeError, BufferError):
                getattr(log, name).close()
        raise
    return log


def _check_messages(path: Path, progress: Progress) -> None:
    """Scan the messages of a binary log as pymavlink does, and refuse a log that is mostly something else."""
    # A message starts with two fixed bytes and its kind. Messages of kind 128, 89 bytes long, define other kinds: their
    # number and length follow.
    start, head_bytes, definition = b"\xa3\x95", 3, 0x80
    defined = {definition: 89}
    lengths: dict[int, int] = {}
    at = damaged = messages = 0
    with open_foreign(path) as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
        while 0 <= (begin := data.find(start, at)) <= len(data) - head_bytes:
            kind, messages = data[begin + len(start)], messages + 1
            damaged += begin - at
            if kind in defined:
                # The length at the first message of a kind counts, even if the kind is defined again.
                at = begin + lengths.setdefault(kind, defined[kind])
            else:
                at = begin + len(start)
                damaged += at - begin
            if kind == definition and at <= len(data):
                number, length = data[begin + head_bytes : begin + head_bytes + 2]
                if length < head_bytes:
                    raise _BeyondLimits(f"its messages of kind {number} have {length} bytes")
                defined[number] = length
            if damaged > MAX_LOG_DAMAGE_BYTES:
                break
            if messages % REPORT_EACH == 0:
                report(progress, 0.0)
        else:
            damaged += max(len(data) - at, 0)
    _check_damage(damaged)


def _check_lines(path: Path) -> None:
    """Refuse a text log that is mostly something else: for each new first word pymavlink scans the rest of the file."""
    kinds, damaged = set(), 0
    with open_foreign(path) as file:
        while line := file.readline(MAX_JOURNAL_LINE_BYTES):
            kinds.add(line[:4].partition(b",")[0])
            damaged += len(line) * (b"," not in line)
            _check_damage(damaged)
            if len(kinds) > MAX_LOG_KINDS:
                raise _BeyondLimits(f"its lines begin with more than {MAX_LOG_KINDS} words")


def _check_damage(damaged: int) -> None:
    if damaged > MAX_LOG_DAMAGE_BYTES:
        raise _BeyondLimits(f"more than {MAX_LOG_DAMAGE_BYTES >> 20} MB of it belong to no message")


#: Columns of `_Log.place`.
_POSITION = ("lat", "lon", "alt", "above_home")
#: Columns of `_Log.attitude`.
_QUATERNION = ("w", "x", "y", "z")


class _Log(NamedTuple):
    """Topics of a log, each with a column ``clock_s``, the autopilot's clock.

    Attributes
    ----------
    place : columns of `_POSITION`
        ``above_home`` may be missing.
    attitude : columns of `_QUATERNION`, or None
    receivers : column ``utc_s`` of each receiver
    ground_m : float or None
        Height of the ground; None for that of the first position less its height above home.
    """

    place: _Columns
    attitude: _Columns | None
    receivers: tuple[_Columns, ...]
    ground_m: float | None = None

    def track(self, path: str | os.PathLike[str], flight: int | None, *, with_times: bool) -> Track:
        """Positions of one flight of the log."""
        lat, lon, alt = (self.place[name] for name in _POSITION[:3])
        has_place = np.isfinite(self.place["clock_s"] + alt) & (np.abs(lat) <= 90.0) & (np.abs(lon) <= 180.0)
        if not has_place.any():
            raise InvalidInput("log {0}: none of its {1:,} positions has a place and a height", path, len(has_place))
        flights = _flights(self.place["clock_s"][has_place])
        which = _flight_index(flights, path, flight)
        place = _rows(_rows(self.place, has_place), flights[which])
        count, clock_s = len(flights), place["clock_s"]
        attitude = None
        if self.attitude is not None:
            turned = _select_flight(self.attitude, which, count)
            if turned is None:
                _log.warning("log %s: left out the attitudes, whose clock restarts at other times", path)
            else:
                quaternions = np.stack([turned[axis] for axis in _QUATERNION], axis=1)
                attitude = _interpolate_attitude(clock_s, turned["clock_s"], quaternions)
        ground_m = self.ground_m
        if ground_m is None:
            above_home_m = np.nan_to_num(place.get("above_home", np.zeros(1)))
            ground_m = float(place["alt"][0] - above_home_m[0])
        time_s = None
        if with_times:
            time_s = clock_s + self._utc_offset_s(which, count)
            wrong = implausible(time_s, CLOCKS["us"].words)
            if wrong is not None:
                raise InvalidInput(
                    "log {0}: {1}",
                    path,
                    wrong,
                    remedy=Message("leave the times out{0}", OptionName("times").in_brackets),
                )
        lost = int(np.count_nonzero(~has_place))
        return Track(place["lat"], place["lon"], place["alt"], ground_m, time_s, attitude, lost)

    def _utc_offset_s(self, flight: int, count: int) -> float:
        """Seconds from the log's clock to UTC by the first receiver that has UTC, else 0."""
        for receiver in self.receivers:
            timed = _select_flight(receiver, flight, count)
            if timed is not None and (known := is_dated(timed["utc_s"])).any():
                return float(np.median((timed["utc_s"] - timed["clock_s"])[known]))
        return 0.0


def _flights(clock_s: Floats) -> list[NDArray[np.intp]]:
    """Rows of each flight in the order of its clock; several late rows in succession begin another flight."""
    starts, late, highest = [0], 0, -np.inf
    clocks = clock_s.tolist() if (np.diff(clock_s) < 0.0).any() else []
    for at, clock in enumerate(clocks):
        late = late + 1 if clock < highest else 0
        # Up to three rows may be late where several tasks write a log; more mean that the clock has restarted.
        if late > 3:
            starts.append(at + 1 - late)
            late, highest = 0, max(clocks[starts[-1] : at + 1])
        highest = max(highest, clock)
    ends = [*starts[1:], len(clock_s)]
    return [start + np.argsort(clock_s[start:end], kind="stable") for start, end in zip(starts, ends)]


def _flight_index(flights: list[NDArray[np.intp]], path: str | os.PathLike[str], flight: int | None) -> int:
    """Index of the chosen flight."""
    if flight is None and len(flights) > 1:
        raise InvalidInput(
            "log {0}: its clock starts again at position {1:,}: it holds {2} flights",
            path,
            int(flights[1].min()) + 1,
            len(flights),
            remedy=Message("choose one of them{0}", OptionName("flight").in_brackets),
        )
    if flight is not None and not 1 <= flight <= len(flights):
        raise InvalidInput("flight {0} of log {1}: must be from 1 to {2}", flight, path, len(flights))
    return (flight or 1) - 1


def _select_flight(columns: _Columns, flight: int, count: int) -> _Columns | None:
    """Rows of one of ``count`` flights; None if the topic does not separate into that many flights."""
    columns = _rows(columns, np.isfinite(columns["clock_s"]))
    clock_s = columns["clock_s"]
    flights = _flights(clock_s) if count > 1 else [np.argsort(clock_s, kind="stable")]
    return _rows(columns, flights[flight]) if len(flights) == count else None


def _utc_s(fixes: _Columns) -> Floats:
    """UTC of the fixes of a DataFlash log; times in 1980 are of a receiver that did not know the time."""
    epoch_s, week_s = 315_964_800.0, 604_800.0
    gps_s = epoch_s + fixes["GWk"] * week_s + fixes["GMS"] * 1e-3
    # Lead of GPS time over UTC from a given time on (IERS, Bulletin C). Logs before July 2012 have no GPS weeks.
    since = np.array([0.0, 1_341_100_800.0, 1_435_708_800.0, 1_483_228_800.0])
    leaps = np.array([15.0, 16.0, 17.0, 18.0])
    utc_s: Floats = gps_s - leaps[np.clip(np.searchsorted(since + leaps, gps_s, side="right") - 1, 0, None)]
    return utc_s


def _renamed(columns: _Columns, names: tuple[str, ...]) -> dict[str, Floats]:
    """Columns of a topic, by their names in `_Log`."""
    clock = columns["timestamp" if "timestamp" in columns else "TimeUS"]
    renamed = _QUATERNION if "q[0]" in names else _POSITION
    return {"clock_s": clock * _S_PER_US, **{new: columns[name] for new, name in zip(renamed, names)}}


def _columns(data: Mapping[str, Any]) -> dict[str, Floats]:
    return {name: np.asarray(values, np.float64) for name, values in data.items()}


def _messages(log: Any, progress: Progress) -> dict[str, dict[str, Floats]]:
    """Columns of the needed messages of a DataFlash log, by message."""
    columns: dict[str, dict[str, tuple[str, float]]] = {}
    rows: dict[str, list[list[float]]] = {}
    read = 0
    while (message := log.recv_match(type=list(_COLUMNS))) is not None:
        read += 1
        if read % REPORT_EACH == 0:
            report(progress, log.percent / 100.0)
        name = message.get_type()
        if name not in columns:
            columns[name] = _existing_columns(name, message.get_fieldnames())
        if columns[name]:
            row = [times * float(getattr(message, one)) for one, times in columns[name].values()]
            rows.setdefault(name, []).append(row)
    return {name: dict(zip(columns[name], np.array(held).T)) for name, held in rows.items()}


def _existing_columns(name: str, fields: Sequence[str]) -> dict[str, tuple[str, float]]:
    """Names in the log and factors of a message's columns; empty if a required column is missing."""
    needed, others = _COLUMNS[name]
    found = {one: (one, 1.0) for one in (*needed, *others) if one in fields}
    for one in needed:
        old = _OLD_COLUMNS.get((name, one), ("", 1.0))
        if one not in found and old[0] in fields:
            found[one] = old
    return found if found.keys() >= set(needed) else {}


def _fixed_rows(place: _Columns) -> dict[str, Floats]:
    """Rows of a DataFlash log with a place; before the first fix places are 0."""
    has_place = (place["Lat"] != 0.0) | (place["Lng"] != 0.0)
    if "Status" in place:
        has_place &= place["Status"] >= 3
    if "I" in place and has_place.any():
        # Take the first of several receivers that has a fix.
        has_place &= place["I"] == place["I"][has_place].min()
    return _rows(place, has_place)


def _rows(columns: _Columns, which: NDArray[np.bool_] | NDArray[np.intp]) -> dict[str, Floats]:
    return {name: values[which] for name, values in columns.items()}


def _valid(columns: _Columns, flag: str) -> NDArray[np.bool_]:
    """Rows whose flag is set; all rows in logs older than the flag."""
    return columns[flag] != 0.0 if flag in columns else np.ones(len(columns["timestamp"]), np.bool_)


def _interpolate_attitude(
    clock_s: Floats, times_s: Floats, quaternions: Floats
) -> tuple[Floats, Floats, Floats] | None:
    """Yaw, tilt and roll (n,) at ``clock_s`` from quaternions (m, 4), w first, body to north-east-down, at ``times_s``.

    Between two quaternions, it is their weighted mean; before the first and after the last, it is constant. None if no
    quaternion is valid.
    """
    valid = np.abs(np.linalg.norm(quaternions, axis=1) - 1.0) < ROUNDING
    times_s, quaternions = times_s[valid], quaternions[valid]
    if not len(times_s):
        return None
    # A quaternion and its negative are the same rotation: choose the sign of each to match the previous quaternion.
    turns = np.sign(np.sum(quaternions[1:] * quaternions[:-1], axis=1))
    signs = np.cumprod(np.concatenate([[1.0], np.where(turns < 0.0, -1.0, 1.0)]))
    quaternions = quaternions * signs[:, np.newaxis]
    mean = np.stack([np.interp(clock_s, times_s, part) for part in quaternions.T], axis=1)
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    vectors = WORLDS["ned"] @ rotation_matrices(mean) @ BODIES["frd"].T
    return attitude_from_axes(vectors[..., 0], vectors[..., 1], vectors[..., 2])
