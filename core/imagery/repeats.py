"""Files that a provider sends for one place after the other, as it does where it has nothing to show.

Photographs of different ground are never the same file, and a placeholder always is. So is open water or snow that a
provider has painted over, which is why what is found here is told, and nothing is left out for it.
"""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..geodesy.mercator import PixelGrid
from .placeholder import DIGEST_DIGITS
from .source import Window

#: Places with the same file that are worth telling of.
_LEAST_PLACES = 3
#: Widths of a part that the farthest of them lie apart at least, from west to east or from north to south: nearer ones
#: may be a pond. Tiles lie whole widths apart, so that no rounding decides. Where all of a run is narrower, they lie as
#: far apart as it is wide.
_FAR_PARTS = 3.5
_DIGEST_BYTES = DIGEST_DIGITS // 2

#: A place and its file: the digest's first bytes, and the part's place.
_PLACE = np.dtype([("digest", ">u8"), ("zoom", "<i4"), ("left", "<f8"), ("top", "<f8"), ("width", "<f8")])

Places = NDArray[np.void]


class Repeats:
    """Digests of the files of a run, each with its place; safe to use from several threads.

    What is found depends on files and places only, not on the order they came in. A place takes 36 bytes.

    Parameters
    ----------
    grid : PixelGrid
        Of the source.
    """

    def __init__(self, grid: PixelGrid) -> None:
        self._grid = grid
        self._lock = threading.Lock()
        self._noted = bytearray()

    def note(self, part: Window, file: bytes) -> None:
        """Note the file that was sent for a part."""
        digest = int.from_bytes(hashlib.sha256(file).digest()[:_DIGEST_BYTES], "big")
        place = np.array((digest, part.zoom, part.left_px, part.top_px, part.width_px), _PLACE).tobytes()
        with self._lock:
            self._noted += place

    def found(self) -> Mapping[str, frozenset[Window]]:
        """Files that came for several places far apart.

        Returns
        -------
        mapping of str to frozenset of Window
            The digest's first digits, as `Placeholder` takes them, to upper-left corners of parts (their sizes are 0);
            files of the most places first.
        """
        with self._lock:
            noted = np.frombuffer(bytes(self._noted), _PLACE)
        if len(noted) < _LEAST_PLACES:
            return {}
        far = min(_FAR_PARTS, self._span(noted))
        noted = noted[np.argsort(noted["digest"], kind="stable")]
        begins = np.flatnonzero(np.r_[True, noted["digest"][1:] != noted["digest"][:-1]])
        counts = np.diff(np.r_[begins, len(noted)])
        found: dict[str, frozenset[Window]] = {}
        for begin, count in zip(begins[counts >= _LEAST_PLACES], counts[counts >= _LEAST_PLACES]):
            places = noted[begin : begin + count]
            corners = frozenset(corner(int(zoom), left, top) for _, zoom, left, top, _ in places.tolist())
            # A part that was asked for twice is one place.
            if len(corners) >= _LEAST_PLACES and self._span(places) >= far:
                found[f"{int(places['digest'][0]):0{DIGEST_DIGITS}x}"] = corners
        return dict(sorted(found.items(), key=lambda one: (-len(one[1]), one[0])))

    def _span(self, places: Places) -> float:
        """How far apart the farthest places lie along an axis, in widths of a part; the map's edges meet."""
        world = np.ldexp(float(self._grid.tile_px), places["zoom"])
        across, down = np.sort(places["left"] / world), places["top"] / world
        gap = np.diff(across, append=across[0] + 1.0).max()
        return float(max(1.0 - gap, np.ptp(down)) / (places["width"] / world).max())


def corner(zoom: int, left_px: float, top_px: float) -> Window:
    """What `Repeats.found` names a part by."""
    return Window(zoom, left_px, top_px, 0, 0)
