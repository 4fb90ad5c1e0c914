"""Many images in one file: a tar of images, table rows and products for WebDataset."""

from __future__ import annotations

import io
import json
import tarfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ...dataset.table import TEXT, TIME, Table, json_cell, written_columns
from ...map_types import TWINS, twin_type

#: File of the index of a map type's shards, for the library ``wids``.
INDEX_FILE = "shards.json"


class Member(NamedTuple):
    """Position and length of an image file in a shard."""

    offset_bytes: int
    length_bytes: int


class Gathered:
    """Collection of image files from several threads, to be packed into a shard."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._files: dict[tuple[str, str], bytes] = {}

    def write(self, path: Path, data: bytes) -> None:
        """Collect a file; ``path`` is where it would lie as a separate file."""
        with self._lock:
            self._files[path.parent.name, path.name] = data

    def packed(
        self, map_type: str, keys: Mapping[str, str], table: Table, products: Sequence[str]
    ) -> tuple[bytes, dict[str, Member]]:
        """Pack the images of a table into a tar.

        The bytes depend only on the images and the table. All members of an image have the same key. They have
        the endings of the image and its sidecar files, ``.json`` for the image's row of the table, and endings such as
        ``.depth.tif`` for products. The image's name cannot be the key, as WebDataset treats everything after the first
        dot as the ending.

        Parameters
        ----------
        map_type : str
        keys : mapping of str to str
            Keys by image names without ending.
        table : Table
            A row for each image, in the order of packing.
        products : sequence of str

        Returns
        -------
        bytes, dict of str to Member
            The tar, and the positions of the image files by name without ending.
        """
        # Times are written as text, as in tables.
        columns = [
            one._replace(kind=TEXT, values=table.time_utc) if one.kind == TIME else one
            for one in written_columns(table)
        ]
        members: dict[str, Member] = {}
        buffer = io.BytesIO()
        with tarfile.open(fileobj=buffer, mode="w", format=tarfile.USTAR_FORMAT) as tar:

            def add(name: str, data: bytes) -> Member:
                info = tarfile.TarInfo(name)
                info.size = len(data)
                begin = tar.offset + tarfile.BLOCKSIZE
                tar.addfile(info, io.BytesIO(data))
                return Member(begin, len(data))

            for row, file_name in enumerate(table.img_names):
                name, _, ending = file_name.rpartition(".")
                key = keys[name]
                members[name] = add(f"{key}.{ending}", self._files[map_type, file_name])
                values = {one.header: json_cell(one, row) for one in columns}
                add(f"{key}.json", json.dumps(values, ensure_ascii=False).encode("utf-8"))
                for (folder, other), data in self._companions(map_type, name, file_name, products):
                    product = "" if folder == map_type else f".{folder}"
                    add(f"{key}{product}{other[len(name) :]}", data)
        return buffer.getvalue(), members

    def _companions(
        self, map_type: str, name: str, file_name: str, products: Sequence[str]
    ) -> list[tuple[tuple[str, str], bytes]]:
        """Other files of an image: its sidecar files and products."""
        endings = (".jgw", ".pgw", f"{file_name[len(name) :]}.aux.xml")
        wanted = [(map_type, name + ending) for ending in endings]
        twins = [twin_type(map_type, kind) for kind in TWINS]
        wanted += [(twin, name + ending) for twin in twins for ending in (file_name[len(name) :], *endings)]
        # Labels are TIFF or PNG, the latter with sidecar files.
        of_labels = (".tif", ".png", ".pgw", ".png.aux.xml")
        wanted += [(product, name + ending) for product in products for ending in of_labels]
        return [(one, self._files[one]) for one in wanted if one in self._files]


def shard_index(shards: Mapping[str, tuple[int, int]]) -> dict[str, Any]:
    """Return the index of shards, given as numbers of images and bytes by file name."""
    listed = [{"url": name, "nsamples": images, "filesize": size} for name, (images, size) in shards.items()]
    return {"__kind__": "wids-shard-index-v1", "wids_version": 1, "shardlist": listed}
