"""Buildings of a CityJSON file, at their own heights or standing on the ground."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..elevation.datum import UNITS_M, Datum
from ..errors import InvalidInput, Message
from ..geodesy.covered_roofs import with_covered
from ..geodesy.local import geocentric
from ..geodesy.projections import transformation
from ..geodesy.raytracing.tracing import ElevationModel
from ..geodesy.reference import read_reference
from ..geodesy.skins import Skin
from ..geodesy.triangles import ROOF, SKIRT_M, WALL, Triangles
from .buildings import BuildingOptions, lowest_ground_m, plain_colours
from .cityjson import CityModel

#: Degrees of latitude and longitude of the tiles that are placed at a time.
_TILE_DEG = 0.005
#: Distance of a vertex from the middle of its building, degrees, beyond which it is taken for wrong: 11 km.
_WIDEST_DEG = 0.1
#: Height above or below the ellipsoid from which a vertex is taken for wrong.
_HIGHEST_M = 20_000.0
#: Triangles kept in memory.
_MOST_TRIANGLES = 2_000_000
#: Treatments of a file's heights.
FILE, GROUND = "file", "ground"


@dataclass
class PlacingCounts:
    """Buildings placed so far.

    Attributes
    ----------
    placed : int
    raised, sunk : int
        Those whose lowest vertex is more than `SKIRT_M` above the lowest ground along their walls, which are made
        longer, and those whose highest vertex is below it. Always 0 for buildings set on the ground.
    without_ground : int
        Those without ground below: left out if they are set on the ground, otherwise at their heights.
    """

    placed: int = 0
    raised: int = 0
    sunk: int = 0
    without_ground: int = 0


class CityBuildings:
    """Buildings of a CityJSON file, a `FaceModel`; they are placed by tiles when asked for.

    Walls go on to `SKIRT_M` below the lowest ground along them, or below the building if that is lower.

    Parameters
    ----------
    model : CityModel
    ground : ElevationModel
    options : BuildingOptions
    heights : str
        `FILE`: the file's heights over its vertical datum. `GROUND`: the lowest vertex of each building stands on the
        lowest ground along its walls. Empty: the file's if PROJ can transform them, or the options have a datum or an
        offset, else the ground.

    Raises
    ------
    InvalidInput
        No vertex lies where its reference system is defined; or the file's heights are asked for and PROJ cannot
        transform them.
    """

    def __init__(
        self, model: CityModel, ground: ElevationModel, options: BuildingOptions | None = None, heights: str = ""
    ) -> None:
        self.options = options or BuildingOptions()
        self.title, self.attribution = model.title, ""
        self.model, self.count, self.listed = model, model.counts.buildings, model.counts.buildings
        self.counts = PlacingCounts()
        self._ground = ground
        self._lat_deg, self._lon_deg = _places(model)
        datum, offset_m, self.heights, self._reason = _datum(model, self.options, heights)
        up = model.points[:, 2] * datum.unit_m + offset_m
        known = np.isfinite(self._lat_deg)
        if datum.code:
            up[known] += datum.heights_m(self._lat_deg[known], self._lon_deg[known])
        self._up_m = up
        is_near = _near(model, self._lat_deg, self._lon_deg) & (np.abs(up[model.faces.triangles]) < _HIGHEST_M).all(
            axis=1
        )
        self._triangles = np.flatnonzero(is_near)
        if not len(self._triangles):
            raise InvalidInput("{0}: has no buildings with surfaces", model.title)
        #: Triangles with vertices where the reference system is not defined, or far from the rest of their building.
        self.out_of_range = len(model.faces.triangles) - len(self._triangles)
        self._place_rows = np.cumsum(model.faces.texture >= 0) - 1
        self._index()
        self._tiles: OrderedDict[tuple[int, int], tuple[Triangles, Numbers]] = OrderedDict()
        self._counted: set[tuple[int, int]] = set()
        self._lock = threading.Lock()

    def _index(self) -> None:
        """Boxes of buildings (west, south, east, north), their sizes and tiles."""
        faces = self.model.faces
        self._numbers, starts = np.unique(faces.instance[self._triangles], return_index=True)
        corners = faces.triangles[self._triangles]

        def ends(values: Floats) -> tuple[Floats, Floats]:
            at = values[corners]
            return np.minimum.reduceat(at.min(axis=1), starts), np.maximum.reduceat(at.max(axis=1), starts)

        (west, east), (south, north) = ends(self._lon_deg), ends(self._lat_deg)
        low, high = ends(self._up_m)
        self._boxes = np.stack([west, south, east, north], axis=1)
        metres = np.radians(1.0) * 6_371_000.0
        across = (east - west) * metres * np.cos(np.radians(south))
        self._size_m = np.maximum.reduce([across, (north - south) * metres, high - low])
        middle = np.stack([0.5 * (west + east), 0.5 * (south + north)], axis=1)
        self._keys = np.floor(middle / _TILE_DEG).astype(np.int64)
        self._firsts = np.append(starts, len(self._triangles))

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was repaired, replaced or left out so far, for users."""
        read, placed = self.model.counts, self.counts
        repaired = read.cleaned_surfaces + read.crossing_surfaces + read.turned_shells
        words = (
            (self._reason, self._reason),
            (read.broken_surfaces, Message("{0:,} surfaces are missing, as they cannot be read", read.broken_surfaces)),
            (self.out_of_range, Message("{0:,} triangles are missing, as they lie far off", self.out_of_range)),
            (read.without_faces, Message("{0:,} buildings without surfaces are left out", read.without_faces)),
            (repaired, Message("{0:,} surfaces and solids were repaired", repaired)),
            (
                read.missing_textures,
                Message("{0:,} of {1:,} textures are missing: plain", read.missing_textures, read.textures),
            ),
            (
                read.unplaced_surfaces,
                Message("{0:,} surfaces have one colour, as their texture is not placed", read.unplaced_surfaces),
            ),
            (placed.raised, Message("{0:,} buildings are above the ground: their walls are longer", placed.raised)),
            (placed.sunk, Message("{0:,} buildings are below the ground", placed.sunk)),
            (
                placed.without_ground if self.heights == GROUND else 0,
                Message("{0:,} buildings without ground below are left out", placed.without_ground),
            ),
        )
        return tuple(Message("{0}: {1}", self.title, text) for count, text in words if count)

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:
        """Triangles of the buildings whose boxes meet the bounding box of positions, but for small ones."""
        west, east = float(np.min(lon_deg)), float(np.max(lon_deg))
        south, north = float(np.min(lat_deg)), float(np.max(lat_deg))
        w, s, e, n = self._boxes.T
        turn = 360.0 * np.rint((0.5 * (west + east) - 0.5 * (w + e)) / 360.0)
        meets = (w + turn <= east) & (e + turn >= west) & (s <= north) & (n >= south) & (self._size_m >= least_m)
        wanted = self._numbers[meets]
        found = []
        for x, y in np.unique(self._keys[meets], axis=0).tolist():
            triangles, numbers = self._tile((x, y))
            which = np.isin(numbers, wanted)
            found.append(triangles if which.all() else triangles.take(which))
        return Triangles.joined(found)

    def _tile(self, key: tuple[int, int]) -> tuple[Triangles, Numbers]:
        """Triangles of a tile's buildings, from memory or made."""
        with self._lock:
            kept = self._tiles.get(key)
            if kept is not None:
                self._tiles.move_to_end(key)
                return kept
            made = self._place(np.flatnonzero((self._keys == key).all(axis=1)), key not in self._counted)
            self._counted.add(key)
            self._tiles[key] = made, made.instance
            while len(self._tiles) > 1 and sum(len(one) for one, _ in self._tiles.values()) > _MOST_TRIANGLES:
                self._tiles.popitem(last=False)
            return self._tiles[key]

    def _place(self, buildings: Numbers, is_counted: bool) -> Triangles:
        """Triangles of buildings, on the ground."""
        faces, counts = self.model.faces, PlacingCounts()
        order = np.searchsorted(faces.feet_instance, self._numbers[buildings], "left")
        until = np.searchsorted(faces.feet_instance, self._numbers[buildings], "right")
        which = [self._triangles[self._firsts[k] : self._firsts[k + 1]] for k in buildings.tolist()]
        feet = [
            edges[np.isin(edges, faces.triangles[own]).all(axis=1)]
            for edges, own in zip([faces.feet[a:b] for a, b in zip(order.tolist(), until.tolist())], which)
        ]
        lines = [edges if len(edges) else _edges(faces.triangles[own]) for edges, own in zip(feet, which)]
        ends = np.concatenate([edges.ravel() for edges in lines])
        surface = self._ground.surface(self._lat_deg[ends], self._lon_deg[ends], 0.0)
        places = np.stack([self._lon_deg, self._lat_deg], axis=1)
        lowest = lowest_ground_m(surface, [list(places[edges]) for edges in lines])
        parts = []
        for own, edges, ground_m in zip(which, feet, lowest.tolist()):
            up = self._up_m[faces.triangles[own]]
            low, high, raise_m = float(up.min()), float(up.max()), 0.0
            counts.without_ground += not math.isfinite(ground_m)
            if self.heights == GROUND:
                if not math.isfinite(ground_m):
                    continue
                raise_m = ground_m - low
            counts.placed += 1
            foot = low + raise_m
            counts.raised += foot > ground_m + SKIRT_M
            counts.sunk += high + raise_m < ground_m
            parts += self._building(own, edges, raise_m, min(foot, ground_m if math.isfinite(ground_m) else foot))
        if is_counted:
            self.counts = PlacingCounts(*(a + b for a, b in zip(vars(self.counts).values(), vars(counts).values())))
        placed = Triangles.joined(parts)
        return with_covered(placed, np.arange(len(placed)))

    def _skin(self, own: Numbers) -> Skin | None:
        """Textures of triangles; None if none has any."""
        texture = self.model.faces.texture[own]
        has_texture = texture >= 0
        if not has_texture.any():
            return None
        places = np.zeros((len(own), 3, 2))
        places[has_texture] = self.model.faces.texture_places[self._place_rows[own[has_texture]]]
        return Skin(texture, places, self.model.textures)

    def _building(self, own: Numbers, feet: Numbers, raise_m: float, foot_m: float) -> list[Triangles]:
        """Faces of a building, without the floor it stands on, and its walls below."""
        faces = self.model.faces
        number = int(faces.instance[own[0]])
        own = own[~faces.on_ground[own]]
        wall, roof = plain_colours(number, self.options.seed)
        kind, given = faces.kind[own], faces.colour[own]
        plain = np.where((kind == ROOF)[:, None], roof, wall)
        colour = np.where(given < 0, plain, given).astype(np.uint8)
        corners = self._corners(faces.triangles[own], self._up_m[faces.triangles[own]] + raise_m)
        found = [Triangles(corners, kind, faces.instance[own], colour, kind == ROOF, self._skin(own))]
        if len(feet):
            top = self._up_m[feet] + raise_m
            bottom = np.minimum(top, foot_m) - SKIRT_M
            (a, b), (at, bt), (al, bl) = feet.T, top.T, bottom.T
            quads = np.concatenate([np.stack([a, b, b], axis=1), np.stack([a, b, a], axis=1)])
            up = np.concatenate([np.stack([at, bt, bl], axis=1), np.stack([at, bl, al], axis=1)])
            walls = colour[kind == WALL]
            below = np.broadcast_to(walls[0] if len(walls) else np.array(wall, np.uint8), (len(quads), 3))
            shape = len(quads)
            found.append(
                Triangles(
                    self._corners(quads, up),
                    np.full(shape, WALL, np.uint8),
                    np.full(shape, number, np.int64),
                    below,
                    np.zeros(shape, np.bool_),
                )
            )
        return found

    def _corners(self, triangles: Numbers, up_m: Floats) -> Floats:
        return geocentric(self._lat_deg[triangles], self._lon_deg[triangles], up_m)


def _edges(triangles: Numbers) -> Numbers:
    """Edges (3t, 2) of triangles (t, 3)."""
    edges: Numbers = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    return edges


def _places(model: CityModel) -> tuple[Floats, Floats]:
    """Latitudes and longitudes of a model's points; NaN where its reference system is not defined."""
    crs = read_reference(model.crs)
    level = crs.sub_crs_list[0] if crs.is_compound else crs
    code = level.to_epsg()
    to = transformation(f"EPSG:{code}" if code else str(level.to_wkt()))
    lat, lon = to.inverse(model.points[:, 0], model.points[:, 1])
    good = np.isfinite(lat) & np.isfinite(lon) & (np.abs(lat) < 90.0)
    if not good[model.faces.triangles].all(axis=1).any():
        raise InvalidInput(
            "{0}: no vertex lies where {1} is defined",
            model.title,
            crs.name,
            remedy=Message("write the right system after the name, such as {0}#crs=EPSG:7415", model.title),
        )
    # Continuous longitudes, also of a city across the antimeridian.
    first = lon[np.flatnonzero(good)[0]]
    lon = lon - 360.0 * np.rint((np.where(good, lon, first) - first) / 360.0)
    return np.where(good, lat, np.nan), np.where(good, lon, np.nan)


def _near(model: CityModel, lat_deg: Floats, lon_deg: Floats) -> Flags:
    """Which triangles have all corners near the middle of their building."""
    corners = model.faces.triangles
    near: Flags = np.isfinite(lat_deg[corners]).all(axis=1)
    at = np.flatnonzero(near)
    lat, lon = lat_deg[corners[at]], lon_deg[corners[at]]
    numbers, starts = np.unique(model.faces.instance[at], return_index=True)
    owner = np.searchsorted(numbers, model.faces.instance[at])
    middle = [[float(np.median(part)) for part in np.split(values, starts[1:])] for values in (lat, lon)]
    lat_m, lon_m = (np.array(values)[owner][:, None] for values in middle)
    scale = np.cos(np.radians(lat_m))
    near[at] = (np.maximum(np.abs(lat - lat_m), np.abs(lon - lon_m) * scale) <= _WIDEST_DEG).all(axis=1)
    return near


def _datum(model: CityModel, options: BuildingOptions, heights: str) -> tuple[Datum, float, str, str]:
    """Datum of a model's heights, what is added to them, what is done with them, and why if nobody asked for it."""
    unit_m = UNITS_M[options.height_unit] if options.height_unit else 0.0
    crs = read_reference(model.crs)
    stated = Datum.from_crs(str(crs.to_wkt()), "m" if unit_m else "", model.title)
    if not crs.is_compound and len(crs.axis_info) < 3:
        stated = None
    if stated is not None and unit_m:
        stated = Datum(stated.code, math.copysign(unit_m, stated.unit_m))
    plain = stated or Datum("", unit_m or 1.0)
    if heights == GROUND:
        return Datum("", plain.unit_m), 0.0, GROUND, ""
    reason = Message("buildings are set on the ground, as it states no vertical datum")
    try:
        if stated is not None:
            if stated.code:
                stated.check()
            return stated, 0.0, FILE, ""
    except InvalidInput as missing:
        if heights == FILE and not (options.datum or options.height_offset_m):
            raise
        reason = Message("buildings are set on the ground ({0})", missing)
    if options.datum or options.height_offset_m:
        return Datum.named(options.datum or "ellipsoid", plain.unit_m), options.height_offset_m, FILE, ""
    return (plain, 0.0, FILE, "") if heights == FILE else (Datum("", plain.unit_m), 0.0, GROUND, reason)
