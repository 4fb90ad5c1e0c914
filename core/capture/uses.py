"""The last image, in the order in which images are made, that may need a part."""

from __future__ import annotations

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..geodesy.mercator import PixelGrid
from ..imagery.source import Window

#: Images whose boxes are looked at together.
_CHUNK = 256
#: Pixels of the part's zoom beyond an image's box that its resampling may need.
_RESAMPLED_PX = 8.0


class LastUsers:
    """Last users of parts, by boxes that certainly contain what each image shows.

    Over relief, the parts of an image are known only once its rays are traced, which takes most of its time. Boxes take
    a few rays.

    Parameters
    ----------
    grid : PixelGrid
    boxes : array (n, 4)
        West, north, east and south end of each image, as fractions of the world; infinite where unknown.
    """

    def __init__(self, grid: PixelGrid, boxes: Floats) -> None:
        self._grid, self._boxes = grid, boxes
        first = np.arange(0, len(boxes), _CHUNK)
        lows, highs = np.minimum.reduceat(boxes[:, :2], first), np.maximum.reduceat(boxes[:, 2:], first)
        self._chunks = np.concatenate([lows, highs], axis=1)

    def last_user(self, window: Window) -> int:
        """Return the number of the last image whose box touches a window; -1 if none does."""
        world = self._grid.world_px(window.zoom)
        left, top = (at - _RESAMPLED_PX for at in window[1:3])
        right, bottom = left + window.width_px + 2.0 * _RESAMPLED_PX, top + window.height_px + 2.0 * _RESAMPLED_PX
        sides = left / world, top / world, right / world, bottom / world
        chunks: list[int] = np.flatnonzero(self._touch(self._chunks, *sides)).tolist()
        for chunk in chunks[::-1]:
            found: Numbers = np.flatnonzero(self._touch(self._boxes[chunk * _CHUNK : (chunk + 1) * _CHUNK], *sides))
            if len(found):
                return chunk * _CHUNK + int(found[-1])
        return -1

    def _touch(self, boxes: Floats, west: float, north: float, east: float, south: float) -> Flags:
        """Whether boxes (n, 4) touch a rectangle; on the map, anywhere around the Earth."""
        left, top, right, bottom = boxes.T
        touch = (left <= east) & (right >= west)
        if self._grid.plane.wraps:
            # Offsets from the box's west end, modulo the whole turn.
            with np.errstate(invalid="ignore"):
                touch |= np.mod(west - left, 1.0) <= right - left
                touch |= np.mod(left - west, 1.0) <= east - west
        touching: Flags = touch & (top <= south) & (bottom >= north)
        return touching
