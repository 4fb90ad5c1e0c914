"""Folders of captures that did not end, found by their files: no table is as new as the journal.

So captures of Processing, of the command line or of another profile are found too, which have no note in this profile.
"""

from __future__ import annotations

import os
from itertools import islice
from pathlib import Path

from ...core.dataset.folder import JOURNAL_FILE, MISSION_FILE, TABLE_FILE
from ...core.errors import InvalidInput
from ...core.text.safe_json import parse_json
from ..paths import entered_folder, exists, is_remote, path_key
from ..settings import Settings

#: Number of folders, the last written to, that are looked at, and largest number of names read in a folder.
_LATEST, _MOST_NAMES = 8, 2_000


def left_folders() -> list[Path]:
    """Folders last written to whose capture did not end, the oldest first, beside the panel's mission or by default.

    Folders that the user has dismissed, and folders on other machines, are left out.
    """
    settings = Settings()
    places = {path_key(place): place for place in (settings.missions, *_panel_place(settings)) if not is_remote(place)}
    written = {path_key(folder): (at, folder) for place in places.values() for at, folder in _journals(place)}
    latest = sorted(written.values())[-_LATEST:]
    return [
        folder for at, folder in latest if path_key(folder) not in settings.dismissed and not _has_ended(folder, at)
    ]


def _panel_place(settings: Settings) -> list[Path]:
    try:
        folder = str(parse_json(settings.form or "{}").get("folder") or "")
    except (InvalidInput, AttributeError):
        return []
    return [entered_folder(folder).parent] if folder else []


def _journals(place: Path) -> list[tuple[float, Path]]:
    """Captures in a folder, with the time when their journals were last written."""
    found = []
    try:
        with os.scandir(place) as entries:
            for entry in islice(entries, _MOST_NAMES):
                at = _written(Path(entry.path, JOURNAL_FILE))
                if at and exists(Path(entry.path, MISSION_FILE)):
                    found.append((at, Path(entry.path)))
    except OSError:
        return []
    return found


def _has_ended(folder: Path, journal_at: float) -> bool:
    """Whether a run wrote its tables, as it does at its end, also when it is stopped."""
    try:
        with os.scandir(folder) as entries:
            return max((_written(Path(entry.path, TABLE_FILE)) for entry in entries), default=0.0) >= journal_at
    except OSError:
        return True


def _written(path: Path) -> float:
    """Time when a file was last written; 0 if there is none."""
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
