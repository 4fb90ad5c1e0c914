"""Open the labels of a mission."""

from __future__ import annotations

import threading
from functools import lru_cache
from pathlib import Path

from ..errors import TerrAInavError
from ..labels.classes import read_side_file
from ..labels.label_map import LabelLayer, LabelMap
from ..mission.mission import Mission
from ..mission.parts import PixelLabels
from ..vectors.layer import open_layer, parse_layer

_OPENING = threading.Lock()


def mission_labels(mission: Mission, labels: PixelLabels | None = None) -> LabelMap:
    """Open the labels of a mission.

    Parameters
    ----------
    labels : PixelLabels or None
        The mission's labels with absolute paths, for processes with another current folder.

    Raises
    ------
    InvalidInput
        A layer cannot be read, or has no such field; as in `LabelMap`.
    """
    wanted = labels or mission.labels
    with _OPENING:
        return _opened(wanted, bool(mission.terrain.buildings), tuple(map(_state, wanted.labels)))


def whole_layer_path(text: str) -> str:
    """Make the path in a text absolute, so that the text names the same layer from any current folder."""
    path = parse_layer(text).path
    return text if path.startswith("/vsi") else f"{Path.cwd() / path}{text[len(path) :]}"


@lru_cache(maxsize=2)
def _opened(labels: PixelLabels, with_buildings: bool, _states: tuple[object, ...]) -> LabelMap:
    """Open layers; blocks of one process share them while their files are unchanged."""
    return LabelMap(
        [_layer(text) for text in labels.labels],
        labels.label_order,
        labels.line_width_m,
        labels.point_radius_m,
        with_buildings=with_buildings,
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
