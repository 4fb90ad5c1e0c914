"""Random scenes with cliffs, and what their rays meet by PROJ and a walk from cell to cell along each of them."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import pyproj
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.raytracing.tracing import Tracing

#: Systems, of which the first four have a datum of their own, and places in them.
SYSTEMS = (
    ("EPSG:27700", 51.5, -0.12),
    ("EPSG:2056", 46.95, 7.45),
    ("EPSG:31370", 50.85, 4.35),
    ("EPSG:5514", 50.08, 14.42),
    ("EPSG:3857", 69.8, 7.0),
    ("EPSG:32616", 35.1, -89.9),
)
TOLERANCE_PX = 0.02
#: Cells along each side of a surface, and points along a ray, between which it is straight.
SIDE, NODES = 160, 65
SIZE = 160, 120
PIXELS = SIZE[0] * SIZE[1]
#: Noise of positions in degrees, metres.
NOISE_M = 1e-7

TO_SPACE = pyproj.Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)


@lru_cache
def to_crs(crs):
    return pyproj.Transformer.from_crs(4326, crs, always_xy=True)


class Found(NamedTuple):
    """What rays that were looked at come to: those that are lost, pass by ground, or are beyond the bound."""

    rays: int
    lost: int
    passed: int
    beyond: int
    worst_share: float


class Kept:
    """One surface, wherever it is asked for."""

    title = attribution = ""

    def __init__(self, surface, cell_m):
        self.kept, self.size_m = surface, cell_m

    def surface(self, *_):
        return self.kept

    def end_m(self, *_):
        return np.inf

    def cell_m(self, *_):
        return self.size_m


def cliff(z, rng):
    y, x = np.indices(z.shape) - SIDE / 2.0
    angle = rng.choice([0.0, 90.0, 180.0, 270.0, rng.uniform(0.0, 360.0)])
    z[x * np.cos(np.radians(angle)) + y * np.sin(np.radians(angle)) > rng.uniform(-20, 20)] += rng.uniform(0.2, 150)


def terraces(z, rng):
    y, x = np.indices(z.shape)
    z += rng.uniform(1, 40) * np.floor((x * rng.uniform(-1, 1) + y * rng.uniform(-1, 1)) / rng.uniform(3, 30))


def blocks(z, rng):
    for _ in range(rng.integers(3, 40)):
        row, column = rng.integers(0, SIDE, 2)
        high, wide = rng.integers(1, 25, 2)
        z[row : row + high, column : column + wide] += rng.uniform(-30, 60)


def walls(z, rng):
    for at in rng.integers(0, SIDE, 5):
        z[:, at] += rng.uniform(1, 80)
    for at in rng.integers(0, SIDE, 3):
        z[at] += rng.uniform(1, 80)


def holes(z, rng):
    blocks(z, rng)
    for _ in range(3):
        row, column = rng.integers(0, SIDE, 2)
        z[row : row + rng.integers(1, 30), column : column + rng.integers(1, 30)] = np.nan


KINDS = (cliff, cliff, terraces, blocks, walls, holes)


def surface_about(crs, lat, lon, cell_m, z):
    """Surface of cells of about a size whose middle is at a place, and the size."""
    if crs == "EPSG:3857":
        grid = PixelGrid(max_zoom=24, native_zoom=24)
        zoom = int(np.clip(np.rint(np.log2(156543.0 * np.cos(np.radians(lat)) / cell_m)), 1, 24))
    else:
        x, y = to_crs(crs).transform(lon, lat)
        size, zoom = cell_m * 2**15, 7
        plane = ProjectedPlane(crs, x - size / 2, y + size / 2, size, size)
        grid = PixelGrid(256, 0, zoom, zoom, plane=plane)
    u, v = grid.plane.forward(np.array([lat]), np.array([lon]))
    world = grid.world_px(zoom)
    surface = Surface(grid, zoom, int(u[0] * world) - SIDE // 2, int(v[0] * world) - SIDE // 2, z)
    return surface, float(grid.ground_m_per_px(np.array(lat), np.array(lon), zoom))


class Truth:
    """Positions on a surface by PROJ alone, and heights bilinear between its pixels' centres."""

    def __init__(self, surface, crs, lat, lon, height):
        self.z = np.asarray(surface.heights_m, np.float64)
        world = 256 * 2**surface.zoom
        if crs == "EPSG:3857":
            half = np.pi * 6378137.0
            self.west, self.north, self.size = -half, half, 2.0 * half / world
        else:
            plane = surface.grid.plane
            self.west, self.north, self.size = plane.west, plane.north, plane.width / world
        self.left, self.top = surface.left_px + 0.5, surface.top_px + 0.5
        self.to_crs = to_crs(crs)
        phi, lam = np.radians(lat), np.radians(lon)
        self.axes = np.array(
            [
                [-np.sin(lam), np.cos(lam), 0.0],
                [-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)],
                [np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)],
            ]
        )
        self.camera = np.array(TO_SPACE.transform(lon, lat, height))

    def position(self, lat, lon):
        x, y = self.to_crs.transform(lon, lat)
        return (x - self.west) / self.size - self.left, (self.north - y) / self.size - self.top

    def along(self, points):
        """Columns, rows and heights of points in the camera's east, north and up."""
        in_space = self.camera + points @ self.axes
        lon, lat, height = TO_SPACE.transform(*np.moveaxis(in_space, -1, 0), direction="INVERSE")
        return *self.position(lat, lon), height

    def seen_from(self, lat, lon, height):
        """Points in the camera's east, north and up."""
        return (np.stack(TO_SPACE.transform(lon, lat, height), axis=-1) - self.camera) @ self.axes.T

    def heights(self, column, row):
        rows, columns = self.z.shape
        x, y = np.clip(column, 0.0, columns - 1.0), np.clip(row, 0.0, rows - 1.0)
        j, i = np.minimum(x.astype(int), columns - 2), np.minimum(y.astype(int), rows - 2)
        u, v, z = x - j, y - i, self.z
        return (z[i, j] * (1 - u) + z[i, j + 1] * u) * (1 - v) + (z[i + 1, j] * (1 - u) + z[i + 1, j + 1] * u) * v

    def met(self, t, x, y, h, margin):
        """First t at which a ray has met the surface, by more than a margin of height; NaN for none.

        The ray is straight between so many t, columns, rows and heights (n,) along it. Cell by cell its height over the
        bilinear patch is a quadratic. Rays that come in from beneath meet none.
        """
        crossed = [t]
        for at in (x, y):
            lines = np.arange(np.ceil(max(at.min(), -1.0)), np.floor(min(at.max(), SIDE)) + 1.0)[:, np.newaxis]
            before, after = at[:-1] - lines, at[1:] - lines
            line, piece = np.nonzero((before < 0.0) != (after < 0.0))
            share = before[line, piece] / (before - after)[line, piece]
            crossed.append(t[piece] + share * (t[piece + 1] - t[piece]))
        ends = np.sort(np.concatenate(crossed))
        middles = (ends[1:] + ends[:-1]) / 2.0
        j, i = (np.floor(np.interp(middles, t, at)).astype(int) for at in (x, y))
        rows, columns = self.z.shape
        inside = (j >= 0) & (j < columns - 1) & (i >= 0) & (i < rows - 1)
        i, j = np.where(inside, i, 0), np.where(inside, j, 0)
        z = self.z
        corners = [np.where(inside, z[i + down, j + right], np.nan) for down in (0, 1) for right in (0, 1)]

        def over(at):
            u, v = np.interp(at, t, x) - j, np.interp(at, t, y) - i
            upper, lower = (a + (b - a) * u for a, b in (corners[:2], corners[2:]))
            return np.interp(at, t, h) - (upper + (lower - upper) * v)

        first, middle, last = over(ends[:-1]), over(middles), over(ends[1:])
        bend, slope = 2.0 * (first + last - 2.0 * middle), 4.0 * middle - 3.0 * first - last
        with np.errstate(divide="ignore", invalid="ignore"):
            bottom = first - slope * slope / (4.0 * bend)
            turns = (bend > 0.0) & (slope < 0.0) & (-slope < 2.0 * bend)
        ground = np.isfinite(first)
        lowest = np.where(turns, bottom, np.minimum(first, last))
        enters = ground & ~np.concatenate([[False], ground[:-1]])
        # What enters too near to the edge to say is taken for beneath.
        beneath = np.flatnonzero(enters & (first < margin))
        meets = np.flatnonzero(ground & (lowest < -margin))
        if not len(meets) or (len(beneath) and beneath[0] <= meets[0]):
            return np.nan
        return float(ends[meets[0] + 1])


def random_scene(seed, looked_at=16):
    """What an image of a random scene with cliffs comes to, low or high, over its ground or beside it."""
    rng = np.random.default_rng([seed, 32])
    crs, lat, lon = SYSTEMS[seed % len(SYSTEMS)]
    if crs == "EPSG:3857":
        lat = rng.uniform(-75.0, 75.0)
    z = rng.uniform(-50.0, 2000.0) + rng.normal(0.0, rng.choice([0.0, 0.2, 2.0]), (SIDE, SIDE))
    KINDS[rng.integers(len(KINDS))](z, rng)
    agl = rng.uniform(2.0, 30.0) if rng.random() < 0.5 else 30.0 * 60.0 ** rng.random()
    surface, cell = surface_about(crs, lat, lon, max(agl * 50.0 ** -rng.uniform(0.2, 1.5), 0.05), z.astype(np.float32))
    beside = rng.random() < 0.25
    column, row = rng.uniform(-0.3 * SIDE, 1.3 * SIDE, 2) if beside else rng.uniform(0.1, 0.9, 2) * SIDE
    lat, lon = (float(at[0]) for at in surface.places(np.array([column]), np.array([row])))
    below = surface.heights(np.array([column]), np.array([row]))[0]
    height = (surface.highest_m if np.isnan(below) or rng.random() < 0.5 else float(below)) + agl
    tilt, roll = rng.uniform(0.0, 85.0), rng.uniform(-10.0, 10.0)
    pose = Poses(*(np.array([at]) for at in (lat, lon, agl, rng.uniform(0.0, 360.0), tilt, roll)))
    scene = ImageGeometry(Camera(rng.uniform(20.0, 100.0), 4 / 3), *SIZE, pose)
    lowest = surface.lowest_m - rng.uniform(0.0, 20.0)
    tracing = Tracing(scene, height, Kept(surface, cell), lowest, TOLERANCE_PX)
    return judged(tracing, Truth(surface, crs, lat, lon, height), cell, rng, looked_at)


def judged(tracing, truth, cell_m, rng, looked_at):
    """What the rays of an image come to: any that see nothing among others that do, and some of each sort."""
    rays, sighting = tracing.rays, tracing.sighting
    depth = sighting.depth_m
    nothing = np.isnan(depth)
    around = np.pad(nothing, 1, constant_values=True).astype(int)
    shifted = [
        around[1 + i : around.shape[0] - 1 + i, 1 + j : around.shape[1] - 1 + j] for i in (-1, 0, 1) for j in (-1, 0, 1)
    ]
    alone = nothing & (sum(shifted) <= 4)
    z = truth.z
    slope = max(np.nanmax(np.abs(np.diff(z, axis=axis)), initial=0.0) for axis in (0, 1)) / cell_m
    pixel = min(float(np.linalg.norm(per)) for per in (rays.per_x, rays.per_y))

    def some(which):
        at = np.flatnonzero(which.ravel())
        return rng.choice(at, min(looked_at, len(at)), replace=False)

    unseen = np.union1d(np.flatnonzero(alone.ravel())[:1000], some(nothing)).astype(int)
    seen = np.union1d(some(~nothing), some(~nothing & (sum(shifted) > 0))).astype(int)
    at = np.concatenate([unseen, seen])
    row, column = np.divmod(at, rays.width)
    directions, t = rays.directions(column + 0.5, row + 0.5), depth.ravel()[at]
    across = 3.0 * SIDE * cell_m / np.maximum(np.hypot(*directions[:, :2].T), 1e-9)
    down = (tracing.height_m - tracing.lowest_m + 50.0) / np.maximum(-directions[:, 2], 1e-9)
    farthest = np.fmin(np.minimum(across, down), t)
    nodes = np.linspace(0.0, 1.0, NODES) * farthest[:, np.newaxis]
    ways = truth.along(nodes[..., np.newaxis] * directions[:, np.newaxis])
    # What is displaced by no more than the bound meets no ground before, either.
    margins = 1e-3 + (1.0 + slope) * TOLERANCE_PX * pixel * farthest
    met = np.isfinite([truth.met(*way) for way in zip(nodes, *ways, margins)])
    lost, passed = int(met[: len(unseen)].sum()), int(met[len(unseen) :].sum())
    row, column = np.divmod(seen, rays.width)
    lat, lon = sighting.lat_deg[row, column], sighting.lon_deg[row, column]
    points = truth.seen_from(lat, lon, truth.heights(*truth.position(lat, lon)))
    onto = np.linalg.solve(np.stack([rays.per_x, rays.per_y, rays.origin], axis=1), points.T)
    with np.errstate(invalid="ignore", divide="ignore"):
        off_px = np.hypot(onto[0] / onto[2] - column - 0.5, onto[1] / onto[2] - row - 0.5)
    noise_px = NOISE_M * (1.0 + slope) / (pixel * depth[row, column])
    share = off_px / (TOLERANCE_PX + noise_px)
    return Found(len(unseen) + len(seen), lost, passed, int((~(share <= 1.0)).sum()), float(share.max(initial=0.0)))
