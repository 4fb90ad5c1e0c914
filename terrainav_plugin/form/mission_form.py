"""The mission that the dock's entries ask for, and the entries that ask for a mission. Knows no widget."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from ...core.errors import InvalidInput
from ..i18n import number_text, tr, translate
from .area import FormError, entered_shape, shape_text, with_box
from .camera import camera_as_typed, given_by, in_length_unit
from .state import DIAGONAL, SENSOR, URL_TEMPLATE, FormState
from .text import aspect_text, exact_degrees_text, parse_aspect, parse_number

if TYPE_CHECKING:
    from ...core.mission.area import Area, Box
    from ...core.mission.mission import Mission

#: Fields of a mission that are entries of the same name, each with messages of its own.
_SAME = (
    *(
        "overlap_along",
        "overlap_across",
        "layout",
        "grid_angle_deg",
        "crosshatch",
        "order",
        "airspeed_m_per_s",
    ),
    *("map_types", "date", "image_format", "image_px", "upsample"),
    *("yaw_deg", "tilt_deg", "roll_deg", "ground_height_m", "start"),
    *("error_budget_px", "accept_error", "frame", "resampling"),
)
#: Entries of the other fields that a message may be about.
_ENTRIES = {
    "area": "north",
    "agl_m": "agl",
    "camera": "fov_deg",
    "img_size": "resize_width_px",
    "wind": "turbulence",
}
#: All that the dock has entries for; other fields it carries along.
_ENTERED = {
    *_SAME,
    *("area", "agl_m", "camera", "source", "zoom", "gsd_m_per_px", "max_px", "img_size", "wind"),
}


class _Checks:
    """Runs the core's own checks field by field and keeps their messages."""

    def __init__(self) -> None:
        self.messages: dict[str, str] = {}

    def __call__(self, field: str, check: Callable[[], Any]) -> Any:
        from ...core.errors import TerrAInavError

        try:
            return check()
        except TerrAInavError as wrong:
            self.messages.setdefault(field, translate(wrong))
        return None

    def number(self, field: str, what: str, text: str, parse: Callable[[str], float]) -> float | None:
        try:
            return parse(text)
        except ValueError:
            self.messages[field] = tr("{what} “{text}”: must be a number").format(
                what=what, text=text.strip()
            )
        return None


def mission(state: FormState) -> Mission:
    """Mission that a state asks for.

    Raises
    ------
    FormError
        With the core's message at every field that is wrong.
    """
    checks = _Checks()
    area = _box(state, checks)
    shape = checks("shape", lambda: entered_shape(state))
    return _mission(state, area if shape is None else shape, checks)


def test_shot(state: FormState, lat_deg: float, lon_deg: float) -> Mission:
    """Mission of one picture above a point, otherwise as entered; raises FormError as `mission` does."""
    from ...core.mission.area import Points

    checks = _Checks()
    single = replace(state, map_types=state.map_types[:1])
    return _mission(single, checks("agl", lambda: Points(((lat_deg, lon_deg, state.agl_m),))), checks)


def box(state: FormState) -> Box | None:
    """Area that a state holds; None where it holds no sound one."""
    return _box(state, _Checks()) if state.has_box else None


def with_folder(state: FormState, folder: str) -> FormState:
    """State with another folder."""
    return replace(state, folder=folder)


def _mission(state: FormState, area: Area | None, checks: _Checks) -> Mission:
    from ...core.mission.area import check_agl

    state = state.asked_for
    camera = _camera(state, checks)
    if state.agl_m > 0.0:
        checks("agl", lambda: check_agl(state.agl_m))
    else:
        checks.messages["agl"] = tr("height above ground {height} {unit}: must be above 0").format(
            height=number_text(state.agl, "g"), unit=state.agl_unit
        )
    for name in ("overlap_along", "overlap_across"):
        if not 0.0 <= getattr(state, name) < 1.0:
            text = tr("overlap {percent} %: must be at least 0 and below 100 %")
            checks.messages[name] = text.format(percent=number_text(100.0 * getattr(state, name), "g"))
    entries = {name: getattr(state, name) for name in _SAME}
    entries.update(source=state.source_name, **_pixels(state))
    beyond = checks("more", lambda: _beyond(state))
    if beyond is not None:
        for name, value in entries.items():
            field = _ENTRIES.get(name, name)
            checks(field, lambda name=name, value=value: beyond.with_(**{name: value}))
        entries["wind"] = _wind(state, beyond, checks)
    if checks.messages:
        raise FormError(checks.messages)
    try:
        return beyond.with_(area=area, agl_m=state.agl_m, camera=camera, **entries)
    except InvalidInput as wrong:
        # Entries that are right one by one, and do not go together.
        raise FormError({entry_of(wrong.field) or "more": translate(wrong)}) from wrong


def _pixels(state: FormState) -> dict[str, Any]:
    """Fields of a mission that say which pixels of the source are taken, and to what size."""
    channels = 1 if state.resize_grey else 3
    return {
        "zoom": state.zoom if state.resolution == "zoom" else None,
        "gsd_m_per_px": state.gsd_m_per_px if state.resolution == "gsd" else None,
        "max_px": state.max_px or None,
        "img_size": (state.resize_width_px, state.resize_height_px, channels) if state.resize else None,
    }


def entry_of(field: str) -> str:
    """Entry in which a field of a mission is put right; empty where there is none."""
    known = {entry.name for entry in fields(FormState)}
    entry = _ENTRIES.get(field, field)
    return entry if entry in known else ""


def _beyond(state: FormState) -> Mission:
    """A mission with what the dock has no entry for; raises InvalidInput."""
    from ...core.mission.mission import SCHEMA, Mission

    anywhere = {"type": "box", "north_deg": 0.0, "west_deg": 0.0, "south_deg": 0.0, "east_deg": 0.0}
    return Mission.from_dict({"schema": SCHEMA, "area": anywhere, "agl_m": 1.0, **state.beyond_entries})


def _wind(state: FormState, beyond: Mission, checks: _Checks) -> Any:
    """Wind that is entered, checked entry by entry; None for none."""
    from ...core.mission.wind import Wind

    if not state.wind:
        return None
    seed = beyond.seed if beyond.wind is None else beyond.wind.seed
    airspeed = beyond.airspeed_m_per_s if "airspeed_m_per_s" in checks.messages else state.airspeed_m_per_s
    entries = {
        "wind_from_deg": ("from_deg", state.wind_from_deg),
        "wind_speed_m_per_s": ("speed_m_per_s", state.wind_speed_m_per_s),
        "turbulence": ("turbulence", state.turbulence),
    }
    wind = Wind(seed=seed)
    for field, (name, value) in entries.items():
        # Each on top of those that are right already; speed and turbulence are judged by the airspeed.
        better = checks(
            field, lambda wind=wind, name=name, value=value: replace(wind, **{name: value}).flown_at(airspeed)
        )
        wind = wind if better is None else better
    return wind


def _camera(state: FormState, checks: _Checks) -> Any:
    from ...core.geodesy.camera import Camera

    ratio = checks.number("aspect", tr("aspect ratio"), state.aspect, parse_aspect)
    if ratio is not None:
        checks("aspect", lambda: Camera(aspect_ratio=ratio))
    sound = ratio is not None and "aspect" not in checks.messages
    field = {DIAGONAL: "fov_deg", SENSOR: "focal_length_mm"}.get(state.fov_mode, "fov_typed_deg")
    if state.fov_mode == SENSOR:
        size_mm = (state.sensor_width_mm, state.sensor_height_mm)
        # With a lens that suits it, so that what is wrong is the sensor.
        if checks("sensor_width_mm", lambda: Camera.from_sensor(size_mm, max(size_mm), ratio)) is None:
            return None
    checks(field, lambda: camera_as_typed(state, ratio if sound else 1.0))
    if state.height_by == "gsd" and not state.camera_gsd > 0.0:
        checks.messages["camera_gsd"] = tr("ground per px: must be above 0")
    # The diagonal itself, which the numbers typed may stand for with other digits.
    return (
        checks(field, lambda: Camera(state.fov_deg, ratio))
        if sound and field not in checks.messages
        else None
    )


def _box(state: FormState, checks: _Checks) -> Box | None:
    from ...core.mission.area import Box, check_lat_lon

    names = {
        "north": tr("northern edge"),
        "west": tr("western edge"),
        "south": tr("southern edge"),
        "east": tr("eastern edge"),
    }
    edges: dict[str, float] = {}
    for field, what in names.items():
        value = checks.number(field, what, getattr(state, field), parse_number)
        if value is None:
            continue
        edges[field] = value
        lat, lon = (value, 0.0) if field in ("north", "south") else (0.0, value)
        checks(field, lambda lat=lat, lon=lon: check_lat_lon(lat, lon))
    if len(edges) < len(names) or set(names) & set(checks.messages):
        return None
    return checks("south", lambda: Box(edges["north"], edges["west"], edges["south"], edges["east"]))


def state_of(mission: Mission, folder: str, like: FormState | None = None) -> FormState:
    """State that asks for ``mission`` again, in the unit and the terms of another state; otherwise in metres."""
    from ...core.imagery.opening import is_address

    state = FormState(
        fov_deg=mission.camera.fov_deg,
        **_pixel_entries(mission),
        aspect=aspect_text(mission.camera.aspect_ratio),
        agl=float(mission.agl_m),
        source=mission.source,
        folder=folder,
        more=_more(mission),
        **{name: getattr(mission, name) for name in _SAME},
    )
    if is_address(mission.source):
        state = replace(state, source=URL_TEMPLATE, template=mission.source)
    if mission.wind is not None:
        state = replace(
            state,
            wind=True,
            wind_speed_m_per_s=mission.wind.speed_m_per_s,
            wind_from_deg=mission.wind.from_deg,
            turbulence=mission.wind.turbulence,
        )
    # A mission file may write 90 for 90.0.
    floats = {f.name: float(getattr(state, f.name)) for f in fields(state) if f.type == "float"}
    state = with_box(replace(state, **floats), mission.area.bounds, exact_degrees_text)
    state = replace(state, shape=shape_text(mission.area, state.agl_m))
    return state if like is None else in_length_unit(given_by(state, like.fov_mode), like.agl_unit)


def _pixel_entries(mission: Mission) -> dict[str, Any]:
    """Entries that ask for a mission's pixels."""
    entries: dict[str, Any] = {"max_px": mission.max_px or 0}
    if mission.zoom is not None:
        entries.update(resolution="zoom", zoom=mission.zoom)
    if mission.gsd_m_per_px is not None:
        entries.update(resolution="gsd", gsd_m_per_px=mission.gsd_m_per_px)
    if mission.img_size is not None:
        width, height, channels = mission.img_size
        entries.update(resize=True, resize_width_px=width, resize_height_px=height, resize_grey=channels == 1)
    return entries


def _more(mission: Mission) -> str:
    """What ``mission`` says beyond the entries, as JSON; empty for nothing."""
    from ...core.mission.area import Box
    from ...core.mission.mission import Mission

    plain = Mission(area=Box(0.0, 0.0, 0.0, 0.0), agl_m=1.0)
    data = mission.to_dict()
    more = {
        f.name: data[f.name]
        for f in fields(Mission)
        if f.name not in _ENTERED and getattr(mission, f.name) != getattr(plain, f.name)
    }
    if mission.wind is not None and mission.wind.seed != mission.seed:
        more["wind"] = {"seed": mission.wind.seed}
    return json.dumps(more) if more else ""


def beyond_text(state: FormState) -> str:
    """What a state's mission says beyond the entries, in words; empty for nothing."""
    words = []
    for name, value in state.beyond_entries.items():
        if name != "wind":
            text = " × ".join(map(str, value)) if isinstance(value, list) else str(value)
            words.append(f"{name.replace('_', ' ')}: {text}")
    return ", ".join(words)
