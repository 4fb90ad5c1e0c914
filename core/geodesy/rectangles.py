"""Rectangles inside the ground seen by cameras, on which coverage of an area is based."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, Union

import numpy as np

from ..arrays import Flags, Floats
from .camera import Camera, Poses
from .ellipsoid import WGS84, Ellipsoid, above_tangent_plane_m, sight_lines
from .footprint import Corners, exact, image_centres
from .frames import FrameEdges
from .mercator import MERCATOR, Plane, lat_to_v, lon_to_u, u_to_lon, v_to_lat
from .planes import ProjectedPlane, TurnedPlane
from .projections import NOISE_M, LocalPlane

#: Plane in metres of rows of captures.
RowsPlane = Union[LocalPlane, TurnedPlane]
#: Margin for rounding an edge to the grid, which moves it outward by up to half a pixel, and for rounding positions.
_MARGIN_PX = 0.5 + 1e-3
#: Halvings to find the largest rectangle that fits, to about float64 precision.
_HALVINGS = 40
#: Widest rectangle, as a world fraction: a camera sees less than half of the Earth.
_WIDEST = 0.5
#: Poses processed at a time: few enough for the caches of a processor.
_BATCH = 512
#: Points along each edge of the image.
_EDGE_POINTS = 12
#: Largest factor by which the ratios of height to width that are tried differ from that of the ground seen.
_RATIO_REACH = 16.0


def inscribed_edges(
    camera: Camera, poses: Poses, ground: Ellipsoid = WGS84, pixel: float = 0.0, plane: Plane = MERCATOR
) -> FrameEdges:
    """Largest rectangles inside the ground seen by cameras, about the centres of the images.

    The centre is the ground point at the image's centre or, if the image's centre shows no ground, at the middle of the
    part that does.

    Parameters
    ----------
    poses : Poses
        (n,), of any attitude.
    pixel : float
        Size of a source pixel as a world fraction; rectangles leave a margin for rounding their edges.

    Returns
    -------
    FrameEdges
        Empty if no part of the map lies inside.

    Raises
    ------
    InvalidInput
        No ray of a camera meets the Earth.
    """
    if isinstance(plane, ProjectedPlane):
        return _edges_in_plane(plane, camera, poses, ground, pixel)
    if len(poses.lat_deg) > _BATCH:
        starts = range(0, len(poses.lat_deg), _BATCH)
        parts = [inscribed_edges(camera, Poses(*(p[i : i + _BATCH] for p in poses)), ground, pixel) for i in starts]
        return FrameEdges(*(np.concatenate(columns) for columns in zip(*parts)))
    at_zero = poses._replace(lon_deg=np.zeros(len(poses.lat_deg)))
    seen = exact(camera, at_zero, tuple((x, y) for x, y in _image_frame().tolist()), ground)
    ring = _map_positions(seen)
    whole = seen.hit.all(axis=1)
    # Longitudes more than a quarter turn from a level camera's lie beyond a pole.
    level = whole & (np.abs(seen.lon_deg) < 90.0).all(axis=1)
    for angle in poses.attitude:
        level &= angle == 0.0
    # A ring that the horizon cuts is not a polygon, nor is a ring around a pole, whose ends are half a world apart.
    polygon = whole & (np.abs(ring[:, -1, 0] - ring[:, 0, 0]) < 0.5)
    edges, centre = _centred_edges(camera, at_zero, ring, polygon & ~level, ~polygon & ~level, ground)
    for side, straight in zip(edges, _level_edges(ring)):
        side[level] = straight[level]
    centre[level, 0] = 0.0
    centre[level, 1] = (edges.top_v + edges.bottom_v)[level] / 2.0
    inside = _narrowed(edges, np.where(polygon | level, _sag(ring), 0.0))
    # Images of level cameras smaller than a twentieth of the world are nearly rectangles on the map.
    tested = np.flatnonzero(~level | (np.ptp(ring[..., 0], axis=1) > 0.05) | camera.distorts)
    if len(tested):
        some = FrameEdges(*(side[tested] for side in inside))
        for side, shown in zip(inside, _shown(camera, at_zero.take(tested), some, centre[tested], ground)):
            side[tested] = shown
    return _narrowed(inside, _MARGIN_PX * pixel)


def _centred_edges(
    camera: Camera, poses: Poses, ring: Floats, polygon: Flags, cut: Flags, ground: Ellipsoid
) -> tuple[FrameEdges, Floats]:
    """Edges and centres (n, 2) of rectangles inside rings that are polygons or cut by the horizon; 0 for others."""
    count = len(ring)
    centre, half_u, half_v = np.zeros((count, 2)), np.zeros(count), np.zeros(count)
    if polygon.any():
        centre[polygon] = _centres(camera, poses.take(polygon), ground)
        half_u[polygon], half_v[polygon] = _half_sizes(ring[polygon] - centre[polygon, np.newaxis], camera.distorts)
    if cut.any():
        centre[cut] = _centres(camera, poses.take(cut), ground)
        half_u[cut], half_v[cut] = _searched(camera, poses.take(cut), ring[cut], centre[cut], ground)
    half_u = np.minimum(half_u, _WIDEST / 2.0)
    u, v = centre.T
    return FrameEdges(u - half_u, u + half_u, v - half_v, v + half_v), centre


def _narrowed(edges: FrameEdges, room: Floats | float) -> FrameEdges:
    """Move edges inward; opposite edges that would cross meet in the middle."""
    across, down = (np.minimum(room, size / 2.0) for size in edges.size)
    west, east, top, bottom = edges
    return FrameEdges(west + across, east - across, top + down, bottom - down)


def _shown(camera: Camera, poses: Poses, edges: FrameEdges, centre: Floats, ground: Ellipsoid) -> FrameEdges:
    """Shrink rectangles about their centres (n, 2) until images show them whole.

    The part of the Earth in an image is convex and less than half of it, so a rectangle is visible if its border is.
    """
    beyond = _border_excess(camera, poses, edges, ground)
    at = np.flatnonzero(beyond > 0.0)
    if len(at) == 0:
        return edges
    rounding = 2.0**-51  # of a position on the map, in world fractions
    reaching = FrameEdges(*(side[at] for side in edges))
    moved = _border_excess(camera, poses.take(at), reaching, ground, rounding)
    finite = np.isfinite(beyond[at]) & np.isfinite(moved)
    noise = np.abs(np.where(finite, moved, 0.0) - np.where(finite, beyond[at], 0.0))
    is_beyond = beyond[at] > noise
    at, limit = at[is_beyond], noise[is_beyond]
    if len(at) == 0:
        return edges
    some, (u, v) = poses.take(at), centre[at].T
    reach = [side[at] - middle for side, middle in zip(edges, (u, u, v, v))]

    def scaled(share: Floats) -> FrameEdges:
        return FrameEdges(*(middle + share * way for way, middle in zip(reach, (u, u, v, v))))

    # For a small excess, in half images, one step is enough; others need halving.
    inside = np.where(beyond[at] < 1e-2, 1.0 - 2.0 * beyond[at], 0.0)
    little = (inside > 0.0) & (_border_excess(camera, some, scaled(inside), ground) <= limit)
    if not little.all():
        halved = _largest_share(
            lambda share: np.asarray(_border_excess(camera, some, scaled(share), ground) <= limit),
            len(at),
            _HALVINGS,
        )
        inside = np.where(little, inside, halved)
    for side, smaller in zip(edges, scaled(inside)):
        side[at] = smaller
    return edges


def _border_excess(
    camera: Camera,
    poses: Poses,
    edges: FrameEdges,
    ground: Ellipsoid,
    moved: float = 0.0,
    points: int | None = None,
) -> Floats:
    """Excess of the borders of rectangles over their images, (n,) in half images; infinite where the Earth hides them.

    ``moved`` shifts the rectangles by a world fraction; ``points`` is the number of points tested along each side.
    """
    points = _border_points(camera) if points is None else points
    across, down = _unit_border(points)
    west, _, top, _ = (side[:, np.newaxis, np.newaxis] for side in edges)
    width, height = (size[:, np.newaxis, np.newaxis] for size in edges.size)
    # Longitudes count from the camera's meridian, whose world fraction is 1/2.
    dlon = u_to_lon(west + width * across + moved + 0.5)
    lat = v_to_lat(top + height * down + moved)
    camera_lat, agl = (values[:, np.newaxis, np.newaxis] for values in (poses.lat_deg, poses.agl_m))
    vectors = sight_lines(camera_lat, agl, lat, dlon, ground)
    sides = camera.side_excess(vectors.reshape(len(west), -1, 3), *poses.attitude)
    below_m = -above_tangent_plane_m(camera_lat, vectors, lat, dlon)
    hidden = _reach(below_m[..., np.newaxis]) >= 0.0
    beyond: Floats = np.where(hidden, np.inf, _reach(sides.reshape(len(west), 4, points, 4))).max(axis=1)
    return beyond


def _level_edges(ring: Floats) -> FrameEdges:
    """Edges inside the rings (n, k, 2) of level, north-up cameras, whose image edges nearly follow the map's axes."""
    north, east, south, west = (
        np.take(ring, range(start, start + _EDGE_POINTS + 1), axis=1, mode="wrap")
        for start in range(0, 4 * _EDGE_POINTS, _EDGE_POINTS)
    )
    return FrameEdges(
        west[..., 0].max(axis=1),
        east[..., 0].min(axis=1),
        north[..., 1].max(axis=1),
        south[..., 1].min(axis=1),
    )


def _map_positions(seen: Corners) -> Floats:
    """World fractions of ground points from the camera's meridian and the map's north edge, (n, k, 2).

    Consecutive points are continuous across the meridian opposite the camera. Poles, infinitely far on the map, are
    placed one world beyond its edges.
    """
    v = np.clip(lat_to_v(seen.lat_deg), -1.0, 2.0)
    return np.stack([np.unwrap(lon_to_u(seen.lon_deg) - 0.5, axis=1, period=1.0), v], axis=-1)


def _centres(camera: Camera, poses: Poses, ground: Ellipsoid) -> Floats:
    """Centres of the rectangles on the map, (n, 2)."""
    lat, lon = (angle[:, np.newaxis] for angle in image_centres(camera, poses, ground))
    return _map_positions(Corners(lat, lon, np.ones(lat.shape, bool)))[:, 0]


def _searched(camera: Camera, poses: Poses, ring: Floats, centre: Floats, ground: Ellipsoid) -> tuple[Floats, Floats]:
    """Half width and height, (n,) each, of the largest rectangles about centres, searched over ratios and sizes."""
    ratios = np.geomspace(1.0 / _RATIO_REACH, _RATIO_REACH, 7)
    every = np.repeat(np.arange(len(centre)), len(ratios))
    u, v = centre[every].T
    reach = np.minimum(np.abs(ring - centre[:, np.newaxis]).max(axis=(1, 2)), _WIDEST / 2.0)[every]
    half_v = reach * np.tile(np.minimum(ratios, 1.0), len(centre))
    half_u = reach * np.tile(np.minimum(1.0 / ratios, 1.0), len(centre))
    some = poses.take(every)

    def fits(share: Floats) -> Flags:
        across, down = share * half_u, share * half_v
        tried = FrameEdges(u - across, u + across, v - down, v + down)
        return np.asarray(_border_excess(camera, some, tried, ground, points=5) <= 0.0)

    inside = _largest_share(fits, len(every), 10)
    width, height = ((inside * half).reshape(len(centre), len(ratios)) for half in (half_u, half_v))
    best = np.argmax(width * height, axis=1)[:, np.newaxis]
    return np.take_along_axis(width, best, axis=1)[:, 0], np.take_along_axis(height, best, axis=1)[:, 0]


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
    camera: Camera, poses: Poses, plane: RowsPlane, ground: Ellipsoid = WGS84
) -> tuple[Floats, Floats, Flags]:
    """Frames (n, k, 2) and centres (n, 2) of images in a plane, relative to the camera's position.

    Returns
    -------
    rings, centres
    whole : array (n,) of bool
        Whether the whole image shows ground.
    """
    frame = _image_frame()
    seen = exact(camera, poses, ((0.0, 0.0), *((x, y) for x, y in frame.tolist())), ground)
    place = np.stack(plane.forward(poses.lat_deg, poses.lon_deg), axis=-1)
    points = np.stack(plane.forward(seen.lat_deg, seen.lon_deg), axis=-1) - place[:, np.newaxis]
    return points[:, 1:], points[:, 0], seen.hit.all(axis=1)


def common_sides(camera: Camera, poses: Poses, plane: RowsPlane, ground: Ellipsoid = WGS84) -> Sides:
    """Sides of one rectangle, relative to the camera's position, that the images of all poses show whole.

    Parameters
    ----------
    poses : Poses
        (n,), whose whole images show ground.

    Returns
    -------
    Sides
        (1,); empty if the images have no ground in common.
    """
    rings, centres, _ = image_rings(camera, poses, plane, ground)
    centre = centres.mean(axis=0)
    half = np.array(_common_half_sizes(rings - centre, camera.distorts))
    half = np.maximum(half - float(_sag(rings).max()) - NOISE_M, 0.0)

    def fits(share: Floats) -> Flags:
        tried = np.broadcast_to(centre, centres.shape), share[0] * np.broadcast_to(half, centres.shape)
        return np.array([bool(_sides_shown(camera, poses, plane, ground, *tried).all())])

    whole = np.ones(1)
    share = 1.0 if fits(whole)[0] else float(_largest_share(fits, 1, _HALVINGS)[0])
    left_bottom, right_top = centre - half * share, centre + half * share
    return Sides(*left_bottom[:, np.newaxis], *right_top[:, np.newaxis])


def image_sides(
    camera: Camera,
    poses: Poses,
    plane: RowsPlane,
    ground: Ellipsoid = WGS84,
    most_m: tuple[float, float] = (math.inf, math.inf),
) -> Sides:
    """Sides of the largest rectangle inside each image about its centre, in the plane, (n,).

    With ``most_m``, a width and height, rectangles have its proportions, and are at most as large. Empty if part of an
    image shows no ground.
    """
    count = len(poses.lat_deg)
    if count > _BATCH:
        parts = [
            image_sides(camera, Poses(*(p[i : i + _BATCH] for p in poses)), plane, ground, most_m)
            for i in range(0, count, _BATCH)
        ]
        return Sides(*(np.concatenate(sides) for sides in zip(*parts)))
    rings, centres, whole = image_rings(camera, poses, plane, ground)
    half = (
        np.stack(_half_sizes(rings - centres[:, np.newaxis], camera.distorts), axis=-1)
        - NOISE_M
        - _sag(rings)[:, np.newaxis]
    )
    if math.isfinite(most_m[0]):
        half = np.broadcast_to(np.array(most_m) / 2.0, half.shape)
    half = np.where(whole[:, np.newaxis], np.maximum(half, 0.0), 0.0)

    def fits(share: Floats) -> Flags:
        return _sides_shown(camera, poses, plane, ground, centres, share[:, np.newaxis] * half)

    every = np.ones(count)
    fitting = fits(every)
    share = every if fitting.all() else np.where(fitting, 1.0, _largest_share(fits, count, _HALVINGS))
    across, up = (share[:, np.newaxis] * half).T
    x, y = (centre + place for centre, place in zip(centres.T, plane.forward(poses.lat_deg, poses.lon_deg)))
    return Sides(x - across, y - up, x + across, y + up)


def _edges_in_plane(
    source_plane: ProjectedPlane, camera: Camera, poses: Poses, ground: Ellipsoid, pixel: float
) -> FrameEdges:
    """`inscribed_edges` on the plane of a source's CRS; empty if part of an image shows no ground."""
    plane = TurnedPlane(source_plane, source_plane.west, source_plane.north, float(poses.lon_deg[0]), 0.0)
    sides = image_sides(camera, poses, plane, ground)
    place = np.stack(plane.forward(poses.lat_deg, poses.lon_deg))
    left, right = (np.where(np.isfinite(side), side, place[0]) for side in (sides.left_m, sides.right_m))
    bottom, top = (np.where(np.isfinite(side), side, place[1]) for side in (sides.bottom_m, sides.top_m))
    across, down = (side * source_plane.unit_m for side in (source_plane.width, source_plane.height))
    edges = FrameEdges(left / across, right / across, -top / down, -bottom / down)
    return _narrowed(edges, _MARGIN_PX * pixel)


def _sides_shown(
    camera: Camera, poses: Poses, plane: RowsPlane, ground: Ellipsoid, centre: Floats, half: Floats
) -> Flags:
    """Whether images show whole rectangles about centres (n, 2), relative to the camera's position; see `_shown`."""
    points = _border_points(camera)
    across, up = (2.0 * share - 1.0 for share in _unit_border(points))
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
    sides = camera.side_excess(vectors.reshape(len(lat), -1, 3), *poses.attitude)
    # Rounding of ground positions in the smallest images, in half images.
    inside: Flags = _reach(sides.reshape(len(lat), 4, points, 4)).max(axis=1) <= 1e-9
    return inside


def _image_frame() -> Floats:
    """Points of the image's frame, (4·points, 2), each edge beginning with its corner."""
    corners = np.array([[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    shares = np.arange(_EDGE_POINTS)[:, np.newaxis] / _EDGE_POINTS
    edges = [start + shares * (end - start) for start, end in zip(corners, np.roll(corners, -1, axis=0))]
    return np.concatenate(edges)


def _border_points(camera: Camera) -> int:
    """Number of points tested along each side of a rectangle; wide images need more."""
    return 13 if camera.fov_deg <= 120.0 and not camera.distorts else 65


def _unit_border(points: int) -> tuple[Floats, Floats]:
    """Shares of width and height, (4, points) each, along the four sides of a rectangle."""
    # Points are densest near corners, where images of straight lines bend most.
    share = (1.0 - np.cos(np.linspace(0.0, np.pi, points))) / 2.0
    low, high = np.zeros_like(share), np.ones_like(share)
    return np.stack([share, share, low, high]), np.stack([low, high, share, share])


def _sag(ring: Floats) -> Floats:
    """Largest sagitta of each ring (n, k, 2), its distance from the chord between two of its points, (n,)."""
    sides = ring.reshape(len(ring), 4, _EDGE_POINTS, 2)
    second, chord = np.diff(sides, n=2, axis=2), sides[:, :, 2:] - sides[:, :, :-2]
    length = np.hypot(chord[..., 0], chord[..., 1])
    # A curve leaves its chord by an eighth of its second difference across the chord.
    aside = np.abs(second[..., 0] * chord[..., 1] - second[..., 1] * chord[..., 0])
    sag: Floats = (aside / np.where(length > 0.0, length, 1.0)).max(axis=(1, 2)) / 8.0
    return sag


def _largest_share(fits: Callable[[Floats], Flags], count: int, halvings: int) -> Floats:
    """Largest shares (count,) in 0 to 1 that fit, by halving; shares below one that fits must fit."""
    inside, outside = np.zeros(count), np.ones(count)
    for _ in range(halvings):
        share = (inside + outside) / 2.0
        fitting = fits(share)
        inside, outside = np.where(fitting, share, inside), np.where(fitting, outside, share)
    return inside


def _reach(size: Floats) -> Floats:
    """Bounds (...) on the largest values of smooth curves sampled at points, (..., points, k).

    Between points a curve exceeds them only next to a local maximum: by the height of the parabola through it and its
    neighbours, and as much again for the difference from a parabola.
    """
    before, middle, after = size[..., :-2, :], size[..., 1:-1, :], size[..., 2:, :]
    bend = before - 2.0 * middle + after
    peak = (middle >= before) & (middle >= after) & (bend < 0.0)
    above = np.where(peak, (after - before) ** 2 / (-4.0 * np.where(peak, bend, -1.0)), 0.0)
    most: Floats = np.maximum(size.max(axis=(-2, -1)), (middle + above).max(axis=(-2, -1)))
    return most


def _half_sizes(ring: Floats, is_bent: bool) -> tuple[Floats, Floats]:
    """Half width and height, (n,) each, of the largest centred rectangle inside each ring (n, k, 2).

    0 for rings without extent, such as rings beyond the map. Rings that are not ``is_bent`` are convex.
    """
    ratios = _ratios(ring)
    half_u = _bent_rooms(ring, ratios) if is_bent else _rooms(ring, ratios)
    best = np.argmax(half_u * half_u * ratios, axis=1)[:, np.newaxis]
    width = np.take_along_axis(half_u, best, axis=1)[:, 0]
    return width, width * np.take_along_axis(ratios, best, axis=1)[:, 0]


def _common_half_sizes(ring: Floats, is_bent: bool) -> tuple[float, float]:
    """Half width and height of the largest centred rectangle inside all rings (n, k, 2); see `_half_sizes`."""
    ratios = _ratios(ring[:1])
    rooms = _bent_rooms if is_bent else _rooms
    half_u = rooms(ring, np.repeat(ratios, len(ring), axis=0)).min(axis=0)
    best = int(np.argmax(half_u * half_u * ratios[0]))
    return float(half_u[best]), float(half_u[best] * ratios[0, best])


def _ratios(ring: Floats) -> Floats:
    """Ratios of height to width to try for each ring, (n, r)."""
    extent = np.ptp(ring, axis=1)
    flat = (extent <= 0.0).any(axis=1)
    shape = np.where(flat, 1.0, extent[:, 1]) / np.where(flat, 1.0, extent[:, 0])
    ratios: Floats = shape[:, np.newaxis] * np.geomspace(1.0 / _RATIO_REACH, _RATIO_REACH, 33)
    return ratios


def _rooms(ring: Floats, ratios: Floats) -> Floats:
    """Half widths (n, r) of the centred rectangles of given ratios of height to width (n, r) inside rings (n, k, 2)."""
    # Vertices first: each step below then is one pass over contiguous rows.
    u, v = np.moveaxis(ring, 0, -1).swapaxes(0, 1).copy()
    flat = (np.ptp(u, axis=0) <= 0.0) | (np.ptp(v, axis=0) <= 0.0)
    way_u, way_v = (np.roll(side, -1, axis=0) - side for side in (u, v))
    # The rectangle is on one side of the line through two vertices while |way × corner| < |way × start|.
    distance = np.abs(way_u * v - way_v * u)
    reach_u, reach_v = np.abs(way_v), np.abs(way_u)
    # Coincident vertices define no line.
    distance[(reach_u == 0.0) & (reach_v == 0.0)] = np.inf
    half_u, need = np.empty(ratios.shape), np.empty_like(u)
    with np.errstate(divide="ignore"):
        for column, ratio in enumerate(ratios.T):
            np.multiply(reach_v, ratio, out=need)
            need += reach_u
            np.divide(distance, need, out=need)
            need.min(axis=0, out=half_u[:, column])
    half_u[flat] = 0.0
    return half_u


def _bent_rooms(ring: Floats, ratios: Floats) -> Floats:
    """`_rooms` of rings that need not be convex, up to the sagittas between points on their sides."""
    following = np.roll(ring, -1, axis=1)
    points = np.concatenate([ring + share * (following - ring) for share in np.arange(8) / 8.0], axis=1)
    u, v = np.abs(points[..., 0]), np.abs(points[..., 1])
    half_u: Floats = np.stack([np.maximum(u, v / ratio[:, np.newaxis]).min(axis=1) for ratio in ratios.T], axis=1)
    half_u[(np.ptp(ring, axis=1) <= 0.0).any(axis=1)] = 0.0
    return half_u
