"""Buildings of CityJSON files (versions 1.0, 1.1, 2.0, and CityJSONSeq) as triangles in the file's own coordinates."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers
from ..errors import InvalidInput, Message
from ..geodesy.ellipsoid import WGS84
from ..geodesy.reference import read_reference
from ..geodesy.triangles import FLOOR, ROOF, SKIRT_M, WALL
from ..storage.files import open_foreign, read_limited
from ..text.plain import one_line
from ..text.safe_json import parse_json
from .appearance import Appearance, ImageTexture
from .surfaces import cut, is_closed, rim, volume_m3

#: Largest file, which takes ten times as much memory; tiles of national data sets have up to some 100 MB.
MAX_CITY_BYTES = 256 << 20
#: Least sine of a roof's or a floor's slope from the vertical; what is steeper is a wall.
_LEVEL = 0.1
#: Coordinates from which vertices are taken for wrong: no system reaches there, in feet either.
_FARTHEST = 1e9
#: Examples of objects with faults.
_EXAMPLES = 5
_VERSION = re.compile(r"(1\.0|1\.1|2\.0)(\.\d+)?")
#: What only CityJSON has; the type may be at the end of the file.
_TYPE = re.compile(rb'"type"\s*:\s*"CityJSON(?:Feature)?"|"CityObjects"\s*:')
_LOD = re.compile(r"\d(\.\d+)?")

#: City objects that stand as faces; others, such as roads, water, plants and relief, are counted.
_BUILDINGS = {"Building", "BuildingPart", "BuildingInstallation", "BuildingConstructiveElement"}
_OTHERS = {"Bridge", "BridgePart", "BridgeInstallation", "BridgeConstructiveElement", "OtherConstruction"}
_WHOLE = {"Building", "BuildingPart", "Bridge", "BridgePart", "OtherConstruction"}
#: Levels of nested lists around a surface, by type of geometry.
_DEPTHS = {"MultiSurface": 1, "CompositeSurface": 1, "Solid": 2, "MultiSolid": 3, "CompositeSolid": 3}
#: Kinds by semantics, and whether the surface stands on the ground; others by their slope.
_KINDS = {
    "RoofSurface": ROOF, "OuterFloorSurface": ROOF, "WallSurface": WALL, "Window": WALL, "Door": WALL,
    "ClosureSurface": WALL, "GroundSurface": FLOOR, "OuterCeilingSurface": FLOOR,
}  # fmt: skip
_INSIDE = {"InteriorWallSurface", "CeilingSurface", "FloorSurface"}
_UNKNOWN = 255
_NO_PLACES = np.empty((0, 3, 2))


@dataclass
class CityCounts:
    """What a file has, and what was repaired or left out.

    Attributes
    ----------
    buildings : int
        Buildings, bridges and other constructions; each has a number, from 1 in the file's order.
    other_objects : Counter
        City objects that are no faces, by type.
    lods : Counter
        Buildings by the level of detail of their faces.
    surfaces, broken_surfaces, empty_surfaces, inside_surfaces : int
        Surfaces that are faces; those that are missing, as they cannot be read or lack vertices; those without area, of
        which nothing is missing; and those of rooms.
    cleaned_surfaces, off_plane_surfaces, crossing_surfaces : int
        Surfaces with repeated vertices or holes without area, with vertices off their plane, and with rings that cross.
    open_shells, turned_shells, cavities : int
        Shells of solids that are not closed, that faced inward, and that lie within solids.
    without_faces, flat_only, without_parent, other_geometries : int
        Buildings without surfaces, and those of them that are footprints only; parts without a building, which are
        buildings of their own; geometries that have no surfaces or are templates.
    merged_vertices, broken_vertices, broken_objects, broken_semantics : int
        Vertices at one place, and those without coordinates; objects and geometries that cannot be read, and geometries
        whose semantics do not fit.
    textures, missing_textures, unplaced_surfaces : int
        Textures of surfaces, those whose images are missing or cannot be read, and surfaces whose places in their
        texture are missing or cannot be read.
    examples : dict of str to list
        Names of some objects by the fault's name.
    """

    buildings: int = 0
    other_objects: Counter[str] = field(default_factory=Counter)
    lods: Counter[str] = field(default_factory=Counter)
    surfaces: int = 0
    broken_surfaces: int = 0
    empty_surfaces: int = 0
    inside_surfaces: int = 0
    cleaned_surfaces: int = 0
    off_plane_surfaces: int = 0
    crossing_surfaces: int = 0
    open_shells: int = 0
    turned_shells: int = 0
    cavities: int = 0
    without_faces: int = 0
    flat_only: int = 0
    without_parent: int = 0
    other_geometries: int = 0
    merged_vertices: int = 0
    broken_vertices: int = 0
    broken_objects: int = 0
    broken_semantics: int = 0
    textures: int = 0
    missing_textures: int = 0
    unplaced_surfaces: int = 0
    examples: dict[str, list[str]] = field(default_factory=dict)

    def add(self, fault: str, name: str) -> None:
        """Count a fault of an object, and keep the object's name as one of a few examples."""
        setattr(self, fault, getattr(self, fault) + 1)
        kept = self.examples.setdefault(fault, [])
        if name not in kept and len(kept) < _EXAMPLES:
            kept.append(name)


class CityFaces(NamedTuple):
    """Faces of buildings; those of one building are neighbours.

    Attributes
    ----------
    triangles : array (t, 3)
        Indices of points; solids face outward.
    kind, instance : array (t,)
        As in `Triangles`.
    colour : array (t, 3) of int16
        Colour that the file gives; -1 where it gives none.
    on_ground : array (t,) of bool
        Undersides that stand on the ground.
    texture : array (t,) of int32
        Index of the texture; -1 without.
    texture_places : array (s, 3, 2)
        Where the corners of those with textures lie in them, one after the other; see `Skin`.
    feet : array (e, 2)
        Edges of triangles that stand on the ground, walls below which face outward.
    feet_instance : array (e,)
    """

    triangles: Numbers
    kind: NDArray[np.uint8]
    instance: Numbers
    colour: NDArray[np.int16]
    on_ground: Flags
    texture: NDArray[np.int32]
    texture_places: Floats
    feet: Numbers
    feet_instance: Numbers


@dataclass(frozen=True, eq=False)
class CityModel:
    """Faces of a file.

    Parameters
    ----------
    title : str
        Name of the file.
    crs : str
        Its coordinate reference system as it states it; empty if it does not.
    points : array (m, 3)
        Coordinates, easting first, in the units of the reference system.
    faces : CityFaces
    textures : tuple of ImageTexture
    counts : CityCounts
    """

    title: str
    crs: str
    points: Floats
    faces: CityFaces
    textures: tuple[ImageTexture, ...]
    counts: CityCounts


def is_cityjson(path: str) -> bool:
    """Whether a file is CityJSON, by its content."""
    try:
        with open_foreign(path) as file:
            kept = file.read(1 << 16)
            if not kept.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
                return False
            while kept:
                if _TYPE.search(kept):
                    return True
                more = file.read(1 << 22)
                # The word may lie across two pieces.
                kept = kept[-64:] + more if more else b""
    except OSError:
        pass
    return False


def read_city(path: str, crs: str = "", lod: str = "") -> CityModel:
    """Read the buildings of a file.

    Parameters
    ----------
    path : str
    crs : str
        Coordinate reference system; empty for the one that the file states.
    lod : str
        Level of detail, such as ``1.2``; where a building lacks it, the next lower one, else the next higher. Empty for
        the highest.

    Raises
    ------
    InvalidInput
        It is not CityJSON of a known version, has no faces, or states no reference system.
    """
    title = Path(path).name
    if lod and not _LOD.fullmatch(lod):
        raise InvalidInput("{0}: level of detail {1!r}: must be a number such as 2 or 1.2", title, lod)
    head, parts = _parse(path, title)
    crs = crs or _reference(head, title)
    try:
        is_geographic = read_reference(crs).is_geographic
    except InvalidInput as wrong:
        raise InvalidInput("{0}: {1}", title, wrong) from wrong
    reader = _FacesReader(lod, _scale(head, title), is_geographic)
    for part in parts:
        reader.read(part, Appearance(part.get("appearance") or head.get("appearance"), Path(path).parent))
    if not reader.found:
        raise InvalidInput("{0}: has no buildings with surfaces", title)
    faces = CityFaces(*(np.concatenate(values) for values in zip(*reader.found)))
    return CityModel(title, crs, np.concatenate(reader.points), faces, tuple(reader.textures), reader.counts)


def _reference(head: dict[str, Any], title: str) -> str:
    """Reference system that a file states: a URL, or a URN in version 1.0."""
    metadata = head.get("metadata")
    stated = metadata.get("referenceSystem") if isinstance(metadata, dict) else None
    if not isinstance(stated, str) or not stated.strip():
        raise InvalidInput(
            "{0}: states no coordinate reference system",
            title,
            remedy=Message("write it after the name, such as {0}#crs=EPSG:7415", title),
        )
    codes = re.findall(r"=https?://www\.opengis\.net/def/crs/EPSG/[\d.]+/(\d+)", stated)
    return "EPSG:" + "+".join(codes) if "crs-compound" in stated and codes else stated.strip()


def _parse(path: str, title: str) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Head of a file, and its parts with city objects and vertices: itself, or the features of a CityJSONSeq."""
    try:
        data = read_limited(path, MAX_CITY_BYTES)
        lines = data.splitlines() if b'"CityJSONFeature"' in data else [data]
        values = [_parse_line(line, k, len(lines)) for k, line in enumerate(lines, 1) if line.strip()]
    except OSError as wrong:
        raise InvalidInput("{0}: cannot be read: {1}", title, one_line(wrong.strerror or str(wrong))) from wrong
    except InvalidInput as wrong:
        raise InvalidInput("{0}: cannot be read: {1}", title, wrong) from wrong
    for k, value in enumerate(values):
        wanted = "CityJSONFeature" if k else "CityJSON"
        if not isinstance(value, dict) or value.get("type") != wanted:
            found = value.get("type") if isinstance(value, dict) else type(value).__name__
            raise InvalidInput("{0}: object {1} is of type {2!r}: must be {3}", title, k + 1, _short(found), wanted)
    version = values[0].get("version")
    if not isinstance(version, str) or not _VERSION.fullmatch(version):
        raise InvalidInput("{0}: CityJSON of version {1!r}: must be 1.0, 1.1 or 2.0", title, _short(version))
    for value in values[1:] or values:
        for name, kind in (("CityObjects", dict), ("vertices", list)):
            if not isinstance(value.get(name), kind):
                raise InvalidInput("{0}: {1!r} is missing", title, name)
    return values[0], values[1:] or values


def _parse_line(line: bytes, number: int, count: int) -> Any:
    try:
        return parse_json(line)
    except InvalidInput as wrong:
        if count == 1:
            raise
        raise InvalidInput("line {0}: {1}", number, wrong) from wrong


def _short(value: object) -> str:
    return one_line(str(value)[:40])


def _scale(head: dict[str, Any], title: str) -> tuple[Floats, Floats]:
    """Scale and translation of vertices."""
    transform = head.get("transform")
    if transform is None:
        if str(head["version"]).startswith("1.0"):
            return np.ones(3), np.zeros(3)
        raise InvalidInput("{0}: 'transform' is missing, which CityJSON has since version 1.1", title)
    found = []
    for name in ("scale", "translate"):
        values = transform.get(name) if isinstance(transform, dict) else None
        if not isinstance(values, list) or len(values) != 3 or not all(map(_is_number, values)):
            raise InvalidInput("{0}: {1!r} of 'transform' is {2}: must be three numbers", title, name, _short(values))
        found.append(np.array(values, np.float64))
    if not found[0].all():
        raise InvalidInput("{0}: 'scale' of 'transform' is {1}: must not be 0", title, _short(transform["scale"]))
    return found[0], found[1]


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


class _CitySurface(NamedTuple):
    """Triangles of a surface, and what is the same for all of them."""

    triangles: Numbers
    kind: int
    colour: tuple[int, int, int]
    stands: bool
    texture: int
    texture_places: Floats


class _Shell(NamedTuple):
    """Triangles of a shell of a solid, or of surfaces that make up none."""

    triangles: Numbers
    kind: NDArray[np.uint8]
    colour: NDArray[np.int16]
    stands: Flags
    texture: NDArray[np.int32]
    texture_places: Floats
    is_solid: bool


class _FacesReader:
    """Collects the faces of a file's parts."""

    def __init__(self, lod: str, scale: tuple[Floats, Floats], is_geographic: bool) -> None:
        self.counts = CityCounts()
        self.points: list[Floats] = []
        self.found: list[CityFaces] = []
        #: Textures of faces, numbered from 0.
        self.textures: dict[ImageTexture, int] = {}
        self._lod, (self._scale, self._shift), self._is_geographic = lod, scale, is_geographic
        self._before = 0

    def read(self, part: dict[str, Any], appearance: Appearance) -> None:
        """Read a part with vertices of its own."""
        places, same = self._vertices(part["vertices"])
        points = self._metres(places)
        families = self._families(part["CityObjects"])
        for root, members in families.items():
            self.counts.buildings += 1
            shells = self._shells(root, members, points, same, appearance)
            if shells:
                has_feet = members[0].get("type") in _BUILDINGS
                self.found.append(_faces(shells, points, self.counts.buildings, self._before, has_feet))
            else:
                self.counts.add("without_faces", root)
        self.points.append(places)
        self._before += len(places)
        self.counts.textures += len(appearance.textures)
        self.counts.unplaced_surfaces += appearance.unplaced
        self.counts.missing_textures += sum(one is None for one in appearance.textures.values())

    def _metres(self, places: Floats) -> Floats:
        """Coordinates from the first point, of which surfaces are cut; in metres if the file's are degrees."""
        if not len(places):
            return places
        metres: Floats = places - places[0]
        if not self._is_geographic:
            return metres
        cosine = np.cos(np.radians(places[0, 1]))
        per_degree = np.radians(1.0) * WGS84.a_m
        metres *= [per_degree * cosine, per_degree, 1.0]
        return metres

    def _vertices(self, values: list[Any]) -> tuple[Floats, list[int]]:
        """Different points, and the point of each vertex; -1 without coordinates."""
        try:
            raw = np.array(values, np.float64).reshape(len(values), 3)
            broken = np.zeros(len(raw), np.bool_)
        except (ValueError, TypeError):
            good = [isinstance(one, list) and len(one) == 3 and all(map(_is_number, one)) for one in values]
            raw = np.array([one if is_good else (0.0, 0.0, 0.0) for one, is_good in zip(values, good)], np.float64)
            broken = ~np.array(good, np.bool_)
        if not len(raw):
            return np.empty((0, 3)), []
        points, same = np.unique(raw, axis=0, return_inverse=True)
        broken |= ~np.isfinite(raw).all(axis=1)
        with np.errstate(over="ignore"):
            broken |= ~(np.abs(raw * self._scale + self._shift) < _FARTHEST).all(axis=1)
        raw[broken] = 0.0
        self.counts.broken_vertices += int(broken.sum())
        same = same.ravel()
        self.counts.merged_vertices += int((~broken).sum()) - len(np.unique(same[~broken]))
        placed = points * self._scale + self._shift
        return placed, np.where(broken, -1, same).tolist()

    def _families(self, objects: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
        """Buildings with their parts, in the file's order; the building itself is the first."""
        standing = {}
        for name, one in objects.items():
            kind = one.get("type") if isinstance(one, dict) else None
            if not isinstance(kind, str):
                self.counts.add("broken_objects", name)
            elif kind in _BUILDINGS or kind in _OTHERS:
                standing[name] = one
            else:
                self.counts.other_objects[kind] += 1
        homes = {name: self._home(name, standing) for name in standing}
        families: dict[str, list[dict[str, Any]]] = {name: [standing[name]] for name in standing if homes[name] == name}
        for name, home in homes.items():
            if home != name:
                families[home].append(standing[name])
        return families

    def _home(self, name: str, standing: dict[str, Any]) -> str:
        """Building of a part."""
        passed = [name]
        while True:
            parents = standing[passed[-1]].get("parents")
            known = (
                [one for one in parents if isinstance(one, str) and one in standing]
                if isinstance(parents, list)
                else []
            )
            if not known or known[0] in passed:
                # Of a circle of parents, the first by name is the building.
                home = min(passed[passed.index(known[0]) :]) if known else passed[-1]
                if known or standing[home]["type"] not in ("Building", "Bridge", "OtherConstruction"):
                    self.counts.without_parent += home == name
                return home
            passed.append(known[0])

    def _shells(
        self, root: str, members: list[dict[str, Any]], points: Floats, same: list[int], appearance: Appearance
    ) -> list[_Shell]:
        """Shells of a building and its parts, of one level of detail if all have it."""
        is_flat: list[bool] = []
        by_member = [self._geometries(root, one, is_flat) for one in members]
        if is_flat and not any(by_member):
            self.counts.add("flat_only", root)
        of_whole = {lod for one, lods in zip(members, by_member) if one["type"] in _WHOLE for lod in lods}
        chosen = self._nearest_lod(of_whole) if of_whole else None
        shells: list[_Shell] = []
        for one, lods in zip(members, by_member):
            if not lods:
                continue
            lod = chosen if chosen in lods else self._nearest_lod(set(lods))
            if lod != chosen and one is not members[0] and chosen in by_member[0]:
                # The building has the faces of this part in its own.
                if one["type"] in _WHOLE:
                    continue
            elif lod != chosen and one is members[0]:
                # Its parts have more detail, and replace it.
                continue
            for geometry in lods[lod]:
                shells += self._read_geometry(root, geometry, points, same, appearance)
        if shells:
            self.counts.lods["" if chosen is None else f"{chosen:g}"] += 1
        return shells

    def _geometries(self, root: str, one: dict[str, Any], is_flat: list[bool]) -> dict[float, list[dict[str, Any]]]:
        """Geometries with surfaces by level of detail, without footprints, which are noted."""
        lods: dict[float, list[dict[str, Any]]] = {}
        geometries = one.get("geometry") or []
        for geometry in geometries if isinstance(geometries, list) else [None]:
            if not isinstance(geometry, dict) or not isinstance(geometry.get("type"), str):
                self.counts.add("broken_objects", root)
            elif geometry["type"] not in _DEPTHS:
                self.counts.add("other_geometries", root)
            else:
                text = str(geometry.get("lod", ""))
                lod = float(text) if _LOD.fullmatch(text) else 1.0
                if lod < 1.0:
                    is_flat.append(True)
                else:
                    lods.setdefault(lod, []).append(geometry)
        return lods

    def _nearest_lod(self, lods: set[float]) -> float:
        """Level of detail to take of those that there are."""
        if not self._lod:
            return max(lods)
        wanted = float(self._lod)
        lower = [one for one in lods if one <= wanted]
        return max(lower) if lower else min(lods)

    def _read_geometry(
        self, root: str, geometry: dict[str, Any], points: Floats, same: list[int], appearance: Appearance
    ) -> list[_Shell]:
        """Shells of a geometry."""
        depth = _DEPTHS[geometry["type"]]
        semantics = geometry.get("semantics")
        kinds = semantics.get("surfaces") if isinstance(semantics, dict) else None
        values = semantics.get("values") if isinstance(semantics, dict) else None
        if semantics is not None and not (isinstance(kinds, list) and (values is None or isinstance(values, list))):
            self.counts.add("broken_semantics", root)
            kinds = None
        shells: dict[tuple[int, ...], list[_CitySurface]] = {}
        for path, rings in self._surfaces(root, geometry.get("boundaries"), depth):
            semantic = _semantic(kinds, values, path)
            if semantic in _INSIDE:
                self.counts.inside_surfaces += 1
                continue
            triangles = self._cut(root, rings, points, same)
            if len(triangles):
                shells.setdefault(path[:-1], []).append(
                    _CitySurface(
                        triangles,
                        _KINDS.get(semantic, _UNKNOWN),
                        appearance.colour(geometry, path) or (-1, -1, -1),
                        semantic == "GroundSurface",
                        *self._textured(appearance.texture(geometry, path, rings), triangles, same),
                    )
                )
        return [self._shell(root, surfaces, points, depth > 1) for surfaces in shells.values()]

    def _textured(
        self, found: tuple[ImageTexture, dict[int, tuple[float, float]]] | None, triangles: Numbers, same: list[int]
    ) -> tuple[int, Floats]:
        """Number of a surface's texture and the places of its triangles' corners; -1 and none without."""
        if found is None:
            return -1, _NO_PLACES
        texture, vertices = found
        places = {same[vertex]: place for vertex, place in vertices.items()}
        corners = np.array([places[point] for point in triangles.ravel().tolist()]).reshape(-1, 3, 2)
        return self.textures.setdefault(texture, len(self.textures)), corners

    def _surfaces(
        self, root: str, boundaries: Any, depth: int, path: tuple[int, ...] = ()
    ) -> Iterator[tuple[tuple[int, ...], list[Any]]]:
        """Surfaces of nested lists with their places; cavities of solids are counted."""
        if not isinstance(boundaries, list):
            self.counts.add("broken_objects", root)
            return
        if depth == 1:
            yield from (((*path, k), one) for k, one in enumerate(boundaries))
            return
        for k, one in enumerate(boundaries):
            if depth == 2 and k:
                # Nothing outside shows the shells of cavities.
                self.counts.cavities += 1
            else:
                yield from self._surfaces(root, one, depth - 1, (*path, k))

    def _cut(self, root: str, rings: Any, points: Floats, same: list[int]) -> Numbers:
        """Triangles of a surface; none if it cannot be read or has no area."""
        count = len(same)
        is_read = isinstance(rings, list) and bool(rings) and all(isinstance(ring, list) for ring in rings)
        if not is_read or not all(type(k) is int and 0 <= k < count and same[k] >= 0 for ring in rings for k in ring):
            self.counts.add("broken_surfaces", root)
            return np.empty((0, 3), np.int64)
        found = cut([[same[k] for k in ring] for ring in rings], points)
        if not len(found.triangles):
            self.counts.add("empty_surfaces", root)
            return found.triangles
        self.counts.surfaces += 1
        for is_so, fault in (
            (found.cleaned, "cleaned_surfaces"),
            (found.off_plane, "off_plane_surfaces"),
            (found.crosses, "crossing_surfaces"),
        ):
            if is_so:
                self.counts.add(fault, root)
        return found.triangles

    def _shell(self, root: str, surfaces: list[_CitySurface], points: Floats, is_solid: bool) -> _Shell:
        """Shell of its surfaces, turned outward if it is closed."""
        all_triangles, kinds, colours, stands, textures, all_places = zip(*surfaces)
        triangles, places = np.concatenate(all_triangles), np.concatenate(all_places)
        closed = is_closed(triangles)
        if closed and volume_m3(triangles, points) < 0.0:
            triangles, places = triangles[:, ::-1], places[:, ::-1]
            self.counts.add("turned_shells", root)
        if is_solid and not closed:
            self.counts.add("open_shells", root)
        counts = [len(one) for one in all_triangles]
        return _Shell(
            triangles,
            np.repeat(np.array(kinds, np.uint8), counts),
            np.repeat(np.array(colours, np.int16), counts, axis=0),
            np.repeat(np.array(stands, np.bool_), counts),
            np.repeat(np.array(textures, np.int32), counts),
            places,
            closed,
        )


def _semantic(kinds: Any, values: Any, path: tuple[int, ...]) -> str:
    """Semantic type of a surface; empty if it has none."""
    for place in path:
        if not isinstance(values, list) or place >= len(values):
            return ""
        values = values[place]
    if not isinstance(kinds, list) or type(values) is not int or not 0 <= values < len(kinds):
        return ""
    surface = kinds[values]
    name = surface.get("type") if isinstance(surface, dict) else None
    return name if isinstance(name, str) else ""


def _faces(shells: list[_Shell], points: Floats, instance: int, before: int, has_feet: bool) -> CityFaces:
    """Faces of a building; kinds that its semantics do not state come from slopes."""
    triangles = np.concatenate([one.triangles for one in shells])
    kind = np.concatenate([one.kind for one in shells])
    stands = np.concatenate([one.stands for one in shells])
    outward = np.repeat([one.is_solid for one in shells], [len(one.kind) for one in shells])
    corners = points[triangles]
    low, top = float(corners[..., 2].min()), corners[..., 2].max(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    up = normal[:, 2] / np.where(length > 0.0, length, 1.0)
    # What is not closed may face either way: only what lies lowest is a floor.
    down = (up < 0.0) & (outward | ((top <= low + 0.5) & bool(top.max() > low + 0.5)))
    by_slope = np.where(np.abs(up) < _LEVEL, WALL, np.where(down, FLOOR, ROOF))
    unknown = kind == _UNKNOWN
    kind = np.where(unknown, by_slope, kind).astype(np.uint8)
    stands = has_feet & (kind == FLOOR) & (stands | (unknown & (top <= low + SKIRT_M)))
    feet = _feet(triangles, kind, stands, corners, low) if has_feet else np.empty((0, 2), np.int64)
    return CityFaces(
        triangles + before,
        kind,
        np.full(len(kind), instance, np.int64),
        np.concatenate([one.colour for one in shells]),
        stands,
        np.concatenate([one.texture for one in shells]),
        np.concatenate([one.texture_places for one in shells]),
        feet + before,
        np.full(len(feet), instance, np.int64),
    )


def _feet(triangles: Numbers, kind: NDArray[np.uint8], stands: Flags, corners: Floats, low: float) -> Numbers:
    """Edges on which a building stands: the rim of its floor, or without one the lowest edges of its walls."""
    if stands.any():
        return rim(triangles[stands])
    walls = (kind == WALL) & (corners[..., 2].min(axis=1) <= low + SKIRT_M)
    if not walls.any():
        return np.empty((0, 2), np.int64)
    edges = rim(triangles[kind != FLOOR])
    lowest = np.unique(triangles[walls][corners[walls, :, 2] <= low + SKIRT_M])
    feet: Numbers = edges[np.isin(edges, lowest).all(axis=1)][:, ::-1]
    return feet
