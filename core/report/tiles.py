"""Parts of a source for one map type, fetched once and kept in memory while methods are timed on them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..imagery.source import Part, Source, Window

Pixels = NDArray[np.uint8]


class Tiles:
    """Pixels of a source's parts by window.

    Parameters
    ----------
    source : Source
    map_type : str
    """

    def __init__(self, source: Source, map_type: str) -> None:
        self.source = source
        self.map_type = map_type
        self._pixels: dict[Window, Pixels] = {}

    def __len__(self) -> int:
        return len(self._pixels)

    def of(self, parts: Sequence[Part]) -> dict[Window, Pixels]:
        """Pixels of some parts; those not there yet are fetched.

        Raises
        ------
        PartError, SourceError
            As `Source.fetch` does.
        """
        for part in parts:
            if part.window not in self._pixels:
                self._pixels[part.window] = self.source.fetch(self.map_type, part.window)
        return {part.window: self._pixels[part.window] for part in parts}
