"""Map frames: assembled from parts on the source's pixel grid, rotated and resized."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..arrays import NDArray, PixelValues
from ..bands import RGB, Bands, fitted
from ..errors import InvalidInput, PartError
from ..imagery.source import Part, Window
from ..mission.plan import Plan

_COLOURS = 3


def capture_window(plan: Plan, index: int) -> Window:
    """Window of one capture; its left and top are int if the source's grid has whole pixels."""
    left, top, width, height = (values[index].item() for values in plan.windows)
    return Window(plan.zoom, left, top, width, height)


def turned(picture: PixelValues, quarter_turns: int) -> PixelValues:
    """Rotate the picture (h, w, ...) of a north-up window for a camera turned clockwise by quarter turns."""
    return np.ascontiguousarray(np.rot90(picture, quarter_turns)) if quarter_turns % 4 else picture


def assemble(
    window: Window, parts: Sequence[Part], pixels: Mapping[Window, PixelValues], bands: Bands = RGB
) -> PixelValues:
    """Assemble the picture of a window from parts, without resampling.

    Parameters
    ----------
    parts : sequence of Part
        Parts that fill the window, from ``Source.parts``.
    pixels : mapping of Window to array (height_px, width_px, bands or one more)
        Pixels of each part, from `Source.fetch`.
    bands : Bands
        Bands of the source.

    Returns
    -------
    array (height_px, width_px, bands) of the bands' type

    Raises
    ------
    PartError
        A part has a wrong size, or a pixel of the window has no imagery.
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
    """Return the pixels of a part unchanged; raises PartError if their shape or type is wrong."""
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
    """Resize a picture and convert its channels.

    Grey is ITU-R BT.601, as Pillow's mode "L". The kernel is Lanczos, which Pillow widens for smaller sizes so that
    fine detail is averaged and does not alias.

    Parameters
    ----------
    picture : array (h, w, bands)
    img_size : tuple (width, height, channels) or None
        Channels are 1 (grey) or 3 (colour), of the bands that are shown. None leaves the picture unchanged.
    bands : Bands
        Bands of the picture.

    Returns
    -------
    array (height, width) or (height, width, 3) of the bands' type

    Raises
    ------
    InvalidInput
        Three channels are asked for of bands that are shown as grey.
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
    """Raise InvalidInput for three channels of a picture without colours."""
    if img_size is not None and img_size[2] == _COLOURS and len(bands.shown) < _COLOURS:
        raise InvalidInput(
            "image size {0} {1} {2}: the source has {3}, which make no colours; 1 channel would be right",
            *img_size,
            bands,
            field="img_size",
        )


def _resized_bands(picture: PixelValues, img_size: tuple[int, int, int], bands: Bands) -> PixelValues:
    """Resize bands as `resized` does, in floats until the end."""
    from PIL import Image

    check_size(img_size, bands)
    width, height, channels = img_size
    shown: NDArray[Any] = picture[..., list(bands.shown)]
    if channels == 1 and len(bands.shown) == _COLOURS:
        # ITU-R BT.601, with Pillow's weights in 65536ths.
        shown = (shown @ (np.array([19595, 38470, 7471]) / 65536.0))[..., np.newaxis]
    if shown.shape[:2] != (height, width):
        images = (Image.fromarray(np.ascontiguousarray(one, np.float32)) for one in np.moveaxis(shown, 2, 0))
        shown = np.stack([np.asarray(image.resize((width, height), Image.LANCZOS)) for image in images], axis=2)
    sized = fitted(shown, bands.dtype)
    return sized[..., 0] if channels == 1 else sized
