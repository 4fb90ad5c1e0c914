"""Pictures as files: GeoTIFF, or JPEG and PNG with a world file and GDAL's auxiliary file beside them."""

from __future__ import annotations

import io
import os
import zlib
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Union

import numpy as np
from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from ..errors import InvalidInput
from ..files import write_whole
from ..geodesy.mercator import wrap_lon_deg
from .control_points import ControlPoints
from .georeference import Georeference, plain_text, xml_text
from .tiff import HEADER_BYTES, Kind, Tag, directory, header

Pixels = NDArray[np.uint8]

SOFTWARE = "TerrAInav"
#: JPEG at this quality, without halving the colours' resolution, is within about a grey level of the source.
JPEG_QUALITY = 95
#: libjpeg's limit (JPEG_MAX_DIMENSION).
JPEG_LONGEST_PX = 65_500
#: Only runs are searched for: on photographs that is four times as fast as zlib's default level and smaller too,
#: as the predictor has left little else to find; drawn maps are small either way.
_ZLIB_STRATEGY = zlib.Z_RLE
_ZLIB_LEVEL = 6
#: What every JPEG ends with (ITU-T T.81, B.1.1.3).
_JPEG_END = b"\xff\xd9"
#: Bytes of pixels in a TIFF strip, so that readers of a large picture need not unpack all of it.
_STRIP_BYTES = 1 << 18
#: Denominator of the seconds of arc in EXIF positions: 3 micrometres of ground, and the numerator fits 32 bits.
_ARC_SECOND_SHARE = 10_000_000
#: Finest denominator of an EXIF altitude first; heights beyond 4,294 km keep whole metres.
_ALTITUDE_SHARES = (1000, 1)
_WITH_ALPHA = 4
#: Denominator of an EXIF heading.
_HEADING_SHARE = 1_000_000

#: Where a picture lies: a map frame by its edges, a camera frame by points.
Place = Union[Georeference, ControlPoints]
_WORLD_FILES = {"jpg": ".jgw", "png": ".pgw"}


@dataclass(frozen=True)
class Description:
    """What a picture's own metadata says about it.

    Parameters
    ----------
    name : str
        Of the picture, without ending.
    map_type : str
    source, attribution : str
        Title of the source as people see it, and the credit it asks for; without characters that files have no
        form for.
    zoom : int
    lat_deg, lon_deg, agl_m, yaw_deg, tilt_deg, roll_deg : float
        Pose of the camera; the longitude may be continuous beyond ±180.
    imagery_date : str
        Empty where the source does not say.
    effective_gsd_m_per_px : float or None
        Metres of ground that the picture tells apart, which enlarged pixels do not make smaller.
    more : tuple of (str, str)
        Names and values that are added to the metadata.
    """

    name: str
    map_type: str
    source: str
    attribution: str
    zoom: int
    lat_deg: float
    lon_deg: float
    agl_m: float
    yaw_deg: float = 0.0
    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    imagery_date: str = ""
    effective_gsd_m_per_px: float | None = None
    more: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        for field in ("source", "attribution", "imagery_date"):
            object.__setattr__(self, field, plain_text(getattr(self, field)))

    @property
    def title(self) -> str:
        """One line for people."""
        return f"{self.name} {self.map_type}, {self.source}"

    @property
    def wrapped_lon_deg(self) -> float:
        """Longitude in [-180, 180)."""
        return float(wrap_lon_deg(np.asarray(self.lon_deg)))

    def metadata(self) -> dict[str, str]:
        """Names and values as GDAL shows them, the same in every format."""
        numbers = {
            "LAT_DEG": self.lat_deg,
            "LON_DEG": self.wrapped_lon_deg,
            "AGL_M": self.agl_m,
            "YAW_DEG": self.yaw_deg,
            "TILT_DEG": self.tilt_deg,
            "ROLL_DEG": self.roll_deg,
        }
        if self.effective_gsd_m_per_px is not None:
            numbers["EFFECTIVE_GSD_M_PER_PX"] = self.effective_gsd_m_per_px
        return {
            "NAME": self.name,
            "MAP_TYPE": self.map_type,
            "SOURCE": self.source,
            "ATTRIBUTION": self.attribution,
            "ZOOM": str(self.zoom),
            **{key: repr(value) for key, value in numbers.items()},
            **({"IMAGERY_DATE": self.imagery_date} if self.imagery_date else {}),
            **dict(self.more),
        }


def file_endings(image_format: str, *, on_map: bool = True) -> tuple[str, ...]:
    """Endings of all the files of one picture, of a map frame or of a camera frame; the last is the picture's own."""
    own = f".{image_format}"
    if image_format == "tif":
        return (own,)
    world_file = (_WORLD_FILES[image_format],) if on_map else ()
    return (*world_file, f"{own}.aux.xml", own)


def check_size(image_format: str, width_px: int, height_px: int) -> None:
    """Refuse pictures that a format cannot hold.

    Raises
    ------
    InvalidInput
        A JPEG of more than 65500 px along a side.
    """
    if image_format == "jpg" and max(width_px, height_px) > JPEG_LONGEST_PX:
        raise InvalidInput(
            f"pictures of {width_px} x {height_px} px: JPEG ends at {JPEG_LONGEST_PX} px; choose tif or png, or "
            "resize them (--img-size)"
        )


def write_picture(
    folder: Path, image_format: str, pixels: Pixels, place: Place, description: Description
) -> int:
    """Write a picture and what belongs beside it, itself last: a picture that is there is complete.

    Parameters
    ----------
    folder : Path
        Where ``<name>.<ending>`` goes; must be there.
    image_format : str
        tif, jpg or png.
    pixels : array (h, w), (h, w, 3) or (h, w, 4) of uint8
        A fourth channel is 0 where the picture has nothing to show and 255 elsewhere; a JPEG leaves it out. The
        bytes written depend on the arguments alone.
    place : Georeference or ControlPoints

    Returns
    -------
    int
        Bytes of all its files together.

    Raises
    ------
    OutputError
    """
    on_map = isinstance(place, Georeference)
    if image_format == "tif":
        contents = [geotiff(pixels, place, description)]
    else:
        encode = jpeg if image_format == "jpg" else png
        contents = [place.aux_xml(description.metadata()).encode("utf-8"), encode(pixels, description)]
        if isinstance(place, Georeference):
            contents.insert(0, place.world_file().encode("ascii"))
    for ending, data in zip(file_endings(image_format, on_map=on_map), contents):
        write_whole(folder / (description.name + ending), data)
    return sum(map(len, contents))


def geotiff(pixels: Pixels, place: Place, description: Description) -> bytes:
    """A lossless GeoTIFF (OGC 19-008) with deflate and horizontal differences.

    Written here and not by Pillow, whose TIFF encoder holds Python's lock: zlib lets go of it, so that the
    pictures of one run are packed on all cores.
    """
    height, width = pixels.shape[:2]
    channels = 1 if pixels.ndim == 2 else pixels.shape[2]
    rows = max(_STRIP_BYTES // (width * channels), 1)
    strips = _packed_strips(pixels, rows)
    tags = [
        Tag(256, Kind.LONG, [width]),
        Tag(257, Kind.LONG, [height]),
        Tag(258, Kind.SHORT, [8] * channels),
        Tag(259, Kind.SHORT, [8]),  # compression: deflate
        Tag(262, Kind.SHORT, [1 if channels == 1 else 2]),  # black is zero; RGB
        Tag(270, Kind.ASCII, description.title),
        Tag(277, Kind.SHORT, [channels]),
        Tag(278, Kind.LONG, [rows]),
        Tag(279, Kind.LONG, [len(strip) for strip in strips]),
        Tag(284, Kind.SHORT, [1]),  # channels pixel by pixel
        Tag(305, Kind.ASCII, SOFTWARE),
        Tag(317, Kind.SHORT, [2]),  # horizontal differences
        Tag(33432, Kind.ASCII, description.attribution),
        *place.tags(),
        Tag(42112, Kind.ASCII, _gdal_metadata(description)),
    ]
    if channels == _WITH_ALPHA:
        tags.append(
            Tag(338, Kind.SHORT, [2])
        )  # the fourth channel is alpha, and the others are not multiplied by it
    return _with_strips(tags, strips)


def _packed_strips(pixels: Pixels, rows: int) -> list[bytes]:
    """Strips one after the other, in one piece of memory that fits the processor's cache."""
    strips = []
    differences = np.empty((min(rows, len(pixels)), *pixels.shape[1:]), np.uint8)
    for top in range(0, len(pixels), rows):
        strip = pixels[top : top + rows]
        changes = differences[: len(strip)]
        changes[:, 0] = strip[:, 0]
        np.subtract(strip[:, 1:], strip[:, :-1], out=changes[:, 1:])
        pack = zlib.compressobj(
            _ZLIB_LEVEL, zlib.DEFLATED, zlib.MAX_WBITS, zlib.DEF_MEM_LEVEL, _ZLIB_STRATEGY
        )
        strips.append(pack.compress(changes.data) + pack.flush())
    return strips


def _with_strips(tags: list[Tag], strips: list[bytes]) -> bytes:
    """File of a directory followed by its strips, whose offsets depend on the directory's own length."""

    def offsets_from(start: int) -> Tag:
        offsets = [start]
        for strip in strips[:-1]:
            offsets.append(offsets[-1] + len(strip))
        return Tag(273, Kind.LONG, offsets)

    length = len(directory([*tags, offsets_from(0)], HEADER_BYTES))
    return b"".join(
        [header(), directory([*tags, offsets_from(HEADER_BYTES + length)], HEADER_BYTES), *strips]
    )


def _gdal_metadata(description: Description) -> str:
    """XML of GDAL's own tag, whose values are escaped twice: GDAL writes them so, and undoes both."""
    items = (
        f'  <Item name="{xml_text(key)}">{xml_text(xml_text(value))}</Item>\n'
        for key, value in description.metadata().items()
    )
    return "<GDALMetadata>\n" + "".join(items) + "</GDALMetadata>\n"


def jpeg(pixels: Pixels, description: Description) -> bytes:
    """A JPEG with EXIF: who, what, and the camera's position and heading."""
    image = Image.fromarray(np.ascontiguousarray(pixels[..., :3]) if pixels.ndim > 2 else pixels)
    exif = b"Exif\0\0" + _exif(description)

    def encoded(file: BinaryIO) -> bytes:
        with file:
            image.save(file, "JPEG", quality=JPEG_QUALITY, subsampling=0, exif=exif)
            file.seek(0)
            return file.read()

    with suppress(OSError):
        data = encoded(_encoders_file())
        # Pillow does not look whether all that it writes is taken: a file that may not grow is cut short.
        if data.endswith(_JPEG_END):
            return data
    return encoded(io.BytesIO())


def _encoders_file() -> BinaryIO:
    """A file in memory, one of the operating system's where it has such.

    Pillow lets go of Python's lock only while it encodes into a file that the operating system knows.
    """
    if hasattr(os, "memfd_create"):
        return os.fdopen(os.memfd_create("terrainav"), "w+b")
    return io.BytesIO()


def _exif(description: Description) -> bytes:
    """EXIF 2.3 block; the altitude is the height above the ground, which lies at 0 m here."""
    lat, lon = description.lat_deg, description.wrapped_lon_deg
    position = [
        Tag(0, Kind.BYTE, [2, 3, 0, 0]),  # GPSVersionID
        Tag(1, Kind.ASCII, "S" if lat < 0.0 else "N"),
        Tag(2, Kind.RATIONAL, _degrees_minutes_seconds(lat)),
        Tag(3, Kind.ASCII, "W" if lon < 0.0 else "E"),
        Tag(4, Kind.RATIONAL, _degrees_minutes_seconds(lon)),
        Tag(5, Kind.BYTE, [0]),  # altitude above sea level
        Tag(6, Kind.RATIONAL, _altitude(description.agl_m)),
        Tag(16, Kind.ASCII, "T"),  # heading from true north
        Tag(17, Kind.RATIONAL, [round(description.yaw_deg % 360.0 * _HEADING_SHARE), _HEADING_SHARE]),
    ]

    def with_position_at(offset: int) -> bytes:
        tags = [
            Tag(270, Kind.ASCII, description.title),
            Tag(274, Kind.SHORT, [1]),  # orientation: as it is
            Tag(305, Kind.ASCII, SOFTWARE),
            Tag(33432, Kind.ASCII, description.attribution),
            Tag(34853, Kind.LONG, [offset]),
        ]
        return directory(tags, HEADER_BYTES)

    position_at = HEADER_BYTES + len(with_position_at(0))
    return header() + with_position_at(position_at) + directory(position, position_at)


def _degrees_minutes_seconds(angle_deg: float) -> list[int]:
    """Numerators and denominators of degrees, minutes and seconds."""
    shares = round(abs(angle_deg) * 3600 * _ARC_SECOND_SHARE)
    minutes, seconds = divmod(shares, 60 * _ARC_SECOND_SHARE)
    degrees, minutes = divmod(minutes, 60)
    return [degrees, 1, minutes, 1, seconds, _ARC_SECOND_SHARE]


def _altitude(agl_m: float) -> list[int]:
    share = next(share for share in _ALTITUDE_SHARES if round(agl_m * share) < 1 << 32 or share == 1)
    return [round(agl_m * share), share]


def png(pixels: Pixels, description: Description) -> bytes:
    """A PNG with its title, software, copyright and the metadata as text chunks."""
    info = PngImagePlugin.PngInfo()
    texts = {"Title": description.title, "Software": SOFTWARE, "Copyright": description.attribution}
    for key, value in {**texts, **description.metadata()}.items():
        info.add_text(key, value)
    buffer = io.BytesIO()
    Image.fromarray(pixels).save(
        buffer, "PNG", pnginfo=info, compress_level=_ZLIB_LEVEL, compress_type=_ZLIB_STRATEGY
    )
    return buffer.getvalue()
