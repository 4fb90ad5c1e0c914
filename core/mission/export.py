"""A plan as a table (CSV), as footprints (GeoJSON, RFC 7946) and for Google Earth (KML)."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..files import write_whole
from ..geodesy.mercator import wrap_lon_deg
from .plan import Plan
from .shape import cut_half_plane

Floats = NDArray[np.float64]
Ring = list[tuple[float, float]]

POSE_COLUMNS = ("name", "column", "row", "lat_deg", "lon_deg", "agl_m", "yaw_deg", "tilt_deg", "roll_deg")
WINDOW_COLUMNS = ("zoom", "left_px", "top_px", "width_px", "height_px")
CORNER_COLUMNS = tuple(
    f"{corner}_{axis}_deg" for corner in ("nw", "ne", "se", "sw") for axis in ("lat", "lon")
)
COLUMNS = POSE_COLUMNS + WINDOW_COLUMNS + CORNER_COLUMNS
#: Height in degrees up to which a footprint's edges are as good as straight in longitude and latitude: at middle
#: latitudes they leave their chord by some 1e-4 of their length.
_STRAIGHT_DEG = 0.1
#: Captures turned to text in one go, so that a million rows never stand in memory as text.
_BATCH = 10_000


def _batches(plan: Plan) -> Iterator[dict[str, list[Any]]]:
    """Columns of the table for one batch of captures after the other, as Python values."""
    left = np.mod(plan.windows.left_px, plan.grid.world_px(plan.zoom))
    lon = wrap_lon_deg(plan.lon_deg)
    corner_lon = wrap_lon_deg(plan.corners.lon_deg)
    for start in range(0, len(plan), _BATCH):
        part = slice(start, start + _BATCH)
        count = len(plan.column[part])
        batch: dict[str, list[Any]] = {
            "name": plan.names[part],
            "column": plan.column[part].tolist(),
            "row": plan.row[part].tolist(),
            "lat_deg": plan.lat_deg[part].tolist(),
            "lon_deg": lon[part].tolist(),
            "agl_m": plan.agl_m[part].tolist(),
            "yaw_deg": plan.poses.yaw_deg[part].tolist(),
            "tilt_deg": plan.poses.tilt_deg[part].tolist(),
            "roll_deg": plan.poses.roll_deg[part].tolist(),
            "zoom": [plan.zoom] * count,
            "left_px": left[part].tolist(),
            "top_px": plan.windows.top_px[part].tolist(),
            "width_px": plan.windows.width_px[part].tolist(),
            "height_px": plan.windows.height_px[part].tolist(),
        }
        for index, corner in enumerate(("nw", "ne", "se", "sw")):
            hit = plan.corners.hit[part, index].tolist()
            for axis, values in (
                ("lat", plan.corners.lat_deg[part, index]),
                ("lon", corner_lon[part, index]),
            ):
                # A corner that looks past the Earth has no place on it.
                cells = values.tolist()
                batch[f"{corner}_{axis}_deg"] = (
                    cells if all(hit) else [c if h else "" for c, h in zip(cells, hit)]
                )
        yield batch


def _csv(plan: Plan) -> Iterator[str]:
    yield ",".join(COLUMNS) + "\n"
    for batch in _batches(plan):
        rows = zip(*(batch[name] for name in COLUMNS))
        # Text of a float is its shortest exact form: all its digits.
        yield "".join(",".join(map(str, row)) + "\n" for row in rows)


def split_at_antimeridian(lon_deg: Floats, lat_deg: Floats) -> list[tuple[Floats, Floats]]:
    """Ring cut where it crosses ±180°, each part within them (RFC 7946, section 3.1.9).

    Parameters
    ----------
    lon_deg, lat_deg : array (n,)
        Ring without its closing corner; longitudes continuous.
    """
    first = int(np.floor((lon_deg.min() + 180.0) / 360.0))
    last = int(np.ceil((lon_deg.max() + 180.0) / 360.0))
    parts = []
    for turn in range(first, max(last, first + 1)):
        west = 360.0 * turn - 180.0
        lon, lat = cut_half_plane(*cut_half_plane(lon_deg, lat_deg, 0, west, 1.0), 0, west + 360.0, -1.0)
        if len(lon) >= 3 and float(lon.max()) > float(lon.min()):
            parts.append((np.clip(lon - 360.0 * turn, -180.0, 180.0), lat))
    return parts


def footprint_ring(plan: Plan, index: int) -> tuple[Floats, Floats]:
    """Longitudes (continuous) and latitudes of a capture's footprint, counter-clockwise, not closed.

    Its corners; where it is so large that its edges are bent on a map, or the horizon or a pole is in the picture,
    the outline of what is seen. Around a pole that goes once around the world and back along the pole's parallel.
    """
    small = np.ptp(plan.corners.lat_deg[index]) < _STRAIGHT_DEG
    if small and plan.corners.hit[index].all() and not plan.poles[index]:
        # Corners come as north-west, north-east, south-east, south-west: clockwise.
        return plan.corners.lon_deg[index, ::-1], plan.corners.lat_deg[index, ::-1]
    seen = plan.outline(index)
    lon, lat = seen.dlon_deg + plan.lon_deg[index], seen.lat_deg
    if seen.pole:
        turn = 360.0 * seen.pole
        lon = np.concatenate([lon, lon[:1] + turn, lon[:1] + turn, lon[:1]])
        lat = np.concatenate([lat, lat[:1], [90.0 * seen.pole] * 2])
    return lon, lat


def _rings(plan: Plan, part: slice) -> Iterator[list[Ring]]:
    """Closed rings, counter-clockwise, of each capture's footprint; several where it crosses ±180°."""
    for index in range(*part.indices(len(plan))):
        lon, lat = footprint_ring(plan, index)
        inside = lon.min() >= -180.0 and lon.max() <= 180.0
        pieces = [(lon, lat)] if inside else split_at_antimeridian(lon, lat)
        yield [[*zip(x.tolist(), y.tolist()), (float(x[0]), float(y[0]))] for x, y in pieces]


def _sight(plan: Plan, index: int) -> dict[str, Any]:
    """What a footprint's properties say of horizon and poles, where they are in the picture."""
    found: dict[str, Any] = {}
    if not plan.corners.hit[index].all():
        found["horizon_edges"] = int(plan.outline(index).horizon.sum())
    if plan.poles[index]:
        found["pole"] = "north" if plan.poles[index] > 0 else "south"
    return found


def _geojson(plan: Plan) -> Iterator[str]:
    yield '{"type": "FeatureCollection", "features": [\n'
    start = 0
    for batch in _batches(plan):
        names = POSE_COLUMNS + WINDOW_COLUMNS
        rows = zip(*(batch[name] for name in names))
        features: list[str] = []
        for row, rings in zip(rows, _rings(plan, slice(start, start + _BATCH))):
            geometry: dict[str, Any] = {"type": "Polygon", "coordinates": rings}
            if len(rings) > 1:
                geometry = {"type": "MultiPolygon", "coordinates": [[ring] for ring in rings]}
            properties = {**dict(zip(names, row)), **_sight(plan, start + len(features))}
            feature = {"type": "Feature", "properties": properties, "geometry": geometry}
            features.append(json.dumps(feature))
        start += _BATCH
        yield ",\n".join(features) + (",\n" if start < len(plan) else "\n")
    yield "]}\n"


def _kml(plan: Plan) -> Iterator[str]:
    yield (
        '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2"><Document>\n'
        "<name>TerrAInav plan</name>\n"
        '<Style id="footprint"><LineStyle><color>ff00a5ff</color><width>1</width></LineStyle>'
        "<PolyStyle><color>3300a5ff</color></PolyStyle></Style>\n<Folder><name>Footprints</name>\n"
    )
    start = 0
    for batch in _batches(plan):
        rings = _rings(plan, slice(start, start + _BATCH))
        yield "".join(_footprint_mark(name, pieces) for name, pieces in zip(batch["name"], rings))
        start += _BATCH
    yield "</Folder>\n<Folder><name>Captures</name>\n"
    for batch in _batches(plan):
        poses = zip(batch["name"], batch["lon_deg"], batch["lat_deg"], batch["agl_m"])
        yield "".join(
            f"<Placemark><name>{html.escape(name)}</name><Point><altitudeMode>relativeToGround</altitudeMode>"
            f"<coordinates>{lon},{lat},{agl}</coordinates></Point></Placemark>\n"
            for name, lon, lat, agl in poses
        )
    yield "</Folder>\n</Document></kml>\n"


def _footprint_mark(name: str, rings: list[Ring]) -> str:
    polygons = "".join(
        "<Polygon><tessellate>1</tessellate><outerBoundaryIs><LinearRing><coordinates>"
        + " ".join(f"{lon},{lat}" for lon, lat in ring)
        + "</coordinates></LinearRing></outerBoundaryIs></Polygon>"
        for ring in rings
    )
    shape = polygons if len(rings) == 1 else f"<MultiGeometry>{polygons}</MultiGeometry>"
    return f"<Placemark><name>{html.escape(name)}</name><styleUrl>#footprint</styleUrl>{shape}</Placemark>\n"


_WRITERS = {".csv": _csv, ".geojson": _geojson, ".kml": _kml}


def check_plan_ending(path: str | os.PathLike[str]) -> None:
    """Refuse a file whose ending names no format a plan can be written in."""
    if Path(path).suffix.lower() not in _WRITERS:
        raise InvalidInput(f"plan file {os.fspath(path)!r}: must end in {', '.join(_WRITERS)}")


def write_plan(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write a plan as a table (.csv), footprints (.geojson) or for Google Earth (.kml), whole or not at all.

    Raises
    ------
    InvalidInput
        Any other ending.
    OutputError
        Where the file cannot be written.
    """
    check_plan_ending(path)
    write_whole(path, (text.encode() for text in _WRITERS[Path(path).suffix.lower()](plan)))
