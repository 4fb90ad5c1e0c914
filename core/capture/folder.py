"""Folder of a capture, on this machine or in an object store, which a mission claims and a run holds."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

from ..dataset.folder import FOOTPRINTS_FILE, JOURNAL_FILE, MISSION_FILE, PLAN_FILE
from ..errors import InvalidInput, Message, OptionName, OutputError
from ..geodesy.contract import CAMERA_FILE
from ..geodesy.mercator import WebMercator
from ..limits import MAX_MISSION_BYTES
from ..map_types import twin_type
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..storage.files import make_folder, open_locked, read_existing, write_whole
from ..storage.stores import is_address, list_sizes, place_kind, put_new
from .begun import check_mission, edited_since
from .choices import BLOCKS_FOLDER, DIVISION_FILE
from .holding import Lease, locked


class CaptureFolder(ABC):
    """Folder that a mission claims, and that one run at a time holds.

    Parameters
    ----------
    root : Path
        Path returned by `store_path`.
    """

    def __init__(self, root: Path) -> None:
        self.root = root

    def claim(self, mission: Mission, *, resume: bool) -> None:
        """Claim the folder for a mission: write ``mission.json``, then make a folder for each map type and product.

        Raises
        ------
        OutputError
            The folder cannot be written, holds another mission, holds this mission without ``resume``, or holds other
            files where the capture writes.
        """
        make_folder(self.root)
        imagery = mission.imagery
        twins = [twin_type(map_type, kind) for map_type in imagery.map_types for kind in mission.varied.twins]
        folders = tuple(one.name for one in imagery.named) or (*imagery.map_types, *twins, *mission.products)
        wanted = mission.to_json().encode("utf-8")
        found = self._read_mark()
        if found is None:
            foreign = self._find_foreign(folders)
            # The folders of a run that began meanwhile are not foreign: that run wrote its mark first.
            if foreign is not None and self._read_mark() is None:
                raise OutputError(
                    "{0} {1}: holds {2} but no {3}, so it is not this mission's",
                    place_kind(self.root),
                    self.root,
                    foreign,
                    MISSION_FILE,
                    remedy="choose another folder",
                )
            # If two runs find no mark at the same time, one writes it and the other finds it.
            if self._write_mark(wanted):
                found, resume = wanted, True
            else:
                found = self._read_mark() or b""
        if not is_mark(found, mission):
            raise edited_since(self.root, found, mission) or OutputError(
                "{0} {1}: holds another mission",
                place_kind(self.root),
                self.root,
                remedy="choose another folder",
            )
        if not resume:
            raise OutputError(
                "{0} {1}: already holds this mission",
                place_kind(self.root),
                self.root,
                remedy=Message("resume it{0} or choose another folder", OptionName("resume").in_brackets),
            )
        for name in folders:
            make_folder(self.root / name)

    @contextmanager
    def opened(self, mission: Mission, *, resume: bool) -> Iterator[Callable[[], None]]:
        """Claim the folder and hold it; yields a function that raises OutputError if another run has taken it."""
        self.claim(mission, resume=resume)
        with self.held() as check:
            check_mission(self.root, mission)
            yield check

    def _read_mark(self) -> bytes | None:
        try:
            return read_existing(self.root / MISSION_FILE, MAX_MISSION_BYTES)
        except InvalidInput as wrong:
            raise OutputError("{0}", wrong) from wrong

    @abstractmethod
    def held(self) -> AbstractContextManager[Callable[[], None]]:
        """Keep other runs out; yields the same as `opened`."""

    @abstractmethod
    def _find_foreign(self, folders: Collection[str]) -> str | None:
        """Name of a file or folder that a new capture would overwrite, or None."""

    @abstractmethod
    def _write_mark(self, mark: bytes) -> bool:
        """Write ``mission.json`` unless it exists; returns whether it was written."""


class LocalFolder(CaptureFolder):
    """Local folder, held by the lock of its journal."""

    def held(self) -> AbstractContextManager[Callable[[], None]]:
        """Keep other runs out by the lock of the journal."""
        return locked(self.root / JOURNAL_FILE)

    def _find_foreign(self, folders: Collection[str]) -> str | None:
        for name in (JOURNAL_FILE, PLAN_FILE, FOOTPRINTS_FILE, CAMERA_FILE, *folders):
            path = self.root / name
            # A run that was killed at its start leaves an empty journal.
            if path.exists() and not (name == JOURNAL_FILE and path.is_file() and not path.stat().st_size):
                return name
        return None

    def _write_mark(self, mark: bytes) -> bool:
        with open_locked(self.root / JOURNAL_FILE):
            if self._read_mark() is not None:
                return False
            write_whole(self.root / MISSION_FILE, mark, durable=True)
            return True


class StoreFolder(CaptureFolder):
    """Folder of an object store, held by a lease, and claimed by an object that only one run can put."""

    _lock_file = "run.lock"

    @contextmanager
    def held(self) -> Iterator[Callable[[], None]]:
        """Keep other runs out by a lease."""
        with Lease(self.root / self._lock_file) as lease:
            yield lease.check

    def _find_foreign(self, _: Collection[str]) -> str | None:
        return min((name for name in list_sizes(self.root) if name != self._lock_file), default=None)

    def _write_mark(self, mark: bytes) -> bool:
        return put_new(self.root / MISSION_FILE, mark)


def capture_folder(root: Path) -> CaptureFolder:
    """Return the folder at a local path or an address."""
    return StoreFolder(root) if is_address(root) else LocalFolder(root)


def has_blocks(folder: Path) -> bool:
    """Whether a local folder was captured in blocks."""
    return (folder / BLOCKS_FOLDER / DIVISION_FILE).is_file()


def captured_mission(plan: Plan) -> Mission:
    """Mission of a plan as its dataset states it: with the CRS of the source, unless that is EPSG:3857.

    In missions, this code means the Web-Mercator map, so missions on other pixel grids in EPSG:3857 state no CRS.
    """
    crs = plan.grid.plane.crs
    if crs == WebMercator.crs or plan.mission.imagery.crs:
        return plan.mission
    return plan.mission.replace(crs=crs)


def is_mark(mark: bytes, mission: Mission) -> bool:
    """Whether the content of ``mission.json`` is a mission from `captured_mission`.

    A mission without a CRS also matches a mission that states the CRS of the source, as images of another CRS have
    other names.
    """
    try:
        if mark == mission.to_json().encode("utf-8"):
            return True
        found = Mission.from_json(mark.decode("utf-8"))
    except (InvalidInput, UnicodeDecodeError):
        return False
    return found == mission or found.replace(crs=found.imagery.crs or mission.imagery.crs) == mission


def holds_mission(mission: Mission, folder: Path) -> bool | None:
    """Whether a folder is a dataset of a mission, as `captured_mission` states it; None without a readable mission."""
    try:
        mark = read_existing(folder / MISSION_FILE, MAX_MISSION_BYTES)
    except (InvalidInput, OutputError):
        return None
    return None if mark is None else is_mark(mark, mission)


def check_captured(root: Path) -> None:
    """Raise OutputError if a local folder holds no capture."""
    if not ((root / MISSION_FILE).is_file() and (root / JOURNAL_FILE).is_file()):
        raise OutputError(
            "folder {0}: holds no capture of this mission, so nothing of it has failed",
            root,
            remedy="capture it first",
        )
