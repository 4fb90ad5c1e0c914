"""Pictures by which providers say that they have none."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import PartError

if TYPE_CHECKING:
    from .source import Pixels


@dataclass(frozen=True)
class Placeholder:
    """How a provider's picture that says "nothing here" is told from imagery.

    Parameters
    ----------
    sha256 : tuple of str
        Hashes of its files.
    header : tuple of (name, value) pairs
        Header that comes with it; a value of "*" stands for any.
    flat_rgb : tuple of (red, green, blue)
        Colours a picture of nothing else is no imagery in.
    """

    sha256: tuple[str, ...] = ()
    header: tuple[tuple[str, str], ...] = ()
    flat_rgb: tuple[tuple[int, int, int], ...] = ()

    def refuse(self, body: bytes, headers: Mapping[str, str]) -> None:
        """Raise PartError for a body or header that is the placeholder's."""
        for name, value in self.header:
            if name.lower() in headers and value in ("*", headers[name.lower()]):
                raise PartError(f"no imagery here, the provider says ({name}: {headers[name.lower()]})")
        if self.sha256 and hashlib.sha256(body).hexdigest() in self.sha256:
            raise PartError("no imagery here: the provider's placeholder picture")

    def refuse_flat(self, pixels: Pixels) -> None:
        """Raise PartError for a picture of one of the flat colours."""
        for colour in self.flat_rgb:
            if tuple(pixels[0, 0, :3]) == colour and bool((pixels == pixels[0, 0]).all()):
                raise PartError("no imagery here: a picture of one colour, rgb({}, {}, {})".format(*colour))
