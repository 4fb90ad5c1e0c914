"""What the picture of a capture is made from, and the picture itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..bands import RGB, Bands, full
from ..geodesy.view import View
from ..imagery.source import Part, Source, Window
from ..mission.plan import Plan
from .camera_frame import camera_parts, render
from .map_frame import assemble, window_of

Pixels = NDArray[Any]


class Shot(NamedTuple):
    """A camera frame: its view, the longitude of the camera, and the kernel it is resampled with."""

    view: View
    lon_deg: float
    kernel: str


class Picture(NamedTuple):
    """Pixels (h, w, bands), or one channel more with a mask, and the shares of them without ground or without a map."""

    pixels: Pixels
    sky_share: float = 0.0
    unmapped_share: float = 0.0


def shot_of(plan: Plan, index: int) -> Window | Shot:
    """What the picture of one capture is made from: a map frame's window, or a camera frame's view."""
    if plan.size_px is None:
        return window_of(plan, index)
    return Shot(plan.view(index), float(plan.lon_deg[index]), plan.mission.accuracy.resampling)


def parts_of(plan: Plan, source: Source, index: int) -> list[Part]:
    """Parts of a source that the picture of one capture is made of."""
    if plan.size_px is None:
        return source.parts(window_of(plan, index))
    return camera_parts(plan.view(index), float(plan.lon_deg[index]))


def draw(
    shot: Window | Shot,
    parts: Sequence[Part],
    pixels: Mapping[Window, Pixels],
    *,
    masked: bool = False,
    bands: Bands = RGB,
) -> Picture:
    """Make a picture of its parts.

    Parameters
    ----------
    parts : sequence of Part
        As `parts_of` gave them.
    pixels : mapping of Window to array
        Of each part.
    masked : bool
        Add a channel to a camera frame that is 0 where the picture shows nothing.
    bands : Bands
        Of the source.

    Raises
    ------
    PartError
        Where the parts do not make a whole picture.
    """
    if isinstance(shot, Window):
        return Picture(assemble(shot, parts, pixels, bands))
    view = shot.view
    picture = render(view, shot.lon_deg, parts, pixels, shot.kernel, bands)
    if masked:
        shown = np.ones(picture.shape[:2], bool) if view.hidden is None else ~view.hidden
        picture = np.dstack([picture, shown * full(bands.dtype)])
    return Picture(picture, view.sky_share, view.unmapped_share)
