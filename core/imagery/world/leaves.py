"""Pieces of the divided land, and how each of them looks: crops, yards, houses.

All of it follows from a piece's hash, size and climate, so it is worked out once for a whole division.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .lattice import Array, bits, mix

BORDER, HEDGE, TRACK, LANE, ROAD, MAIN = range(6)
HALF_WIDTH_M = (0.0, 2.5, 1.6, 3.2, 5.0, 8.0)

FARM, WILD, TOWN = range(3)


@dataclass(frozen=True)
class Leaves:
    """Undivided pieces: arrays of shape (n,), edges in metres of the bent plane.

    `sides` has shape (4, n): what runs along the left, right, top and bottom. `resolved` is false where a
    piece would be
    divided further if its parts were not too small to see.
    """

    x0: Array
    x1: Array
    y0: Array
    y1: Array
    hash: Array
    sides: Array
    kind: Array
    density: Array
    resolved: Array
    settled: Array
    dry: Array

    @property
    def width(self) -> Array:
        """Extent eastward in m."""
        return self.x1 - self.x0

    @property
    def length(self) -> Array:
        """Extent southward in m."""
        return self.y1 - self.y0


CROPS = (  # colour, weight on moist and on dry land, strength of its stripes, and of its speckle
    ((118, 132, 66), 0.16, 0.04, 0.05, 0.10),  # pasture
    ((86, 116, 52), 0.17, 0.05, 0.10, 0.06),  # maize
    ((104, 136, 62), 0.14, 0.06, 0.10, 0.06),  # young grain
    ((184, 162, 104), 0.13, 0.16, 0.07, 0.05),  # ripe grain
    ((202, 186, 136), 0.08, 0.18, 0.10, 0.06),  # stubble
    ((138, 114, 84), 0.10, 0.16, 0.09, 0.09),  # bare soil
    ((112, 92, 70), 0.06, 0.05, 0.08, 0.08),  # moist soil
    ((166, 146, 108), 0.05, 0.20, 0.05, 0.11),  # fallow
    ((70, 104, 50), 0.07, 0.06, 0.13, 0.05),  # beans
    ((198, 188, 82), 0.02, 0.01, 0.06, 0.05),  # rape in flower
    ((142, 146, 90), 0.02, 0.03, 0.05, 0.10),  # meadow
)
TOWN_MEAN = (118, 122, 100)
_LAWN, _YARD = (106, 122, 70), (146, 140, 126)
_ROOFS = (
    (146, 138, 130),
    (112, 106, 102),
    (164, 122, 98),
    (178, 168, 154),
    (132, 92, 74),
    (196, 194, 190),
    (96, 98, 104),
    (154, 112, 88),
)
_HALL_ROOFS = ((196, 196, 194), (168, 170, 172), (142, 146, 152), (214, 212, 206))
_LEAST_PLOT_M, HALL_M = 15.0, 46.0


@dataclass(frozen=True)
class Buildings:
    """A rectangle in each piece: edges in metres of the bent plane; `there` is false where it stays empty.

    `roof` has shape (3, n), `ridge_x` says whether the ridge runs eastward, `pitch` is how much its sides
    differ in light.
    """

    x0: Array
    x1: Array
    y0: Array
    y1: Array
    there: Array
    roof: Array
    ridge_x: Array
    pitch: Array


@dataclass(frozen=True)
class Looks:
    """How pieces look: arrays of shape (n,), float32; `colour` (3, n).

    `stripes` and `speckle` are strengths of texture; stripes run across the direction (`cos`, `sin`).
    """

    colour: Array
    speckle: Array
    stripes: Array
    cos: Array
    sin: Array
    town: Array
    wild: Array
    open: Array
    buildings: Buildings


def _crop_weights(dry: Array) -> Array:
    moist = np.array([w for _, w, _, _, _ in CROPS])[:, None]
    arid = np.array([w for _, _, w, _, _ in CROPS])[:, None]
    return np.asarray(moist + (arid - moist) * dry)


def farm_mean(dry: Array) -> Array:
    """Mean colour of farmland by its dryness (n,), shape (3, n)."""
    colours = np.array([c for c, *_ in CROPS], dtype=np.float64)
    return np.asarray(np.einsum("cn,ck->kn", _crop_weights(dry), colours))


def looks(leaves: Leaves, pixel_m: float) -> Looks:
    """Work out how pieces look to pixels of some size: small ones fade into the mean of their kind."""
    h = mix(leaves.hash + np.uint32(0x2545F491))
    weights = _crop_weights(leaves.dry)
    pick = bits(h, 0, 12) * weights.sum(axis=0)
    crop = np.minimum((pick > np.cumsum(weights, axis=0)).sum(axis=0), len(CROPS) - 1)
    farm, town = leaves.kind == FARM, leaves.kind == TOWN
    least = np.minimum(leaves.width, leaves.length)
    tone = 0.93 + 0.14 * bits(h, 12, 8)
    own = np.array([c for c, *_ in CROPS], dtype=np.float64).T[:, crop] * tone
    mean = farm_mean(leaves.dry)
    clear = leaves.resolved * (np.clip(least / pixel_m / 4.0 - 0.5, 0.0, 1.0) if pixel_m else 1.0)
    colour = mean + (own - mean) * clear
    lawn, yard = np.array(_LAWN)[:, None], np.array(_YARD)[:, None]
    lot = np.where(least > HALL_M, yard, lawn + (yard - lawn) * bits(h, 20, 6) ** 2) * tone
    colour = np.where(town, np.where(leaves.resolved, lot, np.array(TOWN_MEAN)[:, None]), colour)
    turned = mix(leaves.hash + np.uint32(0x6C8E9CF5))
    along = np.where(leaves.width > leaves.length, np.pi / 2, 0.0)
    angle = np.where(bits(turned, 0, 8) < 0.8, along, np.pi * bits(turned, 8, 8))
    striped = np.array([s for *_, s, _ in CROPS])[crop] * farm * leaves.resolved
    speckled = np.where(farm, np.array([s for *_, s in CROPS])[crop], 0.10)
    f = np.float32
    return Looks(
        colour.astype(f), speckled.astype(f), striped.astype(f), np.cos(angle).astype(f), np.sin(angle).astype(f),
        town.astype(f), (leaves.kind == WILD).astype(f), np.clip(-6.0 * leaves.density, 0.0, 1.0).astype(f),
        _build(leaves),
    )  # fmt: skip


def _build(leaves: Leaves) -> Buildings:
    """Put a house on each plot, a hall on large ones, and a farmstead on a few fields."""
    width, length = leaves.width, leaves.length
    h = mix(leaves.hash + np.uint32(0x7F4A7C15))
    town = leaves.kind == TOWN
    least, most = np.minimum(width, length), np.maximum(width, length)
    plot = town & (least > _LEAST_PLOT_M) & (most < 3 * HALL_M) & leaves.resolved
    vacant = bits(h, 0, 8) < np.where(leaves.density > 0.3, 0.06, 0.16)
    roadside = (leaves.sides >= LANE).any(axis=0)
    farmstead = (
        (leaves.kind == FARM)
        & (bits(h, 0, 8) < 0.14)
        & (least > 90.0)
        & (least < 700.0)
        & leaves.resolved
        & roadside
    )
    hall = plot & (least > HALL_M)
    ridge_x = np.where(width > 1.15 * length, True, np.where(length > 1.15 * width, False, bits(h, 8, 1) > 0))
    a, b = 10.5 + 6.5 * bits(h, 9, 6) + 8.0 * farmstead, 7.0 + 3.5 * bits(h, 15, 5) + 4.0 * farmstead
    wide, deep = np.where(ridge_x, a, b), np.where(ridge_x, b, a)
    wide = np.where(hall, 0.62 * width, np.minimum(wide, width - 8.0))
    deep = np.where(hall, 0.58 * length, np.minimum(deep, length - 8.0))
    setback = np.where(farmstead, 14.0, np.where(hall, 8.0, 5.5))
    x0 = leaves.x0 + _along(width, wide, setback, bits(h, 20, 6), farmstead)
    y0 = leaves.y0 + _along(length, deep, setback, bits(h, 26, 6), farmstead)
    kind = mix(h)
    roof = np.where(
        hall,
        np.array(_HALL_ROOFS, dtype=np.float32).T[:, (kind & np.uint32(3)).astype(np.intp)],
        np.array(_ROOFS, dtype=np.float32).T[:, (kind & np.uint32(7)).astype(np.intp)],
    )
    pitch = np.where(hall, 0.0, 0.17).astype(np.float32)
    return Buildings(x0, x0 + wide, y0, y0 + deep, (plot & ~vacant) | farmstead, roof, wide >= deep, pitch)


def _along(room: Array, size: Array, setback: Array, r: Array, near_side: Array) -> Array:
    """Choose how far from a piece's edge its building starts."""
    slack = np.maximum(room - size - 2 * setback, 0.0)
    start = np.minimum(setback, np.maximum(0.5 * (room - size), 0.0))
    return np.asarray(start + slack * np.where(near_side, np.where(r > 0.5, 0.985 + 0.015 * r, 0.015 * r), r))
