"""Sources in memory with known pixels, which count requests, and wait or fail on demand."""

from __future__ import annotations

import threading
import time
from collections import Counter

import numpy as np
from terrainav.core.errors import PartError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import NamedSource, SourceOptions
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.source import Window, tile_parts

from tests.support.patterns import encode_position


class PatternSource:
    """Tiles whose pixels encode their position on the global pixel grid; every request is counted."""

    name = "pattern"
    title = "Pattern"
    attribution = "© Pattern & Söhne <imagery>"
    policy = Policy()
    date = ""

    def __init__(self, map_types=("satellite", "roadmap", "terrain"), *, tile_px=256, wait_s=0.0):
        self.map_types = map_types
        self.grid = PixelGrid(tile_px=tile_px)
        self.wait_s = wait_s
        self.fetched = Counter()
        self.most_at_once = 0
        self.at_once = 0
        self._lock = threading.Lock()

    def parts(self, window):
        return tile_parts(window, self.grid)

    def fetch(self, map_type, part):
        with self._lock:
            self.fetched[map_type, part] += 1
            self.at_once += 1
            self.most_at_once = max(self.most_at_once, self.at_once)
        try:
            if self.wait_s:
                time.sleep(self.wait_s)
            return self.paint(map_type, part)
        finally:
            with self._lock:
                self.at_once -= 1

    def paint(self, map_type, part):
        return encode_position(
            int(part.left_px) + np.arange(part.width_px),
            int(part.top_px) + np.arange(part.height_px),
            map_type,
        )


class FailingSource(PatternSource):
    """Tiles of which some fail: ``errors`` maps their windows to the errors to raise."""

    def __init__(self, errors: dict[Window, Exception], **options):
        super().__init__(**options)
        self.errors = errors

    def paint(self, map_type, part):
        if part in self.errors:
            raise self.errors[part]
        return super().paint(map_type, part)


class CentredSource(PatternSource):
    """Whole pictures by their centre, as from an image service that rounds positions to six decimals."""

    def __init__(self):
        super().__init__(map_types=())
        self.grid = PixelGrid(max_size_px=640, centre_decimals=6)

    def parts(self, window):
        from terrainav.core.imagery.source import Part

        return [Part(window, 0, 0)]


def missing(reason: str = "no imagery (404)") -> PartError:
    """Error of a tile that does not exist."""
    return PartError(reason)


class NamedPattern(NamedSource):
    """`PatternSource`, or another source of this module, by name: a plain value that other processes can open."""

    def __init__(self, options=SourceOptions(), opens=None, policy=None, **how):  # noqa: B008
        super().__init__("pattern", options)
        self._given = {"_opens": opens or PatternSource, "_policy": policy or Policy(), "_how": how}
        self.__dict__.update(self._given)

    def _described(self):
        return {**self._given, "_given": self._given}

    @property
    def _known(self):
        return self._opens(**self._how)

    @property
    def policy(self):
        return self._policy

    @property
    def grid(self):
        return self._known.grid

    @property
    def date(self):
        return ""

    def open(self):
        source = self._known
        source.close = lambda: None
        return source
