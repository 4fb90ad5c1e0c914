"""Small datasets written by hand, with different images and rows of every kind."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

PARTS = ("train", "train", "validation", "train", "test", "train", "gap", "train")
HEAD = "img_names,columns,rows,Lat,Lon,Alt,entropies,status,reason,rejected,split"


def pixels_of(number: int, height: int = 30, width: int = 40) -> np.ndarray:
    """Pixels (height, width, 3) of a smooth image with a sharp edge, different for each number."""
    y, x = np.mgrid[:height, :width] * (30 / height)
    red, green = 128 + 100 * np.sin(x / 9 + number), 128 + 100 * np.cos(y / 7 - number)
    blue = np.where(x + y > 20 + number, 220, 30)
    return np.stack([red, green, blue], axis=-1).astype(np.uint8)


def write_dataset(
    folder: Path, count: int = 24, ending: str = "png", *, split: bool = True, map_types=("satellite",)
) -> Path:
    """Write a dataset of ``count`` rows, the last one failed and the one before rejected; returns its folder."""
    for kind, map_type in enumerate(map_types):
        (folder / map_type).mkdir(parents=True)
        lines = [HEAD if split else HEAD.rpartition(",")[0]]
        for number in range(count):
            lat, lon = round(35.16 - 0.001 * (number // 6), 8), round(-89.9 + 0.001 * (number % 6), 8)
            name = f"{number % 6}_{number // 6}_{lat}_{lon}_17.{ending}"
            failed, rejected = number == count - 1, number == count - 2
            if not failed:
                Image.fromarray(pixels_of(number + 50 * kind)).save(folder / map_type / name)
            cells = [name, number % 6, number // 6, lat, lon, 17, "" if failed else 5.0]
            cells += ["failed" if failed else "done", "no tile" if failed else ""]
            cells += ["entropy 1.000 below 2.1" if rejected else ""]
            cells += [("" if failed or rejected else PARTS[number % len(PARTS)])] if split else []
            lines.append(",".join(map(str, cells)))
        (folder / map_type / "meta_data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return folder
