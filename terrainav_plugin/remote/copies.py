"""Local copies of remote datasets: the files that footprints need, without images.

QGIS reads a file of footprints repeatedly: every redraw of the map would fetch the whole remote file. With a copy, only
the images are remote, and a saved project opens without a network.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path, PurePosixPath

from qgis.core import QgsApplication

from ...core.dataset.folder import CLASSES_FILE, FOOTPRINTS_FILE, MISSION_FILE, TABLE_FILE
from ...core.dataset.vectors import checked_geojson
from ...core.errors import InvalidInput, OutputError
from ...core.imagery.http.client import NotThere
from ...core.labels.classes import MAX_CLASSES_BYTES
from ...core.limits import MAX_MISSION_BYTES, MAX_SETTINGS_BYTES
from ...core.mission.mission import Mission
from ...core.mission.parts import LABELLED
from ...core.storage.files import partial_file, read_limited, write_whole
from ...core.text.safe_json import parse_json
from ..foreign import check_driver
from ..i18n import tr
from ..paths import COPIES, exists, is_folder
from .address import DatasetAddress
from .geoparquet import ITEMS_FILE, can_read, write_from_items
from .store import Store

#: Name of the file in a copy that contains the dataset's address.
ADDRESS_FILE = "address.json"
#: Name of the file, in the folder of a map type, that lists the shards with its images.
SHARDS_FILE = "shards.json"
#: Characters that some systems forbid in folder names.
_ILLEGAL = re.compile(r'[<>:"/\\|?*\x00-\x1f]|[. ]+$')
#: Share of the footprints in the progress; the tables take the rest.
_FOOTPRINTS_SHARE = 0.6
#: Placeholder for footprints that are not copied yet, in the form of a capture, so that QGIS keeps the layer's style.
_NONE_YET = (
    b'{"type": "FeatureCollection", "features": [\n{"type": "Feature", "properties": {"name": ""}, "geometry": '
    b'{"type": "Polygon", "coordinates": [[[0, 0], [0, 0], [0, 0], [0, 0]]]}}\n]}\n'
)
#: Share of fetching the table of all images in the progress; converting it takes the rest.
_ITEMS_SHARE = 0.5
Progress = Callable[[float], bool]


def copy_folder(address: DatasetAddress) -> Path:
    """Folder for the copy of a dataset, which may not exist yet."""
    digest = hashlib.sha256(address.url.encode()).hexdigest()[:12]
    return _copies() / digest / (_ILLEGAL.sub("_", address.name) or "dataset")


def local_copy(source: str) -> str:
    """Path on this machine of the copy that a layer shows, as its project may be from another machine.

    If there is no copy yet, write an invisible footprint to the path: QGIS would ask the user for a missing file.
    """
    file, bar, options = source.replace("\\", "/").partition("|")
    path = _copies().joinpath(*PurePosixPath(file.rpartition(f"{COPIES}/")[2]).parts)
    # Write nothing outside the folder of copies, as the project may be foreign.
    if _copies() not in path.parents or ".." in path.parts:
        return source
    if path.name == FOOTPRINTS_FILE and not exists(path):
        try:
            _make_folder(path.parent)
            write_whole(path, _NONE_YET)
        except (OutputError, ValueError):
            # ValueError is raised for an impossible file name.
            return source
    return f"{path}{bar}{options}"


def _copies() -> Path:
    return Path(QgsApplication.qgisSettingsDirPath(), *COPIES.split("/"))


def copied_address(folder: Path) -> DatasetAddress | None:
    """Address of the dataset of which a folder is the copy; None for folders outside the folder of copies."""
    if _copies() not in folder.parents or ".." in folder.parts:
        return None
    try:
        found = parse_json(read_limited(folder / ADDRESS_FILE, MAX_SETTINGS_BYTES))
        return DatasetAddress.parse(str(found["address"]))
    except (OSError, ValueError, InvalidInput, KeyError, TypeError):
        return None


def has_images_elsewhere(folder: Path) -> bool:
    """Whether the images of a dataset are remote or in shards, and not files in its folder."""
    if copied_address(folder) is not None:
        return True
    return is_folder(folder) and any(folder.glob(f"*/{SHARDS_FILE}"))


def read_only_reason(folder: Path) -> str:
    """Reason why a dataset's images cannot be added, cleaned or split here; empty if they can."""
    address = copied_address(folder)
    if address is not None:
        return tr("{name} is remote and read-only: {address}").format(name=folder.name, address=address.url)
    if has_images_elsewhere(folder):
        return tr("{name} has its images in shards and is read-only").format(name=folder.name)
    return ""


def copy_dataset(store: Store, go_on: Progress) -> tuple[Path, Mission]:
    """Copy the files that footprints need, for a dataset and each of its imageries, in place of an earlier copy.

    Returns
    -------
    folder : Path
    mission : Mission

    Raises
    ------
    InvalidInput
        The address has no dataset.
    OutputError, PartError, SourceError, Cancelled
        As from `Store`; a file cannot be written.
    """
    folder = copy_folder(store.address)
    mission = _copy_mission(store, folder, "")
    places = [f"{one.name}/" for one in mission.imagery.named] if mission.imagery.imageries else [""]
    for number, place in enumerate(places):

        def share(done: float, number: int = number) -> bool:
            return go_on((number + done) / len(places))

        try:
            inner = _copy_mission(store, folder, place) if place else mission
        except NotThere:
            # This imagery is not captured yet.
            continue
        _copy_files(store, folder, place, inner, share)
    return folder, mission


def _copy_mission(store: Store, folder: Path, place: str) -> Mission:
    """Copy the mission of a dataset, or of its subfolder ``place``; raises NotThere if the subfolder is missing."""
    path = folder / place / MISSION_FILE
    try:
        text = b"".join(store.pieces(place + MISSION_FILE, most_bytes=MAX_MISSION_BYTES))
    except NotThere as wrong:
        if place:
            raise
        raise InvalidInput(
            tr("{address}: has no {name}: it is not a dataset of a capture, or does not exist").format(
                address=store.address.url, name=MISSION_FILE
            )
        ) from wrong
    address = store.address.inside(place.rstrip("/")) if place else store.address
    _make_folder(path.parent)
    write_whole(path, text)
    write_whole(path.with_name(ADDRESS_FILE), json.dumps({"address": address.url}).encode())
    return Mission.load(path)


def _copy_files(store: Store, folder: Path, place: str, mission: Mission, go_on: Progress) -> None:
    """Copy footprints and tables; an unfinished run has no tables yet."""
    if {*LABELLED} & {*mission.products}:
        classes = folder / place / CLASSES_FILE
        try:
            write_whole(classes, store.pieces(place + CLASSES_FILE, most_bytes=MAX_CLASSES_BYTES))
        except NotThere:
            classes.unlink(missing_ok=True)
    if not place and can_read() and _take_items(store, folder, mission, go_on):
        return
    pieces = store.pieces(place + FOOTPRINTS_FILE, lambda share: go_on(_FOOTPRINTS_SHARE * share))
    try:
        _write_footprints(folder / place / FOOTPRINTS_FILE, pieces, store.address.file(place + FOOTPRINTS_FILE))
    except NotThere as wrong:
        raise InvalidInput(
            tr("{address}: has no {name}").format(address=store.address.url, name=place + FOOTPRINTS_FILE)
        ) from wrong
    map_types = mission.imagery.map_types
    a_table = (1.0 - _FOOTPRINTS_SHARE) / len(map_types)
    for number, map_type in enumerate(map_types):
        before = _FOOTPRINTS_SHARE + number * a_table
        target = folder / place / map_type / TABLE_FILE
        _make_folder(target.parent)
        try:
            write_whole(
                target,
                store.pieces(
                    f"{place}{map_type}/{TABLE_FILE}",
                    lambda share, before=before: go_on(before + a_table * share),
                ),
            )
        except NotThere:
            target.unlink(missing_ok=True)


def _write_footprints(path: Path, pieces: Iterator[bytes], name: str) -> None:
    """Check footprints and write them: projects that show the copy open the file without further checks."""
    try:
        # With this ending, GDAL still recognises GeoJSON.
        with partial_file(path, ".new.geojson") as unchecked:
            write_whole(unchecked, checked_geojson(pieces, name))
            check_driver(unchecked)
    except OSError as wrong:
        raise OutputError("folder {0}: cannot write {1} ({2})", path.parent, path.name, wrong.strerror) from wrong


def _take_items(store: Store, folder: Path, mission: Mission, go_on: Progress) -> bool:
    """Write all files from the table of images; return False if the table does not exist or cannot be read."""
    items = folder / ITEMS_FILE
    try:
        write_whole(items, store.pieces(ITEMS_FILE, lambda share: go_on(_ITEMS_SHARE * share)))
        for map_type in mission.imagery.map_types:
            _make_folder(folder / map_type)
        write_from_items(
            items,
            folder,
            mission.imagery.map_types,
            lambda share: go_on(_ITEMS_SHARE + (1.0 - _ITEMS_SHARE) * share),
        )
    except (NotThere, InvalidInput):
        return False
    finally:
        items.unlink(missing_ok=True)
    return True


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as wrong:
        raise OutputError("folder {0}: cannot be made ({1})", folder, wrong.strerror) from wrong
