"""Ground seen by the exact camera: corners, and the outline, also where the horizon cuts it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Flags, Floats, NDArray
from ..errors import InvalidInput
from .camera import CORNERS, Camera, Poses
from .ellipsoid import (
    WGS84,
    Ellipsoid,
    above_tangent_plane_m,
    clearance,
    limb,
    limb_azimuth,
    sight_lines,
    trace,
)

#: Poses whose corners are computed at a time, to bound memory.
_BATCH = 1 << 14
#: Points along each arc of the horizon.
_ARC_POINTS = 73
#: Image points as in `CORNERS`.
ImagePoints = tuple[tuple[float, float], ...]


class Corners(NamedTuple):
    """Ground points at the corners of images, in the order of `CORNERS`; arrays (n, 4), degrees.

    Longitudes are continuous with the camera's. Where ``hit`` is False the ray misses the Earth, and the point lies on
    the horizon below it.
    """

    lat_deg: Floats
    lon_deg: Floats
    hit: NDArray[np.bool_]


def exact(camera: Camera, poses: Poses, points: ImagePoints, ground: Ellipsoid = WGS84) -> Corners:
    """Ground points at image points of the exact camera, (n, k); on the horizon where a ray misses the Earth."""
    lat, agl = poses.lat_deg[:, np.newaxis], poses.agl_m[:, np.newaxis]
    rays = camera.rays_enu(points, *poses.attitude)
    seen = trace(lat, agl, rays, ground)
    if not seen.hit.all():
        missed = ~seen.hit
        towards = rays[missed]
        # A vertical ray has no azimuth beyond rounding.
        vertical = np.hypot(towards[:, 0], towards[:, 1]) <= 1e-15 * np.abs(towards[:, 2])
        towards[vertical] = (0.0, 1.0, 0.0)
        at = np.nonzero(missed)[0]
        edge = limb(poses.lat_deg[at], poses.agl_m[at], towards, ground)
        seen.lat_deg[missed], seen.dlon_deg[missed] = edge.lat_deg, edge.dlon_deg
    return Corners(seen.lat_deg, poses.lon_deg[:, np.newaxis] + seen.dlon_deg, seen.hit)


#: Function that computes the ground points seen at image points.
Footprint = Callable[[Camera, Poses, ImagePoints, Ellipsoid], Corners]


def ground_corners(camera: Camera, poses: Poses, ground: Ellipsoid = WGS84, footprint: Footprint = exact) -> Corners:
    """Ground corners of each pose's image, computed once per run of poses that differ only in longitude.

    ``footprint`` is `exact` except when methods are compared.
    """
    first, run = poses.runs()
    shape = len(first), len(CORNERS)
    lat, dlon, hit = np.empty(shape), np.empty(shape), np.empty(shape, bool)
    for start in range(0, len(first), _BATCH):
        some = first[start : start + _BATCH]
        at_zero = poses.take(some)._replace(lon_deg=np.zeros(len(some)))
        part = slice(start, start + len(some))
        lat[part], dlon[part], hit[part] = footprint(camera, at_zero, CORNERS, ground)
    if len(first) < len(run):
        lat, dlon, hit = lat[run], dlon[run], hit[run]
    dlon += poses.lon_deg[:, np.newaxis]
    return Corners(lat, dlon, hit)


def image_centres(camera: Camera, poses: Poses, ground: Ellipsoid = WGS84) -> tuple[Floats, Floats]:
    """Ground points on the optical axes of exact cameras, (n,) each.

    Where the axis misses the Earth: the ground point at the middle of the part of the image that shows ground.

    Returns
    -------
    lat_deg, lon_deg : array (n,)
        Longitudes are continuous with the cameras'.

    Raises
    ------
    InvalidInput
        No ray of a camera meets the Earth.
    """
    first, run = poses.runs()
    each = poses.take(first)._replace(lon_deg=np.zeros(len(first)))
    seen = exact(camera, each, ((0.0, 0.0),), ground)
    lat, dlon = seen.lat_deg[:, 0], seen.lon_deg[:, 0]
    for at in np.flatnonzero(~seen.hit[:, 0]).tolist():
        one = each.take(slice(at, at + 1))
        yaw, tilt, roll = (float(angle[0]) for angle in one.attitude)
        shown = outline(camera, float(one.lat_deg[0]), float(one.agl_m[0]), (yaw, tilt, roll), ground)
        x, y = shown.image_xy.mean(axis=0).tolist()
        middle = exact(camera, one, ((x, y),), ground)
        lat[at], dlon[at] = middle.lat_deg[0, 0], middle.lon_deg[0, 0]
    return lat[run], poses.lon_deg + dlon[run]


@dataclass(frozen=True, eq=False)
class Outline:
    """Ring around the ground that a camera sees, counter-clockwise seen from above.

    Attributes
    ----------
    lat_deg, dlon_deg : array (k,)
        Vertices; the last is joined to the first. Longitudes count from the camera's and are continuous, also around a
        pole, where the last vertex is a full turn away from the first.
    horizon : array (k,) of bool
        Whether the edge from a vertex to the next one lies on the horizon.
    image_xy : array (k, 2)
        Image points of the vertices.
    pole : int
        1 or -1 if the north or south pole lies inside the ring, else 0.
    """

    lat_deg: Floats
    dlon_deg: Floats
    horizon: Flags
    image_xy: Floats
    pole: int


def poles_seen(camera: Camera, poses: Poses, ground: Ellipsoid = WGS84) -> NDArray[np.int64]:
    """1 or -1 for each pose whose image shows the north or south pole, else 0; (n,).

    A camera sees a pole only from above the ellipsoid's tangent plane at the pole.
    """
    found = np.zeros(len(poses.lat_deg), np.int64)
    for pole in (1, -1):
        at_pole = np.full((len(found), 1), 90.0 * pole)
        lat, agl = poses.lat_deg[:, np.newaxis], poses.agl_m[:, np.newaxis]
        vectors = sight_lines(lat, agl, at_pole, np.zeros_like(at_pole), ground)
        points, in_front = camera.image_xy(vectors, *poses.attitude)
        inside = in_front[:, 0] & (np.abs(points[:, 0]) <= 1.0).all(axis=-1)
        above_m = above_tangent_plane_m(lat, vectors, at_pole, np.zeros_like(at_pole))[:, 0]
        found[inside & (above_m > 0.0)] = pole
    return found


def outline(
    camera: Camera,
    lat_deg: float,
    agl_m: float,
    attitude: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ground: Ellipsoid = WGS84,
) -> Outline:
    """Outline of the ground that one camera sees.

    The part of an ideal image that shows the Earth is convex (a rectangle cut by a cone), so vertices are sorted by
    their angle about a point inside. In an image that is distorted, they follow its border and the horizon in turn.

    Parameters
    ----------
    attitude : tuple
        Yaw, tilt, roll in degrees.

    Raises
    ------
    InvalidInput
        No ray of the image meets the Earth.
    """
    view = _View(camera, lat_deg, agl_m, attitude, ground)
    edge = view.frame_points()
    lat, dlon, hit = view.seen(edge)
    # If the whole edge shows ground, the image shows no horizon, as the part that shows the Earth is convex.
    arc = _NO_ARC if hit.all() else view.limb_points()
    points = np.concatenate([edge[hit], arc.image_xy])
    on_limb = np.concatenate([np.zeros(int(hit.sum()), bool), np.ones(len(arc.lat_deg), bool)])
    if len(points) < 3:
        raise InvalidInput(
            "camera at height {0:g} m, yaw {1:g}, tilt {2:g}, roll {3:g} deg: no ray of its image meets the Earth",
            agl_m,
            attitude[0],
            attitude[1],
            attitude[2],
            field="tilt_deg",
            remedy="tilt it down",
        )
    lat, dlon = np.concatenate([lat[hit], arc.lat_deg]), np.concatenate([dlon[hit], arc.dlon_deg])
    if camera.distorts and 0 < hit.sum() < len(hit):
        order = _walk(edge, hit, arc.image_xy.reshape(-1, _ARC_POINTS, 2))
    else:
        centre = points.mean(axis=0)
        order = np.argsort(np.arctan2(points[:, 1] - centre[1], points[:, 0] - centre[0]))
    order = order[_distinct(points[order])]
    lat, dlon, points, on_limb = lat[order], dlon[order], points[order], on_limb[order]
    steps = np.diff(dlon, append=dlon[:1])
    steps -= 360.0 * np.round(steps / 360.0)
    turns = round(float(steps.sum()) / 360.0)
    dlon = dlon[0] + np.concatenate([[0.0], np.cumsum(steps[:-1])])
    return Outline(lat, dlon, on_limb & np.roll(on_limb, -1), points, turns)


def _distinct(points: Floats) -> Flags:
    """Whether each image point differs from the one before by more than rounding."""
    gap = np.abs(points - np.roll(points, 1, axis=0)).max(axis=1)
    return np.asarray(gap > 1e-12)


@dataclass(frozen=True, eq=False)
class _Arc:
    """Points of the horizon inside the image."""

    lat_deg: Floats
    dlon_deg: Floats
    image_xy: Floats


_NO_ARC = _Arc(np.empty(0), np.empty(0), np.empty((0, 2)))


@dataclass(frozen=True)
class _View:
    """One camera over the Earth: points of its image and of the horizon."""

    camera: Camera
    lat_deg: float
    agl_m: float
    attitude: tuple[float, float, float]
    ground: Ellipsoid

    @property
    def _where(self) -> tuple[Floats, Floats]:
        """Latitude and height of the camera."""
        return np.asarray(self.lat_deg), np.asarray(self.agl_m)

    def seen(self, points: Floats) -> tuple[Floats, Floats, Flags]:
        """Latitude, difference of longitude from the camera, and whether the ray hits, of image points (k, 2)."""
        return trace(*self._where, self.camera.rays_enu(points, *self.attitude), self.ground)

    def discriminants(self, points: Floats) -> Floats:
        """Discriminant of `clearance` at image points (k, 2)."""
        return clearance(*self._where, self.camera.rays_enu(points, *self.attitude), self.ground)[0]

    def frame_points(self) -> Floats:
        """16 points along each edge of the image, corners included, (64, 2)."""
        corners = np.array(CORNERS)
        shares = np.arange(16) / 16
        start, way = corners, np.roll(corners, -1, axis=0) - corners
        points = start[:, np.newaxis] + shares[:, np.newaxis] * way[:, np.newaxis]
        return np.asarray(points.reshape(-1, 2), np.float64)

    def limb_points(self) -> _Arc:
        """Points of the horizon inside the image: where it enters and leaves, and along each arc.

        Arcs have 72 pieces, which keep a full circle within 0.1 % of its radius.
        """
        cuts = np.sort(self._crossing_azimuths())
        if len(cuts) == 0:
            cuts = np.array([0.0])
        ends = np.append(cuts[1:], cuts[0] + 2.0 * np.pi)
        middle_inside = self._on_limb((cuts + ends) / 2.0)[3]
        shares = np.linspace(0.0, 1.0, _ARC_POINTS)
        azimuths = [start + shares * (end - start) for start, end in zip(cuts[middle_inside], ends[middle_inside])]
        if not azimuths:
            return _NO_ARC
        lat, dlon, points, _ = self._on_limb(np.concatenate(azimuths))
        return _Arc(lat, dlon, np.clip(points, -1.0, 1.0))

    def _on_limb(self, azimuth: Floats) -> tuple[Floats, Floats, Floats, Flags]:
        """Horizon at azimuths (radians from north): ground points, image points, and whether they are in the image."""
        towards = np.stack([np.sin(azimuth), np.cos(azimuth), np.zeros_like(azimuth)], axis=-1)
        ground = limb(*self._where, towards, self.ground)
        vectors = sight_lines(*self._where, ground.lat_deg, ground.dlon_deg, self.ground)
        points, in_front = self.camera.image_xy(vectors, *self.attitude)
        inside = in_front & (np.abs(points) <= 1.0).all(axis=-1)
        return ground.lat_deg, ground.dlon_deg, points, inside

    def _crossing_azimuths(self) -> Floats:
        """Azimuths, radians from north, at which the horizon crosses the edges of the image."""
        if self.camera.distorts:
            return self._curved_crossings()
        corners = np.array(CORNERS)
        start, way = corners, np.roll(corners, -1, axis=0) - corners
        first, middle, last = (self.discriminants(start + share * way) for share in (0.0, 0.5, 1.0))
        square = 2.0 * (first - 2.0 * middle + last)
        slope = 4.0 * middle - 3.0 * first - last
        shares, edges = [], []
        for index in range(4):
            roots = np.roots([square[index], slope[index], first[index]])
            for root in roots[np.abs(np.imag(roots)) == 0.0].real:
                if 0.0 <= root <= 1.0:
                    shares.append(root)
                    edges.append(index)
        if not shares:
            return np.empty(0)
        points = start[edges] + np.array(shares)[:, np.newaxis] * way[edges]
        rays = self.camera.rays_enu(points, *self.attitude)
        ahead = clearance(*self._where, rays, self.ground)[1] < 0.0
        return limb_azimuth(*self._where, rays[ahead], self.ground)

    def _curved_crossings(self) -> Floats:
        """`_crossing_azimuths` of an image whose edges are curved, between its `frame_points`."""
        edge = self.frame_points()
        hit = self.seen(edge)[2]
        at = np.flatnonzero(hit != np.roll(hit, -1))
        following = (at + 1) % len(edge)
        inside, outside = (
            np.where(hit[at, np.newaxis] == is_hit, edge[at], edge[following]) for is_hit in (True, False)
        )
        for _ in range(60):
            middle = (inside + outside) / 2.0
            seen = self.seen(middle)[2][:, np.newaxis]
            inside, outside = np.where(seen, middle, inside), np.where(seen, outside, middle)
        return limb_azimuth(*self._where, self.camera.rays_enu(inside, *self.attitude), self.ground)


def _walk(edge: Floats, hit: Flags, arcs: Floats) -> NDArray[np.intp]:
    """Order of the points of an outline, counter-clockwise, along the border of the image and the horizon in turn.

    Parts of the ground that the horizon separates are joined by a way to and fro.

    Parameters
    ----------
    edge : array (n, 2)
        Image points along the border.
    hit : array (n,) of bool
        Which of them show ground; these are the first points of the outline.
    arcs : array (k, points, 2)
        Image points along the horizon, by azimuth, which are its other points.
    """

    def turn(points: Floats) -> Floats:
        return np.arctan2(points[..., 1], points[..., 0])

    def nearest(ahead: Floats, here: Floats) -> NDArray[np.intp]:
        """Which of some places along the border is next after each of others."""
        found: NDArray[np.intp] = np.argmin(np.mod(ahead - here[:, np.newaxis], 2.0 * np.pi), axis=1)
        return found

    number, around = np.cumsum(hit) - 1, np.argsort(turn(edge))
    around = np.roll(around, -int(np.flatnonzero(~hit[around])[0]))
    begins = np.flatnonzero(hit[around] & ~hit[np.roll(around, 1)])
    runs = [one[hit[one]] for one in np.split(around, begins)[1:]]
    of_arc = [int(hit.sum()) + index * arcs.shape[1] + np.arange(arcs.shape[1]) for index in range(len(arcs))]
    first, last = (turn(edge[[run[at] for run in runs]]) for at in (0, -1))
    # With the ground on the left, the horizon runs against the azimuths.
    arc_after = nearest(turn(arcs[:, -1]), last) if len(arcs) else None
    run_after = nearest(first, turn(arcs[:, 0]))
    order: list[NDArray[np.intp]] = []
    left = list(range(len(runs)))
    while left:
        begin = len(order)
        run = left[0]
        while run in left:
            left.remove(run)
            order.append(number[runs[run]])
            if arc_after is not None:
                order.append(of_arc[arc_after[run]][::-1])
                run = int(run_after[arc_after[run]])
        if begin or left:
            order.append(order[begin][:1])
    return np.concatenate(order)
