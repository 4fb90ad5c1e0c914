"""Captures to be drawn, and their pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import NDArray, PixelValues
from ..bands import RGB, Bands, full
from ..camera.light import bytes_of_linear, linear_of_bytes
from ..geodesy.camera import Camera, Poses
from ..geodesy.view import View
from ..imagery.source import Part, Source, Window
from ..mission.plan import Plan
from ..mission.takes import Timing
from ..waiting import check_cancelled
from .camera_frame import parts_of_tiles, render
from .map_frame import assemble, capture_window, turned
from .painting import lit_colours, paint

if TYPE_CHECKING:
    from ..geodesy.raytracing.seen_faces import Painted
    from ..geodesy.raytracing.tracing import Sighting, Tracing

#: Bytes of views of a picture's instants that are kept until it is drawn; others are made again.
_KEPT_BYTES = 64 << 20


@dataclass(frozen=True, eq=False)
class Take:
    """Rows of a picture at one instant, seen from one pose. Over relief, rays are traced on demand, or by `trace`.

    Attributes
    ----------
    rows : tuple of int, or None
        First row and the one after the last; None for all.
    pose : Poses or None
        The pose; None for that of the capture.
    colour : str
        The colour whose image the lens makes; empty for green, and for all that the lens does not split.
    """

    plan: Plan
    index: int
    rows: tuple[int, int] | None = None
    pose: Poses | None = None
    colour: str = ""

    @cached_property
    def others(self) -> dict[int, Take]:
        """Takes of red and blue by channel, if the lens splits colours."""
        if self.colour or not self.plan.camera(self.index).splits_colours:
            return {}
        return {channel: replace(self, colour=colour) for channel, colour in ((0, "red"), (2, "blue"))}

    @property
    def _camera(self) -> Camera | None:
        """Camera of the colour; None for the capture's own."""
        return self.plan.camera(self.index).of_colour(self.colour) if self.colour else None

    @cached_property
    def _tracing(self) -> Tracing | None:
        """Rays traced over relief; None over level ground."""
        if self.plan.relief.is_level:
            return None
        return self.plan.views.tracing(self.index, rows=self.rows, pose=self.pose, camera=self._camera)

    @cached_property
    def view(self) -> View:
        """View from which the rows are drawn."""
        views, tracing = self.plan.views, self._tracing
        if tracing is None:
            return views.view(self.index, rows=self.rows, pose=self.pose, camera=self._camera)
        return views.traced_view(tracing)

    @cached_property
    def painted(self) -> Painted | None:
        """Pixels that see faces of buildings which the imagery does not show; None if none does."""
        return None if self._tracing is None else self._tracing.painted()

    @cached_property
    def sighting(self) -> Sighting | None:
        """Ground at the pixels, over relief; None over level ground."""
        return None if self._tracing is None else self._tracing.sighting

    def trace(self, *, with_sighting: bool) -> None:
        """Trace the rays, and keep only what the picture needs of them: they take many times its memory."""
        _ = self.view, self.painted
        if with_sighting:
            _ = self.sighting
        self.__dict__.pop("_tracing", None)
        for other in self.others.values():
            other.trace(with_sighting=False)

    @property
    def tiles(self) -> set[tuple[int, int, int]]:
        """Zoom, column (not wrapped) and row of each tile that the rows show."""
        # A picture in motion has hundreds of takes.
        check_cancelled()
        return set(self.view.tiles(self.lon_deg)).union(*(other.tiles for other in self.others.values()))

    def forget(self) -> None:
        """Forget what was traced; it is traced again on demand."""
        for other in self.others.values():
            other.forget()
        for name in ("_tracing", "view", "painted"):
            self.__dict__.pop(name, None)

    @property
    def lon_deg(self) -> float:
        """Longitude of the camera."""
        return float(self.plan.lon_deg[self.index] if self.pose is None else self.pose.lon_deg[0])

    def draw(self, parts: Sequence[Part], pixels: Mapping[Window, PixelValues], bands: Bands) -> PixelValues:
        """Draw the rows, as `camera_frame.render` does."""
        check_cancelled()
        kernel = self.plan.mission.accuracy.resampling
        picture = render(self.view, self.lon_deg, parts, pixels, kernel, bands)
        if self.painted is not None:
            colours = lit_colours(self.plan, self.index, self.painted, float(full(bands.dtype)))
            paint(picture, self.painted, colours, bands)
        for channel, other in self.others.items():
            picture[..., channel] = other.draw(parts, pixels, bands)[..., channel]
        return picture


@dataclass(frozen=True, eq=False)
class Shot:
    """A camera frame to be drawn: takes of its rows, at one instant or several of the exposure."""

    plan: Plan
    index: int

    @cached_property
    def timing(self) -> Timing | None:
        """When the rows are exposed; None if motion does not change the picture."""
        return Timing.of(self.plan, self.index)

    @cached_property
    def instants(self) -> list[list[Take]]:
        """Takes of each instant of the exposure, from the top of the picture to its bottom."""
        if self.timing is None:
            return [[Take(self.plan, self.index)]]
        height = self.plan.views.size_px(self.index)[1]
        return [
            [Take(self.plan, self.index, (top, bottom), pose) for top, bottom, pose in self.timing.strips(height, at_s)]
            for at_s in self.timing.instants_s()
        ]

    @property
    def middle(self) -> list[Take]:
        """Takes of the middle of the exposure, which labels and products show."""
        return self.instants[len(self.instants) // 2]

    @property
    def hidden(self) -> NDArray[np.bool_] | None:
        """Pixels without a picture, for any reason; None if all have one."""
        hidden = [take.view.hidden for take in self.middle]
        if all(one is None for one in hidden):
            return None
        shapes = ((take.view.height_px, take.view.width_px) for take in self.middle)
        masks = [np.zeros(shape, bool) if one is None else one for one, shape in zip(hidden, shapes)]
        return masks[0] if len(masks) == 1 else np.concatenate(masks)

    @property
    def sky_share(self) -> float:
        """Share of the pixels that see no ground."""
        return self._share(lambda view: view.sky_share)

    @property
    def unmapped_share(self) -> float:
        """Share of the pixels whose ground lies beyond Web-Mercator sources."""
        return self._share(lambda view: view.unmapped_share)

    @property
    def facade_share(self) -> float:
        """Share of the pixels that see steep faces, whose colours no map shows."""
        return self._share(lambda view: view.facade_share)

    def _share(self, of_view: Callable[[View], float]) -> float:
        if len(self.middle) == 1:
            return of_view(self.middle[0].view)
        heights = [take.view.height_px for take in self.middle]
        return float(np.average([of_view(take.view) for take in self.middle], weights=heights))

    @cached_property
    def sighting(self) -> Sighting | None:
        """Ground at the pixels, over relief; None over level ground."""
        found = [one for one in (take.sighting for take in self.middle) if one is not None]
        return join_sightings(found) if found else None

    def trace(self, *, with_sighting: bool) -> list[tuple[int, int, int]]:
        """Trace the rays, keep only what the picture needs of them, and return the tiles that it shows.

        What many instants need is traced again when they are drawn, as it would take too much memory.
        """
        tiles: set[tuple[int, int, int]] = set()
        kept_bytes = 0
        for takes in self.instants:
            is_middle = takes is self.middle
            for take in takes:
                take.trace(with_sighting=with_sighting and is_middle)
                tiles.update(take.tiles)
                kept_bytes += take.view.size_bytes
                if kept_bytes > _KEPT_BYTES and not is_middle:
                    take.forget()
        return sorted(tiles)

    @property
    def tiles(self) -> list[tuple[int, int, int]]:
        """Zoom, column (not wrapped) and row of each tile that the picture shows."""
        takes = [take for takes in self.instants for take in takes]
        return sorted(set().union(*(take.tiles for take in takes)))

    @property
    def kernel(self) -> str:
        """Resampling kernel."""
        return self.plan.mission.accuracy.resampling

    def draw(
        self, parts: Sequence[Part], pixels: Mapping[Window, PixelValues], bands: Bands, *, sharp: bool = False
    ) -> PixelValues:
        """Draw the picture: the mean, in linear light, of its instants; if ``sharp``, the middle one alone."""
        if sharp or len(self.instants) == 1:
            return _stacked([take.draw(parts, pixels, bands) for take in self.middle])
        height, width = (int(size) for size in self.plan.views.size_px(self.index)[::-1])
        total, count = np.zeros((height, width, len(bands)), np.float32), np.zeros((height, width, 1), np.float32)
        for takes in self.instants:
            for take in takes:
                rows = slice(*(take.rows or (0, height)))
                total[rows] += linear_of_bytes(take.draw(parts, pixels, bands))
                hidden = take.view.hidden
                count[rows] += 1.0 if hidden is None else ~hidden[..., np.newaxis]
                if takes is not self.middle:
                    take.forget()
        picture = bytes_of_linear(total / np.maximum(count, 1.0))
        if self.hidden is not None:
            picture[self.hidden] = 0
        return picture


def join_sightings(strips: Sequence[Sighting]) -> Sighting:
    """Join the ground at the pixels of strips of a picture."""
    if len(strips) == 1:
        return strips[0]
    return strips[0]._replace(
        **{name: np.concatenate([getattr(one, name) for one in strips]) for name in strips[0]._fields}
    )


def _stacked(strips: list[PixelValues]) -> PixelValues:
    return strips[0] if len(strips) == 1 else np.concatenate(strips)


class MapShot(NamedTuple):
    """A map frame to be drawn: its window, and the clockwise quarter turns of its top from north."""

    window: Window
    quarter_turns: int = 0


class Picture(NamedTuple):
    """Pixels (h, w, bands), with a mask as an extra channel, and the shares of sky, unmapped ground and façades."""

    pixels: PixelValues
    sky_share: float = 0.0
    unmapped_share: float = 0.0
    facade_share: float = 0.0


def make_shot(plan: Plan, index: int) -> MapShot | Shot:
    """Shot of one capture."""
    if plan.frames.on_map:
        return MapShot(capture_window(plan, index), int(plan.frames.quarter_turns[index]))
    return Shot(plan, index)


def picture_parts(plan: Plan, source: Source, index: int) -> list[Part]:
    """Parts of a source for the picture of one capture and its twins."""
    if plan.frames.on_map:
        return source.parts(capture_window(plan, index))
    return parts_of_tiles(plan.grid, shown_tiles(plan, index))


def shown_tiles(plan: Plan, index: int) -> list[tuple[int, int, int]]:
    """Zoom, column (not wrapped) and row of each tile that a camera frame and its twins show."""
    return sorted({tile for one in lens_plans(plan) for tile in Shot(one, index).tiles})


def lens_plans(plan: Plan) -> tuple[Plan, ...]:
    """The plan, and that of undistorted twins if it has them."""
    return (plan, plan.undistorted) if plan.mission.varied.keep_undistorted else (plan,)


def draw(
    shot: MapShot | Shot,
    parts: Sequence[Part],
    pixels: Mapping[Window, PixelValues],
    *,
    masked: bool = False,
    bands: Bands = RGB,
    sharp: bool = False,
) -> Picture:
    """Draw a picture from its parts.

    Parameters
    ----------
    parts : sequence of Part
        From `picture_parts`.
    pixels : mapping of Window to array
        Pixels of each part.
    masked : bool
        Add a mask to a camera frame, 0 where the picture shows nothing.
    bands : Bands
        Bands of the source.
    sharp : bool
        Leave out the blur by the camera's motion.

    Raises
    ------
    PartError
        The parts do not make a whole picture.
    """
    if isinstance(shot, MapShot):
        return Picture(turned(assemble(shot.window, parts, pixels, bands), shot.quarter_turns))
    picture = shot.draw(parts, pixels, bands, sharp=sharp)
    if masked:
        hidden = shot.hidden
        shown = np.ones(picture.shape[:2], bool) if hidden is None else ~hidden
        picture = np.dstack([picture, shown * full(bands.dtype)])
    return Picture(picture, shot.sky_share, shot.unmapped_share, shot.facade_share)
