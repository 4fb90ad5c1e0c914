"""Camera frames laid on the map, one or all of a dataset, with overviews. Runs in the background; knows no widget.

GDAL and QGIS can place such an image by its ground control points alone, but only through polynomials or splines:
those put an image tilted by 60 degrees a hundred pixels off, or its corners forty. The core knows the exact camera.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from osgeo import gdal

from ...core.dataset.dataset import ImageSet, read_dataset
from ...core.dataset.folder import TABLE_FILE
from ...core.dataset.ground import are_camera_frames
from ...core.dataset.table import Table, usable_rows
from ...core.errors import InvalidInput, Message, OutputError
from ...core.mosaic.frames import CameraImages, camera_frames
from ...core.mosaic.orthomosaic import Orthomosaic, make_orthomosaic, orthorectify
from ...core.storage.files import partial_file
from ..i18n import tr
from .shown import open_image

if TYPE_CHECKING:
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan
    from ...core.mission.relief.ground import Heights

#: Folder in a dataset of the images that are laid on the map one by one.
ON_MAP_FOLDER = "on-map"

OpenHeights = Callable[["Mission"], "Heights | None"]


def lay_on_map(plan: Plan, picture: Path, target: Path) -> None:
    """Write a camera frame as a GeoTIFF in the CRS of its source's pixels, transparent where it shows no ground.

    Parameters
    ----------
    plan : Plan
        Of this one capture.
    picture : Path
        As it was captured.
    target : Path
        Written whole or not at all.

    Raises
    ------
    InvalidInput, OutputError
        Where a file cannot be read or written, or the image shows nothing of the map.
    """
    _lay_on_map(CameraImages.from_plan(plan, 0, picture), target)


def lay_image_on_map(
    folder: Path,
    map_type: str,
    file: str,
    open_heights: OpenHeights,
    fetch: Callable[[Path], None] | None = None,
) -> Path:
    """Make what shows one image of a dataset on the map; returns its file, of a map frame the image itself.

    Parameters
    ----------
    folder : Path
    map_type, file : str
    open_heights : callable
    fetch : callable or None
        Writes an image from outside the dataset's folder to a file.

    Raises
    ------
    InvalidInput, OutputError, SourceError
        As `lay_on_map` does; an image that is not in the dataset, or is rejected.
    """
    if fetch is not None:
        picture = fetched_file(folder, map_type, file)
        fetch(picture)
        if _is_placed(picture):
            return picture
        table = folder / map_type / TABLE_FILE
        images = ImageSet(map_type, table.parent, Table.load(table), table.parent)
    else:
        images = read_dataset(folder).image_set(map_type)
    rows = np.array([row for row, name in enumerate(images.table.img_names) if name == file], np.int64)
    if not len(rows) or not usable_rows(images.table)[rows[0]]:
        raise InvalidInput(tr("image {name}: is not in the dataset, or is rejected").format(name=file))
    if fetch is None:
        picture = images.path(int(rows[0]))
        if not are_camera_frames(images, rows, folder):
            return picture
    target = folder / ON_MAP_FOLDER / map_type / f"{Path(file).stem}.tif"
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except OSError as wrong:
        raise OutputError("image {0}: cannot be written ({1})", target, wrong.strerror) from wrong
    _lay_on_map(replace(camera_frames(folder, images, rows, open_heights), paths=(picture,)), target)
    return target


def fetched_file(folder: Path, map_type: str, file: str) -> Path:
    """Path for a fetched image from outside the dataset's folder."""
    # Subfolder for images from outside the dataset's folder: at an address, or in a shard.
    return folder / ON_MAP_FOLDER / map_type / "fetched" / file


def write_mosaic(
    folder: Path,
    map_type: str,
    target: Path,
    open_heights: OpenHeights,
    progress: Callable[[float], bool],
    gsd_m: float | None = None,
) -> Orthomosaic:
    """Write one orthophoto of all images of a map type, with overviews; the ground sample distance as the size allows.

    Raises
    ------
    InvalidInput, OutputError, SourceError, Cancelled
    """
    # A mosaic has at most a gigabyte: some minutes of work for two cores, or half an hour over relief.
    made = make_orthomosaic(
        folder,
        target,
        map_type=map_type or None,
        gsd_m=gsd_m,
        most_px=None if gsd_m else 1 << 28,
        open_heights=open_heights,
        progress=progress,
    )
    _add_overviews(target)
    return made


def _lay_on_map(frames: CameraImages, target: Path) -> None:
    try:
        with partial_file(target, ".new") as made:
            # Sharp on a screen, and made in seconds.
            orthorectify(frames, made, 2000)
            _add_overviews(made)
    except OSError as wrong:
        raise OutputError("image {0}: cannot be written ({1})", target, wrong.strerror) from wrong


def _add_overviews(path: Path) -> None:
    """Add overviews to a file, each pixel the mean of four."""
    raster = gdal.Open(str(path), gdal.GA_Update)
    if raster is None:
        raise _failed(path)
    factors, factor = [], 2
    # Overviews go on until the map fits about a thumbnail.
    while max(raster.RasterXSize, raster.RasterYSize) // factor * 2 > 256:
        factors.append(factor)
        factor *= 2
    if factors and raster.BuildOverviews("AVERAGE", factors) != gdal.CE_None:
        raise _failed(path)
    del raster


def _is_placed(path: Path) -> bool:
    """Whether an image is georeferenced, which map frames alone are."""
    image = open_image(path)
    return image is not None and image.GetGeoTransform(can_return_null=True) is not None


def _failed(path: Path) -> OutputError:
    reason = " ".join(gdal.GetLastErrorMsg().split())
    return OutputError("mosaic {0}: cannot be made ({1})", path, reason or Message("no reason given"))
