"""Options of a mission: names, kinds, defaults, what they choose among, and what help says of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable

from ..errors import InvalidInput

FEET_IN_METRES = 0.3048
UNITS = {"m": 1.0, "ft": FEET_IN_METRES}
KINDS = ("single", "list", "raster")
MAP_TYPES = ("satellite", "roadmap", "terrain")
LAYOUTS = ("cover", "paper")
#: Whether rows are flown to and fro, or each from its beginning.
SERPENTINE, ONE_WAY = ORDERS = ("serpentine", "one-way")
FORMATS = ("tif", "jpg", "png")
#: How a camera frame takes its pixels from the source's.
RESAMPLINGS = ("nearest", "bilinear", "bicubic", "lanczos")
AUTO = "auto"
#: Kinds of pictures, from cheap to exact.
FRAMES = ("map", "camera")
#: A ray for every pixel of a camera frame, in place of a mesh that is as coarse as the error budget allows.
RAYS = "rays"
#: What the sum of the stages' errors may be where nothing else is said, px.
DEFAULT_BUDGET_PX = 0.1
#: Pixels along the longer side of a camera's image where nothing else is known of the camera.
DEFAULT_IMAGE_PX = 640
#: Longest side of a picture in the paper's layout where no other limit is given.
PAPER_MAX_PX = 640
DEFAULT_MAX_IMAGES = 10_000_000
DEFAULT_AIRSPEED_M_PER_S = 15.0
#: The flight's clock starts here where nothing else is said.
DEFAULT_START = "2000-01-01T00:00:00Z"


@dataclass(frozen=True)
class Option:
    """One option: its name (with underscores), the type and number of its values, default and help.

    ``count`` is None for one value, a range of allowed counts otherwise; ``flag`` options take none.
    """

    name: str
    kind: Callable[[str], Any]
    default: Any
    help: str
    count: tuple[int, int] | None = None
    choices: tuple[str, ...] | None = None
    metavar: str | tuple[str, ...] | None = None
    flag: bool = False

    def read(self, value: Any, where: str) -> Any:
        """Value of the right type from text, or from JSON, or as the command line split it.

        Raises
        ------
        InvalidInput
            Names where it was given, the value and what would be right.
        """
        if self.flag:
            return _truth(value, f"{where} {self.name}")
        parts = value.split() if isinstance(value, str) and self.count else value
        parts = list(parts) if isinstance(parts, (list, tuple)) else [parts]
        low, high = self.count or (1, 1)
        if not low <= len(parts) <= high:
            wanted = str(low) if low == high else f"{low} to {high}"
            raise InvalidInput(
                "{0} {1} {2!r}: takes {3} value{4}", where, self.name, value, wanted, "s" * (high > 1)
            )
        values = tuple(self._one(part, where) for part in parts)
        return values if self.count else values[0]

    def _one(self, part: Any, where: str) -> Any:
        try:
            value = self.kind(part) if isinstance(part, str) else self.kind(str(part))
        except ValueError as wrong:
            raise InvalidInput(
                "{0} {1} {2!r}: must be a {3}", where, self.name, part, _NAMES[self.kind]
            ) from wrong
        if self.choices and value not in self.choices:
            raise InvalidInput(
                "{0} {1} {2!r}: must be one of {3}", where, self.name, part, ", ".join(self.choices)
            )
        return value


_NAMES: dict[Callable[[str], Any], str] = {float: "number", int: "whole number", str: "text"}


def _truth(value: Any, what: str) -> bool:
    if isinstance(value, bool):
        return value
    words = {
        "1": True,
        "true": True,
        "yes": True,
        "on": True,
        "0": False,
        "false": False,
        "no": False,
        "off": False,
    }
    if str(value).lower() not in words:
        raise InvalidInput("{0} {1!r}: must be true or false", what, value)
    return words[str(value).lower()]


#: Every option a mission is made from, in the order help shows them.
OPTIONS: tuple[Option, ...] = (
    Option(
        "coords", str, None, "lat_lon_agl, latTL_lonTL_latBR_lonBR_agl, or a file of lat lon agl [yaw] lines"
    ),
    Option("area", str, None, "GeoJSON file of a polygon, with --agl, instead of --coords", metavar="FILE"),
    Option(
        "agl", float, None, "height above ground of --area; elsewhere it replaces the coordinates' height"
    ),
    Option("agl_unit", str, "m", "unit of the heights given", choices=tuple(UNITS)),
    Option("mission", str, None, "kind of mission; inferred from the coordinates if left out", choices=KINDS),
    Option("camera", str, None, "camera by name (see terrainav cameras) instead of --fov and --aspect-ratio"),
    Option("fov", float, None, "diagonal field of view in degrees (78.8)"),
    Option("hfov", float, None, "horizontal field of view in degrees, instead of --fov"),
    Option("vfov", float, None, "vertical field of view in degrees, instead of --fov"),
    Option(
        "sensor",
        float,
        None,
        "width and height of the sensor in mm, with --focal-length, instead of --fov",
        count=(2, 2),
        metavar=("W", "H"),
    ),
    Option("focal_length", float, None, "focal length of the lens itself in mm, with --sensor"),
    Option(
        "aspect_ratio", float, None, "width and height of the picture (4 3)", count=(2, 2), metavar=("W", "H")
    ),
    Option("yaw", float, 0.0, "degrees the top of the picture is turned clockwise from north"),
    Option(
        "tilt", float, 0.0, "degrees the view is lifted from straight down towards the top of the picture"
    ),
    Option("roll", float, 0.0, "degrees the camera is rolled, right side down"),
    Option("ground_height", float, 0.0, "height of the ground over the WGS84 ellipsoid in metres"),
    Option(
        "overlap",
        float,
        (0.0,),
        "share of a picture the next one shows again, in [0, 1): for both directions, or along and across rows",
        count=(1, 2),
        metavar=("ALONG", "ACROSS"),
    ),
    Option(
        "layout", str, "cover", "cover leaves nothing out; paper is the published UTM grid", choices=LAYOUTS
    ),
    Option(
        "grid_angle",
        float,
        0.0,
        "degrees the rows of an area, and the pictures with them, are turned clockwise from east",
    ),
    Option("crosshatch", str, False, "fly an area a second time, in rows across the first ones", flag=True),
    Option("order", str, ORDERS[0], "rows to and fro, or each from its beginning", choices=ORDERS),
    Option(
        "map_type", str, ("satellite",), "one or more of " + ", ".join(MAP_TYPES), count=(1, len(MAP_TYPES))
    ),
    Option(
        "source",
        str,
        "world",
        "source of imagery: a name (see terrainav sources), a URL template, wmts:URL#layer=NAME, wms:URL#layers=NAME, "
        "or a file (GeoTIFF, VRT, MBTiles, …)",
    ),
    Option(
        "date",
        str,
        None,
        "date of the imagery where the source has several (see terrainav sources show NAME)",
    ),
    Option(
        "image_px",
        int,
        None,
        "pixels along the longer side of the camera's image (a camera by name has its own, others 640)",
    ),
    Option("zoom", int, None, "zoom to use, instead of the one whose pixels come nearest to the camera's"),
    Option("gsd", float, None, "wanted ground sample distance in metres per pixel, instead of --zoom"),
    Option(
        "max_px",
        int,
        None,
        "limit of a picture's longest side in pixels of 256 px tiles, for which a lower zoom is taken (none, 640 with "
        "--layout paper)",
    ),
    Option("upsample", str, False, "allow zooms above the source's native one", flag=True),
    Option("format", str, "tif", "of the pictures: tif and png are lossless", choices=FORMATS),
    Option(
        "img_size",
        int,
        None,
        "resize pictures: width, height, channels (1 or 3)",
        count=(3, 3),
        metavar=("W", "H", "C"),
    ),
    Option(
        "error_budget",
        float,
        DEFAULT_BUDGET_PX,
        "most pixels the errors of all stages may sum to, by their bounds",
    ),
    Option("accept_error", str, False, "go on where no methods fit the error budget", flag=True),
    Option(
        "frame",
        str,
        AUTO,
        "pictures as they are on the map (north-up, not resampled), or as the camera sees them",
        choices=(AUTO, *FRAMES),
    ),
    Option(
        "mesh",
        str,
        AUTO,
        "ground under a camera's picture: auto is a mesh as coarse as the error budget allows, rays one ray a pixel",
        choices=(AUTO, RAYS),
    ),
    Option("resampling", str, "bilinear", "of pictures as the camera sees them", choices=RESAMPLINGS),
    Option(
        "wind",
        float,
        None,
        "moves and turns the captures: mean speed in m/s, degrees it blows from, turbulence (gusts over mean speed)",
        count=(3, 3),
        metavar=("SPEED", "FROM", "TURBULENCE"),
    ),
    Option("airspeed", float, DEFAULT_AIRSPEED_M_PER_S, "flight speed through the air in m/s"),
    Option("start", str, DEFAULT_START, "UTC time of the first exposure, such as 2024-06-21T10:30:00Z"),
    Option("max_images", int, DEFAULT_MAX_IMAGES, "refuse missions of more images"),
    Option("seed", int, 2024, "of whatever is random, such as the synthetic landscape"),
    Option(
        "dataset",
        str,
        "TerrAInav",
        "whose layout a dataset that is read has; plan and capture write TerrAInav's own",
        choices=("TerrAInav", "VBN"),
    ),
    Option("batch_size", int, 8, "images in a batch of a loaded dataset; plan and capture do not use it"),
    Option("data_dir", str, "datasets/terrainav", "folder the dataset is written to"),
    Option("connections", int, 8, "requests under way at once"),
    Option(
        "placeholder",
        str,
        None,
        "SHA-256 (16 or more of its digits) of tiles to treat as missing, as a capture names them that has found the "
        "same tile in many places; with --resume, pictures that show them are made again",
        count=(1, 100),
    ),
    Option(
        "cache_dir", str, None, "folder of the cache of tiles (terrainav cache list shows it)", metavar="DIR"
    ),
    Option("cache_limit", int, None, "size the cache is kept to, in MB", metavar="MB"),
    Option("no_cache", str, False, "keep no tiles for later captures, and use none", flag=True),
)


#: Options that say how a mission is run, not what it is: they go with a mission file.
RUN_OPTIONS = (
    *("dataset", "batch_size", "data_dir", "connections", "placeholder"),
    *("cache_dir", "cache_limit", "no_cache"),
)
