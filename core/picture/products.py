"""Products for every pixel of a picture: depth, ground point, normal, and façades, which maps do not show."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..arrays import Floats, NDArray
from ..bands import Bands
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.ellipsoid import WGS84, sight_lines
from ..geodesy.mercator import wrap_lon_deg
from ..geodesy.raytracing.tracing import Sighting, power_of_two, relief_normals
from ..geodesy.view import ImageRays
from ..mission.plan import Plan
from .map_frame import turned
from .shot import MapShot, Shot

#: Bands of each product, in metres, degrees, and components of unit vectors.
BANDS = {
    "depth": Bands(("depth",), "float32", (0,)),
    "points": Bands(("longitude", "latitude", "height"), "float64", (0,)),
    "normals": Bands(("east", "north", "up"), "float32", (0,)),
    "facades": Bands(("face",), "uint8", (0,)),
}


def products(
    plan: Plan, index: int, size_px: tuple[int, int], shot: MapShot | Shot | None = None
) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """Compute the products that a mission asks for, for one capture's picture as written.

    Parameters
    ----------
    size_px : tuple of int
        Width and height of the picture.
    shot : MapShot, Shot or None
        Shot of the picture, whose traced rays are reused.

    Yields
    ------
    name, array (height, width, bands or one more) of the type in `BANDS`
        An extra channel is 0 where the picture shows no ground.
    """
    wanted = plan.mission.products
    if not wanted:
        return
    seen = sighting(plan, index, size_px, shot)
    has_ground = np.isfinite(seen.depth_m)
    for name in wanted:
        if name == "facades":
            yield name, (seen.steep * np.uint8(255))[..., np.newaxis]
            continue
        if name == "depth":
            values = seen.depth_m[..., np.newaxis]
        elif name == "points":
            values = np.stack([wrap_lon_deg(seen.lon_deg), seen.lat_deg, seen.height_m], axis=-1)
        else:
            # Digits beyond these are noise.
            values = _rounded(seen.normals, 2.0**-21)
        yield name, np.dstack([values, has_ground]).astype(BANDS[name].dtype)


def sighting(plan: Plan, index: int, size_px: tuple[int, int], shot: MapShot | Shot | None = None) -> Sighting:
    """Ground points of the pixels of a capture's picture, rounded to significant digits.

    Parameters
    ----------
    shot : MapShot, Shot or None
        Shot of the picture, whose traced rays are reused.
    """
    traced = shot.sighting if isinstance(shot, Shot) and size_px == plan.views.size_px(index) else None
    if traced is not None:
        seen = traced
    elif not plan.relief.is_level:
        seen = plan.views.tracing(index, size_px).sighting
    else:
        seen = _level_sighting(plan, index, size_px)
    pixel_m = plan.mission.camera.gsd_m_per_px(float(plan.agl_m[index]), max(size_px))
    # Round to 1/8192 of a pixel on the ground; further digits are noise.
    metre = power_of_two(pixel_m * 2.0**-13)
    degree = power_of_two(math.degrees(metre / WGS84.a_m))
    return seen._replace(
        depth_m=_rounded(seen.depth_m, metre),
        lat_deg=_rounded(seen.lat_deg, degree),
        lon_deg=_rounded(seen.lon_deg, degree),
        height_m=_rounded(seen.height_m, metre),
    )


def _rounded(values: Floats, step: float) -> Floats:
    found: Floats = np.rint(values / step) * step + 0.0
    return found


def _level_sighting(plan: Plan, index: int, size_px: tuple[int, int]) -> Sighting:
    """Points of level ground seen by the pixels of a picture."""
    pose = plan.poses.take(np.array([index]))
    camera, (width, height) = plan.mission.camera, size_px
    lat, lon, agl = (float(values[0]) for values in pose[:3])
    if plan.frames.on_map:
        left, top, wide, high = (float(values[index]) for values in plan.windows)
        world, turns = plan.grid.world_px(plan.zoom), int(plan.frames.quarter_turns[index])
        columns, rows = (width, height) if turns % 2 == 0 else (height, width)
        u = (left + (np.arange(columns) + 0.5) * wide / columns) / world
        v = (top + (np.arange(rows) + 0.5) * high / rows) / world
        ground_lat, ground_lon = (turned(at, turns) for at in plan.grid.plane.inverse(*np.meshgrid(u, v)))
        dlon, axis = wrap_lon_deg(ground_lon - lon), np.array([0.0, 0.0, -1.0])
    else:
        rays = ImageRays.from_scene(ImageGeometry(camera, width, height, pose, plan.ground))
        seen = rays.ground(*np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5))
        ground_lat, dlon = seen.lat_deg, seen.dlon_deg
        axis = camera.rays_enu(((0.0, 0.0),), *(angle[0] for angle in pose.attitude))[0]
    with np.errstate(invalid="ignore"):
        depth = sight_lines(np.array(lat), np.array(agl), ground_lat, dlon, plan.ground) @ axis
    height_m = np.where(np.isnan(depth), np.nan, plan.level_m)
    flat = np.where(np.isnan(depth), np.nan, 0.0)
    blank = Sighting.blank(depth.shape)
    return blank._replace(
        depth_m=depth, lat_deg=ground_lat, lon_deg=lon + dlon, height_m=height_m, normals=relief_normals(flat, flat)
    )
