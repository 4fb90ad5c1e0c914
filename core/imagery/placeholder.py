"""Images that providers send instead of missing imagery: known images, and files sent for many places."""

from __future__ import annotations

import hashlib
import re
import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Callable, Protocol, runtime_checkable

import numpy as np

from ..arrays import NDArray
from ..errors import InvalidInput, Message
from ..geodesy.mercator import PixelGrid
from .source import Window

#: Reason of pictures that fail with a placeholder.
PLACEHOLDER_REASON = Message("no imagery here: the provider's placeholder image")
#: Digits of a SHA-256 that are enough to identify a file, unless somebody creates a collision.
DIGEST_DIGITS = 16
#: Called with a part and the file that its pixels were decoded from.
Received = Callable[[Window, bytes], object]
#: A part and its file: first bytes of the file's digest, and place of the part.
_PLACE = np.dtype([("digest", ">u8"), ("zoom", "<i4"), ("left", "<f8"), ("top", "<f8"), ("width", "<f8")])
Places = NDArray[np.void]


@dataclass(frozen=True)
class Placeholder:
    """How to recognise a provider's "no imagery" image.

    Parameters
    ----------
    sha256 : tuple of str
        SHA-256 of each of its files, or the first 16 digits or more.
    header : tuple of (name, value) pairs
        Headers of the answer; "*" stands for any value.
    flat_rgb : tuple of (red, green, blue)
        Colours; an image of only one of these colours is no imagery.
    """

    sha256: tuple[str, ...] = ()
    header: tuple[tuple[str, str], ...] = ()
    flat_rgb: tuple[tuple[int, int, int], ...] = ()

    def __post_init__(self) -> None:
        for digest in self.sha256:
            if not re.fullmatch(rf"[0-9a-f]{{{DIGEST_DIGITS},64}}", digest):
                raise InvalidInput(
                    "placeholder {0!r}: must be the SHA-256 of a tile's file, or the first {1} of its digits or more",
                    digest,
                    DIGEST_DIGITS,
                    field="placeholder",
                )

    def extended(self, digests: Iterable[str]) -> Placeholder:
        """Return a copy with the hashes of further files."""
        known = (digest.strip().lower() for digest in digests)
        return replace(self, sha256=tuple(dict.fromkeys((*self.sha256, *known))))

    def knows(self, digest: str) -> bool:
        """Whether a file is a placeholder, by the digest or its first digits."""
        return any(digest.startswith(known) or known.startswith(digest) for known in self.sha256)


@runtime_checkable
class Provided(Protocol):
    """A source whose parts are files from a provider.

    Attributes
    ----------
    placeholder : Placeholder
        The provider's "no imagery" image.
    received : callable or None
        Called with each part fetched from the network or the cache, in the thread that calls `fetch`.
    """

    placeholder: Placeholder
    received: Received | None


class Repeats:
    """Digests and places of the files of a run; safe to use from several threads.

    Results do not depend on the order of files. A place takes 36 bytes.

    Parameters
    ----------
    grid : PixelGrid
        Grid of the source.
    """

    def __init__(self, grid: PixelGrid) -> None:
        self._grid = grid
        self._lock = threading.Lock()
        self._noted = bytearray()

    def note(self, part: Window, file: bytes) -> None:
        """Note the file sent for a part."""
        digest = int.from_bytes(hashlib.sha256(file).digest()[: DIGEST_DIGITS // 2], "big")
        place = np.array((digest, part.zoom, part.left_px, part.top_px, part.width_px), _PLACE).tobytes()
        with self._lock:
            self._noted += place

    def noted(self) -> bytes:
        """Return all notes, sorted, for `add`."""
        with self._lock:
            return np.sort(np.frombuffer(bytes(self._noted), _PLACE)).tobytes()

    def add(self, noted: bytes) -> None:
        """Add the notes of another run; raises ValueError for other data."""
        if len(noted) % _PLACE.itemsize:
            raise ValueError(noted)
        with self._lock:
            self._noted += noted

    def found(self) -> Mapping[str, frozenset[Window]]:
        """Files sent for three or more places that lie far apart.

        Places lie far apart if they are 3.5 widths of a part apart from west to east or from north to south, as nearer
        parts may show one lake; for a narrower run, if they are as far apart as the run extends. Tiles lie whole widths
        apart, so rounding does not matter.

        Returns
        -------
        mapping of str to frozenset of Window
            Maps the first digits of a digest, as for `Placeholder`, to the upper left corners of parts (windows of
            size 0); files with the most places come first.
        """
        least_places = 3
        with self._lock:
            noted = np.frombuffer(bytes(self._noted), _PLACE)
        if len(noted) < least_places:
            return {}
        far = min(3.5, self._span(noted))
        noted = noted[np.argsort(noted["digest"], kind="stable")]
        begins = np.flatnonzero(np.r_[True, noted["digest"][1:] != noted["digest"][:-1]])
        counts = np.diff(np.r_[begins, len(noted)])
        found: dict[str, frozenset[Window]] = {}
        for begin, count in zip(begins[counts >= least_places], counts[counts >= least_places]):
            places = noted[begin : begin + count]
            corners = frozenset(corner(int(zoom), left, top) for _, zoom, left, top, _ in places.tolist())
            # A part that was requested twice counts as one place.
            if len(corners) >= least_places and self._span(places) >= far:
                found[f"{int(places['digest'][0]):0{DIGEST_DIGITS}x}"] = corners
        return dict(sorted(found.items(), key=lambda one: (-len(one[1]), one[0])))

    def _span(self, places: Places) -> float:
        """Greatest distance of places along an axis, in widths of a part, on a map that wraps around."""
        world = np.ldexp(float(self._grid.tile_px), places["zoom"])
        across, down = np.sort(places["left"] / world), places["top"] / world
        gap = np.diff(across, append=across[0] + 1.0).max()
        return float(max(1.0 - gap, np.ptp(down)) / (places["width"] / world).max())


def noted_digests(noted: bytes) -> set[str]:
    """First digits of all digests in the notes of `Repeats.noted`."""
    return {f"{digest:0{DIGEST_DIGITS}x}" for digest in np.frombuffer(noted, _PLACE)["digest"].tolist()}


def corner(zoom: int, left_px: float, top_px: float) -> Window:
    """Corner of a part, as `Repeats.found` returns it."""
    return Window(zoom, left_px, top_px, 0, 0)
