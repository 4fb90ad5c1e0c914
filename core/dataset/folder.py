"""The dataset folder: file names, map types, and choices of the commands on datasets."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InvalidInput
from ..map_types import CLEAN, twin_type, without_twin
from ..storage.stores import Address, is_address, is_file, list_folders, resolved, store_path

if TYPE_CHECKING:
    from .table import Table

MISSION_FILE = "mission.json"
JOURNAL_FILE = "journal.jsonl"
PLAN_FILE = "plan.csv"
FOOTPRINTS_FILE = "footprints.geojson"
TABLE_FILE = "meta_data.csv"
#: Tables of labels: ids, names and colours of classes; class, layer and feature of each instance.
CLASSES_FILE, INSTANCES_FILE = "classes.json", "instances.csv"
#: Folders of images of labels.
PIXEL_LABELS = CLASSES, INSTANCES = ("classes", "instances")
#: Folder beside the images of a map type, with the images that cleaning has moved away.
REJECTED_FOLDER = "rejected"
#: The map type whose entropies decide on all images of a place.
DECIDING = "roadmap"

#: Image names of captures and of the published dataset, without ending: column, row, latitude, longitude, zoom.
NAME = re.compile(r"(\d+)_(\d+)_(-?\d+(?:\.\d+)?(?:e-\d+)?)_(-?\d+(?:\.\d+)?(?:e-\d+)?)_(\d+)", re.ASCII)
#: Folder of the Night Vision supplement's images, which have no table.
SUPPLEMENT_FOLDER = "JPG2"
#: Threshold of the paper: in its dataset, images below it lack significant detail.
DEFAULT_ENTROPY = 2.1
#: Layouts of folders: of captures and the paper's published data; of the paper's Night Vision supplement.
LAYOUTS = ("TerrAInav", "VBN")
TRAIN, VALIDATION, TEST = PARTS = ("train", "validation", "test")
#: Shares of the parts in the paper.
SHARES = (0.8, 0.1, 0.1)
SEED = 2024
#: How images are ordered or grouped before they are split.
AUTO, *_ = WAYS = ("auto", "shuffled", "in-order", "blocks")
#: Contents of labels: the image's centre, and the camera's position, height and attitude; class and instance of pixels.
TARGETS = IMAGE, CAMERA, HEIGHT, ATTITUDE, *_ = ("image", "camera", "height", "attitude", *PIXEL_LABELS)
#: Frames of labels by name; others are given as ``EPSG:…``.
FRAMES = ("utm", "mercator", "mission")


def map_type_folders(folder: Address) -> dict[str, Path]:
    """Folders of a dataset's map types by name: those with a table, or the folder itself if it has one.

    If the dataset holds several imageries, each a dataset of one map type, the names are those of the imageries.

    Raises
    ------
    InvalidInput
        The folder is not a dataset, or is one map type of a dataset with others that may matter.
    OutputError
        The object store cannot be reached.
    """
    path = store_path(folder)
    try:
        if is_file(path / TABLE_FILE):
            # A name like `.` must be resolved.
            parent = resolved(path).parent
            deciding = deciding_name(resolved(path).name)
            if is_file(parent / MISSION_FILE) or (
                deciding != resolved(path).name and is_file(parent / deciding / TABLE_FILE)
            ):
                raise InvalidInput(
                    "folder {0}: is one map type of the dataset {1}", folder, parent, remedy="give that one"
                )
            return {resolved(path).name: path}
        found = [one for one in _list_folders(path) if is_file(one / TABLE_FILE)]
    except OSError as wrong:
        raise InvalidInput("folder {0}: cannot be read ({1})", folder, wrong.strerror) from wrong
    if not found and is_file(path / MISSION_FILE):
        inside = _imagery_folders(path)
        if inside:
            return inside
    if not found and not is_address(path) and (path / SUPPLEMENT_FOLDER).is_dir():
        raise InvalidInput(
            "folder {0}: is laid out as the Night Vision supplement is",
            folder,
            remedy="make a dataset of it first (terrainav convert --dataset VBN)",
        )
    if not found:
        raise InvalidInput(
            "folder {0}: is not a dataset, as neither it nor a folder in it has a {1}",
            folder,
            TABLE_FILE,
            remedy="give the folder of a capture",
        )
    return {one.name: one for one in found}


def _imagery_folders(path: Path) -> dict[str, Path]:
    """Folders of the one map type of each dataset inside a folder, by the datasets' names."""
    return {
        dataset.name: one
        for dataset in _list_folders(path)
        if is_file(dataset / MISSION_FILE)
        for one in _list_folders(dataset)
        if is_file(one / TABLE_FILE)
    }


def _list_folders(path: Path) -> list[Path]:
    """Entries of a folder that may be folders, by name."""
    return list_folders(path) if is_address(path) else sorted(path.iterdir())


def place_key(folder: Address, folders: Iterable[Path]) -> Callable[[str], str]:
    """Return the function that maps an image's name to its key, which all images of one place share.

    The key is the name without ending. For several imageries, whose zooms and pixels differ, it is column and row.

    Parameters
    ----------
    folder : path
        Dataset.
    folders : iterable of Path
        Its map types, as `map_type_folders` returns them.
    """
    if not any(one.parent.parent == store_path(folder) for one in folders):
        return lambda name: Path(name).stem

    def grid_key(name: str) -> str:
        stem = Path(name).stem
        found = NAME.fullmatch(stem)
        return f"{found.group(1)}_{found.group(2)}" if found else stem

    return grid_key


def map_type_name(name: str) -> str:
    """Map type of a folder: ``satellite`` for the published ``satellite_0``."""
    return name[: len(name) - len(_ending(name))]


def deciding_name(name: str) -> str:
    """Name of the folder whose entropies decide for a folder: ``roadmap_0`` for ``satellite_0``."""
    return DECIDING + _ending(name)


def deciding_folder(name: str, among: Mapping[str, Path]) -> str | None:
    """Name of the roadmap folder whose entropies decide for a folder: with the same ending, or without.

    Among imageries, it is the only imagery of the deciding map type. Of images with effects of a real camera, whose
    noise looks like detail, clean ones decide; twins follow their images. None if there is no such folder, or if it is
    ``name`` itself.
    """
    found = next((one for one in (deciding_name(name), DECIDING) if one in among), None)
    if found is None:
        of_type = [one for one, path in among.items() if path.name == DECIDING]
        found = of_type[0] if len(of_type) == 1 else None
    base = found or without_twin(name)[0]
    found = next((one for one in (twin_type(base, CLEAN), base) if one in among), None)
    return None if found == name else found


def _ending(name: str) -> str:
    """Overlap at the end of a published folder's name, or an empty text."""
    start = name.rfind("_")
    # Published folders end in the overlap of their images: `satellite_0`, `satellite_0.6`.
    return name[start:] if start > 0 and re.fullmatch(r"_\d+(\.\d+)?", name[start:]) else ""


def raster_folders(folder: Path) -> list[Path]:
    """Folders of images inside a published map type's, by name."""
    return sorted(one for one in folder.glob("raster_images_*") if one.is_dir())


def image_folder(folder: Path, table: Table) -> Path:
    """Folder of a map type's images: the table's folder or a folder in it, whichever holds most of them.

    Parameters
    ----------
    folder : Path
        Folder of the map type.
    table : Table
        Table that names the images.

    Raises
    ------
    InvalidInput
        The images are not local files, several folders hold equally many of them, or a folder cannot be read.
    """
    if is_address(folder) or any(table.shard):
        raise no_files_error(folder)
    inside = raster_folders(folder)
    if not inside:
        return folder
    counts = {one: len(_list_names(one).intersection(table.img_names)) for one in (folder, *inside)}
    most = max(counts.values())
    best = [one for one, count in counts.items() if count == most]
    if most and len(best) > 1:
        raise InvalidInput(
            "folder {0}: the images of its {1} are in {2} and in {3} as well",
            folder,
            TABLE_FILE,
            best[0].name,
            best[1].name,
            remedy="move one of the two away",
        )
    return best[0]


def no_files_error(folder: Path) -> InvalidInput:
    """Error for images in shards or object stores where local files are needed."""
    return InvalidInput(
        "folder {0}: its images are in shards or in an object store, and here have to be files of a folder",
        folder,
    )


def _list_names(folder: Path) -> set[str]:
    """Names in a folder of images and in its folder of rejected images."""
    try:
        found = {one.name for one in folder.iterdir()}
        if (folder / REJECTED_FOLDER).is_dir():
            found.update(one.name for one in (folder / REJECTED_FOLDER).iterdir())
    except OSError as wrong:
        raise InvalidInput("folder {0}: cannot be read ({1})", folder, wrong.strerror) from wrong
    return found
