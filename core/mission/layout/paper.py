"""Layout of the published datasets: a grid of equal steps in UTM."""

from __future__ import annotations

import numpy as np

from ...errors import InvalidInput, Message, OptionName
from ...geodesy.projections import utm_zone
from ..areas.area import Box, Polygon
from ..mission import Mission
from ..parts import NORTH
from .rows import (
    Layout,
    RowFrames,
    images_touching,
    in_order,
    level_layout,
    refuse_too_many,
)


def lay_out_paper(mission: Mission, area: Box | Polygon, frames: RowFrames) -> Layout:
    """Grid in the UTM zone of the box's centre, from its top-left corner (the paper's raster mission)."""
    flight = mission.flight
    unsupported = Message("margin {0:g} m", flight.margin_m) if flight.margin_m else ""
    if flight.facing != NORTH:
        unsupported = Message("camera facing {0}", flight.facing)
    if unsupported:
        raise InvalidInput(
            "{0}: the layout {1} does not support it",
            unsupported,
            flight.layout,
            field="layout",
            remedy=Message("use {0} {1}", OptionName("layout"), "cover"),
        )
    box = area.bounds
    middle_lon = box.west_deg + box.span_deg / 2.0
    zone = utm_zone((box.north_deg + box.south_deg) / 2.0, middle_lon)
    # The zone computes with longitudes near its central meridian, which may be a turn away from the box's.
    turn = 360.0 * round((middle_lon - zone.central_meridian_deg) / 360.0)
    reach = box.span_deg / 2.0 + abs(middle_lon - turn - zone.central_meridian_deg)
    # Farther from the meridian the UTM grid is no longer a grid.
    limit_deg = 30.0
    if reach > limit_deg:
        raise InvalidInput(
            "paper layout over {0:g} deg of longitude: its UTM grid holds to {1:g} deg from the zone's meridian",
            box.span_deg,
            limit_deg,
            field="layout",
            remedy=Message("use {0} {1}", OptionName("layout"), "cover"),
        )
    (left, right), (top, bottom) = zone.forward(
        np.array([box.west_deg, box.continuous_east_deg]) - turn, np.array([box.north_deg, box.south_deg])
    )
    width, height = mission.camera.ground_size_m(mission.flight.agl_m)
    step_x, step_y = (
        width * (1.0 - mission.flight.overlap_along),
        height * (1.0 - mission.flight.overlap_across),
    )
    columns = _paper_count(float(right - left), width, step_x)
    rows = _paper_count(float(top - bottom), height, step_y)
    refuse_too_many(columns * rows, mission.output.max_images)
    row, column = (index.ravel() for index in np.indices((int(rows), int(columns)), dtype=np.int64))
    lon, lat = zone.inverse(left + column * step_x, top - row * step_y)
    lon = zone.central_meridian_deg + np.mod(lon - zone.central_meridian_deg + 180.0, 360.0) - 180.0 + turn
    layout = level_layout(mission, column, row, lat, lon)
    return in_order(
        layout if isinstance(area, Box) else images_touching(mission, area, layout, frames(lat), 0.0),
        mission.flight.order,
    )


def _paper_count(extent_m: float, size_m: float, step_m: float) -> float:
    """Number of images until one contains the far corner, ``extent_m`` from the first centre."""
    # Rounding in UTM metres must not add a column or row.
    return max(float(np.ceil((extent_m - size_m / 2.0) / step_m - 1e-9)), 0.0) + 1.0
