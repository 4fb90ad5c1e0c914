"""Rectangles along the axes of a plane that lie wholly inside what cameras see: what turned rows count on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .camera import Camera
from .ellipsoid import WGS84, Ellipsoid, sight_lines
from .footprint import exact
from .plane import NOISE_M, LocalPlane
from .poses import Poses
from .rings import (
    border_points,
    common_half_sizes,
    half_sizes,
    image_frame,
    largest_share,
    reach,
    sag,
    unit_border,
)

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Halvings that find how much smaller a rectangle has to be that its image shows it.
_HALVINGS = 40
#: Half images by which a rectangle may leave its image and still be inside it: the noise of ground positions in the
#: smallest images there are.
_NOISE = 1e-9
#: Poses worked on in one go, to bound memory.
_BATCH = 1024


class Sides(NamedTuple):
    """Sides of rectangles in metres of a plane, (n,)."""

    left_m: Floats
    bottom_m: Floats
    right_m: Floats
    top_m: Floats

    @property
    def size_m(self) -> tuple[Floats, Floats]:
        """Width and height, (n,) each."""
        return self.right_m - self.left_m, self.top_m - self.bottom_m


def image_rings(
    camera: Camera, poses: Poses, plane: LocalPlane, ground: Ellipsoid = WGS84
) -> tuple[Floats, Floats, Flags]:
    """Where images lie in a plane, from the place of the camera: their frames (n, k, 2) and their centres (n, 2).

    Returns
    -------
    rings, centres
    whole : array (n,) of bool
        Whether all of the image sees ground.
    """
    frame = image_frame()
    seen = exact(camera, poses, ((0.0, 0.0), *((x, y) for x, y in frame.tolist())), ground)
    place = np.stack(plane.forward(poses.lat_deg, poses.lon_deg), axis=-1)
    points = np.stack(plane.forward(seen.lat_deg, seen.lon_deg), axis=-1) - place[:, np.newaxis]
    return points[:, 1:], points[:, 0], seen.hit.all(axis=1)


def common_sides(camera: Camera, poses: Poses, plane: LocalPlane, ground: Ellipsoid = WGS84) -> Sides:
    """Sides of one rectangle, from the place of the camera, that the images of all poses show whole.

    Parameters
    ----------
    poses : Poses
        (n,); all of their images see ground in all their parts.

    Returns
    -------
    Sides
        (1,); of no extent where nothing is common to the images.
    """
    rings, centres, _ = image_rings(camera, poses, plane, ground)
    centre = centres.mean(axis=0)
    half = np.array(common_half_sizes(rings - centre))
    half = np.maximum(half - float(sag(rings).max()) - NOISE_M, 0.0)

    def fits(share: Floats) -> Flags:
        tried = np.broadcast_to(centre, centres.shape), share[0] * np.broadcast_to(half, centres.shape)
        return np.array([bool(_shown(camera, poses, plane, ground, *tried).all())])

    whole = np.ones(1)
    share = 1.0 if fits(whole)[0] else float(largest_share(fits, 1, _HALVINGS)[0])
    left_bottom, right_top = centre - half * share, centre + half * share
    return Sides(*left_bottom[:, np.newaxis], *right_top[:, np.newaxis])


def own_sides(camera: Camera, poses: Poses, plane: LocalPlane, ground: Ellipsoid = WGS84) -> Sides:
    """Sides of the rectangle inside each image, in the plane, (n,): as large as the image's centre allows.

    Of no extent where an image does not see ground in all its parts.
    """
    count = len(poses.lat_deg)
    if count > _BATCH:
        parts = [
            own_sides(camera, Poses(*(p[i : i + _BATCH] for p in poses)), plane, ground)
            for i in range(0, count, _BATCH)
        ]
        return Sides(*(np.concatenate(sides) for sides in zip(*parts)))
    rings, centres, whole = image_rings(camera, poses, plane, ground)
    half = np.stack(half_sizes(rings - centres[:, np.newaxis]), axis=-1) - NOISE_M - sag(rings)[:, np.newaxis]
    half = np.where(whole[:, np.newaxis], np.maximum(half, 0.0), 0.0)

    def fits(share: Floats) -> Flags:
        return _shown(camera, poses, plane, ground, centres, share[:, np.newaxis] * half)

    every = np.ones(count)
    fitting = fits(every)
    share = every if fitting.all() else np.where(fitting, 1.0, largest_share(fits, count, _HALVINGS))
    across, up = (share[:, np.newaxis] * half).T
    x, y = (centre + place for centre, place in zip(centres.T, plane.forward(poses.lat_deg, poses.lon_deg)))
    return Sides(x - across, y - up, x + across, y + up)


def _shown(
    camera: Camera, poses: Poses, plane: LocalPlane, ground: Ellipsoid, centre: Floats, half: Floats
) -> Flags:
    """Whether images show the whole borders, and so all, of rectangles about centres (n, 2), from the camera's place.

    What a camera sees is convex in its image, and less than half of the Earth.
    """
    points = border_points(camera)
    across, up = (2.0 * share - 1.0 for share in unit_border(points))
    place = plane.forward(poses.lat_deg, poses.lon_deg)
    x, y = (
        np.asarray((at + middle)[:, np.newaxis, np.newaxis] + size[:, np.newaxis, np.newaxis] * share)
        for at, middle, size, share in zip(place, centre.T, half.T, (across, up))
    )
    lat, lon = plane.inverse(x, y)
    camera_lat, camera_lon, agl = (
        values[:, np.newaxis, np.newaxis] for values in (poses.lat_deg, poses.lon_deg, poses.agl_m)
    )
    vectors = sight_lines(camera_lat, agl, lat, lon - camera_lon, ground)
    sides = camera.beyond_sides(vectors.reshape(len(lat), -1, 3), *poses.attitude)
    inside: Flags = reach(sides.reshape(len(lat), 4, points, 4)).max(axis=1) <= _NOISE
    return inside
