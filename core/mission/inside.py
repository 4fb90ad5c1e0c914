"""Captures that lie wholly on the imagery of a source."""

from __future__ import annotations

import numpy as np

from ..arrays import Flags
from ..errors import InvalidInput
from ..geodesy.camera import Camera, Poses
from ..geodesy.ellipsoid import WGS84, Ellipsoid
from ..geodesy.footprint import Corners, exact
from ..geodesy.mercator import PixelGrid, wrap_lon_deg
from .areas.area import Points
from .layout.coverage import twice_area
from .lenses import Which
from .mission import Mission
from .plan import Plan

#: Pixels beyond the edge of an image that resampling may read.
_MARGIN_PX = 4.0
#: Poses per batch, which bounds the memory of their rims.
_BATCH = 20_000


def on_imagery(grid: PixelGrid, seen: Corners) -> Flags:
    """Which images (n,) lie within the extent of a source's imagery, given the ground (n, k) seen along their rims."""
    whole: Flags = seen.hit.all(axis=1)
    lat, lon = seen.lat_deg, seen.lon_deg
    with np.errstate(invalid="ignore"):
        u, v = grid.plane.forward(lat, lon if grid.plane.wraps else wrap_lon_deg(lon))
        if grid.extent is None:
            whole &= (np.isfinite(u) & (v >= 0.0) & (v <= 1.0)).all(axis=1)
            return whole
    corners = np.array(grid.extent, np.float64)
    corners = corners if twice_area(corners) > 0.0 else corners[::-1]
    if grid.plane.wraps:
        # Rims are continuous in longitude; the extent may lie whole turns away.
        u = u - np.rint(u[:, :1] - corners[:, 0].mean())
    sides = np.roll(corners, -1, axis=0) - corners
    margin = _MARGIN_PX / grid.world_px(grid.native_zoom)
    for (corner_u, corner_v), (side_u, side_v) in zip(corners, sides):
        length = max(float(np.hypot(side_u, side_v)), 1e-300)
        with np.errstate(invalid="ignore"):
            # Distance inward from the side.
            inward = (side_u * (v - corner_v) - side_v * (u - corner_u)) / length
            whole &= (inward >= margin).all(axis=1)
    return whole


def poses_inside(grid: PixelGrid, camera: Camera, poses: Poses, image_px: int, ground: Ellipsoid = WGS84) -> Flags:
    """Which poses (n,) over level ground see only ground that a source has imagery of.

    Parameters
    ----------
    image_px : int
        Pixels along the longer side of the images.
    """
    rim = _rim(camera, image_px)
    found = [
        on_imagery(grid, exact(camera, poses.take(slice(at, at + _BATCH)), rim, ground))
        for at in range(0, len(poses.lat_deg), _BATCH)
    ]
    return np.concatenate([np.zeros(0, np.bool_), *found])


def captures_inside(plan: Plan, grid: PixelGrid) -> Flags:
    """Which captures (n,) of a plan see only ground that a grid, the plan's or another, has imagery of."""
    image_px = int(max(plan.frames.width_px.max(), plan.frames.height_px.max()))

    def inside(camera: Camera, which: Which) -> tuple[Flags]:
        poses, height_m = plan.poses.take(which), plan.height_m[which]
        if plan.relief.is_level:
            return (poses_inside(grid, camera, poses, image_px, plan.ground),)
        rim, found = _rim(camera, image_px), []
        for at in range(0, len(height_m), _BATCH):
            some = slice(at, at + _BATCH)
            batch = poses.take(some)
            batch = batch._replace(lon_deg=wrap_lon_deg(batch.lon_deg))
            found.append(on_imagery(grid, plan.relief.seen(camera, batch, height_m[some], rim)[0]))
        return (np.concatenate(found),)

    (found,) = plan.cameras.together(inside)
    return found


def captured_points(mission: Mission, plan: Plan, kept: Flags) -> Mission:
    """Mission of the ``kept`` captures (n,) of a plan, as points with attitudes.

    Raises
    ------
    InvalidInput
        No capture is kept, or the mission has an area over relief, in wind or with random poses.
    """
    if not kept.any():
        raise InvalidInput(
            "none of the {0:,} images lies within the imagery",
            len(kept),
            remedy="choose another area, or lower flights",
        )
    if isinstance(mission.area, Points):
        return mission.replace(area=mission.area.take(plan.column[kept].tolist()))
    if not plan.relief.is_level or mission.moves_poses:
        raise InvalidInput(
            "images within the imagery: cannot be selected for an area over relief, in wind or with random poses",
            remedy="give points",
        )
    poses = plan.poses.take(np.flatnonzero(kept))
    places = zip(poses.lat_deg.tolist(), wrap_lon_deg(poses.lon_deg).tolist(), poses.agl_m.tolist())
    attitude = (tuple(angle.tolist()) for angle in poses.attitude)
    return mission.replace(area=Points(tuple(places), *attitude))


def _rim(camera: Camera, image_px: int) -> tuple[tuple[float, float], ...]:
    """Points along the rim of an image and of the margin that resampling reads around it, in image coordinates."""
    wide = camera.aspect_ratio >= 1.0
    longer, shorter = image_px, image_px / max(camera.aspect_ratio, 1.0 / camera.aspect_ratio)
    width, height = (longer, shorter) if wide else (shorter, longer)
    x, y = 1.0 + 2.0 * _MARGIN_PX / width, 1.0 + 2.0 * _MARGIN_PX / height
    level = [(along, side) for side in (-1.0, 1.0) for along in np.linspace(-1.0, 1.0, 17)]
    upright = [(side, along) for along, side in level]
    return tuple((x * horizontal, y * vertical) for horizontal, vertical in level + upright)
