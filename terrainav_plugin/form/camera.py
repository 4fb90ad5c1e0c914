"""Conversion of the camera entered between field of view, lens and sensor, and ground sample distance."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...core.geodesy.lens import LENS_FIELDS
from ...core.units import LENGTHS_M, M_PER_FT
from .state import DIAGONAL, HORIZONTAL, SENSOR, VERTICAL, FormState, in_metres
from .text import aspect_text, parse_aspect

if TYPE_CHECKING:
    from ...core.geodesy.camera import Camera

#: Width of a full-frame sensor, by which photographers compare lenses; assumed if the sensor is unknown.
FULL_FRAME_MM = 36.0
#: Metres per unit of ground sample distance, by the unit of lengths: cm with metres, inches with feet.
GSD_M = {"m": 0.01, "ft": M_PER_FT / 12.0}
#: Entries that determine the field of view, by camera mode.
_TYPED_FOR = {
    DIAGONAL: (),
    HORIZONTAL: ("fov_typed_deg",),
    VERTICAL: ("fov_typed_deg",),
    SENSOR: ("focal_length_mm", "sensor_width_mm", "sensor_height_mm"),
}
_NOTHING_TYPED = {
    "fov_typed_deg": 0.0,
    "focal_length_mm": 0.0,
    "sensor_width_mm": 0.0,
    "sensor_height_mm": 0.0,
}
#: All entries of the camera.
CAMERA_ENTRIES = ("fov_mode", "fov_deg", *_NOTHING_TYPED, "aspect", "image_px", *LENS_FIELDS)
#: Entries that, together with the height, determine the ground sample distance.
_CAMERA = {"fov_deg", "aspect", "lens", *_NOTHING_TYPED}


def state_camera(state: FormState) -> Camera | None:
    """Camera of a state; None if its entries are invalid."""
    from ...core.errors import InvalidInput
    from ...core.geodesy.camera import Camera

    try:
        return Camera(state.fov_deg, parse_aspect(state.aspect), **lens_values(state))
    except (ValueError, InvalidInput):
        return None


def lens_values(state: FormState) -> dict[str, Any]:
    """Fields of the lens of a state."""
    return {name: getattr(state, name) for name in LENS_FIELDS}


def camera_as_typed(state: FormState, aspect_ratio: float) -> Camera:
    """Camera from the numbers typed in the camera mode of a state.

    Raises
    ------
    InvalidInput
        A number is outside its domain.
    """
    from ...core.geodesy.camera import Camera

    if state.fov_mode == HORIZONTAL:
        return Camera.from_horizontal_fov(state.fov_typed_deg, aspect_ratio, state.lens)
    if state.fov_mode == VERTICAL:
        return Camera.from_vertical_fov(state.fov_typed_deg, aspect_ratio, state.lens)
    if state.fov_mode == SENSOR:
        size_mm = (state.sensor_width_mm, state.sensor_height_mm)
        return Camera.from_sensor(size_mm, state.focal_length_mm, aspect_ratio, state.lens)
    return Camera(state.fov_deg, aspect_ratio)


def convert_camera(state: FormState, mode: str, sensor_mm: tuple[float, float] | None = None) -> FormState:
    """State with the same camera in another mode, whose numbers are computed.

    Parameters
    ----------
    sensor_mm : (width, height) or None
        Sensor size of the camera; None for full frame.
    """
    plain = replace(state, fov_mode=mode, **_NOTHING_TYPED)
    camera = state_camera(state)
    if camera is None or mode == DIAGONAL:
        return plain
    if mode == HORIZONTAL:
        return replace(plain, fov_typed_deg=camera.horizontal_fov_deg)
    if mode == VERTICAL:
        return replace(plain, fov_typed_deg=camera.vertical_fov_deg)
    width_mm, height_mm = sensor_mm or (FULL_FRAME_MM, FULL_FRAME_MM / camera.aspect_ratio)
    # By the diagonal, as in `Camera.from_sensor`.
    half_mm = math.hypot(width_mm, height_mm) / 2.0
    focal_length_mm = half_mm / math.hypot(*camera.half_tangents)
    return replace(plain, focal_length_mm=focal_length_mm, sensor_width_mm=width_mm, sensor_height_mm=height_mm)


def shown_gsd(state: FormState) -> float:
    """Ground sample distance of the camera in the state's unit; 0 if its entries are invalid.

    It applies at the middle of a nadir image whose longer side has ``image_px`` pixels.
    """
    if state.height_by == "gsd":
        return state.camera_gsd
    camera = state_camera(state)
    if camera is None or not state.agl_m > 0.0 or state.image_px < 1:
        return 0.0
    return in_unit(camera.gsd_m_per_px(state.agl_m, state.image_px), GSD_M[state.agl_unit])


def settled(before: FormState, now: FormState, field: str) -> FormState:
    """State after a change of one entry, with dependent entries updated.

    Of height and ground sample distance, and of field of view and lens, the one typed is kept and the other computed.

    Parameters
    ----------
    before, now : FormState
        States before and after the change, which differ only in ``field``.
    """
    if field == "fov_mode":
        return convert_camera(_restore_fields(before, now, _CAMERA), now.fov_mode)
    if field == "agl_unit":
        return in_length_unit(_restore_fields(before, now, ("agl", "camera_gsd", field)), now.agl_unit)
    if field in ("sensor_width_mm", "sensor_height_mm"):
        now = _update_aspect(now)
    if field in _CAMERA:
        now = _update_diagonal(now)
    if field in _CAMERA or field in ("image_px", "camera_gsd", "agl"):
        now = update_height(now)
    return now


def in_length_unit(state: FormState, unit: str) -> FormState:
    """State with the same height and ground sample distance in another unit."""
    gsd = in_unit(in_metres(state.camera_gsd, GSD_M[state.agl_unit]), GSD_M[unit])
    return replace(state, agl=in_unit(state.agl_m, LENGTHS_M[unit]), camera_gsd=gsd, agl_unit=unit)


def update_height(state: FormState) -> FormState:
    """State with the height computed from the ground sample distance, if the latter was typed."""
    if state.height_by != "gsd":
        return state if state.camera_gsd == 0.0 else replace(state, camera_gsd=0.0)
    camera = state_camera(state)
    if camera is None or not state.camera_gsd > 0.0 or state.image_px < 1:
        return state
    agl_m = camera.agl_m(state.camera_gsd * GSD_M[state.agl_unit], state.image_px)
    return replace(state, agl=in_unit(agl_m, LENGTHS_M[state.agl_unit]))


def in_unit(value: float, unit: float) -> float:
    """Convert metres to a unit of ``unit`` metres.

    Return the shortest number that `in_metres` converts back exactly; the plain quotient if there is none.
    """
    if unit == 1.0:
        return value
    quotient = value / unit
    short = (float(f"{quotient:.{digits}g}") for digits in (6, 9, 12, 15, 16))
    return next((count for count in short if in_metres(count, unit) == value), quotient)


def _restore_fields(before: FormState, now: FormState, names: Iterable[str]) -> FormState:
    """State ``now`` with some fields restored from ``before``."""
    return replace(now, **{name: getattr(before, name) for name in names})


def _update_diagonal(state: FormState) -> FormState:
    """State with the diagonal field of view computed from the numbers typed; unchanged if they are invalid."""
    from ...core.errors import InvalidInput

    if not _TYPED_FOR[state.fov_mode]:
        return state
    try:
        return replace(state, fov_deg=camera_as_typed(state, parse_aspect(state.aspect)).fov_deg)
    except (ValueError, InvalidInput):
        return state


def _update_aspect(state: FormState) -> FormState:
    """State with the aspect ratio of its sensor; unchanged if both agree within the rounding of data sheets."""
    from ...core.geodesy.lens import SQUARE_PIXELS

    width_mm, height_mm = state.sensor_width_mm, state.sensor_height_mm
    if not (width_mm > 0.0 and height_mm > 0.0):
        return state
    ratio = width_mm / height_mm
    try:
        same = abs(ratio / parse_aspect(state.aspect) - 1.0) <= SQUARE_PIXELS
    except (ValueError, ZeroDivisionError):
        same = False
    # Twelve digits, so that 13.2 by 8.8 mm becomes 3:2.
    return state if same else replace(state, aspect=aspect_text(float(f"{ratio:.12g}")))
