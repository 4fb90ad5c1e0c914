"""Options of ``terrainav fly`` besides those of ``terrainav capture``."""

from __future__ import annotations

import argparse
from dataclasses import fields, replace

from ..fields import declared_fields
from ..poses.settings import PoseFile
from ..sequences.settings import InertialErrors, SequenceSettings
from .dataset_options import add_field
from .pose_options import add_sensor_errors

#: What each figure of an inertial unit is.
_FIGURES = {
    "noise": "density of white noise, {0}/√Hz",
    "walk": "density of the noise whose integral the bias is, {1}/√Hz",
    "bias": "standard deviation of the first bias, {0}",
    "scale": "standard deviation of the scale factor's error",
}
#: Options for the fields of `PoseFile` that say how ``--trajectory`` is read.
TRACK_FIELDS = {
    "format": "trajectory_format",
    "origin": "origin",
    "body": "body",
    "world": "world",
    "ground_height_m": "trajectory_ground_height",
    "nadir": "nadir",
    "times": "times",
    "flight": "flight",
}


def add_sequence(flying: argparse.ArgumentParser) -> None:
    """Add the options of a sequence."""
    _add_tracks(flying)
    group = flying.add_argument_group("sequence")
    for field in declared_fields(SequenceSettings):
        add_field(group, field)
    group.add_argument(
        "--lever-arm",
        nargs=3,
        type=float,
        default=(0.0, 0.0, 0.0),
        metavar=("X", "Y", "Z"),
        help="projection centre of the camera in the inertial unit's axes, m (0 0 0)",
    )
    figures = flying.add_argument_group("figures of the inertial unit, instead of those of --imu")
    for one in fields(InertialErrors):
        sensor, _, kind = one.name.partition("_")
        units = ("rad/s", "rad/s²") if sensor == "gyro" else ("m/s²", "m/s³")
        figures.add_argument(
            f"--{one.name.replace('_', '-')}", type=float, metavar="X", help=_FIGURES[kind].format(*units)
        )
    add_sensor_errors(flying.add_argument_group("errors of GNSS receiver, barometer and magnetometer"))


def _add_tracks(flying: argparse.ArgumentParser) -> None:
    """Add the options of flights that a file or a flight dynamics model states."""
    group = flying.add_argument_group("flight of a file or of an aircraft, instead of a mission's")
    flown = group.add_mutually_exclusive_group()
    flown.add_argument(
        "--trajectory", metavar="FILE", help="trajectory or flight log, in a format that `terrainav poses read` reads"
    )
    flown.add_argument(
        "--jsbsim",
        metavar="SCRIPT",
        help="script of JSBSim, such as scripts/Test_F450_Launch.xml of the Python package jsbsim",
    )
    for field in declared_fields(PoseFile):
        if field.name == "origin":
            group.add_argument("--origin", nargs="+", type=float, metavar="DEG", help=f"LAT LON [HEIGHT]: {field.help}")
        elif field.name in TRACK_FIELDS:
            add_field(group, replace(field, option=TRACK_FIELDS[field.name]))
    group.add_argument("--jsbsim-root", metavar="DIR", help="folder with the aircraft, instead of the package's")
    group.add_argument(
        "--jsbsim-place", nargs=2, type=float, metavar=("LAT", "LON"), help="where the script's flight begins, degrees"
    )
    group.add_argument(
        "--raise",
        dest="raised_m",
        type=float,
        default=0.0,
        metavar="M",
        help="height added to the flight of a file or of an aircraft, m (0)",
    )
