"""The folder of a benchmark: queries with their true poses, the reference, and the tiles that match each query.

``benchmark.json`` holds the settings; ``queries.csv``, ``references.csv`` and ``positives.csv`` are all that scoring
needs. Folders beside them hold the images, as datasets that captures have written.
"""

from __future__ import annotations

import csv
import io
import math
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..arrays import Bytes, Floats, Numbers
from ..dataset.dataset import open_image
from ..dataset.folder import INSTANCES, PARTS
from ..dataset.table import GAP
from ..errors import InvalidInput, Message, OptionName
from ..geodesy.camera import Camera, Poses
from ..geodesy.mercator import Plane, WebMercator
from ..geodesy.planes import ProjectedPlane
from ..limits import MAX_MISSION_BYTES, MAX_SETTINGS_BYTES
from ..numbers import real_number
from ..poses.priors import PRIORS_FILE
from ..storage.files import csv_bytes, read_limited, write_whole
from ..text.safe_json import decoded, parse_json

BENCHMARK_FILE = "benchmark.json"
QUERIES_FILE, REFERENCES_FILE, POSITIVES_FILE = "queries.csv", "references.csv", "positives.csv"
QUERIES_FOLDER, REFERENCE_FOLDER, MOSAIC, TILES = "queries", "reference", "mosaic", "tiles"
#: Folder of the buildings inside that of the reference, and their key in ``benchmark.json``.
BUILDINGS = "buildings"
SCHEMA = 1
POSITIVE, SEMI_POSITIVE = "positive", "semi-positive"

#: Greatest coordinate of a mosaic in the unit of its CRS: the Earth's circumference is 4e7 m, or 1.3e8 ft.
_FARTHEST = 2e8
#: Ranges of columns; others range from -1e9 to 1e9.
_SIZES = dict.fromkeys(("width_m", "fx_px", "fy_px", "width_px", "height_px"), (1e-6, 1e9))
_LATITUDES = dict.fromkeys(("lat_deg", "centre_lat_deg"), (-90.0, 90.0))
_ANGLES = dict.fromkeys(("lon_deg", "centre_lon_deg", "yaw_deg", "tilt_deg", "roll_deg"), (-720.0, 720.0))
_RANGES: Mapping[str, tuple[float, float]] = {**_SIZES, **_LATITUDES, **_ANGLES}

_Rows = TypeVar("_Rows", bound="Columns")


@dataclass(frozen=True, eq=False)
class Columns:
    """Base of tables: columns are tuples of str and arrays of float64, with one entry for each row."""

    def __len__(self) -> int:
        return len(getattr(self, fields(self)[0].name))

    @classmethod
    def read(cls: type[_Rows], path: Path) -> _Rows:
        """Read a table; raises InvalidInput naming the line that is wrong."""
        return cls(**_read_columns(path, {one.name: one.type == "Floats" for one in fields(cls)}))

    @classmethod
    def joined(cls: type[_Rows], pieces: Sequence[_Rows]) -> _Rows:
        """Concatenate tables."""
        columns: dict[str, Any] = {}
        for one in fields(cls):
            values = [getattr(piece, one.name) for piece in pieces]
            is_number = one.type == "Floats"
            columns[one.name] = np.concatenate(values) if is_number else tuple(chain.from_iterable(values))
        return cls(**columns)

    def take(self: _Rows, rows: Numbers) -> _Rows:
        """Table of some rows, by index."""
        columns: dict[str, Any] = {}
        for one in fields(self):
            values = getattr(self, one.name)
            is_number = isinstance(values, np.ndarray)
            columns[one.name] = values[rows] if is_number else tuple(values[row] for row in rows.tolist())
        return type(self)(**columns)

    def write(self, path: Path) -> None:
        """Write the table atomically."""
        columns = {one.name: getattr(self, one.name) for one in fields(self)}
        write_columns(path, columns)


@dataclass(frozen=True, eq=False)
class Queries(Columns):
    """Images of q queries to localise, and their true poses.

    Parameters
    ----------
    id : tuple of str
        ``imagery/name``, as in predictions.
    file : tuple of str
        Image, relative to the benchmark's folder.
    imagery : tuple of str
        Name of the imagery that the image shows.
    part : tuple of str
        ``train``, ``validation``, ``test`` or ``gap``; empty without a split.
    centre_lat_deg, centre_lon_deg : array (q,)
        Ground at the centre of the image.
    lat_deg, lon_deg, height_m : array (q,)
        Position of the camera; height above the WGS 84 ellipsoid.
    ground_m : array (q,)
        Height of the ground below the camera, above the WGS 84 ellipsoid.
    yaw_deg, tilt_deg, roll_deg : array (q,)
        As in `Camera.rays_enu`.
    fx_px, fy_px, cx_px, cy_px : array (q,)
        Intrinsics; the centre of the first pixel is (0.5, 0.5).
    width_px, height_px : array (q,)
    """

    id: tuple[str, ...]
    file: tuple[str, ...]
    imagery: tuple[str, ...]
    part: tuple[str, ...]
    centre_lat_deg: Floats
    centre_lon_deg: Floats
    lat_deg: Floats
    lon_deg: Floats
    height_m: Floats
    ground_m: Floats
    yaw_deg: Floats
    tilt_deg: Floats
    roll_deg: Floats
    fx_px: Floats
    fy_px: Floats
    cx_px: Floats
    cy_px: Floats
    width_px: Floats
    height_px: Floats

    @property
    def poses(self) -> Poses:
        """Poses (q,), with heights above ground."""
        above = self.height_m - self.ground_m
        return Poses(self.lat_deg, self.lon_deg, above, self.yaw_deg, self.tilt_deg, self.roll_deg)

    def camera(self, index: int) -> Camera:
        """Camera of a query."""
        across = self.width_px[index] / 2.0 / self.fx_px[index]
        down = self.height_px[index] / 2.0 / self.fy_px[index]
        return Camera.from_horizontal_fov(2.0 * math.degrees(math.atan(across)), float(across / down))


@dataclass(frozen=True, eq=False)
class References(Columns):
    """The r tiles of the reference.

    Parameters
    ----------
    id : tuple of str
        ``tiles_200m/name``, as in predictions.
    file : tuple of str
        Image, relative to the benchmark's folder.
    part : tuple of str
        As in `Queries`; empty where all parts share the reference.
    width_m : array (r,)
        Nominal width on the ground.
    lat_deg, lon_deg : array (r,)
        Centres.
    west, south, east, north : array (r,)
        Edges in the reference's CRS.
    """

    id: tuple[str, ...]
    file: tuple[str, ...]
    part: tuple[str, ...]
    width_m: Floats
    lat_deg: Floats
    lon_deg: Floats
    west: Floats
    south: Floats
    east: Floats
    north: Floats


@dataclass(frozen=True, eq=False)
class Positives(Columns):
    """The p pairs of a query and a tile that show the same ground.

    Parameters
    ----------
    query, reference : tuple of str
    kind : tuple of str
        `POSITIVE` or `SEMI_POSITIVE`.
    iou : array (p,)
        Intersection over union of the ground of query and tile.
    """

    query: tuple[str, ...]
    reference: tuple[str, ...]
    kind: tuple[str, ...]
    iou: Floats


@dataclass(frozen=True, eq=False)
class Priors(Columns):
    """Noisy measurements of the poses of a folder's images, as `poses.priors` writes them."""

    img_names: tuple[str, ...]
    prior_lat_deg: Floats
    prior_lon_deg: Floats
    prior_agl_m: Floats
    prior_yaw_deg: Floats


@dataclass(frozen=True)
class ReferenceMosaic:
    """Georeference of the reference as one image.

    Parameters
    ----------
    file : str
        Path relative to the benchmark's folder.
    crs : str
    west, north : float
        Upper left corner in the CRS's unit.
    pixel_width, pixel_height : float
        Size of a pixel in the CRS's unit, both positive.
    width_px, height_px : int
    """

    file: str
    crs: str
    west: float
    north: float
    pixel_width: float
    pixel_height: float
    width_px: int
    height_px: int

    def __post_init__(self) -> None:
        """Check types and ranges."""
        for name, value in vars(self).items():
            if name in ("file", "crs"):
                right = isinstance(value, str) and not (name == "file" and _may_leave_folder(value))
            else:
                # The corner may lie anywhere in the CRS; all other numbers are sizes.
                low = -_FARTHEST if name in ("west", "north") else 0.0
                types = int if name in ("width_px", "height_px") else (int, float)
                is_number = isinstance(value, types) and not isinstance(value, bool)
                right = is_number and low < value < _FARTHEST
            if not right:
                raise InvalidInput("{0} {1!r}: cannot be that of a mosaic", name, value)

    @cached_property
    def _plane(self) -> Plane:
        if self.crs == WebMercator.crs:
            return WebMercator()
        return ProjectedPlane(
            self.crs,
            self.west,
            self.north,
            self.width_px * self.pixel_width,
            self.height_px * self.pixel_height,
        )

    def xy(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Eastings and northings, in the CRS's unit, of positions in degrees (any shape).

        They are continuous across the mosaic, also at the antimeridian.
        """
        plane = self._plane
        u, v = plane.forward(lat_deg, lon_deg)
        if isinstance(plane, WebMercator):
            middle = (self.west + self.width_px * self.pixel_width / 2.0 - plane.west) / plane.width
            u = u - np.rint(u - middle)
        return plane.west + u * plane.width, plane.north - v * plane.height

    def lat_lon(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude in degrees of eastings and northings (any shape); the inverse of `xy`."""
        plane = self._plane
        return plane.inverse((x - plane.west) / plane.width, (plane.north - y) / plane.height)

    def px(self, lat_deg: Floats, lon_deg: Floats) -> tuple[Floats, Floats]:
        """Columns and rows from the upper left corner, of positions in degrees (any shape)."""
        x, y = self.xy(lat_deg, lon_deg)
        return (x - self.west) / self.pixel_width, (self.north - y) / self.pixel_height

    def ground(self, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        """Latitude and longitude in degrees of columns and rows (any shape); the inverse of `px`."""
        return self.lat_lon(self.west + column * self.pixel_width, self.north - row * self.pixel_height)

    def rim(self) -> tuple[Floats, Floats]:
        """Latitudes and longitudes in degrees of points along the mosaic's edges, corners included."""
        # Nine points for each edge, as edges are curves in degrees.
        along, first = np.linspace(0.0, 1.0, 9), np.zeros(9)
        column, row = (
            np.concatenate([along, along, first, first + 1.0]),
            np.concatenate([first, first + 1.0, along, along]),
        )
        return self.ground(column * self.width_px, row * self.height_px)


@dataclass(frozen=True, eq=False)
class Benchmark:
    """A benchmark, as read from its folder.

    Attributes
    ----------
    about : mapping
        Content of ``benchmark.json``.
    """

    folder: Path
    about: Mapping[str, Any]
    mosaic: ReferenceMosaic
    queries: Queries
    references: References
    truth: Positives

    @classmethod
    def read(cls, folder: str | os.PathLike[str]) -> Benchmark:
        """Read the benchmark in a folder; raises InvalidInput if a file cannot be read."""
        path = Path(folder)
        mark = path / BENCHMARK_FILE
        try:
            about = parse_json(decoded(read_limited(mark, MAX_SETTINGS_BYTES)))
        except (OSError, InvalidInput) as wrong:
            raise InvalidInput(
                "folder {0}: is not a benchmark, as {1} cannot be read ({2})",
                folder,
                BENCHMARK_FILE,
                getattr(wrong, "strerror", None) or wrong,
                remedy="make one first (terrainav benchmark make)",
            ) from wrong
        if not isinstance(about, dict) or about.get("schema") != SCHEMA:
            raise InvalidInput("{0}: is not of a benchmark that this version can read", mark)
        if "mosaic" not in about:
            raise InvalidInput(
                "folder {0}: is not finished",
                folder,
                remedy=Message("go on{0}", OptionName("resume").in_brackets),
            )
        from pyproj.exceptions import ProjError

        try:
            mosaic = ReferenceMosaic(**about["mosaic"])
            middle = mosaic.ground(np.array([mosaic.width_px / 2.0]), np.array([mosaic.height_px / 2.0]))
            # Some projections yield latitudes beyond a pole.
            if not (np.isfinite(middle).all() and abs(middle[0][0]) <= 90.0):
                raise InvalidInput("{0} {1!r}: cannot be that of a mosaic", "west", mosaic.west)
        except (TypeError, InvalidInput, ProjError) as wrong:
            raise InvalidInput("{0}: does not state where the mosaic lies ({1})", mark, wrong) from wrong
        benchmark = cls(
            path,
            about,
            mosaic,
            Queries.read(path / QUERIES_FILE),
            References.read(path / REFERENCES_FILE),
            Positives.read(path / POSITIVES_FILE),
        )
        benchmark._check()
        return benchmark

    def _check(self) -> None:
        for rows, name in ((self.queries, QUERIES_FILE), (self.references, REFERENCES_FILE)):
            if len(set(rows.id)) < len(rows):
                twice = next(one for one, count in Counter(rows.id).items() if count > 1)
                raise InvalidInput("{0}: {1!r} appears twice", self.folder / name, twice)
            for file in rows.file:
                if _may_leave_folder(file):
                    raise InvalidInput("{0}: {1!r} is not a file of the benchmark", self.folder / name, file)
            for column in fields(rows):
                if column.type == "Floats":
                    values = getattr(rows, column.name)
                    low, high = _RANGES.get(column.name, (-1e9, 1e9))
                    for at in np.flatnonzero(~((values >= low) & (values <= high)))[:1].tolist():
                        raise InvalidInput(
                            "{0}: {1} of {2!r} is {3:g}; must be from {4:g} to {5:g}",
                            self.folder / name,
                            column.name,
                            rows.id[at],
                            values[at],
                            low,
                            high,
                        )
        for known, named in (
            (self.query_rows, self.truth.query),
            (self.reference_rows, self.truth.reference),
        ):
            for one in named:
                if one not in known:
                    raise InvalidInput("{0}: names {1!r}, which does not exist", self.folder / POSITIVES_FILE, one)

    @property
    def has_buildings(self) -> bool:
        """Whether the reference has buildings, and queries have masks of them."""
        return isinstance(self.about.get(BUILDINGS), dict)

    def instance_file(self, index: int) -> Path:
        """Image of the numbers of the buildings that a query's pixels show."""
        image = self.folder / self.queries.file[index]
        folder = image.parent.parent / INSTANCES
        # Numbers that take 32 bits are in TIFF files beside images of other formats.
        paths = [folder / f"{image.stem}{ending}" for ending in (".png", ".tif")]
        return next((path for path in paths if path.is_file()), paths[0])

    @cached_property
    def query_rows(self) -> dict[str, int]:
        """Row of each query, by its id."""
        return {name: index for index, name in enumerate(self.queries.id)}

    @cached_property
    def reference_rows(self) -> dict[str, int]:
        """Row of each tile, by its id."""
        return {name: index for index, name in enumerate(self.references.id)}

    @cached_property
    def priors(self) -> Floats:
        """Priors (q, 4) of queries: latitude, longitude, height above ground, yaw; NaN where not measured.

        Raises InvalidInput if a file cannot be read.
        """
        found = np.full((len(self.queries), 4), np.nan)
        at = {file: index for index, file in enumerate(self.queries.file)}
        for folder in {Path(file).parent for file in at}:
            if not (self.folder / folder / PRIORS_FILE).is_file():
                continue
            priors = Priors.read(self.folder / folder / PRIORS_FILE)
            columns = priors.prior_lat_deg, priors.prior_lon_deg, priors.prior_agl_m, priors.prior_yaw_deg
            for name, prior in zip(priors.img_names, np.stack(columns, axis=1)):
                index = at.get((folder / name).as_posix())
                if index is not None:
                    found[index] = prior
        return found

    def positives(self, *, with_semi: bool = False) -> list[Numbers]:
        """Rows of the positive tiles of each query; with ``with_semi`` also of its semi-positive tiles."""
        found: list[list[int]] = [[] for _ in self.queries.id]
        for query, reference, kind in zip(self.truth.query, self.truth.reference, self.truth.kind):
            if kind == POSITIVE or with_semi:
                found[self.query_rows[query]].append(self.reference_rows[reference])
        return [np.array(rows, np.int64) for rows in found]

    @cached_property
    def queries_of_parts(self) -> dict[str, int]:
        """Number of queries in each part and in the gap; empty without a split."""
        counts = Counter(self.queries.part)
        return {part: counts[part] for part in (*PARTS, GAP)} if any(counts) else {}

    def gallery(self, part: str) -> Numbers:
        """Rows of the tiles among which a part's queries are searched; all tiles if ``part`` is empty."""
        parts = self.references.part
        return np.array([at for at, name in enumerate(parts) if not part or name in (part, "")], np.int64)

    def query_rows_in(self, part: str) -> Numbers:
        """Rows of the queries in a part, all queries if ``part`` is empty; raises InvalidInput without any."""
        if part and part not in PARTS:
            raise InvalidInput("part {0!r}: must be one of {1}", part, ", ".join(PARTS))
        if part and not self.queries_of_parts:
            raise InvalidInput("part {0!r}: the benchmark in {1} was made without parts", part, self.folder)
        found = np.array([at for at, name in enumerate(self.queries.part) if part in ("", name)], np.int64)
        if not len(found):
            raise InvalidInput("part {0!r}: the benchmark in {1} has no such queries", part, self.folder)
        return found

    def grey(self, file: str) -> Bytes:
        """Read an image as grey (h, w); raises InvalidInput if it cannot be read."""
        return np.asarray(open_image(self.folder / file, as_shown=True).convert("L"), np.uint8)

    def colours(self, file: str) -> Bytes:
        """Read an image as RGB (h, w, 3); raises InvalidInput if it cannot be read."""
        return np.asarray(open_image(self.folder / file, as_shown=True).convert("RGB"), np.uint8)


def _may_leave_folder(file: str) -> bool:
    """Whether a path may lead out of the benchmark's folder."""
    return Path(file).is_absolute() or ".." in Path(file).parts


def write_columns(path: Path, columns: Mapping[str, Sequence[str] | Floats]) -> None:
    """Write columns as CSV atomically; NaN is an empty cell, and image sizes have no decimals."""
    cells = [_cells(column, is_count=name in ("width_px", "height_px")) for name, column in columns.items()]
    write_whole(path, csv_bytes(chain([tuple(columns)], zip(*cells))))


def _cells(column: Sequence[str] | Floats, *, is_count: bool) -> Iterable[str]:
    if not isinstance(column, np.ndarray):
        return column
    whole = is_count and bool((column == np.floor(column)).all())
    values = column.astype(np.int64).tolist() if whole else column.tolist()
    return ["" if math.isnan(value) else repr(value) for value in values]


def _read_columns(path: Path, is_number: Mapping[str, bool]) -> dict[str, Any]:
    """Read columns of a CSV by name; columns with ``is_number`` become arrays, with NaN for empty cells."""
    lines = read_rows(path)
    header = next(lines)[1]
    missing = [name for name in is_number if name not in header]
    if missing:
        raise InvalidInput("table {0}: has no column {1}", path, missing[0])
    at = {name: header.index(name) for name in is_number}
    cells: dict[str, list[Any]] = {name: [] for name in is_number}
    for number, row in lines:
        for name in is_number:
            text = row[at[name]]
            cells[name].append(read_number(text, f"table {path}, line {number}: {name}") if is_number[name] else text)
    return {name: np.array(found, np.float64) if is_number[name] else tuple(found) for name, found in cells.items()}


def read_rows(path: Path, *, named_by_user: bool = False) -> Iterator[tuple[int, list[str]]]:
    """Yield line number and cells of a CSV's header and of each row.

    Raises
    ------
    InvalidInput
        The file cannot be read, has no header, repeats a column, or has a row of another length than the header.
    """
    try:
        text = decoded(read_limited(path, MAX_MISSION_BYTES, named_by_user=named_by_user))
    except OSError as wrong:
        raise InvalidInput("table {0}: cannot be read ({1})", path, wrong.strerror) from wrong
    except InvalidInput as wrong:
        raise InvalidInput("table {0}: cannot be read ({1})", path, wrong) from wrong
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    width = 0
    try:
        for row in reader:
            if not row:
                continue
            if not width:
                width = len(row)
                _check_header(path, row)
            if len(row) != width:
                raise InvalidInput(
                    "table {0}, line {1}: has {2} cells, not {3}", path, reader.line_num, len(row), width
                )
            yield reader.line_num, row
    except csv.Error as wrong:
        raise InvalidInput("table {0}, line {1}: is not CSV ({2})", path, reader.line_num, wrong) from wrong
    if not width:
        raise InvalidInput("table {0}: is empty", path)


def _check_header(path: Path, header: Sequence[str]) -> None:
    twice = next((name for name, count in Counter(header).items() if name and count > 1), None)
    if twice is not None:
        raise InvalidInput("{0}: has column {1} more than once", Message("table {0}", path), twice)


def read_number(text: str, where: str) -> float:
    """Parse a cell as a finite number, NaN if empty; raises InvalidInput."""
    if not text.strip():
        return math.nan
    try:
        value = real_number(text)
    except ValueError as wrong:
        raise InvalidInput("{0} {1!r}: must be a number", where, text) from wrong
    if not math.isfinite(value):
        raise InvalidInput("{0} {1!r}: must be a finite number", where, text)
    return value
