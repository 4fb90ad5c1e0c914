"""Fields, towns and the roads between them: one recursive division of a gently bent plane.

The plane is the Mercator plane displaced by the region's ``warp`` splines. Its squares of level `ROOT` are
bounded by main
roads and are divided in two again and again, where a hash says, each time across the other axis. A dividing line is a
road, a lane, a track or a hedge by the size of what it divides, so lesser roads end at greater ones. Near a
town's centre
the division goes on to blocks and plots.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .climate import RURAL_PER_SETTLED, dryness, settled
from .lattice import WORLD_M, Array, Points, Samples, Window, bits, cell_hash, mix, salt
from .leaves import BORDER, FARM, HEDGE, LANE, MAIN, ROAD, TOWN, TRACK, WILD, Leaves, Looks, looks
from .region import COARSE, Region, coarse_fields

ROOT = 13
"""Main roads bound squares of this level: 4.9 km."""

_LEFT, _RIGHT, _TOP, _BOTTOM = range(4)
_FAR_M = 1e6
_MAX_DEPTH = 22
_TOWN_LATTICES = (  # level, share of the lattice's points with a town, least and largest radius in m
    (10, 0.55, 1800.0, 5200.0),
    (13, 0.60, 260.0, 1500.0),
    (15, 0.10, 110.0, 300.0),
)


_ROOT_M = WORLD_M / (1 << ROOT)
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
    width, length = roots.columns * _ROOT_M, roots.rows * _ROOT_M
    parts: list[tuple[Array, Array, Array]] = [(np.zeros(0), np.zeros(0), np.zeros(0))]
    for level, share, least, largest in _TOWN_LATTICES:
        if largest < least_m:
            continue
        scale = 2.0 ** (level - ROOT)
        cell = _ROOT_M / scale
        reach = int(np.ceil(largest / cell))
        i0, j0 = int(np.floor(roots.i0 * scale)) - reach, int(np.floor(roots.j0 * scale)) - reach
        i1 = int(np.ceil((roots.i0 + roots.columns) * scale)) + reach
        j1 = int(np.ceil((roots.j0 + roots.rows) * scale)) + reach
        i, j = np.meshgrid(np.arange(i0, i1 + 1), np.arange(j0, j1 + 1))
        h = cell_hash(salt(seed, 2, level), level, i, j)
        x, y = (i / scale - roots.i0) * _ROOT_M, (j / scale - roots.j0) * _ROOT_M
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
    u, v = (roots.i0 + x / _ROOT_M) / (1 << ROOT), (roots.j0 + y / _ROOT_M) / (1 << ROOT)
    samples = Points(0, 0, 0, u, v)
    window = samples.cells(COARSE).support()
    fields = coarse_fields(seed, window)
    share, dry = settled(fields).astype(np.float32), dryness(fields).astype(np.float32)
    return samples.spline(share, window), samples.spline(dry, window)


def _root_squares(seed: int, roots: Window) -> dict[str, Array]:
    i, j = (a.ravel() for a in np.broadcast_arrays(*roots.indices()))
    x0, y0 = (i - roots.i0) * _ROOT_M, (j - roots.j0) * _ROOT_M
    share, dry = _climate(seed, roots, x0 + _ROOT_M / 2, y0 + _ROOT_M / 2)
    return {
        "x0": x0, "x1": x0 + _ROOT_M, "y0": y0, "y1": y0 + _ROOT_M,
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


@lru_cache(maxsize=24)
def _whole(seed: int, roots: Window) -> Division:
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


def bent_plane(region: Region, samples: Samples) -> tuple[Array, Array]:
    """Return the samples' place in the bent plane, float32 metres from their tile's corner."""
    east, south = samples.local_m()
    scale = np.float32(WORLD_M)
    x = region.value("warp_x", samples)
    x *= scale
    x += east
    y = region.value("warp_y", samples)
    y *= scale
    y += south
    return x, y


class Parcels:
    """The pieces under some samples.

    `at` are their numbers among the division's leaves, `index` is each sample's among `at`. `x`, `y` are
    the samples' places in the bent plane, float32 metres from `corner`, which is the tile's.
    """

    def __init__(self, seed: int, region: Region, samples: Samples) -> None:
        self.shape = samples.shape
        self.pixel_m = samples.pixel_m
        self.x, self.y = bent_plane(region, samples)
        margin = 1e-3 + 1e-5 * 256 * samples.pixel_m
        x, y = (
            (float(self.x.min()) - margin, float(self.x.max()) + margin),
            (float(self.y.min()) - margin, float(self.y.max()) + margin),
        )
        east, south = samples.origin_m
        i0, i1 = (int(np.floor((c + east) / _ROOT_M)) for c in x)
        j0, j1 = (int(np.floor((c + south) / _ROOT_M)) for c in y)
        roots = Window(ROOT, i0, j0, i1 - i0 + 1, j1 - j0 + 1)
        whole = samples.zoom >= WHOLE_ZOOM
        self.division = _whole(seed, roots) if whole else divide(seed, roots, samples.pixel_m)
        self.corner = (i0 * _ROOT_M - east, j0 * _ROOT_M - south)
        self.index = np.zeros(self.shape, dtype=np.intp)
        self.at = self._place((x, y))
        self._distances: dict[int, Array | None] = {}

    def _place(self, box: tuple[tuple[float, float], tuple[float, float]]) -> Array:
        """Walk down the division with the samples, leaving aside what their box does not touch."""
        roots, corner = self.division.roots, self.corner
        for c, start, count, stride in (
            (self.x, corner[0], roots.columns, 1),
            (self.y, corner[1], roots.rows, roots.columns),
        ):
            for n in range(1, count):
                self.index += (c >= np.float32(start + n * _ROOT_M)) * stride
        at = np.arange(roots.rows * roots.columns)
        for depth, (cuts, first) in enumerate(zip(self.division.cuts, self.division.first)):
            axis = depth & 1
            low, high = box[axis]
            if at.size == 1:  # the common case high up in the division, without arrays
                only = int(at[0])
                where = float(cuts[only]) + corner[axis]
                if where > high or where < low:
                    at = first[only : only + 1] + int(where < low)
                    continue
            cut = cuts[at] + corner[axis]
            before, after = cut >= low, cut <= high
            both = before & after
            parts = 1 + both
            start = np.cumsum(parts) - parts
            child = first[at] + ~before
            at = np.repeat(child, parts)
            if both.any():
                at[start[both] + 1] += 1
                self._descend(start - ~before, cut.astype(np.float32), self.y if axis else self.x)
        return at

    def _descend(self, slot: Array, cut: Array, c: Array) -> None:
        if slot.size == 1:
            np.greater(c, cut[0], out=self.index, casting="unsafe")
            return
        beyond = c > cut.take(self.index, mode="clip")
        self.index = slot.take(self.index, mode="clip")
        self.index += beyond

    def leaf(self, table: Array) -> Array:
        """Return the entries of the pieces under the samples, shape (n,), of a table of all leaves."""
        out: Array = table[self.at]
        return out

    def spread(self, entries: Array) -> Array:
        """Give each sample the entry of its piece, from the entries of the pieces under the samples."""
        if entries.size == 1:
            return np.full(self.shape, entries[0])
        out: Array = entries.take(self.index, mode="clip")
        return out

    def take(self, table: Array) -> Array:
        """Give each sample its piece's entry of a table of all leaves."""
        return self.spread(table[self.at])

    def edges(self) -> tuple[Array, Array, Array, Array]:
        """Return the left, right, top and bottom edges of the pieces under the samples, float64 local metres."""
        leaves = self.division.leaves
        east, south = self.corner
        return (
            self.leaf(leaves.x0) + east, self.leaf(leaves.x1) + east,
            self.leaf(leaves.y0) + south, self.leaf(leaves.y1) + south,
        )  # fmt: skip

    def distance_m(self, line: int) -> Array | None:
        """Return each sample's distance to the nearest line of a class around its piece, or None."""
        if line not in self._distances:
            self._distances[line] = self._distance_m(line)
        return self._distances[line]

    def _distance_m(self, line: int) -> Array | None:
        there = self.division.leaves.sides[:, self.at] == line
        best: Array | None = None
        for side, edge in enumerate(self.edges()):
            if not there[side].any():
                continue
            c, sign = (self.y if side >= _TOP else self.x), np.float32(1 - 2 * (side & 1))
            table = np.where(there[side], edge, -sign * _FAR_M).astype(np.float32)
            d = c - self.spread(table)
            if sign < 0:
                np.negative(d, out=d)
            best = d if best is None else np.minimum(best, d, out=best)
        return best
