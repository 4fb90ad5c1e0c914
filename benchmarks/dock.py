"""Longest time for which the mission panel keeps QGIS waiting while somebody types into each of its fields.

Keys are posted to the widgets of the real application while its event loop runs, and a timer that is due every
millisecond notes how late it comes: that is how long a click, or a repaint, would have had to wait. Plans are worked
out beside it, as in use.

::

    python tools/qgis_app.py benchmarks/dock.py            # a box of some dozen images
    python tools/qgis_app.py benchmarks/dock.py --large    # of some hundred thousand
"""

from __future__ import annotations

import sys
import time

from qgis.PyQt.QtCore import QEvent, QEventLoop, Qt, QTimer
from qgis.PyQt.QtGui import QKeyEvent
from qgis.PyQt.QtWidgets import QApplication, QComboBox, QLineEdit, QWidget
from qgis.utils import plugins

#: What is typed, key by key, as fast as people do.
KEYS, KEY_MS = "12.5", 120
SMALL = ("35.14", "-89.87", "35.131", "-89.856")
LARGE = ("35.14", "-89.87", "34.14", "-88.9")


class Heartbeat:
    """Notes the longest time between two beats of the event loop."""

    def __init__(self) -> None:
        self.longest_s = 0.0
        self._last = time.perf_counter()
        self._timer = QTimer()
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.timeout.connect(self._beat)
        self._timer.start(1)

    def take_s(self) -> float:
        """Return the longest time since it was last taken."""
        longest_s, self.longest_s = self.longest_s, 0.0
        return longest_s

    def _beat(self) -> None:
        now = time.perf_counter()
        self.longest_s, self._last = max(self.longest_s, now - self._last), now


def run_for(milliseconds: int) -> None:
    """Let the application run."""
    loop = QEventLoop()
    QTimer.singleShot(milliseconds, loop.quit)
    loop.exec()


def post_key(widget: QWidget, key: int, text: str = "") -> None:
    """Press and release a key, by way of the event loop."""
    for kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
        QApplication.postEvent(widget, QKeyEvent(kind, key, Qt.KeyboardModifier.NoModifier, text))


def type_into(widget: QWidget) -> None:
    """Type a number into a field, or go down a chooser's list and up again."""
    widget.setFocus()
    if isinstance(widget, QComboBox):
        for key in (Qt.Key.Key_Down, Qt.Key.Key_Up):
            post_key(widget, key)
            run_for(KEY_MS)
        return
    edit = widget if isinstance(widget, QLineEdit) else widget.findChild(QLineEdit)
    if edit is None:
        for _ in range(2):
            post_key(widget, Qt.Key.Key_Space, " ")
            run_for(KEY_MS)
        return
    edit.selectAll()
    for letter in KEYS:
        post_key(widget, ord(letter), letter)
        run_for(KEY_MS)


def main() -> None:
    """Print the longest wait of every field, the worst first."""
    plugin = plugins["terrainav"]
    workflow = plugin.workflow
    workflow.show_dock(True)
    form = workflow.dock.form
    edges = LARGE if "--large" in sys.argv else SMALL
    for edit, text in zip(form.edges.values(), edges):
        edit.setText(text)
    usual = form.state()
    run_for(5000)
    print(f"{workflow.planned.summary.images:,} images")
    fields = {**form.edges, **{name: w for group in form.groups for name, w in group.entries.items()}}
    for box in form.boxes:
        box.setCollapsed(False)
    form.set_state(usual)
    run_for(2000)
    heartbeat = Heartbeat()
    run_for(500)
    print(f"nothing typed: {1e3 * heartbeat.take_s():.0f} ms")
    waits: dict[str, float] = {}
    for name, widget in fields.items():
        if not widget.isVisible() or name == "folder":
            continue
        heartbeat.take_s()
        type_into(widget)
        # Until the plan of the last key has been shown.
        run_for(10 * KEY_MS)
        waits[name] = heartbeat.take_s()
        form.set_state(usual)
        run_for(5 * KEY_MS)
    for name, wait_s in sorted(waits.items(), key=lambda item: -item[1]):
        print(f"{name:24} {1e3 * wait_s:6.1f} ms")


main()
