"""Lay camera frames on the map, one or all of a dataset, with overviews. Runs in the background; no widgets.

With ground control points alone, GDAL and QGIS can only place such an image by polynomials or splines, which displace
an image tilted by 60 degrees by a hundred pixels, or its corners by forty. The core has the exact camera.
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

#: Folder in a dataset for single images laid on the map.
ON_MAP_FOLDER = "on-map"

OpenHeights = Callable[["Mission"], "Heights | None"]


def lay_on_map(plan: Plan, picture: Path, target: Path) -> None:
    """Write a camera frame as GeoTIFF in the CRS of its source's pixels, transparent outside the ground.

    Parameters
    ----------
    plan : Plan
        Plan of this single capture.
    picture : Path
        The captured image.
    target : Path
        Written completely or not at all.

    Raises
    ------
    InvalidInput, OutputError
        A file cannot be read or written, or the image shows nothing within the map.
    """
    _lay_on_map(CameraImages.from_plan(plan, 0, picture), target)


def lay_image_on_map(
    folder: Path,
    map_type: str,
    file: str,
    open_heights: OpenHeights,
    fetch: Callable[[Path], None] | None = None,
) -> Path:
    """Create a file that shows an image of a dataset on the map, and return its path; a map frame is returned itself.

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
        As from `lay_on_map`; the image is not in the dataset, or is rejected.
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
    # Subfolder for images from outside the dataset's folder: remote ones and those in shards.
    return folder / ON_MAP_FOLDER / map_type / "fetched" / file


def write_mosaic(
    folder: Path,
    map_type: str,
    target: Path,
    open_heights: OpenHeights,
    progress: Callable[[float], bool],
    gsd_m: float | None = None,
) -> Orthomosaic:
    """Write one orthophoto of all images of a map type, with overviews; by default at a GSD that suits the size.

    Raises
    ------
    InvalidInput, OutputError, SourceError, Cancelled
    """
    # A mosaic has at most a gigabyte: minutes of work for two cores, or half an hour over relief.
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
            # Sharp on a screen, and quick to make.
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
    # Overviews continue down to about a thumbnail.
    while max(raster.RasterXSize, raster.RasterYSize) // factor * 2 > 256:
        factors.append(factor)
        factor *= 2
    if factors and raster.BuildOverviews("AVERAGE", factors) != gdal.CE_None:
        raise _failed(path)
    del raster


def _is_placed(path: Path) -> bool:
    """Whether an image is georeferenced, as only map frames are."""
    image = open_image(path)
    return image is not None and image.GetGeoTransform(can_return_null=True) is not None


def _failed(path: Path) -> OutputError:
    reason = " ".join(gdal.GetLastErrorMsg().split())
    return OutputError("mosaic {0}: cannot be made ({1})", path, reason or Message("no reason given"))
