"""The parts of a mission whose fields are plain values, each declared once; without numpy, so that help is quick."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput, Message, OptionName
from ..fields import CheckedFields, declared, field_named
from ..geodesy.vertical import check_vertical
from ..limits import MAX_PICTURE_PX, MAX_PICTURE_SIDE_PX
from ..map_types import ROADMAP, SATELLITE, TERRAIN
from ..text.ranges import RANGES, count, ranges_text, read_ranges
from .imageries import NamedImagery, named_imageries

if TYPE_CHECKING:
    from datetime import datetime

#: Orders of rows: flown to and fro, or all in the same direction.
SERPENTINE, ONE_WAY = "serpentine", "one-way"
#: Directions of the images' top edge: north, or the flight direction of each row.
NORTH, TRACK = "north", "track"
#: Ways to align rows with their area.
ALIGNMENTS = LONGEST_SIDE, SHORTEST = ("longest-side", "shortest")
#: Azimuth of rows along parallels.
EASTWARD_DEG = 90.0
#: Layouts: rows without gaps, or the UTM grid of the published paper.
COVER, PAPER = "cover", "paper"
#: The cheapest frame or mesh that fits the error budget.
AUTO = "auto"
#: One ray per pixel of a camera frame instead of a mesh.
RAYS = "rays"
#: Greatest height above ground, metres: up to it, float64 resolves the ground to less than a micrometre.
HIGHEST_AGL_M = 1e9
#: Heights of the ground, metres: the deepest ocean trench and Everest, with room for the geoid.
LOWEST_GROUND_M, HIGHEST_GROUND_M = -12_000.0, 9_000.0
#: References of the heights of captures.
GROUND, TAKEOFF, ELLIPSOID = "ground", "takeoff", "ellipsoid"
#: Entry into the rows as they are laid out.
FIRST = "first"
#: Entry into the rows at the corner nearest to the take-off.
NEAREST = "nearest"
#: Entries into the rows at a compass corner, with its direction (east, north).
COMPASS_CORNERS = {"north-west": (-1, 1), "north-east": (1, 1), "south-east": (1, -1), "south-west": (-1, -1)}
#: Trigger of the camera at each waypoint, flown through.
BY_WAYPOINT = "waypoint"
#: Trigger of the camera by the distance flown along a row.
BY_DISTANCE = "distance"
#: Trigger of the camera at each waypoint, with a stop.
HOVER = "hover"
#: The drones that are flown with DJI Fly, as target of a file for DJI's programs.
DJI_FLY = "dji-fly"
#: Limit of the sorties of a flight; more indicate an input error.
MOST_SORTIES = 999
#: Treatments of holes in the first source of heights.
FILL, INTERPOLATE, REFUSE = "fill", "interpolate", "refuse"
#: UTC in ISO 8601, to the second or with up to six decimals.
_UTC = r"[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}(\.[0-9]{1,6})?Z"
#: A code, or the WKT of a raster whose coordinate reference system has no code.
_CRS = r"(EPSG:[0-9]{1,7}|[A-Z][A-Z0-9_]*\[.*\])?"
_LONGEST_CRS = 20_000
_CHANNELS = (1, 3)
_NUMBER = r"-?[0-9]+(\.[0-9]*)?([eE][-+]?[0-9]+)?"
#: Conversions to 8 bits: a keyword, or the range of values to stretch.
_STRETCH = f"none|percentile|{_NUMBER} {_NUMBER}"


def utc_time(text: str) -> datetime:
    """Parse an ISO 8601 text in UTC, such as 2024-06-21T10:30:00Z, as a time in the zone UTC.

    Raises
    ------
    InvalidInput
        Another format, or an impossible date or time.
    """
    from datetime import datetime, timezone

    if re.fullmatch(_UTC, text):
        form = "%Y-%m-%dT%H:%M:%S.%fZ" if "." in text else "%Y-%m-%dT%H:%M:%SZ"
        try:
            return datetime.strptime(text, form).replace(tzinfo=timezone.utc)
        except ValueError as wrong:
            raise InvalidInput("start {0!r}: no such time ({1})", text, wrong, field="start") from wrong
    raise InvalidInput("start {0!r}: must be UTC as 2024-06-21T10:30:00Z", text, field="start")


def _check_start(text: str) -> None:
    utc_time(text)


def _check_facing(text: str) -> None:
    if text in (NORTH, TRACK):
        return
    if re.fullmatch(_NUMBER, text) and abs(float(text)) <= 360.0:
        return
    raise InvalidInput(
        "camera faces {0!r}: must be {1}, {2} or an azimuth from -360 to 360",
        text,
        NORTH,
        TRACK,
        field="facing",
    )


def _check_skip_rows(text: str) -> None:
    try:
        read_ranges(text)
    except ValueError as wrong:
        raise InvalidInput(
            "skipped rows {0!r}: must be numbers and ranges such as 3,7-9", text, field="skip_rows"
        ) from wrong


def _check_split_after(text: str) -> None:
    try:
        found = read_ranges(text)
    except ValueError as wrong:
        raise InvalidInput(
            "split after {0!r}: must be numbers of images such as 120,340", text, field="split_after"
        ) from wrong
    splits = count(found)
    if splits >= MOST_SORTIES:
        raise InvalidInput(
            "split after {0:,} images: a flight has at most {1:,} sorties", splits, MOST_SORTIES, field="split_after"
        )


def _check_source(text: str) -> None:
    if not text:
        raise InvalidInput("source is empty: name one, or give a URL template or a file", field="source")
    if "\0" in text:
        raise InvalidInput("source {0!r}: holds a NUL character, which no name has", text, field="source")


def _check_date(text: str) -> None:
    if text != text.strip() or not text.isprintable():
        raise InvalidInput("date {0!r}: must be text without spaces around it, such as 2024-06-21", text, field="date")


def _check_bands(bands: tuple[Any, ...]) -> None:
    for one in bands:
        if not isinstance(one, str) or not one or one != one.strip() or not one.isprintable():
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


def _check_heights(sources: tuple[Any, ...]) -> None:
    for one in sources:
        if not isinstance(one, str) or not one or one != one.strip() or not one.isprintable():
            raise InvalidInput("heights {0!r}: must be a file, terrarium, world or a number", one, field="elevation")


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


def _check_takeoff(place: tuple[Any, ...] | None) -> None:
    if place is None:
        return
    is_pair = len(place) == 2 and all(type(one) in (int, float) for one in place)
    if not (is_pair and abs(place[0]) <= 90.0 and abs(place[1]) <= 360.0):
        raise InvalidInput(
            "take-off {0}: must be a latitude from -90 to 90 and a longitude from -360 to 360 degrees",
            " ".join(map(str, place)),
            field="takeoff",
        )


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
class Attitude(CheckedFields):
    """Attitude of the camera: yaw, then tilt, then roll, as in `Camera.rays_enu`."""

    yaw_deg: float = declared(
        0.0,
        title="yaw",
        help="direction of the image's top edge, clockwise from north, or from grid north of the source's CRS; "
        "images turn with rotated rows, and points may state other yaws",
        unit="deg",
        option="yaw",
        least=-360.0,
        most=360.0,
        advanced=True,
    )
    tilt_deg: float = declared(
        0.0,
        title="tilt",
        help="how far the view is lifted from straight down towards the image's top edge; 90 looks level",
        unit="deg",
        option="tilt",
        least=-180.0,
        most=180.0,
        advanced=True,
    )
    roll_deg: float = declared(
        0.0,
        title="roll",
        help="how far the camera is turned last, after yaw and tilt, about where the image's top edge points: right "
        "side down",
        unit="deg",
        option="roll",
        least=-180.0,
        most=180.0,
        advanced=True,
    )
    random_yaw: bool = declared(
        False,
        title="random yaw",
        help="each image of an area has a yaw at random, by the seed, and rows are as close as that takes; not for "
        "tilted cameras, nor for points, which state their yaws",
        advanced=True,
    )


@dataclass(frozen=True)
class Flight(CheckedFields):
    """How an area is flown: heights, overlaps, rows, speed and time."""

    agl_m: float = declared(
        title="height above ground",
        label="height above gro&und",
        help="height of the captures above ground (AGL); coordinates and points may state other heights",
        unit="m",
        option="agl",
        above=0.0,
        most=HIGHEST_AGL_M,
        suggested=120.0,
    )
    ground_height_m: float = declared(
        0.0,
        title="ground height",
        help="height of the ground above the WGS84 ellipsoid",
        unit="m",
        option="ground_height",
        least=LOWEST_GROUND_M,
        most=HIGHEST_GROUND_M,
        advanced=True,
    )
    overlap_along: float = declared(
        0.0,
        title="front overlap",
        help="share of an image that the next one in its row also shows",
        unit="share",
        least=0.0,
        below=1.0,
        option="overlap",
    )
    overlap_across: float = declared(
        0.0,
        title="side overlap",
        help="share of an image that the next row also shows",
        unit="share",
        least=0.0,
        below=1.0,
        option="overlap",
    )
    layout: str = declared(
        COVER,
        title="layout",
        label="la&yout",
        help="cover: rows without gaps; paper: the UTM grid of the published paper",
        choices={COVER: "Cover (no gaps)", PAPER: "Paper (UTM grid)"},
    )
    row_azimuth_deg: float = declared(
        EASTWARD_DEG,
        title="row azimuth",
        help="direction of an area's rows, clockwise from north: 90 flies them east; not for points",
        unit="deg",
        option="row_azimuth",
        least=0.0,
        most=360.0,
    )
    facing: str = declared(
        NORTH,
        title="camera faces",
        help="direction of the top of the images, to which the yaw is added: north, which turns with rotated rows; "
        "track, the flight direction of each row; or an azimuth in degrees, the same for all images",
        check=_check_facing,
        schema={"pattern": f"^({NORTH}|{TRACK}|{_NUMBER})$"},
    )
    crosshatch: bool = declared(
        False,
        title="crosshatch",
        help="fly the area a second time, in rows across the first: about twice as many images",
    )
    order: str = declared(
        SERPENTINE,
        title="order of rows",
        help="serpentine: every other row is flown back; one-way: every row is flown from its beginning",
        choices={SERPENTINE: "Serpentine (to and fro)", ONE_WAY: "One way"},
    )
    margin_m: float = declared(
        0.0,
        title="margin",
        help="width of the ground around an area that is also covered; not for points",
        unit="m",
        option="margin",
        least=0.0,
        most=100_000.0,
    )
    airspeed_m_per_s: float = declared(
        15.0,
        title="airspeed",
        help="speed of the flight through the air",
        unit="m/s",
        option="airspeed",
        # From hovering drift to the speed of sound, where the wind model holds.
        least=0.1,
        most=340.0,
        advanced=True,
    )
    start: str = declared(
        "2000-01-01T00:00:00Z",
        title="start",
        help="capture time of the first image, in UTC as 2024-06-21T10:30:00Z; the clock of the simulated "
        "flight starts then",
        advanced=True,
        check=_check_start,
        schema={"pattern": f"^{_UTC}$"},
    )
    skip_rows: str = declared(
        "",
        title="skipped rows",
        help="rows of an area that are not flown, by their numbers in the names of images, such as 3,7-9: the other "
        "images keep their names; not for points",
        advanced=True,
        check=_check_skip_rows,
        schema={"pattern": f"^{RANGES}$"},
    )

    def __post_init__(self) -> None:
        """Check every field; store a ``facing`` given as a number as text, and equal sets of rows as equal texts."""
        given: Any = self.facing
        if isinstance(given, (int, float)) and not isinstance(given, bool):
            object.__setattr__(self, "facing", f"{given:.15g}")
        super().__post_init__()
        object.__setattr__(self, "skip_rows", ranges_text(read_ranges(self.skip_rows)))

    @property
    def faced_deg(self) -> float | None:
        """Azimuth that the yaw counts from; None where it counts from the track of each row."""
        return None if self.facing == TRACK else 0.0 if self.facing == NORTH else float(self.facing)

    @property
    def alternates_facing(self) -> bool:
        """Whether cameras of every other row face the opposite direction."""
        return self.facing == TRACK and self.order == SERPENTINE


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
class Terrain(CheckedFields):
    """Relief of the ground, and the flight above it."""

    elevation: tuple[str, ...] = declared(
        (),
        title="elevation",
        help="where heights of the ground come from: raster files, terrarium (public tiles), terrarium:SOURCE or "
        "terrain-rgb:SOURCE (tiles so encoded), world, or a number; of several the first that has a height counts; "
        "left out, the ground is level",
        check=_check_heights,
        schema={"items": {"type": "string", "minLength": 1}},
    )
    surface: tuple[str, ...] = declared(
        (),
        title="surface",
        help="heights of what cameras see, with buildings and trees, if that differs from the elevation, which the "
        "flight follows; given like the elevation, which fills its gaps",
        advanced=True,
        check=_check_heights,
        schema={"items": {"type": "string", "minLength": 1}},
    )
    vertical_datum: str = declared(
        "",
        title="vertical datum",
        help="reference of the heights: ellipsoid, EGM96, EGM2008, or the code of a vertical system such as "
        "EPSG:5773; by default the one that the source states, otherwise the ellipsoid",
        advanced=True,
        check=check_vertical,
        schema={"pattern": "^[^\\s]*$"},
    )
    height_unit: str = declared(
        "",
        title="height unit",
        help="unit of the sources of heights; by default the one that they state, otherwise metres",
        choices={"": "As the source says", "m": "Metres", "ft": "Feet", "us-ft": "US survey feet"},
        advanced=True,
    )
    height_offset_m: float = declared(
        0.0,
        title="height offset",
        help="added to the heights of all sources, for example for a datum whose grid is missing",
        unit="m",
        option="height_offset",
        least=-1000.0,
        most=1000.0,
        advanced=True,
    )
    holes: str = declared(
        FILL,
        title="missing heights",
        help="treatment of places in the area where the first source of heights has none: filled from the next source "
        "that has one, and counted; or also interpolated where no source has one, from heights within 100 pixels on "
        "all sides; or refused",
        choices={
            FILL: "Filled from the next source",
            INTERPOLATE: "Interpolated where no source has any",
            REFUSE: "Refused",
        },
        advanced=True,
    )
    height_above: str = declared(
        GROUND,
        title="height above",
        help="over relief, reference of the heights of captures: the ground below each one; the ground at the take-"
        "off (an area's north-western corner, or the first point), for one height of all; or the ellipsoid",
        choices={GROUND: "The ground below", TAKEOFF: "The take-off", ELLIPSOID: "The ellipsoid"},
        advanced=True,
    )
    climb_m_per_s: float | None = declared(
        None,
        title="climb rate",
        help="over relief, maximum rate of climb and descent: the flight is higher where the ground is steeper",
        unit="m/s",
        option="climb",
        above=0.0,
        suggested=3.0,
        advanced=True,
    )
    height_tolerance_m: float = declared(
        0.0,
        title="height tolerance",
        help="over relief, with the trigger by distance, how far flights in files for drones may be above or below the "
        "planned ones, so that rows need fewer waypoints; 0 keeps them no lower than planned, and hardly higher",
        unit="m",
        option="height_tolerance",
        least=0.0,
        most=1000.0,
        advanced=True,
    )
    clearance_m: float = declared(
        0.0,
        title="clearance",
        help="over relief, minimum height above everything within the clearance distance",
        unit="m",
        option="clearance",
        least=0.0,
        most=HIGHEST_GROUND_M,
        advanced=True,
    )
    clearance_distance_m: float = declared(
        0.0,
        title="clearance distance",
        help="radius around each capture within which the clearance is kept",
        unit="m",
        option="clearance_distance",
        least=0.0,
        most=10_000.0,
        advanced=True,
    )

    def __post_init__(self) -> None:
        """Check every field; refuse a surface without an elevation."""
        super().__post_init__()
        if self.surface and not self.elevation:
            raise InvalidInput(
                "surface {0}: needs an elevation as well, the ground that the flight follows",
                ", ".join(self.surface),
                field="surface",
                remedy=Message("name it as the elevation{0}", OptionName("elevation").in_brackets),
            )


@dataclass(frozen=True)
class Route(CheckedFields):
    """The way to, between and from the rows, and the trigger of the camera."""

    takeoff: tuple[float, float] | None = declared(
        None,
        title="take-off",
        help="latitude and longitude where the flight begins and ends; left out, it goes from the first capture to the "
        "last",
        check=_check_takeoff,
        schema={
            "prefixItems": [
                {"type": "number", "minimum": -90, "maximum": 90},
                {"type": "number", "minimum": -360, "maximum": 360},
            ],
            "items": False,
            "minItems": 2,
        },
        advanced=True,
    )
    entry: str = declared(
        FIRST,
        title="entry",
        help="corner of the rows where the flight begins; for rotated rows the corner nearest to that direction. "
        "first: as the rows are laid out; nearest: the corner nearest to the take-off. Points keep their order",
        choices={
            FIRST: "As laid out",
            "north-west": "North-west",
            "north-east": "North-east",
            "south-east": "South-east",
            "south-west": "South-west",
            NEAREST: "Nearest to take-off",
        },
        advanced=True,
    )
    turnaround_m: float = declared(
        0.0,
        title="turnaround",
        help="distance flown beyond the end of each row before the turn",
        unit="m",
        option="turnaround",
        least=0.0,
        most=10_000.0,
        advanced=True,
    )
    lead_in_m: float = declared(
        0.0,
        title="lead-in",
        help="distance flown on the line of each row before its first capture",
        unit="m",
        option="lead_in",
        least=0.0,
        most=10_000.0,
        advanced=True,
    )
    trigger: str = declared(
        BY_WAYPOINT,
        title="trigger",
        help="waypoint: an image at each waypoint, flown through; distance: the camera is released by the distance "
        "flown along each row; hover: the aircraft stops at each waypoint",
        choices={
            BY_WAYPOINT: "At each waypoint",
            BY_DISTANCE: "By distance along rows",
            HOVER: "Hover and capture",
        },
        advanced=True,
    )
    photo_interval_s: float | None = declared(
        None,
        title="minimum image interval",
        help="shortest time between two images that the camera can sustain",
        unit="s",
        option="photo_interval",
        above=0.0,
        suggested=1.0,
        advanced=True,
    )
    exposure_ms: float | None = declared(
        None,
        title="exposure time",
        help="time that the shutter is open; with the motion blur it limits the speed of the flight, and does not blur "
        "the images",
        unit="ms",
        above=0.0,
        most=10_000.0,
        suggested=1.0,
        advanced=True,
    )
    blur_px: float = declared(
        0.5,
        title="motion blur",
        help="greatest motion of the ground in an image during the exposure time, straight below the camera",
        unit="px",
        above=0.0,
        most=1000.0,
        advanced=True,
    )
    drone: str = declared(
        "mavic-3e",
        title="drone",
        help="drone for DJI files (.kmz); M300 and M350 with the camera P1; dji-fly for drones that use DJI Fly, "
        "such as Mini 4 Pro, Air 3 and Mavic 3",
        choices={
            "mavic-3e": "Mavic 3E",
            "mavic-3t": "Mavic 3T",
            "mavic-3m": "Mavic 3M",
            "m30": "M30",
            "m30t": "M30T",
            "m300": "M300 RTK (P1)",
            "m350": "M350 RTK (P1)",
            "m4e": "M4E",
            "m4t": "M4T",
            DJI_FLY: "DJI Fly (Mini 4 Pro, Air 3, Mavic 3)",
        },
        advanced=True,
    )
    battery_min: float | None = declared(
        None,
        title="battery",
        help="flight time of one battery, without the reserve: the flight is split into sorties that begin and end "
        "at the take-off",
        unit="min",
        option="battery",
        above=0.0,
        suggested=20.0,
        advanced=True,
    )
    split_after: str = declared(
        "",
        title="split after",
        help="numbers of images in flight order, from 1, after which the aircraft lands at the take-off and a new "
        "sortie begins, such as 120,340; each part is split further where the battery requires it",
        advanced=True,
        check=_check_split_after,
        schema={"pattern": f"^{RANGES}$"},
    )

    def __post_init__(self) -> None:
        """Check every field; refuse values that need a take-off point without one."""
        super().__post_init__()
        object.__setattr__(self, "split_after", ranges_text(read_ranges(self.split_after)))
        if self.takeoff is not None:
            object.__setattr__(self, "takeoff", tuple(map(float, self.takeoff)))
        remedy = Message("set a take-off point{0}", OptionName("takeoff").in_brackets)
        if self.takeoff is None and self.entry == NEAREST:
            raise InvalidInput("entry nearest: needs a take-off point to be near to", field="entry", remedy=remedy)
        if self.takeoff is None and self.battery_min is not None:
            raise InvalidInput(
                "battery of {0:g} min: needs a take-off point, where each sortie begins and ends",
                self.battery_min,
                field="battery_min",
                remedy=remedy,
            )
        if self.takeoff is None and self.split_after:
            raise InvalidInput(
                "split after image {0}: needs a take-off point, where each sortie begins and ends",
                self.split_after,
                field="split_after",
                remedy=remedy,
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
        "points, normals of the ground, and the mask of faces that no map shows; of all map types together",
        choices={
            "depth": "Depth along the optical axis",
            "points": "Ground points",
            "normals": "Normals of the ground",
            "facades": "Faces that no map shows",
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


#: Parts whose fields a mission takes by name; no two parts share a name.
FLAT_PARTS: dict[str, type[CheckedFields]] = {
    "attitude": Attitude,
    "flight": Flight,
    "imagery": Imagery,
    "pixels": Pixels,
    "accuracy": Accuracy,
    "terrain": Terrain,
    "route": Route,
    "output": Output,
}
