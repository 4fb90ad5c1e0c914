"""What refusals of CityJSON files advise."""

from __future__ import annotations

import json

from terrainav.core.elevation.heights import ConstantHeight
from terrainav.core.elevation.layered import LayeredElevation
from terrainav.core.faces.opening import open_buildings

from tests.support.remedies import Case, remedy

#: A tetrahedron in Delft, in metres.
CORNERS = [
    [85_000.0, 447_000.0, 0.0],
    [85_010.0, 447_000.0, 0.0],
    [85_000.0, 447_010.0, 0.0],
    [85_000.0, 447_000.0, 9.0],
]
SURFACES = [[[0, 2, 1]], [[0, 1, 3]], [[1, 2, 3]], [[2, 0, 3]]]


def written(case: Case, **metadata: str) -> str:
    solid = {"type": "Solid", "lod": 1, "boundaries": [SURFACES]}
    content = {
        "type": "CityJSON",
        "version": "1.0",
        "CityObjects": {"a": {"type": "Building", "geometry": [solid]}},
        "vertices": CORNERS,
        "metadata": metadata,
    }
    path = case.tmp_path / "delft.city.json"
    path.write_text(json.dumps(content))
    return str(path)


def opened(text: str) -> object:
    return open_buildings(text, LayeredElevation((ConstantHeight(43.0),)))


@remedy(
    "faces/cityjson.py",
    "{}: states no coordinate reference system; write it after the name, such as {}#crs=EPSG:7415",
)
def _no_system(case: Case) -> None:
    path = written(case)
    case.refused(lambda: opened(path))
    again = "write it after the name, such as delft.city.json#crs=EPSG:7415"
    case.follow(again, lambda: opened(f"{path}#crs=EPSG:7415"))


@remedy(
    "faces/city_buildings.py",
    "{}: no vertex lies where {} is defined; write the right system after the name, such as {}#crs=EPSG:7415",
)
def _wrong_system(case: Case) -> None:
    path = written(case, referenceSystem="EPSG:4979")
    case.refused(lambda: opened(path))
    again = "write the right system after the name, such as delft.city.json#crs=EPSG:7415"
    case.follow(again, lambda: opened(f"{path}#crs=EPSG:7415"))
