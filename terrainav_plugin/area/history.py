"""Undo and redo of changes to the area."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from qgis.PyQt.QtCore import QEvent, QObject, Qt, pyqtSignal
from qgis.PyQt.QtGui import QKeyEvent, QKeySequence

from ..compat import QUndoCommand, QUndoStack
from ..form.state import BOX_FIELDS, FormState
from ..i18n import tr

_AREA = (*BOX_FIELDS, "shape")


def same_area(one: FormState, other: FormState) -> bool:
    """Whether two states have the same area."""
    return all(getattr(one, name) == getattr(other, name) for name in _AREA)


def _changed_entries(one: FormState, other: FormState) -> tuple[str, ...]:
    """Entries other than the area in which two states differ, together with entries that belong to these."""
    # Steps may change the height (pasted coordinates do), no-fly areas, the take-off point, skipped rows and splits.
    return tuple(
        name
        for names in (
            ("agl", "agl_unit", "height_by", "camera_gsd"),
            ("no_fly",),
            ("takeoff",),
            ("skip_rows",),
            ("split_after",),
        )
        if any(getattr(one, each) != getattr(other, each) for each in names)
        for name in names
    )


class _Step(QUndoCommand):
    """One change; it is already made when the step is pushed."""

    def __init__(self, name: str, kind: int, before: FormState, after: FormState, history: AreaHistory) -> None:
        super().__init__(name)
        self._kind, self._before, self.after, self._history = kind, before, after, history
        self._done = True

    def id(self) -> int:
        """Kind of step; consecutive steps of the same kind are merged."""
        return self._kind

    def mergeWith(self, other: QUndoCommand) -> bool:
        """Absorb the following step."""
        self.after = other.after
        return True

    def undo(self) -> None:
        """Restore the earlier state."""
        self._history.enter(self._before, self.after)

    def redo(self) -> None:
        """Restore the later state."""
        if self._done:
            self._done = False
            return
        self._history.enter(self.after, self._before)


class AreaHistory(QObject):
    """Undo stack of changes to the area in a form.

    Parameters
    ----------
    read, write : callable
        Return the state of the form; enter a state into it.

    Signals
    -------
    stepped()
        A step has been undone or redone.
    """

    stepped = pyqtSignal()

    def __init__(
        self, read: Callable[[], FormState], write: Callable[[FormState], None], parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self.stack = QUndoStack(self)
        self.stack.setUndoLimit(100)
        self._read, self._write = read, write
        self._last = read()
        self._step: tuple[str, int] | None = None
        self._kinds: dict[str, int] = {}
        self._entering = False

    def name(self, step: str, joined: bool = False) -> None:
        """Name the next change; ``joined`` merges it with a preceding change of the same name."""
        # Qt never merges steps of kind -1.
        kind = self._kinds.setdefault(step, len(self._kinds)) if joined else -1
        self._step = step, kind

    def note(self) -> None:
        """Record the current entries; an unnamed change of the area means another mission, and clears the stack."""
        before, self._last = self._last, self._read()
        step, self._step = self._step, None
        if self._entering:
            return
        if step is None:
            if not same_area(before, self._last):
                self.stack.clear()
            return
        if _changed_entries(before, self._last) or not same_area(before, self._last):
            self.stack.push(_Step(*step, before, self._last, self))

    def enter(self, wanted: FormState, present: FormState) -> None:
        """Enter the area of a state, and the other entries that differ from the present state."""
        names = _AREA + _changed_entries(wanted, present)
        self._entering = True
        try:
            self._write(replace(self._read(), **{name: getattr(wanted, name) for name in names}))
        finally:
            self._entering = False
        self.stepped.emit()


class UndoKeys(QObject):
    """Event filter that passes undo and redo keys from the widgets it is installed on to a history."""

    def __init__(self, history: AreaHistory) -> None:
        super().__init__(history)
        self._stack = history.stack

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Undo or redo before the window's actions or the text field react."""
        if event.type() in (QEvent.Type.ShortcutOverride, QEvent.Type.KeyPress):
            act = self._act(event)
            if act is not None:
                event.accept()
                if event.type() == QEvent.Type.KeyPress:
                    act()
                return True
        return super().eventFilter(watched, event)

    def _act(self, event: QKeyEvent) -> Callable[[], None] | None:
        if event.matches(QKeySequence.StandardKey.Undo):
            return self._stack.undo
        with_control = event.modifiers() & Qt.KeyboardModifier.ControlModifier
        both = with_control and event.modifiers() & Qt.KeyboardModifier.ShiftModifier
        if event.matches(QKeySequence.StandardKey.Redo) or (both and event.key() == Qt.Key.Key_Z):
            return self._stack.redo
        return None


def step_names() -> dict[str, str]:
    """Names of the steps made by typing, by field."""
    return {
        "north": tr("type the northern edge"),
        "west": tr("type the western edge"),
        "south": tr("type the southern edge"),
        "east": tr("type the eastern edge"),
    }
