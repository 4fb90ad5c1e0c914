"""The parts of a mission that say which pictures are made, and how accurately."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from ...errors import InvalidInput
from ...fields import CheckedFields, declared, field_named, is_plain
from ...limits import MAX_PICTURE_PX, MAX_PICTURE_SIDE_PX
from ...map_types import ROADMAP, SATELLITE, TERRAIN
from ...numbers import NUMBER
from ..imageries import NamedImagery, named_imageries

#: Products of labels and buildings.
LABELLED = CLASSES, INSTANCES = ("classes", "instances")
#: The product of the values of an image sensor.
RAW = "raw"
#: The cheapest frame or mesh that fits the error budget.
AUTO = "auto"
#: One ray per pixel of a camera frame instead of a mesh.
RAYS = "rays"
#: A code, or the WKT of a raster whose coordinate reference system has no code.
_CRS = r"(EPSG:[0-9]{1,7}|[A-Z][A-Z0-9_]*\[.*\])?"
_LONGEST_CRS = 20_000
_CHANNELS = (1, 3)
#: Conversions to 8 bits: a keyword, or the range of values to stretch.
_STRETCH = f"none|percentile|{NUMBER} {NUMBER}"


def _check_source(text: str) -> None:
    if not text:
        raise InvalidInput("source is empty: name one, or give a URL template or a file", field="source")
    if "\0" in text:
        raise InvalidInput("source {0!r}: holds a NUL character, which no name has", text, field="source")


def _check_date(text: str) -> None:
    if not is_plain(text):
        raise InvalidInput("date {0!r}: must be text without spaces around it, such as 2024-06-21", text, field="date")


def _check_bands(bands: tuple[Any, ...]) -> None:
    for one in bands:
        if not (one and is_plain(one)):
            raise InvalidInput("band {0!r}: must be a name or a number", one, field="bands")
    if len(set(bands)) != len(bands):
        raise InvalidInput("bands {0}: each may be named once", " ".join(bands), field="bands")


def _check_stretch(text: str) -> None:
    if re.fullmatch(_STRETCH, text):
        if text in ("none", "percentile"):
            return
        low, high = map(float, text.split())
        if low < high < math.inf and low > -math.inf:
            return
    raise InvalidInput(
        "stretch {0!r}: must be none, percentile, or two numbers, the lower one first", text, field="stretch"
    )


def _check_products(products: tuple[str, ...]) -> None:
    if len(set(products)) != len(products):
        raise InvalidInput("products {0}: each may be named once", " ".join(products), field="products")


def _check_crs(text: str) -> None:
    if len(text) > _LONGEST_CRS or not re.fullmatch(_CRS, text) or not text.isprintable():
        raise InvalidInput(
            "coordinate reference system {0!r}: must be a code such as EPSG:2056", text[:80], field="crs"
        )


def _check_map_types(map_types: tuple[str, ...]) -> None:
    if not map_types:
        known = ", ".join(field_named(Imagery, "map_types").choices)
        raise InvalidInput("no map type: give one or more of {0}", known, field="map_types")
    if len(set(map_types)) != len(map_types):
        raise InvalidInput("map types {0}: each may be named once", " ".join(map_types), field="map_types")


def _check_imageries(texts: tuple[Any, ...]) -> None:
    for one in texts:
        if not isinstance(one, str):
            raise InvalidInput("imagery {0!r}: must be text, such as 2014=world", one, field="imageries")
    named_imageries(texts)


def _check_size(size: tuple[Any, ...]) -> None:
    if len(size) != 3 or not all(isinstance(one, int) and not isinstance(one, bool) for one in size):
        raise InvalidInput(
            "image size {0}: must be three whole numbers, width, height and channels",
            str(size),
            field="img_size",
        )
    width, height, channels = size
    if width < 1 or height < 1 or channels not in _CHANNELS:
        raise InvalidInput(
            "image size {0} {1} {2}: needs a width and a height of 1 px or more, and 1 or 3 channels",
            width,
            height,
            channels,
            field="img_size",
        )
    if max(width, height) > MAX_PICTURE_SIDE_PX or width * height > MAX_PICTURE_PX:
        raise InvalidInput(
            "image size {0} x {1} px: must be at most {2:,} px along a side and {3:,} px in all",
            width,
            height,
            MAX_PICTURE_SIDE_PX,
            MAX_PICTURE_PX,
            field="img_size",
        )


@dataclass(frozen=True)
class Imagery(CheckedFields):
    """Source, kinds, date and bands of the imagery."""

    source: str = declared(
        "world",
        title="source",
        help="where the imagery comes from: a name or title (see terrainav sources), a URL template, "
        "wmts:URL#layer=NAME, wms:URL#layers=NAME, arcgis:URL, ogcapi:URL, or a file (GeoTIFF, VRT, MBTiles, …)",
        check=_check_source,
        schema={"minLength": 1},
    )
    map_types: tuple[str, ...] = declared(
        (SATELLITE,),
        title="map types",
        help="kinds of imagery, captured into one folder each",
        choices={SATELLITE: "Satellite", ROADMAP: "Roadmap", TERRAIN: "Terrain"},
        option="map_type",
        check=_check_map_types,
        schema={"minItems": 1, "uniqueItems": True},
    )
    date: str = declared(
        "",
        title="imagery date",
        help="date of the imagery in the source's own format, where it offers several",
        advanced=True,
        check=_check_date,
    )
    bands: tuple[str, ...] = declared(
        (),
        title="bands",
        help="bands of a raster file, by name or by number from 1, in the order to write them in: 4 1 2 is infrared, "
        "red and green of a file with red, green, blue and infrared; left out, GeoTIFF has all of them, and JPEG and "
        "PNG the colours",
        advanced=True,
        check=_check_bands,
        schema={"items": {"type": ["string", "integer"], "minLength": 1}, "uniqueItems": True},
    )
    stretch: str = declared(
        "none",
        title="stretch",
        help="how the values of a raster file become 8 bits: none leaves them as they are, so that JPEG and PNG need "
        "values of 8 bits; percentile stretches from the 2nd to the 98th percentile of the file; two numbers stretch "
        "from the first to the second",
        advanced=True,
        check=_check_stretch,
        schema={"pattern": _STRETCH},
    )
    crs: str = declared(
        "",
        title="coordinate reference system",
        help="system of the images, such as EPSG:2056: one in which the source has pixels, or EPSG:3857 for those of "
        "the Web-Mercator map; left out, the source's own, or the map's where a service has both",
        advanced=True,
        check=_check_crs,
        schema={"pattern": f"^{_CRS}$", "maxLength": _LONGEST_CRS},
    )
    imageries: tuple[str, ...] = declared(
        (),
        title="imageries",
        help="several imageries side by side, instead of a source, its date and map types: NAME=SOURCE, "
        "NAME=SOURCE@DATE or NAME=SOURCE:MAP_TYPE, each captured over the same ground into a folder NAME; without "
        "NAME=, the name is made from the source",
        option="imagery",
        advanced=True,
        check=_check_imageries,
        schema={"items": {"type": "string", "minLength": 1}, "uniqueItems": True},
    )
    seed: int = declared(
        2024,
        title="seed",
        help="seed of everything random, such as the synthetic landscape and gusts of wind",
        advanced=True,
    )

    def __post_init__(self) -> None:
        """Check every field; store bands given as numbers as text."""
        given: Any = self.bands
        if isinstance(given, (tuple, list)):
            object.__setattr__(self, "bands", tuple(str(one) if type(one) is int else one for one in given))
        super().__post_init__()
        others = (self.source, self.date, self.map_types)
        if self.imageries and others != (Imagery.source, Imagery.date, Imagery.map_types):
            raise InvalidInput(
                "imagery {0}, and source {1} {2} {3} as well: must be one of the two",
                self.imageries[0],
                self.source,
                self.date,
                " ".join(self.map_types),
                field="imageries",
            )

    @property
    def named(self) -> tuple[NamedImagery, ...]:
        """The named imageries; empty for one source."""
        return named_imageries(self.imageries)


@dataclass(frozen=True)
class Pixels(CheckedFields):
    """Resolution and size of the images."""

    image_px: int = declared(
        640,
        title="image's longer side",
        label="image's lo&nger side",
        help="pixels along the longer side of the camera's image; the zoom closest to its GSD is used; a named "
        "camera sets it",
        unit="px",
        least=1,
        advanced=True,
    )
    zoom: int | None = declared(
        None,
        title="zoom",
        help="zoom of the source, instead of the one closest to the camera's GSD",
        least=0,
        suggested=18,
        advanced=True,
    )
    gsd_m_per_px: float | None = declared(
        None,
        title="ground sample distance",
        help="ground sample distance (GSD) wanted of the source; the closest zoom is used",
        unit="m",
        above=0.0,
        option="gsd",
        suggested=0.5,
        advanced=True,
    )
    max_px: int | None = declared(
        None,
        title="maximum image side",
        help="limit of every image's longer side, in pixels of 256 px tiles: where an image would exceed it, "
        "all take a lower zoom; without it there is no limit, or 640 in the layout paper",
        unit="px",
        least=1,
        advanced=True,
    )
    upsample: bool = declared(
        False,
        title="allow upsampling",
        help="also use zooms above the source's native one: images get more pixels, but no more detail",
        advanced=True,
    )

    def __post_init__(self) -> None:
        """Check every field; refuse a zoom beside a ground sample distance."""
        super().__post_init__()
        if self.zoom is not None and self.gsd_m_per_px is not None:
            raise InvalidInput(
                "zoom {0} and ground sample distance {1} m: give one of the two",
                self.zoom,
                self.gsd_m_per_px,
                field="zoom",
            )


@dataclass(frozen=True)
class Accuracy(CheckedFields):
    """Error budget, and the methods that make images."""

    error_budget_px: float = declared(
        0.1,
        title="error budget",
        help="maximum sum of the error bounds of all stages, in pixels of the planned image; the cheapest "
        "methods within it are used",
        unit="px",
        option="error_budget",
        above=0.0,
        advanced=True,
    )
    accept_error: bool = declared(
        False,
        title="allow exceeding the error budget",
        help="use the most accurate methods where none stay within the error budget, instead of refusing the mission",
        advanced=True,
    )
    frame: str = declared(
        AUTO,
        title="frame",
        help="map: a window of the source's own pixels, turned by multiples of 90° only, for cameras that look "
        "straight down; camera: the image as the camera sees it; auto: a map frame where its error fits the budget",
        choices={AUTO: "Automatic", "map": "Map frame (not resampled)", "camera": "Camera frame (as seen)"},
        advanced=True,
    )
    mesh: str = declared(
        AUTO,
        title="mesh",
        help="ground under a camera frame: auto is a mesh as coarse as the error budget allows, rays traces one ray "
        "per pixel",
        choices={AUTO: "Automatic", RAYS: "One ray per pixel"},
        advanced=True,
    )
    resampling: str = declared(
        "bilinear",
        title="resampling",
        help="how camera frames interpolate between the source's pixels; map frames are not resampled",
        choices={
            "nearest": "Nearest pixel",
            "bilinear": "Bilinear",
            "bicubic": "Bicubic",
            "lanczos": "Lanczos",
        },
        advanced=True,
    )


@dataclass(frozen=True)
class Output(CheckedFields):
    """Files that a capture writes."""

    image_format: str = declared(
        "tif",
        title="image format",
        help="format of the image files, all of which are georeferenced; tif and png are lossless",
        choices={"tif": "GeoTIFF (lossless)", "jpg": "JPEG (smaller)", "png": "PNG"},
        option="format",
    )
    img_size: tuple[int, int, int] | None = declared(
        None,
        title="image size",
        help="resize images: width, height, channels (1 or 3)",
        advanced=True,
        check=_check_size,
        schema={
            "prefixItems": [
                *2 * [{"type": "integer", "minimum": 1, "maximum": MAX_PICTURE_SIDE_PX}],
                {"enum": list(_CHANNELS)},
            ],
            "items": False,
            "minItems": 3,
        },
    )
    products: tuple[str, ...] = declared(
        (),
        title="products",
        help="files with a value for every pixel, written beside the images: depth along the optical axis, ground "
        "points, normals, the mask of faces that no map shows, and the class and instance of labels and buildings; of "
        "all map types together; raw holds the values of an image sensor before demosaicing and development",
        choices={
            "depth": "Depth along the optical axis",
            "points": "Ground points",
            "normals": "Normals of the ground",
            "facades": "Faces that no map shows",
            CLASSES: "Classes of labels and buildings",
            INSTANCES: "Instances of labels and buildings",
            RAW: "Raw values of the image sensor",
        },
        advanced=True,
        check=_check_products,
        schema={"uniqueItems": True},
    )
    max_images: int = declared(
        10_000_000,
        title="maximum number of images",
        help="missions with more images are refused",
        least=1,
        advanced=True,
    )
