"""A plan as a GeoPackage with layers of footprints, captures and flight line, written by GDAL."""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import chain
from pathlib import Path
from typing import Any

from ...errors import Message, OutputError
from ...storage.files import partial_file
from ..plan import Plan
from .clearance import Reader, geopackage_points
from .rows import POSE_COLUMNS, Corners, batches, clock, closed_rings, parts
from .waypoints import flight_line, takeoff_deg

#: Code of little-endian byte order in well-known binary.
_LITTLE = 1
#: Codes of geometry types in well-known binary.
_POINT, _LINE, _POLYGON = 1, 2, 3
_MULTI_LINE, _MULTI_POLYGON = 5, 6
#: Added to the codes of geometries with heights (ISO).
_WITH_Z = 1000


def geopackage_notes(plan: Plan) -> tuple[str, ...]:
    """Notes on what the layers show, one line each."""
    if plan.nominal is None:
        return ()
    if plan.mission.wind is None:
        return (Message("footprints and captures are those of the random poses, the flight line is the planned one"),)
    return (
        Message("footprints and captures are those of the flight in wind, the flight line is the one that was meant"),
    )


def write_geopackage(plan: Plan, path: Path) -> None:
    """Write the layers ``footprints``, ``captures``, ``flight_line`` and, if one is set, ``takeoff``.

    The file is written whole or not at all.

    Raises
    ------
    OutputError
        GDAL's Python module is missing, or the file cannot be written.
    InvalidInput
        The flight line is too close to the relief.
    """
    try:
        from osgeo import ogr
    except ImportError as missing:
        raise OutputError(
            "{0}: GeoPackages need GDAL's Python module (osgeo), which QGIS brings along",
            path,
            remedy="install it, or choose .geojson",
        ) from missing
    try:
        with (
            # GDAL requires the ending .gpkg.
            partial_file(path, ".part.gpkg") as partial,
            _without_side_files(partial),
            _gdal_errors(path) as raise_error,
        ):
            _write(ogr, plan, partial, raise_error)
            if not plan.relief.is_level:
                reader = Reader(plan)
                reader.check(reader.above_ground([geopackage_points(partial)]), path.name)
    except OSError as wrong:
        raise OutputError("folder {0}: cannot write {1} ({2})", path.parent, path.name, wrong.strerror) from wrong


@contextmanager
def _without_side_files(partial: Path) -> Iterator[None]:
    """Remove the temporary files of SQLite beside a file, before and afterwards."""
    side_files = [partial.with_name(partial.name + ending) for ending in ("-journal", "-wal", "-shm")]
    for path in side_files:
        path.unlink(missing_ok=True)
    try:
        yield
    finally:
        for path in side_files:
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)


@contextmanager
def _gdal_errors(path: Path) -> Iterator[Callable[[], None]]:
    """Collect errors of GDAL in this thread instead of printing them; yields a function that raises the first.

    Whether GDAL's bindings raise exceptions is set for the whole process, by QGIS or another plugin, so both cases are
    handled.
    """
    from osgeo import gdal

    errors: list[str] = []

    def collect(severity: int, _number: int, words: str) -> None:
        if severity >= gdal.CE_Failure:
            errors.append(" ".join(words.split()))

    def raise_error() -> None:
        if errors:
            raise OutputError("{0}: cannot be written ({1})", path, errors[0])

    gdal.PushErrorHandler(collect)
    try:
        yield raise_error
        raise_error()
    except RuntimeError as wrong:
        raise OutputError("{0}: cannot be written ({1})", path, errors[0] if errors else wrong) from wrong
    finally:
        gdal.PopErrorHandler()


def _write(ogr: Any, plan: Plan, partial: Path, raise_error: Callable[[], None]) -> None:
    data = ogr.GetDriverByName("GPKG").CreateDataSource(str(partial))
    raise_error()
    try:
        for name, kind, shapes in (
            ("footprints", ogr.wkbMultiPolygon, _footprints(plan)),
            ("captures", ogr.wkbPoint25D, _captures(plan)),
        ):
            layer = data.CreateLayer(name, _wgs84(), kind)
            raise_error()
            _add_fields(ogr, layer, plan)
            # Without a transaction for all, each feature is a transaction, and waits for the disk.
            data.StartTransaction()
            _fill(ogr, layer, plan, shapes, raise_error)
            data.CommitTransaction()
            raise_error()
        line = data.CreateLayer("flight_line", _wgs84(), ogr.wkbMultiLineString25D)
        raise_error()
        _draw(ogr, line, plan)
        place = takeoff_deg(plan)
        if place is not None:
            _mark(ogr, data.CreateLayer("takeoff", _wgs84(), ogr.wkbPoint), place)
            raise_error()
    finally:
        # Close before the file is renamed or removed; older bindings lack Close.
        (data.Close if hasattr(data, "Close") else data.Destroy)()


def _wgs84() -> Any:
    from osgeo import osr

    wgs84 = osr.SpatialReference()
    wgs84.ImportFromEPSG(4326)
    wgs84.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return wgs84


def _draw(ogr: Any, layer: Any, plan: Plan) -> None:
    """Add the flight line: one feature, or one per sortie of a path that has other points than captures."""
    for name in ("length_m", "flight_s"):
        layer.CreateField(ogr.FieldDefn(name, ogr.OFTReal))
    path = plan.path
    figures = [(plan.direct.distance_m, plan.direct.duration_s)]
    if not path.is_captures:
        layer.CreateField(ogr.FieldDefn("sortie", ogr.OFTInteger))
        each = map(path.sortie_path, range(path.sorties))
        figures = [(one.distance_m, float(seconds)) for one, seconds in zip(each, path.sorties_s)]
    if len(path) < 2:
        return
    for sortie, (length_m, seconds) in enumerate(figures):
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetField(0, length_m)
        feature.SetField(1, seconds)
        if not path.is_captures:
            feature.SetField(2, sortie + 1)
        feature.SetGeometryDirectly(ogr.CreateGeometryFromWkb(_flight_line(plan, sortie)))
        layer.CreateFeature(feature)


def _mark(ogr: Any, layer: Any, place: tuple[float, float]) -> None:
    """Add the take-off point."""
    lat, lon = place
    feature = ogr.Feature(layer.GetLayerDefn())
    shape = struct.pack("<BI2d", _LITTLE, _POINT, lon, lat)
    feature.SetGeometryDirectly(ogr.CreateGeometryFromWkb(shape))
    layer.CreateFeature(feature)


def _add_fields(ogr: Any, layer: Any, plan: Plan) -> None:
    kinds = {"name": ogr.OFTString, "column": ogr.OFTInteger64, "row": ogr.OFTInteger64}
    for name in (*POSE_COLUMNS, *plan.drawn_fields):
        layer.CreateField(ogr.FieldDefn(name, kinds.get(name, ogr.OFTReal)))
    layer.CreateField(ogr.FieldDefn("time", ogr.OFTDateTime))


def _fill(ogr: Any, layer: Any, plan: Plan, shapes: Iterator[bytes], raise_error: Callable[[], None]) -> None:
    """Add a feature for each capture, with its geometry in well-known binary."""
    definition = layer.GetLayerDefn()
    names = (*POSE_COLUMNS, *plan.drawn_fields)
    for part, batch in zip(parts(len(plan)), batches(plan)):
        rows = zip(*(batch[name] for name in names), clock(plan.direct.start, plan.times_s[part]))
        for row, shape in zip(rows, shapes):
            feature = ogr.Feature(definition)
            for index, value in enumerate(row):
                feature.SetField(index, value)
            feature.SetGeometryDirectly(ogr.CreateGeometryFromWkb(shape))
            layer.CreateFeature(feature)
        raise_error()


def _footprints(plan: Plan) -> Iterator[bytes]:
    return map(_multi_polygon, chain.from_iterable(closed_rings(plan, part) for part in parts(len(plan))))


def _multi_polygon(rings: list[Corners]) -> bytes:
    polygons = (
        struct.pack("<BIII", _LITTLE, _POLYGON, 1, len(ring))
        + struct.pack(f"<{2 * len(ring)}d", *chain.from_iterable(ring))
        for ring in rings
    )
    return struct.pack("<BII", _LITTLE, _MULTI_POLYGON, len(rings)) + b"".join(polygons)


def _captures(plan: Plan) -> Iterator[bytes]:
    for batch in batches(plan):
        places = zip(batch["lon_deg"], batch["lat_deg"], batch["agl_m"])
        yield from (struct.pack("<BI3d", _LITTLE, _POINT + _WITH_Z, *place) for place in places)


def _flight_line(plan: Plan, sortie: int) -> bytes:
    lines = [line for line in flight_line(plan, sortie) if len(line[0]) > 1]
    head = struct.pack("<BII", _LITTLE, _MULTI_LINE + _WITH_Z, len(lines))
    for lon, lat, agl in lines:
        places = chain.from_iterable(zip(lon.tolist(), lat.tolist(), agl.tolist()))
        head += struct.pack("<BII", _LITTLE, _LINE + _WITH_Z, len(lon))
        head += struct.pack(f"<{3 * len(lon)}d", *places)
    return head
