"""The dataset folder: what its files are called, and which map types it holds."""

from __future__ import annotations

import os
from pathlib import Path

from ..errors import InvalidInput

MISSION_FILE = "mission.json"
JOURNAL_FILE = "journal.jsonl"
PLAN_FILE = "plan.csv"
FOOTPRINTS_FILE = "footprints.geojson"
TABLE_FILE = "meta_data.csv"
#: Beside the images of a map type: those that cleaning has moved out of the way.
REJECTED_FOLDER = "rejected"


def map_type_folders(folder: str | os.PathLike[str]) -> dict[str, Path]:
    """Folders of a dataset's map types by name: those with a table, or the folder itself where it has one.

    Raises
    ------
    InvalidInput
        A folder that is no dataset, or one map type of a dataset of which the others may matter.
    """
    path = Path(folder)
    try:
        if (path / TABLE_FILE).is_file():
            # A name like `.` tells nothing.
            parent = path.resolve().parent
            if (parent / MISSION_FILE).is_file():
                raise InvalidInput(f"folder {folder}: is one map type of the dataset {parent}; give that one")
            return {path.resolve().name: path}
        found = sorted(one for one in path.iterdir() if (one / TABLE_FILE).is_file())
    except OSError as wrong:
        raise InvalidInput(f"folder {folder}: cannot be read ({wrong.strerror})") from wrong
    if not found:
        raise InvalidInput(
            f"folder {folder}: is no dataset, as neither it nor a folder in it has a {TABLE_FILE}; give the folder "
            "of a capture"
        )
    return {one.name: one for one in found}
