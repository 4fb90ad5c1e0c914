r"""What Hugging Face's datasets, mlcroissant and pandas read of the exports of a dataset.

    python -m venv peers && peers/bin/pip install datasets mlcroissant pandas pyarrow
    terrainav capture --coords "35.1450_-89.8620_35.1405_-89.8560_100" --map-type satellite roadmap --image-px 96 \
        --format jpg --data-dir out
    terrainav clean out --move && terrainav split out
    terrainav export out hf --as huggingface && terrainav export out --as croissant
    terrainav export out --as parquet
    peers/bin/python benchmarks/dataset_peers.py out hf

Each is compared with ``meta_data.csv``, which the script reads itself: images and their sizes, and every value of every
column. Nothing is asked of a hub.
"""

from __future__ import annotations

import csv
import json
import os
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

os.environ["HF_HUB_OFFLINE"] = "1"

import datasets
import mlcroissant
import pandas as pd
import pyarrow.parquet

TABLE_FILE, PARTS = "meta_data.csv", ("train", "validation", "test")
Rows = Mapping[str, Mapping[str, str]]


def rows_of(table: Path) -> Rows:
    """Rows by image name."""
    with table.open(encoding="utf-8", newline="") as file:
        return {row["img_names"]: row for row in csv.DictReader(file)}


def same(value: Any, cell: str) -> bool:
    """Whether a value is what a cell says, to the last digit."""
    if value is None or value != value or value is pd.NaT:
        return cell == ""
    if isinstance(value, pd.Timestamp):
        return value == pd.Timestamp(cell)
    if isinstance(value, bytes):
        value = value.decode()
    return value == cell if isinstance(value, str) else float(value) == float(cell)


def check(what: str, found: Mapping[str, Mapping[str, Any]], rows: Rows, wanted: set[str]) -> None:
    """Print how much is the same; ends the program where something is not."""
    if set(found) != wanted:
        raise SystemExit(f"{what}: {len(found)} images, not {len(wanted)}")
    values = 0
    for name, record in found.items():
        for column, value in record.items():
            if not same(value, rows[name][column]):
                raise SystemExit(f"{what}: {column} of {name} is {value!r}, not {rows[name][column]!r}")
            values += 1
    print(f"{what}: {len(found)} images, {values:,} values as in the table")


def huggingface(folder: Path, map_type: str, rows: Rows) -> None:
    """Parts, features and images."""
    datasets.disable_progress_bars()
    with tempfile.TemporaryDirectory() as cache:
        parts = datasets.load_dataset(str(folder), map_type, cache_dir=cache)
        by_place = {(row["columns"], row["rows"]): name for name, row in rows.items()}
        for part, images in parts.items():
            found = {}
            for record in images:
                picture = record.pop("image")
                found[by_place[str(record["columns"]), str(record["rows"])]] = record
                if picture.size != (record["image_width_px"], record["image_height_px"]):
                    raise SystemExit(f"datasets: an image of {picture.size} px")
            split = any(row.get("split") for row in rows.values())
            wanted = {
                name
                for name, row in rows.items()
                if row["status"] == "done"
                and not row.get("rejected")
                and (row["split"] == part if split else part == PARTS[0])
            }
            check(f"datasets {datasets.__version__}, {map_type}, {part}", found, rows, wanted)


def croissant(folder: Path, map_type: str, rows: Rows) -> None:
    """Records, with images."""
    described = mlcroissant.Dataset(folder / "croissant.json")
    found = {}
    for record in described.records(map_type):
        values = {name.rpartition("/")[2]: value for name, value in record.items()}
        if values.pop("image").size != (values["image_width_px"], values["image_height_px"]):
            raise SystemExit("mlcroissant: an image of another size")
        found[values.pop("file").decode()] = values
    there = {path.name for path in (folder / map_type).rglob("*.jpg")}
    check(f"mlcroissant, {map_type}", found, rows, there)


def parquet(folder: Path, map_type: str, rows: Rows) -> None:
    """Types, values, and what GeoParquet says of the footprints."""
    path = folder / map_type / "meta_data.parquet"
    table = pd.read_parquet(path)
    shapes = table.pop("geometry")
    records = table.astype(object).to_dict("records")
    check(
        f"pandas {pd.__version__}, {map_type}",
        {row["img_names"]: row for row in records},
        rows,
        set(rows),
    )
    about = json.loads(pyarrow.parquet.read_schema(path).metadata[b"geo"])
    (column,) = about["columns"].values()
    print(f"  GeoParquet {about['version']}: {shapes.notna().sum()} footprints, {column['geometry_types']}")


def main() -> None:
    """Compare all."""
    folder, hf = map(Path, sys.argv[1:3])
    for table in sorted(folder.glob(f"*/{TABLE_FILE}")):
        map_type, rows = table.parent.name, rows_of(table)
        huggingface(hf, map_type, rows)
        croissant(folder, map_type, rows)
        parquet(folder, map_type, rows)


if __name__ == "__main__":
    main()
