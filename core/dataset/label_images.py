"""Images of labels: class and instance of each pixel, beside the images of a dataset."""

from __future__ import annotations

import zlib
from functools import cached_property
from pathlib import Path

import numpy as np

from ..arrays import NDArray
from ..errors import InvalidInput, Message
from ..labels.classes import MAX_CLASSES_BYTES, ClassTable, read_classes
from ..map_types import is_undistorted, without_twin
from ..storage.files import read_existing
from ..storage.stores import is_file
from .dataset import UNREADABLE, ImageSet, Place, check_px, open_undecoded, read_image_file
from .folder import CLASSES_FILE
from .geotiff import parse_geotiff
from .stored import ImageFile, StoredImage


class LabelImages:
    """Labels of the images of one map type: the folders ``classes`` and ``instances`` of the dataset, or its shards.

    Parameters
    ----------
    images : ImageSet
    """

    def __init__(self, images: ImageSet) -> None:
        self._images = images

    @property
    def folder(self) -> Path:
        """Folder of the dataset, which all map types share."""
        return self._images.folder.parent

    @cached_property
    def classes(self) -> ClassTable:
        """Ids, names and colours of the classes, background and ignore.

        Raises
        ------
        InvalidInput
            The dataset has no ``classes.json``, or it cannot be read.
        """
        if is_undistorted(self._images.map_type):
            raise InvalidInput(
                "map type {0}: labels are those of the images with distortion",
                self._images.map_type,
                remedy=Message("take {0}", without_twin(self._images.map_type)[0]),
            )
        path = self.folder / CLASSES_FILE
        data = read_existing(path, MAX_CLASSES_BYTES)
        if data is None:
            raise InvalidInput(
                "folder {0}: has no {1}, as it was captured without labels",
                self.folder,
                CLASSES_FILE,
                remedy="capture it with labels",
            )
        return read_classes(data, str(path))

    def pixels(self, kind: str, index: int, *, image: ImageFile | None = None) -> NDArray[np.int64]:
        """Read the labels (h, w) of a row's image.

        Parameters
        ----------
        kind : str
            One of `folder.PIXEL_LABELS`.
        image : path, StoredImage or None
            Where to read the image from; None for the result of `ImageSet.file`.

        Raises
        ------
        InvalidInput
            The labels do not exist, cannot be read, or have another size than the table states for the image.
        """
        file = self._file(kind, self._images.file(index) if image is None else image)
        return read_label_image(file, self._images.expected_px(index))

    def _file(self, kind: str, image: ImageFile) -> ImageFile:
        """File of an image's labels. Labels of images that are not TIFF are PNG, or TIFF if they take 32 bits."""
        endings = (".tif",) if image.suffix == ".tif" else (".png", ".tif")
        if isinstance(image, StoredImage) and image.range is not None:
            found = image.companion([f".{kind}{ending}" for ending in endings])
            if found is None:
                raise InvalidInput(
                    "image {0}: its shard has no {1}, which are with the first map type of a mission", image, kind
                )
            return found
        stem = Path(image.name).stem
        paths = [self.folder / kind / f"{stem}{ending}" for ending in endings]
        path = next((one for one in paths if is_file(one)), paths[0])
        return StoredImage(path.name, path) if isinstance(image, StoredImage) else path


def read_label_image(path: Place, expected_px: tuple[float, float] = (np.nan, np.nan)) -> NDArray[np.int64]:
    """Read an image of labels (h, w), whose colours are ignored.

    Parameters
    ----------
    expected_px : tuple (width, height)
        NaN if unknown.

    Raises
    ------
    InvalidInput
        The image does not exist, cannot be read, has several channels, or another size than expected.
    """
    try:
        data = read_image_file(path)
        stored = parse_geotiff(data)
        if stored is not None:
            values, size = stored.values(), stored.size
        else:
            with open_undecoded(path, data) as image:
                values, size = np.asarray(image), image.size
    except InvalidInput:
        raise
    except FileNotFoundError as wrong:
        raise InvalidInput("labels {0}: are not there", path) from wrong
    except (*UNREADABLE, zlib.error) as wrong:
        raise InvalidInput("labels {0}: cannot be read ({1})", path, wrong) from wrong
    if values.size != size[0] * size[1] or values.dtype.kind not in "iu":
        raise InvalidInput("labels {0}: must have one channel of whole numbers", path)
    check_px(path, size, expected_px)
    # Pillow has 32 bits with a sign only.
    return values.reshape(size[::-1]).astype(np.int64) & 0xFFFFFFFF
