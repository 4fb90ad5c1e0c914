"""Augment images and their labels: rotate, mirror and zoom them, and optionally change contrast and brightness.

The changes of an image follow only from the seed, the epoch and the image's name, not from the order of images, the
number of workers, or the machine. The random numbers are the BLAKE2b digest (RFC 7693) of seed, epoch and name, so no
version of a library can change them. Pixels are the same everywhere, too: coefficients, and so positions of pixels, are
multiples of 2⁻¹⁶, and bilinear values of 8-bit pixels at such positions fit the 53 bits of a double without rounding.

Rotating, mirroring and zooming keep the centre of the image, and so its label, which is the position of the centre on
the ground. They change the yaw and the height. Labels of pixels are changed with the image.
"""

from __future__ import annotations

import hashlib
import math
import struct
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from PIL import Image

from ...arrays import NDArray
from ...errors import InvalidInput

#: Random numbers, one for each quantity of a `Change`, so that leaving out a quantity does not change the others.
_NUMBERS = struct.Struct("<6Q")
_GREYS = 256
#: Most pixels of an image with its reflections: 1.4 GB of Pillow's memory, four times the largest image loaded. A long
#: and narrow image may need far more than its own pixels when it is rotated.
_MOST_PX = 4 * 89_478_485


class Change(NamedTuple):
    """Change applied to one image.

    Attributes
    ----------
    rotation_deg : float
        Counter-clockwise, as seen in the image.
    mirrored, upside_down : bool
        Swap left and right, or top and bottom, after the rotation.
    magnification : float
        Above 1, the image shows less ground, enlarged.
    contrast : float
        Factor by which grey levels' differences from the image's mean are multiplied.
    brightness : float
        Share of the range added to the grey levels.
    """

    rotation_deg: float = 0.0
    mirrored: bool = False
    upside_down: bool = False
    magnification: float = 1.0
    contrast: float = 1.0
    brightness: float = 0.0

    @property
    def moves_pixels(self) -> bool:
        """Whether the image is rotated, mirrored or zoomed."""
        return (self.rotation_deg, self.mirrored, self.upside_down, self.magnification) != (0, False, False, 1)


class _Matrix(NamedTuple):
    """From a position in the result to that in the image, in px with y down, where (0, 0) is the upper left corner."""

    xx: float
    xy: float
    x: float
    yx: float
    yy: float
    y: float

    @classmethod
    def of(cls, change: Change, width: int, height: int) -> _Matrix:
        """Matrix of a change of an image, about its middle."""
        angle = math.radians(change.rotation_deg)
        cosine, sine = math.cos(angle) / change.magnification, math.sin(angle) / change.magnification
        across, down = (-1.0 if change.mirrored else 1.0), (-1.0 if change.upside_down else 1.0)
        # Rounding to multiples of 2^-16 changes positions by 0.003 px at most, 320 px from the centre.
        steps = 65536
        xx, xy, yx, yy = (
            round(one * steps) / steps for one in (cosine * across, -sine * down, sine * across, cosine * down)
        )
        return cls(xx, xy, (width - xx * width - xy * height) / 2.0, yx, yy, (height - yx * width - yy * height) / 2.0)


@dataclass(frozen=True)
class Augmentation:
    """Ranges of random changes; the defaults are those of the paper's program.

    Parameters
    ----------
    rotation_deg : float
        Largest rotation to either side, 0 to 180.
    flip : bool
        Mirror half of the images left to right, and half of them top to bottom.
    zoom : float
        Magnify by factors of 1 / (1 + zoom) to 1 + zoom, as often above as below 1; 0 to 1.
    contrast : float
        Change contrast by factors of 1 - contrast to 1 + contrast; 0 to 1.
    brightness : float
        Raise or lower grey levels by at most this share of their range; 0 to 1.

    Raises
    ------
    InvalidInput
        A value is out of range.
    """

    rotation_deg: float = 90.0
    flip: bool = True
    zoom: float = 0.3
    contrast: float = 0.0
    brightness: float = 0.0

    def __post_init__(self) -> None:
        for name, most in (("rotation_deg", 180.0), ("zoom", 1.0), ("contrast", 1.0), ("brightness", 1.0)):
            value = getattr(self, name)
            if not 0.0 <= value <= most:
                raise InvalidInput("augmentation {0} {1!r}: must be from 0 to {2:g}", name, value, most)

    @property
    def keeps_pose(self) -> bool:
        """Whether images are not rotated, mirrored or zoomed, so that attitude and height stay valid."""
        return not (self.rotation_deg or self.flip or self.zoom)

    def draw_change(self, name: str, seed: int, epoch: int) -> Change:
        """Draw the change of an image in an epoch from seed, epoch and name.

        Parameters
        ----------
        name : str
            Image name without ending, so that images of one place are changed alike in all map types and formats.
        """
        digest = hashlib.blake2b(f"{seed}:{epoch}:{name}".encode(), digest_size=_NUMBERS.size).digest()
        # Numbers from 0 to 1, of the 53 bits of a double's significand.
        turn, mirror, tip, zoom, contrast, light = ((number >> 11) * 2.0**-53 for number in _NUMBERS.unpack(digest))
        return Change(
            self.rotation_deg * (2.0 * turn - 1.0),
            self.flip and mirror < 0.5,
            self.flip and tip < 0.5,
            (1.0 + self.zoom) ** (2.0 * zoom - 1.0),
            1.0 + self.contrast * (2.0 * contrast - 1.0),
            self.brightness * (2.0 * light - 1.0),
        )

    def apply(self, image: Image.Image, name: str, seed: int, epoch: int) -> Image.Image:
        """Draw the change of an image and apply it."""
        return apply_change(image, self.draw_change(name, seed, epoch))


def apply_change(image: Image.Image, change: Change) -> Image.Image:
    """Rotate an image about its centre, mirror, zoom and shade it, keeping its size.

    Beyond the borders, the image continues as its reflection, which repeats the outermost pixels. Pixels are bilinear,
    and Pillow truncates them to whole grey levels: half a level darker on average between pixels.

    Parameters
    ----------
    image : PIL.Image.Image
        8-bit grey or RGB.

    Raises
    ------
    InvalidInput
        The image is too large, or too long and narrow, to be rotated.
    """
    warped = _warp(image, change) if change.moves_pixels else image
    return _shade(warped, change) if (change.contrast, change.brightness) != (1, 0) else warped


def change_labels(labels: NDArray[np.int64], change: Change, beyond: int) -> NDArray[np.int64]:
    """Rotate, mirror and zoom labels (h, w) as `apply_change` does their image, by the nearest rule.

    A pixel has the label in which its centre lies. The image continues beyond its borders as its reflection, of which
    the labels are not known: there they are ``beyond``.
    """
    if not change.moves_pixels:
        return labels
    height, width = labels.shape
    matrix = _Matrix.of(change, width, height)
    x, y = np.arange(width) + 0.5, np.arange(height)[:, np.newaxis] + 0.5
    # Sums of few multiples of 2^-17 are exact.
    column = np.floor(matrix.xx * x + (matrix.xy * y + matrix.x)).astype(np.int64)
    row = np.floor(matrix.yx * x + (matrix.yy * y + matrix.y)).astype(np.int64)
    outside = (column < 0) | (column >= width) | (row < 0) | (row >= height)
    at = np.where(outside, labels.size, row * width + column)
    return np.append(labels, beyond).take(at)


def resize_labels(labels: NDArray[np.int64], height: int, width: int) -> NDArray[np.int64]:
    """Resize labels (h, w) to (height, width): the labels at the centres of the pixels."""
    rows, columns = ((2 * np.arange(new) + 1) * old // (2 * new) for new, old in zip((height, width), labels.shape))
    return labels.take(rows, axis=0).take(columns, axis=1)


def _warp(image: Image.Image, change: Change) -> Image.Image:
    """Rotate, mirror and zoom an image."""
    width, height = image.size
    matrix = _Matrix.of(change, width, height)
    beside = _overhang_px(abs(matrix.xx) * width + abs(matrix.xy) * height, width)
    above = _overhang_px(abs(matrix.yx) * width + abs(matrix.yy) * height, height)
    matrix = matrix._replace(x=beside + matrix.x, y=above + matrix.y)
    return _add_reflections(image, beside, above).transform(image.size, Image.AFFINE, matrix, Image.BILINEAR)


def _overhang_px(seen_px: float, size_px: int) -> int:
    """Number of pixels seen beyond a border, rounded up, and one more for bilinear interpolation."""
    return max(math.ceil((seen_px - size_px) / 2.0), 0) + 1


def _add_reflections(image: Image.Image, beside: int, above: int) -> Image.Image:
    """Extend an image by its reflections: ``beside`` pixels left and right, ``above`` pixels above and below."""
    width, height = image.size
    if (width + 2 * beside) * (height + 2 * above) > _MOST_PX:
        raise InvalidInput(
            "image of {0} x {1} px: augmented, it needs {2} x {3} px with its reflections, which is too much memory",
            width,
            height,
            width + 2 * beside,
            height + 2 * above,
            remedy="take smaller or less narrow images, or do not augment",
        )
    mirrored = image.transpose(Image.FLIP_LEFT_RIGHT)
    copies = (
        (image, mirrored),
        (image.transpose(Image.FLIP_TOP_BOTTOM), mirrored.transpose(Image.FLIP_TOP_BOTTOM)),
    )
    whole = Image.new(image.mode, (width + 2 * beside, height + 2 * above))
    columns, rows = -(-beside // width), -(-above // height)
    for row in range(-rows, rows + 1):
        for column in range(-columns, columns + 1):
            whole.paste(copies[row % 2][column % 2], (beside + column * width, above + row * height))
    return whole


def _shade(image: Image.Image, change: Change) -> Image.Image:
    """Change the contrast of an image about its mean over all channels, and its brightness."""
    counts = image.histogram()
    mean = sum(index % _GREYS * count for index, count in enumerate(counts)) / sum(counts)
    lift = mean + (_GREYS - 1) * change.brightness + 0.5
    table = [min(max(math.floor(lift + change.contrast * (grey - mean)), 0), _GREYS - 1) for grey in range(_GREYS)]
    return image.point(table * len(image.getbands()))
