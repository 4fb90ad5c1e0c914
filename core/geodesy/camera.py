"""Rays and image points of cameras, and poses."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput
from .distortion import BrownConrady, FisheyeLens, PerspectiveLens
from .ellipsoid import arctan2, sin_cos
from .lens import COEFFICIENTS, FISHEYE, PERSPECTIVE, Lens

#: Image coordinates (right, up), each -1..1, of a north-up camera's corners north-west, north-east, south-east,
#: south-west.
CORNERS = ((-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0))
#: Image coordinates of the midpoints of its edges north, east, south, west.
EDGE_MIDPOINTS = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))


@dataclass(frozen=True)
class Camera(Lens):
    """A camera with square pixels; see `Lens`.

    Directions are linear in points of the *ideal image*, that of a pinhole camera with the same focal length and a
    centred axis. A camera that `distorts` has other points in its own image.
    """

    def __post_init__(self) -> None:
        """Check every field, and that the distortion does not fold the image."""
        super().__post_init__()
        if self.distorts:
            for name in COEFFICIENTS[PERSPECTIVE]:
                if name not in COEFFICIENTS[self.lens] and getattr(self, name) != 0.0:
                    raise InvalidInput("{0} {1:g}: a fisheye has k1 to k4 only", name, getattr(self, name), field=name)
            _ = self._distortion

    @cached_property
    def _distortion(self) -> PerspectiveLens | FisheyeLens:
        """Distortion in focal lengths about the principal point."""
        k = (self.k1, self.k2, self.k3, self.k4, self.k5, self.k6)
        return _fitted(self.lens, k, self.p1, self.p2, self.half_tangents, (self.principal_x, self.principal_y))

    def ideal_xy(self, image_xy: Floats) -> Floats:
        """Points of the ideal image that image points show (..., 2), both right and up in half images.

        The image itself unless the camera `distorts`.
        """
        if not self.distorts:
            return image_xy
        return self._flipped(*self._distortion.ideal(*self._seen_focal(image_xy)))

    def seen_xy(self, ideal_xy: Floats) -> Floats:
        """Image points of points of the ideal image (..., 2); the inverse of `ideal_xy`.

        Far outside the image the distortion goes on with the slope that it has there, so that what is outside the image
        appears outside.
        """
        if not self.distorts:
            return ideal_xy
        tan_x, tan_y = self.half_tangents
        x, y = self._distortion.seen(ideal_xy[..., 0] * tan_x, ideal_xy[..., 1] * -tan_y)
        return self._flipped(x, y) + self._axis_xy

    def seen_slopes(self, ideal_xy: Floats) -> Floats:
        """Derivatives (..., 2, 2) of image points by points of the ideal image, both in half images."""
        tan_x, tan_y = self.half_tangents
        if not self.distorts:
            return np.broadcast_to(np.eye(2), (*ideal_xy.shape[:-1], 2, 2))
        xx, xy, yx, yy = self._distortion.slopes(ideal_xy[..., 0] * tan_x, ideal_xy[..., 1] * -tan_y)
        ratio = tan_y / tan_x
        return np.stack([np.stack([xx, -xy * ratio], axis=-1), np.stack([-yx / ratio, yy], axis=-1)], axis=-2)

    @property
    def _axis_xy(self) -> Floats:
        """Image point of the optical axis."""
        return np.array([2.0 * self.principal_x, -2.0 * self.principal_y])

    def _seen_focal(self, image_xy: Floats) -> tuple[Floats, Floats]:
        """Image points in focal lengths from the principal point, right and down."""
        return _in_focal_lengths(np.asarray(image_xy, np.float64) - self._axis_xy, self.half_tangents)

    def _flipped(self, x: Floats, y: Floats) -> Floats:
        """Points in half images, right and up, from focal lengths right and down."""
        tan_x, tan_y = self.half_tangents
        return np.stack([x / tan_x, y / -tan_y], axis=-1)

    def of_colour(self, colour: str) -> Camera:
        """Camera of one colour: ``red``, ``green`` or ``blue``."""
        if not self.splits_colours:
            return self
        scale = {"red": self.red_scale, "green": 0.0, "blue": self.blue_scale}[colour]
        plain = replace(self, red_scale=0.0, blue_scale=0.0)
        return plain.enlarged(1.0 + scale) if scale else plain

    @cached_property
    def extremes(self) -> Extremes:
        """Image points where rays and the scale of the image may be extreme: the corners of an ideal camera."""
        return _extremes(self) if self.distorts else _IDEAL_EXTREMES

    def rays_enu(
        self,
        image_xy: Floats | tuple[tuple[float, float], ...],
        yaw_deg: Floats | float = 0.0,
        tilt_deg: Floats | float = 0.0,
        roll_deg: Floats | float = 0.0,
    ) -> Floats:
        """Directions of image points, in the camera's east, north, up.

        Yaw turns the top of the image clockwise from north; then tilt raises the view from straight down towards the
        top of the image; then roll turns the camera about the direction of the image's top, right side down. These
        are the yaw, pitch and roll (z-y'-x'') of an aircraft whose camera looks down.

        Parameters
        ----------
        image_xy : array (k, 2), or (..., k, 2) for different points in each pose
            Right and up, each -1..1 from edge to edge of the image.
        yaw_deg, tilt_deg, roll_deg : array (...) or float
            Attitude of each pose, broadcast against each other.

        Returns
        -------
        array (..., k, 3)
            Not normalised: the part along the optical axis is 1.
        """
        return self.ideal_rays_enu(self.ideal_xy(np.asarray(image_xy, np.float64)), yaw_deg, tilt_deg, roll_deg)

    def ideal_rays_enu(
        self, ideal_xy: Floats, yaw_deg: Floats | float, tilt_deg: Floats | float, roll_deg: Floats | float
    ) -> Floats:
        """Directions of points of the ideal image; otherwise as `rays_enu`."""
        right, image_up, axis = image_axes(yaw_deg, tilt_deg, roll_deg)
        tan_x, tan_y = self.half_tangents
        rays: Floats = (
            axis[..., np.newaxis, :]
            + (ideal_xy[..., :1] * tan_x) * right[..., np.newaxis, :]
            + (ideal_xy[..., 1:] * tan_y) * image_up[..., np.newaxis, :]
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
            Right and up, -1..1 inside the image; finite but meaningless for points behind the camera.
        in_front : array (..., k) of bool
        """
        right, image_up, axis = _along_axes(vectors_enu, yaw_deg, tilt_deg, roll_deg)
        in_front = axis > 0.0
        depth = np.where(in_front, axis, 1.0)
        tan_x, tan_y = self.half_tangents
        return self.seen_xy(np.stack([right / depth / tan_x, image_up / depth / tan_y], axis=-1)), in_front

    def side_excess(
        self,
        vectors_enu: Floats,
        yaw_deg: Floats | float = 0.0,
        tilt_deg: Floats | float = 0.0,
        roll_deg: Floats | float = 0.0,
    ) -> Floats:
        """Signed offsets of directions from the planes through the camera and the sides of its image.

        Unlike image points, these offsets are smooth at any angle, also behind the camera.

        Parameters
        ----------
        As in `image_xy`.

        Returns
        -------
        array (..., k, 4)
            For right, left, top and bottom: sine of the angle to the plane, divided by the sine of half the field of
            view. Not positive inside the image; at small angles outside, about the distance to the side in half images.
            Sides of an image that is distorted are curved; the offsets have the same sign and slope there.
        """
        right, image_up, axis = _along_axes(vectors_enu, yaw_deg, tilt_deg, roll_deg)
        tan_x, tan_y = self.half_tangents
        length = np.sqrt(np.sum(np.square(vectors_enu), axis=-1))
        if self.distorts:
            return self._curved_excess(right / length, image_up / length, axis / length)
        sides = [
            offset / tan - axis for value, tan in ((right, tan_x), (image_up, tan_y)) for offset in (value, -value)
        ]
        beyond: Floats = np.stack(sides, axis=-1) / length[..., np.newaxis]
        return beyond

    def _curved_excess(self, right: Floats, image_up: Floats, axis: Floats) -> Floats:
        """`side_excess` of unit vectors' parts, for a camera that distorts."""
        lens = self._distortion
        ahead = axis if isinstance(lens, PerspectiveLens) else np.ones_like(axis)
        x, y = lens.seen_vectors(right, -image_up, axis)
        at = self._flipped(x, y) + self._axis_xy * ahead[..., np.newaxis]
        sides = [offset - ahead for value in (at[..., 0], at[..., 1]) for offset in (value, -value)]
        return np.stack(sides, axis=-1)


class Extremes(NamedTuple):
    """Points of an image by which bounds are found.

    Attributes
    ----------
    image_xy, ideal_xy : array (n, 2)
        The points, and those of the ideal image that they show.
    least_scale, greatest_scale : array (n,)
        Least and greatest pixels of the image for one of the ideal image there, in any direction.
    tangent : float
        Greatest tangent of the angle between a ray and the optical axis.
    """

    image_xy: Floats
    ideal_xy: Floats
    least_scale: Floats
    greatest_scale: Floats
    tangent: float


_IDEAL_EXTREMES = Extremes(np.array(CORNERS), np.array(CORNERS), np.ones(len(CORNERS)), np.ones(len(CORNERS)), math.nan)


def _border(points: int) -> Floats:
    """Points along each side of an image, (4·points, 2), from the upper left corner to the right."""
    corners, shares = np.array(CORNERS), np.linspace(0.0, 1.0, points, endpoint=False)[:, np.newaxis]
    sides = [start + shares * (end - start) for start, end in zip(corners, np.roll(corners, -1, axis=0))]
    return np.concatenate(sides)


def _extremes(camera: Camera) -> Extremes:
    inner = np.stack(np.meshgrid(*[np.linspace(-0.5, 0.5, 3)] * 2), axis=-1).reshape(-1, 2)
    points = np.concatenate([_border(8), inner])
    ideal = camera.ideal_xy(points)
    # Pixels are square.
    slopes = camera.seen_slopes(ideal) * np.array([[1.0, camera.aspect_ratio], [1.0 / camera.aspect_ratio, 1.0]])
    scales = np.linalg.svd(slopes, compute_uv=False)
    return Extremes(points, ideal, scales[:, 1], scales[:, 0], float(np.hypot(*(ideal * camera.half_tangents).T).max()))


def _in_focal_lengths(image_xy: Floats, half_tangents: tuple[float, float]) -> tuple[Floats, Floats]:
    return image_xy[..., 0] * half_tangents[0], image_xy[..., 1] * -half_tangents[1]


@lru_cache(maxsize=256)
def _fitted(
    lens: str,
    k: tuple[float, ...],
    p1: float,
    p2: float,
    half_tangents: tuple[float, float],
    principal: tuple[float, float],
) -> PerspectiveLens | FisheyeLens:
    """Distortion of a camera; raises InvalidInput if it folds the image."""
    axis = np.array([2.0 * principal[0], -2.0 * principal[1]])
    border = np.stack(_in_focal_lengths(_border(16) - axis, half_tangents), axis=-1)
    if lens == FISHEYE:
        return FisheyeLens.fitted(k[:4], border)
    return PerspectiveLens.fitted(BrownConrady(k, p1, p2), border)


def _along_axes(
    vectors_enu: Floats, yaw_deg: Floats | float, tilt_deg: Floats | float, roll_deg: Floats | float
) -> tuple[Floats, Floats, Floats]:
    """Parts of vectors (..., k, 3) to the image's right and top, and along the view, (..., k) each."""
    right, image_up, axis = (
        np.einsum("...ki,...i->...k", vectors_enu, direction) for direction in image_axes(yaw_deg, tilt_deg, roll_deg)
    )
    return right, image_up, axis


class Poses(NamedTuple):
    """Poses as arrays (n,) in degrees and metres.

    ``agl_m`` is the height over the ground; longitudes are continuous along a mission. Yaw, tilt and roll are as
    in `Camera.rays_enu`: tilt 0 looks straight down. At ±90° of latitude the longitude defines "north".
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
        return cls.from_attitude(lat_deg, lon_deg, agl_m, 0.0, 0.0, 0.0)

    @classmethod
    def from_attitude(
        cls, lat_deg: Floats, lon_deg: Floats, agl_m: Floats, yaw_deg: float, tilt_deg: float, roll_deg: float
    ) -> Poses:
        """Poses that share one attitude, which is stored once."""
        attitude = (np.broadcast_to(np.float64(angle), np.shape(lat_deg)) for angle in (yaw_deg, tilt_deg, roll_deg))
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
        """Runs of consecutive poses that differ only in longitude, as the captures of a row do.

        Returns
        -------
        first : array (k,)
            Index of the first pose of each run.
        run : array (n,)
            Number of the run of each pose.
        """
        change = np.zeros(self.lat_deg.shape, bool)
        change[:1] = True
        for column in (self.lat_deg, self.agl_m, *self.attitude):
            if any(column.strides):
                change[1:] |= column[1:] != column[:-1]
        return np.flatnonzero(change), np.cumsum(change) - 1


def image_axes(
    yaw_deg: Floats | float, tilt_deg: Floats | float, roll_deg: Floats | float
) -> tuple[Floats, Floats, Floats]:
    """Unit vectors (..., 3) to the image's right and top, and along the view, in east, north, up; see `rays_enu`."""
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


def attitude_from_axes(right: Floats, image_up: Floats, axis: Floats) -> tuple[Floats, Floats, Floats]:
    """Yaw in [-180, 180], tilt in [-90, 90] and roll in degrees of a camera's axes (..., 3); inverse of `image_axes`.

    Where the top of the image points up or down, yaw and roll turn about one axis, and their split is arbitrary.
    """
    yaw = np.degrees(arctan2(image_up[..., 0], image_up[..., 1]))
    tilt = np.degrees(np.arcsin(np.clip(image_up[..., 2], -1.0, 1.0)))
    roll = np.degrees(np.arctan2(-right[..., 2], -axis[..., 2]))
    return yaw, tilt, roll
