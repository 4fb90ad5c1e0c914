"""Blocks of neighbouring captures whose tiles overlap least."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

from ...arrays import Numbers
from ...errors import InvalidInput
from ...geodesy.frames import Windows

#: Images of one at most: all that its shard holds are in memory together.
MOST_IMAGES = 100_000
_SIZE = re.compile(r"([0-9]{1,15}(?:\.[0-9]{1,15})?)\s*(MB)?", re.IGNORECASE)
_MB = 1e6


def images_of(size: str, image_bytes: Callable[[], float]) -> int:
    """Images of a block of a size that a text states: a number of images, or megabytes as ``200MB``.

    Parameters
    ----------
    image_bytes : callable
        Bytes of one image's files, as far as these can be told beforehand; asked of megabytes alone.

    Raises
    ------
    InvalidInput
        Another text, or a size that is too large.
    """
    found = _SIZE.fullmatch(size.strip())
    images = 0
    if found is not None and (found[2] or "." not in found[1]):
        images = round(float(found[1]) * _MB / image_bytes()) if found[2] else int(found[1])
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
    """Divide captures into blocks of as equal a size as can be, each as compact as its neighbours let it be.

    They are halved across their longer extent again and again: what tiles two blocks share lies along the cut, which is
    as short as a cut can be.

    Parameters
    ----------
    windows : Windows
        Of all captures, (n,).
    images : int
        Of a block at most.

    Returns
    -------
    list of array (k,) of int64
        Indices of each block's captures, ascending; the blocks themselves in the order of a walk from half to half.
    """
    left, top, width, height = (np.asarray(values, np.float64) for values in windows)
    # Camera frames that look to the horizon may stand for no rectangle of the map at all.
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
