"""Buildings that are boxes, on ground of any height, as a model of faces."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from terrainav.core.external import compiling
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.local import geocentric
from terrainav.core.geodesy.raytracing.tracing import Tracing
from terrainav.core.geodesy.triangles import ROOF, WALL, Triangles

from tests.core.geodesy.cliffs import Kept, surface_about

LAT, LON = 46.95, 7.45
TOLERANCE_PX = 0.02
SKIRT_M = 2.0
METRE_LAT = 1.0 / 111_160.0
METRE_LON = METRE_LAT / np.cos(np.radians(LAT))


class Boxes:
    """Boxes (n, 6): west, south, width and depth in metres from a place, heights of foot and roof in metres."""

    title = attribution = ""

    def __init__(self, boxes, place=(LAT, LON)):
        boxes = np.asarray(boxes, float)
        west, south, wide, deep, foot, top = boxes.T
        self.count = len(top)
        x = np.stack([west, west + wide, west + wide, west], axis=1)
        y = np.stack([south, south, south + deep, south + deep], axis=1)
        self.lat, self.lon = place[0] + y * METRE_LAT, place[1] + x * METRE_LON
        low, high = (geocentric(self.lat, self.lon, at[:, np.newaxis]) for at in (foot - SKIRT_M, top))
        faces = []
        for one in range(4):
            other = (one + 1) % 4
            faces += [(low[:, one], low[:, other], high[:, other]), (low[:, one], high[:, other], high[:, one])]
        faces += [(high[:, 0], high[:, 1], high[:, 2]), (high[:, 0], high[:, 2], high[:, 3])]
        corners = np.stack([np.stack(face, axis=1) for face in faces], axis=1)
        kind = np.tile(np.array([WALL] * 8 + [ROOF] * 2, np.uint8), len(boxes))
        instance = np.repeat(np.arange(len(boxes)) + 1, len(faces))
        colour = np.stack([instance % 200 + 30, 255 - instance % 200, instance % 7 * 30], axis=1).astype(np.uint8)
        self.all = Triangles(corners.reshape(-1, 3, 3), kind, instance, colour, kind == ROOF)
        self.asked = []

    @property
    def listed(self):
        return self.count

    def triangles(self, lat_deg, lon_deg, least_m=0.0):
        self.asked.append(least_m)
        near = (self.lat.max(axis=1) >= lat_deg.min()) & (self.lat.min(axis=1) <= lat_deg.max())
        near &= (self.lon.max(axis=1) >= lon_deg.min()) & (self.lon.min(axis=1) <= lon_deg.max())
        return self.all.take(np.repeat(near, 10))


def tracing_of(faces, tilt_deg, *, height_m=400.0, yaw_deg=20.0, at=(0.0, -60.0), size=(160, 120), ground=None, **more):
    """Tracing from a place in metres, over level ground of 100 m or a grid of heights (160, 160) with cells of 4 m."""
    z = np.full((160, 160), 100.0) if ground is None else ground
    surface, cell_m = surface_about("EPSG:2056", LAT, LON, 4.0, z)
    place = LAT + at[1] * METRE_LAT, LON + at[0] * METRE_LON
    poses = Poses(*(np.array([value]) for value in (*place, height_m - 100.0, yaw_deg, tilt_deg, 0.0)))
    scene = ImageGeometry(Camera(78.8, size[0] / size[1]), *size, poses)
    return Tracing(scene, height_m, Kept(surface, cell_m), float(z.min()), TOLERANCE_PX, faces, **more)


def town_boxes():
    """A town of 150 boxes."""
    rng = np.random.default_rng(3)
    west, south = rng.uniform(-280, 250, (2, 150))
    wide, deep = rng.uniform(4, 25, (2, 150))
    return Boxes(np.stack([west, south, wide, deep, np.full(150, 100.0), rng.uniform(104, 140, 150)], axis=1))


def code(is_compiled):
    """Context of compiled code, or of numpy's."""
    if is_compiled and not compiling.uses_numba():
        pytest.skip("numba is not installed")
    return nullcontext() if is_compiled else compiling.without_numba()
