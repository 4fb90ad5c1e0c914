"""Rows along parallels that cover an area: overlap becomes the spacing of rows, and of images along rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple, Protocol

import numpy as np

from ...arrays import Floats, NDArray, Numbers, expand_counts
from ...errors import InvalidInput
from ...geodesy.ellipsoid import WGS84, gauss_legendre
from ...geodesy.frames import FrameEdges
from ...geodesy.mercator import lat_to_v, lon_to_u, u_to_lon, v_to_lat
from ..areas.area import Box, Points, Polygon, Polygons, row_spans
from ..mission import Mission
from .paper import lay_out_paper
from .rows import (
    ROUNDING_PX,
    Layout,
    RowFrames,
    bounds_with_margin,
    edges_with_margin,
    images_touching,
    in_order,
    level_layout,
    refuse_beyond_mercator,
    refuse_no_step,
    refuse_too_many,
    sees_below,
)

#: Overlap of neighbours: far above the noise of float64 positions at zoom 22 (1e-7 px), so that rounding never opens a
#: gap, and too small to cost a picture.
_MEETING_PX = 1e-3
#: Rows have converged when no centre moves by more than this share of the world in a pass: 0.4 µm of ground.
_CONVERGED = 1e-14
#: Latitudes tried for cameras that look far aside.
_TRIED = 257
#: Share by which the estimated number of rows may be off.
_COUNT_SHARE = 1e-3
#: Number of rows by which the estimate may be off besides that share.
_COUNT_MORE = 3
#: Number of rows above which images are estimated before rows are placed.
_MANY_ROWS = 1000
#: Share of the estimated images that is certain to be needed.
_CERTAIN_SHARE = 0.95
#: Edges of the frames of captures at latitudes in degrees and heights above ground in metres, (n,) each.
Frames = Callable[[Floats, Floats], FrameEdges]


class Below(Protocol):
    """Heights of captures above the ground that they see: the part of `Relief` that rows use."""

    @property
    def is_level(self) -> bool:
        """Whether the ground is level."""
        ...

    @property
    def merge_distance_m(self) -> float:
        """Distance below which positions count as one."""
        ...

    def least_seen_agl_m(self, lat_deg: Floats) -> Floats:
        """Least height of captures at latitudes (n,) above the highest ground that they see."""
        ...

    def most_seen_agl_m(self, lat_deg: Floats) -> Floats:
        """Greatest height of captures at latitudes (n,) above the highest ground that they see."""
        ...

    def seen_agl_m(self, lat_deg: Floats, lon_deg: Floats) -> Floats:
        """Least height of captures near positions (n,) above the highest ground that they see; may be NaN.

        Near means within `merge_distance_m`.
        """
        ...

    @property
    def deepest_m(self) -> float:
        """Greatest height of a capture above the lowest ground that it sees."""
        ...


def lay_out(mission: Mission, frames: Frames, pixel: float, relief: Below) -> Layout:
    """Positions of the captures of a mission.

    Parameters
    ----------
    frames : callable
        Edges of frames at latitudes and heights of the camera.
    pixel : float
        Size of a pixel as a fraction of the world, >= 0: the outermost frames leave room for rounding.
    relief : Below
        Ground below: rows are closer where it is higher.

    Raises
    ------
    InvalidInput
        There are more captures than ``mission.max_images``, the area is outside Web Mercator, or the camera sees past
        the horizon.
    """
    area = mission.area
    if isinstance(area, (Points, Polygons)):
        raise InvalidInput("points have no rows, and several polygons have rows each by themselves")
    refuse_beyond_mercator(bounds_with_margin(mission, area))

    aside = bool(mission.attitude.tilt_deg or mission.attitude.roll_deg)

    def row_frames(lat_deg: Floats) -> FrameEdges:
        least = frames(lat_deg, relief.least_seen_agl_m(lat_deg))
        if relief.is_level or not aside:
            return least
        # Oblique views shift with height: use the common part of images from all heights.
        most = frames(lat_deg, relief.most_seen_agl_m(lat_deg))
        west, top = (np.maximum(*edges) for edges in ((least.west_u, most.west_u), (least.top_v, most.top_v)))
        east, bottom = (np.minimum(*edges) for edges in ((least.east_u, most.east_u), (least.bottom_v, most.bottom_v)))
        held = (east > west) & (bottom > top)
        return FrameEdges(*(np.where(held, *edges) for edges in zip((west, east, top, bottom), least)))

    if mission.flight.layout == "paper":
        return lay_out_paper(mission, area, row_frames)
    if not (relief.is_level or sees_below(mission)):
        deep = np.float64(relief.deepest_m)
        return _cover(
            mission,
            area,
            row_frames,
            pixel,
            deepest=lambda lat_deg: frames(lat_deg, np.broadcast_to(deep, lat_deg.shape)),
        )
    if relief.is_level or aside:
        return _cover(mission, area, row_frames, pixel)
    return _cover(mission, area, row_frames, pixel, _ReliefRows(mission, frames, relief, _MEETING_PX * pixel))


def _cover(
    mission: Mission,
    area: Box | Polygon,
    frames: RowFrames,
    pixel: float,
    along: _ReliefRows | None = None,
    deepest: RowFrames | None = None,
) -> Layout:
    """Rows whose frames cover an area, and still reach its edges over the lowest ground (``deepest``).

    Frames over ground of other heights lie between the two.
    """
    box = bounds_with_margin(mission, area)
    if deepest is not None:
        box = _enlarged(box, frames, deepest)
    rows_v, edges = _row_centres(mission, box, frames, pixel, refuse_early=along is None)
    rounding = ROUNDING_PX * pixel
    lower = edges if deepest is None else deepest(v_to_lat(rows_v))
    united = _united(edges, lower)
    top_v, bottom_v, beside_deg = edges_with_margin(mission, united.top_v - rounding, united.bottom_v + rounding)
    if along is None and len(rows_v) > _MANY_ROWS:
        # Spans of many rows take long to find, so refuse early: images show at least the area of the polygon.
        one_m2 = WGS84.zone_area_m2_per_deg(v_to_lat(edges.bottom_v), v_to_lat(edges.top_v))
        most_m2 = float(np.max(one_m2 * 360.0 * edges.size[0]))
        refuse_too_many(_CERTAIN_SHARE * area.area_m2() / most_m2, mission.output.max_images)
    spans = row_spans(area, top_v, bottom_v)
    if mission.flight.margin_m:
        spans = spans + beside_deg[:, np.newaxis] * np.array([-1.0, 1.0])
    used = ~np.isnan(spans[:, 0])
    lat, spans = v_to_lat(rows_v[used]), spans[used]
    edges, lower, united = (FrameEdges(*(edge[used] for edge in some)) for some in (edges, lower, united))

    width, _ = edges.size
    step = width * (1.0 - mission.flight.overlap_along) - _MEETING_PX * pixel
    refuse_no_step(step, mission.flight.overlap_along, mission)
    west_u = lon_to_u(spans[:, 0]) - rounding - np.maximum(lower.west_u - edges.west_u, 0.0)
    east_u = lon_to_u(spans[:, 1]) + rounding + np.maximum(edges.east_u - lower.east_u, 0.0)
    counts = np.maximum(np.ceil((east_u - west_u - width) / step), 0.0) + 1.0
    if along is not None:
        # Far more captures than allowed are not counted exactly.
        if float(counts.sum()) > 20.0 * mission.output.max_images:
            refuse_too_many(float(counts.sum()), mission.output.max_images)
        row, column, u, west, east = along.placed(lat, west_u, east_u, edges)
        united = FrameEdges(west, east, edges.top_v[row], edges.bottom_v[row])
    else:
        refuse_too_many(float(counts.sum()), mission.output.max_images)
        per_row = counts.astype(np.int64)
        row, column = expand_counts(per_row)
        middle = (west_u + east_u - edges.west_u - edges.east_u) / 2.0
        u = middle[row] + (column - (per_row[row] - 1) / 2.0) * step[row]
        united = FrameEdges(*(edge[row] for edge in united))
    layout = level_layout(mission, column, row, lat[row], u_to_lon(u))
    return in_order(images_touching(mission, area, layout, united, rounding), mission.flight.order)


def _enlarged(box: Box, frames: RowFrames, deepest: RowFrames) -> Box:
    """Box enlarged north and south so that rows that cover the box also cover the area over the lowest ground."""
    ends = np.array([box.north_deg, box.south_deg])
    high, low = frames(ends), deepest(ends)
    north = np.maximum(low.top_v - high.top_v, 0.0).max()
    south = np.maximum(high.bottom_v - low.bottom_v, 0.0).max()
    top, bottom = lat_to_v(ends[:1])[0] - north, lat_to_v(ends[1:])[0] + south
    north_deg, south_deg = (float(v_to_lat(np.clip(at, 0.0, 1.0))) for at in (top, bottom))
    return replace(box, north_deg=max(north_deg, box.north_deg), south_deg=min(south_deg, box.south_deg))


def _united(frames: FrameEdges, others: FrameEdges) -> FrameEdges:
    """Smallest frames around pairs of frames."""
    return FrameEdges(
        np.minimum(frames.west_u, others.west_u),
        np.maximum(frames.east_u, others.east_u),
        np.minimum(frames.top_v, others.top_v),
        np.maximum(frames.bottom_v, others.bottom_v),
    )


def _row_centres(
    mission: Mission, box: Box, frames: RowFrames, pixel: float, *, refuse_early: bool
) -> tuple[Floats, FrameEdges]:
    """World fractions of the cameras of rows, north to south, and edges of their frames."""
    rows = _ParallelRows(mission, box, frames, pixel, refuse_early=refuse_early)
    centres, edges = rows.settle(rows.first_top, rows.most())
    count = int(np.searchsorted(edges.bottom_v, rows.last_bottom)) + 1
    while count > len(centres):
        # Overlap is a share of the higher row, so rows may be closer than estimated.
        refuse_too_many(count, mission.output.max_images)
        missing, step = rows.last_bottom - edges.bottom_v[-1], edges.bottom_v[-1] - edges.bottom_v[-2]
        centres, edges = rows.settle(rows.first_top, len(centres) + math.ceil(missing / step) + _COUNT_MORE)
        count = int(np.searchsorted(edges.bottom_v, rows.last_bottom)) + 1
    spare = float(edges.bottom_v[count - 1]) - rows.last_bottom
    shift = rows.centring_shift(count, spare)
    placed, edges = rows.settle(rows.first_top - shift, count)
    while edges.bottom_v[-1] < rows.last_bottom - _CONVERGED and count < len(centres):
        # Rows that have only come nearer may no longer reach the end; more rows are not centred.
        count += 1
        placed, edges = rows.settle(rows.first_top, count)
    placed, edges = rows.lean(placed, edges)
    rows.refuse_gaps(placed)
    return placed, edges


#: Passes without progress after which rows only come nearer. Rows that converge improve within ten.
_STALLED = 50


class _ParallelRows:
    """Rows of frames between two parallels, as world fractions."""

    def __init__(self, mission: Mission, box: Box, frames: RowFrames, pixel: float, *, refuse_early: bool) -> None:
        self._mission, self._frames = mission, frames
        self._north, self._south = (float(lat_to_v(np.asarray(lat))) for lat in (box.north_deg, box.south_deg))
        self._meeting = _MEETING_PX * pixel
        # Rows as wide as the box have a known number of images.
        known = refuse_early and isinstance(mission.area, Box)
        self._across = box.span_deg / 360.0 if known else 0.0
        self.first_top = max(self._north - ROUNDING_PX * pixel, 0.0)
        self.last_bottom = min(self._south + ROUNDING_PX * pixel, 1.0)
        self._least, self._most = self._cameras()
        # Placing rows costs as much as all other steps together, and centring tries the rows that are then placed.
        self._settled: dict[tuple[float, int], tuple[Floats, FrameEdges]] = {}

    def _cameras(self) -> tuple[float, float]:
        """Range of cameras with frames that overlap the area."""
        places = np.array([self._north, self._south])
        edges = self._frames(v_to_lat(places))
        aside = (edges.top_v + edges.bottom_v) / 2.0 - places
        # The shift of frames farther aside than a thousandth of the world depends on latitude.
        if float(np.abs(aside).max()) > 1e-3:
            return self._try_cameras()
        # The centre of a symmetric frame differs from the camera's position only by Mercator's stretch.
        level = np.abs(aside) < edges.size[1] / 4.0
        half = edges.size[1] / 2.0
        cameras = np.where(level, places + np.array([-1.0, 1.0]) * half, places - 1.5 * aside)
        return max(min(self._north, float(cameras.min())), 0.0), min(max(self._south, float(cameras.max())), 1.0)

    def _try_cameras(self) -> tuple[float, float]:
        """Range of cameras with frames so far aside that the shift depends on latitude."""
        tried = np.linspace(0.0, 1.0, _TRIED)
        edges = self._frames(v_to_lat(tried))
        sees = (edges.size[1] > 0.0) & (edges.bottom_v >= self._north) & (edges.top_v <= self._south)
        if not sees.any():
            raise InvalidInput(
                "a camera at {0:g} m with this tilt sees the area from nowhere on the map",
                self._mission.flight.agl_m,
                field="tilt_deg",
                remedy="tilt it less or fly lower",
            )
        places = tried[sees]
        highest, lowest = (np.where(sees, edge, worst) for edge, worst in ((edges.top_v, 2.0), (edges.bottom_v, -1.0)))
        if self._out_of_sight(highest - self._north) or self._out_of_sight(self._south - lowest):
            raise self._coverage_error()
        return max(float(places[0] - tried[1]), 0.0), min(float(places[-1] + tried[1]), 1.0)

    def _out_of_sight(self, missing: Floats) -> bool:
        """Whether frames of all tried cameras end before a side of the area."""
        nearest = int(np.argmin(missing))
        # Cameras between the tried ones may reach farther, but not beyond the first and last.
        between = 0 < nearest < _TRIED - 1
        return float(missing[nearest]) > (2.0 / _TRIED if between else 0.0)

    def _coverage_error(self) -> InvalidInput:
        if self._mission.attitude.tilt_deg or self._mission.attitude.roll_deg:
            return InvalidInput(
                "rows from {0:g} m cannot be placed so that their images cover this area",
                self._mission.flight.agl_m,
                remedy="tilt the camera less, fly lower or take a smaller area",
            )
        return InvalidInput(
            "rows from {0:g} m cannot be placed so that their images cover this area",
            self._mission.flight.agl_m,
            remedy="fly lower or take a smaller area",
        )

    def refuse_gaps(self, centres: Floats) -> None:
        """Refuse rows outside the range of cameras, whose frames are elsewhere."""
        if not self._are_inside(centres):
            raise self._coverage_error()

    def _are_inside(self, centres: Floats) -> bool:
        """Whether rows are within the range of cameras."""
        return bool(((centres >= self._least - _CONVERGED) & (centres <= self._most + _CONVERGED)).all())

    def _edges(self, centres: Floats) -> FrameEdges:
        """Edges of frames at the centres, extrapolated outside the range of cameras.

        Centres are outside only while rows converge.
        """
        inside = np.clip(centres, self._least, self._most)
        edges = self._frames(v_to_lat(inside))
        moved = centres - inside
        return edges._replace(top_v=edges.top_v + moved, bottom_v=edges.bottom_v + moved)

    def _steps(self, centres: Floats, edges: FrameEdges) -> Floats:
        """Distances between consecutive rows at centres."""
        height = edges.bottom_v - edges.top_v
        shared = self._mission.flight.overlap_across * np.maximum(height[1:], height[:-1])
        below, above = (edges.bottom_v - centres)[:-1], (centres - edges.top_v)[1:]
        steps: Floats = below + above - shared - self._meeting
        refuse_no_step(steps, self._mission.flight.overlap_across, self._mission)
        return steps

    def most(self) -> int:
        """Number of rows that certainly reach from north to south: the integral of rows per height, and a few more."""
        nodes, weights = gauss_legendre(64)
        half = (self._south - self._north) / 2.0
        edges = self._edges(self._north + half * (1.0 + nodes))
        step = (edges.bottom_v - edges.top_v) * (1.0 - self._mission.flight.overlap_across) - self._meeting
        refuse_no_step(step, self._mission.flight.overlap_across, self._mission)
        count = half * float(np.sum(weights / step))
        refuse_too_many(math.floor(count * (1.0 - _COUNT_SHARE)), self._mission.output.max_images)
        if count > _MANY_ROWS:
            # Placing many rows takes seconds: refuse what certainly exceeds the limit first.
            width, _ = edges.size
            columns = np.ceil(
                np.maximum(self._across - width, 0.0) / (width * (1.0 - self._mission.flight.overlap_along))
            )
            images = half * float(np.sum(weights / step * (columns + 1.0)))
            # The last row ends with the area, so the overlap beyond it is not flown.
            images *= max(
                1.0 - self._mission.flight.overlap_across / (1.0 - self._mission.flight.overlap_across) / count,
                0.0,
            )
            if images * _CERTAIN_SHARE > self._mission.output.max_images:
                # 1 % more, so that a limit raised to this number is enough.
                refuse_too_many(math.ceil(images * 1.01), self._mission.output.max_images)
        return math.ceil(count * (1.0 + _COUNT_SHARE)) + _COUNT_MORE

    def settle(self, top: float, count: int) -> tuple[Floats, FrameEdges]:
        """Centres and edges of ``count`` consecutive rows from a first top edge; the last result is cached."""
        if (top, count) not in self._settled:
            self._settled = {(top, count): self._settle(top, count)}
        return self._settled[top, count]

    def _settle(self, top: float, count: int) -> tuple[Floats, FrameEdges]:
        """Place rows by Picard iteration.

        The position of a row depends on the heights of all rows before, which depend on their positions: all rows are
        placed at once, again and again with the heights of the last pass. Rows that have moved back and forth then only
        come nearer.
        """
        centres = np.linspace(max(top, self._north), self._south, count)
        # Sums of many steps have more noise.
        settled = max(_CONVERGED, 1e-15 * math.sqrt(count))
        nearest, stalled, least = math.inf, 0, np.full(count, np.inf)
        # Convergence is faster than geometric, in under 40 passes unless frames almost contain a pole.
        for _ in range(500):
            edges = self._edges(centres)
            steps = np.concatenate([top + centres[:1] - edges.top_v[:1], self._steps(centres, edges)])
            # Over relief, the height of a frame may jump where its row moves by little, so that no position is right.
            if stalled >= _STALLED:
                least = steps = np.minimum(steps, least)
            placed = np.cumsum(steps)
            moved = float(np.max(np.abs(placed - centres)))
            centres = placed
            if moved <= settled:
                edges = self._edges(centres)
                needed = centres[: int(np.searchsorted(edges.bottom_v, self.last_bottom)) + 1]
                if stalled >= _STALLED and not self._are_inside(needed):
                    break
                return centres, edges
            nearest, stalled = (moved, 0) if moved < nearest and stalled < _STALLED else (nearest, stalled + 1)
            if stalled == 2 * _STALLED:
                break
        raise InvalidInput(
            "rows from {0:g} m cannot be placed so near to a pole",
            self._mission.flight.agl_m,
            remedy="fly lower or farther from it",
        )

    def centring_shift(self, count: int, spare: float) -> float:
        """Shift to the north with which rows extend equally beyond the north and the south of the area."""
        if spare <= 0.0:
            return 0.0

        def below(shift: float) -> float:
            return float(self.settle(self.first_top - shift, count)[1].bottom_v[-1]) - self.last_bottom

        guess = min(spare / 2.0, self.first_top)
        unequal = below(guess) - guess
        # One secant step: heights change slowly with latitude, so the rest is of second order.
        shift = guess * spare / (spare - unequal) if unequal < spare else guess
        shift = max(min(shift, self.first_top), min(spare - (1.0 - self.last_bottom), self.first_top), 0.0)
        return shift if below(shift) >= 0.0 else 0.0

    def lean(self, centres: Floats, edges: FrameEdges) -> tuple[Floats, FrameEdges]:
        """Rows, with the last one moved back if it extends beyond the end of the map."""
        if edges.bottom_v[-1] <= 1.0:
            return centres, edges
        inside, outside = 0.5, float(centres[-1])
        while outside - inside > _CONVERGED:
            middle = (inside + outside) / 2.0
            if self._edges(np.array([middle])).bottom_v[0] <= 1.0:
                inside = middle
            else:
                outside = middle
        centres = np.append(centres[:-1], inside)
        return centres, self._edges(centres)


class _Placed(NamedTuple):
    """Captures along rows, arrays (n,) sorted by row: indices, world fractions ``u``, and frame edges from there."""

    row: Numbers
    column: Numbers
    u: Floats
    west: Floats
    east: Floats

    @classmethod
    def joined(cls, parts: list[_Placed]) -> _Placed:
        """Captures of several parts, sorted by row."""
        placed = cls(*(np.concatenate(values) for values in zip(*parts)))
        return placed.take(np.argsort(placed.row, kind="stable"))

    def take(self, which: NDArray[Any]) -> _Placed:
        """Some of the captures, by index or mask."""
        row, column, *places = self
        return _Placed(row[which], column[which], *(values[which] for values in places))

    def take_rows(self, rows: NDArray[np.bool_]) -> _Placed:
        """Captures of some rows, by a mask (r,)."""
        return self.take(rows[self.row])


class _Stretches(NamedTuple):
    """Stretches (r, m) of rows (r,), in world fractions, with the frame edges of captures in them."""

    first_u: Floats
    size_u: Floats
    west: Floats
    east: Floats

    @classmethod
    def measure(
        cls, lat_deg: Floats, first_u: Floats, size_u: Floats, count: int, frames: Frames, relief: Below
    ) -> _Stretches:
        """Stretches of rows, each with frames for the least height above the ground seen from the stretch."""
        u = first_u[:, np.newaxis] + (np.arange(count) + 0.5) * size_u[:, np.newaxis]
        seen = relief.seen_agl_m(np.repeat(lat_deg, count), u_to_lon(u.ravel())).reshape(u.shape)
        seen = np.fmax(seen, relief.least_seen_agl_m(lat_deg)[:, np.newaxis])
        # Frames are almost proportional to height, so a few heights suffice; between two, the smaller ratio holds.
        heights_count = 5
        lowest, ratio = seen.min(axis=1), seen.max(axis=1) / seen.min(axis=1)
        heights = lowest[:, np.newaxis] * ratio[:, np.newaxis] ** np.linspace(0.0, 1.0, heights_count)
        edges = frames(np.repeat(lat_deg, heights_count), heights.ravel())
        with np.errstate(invalid="ignore"):
            above = np.log(seen / lowest[:, np.newaxis]) / np.log(ratio)[:, np.newaxis] * (heights_count - 1)
        at = np.clip(np.nan_to_num(above), 0, heights_count - 2).astype(np.intp)
        west, east = (edge.reshape(heights.shape) / heights for edge in (edges.west_u, edges.east_u))
        west, east = np.maximum(west[:, :-1], west[:, 1:]), np.minimum(east[:, :-1], east[:, 1:])
        return cls(first_u, size_u, *(seen * np.take_along_axis(edge, at, axis=1) for edge in (west, east)))

    def walk(self, west_u: Floats, east_u: Floats, not_shared: float, meeting: float) -> _Placed:
        """Captures from west to east of each row, (r,), as far apart as overlap allows.

        Consecutive frames share ``1 - not_shared`` of both, and ``meeting`` more.
        """
        ahead = np.arange(math.ceil(float(((self.east - self.west).max(axis=1) / self.size_u).max())) + 2)
        count = self.west.shape[1]
        rows = np.arange(len(west_u))
        # Limit of the next frame, and share of its western part that counts.
        limit, share, u = west_u, 1.0, west_u
        found: list[_Placed] = []
        while len(rows):
            first, size = self.first_u[rows, np.newaxis], self.size_u[rows, np.newaxis]
            now = np.floor((u[:, np.newaxis] - first) / size).astype(np.int64)
            at = np.clip(now + ahead, 0, count - 1)
            west = self.west[rows[:, np.newaxis], at]
            farthest = limit[:, np.newaxis] - share * west
            begin = first + at * size
            # The last stretch in which the capture may be.
            best = len(ahead) - 1 - np.argmax((farthest >= begin)[:, ::-1], axis=1)[:, np.newaxis]
            at, farthest, begin = (np.take_along_axis(values, best, axis=1) for values in (at, farthest, begin))
            u = np.minimum(farthest, begin + size)[:, 0]
            west, east = self.west[rows, at[:, 0]], self.east[rows, at[:, 0]]
            found.append(_Placed(rows, np.full(len(rows), len(found)), u, west, east))
            unfinished = u + east < east_u[rows]
            rows, u, share = rows[unfinished], u[unfinished], not_shared
            limit = u + not_shared * east[unfinished] - meeting
        return _Placed.joined(found)


class _ReliefRows(NamedTuple):
    """Captures along rows over relief with vertical views, as far apart as the ground allows."""

    mission: Mission
    frames: Frames
    relief: Below
    meeting: float

    def placed(self, lat_deg: Floats, west_u: Floats, east_u: Floats, least: FrameEdges) -> _Placed:
        """Captures of rows (r,) that cover the ground between world fractions; ``least`` are the smallest frames.

        Raises
        ------
        InvalidInput
            There are more captures than allowed.
        """
        limit = self.mission.output.max_images
        parallel_m = 2.0 * math.pi * WGS84.normal_radius_m(lat_deg) * np.cos(np.radians(lat_deg))
        size, (room, _) = self.relief.merge_distance_m / parallel_m, least.size
        stretches = np.ceil((east_u - west_u + 2.0 * room) / size)
        # Blocks of 2 million stretches bound the memory.
        blocks = np.flatnonzero(np.diff(np.floor(np.cumsum(stretches) / 2_000_000))) + 1
        found, images = [], 0
        for some in np.split(np.arange(len(lat_deg)), blocks):
            west, east = west_u[some], east_u[some]
            row = _Stretches.measure(
                lat_deg[some],
                west - room[some],
                size[some],
                int(stretches[some].max()),
                self.frames,
                self.relief,
            )
            step = 1.0 - self.mission.flight.overlap_along, self.meeting
            placed = row.walk(west, east, *step)
            # Centre the row if that takes no more captures.
            last = np.append(np.diff(placed.row) > 0, True)
            beyond = (placed.u + placed.east)[last] - east
            centred = row.walk(west - np.minimum(beyond / 2.0, room[some]), east, *step)
            better = np.bincount(centred.row) <= np.bincount(placed.row)
            both = placed.take_rows(~better), centred.take_rows(better)
            images += sum(len(part.row) for part in both)
            if images <= limit:
                found += [part._replace(row=some[part.row]) for part in both]
        refuse_too_many(images, limit)
        return _Placed.joined(found)
