"""Label layers made of shapely's geometries, with the interface of `vectors`."""

from __future__ import annotations

from collections import Counter
from types import SimpleNamespace

import numpy as np
import shapely
from shapely.geometry.polygon import orient

KINDS = {"Polygon": 0, "MultiPolygon": 0, "LineString": 1, "MultiLineString": 1, "Point": 2, "MultiPoint": 2}


class ShapelyLayer:
    """Layer of geometries in longitude and latitude, and their values."""

    def __init__(self, geometries, **values):
        self.geometries, self.columns = list(geometries), values
        self.count, self.fields = len(self.geometries), tuple(values)
        self.boxes = shapely.bounds(np.array(self.geometries, object)).reshape(-1, 4)
        self.reads = 0

    def values(self, field):
        return dict(Counter(self.columns[field]))

    def features(self, west_deg, south_deg, east_deg, north_deg, fields=(), least_m=0.0):
        self.reads += 1
        box = self.boxes
        at = np.nonzero(
            (box[:, 0] <= east_deg) & (box[:, 2] >= west_deg) & (box[:, 1] <= north_deg) & (box[:, 3] >= south_deg)
        )[0]
        vertices, rings, parts, starts, kinds = [np.empty((0, 2))], [0], [0], [0], []
        for one in (self.geometries[index] for index in at):
            kinds.append(KINDS[one.geom_type])
            for part in getattr(one, "geoms", [one]):
                for ring in _rings(part):
                    vertices.append(ring)
                    rings.append(rings[-1] + len(ring))
                parts.append(len(rings) - 1)
            starts.append(len(parts) - 1)
        lon, lat = np.concatenate(vertices).T
        return SimpleNamespace(
            number=at + 1,
            kind=np.array(kinds, np.uint8),
            lon_deg=lon,
            lat_deg=lat,
            ring_starts=np.array(rings),
            part_starts=np.array(parts),
            feature_starts=np.array(starts),
            values={field: tuple(self.columns[field][index] for index in at) for field in fields},
        )


def _rings(part):
    if part.geom_type != "Polygon":
        return [np.array(part.coords)]
    part = orient(part)
    return [np.array(ring.coords) for ring in (part.exterior, *part.interiors)]
