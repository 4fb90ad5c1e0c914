"""The mission that the dock's entries ask for, and the entries that ask for a mission. Knows no widget."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from ..i18n import tr
from .form_state import BOX_FIELDS, URL_TEMPLATE, FormState
from .form_text import (
    SEPARATORS,
    aspect_text,
    degrees_text,
    exact_degrees_text,
    parse_aspect,
    parse_number,
)

if TYPE_CHECKING:
    from ...core.mission.area import Area, Box
    from ...core.mission.mission import Mission

#: Fields of a mission that the dock has entries for; all others it carries along.
_ENTERED = {
    "area",
    "agl_m",
    "camera",
    "overlap_along",
    "overlap_across",
    "layout",
    "map_types",
    "source",
    "date",
    "image_format",
    "yaw_deg",
    "tilt_deg",
    "roll_deg",
    "ground_height_m",
    "error_budget_px",
    "accept_error",
    "frame",
    "resampling",
    "wind",
}
#: Of those, the ones that are the same in both, each with messages of its own.
_SAME = (
    "overlap_along",
    "overlap_across",
    "layout",
    "map_types",
    "date",
    "image_format",
    "yaw_deg",
    "tilt_deg",
    "roll_deg",
    "ground_height_m",
    "error_budget_px",
    "accept_error",
    "frame",
    "resampling",
)


class FormError(Exception):
    """Entries that make no mission: a message for every field that is wrong."""

    def __init__(self, messages: dict[str, str]) -> None:
        super().__init__("; ".join(messages.values()))
        self.messages = messages


def with_box(state: FormState, box: Box, text: Callable[[float], str] = degrees_text) -> FormState:
    """State with the edges of ``box``."""
    return replace(
        state,
        north=text(box.north_deg),
        west=text(box.west_deg),
        south=text(box.south_deg),
        east=text(box.east_deg),
    )


def with_coordinates(state: FormState, text: str) -> FormState:
    """State with pasted coordinates: ``north_west_south_east_agl``, the height in the state's unit.

    Commas and spaces do as well as underscores, and the height may be left out.

    Raises
    ------
    FormError
        For the field ``north``, with what is wrong.
    """
    from ...core.errors import TerrAInavError
    from ...core.mission.area import Box
    from ...core.mission.coords import parse_coords

    parts = SEPARATORS.split(text.strip())
    if len(parts) == len(BOX_FIELDS):
        parts.append(repr(state.agl))
    try:
        area, agl = parse_coords("_".join(parts))
    except TerrAInavError as wrong:
        raise FormError({"north": str(wrong)}) from wrong
    if not isinstance(area, Box):
        where = tr("“{text}” is a point: the area needs north_west_south_east_agl")
        raise FormError({"north": where.format(text=text.strip())})
    return replace(with_box(state, area), agl=agl)


class _Checks:
    """Runs the core's own checks field by field and keeps their messages."""

    def __init__(self) -> None:
        self.messages: dict[str, str] = {}

    def __call__(self, field: str, check: Callable[[], Any]) -> Any:
        from ...core.errors import TerrAInavError

        try:
            return check()
        except TerrAInavError as wrong:
            self.messages.setdefault(field, str(wrong))
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
    carried = _carried_area(state)
    return _mission(state, area if carried is None else carried, checks)


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

    camera = _camera(state, checks)
    checks("agl", lambda: check_agl(state.agl_m))
    entries = {name: getattr(state, name) for name in _SAME}
    entries["source"] = state.source_name
    beyond = checks("more", lambda: _beyond(state))
    if beyond is not None:
        for name, value in entries.items():
            checks(name, lambda name=name, value=value: beyond.with_(**{name: value}))
        entries["wind"] = _wind(state, beyond, checks)
    if checks.messages:
        raise FormError(checks.messages)
    return beyond.with_(area=area, agl_m=state.agl_m, camera=camera, **entries)


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
    entries = {
        "airspeed_m_per_s": state.airspeed_m_per_s,
        "wind_from_deg": state.wind_from_deg,
        "wind_speed_m_per_s": state.wind_speed_m_per_s,
        "turbulence": state.turbulence,
    }
    wind = Wind(seed=seed)
    for field, value in entries.items():
        # Each on top of those that are right already; speed and turbulence are judged by the airspeed.
        name = {"wind_from_deg": "from_deg", "wind_speed_m_per_s": "speed_m_per_s"}.get(field, field)
        better = checks(field, lambda wind=wind, name=name, value=value: replace(wind, **{name: value}))
        wind = wind if better is None else better
    return wind


def _camera(state: FormState, checks: _Checks) -> Any:
    from ...core.geodesy.camera import Camera

    checks("fov_deg", lambda: Camera(fov_deg=state.fov_deg))
    ratio = checks.number("aspect", tr("aspect ratio"), state.aspect, parse_aspect)
    if ratio is not None:
        checks("aspect", lambda: Camera(aspect_ratio=ratio))
    if "fov_deg" in checks.messages or "aspect" in checks.messages:
        return None
    return Camera(state.fov_deg, ratio)


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


def _carried_area(state: FormState) -> Area | None:
    """Polygon or points that the box entered stands for; None where another box has been entered since."""
    from ...core.mission.area import Box, Points

    beyond = _Checks()("more", lambda: _beyond(state))
    if "area" not in state.beyond_entries or beyond is None or isinstance(beyond.area, Box):
        return None
    area = beyond.area
    if with_box(state, bounds_of(area), exact_degrees_text) != state:
        return None
    if isinstance(area, Points) and state.agl_m != beyond.agl_m and state.agl_m > 0.0:
        area = Points(tuple((lat, lon, state.agl_m) for lat, lon, _ in area.poses))
    return area


def state_of(mission: Mission, folder: str) -> FormState:
    """State that asks for ``mission`` again; heights in metres."""
    from ...core.imagery.opening import is_template
    from ...core.imagery.services.ogc import is_service

    state = FormState(
        fov_deg=mission.camera.fov_deg,
        aspect=aspect_text(mission.camera.aspect_ratio),
        agl=float(mission.agl_m),
        source=mission.source,
        folder=folder,
        more=_more(mission),
        **{name: getattr(mission, name) for name in _SAME},
    )
    if is_template(mission.source) or is_service(mission.source):
        state = replace(state, source=URL_TEMPLATE, template=mission.source)
    if mission.wind is not None:
        state = replace(
            state,
            wind=True,
            wind_speed_m_per_s=mission.wind.speed_m_per_s,
            wind_from_deg=mission.wind.from_deg,
            turbulence=mission.wind.turbulence,
            airspeed_m_per_s=mission.wind.airspeed_m_per_s,
        )
    # A mission file may write 90 for 90.0.
    floats = {f.name: float(getattr(state, f.name)) for f in fields(state) if f.type == "float"}
    return with_box(replace(state, **floats), bounds_of(mission.area), exact_degrees_text)


def bounds_of(area: Area) -> Box:
    """Smallest box around an area, points included."""
    from ...core.geodesy.mercator import wrap_lon_deg
    from ...core.mission.area import Box, Points

    if not isinstance(area, Points):
        return area.bounds
    lat, lon, _ = zip(*area.poses)
    # Away from the first point, so that points on either side of the antimeridian are neighbours.
    away = [float(wrap_lon_deg(value - lon[0])) for value in lon]
    west, east = (
        value if abs(value) <= 180.0 else float(wrap_lon_deg(value))
        for value in (lon[0] + min(away), lon[0] + max(away))
    )
    return Box(max(lat), west, min(lat), east)


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
    if not isinstance(mission.area, Box):
        more.update(area=data["area"], agl_m=mission.agl_m)
    return json.dumps(more) if more else ""


def beyond_text(state: FormState) -> str:
    """What a state's mission says beyond the entries, in words; empty for nothing."""
    words = []
    for name, value in state.beyond_entries.items():
        if name == "area":
            if _carried_area(state) is not None:
                words.append(tr("area: {kind}").format(kind=value.get("type")))
        elif name not in ("agl_m", "wind"):
            text = " × ".join(map(str, value)) if isinstance(value, list) else str(value)
            words.append(f"{name.replace('_', ' ')}: {text}")
    return ", ".join(words)
