"""The north-up rectangle of the map that lies wholly inside what a camera sees: what covering an area counts on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .camera import Camera
from .ellipsoid import WGS84, Ellipsoid, above_tangent_plane_m, sight_lines
from .footprint import Corners, exact
from .frames import FrameEdges
from .horizon import outline
from .mercator import lat_to_v, lon_to_u, u_to_lon, v_to_lat
from .poses import Poses
from .rings import (
    EDGE_POINTS,
    RATIO_REACH,
    border_points,
    half_sizes,
    image_frame,
    largest_share,
    reach,
    sag,
    unit_border,
)

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Ratios that are tried where the horizon cuts an image, each by halving.
_TRIED_RATIOS = 7
#: Rounding an edge to the grid may move it outward by half a pixel; the rest is for what float64 does to positions.
_MARGIN_PX = 0.5 + 1e-3
#: Poles are infinitely far up and down the map; this far, in world fractions, is far enough.
_BEYOND = 1.0
#: Longitudes within this of a level camera's are not beyond a pole.
_SAME_SIDE_DEG = 90.0
#: Halvings to find how much smaller a rectangle has to be that the image shows it.
_HALVINGS = 40
#: Halvings, and points along each side, where rectangles of several shapes are compared.
_ROUGHLY, _ROUGH_POINTS = 10, 5
#: Half images by which a rectangle may leave its image to be made smaller in one step.
_LITTLE = 1e-2
#: Rounding of a position on the map, in world fractions.
_ROUNDING = 2.0**-51
#: No camera sees half of the Earth, and so none shows a rectangle of this width.
_WIDEST = 0.5
#: World widths up to which images of level cameras need no second look.
_SMALL = 0.05
#: A ring of the map whose ends are this far apart goes around a pole.
_HALF_TURN = 0.5
#: Poses worked on in one go, to bound memory.
_BATCH = 1024


def inscribed_edges(
    camera: Camera, poses: Poses, ground: Ellipsoid = WGS84, pixel: float = 0.0
) -> FrameEdges:
    """Rectangles inside what cameras see, as large as their centre allows.

    The centre is where the image's centre sees the ground; where that looks past the Earth, the middle of the part
    of the image that does not.

    Parameters
    ----------
    poses : Poses
        (n,), of any attitude.
    pixel : float
        Size of a source pixel as a world fraction: the rectangles leave room for the rounding of their edges.

    Returns
    -------
    FrameEdges
        Of no extent where nothing of the map lies inside.

    Raises
    ------
    InvalidInput
        A camera none of whose rays meets the Earth.
    """
    if len(poses.lat_deg) > _BATCH:
        starts = range(0, len(poses.lat_deg), _BATCH)
        parts = [
            inscribed_edges(camera, Poses(*(p[i : i + _BATCH] for p in poses)), ground, pixel) for i in starts
        ]
        return FrameEdges(*(np.concatenate(columns) for columns in zip(*parts)))
    at_zero = poses._replace(lon_deg=np.zeros(len(poses.lat_deg)))
    seen = exact(camera, at_zero, tuple((x, y) for x, y in image_frame().tolist()), ground)
    ring = _on_map(seen)
    whole = seen.hit.all(axis=1)
    level = whole & (np.abs(seen.lon_deg) < _SAME_SIDE_DEG).all(axis=1)
    for angle in poses.attitude:
        level &= angle == 0.0
    # Rings that the horizon cuts, or that go around a pole, are no polygons of the map.
    polygon = whole & (np.abs(ring[:, -1, 0] - ring[:, 0, 0]) < _HALF_TURN)
    edges, centre = _about_centres(camera, at_zero, ring, polygon & ~level, ~polygon & ~level, ground)
    for side, straight in zip(edges, _level_edges(ring)):
        side[level] = straight[level]
    centre[level, 0] = 0.0
    centre[level, 1] = (edges.top_v + edges.bottom_v)[level] / 2.0
    inside = _narrowed(edges, np.where(polygon | level, sag(ring), 0.0))
    # Small images of level cameras are all but rectangles of the map.
    asked = np.flatnonzero(~level | (np.ptp(ring[..., 0], axis=1) > _SMALL))
    if len(asked):
        some = FrameEdges(*(side[asked] for side in inside))
        for side, shown in zip(inside, _shown(camera, at_zero.take(asked), some, centre[asked], ground)):
            side[asked] = shown
    return _narrowed(inside, _MARGIN_PX * pixel)


def _about_centres(
    camera: Camera, poses: Poses, ring: Floats, polygon: Flags, cut: Flags, ground: Ellipsoid
) -> tuple[FrameEdges, Floats]:
    """Edges and centres (n, 2) of rectangles inside rings that are polygons, and of such that are tried; else zero."""
    count = len(ring)
    centre, half_u, half_v = np.zeros((count, 2)), np.zeros(count), np.zeros(count)
    if polygon.any():
        centre[polygon] = _centres(camera, poses.take(polygon), ground)
        half_u[polygon], half_v[polygon] = half_sizes(ring[polygon] - centre[polygon, np.newaxis])
    if cut.any():
        centre[cut] = _centres(camera, poses.take(cut), ground)
        half_u[cut], half_v[cut] = _searched(camera, poses.take(cut), ring[cut], centre[cut], ground)
    half_u = np.minimum(half_u, _WIDEST / 2.0)
    u, v = centre.T
    return FrameEdges(u - half_u, u + half_u, v - half_v, v + half_v), centre


def _narrowed(edges: FrameEdges, room: Floats | float) -> FrameEdges:
    """Edges moved inward; those that would pass each other meet in the middle."""
    across, down = (np.minimum(room, size / 2.0) for size in edges.size)
    west, east, top, bottom = edges
    return FrameEdges(west + across, east - across, top + down, bottom - down)


def _shown(camera: Camera, poses: Poses, edges: FrameEdges, centre: Floats, ground: Ellipsoid) -> FrameEdges:
    """Rectangles that images show whole: those that are not get smaller about their centre (n, 2) until they are.

    What a camera sees of the Earth is convex in its image and less than half of the Earth, so that a rectangle whose
    border is seen is seen.
    """
    beyond, moved = (_leaving(camera, poses, edges, ground, shift) for shift in (0.0, _ROUNDING))
    finite = np.isfinite(beyond) & np.isfinite(moved)
    noise = np.abs(np.where(finite, moved, 0.0) - np.where(finite, beyond, 0.0))
    at = np.flatnonzero(beyond > noise)
    if len(at) == 0:
        return edges
    some, limit, (u, v) = poses.take(at), noise[at], centre[at].T
    reach = [side[at] - middle for side, middle in zip(edges, (u, u, v, v))]

    def scaled(share: Floats) -> FrameEdges:
        return FrameEdges(*(middle + share * way for way, middle in zip(reach, (u, u, v, v))))

    # What leaves by little is a little smaller; the rest is found by halving.
    inside = np.where(beyond[at] < _LITTLE, 1.0 - 2.0 * beyond[at], 0.0)
    little = (inside > 0.0) & (_leaving(camera, some, scaled(inside), ground) <= limit)
    if not little.all():
        halved = largest_share(
            lambda share: np.asarray(_leaving(camera, some, scaled(share), ground) <= limit),
            len(at),
            _HALVINGS,
        )
        inside = np.where(little, inside, halved)
    for side, smaller in zip(edges, scaled(inside)):
        side[at] = smaller
    return edges


def _leaving(
    camera: Camera,
    poses: Poses,
    edges: FrameEdges,
    ground: Ellipsoid,
    moved: float = 0.0,
    points: int | None = None,
) -> Floats:
    """How far the borders of rectangles leave their images, (n,) in half images, infinite where the Earth hides them.

    ``moved`` shifts the rectangles by so much, in world fractions; ``points`` are looked at along each side.
    """
    points = border_points(camera) if points is None else points
    across, down = unit_border(points)
    west, _, top, _ = (side[:, np.newaxis, np.newaxis] for side in edges)
    width, height = (size[:, np.newaxis, np.newaxis] for size in edges.size)
    # Longitudes here count from the camera's meridian, whose world fraction is a half.
    dlon = u_to_lon(west + width * across + moved + 0.5)
    lat = v_to_lat(top + height * down + moved)
    camera_lat, agl = (values[:, np.newaxis, np.newaxis] for values in (poses.lat_deg, poses.agl_m))
    vectors = sight_lines(camera_lat, agl, lat, dlon, ground)
    sides = camera.beyond_sides(vectors.reshape(len(west), -1, 3), *poses.attitude)
    below_m = -above_tangent_plane_m(camera_lat, vectors, lat, dlon)
    hidden = reach(below_m[..., np.newaxis]) >= 0.0
    beyond: Floats = np.where(hidden, np.inf, reach(sides.reshape(len(west), 4, points, 4))).max(axis=1)
    return beyond


def _level_edges(ring: Floats) -> FrameEdges:
    """Edges inside the rings (n, k, 2) of level, north-up cameras, whose own edges are nearly the map's."""
    north, east, south, west = (
        np.take(ring, range(start, start + EDGE_POINTS + 1), axis=1, mode="wrap")
        for start in range(0, 4 * EDGE_POINTS, EDGE_POINTS)
    )
    return FrameEdges(
        west[..., 0].max(axis=1),
        east[..., 0].min(axis=1),
        north[..., 1].max(axis=1),
        south[..., 1].min(axis=1),
    )


def _on_map(seen: Corners) -> Floats:
    """World fractions of ground points from the camera's meridian and from the map's north, (n, k, 2).

    Points follow each other without a jump where the camera's far meridian lies between them.
    """
    v = np.clip(lat_to_v(seen.lat_deg), -_BEYOND, 1.0 + _BEYOND)
    return np.stack([np.unwrap(lon_to_u(seen.lon_deg) - 0.5, axis=1, period=1.0), v], axis=-1)


def _centres(camera: Camera, poses: Poses, ground: Ellipsoid) -> Floats:
    """Points of the map about which the rectangles lie, (n, 2)."""
    seen = exact(camera, poses, ((0.0, 0.0),), ground)
    centre = _on_map(seen)[:, 0]
    for at in np.flatnonzero(~seen.hit[:, 0]).tolist():
        yaw, tilt, roll = (float(angle[at]) for angle in poses.attitude)
        shown = outline(camera, float(poses.lat_deg[at]), float(poses.agl_m[at]), (yaw, tilt, roll), ground)
        x, y = shown.image_xy.mean(axis=0).tolist()
        centre[at] = _on_map(exact(camera, poses.take(np.array([at])), ((x, y),), ground))[0, 0]
    return centre


def _searched(
    camera: Camera, poses: Poses, ring: Floats, centre: Floats, ground: Ellipsoid
) -> tuple[Floats, Floats]:
    """Half width and height, (n,) each, of the largest rectangles about their centres that are found by trying."""
    ratios = np.geomspace(1.0 / RATIO_REACH, RATIO_REACH, _TRIED_RATIOS)
    every = np.repeat(np.arange(len(centre)), len(ratios))
    u, v = centre[every].T
    reach = np.minimum(np.abs(ring - centre[:, np.newaxis]).max(axis=(1, 2)), _WIDEST / 2.0)[every]
    half_v = reach * np.tile(np.minimum(ratios, 1.0), len(centre))
    half_u = reach * np.tile(np.minimum(1.0 / ratios, 1.0), len(centre))
    some = poses.take(every)

    def fits(share: Floats) -> Flags:
        across, down = share * half_u, share * half_v
        tried = FrameEdges(u - across, u + across, v - down, v + down)
        return np.asarray(_leaving(camera, some, tried, ground, points=_ROUGH_POINTS) <= 0.0)

    inside = largest_share(fits, len(every), _ROUGHLY)
    width, height = ((inside * half).reshape(len(centre), len(ratios)) for half in (half_u, half_v))
    best = np.argmax(width * height, axis=1)[:, np.newaxis]
    return np.take_along_axis(width, best, axis=1)[:, 0], np.take_along_axis(height, best, axis=1)[:, 0]
