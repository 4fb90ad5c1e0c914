"""Products for every pixel of a picture: depth, ground point, normal, and façades, which maps do not show."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..arrays import Floats, NDArray
from ..bands import Bands
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.ellipsoid import WGS84, sight_lines
from ..geodesy.interpolation import Interpolation
from ..geodesy.mercator import wrap_lon_deg
from ..geodesy.raytracing.tracing import Sighting, power_of_two, relief_normals
from ..geodesy.triangles import RELIEF
from ..geodesy.view import ImageRays
from ..labels.label_map import GroundBox, LabelMap
from ..labels.pieces import DegreePlane
from ..mission.parts import CLASSES, INSTANCES
from ..mission.plan import Plan
from ..mission.takes import middle_strips
from .map_frame import turned
from .shot import MapShot, Shot, join_sightings

#: Bands of each product, in metres, degrees, and components of unit vectors.
BANDS = {
    "depth": Bands(("depth",), "float32", (0,)),
    "points": Bands(("longitude", "latitude", "height"), "float64", (0,)),
    "normals": Bands(("east", "north", "up"), "float32", (0,)),
    "facades": Bands(("face",), "uint8", (0,)),
}
_DEGREES = DegreePlane()
#: Pixels whose ground is computed together.
_CACHED_PX = 1 << 14
#: Nodes of the polynomials that hold level ground along each side of an image.
_NODES = 12


def products(
    plan: Plan,
    index: int,
    size_px: tuple[int, int],
    shot: MapShot | Shot | None = None,
    labels: LabelMap | None = None,
) -> Iterator[tuple[str, NDArray[np.generic]]]:
    """Compute the products that a mission asks for, for one capture's picture as written.

    Parameters
    ----------
    size_px : tuple of int
        Width and height of the picture.
    shot : MapShot, Shot or None
        Shot of the picture, whose traced rays are reused.
    labels : LabelMap or None
        Labels for the products classes and instances.

    Yields
    ------
    name, array (height, width, bands or one more) of the type in `BANDS`
        An extra channel is 0 where the picture shows no ground. Classes and instances are arrays (height, width).
    """
    wanted = plan.mission.products
    measured = [name for name in wanted if name in BANDS]
    exact = None
    if measured or not (plan.relief.is_level or plan.frames.on_map):
        exact = _sighting(plan, index, size_px, shot)
    if labels is not None:
        drawn = dict(zip((CLASSES, INSTANCES), _labels(labels, plan, index, size_px, shot, exact)))
        yield from ((name, drawn[name]) for name in wanted if name in drawn)
    if not measured or exact is None:
        return
    seen = _settled(plan, index, size_px, exact)
    has_ground = np.isfinite(seen.depth_m)
    for name in measured:
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


def _labels(
    labels: LabelMap,
    plan: Plan,
    index: int,
    size_px: tuple[int, int],
    shot: MapShot | Shot | None,
    seen: Sighting | None,
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Classes and instances (h, w): of a map frame in its plane, of a camera frame in longitude and latitude."""
    if plan.frames.on_map:
        turns = int(plan.frames.quarter_turns[index])
        u, v = (turned(at, turns) for at in _map_positions(plan, index, size_px))
        # Places on a grid of the frame, whose edges may be curved in degrees.
        some = (np.unique(np.linspace(0, length - 1, 33).astype(np.int64)) for length in u.shape)
        at = np.ix_(*some)
        lat, lon = plan.grid.plane.inverse(u[at], v[at])
        return labels.draw(plan.grid.plane, u, v, _widened(GroundBox.around(lat, lon)))
    if seen is None:
        lat, dlon = _near_level_ground(plan, index, size_px)
        lon = float(plan.lon_deg[index]) + dlon
    else:
        lat, lon = seen.lat_deg, seen.lon_deg
    hidden = shot.hidden if isinstance(shot, Shot) else None
    if hidden is not None:
        rows, columns = ((np.arange(to) * 2 + 1) * of // (2 * to) for to, of in zip(lat.shape, hidden.shape))
        lat = np.where(hidden[np.ix_(rows, columns)], np.nan, lat)
    drawn = labels.draw(_DEGREES, lon, lat, GroundBox.around(lat, lon))
    if labels.with_buildings and seen is not None:
        kind = np.where(np.isfinite(lat), seen.kind, RELIEF)
        labels.add_buildings(drawn, kind, seen.instance)
    return drawn


def _widened(box: GroundBox | None) -> GroundBox | None:
    """Box with a tenth more on each side."""
    if box is None:
        return None
    across, up = (box.east - box.west) / 10.0, (box.north - box.south) / 10.0
    return GroundBox(box.west - across, box.south - up, box.east + across, box.north + up)


def sighting(plan: Plan, index: int, size_px: tuple[int, int], shot: MapShot | Shot | None = None) -> Sighting:
    """Ground points of the pixels of a capture's picture, rounded to significant digits.

    Parameters
    ----------
    shot : MapShot, Shot or None
        Shot of the picture, whose traced rays are reused.
    """
    return _settled(plan, index, size_px, _sighting(plan, index, size_px, shot))


def _sighting(plan: Plan, index: int, size_px: tuple[int, int], shot: MapShot | Shot | None) -> Sighting:
    """Ground points of the pixels of a capture's picture."""
    traced = shot.sighting if isinstance(shot, Shot) and size_px == plan.views.size_px(index) else None
    if traced is not None:
        return traced
    if not plan.relief.is_level:
        strips = middle_strips(plan, index, size_px)
        if len(strips) == 1:
            return plan.views.tracing(index, size_px).sighting
        tracings = (plan.views.tracing(index, size_px, rows=strip[:2], pose=strip.pose) for strip in strips)
        return join_sightings([one.sighting for one in tracings])
    return _level_sighting(plan, index, size_px)


def _digit_m(plan: Plan, index: int, size_px: tuple[int, int]) -> float:
    """1/8192 of a pixel on the ground, metres; further digits are noise."""
    return plan.camera(index).gsd_m_per_px(float(plan.agl_m[index]), max(size_px)) * 2.0**-13


def _settled(plan: Plan, index: int, size_px: tuple[int, int], seen: Sighting) -> Sighting:
    metre = power_of_two(_digit_m(plan, index, size_px))
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


def _map_positions(plan: Plan, index: int, size_px: tuple[int, int]) -> tuple[Floats, ...]:
    """World fractions u and v (h, w) of the centres of a map frame's pixels, before it is turned."""
    (width, height), turns = size_px, int(plan.frames.quarter_turns[index])
    left, top, wide, high = (float(values[index]) for values in plan.windows)
    world = plan.grid.world_px(plan.zoom)
    columns, rows = (width, height) if turns % 2 == 0 else (height, width)
    u = (left + (np.arange(columns) + 0.5) * wide / columns) / world
    v = (top + (np.arange(rows) + 0.5) * high / rows) / world
    return tuple(np.meshgrid(u, v))


def _level_ground(plan: Plan, index: int, size_px: tuple[int, int]) -> tuple[Floats, Floats]:
    """Latitudes (h, w) of level ground seen by the pixels of a camera frame, and longitudes from the camera's."""
    (width, height), camera = size_px, plan.camera(index)
    lat, dlon = np.empty((2, height, width))
    # By rows that fit in the processor's cache.
    rows = max(_CACHED_PX // width, 1)
    for first, end, pose in middle_strips(plan, index, size_px):
        rays = ImageRays.from_scene(ImageGeometry(camera, width, height, pose, plan.ground))
        for top in range(first, end, rows):
            part = slice(top, min(top + rows, end))
            seen = rays.ideal_ground(*rays.ideal_centres(part.start, part.stop))
            lat[part], dlon[part] = seen.lat_deg, seen.dlon_deg + (pose.lon_deg[0] - plan.lon_deg[index])
    return lat, dlon


def _near_level_ground(plan: Plan, index: int, size_px: tuple[int, int]) -> tuple[Floats, Floats]:
    """`_level_ground` within 1/8192 of a pixel, in a sixth of its time.

    Over a plane, offsets from the camera's position times the depth of rays are linear in pixels. The Earth and the
    lens bend them little, so polynomials hold them, unless the image reaches towards the horizon.
    """
    (width, height), pose = size_px, plan.poses.take(np.array([index]))
    if len(middle_strips(plan, index, size_px)) > 1:
        return _level_ground(plan, index, size_px)
    rays = ImageRays.from_scene(ImageGeometry(plan.camera(index), width, height, pose, plan.ground))
    across, down = (Interpolation.along(length, _NODES) for length in size_px)
    seen = rays.ground(*np.meshgrid(across.nodes, down.nodes))
    lat_deg = float(pose.lat_deg[0])
    most_deg = math.degrees(_digit_m(plan, index, size_px) / WGS84.a_m)
    fall = -rays.component(2, *rays.ideal_px(across.nodes, down.nodes[:, np.newaxis]))
    depth = -rays.component(2, *rays.ideal_centres(0, height))
    with np.errstate(invalid="ignore", divide="ignore"):
        offsets = [
            down.weights @ (at * fall) @ across.weights.T / depth for at in (seen.lat_deg - lat_deg, seen.dlon_deg)
        ]
    lat, dlon = lat_deg + offsets[0], offsets[1]
    # Polynomials are worst at the image's edges.
    for row, column in (
        (np.array([[0], [height - 1]]), np.arange(width)),
        (np.arange(height)[:, np.newaxis], np.array([0, width - 1])),
    ):
        edge = rays.ground(column + 0.5, row + 0.5)
        off = np.maximum(
            np.abs(edge.lat_deg - lat[row, column]),
            np.abs(edge.dlon_deg - dlon[row, column]) * math.cos(math.radians(lat_deg)),
        )
        # NaN is no ground.
        if not (off < most_deg).all():
            return _level_ground(plan, index, size_px)
    return lat, dlon


def _level_sighting(plan: Plan, index: int, size_px: tuple[int, int]) -> Sighting:
    """Points of level ground seen by the pixels of a picture."""
    pose = plan.poses.take(np.array([index]))
    lat, lon, agl = (float(values[0]) for values in pose[:3])
    if plan.frames.on_map:
        turns = int(plan.frames.quarter_turns[index])
        places = plan.grid.plane.inverse(*_map_positions(plan, index, size_px))
        ground_lat, ground_lon = (turned(at, turns) for at in places)
        dlon, axis = wrap_lon_deg(ground_lon - lon), np.array([0.0, 0.0, -1.0])
        depth = sight_lines(np.array(lat), np.array(agl), ground_lat, dlon, plan.ground) @ axis
    else:
        ground_lat, dlon = _level_ground(plan, index, size_px)
        depth = np.empty_like(dlon)
        for top, bottom, at in middle_strips(plan, index, size_px):
            rows, east = slice(top, bottom), at.lon_deg[0] - plan.lon_deg[index]
            axis = plan.camera(index).ideal_rays_enu(np.zeros((1, 2)), *(float(angle[0]) for angle in at.attitude))[0]
            with np.errstate(invalid="ignore"):
                lines = sight_lines(at.lat_deg[0], at.agl_m[0], ground_lat[rows], dlon[rows] - east, plan.ground)
            depth[rows] = lines @ axis
    height_m = np.where(np.isnan(depth), np.nan, plan.level_m)
    flat = np.where(np.isnan(depth), np.nan, 0.0)
    blank = Sighting.blank(depth.shape)
    return blank._replace(
        depth_m=depth, lat_deg=ground_lat, lon_deg=lon + dlon, height_m=height_m, normals=relief_normals(flat, flat)
    )
