"""Pictures by which providers say that they have none: known ones, and files that come for many places."""

from __future__ import annotations

import hashlib
import re
import threading
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Callable, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput, Message
from ..geodesy.mercator import PixelGrid
from .source import Window

#: Why a picture fails that needs a placeholder.
PLACEHOLDER_REASON = Message("no imagery here: the provider's placeholder image")
#: Digits of a SHA-256 that name a file as surely as all 64 do, unless somebody makes another for the purpose.
DIGEST_DIGITS = 16
_DIGEST = re.compile(rf"[0-9a-f]{{{DIGEST_DIGITS},64}}")
#: Called with a part and the file that its pixels were read of.
Received = Callable[[Window, bytes], object]
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


@dataclass(frozen=True)
class Placeholder:
    """How a provider's picture that says "nothing here" is told from imagery.

    Parameters
    ----------
    sha256 : tuple of str
        Hashes of its files, or the first 16 digits or more of each.
    header : tuple of (name, value) pairs
        Header that comes with it; a value of "*" stands for any.
    flat_rgb : tuple of (red, green, blue)
        Colours a picture of nothing else is no imagery in.
    """

    sha256: tuple[str, ...] = ()
    header: tuple[tuple[str, str], ...] = ()
    flat_rgb: tuple[tuple[int, int, int], ...] = ()

    def __post_init__(self) -> None:
        for digest in self.sha256:
            if not _DIGEST.fullmatch(digest):
                raise InvalidInput(
                    "placeholder {0!r}: must be the SHA-256 of a tile's file, or the first {1} of its "
                    "digits or more",
                    digest,
                    DIGEST_DIGITS,
                    field="placeholder",
                )

    def with_files(self, digests: Iterable[str]) -> Placeholder:
        """Return one that knows further files by their hashes."""
        known = (digest.strip().lower() for digest in digests)
        return replace(self, sha256=tuple(dict.fromkeys((*self.sha256, *known))))

    def knows(self, digest: str) -> bool:
        """Whether a file is a placeholder, by its hash or the first digits of it."""
        return any(digest.startswith(known) or known.startswith(digest) for known in self.sha256)


@runtime_checkable
class Provided(Protocol):
    """A source whose parts are files of a provider.

    Attributes
    ----------
    placeholder : Placeholder
        What the provider sends where it has nothing.
    received : callable or None
        Called with each part that is fetched, from the network or out of the cache, in the thread that asks.
    """

    placeholder: Placeholder
    received: Received | None


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

    def noted(self) -> bytes:
        """Return all that was noted, in an order of its own, for `add`."""
        with self._lock:
            return np.sort(np.frombuffer(bytes(self._noted), _PLACE)).tobytes()

    def add(self, noted: bytes) -> None:
        """Take what another run has noted; raises ValueError for what no run has."""
        if len(noted) % _PLACE.itemsize:
            raise ValueError(noted)
        with self._lock:
            self._noted += noted

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


def digests_of(noted: bytes) -> set[str]:
    """First digits of the files' digests in what `Repeats.noted` has returned."""
    return {f"{digest:0{DIGEST_DIGITS}x}" for digest in np.frombuffer(noted, _PLACE)["digest"].tolist()}


def corner(zoom: int, left_px: float, top_px: float) -> Window:
    """What `Repeats.found` names a part by."""
    return Window(zoom, left_px, top_px, 0, 0)
