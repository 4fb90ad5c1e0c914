"""Errors of positions: methods against the exact camera, recomputed in numpy's long double."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput, Message
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.camera import CORNERS, Camera, Poses
from ..geodesy.ellipsoid import WGS84
from ..geodesy.footprint import Footprint, outline
from ..geodesy.frames import in_image, map_frame_edges, plane_runs, quarter_turns
from ..geodesy.mercator import MERCATOR, Plane, wrap_lon_deg
from ..geodesy.view import Cells, ImageRays, mesh
from ..mission.plan import Plan
from ..mission.relief.roofed import seen_surface

#: Images whose pixels are compared.
_IMAGES = 3
#: Rays compared along the longer side of an image.
_RAYS = 48
#: Arrays of long double, whose name in numpy depends on the platform.
Long = NDArray[Any]


def spread(count: int, most: int) -> NDArray[np.intp]:
    """At most ``most`` indices spread evenly from 0 to ``count - 1``, both included."""
    indices: NDArray[np.intp] = np.unique(np.round(np.linspace(0, count - 1, min(count, most))).astype(np.intp))
    return indices


def capture_scene(plan: Plan, which: NDArray[np.intp]) -> ImageGeometry:
    """Geometry of some captures of a plan, in px of their planned images."""
    width, height = (np.asarray(size[which], np.float64) for size in (plan.frames.width_px, plan.frames.height_px))
    return ImageGeometry(plan.mission.camera, width, height, plan.poses.take(which), plan.ground)


def bounds_scene(plan: Plan) -> ImageGeometry:
    """Geometry whose bounds hold for a whole plan, and by which its methods were chosen: a capture of each row."""
    first = np.asarray(plane_runs(plan.grid, plan.poses)[0], np.intp)
    sizes = plan.frames.scene_sizes_px(plan.windows, first)
    return ImageGeometry(plan.mission.camera, *sizes, plan.poses.take(first), plan.ground)


def captures(plan: Plan) -> NDArray[np.intp]:
    """Captures that errors are measured on: up to 400, spread over the rows."""
    return spread(len(plan), 400)


class MeshErrors(NamedTuple):
    """Errors of camera frames that a mesh draws.

    Attributes
    ----------
    errors_px : array (n,)
        Empty if no ground on the map is seen.
    reached_px : float
        Greatest bound of a cell, at most the tolerance; 0 if every pixel is traced.
    cells : bytes
        Equal for equal meshes.
    """

    errors_px: Floats
    reached_px: float
    cells: bytes


def footprint_errors_px(plan: Plan, footprint: Footprint) -> Floats:
    """Errors (n,) of a method's corners, and of the exact outline where corners miss the Earth.

    Longitudes are those of the plan, so that errors include the rounding of degrees.
    """
    scene = capture_scene(plan, captures(plan))
    found = footprint(scene.camera, scene.poses, CORNERS, scene.ground)
    x, y = (np.broadcast_to(np.array(CORNERS)[:, axis], found.lat_deg.shape) for axis in (0, 1))
    dlon = found.lon_deg - scene.poses.lon_deg[:, np.newaxis]
    errors = [errors_px(scene, found.lat_deg, dlon, x, y)[found.hit]]
    if found.hit.all():
        return errors[0]
    # Outlines are slow: four are measured.
    for index in spread(len(plan), 4).tolist():
        one = capture_scene(plan, np.array([index], np.intp))
        ring = outline(
            one.camera,
            float(one.poses.lat_deg[0]),
            float(one.poses.agl_m[0]),
            _attitude(one.poses),
            one.ground,
        )
        x, y = ring.image_xy.T[:, np.newaxis]
        inside = np.hypot(x, y) <= np.sqrt(2.0)
        errors.append(errors_px(one, ring.lat_deg[np.newaxis], ring.dlon_deg[np.newaxis], x, y)[inside])
    return np.concatenate([part.ravel() for part in errors])


def _attitude(poses: Poses) -> tuple[float, float, float]:
    yaw, tilt, roll = (float(angle[0]) for angle in poses.attitude)
    return yaw, tilt, roll


def map_frame_errors_px(plan: Plan) -> Floats:
    """Errors (n,) inside map frames, at 9 by 9 points, before their edges are rounded to pixels.

    Rounding moves the frame but not its content, and the georeference includes it.
    """
    scene = capture_scene(plan, captures(plan))
    edges = map_frame_edges(scene.camera, scene.poses, scene.ground, plan.grid.plane)
    along, down = (part.ravel() for part in np.meshgrid(*(np.linspace(0.0, 1.0, 9),) * 2))
    west, east, top, bottom = (edge[:, np.newaxis] for edge in edges)
    du, v = west + (east - west) * along, top + (bottom - top) * down
    shares = (np.broadcast_to(part, v.shape) for part in (along, down))
    column, row = in_image(quarter_turns(scene.poses, plan.grid.plane), *shares)
    x, y = 2.0 * column - 1.0, 1.0 - 2.0 * row
    return map_errors_px(scene, du, v, x, y, plan.grid.plane).ravel()


def mesh_errors(plan: Plan, tolerance_px: float) -> MeshErrors:
    """Errors of camera frames drawn by a mesh, or by rays for a tolerance of 0.

    Pixels outside the cells of a mesh are traced, too.
    """
    errors, reached_px, same = [np.empty(0)], 0.0, []
    for index in spread(len(plan), _IMAGES).tolist():
        scene = capture_scene(plan, np.array([index], np.intp))
        rays = ImageRays.from_scene(scene, plan.grid.plane)
        cells = mesh(rays, tolerance_px)
        if len(cells.loose):
            errors.append(_traced(rays))
        if len(cells.box):
            errors.append(_errors_on_map(rays, *_inside(cells)))
            reached_px = max(reached_px, float(cells.bound_px.max()))
        same += [cells.box.tobytes(), b"|", cells.loose.tobytes(), b"|"]
    return MeshErrors(np.concatenate(errors), reached_px, b"".join(same))


def level_below(plan: Plan, index: int, scene: ImageGeometry) -> ImageGeometry:
    """Geometry of a capture over relief, with level ground at the relief's height below the camera."""
    height, ground = float(plan.height_m[index]), float(plan.ground_m[index])
    poses = scene.poses._replace(agl_m=np.array([height - ground]))
    return replace(scene, poses=poses, ground=WGS84.raised(ground))


def relief_errors_px(plan: Plan, tolerance_px: float | None) -> Floats:
    """Errors (n,) of pixels over relief: by rays of a tolerance or, for None, on level ground.

    Each pixel's position is raised to the relief and projected back to the image; occlusion is ignored.
    """
    found = [np.empty(0)]
    for index in spread(len(plan), _IMAGES).tolist():
        scene = capture_scene(plan, np.array([index], np.intp))
        across, down = (int(size) for size in scene.one_size_px)
        step = max(max(across, down) // _RAYS, 1)
        row, column = (part.ravel() for part in np.mgrid[0:down:step, 0:across:step])
        x_px, y_px = column + 0.5, row + 0.5
        if tolerance_px is None:
            lat, dlon, height = _level_on_relief(plan, level_below(plan, index, scene), x_px, y_px)
        else:
            seen = replace(plan.views.tracing(index), tolerance_px=tolerance_px).sighting
            lat, lon, height = (part[row, column] for part in seen[1:4])
            dlon = lon - float(plan.lon_deg[index])
        hit = np.isfinite(height)
        if not hit.any():
            continue
        over = replace(scene, poses=scene.poses._replace(agl_m=plan.height_m[index : index + 1]), ground=WGS84)
        x, y = 2.0 * x_px / across - 1.0, 1.0 - 2.0 * y_px / down
        one_row = (part[hit][np.newaxis] for part in (lat, dlon, x, y, height))
        found.append(errors_px(over, *one_row).ravel())
    return np.concatenate(found)


def _level_on_relief(plan: Plan, level: ImageGeometry, x_px: Floats, y_px: Floats) -> tuple[Floats, Floats, Floats]:
    """Latitudes and longitudes at which image points see level ground, and the relief's heights there, else NaN."""
    seen = ImageRays.from_scene(level).ground(x_px, y_px)
    lon_deg = float(level.poses.lon_deg[0])
    height = np.full(len(x_px), np.nan)
    if not plan.relief.is_level and seen.hit.any():
        lat, lon = seen.lat_deg[seen.hit], lon_deg + seen.dlon_deg[seen.hit]
        surface = seen_surface(plan.relief.heights).surface(lat, lon, 0.0)
        height[seen.hit] = surface.heights(*surface.position(lat, lon))
    return seen.lat_deg, seen.dlon_deg, height


def _traced(rays: ImageRays) -> Floats:
    """Errors (n,) of rays through an image; empty if it sees no ground on the map."""
    across, down = rays.scene.one_size_px
    step = max(across, down) / _RAYS
    x, y = (part.ravel() for part in np.meshgrid(np.arange(0.5, across + 0.5, step), np.arange(0.5, down + 0.5, step)))
    du, v, hit = rays.map_points(x, y)
    hit &= rays.on_map(v)
    return _errors_on_map(rays, du[hit], v[hit], x[hit], y[hit])


def _inside(cells: Cells) -> tuple[Floats, Floats, Floats, Floats]:
    """Map and image positions of points inside cells, by the perspective through the corners of each."""
    # The 300 cells with the greatest bounds, and 300 spread over the image.
    worst = np.argsort(cells.bound_px)[-300:]
    some = np.union1d(worst, spread(len(cells.box), 300))
    box, du, v = cells.box[some].astype(np.float64), cells.du[some], cells.v[some]
    share = np.linspace(0.0, 1.0, 5)
    s, t = (part.ravel() for part in np.meshgrid(share, share))
    # Eight equations for the unit square, relative to a corner and in units of the cell to keep digits.
    unit = np.maximum(np.ptp(du, axis=1), np.ptp(v, axis=1))[:, np.newaxis]
    across, down = (du - du[:, :1]) / unit, (v - v[:, :1]) / unit
    corner_s, corner_t = np.array([0.0, 0.0, 1.0, 1.0]), np.array([0.0, 1.0, 1.0, 0.0])
    system = np.zeros((len(some), 8, 8))
    system[:, :4, 0], system[:, :4, 1], system[:, :4, 2] = corner_s, corner_t, 1.0
    system[:, 4:, 3:6] = system[:, :4, :3]
    wanted = np.concatenate([across, down], axis=1)
    system[:, :, 6], system[:, :, 7] = -np.tile(corner_s, 2) * wanted, -np.tile(corner_t, 2) * wanted
    found = np.linalg.solve(system, wanted[..., np.newaxis])[..., 0][:, :, np.newaxis]
    depth = 1.0 + found[:, 6] * s + found[:, 7] * t
    map_u = du[:, :1] + unit * (found[:, 0] * s + found[:, 1] * t + found[:, 2]) / depth
    map_v = v[:, :1] + unit * (found[:, 3] * s + found[:, 4] * t + found[:, 5]) / depth
    x = box[:, :1] + (box[:, 2:3] - box[:, :1]) * s
    y = box[:, 1:2] + (box[:, 3:] - box[:, 1:2]) * t
    return map_u.ravel(), map_v.ravel(), x.ravel(), y.ravel()


def _errors_on_map(rays: ImageRays, du: Floats, v: Floats, x_px: Floats, y_px: Floats) -> Floats:
    """Errors (n,) of map positions of image points in px from the upper left corner."""
    scene = rays.scene
    x, y = 2.0 * x_px / scene.width_px - 1.0, 1.0 - 2.0 * y_px / scene.height_px
    across, down, right, up = (part[np.newaxis] for part in (du, v, x, y))
    return map_errors_px(scene, across, down, right, up, rays.plane).ravel()


def map_frame_problem(plan: Plan) -> str:
    """Reason why captures cannot have map frames; empty if they can."""
    scene = capture_scene(plan, captures(plan))
    try:
        edges = map_frame_edges(scene.camera, scene.poses, scene.ground, plan.grid.plane)
    except InvalidInput as wrong:
        return Message(wrong)
    if plan.grid.plane.wraps and ((edges.top_v < 0.0).any() or (edges.bottom_v > 1.0).any()):
        return "it reaches beyond the map's latitudes"
    return ""


def floor_px(scene: ImageGeometry) -> float:
    """Error of the reference in px, the least that can be measured."""
    # A difference of geocentric coordinates has at most eight roundings.
    rounding_m = 8.0 * float(np.finfo(np.longdouble).eps) * scene.ground.a_m
    # The method's image coordinate is a float64.
    of_image = float(np.finfo(np.float64).eps) * float(np.max(scene.half_diagonal_px))
    return rounding_m / float(np.min(scene.nadir_px_m)) + of_image


def map_errors_px(scene: ImageGeometry, du: Floats, v: Floats, x: Floats, y: Floats, plane: Plane = MERCATOR) -> Floats:
    """Errors of map positions: world fractions (n, k) from the camera's meridian and the north edge; see `errors_px`.

    Web Mercator is inverted in long double, as float64 would add errors as large as those measured; other planes by
    PROJ, which is exact to some nanometres.
    """
    if not plane.wraps:
        ground_lat, ground_lon = plane.inverse(du, v)
        return errors_px(scene, ground_lat, wrap_lon_deg(ground_lon - scene.poses.lon_deg[:, np.newaxis]), x, y)
    across, down = (np.asarray(part, np.longdouble) for part in (du, v))
    lat: Long = np.arctan(np.sinh(_radians((0.5 - down) * 360))) / _radians(np.ones_like(down))
    return errors_px(scene, lat, across * 360, x, y)


def errors_px(
    scene: ImageGeometry, lat_deg: Long, dlon_deg: Long, x: Floats, y: Floats, height_m: Floats | float = 0.0
) -> Floats:
    """Distances in the image between points of a method and the points where the exact camera sees the same ground.

    Parameters
    ----------
    scene : ImageGeometry
        Geometry of n poses.
    lat_deg, dlon_deg : array (n, k)
        Ground points: geodetic latitude, and longitude from the camera's.
    x, y : array (n, k)
        Image points (right, up) of the method, -1..1.
    height_m : array (n, k) or float
        Heights of the ground points above the scene's ground.

    Returns
    -------
    array (n, k)
        Errors in px; infinite for points behind the camera.
    """
    seen_x, seen_y, in_front = _seen(scene, lat_deg, dlon_deg, height_m)
    width, height = (
        np.broadcast_to(np.asarray(size, np.float64), scene.poses.lat_deg.shape)[:, np.newaxis]
        for size in (scene.width_px, scene.height_px)
    )
    across, up = (seen_x - x) * width / 2.0, (seen_y - y) * height / 2.0
    return np.where(in_front, np.hypot(across, up), np.inf).astype(np.float64)


def _seen(
    scene: ImageGeometry, lat_deg: Long, dlon_deg: Long, height_m: Floats | float
) -> tuple[Long, Long, NDArray[np.bool_]]:
    """Image points of ground points, and whether they are in front of the camera."""
    a, b = np.longdouble(scene.ground.a_m), np.longdouble(scene.ground.b_m)
    e2 = (a - b) * (a + b) / a**2
    sin, cos = _sin_cos(scene.poses.lat_deg[:, np.newaxis])
    normal = a / np.sqrt(1 - e2 * sin**2)
    agl = scene.poses.agl_m[:, np.newaxis].astype(np.longdouble)
    point_sin, point_cos = _sin_cos(lat_deg)
    point_normal = a / np.sqrt(1 - e2 * point_sin**2)
    lon_sin, lon_cos = _sin_cos(dlon_deg)
    high = np.asarray(height_m, np.longdouble)
    outward = (point_normal + high) * point_cos * lon_cos - (normal + agl) * cos
    east = (point_normal + high) * point_cos * lon_sin
    polar = (point_normal * (1 - e2) + high) * point_sin - (normal * (1 - e2) + agl) * sin
    return _image(scene.camera, scene.poses.attitude, (east, cos * polar - sin * outward, cos * outward + sin * polar))


def _image(
    camera: Camera, attitude: tuple[Floats, Floats, Floats], enu: tuple[Long, Long, Long]
) -> tuple[Long, Long, NDArray[np.bool_]]:
    """Rotate east, north, up by yaw, tilt and roll, and project."""
    (sin_yaw, cos_yaw), (sin_tilt, cos_tilt), (sin_roll, cos_roll) = (
        _sin_cos(angle[:, np.newaxis]) for angle in attitude
    )
    east, north, up = enu
    forward: Long = sin_yaw * east + cos_yaw * north
    right: Long = cos_yaw * east - sin_yaw * north
    down: Long = -up
    forward, down = cos_tilt * forward - sin_tilt * down, sin_tilt * forward + cos_tilt * down
    right, down = cos_roll * right + sin_roll * down, cos_roll * down - sin_roll * right
    in_front = np.asarray(down > 0)
    depth = np.where(in_front, down, 1)
    if camera.distorts:
        half_x, half_y = camera.half_tangents
        ideal = np.stack([right / depth / half_x, forward / depth / half_y], axis=-1)
        seen = camera.seen_xy(ideal.astype(np.float64)).astype(np.longdouble)
        return seen[..., 0], seen[..., 1], in_front
    fov = np.asarray(camera.fov_deg, np.longdouble)
    # Above 90 degrees, use the complement, which keeps digits near 180.
    half = np.tan(_radians(fov) / 2) if camera.fov_deg <= 90.0 else 1 / np.tan(_radians(180 - fov) / 2)
    tan_y = half / np.hypot(np.longdouble(1), np.longdouble(camera.aspect_ratio))
    tan_x = tan_y * np.longdouble(camera.aspect_ratio)
    return right / depth / tan_x, forward / depth / tan_y, in_front


def _radians(angle_deg: Long) -> Long:
    return np.asarray(angle_deg * (np.arctan(np.longdouble(1)) / 45))


def _sin_cos(angle_deg: Long) -> tuple[Long, Long]:
    angle = _radians(np.asarray(angle_deg, np.longdouble))
    return np.sin(angle), np.cos(angle)
