"""Random scenes over the whole domain of each method, and their errors over their bounds, measured in long double."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy import accuracy
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import CORNERS, Camera, Poses
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.footprint import exact
from terrainav.core.geodesy.frames import FrameEdges, map_frame_edges
from terrainav.core.geodesy.mercator import lon_to_u
from terrainav.core.geodesy.rectangles import inscribed_edges
from terrainav.core.geodesy.view import ImageRays, mesh
from terrainav.core.report.footprints import FOOTPRINTS, loc1_px, loc2_px

from tests.core.geodesy import longdouble

LOWEST_M, HIGHEST_M = 1e-2, 3.6e7
LONGEST_PX = 640.0
#: Points of a picture that a map frame is compared at, along each side.
GRID = 7
#: Points drawn in the cells of each mesh, and in each camera frame that is traced.
POINTS_A_MESH, POINTS_A_FRAME = 2000, 300


@dataclass
class Tally:
    """Ratios of measured error to bound, and the scene of the worst."""

    ratios: list[np.ndarray] = field(default_factory=list)
    worst: float = 0.0
    scene: dict[str, Any] = field(default_factory=dict)

    def add(self, ratio, **scene):
        ratio = np.asarray(ratio, float)
        if not len(ratio):
            return
        self.ratios.append(ratio.astype(np.float32))
        at = int(np.argmax(ratio))
        if ratio[at] > self.worst or not self.scene:
            self.worst = float(ratio[at])
            self.scene = {
                name: np.ravel(value)[at if np.size(value) > 1 else 0].item() for name, value in scene.items()
            }

    @property
    def count(self):
        return sum(map(len, self.ratios))

    @property
    def median(self):
        return float(np.median(np.concatenate(self.ratios))) if self.ratios else np.nan


def cameras(rng, count, widest=179.9, narrowest=0.01) -> Iterator[Camera]:
    """Cameras between two fields of view, evenly in the logarithm of their tangents, and of any aspect ratio."""
    low, high = np.log10(np.tan(np.radians([narrowest / 2, widest / 2])))
    for _ in range(count):
        fov = 2 * np.degrees(np.arctan(10 ** rng.uniform(low, high)))
        yield Camera(float(np.clip(fov, 0.01, widest)), float(10 ** rng.uniform(-3, 3)))


def latitudes(rng, count):
    """Even over the Earth, and crowded towards the poles."""
    near_pole = np.sign(rng.uniform(-1, 1, count)) * (90 - 10 ** rng.uniform(-6, 1.5, count))
    return np.where(rng.random(count) < 0.7, np.degrees(np.arcsin(rng.uniform(-1, 1, count))), near_pole)


def image_size(camera):
    aspect = camera.aspect_ratio
    return (LONGEST_PX, LONGEST_PX / aspect) if aspect >= 1 else (LONGEST_PX * aspect, LONGEST_PX)


def level_scene(rng, camera, count):
    """Scenes inside the flat methods' domain whose pixels float64 resolves."""
    t = np.hypot(*camera.half_tangents)
    radius = WGS84.b_m**2 / WGS84.a_m
    top = min(HIGHEST_M, accuracy.FLAT_DOMAIN * radius / t**2)
    finest = accuracy.RESOLVED_M * np.hypot(*image_size(camera)) / 2 / t
    bottom = max(LOWEST_M, finest)
    if bottom >= top:
        return None
    agl, lat = 10 ** rng.uniform(np.log10(bottom), np.log10(top), count), latitudes(rng, count)
    inside = agl / radius * t * np.maximum(np.abs(np.tan(np.radians(lat))), 1.0) <= accuracy.FLAT_DOMAIN
    agl, lat = agl[inside], lat[inside]
    if not len(lat):
        return None
    lon, yaw = rng.uniform(-180, 180, len(lat)), rng.uniform(0, 360, len(lat))
    level = np.zeros(len(lat))
    return ImageGeometry(camera, *image_size(camera), Poses(lat, lon, agl, yaw, level, level))


def away_px(scene, lat, lon, wanted):
    """Distance in the image, px, of where the exact camera sees ground points from where it should; inf where not."""
    camera, poses = scene.camera, scene.poses
    columns = (
        values[:, np.newaxis] for values in (poses.lat_deg, poses.agl_m, poses.yaw_deg, poses.tilt_deg, poses.roll_deg)
    )
    lat_deg, agl, yaw, tilt, roll = columns
    fov, aspect = camera.fov_deg, camera.aspect_ratio
    seen = longdouble.look(lat_deg, agl, fov, aspect, yaw, tilt, roll, lat, lon)
    x, y = (seen.x - wanted[..., 0]) * scene.width_px / 2, (seen.y - wanted[..., 1]) * scene.height_px / 2
    return np.where(seen.visible, np.hypot(x, y), np.inf).astype(float)


def corners_away_px(scene, corners):
    """As `away_px` of corners, whose longitudes are the world's: their rounding is an error, too."""
    dlon = corners.lon_deg.astype(longdouble.Real) - scene.poses.lon_deg[:, np.newaxis]
    return away_px(scene, corners.lat_deg, dlon, np.array(CORNERS))


def facts(scene):
    names = ("lat_deg", "agl_m", "yaw_deg", "tilt_deg", "roll_deg")
    return {
        "fov_deg": scene.camera.fov_deg,
        "aspect_ratio": scene.camera.aspect_ratio,
        **{name: np.asarray(getattr(scene.poses, name)) for name in names},
    }


def level_methods(seed, draws, each) -> dict[str, Tally]:
    """Footprints loc1, loc2 and exact, the map frame, and leaving a small yaw out."""
    rng = np.random.default_rng(seed)
    tallies = {name: Tally() for name in ("loc1", "loc2", "map", "yaw left out")}
    for camera in cameras(rng, draws):
        scene = level_scene(rng, camera, each)
        if scene is None:
            continue
        for name, bound in (("loc1", loc1_px), ("loc2", loc2_px)):
            corners = FOOTPRINTS[name](camera, scene.poses, CORNERS, WGS84)
            error = corners_away_px(scene, corners).max(axis=1)
            tallies[name].add(error / bound(scene), **facts(scene))
        poses = scene.poses
        north_up = ImageGeometry(
            camera, scene.width_px, scene.height_px, poses._replace(yaw_deg=np.zeros(len(poses.lat_deg)))
        )
        lat, dlon, wanted = map_frame_points(camera, north_up.poses)
        error = away_px(north_up, lat, dlon, wanted).max(axis=1)
        tallies["map"].add(error / accuracy.map_frame_px(north_up), **facts(north_up))
        small = poses._replace(yaw_deg=10 ** rng.uniform(-8, -0.5, len(poses.lat_deg)))
        turned = ImageGeometry(camera, scene.width_px, scene.height_px, small)
        error = away_px(turned, lat, dlon, wanted).max(axis=1)
        tallies["yaw left out"].add(error / accuracy.map_frame_px(turned), **facts(turned))
    return tallies


def map_frame_points(camera, poses):
    """Ground that a map frame shows at a grid of image points, and those points."""
    edges = map_frame_edges(camera, poses)
    share = np.linspace(0, 1, GRID)
    x, y = (values.ravel() for values in np.meshgrid(share, share))
    u = edges.west_u[:, np.newaxis] + edges.size[0][:, np.newaxis] * x
    v = edges.top_v[:, np.newaxis] + edges.size[1][:, np.newaxis] * y
    return longdouble.latitude_deg(v), u * longdouble.Real(360), np.stack([2 * x - 1, 1 - 2 * y], axis=-1)


def any_pose(rng, camera, count):
    """Scenes of any attitude and height whose pixels float64 resolves."""
    t = np.hypot(*camera.half_tangents)
    bottom = max(LOWEST_M, accuracy.RESOLVED_M * np.hypot(*image_size(camera)) / 2 / t)
    if bottom >= HIGHEST_M:
        return None
    agl = 10 ** rng.uniform(np.log10(bottom), np.log10(HIGHEST_M), count)
    tilt = np.where(rng.random(count) < 0.3, 0.0, rng.uniform(0, 110, count))
    roll = np.where(rng.random(count) < 0.5, 0.0, rng.uniform(-60, 60, count))
    lat, lon = latitudes(rng, count), rng.uniform(-180, 180, count)
    poses = Poses(lat, lon, agl, rng.uniform(0, 360, count), tilt, roll)
    resolved = accuracy.finest_px_m(ImageGeometry(camera, *image_size(camera), poses)) >= accuracy.RESOLVED_M
    return ImageGeometry(camera, *image_size(camera), poses.take(resolved)) if resolved.any() else None


def exact_footprints(seed, draws, each) -> Tally:
    """The exact camera's corners, of those that hit."""
    rng, tally = np.random.default_rng(seed), Tally()
    for camera in cameras(rng, draws):
        scene = any_pose(rng, camera, each)
        if scene is None:
            continue
        corners = exact(camera, scene.poses, CORNERS, WGS84)
        error = corners_away_px(scene, corners)
        # Points of the very horizon may be hidden by a rounding: they face the camera edge on.
        error = np.where(corners.hit & np.isfinite(error), error, 0.0).max(axis=1)
        some = corners.hit.any(axis=1)
        tally.add(
            (error / accuracy.exact_px(scene))[some],
            **{k: np.ravel(v)[some] if np.size(v) > 1 else v for k, v in facts(scene).items()},
        )
    return tally


def meshes(seed, draws, tolerance_px, widest=179.9, narrowest=0.01) -> tuple[Tally, Tally]:
    """Points in the cells of meshes over their cell's bound: all of them, and the worst of each mesh."""
    rng, of_points, of_meshes = np.random.default_rng(seed), Tally(), Tally()
    for camera in cameras(rng, draws, widest, narrowest):
        width, height = (max(round(size), 1) for size in image_size(camera))
        one = any_pose(rng, camera, 1)
        if one is None:
            continue
        scene = ImageGeometry(camera, width, height, one.poses)
        cells = mesh(ImageRays.from_scene(scene), tolerance_px)
        if not len(cells.box):
            continue
        which = rng.integers(0, len(cells.box), POINTS_A_MESH)
        a, b = rng.random((2, POINTS_A_MESH))
        box = cells.box[which]
        column, row = box[:, 0] + a * (box[:, 2] - box[:, 0]), box[:, 1] + b * (box[:, 3] - box[:, 1])
        du, v = perspective(cells.du[which], cells.v[which], a, b)
        wanted = np.stack([2 * column / width - 1, 1 - 2 * row / height], axis=-1)
        error = away_px(scene, longdouble.latitude_deg(v)[np.newaxis], du[np.newaxis] * 360.0, wanted)[0]
        ratio = error / cells.bound_px[which]
        of_points.add(ratio, **facts(scene))
        of_meshes.add([ratio.max()], **facts(scene))
    return of_points, of_meshes


def perspective(du, v, a, b):
    """Where the perspective through four corners puts points of the unit square (a right, b down)."""
    corner_a, corner_b = np.array([0.0, 0.0, 1.0, 1.0]), np.array([0.0, 1.0, 1.0, 0.0])
    u0, v0 = du[:, :1], v[:, :1]
    # Scaled to the cell, so that the system is well conditioned.
    size_u = np.maximum(np.ptp(du, axis=1, keepdims=True), 1e-300)
    size_v = np.maximum(np.ptp(v, axis=1, keepdims=True), 1e-300)
    x, y = (du - u0) / size_u, (v - v0) / size_v
    zero, one = np.zeros_like(x), np.ones_like(x)
    ca, cb = np.broadcast_to(corner_a, x.shape), np.broadcast_to(corner_b, x.shape)
    upper = np.stack([ca, cb, one, zero, zero, zero, -ca * x, -cb * x], axis=-1)
    lower = np.stack([zero, zero, zero, ca, cb, one, -ca * y, -cb * y], axis=-1)
    solved = np.linalg.solve(np.concatenate([upper, lower], axis=1), np.concatenate([x, y], axis=1)[..., np.newaxis])[
        ..., 0
    ]
    depth = 1 + solved[:, 6] * a + solved[:, 7] * b
    along = (solved[:, 0] * a + solved[:, 1] * b + solved[:, 2]) / depth
    down = (solved[:, 3] * a + solved[:, 4] * b + solved[:, 5]) / depth
    return u0[:, 0] + along * size_u[:, 0], v0[:, 0] + down * size_v[:, 0]


def camera_frames(seed, draws, each) -> tuple[Tally, Tally]:
    """Points of camera frames whose every pixel is traced, those on the map: all of them, and the worst of each frame.

    Positions are those that pixels are read at: fractions of the world that count from its west edge.
    """
    rng, of_points, of_frames = np.random.default_rng(seed), Tally(), Tally()
    for camera in cameras(rng, draws):
        width, height = (max(round(size), 1) for size in image_size(camera))
        some = any_pose(rng, camera, each)
        if some is None:
            continue
        for at in range(len(some.poses.lat_deg)):
            scene = ImageGeometry(camera, width, height, some.poses.take(slice(at, at + 1)))
            column, row = (rng.uniform(0, size, POINTS_A_FRAME) for size in (width, height))
            lon = scene.poses.lon_deg
            du, v, hit = ImageRays.from_scene(scene).map_points(column, row)
            hit &= (v >= 0) & (v <= 1)
            if not hit.any():
                continue
            u = lon_to_u(lon) + du[hit]
            dlon = (u.astype(longdouble.Real) - 0.5) * 360 - lon
            wanted = np.stack([2 * column / width - 1, 1 - 2 * row / height], axis=-1)[hit]
            error = away_px(scene, longdouble.latitude_deg(v[hit])[np.newaxis], dlon[np.newaxis], wanted)[0]
            # Points of the very horizon may be hidden by a rounding: they face the camera edge on.
            ratio = np.where(np.isfinite(error), error, 0.0) / accuracy.camera_frame_px(scene)
            of_points.add(ratio, **facts(scene))
            of_frames.add([ratio.max()], **facts(scene))
    return of_points, of_frames


class Rectangles(NamedTuple):
    """Rectangles looked at, how many of them have extent, and the most px by which a border leaves its image."""

    count: int
    with_extent: int
    worst_px: float


def rectangles_inside(seed, draws, each) -> Rectangles:
    """How far borders of inscribed rectangles leave their images; infinite where the Earth hides a point of one."""
    rng = np.random.default_rng(seed)
    share = np.concatenate([np.linspace(0, 1, 17), np.geomspace(1e-3, 0.05, 6)])
    low, high = 0 * share, 0 * share + 1
    across, down = np.concatenate([share, share, low, high]), np.concatenate([low, high, share, share])
    count, with_extent, worst = 0, 0, -np.inf
    for camera in cameras(rng, draws, 179.9):
        scene = any_pose(rng, camera, each)
        if scene is None:
            continue
        edges, at = _rectangles(camera, scene.poses)
        count += len(at)
        sized = (edges.size[0] > 0) & (edges.size[1] > 0)
        if not sized.any():
            continue
        edges, at = FrameEdges(*(side[sized, np.newaxis] for side in edges)), at[sized]
        with_extent += len(at)
        some = ImageGeometry(camera, scene.width_px, scene.height_px, scene.poses.take(at))
        seen = longdouble.look(
            *(values[:, np.newaxis] for values in (some.poses.lat_deg, some.poses.agl_m)),
            camera.fov_deg,
            camera.aspect_ratio,
            *(values[:, np.newaxis] for values in some.poses.attitude),
            longdouble.latitude_deg(edges.top_v + edges.size[1] * down),
            (edges.west_u + edges.size[0] * across) * 360.0,
        )
        beyond = np.maximum((np.abs(seen.x) - 1) * scene.width_px / 2, (np.abs(seen.y) - 1) * scene.height_px / 2)
        noise = accuracy.mesh_noise_px(some)[:, np.newaxis]
        worst = max(worst, float(np.max(np.where(seen.visible, beyond - noise, np.inf))))
    return Rectangles(count, with_extent, worst)


def _rectangles(camera, poses):
    """Rectangles of those poses that see ground, and which poses they are."""
    every = np.arange(len(poses.lat_deg))
    try:
        return inscribed_edges(camera, poses), every
    except InvalidInput:
        found = []
        for at in every:
            with contextlib.suppress(InvalidInput):
                found.append((inscribed_edges(camera, poses.take(every[at : at + 1])), at))
        sides = zip(*(edges for edges, _ in found)) if found else [[np.empty(0)]] * 4
        return FrameEdges(*(np.concatenate(side) for side in sides)), np.array([at for _, at in found], int)
