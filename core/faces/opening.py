"""Open the buildings that a text names: footprints of a vector file, or a CityJSON file."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from ..errors import InvalidInput
from ..geodesy.raytracing.tracing import ElevationModel
from ..geodesy.triangles import FaceModel
from ..storage.files import file_exists
from ..vectors.layer import open_layer, parse_layer
from .buildings import BuildingOptions, FootprintBuildings
from .city_buildings import FILE, GROUND, CityBuildings
from .cityjson import is_cityjson, read_city


class CityName(NamedTuple):
    """A CityJSON file and how to read it; empty texts for what the file states."""

    path: str
    crs: str = ""
    lod: str = ""
    heights: str = ""


def parse_city(text: str) -> CityName | None:
    """Parse ``FILE[#crs=CODE&lod=NUMBER&heights=file|ground]``; None if there is no CityJSON file of this name.

    Raises
    ------
    InvalidInput
        An option is unknown.
    """
    path, behind = (text, "") if file_exists(text) else text.rpartition("#")[::2]
    if not path or path.startswith("/vsi") or not Path(path).is_file() or not is_cityjson(path):
        return None
    values = {}
    for word in behind.split("&") if behind else ():
        name, _, value = word.partition("=")
        is_known = (name in ("crs", "lod") and value) or (name == "heights" and value in (FILE, GROUND))
        if not is_known or name in values:
            raise InvalidInput(
                "buildings {0}: {1!r} behind # must be crs=CODE, lod=NUMBER, heights=file or heights=ground, each once",
                text,
                word,
                field="buildings",
            )
        values[name] = value
    return CityName(path, **values)


def open_buildings(text: str, ground: ElevationModel, options: BuildingOptions | None = None) -> FaceModel:
    """Buildings on the ground, of ``FILE[:LAYER]``, or of a CityJSON file as in `parse_city`.

    Raises
    ------
    InvalidInput
        The file or layer cannot be opened.
    """
    city = parse_city(text)
    if city is not None:
        return CityBuildings(read_city(city.path, city.crs, city.lod), ground, options, city.heights)
    name = parse_layer(text)
    return FootprintBuildings(open_layer(name.path, name.layer), ground, options)


def whole_building_path(text: str) -> str:
    """Make the path in a text absolute, so that the text names the same buildings from any current folder."""
    path, rest = split_building_path(text)
    return text if path.startswith("/vsi") else f"{Path.cwd() / path}{rest}"


def split_building_path(text: str) -> tuple[str, str]:
    """Split a text that names buildings into the path of the file, and the layer or options behind it."""
    city = parse_city(text)
    path = parse_layer(text).path if city is None else city.path
    return path, text[len(path) :]
