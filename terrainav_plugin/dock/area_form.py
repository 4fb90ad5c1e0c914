"""The area of a form's state, read and entered. Knows no widget."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from ...core.errors import TerrAInavError
from ...core.mission.area import Area, Box, Points, Polygon
from ..i18n import told, tr
from .area_shape import area_at, shape_of, shape_text
from .area_text import area_of_text
from .form_state import BOX_FIELDS, M_PER_FT, FormState
from .form_text import degrees_text, exact_degrees_text, parse_number


class FormError(Exception):
    """Entries that make no mission: a message for every field that is wrong."""

    def __init__(self, messages: dict[str, str]) -> None:
        super().__init__("; ".join(messages.values()))
        self.messages = messages


def with_box(state: FormState, box: Box, text: Callable[[float], str] = degrees_text) -> FormState:
    """State with the edges of ``box``."""
    return replace(state, shape="", **_edges(box, text))


def with_area(state: FormState, area: Area, agl_m: float | None = None) -> FormState:
    """State with another area, and with its height above ground in metres where it has one."""
    if agl_m is not None and agl_m != state.agl_m:
        agl = agl_m / M_PER_FT if state.agl_unit == "ft" else agl_m
        state = replace(state, agl=agl, height_by="agl", camera_gsd=0.0)
    if isinstance(area, Box):
        return with_box(state, area)
    state = with_box(state, area.bounds, exact_degrees_text)
    return replace(state, shape=shape_text(area, state.agl_m))


def with_coordinates(state: FormState, text: str) -> FormState:
    """State with pasted coordinates, heights in the state's unit; `area_of_text` says what is understood.

    Raises
    ------
    FormError
        For the field ``north``, with what is wrong.
    """
    try:
        return with_area(state, *area_of_text(text, state.agl, state.agl_unit))
    except TerrAInavError as wrong:
        raise FormError({"north": told(wrong)}) from wrong


def entered_shape(state: FormState) -> Polygon | Points | None:
    """Polygon or points that are entered, at the height that is; None where the area is a box.

    Raises
    ------
    InvalidInput
        Where the state's text of them cannot be read.
    """
    if not state.shape:
        return None
    bounds = shape_of(state.shape).bounds
    # Edges that are not those around it have been entered since, and make the area a box.
    edges = _edges(bounds, exact_degrees_text)
    if any(getattr(state, name) != text for name, text in edges.items()):
        return None
    return area_at(state.shape, state.agl_m)


def entered_area(state: FormState) -> Area | None:
    """Area that is entered; None where there is none, or no sound one."""
    try:
        shape = entered_shape(state)
        if shape is not None:
            return shape
        return Box(*(parse_number(getattr(state, name)) for name in BOX_FIELDS))
    except (TerrAInavError, ValueError):
        return None


def unit_of(state: FormState) -> tuple[float, str]:
    """Metres in the unit of heights, and its name."""
    return (M_PER_FT, tr("ft")) if state.agl_unit == "ft" else (1.0, tr("m"))


def _edges(box: Box, text: Callable[[float], str]) -> dict[str, str]:
    degrees = (box.north_deg, box.west_deg, box.south_deg, box.east_deg)
    return dict(zip(BOX_FIELDS, map(text, degrees)))
