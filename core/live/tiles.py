"""Tiles of a source in memory, fetched once, and coarser tiles in place of those that are not there in time."""

from __future__ import annotations

import heapq
import threading
import time
from collections import OrderedDict
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from itertools import count
from typing import NamedTuple

import numpy as np
from PIL import Image

from ..arrays import PixelValues
from ..bands import full, source_bands
from ..errors import Cancelled
from ..imagery.source import Part, Source, Window

#: Default bytes of tiles in memory.
MEMORY_BYTES = 256 << 20
#: Most zooms by which a tile may be coarser than the one that it stands in for.
_COARSEST = 6
#: Zooms by which tiles fetched to stand in for others are coarser: one of them covers 64.
_STAND_IN_ZOOMS = 3
#: Order in which tiles are fetched: those that a frame waits for, those that are late without them, those ahead.
NEEDED, BY_DEADLINE, AHEAD = range(3)
#: Most tiles that wait without a frame that insists on them.
_MOST_WAITING = 1024
#: Seconds until a tile that failed is fetched again for a frame with a deadline, and most such tiles.
_FAILED_S, _MOST_FAILED = 10.0, 4096


class ReadyTiles(NamedTuple):
    """Pixels of the parts of a picture.

    Attributes
    ----------
    pixels : dict
        Pixels by window; of a stand-in, those of a coarser tile, enlarged.
    stand_ins : frozenset of Window
        Windows at less than full resolution.
    failed : frozenset of Window
        Stand-ins for tiles that the source does not have, or has with holes.
    """

    pixels: dict[Window, PixelValues]
    stand_ins: frozenset[Window] = frozenset()
    failed: frozenset[Window] = frozenset()


class TileMemory:
    """Tiles of one map type of a source. Threads may share it.

    Parameters
    ----------
    connections : int
        Tiles fetched at once, at most as many as the provider allows.
    most_bytes : int
        Bytes of tiles that are kept; those used longest ago are dropped.
    accept_terms : bool
        Whether the user has agreed to the provider's terms.
    """

    def __init__(
        self,
        source: Source,
        map_type: str,
        connections: int,
        most_bytes: int = MEMORY_BYTES,
        *,
        accept_terms: bool = False,
    ) -> None:
        self.source, self.map_type = source, map_type
        self._most_bytes, self._bytes = most_bytes, 0
        self._kept: OrderedDict[Window, PixelValues] = OrderedDict()
        self._running: dict[Window, Future[PixelValues]] = {}
        self._failed: OrderedDict[Window, float] = OrderedDict()
        # Tiles not yet asked for, by their place in the queue; entries of the queue with another place are void.
        self._waiting: dict[Window, tuple[int, int]] = {}
        self._queue: list[tuple[tuple[int, int], Window]] = []
        self._order = count()
        self._lock = threading.Lock()
        self._pool = ThreadPoolExecutor(source.policy.connections(connections), "terrainav-tiles")
        self._accept_terms, self._is_closed = accept_terms, False
        #: Tiles requested since the start.
        self.requested = 0

    def whole(self, parts: Sequence[Part]) -> ReadyTiles:
        """Pixels of all parts at full resolution.

        Raises
        ------
        PartError, SourceError
            A part is not available, or the provider's terms allow no further requests.
        """
        windows = {part.window for part in parts}
        running = self.begin(windows)
        found = {window: future.result() for window, future in running.items()}
        with self._lock:
            known = {window: self._touched(window) for window in windows - set(found)}
        # Tiles may have been dropped since they were found.
        lost = [Part(window, 0, 0) for window, pixels in known.items() if pixels is None]
        if lost and self._is_closed:
            raise Cancelled
        if lost:
            found.update(self.whole(lost).pixels)
        return ReadyTiles({**{window: pixels for window, pixels in known.items() if pixels is not None}, **found})

    def until(self, parts: Sequence[Part], wait_s: float) -> ReadyTiles:
        """Pixels of all parts as they are after a wait: at full resolution, from coarser tiles, or black.

        The wait ends as soon as all parts are there. What is missing goes on being fetched, and before it coarse tiles
        of places that have none. Tiles that fail, and their holes, are stood in for, and asked for again later.

        Raises
        ------
        TermsError
            The provider's terms allow no further requests.
        """
        windows = {part.window for part in parts}
        self.begin(self._bare(windows), NEEDED, again_after_s=_FAILED_S)
        running = self.begin(windows, BY_DEADLINE, again_after_s=_FAILED_S)
        if running:
            wait(running.values(), max(wait_s, 0.0))
        with self._lock:
            known = {window: self._touched(window) for window in windows}
            failed = {window for window in windows if known[window] is None and window in self._failed}
            found = {window: self._stand_in(window) if pixels is None else pixels for window, pixels in known.items()}
        missing = {window for window, pixels in known.items() if pixels is None}
        for window, pixels in found.items():
            filled = self._without_holes(pixels)
            if filled is not pixels:
                found[window] = filled
                missing.add(window)
                failed.add(window)
        return ReadyTiles(found, frozenset(missing), frozenset(failed))

    def begin(
        self, windows: Iterable[Window], urgency: int = NEEDED, *, again_after_s: float = 0.0
    ) -> dict[Window, Future[PixelValues]]:
        """Fetch windows that are not there yet, without waiting; returns those under way.

        Parameters
        ----------
        urgency : int
            NEEDED, BY_DEADLINE or AHEAD.
        again_after_s : float
            Seconds for which tiles that failed are not asked for again.

        Raises
        ------
        TermsError
            The provider's terms allow no further requests.
        """
        running, since_s = {}, time.monotonic() - again_after_s
        with self._lock:
            wanted = [window for window in windows if window not in self._kept]
            new = {one for one in wanted if one not in self._running and self._failed.get(one, -np.inf) <= since_s}
            if self._is_closed:
                new.clear()
            policy = self.source.policy
            policy.check(self.source.title, self.requested + len(new), self._accept_terms)
            self.requested += len(new)
            for window in new:
                self._running[window] = Future()
            for window in wanted:
                if window not in self._running:
                    continue
                running[window] = self._running[window]
                # Of tiles that may come too late, the newest are most likely to be shown.
                order = next(self._order)
                place = urgency, -order if urgency == BY_DEADLINE else order
                if window in new or place < self._waiting.get(window, (-1, 0)):
                    self._waiting[window] = place
                    heapq.heappush(self._queue, (place, window))
            self._leave_oldest()
            for _ in new:
                self._pool.submit(self._fetch_next)
        return running

    def keep_ahead(self, windows: Iterable[Window]) -> None:
        """Fetch tiles that frames will show soon, in place of those that waited as such."""
        with self._lock:
            self._leave([window for window, (urgency, _) in self._waiting.items() if urgency == AHEAD])
        self.begin(windows, AHEAD, again_after_s=_FAILED_S)

    def close(self) -> None:
        """Stop fetching; the source is not closed."""
        with self._lock:
            self._is_closed = True
            self._leave(list(self._waiting))
        self._pool.shutdown(wait=False, cancel_futures=True)

    def _leave_oldest(self) -> None:
        """Leave the least urgent half of the tiles that wait, if they are too many."""
        spare = [(place, window) for window, place in self._waiting.items() if place[0] != NEEDED]
        if len(spare) > _MOST_WAITING:
            self._leave([window for _, window in sorted(spare)[_MOST_WAITING // 2 :]])
        if len(self._queue) > 4 * _MOST_WAITING + 2 * len(self._waiting):
            self._requeue()

    def _leave(self, windows: Sequence[Window]) -> None:
        """Do not fetch tiles that wait."""
        for window in windows:
            del self._waiting[window]
            self.requested -= 1
            self._running.pop(window).set_exception(Cancelled())
        if windows:
            self._requeue()

    def _requeue(self) -> None:
        """Leave void entries out of the queue."""
        self._queue = [(place, window) for window, place in self._waiting.items()]
        heapq.heapify(self._queue)

    def _fetch_next(self) -> None:
        """Fetch the most urgent tile, if any waits."""
        with self._lock:
            while self._queue:
                place, window = heapq.heappop(self._queue)
                if self._waiting.get(window) == place:
                    del self._waiting[window]
                    break
            else:
                return
            future = self._running[window]
        try:
            pixels = self.source.fetch(self.map_type, window)
        except BaseException as wrong:  # noqa: BLE001 (told to those who wait)
            with self._lock:
                del self._running[window]
                self._failed[window] = time.monotonic()
                self._failed.move_to_end(window)
                while len(self._failed) > _MOST_FAILED:
                    self._failed.popitem(last=False)
            future.set_exception(wrong)
            return
        with self._lock:
            del self._running[window]
            self._failed.pop(window, None)
            self._kept[window] = pixels
            self._bytes += pixels.nbytes
            while self._bytes > self._most_bytes and len(self._kept) > 1:
                self._bytes -= self._kept.popitem(last=False)[1].nbytes
        future.set_result(pixels)

    def _bare(self, windows: set[Window]) -> set[Window]:
        """Coarse tiles of places that have none at all."""
        with self._lock:
            bare = [_coarser(one) for one in windows if not any(w in self._kept for w in (one, *_coarser(one)))]
        found = (one for coarser in bare for one in coarser[_STAND_IN_ZOOMS - 1 : _STAND_IN_ZOOMS])
        return {one for one in found if one.zoom >= self.source.grid.min_zoom}

    def _without_holes(self, pixels: PixelValues) -> PixelValues:
        """Pixels with whatever colours a mask hides."""
        bands = source_bands(self.source)
        if pixels.shape[2] == len(bands) or pixels[..., -1].all():
            return pixels
        filled = pixels.copy()
        filled[..., -1] = full(bands.dtype)
        return filled

    def _touched(self, window: Window) -> PixelValues | None:
        """Pixels of a window that is there, which is now the one used last."""
        pixels = self._kept.get(window)
        if pixels is not None:
            self._kept.move_to_end(window)
        return pixels

    def _stand_in(self, window: Window) -> PixelValues:
        """Pixels in place of a tile: those of the finest coarser tile that is there, enlarged, or black."""
        _, left, top, width, height = window
        for coarser in _coarser(window):
            pixels = self._kept.get(coarser)
            if pixels is None:
                continue
            scale = 1 << (window.zoom - coarser.zoom)
            x, y = left / scale - coarser.left_px, top / scale - coarser.top_px
            return _enlarged(pixels, (x, y, x + width / scale, y + height / scale), (width, height))
        bands = source_bands(self.source)
        return np.zeros((height, width, len(bands)), bands.dtype)


def _coarser(window: Window) -> list[Window]:
    """Tiles that may stand in for one, from the finest."""
    zoom, left, top, width, height = window
    found = []
    for coarser in range(1, min(_COARSEST, zoom) + 1):
        scale = 1 << coarser
        if width % scale or height % scale:
            break
        column, row = int(left // width) // scale, int(top // height) // scale
        found.append(Window(zoom - coarser, column * width, row * height, width, height))
    return found


def _enlarged(pixels: PixelValues, box: tuple[float, float, float, float], size: tuple[int, int]) -> PixelValues:
    """Part of a tile, enlarged to the size of a tile."""
    if pixels.dtype == np.uint8 and pixels.ndim == 3 and pixels.shape[2] in (3, 4):
        return np.asarray(Image.fromarray(pixels).resize(size, Image.Resampling.BILINEAR, box))
    left, top, right, bottom = (round(end) for end in box)
    part = pixels[top:bottom, left:right]
    return part.repeat(size[1] // len(part), axis=0).repeat(size[0] // part.shape[1], axis=1)
