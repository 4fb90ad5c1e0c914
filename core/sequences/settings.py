"""Options of a sequence. Forms and the command show them; numpy is not imported."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import InvalidInput


@dataclass(frozen=True)
class InertialErrors:
    """Errors of an inertial unit, each one figure for all axes, in radians, metres and seconds.

    Parameters
    ----------
    gyro_noise, accelerometer_noise : float
        Density of white noise, rad/s/√Hz and m/s²/√Hz.
    gyro_walk, accelerometer_walk : float
        Density of the noise whose integral the bias is, rad/s²/√Hz and m/s³/√Hz.
    gyro_bias, accelerometer_bias : float
        Standard deviation of the first bias, rad/s and m/s².
    gyro_scale, accelerometer_scale : float
        Standard deviation of the scale factor's error, without unit.

    Raises
    ------
    InvalidInput
        A figure is negative or not finite.
    """

    gyro_noise: float = 0.0
    gyro_walk: float = 0.0
    gyro_bias: float = 0.0
    gyro_scale: float = 0.0
    accelerometer_noise: float = 0.0
    accelerometer_walk: float = 0.0
    accelerometer_bias: float = 0.0
    accelerometer_scale: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value >= 0.0):
                raise InvalidInput("{0} {1}: must be 0 or more", name, value)


#: Inertial units by name, with the source of their figures.
UNITS: Mapping[str, tuple[InertialErrors, str]] = {
    "ideal": (InertialErrors(), "without errors"),
    "euroc": (
        InertialErrors(
            gyro_noise=1.6968e-4, gyro_walk=1.9393e-5, accelerometer_noise=2.0e-3, accelerometer_walk=3.0e-3
        ),
        "ADIS16448 as in imu0/sensor.yaml of EuRoC MAV (Burri et al., IJRR 35(10), 2016), which has no first biases",
    ),
}
