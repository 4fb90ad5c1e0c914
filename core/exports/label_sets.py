"""Write images and their labels as training sets for detection and segmentation, in the layouts of COCO and YOLO."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Numbers
from ..dataset.dataset import ImageSet, read_dataset
from ..dataset.entropy import Report
from ..dataset.folder import PIXEL_LABELS, TEST, TRAIN, VALIDATION
from ..dataset.label_images import LabelImages
from ..errors import InvalidInput
from ..map_types import SATELLITE
from ..storage.files import link_or_copy, make_folder, partial_folder, write_whole
from .huggingface import credit_line, report_share, rows_of_parts
from .masks import Masks, join_rings

#: Names of the parts in both layouts; without a split, all images are for training.
_PART_NAMES = {"": "train", TRAIN: "train", VALIDATION: "val", TEST: "test"}
#: Digits of coordinates in YOLO's labels, for edges of pixels within 0.01 px in images of any size.
_DIGITS = 8


@dataclass(frozen=True, eq=False)
class LabelledSet:
    """Images of one map type with labels.

    Parameters
    ----------
    images : ImageSet
    rows : mapping of str to array
        Rows of each part, by the part's name in the layouts.
    """

    images: ImageSet
    rows: Mapping[str, Numbers]
    labels: LabelImages

    @classmethod
    def read(cls, folder: str | os.PathLike[str], map_type: str | None = None) -> LabelledSet:
        """Read a dataset, but no pixels.

        Parameters
        ----------
        map_type : str or None
            None for ``satellite`` or, without it, the first.

        Raises
        ------
        InvalidInput
            The folder is not a dataset, lacks the map type, or has no images or no labels.
        """
        sets = read_dataset(folder)
        default = SATELLITE if SATELLITE in sets.image_sets else next(iter(sets.image_sets))
        name = map_type or default
        images = sets.image_set(name)
        labels = LabelImages(images)
        _ = labels.classes, images.image_folder
        if not all((labels.folder / one).is_dir() for one in PIXEL_LABELS):
            raise InvalidInput(
                "folder {0}: has labels without both {1} and {2}",
                labels.folder,
                *PIXEL_LABELS,
                remedy="capture it with both products",
            )
        rows = {_PART_NAMES[part]: some for part, some in rows_of_parts(name, images).items()}
        return cls(images, rows, labels)

    def __len__(self) -> int:
        return sum(map(len, self.rows.values()))

    @property
    def names(self) -> dict[int, str]:
        """Names of classes by id, ascending."""
        return {one.id: one.name for one in sorted(self.labels.classes.classes, key=lambda one: one.id)}

    def masks(self, row: int) -> Masks:
        """Masks of a row's image, without background and *ignore*; raises InvalidInput if they cannot be read."""
        classes, instances = (self.labels.pixels(kind, row) for kind in PIXEL_LABELS)
        name = self.images.table.img_names[row]
        if classes.shape != instances.shape:
            raise InvalidInput("labels of {0}: must have the same size in {1} and {2}", name, *PIXEL_LABELS)
        table = self.labels.classes
        masks = Masks(classes, instances, (0, table.ignore))
        unknown = np.setdiff1d(masks.classes, list(self.names))
        if len(unknown):
            raise InvalidInput("labels of {0}: the class {1} is not in the table of classes", name, int(unknown[0]))
        return masks


@dataclass
class _SetWriter:
    """Writing of a set into a folder."""

    found: LabelledSet
    root: Path
    progress: Report | None
    done: int = 0

    def masks(self, part: str, folder: str) -> Iterator[tuple[int, Masks]]:
        """Place the images of a part in a folder; yield their rows and masks."""
        images = self.found.images
        for row in self.found.rows[part].tolist():
            link_or_copy(images.path(row), self.root / folder / images.table.img_names[row])
            yield row, self.found.masks(row)
            self.done += 1
            report_share(self.progress, self.done / len(self.found))

    def write(self, file: str, data: bytes | Iterator[bytes]) -> None:
        make_folder((self.root / file).parent)
        write_whole(self.root / file, data)


def write_coco(
    folder: str | os.PathLike[str],
    target: str | os.PathLike[str],
    map_type: str | None = None,
    progress: Report | None = None,
) -> int:
    """Write a dataset with labels in the layout of COCO; return the number of images.

    ``annotations/instances_train.json`` describes the images in ``train``, and so on for ``val`` and ``test``. Each
    class and instance of an image is an annotation: polygons along the edges of its pixels or, if it has holes, run
    lengths. Pixels of a class that belong to no instance are one annotation with ``iscrowd``. Background and *ignore*
    have none. Images are hard links to the dataset's files, or copies.

    Parameters
    ----------
    target : path
        A new or empty folder, whose name ends in ``.part`` until the export is complete.
    map_type : str or None
        Map type to export; None for ``satellite`` or, without it, the first.
    progress : callable
        Called with the share done, 0 to 1, after each image; returning False cancels, and removes the export.

    Raises
    ------
    Cancelled
        ``progress`` returned False.
    InvalidInput
        The folder is not a dataset, lacks the map type, or has no images or no labels.
    OutputError
        The folder cannot be written or is not empty.
    """
    found = LabelledSet.read(folder, map_type)
    with partial_folder(target) as root:
        export = _SetWriter(found, root, progress)
        for part in found.rows:
            export.write(f"annotations/instances_{part}.json", _coco(export, part))
    return export.done


def _coco(export: _SetWriter, part: str) -> Iterator[bytes]:
    """COCO's description of a part, with one line for each annotation and image."""
    found = export.found
    names = found.images.table.img_names
    number = 0
    sizes: list[tuple[int, int]] = []
    yield b'{"annotations": ['
    for _, masks in export.masks(part, part):
        image = len(sizes) + 1
        for one in coco_annotations(masks):
            number += 1
            yield _line({"id": number, "image_id": image, **one}, number == 1)
        sizes.append((masks.width, masks.height))
    yield b'\n],\n"images": ['
    for image, (row, (width, height)) in enumerate(zip(found.rows[part].tolist(), sizes), 1):
        about = {"id": image, "file_name": names[row], "width": width, "height": height, "license": 1}
        yield _line(about, image == 1)
    categories = [{"id": one, "name": name, "supercategory": ""} for one, name in found.names.items()]
    rest = {
        "categories": categories,
        "info": {"description": "Labels of images, made with TerrAInav"},
        "licenses": [{"id": 1, "name": f"Terms of who made the imagery: {credit_line(found.images)}", "url": ""}],
    }
    yield b"\n],\n" + json.dumps(rest, ensure_ascii=False)[1:].encode() + b"\n"


def _line(value: Mapping[str, Any], is_first: bool) -> bytes:
    return f"{'' if is_first else ','}\n{json.dumps(value, ensure_ascii=False)}".encode()


def coco_annotations(masks: Masks) -> Iterator[dict[str, Any]]:
    """Yield the annotations of an image, without their ids."""
    outlines, lengths = masks.outlines, masks.run_lengths()
    with_hole = set(outlines.mask[outlines.is_hole].tolist())
    size = [masks.height, masks.width]
    for at, (category, instance) in enumerate(zip(masks.classes.tolist(), masks.instances.tolist())):
        is_crowd = instance == 0
        if is_crowd or at in with_hole:
            segmentation: Any = {"size": size, "counts": lengths[at]}
        else:
            segmentation = [ring.ravel().tolist() for ring in outlines.rings(at)]
        yield {
            "category_id": category,
            "instance": instance,
            "bbox": masks.boxes_px[at].tolist(),
            "area": int(masks.areas_px[at]),
            "iscrowd": int(is_crowd),
            "segmentation": segmentation,
        }


def write_yolo(
    folder: str | os.PathLike[str],
    target: str | os.PathLike[str],
    map_type: str | None = None,
    progress: Report | None = None,
) -> int:
    """Write a dataset with labels in the layout of Ultralytics' YOLO; return the number of images.

    ``data.yaml`` names the classes, from 0 in the order of their ids, and the folders ``images/train``, ``images/val``
    and ``images/test``. ``labels/train`` and so on have a text for each image, with a line for each class and instance:
    the class and one polygon along the edges of pixels, as shares of width and height. Parts and holes are joined by
    bridges along edges, which enclose nothing. Pixels that belong to no instance are left out.

    Parameters and exceptions are those of `write_coco`.
    """
    found = LabelledSet.read(folder, map_type)
    number = {one: at for at, one in enumerate(found.names)}
    with partial_folder(target) as root:
        export = _SetWriter(found, root, progress)
        for part in found.rows:
            make_folder(root / "labels" / part)
            for row, masks in export.masks(part, f"images/{part}"):
                stem = Path(found.images.table.img_names[row]).stem
                text = "".join(f"{number[one]} {polygon}\n" for one, polygon in yolo_polygons(masks))
                write_whole(root / "labels" / part / f"{stem}.txt", text.encode())
        write_whole(root / "data.yaml", _data_yaml(found).encode())
    return export.done


def yolo_polygons(masks: Masks) -> Iterator[tuple[int, str]]:
    """Yield class and polygon, as shares of width and height, of each instance in an image."""
    columns, rows = (
        np.array([f"{at / size:.{_DIGITS}g}" for at in range(size + 1)]) for size in (masks.width, masks.height)
    )
    outlines = masks.outlines
    for at in np.flatnonzero(masks.instances).tolist():
        x, y = join_rings(outlines.rings(at)).T
        yield int(masks.classes[at]), " ".join(np.stack([columns[x], rows[y]], axis=1).ravel().tolist())


def _data_yaml(found: LabelledSet) -> str:
    """Text of ``data.yaml``. Ultralytics needs ``val``, which is another part for datasets without validation."""
    parts = list(found.rows)
    validation = next((one for one in ("val", "test") if one in parts), parts[0])
    used = {"train": "train" if "train" in parts else parts[0], "val": validation}
    used.update({"test": "test"} if "test" in parts else {})
    lines = [f"# Made with TerrAInav. Terms of who made the imagery: {json.dumps(credit_line(found.images))}"]
    lines += [f"{one}: images/{part}" for one, part in used.items()]
    lines += ["names:", *(f"  {at}: {json.dumps(name)}" for at, name in enumerate(found.names.values()))]
    return "\n".join([*lines, ""])
