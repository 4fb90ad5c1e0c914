"""Captures in flight order, with functions of all layouts: order, yaws and margins."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Floats, NDArray, Numbers
from ...errors import InvalidInput, Message, OptionName
from ...geodesy.ellipsoid import WGS84
from ...geodesy.frames import FrameEdges
from ...geodesy.mercator import MAX_LAT_DEG, lat_to_v, lon_to_u, u_to_lon, v_to_lat, wrap_lon_deg
from ..areas.area import Area, Box, Points, Polygon, touching
from ..flight.deviates import uniform
from ..flight.legs import legs
from ..mission import Mission
from ..parts import EASTWARD_DEG, NORTH, ONE_WAY, TRACK

#: Edges of the smallest frames at latitudes in degrees, (n,).
RowFrames = Callable[[Floats], FrameEdges]
#: Greatest shift of a frame's edge by rounding, by which the outermost frames extend beyond the area.
ROUNDING_PX = 0.5


class Layout(NamedTuple):
    """Captures in flight order: rows from north to south, flown to and fro or all in one direction.

    Arrays (n,): grid indices, poses in degrees and metres. Longitudes are continuous along a mission. Equal yaws take
    no memory.
    """

    column: Numbers
    row: Numbers
    lat_deg: Floats
    lon_deg: Floats
    agl_m: Floats
    yaw_deg: Floats


def refuse_beyond_mercator(box: Box) -> None:
    """Refuse areas outside the latitudes of Web Mercator."""
    for lat in (box.north_deg, box.south_deg):
        if abs(lat) > MAX_LAT_DEG:
            # Polar stereographic CRSs of Antarctica and the Arctic.
            raise InvalidInput(
                "area reaches latitude {0}: images end at ±{1:.4f} (Web Mercator)",
                lat,
                MAX_LAT_DEG,
                remedy=Message(
                    "choose imagery in a polar CRS, such as the synthetic world with {0} {1}",
                    OptionName("crs"),
                    ("EPSG:3031", "EPSG:3413")[lat > 0.0],
                ),
            )


def refuse_too_many(count: float, limit: int) -> None:
    """Refuse more images than the limit."""
    if count > limit:
        raise InvalidInput(
            "mission of {0:,.0f} images: the limit is {1:,}",
            count,
            limit,
            field="max_images",
            remedy=Message("fly higher, draw a smaller area, or raise it ({0})", OptionName("max_images")),
        )


def lay_out_points(mission: Mission) -> Layout:
    """Captures at the points of a mission, in order."""
    area = mission.area
    if not isinstance(area, Points):
        raise InvalidInput("rows cover an area")
    refuse_too_many(len(area.poses), mission.output.max_images)
    lat, lon, agl = np.array(area.poses, np.float64).reshape(-1, 3).T
    index = np.arange(len(lat), dtype=np.int64)
    yaws = point_angles_deg(mission, area, "yaw")
    return Layout(index, np.zeros_like(index), lat, lon, agl, yaws)


def point_angles_deg(mission: Mission, area: Points, name: str) -> Floats:
    """Yaw, tilt or roll of each point, (n,), from the table or the mission; a common value takes no memory."""
    stated = area.stated_deg(name)
    if stated:
        return np.array(stated, np.float64)
    angle = getattr(mission.attitude, f"{name}_deg")
    if name == "yaw" and mission.flight.facing == TRACK:
        return wrap_lon_deg(angle + _headings_deg(area))
    if name == "yaw":
        (angle,) = row_yaws_deg(mission)
    return np.broadcast_to(np.float64(angle), (len(area.poses),))


def _headings_deg(area: Points) -> Floats:
    """Azimuth from each point to the next at another position, (n,); at the end, the azimuth of the last leg."""
    lat, lon, _ = np.array(area.poses, np.float64).reshape(-1, 3).T
    flown_legs = legs(lat, lon)
    # Points within a micrometre are one position, without a heading to the next.
    moving = np.flatnonzero(flown_legs.distance_m > 1e-6)
    if not len(moving):
        return np.zeros(len(lat))
    ahead = np.searchsorted(moving, np.arange(len(lat)))
    headings: Floats = flown_legs.azimuth_deg[moving[np.minimum(ahead, len(moving) - 1)]]
    return headings


def row_yaws_deg(mission: Mission) -> tuple[float, ...]:
    """Yaws of rows along parallels: of rows flown east and, if it differs, of rows flown west; or yaws all around."""
    yaw, faced = mission.attitude.yaw_deg, mission.flight.faced_deg
    if turns_at_random(mission):
        # Images cover what all of these have in common.
        return tuple(_wrapped(turn * 15.0) for turn in range(24))
    if mission.flight.facing == NORTH:
        return (yaw,)
    if faced is not None:
        return (_wrapped(faced + yaw),)
    tracks = (EASTWARD_DEG, -EASTWARD_DEG)[: 1 + mission.flight.alternates_facing]
    return tuple(_wrapped(track + yaw) for track in tracks)


def turns_at_random(mission: Mission) -> bool:
    """Whether each image has a yaw at random."""
    return mission.attitude.random_yaw and mission.area.covers_ground


def random_yaws_deg(mission: Mission, count: int) -> Floats:
    """Yaws of images (count,) in flight order, uniform in [-180, 180): the same on every machine."""
    yaws: Floats = 360.0 * uniform(np.random.PCG64(np.random.SeedSequence(mission.imagery.seed)), count) - 180.0
    return yaws


def _wrapped(angle_deg: float) -> float:
    return float(wrap_lon_deg(np.array(angle_deg)))


def sees_below(mission: Mission) -> bool:
    """Whether images show the ground straight below the camera.

    Over lower ground such images grow on all sides, while others show different ground.
    """
    attitude = mission.attitude
    below, in_front = mission.camera.image_xy(np.array([[0.0, 0.0, -1.0]]), 0.0, attitude.tilt_deg, attitude.roll_deg)
    return bool(in_front[0] and (np.abs(below[0]) <= 1.0).all())


def bounds_with_margin(mission: Mission, area: Area) -> Box:
    """Box around an area, enlarged by the margin to the north and south."""
    box = area.bounds
    if not mission.flight.margin_m:
        return box
    beyond = math.degrees(_margin_angle(mission))
    return replace(box, north_deg=min(box.north_deg + beyond, 90.0), south_deg=max(box.south_deg - beyond, -90.0))


def _margin_angle(mission: Mission) -> float:
    """Greatest angle of a mission's margin in any direction, radians."""
    # 1 % more, as margin angles are computed on a sphere.
    return 1.01 * mission.flight.margin_m * WGS84.a_m / WGS84.b_m**2


def edges_with_margin(mission: Mission, top_v: Floats, bottom_v: Floats) -> tuple[Floats, Floats, Floats]:
    """Bands (n,) enlarged by the margin, and greatest extent of the margin to the east and west, degrees.

    On a sphere, ground within an angle d of a point at latitude φ extends asin(sin d / cos φ) to the east and west.
    """
    if not mission.flight.margin_m:
        return top_v, bottom_v, np.zeros(len(top_v))
    angle = _margin_angle(mission)
    north, south = v_to_lat(top_v) + math.degrees(angle), v_to_lat(bottom_v) - math.degrees(angle)
    farthest = np.minimum(np.maximum(np.abs(north), np.abs(south)), MAX_LAT_DEG)
    beside_deg = np.degrees(np.arcsin(np.minimum(math.sin(angle) / np.cos(np.radians(farthest)), 1.0)))
    top, bottom = (lat_to_v(np.clip(lat, -MAX_LAT_DEG, MAX_LAT_DEG)) for lat in (north, south))
    return np.minimum(top, top_v), np.maximum(bottom, bottom_v), beside_deg


def level_layout(mission: Mission, column: Numbers, row: Numbers, lat_deg: Floats, lon_deg: Floats) -> Layout:
    """Captures at the mission's height, in rows flown east or west."""
    agl = np.broadcast_to(np.float64(mission.flight.agl_m), row.shape)
    out, *back = row_yaws_deg(mission)
    yaw = np.where(is_flown_back(mission, row), back[0], out) if back else np.broadcast_to(np.float64(out), row.shape)
    return Layout(column, row, lat_deg, lon_deg, agl, yaw)


def is_flown_back(mission: Mission, row: Numbers) -> NDArray[np.bool_]:
    """Which captures are in rows flown against the azimuth of rows, (n,)."""
    return np.asarray((row % 2 == 1) & (mission.flight.order != ONE_WAY))


def refuse_no_step(step: Floats, overlap: float, mission: Mission) -> None:
    """Refuse steps between captures or rows that are not positive."""
    if not (step > 0.0).all():
        if overlap == 0.0:
            turned = mission.attitude.tilt_deg or mission.attitude.roll_deg
            raise InvalidInput(
                "images with under 0.001 px of map in them: the camera looks past the map or the Earth",
                field="tilt_deg" if turned else "agl_m",
                remedy="tilt it less or fly lower" if turned else "fly lower",
            )
        raise InvalidInput("overlap {0}: leaves under 0.001 px between captures", overlap, remedy="overlap less")


def picked(layout: Layout, which: NDArray[Any]) -> Layout:
    """Some of the captures, by index or mask."""
    column, row, *poses = layout
    column = column[which]
    # A value common to all takes no memory.
    kept = (values[which] if any(values.strides) else np.broadcast_to(values[:1], column.shape) for values in poses)
    return Layout(column, row[which], *kept)


def in_order(layout: Layout, order: str) -> Layout:
    """Captures row by row, to and fro or all in one direction; see `is_flown_back`."""
    column = layout.column if order == ONE_WAY else np.where(layout.row % 2, -layout.column, layout.column)
    return picked(layout, np.lexsort((column, layout.row)))


def images_touching(
    mission: Mission, area: Box | Polygon, layout: Layout, edges: FrameEdges, rounding: float
) -> Layout:
    """Captures whose frames, enlarged by rounding and the margin, overlap the area."""
    if isinstance(area, Box):
        return layout
    u = lon_to_u(layout.lon_deg)
    west, east = u_to_lon(u + edges.west_u - rounding), u_to_lon(u + edges.east_u + rounding)
    top_v, bottom_v, beside_deg = edges_with_margin(mission, edges.top_v - rounding, edges.bottom_v + rounding)
    keep = touching(area, west - beside_deg, v_to_lat(bottom_v), east + beside_deg, v_to_lat(top_v))
    return picked(layout, keep)
