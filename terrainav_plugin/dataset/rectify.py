"""Lay camera frames on the map, one or all of a dataset, with overviews. Runs in the background; no widgets.

From ground control points, GDAL and QGIS can only place such an image by polynomials or splines. At a tilt of 60
degrees, polynomials displace it by up to a hundred pixels, and splines displace its corners by forty. The core projects
with the exact camera.
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
from ...core.mission.estimate import MOST_ORTHOMOSAIC_PX
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
        Plan of the single image.
    picture : Path
        The captured image.
    target : Path
        File to write, completely or not at all.

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
    """Write a file that shows an image of a dataset on the map, and return its path; for a map frame, the image's path.

    Parameters
    ----------
    folder : Path
    map_type, file : str
    open_heights : callable
    fetch : callable or None
        Writes an image that is not in the dataset's folder to the given path.

    Raises
    ------
    InvalidInput, OutputError, SourceError
        As from `lay_on_map`; or the image is not in the dataset, or is rejected.
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
    """Path under which to keep an image that is not in the dataset's folder: a remote image, or one in a shard."""
    return folder / ON_MAP_FOLDER / map_type / "fetched" / file


def write_mosaic(
    folder: Path,
    map_type: str,
    target: Path,
    open_heights: OpenHeights,
    progress: Callable[[float], bool],
    gsd_m: float | None = None,
) -> Orthomosaic:
    """Write one orthophoto of all images of a map type, with overviews; the default GSD limits its size.

    Raises
    ------
    InvalidInput, OutputError, SourceError, Cancelled
    """
    # The core limits it to a gigabyte: minutes of work for two cores, or half an hour over relief.
    made = make_orthomosaic(
        folder,
        target,
        map_type=map_type or None,
        gsd_m=gsd_m,
        most_px=None if gsd_m else MOST_ORTHOMOSAIC_PX,
        open_heights=open_heights,
        progress=progress,
    )
    _add_overviews(target)
    return made


def _lay_on_map(frames: CameraImages, target: Path) -> None:
    try:
        with partial_file(target, ".new") as made:
            # 2000 px are sharp on a screen, and quickly made.
            orthorectify(frames, made, 2000)
            _add_overviews(made)
    except OSError as wrong:
        raise OutputError("image {0}: cannot be written ({1})", target, wrong.strerror) from wrong


def _add_overviews(path: Path) -> None:
    """Add overviews to a file; each overview pixel is the mean of four pixels."""
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
