"""Unfinished captures, noted in the user's profile so that they can be offered again after a crash."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QLockFile

from ...core.errors import TerrAInavError
from ...core.limits import MAX_MISSION_BYTES
from ...core.mission.mission import Mission
from ...core.storage.files import read_limited, write_whole
from ...core.text.safe_json import parse_json
from ..i18n import tr
from ..messages import log
from ..paths import UNFINISHED, is_remote, path_key
from ..sources import plan_mission
from ..tasks import Task

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...core.geodesy.mercator import PixelGrid
    from ...core.mission.plan import Plan
    from .run import BackgroundRun

_NOTE, _LOCK = ".json", ".lock"


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
        path = _notes() / f"{_digest(run.folder)}{_NOTE}"
        text = {
            "folder": str(run.folder),
            "images": len(run.plan) * len(run.mission.imagery.map_types),
            "only_failed": run.only_failed,
            "mission": run.mission.to_dict(),
        }
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, json.dumps(text).encode())
        except (OSError, TerrAInavError) as wrong:
            log(tr("The capture could not be noted: {error}").format(error=wrong))
            return
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
    images : int
        Planned number of images.
    there : int or None
        Number of existing images; None if not counted, as for folders on other machines.
    only_failed : bool
    """

    def __init__(self, path: Path, folder: Path, mission: Mission, images: int, only_failed: bool) -> None:
        self._path, self.folder, self.mission = path, folder, mission
        self.images, self.only_failed = images, only_failed
        self.there: int | None = None

    @property
    def name(self) -> str:
        """Name for users."""
        return self.folder.name or str(self.folder)

    def forget(self) -> None:
        """Remove the note, but no images."""
        _remove(self._path)

    def count(self) -> None:
        """Count the existing images without opening them."""
        ending = f".{self.mission.output.image_format}"
        folders = [self.folder / map_type for map_type in self.mission.imagery.map_types]
        self.there = sum(1 for folder in folders for _ in folder.glob(f"*{ending}"))


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
        """Read the notes, and count the images of each capture; changes nothing."""
        for path in sorted(_notes().glob(f"*{_NOTE}"), key=lambda path: path.stat().st_mtime):
            lock = _make_lock(path)
            if not lock.tryLock(0):
                continue
            lock.unlock()
            left = _read(path)
            if left is None:
                continue
            if not is_remote(left.folder):
                left.count()
            self.found.append(left)


class PlanTask(Task):
    """Plan an unfinished capture again.

    Attributes
    ----------
    plan : Plan or None
        Set once the task has succeeded.
    """

    def __init__(self, mission: Mission, find_grid: Callable[[], PixelGrid]) -> None:
        super().__init__(tr("Planning"))
        self.plan: Plan | None = None
        self._mission, self._find_grid = mission, find_grid

    def work(self) -> None:
        """Plan."""
        self.plan = plan_mission(self._mission, self._find_grid)


def _read(path: Path) -> UnfinishedCapture | None:
    """Content of a note; None if it cannot be read."""
    try:
        note = parse_json(read_limited(path, MAX_MISSION_BYTES))
        mission = Mission.from_dict(note["mission"])
        return UnfinishedCapture(path, Path(note["folder"]), mission, int(note["images"]), bool(note["only_failed"]))
    except (OSError, KeyError, TypeError, ValueError, TerrAInavError) as wrong:
        log(tr("{path}: a note of a capture cannot be read ({error})").format(path=path, error=wrong))
        return None


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


def _remove(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as wrong:
        log(tr("The capture could not be noted: {error}").format(error=wrong))
