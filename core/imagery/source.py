"""Protocol of a source of imagery; windows of the pixel grid, and the parts of which a window consists."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from ..arrays import NDArray, PixelValues
from ..geodesy.mercator import PixelGrid
from .policy import Policy


class Window(NamedTuple):
    """A rectangle of a source's global pixel grid at a zoom; hashable, so that equal windows are fetched once.

    Left and top are in px from the upper left corner of the grid's plane (on the map, 180° W and 85.0511° N). They are
    whole numbers, except for sources that are requested by centre.
    """

    zoom: int
    left_px: float
    top_px: float
    width_px: int
    height_px: int


class Part(NamedTuple):
    """One request for a picture.

    ``window`` is the area to fetch, with its left edge within the world; ``dx_px, dy_px`` is the position of its upper
    left pixel in the picture (negative if left of or above the picture).
    """

    window: Window
    dx_px: int
    dy_px: int


class Source(Protocol):
    """A source of pixels. Implementations are safe to call from several threads at once."""

    @property
    def name(self) -> str:
        """Name in missions."""

    @property
    def title(self) -> str:
        """Title for people; "Synthetic (offline)" for the embedded world."""

    @property
    def attribution(self) -> str:
        """Credit for the metadata of every picture."""

    @property
    def map_types(self) -> tuple[str, ...]:
        """Available map types; empty if there is a single kind of picture."""

    @property
    def grid(self) -> PixelGrid:
        """Pixel grid."""

    @property
    def policy(self) -> Policy:
        """Terms of the provider."""

    @property
    def date(self) -> str:
        """Date of the imagery as the source writes it, YYYY-MM-DD or YYYY; empty if unknown."""

    def parts(self, window: Window) -> list[Part]:
        """Return the parts that together fill ``window`` exactly."""

    def fetch(self, map_type: str, part: Window) -> PixelValues:
        """Pixels of one part, (height_px, width_px, 3) uint8 red, green and blue, or of the source's `bands`, if any.

        A further channel, if present, is 0 for pixels without imagery and nonzero for others (255 for uint8).

        Raises
        ------
        PartError
            This part is not available: the pictures that need it fail.
        SourceError
            The source refuses all requests: the run stops.
        """

    def close(self) -> None:
        """Release all resources; running requests end at once and raise Cancelled."""


def tile_parts(window: Window, grid: PixelGrid) -> list[Part]:
    """Tiles of ``grid`` that fill a window with whole-number edges, row by row; on the map, columns wrap around.

    The part of a tile in (wrapped) column x and row y begins at ``x * size, y * size``, with ``grid.part_px`` as size.
    """
    size = grid.part_px(window.zoom)
    left, top = int(window.left_px), int(window.top_px)
    return [
        Part(
            Window(window.zoom, grid.wrapped(column, window.zoom) * size, row * size, size, size),
            column * size - left,
            row * size - top,
        )
        for row in range(top // size, (top + window.height_px - 1) // size + 1)
        for column in range(left // size, (left + window.width_px - 1) // size + 1)
    ]


def composite_on_white(colour: NDArray[np.uint8], alpha: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Lay colours over white by their alpha, 0 to 255; the shapes are broadcast."""
    if bool((alpha == 255).all()):
        return colour
    wide_alpha = alpha.astype(np.uint16)
    mixed: NDArray[np.uint8] = ((colour * wide_alpha + 255 * (255 - wide_alpha) + 127) // 255).astype(np.uint8)
    return mixed
