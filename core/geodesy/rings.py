"""Rings of ground that images see, and the rectangles along a map's axes inside them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .camera import Camera

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Points along each edge of the image.
EDGE_POINTS = 12
#: Ratios of height to width that are tried, and how far they reach from that of the ground itself.
_RATIOS, RATIO_REACH = 33, 16.0
#: Points along each side of a rectangle at which it is asked whether the image shows it.
_BORDER_POINTS = 13
#: The same where fields of view are wider than this, degrees: a half image is a small angle at their sides.
_WIDE_DEG, _WIDE_BORDER_POINTS = 120.0, 65


def image_frame() -> Floats:
    """Points of the image's frame, (4·points, 2), corners first of each edge."""
    corners = np.array([[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    shares = np.arange(EDGE_POINTS)[:, np.newaxis] / EDGE_POINTS
    edges = [start + shares * (end - start) for start, end in zip(corners, np.roll(corners, -1, axis=0))]
    return np.concatenate(edges)


def border_points(camera: Camera) -> int:
    """Points along each side of a rectangle that say whether an image shows it."""
    return _BORDER_POINTS if camera.fov_deg <= _WIDE_DEG else _WIDE_BORDER_POINTS


def unit_border(points: int) -> tuple[Floats, Floats]:
    """Shares of width and height, (4, points) each, along the four sides of a rectangle."""
    # Closest at the corners, where images of straight lines bend the most; along such a side a curve starts level.
    share = (1.0 - np.cos(np.linspace(0.0, np.pi, points))) / 2.0
    low, high = np.zeros_like(share), np.ones_like(share)
    return np.stack([share, share, low, high]), np.stack([low, high, share, share])


def sag(ring: Floats) -> Floats:
    """How far the rings (n, k, 2) bend inward between their points, (n,)."""
    sides = ring.reshape(len(ring), 4, EDGE_POINTS, 2)
    second, chord = np.diff(sides, n=2, axis=2), sides[:, :, 2:] - sides[:, :, :-2]
    length = np.hypot(chord[..., 0], chord[..., 1])
    # Across its chord a curve leaves it by an eighth of its second difference; along it, points are only spaced.
    aside = np.abs(second[..., 0] * chord[..., 1] - second[..., 1] * chord[..., 0])
    sag: Floats = (aside / np.where(length > 0.0, length, 1.0)).max(axis=(1, 2)) / 8.0
    return sag


def largest_share(fits: Callable[[Floats], Flags], count: int, halvings: int) -> Floats:
    """Largest shares (count,) of 0 to 1 that are known to fit, by halving; what fits does so at every smaller share."""
    inside, outside = np.zeros(count), np.ones(count)
    for _ in range(halvings):
        share = (inside + outside) / 2.0
        fitting = fits(share)
        inside, outside = np.where(fitting, share, inside), np.where(fitting, outside, share)
    return inside


def reach(size: Floats) -> Floats:
    """Largest values (...) of smooth curves known at points, (..., points, k).

    Between points a curve is above all of them only beside a point that is above both its neighbours: by what the
    parabola through the three is, and as much again for what is no parabola.
    """
    before, middle, after = size[..., :-2, :], size[..., 1:-1, :], size[..., 2:, :]
    bend = before - 2.0 * middle + after
    peak = (middle >= before) & (middle >= after) & (bend < 0.0)
    above = np.where(peak, (after - before) ** 2 / (-4.0 * np.where(peak, bend, -1.0)), 0.0)
    most: Floats = np.maximum(size.max(axis=(-2, -1)), (middle + above).max(axis=(-2, -1)))
    return most


def half_sizes(ring: Floats) -> tuple[Floats, Floats]:
    """Half width and height, (n,) each, of the largest centred rectangle inside each ring (n, k, 2).

    0 for rings without extent, as those have that lie beyond the map.
    """
    ratios = _ratios(ring)
    half_u = rooms(ring, ratios)
    best = np.argmax(half_u * half_u * ratios, axis=1)[:, np.newaxis]
    width = np.take_along_axis(half_u, best, axis=1)[:, 0]
    return width, width * np.take_along_axis(ratios, best, axis=1)[:, 0]


def common_half_sizes(ring: Floats) -> tuple[float, float]:
    """Half width and height of the largest centred rectangle that lies inside all rings (n, k, 2)."""
    ratios = _ratios(ring[:1])
    half_u = rooms(ring, np.repeat(ratios, len(ring), axis=0)).min(axis=0)
    best = int(np.argmax(half_u * half_u * ratios[0]))
    return float(half_u[best]), float(half_u[best] * ratios[0, best])


def _ratios(ring: Floats) -> Floats:
    """Ratios of height to width that are tried for each ring, (n, r)."""
    extent = np.ptp(ring, axis=1)
    flat = (extent <= 0.0).any(axis=1)
    shape = np.where(flat, 1.0, extent[:, 1]) / np.where(flat, 1.0, extent[:, 0])
    ratios: Floats = shape[:, np.newaxis] * np.geomspace(1.0 / RATIO_REACH, RATIO_REACH, _RATIOS)
    return ratios


def rooms(ring: Floats, ratios: Floats) -> Floats:
    """Half widths (n, r) of the centred rectangles of given ratios of height to width (n, r) inside rings (n, k, 2)."""
    flat = (np.ptp(ring, axis=1) <= 0.0).any(axis=1)
    start, way = ring, np.roll(ring, -1, axis=1) - ring
    # A line through two vertices leaves the rectangle on its side while |way × corner| stays below |way × start|.
    distance = np.abs(way[..., 0] * start[..., 1] - way[..., 1] * start[..., 0])[:, :, np.newaxis]
    reach_u, reach_v = (np.abs(way[..., axis])[:, :, np.newaxis] for axis in (1, 0))
    need = reach_u + reach_v * ratios[:, np.newaxis]
    # Vertices that coincide make no line.
    room = np.where(need > 0.0, distance / np.where(need > 0.0, need, 1.0), np.inf)
    return np.where(flat[:, np.newaxis], 0.0, room.min(axis=1))
