"""Textures of a CityJSON file's surfaces, and their colours: those of materials, and mean colours of textures."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from ..arrays import Floats, NDArray
from ..errors import TerrAInavError
from ..imagery.decode import decode, picture_size
from ..limits import MAX_IMAGE_FILE_BYTES, MAX_PICTURE_PX
from ..storage.files import read_limited

Colour = tuple[int, int, int]
Pixels = NDArray[np.uint8]
#: Side of the largest texture that is kept as it is; larger ones are made smaller.
_MOST_SIDE_PX = 4096
#: Places from which they are taken for wrong.
_FARTHEST = 1e6
#: Bytes of textures kept in memory.
_MOST_BYTES = 256 << 20


class _Kept:
    """Pixels of textures, those used last; ever smaller copies of each follow."""

    def __init__(self) -> None:
        self._levels: OrderedDict[ImageTexture, tuple[Pixels, ...]] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()

    def levels(self, texture: ImageTexture) -> tuple[Pixels, ...]:
        """Levels of an image from memory, or read; none if it cannot be read."""
        with self._lock:
            if texture in self._levels:
                self._levels.move_to_end(texture)
                return self._levels[texture]
            made = _read_levels(texture.path)
            self._levels[texture] = made
            self._bytes += sum(one.nbytes for one in made)
            while self._bytes > _MOST_BYTES and len(self._levels) > 1:
                self._bytes -= sum(one.nbytes for one in self._levels.popitem(last=False)[1])
            return made


_KEPT = _Kept()


@dataclass(frozen=True)
class ImageTexture:
    """A `Texture` of an image file, which is read when asked for.

    Parameters
    ----------
    path : str
    changed_ns : int
        When the file was last changed, so that one that changes is another texture.
    """

    path: str
    changed_ns: int

    def levels(self) -> Sequence[Pixels]:
        """Pixels, and those of ever smaller copies; see `Texture`."""
        return _KEPT.levels(self)


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
        #: Textures that surfaces have, by number; None where the image could not be read.
        self.textures: dict[int, ImageTexture | None] = {}
        #: Surfaces whose places in their texture are missing or cannot be read.
        self.unplaced = 0

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

    def texture(
        self, geometry: dict[str, Any], path: tuple[int, ...], rings: Sequence[Sequence[int]]
    ) -> tuple[ImageTexture, dict[int, tuple[float, float]]] | None:
        """Texture of a surface and the places of its vertices in it; None if it has none for all of them."""
        is_unplaced = False
        for theme in _themes(geometry, "texture"):
            values = _at(theme.get("values"), path)
            texture = self._texture(values)
            if texture is None:
                continue
            is_unplaced = True
            places: dict[int, tuple[float, float]] = {}
            for ring, value in zip(rings, values):
                found = self._ring_places(value)
                if found is not None and len(found) == len(ring):
                    places.update(zip(ring, found))
            if all(vertex in places for ring in rings for vertex in ring):
                return texture, places
        self.unplaced += is_unplaced
        return None

    def _texture_colour(self, rings: object) -> Colour | None:
        """Mean colour of the texture within the outer ring of a surface."""
        texture, places = self._texture(rings), self._ring_places(_item(rings, 0))
        if texture is None or places is None or len(places) < 3:
            return None
        u, v = np.array(places).T
        return _mean_within(texture.levels()[0], u, v)

    def _texture(self, rings: object) -> ImageTexture | None:
        """Texture of a surface, by that of its outer ring; None if it has none that can be read."""
        number = _item(_item(rings, 0), 0)
        if not isinstance(number, int) or isinstance(number, bool):
            return None
        if number not in self.textures:
            texture = self._found(number)
            self.textures[number] = texture if texture is not None and texture.levels() else None
        return self.textures[number]

    def _ring_places(self, ring: object) -> list[tuple[float, float]] | None:
        """Places of a ring's vertices in the texture, from its lower left corner; None if some have none."""
        if not isinstance(ring, list):
            return None
        found = []
        for number in ring[1:]:
            place = _item(self._places, number)
            if not isinstance(place, list) or len(place) < 2:
                return None
            u, v = place[:2]
            if not (_is_number(u) and _is_number(v)):
                return None
            found.append((float(u), float(v)))
        return found

    def _found(self, number: int) -> ImageTexture | None:
        """Texture whose image is in the file's folder; None without one."""
        texture = _item(self._textures, number)
        name = texture.get("image") if isinstance(texture, dict) else None
        if not isinstance(name, str) or not name or "\\" in name or ":" in name or not name.isprintable():
            return None
        parts = PurePosixPath(name)
        if parts.is_absolute() or ".." in parts.parts:
            return None
        path = self._folder.absolute() / parts
        try:
            return ImageTexture(str(path), path.stat().st_mtime_ns)
        except OSError:
            return None


def _read_levels(path: str) -> tuple[Pixels, ...]:
    """Pixels of an image, and those of ever smaller copies; none if it cannot be read."""
    try:
        body = read_limited(path, MAX_IMAGE_FILE_BYTES)
        width, height = picture_size(body)
        if width * height > MAX_PICTURE_PX:
            return ()
        picture = Image.fromarray(np.ascontiguousarray(decode(body, width, height)[..., :3]))
    except (OSError, ValueError, TerrAInavError):
        return ()
    levels = []
    while True:
        if max(picture.size) <= _MOST_SIDE_PX:
            levels.append(np.asarray(picture))
            if max(picture.size) == 1:
                return tuple(levels)
        picture = picture.reduce((min(picture.width, 2), min(picture.height, 2)))


def _mean_within(pixels: Pixels, u: Floats, v: Floats) -> Colour:
    """Mean colour of an image within a ring of texture coordinates, from its lower left corner."""
    height, width = pixels.shape[:2]
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


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= _FARTHEST


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
