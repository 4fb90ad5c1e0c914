"""The entries of the area: four edges around a button, as on a map."""

from __future__ import annotations

from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QLineEdit, QPushButton

from ..i18n import tr
from ..paths import icon
from .field_marks import FieldMarks
from .form_state import BOX_FIELDS

#: Room for five digits and a sign.
_EDGE_PX = 70


class AreaEntries(QgsCollapsibleGroupBoxBasic):
    """Group of the area.

    Attributes
    ----------
    edges : dict of str to QLineEdit
    draw_box : QPushButton
    """

    def __init__(self, marks: FieldMarks) -> None:
        super().__init__(tr("Area"))
        self.edges = {name: _edge(name) for name in BOX_FIELDS}
        letters = {"north": tr("N"), "west": tr("W"), "south": tr("S"), "east": tr("E")}
        grid = QGridLayout(self)
        grid.setHorizontalSpacing(6)
        # As on a map: north above, south below, west left, east right.
        places = {"north": (0, 1), "west": (1, 0), "east": (1, 2), "south": (2, 1)}
        for name, (line, column) in places.items():
            cell = QHBoxLayout()
            label = QLabel(letters[name])
            label.setBuddy(self.edges[name])
            cell.addWidget(label)
            cell.addWidget(self.edges[name], 1)
            grid.addLayout(cell, line, column)
        self.draw_box = QPushButton(icon("draw_box"), tr("Draw box"))
        self.draw_box.setObjectName("draw_box")
        self.draw_box.setToolTip(tr("Press, drag and release on the map"))
        grid.addWidget(self.draw_box, 1, 1)
        for line, name in enumerate(BOX_FIELDS, start=3):
            grid.addWidget(marks.label(name, self.edges[name]), line, 0, 1, 3)
        for column in range(3):
            grid.setColumnStretch(column, 1)


def _edge(name: str) -> QLineEdit:
    tips = {
        "north": tr("Northern edge: latitude in degrees, up to 90"),
        "west": tr(
            "Western edge: longitude in degrees; greater than the eastern one across the antimeridian"
        ),
        "south": tr("Southern edge: latitude in degrees, down to -90"),
        "east": tr("Eastern edge: longitude in degrees"),
    }
    paste = tr("Coordinates pasted here as north_west_south_east_agl fill all fields.")
    edit = QLineEdit()
    edit.setObjectName(name)
    edit.setToolTip(f"{tips[name]}\n{paste}")
    edit.setPlaceholderText(tr("degrees"))
    edit.setMinimumWidth(_EDGE_PX)
    return edit
