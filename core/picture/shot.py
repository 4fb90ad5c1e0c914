"""Captures to be drawn, and their pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import PixelValues
from ..bands import RGB, Bands, full
from ..geodesy.view import View
from ..imagery.source import Part, Source, Window
from ..mission.plan import Plan
from .camera_frame import parts_of_tiles, render
from .map_frame import assemble, capture_window, turned
from .painting import paint, sun_enu

if TYPE_CHECKING:
    from ..geodesy.raytracing.seen_faces import Painted
    from ..geodesy.raytracing.tracing import Sighting, Tracing


@dataclass(frozen=True, eq=False)
class Shot:
    """A camera frame to be drawn. Over relief, its rays are traced on demand, or by `trace`."""

    plan: Plan
    index: int

    @cached_property
    def _tracing(self) -> Tracing | None:
        """Rays traced over relief; None over level ground."""
        return None if self.plan.relief.is_level else self.plan.views.tracing(self.index)

    @cached_property
    def view(self) -> View:
        """View from which the picture is drawn."""
        views, tracing = self.plan.views, self._tracing
        return views.view(self.index) if tracing is None else views.traced_view(tracing)

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

    @property
    def tiles(self) -> list[tuple[int, int, int]]:
        """Zoom, column (not wrapped) and row of each tile that the picture shows."""
        return self.view.tiles(self.lon_deg)

    @property
    def lon_deg(self) -> float:
        """Longitude of the camera."""
        return float(self.plan.lon_deg[self.index])

    @property
    def kernel(self) -> str:
        """Resampling kernel."""
        return self.plan.mission.accuracy.resampling


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
    """Parts of a source for the picture of one capture."""
    if plan.frames.on_map:
        return source.parts(capture_window(plan, index))
    return parts_of_tiles(plan.grid, Shot(plan, index).tiles)


def draw(
    shot: MapShot | Shot,
    parts: Sequence[Part],
    pixels: Mapping[Window, PixelValues],
    *,
    masked: bool = False,
    bands: Bands = RGB,
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

    Raises
    ------
    PartError
        The parts do not make a whole picture.
    """
    if isinstance(shot, MapShot):
        return Picture(turned(assemble(shot.window, parts, pixels, bands), shot.quarter_turns))
    view = shot.view
    picture = render(view, shot.lon_deg, parts, pixels, shot.kernel, bands)
    if shot.painted is not None:
        paint(picture, shot.painted, sun_enu(shot.plan, shot.index), bands)
    if masked:
        shown = np.ones(picture.shape[:2], bool) if view.hidden is None else ~view.hidden
        picture = np.dstack([picture, shown * full(bands.dtype)])
    return Picture(picture, view.sky_share, view.unmapped_share, view.facade_share)
