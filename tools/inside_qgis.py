"""The half of ``qgis_app.py`` that runs inside the application."""

from __future__ import annotations

import faulthandler
import os
import runpy
import signal
import site
import sys
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

import qgis.utils
from qgis.core import QgsApplication, QgsProject
from qgis.PyQt.QtCore import PYQT_VERSION_STR, QThreadPool, QTimer

POLL_MS = 50
TASKS_END_MS = 10_000

# Errors that QGIS would have shown in a dialog, which nobody would close here.
shown_errors: list[str] = []


def prepare() -> None:
    """Make errors and hangs visible on the terminal; called before QGIS loads any plugin."""
    # A copy of descriptor 2, which pytest redirects while a test runs.
    terminal = os.dup(2)
    faulthandler.enable(file=terminal)
    faulthandler.register(signal.SIGUSR1, file=terminal, all_threads=True)
    # QGIS 3.22 itself causes this warning at every start.
    warnings.filterwarnings("ignore", message="setapi", category=DeprecationWarning)
    qgis.utils.showException = _print_exception


def _print_exception(
    kind: type[BaseException],
    error: BaseException,
    trace: TracebackType | None,
    message: str | None,
    *_args: object,
    **_kwargs: object,
) -> None:
    """Print an exception; replaces QGIS's ``showException``."""
    lines = traceback.format_exception(kind, error, trace)
    text = "".join([f"{message or 'Python error inside QGIS'}\n", *lines])
    shown_errors.append(text)
    print(text, file=sys.stderr, flush=True)


def start(job: dict[str, Any]) -> None:
    """Begin `job` once the application's event loop runs; called just before it starts."""
    if job["site_packages"]:
        site.addsitedir(job["site_packages"])
    QTimer.singleShot(0, lambda: _begin(job))


def _begin(job: dict[str, Any]) -> None:
    """Run a job with an empty project, in a window that fills the screen, as no window manager places it."""
    iface = qgis.utils.iface
    iface.mainWindow().setGeometry(QgsApplication.primaryScreen().geometry())
    iface.newProject(False)
    _when_idle(lambda: _finish(job, _run(job)))


def _when_idle(action: Callable[[], None]) -> None:
    """Call `action` once nothing is being drawn or computed."""
    busy = qgis.utils.iface.mapCanvas().isDrawing() or QgsApplication.taskManager().countActiveTasks() > 0
    QTimer.singleShot(POLL_MS if busy else 0, (lambda: _when_idle(action)) if busy else action)


def _run(job: dict[str, Any]) -> int:
    """Run a job; returns its exit code, or 1 if the job reports success but QGIS reported an error."""
    try:
        code = _run_pytest(job) if job["pytest"] else _run_script(job["arguments"])
    except BaseException:  # noqa: BLE001  every error is printed, and the application must end
        traceback.print_exc()
        code = 1
    if shown_errors and code == 0:
        print(f"inside_qgis: QGIS reported {len(shown_errors)} Python error(s), see above", file=sys.stderr)
        code = 1
    return code


def _run_script(arguments: list[str]) -> int:
    sys.argv = list(arguments)
    sys.path.insert(0, str(Path(arguments[0]).resolve().parent))
    try:
        runpy.run_path(arguments[0], run_name="__main__")
    except SystemExit as ended:
        if ended.code is None or isinstance(ended.code, int):
            return ended.code or 0
        print(ended.code, file=sys.stderr)
        return 1
    return 0


def _run_pytest(job: dict[str, Any]) -> int:
    os.environ["PYTEST_QT_API"] = f"pyqt{PYQT_VERSION_STR.partition('.')[0]}"
    import pytest

    root = job["root"]
    settings = [
        f"--rootdir={root}",
        f"--config-file={root}/pyproject.toml",
        f"--confcutdir={root}/tests",
        "-p",
        "pytest-qt",
        # pytest-qt replaces Qt's message handler for each phase of a test, and PyQt calls None instead if a thread of
        # QGIS writes a message in the meantime.
        "--no-qt-log",
    ]
    return int(pytest.main([*settings, *job["arguments"]]))


def _finish(job: dict[str, Any], code: int) -> None:
    """Write the exit code and end the application, without its question whether to save the project.

    The project is closed first: QGIS may crash if it has to close a project with layers while it ends. QGIS 3.40 does
    if a thread of its tasks, such as the news feed's, has opened the authentication database and still waits.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    Path(job["result"]).write_text(str(code), encoding="utf-8")
    QgsProject.instance().setDirty(False)
    qgis.utils.iface.newProject(False)
    # Older versions run tasks in the thread pool of the application.
    getattr(QgsApplication.taskManager(), "threadPool", QThreadPool.globalInstance)().waitForDone(TASKS_END_MS)
    QgsApplication.exit(code)
