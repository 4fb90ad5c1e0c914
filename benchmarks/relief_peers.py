"""Pictures over relief against software that others wrote.

Embree follows the same rays, OpenGL and Embree with OpenCV draw the same pictures, COLMAP rebuilds the ground.

    python -m venv peers
    peers/bin/pip install -e '.[raster]' embreex moderngl opencv-python-headless pycolmap
    peers/bin/python benchmarks/relief_peers.py --dsm dsm.tif            # all, some minutes
    peers/bin/python benchmarks/relief_peers.py --dsm dsm.tif --only embree
    peers/bin/python benchmarks/relief_peers.py --dsm dsm.tif --only pictures
    peers/bin/python benchmarks/relief_peers.py --dsm dsm.tif --only colmap --keep folder

The peers are no part of TerrAInav and live in an environment of their own; one that is missing is skipped in a line.

Embree gets each cell as two triangles, in metres east, north and up of the camera: PROJ alone, from the raster's own
coordinates, puts them there. Triangles differ from the bilinear patch by up to a quarter of the cell's twist in height,
and along a ray by that over how fast the ray comes nearer to the ground. What differs by more is judged by a third: a
walk along the ray, in steps of a fiftieth of a cell through PROJ, over bilinear heights.

Pictures show an image of noise on the ground. OpenGL (moderngl on EGL, with llvmpipe on one thread) draws Embree's
triangles with it; Embree's first hits and their barycentric coordinates are looked up by ``cv2.remap``. Both have the
image's coordinates at the vertices, while TerrAInav finds them from the latitudes and longitudes of its points.

COLMAP gets ten pictures of a capture, where they were taken and the camera, and nothing of the ground. The heights of
the points that it triangulates are compared with the bilinear surface model at the same places. It is done, too, for
pictures of level ground, which have to fail.
"""

from __future__ import annotations

import argparse
import csv
import importlib.util
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
# OpenGL in software draws in the thread that is timed.
os.environ.setdefault("LP_NUM_THREADS", "0")

import numpy as np
import pyproj
from relief import CAMERA, HEIGHTS_M, SIZE, TILTS, Hills, march, timed
from terrainav.core.capture.runner import capture
from terrainav.core.elevation.layered import open_relief
from terrainav.core.external.compiling import uses_numba
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.raytracing.tracing import Tracing
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.resampling import sample

TOLERANCE_PX, YAW = 0.02, 30.0
#: Cells along each side of what the surface model has for Embree, and steps to a cell of the third.
CELLS, STEPS = 512, 50
#: Metres that a ray may be below the ground before it meets it: what 0.02 px are at the rays' ends.
TOUCHING_M = 0.02
MARCHED_DEG = 70.0
GEOCENTRIC = pyproj.Transformer.from_crs(4979, 4978, always_xy=True)
GEODETIC = pyproj.Transformer.from_crs(4978, 4979, always_xy=True)
#: Flight for COLMAP: metres above the first point's ground, metres between pictures along and across, tilts, px.
AGL_M, ALONG_M, ACROSS_M, TILTED, IMAGE_PX = 150.0, 30.0, 39.0, (0.0, 25.0), 800
ORTHO_M, ORTHO_PX = 0.2, 3000
#: Pixels of the image on the ground to a side of a cell, at most, and to a side of the whole.
TEXELS, TEXTURE_PX = 8, 4096
VERTEX_SHADER = """
#version 330
in vec3 metres;
in vec2 cell;
uniform mat4 projection;
out vec3 point;
out vec2 texel;
uniform vec2 cells;
void main() {
    gl_Position = projection * vec4(metres, 1.0);
    point = metres;
    texel = (cell + 0.5) / cells;
}
"""
FRAGMENT_SHADER = """
#version 330
in vec3 point;
in vec2 texel;
uniform sampler2D ground;
layout(location = 0) out vec4 place;
layout(location = 1) out float grey;
void main() {
    place = vec4(point, 1.0);
    grey = texture(ground, texel).r;
}
"""


@dataclass(frozen=True)
class Ground:
    """Heights (rows, columns) at the centres of pixels of a plane, told by PROJ and nothing of TerrAInav's.

    The first pixel's centre is at ``x, y``; pixels have a size of ``step`` of the plane's units.
    """

    plane: pyproj.Proj
    x: float
    y: float
    step: float
    heights_m: np.ndarray

    def position(self, lon: np.ndarray, lat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Columns and rows of places."""
        x, y = self.plane(lon, lat)
        return (np.asarray(x) - self.x) / self.step, (self.y - np.asarray(y)) / self.step

    def at(self, lon: np.ndarray, lat: np.ndarray) -> np.ndarray:
        """Bilinear heights at places; NaN beyond the model."""
        x, y = self.position(lon, lat)
        z = self.heights_m
        inside = (x >= 0) & (y >= 0) & (x <= z.shape[1] - 1) & (y <= z.shape[0] - 1)
        j = np.clip(np.where(inside, x, 0).astype(int), 0, z.shape[1] - 2)
        i = np.clip(np.where(inside, y, 0).astype(int), 0, z.shape[0] - 2)
        u, v = x - j, y - i
        upper = z[i, j] * (1 - u) + z[i, j + 1] * u
        lower = z[i + 1, j] * (1 - u) + z[i + 1, j + 1] * u
        return np.where(inside, upper * (1 - v) + lower * v, np.nan)

    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """Longitudes and latitudes (rows, columns) of the pixels' centres."""
        rows, columns = self.heights_m.shape
        grid = np.meshgrid(self.x + self.step * np.arange(columns), self.y - self.step * np.arange(rows))
        return self.plane(*grid, inverse=True)

    @property
    def twists_m(self) -> np.ndarray:
        """The greatest twist of each cell and those around it, (rows - 1, columns - 1)."""
        z = self.heights_m
        twist = np.abs(z[:-1, :-1] - z[:-1, 1:] - z[1:, :-1] + z[1:, 1:])
        padded = np.pad(twist, 1)
        return np.max([padded[i : i + len(twist), j : j + twist.shape[1]] for i in range(3) for j in range(3)], axis=0)


class Local:
    """East, north and up of a place, by PROJ."""

    def __init__(self, lon: float, lat: float, height_m: float) -> None:
        self.origin = np.array(GEOCENTRIC.transform(lon, lat, height_m))
        lam, phi = np.radians(lon), np.radians(lat)
        east = np.array([-np.sin(lam), np.cos(lam), 0.0])
        up = np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
        self.axes = np.stack([east, np.cross(up, east), up])

    def of(self, lon: np.ndarray, lat: np.ndarray, height_m: np.ndarray) -> np.ndarray:
        """Metres (..., 3) of places."""
        return (np.stack(GEOCENTRIC.transform(lon, lat, height_m), axis=-1) - self.origin) @ self.axes.T

    def places(self, metres: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Longitudes, latitudes and heights of metres (..., 3)."""
        return GEODETIC.transform(*np.moveaxis(metres @ self.axes + self.origin, -1, 0))


class Kept:
    """One surface, wherever it is asked for; made anew each time, so that nothing of it is known yet."""

    title, attribution = "kept", ""

    def __init__(self, surface: Surface, cell_m: float, *, anew: bool) -> None:
        self._parts, self._cell_m, self._anew = surface, cell_m, anew

    def surface(self, *_: object) -> Surface:
        """The surface."""
        one = self._parts
        return Surface(one.grid, one.zoom, one.left_px, one.top_px, one.heights_m) if self._anew else one

    def end_m(self, *_: float) -> float:
        """Distance beyond which there is no ground."""
        return np.inf

    def cell_m(self, *_: float) -> float:
        """Size of its cells."""
        return self._cell_m


def axes_of(yaw_deg: float, tilt_deg: float) -> np.ndarray:
    """Right, top and optical axis (3, 3) of a camera, in east, north and up."""
    yaw, tilt = np.radians(yaw_deg), np.radians(tilt_deg)
    heading, up = np.array([np.sin(yaw), np.cos(yaw), 0.0]), np.array([0.0, 0.0, 1.0])
    right = np.array([np.cos(yaw), -np.sin(yaw), 0.0])
    return np.stack([right, np.cos(tilt) * heading + np.sin(tilt) * up, np.sin(tilt) * heading - np.cos(tilt) * up])


def hills(agl: float) -> tuple[Surface, Ground, float]:
    """Smooth hills: TerrAInav's surface, the same told by PROJ, and the size of its cells, which grow with heights."""
    fine = Hills().surface()
    coarser = round(np.log2(agl / HEIGHTS_M[0]))
    world = 256.0 * 2 ** (fine.zoom - coarser)
    middle = np.array([fine.left_px + 256, fine.top_px + 256]) >> coarser
    left, top = (int(at) - 256 for at in middle)
    surface = Surface(fine.grid, fine.zoom - coarser, left, top, fine.heights_m * 2.0**coarser)
    half = 20037508.342789244
    step = 2 * half / world
    x, y = (surface.left_px + 0.5) * step - half, half - (surface.top_px + 0.5) * step
    return surface, Ground(pyproj.Proj(3857), x, y, step, surface.heights_m), 0.84 * 2**coarser


def of_file(path: str) -> tuple[Surface, Ground, float]:
    """A surface model: TerrAInav's surface, the same told by rasterio and PROJ, and the size of its cells."""
    ground = ground_ellipsoid(path)
    rows, columns = (min(side, CELLS) for side in ground.heights_m.shape)
    ground = Ground(ground.plane, ground.x, ground.y, ground.step, ground.heights_m[:rows, :columns])
    lon, lat = ground.places()
    whole = open_relief([path]).surface(lat.ravel()[[0, -1]], lon.ravel()[[0, -1]])
    column, row = whole.position(lat[0, :1], lon[0, :1])
    left, top = round(float(column[0])), round(float(row[0]))
    if max(abs(left - column[0]), abs(top - row[0])) > 1e-4:
        raise SystemExit(f"{path}: pixels of TerrAInav's surface lie {column[0]}, {row[0]} beside the file's own")
    heights = whole.heights_m[top : top + rows, left : left + columns]
    cut = Surface(whole.grid, whole.zoom, whole.left_px + left, whole.top_px + top, heights)
    return cut, ground, ground.step


def ground_ellipsoid(path: str) -> Ground:
    """A surface model in a projected CRS in metres, as rasterio reads it."""
    import rasterio

    with rasterio.open(path) as file:
        t, band = file.transform, file.read(1, masked=True).astype(np.float64).filled(np.nan)
        return Ground(pyproj.Proj(file.crs.to_wkt()), t.c + t.a / 2.0, t.f + t.e / 2.0, t.a, band)


def comparisons(agl: float, surface: Surface, ground: Ground, cell_m: float) -> Iterator[tuple[float, Comparison]]:
    """Tilts, and a picture of the middle of a surface for each."""
    side_m = min(ground.heights_m.shape) * cell_m
    lon, lat = ground.places()
    middle = tuple(float(values[len(lon) // 2, lon.shape[1] // 2]) for values in (lon, lat))
    level = float(ground.at(*(np.array([value]) for value in middle))[0])
    for tilt in TILTS:
        # Tilted cameras stand back to have the middle in the image, as far as the surface goes.
        back = min(agl * np.tan(np.radians(tilt)), 0.49 * side_m)
        way = back * np.array([-np.sin(np.radians(YAW)), -np.cos(np.radians(YAW)), 0.0])
        at_lon, at_lat, _ = (float(value) for value in Local(*middle, level).places(way))
        yield tilt, Comparison(surface, ground, cell_m, (at_lon, at_lat, level + agl), tilt)


def scenes(dsm: str | None) -> Iterator[tuple[str, Comparison]]:
    """First cells of a row for each picture, and the picture."""
    for agl in HEIGHTS_M:
        for name, made in (("hills", lambda agl=agl: hills(agl)), ("surface", lambda: of_file(dsm))):
            if name == "hills" or dsm:
                for tilt, one in comparisons(agl, *made()):
                    yield f"| {name} | {agl:g} m | {tilt:g}", one


class Comparison:
    """One picture, traced by TerrAInav, by Embree and by a march."""

    def __init__(
        self,
        surface: Surface,
        ground: Ground,
        cell_m: float,
        camera: tuple[float, float, float],
        tilt_deg: float,
    ) -> None:
        self.ground, self.cell_m, self.surface = ground, cell_m, surface
        self.lon, self.lat, self.height_m = camera
        self.local = Local(*camera)
        pose = Poses(*(np.array([value]) for value in (self.lat, self.lon, 100.0, YAW, tilt_deg, 0.0)))
        self.scene = ImageGeometry(CAMERA, *SIZE, pose)
        self.tilt_deg, self.axes = tilt_deg, axes_of(YAW, tilt_deg)
        x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
        self.pixels = np.stack([x.ravel(), y.ravel()], axis=1)
        self.focal_px = SIZE[0] / (2.0 * CAMERA.half_tangents[0])
        across, down = (self.pixels - np.array(SIZE) / 2.0).T / self.focal_px
        self.rays = np.stack([across, -down, np.ones_like(across)], axis=1) @ self.axes
        lon, lat = ground.places()
        self.vertices = self.local.of(lon, lat, ground.heights_m).reshape(-1, 3).astype(np.float32)
        number = np.arange(lon.size, dtype=np.int32).reshape(lon.shape)
        a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]))
        self.triangles = np.stack([a, c, b, b, c, d], axis=1).reshape(-1, 3)

    def traced(self, relief: Kept) -> Tracing:
        """TerrAInav's."""
        lowest = float(np.nanmin(self.ground.heights_m)) - 20.0
        found = Tracing(self.scene, self.height_m, relief, lowest, TOLERANCE_PX)
        _ = found.depth_m
        return found

    def built(self):
        """Embree's scene."""
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        found = EmbreeScene(robust=True)
        TriangleMesh(found, self.vertices, self.triangles)
        found.run(np.zeros((1, 3), np.float32), np.array([[0, 0, 1]], np.float32))
        return found

    def row(self) -> list[str]:
        """Cells of a table."""
        fresh, known = (Kept(self.surface, self.cell_m, anew=anew) for anew in (True, False))
        whole_s = timed(partial(self.traced, fresh))
        own = self.traced(known)
        own_s = timed(partial(self.traced, known))
        build_s, scene = timed(self.built), self.built()
        origins, rays = np.zeros(self.rays.shape, np.float32), self.rays.astype(np.float32)
        follow: Callable[[], dict[str, np.ndarray]] = partial(scene.run, origins, rays, output=True)
        peer_s, peer = timed(follow), follow()
        if not np.isfinite(own.depth_m).any() and not (peer["primID"] >= 0).any():
            return ["0 %"]
        times = [whole_s, own_s, build_s, peer_s]
        # Marches along the ground take half a minute.
        if self.tilt_deg < MARCHED_DEG:
            times.append(timed(partial(march, self.surface, own, self.height_m), 1))
        return [*self.compared(own, peer), *(f"{1e3 * s:.0f} ms" for s in times)]

    def compared(self, own: Tracing, peer: dict[str, np.ndarray]) -> list[str]:
        """Cells of a table that tell how far points are from each other."""
        seen = own.sighting
        t = seen.depth_m.ravel()
        points = self.local.of(*(part.ravel() for part in (seen.lon_deg, seen.lat_deg, seen.height_m)))
        there, hit = np.isfinite(t), peer["primID"] >= 0
        t_peer = np.where(hit, peer["tfar"].astype(np.float64), np.nan)
        both, either = there & hit, there | hit
        length = np.linalg.norm(self.rays, axis=1)
        apart = np.linalg.norm(points - t_peer[:, np.newaxis] * self.rays, axis=1)
        # TerrAInav's own points, through PROJ: on their pixels' rays.
        right, top, axis = (points[there] @ self.axes.T).T
        image = np.stack([right, -top], axis=1) / axis[:, np.newaxis] * self.focal_px + np.array(SIZE) / 2.0
        off_px = np.linalg.norm(image - self.pixels[there], axis=1)
        beyond = np.zeros(len(t), bool)
        beyond[both] = apart[both] > self.allowed_m(seen, peer, t, t_peer, length, both)
        beyond |= there ^ hit
        jumps = beyond & ~(apart < 2.0 * self.cell_m)
        wrong = self.judged(np.flatnonzero(beyond), t, t_peer)
        share = 100.0 / max(np.count_nonzero(either), 1)
        return [
            f"{100.0 * either.mean():.0f} %",
            f"{1e3 * np.median(apart[both]):.2g} mm",
            f"{np.percentile(apart[both], 99):.2g} m",
            f"{apart[both].max():.2g} m",
            f"{share * np.count_nonzero(beyond):.3f} %",
            str(np.count_nonzero(jumps)),
            str(wrong),
            f"{off_px.max():.3f} px",
        ]

    def allowed_m(self, seen, peer, t, t_peer, length, both) -> np.ndarray:
        """What points of pixels where both see ground may be apart by."""
        twists = self.ground.twists_m
        quarter = np.zeros(np.count_nonzero(both))
        for depth in (t, t_peer):
            lon, lat, _ = self.local.places(depth[both, np.newaxis] * self.rays[both])
            column, row = self.ground.position(lon, lat)
            j, i = (np.clip(at.astype(int), 0, n - 1) for at, n in zip((column, row), twists.shape[::-1]))
            quarter = np.maximum(quarter, twists[i, j] / 4.0)
        rays = self.rays[both]
        normal = seen.normals.reshape(-1, 3)[both]
        patch = -np.sum(normal * rays, axis=1) / normal[:, 2]
        normal = peer["Ng"][both].astype(np.float64)
        flat = -np.sum(normal * rays, axis=1) / normal[:, 2]
        # Height by which a ray nears the ground, per metre of it; and 0.02 px, and the rounding of float32.
        closing = np.maximum(np.minimum(patch, flat), 1e-9) / length[both]
        off_m = np.fmax(t, t_peer)[both] * length[both] * (TOLERANCE_PX / self.focal_px + 1e-6)
        steep = np.hypot(normal[:, 0], normal[:, 1]) / normal[:, 2]
        return (quarter + off_m * (1.0 + steep)) / closing

    def judged(self, which: np.ndarray, t: np.ndarray, t_peer: np.ndarray) -> int:
        """How many of TerrAInav's depths a walk in small steps disproves."""
        wrong = 0
        for one in which:
            ray = self.rays[one]
            begin = np.nanmin([t[one], t_peer[one]])
            level = max(float(np.hypot(*ray[:2])), 0.05)
            step = self.cell_m / STEPS / level
            # One that sees nothing: to where it has left the surface's top, the ground, or the model.
            end = t[one] if np.isfinite(t[one]) else begin + 20.0 * self.cell_m / level
            depths = np.arange(begin - STEPS * step, end, step)
            lon, lat, height = self.local.places(np.append(depths, end)[:, np.newaxis] * ray)
            above = height - self.ground.at(lon, lat)
            before = above[:-1][depths < end - TOLERANCE_PX / self.focal_px * end]
            clear = not (before < -TOUCHING_M).any()
            meets = not np.isfinite(t[one]) or abs(above[-1]) < max(TOUCHING_M, np.abs(np.diff(above[-3:])).max())
            wrong += not (clear and meets)
        return wrong


def compare_with_embree(dsm: str | None) -> None:
    """Print a table."""
    if importlib.util.find_spec("embreex") is None:
        print("Embree: skipped, embreex is not installed (pip install embreex)")
        return
    print(
        "| surface | height | tilt | see it | median | 99 % | greatest | beyond | jumps | disproved | off its ray | "
        "TerrAInav | without pyramid | Embree's tree | Embree | march |"
    )
    print("| --- " * 16 + "|")
    for name, one in scenes(dsm):
        print(f"{name} | " + " | ".join(one.row()) + " |", flush=True)


class Picture(NamedTuple):
    """Grey levels and depths in metres, (pixels,) each; NaN where there is no ground."""

    grey: np.ndarray
    depth_m: np.ndarray


class Pictures:
    """The same picture by TerrAInav, by OpenGL, and by Embree and OpenCV."""

    def __init__(self, one: Comparison) -> None:
        import moderngl

        self.one = one
        rows, columns = one.ground.heights_m.shape
        self.texels = min(TEXELS, TEXTURE_PX // max(rows, columns))
        size = columns * self.texels, rows * self.texels
        self.image = smooth_noise(size)
        self.relief, self.embree = Kept(one.surface, one.cell_m, anew=False), one.built()
        self.gl = moderngl.create_standalone_context(backend="egl")
        self.gl.enable(moderngl.DEPTH_TEST)
        program = self.gl.program(vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER)
        program["projection"].write(self.projection().T.astype(np.float32).tobytes())
        program["cells"] = columns, rows
        texture = self.gl.texture(size, 1, self.image.tobytes(), alignment=1)
        texture.repeat_x = texture.repeat_y = False
        texture.use()
        cells = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 2)
        mesh = np.concatenate([one.vertices, cells], axis=1).astype(np.float32)
        self.mesh = self.gl.vertex_array(
            program,
            [(self.gl.buffer(mesh.tobytes()), "3f 2f", "metres", "cell")],
            self.gl.buffer(one.triangles.astype(np.int32).tobytes()),
        )
        attachments = [self.gl.texture(SIZE, 4, dtype="f4"), self.gl.texture(SIZE, 1, dtype="f1")]
        self.frame = self.gl.framebuffer(attachments, self.gl.depth_renderbuffer(SIZE))
        self.frame.use()

    def projection(self) -> np.ndarray:
        """Matrix (4, 4) from metres to clip space; rows of the image from the top."""
        across, down = (2.0 * self.one.focal_px / side for side in SIZE)
        right, top, axis = self.one.axes
        depth = self.one.vertices @ axis
        near = max(0.5 * float(depth[depth > 0.0].min()), 1.0)
        far = 1.01 * float(depth.max())
        scale = (far + near) / (far - near)
        shift = -2.0 * far * near / (far - near)
        rows = [*right * across, 0.0], [*-top * down, 0.0], [*axis * scale, shift], [*axis, 0.0]
        return np.array(rows)

    def own(self) -> Picture:
        """TerrAInav's."""
        seen = self.one.traced(self.relief).sighting
        column, row = self.one.surface.position(seen.lat_deg.ravel(), seen.lon_deg.ravel())
        there = np.isfinite(column)
        grey = np.full(len(column), np.nan)
        at = ((part[there] + 0.5) * self.texels for part in (column, row))
        grey[there] = np.rint(sample(self.image[..., np.newaxis], *at, "bilinear")[:, 0])
        return Picture(grey, seen.depth_m.ravel())

    def drawn(self) -> Picture:
        """OpenGL's."""
        self.frame.clear()
        self.mesh.render()
        place = np.frombuffer(self.frame.read(components=4, dtype="f4"), np.float32).reshape(-1, 4)
        grey = np.frombuffer(self.frame.read(components=1, attachment=1, alignment=1), np.uint8)
        there = place[:, 3] > 0.0
        depth = place[:, :3].astype(np.float64) @ self.one.axes[2]
        return Picture(np.where(there, grey, np.nan), np.where(there, depth, np.nan))

    def remapped(self) -> Picture:
        """Embree's first hits, looked up by OpenCV."""
        import cv2

        rays = self.one.rays.astype(np.float32)
        hits = self.embree.run(np.zeros_like(rays), rays, output=True)
        which = hits["primID"]
        there = which >= 0
        # Cells are two triangles: the first corner, and what u and v add to it.
        cell, second = which // 2, which % 2
        row, column = np.divmod(cell, self.one.ground.heights_m.shape[1] - 1)
        u, v = hits["u"], hits["v"]
        x = (column + np.where(second, 1.0 - u, v) + 0.5) * self.texels - 0.5
        y = (row + np.where(second, u + v, u) + 0.5) * self.texels - 0.5
        x, y = (np.where(there, part, -1.0).astype(np.float32).reshape(SIZE[::-1]) for part in (x, y))
        grey = cv2.remap(self.image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        depth = np.where(there, hits["tfar"].astype(np.float64), np.nan)
        return Picture(np.where(there, grey.ravel(), np.nan), depth)

    def row(self) -> str:
        """Cells of a table."""
        own = self.own()
        cells = [f"{100.0 * np.isfinite(own.depth_m).mean():.0f} %"]
        cells += [f"{1e3 * timed(draw):.0f} ms" for draw in (self.own, self.remapped, self.drawn)]
        for peer in (self.remapped(), self.drawn()):
            cells += self.compared(own, peer)
        self.gl.release()
        return " | ".join(cells)

    def compared(self, own: Picture, peer: Picture) -> list[str]:
        """Share of points beyond the tolerance, holes of one picture alone, and differences of grey levels."""
        one, t, t_peer = self.one, own.depth_m, peer.depth_m
        rays = one.rays.astype(np.float32)
        hits = self.embree.run(np.zeros_like(rays), rays, output=True)
        both = np.isfinite(t) & np.isfinite(t_peer) & (hits["primID"] >= 0)
        if not both.any():
            return ["–"] * 4
        length = np.linalg.norm(one.rays, axis=1)
        allowed = one.allowed_m(one.traced(self.relief).sighting, hits, t, t_peer, length, both)
        beyond = np.abs(t - t_peer)[both] * length[both] > allowed
        grey = np.abs(own.grey[both] - peer.grey[both])
        holes = np.count_nonzero(np.isfinite(t) ^ np.isfinite(t_peer))
        return [
            f"{100.0 * beyond.mean():.3f} %",
            str(holes),
            f"{100.0 * (grey > 1.0).mean():.2f} %",
            f"{np.percentile(grey, 99):.0f}",
        ]


def smooth_noise(size: tuple[int, int]) -> np.ndarray:
    """Grey levels of noise without detail finer than some pixels."""
    import cv2

    noise = cv2.GaussianBlur(np.random.default_rng(7).normal(size=size[::-1]), (0, 0), 3.0)
    return np.clip(128.0 + 45.0 * noise / noise.std(), 0.0, 255.0).astype(np.uint8)


def compare_pictures(dsm: str | None) -> None:
    """Print a table."""
    missing = [name for name in ("moderngl", "embreex", "cv2") if importlib.util.find_spec(name) is None]
    if missing:
        print(f"pictures: skipped, {', '.join(missing)} not installed (pip install moderngl opencv-python-headless)")
        return
    print(f"TerrAInav with {'numba' if uses_numba() else 'numpy'}")
    print(
        "| ground | height | tilt | see it | TerrAInav | Embree + remap | OpenGL | "
        + " | ".join(f"{peer}: beyond | holes | other levels | 99 %" for peer in ("Embree", "OpenGL"))
        + " |"
    )
    print("| --- " * 15 + "|")
    for name, one in scenes(dsm):
        print(f"{name} | {Pictures(one).row()} |", flush=True)


def noise(path: Path, dsm: str, ground: Ground) -> None:
    """Write an orthophoto of noise with detail at every scale about the middle of a surface model."""
    import rasterio

    n = ORTHO_PX
    rng = np.random.default_rng(11)
    frequency = np.hypot(np.fft.fftfreq(n)[:, np.newaxis], np.fft.rfftfreq(n))
    frequency[0, 0] = np.inf
    grey = np.fft.irfft2(np.fft.rfft2(rng.normal(size=(n, n))) / frequency, (n, n))
    grey = np.clip(128.0 + 55.0 * grey / grey.std(), 0.0, 255.0).astype(np.uint8)
    rows, columns = ground.heights_m.shape
    x = ground.x + ground.step * columns / 2.0 - ORTHO_M * n / 2.0
    y = ground.y - ground.step * rows / 2.0 + ORTHO_M * n / 2.0
    with rasterio.open(dsm) as file:
        crs = file.crs
    transform = rasterio.Affine(ORTHO_M, 0.0, x, 0.0, -ORTHO_M, y)
    with rasterio.open(
        path, "w", driver="GTiff", width=n, height=n, count=3, dtype="uint8", crs=crs, transform=transform
    ) as file:
        for band in (1, 2, 3):
            file.write(grey, band)


def flown(folder: Path, dsm: str, ground: Ground, tilt: float, *, level: bool) -> Camera:
    """Capture ten pictures, five along and two across, about the middle of a surface model; give the camera."""
    rows, columns = ground.heights_m.shape
    x, y = ground.x + ground.step * columns / 2.0, ground.y - ground.step * rows / 2.0
    y -= AGL_M * np.tan(np.radians(tilt))
    places = [
        ground.plane(x + (i - 0.5) * ACROSS_M, y + (j - 2) * ALONG_M, inverse=True) for i in range(2) for j in range(5)
    ]
    heights = (f"{float(np.nanmedian(ground.heights_m))}",) if level else (dsm,)
    mission = Mission(
        Points(tuple((lat, lon, AGL_M) for lon, lat in places)),
        AGL_M,
        CAMERA,
        source=str(folder / "noise.tif"),
        elevation=heights,
        height_above="takeoff",
        tilt_deg=tilt,
        image_px=IMAGE_PX,
        image_format="png",
    )
    source = open_source(mission.imagery.source)
    made = plan(mission, source.grid, mission_heights(mission))
    result = capture(made, source, folder / "flight")
    if result.failed or result.written != len(places):
        raise SystemExit(f"{result.written} of {len(places)} images were written")
    return mission.camera


def triangulated(folder: Path, camera: Camera, level_m: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """COLMAP's points: longitudes, latitudes, heights (n,), and how far they are off in the pictures, px.

    It gets the pictures, and of the table beside them where the camera was and how it looked;
    tables of level ground leave its height over the ellipsoid to ``level_m``.
    """
    import pycolmap

    pycolmap.set_random_seed(1)
    pictures, database = folder / "flight" / "satellite", folder / "database.db"
    with (pictures / "meta_data.csv").open(newline="") as file:
        table = {row["img_names"]: row for row in csv.DictReader(file)}
    row = next(iter(table.values()))
    width, height = int(row["image_width_px"]), int(row["image_height_px"])
    reader = pycolmap.ImageReaderOptions()
    focal_px = width / (2.0 * camera.half_tangents[0])
    reader.camera_model = "PINHOLE"
    reader.camera_params = f"{focal_px!r},{focal_px!r},{width / 2.0!r},{height / 2.0!r}"
    pycolmap.extract_features(
        database, pictures, list(table), camera_mode=pycolmap.CameraMode.SINGLE, reader_options=reader
    )
    pycolmap.match_exhaustive(database)
    known = pycolmap.Reconstruction()
    world = _local(row, level_m)
    with pycolmap.Database.open(database) as opened:
        for one in opened.read_all_cameras():
            known.add_camera_with_trivial_rig(one)
        for image in opened.read_all_images():
            row = table[image.name]
            own = _local(row, level_m)
            right, top, axis = axes_of(float(row["yaw_deg"]), float(row["tilt_deg"])) @ own.axes @ world.axes.T
            turn = np.stack([right, -top, axis])
            shift = -turn @ (world.axes @ (own.origin - world.origin))
            bare = pycolmap.Image(name=image.name, camera_id=image.camera_id, image_id=image.image_id)
            known.add_image_with_trivial_frame(bare, pycolmap.Rigid3d(np.column_stack([turn, shift])))
    (folder / "sparse").mkdir()
    found = pycolmap.triangulate_points(known, database, pictures, folder / "sparse")
    points = np.array([point.xyz for point in found.points3D.values()])
    return *world.places(points), found.compute_mean_reprojection_error()


def _local(row: dict[str, str], level_m: float) -> Local:
    height = float(row.get("height_m") or level_m + float(row["agl_m"]))
    return Local(float(row["pose_lon_deg"]), float(row["pose_lat_deg"]), height)


def compare_with_colmap(dsm: str | None, keep: Path | None) -> None:
    """Print a table."""
    if dsm is None or importlib.util.find_spec("pycolmap") is None:
        print("COLMAP: skipped, needs --dsm and pycolmap (pip install pycolmap)")
        return
    print("| images of | tilt | points | off in the images | median height error | 90 % | median | 90 % |")
    print("| --- " * 8 + "|")
    ground = ground_ellipsoid(dsm)
    for tilt, level in [*((tilt, False) for tilt in TILTED), (0.0, True)]:
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            noise(folder / "noise.tif", dsm, ground)
            camera = flown(folder, dsm, ground, tilt, level=level)
            lon, lat, height, off_px = triangulated(folder, camera, float(np.nanmedian(ground.heights_m)))
            if keep:
                shutil.copytree(folder, keep / f"{'level' if level else 'relief'}-{tilt:g}", dirs_exist_ok=True)
        off = np.abs(height - ground.at(lon, lat))
        off = off[np.isfinite(off)]
        pixel_m = 2.0 * camera.half_tangents[0] * AGL_M / IMAGE_PX / np.cos(np.radians(tilt))
        median, most = np.percentile(off, [50, 90])
        print(
            f"| {'level ground' if level else 'relief'} | {tilt:g} | {len(off):,} | {off_px:.2f} px | "
            f"{median:.3f} m | {most:.3f} m | {median / pixel_m:.2f} px | {most / pixel_m:.2f} px |",
            flush=True,
        )


COMPARED: dict[str, Callable[[argparse.Namespace], None]] = {
    "embree": lambda asked: compare_with_embree(asked.dsm),
    "pictures": lambda asked: compare_pictures(asked.dsm),
    "colmap": lambda asked: compare_with_colmap(asked.dsm, asked.keep),
}


def main() -> None:
    """Compare with all, or one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dsm", help="a surface in a projected CRS in metres")
    parser.add_argument("--only", choices=COMPARED, help="one of the comparisons")
    parser.add_argument("--keep", type=Path, help="folder to leave COLMAP's images and points in")
    asked = parser.parse_args()
    for name, compare in COMPARED.items():
        if asked.only in (None, name):
            compare(asked)


if __name__ == "__main__":
    main()
