"""Frames as files in memory: the same bytes as a capture writes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..arrays import PixelValues
from ..bands import Bands
from ..capture.records import image_job
from ..capture.writers import encoded, label_format
from ..errors import InvalidInput
from ..imagery.source import Source
from ..mission.parts import LABELLED
from ..picture.products import BANDS
from .camera import LiveFrame

#: Media types by the name of a format.
MEDIA_TYPES = {"jpg": "image/jpeg", "png": "image/png", "tif": "image/tiff"}
#: What a frame shows besides products.
PICTURE = "picture"


def encode(frame: LiveFrame, source: Source, image: str = PICTURE, image_format: str = "jpg") -> bytes:
    """Return the picture, or one product, of a frame as an image file.

    Parameters
    ----------
    image : str
        ``picture`` or one of the frame's products.
    image_format : str
        jpg, png or tif; products that measure have tif alone.

    Raises
    ------
    InvalidInput
        The format cannot hold the image, or the frame lacks it.
    """
    if image_format not in MEDIA_TYPES:
        raise InvalidInput("format {0!r}: must be one of {1}", image_format, ", ".join(MEDIA_TYPES))
    if image != PICTURE and image not in frame.products:
        raise InvalidInput("image {0!r}: this frame has {1}", image, ", ".join((PICTURE, *frame.products)))
    job = image_job(frame.plan, 0, source, frame.plan.mission.imagery.map_types[0], Path())
    values = frame.picture if image == PICTURE else frame.products[image]
    if image_format not in _formats(image, values, job.bands):
        raise InvalidInput("format {0}: cannot hold {1}", image_format, image, field="format", remedy="choose tif")
    if image in LABELLED:
        return encoded(image_format, values, job.place, job.description)
    if image == PICTURE:
        bands = None if job.bands.are_colours and len(job.bands) == 3 else job.bands
        return encoded(image_format, values, job.place, job.description, bands, job.ranges)
    limits = [(float(np.nanmin(values)), float(np.nanmax(values)))] * len(BANDS[image])
    return encoded(image_format, values, job.place, job.description, BANDS[image], limits)


def _formats(image: str, values: PixelValues, bands: Bands) -> tuple[str, ...]:
    """Formats that can hold an image."""
    if image == PICTURE and bands.are_colours:
        return tuple(MEDIA_TYPES)
    if image in LABELLED and label_format("png", values.dtype) == "png":
        return ("png", "tif")
    return ("tif",)
