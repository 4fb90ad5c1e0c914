"""Checks before GDAL opens a raster file: it must be a picture, and refer only to files that the user allows.

GDAL also opens descriptions of other data: a VRT may name any file of the machine, and a WMS file causes requests that
follow no terms. GDAL's list of allowed formats does not apply to data named inside, so this module reads descriptions
first.
"""

from __future__ import annotations

import codecs
import contextlib
import html
import importlib
import io
import os
import re
import sys
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import combinations
from pathlib import Path
from typing import IO, Any
from urllib.parse import quote, unquote

from ...errors import InvalidInput, Message
from ...geodesy.reference import check_reference, file_named, may_name_file
from ...limits import (
    MAX_BOXES,
    MAX_BOXES_BYTES,
    MAX_QUERY_S,
    MAX_RASTER_BANDS,
    MAX_RASTER_ITEMS,
    MAX_RASTER_OVERVIEWS,
    MAX_TIFF_TEXT_BYTES,
    MAX_VRT_BYTES,
    MAX_VRT_DEPTH,
    MAX_VRT_SOURCES,
    MAX_XML_DEPTH,
    MAX_XML_ELEMENTS,
)
from ...storage.files import file_exists, open_foreign
from ...text.plain import one_line
from ..tiles import check_address, url_host
from .sizes import check_directories, tag_texts

#: Allowed formats, by GDAL's names: pictures without references to other data, and VRT, whose references are checked.
DRIVERS = tuple(
    "GTiff JPEG PNG JP2OpenJPEG JP2KAK JP2ECW JP2MrSID JPEGXL ECW MrSID HFA GPKG WEBP GIF BIGGIF BMP ENVI EHdr NITF "
    "RMF SRTMHGT AAIGrid VRT".split()
)
#: Name in errors for a raster on another machine, instead of its address, which may contain a key.
_HEADER = Message("header")
#: Environment variable with further folders from which a VRT may read files.
FOLDERS_ENV = "TERRAINAV_RASTER_FOLDERS"
#: First bytes of formats in which text of the CRS may stand anywhere: HFA, NITF, MrSID, ECW.
_TEXT_ANYWHERE = (b"EHFA_HEADER_TAG", b"NITF", b"NSIF", b"msid", b"e\x02")
#: First bytes of TIFF, JPEG and PNG files, which GDAL takes for nothing else; a zero byte soon follows.
_BINARY = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+", b"\xff\xd8\xff", b"\x89PNG")
#: First bytes of formats whose check reads whole files: `_TEXT_ANYWHERE`, databases, and grids in text form.
_READ_WHOLE = (*_TEXT_ANYWHERE, b"SQLite format 3", b"ncols", b"NCOLS")
#: Extension of SRTM files, which have no signature, and the possible lengths in bytes, for 1, 1.5 and 3 arc seconds.
_SRTM, _SRTM_BYTES = (
    ".hgt",
    frozenset(2 * side * rows for side, rows in ((1201, 1201), (3601, 3601), (1801, 3601))),
)
#: Number of bytes read from the beginning of a file to determine the format.
_HEAD_BYTES = 4096
#: Elements and attributes of a VRT that name data, in lower case.
_NAMING = frozenset("sourcefilename sourcedataset sourcedatasetname filename dempath x_dataset y_dataset".split())
#: Elements of a VRT whose text is never a name of data.
_TEXTS = frozenset("srs mdi description copyright targetsrs sourcesrs category".split())
_ELSEWHERE = re.compile(r"/vsi|://|<|\bvrt:|^[a-z][a-z0-9_]+:", re.IGNORECASE)
#: Item and domain of metadata in which a raster of any format may name a file with overviews.
OVERVIEW_FILE, OVERVIEW_DOMAIN = "OVERVIEW_FILE", "OVERVIEWS"
NAMES_OVERVIEWS = Message("names another file for its overviews, which is not read")
#: TIFF tags of GDAL's metadata, and of the texts of GeoTIFF keys.
_TIFF_METADATA, _TIFF_KEY_TEXTS = 42112, 34737
#: Prefix of GDAL's virtual file systems, and of the one for HTTP; then a pattern of files on other machines.
VIRTUAL, CURL = "/vsi", "/vsicurl/"
FETCHED = re.compile("https?://|/vsi(curl|s3|gs|az|adls|oss|swift|hdfs|webhdfs)", re.IGNORECASE)
#: Address of a raster file, as opposed to a template of tiles.
ADDRESS = re.compile(
    r"https?://([^{}?#]|\{date\})+\.(tiff?|cog|jp2)(\?([^{}#]|\{date\}|\{key\})*)?", re.IGNORECASE | re.DOTALL
)
#: Placeholder of a key in an address.
KEY = "{key}"
#: Suffixes of files that GDAL opens with a raster, added to the raster's name.
_COMPANIONS = (".ovr", ".msk")
#: Suffixes of files in which GDAL looks for the CRS: added to the name, and in place of the extension.
_BEHIND, _IN_PLACE = (".aux", ".hdr"), (".prj", ".hdr", ".aux", ".tab")
#: Types of boxes of JPEG 2000 and JPEG XL that contain pixels only; first bytes of files of these formats.
_PIXEL_BOXES, _BOXES = frozenset({b"jp2c", b"jxlc", b"jxlp"}), (b"\0\0\0\x0cjP", b"\0\0\0\x0cJXL ")


def file_of_part(name: str) -> str:
    """Path of the file in GDAL's name of a part of it, such as GPKG:ortho.gpkg:summer; empty for other names."""
    # A single letter before a colon is a drive.
    if not re.match(r"[A-Z][A-Za-z0-9_]+:", name):
        return ""
    pieces = re.split(r'[:"]', name)
    # Names have up to five pieces or so; every span of pieces is tried.
    if len(pieces) > 20:
        return ""
    spans = combinations(range(1, len(pieces) + 1), 2)
    # Try the longest first, as a path may contain colons.
    paths = sorted((":".join(pieces[start:end]) for start, end in spans), key=len, reverse=True)
    return next((path for path in paths if path and file_exists(path)), "")


def name_for_gdal(name: str) -> str:
    """Convert the user's name of a raster to GDAL's: an address becomes ``/vsicurl/address``."""
    return CURL + name if ADDRESS.fullmatch(name) else name


def host_of_virtual(name: str) -> str:
    """Host in a name of GDAL's virtual file systems; empty if the name contains no address."""
    found = re.search(r"https?://[^#]+", unquote(name).replace("{key}", "0"), re.IGNORECASE)
    return url_host(found[0]) if found else ""


def fill_key(name: str, key: str) -> str:
    """Put the key, percent-encoded or not, in place of ``{key}`` in a name.

    If ``{key}`` is a whole parameter, the key may consist of several parameters, ``name=value&…``.
    """
    filled = re.sub(r"([?&]){key}(?=[&#]|$)", lambda found: found[1] + key.lstrip("?&"), name)
    return filled.replace(KEY, quote(unquote(key), safe=""))


def check_virtual(path: str) -> None:
    """Refuse a name of GDAL's virtual file systems that contains a key or a password, which would end up in files.

    Raises
    ------
    InvalidInput
        The message does not quote the name.
    """
    plain = unquote(path)
    if re.search(r"[?&](userpwd|header\.|headers?_file|bearer|.*password)", plain, re.IGNORECASE):
        raise InvalidInput("raster file /vsi…: holds credentials; no credentials may stand in it")
    # Check addresses of any scheme with any number of slashes, as curl accepts both. A single letter is a drive.
    for found in re.finditer(r"[a-z][a-z0-9+.-]+:/+", plain, re.IGNORECASE):
        check_address(f"http://{plain[found.end() :]}".replace(" ", "%20"), Message("address of a raster file"))


def allowed_drivers(path: str) -> list[str]:
    """Return the formats in which GDAL may open a file.

    Raises
    ------
    InvalidInput
        The file describes data elsewhere, or is a VRT of such data.
    """
    if path.startswith("/vsi"):
        # Files named by a VRT in a virtual file system cannot be checked.
        return [name for name in DRIVERS if name != "VRT"]
    part = file_of_part(path)
    if part and path.upper().startswith("GTIFF_DIR:OFF:"):
        raise InvalidInput("names a place in the file: must name a directory by its number, GTIFF_DIR:2:…")
    file = Path(part or path)
    # If the file is a link, GDAL resolves names in a VRT from the folder of the link's target.
    folders = (file.parent, _real(file).parent, *_folders())
    _check(file, tuple(dict.fromkeys(map(_real, folders))), 0, {})
    return [name for name in DRIVERS if name != "VRT"] if part else list(DRIVERS)


def _folders() -> Iterator[Path]:
    for one in os.environ.get(FOLDERS_ENV, "").split(os.pathsep):
        if one:
            yield Path(one)


def _check(file: Path, folders: tuple[Path, ...], depth: int, seen: dict[Path, int]) -> int:
    """Check a file and all files that GDAL opens with it; ``depth`` is 0 for the file named by the user.

    Returns
    -------
    int
        Number of reads of other files that reading the file causes, directly or indirectly; ``seen`` has this number
        for each checked file.
    """
    real = _real(file)
    if real in seen:
        return seen[real]
    seen[real] = 0
    if depth > MAX_VRT_DEPTH:
        raise InvalidInput("reads {0} within more than {1} others", file.name, MAX_VRT_DEPTH)
    head = _head(file)
    if _is_vrt(head):
        for (name, relative), times in Counter(_named(file)).items():
            each = [_check_source(file, at, folders, depth, seen) for at in _places(file, name, relative)]
            seen[real] += times * (1 + max(each))
            _check_reads(file, seen[real])
    elif re.search(
        rb"<(GDAL_WM|GDALTileIndex|WM[ST]|Capabilities|TileMap|MRF_META|kml)|\"stac_version\"",
        # Pixels may spell any of these; GDAL, too, looks no further than the first zero byte.
        head.split(b"\0", 1)[0] if head.startswith(_BINARY) else head,
        re.IGNORECASE,
    ):
        raise InvalidInput(
            "{0} describes a service or a collection, whose requests keep to no terms",
            file.name,
            remedy="name the service itself: wms:URL, wmts:URL or a URL template",
        )
    elif depth and head and not (_has_signature(head) or _is_srtm(file)):
        raise InvalidInput("{0} is of no format of images that a VRT may read here", file.name)
    for beside in _companions(file):
        _check(beside, folders, depth + 1, seen)
    aux = file.with_name(file.name + ".aux.xml")
    notes = _head(aux, MAX_VRT_BYTES + 1) if file_exists(aux) else b""
    if len(notes) > MAX_VRT_BYTES:
        raise InvalidInput("{0} holds more than {1} MB of metadata", aux.name, MAX_VRT_BYTES >> 20)
    if _names(f"{OVERVIEW_FILE}|/vsi|_DATASET", notes):
        raise InvalidInput("{0} names other files, which are not read", aux.name)
    with open_foreign(file) as opened:
        check_directories(file.name, opened, head)
        embedded = b"".join(tag_texts(file.name, opened, head, _TIFF_METADATA, MAX_VRT_BYTES))
    if _names(OVERVIEW_FILE, embedded):
        raise InvalidInput("{0} {1}", file.name, NAMES_OVERVIEWS)
    _check_items(aux, notes)
    _check_items(file, embedded)
    check_references(file, head)
    return seen[real]


def _companions(file: Path) -> list[Path]:
    """Files that GDAL opens with a raster; refuses special files such as pipes, on which GDAL would block."""
    try:
        companions, special = _companion_files(str(file.parent), file.parent.stat().st_mtime_ns)
    except OSError:
        # A folder may be searchable but not listable.
        companions, special = {}, ()
    for name in special:
        if name.lower().startswith(file.stem.lower()):
            raise InvalidInput("{0}: is not a regular file, and lies beside {1}", name, file.name)
    found = [name for ending in _COMPANIONS for name in companions.get((file.name + ending).lower(), ())]
    exact = [file.with_name(file.name + ending) for ending in _COMPANIONS]
    return [*dict.fromkeys([*(one for one in exact if file_exists(one)), *map(file.with_name, found)])]


@lru_cache(maxsize=16)
def _companion_files(folder: str, _changed_ns: int) -> tuple[dict[str, list[str]], tuple[str, ...]]:
    """Overviews and masks in a folder, by names in lower case, and the names of special files.

    GDAL looks for overviews and masks in a listing of the folder, ignoring case. Cached until the folder changes.
    """
    companions: dict[str, list[str]] = {}
    special = []
    with os.scandir(folder) as entries:
        for entry in entries:
            is_companion = entry.name.lower().endswith(_COMPANIONS)
            if is_companion:
                companions.setdefault(entry.name.lower(), []).append(entry.name)
            # A folder named like a companion is no plain file: GDAL has formats of folders, which name other files.
            is_plain = entry.is_file() or (entry.is_dir() and not is_companion)
            if not is_plain and Path(entry.path).exists():
                special.append(entry.name)
    return companions, tuple(special)


def _check_reads(vrt: Path, count: int) -> None:
    if count > MAX_VRT_SOURCES:
        raise InvalidInput(
            "{0} reads files more than {1:,} times",
            vrt.name,
            MAX_VRT_SOURCES,
            remedy="make one raster of it, with gdal_translate",
        )


def _check_items(file: Path, metadata: bytes) -> None:
    """Refuse metadata of too many items, which GDAL reads slowly."""
    count = sum(1 for _ in re.finditer(rb"<(mdi|gcp|item)\b", metadata, re.IGNORECASE))
    if count > MAX_RASTER_ITEMS:
        _refuse_number(file, count, MAX_RASTER_ITEMS, Message("items of metadata"))


def _refuse_number(file: Path, count: int, most: int, what: str) -> None:
    raise InvalidInput("{0} has {1:,} {2} or more: must be at most {3:,}", file.name, count, what, most)


def _has_signature(head: bytes) -> bool:
    """Whether a file begins with the signature of a known format."""
    jpeg_2000_and_xl = (b"\0\0\0\x0cjP", b"\xff\x4f\xff\x51", b"\xff\x0a")
    return head.startswith((*_BINARY, b"GIF8", b"BM", b"RIFF", *jpeg_2000_and_xl, *_READ_WHOLE))


def _is_srtm(file: Path) -> bool:
    return file.suffix.lower() == _SRTM and file.stat().st_size in _SRTM_BYTES


def _is_vrt(head: bytes) -> bool:
    return b"<vrtdataset" in head.lower()


def _names(pattern: str, metadata: bytes) -> bool:
    """Whether a pattern occurs in XML metadata, in any case, with entities decoded."""
    return re.search(pattern, html.unescape(metadata.decode("latin-1")), re.IGNORECASE) is not None


def check_references(file: Path, head: bytes | None = None) -> None:
    """Refuse a raster whose coordinate reference system names a file, which PROJ would open when GDAL reads it.

    Parameters
    ----------
    head : bytes or None
        First bytes of the file, if already read.

    Raises
    ------
    InvalidInput
        Names the reason and the file with the CRS, not the raster.
    """
    aux = file.with_name(file.name + ".aux.xml")
    if file_exists(aux):
        # Older programs wrote local encodings; in ISO 8859-1, every byte is a valid character.
        _parse(aux, _References(aux), "iso-8859-1")
    beside = [file.with_name(file.name + ending) for ending in _BEHIND]
    for ending in _IN_PLACE if file.suffix else ():
        beside += [file.with_suffix(ending), file.with_suffix(ending.upper())]
    for place in beside:
        if place != file and file_exists(place):
            with open_foreign(place) as opened:
                _check_texts(place.name, _chunks(opened, 0, place.stat().st_size))
    head = _head(file) if head is None else head
    if _is_vrt(head):
        _parse(file, _References(file))
    elif head.startswith(b"SQLite format 3"):
        _check_texts(file.name, _definitions(file))
    else:
        with open_foreign(file) as opened:
            _check_texts(file.name, _texts(file.name, opened, head, file.stat().st_size))


def check_fetched(name: str, data: bytes) -> None:
    """Check a fetched image of a dataset as `check_references` does."""
    _check_texts(name, _texts(name, io.BytesIO(data), data[:_HEAD_BYTES], len(data)))


def check_virtual_file(path: str, file: IO[bytes], drivers: Sequence[str]) -> list[str]:
    """Check a raster in GDAL's virtual file systems as `check_references` does, reading bytes through GDAL.

    Returns
    -------
    list of str
        Formats that the file may have.

    Raises
    ------
    InvalidInput
        Names the reason only; also raised for formats whose check reads whole files.
    """
    if path.lower().endswith(_SRTM):
        return [name for name in drivers if name == "SRTMHGT"]
    head = file.read(_HEAD_BYTES)
    if head.startswith(_BOXES):
        _check_boxes(file)
        return [name for name in drivers if name.startswith("JP")]
    if head.startswith((b"II", b"MM")):
        check_directories(_HEADER, file, head)
        _check_texts(_HEADER, _texts(_HEADER, file, head, sys.maxsize))
        return [name for name in drivers if name == "GTiff"]
    if head.startswith(_READ_WHOLE):
        raise InvalidInput(
            "is of a format that is read from folders of this machine alone",
            remedy="name a copy of it, unpacked and on this machine",
        )
    # Formats with a signature that do not contain a CRS as text.
    plain = "JPEG PNG GIF BIGGIF WEBP BMP JP2OpenJPEG JP2KAK JP2ECW JP2MrSID JPEGXL".split()
    return [name for name in drivers if name in plain]


def _check_boxes(file: IO[bytes]) -> None:
    """Check the boxes of a file of unknown size, which yields zeros after its end."""
    number = size = 0
    for start, end in _boxes(file, sys.maxsize):
        is_last = end == sys.maxsize
        number, size = number + 1, size + (0 if is_last else end - start)
        if number > MAX_BOXES or size > MAX_BOXES_BYTES:
            raise InvalidInput(
                "has more than {0:,} boxes, or more than {1} MB beside its pixels",
                MAX_BOXES,
                MAX_BOXES_BYTES >> 20,
            )
        file.seek(start)
        if is_last and file.read(8).strip(b"\0"):
            raise InvalidInput("has a box without an end beside its pixels")
        if not is_last:
            _check_texts(_HEADER, _chunks(file, start, end))


def _check_words(name: str, words: str) -> None:
    """Refuse a text with a coordinate reference system that names a file."""
    named = file_named(words)
    if named:
        raise InvalidInput(
            "{0}: its coordinate reference system names the file {1}, which is not opened; must be a code such as "
            "EPSG:25832, or WKT without files",
            name,
            one_line(named),
        )
    if words.lstrip().startswith("{") and "CRS" in words.upper():
        try:
            check_reference(words)
        except InvalidInput as wrong:
            raise InvalidInput("{0}: {1}", name, wrong) from wrong


def _check_texts(name: str, texts: Iterable[bytes]) -> None:
    for text in texts:
        if text.lstrip().startswith(b"{") or may_name_file(text):
            _check_words(name, text.decode("utf-8", "replace"))


def _texts(name: str, file: IO[bytes], head: bytes, size: int) -> Iterator[bytes]:
    """Yield the parts of a raster file (except databases) that may contain text of the CRS."""
    if head.startswith(_BOXES):
        for start, end in _boxes(file, size):
            yield from _chunks(file, start, end)
    elif head.startswith((b"II", b"MM")):
        yield from tag_texts(name, file, head, _TIFF_KEY_TEXTS, MAX_TIFF_TEXT_BYTES)
    # Text of the CRS may stand anywhere in RMF, too.
    elif head.startswith((*_TEXT_ANYWHERE, b"RSW", b"MTW", b"\0WSR")):
        yield from _chunks(file, 0, size)


def _chunks(file: IO[bytes], start: int, end: int) -> Iterator[bytes]:
    """Yield the bytes of a file in chunks of 4 MB that overlap by 1 kB, so that no file name is cut."""
    kept = b""
    file.seek(start)
    while start < end:
        chunk = file.read(min(1 << 22, end - start))
        if not chunk:
            return
        start += len(chunk)
        yield kept + chunk
        kept = chunk[-(1 << 10) :]


def _boxes(file: IO[bytes], size: int) -> Iterator[tuple[int, int]]:
    """Yield start and end of each box of a JPEG 2000 or JPEG XL file that may contain text."""
    at = 0
    while at < size:
        file.seek(at)
        head = file.read(16)
        if len(head) < 8:
            return
        length = int.from_bytes(head[:4], "big")
        if length == 1:
            length = int.from_bytes(head[8:], "big")
        end = at + length if length else size
        if end < at + 8:
            return
        if head[4:8] not in _PIXEL_BOXES:
            yield at, min(end, size)
        at = end


def _definitions(file: Path) -> Iterator[bytes]:
    """Yield the values in a GeoPackage's table of coordinate reference systems."""
    sqlite3: Any = importlib.import_module("sqlite3")
    until_s = time.monotonic() + MAX_QUERY_S
    try:
        with contextlib.closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as database:
            database.set_progress_handler(lambda: time.monotonic() > until_s, 10_000)
            kinds = database.execute("SELECT type FROM sqlite_master WHERE name = 'gpkg_spatial_ref_sys'")
            if any(kind != "table" for (kind,) in kinds):
                raise InvalidInput("{0}: has a view in place of its coordinate reference systems", file.name)
            for row in database.execute("SELECT * FROM gpkg_spatial_ref_sys"):
                yield from (str(value).encode("utf-8", "replace") for value in row)
    except sqlite3.Error:
        # GDAL reports errors of such a file later.
        return


def _check_source(vrt: Path, source: Path, folders: tuple[Path, ...], depth: int, seen: dict[Path, int]) -> int:
    """Check a file that a VRT reads, as `_check` does; links in ``folders`` must be resolved."""
    real = _real(source)
    if not any(_contains(real, folder) for folder in folders):
        raise InvalidInput(
            "{0} reads {1}, which is not beside it",
            vrt.name,
            source,
            remedy=Message("set {0}={1} if that is right", FOLDERS_ENV, source.parent),
        )
    if file_exists(source):
        return _check(source, folders, depth + 1, seen)
    if os.path.exists(source):  # noqa: PTH110
        # GDAL would wait for a pipe for ever, and read a folder as a product, which may name other files.
        raise InvalidInput("{0} reads {1}, which is not a regular file", vrt.name, source)
    return 0


def _real(path: Path) -> Path:
    """Resolve links; unlike `Path.resolve`, this does not raise if links form a loop."""
    return Path(os.path.realpath(path))


def _contains(path: Path, folder: Path) -> bool:
    return folder == path or folder in path.parents


def _places(vrt: Path, name: str, relative: str | None) -> Iterator[Path]:
    """Yield the files that a name in a VRT may mean: GDAL resolves it from the VRT's folder or the current one."""
    name = name.strip()
    inside = Path(name).is_absolute() and not name.startswith("/vsi")
    if "<" in name or not (inside or _ELSEWHERE.search(name) is None):
        raise InvalidInput("{0} reads {1!r}, which is not a file beside it", vrt.name, name.partition("?")[0][:80])
    if relative != "1":
        yield Path.cwd() / name
    if relative != "0":
        yield vrt.parent / name
        yield _real(vrt).parent / name


def _head(file: Path, size: int = _HEAD_BYTES) -> bytes:
    try:
        with open_foreign(file) as opened:
            return opened.read(size)
    except OSError as wrong:
        raise InvalidInput("{0}: cannot be read ({1})", file.name, wrong.strerror) from wrong


def _named(vrt: Path) -> list[tuple[str, str | None]]:
    """Names of data in a VRT, each with its ``relativeToVRT`` ("1" or "0"; None if not stated)."""
    reader = _Reader(vrt)
    _parse(vrt, reader)
    return reader.found


def _parse(file: Path, reader: _References, encoding: str = "utf-8") -> None:
    """Parse a VRT, or GDAL's XML file beside a raster, with a handler."""
    body = _head(file, MAX_VRT_BYTES + 1)
    body = body[3:] if body.startswith(codecs.BOM_UTF8) else body
    if len(body) > MAX_VRT_BYTES:
        raise InvalidInput("{0}: is a VRT of more than {1} MB", file.name, MAX_VRT_BYTES >> 20)
    expat: Any = importlib.import_module("xml.parsers.expat")
    parser = expat.ParserCreate(encoding)
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.text
    for handler in ("CommentHandler", "ProcessingInstructionHandler", "StartCdataSectionHandler"):
        setattr(parser, handler, reader.between)
    parser.StartDoctypeDeclHandler = reader.refuse
    try:
        parser.Parse(body, True)
    except expat.ExpatError as broken:
        raise InvalidInput("{0}: is a VRT that cannot be read ({1})", file.name, broken) from broken


class _References:
    """Handler for GDAL's XML that refuses coordinate reference systems that name files."""

    def __init__(self, file: Path) -> None:
        self._file = file
        self._text: list[str] = []

    def start(self, _name: str, attributes: dict[str, str]) -> None:
        self._check_text()
        for value in attributes.values():
            _check_words(self._file.name, value)

    def end(self, _name: str) -> None:
        self._check_text()

    def text(self, words: str) -> None:
        self._text.append(words)

    def between(self, *_: object) -> None:
        """Ignore comments and similar markup between texts, as GDAL does."""

    def refuse(self, *_: object) -> None:
        raise InvalidInput("{0}: has a document type, which GDAL writes none of", self._file.name)

    def _check_text(self) -> None:
        words, self._text = "".join(self._text), []
        _check_words(self._file.name, words)


class _Reader(_References):
    """Handler that collects the names of data in a VRT. Like GDAL, treat attributes as elements and ignore case."""

    def __init__(self, vrt: Path) -> None:
        super().__init__(vrt)
        self.found: list[tuple[str, str | None]] = []
        self._vrt = vrt
        self._open: list[tuple[str, dict[str, str]]] = []
        self._counts: Counter[str] = Counter()

    def start(self, name: str, attributes: dict[str, str]) -> None:
        self._take_text()
        self._count(name.lower())
        _check_reads(self._vrt, len(self.found))
        name, given = name.lower(), {one.lower(): value for one, value in attributes.items()}
        if self._is_name(self._open[-1]) if self._open else False:
            self.refuse()
        self._open.append((name, given))
        key = given.get("key", "").lower()
        # Refuse Python code for pixels; an element "key" in place of the attribute, which is checked here; and options
        # of formats, which may be file names or SQL statements.
        is_refused = name in ("pixelfunctionlanguage", "pixelfunctioncode", "key") or (
            name == "ooi" and key not in ("overview_level", "num_threads", "numthreads")
        )
        if is_refused or key == OVERVIEW_FILE.lower():
            self.refuse()
        for one, value in given.items():
            if one in _NAMING:
                self.found.append((value, None))
            elif name not in _TEXTS and one != "key" and _ELSEWHERE.search(value):
                self.refuse()

    def _count(self, name: str) -> None:
        self._counts[""] += 1
        if self._counts[""] > MAX_XML_ELEMENTS or len(self._open) >= MAX_XML_DEPTH:
            raise InvalidInput(
                "{0}: is a VRT of more than {1:,} elements, or of more than {2:,} within each other",
                self._vrt.name,
                MAX_XML_ELEMENTS,
                MAX_XML_DEPTH,
            )
        # Overviews are counted for each band.
        limits = {
            "vrtrasterband": (MAX_RASTER_BANDS, Message("bands")),
            "overview": (MAX_RASTER_OVERVIEWS, Message("overviews of a band")),
            "mdi": (MAX_RASTER_ITEMS, Message("items of metadata")),
            "gcp": (MAX_RASTER_ITEMS, Message("ground control points")),
        }
        if name not in limits:
            return
        if name == "vrtrasterband":
            self._counts["overview"] = 0
        self._counts[name] += 1
        most, what = limits[name]
        if self._counts[name] > most:
            _refuse_number(self._vrt, self._counts[name], most, what)

    def end(self, _name: str) -> None:
        self._take_text()
        self._open.pop()

    def text(self, words: str) -> None:
        self._text.append(words)

    def between(self, *_: object) -> None:
        """Refuse comments and similar markup that GDAL may treat as the end of a name."""
        if self._open and self._is_name(self._open[-1]):
            self.refuse()

    def refuse(self, *_: object) -> None:
        raise InvalidInput("{0}: is a VRT with more in it than bands of files", self._vrt.name)

    def _take_text(self) -> None:
        words, self._text = "".join(self._text).strip(), []
        if not self._open or not words:
            return
        element, given = self._open[-1]
        if self._is_name(self._open[-1]):
            self.found.append((words, given.get("relativetovrt")))
        elif element not in _TEXTS and _ELSEWHERE.search(words):
            self.refuse()

    @staticmethod
    def _is_name(element: tuple[str, dict[str, str]]) -> bool:
        name, given = element
        return name in _NAMING or (name == "mdi" and given.get("key", "").lower() in _NAMING)
