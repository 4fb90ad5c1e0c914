"""Datasets whose images show their own labels: grey levels are ten times the class, in boxes that are instances."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from PIL import Image

from tests.support.datasets import HEAD, PARTS

#: Grey levels of the images between one class and the next.
STEP = 10
NAMES = ("field", "wood", "water", "road", "roof", "wall")


def labels_of(number: int, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Classes, 0 to 6, and instances, from 1, of 5 x 6 boxes; the upper left corner is *ignore*."""
    boxes = (np.arange(height) * 5 // height)[:, np.newaxis] * 50 + np.arange(width) * 6 // width
    instances = 1 + boxes + 1000 * number
    classes = (boxes * 3 + boxes // 50 + number) % 7
    classes[:5, :7], instances[:5, :7] = 255, 0
    return classes, instances


def write_labelled(
    folder: Path, count: int = 16, size: tuple[int, int] = (64, 48), ending: str = "png", files: str = "png", wide=False
) -> Path:
    """Write a dataset of images (width, height) with classes and instances; returns its folder.

    Parameters
    ----------
    files : str
        Format of the files of labels.
    wide : bool
        Whether classes take 16 bits, and instances 32.
    """
    width, height = size
    for name in ("satellite", "classes", "instances"):
        (folder / name).mkdir(parents=True)
    lines = [HEAD]
    for number in range(count):
        lat, lon = round(35.16 - 0.001 * (number // 6), 8), round(-89.9 + 0.001 * (number % 6), 8)
        name = f"{number % 6}_{number // 6}_{lat}_{lon}_17"
        classes, instances = labels_of(number, height, width)
        grey = np.where(classes == 255, 255, STEP * classes).astype(np.uint8)
        Image.fromarray(np.stack([grey] * 3, axis=-1)).save(folder / "satellite" / f"{name}.{ending}")
        if wide:
            classes = np.where(classes == 255, 65535, classes * 1000).astype(np.uint16)
            instances = (instances * 10_000).astype(np.uint32)
        image = Image.fromarray(classes.astype(np.uint16 if wide else np.uint8))
        if not wide:
            image.putpalette(bytes(range(256)) * 3)
        image.save(folder / "classes" / f"{name}.{files}")
        stored = Image.fromarray(instances.astype(np.int32) if wide else instances.astype(np.uint16))
        stored.save(folder / "instances" / f"{name}.{'tif' if wide else files}")
        cells = [f"{name}.{ending}", number % 6, number // 6, lat, lon, 17, 5.0, "done", "", "", PARTS[number % 8]]
        lines.append(",".join(map(str, cells)))
    (folder / "satellite" / "meta_data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    scale = 1000 if wide else 1
    classes = [{"id": at * scale, "name": name, "color": f"#{at:06x}"} for at, name in enumerate(NAMES, 1)]
    table = {"background": 0, "ignore": 65535 if wide else 255, "classes": classes}
    (folder / "classes.json").write_text(json.dumps(table), encoding="utf-8")
    return folder
