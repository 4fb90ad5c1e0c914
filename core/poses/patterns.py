"""Flight patterns: corridors along lines, orbits around places, scans of walls and structures.

Corridors and scans run beside a line at constant distance. Around the outside of a corner they follow a circle; on the
inside they are cut where they would come nearer to another part of the line. They are computed in a plane about the
line's middle (EPSG method 9809), whose scale error is 2.5e-4 at `_REACH_M`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, Message
from ..geodesy.camera import Camera
from ..geodesy.mercator import wrap_lon_deg
from ..geodesy.projections import LocalPlane, geodesic_ends
from ..limits import MAX_POSES
from ..mission.areas.area import Points, Polygon, check_agl, check_lat_lon, check_polygons
from .settings import Corridor, Orbit, Scan
from .track import ANGLE_DIGITS, PLACE_DIGITS

#: Farthest that a pattern may reach from the middle of its line.
_REACH_M = 200_000.0


class _Path(NamedTuple):
    """Nodes of a path beside a line, (m,) each: metres in the plane, and headings clockwise from its second axis.

    Headings are continuous, not wrapped. Where a path turns on the spot, it has several nodes.
    """

    x_m: Floats
    y_m: Floats
    heading_deg: Floats

    def sampled(self, step_m: float, turning_m: float, *, closed: bool = False) -> _Path:
        """The path at even steps of at most ``step_m``, from start to end.

        A turn by one radian counts as ``turning_m`` metres. A closed path ends one step before its start.
        """
        moved = np.hypot(np.diff(self.x_m), np.diff(self.y_m))
        flown_m = np.append(0.0, np.cumsum(moved + turning_m * np.abs(np.radians(np.diff(self.heading_deg)))))
        # Rounding must not add a step.
        count = max(math.ceil(float(flown_m[-1]) / step_m * (1.0 - 1e-12)), 1)
        at = np.linspace(0.0, float(flown_m[-1]), count + 1)[: count + (not closed)]
        return _Path(*(np.interp(at, flown_m, values) for values in self))

    def reversed(self) -> _Path:
        """The path flown backwards."""
        return _Path(self.x_m[::-1], self.y_m[::-1], self.heading_deg[::-1] + 180.0)


def corridor(
    lines: Sequence[Floats],
    camera: Camera,
    agl_m: float,
    overlaps: tuple[float, float],
    wanted: Corridor,
) -> Points:
    """Rows along lines that cover a strip, flown to and fro; the top of each image points along its row.

    Around the outside of a corner, where the strip is round, images turn in steps that leave no gap.

    Parameters
    ----------
    lines : sequence of arrays (n, 2) or (n, 3)
        Latitude and longitude in degrees of each corner; sides take the shorter way around the Earth.
    agl_m : float
        Height above ground, metres.
    overlaps : (along, across)
        Shares of an image, in [0, 1), that the next image of the row and the next row show again.

    Raises
    ------
    InvalidInput
        No line, an invalid place, a line of one place, a line that is too long, or too many images.
    """
    check_agl(agl_m)
    along, across = map(_checked_overlap, overlaps)
    width_m, height_m = camera.ground_size_m(agl_m)
    # Rows overlap by at least 2 % of their width, for images that turn at corners.
    step_m, widest_m = height_m * (1.0 - along), width_m * min(1.0 - across, 1.0 - 0.02)
    rows = max(math.ceil((wanted.width_m - width_m) / widest_m), 0) + 1
    spacing_m = (wanted.width_m - width_m) / (rows - 1) if rows > 1 else 0.0
    columns: list[tuple[Floats, ...]] = []
    flown = images = 0
    for line in lines:
        plane, x, y = _on_plane(line[:, :2])
        for number in range(rows):
            right_m = wanted.offset_m + (number - (rows - 1) / 2.0) * spacing_m
            path = _offset_path(x, y, right_m, abs(right_m) - spacing_m, step_m)
            if path is None:
                continue
            reach_m = abs(right_m) + width_m / 2.0
            # Turned by half this angle, the corners of an image still reach beyond the strip of its row.
            turn = 2.0 * math.acos(1.0 - min((width_m - min(spacing_m, widest_m)) / 2.0 / reach_m, 1.0))
            row = path.sampled(step_m, max(width_m / 2.0, step_m / turn))
            images += len(row.x_m)
            _refuse_too_many(images)
            row = row.reversed() if flown % 2 else row
            columns.append(_poses(plane, row, row.heading_deg, agl_m, 0.0))
            flown += 1
    return _points(columns, "line")


def orbit(lat_deg: float, lon_deg: float, wanted: Orbit) -> Points:
    """Circles around a place, clockwise from north, lowest first; the camera looks at the target above the place.

    Heights are above the ground below each capture; over relief, let the mission count heights from the take-off.
    """
    check_lat_lon(lat_deg, lon_deg)
    _refuse_too_many(wanted.circles * wanted.images)
    columns = []
    bearing = np.arange(wanted.images) * (360.0 / wanted.images)
    lats, lons, radii = (np.full(wanted.images, value) for value in (lat_deg, lon_deg, wanted.radius_m))
    lat, lon, away = geodesic_ends(lats, lons, bearing, radii)
    for agl_m in _levels(wanted.lowest_m, wanted.highest_m, wanted.circles):
        tilt = math.degrees(math.atan2(wanted.radius_m, agl_m - wanted.target_m))
        columns.append((lat, lon, np.full(len(lat), agl_m), away + 180.0, np.full(len(lat), tilt)))
    return _points(columns, "centre")


def facade(
    lines: Sequence[Floats],
    camera: Camera,
    overlaps: tuple[float, float],
    wanted: Scan,
    *,
    left: bool = False,
) -> Points:
    """Flights along walls, lowest first, to and fro, on their right or left side; the camera looks at the wall.

    Parameters
    ----------
    lines : sequence of arrays (n, 2) or (n, 3)
        Latitude and longitude of the corners of each wall on the ground.
    overlaps : (along, across)
        Shares of an image of the wall that the next image of a flight and the next flight show again.

    Raises
    ------
    InvalidInput
        As for `corridor`; also if no place is at the distance from every part of the wall.
    """
    columns: list[tuple[Floats, ...]] = []
    for line in lines:
        plane, x, y = _on_plane(line[:, :2])
        columns += _scanned(plane, x, y, camera, overlaps, wanted, -1.0 if left else 1.0)
    return _points(columns, "line")


def structure(outlines: Sequence[Polygon], camera: Camera, overlaps: tuple[float, float], wanted: Scan) -> Points:
    """Flights around structures, lowest first; the camera looks at their walls. Courtyards are not flown.

    Raises
    ------
    InvalidInput
        As for `facade`.
    """
    check_polygons(outlines, Message("outlines"), "area")
    columns: list[tuple[Floats, ...]] = []
    for outline in outlines:
        lon, lat = outline.arrays()[0]
        plane, x, y = _on_plane(np.stack([lat, lon], axis=1), closed=True)
        # Flown anticlockwise, the outside lies to the right.
        twice = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
        x, y = (x, y) if twice > 0.0 else (x[::-1], y[::-1])
        columns += _scanned(plane, x, y, camera, overlaps, wanted, 1.0, closed=True)
    return _points(columns, "outline")


def _scanned(
    plane: LocalPlane,
    x: Floats,
    y: Floats,
    camera: Camera,
    overlaps: tuple[float, float],
    wanted: Scan,
    side: float,
    *,
    closed: bool = False,
) -> Iterator[tuple[Floats, ...]]:
    along, across = map(_checked_overlap, overlaps)
    width_m, height_m = camera.ground_size_m(wanted.distance_m)
    step_m = width_m * (1.0 - along)
    path = _offset_path(x, y, side * wanted.distance_m, wanted.distance_m, step_m, closed=closed)
    if path is None:
        raise InvalidInput(
            "distance {0:g} m: no place is so far from every wall",
            wanted.distance_m,
            field="distance_m",
            remedy="take a shorter distance",
        )
    flight = path.sampled(step_m, 0.0, closed=closed)
    high_m = (wanted.highest_m or wanted.lowest_m) - wanted.lowest_m
    # Rounding must not add a level.
    levels = math.ceil(high_m / (height_m * (1.0 - across)) * (1.0 - 1e-12)) + 1
    _refuse_too_many(levels * len(flight.x_m))
    for number, agl_m in enumerate(_levels(wanted.lowest_m, wanted.highest_m, levels)):
        flown, facing = (flight.reversed(), side) if number % 2 and not closed else (flight, -side)
        yield _poses(plane, flown, flown.heading_deg + 90.0 * facing, agl_m, wanted.tilt_deg)


def _levels(lowest_m: float, highest_m: float | None, count: int) -> list[float]:
    """Evenly spaced heights, lowest first."""
    levels: list[float] = np.linspace(lowest_m, lowest_m if highest_m is None else highest_m, count).tolist()
    return levels


def _checked_overlap(overlap: float) -> float:
    from ..fields import field_named
    from ..mission.parts import Flight

    field_named(Flight, "overlap_along").settled(overlap)
    return overlap


def _refuse_too_many(images: float) -> None:
    if images > MAX_POSES:
        raise InvalidInput("{0:,.0f} poses: must be from 1 to {1:,}", images, MAX_POSES)


def _on_plane(corners: Floats, *, closed: bool = False) -> tuple[LocalPlane, Floats, Floats]:
    """Plane about corners of latitude and longitude (n, 2), and their coordinates in it without repeated corners."""
    for lat, lon in corners.tolist():
        check_lat_lon(lat, lon)
    lat = corners[:, 0]
    lon = corners[0, 1] + np.append(0.0, np.cumsum(wrap_lon_deg(np.diff(corners[:, 1]))))
    plane = LocalPlane(float(lat.min() + lat.max()) / 2.0, float(wrap_lon_deg((lon.min() + lon.max()) / 2.0)))
    x, y = plane.forward(lat, plane.lon_deg + wrap_lon_deg(lon - plane.lon_deg))
    far_m = float(np.hypot(x, y).max())
    if not far_m <= _REACH_M:
        raise InvalidInput(
            "line of {0:,.0f} km: a pattern reaches up to {1:g} km",
            2.0 * far_m / 1000.0,
            2.0 * _REACH_M / 1000.0,
            remedy="take shorter lines",
        )
    before = np.roll(x, 1), np.roll(y, 1)
    # Corners within 1 mm of each other count as one.
    is_distinct = np.hypot(x - before[0], y - before[1]) > 1e-3
    if not closed:
        is_distinct[0] = True
    x, y = x[is_distinct], y[is_distinct]
    if len(x) < 2 + closed:
        raise InvalidInput("line of corners at one place: needs two or more")
    return plane, x, y


def _offset_path(
    x: Floats, y: Floats, right_m: float, least_m: float, step_m: float, *, closed: bool = False
) -> _Path | None:
    """Path at ``right_m`` to the right of a line (negative: left), cut where it is nearer than ``least_m`` to the line.

    None if the whole path is cut.
    """
    if closed:
        x, y = np.append(x, x[:2]), np.append(y, y[:2])
    dx, dy = np.diff(x), np.diff(y)
    # A rough count, checked before memory is allocated: corners add nodes outside and remove them inside.
    _refuse_too_many(float(np.hypot(dx, dy).sum()) / step_m - 2.0 * math.pi * abs(right_m) / step_m)
    headings = np.degrees(np.arctan2(dx, dy))
    turns = wrap_lon_deg(np.diff(headings))
    headings = headings[0] + np.append(0.0, np.cumsum(turns))
    nodes: list[tuple[Floats, Floats, Floats]] = []
    sides = len(headings) - closed
    for number in range(sides):
        heading, length = headings[number], math.hypot(dx[number], dy[number])
        # 16 nodes from image to image.
        share = np.linspace(0.0, 1.0, math.ceil(length / step_m * 16) + 1)
        nodes.append(
            (
                x[number] + share * dx[number],
                y[number] + share * dy[number],
                np.full(len(share), heading),
            )
        )
        turn = turns[number] if number < len(turns) else 0.0
        if turn * right_m <= 0.0 and turn:
            # Turn around the outside of the corner, with a node every 2 degrees; on the spot if the path is the line.
            angles = heading + turn * np.linspace(0.0, 1.0, math.ceil(abs(turn) / 2.0) + 1)
            corner = np.ones(len(angles))
            nodes.append((x[number + 1] * corner, y[number + 1] * corner, angles))
    at_x, at_y, heading_deg = (np.concatenate(values) for values in zip(*nodes))
    angle = np.radians(heading_deg)
    path = _Path(at_x + right_m * np.cos(angle), at_y - right_m * np.sin(angle), heading_deg)
    if least_m <= 0.0:
        return path
    # Allow a micrometre of rounding.
    kept = _distances(path, x[: sides + 1], y[: sides + 1]) >= least_m - 1e-6
    return _Path(*(values[kept] for values in path)) if kept.any() else None


def _distances(path: _Path, x: Floats, y: Floats) -> Floats:
    """Distance (m,) of each node of a path from the nearest side of a line."""
    start_x, start_y, dx, dy = x[:-1], y[:-1], np.diff(x), np.diff(y)
    squares = dx * dx + dy * dy
    nearest = np.empty(len(path.x_m))
    # A million pairs of node and side at a time take 32 MB.
    step = max(1_000_000 // len(dx), 1)
    for first in range(0, len(nearest), step):
        some = slice(first, first + step)
        to_x = path.x_m[some, np.newaxis] - start_x
        to_y = path.y_m[some, np.newaxis] - start_y
        share = np.clip((to_x * dx + to_y * dy) / squares, 0.0, 1.0)
        nearest[some] = np.hypot(to_x - share * dx, to_y - share * dy).min(axis=1)
    return nearest


def _poses(plane: LocalPlane, path: _Path, yaw_deg: Floats, agl_m: float, tilt_deg: float) -> tuple[Floats, ...]:
    """Latitude, longitude, height, true yaw and tilt of the nodes of a path, (n,) each."""
    lat, lon = plane.inverse(path.x_m, path.y_m)
    true = yaw_deg - plane.north_deg(lat, lon)
    return lat, lon, np.full(len(lat), agl_m), true, np.full(len(lat), tilt_deg)


def _points(columns: Sequence[tuple[Floats, ...]], what: str) -> Points:
    if not columns:
        raise InvalidInput("{0}: missing", what)
    lat, lon, agl, yaw, tilt = (np.concatenate(values) for values in zip(*columns))
    digits = (PLACE_DIGITS, PLACE_DIGITS, *[ANGLE_DIGITS] * 3)
    # Adding 0 turns -0 into 0.
    rounded = (
        (np.round(values, places) + 0.0).tolist()
        for values, places in zip((lat, wrap_lon_deg(lon), agl, wrap_lon_deg(yaw), tilt), digits)
    )
    lats, lons, heights, yaws, tilts = rounded
    looks_down = not np.any(tilt)
    return Points(tuple(zip(lats, lons, heights)), tuple(yaws), () if looks_down else tuple(tilts))
