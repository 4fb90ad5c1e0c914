"""A plan's footprints as GeoJSON (RFC 7946)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from ..plan import Plan
from .rows import POSE_COLUMNS, WINDOW_COLUMNS, batches, closed_rings, parts, sortie_numbers


def geojson_text(plan: Plan) -> Iterator[str]:
    """Text of the footprints, in blocks."""
    sorties = sortie_numbers(plan)
    yield '{"type": "FeatureCollection", "features": [\n'
    for part, batch in zip(parts(len(plan)), batches(plan)):
        names = (*POSE_COLUMNS, *WINDOW_COLUMNS, *plan.drawn_fields)
        rows = zip(*(batch[name] for name in names))
        features: list[str] = []
        for row, rings in zip(rows, closed_rings(plan, part)):
            geometry: dict[str, Any] = {"type": "Polygon", "coordinates": rings}
            if len(rings) > 1:
                geometry = {"type": "MultiPolygon", "coordinates": [[ring] for ring in rings]}
            properties = {**dict(zip(names, row)), **_sight(plan, part.start + len(features))}
            if sorties is not None:
                properties["sortie"] = sorties[part.start + len(features)]
            feature = {"type": "Feature", "properties": properties, "geometry": geometry}
            features.append(json.dumps(feature))
        yield ",\n".join(features) + (",\n" if part.stop < len(plan) else "\n")
    yield "]}\n"


def _sight(plan: Plan, index: int) -> dict[str, Any]:
    """Properties of a footprint that shows the horizon or a pole."""
    found: dict[str, Any] = {}
    if not plan.corners.hit[index].all():
        found["horizon_edges"] = int(plan.views.outline(index).horizon.sum())
    if plan.views.poles[index]:
        found["pole"] = "north" if plan.views.poles[index] > 0 else "south"
    return found
