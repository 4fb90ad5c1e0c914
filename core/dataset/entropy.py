"""How much there is to see in an image: Shannon entropy of its grey levels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..errors import InvalidInput

#: Pixels made grey at a time: more than that no longer fit the processor's cache, and take three times as long.
_BAND_PX = 1 << 19


def entropy(image: NDArray[np.uint8]) -> float:
    """Shannon entropy of the histogram of 256 grey levels, the paper's equation 10.

    Parameters
    ----------
    image : array (h, w) or (h, w, 3) of uint8
        Grey, or RGB that is made grey by ITU-R 601 as Pillow's mode "L" has it.

    Returns
    -------
    float
        Bits, 0 (one level only) to 8 (every level equally often).

    Raises
    ------
    InvalidInput
        For any other shape or type, or an image without pixels.
    """
    grey_or_rgb = image.ndim == 2 or (image.ndim == 3 and image.shape[2] == 3)
    if image.dtype != np.uint8 or not grey_or_rgb or image.size == 0:
        raise InvalidInput(
            f"image of shape {image.shape} and type {image.dtype}: must be (height, width) or (height, width, 3) of "
            "uint8 with at least one pixel"
        )
    grey = Image.fromarray(np.ascontiguousarray(image)) if image.ndim == 2 else _grey(image)
    # Adding 0 turns the -0 of a single level into 0.
    return float(grey.entropy()) + 0.0


def _grey(image: NDArray[np.uint8]) -> Image.Image:
    """Grey image (mode L) of an RGB one (h, w, 3)."""
    height, width = image.shape[:2]
    rows = max(_BAND_PX // width, 1)
    bands = (
        (top, Image.fromarray(np.ascontiguousarray(image[top : top + rows])).convert("L"))
        for top in range(0, height, rows)
    )
    if rows >= height:
        return next(bands)[1]
    grey = Image.new("L", (width, height))
    for top, band in bands:
        grey.paste(band, (0, top))
    return grey
