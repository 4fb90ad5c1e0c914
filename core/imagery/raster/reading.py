"""Facts and stored pixels of rasters, read by GDAL's bindings or rasterio."""

from __future__ import annotations

import importlib.util
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import IO, Any, NamedTuple, Protocol, cast

import numpy as np

from ...arrays import Bytes, NDArray
from ...errors import Cancelled, InvalidInput, Message
from ...external.native_calls import NativeCall, NativeThread, thread_contexts
from .remote import Remote
from .sizes import check_block, check_counts
from .trust import DRIVERS, NAMES_OVERVIEWS, OVERVIEW_DOMAIN, OVERVIEW_FILE, VIRTUAL, check_virtual_file
from .virtual import OPTIONS, ROW_BYTES, VirtualFile, raw_bytes_vrt

Values = NDArray[Any]

#: GDAL's option to raise an error if a JPEG is cut off, instead of filling with grey.
STRICT_JPEG = "GDAL_ERROR_ON_LIBJPEG_WARNING"
#: GDAL's option for the size of the block cache, and megabytes: enough for a strip of blocks across a raster of 20,000
#: px. The default, 5 % of the machine's memory, is no faster.
_CACHE, _CACHE_MB = "GDAL_CACHEMAX", 64
#: GDAL's options for one raster, by name.
Options = Mapping[str, str]
NO_OPTIONS: Options = MappingProxyType({})
#: Domains of GDAL's metadata that describe bands: the default, and IMAGERY with wavelengths.
_DOMAINS = ("", "IMAGERY")
#: Item and domain of GDAL's metadata for grey bands in which 0 is white.
_WHITE_IS_ZERO = ("MINISWHITE", "IMAGE_STRUCTURE")
#: Item and domain of GDAL's metadata for the interleaving of bands, and the value for interleaving by pixel.
_INTERLEAVE, _BY_PIXEL = ("INTERLEAVE", "IMAGE_STRUCTURE"), "PIXEL"
#: Formats that GDAL decodes as a whole, although it reports smaller blocks.
_WHOLE = frozenset(["WEBP", "JPEGXL"])
#: Options of the environment that a thread keeps.
_entered = threading.local()


class PixelBox(NamedTuple):
    """A rectangle of pixels, counted from the raster's left and top."""

    left: int
    top: int
    width: int
    height: int


@dataclass(frozen=True)
class Band:
    """A file's description of a band.

    Parameters
    ----------
    data_type : str
        Data type of the values, by numpy's name.
    colour : str
        GDAL's colour interpretation: gray, red, green, blue, alpha, palette, undefined, …
    nodata : float or None
        Value of pixels without data.
    bits : int or None
        Used bits of a value; None if all bits of the type are used.
    palette : tuple of (red, green, blue, alpha)
        Colours of the values from 0 on; empty without a palette.
    masked : bool
        Whether the file has a mask for the band other than nodata and alpha.
    name : str
        Description; empty without one.
    unit : str
        Unit of the values; empty without one.
    scale, offset : float
        The quantity in ``unit`` is value * scale + offset.
    items : tuple of (domain, name, value)
        Metadata in the domains of `_DOMAINS`.
    """

    data_type: str
    colour: str = "undefined"
    nodata: float | None = None
    bits: int | None = None
    palette: tuple[tuple[int, int, int, int], ...] = ()
    masked: bool = False
    name: str = ""
    unit: str = ""
    scale: float = 1.0
    offset: float = 0.0
    items: tuple[tuple[str, str, str], ...] = ()


@dataclass(frozen=True)
class Facts:
    """Description of a raster file.

    Parameters
    ----------
    bands : tuple of Band
    sizes : tuple of (width, height)
        Sizes in px of the raster, then of its overviews from fine to coarse.
    crs_wkt : str
        Empty without one.
    geotransform : tuple of 6 float or None
        In GDAL's order: x of the upper left corner, x steps per column and row, then the same for y; None without one.
    tags : mapping of str to str
        Metadata of the whole file.
    by_points : bool
        Whether only ground control points georeference the raster.
    parts : tuple of str
        Names of the rasters in a file that contains several.
    white_is_zero : bool
        Whether 0 is white in the first band (TIFF's PhotometricInterpretation 0).
    """

    bands: tuple[Band, ...]
    sizes: tuple[tuple[int, int], ...]
    crs_wkt: str
    geotransform: tuple[float, ...] | None
    tags: Mapping[str, str]
    by_points: bool = False
    parts: tuple[str, ...] = ()
    white_is_zero: bool = False


class ReadError(Exception):
    """A library cannot open or read a file. The message is one line; callers add the file."""

    def __init__(self, words: object) -> None:
        is_message = isinstance(words, Message)
        super().__init__(words if is_message else " ".join(str(words).split()) or Message("no reason given"))


class OpenRaster(Protocol):
    """An open raster, or an open overview of one; for one thread at a time."""

    def facts(self) -> Facts:
        """Read the description of the file; call this for the raster only, not for an overview."""

    def read(self, bands: Sequence[int], box: PixelBox, data_type: str = "uint8") -> Values:
        """Read stored values, (len(bands), height, width), into a data type that holds them.

        Bands are counted from 1. Raises ReadError.
        """

    def read_mask(self, band: int, box: PixelBox) -> Bytes:
        """Read the mask of a band, (height, width), with 0 for no data. Raises ReadError."""

    def close(self) -> None:
        """Close the file."""


#: Opens a path's raster (level 0) or overview (level 1 and up) with one of the formats ``drivers``; raises ReadError.
Opener = Callable[..., OpenRaster]


def opener() -> Opener:
    """Return the class that opens raster files, with rasterio or GDAL's bindings.

    If QGIS or GDAL's bindings are loaded, rasterio is not used: its wheels contain another GDAL, and two GDALs in one
    process may crash QGIS.

    Raises
    ------
    InvalidInput
        Neither library is installed.
    """
    loaded = {"qgis", "osgeo"} & sys.modules.keys()
    if not loaded and importlib.util.find_spec("rasterio"):
        return RasterioFile
    if importlib.util.find_spec("osgeo"):
        return GdalFile
    raise InvalidInput("raster files need rasterio: pip install terrainav[raster]")


def _checked(kind: Opener, path: str, drivers: Sequence[str], options: Options) -> tuple[Sequence[str], Options]:
    """Return formats and options to open a raster; check a file in GDAL's virtual file systems first.

    GDAL caches files of servers, so it later opens the same bytes that were checked.

    Raises
    ------
    InvalidInput
    ReadError
    """
    if not path.startswith(VIRTUAL):
        return drivers, options
    # Keep GDAL from opening files beside the raster, which cannot be checked.
    options = {"GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", **options}
    raw = kind(raw_bytes_vrt(path), 0, ("VRT",), {**OPTIONS, **options})
    file = cast("IO[bytes]", VirtualFile(lambda row: raw.read([1], PixelBox(0, row, ROW_BYTES, 1)).tobytes()))
    try:
        return check_virtual_file(path, file, drivers), options
    except EOFError as wrong:
        raise ReadError(Message("its header cannot be read whole")) from wrong
    finally:
        raw.close()


def filled(values: Values, is_known: NDArray[np.bool_], reach_px: int) -> Values:
    """Fill missing values (h, w) of float32 with GDAL's FillNodata.

    A missing value becomes the mean, weighted by inverse distance, of the nearest values within reach in the four
    quadrants around it; it stays unchanged if none is within reach.

    Raises
    ------
    InvalidInput
        As `opener` does.
    ReadError
    """
    return NativeCall(partial(_filled, values, is_known, reach_px)).result()


def _filled(values: Values, is_known: NDArray[np.bool_], reach_px: int) -> Values:
    height, width = values.shape
    if opener() is RasterioFile:
        from rasterio.fill import fillnodata

        with _raised_errors(NO_OPTIONS):
            return np.asarray(fillnodata(values.copy(), is_known, reach_px, 0), np.float32)
    from osgeo import gdal

    with _collected_errors(NO_OPTIONS) as messages:
        memory = gdal.GetDriverByName("MEM")
        target = memory.Create("", width, height, 1, gdal.GDT_Float32)
        mask = memory.Create("", width, height, 1, gdal.GDT_Byte)
        target.WriteRaster(0, 0, width, height, np.ascontiguousarray(values, np.float32).tobytes())
        mask.WriteRaster(0, 0, width, height, is_known.astype(np.uint8).tobytes())
        # By default, temporary files may lie in the current folder.
        options = ["TEMP_FILE_DRIVER=MEM"]
        gdal.FillNodata(target.GetRasterBand(1), mask.GetRasterBand(1), reach_px, 0, options)
        result = target.ReadRaster(0, 0, width, height)
    return _array(result, messages, (height, width), "float32")


@contextmanager
def _collected_errors(options: Options) -> Iterator[list[str]]:
    """Collect GDAL's errors in this thread instead of printing them, and convert exceptions to ReadError.

    Whether the bindings raise depends on settings of the process (QGIS, another plugin), so both cases are handled.
    A JPEG that is cut off is an error; by default, GDAL would only warn and fill with grey.
    """
    from osgeo import gdal

    # Older bindings cannot set options of a thread, and options of the process must stay unchanged.
    wanted = {STRICT_JPEG: "YES", **options} if hasattr(gdal, "SetThreadLocalConfigOption") else {}
    earlier = {name: gdal.GetThreadLocalConfigOption(name) for name in wanted}
    messages: list[str] = []

    def collect(severity: int, _number: int, words: str) -> None:
        if severity >= gdal.CE_Failure:
            messages.append(words)

    gdal.PushErrorHandler(collect)
    for name, value in wanted.items():
        gdal.SetThreadLocalConfigOption(name, value)
    try:
        yield messages
    except RuntimeError as wrong:
        raise ReadError(messages[0] if messages else wrong) from wrong
    finally:
        for name, value in earlier.items():
            gdal.SetThreadLocalConfigOption(name, value)
        gdal.PopErrorHandler()


class GdalFile:
    """A raster or an overview opened by GDAL."""

    def __init__(self, path: str, level: int, drivers: Sequence[str] = DRIVERS, options: Options = NO_OPTIONS) -> None:
        from osgeo import gdal

        drivers, options = _checked(GdalFile, path, drivers, options)
        self._gdal: Any = gdal
        self._options = options
        overview = [f"OVERVIEW_LEVEL={level - 1}"] if level else []
        with _collected_errors(options) as messages:
            self._dataset = gdal.OpenEx(path, gdal.OF_RASTER, allowed_drivers=list(drivers), open_options=overview)
        if self._dataset is None:
            raise ReadError(messages[0] if messages else Message("no format that GDAL knows"))

    def facts(self) -> Facts:
        """Read the description of the file."""
        with _collected_errors(self._options):
            dataset = self._dataset
            if dataset.GetMetadataItem(OVERVIEW_FILE, OVERVIEW_DOMAIN):
                raise ReadError(NAMES_OVERVIEWS)
            first = dataset.GetRasterBand(1) if dataset.RasterCount else None
            overviews = first.GetOverviewCount() if first else 0
            check_counts(dataset.RasterCount, overviews)
            levels = [first, *map(first.GetOverview, range(overviews))] if first else []
            for level in levels:
                self._check_block(level)
            reference = dataset.GetSpatialRef()
            bands = [dataset.GetRasterBand(1 + i) for i in range(dataset.RasterCount)]
            return Facts(
                bands=tuple(self._band(band) for band in bands),
                sizes=(
                    (dataset.RasterXSize, dataset.RasterYSize),
                    *((level.XSize, level.YSize) for level in levels[1:]),
                ),
                crs_wkt=reference.ExportToWkt(["FORMAT=WKT2_2019"]) if reference else "",
                geotransform=dataset.GetGeoTransform(can_return_null=True),
                tags=dict(dataset.GetMetadata()),
                by_points=dataset.GetGCPCount() > 0,
                parts=tuple(name for name, _ in dataset.GetSubDatasets()),
                white_is_zero=dataset.GetMetadataItem(*_WHITE_IS_ZERO) == "YES",
            )

    def _check_block(self, band: Any) -> None:
        dataset, value_bytes = self._dataset, self._gdal.GetDataTypeSize(band.DataType) / 8
        is_whole = dataset.GetDriver().ShortName in _WHOLE
        for_all_bands = is_whole or dataset.GetMetadataItem(*_INTERLEAVE) == _BY_PIXEL
        width, height = (band.XSize, band.YSize) if is_whole else band.GetBlockSize()
        check_block(width, height, value_bytes * (dataset.RasterCount if for_all_bands else 1))

    def _band(self, band: Any) -> Band:
        gdal = self._gdal
        table = band.GetColorTable()
        bits = band.GetMetadataItem("NBITS", "IMAGE_STRUCTURE")
        known = gdal.GMF_ALL_VALID | gdal.GMF_ALPHA | gdal.GMF_NODATA
        data_type = gdal.GetDataTypeName(band.DataType)
        return Band(
            data_type="uint8" if band.DataType == gdal.GDT_Byte else data_type.lower(),
            colour=gdal.GetColorInterpretationName(band.GetColorInterpretation()).lower(),
            nodata=band.GetNoDataValue(),
            bits=int(bits) if bits else None,
            palette=tuple(table.GetColorEntry(i) for i in range(table.GetCount())) if table else (),
            masked=not band.GetMaskFlags() & known,
            name=band.GetDescription(),
            unit=band.GetUnitType(),
            scale=1.0 if band.GetScale() is None else band.GetScale(),
            offset=band.GetOffset() or 0.0,
            items=tuple((domain, *item) for domain in _DOMAINS for item in sorted(band.GetMetadata(domain).items())),
        )

    def read(self, bands: Sequence[int], box: PixelBox, data_type: str = "uint8") -> Values:
        """Read stored values."""
        gdal = self._gdal
        kinds = {"uint16": gdal.GDT_UInt16, "int16": gdal.GDT_Int16, "float32": gdal.GDT_Float32}
        kind = kinds.get(data_type, gdal.GDT_Byte)
        with _collected_errors(self._options) as messages:
            values = self._dataset.ReadRaster(*box, buf_type=kind, band_list=list(bands))
        return _array(values, messages, (len(bands), box.height, box.width), data_type)

    def read_mask(self, band: int, box: PixelBox) -> Bytes:
        """Read the mask of a band."""
        with _collected_errors(self._options) as messages:
            mask = self._dataset.GetRasterBand(band).GetMaskBand()
            values = mask.ReadRaster(*box, buf_type=self._gdal.GDT_Byte)
        return _array(values, messages, (box.height, box.width))

    def close(self) -> None:
        """Close the file."""
        self._dataset = None


def _array(values: bytes | None, messages: list[str], shape: tuple[int, ...], data_type: str = "uint8") -> Values:
    if messages or values is None:
        raise ReadError(messages[0] if messages else Message("no values"))
    return np.frombuffer(values, data_type).reshape(shape)


@contextmanager
def _raised_errors(options: Options) -> Iterator[None]:
    """Convert errors of rasterio to ReadError; a JPEG that is cut off is an error."""
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import CRSError, RasterioError

    try:
        with _environment(options):
            yield
    except (RasterioError, CRSError, CPLE_BaseError, OSError) as wrong:
        # GDAL's first error is at the end of the chain of causes of rasterio's error.
        root: BaseException = wrong
        while root.__cause__ is not None:
            root = root.__cause__
        raise ReadError(root) from wrong


def _environment(options: Options) -> AbstractContextManager[object]:
    """Rasterio's environment; kept in the thread of a file, as entering it takes as long as reading a small window."""
    import rasterio
    from rasterio.session import DummySession

    contexts, entered = thread_contexts(), getattr(_entered, "options", None)
    if entered is options:
        return nullcontext()
    # If S3 keys are in the environment, rasterio would create a boto3 session each time, which takes as long as several
    # tiles. A DummySession avoids this, and GDAL finds the keys itself.
    made: AbstractContextManager[object] = rasterio.Env(
        DummySession(), **{STRICT_JPEG: True, _CACHE: _CACHE_MB, **options}
    )
    # Options for other files, which may allow more, must not stay.
    if contexts is None or entered is not None:
        return made
    contexts.enter_context(made)
    _entered.options = options
    return nullcontext()


class RasterioFile:
    """A raster or an overview opened by rasterio."""

    # Warning filters are global to the process: two threads must not restore them in the wrong order.
    _opening = threading.Lock()

    def __init__(self, path: str, level: int, drivers: Sequence[str] = DRIVERS, options: Options = NO_OPTIONS) -> None:
        import rasterio
        from rasterio.errors import NotGeoreferencedWarning

        drivers, options = _checked(RasterioFile, path, drivers, options)
        overview = {"overview_level": level - 1} if level else {}
        with _raised_errors(options), self._opening, warnings.catch_warnings():
            # Callers report rasters without a georeference.
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            # This does the work of rasterio.open, which accepts only one driver.
            self._dataset: Any = rasterio.DatasetReader(path, driver=list(drivers), **overview)
        self._path, self._drivers, self._options = path, drivers, options

    def facts(self) -> Facts:
        """Read the description of the file."""
        with _raised_errors(self._options):
            dataset = self._dataset
            if any(name.upper() == OVERVIEW_FILE for name in dataset.tags(ns=OVERVIEW_DOMAIN)):
                raise ReadError(NAMES_OVERVIEWS)
            check_counts(dataset.count, len(dataset.overviews(1)) if dataset.count else 0)
            self._check_block()
            given = tuple(dataset.transform.to_gdal())
            # rasterio returns the identity for rasters without a geotransform.
            geotransform = None if given == (0.0, 1.0, 0.0, 0.0, 0.0, 1.0) else given
            return Facts(
                bands=tuple(self._bands()),
                sizes=((dataset.width, dataset.height), *self._overview_sizes()),
                crs_wkt=dataset.crs.to_wkt(version="WKT2_2019") if dataset.crs else "",
                geotransform=geotransform,
                tags=dict(dataset.tags()),
                # Read only if needed: there may be a million points, and rasterio creates an object for each.
                by_points=geotransform is None and bool(dataset.gcps[0]),
                parts=tuple(dataset.subdatasets),
                white_is_zero=dataset.tags(ns=_WHITE_IS_ZERO[1]).get(_WHITE_IS_ZERO[0]) == "YES",
            )

    def _overview_sizes(self) -> Iterator[tuple[int, int]]:
        for level in range(len(self._dataset.overviews(1)) if self._dataset.count else 0):
            overview = RasterioFile(self._path, 1 + level, self._drivers, self._options)
            try:
                overview._check_block()
                yield overview._dataset.width, overview._dataset.height
            finally:
                overview.close()

    def _check_block(self) -> None:
        dataset = self._dataset
        if not dataset.count:
            return
        try:
            value_bytes = np.dtype(dataset.dtypes[0]).itemsize
        except TypeError:
            # Complex integers, which numpy lacks, have up to 8 bytes.
            value_bytes = 8
        name, domain = _INTERLEAVE
        is_whole = dataset.driver in _WHOLE
        for_all_bands = is_whole or dataset.tags(ns=domain).get(name) == _BY_PIXEL
        height, width = (dataset.height, dataset.width) if is_whole else dataset.block_shapes[0]
        check_block(width, height, value_bytes * (dataset.count if for_all_bands else 1))

    def _bands(self) -> Iterator[Band]:
        from rasterio.enums import MaskFlags

        dataset = self._dataset
        known = {MaskFlags.all_valid, MaskFlags.alpha, MaskFlags.nodata}
        # Each of these properties iterates over all bands.
        each = zip(
            dataset.indexes,
            dataset.dtypes,
            dataset.colorinterp,
            dataset.nodatavals,
            dataset.mask_flag_enums,
            dataset.descriptions,
            dataset.units,
            dataset.scales,
            dataset.offsets,
        )
        for index, data_type, colour, nodata, masks, name, unit, scale, offset in each:
            bits = dataset.tags(index, ns="IMAGE_STRUCTURE").get("NBITS")
            palette = dataset.colormap(index) if colour.name == "palette" else {}
            yield Band(
                data_type=data_type,
                colour=colour.name,
                nodata=nodata,
                bits=int(bits) if bits else None,
                palette=tuple(palette[i] for i in sorted(palette)),
                masked=not known & set(masks),
                name=name or "",
                unit=unit or "",
                scale=scale,
                offset=offset,
                items=tuple(
                    (domain, *item)
                    for domain in _DOMAINS
                    for item in sorted(dataset.tags(index, ns=domain or None).items())
                ),
            )

    def read(self, bands: Sequence[int], box: PixelBox, data_type: str = "uint8") -> Values:
        """Read stored values."""
        with _raised_errors(self._options):
            return np.asarray(self._dataset.read(list(bands), window=_window(box)), data_type)

    def read_mask(self, band: int, box: PixelBox) -> Bytes:
        """Read the mask of a band."""
        with _raised_errors(self._options):
            return np.asarray(self._dataset.read_masks(band, window=_window(box)), np.uint8)

    def close(self) -> None:
        """Close the file."""
        self._dataset.close()


def _window(box: PixelBox) -> Any:
    from rasterio.windows import Window

    return Window(*box)


class _ThreadedRaster:
    """A raster whose methods run in a separate thread (`NativeCall`), and are abandoned when no longer wanted."""

    def __init__(self, file: OpenRaster, is_wanted: Callable[[], bool]) -> None:
        self._file, self._is_wanted, self._thread = file, is_wanted, NativeThread()
        self._last: NativeCall[Any] | None = None

    def facts(self) -> Facts:
        """Read the description of the file."""
        facts: Facts = self._called(self._file.facts)
        return facts

    def read(self, bands: Sequence[int], box: PixelBox, data_type: str = "uint8") -> Values:
        """Read stored values."""
        values: Values = self._called(partial(self._file.read, bands, box, data_type))
        return values

    def read_mask(self, band: int, box: PixelBox) -> Bytes:
        """Read the mask of a band."""
        mask: Bytes = self._called(partial(self._file.read_mask, band, box))
        return mask

    def close(self) -> None:
        """Close the file when the last call has ended."""
        if self._last is None:
            self._file.close()
        else:
            self._last.when_ended(lambda _: self._file.close())
        self._thread.close()

    def _called(self, work: Callable[[], Any]) -> Any:
        self._last = NativeCall(work, self._thread)
        return self._last.result(self._is_wanted)


def _close(files: Sequence[OpenRaster]) -> None:
    for file in files:
        file.close()


class Pool:
    """Handles of a raster and its overviews, for use by several threads.

    Parameters
    ----------
    open_file : callable
    path : str
    remote : Remote or None
        The raster if on another machine; closed with the pool.
    """

    def __init__(self, open_file: Opener, path: str, remote: Remote | None = None) -> None:
        self._open, self._path, self.remote = open_file, path, remote
        self._free: dict[int, list[OpenRaster]] = {}
        self._closed = False
        self._lock = threading.Lock()

    @contextmanager
    def lent(self, level: int) -> Iterator[OpenRaster]:
        """Lend a handle of the raster (level 0) or an overview; the handle is closed if its user raises.

        Raises
        ------
        ReadError
            The file cannot be opened.
        Cancelled
            The pool is closed.
        """
        with self._lock:
            if self._closed:
                raise Cancelled("{0}: closed", self._path)
            free = self._free.setdefault(level, [])
            known = free.pop() if free else None
        with self._without_key():
            file = known or self._opened(level)
            try:
                yield file
            except BaseException:
                file.close()
                raise
        if not self._keep_handle(level, file):
            file.close()

    @contextmanager
    def _without_key(self) -> Iterator[None]:
        """Mask the key of the raster's address in errors of GDAL."""
        try:
            yield
        except ReadError as wrong:
            if self.remote is None:
                raise
            raise ReadError(self.remote.masked(str(wrong))) from None

    def _opened(self, level: int) -> OpenRaster:
        if self.remote is None:
            return self._in_thread(partial(self._open, self._path, level))
        try:
            return self._in_thread(partial(self._open, self.remote.path, level, options=self.remote.options))
        except ReadError:
            if not self.remote.leave_out_heads():
                raise
        return self._in_thread(partial(self._open, self.remote.path, level, options=self.remote.options))

    def _in_thread(self, work: Callable[[], OpenRaster]) -> OpenRaster:
        call = NativeCall(work)
        try:
            return _ThreadedRaster(call.result(self._is_open), self._is_open)
        except BaseException:
            call.when_ended(_close)
            raise

    def _is_open(self) -> bool:
        return not self._closed

    def _keep_handle(self, level: int, file: OpenRaster) -> bool:
        with self._lock:
            if not self._closed:
                self._free[level].append(file)
            return not self._closed

    def close(self) -> None:
        """Close the handles; lent handles are closed on return."""
        with self._lock:
            self._closed = True
            files = [file for free in self._free.values() for file in free]
            self._free.clear()
        if self.remote is not None:
            self.remote.close()
        for file in files:
            file.close()
