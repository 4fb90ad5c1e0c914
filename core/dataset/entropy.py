"""How much there is to see in an image: Shannon entropy of its grey levels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ..errors import InvalidInput


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
    histogram = Image.fromarray(np.ascontiguousarray(image)).convert("L").histogram()
    counts = np.array(histogram, np.float64)
    share = counts[counts > 0.0] / counts.sum()
    # Adding 0 turns the -0 of a single level into 0.
    return float(-np.sum(share * np.log2(share))) + 0.0
