"""Single images that are remote files, or parts of a remote or local shard."""

from __future__ import annotations

import sys
from collections import OrderedDict
from collections.abc import Collection, Iterator, Mapping
from contextlib import closing
from pathlib import Path, PurePosixPath
from tarfile import TarInfo
from types import MappingProxyType
from typing import NamedTuple

from ...core.dataset.stored import TAR_BLOCK_BYTES, holds_file, is_name, members
from ...core.errors import InvalidInput, OutputError
from ...core.imagery.http.client import NotThere
from ...core.limits import MAX_FETCHED_IMAGE_BYTES
from ...core.storage.files import open_foreign, write_whole
from ...core.text.plain import whole_number
from ..i18n import tr
from .address import DatasetAddress
from .copies import ADDRESS_FILE, copied_address
from .store import Store

#: Largest number of cached images.
_KEPT = 16
#: Largest number of bytes of the cached images together.
_KEPT_BYTES = 128 << 20
_NOTES = ".aux.xml"
_WORLD_FILES = {".jpg": ".jgw", ".png": ".pgw"}
DEPTH = "depth"
#: Endings that files of products may have; labels of images that are not TIFF may be either.
_ENDINGS = (".tif", ".png")


class Fetched(NamedTuple):
    """A fetched image.

    Parameters
    ----------
    data : bytes
        Contents of the image file.
    place : str
        Address or path of the file, for display.
    beside : mapping of str to bytes
        Contents of georeferencing files, by their ending in place of the image's extension.
    products : mapping of str to bytes
        Contents of files with a value for every pixel, such as depth, by product.
    """

    data: bytes
    place: str
    beside: Mapping[str, bytes] = MappingProxyType({})
    products: Mapping[str, bytes] = MappingProxyType({})

    def save(self, path: Path) -> None:
        """Write the image and its georeferencing files; raises OutputError."""
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as wrong:
            raise OutputError("image {0}: cannot be written ({1})", path, wrong.strerror) from wrong
        for ending, data in self.beside.items():
            write_whole(path.with_name(path.stem + ending), data)
        write_whole(path, self.data)


class _InShard(NamedTuple):
    """Position of an image in a shard, from its row in the table."""

    shard: str
    start: int
    length: int

    @classmethod
    def from_row(cls, row: Mapping[str, str], file: str) -> _InShard | None:
        """Position from a row of the table; None if the row names no shard."""
        shard = row.get("shard", "")
        if not shard:
            return None
        start, length = (whole_number(row.get(name, "")) for name in ("offset_bytes", "size_bytes"))
        # A foreign table may only name files in its own folder.
        if not is_name(shard) or start is None or start < TAR_BLOCK_BYTES or not length:
            raise InvalidInput(tr("image {name}: its row of the table names no part of a shard").format(name=file))
        if length > MAX_FETCHED_IMAGE_BYTES:
            raise _too_large(file)
        return cls(shard, start, length)


class ImageFetcher:
    """Fetch images and cache the last few. Use on one thread; `interrupt` works on any thread."""

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[object, ...], Fetched] = OrderedDict()
        self._stores: dict[DatasetAddress, Store] = {}

    def interrupt(self) -> None:
        """Cancel the current request, so that `fetch` raises `Cancelled`."""
        for store in list(self._stores.values()):
            store.close()
        self._stores.clear()

    def fetch(
        self, folder: Path, map_type: str, file: str, row: Mapping[str, str], products: Collection[str] = ()
    ) -> Fetched | None:
        """Fetch an image of a dataset; None if it is a file in the dataset's folder.

        Parameters
        ----------
        folder : Path
            Folder of the dataset, or of the copy of a remote dataset.
        map_type, file : str
        row : mapping of str to str
            Row of the image in the table; empty if there is none.
        products : collection of str
            Products of this dataset whose files to fetch, too.

        Raises
        ------
        InvalidInput, OutputError, PartError, SourceError, Cancelled
            As from `Store`; or the image does not exist, or its shard is damaged.
        """
        address, part = copied_address(folder), _InShard.from_row(row, file)
        if address is None and part is None:
            return None
        key = (_stamp(folder), folder, map_type, file, part, frozenset(products))
        if key not in self._kept:
            found = (
                self._fetch_from_shard(folder, address, map_type, file, part, products)
                if part is not None
                else self._file(address, map_type, file, products)
            )
            self._keep(key, found)
        self._kept.move_to_end(key)
        return self._kept[key]

    def _keep(self, key: tuple[object, ...], image: Fetched) -> None:
        self._kept[key] = image
        sizes = [len(one.data) + sum(map(len, one.products.values())) for one in self._kept.values()]
        while len(self._kept) > 1 and (len(self._kept) > _KEPT or sum(sizes) > _KEPT_BYTES):
            self._kept.popitem(last=False)
            del sizes[0]

    def _store(self, address: DatasetAddress) -> Store:
        store = self._stores.get(address)
        if store is None:
            store = self._stores[address] = Store(address)
        return store

    def _file(self, address: DatasetAddress, map_type: str, file: str, products: Collection[str]) -> Fetched:
        store, name = self._store(address), f"{map_type}/{file}"
        try:
            data = _whole(store, name)
        except NotThere as wrong:
            raise InvalidInput(tr("There is no image (yet) at {address}").format(address=address.file(name))) from wrong
        found = {}
        for product in products:
            for ending in _ENDINGS:
                content = _read_optional(store, f"{product}/{PurePosixPath(file).stem}{ending}")
                if content is not None:
                    found[product] = content
                    break
        return Fetched(data, address.file(name), products=found)

    def _fetch_from_shard(
        self,
        folder: Path,
        address: DatasetAddress | None,
        map_type: str,
        file: str,
        part: _InShard,
        products: Collection[str],
    ) -> Fetched:
        name = f"{map_type}/{part.shard}"
        shard = address.file(name) if address is not None else str(folder / map_type / part.shard)

        def read(start: int, length: int) -> bytes:
            if address is not None:
                return self._store(address).part(name, start, length)
            with open_foreign(folder / map_type / part.shard) as tar:
                tar.seek(start)
                return tar.read(length)

        try:
            # Also read 16 KiB after the image, where its shard has further files such as its georeferencing.
            text = read(part.start - TAR_BLOCK_BYTES, TAR_BLOCK_BYTES + part.length + (16 << 10))

            def piece(at: int, length: int) -> bytes:
                if at + length <= len(text) or len(found) == len(products):
                    return text[at : at + length]
                # Files of products may be large; only their headers are read in between.
                return read(part.start - TAR_BLOCK_BYTES + at, length)

            found: dict[str, bytes] = {}
            ours = members(piece, shard, 0, sys.maxsize)
            first = next(ours, None)
            ending = PurePosixPath(file).suffix
            if len(text) < TAR_BLOCK_BYTES + part.length:
                raise InvalidInput(tr("shard {shard}: is torn, it ends before the image does").format(shard=shard))
            if (
                first is None
                or not holds_file(first)
                or first.size != part.length
                or PurePosixPath(first.name).suffix != ending
            ):
                raise InvalidInput(
                    tr("shard {shard}: holds no image where the table says; it is torn, or another one").format(
                        shard=shard
                    )
                )
            stem = first.name[: -len(ending)]
            wanted = (_WORLD_FILES.get(ending, ""), ending + _NOTES)
            of_product = {f".{product}{end}": product for product in products for end in _ENDINGS}
            beside = {}
            for tail, member in _companions(ours, stem):
                start = member.offset + TAR_BLOCK_BYTES
                if tail in wanted and start + member.size <= len(text):
                    beside[tail] = text[start : start + member.size]
                elif tail in of_product and member.size <= MAX_FETCHED_IMAGE_BYTES:
                    found[of_product[tail]] = piece(start, member.size)
        except (FileNotFoundError, NotThere) as wrong:
            raise InvalidInput(tr("shard {shard}: is not there").format(shard=shard)) from wrong
        except OSError as wrong:
            raise InvalidInput(
                tr("shard {shard}: cannot be read ({reason})").format(shard=shard, reason=wrong.strerror)
            ) from wrong
        place = tr("{shard}, bytes {first} to {last}").format(
            shard=shard, first=part.start, last=part.start + part.length - 1
        )
        return Fetched(text[TAR_BLOCK_BYTES : TAR_BLOCK_BYTES + part.length], place, beside, found)


def _companions(members_after: Iterator[TarInfo], stem: str) -> Iterator[tuple[str, TarInfo]]:
    """Ending and header of each further file of an image in a shard."""
    for member in members_after:
        if not member.name.startswith(f"{stem}."):
            return
        if holds_file(member):
            yield member.name[len(stem) :], member


def add_georeference(image: Fetched, folder: Path, map_type: str, file: str) -> Fetched:
    """Add the remote georeferencing files to an image; on any thread."""
    address, name = copied_address(folder), PurePosixPath(file)
    if address is None or image.beside or name.suffix not in _WORLD_FILES:
        return image
    with closing(Store(address)) as store:
        endings = (_WORLD_FILES[name.suffix], name.suffix + _NOTES)
        found = {ending: _read_optional(store, f"{map_type}/{name.stem}{ending}") for ending in endings}
    return image._replace(beside={ending: data for ending, data in found.items() if data is not None})


def _whole(store: Store, name: str) -> bytes:
    pieces, size = [], 0
    for piece in store.pieces(name):
        pieces.append(piece)
        size += len(piece)
        if size > MAX_FETCHED_IMAGE_BYTES:
            raise _too_large(name)
    return b"".join(pieces)


def _read_optional(store: Store, name: str) -> bytes | None:
    try:
        return _whole(store, name)
    except NotThere:
        return None


def _too_large(name: str) -> InvalidInput:
    return InvalidInput(tr("image {name}: has more than {most} bytes").format(name=name, most=MAX_FETCHED_IMAGE_BYTES))


def _stamp(folder: Path) -> int:
    """Stamp that changes when a dataset is copied again."""
    try:
        return (folder / ADDRESS_FILE).stat().st_mtime_ns
    except OSError:
        return 0
