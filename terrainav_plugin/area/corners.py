"""Changes to the corners, holes and parts of polygons. No widgets."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from qgis.core import QgsPointXY

from ...core.errors import InvalidInput
from ...core.mission.areas.area import Area, Box, Points, Polygon, Polygons, Position
from ..compat import POLYGON
from ..i18n import tr
from .outline import Corner, area_rings, move_latitude, polygon_geometry

#: Fewest corners of a ring.
LEAST_CORNERS = 3
#: Number of decimals of degrees, about a centimetre on the ground: finer than pointing, and shown in the entries.
DECIMALS = 7


def as_polygons(area: Area) -> Polygon | Polygons | None:
    """An area as polygons; None for points, and for boxes that span 180° or more."""
    if isinstance(area, Box):
        if area.span_deg >= 180.0:
            return None
        west, south, east, north = area.edges_deg
        return Polygon((((west, south), (east, south), (east, north), (west, north)),))
    return None if isinstance(area, Points) else area


def pointed(lon_deg: float, lat_deg: float) -> Position:
    """Position of the pointer, rounded to `DECIMALS`."""
    return round(lon_deg, DECIMALS), round(lat_deg, DECIMALS)


def move_corner(area: Polygon | Polygons, corner: Corner, dlat_deg: float, dlon_deg: float) -> Polygon | Polygons:
    """Area with one corner moved by degrees, within the limits of `move_latitude`."""

    def move(ring: list[Position]) -> None:
        lon, lat = ring[corner.at]
        ring[corner.at] = pointed(lon + dlon_deg, move_latitude(lat, dlat_deg))

    return _changed(area, corner, move)


def insert_corner(area: Polygon | Polygons, corner: Corner, lon_deg: float, lat_deg: float) -> Polygon | Polygons:
    """Area with a new corner on the edge after ``corner``."""

    def add(ring: list[Position]) -> None:
        ring.insert(corner.at + 1, pointed(nearest_turn(lon_deg, ring[corner.at][0]), lat_deg))

    return _changed(area, corner, add)


def without_corner(area: Polygon | Polygons, corner: Corner) -> Polygon | Polygons:
    """Area without one corner.

    Raises
    ------
    InvalidInput
        The ring has only three corners, or the outline would cross itself.
    """
    if len(area_rings(area)[corner.part][corner.ring]) <= LEAST_CORNERS:
        raise InvalidInput(tr("a polygon needs at least 3 corners"))
    return checked(area, _changed(area, corner, lambda ring: ring.pop(corner.at)))


def cut_hole(area: Polygon | Polygons, hole: Polygon) -> Polygon | Polygons:
    """Area with a hole in it.

    Raises
    ------
    InvalidInput
        The hole is not inside a polygon, or it overlaps another hole.
    """
    shapes = area_rings(area)
    for rings in shapes:
        (ring,) = _on_turn_of(rings, hole.rings)
        if polygon_geometry(rings).contains(polygon_geometry([ring])):
            rings.append(ring)
            return checked(area, _area(shapes))
    raise InvalidInput(tr("a hole must lie inside the area"))


def without_hole(area: Polygon | Polygons, part: int, hole: int) -> Polygon | Polygons:
    """Area without one hole; ``hole`` is its index among the rings of the polygon, from 1."""
    shapes = area_rings(area)
    del shapes[part][hole]
    return _area(shapes)


def join_polygon(area: Polygon | Polygons, polygon: Polygon) -> Polygon | Polygons:
    """Area with another polygon, merged with the polygons that it overlaps."""
    shapes, outline = [], [list(ring) for ring in polygon.rings]
    for rings in area_rings(area):
        joined = _joined(rings, _on_turn_of(rings, outline))
        if joined is None:
            shapes.append(rings)
        else:
            outline = joined
    return _area([*shapes, outline])


def without_polygon(area: Polygons, part: int) -> Polygon | Polygons:
    """Area without the polygon of index ``part``."""
    shapes = area_rings(area)
    del shapes[part]
    return _area(shapes)


def find_polygon(area: Polygon | Polygons, lon_deg: float, lat_deg: float) -> tuple[int, int] | None:
    """Index of the polygon that contains a place, and of the hole (from 1; 0 for none); None outside all polygons."""
    for part, rings in enumerate(area_rings(area)):
        west = min(lon for lon, _ in rings[0])
        at = QgsPointXY(west + (lon_deg - west) % 360.0, lat_deg)
        if not polygon_geometry(rings[:1]).contains(at):
            continue
        holes = (number for number, ring in enumerate(rings) if number and polygon_geometry([ring]).contains(at))
        return part, next(holes, 0)
    return None


def checked(before: Polygon | Polygons, after: Polygon | Polygons) -> Polygon | Polygons:
    """Return the area after a change.

    Raises
    ------
    InvalidInput
        Outlines cross that did not cross before the change.
    """
    if is_sound(before) and not is_sound(after):
        raise InvalidInput(tr("the outline would cross itself"))
    return after


def is_sound(area: Polygon | Polygons) -> bool:
    """Whether no outline crosses itself or another of the same polygon."""
    return all(polygon_geometry(rings).isGeosValid() for rings in area_rings(area))


def _changed(
    area: Polygon | Polygons, corner: Corner, change: Callable[[list[Position]], object]
) -> Polygon | Polygons:
    shapes = area_rings(area)
    change(shapes[corner.part][corner.ring])
    return _area(shapes)


def _area(shapes: Sequence[Sequence[Sequence[Position]]]) -> Polygon | Polygons:
    parts = tuple(Polygon(tuple(tuple(ring) for ring in rings)) for rings in shapes)
    return parts[0] if len(parts) == 1 else Polygons(parts)


def _joined(rings: list[list[Position]], others: list[list[Position]]) -> list[list[Position]] | None:
    """Rings of the union of two polygons; None if they do not overlap."""
    one, other = polygon_geometry(rings), polygon_geometry(others)
    # Polygons overlap if they share more than a square micrometre on the ground (in square degrees).
    if one.intersection(other).area() <= 1e-22:
        return None
    joined = one.combine(other)
    if joined.isNull() or joined.type() != POLYGON:
        return None
    polygons = joined.asMultiPolygon() if joined.isMultipart() else [joined.asPolygon()]
    if len(polygons) != 1:
        return None
    return [[(corner.x(), corner.y()) for corner in ring[:-1]] for ring in polygons[0]]


def _on_turn_of(rings: Sequence[Sequence[Position]], others: Sequence[Sequence[Position]]) -> list[list[Position]]:
    """The rings ``others``, shifted by whole turns to be near ``rings``."""
    turn = nearest_turn(others[0][0][0], rings[0][0][0]) - others[0][0][0]
    return [[(lon + turn, lat) for lon, lat in ring] for ring in others]


def nearest_turn(lon_deg: float, other_deg: float) -> float:
    """Longitude shifted by whole turns, to be as near as possible to another longitude."""
    return lon_deg - 360.0 * round((lon_deg - other_deg) / 360.0)
