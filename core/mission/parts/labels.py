"""The part of a mission that names the labels of its pixels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...errors import InvalidInput
from ...fields import CheckedFields, declared, is_plain


def _check_labels(layers: tuple[Any, ...]) -> None:
    for one in layers:
        if not (one and is_plain(one)):
            raise InvalidInput(
                "labels {0!r}: must be a file, FILE:FIELD, FILE:LAYER or FILE:LAYER:FIELD", one, field="labels"
            )
    if len(set(layers)) != len(layers):
        raise InvalidInput("labels {0}: each layer may be named once", ", ".join(layers), field="labels")


def _check_order(name: str) -> None:
    if not is_plain(name):
        raise InvalidInput(
            "label order {0!r}: must be the name of a field, without spaces around it", name, field="label_order"
        )


@dataclass(frozen=True)
class PixelLabels(CheckedFields):
    """Vector layers that give each pixel a class and an instance."""

    labels: tuple[str, ...] = declared(
        (),
        title="labels",
        help="vector files whose features give each pixel its class and instance, as FILE, FILE:FIELD, FILE:LAYER or "
        "FILE:LAYER:FIELD; the field holds the classes, without one the layer is one class; of several files, later "
        "ones lie on top",
        check=_check_labels,
        schema={"items": {"type": "string", "minLength": 1}, "uniqueItems": True},
    )
    label_order: str = declared(
        "",
        title="order of labels",
        help="field of numbers by which overlapping features of a layer lie on top, the greatest last; by default "
        "later features lie on top of earlier ones",
        advanced=True,
        check=_check_order,
    )
    line_width_m: float = declared(
        3.0,
        title="width of lines",
        help="width on the ground of labels that are lines",
        unit="m",
        option="line_width",
        above=0.0,
        most=10_000.0,
        advanced=True,
    )
    point_radius_m: float = declared(
        3.0,
        title="radius of points",
        help="radius on the ground of labels that are points",
        unit="m",
        option="point_radius",
        above=0.0,
        most=10_000.0,
        advanced=True,
    )
