"""Labels of an image, in colours over it. On any thread; no file stays open."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from qgis.PyQt.QtGui import QImage

from ...core.dataset.folder import CLASSES_FILE, INSTANCES_FILE
from ...core.errors import InvalidInput, TerrAInavError
from ...core.labels.classes import BACKGROUND, MAX_CLASSES_BYTES, default_colour, read_classes
from ...core.limits import MAX_TABLE_BYTES
from ...core.mission.parts import CLASSES, INSTANCES
from ...core.storage.files import file_exists, open_foreign, read_existing, text_lines
from ...core.text.plain import one_line, whole_number
from ..i18n import tr, translate
from .picture import read_band, rgba_image

#: Endings of files of labels: as images that are GeoTIFF, and PNG otherwise.
_ENDINGS = (".tif", ".png")
#: Colour of pixels without ground, and of features without a value.
IGNORE_COLOUR = "#ffffff"
#: Step between the hues of consecutive instances, which keeps neighbours apart.
_GOLDEN = 0.6180339887498949


class LegendEntry(NamedTuple):
    """A class or the background: colour as #rrggbb (empty if not drawn), name, and share of the image's pixels."""

    colour: str
    name: str
    share: float


class LabelOverlay(NamedTuple):
    """Labels of an image.

    Parameters
    ----------
    image : QImage or None
        Classes or instances in colours; background is transparent. None if the labels cannot be read.
    legend : tuple of LegendEntry
        Classes in this image, the largest first; empty if classes were not written.
    count : int
        Number of instances in this image.
    classes, instances : array (h, w) or None
        Labels of the displayed pixels; None if not written.
    names : mapping of int to str
        Names of classes.
    features : mapping of int to (str, int)
        Layer and feature of the instances in this image; empty if the table of instances cannot be read.
    problem : str
        Reason why the labels cannot be read; empty if they can.
    """

    image: QImage | None
    legend: tuple[LegendEntry, ...] = ()
    count: int = 0
    classes: np.ndarray | None = None
    instances: np.ndarray | None = None
    names: Mapping[int, str] = MappingProxyType({})
    features: Mapping[int, tuple[str, int]] = MappingProxyType({})
    problem: str = ""

    def text_at(self, x: float, y: float) -> str:
        """Class, instance and feature at ``x, y``, shares of width and height from 0 to 1; empty for background."""
        found = []
        at_class, at_instance = (_at(one, x, y) for one in (self.classes, self.instances))
        if at_class:
            found.append(self.names.get(at_class, str(at_class)))
        if at_instance:
            found.append(tr("instance {number}").format(number=at_instance))
        if at_instance in self.features:
            layer, feature = self.features[at_instance]
            found.append(tr("feature {number} of {layer}").format(number=feature, layer=layer))
        return ", ".join(found)


def read_labels(folder: Path, name: str, shown: str, longest_px: int, fetched: Mapping[str, bytes]) -> LabelOverlay:
    """Read the labels of an image, to the nearest pixels of the size at which `picture.read_picture` reads it.

    Parameters
    ----------
    folder : Path
        Folder of the dataset.
    name : str
        Image, without ending.
    shown : str
        Product in colours, `CLASSES` or `INSTANCES`.
    longest_px : int
    fetched : mapping of str to bytes
        Contents of remote files by product.
    """
    try:
        classes, instances = (_values(folder / one, name, longest_px, fetched.get(one)) for one in (CLASSES, INSTANCES))
        if (classes if shown == CLASSES else instances) is None:
            return LabelOverlay(None, problem=tr("There are no labels (yet)."))
        table = folder / CLASSES_FILE
        content = read_existing(table, MAX_CLASSES_BYTES)
        known = () if content is None else read_classes(content, str(table)).classes
    except (RuntimeError, TerrAInavError) as wrong:
        reason = translate(wrong) if isinstance(wrong, TerrAInavError) else one_line(str(wrong))
        return LabelOverlay(None, problem=tr("The labels cannot be read: {reason}").format(reason=reason))
    numbers = set() if instances is None else set(np.unique(instances).tolist()) - {0}
    names = {one.id: one.name for one in known}
    colours = {one.id: one.colour for one in known}
    legend: tuple[LegendEntry, ...] = ()
    if classes is not None:
        ignore = int(np.iinfo(classes.dtype).max)
        names.update({BACKGROUND: tr("background"), ignore: tr("ignore")})
        colours[ignore] = IGNORE_COLOUR
        legend = _legend(classes, names, colours)
    image = _class_image(classes, colours) if shown == CLASSES else _instance_image(instances)
    features = _features(folder / INSTANCES_FILE, numbers)
    return LabelOverlay(image, legend, len(numbers), classes, instances, names, features)


def _values(folder: Path, name: str, longest_px: int, fetched: bytes | None) -> np.ndarray | None:
    """Labels (h, w) of a file, fetched or in a folder; None if there is none."""
    paths = [folder / f"{name}{ending}" for ending in _ENDINGS]
    path = next((one for one in paths if fetched is not None or file_exists(one)), None)
    if path is None:
        return None
    values, _ = read_band(path, longest_px, fetched)
    if values.ndim != 2 or values.dtype.kind != "u":
        raise InvalidInput(tr("{file}: holds no whole numbers from 0").format(file=f"{folder.name}/{path.name}"))
    return values


def _legend(classes: np.ndarray, names: Mapping[int, str], colours: dict[int, str]) -> tuple[LegendEntry, ...]:
    """Classes in an image, the largest first, and then its background; unknown ones get colours of their own."""
    ids, counts = np.unique(classes, return_counts=True)
    rows = sorted(zip(ids.tolist(), counts.tolist()), key=lambda row: (row[0] == BACKGROUND, -row[1]))
    for number, _ in rows:
        if number != BACKGROUND:
            colours.setdefault(number, default_colour(number - 1))
    return tuple(
        LegendEntry(colours.get(number, ""), names.get(number, str(number)), count / classes.size)
        for number, count in rows
    )


def _class_image(classes: np.ndarray, colours: Mapping[int, str]) -> QImage:
    """Classes in their colours; background is transparent."""
    table = np.zeros((int(np.iinfo(classes.dtype).max) + 1, 4), np.uint8)
    for number, colour in colours.items():
        table[number] = [*bytes.fromhex(colour[1:]), 255]
    table[BACKGROUND] = 0
    return rgba_image(table[classes])


def _instance_image(instances: np.ndarray) -> QImage:
    """Instances in distinct colours with white outlines; background is transparent."""
    ids, places = np.unique(instances, return_inverse=True)
    hue = 6.0 * (ids * _GOLDEN % 1.0)[:, np.newaxis]
    # Of full saturation, from dark to bright by turns.
    share = np.clip(np.abs((hue + np.array([0.0, 4.0, 2.0])) % 6.0 - 3.0) - 1.0, 0.0, 1.0)
    bright = np.take((1.0, 0.75, 0.9), ids.astype(np.int64) % 3)[:, np.newaxis]
    table = np.full((len(ids), 4), 255, np.uint8)
    table[:, :3] = np.rint(255.0 * bright * share)
    table[ids == 0] = 0
    pixels = table[places.reshape(instances.shape)]
    edge = np.zeros(instances.shape, np.bool_)
    for axis in (0, 1):
        differs = np.diff(instances.astype(np.int64), axis=axis) != 0
        rows, columns = differs.shape
        edge[:rows, :columns] |= differs
        edge[-rows:, -columns:] |= differs
    pixels[edge & (instances > 0)] = 255
    return rgba_image(pixels)


def _features(table: Path, numbers: set[int]) -> dict[int, tuple[str, int]]:
    """Layer and feature of instances; rows are in order of their numbers, and read up to the last one."""
    found: dict[int, tuple[str, int]] = {}
    try:
        with open_foreign(table, MAX_TABLE_BYTES) as file:
            for row in csv.DictReader(text_lines(file, "utf-8-sig")):
                if len(found) == len(numbers):
                    break
                number = whole_number(row.get("id") or "")
                feature = whole_number(row.get("feature") or "")
                if number in numbers and feature is not None:
                    found[number] = (one_line(row.get("layer") or ""), feature)
    except (OSError, UnicodeDecodeError, csv.Error, InvalidInput):
        # The copy of a remote dataset has no such table.
        return {}
    return found


def _at(values: np.ndarray | None, x: float, y: float) -> int:
    if values is None:
        return 0
    height, width = values.shape
    return int(values[min(int(y * height), height - 1), min(int(x * width), width - 1)])
