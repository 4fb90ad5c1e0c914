"""Classes of label layers: ids, names and colours."""

from __future__ import annotations

import colorsys
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import NDArray, Numbers
from ..errors import InvalidInput, Message
from ..storage.files import read_existing
from ..text.safe_json import parse_json

BACKGROUND = 0
#: Greatest class ids in 8 and 16 bits; the next number is `ClassTable.ignore`.
MOST_IN_8_BITS, MOST_IN_16_BITS = 254, 65_534
#: Ending of the file beside a layer's file that gives its values ids, names and colours.
SIDE_FILE = ".classes.json"
#: Largest table of classes that is read: 65,534 with names of some hundred characters.
MAX_CLASSES_BYTES = 16 << 20
#: Colours that the colour-blind can tell apart (Okabe and Ito, 2008), without black.
_COLOURS = ("#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2", "#d55e00", "#cc79a7")
_BACKGROUND_COLOUR, _IGNORE_COLOUR = "#000000", "#ffffff"


@dataclass(frozen=True)
class LabelClass:
    """One class: its id, name, and colour as #rrggbb."""

    id: int
    name: str
    colour: str


@dataclass(frozen=True, eq=False)
class ClassTable:
    """Classes of a mission's labels.

    Parameters
    ----------
    classes : tuple of LabelClass
        By id, without background and ignore.
    values : tuple of mapping
        For each layer, the class id of each value of its field; the only key is None for a layer without field.
    wall, roof : int
        Class ids of buildings; 0 for a mission without buildings.
    unlabelled : int
        Number of features without a value.
    """

    classes: tuple[LabelClass, ...]
    values: tuple[Mapping[Any, int], ...] = ()
    wall: int = 0
    roof: int = 0
    unlabelled: int = 0

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """Type of class pixels: uint8 or uint16."""
        most = max((one.id for one in self.classes), default=0)
        return np.dtype(np.uint8 if most <= MOST_IN_8_BITS else np.uint16)

    @property
    def ignore(self) -> int:
        """Class id of pixels without ground, and of features without a value: 255 or 65,535."""
        return int(np.iinfo(self.dtype).max)

    @cached_property
    def colours(self) -> NDArray[np.uint8] | None:
        """Colour table (256, 3) of classes in 8 bits; None in 16 bits."""
        if self.dtype.itemsize > 1:
            return None
        table = np.zeros((256, 3), np.uint8)
        for number, colour in [(one.id, one.colour) for one in self.classes] + [(self.ignore, _IGNORE_COLOUR)]:
            table[number] = [int(colour[at : at + 2], 16) for at in (1, 3, 5)]
        return table

    def ids(self, layer: int, values: Sequence[Any] | None, count: int) -> Numbers:
        """Class ids (count,) of features of a layer by their values; None for a layer without field."""
        known = self.values[layer]
        if values is None:
            return np.full(count, known[None], np.int64)
        return np.array([known.get(_value(one), self.ignore) for one in values], np.int64).reshape(count)

    def to_json(self) -> dict[str, Any]:
        """Return the content of ``classes.json``."""
        classes = [{"id": one.id, "name": one.name, "color": one.colour} for one in self.classes]
        return {"background": BACKGROUND, "ignore": self.ignore, "classes": classes}


@dataclass(frozen=True)
class LayerValues:
    """Values of one layer of labels.

    Parameters
    ----------
    name : str
        Name of the layer, which is the class of a layer without field.
    field : str
        Empty for a layer without field.
    counts : mapping
        Values of the field with their numbers of features.
    named : mapping
        Id, name and colour by value, as texts, from the layer's side file.
    """

    name: str
    field: str
    counts: Mapping[Any, int]
    named: Mapping[str, Mapping[str, Any]]


def class_table(layers: Sequence[LayerValues], *, with_buildings: bool = False) -> ClassTable:
    """Give the values of layers ids, names and colours.

    Ids are the values themselves if all are whole numbers from 0 to 65,534; otherwise the distinct values have ids from
    1 in their order. Layers without field follow, and then walls and roofs of buildings.

    Raises
    ------
    InvalidInput
        A field has no values, or there are more classes than 16 bits hold.
    """
    found = {_value(value) for one in layers for value in one.counts} - {None}
    for one in layers:
        if one.field and not any(_value(value) is not None for value in one.counts):
            raise InvalidInput(
                "labels {0}: the field {1} has no value in any feature",
                one.name,
                one.field,
                remedy="choose another field, or none",
                field="labels",
            )
    named: dict[str, Mapping[str, Any]] = {key: about for one in layers for key, about in one.named.items()}
    ids, names = _numbered(found, named)
    taken = max(ids.values(), default=0)
    by_layer: list[Mapping[Any, int]] = []
    more: dict[str, int] = {}

    def number_of(name: str) -> int:
        nonlocal taken
        known = {text: number for number, text in names.items()}
        if name not in known and name not in more:
            taken += 1
            more[name] = taken
        return more.get(name) or known[name]

    by_layer = [ids if one.field else {None: number_of(one.name)} for one in layers]
    wall, roof = (number_of("wall"), number_of("roof")) if with_buildings else (0, 0)
    names.update((number, name) for name, number in more.items())
    if len(names) > MOST_IN_16_BITS or taken > MOST_IN_16_BITS:
        raise too_many(len(names))
    colours = {number: about["color"] for number, about in _by_id(named, ids).items() if "color" in about}
    classes = tuple(
        LabelClass(number, names[number], colours.get(number, default_colour(at)))
        for at, number in enumerate(sorted(number for number in names if number != BACKGROUND))
    )
    missing = sum(count for one in layers if one.field for value, count in one.counts.items() if _value(value) is None)
    return ClassTable(classes, tuple(by_layer), wall, roof, missing)


def _numbered(found: set[Any], named: Mapping[str, Mapping[str, Any]]) -> tuple[dict[Any, int], dict[int, str]]:
    """Ids by value, and names by id."""
    if all(_is_id(value) for value in found):
        ids = {value: int(value) for value in found}
    else:
        ids = {value: number for number, value in enumerate(sorted(found, key=_order), 1)}
    if len(ids) > MOST_IN_16_BITS:
        raise too_many(len(ids))
    stated = {value: named[str(value)]["id"] for value in ids if "id" in named.get(str(value), {})}
    if any(value != number for value, number in ids.items()):
        # Numbers that the side file gives others are passed over, so that no value falls into another's class.
        taken = set(stated.values())
        free = (number for number in count(len(ids) + 1) if number not in taken)
        ids = {value: next(free) if number in taken else number for value, number in ids.items()}
    ids.update(stated)
    names: dict[int, str] = {}
    for value, number in ids.items():
        # Values that a side file gives one id are one class, of the first's name.
        names.setdefault(number, str(named.get(str(value), {}).get("name", value)))
    return ids, names


def _by_id(named: Mapping[str, Mapping[str, Any]], ids: Mapping[Any, int]) -> dict[int, Mapping[str, Any]]:
    return {number: named[str(value)] for value, number in ids.items() if str(value) in named}


def too_many(count: int) -> InvalidInput:
    """Error for more classes than 16 bits hold."""
    return InvalidInput(
        "labels of {0:,} classes: files of 16 bits hold {1:,}",
        count,
        MOST_IN_16_BITS,
        remedy="choose a field with fewer values, or none and tell features apart by the product instances",
        field="labels",
    )


def _value(value: Any) -> Any:
    """Value of a field: whole numbers as int, texts without spaces around; None if null or empty."""
    if isinstance(value, str):
        return value.strip() or None
    if isinstance(value, float):
        if not math.isfinite(value):
            return None
        return int(value) if value.is_integer() else value
    return value


def _is_id(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= MOST_IN_16_BITS


def _order(value: Any) -> tuple[bool, Any]:
    """Numbers first, by value, then texts."""
    return (False, value) if isinstance(value, (int, float)) else (True, str(value))


def default_colour(at: int) -> str:
    """Colour of the class at a place of the table: seven that the colour-blind can tell apart, then lighter or darker.

    Further classes get hues by the golden ratio.
    """
    if at < len(_COLOURS):
        return _COLOURS[at]
    hue = (at * 0.6180339887498949) % 1.0
    red, green, blue = colorsys.hls_to_rgb(hue, (0.35, 0.75, 0.55)[at % 3], 0.7)
    return f"#{round(red * 255):02x}{round(green * 255):02x}{round(blue * 255):02x}"


def read_side_file(layer_file: Path) -> dict[str, Mapping[str, Any]]:
    """Ids, names and colours by value, from the file ``<layer>.classes.json`` beside a layer's file, if it exists.

    Raises
    ------
    InvalidInput
        The file cannot be read as ``{"classes": [{"value": ..., "id": ..., "name": ..., "color": "#rrggbb"}]}``, in
        which each entry has a value or a name.
    """
    path = layer_file.with_suffix(SIDE_FILE)
    data = read_existing(path, MAX_CLASSES_BYTES)
    if data is None:
        return {}
    try:
        found = parse_json(data)
        return {str(one.get("value", one.get("name"))): _entry(one) for one in found["classes"]}
    except InvalidInput as wrong:
        raise _unread(path, wrong) from wrong
    except (AttributeError, KeyError, TypeError) as wrong:
        raise _unread(path, Message("it must hold a list named classes")) from wrong


def read_classes(data: bytes, name: str) -> ClassTable:
    """Classes of a dataset, from the content of its ``classes.json``.

    Parameters
    ----------
    data : bytes
    name : str
        Path of the file, for messages.

    Raises
    ------
    InvalidInput
        The content is not as `ClassTable.to_json` returns it.
    """
    try:
        content = parse_json(data)
        entries = [_entry(one) for one in content["classes"]]
        table = ClassTable(tuple(LabelClass(one["id"], one["name"], one["color"]) for one in entries))
        background, ignore = content["background"], content["ignore"]
    except InvalidInput as wrong:
        raise _unread(name, wrong) from wrong
    except (AttributeError, KeyError, TypeError) as wrong:
        raise _unread(name, Message("it must hold background, ignore, and classes of id, name and color")) from wrong
    if (background, ignore) != (BACKGROUND, table.ignore):
        why = Message("background {0!r} and ignore {1!r} must be {2} and {3}", background, ignore, 0, table.ignore)
        raise _unread(name, why)
    return table


def _entry(one: Mapping[str, Any]) -> dict[str, Any]:
    number, colour, name = one.get("id", 0), one.get("color", "#000000"), one.get("name", "")
    if not _is_id(number):
        raise InvalidInput("id {0!r}: must be a whole number from 0 to {1}", number, MOST_IN_16_BITS)
    if not (isinstance(colour, str) and re.fullmatch(r"#[0-9a-fA-F]{6}", colour)):
        raise InvalidInput("color {0!r}: must be #rrggbb", colour)
    if not isinstance(name, str):
        raise InvalidInput("name {0!r}: must be a text", name)
    return {key: one[key] for key in ("id", "name", "color") if key in one}


def _unread(path: Path | str, why: object) -> InvalidInput:
    return InvalidInput("table of classes {0}: {1}", path, why, field="labels")
