"""Options of a sequence. Forms and the command show them; numpy is not imported."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from ..errors import InvalidInput
from ..fields import CheckedFields, declared


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


def inertial_errors(unit: str, figures: Mapping[str, float]) -> tuple[InertialErrors, str]:
    """Errors of a unit by name with some figures replaced, and the source of the figures."""
    errors, source = UNITS[unit]
    if not figures:
        return errors, source
    return replace(errors, **figures), f"{source}; {', '.join(figures)} as given"


@dataclass(frozen=True)
class SequenceSettings(CheckedFields):
    """Rates, inertial unit and random errors of a sequence."""

    rate_hz: float = declared(
        20.0,
        title="frame rate",
        help="frames per second",
        unit="Hz",
        option="rate",
        least=0.1,
        most=240.0,
    )
    smooth_s: float | None = declared(
        None,
        title="smoothing",
        help="interval of the control points of the path; 0 goes exactly through poses. Left out, poses with times are "
        "gone through, and other flights turn with about 4.5 m/s²",
        unit="s",
        option="smooth",
        least=0.0,
        most=60.0,
    )
    sortie: int = declared(
        1,
        title="sortie",
        help="which sortie of the flight, from its first capture to its last",
        least=1,
        most=999,
    )
    imu: str = declared(
        "euroc",
        title="inertial unit",
        help="errors of the inertial unit",
        choices={"ideal": "without errors", "euroc": "ADIS16448 as in EuRoC MAV"},
    )
    imu_rate_hz: float = declared(
        200.0,
        title="rate of the inertial unit",
        help="inertial measurements per second",
        unit="Hz",
        option="imu_rate",
        least=10.0,
        most=4000.0,
    )
    imu_axes: str = declared(
        "frd",
        title="axes of the inertial unit",
        help="axes of the inertial unit, which the camera is fixed to",
        choices={
            "frd": "forward, right, down; the camera looks down, the top of its image ahead",
            "flu": "forward, left, up; the camera looks down, the top of its image ahead",
            "urf": "up, right, forward; the camera looks forward",
            "camera": "right, down, forward of the camera",
        },
    )
    gnss_rate_hz: float = declared(
        5.0,
        title="rate of the GNSS receiver",
        help="positions per second",
        unit="Hz",
        option="gnss_rate",
        least=0.1,
        most=100.0,
    )
    air_rate_hz: float = declared(
        50.0,
        title="rate of barometer and magnetometer",
        help="readings of barometer and magnetometer per second",
        unit="Hz",
        option="air_rate",
        least=0.1,
        most=1000.0,
    )
    sensor_seed: int = declared(
        2024,
        title="seed of the sensors",
        help="seed of the sensors' random errors",
        least=0,
    )

    def __post_init__(self) -> None:
        """Check every field, and the rates against each other."""
        super().__post_init__()
        if self.imu_rate_hz < self.rate_hz:
            raise InvalidInput(
                "rate of the inertial unit {0:g} Hz: must be at least that of the frames, {1:g} Hz",
                self.imu_rate_hz,
                self.rate_hz,
                field="imu_rate_hz",
            )
