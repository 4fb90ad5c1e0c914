"""The entries of the camera chooser: cameras by name, and the user's own."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ...core.errors import InvalidInput
from ..form.camera import camera_of
from ..form.state import SENSOR, FormState
from ..i18n import number_text, told, tr
from .choices import CameraChoice

if TYPE_CHECKING:
    from ...core.mission.presets import CameraPreset

#: Largest number that the parts of an aspect ratio are written with; beyond, it is written as it is.
_MOST_IN_RATIO = 10_000


def camera_choices() -> tuple[list[CameraChoice], str]:
    """Entries of the camera chooser, the paper's camera first; and what is wrong with the user's own cameras."""
    from ...core.mission.presets import camera_shelf, shipped_cameras

    own: tuple[CameraPreset, ...] = ()
    try:
        own, problems = camera_shelf()
        wrong = "; ".join(map(told, problems.values()))
    except InvalidInput as unreadable:
        wrong = told(unreadable)
    return [_choice(preset) for preset in (*shipped_cameras(), *own)], wrong


def save_camera(name: str, state: FormState) -> None:
    """Keep the camera that is entered under a name.

    Raises
    ------
    InvalidInput
        No name, one that is taken, or entries that make no camera.
    OutputError
        The file of own cameras cannot be written.
    """
    from ...core.mission.presets import add_camera

    camera = camera_of(state)
    if camera is None:
        raise InvalidInput(tr("The values entered make no camera: put right what is marked, and save then."))
    fraction = Fraction(camera.aspect_ratio).limit_denominator(_MOST_IN_RATIO)
    exact = fraction.numerator / fraction.denominator == camera.aspect_ratio
    ratio = [fraction.numerator, fraction.denominator] if exact else [camera.aspect_ratio, 1]
    facts: dict[str, Any] = {"fov_deg": camera.fov_deg}
    if state.fov_mode == SENSOR:
        size_mm = [state.sensor_width_mm, state.sensor_height_mm]
        facts = {"sensor_mm": size_mm, "focal_length_mm": state.focal_length_mm}
    add_camera(name.strip(), {**facts, "aspect_ratio": ratio, "image_px": state.image_px})


def forget_camera(name: str) -> None:
    """Remove one of the user's own cameras; raises InvalidInput or OutputError."""
    from ...core.mission.presets import remove_camera

    remove_camera(name)


def _choice(preset: CameraPreset) -> CameraChoice:
    camera = preset.camera
    lines = [
        tr("{name}: {degrees}° across the diagonal").format(
            name=preset.name, degrees=number_text(camera.fov_deg, ".1f")
        )
    ]
    if preset.width_px is not None and preset.height_px is not None:
        lines.append(
            tr("The real camera's pictures: {width} × {height} px").format(
                width=preset.width_px, height=preset.height_px
            )
        )
    if preset.sensor_mm is not None:
        lines.append(
            tr("Sensor {width} × {height} mm, focal length {focal} mm").format(
                width=number_text(preset.sensor_mm[0], "g"),
                height=number_text(preset.sensor_mm[1], "g"),
                focal=number_text(preset.focal_length_mm, "g"),
            )
        )
    if preset.source:
        lines.append(tr("Source: {source}").format(source=preset.source))
    return CameraChoice(
        preset.name,
        camera.fov_deg,
        camera.aspect_ratio,
        preset.sensor_mm,
        preset.image_px,
        "\n".join(lines),
        preset.user,
    )
