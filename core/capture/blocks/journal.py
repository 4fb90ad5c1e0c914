"""Journal of a capture in blocks: a record for each block, in a local folder or an object store."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...dataset.folder import JOURNAL_FILE
from ...errors import InvalidInput, Message, OutputError
from ...imagery.placeholder import Placeholder, noted_digests
from ...limits import MAX_RECORD_BYTES, MAX_SETTINGS_BYTES
from ...map_types import twin_type
from ...mission.plan import Plan
from ...storage.files import json_bytes, read_each, read_existing, write_whole
from ...storage.stores import is_address, is_file, list_sizes
from ...text.safe_json import parse_json
from ..choices import BLOCKS_FOLDER, DIVISION_FILE, WEBDATASET
from ..folder import capture_folder, captured_mission
from ..images import CaptureJournal, file_sizes, image_endings, is_complete
from ..journal import FAILED, Outcome
from ..making import Piece
from .block import Record, block_name, shard_name
from .division import divide
from .shards import INDEX_FILE, shard_index


class BlockJournal(CaptureJournal):
    """Journal with a record for each block, which the block's maker commits.

    Parameters
    ----------
    plan : Plan
    root : Path
    layout : str
        One of `choices.LAYOUTS`.
    block_images : int
        Most images of a block.
    hold : callable
        Raises OutputError if another run has taken the place.

    Raises
    ------
    OutputError
        The place was captured without blocks, or with other blocks.
    """

    def __init__(self, plan: Plan, root: Path, layout: str, block_images: int, hold: Callable[[], None]) -> None:
        self.root, self.images, self.in_shards = root, len(plan), layout == WEBDATASET
        self._plan, self._hold = plan, hold
        self._divided = divide(plan.windows, block_images)
        self._endings = image_endings(plan)
        # Number of images, and bytes, of each shard, by map type and number of the block.
        self._shards: defaultdict[str, dict[int, tuple[int, int]]] = defaultdict(dict)
        self._check_division(layout, block_images)

    @classmethod
    @contextmanager
    def opened(
        cls, plan: Plan, root: Path, layout: str, block_images: int, *, resume: bool, only_failed: bool
    ) -> Iterator[BlockJournal]:
        """Claim a place for a plan and open its journal, which keeps other runs out; raises OutputError."""
        if only_failed and not is_file(root / BLOCKS_FOLDER / DIVISION_FILE):
            raise OutputError(
                "{0}: holds no capture in blocks of this mission, so nothing of it has failed",
                root,
                remedy="capture it first",
            )
        folder = capture_folder(root)
        with folder.opened(captured_mission(plan), resume=resume or only_failed) as hold:
            yield cls(plan, root, layout, block_images, hold)

    def check(self) -> None:
        """Raise OutputError if another run has taken the place."""
        self._hold()

    def read(
        self, map_type: str, placeholder: Placeholder, *, only_failed: bool
    ) -> tuple[dict[str, Outcome], list[Piece]]:
        """Read the records of a map type; a block that lacks any image is made again as a whole."""
        records = self._read_records(map_type)
        known: dict[str, Outcome] = {}
        pieces = []
        for number, indices in enumerate(self._divided):
            record = records.get(number)
            if record is None:
                is_missing = not only_failed
            else:
                known.update(record.outcomes)
                self._note_shard(map_type, number, record)
                is_missing = record.failed or any(map(placeholder.knows, noted_digests(record.noted)))
            if is_missing:
                pieces.append(Piece(map_type, indices, number))
        return known, pieces

    def _read_records(self, map_type: str) -> dict[int, Record]:
        """Read the records of complete blocks, by number."""
        existing = list_sizes(self.root / BLOCKS_FOLDER)
        wanted = {number: f"{block_name(map_type, number)}.jsonl" for number in range(len(self._divided))}
        numbers = [number for number, name in wanted.items() if name in existing]
        sizes = file_sizes(self.root / map_type)
        twin_sizes = {
            kind: file_sizes(self.root / twin_type(map_type, kind)) for kind in self._plan.mission.varied.twins
        }
        paths = [self.root / BLOCKS_FOLDER / wanted[number] for number in numbers]
        read = zip(numbers, read_each(paths, MAX_RECORD_BYTES))
        records = {number: Record.from_bytes(data or b"") for number, data in read}
        names = self._plan.names
        return {
            number: record
            for number, record in records.items()
            if record is not None
            and record.matches(map_type, [names[index] for index in self._divided[number].tolist()])
            and self._is_whole(map_type, number, record, sizes, twin_sizes)
        }

    def _is_whole(
        self,
        map_type: str,
        number: int,
        record: Record,
        sizes: Mapping[str, int],
        twin_sizes: Mapping[str, Mapping[str, int]],
    ) -> bool:
        """Whether the files of a block still have the sizes that its record states, and hold its images."""
        shard = shard_name(map_type, number) if self.in_shards else ""
        if not record.fits(shard):
            return False
        if shard and record.shard_bytes:
            return sizes.get(shard) == record.shard_bytes
        made = [one for one in record.outcomes.values() if one.status != FAILED]
        return all(
            is_complete(one, self._endings, sizes)
            and all(is_complete(one.twin(kind), self._endings, of_twins) for kind, of_twins in twin_sizes.items())
            for one in made
        )

    def take(self, piece: Piece, record: Record) -> None:
        """Take the record of a block that was made or given up."""
        self._note_shard(piece.map_type, piece.number, record)

    def give_up(self, piece: Piece, reason: str) -> Record:
        """Commit a record in which all images of a block have failed for a reason, and return it."""
        lost = (self._plan.names[index] for index in piece.indices.tolist())
        record = Record({name: Outcome(piece.map_type, name, reason=reason) for name in lost})
        record.commit(self.root, block_name(piece.map_type, piece.number))
        self._shards[piece.map_type].pop(piece.number, None)
        return record

    def note(self, outcome: Outcome) -> None:
        """Do nothing: the outcome is in the record of the image's block."""

    def _note_shard(self, map_type: str, number: int, record: Record) -> None:
        if record.shard_bytes:
            images = sum(one.status != FAILED for one in record.outcomes.values())
            self._shards[map_type][number] = (images, record.shard_bytes)

    def write_index(self, map_type: str) -> None:
        """Write the index of the shards of a map type, if images are in shards."""
        if self.in_shards:
            shards = {shard_name(map_type, number): of for number, of in sorted(self._shards[map_type].items())}
            write_whole(self.root / map_type / INDEX_FILE, json_bytes(shard_index(shards)))

    def _check_division(self, layout: str, images: int) -> None:
        """Note how the capture is divided into blocks; raises OutputError if it was begun with another division."""
        wanted: dict[str, Any] = {
            "layout_of_files": layout,
            "images": images,
            "captures": len(self._plan),
            "names_sha256": hashlib.sha256("\n".join(self._plan.names).encode("utf-8")).hexdigest(),
        }
        path = self.root / BLOCKS_FOLDER / DIVISION_FILE
        data = read_existing(path, MAX_SETTINGS_BYTES)
        if data is None:
            if not is_address(self.root):
                if list_sizes(self.root).get(JOURNAL_FILE):
                    raise OutputError(
                        "folder {0}: was captured without blocks",
                        self.root,
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
                self.root,
                remedy="choose another folder",
            )
        raise OutputError(
            "{0}: was begun with the layout {1} and blocks of {2} images: it goes on with the same",
            self.root,
            found.get("layout_of_files"),
            found.get("images"),
        )

    def _unreadable(self, reason: object) -> OutputError:
        return OutputError(
            "{0}: its {1} cannot be read ({2}), so it is not known how it was begun",
            self.root,
            f"{BLOCKS_FOLDER}/{DIVISION_FILE}",
            reason,
            remedy="choose another folder",
        )
