"""A polygon or points as the text that a form keeps of them. Knows no widget."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields, replace
from functools import lru_cache

from ...core.errors import InvalidInput
from ...core.mission.area import Area, Box, Points, Polygon
from ...core.mission.mission import SCHEMA, Mission
from ...core.safe_json import parse_json
from ..i18n import tr

#: Heights this near to each other are the same: spin boxes show four decimals, of a foot at least.
SAME_HEIGHT_M = 1e-4
#: Shapes kept read: the one entered, and those that undo goes through.
_KEPT = 8


@dataclass(frozen=True)
class Shape:
    """A polygon or points, read.

    Parameters
    ----------
    area : Polygon or Points
    bounds : Box
        The smallest box around it, which the edges' fields show.
    agl_m : float
        Height that was entered when points were taken; another one since then is that of all points.
    """

    area: Polygon | Points
    bounds: Box
    agl_m: float

    def at(self, agl_m: float) -> Polygon | Points:
        """Area when a height is entered: all points have it unless it is the one they were taken with."""
        if not isinstance(self.area, Points) or abs(agl_m - self.agl_m) <= SAME_HEIGHT_M or agl_m <= 0.0:
            return self.area
        return replace(self.area, poses=tuple((lat, lon, agl_m) for lat, lon, _ in self.area.poses))


def shape_text(area: Area, agl_m: float) -> str:
    """Text of a polygon or of points, taken while a height is entered; empty for a box."""
    if isinstance(area, Box):
        return ""
    # As a mission's file has it; without the copy of every corner that `Mission.to_dict` makes.
    data = {field.name: getattr(area, field.name) for field in fields(area)}
    return json.dumps({"type": type(area).__name__.lower(), **data, "agl_m": agl_m})


@lru_cache(_KEPT)
def shape_of(text: str) -> Shape:
    """Shape of a text; raises InvalidInput where it holds none."""
    try:
        data = parse_json(text)
        agl_m = float(data.pop("agl_m", 1.0))
    except (ValueError, TypeError, AttributeError) as wrong:
        raise InvalidInput(tr("the area's shape cannot be read: {error}").format(error=wrong)) from wrong
    area = Mission.from_dict({"schema": SCHEMA, "area": data, "agl_m": 1.0}).area
    if isinstance(area, Box):
        raise InvalidInput(tr("the area's shape is a box: must be a polygon or points"))
    return Shape(area, area.bounds, agl_m)


@lru_cache(_KEPT)
def area_at(text: str, agl_m: float) -> Polygon | Points:
    """Area of a text when a height is entered; raises InvalidInput where it holds none."""
    return shape_of(text).at(agl_m)
