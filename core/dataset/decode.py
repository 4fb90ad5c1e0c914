"""From image files to 8-bit pixels of the size and channels that are asked for."""

from __future__ import annotations

import io
import math
import os
import re
from pathlib import Path

from PIL import Image, UnidentifiedImageError

from ..errors import InvalidInput

#: What Pillow raises for a file that is no whole image, or too large a one.
UNREADABLE = (OSError, ValueError, SyntaxError, Image.DecompressionBombError)
#: Of Pillow's modes, those with eight bits or less: grey, and all that becomes RGB.
_GREY, _COLOUR = (
    ("1", "L", "LA", "La"),
    ("RGB", "RGBA", "RGBa", "RGBX", "P", "PA", "CMYK", "YCbCr", "LAB", "HSV"),
)
#: A JPEG is decoded at half, a quarter or an eighth of its size where that is still so many times the size asked for;
#: with less, the result begins to differ from that of the whole one.
_SPARE = 2
#: A size that is not known.
_UNKNOWN_PX = (math.nan, math.nan)


def open_image(
    path: str | os.PathLike[str],
    img_size: tuple[int, int, int] | None = None,
    said_px: tuple[float, float] = _UNKNOWN_PX,
) -> Image.Image:
    """Image of a file, grey (``L``) or ``RGB``, decoded whole.

    Transparency is dropped: pixels keep the colours that they have below it. Colours become grey by ITU-R BT.601.
    Images are resized with Pillow's bilinear filter, which takes the mean over all pixels that become one.

    Parameters
    ----------
    path : path
        GeoTIFF, JPEG, PNG or another format of Pillow's.
    img_size : tuple (width, height, channels) or None
        In px, and 1 (grey) or 3 (colour); None leaves both as they are.
    said_px : tuple (width, height)
        What the table says of the file, NaN where it says nothing.

    Raises
    ------
    InvalidInput
        A file that cannot be read, is PostScript, has more than eight bits a channel or another size than is said.
    """
    try:
        # From memory: a compressed TIFF's file is closed by libtiff and by Pillow, and the second of them may close
        # what another thread has opened in between.
        with Image.open(io.BytesIO(Path(path).read_bytes())) as image:
            if image.mode not in _GREY + _COLOUR:
                raise InvalidInput(
                    f"image {path}: has pixels of Pillow's mode {image.mode}; 8-bit grey or colour would be right"
                )
            if image.format == "EPS":
                raise InvalidInput(
                    f"image {path}: is PostScript, a program that is not run; an image of pixels would be right"
                )
            _check_size(path, image, said_px)
            if img_size is None:
                return _of_mode(image, "L" if image.mode in _GREY else "RGB")
            width, height, channels = img_size
            mode = "L" if channels == 1 else "RGB"
            image.draft(mode, (_SPARE * width, _SPARE * height))
            found = _of_mode(image, mode)
            return found if found.size == (width, height) else found.resize((width, height), Image.BILINEAR)
    except InvalidInput:
        raise
    except FileNotFoundError as wrong:
        raise InvalidInput(
            f"image {path}: is not there; put it back, or capture it again (--resume)"
        ) from wrong
    except UnidentifiedImageError as wrong:
        raise InvalidInput(f"image {path}: cannot be read (of no format that Pillow knows)") from wrong
    except UNREADABLE as wrong:
        # Of a compressed TIFF's pixels Pillow tells libtiff's number alone.
        what = "its pixels are damaged or cut off" if re.fullmatch(r"-?\d+", str(wrong)) else wrong
        raise InvalidInput(f"image {path}: cannot be read ({what})") from wrong


def _check_size(path: str | os.PathLike[str], image: Image.Image, said_px: tuple[float, float]) -> None:
    if any(said == said and said != size for said, size in zip(said_px, image.size)):
        raise InvalidInput(
            f"image {path}: has {image.width} x {image.height} px, and {said_px[0]:g} x {said_px[1]:g} px in the "
            "table; capture it again, or put the table right"
        )


def _of_mode(image: Image.Image, mode: str) -> Image.Image:
    image.load()
    return image if image.mode == mode else image.convert(mode)
