"""Map frames: rectangles of source pixels, with rounded edges."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..errors import InvalidInput
from .accuracy import ImageGeometry, bound_px, map_frame_px, map_noise_px
from .camera import EDGE_MIDPOINTS, Camera, Poses
from .ellipsoid import WGS84, Ellipsoid, trace
from .mercator import MERCATOR, PixelGrid, Plane, lat_to_v, lon_to_u, wrap_lon_deg

#: Poses processed at a time, to bound memory.
_BATCH = 1 << 16


class FrameEdges(NamedTuple):
    """Edges of frames as world fractions, (n,) each.

    ``west_u`` and ``east_u`` count from the camera's meridian (on the plane of a source's CRS, from its west),
    ``top_v`` and ``bottom_v`` from the north.
    """

    west_u: Floats
    east_u: Floats
    top_v: Floats
    bottom_v: Floats

    @property
    def size(self) -> tuple[Floats, Floats]:
        """Width and height as world fractions, (n,) each."""
        return self.east_u - self.west_u, self.bottom_v - self.top_v


class Windows(NamedTuple):
    """Rectangles in a source's global pixel grid at one zoom; arrays of one shape (n,).

    Left and top count from 180° W and 85.0511° N, or from the upper left corner of the plane of the source's CRS; left
    is continuous (below 0 or beyond the world's width across the antimeridian). Left and top are whole numbers (int64),
    or float64 if the source places pictures by their centre.
    """

    left_px: Numbers | Floats
    top_px: Numbers | Floats
    width_px: Numbers
    height_px: Numbers

    @property
    def bounds_px(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Left, top, right and bottom edges as float64, (n,) each."""
        left, top = np.asarray(self.left_px, np.float64), np.asarray(self.top_px, np.float64)
        return left, top, left + self.width_px, top + self.height_px


class Sizes(NamedTuple):
    """Widths and heights of camera frames, px, (n,) each; a size shared by all frames is stored once."""

    width_px: Numbers
    height_px: Numbers

    @classmethod
    def from_widths(cls, width: Floats, aspect_ratio: float) -> Sizes:
        """Sizes in whole pixels of images of given widths, (n,); 0 where a side is under half a pixel."""
        widths = width[:1] if len(width) and width.min() == width.max() else width
        sides = (np.rint(side).astype(np.int64) for side in (widths, widths / aspect_ratio))
        return cls(*(np.broadcast_to(side, width.shape) for side in sides))

    @property
    def largest(self) -> tuple[int, int]:
        """Size of the largest image."""
        return int(self.width_px.max()), int(self.height_px.max())

    def take(self, which: NDArray[Any] | slice) -> Sizes:
        """Some of the sizes, by index, mask or slice."""
        count = self.width_px[which].shape
        return Sizes(*(side[which] if any(side.strides) else np.broadcast_to(side[:1], count) for side in self))

    def runs(self, first: NDArray[np.intp], run: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Split the runs of `Poses.runs` where the size of images changes."""
        if not any(self.width_px.strides + self.height_px.strides):
            return first, run
        change = np.zeros(len(run), bool)
        change[first] = True
        for side in self:
            change[1:] |= side[1:] != side[:-1]
        return np.flatnonzero(change), np.cumsum(change) - 1


def quarter_turns(poses: Poses, plane: Plane = MERCATOR) -> Numbers:
    """Clockwise quarter turns, 0 to 3, nearest to the angle from a plane's north to the tops of images, (n,)."""
    yaw = plane.grid_azimuth_deg(poses.yaw_deg, poses.lat_deg, poses.lon_deg)
    if not any(yaw.strides):
        # A yaw shared by all poses is stored once.
        return np.broadcast_to(_turns(yaw[:1]), yaw.shape)
    return _turns(yaw)


def _turns(yaw_deg: Floats) -> Numbers:
    turns: Numbers = np.mod(np.rint(yaw_deg / 90.0), 4.0).astype(np.int64)
    return turns


def swapped(turns: Numbers, width: Floats | float, height: Floats | float) -> tuple[Floats, Floats]:
    """Sizes along the map's x and y of images turned by quarter turns, (n,); applied twice, the original sizes."""
    across = turns % 2 == 1
    return np.where(across, height, width), np.where(across, width, height)


def in_image(turns: Numbers, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Columns and rows of images turned by quarter turns, as shares of their sizes, (n, ...).

    Parameters
    ----------
    turns : array (n,)
    x, y : array (n, ...)
        Shares of the rectangle on the map, from its upper left corner.
    """
    which = turns.reshape(turns.shape + (1,) * (np.ndim(x) - 1)) if np.ndim(x) else turns
    return np.choose(which, (x, y, 1.0 - x, 1.0 - y)), np.choose(which, (y, 1.0 - x, 1.0 - y, x))


def on_map(turns: Numbers, column: Floats, row: Floats) -> tuple[Floats, Floats]:
    """Shares of the rectangle on the map at columns and rows of images, (n, ...); the inverse of `in_image`."""
    return in_image((4 - turns) % 4, column, row)


def map_frame_edges(camera: Camera, poses: Poses, ground: Ellipsoid = WGS84, plane: Plane = MERCATOR) -> FrameEdges:
    """Map-frame edges of nadir cameras, through the exact midpoints of the image edges.

    Parameters
    ----------
    poses : Poses
        (n,), taken as level, with yaws rounded to quarter turns from the map's north.
    plane : WebMercator or ProjectedPlane
        The plane of the frames.

    Raises
    ------
    InvalidInput
        An edge midpoint looks past the Earth, beyond a pole of the map, or beyond the plane: no rectangle holds the
        picture.
    """
    lat_deg, agl_m = poses.lat_deg, poses.agl_m
    grid_north_deg = -plane.north_deg(lat_deg, poses.lon_deg)
    points: Floats = np.array(EDGE_MIDPOINTS)
    turned = quarter_turns(poses, plane) % 2 == 1
    if turned.any():
        # After a quarter turn, the width of the image runs from north to south.
        tan_x, tan_y = camera.half_tangents
        across = points * np.array([tan_y / tan_x, tan_x / tan_y])
        points = np.where(turned[:, np.newaxis, np.newaxis], across, points)
    seen = trace(lat_deg[:, np.newaxis], agl_m[:, np.newaxis], camera.rays_enu(points, grid_north_deg), ground)
    if not seen.hit.all():
        at = int(np.flatnonzero(~seen.hit.all(axis=1))[0])
        raise InvalidInput(
            "height {0:g} m with a field of view of {1:g} deg: the image reaches past the Earth's horizon",
            float(agl_m[at]),
            camera.fov_deg,
            remedy="fly lower or narrow the field of view",
        )
    u, v = plane.seen(seen.lat_deg, poses.lon_deg[:, np.newaxis], seen.dlon_deg)
    beyond = np.flatnonzero(plane.lacks_frames(u, seen.dlon_deg))
    if len(beyond):
        at = int(beyond[0])
        plane.refuse_frame(float(lat_deg[at]), float(poses.lon_deg[at]), float(agl_m[at]))
    return FrameEdges(u[:, 3], u[:, 1], v[:, 0], v[:, 2])


def plane_frame_px(scene: ImageGeometry, plane: Plane, bend: Floats | float) -> Floats:
    """Bound of the error of map frames on a plane that ignore a small attitude, (n,); on Web Mercator `map_frame_px`.

    The error of convergence, scale and curvature is measured at the corners of the image, the middles of its edges and
    its centre. Between these nine points a quadratic surface is at most (5/4)² times as large; ρ(max(w, h)/R)²(1 + B²)
    bounds higher orders, with B the plane's greatest ``bend``.
    """
    if plane.wraps:
        return map_frame_px(scene)
    count = len(scene.poses.lat_deg)
    if count > _BATCH:
        sizes = (np.broadcast_to(size, count) for size in (scene.width_px, scene.height_px))
        width, height = sizes
        parts = [
            plane_frame_px(
                ImageGeometry(scene.camera, width[at], height[at], scene.poses.take(at), scene.ground),
                plane,
                bend,
            )
            for at in (slice(start, start + _BATCH) for start in range(0, count, _BATCH))
        ]
        return np.concatenate(parts)
    poses, across = scene.poses, np.linspace(-1.0, 1.0, 3)
    x, y = (points.ravel() for points in np.meshgrid(across, across))
    rays = scene.camera.rays_enu(tuple(zip(x.tolist(), y.tolist())), *poses.attitude)
    seen = trace(poses.lat_deg[:, np.newaxis], poses.agl_m[:, np.newaxis], rays, scene.ground)
    u, v = plane.forward(seen.lat_deg, poses.lon_deg[:, np.newaxis] + seen.dlon_deg)
    edges = map_frame_edges(scene.camera, poses, scene.ground, plane)
    width, height = edges.size
    turns = quarter_turns(poses, plane)
    column, row = (np.broadcast_to(part, (count, len(x))) for part in ((x + 1.0) / 2.0, (1.0 - y) / 2.0))
    share_x, share_y = on_map(turns, column, row)
    off_x = (u - edges.west_u[:, np.newaxis]) / width[:, np.newaxis] - share_x
    off_y = (v - edges.top_v[:, np.newaxis]) / height[:, np.newaxis] - share_y
    width_px, height_px = swapped(turns, scene.width_px, scene.height_px)
    found = np.hypot(off_x * width_px[:, np.newaxis], off_y * height_px[:, np.newaxis]).max(axis=1)
    size_m = 2.0 * poses.agl_m * max(scene.camera.half_tangents)
    third = scene.half_diagonal_px * (size_m / scene.radius_m) ** 2 * (1.0 + bend**2)
    bound: Floats = bound_px(scene, 1.25**2 * found + third) + map_noise_px(scene)
    return np.where(np.isfinite(bound), bound, np.inf)


def frame_windows(edges: FrameEdges, run: NDArray[np.intp], lon_deg: Floats, grid: PixelGrid, zoom: int) -> Windows:
    """Frames on a source's pixel grid, with rounded edges.

    Parameters
    ----------
    edges : FrameEdges
        (k,), one per run of poses.
    run : array (n,)
        The run of each pose.
    lon_deg : array (n,)
        Longitudes with which the windows' left edges are continuous.
    """
    world = grid.world_px(zoom)
    u = grid.meridian_u(lon_deg)
    left, right = (_rounded((u + edge[run]) * float(world)) for edge in (edges.west_u, edges.east_u))
    top, bottom = (_rounded(edge * float(world)) for edge in (edges.top_v, edges.bottom_v))
    windows = Windows(left, top[run], right - left, (bottom - top)[run])
    if grid.centre_decimals is None:
        return windows
    return _centred(windows, grid, zoom, grid.centre_decimals)


def plane_runs(grid: PixelGrid, poses: Poses) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Runs of poses whose frames differ only in longitude: `Poses.runs` on the map, else every pose."""
    if grid.plane.wraps:
        return poses.runs()
    every = np.arange(len(poses.lat_deg))
    return every, every


def map_windows(camera: Camera, poses: Poses, grid: PixelGrid, zoom: int, ground: Ellipsoid = WGS84) -> Windows:
    """Map frames of nadir cameras on a source's pixel grid; raises InvalidInput as `map_frame_edges` does."""
    first, run = plane_runs(grid, poses)
    return frame_windows(map_frame_edges(camera, poses.take(first), ground, grid.plane), run, poses.lon_deg, grid, zoom)


def _rounded(position_px: Floats) -> Numbers:
    nearest = position_px + 0.5
    np.floor(nearest, out=nearest)
    whole: Numbers = nearest.astype(np.int64)
    return whole


def _centred(windows: Windows, grid: PixelGrid, zoom: int, decimals: int) -> Windows:
    """Windows about their centres as the source rounds them, enlarged so that each still covers its frame."""
    lat_deg, lon_deg = window_centres(windows, grid, zoom)
    world = grid.world_px(zoom)
    shift_px = 0.5 * 10.0**-decimals / 360.0 * world
    lat, lon = np.round(lat_deg, decimals), np.round(lon_deg, decimals)
    width = _whole_units(windows.width_px + 2.0 * shift_px, grid)
    height = _whole_units(windows.height_px + 2.0 * shift_px / np.cos(np.radians(lat_deg)), grid)
    left, _, right, _ = windows.bounds_px
    # The centre of a window may lie beyond the world's edge by whole turns, which are exact.
    turns = np.round((left + right) / 2.0 / world - lon_to_u(lon))
    left = (lon_to_u(lon) + turns) * world - 0.5 * width
    top = lat_to_v(lat) * world - 0.5 * height
    # A step far below a micrometre of ground and far above the noise of float64, so that every processor gets the same
    # edges.
    step_px = 2.0**-20
    left, top = (np.rint(edge / step_px) * step_px for edge in (left, top))
    return Windows(left, top, width, height)


def _whole_units(size_px: Floats, grid: PixelGrid) -> Numbers:
    """Sizes in px, rounded up to whole pixels in 256 px terms, the unit of requests to a source of centred pictures."""
    whole: Numbers = (np.ceil(size_px / grid.scale) * grid.scale).astype(np.int64)
    return whole


def window_centres(windows: Windows, grid: PixelGrid, zoom: int) -> tuple[Floats, Floats]:
    """Latitude and longitude (wrapped) in degrees of the windows' centres, (n,) each."""
    world = grid.world_px(zoom)
    left, top, right, bottom = windows.bounds_px
    lat_deg, lon_deg = grid.plane.inverse((left + right) / 2.0 / world, (top + bottom) / 2.0 / world)
    return lat_deg, wrap_lon_deg(lon_deg)
