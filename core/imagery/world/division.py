"""Fields, towns and the roads between them: one recursive division of a gently bent plane.

The plane is the Mercator plane displaced by the region's ``warp`` splines. Its squares of level `ROOT` are
bounded by main roads and are divided in two again and again, where a hash says, each time across the other axis. A
dividing line is a road, a lane, a track or a hedge by the size of what it divides, so lesser roads end at greater ones.
Near a town's centre the division goes on to blocks and plots.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .climate import RURAL_PER_SETTLED, dryness, settled
from .lattice import WORLD_M, Array, Window, bits, cell_hash, mix, salt
from .leaves import BORDER, FARM, HEDGE, LANE, MAIN, ROAD, TOWN, TRACK, WILD, Leaves, Looks, looks
from .region import COARSE, coarse_fields
from .samples import Points
from .shared import shared

ROOT = 13
"""Main roads bound squares of this level: 4.9 km."""

_LEFT, _RIGHT, _TOP, _BOTTOM = range(4)
_MAX_DEPTH = 22
_TOWN_LATTICES = (  # level, share of the lattice's points with a town, least and largest radius in m
    (10, 0.55, 1800.0, 5200.0),
    (13, 0.60, 260.0, 1500.0),
    (15, 0.10, 110.0, 300.0),
)


ROOT_M = WORLD_M / (1 << ROOT)
_LEAST_PX = 3.0
"""Pieces are divided while the halves are wider than this."""

WHOLE_ZOOM = 14
"""From this zoom on a tile touches few squares, which are divided whole and remembered."""


@dataclass(frozen=True)
class Towns:
    """Towns around a block.

    Centres in metres of the bent plane from the block's corner and radii, each of shape (n,).
    """

    x: Array
    y: Array
    radius: Array

    def density(self, x: Array, y: Array) -> Array:
        """How far inside a town points are: 1 at a centre, 0 at the edge, negative outside."""
        out = np.full(x.shape, -1.0)
        for cx, cy, r in zip(self.x, self.y, self.radius):
            d = np.sqrt((x - cx) ** 2 + (y - cy) ** 2)
            np.maximum(out, 1.0 - d / r, out=out)
        return out


@dataclass(frozen=True)
class Division:
    """Root squares divided to their leaves.

    Step *n* cuts the pieces of depth *n* across axis ``n % 2`` at ``cuts[n]`` (infinite: not cut); the part
    before the cut
    is piece ``first[n]`` of the next depth, the part after it the piece that follows.
    """

    roots: Window
    cuts: list[Array]
    first: list[Array]
    leaves: Leaves
    looks: Looks


def _towns(seed: int, roots: Window, least_m: float) -> Towns:
    """Find the towns that reach into a block of root squares."""
    width, length = roots.columns * ROOT_M, roots.rows * ROOT_M
    parts: list[tuple[Array, Array, Array]] = [(np.zeros(0), np.zeros(0), np.zeros(0))]
    for level, share, least, largest in _TOWN_LATTICES:
        if largest < least_m:
            continue
        scale = 2.0 ** (level - ROOT)
        cell = ROOT_M / scale
        reach = int(np.ceil(largest / cell))
        i0, j0 = int(np.floor(roots.i0 * scale)) - reach, int(np.floor(roots.j0 * scale)) - reach
        i1 = int(np.ceil((roots.i0 + roots.columns) * scale)) + reach
        j1 = int(np.ceil((roots.j0 + roots.rows) * scale)) + reach
        i, j = np.meshgrid(np.arange(i0, i1 + 1), np.arange(j0, j1 + 1))
        h = cell_hash(salt(seed, 2, level), level, i, j)
        x, y = (i / scale - roots.i0) * ROOT_M, (j / scale - roots.j0) * ROOT_M
        if level > ROOT:
            x, y = x + cell * bits(h, 0, 8), y + cell * bits(h, 8, 8)
        radius = least + (largest - least) * bits(h, 16, 8).astype(np.float64) ** 2.5
        near = (
            (bits(h, 24, 8) < share)
            & (x > -radius)
            & (x < width + radius)
            & (y > -radius)
            & (y < length + radius)
        )
        x, y, radius, h = x[near], y[near], radius[near], h[near]
        if x.size:
            keep = _climate(seed, roots, x, y)[0] > 0.25 + 0.5 * bits(mix(h + np.uint32(77)), 0, 8)
            parts.append((x[keep], y[keep], radius[keep]))
    return Towns(*(np.concatenate(part) for part in zip(*parts)))


def _climate(seed: int, roots: Window, x: Array, y: Array) -> tuple[Array, Array]:
    """Share of settled land, and dryness, at points given in metres from the block's corner."""
    # The plane's bend is small against the 39 km cells of climate, so it is left out here.
    u, v = (roots.i0 + x / ROOT_M) / (1 << ROOT), (roots.j0 + y / ROOT_M) / (1 << ROOT)
    samples = Points(0, 0, 0, u, v)
    window = samples.cells(COARSE).support()
    fields = coarse_fields(seed, window)
    share, dry = settled(fields).astype(np.float32), dryness(fields).astype(np.float32)
    return samples.spline(share, window), samples.spline(dry, window)


def _root_squares(seed: int, roots: Window) -> dict[str, Array]:
    i, j = (a.ravel() for a in np.broadcast_arrays(*roots.indices()))
    x0, y0 = (i - roots.i0) * ROOT_M, (j - roots.j0) * ROOT_M
    share, dry = _climate(seed, roots, x0 + ROOT_M / 2, y0 + ROOT_M / 2)
    return {
        "x0": x0, "x1": x0 + ROOT_M, "y0": y0, "y1": y0 + ROOT_M,
        "hash": cell_hash(salt(seed, 3), ROOT, i, j), "sides": np.full((4, i.size), MAIN, dtype=np.int8),
        "kind": np.full(i.size, FARM, dtype=np.int8), "limit": np.full(i.size, 300.0),
        "settled": share, "dry": dry,
        "density": np.full(i.size, -1.0), "resolved": np.ones(i.size, dtype=bool),
    }  # fmt: skip


def divide(seed: int, roots: Window, pixel_m: float) -> Division:
    """Divide a block of root squares into pieces of a few pixels; wholly if the pixel is 0."""
    least_m = _LEAST_PX * pixel_m
    nodes = _root_squares(seed, roots)
    towns = _towns(seed, roots, least_m)
    cuts: list[Array] = []
    first: list[Array] = []
    idle = 0
    for depth in range(_MAX_DEPTH):
        split = _decide(nodes, depth, towns, least_m)
        idle = 0 if split.any() else idle + 1
        if idle == 2:
            break
        nodes, cut, slot = _split(nodes, split, depth & 1)
        cuts.append(cut)
        first.append(slot)
    del nodes["limit"]
    leaves = Leaves(**nodes)
    return Division(roots, cuts, first, leaves, looks(leaves, pixel_m))


@shared(24)
def whole_division(seed: int, roots: Window) -> Division:
    """Divide a block of root squares to the last plot."""
    return divide(seed, roots, 0.0)


def _decide(n: dict[str, Array], depth: int, towns: Towns, least_m: float) -> Array:
    """Say which pieces are divided at this depth; settle what they are."""
    width, length = n["x1"] - n["x0"], n["y1"] - n["y0"]
    side, other = (width, length) if depth & 1 == 0 else (length, width)
    h = n["hash"]
    if depth == 2:
        n["kind"][bits(h, 20, 8) >= RURAL_PER_SETTLED * n["settled"]] = WILD
    if depth == 4:
        n["limit"] = 190.0 + 330.0 * bits(h, 12, 8).astype(np.float64) ** 1.5
    limit = n["limit"]
    if towns.x.size:
        density = towns.density(0.5 * (n["x0"] + n["x1"]), 0.5 * (n["y0"] + n["y1"]))
        density += 0.25 * (bits(h, 4, 8) - 0.5) * (density > -0.3)
        n["density"] = density
        reach = np.maximum(width, length)
        n["kind"] = np.where((density > 0) & (reach < 1300.0), TOWN, n["kind"]).astype(np.int8)
        plot = 27.0 + 14.0 * bits(h, 7, 6) + 40.0 * (density > 0.72)
        limit = np.where(n["kind"] == TOWN, plot, limit)
    if depth >= 2:
        limit = np.where(n["kind"] == WILD, np.inf, limit)
    wanted = (side > limit) & (side > 0.62 * other)
    n["resolved"] &= ~wanted | (side > 2 * least_m)
    return np.asarray(wanted & (side > 2 * least_m))


def _split(n: dict[str, Array], split: Array, axis: int) -> tuple[dict[str, Array], Array, Array]:
    """Cut pieces in two; return the pieces of the next depth, the cuts, and where each piece's first part is."""
    low, high = ("x0", "x1") if axis == 0 else ("y0", "y1")
    h, side = n["hash"], n[high] - n[low]
    at = n[low] + side * (0.38 + 0.24 * bits(h, 0, 10))
    line = _line(n, side, h)
    parts = 1 + split
    slot = np.cumsum(parts) - parts
    parent = np.repeat(np.arange(h.size), parts)
    child: dict[str, Array] = {k: (v[:, parent] if v.ndim == 2 else v[parent]) for k, v in n.items()}
    a = slot[split]
    b = a + 1
    child[high][a] = at[split]
    child[low][b] = at[split]
    near, far = (_RIGHT, _LEFT) if axis == 0 else (_BOTTOM, _TOP)
    child["sides"][near, a] = line[split]
    child["sides"][far, b] = line[split]
    child["hash"][a] = mix(h[split] + np.uint32(0x9E3779B9))
    child["hash"][b] = mix(h[split] + np.uint32(0x51ED270B))
    return child, np.where(split, at, np.inf), slot


def _line(n: dict[str, Array], side: Array, h: Array) -> Array:
    """Choose what runs along a dividing line, by the length that it divides."""
    r = bits(h, 24, 8)
    line = np.where(r < 0.22, HEDGE, np.where(r < 0.36, TRACK, BORDER))
    line = np.where(
        side > 480, np.where(r < 0.3, LANE, np.where(r < 0.6, TRACK, np.where(r < 0.85, HEDGE, BORDER))), line
    )
    line = np.where(side > 1100, np.where(r < 0.75, LANE, TRACK), line)
    line = np.where(side > 2200, ROAD, line)
    line = np.where(n["kind"] == TOWN, np.where(side > 105, LANE, BORDER), line)
    return line.astype(np.int8)
