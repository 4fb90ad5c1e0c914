"""Buildings as faces against Embree: triangle, instance, class and depth of every pixel, over five scenes.

    python -m venv peers
    peers/bin/pip install -e '.[raster,vectors]' embreex
    peers/bin/python benchmarks/faces_peers.py --data FOLDER

The folder has ``elevation/dtm.tif`` and ``elevation/buildings.geojson`` (Washington), ``cityjson/delft.city.json`` and
``osm/helsinki.osm.pbf``; scenes whose files are missing are skipped in a line. The synthetic world, and houses on a
slope of 35 degrees, need none.

Embree gets the triangles of TerrAInav's buildings, and the relief as triangles of a fourth of a cell, in metres east,
north and up of the camera: PROJ puts the relief there. A pixel is compared where 16 of Embree's rays around it, at 0.5
px, hit the same triangle as that through its centre, or all the relief, or all nothing, and where none of 16 at 2 px
passes an outline of relief before triangles: TerrAInav averages heights to the size of pixels, which moves it. Where
triangles lie on top of each other, either may be seen: such pixels count as ties.

Triangles of the relief are not its bilinear patches: depths of the relief are compared by `relief_peers.py`.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyproj
from relief_peers import Local, axes_of
from terrainav.core.elevation.layered import open_relief
from terrainav.core.faces.opening import open_buildings
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.local import enu_axes, geocentric
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.faces import face_hits
from terrainav.core.geodesy.raytracing.tracing import ElevationModel, Tracing
from terrainav.core.geodesy.triangles import RELIEF, FaceModel

TILTS, YAW_DEG, SIZE, TOLERANCE_PX = (0.0, 45.0, 60.0, 75.0), 30.0, (320, 240), 0.02
CAMERA = Camera(78.8, SIZE[0] / SIZE[1])
#: Metres that the scene reaches from its middle, and vertices of the relief along a side, at most.
REACH_M, MOST_VERTICES = 700.0, 1_200
#: Least distances of compared pixels from edges and from outlines of the relief, and rays that look for these.
EDGE_PX, OUTLINE_PX, AROUND = 0.5, 2.0, 16
#: Least distance of a triangle behind relief, as a share of its depth, for an outline of the relief.
BEHIND = 1e-3
#: Depths of two triangles that lie on top of each other differ by Embree's single precision.
TIE, DEPTH = 1e-6, 1e-4
FACES, GROUND, SKY = 0, 1, -1


@dataclass(frozen=True)
class Scene:
    """Buildings and relief, seen from a height above the ground around a place."""

    name: str
    faces: FaceModel
    relief: ElevationModel
    lat: float
    lon: float
    agl_m: float = 150.0


class Compared(NamedTuple):
    """Counts of pixels, and the greatest relative difference of depths."""

    triangles: int
    buildings: int
    compared: int
    wrong_triangles: int
    wrong_instances: int
    wrong_classes: int
    wrong_depths: int
    ties: int
    farthest: float

    @property
    def is_equal(self) -> bool:
        """Whether no pixel differs."""
        return not (self.wrong_triangles or self.wrong_instances or self.wrong_classes or self.wrong_depths)


def washington(data: Path, _: Path) -> Scene:
    """84 footprints with heights on bare earth."""
    relief = open_relief([str(data / "elevation" / "dtm.tif")])
    faces = open_buildings(str(data / "elevation" / "buildings.geojson"), relief)
    ring = json.loads((data / "elevation" / "buildings.geojson").read_text())["features"]
    points = np.array([np.array(_first_point(one["geometry"]["coordinates"])) for one in ring])
    lon, lat = np.median(points, axis=0).tolist()
    return Scene("Washington", faces, relief, lat, lon)


def _first_point(coordinates: Any) -> list[float]:
    while isinstance(coordinates[0], list):
        coordinates = coordinates[0]
    return [float(value) for value in coordinates[:2]]


def delft(data: Path, _: Path) -> Scene:
    """LoD1 of Delft on level ground."""
    relief = open_relief(["0"])
    path = data / "cityjson" / "delft.city.json"
    ends = np.array(json.loads(path.read_text())["metadata"]["geographicalExtent"])
    x, y = (ends[:2] + ends[3:5]) / 2.0
    lon, lat = pyproj.Transformer.from_crs(28992, 4326, always_xy=True).transform(x, y)
    return Scene("Delft", open_buildings(f"{path}#heights=ground", relief), relief, lat, lon)


def helsinki(data: Path, _: Path) -> Scene:
    """OpenStreetMap's buildings and parts, with levels, heights and roofs, on level ground."""
    relief = open_relief(["20"])
    return Scene("Helsinki", open_buildings(str(data / "osm" / "helsinki.osm.pbf"), relief), relief, 60.1695, 24.9485)


def world(_: Path, __: Path) -> Scene:
    """The houses of the embedded landscape on its ground."""
    relief = open_relief(["world"])
    # A tile of zoom 19 in a town.
    lat, lon = PixelGrid().plane.inverse(np.array([131253.5 / 2.0**19]), np.array([207446.5 / 2.0**19]))
    return Scene("synthetic world", relief.faces, relief, float(lat[0]), float(lon[0]))


def slope(_: Path, folder: Path) -> Scene:
    """Houses of all roof shapes on a slope of 35 degrees with waves."""
    import rasterio

    west, north, cell, side = 500_000.0, 5_200_000.0, 2.0, 400
    x, y = np.meshgrid(np.arange(side) * cell, np.arange(side) * cell)
    heights = 300.0 + 0.7 * y + 5.0 * np.sin(x / 30.0)
    at = rasterio.Affine(cell, 0.0, west, 0.0, -cell, north)
    profile = {"driver": "GTiff", "width": side, "height": side, "count": 1, "dtype": "float32", "crs": "EPSG:32632"}
    with rasterio.open(folder / "slope.tif", "w", transform=at, **profile) as file:
        file.write(heights.astype(np.float32), 1)
    to_degrees, rng, features = pyproj.Transformer.from_crs(32632, 4326, always_xy=True), np.random.default_rng(1), []
    shapes = ("flat", "gabled", "hipped", "pyramidal", "skillion", "half-hipped")
    for number, (left, low) in enumerate((i * 32.0, j * 32.0) for i in range(2, 22) for j in range(2, 22)):
        wide, deep, high = rng.uniform(8.0, 20.0), rng.uniform(8.0, 20.0), rng.uniform(6.0, 15.0)
        ring = np.array([(0, 0), (wide, 0), (wide, deep), (0, deep), (0, 0)])
        lon, lat = to_degrees.transform(west + left + ring[:, 0], north - 750.0 + low + ring[:, 1])
        values = {"height": high, "roof:shape": shapes[number % 6], "roof:height": 3.0}
        geometry = {"type": "Polygon", "coordinates": [np.stack([lon, lat], axis=1).tolist()]}
        features.append({"type": "Feature", "geometry": geometry, "properties": values})
    (folder / "houses.geojson").write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    relief = open_relief([str(folder / "slope.tif")])
    lon, lat = to_degrees.transform(west + side * cell / 2.0, north - side * cell / 2.0)
    return Scene("steep slope", open_buildings(str(folder / "houses.geojson"), relief), relief, lat, lon)


SCENES: dict[str, Callable[[Path, Path], Scene]] = {
    one.__name__: one for one in (washington, delft, helsinki, world, slope)
}

#: Files of scenes.
FILES = {
    "washington": ("elevation/dtm.tif", "elevation/buildings.geojson"),
    "delft": ("cityjson/delft.city.json",),
    "helsinki": ("osm/helsinki.osm.pbf",),
}


class Picture:
    """One picture of a scene, by TerrAInav and by Embree."""

    def __init__(self, scene: Scene, tilt_deg: float) -> None:
        self.scene = scene
        middle = np.array([scene.lat]), np.array([scene.lon])
        near = scene.relief.surface(*middle)
        ground_m = float(near.heights(*near.position(*middle))[0])
        # Tilted cameras stand back to have the middle in the image.
        back = min(scene.agl_m * np.tan(np.radians(tilt_deg)), 1.2 * scene.agl_m)
        way = back * np.array([-np.sin(np.radians(YAW_DEG)), -np.cos(np.radians(YAW_DEG)), 0.0])
        lon, lat, _ = (float(at) for at in Local(scene.lon, scene.lat, ground_m).places(way))
        place = np.array([lat]), np.array([lon])
        below = scene.relief.surface(*place)
        below_m = float(below.heights(*below.position(*place))[0])
        self.height_m = scene.agl_m + max(ground_m, below_m if np.isfinite(below_m) else ground_m)
        self.local = Local(lon, lat, self.height_m)
        pose = Poses(*(np.array([value]) for value in (lat, lon, scene.agl_m, YAW_DEG, tilt_deg, 0.0)))
        self.geometry = ImageGeometry(CAMERA, *SIZE, pose)
        self.axes = axes_of(YAW_DEG, tilt_deg)
        self.box = self._box(lat, lon)
        self.triangles = scene.faces.triangles(*self.box)

    def _box(self, lat: float, lon: float) -> tuple[np.ndarray, np.ndarray]:
        """Latitudes and longitudes of the ends of the scene around the camera."""
        offsets = np.array([[-REACH_M, -REACH_M, 0.0], [REACH_M, REACH_M, 0.0]])
        lons, lats, _ = Local(lon, lat, 0.0).places(offsets)
        return lats, lons

    def relief_mesh(self) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (n, 3) in metres of the camera's frame, and triangles (m, 3) of the relief."""
        surface = self.scene.relief.surface(*self.box)
        column, row = surface.position(*self.box)
        rows, columns = surface.cells
        ends = [np.clip(np.sort(at), 0.0, most) for at, most in ((column, columns), (row, rows))]
        counts = [min(int(np.ceil(end - begin)) * 4 + 1, MOST_VERTICES) for begin, end in ends]
        x, y = np.meshgrid(*(np.linspace(*span, count) for span, count in zip(ends, counts)))
        heights = surface.heights(x.ravel(), y.ravel())
        lat, lon = surface.places(x.ravel(), y.ravel())
        number = np.arange(x.size, dtype=np.int32).reshape(x.shape)
        a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, :-1], number[1:, 1:]))
        faces = np.stack([a, c, b, b, c, d], axis=1).reshape(-1, 3)
        return self.local.of(lon, lat, heights), faces[np.isfinite(heights)[faces].all(axis=1)]

    def traced(self) -> Tracing:
        """TerrAInav's."""
        lowest_m = float(np.nanmin(self.scene.relief.surface(*self.box).heights_m)) - 20.0
        return Tracing(self.geometry, self.height_m, self.scene.relief, lowest_m, TOLERANCE_PX, self.scene.faces)

    def embree(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """What centres of pixels meet (n,), its triangle and its depth, by Embree; and whether edges are far away."""
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        scene = EmbreeScene(robust=True)
        corners = (self.triangles.corners_m.reshape(-1, 3) - self.local.origin) @ self.local.axes.T
        TriangleMesh(scene, corners.astype(np.float32), np.arange(len(corners), dtype=np.int32).reshape(-1, 3))
        vertices, faces = self.relief_mesh()
        TriangleMesh(scene, np.nan_to_num(vertices).astype(np.float32), faces)

        def met(shift_px: tuple[float, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
            x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5 + shift_px[0], np.arange(SIZE[1]) + 0.5 + shift_px[1])
            rays = self.rays(x.ravel(), y.ravel()).astype(np.float32)
            found = scene.run(np.zeros(rays.shape, np.float32), rays, output=True)
            hit = found["primID"] >= 0
            what = np.where(hit, found["geomID"], SKY)
            return what, np.where(what == FACES, found["primID"], -1), np.where(hit, found["tfar"], np.nan)

        what, triangle, depth = met((0.0, 0.0))
        is_far = np.ones(len(what), bool)
        for turn in np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False):
            other, its, _ = met((EDGE_PX * np.cos(turn), EDGE_PX * np.sin(turn)))
            is_far &= (other == what) & (its == triangle)
            other, _, nearer = met((OUTLINE_PX * np.cos(turn), OUTLINE_PX * np.sin(turn)))
            before = (what == FACES) & (other == GROUND) & (nearer < depth * (1.0 - BEHIND))
            behind = (what == GROUND) & (other == FACES) & (depth < nearer * (1.0 - BEHIND))
            is_far &= ~(before | behind)
        return what, triangle, depth.astype(np.float64), is_far

    def compared(self) -> Compared:
        """Compare all pixels far from edges."""
        what, triangle, depth, is_far = self.embree()
        traced = self.traced()
        seen = traced.sighting
        kind, instance, own_depth = (values.ravel() for values in (seen.kind, seen.instance, seen.depth_m))
        own = self._own_triangles(traced, kind != RELIEF)
        face = what == FACES
        peer_kind = np.where(face, self.triangles.kind[triangle], RELIEF)
        peer_instance = np.where(face, self.triangles.instance[triangle], 0)
        peer = np.where(face, self._numbers()[triangle], -1)
        off = np.where(face, np.abs(own_depth - depth) / depth, 0.0)
        # What lies on top of another triangle may be either of them.
        ties = is_far & face & (own >= 0) & (own != peer) & (off < TIE)
        some = is_far & ~ties & ~self._beyond(own_depth)
        # Sky and ground, too, must be where Embree has them.
        lost = some & ((what == SKY) != np.isnan(own_depth))
        known = some & face & (own == peer)
        return Compared(
            len(self.triangles),
            int(face.sum()),
            int(some.sum()),
            int((some & (own != peer)).sum()),
            int((some & (instance != peer_instance)).sum()),
            int((some & (kind != peer_kind)).sum() + lost.sum()),
            int((known & ~(off < DEPTH)).sum()),
            int(ties.sum()),
            float(off[known].max()) if known.any() else 0.0,
        )

    def _beyond(self, depth: np.ndarray) -> np.ndarray:
        """Whether points at depths (n,) lie beyond what Embree has of the scene."""
        x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5, np.arange(SIZE[1]) + 0.5)
        points = depth[:, np.newaxis] * self.rays(x.ravel(), y.ravel())
        return np.asarray(np.abs(points[:, :2]).max(axis=1) > 0.95 * REACH_M)

    def rays(self, x_px: np.ndarray, y_px: np.ndarray) -> np.ndarray:
        """Rays (n, 3) of image points, in metres east, north and up at a depth of 1."""
        focal_px = SIZE[0] / (2.0 * CAMERA.half_tangents[0])
        across, down = (x_px - SIZE[0] / 2.0) / focal_px, (y_px - SIZE[1] / 2.0) / focal_px
        return np.asarray(np.stack([across, -down, np.ones_like(across)], axis=1) @ self.axes)

    def _numbers(self) -> np.ndarray:
        """Number of each triangle, the same for those with the same corners; (n,)."""
        return np.array([self._by_corners[one.tobytes()] for one in self.triangles.corners_m], np.int64)

    @cached_property
    def _by_corners(self) -> dict[bytes, int]:
        found: dict[bytes, int] = {}
        for at, one in enumerate(self.triangles.corners_m):
            found.setdefault(one.tobytes(), at)
        return found

    def _own_triangles(self, traced: Tracing, is_face: np.ndarray) -> np.ndarray:
        """Number of the triangle that each pixel sees, -1 for none."""
        place = *traced.place, traced.height_m
        hits, known = face_hits(self.triangles, geocentric(*place), enu_axes(*place[:2]), traced.rays), self._by_corners
        # The last is for rays that hit none.
        numbers = np.array([*(known[one.tobytes()] for one in hits.triangles.corners_m), -2], np.int64)
        return np.where(is_face, numbers[hits.triangle.ravel()], -1)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path("../shared/data"), help="folder of the scenes' files")
    parser.add_argument("--only", choices=SCENES, nargs="+", default=list(SCENES), help="names of scenes")
    asked = parser.parse_args()
    print(
        "| scene | tilt | triangles | pixels of buildings | compared | other triangle | other instance | other class | "
        "depth off | ties | greatest difference of depths |"
    )
    print("| --- " * 11 + "|")
    with tempfile.TemporaryDirectory() as folder:
        for name in asked.only:
            if missing := [file for file in FILES.get(name, ()) if not (asked.data / file).is_file()]:
                print(f"{name}: skipped, {missing[0]} is missing")
                continue
            scene = SCENES[name](asked.data, Path(folder))
            for tilt in TILTS:
                one = Picture(scene, tilt).compared()
                share = 100.0 * one.compared / (SIZE[0] * SIZE[1])
                print(
                    f"| {scene.name} | {tilt:g}° | {one.triangles:,} | {one.buildings:,} | {share:.1f} % | "
                    f"{one.wrong_triangles} | {one.wrong_instances} | {one.wrong_classes} | {one.wrong_depths} | "
                    f"{one.ties} | {one.farthest:.1e} |",
                    flush=True,
                )


if __name__ == "__main__":
    main()
