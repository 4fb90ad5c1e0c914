"""Longest time for which the mission panel keeps QGIS waiting while somebody types into each of its fields.

Keys come one by one to the widgets of the real application while its event loop runs, and a timer that is due every
millisecond notes how late it comes: that is how long a click, or a repaint, would have had to wait. Plans are worked
out beside it, as in use. Of each longest wait it is said how long the main thread was at work and how long it stood in
the queue for a processor, which is long where other programs run; beside it is how long the longest key took, and the
most work between two beats.

::

    python tools/qgis_app.py benchmarks/dock.py            # a box of some dozen images
    python tools/qgis_app.py benchmarks/dock.py --large    # of some hundred thousand
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable

from heartbeat import Heartbeat
from qgis.PyQt.QtCore import QEvent, QEventLoop, Qt, QTimer
from qgis.PyQt.QtGui import QKeyEvent
from qgis.PyQt.QtWidgets import QApplication, QComboBox, QLineEdit, QWidget
from qgis.utils import plugins

#: What is typed, key by key, as fast as people do.
KEYS, KEY_MS = "12.5", 120
SMALL = ("35.14", "-89.87", "35.131", "-89.856")
LARGE = ("35.14", "-89.87", "34.14", "-88.9")


def run_for(milliseconds: int) -> None:
    """Let the application run."""
    loop = QEventLoop()
    QTimer.singleShot(milliseconds, loop.quit)
    loop.exec()


def seconds_of(act: Callable[[], object]) -> float:
    """Run something and return how long it took."""
    start = time.perf_counter()
    act()
    return time.perf_counter() - start


def press_key(widget: QWidget, key: int, text: str = "") -> float:
    """Press and release a key; return how long it took to be dealt with."""
    seconds = 0.0
    for kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
        event = QKeyEvent(kind, key, Qt.KeyboardModifier.NoModifier, text)
        seconds += seconds_of(lambda event=event: QApplication.sendEvent(widget, event))
    run_for(KEY_MS)
    return seconds


def type_into(widget: QWidget) -> float:
    """Type a number into a field, or go down a chooser's list and up again; return the longest time of a key."""
    widget.setFocus()
    if isinstance(widget, QComboBox):
        return max(press_key(widget, key) for key in (Qt.Key.Key_Down, Qt.Key.Key_Up))
    edit = widget if isinstance(widget, QLineEdit) else widget.findChild(QLineEdit)
    if edit is None:
        return max(press_key(widget, Qt.Key.Key_Space, " ") for _ in range(2))
    edit.selectAll()
    return max(press_key(widget, ord(letter), letter) for letter in KEYS)


def main() -> None:
    """Print the longest wait of every field, the worst first."""
    plugin = plugins["terrainav"]
    session = plugin.session
    session.show_dock(True)
    form = session.dock.form
    edges = LARGE if "--large" in sys.argv else SMALL
    for edit, text in zip(form.edges.values(), edges):
        edit.setText(text)
    usual = form.state()
    run_for(5000)
    print(f"{session.planned.summary.images:,} images")
    fields = {**form.edges, **{name: w for group in form.groups for name, w in group.entries.items()}}
    for box in form.boxes:
        form.pages.setCurrentWidget(form.pages.page_of(box))
        box.setCollapsed(False)
    form.set_state(usual)
    run_for(2000)
    heartbeat = Heartbeat()
    run_for(1000)
    print(f"nothing typed: {heartbeat.longest.text()} ms{load()}")
    print(f"{'field':20} {'a key, ms':>10} {'longest wait, ms (at work + queued)':>36} {'most work, ms':>14}")
    lines = []
    for name, widget in fields.items():
        form.pages.setCurrentWidget(form.pages.page_of(widget))
        if not widget.isVisible() or name == "folder":
            continue
        heartbeat.reset()
        key_s = type_into(widget)
        # Until the plan of the last key has been shown, and the entries written down.
        run_for(12 * KEY_MS)
        wait = heartbeat.longest
        text = f"{name:20} {1e3 * key_s:10.1f} {wait.text():>36} {1e3 * heartbeat.most_work_s:14.0f}"
        lines.append((wait, text))
        form.set_state(usual)
        run_for(5 * KEY_MS)
    print("\n".join(text for _, text in sorted(lines, reverse=True)))
    run_for(2000)
    for what, act in (
        ("a plan taken up", lambda: session.planner.planned.emit(session.planned)),
        ("entries written down", session.memory.write),
    ):
        print(f"{what}: {1e3 * seconds_of(act):.1f} ms")


def load() -> str:
    """How busy the machine is, where it says so."""
    return f"; load average {os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""


main()
