"""What a source of imagery is to the rest of TerrAInav."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats, PixelValues
from ..geodesy.mercator import PixelGrid
from .policy import Policy


class Window(NamedTuple):
    """A rectangle of a source's global pixel grid at a zoom; hashable, so that equal ones are fetched once.

    Left and top count px from the upper left corner of the grid's plane (of the map 180° W and 85.0511° N); they are
    whole but for sources addressed by centre.
    """

    zoom: int
    left_px: float
    top_px: float
    width_px: int
    height_px: int


class Part(NamedTuple):
    """One request's share of a picture.

    ``window`` is what to fetch, its left within the world; ``dx_px, dy_px`` is where its upper-left pixel
    falls in the picture (negative where it starts before the picture does).
    """

    window: Window
    dx_px: int
    dy_px: int


class Source(Protocol):
    """A place pixels come from. Implementations are safe to call from several threads at once."""

    @property
    def name(self) -> str:
        """What a mission names it by."""

    @property
    def title(self) -> str:
        """What people see; "Synthetic (offline)" for the embedded world."""

    @property
    def attribution(self) -> str:
        """Credit that goes into every picture's metadata."""

    @property
    def map_types(self) -> tuple[str, ...]:
        """Map types it can tell apart; empty where it has one kind of picture only."""

    @property
    def grid(self) -> PixelGrid:
        """Its pixels."""

    @property
    def policy(self) -> Policy:
        """What its provider allows."""

    @property
    def date(self) -> str:
        """Date of its imagery as the source writes it, YYYY-MM-DD or YYYY; empty where it is not known."""

    def parts(self, window: Window) -> list[Part]:
        """Return the parts that together fill ``window`` exactly."""

    def fetch(self, map_type: str, part: Window) -> PixelValues:
        """Pixels of one part, (height_px, width_px, 3) uint8: red, green, blue; of a source with `bands`, these.

        One channel more, where there is one, is 0 at pixels without imagery and not 0 elsewhere (255 of uint8).

        Raises
        ------
        PartError
            This part cannot be had: the pictures that need it fail.
        SourceError
            Nothing can be had from this source: the run stops.
        """

    def close(self) -> None:
        """Free what it holds; requests under way end at once and raise Cancelled."""


class Walled(Protocol):
    """A source of imagery and of heights that also has the colours of walls, which no map shows."""

    def walls(
        self, map_type: str, lat_deg: Floats, lon_deg: Floats, east: Floats, north: Floats
    ) -> NDArray[np.float32]:
        """Colours of the walls below roofs, (n, 3); NaN where there are none.

        Parameters
        ----------
        lat_deg, lon_deg : array (n,)
            Places on the roofs, right above the walls.
        east, north : array (n,)
            Which way the walls face, as a unit vector.
        """


def tile_parts(window: Window, grid: PixelGrid) -> list[Part]:
    """Tiles of ``grid`` that fill a whole-numbered window, by rows; columns wrap around the world, where it is the map.

    The part of a tile starts at ``x * tile_px, y * tile_px`` of its wrapped column x and row y.
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


def over_white(colour: NDArray[np.uint8], alpha: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Colours over white by their alpha, 0 to 255; of one shape, or of shapes that go together."""
    if bool((alpha == 255).all()):
        return colour
    whole = alpha.astype(np.uint16)
    mixed: NDArray[np.uint8] = ((colour * whole + 255 * (255 - whole) + 127) // 255).astype(np.uint8)
    return mixed
