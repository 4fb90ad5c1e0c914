"""Summaries of the groups of entries, shown next to the titles of folded groups."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

from ...core.fields import declared_fields, field_named
from ...core.geodesy.lens import LENS_FIELDS, Lens
from ...core.mission.parts import FLAT_PARTS, REALISM_PARTS
from ..i18n import number_text, tr, translate
from ..units import gsd_text, length_text
from .area import describe_area, entered_area
from .state import DECLARED, SENSOR, FormState
from .text import short_aspect


def headings(state: FormState, source: str) -> dict[str, str]:
    """Summary of every group, by its name.

    Parameters
    ----------
    source : str
        Title of the source.
    """
    return {
        "area_group": _area(state),
        "camera_group": _camera(state),
        "flight": _flight(state),
        "imagery_group": _joined(source, state.date),
        "output": _joined(Path(state.folder).name, _choice(state, "image_format").partition(" (")[0]),
        "attitude": _attitude(state),
        "route": _route(state),
        "relief": ", ".join(state.elevation) or tr("level ground"),
        "labels": _joined(*map(_file_name, (*state.labels, *state.buildings))) or tr("none"),
        "realism": ", ".join(_changed_titles(state, REALISM_PARTS)) or tr("ideal camera"),
        "pixels": _pixels(state),
        "wind": _wind(state),
        "accuracy": _joined(
            tr("{budget} px").format(budget=_number(state.error_budget_px)),
            _changed_choice(state, "frame").partition(" (")[0],
        ),
    }


def _file_name(text: str) -> str:
    """Name of a file, without its folder, and with its layer and field."""
    return re.split(r"[/\\]", text)[-1]


def _area(state: FormState) -> str:
    area = entered_area(state)
    return tr("none yet") if area is None else describe_area(area, state.agl_unit)


def _camera(state: FormState) -> str:
    shape = short_aspect(state.aspect)
    if state.fov_mode == SENSOR:
        return _joined(tr("{length} mm").format(length=_number(state.focal_length_mm)), shape)
    return _joined(_degrees(state.fov_deg), shape)


def _flight(state: FormState) -> str:
    along, across = (100.0 * share for share in (state.overlap_along, state.overlap_across))
    both = _number(along) if along == across else f"{_number(along)}/{_number(across)}"
    overlap = tr("overlap {share} %").format(share=both) if along or across else tr("no overlap")
    crosshatch = translate(DECLARED["crosshatch"].title) if state.crosshatch else ""
    return _joined(f"{_number(state.agl)} {state.agl_unit}", overlap, crosshatch)


def _attitude(state: FormState) -> str:
    turned = (
        (tr("yaw {angle}"), state.yaw_deg),
        (tr("tilt {angle}"), state.tilt_deg),
        (tr("roll {angle}"), state.roll_deg),
    )
    words = [text.format(angle=_degrees(value)) for text, value in turned if value]
    return _joined(
        *(words or [tr("straight down")]),
        tr("ground at {height}").format(height=length_text(state.ground_height_m, state.agl_unit))
        if state.ground_height_m
        else "",
        "" if state.start == DECLARED["start"].default else state.start,
    )


def _route(state: FormState) -> str:
    battery = tr("sorties of {minutes} min")
    lengths = (
        (tr("lead-in {length}"), state.lead_in_m),
        (tr("turnaround {length}"), state.turnaround_m),
    )
    return _joined(
        tr("from the take-off point") if state.takeoff.strip() else tr("first to last capture"),
        *(_changed_choice(state, name) for name in ("entry", "trigger")),
        *(text.format(length=length_text(value, state.agl_unit)) for text, value in lengths if value),
        battery.format(minutes=_number(state.battery_min)) if state.battery_min else "",
    )


def _pixels(state: FormState) -> str:
    ways = {
        "zoom": tr("zoom {zoom}").format(zoom=state.zoom),
        "gsd": gsd_text(state.gsd_m_per_px, state.agl_unit) if state.gsd_m_per_px > 0.0 else "",
    }
    size = tr("{width} × {height} px").format(
        width=number_text(state.resize_width_px), height=number_text(state.resize_height_px)
    )
    return _joined(ways.get(state.resolution, tr("automatic")), size if state.resize else "")


def _wind(state: FormState) -> str:
    if not state.wind:
        return tr("off")
    return tr("{speed} m/s from {angle}").format(
        speed=_number(state.wind_speed_m_per_s), angle=_degrees(state.wind_from_deg)
    )


def _choice(state: FormState, name: str) -> str:
    return translate(DECLARED[name].choices.get(getattr(state, name), ""))


def _changed_choice(state: FormState, name: str) -> str:
    """Title of the choice in the entry ``name``; empty for the default."""
    return "" if getattr(state, name) == DECLARED[name].default else _choice(state, name)


def _changed_titles(state: FormState, parts: Iterable[str]) -> list[str]:
    """Titles of the fields of a lens, as one, and of parts that differ from their defaults."""
    lens = (
        field_named(Lens, "lens").title if any(getattr(state, one) != getattr(Lens, one) for one in LENS_FIELDS) else ""
    )
    changed = (one for part in parts for one in declared_fields(FLAT_PARTS[part]))
    titles = [one.title for one in changed if getattr(state, one.name) != one.default]
    return [translate(title) for title in (lens, *titles) if title]


def _number(value: float) -> str:
    return number_text(value, ".4g") if abs(value) < 1e4 else number_text(value, ",.0f")


def _degrees(value: float) -> str:
    return f"{_number(value)}°"


def _joined(*words: str) -> str:
    return ", ".join(_filled(words))


def _filled(words: Iterable[str]) -> list[str]:
    return [word for word in words if word]
