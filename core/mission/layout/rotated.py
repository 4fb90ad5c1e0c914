"""Rows in a plane: rotated or crosshatched rows, and rows in the CRS of a source."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ...arrays import Flags, Floats, Numbers, expand_counts
from ...errors import InvalidInput, Message, OptionName
from ...geodesy.camera import Camera, Poses
from ...geodesy.ellipsoid import Ellipsoid
from ...geodesy.mercator import MERCATOR, Plane, wrap_lon_deg
from ...geodesy.planes import ProjectedPlane, TurnedPlane
from ...geodesy.projections import NOISE_M, LocalPlane, geodesic_ends
from ...geodesy.rectangles import RowsPlane, Sides, common_sides, image_rings, image_sides
from ..areas.area import (
    Area,
    Box,
    Points,
    Polygon,
    Polygons,
    band_spans,
    crossed_and_held,
    ground_m2,
    polygon_edges,
    shared_rings,
    touching,
)
from ..mission import Mission
from ..parts import EASTWARD_DEG, NORTH, TRACK
from .coverage import (
    Coverage,
    Overlap,
    Rectangles,
    clip_ring,
    gaps_by_band,
    joined,
    shares,
    summarize_overlap,
    summed,
    twice_area,
)
from .rows import (
    Layout,
    bounds_with_margin,
    in_order,
    is_flown_back,
    refuse_beyond_mercator,
    refuse_no_step,
    refuse_too_many,
    row_yaws_deg,
    turns_at_random,
)

#: Greatest distance from the middle of a plane: there the plane enlarges by 0.6 %, and needs 0.6 % more images.
_REACH_M = 1e6
#: Overlap of neighbours, far above the noise of positions, so that rounding opens no gap.
_MEETING_M = 4.0 * NOISE_M
#: Accuracy of the sides of an area where only its extent matters.
_EXTENT_M = 10.0
#: Sides of an area bend in a plane. They are divided into pieces accurate to this share of a rectangle.
_BEND_SHARE = 1e-4


class Pass(NamedTuple):
    """Rows of one direction, in flight order.

    Attributes
    ----------
    plane : LocalPlane or TurnedPlane
        Plane with its first axis along the rows, and its second along yaw 0.
    sides : Sides
        Rectangle of ground, relative to the camera, that every image of the pass shows.
    first : int
        Index of the first capture.
    back : Sides or None
        The same rectangle for rows flown back, if their images look in the other direction.
    first_row : int
        Number of the first row.
    area : Polygon or None
        Polygon that the pass covers; None for the whole area.
    """

    plane: RowsPlane
    sides: Sides
    first: int
    back: Sides | None = None
    first_row: int = 0
    area: Polygon | None = None

    def row_sides(self, row: Numbers) -> Sides:
        """Rectangles of captures by row (n,): one for all, or one each."""
        return self.sides if self.back is None else _alternating(self.sides, self.back, (row - self.first_row) % 2 == 1)


class PlaneArea(NamedTuple):
    """Area in a plane: rings, the outer one first, with sides accurate to ``bend_m``."""

    rings: tuple[tuple[Floats, Floats], ...]
    bend_m: float

    def arrays(self) -> list[tuple[Floats, Floats]]:
        """Coordinates of the corners of each ring along the axes."""
        return list(self.rings)


def is_rotated(mission: Mission) -> bool:
    """Whether the rows of a mission are rotated or crosshatched, or look to both sides."""
    if not mission.area.covers_ground:
        return False
    # Rows along parallels must differ only in latitude; oblique views that alternate sides differ more.
    sees_aside = bool(mission.attitude.tilt_deg or mission.attitude.roll_deg)
    return (
        mission.flight.row_azimuth_deg != EASTWARD_DEG
        or mission.flight.crosshatch
        or (mission.flight.alternates_facing and sees_aside)
    )


def lay_out_rotated(
    mission: Mission,
    ground: Ellipsoid,
    source: Plane = MERCATOR,
    room_m: float = 0.0,
    narrowed_m: float = 0.0,
    lower: float = 1.0,
) -> tuple[Layout, tuple[Pass, ...]]:
    """Positions of captures in rows in a plane: around the area, or of the source's CRS with rows along grid east.

    Parameters
    ----------
    room_m : float
        Enlarges the area on all sides.
    narrowed_m : float
        Reduces the common rectangle of images on all sides.
    lower : float
        Greatest ratio of a capture's height above ground to the mission's height: oblique views show lower ground
        farther away, so the area is enlarged.

    Raises
    ------
    InvalidInput
        As for `lay_out`; or the area or images extend too far, images see the sky, or the layout is ``paper``.
    """
    area = mission.area
    if isinstance(area, (Points, Polygons)):
        raise InvalidInput("points have no rows that could be turned, and several polygons each their own")
    if mission.flight.layout != "cover" and not is_rotated(mission):
        raise InvalidInput(
            "layout {0}: lies on the Web-Mercator map, and the source has pixels of its own in {1}",
            mission.flight.layout,
            source.name,
            field="layout",
            remedy=Message("use {0} {1}", OptionName("layout"), "cover"),
        )
    if mission.flight.layout != "cover":
        wanted = (
            Message("row azimuth {0:g} deg", mission.flight.row_azimuth_deg)
            if mission.flight.row_azimuth_deg != EASTWARD_DEG
            else Message("crosshatch")
        )
        raise InvalidInput(
            "{0}: the layout {1} is north-up",
            wanted,
            mission.flight.layout,
            field="layout",
            remedy=Message("use {0} {1}", OptionName("layout"), "cover"),
        )
    box = area.bounds
    if source.wraps:
        refuse_beyond_mercator(bounds_with_margin(mission, area))
    middle = (box.north_deg + box.south_deg) / 2.0, box.west_deg + box.span_deg / 2.0
    turned_deg = mission.flight.row_azimuth_deg - EASTWARD_DEG
    angles = [turned_deg, turned_deg + 90.0][: 1 + mission.flight.crosshatch]
    parts: list[Layout] = []
    passes: list[Pass] = []
    for angle in angles:
        plane: RowsPlane = LocalPlane(*middle, angle)
        if isinstance(source, ProjectedPlane):
            plane = source.turned(*_plane_middle(source, area), angle)
        flown, rows = (sum(len(part.row) for part in parts), sum(int(part.row.max()) + 1 for part in parts))
        part, sides, back = _laid_out(mission, area, plane, ground, flown, (room_m, narrowed_m), lower)
        parts.append(part._replace(row=part.row + rows))
        passes.append(Pass(plane, sides, flown, back, rows))
    if len(parts) == 1:
        return parts[0], tuple(passes)
    whole = Layout(*(np.concatenate(columns) for columns in zip(*parts)))
    return whole._replace(agl_m=np.broadcast_to(np.float64(mission.flight.agl_m), whole.row.shape)), tuple(passes)


def _plane_middle(plane: ProjectedPlane, area: Box | Polygon) -> tuple[float, float]:
    """Latitude and longitude of the middle of an area's extent in a plane; around a pole, the middle is the pole."""
    lon, lat = (np.concatenate(values) for values in zip(*area.arrays()))
    ends = np.linspace(0.0, 1.0, 8, endpoint=False)
    lon, lat = ((part[:, np.newaxis] + ends * (np.roll(part, -1) - part)[:, np.newaxis]).ravel() for part in (lon, lat))
    u, v = plane.forward(lat, lon)
    reached = np.isfinite(u)
    if not reached.all():
        raise InvalidInput(
            "area: the source's CRS {0} does not reach latitude {1!r}, longitude {2!r}",
            plane.name,
            float(lat[~reached][0]),
            float(lon[~reached][0]),
            remedy="choose an area that the source shows",
        )
    middle = plane.inverse(*(np.array((float(part.min()) + float(part.max())) / 2.0) for part in (u, v)))
    return float(middle[0]), float(middle[1])


def _laid_out(
    mission: Mission,
    area: Box | Polygon,
    plane: RowsPlane,
    ground: Ellipsoid,
    flown: int,
    rooms_m: tuple[float, float],
    lower: float,
) -> tuple[Layout, Sides, Sides | None]:
    """One pass, after ``flown`` captures, and the common rectangles of images of rows flown out and back."""
    extent = _shape(area, plane, _EXTENT_M)
    back: Sides | None = None
    # The margin is part of the extent of captures.
    extent = extent._replace(bend_m=extent.bend_m + _plane_margin(mission, area, plane))
    sides = _common(mission, extent, plane, ground, is_back=False)
    room_m, narrowed_m = rooms_m
    if mission.flight.alternates_facing:
        sides, back = _symmetric(sides, _common(mission, extent, plane, ground, is_back=True))
    if narrowed_m:
        sides, back = _narrower(sides, narrowed_m), None if back is None else _narrower(back, narrowed_m)
    (width,), (height,) = sides.size_m
    steps = np.array([width * (1.0 - mission.flight.overlap_along), height * (1.0 - mission.flight.overlap_across)])
    step_x, step_y = steps - _MEETING_M
    refuse_no_step(steps[:1] - _MEETING_M, mission.flight.overlap_along, mission)
    refuse_no_step(steps[1:] - _MEETING_M, mission.flight.overlap_across, mission)
    # Images without overlap sum to the area, apart from the enlargement of the plane.
    refuse_too_many(flown + 0.95 * area.area_m2() / float(width * height), mission.output.max_images)
    shape = _shape(area, plane, _BEND_SHARE * float(min(width, height)))
    left_m, bottom_m, right_m, top_m = (float(side[0]) for side in sides)
    aside_m = max(left_m, bottom_m, -right_m, -top_m, 0.0)
    margin = shape.bend_m + _MEETING_M + room_m + (lower - 1.0) * aside_m + _plane_margin(mission, area, plane)

    y = np.concatenate([ring[1] for ring in shape.rings])
    need = float(y.max() - y.min()) + 2.0 * margin
    rows = max(math.ceil((need - height) / step_y), 0.0) + 1.0
    refuse_too_many(flown + rows, mission.output.max_images)
    tops = float(y.max() + y.min()) / 2.0 + ((rows - 1.0) * step_y + height) / 2.0 - step_y * np.arange(rows)
    edges = polygon_edges(shape)
    spans = [band_spans(edges, float(top - height) - margin, float(top) + margin) for top in tops]
    held = np.array([len(low) > 0 for low, _ in spans])
    low, high = (
        np.array([pick(span[side]) for span, is_held in zip(spans, held) if is_held])
        for side, pick in ((0, np.min), (1, np.max))
    )
    tops = tops[held]
    counts = np.maximum(np.ceil((high - low + 2.0 * margin - width) / step_x), 0.0) + 1.0
    refuse_too_many(flown + float(counts.sum()), mission.output.max_images)
    per_row = counts.astype(np.int64)
    row, column = expand_counts(per_row)
    left = ((low + high) / 2.0)[row] + (column - (per_row[row] - 1) / 2.0) * step_x - width / 2.0
    bottom = (tops - height)[row]
    keep = touching(shape, left - margin, bottom - margin, left + width + margin, bottom + height + margin)
    is_back = is_flown_back(mission, row[keep])
    shown = sides if back is None else _alternating(sides, back, is_back)
    lat, lon = plane.inverse(left[keep] - shown.left_m, bottom[keep] - shown.bottom_m)
    yaw = _yaws_deg(mission, plane, lat, lon, is_back)
    agl = np.broadcast_to(np.float64(mission.flight.agl_m), lat.shape)
    return in_order(Layout(column[keep], row[keep], lat, lon, agl, yaw), mission.flight.order), sides, back


def _plane_margin(mission: Mission, area: Box | Polygon, plane: RowsPlane) -> float:
    """Greatest length of a mission's margin in a plane, which enlarges most at its rim."""
    margin = mission.flight.margin_m
    if not margin:
        return 0.0
    lon, lat = (np.concatenate(values)[:, np.newaxis] for values in zip(*area.arrays()))
    azimuths = np.arange(0.0, 360.0, 15.0)
    to_lat, to_lon, _ = geodesic_ends(*np.broadcast_arrays(lat, lon, azimuths, margin))
    to_lon = lon + wrap_lon_deg(to_lon - lon)
    ends = (plane.forward(*place) for place in ((lat, lon), (to_lat, to_lon)))
    (x, y), (to_x, to_y) = ends
    return float(np.hypot(to_x - x, to_y - y).max()) * 1.001  # for azimuths between


def _narrower(sides: Sides, by_m: float) -> Sides:
    """Rectangles reduced on all sides, at most to nothing."""
    across, up = (np.minimum(by_m, size / 2.0) for size in sides.size_m)
    left, bottom, right, top = sides
    return Sides(left + across, bottom + up, right - across, top - up)


def _alternating(sides: Sides, back: Sides, is_back: Flags) -> Sides:
    """Rectangles of captures (n,), some of which are in rows flown back."""
    return Sides(*(np.where(is_back, flown_back, flown_out) for flown_out, flown_back in zip(sides, back)))


def _symmetric(sides: Sides, back: Sides) -> tuple[Sides, Sides]:
    """Common part of the rectangles of rows flown out and of rows flown back, turned; and this part turned back.

    Rectangles are turned by 180 degrees.
    """
    left, bottom, right, top = (
        pick(flown_out, -flown_back)
        for pick, flown_out, flown_back in (
            (np.maximum, sides.left_m, back.right_m),
            (np.maximum, sides.bottom_m, back.top_m),
            (np.minimum, sides.right_m, back.left_m),
            (np.minimum, sides.top_m, back.bottom_m),
        )
    )
    return Sides(left, bottom, right, top), Sides(-right, -top, -left, -bottom)


def _yaws_deg(mission: Mission, plane: RowsPlane, lat_deg: Floats, lon_deg: Floats, is_back: Flags | bool) -> Floats:
    """Yaws of images as the mission demands, relative to the rows: less the convergence of the plane.

    A fixed azimuth is from true north, or in the plane of a source from grid north.
    """
    flight, yaw = mission.flight, mission.attitude.yaw_deg
    relative: Floats | float = yaw
    if flight.facing == TRACK:
        relative = yaw + np.where(is_back, -EASTWARD_DEG, EASTWARD_DEG)
    elif flight.facing != NORTH and isinstance(plane, LocalPlane):
        return np.broadcast_to(wrap_lon_deg(np.array((flight.faced_deg or 0.0) + yaw)), lat_deg.shape)
    elif flight.facing != NORTH:
        relative = yaw + (flight.faced_deg or 0.0) - plane.angle_deg
    return wrap_lon_deg(relative - plane.north_deg(lat_deg, lon_deg))


def _posed(mission: Mission, plane: RowsPlane, x_m: Floats, y_m: Floats, is_back: bool) -> Poses:
    """Poses of captures at positions in a plane, with the mission's attitude."""
    lat, lon = plane.inverse(x_m, y_m)
    tilt, roll = (np.full(lat.shape, angle) for angle in (mission.attitude.tilt_deg, mission.attitude.roll_deg))
    agl = np.full(lat.shape, mission.flight.agl_m)
    return Poses(lat, lon, agl, _yaws_deg(mission, plane, lat, lon, is_back), tilt, roll)


def _common(mission: Mission, shape: PlaneArea, plane: RowsPlane, ground: Ellipsoid, is_back: bool) -> Sides:
    """Rectangle, relative to the camera, that all images over a shape show, for rows flown in one direction."""
    middle = _posed(mission, plane, np.zeros(1), np.zeros(1), is_back)
    ring, _, whole = image_rings(mission.camera, middle, plane, ground)
    if not whole.all():
        if isinstance(plane, TurnedPlane):
            raise InvalidInput(
                "camera with tilt {0:g}, roll {1:g} deg from {2:g} m: sees past the horizon, and an area is covered by "
                "images of ground alone on a source that has its own CRS",
                mission.attitude.tilt_deg,
                mission.attitude.roll_deg,
                mission.flight.agl_m,
                field="tilt_deg",
                remedy="tilt it less or fly lower",
            )
        if mission.flight.alternates_facing and (mission.attitude.tilt_deg or mission.attitude.roll_deg):
            raise InvalidInput(
                "camera with tilt {0:g}, roll {1:g} deg from {2:g} m: sees past the horizon, where rows flown to and "
                "fro have no frames that face their track",
                mission.attitude.tilt_deg,
                mission.attitude.roll_deg,
                mission.flight.agl_m,
                field="tilt_deg",
                remedy="tilt it less or fly lower",
            )
        if mission.attitude.tilt_deg or mission.attitude.roll_deg:
            raise InvalidInput(
                "camera with tilt {0:g}, roll {1:g} deg from {2:g} m: sees past the horizon, where "
                "turned rows have no frames",
                mission.attitude.tilt_deg,
                mission.attitude.roll_deg,
                mission.flight.agl_m,
                field="tilt_deg",
                remedy="tilt it less, fly lower or fly north-up rows",
            )
        raise InvalidInput(
            "camera from {0:g} m: sees past the horizon, where turned rows have no frames",
            mission.flight.agl_m,
            field="agl_m",
            remedy="fly lower or fly north-up rows",
        )
    reach = np.abs(ring).max(axis=(0, 1)) + shape.bend_m
    ends = [
        (float(np.min(along)) - far, float(np.max(along)) + far)
        for along, far in zip(map(np.concatenate, zip(*shape.rings)), reach.tolist())
    ]
    farthest = math.hypot(*(max(abs(low), abs(high)) for low, high in ends))
    if not farthest <= _REACH_M:
        raise InvalidInput(
            "row azimuth {0:g} deg: turned rows hold to {1:g} km from the area's middle, and the area "
            "or its images reach {2:.4g} km",
            mission.flight.row_azimuth_deg,
            _REACH_M / 1000.0,
            farthest / 1000.0,
            field="row_azimuth_deg",
            remedy="take a smaller area or north-up rows",
        )
    # Images at a lattice of places stand for all others.
    count = 9
    x, y = (places.ravel() for places in np.meshgrid(*(np.linspace(*end, count) for end in ends)))
    poses = _posed(mission, plane, x, y, is_back)
    rings, _, whole = image_rings(mission.camera, poses, plane, ground)
    if turns_at_random(mission):
        yaws = np.array(row_yaws_deg(mission))
        turned = Poses(*(np.repeat(values, len(yaws)) for values in poses))._replace(yaw_deg=np.tile(yaws, len(x)))
        sides = common_sides(mission.camera, turned, plane, ground)
        # At a yaw between two of these, a corner comes nearer to an image's edge by the cosine of half their distance.
        between = math.cos(math.pi / len(yaws))
        common = Sides(*(side * between for side in sides))
    else:
        common = common_sides(mission.camera, poses, plane, ground)
    # Between the places a curve deviates from its chord by an eighth of the second difference.
    lattice = rings.reshape(count, count, -1)
    bend = max(float(np.abs(np.diff(lattice, n=2, axis=axis)).max()) for axis in (0, 1)) / 4.0
    return _narrower(common, bend)


def _shape(area: Box | Polygon, plane: RowsPlane, bend_m: float) -> PlaneArea:
    """Area in a plane, with its sides divided into pieces accurate to ``bend_m``."""
    found = [_cut(lon, lat, plane, bend_m) for lon, lat in area.arrays()]
    # Twice the measured deviation, for pieces that bend unevenly.
    return PlaneArea(tuple((x, y) for x, y, _ in found), 2.0 * max(bend for _, _, bend in found))


def _cut(lon_deg: Floats, lat_deg: Floats, plane: RowsPlane, bend_m: float) -> tuple[Floats, Floats, float]:
    """Ring of a polygon in a plane, divided where its sides bend, and the greatest deviation from chords."""
    most_halvings = 12
    for halvings in range(most_halvings + 1):
        x, y = plane.forward(lat_deg, lon_deg)
        deviation = np.zeros(len(x))
        for share in (0.25, 0.5, 0.75):  # an S-shaped side does not deviate in its middle
            lon, lat, *chord = (part + share * (np.roll(part, -1) - part) for part in (lon_deg, lat_deg, x, y))
            on_side = plane.forward(lat, lon)
            deviation = np.maximum(deviation, np.hypot(on_side[0] - chord[0], on_side[1] - chord[1]))
        bent = np.flatnonzero(deviation > bend_m)
        if halvings == most_halvings or not len(bent):
            break
        lon_deg, lat_deg = (
            np.insert(part, bent + 1, ((part + np.roll(part, -1)) / 2.0)[bent]) for part in (lon_deg, lat_deg)
        )
    return x, y, float(deviation.max())


# --- ground that images show


def rotated_rectangles(
    mission: Mission, camera: Camera, part: Pass, poses: Poses, row: Numbers, ground: Ellipsoid, moved: bool
) -> Rectangles:
    """Rectangles that images of a pass show, in its plane; measured one by one if captures have ``moved``."""
    if moved and turns_at_random(mission):
        # The largest rectangles of images at other yaws may not hold the common one; 2 % more, to be rounded down.
        width, height = (1.02 * float(size[0]) for size in part.sides.size_m)
        return _rounded(image_sides(camera, poses, part.plane, ground, (width, height)), part.sides.size_m)
    if moved:
        return _rounded(image_sides(camera, poses, part.plane, ground), part.sides.size_m)
    x, y = part.plane.forward(poses.lat_deg, poses.lon_deg)
    # The deviations of captures from a straight row are noise, which `_MEETING_M` allows for.
    new = np.append(True, row[1:] != row[:-1])
    y = y[new][np.cumsum(new) - 1]
    left, bottom, right, top = part.row_sides(row)
    return Rectangles(x + left, y + bottom, x + right, y + top)


def inner_rectangles(plane: RowsPlane, west: Floats, south: Floats, east: Floats, north: Floats) -> Rectangles:
    """Rectangles along the axes of a plane, inside rectangles of the map with edges in degrees, (n,) each.

    The axes differ by quarter turns and by the convergence of the plane.
    """
    lon, lat = np.stack([west, east, east, west]), np.stack([south, south, north, north])
    x, y = (np.sort(part, axis=0) for part in plane.forward(lat, lon))
    return Rectangles(x[1], y[1], np.maximum(x[2], x[1]), np.maximum(y[2], y[1]))


def _rounded(sides: Sides, size_m: tuple[Floats, Floats]) -> Rectangles:
    """Rectangles inside others, with edges on a lattice of 512 cells per ``size_m``."""
    # Without a common lattice, the gaps between a million images in wind take too long.
    across, up = (size / 512 for size in size_m)
    left, bottom = np.ceil(sides.left_m / across) * across, np.ceil(sides.bottom_m / up) * up
    right, top = np.floor(sides.right_m / across) * across, np.floor(sides.top_m / up) * up
    # Images may be smaller than a cell of the lattice.
    return Rectangles(left, bottom, np.maximum(right, left), np.maximum(top, bottom))


def rotated_coverage(mission: Mission, passes: tuple[Pass, ...], rectangles: tuple[Rectangles, ...]) -> Coverage:
    """Coverage of the mission's area by rectangles, in m² of ground.

    Each polygon counts with the rectangles of its passes.
    """
    area = mission.area
    found = []
    for part in area.parts:
        which = [at for at, one in enumerate(passes) if one.area is None or one.area == part]
        shown = [passes[at] for at in which], [rectangles[at] for at in which]
        held = [Polygon((tuple(zip(lon.tolist(), lat.tolist())),)) for lon, lat in shared_rings(part, mission.no_fly)]
        found.append(_pass_coverage(part, *shown).without([_pass_coverage(one, *shown) for one in held]))
    return summed(found)


def _pass_coverage(area: Box | Polygon, passes: Sequence[Pass], rectangles: Sequence[Rectangles]) -> Coverage:
    """Coverage of an area by rectangles, in the plane of the first pass."""
    if not passes:
        return Coverage(area.area_m2(), area.area_m2(), complete=False)
    plane = passes[0].plane
    shape = _shape(area, plane, _BEND_SHARE * float(np.min(passes[0].sides.size_m)))
    x, y = (np.concatenate(values) for values in zip(*shape.rings))
    bend = shape.bend_m
    west, south, east, north = x.min() - bend, y.min() - bend, x.max() + bend, y.max() + bend
    within = float(west), float(south), float(east), float(north)
    shown: tuple[Rectangles, ...] = ()
    missing = Rectangles(*np.empty((4, 0)))
    for one in rectangles:
        # Rows of a second pass cross the first rows at a right angle.
        shown = (*shown, Rectangles(one.y0, -one.x1, one.y1, -one.x0) if shown else joined(one))
        found = gaps_by_band(Rectangles(*(np.concatenate(sides) for sides in zip(*shown))), within)
        missing = Rectangles(*(np.concatenate(sides) for sides in zip(*(_candidates(shape, some) for some in found))))
        if not len(missing.x0):
            break
    lost = (
        _plane_ground_m2(plane, shape, missing)
        if isinstance(plane, TurnedPlane)
        else ground_m2(shape, *missing, plane.inverse)
    )
    return Coverage(area.area_m2(), float(lost.sum()), complete=not len(lost))


def plane_share(area: Area, plane: ProjectedPlane, extent: tuple[tuple[float, float], ...]) -> float:
    """Share of an area in a rectangle of a plane (corners as fractions), measured in the plane."""
    shares = [_part_share(part, plane, extent) for part in area.parts]
    if len(shares) == 1 or min(shares) == 1.0:
        return min(shares)
    sizes = [part.area_m2() for part in area.parts]
    return sum(size * share for size, share in zip(sizes, shares)) / sum(sizes)


def _part_share(area: Box | Polygon, source: ProjectedPlane, extent: tuple[tuple[float, float], ...]) -> float:
    """Share of one part of an area in a rectangle of a plane, see `plane_share`."""
    plane = source.turned(*_plane_middle(source, area), 0.0)
    shape = _shape(area, plane, _EXTENT_M)
    u, v = np.array(extent).T
    x, y = plane.from_crs(source.west + u * source.width, source.north - v * source.height)
    rectangle = np.array([[x.min(), y.min()], [x.max(), y.min()], [x.max(), y.max()], [x.min(), y.max()]])
    points = np.concatenate([np.stack(ring, axis=1) for ring in shape.rings])
    if (points >= rectangle[0]).all() and (points <= rectangle[2]).all():
        return 1.0
    whole, held = (sum(_clipped_m2(shape, some)) for some in (_bounding_corners(points), rectangle))
    return min(max(held / whole, 0.0), 1.0)


def _bounding_corners(points: Floats) -> Floats:
    """Corners (4, 2) of the rectangle around points (n, 2)."""
    (west, south), (east, north) = points.min(axis=0), points.max(axis=0)
    return np.array([[west, south], [east, south], [east, north], [west, north]])


def _clipped_m2(shape: PlaneArea, rectangle: Floats) -> list[float]:
    """Areas, in the plane, of the rings of a shape inside a rectangle (4, 2); holes are negative."""
    parts = [clip_ring(np.stack(ring, axis=1), rectangle) for ring in shape.rings]
    areas = [abs(twice_area(part)) / 2.0 for part in parts]
    return [area if number == 0 else -area for number, area in enumerate(areas)]


def _plane_ground_m2(plane: TurnedPlane, shape: PlaneArea, found: Rectangles) -> Floats:
    """Square metres of ground of a shape inside rectangles, (n,): areas in the plane times its scale there.

    Longitudes would not do, as a plane may contain a pole.
    """
    x0, y0, x1, y1 = found
    lat, lon = plane.inverse((x0 + x1) / 2.0, (y0 + y1) / 2.0)
    source = plane.plane
    across, down = source.ground_m(lat, lon)
    scale = across / (source.width * source.unit_m) * down / (source.height * source.unit_m)
    corners = np.stack([x0, y0, x1, y0, x1, y1, x0, y1], axis=1).reshape(-1, 4, 2)
    inside = np.array([max(sum(_clipped_m2(shape, rectangle)), 0.0) for rectangle in corners])
    ground: Floats = inside * scale
    return ground[ground > 0.0]


def _candidates(shape: PlaneArea, found: Rectangles) -> Rectangles:
    """Rectangles that may overlap a shape, given its accuracy."""
    x0, y0, x1, y1 = found
    bend = shape.bend_m
    crossed, held = crossed_and_held(shape, x0 - bend, y0 - bend, x1 + bend, y1 + bend)
    return Rectangles(*(side[crossed | held] for side in found))


def rotated_overlap(
    column: Numbers, row: Numbers, passes: tuple[Pass, ...], rectangles: tuple[Rectangles, ...]
) -> Overlap:
    """Overlap of neighbours in the same pass, along its rows and from row to row."""
    ends = [*(part.first for part in passes[1:]), len(row)]
    found = [
        shares(column[part.first : end], row[part.first : end], sides, rows_are_level=True)
        for part, end, sides in zip(passes, ends, rectangles)
    ]
    return summarize_overlap(*(np.concatenate(values) for values in zip(*found)))
