"""Images outside local folders: objects of a store, and ranges of shards.

A shard is a tar beside the table, whose columns hold the offset and size of each image in it.
"""

from __future__ import annotations

import re
import tarfile
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple, Union

import numpy as np

from ..errors import InvalidInput
from ..limits import MAX_IMAGE_FILE_BYTES, MAX_IMAGE_MEMBERS
from ..storage.files import open_foreign, read_existing
from ..storage.stores import get_range, is_address, is_file, list_sizes
from .table import Table

#: Size of the blocks of a tar; a member's header is one block.
TAR_BLOCK_BYTES = tarfile.BLOCKSIZE


class Range(NamedTuple):
    """Position and size of an image's data in a shard."""

    offset_bytes: int
    size_bytes: int


@dataclass(frozen=True)
class StoredImage:
    """An image in an object store or in a shard, used in place of a path.

    Parameters
    ----------
    name : str
        Name of the image, with ending.
    place : Path
        Path of the object, or of the shard that holds the image.
    range : Range or None
        Range of the shard; None for an object.
    shard_bytes : int
        Length of the shard.
    copy : Path or None
        Local copy of the shard, which is read if it exists.
    """

    name: str
    place: Path
    range: Range | None = None
    shard_bytes: int = 0
    copy: Path | None = None

    def __str__(self) -> str:
        return str(self.place) if self.range is None else f"{self.name} in {self.place}"

    @property
    def suffix(self) -> str:
        """Ending of the name, with its dot."""
        return Path(self.name).suffix

    def read_bytes(self) -> bytes:
        """Read the image's file.

        Raises
        ------
        InvalidInput
            The image or the shard does not exist, or the shard holds something else in the image's place.
        OutputError
            The store cannot be reached.
        """
        if self.range is None:
            data = read_existing(self.place, MAX_IMAGE_FILE_BYTES)
            if data is None:
                raise InvalidInput("image {0}: is not there", self)
            return data
        offset, size = self.range
        if size > MAX_IMAGE_FILE_BYTES:
            raise InvalidInput("image {0}: has {1:,} bytes; must have {2:,} at most", self, size, MAX_IMAGE_FILE_BYTES)
        # Most images take one request. Above 16 MB, the header is checked first, and the data are in memory only once.
        data = self._part(offset - TAR_BLOCK_BYTES, TAR_BLOCK_BYTES + size * (size <= 16_000_000))
        member = parse_member(data[:TAR_BLOCK_BYTES])
        is_there = (
            member is not None
            and holds_file(member)
            and member.size == size
            and Path(member.name).suffix == self.suffix
        )
        found = data[TAR_BLOCK_BYTES:] or self._part(offset, size) if is_there else b""
        if len(found) != size:
            raise InvalidInput(
                "image {0}: is not where the table says it is, as the shard is damaged or a different one",
                self,
                remedy="put back the shard that belongs to the table",
            )
        return found

    def endings(self) -> Iterator[str]:
        """Yield endings of the image's files; raises InvalidInput as `companion`."""
        return (ending for ending, _ in self._files())

    def companion(self, endings: Collection[str]) -> StoredImage | None:
        """First of the image's files in the shard with one of some endings, such as ``.depth.tif``.

        Raises
        ------
        InvalidInput
            As `members`; or a member is not a regular file, or exceeds the shard.
        """
        for ending, place in self._files():
            if ending in endings:
                return replace(self, name=Path(self.name).stem + ending, range=place)
        return None

    def _files(self) -> Iterator[tuple[str, Range]]:
        """Yield endings and ranges of the image's files, which follow each other in the shard."""
        if self.range is None:
            return
        key = None
        start = self.range.offset_bytes - TAR_BLOCK_BYTES
        for member in members(self._part, self.place, start, self.shard_bytes):
            # The files of an image have the same name up to its first dot.
            stem, _, _ = member.name.partition(".")
            key = stem if key is None else key
            if stem != key:
                return
            if not holds_file(member) or member.offset + member_bytes(member) > self.shard_bytes:
                raise InvalidInput(
                    "shard {0}: its part of image {1} at byte {2:,} is not a whole file",
                    self.place,
                    self.name,
                    member.offset,
                )
            yield member.name[len(key) :], Range(member.offset + TAR_BLOCK_BYTES, member.size)

    def _part(self, start: int, length: int) -> bytes:
        """Read bytes of the shard."""
        for path in (self.copy, self.place):
            if path is None:
                continue
            if is_address(path):
                return get_range(path, start, length)
            try:
                with open_foreign(path) as file:
                    file.seek(start)
                    return file.read(length)
            except FileNotFoundError as wrong:
                if path is self.place:
                    raise InvalidInput("shard {0}: is not there", path) from wrong
            except OSError as wrong:
                raise InvalidInput("shard {0}: cannot be read ({1})", path, wrong.strerror) from wrong
        return b""


#: Where the bytes of an image are read from.
ImageFile = Union[Path, StoredImage]


def has_sidecar(image: ImageFile, endings: Iterable[str]) -> bool:
    """Whether a file with the image's name and one of the endings is beside the image."""
    if not isinstance(image, StoredImage):
        return any(image.with_suffix(ending).exists() for ending in endings)
    if image.range is None:
        return any(is_file(image.place.with_suffix(ending)) for ending in endings)
    return not set(endings).isdisjoint(image.endings())


def is_name(text: str) -> bool:
    """Whether a text can be the name of a file in a folder."""
    return text not in ("", ".", "..") and not re.search(r"[/\\:\x00]", text)


def shard_sizes(folder: Path, table: Table) -> dict[str, int]:
    """Sizes in bytes of the shards that a table names, by name, in its order.

    Raises
    ------
    InvalidInput
        A row does not locate its image, or a shard does not exist or is truncated.
    OutputError
        The store cannot be reached.
    """
    made = np.flatnonzero(table.made)
    offset, size = table.offset_bytes[made], table.size_bytes[made]
    names = [table.shard[row] for row in made.tolist()]
    known = np.array([is_name(name) for name in names], np.bool_)
    # NaN fails these comparisons.
    known &= (offset >= TAR_BLOCK_BYTES) & (size >= 1.0) & (offset % 1.0 == 0.0) & (size % 1.0 == 0.0)
    if not known.all():
        row = made[int(np.argmin(known))]
        raise InvalidInput("folder {0}: the table does not say where in a shard {1} is", folder, table.img_names[row])
    needed: dict[str, float] = {}
    for name, end in zip(names, (offset + size).tolist()):
        needed[name] = max(needed.get(name, 0.0), end)
    found = list_sizes(folder) if is_address(folder) else _sizes(folder, needed)
    for name, end in needed.items():
        if name not in found:
            raise InvalidInput("folder {0}: the shard {1} of the table is not there", folder, name)
        if found[name] < end:
            raise InvalidInput(
                "shard {0}: is cut short, as it has {1:,} bytes of {2:,.0f} that its images need",
                folder / name,
                found[name],
                end,
            )
    return {name: found[name] for name in needed}


def _sizes(folder: Path, names: Iterable[str]) -> dict[str, int]:
    """Sizes in bytes of those files that exist in a folder."""
    return {name: (folder / name).stat().st_size for name in names if (folder / name).is_file()}


def members(read: Callable[[int, int], bytes], shard: str | Path, start: int, end: int) -> Iterator[tarfile.TarInfo]:
    """Yield consecutive members of a shard, without headers that extend the next header.

    Parameters
    ----------
    read : callable
        Called with a position and a number of bytes; returns fewer at the end of the shard.
    shard : str or Path
        Name of the shard for messages.
    start, end : int
        Position of the first header; end of the range to read.

    Yields
    ------
    TarInfo
        ``offset`` is the position of its header.

    Raises
    ------
    InvalidInput
        A header states a negative size, or there are more members than an image has.
    """
    extensions = {tarfile.XHDTYPE, tarfile.XGLTYPE, tarfile.SOLARIS_XHDTYPE}
    extensions |= {tarfile.GNUTYPE_LONGNAME, tarfile.GNUTYPE_LONGLINK}
    at, count = start, 0
    while at <= end - TAR_BLOCK_BYTES:
        member = parse_member(read(at, TAR_BLOCK_BYTES))
        if member is None:
            return
        member.offset = at
        if member.size < 0:
            raise InvalidInput("shard {0}: states {1:,} bytes for the file at byte {2:,}", shard, member.size, at)
        count += 1
        if count > MAX_IMAGE_MEMBERS:
            raise InvalidInput(
                "shard {0}: has more than {1} files of one image from byte {2:,} on",
                shard,
                MAX_IMAGE_MEMBERS,
                start,
            )
        if member.type not in extensions:
            yield member
        at += member_bytes(member)


def parse_member(header: bytes) -> tarfile.TarInfo | None:
    """Parse a block of a tar as a member's header; None if the block is not a complete header."""
    # The magic of POSIX and GNU tars (POSIX.1, ustar interchange format).
    if header[257:262] != b"ustar":
        return None
    try:
        return tarfile.TarInfo.frombuf(header[:TAR_BLOCK_BYTES], "utf-8", "surrogateescape")
    except tarfile.HeaderError:
        return None


def holds_file(member: tarfile.TarInfo) -> bool:
    """Whether a member is a regular file, and not a link, device, folder or sparse file."""
    return member.type in (tarfile.REGTYPE, tarfile.AREGTYPE)


def member_bytes(member: tarfile.TarInfo) -> int:
    """Bytes from a member's header to the next one."""
    return TAR_BLOCK_BYTES + -(-member.size // TAR_BLOCK_BYTES) * TAR_BLOCK_BYTES
