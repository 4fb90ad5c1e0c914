"""Write folders of images with a card, for Hugging Face's library ``datasets``."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..dataset.dataset import ImageSet, read_dataset
from ..dataset.entropy import Report
from ..dataset.folder import PARTS
from ..dataset.table import NUMBER, WHOLE, Column, image_parts, json_cell, usable_rows, written_columns
from ..errors import Cancelled, InvalidInput
from ..map_types import SATELLITE
from ..storage.files import link_or_copy, partial_folder, write_whole
from .tables import chosen_sets

METADATA_FILE = "metadata.jsonl"


def write_huggingface(
    folder: str | os.PathLike[str],
    target: str | os.PathLike[str],
    map_type: str | None = None,
    progress: Report | None = None,
) -> list[Path]:
    """Write a dataset as a folder for ``datasets.load_dataset``; return the paths of the card and the tables.

    Each map type is a configuration: a folder with the parts ``train``, ``validation`` and ``test`` of a split dataset,
    or with all images. Each part has a ``metadata.jsonl`` with the non-empty columns of ``meta_data.csv``. Images are
    hard links to the dataset's files, or copies if the file system has no links. Images that failed, are rejected or
    are in the gap between parts are left out.

    Parameters
    ----------
    target : path
        A new or empty folder; until everything is written, its name ends in ``.part``.
    map_type : str or None
        Map type to export; None for all.
    progress : callable
        Called with the share done, 0 to 1, after each image; returning False cancels, and removes the export.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    InvalidInput
        The folder is not a dataset, lacks the map type, or has no images to export.
    OutputError
        The folder cannot be written or is not empty.
    """
    sets = chosen_sets(read_dataset(folder), map_type)
    parts = {name: rows_of_parts(name, images) for name, images in sets.items()}
    count, total = 0, sum(len(rows) for one in parts.values() for rows in one.values())
    features, types = {}, {WHOLE: "int64", NUMBER: "float64"}
    written = [Path("README.md")]
    with partial_folder(target) as root:
        for name, images in sets.items():
            columns = _columns(images, np.concatenate([*parts[name].values()]))
            features[name] = {one.header: types.get(one.kind, "string") for one in columns}
            for part, rows in parts[name].items():
                place = Path(name, part)
                for row in rows.tolist():
                    link_or_copy(images.path(row), root / place / images.table.img_names[row])
                    count += 1
                    report_share(progress, count / total)
                written.append(place / METADATA_FILE)
                write_whole(root / written[-1], _lines(images, columns, rows))
        write_whole(root / written[0], _card(sets, parts, features).encode("utf-8"))
    return [Path(target) / one for one in written]


def report_share(progress: Report | None, share: float) -> None:
    """Report the share done of an export; raises Cancelled if the export is to stop."""
    if progress is not None and not progress(share):
        raise Cancelled("stopped while images were exported: nothing is left of the export")


def rows_of_parts(name: str, images: ImageSet) -> dict[str, Any]:
    """Rows of each non-empty part; without a split, rows of all images under an empty name."""
    rows, part = np.flatnonzero(usable_rows(images.table)), image_parts(images.table)
    if part is None:
        found = {"": rows} if len(rows) else {}
    else:
        by_part = {one: np.array([row for row in rows.tolist() if part[row] == one], np.int64) for one in PARTS}
        found = {one: some for one, some in by_part.items() if len(some)}
    if not found:
        raise InvalidInput("map type {0!r}: has no image to export", name)
    return found


def _columns(images: ImageSet, rows: Any) -> list[Column]:
    """Columns, except image names, that have a value in any of the rows."""
    _, *columns = written_columns(images.table)
    found = []
    for one in columns:
        # Times are exported as text, which all versions of the library read in the same way.
        values = images.table.time_utc if one.header == "time_utc" else one.values
        if any(values[row] for row in rows.tolist()) if isinstance(values, tuple) else np.isfinite(values[rows]).any():
            found.append(one._replace(values=values))
    return found


def _lines(images: ImageSet, columns: list[Column], rows: Any) -> Iterator[bytes]:
    for row in rows.tolist():
        cells = {one.header: json_cell(one, row) for one in columns}
        line = json.dumps({"file_name": images.table.img_names[row], **cells}, ensure_ascii=False)
        yield f"{line}\n".encode()


def _card(
    sets: Mapping[str, ImageSet],
    parts: Mapping[str, Mapping[str, Any]],
    features: Mapping[str, Mapping[str, str]],
) -> str:
    """Text of the card: YAML, then Markdown."""
    count = sum(len(rows) for one in parts.values() for rows in one.values())
    limits = {10**3: "n<1K", 10**4: "1K<n<10K", 10**5: "10K<n<100K", 10**6: "100K<n<1M", 10**7: "1M<n<10M"}
    size = next((text for limit, text in limits.items() if count < limit), "n>10M")
    lines = [
        "---",
        "license: other",
        "license_name: imagery-provider",
        f"size_categories: [{_quoted(size)}]",
        "tags: [geospatial, uav, visual-localization]",
        "configs:",
    ]
    default = SATELLITE if SATELLITE in sets else next(iter(sets))
    for name in sets:
        lines += [f"- config_name: {_quoted(name)}", f"  data_dir: {_quoted(name)}"]
        lines += ["  default: true"] if name == default else []
    lines.append("dataset_info:")
    for name, types in features.items():
        lines += [f"- config_name: {_quoted(name)}", "  features:"]
        for header, kind in {"image": "image", **types}.items():
            lines += [f"  - name: {_quoted(header)}", f"    dtype: {kind}"]
    lines += ["---", "", "# Georeferenced images with their poses", "", "| configuration | part | images |"]
    lines.append("| --- | --- | ---: |")
    lines += [
        f"| {name} | {part or 'all'} | {len(rows):,} |" for name, some in parts.items() for part, rows in some.items()
    ]
    lines += [
        "",
        "`Lat` and `Lon` are the ground in the middle of an image, in degrees (WGS 84); `Alt` is the zoom.",
        "`pose_lat_deg`, `pose_lon_deg` and `agl_m` are the camera's place and its height above the ground, `yaw_deg`,",
        "`tilt_deg` (0 looks straight down) and `roll_deg` its attitude.",
        "",
        "The terms are those of who made the imagery:",
        "",
    ]
    return "\n".join([*lines, *(f"- {name}: {credit_line(images)}" for name, images in sets.items()), ""])


def credit_line(images: ImageSet) -> str:
    """Sources of the imagery of a map type, with their attributions."""
    table = images.table
    found = dict.fromkeys(", ".join(text for text in pair if text) for pair in zip(table.source, table.attribution))
    return "; ".join(text for text in found if text) or "not known"


def _quoted(text: str) -> str:
    """YAML string: any JSON string is one."""
    return json.dumps(text, ensure_ascii=False)
