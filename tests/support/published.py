"""Datasets of others, written as by their programs."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from PIL import Image

HEAD = ",img_names,columns,row,Lat,Lon,Alt,entropies"
#: Folder of the published flight, with its metres above ground, field of view, and label of the aspect ratio 4:3.
FLIGHT = "raster_images_35.1375_-89.8615_0_120.0_78.8_4_4"


def picture(seed, blank=False, size=(64, 48)) -> Image.Image:
    """Image of noise, or a blank one."""
    width, height = size
    if blank:
        return Image.new("RGB", size, (240, 240, 240))
    return Image.fromarray(np.random.default_rng(seed).integers(0, 256, (height, width, 3), np.uint8))


def write_published(
    folder: Path,
    *,
    images="",
    columns=3,
    rows=2,
    zoom=17,
    size=(64, 48),
    blank=(),
    entropies=True,
    start=(35.16, -89.9),
) -> list[str]:
    """Write a map type with its table, as the paper's ``to_csv`` writes it: an unnamed index, numbers with a point.

    Parameters
    ----------
    images : str
        Folder of the images inside; beside the table if empty.
    blank : collection of (column, row)
        Images without anything to see.
    entropies : bool
        Whether the table has a column of entropies.

    Returns
    -------
    list of str
        Names, in the order of the table.
    """
    place = folder / images
    place.mkdir(parents=True)
    lines, names = [HEAD if entropies else HEAD.rpartition(",")[0]], []
    for column in range(columns):
        for row in range(rows):
            lat, lon = round(start[0] - 0.001065 * row, 7), round(start[1] + 0.0017293 * column, 7)
            name = f"{column}_{row}_{lat}_{lon}_{zoom}.jpg"
            plain = (column, row) in blank
            picture(10 * column + row, plain, size).save(place / name)
            cells = [len(names), name, float(column), float(row), lat, lon, float(zoom)]
            lines.append(",".join(map(str, [*cells, *([1.25 if plain else 7.5] if entropies else [])])))
            names.append(name)
    (folder / "meta_data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return names


def flown_size(agl_m: float, fov_deg: float, lat_deg: float, zoom: int) -> tuple[int, int]:
    """Size in px, at a zoom and on a sphere, of a camera's image with an aspect ratio of 4:3."""
    diagonal_px = 2.0 * agl_m * math.tan(math.radians(fov_deg / 2.0))
    diagonal_px /= 40075016.686 / (256 * 2**zoom) * math.cos(math.radians(lat_deg))
    return int(0.8 * diagonal_px), int(0.6 * diagonal_px)


def write_vbn(folder: Path, stems, *, texts=None, line=" {lat} {lon} {alt} ") -> None:
    """Write the supplement's layout: an image and a text of ``key: value`` lines for each stem.

    Parameters
    ----------
    texts : list of str or None
        Stems of the texts, if they differ from those of the images.
    line : str
        Template of the text after the colon of the position.
    """
    (folder / "JPG2").mkdir(parents=True)
    (folder / "MetaData2").mkdir()
    for index, stem in enumerate(stems):
        picture(index).save(folder / "JPG2" / f"{stem}.jpg")
    for index, stem in enumerate(stems if texts is None else texts):
        position = line.format(lat=35.0 + index / 100.0, lon=-90.0 + index / 50.0, alt=1000.5 + index)
        (folder / "MetaData2" / f"{stem}.txt").write_text(
            f"Image_name: frame {index}\nPlatform_position_LatLongAlt:{position}\nPlatform_orientation: 0 0 {index}\n",
            encoding="utf-8",
        )
