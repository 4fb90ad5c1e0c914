"""The flight line: every leg where captures are drawn one by one, and few corners elsewhere. Runs in the background."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from qgis.core import QgsFeature, QgsGeometry, QgsLineString, QgsMultiLineString

from ...core.geodesy.mercator import wrap_lon_deg
from .outlines import metres
from .preview_features import Clock, feature, moment
from .preview_index import Boxes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...core.mission.plan import Plan
    from .preview_index import CaptureIndex
    from .preview_view import Rect

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.int64]

#: Least space between legs on the screen: closer ones would hide all else.
_LEAST_SPACE_PX = 10.0
#: A flight of up to so many captures is always drawn whole; longer ones have so many corners from afar.
MOST_CORNERS = 4000


class Flight:
    """The way from the first capture of a plan to the last."""

    def __init__(self, plan: Plan, index: CaptureIndex, clock: Clock) -> None:
        self._plan = plan
        lon = wrap_lon_deg(np.array([plan.lon_deg[0]]))
        self._attributes = (
            plan.flight_distance_m,
            len(plan),
            float(plan.lat_deg[0]),
            float(lon[0]),
            moment(clock.at_ms[0]),
            moment(clock.until_ms[-1]),
        )
        self._whole = _corners(plan.row)
        if self.is_short:
            return
        # Legs longer than the pictures beside them may cross a view that no picture of them touches.
        x, y = metres(plan.lon_deg, plan.lat_deg)
        step = np.maximum(np.abs(np.diff(x)), np.abs(np.diff(y)))
        self._long = np.flatnonzero(step > np.minimum(index.longer_m[:-1], index.longer_m[1:]))
        x0, y0, x1, y1 = (values[self._long + shift] for shift in (0, 1) for values in (x, y))
        self._long_boxes = Boxes.wrapped(
            np.minimum(x0, x1), np.minimum(y0, y1), np.maximum(x0, x1), np.maximum(y0, y1)
        )

    @property
    def is_short(self) -> bool:
        """Whether it is always drawn whole."""
        return len(self._plan) <= MOST_CORNERS

    def whole(self) -> list[QgsFeature]:
        """The line from end to end, at few corners of a long flight: where rows begin and end, and some between."""
        return self._feature([self._whole])

    def ends(self) -> list[QgsFeature]:
        """The first row and the last."""
        row = self._plan.row[self._whole]
        return self._feature([self._whole[row == end] for end in np.unique([row[0], row[-1]])])

    def is_clear(self, bounds: Rect, px_per_m: float) -> bool:
        """Whether the legs of the whole flight lie far enough apart on the screen, over all, to be told apart."""
        area_m2 = (bounds.east - bounds.west) * (bounds.north - bounds.south)
        # Metres of the map are longer than those of the ground by the same share in length and, squared, in area.
        length_m = self._plan.flight_distance_m / np.cos(
            np.radians(float(np.mean(self._plan.lat_deg[self._whole])))
        )
        return bool(area_m2 * px_per_m >= _LEAST_SPACE_PX * length_m)

    def near(self, ids: Numbers, rect: Rect) -> list[QgsFeature]:
        """Legs of a long flight from or to some captures, and those that cross a part of the world on their way."""
        last = len(self._plan) - 1
        crossing = self._long[self._long_boxes.meets(rect)]
        legs = np.unique(np.concatenate([ids, ids - 1, crossing]))
        legs = legs[(legs >= 0) & (legs < last)]
        cuts = np.flatnonzero(np.diff(legs) > 1) + 1
        return self._feature([np.append(run, run[-1] + 1) for run in np.split(legs, cuts) if len(run)])

    def _feature(self, runs: list[Numbers]) -> list[QgsFeature]:
        lines = QgsMultiLineString()
        for run in runs:
            for lon, lat in _split_at_antimeridian(self._plan.lon_deg[run], self._plan.lat_deg[run]):
                x, y = metres(lon, lat)
                lines.addGeometry(QgsLineString(x.tolist(), y.tolist()))
        return [feature(QgsGeometry(lines), *self._attributes)]


def _corners(row: Numbers) -> Numbers:
    count = len(row)
    if count <= MOST_CORNERS:
        return np.arange(count)
    turns = row[1:] != row[:-1]
    ends = np.flatnonzero(np.r_[True, turns] | np.r_[turns, True])
    if len(ends) > MOST_CORNERS:
        return np.unique(np.linspace(0, count - 1, MOST_CORNERS).astype(np.int64))
    between = np.linspace(0, count - 1, MOST_CORNERS - len(ends)).astype(np.int64)
    return np.union1d(ends, between)


def _split_at_antimeridian(lon: Floats, lat: Floats) -> list[tuple[Floats, Floats]]:
    """Parts of a line of continuous longitudes, each within one turn of the Earth."""
    turn = np.floor((lon + 180.0) / 360.0)
    at = np.flatnonzero(turn[1:] != turn[:-1])
    if not len(at):
        return [(lon - 360.0 * turn[0], lat)]
    border = 360.0 * np.maximum(turn[at], turn[at + 1]) - 180.0
    share = (border - lon[at]) / (lon[at + 1] - lon[at])
    crossing_lat = lat[at] + share * (lat[at + 1] - lat[at])
    parts = []
    for begin, end in zip([0, *(at + 1)], [*(at + 1), len(lon)]):
        part_lon, part_lat = lon[begin:end], lat[begin:end]
        if begin > 0:
            index = int(np.searchsorted(at + 1, begin))
            part_lon, part_lat = np.r_[border[index], part_lon], np.r_[crossing_lat[index], part_lat]
        if end < len(lon):
            index = int(np.searchsorted(at + 1, end))
            part_lon, part_lat = np.r_[part_lon, border[index]], np.r_[part_lat, crossing_lat[index]]
        parts.append((part_lon - 360.0 * turn[begin], part_lat))
    return parts
