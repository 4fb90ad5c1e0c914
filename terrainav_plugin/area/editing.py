"""Undoable edits of the area, from its entries to the form."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from qgis.PyQt.QtCore import QObject, pyqtSignal

from ...core.mission.areas.area import Area, Polygon
from ..form.area import (
    FormError,
    describe_area,
    entered_area,
    entered_no_fly,
    no_fly_text,
    paste_coordinates,
    replace_area,
)
from ..form.state import FormState
from ..form.text import looks_like_coordinates
from ..i18n import tr
from .entries import AreaEntries
from .history import AreaHistory, UndoKeys, step_names


class AreaEditing(QObject):
    """Enter every change of the area into the form as an undoable step, and describe the area.

    Parameters
    ----------
    entries : AreaEntries
    read, write : callable
        Return the state of the form; enter a state into it.

    Signals
    -------
    typed()
        The user has edited an edge.
    coordinates_entered()
        The user has typed or pasted the area, or an edge of it.
    noted()
        A change of the form has been handled.

    Attributes
    ----------
    wrong : dict of str to str
        Errors of coordinates pasted into an edge, by field; empty once an edge changes.
    """

    typed = pyqtSignal()
    coordinates_entered = pyqtSignal()
    noted = pyqtSignal()

    def __init__(
        self,
        entries: AreaEntries,
        read: Callable[[], FormState],
        write: Callable[[FormState], None],
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._entries, self._read, self._write = entries, read, write
        self.wrong: dict[str, str] = {}
        self.history = AreaHistory(read, write, self)
        self.undo_keys = UndoKeys(self.history)
        self._shape_lost = False
        #: The area described last, its unit and the description, as measuring large shapes is slow.
        self._worded: tuple[Area | None, str, str] = (None, "", "")
        entries.connect_history(self.history)
        entries.box_wanted.connect(self.make_box)
        entries.no_fly_cleared.connect(self.clear_no_fly)
        # The text fields too, as they receive keys before the panel.
        for widget in (parent, *entries.edges.values()):
            widget.installEventFilter(self.undo_keys)
        for name, edit in entries.edges.items():
            edit.textChanged.connect(partial(self._take_typed, name))
            edit.editingFinished.connect(partial(self._finish_edge, name))

    def state(self) -> FormState:
        """State of the form."""
        return self._read()

    def set_area(self, area: Area, step: str, agl_m: float | None = None, joined: bool = False) -> None:
        """Enter an area as one step; ``joined`` merges it with a preceding step of the same name.

        Raises
        ------
        InvalidInput
            The area has values outside their domain.
        """
        self._set(replace_area(self._read(), area, agl_m), step, joined)

    def set_coordinates(self, text: str) -> None:
        """Enter coordinates from text; raises FormError for the field ``north``."""
        self._set(paste_coordinates(self._read(), text), tr("paste coordinates"))
        self.coordinates_entered.emit()

    def set_no_fly(self, polygons: tuple[Polygon, ...], step: str) -> None:
        """Enter no-fly areas as one step."""
        self._set(replace(self._read(), no_fly=no_fly_text(polygons)), step)

    def clear_no_fly(self) -> None:
        """Remove all no-fly areas."""
        self.set_no_fly((), tr("clear the no-fly areas"))

    def set_takeoff(self, text: str, step: str) -> None:
        """Enter a take-off point as one step; an empty text removes it."""
        self._set(replace(self._read(), takeoff=text), step)

    def set_entry(self, name: str, text: str, step: str) -> None:
        """Enter skipped rows or splits as one step."""
        self._set(replace(self._read(), **{name: text}), step)

    def make_box(self) -> None:
        """Replace a polygon or points by their bounding box."""
        area = entered_area(self._read())
        if area is not None:
            self.set_area(area.bounds, tr("make it a box"))

    def note(self) -> None:
        """Handle a change of the form."""
        self.history.note()
        state = self._read()
        area = entered_area(state)
        if (area, state.agl_unit) != self._worded[:2]:
            self._worded = area, state.agl_unit, "" if area is None else describe_area(area, state.agl_unit)
        is_ground = area is not None and area.covers_ground
        self._entries.show_no_fly(len(entered_no_fly(state)))
        self._entries.show_description(self._worded[2], bool(self._entries.shape), self._shape_lost, is_ground)
        self.noted.emit()

    def _set(self, state: FormState, step: str, joined: bool = False) -> None:
        self._shape_lost = False
        self.history.name(step, joined)
        self._write(state)

    def _take_typed(self, name: str, text: str) -> None:
        """Distribute coordinates pasted into one edge over all edges; a typed edge makes the area a box."""
        self.wrong = {}
        # Not while typing: three numbers may become an angle, or four numbers.
        if self._entries.edges[name].is_pasted() and self._is_spread(name, text):
            return
        self._shape_lost = self._shape_lost or bool(self._entries.shape)
        self._entries.shape = ""
        self.history.name(step_names()[name], joined=True)
        self.typed.emit()
        self.coordinates_entered.emit()

    def _finish_edge(self, name: str) -> None:
        """Distribute coordinates typed into one edge over all edges, when the edge loses the focus."""
        text = self._entries.edges[name].text()
        if not self.wrong and looks_like_coordinates(text) and not self._is_spread(name, text):
            self.typed.emit()

    def _is_spread(self, name: str, text: str) -> bool:
        """Distribute coordinates over all edges, or note their errors; False if the text has no coordinates."""
        if not looks_like_coordinates(text):
            return False
        try:
            self.set_coordinates(text)
        except FormError as wrong:
            self.wrong = {name: wrong.messages["north"]}
            return False
        return True
