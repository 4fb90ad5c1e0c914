"""From the bytes of an answer to pixels, or to the reason why they are no picture."""

from __future__ import annotations

import io
import re

import numpy as np
from PIL import GifImagePlugin, ImageFile, JpegImagePlugin, PngImagePlugin, WebPImagePlugin, features

from ..errors import PartError
from .client import BrokenPictureError, first_words
from .source import Pixels

#: What must not follow 0xFF within the entropy-coded data of a JPEG (ITU-T T.81, B.1.1.5), and what may.
#: It begins with one plain byte, which is searched for ten times as fast as ``\xff+`` is.
_JPEG_MARKER = re.compile(rb"\xff\xff*([^\x00\xff\xd0-\xd7])", re.DOTALL)
_JPEG_END, _JPEG_SCAN = 0xD9, 0xDA


def decode(
    body: bytes, width_px: int, height_px: int, content_type: str = "", *, alpha: bool = False
) -> Pixels:
    """Pixels of a PNG, JPEG, WebP or GIF, decoded whole.

    Grey and palettes become RGB, 16 bits become 8. Translucent pixels are laid over white, as browsers do;
    wholly transparent ones are ground without imagery, which a picture of nothing else is refused for.

    Parameters
    ----------
    body : bytes
    width_px, height_px : int
        Size the picture must have; nothing of another size is decoded.
    content_type : str
        What the server calls it; for messages only.
    alpha : bool
        Hand translucent pixels out as they are, and pictures without imagery too.

    Returns
    -------
    array (height_px, width_px, 3 or 4) uint8
        Red, green, blue; a fourth channel tells imagery (255) from none (0) where there are such pixels, or is the
        picture's own alpha where that is asked for.

    Raises
    ------
    PartError
        With the reason alone: who asked knows the part. `BrokenPictureError` where another copy may be whole.
    """
    try:
        image = _open(body, content_type)
        if image.size != (width_px, height_px):
            raise PartError(
                f"a picture of {image.size[0]}x{image.size[1]} px instead of {width_px}x{height_px}"
            )
        image.load()
    except (OSError, SyntaxError, ValueError, EOFError, IndexError, KeyError, OverflowError) as broken:
        raise BrokenPictureError(f"broken picture ({str(broken) or type(broken).__name__})") from broken
    return _rgb(image, alpha)


def _open(body: bytes, content_type: str) -> ImageFile.ImageFile:
    """Picture with its header read, by the reader its first bytes ask for, its integrity checked."""
    # Straight to the readers: Image.open warns of large pictures before their size can be refused here.
    if body.startswith(b"\x89PNG\r\n\x1a\n"):
        # Pillow skips the checksums of the pixels' chunks when it decodes.
        PngImagePlugin.PngImageFile(io.BytesIO(body)).verify()
        return PngImagePlugin.PngImageFile(io.BytesIO(body))
    if body.startswith(b"\xff\xd8\xff"):
        _check_jpeg(body)
        return JpegImagePlugin.JpegImageFile(io.BytesIO(body))
    if body[:4] == b"RIFF" and body[8:12] == b"WEBP":
        if not features.check("webp"):  # type: ignore[no-untyped-call]
            raise PartError("a WebP picture, which this installation of Pillow cannot read")
        return WebPImagePlugin.WebPImageFile(io.BytesIO(body))
    if body[:6] in (b"GIF87a", b"GIF89a"):
        return GifImagePlugin.GifImageFile(io.BytesIO(body))
    if not body:
        raise BrokenPictureError("an empty answer instead of a picture")
    words = first_words(body, content_type)
    kind = content_type.partition(";")[0].strip() or "something"
    if words:
        # It says what it is: that is the provider's answer, and no copy of a picture gone bad.
        raise PartError(f"{kind} instead of a picture: {words}")
    raise BrokenPictureError(f"{kind} instead of a picture")


def _check_jpeg(body: bytes) -> None:
    """Refuse a JPEG whose segments or scans are broken: libjpeg would fill what is missing with grey."""
    at = 2
    while True:
        if body[at : at + 1] != b"\xff":
            raise OSError("JPEG segments out of step")
        while body[at : at + 1] == b"\xff":
            at += 1
        if at >= len(body):
            raise OSError("JPEG broken off")
        marker = body[at]
        at += 1
        if marker == _JPEG_END:
            return
        at += int.from_bytes(body[at : at + 2], "big")
        if marker == _JPEG_SCAN:
            found = _JPEG_MARKER.search(body, at)
            if found is None:
                raise OSError("JPEG broken off")
            at = found.start()


def _rgb(image: ImageFile.ImageFile, alpha: bool) -> Pixels:
    if image.mode.startswith("I"):
        grey = (np.asarray(image, np.int64) >> 8).clip(0, 255).astype(np.uint8)
        return np.repeat(grey[..., np.newaxis], 3, axis=2)
    if image.mode in ("LA", "PA", "La", "RGBA", "RGBa") or "transparency" in image.info:
        rgba = np.asarray(image.convert("RGBA"))
        return rgba if alpha else _over_white(rgba)
    rgb: Pixels = np.asarray(image if image.mode == "RGB" else image.convert("RGB"))
    return rgb


def _over_white(rgba: Pixels) -> Pixels:
    """Colours over white; with a fourth channel, 0 or 255, where some pixels hold no imagery at all."""
    alpha = rgba[..., 3:]
    if not alpha.any():
        raise PartError("no imagery (a transparent picture)")
    colour = np.ascontiguousarray(rgba[..., :3])
    if bool((alpha == 255).all()):
        return colour
    whole = alpha.astype(np.uint16)
    mixed: Pixels = ((colour * whole + 255 * (255 - whole) + 127) // 255).astype(np.uint8)
    if bool(alpha.all()):
        return mixed
    return np.concatenate([mixed, np.where(alpha, np.uint8(255), np.uint8(0))], axis=2)
