"""Buildings of a vector layer, standing on the ground."""

from __future__ import annotations

import math
import threading
from collections import Counter, OrderedDict
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers, expand_counts
from ..geodesy.covered_roofs import with_covered
from ..geodesy.ellipsoid import WGS84
from ..geodesy.local import geocentric
from ..geodesy.raytracing.surface import Surface
from ..geodesy.raytracing.tracing import ElevationModel
from ..geodesy.triangles import FLOOR, NO_TRIANGLES, ROOF, SKIRT_M, Triangles
from ..vectors.features import Features
from ..vectors.layer import VectorLayer
from .heights import LEVEL_M, Value, read_colour, read_direction_deg, read_length_m, read_number
from .roofs import FLAT, NEAREST, PITCH_DEG, SHAPES, Roof, Solid, build, pitched_height_m
from .triangulation import open_ring, triangulate

#: Where the height of a building comes from, in `FootprintBuildings.survey`; `NO_BUILDING` for other features.
WITH_HEIGHT, WITH_LEVELS, BY_DEFAULT, NO_BUILDING = range(4)
#: Zoom of the Web-Mercator tiles, about 600 m wide, that are read at a time.
_ZOOM = 16
#: Most tiles that are read without asking first whether features reach into them.
_FEW_TILES = 64
#: Triangles kept in memory.
_MOST_TRIANGLES = 2_000_000
#: Share of an outline that its parts cover, from which they replace it.
_COVERED = 0.9
#: Points along either side of an outline's box by which that share is measured.
_SAMPLES = 24
#: Height of what counts as higher than all.
_HIGHEST_M = 9000.0
#: Examples of unread values.
_EXAMPLES = 5
_HEIGHTS = ("height", "HEIGHT", "Height", "building:height", "building_height", "measuredHeight", "bldg_height")
_FIELDS = (
    "building", "min_height", "building:levels", "building:min_level", "roof:height", "roof:levels", "roof:shape",
    "roof:direction", "roof:orientation", "roof:angle", "building:part", "building:colour", "roof:colour",
)  # fmt: skip
#: Plaster, brick, concrete, wood and stone.
_WALLS = ((222, 211, 190), (203, 186, 160), (164, 104, 84), (150, 148, 143), (142, 112, 82), (190, 182, 170))
_ROOFS = ((128, 124, 120), (150, 84, 66), (104, 102, 104))


@dataclass(frozen=True)
class BuildingOptions:
    """How buildings are read.

    Parameters
    ----------
    height_field : str
        Field with heights; empty: the usual ones.
    default_height_m : float
        Height of buildings without height and levels.
    seed : int
        Chooses the colours.
    datum, height_unit : str
        Vertical datum and unit of absolute heights, as in `elevation.datum`; empty: those that the file states.
    height_offset_m : float
        Added to absolute heights whose datum is not known to PROJ here.
    """

    height_field: str = ""
    default_height_m: float = 6.0
    seed: int = 0
    datum: str = ""
    height_unit: str = ""
    height_offset_m: float = 0.0


@dataclass
class BuildingCounts:
    """Buildings read so far, by where their heights come from, and what was changed or left out."""

    with_height: int = 0
    with_levels: int = 0
    by_default: int = 0
    lowered_min_heights: int = 0
    lowered_roofs: int = 0
    flat_instead: int = 0
    replaced: int = 0
    without_ground: int = 0
    not_solid: int = 0
    unread: Counter[str] = field(default_factory=Counter)
    unknown_roofs: Counter[str] = field(default_factory=Counter)
    examples: dict[str, list[str]] = field(default_factory=dict)

    def add_unread(self, name: str, value: Value) -> None:
        """Count a value that could not be read, and keep it as one of a few examples."""
        self.unread[name] += 1
        kept = self.examples.setdefault(name, [])
        if str(value) not in kept and len(kept) < _EXAMPLES:
            kept.append(str(value))


class _Footprint(NamedTuple):
    """Polygon of a feature, in degrees and in metres from its first vertex."""

    row: int
    origin_deg: Floats
    per_deg: Floats
    rings: list[Floats]

    @property
    def degrees(self) -> list[Floats]:
        """Rings as longitude and latitude."""
        return [ring / self.per_deg + self.origin_deg for ring in self.rings]


class _Tile(NamedTuple):
    """Triangles of a tile, with the solids they are of, whose boxes (west, south, east, north) and sizes follow."""

    triangles: Triangles
    solid: Numbers
    boxes_deg: Floats
    size_m: Floats
    owners: frozenset[tuple[int, int]]


class FootprintBuildings:
    """Solids over the footprints of a layer (a `FaceModel`), read by tiles.

    A building belongs to the tile of its first vertex, and a part to that of its outline.

    Parameters
    ----------
    layer : VectorLayer
    ground : ElevationModel
    options : BuildingOptions
    """

    def __init__(self, layer: VectorLayer, ground: ElevationModel, options: BuildingOptions | None = None) -> None:
        self.options = options or BuildingOptions()
        self.title, self.attribution, self.fields = layer.title, layer.attribution, layer.fields
        self.counts = BuildingCounts()
        self.count = layer.count
        self.warnings: tuple[str, ...] = ()
        self._layer, self._ground = layer, ground
        heights = (self.options.height_field,) if self.options.height_field else _HEIGHTS
        self._heights = tuple(name for name in heights if name in layer.fields)
        self._fields = (*self._heights, *(name for name in _FIELDS if name in layer.fields))
        self._tiles: OrderedDict[tuple[int, int], _Tile] = OrderedDict()
        self._counted: set[tuple[int, int]] = set()
        self._lock = threading.Lock()

    @property
    def listed(self) -> int:
        """Greatest number of a building: all are in the file."""
        return self.count

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:
        """Triangles of the buildings whose boxes meet the bounding box of positions, but for small ones."""
        west, east = float(np.min(lon_deg)), float(np.max(lon_deg))
        south, north = float(np.min(lat_deg)), float(np.max(lat_deg))
        (left, top), (right, bottom) = _tile_of(west, north), _tile_of(east, south)
        inside = self._tiles_with_features(left, top, right, bottom)
        owners = sorted(set(inside).union(*(self._tile(*one).owners for one in inside)))
        found = []
        for one in owners:
            tile = self._tile(*one)
            w, s, e, n = tile.boxes_deg.T
            meets = (w <= east) & (e >= west) & (s <= north) & (n >= south) & (tile.size_m >= least_m)
            found.append(tile.triangles if meets.all() else tile.triangles.take(np.flatnonzero(meets)))
        return Triangles.joined(found)

    def _tiles_with_features(self, left: int, top: int, right: int, bottom: int) -> list[tuple[int, int]]:
        """Tiles of a range; of large ones, towards the horizon, without parts that no feature reaches into."""
        across, down = right - left + 1, bottom - top + 1
        if across * down <= _FEW_TILES:
            return [(x, y) for x in range(left, right + 1) for y in range(top, bottom + 1)]
        (west, _, _, north), (_, south, east, _) = _tile_box(left, top), _tile_box(right, bottom)
        if not self._layer.count_in(west, south, east, north):
            return []
        if across >= down:
            middle = left + across // 2
            parts = (left, top, middle - 1, bottom), (middle, top, right, bottom)
        else:
            middle = top + down // 2
            parts = (left, top, right, middle - 1), (left, middle, right, bottom)
        return [tile for part in parts for tile in self._tiles_with_features(*part)]

    def survey(
        self, west_deg: float, south_deg: float, east_deg: float, north_deg: float, most: int = -1
    ) -> tuple[Features, NDArray[np.uint8]]:
        """Read the features of a box without placing them, and where their heights come from; they are counted.

        Parameters
        ----------
        west_deg, south_deg, east_deg, north_deg, most
            As for `VectorLayer.features`.
        """
        features = self._layer.features(west_deg, south_deg, east_deg, north_deg, self._fields, most=most)
        sources = np.full(len(features.number), NO_BUILDING, np.uint8)
        for row in sorted({one.row for one in _footprints(features)}):
            sources[row] = self._stated_height({name: column[row] for name, column in features.values.items()})[0]
        return features, sources

    def _tile(self, x: int, y: int) -> _Tile:
        """Tile of a place, from memory or made."""
        key = x, y
        with self._lock:
            if key in self._tiles:
                self._tiles.move_to_end(key)
                return self._tiles[key]
            kept = self.counts
            if key in self._counted:
                self.counts = BuildingCounts()
            try:
                tile = self._make(x, y)
            finally:
                if key in self._counted:
                    self.counts = kept
            self._counted.add(key)
            self._tiles[key] = tile
            while len(self._tiles) > 1 and sum(len(one.triangles) for one in self._tiles.values()) > _MOST_TRIANGLES:
                self._tiles.popitem(last=False)
            return tile

    def _make(self, x: int, y: int) -> _Tile:
        """Read the buildings of a tile and place them."""
        box = _tile_box(x, y)
        near = _footprints(self._layer.features(*box, fields=self._fields))
        own = [one for one in near if _tile_of(*one.origin_deg) == (x, y)]
        owners = frozenset(_tile_of(*one.origin_deg) for one in near)
        if not own:
            return _Tile(NO_TRIANGLES, np.empty(0, np.int64), np.empty((0, 4)), np.empty(0), owners)
        ends = np.concatenate([one.degrees[0] for one in own])
        (west, south), (east, north) = ends.min(axis=0).tolist(), ends.max(axis=0).tolist()
        features = self._layer.features(west, south, east, north, fields=self._fields)
        near = _footprints(features)
        chosen = self._without_replaced(features, near, (x, y))
        tile = self._placed(features, chosen, owners)
        own_ids = {id(one) for one, _ in chosen}
        others = [one for one in near if _tile_of(*one.origin_deg) != (x, y) and id(one) not in own_ids]
        others = [one for one in others if _overlaps(one, tile.boxes_deg)]
        return tile._replace(triangles=_with_covered(tile.triangles, tile.solid, others))

    def _without_replaced(
        self, features: Features, near: list[_Footprint], key: tuple[int, int]
    ) -> list[tuple[_Footprint, int]]:
        """Footprints of a tile with their instances: parts have their outline's, and replace it where they cover it."""
        is_part = features.values.get("building:part", (None,) * len(features.number))
        outlines = [one for one in near if is_part[one.row] in (None, "", "no")]
        parts = [one for one in near if is_part[one.row] not in (None, "", "no")]
        boxes = np.array([[*one.degrees[0].min(axis=0), *one.degrees[0].max(axis=0)] for one in outlines])
        homes: dict[int, list[_Footprint]] = {}
        found = []
        for part in parts:
            home = _home(part, outlines, boxes) if outlines else None
            if home is not None:
                homes.setdefault(home, []).append(part)
            elif _tile_of(*part.origin_deg) == key:
                found.append((part, int(features.number[part.row])))
        for k, outline in enumerate(outlines):
            if _tile_of(*outline.origin_deg) != key:
                continue
            number, its = int(features.number[outline.row]), homes.get(k, [])
            if its and _covered_share(outline, its) >= _COVERED:
                self.counts.replaced += 1
            else:
                found.append((outline, number))
            found += [(part, number) for part in its]
        return found

    def _placed(
        self, features: Features, chosen: list[tuple[_Footprint, int]], owners: frozenset[tuple[int, int]]
    ) -> _Tile:
        """Solids of footprints on the ground, as triangles."""
        if not chosen:
            return _Tile(NO_TRIANGLES, np.empty(0, np.int64), np.empty((0, 4)), np.empty(0), owners)
        ends = np.concatenate([one.degrees[0] for one, _ in chosen])
        surface = self._ground.surface(ends[:, 1], ends[:, 0], 0.0)
        lowest = lowest_ground_m(surface, [one.degrees for one, _ in chosen])
        parts, boxes, sizes = [], [], []
        for (one, instance), base in zip(chosen, lowest.tolist()):
            if not math.isfinite(base):
                self.counts.without_ground += 1
                continue
            values = {name: column[one.row] for name, column in features.values.items()}
            solid, bottom = self._solid(one, values)
            if solid is None:
                self.counts.not_solid += 1
                continue
            parts.append(self._triangles(one, solid, base, bottom, instance, values))
            degrees = one.degrees[0]
            box = [*degrees.min(axis=0), *degrees.max(axis=0)]
            boxes.append(np.broadcast_to(box, (len(parts[-1]), 4)))
            sizes.append(np.full(len(parts[-1]), float(np.ptp(solid.points_m, axis=0).max())))
        if not parts:
            return _Tile(NO_TRIANGLES, np.empty(0, np.int64), np.empty((0, 4)), np.empty(0), owners)
        owner = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
        return _Tile(Triangles.joined(parts), owner, np.concatenate(boxes), np.concatenate(sizes), owners)

    def _triangles(
        self, one: _Footprint, solid: Solid, base_m: float, bottom_m: float, instance: int, values: dict[str, Value]
    ) -> Triangles:
        """Triangles of a solid on the ground; what touches it has no underside, and walls that go on below it."""
        up = solid.points_m[:, 2].copy()
        keep = np.ones(len(solid.kind), np.bool_)
        if bottom_m <= 0.0:
            keep = solid.kind != FLOOR
            up[len(up) // 2 :] -= SKIRT_M
        place = solid.points_m[:, :2] / one.per_deg + one.origin_deg
        corners = geocentric(place[:, 1], place[:, 0], up + base_m)[solid.triangles[keep]]
        kind, (wall, roof) = solid.kind[keep], plain_colours(instance, self.options.seed)
        wall = read_colour(values.get("building:colour")) or wall
        roof = read_colour(values.get("roof:colour")) or roof
        colour = np.where((kind == ROOF)[:, None], roof, wall).astype(np.uint8)
        return Triangles(corners, kind, np.full(len(kind), instance, np.int64), colour, kind == ROOF)

    def _solid(self, one: _Footprint, values: dict[str, Value]) -> tuple[Solid | None, float]:
        """Solid of a footprint in metres above its lowest ground, and the height of its underside."""
        counts, ring = self.counts, one.rings[0]
        shape = self._shape(values)
        across = values.get("roof:orientation") == "across"
        rise = self._read("roof:height", values)
        if rise is None:
            roof_levels = self._read("roof:levels", values)
            angle = self._read("roof:angle", values)
            rise = roof_levels * LEVEL_M if roof_levels and shape != FLAT else None
            if rise is None:
                angle = angle if angle is not None and 0.0 < angle < 85.0 else PITCH_DEG
                rise = pitched_height_m(ring, shape, across, angle)
        stated = rise if "roof:height" in values and values["roof:height"] not in (None, "") else None
        source, height = self._stated_height(values)
        if source == WITH_LEVELS and shape != FLAT:
            height += rise
        bottom = self._read("min_height", values)
        if bottom is None:
            bottom = (self._read("building:min_level", values) or 0.0) * LEVEL_M
        if bottom >= height:
            counts.lowered_min_heights += 1
            bottom = 0.0
        bottom = max(bottom, 0.0)
        if shape != FLAT and stated is not None and stated > height - bottom:
            counts.lowered_roofs += 1
        rise = min(rise, height - bottom) if stated is not None else min(rise, 0.5 * (height - bottom))
        direction = read_direction_deg(values.get("roof:direction"))
        roof = Roof(shape, rise, math.nan if direction is None else direction, across)
        solid, asked = build(one.rings, bottom, height, roof)
        counts.flat_instead += solid is not None and not asked
        return solid, bottom

    def _stated_height(self, values: dict[str, Value]) -> tuple[int, float]:
        """Where the height of a building comes from, and the height, without a roof on levels; counted."""
        height, levels = self._height(values), self._read("building:levels", values)
        if height is not None and height > 0.0:
            self.counts.with_height += 1
            return WITH_HEIGHT, height
        if levels is not None and levels > 0.0:
            self.counts.with_levels += 1
            return WITH_LEVELS, levels * LEVEL_M
        self.counts.by_default += 1
        return BY_DEFAULT, self.options.default_height_m

    def _height(self, values: dict[str, Value]) -> float | None:
        """Height as the first field that has one states it."""
        for name in self._heights:
            height = self._read(name, values)
            if height is not None:
                return height
        return None

    def _shape(self, values: dict[str, Value]) -> str:
        """Shape of the roof; unknown ones are counted and flat, like them the nearest are counted."""
        value = values.get("roof:shape")
        text = "" if value is None else str(value).strip().lower()
        if text in ("", *SHAPES):
            return text or FLAT
        self.counts.unknown_roofs[text] += 1
        return NEAREST.get(text, FLAT)

    def _read(self, name: str, values: dict[str, Value]) -> float | None:
        """Number of a field, counted where it cannot be read."""
        value = values.get(name)
        if value is None or value == "":
            return None
        is_count = "level" in name or name == "roof:angle"
        number = read_number(value) if is_count else read_length_m(value)
        most = _HIGHEST_M / LEVEL_M if "level" in name else _HIGHEST_M
        if number is None or abs(number) > most:
            self.counts.add_unread(name, value)
            return None
        return number


def plain_colours(instance: int, seed: int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    """Colours of the walls and the roof of a building for which the file has none."""
    mixed = (instance * 2654435761 + seed * 40503) >> 4
    return _WALLS[mixed % len(_WALLS)], _ROOFS[mixed // 7 % len(_ROOFS)]


def lowest_ground_m(surface: Surface, footprints: list[list[Floats]]) -> Floats:
    """Lowest ground along the boundaries of footprints, rings (n, 2) of longitude and latitude; NaN without ground.

    Heights are bilinear between pixel centres: quadratic along an edge within a cell, so their least value is exact.
    """
    rings = [(k, ring) for k, one in enumerate(footprints) for ring in one]
    starts = np.concatenate([ring for _, ring in rings])
    ends = np.concatenate([np.roll(ring, -1, axis=0) for _, ring in rings])
    owner = np.repeat([k for k, _ in rings], [len(ring) for _, ring in rings])
    a = np.stack(surface.position(starts[:, 1], starts[:, 0]), axis=-1)
    b = np.stack(surface.position(ends[:, 1], ends[:, 0]), axis=-1)
    edge, t = [np.arange(len(a)), np.arange(len(a))], [np.zeros(len(a)), np.ones(len(a))]
    for axis in (0, 1):
        low, high = np.minimum(a, b)[:, axis], np.maximum(a, b)[:, axis]
        count = np.maximum(np.floor(high) - np.ceil(low) + 1, 0).astype(np.int64)
        which, number = expand_counts(count)
        line = np.ceil(low)[which] + number
        run = (b - a)[which, axis]
        edge.append(which)
        t.append(np.clip((line - a[which, axis]) / np.where(run == 0.0, 1.0, run), 0.0, 1.0))
    edges, along = np.concatenate(edge), np.concatenate(t)
    order = np.lexsort((along, edges))
    edges, along = edges[order], along[order]

    def heights(which: Numbers, at: Floats) -> Floats:
        place = a[which] + at[:, None] * (b - a)[which]
        return surface.heights(place[:, 0], place[:, 1])

    ends_m = heights(edges, along)
    least = np.full(len(footprints), np.inf)
    np.minimum.at(least, owner[edges], ends_m)
    same: Flags = edges[1:] == edges[:-1]
    which, t0, t1, h0, h1 = edges[:-1][same], along[:-1][same], along[1:][same], ends_m[:-1][same], ends_m[1:][same]
    middle = heights(which, 0.5 * (t0 + t1))
    curve, slope = 2.0 * (h0 + h1 - 2.0 * middle), 4.0 * middle - 3.0 * h0 - h1
    s = np.where(curve > 0.0, -slope / np.where(curve > 0.0, 2.0 * curve, 1.0), 0.0)
    inner = np.where((s > 0.0) & (s < 1.0), h0 + s * (slope + s * curve), h0)
    np.minimum.at(least, owner[which], inner)
    return least


def _overlaps(one: _Footprint, boxes_deg: Floats) -> bool:
    """Whether a footprint's box overlaps any of some boxes (n, 4)."""
    low, high = one.degrees[0].min(axis=0), one.degrees[0].max(axis=0)
    return bool(((boxes_deg[:, :2] < high) & (boxes_deg[:, 2:] > low)).all(axis=1).any())


def _with_covered(triangles: Triangles, solid: Numbers, others: list[_Footprint]) -> Triangles:
    """Triangles of a tile whose covered roofs do not show the imagery.

    Footprints ``others`` of other tiles, whose heights are not known, count as higher.
    """
    covers = [NO_TRIANGLES.corners_m]
    for one in others:
        lon, lat = np.concatenate(one.degrees).T
        covers.append(geocentric(lat, lon, _HIGHEST_M)[triangulate(one.rings)])
    corners = np.concatenate(covers)
    count = len(corners)
    above = Triangles(
        corners,
        np.full(count, ROOF, np.uint8),
        np.zeros(count, np.int64),
        np.zeros((count, 3), np.uint8),
        np.zeros(count, np.bool_),
    )
    found = with_covered(Triangles.joined([triangles, above]), np.append(solid, np.full(count, -1)))
    return found.take(np.arange(len(triangles)))


def _tile_of(lon_deg: float, lat_deg: float) -> tuple[int, int]:
    """Tile of a place; columns go on beyond the antimeridian."""
    v = 0.5 - math.asinh(math.tan(math.radians(lat_deg))) / (2.0 * math.pi)
    return math.floor((lon_deg / 360.0 + 0.5) * 2**_ZOOM), math.floor(v * 2**_ZOOM)


def _tile_box(x: int, y: int) -> tuple[float, float, float, float]:
    """West, south, east and north of a tile, degrees."""
    north, south = (math.degrees(math.atan(math.sinh(2.0 * math.pi * (0.5 - row / 2**_ZOOM)))) for row in (y, y + 1))
    west, east = ((column / 2**_ZOOM - 0.5) * 360.0 for column in (x, x + 1))
    return west, south, east, north


def _footprints(features: Features) -> list[_Footprint]:
    """Polygons of buildings, those of several parts one by one."""
    found = []
    places = np.column_stack([features.lon_deg, features.lat_deg])
    values = features.values
    # Where a layer has OpenStreetMap's key for buildings, its other areas are parks, woods and the like.
    tags = [values[name] for name in ("building", "building:part") if name in values and "building" in values]
    for row in np.flatnonzero(np.asarray(features.kind) == 0).tolist():
        if tags and all(column[row] in (None, "", "no") for column in tags):
            continue
        for part in range(features.feature_starts[row], features.feature_starts[row + 1]):
            span = range(features.part_starts[part], features.part_starts[part + 1])
            rings = [places[features.ring_starts[k] : features.ring_starts[k + 1]] for k in span]
            origin, lat = rings[0][0], float(rings[0][0, 1])
            east = math.radians(float(WGS84.normal_radius_m(np.asarray(lat)))) * math.cos(math.radians(lat))
            per_deg = np.array([east, math.radians(float(WGS84.meridional_radius_m(np.asarray(lat))))])
            found.append(_Footprint(row, origin, per_deg, [open_ring((ring - origin) * per_deg) for ring in rings]))
    return found


def _inside(points_deg: Floats, one: _Footprint) -> Flags:
    """Whether points (n, 2), longitude and latitude, lie inside a footprint."""
    inside = np.zeros(len(points_deg), np.bool_)
    for ring in one.degrees:
        after = np.roll(ring, -1, axis=0)
        for (x0, y0), (x1, y1) in zip(ring.tolist(), after.tolist()):
            if y0 != y1:
                spans = (y0 > points_deg[:, 1]) != (y1 > points_deg[:, 1])
                inside ^= spans & (points_deg[:, 0] < x0 + (points_deg[:, 1] - y0) * (x1 - x0) / (y1 - y0))
    return inside


def _samples(one: _Footprint) -> Floats:
    """Points (n, 2) inside a footprint, on a regular grid."""
    low, high = one.degrees[0].min(axis=0), one.degrees[0].max(axis=0)
    steps = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    x, y = np.meshgrid(*(low + steps[:, None] * (high - low)).T)
    grid = np.column_stack([x.ravel(), y.ravel()])
    return grid[_inside(grid, one)]


def _home(part: _Footprint, outlines: list[_Footprint], boxes: Floats) -> int | None:
    """Outline that has the greatest share of a part, at least half; None without any."""
    points = _samples(part)
    low, high = part.degrees[0].min(axis=0), part.degrees[0].max(axis=0)
    meets = (boxes[:, :2] <= high).all(axis=1) & (boxes[:, 2:] >= low).all(axis=1)
    shares = [(int(_inside(points, outlines[k]).sum()), -k) for k in np.flatnonzero(meets).tolist()]
    most, k = max(shares, default=(0, 0))
    return -k if 2 * most >= len(points) > 0 else None


def _covered_share(outline: _Footprint, parts: list[_Footprint]) -> float:
    """Share of an outline that parts cover."""
    points = _samples(outline)
    covered = np.zeros(len(points), np.bool_)
    for part in parts:
        covered |= _inside(points, part)
    return float(covered.mean()) if len(points) else 0.0
