"""Entries of the area: tools to draw it, a description, and four edges."""

from __future__ import annotations

import html

from qgis.core import QgsApplication
from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QSignalBlocker, Qt, pyqtSignal
from qgis.PyQt.QtGui import QKeySequence
from qgis.PyQt.QtWidgets import (
    QGridLayout,
    QLabel,
    QPushButton,
    QToolButton,
    QVBoxLayout,
)

from ..form.state import BOX_FIELDS, FormState
from ..form.text import inserted, short_degrees
from ..i18n import number_text, tr
from ..paths import icon
from ..plain import shown_plain
from ..widgets import FieldMarks, ShortLine, box_contents, named, row, tool_button
from .history import AreaHistory
from .menu import AreaMenu
from .no_fly import NoFlyMenu


class EdgeLine(ShortLine):
    """Entry for an edge; distinguishes pasting from typing."""

    def __init__(self) -> None:
        super().__init__(short_degrees)
        self._before = ""

    def enter(self, text: str) -> None:
        """Enter a text."""
        super().enter(text)
        self._before = self.text()

    def is_pasted(self) -> bool:
        """Whether the text has gained several characters at once since the last call."""
        before, self._before = self._before, self.text()
        return inserted(before, self._before) > 1


class AreaEntries(QgsCollapsibleGroupBoxBasic):
    """Group of the area.

    Signals
    -------
    box_wanted()
        The user wants to replace polygons or points by their bounding box.
    no_fly_cleared()
        The user wants to remove all no-fly areas.

    Attributes
    ----------
    edges : dict of str to EdgeLine
    shape, no_fly : str
        Polygons or points, and no-fly areas, as in `FormState`.
    draw_box, draw_polygon, edit : QPushButton
    area_from : AreaMenu
    no_fly_from : NoFlyMenu
    undo, redo : QToolButton
    """

    box_wanted = pyqtSignal()
    no_fly_cleared = pyqtSignal()

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__(tr("Area"))
        self.shape = self.no_fly = ""
        self.edges = {name: _edge(name) for name in BOX_FIELDS}
        self.draw_box = named(
            QPushButton(icon("draw_box"), tr("Draw &box")),
            "draw_box",
            tr("Press, drag and release on the map"),
        )
        self.draw_polygon = named(
            QPushButton(icon("draw_polygon"), tr("Draw polygon")),
            "draw_polygon",
            tr(
                "Draw a polygon: click each corner on the map; a double click, a right click or Enter finishes, "
                "Backspace removes the last corner, Esc cancels"
            ),
        )
        self.area_from = AreaMenu()
        self.edit = named(
            QPushButton(QgsApplication.getThemeIcon("/mActionVertexTool.svg"), tr("Edit")),
            "edit_area",
            tr(
                "Change the area on the map: drag inside it to move it; drag the edges and corners of a box, or the "
                "corners of a polygon. Dragging a polygon's edge adds a corner, a right click on a corner or Delete "
                "removes it; a right click elsewhere cuts holes and adds polygons. Arrow keys move the area by a pixel "
                "of the screen, with Shift by ten; Esc ends it."
            ),
        )
        self.edit.setCheckable(True)
        self.undo = _tool_button("undo_area", "/mActionUndo.svg")
        self.redo = _tool_button("redo_area", "/mActionRedo.svg")
        self.words = named(QLabel(), "describe_area")
        self.words.setWordWrap(True)
        self.words.setTextFormat(Qt.TextFormat.RichText)
        self.words.linkActivated.connect(self.box_wanted)
        self.no_fly_from = NoFlyMenu()
        self.no_fly_words = named(QLabel(), "no_fly_words", tr("No image is taken and no leg leads there"))
        self.no_fly_words.setTextFormat(Qt.TextFormat.RichText)
        self.no_fly_words.linkActivated.connect(lambda _link: self.no_fly_cleared.emit())
        self._lay_out(marks)

    def values(self) -> dict[str, str]:
        """Return the entries by field."""
        return {
            **{name: edit.whole() for name, edit in self.edges.items()},
            "shape": self.shape,
            "no_fly": self.no_fly,
        }

    def set_state(self, state: FormState) -> None:
        """Enter the fields of a state without emitting signals."""
        self.show_edges(state)
        self.shape, self.no_fly = state.shape, state.no_fly

    def show_edges(self, state: FormState) -> None:
        """Show the edges, for example while dragging, without emitting signals."""
        for name, edit in self.edges.items():
            with QSignalBlocker(edit):
                edit.enter(getattr(state, name))

    def show_description(self, text: str, is_shape: bool, was_shape: bool = False, is_ground: bool = False) -> None:
        """Show a description of the area; empty if there is no area.

        Parameters
        ----------
        is_ground : bool
            Whether the area is a box or polygons.
        is_shape, was_shape : bool
            Whether the area consists of polygons or points, now and before the last change.
        """
        words = html.escape(text)
        if is_shape:
            words += f' (<a href="box">{html.escape(tr("make it a box"))}</a>)'
            tip = tr("The edges are those of the box around it. Typing one makes the area a box.")
        else:
            tip = tr("Size on the ground: width along its middle parallel, height along a meridian")
            if was_shape and text:
                words += ". " + html.escape(tr("The edge typed made it a box; undo brings the shape back."))
        self.words.setText(words)
        self.words.setToolTip(tip)
        self.words.setVisible(bool(text))
        self.area_from.offer_changes(is_ground, is_shape)
        self.edit.setEnabled(bool(text))

    def show_no_fly(self, count: int) -> None:
        """Show the number of no-fly areas."""
        words = tr("1 no-fly area") if count == 1 else tr("{n} no-fly areas").format(n=number_text(count))
        if count:
            words = f'{html.escape(words)} (<a href="remove">{html.escape(tr("remove"))}</a>)'
        self.no_fly_words.setText(words)
        self.no_fly_words.setVisible(count > 0)

    def connect_history(self, history: AreaHistory) -> None:
        """Connect the buttons and the fields' keys to undo and redo."""
        stack = history.stack
        # Connect bound methods, which are disconnected when this group is deleted: the stack lives longer, and emits
        # names at its end.
        for button, act, can, text_changed, name in (
            (self.undo, stack.undo, stack.canUndoChanged, stack.undoTextChanged, self._name_undo),
            (self.redo, stack.redo, stack.canRedoChanged, stack.redoTextChanged, self._name_redo),
        ):
            button.clicked.connect(act)
            can.connect(button.setEnabled)
            text_changed.connect(name)
            button.setEnabled(False)
            name("")

    def _name_undo(self, step: str) -> None:
        tip = tr("Undo: {step} ({keys})").format(step=step, keys=_native("Ctrl+Z"))
        self.undo.setToolTip(shown_plain(tip) if step else tr("No change of the area to undo"))

    def _name_redo(self, step: str) -> None:
        tip = tr("Redo: {step} ({keys})").format(step=step, keys=_native("Ctrl+Shift+Z"))
        self.redo.setToolTip(shown_plain(tip) if step else tr("No change of the area to redo"))

    def _lay_out(self, marks: FieldMarks) -> None:
        titles = {"north": tr("North"), "west": tr("West"), "south": tr("South"), "east": tr("East")}
        tools = QGridLayout()
        buttons = (self.draw_box, self.draw_polygon, self.area_from, self.edit, self.no_fly_from)
        for number, tool in enumerate((*buttons, row(self.undo, self.redo))):
            tools.addWidget(tool, *divmod(number, 3))
        for column in range(3):
            tools.setColumnStretch(column, 1)
        corners = QGridLayout()
        # (row, column) of each edge.
        places = {"north": (0, 0), "west": (0, 1), "south": (1, 0), "east": (1, 1)}
        for name, (line, column) in places.items():
            label = QLabel(titles[name])
            label.setBuddy(self.edges[name])
            corners.addWidget(label, line, 2 * column)
            corners.addWidget(self.edges[name], line, 2 * column + 1)
        corners.setColumnStretch(1, 1)
        corners.setColumnStretch(3, 1)
        layout = QVBoxLayout(box_contents(self))
        layout.setContentsMargins(9, 0, 9, 2)
        layout.addLayout(tools)
        layout.addWidget(self.words)
        layout.addLayout(corners)
        layout.addWidget(self.no_fly_words)
        for name, field in {**self.edges, "shape": self.words, "no_fly": self.no_fly_words}.items():
            layout.addWidget(marks.label(name, field))


def _native(keys: str) -> str:
    """Name of a key sequence on this platform."""
    return QKeySequence(keys).toString(QKeySequence.SequenceFormat.NativeText)


def _tool_button(name: str, image: str) -> QToolButton:
    button = tool_button(name, QgsApplication.getThemeIcon(image), "")
    button.setAutoRaise(True)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    return button


def _edge(name: str) -> EdgeLine:
    tips = {
        "north": tr("Northern edge: latitude in degrees, up to 90"),
        "west": tr("Western edge: longitude in degrees; greater than the eastern one across the antimeridian"),
        "south": tr("Southern edge: latitude in degrees, down to -90"),
        "east": tr("Eastern edge: longitude in degrees"),
    }
    paste = tr(
        "A number, or degrees, minutes and seconds such as 47 01 30. "
        "Coordinates pasted here, or typed and left, fill all fields: north_west_south_east_agl, lat_lon_agl, or lines "
        "of lat lon agl [yaw]. An edge typed makes a polygon or points a box."
    )
    edit = named(EdgeLine(), name, f"{tips[name]}\n{paste}")
    edit.setPlaceholderText(tr("degrees"))
    # Wide enough for five digits and a sign.
    edit.setMinimumWidth(70)
    # Allow pasting tens of thousands of lines; Qt's default cuts the text after about a thousand.
    edit.setMaxLength(1_000_000)
    return edit
