"""Colours of a CityJSON file's surfaces: those of its materials, and the mean colours of its textures."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import Any, Union

import numpy as np
from PIL import Image, ImageDraw

from ..arrays import NDArray
from ..errors import TerrAInavError
from ..imagery.decode import decode, picture_size
from ..limits import MAX_IMAGE_FILE_BYTES, MAX_PICTURE_PX
from ..storage.files import read_limited

Colour = tuple[int, int, int]
_Pixels = Union[NDArray[np.uint8], None]


class Appearance:
    """Materials and textures of a file; images are read when a surface has them.

    Parameters
    ----------
    content : object
        The file's ``appearance``.
    folder : Path
        Folder of the file; images outside it are not read.
    """

    def __init__(self, content: object, folder: Path) -> None:
        found: dict[str, Any] = content if isinstance(content, dict) else {}
        names = ("materials", "textures", "vertices-texture")
        self._materials, self._textures, self._places = map(found.get, names)
        self._folder = folder
        #: Textures that surfaces have, by whether their image could be read.
        self.textures: dict[int, bool] = {}
        self._image = lru_cache(maxsize=16)(self._read)

    def colour(self, geometry: dict[str, Any], path: tuple[int, ...]) -> Colour | None:
        """Colour of a surface by its place in a geometry's boundaries: its texture's, else its material's, or None."""
        for theme in _themes(geometry, "texture"):
            found = self._texture_colour(_at(theme.get("values"), path))
            if found is not None:
                return found
        for theme in _themes(geometry, "material"):
            number = theme["value"] if "value" in theme else _at(theme.get("values"), path)
            material = _item(self._materials, number)
            found = _read_rgb(material.get("diffuseColor")) if isinstance(material, dict) else None
            if found is not None:
                return found
        return None

    def _texture_colour(self, rings: object) -> Colour | None:
        """Mean colour of the texture within the outer ring of a surface."""
        ring = _item(rings, 0)
        number = _item(ring, 0)
        if not isinstance(ring, list) or not isinstance(number, int) or isinstance(number, bool):
            return None
        pixels = self._image(number)
        self.textures[number] = pixels is not None
        places = [_item(self._places, one) for one in ring[1:]]
        if pixels is None or len(places) < 3:
            return None
        try:
            u, v = np.array([place[:2] for place in places], np.float64).T
        except (TypeError, ValueError):
            return None
        return _mean_within(pixels, u, v)

    def _read(self, number: int) -> _Pixels:
        """Pixels of a texture's image; None if there is none in the file's folder, or it cannot be read."""
        texture = _item(self._textures, number)
        name = texture.get("image") if isinstance(texture, dict) else None
        if not isinstance(name, str) or not name or "\\" in name or ":" in name or not name.isprintable():
            return None
        parts = PurePosixPath(name)
        if parts.is_absolute() or ".." in parts.parts:
            return None
        try:
            body = read_limited(self._folder / parts, MAX_IMAGE_FILE_BYTES)
            width, height = picture_size(body)
            return decode(body, width, height) if width * height <= MAX_PICTURE_PX else None
        except (OSError, ValueError, TerrAInavError):
            return None


def _mean_within(pixels: NDArray[np.uint8], u: Any, v: Any) -> Colour | None:
    """Mean colour of an image within a ring of texture coordinates, from its lower left corner."""
    height, width = pixels.shape[:2]
    if not (np.isfinite(u).all() and np.isfinite(v).all()):
        return None
    if min(u.min(), v.min()) < 0.0 or max(u.max(), v.max()) > 1.0:
        # The image is repeated.
        mean = pixels[..., :3].reshape(-1, 3).mean(axis=0)
    else:
        x, y = u * width - 0.5, (1.0 - v) * height - 0.5
        left, top = max(math.floor(x.min()), 0), max(math.floor(y.min()), 0)
        part = pixels[top : math.ceil(y.max()) + 1, left : math.ceil(x.max()) + 1, :3]
        mask = Image.new("1", (part.shape[1], part.shape[0]))
        ImageDraw.Draw(mask).polygon(list(zip((x - left).tolist(), (y - top).tolist())), fill=1, outline=1)
        inside = np.asarray(mask)
        mean = (part[inside] if inside.any() else part.reshape(-1, 3)).mean(axis=0)
    red, green, blue = np.rint(mean).astype(int).tolist()
    return red, green, blue


def _read_rgb(value: object) -> Colour | None:
    """Colour of three numbers from 0 to 1."""
    if not isinstance(value, list) or len(value) != 3:
        return None
    if not all(isinstance(one, (int, float)) and 0.0 <= one <= 1.0 for one in value):
        return None
    red, green, blue = (round(255.0 * one) for one in value)
    return red, green, blue


def _themes(geometry: dict[str, Any], name: str) -> list[dict[str, Any]]:
    """Themes of a geometry's materials or textures."""
    themes = geometry.get(name)
    return [one for one in themes.values() if isinstance(one, dict)] if isinstance(themes, dict) else []


def _item(values: object, place: object) -> Any:
    """Value at a place of a list, or None."""
    if not isinstance(values, list) or not isinstance(place, int) or isinstance(place, bool):
        return None
    return values[place] if 0 <= place < len(values) else None


def _at(values: object, path: tuple[int, ...]) -> Any:
    """Value of nested lists."""
    for place in path:
        values = _item(values, place)
    return values
