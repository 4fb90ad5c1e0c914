"""Options for reading files of poses, for flying lines and patterns, and for sensor errors.

Forms and the command show them; numpy is not imported.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import InvalidInput
from ..fields import CheckedFields, declared
from ..mission.parts import HIGHEST_AGL_M, HIGHEST_GROUND_M, LOWEST_GROUND_M

#: Formats of trajectories in metres of a local frame.
LOCAL_FORMATS = ("tum", "kitti", "euroc")
#: Formats that do not state the unit of their times.
COUNTED_FORMATS = ("tum", "euroc")
#: Choice for ``times`` that leaves times out.
WITHOUT_TIMES = "none"
#: Formats of flight logs, which have far more positions than a mission has images.
LOG_FORMATS = ("ulog", "dataflash")
#: Formats by the endings of files.
ENDINGS = {".gpx": "gpx", ".ulg": "ulog", ".bin": "dataflash", ".log": "dataflash"}
#: Ending of exported Litchi missions.
LITCHI_ENDING = ".litchi.csv"


@dataclass(frozen=True)
class PoseFile(CheckedFields):
    """Options for reading the poses of a trajectory or flight log.

    Parameters
    ----------
    start_s : float or None
        Time of the first position, in seconds after 1970, instead of the file's times.
    """

    format: str | None = declared(
        None,
        title="format",
        help="format of a file with another ending",
        label="&Format",
        choices={
            "tum": "TUM trajectory",
            "kitti": "KITTI trajectory",
            "euroc": "EuRoC trajectory",
            "gpx": "GPX track",
            "ulog": "PX4 log (ULog)",
            "dataflash": "ArduPilot log (DataFlash)",
            "litchi": "Litchi mission",
        },
    )
    origin: tuple[float, ...] = declared(
        (),
        title="origin of the local frame",
        help="latitude, longitude and height of the frame's origin; heights of the file are above that height",
        label="&Origin: latitude, longitude, height",
    )
    body: str | None = declared(
        None,
        title="axes of what the poses are of",
        help="what the poses are of, with its axes; the camera of an aircraft looks down, the top of its image ahead",
        label="Poses &are of",
        choices={
            "camera": "camera (right, down, forward)",
            "frd": "aircraft (forward, right, down)",
            "flu": "aircraft (forward, left, up)",
            "urf": "EuRoC's inertial unit (up, right, forward)",
        },
    )
    world: str | None = declared(
        None,
        title="axes of the frame",
        help="axes of the frame that the poses are in",
        label="A&xes of the frame",
        choices={
            "enu": "east, north, up",
            "ned": "north, east, down",
            "rdf": "right, down, forward of a camera that looks north",
        },
    )
    ground_height_m: float | None = declared(
        None,
        title="ground height",
        help="height of the ground, as the file counts heights",
        unit="m",
        option="ground_height",
        least=LOWEST_GROUND_M,
        most=HIGHEST_GROUND_M,
    )
    agl_m: float | None = declared(
        None,
        title="height above ground",
        help="one height above ground for all positions",
        unit="m",
        option="agl",
        above=0.0,
        most=HIGHEST_AGL_M,
    )
    start_s: float | None = None
    times: str | None = declared(
        None,
        title="times",
        help="unit of the times of tum and euroc, or none: times of any format are left out",
        label="&Times",
        choices={
            "s": "in seconds",
            "ms": "in milliseconds",
            "us": "in microseconds",
            "ns": "in nanoseconds",
            WITHOUT_TIMES: "left out",
        },
    )
    flight: int | None = declared(
        None,
        title="flight",
        help="which flight of a log whose clock starts again, from 1",
        label="&Flight of the log",
        least=1,
        most=1000,
    )
    nadir: bool = declared(
        False,
        title="gimbal keeps the camera straight down",
        help="a gimbal keeps the camera straight down: take only the yaw of the attitude",
        label="Gimbal keeps the camera straight &down",
    )
    every_s: float | None = declared(
        None,
        title="time interval",
        help="keep one position each so many seconds",
        unit="s",
        above=0.0,
    )
    every_m: float | None = declared(
        None,
        title="distance interval",
        help="keep one position each so many metres of the way",
        unit="m",
        above=0.0,
    )


@dataclass(frozen=True)
class LineFlight(CheckedFields):
    """Options for flying a line; exactly one of the two intervals is required.

    Raises
    ------
    InvalidInput
        A value out of range, no interval, or both.
    """

    speed_m_per_s: float = declared(
        title="speed",
        help="speed over ground",
        label="&Speed",
        unit="m/s",
        option="speed",
        least=0.1,
        most=340.0,
        suggested=12.0,
    )
    every_s: float | None = declared(
        None,
        title="time interval",
        help="time from one exposure to the next",
        unit="s",
        above=0.0,
    )
    every_m: float | None = declared(
        None,
        title="distance interval",
        help="distance flown from one exposure to the next",
        unit="m",
        above=0.0,
    )
    bank_deg: float = declared(
        25.0,
        title="bank in turns",
        help="bank in turns; with the speed, it gives their radius",
        label="&Bank in turns",
        unit="deg",
        option="bank",
        least=1.0,
        most=80.0,
    )
    fixed_camera: bool = declared(
        False,
        title="camera rolls with the aircraft",
        help="the camera is fixed to the aircraft; without this, a gimbal keeps it level in turns",
        label="Camera rolls with the aircr&aft",
    )

    def __post_init__(self) -> None:
        """Check every field, and that exactly one interval is given."""
        super().__post_init__()
        if (self.every_s is None) == (self.every_m is None):
            raise InvalidInput("interval: must be either in seconds or in metres")


@dataclass(frozen=True)
class Corridor(CheckedFields):
    """A strip along a line, covered by parallel rows; the top of the images points along the way."""

    width_m: float = declared(
        title="width",
        help="width of the strip along the line; 0 is one row above the line",
        label="&Width",
        unit="m",
        option="width",
        least=0.0,
        most=100_000.0,
        suggested=60.0,
    )
    offset_m: float = declared(
        0.0,
        title="offset",
        help="how far to the right of the line the middle of the strip lies",
        label="&Offset to the right",
        unit="m",
        option="offset",
        least=-100_000.0,
        most=100_000.0,
    )


@dataclass(frozen=True)
class Orbit(CheckedFields):
    """Circles around a place, from which the camera looks at it.

    Raises
    ------
    InvalidInput
        A value out of range, or a highest circle below the lowest.
    """

    radius_m: float = declared(
        title="radius",
        help="distance of the captures from the centre",
        label="&Radius",
        unit="m",
        option="radius",
        above=0.0,
        most=100_000.0,
        suggested=40.0,
    )
    lowest_m: float = declared(
        title="lowest height",
        help="height above ground of the lowest circle",
        label="&Lowest height",
        unit="m",
        option="lowest",
        above=0.0,
        most=HIGHEST_AGL_M,
        suggested=30.0,
    )
    highest_m: float | None = declared(
        None,
        title="highest height",
        help="height above ground of the highest circle; left out, there is only one circle",
        label="&Highest height",
        unit="m",
        option="highest",
        above=0.0,
        most=HIGHEST_AGL_M,
    )
    circles: int = declared(
        1,
        title="circles",
        help="number of circles, evenly spaced from the lowest height to the highest",
        label="&Circles",
        least=1,
        most=1000,
    )
    images: int = declared(
        36,
        title="images per circle",
        help="number of images on each circle",
        label="&Images per circle",
        least=1,
        most=36_000,
    )
    target_m: float = declared(
        0.0,
        title="height of the target",
        help="height above ground, at the centre, that the camera looks at",
        label="Height of the &target",
        unit="m",
        option="target",
        least=0.0,
        most=HIGHEST_AGL_M,
    )

    def __post_init__(self) -> None:
        """Check every field, and the heights against each other."""
        super().__post_init__()
        _check_heights(self.lowest_m, self.highest_m)
        if self.circles > 1 and self.highest_m is None:
            raise InvalidInput(
                "{0} circles at one height: must be 1", self.circles, remedy="give the highest height as well"
            )


@dataclass(frozen=True)
class Scan(CheckedFields):
    """Flights along the walls of a structure, one above the other, from which the camera looks at them.

    Raises
    ------
    InvalidInput
        A value out of range, or a highest flight below the lowest.
    """

    distance_m: float = declared(
        title="distance",
        help="distance of the captures from the wall",
        label="&Distance",
        unit="m",
        option="distance",
        above=0.0,
        most=10_000.0,
        suggested=20.0,
    )
    lowest_m: float = declared(
        title="lowest height",
        help="height above ground of the lowest flight",
        label="&Lowest height",
        unit="m",
        option="lowest",
        above=0.0,
        most=HIGHEST_AGL_M,
        suggested=10.0,
    )
    highest_m: float | None = declared(
        None,
        title="highest height",
        help="height above ground of the highest flight; left out, there is only one flight",
        label="&Highest height",
        unit="m",
        option="highest",
        above=0.0,
        most=HIGHEST_AGL_M,
    )
    tilt_deg: float = declared(
        90.0,
        title="tilt",
        help="tilt of the camera: 90 looks level at the wall, less looks down at it",
        label="&Tilt",
        unit="deg",
        option="tilt",
        least=30.0,
        most=120.0,
    )

    def __post_init__(self) -> None:
        """Check every field, and the heights against each other."""
        super().__post_init__()
        _check_heights(self.lowest_m, self.highest_m)


def _check_heights(lowest_m: float, highest_m: float | None) -> None:
    if highest_m is not None and highest_m < lowest_m:
        raise InvalidInput(
            "highest height {0:g} m: is below the lowest, {1:g} m", highest_m, lowest_m, field="highest_m"
        )


@dataclass(frozen=True)
class Sensors:
    """Errors of sensors.

    Parameters
    ----------
    gnss_m, barometer_m, compass_deg : float
        Standard deviations: of the place, along east and along north, up to 10 km; of the height, up to 10 km; of the
        heading, up to 180 degrees.
    drift_s : float
        Time constant of the drifting half of the variance, up to 1e6; 0 makes all variance white.
    outage_share, outage_s : float
        Share of the time without a fix, in [0, 1), and mean duration of an outage.

    Raises
    ------
    InvalidInput
        A value out of range.
    """

    gnss_m: float = 1.5
    barometer_m: float = 1.0
    compass_deg: float = 3.0
    drift_s: float = 60.0
    outage_share: float = 0.0
    outage_s: float = 10.0

    def __post_init__(self) -> None:
        # A reading with larger errors carries no information about the pose.
        limits = {"gnss_m": 10_000.0, "barometer_m": 10_000.0, "compass_deg": 180.0, "drift_s": 1e6}
        for name, most in limits.items():
            value = getattr(self, name)
            if not 0.0 <= value <= most:
                raise InvalidInput("{0} {1}: must be from 0 to {2:,g}", name, value, most)
        if not 0.0 <= self.outage_share < 1.0:
            raise InvalidInput("share of outages {0}: must be from 0 to below 1", self.outage_share)
        if not (math.isfinite(self.outage_s) and self.outage_s > 0.0):
            raise InvalidInput("mean length of outages {0} s: must be above 0", self.outage_s)
