"""Frames as files in memory: the same bytes as a capture writes."""

from __future__ import annotations

from pathlib import Path

from ..arrays import PixelValues
from ..bands import RGB, Bands
from ..capture.records import bands_as_written, value_ranges
from ..capture.writers import encoded, label_format, write_labels
from ..errors import InvalidInput
from ..mission.parts import CLASSES, LABELLED
from ..picture.products import BANDS
from .camera import LiveFrame

#: Media types by the name of a format.
MEDIA_TYPES = {"jpg": "image/jpeg", "png": "image/png", "tif": "image/tiff"}
#: What a frame shows besides products.
PICTURE = "picture"


def encode(frame: LiveFrame, image: str = PICTURE, image_format: str = "jpg") -> bytes:
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
    job = frame.job
    values = frame.picture if image == PICTURE else frame.products[image]
    if image_format not in _formats(image, values, job.bands):
        raise InvalidInput("format {0}: cannot hold {1}", image_format, image, field="format", remedy="choose tif")
    if image in LABELLED:
        files: dict[str, bytes] = {}
        colours = job.labels.classes.colours if image == CLASSES and job.labels is not None else None

        def keep(path: Path, data: bytes) -> None:
            files[path.suffix] = data

        write_labels(Path(), image_format, values, job.place, job.description, colours, keep)
        return files[f".{image_format}"]
    if image == PICTURE:
        bands, ranges = (None, ()) if job.bands == RGB else bands_as_written(job)
        return encoded(image_format, values, job.place, job.description, bands, ranges)
    limits = value_ranges(values, BANDS[image])
    return encoded(image_format, values, job.place, job.description, BANDS[image], limits)


def _formats(image: str, values: PixelValues, bands: Bands) -> tuple[str, ...]:
    """Formats that can hold an image."""
    if image == PICTURE and bands.are_colours:
        return tuple(MEDIA_TYPES)
    if image in LABELLED and label_format("png", values.dtype) == "png":
        return ("png", "tif")
    return ("tif",)
