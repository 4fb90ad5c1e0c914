"""Unfinished captures, offered again after a crash: noted in the user's profile, or found in their folders."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QLockFile

from ...core.capture.choices import BLOCKS_FOLDER, DIVISION_FILE
from ...core.dataset.folder import JOURNAL_FILE, MISSION_FILE, PLAN_FILE, REJECTED_FOLDER
from ...core.errors import TerrAInavError
from ...core.limits import MAX_MISSION_BYTES, MAX_TABLE_BYTES
from ...core.mission.mission import Mission
from ...core.storage.files import lock_tried, open_foreign, read_limited, write_whole
from ...core.text.safe_json import parse_json
from ..i18n import tr
from ..messages import log
from ..paths import UNFINISHED, exists, is_remote, path_key
from ..settings import Settings
from ..sources import MissionPlans, plan_imageries
from ..tasks import Task
from .left import left_folders

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...core.geodesy.mercator import PixelGrid
    from .run import BackgroundRun

_NOTE, _LOCK = ".json", ".lock"
#: When this session began.
_BEGAN = time.time()


class Unfinished:
    """Notes of this session's captures; each note is removed when its capture ends.

    A lock file for each note shows other QGIS instances on this machine that the capture is running.
    """

    def __init__(self) -> None:
        self._locks: dict[BackgroundRun, QLockFile] = {}

    def note(self, run: BackgroundRun) -> None:
        """Note a queued run; a read-only profile does not prevent a capture."""
        if run.test_shot:
            return
        if not is_remote(run.folder):
            Settings().dismiss(run.folder, again=True)
        path = _notes() / f"{_digest(run.folder)}{_NOTE}"
        text = {
            "folder": str(run.folder),
            "images": run.images,
            "only_failed": run.only_failed,
            "mission": run.mission.to_dict(),
        }
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, json.dumps(text).encode())
        except (OSError, TerrAInavError) as wrong:
            log(tr("The capture could not be noted: {error}").format(error=wrong))
            return
        if not _is_held(path):
            _remove(path.with_suffix(_LOCK))
        self._locks[run] = _make_lock(path)
        self._locks[run].tryLock(0)

    def forget(self, run: BackgroundRun) -> None:
        """Remove the note of an ended run, whether it succeeded or failed."""
        lock = self._locks.pop(run, None)
        if lock is not None:
            _remove(_notes() / f"{_digest(run.folder)}{_NOTE}")
            lock.unlock()

    def close(self) -> None:
        """Leave the notes of unfinished captures to the next session."""
        for lock in self._locks.values():
            lock.unlock()
        self._locks.clear()


class UnfinishedCapture:
    """An unfinished capture of an earlier session.

    Attributes
    ----------
    folder : Path
    mission : Mission
    images : int or None
        Planned number of images; None if unknown, as if the capture stopped before its plan was written.
    there : int or None
        Number of existing images; None if not counted, as for folders on other machines.
    only_failed : bool
    """

    def __init__(
        self, path: Path | None, folder: Path, mission: Mission, images: int | None, only_failed: bool = False
    ) -> None:
        self._path, self.folder, self.mission = path, folder, mission
        self.images, self.only_failed = images, only_failed
        self.there: int | None = None

    @property
    def name(self) -> str:
        """Name for users."""
        return self.folder.name or str(self.folder)

    def forget(self) -> None:
        """Offer the capture no more; its images are kept."""
        if self._path is not None:
            _remove(self._path)
        if not is_remote(self.folder):
            Settings().dismiss(self.folder)

    def count(self) -> None:
        """Count the existing images without opening them."""
        ending = f".{self.mission.output.image_format}"
        self.there = sum(1 for one in _image_folders(self.folder, self.mission) for _ in one.glob(f"*{ending}"))


class FindTask(Task):
    """Find the unfinished captures.

    Attributes
    ----------
    found : list of UnfinishedCapture
    """

    def __init__(self) -> None:
        super().__init__(tr("Looking for captures that have not ended"))
        self.found: list[UnfinishedCapture] = []

    def work(self) -> None:
        """Read the notes, look into the folders last written to, and count images; changes nothing."""
        running = set()
        for path in sorted(_notes().glob(f"*{_NOTE}"), key=lambda path: path.stat().st_mtime):
            left = _read(path)
            if left is None:
                continue
            if _is_held(path):
                running.add(_digest(left.folder))
                continue
            if not is_remote(left.folder):
                left.count()
            self.found.append(left)
        known = running | {_digest(left.folder) for left in self.found}
        self.found += [left for folder in left_folders() if _digest(folder) not in known for left in _found(folder)]


class PlanTask(Task):
    """Plan an unfinished capture again.

    Attributes
    ----------
    plans : MissionPlans or None
        Set once the task has succeeded.
    """

    def __init__(self, mission: Mission, find_grids: dict[str, Callable[[], PixelGrid]]) -> None:
        super().__init__(tr("Planning"))
        self.plans: MissionPlans | None = None
        self._mission, self._find_grids = mission, find_grids

    def work(self) -> None:
        """Plan."""
        self.plans = plan_imageries(self._mission, self._find_grids)


def _read(path: Path) -> UnfinishedCapture | None:
    """Content of a note; None if it cannot be read."""
    try:
        note = parse_json(read_limited(path, MAX_MISSION_BYTES))
        mission = Mission.from_dict(note["mission"])
        return UnfinishedCapture(path, Path(note["folder"]), mission, int(note["images"]), bool(note["only_failed"]))
    except (OSError, KeyError, TypeError, ValueError, TerrAInavError) as wrong:
        log(tr("{path}: a note of a capture cannot be read ({error})").format(path=path, error=wrong))
        return None


def _found(folder: Path) -> list[UnfinishedCapture]:
    """The unfinished capture in a folder, if this session can resume it and no other program is running it."""
    if any(exists(folder / name) for name in (BLOCKS_FOLDER, DIVISION_FILE)):
        return []
    try:
        mission = Mission.from_json(read_limited(folder / MISSION_FILE, MAX_MISSION_BYTES).decode("utf-8"))
        with lock_tried(folder / JOURNAL_FILE) as is_free:
            if not is_free:
                return []
    except (OSError, ValueError, TerrAInavError):
        # Foreign files, or a folder that may not be written.
        return []
    left = UnfinishedCapture(None, folder, mission, _count_planned(folder, mission))
    left.count()
    rejected = sum(1 for one in _image_folders(folder, mission) for _ in (one / REJECTED_FOLDER).glob("*.*"))
    # Copies of datasets have files of any age: those with all their images have ended.
    return [left] if left.images is None or (left.there or 0) + rejected < left.images else []


def _count_planned(folder: Path, mission: Mission) -> int | None:
    """Planned number of images, by the lines of the plans; None if one was not written."""
    captures = 0
    try:
        for dataset, kinds in Counter(one.parent for one in _image_folders(folder, mission)).items():
            with open_foreign(dataset / PLAN_FILE, MAX_TABLE_BYTES) as lines:
                captures += kinds * (sum(1 for _ in lines) - 1)
    except (OSError, TerrAInavError):
        return None
    return captures


def _image_folders(folder: Path, mission: Mission) -> list[Path]:
    """Folder of each map type, of each of several imageries."""
    if mission.imagery.imageries:
        return [folder / one.name / one.map_type for one in mission.imagery.named]
    return [folder / map_type for map_type in mission.imagery.map_types]


def _notes() -> Path:
    return Path(QgsApplication.qgisSettingsDirPath()) / UNFINISHED


def _digest(folder: Path) -> str:
    # Do not resolve links in a folder on another machine: that would access the network.
    place = str(folder) if is_remote(folder) else path_key(folder)
    return hashlib.sha256(place.encode("utf-8", "surrogatepass")).hexdigest()[:16]


def _make_lock(path: Path) -> QLockFile:
    lock = QLockFile(str(path.with_suffix(_LOCK)))
    # A lock never expires, as a capture may take days; Qt detects the lock of a crashed QGIS by its process.
    lock.setStaleLockTime(0)
    return lock


def _is_held(path: Path) -> bool:
    """Whether a session that is still there holds the lock of a note."""
    lock = _make_lock(path)
    if lock.tryLock(0):
        lock.unlock()
        return False
    known, process, *_ = lock.getLockInfo()
    try:
        is_earlier = path.with_suffix(_LOCK).stat().st_mtime < _BEGAN
    except OSError:
        is_earlier = True
    # In a sandbox such as Flatpak, QGIS has the same number each time, so Qt takes this process for the one that died.
    return not (known and process == os.getpid() and is_earlier)


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as wrong:
        log(tr("The capture could not be noted: {error}").format(error=wrong))
