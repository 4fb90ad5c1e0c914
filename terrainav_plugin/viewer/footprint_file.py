"""The footprints of a dataset, found by place and by number. On any thread; no file stays open.

QGIS itself reads a GeoJSON file of this size from its beginning for every question: seconds for a hundred thousand.
Ours has a footprint a line, so that it is read once and then only where a footprint is.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from ...core.dataset.folder import FOOTPRINTS_FILE
from ...core.errors import InvalidInput

_FEATURE = b'{"type": "Feature",'


class FootprintFile:
    """Where the footprints of a dataset are, in its file and on the ground.

    Parameters
    ----------
    folder : Path
        Of the dataset.

    Raises
    ------
    InvalidInput
        Where the file cannot be read or is none of ours.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / FOOTPRINTS_FILE
        self.stamp = stamp_of(self.path)
        offsets: list[int] = []
        bounds: list[tuple[float, float, float, float]] = []
        offset = 0
        try:
            with self.path.open("rb") as file:
                for line in file:
                    if line.startswith(_FEATURE):
                        offsets.append(offset)
                        bounds.append(_bounds(_feature(line)))
                    offset += len(line)
        except (OSError, ValueError, KeyError, IndexError, TypeError) as wrong:
            raise InvalidInput(f"footprints {self.path}: cannot be read ({wrong})") from wrong
        self._offsets = np.array(offsets, np.int64)
        self._bounds = np.array(bounds, np.float64).reshape(-1, 4)

    def __len__(self) -> int:
        return len(self._offsets)

    def near(self, lat_deg: float, lon_deg: float) -> list[int]:
        """Numbers of the footprints in whose bounds a place is."""
        west, south, east, north = self._bounds.T
        inside = (west <= lon_deg) & (lon_deg <= east) & (south <= lat_deg) & (lat_deg <= north)
        return [int(number) for number in np.flatnonzero(inside)]

    def read(self, number: int) -> dict[str, Any]:
        """Feature of a number, as GeoJSON says it; raises InvalidInput where it cannot be read."""
        try:
            with self.path.open("rb") as file:
                file.seek(int(self._offsets[number]))
                return _feature(file.readline())
        except (OSError, ValueError) as wrong:
            raise InvalidInput(f"footprints {self.path}: cannot be read ({wrong})") from wrong


def stamp_of(path: Path) -> tuple[int, int]:
    """What changes with a file: its time and length; zeros where it is not there."""
    try:
        found = path.stat()
    except OSError:
        return 0, 0
    return found.st_mtime_ns, found.st_size


def rings_of(feature: dict[str, Any]) -> list[list[list[list[float]]]]:
    """Polygons of a feature, each a list of closed rings of longitudes and latitudes."""
    geometry = feature["geometry"]
    coordinates = geometry["coordinates"]
    # Several rings of ours are parts on either side of the antimeridian.
    return coordinates if geometry["type"] == "MultiPolygon" else [coordinates]


def _feature(line: bytes) -> dict[str, Any]:
    feature = json.loads(line.rstrip().rstrip(b","))
    return feature if isinstance(feature, dict) else {}


def _bounds(feature: dict[str, Any]) -> tuple[float, float, float, float]:
    corners = [corner for polygon in rings_of(feature) for ring in polygon for corner in ring]
    lons, lats = [corner[0] for corner in corners], [corner[1] for corner in corners]
    return min(lons), min(lats), max(lons), max(lats)
