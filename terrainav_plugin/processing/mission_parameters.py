"""The parameters of a mission, and the mission read from them."""

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsProcessing,
    QgsProcessingAlgorithm,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterExtent,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterField,
    QgsProcessingParameterFile,
    QgsProcessingParameterNumber,
    QgsProcessingParameterPoint,
    QgsProcessingParameterString,
)

from ...core.errors import InvalidInput
from ...core.fields import Field, declared_fields, field_named
from ...core.geodesy.lens import LENS_FIELDS, Lens
from ...core.mission.flight.wind import Wind
from ...core.mission.parts import FLAT_PARTS, Flight, Imagery, Pixels
from ...core.numbers import integer
from ...core.resources import read_json
from ..form.fields import field_sentence, field_title
from ..form.text import aspect_text, parse_aspect
from ..i18n import tr, translate
from .areas import area_of_extent, area_of_layer, check_parameter_crs, no_fly_of_layer
from .choices import ChoiceParameter

if TYPE_CHECKING:
    from ...core.geodesy.camera import Camera
    from ...core.mission.areas.area import Area
    from ...core.mission.mission import Mission
    from .algorithm import Algorithm, AlgorithmRun

_WHOLE = QgsProcessingParameterNumber.Type.Integer
_REAL = QgsProcessingParameterNumber.Type.Double
#: Parameters whose names differ from the command's options, by field.
_IDS = {"overlap_along": "FRONT_OVERLAP", "overlap_across": "SIDE_OVERLAP", "map_types": "MAP_TYPES"}
#: Fields whose parameter has no default value although the mission has one: the chosen camera determines ``image_px``
#: and the lens, and the texts may be left empty.
_IF_GIVEN = ("image_px", "start", "date", "crs", *LENS_FIELDS)
#: The last parameter of a mission, which replaces all others.
_FILE = "MISSION"
_LENS = tuple(field_named(Lens, name) for name in LENS_FIELDS)
_WIND = {"WIND_SPEED": "speed_m_per_s", "WIND_FROM": "from_deg", "TURBULENCE": "turbulence"}


def add_mission_parameters(algorithm: Algorithm, *, listed: bool) -> None:
    """Add all parameters of a mission, the less common ones as advanced.

    ``listed`` omits the user's cameras and sources from the choices, as reading them is slow.
    """
    _add_area(algorithm)
    _add_camera(algorithm, listed)
    for part in FLAT_PARTS.values():
        for field in declared_fields(part):
            if field.name == "agl_m":
                continue
            if field.name == "source":
                _add_source(algorithm, listed)
            else:
                algorithm.add(_parameter(field), field_sentence(field), advanced=field.advanced)
    for name, own in _WIND.items():
        field = field_named(Wind, own)
        usual = field.default if own == "speed_m_per_s" else field.initial_value
        algorithm.add(number_parameter(name, field, usual), field_sentence(field), advanced=True)
    mission = QgsProcessingParameterFile(_FILE, tr("Mission file"), extension="json", optional=True)
    algorithm.add(
        mission,
        tr("A mission file written by “Plan a mission”. All parameters above are then ignored."),
        advanced=True,
    )


def leave_mission_to_file(algorithm: QgsProcessingAlgorithm) -> None:
    """Hide the parameters that the mission's file replaces in an algorithm's window."""
    flags = QgsProcessingParameterDefinition.Flag
    for parameter in algorithm.parameterDefinitions():
        if parameter.name() == _FILE:
            parameter.setFlags(parameter.flags() & ~flags.FlagAdvanced)
            return
        parameter.setFlags(parameter.flags() | flags.FlagHidden)


def read_mission(run: AlgorithmRun) -> Mission:
    """Mission from parameters; raises InvalidInput.

    A mission file replaces all other parameters.
    """
    from ...core.imagery.catalogue import source_name
    from ...core.mission.mission import Mission

    path = run.algorithm.parameterAsFile(run.parameters, _FILE, run.context)
    if path:
        return Mission.load(path)
    area, agl_m = _area(run, run.number("AGL"))
    camera, own_px = _camera(run)
    entries: dict[str, Any] = {"image_px": own_px}
    for part in FLAT_PARTS.values():
        for field in declared_fields(part):
            # The others are read separately.
            if field.name not in ("agl_m", "source", "map_types", "img_size", "takeoff"):
                value = _value(run, field)
                entries.update({} if value is None else {field.name: value})
    size, other = run.text("IMG_SIZE").strip(), run.text("OTHER_SOURCE").strip()
    return Mission(
        area,
        agl_m,
        camera,
        wind=_wind(run, entries["seed"]),
        no_fly=no_fly_of_layer(run),
        map_types=run.chosen("MAP_TYPES"),
        source=source_name(other) if other else run.choice("SOURCE"),
        img_size=_size(size) if size else None,
        takeoff=_takeoff(run),
        **entries,
    )


def _parameter_id(field: Field) -> str:
    return _IDS.get(field.name, field.name_of_option.upper())


def _value(run: AlgorithmRun, field: Field) -> Any:
    """Value of a field's parameter; None if it is optional and not given."""
    name = _parameter_id(field)
    if field.unit.times != 1.0:
        return None if field.optional and run.parameters.get(name) is None else _share(run, field)
    if field.choices and field.kind is tuple:
        return run.chosen(name)
    if field.choices:
        return run.choice(name) or None
    if field.kind is str:
        text = run.text(name).strip()
        return (text.lower() if field.name == "facing" else text) or None
    # Paths and names of sources are separated by semicolons, as they may contain spaces.
    if field.name in ("elevation", "surface", "imageries", "buildings", "labels", "vary"):
        return tuple(part.strip() for part in run.text(name).split(";") if part.strip())
    if field.kind is tuple:
        return tuple(run.text(name).split())
    if (field.optional or field.name in _IF_GIVEN) and run.parameters.get(name) is None:
        return None
    return {float: run.number, int: run.whole, bool: run.flag}[field.kind](name)


def _parameter(field: Field) -> QgsProcessingParameterDefinition:
    """Parameter of a declared field."""
    name, title = _parameter_id(field), field_title(field)
    if field.choices:
        several = field.kind is tuple
        usual = None if field.name in _IF_GIVEN else list(field.default) if several else field.default
        # An optional parameter offers no value for "nothing".
        choices = {value: translate(words) for value, words in field.choices.items() if value}
        return ChoiceParameter(name, title, choices, usual or None, several=several)
    if field.kind is bool:
        return QgsProcessingParameterBoolean(name, title, field.default)
    if field.name == "takeoff":
        return QgsProcessingParameterPoint(name, title, optional=True)
    if field.kind in (str, tuple):
        usual = field.default if field.kind is str and field.name not in _IF_GIVEN else None
        return QgsProcessingParameterString(name, title, usual, optional=True)
    return number_parameter(name, field, None if field.name in _IF_GIVEN else field.default)


def _add_area(algorithm: Algorithm) -> None:
    algorithm.add(
        QgsProcessingParameterExtent("EXTENT", tr("Area: extent"), optional=True),
        tr("Box to cover. Give this, a layer, coordinates, or a mission file."),
    )
    algorithm.add(
        QgsProcessingParameterFeatureSource(
            "AREA",
            tr("Area: polygons or points"),
            [QgsProcessing.SourceType.TypeVectorPolygon, QgsProcessing.SourceType.TypeVectorPoint],
            optional=True,
        ),
        tr(
            "Polygons (with holes) to cover, each with separate rows; those that touch are merged. Or "
            "points, each one capture. In any CRS."
        ),
    )
    algorithm.add(
        QgsProcessingParameterString("COORDS", tr("Area: coordinates"), optional=True),
        tr(
            "lat_lon_agl for one capture, latTL_lonTL_latBR_lonBR_agl for a box, with or without the height, or a "
            "file: lat lon agl [yaw] lines, or a table whose first line names its columns; heights in metres."
        ),
    )
    algorithm.add(
        QgsProcessingParameterFeatureSource(
            "NO_FLY", tr("No-fly areas"), [QgsProcessing.SourceType.TypeVectorPolygon], optional=True
        ),
        tr("Polygons over which no image is taken: images planned inside are left out."),
    )
    field = field_named(Flight, "agl_m")
    algorithm.add(number_parameter("AGL", field, field.initial_value), field_sentence(field))
    any_type = QgsProcessingParameterField.DataType.Any
    for name, title, text in (
        ("AGL_FIELD", tr("Height field"), tr("Height above ground of each point, metres.")),
        ("YAW_FIELD", tr("Yaw field"), tr("Yaw of each point, degrees clockwise from north.")),
        ("TILT_FIELD", tr("Tilt field"), tr("Tilt of each point, degrees: 0 looks straight down.")),
        (
            "GIMBAL_PITCH_FIELD",
            tr("Gimbal pitch field"),
            tr("Pitch of each point instead of a tilt, degrees: -90 looks straight down."),
        ),
        ("ROLL_FIELD", tr("Roll field"), tr("Roll of each point, degrees, right side down.")),
        (
            "TIME_FIELD",
            tr("Capture time field"),
            tr(
                "Time of each point: a date with its time, text such as 2024-06-21T10:30:00Z, or seconds after 1970; "
                "in UTC where no zone is stated. Captures are in the order of their times."
            ),
        ),
    ):
        of_points = QgsProcessingParameterField(
            name,
            title,
            parentLayerParameterName="AREA",
            type=any_type if name == "TIME_FIELD" else QgsProcessingParameterField.DataType.Numeric,
            optional=True,
        )
        algorithm.add(of_points, text, advanced=True)


def _add_camera(algorithm: Algorithm, listed: bool) -> None:
    algorithm.add(
        ChoiceParameter("CAMERA", tr("Camera"), {name: name for name in _cameras(listed)}),
        tr("Sets the field of view, aspect ratio and pixels. If no camera is chosen, the values below apply."),
    )
    field = field_named(Lens, "fov_deg")
    algorithm.add(
        number_parameter("FOV", field, field.default),
        tr("{help} Without a chosen camera.").format(help=field_sentence(field)),
    )
    algorithm.add(
        QgsProcessingParameterString("ASPECT", tr("Aspect ratio, width:height"), aspect_text(Lens.aspect_ratio)),
        tr("Without a chosen camera; such as 4:3, 16:9 or 1.5."),
    )
    for field in _LENS:
        text = tr("{help} If empty, as the chosen camera has it.").format(help=field_sentence(field))
        algorithm.add(_parameter(field), text, advanced=True)


def _add_source(algorithm: Algorithm, listed: bool) -> None:
    field = field_named(Imagery, "source")
    algorithm.add(
        ChoiceParameter("SOURCE", tr("Source of imagery"), _sources(listed), field.default, titled=True, more=listed),
        tr(
            "By title or name, as “Synthetic (offline)” or “world”, which is the embedded landscape and needs no "
            "network."
        ),
    )
    algorithm.add(
        QgsProcessingParameterString("OTHER_SOURCE", tr("Other source"), optional=True),
        tr(
            "Used instead of the source above: one of your own sources by name or title, a URL template with {z}, "
            "{x}, {y}, wmts:URL#layer=NAME, wms:URL#layers=NAME, arcgis:URL, ogcapi:URL#collection=NAME, a raster or "
            "MBTiles file, or qgis:project for the project's map."
        ),
    )


def number_parameter(name: str, field: Field, usual: float | None) -> QgsProcessingParameterNumber:
    """Number parameter of a field, with its declared range."""
    kind = _WHOLE if field.kind is int else _REAL
    times = field.unit.times
    shown = None if usual is None else usual * times if times != 1.0 else usual
    parameter = QgsProcessingParameterNumber(name, field_title(field), kind, shown, usual is None)
    least = field.least if field.above is None else field.above
    most = field.most if field.below is None else field.below
    if least is not None:
        parameter.setMinimum(least * times)
    if most is not None:
        parameter.setMaximum(most * times)
    return parameter


def _cameras(listed: bool) -> tuple[str, ...]:
    if listed:
        return tuple(data["name"] for data in read_json("cameras.json"))
    from ...core.mission.cameras import cameras

    return tuple(camera.name for camera in cameras())


def _sources(listed: bool) -> dict[str, str]:
    """Titles of sources, by name."""
    shipped = {name: str(data["title"]) for name, data in read_json("sources.json").items()}
    if listed:
        return shipped
    from ...core.imagery.catalogue import user_sources

    try:
        return {**shipped, **{entry.name: entry.title for entry in user_sources()}}
    except InvalidInput:
        # A broken file of the user's sources is reported when one of them is used.
        return shipped


def _share(run: AlgorithmRun, field: Field) -> float:
    """Share from a percentage, computed from the decimal typed: a binary fraction would give other last digits."""
    return float(Decimal(repr(run.number(_parameter_id(field)))) / int(field.unit.times))


def _area(run: AlgorithmRun, agl_m: float) -> tuple[Area, float]:
    given = [name for name in ("EXTENT", "AREA", "COORDS") if run.is_given(name)]
    if len(given) != 1:
        raise InvalidInput(
            tr("{count} areas given: needs one of extent, polygons or points, and coordinates").format(count=len(given))
        )
    if given == ["EXTENT"]:
        return area_of_extent(run), agl_m
    if given == ["AREA"]:
        return area_of_layer(run, agl_m)
    from ...core.mission.areas.coords import parse_coords

    return parse_coords(run.text("COORDS").strip(), agl_m=agl_m)


def _camera(run: AlgorithmRun) -> tuple[Camera, int]:
    """Camera, and the number of pixels along the longer side of its images."""
    from ...core.geodesy.camera import Camera
    from ...core.mission.cameras import camera_named

    given = {field.name: _value(run, field) for field in _LENS}
    lens = {name: value for name, value in given.items() if value is not None}
    name = run.choice("CAMERA")
    if name:
        preset = camera_named(name)
        return replace(preset.camera, **lens), preset.image_px or Pixels.image_px
    text = run.text("ASPECT")
    try:
        ratio = parse_aspect(text)
    except ValueError as wrong:
        raise InvalidInput(tr("aspect ratio {text!r}: must be such as 4:3").format(text=text)) from wrong
    return Camera(run.number("FOV"), ratio, **lens), Pixels.image_px


def _wind(run: AlgorithmRun, seed: int) -> Wind | None:
    speed, origin, turbulence = map(run.number, _WIND)
    return Wind(speed, origin, turbulence, seed) if speed > 0.0 else None


def _takeoff(run: AlgorithmRun) -> tuple[float, float] | None:
    """Latitude and longitude of a point in any CRS; None without a point."""
    if not run.is_given("TAKEOFF"):
        return None
    check_parameter_crs(run, "TAKEOFF")
    wgs84 = QgsCoordinateReferenceSystem("EPSG:4326")
    place = run.algorithm.parameterAsPoint(run.parameters, "TAKEOFF", run.context, wgs84)
    return place.y(), place.x()


def _size(text: str) -> tuple[int, int, int]:
    try:
        width, height, channels = (integer(part) for part in text.replace(",", " ").split())
    except ValueError as wrong:
        raise InvalidInput(
            tr("image size {text!r}: must be width height channels, such as 256 256 3").format(text=text)
        ) from wrong
    return width, height, channels
