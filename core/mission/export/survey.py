"""A plan that QGroundControl edits as a survey: polygon, rows and camera beside the items that are flown.

Keys are those of QGroundControl's plan file format (https://docs.qgroundcontrol.com, developer guide); the parts of the
survey have version 1, which every QGroundControl since 3.5 reads. The items are the planned captures. QGroundControl
recomputes the rows when the survey is edited, or opened with a speed other than its default, so polygon, spacing and
entry are chosen such that its rows coincide with the planned ones.

QGroundControl lays rows of azimuth ``angle`` at distances ``k * spacing - reach / 2`` to the right of the middle of the
polygon's extent in east and north, k = 0, 1, …, where ``reach`` is the longer side of the extent plus 2,000 m, and
clips each row to the polygon.
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
    check_qgroundcontrol,
    departure,
    flight,
    plan_object,
    plan_text,
    qgroundcontrol_notes,
    return_home,
    simple_items,
)
from .sorties import Sortie, sorties


class _SurveyRows(NamedTuple):
    """Rows of one sortie in flight order, in the plane around its first capture.

    Parameters
    ----------
    azimuth_deg : float
        Angle for QGroundControl, in (-90, 90].
    offset_m : array (r,)
        Distances to the right of the origin, seen in the direction of ``azimuth_deg``.
    low_m, high_m : array (r,)
        Positions of the first and last captures along this direction.
    forward : bool
        Whether the first row is flown in this direction.
    spacing_m, interval_m : float
        Distance between rows, and between the captures of a row.
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
        """Latitudes and longitudes of positions along and to the right of the rows."""
        east, north = self.east_north(along_m, offset_m)
        lat, lon = self.plane.inverse(east, north)
        return [list(place) for place in zip(lat.tolist(), wrap_lon_deg(lon).tolist())]

    def east_north(self, along_m: Floats, offset_m: Floats) -> tuple[Floats, Floats]:
        """Positions east and north of the origin of the plane."""
        sine, cosine = np.sin(np.radians(self.azimuth_deg)), np.cos(np.radians(self.azimuth_deg))
        return along_m * sine + offset_m * cosine, along_m * cosine - offset_m * sine


def check_survey(plan: Plan) -> None:
    """Raise InvalidInput for a mission that a survey cannot represent."""
    check_qgroundcontrol(plan)
    if plan.joints:
        raise InvalidInput(
            "QGroundControl survey: takes one mission, and {0} are joined",
            len(plan.joints) + 1,
            remedy="choose the ending .plan",
        )
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
        # Rows bend on the Earth, so yaws within a degree count as along or across the rows.
        if _misalignment_deg(plan, rows) > 1.0:
            raise InvalidInput(
                "QGroundControl survey with images {0:g} deg off the direction of rows: must be along or across them",
                round(_misalignment_deg(plan, rows), 1),
                field="yaw_deg",
                remedy="choose the ending .plan",
            )


def survey_texts(plan: Plan) -> list[Iterator[str]]:
    """Text of the plan of each sortie, in blocks."""
    return [_text(plan, sortie) for sortie in sorties(plan)]


def survey_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on how QGroundControl treats the survey, one line each."""
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
    if plan.in_skipped_rows:
        notes.append(Message("rows laid anew include the skipped ones"))
    return (*qgroundcontrol_notes(plan), *notes)


def _text(plan: Plan, sortie: Sortie) -> Iterator[str]:
    captures = np.flatnonzero(sortie.capture >= 0)
    first, end = int(captures[0]), int(captures[-1]) + 1
    before = list(simple_items(chain(departure(sortie), _way(plan, sortie.take(slice(0, first)))), 1))
    item = _survey(plan, sortie.take(slice(first, end)), len(before) + 1)
    number = len(before) + 1 + len(item["TransectStyleComplexItem"]["Items"])
    after = chain(_way(plan, sortie.take(slice(end, len(sortie)))), return_home(plan, sortie))
    return plan_text(
        plan_object(sortie, mixed_heights=_follows_terrain(plan)),
        chain(before, [item], simple_items(after, number)),
    )


def _way(plan: Plan, sortie: Sortie) -> Iterator[Any]:
    return flight(plan, sortie) if len(sortie) else iter(())


def _survey(plan: Plan, sortie: Sortie, first: int) -> dict[str, Any]:
    """Complex item of the rows of a sortie, with simple items numbered from ``first``."""
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
        inner.update(
            # QGroundControl's default is 10 m.
            TerrainAdjustTolerance=plan.mission.terrain.height_tolerance_m or 10,
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
    """Positions at which the flight turns: the ends of rows, and the points between rows."""
    shown = np.flatnonzero(sortie.capture < 0).tolist()
    shown = sorted({*shown, *(end for run in sortie.runs(plan) for end in run)})
    return [[float(sortie.lat_deg[at]), float(sortie.lon_deg[at])] for at in shown]


def _rows(plan: Plan, sortie: Sortie) -> _SurveyRows:
    """Rows of a sortie; for a crosshatch, only the rows in its first direction."""
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
    extent = np.stack([east[ends] - east[starts], north[ends] - north[starts]], axis=1)
    longest = int(np.argmax(np.hypot(*extent.T)))
    azimuth = plan.mission.flight.row_azimuth_deg
    if np.hypot(*extent[longest]) > 0.0:
        azimuth = float(np.degrees(np.arctan2(*extent[longest])))
    # QGroundControl reverses angles beyond 90 degrees.
    azimuth = 90.0 - (90.0 - azimuth) % 180.0
    sine, cosine = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
    along, right = east * sine + north * cosine, east * cosine - north * sine
    offset = (right[starts] + right[ends]) / 2.0
    counts = sortie.capture[ends] - sortie.capture[starts]
    # A row of one image has no direction, so the first longer row decides.
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


def _misalignment_deg(plan: Plan, rows: _SurveyRows) -> float:
    deviation = np.mod(plan.meant.yaw_deg - rows.azimuth_deg + 45.0, 90.0) - 45.0
    return float(np.abs(deviation).max())


def _polygon(plan: Plan, rows: _SurveyRows) -> tuple[list[list[float]], float, int]:
    """Polygon, spacing and entry with which the rows of QGroundControl coincide with the planned ones.

    The corners begin on the side where the first row is entered, from the lowest offset to the highest, as
    QGroundControl flies rows away from the first side.
    """
    order = np.argsort(rows.offset_m, kind="stable")
    offset, low, high = rows.offset_m[order], rows.low_m[order], rows.high_m[order]
    # Entry at the top left (0) or the top right (1).
    entry = 0 if order[0] <= order[-1] else 1
    # The polygon reaches 2 % of an interval beyond the ends of rows.
    margin = 0.02 * rows.interval_m
    # By distance, the last image is taken just inside the polygon; with hovering, one more would be taken there.
    sign = -1.0 if plan.mission.trigger == HOVER else 1.0
    beyond = np.where(high - low < 4.0 * margin, margin, sign * margin)
    # Ends of rows over a slanting side step by up to half an interval.
    straight = 0.6 * rows.interval_m
    left = _straightened(offset, low - beyond, straight, -1.0)
    right = _straightened(offset, high + beyond, straight, 1.0)
    near, far = (left, right) if rows.forward else (right, left)
    best: tuple[float, Floats, Floats, float] = np.inf, low, offset, rows.spacing_m
    # Shares of the spacing by which the polygon reaches beyond its outermost rows.
    shares = np.linspace(0.05, 0.95, 37)
    for below, above in sorted(product(shares, shares), key=sum):
        ends = below * rows.spacing_m, above * rows.spacing_m
        sides = _extended(*near, *ends, margin), _extended(*far, *ends, margin)
        along = np.concatenate([sides[0][0], sides[1][0][::-1]])
        across = np.concatenate([sides[0][1], sides[1][1][::-1]])
        spacing, deviation = _fitted(rows, along, across, offset)
        if deviation < best[0]:
            best = deviation, along, across, spacing
        # Rows within 2 % of a spacing coincide.
        if deviation < 0.02:
            break
    _, along, across, spacing = best
    return rows.placed(along, across), spacing, entry


def _straightened(offset_m: Floats, along_m: Floats, tolerance_m: float, outward: float) -> tuple[Floats, Floats]:
    """Side of the polygon that leaves no end of a row outside, with few corners.

    Over a slanting side the ends of rows step from image to image; a corner at each end would be tedious to edit.
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


def _extended(
    along_m: Floats, offset_m: Floats, below_m: float, above_m: float, tolerance_m: float
) -> tuple[Floats, Floats]:
    """Side extended beyond the outermost rows; corners are moved where the side crosses the rows, else added."""
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
    """Spacing that centres QGroundControl's rows on the planned ones, and their greatest deviation, in spacings."""
    east, north = rows.east_north(along_m, across_m)
    middle = (east.min() + east.max()) / 2.0, (north.min() + north.max()) / 2.0
    # The reach is the longer side of the extent plus 2,000 m.
    reach_m = max(np.ptp(east), np.ptp(north)) + 2000.0
    azimuth = np.radians(rows.azimuth_deg)
    from_first = offset_m - (middle[0] * np.cos(azimuth) - middle[1] * np.sin(azimuth)) + reach_m / 2.0
    centre = float(from_first[0] + from_first[-1]) / 2.0
    # An even number of rows has none in the middle.
    half = 0.5 * (round(float(np.ptp(offset_m)) / rows.spacing_m) % 2)
    steps = max(round(centre / rows.spacing_m - half), 1) + half
    spacing = centre / steps
    deviation = np.abs(from_first / spacing - np.round(from_first / spacing)).max()
    return float(spacing), float(deviation)


def _camera(plan: Plan, rows: _SurveyRows, spacing_m: float) -> dict[str, Any]:
    """CameraCalc of QGroundControl: sensor and focal length of a 35 mm film with the camera's field of view."""
    camera, flight_part = plan.mission.camera, plan.mission.flight
    height_m = float(np.median(plan.meant.agl_m))
    if _follows_terrain(plan):
        height_m = flight_part.agl_m
    wide_m, high_m = camera.ground_size_m(1.0)
    aspect = wide_m / high_m
    diagonal_mm = float(np.hypot(36.0, 24.0))
    sensor_mm = diagonal_mm * aspect / np.hypot(aspect, 1.0), diagonal_mm / np.hypot(aspect, 1.0)
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
