"""The parameters of a mission, and the mission that they ask for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterFile,
    QgsProcessingParameterNumber,
    QgsProcessingParameterString,
)

from ...core.errors import InvalidInput
from ...core.resources import read_json
from ..i18n import tr
from .areas import area_of_layer, box_of_extent

if TYPE_CHECKING:
    from ...core.geodesy.camera import Camera
    from ...core.mission.area import Area
    from ...core.mission.mission import Mission
    from ...core.mission.wind import Wind
    from .algorithm import Algorithm

_WHOLE = QgsProcessingParameterNumber.Type.Integer
_REAL = QgsProcessingParameterNumber.Type.Double
_MAP_TYPES = ("satellite", "roadmap", "terrain")
_LAYOUTS = ("cover", "paper")
_ORDERS = ("serpentine", "one-way")
_FORMATS = ("tif", "jpg", "png")
_FRAMES = ("auto", "map", "camera")
_RESAMPLINGS = ("nearest", "bilinear", "bicubic", "lanczos")
#: A share typed in percent is refused in words; a spin box would make it the highest one that it takes.
_MOST_TYPED = 100.0
#: Parameters that are fields of a mission as they are.
_SAME = {
    "OVERLAP_ALONG": "overlap_along",
    "OVERLAP_ACROSS": "overlap_across",
    "GRID_ANGLE": "grid_angle_deg",
    "YAW": "yaw_deg",
    "TILT": "tilt_deg",
    "ROLL": "roll_deg",
    "GROUND_HEIGHT": "ground_height_m",
    "ERROR_BUDGET": "error_budget_px",
    "AIRSPEED": "airspeed_m_per_s",
}
_FLAGS = {"CROSSHATCH": "crosshatch", "ACCEPT_ERROR": "accept_error", "UPSAMPLE": "upsample"}
_COUNTS = {"SEED": "seed", "MAX_IMAGES": "max_images"}
#: Those that say nothing where they are not given.
_IF_GIVEN = {"ZOOM": "zoom", "IMAGE_PX": "image_px", "MAX_PX": "max_px"}
_CHOICES = {
    "LAYOUT": "layout",
    "ORDER": "order",
    "FORMAT": "image_format",
    "FRAME": "frame",
    "RESAMPLING": "resampling",
}


def add_mission_parameters(algorithm: Algorithm, *, listed: bool) -> None:
    """Add all parameters of a mission; those that few people need are advanced ones.

    ``listed`` leaves the user's own cameras and sources out of the choices, which take long to find out.
    """
    _add_area(algorithm)
    _add_camera(algorithm, listed)
    _add_layout(algorithm)
    _add_imagery(algorithm, listed)
    _add_details(algorithm)


def mission_of(
    algorithm: Algorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
) -> Mission:
    """Mission that parameters ask for; raises InvalidInput.

    A mission file says all of it: parameters beside it are left aside.
    """
    from ...core.mission.mission import Mission

    path = algorithm.parameterAsFile(parameters, "MISSION", context)
    if path:
        return Mission.load(path)
    agl_m = algorithm.parameterAsDouble(parameters, "AGL", context)
    area, agl_m = _area(algorithm, parameters, context, feedback, agl_m)
    entries: dict[str, Any] = {}
    for names, read in (
        (_SAME, algorithm.parameterAsDouble),
        (_FLAGS, algorithm.parameterAsBool),
        (_COUNTS, algorithm.parameterAsInt),
        (_CHOICES, algorithm.parameterAsEnumString),
    ):
        entries.update({field: read(parameters, name, context) for name, field in names.items()})
    text = {
        name: algorithm.parameterAsString(parameters, name, context).strip()
        for name in ("OTHER_SOURCE", "DATE", "START", "IMG_SIZE")
    }
    if text["START"]:
        entries["start"] = text["START"]
    if text["IMG_SIZE"]:
        entries["img_size"] = _size(text["IMG_SIZE"])
    camera, own_px = _camera(algorithm, parameters, context)
    entries["image_px"] = own_px
    for name, field in _IF_GIVEN.items():
        if parameters.get(name) is not None:
            entries[field] = algorithm.parameterAsInt(parameters, name, context)
    if parameters.get("GSD") is not None:
        entries["gsd_m_per_px"] = algorithm.parameterAsDouble(parameters, "GSD", context)
    return Mission(
        area=area,
        agl_m=agl_m,
        camera=camera,
        map_types=tuple(algorithm.parameterAsEnumStrings(parameters, "MAP_TYPES", context)),
        source=text["OTHER_SOURCE"] or algorithm.parameterAsEnumString(parameters, "SOURCE", context),
        date=text["DATE"],
        wind=_wind(algorithm, parameters, context, entries["seed"]),
        **entries,
    )


def _add_area(algorithm: Algorithm) -> None:
    algorithm.add(
        QgsProcessingParameterExtent("EXTENT", tr("Area: extent"), optional=True),
        tr("Box to be covered. Give this, a layer, coordinates, or a mission file."),
    )
    algorithm.add(
        QgsProcessingParameterFeatureSource(
            "AREA",
            tr("Area: polygons or points"),
            [QgsProcessing.SourceType.TypeVectorPolygon, QgsProcessing.SourceType.TypeVectorPoint],
            optional=True,
        ),
        tr("One polygon (with holes) to be covered, or points, each of which is one capture; in any CRS."),
    )
    algorithm.add(
        QgsProcessingParameterString("COORDS", tr("Area: coordinates"), optional=True),
        tr(
            "lat_lon_agl for one capture, latTL_lonTL_latBR_lonBR_agl for a box, or a text file of lat lon agl [yaw] "
            "lines; heights in metres."
        ),
    )
    algorithm.add(
        _number("AGL", tr("Height above ground (metres)"), 120.0, 0.0),
        tr(
            "Of captures over an extent, a polygon, or points without a field of heights. Coordinates have their own."
        ),
    )


def _add_camera(algorithm: Algorithm, listed: bool) -> None:
    algorithm.add(
        _choice("CAMERA", tr("Camera"), _cameras(listed), None),
        tr("Its field of view, aspect ratio and pixels. Without one, those below count."),
    )
    algorithm.add(
        _number("FOV", tr("Diagonal field of view (degrees)"), 78.8, 0.0, 180.0),
        tr("Where no camera is chosen."),
    )
    algorithm.add(
        QgsProcessingParameterString("ASPECT", tr("Aspect ratio, width:height"), "4:3"),
        tr("Where no camera is chosen; such as 4:3, 16:9 or 1.5."),
    )


def _add_layout(algorithm: Algorithm) -> None:
    share = tr("Share of a picture that the next one shows again, 0 to below 1.")
    algorithm.add(_number("OVERLAP_ALONG", tr("Overlap along rows (share)"), 0.0, 0.0, _MOST_TYPED), share)
    algorithm.add(_number("OVERLAP_ACROSS", tr("Overlap across rows (share)"), 0.0, 0.0, _MOST_TYPED), share)
    algorithm.add(
        _choice("LAYOUT", tr("Layout"), _LAYOUTS, "cover"),
        tr("cover leaves nothing out; paper is the published UTM grid."),
    )
    algorithm.add(
        _number("GRID_ANGLE", tr("Grid angle (degrees)"), 0.0, -180.0, 180.0),
        tr("Rows, and the pictures with them, are turned clockwise from east."),
    )
    algorithm.add(
        QgsProcessingParameterBoolean("CROSSHATCH", tr("Crosshatch"), False),
        tr("Fly the area a second time, in rows across the first ones."),
    )
    algorithm.add(
        _choice("ORDER", tr("Order of rows"), _ORDERS, "serpentine"),
        tr("serpentine flies rows to and fro, one-way each from its beginning."),
    )


def _add_imagery(algorithm: Algorithm, listed: bool) -> None:
    algorithm.add(
        _choice("SOURCE", tr("Source of imagery"), _sources(listed), "world"),
        tr("world is the embedded synthetic one, which needs no network."),
    )
    algorithm.add(
        QgsProcessingParameterString("OTHER_SOURCE", tr("Other source"), optional=True),
        tr(
            "Instead of the one above: a name of your own, a URL template with {z}, {x}, {y}, wmts:URL#layer=NAME, "
            "wms:URL#layers=NAME, a raster or MBTiles file, or qgis:project for the project's map."
        ),
    )
    algorithm.add(
        _choice("MAP_TYPES", tr("Map types"), _MAP_TYPES, ["satellite"], several=True),
        tr("Each is captured into a folder of its own."),
    )
    algorithm.add(
        _choice("FORMAT", tr("Files"), _FORMATS, "tif"),
        tr("tif is lossless and georeferenced in itself; jpg and png have world files beside them."),
    )


def _add_details(algorithm: Algorithm) -> None:
    def number(
        name: str, title: str, text: str, *limits: Any, kind: Any = _REAL, optional: bool = False
    ) -> None:
        algorithm.add(_number(name, title, *limits, kind=kind, optional=optional), text, advanced=True)

    def texts(name: str, title: str, text: str) -> None:
        algorithm.add(QgsProcessingParameterString(name, title, optional=True), text, advanced=True)

    def flag(name: str, title: str, text: str) -> None:
        algorithm.add(QgsProcessingParameterBoolean(name, title, False), text, advanced=True)

    for name, title, text in (
        ("AGL_FIELD", tr("Field of heights"), tr("Height above ground of each point, metres.")),
        ("YAW_FIELD", tr("Field of yaws"), tr("Yaw of each point, degrees clockwise from north.")),
    ):
        field = QgsProcessingParameterField(
            name,
            title,
            parentLayerParameterName="AREA",
            type=QgsProcessingParameterField.DataType.Numeric,
            optional=True,
        )
        algorithm.add(field, text, advanced=True)
    number("YAW", tr("Yaw (degrees)"), tr("Top of the pictures, clockwise from north."), 0.0, -360.0, 360.0)
    number("TILT", tr("Tilt (degrees)"), tr("0 looks straight down, 90 at the horizon."), 0.0, -180.0, 180.0)
    number("ROLL", tr("Roll (degrees)"), tr("Right side down."), 0.0, -180.0, 180.0)
    number(
        "GROUND_HEIGHT", tr("Ground height (metres)"), tr("Over the WGS84 ellipsoid."), 0.0, -12000.0, 9000.0
    )
    number("ERROR_BUDGET", tr("Error budget (px)"), tr("How wrong a pixel may be."), 0.1, 0.0)
    flag("ACCEPT_ERROR", tr("Accept a larger error"), tr("Go on where no methods fit the error budget."))
    for name, title, choices, usual, text in (
        (
            "FRAME",
            tr("Kind of picture"),
            _FRAMES,
            "auto",
            tr("auto takes the cheapest that fits the error budget."),
        ),
        ("RESAMPLING", tr("Resampling"), _RESAMPLINGS, "bilinear", tr("Of camera frames.")),
    ):
        algorithm.add(_choice(name, title, choices, usual), text, advanced=True)
    pixels = tr("Along the longer side of the camera's image; without it, the chosen camera's own, or 640.")
    number("IMAGE_PX", tr("Image's longer side (px)"), pixels, None, 1, kind=_WHOLE, optional=True)
    nearest = tr("Without it, the one whose pixels come nearest to the camera's.")
    number("ZOOM", tr("Zoom"), nearest, None, 0, 30, kind=_WHOLE, optional=True)
    number("GSD", tr("Ground sample distance (metres)"), tr("Instead of a zoom."), None, 0.0, optional=True)
    limit = tr(
        "Limit for all pictures, in pixels of 256 px tiles: where one would be larger, a lower zoom is taken."
    )
    number("MAX_PX", tr("Longest side (px)"), limit, None, 1, kind=_WHOLE, optional=True)
    flag("UPSAMPLE", tr("Allow upsampling"), tr("Zooms above the source's own detail."))
    texts("IMG_SIZE", tr("Resize pictures to"), tr("width height channels, such as 256 256 3."))
    texts("DATE", tr("Date of the imagery"), tr("Where the source has several."))
    number("WIND_SPEED", tr("Wind speed (m/s)"), tr("0 for still air."), 0.0, 0.0)
    number("WIND_FROM", tr("Wind from (degrees)"), tr("Clockwise from north."), 270.0, 0.0, 360.0)
    number("TURBULENCE", tr("Turbulence"), tr("0 for steady wind; gusts are drawn by the seed."), 0.2, 0.0)
    number("AIRSPEED", tr("Airspeed (m/s)"), tr("Through the air."), 15.0, 0.1, 340.0)
    texts("START", tr("Start of the flight"), tr("UTC, such as 2024-06-21T10:30:00Z."))
    number("SEED", tr("Seed"), tr("Of whatever is random."), 2024, 0, kind=_WHOLE)
    number("MAX_IMAGES", tr("Most images"), tr("More are refused."), 10_000_000, 1, kind=_WHOLE)
    mission = QgsProcessingParameterFile("MISSION", tr("Mission file"), extension="json", optional=True)
    algorithm.add(
        mission,
        tr("A mission as the plan writes it; all parameters above are left aside then."),
        advanced=True,
    )


def _number(
    name: str,
    title: str,
    usual: float | None,
    least: float | None = None,
    most: float | None = None,
    *,
    kind: Any = _REAL,
    optional: bool = False,
) -> QgsProcessingParameterNumber:
    parameter = QgsProcessingParameterNumber(name, title, kind, usual, optional)
    if least is not None:
        parameter.setMinimum(least)
    if most is not None:
        parameter.setMaximum(most)
    return parameter


def _choice(
    name: str, title: str, choices: tuple[str, ...], usual: object, *, several: bool = False
) -> QgsProcessingParameterEnum:
    """Choice whose values are the words themselves, in models, scripts and on the terminal."""
    return QgsProcessingParameterEnum(
        name,
        title,
        options=list(choices),
        allowMultiple=several,
        defaultValue=usual,
        optional=usual is None,
        usesStaticStrings=True,
    )


def _cameras(listed: bool) -> tuple[str, ...]:
    if listed:
        return tuple(data["name"] for data in read_json("cameras.json"))
    from ...core.mission.cameras import cameras

    return tuple(camera.name for camera in cameras())


def _sources(listed: bool) -> tuple[str, ...]:
    shipped = tuple(read_json("sources.json"))
    if listed:
        return shipped
    from ...core.imagery.catalogue import user_sources

    try:
        return (*shipped, *(entry.name for entry in user_sources()))
    except InvalidInput:
        # A broken file of one's own sources is named where one of them is asked for.
        return shipped


def _area(
    algorithm: Algorithm,
    parameters: dict[str, Any],
    context: QgsProcessingContext,
    feedback: QgsProcessingFeedback,
    agl_m: float,
) -> tuple[Area, float]:
    given = [name for name in ("EXTENT", "AREA", "COORDS") if parameters.get(name) not in (None, "")]
    if len(given) != 1:
        raise InvalidInput(
            tr("{count} areas given: needs one of extent, polygons or points, and coordinates").format(
                count=len(given)
            )
        )
    if given == ["EXTENT"]:
        return box_of_extent(algorithm, parameters, context), agl_m
    if given == ["AREA"]:
        return area_of_layer(algorithm, parameters, context, feedback, agl_m)
    from ...core.mission.coords import parse_coords

    return parse_coords(algorithm.parameterAsString(parameters, "COORDS", context).strip())


def _camera(
    algorithm: Algorithm, parameters: dict[str, Any], context: QgsProcessingContext
) -> tuple[Camera, int]:
    """Camera, and the pixels along the longer side of its image."""
    from ...core.geodesy.camera import Camera
    from ...core.mission.cameras import camera_named
    from ...core.mission.parts import Pixels
    from ..form.text import parse_aspect

    name = algorithm.parameterAsEnumString(parameters, "CAMERA", context)
    if name:
        preset = camera_named(name)
        return preset.camera, preset.image_px or Pixels.image_px
    text = algorithm.parameterAsString(parameters, "ASPECT", context)
    try:
        ratio = parse_aspect(text)
    except ValueError as wrong:
        raise InvalidInput(tr("aspect ratio {text!r}: must be such as 4:3").format(text=text)) from wrong
    return Camera(algorithm.parameterAsDouble(parameters, "FOV", context), ratio), Pixels.image_px


def _wind(
    algorithm: Algorithm, parameters: dict[str, Any], context: QgsProcessingContext, seed: int
) -> Wind | None:
    from ...core.mission.wind import Wind

    speed, origin, turbulence = (
        algorithm.parameterAsDouble(parameters, name, context)
        for name in ("WIND_SPEED", "WIND_FROM", "TURBULENCE")
    )
    return Wind(speed, origin, turbulence, seed) if speed > 0.0 else None


def _size(text: str) -> tuple[int, int, int]:
    try:
        width, height, channels = (int(part) for part in text.replace(",", " ").split())
    except ValueError as wrong:
        raise InvalidInput(
            tr("image size {text!r}: must be width height channels, such as 256 256 3").format(text=text)
        ) from wrong
    return width, height, channels
