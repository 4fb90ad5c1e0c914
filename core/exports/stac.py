"""Describe a dataset in STAC: a collection, and images as its items in one GeoParquet table."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from ..arrays import NDArray
from ..dataset.dataset import Dataset, ImageSet, read_dataset
from ..dataset.folder import MISSION_FILE
from ..dataset.ground import are_camera_frames
from ..dataset.table import NUMBER, REJECTED, TEXT, WHOLE, Column, written_columns
from ..errors import InvalidInput
from ..geodesy.camera import image_axes
from ..geodesy.ellipsoid import arctan2
from ..geodesy.mercator import wrap_lon_deg
from ..map_types import is_undistorted
from ..mission.mission import Mission
from ..storage.files import json_bytes, write_whole
from ..storage.stores import Address, is_file
from .croissant import DESCRIPTION, TAR, dataset_name, describe_files, media_type, own_folder
from .huggingface import credit_line
from .tables import (
    GEOMETRY,
    FootprintGeometries,
    arrow_array,
    arrow_type,
    chosen_sets,
    described_folder,
    geometry_metadata,
    image_stem,
    import_pyarrow,
    parquet_blocks,
    row_groups,
)

ITEMS_FILE, COLLECTION_FILE = "items.parquet", "collection.json"
STAC_VERSION = "1.1.0"
#: Columns that every item has.
_ITEM_COLUMNS = (
    "type",
    "stac_version",
    "stac_extensions",
    "id",
    "collection",
    GEOMETRY,
    "bbox",
    "links",
    "assets",
)
_TIMES = _, _START, _END = ("datetime", "start_datetime", "end_datetime")
_MAP_TYPE, _GSD, _PROJ_CODE, _IMAGE = "map_type", "gsd", "proj:code", "image"
_RESERVED = frozenset((*_ITEM_COLUMNS, *_TIMES, _MAP_TYPE, _GSD, "properties"))
#: Interval for imagery of unknown date, so that any search for a time finds it. Some readers count nanoseconds in 64
#: bits, into which both ends fit.
_EARLIEST, _LATEST = np.datetime64("1700-01-01T00:00:00"), np.datetime64("2200-01-01T00:00:00")
_EDGES = ("xmin", "ymin", "xmax", "ymax")


def write_stac(folder: Address, target: Address, map_type: str | None = None) -> list[Path]:
    """Write ``items.parquet``, ``collection.json`` and ``croissant.json`` into a dataset's folder; return their paths.

    Items are all existing images, including images that cleaning has rejected. Earlier descriptions are replaced.
    Parameters and errors are as for `write_croissant`; the dataset may also be at an address, and OutputError is also
    raised without pyarrow.
    """
    import_pyarrow("stac")
    return describe(own_folder(read_dataset(folder), target, COLLECTION_FILE), map_type)


def describe(dataset: Dataset, map_type: str | None = None) -> list[Path]:
    """Write the descriptions of a dataset; see `write_stac`."""
    arrow = import_pyarrow("stac")
    shown: dict[Path, FootprintGeometries | None] = {}
    parts = []
    for name, images in chosen_sets(dataset, map_type).items():
        place = images.folder.parent
        if place not in shown:
            shown[place] = FootprintGeometries.read(place)
        footprints = None if is_undistorted(images.map_type) else shown[place]
        parts.append(_Items.from_images(dataset, name, images, footprints))
    if not any(len(one.rows) for one in parts):
        raise InvalidInput("folder {0}: has no image to export", dataset.folder)
    collection = _collection(dataset, parts)
    items, described = dataset.folder / ITEMS_FILE, dataset.folder / COLLECTION_FILE
    write_whole(items, _blocks(arrow, parts, collection))
    write_whole(described, json_bytes(collection))
    return [items, described, describe_files(dataset, map_type)]


@dataclass(frozen=True, eq=False)
class _Items:
    """Existing images (n) of a map type.

    Parameters
    ----------
    rows : array (n,)
        Rows of the table.
    columns : mapping of str to Column
        Columns of the table that become properties of items, for all rows of the table.
    hrefs : sequence of str
        Addresses of the images relative to the dataset's folder.
    bounds : array (n, 4)
        West, south, east, north.
    shown, places : FootprintGeometries or None, array (n,)
        Footprints, and the index of each image's footprint; -1 for images with only a position.
    start, end : array (n,) of datetime64
        First and last second of the imagery; NaT where unknown.
    """

    name: str
    images: ImageSet
    rows: NDArray[np.intp]
    columns: dict[str, Column]
    hrefs: Sequence[str]
    media: str
    bounds: NDArray[np.float64]
    shown: FootprintGeometries | None
    places: NDArray[np.intp]
    start: NDArray[Any]
    end: NDArray[Any]

    @classmethod
    def from_images(cls, dataset: Dataset, name: str, images: ImageSet, shown: FootprintGeometries | None) -> _Items:
        """Items of a map type."""
        table = images.table
        rows = np.flatnonzero(images.made)
        columns = {one.header: one for one in written_columns(table) if one.header not in ("status", "reason")}
        for header in _RESERVED & {*table.other}:
            # Rename foreign columns whose names have another meaning in STAC.
            columns[f"table_{header}"] = columns.pop(header)._replace(header=f"table_{header}")
        if "time_utc" in columns:
            # As text: readers convert only the times that STAC defines, and JSON has no type for other times.
            columns["time_utc"] = Column("time_utc", TEXT, table.time_utc)
        if images.shards:
            folder = _href(described_folder(dataset, images.folder))
            hrefs, media = [folder + quote(shard) for shard in table.shard], TAR
        else:
            hrefs, media = _files(dataset, images), media_type(next(iter(table.img_names), ""))
        places = np.full(len(rows), -1) if shown is None else shown.places(table.img_names)[rows]
        lon = wrap_lon_deg(table.lon_deg[rows])
        bounds = np.stack([lon, table.lat_deg[rows]] * 2, axis=-1)
        if shown is not None:
            bounds[places >= 0] = shown.bounds[places[places >= 0]]
        columns.update(_properties(images, is_camera=_is_camera(dataset, images, rows)))
        held = {header: one for header, one in columns.items() if _holds_any(one, rows)}
        start, end = (times[rows] for times in _times(table.imagery_date))
        return cls(name, images, rows, held, hrefs, media, bounds, shown, places, start, end)

    @property
    def extensions(self) -> list[str]:
        """Addresses of the STAC extensions that the properties need."""
        prefixes = {header.partition(":")[0] for header in self.columns}
        schemas = {"proj": "projection/v2.0.0", "view": "view/v1.0.0"}
        return [
            f"https://stac-extensions.github.io/{schema}/schema.json"
            for prefix, schema in schemas.items()
            if prefix in prefixes
        ]

    @property
    def kinds(self) -> set[str]:
        """GeoJSON types of the geometries."""
        found = {"Point"} if (self.places < 0).any() else set()
        return found if self.shown is None else found | self.shown.geometry_types(self.places)

    def group(self, arrow: Any, some: slice, assets: Any) -> dict[str, Any]:
        """Arrow arrays for a slice of the items, by name of the item column."""
        rows, names = self.rows[some].tolist(), self.images.table.img_names
        (image,) = assets
        files = {
            "href": arrow.array([self.hrefs[row] for row in rows], arrow.string()),
            **{
                name: arrow.repeat(arrow.scalar(value, image.type.field(name).type), len(rows))
                for name, value in (("type", self.media), ("roles", ["data"]))
            },
        }
        asset = arrow.StructArray.from_arrays([files[one.name] for one in image.type], fields=[*image.type])
        edges = [arrow.array(np.ascontiguousarray(edge)) for edge in self.bounds[some].T]
        times = {
            name: arrow.array(np.where(np.isnat(values[some]), unknown, values[some]).astype("datetime64[us]"))
            for name, values, unknown in ((_START, self.start, _EARLIEST), (_END, self.end, _LATEST))
        }
        return {
            "id": arrow.array([f"{self.name}_{image_stem(names[row])}" for row in rows], arrow.string()),
            GEOMETRY: self._geometries(arrow, some),
            "bbox": arrow.StructArray.from_arrays(edges, _EDGES),
            "assets": arrow.StructArray.from_arrays([asset], fields=[image]),
            **{name: one.cast(arrow.timestamp("us", tz="UTC")) for name, one in times.items()},
        }

    def _geometries(self, arrow: Any, some: slice) -> Any:
        """Footprints of a slice of the items as well-known binary; items without a footprint have a point."""
        places, bounds = self.places[some], self.bounds[some]
        if self.shown is not None and (places >= 0).all():
            return self.shown.shapes(arrow, places)
        points = np.zeros(len(places), [("order", "u1"), ("kind", "<u4"), ("lon", "<f8"), ("lat", "<f8")])
        points["order"], points["kind"], points["lon"], points["lat"] = 1, 1, bounds[:, 0], bounds[:, 1]
        drawn = arrow.array([point.tobytes() for point in points], arrow.binary())
        if self.shown is None:
            return drawn
        return arrow.compute.if_else(arrow.array(places >= 0), self.shown.shapes(arrow, places), drawn)


def _files(dataset: Dataset, images: ImageSet) -> list[str]:
    """Addresses of the images of a map type relative to the dataset's folder."""
    folder, names = _href(described_folder(dataset, images.files or images.folder)), images.table.img_names
    hrefs = [folder + quote(name) for name in names]
    # Cleaning moves separate files, but not images in shards.
    marks = () if images.files is None else images.table.other.get(REJECTED, ())
    for row in (row for row, mark in enumerate(marks) if mark):
        hrefs[row] = _href(described_folder(dataset, images.path(row).parent)) + quote(names[row])
    return hrefs


def _href(folder: Path) -> str:
    path = quote(folder.as_posix())
    return "./" if path in ("", ".") else f"./{path}/"


def _is_camera(dataset: Dataset, images: ImageSet, rows: NDArray[np.intp]) -> bool | None:
    """Whether images are camera frames; None for foreign tables, which have no windows of map pixels."""
    if not len(rows) or not np.isfinite(images.table.left_px[rows]).all():
        return None
    return are_camera_frames(images, rows, dataset.folder)


def _properties(images: ImageSet, *, is_camera: bool | None) -> dict[str, Column]:
    """STAC properties computed from a table, for all rows."""
    table = images.table
    found = {}
    path = images.folder.parent / MISSION_FILE
    if is_file(path):
        mission = Mission.load(path)
        across = 2.0 * mission.camera.half_tangents[0]
        varies = any(one.field == "fov_deg" for one in mission.varied.of_lens)
        found[_GSD] = table.agl_m / table.fx_px if varies else table.agl_m * across / table.image_width_px
    if is_camera:
        *_, axis = image_axes(table.yaw_deg, table.tilt_deg, table.roll_deg)
        off_nadir = np.degrees(np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), -axis[:, 2]))
        azimuth = np.degrees(arctan2(axis[:, 0], axis[:, 1])) % 360.0
        # A camera that looks above the horizon has neither angle, and a camera that looks straight down has no azimuth.
        found["view:off_nadir"] = np.where(off_nadir <= 90.0, off_nadir, np.nan)
        found["view:azimuth"] = np.where((off_nadir > 0.0) & (off_nadir <= 90.0), azimuth, np.nan)
    columns = {header: Column(header, NUMBER, values) for header, values in found.items()}
    if is_camera is False:
        codes = {crs: _code(crs) for crs in set(table.crs)}
        columns[_PROJ_CODE] = Column(_PROJ_CODE, TEXT, tuple(codes[crs] for crs in table.crs))
    return columns


def _code(crs: str) -> str:
    """Code of a CRS as tables state it; empty if the CRS has no code."""
    return (crs if re.fullmatch(r"[A-Z]+:[0-9A-Za-z_.]+", crs) else "") if crs else "EPSG:3857"


def _holds_any(column: Column, rows: NDArray[np.intp]) -> bool:
    values = column.values
    if isinstance(values, tuple):
        return any(values[row] for row in rows.tolist())
    return bool(np.isfinite(values[rows]).any())


def _times(dates: Sequence[str]) -> tuple[NDArray[Any], NDArray[Any]]:
    """First and last second of each date of imagery; NaT where unknown."""
    spans = {text: _span(text) for text in set(dates)}
    first, last = ([spans[text][end] for text in dates] for end in (0, 1))
    return np.array(first, "datetime64[s]"), np.array(last, "datetime64[s]")


def _span(text: str) -> tuple[np.datetime64, np.datetime64]:
    """First and last second of a year, month or day, or of a range between two; NaT for other texts."""
    unknown = np.datetime64("NaT"), np.datetime64("NaT")
    day = r"(\d{4}(?:-\d\d(?:-\d\d)?)?)(?:T[\d:.]*Z?)?"
    found = re.fullmatch(rf"{day}(?:\s*(?:-|/|\.\.)\s*{day})?", text.strip())
    if found is None:
        return unknown
    try:
        first, last = (np.datetime64(one) for one in (found[1], found[2] or found[1]))
    except ValueError:
        return unknown
    # The end is the last second before the next year, month or day.
    start, end = first.astype("datetime64[s]"), (last + 1).astype("datetime64[s]") - 1
    return (start, end) if _EARLIEST < start <= end < _LATEST else unknown


def _blocks(arrow: Any, parts: Sequence[_Items], collection: Mapping[str, Any]) -> Iterator[bytes]:
    """GeoParquet file of the items, in blocks."""
    text, texts, time = arrow.string(), arrow.list_(arrow.string()), arrow.timestamp("us", tz="UTC")
    link = arrow.struct([(name, text) for name in ("href", "rel", "type")])
    asset = arrow.struct([("href", text), ("type", text), ("roles", texts)])
    kinds: dict[str, str] = {}
    for column in (column for one in parts for column in one.columns.values()):
        # A column may have only whole numbers in one table and other numbers in another table.
        known = kinds.setdefault(column.header, column.kind)
        kinds[column.header] = column.kind if known == WHOLE else known
    types: dict[str, Any] = {
        **dict.fromkeys(_ITEM_COLUMNS, text),
        "stac_extensions": texts,
        GEOMETRY: arrow.binary(),
        "bbox": arrow.struct([(edge, arrow.float64()) for edge in _EDGES]),
        "links": arrow.list_(link),
        "assets": arrow.struct([(_IMAGE, asset)]),
        **dict.fromkeys(_TIMES, time),
        _MAP_TYPE: text,
        **{header: arrow_type(arrow, kind) for header, kind in kinds.items()},
    }
    same: dict[str, Any] = {
        "type": "Feature",
        "stac_version": STAC_VERSION,
        "collection": collection["id"],
        "links": [{"href": f"./{COLLECTION_FILE}", "rel": "collection", "type": "application/json"}],
        "datetime": None,
    }

    def groups() -> Iterator[dict[str, Any]]:
        for one in parts:
            for some in row_groups(len(one.rows)):
                shared = {**same, "stac_extensions": one.extensions, _MAP_TYPE: one.name}
                rows = one.rows[some]
                yield {
                    **{name: arrow.nulls(len(rows), kind) for name, kind in types.items()},
                    **{n: arrow.repeat(arrow.scalar(v, types[n]), len(rows)) for n, v in shared.items()},
                    **one.group(arrow, some, types["assets"]),
                    **{
                        header: arrow_array(arrow, column._replace(kind=kinds[header]), rows)
                        for header, column in one.columns.items()
                    },
                }

    bounds = np.concatenate([one.bounds for one in parts])
    geo = geometry_metadata({kind for one in parts for kind in one.kinds}, bounds)
    geo["columns"][GEOMETRY]["covering"] = {"bbox": {edge: ["bbox", edge] for edge in _EDGES}}
    metadata = {
        "geo": geo,
        "stac-geoparquet": {"version": "1.0.0", "collections": {collection["id"]: collection}},
    }
    return parquet_blocks(arrow, arrow.schema([*types.items()]), metadata, groups())


def _collection(dataset: Dataset, parts: Sequence[_Items]) -> dict[str, Any]:
    """STAC collection of a dataset, JSON-ready."""
    bounds = np.concatenate([one.bounds for one in parts])
    start, end = (np.concatenate(times) for times in zip(*((one.start, one.end) for one in parts)))
    known = not np.isnat(start).any()
    sources = dict.fromkeys(
        pair for one in parts for pair in zip(one.images.table.source, one.images.table.attribution) if any(pair)
    )
    gsd = [np.asarray(one.columns[_GSD].values)[one.rows] for one in parts if _GSD in one.columns]
    least, most = (float(extreme(np.concatenate(gsd))) if gsd else 0.0 for extreme in (np.nanmin, np.nanmax))
    count = sum(len(one.rows) for one in parts)
    return {
        "type": "Collection",
        "stac_version": STAC_VERSION,
        "stac_extensions": [],
        "id": dataset_name(dataset),
        "title": dataset_name(dataset),
        "description": f"{DESCRIPTION} {count:,} images: "
        + "; ".join(f"{one.name}, {credit_line(one.images)}" for one in parts)
        + ". The terms are those of who made the imagery.",
        "license": "other",
        "providers": [
            *(
                {"name": source or credit, "description": credit or source, "roles": ["producer", "licensor"]}
                for source, credit in sources
            ),
            {"name": "TerrAInav", "roles": ["processor"]},
        ],
        "extent": {
            "spatial": {"bbox": [[float(edge) for edge in (*bounds[:, :2].min(axis=0), *bounds[:, 2:].max(axis=0))]]},
            "temporal": {"interval": [[f"{start.min()}Z", f"{end.max()}Z"] if known else [None, None]]},
        },
        "summaries": {
            _MAP_TYPE: [one.name for one in parts],
            **({_GSD: {"minimum": least, "maximum": most}} if gsd else {}),
        },
        "item_assets": {_IMAGE: {"type": parts[0].media, "roles": ["data"]}},
        "assets": {
            "items": {
                "href": f"./{ITEMS_FILE}",
                "title": "All images, as GeoParquet",
                "description": "STAC items in the order of the tables, one map type after the other.",
                "type": "application/vnd.apache.parquet",
                "roles": ["collection-mirror"],
            }
        },
        "links": [],
    }
