"""Fields, towns and the roads between them: one recursive division of a gently bent plane, and how its pieces look.

The plane is the Mercator plane displaced by the region's ``warp`` splines. Its squares of level `ROOT` are
bounded by main roads and are divided in two again and again, where a hash says, each time across the other axis. A
dividing line is a road, a lane, a track or a hedge by the size of what it divides, so lesser roads end at greater ones.
Near a town's centre the division goes on to blocks and plots. Crops, yards and houses follow from a piece's hash, size
and climate, and are worked out once for a whole division.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .climate import RURAL_PER_SETTLED, dryness, settled
from .lattice import WORLD_M, Array, LatticeWindow, bits, cell_hash, mix, salt
from .region import COARSE, coarse_fields
from .samples import ScatteredPositions, shared

BORDER, HEDGE, TRACK, LANE, ROAD, MAIN = range(6)
HALF_WIDTH_M = (0.0, 2.5, 1.6, 3.2, 5.0, 8.0)

FARM, WILD, TOWN = range(3)
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
_WALLS = (
    (232, 228, 218),
    (226, 210, 180),
    (208, 188, 154),
    (214, 180, 132),
    (196, 196, 192),
    (184, 140, 116),
    (216, 194, 180),
    (194, 200, 188),
)
_OF_THE_ROOF = 0.25
"""Share of a roof's colour in that of its walls."""
_LEAST_PLOT_M, HALL_M = 15.0, 46.0
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


def wall_colours(hashes: Array, roof: Array) -> Array:
    """Colours of the walls below roofs (3, n) on pieces of some hashes (n,), in full light; (3, n)."""
    kind = mix(_own(hashes))
    paint = np.array(_WALLS, dtype=np.float32).T[:, (kind >> np.uint32(3) & np.uint32(7)).astype(np.intp)]
    return np.asarray(paint + (roof - paint) * np.float32(_OF_THE_ROOF))


def _own(hashes: Array) -> Array:
    """Hashes of the buildings on pieces."""
    return mix(hashes + np.uint32(0x7F4A7C15))


def _build(leaves: Leaves) -> Buildings:
    """Put a house on each plot, a hall on large ones, and a farmstead on a few fields."""
    width, length = leaves.width, leaves.length
    h = _own(leaves.hash)
    town = leaves.kind == TOWN
    least, most = np.minimum(width, length), np.maximum(width, length)
    plot = town & (least > _LEAST_PLOT_M) & (most < 3 * HALL_M) & leaves.resolved
    vacant = bits(h, 0, 8) < np.where(leaves.density > 0.3, 0.06, 0.16)
    roadside = (leaves.sides >= LANE).any(axis=0)
    farmstead = (
        (leaves.kind == FARM) & (bits(h, 0, 8) < 0.14) & (least > 90.0) & (least < 700.0) & leaves.resolved & roadside
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

    roots: LatticeWindow
    cuts: list[Array]
    first: list[Array]
    leaves: Leaves
    looks: Looks


def _towns(seed: int, roots: LatticeWindow, least_m: float) -> Towns:
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
        near = (bits(h, 24, 8) < share) & (x > -radius) & (x < width + radius) & (y > -radius) & (y < length + radius)
        x, y, radius, h = x[near], y[near], radius[near], h[near]
        if x.size:
            keep = _climate(seed, roots, x, y)[0] > 0.25 + 0.5 * bits(mix(h + np.uint32(77)), 0, 8)
            parts.append((x[keep], y[keep], radius[keep]))
    return Towns(*(np.concatenate(part) for part in zip(*parts)))


def _climate(seed: int, roots: LatticeWindow, x: Array, y: Array) -> tuple[Array, Array]:
    """Share of settled land, and dryness, at points given in metres from the block's corner."""
    # The plane's bend is small against the 39 km cells of climate, so it is left out here.
    u, v = (roots.i0 + x / ROOT_M) / (1 << ROOT), (roots.j0 + y / ROOT_M) / (1 << ROOT)
    samples = ScatteredPositions(0, 0, 0, u, v)
    window = samples.cells(COARSE).support()
    fields = coarse_fields(seed, window)
    share, dry = settled(fields).astype(np.float32), dryness(fields).astype(np.float32)
    return samples.spline(share, window), samples.spline(dry, window)


def _root_squares(seed: int, roots: LatticeWindow) -> dict[str, Array]:
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


def divide(seed: int, roots: LatticeWindow, pixel_m: float) -> Division:
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
def whole_division(seed: int, roots: LatticeWindow) -> Division:
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
