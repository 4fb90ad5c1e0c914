"""The dataset folder: what it must not hold before a capture, and what it holds of one already."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from ..dataset.folder import FOOTPRINTS_FILE, JOURNAL_FILE, MISSION_FILE, PLAN_FILE, REJECTED_FOLDER
from ..errors import InvalidInput, Message, OptionName, OutputError
from ..geodesy.mercator import WebMercator
from ..limits import MAX_MISSION_BYTES
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..storage.files import PARTIAL_ENDING, make_folder, open_locked, read_if_there, read_limited, write_whole
from ..storage.stores import is_address, put_new, sizes_in, store_path
from .begun import edited_since
from .choices import BLOCKS_FOLDER, DIVISION_FILE
from .journal import Outcome

#: What a run has in an object store while it is at work there.
LOCK_FILE = "run.lock"


def open_folder(folder: str | os.PathLike[str], mission: Mission, *, resume: bool) -> Path:
    """Make a folder a mission's own, unless it holds something else.

    ``mission.json`` is the mark: it is written before anything else is.

    Returns
    -------
    Path
        The folder, with ``mission.json`` and a folder for each map type and product in it.

    Raises
    ------
    OutputError
        Where it cannot be written, holds another mission, holds this one and ``resume`` is not set, or holds
        foreign files in the places of ours.
    """
    path = Path(folder)
    make_folder(path)
    imagery = mission.imagery
    folders = tuple(one.name for one in imagery.named) or (*imagery.map_types, *mission.output.products)
    wanted = mission.to_json().encode("utf-8")
    found = _mark_of(path)
    if found is None:
        _refuse_foreign(path, folders)
        # Of two runs that find the folder empty at the same time, one makes it its own and the other finds it so.
        with open_locked(path / JOURNAL_FILE):
            found = _mark_of(path)
            if found is None:
                write_whole(path / MISSION_FILE, wanted, durable=True)
                found, resume = wanted, True
    if not is_of(found, mission):
        raise edited_since(path, found, mission) or OutputError(
            "folder {0}: holds another mission", folder, remedy="choose another folder"
        )
    if not resume:
        raise OutputError(
            "folder {0}: already holds this mission",
            folder,
            remedy=Message("resume it{0} or choose another folder", OptionName("resume").in_brackets),
        )
    for name in folders:
        make_folder(path / name)
    return path


def open_place(address: str | os.PathLike[str], mission: Mission, *, resume: bool) -> Path:
    """Make a folder, or an object store's, a mission's own: `open_folder`, and the same of an address."""
    if not is_address(address):
        return open_folder(address, mission, resume=resume)
    path = store_path(address)
    found, wanted = read_if_there(path / MISSION_FILE, MAX_MISSION_BYTES), mission.to_json().encode("utf-8")
    if found is None:
        foreign = min((name for name in sizes_in(path) if name != LOCK_FILE), default=None)
        if foreign is not None:
            raise OutputError(
                "address {0}: holds {1} but no {2}, so it is not this mission's",
                address,
                foreign,
                MISSION_FILE,
                remedy="choose another one",
            )
        # Of two runs that find nothing, one puts its mark and the other finds it.
        if put_new(path / MISSION_FILE, wanted):
            return path
        found = read_if_there(path / MISSION_FILE, MAX_MISSION_BYTES) or b""
    if not is_of(found, mission):
        raise edited_since(path, found, mission) or OutputError(
            "address {0}: holds another mission", address, remedy="choose another one"
        )
    if not resume:
        raise OutputError(
            "address {0}: already holds this mission",
            address,
            remedy=Message("resume it{0} or choose another one", OptionName("resume").in_brackets),
        )
    return path


def has_blocks(folder: Path) -> bool:
    """Whether a folder of this machine was captured in blocks."""
    return (folder / BLOCKS_FOLDER / DIVISION_FILE).is_file()


def captured_mission(plan: Plan) -> Mission:
    """Mission of a plan as its dataset states it: with the coordinate reference system, if the source has its own.

    Of pixels that are not the Web-Mercator map's in EPSG:3857 it is left to the source, as that code names the map's.
    """
    crs = plan.grid.plane.crs
    if crs == WebMercator.crs or plan.mission.imagery.crs:
        return plan.mission
    return plan.mission.with_(crs=crs)


def is_of(mark: bytes, mission: Mission) -> bool:
    """Whether a folder's ``mission.json`` is of a mission as `captured_mission` has it.

    One that leaves the coordinate reference system to the source is of those that state it: whether its images are the
    same ones is found when these are looked at.
    """
    try:
        if mark == mission.to_json().encode("utf-8"):
            return True
        found = Mission.from_json(mark.decode("utf-8"))
    except (InvalidInput, UnicodeDecodeError):
        return False
    return found == mission or found.with_(crs=found.imagery.crs or mission.imagery.crs) == mission


def holds_mission_of(plan: Plan, folder: Path) -> bool | None:
    """Whether a folder is a dataset of a plan's mission; None where it is of none, or that cannot be read."""
    try:
        mark = _mark_of(folder)
    except OutputError:
        return None
    return None if mark is None else is_of(mark, captured_mission(plan))


def check_captured(folder: str | os.PathLike[str]) -> None:
    """Raise OutputError where a folder holds no capture, of which something might have failed."""
    path = Path(folder)
    if _mark_of(path) is None or not (path / JOURNAL_FILE).is_file():
        raise OutputError(
            "folder {0}: holds no capture of this mission, so nothing of it has failed",
            folder,
            remedy="capture it first",
        )


def _mark_of(path: Path) -> bytes | None:
    mark = path / MISSION_FILE
    try:
        return read_limited(mark, MAX_MISSION_BYTES) if mark.exists() else None
    except (OSError, InvalidInput) as wrong:
        raise OutputError(
            "folder {0}: cannot read {1} ({2})", path, MISSION_FILE, getattr(wrong, "strerror", None) or wrong
        ) from wrong


def _refuse_foreign(path: Path, folders: Iterable[str]) -> None:
    for name in (JOURNAL_FILE, PLAN_FILE, FOOTPRINTS_FILE, *folders):
        found = path / name
        # A run that was killed as it began leaves an empty journal.
        if not found.exists() or (name == JOURNAL_FILE and found.is_file() and found.stat().st_size == 0):
            continue
        # What a run makes comes after its mark: one that has begun meanwhile is told from foreign files by that.
        if _mark_of(path) is None:
            raise OutputError(
                "folder {0}: holds {1} but no {2}, so it is not this mission's",
                path,
                name,
                MISSION_FILE,
                remedy="choose another folder",
            )


def complete_pictures(folder: Path, endings: tuple[str, ...], outcomes: Mapping[str, Outcome]) -> set[str]:
    """Those of the pictures that are there with all their files, as long as they were when they were written.

    Pictures that cleaning has moved are there, and some files of one that it was moving. What a killed run was writing
    is removed; so this is for the run that has the journal open.

    Parameters
    ----------
    folder : Path
        Of a map type.
    endings : tuple of str
        Of all files of a picture.
    outcomes : mapping of str to Outcome
        By the picture's name.
    """
    partial = tuple(ending + PARTIAL_ENDING for ending in endings)
    sizes = sizes_of_pictures(folder)
    for name in [name for name in sizes if name.endswith(partial)]:
        with contextlib.suppress(OSError):
            (folder / name).unlink()
    return {name for name, outcome in outcomes.items() if is_complete(outcome, endings, sizes)}


def sizes_of_pictures(folder: Path) -> dict[str, int]:
    """Bytes of the files of a map type's folder, by name, and of those that cleaning has moved out of the way."""
    return {**sizes_in(folder / REJECTED_FOLDER), **sizes_in(folder)}


def is_complete(outcome: Outcome, endings: tuple[str, ...], sizes: Mapping[str, int]) -> bool:
    """Whether all files of a picture that was made are there, as long as they were then."""
    lengths = [sizes.get(outcome.name + ending, 0) for ending in endings]
    return all(lengths) and outcome.size_bytes in (0, sum(lengths))


def remove_picture(folder: Path, endings: tuple[str, ...], name: str) -> None:
    """Remove all files of a picture of a map type's folder, wherever cleaning has put them; raises OutputError."""
    for place in (folder, folder / REJECTED_FOLDER):
        for ending in reversed(endings):
            path = place / (name + ending)
            try:
                path.unlink(missing_ok=True)
            except OSError as wrong:
                raise OutputError(
                    "file {0}: cannot be removed ({1})", path, wrong.strerror, remedy="close what shows it"
                ) from wrong
