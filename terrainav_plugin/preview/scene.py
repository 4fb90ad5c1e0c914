"""Features of a plan for a view of the map. Runs in the background."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..map.outlines import metres, placed
from .density import DensityCells, density_features, levels, mean_images
from .features import (
    ExposureTimes,
    Picked,
    area_features,
    centre_features,
    footprint_features,
    plan_flight,
    plan_part,
)
from .index import CaptureIndex, Rects, count_shown
from .view import MERCATOR, Rect, preview_world

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from qgis.core import QgsFeature

    from ...core.mission.plan import Plan
    from .view import MapView

    Floats = NDArray[np.float64]
    Numbers = NDArray[np.int64]

#: Largest number of images drawn individually, so that the user does not notice how they are added to a layer.
MOST_DRAWN = 1000
#: Number of images up to which all are drawn, however small they are: otherwise nothing would be visible from afar.
FEW = 100
_DENSITY_MARGIN = 0.25
#: Largest deviation of a footprint's curved edges from the rectangle around its corners, as a share of its size, for
#: footprints of up to half a degree; of lenses that distort, of which r + k1 r³ may be nearly r³.
_BULGE, _BENT_BULGE = 0.01, 0.25


class Drawing(NamedTuple):
    """Features of each layer, and the part of the world, scale and time for which they are valid.

    Attributes
    ----------
    layers : dict
        Features by role of their layer; a list that is unchanged need not be added again.
    covers : Rect
        Part of the world for which the features are valid.
    px_per_m : float
        Scale for which the features were computed.
    all_drawn : bool
        Whether all images in ``covers`` are drawn individually, none as density.
    times_ms : tuple of float, or None
        Time range for which the features were computed; None if they are valid at any time.
    bounds : Rect
        Bounds of the whole mission.
    """

    layers: dict[str, list[QgsFeature]]
    covers: Rect
    px_per_m: float
    all_drawn: bool
    times_ms: tuple[float, float] | None
    bounds: Rect

    def serves(self, view: MapView) -> bool:
        """Whether this drawing is also valid for another view."""
        if not self.covers.contains(view.rect) or (not self.all_drawn and self.times_ms != view.times_ms):
            return False
        scale = view.px_per_m(*_middle(view.rect, self.bounds))
        # At a larger scale, images drawn individually remain valid; at a smaller scale, they may be too small.
        return math.isclose(scale, self.px_per_m, rel_tol=1e-3) or (self.all_drawn and scale > self.px_per_m)


class PreviewScene:
    """A plan prepared for drawing. Use on one thread at a time.

    Parameters
    ----------
    plan : Plan
    check : callable
        Called between steps; raises an exception if the work is overtaken.
    """

    def __init__(self, plan: Plan, check: Callable[[], None] = lambda: None) -> None:
        self.plan = plan
        self.windows = Rects.wrapped(*plan.edges, preview_world(plan))
        check()
        self.index = CaptureIndex(self.windows if plan.frames.on_map else _seen(plan, self.windows))
        check()
        self._clock = ExposureTimes(plan)
        self._flight = plan_flight(plan, self.index, self._clock)
        self._area = area_features(plan)
        self._whole_flight, self._flight_ends = self._flight.whole(), self._flight.ends()
        self.bounds = _bounds(plan, self.index.boxes)
        self._density: tuple[tuple[DensityCells, float], list[QgsFeature]] | None = None

    def draw(self, view: MapView | None, check: Callable[[], None] = lambda: None) -> Drawing:
        """Features for a view; None for the whole mission, before there is a view."""
        rect = self.bounds if view is None else view.rect
        scale = 1000.0 / rect.longer_m if view is None else view.px_per_m(*_middle(rect, self.bounds))
        times = None if view is None else view.times_ms
        # Images below 6 px on the screen are shown as density.
        smallest_m = 0.0 if len(self.plan) <= FEW else 6.0 / scale
        ids, covers, dense_below = self._choose(rect, smallest_m, times)
        check()
        all_drawn = ids is not None and dense_below == 0.0
        layers = {"area": self._area, "flight": self._flight_ends, "centres": [], "footprints": []}
        if all_drawn or self._flight.is_clear(self.bounds, scale):
            layers["flight"] = self._whole_flight
        if ids is not None:
            picked = self._picked(ids)
            check()
            layers["footprints"] = footprint_features(picked)
            check()
            layers["centres"] = centre_features(picked)
            if all_drawn and not self._flight.is_short:
                layers["flight"] = self._flight.legs(ids, covers)
        check()
        if not all_drawn:
            covers = rect.grown(_DENSITY_MARGIN) if ids is None else covers
        layers["density"] = [] if all_drawn else self._dense(covers, scale, dense_below)
        return Drawing(layers, covers, scale, all_drawn, times, self.bounds)

    def _choose(
        self, rect: Rect, smallest_m: float, times: tuple[float, float] | None
    ) -> tuple[Numbers | None, Rect, float]:
        """Images to draw individually, or None; where that is valid; and the size below which images become density."""
        if rect.is_empty():
            return np.empty(0, np.int64), rect, 0.0
        # With a margin around the view, the drawing also serves small moves: try the widest margin first.
        for margin in (0.5, 0.2, 0.05, 0.0):
            covers = rect.grown(margin)
            # The bins also contain images outside the view: skip the search only if they have three times too many.
            if self.index.count(covers, smallest_m) > 3 * MOST_DRAWN:
                continue
            ids = self.index.find(covers, smallest_m)
            if len(ids) <= MOST_DRAWN:
                smaller = smallest_m > 0.0 and self._has_below(smallest_m, covers)
                if len(ids) or not smaller:
                    return ids, covers, smallest_m if smaller else 0.0
                break
        return self._flown(rect, times), rect.grown(_DENSITY_MARGIN), math.inf

    def _has_below(self, size_m: float, rect: Rect) -> bool:
        if float(self.index.longer_m.min()) >= size_m:
            return False
        return self.index.count(rect) > self.index.count(rect, size_m) or bool(
            (self.index.longer_m[self.index.find(rect)] < size_m).any()
        )

    def _flown(self, rect: Rect, times: tuple[float, float] | None) -> Numbers | None:
        """Images in view in the time range of the temporal controller, if these are few enough to draw; else None."""
        if times is None:
            return None
        first, after = self._clock.during(times)
        if after - first > MOST_DRAWN:
            return None
        ids = np.arange(first, after)
        return ids[self.index.boxes.take(ids).meets(rect.grown(_DENSITY_MARGIN))]

    def _picked(self, ids: Numbers) -> Picked:
        part = plan_part(self.plan, ids)
        clock = self._clock
        return Picked(
            part,
            clock.at_ms[ids],
            clock.until_ms[ids],
            self._overlap(ids),
            _crowd(self.index.boxes.take(ids)),
        )

    def _overlap(self, ids: Numbers) -> Numbers:
        """Number of planned images that show the middle of each image; camera frames count by inscribed rectangles."""
        if not len(ids):
            return np.empty(0, np.int64)
        x, y = self.windows.take(ids).middles
        others = self.index.find(Rect(x.min(), y.min(), x.max(), y.max(), self.windows.world))
        return count_shown(self.windows.take(others), x, y)

    def _dense(self, rect: Rect, scale: float, below_m: float) -> list[QgsFeature]:
        cells = DensityCells.covering(rect, scale)
        if self._density is None or self._density[0] != (cells, below_m):
            windows = self.windows
            if math.isfinite(below_m):
                windows = windows.take(np.flatnonzero(self.index.longer_m < below_m))
            elif self.index.count(rect) < len(self.plan) // 4:
                windows = windows.take(self.index.find(rect))
            self._density = (cells, below_m), density_features(levels(mean_images(windows, cells)), cells)
        return self._density[1]


def _crowd(boxes: Rects) -> Numbers:
    """Number of rectangles that contain the middle of each rectangle."""
    return count_shown(boxes, *boxes.middles)


def _middle(rect: Rect, bounds: Rect) -> tuple[float, float]:
    """Point of a view at which to compute its scale: within the mission, if the mission is in view."""
    x = [max(rect.west, bounds.west), min(rect.east, bounds.east)]
    y = [max(rect.south, bounds.south), min(rect.north, bounds.north)]
    if x[0] > x[1]:
        x = [rect.west, rect.east]
    if y[0] > y[1]:
        y = [rect.south, rect.north]
    middle, world = sum(x) / 2.0, rect.world
    return (middle - world.size if world.wraps and middle > world.east else middle), sum(y) / 2.0


def _bounds(plan: Plan, boxes: Rects) -> Rect:
    """Bounds of a whole mission, from its captures with continuous longitudes."""
    world, turn = boxes.world, 0.0
    if world.wraps:
        x, _ = metres(plan.lon_deg, np.zeros(len(plan)))
        turn = world.size * np.round((x - (boxes.west + boxes.east) / 2.0) / world.size)
    west, east = float((boxes.west + turn).min()), float((boxes.east + turn).max())
    return Rect.fitted(west, float(boxes.south.min()), east, float(boxes.north.max()), world)


def _seen(plan: Plan, windows: Rects) -> Rects:
    """Bounding rectangles of the ground in camera frames; generous if the horizon or a pole may be visible."""
    if not windows.world.wraps:
        return _seen_in_crs(plan, windows)
    corners = plan.corners
    lat, lon = corners.lat_deg, corners.lon_deg
    south, north, west, east = lat.min(axis=1), lat.max(axis=1), lon.min(axis=1), lon.max(axis=1)
    margin = _bulge(plan) * np.maximum(north - south, east - west)
    south, north, west, east = south - margin, north + margin, west - margin, east + margin
    ample = np.flatnonzero(
        ~corners.hit.all(axis=1) | (plan.views.poles != 0) | (np.maximum(north - south, east - west) > 0.5)
    )
    if len(ample):
        reach = _horizon_deg(plan.height_m[ample])
        at_lat, at_lon = plan.lat_deg[ample], plan.lon_deg[ample]
        south[ample], north[ample] = at_lat - reach, at_lat + reach
        # Range of longitudes of a circle on a sphere: all longitudes if the circle contains a pole.
        share = np.sin(np.radians(reach)) / np.cos(np.radians(at_lat))
        wide = np.where(np.abs(at_lat) + reach < 90.0, np.degrees(np.arcsin(np.clip(share, 0.0, 1.0))), 180.0)
        west[ample], east[ample] = at_lon - wide, at_lon + wide
    x0, y0 = metres(west, np.maximum(south, -90.0))
    x1, y1 = metres(east, np.minimum(north, 90.0))
    return Rects.wrapped(x0, np.maximum(y0, MERCATOR.south), x1, np.minimum(y1, MERCATOR.north))


def _bulge(plan: Plan) -> float:
    return _BENT_BULGE if plan.cameras.distort else _BULGE


def _seen_in_crs(plan: Plan, windows: Rects) -> Rects:
    """Bounding rectangles as from `_seen`, in the CRS of the imagery; such camera frames do not show the horizon."""
    x, y = placed(plan.grid.plane, plan.corners.lon_deg, plan.corners.lat_deg)
    # Ignore corners outside the domain of the projection; the inscribed rectangle of each image remains.
    west, east = np.fmin.reduce(x, axis=1, initial=np.inf), np.fmax.reduce(x, axis=1, initial=-np.inf)
    south, north = np.fmin.reduce(y, axis=1, initial=np.inf), np.fmax.reduce(y, axis=1, initial=-np.inf)
    west, south = np.minimum(west, windows.west), np.minimum(south, windows.south)
    east, north = np.maximum(east, windows.east), np.maximum(north, windows.north)
    margin = _bulge(plan) * np.maximum(east - west, north - south)
    return Rects(west - margin, south - margin, east + margin, north + margin, windows.world)


def _horizon_deg(height_m: Floats) -> Floats:
    """Degrees to the horizon, as an upper limit."""
    height = np.maximum(height_m, 0.0)
    # A smaller radius gives a larger angle; 1 % more covers the smaller radii of curvature of the ellipsoid.
    polar_radius_m = 6_356_752.0
    return np.degrees(np.arccos(polar_radius_m / (polar_radius_m + height))) * 1.01 + 1e-6
