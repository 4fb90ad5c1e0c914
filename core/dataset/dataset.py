"""A dataset as it is read: its map types, each with a table and the images that the table names."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from .choices import LAYOUTS
from .decode import open_image
from .folder import REJECTED_FOLDER, TABLE_FILE, image_folder, map_type_folders, map_type_of
from .images import Images, some
from .published import check_names
from .table import Table
from .vbn import read_vbn

#: The map type of a supplement's images, which are no map's.
VBN_MAP_TYPE = "camera"
#: Pillow's modes by the channels that are asked for.
_MODES = {1: "L", 3: "RGB"}


@dataclass(frozen=True, eq=False)
class ImageSet:
    """The images of one map type.

    Parameters
    ----------
    map_type : str
        Such as ``satellite``, also of a published folder ``satellite_0``.
    folder : Path
        Where the table lies, or would lie.
    table : Table
        All rows.
    image_folder : Path
        Where the images lie; those that cleaning has moved are in ``rejected`` inside.
    """

    map_type: str
    folder: Path
    table: Table
    image_folder: Path

    def __len__(self) -> int:
        return len(self.table)

    @property
    def there(self) -> NDArray[np.bool_]:
        """Rows (n,) whose image exists: those that have not failed."""
        return rows_made(self.table)

    def path(self, index: int) -> Path:
        """Where the file of a row lies now: in its folder, or among the rejected ones."""
        name = self.table.img_names[index]
        kept = self.image_folder / name
        moved = self.image_folder / REJECTED_FOLDER / name
        return moved if not kept.exists() and moved.exists() else kept

    def pixels(self, index: int, channels: int | None = None) -> NDArray[np.uint8]:
        """Pixels of a row's image, without a mask.

        Parameters
        ----------
        index : int
        channels : int or None
            1 for grey (ITU-R 601), 3 for red, green, blue; as the file has it for None.

        Returns
        -------
        array (h, w) for grey or (h, w, 3) of uint8

        Raises
        ------
        InvalidInput
            An image that is not there, cannot be read, or is not of the size that the table says.
        """
        if channels is not None and channels not in _MODES:
            raise InvalidInput(f"channels {channels}: must be 1 or 3")
        image = open_image(self.path(index), said_px=self.said_px(index))
        mode = image.mode if channels is None else _MODES[channels]
        return np.asarray(image if image.mode == mode else image.convert(mode), np.uint8)

    def said_px(self, index: int) -> tuple[float, float]:
        """Width and height that the table says of a row's image, NaN where it says nothing."""
        return float(self.table.image_width_px[index]), float(self.table.image_height_px[index])


@dataclass(frozen=True, eq=False)
class Dataset:
    """A folder of images with tables.

    Parameters
    ----------
    folder : Path
    layout : str
        One of `LAYOUTS`.
    image_sets : mapping of str to ImageSet
        By map type; where several published folders are of one, as of several overlaps, by the folder's name.
    """

    folder: Path
    layout: str
    image_sets: Mapping[str, ImageSet]

    def image_set(self, map_type: str) -> ImageSet:
        """Images of a map type; raises InvalidInput where there are none, with those that are there."""
        if map_type not in self.image_sets:
            raise InvalidInput(f"map type {map_type!r}: {self.folder} has {', '.join(self.image_sets)}")
        return self.image_sets[map_type]


def read_dataset(
    folder: str | os.PathLike[str], layout: str = "TerrAInav", *, map_types: Collection[str] | None = None
) -> Dataset:
    """Dataset in a folder, whose tables and files agree; reads no pixels.

    Parameters
    ----------
    folder : path
        Of a capture, of the paper's published data (``Memphis_Agricenter`` with ``satellite`` or ``satellite_0`` in it,
        or one of these where it stands alone), or of the Night Vision supplement.
    layout : str
        One of `LAYOUTS`.
    map_types : collection of str or None
        Only these, by their names in `Dataset.image_sets`; None for all.

    Raises
    ------
    InvalidInput
        A folder that is no such dataset or has no such map type, rows that cannot be read, or a table that says
        otherwise than the files: they are named.
    """
    path = Path(folder)
    if layout not in LAYOUTS:
        raise InvalidInput(f"layout {layout!r}: must be one of {', '.join(LAYOUTS)}")
    if layout == "VBN":
        table, images = read_vbn(path)
        return _only(
            Dataset(path, layout, {VBN_MAP_TYPE: ImageSet(VBN_MAP_TYPE, images, table, images)}), map_types
        )
    folders = map_type_folders(path)
    counts = Counter(map(map_type_of, folders))
    keys = {name if counts[map_type_of(name)] > 1 else map_type_of(name): name for name in folders}
    wanted = keys if map_types is None else {key: name for key, name in keys.items() if key in map_types}
    sets = {key: _read_set(map_type_of(name), folders[name]) for key, name in wanted.items()}
    missing = [one for one in map_types or () if one not in keys]
    if missing:
        raise InvalidInput(f"map type {missing[0]!r}: {folder} has {', '.join(keys)}")
    return Dataset(path, layout, sets)


def rows_made(table: Table) -> NDArray[np.bool_]:
    """Rows (n,) of a table whose images have been made."""
    return np.array([status != "failed" for status in table.status], np.bool_)


def _read_set(map_type: str, folder: Path) -> ImageSet:
    table = Table.load(folder / TABLE_FILE)
    _check_positions(table, folder / TABLE_FILE)
    check_names(table, folder / TABLE_FILE)
    images = image_folder(folder, table.img_names)
    Images(images).check(table.img_names, rows_made(table))
    return ImageSet(map_type, folder, table, images)


def _check_positions(table: Table, path: Path) -> None:
    off = np.flatnonzero((np.abs(table.lat_deg) > 90.0) | (np.abs(table.lon_deg) > 360.0))
    if off.size:
        names = [table.img_names[row] for row in off.tolist()]
        raise InvalidInput(
            f"table {path}: {some(names)} {'is' if len(names) == 1 else 'are'} not on the Earth, first at Lat "
            f"{table.lat_deg[off[0]]:g}, Lon {table.lon_deg[off[0]]:g}; Lat must be within 90 degrees, Lon within 360"
        )


def _only(dataset: Dataset, map_types: Collection[str] | None) -> Dataset:
    if map_types is None:
        return dataset
    return Dataset(dataset.folder, dataset.layout, {one: dataset.image_set(one) for one in map_types})
