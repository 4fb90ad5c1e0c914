"""The mission of the dock's entries, and the entries of a mission. No widgets."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from ...core.errors import InvalidInput, TerrAInavError
from ...core.fields import Field, declared_fields, field_named
from ...core.geodesy.lens import LENS_FIELDS
from ...core.mission.parts import FLAT_PARTS, GROUND, REALISM_PARTS, Flight, Imagery, Output, Route, Sunlight
from ..i18n import number_text, plain_number, tr, translate
from .area import FormError, edge_deg, entered_shape, no_fly_text, parse_no_fly, replace_box, shape_text
from .camera import camera_as_typed, convert_camera, in_length_unit, lens_values
from .state import (
    BOX_FIELDS,
    DECLARED,
    DIAGONAL,
    ENTERED_AS_DECLARED,
    SENSOR,
    URL_TEMPLATE,
    WITHOUT_ENTRY,
    FormState,
)
from .text import (
    aspect_text,
    exact_degrees_text,
    has_minutes,
    looks_like_coordinates,
    parse_aspect,
    parse_place,
    short_place,
)

if TYPE_CHECKING:
    from ...core.mission.areas.area import Area, Box, Points
    from ...core.mission.imageries import NamedImagery
    from ...core.mission.mission import Mission

#: Entries by the name that error messages give to their field, where it differs.
_ENTRIES = {
    "area": "north",
    "agl_m": "agl",
    "camera": "fov_deg",
    "img_size": "resize_width_px",
    "wind": "turbulence",
    "speed_m_per_s": "wind_speed_m_per_s",
    "from_deg": "wind_from_deg",
}
#: Fields of twins of images, which are no effects.
_KEPT = ("keep_clean", "keep_undistorted")
#: Least and greatest aspect ratio: others are slips, for which the planner would blame the height.
_ASPECTS = 0.001, 1000.0
#: Key of errors that concern no entry of the panel.
_BEYOND = "more"
#: Entries of poses that are stated: nothing moves or orders them.
_STILL = {"wind": False, "height_above": GROUND, "skip_rows": "", "order": Flight.order}


class _Checks:
    """Run the core's checks field by field, and keep their messages."""

    def __init__(self) -> None:
        self.messages: dict[str, str] = {}

    def __call__(self, field: str, check: Callable[[], Any]) -> Any:
        try:
            return check()
        except TerrAInavError as wrong:
            # When entries are checked together, the error may name an entry other than ``field``.
            named = wrong.field if wrong.field in (*BOX_FIELDS, *LENS_FIELDS) else field
            self.messages.setdefault(named, translate(wrong))
        return None

    def number(self, field: str, what: str, text: str, parse: Callable[[str], float]) -> float | None:
        try:
            return parse(text)
        except ValueError:
            self.messages[field] = tr("{what} “{text}”: must be a number").format(what=what, text=text.strip())
        return None


def mission(state: FormState) -> Mission:
    """Mission of a state.

    Raises
    ------
    FormError
        With the core's message for every wrong field.
    """
    from ...core.mission.areas.area import check_ground

    checks = _Checks()
    area = _box(state, checks)
    shape = checks("shape", lambda: entered_shape(state))
    if shape is None and area is not None:
        # Only a box is checked: the box around points may have no area on the ground.
        checks("south", lambda: check_ground(area))
    return _mission(state, area if shape is None else shape, checks)


def test_shot(state: FormState, lat_deg: float, lon_deg: float) -> Mission:
    """Mission of one image above a point, otherwise as entered; raises FormError as `mission` does."""
    from ...core.mission.areas.area import Points

    # The ideal image is shown beside one with effects.
    has_effects = any(getattr(state, one.name) != one.default for one in _effect_fields())
    single = replace(_one_imagery(state), keep_clean=has_effects)
    return _not_flown(single, lambda: Points(((lat_deg, lon_deg, state.agl_m),)))


def single_view(state: FormState, lat_deg: float, lon_deg: float) -> Mission:
    """Mission of one image above a point, from which a live camera is made; raises FormError as `mission` does."""
    from ...core.mission.areas.area import Points

    still = replace(_one_imagery(state), **_STILL)
    return _not_flown(still, lambda: Points(((lat_deg, lon_deg, state.agl_m),)))


def recorded(state: FormState, points: Points, above: str) -> Mission:
    """Mission of given poses, otherwise as entered; raises FormError as `mission` does.

    Parameters
    ----------
    above : str
        Where heights of the points count from, as the mission's ``height_above``.
    """
    return _not_flown(replace(state, **{**_STILL, "height_above": above}), lambda: points)


def _one_imagery(state: FormState) -> FormState:
    """State of one imagery and map type, without twins of images."""
    return replace(
        state,
        map_types=state.map_types[:1],
        imageries=(),
        imagery_name="",
        keep_clean=False,
        keep_undistorted=False,
    )


def _not_flown(state: FormState, points: Callable[[], Points]) -> Mission:
    """Mission of points without a route: it needs no take-off and no battery, but images are exposed."""
    checks = _Checks()
    route = {one.name: one.default for one in declared_fields(Route) if one.name in ENTERED_AS_DECLARED}
    del route["exposure_ms"]
    return _mission(replace(state, takeoff="", no_fly="", **route), checks("agl", points), checks)


def _effect_fields() -> list[Field]:
    """Fields of the effects of a real camera, and of values that vary; not those of the sun, which is on the scene."""
    parts = (FLAT_PARTS[name] for name in REALISM_PARTS if FLAT_PARTS[name] is not Sunlight)
    return [one for part in parts for one in declared_fields(part) if one.name not in _KEPT]


def box(state: FormState) -> Box | None:
    """Box entered; None if missing or invalid."""
    return _box(state, _Checks()) if state.has_box else None


def _mission(state: FormState, area: Area | None, checks: _Checks) -> Mission:
    from ...core.mission.areas.area import check_agl
    from ...core.mission.mission import Mission

    state = state.effective
    camera = _camera(state, checks)
    if state.agl_m > 0.0:
        checks("agl", lambda: check_agl(state.agl_m))
    else:
        checks.messages["agl"] = tr("height above ground {height} {unit}: must be above 0").format(
            height=number_text(state.agl, "g"), unit=state.agl_unit
        )
    entries = {name: getattr(state, name) for name in ENTERED_AS_DECLARED if name not in LENS_FIELDS}
    entries.update(_pixels(state), source=state.source_name, takeoff=checks("takeoff", lambda: takeoff(state)))
    if not state.map_types:
        checks.messages["map_types"] = tr("no map type: tick one or more")
    for name, value in entries.items():
        checks(field_entry(name) or _BEYOND, partial(_check, name, value))
    entries.update(_imageries(state, checks))
    wind = _wind(state, checks)
    no_fly = checks("no_fly", lambda: parse_no_fly(state.no_fly))
    checks.messages.update((name, unread_text(name, text)) for name, text in state.unread if name not in state.hidden)
    if checks.messages:
        raise FormError(checks.messages)
    try:
        return Mission(area, state.agl_m, camera, wind=wind, no_fly=no_fly, **entries)
    except InvalidInput as wrong:
        # Each entry is valid, but not in combination with another.
        raise FormError({field_entry(wrong.field) or _BEYOND: translate(wrong)}) from wrong


def own_imagery(state: FormState) -> NamedImagery:
    """Imagery of the source, date and map type entered, by its name or one made of them; raises InvalidInput."""
    from ...core.mission.imageries import NamedImagery

    made = NamedImagery.unnamed(state.source_name, state.date, *state.map_types[:1])
    made = replace(made, name=state.imagery_name) if state.imagery_name else made
    if NamedImagery.parse(str(made)) != made:
        # Its name or date looks like another part of the text.
        raise InvalidInput(tr("this source cannot be one of several: save it under another name first"))
    return made


def _imageries(state: FormState, checks: _Checks) -> dict[str, Any]:
    """Fields of a mission of several imageries, in place of those of one source; empty for one source."""
    if not (state.imageries or state.imagery_name):
        return {}
    if len(state.map_types) > 1:
        checks.messages["map_types"] = tr("several imageries: tick one map type here, and add the others as imagery")
    own = checks("imageries", lambda: own_imagery(state))
    texts = (*(() if own is None else (str(own),)), *state.imageries)
    checks("imageries", partial(_check, "imageries", texts))
    usual = {name: field_named(Imagery, name).default for name in ("source", "date", "map_types")}
    return {**usual, "imageries": texts}


def unread_text(name: str, text: str) -> str:
    """Message for an invalid text in a number's entry: it is not a number, or outside the entry's range."""
    others = {
        "camera_gsd": tr("GSD"),
        "fov_typed_deg": tr("field of view"),
        "focal_length_mm": tr("focal length"),
        "sensor_width_mm": tr("sensor width"),
        "sensor_height_mm": tr("sensor height"),
        "resize_width_px": tr("image width"),
        "resize_height_px": tr("image height"),
        "facing": tr("azimuth"),
    }
    field = DECLARED.get(name)
    what = others.get(name) or (translate(field.title) if field is not None else name)
    try:
        value = plain_number(text)
    except ValueError:
        return tr("{what} “{text}”: must be a number").format(what=what, text=text)
    if field is not None and name not in others:
        try:
            field.settled(value / field.unit.times)
        except InvalidInput as wrong:
            return translate(wrong)
    # -0 too: a sign is not left out in silence.
    if math.copysign(1.0, value) < 0.0:
        return tr("{what} “{text}”: must be 0 or more").format(what=what, text=text)
    if value != int(value) and (name.startswith("resize_") or (field is not None and field.kind is int)):
        return tr("{what} “{text}”: must be a whole number").format(what=what, text=text)
    if 0.0 < value < 1.0:
        return tr("{what} “{text}”: is too small").format(what=what, text=text)
    return tr("{what} “{text}”: is too large").format(what=what, text=text)


def _check(name: str, value: Any) -> None:
    """Refuse a value that is invalid for a mission's field."""
    field = ENTERED_AS_DECLARED.get(name) or DECLARED.get(name) or field_named(Output, name)
    field.settled(value)


def takeoff(state: FormState) -> tuple[float, float] | None:
    """Latitude and longitude of the take-off point entered; None if there is none.

    Raises
    ------
    InvalidInput
        The text is not two numbers, or not a place on the Earth.
    """
    text = state.takeoff.strip()
    if not text:
        return None
    try:
        lat, lon = parse_place(text)
    except ValueError as wrong:
        raise InvalidInput(
            tr("take-off “{text}”: must be a latitude and a longitude, such as {example}").format(
                text=text, example=short_place("35.15, -89.9")
            ),
            field="takeoff",
        ) from wrong
    place: tuple[float, float] | None = field_named(Route, "takeoff").settled((lat, lon))
    return place


def takeoff_text(place: tuple[float, float] | None) -> str:
    """Text of a take-off point, from which `takeoff` reads the same numbers; empty for None."""
    return "" if place is None else ", ".join(map(exact_degrees_text, place))


def _pixels(state: FormState) -> dict[str, Any]:
    """Fields of a mission for the resolution and size of images."""
    channels = 1 if state.resize_grey else 3
    return {
        "zoom": state.zoom if state.resolution == "zoom" else None,
        "gsd_m_per_px": state.gsd_m_per_px if state.resolution == "gsd" else None,
        "img_size": (state.resize_width_px, state.resize_height_px, channels) if state.resize else None,
    }


def field_entry(field: str) -> str:
    """Entry for a field of a mission; empty if it has none."""
    known = {entry.name for entry in fields(FormState)} - set(WITHOUT_ENTRY)
    entry = _ENTRIES.get(field, field)
    return entry if entry in known else ""


def refused_fields(error: TerrAInavError) -> dict[str, str]:
    """Map the entry that an error concerns to the message; empty if the error concerns no entry, or several."""
    entry = field_entry(error.field) if error.field else ""
    return {entry: translate(error)} if entry else {}


def _wind(state: FormState, checks: _Checks) -> Any:
    """Wind entered, checked entry by entry; None if there is none."""
    from ...core.mission.flight.wind import Wind

    if not state.wind:
        return None
    seed = state.seed if state.wind_seed is None else state.wind_seed
    airspeed = Flight.airspeed_m_per_s if "airspeed_m_per_s" in checks.messages else state.airspeed_m_per_s
    entries = {
        "wind_from_deg": ("from_deg", state.wind_from_deg),
        "wind_speed_m_per_s": ("speed_m_per_s", state.wind_speed_m_per_s),
        "turbulence": ("turbulence", state.turbulence),
    }
    wind = Wind(seed=seed)
    for field, (name, value) in entries.items():
        # Add each value to the valid ones: the airspeed limits speed and turbulence together.
        better = checks(
            field, lambda wind=wind, name=name, value=value: replace(wind, **{name: value}).checked(airspeed)
        )
        wind = wind if better is None else better
    return wind


def _camera(state: FormState, checks: _Checks) -> Any:
    from ...core.geodesy.camera import Camera

    ratio = checks.number("aspect", tr("aspect ratio"), state.aspect, parse_aspect)
    if ratio is not None:
        checks("aspect", lambda: Camera(aspect_ratio=ratio))
        if ratio > 0.0 and not _ASPECTS[0] <= ratio <= _ASPECTS[1]:
            checks.messages["aspect"] = tr("aspect ratio “{text}”: must be from {least} to {most}").format(
                text=state.aspect.strip(), least=number_text(_ASPECTS[0], "g"), most=number_text(_ASPECTS[1], "g")
            )
    sound = ratio is not None and "aspect" not in checks.messages
    field = {DIAGONAL: "fov_deg", SENSOR: "focal_length_mm"}.get(state.fov_mode, "fov_typed_deg")
    if state.fov_mode == SENSOR:
        size_mm = (state.sensor_width_mm, state.sensor_height_mm)
        # Check the sensor with a focal length that is certainly valid, so that an error is about the sensor.
        if checks("sensor_width_mm", lambda: Camera.from_sensor(size_mm, max(size_mm), ratio)) is None:
            return None
    checks(field, lambda: camera_as_typed(state, ratio if sound else 1.0))
    if state.height_by == "gsd" and not state.camera_gsd > 0.0:
        checks.messages["camera_gsd"] = tr("GSD: must be above 0")
    # Use the stored diagonal: recomputed from the typed numbers, its last digits may differ.
    if not sound or field in checks.messages:
        return None
    if checks(field, lambda: Camera(state.fov_deg, ratio)) is None:
        return None
    for name in LENS_FIELDS:
        checks(name, partial(_check, name, getattr(state, name)))
    return checks("k1", lambda: Camera(state.fov_deg, ratio, **lens_values(state)))


def _box(state: FormState, checks: _Checks) -> Box | None:
    from ...core.mission.areas.area import Box, check_lat_lon

    names = {
        "north": tr("northern edge"),
        "west": tr("western edge"),
        "south": tr("southern edge"),
        "east": tr("eastern edge"),
    }
    edges: dict[str, float] = {}
    for field, what in names.items():
        text = getattr(state, field)
        value = checks.number(field, what, text, partial(edge_deg, field))
        if value is None:
            if looks_like_coordinates(text):
                checks.messages[field] = tr("coordinates are read when you leave the field")
            elif has_minutes(text):
                checks.messages[field] = tr("{what} “{text}”: minutes and seconds must be below 60").format(
                    what=what, text=text.strip()
                )
            continue
        edges[field] = value
        lat, lon = (value, 0.0) if field in ("north", "south") else (0.0, value)
        checks(field, lambda lat=lat, lon=lon: check_lat_lon(lat, lon))
    if len(edges) < len(names) or set(names) & set(checks.messages):
        return None
    return checks("south", lambda: Box(edges["north"], edges["west"], edges["south"], edges["east"]))


def mission_state(mission: Mission, folder: str, like: FormState | None = None) -> FormState:
    """State that gives ``mission``, in the units and modes of ``like``; by default in metres."""
    from ...core.imagery.opening import source_kind

    given = {name: value for part in FLAT_PARTS for name, value in vars(getattr(mission, part)).items()}
    first = mission.of_first_imagery.imagery
    given.update(source=first.source, date=first.date, map_types=first.map_types)
    given.update((name, getattr(mission.camera, name)) for name in LENS_FIELDS)
    state = FormState(
        fov_deg=mission.camera.fov_deg,
        **_pixel_entries(mission),
        aspect=aspect_text(mission.camera.aspect_ratio),
        agl=mission.flight.agl_m,
        folder=folder,
        no_fly=no_fly_text(mission.no_fly),
        takeoff=takeoff_text(mission.route.takeoff),
        imageries=mission.imagery.imageries[1:],
        imagery_name=_own_name(mission),
        **{name: given[name] for name in ENTERED_AS_DECLARED},
    )
    if source_kind(first.source).is_address:
        state = replace(state, source=URL_TEMPLATE, template=first.source)
    if mission.wind is not None:
        state = replace(
            state,
            wind=True,
            wind_speed_m_per_s=mission.wind.speed_m_per_s,
            wind_from_deg=mission.wind.from_deg,
            turbulence=mission.wind.turbulence,
            wind_seed=None if mission.wind.seed == mission.imagery.seed else mission.wind.seed,
        )
    state = replace_box(state, mission.area.bounds, exact_degrees_text)
    state = replace(state, shape=shape_text(mission.area, state.agl_m))
    return state if like is None else in_length_unit(convert_camera(state, like.fov_mode), like.agl_unit)


def _own_name(mission: Mission) -> str:
    """Name of the first of several imageries; empty if the panel gives it the same."""
    from ...core.mission.imageries import NamedImagery

    first, *others = mission.imagery.named or (None,)
    if first is None:
        return ""
    usual = NamedImagery.unnamed(first.source, first.date, first.map_type)
    return "" if others and first == usual else first.name


def _pixel_entries(mission: Mission) -> dict[str, Any]:
    """Entries for the resolution and size of a mission's images."""
    entries: dict[str, Any] = {}
    if mission.pixels.zoom is not None:
        entries.update(resolution="zoom", zoom=mission.pixels.zoom)
    if mission.pixels.gsd_m_per_px is not None:
        entries.update(resolution="gsd", gsd_m_per_px=mission.pixels.gsd_m_per_px)
    if mission.output.img_size is not None:
        width, height, channels = mission.output.img_size
        entries.update(resize=True, resize_width_px=width, resize_height_px=height, resize_grey=channels == 1)
    return entries


def extras_text(state: FormState) -> str:
    """Titles and values of the fields without entries in the panel that differ from their defaults."""
    extras = ((ENTERED_AS_DECLARED[name], getattr(state, name)) for name in WITHOUT_ENTRY)
    return ", ".join(f"{translate(field.title)}: {value}" for field, value in extras if value != field.default)


def drop_extras(state: FormState) -> FormState:
    """State with defaults for the fields without entries in the panel."""
    return replace(state, wind_seed=None, **{name: ENTERED_AS_DECLARED[name].default for name in WITHOUT_ENTRY})
