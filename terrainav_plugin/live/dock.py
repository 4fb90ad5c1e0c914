"""The panel of the live view: the picture, what is known of it, and the entries of the camera's pose."""

from __future__ import annotations

from typing import TYPE_CHECKING

from qgis.gui import QgsDockWidget
from qgis.PyQt.QtCore import pyqtSignal
from qgis.PyQt.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from ...core.fields import field_named
from ...core.mission.methods import bound_text
from ...core.mission.parts import HIGHEST_AGL_M, Attitude
from ...core.units import M_PER_FT
from ..i18n import number_text, tr, translate
from ..picture_view import PictureView
from ..units import FEET
from ..widgets import WRONG_COLOUR, NumberBox, folder_entry, named, push_button, spin, wrapped_label

if TYPE_CHECKING:
    from ...core.live.camera import FrameRequest
    from .source import LiveImage

#: Least height that can be entered, in metres or feet.
_LOWEST = 0.1


class LiveDock(QgsDockWidget):
    """The panel; it only displays, and emits what the user enters.

    Signals
    -------
    pose_entered(str, float)
        Name and value of the entry that the user has changed: height in metres, yaw, tilt or roll in degrees.
    """

    pose_entered = pyqtSignal(str, float)

    def __init__(self) -> None:
        super().__init__(tr("TerrAInav: live view"))
        self.setObjectName("terrainav_live")
        self.picture = PictureView("live_picture")
        self.status, self.problem = wrapped_label("live_status"), wrapped_label("live_problem")
        self.problem.setStyleSheet(f"color: {WRONG_COLOUR}")
        self.problem.hide()
        self.place = _toggle(
            "live_place",
            tr("Move on m&ap"),
            tr("Drag the camera on the map, and its handle to turn it; with the keyboard on the map, use arrow keys"),
        )
        self.follow = _toggle(
            "live_follow",
            tr("&Follow flight"),
            tr("Show what the camera sees in the planned flight, at the time of QGIS's temporal controller"),
        )
        self.record = _toggle(
            "live_record",
            tr("Rec&ord"),
            tr("Note the poses of the camera until you press again, then capture an image from each"),
        )
        self.entries = self._make_entries()
        self.folder = folder_entry(
            "live_folder", tr("Folder of the recording"), tr("Folder of the dataset that a recording becomes")
        )
        self.rate = spin("live_rate", 0.1, 10.0, 1, tr(" per s"), tr("Images of a recording while you move the camera"))
        self.rate.setValue(2.0)
        self.setWidget(self._contents())
        self.show_text("")

    def show_image(self, taken: LiveImage, unit: str) -> None:
        """Show a picture, with heights in metres or feet."""
        self.picture.show_image(taken.image)
        self._describe(status_text(taken, unit))

    def show_text(self, text: str) -> None:
        """Show a text in place of a picture."""
        self.picture.show_image(None, text)
        self._describe("")

    def show_problem(self, text: str) -> None:
        """Show why there is no newer picture; an empty text removes it."""
        self.problem.setText(text)
        self.problem.setVisible(bool(text))

    def show_pose(self, pose: FrameRequest, agl_m: float | None) -> None:
        """Show a pose in the entries; None leaves the height above ground as it is."""
        values = {"height": agl_m, "yaw": pose.yaw_deg, "tilt": pose.tilt_deg, "roll": pose.roll_deg}
        for name, value in values.items():
            entry = self.entries[name]
            # An entry that the user is typing into keeps its text.
            if value is not None and entry.number() != value:
                blocked = entry.blockSignals(True)
                entry.enter(value)
                entry.blockSignals(blocked)

    def show_recording(self, poses: int | None) -> None:
        """Show the number of poses that are recorded; None after a recording."""
        is_recording = poses is not None
        self.record.setText(
            tr("Stop rec&ording ({poses})").format(poses=number_text(poses)) if is_recording else tr("Rec&ord")
        )
        widgets: tuple[QWidget, ...] = (self.follow, self.folder, self.rate)
        for widget in widgets:
            widget.setEnabled(not is_recording)

    def show_following(self, following: bool) -> None:
        """Enable the entries of the pose unless the camera follows the flight."""
        widgets: tuple[QWidget, ...] = (self.place, *self.entries.values())
        for widget in widgets:
            widget.setEnabled(not following)

    def set_unit(self, unit: str) -> None:
        """Set the unit of heights, m or ft."""
        height = self.entries["height"]
        number, height.times = height.number(), 1.0 / M_PER_FT if unit == FEET else 1.0
        height.setRange(_LOWEST, HIGHEST_AGL_M * height.times)
        height.setSuffix(f" {unit}")
        blocked = height.blockSignals(True)
        height.enter(number)
        height.blockSignals(blocked)

    def _describe(self, text: str) -> None:
        self.status.setText(text)
        self.picture.setAccessibleName(tr("Picture of the camera"))
        self.picture.setAccessibleDescription(text or self.problem.text())

    def _make_entries(self) -> dict[str, NumberBox]:
        """Entries of the pose by name; angles as missions may have them."""
        tips = {
            "yaw": tr("Direction of the image's top edge, clockwise from north"),
            "tilt": tr("Angle between the view and the vertical: 0 looks straight down"),
            "roll": tr("Turn of the camera about its view"),
        }
        entries = {
            "height": spin("live_height", _LOWEST, HIGHEST_AGL_M, 2, " m", tr("Height of the camera above ground"))
        }
        for name, tip in tips.items():
            field = field_named(Attitude, f"{name}_deg")
            entries[name] = spin(f"live_{name}", field.least, field.most, 2, "°", tip)
        for name, entry in entries.items():
            entry.valueChanged.connect(
                lambda _value, name=name, entry=entry: self.pose_entered.emit(name, entry.number())
            )
        return entries

    def _contents(self) -> QWidget:
        grid = QGridLayout()
        titles = {"height": tr("He&ight"), "yaw": tr("&Yaw"), "tilt": tr("&Tilt"), "roll": tr("Roll")}
        for number, (name, title) in enumerate(titles.items()):
            row, column = divmod(number, 2)
            grid.addWidget(_label(title, self.entries[name]), row, 2 * column)
            grid.addWidget(self.entries[name], row, 2 * column + 1)
        buttons = QHBoxLayout()
        for button in (self.place, self.follow, self.record):
            buttons.addWidget(button)
        into = QHBoxLayout()
        into.addWidget(_label(tr("I&nto"), self.folder))
        into.addWidget(self.folder, 1)
        into.addWidget(self.rate)
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(4, 2, 4, 4)
        layout.setSpacing(4)
        layout.addWidget(self.picture, 1)
        layout.addWidget(self.problem)
        layout.addWidget(self.status)
        layout.addLayout(grid)
        layout.addLayout(buttons)
        layout.addLayout(into)
        return contents


def status_text(taken: LiveImage, unit: str) -> str:
    """Pose, methods and error bound of a picture, and how much of it is not at full resolution."""
    pose, accuracy = taken.request, taken.accuracy
    height = taken.agl_m / (M_PER_FT if unit == FEET else 1.0)
    parts = [
        f"{pose.lat_deg:.6f}, {pose.lon_deg:.6f}",
        tr("{height} {unit} above ground").format(height=number_text(height, ",.1f"), unit=unit),
        tr("yaw {yaw}°, tilt {tilt}°, roll {roll}°").format(
            **{name: number_text(getattr(pose, f"{name}_deg"), ".1f") for name in ("yaw", "tilt", "roll")}
        ),
        "; ".join(str(choice.method.name) for choice in accuracy.choices),
        tr("relief still level, error unknown")
        if taken.is_levelled
        else tr("error ≤ {px} px").format(px=translate(bound_text(accuracy.bound_px))),
        tr("{ms} ms").format(ms=number_text(1000.0 * taken.made_s, ",.0f")),
    ]
    if taken.coarse_share > 0.0:
        share = number_text(max(100.0 * taken.coarse_share, 1.0), ".0f")
        parts.append(tr("{share} % at lower resolution until its tiles are here").format(share=share))
    return " · ".join(parts)


def _toggle(name: str, text: str, tip: str) -> QPushButton:
    made = push_button(name, text, tip)
    made.setCheckable(True)
    return made


def _label(title: str, buddy: QWidget) -> QLabel:
    made = named(QLabel(title), f"{buddy.objectName()}_label")
    made.setBuddy(buddy)
    return made
