"""Many images in one file: a tar of each image, its row of the table and its products, as WebDataset reads them."""

from __future__ import annotations

import io
import json
import tarfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ...dataset.table import TEXT, TIME, Table, json_cell, written_columns

#: Index of a map type's shards, as the library ``wids`` has it.
INDEX_FILE = "shards.json"
_INDEX: dict[str, Any] = {"__kind__": "wids-shard-index-v1", "wids_version": 1}


class Member(NamedTuple):
    """Where an image's own file begins in a shard, and how long it is."""

    offset_bytes: int
    length_bytes: int


class Gathered:
    """Files of images, kept until they are packed: takes files from several threads, in any order."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._files: dict[tuple[str, str], bytes] = {}

    def write(self, path: Path, data: bytes) -> None:
        """Take a file, by the folder and the name that it would have elsewhere."""
        with self._lock:
            self._files[path.parent.name, path.name] = data

    def packed(
        self, map_type: str, keys: Mapping[str, str], table: Table, products: Sequence[str]
    ) -> tuple[bytes, dict[str, Member]]:
        """Tar of the images of a table.

        Its bytes depend on the images and the table alone. Members of an image have one key, and endings: its own,
        those of the files beside it, ``.json`` with its row of the table, and ``.depth.tif`` and such of products.
        Names of images would be none, as WebDataset takes all after the first dot for the ending.

        Parameters
        ----------
        map_type : str
        keys : mapping of str to str
            By the image's name without ending.
        table : Table
            A row of each image, in the order that they are packed.
        products : sequence of str

        Returns
        -------
        bytes, dict of str to Member
            Where the images' own files are, by name without ending.
        """
        # Times as texts, as tables have them.
        columns = [
            one._replace(kind=TEXT, values=table.time_utc) if one.kind == TIME else one
            for one in written_columns(table)
        ]
        members: dict[str, Member] = {}
        buffer = io.BytesIO()
        with tarfile.open(fileobj=buffer, mode="w", format=tarfile.USTAR_FORMAT) as tar:

            def add(name: str, data: bytes) -> Member:
                about = tarfile.TarInfo(name)
                about.size = len(data)
                begin = tar.offset + tarfile.BLOCKSIZE
                tar.addfile(about, io.BytesIO(data))
                return Member(begin, len(data))

            for row, file_name in enumerate(table.img_names):
                name, _, ending = file_name.rpartition(".")
                key = keys[name]
                members[name] = add(f"{key}.{ending}", self._files[map_type, file_name])
                values = {one.header: json_cell(one, row) for one in columns}
                add(f"{key}.json", json.dumps(values, ensure_ascii=False).encode("utf-8"))
                for (folder, other), data in self._beside(map_type, name, file_name, products):
                    product = "" if folder == map_type else f".{folder}"
                    add(f"{key}{product}{other[len(name) :]}", data)
        return buffer.getvalue(), members

    def _beside(
        self, map_type: str, name: str, file_name: str, products: Sequence[str]
    ) -> list[tuple[tuple[str, str], bytes]]:
        """Files of an image but its own."""
        endings = (".jgw", ".pgw", f"{file_name[len(name) :]}.aux.xml")
        wanted = [(map_type, name + ending) for ending in endings]
        wanted += [(product, f"{name}.tif") for product in products]
        return [(one, self._files[one]) for one in wanted if one in self._files]


def index_of(shards: Mapping[str, tuple[int, int]]) -> dict[str, Any]:
    """Index of shards by file name: their images and bytes."""
    listed = [{"url": name, "nsamples": images, "filesize": size} for name, (images, size) in shards.items()]
    return {**_INDEX, "shardlist": listed}
