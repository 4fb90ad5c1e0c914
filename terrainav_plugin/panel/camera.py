"""Entries of the camera: its name, its field of view in several modes, and the size of images."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QInputDialog, QMenu, QToolButton

from ...core.errors import InvalidInput, OutputError
from ...core.geodesy.lens import LENS_FIELDS, Lens
from ..form.camera import convert_camera, lens_values, state_camera, update_height
from ..form.state import DIAGONAL, HORIZONTAL, SENSOR, VERTICAL, FormState
from ..form.text import aspect_text, parse_aspect, short_aspect
from ..i18n import number_text, tr, translate
from ..plain import shown_plain
from ..settings import Settings
from ..widgets import FieldMarks, ShortLine, combo, named, row, spin, tool_button
from .choices import CameraChoice
from .entries import Entries

if TYPE_CHECKING:
    from ...core.mission.cameras import CameraPreset

#: Largest values of the spin boxes, beyond the valid ones: messages explain invalid values.
_DEGREES, _MM = 360.0, 1e6
#: Number of decimals in which the fields of view of equal cameras agree.
_SAME_DECIMALS = 6
_SENSOR = ("sensor_width_mm", "sensor_height_mm")


class CameraEntries(Entries):
    """Group of the camera.

    Signals
    -------
    chosen(object)
        The user has chosen a camera, a `CameraChoice`.
    """

    chosen = pyqtSignal(object)

    def __init__(self, marks: FieldMarks, cameras: Sequence[CameraChoice]) -> None:
        super().__init__("camera_group", tr("Camera"), marks)
        self._cameras = list(cameras)
        self._state = FormState()
        self._trouble = ""
        self._add_chooser()
        self._add_field_of_view()
        tip = tr("Width to height of the image, such as 4:3, 4000x3000 or 1.333")
        self.aspect = named(ShortLine(short_aspect), "aspect", tip)
        self.add("aspect", tr("Aspect ra&tio"), self.aspect)
        self.add_declared("image_px")
        self._fill_chooser()

    def values(self) -> dict[str, Any]:
        """Return the values of the entries; of field of view, lens and sensor, only those of the current mode."""
        values = super().values()
        mode = values["fov_mode"]
        hidden = [name for name in ("fov_typed_deg", "focal_length_mm", *_SENSOR) if not _counts(name, mode)]
        values.update(dict.fromkeys(hidden, 0.0))
        if mode != DIAGONAL:
            # The typed entries determine it.
            del values["fov_deg"]
        return values

    def enter(self, state: FormState) -> None:
        """Enter the fields of a state."""
        self._state = state
        super().enter(state)
        self.fov.setVisible(state.fov_mode == DIAGONAL)
        self.fov_typed.setVisible(state.fov_mode in (HORIZONTAL, VERTICAL))
        for field in self._lens:
            self.show_row(field, state.fov_mode == SENSOR)
        self._name_camera(state)

    def show_marked(self, messages: dict[str, str]) -> None:
        """Unfold the group for a message at an entry; still show why a camera could not be saved or removed."""
        if self._trouble:
            messages.setdefault("camera", self._trouble)
        super().show_marked(messages)

    # --- layout

    def _add_chooser(self) -> None:
        self.camera = combo("camera", (), _chooser_tip())
        tip = tr("Save these values as your own camera, or remove one")
        self.more = tool_button("more_cameras", QgsApplication.getThemeIcon("/symbologyAdd.svg"), tip)
        self.more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self.more)
        self.save = menu.addAction(tr("Save these values as…"), self._save)
        self.remove = menu.addAction(tr("Remove this camera"), self._remove)
        self.more.setMenu(menu)
        self._form.addRow(
            tr("C&amera"), self._marks.field("camera", self.camera, row(self.camera, self.more, stretch=0))
        )
        self.camera.activated.connect(self._choose)

    def _add_field_of_view(self) -> None:
        modes = (
            (DIAGONAL, tr("Diagonal")),
            (HORIZONTAL, tr("Horizontal")),
            (VERTICAL, tr("Vertical")),
            (SENSOR, tr("Focal length")),
        )
        tip = tr(
            "How to enter the field of view: in degrees across the image's diagonal, width or height, or as "
            "focal length and sensor in mm. A change converts the values."
        )
        self.fov_mode = combo("fov_mode", modes, tip)
        # Wide enough for "Focal length".
        self.fov_mode.setMinimumContentsLength(8)
        tip = tr("Field of view across the image's diagonal, in degrees")
        self.fov = spin("fov_deg", 0.0, _DEGREES, 6, " °", tip)
        tip = tr("Field of view across the image's width or height, as selected, in degrees")
        self.fov_typed = spin("fov_typed_deg", 0.0, _DEGREES, 6, " °", tip)
        for box in (self.fov, self.fov_typed):
            # Wide enough for the angles of named cameras, such as 82.721 °.
            box.setMinimumWidth(12 * box.fontMetrics().averageCharWidth())
        for name, widget in (
            ("fov_mode", self.fov_mode),
            ("fov_deg", self.fov),
            ("fov_typed_deg", self.fov_typed),
        ):
            self.take(name, widget)
        shown = row(self.fov_mode, self.fov, self.fov_typed, stretch=(1, 2))
        field = self._marks.field("fov_deg", self.fov, shown)
        self._form.addRow(tr("F&ield of view"), self._marks.field("fov_typed_deg", self.fov_typed, field))
        tip = tr("Actual focal length of the lens in millimetres, not its full-frame equivalent")
        name = "focal_length_mm"
        focal = self.add(name, tr("Focal length"), spin(name, 0.0, _MM, 6, " mm", tip))
        tips = (tr("Width of the sensor in millimetres"), tr("Height of the sensor in millimetres"))
        sizes = {name: spin(name, 0.0, _MM, 6, " mm", tip) for name, tip in zip(_SENSOR, tips)}
        self._lens = (focal, self.add_two(tr("Sensor"), *_SENSOR, sizes, "×"))

    # --- presets and user's cameras

    def apply_camera(self, state: FormState, choice: CameraChoice) -> FormState:
        """State with the values of a camera, in the state's camera mode."""
        plain = replace(
            state,
            fov_deg=choice.fov_deg,
            aspect=aspect_text(choice.aspect_ratio),
            image_px=choice.image_px or FormState().image_px,
            **dict(choice.lens),
        )
        return update_height(convert_camera(plain, state.fov_mode, choice.sensor_mm))

    def real_camera(self, state: FormState, usual: str) -> CameraChoice | None:
        """The real camera chosen last, else the one named ``usual``; None if a real camera is entered."""
        real = {choice.name: choice for choice in self._cameras if choice.image_px is not None}
        if any(_is(choice, state) for choice in real.values()):
            return None
        return real.get(Settings().camera) or real.get(usual)

    def is_entered(self, choice: CameraChoice) -> bool:
        """Whether a camera is entered."""
        return _is(choice, self._state)

    def _fill_chooser(self) -> None:
        self.camera.clear()
        for choice in self._cameras:
            self.camera.addItem(choice.name, choice)
            self.camera.setItemData(self.camera.count() - 1, shown_plain(choice.tip), Qt.ItemDataRole.ToolTipRole)
        self.camera.addItem(tr("Custom"), None)
        self._name_camera(self._state)

    def _choose(self) -> None:
        choice = self.camera.currentData()
        self._trouble = ""
        if choice is not None:
            if choice.image_px is not None:
                Settings().camera = choice.name
            self.chosen.emit(choice)

    def _name_camera(self, state: FormState) -> None:
        """Show the name of the entered camera; if several cameras have its values, keep the name shown."""
        current = self.camera.currentData()
        if current is None or not _is(current, state):
            found = next((at for at, choice in enumerate(self._cameras) if _is(choice, state)), None)
            self.camera.setCurrentIndex(len(self._cameras) if found is None else found)
            current = self.camera.currentData()
        self.camera.setToolTip(shown_plain(current.tip) if current is not None and current.tip else _chooser_tip())
        self.remove.setEnabled(current is not None and current.user)

    def _save(self) -> None:
        name, given = QInputDialog.getText(self, tr("Save camera"), tr("Name of the camera:"))
        if given:
            self._change(lambda: save_camera(name, self._state), name.strip())

    def _remove(self) -> None:
        from ...core.mission.cameras import remove_camera

        name = self.camera.currentText()
        self._change(lambda: remove_camera(name), "")

    def _change(self, act: Any, named: str) -> None:
        """Change the user's cameras and refill the chooser; show a problem at the chooser."""
        self._trouble = ""
        try:
            act()
        except (InvalidInput, OutputError) as wrong:
            self._trouble = translate(wrong)
        else:
            self._cameras, self._trouble = camera_choices()
            self._fill_chooser()
            if named:
                self.camera.setCurrentIndex(max(self.camera.findText(named), 0))
                self._name_camera(self._state)
        self.edited.emit("camera")


def camera_choices() -> tuple[list[CameraChoice], str]:
    """Entries of the camera chooser, the paper's camera first; and a text on problems with the user's cameras."""
    from ...core.mission.cameras import camera_shelf, shipped_cameras

    own: tuple[CameraPreset, ...] = ()
    try:
        shelf = camera_shelf()
        own, wrong = shelf.entries, "; ".join(map(translate, shelf.problems.values()))
    except InvalidInput as unreadable:
        wrong = translate(unreadable)
    return [_choice(preset) for preset in (*shipped_cameras(), *own)], wrong


def save_camera(name: str, state: FormState) -> None:
    """Save the entered camera under a name.

    Raises
    ------
    InvalidInput
        The name is empty or taken, or the entries are invalid.
    OutputError
        The file of the user's cameras cannot be written.
    """
    from ...core.mission.cameras import add_camera

    camera = state_camera(state)
    if camera is None:
        raise InvalidInput(tr("These values are not a valid camera: fix the highlighted fields, then save."))
    # Write a ratio of larger integers as a decimal number.
    fraction = Fraction(camera.aspect_ratio).limit_denominator(10_000)
    exact = fraction.numerator / fraction.denominator == camera.aspect_ratio
    ratio = [fraction.numerator, fraction.denominator] if exact else [camera.aspect_ratio, 1]
    facts: dict[str, Any] = {"fov_deg": camera.fov_deg}
    if state.fov_mode == SENSOR:
        size_mm = [state.sensor_width_mm, state.sensor_height_mm]
        facts = {"sensor_mm": size_mm, "focal_length_mm": state.focal_length_mm}
    lens = {one: value for one, value in lens_values(state).items() if value != getattr(Lens, one)}
    add_camera(name.strip(), {**facts, "aspect_ratio": ratio, "image_px": state.image_px, **lens})


def _chooser_tip() -> str:
    return tr("Fills in field of view (degrees), aspect ratio and the image's longer side (px)")


def _counts(name: str, mode: str) -> bool:
    return mode in ((HORIZONTAL, VERTICAL) if name == "fov_typed_deg" else (SENSOR,))


def _is(choice: CameraChoice, state: FormState) -> bool:
    """Whether a state has the values of a camera."""
    try:
        ratio = parse_aspect(state.aspect)
    except ValueError:
        return False
    return (
        round(choice.fov_deg, _SAME_DECIMALS) == round(state.fov_deg, _SAME_DECIMALS)
        and ratio == choice.aspect_ratio
        and choice.image_px in (None, state.image_px)
        and dict(choice.lens) == lens_values(state)
    )


def _choice(preset: CameraPreset) -> CameraChoice:
    camera = preset.camera
    lines = [
        tr("{name}: {degrees}° across the diagonal").format(
            name=preset.name, degrees=number_text(camera.fov_deg, ".1f")
        )
    ]
    if preset.width_px is not None and preset.height_px is not None:
        lines.append(
            tr("The real camera's images: {width} × {height} px").format(width=preset.width_px, height=preset.height_px)
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
        tuple((one, getattr(camera, one)) for one in LENS_FIELDS),
    )
