"""Convert published datasets: copy the images and write tables with TerrAInav's columns."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..arrays import Floats
from ..errors import InvalidInput, OutputError
from ..storage.files import PARTIAL_ENDING, make_folder
from .dataset import UNREADABLE, Dataset, ImageSet, first_names, open_bands, open_undecoded, read_dataset
from .folder import MISSION_FILE, REJECTED_FOLDER, TABLE_FILE
from .published import add_windows
from .table import Table


@dataclass(frozen=True)
class Converted:
    """Result of converting one map type.

    Parameters
    ----------
    images, failed : int
        Number of images copied, and of rows without an image.
    framed : int
        Images whose ground is known.
    """

    map_type: str
    images: int
    failed: int
    framed: int


def convert(
    folder: str | os.PathLike[str], target: str | os.PathLike[str], layout: str = "TerrAInav"
) -> tuple[Converted, ...]:
    """Convert a published dataset to TerrAInav's columns; the source is only read.

    Images are copied unchanged, including those that cleaning has moved to ``rejected``. Tables get the image sizes.
    Tables in TerrAInav's layout also get poses that look straight down with north up, heights if the name of the image
    folder states them, and windows: centred on ``Lat``, ``Lon`` at zoom ``Alt``, in pixels of 256 px tiles. Published
    images may consist of tiles of a higher zoom than ``Alt``. How much higher follows from the flight's height and
    field of view; if the difference is not a whole number, the windows stay unknown.

    Parameters
    ----------
    folder, target : path
        Published dataset, and a new or empty folder for its copy.
    layout : str
        Layout of the source, one of `LAYOUTS`.

    Raises
    ------
    InvalidInput
        As `read_dataset`; an image cannot be read, or the source is a capture. Nothing is written then.
    OutputError
        The target is in use or cannot be written. No part of the result is left then.
    """
    source, out = Path(folder), Path(target)
    _check_places(source, out)
    out = out.resolve()
    dataset = read_dataset(source, layout)
    tables = {name: _convert_table(one, layout) for name, one in dataset.image_sets.items()}
    _write(dataset, tables, out)
    return tuple(
        Converted(
            name,
            int(one.made.sum()),
            int((~one.made).sum()),
            int(np.isfinite(tables[name].left_px[one.made]).sum()),
        )
        for name, one in dataset.image_sets.items()
    )


def _check_places(source: Path, target: Path) -> None:
    if (source / MISSION_FILE).is_file():
        raise InvalidInput("folder {0}: is a capture, whose tables are ours already", source)
    copy, original = target.resolve(), source.resolve()
    if original == copy or original in copy.parents or copy in original.parents:
        raise InvalidInput("folder {0}: must lie outside {1}, which is left as it is", target, source)
    if copy == Path.cwd():
        raise InvalidInput(
            "folder {0!r}: is the current one, which is in use", os.fspath(target), remedy="give a new one"
        )
    try:
        if target.exists() and (not target.is_dir() or any(target.iterdir())):
            raise OutputError("folder {0}: is there already", target, remedy="choose a new or empty folder")
    except OSError as wrong:
        raise OutputError("folder {0}: cannot be read ({1})", target, wrong.strerror) from wrong


def _convert_table(images: ImageSet, layout: str) -> Table:
    """Add sizes to a table, and poses and windows if the layout implies them."""
    if not images.made.any():
        raise InvalidInput("table {0}: names no image that is there; nothing to convert", images.folder / TABLE_FILE)
    width, height = _sizes(images)
    status = tuple("done" if made else "failed" for made in images.made.tolist())
    table = replace(images.table, image_width_px=width, image_height_px=height, status=status)
    return table if layout == "VBN" else add_windows(table, images.image_folder.name)


def _sizes(images: ImageSet) -> tuple[Floats, Floats]:
    """Read widths and heights (n,) in px, NaN for rows without an image."""
    sizes = np.full((len(images), 2), np.nan)
    wrong = []
    for index in np.flatnonzero(images.made).tolist():
        path = images.path(index)
        try:
            stored = open_bands(path)
            if stored is not None:
                sizes[index] = stored.size
                continue
            with open_undecoded(path) as image:
                sizes[index] = image.size
                # Decode the image to find truncated files; a JPEG at an eighth of its size, which is fast.
                image.draft(image.mode, (1, 1))
                image.load()
        except UNREADABLE:
            wrong.append(path.name)
    if wrong:
        raise InvalidInput("folder {0}: no images that can be read: {1}", images.image_folder, first_names(wrong))
    return sizes[:, 0], sizes[:, 1]


def _write(dataset: Dataset, tables: Mapping[str, Table], target: Path) -> None:
    """Write to a temporary folder and rename it when complete."""
    partial = target.with_name(target.name + PARTIAL_ENDING)
    make_folder(target.parent)
    try:
        partial.mkdir()
    except FileExistsError as wrong:
        raise OutputError(
            "folder {0}: is left over from an interrupted conversion, or another is running",
            partial,
            remedy="remove it",
        ) from wrong
    except OSError as wrong:
        raise OutputError("folder {0}: cannot be made ({1})", partial, wrong.strerror) from wrong
    try:
        _fill(partial, dataset.image_sets, tables)
        if target.exists():
            target.rmdir()
        os.replace(partial, target)
    except OSError as wrong:
        raise OutputError("folder {0}: cannot be written ({1})", target, wrong.strerror) from wrong
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def _fill(folder: Path, image_sets: Mapping[str, ImageSet], tables: Mapping[str, Table]) -> None:
    for name, images in image_sets.items():
        for index in np.flatnonzero(images.made).tolist():
            origin = images.path(index)
            moved = origin.parent.name == REJECTED_FOLDER and origin.parent != images.image_folder
            place = folder / name / (REJECTED_FOLDER if moved else "")
            place.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(origin, place / origin.name)
        (folder / name).mkdir(exist_ok=True)
        tables[name].save(folder / name / TABLE_FILE)
