"""Features as pieces in the plane of an image: polygons, and segments with a radius for lines and points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Protocol

import numpy as np

from ..arrays import Floats, Numbers, expand_counts
from ..geodesy.ellipsoid import WGS84
from ..vectors.features import LINE, POINT, Features

#: Longest segment of a line, metres; along it, the plane's scale counts as constant.
_SEGMENT_M = 1000.0
_MOST_LAT_DEG = 90.0 - 1e-9


class LabelPlane(Protocol):
    """Plane in which labels are drawn."""

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Positions in the plane of positions in degrees (any shape)."""

    def ground_m(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Metres of ground per unit of the plane's axes, at positions (any shape)."""


@dataclass(frozen=True)
class DegreePlane:
    """Longitudes and latitudes in degrees, in which camera frames are drawn."""

    def forward(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Longitudes and latitudes."""
        return lon_deg, lat_deg

    def ground_m(self, lat_deg: Floats, _lon_deg: Floats, /) -> tuple[Floats, Floats]:
        """Metres of ground per degree."""
        degree = np.radians(1.0)
        across = WGS84.normal_radius_m(lat_deg) * np.cos(np.radians(lat_deg)) * degree
        return across, WGS84.meridional_radius_m(lat_deg) * degree


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces (n,) of features, the topmost first.

    Parameters
    ----------
    label, instance, rank : array (n,) of int64
        Class id, instance id, and the feature's place in the order of drawing.
    box : array (n, 4)
        Least x, least y, greatest x and greatest y in the plane.
    radius_m : array (n,)
        0 for a polygon; for others the radius about a segment.
    scale_m : array (n, 2)
        Metres of ground per unit of x and y.
    starts : array (n + 1,) of int64
        First edge of each piece; a segment is one edge.
    edges : array (m, 4)
        x and y of the lower end, then of the upper end of each edge.
    """

    label: Numbers
    instance: Numbers
    rank: Numbers
    box: Floats
    radius_m: Floats
    scale_m: Floats
    starts: Numbers
    edges: Floats

    def __len__(self) -> int:
        return len(self.label)

    def take(self, which: Numbers) -> Pieces:
        """Pieces of some indices, in their order."""
        counts = np.diff(self.starts)[which]
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        at = np.repeat(self.starts[which] - starts[:-1], counts) + np.arange(starts[-1])
        rows = {one.name: getattr(self, one.name)[which] for one in fields(self) if one.name not in ("starts", "edges")}
        return Pieces(**rows, starts=starts, edges=self.edges[at])

    @classmethod
    def joined(cls, parts: Sequence[Pieces]) -> Pieces:
        """Pieces of several parts, one after the other."""
        if not parts:
            return NO_PIECES
        counts = np.concatenate([np.diff(part.starts) for part in parts])
        starts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        joined = {
            one.name: np.concatenate([getattr(part, one.name) for part in parts])
            for one in fields(cls)
            if one.name != "starts"
        }
        return cls(**joined, starts=starts)


NO_PIECES = Pieces(
    np.empty(0, np.int64),
    np.empty(0, np.int64),
    np.empty(0, np.int64),
    np.empty((0, 4)),
    np.empty(0),
    np.empty((0, 2)),
    np.zeros(1, np.int64),
    np.empty((0, 4)),
)


def pieces(
    features: Features, labels: Numbers, plane: LabelPlane, line_width_m: float, point_radius_m: float
) -> Pieces:
    """Return the pieces of features: a polygon for each part, a segment for each edge of a line and each point.

    Edges are straight in the plane. Pieces are in the order of the features.

    Parameters
    ----------
    labels : array (n, 3) of int64
        Class id, instance id and place in the order of each feature.
    """
    ring = np.repeat(np.arange(len(features.ring_starts) - 1), np.diff(features.ring_starts))
    part_of_ring = np.repeat(np.arange(len(features.part_starts) - 1), np.diff(features.part_starts))
    feature_of_part = np.repeat(np.arange(len(features.feature_starts) - 1), np.diff(features.feature_starts))
    feature = feature_of_part[part_of_ring[ring]] if len(ring) else np.empty(0, np.int64)
    # Just beside the poles, which Web Mercator does not hold.
    lat_deg = np.clip(features.lat_deg, -_MOST_LAT_DEG, _MOST_LAT_DEG)
    x, y = plane.forward(lat_deg, features.lon_deg)
    xy = np.stack([x, y], axis=1)
    kind = features.kind[feature]
    radius = np.where(kind == LINE, line_width_m / 2.0, np.where(kind == POINT, point_radius_m, 0.0))
    # Edges lead from each vertex to the next of its ring; of points to themselves.
    first = np.nonzero(ring[:-1] == ring[1:])[0] if len(ring) else np.empty(0, np.int64)
    first = first[kind[first] != POINT]
    second = first + 1
    points = np.nonzero(kind == POINT)[0]
    first, second = np.concatenate([first, points]), np.concatenate([second, points])
    order = np.argsort(first, kind="stable")
    first, second = first[order], second[order]
    edges = np.concatenate([xy[first], xy[second]], axis=1)
    finite = np.isfinite(edges).all(axis=1)
    first, second, edges = first[finite], second[finite], edges[finite]
    is_stroke = radius[first] > 0.0
    scale = np.ones((len(first), 2))
    if is_stroke.any():
        middle = ((one[first] + one[second]) / 2.0 for one in (features.lat_deg, features.lon_deg))
        scale = np.stack(plane.ground_m(*middle), axis=1)
        length = np.where(is_stroke, np.hypot(*((edges[:, 2:] - edges[:, :2]) * scale).T), 0.0)
        copies = np.maximum(np.ceil(length / _SEGMENT_M), 1).astype(np.int64)
        at, edges, scale = _divided(features, plane, (first, second), edges, copies)
        first, is_stroke = first[at], is_stroke[at]
    # One piece for each part of polygons, and for each segment.
    key = np.where(is_stroke, len(part_of_ring) + np.arange(len(first)), part_of_ring[ring[first]])
    starts = np.nonzero(np.concatenate([[True], key[1:] != key[:-1]]))[0] if len(key) else np.empty(0, np.int64)
    owner = feature[first[starts]]
    return Pieces(
        labels[owner, 0],
        labels[owner, 1],
        labels[owner, 2],
        _boxes(edges, starts, radius[first[starts]], scale[starts]),
        radius[first[starts]],
        scale[starts],
        np.append(starts, len(edges)).astype(np.int64),
        _upward(edges),
    )


def _divided(
    features: Features, plane: LabelPlane, ends: tuple[Numbers, Numbers], edges: Floats, copies: Numbers
) -> tuple[Numbers, Floats, Floats]:
    """Divide long segments; returns the edge that each part belongs to, the parts, and the scales of their middles."""
    at, step = expand_counts(copies)
    low, high = step / copies[at], (step + 1) / copies[at]
    way = edges[at, 2:] - edges[at, :2]
    parts = np.concatenate([edges[at, :2] + way * low[:, None], edges[at, :2] + way * high[:, None]], axis=1)
    whole = copies[at] == 1
    parts[whole] = edges[at[whole]]
    first, second = (end[at] for end in ends)
    middle = (
        one[first] + (one[second] - one[first]) * (low + high) / 2.0 for one in (features.lat_deg, features.lon_deg)
    )
    return at, parts, np.stack(plane.ground_m(*middle), axis=1)


def _upward(edges: Floats) -> Floats:
    """Edges with their lower end first, so that neighbours compute the same crossings with a common edge."""
    swap = (edges[:, 1] > edges[:, 3]) | ((edges[:, 1] == edges[:, 3]) & (edges[:, 0] > edges[:, 2]))
    return np.where(swap[:, None], edges[:, [2, 3, 0, 1]], edges)


def _boxes(edges: Floats, starts: Numbers, radius_m: Floats, scale_m: Floats) -> Floats:
    if not len(starts):
        return np.empty((0, 4))
    low = np.minimum(edges[:, :2], edges[:, 2:])
    high = np.maximum(edges[:, :2], edges[:, 2:])
    # A little more, as distances are rounded.
    room = radius_m[:, None] / scale_m * (1.0 + 1e-6)
    return np.concatenate([np.minimum.reduceat(low, starts) - room, np.maximum.reduceat(high, starts) + room], axis=1)
