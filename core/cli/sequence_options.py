"""Options of ``terrainav fly`` besides those of ``terrainav capture``."""

from __future__ import annotations

import argparse
from dataclasses import fields

from ..fields import declared_fields
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


def add_sequence(flying: argparse.ArgumentParser) -> None:
    """Add the options of a sequence."""
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
