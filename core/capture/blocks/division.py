"""Divide captures into blocks that share few tiles."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

from ...arrays import Numbers
from ...errors import InvalidInput
from ...geodesy.frames import Windows

#: Most images of a block: the images of a shard are all in memory at once.
MOST_IMAGES = 100_000


def parse_block_size(size: str, image_bytes: Callable[[], float]) -> int:
    """Parse the size of a block, a number of images or megabytes such as ``200MB``, into a number of images.

    Parameters
    ----------
    image_bytes : callable
        Estimates the bytes of an image's files; called only for sizes in megabytes.

    Raises
    ------
    InvalidInput
        The text is not a size, or the size is too large.
    """
    found = re.fullmatch(r"([0-9]{1,15}(?:\.[0-9]{1,15})?)\s*(MB)?", size.strip(), re.IGNORECASE)
    images = 0
    if found is not None and (found[2] or "." not in found[1]):
        images = round(float(found[1]) * 1e6 / image_bytes()) if found[2] else int(found[1])
        images = max(images, 1) if found[2] and float(found[1]) > 0.0 else images
    if not 1 <= images <= MOST_IMAGES:
        raise InvalidInput(
            "block {0!r}: must be 1 to {1:,} images, such as 256, or their size in MB, such as 200MB",
            size,
            MOST_IMAGES,
            field="block",
        )
    return images


def divide(windows: Windows, images: int) -> list[Numbers]:
    """Divide captures into compact blocks of nearly equal size.

    Captures are repeatedly halved by a cut across their longer extent; cuts are short, so blocks share few tiles.

    Parameters
    ----------
    windows : Windows
        Windows (n,) of all captures.
    images : int
        Most images of a block.

    Returns
    -------
    list of array (k,) of int64
        Indices of the captures of each block, ascending; blocks are in the order of the halves.
    """
    left, top, width, height = (np.asarray(values, np.float64) for values in windows)
    # Camera frames that look to the horizon may have no rectangle on the map.
    across = np.nan_to_num(left + width / 2.0)
    down = np.nan_to_num(top + height / 2.0)

    def halves(which: Numbers, blocks: int) -> list[Numbers]:
        if blocks <= 1:
            return [np.sort(which)] if len(which) else []
        x, y = across[which], down[which]
        order = np.lexsort((which, y, x) if np.ptp(x) >= np.ptp(y) else (which, x, y))
        first = blocks // 2
        at = len(which) * first // blocks
        return halves(which[order[:at]], first) + halves(which[order[at:]], blocks - first)

    count = len(left)
    return halves(np.arange(count, dtype=np.int64), -(-count // images))
