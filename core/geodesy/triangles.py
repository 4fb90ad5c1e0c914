"""Triangles in the Earth's frame: buildings, and what else stands on the relief with walls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers
from .skins import Skin, joined_skins

#: Kinds of surfaces: the relief itself, and those of buildings.
RELIEF, ROOF, WALL, FLOOR = 0, 1, 2, 3
#: Depth of walls below the lowest ground: coarser levels of the relief differ from the finest.
SKIRT_M = 2.0


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles (n,), seen from both sides.

    Parameters
    ----------
    corners_m : array (n, 3, 3)
        Geocentric coordinates of the corners (WGS 84, EPSG:4978), metres; counter-clockwise seen from outside.
    kind : array (n,) of uint8
        `ROOF`, `WALL` or `FLOOR`, the underside.
    instance : array (n,) of int64
        Number of the building, from 1.
    colour : array (n, 3) of uint8
        Colour, red, green and blue, where no imagery shows the surface.
    shows_imagery : array (n,) of bool
        Whether the imagery shows the surface: roofs with nothing above them.
    skin : Skin or None
        Textures of what no imagery shows; None without any.
    """

    corners_m: Floats
    kind: NDArray[np.uint8]
    instance: Numbers
    colour: NDArray[np.uint8]
    shows_imagery: Flags
    skin: Skin | None = None

    def __len__(self) -> int:
        return len(self.kind)

    def take(self, which: Numbers | Flags) -> Triangles:
        """Triangles of some indices, or where a mask is true."""
        return Triangles(
            self.corners_m[which],
            self.kind[which],
            self.instance[which],
            self.colour[which],
            self.shows_imagery[which],
            None if self.skin is None else self.skin.take(which),
        )

    @classmethod
    def joined(cls, parts: Sequence[Triangles]) -> Triangles:
        """Triangles of several parts, one after the other."""
        some = [part for part in parts if len(part)]
        if len(some) < 2:
            return some[0] if some else NO_TRIANGLES
        return cls(
            np.concatenate([part.corners_m for part in some]),
            np.concatenate([part.kind for part in some]),
            np.concatenate([part.instance for part in some]),
            np.concatenate([part.colour for part in some]),
            np.concatenate([part.shows_imagery for part in some]),
            joined_skins([part.skin for part in some], [len(part) for part in some]),
        )


NO_TRIANGLES = Triangles(
    np.empty((0, 3, 3)),
    np.empty(0, np.uint8),
    np.empty(0, np.int64),
    np.empty((0, 3), np.uint8),
    np.empty(0, np.bool_),
)


class FaceModel(Protocol):
    """Source of triangles that stand on the relief."""

    @property
    def title(self) -> str:
        """Name for users."""

    @property
    def attribution(self) -> str:
        """Credit for the faces."""

    @property
    def count(self) -> int:
        """Greatest number of a building."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """What was repaired, replaced or left out so far, for users."""

    @property
    def listed(self) -> int:
        """Numbers up to this are those of buildings in a file, one each; greater ones are too many to list."""

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:
        """Triangles of all buildings that reach into the bounding box of positions; longitudes are continuous.

        Buildings whose height and width are below ``least_m`` may be left out.
        """


@dataclass(frozen=True)
class _NoFaces:
    """No buildings anywhere, a `FaceModel`."""

    title: str = ""
    attribution: str = ""
    count: int = 0
    warnings: tuple[str, ...] = ()
    listed: int = 0

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:  # noqa: ARG002
        """No triangles."""
        return NO_TRIANGLES


NO_FACES: FaceModel = _NoFaces()
