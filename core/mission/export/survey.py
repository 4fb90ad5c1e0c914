"""A plan for QGroundControl that it edits as a survey: a polygon, rows and a camera, beside the items that are flown.

Keys are those of the plan file format that QGroundControl publishes (https://docs.qgroundcontrol.com, developer guide);
the survey's parts are in their first version, which every QGroundControl since 3.5 reads. Its items are the planned
captures. QGroundControl works the rows out anew when the survey is edited, and also when it is opened where the speed
is other than its own default; so the polygon, the spacing and the entry are such that its rows come to lie on the
planned ones.

QGroundControl lays rows of azimuth ``angle`` at distances ``k * spacing - reach / 2`` to the right of the middle of the
polygon's extent in east and north, k = 0, 1, …, where ``reach`` is the extent's longer side and 2,000 m, and flies each
from where it meets the polygon to where it leaves it.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, product
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Floats
from ...errors import InvalidInput, Message
from ...geodesy.mercator import wrap_lon_deg
from ...geodesy.projections import LocalPlane
from ..areas.area import Box, Polygon
from ..parts import GROUND, HOVER, ONE_WAY
from ..plan import Plan
from .qgroundcontrol import (
    after_flight,
    before_flight,
    check_qgroundcontrol,
    flight,
    plan_object,
    qgroundcontrol_notes,
    simple_items,
    text_of,
)
from .sorties import Sortie, sorties

#: Shares of the spacing by which the polygon may reach beyond its outermost rows, which choose where rows come to lie.
_MARGINS = np.linspace(0.05, 0.95, 37)
#: By how much the polygon reaches beyond the ends of rows, and by how much more where its side slants, in distances
#: between images.
_END_SHARE, _STRAIGHT_SHARE = 0.02, 0.6
#: Diagonal of a 35 mm film's image, mm: QGroundControl asks for a sensor where a camera has an angle of view.
_DIAGONAL_MM = float(np.hypot(36.0, 24.0))
_TOP_LEFT, _TOP_RIGHT = 0, 1


class _SurveyRows(NamedTuple):
    """Rows of one sortie in the plane about its first capture, in flight order.

    Parameters
    ----------
    azimuth_deg : float
        QGroundControl's angle: above -90 to 90.
    offset_m : array (r,)
        To the right of that direction.
    low_m, high_m : array (r,)
        Their first and last captures along that direction.
    forward : bool
        Whether the first row is flown in that direction.
    spacing_m, interval_m : float
        Between rows, and between the captures of one.
    """

    plane: LocalPlane
    azimuth_deg: float
    offset_m: Floats
    low_m: Floats
    high_m: Floats
    forward: bool
    spacing_m: float
    interval_m: float

    def placed(self, along_m: Floats, offset_m: Floats) -> list[list[float]]:
        """Latitudes and longitudes of places along and to the right of the rows."""
        east, north = self.east_north(along_m, offset_m)
        lat, lon = self.plane.inverse(east, north)
        return [list(place) for place in zip(lat.tolist(), wrap_lon_deg(lon).tolist())]

    def east_north(self, along_m: Floats, offset_m: Floats) -> tuple[Floats, Floats]:
        """Places east and north of the plane's middle."""
        sine, cosine = np.sin(np.radians(self.azimuth_deg)), np.cos(np.radians(self.azimuth_deg))
        return along_m * sine + offset_m * cosine, along_m * cosine - offset_m * sine


def check_survey(plan: Plan) -> None:
    """Raise InvalidInput for a mission that is no survey of QGroundControl's."""
    check_qgroundcontrol(plan)
    area, meant = plan.mission.area, plan.meant
    one_polygon = isinstance(area, Box) or (isinstance(area, Polygon) and len(area.rings) == 1)
    if not one_polygon:
        raise InvalidInput(
            "QGroundControl survey: needs an area of one polygon without holes",
            field="area",
            remedy="choose the ending .plan",
        )
    tilt, roll = (float(np.abs(angle).max()) for angle in (meant.tilt_deg, meant.roll_deg))
    if max(tilt, roll) > 0.0:
        raise InvalidInput(
            "QGroundControl survey with a tilt of {0:g} and a roll of {1:g} deg: must look straight down",
            tilt,
            roll,
            remedy="choose the ending .plan",
        )
    for sortie in sorties(plan):
        rows = _rows(plan, sortie)
        # Rows bend on the Earth, so yaws within a degree count as along or across them.
        if _off_square_deg(plan, rows) > 1.0:
            raise InvalidInput(
                "QGroundControl survey with images {0:g} deg off the direction of rows: must be along or across them",
                round(_off_square_deg(plan, rows), 1),
                field="yaw_deg",
                remedy="choose the ending .plan",
            )


def survey_texts(plan: Plan) -> list[Iterator[str]]:
    """Text of the plan of each sortie, in blocks."""
    return [_text(plan, sortie) for sortie in sorties(plan)]


def survey_notes(plan: Plan) -> tuple[str, ...]:
    """What QGroundControl makes of the survey, one line each."""
    notes = [
        Message(
            "QGroundControl lays the rows anew when you edit the survey, or open it at another speed than its own: "
            "within a metre or two of the planned ones, with the nose along the flight"
        )
    ]
    if plan.mission.flight.order == ONE_WAY:
        notes.append(Message("rows laid anew are flown to and fro"))
    if plan.mission.flight.crosshatch:
        notes.append(Message("crossing rows laid anew are as far apart as the first ones"))
    return (*qgroundcontrol_notes(plan), *notes)


def _text(plan: Plan, sortie: Sortie) -> Iterator[str]:
    captures = np.flatnonzero(sortie.capture >= 0)
    first, end = int(captures[0]), int(captures[-1]) + 1
    before = list(simple_items(chain(before_flight(plan, sortie), _way(plan, sortie.take(slice(0, first)))), 1))
    item = _survey(plan, sortie.take(slice(first, end)), len(before) + 1)
    number = len(before) + 1 + len(item["TransectStyleComplexItem"]["Items"])
    after = chain(_way(plan, sortie.take(slice(end, len(sortie)))), after_flight(plan, sortie))
    return text_of(
        plan_object(plan, sortie, mixed_heights=_follows_terrain(plan)),
        chain(before, [item], simple_items(after, number)),
    )


def _way(plan: Plan, sortie: Sortie) -> Iterator[Any]:
    return flight(plan, sortie) if len(sortie) else iter(())


def _survey(plan: Plan, sortie: Sortie, first: int) -> dict[str, Any]:
    """The complex item of the rows of a sortie, whose own items are numbered from ``first``."""
    rows = _rows(plan, sortie)
    polygon, spacing_m, entry = _polygon(plan, rows)
    hovers = plan.mission.trigger == HOVER
    turns = sortie.capture < 0
    inner: dict[str, Any] = {
        "CameraCalc": _camera(plan, rows, spacing_m),
        "CameraShots": int(np.count_nonzero(~turns)),
        "CameraTriggerInTurnAround": False,
        "FollowTerrain": _follows_terrain(plan),
        "HoverAndCapture": hovers,
        "Items": list(simple_items(flight(plan, sortie), first)),
        "Refly90Degrees": plan.mission.flight.crosshatch,
        "TurnAroundDistance": plan.mission.route.turnaround_m,
        "VisualTransectPoints": _corners(plan, sortie),
        "version": 1,
    }
    if _follows_terrain(plan):
        # QGroundControl's defaults.
        inner.update(
            TerrainAdjustTolerance=10,
            TerrainAdjustMaxClimbRate=plan.mission.terrain.climb_m_per_s or 0,
            TerrainAdjustMaxDescentRate=plan.mission.terrain.climb_m_per_s or 0,
            TerrainFlightSpeed=plan.mission.flight.airspeed_m_per_s,
        )
    return {
        "TransectStyleComplexItem": inner,
        "angle": rows.azimuth_deg,
        "complexItemType": "survey",
        "entryLocation": entry,
        "flyAlternateTransects": False,
        "polygon": polygon,
        "splitConcavePolygons": False,
        "type": "ComplexItem",
        "version": 5,
    }


def _follows_terrain(plan: Plan) -> bool:
    return not plan.relief.is_level and plan.mission.terrain.height_above == GROUND


def _corners(plan: Plan, sortie: Sortie) -> list[list[float]]:
    """Places at which the flight turns: the ends of its rows, and the points between them."""
    shown = np.flatnonzero(sortie.capture < 0).tolist()
    shown = sorted({*shown, *(end for run in sortie.runs(plan) for end in run)})
    return [[float(sortie.lat_deg[at]), float(sortie.lon_deg[at])] for at in shown]


def _rows(plan: Plan, sortie: Sortie) -> _SurveyRows:
    """Rows of a sortie; of crossed ones those of the direction that it begins with."""
    at = np.flatnonzero(sortie.capture >= 0)
    captures = sortie.capture[at]
    if len(plan.passes) > 1 and captures[0] < plan.passes[1].first:
        at = at[captures < plan.passes[1].first]
    ends_of: dict[int, tuple[int, int]] = {}
    for start, end in (run for run in sortie.runs(plan) if run[1] <= at[-1]):
        row = int(plan.row[sortie.capture[start]])
        # Over relief, a row may have points between its captures.
        ends_of[row] = ends_of.get(row, (start, end))[0], end
    runs = list(ends_of.values())
    plane = LocalPlane(float(sortie.lat_deg[at[0]]), float(sortie.lon_deg[at[0]]))
    lon = plane.lon_deg + np.mod(sortie.lon_deg - plane.lon_deg + 180.0, 360.0) - 180.0
    east, north = plane.forward(sortie.lat_deg, lon)
    starts, ends = (np.array([run[which] for run in runs]) for which in (0, 1))
    way = np.stack([east[ends] - east[starts], north[ends] - north[starts]], axis=1)
    longest = int(np.argmax(np.hypot(*way.T)))
    azimuth = plan.mission.flight.row_azimuth_deg
    if np.hypot(*way[longest]) > 0.0:
        azimuth = float(np.degrees(np.arctan2(*way[longest])))
    # QGroundControl takes angles beyond a right one for those of the opposite direction.
    azimuth = 90.0 - (90.0 - azimuth) % 180.0
    sine, cosine = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
    along, right = east * sine + north * cosine, east * cosine - north * sine
    offset = (right[starts] + right[ends]) / 2.0
    counts = sortie.capture[ends] - sortie.capture[starts]
    # A row of one image has no direction; rows are flown to and fro.
    shown = int(np.argmax(counts > 0))
    forward = bool((along[ends] >= along[starts])[shown])
    if plan.mission.flight.order != ONE_WAY and shown % 2:
        forward = not forward
    interval = np.abs(along[ends] - along[starts])[counts > 0] / counts[counts > 0]
    camera = plan.mission.camera.ground_size_m(float(np.median(plan.meant.agl_m)))
    steps = np.diff(np.unique(np.round(offset, 3)))
    return _SurveyRows(
        plane,
        azimuth,
        offset,
        np.minimum(along[starts], along[ends]),
        np.maximum(along[starts], along[ends]),
        forward,
        float(np.median(steps)) if len(steps) else min(camera),
        float(np.median(interval)) if len(interval) else min(camera),
    )


def _off_square_deg(plan: Plan, rows: _SurveyRows) -> float:
    off = np.mod(plan.meant.yaw_deg - rows.azimuth_deg + 45.0, 90.0) - 45.0
    return float(np.abs(off).max())


def _polygon(plan: Plan, rows: _SurveyRows) -> tuple[list[list[float]], float, int]:
    """Polygon around the rows, spacing and entry with which QGroundControl lays its rows onto them.

    The polygon's corners begin on the side where the first row is entered and run there from the lowest to the
    highest offset: QGroundControl flies its rows away from the side that comes first.
    """
    order = np.argsort(rows.offset_m, kind="stable")
    offset, low, high = rows.offset_m[order], rows.low_m[order], rows.high_m[order]
    entry = _TOP_LEFT if order[0] <= order[-1] else _TOP_RIGHT
    margin = _END_SHARE * rows.interval_m
    # Beyond the ends the last image by distance is still made; where the aircraft hovers at the end itself, one more
    # would be.
    sign = -1.0 if plan.mission.trigger == HOVER else 1.0
    beyond = np.where(high - low < 4.0 * margin, margin, sign * margin)
    straight = _STRAIGHT_SHARE * rows.interval_m
    left = _straightened(offset, low - beyond, straight, -1.0)
    right = _straightened(offset, high + beyond, straight, 1.0)
    near, far = (left, right) if rows.forward else (right, left)
    best: tuple[float, Floats, Floats, float] = np.inf, low, offset, rows.spacing_m
    for below, above in sorted(product(_MARGINS, _MARGINS), key=sum):
        ends = below * rows.spacing_m, above * rows.spacing_m
        sides = _capped(*near, *ends, margin), _capped(*far, *ends, margin)
        along = np.concatenate([sides[0][0], sides[1][0][::-1]])
        across = np.concatenate([sides[0][1], sides[1][1][::-1]])
        spacing, off = _fitted(rows, along, across, offset)
        if off < best[0]:
            best = off, along, across, spacing
        # Rows within 2 % of a spacing lie where they were planned.
        if off < 0.02:
            break
    _, along, across, spacing = best
    return rows.placed(along, across), spacing, entry


def _straightened(offset_m: Floats, along_m: Floats, tolerance_m: float, outward: float) -> tuple[Floats, Floats]:
    """One side of the polygon around ends of rows, with few corners: it leaves no end outside.

    Ends of rows over a slanting side step from image to image; corners at each of them would be none to edit.
    """
    kept = [0]
    while kept[-1] < len(offset_m) - 1:
        start, end = kept[-1], len(offset_m) - 1
        while end > start + 1:
            between = slice(start + 1, end)
            line = np.interp(offset_m[between], offset_m[[start, end]], along_m[[start, end]])
            if np.abs(line - along_m[between]).max() <= tolerance_m:
                break
            end -= 1
        kept.append(end)
    short = (along_m - np.interp(offset_m, offset_m[kept], along_m[kept])) * outward
    return along_m[kept] + outward * max(float(short.max()), 0.0), offset_m[kept]


def _capped(
    along_m: Floats, offset_m: Floats, below_m: float, above_m: float, tolerance_m: float
) -> tuple[Floats, Floats]:
    """A side that goes on beyond the outermost rows; its last corners move there where it runs across them anyway."""
    along, offset = along_m.tolist(), offset_m.tolist()
    low, high = offset[0] - below_m, offset[-1] + above_m
    for at, beside, end in ((0, 1, low), (-1, -2, high)):
        if len(along) > 1 and abs(along[at] - along[beside]) <= tolerance_m:
            offset[at] = end
        else:
            where = 0 if at == 0 else len(along)
            along.insert(where, along[at])
            offset.insert(where, end)
    return np.array(along), np.array(offset)


def _fitted(rows: _SurveyRows, along_m: Floats, across_m: Floats, offset_m: Floats) -> tuple[float, float]:
    """Spacing with which a row of QGroundControl's is in the middle of the planned ones, and how far others are off."""
    east, north = rows.east_north(along_m, across_m)
    middle = (east.min() + east.max()) / 2.0, (north.min() + north.max()) / 2.0
    # QGroundControl's rows reach beyond the polygon's extent by 2 km, both sides together.
    reach_m = max(np.ptp(east), np.ptp(north)) + 2000.0
    azimuth = np.radians(rows.azimuth_deg)
    from_first = offset_m - (middle[0] * np.cos(azimuth) - middle[1] * np.sin(azimuth)) + reach_m / 2.0
    centre = float(from_first[0] + from_first[-1]) / 2.0
    # With an even number of rows there is none in the middle.
    half = 0.5 * (round(float(np.ptp(offset_m)) / rows.spacing_m) % 2)
    steps = max(round(centre / rows.spacing_m - half), 1) + half
    spacing = centre / steps
    off = np.abs(from_first / spacing - np.round(from_first / spacing)).max()
    return float(spacing), float(off)


def _camera(plan: Plan, rows: _SurveyRows, spacing_m: float) -> dict[str, Any]:
    """QGroundControl's CameraCalc: sensor and focal length of 35 mm film that give the camera's angle of view."""
    camera, flight_ = plan.mission.camera, plan.mission.flight
    height_m = float(np.median(plan.meant.agl_m))
    if _follows_terrain(plan):
        height_m = flight_.agl_m
    wide_m, high_m = camera.ground_size_m(1.0)
    aspect = wide_m / high_m
    sensor_mm = _DIAGONAL_MM * aspect / np.hypot(aspect, 1.0), _DIAGONAL_MM / np.hypot(aspect, 1.0)
    longer = plan.mission.pixels.image_px
    size_px = (longer, max(round(longer / aspect), 1)) if aspect >= 1.0 else (max(round(longer * aspect), 1), longer)
    turned = np.mod(plan.meant.yaw_deg[0] - rows.azimuth_deg + 45.0, 180.0) >= 90.0
    across_m, along_m = (high_m, wide_m) if turned else (wide_m, high_m)
    return {
        "AdjustedFootprintFrontal": rows.interval_m,
        "AdjustedFootprintSide": spacing_m,
        "CameraName": "Custom Camera",
        "DistanceToSurface": height_m,
        "DistanceToSurfaceRelative": True,
        "FixedOrientation": False,
        "FocalLength": sensor_mm[0] / wide_m,
        "FrontalOverlap": _overlap(rows.interval_m, along_m * height_m),
        "ImageDensity": 100.0 * height_m * wide_m / size_px[0],
        "ImageHeight": size_px[1],
        "ImageWidth": size_px[0],
        "Landscape": not turned,
        "MinTriggerInterval": plan.mission.route.photo_interval_s or 0,
        "SensorHeight": sensor_mm[1],
        "SensorWidth": sensor_mm[0],
        "SideOverlap": _overlap(spacing_m, across_m * height_m),
        "ValueSetIsDistance": True,
        "version": 1,
    }


def _overlap(step_m: float, footprint_m: float) -> float:
    return max(100.0 * (1.0 - step_m / footprint_m), 0.0)
