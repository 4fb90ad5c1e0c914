"""Where the results of blocks go: whose place it is, which run is at work there, what is there already."""

from __future__ import annotations

import hashlib
import json
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...dataset.folder import JOURNAL_FILE
from ...errors import OutputError
from ...files import json_bytes, open_locked, write_whole
from ...mission.plan import Plan
from ...safe_json import parse_json
from ...stores import get, is_address, put, put_new, remove, sizes_in, store_path
from ..choices import FOLDERS, WEBDATASET
from ..folder import LOCK_FILE, captured_mission, is_complete, open_place, sizes_of_pictures
from ..journal import FAILED
from ..writers import file_endings
from .block import BLOCKS_FOLDER, Record, block_name

#: What says how a destination is divided into blocks.
DIVISION_FILE = "blocks.json"
#: Seconds between a run's signs of life, and after how many without one it counts as dead.
BEAT_S, DEAD_S = 5.0, 30.0
#: Records that are read at once.
_READ_AT_ONCE = 16


class Destination:
    """A folder or an object store's, opened for one run, which is to hold it (`held`).

    Parameters
    ----------
    address : str
    plan : Plan
    resume : bool

    Raises
    ------
    OutputError
        It cannot be written, holds another mission, or this one without ``resume``.
    """

    def __init__(self, address: str, plan: Plan, *, resume: bool) -> None:
        self._address, self._plan = address, plan
        self.root = open_place(address, captured_mission(plan), resume=resume)
        self._layout = FOLDERS

    def records(self, map_type: str, count: int) -> dict[int, Record]:
        """Records of the blocks that are there, whole, by number.

        Parameters
        ----------
        count : int
            How many blocks there are.
        """
        there = sizes_in(self.root / BLOCKS_FOLDER)
        wanted = {number: f"{block_name(map_type, number)}.jsonl" for number in range(count)}
        numbers = [number for number, name in wanted.items() if name in there]
        sizes = sizes_of_pictures(self.root / map_type)
        with ThreadPoolExecutor(_READ_AT_ONCE) as threads:
            read = threads.map(lambda number: get(self.root / BLOCKS_FOLDER / wanted[number]), numbers)
            records = {number: Record.from_bytes(data or b"") for number, data in zip(numbers, read)}
        return {
            number: record
            for number, record in records.items()
            if record is not None and self._is_whole(map_type, number, record, sizes)
        }

    def _is_whole(self, map_type: str, number: int, record: Record, sizes: dict[str, int]) -> bool:
        """Whether the files of a block are as long as they were when it was committed."""
        if self._layout == WEBDATASET and record.shard_bytes:
            return sizes.get(f"{block_name(map_type, number)}.tar") == record.shard_bytes
        endings = file_endings(self._plan.mission.output.image_format, on_map=self._plan.size_px is None)
        return all(
            is_complete(one, endings, sizes) for one in record.outcomes.values() if one.status != FAILED
        )

    def check_division(self, layout: str, images: int) -> None:
        """Note how it is divided, or refuse to go on in another way than it was begun: asked once, before all else.

        Parameters
        ----------
        layout : str
            One of `choices.LAYOUTS`.
        images : int
            Of a block at most.

        Raises
        ------
        OutputError
            It was begun in another way, or captured without blocks.
        """
        self._layout = layout
        wanted: dict[str, Any] = {
            "layout_of_files": layout,
            "images": images,
            "captures": len(self._plan),
            "names_sha256": hashlib.sha256("\n".join(self._plan.names).encode("utf-8")).hexdigest(),
        }
        path = self.root / BLOCKS_FOLDER / DIVISION_FILE
        data = get(path)
        if data is None:
            if not is_address(self.root):
                if sizes_in(self.root).get(JOURNAL_FILE):
                    raise OutputError(
                        "folder {0}: was captured without blocks",
                        self._address,
                        remedy="choose another folder",
                    )
                path.parent.mkdir(exist_ok=True)
            write_whole(path, json_bytes(wanted))
            return
        found = parse_json(data)
        if found == wanted:
            return
        if [found.get(name) for name in ("captures", "names_sha256")] != [
            wanted[name] for name in ("captures", "names_sha256")
        ]:
            raise OutputError(
                "{0}: holds this mission with other images, because the source or the version was another",
                self._address,
                remedy="choose another one",
            )
        raise OutputError(
            "{0}: was begun with the layout {1} and blocks of {2} images: it goes on with the same",
            self._address,
            found.get("layout_of_files"),
            found.get("images"),
        )


def has_blocks(folder: Path) -> bool:
    """Whether a folder of this machine was captured in blocks."""
    return (folder / BLOCKS_FOLDER / DIVISION_FILE).is_file()


def check_in_blocks(address: str) -> None:
    """Raise OutputError where no capture in blocks is, of which something might have failed."""
    if get(store_path(address) / BLOCKS_FOLDER / DIVISION_FILE) is None:
        raise OutputError(
            "{0}: holds no capture in blocks of this mission, so nothing of it has failed",
            address,
            remedy="capture it first",
        )


@contextmanager
def held(root: Path) -> Iterator[Callable[[], None]]:
    """Hold a place against other runs meanwhile; yields what raises OutputError where another has taken it.

    Raises
    ------
    OutputError
        Another run is at work there.
    """
    if not is_address(root):
        with open_locked(root / JOURNAL_FILE):
            yield lambda: None
        return
    with _Lease(root / LOCK_FILE) as lease:
        yield lease.check


class _Lease:
    """An object that only one run has, and which it changes as a sign that it is alive.

    Object stores have no locks, but put an object only if there is none. A run that dies leaves its own: who finds one
    watches it, and takes it over where it does not change for longer than a run that is alive would let it be. Nothing
    depends on clocks of different machines.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._token = uuid.uuid4().hex
        self._beats = 0
        self._ended = threading.Event()
        self._lost: OutputError | None = None
        self._thread = threading.Thread(target=self._beat, name="terrainav-lease", daemon=True)

    def __enter__(self) -> _Lease:
        if not put_new(self._path, self._content()):
            self._take_over()
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        # Another run may have taken over since the last beat.
        if self._lost is None and self._is_own(get(self._path)):
            remove(self._path)

    def check(self) -> None:
        """Raise OutputError where another run has taken the place, or it can be written no more."""
        if self._lost is not None:
            raise self._lost

    def _content(self) -> bytes:
        return json.dumps({"run": self._token, "beat": self._beats}).encode("ascii")

    def _take_over(self) -> None:
        found = get(self._path)
        until_s = time.monotonic() + DEAD_S
        while time.monotonic() < until_s:
            time.sleep(BEAT_S / 5.0)
            now = get(self._path)
            if now != found and now is not None:
                raise self._busy()
            if now is None:
                if put_new(self._path, self._content()):
                    return
                raise self._busy()
        # Of two that take over at once the last one to put has it; the other finds that out before it begins.
        put(self._path, self._content())
        time.sleep(BEAT_S / 5.0)
        if get(self._path) != self._content():
            raise self._busy()

    def _busy(self) -> OutputError:
        return OutputError(
            "address {0}: another run is at work there", self._path.parent, remedy="wait until it has ended"
        )

    def _is_own(self, found: bytes | None) -> bool:
        return found is not None and self._token.encode("ascii") in found

    def _beat(self) -> None:
        heard_s = time.monotonic()
        while self._lost is None and not self._ended.wait(BEAT_S):
            wrong = self._signed()
            if wrong is None:
                heard_s = time.monotonic()
            # A store may be out of reach for a moment; by then others may take this run for dead.
            elif time.monotonic() - heard_s > DEAD_S - BEAT_S:
                self._lost = wrong

    def _signed(self) -> OutputError | None:
        """Give a sign of life, unless another run has taken over; what was wrong with that, if anything."""
        try:
            found = get(self._path)
            if found is not None and not self._is_own(found):
                self._lost = OutputError(
                    "address {0}: another run has taken over, as this one gave no sign of life for {1:g} s",
                    self._path.parent,
                    DEAD_S,
                )
                return self._lost
            self._beats += 1
            put(self._path, self._content())
        except OutputError as wrong:
            return wrong
        return None
