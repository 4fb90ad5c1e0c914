"""Pictures by which providers say that they have none."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ..errors import InvalidInput, PartError
from ..text import one_line

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Pixels = NDArray[np.uint8]

#: Why a picture fails that needs a placeholder.
PLACEHOLDER_REASON = "no imagery here: the provider's placeholder picture"
#: Digits of a SHA-256 that name a file as surely as all 64 do, unless somebody makes another for the purpose.
DIGEST_DIGITS = 16
_DIGEST = re.compile(rf"[0-9a-f]{{{DIGEST_DIGITS},64}}")


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
                    f"placeholder {digest!r}: must be the SHA-256 of a tile's file, or the first {DIGEST_DIGITS} "
                    "of its digits or more"
                )

    def with_files(self, digests: Iterable[str]) -> Placeholder:
        """Return one that knows further files by their hashes."""
        known = (digest.strip().lower() for digest in digests)
        return replace(self, sha256=tuple(dict.fromkeys((*self.sha256, *known))))

    def knows(self, digest: str) -> bool:
        """Whether a file is a placeholder by its hash, or the first digits of that."""
        return any(digest.startswith(known) or known.startswith(digest) for known in self.sha256)

    def refuse(self, body: bytes, headers: Mapping[str, str]) -> None:
        """Raise PartError for a body or header that is the placeholder's."""
        for name, value in self.header:
            if name.lower() in headers and value in ("*", headers[name.lower()]):
                raise PartError(
                    f"no imagery here, the provider says ({name}: {one_line(headers[name.lower()])})"
                )
        if self.sha256 and self.knows(hashlib.sha256(body).hexdigest()):
            raise PartError(PLACEHOLDER_REASON)

    def refuse_flat(self, pixels: Pixels) -> None:
        """Raise PartError for a picture of one of the flat colours."""
        for colour in self.flat_rgb:
            if tuple(pixels[0, 0, :3]) == colour and bool((pixels == pixels[0, 0]).all()):
                raise PartError("no imagery here: a picture of one colour, rgb({}, {}, {})".format(*colour))
