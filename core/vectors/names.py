"""Layers and fields of vector files as users name them."""

from __future__ import annotations

import re
from typing import NamedTuple

from ..errors import InvalidInput
from ..storage.files import file_exists

_DRIVE = re.compile(r"[A-Za-z]:[\\/]")


class LayerName(NamedTuple):
    """A file, a layer in it, and a field; layer and field are empty if not named."""

    path: str
    layer: str = ""
    field: str = ""


def split_name(text: str) -> tuple[str, list[str]]:
    """Split a name into the longest part that is a file, and what follows it, at most two parts.

    Raises
    ------
    InvalidInput
        There is no such file.
    """
    parts = text.strip().split(":")
    for count in range(len(parts), max(len(parts) - 3, 0), -1):
        path = ":".join(parts[:count])
        if path and file_exists(path):
            return path, parts[count:]
    shown = text[:2] + text[2:].partition(":")[0] if _DRIVE.match(text) else text.partition(":")[0]
    raise InvalidInput("{0}: no such file", shown or text)
