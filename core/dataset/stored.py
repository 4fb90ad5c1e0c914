"""Images outside local folders: objects in a store, and ranges of shards.

A shard is a tar beside the table; columns of the table hold the offset and size of each image in it.
"""

from __future__ import annotations

import re
import tarfile
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Union

import numpy as np

from ..errors import InvalidInput
from ..limits import MAX_IMAGE_FILE_BYTES, MAX_IMAGE_MEMBERS
from ..storage.files import open_foreign, read_existing
from ..storage.stores import get_range, is_address, is_file, list_sizes
from .table import Table

#: Tars are of blocks, and a member's header is one.
TAR_BLOCK_BYTES = tarfile.BLOCKSIZE
_OF_THE_NEXT = (
    tarfile.XHDTYPE,
    tarfile.XGLTYPE,
    tarfile.SOLARIS_XHDTYPE,
    tarfile.GNUTYPE_LONGNAME,
    tarfile.GNUTYPE_LONGLINK,
)


class Range(NamedTuple):
    """Where an image's data begin in a shard, and how many bytes they are."""

    offset_bytes: int
    size_bytes: int


@dataclass(frozen=True)
class StoredImage:
    """An image in an object store or in a shard, to be read as a file's path is.

    Parameters
    ----------
    name : str
        The image's, with its ending.
    place : Path
        The object, or the shard that the image is in.
    range : Range or None
        Of a shard.
    shard_bytes : int
        Length of the shard.
    copy : Path or None
        Where a copy of the shard may be on this machine, which is read if it is there.
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
        """Ending of the name."""
        return Path(self.name).suffix

    def read_bytes(self) -> bytes:
        """Read the image's file.

        Raises
        ------
        InvalidInput
            It is not there; or the shard is not, or has something else there.
        OutputError
            A store that cannot be asked.
        """
        if self.range is None:
            data = read_existing(self.place, MAX_IMAGE_FILE_BYTES)
            if data is None:
                raise InvalidInput("image {0}: is not there", self)
            return data
        offset, size = self.range
        if size > MAX_IMAGE_FILE_BYTES:
            raise InvalidInput("image {0}: has {1:,} bytes; must have {2:,} at most", self, size, MAX_IMAGE_FILE_BYTES)
        # One request for most images; what is large is in memory once, and only if its header says the same.
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
                "image {0}: is not where the table says it is, as the shard is torn or another one",
                self,
                remedy="put back the shard that belongs to the table",
            )
        return found

    def endings(self) -> Iterator[str]:
        """Endings of the files that belong to the image, which are its neighbours in the shard.

        Raises
        ------
        InvalidInput
            As `members` does; or one of them is something else than a file, or passes the shard's end.
        """
        if self.range is None:
            return
        key = None
        start = self.range.offset_bytes - TAR_BLOCK_BYTES
        for member in members(self._part, self.place, start, self.shard_bytes):
            # Up to its first dot the files of one image have their name in common.
            own, _, _ = member.name.partition(".")
            key = own if key is None else key
            if own != key:
                return
            if not holds_file(member) or member.offset + member_bytes(member) > self.shard_bytes:
                raise InvalidInput(
                    "shard {0}: what it has of the image {1} at byte {2:,} is no whole file",
                    self.place,
                    self.name,
                    member.offset,
                )
            yield member.name[len(key) :]

    def _part(self, start: int, length: int) -> bytes:
        """Some bytes of the shard."""
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


#: What the bytes of an image are read from.
ImageFile = Union[Path, StoredImage]


def has_sidecar(image: ImageFile, endings: Iterable[str]) -> bool:
    """Whether a file of the image's name and one of some endings is beside it."""
    if not isinstance(image, StoredImage):
        return any(image.with_suffix(ending).exists() for ending in endings)
    if image.range is None:
        return any(is_file(image.place.with_suffix(ending)) for ending in endings)
    return not set(endings).isdisjoint(image.endings())


def is_name(text: str) -> bool:
    """Whether a file in a folder may have such a name."""
    return text not in ("", ".", "..") and not re.search(r"[/\\:\x00]", text)


def shard_sizes(folder: Path, table: Table) -> dict[str, int]:
    """Bytes of the shards that a table names, by their names, in its order.

    Raises
    ------
    InvalidInput
        Rows that do not say where their images are, a shard that is not there, or one that is cut short.
    OutputError
        A store that cannot be asked.
    """
    made = np.flatnonzero(table.made)
    offset, size = table.offset_bytes[made], table.size_bytes[made]
    names = [table.shard[row] for row in made.tolist()]
    known = np.array([is_name(name) for name in names], np.bool_)
    # NaN, which is no number of bytes, is not at least one.
    known &= (offset >= TAR_BLOCK_BYTES) & (size >= 1.0) & (offset % 1.0 == 0.0) & (size % 1.0 == 0.0)
    if not known.all():
        row = made[int(np.argmin(known))]
        raise InvalidInput("folder {0}: the table does not say where in a shard {1} is", folder, table.img_names[row])
    needed: dict[str, float] = {}
    for name, end in zip(names, (offset + size).tolist()):
        needed[name] = max(needed.get(name, 0.0), end)
    there = list_sizes(folder) if is_address(folder) else _sizes(folder, needed)
    for name, end in needed.items():
        if name not in there:
            raise InvalidInput("folder {0}: the shard {1} of the table is not there", folder, name)
        if there[name] < end:
            raise InvalidInput(
                "shard {0}: is cut short, as it has {1:,} bytes of {2:,.0f} that its images need",
                folder / name,
                there[name],
                end,
            )
    return {name: there[name] for name in needed}


def _sizes(folder: Path, names: Iterable[str]) -> dict[str, int]:
    """Sizes in bytes of the files that exist in a folder."""
    return {name: (folder / name).stat().st_size for name in names if (folder / name).is_file()}


def members(read: Callable[[int, int], bytes], shard: str | Path, start: int, end: int) -> Iterator[tarfile.TarInfo]:
    """Members of a shard from one on, of which an image has a few: each behind the one before it.

    Headers that state something of the next member, such as a long name, are no members.

    Parameters
    ----------
    read : callable
        Gives so many bytes from one on; fewer where there are no more.
    shard : str or Path
        For messages.
    start, end : int
        Where the first one's header begins, and where what is read ends.

    Yields
    ------
    TarInfo
        Its ``offset`` is where its header begins.

    Raises
    ------
    InvalidInput
        A header of a negative size, or more members than an image has.
    """
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
        if member.type not in _OF_THE_NEXT:
            yield member
        at += member_bytes(member)


def parse_member(header: bytes) -> tarfile.TarInfo | None:
    """File that a block of a tar is the header of; None where it is none, or not whole."""
    if header[257:262] != b"ustar":
        return None
    try:
        return tarfile.TarInfo.frombuf(header[:TAR_BLOCK_BYTES], "utf-8", "surrogateescape")
    except tarfile.HeaderError:
        return None


def holds_file(member: tarfile.TarInfo) -> bool:
    """Whether a member is a file as it is, and no link, device, folder or file with holes."""
    return member.type in (tarfile.REGTYPE, tarfile.AREGTYPE)


def member_bytes(member: tarfile.TarInfo) -> int:
    """Bytes of a member from its header to the next one's."""
    return TAR_BLOCK_BYTES + -(-member.size // TAR_BLOCK_BYTES) * TAR_BLOCK_BYTES
