"""Read shapes of GeoJSON files, in any reference system, in degrees of WGS 84.

RFC 7946 allows only WGS 84. The specification of 2008 has a member ``crs``, which QGIS, GDAL and PostGIS still write;
it applies to everything inside its object, unless an inner object has another ``crs``. Easting or longitude comes
first, whatever the axis order of the system, as in GDAL.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...arrays import Floats, NDArray
from ...errors import InvalidInput
from ...geodesy.ellipsoid import WGS84
from ...geodesy.reference import is_code, read_reference

if TYPE_CHECKING:
    from pyproj import Transformer

#: Greatest distance on the ground, metres, between a side drawn straight in degrees and drawn straight in its system:
#: about a pixel of the sharpest imagery. At the places compared, half of it is allowed.
EDGE_TOLERANCE_M = 0.1
#: Greatest number of corners of one ring or line, including corners added to its sides.
_MOST_CORNERS = 1_000_000
#: Greatest number of characters of a name that messages show.
_SHOWN = 80


class Shape(NamedTuple):
    """A Polygon or LineString: its coordinates as in the file, and their reference system."""

    coordinates: Any
    system: System


def shapes(data: Any, kind: str, where: str) -> Iterator[Shape]:
    """Yield each shape of a kind, and each part of a multi-part shape, at any depth of features and collections.

    Parameters
    ----------
    data : object
        A GeoJSON object.
    kind : {"Polygon", "LineString"}
    where : str
        Name of the file, for messages.

    Raises
    ------
    InvalidInput
        A reference system that cannot be read.
    """
    yield from _shapes(data, kind, System(where), {})


def _shapes(data: Any, kind: str, system: System, known: dict[str, System]) -> Iterator[Shape]:
    if not isinstance(data, dict):
        return
    if "crs" in data:
        name = _name(data["crs"], system.where)
        if name not in known:
            known[name] = SystemOfFile(system.where, name)
        system = known[name]
    coordinates = _listed(data, "coordinates")
    if data.get("type") == kind and coordinates:
        yield Shape(coordinates, system)
    elif data.get("type") == f"Multi{kind}":
        yield from (Shape(part, system) for part in coordinates if part)
    for inner in (data.get("geometry"), *_listed(data, "features"), *_listed(data, "geometries")):
        yield from _shapes(inner, kind, system, known)


def _listed(data: dict[str, Any], name: str) -> list[Any]:
    """List under a name; empty for anything else, such as null."""
    value = data.get(name)
    return value if isinstance(value, list) else []


def _name(crs: Any, where: str) -> str:
    """Name of the reference system in a ``crs`` member, in any form that GDAL reads."""
    kind = crs.get("type") if isinstance(crs, dict) else None
    stated = crs.get("properties") if isinstance(crs, dict) else None
    stated = stated if isinstance(stated, dict) else {}
    kind = kind.lower() if isinstance(kind, str) else ""
    if kind in ("link", "url"):
        link = str(stated.get("href") or stated.get("url") or "")
        raise InvalidInput(
            "{0}: its crs is a link ({1}), which is not followed; must be a name such as EPSG:25832",
            where,
            link[:_SHOWN],
        )
    name = stated.get({"name": "name", "ogc": "urn"}.get(kind, ""))
    code = stated.get("code")
    if kind == "epsg" and isinstance(code, (int, str)):
        name = f"EPSG:{code}"
    if not isinstance(name, str):
        raise InvalidInput("{0}: its crs has no name; must be a name such as EPSG:25832, or left out for WGS 84", where)
    return name.strip()


class System:
    """WGS 84, the reference system of files without a ``crs``.

    Parameters
    ----------
    where : str
        Name of the file, for messages.
    """

    def __init__(self, where: str) -> None:
        self.where = where

    def degrees(self, corners: Floats) -> Floats:
        """Convert the corners (n, k) of a ring or line to corners (m, k), m >= n, longitude and latitude first."""
        return corners


class SystemOfFile(System):
    """A reference system that a file names.

    Parameters
    ----------
    where : str
    name : str

    Raises
    ------
    InvalidInput
        PROJ knows no geographic or projected system of this name.
    """

    def __init__(self, where: str, name: str) -> None:
        super().__init__(where)
        self.name = name[:_SHOWN]
        transformer = _transformer(name)
        if transformer is None:
            raise InvalidInput(
                "{0}: its crs {1!r} is not a geographic or projected reference system that PROJ knows; "
                "must be a code such as EPSG:25832",
                where,
                self.name,
            )
        self._transformer = transformer

    def degrees(self, corners: Floats) -> Floats:
        """Convert corners to WGS 84, and add corners until sides stay in place within `EDGE_TOLERANCE_M`.

        Raises
        ------
        InvalidInput
            A corner is outside the domain of the system, or a side runs through a pole or across the map's edge.
        """
        # A side still bent after 24 halvings crosses a pole or the map's edge.
        for _ in range(24):
            places = self._places(corners)
            bent = self._bent(corners, places)
            if not bent.size:
                return np.concatenate([places, corners[:, 2:]], axis=1)
            if len(corners) + len(bent) > _MOST_CORNERS:
                break
            corners = np.insert(corners, bent + 1, (corners[bent] + corners[bent + 1]) / 2.0, axis=0)
        raise InvalidInput(
            "{0}: a side runs through a pole, across the edge of the map of {1}, or too far; must be cut",
            self.where,
            self.name,
        )

    def _bent(self, corners: Floats, places: Floats) -> NDArray[np.intp]:
        """Indices of sides that move too far when drawn straight in degrees."""
        sides = np.diff(places, axis=0)
        sides[:, 0] -= 360.0 * np.rint(sides[:, 0] / 360.0)
        farthest, m_per_deg = np.zeros(len(sides)), math.radians(WGS84.a_m)
        for share in (0.25, 0.5, 0.75):
            places_between = self._places(corners[:-1] + share * np.diff(corners, axis=0))
            offset = places_between - (places[:-1] + share * sides)
            east = (offset[:, 0] - 360.0 * np.rint(offset[:, 0] / 360.0)) * np.cos(np.radians(places_between[:, 1]))
            farthest = np.maximum(farthest, np.hypot(east, offset[:, 1]) * m_per_deg)
        return np.flatnonzero(farthest > EDGE_TOLERANCE_M / 2.0)

    def _places(self, corners: Floats) -> Floats:
        """Longitudes and latitudes (n, 2)."""
        from ...geodesy.projections import through_proj

        if not len(corners):
            return corners[:, :2]
        places = np.stack(through_proj(self._transformer.transform, corners[:, 0], corners[:, 1]), axis=1)
        lost = np.flatnonzero(~np.isfinite(places).all(axis=1))
        if lost.size:
            raise InvalidInput(
                "{0}: corner {1:g}, {2:g} is outside the domain of its crs {3}",
                self.where,
                *corners[lost[0], :2].tolist(),
                self.name,
            )
        return places


def _transformer(name: str) -> Transformer | None:
    """Transformation from a named system to WGS 84, if PROJ has one."""
    if len(name) > _SHOWN or not is_code(name):
        return None
    from pyproj import Transformer
    from pyproj.exceptions import ProjError

    try:
        crs = read_reference(name)
        if not (crs.is_geographic or crs.is_projected):
            return None
        return Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    except (ProjError, InvalidInput):
        return None
