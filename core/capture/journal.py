"""The journal file of a capture: a line of JSON for each image that is finished or has failed.

A killed process loses no image that it has noted: each image is renamed into place before its line is handed to the
operating system. To save time, images and lines are not forced to the disk one by one: that would take 0.3 to 3 ms an
image on a solid-state disk, and more on others. So a power failure may lose images; a resumed capture finds them, as
each line has the size of its image.
"""

from __future__ import annotations

import json
import math
import os
import threading
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from ..errors import OutputError
from ..limits import MAX_JOURNAL_LINE_BYTES, MAX_TABLE_BYTES
from ..map_types import CLEAN, twin_type
from ..mission.takes import RATE_COLUMNS
from ..storage.files import open_locked, open_own
from ..storage.store_requests import larger_than
from ..text.safe_json import parse_json

DONE = "done"
FAILED = "failed"
#: Facts of where an image shows what, which hold without the effects on light, too.
_OF_GEOMETRY = {"row_time_us", *RATE_COLUMNS, "east_m", "north_m"}


@dataclass(frozen=True)
class Outcome:
    """Outcome of an image: done or failed.

    Parameters
    ----------
    map_type, name : str
        Name without ending.
    entropy : float or None
        In bits; None for an image that failed.
    reason : str
        Why the image failed; empty for an image that is done.
    sky_share, unmapped_share, facade_share : float
        Shares of pixels that see sky, ground beyond the Web-Mercator map, and faces of relief that maps do not show.
    size_bytes : int
        Bytes of all files of the image; 0 where unknown.
    repeated : tuple of str
        Digests of files in the image that the provider also sent for places far away; see `Repeats`.
    shard : str
        File that the image shares with others; empty if it has a separate file.
    offset_bytes, length_bytes : int
        Position and length of the image in the shard.
    facts : tuple of (str, float or str)
        What is stated of a real camera's effects on the image, by the name of the table's column.
    twins : tuple of Outcome
        Outcomes of the image's twins, by whose map types they are found.
    """

    map_type: str
    name: str
    entropy: float | None = None
    reason: str = ""
    sky_share: float = 0.0
    unmapped_share: float = 0.0
    facade_share: float = 0.0
    size_bytes: int = 0
    repeated: tuple[str, ...] = ()
    shard: str = ""
    offset_bytes: int = 0
    length_bytes: int = 0
    facts: tuple[tuple[str, float | str], ...] = ()
    twins: tuple[Outcome, ...] = ()

    @property
    def status(self) -> str:
        """``done`` or ``failed``."""
        return FAILED if self.entropy is None else DONE

    def clean(self, entropy: float, size_bytes: int) -> Outcome:
        """Outcome of the twin without effects on light, by its entropy and the size of its files."""
        facts = tuple(one for one in self.facts if one[0] in _OF_GEOMETRY)
        map_type = twin_type(self.map_type, CLEAN)
        return replace(self, map_type=map_type, entropy=entropy, size_bytes=size_bytes, facts=facts)

    def twin(self, kind: str) -> Outcome:
        """Outcome of a twin: failed unless it is noted."""
        map_type = twin_type(self.map_type, kind)
        failed = replace(self, map_type=map_type, entropy=None, size_bytes=0, facts=(), twins=())
        return next((one for one in self.twins if one.map_type == map_type), failed)

    def to_line(self) -> bytes:
        """Line of the journal."""
        return json.dumps(self._fields(), ensure_ascii=False).encode("utf-8") + b"\n"

    def _fields(self) -> dict[str, Any]:
        fields: dict[str, Any] = {
            "map_type": self.map_type,
            "name": self.name,
            "status": self.status,
            "entropy": self.entropy,
            "reason": self.reason,
        }
        if self.sky_share or self.unmapped_share:
            fields.update(sky_share=self.sky_share, unmapped_share=self.unmapped_share)
        if self.facade_share:
            fields.update(facade_share=self.facade_share)
        if self.size_bytes:
            fields.update(size_bytes=self.size_bytes)
        if self.repeated:
            fields.update(repeated=self.repeated)
        if self.shard:
            fields.update(shard=self.shard, offset_bytes=self.offset_bytes, length_bytes=self.length_bytes)
        if self.facts:
            fields.update(facts=dict(self.facts))
        if self.twins:
            fields.update(twins=[one._fields() for one in self.twins])
        return fields

    @classmethod
    def from_line(cls, line: bytes) -> Outcome | None:
        """Parse a line; None if it is torn."""
        try:
            return cls._from_fields(parse_json(line))
        except (ValueError, KeyError, TypeError, AttributeError, OverflowError):
            return None

    @classmethod
    def _from_fields(cls, fields: Any) -> Outcome:
        sky, unmapped, facades = (float(fields.get(f"{what}_share", 0.0)) for what in ("sky", "unmapped", "facade"))
        entropy = float(fields["entropy"]) if fields["status"] == DONE else None
        sizes = [int(fields.get(f"{what}_bytes", 0)) for what in ("size", "offset", "length")]
        # Comparisons with NaN are false.
        is_sound = all(0.0 <= share <= 1.0 for share in (sky, unmapped, facades))
        if not (is_sound and 0.0 <= (entropy or 0.0) < math.inf and min(sizes) >= 0):
            raise ValueError(fields["name"])
        return cls(
            str(fields["map_type"]),
            str(fields["name"]),
            entropy,
            str(fields["reason"]),
            sky,
            unmapped,
            facades,
            sizes[0],
            tuple(map(str, fields.get("repeated", ()))),
            str(fields.get("shard", "")),
            sizes[1],
            sizes[2],
            tuple(_fact(*one) for one in fields.get("facts", {}).items()),
            tuple(map(cls._from_fields, fields.get("twins", ()))),
        )


def _fact(name: str, value: Any) -> tuple[str, float | str]:
    """A fact as read from a line; raises TypeError."""
    if isinstance(value, str):
        return name, value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(name)
    return name, float(value)


class Journal:
    """The journal file of a folder, read once and then appended to by one run at a time.

    Lines are handed to the operating system one by one, so that they outlive the process. A torn line is ignored, and
    its image is made again. Of several lines about an image, the last counts.

    The file is locked while open, which keeps other runs out of the folder.

    Raises
    ------
    OutputError
        The file cannot be read or written, or another run has it open.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: IO[bytes] | None = None
        self._read()

    def _read(self) -> None:
        self._bytes = self._whole_bytes = 0
        self._adding = threading.Lock()
        self.outcomes: dict[tuple[str, str], Outcome] = {}
        try:
            with open_own(self._path, "rb", buffering=1 << 20) as file:
                if os.fstat(file.fileno()).st_size > MAX_TABLE_BYTES:
                    raise OutputError("journal {0}: cannot be read ({1})", self._path, larger_than(MAX_TABLE_BYTES))
                while line := file.readline(MAX_JOURNAL_LINE_BYTES):
                    self._take(line)
        except FileNotFoundError:
            return
        except OSError as wrong:
            raise OutputError("journal {0}: cannot be read ({1})", self._path, wrong.strerror) from wrong

    def _take(self, line: bytes) -> None:
        """Parse a line; pieces of a line that is too long count as torn lines."""
        self._bytes += len(line)
        if line.endswith(b"\n"):
            self._whole_bytes = self._bytes
            outcome = Outcome.from_line(line)
            if outcome is not None:
                self.outcomes[outcome.map_type, outcome.name] = outcome

    def __enter__(self) -> Journal:
        self._file = open_locked(self._path)
        try:
            if os.fstat(self._file.fileno()).st_size != self._bytes:
                # Another run has appended lines since the file was read.
                self._read()
            self._file.truncate(self._whole_bytes)
        except OSError as wrong:
            self._file.close()
            raise self._unwritable(wrong) from wrong
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        file, self._file = self._file, None
        if file is None:
            return
        with file:
            try:
                os.fsync(file.fileno())
            except OSError as wrong:
                if error is None:
                    raise self._unwritable(wrong) from wrong

    @property
    def file(self) -> IO[bytes]:
        """The open file; raises OutputError if it is closed."""
        if self._file is None:
            raise OutputError("journal {0}: is not open", self._path)
        return self._file

    def check(self) -> None:
        """Raise OutputError if another run has written to the file after the lock was lost; any thread may call it."""
        with self._adding:
            self._check()

    def _check(self) -> None:
        try:
            size = os.fstat(self.file.fileno()).st_size
        except OSError as wrong:
            raise self._unwritable(wrong) from wrong
        if size != self._whole_bytes:
            raise OutputError(
                "folder {0}: another run has taken over, as its {1} shows", self._path.parent, self._path.name
            )

    def add(self, outcome: Outcome) -> None:
        """Append an outcome; raises OutputError."""
        line = outcome.to_line()
        with self._adding:
            self._check()
            try:
                written = self.file.write(line)
                if written != len(line):
                    # A full disk may take only a part of the line; remove it, so that the next line does not join it.
                    self.file.truncate(self._whole_bytes)
                    raise OSError(None, "the disk took only a part of a line")
            except OSError as wrong:
                raise self._unwritable(wrong) from wrong
            self._whole_bytes += len(line)
        self.outcomes[outcome.map_type, outcome.name] = outcome

    def _unwritable(self, wrong: OSError) -> OutputError:
        return OutputError("folder {0}: cannot write {1} ({2})", self._path.parent, self._path.name, wrong.strerror)
