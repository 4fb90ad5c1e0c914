"""Presets in the panel: applied, undone, and recognised. No widgets."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from ...core.mission.mission import flat_fields
from ...core.mission.presets import CAMERA_KINDS, PRESETS, Preset, camera_kind_values
from ..i18n import tr, translate
from .camera import CAMERA_ENTRIES, settled, update_height
from .state import ENTERED_AS_DECLARED, FormState
from .text import aspect_text


def apply_preset(state: FormState, preset: Preset, offered: Collection[str] = ()) -> FormState:
    """State with the values of a preset.

    Parameters
    ----------
    offered : collection of str
        Map types of the source; empty if the source accepts any.
    """
    entries = _entries(preset, offered)
    aspect = entries.pop("aspect", state.aspect)
    state = replace(state, **entries)
    return state if aspect == state.aspect else settled(state, replace(state, aspect=aspect), "aspect")


def without_preset(state: FormState, preset: Preset, before: FormState) -> FormState:
    """State in which the entries set by a preset are restored from ``before``."""
    entries = {name: getattr(before, name) for name in _entries(preset, ())}
    aspect = entries.pop("aspect", state.aspect)
    state = replace(state, **entries)
    return state if aspect == state.aspect else settled(state, replace(state, aspect=aspect), "aspect")


def with_camera_of(state: FormState, before: FormState) -> FormState:
    """State with the camera of ``before``."""
    return update_height(replace(state, **{name: getattr(before, name) for name in CAMERA_ENTRIES}))


def preset_changes(before: FormState, now: FormState, preset: Preset, camera: str = "") -> list[str]:
    """Titles of the values that a preset has changed, and the name of the ``camera`` that it has chosen, if any."""
    titles = {one.name: translate(one.title) for one in flat_fields()}
    names = [name for name in _entries(preset, ()) if getattr(before, name) != getattr(now, name)]
    shown = [titles.get(name, tr("size of the images")) for name in names]
    return list(dict.fromkeys([*shown, *([tr("camera {name}").format(name=camera)] if camera else ())]))


def find_preset(state: FormState, offered: Collection[str] = ()) -> Preset | None:
    """Preset whose values are entered; None if there is none. ``offered`` is as in `apply_preset`."""
    return next((preset for preset in PRESETS if _has(state, _entries(preset, offered))), None)


def apply_camera_kind(state: FormState, preset: Preset) -> FormState:
    """State with the effects of a kind of camera, and no others."""
    return replace(state, **camera_kind_values(preset))


def find_camera_kind(state: FormState) -> Preset | None:
    """Kind of camera whose effects are entered; None if there is none."""
    return next((preset for preset in CAMERA_KINDS if apply_camera_kind(state, preset) == state), None)


def _has(state: FormState, entries: Mapping[str, Any]) -> bool:
    """Whether a state has these entries; the image size is compared only if images are resized."""
    size = ("resize_width_px", "resize_height_px", "resize_grey")
    return all(
        set(value) == set(state.map_types) if name == "map_types" else value == getattr(state, name)
        for name, value in entries.items()
        if state.resize or name not in size
    )


def _entries(preset: Preset, offered: Collection[str]) -> dict[str, Any]:
    """Entries of the panel that a preset sets."""
    values = dict(preset.values)
    entries: dict[str, Any] = {name: value for name, value in values.items() if name in ENTERED_AS_DECLARED}
    if "aspect_ratio" in values:
        entries["aspect"] = aspect_text(values["aspect_ratio"])
    if "img_size" in values:
        size = values["img_size"]
        entries["resize"] = size is not None
        if size is not None:
            width_px, height_px, channels = size
            entries.update(resize_width_px=width_px, resize_height_px=height_px, resize_grey=channels == 1)
    if offered:
        had = tuple(name for name in values["map_types"] if name in offered)
        entries["map_types"] = had or tuple(offered)[:1]
    elif len(values["map_types"]) > 1:
        # Any name would give the same images from a source of one kind: one is enough.
        entries["map_types"] = values["map_types"][:1]
    return entries
