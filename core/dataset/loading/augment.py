"""Augmentation: images turned, mirrored, zoomed, and where that is asked for with other contrast and brightness.

What is done to an image follows from the seed, the epoch and the image's name alone: never from the order in which
images are taken, the number of workers, or the machine. The random numbers are the digest of those three by BLAKE2b
(RFC 7693), so no version of a library can change them. The pixels are the same everywhere, too. Coefficients are
rounded to multiples of 2⁻¹⁶, as are positions of pixels then, and a bilinear value of 8-bit pixels between them has
less than the 53 bits of a double: nothing is left to be rounded one way here and another way there.

Turning, mirroring and zooming keep the image's centre where it is, between the pixels of an even size, and so keep
the label, which is the position of the centre on the ground. They do not keep north up, nor the height.
"""

from __future__ import annotations

import hashlib
import math
import struct
from dataclasses import dataclass
from typing import NamedTuple

from PIL import Image

from ...errors import InvalidInput

#: Steps of the coefficients in 1 / px: 320 px from the centre they are off by 0.003 px at most.
_STEPS = 65536
#: Bits of a float's significand: as many of 64 random ones are used.
_UNUSED_BITS, _UNIT = 11, 2.0**-53
#: Six numbers, by quantity, so that one that is not asked for leaves the others as they are.
_NUMBERS = struct.Struct("<6Q")
_GREYS = 256
#: Pixels of an image with its reflections: 1.4 GB of Pillow's memory, four times the largest image that is loaded. A
#: long and narrow one that is turned may need far more than it has.
_MOST_PX = 4 * 89_478_485


class Change(NamedTuple):
    """Change applied to one image.

    Attributes
    ----------
    rotation_deg : float
        Counter-clockwise, as one looks at the image.
    mirrored, upside_down : bool
        Left and right, top and bottom changed for each other, after the rotation.
    magnification : float
        Above 1 the image shows less, and that larger.
    contrast : float
        Factor of the grey levels' distances from the image's mean.
    brightness : float
        Share of the range that grey levels are raised by.
    """

    rotation_deg: float = 0.0
    mirrored: bool = False
    upside_down: bool = False
    magnification: float = 1.0
    contrast: float = 1.0
    brightness: float = 0.0


@dataclass(frozen=True)
class Augmentation:
    """How far images may be changed; the defaults are those of the paper's program.

    Parameters
    ----------
    rotation_deg : float
        Most that images are turned to either side, 0 to 180.
    flip : bool
        Mirror every other image left to right, and every other one top to bottom.
    zoom : float
        Images are magnified by factors of 1 / (1 + zoom) to 1 + zoom, as often up as down; 0 to 1.
    contrast : float
        Contrast is changed by factors of 1 - contrast to 1 + contrast; 0 to 1.
    brightness : float
        Grey levels are raised or lowered by this share of their range at most; 0 to 1.

    Raises
    ------
    InvalidInput
        A value outside of its range.
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
        """Whether images are neither turned nor mirrored nor zoomed, so that attitude and height hold for them."""
        return not (self.rotation_deg or self.flip or self.zoom)

    def draw_change(self, name: str, seed: int, epoch: int) -> Change:
        """Return the change of an image in an epoch, drawn from seed, epoch and name.

        Parameters
        ----------
        name : str
            The image's, without ending: the images of one place are changed alike in all map types and formats.
        """
        digest = hashlib.blake2b(f"{seed}:{epoch}:{name}".encode(), digest_size=_NUMBERS.size).digest()
        turn, mirror, tip, zoom, contrast, light = (
            (number >> _UNUSED_BITS) * _UNIT for number in _NUMBERS.unpack(digest)
        )
        return Change(
            self.rotation_deg * (2.0 * turn - 1.0),
            self.flip and mirror < 0.5,
            self.flip and tip < 0.5,
            (1.0 + self.zoom) ** (2.0 * zoom - 1.0),
            1.0 + self.contrast * (2.0 * contrast - 1.0),
            self.brightness * (2.0 * light - 1.0),
        )

    def applied(self, image: Image.Image, name: str, seed: int, epoch: int) -> Image.Image:
        """Return an image as `apply_change` makes it by `draw_change`."""
        return apply_change(image, self.draw_change(name, seed, epoch))


def apply_change(image: Image.Image, change: Change) -> Image.Image:
    """Return an image of the same size that is turned, mirrored, zoomed and shaded.

    The rotation is about the image's centre. Beyond the borders the image goes on as its reflection, in which the
    outermost pixels come twice. Pixels are bilinear, and cut to whole grey levels as Pillow does: half a level darker
    in the mean where they fall between others.

    Parameters
    ----------
    image : PIL.Image.Image
        8-bit grey or RGB.

    Raises
    ------
    InvalidInput
        An image that is too large, or too long and narrow, to be turned.
    """
    moved = image
    if (change.rotation_deg, change.mirrored, change.upside_down, change.magnification) != (
        0,
        False,
        False,
        1,
    ):
        moved = _warp(image, change)
    return _shade(moved, change) if (change.contrast, change.brightness) != (1, 0) else moved


def _warp(image: Image.Image, change: Change) -> Image.Image:
    """The image turned, mirrored and zoomed."""
    width, height = image.size
    angle = math.radians(change.rotation_deg)
    cosine, sine = math.cos(angle) / change.magnification, math.sin(angle) / change.magnification
    across, down = (-1.0 if change.mirrored else 1.0), (-1.0 if change.upside_down else 1.0)
    # From a pixel of the result to where it is taken from, with y pointing down.
    xx, xy, yx, yy = (
        round(one * _STEPS) / _STEPS for one in (cosine * across, -sine * down, sine * across, cosine * down)
    )
    beside = _overhang_px(abs(xx) * width + abs(xy) * height, width)
    above = _overhang_px(abs(yx) * width + abs(yy) * height, height)
    x = beside + (width - xx * width - xy * height) / 2.0
    y = above + (height - yx * width - yy * height) / 2.0
    return _add_reflections(image, beside, above).transform(
        image.size, Image.AFFINE, (xx, xy, x, yx, yy, y), Image.BILINEAR
    )


def _overhang_px(seen_px: float, size_px: int) -> int:
    """Whole pixels that are seen beyond a border, with one more that the bilinear ones rest on."""
    return max(math.ceil((seen_px - size_px) / 2.0), 0) + 1


def _add_reflections(image: Image.Image, beside: int, above: int) -> Image.Image:
    """The image with so many pixels of its reflections on either side, and above and below."""
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
    """The image with another contrast about its mean over all channels, and another brightness."""
    counts = image.histogram()
    mean = sum(index % _GREYS * count for index, count in enumerate(counts)) / sum(counts)
    lift = mean + (_GREYS - 1) * change.brightness + 0.5
    table = [min(max(math.floor(lift + change.contrast * (grey - mean)), 0), _GREYS - 1) for grey in range(_GREYS)]
    return image.point(table * len(image.getbands()))
