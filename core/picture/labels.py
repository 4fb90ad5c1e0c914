"""Open the labels of a plan."""

from __future__ import annotations

import threading
from functools import lru_cache
from pathlib import Path

from ..errors import TerrAInavError
from ..geodesy.triangles import NO_FACES
from ..labels.classes import read_side_file
from ..labels.label_map import LabelLayer, LabelMap
from ..mission.parts import PixelLabels
from ..mission.plan import Plan
from ..vectors.layer import open_layer, parse_layer

_OPENING = threading.Lock()


def plan_labels(plan: Plan, labels: PixelLabels | None = None) -> LabelMap:
    """Open the labels of a plan's mission, with the numbers of its buildings.

    Parameters
    ----------
    labels : PixelLabels or None
        The mission's labels with absolute paths, for processes with another current folder.

    Raises
    ------
    InvalidInput
        A layer cannot be read, or has no such field; as in `LabelMap`.
    """
    wanted = labels or plan.mission.labels
    faces = NO_FACES if plan.relief.is_level else plan.relief.heights.faces
    buildings = None if faces is NO_FACES else (faces.count, faces.listed)
    with _OPENING:
        return _opened(wanted, buildings, tuple(map(_state, wanted.labels)))


def whole_layer_path(text: str) -> str:
    """Make the path in a text absolute, so that the text names the same layer from any current folder."""
    path = parse_layer(text).path
    return text if path.startswith("/vsi") else f"{Path.cwd() / path}{text[len(path) :]}"


@lru_cache(maxsize=2)
def _opened(labels: PixelLabels, buildings: tuple[int, int] | None, _states: tuple[object, ...]) -> LabelMap:
    """Open layers; blocks of one process share them while their files are unchanged."""
    return LabelMap(
        [_layer(text) for text in labels.labels],
        labels.label_order,
        labels.line_width_m,
        labels.point_radius_m,
        buildings=buildings,
    )


def _state(text: str) -> tuple[float, int] | None:
    """Time and size of a layer's file; None if it cannot be found."""
    try:
        found = Path(parse_layer(text).path).stat()
    except (OSError, TerrAInavError):
        return None
    return found.st_mtime, found.st_size


def _layer(text: str) -> LabelLayer:
    try:
        name = parse_layer(text)
        layer = open_layer(name.path, name.layer)
    except TerrAInavError as wrong:
        wrong.field = wrong.field or "labels"
        raise
    path = Path(name.path)
    return LabelLayer(layer, name.layer or path.stem, name.field, read_side_file(path))
