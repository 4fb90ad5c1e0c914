"""The area of the entries: read, written and described. No widgets."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import lru_cache

import numpy as np

from ...core.errors import InvalidInput, TerrAInavError
from ...core.geodesy.ellipsoid import WGS84
from ...core.mission.areas.area import ANGLES, Area, Box, Points, Polygon, Polygons, check_ground
from ...core.mission.areas.coords import parse_coords
from ...core.mission.mission import area_from_dict
from ...core.mission.pose_table import read_header, read_poses, usual_names
from ...core.numbers import real_number
from ...core.text.safe_json import parse_json
from ...core.units import LENGTHS_M
from ..i18n import localized, number_text, tr, translate
from ..units import area_text, length_text
from .state import BOX_FIELDS, FormState, in_metres
from .text import (
    LATITUDE,
    LONGITUDE,
    SEPARATORS,
    degrees_text,
    exact_degrees_text,
    parse_degrees,
    to_decimal_degrees,
    to_decimal_points,
)

#: Heights closer than this are equal: spin boxes show four decimals, of metres or feet.
SAME_HEIGHT_M = 1e-4
#: Number of parsed shapes to cache: the shape entered, and the shapes of undo steps.
_KEPT = 8
#: Count of numbers in ``lat lon``, ``lat lon agl`` and ``lat lon agl yaw``.
_POINT, _POSE, _POSE_AND_YAW = 2, 3, 4
#: Count of numbers in two opposite corners.
_CORNERS = 4


class FormError(TerrAInavError):
    """Entries from which no mission can be made, with a message for each wrong field."""

    def __init__(self, messages: dict[str, str]) -> None:
        super().__init__("; ".join(messages.values()))
        self.messages = messages


def replace_box(state: FormState, box: Box, text: Callable[[float], str] = degrees_text) -> FormState:
    """State with the edges of ``box``."""
    return replace(state, shape="", **_edges(box, text))


def replace_area(state: FormState, area: Area, agl_m: float | None = None) -> FormState:
    """State with another area, and with ``agl_m`` as its height above ground unless None."""
    if agl_m is not None and agl_m != state.agl_m:
        state = replace(state, agl=agl_m / LENGTHS_M[state.agl_unit], height_by="agl", camera_gsd=0.0)
    if isinstance(area, Box):
        return replace_box(state, area)
    state = replace_box(state, area.bounds, exact_degrees_text)
    return replace(state, shape=shape_text(area, state.agl_m))


def paste_coordinates(state: FormState, text: str) -> FormState:
    """State with pasted coordinates, heights in the state's unit; see `area_of_text` for the formats.

    Raises
    ------
    FormError
        For the field ``north``.
    """
    try:
        return replace_area(state, *area_of_text(text, state.agl, state.agl_unit))
    except TerrAInavError as wrong:
        raise FormError({"north": translate(wrong)}) from wrong


def entered_shape(state: FormState) -> Polygon | Polygons | Points | None:
    """Return the polygons or points entered, at the height entered; None if the area is a box.

    Raises
    ------
    InvalidInput
        ``state.shape`` cannot be read.
    """
    if not state.shape:
        return None
    bounds = parse_shape(state.shape).bounds
    # If the edges are not the shape's bounding box, a box was entered after the shape.
    edges = _edges(bounds, exact_degrees_text)
    if any(getattr(state, name) != text for name, text in edges.items()):
        return None
    return parse_area(state.shape, state.agl_m)


def entered_area(state: FormState) -> Area | None:
    """Area entered; None if missing or invalid."""
    try:
        shape = entered_shape(state)
        if shape is not None:
            return shape
        box = Box(*(edge_deg(name, getattr(state, name)) for name in BOX_FIELDS))
        check_ground(box)
    except (TerrAInavError, ValueError):
        return None
    return box


def edge_deg(name: str, text: str) -> float:
    """Degrees of the edge entered in the field ``name``; raises ValueError if ``text`` is not an angle."""
    return parse_degrees(text, LATITUDE if name in ("north", "south") else LONGITUDE)


@dataclass(frozen=True)
class EnteredShape:
    """A polygon or points, parsed.

    Parameters
    ----------
    area : Polygon, Polygons or Points
    bounds : Box
        The bounding box, shown in the edges' fields.
    agl_m : float
        Height entered when the points were taken; a different height entered later applies to all points.
    """

    area: Polygon | Polygons | Points
    bounds: Box
    agl_m: float

    def area_at_height(self, agl_m: float) -> Polygon | Polygons | Points:
        """Area with all points at ``agl_m``; unchanged if that is the height at which they were taken."""
        if not isinstance(self.area, Points) or abs(agl_m - self.agl_m) <= SAME_HEIGHT_M or agl_m <= 0.0:
            return self.area
        return replace(self.area, poses=tuple((lat, lon, agl_m) for lat, lon, _ in self.area.poses))


def shape_text(area: Area, agl_m: float) -> str:
    """JSON of polygons or points, with the height entered when they were taken; empty for a box."""
    if isinstance(area, Box):
        return ""
    # The form of a mission's file; `Mission.to_dict` would copy every corner.
    data = {field.name: getattr(area, field.name) for field in fields(area)}
    if isinstance(area, Polygons):
        data = {"parts": [{"rings": part.rings} for part in area.parts]}
    return json.dumps({"type": type(area).__name__.lower(), **data, "agl_m": agl_m})


@lru_cache(_KEPT)
def parse_shape(text: str) -> EnteredShape:
    """Shape from the text of `shape_text`; raises InvalidInput if it cannot be read."""
    try:
        data = parse_json(text)
        agl_m = float(data.pop("agl_m", 1.0))
    except (ValueError, TypeError, AttributeError) as wrong:
        raise InvalidInput(tr("the area's shape cannot be read: {error}").format(error=wrong)) from wrong
    area = area_from_dict(data)
    if isinstance(area, Box):
        raise InvalidInput(tr("the area's shape is a box: must be a polygon or points"))
    return EnteredShape(area, area.bounds, agl_m)


def no_fly_text(polygons: tuple[Polygon, ...]) -> str:
    """JSON of no-fly areas; empty if there are none."""
    return json.dumps([{"rings": polygon.rings} for polygon in polygons]) if polygons else ""


@lru_cache(_KEPT)
def parse_no_fly(text: str) -> tuple[Polygon, ...]:
    """No-fly areas from the text of `no_fly_text`; raises InvalidInput if they cannot be read."""
    return area_from_dict({"type": "polygons", "parts": parse_json(text)}).parts if text else ()


def entered_no_fly(state: FormState) -> tuple[Polygon, ...]:
    """No-fly areas entered; empty if they cannot be read."""
    try:
        return parse_no_fly(state.no_fly)
    except InvalidInput:
        return ()


@lru_cache(_KEPT)
def parse_area(text: str, agl_m: float) -> Polygon | Polygons | Points:
    """Area from the text of `shape_text`, at the height entered; raises InvalidInput if it cannot be read."""
    return parse_shape(text).area_at_height(agl_m)


def area_of_text(text: str, agl: float, agl_unit: str) -> tuple[Area, float | None]:
    """Area from pasted text.

    Parameters
    ----------
    text : str
        ``north_west_south_east_agl`` or ``lat_lon_agl``, several lines of ``lat lon agl [yaw]``, or a table of poses
        with a header, as for `pose_table.read_poses`. Commas, semicolons and spaces work as well as underscores, and
        one line may omit the height. `to_decimal_points` reads decimal commas, and `to_decimal_degrees` degrees,
        minutes and seconds with a hemisphere's letter.
    agl : float
        Height for text without heights.
    agl_unit : str
        Unit of all heights: m or ft.

    Returns
    -------
    area : Box or Points
    agl_m : float or None
        Height of the first point in the text, in metres; None if the text has no height.

    Raises
    ------
    InvalidInput
        The text cannot be read; the message quotes the wrong part and the number of its line.
    """
    held = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    header = read_header(text.splitlines())
    if header:
        has_heights = "agl" in usual_names(header)
        agl_m = None if has_heights else in_metres(agl, LENGTHS_M[agl_unit])
        points = read_poses(text.splitlines(), agl_unit=agl_unit, agl_m=agl_m)
        return points, points.poses[0][2] if has_heights else None
    try:
        text = to_decimal_degrees("\n".join(line for _, line in held))
    except ValueError as wrong:
        raise InvalidInput(
            tr(
                "coordinates “{text}”: minutes and seconds must be below 60, and each latitude stand before its "
                "longitude"
            ).format(text=wrong)
        ) from wrong
    try:
        read = to_decimal_points(text).splitlines()
    except ValueError as wrong:
        raise InvalidInput(
            tr(
                "coordinates “{text}”: a comma may stand between numbers or before decimals; write points before "
                "decimals, or spaces between numbers"
            ).format(text=wrong)
        ) from wrong
    lines = [(number, _without_separators(line)) for (number, _), line in zip(held, read)]
    if len(lines) > 1:
        return _points(lines, agl, agl_unit)
    line = lines[0][1] if lines else ""
    parts = SEPARATORS.split(line)
    given = len(parts) not in (_POINT, _CORNERS)
    area, agl_m = parse_coords(line if given else "_".join([*parts, repr(agl)]), agl_unit=agl_unit)
    return area, agl_m if given else None


def size_m(box: Box) -> tuple[float, float]:
    """Width along the middle parallel and height along a meridian, in metres on the ground."""
    middle = np.radians((box.north_deg + box.south_deg) / 2.0)
    radius = float(WGS84.normal_radius_m(np.degrees(middle)))
    width = radius * math.cos(float(middle)) * math.radians(box.span_deg)
    # The mean of 17 latitudes gives the meridian's length to the four digits shown.
    radii = WGS84.meridional_radius_m(np.linspace(box.south_deg, box.north_deg, 17))
    return width, float(radii.mean()) * math.radians(box.north_deg - box.south_deg)


def size_text(box: Box, unit: str) -> str:
    """Width, height and area of a box, in metric units or feet and related units."""
    width, height = (length_text(length, unit) for length in size_m(box))
    return f"{width} × {height}, {area_text(box.area_m2(), unit)}"


def describe_area(area: Area, unit: str) -> str:
    """One-line description of an area, in metric or imperial units."""
    if isinstance(area, Box):
        return tr("Box, {size}").format(size=size_text(area, unit))
    if not isinstance(area, Points):
        return _describe_polygons(area, unit)
    heights = [agl / LENGTHS_M[unit] for _, _, agl in area.poses]
    words = [tr("Single capture") if len(heights) == 1 else tr("{n} points").format(n=number_text(len(heights)))]
    low, high = (localized(f"{height:,.1f}".rstrip("0").rstrip(".")) for height in (min(heights), max(heights)))
    words.append((low if low == high else f"{low}–{high}") + f" {unit} AGL")
    own = [what for name, what in angle_names().items() if name in ANGLES and area.stated_deg(name)]
    own += [tr("time")] if area.times_s else []
    if len(heights) == 1 and area.yaws_deg:
        words.append(tr("yaw {yaw}°").format(yaw=number_text(area.yaws_deg[0], "g")))
    elif own:
        *others, last = own
        text = tr("each with its {values} and {last}") if others else tr("each with its {last}")
        words.append(text.format(values=", ".join(others), last=last))
    return ", ".join(words)


def angle_names() -> dict[str, str]:
    """Translated names of the angles of points, by field."""
    return {"yaw": tr("yaw"), "tilt": tr("tilt"), "gimbal_pitch": tr("gimbal pitch"), "roll": tr("roll")}


def readout(area: Area, unit: str) -> str:
    """Text shown at the cursor while an area is drawn or moved."""
    if isinstance(area, Points):
        return tr("{n} points").format(n=len(area.poses)) if len(area.poses) > 1 else tr("Single capture")
    return size_text(area, unit) if isinstance(area, Box) else area_text(area.area_m2(), unit)


def _edges(box: Box, text: Callable[[float], str]) -> dict[str, str]:
    degrees = (box.north_deg, box.west_deg, box.south_deg, box.east_deg)
    return dict(zip(BOX_FIELDS, map(text, degrees)))


def _without_separators(line: str) -> str:
    """Line without separators at either end; a regular expression for the end would take quadratic time."""
    first, after = (found.end() if found else 0 for found in map(SEPARATORS.match, (line, line[::-1])))
    return line[first : len(line) - after]


def _points(lines: list[tuple[int, str]], agl: float, agl_unit: str) -> tuple[Points, float | None]:
    """Points from several lines, either all with a yaw or all without; and the first height, if any."""
    poses: list[tuple[float, float, float]] = []
    yaws: list[float] = []
    given = False
    for number, line in lines:
        parts = SEPARATORS.split(line)
        where = tr("line {number}:").format(number=number)
        try:
            if len(parts) not in (_POINT, _POSE, _POSE_AND_YAW):
                found = tr("“{line}” has {count} numbers; several lines must be of lat lon agl [yaw]")
                raise InvalidInput(found.format(line=line, count=len(parts)))
            given = given or len(parts) >= _POSE
            first = parts[:_POSE] if len(parts) >= _POSE else [*parts, repr(agl)]
            point, _ = parse_coords("_".join(first), agl_unit=agl_unit)
            poses += point.poses
            if len(parts) == _POSE_AND_YAW:
                yaws += Points(point.poses, (_number(parts[3]),)).yaws_deg
        except InvalidInput as wrong:
            raise InvalidInput("{0} {1}", where, wrong) from wrong
        if yaws and len(yaws) != len(poses):
            raise InvalidInput("{0} {1}", where, tr("give every point a yaw, or none"))
    return Points(tuple(poses), tuple(yaws)), poses[0][2] if given else None


def _number(text: str) -> float:
    try:
        return real_number(text.replace("\u2212", "-"))
    except ValueError as wrong:
        raise InvalidInput(tr("yaw “{text}”: must be a number of degrees").format(text=text)) from wrong


def _describe_polygons(polygon: Polygon | Polygons, unit: str) -> str:
    parts = polygon.parts
    corners = sum(len(ring) for part in parts for ring in part.rings)
    words = [tr("Polygon") if len(parts) == 1 else tr("{n} polygons").format(n=number_text(len(parts)))]
    words.append(tr("{n} corners").format(n=number_text(corners)))
    holes = sum(len(part.rings) - 1 for part in parts)
    if holes:
        words.append(tr("1 hole") if holes == 1 else tr("{n} holes").format(n=holes))
    words.append(area_text(polygon.area_m2(), unit))
    return ", ".join(words)
