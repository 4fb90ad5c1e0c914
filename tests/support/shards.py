"""Datasets in shards, packed from the folder of a capture, in the form that a capture in blocks writes."""

from __future__ import annotations

import csv
import io
import json
import math
import tarfile
from pathlib import Path

from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import HEADERS, Table
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.storage.files import write_whole
from terrainav.core.storage.stores import Address, store_path

#: Mission over the embedded world: 20 images, 5 columns in 4 rows.
MISSION = Mission(Box(35.16, -89.90, 35.1561, -89.8927), 120.0, image_px=48, max_px=48, image_format="png")
#: Endings of the files that belong to an image.
_BESIDE = (".jgw", ".pgw", ".jpg.aux.xml", ".png.aux.xml", ".tif.aux.xml")
_COLUMNS = ("shard", "offset_bytes", "size_bytes")


def write_folders(folder: Path, mission: Mission = MISSION) -> Path:
    """Capture a mission over the embedded world as a folder of files; returns the folder."""
    source = open_source("world")
    assert not capture(plan(mission, source.grid), source, folder).failed
    return folder


def write_shards(target: Address, folder: Path, images_a_shard: int = 5) -> Path:
    """Pack the folder of a capture into shards at a folder or an address; returns the place.

    All map types are packed, with the products that the capture has beside them.
    """
    place = store_path(target)
    for name in ("mission.json", "plan.csv", "footprints.geojson", "classes.json", "instances.csv"):
        if (folder / name).is_file():
            _write(place / name, (folder / name).read_bytes())
    tables = sorted(folder.glob("*/meta_data.csv"))
    products = sorted(one for one in folder.iterdir() if one.is_dir() and not (one / "meta_data.csv").is_file())
    for path in tables:
        map_type, table = path.parent.name, Table.load(path)
        where, index = {}, []
        for number, first in enumerate(range(0, len(table), images_a_shard)):
            rows = [row for row in range(first, min(first + images_a_shard, len(table))) if table.made[row]]
            if not rows:
                continue
            name = f"{map_type}-{number:06d}.tar"
            data, ranges = _shard(path.parent, table, rows, products)
            where.update({row: (name, *ranges[row]) for row in rows})
            index.append({"url": name, "nsamples": len(rows), "filesize": len(data)})
            _write(place / map_type / name, data)
            journal = "".join(json.dumps({"key": f"{row:09d}"}) + "\n" for row in rows)
            _write(place / "blocks" / f"{map_type}-{number:06d}.jsonl", journal.encode())
        wids = {"__kind__": "wids-shard-index-v1", "wids_version": 1, "shardlist": index}
        _write(place / map_type / "shards.json", json.dumps(wids).encode())
        _write(place / map_type / "meta_data.csv", _table(path, where))
    return place


def _shard(
    folder: Path, table: Table, rows: list[int], products: list[Path]
) -> tuple[bytes, dict[int, tuple[int, int]]]:
    """A tar of some rows' images, and the offset and size of each image in it."""
    ranges = {}
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w", format=tarfile.USTAR_FORMAT) as tar:

        def add(name: str, data: bytes) -> tuple[int, int]:
            member = tarfile.TarInfo(name)
            member.size = len(data)
            tar.addfile(member, io.BytesIO(data))
            return file.tell() - len(data) - -len(data) % 512, len(data)

        for row in rows:
            key, name = f"{row:09d}", table.img_names[row]
            stem, ending = Path(name).stem, Path(name).suffix
            ranges[row] = add(key + ending, (folder / name).read_bytes())
            add(f"{key}.json", json.dumps(_row(table, row)).encode())
            for beside in _BESIDE:
                if (folder / (stem + beside)).is_file():
                    add(key + beside, (folder / (stem + beside)).read_bytes())
            for product in products:
                for other in (".tif", ".png"):
                    if (product / f"{stem}{other}").is_file():
                        add(f"{key}.{product.name}{other}", (product / f"{stem}{other}").read_bytes())
    return file.getvalue(), ranges


def _row(table: Table, row: int) -> dict[str, object]:
    """Values of an image in the table, by field; the file's name is ``img_name``."""
    known: dict[str, object] = {"img_name": table.img_names[row]}
    for name in HEADERS:
        value = getattr(table, name)[row]
        value = value if isinstance(value, str) else value.item()
        if name not in ("img_names", *_COLUMNS) and value != "" and not math.isnan(_number(value)):
            known[name] = value
    return known


def _number(value: object) -> float:
    return value if isinstance(value, float) else 0.0


def _table(path: Path, where: dict[int, tuple[str, int, int]]) -> bytes:
    """The table with the three columns of shards."""
    with path.open(encoding="utf-8", newline="") as file:
        head, *lines = csv.reader(file)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([*head, *_COLUMNS])
    writer.writerows([*cells, *where.get(row, ("", "", ""))] for row, cells in enumerate(lines))
    return out.getvalue().encode("utf-8")


def _write(path: Path, data: bytes) -> None:
    if isinstance(path, Path):
        path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, data)
