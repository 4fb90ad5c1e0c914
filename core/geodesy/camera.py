"""Rays and image points of cameras, and poses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from .ellipsoid import arctan2, sin_cos
from .lens import Lens

#: Image coordinates (right, up), each -1..1, of a north-up camera's corners north-west, north-east, south-east,
#: south-west.
CORNERS = ((-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0))
#: Image coordinates of the midpoints of its edges north, east, south, west.
EDGE_MIDPOINTS = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))


@dataclass(frozen=True)
class Camera(Lens):
    """An ideal pinhole camera with square pixels; see `Lens`."""

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
        right, image_up, axis = image_axes(yaw_deg, tilt_deg, roll_deg)
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
            Right and up, -1..1 inside the image; finite but meaningless for points behind the camera.
        in_front : array (..., k) of bool
        """
        right, image_up, axis = (
            np.einsum("...ki,...i->...k", vectors_enu, direction)
            for direction in image_axes(yaw_deg, tilt_deg, roll_deg)
        )
        in_front = axis > 0.0
        depth = np.where(in_front, axis, 1.0)
        tan_x, tan_y = self.half_tangents
        return np.stack([right / depth / tan_x, image_up / depth / tan_y], axis=-1), in_front

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
        """
        right, image_up, axis = (
            np.einsum("...ki,...i->...k", vectors_enu, direction)
            for direction in image_axes(yaw_deg, tilt_deg, roll_deg)
        )
        tan_x, tan_y = self.half_tangents
        length = np.sqrt(np.sum(np.square(vectors_enu), axis=-1))
        sides = [
            offset / tan - axis for value, tan in ((right, tan_x), (image_up, tan_y)) for offset in (value, -value)
        ]
        beyond: Floats = np.stack(sides, axis=-1) / length[..., np.newaxis]
        return beyond


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
