"""Labels and buildings around a plan, read from their files: notes for the panel, features to draw. On any thread."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..core.errors import TerrAInavError
from .i18n import number_text, tr

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..core.faces.buildings import BuildingCounts
    from ..core.geodesy.triangles import FaceModel
    from ..core.labels.label_map import LabelMap
    from ..core.mission.parts import Terrain
    from ..core.mission.plan import Plan
    from ..core.vectors.features import Features
    from ..core.vectors.layer import VectorLayer

    Floats = NDArray[np.float64]
    #: West, south, east and north in degrees; longitudes are continuous.
    Box = tuple[float, float, float, float]

#: Largest number of features that are drawn of all layers of labels, and of buildings.
MOST_FEATURES = 5_000
#: Ground farther away than this many heights of the camera is not drawn: images of the horizon see whole countries.
_MOST_HEIGHTS = 10.0
#: Largest number of images that are searched for labels one by one.
_MOST_SEARCHED = 2_000
_M_PER_DEG = 111_320.0
#: Colours of buildings with a height, with levels, and of default height, for the colour-blind too.
_BUILDING_COLOURS = ("#0072b2", "#56b4e9", "#d55e00")
_CITY_COLOUR = "#009e73"


class DrawnFeatures(NamedTuple):
    """Features of a layer, those nearest to the middle of the planned images.

    Parameters
    ----------
    features : Features
        n of them.
    places : sequence of int
        For each, the place of its kind in `kinds`; -1 for features that are not drawn.
    kinds : sequence of (str, str)
        Title and colour (#rrggbb) of each kind.
    width_m, radius_m : float
        Width of lines and radius of points.
    """

    features: Features
    places: Sequence[int]
    kinds: Sequence[tuple[str, str]]
    width_m: float = 0.0
    radius_m: float = 0.0


class PlanFeatures(NamedTuple):
    """Labels and buildings around a plan.

    Parameters
    ----------
    layers : mapping of str to tuple of DrawnFeatures
        By role in the preview: labels, buildings; missing if the mission has none.
    counts : mapping of str to int
        Number of features around the plan, drawn or not, by role.
    notes : mapping of str to str
        Text for the panel, by entry.
    """

    layers: Mapping[str, tuple[DrawnFeatures, ...]] = MappingProxyType({})
    counts: Mapping[str, int] = MappingProxyType({})
    notes: Mapping[str, str] = MappingProxyType({})


def open_labels(plan: Plan) -> LabelMap:
    """Open the labels of a plan, and index their files, if they have not been.

    Raises
    ------
    InvalidInput
        A layer or its classes cannot be read; names the entry.
    Cancelled
        The enclosing `waiting.cancellable` is cancelled.
    """
    # Imported here, as only labels need vector files.
    from ..core.picture.labels import plan_labels

    try:
        return plan_labels(plan)
    except TerrAInavError as wrong:
        wrong.field = wrong.field or "labels"
        raise


def read_features(plan: Plan) -> PlanFeatures:
    """Read the labels and buildings around a plan; raises as `open_labels` does."""
    mission = plan.mission
    if not (mission.labels.labels or mission.terrain.buildings):
        return PlanFeatures()
    views = _ImageBoxes(plan)
    layers, counts, notes = {}, {}, {}
    if mission.labels.labels:
        layers["labels"], counts["labels"], notes["labels"] = _read_labels(plan, views)
    if mission.terrain.buildings:
        layers["buildings"], counts["buildings"], notes["buildings"] = _read_buildings(plan, views)
    return PlanFeatures(layers, counts, notes)


class _ImageBoxes:
    """Boxes of the ground in a plan's images, in degrees.

    Attributes
    ----------
    near : Box
        Box of the ground in all images that is not far from the cameras.
    """

    def __init__(self, plan: Plan) -> None:
        lat, lon = plan.corners.lat_deg, plan.corners.lon_deg
        # Corners are continuous with their cameras, and these with the first one.
        turn = 360.0 * np.round((plan.lon_deg - plan.lon_deg[0]) / 360.0)[:, np.newaxis]
        lon = lon - turn
        self._west, self._south, self._east, self._north = (lon.min(1), lat.min(1), lon.max(1), lat.max(1))
        self._is_whole = bool(plan.corners.hit.all())
        reach = _MOST_HEIGHTS * np.maximum(plan.agl_m, 1.0)[:, np.newaxis] / _M_PER_DEG
        wide = reach / np.maximum(np.cos(np.radians(plan.lat_deg)), 0.01)[:, np.newaxis]
        at_lat, at_lon = plan.lat_deg[:, np.newaxis], plan.lon_deg[:, np.newaxis] - turn
        lat, lon = np.clip(lat, at_lat - reach, at_lat + reach), np.clip(lon, at_lon - wide, at_lon + wide)
        self.near: Box = (float(lon.min()), float(lat.min()), float(lon.max()), float(lat.max()))

    def show(self, layer: VectorLayer) -> bool:
        """Whether any image may show a feature of a layer; True if that is not known without a long search."""
        whole = (self._west.min(), self._south.min(), self._east.max(), self._north.max())
        if not layer.count_in(*map(float, whole)):
            # Images of the horizon see more than their corners.
            return not self._is_whole
        if len(self._west) > _MOST_SEARCHED:
            return True
        boxes = zip(*(edge.tolist() for edge in (self._west, self._south, self._east, self._north)))
        return any(layer.count_in(*box) for box in boxes)


def _read_labels(plan: Plan, views: _ImageBoxes) -> tuple[tuple[DrawnFeatures, ...], int, str]:
    labels, found = plan.mission.labels, open_labels(plan)
    table = found.classes
    kinds = [*((one.name, one.colour) for one in table.classes), (tr("ignore"), "#ffffff")]
    places = {one.id: place for place, one in enumerate(table.classes)}
    drawn, most = [], MOST_FEATURES // len(found.layers)
    for number, layer in enumerate(found.layers):
        fields = (layer.field,) if layer.field else ()
        features = layer.source.features(*views.near, fields, most=most)
        ids = table.ids(number, features.values[layer.field] if layer.field else None, len(features))
        drawn.append(
            DrawnFeatures(
                features,
                [places.get(one, len(kinds) - 1) for one in ids.tolist()],
                kinds,
                labels.line_width_m,
                labels.point_radius_m,
            )
        )
    count = sum(layer.source.count_in(*views.near) for layer in found.layers)
    return tuple(drawn), count, _label_note(found, views)


def _label_note(found: LabelMap, views: _ImageBoxes) -> str:
    lines = [_layer_note(layer.name, layer.source) for layer in found.layers]
    classes = tr("Classes: {count}.").format(count=number_text(len(found.classes.classes)))
    if found.classes.unlabelled:
        more = tr("Features without a value, which are ignored: {count}.")
        classes += " " + more.format(count=number_text(found.classes.unlabelled))
    lines.append(classes)
    if not any(views.show(layer.source) for layer in found.layers):
        lines.append(tr("No label lies in any image."))
    return "\n".join(lines)


def _layer_note(name: str, layer: VectorLayer) -> str:
    """Numbers of features of a layer, and of those repaired and left out."""
    count = layer.count
    parts = [tr("1 feature") if count == 1 else tr("{count} features").format(count=number_text(count))]
    if layer.repaired:
        parts.append(tr("{count} repaired (self-crossing)").format(count=number_text(layer.repaired)))
    if layer.dropped:
        parts.append(tr("{count} left out (no area or length)").format(count=number_text(layer.dropped)))
    return f"{name}: {', '.join(parts)}."


def _read_buildings(plan: Plan, views: _ImageBoxes) -> tuple[tuple[DrawnFeatures, ...], int, str]:
    from ..core.faces.city_buildings import CityBuildings
    from ..core.faces.opening import parse_city

    terrain = plan.mission.terrain
    drawn, lines, count, in_view = [], [], 0, False
    most = MOST_FEATURES // len(terrain.buildings)
    for text, model in zip(terrain.buildings, _models(plan)):
        if isinstance(model, CityBuildings):
            # The plan itself warns of what is repaired or left out of such a file.
            found, around = _city_roofs(model, views.near, most)
            lines.append(tr("{name}: {count} buildings.").format(name=model.title, count=number_text(model.count)))
            is_seen = around > 0
        elif parse_city(text) is not None:
            continue
        else:
            layer, found, counts = _read_footprints(text, terrain, views.near, most)
            around, is_seen = layer.count_in(*views.near), views.show(layer)
            lines += [_layer_note(layer.title, layer), _building_note(counts, len(found.features), around)]
        drawn.append(found)
        count, in_view = count + around, in_view or is_seen
    if not in_view:
        lines.append(tr("No building stands in any image."))
    return tuple(drawn), count, "\n".join(filter(None, lines))


def _read_footprints(
    text: str, terrain: Terrain, box: Box, most: int
) -> tuple[VectorLayer, DrawnFeatures, BuildingCounts]:
    """Footprints of a layer, by where their heights come from."""
    from ..core.faces.buildings import NO_BUILDING, BuildingOptions, FootprintBuildings
    from ..core.vectors.layer import open_layer, parse_layer

    name = parse_layer(text)
    layer = open_layer(name.path, name.layer)
    options = BuildingOptions(terrain.building_height_field, terrain.building_height_m)
    # A model of its own, as that of the plan counts what images show; without ground, as nothing is placed on it.
    model = FootprintBuildings(layer, None, options)
    features, sources = model.survey(*box, most=most)
    height = tr("default height ({height} m)").format(height=number_text(terrain.building_height_m, "g"))
    kinds = [*zip((tr("with height"), tr("with levels"), height), _BUILDING_COLOURS)]
    places = np.where(sources == NO_BUILDING, -1, sources).tolist()
    return layer, DrawnFeatures(features, places, kinds), model.counts


def _models(plan: Plan) -> Sequence[FaceModel | None]:
    """Models of each file of buildings; None where no building stands in any image."""
    if plan.relief.is_level:
        return [None] * len(plan.mission.terrain.buildings)
    faces = plan.relief.heights.faces
    return getattr(faces, "models", (faces,))


def _city_roofs(model: FaceModel, box: Box, most: int) -> tuple[DrawnFeatures, int]:
    """Roofs of a CityJSON file, those nearest to the middle of a box, and the number of buildings in the box."""
    from ..core.geodesy.local import geodetic
    from ..core.geodesy.triangles import ROOF
    from ..core.vectors.features import POLYGON, Features

    west, south, east, north = box
    found = model.triangles(np.array([south, north]), np.array([west, east]))
    found = found.take(found.kind == ROOF)
    lat, lon, _ = (values.reshape(-1, 3) for values in geodetic(found.corners_m.reshape(-1, 3)))
    lon = lon + 360.0 * np.round(((west + east) / 2.0 - lon) / 360.0)
    across = (lon[:, 0] - (west + east) / 2.0) * np.cos(np.radians((south + north) / 2.0))
    numbers, which = np.unique(found.instance, return_inverse=True)
    away = np.full(len(numbers), np.inf)
    np.minimum.at(away, which, np.hypot(across, lat[:, 0] - (south + north) / 2.0))
    kept = np.sort(np.argsort(away, kind="stable")[:most])
    rows = np.flatnonzero(np.isin(which, kept))
    rows = rows[np.argsort(which[rows], kind="stable")]
    closed = [0, 1, 2, 0]
    features = Features(
        numbers[kept],
        np.full(len(kept), POLYGON, np.uint8),
        lon[rows][:, closed].ravel(),
        lat[rows][:, closed].ravel(),
        4 * np.arange(len(rows) + 1),
        np.arange(len(rows) + 1),
        np.searchsorted(which[rows], np.append(kept, len(numbers))),
        {},
    )
    return DrawnFeatures(features, [0] * len(kept), [(tr("of CityJSON"), _CITY_COLOUR)]), len(numbers)


def _building_note(counts: BuildingCounts, read: int, around: int) -> str:
    """Where the heights of buildings come from, and values that cannot be read, of those read of all in the area."""
    numbers = (counts.with_height, counts.with_levels, counts.by_default)
    if not any(numbers):
        return ""
    where = tr("In the planned area")
    if read < around:
        where = tr("Of the nearest {read} of {around} features in the planned area").format(
            read=number_text(read), around=number_text(around)
        )
    text = tr("{where}: {height} with a height, {levels} with levels, {default} of the default height.")
    values = dict(zip(("height", "levels", "default"), map(number_text, numbers)))
    found = [text.format(where=where, **values)]
    for name, count in sorted(counts.unread.items()):
        examples = ", ".join(f"“{one}”" for one in counts.examples.get(name, ()))
        unread = tr("Values of {field} that cannot be read: {count} ({examples}).")
        found.append(unread.format(field=name, count=number_text(count), examples=examples))
    return " ".join(found)
