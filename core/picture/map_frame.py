"""Map frames out of parts: put together on the source's pixel grid, whole or not at all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import PartError
from ..imagery.source import Part, Window
from ..mission.plan import Plan

Pixels = NDArray[np.uint8]


def window_of(plan: Plan, index: int) -> Window:
    """Window of one capture; its left and top are int where the source's grid is."""
    left, top, width, height = (values[index].item() for values in plan.windows)
    return Window(plan.zoom, left, top, width, height)


def assemble(window: Window, parts: Sequence[Part], pixels: Mapping[Window, Pixels]) -> Pixels:
    """Put parts together to the picture of a window, without resampling.

    Parameters
    ----------
    parts : sequence of Part
        What the source said fills the window.
    pixels : mapping of Window to array (height_px, width_px, 3 or 4) of uint8
        Each part's pixels, as `Source.fetch` gives them.

    Returns
    -------
    array (height_px, width_px, 3) of uint8

    Raises
    ------
    PartError
        A part of another size than it was asked for, or parts that leave a pixel of the window open or without
        imagery.
    """
    height, width = window.height_px, window.width_px
    picture = np.empty((height, width, 3), np.uint8)
    filled = np.zeros((height, width), np.bool_)
    for part in parts:
        image = checked(part.window, pixels[part.window])
        x, y = max(part.dx_px, 0), max(part.dy_px, 0)
        right = min(part.dx_px + part.window.width_px, width)
        bottom = min(part.dy_px + part.window.height_px, height)
        if right <= x or bottom <= y:
            continue
        piece = image[y - part.dy_px : bottom - part.dy_px, x - part.dx_px : right - part.dx_px]
        picture[y:bottom, x:right] = piece[..., :3]
        filled[y:bottom, x:right] = piece[..., 3] != 0 if piece.shape[2] == 4 else True
    if not filled.all():
        raise PartError("no imagery at {0} of the picture's {1} pixels", int((~filled).sum()), filled.size)
    return picture


def checked(window: Window, image: Pixels) -> Pixels:
    """Pixels of a part, as they are; raises PartError where they are of another size than was asked for."""
    wanted = (window.height_px, window.width_px, 3)
    if image.shape not in (wanted, (*wanted[:2], 4)) or image.dtype != np.uint8:
        raise PartError(
            "part at {0}, {1} px has shape {2} of {3}: {4} of uint8 was asked for",
            window.left_px,
            window.top_px,
            image.shape,
            image.dtype,
            wanted,
        )
    return image


def resized(picture: Pixels, img_size: tuple[int, int, int] | None) -> Pixels:
    """Picture at the size and number of channels that are wanted.

    Grey is ITU-R 601 as Pillow's mode "L". Sizes are changed by Lanczos' kernel, which Pillow widens where
    the picture shrinks, so that fine detail is averaged and does not alias.

    Parameters
    ----------
    picture : array (h, w, 3) of uint8
    img_size : tuple (width, height, channels) or None
        Channels 1 (grey) or 3 (colour); None leaves the picture as it is.

    Returns
    -------
    array (height, width) or (height, width, 3) of uint8
    """
    if img_size is None:
        return picture
    width, height, channels = img_size
    from PIL import Image

    image = Image.fromarray(picture)
    if channels == 1:
        image = image.convert("L")
    if image.size != (width, height):
        image = image.resize((width, height), Image.LANCZOS)
    return np.asarray(image)
