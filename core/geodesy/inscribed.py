"""The north-up rectangle of the map that lies wholly inside what a camera sees: what covering an area counts on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from .camera import Camera
from .ellipsoid import WGS84, Ellipsoid
from .footprint import Corners, exact
from .frames import FrameEdges
from .mercator import lat_to_v, lon_to_u
from .poses import Poses

Floats = NDArray[np.float64]

#: Points along each edge of the image.
_EDGE_POINTS = 12
#: Ratios of height to width that are tried, and how far they reach from that of the ground itself.
_RATIOS, _RATIO_REACH = 33, 16.0
#: Points an image is searched with for the middle of the ground it shows, along each side.
_SEARCH_POINTS = 9
#: Rounding an edge to the grid may move it outward by half a pixel; the rest is for what float64 does to positions.
_MARGIN_PX = 0.5 + 1e-3
#: Poles are infinitely far up and down the map; this far, in world fractions, is far enough.
_BEYOND = 1.0
#: Longitudes within this of a level camera's are not beyond a pole.
_SAME_SIDE_DEG = 90.0
#: Poses worked on in one go, to bound memory.
_BATCH = 1024


def _image_frame() -> Floats:
    """Points of the image's frame, (4·points, 2), corners first of each edge."""
    corners = np.array([[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    shares = np.arange(_EDGE_POINTS)[:, np.newaxis] / _EDGE_POINTS
    edges = [start + shares * (end - start) for start, end in zip(corners, np.roll(corners, -1, axis=0))]
    return np.concatenate(edges)


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
    frame = tuple((x, y) for x, y in _image_frame().tolist())
    if not any(angle.any() for angle in poses.attitude):
        seen = exact(camera, at_zero, frame, ground)
        if seen.hit.all() and (np.abs(seen.lon_deg) < _SAME_SIDE_DEG).all():
            ring = _on_map(seen)
            return _shrunk(_level_edges(ring), ring, pixel)
    centre = _map_points(camera, at_zero, (_anchor(camera, at_zero, ground),), ground)
    ring = _map_points(camera, at_zero, frame, ground)
    half_u, half_v = _half_sizes(ring - centre)
    u, v = centre[:, 0, 0], centre[:, 0, 1]
    return _shrunk(FrameEdges(u - half_u, u + half_u, v - half_v, v + half_v), ring, pixel)


def _shrunk(edges: FrameEdges, ring: Floats, pixel: float) -> FrameEdges:
    """Edges with room for their rounding and for how far the ring bends inward between its points.

    Edges that would pass each other meet in the middle.
    """
    west, east, top, bottom = edges
    sides = ring.reshape(len(ring), 4, _EDGE_POINTS, 2)
    second, chord = np.diff(sides, n=2, axis=2), sides[:, :, 2:] - sides[:, :, :-2]
    length = np.hypot(chord[..., 0], chord[..., 1])
    # Across its chord a curve leaves it by an eighth of its second difference; along it, points are only spaced.
    aside = np.abs(second[..., 0] * chord[..., 1] - second[..., 1] * chord[..., 0])
    sag = (aside / np.where(length > 0.0, length, 1.0)).max(axis=(1, 2)) / 8.0
    across, down = (np.minimum(_MARGIN_PX * pixel + sag, size / 2.0) for size in edges.size)
    return FrameEdges(west + across, east - across, top + down, bottom - down)


def _level_edges(ring: Floats) -> FrameEdges:
    """Edges inside the rings (n, k, 2) of level, north-up cameras, whose own edges are nearly the map's."""
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


def _map_points(
    camera: Camera, poses: Poses, points: tuple[tuple[float, float], ...], ground: Ellipsoid
) -> Floats:
    """World fractions from the camera's meridian and from the map's north, (n, k, 2)."""
    return _on_map(exact(camera, poses, points, ground))


def _on_map(seen: Corners) -> Floats:
    """World fractions of ground points, (n, k, 2)."""
    v = np.clip(lat_to_v(seen.lat_deg), -_BEYOND, 1.0 + _BEYOND)
    return np.stack([lon_to_u(seen.lon_deg) - 0.5, v], axis=-1)


def _anchor(camera: Camera, poses: Poses, ground: Ellipsoid) -> tuple[float, float]:
    """Image point about which the rectangles lie."""
    if exact(camera, poses, ((0.0, 0.0),), ground).hit.all():
        return 0.0, 0.0
    along = np.linspace(-1.0, 1.0, _SEARCH_POINTS)
    points = [(x, y) for x in along.tolist() for y in along.tolist()]
    hit = exact(camera, poses, tuple(points), ground).hit
    if not hit.any(axis=1).all():
        at = int(np.flatnonzero(~hit.any(axis=1))[0])
        raise InvalidInput(
            f"camera with tilt {float(poses.tilt_deg[at]):g} and roll {float(poses.roll_deg[at]):g} deg at "
            f"{float(poses.agl_m[at]):g} m: no ray of its image meets the Earth; tilt it down"
        )
    everywhere = hit.all(axis=0)
    x, y = np.array(points)[everywhere if everywhere.any() else hit[0]].mean(axis=0).tolist()
    return x, y


def _half_sizes(ring: Floats) -> tuple[Floats, Floats]:
    """Half width and height, (n,) each, of the largest centred rectangle inside each ring (n, k, 2).

    0 for rings without extent, as those have that lie beyond the map.
    """
    extent = np.ptp(ring, axis=1)
    flat = (extent <= 0.0).any(axis=1)
    shape = np.where(flat, 1.0, extent[:, 1]) / np.where(flat, 1.0, extent[:, 0])
    ratios = shape[:, np.newaxis] * np.geomspace(1.0 / _RATIO_REACH, _RATIO_REACH, _RATIOS)
    start, way = ring, np.roll(ring, -1, axis=1) - ring
    # A line through two vertices leaves the rectangle on its side while |way × corner| stays below |way × start|.
    distance = np.abs(way[..., 0] * start[..., 1] - way[..., 1] * start[..., 0])[:, :, np.newaxis]
    reach_u, reach_v = (np.abs(way[..., axis])[:, :, np.newaxis] for axis in (1, 0))
    need = reach_u + reach_v * ratios[:, np.newaxis]
    # Vertices that coincide make no line.
    room = np.where(need > 0.0, distance / np.where(need > 0.0, need, 1.0), np.inf)
    half_u = np.where(flat[:, np.newaxis], 0.0, room.min(axis=1))
    best = np.argmax(half_u * half_u * ratios, axis=1)[:, np.newaxis]
    width = np.take_along_axis(half_u, best, axis=1)[:, 0]
    return width, width * np.take_along_axis(ratios, best, axis=1)[:, 0]
