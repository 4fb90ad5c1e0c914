"""From the bytes of an answer to pixels, or to the reason why they are no picture."""

from __future__ import annotations

import hashlib
import io
import re
import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np
import PIL
from PIL import GifImagePlugin, Image, ImageFile, JpegImagePlugin, PngImagePlugin, WebPImagePlugin, features

from ..arrays import PixelValues
from ..errors import Message, PartError
from ..limits import MAX_JPEG_SCANS, MAX_JPEG_SEGMENTS, MAX_PICTURE_EXTRA_BYTES
from ..text import first_words, one_line
from .http.client import BrokenPictureError
from .http.transport import Response
from .placeholder import PLACEHOLDER_REASON, Placeholder
from .source import over_white

#: What must not follow 0xFF within the entropy-coded data of a JPEG (ITU-T T.81, B.1.1.5), and what may.
#: It begins with one plain byte, which is searched for ten times as fast as ``\xff+`` is, and which is all that is
#: looked at again where many follow each other.
_JPEG_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]", re.DOTALL)
_JPEG_FILL = re.compile(rb"\xff*")
_JPEG_END, _JPEG_SCAN = 0xD9, 0xDA
#: Segments of a JPEG that do not say what its pixels are: comments, and all of applications but JFIF's and Adobe's.
_JPEG_NOTES = frozenset({*range(0xE1, 0xEE), 0xEF, 0xFE})
#: What begins an extension, a picture and the end of a GIF, and the extension that tells which colour is transparent.
_GIF_BLOCK = re.compile(rb"[!,;]")
_GIF_CONTROL = 0xF9
#: First libwebp without the hole by which a picture may run any code (CVE-2023-4863).
_SOUND_LIBWEBP = (1, 3, 2)
#: How many times as wide as asked for a picture may be that is resized.
_MOST_RESIZED = 4
#: Bytes of a pixel with four channels of 16 bits.
_PIXEL_BYTES = 8
_KIND_CHARACTERS = 60


class WrongSizeError(PartError):
    """A picture of another size than was asked for; its first two values are the width and height that it has."""


def decode(
    body: bytes,
    width_px: int,
    height_px: int,
    content_type: str = "",
    *,
    alpha: bool = False,
    any_size: bool = False,
) -> PixelValues:
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
    any_size : bool
        Resize a picture of another size, up to four times as wide and high: means of the pixels beneath each.

    Returns
    -------
    array (height_px, width_px, 3 or 4) uint8
        Red, green, blue; a fourth channel tells imagery (255) from none (0) where there are such pixels, or is the
        picture's own alpha where that is asked for.

    Raises
    ------
    PartError
        With the reason alone: who asked knows the part. `BrokenPictureError` where another copy may be whole, and
        `WrongSizeError` for what is too large or too small.
    """
    larger = _MOST_RESIZED if any_size else 1
    most_bytes = _PIXEL_BYTES * width_px * height_px * larger**2 + MAX_PICTURE_EXTRA_BYTES
    if len(body) > most_bytes:
        raise PartError(
            "{0:,} bytes, more than the {1:,} of {2}x{3} px at most",
            len(body),
            most_bytes,
            width_px,
            height_px,
        )
    try:
        image = _open(body, content_type, whole=True)
        resized = image.size != (width_px, height_px)
        fits = image.width <= larger * width_px and image.height <= larger * height_px
        if resized and not (any_size and fits):
            raise WrongSizeError(
                "an image of {0}x{1} px instead of {2}x{3}",
                image.size[0],
                image.size[1],
                width_px,
                height_px,
            )
        image.load()
        pixels = _rgb(image, alpha)
        return _resized(pixels, width_px, height_px, alpha) if resized else pixels
    except PartError:
        raise
    except Exception as broken:
        raise _broken(broken) from broken


def read_answer(
    response: Response,
    width_px: int,
    height_px: int,
    placeholder: Placeholder,
    *,
    alpha: bool = False,
    any_size: bool = False,
) -> PixelValues:
    """Pixels of a provider's answer, as `decode` returns them.

    Raises
    ------
    PartError
        As `decode` does, and for the provider's placeholder.
    """
    refuse_marked(response.body, response.headers, placeholder)
    content_type = response.headers.get("content-type", "")
    pixels = decode(response.body, width_px, height_px, content_type, alpha=alpha, any_size=any_size)
    refuse_flat(pixels, placeholder)
    return pixels


def refuse_marked(body: bytes, headers: Mapping[str, str], placeholder: Placeholder) -> None:
    """Raise PartError for a body or header that is the placeholder's."""
    for name, value in placeholder.header:
        if name.lower() in headers and value in ("*", headers[name.lower()]):
            raise PartError(
                "no imagery here, the provider says ({0}: {1})", name, one_line(headers[name.lower()])
            )
    if placeholder.sha256 and hashlib.sha256(body).hexdigest().startswith(placeholder.sha256):
        raise PartError(PLACEHOLDER_REASON)


def refuse_flat(pixels: PixelValues, placeholder: Placeholder) -> None:
    """Raise PartError for a picture of one of the placeholder's flat colours."""
    for colour in placeholder.flat_rgb:
        if tuple(pixels[0, 0, :3]) == colour and bool((pixels == pixels[0, 0]).all()):
            raise PartError("no imagery here: an image of one colour, rgb({0}, {1}, {2})", *colour)


def picture_size(body: bytes) -> tuple[int, int]:
    """Width and height of a picture, px, from its header; raises PartError where it has none."""
    try:
        return _open(body, "", whole=False).size
    except PartError:
        raise
    except Exception as broken:
        raise _broken(broken) from broken


def _broken(why: Exception | Message) -> BrokenPictureError:
    """Failure of what one of Pillow's readers has stumbled over: they let through whatever that is."""
    said = why if isinstance(why, Message) else one_line(str(why)) or type(why).__name__
    return BrokenPictureError("broken image ({0})", said)


def _open(body: bytes, content_type: str, *, whole: bool) -> ImageFile.ImageFile:
    """Picture with its header read, by the reader its first bytes ask for; its integrity checked where it is ``whole``.

    Comments and other notes of a JPEG or GIF are left out: the time and memory they take Pillow has no bounds.
    """
    # Straight to the readers: Image.open warns of large pictures before their size can be refused here.
    if body.startswith(b"\x89PNG\r\n\x1a\n"):
        if whole:
            # Pillow skips the checksums of the pixels' chunks when it decodes.
            PngImagePlugin.PngImageFile(io.BytesIO(body)).verify()
        return PngImagePlugin.PngImageFile(io.BytesIO(body))
    if body.startswith(b"\xff\xd8\xff"):
        return JpegImagePlugin.JpegImageFile(io.BytesIO(_plain_jpeg(body, whole=whole)))
    if body[:4] == b"RIFF" and body[8:12] == b"WEBP":
        if not features.check("webp"):  # type: ignore[no-untyped-call]
            raise PartError("a WebP image, which this installation of Pillow cannot read")
        if problem := webp_problem():
            raise PartError(problem)
        return WebPImagePlugin.WebPImageFile(io.BytesIO(body))
    if body[:6] in (b"GIF87a", b"GIF89a"):
        return GifImagePlugin.GifImageFile(io.BytesIO(_plain_gif(body)))
    if not body:
        raise BrokenPictureError("an empty answer instead of an image")
    words = first_words(body, content_type)
    kind = one_line(content_type.partition(";")[0], _KIND_CHARACTERS) or "something"
    if words:
        # It says what it is: that is the provider's answer, and no copy of a picture gone bad.
        raise PartError("{0} instead of an image: {1}", kind, words)
    raise BrokenPictureError("{0} instead of an image", kind)


@lru_cache(maxsize=1)
def webp_problem() -> str:
    """Why WebP pictures are not safe to read here; empty where they are.

    A distribution mends its own libwebp and leaves the version as it is; what comes inside a wheel of Pillow is as
    old as the wheel.
    """
    version = str(features.version("webp") or "")  # type: ignore[no-untyped-call]
    numbers = tuple(int(part) for part in version.split(".") if part.isdigit())
    if not _brings_libraries() or numbers >= _SOUND_LIBWEBP:
        return ""
    return Message(
        "a WebP image, which libwebp {0} would not read safely: install Pillow 10.0.1 or later", version
    )


def _brings_libraries() -> bool:
    """Whether this Pillow has come with libraries of its own, as its wheels do."""
    package = Path(PIL.__file__).parent
    beside = (package.parent / "pillow.libs", package.parent / "Pillow.libs", package / ".dylibs")
    return sys.platform == "win32" or any(folder.is_dir() for folder in beside)


def _plain_jpeg(body: bytes, *, whole: bool) -> bytes:
    """JPEG without its notes; refused where its segments are broken or, as a whole, its scans are.

    Of scans that break off libjpeg would fill what is missing with grey.
    """
    at, segments, scans = 2, 0, 0
    kept = [body[:at]]
    while True:
        if body[at : at + 1] != b"\xff":
            raise _broken(Message("JPEG segments out of step"))
        begin, at = at, _JPEG_FILL.match(body, at).end()  # type: ignore[union-attr]
        if at >= len(body):
            raise _broken(Message("JPEG cut off"))
        marker = body[at]
        at += 1
        if marker == _JPEG_SCAN and not scans:
            kept.append(body[begin:])
            if not whole:
                break
        if marker == _JPEG_END:
            break
        # Pillow reads the head byte by byte.
        segments += 1 if scans else at - begin - 1
        scans += marker == _JPEG_SCAN
        if segments > MAX_JPEG_SEGMENTS or scans > MAX_JPEG_SCANS:
            raise _broken(
                Message("JPEG of more than {0} scans or {1} segments", MAX_JPEG_SCANS, MAX_JPEG_SEGMENTS)
            )
        at += int.from_bytes(body[at : at + 2], "big")
        if not scans and marker not in _JPEG_NOTES:
            kept.append(body[begin:at])
        if marker == _JPEG_SCAN:
            found = _JPEG_MARKER.search(body, at)
            if found is None:
                raise _broken(Message("JPEG cut off"))
            at = found.start()
    return b"".join(kept)


def _plain_gif(body: bytes) -> bytes:
    """GIF without the notes before its picture."""
    at = 13 + (3 << (body[10] & 7) + 1 if body[10] & 0x80 else 0)
    kept = [body[:at]]
    while found := _GIF_BLOCK.search(body, at):
        begin = at = found.start()
        if found.group() != b"!":
            break
        at += 2
        while size := body[at]:
            at += 1 + size
        at += 1
        if body[begin + 1] == _GIF_CONTROL:
            kept.append(body[begin:at])
    return b"".join([*kept, body[at:]])


def _rgb(image: ImageFile.ImageFile, alpha: bool) -> PixelValues:
    if image.mode.startswith("I"):
        grey = (np.asarray(image, np.int64) >> 8).clip(0, 255).astype(np.uint8)
        return np.repeat(grey[..., np.newaxis], 3, axis=2)
    if image.mode in ("LA", "PA", "La", "RGBA", "RGBa") or "transparency" in image.info:
        rgba = np.asarray(image.convert("RGBA"))
        return rgba if alpha else _imagery(rgba)
    rgb: PixelValues = np.asarray(image if image.mode == "RGB" else image.convert("RGB"))
    return rgb


def _resized(pixels: PixelValues, width_px: int, height_px: int, alpha: bool) -> PixelValues:
    """Means of the pixels beneath each of another size; none where one of them holds no imagery."""
    means = np.array(Image.fromarray(pixels).resize((width_px, height_px), Image.Resampling.BOX))
    if means.shape[2] == 4 and not alpha:
        means[..., 3] = np.where(means[..., 3] == 255, 255, 0)
    return means


def _imagery(rgba: PixelValues) -> PixelValues:
    """Colours over white; with a fourth channel, 0 or 255, where some pixels hold no imagery at all."""
    alpha = rgba[..., 3:]
    if not alpha.any():
        raise PartError("no imagery (a transparent image)")
    colour = over_white(np.ascontiguousarray(rgba[..., :3]), alpha)
    if bool(alpha.all()):
        return colour
    return np.concatenate([colour, np.where(alpha, np.uint8(255), np.uint8(0))], axis=2)
