"""Where the results of blocks go: whose place it is, which run is at work there, what is there already."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import Any

from ...arrays import Numbers
from ...dataset.folder import JOURNAL_FILE
from ...errors import InvalidInput, Message, OutputError
from ...limits import MAX_RECORD_BYTES, MAX_SETTINGS_BYTES
from ...mission.plan import Plan
from ...storage.files import json_bytes, read_each, read_if_there, write_whole
from ...storage.stores import is_address, is_file, sizes_in, store_path
from ...text.safe_json import parse_json
from ..begun import hold_to_mission
from ..choices import BLOCKS_FOLDER, DIVISION_FILE, FOLDERS, WEBDATASET
from ..folder import captured_mission, is_complete, open_place, sizes_of_pictures
from ..journal import FAILED
from ..writers import file_endings
from .block import Record, block_name


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
        self._mission = captured_mission(plan)
        self.root = open_place(address, self._mission, resume=resume)
        self._layout = FOLDERS

    def records(self, map_type: str, divided: Sequence[Numbers]) -> dict[int, Record]:
        """Records of the blocks that are there, whole, by number.

        Parameters
        ----------
        divided : sequence of Numbers
            Indices of the captures of each block.
        """
        there = sizes_in(self.root / BLOCKS_FOLDER)
        wanted = {number: f"{block_name(map_type, number)}.jsonl" for number in range(len(divided))}
        numbers = [number for number, name in wanted.items() if name in there]
        sizes = sizes_of_pictures(self.root / map_type)
        paths = [self.root / BLOCKS_FOLDER / wanted[number] for number in numbers]
        read = zip(numbers, read_each(paths, MAX_RECORD_BYTES))
        records = {number: Record.from_bytes(data or b"") for number, data in read}
        names = self._plan.names
        return {
            number: record
            for number, record in records.items()
            if record is not None
            and record.is_of(map_type, [names[index] for index in divided[number].tolist()])
            and self._is_whole(map_type, number, record, sizes)
        }

    def _is_whole(self, map_type: str, number: int, record: Record, sizes: dict[str, int]) -> bool:
        """Whether the files of a block are as long as they were when it was committed, and hold its images."""
        shard = f"{block_name(map_type, number)}.tar" if self._layout == WEBDATASET else ""
        if not record.fits(shard):
            return False
        if shard and record.shard_bytes:
            return sizes.get(shard) == record.shard_bytes
        endings = file_endings(self._plan.mission.output.image_format, on_map=self._plan.frames.on_map)
        return all(
            is_complete(one, endings, sizes) for one in record.outcomes.values() if one.status != FAILED
        )

    def check_division(self, layout: str, images: int) -> None:
        """Note how it is begun and divided, or refuse to go on in another way: asked once, before all else.

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
        self._check_blocks(layout, images)
        hold_to_mission(self.root, self._mission)

    def _check_blocks(self, layout: str, images: int) -> None:
        wanted: dict[str, Any] = {
            "layout_of_files": layout,
            "images": images,
            "captures": len(self._plan),
            "names_sha256": hashlib.sha256("\n".join(self._plan.names).encode("utf-8")).hexdigest(),
        }
        path = self.root / BLOCKS_FOLDER / DIVISION_FILE
        data = read_if_there(path, MAX_SETTINGS_BYTES)
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
        try:
            found = parse_json(data)
        except InvalidInput as wrong:
            raise self._unreadable(wrong) from wrong
        if not isinstance(found, dict):
            raise self._unreadable(Message("it holds no object"))
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

    def _unreadable(self, reason: object) -> OutputError:
        return OutputError(
            "{0}: its {1} cannot be read ({2}), so it is not known how it was begun",
            self._address,
            f"{BLOCKS_FOLDER}/{DIVISION_FILE}",
            reason,
            remedy="choose another folder",
        )


def check_in_blocks(address: str) -> None:
    """Raise OutputError where no capture in blocks is, of which something might have failed."""
    if not is_file(store_path(address) / BLOCKS_FOLDER / DIVISION_FILE):
        raise OutputError(
            "{0}: holds no capture in blocks of this mission, so nothing of it has failed",
            address,
            remedy="capture it first",
        )
