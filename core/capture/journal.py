"""The journal of a capture: one line of JSON for each picture that is finished or has failed."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from ..errors import OutputError

DONE = "done"
FAILED = "failed"


@dataclass(frozen=True)
class Outcome:
    """What became of one picture.

    Parameters
    ----------
    map_type, name : str
        The picture; its name is without ending.
    entropy : float or None
        Bits, of a picture that is done.
    reason : str
        Why it failed; empty for one that is done.
    sky_share, unmapped_share : float
        Shares of its pixels that see no ground, and ground that no Web-Mercator source has.
    """

    map_type: str
    name: str
    entropy: float | None = None
    reason: str = ""
    sky_share: float = 0.0
    unmapped_share: float = 0.0

    @property
    def status(self) -> str:
        """``done`` or ``failed``."""
        return FAILED if self.entropy is None else DONE

    def to_line(self) -> bytes:
        """Line of the journal."""
        fields: dict[str, Any] = {
            "map_type": self.map_type,
            "name": self.name,
            "status": self.status,
            "entropy": self.entropy,
            "reason": self.reason,
        }
        if self.sky_share or self.unmapped_share:
            fields.update(sky_share=self.sky_share, unmapped_share=self.unmapped_share)
        return json.dumps(fields, ensure_ascii=False).encode("utf-8") + b"\n"

    @classmethod
    def from_line(cls, line: bytes) -> Outcome | None:
        """Outcome of a line, or None where the line is torn."""
        try:
            fields = json.loads(line)
            entropy = float(fields["entropy"]) if fields["status"] == DONE else None
            shares = (float(fields.get(name, 0.0)) for name in ("sky_share", "unmapped_share"))
            return cls(str(fields["map_type"]), str(fields["name"]), entropy, str(fields["reason"]), *shares)
        except (ValueError, KeyError, TypeError, AttributeError):
            return None


class Journal:
    """The journal file of a folder, read once and then appended to.

    Lines are handed to the operating system one by one, so that they outlive the process. A line that is
    torn counts as not written: its picture is made again. Of several lines about a picture the last holds.

    Raises
    ------
    OutputError
        Where the file cannot be read or written.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._file: IO[Any] | None = None
        self.outcomes: dict[tuple[str, str], Outcome] = {}
        try:
            text = path.read_bytes() if path.exists() else b""
        except OSError as wrong:
            raise OutputError(f"journal {path}: cannot be read ({wrong.strerror})") from wrong
        self._whole_bytes = text.rfind(b"\n") + 1
        for line in text[: self._whole_bytes].split(b"\n"):
            outcome = Outcome.from_line(line)
            if outcome is not None:
                self.outcomes[outcome.map_type, outcome.name] = outcome

    def __enter__(self) -> Journal:
        try:
            self._file = self._path.open("ab", buffering=0)
            self._file.truncate(self._whole_bytes)
        except OSError as wrong:
            raise self._unwritable(wrong) from wrong
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._file is not None:
            self._file.close()

    def add(self, outcome: Outcome) -> None:
        """Append an outcome."""
        if self._file is None:
            raise OutputError(f"journal {self._path}: is not open")
        line = outcome.to_line()
        try:
            written = self._file.write(line)
            if written != len(line):
                # A full disk may take a part of the line only; it is taken back so that no later line joins it.
                self._file.truncate(self._whole_bytes)
                raise OSError(None, "the disk took only a part of a line")
        except OSError as wrong:
            raise self._unwritable(wrong) from wrong
        self._whole_bytes += len(line)
        self.outcomes[outcome.map_type, outcome.name] = outcome

    def _unwritable(self, wrong: OSError) -> OutputError:
        folder, name = os.path.split(self._path)
        return OutputError(f"folder {folder}: cannot write {name} ({wrong.strerror})")
