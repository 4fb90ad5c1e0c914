"""Tiles of a source in memory, fetched once, and coarser tiles in place of those that are not there in time."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import suppress
from typing import NamedTuple

import numpy as np
from PIL import Image

from ..arrays import PixelValues
from ..bands import source_bands
from ..errors import TerrAInavError
from ..imagery.source import Part, Source, Window

#: Default bytes of tiles in memory.
MEMORY_BYTES = 256 << 20
#: Most zooms by which a tile may be coarser than the one that it stands in for.
_COARSEST = 6


class ReadyTiles(NamedTuple):
    """Pixels of the parts of a picture.

    Attributes
    ----------
    pixels : dict
        Pixels by window; of a stand-in, those of a coarser tile, enlarged.
    stand_ins : frozenset of Window
        Windows at less than full resolution.
    """

    pixels: dict[Window, PixelValues]
    stand_ins: frozenset[Window] = frozenset()


class TileMemory:
    """Tiles of one map type of a source. Threads may share it.

    Parameters
    ----------
    connections : int
        Tiles fetched at once, at most as many as the provider allows.
    most_bytes : int
        Bytes of tiles that are kept; those used longest ago are dropped.
    """

    def __init__(self, source: Source, map_type: str, connections: int, most_bytes: int = MEMORY_BYTES) -> None:
        self.source, self.map_type = source, map_type
        self._most_bytes, self._bytes = most_bytes, 0
        self._kept: OrderedDict[Window, PixelValues] = OrderedDict()
        self._running: dict[Window, Future[PixelValues]] = {}
        self._lock = threading.Lock()
        self._pool = ThreadPoolExecutor(source.policy.connections(connections), "terrainav-tiles")
        self._is_closed = False

    def whole(self, parts: Sequence[Part]) -> ReadyTiles:
        """Pixels of all parts at full resolution.

        Raises
        ------
        PartError, SourceError
            A part is not available.
        """
        windows = {part.window for part in parts}
        running = self.begin(windows)
        found = {window: future.result() for window, future in running.items()}
        with self._lock:
            known = {window: self._touched(window) for window in windows - set(found)}
        # Tiles may have been dropped since they were found.
        lost = [Part(window, 0, 0) for window, pixels in known.items() if pixels is None]
        if lost:
            found.update(self.whole(lost).pixels)
        return ReadyTiles({**{window: pixels for window, pixels in known.items() if pixels is not None}, **found})

    def until(self, parts: Sequence[Part], wait_s: float) -> ReadyTiles:
        """Pixels of all parts as they are after a wait: at full resolution, from coarser tiles, or black.

        The wait ends as soon as all parts are there. What is missing goes on being fetched.
        """
        windows = {part.window for part in parts}
        running = self.begin(windows)
        if running:
            wait(running.values(), max(wait_s, 0.0))
        found: dict[Window, PixelValues] = {}
        for window, future in running.items():
            with suppress(TerrAInavError):
                if future.done():
                    found[window] = future.result()
        with self._lock:
            for window in windows - set(found):
                pixels = self._touched(window)
                if pixels is not None:
                    found[window] = pixels
            missing = windows - set(found)
            found.update((window, self._stand_in(window)) for window in missing)
        return ReadyTiles(found, frozenset(missing))

    def begin(self, windows: Iterable[Window]) -> dict[Window, Future[PixelValues]]:
        """Fetch windows that are not there yet, without waiting; returns those under way."""
        running = {}
        with self._lock:
            for window in windows:
                if window in self._kept:
                    continue
                if window not in self._running and not self._is_closed:
                    self._running[window] = self._pool.submit(self._fetch, window)
                if window in self._running:
                    running[window] = self._running[window]
        return running

    def close(self) -> None:
        """Stop fetching; the source is not closed."""
        with self._lock:
            self._is_closed = True
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _fetch(self, window: Window) -> PixelValues:
        try:
            pixels = self.source.fetch(self.map_type, window)
        except BaseException:
            with self._lock:
                self._running.pop(window, None)
            raise
        with self._lock:
            self._running.pop(window, None)
            self._kept[window] = pixels
            self._bytes += pixels.nbytes
            while self._bytes > self._most_bytes and len(self._kept) > 1:
                self._bytes -= self._kept.popitem(last=False)[1].nbytes
        return pixels

    def _touched(self, window: Window) -> PixelValues | None:
        """Pixels of a window that is there, which is now the one used last."""
        pixels = self._kept.get(window)
        if pixels is not None:
            self._kept.move_to_end(window)
        return pixels

    def _stand_in(self, window: Window) -> PixelValues:
        """Pixels in place of a tile: those of the finest coarser tile that is there, enlarged, or black."""
        zoom, left, top, width, height = window
        for coarser in range(1, min(_COARSEST, zoom) + 1):
            scale = 1 << coarser
            column, row = int(left // width) // scale, int(top // height) // scale
            pixels = self._kept.get(Window(zoom - coarser, column * width, row * height, width, height))
            if pixels is None or width % scale or height % scale:
                continue
            x, y = left / scale - column * width, top / scale - row * height
            box = (x, y, x + width / scale, y + height / scale)
            return _enlarged(pixels, box, (width, height))
        bands = source_bands(self.source)
        return np.zeros((height, width, len(bands)), bands.dtype)


def _enlarged(pixels: PixelValues, box: tuple[float, float, float, float], size: tuple[int, int]) -> PixelValues:
    """Part of a tile, enlarged to the size of a tile."""
    if pixels.dtype == np.uint8 and pixels.ndim == 3 and pixels.shape[2] in (3, 4):
        return np.asarray(Image.fromarray(pixels).resize(size, Image.Resampling.BILINEAR, box))
    left, top, right, bottom = (round(end) for end in box)
    part = pixels[top:bottom, left:right]
    return part.repeat(size[1] // len(part), axis=0).repeat(size[0] // part.shape[1], axis=1)
