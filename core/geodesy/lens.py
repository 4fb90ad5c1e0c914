"""Field of view, aspect ratio, distortion and ground size of a camera, in plain Python numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
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
#: Fields that distort pictures, besides the kind of lens.
_DISTORTION = ("k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2", "principal_x", "principal_y")
#: Fields of a lens besides the field of view and the shape of its image.
LENS_FIELDS = ("lens", *_DISTORTION, "red_scale", "blue_scale")
#: Kinds of lenses.
LENSES = PERSPECTIVE, FISHEYE = ("perspective", "fisheye")
#: Coefficients that each kind has, in OpenCV's order.
COEFFICIENTS = {
    PERSPECTIVE: ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"),
    FISHEYE: ("k1", "k2", "k3", "k4"),
}


@dataclass(frozen=True)
class Lens(CheckedFields):
    """The lens of a camera with square pixels; by default that of an ideal pinhole camera.

    Parameters
    ----------
    fov_deg : float
        Diagonal field of view of the lens without distortion and with a centred axis, in (0, 180) degrees: for a
        focal length f and half a diagonal d of the image, 2 atan(d/f), and 2 d/f for a fisheye.
    aspect_ratio : float
        Image width over image height, > 0.
    lens : str
        ``perspective``, distorted after Brown and Conrady by k1 to k6, p1 and p2, or ``fisheye``, after Kannala and
        Brandt by k1 to k4; as OpenCV defines them.
    principal_x, principal_y : float
        How far the principal point is right of the image's centre and below it, as shares of its width and height.
    red_scale, blue_scale : float
        Magnification of red and blue relative to green, minus 1.
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
    lens: str = declared(
        PERSPECTIVE,
        title="lens",
        help="a perspective lens, or a fisheye, whose image is about as far from its centre as a ray is off the axis",
        choices={PERSPECTIVE: "perspective", FISHEYE: "fisheye"},
        advanced=True,
    )
    k1: float = declared(
        0.0,
        title="distortion k1",
        help="first radial coefficient of the lens's distortion, as OpenCV defines it",
        unit="coefficient",
        advanced=True,
    )
    k2: float = declared(
        0.0, title="distortion k2", help="second radial coefficient", unit="coefficient", advanced=True
    )
    k3: float = declared(0.0, title="distortion k3", help="third radial coefficient", unit="coefficient", advanced=True)
    k4: float = declared(
        0.0,
        title="distortion k4",
        help="fourth radial coefficient; of a perspective lens, in the denominator",
        unit="coefficient",
        advanced=True,
    )
    k5: float = declared(
        0.0,
        title="distortion k5",
        help="fifth radial coefficient of a perspective lens, in the denominator",
        unit="coefficient",
        advanced=True,
    )
    k6: float = declared(
        0.0,
        title="distortion k6",
        help="sixth radial coefficient of a perspective lens, in the denominator",
        unit="coefficient",
        advanced=True,
    )
    p1: float = declared(
        0.0,
        title="distortion p1",
        help="first tangential coefficient of a perspective lens",
        unit="coefficient",
        advanced=True,
    )
    p2: float = declared(
        0.0,
        title="distortion p2",
        help="second tangential coefficient of a perspective lens",
        unit="coefficient",
        advanced=True,
    )
    principal_x: float = declared(
        0.0,
        title="principal point, right",
        help="how far the optical axis meets the image right of its centre, as a share of its width",
        unit="coefficient",
        least=-0.5,
        most=0.5,
        advanced=True,
    )
    principal_y: float = declared(
        0.0,
        title="principal point, down",
        help="how far the optical axis meets the image below its centre, as a share of its height",
        unit="coefficient",
        least=-0.5,
        most=0.5,
        advanced=True,
    )
    red_scale: float = declared(
        0.0,
        title="scale of red",
        help="magnification of red relative to green, minus 1: 0.001 moves a corner at 400 px outward by 0.4 px",
        unit="coefficient",
        least=-0.1,
        most=0.1,
        advanced=True,
    )
    blue_scale: float = declared(
        0.0,
        title="scale of blue",
        help="magnification of blue relative to green, minus 1",
        unit="coefficient",
        least=-0.1,
        most=0.1,
        advanced=True,
    )

    @classmethod
    def from_horizontal_fov(
        cls: type[_Lens], fov_deg: float, aspect_ratio: float = PAPER_ASPECT_RATIO, lens: str = PERSPECTIVE
    ) -> _Lens:
        """Camera by its horizontal field of view h: the diagonal one is 2 atan(tan(h/2) sqrt(1 + a^2) / a).

        Parameters
        ----------
        fov_deg : float
            Horizontal field of view, in (0, 180) degrees.
        aspect_ratio : float
            Image width over image height, a, > 0.
        lens : str
            Of a fisheye, the diagonal field of view is h sqrt(1 + a^2) / a.

        Raises
        ------
        InvalidInput
            Outside the domain, or where the diagonal field of view rounds to 180 degrees.
        """
        _check_side("horizontal", fov_deg, aspect_ratio)
        return cls._across(_half_size(fov_deg, lens) * math.hypot(1.0, 1.0 / aspect_ratio), aspect_ratio, lens)

    @classmethod
    def from_vertical_fov(
        cls: type[_Lens], fov_deg: float, aspect_ratio: float = PAPER_ASPECT_RATIO, lens: str = PERSPECTIVE
    ) -> _Lens:
        """Camera by its vertical field of view v: the diagonal one is 2 atan(tan(v/2) sqrt(1 + a^2)).

        Parameters and errors are those of `from_horizontal_fov`.
        """
        _check_side("vertical", fov_deg, aspect_ratio)
        return cls._across(_half_size(fov_deg, lens) * math.hypot(1.0, aspect_ratio), aspect_ratio, lens)

    @classmethod
    def from_focal_px(
        cls: type[_Lens], size_px: tuple[float, float], focal_px: float, lens: str = PERSPECTIVE
    ) -> _Lens:
        """Camera by the size of its image and its focal length, > 0 each, as calibrations state them."""
        return cls._across(math.hypot(*size_px) / 2.0 / focal_px, size_px[0] / size_px[1], lens)

    @classmethod
    def from_sensor(
        cls: type[_Lens],
        sensor_mm: tuple[float, float],
        focal_length_mm: float,
        aspect_ratio: float | None = None,
        lens: str = PERSPECTIVE,
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
        lens : str
            Of a fisheye, the diagonal field of view is sqrt(w^2 + h^2) / f.

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
        return cls._across(math.hypot(width_mm, height_mm) / 2.0 / focal_length_mm, ratio, lens)

    @classmethod
    def _across(cls: type[_Lens], half_size: float, aspect_ratio: float, lens: str) -> _Lens:
        """Camera by half its image's diagonal in focal lengths."""
        fov_deg = _across_deg(half_size, lens)
        if not 0.0 < fov_deg < 180.0:
            raise InvalidInput(
                "field of view across the diagonal {0:g} deg: must be between 0 and 180, both excluded",
                fov_deg,
                remedy="choose a less extreme field of view or aspect ratio",
            )
        return cls(fov_deg, aspect_ratio) if lens == PERSPECTIVE else cls(fov_deg, aspect_ratio, lens)

    @property
    def distorts(self) -> bool:
        """Whether pictures differ from those of an ideal pinhole camera with a centred axis."""
        return self.lens != PERSPECTIVE or any(getattr(self, name) != 0.0 for name in _DISTORTION)

    @property
    def splits_colours(self) -> bool:
        """Whether red, green and blue have pictures of their own."""
        return self.red_scale != 0.0 or self.blue_scale != 0.0

    @property
    def is_ideal(self) -> bool:
        """Whether the camera is an ideal pinhole camera with a centred axis."""
        return not (self.distorts or self.splits_colours)

    @property
    def undistorted(self: _Lens) -> _Lens:
        """Ideal pinhole camera with the same focal length and shape of the image, and a centred axis."""
        fov_deg = self.fov_deg
        if self.lens != PERSPECTIVE:
            fov_deg = _across_deg(_half_size(fov_deg, self.lens), PERSPECTIVE)
        return type(self)(fov_deg, self.aspect_ratio)

    @property
    def coefficients(self) -> dict[str, float]:
        """Coefficients that this kind of lens has, by name, in OpenCV's order."""
        return {name: getattr(self, name) for name in COEFFICIENTS[self.lens]}

    @property
    def half_tangents(self) -> tuple[float, float]:
        """Half the width and half the height of the image in focal lengths.

        Of a perspective lens without distortion, the tangents of half the horizontal and half the vertical field of
        view: equation 2 of the paper, without its sine and cosine of an arctangent, which lose all digits of the height
        at extreme aspect ratios.
        """
        diagonal = _half_size(self.fov_deg, self.lens)
        return (
            diagonal * (self.aspect_ratio / math.hypot(1.0, self.aspect_ratio)),
            diagonal / math.hypot(1.0, self.aspect_ratio),
        )

    @property
    def horizontal_fov_deg(self) -> float:
        """Horizontal field of view in degrees, without distortion."""
        return _across_deg(self.half_tangents[0], self.lens)

    @property
    def vertical_fov_deg(self) -> float:
        """Vertical field of view in degrees, without distortion."""
        return _across_deg(self.half_tangents[1], self.lens)

    def enlarged(self: _Lens, scale: float) -> _Lens:
        """Camera with its focal length times ``scale``."""
        return replace(self, fov_deg=_across_deg(math.hypot(*self.half_tangents) / scale, self.lens))

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


def _half_size(fov_deg: float, lens: str) -> float:
    """Half of an image in focal lengths, across a field of view."""
    return math.radians(fov_deg) / 2.0 if lens == FISHEYE else _half_tangent(fov_deg)


def _across_deg(half_size: float, lens: str) -> float:
    """Inverse of `_half_size`, in degrees."""
    return math.degrees(2.0 * (half_size if lens == FISHEYE else math.atan(half_size)))


def _check_side(side: str, fov_deg: float, aspect_ratio: float) -> None:
    if not 0.0 < fov_deg < 180.0:
        raise InvalidInput("{0} field of view {1} deg: must be between 0 and 180, both excluded", side, fov_deg)
    _check_ratio(aspect_ratio)


def _check_ratio(aspect_ratio: float) -> None:
    field_named(Lens, "aspect_ratio").settled(aspect_ratio)
