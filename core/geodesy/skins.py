"""Textures on triangles: images, and where the corners lie in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..arrays import Flags, Floats, NDArray, Numbers


class Texture(Protocol):
    """An image on triangles; equal ones are the same image."""

    def levels(self) -> Sequence[NDArray[np.uint8]]:
        """Pixels (height, width, 3), and those of ever smaller copies, each of half the size; none if it is lost."""


@dataclass(frozen=True, eq=False)
class Skin:
    """Textures of triangles (n,).

    Parameters
    ----------
    texture : array (n,) of int32
        Index of the texture; -1 without.
    places : array (n, 3, 2)
        Where the corners lie: shares of the image's width and height, from its lower left corner. The image is
        repeated beyond 0 and 1.
    textures : tuple of Texture
    """

    texture: NDArray[np.int32]
    places: Floats
    textures: tuple[Texture, ...]

    def take(self, which: Numbers | Flags) -> Skin:
        """Skin of some triangles, by index or mask."""
        return Skin(self.texture[which], self.places[which], self.textures)

    def colours(self, triangle: Numbers, found: Floats, instead: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Colours (m, 3) at places on triangles, between the four nearest pixels of a copy of about their size.

        Parameters
        ----------
        triangle : array (m,)
        found : array (6, m)
            Places, and by how much they change to the next pixel along columns and along rows.
        instead : array (m, 3)
            Colours where a texture is lost.
        """
        colours = instead.copy()
        used = self.texture[triangle]
        order = np.argsort(used, kind="stable")
        numbers, starts = np.unique(used[order], return_index=True)
        is_once = ((self.places >= 0.0) & (self.places <= 1.0)).all(axis=(1, 2))
        for number, which in zip(numbers.tolist(), np.split(order, starts[1:])):
            levels = self.textures[number].levels()
            if not levels:
                continue
            height, width = levels[0].shape[:2]
            steps = np.hypot(found[2::2, which] * width, found[3::2, which] * height).max(axis=0)
            level = np.clip(np.log2(np.maximum(steps, 1.0)).astype(np.int64), 0, len(levels) - 1)
            for one in np.unique(level).tolist():
                some = which[level == one]
                colours[some] = _between(levels[one], found[0, some], found[1, some], is_once[triangle[some]])
        return colours


def joined_skins(skins: Sequence[Skin | None], counts: Sequence[int]) -> Skin | None:
    """Skins of several numbers of triangles, one after the other; None if none has any."""
    numbers: dict[Texture, int] = {}
    texture, places = [], []
    for skin, count in zip(skins, counts):
        if skin is None:
            texture.append(np.full(count, -1, np.int32))
            places.append(np.zeros((count, 3, 2)))
        else:
            of = [numbers.setdefault(one, len(numbers)) for one in skin.textures]
            # Its last one is for those without.
            texture.append(np.array([*of, -1], np.int32)[skin.texture])
            places.append(skin.places)
    return Skin(np.concatenate(texture), np.concatenate(places), tuple(numbers)) if numbers else None


def _between(pixels: NDArray[np.uint8], u: Floats, v: Floats, is_once: Flags) -> NDArray[np.uint8]:
    """Colours (m, 3) between an image's pixels; beyond its edges those of the edge, or of the other edge."""
    height, width = pixels.shape[:2]
    x, y = u * width - 0.5, (1.0 - v) * height - 0.5
    x, y = np.where(is_once, np.clip(x, 0.0, width - 1.0), x), np.where(is_once, np.clip(y, 0.0, height - 1.0), y)
    left, top = np.floor(x), np.floor(y)
    across, down = (x - left)[:, np.newaxis], (y - top)[:, np.newaxis]
    columns = [((left + k) % width).astype(np.int64) for k in range(2)]
    rows = [((top + k) % height).astype(np.int64) for k in range(2)]
    upper, lower = (pixels[row, columns[0]] * (1.0 - across) + pixels[row, columns[1]] * across for row in rows)
    colours: NDArray[np.uint8] = np.rint(upper * (1.0 - down) + lower * down).astype(np.uint8)
    return colours
