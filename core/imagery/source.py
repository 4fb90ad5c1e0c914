"""The protocol of a source of imagery: windows of its pixel grid, the parts that fill them, their pixels."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats, PixelValues
from ..geodesy.mercator import PixelGrid
from .policy import Policy


class Window(NamedTuple):
    """A rectangle of a source's global pixel grid at a zoom; hashable, so that equal ones are fetched once.

    Left and top are px from the upper left corner of the grid's plane (of the map, 180° W and 85.0511° N); they are
    whole numbers except for sources addressed by centre.
    """

    zoom: int
    left_px: float
    top_px: float
    width_px: int
    height_px: int


class Part(NamedTuple):
    """One request of a picture.

    ``window`` is to be fetched, its left within the world; ``dx_px, dy_px`` is the place of its upper left pixel in the
    picture (negative where it begins before the picture).
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
        """Available map types; empty where there is a single kind of picture."""

    @property
    def grid(self) -> PixelGrid:
        """Pixel grid."""

    @property
    def policy(self) -> Policy:
        """Terms of the provider."""

    @property
    def date(self) -> str:
        """Date of the imagery as the source writes it, YYYY-MM-DD or YYYY; empty where unknown."""

    def parts(self, window: Window) -> list[Part]:
        """Return the parts that together fill ``window`` exactly."""

    def fetch(self, map_type: str, part: Window) -> PixelValues:
        """Pixels of one part, (height_px, width_px, 3) uint8: red, green, blue; of a source with `bands`, those.

        A further channel, where present, is 0 at pixels without imagery and nonzero elsewhere (255 for uint8).

        Raises
        ------
        PartError
            This part is not available: the pictures that need it fail.
        SourceError
            The source refuses all requests: the run stops.
        """

    def close(self) -> None:
        """Release its resources; requests under way end at once and raise Cancelled."""


class Walled(Protocol):
    """A source of imagery and heights that also has the colours of walls, which no map shows."""

    def walls(
        self, map_type: str, lat_deg: Floats, lon_deg: Floats, east: Floats, north: Floats
    ) -> NDArray[np.float32]:
        """Colours of the walls below roofs, (n, 3); NaN without walls.

        Parameters
        ----------
        lat_deg, lon_deg : array (n,)
            Positions on the roofs, directly above the walls.
        east, north : array (n,)
            Unit vector away from the wall.
        """


def tile_parts(window: Window, grid: PixelGrid) -> list[Part]:
    """Tiles of ``grid`` that fill a window of whole numbers, by rows; on the map, columns wrap around the world.

    The part of a tile begins at ``x * tile_px, y * tile_px`` of its wrapped column x and row y.
    """
    size = grid.tile_px
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
    """Colours over white by their alpha, 0 to 255; the shapes broadcast."""
    if bool((alpha == 255).all()):
        return colour
    whole = alpha.astype(np.uint16)
    mixed: NDArray[np.uint8] = ((colour * whole + 255 * (255 - whole) + 127) // 255).astype(np.uint8)
    return mixed
