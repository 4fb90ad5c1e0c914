"""The houses of the synthetic world as a layer of labels, or of buildings.

    python examples/world_houses.py 35.1460_-89.8670_35.1340_-89.8520 houses.geojson
    terrainav capture --coords "35.1460_-89.8670_35.1340_-89.8520_100" --labels houses.geojson:roof --data-dir OUT

The box is latTL_lonTL_latBR_lonBR; houses reach 500 m beyond it, as tilted images do. Each house is a polygon with its
`roof`, flat or gabled, and its `height` in metres.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from pyproj import Transformer
from terrainav.core.errors import TerrAInavError
from terrainav.core.geodesy.triangles import ROOF, SKIRT_M, WALL
from terrainav.core.pairs.places import read_box
from terrainav.core.world.houses import WorldHouses
from terrainav.core.world.lattice import chart_seed

#: The landscape of `--source world`.
SEED = 2024
#: Rises of roofs below this are rounding, metres.
LEVEL_M = 0.01
#: Tilted images see ground beyond their box.
AROUND_M, M_PER_DEG = 500.0, 111_000.0


def features(box: str) -> list[dict[str, object]]:
    """Features of GeoJSON of the houses in a box and around it."""
    area = read_box(box)
    up = np.array([-1.0, 1.0]) * AROUND_M / M_PER_DEG
    lat, lon = np.array([area.south_deg, area.north_deg]), np.array([area.west_deg, area.east_deg])
    houses = WorldHouses(chart_seed(SEED, 0)).triangles(lat + up, lon + up / np.cos(np.radians(lat)))
    to_degrees = Transformer.from_crs("EPSG:4978", "EPSG:4979", always_xy=True)
    lon, lat, height = to_degrees.transform(*np.moveaxis(houses.corners_m, -1, 0))
    found = []
    for number in np.unique(houses.instance):
        roof = (houses.instance == number) & (houses.kind == ROOF)
        wall = (houses.instance == number) & (houses.kind == WALL)
        eaves = height[roof].min()
        at_eaves = height[roof] < eaves + LEVEL_M
        corners = np.unique(np.stack([lon[roof][at_eaves], lat[roof][at_eaves]], axis=1).round(9), axis=0)
        towards = corners - corners.mean(axis=0)
        ring = corners[np.argsort(np.arctan2(towards[:, 1], towards[:, 0]))].tolist()
        values = {
            "roof": "flat" if at_eaves.all() else "gabled",
            "height": round(float(height[roof].max() - height[wall].min() - SKIRT_M), 2),
        }
        shape = {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}
        found.append({"type": "Feature", "properties": values, "geometry": shape})
    return found


def main() -> None:
    """Write the file."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("box", help="latTL_lonTL_latBR_lonBR, in degrees")
    parser.add_argument("file", type=Path, help="GeoJSON to write")
    asked = parser.parse_args()
    found = features(asked.box)
    asked.file.write_text(json.dumps({"type": "FeatureCollection", "features": found}), encoding="utf-8")
    print(f"{len(found):,} houses in {asked.file}")


if __name__ == "__main__":
    try:
        main()
    except TerrAInavError as wrong:
        sys.exit(f"world_houses: {wrong}")
