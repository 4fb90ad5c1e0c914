"""Fields, towns and the roads between them: a recursive division of a gently bent plane, and the looks of its pieces.

The plane is the Mercator plane displaced by the region's ``warp`` splines. Its squares of level `ROOT` are bounded by
main roads and are halved again and again, across each axis in turn, at a place chosen by a hash. A dividing line is a
road, lane, track or hedge, by the size of what it divides, so that lesser roads end at greater ones. Near a town's
centre the division goes on to blocks and plots. Crops, yards and houses follow from a piece's hash, size and climate,
and are computed once for a whole division.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .climate import RURAL_PER_SETTLED, dryness, settled
from .lattice import WORLD_M, Array, LatticeWindow, bits, cell_hash, mix, salt
from .region import COARSE, coarse_fields
from .samples import ScatteredPositions, shared

#: Lines between pieces.
BORDER, HEDGE, TRACK, LANE, ROAD, MAIN = range(6)
#: Half widths of the lines, from `BORDER` to `MAIN`.
HALF_WIDTH_M = (0.0, 2.5, 1.6, 3.2, 5.0, 8.0)
#: Kinds of pieces.
FARM, WILD, TOWN = range(3)


class Crop(NamedTuple):
    """Colour of a crop, its frequency on moist and on dry land, and the strength of its stripes and its speckle."""

    colour: tuple[int, int, int]
    moist: float
    dry: float
    stripes: float
    speckle: float


_CROPS = (
    Crop((118, 132, 66), 0.16, 0.04, 0.05, 0.10),  # pasture
    Crop((86, 116, 52), 0.17, 0.05, 0.10, 0.06),  # maize
    Crop((104, 136, 62), 0.14, 0.06, 0.10, 0.06),  # young grain
    Crop((184, 162, 104), 0.13, 0.16, 0.07, 0.05),  # ripe grain
    Crop((202, 186, 136), 0.08, 0.18, 0.10, 0.06),  # stubble
    Crop((138, 114, 84), 0.10, 0.16, 0.09, 0.09),  # bare soil
    Crop((112, 92, 70), 0.06, 0.05, 0.08, 0.08),  # moist soil
    Crop((166, 146, 108), 0.05, 0.20, 0.05, 0.11),  # fallow
    Crop((70, 104, 50), 0.07, 0.06, 0.13, 0.05),  # beans
    Crop((198, 188, 82), 0.02, 0.01, 0.06, 0.05),  # rape in flower
    Crop((142, 146, 90), 0.02, 0.03, 0.05, 0.10),  # meadow
)
#: Colours of the roofs of houses.
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
#: Plots wider than this hold a hall.
_HALL_M = 46.0
#: Level of the squares that main roads bound, 4.9 km.
ROOT = 13
ROOT_M = WORLD_M / (1 << ROOT)


@dataclass(frozen=True)
class Leaves:
    """Undivided pieces: arrays of shape (n,), edges in metres of the bent plane.

    `sides` (4, n) are the lines on the left, right, top and bottom. `resolved` is false where a piece would be divided
    further if its parts were not too small to see.
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
    """A building in each piece: edges in metres of the bent plane; `there` is false if the piece has no building.

    `roof` is its colour (3, n), `ridge_x` whether the ridge runs eastward, `pitch` the difference in light between its
    sides.
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
    """Looks of pieces: float32 arrays of shape (n,); `colour` (3, n).

    `stripes` and `speckle` are strengths of textures; stripes run across the direction (`cos`, `sin`).
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
    on_moist = np.array([crop.moist for crop in _CROPS])[:, None]
    on_dry = np.array([crop.dry for crop in _CROPS])[:, None]
    return np.asarray(on_moist + (on_dry - on_moist) * dry)


def farm_mean(dry: Array) -> Array:
    """Mean colour of farmland by its dryness (n,), shape (3, n)."""
    colours = np.array([crop.colour for crop in _CROPS], dtype=np.float64)
    return np.asarray(np.einsum("cn,ck->kn", _crop_weights(dry), colours))


def looks(leaves: Leaves, pixel_m: float) -> Looks:
    """Compute the looks of pieces for a pixel size: small pieces fade into the mean of their kind."""
    h = mix(leaves.hash + np.uint32(0x2545F491))
    weights = _crop_weights(leaves.dry)
    pick = bits(h, 0, 12) * weights.sum(axis=0)
    crop = np.minimum((pick > np.cumsum(weights, axis=0)).sum(axis=0), len(_CROPS) - 1)
    farm, town = leaves.kind == FARM, leaves.kind == TOWN
    least = np.minimum(leaves.width, leaves.length)
    tone = 0.93 + 0.14 * bits(h, 12, 8)
    field = np.array([one.colour for one in _CROPS], dtype=np.float64).T[:, crop] * tone
    mean = farm_mean(leaves.dry)
    clear = leaves.resolved * (np.clip(least / pixel_m / 4.0 - 0.5, 0.0, 1.0) if pixel_m else 1.0)
    colour = mean + (field - mean) * clear
    town_mean, lawn, yard = (np.array(c)[:, None] for c in ((118, 122, 100), (106, 122, 70), (146, 140, 126)))
    lot = np.where(least > _HALL_M, yard, lawn + (yard - lawn) * bits(h, 20, 6) ** 2) * tone
    colour = np.where(town, np.where(leaves.resolved, lot, town_mean), colour)
    turned = mix(leaves.hash + np.uint32(0x6C8E9CF5))
    along = np.where(leaves.width > leaves.length, np.pi / 2, 0.0)
    angle = np.where(bits(turned, 0, 8) < 0.8, along, np.pi * bits(turned, 8, 8))
    striped = np.array([one.stripes for one in _CROPS])[crop] * farm * leaves.resolved
    speckled = np.where(farm, np.array([one.speckle for one in _CROPS])[crop], 0.10)
    f = np.float32
    return Looks(
        colour.astype(f), speckled.astype(f), striped.astype(f), np.cos(angle).astype(f), np.sin(angle).astype(f),
        town.astype(f), (leaves.kind == WILD).astype(f), np.clip(-6.0 * leaves.density, 0.0, 1.0).astype(f),
        _build(leaves),
    )  # fmt: skip


def wall_colours(hashes: Array, roof: Array) -> Array:
    """Colours (3, n), in full light, of the walls below roofs (3, n) on pieces with hashes (n,)."""
    kind = mix(_building_hashes(hashes))
    paint = np.array(_WALLS, dtype=np.float32).T[:, (kind >> np.uint32(3) & np.uint32(7)).astype(np.intp)]
    # Walls match their roof: they take a quarter of its colour.
    return np.asarray(paint + (roof - paint) * np.float32(0.25))


def _building_hashes(hashes: Array) -> Array:
    """Hashes of buildings, by those of their pieces."""
    return mix(hashes + np.uint32(0x7F4A7C15))


def _build(leaves: Leaves) -> Buildings:
    """Put a house on each plot, a hall on large ones, and a farmstead on a few fields."""
    width, length = leaves.width, leaves.length
    h = _building_hashes(leaves.hash)
    town = leaves.kind == TOWN
    least, most = np.minimum(width, length), np.maximum(width, length)
    plot = town & (least > 15.0) & (most < 3 * _HALL_M) & leaves.resolved
    vacant = bits(h, 0, 8) < np.where(leaves.density > 0.3, 0.06, 0.16)
    roadside = (leaves.sides >= LANE).any(axis=0)
    farmstead = (
        (leaves.kind == FARM) & (bits(h, 0, 8) < 0.14) & (least > 90.0) & (least < 700.0) & leaves.resolved & roadside
    )
    hall = plot & (least > _HALL_M)
    ridge_x = np.where(width > 1.15 * length, True, np.where(length > 1.15 * width, False, bits(h, 8, 1) > 0))
    a, b = 10.5 + 6.5 * bits(h, 9, 6) + 8.0 * farmstead, 7.0 + 3.5 * bits(h, 15, 5) + 4.0 * farmstead
    wide, deep = np.where(ridge_x, a, b), np.where(ridge_x, b, a)
    wide = np.where(hall, 0.62 * width, np.minimum(wide, width - 8.0))
    deep = np.where(hall, 0.58 * length, np.minimum(deep, length - 8.0))
    setback = np.where(farmstead, 14.0, np.where(hall, 8.0, 5.5))
    x0 = leaves.x0 + _building_start(width, wide, setback, bits(h, 20, 6), farmstead)
    y0 = leaves.y0 + _building_start(length, deep, setback, bits(h, 26, 6), farmstead)
    kind = mix(h)
    roof = np.where(
        hall,
        np.array(_HALL_ROOFS, dtype=np.float32).T[:, (kind & np.uint32(3)).astype(np.intp)],
        np.array(_ROOFS, dtype=np.float32).T[:, (kind & np.uint32(7)).astype(np.intp)],
    )
    pitch = np.where(hall, 0.0, 0.17).astype(np.float32)
    return Buildings(x0, x0 + wide, y0, y0 + deep, (plot & ~vacant) | farmstead, roof, wide >= deep, pitch)


def _building_start(room: Array, size: Array, setback: Array, r: Array, near_side: Array) -> Array:
    """Choose the distance from a piece's edge to its building."""
    slack = np.maximum(room - size - 2 * setback, 0.0)
    start = np.minimum(setback, np.maximum(0.5 * (room - size), 0.0))
    return np.asarray(start + slack * np.where(near_side, np.where(r > 0.5, 0.985 + 0.015 * r, 0.015 * r), r))


@dataclass(frozen=True)
class Towns:
    """Towns around a block: centres in metres of the bent plane from the block's corner, and radii, (n,) each."""

    x: Array
    y: Array
    radius: Array

    def density(self, x: Array, y: Array) -> Array:
        """Depth of points inside towns: 1 at a centre, 0 at the edge, negative outside."""
        out = np.full(x.shape, -1.0)
        for cx, cy, r in zip(self.x, self.y, self.radius):
            d = np.sqrt((x - cx) ** 2 + (y - cy) ** 2)
            np.maximum(out, 1.0 - d / r, out=out)
        return out


@dataclass(frozen=True)
class Division:
    """Root squares divided to their leaves.

    Step *n* cuts the pieces of depth *n* across axis ``n % 2`` at ``cuts[n]`` (infinite: not cut). The part before the
    cut is piece ``first[n]`` of the next depth; the part after it follows.
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
    # Level, share of the lattice's points that have a town, least and largest radius in metres.
    lattices = ((10, 0.55, 1800.0, 5200.0), (13, 0.60, 260.0, 1500.0), (15, 0.10, 110.0, 300.0))
    for level, share, least, largest in lattices:
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
    """Share of settled land, and dryness, at points in metres from the block's corner."""
    # The bend of the plane is negligible against the 39 km cells of climate.
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
    """Divide a block of root squares into pieces of a few pixels; completely if ``pixel_m`` is 0."""
    # Both halves of a piece must be wider than 3 px.
    least_m = 3.0 * pixel_m
    nodes = _root_squares(seed, roots)
    towns = _towns(seed, roots, least_m)
    cuts: list[Array] = []
    first: list[Array] = []
    idle = 0
    # Half of 22 cuts divide each axis: down to 2.4 m.
    for depth in range(22):
        divided = _choose_divided(nodes, depth, towns, least_m)
        idle = 0 if divided.any() else idle + 1
        # Neither axis has pieces left to divide.
        if idle == 2:
            break
        nodes, cut, slot = _split(nodes, divided, depth & 1)
        cuts.append(cut)
        first.append(slot)
    del nodes["limit"]
    leaves = Leaves(**nodes)
    return Division(roots, cuts, first, leaves, looks(leaves, pixel_m))


@shared(24)
def whole_division(seed: int, roots: LatticeWindow) -> Division:
    """Divide a block of root squares completely."""
    return divide(seed, roots, 0.0)


def _choose_divided(n: dict[str, Array], depth: int, towns: Towns, least_m: float) -> Array:
    """Choose which pieces to divide at this depth, and update their kinds."""
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


def _split(n: dict[str, Array], divided: Array, axis: int) -> tuple[dict[str, Array], Array, Array]:
    """Cut pieces in two; return the pieces of the next depth, the cuts, and the index of each piece's first part."""
    low, high = ("x0", "x1") if axis == 0 else ("y0", "y1")
    h, side = n["hash"], n[high] - n[low]
    at = n[low] + side * (0.38 + 0.24 * bits(h, 0, 10))
    line = _line(n, side, h)
    parts = 1 + divided
    slot = np.cumsum(parts) - parts
    parent = np.repeat(np.arange(h.size), parts)
    child: dict[str, Array] = {k: (v[:, parent] if v.ndim == 2 else v[parent]) for k, v in n.items()}
    a = slot[divided]
    b = a + 1
    child[high][a] = at[divided]
    child[low][b] = at[divided]
    # The cut is the right or bottom side of the first part, and the left or top side of the second.
    child["sides"][2 * axis + 1, a] = line[divided]
    child["sides"][2 * axis, b] = line[divided]
    child["hash"][a] = mix(h[divided] + np.uint32(0x9E3779B9))
    child["hash"][b] = mix(h[divided] + np.uint32(0x51ED270B))
    return child, np.where(divided, at, np.inf), slot


def _line(n: dict[str, Array], side: Array, h: Array) -> Array:
    """Choose the kind of a dividing line by the length that it divides."""
    r = bits(h, 24, 8)
    line = np.where(r < 0.22, HEDGE, np.where(r < 0.36, TRACK, BORDER))
    line = np.where(
        side > 480, np.where(r < 0.3, LANE, np.where(r < 0.6, TRACK, np.where(r < 0.85, HEDGE, BORDER))), line
    )
    line = np.where(side > 1100, np.where(r < 0.75, LANE, TRACK), line)
    line = np.where(side > 2200, ROAD, line)
    line = np.where(n["kind"] == TOWN, np.where(side > 105, LANE, BORDER), line)
    return line.astype(np.int8)
