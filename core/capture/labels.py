"""Labels of a capture: opened for its products, and the tables of classes and instances."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path

from ..dataset.folder import CLASSES_FILE, INSTANCES_FILE
from ..errors import OutputError
from ..labels.label_map import LabelMap
from ..limits import MAX_TABLE_BYTES
from ..mission.parts import CLASSES, INSTANCES, LABELLED, PixelLabels
from ..mission.plan import Plan
from ..storage.files import csv_bytes, json_bytes, read_existing, write_whole
from .writers import label_format


def open_labels(plan: Plan, labels: PixelLabels | None = None) -> LabelMap | None:
    """Open the labels of a plan, as `picture.labels.plan_labels`; None if its products have none."""
    if not set(LABELLED) & set(plan.mission.products):
        return None
    # Imported here, as only labels need vector files.
    from ..picture.labels import plan_labels

    return plan_labels(plan, labels)


def absolute_labels(labels: PixelLabels) -> PixelLabels:
    """Labels with absolute paths, for processes with another current folder."""
    if not labels.labels:
        return labels
    from ..picture.labels import whole_layer_path

    return replace(labels, labels=tuple(map(whole_layer_path, labels.labels)))


def write_label_tables(labels: LabelMap, root: Path, image_format: str) -> None:
    """Write the tables of classes and of instances beside the mission, the latter row by row.

    Raises
    ------
    OutputError
        The folder has images of other classes or instances, as a layer has changed since; nothing is written.
    """
    types = {CLASSES: labels.classes.dtype, INSTANCES: labels.instance_dtype}
    files = {
        name: {"format": label_format(image_format, dtype), "bits": 8 * dtype.itemsize} for name, dtype in types.items()
    }
    classes = json_bytes({**labels.classes.to_json(), "files": files})

    def rows() -> Iterator[bytes]:
        header = ("id", "class", "layer", "feature")
        return (csv_bytes([row]) for row in chain([header], labels.instance_rows()))

    for name, parts in ((CLASSES_FILE, iter([classes])), (INSTANCES_FILE, rows())):
        if not _may_be(root / name, parts):
            raise OutputError(
                "folder {0}: its {1} is of other labels, as layers have changed since its images were made",
                root,
                name,
                remedy="choose another folder, or restore the layers",
            )
    write_whole(root / CLASSES_FILE, classes)
    write_whole(root / INSTANCES_FILE, rows())


def _may_be(path: Path, parts: Iterator[bytes]) -> bool:
    """Whether a file has this content, or does not exist yet."""
    data = read_existing(path, MAX_TABLE_BYTES)
    if data is None:
        return True
    at = 0
    for part in parts:
        if not data.startswith(part, at):
            return False
        at += len(part)
    return at == len(data)
