"""The dataset folder: what it must not hold before a capture, and what it holds of one already."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from ..errors import OutputError
from ..files import make_folder, write_whole
from ..mission.export import write_plan
from ..mission.mission import Mission
from ..mission.plan import Plan

MISSION_FILE = "mission.json"
JOURNAL_FILE = "journal.jsonl"
PLAN_FILE = "plan.csv"
FOOTPRINTS_FILE = "footprints.geojson"
TABLE_FILE = "meta_data.csv"


def open_folder(folder: str | os.PathLike[str], mission: Mission, *, resume: bool) -> Path:
    """Make a folder a mission's own, unless it holds something else.

    ``mission.json`` is the mark: it is written before anything else is.

    Returns
    -------
    Path
        The folder, with ``mission.json`` and a folder for each map type in it.

    Raises
    ------
    OutputError
        Where it cannot be written, holds another mission, holds this one and ``resume`` is not set, or holds
        foreign files in the places of ours.
    """
    path = Path(folder)
    make_folder(path)
    mark = path / MISSION_FILE
    wanted = mission.to_json().encode("utf-8")
    try:
        found = mark.read_bytes() if mark.exists() else None
    except OSError as wrong:
        raise OutputError(f"folder {folder}: cannot read {MISSION_FILE} ({wrong.strerror})") from wrong
    if found is None:
        _refuse_foreign(path, mission.map_types)
        write_whole(mark, wanted)
    elif found != wanted:
        raise OutputError(f"folder {folder}: holds another mission; choose another folder")
    elif not resume:
        raise OutputError(
            f"folder {folder}: already holds this mission; resume it (--resume) or choose another folder"
        )
    for map_type in mission.map_types:
        make_folder(path / map_type)
    return path


def _refuse_foreign(path: Path, map_types: Iterable[str]) -> None:
    for name in (JOURNAL_FILE, PLAN_FILE, FOOTPRINTS_FILE, *map_types):
        if (path / name).exists():
            raise OutputError(
                f"folder {path}: holds {name} but no {MISSION_FILE}, so it is not this mission's; choose another folder"
            )


def write_plan_files(folder: Path, plan: Plan) -> None:
    """Write the plan's table and footprints beside the mission."""
    write_plan(plan, folder / PLAN_FILE)
    write_plan(plan, folder / FOOTPRINTS_FILE)


def complete_pictures(folder: Path, endings: tuple[str, ...], names: Iterable[str]) -> set[str]:
    """Those of the named pictures that are in a folder with all their files, none of them empty."""
    try:
        with os.scandir(folder) as entries:
            whole = {entry.name for entry in entries if entry.stat().st_size > 0}
    except OSError as wrong:
        raise OutputError(f"folder {folder}: cannot be read ({wrong.strerror})") from wrong
    return {name for name in names if all(name + ending in whole for ending in endings)}
