r"""What Ultralytics reads of the export of labels to YOLO.

    python -m venv peers && peers/bin/pip install ultralytics
    terrainav capture --coords "35.160_-89.898_35.156_-89.894_100" --frame camera --tilt 45 \
        --labels fields.geojson:crop --format png --data-dir out
    terrainav split out && terrainav export out yolo --as yolo
    peers/bin/python benchmarks/label_peers.py out yolo

Its reader takes the folder; its boxes and the masks that it fills are compared with the pixels of ``classes`` and
``instances``, which the script reads itself. Nothing is trained and nothing downloaded.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image
from ultralytics.data.dataset import YOLODataset
from ultralytics.data.utils import check_det_dataset, polygon2mask


def masks_of(folder: Path, stem: str) -> list[tuple[int, np.ndarray]]:
    """Class and mask of each class and instance of an image, by instance, then class."""
    table = json.loads((folder / "classes.json").read_text(encoding="utf-8"))
    numbers = {one: at for at, one in enumerate(sorted(one["id"] for one in table["classes"]))}
    files = (next((folder / kind).glob(f"{stem}.*[gf]")) for kind in ("instances", "classes"))
    instances, classes = (np.asarray(Image.open(file)).astype(np.int64) for file in files)
    keys = sorted(set(zip(instances.ravel().tolist(), classes.ravel().tolist())))
    return [(numbers[one], (classes == one) & (instances == at)) for at, one in keys if at and one in numbers]


def main() -> None:
    """Compare each part."""
    folder, yolo = map(Path, sys.argv[1:])
    data = check_det_dataset(str(yolo / "data.yaml"), autodownload=False)
    for part in ("train", "val", "test"):
        if data.get(part) is None:
            continue
        read = YOLODataset(img_path=data[part], data=data, task="segment", augment=False)
        count, box_px, more = 0, 0.0, []
        for found in read.labels:
            wanted = masks_of(folder, Path(found["im_file"]).stem)
            height, width = found["shape"]
            if [number for number, _ in wanted] != found["cls"][:, 0].astype(int).tolist():
                sys.exit(f"{found['im_file']}: other classes")
            for (_, mask), box, corners in zip(wanted, found["bboxes"], found["segments"]):
                (y, x), size = np.nonzero(mask), (width, height, width, height)
                edges = x.min(), y.min(), x.max() + 1, y.max() + 1
                middle = [(edges[at] + edges[at + 2]) / 2 for at in (0, 1)]
                sides = [edges[at + 2] - edges[at] for at in (0, 1)]
                box_px = max(box_px, float(np.abs(box * size - [*middle, *sides]).max()))
                filled = polygon2mask((height, width), [(corners * [width, height]).ravel()]).astype(bool)
                if not (filled | ~mask).all():
                    sys.exit(f"{found['im_file']}: lacks pixels")
                more.append(filled.sum() / mask.sum() - 1.0)
                count += 1
        print(
            f"{part}: {len(read.labels)} images, {count} instances; boxes within {box_px:.1g} px; filled masks hold "
            f"all pixels, and {np.median(more):.1%} more (median)"
        )


if __name__ == "__main__":
    main()
