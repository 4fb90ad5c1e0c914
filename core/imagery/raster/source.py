"""A raster file as a source, on the pixel grid of the Web-Mercator map or in its CRS; ``{date}`` selects a file."""

from __future__ import annotations

import datetime as dt
import glob
import itertools
import math
import os
import re
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from ...arrays import Floats, PixelValues
from ...bands import NO_STRETCH, Bands, Range, in_8_bits, percentiles, stretch_range
from ...errors import InvalidInput, Message, PartError, SourceError
from ...geodesy.mercator import HIGHEST_ZOOM, PixelGrid
from ...geodesy.planes import ProjectedPlane
from ...limits import MAX_METADATA_CHARACTERS
from ...text.plain import printable
from ..http.transport import Transport
from ..opening import FileSource
from ..policy import Policy
from ..source import Part, Window, tile_parts
from ..systems import MAP
from ..tiles import KEY_ENV, check_zoom, environment_key
from .colours import Colours, choose_colours, height_colours
from .georeference import TILE_PX, RasterGeoreference
from .reading import Facts, OpenRaster, PixelBox, Pool, ReadError, Values, opener
from .remote import Remote
from .resampling import MOST_PX, PixelFootprints, Sums, are_pixels, means, pixel_footprints, reduced, without_mask
from .trust import FETCHED, KEY, allowed_drivers, check_virtual, file_of_part, host_of_virtual, name_for_gdal

#: Least and greatest number of pixels for percentiles; an overview needs the least to be chosen.
_SAMPLED_PX, _MOST_SAMPLED_PX = 1 << 18, 1 << 22
#: Slivers of pixels narrower than this are not read, px: noise of positions, far below the tolerance of `means`.
_SLIVER_PX = 1e-5
#: Side of the parts of pixels that are copied, a common size of blocks: a call takes as long as many pixels.
_COPIED_PX = 512
#: Placeholder of the date in a path.
PLACEHOLDER = "{date}"


class RasterFile(FileSource):
    """A raster file, or a path with {date} of several raster files."""

    takes_date = True
    has_bands = True

    def _open(self, date: str) -> RasterSource:
        options = self.options
        return open_raster(
            self.text,
            date=date,
            own_pixels=options.crs != MAP,
            bands=options.bands,
            stretch=options.stretch,
            as_stored=options.as_stored,
            heights=options.heights,
            transport=options.transport,
            key=options.key or self.environment_key() or "",
        )

    @property
    def needs_key(self) -> bool:
        """Whether the address contains {key}."""
        return KEY in self.text

    def environment_key(self) -> str | None:
        """Return the environment's key if the host may receive it."""
        if not self.needs_key:
            return None
        return environment_key([host_of_virtual(self.text)], named_by_user=self.options.named_by_user)


def open_raster(
    path: str | os.PathLike[str],
    *,
    date: str = "",
    own_pixels: bool = True,
    bands: Sequence[str] = (),
    stretch: str = NO_STRETCH,
    as_stored: bool = False,
    heights: bool = False,
    transport: Transport | None = None,
    key: str = "",
) -> RasterSource:
    """Open a raster file as a source of imagery.

    Accepted are georeferenced pictures: GeoTIFF, COG, JPEG 2000, a picture with world file and projection, or a VRT of
    files in its folder (see `trust` for all formats). `RasterSource` describes the resampling.

    Parameters
    ----------
    path : path
        A path, possibly with ``{date}`` in place of a date in any form; a path in GDAL's virtual file systems,
        ``/vsi…``; or the address of a file, ``https://…/x.tif``, which is read in parts.
    date : str
        YYYY-MM-DD, YYYY-MM or YYYY; empty for the date in the file, if any.
    own_pixels : bool
        Whether to use the raster's pixels in its CRS if possible (see `RasterSource`). Otherwise pictures have the
        pixels of the Web-Mercator map, aligned with other sources.
    bands : sequence of str
        Bands in the wanted order, by name or by number from 1; empty for all (as stored), or for red, green and blue.
    stretch : str
        Conversion of values to 8 bits: ``none``, ``percentile``, or two numbers, which become 0 and 255.
    as_stored : bool
        Whether to return any number of bands, in the file's data type unless stretched; otherwise red, green and blue
        of 8 bits.
    heights : bool
        Whether to return the first band as heights in float32; the raster's pixels may then be in degrees, too.
    transport : Transport or None
        Transport for requests not made by GDAL, which is not closed here; None to create a transport.
    key : str
        Value of ``{key}`` in an address.

    Raises
    ------
    InvalidInput
        The file is missing, is not a raster, lacks a georeference or wanted bands, has more than 8 bits where 8 are
        required, or refers to data elsewhere; no file has the date; or no library for raster files is installed.
    SourceError
        The server is out of reach or refuses.
    """
    given = os.fspath(path)
    name = name_for_gdal(given)
    if name.startswith("/vsi"):
        check_virtual(name)
    file, date = dated_file(name, date)
    _check_exists(file)
    try:
        drivers = allowed_drivers(file)
    except InvalidInput as wrong:
        raise InvalidInput("{0}: {1}", file, wrong) from wrong
    library = partial(opener(), drivers=drivers)
    remote = Remote(file, _title(file), transport, _required_key(file, key)) if FETCHED.search(file) else None
    pool = Pool(library, file, remote)
    try:
        with pool.lent(0) as raster:
            facts = raster.facts()
        return RasterSource(
            given,
            file,
            date or date_of_tags(facts.tags),
            facts,
            pool,
            own_pixels=own_pixels,
            bands=bands,
            stretch=stretch,
            as_stored=as_stored,
            heights=heights,
        )
    except ReadError as wrong:
        pool.close()
        raise InvalidInput("{0}: is not a readable raster: {1}", file, wrong) from wrong
    except InvalidInput as wrong:
        pool.close()
        raise InvalidInput("{0}: {1}", file, wrong, field=wrong.field) from wrong


class RasterSource:
    """A raster file in any coordinate reference system, opened by `open_raster`.

    If the raster's rows are parallel to an axis of a projected CRS, pictures have the raster's pixels, or means of 2,
    4, 8 … pixels along each side. Otherwise, or if these pixels coincide with the map's, pictures have the map's
    pixels.

    Each pixel of the map is the mean over its footprint in the raster, which PROJ locates for each pixel. The result is
    an average if the footprint is larger than the raster's pixels, a bilinear interpolation if not, and the unchanged
    pixel if the grids coincide. If any part of a footprint lacks imagery (beyond the edge, nodata, mask, alpha 0), all
    channels are 0, including the mask after the bands, so that missing pixels never mix with values. Palettes are
    converted to colours before, and values are stretched to 8 bits after resampling. Far below the native zoom, means
    are computed from an overview with at least 4 pixels along each side of a footprint.

    Attributes
    ----------
    bands : Bands
        Bands of the pixels that `fetch` returns.
    facts : Facts
        Description of the file.
    """

    map_types: tuple[str, ...] = ()

    def __init__(
        self,
        name: str,
        path: str,
        date: str,
        facts: Facts,
        pool: Pool,
        *,
        own_pixels: bool,
        bands: Sequence[str] = (),
        stretch: str = NO_STRETCH,
        as_stored: bool = False,
        heights: bool = False,
    ) -> None:
        if not facts.bands:
            inside = Message("name one of those within, such as {0}", facts.parts[0]) if facts.parts else None
            raise InvalidInput("is not a raster itself", remedy=inside)
        self.name = name
        self.title = _title(path)
        self.date = date
        self.facts = facts
        tags = ("TIFFTAG_COPYRIGHT", "COPYRIGHT", "EXIF_Copyright", "TIFFTAG_ARTIST")
        credit = next((facts.tags[tag] for tag in tags if facts.tags.get(tag, "").strip()), "")
        self.attribution = " ".join(printable(credit[:MAX_METADATA_CHARACTERS]).split()) or self.title
        self._path = path
        self._limits = stretch_range(stretch)
        self._is_stretched = stretch != NO_STRETCH
        self._colours: Colours = (
            height_colours(facts)
            if heights
            else choose_colours(facts, bands, as_stored=as_stored, stretched=self._is_stretched, title=self.title)
        )
        kind = self._colours.kind
        self.bands: Bands = replace(kind, data_type="uint8") if self._is_stretched else kind
        self._percentiles: tuple[Range, ...] | None = None
        self._measuring = threading.Lock()
        self._place = RasterGeoreference(facts)
        self._sizes = facts.sizes
        self._pool = pool
        self.policy = Policy() if pool.remote is None else pool.remote.policy
        self._fetched = itertools.count(1)
        self._state = _state(path)
        self.grid = self._grid(self._place.own_plane(of_degrees=heights) if own_pixels else None)

    def __repr__(self) -> str:
        return f"RasterSource({self._path!r}, {self.grid})"

    @property
    def is_warped(self) -> bool:
        """Whether the raster's coordinate reference system differs from the map's, EPSG:3857."""
        return self._place.is_warped

    def parts(self, window: Window) -> list[Part]:
        """Tiles that fill ``window``."""
        return tile_parts(window, self.grid)

    def fetch(self, map_type: str, part: Window) -> PixelValues:  # noqa: ARG002 (a file has one kind of picture)
        """Pixels of a part.

        Returns
        -------
        array (height_px, width_px, bands or one more) of the bands' type

        Raises
        ------
        InvalidInput
            The zoom is not available.
        PartError
            The pixels cannot be read.
        SourceError
            The file is gone or has changed since it was opened, or its provider's terms allow no more requests.
        Cancelled
            The source is closed.
        """
        check_zoom(part.zoom, self.grid, self.title)
        if self.policy.bulk_allowed == "no":
            self.policy.check(self.title, next(self._fetched))
        self._check_same()
        picture = self._mean_colours(pixel_footprints(*self._place.positions(part, self.grid)), part)
        if picture.shape[2] == len(self.bands):
            return picture
        if self._is_stretched:
            picture = self._stretched(picture)
        return without_mask(picture) if bool(picture[..., -1].all()) else picture

    @property
    def ranges(self) -> tuple[Range, ...]:
        """Values displayed darkest and brightest, by band: 0 and 255 for 8 bits, otherwise percentiles of the file.

        Raises
        ------
        SourceError
            The file cannot be read.
        """
        if self.bands.data_type == "uint8":
            return ((0.0, 255.0),) * len(self.bands)
        return self._file_percentiles()

    def _check_same(self, *, anew: bool = False) -> None:
        """Refuse a file that is gone or has changed; see `Remote.check` for remote files."""
        if self._pool.remote is not None:
            self._pool.remote.check(anew=anew)
        state = _state(self._path)
        if state != self._state:
            if state is None:
                raise SourceError("{0}: is gone", self._path)
            raise SourceError("{0}: has changed since it was opened", self._path, remedy="start anew")

    def _stretched(self, picture: Values) -> PixelValues:
        count = len(self.bands)
        limits = self._file_percentiles() if self._limits is None else (self._limits,) * count
        has_imagery = picture[..., -1] != 0
        shown = np.empty(picture.shape, np.uint8)
        shown[..., :-1] = in_8_bits(picture[..., :-1], limits)
        shown[..., -1] = 255
        shown[~has_imagery] = 0
        return shown

    def _file_percentiles(self) -> tuple[Range, ...]:
        """Percentiles of each band in the coarsest overview with enough pixels; computed once."""
        with self._measuring:
            if self._percentiles is None:
                values = self._sampled()
                self._percentiles = tuple(percentiles(values[:, band]) for band in range(len(self.bands)))
            return self._percentiles

    def _sampled(self) -> Values:
        """Values (n, bands) of all pixels of the raster or, if it is large, of a grid of 16 by 16 squares."""
        level = max(i for i, (width, height) in enumerate(self._sizes) if i == 0 or width * height >= _SAMPLED_PX)
        width, height = self._sizes[level]
        boxes = [PixelBox(0, 0, width, height)]
        # Read fewer pixels if there are more than four bands, to limit memory.
        share = max(len(self.bands) / 4.0, 1.0)
        if width * height * share > _MOST_SAMPLED_PX:
            side = min(max(int(64 / share), 1), width, height)
            boxes = [
                PixelBox(round(left), round(top), side, side)
                for top in np.linspace(0, height - side, 16)
                for left in np.linspace(0, width - side, 16)
            ]
        try:
            with self._pool.lent(level) as file:
                read = [self._colours.read(file, box).reshape(-1, len(self.bands) + 1) for box in boxes]
        except ReadError as wrong:
            self._check_same(anew=True)
            raise SourceError("{0}: cannot be read: {1}", self.title, wrong) from wrong
        values = np.concatenate(read)
        valid: Values = values[values[:, -1] != 0, :-1]
        return valid

    def close(self) -> None:
        """Close the file; `fetch` raises `Cancelled` afterwards."""
        self._pool.close()

    def _grid(self, own: tuple[ProjectedPlane, int] | None) -> PixelGrid:
        native = own[1] if own else min(max(self._place.native_zoom(), 0), HIGHEST_ZOOM)
        width, height = self._sizes[-1]
        lowest = 0
        if width * height > MOST_PX:
            # Without small overviews, tiles of low zooms would be means of too many pixels.
            side = self._sizes[0][0] / width * MOST_PX**0.5 / TILE_PX
            lowest = max(native - int(np.log2(side)) + 1, 0)
        # Zooms above the native one enlarge pixels. On the map, allow them up to 22, as most tiled sources do; in
        # another plane, six of them.
        if own:
            highest, extent = min(native + 6, HIGHEST_ZOOM), self._place.own_extent(native)
            return PixelGrid(TILE_PX, lowest, highest, native, extent=extent, plane=own[0], native_part_px=_COPIED_PX)
        return PixelGrid(TILE_PX, lowest, max(native, 22), native, extent=self._place.extent())

    def _mean_colours(self, footprints: PixelFootprints, part: Window) -> Values:
        """Means over footprints, with a mask; without, if they are pixels as stored."""
        level = self._level(footprints)
        width, height = self._sizes[level]
        footprints = footprints.scaled(0.0, 0.0, self._sizes[0][0] / width, self._sizes[0][1] / height)
        # Sum blocks of pixels while reading. On the map, a footprint must be at least two blocks wide and high; in the
        # raster's plane, a footprint is one block.
        least = 2.0 if self.grid.plane.wraps else 1.0
        x, y = (
            max(int(_smallest(size) / least + _SLIVER_PX), 1) for size in (footprints.width_px, footprints.height_px)
        )
        box = _extent(footprints, width, height, x, y)
        if box is None:
            kind = self._colours.kind
            return np.zeros((part.height_px, part.width_px, len(kind) + 1), kind.dtype)
        if box.width * box.height > MOST_PX:
            raise PartError(
                "{0}: a part of zoom {1} covers {2}x{3} px of it, which are too many",
                self.title,
                part.zoom,
                box.width,
                box.height,
                remedy="give it overviews, with gdaladdo",
            )
        footprints = footprints.scaled(box.left, box.top, x, y)
        if self._colours.are_stored and not self._is_stretched and are_pixels(footprints, box.height, box.width):
            return self._read(level, box, x, y, self._colours.read_stored)
        return means(self._read(level, box, x, y, self._colours.read), footprints, x * y, self._colours.kind.data_type)

    def _level(self, footprints: PixelFootprints) -> int:
        """Coarsest overview with at least four pixels along each side of a footprint.

        An overview made by decimation is shifted by half a pixel, which is then at most an eighth of a map pixel.
        """
        full_width, full_height = self._sizes[0]
        wide, high = _smallest(footprints.width_px), _smallest(footprints.height_px)
        return max(
            (
                level
                for level, (width, height) in enumerate(self._sizes)
                if wide * width / full_width >= 4.0 and high * height / full_height >= 4.0
            ),
            default=0,
        )

    def _read(self, level: int, box: PixelBox, x: int, y: int, read: Callable[[OpenRaster, PixelBox], Values]) -> Sums:
        """Sums of values in a box over blocks of ``x`` by ``y`` px, read in strips of about four million values."""
        bottom = box.top + box.height
        rows = max((1 << 22) // (box.width * y * (len(self.bands) + 1)), 1) * y
        try:
            with self._pool.lent(level) as file:
                strips = [
                    reduced(read(file, strip), x, y)
                    for strip in (
                        PixelBox(box.left, top, box.width, min(rows, bottom - top))
                        for top in range(box.top, bottom, rows)
                    )
                ]
        except ReadError as wrong:
            # If the file has changed, raise SourceError instead.
            self._check_same(anew=True)
            raise PartError("{0}: cannot be read here: {1}", self.title, wrong) from wrong
        return strips[0] if len(strips) == 1 else np.concatenate(strips)


def _required_key(path: str, key: str) -> str:
    if KEY in path and not key:
        raise SourceError("{0}: needs an API key: set the environment variable {1}", _title(path), KEY_ENV)
    return key if KEY in path else ""


def _title(path: str) -> str:
    """File name in any kind of path or address."""
    if FETCHED.search(path):
        path = unquote(re.split(r"[?&]url=", path)[-1]).partition("?")[0]
    return Path(path).name


def _check_exists(path: str) -> None:
    if path.startswith("/vsi") or file_of_part(path):
        return
    try:
        if Path(path).is_dir():
            raise InvalidInput("{0}: is a folder", path, remedy="name a raster file")
        if not Path(path).is_file():
            raise InvalidInput("{0}: there is no such file", path)
    except OSError as wrong:
        raise InvalidInput("{0}: cannot be read ({1})", path, wrong.strerror) from wrong


def _state(path: str) -> tuple[int, int] | None:
    """Size and modification time of a file; None for missing and virtual files."""
    try:
        status = Path(file_of_part(path) or path).stat()
    except OSError:
        return None
    return status.st_size, status.st_mtime_ns


def _smallest(size_px: Floats) -> float:
    finite = size_px[np.isfinite(size_px)]
    return float(finite.min()) if finite.size else 1.0


def _extent(footprints: PixelFootprints, width: int, height: int, x: int, y: int) -> PixelBox | None:
    """Box of pixels under footprints, in whole blocks of ``x`` by ``y`` px from the raster's corner; None if empty."""
    left, right = (
        footprints.column_px - footprints.width_px / 2.0,
        footprints.column_px + footprints.width_px / 2.0,
    )
    top, bottom = (
        footprints.row_px - footprints.height_px / 2.0,
        footprints.row_px + footprints.height_px / 2.0,
    )
    # Comparisons with NaN are False, without a warning.
    with np.errstate(invalid="ignore"):
        across = (right > _SLIVER_PX) & (left < width - _SLIVER_PX)
        down = (bottom > _SLIVER_PX) & (top < height - _SLIVER_PX)
    if not footprints.are_upright:
        across = down = across & down
    if not (across.any() and down.any()):
        return None
    left, right, top, bottom = left[across], right[across], top[down], bottom[down]
    first_x, first_y = (max(math.floor(edge.min() + _SLIVER_PX), 0) for edge in (left, top))
    first_x, first_y = first_x - first_x % x, first_y - first_y % y
    last_x, last_y = (math.ceil(edge.max() - _SLIVER_PX) for edge in (right, bottom))
    last_x, last_y = min(last_x + -last_x % x, width), min(last_y + -last_y % y, height)
    return PixelBox(first_x, first_y, last_x - first_x, last_y - first_y)


def checked_date(text: str) -> str:
    """Convert a date to YYYY, YYYY-MM or YYYY-MM-DD; in ``text``, ``-`` may be ``_``, ``.`` or missing.

    Raises
    ------
    InvalidInput
        Another form, or a day that does not exist.
    """
    found = re.fullmatch(r"(\d{4})(?:([-_.]?)(\d\d)(?:\2(\d\d))?)?", text)
    numbers = [number for number in (found.group(1, 3, 4) if found else ()) if number]
    try:
        dt.date(*(int(number) for number in [*numbers, "01", "01"][:3]))
    except (ValueError, TypeError):
        numbers = []
    if not numbers:
        raise InvalidInput("date {0!r}: must be YYYY-MM-DD, YYYY-MM or YYYY", text, field="date")
    return "-".join(numbers)


def date_of_tags(tags: Mapping[str, str]) -> str:
    """Day in a TIFF's date tag, as YYYY-MM-DD; empty without a valid date."""
    found = re.match(r"(\d{4})[:-](\d\d)[:-](\d\d)", tags.get("TIFFTAG_DATETIME", ""))
    try:
        return dt.date(*(int(number) for number in found.groups())).isoformat() if found else ""
    except ValueError:
        return ""


def dated_file(path: str, date: str) -> tuple[str, str]:
    """Find the file for a path and a date.

    Parameters
    ----------
    path : str
        May contain ``{date}``, also several times and in folder names.
    date : str
        In any form of `checked_date`; empty for none.

    Returns
    -------
    path, date : str
        The date as `checked_date` returns it.

    Raises
    ------
    InvalidInput
        No file has this date, or a path with ``{date}`` has none; the error lists the available dates.
    """
    date = checked_date(date) if date else ""
    if PLACEHOLDER not in path:
        return path, date
    if path.startswith("/vsi"):
        if not date:
            raise InvalidInput("{0}: say which date", path, field="date")
        return path.replace(PLACEHOLDER, date), date
    files = _files(path)
    if date in files:
        return files[date], date
    dates = sorted(files)
    named: str = ", ".join(dates[-10:]) or Message("none")
    if len(dates) > 10:
        named = Message("{0} earlier ones and {1}", len(dates) - 10, named)
    missing = Message("there is none of {0}", date) if date else Message("say which date")
    raise InvalidInput("{0}: {1}; dates there are: {2}", path, missing, named, field="date")


def _files(path: str) -> dict[str, str]:
    """Files that match a path with ``{date}``, by date."""
    first, *more = os.path.normpath(path).split(PLACEHOLDER)
    pattern = re.compile(re.escape(first) + "(.+?)" + r"\1".join(map(re.escape, more)), re.DOTALL)
    found: dict[str, str] = {}
    # Path.glob does not accept absolute patterns.
    for name in sorted(glob.glob("*".join(map(glob.escape, [first, *more])))):  # noqa: PTH207
        match = pattern.fullmatch(os.path.normpath(name))
        if match and Path(name).is_file():
            try:
                found[checked_date(match.group(1))] = name
            except InvalidInput:
                continue
    return found
