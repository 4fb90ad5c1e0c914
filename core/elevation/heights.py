"""Sources of heights over the ellipsoid, each on its pixel grid."""

from __future__ import annotations

import math
import re
import threading
import weakref
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib.util import resolve_name
from typing import Any, Protocol

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput, Message, OptionName
from ..geodesy.local import enu_axes, geodetic
from ..geodesy.mercator import PixelGrid
from ..geodesy.triangles import NO_FACES, FaceModel, Triangles
from ..imagery.entry import CatalogueEntry
from ..imagery.opening import NAMED, NamedSource, SourceOptions, named_source, source_kind, whole_path
from ..imagery.source import Source, Window, tile_parts
from ..imagery.xyz import open_entry
from ..numbers import real_number
from ..resources import read_json
from ..storage.files import file_exists
from ..text.plain import whole_number
from .datum import UNITS_M, Datum

Heights32 = NDArray[np.float32]

#: Plausible heights of the ground over the ellipsoid, metres.
LOWEST_M, HIGHEST_M = -12_000.0, 9_500.0
#: Common value for no data, which some programs write without a declaration.
_VOID = -9999.0
#: Functions to decode heights from red, green and blue of tiles, by name of the encoding.
_ENCODED: dict[str, Callable[[NDArray[Any]], Floats]] = {
    "terrarium": lambda rgb: rgb @ np.array([256.0, 1.0, 1.0 / 256.0]) - 32768.0,
    "terrain-rgb": lambda rgb: rgb @ np.array([6553.6, 25.6, 0.1]) - 10000.0,
}


@dataclass(frozen=True)
class HeightOptions:
    """Options of a source of heights.

    Parameters
    ----------
    datum : str
        See `Datum.named`; empty for the datum of the source, or the ellipsoid if the source states none.
    unit : str
        m, ft or us-ft; empty for the unit of the source.
    offset_m : float
        Metres to add to all heights.
    source : SourceOptions
        Options common to sources of heights and of imagery.
    """

    datum: str = ""
    unit: str = ""
    offset_m: float = 0.0
    source: SourceOptions = SourceOptions()  # noqa: RUF009  frozen


class Layer(Protocol):
    """Heights over the ellipsoid on a pixel grid. Implementations are safe to call from several threads at once."""

    @property
    def title(self) -> str:
        """Title for people."""

    @property
    def attribution(self) -> str:
        """Credit for the heights."""

    @property
    def grid(self) -> PixelGrid:
        """Pixel grid; heights are at pixel centres."""

    @property
    def faces(self) -> FaceModel:
        """Buildings of the source, which the heights leave out."""

    def read(self, zoom: int, left_px: int, top_px: int, width_px: int, height_px: int) -> Heights32:
        """Read heights (height_px, width_px) in metres, NaN if missing."""


class ConstantHeight:
    """The same height everywhere."""

    attribution = ""
    grid = PixelGrid(max_zoom=30, native_zoom=30)
    faces = NO_FACES

    def __init__(self, height_m: float) -> None:
        self.height_m = height_m
        self.title = f"{height_m:g} m"

    def read(self, _zoom: int, _left_px: int, _top_px: int, width_px: int, height_px: int) -> Heights32:
        """Return the height."""
        return np.full((height_px, width_px), self.height_m, np.float32)


class TiledHeights:
    """Heights of a source of tiles, with a cache of 64 MB; the source is closed when the last reference is gone.

    Parameters
    ----------
    source : Source
        Source with heights in the first band, or encoded in colours.
    decoded : callable or None
        Converts colours (h, w, 3) to heights; None for heights in a band.
    datum : Datum
    offset_m : float
    scale, offset : float
        Heights in a band are value * scale + offset.
    says_void : bool
        Whether the source declares a no-data value, so that -9999 may be a value of a scaled band.
    faces : FaceModel
        Buildings of the source, on heights as it states them.
    """

    def __init__(
        self,
        source: Source,
        decoded: Callable[[NDArray[Any]], Floats] | None,
        datum: Datum,
        offset_m: float,
        scale: float = 1.0,
        offset: float = 0.0,
        *,
        says_void: bool = True,
        faces: FaceModel = NO_FACES,
    ) -> None:
        self._source, self._decoded, self._datum, self._offset_m = source, decoded, datum, offset_m
        self._scale, self._offset, self._says_void = scale, offset, says_void
        self.title, self.attribution, self.grid = source.title, source.attribution, source.grid
        self.faces = (
            _RaisedFaces(faces, datum, offset_m) if faces is not NO_FACES and (datum.code or offset_m) else faces
        )
        self._kept: OrderedDict[Window, Heights32] = OrderedDict()
        self._kept_bytes = 0
        self._lock = threading.Lock()
        weakref.finalize(self, source.close)

    @property
    def datum(self) -> Datum:
        """Vertical datum of the source."""
        return self._datum

    def read(self, zoom: int, left_px: int, top_px: int, width_px: int, height_px: int) -> Heights32:
        """Read the heights of a window."""
        found = np.full((height_px, width_px), np.nan, np.float32)
        window = Window(zoom, left_px, top_px, width_px, height_px)
        for part in tile_parts(window, self.grid):
            if not self._exists(part.window):
                continue
            tile = self._tile(part.window)
            x, y = max(part.dx_px, 0), max(part.dy_px, 0)
            right, bottom = (
                min(part.dx_px + part.window.width_px, width_px),
                min(part.dy_px + part.window.height_px, height_px),
            )
            found[y:bottom, x:right] = tile[y - part.dy_px : bottom - part.dy_px, x - part.dx_px : right - part.dx_px]
        return found

    def _exists(self, tile: Window) -> bool:
        """Whether a tile lies within the grid's world."""
        count = 1 << tile.zoom
        column, row = (int(at) // self.grid.tile_px for at in (tile.left_px, tile.top_px))
        return 0 <= column < count and 0 <= row < count

    def _tile(self, tile: Window) -> Heights32:
        with self._lock:
            kept = self._kept.get(tile)
            if kept is not None:
                self._kept.move_to_end(tile)
                return kept
        heights = self._decode_tile(tile)
        with self._lock:
            if tile not in self._kept:
                self._kept[tile] = heights
                self._kept_bytes += heights.nbytes
            while self._kept_bytes > 64 << 20 and len(self._kept) > 1:
                self._kept_bytes -= self._kept.popitem(last=False)[1].nbytes
        return heights

    def _decode_tile(self, tile: Window) -> Heights32:
        pixels = self._source.fetch("", tile)
        channels = 1 if self._decoded is None else 3
        values = pixels[..., :channels].astype(np.float64)
        if self._decoded is None:
            heights = values[..., 0] * self._scale + self._offset
        else:
            heights = self._decoded(values)
            # Values for missing heights in such tiles, and black; rounded, as steps of the encodings are 4 mm or more.
            void = np.isin(np.round(heights, 3), (_VOID, -32767.0, -32768.0)) | ~values.any(axis=-1)
            heights = np.where(void, np.nan, heights)
        if pixels.shape[2] > channels:
            heights = np.where(pixels[..., channels] != 0, heights, np.nan)
        void = heights == _VOID
        if not self._says_void:
            # The value for no data is stored unscaled.
            void |= values[..., 0] == _VOID
        heights = heights * self._datum.unit_m + self._offset_m
        if self._datum.code:
            heights = heights + self._datum_heights_m(tile)
        with np.errstate(invalid="ignore"):
            wrong = np.argwhere((heights < LOWEST_M) | (heights > HIGHEST_M) | void)
        if len(wrong):
            row, column = wrong[0].tolist()
            lat, lon = self._positions(tile, np.array([column]), np.array([row]))
            raise InvalidInput(
                "{0}: height {1:g} m at latitude {2:.6f}, longitude {3:.6f}: must be from {4:g} to {5:g}, and not "
                "{6:g}, which stands for no data elsewhere",
                self.title,
                float(heights[row, column]),
                float(lat[0]),
                float(lon[0]),
                LOWEST_M,
                HIGHEST_M,
                _VOID,
                remedy="say so in the file where the value stands for no data, for example with gdal_edit.py -a_nodata",
            )
        return heights.astype(np.float32)

    def _datum_heights_m(self, tile: Window) -> Floats:
        """Heights of the datum's zero surface at the pixels of a tile.

        In tiles narrower than 30 km, heights are interpolated between 17 points along each side: geoids are straight
        to a centimetre between these.
        """
        size = tile.width_px
        middle = self._positions(tile, np.array([size / 2.0]), np.array([size / 2.0]))
        width_m = float(self.grid.ground_m_per_px(middle[0], middle[1], tile.zoom)[0]) * size
        positions = np.arange(size, dtype=np.float64)
        at = positions if width_m > 30_000.0 else np.linspace(0.0, size - 1.0, 17)
        columns, rows = np.meshgrid(at, at)
        known = self._datum.heights_m(*self._positions(tile, columns, rows))
        if len(at) == size:
            return known
        by_row = np.stack([np.interp(positions, at, line) for line in known])
        heights: Floats = np.stack([np.interp(positions, at, line) for line in by_row.T], axis=1)
        return heights

    def _positions(self, tile: Window, column: Floats, row: Floats) -> tuple[Floats, Floats]:
        world = self.grid.world_px(tile.zoom)
        return self.grid.plane.inverse((tile.left_px + column + 0.5) / world, (tile.top_px + row + 0.5) / world)


@dataclass(frozen=True)
class _RaisedFaces:
    """Faces above a datum, raised by metres: a `FaceModel`."""

    faces: FaceModel
    datum: Datum
    offset_m: float

    @property
    def title(self) -> str:
        """Name for users."""
        return self.faces.title

    @property
    def attribution(self) -> str:
        """Credit for the faces."""
        return self.faces.attribution

    @property
    def count(self) -> int:
        """Greatest number of a building."""
        return self.faces.count

    @property
    def listed(self) -> int:
        """Greatest number of a building in a file."""
        return self.faces.listed

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the faces."""
        return self.faces.warnings

    def triangles(self, lat_deg: Floats, lon_deg: Floats, least_m: float = 0.0) -> Triangles:
        """Triangles of the faces, raised along the ellipsoid's normals; see `FaceModel`."""
        found = self.faces.triangles(lat_deg, lon_deg, least_m)
        lat, lon, _ = geodetic(found.corners_m)
        up_m = self.offset_m + (self.datum.heights_m(lat, lon) if self.datum.code else np.zeros_like(lat))
        return replace(found, corners_m=found.corners_m + enu_axes(lat, lon)[..., 2, :] * up_m[..., np.newaxis])


def open_heights(text: str, options: HeightOptions = HeightOptions()) -> Layer:
    """Open the source of heights that a text names.

    Parameters
    ----------
    text : str
        A raster file; ``world``, the embedded landscape; ``terrarium``, the public tiles of that name;
        ``terrarium:SOURCE`` or ``terrain-rgb:SOURCE``, a URL template or an MBTiles file of tiles in that encoding; or
        a number, the height of level ground over the ellipsoid in metres. ``#maxzoom=N&tilesize=N`` after a template
        states the highest zoom, by default 15, and the tile size, by default 256 px, or 512 px with @2x in the address.

    Raises
    ------
    InvalidInput
        The source is unknown, or its heights are ambiguous or invalid.
    SourceError
        The source is out of reach.
    """
    height_m = _number(text)
    if height_m is not None:
        if not LOWEST_M <= height_m <= HIGHEST_M:
            raise InvalidInput(
                "height {0:g} m: must be from {1:g} to {2:g}",
                height_m,
                LOWEST_M,
                HIGHEST_M,
                field="elevation",
            )
        return ConstantHeight(height_m)
    _check_one(text)
    datum = Datum.named(options.datum, _unit_m(options.unit)) if options.datum else None
    source_options = replace(options.source, crs="", bands=(), stretch="none", heights=True)
    if text.lower() == "world":
        # Import by name, as this room must not import the embedded world.
        module = __import__(resolve_name("..world.source", __package__ or ""), fromlist=["*"])
        world = module.WorldHeights(source_options.seed, options.source.crs)
        # Its heights are metres, whatever those of files are.
        datum = Datum(datum.code if datum else "")
        return TiledHeights(world, None, datum, options.offset_m, faces=world.faces)
    encoding, colon, inner = text.partition(":")
    if text in _shipped():
        entry = CatalogueEntry.from_dict(text, _shipped()[text])
        tiles = open_entry(entry, entry.date(None), None, replace(source_options, encoded=True))
        return TiledHeights(tiles, _ENCODED[text], datum or Datum.named("EGM96"), options.offset_m)
    if colon and encoding in _ENCODED:
        inner, max_zoom, tile_px = _read_template(inner, text)
        source_options = replace(source_options, heights=False, encoded=True, max_zoom=max_zoom, tile_px=tile_px)
        source = named_source(inner, source_options).open()
        return TiledHeights(source, _ENCODED[encoding], datum or Datum("", _unit_m(options.unit)), options.offset_m)
    return _open_raster(text, named_source(text, source_options), datum, options)


def _read_template(inner: str, text: str) -> tuple[str, int, int | None]:
    """Parse the text after an encoding; return the source, the highest zoom and the tile size."""
    source, _, behind = inner.partition("#")
    words = dict(word.split("=", 1) for word in behind.split("&") if "=" in word)
    if not words.keys() & {"maxzoom", "tilesize"}:
        source, words = inner, {}
    numbers = {}
    for name, value in words.items():
        if name not in ("maxzoom", "tilesize"):
            raise InvalidInput("heights {0}: {1!r} behind # must be maxzoom or tilesize", text, name)
        number = whole_number(value)
        if number is None or (name == "tilesize" and number == 0):
            raise InvalidInput("heights {0}: {1} {2!r} must be a whole number", text, name, value)
        numbers[name] = number
    is_template = source_kind(source).is_address
    usual = 512 if is_template and "@2x" in source else None
    return source, numbers.get("maxzoom", 15), numbers.get("tilesize", usual)


def _check_one(text: str) -> None:
    """Raise InvalidInput for a text that lists several sources."""
    parts = re.split(r"\s*[;,]\s*", text)
    if len(parts) > 1 and not file_exists(text) and all(_may_be_heights(part, text) for part in parts):
        raise InvalidInput(
            "heights {0!r}: are several sources in one",
            text,
            field="elevation",
            remedy=Message(
                "write a semicolon between them in QGIS, and a space in a command{0}",
                OptionName("elevation").in_brackets,
            ),
        )


def _may_be_heights(part: str, text: str) -> bool:
    """Whether a part of a text may name a source of heights; in an address, numbers do not."""
    if _number(part) is not None:
        return "://" not in text
    if part.lower() == "world" or part in _shipped() or part.partition(":")[0] in _ENCODED:
        return True
    kind = source_kind(part)
    return kind.is_file or kind.is_address


def whole_heights_path(text: str) -> str:
    """Make the path in a text absolute, so that the text names the same heights from any current folder."""
    if _number(text) is not None:
        return text
    encoding, colon, inner = text.partition(":")
    return f"{encoding}:{whole_path(inner)}" if colon and encoding in _ENCODED else whole_path(text)


def _check_known(named: NamedSource) -> None:
    """Raise InvalidInput for an unknown name; the remedy lists sources of heights."""
    try:
        _ = named.title
    except InvalidInput as unknown:
        raise InvalidInput(
            "heights {0!r}: no such source is known",
            named.text,
            field="elevation",
            remedy="name a raster file of heights, terrarium, world or a number of metres",
        ) from unknown


def _open_raster(text: str, named: NamedSource, datum: Datum | None, options: HeightOptions) -> Layer:
    if source_kind(text).named_by == NAMED:
        _check_known(named)
    if not named.has_bands and named.title:
        raise InvalidInput(
            "heights {0}: is a source of images",
            text,
            field="elevation",
            remedy="name a raster file of heights, terrarium or world, or write terrarium: or terrain-rgb: before the "
            "address of tiles whose colours are heights",
        )
    source: Any = named.open()
    try:
        found = _raster_datum(source, datum, options)
        first = source.facts.bands[0]
        if not math.isfinite(first.scale * first.offset) or first.scale == 0.0:
            raise InvalidInput(
                "{0}: its heights have the scale {1:g} and the offset {2:g}: must be finite, and the scale not 0",
                source.title,
                first.scale,
                first.offset,
            )
    except InvalidInput:
        source.close()
        raise
    return TiledHeights(
        source, None, found, options.offset_m, first.scale, first.offset, says_void=first.nodata is not None
    )


def _raster_datum(source: Any, datum: Datum | None, options: HeightOptions) -> Datum:
    """Datum and unit of a raster: the user's, otherwise the file's."""
    facts = source.facts
    unit = "m" if options.unit else facts.bands[0].unit
    found = Datum.from_crs(facts.crs_wkt, unit, source.title) or Datum()
    if datum is None:
        datum = found
    elif found.unit_m * datum.unit_m < 0.0 and (found.code or found.unit_m < 0.0):
        raise InvalidInput(
            "{0}: its vertical axis points {1}, and that of {2} {3}: must point the same way",
            source.title,
            _direction(found),
            datum.name,
            _direction(datum),
            field="vertical_datum",
        )
    unit_m = _unit_m(options.unit) if options.unit else abs(found.unit_m)
    datum = Datum(datum.code, math.copysign(unit_m, datum.unit_m))
    if datum.code:
        datum.check()
    return datum


def _direction(datum: Datum) -> Message:
    return Message("down") if datum.unit_m < 0.0 else Message("up")


def _unit_m(unit: str) -> float:
    return UNITS_M[unit] if unit else 1.0


def _number(text: str) -> float | None:
    try:
        value = real_number(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _shipped() -> dict[str, Any]:
    shipped: dict[str, Any] = read_json("elevation.json")
    return shipped
