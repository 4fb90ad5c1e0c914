"""Tab for cleaning a dataset; displays only, and emits the user's requests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from qgis.PyQt.QtCore import QSignalBlocker, QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QColor, QIcon, QPainter, QPaintEvent, QPixmap
from qgis.PyQt.QtWidgets import (
    QCheckBox,
    QComboBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QSizePolicy,
    QTabWidget,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from ...core.dataset.folder import DEFAULT_ENTROPY
from ..dataset.picture import DisplayImage, read_picture
from ..form.fields import map_type_title
from ..i18n import number_text, tr
from ..plain import shown_plain
from ..widgets import growing_form, named, push_button, spin, wrapped_label
from .charts import DECIMALS, HIGHEST, KEPT, LOWEST, REJECTED, Bars, Histogram
from .entropies import Entropies, Example
from .tab import no_folder
from .tasks import MARK, MOVE, UNDO

#: Number of example images on each side of the threshold.
COUNT = 4
_ICON_PX = (72, 54)


class CleanTab(QWidget):
    """Show the effect of a threshold on a dataset.

    Signals
    -------
    map_type_chosen(str)
    threshold_changed(float)
        Threshold in bits, from any of the controls.
    on_map_toggled(bool)
    action_wanted(str)
        One of `MARK`, `MOVE` and `UNDO`.
    pictures_wanted()
    """

    map_type_chosen = pyqtSignal(str)
    threshold_changed = pyqtSignal(float)
    on_map_toggled = pyqtSignal(bool)
    action_wanted = pyqtSignal(str)
    pictures_wanted = pyqtSignal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("clean_tab")
        self.entropies: Entropies | None = None
        self._busy = self._footprints = False
        self._lost_focus: QWidget | None = None
        self._make_entries()
        self.charts = (Histogram(), Bars())
        self.tabs = named(QTabWidget(), "charts")
        self.tabs.addTab(self.charts[0], tr("Histo&gram"))
        self.tabs.addTab(self.charts[1], tr("&Image by image"))
        for chart in self.charts:
            chart.look = self.tabs
            chart.threshold_moved.connect(self.threshold.setValue)
            chart.show_threshold(self.threshold.value())
        self.counts = wrapped_label("counts")
        self.counts.setTextFormat(Qt.TextFormat.RichText)
        self.notes = wrapped_label("notes")
        self.reason = wrapped_label("reason")
        self.reason.hide()
        self.strip = ExampleStrip()
        self._make_buttons()
        self._lay_out()
        self.show_hint()

    # --- display

    def show_hint(self, text: str = "") -> None:
        """Show a text instead of entropies; by default, ask for a folder."""
        text = text or no_folder()
        self.entropies = None
        for chart in self.charts:
            chart.show_hint(text)
        self.counts.setText("")
        self.notes.setText("")
        self._show_reason("")
        self.strip.clear()
        with QSignalBlocker(self.map_type):
            self.map_type.clear()
        self._enable()

    def show_entropies(self, found: Mapping[str, Entropies], map_type: str, footprints: bool) -> None:
        """Show a map type of a dataset, and offer the others.

        Parameters
        ----------
        footprints : bool
            Whether the dataset has footprints to show on the map.
        """
        self._footprints = footprints
        self.on_map.setToolTip(
            tr("Mark on the map the images that would be rejected") if footprints else no_footprints()
        )
        with QSignalBlocker(self.map_type):
            self.map_type.clear()
            for name in found:
                self.map_type.addItem(map_type_title(name), name)
            self.map_type.setCurrentIndex(list(found).index(map_type))
        self.entropies = found[map_type]
        self._show_reason("")
        for chart in self.charts:
            chart.show_bits(self.entropies.bits, self.entropies.suggested)
        self._show_counts()
        self._enable()

    def show_working(self, working: bool) -> None:
        """Disable the buttons during a task."""
        self._busy = working
        self._enable()

    def _threshold_set(self, bits: float) -> None:
        for chart in self.charts:
            chart.show_threshold(bits)
        self._show_reason("")
        self._show_counts()
        self.threshold_changed.emit(bits)

    def _show_counts(self) -> None:
        found = self.entropies
        if found is None:
            return
        rejected, count = found.rejected(self.threshold.value()), len(found)
        self.counts.setText(
            tr("<b>{kept}</b> of {count} images kept, <b>{rejected}</b> rejected ({percent} %)").format(
                kept=number_text(count - rejected),
                count=number_text(count),
                rejected=number_text(rejected),
                percent=number_text(100.0 * rejected / max(count, 1), ".1f"),
            )
        )
        notes = []
        if found.by_roadmap:
            notes.append(
                tr("The roadmap decides for all of them.")
                if found.by_roadmap == len(found)
                else tr("The roadmap decides for {count} of them.").format(count=number_text(found.by_roadmap))
            )
        if found.failed:
            notes.append(tr("{count} images could not be captured.").format(count=number_text(found.failed)))
        if found.marked or found.moved:
            notes.append(
                tr("Cleaned before: {marked} images marked, {moved} files moved away.").format(
                    marked=number_text(found.marked), moved=number_text(found.moved)
                )
            )
        self.notes.setText(" ".join(notes) or tr("Not cleaned yet."))

    def _enable(self) -> None:
        """Enable the actions that are possible now."""
        # The window's focus, as a tab's own `focusWidget` remembers a child that has lost the focus.
        focus = self.window().focusWidget()
        focus = focus if focus is not None and self.isAncestorOf(focus) else None
        there = self.entropies is not None and not self._busy
        some = there and len(self.entropies) > 0
        for widget in (self.map_type, self.threshold, *self.charts, self.tabs, self.save):
            widget.setEnabled(some)
        self.on_map.setEnabled(some and self._footprints)
        self.suggest.setEnabled(some and self.entropies.suggested is not None)
        self.buttons[MARK].setEnabled(some)
        self.buttons[MOVE].setEnabled(some)
        self.buttons[UNDO].setEnabled(there)
        self._keep_focus(focus)

    def _keep_focus(self, before: QWidget | None) -> None:
        """Note a widget that loses the focus by being disabled, and return the focus once the widget is enabled."""
        if before is not None and self._lost_focus is None and not before.isEnabled():
            self._lost_focus = before
        elif self._lost_focus is not None and self._lost_focus.isEnabled():
            self._lost_focus.setFocus()
            self._lost_focus = None

    def forget_focus(self) -> None:
        """Leave the focus where it is, as the user is typing there."""
        self._lost_focus = None

    def _suggest(self) -> None:
        """Set the threshold between two groups of entropies, and explain it; keep it if there is only one group."""
        found = self.entropies
        if found is None or found.suggested is None:
            return
        share = found.rejected(found.suggested) / max(len(found), 1)
        figures = {
            "bits": number_text(found.suggested, ".2f"),
            "rejected": number_text(found.rejected(found.suggested)),
            "count": number_text(len(found)),
            "percent": number_text(100.0 * share, ".0f"),
        }
        if not found.groups:
            self._show_reason(
                tr(
                    "The entropies form one group: nothing stands out, and the threshold stays as it is. Cut in two at "
                    "{bits} bits (Otsu's method, the dotted line), {rejected} of {count} images ({percent} %) would be "
                    "rejected, which may all be good."
                ).format(**figures)
            )
            return
        self.threshold.setValue(found.suggested)
        text = tr(
            "The entropies form two groups with few images between them; {bits} bits separate them best "
            "(Otsu's method). The lower group has {rejected} of {count} images ({percent} %)."
        ).format(**figures)
        # Images without detail are usually few.
        if share > 0.25:
            text += " " + tr("That is a large part: look at the images below before you reject them.")
        self._show_reason(text)

    def _show_reason(self, text: str) -> None:
        self.reason.setText(text)
        self.reason.setVisible(bool(text))

    # --- layout

    def _make_entries(self) -> None:
        self.map_type = named(
            QComboBox(),
            "clean_map_type",
            tr("Map type shown here; cleaning applies this threshold to all map types"),
        )
        self.map_type.activated.connect(lambda index: self.map_type_chosen.emit(self.map_type.itemData(index)))
        tip = tr("Images with less entropy are rejected. 0 bits: a single grey; 8 bits: the maximum")
        self.threshold = spin("threshold", LOWEST, HIGHEST, DECIMALS, tr(" bits"), tip)
        self.threshold.setStepType(self.threshold.StepType.DefaultStepType)
        self.threshold.setSingleStep(0.05)
        self.threshold.setValue(DEFAULT_ENTROPY)
        self.threshold.valueChanged.connect(self._threshold_set)
        self.suggest = push_button(
            "suggest",
            tr("S&uggest"),
            tr(
                "Threshold that best separates the entropies into two groups (Otsu's method, the dotted line), and "
                "how many images it rejects"
            ),
        )
        self.suggest.clicked.connect(lambda _checked: self._suggest())
        self.on_map = named(QCheckBox(tr("On the map")), "on_map")
        self.on_map.setChecked(True)
        self.on_map.toggled.connect(self.on_map_toggled)

    def _make_buttons(self) -> None:
        self.buttons = {
            MARK: push_button(
                MARK,
                tr("Mar&k"),
                tr("Reject low-detail images: note in the dataset's table which are rejected, and why"),
            ),
            MOVE: push_button(
                MOVE,
                tr("Move &away"),
                tr("Mark rejected images, and move their files to a folder “rejected” beside the others"),
            ),
            UNDO: push_button(UNDO, tr("U&ndo"), tr("Remove all marks and move all files back")),
        }
        for action, button in self.buttons.items():
            button.clicked.connect(lambda _=False, action=action: self.action_wanted.emit(action))
        self.save = push_button(
            "save_pictures",
            tr("Save charts…"),
            tr("Write both charts of every map type as PNG; needs the Python package matplotlib"),
        )
        self.save.clicked.connect(lambda _checked: self.pictures_wanted.emit())

    def _lay_out(self) -> None:
        shown = QHBoxLayout()
        shown.addWidget(self.map_type, 1)
        shown.addWidget(self.on_map)
        form = growing_form()
        title = QLabel(tr("Map t&ype"))
        title.setBuddy(self.map_type)
        form.addRow(title, shown)
        line = QHBoxLayout()
        label = QLabel(tr("&Threshold"))
        label.setBuddy(self.threshold)
        line.addWidget(label)
        line.addWidget(self.threshold, 1)
        line.addWidget(self.suggest)
        line.addWidget(self.save)
        actions = QHBoxLayout()
        actions.addStretch(1)
        for widget in (self.buttons[UNDO], self.buttons[MARK], self.buttons[MOVE]):
            actions.addWidget(widget)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addLayout(form)
        layout.addWidget(self.tabs, 1)
        layout.addLayout(line)
        layout.addWidget(self.reason)
        layout.addWidget(self.counts)
        layout.addWidget(self.notes)
        layout.addWidget(self.strip)
        layout.addLayout(actions)


class ExampleStrip(QWidget):
    """Show example images; the nearest to the threshold are in the middle.

    Signals
    -------
    chosen(int)
        Row of the table.
    """

    chosen = pyqtSignal(int)

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("examples")
        self.below, self.above = _buttons("below"), _buttons("above")
        self._rows: dict[QToolButton, int] = {}
        layout = QGridLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setVerticalSpacing(2)
        sides = (
            # The nearest rejected image comes last, next to the nearest kept image.
            (tr("Just below: rejected"), REJECTED, self.below[::-1]),
            (tr("Just above: kept"), KEPT, self.above),
        )
        for column, (title, colour, buttons) in enumerate(sides):
            heading = QLabel(title)
            heading.setAlignment(Qt.AlignmentFlag.AlignCenter)
            layout.addWidget(heading, 0, column)
            layout.addWidget(_Line(colour), 1, column)
            row = QHBoxLayout()
            row.setSpacing(2)
            for button in buttons:
                row.addWidget(button)
                button.clicked.connect(lambda _=False, button=button: self._choose(button))
            layout.addLayout(row, 2, column)
        self.clear()

    def clear(self) -> None:
        """Show no images."""
        self.show_examples([], [])

    def show_examples(self, below: Sequence[ExampleImage], above: Sequence[ExampleImage]) -> None:
        """Show images below and above the threshold; in both lists, the nearest to the threshold comes first."""
        self._rows.clear()
        for buttons, shown in ((self.below, below), (self.above, above)):
            for button, example in zip(buttons, [*shown, *[None] * (len(buttons) - len(shown))]):
                self._show(button, example)

    def _show(self, button: QToolButton, shown: ExampleImage | None) -> None:
        button.setEnabled(shown is not None)
        if shown is None:
            button.setIcon(QIcon())
            button.setText("")
            button.setToolTip("")
            button.setAccessibleName("")
            return
        example, picture = shown
        button.setIcon(_icon(picture, self.devicePixelRatioF()))
        button.setText(number_text(example.entropy, ".3f"))
        tip = tr("{name}\n{bits} bits; press to show it on the map").format(
            name=example.path.name, bits=number_text(example.entropy, ".3f")
        )
        button.setToolTip(shown_plain(f"{tip}\n{picture.problem}" if picture.problem else tip))
        button.setAccessibleName(tip)
        self._rows[button] = example.index

    def _choose(self, button: QToolButton) -> None:
        if button in self._rows:
            self.chosen.emit(self._rows[button])


class ExampleImage(NamedTuple):
    """An example, and its image."""

    example: Example
    picture: DisplayImage


def read_examples(
    examples: tuple[Sequence[Example], Sequence[Example]], ratio: float
) -> tuple[list[ExampleImage], list[ExampleImage]]:
    """Read images for a screen with ``ratio`` device pixels per Qt pixel; on any thread."""
    longest_px = round(max(_ICON_PX) * ratio)
    below, above = ([ExampleImage(one, read_picture(one.path, longest_px)) for one in side] for side in examples)
    return below, above


def no_footprints() -> str:
    """Reason why a dataset cannot be shown on the map."""
    return tr("This dataset has no footprints: it cannot be shown on the map.")


class _Line(QWidget):
    """A horizontal line in the colour that one side of the threshold has in the charts."""

    def __init__(self, colour: QColor) -> None:
        super().__init__()
        self._colour = colour
        self.setFixedHeight(3)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: ARG002  Qt passes it
        QPainter(self).fillRect(self.rect(), self._colour)


def _buttons(side: str) -> list[QToolButton]:
    buttons = []
    for number in range(COUNT):
        button = named(QToolButton(), f"{side}_{number}")
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextUnderIcon)
        button.setIconSize(QSize(*_ICON_PX))
        button.setAutoRaise(True)
        button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        # With a large font or in a narrow window, the buttons shrink and crop their images.
        button.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        button.setMinimumWidth(34)
        buttons.append(button)
    return buttons


def _icon(picture: DisplayImage, ratio: float) -> QIcon:
    size = QSize(*_ICON_PX) * ratio
    if picture.image is None:
        pixmap = QPixmap(size)
        pixmap.fill(QColor(0, 0, 0, 0))
    else:
        # Crop the image to fill the icon, so that images of different shapes make an even row.
        whole = picture.image.scaled(
            size, Qt.AspectRatioMode.KeepAspectRatioByExpanding, Qt.TransformationMode.SmoothTransformation
        )
        left, top = (whole.width() - size.width()) // 2, (whole.height() - size.height()) // 2
        pixmap = QPixmap.fromImage(whole.copy(left, top, size.width(), size.height()))
    pixmap.setDevicePixelRatio(ratio)
    return QIcon(pixmap)
