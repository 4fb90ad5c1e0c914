"""Cameras by their field of view, and their poses: where they are and which way they look."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from .ellipsoid import sin_cos

Floats = NDArray[np.float64]
#: Image coordinates (right, up), each -1..1, of the corners north-west, north-east, south-east,
#: south-west and of the edge midpoints north, east, south, west of a north-up camera.
CORNERS = ((-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0))
EDGE_MIDPOINTS = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))
#: Width to height of a sensor may differ from that of its pixels by this share, which is what data sheets round
#: away; beyond, the numbers do not belong together or the pixels are not square.
SQUARE_PIXELS = 0.03


@dataclass(frozen=True)
class Camera:
    """An ideal pinhole camera with square pixels.

    Parameters
    ----------
    fov_deg : float
        Diagonal field of view, in (0, 180) degrees.
    aspect_ratio : float
        Image width over image height, > 0.
    """

    fov_deg: float = 78.8
    aspect_ratio: float = 4.0 / 3.0

    def __post_init__(self) -> None:
        if not 0.0 < self.fov_deg < 180.0:
            raise InvalidInput(
                "field of view {0} deg: must be between 0 and 180, both excluded", self.fov_deg
            )
        _check_ratio(self.aspect_ratio)
        object.__setattr__(self, "fov_deg", float(self.fov_deg))
        object.__setattr__(self, "aspect_ratio", float(self.aspect_ratio))

    @classmethod
    def from_horizontal_fov(cls, fov_deg: float, aspect_ratio: float = 4.0 / 3.0) -> Camera:
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
            Outside the domain, or where the diagonal is no longer told from 180 degrees.
        """
        _check_side("horizontal", fov_deg, aspect_ratio)
        return cls._across(_half_tangent(fov_deg) * math.hypot(1.0, 1.0 / aspect_ratio), aspect_ratio)

    @classmethod
    def from_vertical_fov(cls, fov_deg: float, aspect_ratio: float = 4.0 / 3.0) -> Camera:
        """Camera by its vertical field of view v: the diagonal one is 2 atan(tan(v/2) sqrt(1 + a^2)).

        Parameters and refusals are those of `from_horizontal_fov`.
        """
        _check_side("vertical", fov_deg, aspect_ratio)
        return cls._across(_half_tangent(fov_deg) * math.hypot(1.0, aspect_ratio), aspect_ratio)

    @classmethod
    def from_sensor(
        cls, sensor_mm: tuple[float, float], focal_length_mm: float, aspect_ratio: float | None = None
    ) -> Camera:
        """Camera by its data sheet: the diagonal field of view is 2 atan(sqrt(w^2 + h^2) / (2 f)).

        Parameters
        ----------
        sensor_mm : (width, height)
            Of the part of the sensor that makes the picture, w and h, > 0.
        focal_length_mm : float
            The lens's own, f, > 0; not one "equivalent to 35 mm film".
        aspect_ratio : float or None
            Of the picture in pixels, which data sheets state exactly where they round the sensor's size; None for
            that of the sensor.

        Raises
        ------
        InvalidInput
            Outside the domain, or where the pixels would be further from square than `SQUARE_PIXELS`.
        """
        width_mm, height_mm = sensor_mm
        if not all(math.isfinite(side) and side > 0.0 for side in sensor_mm):
            raise InvalidInput("sensor {0} by {1} mm: both sides must be above 0", width_mm, height_mm)
        if not (math.isfinite(focal_length_mm) and focal_length_mm > 0.0):
            raise InvalidInput("focal length {0} mm: must be above 0", focal_length_mm)
        own = width_mm / height_mm
        ratio = own if aspect_ratio is None else aspect_ratio
        _check_ratio(ratio)
        if abs(own / ratio - 1.0) > SQUARE_PIXELS:
            raise InvalidInput(
                "sensor {0:g} by {1:g} mm and a picture of {2:.4g} to 1: pixels would not be square",
                width_mm,
                height_mm,
                ratio,
                remedy="give the part of the sensor that the picture shows",
            )
        return cls._across(math.hypot(width_mm, height_mm) / 2.0 / focal_length_mm, ratio)

    @classmethod
    def _across(cls, half_tangent: float, aspect_ratio: float) -> Camera:
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

        The paper's equation 2 without its sine and cosine of an arctangent, which lose every digit of
        the height at extreme aspect ratios.
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
        """Width and height in metres of flat ground seen from ``agl_m`` straight above (equations 1, 2)."""
        tan_x, tan_y = self.half_tangents
        return 2.0 * agl_m * tan_x, 2.0 * agl_m * tan_y

    def gsd_m_per_px(self, agl_m: float, longer_side_px: float) -> float:
        """Ground sample distance straight down, at the middle of the picture, over flat ground.

        It is 2 H t / n with t the tangent of half the field of view along the longer side: as pixels are square, it is
        the same along both sides, and everywhere in the picture of flat ground seen from straight above.

        Parameters
        ----------
        agl_m : float
            Height above ground H in metres, > 0.
        longer_side_px : float
            Pixels n along the picture's longer side, > 0.
        """
        return 2.0 * agl_m * max(self.half_tangents) / longer_side_px

    def agl_m(self, gsd_m_per_px: float, longer_side_px: float) -> float:
        """Height above ground in metres at which a picture has a ground sample distance; inverse of `gsd_m_per_px`."""
        return gsd_m_per_px * longer_side_px / (2.0 * max(self.half_tangents))

    def rays_enu(
        self,
        image_xy: Floats | tuple[tuple[float, float], ...],
        yaw_deg: Floats | float = 0.0,
        tilt_deg: Floats | float = 0.0,
        roll_deg: Floats | float = 0.0,
    ) -> Floats:
        """Directions of image points, in the camera's east, north, up.

        Yaw turns the top of the image clockwise from north; tilt then lifts the view from straight down
        towards where the top of the image points; roll last turns the camera about the direction of its
        image's top, right side down. They are the yaw, pitch and roll of an aircraft (z-y'-x'') that
        carries the camera looking down.

        Parameters
        ----------
        image_xy : array (k, 2), or (..., k, 2) for points of each pose's own
            Right and up, each -1..1 from edge to edge of the image.
        yaw_deg, tilt_deg, roll_deg : array (...) or float
            Attitude of each pose, broadcast against each other.

        Returns
        -------
        array (..., k, 3)
            Not normalised: the part along the optical axis is 1.
        """
        right, image_up, axis = _image_axes(yaw_deg, tilt_deg, roll_deg)
        points = np.asarray(image_xy, np.float64)
        tan_x, tan_y = self.half_tangents
        rays: Floats = (
            axis[..., np.newaxis, :]
            + (points[..., :1] * tan_x) * right[..., np.newaxis, :]
            + (points[..., 1:] * tan_y) * image_up[..., np.newaxis, :]
        )
        return rays

    def image_xy(
        self,
        vectors_enu: Floats,
        yaw_deg: Floats | float = 0.0,
        tilt_deg: Floats | float = 0.0,
        roll_deg: Floats | float = 0.0,
    ) -> tuple[Floats, NDArray[np.bool_]]:
        """Image points of directions; the inverse of `rays_enu`.

        Parameters
        ----------
        vectors_enu : array (..., k, 3)
            East, north, up of the camera; any length but zero.
        yaw_deg, tilt_deg, roll_deg : array (...) or float

        Returns
        -------
        image_xy : array (..., k, 2)
            Right and up, -1..1 inside the image; finite but without meaning for what lies behind the camera.
        in_front : array (..., k) of bool
        """
        right, image_up, axis = (
            np.einsum("...ki,...i->...k", vectors_enu, direction)
            for direction in _image_axes(yaw_deg, tilt_deg, roll_deg)
        )
        in_front = axis > 0.0
        depth = np.where(in_front, axis, 1.0)
        tan_x, tan_y = self.half_tangents
        return np.stack([right / depth / tan_x, image_up / depth / tan_y], axis=-1), in_front

    def beyond_sides(
        self,
        vectors_enu: Floats,
        yaw_deg: Floats | float = 0.0,
        tilt_deg: Floats | float = 0.0,
        roll_deg: Floats | float = 0.0,
    ) -> Floats:
        """How far directions lie outside the planes through the camera and the sides of its image.

        Unlike image points this is smooth at any angle, also behind the camera.

        Parameters
        ----------
        As in `image_xy`.

        Returns
        -------
        array (..., k, 4)
            For right, left, top and bottom the sine of the angle from the plane, over that of half the image:
            nowhere positive inside the image, and near half images beyond a side where angles are small.
        """
        right, image_up, axis = (
            np.einsum("...ki,...i->...k", vectors_enu, direction)
            for direction in _image_axes(yaw_deg, tilt_deg, roll_deg)
        )
        tan_x, tan_y = self.half_tangents
        length = np.sqrt(np.sum(np.square(vectors_enu), axis=-1))
        sides = [
            offset / tan - axis
            for value, tan in ((right, tan_x), (image_up, tan_y))
            for offset in (value, -value)
        ]
        beyond: Floats = np.stack(sides, axis=-1) / length[..., np.newaxis]
        return beyond


class Poses(NamedTuple):
    """Poses as arrays (n,) in degrees and metres.

    ``agl_m`` is the height over the ground; longitudes are continuous along a mission. Yaw, tilt and roll are as
    in `Camera.rays_enu`: tilt 0 looks straight down. At ±90° of latitude the longitude says where "north" is.
    """

    lat_deg: Floats
    lon_deg: Floats
    agl_m: Floats
    yaw_deg: Floats
    tilt_deg: Floats
    roll_deg: Floats

    @classmethod
    def level(cls, lat_deg: Floats, lon_deg: Floats, agl_m: Floats) -> Poses:
        """North-up poses that look straight down."""
        return cls.of_attitude(lat_deg, lon_deg, agl_m, 0.0, 0.0, 0.0)

    @classmethod
    def of_attitude(
        cls, lat_deg: Floats, lon_deg: Floats, agl_m: Floats, yaw_deg: float, tilt_deg: float, roll_deg: float
    ) -> Poses:
        """Poses of one attitude; it takes no memory, however many they are."""
        attitude = (
            np.broadcast_to(np.float64(angle), np.shape(lat_deg)) for angle in (yaw_deg, tilt_deg, roll_deg)
        )
        return cls(lat_deg, lon_deg, agl_m, *attitude)

    @property
    def attitude(self) -> tuple[Floats, Floats, Floats]:
        """Yaw, tilt and roll in degrees, (n,) each."""
        return self.yaw_deg, self.tilt_deg, self.roll_deg

    def take(self, which: NDArray[Any] | slice) -> Poses:
        """Some of the poses, by index, mask or slice."""
        lat_deg = self.lat_deg[which]
        return Poses(
            lat_deg,
            *(
                values[which] if any(values.strides) else np.broadcast_to(values[:1], lat_deg.shape)
                for values in self[1:]
            ),
        )

    def runs(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Runs of neighbours that differ in longitude alone, as the captures of a row do.

        Their geometry differs by that longitude alone, too.

        Returns
        -------
        first : array (k,)
            Index of the first of each run.
        run : array (n,)
            For every pose the run it is in.
        """
        change = np.zeros(self.lat_deg.shape, bool)
        change[:1] = True
        for column in (self.lat_deg, self.agl_m, *self.attitude):
            if any(column.strides):
                change[1:] |= column[1:] != column[:-1]
        return np.flatnonzero(change), np.cumsum(change) - 1


def _half_tangent(fov_deg: float) -> float:
    """tan(fov/2), through the complement above 90° where the argument itself loses digits."""
    if fov_deg <= 90.0:
        return math.tan(math.radians(fov_deg) / 2.0)
    return 1.0 / math.tan(math.radians(180.0 - fov_deg) / 2.0)


def _fov_deg(half_tangent: float) -> float:
    """Field of view of the tangent of half of it."""
    return math.degrees(2.0 * math.atan(half_tangent))


def _check_side(side: str, fov_deg: float, aspect_ratio: float) -> None:
    if not 0.0 < fov_deg < 180.0:
        raise InvalidInput(
            "{0} field of view {1} deg: must be between 0 and 180, both excluded", side, fov_deg
        )
    _check_ratio(aspect_ratio)


def _check_ratio(aspect_ratio: float) -> None:
    if not (math.isfinite(aspect_ratio) and aspect_ratio > 0.0):
        raise InvalidInput("aspect ratio {0}: must be a number above 0 (width / height)", aspect_ratio)


def _image_axes(
    yaw_deg: Floats | float, tilt_deg: Floats | float, roll_deg: Floats | float
) -> tuple[Floats, Floats, Floats]:
    """Unit vectors (..., 3) of the image's right, of its top, and of the view, in east, north, up."""
    (sin_yaw, cos_yaw), (sin_tilt, cos_tilt), (sin_roll, cos_roll) = (
        sin_cos(np.asarray(angle, np.float64)[..., np.newaxis]) for angle in (yaw_deg, tilt_deg, roll_deg)
    )
    flat = np.zeros_like(sin_yaw)
    heading = np.concatenate([sin_yaw, cos_yaw, flat], axis=-1)
    level_right = np.concatenate([cos_yaw, -sin_yaw, flat], axis=-1)
    zenith = np.array([0.0, 0.0, 1.0])
    image_up = cos_tilt * heading + sin_tilt * zenith
    pitched = sin_tilt * heading - cos_tilt * zenith
    right = cos_roll * level_right + sin_roll * pitched
    axis = cos_roll * pitched - sin_roll * level_right
    return right, image_up, axis
