"""Map frames out of parts: put together on the source's pixel grid, whole or not at all, and turned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import PixelValues
from ..bands import RGB, Bands, fitted
from ..errors import InvalidInput, PartError
from ..imagery.source import Part, Window
from ..mission.plan import Plan

_COLOURS = 3


def capture_window(plan: Plan, index: int) -> Window:
    """Window of one capture; its left and top are int where the source's grid is."""
    left, top, width, height = (values[index].item() for values in plan.windows)
    return Window(plan.zoom, left, top, width, height)


def turned(picture: PixelValues, quarter_turns: int) -> PixelValues:
    """Picture of a north-up window (h, w, ...) as a camera sees it whose top points so many quarter turns clockwise.

    No pixel changes its value.
    """
    return np.ascontiguousarray(np.rot90(picture, quarter_turns)) if quarter_turns % 4 else picture


def assemble(
    window: Window, parts: Sequence[Part], pixels: Mapping[Window, PixelValues], bands: Bands = RGB
) -> PixelValues:
    """Put parts together to the picture of a window, without resampling.

    Parameters
    ----------
    parts : sequence of Part
        What the source said fills the window.
    pixels : mapping of Window to array (height_px, width_px, bands or one more)
        Each part's pixels, as `Source.fetch` gives them.
    bands : Bands
        Of the source.

    Returns
    -------
    array (height_px, width_px, bands) of their type

    Raises
    ------
    PartError
        A part of another size than it was asked for, or parts that leave a pixel of the window open or without
        imagery.
    """
    height, width = window.height_px, window.width_px
    count = len(bands)
    picture = np.empty((height, width, count), bands.dtype)
    filled = np.zeros((height, width), np.bool_)
    for part in parts:
        image = checked(part.window, pixels[part.window], bands)
        x, y = max(part.dx_px, 0), max(part.dy_px, 0)
        right = min(part.dx_px + part.window.width_px, width)
        bottom = min(part.dy_px + part.window.height_px, height)
        if right <= x or bottom <= y:
            continue
        piece = image[y - part.dy_px : bottom - part.dy_px, x - part.dx_px : right - part.dx_px]
        picture[y:bottom, x:right] = piece[..., :count]
        filled[y:bottom, x:right] = piece[..., count] != 0 if piece.shape[2] > count else True
    if not filled.all():
        raise PartError("no imagery at {0} of the image's {1} pixels", int((~filled).sum()), filled.size)
    return picture


def checked(window: Window, image: PixelValues, bands: Bands = RGB) -> PixelValues:
    """Pixels of a part, as they are; raises PartError where they are of another size than was asked for."""
    wanted = (window.height_px, window.width_px, len(bands))
    if image.shape not in (wanted, (*wanted[:2], len(bands) + 1)) or image.dtype != bands.dtype:
        raise PartError(
            "part at {0}, {1} px has shape {2} of {3}: {4} of {5} was asked for",
            window.left_px,
            window.top_px,
            image.shape,
            image.dtype,
            wanted,
            bands.data_type,
        )
    return image


def resized(picture: PixelValues, img_size: tuple[int, int, int] | None, bands: Bands = RGB) -> PixelValues:
    """Picture at the size and number of channels that are wanted.

    Grey is ITU-R 601 as Pillow's mode "L". Sizes are changed by Lanczos' kernel, which Pillow widens where
    the picture shrinks, so that fine detail is averaged and does not alias.

    Parameters
    ----------
    picture : array (h, w, bands)
    img_size : tuple (width, height, channels) or None
        Channels 1 (grey) or 3 (colour): of other bands those that are shown as such. None leaves the picture as it is.
    bands : Bands
        Of the picture.

    Returns
    -------
    array (height, width) or (height, width, 3) of the bands' type

    Raises
    ------
    InvalidInput
        Three channels of bands that are shown as grey.
    """
    if img_size is None:
        return picture
    width, height, channels = img_size
    from PIL import Image

    if not (bands.are_colours and len(bands) == _COLOURS):
        return _resized_bands(picture, img_size, bands)
    image = Image.fromarray(picture)
    if channels == 1:
        image = image.convert("L")
    if image.size != (width, height):
        image = image.resize((width, height), Image.LANCZOS)
    return np.asarray(image)


def check_size(img_size: tuple[int, int, int] | None, bands: Bands) -> None:
    """Refuse colours of a picture that has none."""
    if img_size is not None and img_size[2] == _COLOURS and len(bands.shown) < _COLOURS:
        raise InvalidInput(
            "image size {0} {1} {2}: the source has {3}, which make no colours; 1 channel would be right",
            *img_size,
            bands,
            field="img_size",
        )


def _resized_bands(picture: PixelValues, img_size: tuple[int, int, int], bands: Bands) -> PixelValues:
    """Resized as `resized` does, in floats until the end."""
    from PIL import Image

    check_size(img_size, bands)
    width, height, channels = img_size
    shown: NDArray[Any] = picture[..., list(bands.shown)]
    if channels == 1 and len(bands.shown) == _COLOURS:
        # ITU-R 601, in the parts of 65536 that Pillow counts in.
        shown = (shown @ (np.array([19595, 38470, 7471]) / 65536.0))[..., np.newaxis]
    if shown.shape[:2] != (height, width):
        images = (Image.fromarray(np.ascontiguousarray(one, np.float32)) for one in np.moveaxis(shown, 2, 0))
        shown = np.stack([np.asarray(image.resize((width, height), Image.LANCZOS)) for image in images], axis=2)
    sized = fitted(shown, bands.dtype)
    return sized[..., 0] if channels == 1 else sized
