"""Files of a sequence beside those of its dataset, and their tables."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Floats, Numbers
from ..errors import InvalidInput
from ..limits import MAX_SETTINGS_BYTES, MAX_TABLE_BYTES
from ..storage.files import csv_bytes, read_limited, write_whole
from ..text.safe_json import decoded, parse_json

SEQUENCE_FILE = "sequence.json"
#: Version of the sequence's file.
SCHEMA = 1
#: Rows written at a time.
_ROWS = 1 << 15
_AXES = ("x", "y", "z")
#: Columns of each table after the first, ``time_ns``.
TABLES: Mapping[str, tuple[str, ...]] = {
    "imu.csv": (*(f"rate_{axis}_rad_per_s" for axis in _AXES), *(f"force_{axis}_m_per_s2" for axis in _AXES)),
    "trajectory.csv": (
        *("lat_deg", "lon_deg", "height_m", "east_m_per_s", "north_m_per_s", "up_m_per_s"),
        *("q_w", "q_x", "q_y", "q_z"),
        *(f"gyro_bias_{axis}_rad_per_s" for axis in _AXES),
        *(f"accelerometer_bias_{axis}_m_per_s2" for axis in _AXES),
    ),
    "gnss.csv": ("lat_deg", "lon_deg", "height_m"),
    "barometer.csv": ("pressure_pa",),
    "magnetometer.csv": tuple(f"field_{axis}_nt" for axis in _AXES),
}
INERTIAL_FILE, TRAJECTORY_FILE, GNSS_FILE, BAROMETER_FILE, MAGNETOMETER_FILE = TABLES


def write_table(folder: Path, name: str, stamps_ns: Numbers, *columns: tuple[Floats, int]) -> None:
    """Write one of `TABLES`: times (n,), and values (n,) or (n, k), each with its decimals; empty cells for NaN."""
    values = np.concatenate(
        [np.round(column, digits).reshape(len(stamps_ns), -1) + 0.0 for column, digits in columns], axis=1
    )

    def blocks() -> Iterator[bytes]:
        yield csv_bytes([("time_ns", *TABLES[name])])
        for start in range(0, len(stamps_ns), _ROWS):
            some = slice(start, start + _ROWS)
            cells = ([value if value == value else None for value in row] for row in values[some].tolist())
            yield csv_bytes([stamp, *row] for stamp, row in zip(stamps_ns[some].tolist(), cells))

    write_whole(folder / name, blocks())


def read_table(folder: Path, name: str) -> tuple[Numbers, Floats]:
    """Times (n,) in nanoseconds and values (n, k) of one of `TABLES`; NaN for empty cells.

    Raises
    ------
    InvalidInput
        The file cannot be read, or holds something else.
    """
    path = folder / name
    try:
        head, *lines = decoded(read_limited(path, MAX_TABLE_BYTES)).splitlines()
        if head.split(",") != ["time_ns", *TABLES[name]]:
            raise InvalidInput("has other columns")
        cells = [line.split(",") for line in lines]
        stamps = np.array([int(row[0]) for row in cells], np.int64)
        values = np.array([[float(cell or "nan") for cell in row[1:]] for row in cells], np.float64)
        values = values.reshape(len(stamps), len(TABLES[name]))
    except (OSError, ValueError, OverflowError) as wrong:
        raise InvalidInput("table {0}: cannot be read ({1})", path, wrong) from wrong
    return stamps, values


def sequence_file(folder: str | os.PathLike[str]) -> Path | None:
    """The file that states the sequence of a dataset, in its folder or, of several imageries, above; None without."""
    paths = (one / SEQUENCE_FILE for one in (Path(folder), Path(folder).resolve().parent))
    return next((path for path in paths if path.is_file()), None)


@dataclass(frozen=True, eq=False)
class SequenceRecord:
    """A sequence as its folder states it.

    Parameters
    ----------
    folder : Path
    rate_hz, imu_rate_hz : float
    camera_to_imu : array (4, 4)
        From the camera's axes (right, down, view) to those of the inertial unit, in metres.
    imu_errors : mapping
        Figures of the errors of the inertial unit.
    gnss_m : float
        Standard deviation of the receiver's places along each axis.
    """

    folder: Path
    rate_hz: float
    imu_rate_hz: float
    camera_to_imu: Floats
    imu_errors: Mapping[str, float]
    gnss_m: float

    @classmethod
    def read(cls, folder: str | os.PathLike[str]) -> SequenceRecord:
        """Read the sequence of a dataset.

        Raises
        ------
        InvalidInput
            The folder holds no sequence, or a damaged one.
        """
        path = sequence_file(folder)
        if path is None:
            raise InvalidInput(
                "folder {0}: is not a sequence, as it has no {1}", folder, SEQUENCE_FILE, remedy="fly one"
            )
        try:
            data = parse_json(read_limited(path, MAX_SETTINGS_BYTES))
            if data["schema"] != SCHEMA:
                raise InvalidInput("version {0}: must be {1}", data["schema"], SCHEMA)
            rates = float(data["rate_hz"]), float(data["imu_rate_hz"])
            turn = np.array(data["camera_to_imu"], np.float64).reshape(4, 4)
            gnss_m = float(data["prior_errors"]["gnss_m"])
            errors = {str(name): float(value) for name, value in data["imu_errors"].items()}
        except (OSError, KeyError, TypeError, ValueError, AttributeError) as wrong:
            raise InvalidInput("sequence {0}: cannot be read ({1})", path, wrong) from wrong
        return cls(path.parent, *rates, turn, errors, gnss_m)

    def table(self, name: str) -> tuple[Numbers, Floats]:
        """Read one of `TABLES`; see `read_table`."""
        return read_table(self.folder, name)
