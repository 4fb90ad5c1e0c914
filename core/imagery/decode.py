"""Decode the bytes of an answer to pixels, or find the reason why they are not imagery."""

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
from ..text.plain import first_words, one_line
from .http.client import BrokenPictureError
from .http.transport import Response
from .placeholder import PLACEHOLDER_REASON, Placeholder
from .source import composite_on_white

#: Marker that ends the entropy-coded data of a JPEG, in which it cannot occur (ITU-T T.81, B.1.1.5). The pattern begins
#: with a single byte, as ``\xff+`` is ten times as slow, even for long runs of this byte.
_JPEG_MARKER = re.compile(rb"\xff[^\x00\xff\xd0-\xd7]", re.DOTALL)
_JPEG_FILL = re.compile(rb"\xff*")
_JPEG_END, _JPEG_SCAN = 0xD9, 0xDA
#: First byte of an extension, an image and the trailer of a GIF.
_GIF_BLOCK = re.compile(rb"[!,;]")


class WrongSizeError(PartError):
    """A picture has another size than requested; the error's first two values are the picture's width and height."""


def decode(
    body: bytes,
    width_px: int,
    height_px: int,
    content_type: str = "",
    *,
    alpha: bool = False,
    any_size: bool = False,
) -> PixelValues:
    """Pixels of a PNG, JPEG, WebP or GIF, decoded completely.

    Grey and palettes become RGB, 16 bits become 8. Translucent pixels are laid over white, as browsers do. Fully
    transparent pixels have no imagery; a picture without other pixels is refused.

    Parameters
    ----------
    body : bytes
    width_px, height_px : int
        Required size; a picture of another size is not decoded.
    content_type : str
        Type that the server states, used in messages only.
    alpha : bool
        Keep the alpha channel, and accept pictures without imagery.
    any_size : bool
        Resize pictures of up to four times the width and height; each resulting pixel is a mean of source pixels.

    Returns
    -------
    array (height_px, width_px, 3 or 4) uint8
        Red, green, blue; if some pixels have no imagery, also a fourth channel, 0 without and 255 with imagery. With
        ``alpha``, the fourth channel is the alpha channel of the picture.

    Raises
    ------
    PartError
        Names the reason, not the part. `BrokenPictureError` if another copy may be sound, `WrongSizeError` for
        another size.
    """
    larger = 4 if any_size else 1
    # A pixel of four channels of 16 bits has 8 bytes.
    most_bytes = 8 * width_px * height_px * larger**2 + MAX_PICTURE_EXTRA_BYTES
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
    """Raise PartError if the body or a header is a mark of the placeholder."""
    for name, value in placeholder.header:
        if name.lower() in headers and value in ("*", headers[name.lower()]):
            raise PartError("no imagery here, the provider says ({0}: {1})", name, one_line(headers[name.lower()]))
    if placeholder.sha256 and hashlib.sha256(body).hexdigest().startswith(placeholder.sha256):
        raise PartError(PLACEHOLDER_REASON)


def refuse_flat(pixels: PixelValues, placeholder: Placeholder) -> None:
    """Raise PartError for a picture of one of the placeholder's flat colours."""
    for colour in placeholder.flat_rgb:
        if tuple(pixels[0, 0, :3]) == colour and bool((pixels == pixels[0, 0]).all()):
            raise PartError("no imagery here: an image of one colour, rgb({0}, {1}, {2})", *colour)


def picture_size(body: bytes) -> tuple[int, int]:
    """Width and height of a picture, px, from its header; raises PartError without one."""
    try:
        return _open(body, "", whole=False).size
    except PartError:
        raise
    except Exception as broken:
        raise _broken(broken) from broken


def _broken(why: Exception | Message) -> BrokenPictureError:
    """Error of a picture that Pillow cannot decode, by the exception it raised or the reason found here."""
    reason = why if isinstance(why, Message) else one_line(str(why)) or type(why).__name__
    return BrokenPictureError("broken image ({0})", reason)


def _open(body: bytes, content_type: str, *, whole: bool) -> ImageFile.ImageFile:
    """Open a picture with the reader for its first bytes and read its header; check the integrity of a ``whole`` file.

    Comments and other metadata of a JPEG or GIF are removed: Pillow would spend unbounded time and memory on them.
    """
    # Call the readers directly: Image.open warns of large pictures before this module can refuse their size.
    if body.startswith(b"\x89PNG\r\n\x1a\n"):
        if whole:
            # Decoding skips the checksums of the pixels' chunks.
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
    kind = one_line(content_type.partition(";")[0], 60) or "something"
    if words:
        # Text is the provider's answer, not a damaged copy of a picture.
        raise PartError("{0} instead of an image: {1}", kind, words)
    raise BrokenPictureError("{0} instead of an image", kind)


@lru_cache(maxsize=1)
def webp_problem() -> str:
    """Reason why WebP pictures are unsafe to read with this Pillow; empty if they are safe.

    Distributions patch libwebp without a new version number, so only wheels of Pillow are judged by it.
    """
    version = str(features.version("webp") or "")  # type: ignore[no-untyped-call]
    numbers = tuple(int(part) for part in version.split(".") if part.isdigit())
    # 1.3.2 is the first version without CVE-2023-4863, which lets a picture run any code.
    if not _brings_libraries() or numbers >= (1, 3, 2):
        return ""
    return Message("a WebP image, which libwebp {0} would not read safely: install Pillow 10.0.1 or later", version)


def _brings_libraries() -> bool:
    """Whether this Pillow includes the libraries that it uses, as wheels do."""
    package = Path(PIL.__file__).parent
    beside = (package.parent / "pillow.libs", package.parent / "Pillow.libs", package / ".dylibs")
    return sys.platform == "win32" or any(folder.is_dir() for folder in beside)


def _plain_jpeg(body: bytes, *, whole: bool) -> bytes:
    """Remove metadata from a JPEG; refuse broken segments and, in a ``whole`` file, scans cut off.

    libjpeg would fill the missing rest of a scan with grey.
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
        # Before the scans, Pillow reads byte by byte, so count fill bytes there.
        segments += 1 if scans else at - begin - 1
        scans += marker == _JPEG_SCAN
        if segments > MAX_JPEG_SEGMENTS or scans > MAX_JPEG_SCANS:
            raise _broken(Message("JPEG of more than {0} scans or {1} segments", MAX_JPEG_SCANS, MAX_JPEG_SEGMENTS))
        at += int.from_bytes(body[at : at + 2], "big")
        # Comments, and application data except of JFIF and Adobe, do not affect the pixels.
        if not scans and not (0xE1 <= marker <= 0xED or marker in (0xEF, 0xFE)):
            kept.append(body[begin:at])
        if marker == _JPEG_SCAN:
            found = _JPEG_MARKER.search(body, at)
            if found is None:
                raise _broken(Message("JPEG cut off"))
            at = found.start()
    return b"".join(kept)


def _plain_gif(body: bytes) -> bytes:
    """Remove the extensions before a GIF's image, except the transparent colour."""
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
        # The graphic control extension has the transparent colour.
        if body[begin + 1] == 0xF9:
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
    """Resize by means of covered pixels; a result has imagery only if all pixels it covers have."""
    means = np.array(Image.fromarray(pixels).resize((width_px, height_px), Image.Resampling.BOX))
    if means.shape[2] == 4 and not alpha:
        means[..., 3] = np.where(means[..., 3] == 255, 255, 0)
    return means


def _imagery(rgba: PixelValues) -> PixelValues:
    """Lay colours over white; add a fourth channel, 0 or 255, if some pixels have no imagery."""
    alpha = rgba[..., 3:]
    if not alpha.any():
        raise PartError("no imagery (a transparent image)")
    colour = composite_on_white(np.ascontiguousarray(rgba[..., :3]), alpha)
    if bool(alpha.all()):
        return colour
    return np.concatenate([colour, np.where(alpha, np.uint8(255), np.uint8(0))], axis=2)
