"""Field of view, aspect ratio and ground size of an ideal camera, in plain Python numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

from ..errors import InvalidInput
from ..fields import CheckedFields, declared, field_named

_Lens = TypeVar("_Lens", bound="Lens")
#: Largest relative difference between the aspect ratios of sensor and image that rounding in data sheets explains;
#: beyond it the numbers do not match, or pixels are not square.
SQUARE_PIXELS = 0.03
#: Diagonal field of view of the paper's camera.
PAPER_FOV_DEG = 78.8
#: Aspect ratio of the paper's camera.
PAPER_ASPECT_RATIO = 4.0 / 3.0


@dataclass(frozen=True)
class Lens(CheckedFields):
    """The lens of an ideal pinhole camera with square pixels.

    Parameters
    ----------
    fov_deg : float
        Diagonal field of view, in (0, 180) degrees.
    aspect_ratio : float
        Image width over image height, > 0.
    """

    fov_deg: float = declared(
        PAPER_FOV_DEG,
        title="field of view",
        help="field of view across the image's diagonal",
        unit="deg",
        option="fov",
        above=0.0,
        below=180.0,
    )
    aspect_ratio: float = declared(
        PAPER_ASPECT_RATIO, title="aspect ratio", help="width of the image over its height", above=0.0
    )

    @classmethod
    def from_horizontal_fov(cls: type[_Lens], fov_deg: float, aspect_ratio: float = PAPER_ASPECT_RATIO) -> _Lens:
        """Camera by its horizontal field of view h: the diagonal one is 2 atan(tan(h/2) sqrt(1 + a^2) / a).

        Parameters
        ----------
        fov_deg : float
            Horizontal field of view, in (0, 180) degrees.
        aspect_ratio : float
            Image width over image height, a, > 0.

        Raises
        ------
        InvalidInput
            Outside the domain, or where the diagonal field of view rounds to 180 degrees.
        """
        _check_side("horizontal", fov_deg, aspect_ratio)
        return cls._across(_half_tangent(fov_deg) * math.hypot(1.0, 1.0 / aspect_ratio), aspect_ratio)

    @classmethod
    def from_vertical_fov(cls: type[_Lens], fov_deg: float, aspect_ratio: float = PAPER_ASPECT_RATIO) -> _Lens:
        """Camera by its vertical field of view v: the diagonal one is 2 atan(tan(v/2) sqrt(1 + a^2)).

        Parameters and errors are those of `from_horizontal_fov`.
        """
        _check_side("vertical", fov_deg, aspect_ratio)
        return cls._across(_half_tangent(fov_deg) * math.hypot(1.0, aspect_ratio), aspect_ratio)

    @classmethod
    def from_sensor(
        cls: type[_Lens],
        sensor_mm: tuple[float, float],
        focal_length_mm: float,
        aspect_ratio: float | None = None,
    ) -> _Lens:
        """Camera by its data sheet: the diagonal field of view is 2 atan(sqrt(w^2 + h^2) / (2 f)).

        Parameters
        ----------
        sensor_mm : (width, height)
            Size of the part of the sensor that the image shows, w and h, > 0.
        focal_length_mm : float
            True focal length f, > 0; not one "equivalent to 35 mm film".
        aspect_ratio : float or None
            Aspect ratio of the image in pixels, which data sheets state exactly while they round the sensor's size;
            None for that of the sensor.

        Raises
        ------
        InvalidInput
            Outside the domain, or pixels farther from square than `SQUARE_PIXELS`.
        """
        width_mm, height_mm = sensor_mm
        if not all(math.isfinite(side) and side > 0.0 for side in sensor_mm):
            raise InvalidInput("sensor {0} by {1} mm: both sides must be above 0", width_mm, height_mm)
        if not (math.isfinite(focal_length_mm) and focal_length_mm > 0.0):
            raise InvalidInput("focal length {0} mm: must be above 0", focal_length_mm)
        sensor_ratio = width_mm / height_mm
        ratio = sensor_ratio if aspect_ratio is None else aspect_ratio
        _check_ratio(ratio)
        if abs(sensor_ratio / ratio - 1.0) > SQUARE_PIXELS:
            raise InvalidInput(
                "sensor {0:g} by {1:g} mm and an image of {2:.4g} to 1: pixels would not be square",
                width_mm,
                height_mm,
                ratio,
                remedy="give the part of the sensor that the image shows",
            )
        return cls._across(math.hypot(width_mm, height_mm) / 2.0 / focal_length_mm, ratio)

    @classmethod
    def _across(cls: type[_Lens], half_tangent: float, aspect_ratio: float) -> _Lens:
        """Camera by the tangent of half its diagonal field of view."""
        fov_deg = _fov_deg(half_tangent)
        if not 0.0 < fov_deg < 180.0:
            raise InvalidInput(
                "field of view across the diagonal {0:g} deg: must be between 0 and 180, both excluded",
                fov_deg,
                remedy="choose a less extreme field of view or aspect ratio",
            )
        return cls(fov_deg, aspect_ratio)

    @property
    def half_tangents(self) -> tuple[float, float]:
        """Tangents of half the horizontal and half the vertical field of view.

        Equation 2 of the paper, without its sine and cosine of an arctangent, which lose all digits of the height at
        extreme aspect ratios.
        """
        diagonal = _half_tangent(self.fov_deg)
        return (
            diagonal * (self.aspect_ratio / math.hypot(1.0, self.aspect_ratio)),
            diagonal / math.hypot(1.0, self.aspect_ratio),
        )

    @property
    def horizontal_fov_deg(self) -> float:
        """Horizontal field of view in degrees."""
        return _fov_deg(self.half_tangents[0])

    @property
    def vertical_fov_deg(self) -> float:
        """Vertical field of view in degrees."""
        return _fov_deg(self.half_tangents[1])

    def ground_size_m(self, agl_m: float) -> tuple[float, float]:
        """Width and height in metres of flat ground seen straight down from ``agl_m`` (equations 1, 2)."""
        tan_x, tan_y = self.half_tangents
        return 2.0 * agl_m * tan_x, 2.0 * agl_m * tan_y

    def gsd_m_per_px(self, agl_m: float, longer_side_px: float) -> float:
        """Ground sample distance of an image of flat ground taken straight down.

        It is 2 H t / n, with t the tangent of half the field of view along the longer side. As pixels are square, it is
        the same along both sides and everywhere in the image.

        Parameters
        ----------
        agl_m : float
            Height above ground H in metres, > 0.
        longer_side_px : float
            Pixels n along the image's longer side, > 0.
        """
        return 2.0 * agl_m * max(self.half_tangents) / longer_side_px

    def agl_m(self, gsd_m_per_px: float, longer_side_px: float) -> float:
        """Height above ground in metres at which an image has a ground sample distance; inverse of `gsd_m_per_px`."""
        return gsd_m_per_px * longer_side_px / (2.0 * max(self.half_tangents))


def _half_tangent(fov_deg: float) -> float:
    """tan(fov/2); above 90° through the complement, which keeps the digits of the argument."""
    if fov_deg <= 90.0:
        return math.tan(math.radians(fov_deg) / 2.0)
    return 1.0 / math.tan(math.radians(180.0 - fov_deg) / 2.0)


def _fov_deg(half_tangent: float) -> float:
    """Inverse of `_half_tangent`, in degrees."""
    return math.degrees(2.0 * math.atan(half_tangent))


def _check_side(side: str, fov_deg: float, aspect_ratio: float) -> None:
    if not 0.0 < fov_deg < 180.0:
        raise InvalidInput("{0} field of view {1} deg: must be between 0 and 180, both excluded", side, fov_deg)
    _check_ratio(aspect_ratio)


def _check_ratio(aspect_ratio: float) -> None:
    field_named(Lens, "aspect_ratio").settled(aspect_ratio)
