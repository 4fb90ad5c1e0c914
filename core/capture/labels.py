"""Labels of a capture: opened for its products, and the tables of classes and instances."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain
from pathlib import Path

from ..dataset.folder import CLASSES_FILE, INSTANCES_FILE
from ..labels.label_map import LabelMap
from ..mission.parts import CLASSES, INSTANCES, LABELLED, PixelLabels
from ..mission.plan import Plan
from ..storage.files import csv_bytes, json_bytes, write_whole
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
    """Write the tables of classes and of instances beside the mission, the latter row by row."""
    types = {CLASSES: labels.classes.dtype, INSTANCES: labels.instance_dtype}
    files = {
        name: {"format": label_format(image_format, dtype), "bits": 8 * dtype.itemsize} for name, dtype in types.items()
    }
    write_whole(root / CLASSES_FILE, json_bytes({**labels.classes.to_json(), "files": files}))
    header = ("id", "class", "layer", "feature")
    rows = chain([header], labels.instance_rows())
    write_whole(root / INSTANCES_FILE, (csv_bytes([row]) for row in rows))
