"""Layers of labels, and the labels of an image's pixels."""

from __future__ import annotations

import math
import threading
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..errors import InvalidInput
from ..geodesy.ellipsoid import WGS84
from ..geodesy.triangles import FLOOR, ROOF, WALL
from ..vectors.features import Features
from .classes import BACKGROUND, ClassTable, LayerValues, class_table
from .drawing import topmost
from .pieces import NO_PIECES, LabelPlane, Pieces, pieces

#: Most edges of regions kept in memory.
_MOST_EDGES = 1 << 22
#: Least side of a region, degrees: some 10 m.
_LEAST_DEG = 2.0**-13
#: Name of the buildings in the table of instances.
BUILDINGS = "buildings"
#: Bands of latitude in which the table of instances is read.
_BANDS = 64


class LabelSource(Protocol):
    """Vector layer, as `vectors` opens it."""

    @property
    def count(self) -> int:
        """Number of features."""

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of fields."""

    @property
    def repaired(self) -> int:
        """Number of features that were repaired."""

    @property
    def dropped(self) -> int:
        """Number of features that were left out."""

    def features(
        self, west_deg: float, south_deg: float, east_deg: float, north_deg: float, fields: Sequence[str] = ()
    ) -> Features:
        """Features in a box, in the layer's order; longitudes are continuous with the box's."""

    def values(self, field: str) -> dict[Any, int]:
        """Distinct values of a field, with their numbers of features."""


@dataclass(frozen=True, eq=False)
class LabelLayer:
    """One layer of labels.

    Parameters
    ----------
    source : LabelSource
    name : str
        Name for users, which is the class of a layer without field.
    field : str
        Field of the classes; empty for one class.
    named : mapping
        Ids, names and colours by value, from `classes.read_side_file`.
    """

    source: LabelSource
    name: str
    field: str = ""
    named: dict[str, Any] | None = None

    @property
    def values(self) -> LayerValues:
        """Values of the field."""
        counts = self.source.values(self.field) if self.field else {}
        return LayerValues(self.name, self.field, counts, self.named or {})


class GroundBox(NamedTuple):
    """Box of ground in degrees; longitudes are continuous."""

    west: float
    south: float
    east: float
    north: float

    @classmethod
    def around(cls, lat_deg: Floats, lon_deg: Floats) -> GroundBox | None:
        """Box around positions, NaN left out; None without any."""
        known = np.isfinite(lat_deg) & np.isfinite(lon_deg)
        if not known.any():
            return None
        lat, lon = (lat_deg, lon_deg) if known.all() else (lat_deg[known], lon_deg[known])
        return cls(float(lon.min()), float(lat.min()), float(lon.max()), float(lat.max()))


class LabelMap:
    """Layers of a mission's labels, the last on top.

    Parameters
    ----------
    layers : sequence of LabelLayer
    order_field : str
        Field by which the features of a layer lie on top, the greatest last; empty for the layer's order.
    line_width_m, point_radius_m : float
        Width of lines and radius of points, on the ground.
    buildings : tuple of int or None
        Greatest number of a building, and of those that are listed, as in `FaceModel`; None for a mission without
        buildings. Their walls and roofs are classes.

    Raises
    ------
    InvalidInput
        As in `class_table`; no layer has the order field, or values there are no numbers.
    """

    def __init__(
        self,
        layers: Sequence[LabelLayer],
        order_field: str = "",
        line_width_m: float = 3.0,
        point_radius_m: float = 3.0,
        *,
        buildings: tuple[int, int] | None = None,
    ) -> None:
        self.layers, self.with_buildings = tuple(layers), buildings is not None
        self._buildings, self._listed = buildings or (0, 0)
        self._order_field, self._sizes = order_field, (line_width_m, point_radius_m)
        self.classes: ClassTable = class_table([one.values for one in layers], with_buildings=self.with_buildings)
        ends = np.cumsum([0, *(one.source.count for one in layers)])
        #: Instance ids of each layer's features begin after these; those of buildings after the last.
        self.offsets: tuple[int, ...] = tuple(ends.tolist())
        if order_field and layers and not any(order_field in one.source.fields for one in layers):
            raise InvalidInput("label order {0!r}: no layer of labels has this field", order_field, field="label_order")
        self._regions: OrderedDict[tuple[Any, ...], Pieces] = OrderedDict()
        self._lock = threading.Lock()

    @property
    def instance_dtype(self) -> np.dtype[Any]:
        """Type of instance pixels: uint16, or uint32 for more features and buildings."""
        most = self.offsets[-1] + self._buildings
        return np.dtype(np.uint32 if most > np.iinfo(np.uint16).max else np.uint16)

    def draw(self, plane: LabelPlane, x: Floats, y: Floats, box: GroundBox | None) -> tuple[NDArray[Any], NDArray[Any]]:
        """Return the classes and instances (h, w) of pixels.

        Parameters
        ----------
        plane : LabelPlane
            Plane in which edges are straight.
        x, y : array (h, w)
            Positions of the pixels' centres in the plane; NaN without ground.
        box : GroundBox or None
            Ground that holds the positions; None without ground.
        """
        if box is None:
            return np.full(x.shape, self.classes.ignore, self.classes.dtype), np.zeros(x.shape, self.instance_dtype)
        shown = self._region(plane, box)
        found = topmost(shown, x, y)
        # The last of each table is for pixels without a piece, whose index is -1.
        classes = np.append(shown.label, BACKGROUND).astype(self.classes.dtype).take(found)
        instances = np.append(shown.instance, 0).astype(self.instance_dtype).take(found)
        # Not finite if either is not.
        unseen = ~np.isfinite(x + y)
        classes[unseen] = self.classes.ignore
        return classes, instances

    def add_buildings(
        self, labels: tuple[NDArray[Any], NDArray[Any]], kind: NDArray[np.uint8], instance: Numbers
    ) -> None:
        """Label the pixels of buildings: walls and undersides, and roofs where no layer has labelled them.

        Parameters
        ----------
        labels : tuple of array (h, w)
            From `draw`; changed in place.
        kind, instance : array (h, w)
            Kinds of surfaces and numbers of buildings, as in `Sighting`.
        """
        classes, instances = labels
        walls = (kind == WALL) | (kind == FLOOR)
        roofs = (kind == ROOF) & (instances == 0)
        classes[walls], classes[roofs] = self.classes.wall, self.classes.roof
        for part in (walls, roofs):
            instances[part] = self.offsets[-1] + instance[part]

    def instance_rows(self) -> Iterator[tuple[int, int, str, int]]:
        """Yield instance id, class id, layer and feature of all features, in order of the ids; then of buildings.

        Buildings have the class of their walls, and numbers instead of features. The synthetic world's own houses
        follow after all of these, and are too many to list.
        """
        for number, layer in enumerate(self.layers):
            ids = self._class_of_features(number, layer)
            for feature, class_id in enumerate(ids.tolist(), 1):
                if class_id >= 0:
                    yield self.offsets[number] + feature, class_id, layer.name, feature
        for building in range(1, self._listed + 1):
            yield self.offsets[-1] + building, self.classes.wall, BUILDINGS, building

    def _class_of_features(self, number: int, layer: LabelLayer) -> Numbers:
        """Class id of each feature of a layer, -1 for those without geometry."""
        ids = np.full(layer.source.count, -1, np.int64)
        edges = np.linspace(-90.0, 90.0, _BANDS + 1).tolist()
        fields = (layer.field,) if layer.field else ()
        for south, north in zip(edges, edges[1:]):
            found = layer.source.features(-180.0, south, 180.0, north, fields)
            values = found.values[layer.field] if layer.field else None
            ids[found.number - 1] = self.classes.ids(number, values, len(found.number))
        return ids

    def _region(self, plane: LabelPlane, box: GroundBox) -> Pieces:
        """Pieces of a region that holds a box: two by two tiles of at least the box's size, kept for other images."""
        width, height = (
            2.0 ** math.ceil(math.log2(max(size, _LEAST_DEG))) for size in (box.east - box.west, box.north - box.south)
        )
        column, row = math.floor(box.west / width), math.floor(box.south / height)
        key = (plane, width, height, column, row)
        with self._lock:
            if key not in self._regions:
                whole = GroundBox(
                    column * width, max(row * height, -90.0), (column + 2) * width, min((row + 2) * height, 90.0)
                )
                self._regions[key] = self._read(plane, whole)
                kept = sum(len(one.edges) for one in self._regions.values())
                while kept > _MOST_EDGES and len(self._regions) > 1:
                    kept -= len(self._regions.popitem(last=False)[1].edges)
            self._regions.move_to_end(key)
            return self._regions[key]

    def _read(self, plane: LabelPlane, box: GroundBox) -> Pieces:
        """Read the pieces in a box, the topmost first."""
        room = np.degrees((max(self._sizes) + 1.0) / WGS84.b_m)
        lowest = max(abs(box.south), abs(box.north)) + room
        across = min(room / max(math.cos(math.radians(min(lowest, 90.0))), 1e-6), 180.0)
        west, south, east, north = box.west - across, box.south - room, box.east + across, box.north + room
        if east - west >= 360.0:
            middle = (west + east) / 2.0
            west, east = middle - 180.0, middle + 180.0
        parts: list[Pieces] = []
        for number, layer in reversed(tuple(enumerate(self.layers))):
            ordered = self._order_field if self._order_field in layer.source.fields else ""
            fields = tuple(dict.fromkeys(one for one in (layer.field, ordered) if one))
            found = layer.source.features(west, max(south, -90.0), east, min(north, 90.0), fields)
            count = len(found.number)
            if not count:
                continue
            labels = self.classes.ids(number, found.values[layer.field] if layer.field else None, count)
            # Of the features that lie on top of each other, the last is the topmost.
            rank = np.argsort(_order_values(found, ordered), kind="stable")
            place = np.empty(count, np.int64)
            place[rank] = np.arange(count)
            made = pieces(
                found, np.stack([labels, found.number + self.offsets[number], place], axis=1), plane, *self._sizes
            )
            parts.append(made.take(np.argsort(-made.rank, kind="stable")))
        return Pieces.joined(parts) if parts else NO_PIECES


def _order_values(features: Features, field: str) -> Floats:
    """Numbers by which features are ordered, those without a number first."""
    if not field:
        return np.zeros(len(features.number))
    values = features.values[field]
    for one in values:
        if one is not None and (isinstance(one, str) or not math.isfinite(one)):
            raise InvalidInput(
                "label order {0}: has the value {1!r}, which is no number",
                field,
                one,
                remedy="choose a field of numbers",
                field="label_order",
            )
    return np.array([-math.inf if one is None else float(one) for one in values])
